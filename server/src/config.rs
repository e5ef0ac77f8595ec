use std::path::PathBuf;

use serving::{Misfits, Settings};

use crate::limits::Limits;

/// Everything that can be set, with its default.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// Port, limits of messages and how to leave.
    pub serving: Settings,
    /// The name by which axes know this replica; unset: its address.
    pub served_by: Option<String>,
    /// How large a motion may be, and how many of them.
    pub limits: Limits,
    /// A folder in which every stream is written down, a file for each; `None`: nowhere.
    pub record: Option<PathBuf>,
    /// Names under which people reach the console, beside addresses and `localhost`.
    pub console_hosts: Vec<String>,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            serving: Settings::on_port(50051),
            served_by: None,
            limits: Limits::default(),
            record: None,
            console_hosts: Vec::new(),
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
        for (setting, _) in self.limits.named().into_iter().filter(|(_, most)| *most == 0) {
            misfits.note(setting, "is 0, so that no axis could be served: give 1 or more");
        }
        if self.limits.axes > planner::MAX_AXES {
            let (given, most) = (self.limits.axes, planner::MAX_AXES);
            misfits
                .note("max-axes", format!("is {given}, and no plan has more than {most}: give 1 to {most}"));
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
        let limits = Limits { streams: 0, axes: 65, ..Limits::default() };
        let mut wrong = Config { limits, served_by: Some(String::new()), ..Config::default() };
        wrong.serving.max_message_bytes = 0;
        let misfits = wrong.misfits();
        let settings: Vec<&str> = misfits.as_slice().iter().map(|misfit| &*misfit.setting).collect();
        assert_eq!(settings, ["max-message-bytes", "max-streams", "max-axes", "served-by"]);
    }
}
