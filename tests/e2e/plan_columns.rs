//! Many moves in columns: what `Plan` says of each, in its place.

use client::Error;
use e2e::{Loopback, fifty_millimetres};
use planner::{Family, Judged, RequestSpec, ShortPathPolicy, State};
use proto::{Detail, MoveColumns, PlannedMoves, Reason, Rejected, pb};
use server::{Config, Limits};
use tonic::Status;

/// Numbers in −1..1 that look random.
fn drawn(count: usize, seed: f64) -> Vec<f64> {
    (0..count).map(|index| ((index as f64 + seed) * 12.9898).sin()).collect()
}

/// Moves of a family, with and without speeds, some of which cannot be.
fn columns(family: Family, count: usize) -> MoveColumns {
    let like = RequestSpec {
        family: Ok(family),
        order: (family == Family::Polynomial).then_some(5),
        short_path: Ok(ShortPathPolicy::NearestVelocity),
        ..fifty_millimetres()
    };
    let mut columns = MoveColumns::like(like);
    if family == Family::Polynomial {
        let limits = &mut columns.like.axes[0].limits;
        (limits.max_snap, limits.max_higher_derivatives) = (Some(4000.0), vec![2e5]);
    }
    columns.start_position = drawn(count, 0.1);
    columns.goal_position = drawn(count, 0.2);
    columns.max_velocity = drawn(count, 0.3).iter().map(|share| 0.3 + 0.2 * share).collect();
    columns.max_deceleration = drawn(count, 0.4).iter().map(|share| 3.0 + share).collect();
    let travel = columns.start_position.iter().zip(&columns.goal_position).map(|(from, to)| to - from);
    match family {
        Family::SCurve => {
            columns.start_velocity = drawn(count, 0.5).iter().map(|share| 0.12 * share).collect()
        }
        // A trapezoid does not turn.
        Family::Trapezoidal => {
            columns.start_velocity = travel.map(|travel| 0.05f64.copysign(travel)).collect()
        }
        Family::Polynomial | Family::Trigonometric => {}
    }
    if family == Family::SCurve {
        columns.start_acceleration = drawn(count, 0.6).iter().map(|share| share.max(0.0)).collect();
        columns.feed_rate = drawn(count, 0.8).iter().map(|share| 0.4 + 0.3 * share).collect();
    }
    columns.goal_position[3] = f64::NAN;
    columns.max_velocity[5] = -1.0;
    columns.max_deceleration[5] = 0.0;
    // Nothing to go.
    columns.goal_position[7] = columns.start_position[7];
    columns
}

fn message(columns: impl Into<pb::MoveColumns>) -> pb::PlanManyRequest {
    pb::PlanManyRequest { columns: Some(columns.into()), ..Default::default() }
}

/// The answers to `messages`, up to the status that ends them.
async fn asked(
    server: &Loopback,
    messages: Vec<pb::PlanManyRequest>,
) -> (Vec<pb::PlanColumns>, Option<Status>) {
    let mut planner = server.planner().await;
    let mut answers = planner.plan_many(tokio_stream::iter(messages)).await.unwrap().into_inner();
    let mut all = Vec::new();
    loop {
        match answers.message().await {
            Ok(Some(answer)) => all.extend(answer.columns),
            Ok(None) => return (all, None),
            Err(status) => return (all, Some(status)),
        }
    }
}

#[track_caller]
fn reason(status: Option<&Status>) -> Rejected {
    let status = status.expect("a refusal");
    Rejected::from_status(status).unwrap_or_else(|| panic!("no reason in {status:?}"))
}

/// What `Plan` answers, move by move: the same bits of every piece, the same names and adjustments, the same refusals but for where the number stands.
#[tokio::test]
async fn every_move_is_what_plan_says_of_it() {
    let server = Loopback::start().await;
    let client = server.client().await;
    for family in [Family::SCurve, Family::Trapezoidal, Family::Trigonometric, Family::Polynomial] {
        let columns = columns(family, 200);
        let mut parts = Vec::new();
        for detail in [Detail::Full, Detail::Motion] {
            let all = client.plan_columns(&columns, detail).await.unwrap();
            let [moves] = all.try_into().unwrap();
            parts.push(moves);
        }
        let mut counts = [0; 2];
        for index in 0..columns.len() {
            let alone = client.plan(columns.request(index)).await;
            for moves in &parts {
                check(family, &columns, moves, index, alone.clone());
            }
            counts[usize::from(alone.is_err())] += 1;
        }
        assert!(counts[0] > 150 && counts[1] >= 2, "{family:?}: {counts:?}");
        assert_eq!(parts[0].refusals().count(), counts[1]);
        // What is not told is not sent.
        let [full, motion] = [&parts[0], &parts[1]].map(|moves| moves.outcome(0).unwrap().unwrap());
        assert_eq!(full.position.len(), full.segment_duration.len());
        assert_eq!((motion.position, motion.velocity), (&[][..], &[][..]));
        assert_eq!(motion.acceleration.is_empty(), family != Family::Trapezoidal);
    }
}

#[track_caller]
fn check(
    family: Family,
    columns: &MoveColumns,
    moves: &PlannedMoves,
    index: usize,
    alone: Result<Judged, Error>,
) {
    match (moves.plan(index, columns), alone) {
        (Ok(accepted), Ok(alone)) => {
            assert_eq!(*accepted.judged(), alone, "{family:?} {index}");
            let bits = |judged: &Judged| format!("{:?}", judged.plan().axes());
            assert_eq!(bits(accepted.judged()), bits(&alone));
            let told = moves.outcome(index).unwrap().unwrap();
            assert_eq!(told.duration.to_bits(), alone.plan().duration().to_bits());
            assert_eq!(told.cycle_count, alone.plan().cycle_count());
        }
        (Err(refused), Err(Error::Rejected(alone))) => {
            let place = |rejected: &Rejected| -> Vec<_> {
                rejected.fields.iter().map(|field| (field.reason, field.description.clone())).collect()
            };
            assert_eq!((refused.reason, &refused.metadata), (alone.reason, &alone.metadata));
            assert_eq!(place(&refused), place(&alone), "{family:?} {index}");
            assert_eq!(moves.durations()[index], 0.0);
            let fields: Vec<&str> = refused.fields.iter().map(|field| field.field.as_str()).collect();
            match index {
                3 => assert_eq!(fields, ["columns.goal_position[3]"]),
                5 => assert_eq!(fields, ["columns.max_velocity[5]", "columns.max_deceleration[5]"]),
                _ => assert!(fields.iter().all(|field| field.starts_with("columns.")), "{fields:?}"),
            }
        }
        (one, other) => panic!("{family:?} {index}: {one:?} and {other:?}"),
    }
}

/// Where the planner here would not make the same, as another version may not, the plan is what came: an ulp is kept.
#[tokio::test]
async fn a_plan_of_another_planner_is_made_of_what_came() {
    let server = Loopback::start().await;
    for family in [Family::SCurve, Family::Trapezoidal, Family::Trigonometric, Family::Polynomial] {
        let columns = columns(family, 20);
        for detail in [Detail::Full, Detail::Motion] {
            let asked_for = pb::PlanManyRequest { detail: detail.to_wire(), ..message(columns.clone()) };
            let (mut answers, end) = asked(&server, vec![asked_for]).await;
            assert!(end.is_none(), "{end:?}");
            let mut answer = answers.remove(0);
            answer.planner_version = "0.0.1".into();
            let same = PlannedMoves::from_wire(answer.clone()).unwrap().plan(0, &columns).unwrap();
            let first = &mut answer.segments.as_mut().unwrap().duration[0];
            *first = first.next_up();
            let moves = PlannedMoves::from_wire(answer).unwrap();
            let other = moves.plan(0, &columns);
            if detail == Detail::Motion {
                let refused = other.unwrap_err();
                assert_eq!(refused.reason, Reason::MessageInvalid);
                assert!(refused.message.contains("FULL"), "{refused}");
                continue;
            }
            let other = other.unwrap();
            let [same, other] = [&same, &other].map(|plan| &plan.plan().axes()[0]);
            let [mut pieces, others] = [same, other].map(|axis| axis.profile.segments().to_vec());
            pieces[0].duration = pieces[0].duration.next_up();
            assert_eq!(pieces, others, "{family:?}");
            assert_eq!(same.profile.end(), other.profile.end());
            assert!((other.classification.feed_rate - same.classification.feed_rate).abs() < 1e-9);
        }
    }
}

/// What all moves have wrong ends the stream, and what came before holds.
#[tokio::test]
async fn what_is_wrong_with_all_ends_the_stream() {
    let server = Loopback::start().await;
    let good = pb::MoveColumns::from(columns(Family::SCurve, 10));
    let with = |change: &dyn Fn(&mut pb::MoveColumns)| {
        let mut columns = good.clone();
        change(&mut columns);
        message(columns)
    };
    let like =
        |change: &dyn Fn(&mut pb::PlanRequest)| with(&|columns| change(columns.like.as_mut().unwrap()));
    let both = pb::PlanManyRequest { requests: vec![fifty_millimetres().into()], ..message(good.clone()) };
    let unknown = pb::PlanManyRequest { detail: 99, ..message(good.clone()) };
    let rows = [
        (with(&|columns| columns.like = None), Reason::FieldMissing, "columns.like"),
        (
            with(&|columns| columns.goal_velocity = vec![0.0; 3]),
            Reason::LengthMismatch,
            "columns.goal_velocity",
        ),
        (like(&|like| like.axes.clear()), Reason::NoAxes, "columns.like.axes"),
        (like(&|like| like.axes.push(like.axes[0].clone())), Reason::TooManyAxes, "columns.like.axes"),
        (like(&|like| like.axes[0].axis = "x\n".into()), Reason::NameInvalid, "columns.like.axes[0].axis"),
        (like(&|like| like.axes[0].kind = 0), Reason::KindUnspecified, "columns.like.axes[0].kind"),
        (like(&|like| like.family = 99), Reason::KindUnspecified, "columns.like.family"),
        (
            like(&|like| like.cycle_time = Some(proto::Duration { seconds: 1, nanos: -1 })),
            Reason::ValueOutOfRange,
            "columns.like.cycle_time",
        ),
        (both, Reason::ProtocolOrder, "columns"),
        (unknown, Reason::KindUnspecified, "detail"),
    ];
    for (bad, expected, field) in rows {
        let (answers, end) = asked(&server, vec![message(good.clone()), bad, message(good.clone())]).await;
        let rejected = reason(end.as_ref());
        assert_eq!(
            (answers.len(), rejected.reason, &*rejected.fields[0].field),
            (1, expected, field),
            "{rejected}"
        );
    }
    let (_, end) = asked(&server, vec![with(&|columns| columns.goal_velocity = vec![0.0; 3])]).await;
    let text = reason(end.as_ref()).message;
    assert_eq!(
        text,
        "columns.goal_velocity: has 3 numbers, and columns.start_position has 10: give one for each move, or none where \
         that of like holds for all"
    );
    // None at all is answered with none.
    let none = MoveColumns::like(fifty_millimetres());
    let (answers, end) = asked(&server, vec![message(none)]).await;
    assert!(end.is_none() && answers.len() == 1 && answers[0].duration.is_empty(), "{answers:?}");
}

/// What `like` says holds where there is no column, and what is wrong with it there is wrong with each.
#[tokio::test]
async fn what_like_says_holds_for_all() {
    let server = Loopback::start().await;
    let client = server.client().await;
    let mut columns = MoveColumns::like(fifty_millimetres());
    columns.like.axes[0].goal = State { position: 0.3, velocity: f64::NAN, acceleration: 0.0 };
    columns.start_position = vec![0.0, 0.1, 0.2];
    let [moves] = client.plan_columns(&columns, Detail::Full).await.unwrap().try_into().unwrap();
    for (index, rejected) in moves.refusals() {
        assert_eq!(rejected.fields[0].field, "columns.like.axes[0].goal.velocity", "{index}");
    }
    assert_eq!(moves.refusals().count(), 3);
    columns.like.axes[0].goal.velocity = 0.0;
    let [moves] = client.plan_columns(&columns, Detail::Full).await.unwrap().try_into().unwrap();
    assert!(moves.all_planned() && moves.durations()[0] > moves.durations()[2]);
}

#[tokio::test]
async fn each_size_has_its_reason() {
    let mut config =
        Config { limits: Limits { plans_per_message: 100, ..Limits::default() }, ..Config::loopback() };
    config.serving.max_message_bytes = 20_000;
    let server = Loopback::with(config).await;
    let moves = |count| {
        let mut columns = MoveColumns::like(fifty_millimetres());
        columns.goal_position = drawn(count, 0.3);
        message(columns)
    };
    let (answers, end) = asked(&server, vec![moves(20), moves(101)]).await;
    let rejected = reason(end.as_ref());
    assert_eq!((answers.len(), rejected.reason), (1, Reason::TooManyPlans));
    assert_eq!(rejected.fields[0].field, "columns");
    assert!(rejected.message.contains("has 101 moves") && rejected.message.contains("max_plans_per_message"));
    // An answer that no message may hold: seven segments of forty bytes for each.
    let (answers, end) = asked(&server, vec![moves(20), moves(100)]).await;
    let rejected = reason(end.as_ref());
    assert_eq!((answers.len(), rejected.reason), (1, Reason::MessageTooLarge), "{rejected}");
    let fit: usize = rejected.metadata["fit"].parse().unwrap();
    assert!((60..72).contains(&fit), "{fit}");
    // Less of each.
    let motion = pb::PlanManyRequest { detail: pb::PlanDetail::Motion as i32, ..moves(100) };
    let (answers, end) = asked(&server, vec![motion]).await;
    assert!(end.is_none() && answers[0].duration.len() == 100);
}

/// Through the client, over several messages, some of them large enough to be planned aside.
#[tokio::test]
async fn the_parts_of_many_are_in_order() {
    let server = Loopback::start().await;
    let client = server.client().await;
    let count = 10_000;
    let mut columns = MoveColumns::like(fifty_millimetres());
    columns.goal_position = (1..=count).map(|index| 1e-4 * f64::from(index)).collect();
    let parts = client.plan_columns(&columns, Detail::Motion).await.unwrap();
    assert_eq!(parts.iter().map(PlannedMoves::len).collect::<Vec<_>>(), [4096, 4096, 1808]);
    let durations: Vec<f64> = parts.iter().flat_map(|part| part.durations().to_vec()).collect();
    assert!(durations.is_sorted(), "farther is longer");
    assert_eq!(client.plan_columns(&columns.slice(0..0), Detail::Full).await.unwrap(), []);
    // One stream takes both, in turn; what is taken as the other is no answer.
    let (asking, mut answers) = client.plan_many(Detail::Motion).await.unwrap();
    assert!(asking.ask(vec![fifty_millimetres()]).await.unwrap());
    assert!(asking.ask_columns(columns.slice(0..5)).await.unwrap());
    assert_eq!(answers.next().await.unwrap().unwrap().len(), 1);
    assert_eq!(answers.next_columns().await.unwrap().unwrap().len(), 5);
    assert!(asking.ask(vec![fifty_millimetres()]).await.unwrap());
    assert!(matches!(answers.next_columns().await, Err(Error::Protocol(_))));
}
