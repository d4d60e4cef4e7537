//! The map from a chart on one section to a chart on another, along the flow, with its derivative.
//!
//! With `P` the map along the flow, `q'(q) = L (P(chi(q)) - c')` and `L` the rows of the inverse of the frame that is
//! reached. By the mean value theorem, `m` a double near `chi(q_0)`,
//! ```text
//! q'(q_0) in  L (P(m) - c') + L DP (chi(q_0) - m),
//! q'(q)   in  q'(q_0) + R (q - q_0),   R contains  L DP(chi(q)) (B_q + B_w dw/dq)  for all q of the box.
//! ```
//! The orbit of `m` alone is followed without the others. So where the values of the constants are uncertain, what that does
//! to `q'` is a linear form of these few numbers, and not of the sides of a box.

use super::chart::Frame;
use super::failure::Failure;
use super::flow::{Bundle, Flow, Tube};
use super::interval::Interval;
use super::lohner::StateSet;
use super::matrix::{IntervalVector, Matrix, combine, points};
use super::program::Program;
use super::section::cross;
use crate::ensemble::Control;

/// The constants of motion, the level on which orbits are followed, and how far charts reach.
#[derive(Clone, Debug)]
pub struct Level {
    /// The constants of motion.
    pub constants: Program,
    /// Their values; what is proved holds for every value within.
    pub values: IntervalVector,
    /// Greatest absolute value of the coordinates `w`.
    pub reach: f64,
}

/// What is known of the map from section to section on a box.
#[derive(Clone, Debug)]
pub struct Passage {
    /// Image of `q_0`.
    pub offset: IntervalVector,
    /// Derivatives on the whole box.
    pub derivative: Matrix<Interval>,
    /// Coordinates `w` of the image of the box.
    pub w: IntervalVector,
    /// Flight times of all orbits.
    pub time: Interval,
    /// The times within which every orbit crosses exactly once.
    pub window: Interval,
    /// Rate of change of the coordinate of the flow where orbits cross, and around.
    pub rate: Interval,
    /// Where the orbits are during the flight.
    pub tubes: Vec<Tube>,
}

impl Passage {
    /// A box that contains the image of the box `q` around `q_0`.
    pub fn image(&self, q: &[Interval], q_0: &[Interval]) -> IntervalVector {
        let moved = self.derivative.apply(&combine(q, q_0, |q, q_0| q - q_0));
        combine(&self.offset, &moved, |offset, moved| offset + moved)
    }
}

/// Follows the orbits that start at `q`, which contains `q_0`, for about `time`, up to the section of another frame.
///
/// # Errors
/// A chart, an enclosure of the flow, or the crossing is not certain.
#[allow(clippy::too_many_arguments)] // from where, to where, how long
pub fn pass(
    flow: &mut Flow,
    level: &Level,
    (from, q, q_0): (&Frame, &[Interval], &[f64]),
    to: &Frame,
    time: f64,
    control: &Control,
) -> Result<Passage, Failure> {
    let lift = |q: &[Interval]| from.lift(&level.constants, &level.values, q, level.reach);
    let (whole, small) = (lift(q)?, lift(&points(q_0))?);
    // both from one point m, whose orbit is followed by itself: what follows is mean values between m and the others
    let (center, extent) = from.described(&whole, &small);
    let first_extent = from.described(&small, &small).1;
    let frame = from.columns_and_identity();
    let with_center = extent.iter().map(|entry| entry.hull(Interval::ZERO)).collect();
    let point = StateSet::new(&center, Matrix::from_fn(center.len(), 0, |_, _| 0.0), vec![]);
    let states = vec![StateSet::new(&center, frame.clone(), with_center), point];
    let mut bundle = Bundle::new(states, frame);
    let mut tubes = vec![];
    flow.advance(&mut bundle, time, control, |tube| tubes.push(tube.clone()))?;

    let (field, section) = (flow.field().clone(), to.section());
    let crossing = cross(flow, &bundle.states[0], &section)?;
    let first = cross(flow, &bundle.states[1], &section)?.within(&crossing)?.of_small_set(flow, &bundle.states[1])?;
    let reached = to.relative(&first);
    let along = crossing.derivative(&field, &section).times(&bundle.derivative.hull());
    let to_q = to.to_directions().times(&along);
    let to_w = to.to_constants().times(&along);
    let offset = combine(&to.to_directions().apply(&reached), &to_q.apply(&first_extent), |a, b| a + b);
    let w = combine(&to.to_constants().apply(&reached), &to_w.apply(&extent), |a, b| a + b);
    let (by_q, by_w) = from.split(&to_q);
    let derivative = by_q.plus(&by_w.times(&whole.slope));
    // then the point with these coordinates is the point of the chart: there is only one within its reach
    if !w.iter().all(|w| w.is_within(Interval::symmetric(level.reach))) {
        return Err(Failure::OutsideChart);
    }
    let duration = Interval::point(time);
    tubes.push(Tube { time: duration + crossing.window, states: crossing.tube });
    Ok(Passage {
        offset,
        derivative,
        w,
        time: duration + crossing.delay,
        window: duration + crossing.window,
        rate: crossing.rate,
        tubes,
    })
}
