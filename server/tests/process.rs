//! The process itself: what it says, and the code that it ends with.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail by panicking")]

use std::io::{BufRead as _, BufReader};
use std::process::{Command, Stdio};

fn server(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_portamento-server"));
    command.args(args).env_remove("RUST_LOG").stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

#[test]
fn every_setting_that_cannot_be_is_said_at_once() {
    let args = ["--listen", "0.0.0.0:0", "--max-streams", "0", "--drain-deadline", "-1"];
    let ended = server(&args).output().unwrap();
    let said = String::from_utf8(ended.stderr).unwrap();
    assert_eq!(ended.status.code(), Some(64), "{said}");
    let settings: Vec<&str> = said.lines().map(|line| line.split_whitespace().nth(1).unwrap()).collect();
    assert_eq!(settings, ["listen", "max-streams", "drain-deadline"], "{said}");
}

#[test]
fn exit_codes_tell_a_setting_from_a_failure() {
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let address = taken.local_addr().unwrap().to_string();
    let rows: [(&[&str], i32); 5] = [
        (&["--help"], 0),
        (&["--listen", "somewhere"], 64),
        (&["--drain-deadline", "NaN"], 64),
        (&["--listen", &address], 1),
        (&["--listen", "127.0.0.1:1", "healthcheck"], 1),
    ];
    for (args, code) in rows {
        let ended = server(args).output().unwrap();
        assert_eq!(ended.status.code(), Some(code), "{args:?}: {}", String::from_utf8_lossy(&ended.stderr));
    }
}

#[test]
fn a_log_that_nobody_looks_at_is_plain() {
    let mut process = server(&["--listen", "127.0.0.1:0"]).spawn().unwrap();
    let mut line = String::new();
    BufReader::new(process.stderr.take().unwrap()).read_line(&mut line).unwrap();
    process.kill().unwrap();
    process.wait().unwrap();
    assert!(line.contains("serving address=127.0.0.1:") && !line.contains('\u{1b}'), "{line:?}");
}
