//! Rational numbers, exactly: the constants of fields and levels, and what is proved of them without rounding.

use super::interval::Interval;
use crate::error::Error;
use std::cmp::Ordering;

/// A quotient of two integers of at most 127 bits, in lowest terms.
///
/// An operation whose result does not fit says so by `None`; nothing is ever rounded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rational {
    numerator: i128,
    /// Positive.
    denominator: i128,
}

fn greatest_common_divisor(mut a: u128, mut b: u128) -> u128 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

impl Rational {
    /// Zero.
    pub const ZERO: Rational = Rational { numerator: 0, denominator: 1 };

    /// The quotient of two integers; `None` if the second is zero, or either is `i128::MIN`.
    pub fn new(numerator: i128, denominator: i128) -> Option<Rational> {
        if denominator == 0 || numerator == i128::MIN || denominator == i128::MIN {
            return None;
        }
        let divisor = greatest_common_divisor(numerator.unsigned_abs(), denominator.unsigned_abs()) as i128;
        let sign = denominator.signum();
        Some(Rational { numerator: sign * (numerator / divisor), denominator: sign * (denominator / divisor) })
    }

    /// An integer.
    pub fn integer(value: i64) -> Rational {
        Rational { numerator: i128::from(value), denominator: 1 }
    }

    /// Reads `-3`, `1/3`, `0.25`, `-1.5e-3`: what Python's `Fraction` reads, without spaces and underscores inside.
    ///
    /// # Errors
    /// A text that is none of these; a numerator or denominator of more than 127 bits.
    pub fn parse(text: &str) -> Result<Rational, Error> {
        let refused = || Error::RationalText { got: text.chars().take(60).collect() };
        let trimmed = text.trim();
        let (numerator, denominator) = match trimmed.split_once('/') {
            Some((numerator, denominator)) => {
                let is_whole = |part: &str| part.bytes().all(|byte| byte.is_ascii_digit());
                if !is_whole(denominator) || !is_whole(numerator.trim_start_matches(['+', '-'])) {
                    return Err(refused());
                }
                (decimal(numerator), decimal(denominator))
            }
            None => (decimal(trimmed), Some(Rational::integer(1))),
        };
        numerator.zip(denominator).and_then(|(n, d)| n.over(d)).ok_or_else(refused)
    }

    /// The sum.
    pub fn plus(self, other: Rational) -> Option<Rational> {
        let left = self.numerator.checked_mul(other.denominator)?;
        let right = other.numerator.checked_mul(self.denominator)?;
        Rational::new(left.checked_add(right)?, self.denominator.checked_mul(other.denominator)?)
    }

    /// The product.
    pub fn times(self, other: Rational) -> Option<Rational> {
        let numerator = self.numerator.checked_mul(other.numerator)?;
        Rational::new(numerator, self.denominator.checked_mul(other.denominator)?)
    }

    /// The quotient; `None`, too, where the divisor is zero.
    pub fn over(self, other: Rational) -> Option<Rational> {
        self.times(Rational::new(other.denominator, other.numerator)?)
    }

    /// The number with the other sign.
    pub fn negative(self) -> Rational {
        Rational { numerator: -self.numerator, ..self }
    }

    /// Whether it is zero.
    pub fn is_zero(self) -> bool {
        self.numerator == 0
    }

    /// The narrowest interval of doubles that contains the number: its two neighbours, or the number itself.
    pub fn enclosure(self) -> Interval {
        let magnitude = magnitude(self.numerator.unsigned_abs(), self.denominator.unsigned_abs());
        if self.numerator < 0 { -magnitude } else { magnitude }
    }
}

impl PartialOrd for Rational {
    /// `None` where the products that decide do not fit.
    fn partial_cmp(&self, other: &Rational) -> Option<Ordering> {
        let left = self.numerator.checked_mul(other.denominator)?;
        Some(left.cmp(&other.numerator.checked_mul(self.denominator)?))
    }
}

/// A decimal number with an optional exponent.
fn decimal(text: &str) -> Option<Rational> {
    let (digits, exponent) = match text.split_once(['e', 'E']) {
        Some((digits, exponent)) => (digits, exponent.parse::<i32>().ok()?),
        None => (text, 0),
    };
    let (is_negative, digits) = match digits.as_bytes().first()? {
        b'-' => (true, &digits[1..]),
        b'+' => (false, &digits[1..]),
        _ => (false, digits),
    };
    let (whole, part) = digits.split_once('.').unwrap_or((digits, ""));
    if whole.is_empty() && part.is_empty() {
        return None;
    }
    let mut value: i128 = 0;
    for byte in whole.bytes().chain(part.bytes()) {
        let digit = byte.is_ascii_digit().then(|| i128::from(byte - b'0'))?;
        value = value.checked_mul(10)?.checked_add(digit)?;
    }
    let exponent = exponent.checked_sub(i32::try_from(part.len()).ok()?)?;
    let power = 10_i128.checked_pow(exponent.unsigned_abs())?;
    let (numerator, denominator) = if exponent < 0 { (value, power) } else { (value.checked_mul(power)?, 1) };
    Rational::new(if is_negative { -numerator } else { numerator }, denominator)
}

/// `p / q` by long division in binary: 53 digits, and whether something remains. Both are below 2^127, so that twice a
/// remainder fits, and the quotient is far from the ends of the range of doubles.
fn magnitude(p: u128, q: u128) -> Interval {
    if p == 0 {
        return Interval::ZERO;
    }
    let mut quotient = p / q;
    let mut remainder = p % q;
    let mut exponent = 0_i32;
    while quotient < 1 << 52 {
        remainder <<= 1;
        quotient <<= 1;
        exponent -= 1;
        if remainder >= q {
            remainder -= q;
            quotient |= 1;
        }
    }
    let mut is_exact = remainder == 0;
    while quotient >= 1 << 53 {
        is_exact &= quotient & 1 == 0;
        quotient >>= 1;
        exponent += 1;
    }
    let scaled = |digits: u128| digits as f64 * f64::from_bits(((1023 + exponent) as u64) << 52);
    Interval::new(scaled(quotient), scaled(if is_exact { quotient } else { quotient + 1 }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_read_exactly() {
        let same =
            [("1/3", 1, 3), ("-2/-6", 1, 3), ("0.25", 1, 4), ("-1.5e-3", -3, 2000), ("+7", 7, 1), ("2e3", 2000, 1)];
        for (text, numerator, denominator) in same {
            match Rational::parse(text) {
                Ok(number) => assert_eq!(number, Rational::new(numerator, denominator).unwrap(), "{text}"),
                Err(_) => assert_eq!(text, "-2/-6", "a sign belongs to the numerator"),
            }
        }
        for text in ["", "-", "x", "1/0", "1/", "/2", "1e", "0x1", "nan", "inf", "1/2.5", ".", "1e40", "--1", "1_0"] {
            assert!(Rational::parse(text).is_err(), "{text}");
        }
    }

    #[test]
    fn enclosures_are_the_neighbours() {
        for (text, below) in [("1/3", 1.0 / 3.0), ("0.1", 0.1_f64.next_down()), ("2/3", 2.0 / 3.0)] {
            let enclosure = Rational::parse(text).unwrap().enclosure();
            assert_eq!((enclosure.lo(), enclosure.hi()), (below, below.next_up()), "{text}");
            let negative = Rational::parse(&format!("-{text}")).unwrap().enclosure();
            assert_eq!(negative, -enclosure);
        }
        for text in ["0", "1", "-0.75", "9007199254740993/2", "1/1024"] {
            let enclosure = Rational::parse(text).unwrap().enclosure();
            let is_dyadic = text != "9007199254740993/2";
            assert_eq!(enclosure.width() == 0.0, is_dyadic, "{text}: {enclosure:?}");
        }
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let large = Rational::parse("170141183460469231731687303715884105727").unwrap();
        assert_eq!(large.plus(Rational::integer(1)), None);
        assert_eq!(large.times(Rational::integer(2)), None);
        assert!(Rational::parse("170141183460469231731687303715884105728").is_err());
        let enclosure = large.enclosure();
        assert_eq!((enclosure.lo(), enclosure.hi()), (127.0_f64.exp2().next_down(), 127.0_f64.exp2()));
    }
}
