use core::fmt;

/// A number in the fewest digits that read back to the same bits, with an exponent where zeros would fill the line.
///
/// ```
/// # use planner::Shortest;
/// assert_eq!(Shortest(-0.002).to_string(), "-0.002");
/// assert_eq!(Shortest(6.25e-17).to_string(), "6.25e-17");
/// assert_eq!(Shortest(1e300).to_string(), "1e300");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shortest(pub f64);

impl Shortest {
    /// From here on there is an exponent …
    const LARGE: f64 = 1e6;
    /// … and below here.
    const SMALL: f64 = 1e-4;
}

impl fmt::Display for Shortest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value) = *self;
        let magnitude = value.abs();
        let plain = value == 0.0 || !value.is_finite() || (Self::SMALL..Self::LARGE).contains(&magnitude);
        if plain { write!(f, "{value}") } else { write!(f, "{value:e}") }
    }
}
