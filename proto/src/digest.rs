//! The rolling digest that proves that server and axis hold the same setpoints.

use std::fmt;

use xxhash_rust::xxh3::{Xxh3, xxh3_64};

use crate::pb::SetpointColumns;

/// Digest of every setpoint of a stream through some cycle.
///
/// ```text
/// d(0) = 0
/// d(n) = XXH3-64, seed 0, of  d(n-1) | n | p v a j of axis 0 | p v a j of axis 1 | ...
/// ```
///
/// Axes stand in plan order; every word has 64 bits and is little-endian, doubles by their bits. So `-0.0` and
/// `0.0` differ: what is compared is what the servo is given. `vectors/digest.json` holds test vectors.
///
/// ```
/// # use proto::Digest;
/// let resting = [0.25, 0.0, 0.0, 0.0];
/// assert_eq!(Digest::ZERO.then(1, [resting]), Digest::from(0x7d3e_2c36_3040_c1e1));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Digest(u64);

/// Axes whose cycle fits the stack buffer and is hashed in one go; more are hashed in several.
const AXES_AT_ONCE: usize = 8;
const CYCLE_BYTES: usize = 16 + 32 * AXES_AT_ONCE;

impl Digest {
    /// The digest before cycle 1: nothing has been sent.
    pub const ZERO: Self = Self(0);

    /// The digest through `cycle`, given the one through the cycle before it, and position, velocity,
    /// acceleration and jerk of each axis in plan order.
    ///
    /// Allocates nothing, for any number of axes.
    #[must_use]
    pub fn then(self, cycle: u64, axes: impl IntoIterator<Item = [f64; 4]>) -> Self {
        let mut bytes = [0; CYCLE_BYTES];
        bytes[..8].copy_from_slice(&self.0.to_le_bytes());
        bytes[8..16].copy_from_slice(&cycle.to_le_bytes());
        let mut filled = 16;
        let mut overflow: Option<Xxh3> = None;
        for value in axes.into_iter().flatten() {
            if filled == CYCLE_BYTES {
                overflow.get_or_insert_with(Xxh3::new).update(&bytes);
                filled = 0;
            }
            bytes[filled..filled + 8].copy_from_slice(&value.to_bits().to_le_bytes());
            filled += 8;
        }
        let rest = &bytes[..filled];
        Self(match overflow {
            None => xxh3_64(rest),
            Some(mut hasher) => {
                hasher.update(rest);
                hasher.digest()
            }
        })
    }

    /// The digests through `first_cycle`, `first_cycle + 1`, ..., one for each cycle of `columns`, given the one
    /// through the cycle before `first_cycle`. The last of them is the digest through the columns.
    ///
    /// # Errors
    /// [`RaggedColumns`], before anything is hashed.
    pub fn rolling<'a>(
        self,
        first_cycle: u64,
        columns: &'a SetpointColumns,
    ) -> Result<impl Iterator<Item = Self> + 'a, RaggedColumns> {
        let SetpointColumns { cycles, position, velocity, acceleration, jerk } = columns;
        let values = position.len();
        let stride = *cycles as usize;
        // Cycles of no axes are refused too: their number would cost a peer nothing.
        let whole = (values == 0) == (stride == 0) && values.is_multiple_of(stride);
        if !whole || [velocity, acceleration, jerk].iter().any(|column| column.len() != values) {
            return Err(RaggedColumns {
                cycles: *cycles,
                lengths: [values, velocity.len(), acceleration.len(), jerk.len()],
            });
        }
        let mut digest = self;
        Ok((0..stride).map(move |offset| {
            let cycle = first_cycle.wrapping_add(offset as u64);
            let axes = (offset..values).step_by(stride);
            digest =
                digest.then(cycle, axes.map(|at| [position[at], velocity[at], acceleration[at], jerk[at]]));
            digest
        }))
    }
}

impl From<u64> for Digest {
    fn from(bits: u64) -> Self {
        Self(bits)
    }
}

impl From<Digest> for u64 {
    fn from(digest: Digest) -> Self {
        digest.0
    }
}

impl fmt::Display for Digest {
    /// Sixteen hexadecimal digits.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}

/// Columns that are not one value per axis and cycle.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "columns of {} positions, {} velocities, {} accelerations and {} jerks do not make {cycles} cycles: \
     each needs cycles x axes values, and at least one axis",
    lengths[0], lengths[1], lengths[2], lengths[3]
)]
pub struct RaggedColumns {
    /// Cycles that the columns claim to hold.
    pub cycles: u32,
    /// Values in the columns of position, velocity, acceleration and jerk.
    pub lengths: [usize; 4],
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn one_shot(before: u64, cycle: u64, axes: &[[f64; 4]]) -> u64 {
        let words = [before, cycle].into_iter().chain(axes.iter().flatten().map(|value| value.to_bits()));
        xxh3_64(&words.flat_map(u64::to_le_bytes).collect::<Vec<u8>>())
    }

    proptest! {
        // The stack buffer, and what comes after it, is an optimisation.
        #[test]
        fn hashing_in_several_goes_is_hashing_in_one(
            before: u64,
            cycle: u64,
            bits in proptest::collection::vec(any::<[u64; 4]>(), 0..70),
        ) {
            let axes: Vec<[f64; 4]> = bits.iter().map(|axis| axis.map(f64::from_bits)).collect();
            let expected = one_shot(before, cycle, &axes);
            prop_assert_eq!(u64::from(Digest::from(before).then(cycle, axes)), expected);
        }
    }
}
