//! The process itself: what it says, and the code that it ends with.
#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use std::process::Command;

fn axis(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_portamento-sim-axis"));
    command.args(args).env_remove("RUST_LOG");
    command
}

#[test]
fn every_setting_that_cannot_be_is_said_at_once() {
    let args =
        ["--listen", "0.0.0.0:0", "--max-runs", "0", "--drain-deadline", "-1", "--model", "/nowhere.json"];
    let ended = axis(&args).output().unwrap();
    let said = String::from_utf8(ended.stderr).unwrap();
    assert_eq!(ended.status.code(), Some(64), "{said}");
    let settings: Vec<&str> = said.lines().map(|line| line.split_whitespace().nth(1).unwrap()).collect();
    assert_eq!(settings, ["drain-deadline", "model", "listen", "max-runs"], "{said}");
}

/// The file that is handed out says every setting as it is, and is one that can be read.
#[test]
fn the_settings_of_deploy_are_those_of_the_simulator() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../deploy/config/sim-axis.toml");
    let printed = String::from_utf8(axis(&["settings"]).output().unwrap().stdout).unwrap();
    if std::env::var_os("PORTAMENTO_REGENERATE").is_some() {
        std::fs::write(path, &printed).unwrap();
    }
    assert_eq!(std::fs::read_to_string(path).unwrap(), printed, "PORTAMENTO_REGENERATE=1 writes it");
    let ended = axis(&["--config", path, "--max-runs", "0"]).output().unwrap();
    let said = String::from_utf8(ended.stderr).unwrap();
    assert_eq!((ended.status.code(), said.lines().count()), (Some(64), 1), "{said}");
}
