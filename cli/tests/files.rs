//! Files to begin with, plans held beside each other, and pictures of them.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    missing_docs,
    reason = "a test may fail by panicking"
)]

mod common;

use std::path::{Path, PathBuf};

use common::{portamento, request};

/// An empty place for the files of one test.
fn place(test: &str) -> PathBuf {
    let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join("files").join(test);
    let _ = std::fs::remove_dir_all(&place);
    std::fs::create_dir_all(&place).unwrap();
    place
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// The names of the fields of a message, in lowerCamelCase, from the schema itself.
fn fields(schema: &str, message: &str) -> Vec<String> {
    let start = schema.find(&format!("\nmessage {message} {{")).unwrap();
    let body = &schema[start..start + schema[start..].find("\n}").unwrap()];
    let field = |line: &str| -> Option<String> {
        let (name, number) = line.trim().strip_suffix(';')?.rsplit_once(" = ")?;
        number.parse::<u32>().ok()?;
        let mut words = name.rsplit(' ').next()?.split('_');
        let first = words.next()?.to_owned();
        Some(words.fold(first, |name, word| name + &word[..1].to_uppercase() + &word[1..]))
    };
    body.lines().filter_map(field).collect()
}

#[test]
fn a_request_to_begin_with_says_every_field_and_can_be_planned() {
    let schema = std::fs::read_to_string("../proto/motion/v1/plan.proto").unwrap();
    let rows = [
        ("plan", &["PlanRequest", "AxisMove", "AxisState", "AxisLimits"][..]),
        ("pvt", &["PlanPvtRequest", "PvtAxis", "AxisState"][..]),
    ];
    for (what, messages) in rows {
        let file = place(what).join("request.json");
        let said = portamento(&["init", what, text(&file)], "").with(0);
        assert!(said.out.contains(&format!("portamento {what} --request")), "{}", said.out);
        let written = std::fs::read_to_string(&file).unwrap();
        for message in messages {
            for field in fields(&schema, message) {
                assert!(written.contains(&format!("\"{field}\"")), "{what}: {message}.{field}");
            }
        }
        let longest = written.lines().map(|line| line.chars().count()).max();
        assert!(longest <= Some(90), "{longest:?}");
        let planned = portamento(&[what, "--request", text(&file), "--json"], "").with(0).json();
        assert_eq!(planned["plan"]["certificate"]["passed"], true);
        // Without comments it is the same request.
        let bare = portamento(&["init", what, "-", "--bare"], "").with(0).out;
        assert!(!bare.contains("//") && serde_json::from_str::<serde_json::Value>(&bare).is_ok());
        assert_eq!(portamento(&[what, "--request", "-", "--json"], &bare).with(0).json(), planned);
    }
}

#[test]
fn a_request_is_asked_for_in_any_order_of_words() {
    let place = place("order");
    for (number, words) in
        [&["a.json"][..], &["a.json", "plan"], &["plan", "a.json"], &["a.json", "pvt"]].iter().enumerate()
    {
        let file = place.join(format!("{number}.json"));
        let words: Vec<&str> =
            words.iter().map(|word| if *word == "a.json" { text(&file) } else { word }).collect();
        portamento(&[&["init"], &words[..]].concat(), "").with(0);
        let command = if words.contains(&"pvt") { "pvt" } else { "plan" };
        portamento(&[command, "--request", text(&file)], "").with(0);
    }
    let unknown = portamento(&["init", "move"], "").with(2).err.replace('\n', " ");
    assert!(unknown.contains("name plan or pvt, or a file, as move.json"), "{unknown}");
    portamento(&["init", "a.json", "b.json"], "").with(2);
    portamento(&["init", "plan", "pvt"], "").with(2);
    let mistyped = portamento(&["explain", "PATH_TO_SHORT"], "").with(2).err;
    assert!(
        mistyped.contains("did you mean PATH_TOO_SHORT?") && mistyped.contains("(exit code 2)"),
        "{mistyped}"
    );
}

#[test]
fn a_plan_is_named_with_a_flag_or_without() {
    let file = place("named").join("move.json");
    let args = [
        "plan",
        "--distance",
        "0.05",
        "--max-velocity",
        "0.25",
        "--max-acceleration",
        "3",
        "--max-jerk",
        "100",
    ];
    portamento(&[&args[..], &["--output", text(&file)]].concat(), "").with(0);
    for command in ["verify", "sample"] {
        let plainly = portamento(&[command, text(&file)], "").with(0).out;
        assert_eq!(portamento(&[command, "--plan", text(&file)], "").with(0).out, plainly);
        portamento(&[command, text(&file), "--plan", text(&file)], "").with(2);
        let missing = portamento(&[command], "").with(2).err;
        assert!(missing.contains("PLAN.json"), "{missing}");
    }
}

#[test]
fn what_is_there_is_not_written_over() {
    let file = place("over").join("mine.json");
    std::fs::write(&file, "mine").unwrap();
    let refused = portamento(&["init", "plan", text(&file)], "").with(2);
    assert!(refused.err.contains("is there already") && refused.err.contains("--force"), "{}", refused.err);
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "mine");
    portamento(&["init", "plan", text(&file), "--force"], "").with(0);
}

#[test]
fn comments_are_read_wherever_requests_are() {
    let one = request(0.05).to_string();
    let commented = format!("// a move\n{} // its end\n", one.replacen('{', "{ /* one axis */ ", 1));
    let plain = portamento(&["plan", "--request", "-", "--json"], &one).with(0).out;
    assert_eq!(portamento(&["plan", "--request", "-", "--json"], &commented).with(0).out, plain);
    assert_eq!(portamento(&["plan", "--batch", "-"], &commented).with(0).out, plain);
    // What is wrong is found where it stands.
    let wrong =
        portamento(&["plan", "--request", "-"], "// µ\n{\"axse\": []}").with(2).err.replace('\n', " ");
    assert!(wrong.contains("column 7: unrecognized"), "{wrong}");
}

#[test]
fn plans_are_held_beside_each_other() {
    let place = place("diff");
    let plan = |name: &str, acceleration: &str| {
        let file = place.join(name);
        let args = ["plan", "--distance", "0.0503", "--max-velocity", "0.25", "--max-jerk", "97"];
        let more = ["--max-acceleration", acceleration, "--output", text(&file)];
        portamento(&[&args[..], &more].concat(), "").with(0);
        file
    };
    let (a, b, nearly) = (plan("a.json", "3"), plan("b.json", "2.5"), plan("c.json", "3.0000000001"));
    let same = portamento(&["diff", text(&a), text(&a)], "").with(0).out;
    assert!(same.contains("Both last as long.") && same.contains("No difference."), "{same}");
    insta::assert_snapshot!(
        "differences",
        portamento(&["diff", text(&a), text(&b)], "")
            .with(1)
            .out
            .replace(env!("CARGO_PKG_VERSION"), "VERSION")
    );
    let found = portamento(&["diff", text(&a), text(&b), "--json"], "").with(1).json();
    // With 2.5 m/s² the first jerk of 97 m/s³ ends after 25.8 ms, with 3 m/s² after 30.9. No piece ends on a cycle, where
    // rounding would say which jerk it has.
    assert_eq!(found["first"]["cycle"], 26);
    assert_eq!(found["worst"][2]["quantity"], "acceleration");
    portamento(&["diff", text(&a), text(&nearly)], "").with(1);
    portamento(&["diff", text(&a), text(&nearly), "--tolerance", "1e-6"], "").with(0);
    portamento(&["diff", text(&a), text(&place.join("none.json"))], "").with(2);
    let other = portamento(
        &[
            "plan",
            "--distance",
            "1",
            "--max-velocity",
            "1",
            "--max-acceleration",
            "1",
            "--max-jerk",
            "1",
            "--cycle-time",
            "2ms",
            "--json",
        ],
        "",
    );
    let refused = portamento(&["diff", text(&a), "-"], &other.with(0).out).with(2).err;
    assert!(refused.contains("--cycle-time"), "{refused}");
}

#[test]
fn pictures_are_png_where_their_name_says_so() {
    let file = place("png").join("move.png");
    let args = [
        "plan",
        "--distance",
        "0.05",
        "--max-velocity",
        "0.25",
        "--max-acceleration",
        "3",
        "--max-jerk",
        "100",
    ];
    portamento(&[&args[..], &["--plot", text(&file)]].concat(), "").with(0);
    let picture = std::fs::read(&file).unwrap();
    assert_eq!(&picture[..8], b"\x89PNG\r\n\x1a\n");
    // Twice 960 wide; letters and curves make it larger than a blank one.
    assert_eq!(u32::from_be_bytes(picture[16..20].try_into().unwrap()), 1920);
    assert!(picture.len() > 50_000, "{}", picture.len());
}
