use nalgebra::{Matrix4, Vector4};

/// Frequency of the vibration in `record`, equidistant positions `cycle` seconds apart [Hz]; `None` where no
/// single vibration stands out.
///
/// Looked for in the second difference, the load's acceleration: a slow creep into position has next to none.
/// There a damped sine is fitted by least squares, from a first guess at the peak of the spectrum:
///
/// ```text
/// y(k) = exp(−σk)·(A·cos ωk + B·sin ωk)        k in cycles
/// ```
///
/// For one damped sine, beside any offset and drift, within [1e-6](FREQUENCY_ACCURACY) of the frequency; a
/// settling motion under it costs about a percent. At least half a period must be in the record, and two
/// cycles in a period. Only the first [`MOST_CYCLES`] are looked at. The frequency is that of the damped swing.
pub(crate) fn frequency(record: &[f64], cycle: f64) -> Option<f64> {
    let record = &record[..record.len().min(MOST_CYCLES)];
    let swing: Vec<f64> = record.windows(3).map(|x| (x[2] - x[1]) - (x[1] - x[0])).collect();
    if swing.len() < LEAST_CYCLES || is_rounding(&swing, record) {
        return None;
    }
    let fitted = Fit::coarse(&swing).refined(&swing);
    fitted.stands_out(&swing).then(|| fitted.omega / std::f64::consts::TAU / cycle)
}

/// Nothing but the last bits of the positions.
fn is_rounding(swing: &[f64], record: &[f64]) -> bool {
    let size = record.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
    let rms = libm::sqrt(energy(swing) / swing.len() as f64);
    rms <= ROUNDING * size || rms == 0.0
}

#[derive(Clone, Copy, Debug)]
struct Fit {
    cosine: f64,
    sine: f64,
    /// [1/cycle]
    sigma: f64,
    /// [rad/cycle]
    omega: f64,
}

impl Fit {
    /// The peak of the spectrum, on a grid twice as fine as the record's own, and the decay between its halves.
    fn coarse(swing: &[f64]) -> Self {
        let n = swing.len();
        let grid = std::f64::consts::PI / n as f64;
        let peak = (1..n)
            .map(|line| projection(swing, line as f64 * grid))
            .enumerate()
            .max_by(|(_, one), (_, other)| f64::total_cmp(&square(*one), &square(*other)));
        let (line, (cosine, sine)) = peak.unwrap_or((0, (0.0, 0.0)));
        let (early, late) = swing.split_at(n / 2);
        let decay = libm::log(energy(early).max(f64::MIN_POSITIVE) / energy(late).max(f64::MIN_POSITIVE));
        let scale = 2.0 / n as f64;
        Self {
            cosine: cosine * scale,
            sine: sine * scale,
            sigma: (decay / n as f64).clamp(0.0, 0.5),
            omega: (line + 1) as f64 * grid,
        }
    }

    /// Levenberg and Marquardt, with the scale of each parameter taken from its own column.
    fn refined(self, swing: &[f64]) -> Self {
        let mut best = self;
        let (mut normal, mut slope, mut left) = best.normal_equations(swing);
        let mut damping = 1e-3;
        for _ in 0..MOST_STEPS {
            let diagonal = Matrix4::from_diagonal(&normal.diagonal());
            let Some(step) = (normal + diagonal * damping).lu().solve(&slope) else { break };
            let tried = best.moved(step);
            let (tried_normal, tried_slope, tried_left) = tried.normal_equations(swing);
            if tried_left < left {
                let has_converged = step[3].abs() <= STEP_SLACK * tried.omega.abs();
                (best, normal, slope, left) = (tried, tried_normal, tried_slope, tried_left);
                damping *= 0.1;
                if has_converged {
                    break;
                }
            } else {
                damping *= 10.0;
            }
        }
        best
    }

    fn moved(self, step: Vector4<f64>) -> Self {
        Self {
            cosine: self.cosine + step[0],
            sine: self.sine + step[1],
            sigma: self.sigma + step[2],
            omega: self.omega + step[3],
        }
    }

    /// `JᵀJ`, `Jᵀr` and `rᵀr` of the residuals `r` and their Jacobian `J` in the order of the fields.
    fn normal_equations(&self, swing: &[f64]) -> (Matrix4<f64>, Vector4<f64>, f64) {
        let (mut normal, mut slope, mut left) = (Matrix4::zeros(), Vector4::zeros(), 0.0);
        for (k, (y, (cosine, sine))) in swing.iter().zip(phasor(self.sigma, self.omega)).enumerate() {
            let k = k as f64;
            let model = self.cosine * cosine + self.sine * sine;
            let turned = self.sine * cosine - self.cosine * sine;
            let row = Vector4::new(cosine, sine, -k * model, k * turned);
            normal += row * row.transpose();
            slope += row * (y - model);
            left += (y - model) * (y - model);
        }
        (normal, slope, left)
    }

    fn stands_out(&self, swing: &[f64]) -> bool {
        let (_, _, left) = self.normal_equations(swing);
        let half_periods = self.omega * swing.len() as f64 / std::f64::consts::PI;
        left <= MOST_UNEXPLAINED * energy(swing)
            && half_periods >= 1.0
            && self.omega <= std::f64::consts::PI
            && self.sigma < self.omega
    }
}

/// Σ y·cos ωk and Σ y·sin ωk.
fn projection(swing: &[f64], omega: f64) -> (f64, f64) {
    swing
        .iter()
        .zip(phasor(0.0, omega))
        .fold((0.0, 0.0), |(c, s), (y, (cosine, sine))| (c + y * cosine, s + y * sine))
}

/// exp(−σk)·(cos ωk, sin ωk) for k = 0, 1, …: one multiplication each, off by k roundings at most.
fn phasor(sigma: f64, omega: f64) -> impl Iterator<Item = (f64, f64)> {
    let left = libm::exp(-sigma);
    let (cos, sin) = (left * libm::cos(omega), left * libm::sin(omega));
    std::iter::successors(Some((1.0, 0.0)), move |&(c, s): &(f64, f64)| {
        Some((c * cos - s * sin, c * sin + s * cos))
    })
}

fn square((cosine, sine): (f64, f64)) -> f64 {
    cosine * cosine + sine * sine
}

fn energy(swing: &[f64]) -> f64 {
    swing.iter().map(|y| y * y).sum()
}

/// Bounds the first guess, which looks at every frequency of the grid in every cycle: some milliseconds.
const MOST_CYCLES: usize = 2048;
/// Fewer give no more equations than unknowns.
const LEAST_CYCLES: usize = 8;
/// Steps of the fit; it takes five to ten from a grid of half lines.
const MOST_STEPS: usize = 60;
/// Change of ω that ends the fit, relative [1]: a thousandth of the stated accuracy.
const STEP_SLACK: f64 = 1e-3 * FREQUENCY_ACCURACY;
/// Accuracy of the frequency of a single damped sine, relative [1].
const FREQUENCY_ACCURACY: f64 = 1e-6;
/// Share of the acceleration's energy that may be something else than the vibration [1].
const MOST_UNEXPLAINED: f64 = 0.5;
/// RMS of the second difference below which it is rounding, relative to the positions [1]: its own four
/// roundings, and those of a swing that a plant has computed.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const CYCLE: f64 = 1e-3;

    fn record(cycles: usize, position: impl Fn(f64) -> f64) -> Vec<f64> {
        (0..cycles).map(|n| position(n as f64 * CYCLE)).collect()
    }

    fn swing(amplitude: f64, hertz: f64, decay: f64, phase: f64) -> impl Fn(f64) -> f64 {
        move |t| amplitude * (-decay * t).exp() * (std::f64::consts::TAU * hertz * t + phase).cos()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn a_damped_sine_is_found(
            hertz in 5.0..400.0, damping in 0.0..0.1, phase in 0.0..6.3, cycles in 300_usize..1200,
            offset in -0.1..0.1,
        ) {
            let load = swing(1e-5, hertz, damping * hertz * std::f64::consts::TAU, phase);
            let found = frequency(&record(cycles, |t| offset + load(t)), CYCLE).unwrap();
            prop_assert!((found / hertz - 1.0).abs() < FREQUENCY_ACCURACY, "{} of {}", found, hertz);
        }
    }

    #[test]
    fn a_creep_ten_times_as_large_costs_a_percent() {
        let load = swing(1e-5, 40.0, 3.0, 1.0);
        let found = frequency(&record(500, |t| load(t) + 1e-4 * (-50.0 * t).exp()), CYCLE).unwrap();
        assert!((found / 40.0 - 1.0).abs() < 0.01, "{found}");
    }

    #[test]
    fn where_nothing_swings_nothing_is_found() {
        assert_eq!(frequency(&record(500, |_| 0.05), CYCLE), None);
        assert_eq!(frequency(&record(500, |t| 1e-4 * (-50.0 * t).exp()), CYCLE), None);
        assert_eq!(frequency(&record(500, |t| 0.1 + f64::EPSILON * (300.0 * t).sin()), CYCLE), None);
        assert_eq!(frequency(&record(5, swing(1.0, 200.0, 0.0, 0.0)), CYCLE), None);
        assert_eq!(frequency(&[], CYCLE), None);
        assert_eq!(frequency(&[f64::NAN; 100], CYCLE), None);
    }
}
