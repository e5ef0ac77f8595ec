use std::error::Error;
use std::io::{BufRead as _, BufReader};
use std::process::{Child, Command, Stdio};

type Failed = Box<dyn Error + Send + Sync>;

/// A server process, gone with its value.
#[derive(Debug)]
pub struct Process {
    /// The process.
    pub child: Child,
    /// Where it serves.
    pub endpoint: String,
}

impl Process {
    /// The server that was built beside this program, with `args`, on a free port.
    ///
    /// # Errors
    /// Where there is none, or it does not serve.
    pub fn server(args: &[&str]) -> Result<Self, Failed> {
        let binary = std::env::current_exe()?.with_file_name("portamento-server");
        let mut command = Command::new(&binary);
        command.args(["--listen", "127.0.0.1:0"]).args(args);
        Self::start(command)
    }

    /// One that says `serving address=` in its log once it serves.
    ///
    /// # Errors
    /// Where it cannot be started, or does not serve.
    pub fn start(mut command: Command) -> Result<Self, Failed> {
        command.env("RUST_LOG", "serving=info");
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
        let mut child = command.spawn().map_err(|error| {
            let binary = command.get_program().to_string_lossy();
            format!("{binary} cannot be started: {error}; build it first, in the same profile")
        })?;
        let lines = child.stderr.take().map(BufReader::new).map(BufReader::lines);
        let mut lines = lines.into_iter().flatten().map_while(Result::ok);
        let address = lines.find_map(|line| Some(line.split_once("serving address=")?.1.trim().to_owned()));
        // Read on, or a full pipe would hold the server up.
        std::thread::spawn(move || lines.for_each(drop));
        let address = address.ok_or("the server does not serve")?;
        Ok(Self { child, endpoint: format!("http://{address}") })
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        // It may be dead already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
