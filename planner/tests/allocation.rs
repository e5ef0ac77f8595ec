//! What a control loop calls per cycle takes nothing from the heap.

#![allow(unsafe_code, reason = "an allocator is unsafe to write; this one counts and passes on")]
#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::hint::black_box;

use common::splices;
use planner::{
    AxisKind, AxisMoveSpec, AxisProblem, AxisTransfer, Bounds, Cursor, Family, Limits, LimitsSpec,
    MoveSeries, Problem, PvtPlanner, PvtPolicy, PvtTarget, Request, RequestSpec, ShortPathPolicy, State,
    Synchronization, Timing, Transfer, plan, plan_between, plan_move, plan_polynomial, plan_stop,
    plan_transfer, plan_trigonometric, plan_velocity, together,
};

thread_local! {
    /// Counts this thread's allocations only: the test harness has threads of its own.
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

struct Counting;

fn count() {
    // A thread that is ending has no counter any more, and nothing to count for.
    let _ = ALLOCATIONS.try_with(|allocations| allocations.set(allocations.get() + 1));
}

// SAFETY: everything is passed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: the caller's promises are those that `System` asks for.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count();
        // SAFETY: as above; `pointer` came from `System`.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        // SAFETY: as above.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

/// How often `work` goes to the heap.
fn allocations(work: impl FnOnce()) -> u64 {
    let before = ALLOCATIONS.get();
    work();
    ALLOCATIONS.get() - before
}

fn limits() -> LimitsSpec {
    LimitsSpec { max_velocity: 0.5, max_acceleration: 2.0, max_jerk: 20.0, ..LimitsSpec::default() }
}

#[test]
fn the_counter_counts() {
    assert_eq!(allocations(|| drop(black_box(Box::new(1)))), 2);
}

/// Under every policy that has an answer, long and short.
#[test]
fn a_plan_allocates_nothing() {
    for policy in
        [ShortPathPolicy::Reject, ShortPathPolicy::NearestVelocity, ShortPathPolicy::MatchStartVelocity]
    {
        for (from, to, length) in [(0.0, 0.0, 1.0), (0.1, 0.4, 0.3), (0.4, 0.1, 1e-3), (0.1, 0.4, 1e-3)] {
            let start = State { position: 0.0, velocity: from, acceleration: 0.0 };
            let goal = State { position: length, velocity: to, acceleration: 0.0 };
            let problem = Problem::new(start, goal, limits().try_into().unwrap(), policy).unwrap();
            if policy == ShortPathPolicy::Reject && length < 0.1 {
                continue;
            }
            let count = allocations(|| {
                let _ = black_box(plan_move(black_box(&problem)));
            });
            assert_eq!(count, 0, "{policy:?} from {from} to {to} over {length}");
        }
    }
}

/// From any state to any state, from inside and from beyond the bounds; a stop; and limits that tell speeding up from slowing down.
#[test]
fn a_transfer_allocates_nothing() {
    let bounds = Bounds::symmetric(0.5, 2.0, 20.0).unwrap();
    let limits: Limits = LimitsSpec { max_deceleration: Some(1.0), ..limits() }.try_into().unwrap();
    for (velocity, acceleration, to) in
        [(0.0, 0.0, 1.0), (0.3, -0.5, 0.01), (0.9, 0.5, -1.0), (-0.2, 3.0, 0.0)]
    {
        let start = State { position: 0.0, velocity, acceleration };
        let transfer = Transfer::new(start, State::at_rest(to), bounds).unwrap();
        let count = allocations(|| {
            let transit = black_box(plan_transfer(black_box(&transfer))).unwrap();
            black_box((transit.at(0.1), transit.segments(), transit.duration()));
            black_box(plan_velocity(start, 0.1, bounds)).unwrap();
            black_box(plan_between(start, State::at_rest(to), &limits)).unwrap();
            black_box(plan_stop(start, &limits)).unwrap();
        });
        assert_eq!(count, 0, "from {velocity}, {acceleration} to {to}");
    }
}

/// Several axes at one time and on a line, and durations with a blocked interval, once there is room for the answer.
#[test]
fn axes_together_allocate_nothing() {
    let bounds = Bounds::symmetric(1.0, 1.0, 10.0).unwrap();
    let limits: Limits = LimitsSpec { max_deceleration: Some(1.0), ..limits() }.try_into().unwrap();
    let at_speed = State { position: 0.0, velocity: 1.0, acceleration: 0.0 };
    let fast = Transfer::new(at_speed, State { position: 1.0, ..at_speed }, bounds).unwrap();
    let asymmetric = AxisTransfer::within_limits(State::at_rest(0.0), State::at_rest(0.4), &limits).unwrap();
    let mut transits = Vec::with_capacity(3);
    for (way, how) in
        [(0.7, Synchronization::Time), (0.1, Synchronization::Time), (0.7, Synchronization::Phase)]
    {
        let slow = Transfer::new(State::at_rest(0.0), State::at_rest(way), bounds).unwrap();
        let third = if how == Synchronization::Time { fast.into() } else { AxisTransfer::from(slow) };
        let axes = [AxisTransfer::from(slow), asymmetric, third];
        let count = allocations(|| {
            black_box(together(black_box(&axes), how, Timing::default(), &mut transits)).unwrap();
            black_box(third.arrivals()).unwrap();
        });
        assert_eq!(count, 0, "{way} {how:?}");
    }
}

/// Rest to rest in the families that need rest.
#[test]
fn a_smoother_plan_allocates_nothing() {
    let limits =
        LimitsSpec { max_snap: Some(4e3), max_higher_derivatives: vec![1e6, 1e9, 1e12, 1e15], ..limits() };
    for length in [1e-6, 0.1, 10.0] {
        let (start, goal) = (State::at_rest(0.0), State::at_rest(length));
        let limits = limits.clone().try_into().unwrap();
        let problem = Problem::new(start, goal, limits, ShortPathPolicy::Reject).unwrap();
        let count = allocations(|| {
            black_box(plan_trigonometric(black_box(&problem))).unwrap();
            for order in 2..=8 {
                let planned = plan_polynomial(black_box(&problem), order).unwrap();
                black_box(planned.at(0.3 * planned.duration()));
            }
        });
        assert_eq!(count, 0, "over {length}");
    }
}

#[test]
fn reading_allocates_nothing() {
    let axis = AxisMoveSpec {
        axis: "x".into(),
        kind: Ok(AxisKind::Prismatic),
        start: State::at_rest(0.0),
        goal: State::at_rest(0.425),
        limits: limits(),
    };
    let spec = RequestSpec {
        axes: vec![axis],
        cycle_time_ns: None,
        family: Ok(Family::SCurve),
        order: None,
        short_path: Ok(ShortPathPolicy::Reject),
        synchronization: Ok(Synchronization::None),
        minimum_duration: None,
        end_on_cycle: false,
    };
    let request = Request::try_from(spec).unwrap();
    let plan = plan(&request).unwrap();
    let profile = &plan.axes()[0].profile;
    let AxisProblem::Along(problem) = &request.axes()[0].problem else { panic!("from rest to rest") };
    let planned = plan_move(problem).unwrap();
    let mut cursor = Cursor::new(profile);
    let mut sampler = plan.sampler();
    let mut columns = [[f64::NAN; 1300]; 4];

    let count = allocations(|| {
        for cycle in (0..1300).chain((0..1300).rev()) {
            let time = plan.cycle_time().start_of(cycle);
            black_box((planned.at(time), profile.at(time), cursor.at(time)));
            for setpoint in sampler.at(cycle) {
                black_box(setpoint);
            }
        }
        sampler.fill(0, 0, columns.each_mut().map(|column| column.as_mut_slice()));
    });
    assert_eq!(count, 0);
    assert!((columns[0][1299] - 0.425).abs() < f64::EPSILON);
}

/// One command after another, met and not met, under every policy that adjusts.
#[test]
fn a_command_of_position_velocity_and_time_allocates_nothing() {
    for policy in [PvtPolicy::PreferVelocity, PvtPolicy::PreferPosition, PvtPolicy::ExtendTime] {
        let limits = LimitsSpec { max_deceleration: Some(3.0), ..limits() };
        let mut planner = PvtPlanner::new(State::at_rest(0.0), limits.try_into().unwrap(), policy).unwrap();
        let targets = [(0.002, 0.1), (0.1, 0.1), (-0.1, -0.4), (0.0, 0.0), (0.0, 0.5), (0.02, 0.45)];
        let count = allocations(|| {
            for (position, velocity) in targets {
                let target = PvtTarget { position, velocity, duration: 0.05 };
                black_box(planner.command(black_box(target))).unwrap();
            }
        });
        assert_eq!(count, 0, "{policy:?}");
    }
}

/// A splice makes a plan, which is kept: so many pieces of memory for each kind, operation by operation (hold, resume, override,
/// retarget), and no more.
#[test]
fn a_splice_allocates_what_it_keeps() {
    let counts = splices::motions().map(|(_, motion)| {
        splices::operations(&motion).map(|(_, motion, operation)| {
            // Each is given back, too.
            allocations(|| drop(black_box(motion.splice(splices::AT + 1, &operation).unwrap()))) / 2
        })
    });
    // One axis; six each alone, on a line, and arriving together.
    let most = [[16, 17, 17, 18], [41, 42, 42, 48], [91, 48, 93, 141], [58, 54, 58, 55]];
    let within = counts.iter().flatten().zip(most.iter().flatten()).all(|(count, most)| count <= most);
    assert!(within, "{counts:?}, at most {most:?}");
}

/// Of every family without an order, from and to any state inside the limits, with limits of its own: from the second move on.
#[test]
fn the_moves_of_a_series_allocate_nothing() {
    for family in [Family::SCurve, Family::Trapezoidal, Family::Trigonometric] {
        let still = State::at_rest(0.0);
        let axis = AxisMoveSpec {
            axis: "x".into(),
            kind: Ok(AxisKind::Prismatic),
            start: still,
            goal: still,
            limits: limits(),
        };
        let mut series = MoveSeries::like(RequestSpec {
            axes: vec![axis],
            cycle_time_ns: None,
            family: Ok(family),
            order: None,
            short_path: Ok(ShortPathPolicy::Reverse),
            synchronization: Ok(Synchronization::None),
            minimum_duration: None,
            end_on_cycle: false,
        })
        .unwrap();
        let part = if family == Family::SCurve { 1.0 } else { 0.0 };
        let moves = |series: &mut MoveSeries| {
            for number in 1..100 {
                let share = f64::from(number) / 100.0;
                series.limit(|limits| limits.max_deceleration = Some(1.0 + share));
                let start =
                    State { position: 0.0, velocity: 0.3 * share * part, acceleration: -0.5 * share * part };
                let goal = State { position: share, velocity: -0.4 * share * part, acceleration: 0.0 };
                black_box(series.answer(start, goal).unwrap().profile().duration());
            }
        };
        moves(&mut series);
        assert_eq!(allocations(|| moves(&mut series)), 0, "{family:?}");
    }
}
