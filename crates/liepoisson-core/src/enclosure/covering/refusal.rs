//! The first check that a certificate does not pass.

use crate::enclosure::failure::Failure;
use std::fmt;

/// Which check it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Check {
    /// Shapes, and that all numbers are finite.
    Form,
    /// The constants of motion are constant along orbits, identically.
    Constants,
    /// The symmetry maps orbits to orbits, keeps the constants, and changes something.
    Symmetry,
    /// The reversing symmetries map orbits to orbits run backwards, and keep the constants.
    Reversers,
    /// The edges form two loops.
    Graph,
    /// The matrix of a frame is regular.
    Frame,
    /// On the set the level is a graph, unique within the reach of the chart.
    Chart,
    /// The flow crosses the section, on the set and where orbits arrive, in its positive direction.
    Transversality,
    /// The flow is enclosed up to the section that is reached.
    Passage,
    /// The image reaches across the set in the unstable directions.
    Expansion,
    /// The image is within the set in the stable directions.
    Contraction,
    /// The cone conditions.
    Cones,
    /// The reflected periodic orbit is within the sets again, at the times of the edges.
    Reversal,
    /// The middle set of the excursion is apart.
    Separation,
    /// The multipliers are not real.
    Multipliers,
    /// The angles on two levels differ.
    Rotation,
    /// The entropy has a positive lower bound.
    Entropy,
    /// The caller, or the clock, ended the check.
    Stopped,
}

impl Check {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Check::Form => "form",
            Check::Constants => "constants of motion",
            Check::Symmetry => "symmetry",
            Check::Reversers => "reversing symmetries",
            Check::Graph => "graph",
            Check::Frame => "frame",
            Check::Chart => "chart",
            Check::Transversality => "transversality",
            Check::Passage => "passage",
            Check::Expansion => "expansion",
            Check::Contraction => "contraction",
            Check::Cones => "cones",
            Check::Reversal => "reversal",
            Check::Separation => "separation",
            Check::Multipliers => "multipliers",
            Check::Rotation => "rotation",
            Check::Entropy => "entropy",
            Check::Stopped => "stopped",
        }
    }
}

/// Where a check fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// In the whole of the certificate.
    Everywhere,
    /// In a set.
    Set(usize),
    /// In an edge.
    Edge(usize),
}

/// The first check that fails.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refusal {
    /// Which.
    pub check: Check,
    /// Where.
    pub place: Place,
    /// The number that should have been on the other side of its bound; NaN where there is none.
    pub value: f64,
    /// The enclosure that was not found.
    pub failure: Option<Failure>,
    /// What was wanted.
    pub wanted: &'static str,
}

impl Refusal {
    pub(super) fn new(check: Check, place: Place, wanted: &'static str) -> Refusal {
        Refusal { check, place, value: f64::NAN, failure: None, wanted }
    }

    pub(super) fn with_value(self, value: f64) -> Refusal {
        Refusal { value, ..self }
    }

    /// An enclosure that was not found.
    pub(super) fn failed(check: Check, place: Place, failure: Failure) -> Refusal {
        let check = if failure == Failure::Stopped { Check::Stopped } else { check };
        Refusal { check, place, value: f64::NAN, failure: Some(failure), wanted: "an enclosure" }
    }
}

impl Refusal {
    /// What to print, with a place of the caller's words.
    pub fn message(&self, place: &str) -> String {
        let separator = if place.is_empty() { "" } else { ", " };
        let got = match self.failure {
            Some(failure) => format!("; got {failure}"),
            None if self.value.is_nan() => String::new(),
            None => format!("; got {}", self.value),
        };
        format!("{}{separator}{place}: wanted {}{got}", self.check.name(), self.wanted)
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let place = match self.place {
            Place::Everywhere => String::new(),
            Place::Set(set) => format!("set {set}"),
            Place::Edge(edge) => format!("edge {edge}"),
        };
        f.write_str(&self.message(&place))
    }
}
