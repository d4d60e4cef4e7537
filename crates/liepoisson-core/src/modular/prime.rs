//! Arithmetic modulo an odd prime below 2^62, with sums of products that are reduced once.
//!
//! Residues are plain numbers from 0 to p - 1. A factor that meets many of them is *scaled*: multiplied by 2^64. A sum of
//! products of a residue and a scaled factor is kept in 128 bits below `p 2^64`, and Montgomery's reduction divides it by
//! 2^64 (Montgomery 1985), so that one product costs one multiplication and its share of a reduction.

use crate::error::Error;

/// An odd prime and what its arithmetic needs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Prime {
    p: u64,
    /// The inverse of p modulo 2^64.
    inverse: u64,
    /// 2^128 modulo p.
    square: u64,
}

impl Prime {
    /// # Errors
    /// A number that is even, composite, or not below 2^62.
    pub(super) fn new(p: u64) -> Result<Prime, Error> {
        if p >= 1 << 62 || p.is_multiple_of(2) || !is_prime(p) {
            return Err(Error::Prime { got: p });
        }
        // each of Newton's steps doubles the number of correct bits, of which p itself has three
        let mut inverse = p;
        for _ in 0..5 {
            inverse = inverse.wrapping_mul(2u64.wrapping_sub(p.wrapping_mul(inverse)));
        }
        let power = (1u128 << 64) % u128::from(p);
        Ok(Prime { p, inverse, square: (power * power % u128::from(p)) as u64 })
    }

    pub(super) fn residue(self, number: u64) -> u64 {
        number % self.p
    }

    pub(super) fn nonzero_residue(self, number: u64) -> u64 {
        1 + number % (self.p - 1)
    }

    /// A sum below `p 2^64`, divided by 2^64.
    #[inline(always)]
    pub(super) fn reduce(self, sum: u128) -> u64 {
        let quotient = (sum as u64).wrapping_mul(self.inverse);
        let subtrahend = ((u128::from(quotient) * u128::from(self.p)) >> 64) as u64;
        let high = (sum >> 64) as u64;
        if high >= subtrahend { high - subtrahend } else { high + self.p - subtrahend }
    }

    /// A sum of up to 16 products, divided by 2^64.
    #[inline(always)]
    pub(super) fn reduce_16(self, sum: u128) -> u64 {
        // 16 (p - 1)^2 < 4 p 2^64
        let mut high = (sum >> 64) as u64;
        high -= if high >= 2 * self.p { 2 * self.p } else { 0 };
        high -= if high >= self.p { self.p } else { 0 };
        self.reduce(u128::from(high) << 64 | u128::from(sum as u64))
    }

    /// `sum + a b`, below `p 2^64` again.
    #[inline(always)]
    pub(super) fn add_product(self, sum: u128, a: u64, b: u64) -> u128 {
        let sum = sum + u128::from(a) * u128::from(b);
        let high = (sum >> 64) as u64;
        let high = if high >= self.p { high - self.p } else { high };
        u128::from(high) << 64 | u128::from(sum as u64)
    }

    /// `2^64 a`.
    #[inline(always)]
    pub(super) fn scaled(self, a: u64) -> u64 {
        self.reduce(u128::from(a) * u128::from(self.square))
    }

    /// The product of a residue and a scaled factor.
    #[inline(always)]
    pub(super) fn product(self, a: u64, scaled: u64) -> u64 {
        self.reduce(u128::from(a) * u128::from(scaled))
    }

    #[inline(always)]
    pub(super) fn add(self, a: u64, b: u64) -> u64 {
        let sum = a + b;
        if sum >= self.p { sum - self.p } else { sum }
    }

    #[inline(always)]
    pub(super) fn negative(self, a: u64) -> u64 {
        if a == 0 { 0 } else { self.p - a }
    }

    /// The inverse of a residue that is not zero.
    pub(super) fn inverse(self, a: u64) -> u64 {
        let (mut power, mut result, mut exponent) = (self.scaled(a), 1, self.p - 2);
        while exponent > 0 {
            if exponent % 2 == 1 {
                result = self.product(result, power);
            }
            power = self.product(power, power);
            exponent /= 2;
        }
        result
    }
}

/// Whether an odd number is a prime: the test of Miller and Rabin with bases that decide it below 3.3e24 (Sorenson and
/// Webster 2017).
fn is_prime(n: u64) -> bool {
    const BASES: [u64; 13] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41];
    if n < 2 {
        return false;
    }
    let product = |a: u64, b: u64| (u128::from(a) * u128::from(b) % u128::from(n)) as u64;
    let shift = (n - 1).trailing_zeros();
    BASES.iter().all(|&base| {
        if base % n == 0 {
            return base == n;
        }
        let (mut x, mut power, mut exponent) = (1, base % n, (n - 1) >> shift);
        while exponent > 0 {
            if exponent % 2 == 1 {
                x = product(x, power);
            }
            power = product(power, power);
            exponent /= 2;
        }
        if x == 1 {
            return true;
        }
        for _ in 0..shift {
            if x == n - 1 {
                return true;
            }
            x = product(x, x);
        }
        false
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const PRIMES: [u64; 6] = [3, 5, 101, 65_537, (1 << 61) - 1, (1 << 62) - 57];

    #[test]
    fn primes_are_told_from_other_numbers() {
        let by_division = |n: u64| n > 2 && (2..n).take_while(|d| d * d <= n).all(|d| !n.is_multiple_of(d));
        assert!((0..20_000).filter(|n| n % 2 == 1).all(|n| is_prime(n) == by_division(n)));
        assert!(PRIMES.iter().all(|&p| Prime::new(p).is_ok()));
        // two primes squared and multiplied, a Carmichael number, a strong pseudoprime to the bases up to 37
        let composite = [2_147_483_647 * 2_147_483_629, 1_000_003 * 1_000_003, 56_052_361, 318_665_857_834_031_151];
        assert!(composite.iter().all(|&n| Prime::new(n).is_err()));
        assert!([0, 1, 2, 4, 1 << 62, (1 << 63) - 25, u64::MAX].iter().all(|&n| Prime::new(n).is_err()));
    }

    proptest! {
        #[test]
        fn sums_of_products_are_those_of_the_integers(which in 0usize..6, numbers in prop::collection::vec(any::<(u64, u64)>(), 1..=16)) {
            let (p, prime) = (PRIMES[which], Prime::new(PRIMES[which]).unwrap());
            let pairs: Vec<(u64, u64)> = numbers.iter().map(|&(a, b)| (a % p, b % p)).collect();
            let wanted = pairs.iter().fold(0, |sum, &(a, b)| (sum + u128::from(a) * u128::from(b)) % u128::from(p)) as u64;
            let kept = pairs.iter().fold(0, |sum, &(a, b)| prime.add_product(sum, a, prime.scaled(b)));
            let whole: u128 = pairs.iter().map(|&(a, b)| u128::from(a) * u128::from(prime.scaled(b))).sum();
            prop_assert_eq!([prime.reduce(kept), prime.reduce_16(whole)], [wanted; 2]);
        }

        #[test]
        fn inverses_and_negatives_are_inverses(which in 0usize..6, number in any::<u64>()) {
            let prime = Prime::new(PRIMES[which]).unwrap();
            let a = prime.residue(number);
            prop_assert_eq!(prime.add(a, prime.negative(a)), 0);
            prop_assert_eq!(prime.reduce(u128::from(prime.scaled(a))), a);
            prop_assume!(a != 0);
            prop_assert_eq!(prime.product(a, prime.scaled(prime.inverse(a))), 1);
        }
    }

    /// The largest residues of the largest prime are what comes nearest to overflow.
    #[test]
    fn the_largest_sums_fit() {
        let p = (1 << 62) - 57;
        let prime = Prime::new(p).unwrap();
        let square = u128::from(p - 1) * u128::from(p - 1);
        let mut kept = 0;
        for n in 1..=1000u32 {
            kept = prime.add_product(kept, p - 1, p - 1);
            assert_eq!(prime.scaled(prime.reduce(kept)), u64::from(n));
        }
        let reduced = prime.reduce_16(16 * square);
        assert!(reduced < p);
        assert_eq!(prime.scaled(reduced), 16);
    }
}
