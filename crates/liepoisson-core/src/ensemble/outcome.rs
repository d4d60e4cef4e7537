//! How trajectories end.

/// How a trajectory ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// It reached the last time.
    Finished,
    /// Its step no longer changes the time.
    StepTooSmall,
    /// Its state, a tangent vector, or their series are not finite.
    NotFinite,
    /// It took as many steps as it may without reaching the last time.
    MaxSteps,
    /// The run was cancelled before it reached the last time.
    Cancelled,
    /// The implicit equation of a step was not solved: the step is too long for it.
    NoConvergence,
    /// The time that the run may take was over before it reached the last time.
    TimeLimit,
    /// Its step is not short beside the times in which the damping relaxes.
    StepTooLarge,
}

impl Outcome {
    /// All of them, by their codes.
    pub const ALL: [Outcome; 8] = [
        Outcome::Finished,
        Outcome::StepTooSmall,
        Outcome::NotFinite,
        Outcome::MaxSteps,
        Outcome::Cancelled,
        Outcome::NoConvergence,
        Outcome::TimeLimit,
        Outcome::StepTooLarge,
    ];

    /// Its code in results: its position in [`Outcome::ALL`].
    pub fn code(self) -> u8 {
        self as u8
    }

    /// Its name in results.
    pub fn name(self) -> &'static str {
        match self {
            Outcome::Finished => "finished",
            Outcome::StepTooSmall => "step too small",
            Outcome::NotFinite => "not finite",
            Outcome::MaxSteps => "max steps",
            Outcome::Cancelled => "cancelled",
            Outcome::NoConvergence => "no convergence",
            Outcome::TimeLimit => "time limit",
            Outcome::StepTooLarge => "step too large",
        }
    }
}

/// The end of one trajectory: the last point that it reached.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// How it ended.
    pub outcome: Outcome,
    /// Time reached.
    pub time: f64,
    /// Accepted steps.
    pub n_steps: u64,
    /// State at that time.
    pub state: Vec<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_positions() {
        assert!(Outcome::ALL.iter().enumerate().all(|(position, outcome)| usize::from(outcome.code()) == position));
    }
}
