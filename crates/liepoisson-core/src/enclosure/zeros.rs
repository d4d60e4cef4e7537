//! All zeros of a square system of polynomials in a box: each is proved to be there and to be the only one near it.
//!
//! Krawczyk's operator `K = m - Y F(m) + (I - Y DF(X)) (X - m)` contains all zeros in the box `X`. If `K` and `X` have nothing
//! in common there is none; if `K` is inside `X` there is exactly one. Otherwise `X` is replaced by what both have in common,
//! or cut in two. Boxes that become tiny without an answer are returned: zeros may be there, or on a curve through them.
//!
//! # References
//! - A. Neumaier, *Interval Methods for Systems of Equations*, 1990, chapter 5.

use super::failure::Failure;
use super::interval::Interval;
use super::linear::approximate_inverse;
use super::matrix::{IntervalVector, Matrix, combine, is_inside, is_unknown, is_within, meet, mid, points};
use super::program::Program;
use crate::ensemble::Control;

/// The zeros in a box.
#[derive(Clone, Debug, Default)]
pub struct Zeros {
    /// Narrow boxes, each with exactly one zero.
    pub boxes: Vec<IntervalVector>,
    /// The boxes in which these are the only ones.
    pub unique_within: Vec<IntervalVector>,
    /// Boxes of which nothing is known. Outside these and the others there is no zero.
    pub undecided: Vec<IntervalVector>,
}

enum Verdict {
    None,
    /// A narrow box, and that in which its zero is the only one.
    One(IntervalVector, IntervalVector),
    Within(IntervalVector),
    Undecided,
}

/// The zeros of a system within `region`, by looking at no more than `max_boxes` boxes; the others are undecided.
///
/// # Errors
/// The wish of the caller to end; a region of which a component is not known.
///
/// # Panics
/// If there are not as many polynomials as variables and components of the region.
pub fn zeros(system: &Program, region: &[Interval], max_boxes: usize, control: &Control) -> Result<Zeros, Failure> {
    assert!(system.n_rows() == region.len() && system.n_variables() == region.len(), "a square system");
    if is_unknown(region) {
        return Err(Failure::NotContracted);
    }
    let mut found = Zeros::default();
    let mut waiting = vec![region.to_vec()];
    let mut n_boxes = 0;
    while let Some(next) = waiting.pop() {
        if control.look_at_clock().is_some() {
            return Err(Failure::Stopped);
        }
        n_boxes += 1;
        if n_boxes > max_boxes {
            found.undecided.push(next);
            continue;
        }
        let (box_, is_smaller) = match newton(system, &next) {
            Verdict::None => continue,
            Verdict::One(zero, around) => {
                keep(&mut found, zero, around);
                continue;
            }
            Verdict::Within(part) => {
                let is_smaller = total_width(&part) < 0.7 * total_width(&next);
                (part, is_smaller)
            }
            Verdict::Undecided => (next, false),
        };
        if is_smaller {
            waiting.push(box_);
            continue;
        }
        match halves(&box_) {
            Some(halves) => waiting.extend(halves),
            // a zero on the boundary of two boxes is inside a box that is a little larger
            None => match newton(system, &inflated(&box_)) {
                Verdict::None => (),
                Verdict::One(zero, around) if is_within(&zero, region) => keep(&mut found, zero, around),
                _ => found.undecided.push(box_),
            },
        }
    }
    Ok(found)
}

/// Keeps a zero, unless it is one that was found from the box beside it.
fn keep(found: &mut Zeros, zero: IntervalVector, around: IntervalVector) {
    if found.unique_within.iter().any(|known| is_within(&zero, known)) {
        return;
    }
    if found.boxes.iter().any(|known| !is_unknown(&meet(known, &zero))) {
        return found.undecided.push(zero);
    }
    found.boxes.push(zero);
    found.unique_within.push(around);
}

fn total_width(box_: &[Interval]) -> f64 {
    box_.iter().map(|component| component.width()).sum()
}

fn inflated(box_: &[Interval]) -> IntervalVector {
    let wider = |component: &Interval| {
        *component + Interval::symmetric(10.0 * component.width() + 1e-14 * component.mag() + f64::MIN_POSITIVE)
    };
    box_.iter().map(wider).collect()
}

/// The box cut across its widest side; none if that is too narrow already.
fn halves(box_: &[Interval]) -> Option<[IntervalVector; 2]> {
    let widest = (0..box_.len()).fold(0, |best, i| if box_[i].width() > box_[best].width() { i } else { best });
    let side = box_[widest];
    if side.width() <= 1e-10 * side.mag().max(1e-6) {
        return None;
    }
    let mut parts = [box_.to_vec(), box_.to_vec()];
    // not in the middle, where zeros of symmetric systems like to be
    let cut = side.lo() + 0.4873 * (side.hi() - side.lo());
    parts[0][widest] = Interval::new(side.lo(), cut);
    parts[1][widest] = Interval::new(cut, side.hi());
    Some(parts)
}

/// Krawczyk's operator; none if there is no approximate inverse.
fn operator(system: &Program, box_: &[Interval]) -> Option<IntervalVector> {
    let (middle, jacobian) = (points(&mid(box_)), system.jacobian(box_));
    let inverse = approximate_inverse(&jacobian.mid())?.enclosed();
    let rest = Matrix::identity(box_.len()).enclosed().minus(&inverse.times(&jacobian));
    let extent = combine(box_, &middle, |box_, middle| box_ - middle);
    let step = combine(&rest.apply(&extent), &inverse.apply(&system.values(&middle)), |rest, newton| rest - newton);
    let image = combine(&middle, &step, |middle, step| middle + step);
    (!is_unknown(&image)).then_some(image)
}

fn newton(system: &Program, box_: &[Interval]) -> Verdict {
    if system.values(box_).iter().any(|value| !value.is_unknown() && !value.contains(0.0)) {
        return Verdict::None;
    }
    let Some(image) = operator(system, box_) else { return Verdict::Undecided };
    let common = meet(&image, box_);
    if is_unknown(&common) {
        Verdict::None
    } else if is_inside(&image, box_) {
        Verdict::One(narrowed(system, common), box_.to_vec())
    } else {
        Verdict::Within(common)
    }
}

/// The box of exactly one zero, as narrow as the operator makes it.
fn narrowed(system: &Program, zero: IntervalVector) -> IntervalVector {
    let mut zero = zero;
    for _ in 0..20 {
        let Some(image) = operator(system, &zero) else { break };
        let next = meet(&image, &zero);
        if is_unknown(&next) || total_width(&next) >= 0.9 * total_width(&zero) {
            break;
        }
        zero = next;
    }
    zero
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::enclosure::polynomial::Polynomial;
    use crate::enclosure::rational::Rational;

    fn system(n: usize, rows: &[&[(i64, &[usize])]]) -> Program {
        let row = |terms: &&[(i64, &[usize])]| {
            let terms = terms.iter().map(|&(c, factors)| (Rational::integer(c), factors.to_vec()));
            Polynomial::new(n, terms).unwrap()
        };
        Program::new(n, &rows.iter().map(row).collect::<Vec<_>>())
    }

    #[test]
    fn all_zeros_of_two_curves_are_found() {
        // x^2 + y^2 = 25, x y = 12
        let curves = system(2, &[&[(1, &[0, 0]), (1, &[1, 1]), (-25, &[])], &[(1, &[0, 1]), (-12, &[])]]);
        let region = [Interval::symmetric(10.0), Interval::symmetric(10.0)];
        let found = zeros(&curves, &region, 10_000, &Control::default()).unwrap();
        assert!(found.undecided.is_empty() && found.boxes.len() == 4, "{found:?}");
        for exact in [[3.0, 4.0], [4.0, 3.0], [-3.0, -4.0], [-4.0, -3.0]] {
            let contains = |zero: &&IntervalVector| zero[0].contains(exact[0]) && zero[1].contains(exact[1]);
            let zero = found.boxes.iter().find(contains).unwrap();
            assert!(zero.iter().all(|component| component.width() < 1e-13), "{zero:?}");
        }
    }

    #[test]
    fn zeros_that_are_not_simple_stay_undecided() {
        let double = system(1, &[&[(1, &[0, 0])]]);
        let found = zeros(&double, &[Interval::new(-1.0, 2.0)], 1000, &Control::default()).unwrap();
        assert!(found.boxes.is_empty() && found.undecided.iter().any(|box_| box_[0].contains(0.0)), "{found:?}");
        let none = system(1, &[&[(1, &[0, 0]), (1, &[])]]);
        let found = zeros(&none, &[Interval::new(-1.0, 2.0)], 1000, &Control::default()).unwrap();
        assert!(found.boxes.is_empty() && found.undecided.is_empty());
    }

    #[test]
    fn a_zero_on_a_cut_is_found_once() {
        let line = system(1, &[&[(1, &[0])]]);
        let region = Interval::new(-0.4873, 1.0 - 0.4873);
        let found = zeros(&line, &[region], 1000, &Control::default()).unwrap();
        assert_eq!((found.boxes.len(), found.undecided.len()), (1, 0), "{found:?}");
    }
}
