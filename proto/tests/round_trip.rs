//! Domain to wire and back gives the same bits.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail by panicking")]

use planner::motion::{AxisPoints, Points};
use planner::{AxisMoveSpec, Judged, Limits, LimitsSpec, Request, RequestSpec, State};
use proptest::prelude::*;
use prost::Message;
use proto::stream::{
    Ask, Batch, Columns, FromAxis, GoalSpec, Motion, Open, Operation, OperationResult, Report, Resume,
    Revised, Source, StreamEvent, StreamEventKind, ToAxis,
};
use proto::{
    Digest, pb, plan_from_wire, plan_to_wire, request_from_wire, request_to_wire, response_from_wire,
    response_to_wire,
};

fn request(distance: f64, start: f64, end: f64, cruise: f64) -> RequestSpec {
    let axis = pb::AxisMove {
        axis: "x".into(),
        kind: pb::AxisKind::Prismatic as i32,
        start: Some(pb::AxisState { velocity: start, ..Default::default() }),
        goal: Some(pb::AxisState { position: distance, velocity: end, acceleration: 0.0 }),
        limits: Some(pb::AxisLimits {
            max_velocity: cruise,
            max_acceleration: 2.0,
            max_jerk: 100.0,
            ..Default::default()
        }),
    };
    let policy = pb::ShortPathPolicy::NearestVelocity as i32;
    pb::PlanRequest { axes: vec![axis], short_path_policy: policy, ..Default::default() }.into()
}

/// From rest to rest, with limits of every order, by another family.
fn smoother(distance: f64, cruise: f64, family: pb::ProfileFamily, order: Option<u32>) -> RequestSpec {
    let mut spec = request(distance, 0.0, 0.0, cruise);
    let wire = pb::PlanRequest { family: family as i32, ..Default::default() };
    spec.family = RequestSpec::from(wire).family;
    spec.order = order;
    spec.axes[0].limits.max_snap = Some(1e4);
    spec.axes[0].limits.max_higher_derivatives = vec![1e6, 1e8, 1e10, 1e12];
    spec
}

fn comes_back(judged: &Judged) -> Result<(), TestCaseError> {
    let wire = plan_to_wire(judged);
    let bytes = proto::encode_plan(judged);
    // What is written is what generated code makes of what is read: no field is lost, or in another place.
    prop_assert_eq!(&wire.encode_to_vec(), &bytes);
    prop_assert_eq!(&proto::fingerprint(&wire)[..], &wire.fingerprint);
    explained(&wire, judged);
    let back = plan_from_wire(pb::Plan::decode(bytes.clone()).unwrap()).unwrap();
    prop_assert_eq!(&back, judged.plan());
    prop_assert_eq!(proto::encode_plan(&Judged::new(back)), bytes);
    for detail in [proto::Detail::Full, proto::Detail::Motion] {
        let mut outcomes = proto::Outcomes::with_room(1, usize::MAX, detail);
        outcomes.push(&Ok(judged.clone()));
        let sent = outcomes.into_wire().encode_to_vec();
        let read = pb::PlanManyResponse::decode(&*sent).unwrap();
        prop_assert_eq!(read.encode_to_vec(), sent);
        let back = proto::outcome_from_wire(read.outcomes[0].clone()).unwrap().unwrap();
        prop_assert_eq!(back.plan(), judged.plan());
    }
    let json = proto::to_json(&wire).unwrap();
    prop_assert_eq!(proto::from_json::<pb::Plan>(&json).unwrap(), wire);
    Ok(())
}

/// What is only told, and read by nobody here: each field is what it is called.
fn explained(wire: &pb::Plan, judged: &Judged) {
    let pb::PlanExplanation { critical_axis, bindings } = wire.explanation.clone().unwrap();
    let planner::Explanation { critical_axis: axis, bindings: ours } = judged.explanation();
    assert_eq!((&*critical_axis, bindings.len()), (axis, ours.len()));
    for (told, ours) in bindings.into_iter().zip(ours) {
        let pb::plan_explanation::Binding { axis, quantity, from_time, to_time } = told;
        assert_eq!(
            (&*axis, from_time.to_bits(), to_time.to_bits()),
            (ours.axis, ours.from_time.to_bits(), ours.to_time.to_bits())
        );
        let name = pb::Quantity::try_from(quantity).unwrap().as_str_name();
        assert_eq!(name, format!("QUANTITY_{}", ours.quantity.to_string().to_uppercase()));
    }
}

fn judged(spec: RequestSpec) -> Judged {
    Judged::answer(&Request::try_from(spec).unwrap()).unwrap()
}

proptest! {
    #[test]
    fn a_plan_comes_back_with_the_same_bits(
        distance in 1e-9..10.0, start in 0.0..0.5, end in 0.0..0.5, cruise in 0.5..2.0,
    ) {
        comes_back(&judged(request(distance, start, end, cruise)))?;
    }

    #[test]
    fn a_plan_of_order_n_comes_back_with_the_same_bits(
        distance in -10.0..10.0f64, cruise in 0.5..2.0, order in 2..=8u32,
    ) {
        let spec = smoother(distance, cruise, pb::ProfileFamily::Polynomial, Some(order));
        comes_back(&judged(spec).accepted().unwrap().judged().clone())?;
    }

    #[test]
    fn a_plan_of_cosines_comes_back_with_the_same_bits(distance in -10.0..10.0f64, cruise in 0.5..2.0) {
        let spec = smoother(distance, cruise, pb::ProfileFamily::Trigonometric, None);
        comes_back(&judged(spec).accepted().unwrap().judged().clone())?;
    }

    #[test]
    fn limits_come_back_as_they_were_stated(
        velocity in 1e-3..1e3, reverse in proptest::option::of(0.0..1e3), feed in proptest::option::of(1e-3..1e3),
        jerk in 1e-3..1e6, higher in proptest::collection::vec(1e-3..1e6, 0..6),
    ) {
        let spec = LimitsSpec {
            max_velocity: velocity,
            max_acceleration: 3.0,
            max_jerk: jerk,
            max_velocity_reverse: reverse,
            feed_rate: feed,
            max_higher_derivatives: higher,
            ..LimitsSpec::default()
        };
        let limits = Limits::try_from(spec.clone());
        prop_assume!(limits.is_ok());
        let wire = pb::AxisLimits::from(limits.unwrap().spec().clone());
        prop_assert_eq!(LimitsSpec::from(wire), spec);
    }

    #[test]
    fn a_report_comes_back(executed in any::<u64>(), accepted in any::<u64>(), digest in any::<u64>()) {
        let report = Report {
            executed_cycle: executed,
            accepted_cycle: accepted,
            digest: Digest::from(digest),
            ..Report::default()
        };
        let there = FromAxis::Report(report);
        prop_assert_eq!(request_from_wire(request_to_wire(&there)).unwrap(), there);
    }
}

/// From rest to rest a move has a name in three papers.
#[test]
fn every_name_of_a_shape_comes_back() {
    let judged = judged(request(0.05, 0.0, 0.0, 1.0));
    let wire = plan_to_wire(&judged);
    let names = wire.axes[0].classification.clone().unwrap();
    let given = [&names.eight_type, &names.asymmetric_type, &names.six_case].map(|name| name.as_deref());
    assert_eq!(given, [Some("5"), Some("2"), Some("D.2")]);
    assert_eq!(&plan_from_wire(wire.clone()).unwrap(), judged.plan());

    let mut unknown = wire;
    let names = unknown.axes[0].classification.as_mut().unwrap();
    names.asymmetric_type = Some("9".into());
    names.six_case = Some("C1".into());
    let refusal = plan_from_wire(unknown).unwrap_err();
    let fields: Vec<_> = refusal.as_slice().iter().map(|invalid| invalid.field.to_string()).collect();
    assert_eq!(fields, ["asymmetric_type", "six_case"].map(|name| format!("axes[0].classification.{name}")));
}

/// Its certificate holds a jerk without bound, which JSON has a word for.
#[test]
fn a_trapezoid_comes_back() {
    let mut spec = request(0.05, 0.0, 0.0, 0.25);
    spec.family = Ok(planner::Family::Trapezoidal);
    let wire = plan_to_wire(&judged(spec));
    assert_eq!(wire.method.as_ref().map(|method| method.order), Some(2));
    let json = proto::to_json(&wire).unwrap();
    assert_eq!(proto::from_json::<pb::Plan>(&json).unwrap(), wire);
    let back = Judged::new(plan_from_wire(wire.clone()).unwrap());
    assert_eq!(plan_to_wire(&back), wire);
}

#[test]
fn an_open_comes_back() {
    let plan = judged(request(0.05, 0.0, 0.0, 0.25)).accepted().unwrap();
    let open = Open {
        stream: "cell-7/x".into(),
        epoch: 3,
        lead_cycles: 40,
        batch_cycles: 10,
        axis_guard: 2,
        close_at_rest: true,
        accept_unproved: false,
        compact: true,
        executed_cycle: 0,
        source: Source::Plan(plan.clone()),
    };
    let comes_back = |open: Open| {
        let there = FromAxis::Open(Box::new(open));
        assert_eq!(request_from_wire(request_to_wire(&there)).unwrap(), there);
    };
    comes_back(open.clone());
    // In the middle of it, and after a way to rest.
    let motion = Motion::opened(planner::motion::Motion::open(plan).unwrap());
    let rests = motion.starved(100, &motion.tails(100).unwrap(), Digest::from(7)).unwrap();
    for (motion, next_cycle) in [(motion, 101), (rests.clone(), rests.last_cycle() + 1)] {
        let (digest, checkpoint_digest) = (Digest::from(5), Digest::from(6));
        let resume =
            Resume { motion, next_cycle, digest, checkpoint_cycle: next_cycle - 1, checkpoint_digest };
        comes_back(Open { executed_cycle: 90, source: Source::Resume(Box::new(resume)), ..open.clone() });
    }
}

#[test]
fn a_batch_comes_back_with_its_ways_to_rest() {
    let plan = judged(request(0.05, 0.0, 0.0, 0.25)).accepted().unwrap();
    let motion = Motion::opened(planner::motion::Motion::open(plan).unwrap());
    for cycles in [1..=100, 301..=motion.last_cycle()] {
        let (first_cycle, last_cycle) = cycles.into_inner();
        let columns = Columns::of_plan(motion.plan(), first_cycle..last_cycle + 1);
        let tails = motion.tails(last_cycle).unwrap();
        assert_eq!(tails.profiles().len(), usize::from(last_cycle < motion.last_cycle()));
        let last = last_cycle == motion.last_cycle();
        let (revision, replaces, digest) = (3, true, Digest::from(9));
        let there = ToAxis::Batch(Batch { first_cycle, revision, replaces, last, columns, digest, tails });
        let back = response_from_wire(response_to_wire(4, there.clone())).unwrap();
        assert_eq!(back, (4, there));
    }
}

#[test]
fn a_bare_batch_comes_back_unless_it_is_too_long() {
    let bare = |cycles| {
        ToAxis::Batch(Batch {
            first_cycle: 101,
            revision: 3,
            replaces: false,
            last: false,
            columns: Columns::bare(cycles),
            digest: Digest::from(9),
            tails: proto::stream::Tails::default(),
        })
    };
    let wire = response_to_wire(4, bare(20));
    assert!(prost::Message::encoded_len(&wire) < 32);
    assert_eq!(response_from_wire(wire).unwrap(), (4, bare(20)));
    let rejected = response_from_wire(response_to_wire(4, bare(4097))).unwrap_err();
    let field = rejected.fields[0].field.as_str();
    assert_eq!((rejected.reason, field), (proto::Reason::ValueOutOfRange, "batch.cycles"), "{rejected}");
}

/// Otherwise a message of some bytes would be four thousand million setpoints to whoever evaluates them.
#[test]
fn columns_of_cycles_without_numbers_are_none() {
    for (cycles, beside) in [(u32::MAX, 0), (20, 20), (0, 20)] {
        let columns = Some(pb::SetpointColumns { cycles, ..Default::default() });
        let batch = pb::SetpointBatch { first_cycle: 1, columns, cycles: beside, ..Default::default() };
        let message = Some(pb::stream_setpoints_response::Message::Batch(batch));
        let rejected = response_from_wire(pb::StreamSetpointsResponse { epoch: 1, message }).unwrap_err();
        assert_eq!(rejected.reason, proto::Reason::LengthMismatch, "{rejected}");
    }
}

/// The wire drops the sign of a zero: a plan from negative zeros has to sample to the same bits on both sides of it.
#[test]
fn negative_zeros_do_not_change_the_bits() {
    let mut spec = request(0.05, 0.0, 0.0, 0.25);
    spec.axes[0].start = State { position: -0.0, velocity: -0.0, acceleration: -0.0 };
    spec.axes[0].goal.velocity = -0.0;
    let judged = judged(spec);
    let bytes = plan_to_wire(&judged).encode_to_vec();
    let back = plan_from_wire(pb::Plan::decode(bytes.as_slice()).unwrap()).unwrap();
    let bits = |plan: &planner::Plan| -> Vec<[u64; 4]> {
        let mut sampler = plan.sampler();
        (0..=plan.cycle_count())
            .flat_map(|cycle| sampler.at(cycle).collect::<Vec<_>>())
            .map(|setpoint| setpoint.words().map(f64::to_bits))
            .collect()
    };
    assert_eq!(bits(judged.plan()), bits(&back));
}

#[test]
fn an_event_comes_back() {
    let there = ToAxis::Event(StreamEvent { kind: StreamEventKind::Standstill, at_cycle: 7 });
    let back = proto::response_from_wire(proto::response_to_wire(5, there.clone())).unwrap();
    assert_eq!(back, (5, there));
}

/// Also of a trapezoid, in whose splices the acceleration may jump, so that they promise less than other S-curves do.
#[test]
fn a_motion_comes_back_with_its_base_and_what_became_of_operations() {
    use planner::motion::{Operation, Override};
    let mut trapezoid = request(0.05, 0.0, 0.0, 0.25);
    trapezoid.family = Ok(planner::Family::Trapezoidal);
    let specs = [
        request(0.05, 0.0, 0.0, 0.25),
        request(0.5, 0.1, 0.2, 0.25),
        smoother(0.3, 0.5, pb::ProfileFamily::Polynomial, Some(5)),
        smoother(0.3, 0.5, pb::ProfileFamily::Trigonometric, None),
        trapezoid,
    ];
    let half = Operation::Override(Override::new(0.5).unwrap());
    let mut without_jerk = 0;
    for spec in specs {
        for cycle in (0..300).step_by(7) {
            let opened = planner::motion::Motion::open(judged(spec.clone()).accepted().unwrap()).unwrap();
            let mut under_way = opened;
            for (index, operation) in
                [&half, &Operation::Hold, &Operation::Resume, &Operation::Stop].into_iter().enumerate()
            {
                under_way = under_way.splice(cycle + 40 * index as u64, operation).unwrap().motion;
                without_jerk += u32::from(!under_way.plan().guarantees(planner::Quantity::Jerk));
                let result = OperationResult {
                    request_id: "h".into(),
                    effective_cycle: cycle,
                    rest_cycle: under_way.last_cycle(),
                    revision: under_way.revision(),
                    on_path: true,
                    operation_digest: 7,
                };
                let recent = [result].into();
                let motion =
                    Motion { under_way: under_way.clone(), digest_before: Digest::from(cycle), recent };
                let there = ToAxis::Revised(Box::new(Revised { motion }));
                let back = proto::response_from_wire(proto::response_to_wire(5, there.clone())).unwrap();
                assert_eq!(back, (5, there));
            }
        }
    }
    assert!(without_jerk > 0, "no splice was made in a jump");
}

#[test]
fn operations_come_back() {
    let goal = GoalSpec {
        axis: "x".into(),
        goal: Some(State { position: 0.1, velocity: 0.2, acceleration: -0.3 }),
        limits: Some(LimitsSpec {
            max_velocity: 1.0,
            max_acceleration: 2.0,
            max_jerk: 3.0,
            ..LimitsSpec::default()
        }),
    };
    let plain = GoalSpec { goal: None, limits: None, ..goal.clone() };
    let asks = [
        Ask::Hold,
        Ask::Resume,
        Ask::Override(0.5),
        Ask::Retarget(vec![goal, plain]),
        Ask::Append(Points {
            axes: vec![AxisPoints {
                axis: "x".into(),
                times: vec![0.05],
                positions: vec![0.1],
                velocities: vec![-0.2],
            }],
            last: true,
        }),
        Ask::Stop,
    ];
    for ask in asks.into_iter().map(Some).chain([None]) {
        for not_before_cycle in [None, Some(0), Some(u64::MAX)] {
            let operation = Operation { request_id: "o".into(), not_before_cycle, ask: ask.clone() };
            let there = FromAxis::Operation(operation);
            assert_eq!(request_from_wire(request_to_wire(&there)).unwrap(), there);
        }
    }
}

#[test]
fn a_motion_that_is_none_is_refused_with_its_field() {
    let under_way = planner::motion::Motion::open(judged(request(0.05, 0.0, 0.0, 0.25)).accepted().unwrap());
    let held = under_way.unwrap().splice(100, &planner::motion::Operation::Hold).unwrap().motion;
    let there = ToAxis::Revised(Box::new(Revised { motion: Motion::opened(held) }));
    let Some(pb::stream_setpoints_response::Message::Revised(revised)) =
        proto::response_to_wire(1, there).message
    else {
        panic!("it was revised")
    };
    let wire = revised.motion.unwrap();
    type Spoil = fn(&mut pb::Motion);
    let rows: [(Spoil, proto::Reason, &str); 7] = [
        (|motion| motion.base = None, proto::Reason::FieldMissing, "motion.base"),
        (|motion| motion.plan = None, proto::Reason::FieldMissing, "motion.plan"),
        (
            |motion| motion.override_factor = f64::NAN,
            proto::Reason::OverrideOutOfRange,
            "motion.override_factor",
        ),
        (|motion| motion.from_cycle = u64::MAX, proto::Reason::ValueOutOfRange, "motion.from_cycle"),
        (
            |motion| motion.closing_from_cycle = Some(7),
            proto::Reason::ValueOutOfRange,
            "motion.closing_from_cycle",
        ),
        (
            |motion| motion.base_time.push(pb::AxisSegment::default()),
            proto::Reason::TimesNotIncreasing,
            "motion.base_time[0].duration",
        ),
        (|motion| motion.phase = 0, proto::Reason::KindUnspecified, "motion.phase"),
    ];
    for (spoil, reason, field) in rows {
        let mut motion = wire.clone();
        spoil(&mut motion);
        let revised = pb::MotionRevised { motion: Some(motion), certificate: None };
        let message = Some(pb::stream_setpoints_response::Message::Revised(Box::new(revised)));
        let rejected =
            proto::response_from_wire(pb::StreamSetpointsResponse { epoch: 1, message }).unwrap_err();
        assert_eq!((rejected.reason, rejected.fields[0].field.as_str()), (reason, field), "{rejected}");
    }
}

/// Axes that arrive together, slowed, held and resumed: the pieces are of degree 9, and the law of time travels with them.
#[test]
fn a_motion_that_is_re_timed_comes_back_with_the_same_bits() {
    use planner::motion::{Operation as Planned, Override};
    let mut spec = request(0.5, 0.0, 0.0, 0.25);
    spec.axes.push(AxisMoveSpec { axis: "y".into(), goal: State::at_rest(-0.1), ..spec.axes[0].clone() });
    spec.synchronization = Ok(planner::Synchronization::Time);
    let mut motion = planner::motion::Motion::open(judged(spec).accepted().unwrap()).unwrap();
    let slower = Planned::Override(Override::new(0.5).unwrap());
    for (cycle, operation) in [(300, slower), (700, Planned::Hold), (3000, Planned::Resume)] {
        motion = motion.splice(cycle, &operation).unwrap().motion;
        assert!(motion.base_time().is_some());
        let revised = Box::new(Revised { motion: Motion::opened(motion.clone()) });
        let wire = proto::response_to_wire(1, ToAxis::Revised(revised.clone()));
        let (_, back) = proto::response_from_wire(wire).unwrap();
        assert_eq!(back, ToAxis::Revised(revised), "{operation:?}");
    }
}

#[test]
fn columns_of_different_lengths_are_refused() {
    let wire = pb::SetpointColumns { cycles: 2, position: vec![0.0; 2], ..Default::default() };
    let rejected = Columns::try_from(wire).unwrap_err();
    assert_eq!(rejected.reason, proto::Reason::LengthMismatch);
}

/// In protocol buffers the parts of a duration have one sign; what others mean depends on who reads them.
#[test]
fn durations_whose_parts_contradict_each_other_are_refused() {
    let part = |seconds, nanos| Some(prost_types::Duration { seconds, nanos });
    let refused = |cycle_time, minimum_duration| {
        let wire = pb::PlanRequest { cycle_time, minimum_duration, ..Default::default() };
        let rejected = proto::Rejected::from(proto::plan_request_from_wire(wire).unwrap_err());
        let fields = rejected.fields.iter().map(|field| format!("{}: {}", field.field, field.description));
        (rejected.metadata, fields.collect::<Vec<_>>())
    };
    let way_out = "give both parts one sign, and less than 1000000000 ns beside the seconds";
    let no_axes = "axes: is empty: give at least one axis".to_owned();
    for (seconds, nanos) in [(1, -5), (-1, 5), (0, 1_000_000_000), (0, i32::MIN), (i64::MAX, -1)] {
        let said = format!("is {seconds} s and {nanos} ns: {way_out}");
        let (metadata, fields) = refused(part(seconds, nanos), part(seconds, nanos));
        let expected = [format!("minimum_duration: {said}"), format!("cycle_time: {said}"), no_axes.clone()];
        assert_eq!(fields, expected);
        assert_eq!(metadata["given"], format!("{seconds} s and {nanos} ns"));
        let wire = pb::PlanPvtRequest { cycle_time: part(seconds, nanos), ..Default::default() };
        let refused = proto::pvt_request_from_wire(wire).unwrap_err();
        assert!(refused.to_string().starts_with(&format!("cycle_time: {said}; ")), "{refused}");
        let mut wire = plan_to_wire(&judged(request(0.05, 0.0, 0.0, 0.25)));
        wire.cycle_time = part(seconds, nanos);
        let refused = plan_from_wire(wire).unwrap_err();
        assert!(refused.to_string().starts_with(&format!("cycle_time: {said}")), "{refused}");
    }
    assert_eq!(refused(part(0, 1_000_000), part(1, 999_999_999)).1, [no_axes]);
}

#[test]
fn every_invalid_field_is_named_at_once() {
    let axis = pb::AxisMove {
        axis: "x".into(),
        goal: Some(pb::AxisState { position: f64::NAN, ..Default::default() }),
        ..Default::default()
    };
    let wire = pb::PlanRequest { axes: vec![axis.clone(), axis], family: 99, ..Default::default() };
    let invalid = Request::try_from(RequestSpec::from(wire)).unwrap_err();
    let rejected = proto::Rejected::from(invalid);
    let fields: Vec<&str> = rejected.fields.iter().map(|violation| violation.field.as_str()).collect();
    assert_eq!(
        fields,
        [
            "family",
            "axes[1].axis",
            "axes[0].kind",
            "axes[0].limits",
            "axes[0].goal.position",
            "axes[1].kind",
            "axes[1].limits",
            "axes[1].goal.position",
        ]
    );
    let start = rejected.fields.iter().find(|violation| violation.field == "axes[0].goal.position");
    assert_eq!(start.unwrap().reason, proto::Reason::NotFinite);
}

#[test]
fn laws_that_are_none_are_refused_with_their_path() {
    use pb::axis_segment::{CosineJerk, Law, Polynomial};
    let polynomial = |derivatives: &[f64]| Law::Polynomial(Polynomial { derivatives: derivatives.to_vec() });
    let rows = [
        (Law::Jerk(f64::NAN), proto::Reason::NotFinite, "jerk"),
        (polynomial(&[]), proto::Reason::OrderUnsupported, "polynomial.derivatives"),
        (polynomial(&[1.0; 14]), proto::Reason::OrderUnsupported, "polynomial.derivatives"),
        (polynomial(&[1.0, f64::INFINITY]), proto::Reason::NotFinite, "polynomial.derivatives[1]"),
        (
            Law::CosineJerk(CosineJerk { peak_jerk: f64::NAN }),
            proto::Reason::NotFinite,
            "cosine_jerk.peak_jerk",
        ),
    ];
    for (law, reason, field) in rows {
        let mut wire = plan_to_wire(&judged(request(0.05, 0.0, 0.0, 0.25)));
        wire.axes[0].segments[1].law = Some(law);
        let rejected = proto::Rejected::from(plan_from_wire(wire).unwrap_err());
        let found: Vec<_> = rejected.fields.iter().map(|violation| violation.field.as_str()).collect();
        assert_eq!(found, [format!("axes[0].segments[1].{field}")]);
        assert_eq!(rejected.reason, reason);
    }
}

#[test]
fn refusals_of_the_families_have_their_reasons() {
    let reason = |spec: RequestSpec| {
        let rejected = proto::Rejected::from(Request::try_from(spec).unwrap_err());
        (rejected.reason, rejected.fields[0].field.clone())
    };
    let polynomial = |order| smoother(1.0, 1.0, pb::ProfileFamily::Polynomial, order);
    for order in [None, Some(0), Some(1), Some(40)] {
        assert_eq!(reason(polynomial(order)), (proto::Reason::OrderUnsupported, "order".into()));
    }
    let mut no_snap = polynomial(Some(4));
    no_snap.axes[0].limits.max_snap = None;
    let field = "axes[0].limits.max_snap".into();
    assert_eq!(reason(no_snap), (proto::Reason::FieldMissing, field));
    let mut moving = smoother(1.0, 1.0, pb::ProfileFamily::Trigonometric, None);
    moving.axes[0].start.velocity = 0.25;
    let field = "axes[0].start.velocity".into();
    assert_eq!(reason(moving), (proto::Reason::StateNotAtRest, field));
}

/// What a judge said comes back whole, where an axis turns back as well.
#[test]
fn a_certificate_comes_back() {
    let points = planner::PvtRequestSpec {
        axes: vec![planner::PvtAxisSpec {
            axis: "x".into(),
            kind: Ok(planner::AxisKind::Prismatic),
            limits: Limits::symmetric(1.0, 4.0, 100.0).unwrap().spec().clone(),
            start: State::default(),
            times: vec![0.1, 0.2],
            positions: vec![0.1, 0.0],
            velocities: vec![0.0, 0.5],
        }],
        cycle_time_ns: None,
        interpolation: Ok(planner::PvtInterpolation::Quintic),
        policy: Ok(planner::PvtPolicy::Reject),
        finish_unreached: false,
    };
    let judged = planner::JudgedPvt::answer(&points.try_into().unwrap()).unwrap();
    let certificate = judged.judged().certificate();
    assert!(!certificate.reversals.is_empty());
    let wire = pb::PlanCertificate::from(certificate);
    assert_eq!(wire.reversals.len(), certificate.reversals.len());
    let wire = pb::PlanCertificate::decode(&*wire.encode_to_vec()).unwrap();
    assert_eq!(&planner::Certificate::try_from(wire).unwrap(), certificate);
}
