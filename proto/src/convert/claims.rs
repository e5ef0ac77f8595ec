//! What a plan says of itself, held against what it is.

use planner::{
    AdjustmentReason, Family, Field, InvalidField, InvalidFields, LIMIT_TOLERANCE, Law, Maker, Method, Plan,
    PvtInterpolation, PvtMethod, Quantity, Segment, Shortest, Why,
};

use crate::{fingerprint, pb};

/// The statements of a plan on the wire that its motion proves or disproves. What was only asked for (policy,
/// synchronization, whether to end on a cycle) is not among them, and neither are certificate and explanation, which
/// are computed again.
///
/// A plan that somebody wrote by hand may leave any of them out: zero, and an empty text, say nothing.
pub(super) struct Claims {
    cycle_count: u64,
    duration: f64,
    method: Option<Method>,
    guaranteed: Vec<Quantity>,
    fingerprint: Option<Why>,
}

impl Claims {
    /// What `wire` says; method and guarantees have been read already.
    pub(super) fn of(wire: &pb::Plan, method: Option<Method>, guaranteed: &[Quantity]) -> Self {
        let &pb::Plan { cycle_count, duration, .. } = wire;
        let guaranteed = guaranteed.to_vec();
        Self { cycle_count, duration, method, guaranteed, fingerprint: wrong_fingerprint(wire) }
    }

    /// Everything that is said and not so.
    pub(super) fn against(&self, plan: &Plan) -> InvalidFields {
        let mut invalid = InvalidFields::default();
        if let Some(method) = self.method {
            self.against_method(&mut invalid, method, plan);
        }
        if self.cycle_count != 0 {
            note(&mut invalid, "cycle_count", self.cycle_count, plan.cycle_count());
        }
        let (said, is) = (self.duration, plan.duration());
        // Not `>`: NaN is wrong.
        let near = (said - is).abs() <= LIMIT_TOLERANCE * is;
        if said != 0.0 && !near {
            note(&mut invalid, "duration", Shortest(said), Shortest(is));
        }
        invalid.note("fingerprint", self.fingerprint.clone());
        invalid
    }

    fn against_method(&self, invalid: &mut InvalidFields, method: Method, plan: &Plan) {
        let pieces = || {
            plan.axes().iter().flat_map(|axis| {
                let stopped = axis.adjustments.iter().any(|a| a.reason == AdjustmentReason::ClosingStop);
                axis.profile.segments().iter().map(move |piece| (piece, stopped))
            })
        };
        if let Some(pvt) = method.pvt {
            self.against_points(invalid, method, pvt, &|interpolation| {
                pieces().all(|(piece, stopped)| joins(interpolation, &piece, stopped))
            });
            return;
        }
        let made_by = |family| pieces().all(|(piece, stopped)| makes(family, &piece, stopped));
        if !made_by(method.family) {
            let families = [Family::SCurve, Family::Trapezoidal, Family::Polynomial, Family::Trigonometric];
            let able: Vec<_> =
                families.into_iter().filter(|family| made_by(*family)).map(Family::name).collect();
            let able = if able.is_empty() { "of no family".to_owned() } else { able.join(" or ") };
            note(invalid, "method.family", method.family.name(), able);
            return;
        }
        let highest = pieces().map(|(piece, _)| order(&piece)).max();
        let order = method.family.order().or(highest).unwrap_or(method.order);
        if method.order != 0 {
            note(invalid, "method.order", method.order, order);
        }
        self.against_promises(invalid, Method { order, ..method });
    }

    /// The same of a plan through points; `joined_by` tells whether its pieces are those of an interpolation.
    fn against_points(
        &self,
        invalid: &mut InvalidFields,
        method: Method,
        pvt: PvtMethod,
        joined_by: &dyn Fn(PvtInterpolation) -> bool,
    ) {
        if !joined_by(pvt.interpolation) {
            use PvtInterpolation::{Cubic, Quintic, SShaped};
            let able = [SShaped, Cubic, Quintic].into_iter().filter(|&other| joined_by(other));
            let able: Vec<_> = able.map(PvtInterpolation::name).collect();
            let able =
                if able.is_empty() { "nothing that joins points".to_owned() } else { able.join(" or ") };
            note(invalid, "method.interpolation", pvt.interpolation.name(), able);
            return;
        }
        let made = Method::through_points(pvt);
        note(invalid, "method.family", method.family.name(), made.family.name());
        if method.order != 0 {
            note(invalid, "method.order", method.order, made.order);
        }
        self.against_promises(invalid, made);
    }

    fn against_promises(&self, invalid: &mut InvalidFields, made: Method) {
        let promises = made.promises();
        if !promises.iter().all(|promised| self.guaranteed.contains(promised)) {
            note(invalid, "guaranteed", listed(&self.guaranteed), listed(promises));
        }
    }
}

/// The names of shapes that a plan states and that its motion does not have, found by planning it again. A motion that is not the one
/// its method gives has no names to compare; of a speed, every motion has its own.
#[must_use]
pub fn misclassified(plan: &Plan) -> InvalidFields {
    let mut invalid = InvalidFields::default();
    for (index, axis) in plan.axes().iter().enumerate() {
        let Some(is) = planner::classified_again(plan, axis) else { continue };
        let said = axis.classification;
        let mut inner = InvalidFields::default();
        let name = |name: Option<&'static str>| name.unwrap_or("nothing");
        let mut compare = |field, said: Option<&'static str>, is: Option<&'static str>| {
            if said.is_some() {
                note(&mut inner, field, name(said), name(is));
            }
        };
        compare("eight_type", said.eight_type.map(|t| t.name()), is.eight_type.map(|t| t.name()));
        compare(
            "asymmetric_type",
            said.asymmetric_type.map(|t| t.name()),
            is.asymmetric_type.map(|t| t.name()),
        );
        compare("six_case", said.six_case.map(|c| c.name()), is.six_case.map(|c| c.name()));
        // Not `>`: NaN is wrong. Unset is 0.
        let near = (said.feed_rate - is.feed_rate).abs() <= LIMIT_TOLERANCE * is.feed_rate;
        if said.feed_rate != 0.0 && !near {
            note(&mut inner, "feed_rate", Shortest(said.feed_rate), Shortest(is.feed_rate));
        }
        let outer = Field::named("classification").within(&Field::element("axes", index));
        invalid.extend_within(&outer, inner);
    }
    invalid
}

/// Notes that `field` says what is not so.
fn note<S: PartialEq<I> + ToString, I: ToString>(invalid: &mut InvalidFields, field: &str, said: S, is: I) {
    if said != is {
        let (given, correct) = (said.to_string(), is.to_string());
        invalid.push(InvalidField::new(Field::named(field), Why::Misstated { given, correct }));
    }
}

/// Does `family` lay such a piece? A stop after it is jerk-limited, whatever it comes after.
fn makes(family: Family, piece: &Segment, stopped: bool) -> bool {
    let constant_acceleration = piece.law == Law::ConstantJerk(0.0);
    match (family, piece.law) {
        (Family::SCurve | Family::Polynomial, Law::ConstantJerk(_)) => true,
        (Family::Trapezoidal, Law::ConstantJerk(_)) => constant_acceleration || stopped,
        (Family::Trigonometric, Law::ConstantJerk(_)) => constant_acceleration,
        (Family::Polynomial, Law::Polynomial(_)) | (Family::Trigonometric, Law::CosineJerk { .. }) => true,
        (Family::SCurve | Family::Trapezoidal | Family::Trigonometric, Law::Polynomial(_))
        | (Family::SCurve | Family::Trapezoidal | Family::Polynomial, Law::CosineJerk { .. }) => false,
    }
}

/// Does `interpolation` join points by such a piece? A stop after it is jerk-limited, whatever it comes after.
fn joins(interpolation: PvtInterpolation, piece: &Segment, stopped: bool) -> bool {
    match (interpolation, piece.law) {
        (PvtInterpolation::SShaped | PvtInterpolation::Cubic, Law::ConstantJerk(_)) => true,
        (PvtInterpolation::Quintic, Law::ConstantJerk(_)) => stopped,
        (PvtInterpolation::Quintic, Law::Polynomial(derivatives)) => derivatives.order() == 5,
        (PvtInterpolation::SShaped | PvtInterpolation::Cubic, Law::Polynomial(_))
        | (_, Law::CosineJerk { .. }) => false,
    }
}

/// The order of the highest derivative that a piece states.
fn order(piece: &Segment) -> u32 {
    match piece.law {
        Law::ConstantJerk(0.0) => 2,
        Law::ConstantJerk(_) | Law::CosineJerk { .. } => 3,
        Law::Polynomial(derivatives) => derivatives.order() as u32,
    }
}

fn listed(quantities: &[Quantity]) -> String {
    let names: Vec<_> = quantities.iter().map(|quantity| quantity.to_string().to_uppercase()).collect();
    if names.is_empty() { "nothing".to_owned() } else { names.join(", ") }
}

/// Why the fingerprint is wrong, if it is. That of a planner of another version may count fields which this one does not
/// know, so only our own can be held against the plan.
fn wrong_fingerprint(wire: &pb::Plan) -> Option<Why> {
    let pb::Plan { fingerprint: given, planner_version, .. } = wire;
    let ours = planner_version.is_empty() || *planner_version == Maker::default().planner_version;
    if given.is_empty() || !ours {
        return None;
    }
    let correct = fingerprint(wire);
    let hex = |bytes: &[u8]| bytes.iter().map(|byte| format!("{byte:02x}")).collect::<String>();
    (*given != correct).then(|| Why::FingerprintMismatch { given: hex(given), correct: hex(&correct) })
}
