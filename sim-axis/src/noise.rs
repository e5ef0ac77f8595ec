/// SplitMix64: a counter and a mixer, enough for encoder noise and the same everywhere.
///
/// Source: Steele, Lea & Flood (2014), "Fast splittable pseudorandom number generators".
#[derive(Clone, Debug)]
pub(crate) struct Noise(u64);

impl Noise {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next of a uniform distribution over −½ to ½.
    pub(crate) fn half_unit(&mut self) -> f64 {
        const ULP_OF_ONE_HALF: f64 = 1.0 / 9_007_199_254_740_992.0;
        (self.bits() >> 11) as f64 * ULP_OF_ONE_HALF - 0.5
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_sequence_comes_out() {
        // First outputs for seed 1234567: the reference implementation of Vigna, splitmix64.c.
        let mut noise = Noise::new(1_234_567);
        assert_eq!([noise.bits(), noise.bits()], [6_457_827_717_110_365_317, 3_203_168_211_198_807_973]);
    }

    #[test]
    fn noise_stays_within_half_a_unit_and_is_centred() {
        let mut noise = Noise::new(7);
        let draws: Vec<f64> = (0..10_000).map(|_| noise.half_unit()).collect();
        assert!(draws.iter().all(|draw| (-0.5..0.5).contains(draw)));
        let mean = draws.iter().sum::<f64>() / draws.len() as f64;
        // Four standard deviations of the mean of ten thousand.
        assert!(mean.abs() < 4.0 * (1.0_f64 / 12.0 / 1e4).sqrt(), "{mean}");
    }
}
