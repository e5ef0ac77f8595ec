use planner::Plan;
use proto::{Reason, Rejected, pb};

/// How large a motion may be, and how many of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// The most streams at a time.
    pub streams: usize,
    /// The most streams of one identity at a time.
    pub streams_per_identity: usize,
    /// The most axes of one plan or stream, up to [`planner::MAX_AXES`].
    pub axes: usize,
    /// The most requests, or moves in columns, in a message of `PlanMany`.
    pub plans_per_message: usize,
    /// The most segments of a plan that is sent in, of all its axes together.
    pub segments: usize,
    /// The most cycles of a motion that is streamed.
    pub cycles: u64,
    /// The most points of a `PlanPvt` request, of all its axes together.
    pub pvt_points: usize,
    /// The farthest cycle that `SamplePlan` gives: its digest is rolled from cycle 1.
    pub sample_cycles: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            streams: 10_000,
            streams_per_identity: 10_000,
            axes: planner::MAX_AXES,
            // A few milliseconds of work for a core, and an answer of some 5 MB.
            plans_per_message: 4096,
            segments: 1_000_000,
            // A thousand hours at 1 ms.
            cycles: 3_600_000_000,
            // 10 000 of six axes: their plan fits a message.
            pvt_points: 60_000,
            // Ten hours at 1 ms.
            sample_cycles: 36_000_000,
        }
    }
}

impl Limits {
    /// Every limit by its setting.
    pub(crate) fn named(&self) -> [(&'static str, u64); 8] {
        let Self {
            streams,
            streams_per_identity,
            axes,
            plans_per_message,
            segments,
            cycles,
            pvt_points,
            sample_cycles,
        } = *self;
        [
            ("max-streams", streams as u64),
            ("max-streams-per-identity", streams_per_identity as u64),
            ("max-axes", axes as u64),
            ("max-plans-per-message", plans_per_message as u64),
            ("max-segments", segments as u64),
            ("max-cycles", cycles),
            ("max-pvt-points", pvt_points as u64),
            ("max-sample-cycles", sample_cycles),
        ]
    }

    /// Are `given` axes, in the list called `field`, as many as a request may have?
    pub(crate) fn admit_axes(&self, field: &str, given: usize) -> Result<(), Rejected> {
        if given <= self.axes {
            return Ok(());
        }
        let most = self.axes;
        let raise = if most < planner::MAX_AXES { ", or raise max_axes" } else { "" };
        let text = format!(
            "has {given} axes, and this server takes {most}: plan those apart that need not go together{raise}"
        );
        let rejected = Rejected::for_field(field, Reason::TooManyAxes, text);
        Err(rejected.with("given", given).with("allowed", most))
    }

    /// Are `given` requests, or moves, in the field called `field` as many as a message may have?
    pub(crate) fn admit_plans(&self, field: &str, given: usize) -> Result<(), Rejected> {
        let most = self.plans_per_message;
        if given <= most {
            return Ok(());
        }
        let text = format!(
            "has {given} {}, and this server takes {most} in a message: send them in several, on the same stream, or \
             raise max_plans_per_message",
            if field == "columns" { "moves" } else { "requests" }
        );
        let rejected = Rejected::for_field(field, Reason::TooManyPlans, text);
        Err(rejected.with("given", given).with("allowed", most))
    }

    /// Is a plan that is sent in as field `plan` as large as it may be?
    pub(crate) fn admit_plan(&self, plan: Option<&pb::Plan>) -> Result<(), Rejected> {
        let Some(plan) = plan else { return Ok(()) };
        self.admit_axes("plan.axes", plan.axes.len())?;
        self.admit_segments("plan.axes", plan.axes.iter().map(|axis| axis.segments.len()).sum())
    }

    /// Is the motion that a stream opens with as large as it may be?
    pub(crate) fn admit_motion(&self, field: &str, plan: &Plan) -> Result<(), Rejected> {
        let axes = format!("{field}.axes");
        self.admit_axes(&axes, plan.axes().len())?;
        let segments = plan.axes().iter().map(|axis| axis.profile.segments().len()).sum();
        self.admit_segments(&axes, segments)?;
        let (given, most) = (plan.cycle_count(), self.cycles);
        if given <= most {
            return Ok(());
        }
        let text = format!(
            "has {given} cycles, and this server streams {most}: shorten the motion, lengthen its cycle, or raise max_cycles"
        );
        let rejected = Rejected::for_field(field, Reason::TooManyCycles, text);
        Err(rejected.with("given", given).with("allowed", most))
    }

    fn admit_segments(&self, field: &str, given: usize) -> Result<(), Rejected> {
        let most = self.segments;
        if given <= most {
            return Ok(());
        }
        let text = format!(
            "has {given} segments of all axes together, and this server takes {most}: split the motion, or raise \
             max_segments"
        );
        let rejected = Rejected::for_field(field, Reason::TooManySegments, text);
        Err(rejected.with("given", given).with("allowed", most))
    }
}
