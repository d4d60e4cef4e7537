//! Where series keep their sign: a step that stays on one branch of each root and power.
//!
//! Beyond a zero of `u` the series of `sqrt(u^2)` is that of `u`, no longer of `|u|`, and nothing in its terms tells. So a step
//! ends before the first zero of such a series, and the next one is so much shorter, until nothing of it is left.

use super::frame::Frame;
use super::program::Program;
use crate::lanes::Lane;
use crate::method::MAX_ORDER;

/// Longest step that is looked at, in units in which the terms beside the first are no larger than that.
const LONGEST: f64 = 1024.0;

/// A piece of a step shorter than this part of what comes before it is not looked at: it is the next step's affair.
const SHORTEST: f64 = 1.0 / 16.0;

/// The last two terms of a series whose zeros are looked for are at most this part of the first: it has to be the function still
/// where it vanishes. The steps of a solution that is a polynomial are not limited by its own terms.
const ACCURATE: f64 = 1e-3;

/// The part of the way to a zero that is taken: more than the error of its place is left.
const MARGIN: f64 = 0.875;

/// A step that is shortened to less than this part of the largest so far is none: the zero is here. Much closer to it a root of a difference,
/// such as `sqrt(1 - sin^2)`, has no digits left.
const NOTHING: f64 = 1.0 / 4_194_304.0;

/// Shortens the steps, one for each lane, on which one of the series of a program that must not vanish may do so, up to the order
/// of the frame. What lies behind, as the signs of the largest steps so far tell, does not matter.
#[inline(always)]
pub(super) fn keep<V: Lane>(program: &Program, frame: &Frame, work: &[V], largest: &[f64], steps: &mut [f64]) {
    let state = frame.state(program);
    for &series in &program.branches {
        let series = &state.series(work, series)[..=frame.k];
        let mut step = V::splat(0.0);
        for (lane, &longest) in steps.iter().enumerate() {
            step.set(lane, longest);
        }
        // odd powers of the step and even ones side by side: one chain would take twice as long
        let (square, (pairs, last)) = (step.mul(step), series[1..].as_chunks());
        let mut odd = last.first().map_or(V::splat(0.0), |coefficient| coefficient.abs());
        let mut even = V::splat(0.0);
        for [first, second] in pairs.iter().rev() {
            odd = odd.mul_add(square, first.abs());
            even = even.mul_add(square, second.abs());
        }
        let rest = even.mul_add(square, odd.mul(step));
        for (lane, longest) in steps.iter_mut().enumerate() {
            // of an infinite step the rest may be NaN
            let vanishes_nowhere = rest.get(lane) < series[0].get(lane).abs();
            if !vanishes_nowhere && *longest > 0.0 {
                *longest = shortened(*longest, largest[lane], series.len(), |k| series[k].get(lane));
            }
        }
    }
}

/// The longest step, at most `step`, on which a series of so many coefficients certainly keeps its sign, in the direction of the
/// largest step so far, or in both if there is none.
fn shortened(step: f64, largest: f64, count: usize, coefficient: impl Fn(usize) -> f64) -> f64 {
    let first = coefficient(0);
    let count = (1..count).take_while(|&k| coefficient(k).is_finite()).count() + 1;
    if !(first.is_finite() && first != 0.0) {
        return step;
    }
    // units of time, a power of two, in which all terms but the first add up to less than that: numbers far from overflow
    let allowed = libm::log2(first.abs()) - libm::log2(count as f64);
    let bound = |k: usize| (allowed - libm::log2(coefficient(k).abs())) / k as f64;
    let unit = (1..count).filter(|&k| coefficient(k) != 0.0).map(bound).fold(f64::INFINITY, f64::min);
    if unit == f64::INFINITY {
        return step;
    }
    let accurate = |k: usize| libm::exp2(libm::log2(ACCURATE * first.abs() / coefficient(k).abs()) / k as f64);
    let last = (count.saturating_sub(2).max(1)..count).filter(|&k| coefficient(k) != 0.0);
    let step = last.map(accurate).fold(step, f64::min);
    let (unit, size) = (unit.floor() as i32, libm::frexp(first).1);
    let length = libm::scalbn(step, -unit).min(LONGEST);
    let mut reached = f64::INFINITY;
    let directions = if largest == 0.0 { &[1.0, -1.0][..] } else { &[largest.signum()][..] };
    for direction in directions {
        let mut scaled = [0.0; MAX_ORDER + 1];
        let mut power = 1.0;
        for (k, to) in scaled[..count].iter_mut().enumerate() {
            *to = power * libm::scalbn(coefficient(k), k as i32 * unit - size);
            power *= direction;
        }
        reached = reach(&mut scaled[..count], length).min(reached);
    }
    if reached == length && length < LONGEST {
        return step;
    }
    let longest = libm::scalbn(if reached < length { MARGIN * reached } else { reached }, unit);
    if reached < length && longest < NOTHING * largest.abs() { 0.0 } else { longest }
}

/// How far from zero, at most to `length`, a polynomial keeps its sign: piece by piece, each so short that the first coefficient
/// outweighs the others there.
fn reach(c: &mut [f64], length: f64) -> f64 {
    let (mut at, mut piece) = (0.0, length);
    loop {
        piece = piece.min(length - at);
        while c[1..].iter().rev().fold(0.0, |rest, c| (rest + c.abs()) * piece) >= c[0].abs() {
            piece *= 0.5;
            if piece < SHORTEST * at {
                return at;
            }
        }
        if at + piece >= length {
            return length;
        }
        at += piece;
        for k in 0..c.len() {
            for j in (k..c.len() - 1).rev() {
                c[j] += piece * c[j + 1];
            }
        }
        piece *= 2.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(series: &[f64], step: f64) -> f64 {
        shortened(step, 0.0, series.len() + 2, |k| series.get(k).copied().unwrap_or(0.0))
    }

    #[test]
    fn a_step_ends_before_the_first_zero_ahead_or_behind() {
        // (1 - t/2)(1 + t/5)(1 - t/30), its mirror image, and both in other units
        let series = [1.0, -1.0 / 2.0 + 1.0 / 5.0 - 1.0 / 30.0, -1.0 / 10.0 + 1.0 / 60.0 - 1.0 / 150.0, 1.0 / 300.0];
        for (sign, exponent) in [(1.0, 0), (-1.0, 0), (1.0, 200), (-1.0, -200)] {
            let mut power = 1.0;
            let unit = libm::scalbn(1.0, exponent);
            let series = series.map(|c| {
                let c = c * power;
                power *= sign / unit;
                c
            });
            for step in [0.1, 1.0, 1.5, 1.8] {
                assert_eq!(of(&series, step * unit), step * unit);
            }
            for step in [2.0, 2.1, 6.0, 1e6] {
                let shortened = of(&series, step * unit) / unit;
                assert!((1.3..2.0).contains(&shortened), "{step}: {shortened}");
                let ahead =
                    super::shortened(step * unit, sign * unit, 6, |k| series.get(k).copied().unwrap_or(0.0)) / unit;
                let behind =
                    super::shortened(step * unit, -sign * unit, 6, |k| series.get(k).copied().unwrap_or(0.0)) / unit;
                let until_next = step.min(5.0);
                assert!((1.3..2.0).contains(&ahead), "{step}: {ahead}");
                assert!((0.6 * until_next..=until_next).contains(&behind), "{step}: {behind}");
            }
        }
    }

    #[test]
    fn series_without_a_zero_leave_the_step_as_it_is() {
        // 2 + cos t up to t = 6, 1 + t^2, and constants
        let mut cosine = [0.0; 31];
        let mut term = 1.0;
        for k in 0..=15 {
            cosine[2 * k] = term;
            term /= -(((2 * k + 1) * (2 * k + 2)) as f64);
        }
        cosine[0] += 2.0;
        assert_eq!(of(&cosine, 6.0), 6.0);
        assert_eq!(of(&[1.0, 0.0, 1.0], 20.0), 20.0);
        assert_eq!((of(&[1.0, 0.0, 0.0], 1e300), of(&[-3.0], 1.0)), (1e300, 1.0));
    }

    #[test]
    fn steps_accumulate_at_a_multiple_zero() {
        // (1 - t)^6 about the end of each step
        let mut distance = 1.0_f64;
        for _ in 0..100 {
            let mut series = [1.0, -6.0, 15.0, -20.0, 15.0, -6.0, 1.0];
            let mut power = distance.powi(6);
            for c in &mut series {
                *c *= power;
                power /= distance;
            }
            let step = of(&series, 10.0);
            assert!(step < distance && step > 0.25 * distance, "{step} of {distance}");
            distance -= step;
        }
        assert!(distance < 1e-9);
        // a simple zero, as close as that, ends it in the direction in which it lies
        let step = |sign| shortened(1.0, sign, 4, |k| [1e-8, -1.0, 0.0, 0.0][k]);
        assert_eq!(step(1.0), 0.0);
        assert!(step(-1.0) > 1e-6);
        assert!(step(0.0) > 0.5e-8);
    }
}
