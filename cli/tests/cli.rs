//! The command-line tool as its users meet it: what it prints, and what it ends with.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::float_cmp,
    clippy::panic,
    missing_docs,
    reason = "a test may fail by panicking"
)]

mod common;

use std::path::{Path, PathBuf};

use common::{Ran, portamento, request};
use serde_json::{Value, json};

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

#[test]
fn help_teaches() {
    for command in [
        "", "demo", "init", "plan", "pvt", "compare", "verify", "diff", "sample", "track", "command",
        "watch", "replay", "grade", "bench", "explain",
    ] {
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
    let long_name = "a name that is longer than any table has room for";
    let rows: [&[&str]; 11] = [
        &["--distance", "1e-12"],
        &["--distance", "-1e6", "--axis", long_name],
        &["--distance", "0.123456789", "--from", "-1234.56789", "--kind", "revolute"],
        &["--distance", "0.333", "--start-velocity", "0.1", "--max-position", "7", "--kind", "pulses"],
        &["--distance", "0.05", "--from", "-1e9", "--kind", "pulses"],
        &["--distance", "123456.789012345", "--max-deceleration", "1.23456789e-7", "--kind", "pulses"],
        &["--distance", "1e-31", "--from", "1e-29", "--start-velocity", "1e-25", "--axis", long_name],
        &["--distance", "-3.3e11", "--from", "1.1e12", "--axis", long_name, "--kind", "pulses"],
        &["--distance", "1e11", "--feed-rate", "1e9", "--end-velocity", "0.123456789"],
        &["--distance", "1e3", "--family", "trapezoidal", "--start-velocity", "1.23456789e-9"],
        &["--distance", "1e-7", "--family", "polynomial", "--order", "4", "--max-snap", "123456.789"],
    ];
    for row in rows {
        let out = plan(row).with(0).out;
        let table = out.lines().filter(|line| !line.starts_with("Axis a name"));
        let longest = table.map(|line| line.chars().count()).max();
        assert!(longest <= Some(80), "{longest:?}:\n{out}");
    }
}

/// What lasts is not shown as lasting nothing, and what moves not as standing.
#[test]
fn tables_keep_their_digits() {
    let far = plan(&["--distance", "0.05", "--from", "1e6"]).with(0).out;
    assert!(far.contains("1000000.0005"), "{far}");
    let long = plan(&["--distance", "1e6"]).with(0).out;
    for digits in ["0.05333", "0.01417", "jerk for 0.03 s at\n  4000000 s", "4000000114 cycles"] {
        assert!(long.contains(digits), "{digits}: {long}");
    }
    let short = plan(&["--distance", "1e-12"]).with(0).out;
    assert!(short.starts_with("6.84e-5 s, 1 cycle of 1 ms;") && short.contains("1.71e-5"), "{short}");
}

#[test]
fn without_a_way_an_axis_stands_or_passes() {
    let still = plan(&["--distance", "0"]).with(0).out;
    assert!(still.contains("Axis x, prismatic: stands still\n"), "{still}");
    for speed in ["0.125", "-0.125"] {
        let [start, end] = ["start", "end"].map(|end| format!("--{end}-velocity={speed}"));
        let args = ["--distance", "0", &start, &end];
        let passing = plan(&args).with(0).out;
        assert!(passing.contains(&format!("no way to go, passes at {speed} m/s\n")), "{passing}");
        let json = plan(&[&args[..], &["--json"]].concat()).with(0).json();
        let check = &json["plan"]["certificate"]["limitChecks"][0];
        assert_eq!(
            (&check["extremum"], &check["margin"]),
            (&json!(speed.parse::<f64>().unwrap()), &json!(0.5))
        );
        assert_eq!(json["plan"]["axes"][0]["classification"]["feedRate"], 0.125);
    }
}

#[test]
fn colours_are_for_terminals() {
    assert!(!plan(&["--distance", "0.05"]).with(0).out.contains('\x1b'));
    let plain = plan(&["--distance", "0.05"]).with(0).out;
    let painted = plan(&["--distance", "0.05", "--color", "always"]).with(0).out;
    assert!(painted.contains("\x1b[1m"));
    // Nothing but emphasis differs: lines break where they do without.
    let bare: Vec<_> = painted
        .split('\x1b')
        .enumerate()
        .map(|(index, part)| match part.split_once('m') {
            Some((_, rest)) if index > 0 => rest,
            _ => part,
        })
        .collect();
    assert_eq!(bare.concat(), plain);
    // Nor does a name steer a terminal.
    assert!(!plan(&["--distance", "0.05", "--axis", "\x1b[31m"]).with(3).err.contains('\x1b'));
}

#[test]
fn exit_codes_tell_why() {
    let rows: [(&[&str], i32); 18] = [
        (&["demo", "--endpoint", "http://127.0.0.1:1"], 2),
        (
            &[
                "plan",
                "--from",
                "1e20",
                "--distance",
                "1",
                "--max-velocity",
                "1",
                "--max-acceleration",
                "1",
                "--max-jerk",
                "1",
            ],
            2,
        ),
        (&["plan"], 2),
        (&["plan", "--request", "-", "--endpoint", "foo bar"], 2),
        (&["plan", "--request", "-", "--endpoint", "localhost:50051"], 2),
        (&["plan", "--request", "-", "--endpoint", "ftp://cell:50051"], 2),
        (&["plan", "--request", "-", "--plot", "x.png"], 2),
        (&["demo", "--plot", "demo.pdf"], 2),
        (&["track", "--plan", "-", "--planner", "http://"], 2),
        (&["track", "--plan", "-", "--plot", "track"], 2),
        (&["plan", "--distance", "0.05", "--max-velocity", "fast"], 2),
        (&["plan", "--distance", "1", "--batch", "-"], 2),
        (&["plan", "--request", "/nowhere/request.json"], 2),
        (&["verify", "--plan", "/nowhere/plan.json"], 2),
        (&["explain", "NO_SUCH_REASON"], 2),
        (&["explain", "path_too_short"], 0),
        (&["explain", "path-too-short"], 0),
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
    portamento(&["plan", "--request", "-"], request(f64::MAX).to_string()).with(3);
    portamento(&["plan", "--request", "-"], request(0.05).to_string()).with(0);
    // With the mark of its encoding that some editors put first.
    portamento(&["plan", "--request", "-"], format!("\u{feff}{}", request(0.05))).with(0);
    let batch = portamento(&["plan", "--batch", "-"], format!("\u{feff}{}", request(0.05))).with(0);
    assert!(batch.lines()[0].get("error").is_none(), "{}", batch.out);
}

/// From full motion past the goal and back, and from beyond the limits, which the judge says.
#[test]
fn any_states_are_shown() {
    let reverse = ["--short-path", "reverse", "--start-acceleration", "2"];
    let past = plan(&[&["--distance", "0.01", "--start-velocity", "0.2"], &reverse[..]].concat()).with(0);
    let beyond = plan(&["--distance", "0.2", "--start-velocity", "0.4", "--end-acceleration=-1"]).with(0);
    insta::assert_snapshot!("past", unversioned(&past.out));
    insta::assert_snapshot!("led_back", unversioned(&beyond.out));
    let refused = plan(&["--distance", "0.2", "--end-acceleration", "4"]).with(3);
    assert!(refused.err.contains("--end-acceleration: is 4, beyond 3"), "{}", refused.err);
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
    tampered["cycleCount"] = json!(300);
    tampered["fingerprint"] = json!("");
    let tampered_file = place.join("tampered.json");
    std::fs::write(&tampered_file, tampered.to_string()).unwrap();
    let failed = portamento(&["verify", "--plan", text(&tampered_file)], "").with(1);
    insta::assert_snapshot!("tampered", failed.out + &failed.err);
    tampered["cycleCount"] = json!(0);
    let failed = portamento(&["verify", "--plan", "-", "--json"], tampered.to_string()).with(1).json();
    assert_eq!(failed["certificate"]["passed"], false);

    let csv = place.join("tampered.csv");
    let args = ["sample", "--plan", text(&tampered_file), "--output", text(&csv)];
    let refused = portamento(&args, "").with(3);
    assert!(refused.err.contains("PLAN_REJECTED"), "{}", refused.err);
    assert!(!csv.exists());

    // What a plan says of itself, one lie each; programs get the field.
    let good: Value = serde_json::from_str(&std::fs::read_to_string(&file).unwrap()).unwrap();
    let lies = [
        ("cycleCount", json!("313"), "cycle_count"),
        ("duration", json!(0.25), "duration"),
        ("fingerprint", json!("AAAA"), "fingerprint"),
        ("guaranteed", json!(["QUANTITY_VELOCITY"]), "guaranteed"),
        ("method", json!({"family": "PROFILE_FAMILY_TRAPEZOIDAL", "order": 2}), "method.family"),
    ];
    for (key, value, field) in lies {
        let mut lying = good.clone();
        lying[key] = value;
        let lying = lying.to_string();
        let shown = portamento(&["verify", "--plan", "-"], &lying).with(1);
        assert!(
            shown.out.contains("not what it says of itself") && shown.out.contains(field),
            "{}",
            shown.out
        );
        let error = portamento(&["verify", "--plan", "-", "--json"], &lying).with(1).json();
        assert_eq!(
            (&error["error"]["reason"], &error["error"]["fields"][0]["field"]),
            (&json!("PLAN_REJECTED"), &json!(field))
        );
        let refused = portamento(&["sample", "--plan", "-"], &lying).with(3);
        assert!(refused.out.is_empty() && refused.err.contains(field), "{}", refused.err);
    }

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
            told.send(server.address().endpoint()).unwrap();
            server.run(std::future::pending()).await.unwrap();
        });
    });
    heard.recv().unwrap()
}

#[test]
fn a_link_is_graded() {
    let endpoint = server();
    let args = ["grade", "--endpoint", &endpoint, "--time", "1s"];
    let shown = portamento(&args, "").with(0).out;
    for part in
        ["round trip", "arrival gap", "wakes up late by", "opens a stream in", "up to", "lead", "guard"]
    {
        assert!(shown.contains(part), "{shown}");
    }
    assert!(shown.lines().all(|line| line.chars().count() <= 80), "{shown}");
    let told = portamento(&[&args[..], &["--json"]].concat(), "").with(0).out;
    let told: serde_json::Value = serde_json::from_str(&told).unwrap();
    let lead = told["leadCycles"].as_u64().unwrap();
    assert!((10..=250).contains(&lead) && told["axisGuard"].as_u64().unwrap() >= 1, "{told}");
    assert!(told["roundTrip"]["count"].as_u64().unwrap() > 50, "{told}");
    assert_eq!(told["lateness"]["count"], 1000, "a cycle of one millisecond each");
    assert!(told["roundTrip"]["worst"].as_f64() >= told["roundTrip"]["median"].as_f64(), "{told}");

    let refused = portamento(&["grade", "--time", "10ms"], "").with(2).err;
    assert!(refused.contains("1s to 1h"), "{refused}");
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
    // Nobody at a socket is said as nobody at a port is.
    plan(&["--distance", "0.05", "--endpoint", "unix:/nowhere/portamento.sock"]).with(4);
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
    for endpoint in ["http://127.0.0.1:9", "http://[::1]:9/"] {
        let ran = plan(&["--distance", "0.05", "--endpoint", endpoint]).with(4);
        assert!(ran.err.contains("exit code 4") && ran.err.contains("--endpoint"), "{}", ran.err);
    }
}

/// As in the README, but as fast as it computes.
#[test]
fn the_demo_is_played_and_drawn() {
    let file = place("demo").join("demo.svg");
    let out = portamento(&["demo", "--virtual-time", "--plot", text(&file)], "").with(0).out;
    let longest =
        out.lines().filter(|line| !line.starts_with("Drawn in ")).map(|line| line.chars().count()).max();
    assert!(longest <= Some(80), "{longest:?}:\n{out}");
    for part in ["with 3 operations, no underrun", "the digest is that of a replay", "Drawn in "] {
        assert!(out.contains(part), "{part}: {out}");
    }
    // A row of the comparison for every family.
    for family in ["s-curve", "trapezoidal", "polynomial:4", "polynomial:5", "trigonometric"] {
        let rows = out.lines().filter(|line| line.split_whitespace().next() == Some(family)).count();
        assert!(rows >= 1, "{family}: {out}");
    }
    assert!(std::fs::read_to_string(&file).unwrap().starts_with("<svg"));
}

#[test]
fn a_plot_is_written() {
    let file = place("plot").join("plan.svg");
    plan(&["--distance", "0.05", "--plot", text(&file)]).with(0);
    let svg = std::fs::read_to_string(&file).unwrap();
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"), "{svg}");
}

/// The move of Nguyen, Ng and Chen (2008), section 4: 50 mm at 60 mm/s. Their other limits are not known; with these every
/// limit is reached.
const PAPERS_MOVE: [&str; 8] =
    ["--distance", "0.05", "--max-velocity", "0.06", "--max-acceleration", "0.6", "--max-jerk", "12"];

fn compare(args: &[&str]) -> Ran {
    portamento(&[&["compare"], args].concat(), "")
}

#[test]
fn families_are_compared_on_one_axis() {
    let plot = place("compare").join("families.svg");
    let shown = compare(&[&PAPERS_MOVE[..], &["--plot", text(&plot)]].concat()).with(0).out;
    insta::assert_snapshot!("compared", shown);
    let svg = std::fs::read_to_string(plot).unwrap();
    for part in ["Velocity [m/s]", "Following error [µm]", "Load error [", "s-curve", "polynomial:5"] {
        assert!(svg.contains(part), "{part}");
    }
}

/// What the paper found, figures 8 and 10: the higher the order the smaller the error, and cosines as good as order five.
#[test]
fn the_papers_finding_holds_on_the_linear_motor() {
    let answer = compare(&[&PAPERS_MOVE[..], &["--json"]].concat()).with(0).json();
    let moves = answer["moves"].as_array().unwrap();
    let names: Vec<&str> = moves.iter().map(|one| one["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["s-curve", "polynomial:4", "polynomial:5", "trigonometric"]);
    for what in ["maxFollowingError", "rmsFollowingError", "maxLoadError", "residualVibrationAmplitude"] {
        let values: Vec<f64> = moves.iter().map(|one| one[what].as_f64().unwrap()).collect();
        assert!(values[0] > values[1] && values[1] > values[2], "{what}: {values:?}");
        assert!(values[3] <= values[2] * 1.05, "{what}: {values:?}");
    }
    // Snap 2·12²/0.6 and crackle 2·480²/12, which nobody gave, are said.
    let chosen: Vec<(u64, f64)> = answer["chosenLimits"]
        .as_array()
        .unwrap()
        .iter()
        .map(|one| (one["order"].as_u64().unwrap(), one["limit"].as_f64().unwrap()))
        .collect();
    assert_eq!(chosen, [(4, 480.0), (5, 38_400.0)]);
    let given = ["--max-snap", "480", "--families", "polynomial:4", "--json"];
    let given = compare(&[&PAPERS_MOVE[..], &given].concat()).with(0).json();
    assert_eq!(given["chosenLimits"], json!([]));
    assert_eq!(given["moves"][0], moves[1]);
}

/// A move that ends at speed has its closing stop here as on a stream: nothing is brought to rest at once.
#[test]
fn what_ends_at_speed_is_stopped_within_its_limits() {
    let at_speed =
        compare(&[&PAPERS_MOVE[..], &["--end-velocity", "0.05", "--families", "s-curve", "--json"]].concat());
    let at_rest = compare(&[&PAPERS_MOVE[..], &["--families", "s-curve", "--json"]].concat()).with(0).json();
    let (at_speed, at_rest) = (at_speed.with(0).json()["moves"][0].clone(), at_rest["moves"][0].clone());
    for what in ["maxFollowingError", "residualVibrationAmplitude", "maxEffort"] {
        let [one, other] = [&at_speed, &at_rest].map(|one| one[what].as_f64().unwrap());
        assert!(one < 2.0 * other, "{what}: {one} beside {other} from rest to rest");
    }
}

/// What is derived from a jump is an impulse, and what is derived from that is no less.
#[test]
fn no_derivative_above_a_jump_is_said_to_be_bounded() {
    let higher = ["--max-snap", "1", "--max-higher-derivatives", "1", "1"];
    let answer = plan(&[&["--distance", "0.05", "--json"], &higher[..]].concat()).with(0).json();
    let checks = answer["plan"]["certificate"]["limitChecks"].as_array().unwrap();
    for quantity in ["QUANTITY_SNAP", "QUANTITY_CRACKLE", "QUANTITY_POP"] {
        let check = checks.iter().find(|check| check["quantity"] == quantity).unwrap();
        assert_eq!(
            (&check["extremum"], &check["guaranteed"]),
            (&json!("Infinity"), &json!(false)),
            "{check}"
        );
    }
}

/// Metres, radians and pulses: the same numbers make the same swing on the machine of their kind, but for what its encoder resolves.
#[test]
fn every_kind_of_axis_is_followed_by_a_machine_of_its_kind() {
    let of = |kind: &str, scale: f64, more: &[&str]| {
        let numbers = [0.05, 0.06, 0.6, 12.0].map(|number| (number * scale).to_string());
        let flags = ["--distance", "--max-velocity", "--max-acceleration", "--max-jerk"];
        let mut args: Vec<&str> =
            flags.iter().zip(&numbers).flat_map(|(flag, number)| [*flag, number.as_str()]).collect();
        args.extend(["--kind", kind, "--json"]);
        args.extend(more);
        compare(&args).with(0).json()["moves"].clone()
    };
    let metres = of("prismatic", 1.0, &[]);
    let rows = [
        (of("revolute", 1.0, &[]), 1.0),
        (of("pulses", 1e6, &[]), 1e6),
        (of("pulses", 2e4, &["--pulses-per-metre", "2e4"]), 2e4),
    ];
    for (moves, scale) in rows {
        for (index, one) in metres.as_array().unwrap().iter().enumerate() {
            for what in
                ["maxFollowingError", "rmsFollowingError", "maxLoadError", "residualVibrationAmplitude"]
            {
                let [ours, theirs] = [one, &moves[index]].map(|one| one[what].as_f64().unwrap());
                // The table is read to a tenth of a microradian, the slide to a hundredth of a micrometre.
                let allowed = 0.02 * ours + 1e-7;
                assert!(
                    (theirs / scale - ours).abs() <= allowed,
                    "{index} {what}: {ours} {}",
                    theirs / scale
                );
            }
            assert_eq!(moves[index]["effortSaturatedTime"], 0.0);
        }
    }
    let words = |kind: &str| {
        compare(&[&PAPERS_MOVE[..], &["--kind", kind]].concat()).with(0).out.replace("\n  ", " ")
    };
    assert!(words("prismatic").contains("A linear motor of 6 kg"), "{}", words("prismatic"));
    assert!(words("revolute").contains("A torque motor of 0.12 kg m²"), "{}", words("revolute"));
    assert!(words("pulses").contains("one pulse is 1e-6 m."), "{}", words("pulses"));
    let bad = compare(&[&PAPERS_MOVE[..], &["--settle-tolerance", "NaN"]].concat()).with(2);
    assert!(bad.err.contains("--settle-tolerance is NaN"), "{}", bad.err);
    let lost = compare(&[&PAPERS_MOVE[..], &["--pulses-per-metre", "100"]].concat()).with(2);
    assert!(lost.err.contains("--kind pulses"), "{}", lost.err);
}

/// A motor at the end of its effort says more of the motor than of the family.
#[test]
fn a_motor_too_weak_for_the_move_is_told_of() {
    let brisk =
        ["--distance", "0.5", "--max-velocity", "2", "--max-acceleration", "25", "--max-jerk", "2000"];
    let shown = compare(&brisk).with(0).out.replace("\n  ", " ");
    assert!(shown.contains("The drive wanted more than the 150 N of the motor: s-curve for "), "{shown}");
    let moves = compare(&[&brisk[..], &["--json"]].concat()).with(0).json()["moves"].clone();
    let saturated = moves[0]["effortSaturatedTime"].as_f64().unwrap();
    assert!(saturated > 0.01 && moves[0]["maxEffort"].as_f64().unwrap() <= 150.0, "{moves}");
    let shown = compare(&PAPERS_MOVE).with(0).out;
    assert!(!shown.contains("The drive wanted"), "{shown}");
}

/// Families that have one limit for speeding up and slowing down say which of two they keep to.
#[test]
fn the_smaller_limit_of_both_is_not_taken_without_a_word() {
    let unlike = [&PAPERS_MOVE[..], &["--max-deceleration", "0.3"]].concat();
    let plan = |more: &[&str]| {
        let args = [&["plan"], &unlike[..], more].concat();
        portamento(&args, "").with(0).out.replace("\n  ", " ")
    };
    let said = "within the smaller limit of both: 0.3 m/s² of deceleration, not 0.6 m/s² of acceleration.";
    let families: [(&[&str], bool); 4] = [
        (&["--family", "polynomial", "--order", "4", "--max-snap", "480"], true),
        (&["--family", "trigonometric"], true),
        (&["--family", "trapezoidal"], false),
        (&[], false),
    ];
    for (family, expected) in families {
        let shown = plan(family);
        assert_eq!(shown.contains(said), expected, "{shown}");
    }
    let shown = compare(&unlike).with(0).out.replace("\n  ", " ");
    let said = "both (0.3 m/s² of deceleration, not 0.6 m/s² of acceleration): polynomial:4, polynomial:5, trigonometric.";
    assert!(shown.contains(said), "{shown}");
    let shown = compare(&PAPERS_MOVE).with(0).out;
    assert!(!shown.contains("smaller limit"), "{shown}");
}

/// What is wrong is said in the words that were typed; programs get the fields and names of the schema.
#[test]
fn refusals_name_what_was_typed() {
    let rows: [(&str, &[&str], &str); 9] = [
        ("plan", &["--start-velocity", "NaN"], "--start-velocity: is NaN"),
        ("plan", &["--axis", ""], "--axis: is empty"),
        (
            "plan",
            &["--from", "NaN"],
            "error: NOT_FINITE: --from: is NaN: give a finite number of at most 1e60 in magnitude. (exit",
        ),
        (
            "plan",
            &[
                "--family",
                "polynomial",
                "--order",
                "6",
                "--max-snap",
                "480",
                "--max-higher-derivatives",
                "1",
                "NaN",
            ],
            "--max-higher-derivatives, value 2: is NaN",
        ),
        (
            "plan",
            &["--family", "polynomial", "--order", "7", "--max-snap", "480", "--max-higher-derivatives", "1"],
            "--max-higher-derivatives: has 1 limit, and order 7 needs 3",
        ),
        (
            "plan",
            &["--family", "trigonometric", "--end-velocity", "0.01"],
            "the family trigonometric goes from rest to rest, so give 0 or choose s-curve",
        ),
        ("plan", &["--family", "trigonometric", "--order", "4"], "leave it out or choose polynomial"),
        ("compare", &["--families", "s-curve,polynomial:40"], "--families polynomial:40: asks for order 40"),
        (
            "compare",
            &["--families", "trigonometric", "--start-velocity", "0.01"],
            "--start-velocity: is 0.01",
        ),
    ];
    for (command, args, said) in rows {
        let args = [&[command], &PAPERS_MOVE[..], args].concat();
        let words = portamento(&args, "").with(3).err.replace('\n', " ");
        assert!(words.contains(said), "{words}");
        assert!(!words.contains("axes[0]"), "{words}");
        let json = portamento(&[&args[..], &["--json"]].concat(), "").with(3).json();
        assert!(!json.to_string().contains("--"), "{json}");
    }
}

#[test]
fn requests_from_files_are_compared() {
    let place = place("compare");
    let write = |name: &str, request: Value| {
        let path = place.join(name);
        std::fs::write(&path, request.to_string()).unwrap();
        path
    };
    let mut cosine = request(0.05);
    cosine["family"] = json!("PROFILE_FAMILY_TRIGONOMETRIC");
    let mut turning = request(0.05);
    turning["axes"][0]["kind"] = json!("AXIS_KIND_REVOLUTE");
    let (plain, cosine, turning) =
        (write("plain.json", request(0.05)), write("cosine.json", cosine), write("turning.json", turning));
    let answer = compare(&["--request", text(&plain), text(&cosine), "--json"]).with(0).json();
    assert_eq!(
        (&answer["moves"][0]["name"], &answer["moves"][1]["family"]),
        (&json!("plain"), &json!("TRIGONOMETRIC"))
    );
    let other = compare(&["--request", text(&plain), text(&turning)]).with(2);
    assert!(other.err.contains("of different kinds"), "{}", other.err);
    // On another axis: one that follows ideally.
    let model = place.join("ideal.json");
    std::fs::write(&model, "[{\"mechanics\": {\"ideal\": {}}}]").unwrap();
    let ideal = compare(&["--request", text(&plain), "--model", text(&model), "--json"]).with(0).json();
    assert_eq!(ideal["moves"][0]["maxFollowingError"], 0.0);
    std::fs::write(&model, "[{\"noiseSeed\": \"x\"}]").unwrap();
    let bad = compare(&["--request", text(&plain), "--model", text(&model)]).with(2);
    assert!(bad.err.contains("is not an AxisModel"), "{}", bad.err);
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let rows: [(&[&str], i32, &str); 5] = [
        (&["--families", "polynomial"], 2, "polynomial:4"),
        (&["--families", "cubic"], 2, "trigonometric"),
        (&["--families", "s-curve:4"], 2, "only a polynomial"),
        (&["--families", "polynomial:9"], 3, "ORDER_UNSUPPORTED"),
        (&["--families", "trigonometric", "--end-velocity", "0.01"], 3, "STATE_NOT_AT_REST"),
    ];
    for (args, code, word) in rows {
        let ran = compare(&[&PAPERS_MOVE[..], args].concat()).with(code);
        assert!(ran.err.contains(word), "{}", ran.err);
    }
    // Days of motion are not simulated behind anybody's back.
    let long =
        ["--distance", "1e6", "--max-velocity", "0.25", "--max-acceleration", "3", "--max-jerk", "100"];
    let ran = compare(&long).with(3);
    assert!(ran.err.contains("TOO_MANY_CYCLES") && ran.err.contains("600000"), "{}", ran.err);
}

/// Which axis sets the pace, in words and in the figure; of axes that wait for a clock none does.
#[test]
fn several_axes_say_who_sets_the_pace() {
    let axis = |name: &str, far: f64| {
        json!({"axis": name, "kind": "AXIS_KIND_PRISMATIC", "goal": {"position": far},
            "start": {"velocity": far, "acceleration": 5.0 * far},
            "limits": {"maxVelocity": 0.25, "maxAcceleration": 3, "maxJerk": 100}})
    };
    let ask = |synchronization: &str, minimum: &str| {
        let request = json!({"synchronization": synchronization, "minimumDuration": minimum,
            "axes": [axis("x", 0.05), axis("y", 0.1)]});
        portamento(&["plan", "--request", "-"], request.to_string())
            .with(0)
            .out
            .lines()
            .nth(1)
            .unwrap()
            .to_owned()
    };
    let rows = [
        ("SYNCHRONIZATION_NONE", "0s", "Axis y takes longest."),
        ("SYNCHRONIZATION_TIME", "0s", "All axes arrive together, as soon as axis y can."),
        (
            "SYNCHRONIZATION_PHASE",
            "0s",
            "All axes keep to one line, and arrive as soon as that allows; axis y holds it",
        ),
        (
            "SYNCHRONIZATION_TIME",
            "2s",
            "All axes arrive together, later than they could: as late as was asked for.",
        ),
    ];
    for (synchronization, minimum, said) in rows {
        assert_eq!(ask(synchronization, minimum), said, "{synchronization}, {minimum}");
    }
}

#[test]
fn order_two_needs_no_jerk() {
    let limits = ["--distance", "0.05", "--max-velocity", "0.25", "--max-acceleration", "3", "--json"];
    let plan = |family: &str| portamento(&[&["plan", "--family", family], &limits[..]].concat(), "");
    let planned = plan("trapezoidal").with(0).json();
    assert_eq!(planned["plan"]["axes"][0]["limits"]["maxJerk"], 3000.0);
    let refused = plan("s-curve").with(2);
    assert!(refused.err.contains("--max-jerk is missing"), "{}", refused.err);
}
