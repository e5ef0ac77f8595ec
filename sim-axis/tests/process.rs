//! The process itself: what it says, and the code that it ends with.
#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use std::process::Command;

#[test]
fn every_setting_that_cannot_be_is_said_at_once() {
    let args =
        ["--listen", "0.0.0.0:0", "--max-runs", "0", "--drain-deadline", "-1", "--model", "/nowhere.json"];
    let ended = Command::new(env!("CARGO_BIN_EXE_portamento-sim-axis")).args(args).output().unwrap();
    let said = String::from_utf8(ended.stderr).unwrap();
    assert_eq!(ended.status.code(), Some(64), "{said}");
    let settings: Vec<&str> = said.lines().map(|line| line.split_whitespace().nth(1).unwrap()).collect();
    assert_eq!(settings, ["listen", "max-runs", "drain-deadline", "model"], "{said}");
}
