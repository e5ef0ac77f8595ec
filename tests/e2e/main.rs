//! Stories across crates, over real gRPC on this machine. One binary, a module for each story.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp,
    reason = "a test may fail by panicking, and compares bits on purpose"
)]

mod attacked;
mod bad_columns;
mod bad_fields;
mod bad_plans;
mod bad_streams;
mod browser;
mod compact;
mod failover;
mod families;
mod figures;
mod injected;
mod large_messages;
mod limits;
mod operations;
mod plan_columns;
mod plan_many;
mod plan_then_stream;
mod pvt;
mod reflected;
mod rehearsed;
mod rehearsed_paths;
mod secured;
mod shared;
mod side_port;
mod simulated;
mod spread;
mod standing_services;
mod synchronised;
mod told;
mod tracking;
mod unix;
mod watching;
