//! Many moves of one axis, in columns: as they are asked for, and as they are answered.

mod moves;
mod planned;

pub use moves::Moves;
pub use planned::{PlannedMove, PlannedMoves};

use planner::{AxisMoveSpec, Field, InvalidField, InvalidFields, LimitsSpec, RequestSpec, State};

use super::field::missing;
use super::request::spec_from_wire;
use crate::{FieldViolation, Reason, Rejected, pb};

/// Many moves of one axis: what they have in common, and a column for each number in which they differ. A column has a number
/// for each move, or none where `like` holds for all.
#[derive(Clone, Debug, PartialEq)]
pub struct MoveColumns {
    /// What all have in common, of one axis.
    pub like: RequestSpec,
    /// Where each begins [axis units].
    pub start_position: Vec<f64>,
    /// With which velocity [axis units/s].
    pub start_velocity: Vec<f64>,
    /// With which acceleration [axis units/s²].
    pub start_acceleration: Vec<f64>,
    /// Where each ends [axis units].
    pub goal_position: Vec<f64>,
    /// With which velocity [axis units/s].
    pub goal_velocity: Vec<f64>,
    /// With which acceleration [axis units/s²].
    pub goal_acceleration: Vec<f64>,
    /// Greatest speed [axis units/s], > 0.
    pub max_velocity: Vec<f64>,
    /// Greatest acceleration while speed grows [axis units/s²], > 0.
    pub max_acceleration: Vec<f64>,
    /// Greatest jerk [axis units/s³], > 0.
    pub max_jerk: Vec<f64>,
    /// Greatest acceleration while speed shrinks [axis units/s²], > 0.
    pub max_deceleration: Vec<f64>,
    /// Greatest speed towards falling positions [axis units/s], ≥ 0.
    pub max_velocity_reverse: Vec<f64>,
    /// The speed asked for along the move [axis units/s], > 0.
    pub feed_rate: Vec<f64>,
}

/// The names of the columns, and the path of the same number in a request.
const COLUMNS: [(&str, &str); 12] = [
    ("start_position", "axes[0].start.position"),
    ("start_velocity", "axes[0].start.velocity"),
    ("start_acceleration", "axes[0].start.acceleration"),
    ("goal_position", "axes[0].goal.position"),
    ("goal_velocity", "axes[0].goal.velocity"),
    ("goal_acceleration", "axes[0].goal.acceleration"),
    ("max_velocity", "axes[0].limits.max_velocity"),
    ("max_acceleration", "axes[0].limits.max_acceleration"),
    ("max_jerk", "axes[0].limits.max_jerk"),
    ("max_deceleration", "axes[0].limits.max_deceleration"),
    ("max_velocity_reverse", "axes[0].limits.max_velocity_reverse"),
    ("feed_rate", "axes[0].limits.feed_rate"),
];

impl MoveColumns {
    /// Moves like `like`, none yet.
    #[must_use]
    pub fn like(like: RequestSpec) -> Self {
        Self {
            like,
            start_position: Vec::new(),
            start_velocity: Vec::new(),
            start_acceleration: Vec::new(),
            goal_position: Vec::new(),
            goal_velocity: Vec::new(),
            goal_acceleration: Vec::new(),
            max_velocity: Vec::new(),
            max_acceleration: Vec::new(),
            max_jerk: Vec::new(),
            max_deceleration: Vec::new(),
            max_velocity_reverse: Vec::new(),
            feed_rate: Vec::new(),
        }
    }

    fn columns(&self) -> [&Vec<f64>; 12] {
        let Self {
            like: _,
            start_position,
            start_velocity,
            start_acceleration,
            goal_position,
            goal_velocity,
            goal_acceleration,
            max_velocity,
            max_acceleration,
            max_jerk,
            max_deceleration,
            max_velocity_reverse,
            feed_rate,
        } = self;
        [
            start_position,
            start_velocity,
            start_acceleration,
            goal_position,
            goal_velocity,
            goal_acceleration,
            max_velocity,
            max_acceleration,
            max_jerk,
            max_deceleration,
            max_velocity_reverse,
            feed_rate,
        ]
    }

    /// How many moves: as many as the longest column has numbers.
    #[must_use]
    pub fn len(&self) -> usize {
        self.columns().into_iter().map(Vec::len).max().unwrap_or_default()
    }

    /// Is there none?
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The moves of `range`, which lies inside.
    #[must_use]
    pub fn slice(&self, range: std::ops::Range<usize>) -> Self {
        let part = |column: &Vec<f64>| column.get(range.clone()).map(<[f64]>::to_vec).unwrap_or_default();
        Self {
            like: self.like.clone(),
            start_position: part(&self.start_position),
            start_velocity: part(&self.start_velocity),
            start_acceleration: part(&self.start_acceleration),
            goal_position: part(&self.goal_position),
            goal_velocity: part(&self.goal_velocity),
            goal_acceleration: part(&self.goal_acceleration),
            max_velocity: part(&self.max_velocity),
            max_acceleration: part(&self.max_acceleration),
            max_jerk: part(&self.max_jerk),
            max_deceleration: part(&self.max_deceleration),
            max_velocity_reverse: part(&self.max_velocity_reverse),
            feed_rate: part(&self.feed_rate),
        }
    }

    /// Move number `index` as a request of its own.
    #[must_use]
    pub fn request(&self, index: usize) -> RequestSpec {
        let mut spec = self.like.clone();
        for AxisMoveSpec { start, goal, limits, .. } in &mut spec.axes {
            (*start, *goal) = self.ends(index, *start, *goal);
            self.limit(index, limits);
        }
        spec
    }

    /// Start and goal of move number `index`; `start` and `goal` where they have no column.
    #[inline]
    fn ends(&self, index: usize, start: State, goal: State) -> (State, State) {
        let of = |column: &Vec<f64>, otherwise: f64| column.get(index).copied().unwrap_or(otherwise);
        let start = State {
            position: of(&self.start_position, start.position),
            velocity: of(&self.start_velocity, start.velocity),
            acceleration: of(&self.start_acceleration, start.acceleration),
        };
        let goal = State {
            position: of(&self.goal_position, goal.position),
            velocity: of(&self.goal_velocity, goal.velocity),
            acceleration: of(&self.goal_acceleration, goal.acceleration),
        };
        (start, goal)
    }

    /// Sets those of the limits that have a column to what they are of move number `index`.
    fn limit(&self, index: usize, limits: &mut LimitsSpec) {
        let set = |limit: &mut f64, column: &Vec<f64>| *limit = column.get(index).copied().unwrap_or(*limit);
        set(&mut limits.max_velocity, &self.max_velocity);
        set(&mut limits.max_acceleration, &self.max_acceleration);
        set(&mut limits.max_jerk, &self.max_jerk);
        let set = |limit: &mut Option<f64>, column: &Vec<f64>| *limit = column.get(index).copied().or(*limit);
        set(&mut limits.max_deceleration, &self.max_deceleration);
        set(&mut limits.max_velocity_reverse, &self.max_velocity_reverse);
        set(&mut limits.feed_rate, &self.feed_rate);
    }

    /// Do the limits differ from move to move?
    fn have_limits(&self) -> bool {
        self.columns().into_iter().skip(6).any(|column| !column.is_empty())
    }

    /// Every column that has neither a number for each move nor none.
    fn ragged(&self) -> Option<Rejected> {
        let expected = self.len();
        let lengths = || self.columns().into_iter().map(Vec::len).zip(COLUMNS);
        let (_, (longest, _)) = lengths().find(|(length, _)| *length == expected)?;
        let ragged = lengths().filter(|(length, _)| *length != 0 && *length != expected);
        let fields = ragged.map(|(given, (name, _))| {
            let text = format!(
                "has {given} numbers, and columns.{longest} has {expected}: give one for each move, or none where that of \
                 like holds for all"
            );
            FieldViolation::new(format!("columns.{name}"), Reason::LengthMismatch, text)
        });
        Some(Rejected::for_fields(fields.collect())?.with("needed", expected))
    }

    /// Where the numbers of move number `index` stand that `invalid` speaks of, as if it was a request of its own.
    fn located(&self, index: usize, invalid: &InvalidFields) -> InvalidFields {
        let mut located = InvalidFields::default();
        for InvalidField { field, why } in invalid.as_slice() {
            let columns = COLUMNS.into_iter().zip(self.columns());
            let mut own = columns.filter(|((_, path), column)| *path == field.as_str() && !column.is_empty());
            let path = match own.next() {
                Some(((name, _), _)) => format!("columns.{name}[{index}]"),
                None if field.as_str().is_empty() => "columns".to_owned(),
                None => format!("columns.like.{field}"),
            };
            located.push(InvalidField::new(Field::named(&path), why.clone()));
        }
        located
    }
}

impl From<MoveColumns> for pb::MoveColumns {
    fn from(columns: MoveColumns) -> Self {
        let MoveColumns {
            like,
            start_position,
            start_velocity,
            start_acceleration,
            goal_position,
            goal_velocity,
            goal_acceleration,
            max_velocity,
            max_acceleration,
            max_jerk,
            max_deceleration,
            max_velocity_reverse,
            feed_rate,
        } = columns;
        Self {
            like: Some(like.into()),
            start_position,
            start_velocity,
            start_acceleration,
            goal_position,
            goal_velocity,
            goal_acceleration,
            max_velocity,
            max_acceleration,
            max_jerk,
            max_deceleration,
            max_velocity_reverse,
            feed_rate,
        }
    }
}

/// The columns on the wire, and what is wrong with the durations of what they have in common. Whether the rest is sound is for its
/// constructors to say.
///
/// # Errors
/// [`Reason::FieldMissing`] without anything in common.
fn columns_from_wire(wire: pb::MoveColumns) -> Result<(InvalidFields, MoveColumns), Rejected> {
    let pb::MoveColumns {
        like,
        start_position,
        start_velocity,
        start_acceleration,
        goal_position,
        goal_velocity,
        goal_acceleration,
        max_velocity,
        max_acceleration,
        max_jerk,
        max_deceleration,
        max_velocity_reverse,
        feed_rate,
    } = wire;
    let like = like.ok_or_else(|| missing("columns.like", "what all moves have in common, of one axis"))?;
    let (malformed, like) = spec_from_wire(like);
    let columns = MoveColumns {
        like,
        start_position,
        start_velocity,
        start_acceleration,
        goal_position,
        goal_velocity,
        goal_acceleration,
        max_velocity,
        max_acceleration,
        max_jerk,
        max_deceleration,
        max_velocity_reverse,
        feed_rate,
    };
    Ok((malformed, columns))
}
