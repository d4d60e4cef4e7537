//! Which of the two adaptive methods takes less work for a field and a tolerance, by counted operations: the same on every processor.

use crate::field::{Quadratic, Space, Tape, Top};
use crate::method::Taylor;
use crate::method::dop853::{ERROR_OF_ORDER_3, ERROR_OF_ORDER_5, STAGES, WEIGHTS};
use crate::method::step_end::n_looks;

/// A field whose operations are counted, with one tangent vector.
pub(crate) trait Counted: Space {
    /// The order that Taylor's method has for the field, and operations of a step.
    fn series_step(&self, method: Taylor) -> (usize, f64);

    /// Operations of the rates of change.
    fn rates(&self) -> f64;
}

/// Whether the Runge-Kutta method of order 8 takes fewer operations to a given time than Taylor's.
pub(crate) fn runge_kutta_is_cheaper(field: &impl Counted, method: Taylor) -> bool {
    let (order, series) = field.series_step(method);
    let n_terms: usize = STAGES.iter().chain(&[WEIGHTS, ERROR_OF_ORDER_5, ERROR_OF_ORDER_3]).map(|row| row.len()).sum();
    let sums = (2 * field.n_components() * n_terms) as f64;
    let stages = (1 + STAGES.len()) as f64 * field.rates() + sums;
    let powers = 1.0 / 8.0 - 1.0 / (order as f64 - 1.0);
    stages < series * LENGTH * libm::exp(powers * libm::log(method.tolerance()))
}

const LENGTH: f64 = 1.75;

/// Operations of a field of degree two: products, each with one tangent vector, and terms that they and the components enter.
fn of_degree_two(n_products: usize, n_terms: usize) -> f64 {
    3.0 * n_products as f64 + 2.0 * n_terms as f64
}

impl Counted for Quadratic {
    fn series_step(&self, method: Taylor) -> (usize, f64) {
        let [products, terms] = self.counts().map(|count| count as f64);
        let order = method.order();
        let n = order as f64;
        (order, 1.5 * products * n * (n + 1.0) + 2.0 * terms * n)
    }

    fn rates(&self) -> f64 {
        let [n_products, n_terms] = self.counts();
        of_degree_two(n_products, n_terms)
    }
}

impl Counted for Top {
    fn series_step(&self, method: Taylor) -> (usize, f64) {
        (method.order(), 0.0)
    }

    fn rates(&self) -> f64 {
        of_degree_two(15, 24)
    }
}

impl Counted for Tape {
    fn series_step(&self, method: Taylor) -> (usize, f64) {
        let order = method.for_tape(self).order();
        (order, self.cost_of_a_step(order, n_looks(self, order)))
    }

    fn rates(&self) -> f64 {
        self.counts()[1] * 25.0
    }
}
