//! Numbers for people: as many digits as help, one column like the next.

use planner::{AxisKind, CycleTime, Quantity};

/// Of the largest value in a column [1]: what is less is a rounding, and shown as zero.
const NOISE: f64 = 1e-12;
/// Digits that the smallest value of a column keeps at least, and so does the difference between its ends.
const LEAST_DIGITS: i32 = 3;
/// A column all of which is less has exponents: zeros in front say nothing.
const SMALL: f64 = 1e-4;
/// What a number in a column may have beside its digits: the rest of a large one, point and sign.
const BESIDE: i32 = 7;
/// The longest number by itself in fixed notation; past it an exponent is shorter.
const LONGEST_ALONE: usize = 10;

/// The values of one column. What is far below the largest is a rounding, and shown as zero.
///
/// All have one number of decimals, with `digits` significant ones for the largest, and zeros that all have at the end
/// left out. Where that would take digits from the smallest, or hide what the values differ by, or take too much room,
/// each value has digits of its own.
pub(crate) fn column(values: &[f64], digits: i32) -> Vec<String> {
    let largest = values.iter().copied().map(f64::abs).filter(|v| v.is_finite()).fold(0.0, f64::max);
    let shown = |value: f64| if value.abs() <= NOISE * largest { 0.0 } else { value };
    exact_column(&values.iter().copied().map(shown).collect::<Vec<_>>(), digits)
}

/// As [`column`], of values none of which is a rounding, however small.
pub(crate) fn exact_column(values: &[f64], digits: i32) -> Vec<String> {
    let finite = || values.iter().copied().filter(|value| value.is_finite());
    let largest = finite().map(f64::abs).fold(0.0, f64::max);
    let smallest = finite().map(f64::abs).filter(|v| *v > 0.0).fold(f64::INFINITY, f64::min);
    let spread = finite().fold(f64::NEG_INFINITY, f64::max) - finite().fold(f64::INFINITY, f64::min);
    let alone = || values.iter().map(|&value| alone(value, digits)).collect();
    if largest < SMALL {
        return alone();
    }
    let places = |value: f64, digits: i32| digits - 1 - value.log10().floor() as i32;
    let mut least = places(largest, digits.min(LEAST_DIGITS + 1)).max(places(smallest, LEAST_DIGITS)).max(0);
    if spread > NOISE * largest {
        least = least.max(places(spread, LEAST_DIGITS));
    }
    let wanted = places(largest, digits).max(least);
    // The roundings of a double are not shown.
    let most = places(largest, f64::DIGITS as i32).max(0);
    let aligned = (least..=wanted.min(most)).rev().map(|decimals| fixed(values, decimals as usize));
    let longest = (digits + BESIDE) as usize;
    aligned.into_iter().find(|texts| texts.iter().all(|text| text.len() <= longest)).unwrap_or_else(alone)
}

/// One value with `digits` significant digits, or all of a whole number's, without zeros at the end.
fn alone(value: f64, digits: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return (value + 0.0).to_string();
    }
    let decimals = (digits - 1 - value.abs().log10().floor() as i32).max(0);
    let text = fixed(&[value], decimals as usize).remove(0);
    if value.abs() < SMALL || text.len() > LONGEST_ALONE { scientific(value, digits) } else { text }
}

fn fixed(values: &[f64], decimals: usize) -> Vec<String> {
    let mut texts: Vec<String> = values.iter().map(|value| format!("{value:.decimals$}")).collect();
    for text in &mut texts {
        // What rounds to zero is zero, without a sign.
        if text.starts_with('-') && text.bytes().all(|byte| matches!(byte, b'-' | b'0' | b'.')) {
            text.remove(0);
        }
    }
    let spare = texts
        .iter()
        .filter(|text| text.contains('.'))
        .map(|text| text.len() - text.trim_end_matches('0').len())
        .min()
        .unwrap_or(0);
    if decimals > 0 {
        let cut = if spare >= decimals { decimals + 1 } else { spare };
        for text in texts.iter_mut().filter(|text| text.contains('.')) {
            text.truncate(text.len() - cut);
        }
    }
    texts
}

fn scientific(value: f64, digits: i32) -> String {
    let text = format!("{:.*e}", (digits - 1).clamp(2, 3) as usize, value);
    match text.split_once('e') {
        Some((mantissa, exponent)) if mantissa.contains('.') => {
            format!("{}e{exponent}", mantissa.trim_end_matches('0').trim_end_matches('.'))
        }
        _ => text,
    }
}

/// One value with six significant digits, without zeros at the end.
pub(crate) fn plain(value: f64) -> String {
    column(&[value], 6).remove(0)
}

/// A share as a percentage.
pub(crate) fn percent(share: f64) -> String {
    let percent = share * 100.0;
    if percent.abs() < 5e-8 { "0 %".to_owned() } else { format!("{} %", column(&[percent], 3).remove(0)) }
}

/// So many of something.
pub(crate) fn counted(count: u64, noun: &str) -> String {
    if count == 1 { format!("1 {noun}") } else { format!("{count} {noun}s") }
}

/// A cycle in the unit in which people say it.
pub(crate) fn cycle(cycle: CycleTime) -> String {
    let ns = cycle.as_ns();
    if ns < 1_000_000 {
        format!("{} us", plain(ns as f64 / 1e3))
    } else {
        format!("{} ms", plain(ns as f64 / 1e6))
    }
}

/// The unit of a quantity of an axis.
pub(crate) fn unit(kind: AxisKind, quantity: Quantity) -> String {
    let base = match kind {
        AxisKind::Prismatic => "m",
        AxisKind::Revolute => "rad",
        AxisKind::Pulses => "pulses",
    };
    match quantity {
        Quantity::Position => base.to_owned(),
        Quantity::Velocity => format!("{base}/s"),
        Quantity::Acceleration => format!("{base}/s²"),
        Quantity::Jerk => format!("{base}/s³"),
        Quantity::Snap => format!("{base}/s⁴"),
        Quantity::Crackle => format!("{base}/s⁵"),
        Quantity::Pop => format!("{base}/s⁶"),
        Quantity::Lock => format!("{base}/s⁷"),
        Quantity::Drop => format!("{base}/s⁸"),
        Quantity::Time => "s".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_lines_up_and_says_no_more_than_it_knows() {
        let rows: [(&[f64], &[&str]); 15] = [
            (&[0.0, 0.03, 0.0833333333], &["0.0000000", "0.0300000", "0.0833333"]),
            (&[100.0, 0.0, -100.0], &["100", "0", "-100"]),
            (&[1.0, 2.5, -1e-17], &["1.0", "2.5", "0.0"]),
            (&[1e-12, 0.0], &["1e-12", "0"]),
            (&[123456789.25, 1.0], &["123456789.25", "1.00"]),
            (&[123456789.25], &["123456789"]),
            (&[1.5e40, 2.0], &["1.5e40", "0"]),
            (&[0.0, -0.0], &["0", "0"]),
            (&[f64::NAN, -0.0], &["NaN", "0"]),
            // Short beside long: each keeps its digits.
            (&[0.03, 0.0533333333, 3999999.886], &["0.0300", "0.0533", "3999999.8860"]),
            (&[0.03, 0.0533333333, 12345678901.5], &["0.03", "0.0533333", "1.235e10"]),
            (&[1.5e-7, 2.5, 31622.7766], &["1.5e-7", "2.5", "31622.8"]),
            // A short way far from zero.
            (&[1e6, 1e6 + 0.0004500, 1e6 + 0.05], &["1000000.0000", "1000000.0005", "1000000.0500"]),
            // The roundings of a double are not digits.
            (&[1e9, 1e9 + 1e-7], &["1000000000", "1000000000"]),
            (&[7.0], &["7"]),
        ];
        for (values, expected) in rows {
            assert_eq!(column(values, 6), expected, "{values:?}");
        }
        // Nothing that lasts is a rounding.
        assert_eq!(exact_column(&[1e-18, 31622.7766], 6), ["1e-18", "31622.8"]);
        assert_eq!(column(&[1e-18, 31622.7766], 6), ["0.0", "31622.8"]);
        assert_eq!([0, 1, 2].map(|count| counted(count, "cycle")), ["0 cycles", "1 cycle", "2 cycles"]);
        assert_eq!(plain(f64::NAN), "NaN");
        assert_eq!(plain(0.31333333333), "0.313333");
    }
}
