use crate::noise::Noise;

/// What the drive sees of the motor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measured {
    /// [m or rad].
    pub position: f64,
    /// [m/s or rad/s].
    pub velocity: f64,
}

/// The encoder on the motor, read once per substep.
///
/// An exact one gives position and velocity as they are. One with counts gives the nearest count, and
/// a velocity as drives estimate it: counts gained over the last [`WINDOW`](Self::WINDOW) substeps, over their
/// time. For a count `q` and a substep `h`:
///
/// ```text
/// |position error| ≤ q/2      |velocity error| ≤ q/(WINDOW·h) + |a|·WINDOW·h/2      (2q for q with noise)
/// ```
///
/// The second term is the delay of half a window. Noise moves the place where a count changes by up to half
/// a count, uniformly, as the electrical noise of a sine-cosine track does.
#[derive(Clone, Debug)]
pub struct Encoder(Kind);

#[derive(Clone, Debug)]
enum Kind {
    Exact,
    Counting {
        resolution: f64,
        substep: f64,
        noise: Option<Noise>,
        past: [i64; Encoder::WINDOW],
        oldest: usize,
    },
}

impl Encoder {
    /// Substeps over which velocity is estimated: a fourth of the ripple of one, for a delay of two.
    pub const WINDOW: usize = 4;

    /// `resolution` per count [m or rad], 0: exact; `seed` of the noise, 0: none; to be read every `substep`
    /// [s], first where the motor is `now`, on a motor that came there steadily.
    #[must_use]
    pub fn new(resolution: f64, seed: u64, substep: f64, now: Measured) -> Self {
        if resolution == 0.0 {
            return Self(Kind::Exact);
        }
        let past = std::array::from_fn(|n| {
            let ago = (Self::WINDOW - n) as f64 * substep;
            count(now.position - now.velocity * ago, resolution)
        });
        let noise = (seed != 0).then(|| Noise::new(seed));
        Self(Kind::Counting { resolution, substep, noise, past, oldest: 0 })
    }

    /// Reads the motor, which is where `actual` says.
    pub fn read(&mut self, actual: Measured) -> Measured {
        match &mut self.0 {
            Kind::Exact => actual,
            Kind::Counting { resolution, substep, noise, past, oldest } => {
                let jitter = noise.as_mut().map_or(0.0, Noise::half_unit);
                let now = count(actual.position + jitter * *resolution, *resolution);
                let gained = now.saturating_sub(std::mem::replace(&mut past[*oldest], now));
                *oldest = (*oldest + 1) % Self::WINDOW;
                let position = now as f64 * *resolution;
                let velocity = gained as f64 * *resolution / (Self::WINDOW as f64 * *substep);
                Measured { position, velocity }
            }
        }
    }
}

/// The nearest count; saturates some 9·10¹⁸ counts away from zero.
fn count(position: f64, resolution: f64) -> i64 {
    libm::round(position / resolution) as i64
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SUBSTEP: f64 = 1e-4;
    /// Slack on a bound in counts [1]: positions of up to a million counts, rounded to 53 bits.
    const ROUNDING: f64 = 1e-9;

    proptest! {
        #[test]
        fn quantisation_keeps_its_bounds(
            q in 1e-9..1e-3, start in -1e6..1e6, speed in -100.0..100.0, acceleration in -1e4..1e4_f64, seed in 0_u64..3,
        ) {
            // Start, speed and acceleration in counts, counts per substep and per 10⁴ substeps squared.
            let (start, v, a) = (start * q, speed * q / SUBSTEP, acceleration * 1e-4 * q / SUBSTEP / SUBSTEP);
            let mut encoder = Encoder::new(q, seed, SUBSTEP, Measured { position: start, velocity: v });
            let window = Encoder::WINDOW as f64 * SUBSTEP;
            let half = if seed == 0 { 0.5 } else { 1.0 };
            for n in 0..50 {
                let t = f64::from(n) * SUBSTEP;
                let actual = Measured { position: start + v * t + a * t * t / 2.0, velocity: v + a * t };
                let seen = encoder.read(actual);
                prop_assert!((seen.position - actual.position).abs() <= q * (half + ROUNDING));
                let ripple = 2.0 * half * q / window + a.abs() * window / 2.0;
                prop_assert!((seen.velocity - actual.velocity).abs() <= ripple * (1.0 + ROUNDING) + q * ROUNDING / window);
            }
        }
    }

    #[test]
    fn an_exact_encoder_changes_nothing() {
        let actual = Measured { position: 0.1 + 0.2, velocity: -1.0 / 3.0 };
        assert_eq!(Encoder::new(0.0, 5, SUBSTEP, Measured::default()).read(actual), actual);
    }

    #[test]
    fn the_same_seed_reads_the_same() {
        let read = |seed| -> Vec<f64> {
            let mut encoder = Encoder::new(1e-6, seed, SUBSTEP, Measured::default());
            (0..100)
                .map(|n| encoder.read(Measured { position: f64::from(n) * 3e-7, velocity: 0.0 }).position)
                .collect()
        };
        assert_eq!(read(3), read(3));
        assert_ne!(read(3), read(4));
        assert_ne!(read(3), read(0));
    }
}
