//! Server and axis processes: one for each value, gone with it.

use std::io::{BufRead as _, BufReader};
use std::net::SocketAddr;
use std::path::PathBuf;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// How long a process may take to serve, or to be gone.
const PATIENCE: Duration = Duration::from_secs(20);

/// A process on a port of its own.
#[derive(Debug)]
pub(crate) struct Replica {
    child: Child,
    address: SocketAddr,
    log: Arc<Mutex<String>>,
}

impl Replica {
    /// A process called `name` on a free port, that serves.
    pub(crate) async fn start(name: &str) -> Self {
        Self::with(name, SocketAddr::from(([127, 0, 0, 1], 0)), &[]).await
    }

    /// A process called `name` at `address`, with further arguments.
    pub(crate) async fn with(name: &str, address: SocketAddr, arguments: &[&str]) -> Self {
        let mut command = Command::new(binary("portamento-server", "PORTAMENTO_SERVER"));
        command.args(["--listen", &address.to_string(), "--served-by", name]).args(arguments);
        Self::run(command).await
    }

    /// A process called `name` on a free port, in this environment.
    pub(crate) async fn within(name: &str, environment: &[(&str, String)]) -> Self {
        let mut command = Command::new(binary("portamento-server", "PORTAMENTO_SERVER"));
        command.args(["--listen", "127.0.0.1:0", "--served-by", name]).envs(environment.iter().cloned());
        Self::run(command).await
    }

    /// A process with simulated axes on a free port, in this environment.
    pub(crate) async fn axis(environment: &[(&str, String)]) -> Self {
        let mut command = Command::new(binary("portamento-sim-axis", "PORTAMENTO_SIM_AXIS"));
        command.args(["--listen", "127.0.0.1:0"]).envs(environment.iter().cloned());
        Self::run(command).await
    }

    async fn run(mut command: Command) -> Self {
        command.env_remove("RUST_LOG").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
        let started = tokio::task::spawn_blocking(move || Self::spawn(command));
        tokio::time::timeout(PATIENCE, started).await.expect("it serves soon").unwrap()
    }

    fn spawn(mut command: Command) -> Self {
        let mut child = command.spawn().expect("the process starts");
        let mut lines = BufReader::new(child.stderr.take().unwrap()).lines().map_while(Result::ok);
        let (mut text, mut address) = (String::new(), None);
        for line in lines.by_ref() {
            text.push_str(&line);
            text.push('\n');
            address = line.split("serving address=").nth(1).and_then(|rest| rest.trim().parse().ok());
            if address.is_some() {
                break;
            }
        }
        let Some(address) = address else { panic!("the process does not serve: {text}") };
        let log = Arc::new(Mutex::new(text));
        let kept = Arc::clone(&log);
        // Reads on, so that the process is never held up by a full pipe.
        std::thread::spawn(move || {
            for line in lines {
                let mut log = kept.lock().unwrap();
                log.push_str(&line);
                log.push('\n');
            }
        });
        Self { child, address, log }
    }

    /// Where it is.
    pub(crate) fn address(&self) -> SocketAddr {
        self.address
    }

    /// Where it is, for a client.
    pub(crate) fn endpoint(&self) -> String {
        format!("http://{}", self.address)
    }

    /// The number of the process.
    pub(crate) fn pid(&self) -> u32 {
        self.child.id()
    }

    /// Ends it as `kill -9` does: it says no good-bye.
    pub(crate) fn kill(&mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }

    /// Sends it a signal, by its name.
    pub(crate) fn signal(&self, signal: &str) {
        // Every shell has it; not every system has the command.
        let command = format!("kill -{signal} {}", self.child.id());
        assert!(Command::new("sh").args(["-c", &command]).status().unwrap().success(), "{command}");
    }

    /// Stops it for so many milliseconds: it gets no processor.
    pub(crate) fn stalls(&self, milliseconds: u64) {
        let pid = self.child.id();
        // The shell's own wait: whoever tests does not sleep.
        let command = format!("kill -STOP {pid}; sleep {}; kill -CONT {pid}", milliseconds as f64 / 1e3);
        assert!(Command::new("sh").args(["-c", &command]).status().unwrap().success(), "{command}");
    }

    /// Waits until it has gone by itself, for at most `within`.
    pub(crate) async fn gone(mut self, within: Duration) -> ExitStatus {
        let waiting = async {
            let mut look = tokio::time::interval(Duration::from_millis(5));
            loop {
                look.tick().await;
                if let Some(status) = self.child.try_wait().unwrap() {
                    return status;
                }
            }
        };
        let status = tokio::time::timeout(within, waiting).await;
        status.unwrap_or_else(|_| panic!("it has not gone after {within:?}:\n{}", self.log.lock().unwrap()))
    }
}

impl Drop for Replica {
    fn drop(&mut self) {
        if std::thread::panicking() {
            eprintln!("--- log of the process at {}\n{}", self.address, self.log.lock().unwrap());
        }
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The program that was built with this test, or that the variable `named_by` names.
fn binary(program: &str, named_by: &str) -> PathBuf {
    if let Some(named) = std::env::var_os(named_by) {
        return named.into();
    }
    let test = std::env::current_exe().unwrap();
    let binary = test.ancestors().nth(2).unwrap().join(program);
    assert!(
        binary.is_file(),
        "{} is not there: build it with `cargo build --workspace --bins`, with --release where the tests are",
        binary.display()
    );
    binary
}
