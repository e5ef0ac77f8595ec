//! The command-line tool as its users meet it: what it prints, and what it ends with.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::float_cmp,
    clippy::panic,
    missing_docs,
    reason = "a test may fail by panicking"
)]

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::{Value, json};

/// What came of one call.
struct Ran {
    code: i32,
    out: String,
    err: String,
}

impl Ran {
    #[track_caller]
    fn with(self, code: i32) -> Self {
        assert_eq!(self.code, code, "{}\n{}", self.out, self.err);
        self
    }

    #[track_caller]
    fn json(&self) -> Value {
        serde_json::from_str(&self.out).unwrap_or_else(|error| panic!("{error}: {}", self.out))
    }

    #[track_caller]
    fn lines(&self) -> Vec<Value> {
        self.out.lines().map(|line| serde_json::from_str(line).expect(line)).collect()
    }
}

fn portamento(args: &[&str], input: &str) -> Ran {
    let mut child = Command::new(env!("CARGO_BIN_EXE_portamento"))
        .args(args)
        .env_remove("NO_COLOR")
        .env("COLUMNS", "80")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let input = input.to_owned();
    // Beside reading: a batch answers while it is asked.
    let feeding = std::thread::spawn(move || {
        // Whoever needs no input does not read it.
        let _ = stdin.write_all(input.as_bytes());
    });
    let Output { status, stdout, stderr } = child.wait_with_output().unwrap();
    feeding.join().unwrap();
    Ran {
        code: status.code().unwrap(),
        out: String::from_utf8(stdout).unwrap(),
        err: String::from_utf8(stderr).unwrap(),
    }
}

/// A place for the files of one test.
fn place(test: &str) -> PathBuf {
    let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join(test);
    std::fs::create_dir_all(&place).unwrap();
    place
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

const LIMITS: [&str; 6] = ["--max-velocity", "0.25", "--max-acceleration", "3", "--max-jerk", "100"];

/// `portamento plan` with the limits of the demo.
fn plan(args: &[&str]) -> Ran {
    portamento(&[&["plan"], &LIMITS[..], args].concat(), "")
}

/// What is the same in every version.
fn unversioned(text: &str) -> String {
    text.replace(env!("CARGO_PKG_VERSION"), "VERSION")
}

fn request(distance: f64) -> Value {
    json!({"axes": [{
        "axis": "x",
        "kind": "AXIS_KIND_PRISMATIC",
        "goal": {"position": distance},
        "limits": {"maxVelocity": 0.25, "maxAcceleration": 3, "maxJerk": 100},
    }]})
}

fn batch(lines: &[String]) -> Ran {
    portamento(&["plan", "--batch", "-"], &lines.join("\n"))
}

#[test]
fn help_teaches() {
    for command in ["", "plan", "verify", "sample", "explain"] {
        let args: Vec<&str> = [command, "--help"].into_iter().filter(|arg| !arg.is_empty()).collect();
        let help = portamento(&args, "").with(0).out;
        assert!(help.contains("Examples:"), "{help}");
        let longest = help.lines().map(|line| line.chars().count()).max();
        assert!(longest <= Some(80), "{longest:?}: {help}");
        insta::assert_snapshot!(format!("help_{command}"), help);
    }
}

#[test]
fn a_plan_is_shown() {
    insta::assert_snapshot!(unversioned(&plan(&["--distance", "0.05"]).with(0).out));
}

#[test]
fn a_path_too_short_is_shown() {
    let args = ["--distance", "-0.002", "--end-velocity", "-0.2"];
    let refused = plan(&args).with(3);
    assert_eq!(refused.out, "");
    insta::assert_snapshot!("refused_in_words", refused.err);
    let json = plan(&[&args[..], &["--json"]].concat()).with(3).json();
    assert_eq!(json["error"]["code"], "FAILED_PRECONDITION");
    assert_eq!(json["error"]["reason"], "PATH_TOO_SHORT");
    assert_eq!(json["error"]["metadata"]["given"], "-0.002");
    let nearest = plan(&[&args[..], &["--short-path", "nearest-velocity"]].concat()).with(0).out;
    insta::assert_snapshot!("adjusted", unversioned(&nearest));
}

#[test]
fn tables_fit_eighty_columns() {
    let rows: [&[&str]; 4] = [
        &["--distance", "1e-12"],
        &["--distance", "-1e6", "--axis", "a name that is longer than any table has room for"],
        &["--distance", "0.123456789", "--from", "-1234.56789", "--kind", "revolute"],
        &["--distance", "0.333", "--start-velocity", "0.1", "--max-position", "7", "--kind", "pulses"],
    ];
    for row in rows {
        let out = plan(row).with(0).out;
        let table = out.lines().filter(|line| !line.starts_with("Axis a name"));
        let longest = table.map(|line| line.chars().count()).max();
        assert!(longest <= Some(80), "{longest:?}:\n{out}");
    }
}

#[test]
fn colours_are_for_terminals() {
    assert!(!plan(&["--distance", "0.05"]).with(0).out.contains('\x1b'));
    assert!(plan(&["--distance", "0.05", "--color", "always"]).with(0).out.contains("\x1b[1m"));
    // Nor does a name steer a terminal.
    assert!(!plan(&["--distance", "0.05", "--axis", "\x1b[31m"]).with(3).err.contains('\x1b'));
}

#[test]
fn exit_codes_tell_why() {
    let rows: [(&[&str], i32); 8] = [
        (&["plan"], 2),
        (&["plan", "--distance", "0.05", "--max-velocity", "fast"], 2),
        (&["plan", "--distance", "1", "--batch", "-"], 2),
        (&["plan", "--request", "/nowhere/request.json"], 2),
        (&["verify", "--plan", "/nowhere/plan.json"], 2),
        (&["explain", "NO_SUCH_REASON"], 2),
        (&["explain", "path_too_short"], 0),
        (&["explain"], 0),
    ];
    for (args, code) in rows {
        portamento(args, "").with(code);
    }
    let everything = plan(&["--distance", "NaN", "--cycle-time", "0ms", "--start-velocity=inf"]).with(3);
    for flag in ["--cycle-time", "--to or --distance", "--start-velocity", "exit code 3"] {
        assert!(everything.err.contains(flag), "{}", everything.err);
    }
    plan(&["--distance", "0.05", "--output", "/nowhere/plan.json"]).with(1);
    portamento(&["plan", "--request", "-"], "{").with(2);
    portamento(&["plan", "--request", "-"], &request(f64::MAX).to_string()).with(3);
    portamento(&["plan", "--request", "-"], &request(0.05).to_string()).with(0);
}

#[test]
fn a_batch_answers_every_line_in_order() {
    let many = vec![request(0.05)["axes"][0].clone(); 1000];
    let mut not_a_number = request(0.05);
    not_a_number["axes"][0]["goal"]["velocity"] = json!("NaN");
    let mut bare = request(0.05).to_string();
    bare = bare.replace("0.05", "NaN");
    let lines = [
        request(0.05).to_string(),
        "garbage".into(),
        "  ".into(),
        not_a_number.to_string(),
        bare.clone(),
        bare.replace("NaN", "-Infinity"),
        bare.replace("NaN", "1e999"),
        json!({"axes": many, "synchronization": "SYNCHRONIZATION_NONE"}).to_string(),
        json!({"axes": []}).to_string(),
        "{\"axis\": []}".into(),
        "[1, 2]".into(),
        "\u{feff}".into(),
        request(-0.1).to_string(),
    ];
    let ran = batch(&lines).with(0);
    let answers = ran.lines();
    let expected = [
        "plan",
        "INVALID_ARGUMENT MESSAGE_INVALID",
        "INVALID_ARGUMENT NOT_FINITE",
        "INVALID_ARGUMENT NOT_FINITE",
        "INVALID_ARGUMENT NOT_FINITE",
        "INVALID_ARGUMENT NOT_FINITE",
        "RESOURCE_EXHAUSTED TOO_MANY_AXES",
        "INVALID_ARGUMENT NO_AXES",
        "INVALID_ARGUMENT MESSAGE_INVALID",
        "INVALID_ARGUMENT MESSAGE_INVALID",
        "INVALID_ARGUMENT MESSAGE_INVALID",
        "plan",
    ];
    let said = answers.iter().map(|answer| match answer.get("error") {
        None => {
            assert_eq!(answer["plan"]["certificate"]["passed"], true);
            "plan".to_owned()
        }
        Some(error) => {
            let texts = ["code", "reason", "message"].map(|key| error[key].as_str().unwrap());
            assert!(error["fields"].is_array() && error["metadata"].is_object() && !texts[2].is_empty());
            format!("{} {}", texts[0], texts[1])
        }
    });
    assert_eq!(said.collect::<Vec<_>>(), expected);
    // Lines are counted as an editor does.
    assert!(answers[1]["error"]["message"].as_str().unwrap().starts_with("line 2, column 1: "));
    assert_eq!(answers[2]["error"]["fields"][0]["field"], "axes[0].goal.velocity");
    assert_eq!(answers[10]["error"]["metadata"]["line"], "12");
    assert_eq!(answers[11]["plan"]["axes"][0]["reached"]["position"], -0.1);
}

#[test]
fn a_batch_answers_before_it_is_asked_again() {
    use std::io::{BufRead as _, BufReader};
    let mut child = Command::new(env!("CARGO_BIN_EXE_portamento"))
        .args(["plan", "--batch", "-"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let mut answers = BufReader::new(child.stdout.take().unwrap()).lines();
    for distance in [0.05, 0.1] {
        writeln!(stdin, "{}", request(distance)).unwrap();
        let answer: Value = serde_json::from_str(&answers.next().unwrap().unwrap()).unwrap();
        assert_eq!(answer["plan"]["axes"][0]["reached"]["position"], distance);
    }
    // The reader goes: a quiet end.
    drop(answers);
    for _ in 0..100 {
        if writeln!(stdin, "{}", request(0.05)).is_err() {
            break;
        }
    }
    drop(stdin);
    assert!(child.wait().unwrap().success());
}

#[test]
fn a_plan_verifies_until_somebody_changes_it() {
    let place = place("verify");
    let file = place.join("plan.json");
    plan(&["--distance", "0.05", "--output", text(&file)]).with(0);
    let passed = portamento(&["verify", "--plan", text(&file), "--json"], "").with(0).json();
    assert_eq!(passed["certificate"]["passed"], true);
    assert_eq!(passed["certificate"]["limitChecks"].as_array().unwrap().len(), 3);

    // A PlanResponse will do as well, and standard input.
    let response = plan(&["--distance", "0.05", "--json"]).with(0).out;
    assert!(portamento(&["verify", "--plan", "-"], &response).with(0).out.contains("Certificate: passed"));

    let mut tampered: Value = serde_json::from_str(&std::fs::read_to_string(&file).unwrap()).unwrap();
    tampered["axes"][0]["segments"][2]["jerk"] = json!(-120.0);
    let tampered_file = place.join("tampered.json");
    std::fs::write(&tampered_file, tampered.to_string()).unwrap();
    let failed = portamento(&["verify", "--plan", text(&tampered_file)], "").with(1);
    assert!(failed.out.contains("Certificate: FAILED"), "{}", failed.out);
    assert!(failed.err.contains("fingerprint"), "{}", failed.err);
    let failed = portamento(&["verify", "--plan", text(&tampered_file), "--json"], "").with(1).json();
    assert_eq!(failed["certificate"]["passed"], false);

    let csv = place.join("tampered.csv");
    let args = ["sample", "--plan", text(&tampered_file), "--output", text(&csv)];
    let refused = portamento(&args, "").with(3);
    assert!(refused.err.contains("PLAN_REJECTED"), "{}", refused.err);
    assert!(!csv.exists());

    // Held against limits of somebody else.
    let against = place.join("against.json");
    let slower = json!({"axes": [{"axis": "x",
        "limits": {"maxVelocity": 0.2, "maxAcceleration": 3, "maxJerk": 100}}]});
    std::fs::write(&against, slower.to_string()).unwrap();
    portamento(&["verify", "--plan", text(&file), "--against", text(&against)], "").with(1);
    std::fs::write(&against, request(0.05).to_string()).unwrap();
    portamento(&["verify", "--plan", text(&file), "--against", text(&against)], "").with(0);
    std::fs::write(&against, json!({"axes": [{"axis": "w"}]}).to_string()).unwrap();
    portamento(&["verify", "--plan", text(&file), "--against", text(&against)], "").with(3);
}

#[test]
fn samples_are_those_of_the_digest() {
    let place = place("sample");
    let (file, csv) = (place.join("plan.json"), place.join("plan.csv"));
    plan(&["--distance", "0.4", "--output", text(&file)]).with(0);
    let ran = portamento(&["sample", "--plan", text(&file), "--output", text(&csv)], "").with(0);
    assert_eq!(ran.out, "");
    let csv = std::fs::read_to_string(&csv).unwrap();
    let (header, rows) = csv.split_once('\n').unwrap();
    assert_eq!(header, "cycle,time_s,x.position,x.velocity,x.acceleration,x.jerk");
    let mut digest = proto::Digest::ZERO;
    for (index, row) in rows.lines().enumerate() {
        let fields: Vec<&str> = row.split(',').collect();
        assert_eq!(fields[0], index.to_string());
        assert_eq!(fields[1].parse::<f64>().unwrap(), index as f64 / 1e3);
        let words = std::array::from_fn(|word| fields[2 + word].parse().unwrap());
        if index > 0 {
            digest = digest.then(index as u64, [words]);
        }
    }
    let last = rows.lines().count() - 1;
    let expected = format!("digest {} (0x{digest}) through cycle {last}\n", u64::from(digest));
    assert_eq!(ran.err, expected);
    assert!(rows.lines().last().unwrap().contains(",0.4,0.0,0.0,"), "{}", rows.lines().last().unwrap());

    // The digest begins at cycle 1, wherever printing begins; chunks are lines.
    let args = ["sample", "--plan", text(&file), "--first-cycle", "300"];
    let part = portamento(&args, "").with(0);
    assert_eq!(part.err, expected);
    assert_eq!(part.out.lines().nth(1), rows.lines().nth(300));
    let chunks = portamento(&["sample", "--plan", text(&file), "--json"], "").with(0).lines();
    assert_eq!(chunks[0]["firstCycle"], "0");
    assert_eq!(chunks.last().unwrap()["digest"], u64::from(digest).to_string());
    let args = ["sample", "--plan", text(&file), "--first-cycle", "10", "--cycles", "5"];
    assert_eq!(portamento(&args, "").with(0).out.lines().count(), 6);
    let args = ["sample", "--plan", text(&file), "--first-cycle", "99999"];
    assert!(portamento(&args, "").with(3).err.contains("VALUE_OUT_OF_RANGE"));
}

/// A server on a port of its own, for as long as the test runs.
fn server() -> String {
    let (told, heard) = std::sync::mpsc::channel();
    std::thread::spawn(move || {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
        runtime.block_on(async {
            let server = server::Server::bind(server::Config::loopback()).await.unwrap();
            told.send(format!("http://{}", server.address())).unwrap();
            server.run(std::future::pending()).await.unwrap();
        });
    });
    heard.recv().unwrap()
}

#[test]
fn a_server_gives_the_answers_of_this_process() {
    let endpoint = server();
    let place = place("endpoint");
    let (here, there) = (place.join("here.json"), place.join("there.json"));
    let ask = |args: &[&str], input: &str| {
        let local = portamento(args, input);
        let remote = portamento(&[args, &["--endpoint", &endpoint]].concat(), input);
        assert_eq!((local.code, &local.out, &local.err), (remote.code, &remote.out, &remote.err), "{args:?}");
        local
    };
    let lines: Vec<String> = (0..3000)
        .map(|index| match index % 7 {
            0 => "garbage".to_owned(),
            1 => request(f64::MAX).to_string(),
            _ => request(f64::from(index) / 1e3).to_string(),
        })
        .collect();
    let batch = ask(&["plan", "--batch", "-"], &lines.join("\n")).with(0);
    assert_eq!(batch.out.lines().count(), lines.len());
    let args = [&["plan"], &LIMITS[..], &["--distance", "0.4"]].concat();
    ask(&args, "").with(0);
    ask(&[&args[..], &["--json"]].concat(), "").with(0);
    ask(&[&args[..], &["--end-velocity", "0.3"]].concat(), "").with(3);
    plan(&["--distance", "0.4", "--output", text(&here)]).with(0);
    plan(&["--distance", "0.4", "--output", text(&there), "--endpoint", &endpoint]).with(0);
    assert_eq!(std::fs::read(&here).unwrap(), std::fs::read(&there).unwrap());
    ask(&["verify", "--plan", text(&here)], "").with(0);
    ask(&["verify", "--plan", text(&here), "--json"], "").with(0);
    ask(&["sample", "--plan", text(&here)], "").with(0);
    ask(&["sample", "--plan", text(&here), "--json", "--first-cycle", "1234", "--cycles", "300"], "").with(0);
    ask(&["sample", "--plan", text(&here), "--first-cycle", "99999"], "").with(3);
    let tampered = std::fs::read_to_string(&here).unwrap().replacen("\"jerk\": 100.0", "\"jerk\": 120.0", 1);
    ask(&["verify", "--plan", "-"], &tampered).with(1);
    ask(&["sample", "--plan", "-"], &tampered).with(3);
}

#[test]
fn nobody_at_the_endpoint_is_told() {
    for endpoint in ["http://127.0.0.1:9", "not an address"] {
        let ran = plan(&["--distance", "0.05", "--endpoint", endpoint]).with(4);
        assert!(ran.err.contains("exit code 4") && ran.err.contains("--endpoint"), "{}", ran.err);
    }
}

#[test]
fn a_plot_is_written() {
    let file = place("plot").join("plan.svg");
    plan(&["--distance", "0.05", "--plot", text(&file)]).with(0);
    let svg = std::fs::read_to_string(&file).unwrap();
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"), "{svg}");
}

/// Bui, Le and Doan (2021): five hundred moves solved at 60 digits, under three policies each, all in one run. The
/// tolerances are those of the planner's own test: of the total duration, and of the position.
#[test]
fn a_batch_of_every_reference_move() {
    const DURATION: f64 = 1e-12;
    const POSITION: f64 = 1e-13;
    let vectors = include_str!("../../planner/tests/vectors/eight_type.json");
    let records: Vec<Value> = serde_json::from_str(vectors).unwrap();
    let policies = [("strict", "REJECT"), ("closest", "NEAREST_VELOCITY"), ("paper", "MATCH_START_VELOCITY")];
    let questions: Vec<(&Value, &str, &str)> = records
        .iter()
        .flat_map(|record| policies.map(|(answers, policy)| (record, answers, policy)))
        .collect();
    let lines: Vec<String> = questions
        .iter()
        .map(|(record, _, policy)| {
            json!({
                "axes": [{
                    "axis": "x",
                    "kind": "AXIS_KIND_PRISMATIC",
                    "start": {"velocity": record["v_s"]},
                    "goal": {"position": record["s"], "velocity": record["v_e"]},
                    "limits": {
                        "maxVelocity": record["v_cf"],
                        "maxAcceleration": record["a_max"],
                        "maxJerk": record["j_max"],
                    },
                }],
                "shortPathPolicy": format!("SHORT_PATH_POLICY_{policy}"),
            })
            .to_string()
        })
        .collect();
    let answers = batch(&lines).with(0).lines();
    assert_eq!(answers.len(), questions.len());
    for ((record, answers_of, policy), answer) in questions.iter().zip(&answers) {
        let name = format!("record {} ({policy})", record["id"]);
        let expected = &record[answers_of];
        if expected["feasible"] == false {
            assert_eq!(answer["error"]["reason"], "PATH_TOO_SHORT", "{name}");
            let needed: f64 = answer["error"]["metadata"]["needed"].as_str().unwrap().parse().unwrap();
            let least = record["min_length"].as_f64().unwrap();
            assert!((needed.abs() - least).abs() <= 1e-12 * least, "{name}: {needed} {least}");
            continue;
        }
        let plan = &answer["plan"];
        assert_eq!(plan["certificate"]["passed"], true, "{name}");
        let total = expected["total"].as_f64().unwrap();
        let axis = &plan["axes"][0];
        if expected["times_ambiguous"] == false {
            let duration = plan["duration"].as_f64().unwrap();
            assert!((duration - total).abs() <= DURATION * total, "{name}: {duration} {total}");
            let lasting = |times: Vec<f64>| -> Vec<f64> {
                times.into_iter().filter(|time| *time > DURATION * total).collect()
            };
            let ours = axis["segments"].as_array().unwrap().iter();
            let ours = lasting(ours.map(|segment| segment["duration"].as_f64().unwrap()).collect());
            let theirs = expected["T"].as_array().unwrap().iter();
            let theirs = lasting(theirs.map(|time| time.as_f64().unwrap()).collect());
            assert_eq!(ours.len(), theirs.len(), "{name}: {ours:?} {theirs:?}");
            for (ours, theirs) in ours.iter().zip(&theirs) {
                assert!((ours - theirs).abs() <= DURATION * total, "{name}: {ours} {theirs}");
            }
        }
        if expected["type_ambiguous"] == false && expected["type"] != "0" {
            assert_eq!(axis["classification"]["eightType"], expected["type"], "{name}");
        }
        let (reached, asked) = (axis["reached"]["position"].as_f64(), record["s"].as_f64());
        let (reached, asked) = (reached.unwrap(), asked.unwrap());
        assert!((reached - asked).abs() <= POSITION * asked.abs(), "{name}: {reached} {asked}");
    }
}
