//! Stories across crates, over real gRPC on this machine. One binary, a module for each story.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp,
    reason = "a test may fail by panicking, and compares bits on purpose"
)]

mod bad_plans;
mod bad_streams;
mod families;
mod large_messages;
mod operations;
mod plan_then_stream;
mod pvt;
mod rehearsed;
mod rehearsed_paths;
mod side_port;
mod standing_services;
mod synchronised;
mod tracking;
mod watching;
