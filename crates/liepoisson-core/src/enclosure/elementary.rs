//! The exponential, the arc tangent and pi, by series with remainders, of intervals.

use super::interval::Interval;

/// `exp(x)`: the series of `x / 2^m`, of size below 1/8, squared m times. Unknown beyond 700.
pub fn exp(x: Interval) -> Interval {
    if x.is_unknown() || x.mag() > 700.0 {
        return Interval::UNKNOWN;
    }
    exp_of_point(x.lo()).hull(exp_of_point(x.hi()))
}

fn exp_of_point(x: f64) -> Interval {
    const DEGREE: u32 = 16;
    let (mut part, mut halvings) = (x, 0);
    while part.abs() > 0.125 {
        part *= 0.5;
        halvings += 1;
    }
    let part = Interval::point(part);
    let mut sum = Interval::ONE;
    for k in (1..=DEGREE).rev() {
        sum = Interval::ONE + sum * part / Interval::point(f64::from(k));
    }
    // what follows is less than twice its first term, with 2 / 17! < 6e-15
    sum += Interval::symmetric((part.powi(DEGREE + 1).abs() * Interval::point(6e-15)).hi());
    (0..halvings).for_each(|_| sum = sum.sqr());
    sum
}

/// `atan(x)`: `atan(x) = 2 atan(x / (1 + sqrt(1 + x^2)))`, four times, then the alternating series.
pub fn atan(x: Interval) -> Interval {
    if x.is_unknown() {
        return x;
    }
    atan_of_point(x.lo()).hull(atan_of_point(x.hi()))
}

fn atan_of_point(x: f64) -> Interval {
    let half = |tangent: Interval| tangent / (Interval::ONE + (Interval::ONE + tangent.sqr()).sqrt());
    let part = (0..4).fold(Interval::point(x), |tangent, _| half(tangent));
    atan_series(part) * Interval::point(16.0)
}

/// `x - x^3 / 3 + x^5 / 5 - ...` for `|x| < 1/4`, where a remainder is less than its first term.
fn atan_series(x: Interval) -> Interval {
    const TERMS: u32 = 16;
    let square = -x.sqr();
    let reciprocal = |k: u32| Interval::ONE / Interval::point(f64::from(2 * k + 1));
    let sum = (0..TERMS).rev().fold(Interval::ZERO, |sum, k| sum * square + reciprocal(k));
    x * sum + Interval::symmetric(x.powi(2 * TERMS + 1).mag())
}

/// Pi: `16 atan(1/5) - 4 atan(1/239)` (Machin 1706).
pub fn pi() -> Interval {
    let whole = |value: f64| Interval::point(value);
    let [first, second] = [5.0, 239.0].map(|value| atan_series(Interval::ONE / whole(value)));
    whole(16.0) * first - whole(4.0) * second
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn exponentials_and_arc_tangents_agree_with_libm(x in -30.0..30.0_f64) {
            // libm is within one unit
            let (exponential, angle) = (exp(Interval::point(x)), atan(Interval::point(x)));
            for (enclosure, value) in [(exponential, libm::exp(x)), (angle, libm::atan(x))] {
                let near = Interval::new(value.next_down(), value.next_up());
                prop_assert!(!near.meet(enclosure).is_unknown(), "{enclosure:?}, {value}");
                prop_assert!(enclosure.width() < 1e-12 * value.abs() + 1e-300, "{enclosure:?}"); // 1.5e-13
            }
            // exp(x) exp(-x) = 1, atan(x) + atan(1/x) = pi/2
            prop_assert!((exponential * exp(Interval::point(-x))).contains(1.0));
        }
    }

    #[test]
    fn known_values_are_contained() {
        let digits = pi();
        // pi is above the double nearest to it: an enclosure must reach beyond it
        assert!(digits.lo() <= std::f64::consts::PI && std::f64::consts::PI < digits.hi());
        assert!(digits.width() < 1e-14);
        let quarter = atan(Interval::ONE) * Interval::point(4.0);
        assert!(!quarter.meet(digits).is_unknown());
        // e is above the double nearest to it
        let e = exp(Interval::ONE);
        assert!(e.lo() <= std::f64::consts::E && std::f64::consts::E < e.hi() && e.width() < 1e-13);
        assert_eq!(exp(Interval::ZERO).mid(), 1.0);
        assert!(exp(Interval::point(800.0)).is_unknown() && atan(Interval::UNKNOWN).is_unknown());
    }
}
