//! The real images on a private network: a controller plans on the server, and an axis in a container of its own plays
//! the plan from it.
//!
//! Needs a Docker engine: `cargo test -p e2e --test containers`. Where there is none the tests say so and are skipped;
//! with `PORTAMENTO_REQUIRE_DOCKER=1` that is a failure.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp,
    reason = "a test may fail by panicking, and compares counts"
)]

mod cell;
mod delayed;
mod engine;
mod fails_over;
mod others;
mod plan_and_track;
mod plant;
