//! Jerk-limited motion.
#![cfg_attr(not(feature = "std"), no_std)]

mod state;
pub use state::State;
