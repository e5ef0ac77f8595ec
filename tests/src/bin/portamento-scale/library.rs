//! What the library's work costs, in CPU time of one thread of this process.

use std::hint::black_box;
use std::process::Command;

use e2e::{fifty_millimetres, planned_pvt, resident_kib, swing, together};
use planner::{Accepted, Alone, Judged, JudgedPvt, PvtRequest, Request, RequestSpec, certify, plan};
use prost::Message as _;
use proto::{encode_plan, encode_pvt, pb, plan_from_wire};
use rustix::time::{ClockId, clock_gettime};

use crate::Failed;
use crate::measured::{Measured, median};

pub(crate) const AXES: [usize; 7] = [1, 2, 4, 8, 16, 32, 64];
pub(crate) const POINTS: [usize; 7] = [10, 30, 100, 300, 1000, 3000, 10_000];
/// From one point of a table to the next \[s\].
pub(crate) const BEAT: f64 = 0.05;

pub(crate) fn measure(into: &mut Measured) -> Result<(), Failed> {
    for axes in AXES {
        by_axes(axes, into)?;
    }
    for points in POINTS {
        for axes in [1, 6] {
            by_points(points, axes, into)?;
        }
        by_pieces(points, into)?;
    }
    Ok(())
}

/// Axes that arrive together.
fn by_axes(axes: usize, into: &mut Measured) -> Result<(), Failed> {
    let spec = together(axes, &fifty_millimetres());
    let request = Request::try_from(spec.clone())?;
    let bytes = pb::PlanRequest::from(spec).encode_to_vec();
    let planned = plan(&request)?;
    let answer = || {
        let wire = pb::PlanRequest::decode(bytes.as_slice()).unwrap_or_default();
        let request = Request::try_from(RequestSpec::from(wire)).ok()?;
        Some(encode_plan(&Judged::answer(&request).ok()?).len())
    };
    answer().ok_or("a move of several axes cannot be read again")?;
    let n = axes as f64;
    // One alone, from rest to rest, has a short way of its own.
    into.add("plan", if axes == 1 { "plan, alone" } else { "plan" }, n, 1e6 * timed(|| plan(&request)));
    into.add("plan", "judge", n, 1e6 * timed(|| certify(&planned)));
    into.add("plan", "from bytes to bytes", n, 1e6 * timed(answer));
    Ok(())
}

/// A table of points.
fn by_points(points: usize, axes: usize, into: &mut Measured) -> Result<(), Failed> {
    let spec = swing(axes, points, BEAT * points as f64);
    let request = PvtRequest::try_from(spec.clone())?;
    let bytes = pb::PlanPvtRequest::from(spec).encode_to_vec();
    let answer = || {
        let wire = pb::PlanPvtRequest::decode(bytes.as_slice()).unwrap_or_default();
        let request = PvtRequest::try_from(planner::PvtRequestSpec::from(wire)).ok()?;
        Some(encode_pvt(&JudgedPvt::answer(&request).ok()?, &Alone).encode_to_vec().len())
    };
    answer().ok_or("a table cannot be read again")?;
    let (n, axes) = (points as f64, if axes == 1 { "1 axis" } else { "6 axes" });
    into.add("points", &format!("plan and judge, {axes}"), n, 1e3 * timed(|| JudgedPvt::answer(&request)));
    into.add("points", &format!("from bytes to bytes, {axes}"), n, 1e3 * timed(answer));
    Ok(())
}

/// A plan of many pieces, of one axis.
fn by_pieces(points: usize, into: &mut Measured) -> Result<(), Failed> {
    let plan = planned_pvt(swing(1, points, BEAT * points as f64));
    let bytes = encode_plan(plan.judged());
    let read = || -> Option<Accepted> {
        Judged::new(plan_from_wire(pb::Plan::decode(bytes.clone()).ok()?).ok()?).accepted().ok()
    };
    read().ok_or("a plan cannot be read again")?;
    let cycles = plan.plan().cycle_count();
    let in_order = || {
        let mut sampler = plan.plan().sampler();
        (0..cycles)
            .flat_map(|cycle| sampler.at(cycle).next())
            .map(|setpoint| setpoint.state.position)
            .sum::<f64>()
    };
    // Steps of the golden section come to every part of the plan in turn, and never to the next piece.
    let anywhere = || {
        let mut sampler = plan.plan().sampler();
        let cycle = |step: u64| ((step as f64 * 0.618_033_988_749_895).fract() * cycles as f64) as u64;
        (0..cycles)
            .flat_map(|step| sampler.at(cycle(step)).next())
            .map(|setpoint| setpoint.state.position)
            .sum::<f64>()
    };
    let n = plan.plan().axes()[0].profile.segments().len() as f64;
    into.add("pieces", "read and judge", n, 1e6 * timed(read));
    into.add("sample", "in order", n, 1e9 * timed(in_order) / cycles as f64);
    into.add("sample", "anywhere", n, 1e9 * timed(anywhere) / cycles as f64);
    into.add("pieces memory", "in the process", n, weighed(points)?);
    into.add("pieces memory", "on the wire", n, bytes.len() as f64 / 1024.0);
    Ok(())
}

/// Asks a process of its own, whose heap has nothing else to give, for [`weigh`].
fn weighed(points: usize) -> Result<f64, Failed> {
    let output = Command::new(std::env::current_exe()?).args(["--weigh", &points.to_string()]).output()?;
    Ok(String::from_utf8(output.stdout)?.trim().parse()?)
}

/// Memory of a plan through points that is kept [KiB]: of so many copies that what the process has besides does not show.
pub(crate) fn weigh(points: usize) -> Result<f64, Failed> {
    let plan = planned_pvt(swing(1, points, BEAT * points as f64));
    let copies = 500_000 / (points + 10) + 2;
    let mut kept = Vec::with_capacity(copies);
    let before = resident_kib(std::process::id())? as f64;
    kept.resize_with(copies, || plan.clone());
    let after = resident_kib(std::process::id())? as f64;
    drop(black_box(kept));
    Ok((after - before) / copies as f64)
}

/// The least time of a round \[s\]: a thousand times what reading the clock takes.
const ROUND: f64 = 2e-3;
const ROUNDS: usize = 5;

/// CPU time of one operation, the median of rounds \[s\].
fn timed<T>(mut operation: impl FnMut() -> T) -> f64 {
    let mut of = |count: usize| {
        let begun = processor_time();
        for _ in 0..count {
            black_box(operation());
        }
        processor_time() - begun
    };
    of(1);
    let mut count = 1;
    while of(count) < ROUND {
        count *= 2;
    }
    let mut rounds: Vec<f64> = (0..ROUNDS).map(|_| of(count) / count as f64).collect();
    rounds.sort_unstable_by(f64::total_cmp);
    median(&rounds)
}

/// What this thread has taken of a processor so far \[s\]: while others have it, it stands still.
fn processor_time() -> f64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}
