//! Natural numbers of any size: what rational constants are made of.

use std::cmp::Ordering;

/// A natural number, by its digits to the base 2^32, the lowest first and the highest not zero.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Natural(Vec<u32>);

impl Natural {
    pub(super) fn zero() -> Natural {
        Natural(vec![])
    }

    pub(super) fn from_u64(value: u64) -> Natural {
        Natural(vec![value as u32, (value >> 32) as u32]).trimmed()
    }

    /// From decimal digits.
    pub(super) fn from_digits(digits: &str) -> Natural {
        digits.bytes().fold(Natural::zero(), |value, digit| value.times_small(10, u32::from(digit - b'0')))
    }

    /// The number as 64 bits, if it fits.
    pub(super) fn to_u64(&self) -> Option<u64> {
        match self.0[..] {
            [] => Some(0),
            [low] => Some(u64::from(low)),
            [low, high] => Some(u64::from(low) | u64::from(high) << 32),
            _ => None,
        }
    }

    fn trimmed(mut self) -> Natural {
        while self.0.last() == Some(&0) {
            self.0.pop();
        }
        self
    }

    pub(super) fn is_zero(&self) -> bool {
        self.0.is_empty()
    }

    pub(super) fn is_one(&self) -> bool {
        self.0 == [1]
    }

    /// Bits without leading zeros.
    pub(super) fn bits(&self) -> u64 {
        self.0.last().map_or(0, |high| 32 * self.0.len() as u64 - u64::from(high.leading_zeros()))
    }

    fn times_small(&self, factor: u32, carry: u32) -> Natural {
        let mut carry = u64::from(carry);
        let mut digits = Vec::with_capacity(self.0.len() + 1);
        for &digit in &self.0 {
            let value = u64::from(digit) * u64::from(factor) + carry;
            digits.push(value as u32);
            carry = value >> 32;
        }
        digits.push(carry as u32);
        Natural(digits).trimmed()
    }

    pub(super) fn plus(&self, other: &Natural) -> Natural {
        let (long, short) = if self.0.len() < other.0.len() { (other, self) } else { (self, other) };
        let mut carry = 0;
        let mut digits = Vec::with_capacity(long.0.len() + 1);
        for (k, &digit) in long.0.iter().enumerate() {
            let value = u64::from(digit) + u64::from(short.0.get(k).copied().unwrap_or(0)) + carry;
            digits.push(value as u32);
            carry = value >> 32;
        }
        digits.push(carry as u32);
        Natural(digits).trimmed()
    }

    /// The difference; `other` is not larger.
    pub(super) fn minus(&self, other: &Natural) -> Natural {
        let mut borrow = 0;
        let mut digits = Vec::with_capacity(self.0.len());
        for (k, &digit) in self.0.iter().enumerate() {
            let value = i64::from(digit) - i64::from(other.0.get(k).copied().unwrap_or(0)) - borrow;
            digits.push(value as u32);
            borrow = i64::from(value < 0);
        }
        debug_assert_eq!(borrow, 0);
        Natural(digits).trimmed()
    }

    pub(super) fn times(&self, other: &Natural) -> Natural {
        let mut digits = vec![0u32; self.0.len() + other.0.len()];
        for (i, &a) in self.0.iter().enumerate() {
            let mut carry = 0;
            for (j, &b) in other.0.iter().enumerate() {
                let value = u64::from(a) * u64::from(b) + u64::from(digits[i + j]) + carry;
                digits[i + j] = value as u32;
                carry = value >> 32;
            }
            digits[i + other.0.len()] = carry as u32;
        }
        Natural(digits).trimmed()
    }

    pub(super) fn shifted_left(&self, bits: u64) -> Natural {
        let (whole, part) = ((bits / 32) as usize, bits % 32);
        let mut digits = vec![0; whole];
        digits.extend(self.times_small(1 << part, 0).0);
        Natural(digits).trimmed()
    }

    pub(super) fn shifted_right(&self, bits: u64) -> Natural {
        let (whole, part) = ((bits / 32) as usize, bits % 32);
        let digits = self.0.get(whole..).unwrap_or(&[]);
        let above = |k: usize| u64::from(digits.get(k + 1).copied().unwrap_or(0)) << 32;
        Natural(digits.iter().enumerate().map(|(k, &digit)| ((above(k) | u64::from(digit)) >> part) as u32).collect())
            .trimmed()
    }

    /// Quotient and remainder; the divisor is not zero. Schoolbook division, Knuth (1997), algorithm 4.3.1 D.
    pub(super) fn divided(&self, divisor: &Natural) -> (Natural, Natural) {
        if let (Some(a), Some(b)) = (self.to_u64(), divisor.to_u64()) {
            return (Natural::from_u64(a / b), Natural::from_u64(a % b));
        }
        if (*self).cmp(divisor) == Ordering::Less {
            return (Natural::zero(), self.clone());
        }
        if let [small] = divisor.0[..] {
            return self.divided_small(small);
        }
        let shift = u64::from(divisor.0[divisor.0.len() - 1].leading_zeros());
        let (v, mut u) = (divisor.shifted_left(shift).0, self.shifted_left(shift).0);
        u.resize(self.0.len() + 1, 0);
        let n = v.len();
        let (high, next) = (u64::from(v[n - 1]), u64::from(v[n - 2]));
        let mut quotient = vec![0; u.len() - n];
        for j in (0..u.len() - n).rev() {
            let top = u64::from(u[j + n]) << 32 | u64::from(u[j + n - 1]);
            let (mut guess, mut rest) = (top / high, top % high);
            while guess >> 32 != 0 || guess * next > (rest << 32 | u64::from(u[j + n - 2])) {
                guess -= 1;
                rest += high;
                if rest >> 32 != 0 {
                    break;
                }
            }
            if subtract_multiple(&mut u[j..=j + n], &v, guess) {
                guess -= 1;
                add_back(&mut u[j..=j + n], &v);
            }
            quotient[j] = guess as u32;
        }
        (Natural(quotient).trimmed(), Natural(u).trimmed().shifted_right(shift))
    }

    fn divided_small(&self, divisor: u32) -> (Natural, Natural) {
        let mut rest = 0;
        let mut digits = vec![0; self.0.len()];
        for (k, &digit) in self.0.iter().enumerate().rev() {
            let value = rest << 32 | u64::from(digit);
            digits[k] = (value / u64::from(divisor)) as u32;
            rest = value % u64::from(divisor);
        }
        (Natural(digits).trimmed(), Natural::from_u64(rest))
    }

    /// The greatest common divisor; powers of two, of which rounded numbers consist, are found without a division.
    pub(super) fn greatest_common_divisor(&self, other: &Natural) -> Natural {
        if self.is_zero() || other.is_zero() {
            return if self.is_zero() { other.clone() } else { self.clone() };
        }
        let (twos, other_twos) = (self.trailing_zeros(), other.trailing_zeros());
        let odd = self.shifted_right(twos).odd_common_divisor(other.shifted_right(other_twos));
        odd.shifted_left(twos.min(other_twos))
    }

    /// How often two divides it, which is not zero.
    fn trailing_zeros(&self) -> u64 {
        let whole = self.0.iter().take_while(|&&digit| digit == 0).count();
        32 * whole as u64 + u64::from(self.0[whole].trailing_zeros())
    }

    fn odd_common_divisor(self, other: Natural) -> Natural {
        let (mut a, mut b) = (self, other);
        while !b.is_zero() {
            if a.is_one() || b.is_one() {
                return Natural::from_u64(1);
            }
            if let (Some(mut p), Some(mut q)) = (a.to_u64(), b.to_u64()) {
                while q != 0 {
                    (p, q) = (q, p % q);
                }
                return Natural::from_u64(p);
            }
            let rest = a.divided(&b).1;
            (a, b) = (b, rest);
        }
        a
    }

    pub(super) fn power(&self, exponent: u32) -> Natural {
        let mut result = Natural::from_u64(1);
        for bit in (0..32 - exponent.leading_zeros()).rev() {
            result = result.times(&result);
            if exponent >> bit & 1 == 1 {
                result = result.times(self);
            }
        }
        result
    }

    /// The largest whole number whose square is not larger: Newton's method from above.
    pub(super) fn square_root(&self) -> Natural {
        if self.is_zero() {
            return Natural::zero();
        }
        let mut root = Natural::from_u64(1).shifted_left(self.bits().div_ceil(2));
        loop {
            let next = root.plus(&self.divided(&root).0).shifted_right(1);
            if next >= root {
                return root;
            }
            root = next;
        }
    }

    /// The factors below 1000 with how often they occur, then what is left of the number.
    pub(super) fn small_factors(&self) -> Vec<(Natural, i64)> {
        let mut factors = vec![];
        let mut rest = self.clone();
        for divisor in 2..1000 {
            let mut count = 0;
            while !rest.is_one() {
                let (quotient, left) = rest.divided_small(divisor);
                if !left.is_zero() {
                    break;
                }
                rest = quotient;
                count += 1;
            }
            if count > 0 {
                factors.push((Natural::from_u64(u64::from(divisor)), count));
            }
        }
        if !rest.is_one() {
            factors.push((rest, 1));
        }
        factors
    }

    /// The decimal digits.
    pub(super) fn digits(&self) -> String {
        let mut parts = vec![];
        let mut rest = self.clone();
        while !rest.is_zero() {
            let (quotient, part) = rest.divided_small(1_000_000_000);
            parts.push(part.to_u64().unwrap_or(0));
            rest = quotient;
        }
        let first = parts.pop().unwrap_or(0).to_string();
        parts.iter().rev().fold(first, |text, part| format!("{text}{part:09}"))
    }
}

impl PartialOrd for Natural {
    fn partial_cmp(&self, other: &Natural) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Natural {
    fn cmp(&self, other: &Natural) -> Ordering {
        self.0.len().cmp(&other.0.len()).then_with(|| self.0.iter().rev().cmp(other.0.iter().rev()))
    }
}

/// `part -= factor divisor`; whether it went below zero.
fn subtract_multiple(part: &mut [u32], divisor: &[u32], factor: u64) -> bool {
    let (mut carry, mut borrow) = (0, 0);
    for (k, digit) in part.iter_mut().enumerate() {
        let product = factor * u64::from(divisor.get(k).copied().unwrap_or(0)) + carry;
        carry = product >> 32;
        let value = i64::from(*digit) - i64::from(product as u32) - borrow;
        *digit = value as u32;
        borrow = i64::from(value < 0);
    }
    borrow != 0
}

/// `part += divisor`, without the last carry.
fn add_back(part: &mut [u32], divisor: &[u32]) {
    let mut carry = 0;
    for (k, digit) in part.iter_mut().enumerate() {
        let value = u64::from(*digit) + u64::from(divisor.get(k).copied().unwrap_or(0)) + carry;
        *digit = value as u32;
        carry = value >> 32;
    }
}

#[cfg(test)]
mod tests {
    use super::Natural;

    #[test]
    fn common_divisors_contain_the_common_powers_of_two() {
        let [a, b, c] = [3u64 << 40, 7 << 9, 5 << 20].map(Natural::from_u64);
        let power = |exponent| Natural::from_u64(1).shifted_left(exponent);
        assert_eq!(a.times(&c).greatest_common_divisor(&b.times(&c)), c.times(&power(9)));
        assert_eq!(a.times(&power(300)).greatest_common_divisor(&power(200)), power(200));
        assert_eq!(a.greatest_common_divisor(&Natural::zero()), a);
        assert_eq!(Natural::zero().greatest_common_divisor(&b), b);
    }
}
