//! The flags that set the fields of a request, so that a refusal speaks of what was typed.

use clap::ValueEnum;

use super::motion::ShortPath;
use super::pvt::{Interpolation, Policy};
use crate::law::FamilyName;

/// Fields of a request made from flags, and the flags that set them. Where one name begins with another, it
/// comes first.
const FLAGS: [(&str, &str); 27] = [
    ("interpolation", "--interpolation"),
    ("policy", "--policy"),
    ("finish_unreached", "--finish-unreached"),
    ("cycle_time", "--cycle-time"),
    ("family", "--family"),
    ("order", "--order"),
    ("short_path_policy", "--short-path"),
    ("minimum_duration", "--minimum-duration"),
    ("end_on_cycle", "--end-on-cycle"),
    ("start.position", "--from"),
    ("start.velocity", "--start-velocity"),
    ("start.acceleration", "--start-acceleration"),
    ("goal.position", "--to or --distance"),
    ("goal.velocity", "--end-velocity"),
    ("goal.acceleration", "--end-acceleration"),
    ("limits.max_velocity_reverse", "--max-velocity-reverse"),
    ("limits.max_velocity", "--max-velocity"),
    ("limits.max_acceleration", "--max-acceleration"),
    ("limits.max_jerk", "--max-jerk"),
    ("limits.max_deceleration", "--max-deceleration"),
    ("limits.min_position", "--min-position"),
    ("limits.max_position", "--max-position"),
    ("limits.feed_rate", "--feed-rate"),
    ("limits.max_snap", "--max-snap"),
    ("limits.max_higher_derivatives", "--max-higher-derivatives"),
    ("limits", "--max-velocity and the other limits"),
    ("axis", "--axis"),
];

/// The flag that sets the field, so that a refusal speaks of what was typed; of a flag with several values, which of them. All axes have
/// what the flags say.
pub(crate) fn flag_of(field: &str) -> Option<String> {
    let of_axis = field.strip_prefix("axes[").and_then(|rest| rest.split_once("]."));
    let field = of_axis.map_or(field, |(_, field)| field);
    let (list, index) = match field.strip_suffix(']').and_then(|rest| rest.rsplit_once('[')) {
        Some((list, index)) => (list, index.parse::<usize>().ok()),
        None => (field, None),
    };
    let (_, flag) = FLAGS.iter().find(|(name, _)| *name == list)?;
    Some(match index {
        Some(index) => format!("{flag}, value {}", index + 1),
        None => (*flag).to_owned(),
    })
}

/// A text with flags in place of the fields that it names, and with their values in place of the names that a request has for these.
pub(crate) fn in_flags(text: &str) -> String {
    // `order` and `family` are words as well. A limit is called by its last name where its neighbours are named beside it.
    let full = FLAGS.iter().filter(|(name, _)| name.contains(['.', '_'])).copied();
    let last = FLAGS.iter().filter_map(|(name, flag)| Some((name.strip_prefix("limits.")?, *flag)));
    let text = full.chain(last).fold(text.to_owned(), |text, (name, flag)| text.replace(name, flag));
    let values: Vec<String> = FamilyName::names()
        .chain(ShortPath::names())
        .chain(Policy::names())
        .chain(Interpolation::names())
        .collect();
    let is_of_a_name = |c: char| c.is_ascii_uppercase() || c == '_';
    let mut out = String::with_capacity(text.len());
    let mut rest = text.as_str();
    while let Some(begin) = rest.find(is_of_a_name) {
        let (before, from) = rest.split_at(begin);
        let (name, after) = from.split_at(from.find(|c| !is_of_a_name(c)).unwrap_or(from.len()));
        let value = name.to_ascii_lowercase().replace('_', "-");
        out.push_str(before);
        out.push_str(if values.contains(&value) { &value } else { name });
        rest = after;
    }
    out.push_str(rest);
    out
}

/// The values that a flag takes.
pub(crate) trait Names: ValueEnum + 'static {
    fn names() -> impl Iterator<Item = String> {
        let values = Self::value_variants().iter().filter_map(Self::to_possible_value);
        values.map(|value| value.get_name().to_owned())
    }
}

impl<T: ValueEnum + 'static> Names for T {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refusal_speaks_as_the_command_line_does() {
        let rows = [
            ("choose S_CURVE", "choose s-curve"),
            (
                "choose REJECT, NEAREST_VELOCITY or MATCH_START_VELOCITY",
                "choose reject, nearest-velocity or match-start-velocity",
            ),
            (
                "the family TRIGONOMETRIC has order 3, raise limits.max_jerk",
                "the family trigonometric has order 3, raise --max-jerk",
            ),
            ("give max_velocity and max_jerk", "give --max-velocity and --max-jerk"),
            ("exchange min_position and max_position", "exchange --min-position and --max-position"),
            ("is NaN in µm, PATH_TOO_SHORT, S_CURVED", "is NaN in µm, PATH_TOO_SHORT, S_CURVED"),
        ];
        for (text, expected) in rows {
            assert_eq!(in_flags(text), expected);
        }
    }

    #[test]
    fn a_field_has_its_flag() {
        let rows = [
            ("axes[0].limits.max_jerk", Some("--max-jerk")),
            ("axes[0].limits.max_higher_derivatives", Some("--max-higher-derivatives")),
            ("axes[0].limits.max_higher_derivatives[1]", Some("--max-higher-derivatives, value 2")),
            ("order", Some("--order")),
            ("axes", None),
            ("axes[0]", None),
            ("axes[0].axis", Some("--axis")),
        ];
        for (field, flag) in rows {
            assert_eq!(flag_of(field).as_deref(), flag, "{field}");
        }
    }
}
