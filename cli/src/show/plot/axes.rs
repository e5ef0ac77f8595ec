//! Where a time and a value lie in the picture, and which numbers stand beside them.

use super::figure::{Baseline, Figure, Limit, Panel};
use super::layout::{LEFT, PANEL, RIGHT};
use crate::show::number::plain;

/// Of the range of a panel [1]: what is left free at either end.
const HEADROOM: f64 = 0.12;
/// Of a limit [1]: a curve that gets less near leaves the limit out of the picture.
const NEAR: f64 = 0.25;

/// Time, from zero to the right edge.
pub(super) struct TimeAxis {
    pub(super) until: f64,
    pub(super) unit: &'static str,
    /// In how many of the unit a second is counted.
    pub(super) per_second: f64,
}

impl TimeAxis {
    pub(super) fn of(figure: &Figure) -> Self {
        let times = figure.panels.iter().flat_map(|panel| &panel.series).flat_map(|series| &series.points);
        let last = times.map(|point| point.0).filter(|time| time.is_finite()).fold(0.0, f64::max);
        let until = if last > 0.0 { last } else { 1e-3 };
        let (unit, per_second) = match until {
            t if t < 2e-5 => ("ns", 1e9),
            t if t < 2e-3 => ("µs", 1e6),
            t if t < 0.2 => ("ms", 1e3),
            _ => ("s", 1.0),
        };
        Self { until, unit, per_second }
    }

    pub(super) fn x(&self, time: f64) -> f64 {
        LEFT + (time / self.until).clamp(0.0, 1.0) * (RIGHT - LEFT)
    }
}

/// Values, from the bottom of a panel to its top.
pub(super) struct ValueAxis {
    top: f64,
    pub(super) least: f64,
    pub(super) greatest: f64,
}

impl ValueAxis {
    pub(super) fn of(panel: &Panel, top: f64) -> Self {
        let (low, high) = panel.extent();
        let shown = panel.limits.iter().filter(|limit| panel.sees(limit)).map(|limit| limit.value);
        let zero = (panel.baseline == Baseline::Zero).then_some(0.0);
        let (least, greatest) = shown
            .chain(zero)
            .fold((low, high), |(least, greatest), value| (least.min(value), greatest.max(value)));
        let span = greatest - least;
        // A curve that does not vary lies in the middle.
        let room = if span > 1e-12 * greatest.abs().max(least.abs()) {
            HEADROOM * span
        } else {
            (0.5 * greatest.abs()).max(f64::MIN_POSITIVE.sqrt())
        };
        let room = if span == 0.0 && greatest == 0.0 { 1.0 } else { room };
        Self { top, least: least - room, greatest: greatest + room }
    }

    pub(super) fn y(&self, value: f64) -> f64 {
        self.top + PANEL * (1.0 - (value - self.least) / (self.greatest - self.least))
    }
}

impl Panel {
    pub(super) fn extent(&self) -> (f64, f64) {
        let curves = self.series.iter().flat_map(|series| &series.points);
        let values = curves.chain(self.marks.iter().flat_map(|marks| &marks.points)).map(|point| point.1);
        let (low, high) = values
            .filter(|value| value.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        if low <= high { (low, high) } else { (0.0, 0.0) }
    }

    /// Does a curve come near enough to this limit for both to be in the picture?
    pub(super) fn sees(&self, limit: &Limit) -> bool {
        let (low, high) = self.extent();
        if self.baseline == Baseline::Themselves {
            let span = (high - low).max(f64::MIN_POSITIVE);
            return limit.value >= low - span && limit.value <= high + span;
        }
        let towards = if limit.value < 0.0 { -low } else { high };
        towards >= NEAR * limit.value.abs() && towards > 0.0
    }

    /// The limits that no curve comes near, though it goes that way.
    pub(super) fn unseen(&self) -> Vec<f64> {
        let (low, high) = self.extent();
        // A ripple about zero does not go anywhere.
        let some = 0.05 * (high - low);
        let heads_for = |value: f64| {
            self.baseline == Baseline::Themselves || if value < 0.0 { -low > some } else { high > some }
        };
        let away = |limit: &&Limit| !self.sees(limit) && heads_for(limit.value);
        self.limits.iter().filter(away).map(|limit| limit.value).collect()
    }
}

/// A number with a minus that is as wide as a plus.
pub(super) fn signed(value: f64) -> String {
    plain(value).replacen('-', "−", 1)
}

/// Positions of marks on an axis: whole multiples of 1, 2 or 5 times a power of ten.
pub(super) struct Ticks {
    first: i64,
    last: i64,
    step: f64,
    decimals: usize,
}

impl Ticks {
    /// About `wanted` of them between `least` and `greatest`.
    pub(super) fn of(least: f64, greatest: f64, wanted: u32) -> Self {
        let rough = (greatest - least) / f64::from(wanted);
        let exponent = rough.log10().floor();
        let power = 10f64.powf(exponent);
        let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|step| *step >= rough);
        let step = step.unwrap_or(power);
        let decimals = (-step.log10().floor()).clamp(0.0, 17.0) as usize;
        let slack = 1e-9;
        let (first, last) = ((least / step - slack).ceil() as i64, (greatest / step + slack).floor() as i64);
        Self { first, last: last.min(first.saturating_add(50)), step, decimals }
    }

    pub(super) fn labels(&self) -> impl Iterator<Item = (f64, String)> {
        (self.first..=self.last).map(|index| {
            let value = index as f64 * self.step;
            let text = format!("{value:.*}", self.decimals);
            (value, text.replacen('-', "−", 1))
        })
    }
}

/// A power of ten that is taken out of the marks of an axis and put into its title.
pub(super) struct Scale {
    pub(super) factor: f64,
    pub(super) prefix: String,
}

impl Scale {
    pub(super) fn of(least: f64, greatest: f64, unit: &str) -> Self {
        let largest = least.abs().max(greatest.abs());
        if (1e-2..1e5).contains(&largest) || largest == 0.0 || !largest.is_finite() {
            return Self { factor: 1.0, prefix: String::new() };
        }
        let exponent = (largest.log10() / 3.0).floor() as i32 * 3;
        let factor = 10f64.powi(exponent);
        // Small lengths and angles have units that people say.
        if let (Some(prefix), true) = (prefix(exponent), unit.starts_with('m') || unit.starts_with("rad")) {
            return Self { factor, prefix: prefix.to_owned() };
        }
        let digits: String = exponent
            .to_string()
            .chars()
            .map(|c| match c {
                '-' => '⁻',
                '1' => '¹',
                '2' => '²',
                '3' => '³',
                c => c.to_digit(10).and_then(|digit| char::from_u32(0x2070 + digit)).unwrap_or(c),
            })
            .collect();
        Self { factor, prefix: format!("10{digits} ") }
    }
}

/// Of the SI.
fn prefix(exponent: i32) -> Option<&'static str> {
    match exponent {
        -3 => Some("m"),
        -6 => Some("µ"),
        -9 => Some("n"),
        _ => None,
    }
}
