use std::path::PathBuf;

use serving::{Misfits, Settings};

/// Everything that can be set, with its default.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// Port, limits of messages and how to leave.
    pub serving: Settings,
    /// The name by which axes know this replica; unset: its address.
    pub served_by: Option<String>,
    /// The most streams at a time.
    pub max_streams: usize,
    /// The most points of a `PlanPvt` request, of all its axes together.
    pub max_pvt_points: usize,
    /// A folder in which every stream is written down, a file for each; `None`: nowhere.
    pub record: Option<PathBuf>,
    /// Names under which people reach the console, beside addresses and `localhost`.
    pub console_hosts: Vec<String>,
    /// The farthest cycle that `SamplePlan` gives: its digest is rolled from cycle 1.
    pub max_sample_cycles: u64,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            serving: Settings::on_port(50051),
            served_by: None,
            max_streams: 10_000,
            // 10 000 of six axes: their plan fits a message.
            max_pvt_points: 60_000,
            record: None,
            console_hosts: Vec::new(),
            // Ten hours at 1 ms.
            max_sample_cycles: 36_000_000,
        }
    }
}

impl Config {
    /// A server on any free port of this machine.
    #[must_use]
    pub fn loopback() -> Self {
        Self { serving: Settings::on_port(0), ..Self::default() }
    }

    /// Everything that cannot be.
    #[must_use]
    pub fn misfits(&self) -> Misfits {
        let mut misfits = self.serving.misfits();
        if self.max_streams == 0 {
            misfits.note("max-streams", "is 0, so that no axis could be served: give 1 or more");
        }
        if let Some(folder) = self.record.as_deref().filter(|folder| !folder.is_dir()) {
            misfits.note("record", format!("is {}, which is no folder: make it first", folder.display()));
        }
        if let Some(why) = self.served_by.as_deref().and_then(planner::wrong_name) {
            misfits.note("served-by", why.to_string());
        }
        misfits
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_is_said_at_once() {
        assert_eq!(Config::default().misfits(), Misfits::default());
        let mut wrong = Config { max_streams: 0, served_by: Some(String::new()), ..Config::default() };
        wrong.serving.max_message_bytes = 0;
        let misfits = wrong.misfits();
        let settings: Vec<&str> = misfits.as_slice().iter().map(|misfit| misfit.setting).collect();
        assert_eq!(settings, ["max-message-bytes", "max-streams", "served-by"]);
    }
}
