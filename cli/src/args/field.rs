//! The flags that set the fields of a request, so that a refusal speaks of what was typed.

/// Fields of a request made from flags, and the flags that set them. Where one name begins with another, it
/// comes first.
const FLAGS: [(&str, &str); 25] = [
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
];

/// The flag that sets the field, so that a refusal speaks of what was typed. All axes have what the flags say.
pub(crate) fn flag_of(field: &str) -> Option<&'static str> {
    let of_axis = field.strip_prefix("axes[").and_then(|rest| rest.split_once("]."));
    let field = of_axis.map_or(field, |(_, field)| field);
    FLAGS.iter().find(|(name, _)| *name == field).map(|(_, flag)| *flag)
}

/// A text with flags in place of the fields that it names.
pub(crate) fn in_flags(text: &str) -> String {
    // `order` and `family` are words as well.
    let names = FLAGS.iter().filter(|(name, _)| name.contains(['.', '_']));
    names.fold(text.to_owned(), |text, (name, flag)| text.replace(name, flag))
}
