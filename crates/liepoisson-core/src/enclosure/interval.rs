//! Intervals of doubles: each operation contains all results of its operands' members.

use super::rounding::{add_down, add_up, div_down, div_up, mul_down, mul_up, sqrt_down, sqrt_up, unit};
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// A closed bounded interval `[lo, hi]` of finite doubles, or *nothing known*.
///
/// Nothing is known after a division by an interval that contains zero, a root of one that contains negative numbers, an
/// overflow, an empty intersection. It is kept as NaN: every operation with it gives nothing again, and every question about
/// it (`contains`, `is_within`, ...) is answered by `false`. It differs from itself, as NaN does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    lo: f64,
    hi: f64,
}

impl Interval {
    /// Nothing is known.
    pub const UNKNOWN: Interval = Interval { lo: f64::NAN, hi: f64::NAN };
    /// The number zero.
    pub const ZERO: Interval = Interval { lo: 0.0, hi: 0.0 };
    /// The number one.
    pub const ONE: Interval = Interval { lo: 1.0, hi: 1.0 };

    /// From the lower to the upper bound; unknown if these are no finite numbers in this order.
    pub const fn new(lo: f64, hi: f64) -> Interval {
        if lo <= hi && lo >= f64::MIN && hi <= f64::MAX { Interval { lo, hi } } else { Interval::UNKNOWN }
    }

    /// One double; unknown if it is not finite.
    pub const fn point(value: f64) -> Interval {
        Interval::new(value, value)
    }

    /// `[-radius, radius]`; unknown for a negative radius.
    pub const fn symmetric(radius: f64) -> Interval {
        Interval::new(-radius, radius)
    }

    /// All numbers whose distance from `mid` is at most `radius`.
    pub fn ball(mid: f64, radius: f64) -> Interval {
        Interval::point(mid) + Interval::symmetric(radius)
    }

    /// Bounds of an operation; unknown where one overflowed.
    #[inline(always)]
    fn made(lo: f64, hi: f64) -> Interval {
        if lo >= f64::MIN && hi <= f64::MAX { Interval { lo, hi } } else { Interval::UNKNOWN }
    }

    /// Lower bound, or NaN.
    #[inline(always)]
    pub fn lo(self) -> f64 {
        self.lo
    }

    /// Upper bound, or NaN.
    #[inline(always)]
    pub fn hi(self) -> f64 {
        self.hi
    }

    /// Whether nothing is known.
    pub fn is_unknown(self) -> bool {
        self.lo.is_nan()
    }

    /// A double near the middle, inside.
    pub fn mid(self) -> f64 {
        (0.5 * self.lo + 0.5 * self.hi).clamp_into(self)
    }

    /// A bound of the distances of all members from [`Interval::mid`].
    pub fn rad(self) -> f64 {
        let mid = self.mid();
        add_up(self.hi, -mid).max(add_up(mid, -self.lo))
    }

    /// An upper bound of `hi - lo`.
    pub fn width(self) -> f64 {
        add_up(self.hi, -self.lo)
    }

    /// The greatest absolute value.
    pub fn mag(self) -> f64 {
        if self.is_unknown() { f64::NAN } else { self.hi.abs().max(self.lo.abs()) }
    }

    /// The least absolute value.
    pub fn mig(self) -> f64 {
        match self {
            _ if self.is_unknown() => f64::NAN,
            _ if self.contains(0.0) => 0.0,
            _ => self.lo.abs().min(self.hi.abs()),
        }
    }

    /// Whether `value` is a member.
    pub fn contains(self, value: f64) -> bool {
        self.lo <= value && value <= self.hi
    }

    /// Whether every member is one of `other`.
    pub fn is_within(self, other: Interval) -> bool {
        other.lo <= self.lo && self.hi <= other.hi
    }

    /// Whether every member lies between the bounds of `other` and is neither of them.
    pub fn is_inside(self, other: Interval) -> bool {
        other.lo < self.lo && self.hi < other.hi
    }

    /// Whether all members are greater than zero.
    pub fn is_positive(self) -> bool {
        self.lo > 0.0
    }

    /// Whether all members are less than zero.
    pub fn is_negative(self) -> bool {
        self.hi < 0.0
    }

    /// The least interval that contains both.
    pub fn hull(self, other: Interval) -> Interval {
        if self.is_unknown() || other.is_unknown() {
            return Interval::UNKNOWN;
        }
        Interval { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// The common members; unknown if there are none.
    pub fn meet(self, other: Interval) -> Interval {
        if self.is_unknown() || other.is_unknown() {
            return Interval::UNKNOWN;
        }
        Interval::new(self.lo.max(other.lo), self.hi.min(other.hi))
    }

    /// The square.
    pub fn sqr(self) -> Interval {
        if self.lo >= 0.0 {
            Interval::made(mul_down(self.lo, self.lo), mul_up(self.hi, self.hi))
        } else if self.hi <= 0.0 {
            Interval::made(mul_down(self.hi, self.hi), mul_up(self.lo, self.lo))
        } else {
            let mag = self.mag();
            Interval::made(if mag.is_nan() { mag } else { 0.0 }, mul_up(mag, mag))
        }
    }

    /// A power; `x^0 = 1`.
    pub fn powi(self, exponent: u32) -> Interval {
        match exponent {
            _ if self.is_unknown() => self,
            0 => Interval::ONE,
            1 => self,
            _ => {
                let root = self.powi(exponent / 2).sqr();
                // an odd power is monotone, so that its bounds are powers of the bounds
                match exponent % 2 {
                    0 => root,
                    _ if self.lo >= 0.0 || self.hi <= 0.0 => root * self,
                    _ => Interval::point(self.lo).powi(exponent).hull(Interval::point(self.hi).powi(exponent)),
                }
            }
        }
    }

    /// The square root; unknown where there are negative members.
    pub fn sqrt(self) -> Interval {
        if self.lo >= 0.0 { Interval::made(sqrt_down(self.lo), sqrt_up(self.hi)) } else { Interval::UNKNOWN }
    }

    /// The absolute value.
    pub fn abs(self) -> Interval {
        Interval::made(self.mig(), self.mag())
    }

    /// The lesser of two numbers.
    pub fn min(self, other: Interval) -> Interval {
        if self.is_unknown() || other.is_unknown() {
            return Interval::UNKNOWN;
        }
        Interval { lo: self.lo.min(other.lo), hi: self.hi.min(other.hi) }
    }

    /// The greater of two numbers.
    pub fn max(self, other: Interval) -> Interval {
        -(-self).min(-other)
    }
}

trait ClampInto {
    fn clamp_into(self, bounds: Interval) -> f64;
}

impl ClampInto for f64 {
    fn clamp_into(self, bounds: Interval) -> f64 {
        if bounds.is_unknown() { f64::NAN } else { self.max(bounds.lo).min(bounds.hi) }
    }
}

impl From<f64> for Interval {
    fn from(value: f64) -> Interval {
        Interval::point(value)
    }
}

impl Neg for Interval {
    type Output = Interval;
    #[inline(always)]
    fn neg(self) -> Interval {
        Interval { lo: -self.hi, hi: -self.lo }
    }
}

impl Add for Interval {
    type Output = Interval;
    #[inline(always)]
    fn add(self, other: Interval) -> Interval {
        Interval::made(add_down(self.lo, other.lo), add_up(self.hi, other.hi))
    }
}

impl Sub for Interval {
    type Output = Interval;
    #[inline(always)]
    fn sub(self, other: Interval) -> Interval {
        self + -other
    }
}

impl AddAssign for Interval {
    #[inline(always)]
    fn add_assign(&mut self, other: Interval) {
        *self = *self + other;
    }
}

impl SubAssign for Interval {
    #[inline(always)]
    fn sub_assign(&mut self, other: Interval) {
        *self = *self - other;
    }
}

impl Mul for Interval {
    type Output = Interval;
    /// Of the four products of bounds the two that are needed are chosen by signs, without a branch: those are chance. Only
    /// where both contain zero inside are all four needed. What is unknown comes there, too, and stays so.
    #[inline(always)]
    fn mul(self, other: Interval) -> Interval {
        let is_definite = |x: Interval| (x.lo >= 0.0) | (x.hi <= 0.0);
        let (a, b) = if is_definite(other) { (self, other) } else { (other, self) };
        if !is_definite(b) {
            return product_around_zero(a, b);
        }
        let (first, last) = if b.hi <= 0.0 { (a.hi, a.lo) } else { (a.lo, a.hi) };
        let low = mul_down(first, if first >= 0.0 { b.lo } else { b.hi });
        Interval::made(low, mul_up(last, if last >= 0.0 { b.hi } else { b.lo }))
    }
}

/// The product where both contain zero inside. Rounding is monotone, so the lesser of two rounded products is the rounded
/// lesser one.
#[inline]
pub(super) fn product_around_zero(a: Interval, b: Interval) -> Interval {
    let lower = |x: f64, y: f64| if x < y || x.is_nan() { x } else { y };
    let (low, high) = (lower(a.lo * b.hi, a.hi * b.lo), -lower(-(a.lo * b.lo), -(a.hi * b.hi)));
    Interval::made(low - unit(low), high + unit(high))
}

impl Div for Interval {
    type Output = Interval;
    /// Unknown where the divisor contains zero.
    fn div(self, other: Interval) -> Interval {
        let (a, b) = (self, other);
        if b.hi < 0.0 {
            return -a / -b;
        }
        if b.lo > 0.0 {
            // a bound of the dividend goes with the bound of the divisor that moves it outwards
            let low = if a.lo >= 0.0 { b.hi } else { b.lo };
            let high = if a.hi >= 0.0 { b.lo } else { b.hi };
            return Interval::made(div_down(a.lo, low), div_up(a.hi, high));
        }
        Interval::UNKNOWN
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::enclosure::rational::Rational;
    use proptest::prelude::*;

    /// Numbers whose sums, products and quotients fit into the fractions that the results are compared with.
    fn number() -> impl Strategy<Value = f64> {
        prop_oneof![
            (-1000_i32..1000).prop_map(f64::from),
            (-(1_i64 << 53)..1 << 53, 0..60_i32).prop_map(|(digits, down)| digits as f64 * f64::from(-down).exp2()),
        ]
    }

    fn interval() -> impl Strategy<Value = Interval> {
        (number(), number()).prop_map(|(a, b)| Interval::new(a.min(b), a.max(b)))
    }

    /// Bounds, a point between them, as exact fractions.
    fn members(of: Interval) -> Vec<f64> {
        vec![of.lo(), of.hi(), of.mid()]
    }

    fn exactly(value: f64) -> Rational {
        let (mut digits, mut power) = (value, 0_u32);
        while digits.fract() != 0.0 {
            digits *= 2.0;
            power += 1;
        }
        Rational::new(digits as i128, 1).unwrap().over(Rational::new(1_i128 << power, 1).unwrap()).unwrap()
    }

    /// Whether the exact result is inside, as far as it fits.
    fn contains(result: Interval, exact: Option<Rational>) -> bool {
        let Some(exact) = exact else { return true };
        let narrowest = exact.enclosure();
        // the result contains the number if and only if it contains the narrowest interval around it
        narrowest.is_within(result)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn operations_contain_the_exact_results(a in interval(), b in interval()) {
            for x in members(a) {
                for y in members(b) {
                    let (p, q) = (exactly(x), exactly(y));
                    prop_assert!(contains(a + b, p.plus(q)), "{a:?} + {b:?}");
                    prop_assert!(contains(a - b, p.plus(q.negative())), "{a:?} - {b:?}");
                    prop_assert!(contains(a * b, p.times(q)), "{a:?} * {b:?}");
                    if !b.contains(0.0) {
                        prop_assert!(contains(a / b, p.over(q)), "{a:?} / {b:?}");
                    }
                }
                prop_assert!(contains(a.sqr(), exactly(x).times(exactly(x))));
                prop_assert!(contains(a.abs(), Some(exactly(x.abs()))));
            }
        }

        #[test]
        fn single_numbers_give_neighbours_or_exact_results(x in number(), y in number()) {
            let (a, b) = (Interval::point(x), Interval::point(y));
            let mut results = vec![(a + b, exactly(x).plus(exactly(y))), (a * b, exactly(x).times(exactly(y)))];
            if y != 0.0 {
                results.push((a / b, exactly(x).over(exactly(y))));
            }
            for (result, exact) in results {
                let Some(exact) = exact else { continue };
                let narrowest = exact.enclosure();
                prop_assert!(narrowest.is_within(result));
                if narrowest.width() == 0.0 {
                    prop_assert_eq!(result, narrowest);
                } else {
                    // one unit, rarely two; the narrowest has a width of one
                    prop_assert!(result.width() <= 3.0 * narrowest.width());
                }
            }
        }

        #[test]
        fn roots_and_powers_contain_the_exact_results(digits in 1_i64 << 48..1_i64 << 52, k in 0..6_u32) {
            let x = digits as f64;
            let root = Interval::point(x).sqrt();
            // the bounds, from 2^24 to 2^26, are multiples of 2^-28, so that their squares fit
            let square = |bound: f64| {
                let scaled = (bound * 28.0_f64.exp2()) as i128;
                scaled * scaled
            };
            let (below, exact, above) = (square(root.lo()), i128::from(digits) << 56, square(root.hi()));
            prop_assert!(below <= exact && exact <= above && (above == below || below < exact));
            let whole = (x % 100.0).floor();
            let exact = (0..k).fold(1_i128, |power, _| power * whole as i128);
            prop_assert_eq!(Interval::point(whole).powi(k), Interval::point(exact as f64));
            prop_assert_eq!(Interval::point(whole * whole).sqrt(), Interval::point(whole));
        }

        #[test]
        fn tiny_results_are_moved_outwards(x in 1e-170..1e-160_f64, y in 1e-170..1e-160_f64) {
            let product = Interval::point(x) * Interval::point(y);
            prop_assert!(product.lo() < x * y && x * y < product.hi());
            let quotient = Interval::point(x * 1e-140) / Interval::point(3.0);
            prop_assert!(quotient.lo() < quotient.hi());
        }
    }

    #[test]
    fn powers_of_intervals_around_zero_are_narrow() {
        let x = Interval::new(-2.0, 3.0);
        assert_eq!(x.powi(2), Interval::new(0.0, 9.0));
        assert_eq!(x.powi(3), Interval::new(-8.0, 27.0));
        assert_eq!(x.powi(4), Interval::new(0.0, 81.0));
    }

    #[test]
    fn what_is_not_known_stays_so_and_answers_no() {
        let huge = Interval::point(f64::MAX);
        let unknown = [
            Interval::UNKNOWN,
            Interval::point(f64::NAN),
            Interval::point(f64::INFINITY),
            Interval::new(1.0, 0.0),
            Interval::ONE / Interval::new(-1.0, 1.0),
            Interval::ONE / Interval::ZERO,
            Interval::new(-1.0, 1.0).sqrt(),
            huge + huge,
            -huge - huge,
            huge * huge,
            huge * Interval::new(-2.0, 2.0),
            huge.sqr(),
            huge / Interval::point(0.5),
            Interval::ONE.meet(Interval::ZERO),
        ];
        for nothing in unknown {
            assert!(nothing.is_unknown(), "{nothing:?}");
            let others = [Interval::ZERO, Interval::ONE, Interval::new(-1.0, 2.0), nothing];
            for other in others {
                let results = [nothing + other, other - nothing, nothing * other, other * nothing, nothing / other];
                let more = [other / nothing, nothing.hull(other), nothing.meet(other), nothing.min(other)];
                for result in results.into_iter().chain(more) {
                    assert!(result.is_unknown(), "{nothing:?} with {other:?}: {result:?}");
                }
                assert!(!nothing.is_within(other) && !other.is_within(nothing));
                assert!(!nothing.is_inside(other) && !other.is_inside(nothing));
            }
            for result in [-nothing, nothing.sqr(), nothing.powi(3), nothing.powi(0), nothing.sqrt(), nothing.abs()] {
                assert!(result.is_unknown());
            }
            assert!(!nothing.contains(0.0) && !nothing.is_positive() && !nothing.is_negative());
            assert!(nothing.mag().is_nan() && nothing.mig().is_nan() && nothing.mid().is_nan());
        }
    }

    #[test]
    fn the_middle_and_the_radius_cover_the_interval() {
        for x in [Interval::new(1.0, 1.0 + f64::EPSILON), Interval::new(-1e308, 1e308), Interval::new(0.1, 0.3)] {
            assert!(x.contains(x.mid()));
            assert!(x.is_within(Interval::ball(x.mid(), x.rad())));
        }
    }
}
