//! A Docker engine by its command: networks and containers that go away with their values.

use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;
use std::time::Duration;

/// The tag of the images under test.
const TAG: &str = "e2e";

/// Runs `docker` and gives what it printed.
#[track_caller]
pub(crate) fn docker(arguments: &[&str]) -> String {
    let Output { status, stdout, stderr } = command(arguments).output().expect("docker runs");
    assert!(status.success(), "docker {arguments:?}: {}", String::from_utf8_lossy(&stderr));
    String::from_utf8(stdout).expect("text").trim().to_owned()
}

fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new("docker");
    command.args(arguments).stdin(Stdio::null());
    command
}

/// Is there an engine? Says why not, once; fails where one is required.
pub(crate) fn is_there() -> bool {
    static THERE: OnceLock<bool> = OnceLock::new();
    *THERE.get_or_init(|| {
        let answer = command(&["version", "--format", "{{.Server.Version}}"]).output();
        let there = answer.as_ref().is_ok_and(|output| output.status.success());
        if !there {
            let why = match answer {
                Ok(output) => String::from_utf8_lossy(&output.stderr).trim().to_owned(),
                Err(error) => error.to_string(),
            };
            assert!(
                std::env::var_os("PORTAMENTO_REQUIRE_DOCKER").is_none(),
                "a Docker engine is required, and none answers: {why}"
            );
            eprintln!("skipped: no Docker engine answers ({why})");
        }
        there
    })
}

/// Builds the images, once.
pub(crate) fn images() {
    static BUILT: OnceLock<()> = OnceLock::new();
    BUILT.get_or_init(|| {
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../deploy/build.sh");
        let built = Command::new(script).arg(TAG).stdin(Stdio::null()).status().expect("the script runs");
        assert!(built.success(), "{script} failed");
    });
}

/// A private network.
pub(crate) struct Network {
    name: String,
}

impl Network {
    pub(crate) fn new(story: &str) -> Self {
        let name = format!("portamento-{story}-{}", std::process::id());
        docker(&["network", "create", &name]);
        Self { name }
    }
}

impl Drop for Network {
    fn drop(&mut self) {
        let _ = command(&["network", "rm", &self.name]).output();
    }
}

/// A container of one of the images: no root, a read-only file system, and a port on this machine's loopback.
pub(crate) struct Container {
    id: String,
    port: u16,
}

impl Container {
    /// Starts image `portamento-{image}` under `name` on `network`, and waits until it is healthy.
    pub(crate) fn start(network: &Network, image: &str, name: &str, port: u16) -> Self {
        let publish = format!("127.0.0.1::{port}");
        let tagged = format!("portamento-{image}:{TAG}");
        let id = docker(&[
            "run",
            "--detach",
            "--read-only",
            "--cap-drop",
            "ALL",
            "--network",
            &network.name,
            "--network-alias",
            name,
            "--publish",
            &publish,
            &tagged,
            "--insecure",
        ]);
        let mut container = Self { id, port: 0 };
        container.wait_until_healthy();
        let published = docker(&["port", &container.id, &port.to_string()]);
        let first = published.lines().next().expect("a published port");
        container.port = first.rsplit(':').next().and_then(|port| port.parse().ok()).expect("a port");
        container
    }

    /// Where it is from this machine.
    pub(crate) fn endpoint(&self) -> String {
        format!("http://127.0.0.1:{}", self.port)
    }

    /// What it has logged.
    pub(crate) fn logs(&self) -> String {
        let output = command(&["logs", &self.id]).output().expect("docker runs");
        String::from_utf8_lossy(&[output.stdout, output.stderr].concat()).into_owned()
    }

    /// Stops it as an orchestrator does, and gives its exit code.
    pub(crate) fn stop(&self) -> String {
        docker(&["stop", "--time", "20", &self.id]);
        docker(&["inspect", "--format", "{{.State.ExitCode}}", &self.id])
    }

    #[expect(
        clippy::disallowed_methods,
        reason = "the engine runs the health check on its own clock; nothing tells us"
    )]
    fn wait_until_healthy(&self) {
        for _ in 0..100 {
            let health =
                docker(&["inspect", "--format", "{{.State.Health.Status}} {{.State.Running}}", &self.id]);
            match health.as_str() {
                "healthy true" => return,
                running if running.ends_with("true") => std::thread::sleep(Duration::from_millis(200)),
                other => panic!("the container is {other}: {}", self.logs()),
            }
        }
        panic!("the container is not healthy after 20 s: {}", self.logs());
    }
}

impl Drop for Container {
    fn drop(&mut self) {
        if std::thread::panicking() {
            eprintln!("--- logs of a container\n{}", self.logs());
        }
        let _ = command(&["rm", "--force", "--volumes", &self.id]).output();
    }
}
