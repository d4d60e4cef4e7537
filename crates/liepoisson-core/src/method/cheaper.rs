//! Which of the two adaptive methods takes less work for a field and a tolerance, by counted operations: the same on every processor.
//!
//! Steps of Taylor's method, of order `N`, are `rho tolerance^(1/(N-1))` long, those of the Runge-Kutta method of order 8
//! `c rho tolerance^(1/8)`. With `W` operations in a step of either, the work to a given time is `W` over these. Operations are in
//! units of a multiply-add of a tape's series, and with one tangent vector; without any both methods save about as much.
//!
//! Measured over eleven systems, those of `benchmarks/general_problems.py` and a top, at six tolerances from 1e-3 to 1e-13, with and
//! without tangent vectors: the ratio of the times is off the counted one by a factor of 1.35, and the choice costs 2% more time on
//! average than the quicker method of each row (49% at most, on two), where Taylor's method alone costs 10% more, the other one 30%.

use crate::field::{OF_A_STEP, Quadratic, Space, Tape, Top};
use crate::method::Taylor;
use crate::method::dop853::{ERROR_OF_ORDER_3, ERROR_OF_ORDER_5, STAGES, WEIGHTS};
use crate::method::step_end::n_looks;

/// `c` of these systems, as accepted steps say: 1.85 in the geometric mean, from 1.4 to 2.6. What counts is work, also that of refused
/// steps: as times say, 1.37.
const LENGTH: f64 = 4.0 / 3.0;

/// A field whose operations are counted.
pub(crate) trait Counted: Space {
    /// The order that Taylor's method has for the field.
    fn order(&self, method: Taylor) -> usize {
        method.order()
    }

    /// Operations of a step with a series up to this order.
    fn series(&self, order: usize) -> f64;

    /// Operations of the rates of change.
    fn rates(&self) -> f64;
}

/// Whether the Runge-Kutta method of order 8 takes less work to a given time than Taylor's.
pub(crate) fn runge_kutta_is_cheaper(field: &impl Counted, method: Taylor) -> bool {
    let order = field.order(method);
    let rows = STAGES.into_iter().chain([WEIGHTS, ERROR_OF_ORDER_5, ERROR_OF_ORDER_3]);
    let sums = 2 * field.n_components() * rows.map(<[_]>::len).sum::<usize>();
    let stages = (1 + STAGES.len()) as f64 * field.rates() + sums as f64 + OF_A_STEP;
    let power = 1.0 / 8.0 - 1.0 / (order as f64 - 1.0);
    stages < LENGTH * libm::exp(power * libm::log(method.tolerance())) * field.series(order)
}

impl Counted for Tape {
    fn order(&self, method: Taylor) -> usize {
        method.for_tape(self).order()
    }

    fn series(&self, order: usize) -> f64 {
        self.cost_of_a_step(order, n_looks(self, order))
    }

    fn rates(&self) -> f64 {
        self.cost_of_rates()
    }
}

/// Of four systems, with 3 to 208 products: steps of series are within 20% of their times, those of stages within 25%.
impl Counted for Quadratic {
    fn series(&self, order: usize) -> f64 {
        let ([products, terms], n) = (self.counts(), order as f64);
        OF_A_STEP + 100.0 * n + 3.0 * products * n * (n + 1.0) + 10.0 * terms * n
    }

    fn rates(&self) -> f64 {
        let [products, terms] = self.counts();
        250.0 + 6.0 * products + 10.0 * terms
    }
}

/// Its 15 products, in a kernel of its own, are with one tangent vector 45; of the rest as times say.
impl Counted for Top {
    fn series(&self, order: usize) -> f64 {
        let n = order as f64;
        OF_A_STEP + 170.0 * n + 45.0 / 2.0 * n * (n + 1.0)
    }

    fn rates(&self) -> f64 {
        70.0
    }
}
