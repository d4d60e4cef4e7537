//! A quadratic field given at run time: the field and tangent field of its tensor, with the same bits on every register.

use crate::common::*;
use liepoisson_core::analysis::orbit::{Orbits, orbits};
use liepoisson_core::ensemble::{Control, Ensemble};
use liepoisson_core::error::Error;
use liepoisson_core::field::{Field, Quadratic, Space};
use liepoisson_core::lanes::Simd;
use liepoisson_core::method::Taylor;
use proptest::prelude::*;

/// The entries of a quadratic field.
#[derive(Clone, Debug, Default)]
struct Tensor {
    n: usize,
    constant: Vec<(usize, f64)>,
    linear: Vec<(usize, usize, f64)>,
    quadratic: Vec<(usize, usize, usize, f64)>,
}

impl Tensor {
    fn field(&self) -> Quadratic {
        Quadratic::new(self.n, &self.constant, &self.linear, &self.quadratic).unwrap()
    }

    /// `x'` from its definition, and beside it the sum of the absolute values of its terms.
    fn evaluate(&self, x: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let (mut value, mut size) = (vec![0.0; self.n], vec![0.0; self.n]);
        let mut add = |i: usize, term: f64| {
            value[i] += term;
            size[i] += term.abs();
        };
        self.constant.iter().for_each(|&(i, c)| add(i, c));
        self.linear.iter().for_each(|&(i, j, c)| add(i, c * x[j]));
        self.quadratic.iter().for_each(|&(i, j, k, c)| add(i, c * x[j] * x[k]));
        (value, size)
    }

    /// Taylor coefficients of orders `0..=order` of the solution through `x` and of a tangent vector `v`, by Cauchy's
    /// product for each entry of the tensor: `(k + 1) x_i[k+1] = sum c sum_s x_j[s] x_k[k-s]`.
    fn series(&self, x: &[f64], v: &[f64], order: usize) -> [Vec<Vec<f64>>; 2] {
        let (mut state, mut tangent) = (vec![x.to_vec()], vec![v.to_vec()]);
        for k in 0..order {
            let (mut next, mut d_next) = (vec![0.0; self.n], vec![0.0; self.n]);
            if k == 0 {
                self.constant.iter().for_each(|&(i, c)| next[i] += c);
            }
            for &(i, j, c) in &self.linear {
                next[i] += c * state[k][j];
                d_next[i] += c * tangent[k][j];
            }
            for &(i, j, l, c) in &self.quadratic {
                for s in 0..=k {
                    next[i] += c * state[s][j] * state[k - s][l];
                    d_next[i] += c * (tangent[s][j] * state[k - s][l] + state[s][j] * tangent[k - s][l]);
                }
            }
            state.push(next.iter().map(|value| value / (k + 1) as f64).collect());
            tangent.push(d_next.iter().map(|value| value / (k + 1) as f64).collect());
        }
        [state, tangent]
    }

    /// The same field with the absolute values of its entries: its series bounds the terms of every sum.
    fn majorant(&self) -> Tensor {
        Tensor {
            n: self.n,
            constant: self.constant.iter().map(|&(i, c)| (i, c.abs())).collect(),
            linear: self.linear.iter().map(|&(i, j, c)| (i, j, c.abs())).collect(),
            quadratic: self.quadratic.iter().map(|&(i, j, k, c)| (i, j, k, c.abs())).collect(),
        }
    }
}

/// `l' = l x omega + alpha x a + beta x b`, `alpha' = alpha x omega + epsilon beta x a`, `beta' = beta x omega`, entry by
/// entry, with `omega_i = l_i / I_i`.
fn tensor_of_top(p: &Parameters) -> Tensor {
    let mut tensor = Tensor { n: 9, ..Tensor::default() };
    for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
        for vector in [0, 3, 6] {
            tensor.quadratic.push((vector + i, vector + j, k, 1.0 / p.inertia[k]));
            tensor.quadratic.push((vector + i, vector + k, j, -1.0 / p.inertia[j]));
        }
        for (to, from, c) in [(0, 3, p.a), (0, 6, p.b), (3, 6, p.a.map(|a| p.epsilon * a))] {
            tensor.linear.push((to + i, from + j, c[k]));
            tensor.linear.push((to + i, from + k, -c[j]));
        }
    }
    tensor
}

/// Fields of up to 24 components; sparse, dense, and with few components in every product (stars of products).
fn tensors() -> impl Strategy<Value = Tensor> {
    (1..25_usize, 1..4_usize).prop_flat_map(|(n, kind)| {
        let coefficient = || -1.0..1.0_f64;
        let second = if kind == 1 { n.div_ceil(4) } else { n };
        let entries = if kind == 3 { 4 * n * n } else { 4 * n };
        (
            proptest::collection::vec((0..n, coefficient()), 0..3),
            proptest::collection::vec((0..n, 0..n, coefficient()), 0..2 * n),
            proptest::collection::vec((0..n, 0..n, 0..second, coefficient()), 0..entries),
        )
            .prop_map(move |(constant, linear, quadratic)| Tensor { n, constant, linear, quadratic })
    })
}

fn spread(n: usize, seed: f64) -> Vec<f64> {
    (0..n).map(|i| 2.0 * (((i as f64 + seed) * 0.618_033_988_75) % 1.0) - 1.0).collect()
}

/// Coefficients of the kernel: groups of orders `0..=order`.
fn kernel_series(field: &Quadratic, starts: &[Vec<f64>], order: usize) -> Vec<Vec<Vec<f64>>> {
    let (n, n_tangents) = (field.n_components(), starts.len() - 1);
    let row = field.row(n_tangents);
    let mut rows = vec![0.0_f64; (order + 1) * row];
    for (group, start) in starts.iter().enumerate() {
        rows[group * field.group()..][..n].copy_from_slice(start);
    }
    for k in 0..order {
        field.derive_work(&mut rows, n_tangents, k);
        field.extend(&mut rows, n_tangents, k);
    }
    let of_group =
        |group: usize| (0..=order).map(|k| rows[k * row + group * field.group()..][..n].to_vec()).collect::<Vec<_>>();
    (0..starts.len()).map(of_group).collect()
}

fn integrate(field: &Quadratic, states: &[f64], tangents: &[f64], times: &[f64], threads: usize, simd: Simd) -> Orbits {
    let n_tangents = tangents.len() / states.len();
    let method = Taylor::new(1e-13, None, 300).unwrap();
    let ensemble = Ensemble { field, method, states, tangents, n_tangents, times };
    orbits(&ensemble, threads, simd, &Control::default(), true, |_| ()).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    /// Every coefficient up to order 6, of the state and of up to three tangent vectors, against the recurrence without
    /// tiles. The majorant's coefficient bounds the sum of the absolute values of all terms, each rounded some tens of times.
    #[test]
    fn series_equals_cauchy_products(tensor in tensors(), n_tangents in 0..4_usize, seed in 0.0..100.0_f64) {
        let field = tensor.field();
        let starts: Vec<Vec<f64>> = (0..=n_tangents).map(|g| spread(tensor.n, seed + 31.0 * g as f64)).collect();
        let kernel = kernel_series(&field, &starts, 6);
        let absolute = |x: &[f64]| x.iter().map(|x| x.abs()).collect::<Vec<_>>();
        let majorant = tensor.majorant();
        for g in 0..=n_tangents {
            let v = &starts[g];
            let expected = &tensor.series(&starts[0], v, 6)[g.min(1)];
            let bounds = &majorant.series(&absolute(&starts[0]), &absolute(v), 6)[g.min(1)];
            for k in 0..=6 {
                for i in 0..tensor.n {
                    let (got, wanted, bound) = (kernel[g][k][i], expected[k][i], 1e-14 * bounds[k][i]);
                    prop_assert!((got - wanted).abs() <= bound, "group {g} order {k} component {i}: {got} {wanted} {bound}");
                }
            }
        }
    }

    #[test]
    fn first_coefficient_is_the_field(tensor in tensors(), seed in 0.0..100.0_f64) {
        let x = spread(tensor.n, seed);
        let (value, size) = tensor.evaluate(&x);
        let kernel = kernel_series(&tensor.field(), &[x], 1);
        for i in 0..tensor.n {
            prop_assert!((kernel[0][1][i] - value[i]).abs() <= 1e-14 * size[i], "{} {}", kernel[0][1][i], value[i]);
        }
    }

    #[test]
    fn tensor_of_the_top_equals_poisson_tensor_times_gradient(p in parameters(), x in vector9()) {
        let kernel = kernel_series(&tensor_of_top(&p).field(), std::slice::from_ref(&x), 1);
        let expected = p.hamiltonian_vector_field(&x);
        // as for the hand-written kernel: sums of up to 12 products of numbers up to 10
        prop_assert!(distance(&kernel[0][1], &expected) < 500.0 * f64::EPSILON, "{:?} {expected:?}", kernel[0][1]);
    }

    #[test]
    fn orbit_and_tangents_equal_those_of_the_hand_written_top(p in parameters(), x in vector9(), v in vector9()) {
        let times = [0.0, 1.0, 3.0];
        let hand_written = run(&p.top(), taylor(1e-15), &x, &v, &times, Simd::widest());
        let field = tensor_of_top(&p).field();
        let ensemble =
            Ensemble { field: &field, method: taylor(1e-15), states: &x, tangents: &v, n_tangents: 1, times: &times };
        let derived = orbits(&ensemble, 1, Simd::widest(), &Control::default(), false, |_| ()).unwrap();
        let size = |values: &[f64]| values.iter().fold(1.0_f64, |size, value| size.max(value.abs()));
        // errors of round-off grow at most as the tangent map of 3 time units, whose size grows with that of the state
        let (states, tangents) = (size(&hand_written.states), size(&hand_written.tangents));
        prop_assert!(distance(&derived.states, &hand_written.states) < 1e-11 * states.powi(3));
        prop_assert!(distance(&derived.tangents, &hand_written.tangents) < 1e-10 * states.powi(4) * tangents.powi(2));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Ensembles in which some trajectories blow up or start at numbers that are not finite.
    #[test]
    fn bits_do_not_depend_on_lanes_or_threads(
        tensor in tensors(), trajectories in 1..20_usize, n_tangents in 0..3_usize, bad in 0..20_usize,
        value in prop_oneof![Just(f64::NAN), Just(f64::INFINITY), Just(1e200), Just(0.0)],
    ) {
        let n = tensor.n;
        let mut states = spread(n * trajectories, 0.3);
        states[(bad % trajectories) * n] = value;
        let tangents = spread(n * trajectories * n_tangents, 7.1);
        let field = tensor.field();
        assert_same_bits(
            &everywhere(|simd, threads| integrate(&field, &states, &tangents, &[0.0, 0.1, 0.5], threads, simd)),
            true,
        );
    }
}

/// One component, `x' = x - x^2`: the logistic curve `x = 1 / (1 + (1/x0 - 1) exp(-t))`.
#[test]
fn logistic_equation_follows_the_logistic_curve() {
    let field = Quadratic::new(1, &[], &[(0, 0, 1.0)], &[(0, 0, 0, -1.0)]).unwrap();
    let orbit = integrate(&field, &[0.1], &[1.0], &[0.0, 5.0], 1, Simd::widest());
    let decay = (-5.0_f64).exp();
    let x = 1.0 / (1.0 + 9.0 * decay);
    assert!((orbit.states[1] - x).abs() < 1e-13, "{} {x}", orbit.states[1]);
    // dx/dx0 = exp(-t) (x / x0)^2
    let derivative = decay * (x / 0.1) * (x / 0.1);
    assert!((orbit.tangents[1] / derivative - 1.0).abs() < 1e-12, "{} {derivative}", orbit.tangents[1]);
}

/// `x' = 1 + x^2` is solved by `tan t`.
#[test]
fn constant_and_square_give_the_tangent_function() {
    let field = Quadratic::new(1, &[(0, 1.0)], &[], &[(0, 0, 0, 1.0)]).unwrap();
    let orbit = integrate(&field, &[0.0], &[], &[0.0, 1.2], 1, Simd::widest());
    assert!((orbit.states[1] / 1.2_f64.tan() - 1.0).abs() < 1e-13, "{}", orbit.states[1]);
}

/// No quadratic part: an oscillator pushed by a constant force, `x' = v`, `v' = 1 - x`, `x = 1 - cos t`.
#[test]
fn linear_field_is_integrated() {
    let field = Quadratic::new(2, &[(1, 1.0)], &[(0, 1, 1.0), (1, 0, -1.0)], &[]).unwrap();
    let orbit = integrate(&field, &[0.0, 0.0], &[1.0, 0.0], &[0.0, 7.0], 1, Simd::widest());
    assert!(distance(&orbit.states[2..], &[1.0 - 7.0_f64.cos(), 7.0_f64.sin()]) < 1e-13);
    assert!(distance(&orbit.tangents[2..], &[7.0_f64.cos(), -(7.0_f64.sin())]) < 1e-13);
}

/// `x_j x_k` and `x_k x_j` are one product, entries add up, and what cancels is not there: infinity times zero would show.
#[test]
fn entries_with_the_same_indices_add_up() {
    let entries = [(0, 0, 1, 0.25), (0, 1, 0, 0.5), (0, 1, 0, 0.25), (1, 2, 2, 3.0), (1, 2, 2, -3.0)];
    let field = Quadratic::new(3, &[(2, 1.0), (2, 1.0)], &[(1, 2, 1.0), (1, 2, -1.0)], &entries).unwrap();
    let series = kernel_series(&field, &[vec![3.0, 5.0, f64::INFINITY]], 1);
    assert_eq!(series[0][1], [15.0, 0.0, 2.0]);
}

/// Memory and time follow the entries, not the square of the number of components.
#[test]
fn a_field_of_a_million_components_with_few_products_is_made() {
    let n = 1 << 20;
    let entries: Vec<_> = (0..2000).map(|k| (k, 500 * k, 500 * k + 1, 1.0)).collect();
    let field = Quadratic::new(n, &[], &[(n - 1, 0, 1.0)], &entries).unwrap();
    assert_eq!(field.n_components(), n);
}

#[test]
fn entries_that_make_no_field_are_refused_by_name() {
    let refused =
        |n, constant: &[_], linear: &[_], quadratic: &[_]| Quadratic::new(n, constant, linear, quadratic).unwrap_err();
    for got in [0, 1 << 31, 1 << 62, usize::MAX] {
        assert_eq!(refused(got, &[], &[], &[]), Error::Components { got });
    }
    let index = |name, got| Error::ComponentIndex { name, n_components: 2, got };
    assert_eq!(refused(2, &[(2, 1.0)], &[], &[]), index("constant", 2));
    assert_eq!(refused(2, &[], &[(0, 5, 1.0)], &[]), index("linear", 5));
    assert_eq!(refused(2, &[], &[], &[(0, 0, 7, 1.0)]), index("quadratic", 7));
    let infinite = f64::INFINITY;
    assert_eq!(refused(2, &[], &[(0, 1, infinite)], &[]), Error::ParameterNotFinite { name: "linear", got: infinite });
    assert!(matches!(refused(2, &[(1, f64::NAN)], &[], &[]), Error::ParameterNotFinite { name: "constant", .. }));
    let huge = [(0, 0, 1, f64::MAX), (0, 1, 0, f64::MAX)];
    assert_eq!(refused(2, &[], &[], &huge), Error::ParameterNotFinite { name: "quadratic", got: infinite });
}
