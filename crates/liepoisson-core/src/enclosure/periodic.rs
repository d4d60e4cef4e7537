//! Periodic orbits through several sections, by Krawczyk's operator for all of the sections at once.
//!
//! With `P_i` the map from section `i` to the next, `F_i(q) = q_{i+1} - P_i(q_i)`, cyclically. If
//! ```text
//! K = m - Y F(m) + (I - Y DF(Q)) (Q - m)
//! ```
//! is inside the box `Q`, there is exactly one zero of `F` in `Q`, hence exactly one periodic orbit that crosses the sections
//! within `Q` and in times within the windows of the passages. Shooting between several sections keeps the derivatives small.
//!
//! # References
//! - R. Krawczyk, *Newton-Algorithmen zur Bestimmung von Nullstellen mit Fehlerschranken*, Computing 4 (1969) 187.
//! - Z. Galias, *Interval methods for rigorous investigations of periodic orbits*, Int. J. Bifurcation Chaos 11 (2001) 2427.

use super::chart::Frame;
use super::failure::Failure;
use super::flow::Flow;
use super::interval::Interval;
use super::linear::approximate_inverse;
use super::matrix::{IntervalVector, Matrix, combine, is_inside, mid, points};
use super::passage::{Level, Passage, pass};
use crate::ensemble::Control;

/// One leg of a closed chain: from a frame to the next, which may be the image of the first one under a reflection.
#[derive(Clone, Debug)]
pub struct Leg {
    /// Where it starts.
    pub from: Frame,
    /// The frame that the end is expressed in.
    pub to: Frame,
    /// The time, about.
    pub time: f64,
}

/// A periodic orbit (perhaps modulo a reflection) that was proved to exist and to be the only one in its boxes.
#[derive(Clone, Debug)]
pub struct PeriodicOrbit {
    /// Where it crosses each section, in its chart.
    pub q: Vec<IntervalVector>,
    /// The same points as states.
    pub states: Vec<IntervalVector>,
    /// The box in which it is the only one.
    pub unique_within: Vec<IntervalVector>,
    /// The passages on the narrow boxes.
    pub passages: Vec<Passage>,
}

impl PeriodicOrbit {
    /// The derivative of the map around the orbit, in the chart of the first section.
    pub fn derivative(&self) -> Matrix<Interval> {
        let derivatives = self.passages.iter().map(|passage| passage.derivative.clone());
        derivatives.reduce(|product, next| next.times(&product)).expect("a chain has a leg")
    }

    /// The period.
    pub fn period(&self) -> Interval {
        self.passages.iter().fold(Interval::ZERO, |sum, passage| sum + passage.time)
    }
}

/// Newton steps in doubles before the proof.
const NEWTON_STEPS: usize = 4;
/// How often boxes are tried.
const TRIALS: usize = 8;

/// Finds the periodic orbit near `guess` (coordinates in each chart) and proves that it is there.
///
/// # Errors
/// A passage is not certain, or no box is mapped into itself.
///
/// # Panics
/// If there is no leg.
pub fn periodic_orbit(
    flow: &mut Flow,
    level: &Level,
    legs: &[Leg],
    guess: Vec<Vec<f64>>,
    control: &Control,
) -> Result<PeriodicOrbit, Failure> {
    assert!(!legs.is_empty() && legs.len() == guess.len(), "a guess for each leg");
    let mut chain = Chain { flow, level, legs, control };
    let mut middle = guess;
    let mut step = f64::INFINITY;
    for _ in 0..NEWTON_STEPS {
        let passages = chain.passages(&around(&middle, 1e-9), &middle)?;
        let newton = chain.newton(&passages, &middle).ok_or(Failure::Singular)?;
        step = newton.iter().map(|entry| entry.mag()).fold(0.0, f64::max);
        let m = middle[0].len();
        for (i, values) in middle.iter_mut().enumerate() {
            values.iter_mut().enumerate().for_each(|(j, value)| *value += newton[i * m + j].mid());
        }
        if middle.iter().flatten().any(|value| !value.is_finite()) {
            return Err(Failure::NotContracted);
        }
        let scale = middle.iter().flatten().fold(1e-300, |size: f64, value| size.max(value.abs()));
        if step < 1e-8 * scale {
            break;
        }
    }
    // the last step was small, so that its size is that of what is uncertain
    let mut radius = 0.25 * step.max(f64::MIN_POSITIVE);
    for _ in 0..TRIALS {
        radius *= 4.0;
        let boxes = around(&middle, radius);
        let passages = match chain.passages(&boxes, &middle) {
            Ok(passages) => passages,
            Err(Failure::Stopped) => return Err(Failure::Stopped),
            Err(_) => continue, // a larger box cannot help, but the number of trials is small
        };
        let Some(image) = chain.krawczyk(&passages, &boxes, &middle) else { continue };
        if image.iter().zip(&boxes).all(|(image, box_)| is_inside(image, box_)) {
            return chain.narrowed(image, boxes, &middle);
        }
        let reached = image.iter().flatten().zip(middle.iter().flatten());
        let needed = reached.map(|(image, middle)| (*image - Interval::point(*middle)).mag()).fold(0.0, f64::max);
        if needed.is_finite() && needed > radius {
            radius = 0.5 * needed;
        }
    }
    Err(Failure::NotContracted)
}

/// Boxes around the middles.
fn around(middle: &[Vec<f64>], radius: f64) -> Vec<IntervalVector> {
    middle.iter().map(|values| values.iter().map(|&value| Interval::ball(value, radius)).collect()).collect()
}

struct Chain<'c> {
    flow: &'c mut Flow,
    level: &'c Level,
    legs: &'c [Leg],
    control: &'c Control,
}

impl Chain<'_> {
    fn passages(&mut self, boxes: &[IntervalVector], middle: &[Vec<f64>]) -> Result<Vec<Passage>, Failure> {
        let legs = self.legs.iter().zip(boxes.iter().zip(middle));
        legs.map(|(leg, (q, q_0))| pass(self.flow, self.level, (&leg.from, q, q_0), &leg.to, leg.time, self.control))
            .collect()
    }

    /// The derivative of `F` on the boxes.
    fn jacobian(&self, passages: &[Passage]) -> Matrix<Interval> {
        let (count, m) = (passages.len(), passages[0].offset.len());
        let mut jacobian = Matrix::from_fn(count * m, count * m, |_, _| Interval::ZERO);
        for (i, passage) in passages.iter().enumerate() {
            let next = (i + 1) % count;
            for row in 0..m {
                jacobian[(i * m + row, next * m + row)] += Interval::ONE;
                for column in 0..m {
                    jacobian[(i * m + row, i * m + column)] -= passage.derivative[(row, column)];
                }
            }
        }
        jacobian
    }

    /// `F` at the middles.
    fn defect(&self, passages: &[Passage], middle: &[Vec<f64>]) -> IntervalVector {
        let count = passages.len();
        let legs = passages.iter().enumerate();
        legs.flat_map(|(i, passage)| combine(&points(&middle[(i + 1) % count]), &passage.offset, |q, image| q - image))
            .collect()
    }

    /// The step of Newton's method in doubles.
    fn newton(&self, passages: &[Passage], middle: &[Vec<f64>]) -> Option<IntervalVector> {
        let inverse = approximate_inverse(&self.jacobian(passages).mid())?.enclosed();
        Some(inverse.apply(&points(&mid(&self.defect(passages, middle)))).iter().map(|&entry| -entry).collect())
    }

    fn krawczyk(
        &self,
        passages: &[Passage],
        boxes: &[IntervalVector],
        middle: &[Vec<f64>],
    ) -> Option<Vec<IntervalVector>> {
        let jacobian = self.jacobian(passages);
        let inverse = approximate_inverse(&jacobian.mid())?.enclosed();
        let rest = Matrix::identity(jacobian.n_rows()).enclosed().minus(&inverse.times(&jacobian));
        let middle = points(&middle.concat());
        let extent = combine(&boxes.concat(), &middle, |box_, middle| box_ - middle);
        let newton = inverse.apply(&self.defect(passages, &mid_of(&middle, boxes)));
        let moved = combine(&rest.apply(&extent), &newton, |rest, newton| rest - newton);
        let image = combine(&middle, &moved, |middle, moved| middle + moved);
        Some(image.chunks(boxes[0].len()).map(<[Interval]>::to_vec).collect())
    }

    /// The orbit, with passages of the narrow boxes.
    fn narrowed(
        &mut self,
        image: Vec<IntervalVector>,
        unique_within: Vec<IntervalVector>,
        middle: &[Vec<f64>],
    ) -> Result<PeriodicOrbit, Failure> {
        let q = image;
        let passages = self.passages(&hulls(&q, middle), middle)?;
        let lift = |(leg, q): (&Leg, &IntervalVector)| {
            leg.from.lift(&self.level.constants, &self.level.values, q, self.level.reach).map(|lift| lift.states)
        };
        let states = self.legs.iter().zip(&q).map(lift).collect::<Result<_, _>>()?;
        Ok(PeriodicOrbit { q, states, unique_within, passages })
    }
}

fn mid_of(middle: &[Interval], boxes: &[IntervalVector]) -> Vec<Vec<f64>> {
    mid(middle).chunks(boxes[0].len()).map(<[f64]>::to_vec).collect()
}

/// The boxes with their middles, from which mean values are taken.
fn hulls(boxes: &[IntervalVector], middle: &[Vec<f64>]) -> Vec<IntervalVector> {
    boxes.iter().zip(middle).map(|(box_, middle)| combine(box_, &points(middle), Interval::hull)).collect()
}
