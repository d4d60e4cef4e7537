//! The middle set of the excursion is apart from everything else that orbits of the graph may meet at that time.
//!
//! Let an orbit have two codes, words in the two loops, that differ to the right for the first time at a visit of the first
//! set. By one of them it is in the middle set M at a time in `[t_M]` after it. By the other it has gone around the short
//! loop at least once before it began an excursion, so that it is near the periodic orbit, or on the excursion at a time
//! that is earlier, relative to its own passage of M, by at least `T_1 - width[t_M]`, up to the symmetry. If M is apart from
//! the tubes of all of these, the orbit has one code. The same holds to the left, with times from M to the end. The bound of
//! the entropy asks for a little more: three times the time that is left out must be short against the loops.

use super::graph::Loop;
use super::{Check, Place, Refusal};
use crate::enclosure::interval::Interval;
use crate::enclosure::matrix::IntervalVector;
use crate::enclosure::passage::Passage;
use crate::enclosure::polynomial::Sign;

/// Lower bounds of distances of the middle set, in the largest component; all positive.
#[derive(Clone, Copy, Debug)]
pub struct Distances {
    /// Number of the middle set.
    pub middle: usize,
    /// To the tube of the periodic orbit and its image under the symmetry.
    pub to_orbit: f64,
    /// To the tube of the excursion at times that differ by more than the time that was given.
    pub to_excursion: f64,
    /// To the image of the whole excursion under the symmetry.
    pub to_image: f64,
}

/// What the separation is computed from.
pub(super) struct Paths<'p> {
    pub(super) loops: &'p [Loop; 2],
    /// For each edge.
    pub(super) passages: &'p [Passage],
    /// Number of the middle set, and its place in the excursion: so many edges lead to it.
    pub(super) middle: (usize, usize),
    /// A box that contains it.
    pub(super) states: &'p [Interval],
    pub(super) symmetry: &'p [Sign],
    pub(super) near: f64,
}

/// The greatest distance of two boxes in one component, from below.
fn distance(a: &[Interval], b: &[Interval]) -> f64 {
    let apart = |a: &Interval, b: &Interval| {
        let gap = *a - *b;
        if gap.is_unknown() { f64::NAN } else { gap.mig() }
    };
    let gaps = a.iter().zip(b).map(|(a, b)| apart(a, b));
    gaps.fold(0.0, |most: f64, gap| if gap.is_nan() || most.is_nan() { f64::NAN } else { most.max(gap) })
}

fn least(values: impl Iterator<Item = f64>) -> f64 {
    let lesser = |a: f64, b: f64| if a.is_nan() || b.is_nan() { f64::NAN } else { a.min(b) };
    values.fold(f64::INFINITY, lesser)
}

fn total<'p>(passages: impl Iterator<Item = &'p Passage>) -> Interval {
    passages.fold(Interval::ZERO, |sum, passage| sum + passage.time)
}

impl Paths<'_> {
    fn along(&self, which: usize) -> Vec<&Passage> {
        self.loops[which].iter().map(|&edge| &self.passages[edge]).collect()
    }

    fn image(&self, states: &[Interval]) -> IntervalVector {
        states.iter().zip(self.symmetry).map(|(&state, sign)| sign.of(state)).collect()
    }

    /// The three distances.
    ///
    /// # Errors
    /// One is not positive, or the time that was given is not short against the loops.
    pub(super) fn distances(&self) -> Result<Distances, Refusal> {
        let (set, place) = self.middle;
        let refused = |wanted, value: f64| Refusal::new(Check::Separation, Place::Set(set), wanted).with_value(value);
        let (orbit, excursion) = (self.along(0), self.along(1));
        let (before, after) = excursion.split_at(place);

        // another passage of M is at least one turn around the short loop away, less what the flight times vary; for the
        // entropy the number of turns between two passages must follow from the time between them
        let near = Interval::point(self.near);
        let turn = total(orbit.iter().copied());
        let flights = [before, after].map(|flight| total(flight.iter().copied()));
        let widths = Interval::point(flights[0].width()) + Interval::point(flights[1].width());
        let spare = turn - widths - near - near - near;
        let between = flights[0] + flights[1] - widths - near - near - near;
        if !(spare.is_positive() && between.is_positive()) {
            return Err(refused("a time near the middle set that is short against the loops", spare.lo()));
        }
        let apart = |states: &[Interval]| distance(self.states, states);
        let both = |states: &[Interval]| least([apart(states), apart(&self.image(states))].into_iter());
        let to_orbit = least(orbit.iter().flat_map(|passage| &passage.tubes).map(|tube| both(&tube.states)));
        let all = excursion.iter().flat_map(|passage| &passage.tubes);
        let to_image = least(all.map(|tube| apart(&self.image(&tube.states))));
        let is_near = |time: Interval| time.is_within(Interval::symmetric(self.near));
        let to_excursion = least(excursion.iter().enumerate().flat_map(|(k, passage)| {
            // times relative to the passage of M, through the flights between
            let start = if k < place {
                -total(excursion[k..place].iter().copied())
            } else {
                total(excursion[place..k].iter().copied())
            };
            let others = passage.tubes.iter().filter(move |tube| !is_near(start + tube.time));
            others.map(|tube| apart(&tube.states))
        }));
        for (value, wanted) in [
            (to_orbit, "a middle set apart from the periodic orbit"),
            (to_excursion, "a middle set apart from the excursion at other times"),
            (to_image, "a middle set apart from the image of the excursion"),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(refused(wanted, value));
            }
        }
        Ok(Distances { middle: set, to_orbit, to_excursion, to_image })
    }
}
