//! `portamento`, the command-line tool: exit codes and nothing else.

#![allow(rustdoc::broken_intra_doc_links, reason = "units stand in square brackets in help texts")]

mod args;
mod command;
mod failure;
mod law;
mod measure;
mod record;
mod replica;
mod service;
mod show;
mod source;

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(command::run())
}
