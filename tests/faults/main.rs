//! What becomes of a stream when its server dies, falls silent, lies or leaves: real server processes, and axes in this process, by
//! the wall clock, so that every setpoint that a servo is given is seen here.
//!
//! The binaries are those that lie beside this test: `cargo test --workspace` builds them, and before
//! `cargo test -p e2e --test faults` alone `cargo build --workspace --bins` does. `PORTAMENTO_SERVER` and `PORTAMENTO_SIM_AXIS` name others.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp,
    reason = "a test may fail by panicking, and compares bits on purpose"
)]

mod clocks;
mod collector;
mod deaths;
mod drains;
mod exports;
mod liar;
mod lies;
mod mute;
mod replica;
mod resumes;
mod run;
mod silences;
mod soak;
mod stalls;
mod starvation;
