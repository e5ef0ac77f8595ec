//! Numbers for people: as many digits as help, one column like the next.

use planner::{AxisKind, CycleTime, Quantity};

/// Of the largest value in a column [1]: what is less is a rounding, and shown as zero.
const NOISE: f64 = 1e-12;
/// Digits that the smallest value of a column keeps at least.
const LEAST_DIGITS: i32 = 3;
/// A column all of which is less has exponents: zeros in front say nothing.
const SMALL: f64 = 1e-4;
/// The longest number in fixed notation; past it an exponent is shorter.
const LONGEST: usize = 10;

/// The values of one column, with one number of decimals: `digits` significant ones for the largest, and zeros that
/// all have at the end left out.
pub(crate) fn column(values: &[f64], digits: i32) -> Vec<String> {
    let largest = values.iter().copied().map(f64::abs).filter(|v| v.is_finite()).fold(0.0, f64::max);
    let shown = |value: f64| if value.abs() <= NOISE * largest { 0.0 } else { value };
    let smallest = values.iter().map(|&v| shown(v).abs()).filter(|v| *v > 0.0).fold(f64::INFINITY, f64::min);
    if largest == 0.0 {
        return values
            .iter()
            .map(|value| if *value == 0.0 { "0".to_owned() } else { value.to_string() })
            .collect();
    }
    if largest < SMALL {
        return values.iter().map(|&value| scientific(shown(value), digits)).collect();
    }
    let places = |value: f64, digits: i32| digits - 1 - value.log10().floor() as i32;
    let wanted = places(largest, digits).max(places(smallest, LEAST_DIGITS)).max(0);
    let least = places(largest, digits.min(LEAST_DIGITS + 1)).max(0);
    for decimals in (least..=wanted).rev() {
        let fixed = fixed(values, decimals as usize, shown);
        if fixed.iter().all(|text| text.len() <= LONGEST) {
            return fixed;
        }
    }
    values.iter().map(|&value| scientific(shown(value), digits)).collect()
}

fn fixed(values: &[f64], decimals: usize, shown: impl Fn(f64) -> f64) -> Vec<String> {
    let mut texts: Vec<String> = values.iter().map(|&value| format!("{:.decimals$}", shown(value))).collect();
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
    if value == 0.0 {
        return "0".to_owned();
    }
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
        let rows: [(&[f64], &[&str]); 7] = [
            (&[0.0, 0.03, 0.0833333333], &["0.0000000", "0.0300000", "0.0833333"]),
            (&[100.0, 0.0, -100.0], &["100", "0", "-100"]),
            (&[1.0, 2.5, -1e-17], &["1.0", "2.5", "0.0"]),
            (&[1e-12, 0.0], &["1e-12", "0"]),
            (&[123456789.25, 1.0], &["123456789", "1"]),
            (&[1.5e40, 2.0], &["1.5e40", "0"]),
            (&[0.0, -0.0], &["0", "0"]),
        ];
        for (values, expected) in rows {
            assert_eq!(column(values, 6), expected, "{values:?}");
        }
        assert_eq!(plain(f64::NAN), "NaN");
        assert_eq!(plain(0.31333333333), "0.313333");
    }
}
