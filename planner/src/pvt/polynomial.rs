//! The polynomials that other controllers put through the points: for comparison, since they know no limit.

use super::{PvtInterpolation, PvtTarget};
use crate::{Derivatives, Law, Segment, State};

/// The one piece from `start` to `target`; none for ramps, which are several.
///
/// With `S` the displacement, `T` the duration and `τ = t/T`:
///
/// ```text
/// cubic      p = p₀ + v_s·t + b·t² + c·t³        b = (3S − T·(2v_s + v_e))/T²    c = (T·(v_s + v_e) − 2S)/T³
/// quintic    p = p₀ + v_s·t + k₃τ³ + k₄τ⁴ + k₅τ⁵
///            k₃ = 10S − T·(6v_s + 4v_e)    k₄ = −15S + T·(8v_s + 7v_e)    k₅ = 6S − 3T·(v_s + v_e)
/// ```
/// The cubic's acceleration is `2b` where it begins, whatever it was before; the quintic's is zero at both ends.
pub(super) fn piece(interpolation: PvtInterpolation, start: State, target: &PvtTarget) -> Option<Segment> {
    let PvtTarget { position, velocity, duration } = *target;
    let way = position - start.position;
    let (before, after) = (start.velocity * duration, velocity * duration);
    let square = duration * duration;
    let cube = square * duration;
    let (law, acceleration) = match interpolation {
        PvtInterpolation::SShaped => return None,
        PvtInterpolation::Cubic => {
            let (b, c) = (3.0 * way - (2.0 * before + after), (before + after) - 2.0 * way);
            (Law::ConstantJerk(6.0 * c / cube + 0.0), 2.0 * b / square)
        }
        PvtInterpolation::Quintic => {
            let jerk = 6.0 * (10.0 * way - (6.0 * before + 4.0 * after)) / cube;
            let snap = 24.0 * ((8.0 * before + 7.0 * after) - 15.0 * way) / (cube * duration);
            let crackle = 120.0 * (6.0 * way - 3.0 * (before + after)) / (cube * square);
            (Law::Polynomial(Derivatives::kept(&[jerk + 0.0, snap + 0.0, crackle + 0.0])), 0.0)
        }
    };
    Some(Segment { duration, start: State { acceleration, ..start }.with_positive_zeros(), law })
}
