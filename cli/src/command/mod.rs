//! One file for each subcommand.

mod batch;
mod bench;
mod compare;
mod demo;
pub(crate) mod diff;
mod explain;
mod follow;
mod grade;
mod init;
pub(crate) mod machine;
mod operate;
mod plan;
mod pvt;
mod replay;
mod sample;
mod track;
mod verify;
mod watch;

use std::io::{self, BufWriter, Write as _};

use clap::Parser as _;

use crate::args::{Cli, Command};
use crate::failure::Failure;
use crate::service::Server;
use crate::show::paint::{Paint, Screen};

/// Reads the command line, does what it says, tells what went wrong; returns the exit code.
pub(crate) fn run() -> u8 {
    let Cli { global, command } = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(said) => return tell_usage(&said),
    };
    let (stdout, stderr) = (io::stdout(), io::stderr());
    let (paint, notes_paint) = (Paint::new(global.color, &stdout), Paint::new(global.color, &stderr));
    let mut out = BufWriter::with_capacity(1 << 16, stdout.lock());
    let mut notes = stderr.lock();
    let json = global.json;
    let mut screen = Screen { out: &mut out, notes: &mut notes, paint, notes_paint, json };
    let endpoint = global.endpoint.as_deref();
    let done = global.encryption.connect().and_then(|connect| {
        let server = Server { endpoint, connect: &connect };
        execute(&command, server, &mut screen)
    });
    let done = done.and_then(|()| screen.out.flush().map_err(Failure::from));
    let Err(failure) = done else { return 0 };
    // What was printed before the failure comes before its message. Where neither can be written, nobody listens.
    let _ = screen.out.flush();
    let _ = screen.tell(&failure);
    failure.exit_code()
}

/// Help where that was asked for, or what is wrong with the flags.
fn tell_usage(said: &clap::Error) -> u8 {
    use clap::error::ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand;
    let code = u8::try_from(said.exit_code()).unwrap_or(2);
    // Where it cannot be written, nobody listens.
    let _ = said.print();
    if said.use_stderr() && said.kind() != DisplayHelpOnMissingArgumentOrSubcommand {
        let _ = writeln!(io::stderr(), "(exit code {code})");
    }
    code
}

fn execute(command: &Command, server: Server<'_>, screen: &mut Screen<'_>) -> Result<(), Failure> {
    match command {
        Command::Demo(_) if server.endpoint.is_some() => Err(Failure::Usage(
            "demo runs its own server in this process: leave --endpoint out, or use plan and track"
                .to_owned(),
        )),
        Command::Bench(_) if server.endpoint.is_some() => {
            Err(Failure::Usage("bench measures this process: leave --endpoint out".to_owned()))
        }
        Command::Demo(args) => demo::run(args, screen),
        Command::Init(args) => init::run(args, screen),
        Command::Plan(args) => plan::run(args, server, screen),
        Command::Pvt(args) => pvt::run(args, server, screen),
        Command::Compare(args) => compare::run(args, server, screen),
        Command::Verify(args) => verify::run(args, server, screen),
        Command::Diff(args) => diff::run(args, screen),
        Command::Sample(args) => sample::run(args, server, screen),
        Command::Track(args) => track::run(args, server, screen),
        Command::Operate(args) => operate::run(args, server, screen),
        Command::Replay(args) => replay::run(args, screen),
        Command::Watch(args) => watch::run(args, server, screen),
        Command::Grade(args) => grade::run(args, server, screen),
        Command::Bench(args) => bench::run(args, screen),
        Command::Explain(args) => explain::run(args, screen),
    }
}
