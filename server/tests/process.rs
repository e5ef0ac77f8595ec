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
    assert_eq!(settings, ["drain-deadline", "listen", "max-streams"], "{said}");
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

/// What a file, the environment and flags say that cannot be, and that the process says nothing of a port.
#[test]
fn file_environment_and_flags_are_wrong_at_once() {
    let file = in_a_file(
        "wrong.toml",
        "max_stream = 7\nmax_axes = \"many\"\ntls_cert = \"/nowhere.pem\"\nidle_deadline = [7]\nreflection = \"yes\"\n",
    );
    let ended = server(&["--config", &file, "--max-segments", "-1", "--cors-origins", "console"])
        .env("PORTAMENTO_KEEPALIVE_TIMEOUT", "0")
        .env("PORTAMENTO_LOG_FORMAT", "xml")
        .output()
        .unwrap();
    let said = String::from_utf8(ended.stderr).unwrap();
    assert_eq!(ended.status.code(), Some(64), "{said}");
    for (setting, problem) in [
        ("max_stream", "max_streams is"),
        ("max-axes", "is \"many\""),
        ("tls-key", "is missing"),
        ("idle_deadline", "is neither text"),
        ("reflection", "is \"yes\""),
        ("max-segments", "is \"-1\""),
        ("cors-origins", "\"console\""),
        ("keepalive-timeout", "is 0"),
        ("log-format", "is \"xml\": give text or json"),
    ] {
        let line = said.lines().find(|line| line.starts_with(&format!("portamento-server: {setting} ")));
        assert!(line.is_some_and(|line| line.contains(problem)), "{setting}: {said}");
    }
    assert!(!said.contains("serving"), "{said}");
}

/// Flags before the environment, the environment before the file, and that before what is usual.
#[test]
fn flags_go_before_the_environment_and_that_before_the_file() {
    let file = in_a_file("ranks.toml", "served_by = \"\"\nmax_axes = 0\nmax_segments = 0\n");
    let ended = server(&["--config", &file, "--max-segments", "9"]).env("PORTAMENTO_MAX_AXES", "8").output();
    let said = String::from_utf8(ended.unwrap().stderr).unwrap();
    // Only what nothing goes before is still wrong.
    assert_eq!(said.lines().count(), 1, "{said}");
    assert!(said.contains("served-by"), "{said}");
}

/// The file that is handed out says every setting as it is, and is one that can be read.
#[test]
fn the_settings_of_deploy_are_those_of_the_server() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../deploy/config/server.toml");
    let printed = server(&["settings"]).output().unwrap().stdout;
    let printed = String::from_utf8(printed).unwrap();
    if std::env::var_os("PORTAMENTO_REGENERATE").is_some() {
        std::fs::write(path, &printed).unwrap();
    }
    assert_eq!(std::fs::read_to_string(path).unwrap(), printed, "PORTAMENTO_REGENERATE=1 writes it");
    let ended = server(&["--config", path, "--max-axes", "0"]).output().unwrap();
    let said = String::from_utf8(ended.stderr).unwrap();
    assert_eq!((ended.status.code(), said.lines().count()), (Some(64), 1), "{said}");
}

/// What Kubernetes mounts is known to the server: only the certificates are not here.
#[test]
fn the_settings_of_kubernetes_are_known() {
    let settings = concat!(env!("CARGO_MANIFEST_DIR"), "/../deploy/kubernetes/settings");
    let policy = format!("{settings}/policy.toml");
    let ended =
        server(&["--config", &format!("{settings}/server.toml"), "--policy", &policy]).output().unwrap();
    let said = String::from_utf8(ended.stderr).unwrap();
    assert_eq!(ended.status.code(), Some(64), "{said}");
    let wrong: Vec<&str> = said.lines().filter(|line| !line.contains("/certificates/")).collect();
    // Without them nobody is known, to whom the policy might grant anything.
    assert!(
        wrong.iter().all(|line| line.starts_with("portamento-server: policy says who may do what")),
        "{said}"
    );
}

/// A collector that is none is said with all the rest; a plant turns export on by a setting, without another binary.
#[test]
fn spans_go_where_a_setting_says() {
    let rows: [(&[&str], &str); 3] = [
        (&["--otlp-endpoint", "collector:4317"], "otlp-endpoint is \"collector:4317\": it has no scheme"),
        (&["--otlp-endpoint", "https://collector:4317"], "otlp-endpoint is https"),
        (
            &["--otlp-ca", concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml")],
            "otlp-ca is given without a collector",
        ),
    ];
    for (args, problem) in rows {
        let ended = server(&[args, &["--max-streams", "0"]].concat()).output().unwrap();
        let said = String::from_utf8(ended.stderr).unwrap();
        assert_eq!((ended.status.code(), said.lines().count()), (Some(64), 2), "{said}");
        assert!(said.contains(problem) && said.contains("max-streams"), "{said}");
    }
}

fn in_a_file(name: &str, text: &str) -> String {
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn logs_for_programs_are_a_document_a_line() {
    let mut process = server(&["--listen", "127.0.0.1:0", "--log-format", "json"]).spawn().unwrap();
    let mut line = String::new();
    BufReader::new(process.stderr.take().unwrap()).read_line(&mut line).unwrap();
    process.kill().unwrap();
    process.wait().unwrap();
    assert!(line.starts_with('{') && line.contains("\"message\":\"serving\""), "{line:?}");
}

/// The socket is there for as long as its process, for its owner and his group; one that was left behind is replaced, and what
/// is none of ours is left alone.
#[test]
fn a_socket_is_taken_and_given_back() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = std::env::temp_dir().join(format!("portamento-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("server.sock");
    let listen = format!("unix:{}", path.display());
    let start = || {
        let mut process = server(&["--listen", &listen]).spawn().unwrap();
        let mut log = BufReader::new(process.stderr.take().unwrap());
        let mut line = String::new();
        log.read_line(&mut line).unwrap();
        assert!(line.contains(&format!("serving address={listen}")), "{line:?}");
        (process, log)
    };
    let asked = || server(&["--listen", &listen, "healthcheck"]).output().unwrap().status.code();
    let (mut first, _log) = start();
    assert_eq!(asked(), Some(0));
    assert_eq!(std::fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o660);
    // Somebody listens: he keeps it.
    let second = server(&["--listen", &listen]).output().unwrap();
    let said = String::from_utf8(second.stderr).unwrap();
    assert_eq!(second.status.code(), Some(1), "{said}");
    assert!(said.contains("another process listens there"), "{said}");
    assert_eq!(asked(), Some(0));
    // Killed, it leaves its socket behind, and the next takes the place.
    first.kill().unwrap();
    first.wait().unwrap();
    assert!(path.exists());
    assert_eq!(asked(), Some(1));
    let (mut third, _log) = start();
    assert_eq!(asked(), Some(0));
    // Told to stop, it takes its socket with it.
    let told = Command::new("kill").args(["-TERM", &third.id().to_string()]).status().unwrap();
    assert!(told.success() && third.wait().unwrap().success());
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 0);
    // What is no socket is not ours to remove.
    std::fs::write(&path, "mine").unwrap();
    let refused = server(&["--listen", &listen]).output().unwrap();
    let said = String::from_utf8(refused.stderr).unwrap();
    assert!(refused.status.code() == Some(1) && said.contains("no socket"), "{said}");
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "mine");
    std::fs::remove_dir_all(&folder).unwrap();
}
