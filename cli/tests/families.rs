//! Every record of the reference vectors as a request, through `portamento plan --batch`: durations, pieces, names and samples of the
//! answers hold to what a double can meet.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp,
    missing_docs,
    reason = "a test may fail by panicking"
)]

use std::io::Write as _;
use std::process::{Command, Stdio};

use serde_json::{Map, Value, json};

/// Of the total duration [1].
const DURATION: f64 = 1e-12;
/// Of the distance [1].
const POSITION: f64 = 1e-13;
/// Of the peak of a derivative [1].
const DERIVATIVE: f64 = 1e-11;

/// A request, and what the answer is to be.
struct Row {
    name: String,
    request: Value,
    distance: f64,
    total: f64,
    /// Of the pieces, of which some are zero.
    durations: Vec<f64>,
    /// How far position and each derivative go, from the speed on; of the last of them there is no sample.
    peaks: Vec<f64>,
    /// Time, position, velocity, acceleration ...
    samples: Vec<Vec<f64>>,
    /// A name in the classification, unless the result jumps beside the record.
    named: Option<(&'static str, String)>,
}

fn records(text: &str) -> Vec<Value> {
    serde_json::from_str(text).unwrap()
}

fn number(record: &Value, field: &str) -> f64 {
    record[field].as_f64().unwrap_or_else(|| panic!("{field} of {record}"))
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

fn direction(record: &Value) -> f64 {
    record.get("dir").and_then(Value::as_f64).unwrap_or(1.0)
}

fn ambiguous(record: &Value) -> bool {
    let set = |flag: &str| record.get(flag).and_then(Value::as_bool).unwrap_or(false);
    set("type_ambiguous") || set("times_ambiguous")
}

/// A move from rest at zero.
fn request(family: &str, distance: f64, limits: &Map<String, Value>) -> Value {
    json!({
        "family": format!("PROFILE_FAMILY_{family}"),
        "axes": [{"axis": "x", "kind": "AXIS_KIND_PULSES", "goal": {"position": distance}, "limits": limits}],
    })
}

fn limits(fields: &[(&str, f64)]) -> Map<String, Value> {
    fields.iter().map(|(name, value)| ((*name).to_owned(), json!(value))).collect()
}

fn samples(record: &Value) -> Vec<Vec<f64>> {
    record["samples"].as_array().unwrap().iter().map(numbers).collect()
}

/// The pieces of Nguyen, Ng and Chen's template, of which piece k holds derivative n − (zeros at the end of k in binary) for `holds` of it.
fn template(holds: &[f64]) -> Vec<f64> {
    (1..1usize << holds.len()).map(|k| holds[holds.len() - 1 - k.trailing_zeros() as usize]).collect()
}

/// Orders 2 to 8. A limit that every axis has and that order 2 does not use is far away.
fn polynomial() -> Vec<Row> {
    let mut records = records(include_str!("../../planner/tests/vectors/polynomial.json"));
    records.extend(self::records(include_str!("../../planner/tests/vectors/polynomial_high.json")));
    let row = |record: &Value| {
        let bounds = numbers(&record["X"]);
        let order = record["n"].as_u64().unwrap();
        let jerk = bounds.get(3).copied().unwrap_or(1e50);
        let mut limits =
            limits(&[("maxVelocity", bounds[1]), ("maxAcceleration", bounds[2]), ("maxJerk", jerk)]);
        if let Some(snap) = bounds.get(4) {
            limits.insert("maxSnap".into(), json!(snap));
        }
        if bounds.len() > 5 {
            limits.insert("maxHigherDerivatives".into(), json!(bounds[5..]));
        }
        let mut request = request("POLYNOMIAL", bounds[0], &limits);
        request["order"] = json!(order);
        Row {
            name: format!("polynomial {}", record["id"]),
            request,
            distance: bounds[0],
            total: number(record, "total"),
            durations: template(&numbers(&record["T"])),
            peaks: numbers(&record["peaks"])[1..].to_vec(),
            samples: samples(record),
            named: None,
        }
    };
    records.iter().map(row).collect()
}

fn trigonometric() -> Vec<Row> {
    let records = records(include_str!("../../planner/tests/vectors/trigonometric.json"));
    let row = |record: &Value| {
        let limits = limits(&[
            ("maxVelocity", number(record, "v_max")),
            ("maxAcceleration", number(record, "a_max")),
            ("maxJerk", number(record, "j_peak")),
        ]);
        Row {
            name: format!("trigonometric {}", record["id"]),
            request: request("TRIGONOMETRIC", number(record, "s"), &limits),
            distance: number(record, "s"),
            total: number(record, "total"),
            durations: numbers(&record["T"]),
            peaks: vec![
                number(record, "v_peak"),
                number(record, "a_peak"),
                number(record, "j_peak"),
                std::f64::consts::PI * number(record, "j_peak") / number(record, "t_J"),
            ],
            samples: samples(record),
            named: Some(("sixCase", pointed(record))),
        }
    };
    records.iter().map(row).collect()
}

/// The records leave the point out: `C1` is `C.1`.
fn pointed(record: &Value) -> String {
    let mut name = record["case"].as_str().unwrap().to_owned();
    if name.len() == 2 {
        name.insert(1, '.');
    }
    name
}

fn asymmetric() -> Vec<Row> {
    let mut all = records(include_str!("../../planner/tests/vectors/asymmetric_paper.json"));
    all.extend(records(include_str!("../../planner/tests/vectors/asymmetric.json")));
    let row = |record: &Value| {
        let limits = limits(&[
            ("maxVelocity", number(record, "v_max")),
            ("maxAcceleration", number(record, "a_max")),
            ("maxDeceleration", number(record, "d_max")),
            ("maxJerk", number(record, "j_max")),
        ]);
        let distance = signed(record, "L");
        Row {
            name: format!("asymmetric {}", record["id"]),
            request: request("S_CURVE", distance, &limits),
            distance,
            total: number(record, "total"),
            durations: numbers(&record["T"]),
            peaks: vec![
                number(record, "v_peak").abs(),
                number(record, "a_max").max(number(record, "d_max")),
                number(record, "j_max"),
            ],
            samples: samples(record),
            named: (!ambiguous(record)).then(|| ("asymmetricType", record["type"].to_string())),
        }
    };
    all.iter().map(row).collect()
}

/// Some records have the sign in the distance, some beside it.
fn signed(record: &Value, field: &str) -> f64 {
    direction(record) * number(record, field).abs()
}

fn six_case() -> Vec<Row> {
    let mut all = records(include_str!("../../planner/tests/vectors/six_case_paper.json"));
    all.extend(records(include_str!("../../planner/tests/vectors/six_case.json")));
    let row = |record: &Value| {
        let limits = limits(&[
            ("maxVelocity", number(record, "v_max")),
            ("maxAcceleration", number(record, "a_max")),
            ("maxJerk", number(record, "j_max")),
        ]);
        let distance = signed(record, "s");
        Row {
            name: format!("six case {}", record["id"]),
            request: request("S_CURVE", distance, &limits),
            distance,
            total: number(record, "total"),
            durations: numbers(&record["T"]),
            peaks: vec![number(record, "v_peak").abs(), number(record, "a_max"), number(record, "j_max")],
            samples: samples(record),
            named: (!ambiguous(record)).then(|| ("sixCase", pointed(record))),
        }
    };
    all.iter().map(row).collect()
}

/// Those whose end velocity can be kept.
fn eight_type() -> Vec<Row> {
    let mut all = records(include_str!("../../planner/tests/vectors/eight_type_table2.json"));
    all.extend(records(include_str!("../../planner/tests/vectors/eight_type.json")));
    let row = |record: &Value| {
        let strict = &record["strict"];
        if strict["feasible"] != true || ambiguous(strict) {
            return None;
        }
        let limits = limits(&[
            ("maxVelocity", number(record, "v_cf").abs()),
            ("maxAcceleration", number(record, "a_max")),
            ("maxJerk", number(record, "j_max")),
        ]);
        let distance = number(record, "s");
        let mut request = request("S_CURVE", distance, &limits);
        request["axes"][0]["start"] = json!({"velocity": record["v_s"]});
        request["axes"][0]["goal"]["velocity"] = record["v_e"].clone();
        Some(Row {
            name: format!("eight type {}", record["id"]),
            request,
            distance,
            total: number(strict, "total"),
            durations: numbers(&strict["T"]),
            peaks: vec![number(strict, "v_peak").abs(), number(record, "a_max"), number(record, "j_max")],
            samples: samples(strict),
            named: Some(("eightType", strict["type"].as_str().unwrap().to_owned())),
        })
    };
    all.iter().filter_map(row).collect()
}

fn answers(rows: &[Row]) -> Vec<String> {
    let mut child = Command::new(env!("CARGO_BIN_EXE_portamento"))
        .args(["plan", "--batch", "-"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let lines: Vec<String> = rows.iter().map(|row| row.request.to_string()).collect();
    let feeding = std::thread::spawn(move || stdin.write_all(lines.join("\n").as_bytes()).unwrap());
    let output = child.wait_with_output().unwrap();
    feeding.join().unwrap();
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).unwrap();
    text.lines().map(str::to_owned).collect()
}

fn check(row: &Row, line: &str) {
    let Row { name, request, distance, total, durations, peaks, samples, named } = row;
    let answer: Value = serde_json::from_str(line).unwrap();
    let plan = &answer["plan"];
    assert!(plan.is_object(), "{name}: {answer} to {request}");
    let close = |what: &str, ours: f64, expected: f64, tolerance: f64| {
        let off = (ours - expected).abs();
        assert!(off <= tolerance, "{name}: {what} {ours} is {off:e} from {expected}, allowed {tolerance:e}");
    };
    assert_eq!(plan["certificate"]["passed"], true, "{name}");
    close("duration", number(plan, "duration"), *total, DURATION * total);
    let axis = &plan["axes"][0];
    assert_eq!(axis["reached"]["position"], json!(distance), "{name}");
    assert!(axis["adjustments"].as_array().is_none_or(Vec::is_empty), "{name}");
    close("peak", number(&axis["classification"], "feedRate"), peaks[0], DERIVATIVE * peaks[0]);
    let lasting = |durations: &[f64]| -> Vec<f64> {
        durations.iter().copied().filter(|&duration| duration > DURATION * total).collect()
    };
    let pieces = axis["segments"].as_array().unwrap();
    let ours: Vec<f64> = pieces.iter().map(|piece| number(piece, "duration")).collect();
    let (ours, expected) = (lasting(&ours), lasting(durations));
    assert_eq!(ours.len(), expected.len(), "{name}: {ours:?} {expected:?}");
    for (ours, expected) in ours.iter().zip(expected) {
        close("piece", *ours, expected, DURATION * total);
    }
    assert!(!samples.is_empty(), "{name}");
    let wire = proto::from_json::<proto::pb::PlanResponse>(line).unwrap().plan.unwrap();
    let read = proto::plan_from_wire(wire).unwrap();
    let profile = &read.axes()[0].profile;
    for sample in samples {
        let (t, expected) = (sample[0], &sample[1..]);
        let (begin, piece) = profile.timed_segments().take_while(|(begin, _)| *begin <= t).last().unwrap();
        let ours = piece.derivatives(t - begin);
        for (order, (ours, expected)) in ours.iter().zip(expected).enumerate() {
            let allowed = match order {
                0 => POSITION * distance.abs(),
                order => DERIVATIVE * peaks[order - 1],
            };
            // A rounding of the time is worth as much as the next derivative.
            let late = peaks.get(order).map_or(0.0, |next| 4.0 * f64::EPSILON * t * next);
            close(&format!("derivative {order} at {t}"), *ours, *expected, allowed + late);
        }
    }
    if let Some((method, expected)) = named {
        assert_eq!(axis["classification"][method], json!(expected), "{name}");
    }
}

fn hold(rows: &[Row], at_least: usize) {
    assert!(rows.len() >= at_least, "{}", rows.len());
    let answers = answers(rows);
    assert_eq!(answers.len(), rows.len());
    for (row, answer) in rows.iter().zip(&answers) {
        check(row, answer);
    }
}

#[test]
fn polynomials_of_the_vectors() {
    hold(&polynomial(), 173);
}

#[test]
fn cosines_of_the_vectors() {
    hold(&trigonometric(), 100);
}

#[test]
fn asymmetric_moves_of_the_vectors() {
    hold(&asymmetric(), 250);
}

#[test]
fn six_cases_of_the_vectors() {
    hold(&six_case(), 250);
}

#[test]
fn eight_types_of_the_vectors() {
    hold(&eight_type(), 300);
}
