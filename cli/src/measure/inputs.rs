//! The problems that the planner's own tests and benches draw: the same files, so that all measure the same.

#![allow(
    dead_code,
    unreachable_pub,
    clippy::unwrap_used,
    clippy::float_cmp,
    reason = "seeds are constants, so what is drawn from them is known to be drawn; tests take more of it"
)]

#[cfg(feature = "peers")]
#[path = "../../../planner/tests/common/axes.rs"]
pub(crate) mod axes;
#[path = "../../../planner/tests/common/commands.rs"]
pub(crate) mod commands;
#[path = "../../../planner/tests/common/motions.rs"]
pub(crate) mod motions;
#[path = "../../../planner/tests/common/moves.rs"]
pub(crate) mod moves;
#[path = "../../../planner/tests/common/paths.rs"]
pub(crate) mod paths;
#[cfg(feature = "peers")]
#[path = "../../../planner/tests/common/peer.rs"]
pub(crate) mod peer;
#[path = "../../../planner/tests/common/ramp.rs"]
pub(crate) mod ramp;
#[path = "../../../planner/tests/common/random.rs"]
pub(crate) mod random;
#[path = "../../../planner/tests/common/splices.rs"]
pub(crate) mod splices;
#[path = "../../../planner/tests/common/states.rs"]
pub(crate) mod states;
