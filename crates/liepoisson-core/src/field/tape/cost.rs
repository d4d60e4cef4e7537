//! What a step costs: operations counted in the program of a tape, whatever the processor.

use super::Tape;
use super::steps::{Kind, Step};

/// Operations at each order of a series, for each sum of products: its ends, the rule of the node, and the start of its loop. Of compiled
/// code for a double pendulum, in registers of AVX2 and in units of a multiply-add of its loops: 26.
const OF_A_NODE: f64 = 25.0;

/// Operations of a rate of change, for each rule: 17 of the same pendulum.
const OF_A_RULE: f64 = 15.0;

/// Operations of a step that depend neither on the tape nor on the order: its choice, the clock, and what is told of it. As above, 2300.
pub(crate) const OF_A_STEP: f64 = 2000.0;

/// Operations of the rates of change at a stage, for each rule of state and tangent vector. Of compiled Runge-Kutta steps of systems
/// without functions, in units of the same multiply-adds, 0.27 ns with AVX-512: 2.6 to 3.0.
const OF_A_RATE: f64 = 3.0;

/// The same for each pair of sine and cosine, and each other function: 22 to 84.
const OF_A_FUNCTION: f64 = 60.0;

impl Tape {
    /// Operations of a step with a series up to `order` and one tangent vector, at so many of whose nodes the series is compared with
    /// the field: `p N (N - 1) / 2` multiply-adds of sums of products, and others that grow as the order and less.
    pub(crate) fn cost_of_a_step(&self, order: usize, n_looks: usize) -> f64 {
        let products = |kind: Kind, has_tangent: bool| match (kind, has_tangent) {
            (Kind::Product, true) => 3.0,
            (Kind::Square, true) => 1.5,
            (Kind::Single, true) | (Kind::Pair, false) => 2.0,
            (Kind::Pair, true) => 4.0,
            (Kind::Product | Kind::Single, false) => 1.0,
            (Kind::Square, false) => 0.5,
        };
        let convolutions = &self.program.convolutions;
        let of_a_term: f64 = convolutions.iter().map(|one| products(one.kind, one.tangent.is_some())).sum();
        let (order, n_looks, n) = (order as f64, n_looks as f64, self.n_components as f64);
        let of_a_look = 2.0 * n * order + OF_A_RULE * self.program.steps.len() as f64;
        let of_exponents = 2.0 * order * self.program.exponents.len() as f64;
        of_a_term * (order * (order - 1.0) / 2.0)
            + OF_A_NODE * convolutions.len() as f64 * order
            + n_looks * of_a_look
            + of_exponents
            + OF_A_STEP
    }

    /// Operations of the rates of change with one tangent vector.
    pub(crate) fn cost_of_rates(&self) -> f64 {
        let is_function =
            |step: &&Step| matches!(step, Step::Integral { .. } | Step::DividedIntegral { .. } | Step::Pair { .. });
        let (steps, tangent_steps) = (&self.program.steps, &self.program.tangent_steps);
        let n_functions = steps.iter().filter(is_function).count();
        OF_A_RATE * (steps.len() + tangent_steps.len()) as f64 + OF_A_FUNCTION * n_functions as f64
    }
}
