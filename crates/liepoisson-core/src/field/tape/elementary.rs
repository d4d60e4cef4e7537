//! Elementary functions of a register: the same bits for every width, from `+ - *` and fused multiply-add alone.

use super::graph::Function;
use crate::lanes::{Lane, Number, polynomial};
use std::f64::consts::{FRAC_2_PI, FRAC_PI_2, LN_2, LOG2_E};

/// `FRAC_PI_2 + PI_2_MIDDLE + PI_2_LOW` is pi/2 to 160 bits.
const PI_2_MIDDLE: f64 = 6.123233995736766e-17;
const PI_2_LOW: f64 = -1.4973849048591698e-33;
/// `LN_2 + LN_2_LOW` is ln 2 to 106 bits.
const LN_2_LOW: f64 = 2.3190468138462996e-17;

/// Beyond this the number of quarter turns is no longer certain to one: such lanes go to `libm`.
const LARGEST_ANGLE: f64 = 1e9;
/// Beyond this `exp` comes near the ends of the range of numbers: such lanes go to `libm`.
const LARGEST_EXPONENT: f64 = 700.0;

/// Minimax coefficients of FreeBSD's msun for `|r| <= pi/4`: `sin r = r + r^3 (S1 + ...)`.
const SINE: [f64; 6] = [
    -1.666_666_666_666_663_2e-1,
    8.333_333_333_322_49e-3,
    -1.984_126_982_985_795e-4,
    2.755_731_370_707_006_8e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];
/// `cos r = 1 - r^2/2 + r^4 (C1 + ...)`
const COSINE: [f64; 6] = [
    4.166_666_666_666_66e-2,
    -1.388_888_888_887_411e-3,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];
/// `1/n!` from `n = 2`: the remainder after `n = 13` is below 4e-18 for `|r| <= ln(2)/2`.
const EXPONENTIAL: [f64; 12] = [
    1.0 / 2.0,
    1.0 / 6.0,
    1.0 / 24.0,
    1.0 / 120.0,
    1.0 / 720.0,
    1.0 / 5_040.0,
    1.0 / 40_320.0,
    1.0 / 362_880.0,
    1.0 / 3_628_800.0,
    1.0 / 39_916_800.0,
    1.0 / 479_001_600.0,
    1.0 / 6_227_020_800.0,
];

/// `a - b`
#[inline(always)]
fn minus<V: Lane>(a: V, b: V) -> V {
    b.neg_mul_add(V::splat(1.0), a)
}

/// `x factor`, rounded to a whole number (halves to even), for results below 2^51.
#[inline(always)]
fn round_product<V: Lane>(x: V, factor: f64) -> V {
    // Adding 1.5 * 2^52 leaves no bits for a fraction.
    const SHIFT: f64 = 6_755_399_441_055_744.0;
    minus(x.mul_add(V::splat(factor), V::splat(SHIFT)), V::splat(SHIFT))
}

/// `x - n (high + middle + low)` as a number and what it lacks.
#[inline(always)]
fn reduce<V: Lane>(x: V, n: V, high: f64, middle: f64, low: f64) -> (V, V) {
    let first = n.fused_neg_mul_add(V::splat(high), x); // exact: a multiple of 2^-53 below one
    let second = n.mul(V::splat(middle));
    let second_lacks = n.fused_mul_add(V::splat(middle), second.mul(V::splat(-1.0)));
    let r = minus(first, second);
    // what the difference lost, whichever of the two is larger
    let taken = minus(r, first);
    let lost = minus(minus(first, minus(r, taken)), second.add(taken));
    (r, n.neg_mul_add(V::splat(low), minus(lost, second_lacks)))
}

/// Whether no lane is larger than `limit` in size; NaN counts as small.
#[inline(always)]
fn all_within<V: Lane>(x: V, limit: f64) -> bool {
    if V::IS_RECORDED {
        return x.abs().record_limit(V::splat(limit));
    }
    !x.as_scalars().iter().fold(false, |beyond, lane| beyond | (lane.to_f64().abs() > limit))
}

/// Sine and cosine, each within one unit of round-off.
#[inline(always)]
pub(super) fn sin_cos<V: Lane>(x: V) -> (V, V) {
    let one = V::splat(1.0);
    let n = round_product(x, FRAC_2_PI);
    let (r, tail) = reduce(x, n, FRAC_PI_2, PI_2_MIDDLE, PI_2_LOW);
    let z = r.mul(r);
    let half = z.mul(V::splat(0.5));
    let w = minus(one, half);
    let sine = {
        let cubic = r.mul(z).mul(polynomial(&SINE, z));
        r.add(tail.mul_add(w, cubic))
    };
    let cosine = {
        let quartic = z.mul(z).mul(polynomial(&COSINE, z));
        w.add(minus(minus(one, w), half).add(r.neg_mul_add(tail, quartic)))
    };
    // n mod 4 in {-2, ..., 2}; whole numbers below 2^51, so all of this is exact
    let quarter = round_product(n, 0.25).neg_mul_add(V::splat(4.0), n);
    let odd = round_product(n, 0.5).neg_mul_add(V::splat(2.0), n).abs();
    // even quarters: 1 or -1; odd: 0; and the other way round
    let (even_sign, odd_sign) = (minus(one, quarter.abs()), odd.mul(quarter));
    let mut result = (cosine.mul_add(odd_sign, sine.mul(even_sign)), sine.neg_mul_add(odd_sign, cosine.mul(even_sign)));
    if !all_within(x, LARGEST_ANGLE) {
        for lane in 0..V::WIDTH {
            let angle = x.get(lane);
            if angle.abs() > LARGEST_ANGLE {
                let (sine, cosine) = libm::sincos(angle);
                result.0.set(lane, sine);
                result.1.set(lane, cosine);
            }
        }
    }
    result
}

/// The exponential function, within one unit of round-off.
#[inline(always)]
pub(super) fn exp<V: Lane>(x: V) -> V {
    let n = round_product(x, LOG2_E);
    let (r, tail) = reduce(x, n, LN_2, LN_2_LOW, 0.0);
    let above_one = r.add(r.mul(r).mul_add(polynomial(&EXPONENTIAL, r), tail));
    // in range for every lane that keeps this result
    let power = n.power_of_two();
    let mut result = power.mul_add(above_one, power);
    if !all_within(x, LARGEST_EXPONENT) {
        for lane in 0..V::WIDTH {
            let exponent = x.get(lane);
            if exponent.abs() > LARGEST_EXPONENT {
                result.set(lane, libm::exp(exponent));
            }
        }
    }
    result
}

/// Any function, lane by lane.
#[inline(always)]
pub(super) fn each<V: Lane>(mut x: V, function: impl Fn(f64) -> f64) -> V {
    for lane in x.as_scalars_mut() {
        *lane = Number::of(function(lane.to_f64()));
    }
    x
}

/// What is computed of one register at order 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Called {
    /// Sine and cosine, circular or hyperbolic.
    Pair { hyperbolic: bool },
    /// One function, twice.
    One(Function),
}

impl Called {
    #[inline(always)]
    pub(super) fn of<V: Lane>(self, x: V) -> [V; 2] {
        // sines, cosines and exponentials are operations on registers but for large arguments
        let is_called = !matches!(self, Called::Pair { hyperbolic: false } | Called::One(Function::Exp));
        if is_called && let Some(recorded) = V::record_call(self.code(), x) {
            return recorded;
        }
        self.compute(x)
    }

    #[inline(always)]
    pub(super) fn compute<V: Lane>(self, x: V) -> [V; 2] {
        match self {
            Called::Pair { hyperbolic: true } => [each(x, libm::sinh), each(x, libm::cosh)],
            Called::Pair { hyperbolic: false } => sin_cos(x).into(),
            Called::One(Function::Exp) => [exp(x); 2],
            Called::One(function) => [each(x, |x| function.value(x)); 2],
        }
    }

    /// The function as two numbers.
    fn code(self) -> [u64; 2] {
        match self {
            Called::Pair { hyperbolic } => [u64::from(hyperbolic), 0],
            Called::One(function) => function.code(),
        }
    }

    /// The function with this code.
    pub(super) fn from_code([tag, number]: [u64; 2]) -> Called {
        match tag {
            0 | 1 => Called::Pair { hyperbolic: tag == 1 },
            _ => Called::One(Function::from_code(tag, number)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Distance in units of the last place of `b`.
    fn ulps(a: f64, b: f64) -> f64 {
        if a == b {
            return 0.0;
        }
        let ulp = (f64::from_bits(b.abs().to_bits() + 1) - b.abs()).max(f64::MIN_POSITIVE);
        (a - b).abs() / ulp
    }

    proptest! {
        /// libm is itself within one unit.
        #[test]
        fn sine_and_cosine_agree_with_libm(x in prop_oneof![-1.0..1.0_f64, -100.0..100.0_f64, -2e9..2e9_f64]) {
            let (s, c) = sin_cos(x);
            prop_assert!(ulps(s, libm::sin(x)) <= 1.0, "{s} {}", libm::sin(x));
            prop_assert!(ulps(c, libm::cos(x)) <= 1.0, "{c} {}", libm::cos(x));
        }

        /// Next to the zeros nearly all digits of the angle cancel.
        #[test]
        fn sine_and_cosine_keep_their_digits_next_to_their_zeros(n in -600_000_000_i64..600_000_000) {
            let x = n as f64 * FRAC_PI_2;
            let (s, c) = sin_cos(x);
            prop_assert!(ulps(s, libm::sin(x)) <= 1.0, "{s} {}", libm::sin(x));
            prop_assert!(ulps(c, libm::cos(x)) <= 1.0, "{c} {}", libm::cos(x));
        }

        #[test]
        fn exponential_agrees_with_libm(x in prop_oneof![-1.0..1.0_f64, -800.0..800.0_f64]) {
            prop_assert!(ulps(exp(x), libm::exp(x)) <= 1.0, "{} {}", exp(x), libm::exp(x));
        }
    }

    #[test]
    fn special_arguments_give_what_they_should() {
        for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(sin_cos(x).0.is_nan() && sin_cos(x).1.is_nan());
        }
        assert_eq!(sin_cos(0.0), (0.0, 1.0));
        assert_eq!((exp(0.0), exp(f64::INFINITY), exp(f64::NEG_INFINITY)), (1.0, f64::INFINITY, 0.0));
        assert!(exp(f64::NAN).is_nan());
        assert_eq!(exp(710.0), f64::INFINITY);
    }
}
