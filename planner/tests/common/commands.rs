//! Commands of position, velocity and time, as a tracked target gives them.

use super::random::Random;

/// One command comes after another \[s\].
pub(crate) const BEAT: f64 = 0.05;

/// A target that is tracked at a beat: most commands can be met, about one in ten cannot.
pub(crate) fn tracked(random: &mut Random, count: usize) -> Vec<(f64, f64)> {
    let (mut position, mut velocity) = (0.0, 0.0);
    (0..count)
        .map(|_| {
            let wild = random.bits().is_multiple_of(24);
            let change = if wild { random.between(-0.3, 0.3) } else { random.between(-0.05, 0.05) };
            let next = f64::clamp(velocity + change, -0.5, 0.5);
            let off = if wild { 2e-3 } else { 1e-4 };
            position += 0.5 * (velocity + next) * BEAT + random.between(-off, off);
            velocity = next;
            (position, velocity)
        })
        .collect()
}
