//! Exact rational numbers of any size, the constants of formulas.

use super::natural::Natural;
use std::cmp::Ordering;
use std::fmt;
use std::sync::Arc;

/// A rational number in lowest terms.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Rational(Arc<Parts>);

#[derive(Debug, PartialEq, Eq, Hash)]
struct Parts {
    negative: bool,
    numerator: Natural,
    /// Not zero.
    denominator: Natural,
}

impl Rational {
    /// Numerator and denominator without a common factor.
    fn of(negative: bool, numerator: Natural, denominator: Natural) -> Rational {
        let negative = negative && !numerator.is_zero();
        Rational(Arc::new(Parts { negative, numerator, denominator }))
    }

    fn new(negative: bool, numerator: Natural, denominator: Natural) -> Rational {
        let divisor = numerator.greatest_common_divisor(&denominator);
        if divisor.is_one() {
            return Rational::of(negative, numerator, denominator);
        }
        Rational::of(negative, numerator.divided(&divisor).0, denominator.divided(&divisor).0)
    }

    /// A whole number.
    pub fn integer(value: i64) -> Rational {
        let (numerator, denominator) = (Natural::from_u64(value.unsigned_abs()), Natural::from_u64(1));
        Rational::of(value < 0, numerator, denominator)
    }

    pub(super) fn whole(value: Natural) -> Rational {
        Rational::of(false, value, Natural::from_u64(1))
    }

    /// Zero.
    pub fn zero() -> Rational {
        Rational::integer(0)
    }

    /// One.
    pub fn one() -> Rational {
        Rational::integer(1)
    }

    /// A quotient of whole numbers, the second of which is not zero.
    pub fn fraction(numerator: i64, denominator: u32) -> Rational {
        let (over, under) = (Natural::from_u64(numerator.unsigned_abs()), Natural::from_u64(u64::from(denominator)));
        Rational::new(numerator < 0, over, under)
    }

    /// A decimal number: digits, perhaps with a point, times a power of ten.
    pub(super) fn decimal(digits: &str, exponent: i64) -> Rational {
        let (whole, part) = digits.split_once('.').unwrap_or((digits, ""));
        let mantissa = Natural::from_digits(&format!("{whole}{part}"));
        let exponent = exponent - part.len() as i64;
        let power = Natural::from_u64(10).power(exponent.unsigned_abs() as u32);
        if exponent < 0 {
            Rational::new(false, mantissa, power)
        } else {
            Rational::of(false, mantissa.times(&power), Natural::from_u64(1))
        }
    }

    /// A fixed-point number, `value / 2^bits`.
    pub(super) fn scaled(negative: bool, value: Natural, bits: u64) -> Rational {
        Rational::new(negative, value, Natural::from_u64(1).shifted_left(bits))
    }

    /// The size times `2^bits`, rounded down.
    pub(super) fn fixed(&self, bits: u64) -> Natural {
        self.0.numerator.shifted_left(bits).divided(&self.0.denominator).0
    }

    pub(super) fn numerator(&self) -> &Natural {
        &self.0.numerator
    }

    pub(super) fn denominator(&self) -> &Natural {
        &self.0.denominator
    }

    /// Whether it is zero.
    pub fn is_zero(&self) -> bool {
        self.0.numerator.is_zero()
    }

    /// Whether it is one.
    pub fn is_one(&self) -> bool {
        !self.0.negative && self.0.numerator.is_one() && self.0.denominator.is_one()
    }

    /// Whether it is below zero.
    pub fn is_negative(&self) -> bool {
        self.0.negative
    }

    /// Whether it is a whole number.
    pub fn is_integer(&self) -> bool {
        self.0.denominator.is_one()
    }

    /// The whole number that it is, if it is one of 32 bits.
    pub fn to_integer(&self) -> Option<i64> {
        let size = self.0.numerator.to_u64().filter(|&size| self.is_integer() && size <= u64::from(u32::MAX))? as i64;
        Some(if self.0.negative { -size } else { size })
    }

    /// The largest whole number that is not above it, if it has 32 bits.
    pub fn floor(&self) -> Option<i64> {
        let (quotient, rest) = self.0.numerator.divided(&self.0.denominator);
        let size = quotient.to_u64().filter(|&size| size <= u64::from(u32::MAX))? as i64;
        Some(if self.0.negative { -size - i64::from(!rest.is_zero()) } else { size })
    }

    /// Bits of numerator and denominator together.
    pub fn bits(&self) -> u64 {
        self.0.numerator.bits() + self.0.denominator.bits()
    }

    /// The sum.
    pub fn plus(&self, other: &Rational) -> Rational {
        let left = self.0.numerator.times(&other.0.denominator);
        let right = other.0.numerator.times(&self.0.denominator);
        let denominator = self.0.denominator.times(&other.0.denominator);
        if self.0.negative == other.0.negative {
            return Rational::new(self.0.negative, left.plus(&right), denominator);
        }
        match left.cmp(&right) {
            Ordering::Less => Rational::new(other.0.negative, right.minus(&left), denominator),
            _ => Rational::new(self.0.negative, left.minus(&right), denominator),
        }
    }

    /// The product.
    pub fn times(&self, other: &Rational) -> Rational {
        let negative = self.0.negative != other.0.negative;
        let numerator = self.0.numerator.times(&other.0.numerator);
        Rational::new(negative, numerator, self.0.denominator.times(&other.0.denominator))
    }

    /// The opposite number.
    pub fn negated(&self) -> Rational {
        Rational::of(!self.0.negative, self.0.numerator.clone(), self.0.denominator.clone())
    }

    /// The size.
    pub fn size(&self) -> Rational {
        if self.0.negative { self.negated() } else { self.clone() }
    }

    /// One over the number, which is not zero.
    pub fn reciprocal(&self) -> Rational {
        debug_assert!(!self.is_zero());
        Rational::of(self.0.negative, self.0.denominator.clone(), self.0.numerator.clone())
    }

    /// A whole power; of zero no negative one.
    pub fn power(&self, exponent: i64) -> Rational {
        let times = exponent.unsigned_abs() as u32;
        let negative = self.0.negative && times % 2 == 1;
        let result = Rational::of(negative, self.0.numerator.power(times), self.0.denominator.power(times));
        if exponent < 0 { result.reciprocal() } else { result }
    }

    /// The nearest double, to even where two are; infinite above the range.
    pub fn to_f64(&self) -> f64 {
        if self.is_zero() {
            return 0.0;
        }
        // a quotient of 65 or 66 bits, whose last bit says whether a rest is left
        let shift = 65 - (self.0.numerator.bits() as i64 - self.0.denominator.bits() as i64);
        let (over, under) = if shift >= 0 {
            (self.0.numerator.shifted_left(shift as u64), self.0.denominator.clone())
        } else {
            (self.0.numerator.clone(), self.0.denominator.shifted_left(-shift as u64))
        };
        let (quotient, rest) = over.divided(&under);
        let bits = quotient.bits() as i64;
        // the place of the last bit that a double has, as an exponent of two
        let last = (bits - shift - 53).max(-1074);
        let dropped = (last + shift) as u64; // at least 12
        let (kept, half) = (quotient.shifted_right(dropped), quotient.shifted_right(dropped - 1));
        let is_half_set = half.minus(&kept.shifted_left(1)).is_one();
        let beyond = !rest.is_zero() || quotient.cmp(&half.shifted_left(dropped - 1)) != Ordering::Equal;
        let mut mantissa = kept.to_u64().unwrap_or(0);
        if is_half_set && (beyond || mantissa % 2 == 1) {
            mantissa += 1;
        }
        let size = power_of_two(mantissa as f64, last);
        if self.0.negative { -size } else { size }
    }

    /// The root of this order, if it is rational; of a number that is not negative.
    pub(super) fn exact_root(&self, order: u32) -> Option<Rational> {
        let (numerator, denominator) = (root(&self.0.numerator, order)?, root(&self.0.denominator, order)?);
        Some(Rational::of(false, numerator, denominator))
    }
}

/// `value 2^exponent`; exact where the result is a double.
fn power_of_two(value: f64, exponent: i64) -> f64 {
    let half = exponent / 2;
    if exponent > 1023 {
        return f64::INFINITY;
    }
    value * 2f64.powi(half as i32) * 2f64.powi((exponent - half) as i32)
}

/// The whole root of this order, if there is one: by bisection.
fn root(number: &Natural, order: u32) -> Option<Natural> {
    if number.is_zero() || number.is_one() {
        return Some(number.clone());
    }
    let mut low = Natural::from_u64(1);
    let mut high = low.shifted_left(number.bits() / u64::from(order) + 1);
    loop {
        let middle = low.plus(&high).shifted_right(1);
        if middle == low {
            return (low.power(order) == *number).then_some(low);
        }
        match middle.power(order).cmp(number) {
            Ordering::Greater => high = middle,
            _ => low = middle,
        }
    }
}

impl PartialOrd for Rational {
    fn partial_cmp(&self, other: &Rational) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Rational {
    fn cmp(&self, other: &Rational) -> Ordering {
        let difference = self.plus(&other.negated());
        match (difference.is_zero(), difference.0.negative) {
            (true, _) => Ordering::Equal,
            (_, true) => Ordering::Less,
            _ => Ordering::Greater,
        }
    }
}

impl fmt::Display for Rational {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sign = if self.0.negative { "-" } else { "" };
        write!(f, "{sign}{}", self.0.numerator.digits())?;
        if self.is_integer() { Ok(()) } else { write!(f, "/{}", self.0.denominator.digits()) }
    }
}

#[cfg(test)]
mod tests {
    use super::Rational;
    use proptest::prelude::*;

    #[test]
    fn doubles_are_rounded_to_even_at_every_size() {
        for (text, exponent, wanted) in [
            ("1", 0, 1.0),
            ("0.1", 0, 0.1),
            ("9007199254740993", 0, 9007199254740992.0),
            ("9007199254740995", 0, 9007199254740996.0),
            ("4.9406564584124654", -324, 5e-324),
            ("2.4703282292062327", -324, 0.0),
            ("2.4703282292062328", -324, 5e-324),
            ("1.7976931348623157", 308, f64::MAX),
            ("1.7976931348623159", 308, f64::INFINITY),
            ("2.2250738585072011", -308, 2.225073858507201e-308),
        ] {
            assert_eq!(Rational::decimal(text, exponent).to_f64(), wanted, "{text}e{exponent}");
        }
    }

    #[test]
    fn roots_are_found_where_they_are_rational() {
        let number = Rational::decimal("8", 60).times(&Rational::fraction(1, 27));
        assert_eq!(number.exact_root(3), Some(Rational::decimal("2", 20).times(&Rational::fraction(1, 3))));
        assert_eq!(number.exact_root(2), None);
    }

    proptest! {
        #[test]
        fn a_decimal_is_the_double_that_it_prints_as(bits in any::<u64>()) {
            let wanted = f64::from_bits(bits & (u64::MAX >> 1));
            prop_assume!(wanted.is_finite());
            let text = format!("{wanted:e}");
            let (digits, exponent) = text.split_once('e').unwrap();
            prop_assert_eq!(Rational::decimal(digits, exponent.parse().unwrap()).to_f64(), wanted);
        }

        #[test]
        fn quotients_of_doubles_are_those_of_the_processor(a in 1u64..1 << 53, b in 1u64..1 << 53) {
            let number = Rational::integer(a as i64).times(&Rational::integer(b as i64).reciprocal());
            prop_assert_eq!(number.to_f64(), a as f64 / b as f64);
        }

        #[test]
        fn long_numbers_obey_the_laws(a in "[1-9][0-9]{0,90}", b in "[1-9][0-9]{0,60}", c in "[1-9][0-9]{0,40}") {
            let [a, b, c] = [a, b, c].map(|text| Rational::decimal(&text, 0));
            let quotient = a.times(&b.reciprocal());
            prop_assert_eq!(quotient.times(&b), a.clone());
            prop_assert_eq!(quotient.plus(&c).plus(&c.negated()), quotient.clone());
            prop_assert_eq!(quotient.plus(&c).times(&b), a.plus(&c.times(&b)));
            prop_assert_eq!(a.to_string().parse::<f64>().unwrap(), a.to_f64());
        }
    }
}
