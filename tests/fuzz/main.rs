//! Every decoder and constructor that takes what others send or write, on bytes that nobody meant: it answers or refuses, with a
//! reason and a text, and never panics. Begins with what `corpus/` holds and changes it, for a bounded time.
//!
//! `PORTAMENTO_FUZZ_SECONDS=600 cargo test --release -p e2e --test fuzz` looks for longer, and `PORTAMENTO_FUZZ_SEED=7` elsewhere. What
//! panics is written to `corpus/TARGET/`, so that it stays: commit it with its mending.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail by panicking")]

mod mutate;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use planner::Judged;
use prost::Message as _;
use proto::stream::Watch;
use proto::{Rejected, TraceContext, pb};
use server::session::{Event, Session};

/// How long each target is looked at where nobody says [s].
const SECONDS: f64 = 2.0;
/// Larger inputs only take longer.
const MOST_BYTES: usize = 4096;

#[test]
fn plan_requests() {
    run("plan_request", |bytes| {
        let Ok(wire) = pb::PlanRequest::decode(bytes) else { return };
        // What is planned, is judged, and travels.
        let request = checked(proto::plan_request_from_wire(wire));
        if let Some(judged) = request.and_then(|request| checked(Judged::answer(&request))) {
            let wire = proto::plan_to_wire(&judged);
            assert!(proto::plan_from_wire(wire).is_ok(), "an answer that cannot be read");
        }
    });
}

/// At the server: what is in order is planned, and its answer reads back.
#[test]
fn columns_of_moves() {
    run("columns", |bytes| {
        let Ok(wire) = pb::MoveColumns::decode(bytes) else { return };
        let moves = proto::Moves::from_wire(wire, proto::Detail::Full, |_| Ok(()));
        let Some(mut moves) = checked(moves) else { return };
        let count = moves.len();
        while moves.plan_next().is_some() {}
        let planned =
            proto::PlannedMoves::from_wire(moves.into_wire()).expect("an answer that cannot be read");
        assert_eq!(planned.len(), count);
        for (_, refused) in planned.refusals() {
            checked::<()>(Err(refused));
        }
    });
}

/// At the client: whatever comes is an answer or none, and a plan of it is judged.
#[test]
fn columns_of_plans() {
    let mut asked = proto::MoveColumns::like(e2e::fifty_millimetres());
    asked.goal_position = vec![0.05, 0.1, -0.2];
    run("plan_columns", |bytes| {
        let Ok(wire) = pb::PlanColumns::decode(bytes) else { return };
        let Some(planned) = checked(proto::PlannedMoves::from_wire(wire)) else { return };
        for index in 0..planned.len().min(4) {
            // What a peer says in a refusal of his is his.
            if planned.outcome(index).unwrap().is_err() {
                continue;
            }
            let Some(plan) = checked(planned.plan(index, &asked)) else { continue };
            assert_eq!(plan.plan().sampler().at(1).count(), 1);
        }
        assert!(planned.outcome(planned.len()).is_none());
    });
}

#[test]
fn tables_of_points() {
    run("pvt_request", |bytes| {
        let Ok(wire) = pb::PlanPvtRequest::decode(bytes) else { return };
        let request = checked(proto::pvt_request_from_wire(wire));
        if let Some(request) = request {
            checked(planner::JudgedPvt::answer(&request));
        }
    });
}

#[test]
fn plans_from_outside() {
    run("plan", |bytes| {
        let Ok(wire) = pb::Plan::decode(bytes) else { return };
        let plan = checked(proto::plan_from_wire(wire));
        if let Some(plan) = plan.and_then(|plan| checked(proto::accepted("plan", plan))) {
            // Only what the judge passes is played: a few cycles of it, as many as it has.
            let cycles = plan.plan().cycle_count().min(100);
            assert!(plan.plan().sampler().at(cycles).all(|setpoint| setpoint.state.position.is_finite()));
        }
    });
}

#[test]
fn plans_in_files() {
    run("plan_file", |bytes| {
        let Ok(text) = std::str::from_utf8(bytes) else { return };
        match proto::from_json::<pb::Plan>(text) {
            Ok(wire) => drop(checked(proto::plan_from_wire(wire))),
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    });
}

/// What a commander asks of a stream that is open; twice, as after an answer that got lost.
#[test]
fn operations() {
    let planned = e2e::planned(e2e::fifty_millimetres());
    run("operation", |bytes| {
        let Ok(wire) = pb::Operation::decode(bytes) else { return };
        let mut session = Session::open(e2e::open("cell-7/x", planned.clone()), "fuzz").unwrap();
        for ticket in 1..=2 {
            session.handle(Event::Command { ticket, operation: wire.clone().into() });
            while session.poll_output().is_some() {}
            while let Some(answer) = session.poll_answer() {
                checked(answer.result);
            }
        }
    });
}

#[test]
fn who_looks_on() {
    run("watch", |bytes| {
        let Ok(wire) = pb::WatchStreamRequest::decode(bytes) else { return };
        checked(Watch::try_from(wire));
    });
}

#[test]
fn runs_of_an_axis() {
    run("run_tracking", |bytes| {
        let Ok(wire) = pb::RunTrackingRequest::decode(bytes) else { return };
        checked(sim_axis::track_request(wire, &sim_axis::Models::default()));
    });
}

#[test]
fn trace_contexts() {
    run("traceparent", |bytes| {
        let Ok(text) = std::str::from_utf8(bytes) else { return };
        match text.parse::<TraceContext>() {
            Ok(trace) => assert_eq!(trace.to_string(), text),
            Err(error) => assert!(error.to_string().len() < 512),
        }
    });
}

#[test]
fn what_an_axis_says() {
    run("from_axis", |bytes| {
        let Ok(wire) = pb::StreamSetpointsRequest::decode(bytes) else { return };
        checked(proto::request_from_wire(wire));
    });
}

#[test]
fn what_a_server_says() {
    run("to_axis", |bytes| {
        let Ok(wire) = pb::StreamSetpointsResponse::decode(bytes) else { return };
        if let Err(error) = proto::response_from_wire(wire) {
            assert!(!error.to_string().is_empty());
        }
    });
}

#[test]
fn refusals() {
    run("refusal", |bytes| {
        if let Some(rejected) = Rejected::from_bytes(bytes) {
            let again = Rejected::from_bytes(&rejected.to_bytes());
            assert_eq!(again.as_ref(), Some(&rejected), "a refusal that does not read back");
            drop(tonic::Status::from(rejected));
        }
    });
}

#[test]
fn models_in_files() {
    run("models", |bytes| {
        let Ok(text) = std::str::from_utf8(bytes) else { return };
        if let Err(error) = sim_axis::models_from_json(text) {
            assert!(!error.to_string().is_empty());
        }
    });
}

#[test]
fn policies() {
    run("policy", |bytes| {
        let Ok(text) = std::str::from_utf8(bytes) else { return };
        match serving::Policy::parse(text) {
            Ok(policy) => drop(policy.allows_method("spiffe://plant/cell-7/x", "a/B")),
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    });
}

#[test]
fn settings_in_files() {
    run("settings", |bytes| {
        let Ok(text) = std::str::from_utf8(bytes) else { return };
        let mut misfits = serving::Misfits::default();
        let command = serving::with_settings(clap_command(), text, "file", &mut misfits);
        for misfit in misfits.as_slice() {
            assert!(!misfit.setting.is_empty() && !misfit.problem.is_empty(), "{misfit:?}");
        }
        // Whatever the file says, flags are read, or the values that are none of them.
        drop(command.try_get_matches_from(["portamento"]));
    });
}

fn clap_command() -> clap::Command {
    use clap::Args as _;
    serving::Flags::augment_args(clap::Command::new("portamento"))
}

/// What was answered; a refusal has to say something.
#[track_caller]
fn checked<T>(answered: Result<T, impl Into<Rejected>>) -> Option<T> {
    match answered {
        Ok(answer) => Some(answer),
        Err(refused) => {
            let rejected = refused.into();
            assert!(!rejected.message.is_empty(), "{rejected:?} says nothing");
            for field in &rejected.fields {
                assert!(!field.field.is_empty() && !field.description.is_empty(), "{field:?}");
            }
            let status = tonic::Status::from(rejected.clone());
            assert_eq!(status.code(), rejected.reason.code());
            None
        }
    }
}

/// Gives `target` every input of its corpus, and what becomes of them.
fn run(name: &str, target: impl Fn(&[u8])) {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(name);
    let mut corpus = read(&directory);
    assert!(!corpus.is_empty(), "{} holds nothing to begin with", directory.display());
    let give = |bytes: &[u8]| {
        if catch_unwind(AssertUnwindSafe(|| target(bytes))).is_err() {
            let path = directory.join(format!("found-{:016x}", hash(bytes)));
            std::fs::write(&path, bytes).unwrap();
            panic!("{name} fails on {}", path.display());
        }
    };
    corpus.iter().for_each(|bytes| give(bytes));
    let seed = std::env::var("PORTAMENTO_FUZZ_SEED").ok().and_then(|seed| seed.parse().ok()).unwrap_or(1);
    let seconds = std::env::var("PORTAMENTO_FUZZ_SECONDS").ok().and_then(|text| text.parse().ok());
    let until = Instant::now() + Duration::from_secs_f64(seconds.unwrap_or(SECONDS));
    let mut random = fastrand::Rng::with_seed(seed);
    let mut tried = 0_u64;
    while Instant::now() < until {
        let bytes = mutate::from(&corpus, MOST_BYTES, &mut random);
        give(&bytes);
        tried += 1;
        // Some become a beginning themselves, so that changes add up.
        if tried.is_multiple_of(64) && corpus.len() < 512 {
            corpus.push(bytes);
        }
    }
    eprintln!("{name}: {tried} inputs, seed {seed}");
}

fn read(directory: &Path) -> Vec<Vec<u8>> {
    let entries = std::fs::read_dir(directory).into_iter().flatten();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths.into_iter().map(|path| std::fs::read(path).unwrap()).collect()
}

/// FNV-1a: names only have to differ.
fn hash(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3))
}

/// Writes the beginnings: good messages of every kind. `cargo test -p e2e --test fuzz -- --ignored corpus`.
#[test]
#[ignore = "writes the corpus"]
fn corpus() {
    use e2e::{fifty_millimetres, planned};
    let write = |target: &str, name: &str, bytes: &[u8]| {
        let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(target);
        std::fs::create_dir_all(&directory).unwrap();
        std::fs::write(directory.join(name), bytes).unwrap();
    };
    let request = pb::PlanRequest::from(fifty_millimetres());
    write("plan_request", "one-axis", &request.encode_to_vec());
    let mut several = request.clone();
    several.axes.push(pb::AxisMove { axis: "y".into(), ..several.axes[0].clone() });
    several.synchronization = pb::Synchronization::Time as i32;
    write("plan_request", "two-in-time", &several.encode_to_vec());
    for (name, family) in [
        ("polynomial", pb::ProfileFamily::Polynomial),
        ("trapezoidal", pb::ProfileFamily::Trapezoidal),
        ("trigonometric", pb::ProfileFamily::Trigonometric),
    ] {
        let request = pb::PlanRequest { family: family as i32, ..request.clone() };
        write("plan_request", name, &request.encode_to_vec());
    }
    for (name, family) in [
        ("s-curve", planner::Family::SCurve),
        ("trapezoidal", planner::Family::Trapezoidal),
        ("trigonometric", planner::Family::Trigonometric),
        ("polynomial", planner::Family::Polynomial),
    ] {
        let mut like = fifty_millimetres();
        (like.family, like.order) = (Ok(family), (family == planner::Family::Polynomial).then_some(4));
        like.axes[0].limits.max_snap = Some(6000.0);
        let mut columns = proto::MoveColumns::like(like);
        columns.goal_position = vec![0.05, 0.1, f64::NAN];
        columns.max_velocity = vec![0.25, 0.5, 0.1];
        columns.feed_rate = vec![0.2, 0.6, 0.1];
        let wire = pb::MoveColumns::from(columns);
        write("columns", name, &wire.encode_to_vec());
        let mut moves = proto::Moves::from_wire(wire, proto::Detail::Full, |_| Ok(())).unwrap();
        while moves.plan_next().is_some() {}
        write("plan_columns", name, &moves.into_wire().encode_to_vec());
    }
    let points = pb::PlanPvtRequest {
        axes: vec![pb::PvtAxis {
            axis: "x".into(),
            kind: pb::AxisKind::Prismatic as i32,
            start: Some(pb::AxisState::default()),
            limits: request.axes[0].limits.clone(),
            times: vec![0.5, 1.0, 1.5],
            positions: vec![0.01, 0.02, 0.03],
            velocities: vec![0.02, 0.02, 0.0],
        }],
        ..Default::default()
    };
    write("pvt_request", "three-points", &points.encode_to_vec());
    let plan = planned(fifty_millimetres());
    let wire = proto::plan_to_wire(plan.judged());
    write("plan", "fifty-millimetres", &wire.encode_to_vec());
    write("plan_file", "fifty-millimetres.json", proto::to_json_pretty(&wire).unwrap().as_bytes());
    let open = proto::request_to_wire(&proto::stream::FromAxis::Open(Box::new(e2e::open("x", plan))));
    write("from_axis", "open", &open.encode_to_vec());
    let report =
        pb::AxisReport { executed_cycle: 10, accepted_cycle: 50, grant_cycle: 50, ..Default::default() };
    let report =
        pb::StreamSetpointsRequest { message: Some(pb::stream_setpoints_request::Message::Report(report)) };
    write("from_axis", "report", &report.encode_to_vec());
    let operation = pb::Operation {
        request_id: "1".into(),
        not_before_cycle: Some(7),
        operation: Some(pb::operation::Operation::SetOverride(pb::SetOverride { factor: 0.5 })),
    };
    let operation = pb::StreamSetpointsRequest {
        message: Some(pb::stream_setpoints_request::Message::Operation(operation)),
    };
    write("from_axis", "override", &operation.encode_to_vec());
    let motion = pb::Motion {
        plan: Some(wire),
        override_factor: 1.0,
        phase: pb::Phase::Moving as i32,
        ..Default::default()
    };
    let opened = pb::Opened { motion: Some(motion), first_cycle: 1, served_by: "a".into(), current_epoch: 1 };
    let opened = pb::StreamSetpointsResponse {
        epoch: 1,
        message: Some(pb::stream_setpoints_response::Message::Opened(Box::new(opened))),
    };
    write("to_axis", "opened", &opened.encode_to_vec());
    let columns = pb::SetpointColumns {
        cycles: 2,
        position: vec![0.0, 0.1],
        velocity: vec![0.0, 0.1],
        acceleration: vec![0.0, 0.1],
        jerk: vec![0.0, 0.1],
    };
    let batch = pb::SetpointBatch { first_cycle: 1, columns: Some(columns), ..Default::default() };
    let batch = pb::StreamSetpointsResponse {
        epoch: 1,
        message: Some(pb::stream_setpoints_response::Message::Batch(batch)),
    };
    write("to_axis", "batch", &batch.encode_to_vec());
    let rejected = Rejected::for_field("axes[0].kind", proto::Reason::KindUnspecified, "is not set: say one")
        .with("given", 7)
        .retry_after(Duration::from_millis(100));
    write("refusal", "field", &rejected.to_bytes());
    let model = r#"[{"axis":"x","mechanics":{"twoMass":{"motorInertia":1,"loadInertia":1,"stiffness":1000,"damping":1}},"servo":{"positionGain":50}}]"#;
    write("models", "two-mass.json", model.as_bytes());
    write("policy", "deploy.toml", include_bytes!("../../deploy/config/policy.toml"));
    write("settings", "deploy.toml", include_bytes!("../../deploy/kubernetes/settings/server.toml"));
    write(
        "settings",
        "every-shape.toml",
        b"a = 1\nmax_connections = [\"x\", \"y\"]\nlog = 1.5\nreflection = true\n",
    );
}
