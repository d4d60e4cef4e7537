//! The check of a certificate of chaos: sets that cover each other along the flow, on levels of constants of motion.
//!
//! A certificate is a point and a frame of doubles for each set, and a list of edges with flight times. Nothing about it is
//! trusted. [`check`] proves, for every level of a ball, what the theorem of docs/proof.md asks for, in this order:
//!
//! 1. form: shapes, finite numbers; the constants of motion are constant, the symmetry and the reversing symmetries are
//!    such, exactly, as identities of polynomials with rational coefficients;
//! 2. graph: the edges form two loops through one set: one through few sets, followed by the periodic orbit, and an
//!    excursion through all of the others;
//! 3. charts: on each set the level is a graph over the coordinates `q`, and the flow crosses the section there;
//! 4. edges: the flow takes each set across the next one ([`relation`]): covering relations, and cone conditions;
//! 5. the periodic orbit is symmetric ([`reversal`]), in sets that are smaller by a factor;
//! 6. separation: the middle set of the excursion is apart from all else that orbits of the graph meet at that time
//!    ([`separation`]);
//! 7. the multipliers of the periodic orbit are not real, and their angle is not the same on two levels ([`rotation`]);
//! 8. entropy from the flight times.

pub mod entropy;
pub mod graph;
pub mod refusal;
pub mod relation;
pub mod reversal;
pub mod rotation;
pub mod separation;

mod checker;
mod form;

pub use checker::check;
pub use refusal::{Check, Place, Refusal};

use super::interval::Interval;
use super::matrix::Matrix;
use super::polynomial::{Polynomial, Sign};
use super::rational::Rational;

/// A set `{ c + B (q_u, 0, q_s, w) : |q_u| <= 1, |q_s| <= 1 }` on a level, with Euclidean norms.
#[derive(Clone, Debug)]
pub struct CoveringSet {
    /// c.
    pub center: Vec<f64>,
    /// B: columns u, flow, s, and as many as there are constants of motion.
    pub frame: Matrix<f64>,
}

/// The claim that one set covers another after about `time`, perhaps after the symmetry.
#[derive(Clone, Copy, Debug)]
pub struct Edge {
    /// Number of the set that is carried along.
    pub from: usize,
    /// Number of the set that is covered.
    pub to: usize,
    /// Flight time, about.
    pub time: f64,
    /// Whether the symmetry is applied at the end.
    pub is_reflected: bool,
}

/// What is claimed, and of which system.
#[derive(Clone, Debug)]
pub struct Certificate {
    /// The rate of change of each component.
    pub field: Vec<Polynomial>,
    /// Constants of motion.
    pub constants: Vec<Polynomial>,
    /// Their values.
    pub level: Vec<Rational>,
    /// A reflection that maps orbits to orbits.
    pub symmetry: Vec<Sign>,
    /// Reflections that map orbits to orbits run through backwards.
    pub reversers: Vec<Vec<Sign>>,
    /// Number of unstable directions, the first columns of each frame.
    pub n_unstable: usize,
    /// The sets.
    pub sets: Vec<CoveringSet>,
    /// The edges.
    pub edges: Vec<Edge>,
}

/// How the check is made, and of how much. None of it is trusted: what is refused may be accepted with other settings, but
/// what is accepted is proved.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The check holds for all levels whose constants differ by at most this from those of the certificate.
    pub level_radius: Rational,
    /// Order of the Taylor series.
    pub order: usize,
    /// The longest step.
    pub step: f64,
    /// Reach of the charts: greatest `|w_k|`.
    pub reach: f64,
    /// Factor of the smaller sets around the periodic orbit.
    pub small: f64,
    /// The excursion is apart from its middle set at times that differ by more than this.
    pub near: f64,
    /// The two levels on which the angles of the multipliers are compared: the first constant less and more by this, which
    /// must not leave the ball. Without it they are not looked at.
    pub shift: Option<Rational>,
}

impl Default for Settings {
    fn default() -> Settings {
        Settings {
            level_radius: Rational::new(3, 100_000_000).expect("not zero"),
            order: 20,
            step: 0.1,
            reach: 1e-3,
            small: 0.1,
            near: 0.3,
            shift: Rational::new(1, 1 << 26),
        }
    }
}

/// How far each condition of an accepted certificate holds, rounded to the side on which the number is true.
#[derive(Clone, Debug)]
pub struct Margins {
    /// Number of steps of the flow along the edges.
    pub n_steps: usize,
    /// For each edge the least `|q_u|` of images of `|q_u| = 1`; above one.
    pub expansion: Vec<f64>,
    /// For each edge the greatest `|q_s|` of images; below one.
    pub contraction: Vec<f64>,
    /// For each edge the least `delta` of `Q(d') >= Q(d) + delta |d|^2`; positive.
    pub cone: Vec<f64>,
    /// For each edge the greatest `|w_k|` of images; at most the reach of the charts.
    pub chart: Vec<f64>,
    /// The least rate at which orbits cross sections, in coordinates of the frames; positive.
    pub crossing_rate: f64,
    /// The least expansion and the greatest contraction of the smaller sets around the periodic orbit.
    pub small: (f64, f64),
    /// The greatest `|q_u|` and `|q_s|` of reflected points of the periodic orbit; below one.
    pub reversal: f64,
    /// Distances, in the largest component, of the middle set.
    pub separation: separation::Distances,
    /// Flight times of the two loops, and how often the symmetry is applied in them.
    pub loops: [(Interval, usize); 2],
    /// Lower bound of the topological entropy of the flow.
    pub entropy: f64,
    /// What was asked for of the multipliers of the periodic orbit.
    pub rotation: Option<Rotation>,
}

/// The multipliers of the periodic orbit.
#[derive(Clone, Copy, Debug)]
pub struct Rotation {
    /// `T^2/4 - S + 2`, on all levels; negative.
    pub discriminant: Interval,
    /// The angle, divided by pi, on the two levels.
    pub angles: [Interval; 2],
    /// Its periods on the two levels, modulo the symmetry.
    pub periods: [Interval; 2],
    /// Absolute values of the multipliers on the two levels, those above one.
    pub moduli: [Interval; 2],
}
