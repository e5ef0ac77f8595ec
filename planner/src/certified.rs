use alloc::vec::Vec;

use crate::explain::{Explanation, explain};
use crate::verify::{Certificate, Violation, certify_by};
use crate::{Alone, InvalidFields, Plan, PvtPointReport, PvtRequest, Request, Workers, plan_pvt_by};

/// A plan with the judge's certificate, whatever that says.
#[derive(Clone, Debug, PartialEq)]
pub struct Judged {
    plan: Plan,
    certificate: Certificate,
}

impl Judged {
    /// Plans a request and judges the answer.
    ///
    /// # Errors
    /// Those of [`plan`](crate::plan).
    pub fn answer(request: &Request) -> Result<Self, InvalidFields> {
        crate::plan(request).map(Self::new)
    }

    /// Judges `plan`.
    #[must_use]
    pub fn new(plan: Plan) -> Self {
        Self::new_by(plan, &Alone)
    }

    /// As [`new`](Self::new), by `workers` who each judge some of the axes.
    #[must_use]
    pub fn new_by(plan: Plan, workers: &impl Workers) -> Self {
        let certificate = certify_by(&plan, workers);
        Self { plan, certificate }
    }

    /// The plan.
    #[must_use]
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// What the judge found.
    #[must_use]
    pub fn certificate(&self) -> &Certificate {
        &self.certificate
    }

    /// Which limits hold the motion back: told when it is asked for, as a motion under way is spliced more often than it is explained.
    #[must_use]
    pub fn explanation(&self) -> Explanation<'_> {
        explain(&self.plan)
    }

    /// The plan as one that may be executed.
    ///
    /// # Errors
    /// Everything that it promises and does not keep.
    pub fn accepted(self) -> Result<Accepted, Rejection> {
        let violations: Vec<Violation> = self.certificate.violations().collect();
        if violations.is_empty() { Ok(Accepted(self)) } else { Err(Rejection { violations }) }
    }
}

/// A plan through points with the judge's certificate, and what became of each point.
#[derive(Clone, Debug, PartialEq)]
pub struct JudgedPvt {
    judged: Judged,
    points: Vec<PvtPointReport>,
}

impl JudgedPvt {
    /// Plans a request and judges the answer.
    ///
    /// # Errors
    /// Those of [`plan_pvt`](crate::plan_pvt).
    pub fn answer(request: &PvtRequest) -> Result<Self, InvalidFields> {
        Self::answer_by(request, &Alone)
    }

    /// As [`answer`](Self::answer), to the last bit, with `workers` who each plan and judge some of the axes.
    ///
    /// # Errors
    /// Those of [`plan_pvt`](crate::plan_pvt).
    pub fn answer_by(request: &PvtRequest, workers: &impl Workers) -> Result<Self, InvalidFields> {
        let (plan, points) = plan_pvt_by(request, workers)?.into_parts();
        Ok(Self { judged: Judged::new_by(plan, workers), points })
    }

    /// Judges `plan`.
    #[must_use]
    pub fn new(plan: Plan, points: Vec<PvtPointReport>) -> Self {
        Self { judged: Judged::new(plan), points }
    }

    /// The plan with its certificate.
    #[must_use]
    pub fn judged(&self) -> &Judged {
        &self.judged
    }

    /// One report for each axis and point, axis by axis.
    #[must_use]
    pub fn points(&self) -> &[PvtPointReport] {
        &self.points
    }
}

/// A plan that the judge has nothing against: the only kind that is streamed or sampled.
#[derive(Clone, Debug, PartialEq)]
pub struct Accepted(Judged);

impl Accepted {
    /// The plan.
    #[must_use]
    pub fn plan(&self) -> &Plan {
        &self.0.plan
    }

    /// The plan with its certificate.
    #[must_use]
    pub fn judged(&self) -> &Judged {
        &self.0
    }
}

/// Why the judge rejects a plan: never empty.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", Worded(.violations))]
pub struct Rejection {
    /// What is promised and not kept, joins first.
    pub violations: Vec<Violation>,
}

/// The first of a list in words, and how many more there are.
struct Worded<'a>(&'a [Violation]);

impl core::fmt::Display for Worded<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let [first, rest @ ..] = self.0 else { return Ok(()) };
        write!(f, "{first}")?;
        if rest.is_empty() { Ok(()) } else { write!(f, "; and {} more", rest.len()) }
    }
}
