//! A Docker engine by its command: networks and containers that go away with their values.

use std::path::Path;
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

/// A container of one of the images: no root, a read-only file system, and ports on this machine's loopback.
pub(crate) struct Container {
    id: String,
    port: u16,
    http: u16,
}

/// Where each process answers HTTP in its container.
const HTTP: u16 = 9090;

impl Container {
    /// Starts image `portamento-{image}` under `name` on `network`, without encryption, and waits until it is healthy.
    pub(crate) fn start(network: &Network, image: &str, name: &str, port: u16) -> Self {
        Self::start_with(network, image, name, port, &[], &[])
    }

    /// The same with `files`, a directory of which is `/files` in the container, and `arguments`.
    pub(crate) fn start_with(
        network: &Network,
        image: &str,
        name: &str,
        port: u16,
        files: &[&Path],
        arguments: &[&str],
    ) -> Self {
        let publish = [format!("127.0.0.1::{port}"), format!("127.0.0.1::{HTTP}")];
        let tagged = format!("portamento-{image}:{TAG}");
        let http = format!("--http=0.0.0.0:{HTTP}");
        let volumes: Vec<String> =
            files.iter().map(|directory| format!("{}:/files:ro", directory.display())).collect();
        let mut command = vec!["run", "--detach", "--read-only", "--cap-drop", "ALL"];
        command.extend(["--network", &network.name, "--network-alias", name]);
        publish.iter().for_each(|port| command.extend(["--publish", port]));
        volumes.iter().for_each(|volume| command.extend(["--volume", volume]));
        // The health check asks where the process does.
        let variable = if image == "server" { "PORTAMENTO_HTTP" } else { "PORTAMENTO_SIM_AXIS_HTTP" };
        let variable = format!("{variable}=0.0.0.0:{HTTP}");
        command.extend(["--env", &variable, &tagged, "--insecure", &http]);
        command.extend(arguments);
        let id = docker(&command);
        let mut container = Self { id, port: 0, http: 0 };
        container.wait_until_healthy();
        container.port = container.published(port);
        container.http = container.published(HTTP);
        container
    }

    /// Starts a line to `before`, HOST:PORT, as `name` on `network`; `how` are the arguments of `portamento-line`. It is the program that was
    /// built with this test, with the libraries of this machine that it needs.
    pub(crate) fn line(network: &Network, name: &str, port: u16, before: &str, how: &[&str]) -> Self {
        let program = env!("CARGO_BIN_EXE_portamento-line");
        let listed = Command::new("ldd").arg(program).output().expect("ldd runs");
        let listed = String::from_utf8(listed.stdout).expect("text");
        let libraries = listed.split_whitespace().filter(|word| word.starts_with('/'));
        let mut volumes: Vec<String> = libraries.map(|path| format!("{path}:{path}:ro")).collect();
        volumes.push(format!("{program}:/portamento-line:ro"));
        let (publish, listen) = (format!("127.0.0.1::{port}"), format!("--listen=0.0.0.0:{port}"));
        let (image, before) = (format!("portamento-server:{TAG}"), format!("--before={before}"));
        let mut command = vec!["run", "--detach", "--read-only", "--cap-drop", "ALL", "--no-healthcheck"];
        command.extend(["--network", &network.name, "--network-alias", name, "--publish", &publish]);
        volumes.iter().for_each(|volume| command.extend(["--volume", volume]));
        command.extend(["--entrypoint", "/portamento-line", &image, &listen, &before]);
        command.extend(how);
        let mut container = Self { id: docker(&command), port: 0, http: 0 };
        container.wait_until_said("carrying");
        container.port = container.published(port);
        container
    }

    fn published(&self, port: u16) -> u16 {
        let published = docker(&["port", &self.id, &port.to_string()]);
        let first = published.lines().next().expect("a published port");
        first.rsplit(':').next().and_then(|port| port.parse().ok()).expect("a port")
    }

    /// Where it is from this machine, with encryption: its certificate has its name on the network.
    pub(crate) fn secure_endpoint(&self) -> String {
        format!("https://127.0.0.1:{}", self.port)
    }

    /// A page of its side port.
    pub(crate) async fn page(&self, path: &str) -> (u16, String) {
        let answer = reqwest::get(format!("http://127.0.0.1:{}{path}", self.http)).await.expect("an answer");
        (answer.status().as_u16(), answer.text().await.expect("a text"))
    }

    /// One of its figures, over all labels.
    pub(crate) async fn figure(&self, beginning: &str) -> f64 {
        let (_, page) = self.page("/metrics").await;
        let lines = page.lines().filter(|line| line.starts_with(beginning));
        lines.filter_map(|line| line.rsplit(' ').next()?.parse::<f64>().ok()).sum()
    }

    /// Ends it in the middle of whatever it does.
    pub(crate) fn kill(&self) {
        docker(&["kill", &self.id]);
    }

    /// Takes it off the network, while it goes on.
    pub(crate) fn disconnect(&self, network: &Network) {
        docker(&["network", "disconnect", &network.name, &self.id]);
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

impl Container {
    #[expect(clippy::disallowed_methods, reason = "the engine's log is read again; nothing tells us")]
    fn wait_until_said(&self, word: &str) {
        for _ in 0..100 {
            if self.logs().contains(word) {
                return;
            }
            std::thread::sleep(Duration::from_millis(100));
        }
        panic!("the container has not said {word:?} after 10 s: {}", self.logs());
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
