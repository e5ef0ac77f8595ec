//! `portamento`, the command-line tool: exit codes and nothing else.

mod args;
mod command;
mod failure;
mod service;
mod show;
mod source;

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(command::run())
}
