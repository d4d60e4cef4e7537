//! The periodic orbit is mapped to itself by the reversing symmetries.
//!
//! Let x_i be its points in the sets of the short loop, made smaller by a factor. A reverser `rho`, perhaps followed by the
//! symmetry `R`, takes x_i near to the section of set `s(i)`, where `s` runs through the loop backwards; a short flight takes
//! it to a point y_s(i) of that section. If all of these are in the sets and the flight times between them are within the
//! windows of the edges, in which orbits cross exactly once, then the reversed orbit follows the edges of the short loop, and
//! since only one orbit does, it is the periodic orbit.

use super::graph::Loop;
use super::{Edge, Place};
use crate::enclosure::chart::Frame;
use crate::enclosure::failure::Failure;
use crate::enclosure::flow::Flow;
use crate::enclosure::interval::Interval;
use crate::enclosure::linear::euclidean_norm;
use crate::enclosure::lohner::StateSet;
use crate::enclosure::matrix::{Matrix, combine, points};
use crate::enclosure::passage::{Level, Passage};
use crate::enclosure::polynomial::Sign;
use crate::enclosure::section::cross;
use crate::ensemble::Control;

/// The short loop, on the sets and on the smaller ones.
pub(super) struct ShortLoop<'p> {
    pub(super) flow: &'p mut Flow,
    pub(super) level: &'p Level,
    pub(super) edges: &'p [Edge],
    pub(super) path: &'p Loop,
    pub(super) frames: &'p [Frame],
    pub(super) symmetry: &'p [Sign],
    pub(super) n_unstable: usize,
    /// Radius of the smaller sets.
    pub(super) small: f64,
    /// For each edge, from the whole sets.
    pub(super) passages: &'p [Passage],
    /// For each edge of the loop, from the smaller ones.
    pub(super) small_passages: &'p [Passage],
}

/// Where the reflected point of a set is in the chart of another.
#[derive(Clone, Copy, Debug)]
struct Image {
    /// Whether the symmetry follows the reverser.
    is_reflected: bool,
    /// The greater one of `|q_u|` and `|q_s|`.
    size: f64,
    /// The flight to the section.
    delay: Interval,
}

impl ShortLoop<'_> {
    /// The greatest size of an image; none if the symmetry is not certain.
    pub(super) fn size(&mut self, reverser: &[Sign], control: &Control) -> Result<Option<f64>, Failure> {
        let count = self.path.len();
        for shift in 0..count {
            let mut images = vec![];
            for i in 0..count {
                if control.look_at_clock().is_some() {
                    return Err(Failure::Stopped);
                }
                let target = (shift + count - i) % count;
                let found = [false, true].into_iter().find_map(|is_reflected| {
                    self.image(reverser, is_reflected, self.set(i), self.set(target)).ok().flatten()
                });
                match found {
                    Some(image) => images.push(image),
                    None => break,
                }
            }
            if images.len() == count && self.follows_the_edges(&images, shift) {
                return Ok(Some(images.iter().map(|image| image.size).fold(0.0, f64::max)));
            }
        }
        Ok(None)
    }

    /// The number of a set of the loop.
    fn set(&self, place: usize) -> usize {
        self.edges[self.path[place]].from
    }

    /// The image of a smaller set, if it is within the target.
    fn image(
        &mut self,
        reverser: &[Sign],
        is_reflected: bool,
        from: usize,
        to: usize,
    ) -> Result<Option<Image>, Failure> {
        let (source, target) = (&self.frames[from], &self.frames[to]);
        let small = vec![Interval::symmetric(self.small); source.n_directions()];
        let lift = source.lift(&self.level.constants, &self.level.values, &small, self.level.reach)?;
        let moved = source.reflected(reverser);
        let moved = if is_reflected { moved.reflected(self.symmetry) } else { moved };
        let set = StateSet::new(moved.center(), moved.columns().clone(), lift.coordinates.clone());
        let crossing = cross(self.flow, &set, &target.section())?;
        // L (S c + S B y - c') + delay L f
        let rates = self.flow.field().values(&crossing.tube);
        let place = |rows: &Matrix<Interval>| {
            let center = rows.apply(&combine(&points(moved.center()), &points(target.center()), |a, b| a - b));
            let extent = rows.times(&moved.columns().enclosed()).apply(&lift.coordinates);
            let flight: Vec<Interval> = rows.apply(&rates).iter().map(|&rate| crossing.delay * rate).collect();
            combine(&combine(&center, &extent, |a, b| a + b), &flight, |a, b| a + b)
        };
        let (q, w) = (place(&target.to_directions()), place(&target.to_constants()));
        let (unstable, stable) = q.split_at(self.n_unstable);
        let size = euclidean_norm(unstable).max(euclidean_norm(stable)).hi();
        let is_in_chart = w.iter().all(|w| w.is_within(Interval::symmetric(self.level.reach)));
        Ok((size < 1.0 && is_in_chart).then_some(Image { is_reflected, size, delay: crossing.delay }))
    }

    /// Whether the images follow the edges backwards: an edge from i to j becomes one from s(j) to s(i).
    fn follows_the_edges(&self, images: &[Image], shift: usize) -> bool {
        let count = images.len();
        (0..count).all(|i| {
            let j = (i + 1) % count;
            let (from, edge) = ((shift + count - j) % count, self.path[i]);
            let other = self.path[from];
            let time = self.small_passages[i].time + images[i].delay - images[j].delay;
            let flips = [self.edges[edge].is_reflected, images[i].is_reflected, images[j].is_reflected];
            let is_flipped = flips.into_iter().filter(|&flip| flip).count() % 2 == 1;
            time.is_within(self.passages[other].window) && is_flipped == self.edges[other].is_reflected
        })
    }

    /// Where a refusal is found.
    pub(super) fn place(&self) -> Place {
        Place::Set(self.set(0))
    }
}
