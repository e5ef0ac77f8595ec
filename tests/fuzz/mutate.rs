//! Changes that hurt: to bits, to the numbers that bytes may stand for, to lengths, and between inputs.

use fastrand::Rng;

/// Numbers that formulas trip over.
const NUMBERS: [f64; 14] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    0.0,
    -0.0,
    1.0,
    -1.0,
    f64::MIN_POSITIVE,
    5e-324,
    f64::MAX,
    f64::MIN,
    f64::EPSILON,
    1e-300,
    9_007_199_254_740_993.0,
];

/// Words that texts trip over.
const WORDS: [&str; 12] = [
    "NaN",
    "Infinity",
    "-1",
    "1e999",
    "null",
    "[]",
    "{}",
    "\"\"",
    "*",
    "\u{0}",
    "\u{fffd}",
    "99999999999999999999",
];

/// An input made of those of `corpus`, of at most `most` bytes.
pub(crate) fn from(corpus: &[Vec<u8>], most: usize, random: &mut Rng) -> Vec<u8> {
    let pick = |random: &mut Rng| random.choice(corpus).cloned().unwrap_or_default();
    let mut bytes = pick(random);
    for _ in 0..=random.usize(0..6) {
        let at = random.usize(0..=bytes.len());
        match random.u8(0..9) {
            0 => flip(&mut bytes, at, random),
            1 => overwrite(&mut bytes, at, &[random.u8(..)]),
            2 => {
                let number = random.choice(NUMBERS).unwrap_or_default();
                overwrite(&mut bytes, at, &number.to_le_bytes());
            }
            3 => overwrite(&mut bytes, at, &f64::from_bits(random.u64(..)).to_le_bytes()),
            // The largest number that a varint may be.
            4 => overwrite(&mut bytes, at, &[0xff; 9]),
            5 => bytes.truncate(at),
            6 => {
                let word = random.choice(WORDS).unwrap_or_default().as_bytes().to_vec();
                bytes.splice(at..at, word);
            }
            7 => {
                let until = random.usize(at..=bytes.len());
                let piece = bytes[at..until].to_vec();
                bytes.splice(at..at, piece);
            }
            _ => {
                let other = pick(random);
                let from = random.usize(0..=other.len());
                bytes.truncate(at);
                bytes.extend_from_slice(&other[from..]);
            }
        }
    }
    bytes.truncate(most);
    bytes
}

fn flip(bytes: &mut [u8], at: usize, random: &mut Rng) {
    if let Some(byte) = bytes.get_mut(at) {
        *byte ^= 1 << random.u8(0..8);
    }
}

fn overwrite(bytes: &mut [u8], at: usize, with: &[u8]) {
    for (byte, new) in bytes.iter_mut().skip(at).zip(with) {
        *byte = *new;
    }
}
