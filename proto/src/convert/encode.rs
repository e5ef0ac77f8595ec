//! Plans and what comes with them, straight from the motion to bytes.
//!
//! This is the only place that says what of a plan goes into which field: the trees of [`pb`] are read from these bytes.

use planner::{
    Adjustment, Alone, AxisPlan, Binding, Certificate, Classification, EndCheck, Explanation, JoinCheck,
    Judged, JudgedPvt, Law, LimitCheck, LimitsSpec, Maker, Method, Plan, PvtPointReport, PvtRegion, Reversal,
    Segment, State, Workers,
};
use prost::Message;
use prost::bytes::Bytes;
use xxhash_rust::xxh3::xxh3_128;

use super::choice::{
    family_to_wire, interpolation_to_wire, kind_to_wire, policy_to_wire, quantity_to_wire,
    short_path_to_wire, synchronization_to_wire,
};
use super::duration::cycle_time_to_wire;
use crate::write::{Writer, read};
use crate::{Detail, Rejected, outgoing, pb};

/// Of a fingerprint \[bytes\]; it is the first field of a plan.
const FINGERPRINT: usize = 16;
/// The key and the length that come before it.
const BEFORE: usize = 2;

/// A piece of constant jerk from a state, with its key and its length \[bytes\].
const PIECE: usize = 49;
/// What else there is of an axis, about: limits, checks, what holds it back \[bytes\].
const AXIS: usize = 1000;
/// What else there is of a plan, about \[bytes\].
const HEAD: usize = 200;
/// A report on a point, about \[bytes\].
const POINT: usize = 70;

/// The plan on the wire, with certificate, explanation and fingerprint.
#[must_use]
pub fn plan_to_wire(judged: &Judged) -> pb::Plan {
    read(plan(judged, Detail::Full, &Alone))
}

pub(super) fn plan_unexplained(judged: &Judged) -> pb::Plan {
    read(plan(judged, Detail::Motion, &Alone))
}

impl From<&Certificate> for pb::PlanCertificate {
    fn from(certificate: &Certificate) -> Self {
        read_of(|writer| self::certificate(writer, certificate))
    }
}

pub(super) fn adjustment_to_wire(adjustment: &Adjustment) -> pb::Adjustment {
    read_of(|writer| self::adjustment(writer, adjustment))
}

/// The report on a point of the axis called `name`.
#[must_use]
pub fn point_to_wire(report: &PvtPointReport, name: &str) -> pb::PvtPointReport {
    read_of(|writer| point(writer, report, name))
}

fn read_of<M: Message + Default>(write: impl FnOnce(&mut Writer)) -> M {
    let mut writer = Writer::default();
    write(&mut writer);
    read(writer)
}

/// The plan in bytes, as [`plan_to_wire`] has it in a tree.
#[must_use]
pub fn encode_plan(judged: &Judged) -> Bytes {
    plan(judged, Detail::Full, &Alone).into_bytes().into()
}

/// What became of a question about points in bytes, as [`pvt_to_wire`](super::pvt_to_wire) has it in a tree, by `workers` who each
/// write some axes and some of the reports: the same bytes from any number of them.
#[must_use]
pub fn encode_pvt(judged: &JudgedPvt, workers: &impl Workers) -> outgoing::PlanPvtResponse {
    let (axes, reports) = (judged.judged().plan().axes(), judged.points());
    let parts = workers.each_range(reports.len(), |range| {
        let mut points = Messages::with_room(range.len(), range.len() * POINT);
        for report in &reports[range] {
            let name = axes.get(report.axis).map_or("", |axis| &axis.axis);
            points.push(|writer| point(writer, report, name));
        }
        points.into_each()
    });
    let mut points = Vec::with_capacity(reports.len());
    parts.into_iter().for_each(|part| points.extend(part));
    let plan = plan(judged.judged(), Detail::Full, workers).into_bytes().into();
    outgoing::PlanPvtResponse { plan, points }
}

/// Answers to many requests in bytes.
#[derive(Debug)]
pub struct Outcomes {
    messages: Messages,
    detail: Detail,
}

impl Outcomes {
    /// None yet, with room for so many, though not for more than so many bytes: whoever asks decides on the one, and whoever answers
    /// on the other.
    #[must_use]
    pub fn with_room(count: usize, most_bytes: usize, detail: Detail) -> Self {
        let each = if detail == Detail::Full { HEAD + AXIS } else { HEAD };
        let bytes = count.saturating_mul(each).min(most_bytes);
        Self { messages: Messages::with_room(count, bytes), detail }
    }

    /// What became of the next request, with as much of the plan as is wanted.
    pub fn push(&mut self, answer: &Result<Judged, Rejected>) {
        let detail = self.detail;
        self.messages.push(|writer| match answer {
            Ok(judged) => writer.nested(1, |writer| plan_into(writer, judged, detail)),
            Err(rejected) => writer.given_bytes(2, &rejected.to_bytes()),
        });
    }

    /// How many answers there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.messages.ends.len()
    }

    /// Is there none?
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Of all of them \[bytes\].
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.messages.writer.len()
    }

    /// All of them as a message.
    #[must_use]
    pub fn into_wire(self) -> outgoing::PlanManyResponse {
        outgoing::PlanManyResponse { outcomes: self.messages.into_each().collect(), columns: None }
    }
}

/// Messages of one kind, written one after the other into the same place.
#[derive(Debug)]
struct Messages {
    writer: Writer,
    /// Where each of them ends.
    ends: Vec<usize>,
}

impl Messages {
    fn with_room(count: usize, bytes: usize) -> Self {
        Self { writer: Writer::with_room(bytes), ends: Vec::with_capacity(count) }
    }

    fn push(&mut self, write: impl FnOnce(&mut Writer)) {
        write(&mut self.writer);
        self.ends.push(self.writer.len());
    }

    fn into_each(self) -> impl Iterator<Item = Bytes> {
        let mut rest = Bytes::from(self.writer.into_bytes());
        let mut begin = 0;
        self.ends.into_iter().map(move |end| {
            let message = rest.split_to(end - begin);
            begin = end;
            message
        })
    }
}

/// Room for what will be written of axes, but for rare things.
fn room_for(axes: &[AxisPlan]) -> usize {
    let pieces: usize = axes.iter().map(|axis| axis.profile.segments().len()).sum();
    HEAD + pieces * PIECE + axes.len() * AXIS
}

/// A [`pb::Plan`], of which `workers` each write some axes.
fn plan(judged: &Judged, detail: Detail, workers: &impl Workers) -> Writer {
    let axes = judged.plan().axes();
    let parts = workers.each_range(axes.len(), |range| {
        // Whoever begins writes what is before the axes, and the rest is appended to it.
        let begins = range.start == 0;
        let mut writer = Writer::with_room(room_for(if begins { axes } else { &axes[range.clone()] }));
        if begins {
            head(&mut writer, judged.plan(), detail);
        }
        axes[range].iter().for_each(|one| writer.nested(6, |writer| axis(writer, one)));
        writer
    });
    let mut parts = parts.into_iter();
    let mut writer = parts.next().unwrap_or_default();
    parts.for_each(|part| writer.append(&part));
    foot(&mut writer, judged, detail);
    seal(&mut writer, 0, detail);
    writer
}

/// The same, into a message that is begun.
fn plan_into(writer: &mut Writer, judged: &Judged, detail: Detail) {
    let begin = writer.len();
    head(writer, judged.plan(), detail);
    judged.plan().axes().iter().for_each(|one| writer.nested(6, |writer| axis(writer, one)));
    foot(writer, judged, detail);
    seal(writer, begin, detail);
}

/// What comes before the axes; of the fingerprint, its place.
fn head(writer: &mut Writer, plan: &Plan, detail: Detail) {
    if detail == Detail::Full {
        writer.given_bytes(1, &[0; FINGERPRINT]);
    }
    writer.text(2, &plan.maker().planner_version);
    writer.message(3, &cycle_time_to_wire(plan.cycle_time()));
    writer.whole(4, plan.cycle_count());
    writer.double(5, plan.duration());
}

/// What comes after them.
fn foot(writer: &mut Writer, judged: &Judged, detail: Detail) {
    let plan = judged.plan();
    match detail {
        Detail::Full => {
            writer.nested(7, |writer| certificate(writer, judged.certificate()));
            writer.nested(8, |writer| explanation(writer, &judged.explanation()));
        }
        Detail::Motion => writer.nested(7, |writer| writer.flag(4, judged.certificate().passed())),
    }
    let Maker { planner_version: _, evaluation_version } = plan.maker();
    writer.whole(9, u64::from(*evaluation_version));
    let Method { family, order, short_path, synchronization, end_on_cycle, pvt } = plan.method();
    writer.nested(10, |writer| {
        writer.choice(1, family_to_wire(family));
        writer.whole(2, u64::from(order));
        writer.choice(3, short_path_to_wire(short_path));
        writer.choice(4, synchronization_to_wire(synchronization));
        writer.flag(5, end_on_cycle);
        if let Some(pvt) = pvt {
            writer.choice(6, interpolation_to_wire(pvt.interpolation));
            writer.choice(7, policy_to_wire(pvt.policy));
        }
    });
    writer.choices(11, plan.guaranteed().iter().copied().map(quantity_to_wire));
}

/// Puts the fingerprint of the plan that begins there into its place: that of all that comes after it.
fn seal(writer: &mut Writer, begin: usize, detail: Detail) {
    if detail == Detail::Full {
        let begin = begin + BEFORE;
        let fingerprint: [u8; FINGERPRINT] = xxh3_128(writer.since(begin + FINGERPRINT)).to_be_bytes();
        writer.since_mut(begin)[..FINGERPRINT].copy_from_slice(&fingerprint);
    }
}

fn axis(writer: &mut Writer, plan: &AxisPlan) {
    let AxisPlan { axis, kind, limits, profile, goal, adjustments, classification: class, pvt_regions } =
        plan;
    writer.text(1, axis);
    writer.choice(2, kind_to_wire(*kind));
    writer.nested(3, |writer| self::limits(writer, limits.spec()));
    profile.segments().iter().for_each(|piece| segment(writer, &piece));
    writer.nested(5, |writer| state(writer, *goal));
    writer.nested(6, |writer| state(writer, profile.end()));
    adjustments.iter().for_each(|one| writer.nested(7, |writer| adjustment(writer, one)));
    writer.nested(8, |writer| classification(writer, class, pvt_regions));
}

/// A [`pb::AxisSegment`].
fn segment(writer: &mut Writer, segment: &Segment) {
    let Segment { duration, start, law } = segment;
    writer.nested(4, |writer| {
        writer.double(1, *duration);
        writer.nested(2, |writer| state(writer, *start));
        match law {
            Law::ConstantJerk(jerk) => writer.given_double(3, *jerk),
            Law::Polynomial(derivatives) => {
                writer.nested(4, |writer| writer.doubles(1, derivatives.as_slice()));
            }
            Law::CosineJerk { peak } => writer.nested(5, |writer| writer.double(1, *peak)),
        }
    });
}

/// A [`pb::AxisState`].
fn state(writer: &mut Writer, state: State) {
    let State { position, velocity, acceleration } = state;
    writer.double(1, position);
    writer.double(2, velocity);
    writer.double(3, acceleration);
}

/// A [`pb::AxisLimits`].
fn limits(writer: &mut Writer, limits: &LimitsSpec) {
    let LimitsSpec {
        max_velocity,
        max_acceleration,
        max_jerk,
        max_deceleration,
        max_velocity_reverse,
        min_position,
        max_position,
        max_snap,
        max_higher_derivatives,
        feed_rate,
    } = limits;
    writer.double(1, *max_velocity);
    writer.double(2, *max_acceleration);
    writer.double(3, *max_jerk);
    let stated = [max_deceleration, max_velocity_reverse, min_position, max_position, max_snap];
    for (field, stated) in (4..).zip(stated) {
        stated.iter().for_each(|stated| writer.given_double(field, *stated));
    }
    writer.doubles(9, max_higher_derivatives);
    feed_rate.iter().for_each(|feed_rate| writer.given_double(10, *feed_rate));
}

/// A [`pb::Adjustment`].
fn adjustment(writer: &mut Writer, adjustment: &Adjustment) {
    let Adjustment { quantity, asked, planned, reason } = *adjustment;
    writer.choice(1, quantity_to_wire(quantity));
    writer.double(2, asked);
    writer.double(3, planned);
    writer.text(4, reason.name());
}

fn classification(writer: &mut Writer, classification: &Classification, regions: &[PvtRegion]) {
    let Classification { eight_type, asymmetric_type, six_case, feed_rate } = *classification;
    let names = [
        eight_type.map(|kind| kind.name()),
        asymmetric_type.map(|kind| kind.name()),
        six_case.map(|case| case.name()),
    ];
    for (field, name) in (1..).zip(names) {
        name.into_iter().for_each(|name| writer.given_text(field, name));
    }
    regions.iter().for_each(|region| writer.given_text(4, region.name()));
    writer.double(5, feed_rate);
}

fn certificate(writer: &mut Writer, certificate: &Certificate) {
    let Certificate { limits, joins, ends, reversals } = certificate;
    for check in limits {
        writer.nested(1, |writer| limit_check(writer, check));
    }
    for JoinCheck { axis, quantity, worst_jump, allowed, at_time, guaranteed } in joins {
        writer.nested(2, |writer| {
            writer.text(1, axis);
            writer.choice(2, quantity_to_wire(*quantity));
            writer.double(3, *worst_jump);
            writer.double(4, *at_time);
            writer.double(5, *allowed);
            writer.flag(6, *guaranteed);
        });
    }
    for EndCheck { axis, quantity, residual, allowed } in ends {
        writer.nested(3, |writer| {
            writer.text(1, axis);
            writer.choice(2, quantity_to_wire(*quantity));
            writer.double(3, *residual);
            writer.double(4, *allowed);
        });
    }
    writer.flag(4, certificate.passed());
    for Reversal { axis, at_time, position } in reversals {
        writer.nested(5, |writer| {
            writer.text(1, axis);
            writer.double(2, *at_time);
            writer.double(3, *position);
        });
    }
}

fn limit_check(writer: &mut Writer, check: &LimitCheck) {
    let LimitCheck { axis, quantity, limit, extremum, at_time, margin, guaranteed, led_back_by } = check;
    writer.text(1, axis);
    writer.choice(2, quantity_to_wire(*quantity));
    writer.double(3, *limit);
    writer.double(4, *extremum);
    writer.double(5, *at_time);
    writer.double(6, *margin);
    writer.flag(7, *guaranteed);
    led_back_by.iter().for_each(|by| writer.given_double(8, *by));
}

fn explanation(writer: &mut Writer, explanation: &Explanation<'_>) {
    let Explanation { critical_axis, bindings } = explanation;
    writer.text(1, critical_axis);
    for Binding { axis, quantity, from_time, to_time } in bindings {
        writer.nested(2, |writer| {
            writer.text(1, axis);
            writer.choice(2, quantity_to_wire(*quantity));
            writer.double(3, *from_time);
            writer.double(4, *to_time);
        });
    }
}

/// A [`pb::PvtPointReport`] on a point of the axis called `name`.
fn point(writer: &mut Writer, report: &PvtPointReport, name: &str) {
    let PvtPointReport { axis: _, point, region, position, velocity, time, reachable, adjustments } = report;
    writer.text(1, name);
    writer.whole(2, *point as u64);
    writer.text(3, region.map_or("", PvtRegion::name));
    writer.double(4, *position);
    writer.double(5, *velocity);
    writer.double(6, *time);
    if let Some((least, greatest)) = *reachable {
        writer.given_double(7, least);
        writer.given_double(8, greatest);
    }
    adjustments.iter().for_each(|one| writer.nested(9, |writer| adjustment(writer, one)));
}
