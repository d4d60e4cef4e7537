//! Where orbits cross a section, when, and the derivative of the map that takes them there.
//!
//! After a flight the orbits of a set are near the section `s = 0`. On a box that contains them for all times of a window
//! `[-d, d]`, `g = grad s . f` keeps its sign. By the mean value theorem an orbit that is at `x` crosses at a time of
//! `-s(x) / g`, and if that is within the window it does so exactly once there. With `y` the crossing,
//! ```text
//! P(x) = phi_tau(x)(x),   DP = (I - f(y) grad s(y)^T / g(y)) D phi_tau .
//! ```

use super::apriori;
use super::failure::Failure;
use super::flow::{Bundle, Flow};
use super::interval::Interval;
use super::lohner::StateSet;
use super::matrix::{IntervalVector, Matrix, combine, dot, hull, meet, points};
use super::program::Program;
use crate::ensemble::Control;

/// A surface `s = 0`.
#[derive(Clone, Debug)]
pub enum Section {
    /// `normal . (x - through) = 0`, a hyperplane. The bounds of the normal contain those of the one that is meant.
    Affine {
        /// The gradient.
        normal: IntervalVector,
        /// A point on it.
        through: Vec<f64>,
    },
    /// The zeros of the one polynomial of a program.
    Polynomial(Program),
}

impl Section {
    fn value(&self, at: &[Interval]) -> Interval {
        match self {
            Section::Affine { normal, through } => dot(normal, &combine(at, &points(through), |x, p| x - p)),
            Section::Polynomial(function) => function.values(at)[0],
        }
    }

    fn gradient(&self, at: &[Interval]) -> IntervalVector {
        match self {
            Section::Affine { normal, .. } => normal.clone(),
            Section::Polynomial(function) => function.jacobian(at).row(0).to_vec(),
        }
    }

    /// The rate of change along the field, on a box.
    pub fn rate(&self, field: &Program, at: &[Interval]) -> Interval {
        dot(&self.gradient(at), &field.values(at))
    }
}

/// The crossings of all orbits of a set.
#[derive(Clone, Debug)]
pub struct Crossing {
    /// Times of crossing, counted from the set.
    pub delay: Interval,
    /// The times within which each orbit crosses exactly once.
    pub window: Interval,
    /// Rate of change of `s` along the orbits within the window.
    pub rate: Interval,
    /// A box that contains the orbits within the window.
    pub tube: IntervalVector,
    /// A box that contains the crossings.
    pub states: IntervalVector,
    /// The derivatives of the flow from the set to the crossing, for a fixed time.
    pub transport: Matrix<Interval>,
}

/// Lets the orbits of a set cross a section that they are near to.
///
/// # Errors
/// It is not sure that each crosses exactly once within a window of time around the present.
pub fn cross(flow: &mut Flow, set: &StateSet, section: &Section) -> Result<Crossing, Failure> {
    let field = flow.field().clone();
    let start = hull(&set.hull(), &points(set.center()));
    let range = set.range(section.value(&points(set.center())), &section.gradient(&start));
    let guess = range / section.rate(&field, &start);
    let reach = 2.0 * guess.mag() + 1e-14;
    let window = Interval::symmetric(reach);
    let tube = apriori::states(&field, &start, window).ok_or(Failure::NoCrossing)?;
    let rate = section.rate(&field, &tube);
    let mut delay = -range / rate;
    if !delay.is_inside(window) {
        return Err(Failure::NoCrossing);
    }
    // the orbits up to their crossings stay in a smaller box, which says more about when they cross
    let mut path = tube.clone();
    for _ in 0..2 {
        path =
            apriori::states(&field, &start, delay.hull(Interval::ZERO)).map_or(path.clone(), |box_| meet(&path, &box_));
        delay = delay.meet(-range / section.rate(&field, &path));
    }
    let rates = field.values(&path);
    let direct: IntervalVector = (0..start.len()).map(|i| start[i] + delay * rates[i]).collect();
    let states = meet(&path, &direct);
    let jacobian = field.jacobian(&path);
    let meanwhile = apriori::derivatives(&jacobian, delay.hull(Interval::ZERO));
    let change = jacobian.times(&meanwhile);
    let unit = Matrix::identity(start.len()).enclosed();
    let transport = Matrix::from_fn(start.len(), start.len(), |i, j| unit[(i, j)] + delay * change[(i, j)]);
    if delay.is_unknown() || super::matrix::is_unknown(&states) || transport.is_unknown() {
        return Err(Failure::NoCrossing);
    }
    Ok(Crossing { delay, window, rate, tube, states, transport })
}

impl Crossing {
    /// The crossing, if it is the one of a set that these orbits are a part of: within its window each of them crosses once.
    ///
    /// # Errors
    /// It may be another one.
    pub fn within(self, whole: &Crossing) -> Result<Crossing, Failure> {
        if self.delay.is_within(whole.window) { Ok(self) } else { Err(Failure::NoCrossing) }
    }

    /// Matrices that contain the projections along the field onto the tangent spaces of the section, times the transport.
    pub fn derivative(&self, field: &Program, section: &Section) -> Matrix<Interval> {
        let rates = field.values(&self.states);
        let gradient = section.gradient(&self.states);
        let speed = dot(&gradient, &rates);
        let n = rates.len();
        let projection = Matrix::from_fn(n, n, |i, j| {
            let unit = if i == j { Interval::ONE } else { Interval::ZERO };
            unit - rates[i] * gradient[j] / speed
        });
        projection.times(&self.transport)
    }

    /// The crossings themselves, from a small set: its box is moved by the series of its solutions.
    pub fn of_small_set(&self, flow: &mut Flow, set: &StateSet) -> Result<IntervalVector, Failure> {
        let moved = flow.image(&set.hull(), self.delay).ok_or(Failure::NoCrossing)?;
        Ok(meet(&moved, &self.states))
    }
}

/// The map of a set of states to a section, with its derivative.
#[derive(Clone, Debug)]
pub struct SectionMap {
    /// Flight times.
    pub time: Interval,
    /// A box that contains the crossings.
    pub states: IntervalVector,
    /// The derivative by the state, for all states of the set.
    pub derivative: Matrix<Interval>,
    /// The crossing itself.
    pub crossing: Crossing,
}

/// Follows `center + frame box` for about `time`, up to a section: the image of the center and, by the mean value theorem,
/// of the others.
///
/// # Errors
/// No enclosure of the flow, or it is not sure that every orbit crosses once, near that time.
pub fn section_map(
    flow: &mut Flow,
    (center, frame, coordinates): (&[f64], &Matrix<f64>, &[Interval]),
    section: &Section,
    time: f64,
    control: &Control,
) -> Result<SectionMap, Failure> {
    let n = center.len();
    let with_center: IntervalVector = coordinates.iter().map(|entry| entry.hull(Interval::ZERO)).collect();
    let whole = StateSet::new(center, frame.clone(), with_center);
    let point = StateSet::new(center, Matrix::from_fn(n, 0, |_, _| 0.0), vec![]);
    let mut bundle = Bundle::new(vec![whole, point], Matrix::identity(n));
    flow.advance(&mut bundle, time, control, |_| ())?;
    let crossing = cross(flow, &bundle.states[0], section)?;
    let first = cross(flow, &bundle.states[1], section)?.within(&crossing)?.of_small_set(flow, &bundle.states[1])?;
    let derivative = crossing.derivative(flow.field(), section).times(&bundle.derivative.hull());
    let moved = derivative.times(&frame.enclosed()).apply(coordinates);
    let states = meet(&crossing.states, &combine(&first, &moved, |first, moved| first + moved));
    Ok(SectionMap { time: Interval::point(time) + crossing.delay, states, derivative, crossing })
}
