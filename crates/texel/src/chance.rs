//! Chance by hashing: a number depends on its seed and on what it is for, not on when or where it is asked for.

/// A hash of a seed and what follows (SplitMix64, Steele, Lea and Flood 2014, in a chain).
pub(crate) fn hash(seed: u64, words: &[u64]) -> u64 {
    words.iter().fold(mix(seed), |state, word| mix(state ^ mix(*word)))
}

fn mix(word: u64) -> u64 {
    let mut z = word.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ z >> 31
}

/// A number from 0 to 1, 1 left out.
pub(crate) fn unit(seed: u64, words: &[u64]) -> f64 {
    (hash(seed, words) >> 11) as f64 / (1u64 << 53) as f64
}

/// A number with mean 0 and variance 1, nearly normal: the sum of four even ones (Irwin 1927, Hall 1927), so that it
/// needs no function that differs between machines. Within ±3.5.
pub(crate) fn normal(seed: u64, words: &[u64]) -> f64 {
    let start = hash(seed, words);
    let sum: f64 = (0..4).map(|i| unit(start, &[i])).sum();
    (sum - 2.0) * 3f64.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_those_of_the_normal_distribution() {
        let numbers: Vec<f64> = (0..100_000).map(|i| normal(7, &[i])).collect();
        let mean = numbers.iter().sum::<f64>() / 1e5;
        let square = numbers.iter().map(|x| x * x).sum::<f64>() / 1e5;
        assert!(mean.abs() < 0.01 && (square - 1.0).abs() < 0.01, "{mean} {square}");
    }

    #[test]
    fn the_same_on_every_machine() {
        assert_eq!(hash(0, &[]), 0xe220_a839_7b1d_cdaf);
        assert_ne!(hash(1, &[2, 3]), hash(1, &[3, 2]));
    }
}
