//! Many requests at once: an answer a line, whatever the line is.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::float_cmp,
    clippy::panic,
    missing_docs,
    reason = "a test may fail by panicking"
)]

mod common;
#[allow(dead_code, reason = "the planner's own tests take the rest")]
#[path = "../../planner/tests/common/vectors.rs"]
mod vectors;

use std::io::Write as _;
use std::process::{Command, Stdio};

use common::{Ran, portamento, request};
use serde_json::{Value, json};

/// `portamento plan --batch`, line by line.
fn batch(lines: &[String]) -> Ran {
    portamento(&["plan", "--batch", "-"], lines.join("\n"))
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

/// However lines end, and whatever is in them: a line of input that is not blank has a line of output, in order.
#[test]
fn lines_are_counted_as_an_editor_does() {
    let good = request(0.05).to_string();
    let long = format!("{}{good}", " ".repeat(10 << 20));
    let plan = "plan";
    let unread = "MESSAGE_INVALID";
    /// What it is, what is read, and what is answered: a reason and the line that it names.
    type Row<'a> = (&'a str, Vec<u8>, Vec<(&'a str, &'a str)>);
    let rows: Vec<Row<'_>> = vec![
        ("nothing", vec![], vec![]),
        ("blank lines alone", b"\n\r\n  \t\n\n".to_vec(), vec![]),
        ("no newline at the end", good.clone().into(), vec![(plan, "")]),
        ("a newline at the end", format!("{good}\n").into(), vec![(plan, "")]),
        ("CRLF", format!("{good}\r\n\r\n{{\r\n{good}").into(), vec![(plan, ""), (unread, "3"), (plan, "")]),
        ("ten megabytes", format!("{long}\n{good}\n").into(), vec![("MESSAGE_TOO_LARGE", "1"), (plan, "")]),
        ("ten megabytes, unended", long.clone().into(), vec![("MESSAGE_TOO_LARGE", "1")]),
        ("two on a line", format!("{good}{good}\n{good}").into(), vec![(unread, "1"), (plan, "")]),
        ("cut short", format!("\n{good}\n{}", &good[..40]).into(), vec![(plan, ""), (unread, "3")]),
        (
            "not UTF-8",
            [b"\xff\xfe{}\n".as_slice(), good.as_bytes()].concat(),
            vec![(unread, "1"), (plan, "")],
        ),
        ("a field of no message", b"{\"axes\": [{\"knd\": 1}]}".to_vec(), vec![(unread, "1")]),
        ("a name of no choice", b"{\"family\": \"S_CURVE\"}".to_vec(), vec![(unread, "1")]),
        ("a text for a number", b"{\"order\": \"three\"}".to_vec(), vec![(unread, "1")]),
        ("nesting without end", vec![b'['; 1 << 20], vec![(unread, "1")]),
        ("a request of nothing", b"{}".to_vec(), vec![("NO_AXES", "")]),
    ];
    for (name, input, expected) in rows {
        let answers = portamento(&["plan", "--batch", "-"], input).with(0).lines();
        let said: Vec<(&str, &str)> = answers
            .iter()
            .map(|answer| match answer.get("error") {
                None => (plan, ""),
                Some(error) => {
                    let line = error["metadata"]["line"].as_str().unwrap_or_default();
                    let message = error["message"].as_str().unwrap();
                    assert!(
                        line.is_empty() || message.starts_with(&format!("line {line}")),
                        "{name}: {message}"
                    );
                    (error["reason"].as_str().unwrap(), line)
                }
            })
            .collect();
        assert_eq!(said, expected, "{name}");
    }
}

/// Programs rely on every key, and on texts for values.
#[test]
fn an_error_has_one_form() {
    let mut short = request(0.002);
    short["axes"][0]["goal"]["velocity"] = json!(0.25);
    let answers = batch(&[short.to_string(), "{]".into()]).with(0).lines();
    let [given, needed, nearest] =
        ["given", "needed", "nearest"].map(|key| answers[0]["error"]["metadata"][key].clone());
    // D = v/2·(v/a + a/j) from rest to 0.25 m/s.
    let least = 0.125 * (0.25 / 3.0 + 0.03);
    assert!((needed.as_str().unwrap().parse::<f64>().unwrap() - least).abs() < 1e-15, "{needed}");
    assert!(nearest.as_str().unwrap().parse::<f64>().unwrap() < 0.25, "{nearest}");
    let text = |value: &Value| value.as_str().unwrap().to_owned();
    let description = format!(
        "the path of {} is too short to change from the start to the end velocity, which needs {}: lengthen it, end at a \
         velocity of {}, or name a short_path_policy",
        text(&given),
        text(&needed),
        text(&nearest)
    );
    let field = "axes[0].goal.velocity";
    let expected = json!({"error": {
        "code": "FAILED_PRECONDITION",
        "reason": "PATH_TOO_SHORT",
        "message": format!("{field}: {description}"),
        "fields": [{"field": field, "reason": "PATH_TOO_SHORT", "description": description}],
        "metadata": {"given": "0.002", "needed": needed, "nearest": nearest},
    }});
    assert_eq!(answers[0], expected);
    let expected = json!({"error": {
        "code": "INVALID_ARGUMENT",
        "reason": "MESSAGE_INVALID",
        "message": "line 2, column 2: key must be a string: give one PlanRequest in proto3 JSON a line",
        "fields": [],
        "metadata": {"line": "2"},
    }});
    assert_eq!(answers[1], expected);
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

/// Numbers drawn to hurt, always the same ones.
struct Draw(u64);

impl Draw {
    /// SplitMix64: Steele, Lea and Flood (2014).
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    fn below(&mut self, end: u64) -> u64 {
        self.bits() % end
    }

    fn one_in(&mut self, many: u64) -> bool {
        self.below(many) == 0
    }

    /// From 0 to 1.
    fn part(&mut self) -> f64 {
        self.bits() as f64 / u64::MAX as f64
    }

    fn of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len() as u64) as usize]
    }

    /// A magnitude between 10^-decades and 10^decades: round, or with every digit it can have.
    fn magnitude(&mut self, decades: f64) -> f64 {
        let exponent = (2.0 * self.part() - 1.0) * decades;
        if self.one_in(3) { 10f64.powi(exponent as i32) } else { 10f64.powf(exponent) }
    }

    /// A share of a limit: none, all, all but a rounding, nearly none, or anything.
    fn share(&mut self) -> f64 {
        let anything = self.part();
        self.of(&[0.0, 0.0, 1.0, 1.0 - f64::EPSILON, 1e-9, anything, anything, anything])
    }

    fn axis(&mut self, name: usize, decades: f64, family: &str) -> Value {
        let unit = self.magnitude(decades);
        let [velocity, acceleration, jerk] = [0; 3].map(|_| unit * self.magnitude(3.0));
        // From far below what the limits take notice of to far above.
        let natural = velocity * velocity / acceleration + acceleration.powi(3) / (jerk * jerk);
        let distance = if self.one_in(20) { 0.0 } else { natural * self.magnitude(6.0) };
        let sign = self.of(&[1.0, -1.0]);
        let from = self.of(&[0.0, 0.0, 1.0, -1e3, 1e6]) * distance;
        let mut limits = json!({"maxVelocity": velocity, "maxAcceleration": acceleration, "maxJerk": jerk});
        let mut optional = |key: &str, value: f64, wanted: bool| {
            if wanted {
                limits[key] = json!(value);
            }
        };
        optional("maxDeceleration", acceleration * self.magnitude(2.0), self.one_in(2));
        let reverse = if self.one_in(6) { 0.0 } else { velocity * self.part() };
        optional("maxVelocityReverse", reverse, self.one_in(6));
        optional("feedRate", velocity * self.magnitude(1.0), self.one_in(6));
        optional("maxPosition", from.max(from + sign * distance) + self.part() * distance, self.one_in(6));
        optional("minPosition", from.min(from + sign * distance), self.one_in(6));
        optional("maxSnap", unit * self.magnitude(4.0), family == "POLYNOMIAL" && !self.one_in(30));
        if family == "POLYNOMIAL" {
            limits["maxHigherDerivatives"] = json!([0; 4].map(|_| unit * self.magnitude(4.0)));
        }
        let moving = matches!(family, "S_CURVE" | "TRAPEZOIDAL");
        let mut speed = || {
            let against = if self.one_in(40) { -1.0 } else { 1.0 };
            if moving { against * sign * velocity * self.share() } else { 0.0 }
        };
        let (start, end) = (speed(), speed());
        json!({
            "axis": format!("a{name}"),
            "kind": format!("AXIS_KIND_{}", self.of(&["PRISMATIC", "REVOLUTE", "PULSES"])),
            "start": {"position": from, "velocity": start},
            "goal": {"position": from + sign * distance, "velocity": end},
            "limits": limits,
        })
    }

    fn request(&mut self) -> Value {
        let family =
            self.of(&["S_CURVE", "S_CURVE", "S_CURVE", "TRAPEZOIDAL", "POLYNOMIAL", "TRIGONOMETRIC"]);
        let decades = self.of(&[0.0, 3.0, 9.0]);
        let axes = if self.one_in(10) { 3 } else { 1 };
        let mut request = json!({
            "axes": (0..axes).map(|name| self.axis(name, decades, family)).collect::<Vec<_>>(),
            "family": format!("PROFILE_FAMILY_{family}"),
            "synchronization": "SYNCHRONIZATION_NONE",
            "shortPathPolicy": format!(
                "SHORT_PATH_POLICY_{}",
                self.of(&["REJECT", "NEAREST_VELOCITY", "MATCH_START_VELOCITY", "REVERSE"])
            ),
            "cycleTime": self.of(&["0.00001s", "0.001s", "0.000250s", "1s"]),
        });
        if family == "POLYNOMIAL" {
            request["order"] = json!(2 + self.below(7));
        }
        request
    }
}

/// Two thousand requests through the tool itself; every plan that comes back is held against itself, judged anew, and
/// compared with what was asked; everything else has a reason that is one.
#[test]
fn what_is_planned_passes_and_what_is_not_has_a_reason() {
    const SEED: u64 = 2026;
    let mut draw = Draw(SEED);
    let requests: Vec<Value> = (0..2000).map(|_| draw.request()).collect();
    let lines: Vec<String> = requests.iter().map(Value::to_string).collect();
    let ran = batch(&lines).with(0);
    let answers: Vec<&str> = ran.out.lines().collect();
    assert_eq!(answers.len(), requests.len());
    let mut planned = 0;
    for (request, answer) in requests.iter().zip(answers) {
        if let Ok(response) = proto::from_json::<proto::pb::PlanResponse>(answer) {
            planned += 1;
            holds(request, response.plan.unwrap());
        } else {
            has_a_reason(request, &serde_json::from_str::<Value>(answer).unwrap()["error"]);
        }
    }
    assert!(planned > 1200, "only {planned} were planned");
}

#[track_caller]
fn holds(request: &Value, wire: proto::pb::Plan) {
    let stated = wire.certificate.clone().unwrap();
    let plan = proto::plan_from_wire(wire).unwrap_or_else(|why| panic!("{request}: {why}"));
    let judged = planner::Judged::new(plan);
    assert!(stated.passed, "{request}: {:?}", judged.certificate());
    assert_eq!(proto::pb::PlanCertificate::from(judged.certificate()), stated, "{request}");
    let accepted = judged.accepted().unwrap_or_else(|why| panic!("{request}: {why}"));
    for (asked, axis) in request["axes"].as_array().unwrap().iter().zip(accepted.plan().axes()) {
        let [start, goal] = ["start", "goal"].map(|end| {
            let part = |name: &str| asked[end][name].as_f64().unwrap_or_default();
            planner::State { position: part("position"), velocity: part("velocity"), acceleration: 0.0 }
        });
        let begins = planner::State { acceleration: 0.0, ..axis.profile.start() };
        // Where there is no way to go, the plan is the end state alone.
        if !axis.profile.segments().is_empty() {
            assert_eq!(begins, start, "{request}");
        }
        assert_eq!((axis.goal, axis.goal_to_reach()), (goal, axis.profile.end()), "{request}");
        assert_eq!(axis.profile.end().position, goal.position, "{request}");
        let rejecting = request["shortPathPolicy"] == "SHORT_PATH_POLICY_REJECT";
        if rejecting {
            assert_eq!(axis.profile.end(), goal, "{request}");
        }
    }
}

#[track_caller]
fn has_a_reason(request: &Value, error: &Value) {
    let reason = error["reason"].as_str().unwrap();
    let field = error["fields"][0]["field"].as_str().unwrap_or_default();
    let policy = &request["shortPathPolicy"];
    let expected = match reason {
        "PATH_TOO_SHORT" => policy == "SHORT_PATH_POLICY_REJECT" && error["metadata"]["nearest"].is_string(),
        // Trapezoids against the travel or back on a path too short, several axes at speed: nothing else is left out.
        "NOT_IMPLEMENTED" => field.ends_with(".velocity"),
        "START_OUTSIDE_LIMITS" | "GOAL_OUTSIDE_LIMITS" => error["metadata"]["needed"].is_string(),
        "POSITION_LIMIT" => error["metadata"]["needed"].is_string(),
        "TOO_MANY_CYCLES" => field.starts_with("axes"),
        "FIELD_MISSING" => field.ends_with("max_snap"),
        _ => false,
    };
    assert!(expected, "{request}: {error}");
}

fn request_of(record: &vectors::Record) -> String {
    let (start, goal) = (record.start(), record.goal());
    let state = |state: planner::State| json!({"position": state.position, "velocity": state.velocity, "acceleration": state.acceleration});
    json!({
        "shortPathPolicy": "SHORT_PATH_POLICY_REVERSE",
        "axes": [{
            "axis": "x",
            "kind": "AXIS_KIND_PRISMATIC",
            "start": state(start),
            "goal": state(goal),
            "limits": {
                "maxVelocity": record.vmax,
                "maxVelocityReverse": -record.vmin,
                "maxAcceleration": record.amax,
                "maxJerk": record.jmax,
            },
        }],
    })
    .to_string()
}

/// 2286 questions with the durations of Ruckig 0.19.4: all that a limit on acceleration can ask, the same up and down.
#[test]
fn states_are_answered_no_later_than_by_the_peer() {
    let records: Vec<_> =
        vectors::records().into_iter().filter(|record| record.amax == -record.amin).collect();
    let lines: Vec<_> = records.iter().map(request_of).collect();
    let answers = batch(&lines).with(0).lines();
    assert_eq!((answers.len(), records.len()), (2286, 2286));
    for (record, answer) in records.iter().zip(answers) {
        let plan = &answer["plan"];
        assert_eq!(plan["certificate"]["passed"], json!(true), "{}: {answer}", request_of(record));
        let ours = plan["duration"].as_f64().unwrap();
        let theirs = record.duration.unwrap_or(f64::INFINITY);
        assert!(
            ours <= theirs * (1.0 + 1e-9),
            "{}: {ours} s, and the peer takes {theirs}",
            request_of(record)
        );
    }
}
