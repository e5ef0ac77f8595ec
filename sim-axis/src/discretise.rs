use nalgebra::{Const, DimMin, OMatrix, SMatrix, SVector};

/// What a linear system `ẋ = A·x` does to its state in `substep` seconds: `exp(A·h)`, exact.
///
/// An input that is held over the substep is a state that does not change, one that ramps a state with
/// a constant rate; with them in `x` the exponential is the exact zero-order or first-order hold.
/// Source: Van Loan (1978), "Computing integrals involving the matrix exponential".
///
/// `order` says which derivative of a position each state is. The exponential is taken with time counted in
/// substeps, where positions, velocities and accelerations are of one size: in seconds `A·h` has entries of
/// `k·h/m` ≈ 10⁵ for a stiff axis, and scaling and squaring would lose that many digits.
pub(crate) fn flow<const N: usize>(
    rates: SMatrix<f64, N, N>,
    order: [u8; N],
    substep: f64,
) -> SMatrix<f64, N, N>
where
    Const<N>: DimMin<Const<N>, Output = Const<N>>,
{
    let scale = SVector::<f64, N>::from(order.map(|order| match order {
        0 => 1.0,
        1 => substep,
        _ => substep * substep,
    }));
    let per_substep =
        SMatrix::from_fn(|row, column| rates[(row, column)] * substep * scale[row] / scale[column]);
    let flow: SMatrix<f64, N, N> = OMatrix::<f64, Const<N>, Const<N>>::exp(&per_substep);
    SMatrix::from_fn(|row, column| flow[(row, column)] * scale[column] / scale[row])
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix2, Matrix3};

    /// Slack on an entry of the flow [1]: the exponential is good to some ten roundings of its norm.
    const ROUNDING: f64 = 1e-14;

    fn check<const N: usize>(flow: SMatrix<f64, N, N>, expected: SMatrix<f64, N, N>) {
        for (found, expected) in flow.iter().zip(expected.iter()) {
            assert!((found - expected).abs() <= ROUNDING * expected.abs().max(f64::MIN_POSITIVE), "{flow}");
        }
    }

    #[test]
    fn a_free_mass_under_held_acceleration_moves_on_a_parabola() {
        let h = 1e-4;
        let rates = Matrix3::new(0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0);
        check(flow(rates, [0, 1, 2], h), Matrix3::new(1.0, h, h * h / 2.0, 0.0, 1.0, h, 0.0, 0.0, 1.0));
    }

    #[test]
    fn a_mass_in_oil_slows_down_exponentially() {
        let (h, rate): (f64, f64) = (1e-4, 250.0);
        let decay = (-rate * h).exp();
        let rates = Matrix2::new(0.0, 1.0, 0.0, -rate);
        check(flow(rates, [0, 1], h), Matrix2::new(1.0, -(-rate * h).exp_m1() / rate, 0.0, decay));
    }

    #[test]
    fn a_damped_oscillator_turns_by_its_closed_form() {
        // Ogata (2010), §5.3: ω of the undamped, ζ of critical, ω_d = ω·√(1 − ζ²).
        for (omega, zeta) in [(250.0, 0.0), (250.0, 0.02), (3.0, 0.7), (31_000.0, 0.001)] {
            let h: f64 = 1e-4;
            let damped: f64 = omega * f64::sqrt(1.0 - zeta * zeta);
            let (sin, cos) = (damped * h).sin_cos();
            let decay = (-zeta * omega * h).exp();
            let sway = zeta * omega / damped * sin;
            let expected =
                decay * Matrix2::new(cos + sway, sin / damped, -omega * omega / damped * sin, cos - sway);
            let rates = Matrix2::new(0.0, 1.0, -omega * omega, -2.0 * zeta * omega);
            check(flow(rates, [0, 1], h), expected);
        }
    }
}
