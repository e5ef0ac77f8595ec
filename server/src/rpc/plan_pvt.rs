use planner::JudgedPvt;
use proto::{Reason, Rejected, Threads, encode_pvt, outgoing, pb, pvt_request_from_wire};

/// From this many points on, an answer takes longer than the streams of this process may wait: about a millisecond.
const LONG: usize = 500;

/// From this many points on, threads are worth what it costs to make them: an answer takes a millisecond or two.
const LARGE: usize = 2_000;

/// One request is not to have all of a large machine.
const MOST_THREADS: usize = 4;

/// Of all axes together.
fn count(wire: &pb::PlanPvtRequest) -> usize {
    let of = |axis: &pb::PvtAxis| axis.times.len().max(axis.positions.len()).max(axis.velocities.len());
    wire.axes.iter().map(of).sum()
}

/// Is it to be answered on a thread of its own?
pub(super) fn is_long(wire: &pb::PlanPvtRequest) -> bool {
    count(wire) >= LONG
}

/// The plan through at most `most` points.
pub(super) fn plan(wire: pb::PlanPvtRequest, most: usize) -> Result<outgoing::PlanPvtResponse, Rejected> {
    let given = count(&wire);
    if given > most {
        let text = format!(
            "has {given} points, and this server takes {most} of all axes together: plan the table in parts, each from the \
             state in which the one before it ends, or raise max_pvt_points"
        );
        let rejected = Rejected::for_field("axes", Reason::TooManyPoints, text);
        return Err(rejected.with("given", given).with("allowed", most));
    }
    let request = pvt_request_from_wire(wire)?;
    let threads = if given < LARGE { Threads::new(1) } else { Threads::of_machine(MOST_THREADS) };
    Ok(encode_pvt(&JudgedPvt::answer_by(&request, &threads)?, &threads))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_points_than_the_limit_are_refused_by_name() {
        let axis = |points| pb::PvtAxis { times: vec![0.0; points], ..Default::default() };
        let wire = pb::PlanPvtRequest { axes: vec![axis(7), axis(4)], ..Default::default() };
        assert_eq!(count(&wire), 11);
        let rejected = plan(wire, 10).unwrap_err();
        assert_eq!((rejected.reason, rejected.fields[0].field.as_str()), (Reason::TooManyPoints, "axes"));
        assert!(rejected.message.contains("11 points") && rejected.message.contains("max_pvt_points"));
        assert_eq!(rejected.metadata["allowed"], "10");
        // Lists of different lengths count by the longest.
        let ragged = pb::PvtAxis { velocities: vec![0.0; 12], ..axis(1) };
        let wire = pb::PlanPvtRequest { axes: vec![ragged], ..Default::default() };
        assert_eq!(plan(wire, 10).unwrap_err().reason, Reason::TooManyPoints);
    }
}
