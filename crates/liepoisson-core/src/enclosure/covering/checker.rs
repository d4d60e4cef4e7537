//! All checks of a certificate, in their order.

use super::entropy::entropy;
use super::graph::{Loop, loops};
use super::relation::{Relation, relation};
use super::reversal::ShortLoop;
use super::rotation::{Multipliers, discriminant, multipliers};
use super::separation::Paths;
use super::{Certificate, Check, Margins, Place, Refusal, Rotation, Settings, form};
use crate::enclosure::chart::{Frame, Lift};
use crate::enclosure::failure::Failure;
use crate::enclosure::flow::{Flow, Options};
use crate::enclosure::interval::Interval;
use crate::enclosure::linear::euclidean_norm;
use crate::enclosure::matrix::{IntervalVector, Matrix};
use crate::enclosure::passage::{Level, Passage, pass};
use crate::enclosure::periodic::{Leg, PeriodicOrbit, periodic_orbit};
use crate::enclosure::program::Program;
use crate::enclosure::rational::Rational;
use crate::ensemble::Control;

/// Verifies a certificate; what it proves is said in docs/proof.md.
///
/// The search for it may have made any mistake. `control` ends the check early, and tells how much of it is done.
///
/// # Errors
/// The first check that does not pass.
pub fn check(certificate: &Certificate, settings: &Settings, control: &Control) -> Result<Margins, Refusal> {
    form::shapes(certificate, settings)?;
    form::identities(certificate)?;
    let loops = loops(&certificate.edges, certificate.sets.len())?;
    for path in &loops {
        // then the periodic orbit is mapped to itself by the symmetry
        let n_reflections = path.iter().filter(|&&edge| certificate.edges[edge].is_reflected).count();
        if n_reflections % 2 == 0 {
            let wanted = "an odd number of reflections in each loop";
            return Err(Refusal::new(Check::Graph, Place::Edge(path[0]), wanted));
        }
    }
    let frames = form::frames(certificate)?;
    let n = certificate.field.len();
    let field = Program::new(n, &certificate.field);
    let options = Options { order: settings.order, step: settings.step, ..Options::default() };
    let level = Level {
        constants: Program::new(n, &certificate.constants),
        values: form::level(certificate, settings.level_radius, Rational::ZERO)?,
        reach: settings.reach,
    };
    let checker = Checker { certificate, settings, control, frames, loops, level, flow: Flow::new(field, options) };
    checker.run()
}

struct Checker<'c> {
    certificate: &'c Certificate,
    settings: &'c Settings,
    control: &'c Control,
    frames: Vec<Frame>,
    loops: [Loop; 2],
    /// All levels of the ball.
    level: Level,
    flow: Flow,
}

impl Checker<'_> {
    fn run(mut self) -> Result<Margins, Refusal> {
        let lifts = self.charts()?;
        let (passages, relations) = self.edges()?;
        let (small_passages, small) = self.small_loop(&passages)?;
        let reversal = self.reversal(&passages, &small_passages)?;

        let place = self.loops[1].len() / 2;
        let middle = self.certificate.edges[self.loops[1][place]].from;
        let paths = Paths {
            loops: &self.loops,
            passages: &passages,
            middle: (middle, place),
            states: &lifts[middle].states,
            symmetry: &self.certificate.symmetry,
            near: self.settings.near,
        };
        let separation = paths.distances()?;

        let rotation = match self.settings.shift {
            Some(shift) => Some(self.rotation(&passages, &small_passages, shift)?),
            None => None,
        };
        let loops = self.flight_times(&passages);
        let entropy = entropy([loops[0].0.hi(), loops[1].0.hi()]);
        if entropy.is_nan() || entropy <= 0.0 {
            return Err(Refusal::new(Check::Entropy, Place::Everywhere, "a positive lower bound").with_value(entropy));
        }
        Ok(Margins {
            n_steps: passages.iter().map(|passage| passage.tubes.len() - 1).sum(),
            expansion: relations.iter().map(|relation| relation.expansion).collect(),
            contraction: relations.iter().map(|relation| relation.contraction).collect(),
            cone: relations.iter().map(|relation| relation.cone).collect(),
            chart: passages.iter().map(|passage| greatest(&passage.w)).collect(),
            crossing_rate: passages.iter().map(|passage| passage.rate.lo()).fold(f64::INFINITY, f64::min),
            small,
            reversal,
            separation,
            loops,
            entropy,
            rotation,
        })
    }

    fn everywhere(&self, radius: f64) -> IntervalVector {
        vec![Interval::symmetric(radius); self.frames[0].n_directions()]
    }

    /// Each set is in a chart, and the flow crosses its section in the direction of its column.
    fn charts(&mut self) -> Result<Vec<Lift>, Refusal> {
        let q = self.everywhere(1.0);
        let mut lifts = vec![];
        for (number, frame) in self.frames.iter().enumerate() {
            let place = Place::Set(number);
            let lift = frame
                .lift(&self.level.constants, &self.level.values, &q, self.level.reach)
                .map_err(|failure| Refusal::failed(Check::Chart, place, failure))?;
            let rate = frame.section().rate(self.flow.field(), &lift.states);
            if !rate.is_positive() {
                let wanted = "orbits that cross the section in the direction of the frame";
                return Err(Refusal::new(Check::Transversality, place, wanted).with_value(rate.lo()));
            }
            lifts.push(lift);
        }
        Ok(lifts)
    }

    /// The frame that an edge ends in: the image under the symmetry, which commutes with the flow, where it is applied.
    fn target(&self, edge: usize) -> Frame {
        let edge = &self.certificate.edges[edge];
        let frame = &self.frames[edge.to];
        if edge.is_reflected { frame.reflected(&self.certificate.symmetry) } else { frame.clone() }
    }

    /// Follows an edge from `|q_k| <= radius`.
    fn pass(&mut self, edge: usize, radius: f64) -> Result<Passage, Refusal> {
        let (q, to) = (self.everywhere(radius), self.target(edge));
        let from = (&self.frames[self.certificate.edges[edge].from], &*q, &*vec![0.0; q.len()]);
        let time = self.certificate.edges[edge].time;
        let passage = pass(&mut self.flow, &self.level, from, &to, time, self.control)
            .map_err(|failure| Refusal::failed(Check::Passage, Place::Edge(edge), failure))?;
        if !passage.rate.is_positive() {
            let wanted = "orbits that arrive in the direction of the frame";
            return Err(Refusal::new(Check::Transversality, Place::Edge(edge), wanted).with_value(passage.rate.lo()));
        }
        Ok(passage)
    }

    /// Every edge is a covering relation with cone conditions.
    fn edges(&mut self) -> Result<(Vec<Passage>, Vec<Relation>), Refusal> {
        let (mut passages, mut relations) = (vec![], vec![]);
        let count = self.certificate.edges.len();
        for edge in 0..count {
            let passage = self.pass(edge, 1.0)?;
            let n_unstable = self.certificate.n_unstable;
            relations.push(relation(&passage.offset, &passage.derivative, n_unstable, 1.0, Place::Edge(edge))?);
            passages.push(passage);
            self.control.set_done((edge + 1) as f64 / (count + 6 * self.loops[0].len()) as f64);
        }
        Ok((passages, relations))
    }

    /// The edges of the short loop between smaller sets: the periodic orbit is in these.
    fn small_loop(&mut self, passages: &[Passage]) -> Result<(Vec<Passage>, (f64, f64)), Refusal> {
        let (mut found, mut worst) = (vec![], (f64::INFINITY, 0.0_f64));
        for edge in self.loops[0].clone() {
            let (small, place) = (self.settings.small, Place::Edge(edge));
            let passage = self.pass(edge, small)?;
            let relation = relation(&passage.offset, &passage.derivative, self.certificate.n_unstable, small, place)?;
            worst = (worst.0.min(relation.expansion), worst.1.max(relation.contraction));
            self.require_same_crossing(edge, &passage, passages)?;
            found.push(passage);
        }
        Ok((found, worst))
    }

    /// Orbits of a part of a set cross where those of the set do: within its window each crosses once.
    fn require_same_crossing(&self, edge: usize, part: &Passage, passages: &[Passage]) -> Result<(), Refusal> {
        if part.time.is_within(passages[edge].window) {
            return Ok(());
        }
        Err(Refusal::new(Check::Passage, Place::Edge(edge), "the crossing of the whole set"))
    }

    /// The periodic orbit is mapped to itself by every reverser.
    fn reversal(&mut self, passages: &[Passage], small_passages: &[Passage]) -> Result<f64, Refusal> {
        let mut short = ShortLoop {
            flow: &mut self.flow,
            level: &self.level,
            edges: &self.certificate.edges,
            path: &self.loops[0],
            frames: &self.frames,
            symmetry: &self.certificate.symmetry,
            n_unstable: self.certificate.n_unstable,
            small: self.settings.small,
            passages,
            small_passages,
        };
        let mut size = 0.0_f64;
        for reverser in &self.certificate.reversers {
            let place = short.place();
            let found = short
                .size(reverser, self.control)
                .map_err(|failure| Refusal::failed(Check::Reversal, place, failure))?;
            let wanted = "the reflected periodic orbit within the sets";
            size = size.max(found.ok_or(Refusal::new(Check::Reversal, place, wanted))?);
        }
        Ok(size)
    }

    /// `T^2/4 - S + 2 < 0` for the periodic orbits of all levels.
    fn complex_multipliers(&self, small_passages: &[Passage]) -> Result<Interval, Refusal> {
        let around = around(small_passages.iter().map(|passage| &passage.derivative));
        let refused = |wanted| {
            Refusal::new(Check::Multipliers, Place::Set(self.certificate.edges[self.loops[0][0]].from), wanted)
        };
        if around.n_rows() != 4 || self.certificate.n_unstable != 2 {
            return Err(refused("two unstable and two stable directions"));
        }
        let discriminant = discriminant(&around);
        if !discriminant.is_negative() {
            return Err(refused("a negative discriminant").with_value(discriminant.hi()));
        }
        Ok(discriminant)
    }

    /// Complex multipliers on all levels, and different angles on two of them.
    fn rotation(
        &mut self,
        passages: &[Passage],
        small_passages: &[Passage],
        shift: Rational,
    ) -> Result<Rotation, Refusal> {
        let refused = |wanted| Refusal::new(Check::Rotation, Place::Everywhere, wanted);
        let discriminant = self.complex_multipliers(small_passages)?;
        let is_in_ball = shift > Rational::ZERO && shift <= self.settings.level_radius;
        if !is_in_ball {
            return Err(refused("two levels of the ball"));
        }
        let (below, of_below) = self.periodic_orbit(passages, shift.negative())?;
        let (above, of_above) = self.periodic_orbit(passages, shift)?;
        let angles = [of_below.rotation, of_above.rotation];
        if !angles[0].meet(angles[1]).is_unknown() {
            return Err(refused("different angles on two levels"));
        }
        let moduli = [of_below.modulus, of_above.modulus];
        Ok(Rotation { discriminant, angles, periods: [below.period(), above.period()], moduli })
    }

    /// The orbit that follows the short loop on one level, and its multipliers.
    fn periodic_orbit(
        &mut self,
        passages: &[Passage],
        shift: Rational,
    ) -> Result<(PeriodicOrbit, Multipliers), Refusal> {
        let level = Level { values: form::level(self.certificate, Rational::ZERO, shift)?, ..self.level.clone() };
        let edges = self.loops[0].clone();
        let leg = |&edge: &usize| Leg {
            from: self.frames[self.certificate.edges[edge].from].clone(),
            to: self.target(edge),
            time: self.certificate.edges[edge].time,
        };
        let legs: Vec<Leg> = edges.iter().map(leg).collect();
        let start = vec![vec![0.0; self.frames[0].n_directions()]; legs.len()];
        let place = Place::Set(self.certificate.edges[edges[0]].from);
        let orbit = periodic_orbit(&mut self.flow, &level, &legs, start, self.control)
            .map_err(|failure| Refusal::failed(Check::Rotation, place, failure))?;
        for (i, &edge) in edges.iter().enumerate() {
            // in the sets, and by the same crossings, there is only one orbit that follows the loop
            self.require_same_crossing(edge, &orbit.passages[i], passages)?;
            let (unstable, stable) = orbit.q[i].split_at(self.certificate.n_unstable);
            let size = euclidean_norm(unstable).max(euclidean_norm(stable)).hi();
            if size.is_nan() || size >= 1.0 {
                let wanted = "the periodic orbit of a neighbouring level within the sets";
                return Err(Refusal::new(Check::Rotation, place, wanted).with_value(size));
            }
        }
        let found = multipliers(&orbit.derivative());
        if found.rotation.is_unknown() || found.modulus.is_unknown() {
            return Err(Refusal::failed(Check::Rotation, place, Failure::Singular));
        }
        Ok((orbit, found))
    }

    /// Flight times of the loops, and how often the symmetry is applied.
    fn flight_times(&self, passages: &[Passage]) -> [(Interval, usize); 2] {
        [0, 1].map(|which| {
            let edges = &self.loops[which];
            let time = edges.iter().fold(Interval::ZERO, |sum, &edge| sum + passages[edge].time);
            (time, edges.iter().filter(|&&edge| self.certificate.edges[edge].is_reflected).count())
        })
    }
}

fn greatest(vector: &[Interval]) -> f64 {
    vector.iter().map(|entry| entry.mag()).fold(0.0, f64::max)
}

/// The product of derivatives, the first one to the right.
fn around<'m>(derivatives: impl Iterator<Item = &'m Matrix<Interval>>) -> Matrix<Interval> {
    derivatives.cloned().reduce(|product, next| next.times(&product)).expect("a loop has an edge")
}
