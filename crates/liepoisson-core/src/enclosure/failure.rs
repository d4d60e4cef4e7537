//! Why an enclosure was not found.

use std::fmt;

/// What could not be proved, and where. It says nothing about what is true: smaller sets or steps may do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Failure {
    /// No box was found in which the solutions stay during a step, or it became too wide.
    NoStep {
        /// Time at the beginning of the step.
        time: f64,
    },
    /// The number of steps that were allowed is used up.
    Steps {
        /// Time that was reached.
        time: f64,
    },
    /// At the time that was given it is not sure that every orbit crosses the section once, and transversally.
    NoCrossing,
    /// Images may lie outside the part of the level on which a chart is unique.
    OutsideChart,
    /// A matrix of intervals may contain a singular one.
    Singular,
    /// The operator of Newton's method does not map the box into itself, so that it proves no zero.
    NotContracted,
    /// The caller, or the clock, ended the computation.
    Stopped,
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Failure::NoStep { time } => write!(f, "no enclosure of a step from time {time}"),
            Failure::Steps { time } => write!(f, "no steps left at time {time}"),
            Failure::NoCrossing => f.write_str("no certain transversal crossing of the section"),
            Failure::OutsideChart => f.write_str("images that may lie beyond the reach of a chart"),
            Failure::Singular => f.write_str("a matrix that may be singular"),
            Failure::NotContracted => f.write_str("Newton's operator does not map the box into itself"),
            Failure::Stopped => f.write_str("the time limit has passed"),
        }
    }
}
