use client::Connect;
use serving::{Misfits, Settings};

use crate::models::Models;

/// Everything that can be set, with its default.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// Port, limits of messages and how to leave.
    pub serving: Settings,
    /// The axes of this process.
    pub models: Models,
    /// The most runs at a time: each has a thread of its own.
    pub max_runs: usize,
    /// How planners are connected to.
    pub connect: Connect,
    /// May callers make things go wrong?
    pub fault_injection: bool,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            serving: Settings::on_port(50052),
            models: Models::default(),
            max_runs: 64,
            connect: Connect::new(),
            fault_injection: false,
        }
    }
}

impl Config {
    /// An axis on any free port of this machine.
    #[must_use]
    pub fn loopback() -> Self {
        Self { serving: Settings::on_port(0), ..Self::default() }
    }

    /// Everything that cannot be.
    #[must_use]
    pub fn misfits(&self) -> Misfits {
        let mut misfits = self.serving.misfits();
        if self.max_runs == 0 {
            misfits.note("max-runs", "is 0, so that no axis could move: give 1 or more");
        }
        misfits
    }
}
