//! Random numbers by their place: each is a function of a key and a counter, so that nobody has to draw those before it.
//!
//! # References
//! Salmon, Moraes, Dror and Shaw, *Parallel random numbers: as easy as 1, 2, 3* (2011): Philox, four words of 32 bits, ten
//! rounds. Box and Muller, Ann. Math. Statist. 29 (1958) 610: normal numbers.

const MULTIPLIERS: [u32; 2] = [0xD251_1F53, 0xCD9E_8D57];
const WEYL: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];
const ROUNDS: usize = 10;

/// The four words of Philox4x32-10 at a counter.
pub fn philox([mut k0, mut k1]: [u32; 2], mut counter: [u32; 4]) -> [u32; 4] {
    for _ in 0..ROUNDS {
        let [a, b, c, d] = counter;
        let [left, right] = [u64::from(MULTIPLIERS[0]) * u64::from(a), u64::from(MULTIPLIERS[1]) * u64::from(c)];
        counter = [(right >> 32) as u32 ^ b ^ k0, right as u32, (left >> 32) as u32 ^ d ^ k1, left as u32];
        (k0, k1) = (k0.wrapping_add(WEYL[0]), k1.wrapping_add(WEYL[1]));
    }
    counter
}

/// The middle of one of 2^53 equal intervals of the unit one, from 64 bits: at least 2^-54, so that it has a logarithm, and 1
/// where the middle of the last is rounded.
fn between(high: u32, low: u32) -> f64 {
    (((u64::from(high) << 32 | u64::from(low)) >> 11) as f64 + 0.5) * 2f64.powi(-53)
}

/// Two independent normal numbers of mean 0 and variance 1 at a counter; the same bits on every processor.
pub fn two_normals(key: [u32; 2], counter: [u32; 4]) -> [f64; 2] {
    let [a, b, c, d] = philox(key, counter);
    let radius = (-2.0 * libm::log(between(a, b))).sqrt();
    let (sine, cosine) = libm::sincos(2.0 * std::f64::consts::PI * between(c, d));
    [radius * cosine, radius * sine]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The vectors that the authors publish with Random123.
    #[test]
    fn words_are_those_of_the_authors() {
        assert_eq!(philox([0; 2], [0; 4]), [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]);
        assert_eq!(philox([u32::MAX; 2], [u32::MAX; 4]), [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]);
        let (key, counter) = ([0xa409_3822, 0x299f_31d0], [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344]);
        assert_eq!(philox(key, counter), [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1]);
    }

    #[test]
    fn extreme_words_have_logarithms() {
        assert_eq!(between(0, 0), 2f64.powi(-54));
        assert_eq!(between(u32::MAX, u32::MAX), 1.0); // 2^53 - 1/2 is rounded to even
        assert_eq!((-2.0 * libm::log(1.0)).sqrt(), 0.0);
    }

    /// Of n numbers, the mean of z^k is within five standard errors of its value.
    #[test]
    fn numbers_have_the_moments_of_the_normal_law() {
        let n = 100_000_u32;
        let numbers: Vec<f64> = (0..n).flat_map(|i| two_normals([7, 11], [i, 0, 3, 1])).collect();
        for (power, moment, variance) in [(1, 0.0, 1.0), (2, 1.0, 2.0), (3, 0.0, 15.0), (4, 3.0, 96.0_f64)] {
            let mean = numbers.iter().map(|z| z.powi(power)).sum::<f64>() / numbers.len() as f64;
            let error = (variance / numbers.len() as f64).sqrt();
            assert!((mean - moment).abs() < 5.0 * error, "mean of z^{power}: {mean}, wanted {moment} +- {error}");
        }
    }
}
