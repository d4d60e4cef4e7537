//! What the tests share: random tops and states, and the vector field written out from the Poisson tensor.

use liepoisson_core::analysis::orbit::{Orbits, orbits};
use liepoisson_core::ensemble::{Control, Ensemble, Outcome};
use liepoisson_core::field::Top;
use liepoisson_core::lanes::Simd;
use liepoisson_core::method::{Method, Taylor};
use proptest::array::uniform3;
use proptest::prelude::*;

/// Parameters of a top: inertia, a, b, epsilon.
#[derive(Clone, Copy, Debug)]
pub struct Parameters {
    pub inertia: [f64; 3],
    pub a: [f64; 3],
    pub b: [f64; 3],
    pub epsilon: f64,
}

pub const TWISTED_KOVALEVSKAYA: Parameters =
    Parameters { inertia: [2.0, 2.0, 1.0], a: [-1.0, 0.0, 0.0], b: [0.0; 3], epsilon: 1.0 };

impl Parameters {
    pub fn top(&self) -> Top {
        Top::new(self.inertia, self.a, self.b, self.epsilon).unwrap()
    }

    /// `J(x) grad H(x)` with `J = [[l^, alpha^, beta^], [alpha^, eps beta^, 0], [beta^, 0, 0]]`, `u^ v = u x v`.
    pub fn hamiltonian_vector_field(&self, x: &[f64]) -> [f64; 9] {
        let gradient = self.gradient(x);
        let mut hat = [[[0.0; 3]; 3]; 3];
        for (vector, hat) in hat.iter_mut().enumerate() {
            let [u1, u2, u3] = [x[3 * vector], x[3 * vector + 1], x[3 * vector + 2]];
            *hat = [[0.0, -u3, u2], [u3, 0.0, -u1], [-u2, u1, 0.0]];
        }
        let blocks = [
            [Some((0, 1.0)), Some((1, 1.0)), Some((2, 1.0))],
            [Some((1, 1.0)), Some((2, self.epsilon)), None],
            [Some((2, 1.0)), None, None],
        ];
        let mut field = [0.0; 9];
        for (row, columns) in blocks.iter().enumerate() {
            for (column, block) in columns.iter().enumerate() {
                let Some((vector, factor)) = *block else { continue };
                for i in 0..3 {
                    for j in 0..3 {
                        field[3 * row + i] += factor * hat[vector][i][j] * gradient[3 * column + j];
                    }
                }
            }
        }
        field
    }

    fn gradient(&self, x: &[f64]) -> [f64; 9] {
        let mut gradient = [0.0; 9];
        for i in 0..3 {
            gradient[i] = x[i] / self.inertia[i];
            gradient[3 + i] = self.a[i];
            gradient[6 + i] = self.b[i];
        }
        gradient
    }

    pub fn energy(&self, x: &[f64]) -> f64 {
        (0..3).map(|i| x[i] * x[i] / (2.0 * self.inertia[i]) + self.a[i] * x[3 + i] + self.b[i] * x[6 + i]).sum()
    }

    /// `|alpha|^2 + 2 eps l.beta`, `alpha.beta`, `|beta|^2`.
    pub fn casimirs(&self, x: &[f64]) -> [f64; 3] {
        let dot = |u: usize, v: usize| (0..3).map(|i| x[3 * u + i] * x[3 * v + i]).sum::<f64>();
        [dot(1, 1) + 2.0 * self.epsilon * dot(0, 2), dot(1, 2), dot(2, 2)]
    }
}

pub fn parameters() -> impl Strategy<Value = Parameters> {
    let vector = || uniform3(prop_oneof![1 => Just(0.0), 3 => -2.0..2.0_f64]);
    (uniform3(0.3..3.0_f64), vector(), vector(), prop_oneof![1 => Just(0.0), 3 => -2.0..2.0_f64])
        .prop_map(|(inertia, a, b, epsilon)| Parameters { inertia, a, b, epsilon })
}

pub fn vector9() -> impl Strategy<Value = Vec<f64>> {
    proptest::collection::vec(-1.5..1.5_f64, 9)
}

/// A spread of deterministic starts: each vector on the unit sphere, by golden angles.
pub fn starts(trajectories: usize) -> Vec<f64> {
    (0..3 * trajectories)
        .flat_map(|k| {
            let (z, phase) = (1.0 - 2.0 * ((k as f64 * 0.618_034) % 1.0), k as f64 * 2.4);
            let radius = (1.0 - z * z).sqrt();
            [radius * phase.cos(), radius * phase.sin(), z]
        })
        .collect()
}

pub fn taylor(tolerance: f64) -> Taylor {
    Taylor::new(tolerance, None, 1_000_000).unwrap()
}

/// Orbits of one or more trajectories at `times`.
pub fn run<M: Method<Top>>(
    top: &Top,
    method: M,
    states: &[f64],
    tangents: &[f64],
    times: &[f64],
    simd: Simd,
) -> Orbits {
    let n_tangents = if states.is_empty() { 0 } else { tangents.len() / states.len() };
    let ensemble = Ensemble { field: top, method, states, tangents, n_tangents, times };
    orbits(&ensemble, 1, simd, &Control::default(), false, |_| ()).unwrap()
}

/// What `run` gives with each instruction set that the processor has, on one thread and on three.
pub fn everywhere<R>(run: impl Fn(Simd, usize) -> R) -> Vec<R> {
    let available = Simd::ALL.into_iter().filter(|simd| simd.is_available());
    available.flat_map(|simd| [0, 1, 3].map(|threads| run(simd, threads))).collect()
}

/// Bits, so that NaN equals NaN.
pub fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

pub fn distance(u: &[f64], v: &[f64]) -> f64 {
    u.iter().zip(v).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// The same orbits, bit for bit. `with_times`: also where trajectories ended. With fixed steps those that leave the finite numbers end with a batch of
/// steps, and what a batch is depends on the neighbours.
pub fn assert_same_bits(results: &[Orbits], with_times: bool) {
    for other in &results[1..] {
        assert_eq!(bits(&results[0].states), bits(&other.states));
        assert_eq!(bits(&results[0].tangents), bits(&other.tangents));
        for (a, b) in results[0].summaries.iter().zip(&other.summaries) {
            assert_eq!(a.outcome, b.outcome);
            if with_times || a.outcome != Outcome::NotFinite {
                assert_eq!((a.n_steps, a.time.to_bits()), (b.n_steps, b.time.to_bits()));
                assert_eq!(bits(&a.state), bits(&b.state));
            }
        }
        for (a, b) in results[0].series.iter().zip(&other.series) {
            assert_eq!((bits(&a.times), bits(&a.coefficients)), (bits(&b.times), bits(&b.coefficients)));
        }
    }
}
