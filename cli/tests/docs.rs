//! The documentation is true: its commands run, its figures are what the commands draw, its reference is what the programs
//! and the schema say.
//!
//! Blocks of `sh` run in the order in which they stand on a page, in an empty folder, with the programs on the path and the
//! ports of this machine to themselves; a block of `text` that follows one has lines that are printed, with `…` for what
//! differs. After a change: `PORTAMENTO_REGENERATE=1 cargo test -p portamento-cli --test docs`.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    missing_docs,
    reason = "a test may fail by panicking"
)]

mod common;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use common::portamento;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_owned()
}

/// Writes `fresh` into the file where it is asked for, and compares.
#[track_caller]
fn check(path: &Path, fresh: &str) {
    if std::env::var_os("PORTAMENTO_REGENERATE").is_some() {
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, fresh).unwrap();
    }
    let kept = std::fs::read_to_string(path).unwrap_or_default();
    assert!(
        kept == fresh,
        "{} is not up to date: run `PORTAMENTO_REGENERATE=1 cargo test -p portamento-cli --test docs` and commit",
        path.display()
    );
}

/// Pages in `docs` and below, but for those that are made.
fn pages() -> Vec<PathBuf> {
    let mut pages = Vec::new();
    let mut folders = vec![root().join("docs")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() && path.file_name().is_some_and(|name| name != "reference") {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "md") {
                pages.push(path);
            }
        }
    }
    pages.sort();
    pages
}

struct Block {
    kind: String,
    text: String,
}

fn blocks(page: &str) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut open: Option<Block> = None;
    for line in page.lines() {
        match (&mut open, line.strip_prefix("```")) {
            (None, Some(kind)) => open = Some(Block { kind: kind.to_owned(), text: String::new() }),
            (Some(_), Some(_)) => blocks.extend(open.take()),
            (Some(block), None) => block.text += &format!("{line}\n"),
            (None, None) => {}
        }
    }
    assert!(open.is_none(), "a block is not closed");
    blocks
}

/// What is between the outputs of two blocks.
const MARK: &str = "=====8<=====";

/// Where the programs are. `cargo test --workspace` builds all of them; by itself this package's tests build its own alone.
fn programs() -> PathBuf {
    let beside = Path::new(env!("CARGO_BIN_EXE_portamento")).parent().unwrap();
    if ["portamento-server", "portamento-sim-axis"].iter().all(|program| beside.join(program).exists()) {
        return beside.to_owned();
    }
    let args = ["build", "-q", "--locked", "-p", "portamento-server", "-p", "portamento-sim-axis"];
    let built = Command::new(env!("CARGO")).args(args).current_dir(root()).status().unwrap();
    assert!(built.success());
    beside.to_owned()
}

#[test]
fn every_command_on_every_page_runs() {
    let programs = programs();
    let path = format!("{}:{}", programs.display(), std::env::var("PATH").unwrap());
    let mut all = pages();
    all.push(root().join("README.md"));
    for page in all {
        let text = std::fs::read_to_string(&page).unwrap();
        let mut blocks = blocks(&text);
        if page.ends_with("README.md") && page.parent() == Some(&root()) {
            blocks.iter_mut().for_each(|block| block.text = from_a_checkout(&block.text));
        }
        let runs: Vec<&Block> = blocks.iter().filter(|block| block.kind == "sh").collect();
        if runs.is_empty() {
            continue;
        }
        let name = page.strip_prefix(root()).unwrap().display().to_string();
        let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join("docs").join(name.replace('/', "_"));
        let _ = std::fs::remove_dir_all(&place);
        std::fs::create_dir_all(&place).unwrap();
        std::os::unix::fs::symlink(root().join("planner"), place.join("planner")).unwrap();
        // Programs left in the background end with the page.
        let mut script = "set -eu\ntrap 'kill $(jobs -p) 2>/dev/null || true; wait' EXIT\n".to_owned();
        for block in &runs {
            // What is started in the background has its port before the next command asks.
            let text = block.text.replace("portamento-server &", "portamento-server & ready 50051");
            let text = text.replace("--http 127.0.0.1:8080 &", "--http 127.0.0.1:8080 & ready 50051");
            let text = text.replace("--record first &", "--record first & ready 50051");
            let text = text.replace("--record second &", "--record second & ready 50053");
            let text = text.replace("--listen 127.0.0.1:50053 &", "--listen 127.0.0.1:50053 & ready 50053");
            let text = text.replace("portamento-sim-axis &", "portamento-sim-axis & ready 50052");
            writeln!(script, "{text}\necho '{MARK}'").unwrap();
        }
        // Looked up, not tried: a connection to a port on which nobody listens may begin at that very port, and then takes it.
        let ready =
            "ready() { until grep -q \":$(printf %04X $1) 00000000:0000 0A\" /proc/net/tcp; do :; done; }\n";
        let ran = alone(&format!("{ready}{script}"), &place, &path);
        let said = String::from_utf8_lossy(&ran.stdout);
        let errors = String::from_utf8_lossy(&ran.stderr);
        assert!(ran.status.success(), "{name}: {said}\n{errors}");
        let outputs: Vec<&str> = said.split(MARK).collect();
        let mut number = 0;
        let mut last: Option<usize> = None;
        for block in &blocks {
            match block.kind.as_str() {
                "sh" => {
                    last = Some(number);
                    number += 1;
                }
                "text" => {
                    for line in last.take().map(|_| block.text.lines()).into_iter().flatten() {
                        let output = outputs[number - 1];
                        let printed = output.lines().any(|printed| matches(line, printed));
                        assert!(printed, "{name}: {line:?} is not printed: {output}\n{errors}");
                    }
                }
                _ => last = None,
            }
        }
        figures(&page, &text, &place);
    }
}

/// Commands that are called by way of cargo, as this test calls them. What builds, tests or deploys has tests of its own; and what
/// is to be typed while something else runs is typed so in the tutorial.
fn from_a_checkout(text: &str) -> String {
    let text = text.replace("cargo run --release -- ", "portamento ").replace("target/release/", "");
    let left_out = |line: &str| {
        line.starts_with("cargo ") || line.starts_with("deploy/") || line.contains("# while it is tracked")
    };
    text.lines().filter(|line| !left_out(line)).map(|line| format!("{line}\n")).collect()
}

/// `…` stands for what differs.
fn matches(wanted: &str, printed: &str) -> bool {
    match wanted.split_once('…') {
        Some((begin, end)) => printed.starts_with(begin) && printed.ends_with(end),
        None => printed == wanted,
    }
}

/// Figures beside a page are those that its commands draw under the same name.
fn figures(page: &Path, text: &str, place: &Path) {
    for (at, _) in text.match_indices("](") {
        let target = text[at + 2..].split(')').next().unwrap();
        let drawn = place.join(target);
        if target.ends_with(".svg") && !target.contains('/') {
            assert!(drawn.exists(), "{}: {target} is not drawn on the page", page.display());
            check(&page.with_file_name(target), &std::fs::read_to_string(drawn).unwrap());
        }
    }
}

/// Runs a script with no network but a loopback of its own, where the system lets it: the ports that the pages name may be
/// taken otherwise.
fn alone(script: &str, place: &Path, path: &str) -> std::process::Output {
    let can = |args: &[&str]| {
        let tried = Command::new("unshare").args(args).arg("true").stderr(Stdio::null()).status();
        tried.is_ok_and(|status| status.success())
    };
    let mut command = if can(&["-n"]) {
        let mut command = Command::new("unshare");
        command.arg("-n");
        command
    } else if can(&["-rn"]) {
        let mut command = Command::new("unshare");
        command.arg("-rn");
        command
    } else {
        Command::new("env")
    };
    let up = "(ip link set lo up || ifconfig lo up) 2>/dev/null || true\n";
    command
        .args(["timeout", "120", "bash", "-c", &format!("{up}{script}")])
        .current_dir(place)
        .env("PATH", path)
        .env("COLUMNS", "80")
        .env("RUST_LOG", "warn")
        .stdin(Stdio::null())
        .output()
        .unwrap()
}

#[test]
fn links_lead_somewhere() {
    let mut all = pages();
    all.extend(
        ["README.md", "docs/reference/command-line.md", "docs/reference/api.md"]
            .map(|name| root().join(name)),
    );
    for page in all {
        let text = std::fs::read_to_string(&page).unwrap();
        for (at, _) in text.match_indices("](") {
            let target = text[at + 2..].split(')').next().unwrap();
            if target.contains("://") {
                continue;
            }
            let (file, anchor) = target.split_once('#').unwrap_or((target, ""));
            let path = if file.is_empty() { page.clone() } else { page.parent().unwrap().join(file) };
            assert!(path.exists(), "{}: {target}", page.display());
            if !anchor.is_empty() {
                let text = std::fs::read_to_string(&path).unwrap();
                let heads = text.lines().filter(|line| line.starts_with('#'));
                let named = |line: &str| line.trim_start_matches('#').trim().to_lowercase().replace(' ', "-");
                assert!(heads.map(named).any(|name| name == anchor), "{}: {target}", page.display());
            }
        }
    }
}

#[test]
fn the_command_line_is_described_as_it_describes_itself() {
    let mut page = "# Command line\n\nWhat `portamento --help` and `portamento COMMAND --help` print. This page is made; `cli/tests/docs.rs` \
                    keeps it equal.\n"
        .to_owned();
    let help = portamento(&["--help"], "").with(0).out;
    let commands =
        help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let names: Vec<&str> = commands
        .filter(|line| line.starts_with("  ") && !line.starts_with("   "))
        .map(|line| line.split_whitespace().next().unwrap())
        .filter(|name| *name != "help")
        .collect();
    assert!(names.len() > 10, "{names:?}");
    for name in std::iter::once("").chain(names) {
        let args: Vec<&str> = [name, "--help"].into_iter().filter(|arg| !arg.is_empty()).collect();
        let title = format!("portamento {name}");
        let help = portamento(&args, "").with(0).out;
        let lines: Vec<&str> = help.lines().map(str::trim_end).collect();
        write!(page, "\n## {}\n\n```text\n{}\n```\n", title.trim_end(), lines.join("\n")).unwrap();
    }
    check(&root().join("docs/reference/command-line.md"), &page);
}

#[test]
fn messages_and_services_are_described_as_the_schema_describes_them() {
    let mut page = "# Messages and services\n\nFrom the comments of `proto/motion/v1/*.proto`. This page is made; `cli/tests/docs.rs` keeps it \
                    equal. In JSON names of fields are in lowerCamelCase, or as they stand here.\n"
        .to_owned();
    for name in ["plan", "setpoint", "sim_axis", "recording"] {
        let text = std::fs::read_to_string(root().join(format!("proto/motion/v1/{name}.proto"))).unwrap();
        page += &described(&text, &format!("{name}.proto"));
    }
    check(&root().join("docs/reference/api.md"), &page);
}

/// One file of the schema as Markdown: a section for each message, enum and service, a row for each part.
fn described(text: &str, name: &str) -> String {
    let mut page = format!("\n# {name}\n");
    let mut comment = String::new();
    // The names of what is open, outermost first.
    let mut open: Vec<String> = Vec::new();
    for line in text.lines().map(str::trim) {
        if let Some(said) = line.strip_prefix("//") {
            comment += &format!("{}\n", said.strip_prefix(' ').unwrap_or(said));
            continue;
        }
        let words: Vec<&str> = line.split_whitespace().collect();
        match words.as_slice() {
            ["syntax", ..] | ["import", ..] => {}
            ["package", ..] => writeln!(page, "\n{}", comment.trim_end()).unwrap(),
            [kind @ ("message" | "enum" | "service"), title, ..] => {
                open.push((*title).to_owned());
                let head = if *kind == "message" { ["field", "type"] } else { ["name", ""] };
                let level = if open.len() > 1 { "###" } else { "##" };
                write!(page, "\n{level} {}\n\n{}\n", open.join("."), flowing(&comment)).unwrap();
                if !line.ends_with('}') {
                    write!(page, "\n| {} | {} | |\n|---|---|---|\n", head[0], head[1]).unwrap();
                }
                if line.ends_with('}') {
                    open.pop();
                }
            }
            ["oneof", title, ..] => {
                open.push(String::new());
                writeln!(page, "| | *{title}* | {} |", flowing(&comment)).unwrap();
            }
            ["rpc", ..] => {
                let call = line.trim_start_matches("rpc ").trim_end_matches(';');
                let (name, rest) = call.split_once('(').unwrap();
                writeln!(page, "| `{name}` | `({rest}` | {} |", flowing(&comment)).unwrap();
            }
            ["}"] => drop(open.pop()),
            [.., "=", _] if line.ends_with(';') => {
                let (declared, _) = line.rsplit_once(" = ").unwrap();
                let (kind, name) = declared.rsplit_once(' ').unwrap_or(("", declared));
                let kind = if kind.is_empty() { String::new() } else { format!("`{kind}`") };
                writeln!(page, "| `{name}` | {kind} | {} |", flowing(&comment)).unwrap();
            }
            _ => {}
        }
        comment.clear();
    }
    page
}

/// A comment on one line, in which nothing ends a cell.
fn flowing(comment: &str) -> String {
    comment.split_whitespace().collect::<Vec<_>>().join(" ").replace('|', "\\|").replace('<', "&lt;")
}
