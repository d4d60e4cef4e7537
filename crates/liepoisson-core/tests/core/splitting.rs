//! Splitting methods: Poisson maps that keep every Casimir, of the order that they claim, the same bits on every path.

use crate::common::*;
use liepoisson_core::analysis::lyapunov::finite_time_exponents;
use liepoisson_core::analysis::orbit::{Orbits, orbits};
use liepoisson_core::ensemble::{Control, Ensemble, Outcome};
use liepoisson_core::error::Error;
use liepoisson_core::field::{Noise, Noisy, Path, Ridge, Space, SplitTerms};
use liepoisson_core::lanes::Simd;
use liepoisson_core::method::{Method, Single, Splitting};
use proptest::prelude::*;

const ORDERS: [usize; 4] = [2, 4, 6, 8];

fn splitting(order: usize, step: f64) -> Splitting {
    Splitting::new(order, step, 10_000_000).unwrap()
}

/// Tops of every kind of inertia that has a flow of its own: general, spherical, each pair of equal moments.
fn tops() -> impl Strategy<Value = Parameters> {
    (parameters(), 0..5_usize).prop_map(|(mut p, kind)| {
        let [i1, i2, i3] = p.inertia;
        p.inertia = [[i1, i2, i3], [i1, i1, i1], [i1, i2, i2], [i1, i2, i1], [i1, i1, i3]][kind];
        p
    })
}

/// One top of each kind.
fn one_of_each() -> [Parameters; 5] {
    let inertias = [[1.9, 1.3, 0.8], [1.2, 1.2, 1.2], [0.7, 1.6, 1.6], [1.6, 0.7, 1.6], [2.0, 2.0, 1.0]];
    inertias.map(|inertia| Parameters { inertia, a: [-1.0, 0.3, 0.2], b: [0.0, 0.4, -0.3], epsilon: 0.8 })
}

fn order() -> impl Strategy<Value = usize> {
    proptest::sample::select(&ORDERS[..])
}

/// The unit vectors, as tangent vectors of one trajectory.
fn identity(n: usize) -> Vec<f64> {
    (0..n * n).map(|at| if at % (n + 1) == 0 { 1.0 } else { 0.0 }).collect()
}

/// Any field with any method, one thread.
fn integrate<F: Space, M: Method<F>>(field: &F, method: M, states: &[f64], tangents: &[f64], times: &[f64]) -> Orbits {
    let ensemble = Ensemble { field, method, states, tangents, n_tangents: tangents.len() / states.len(), times };
    orbits(&ensemble, 1, Simd::widest(), &Control::default(), false, |_| ()).unwrap()
}

/// The last state of a single trajectory.
fn end<F: Space, M: Method<F>>(field: &F, method: M, state: &[f64], times: &[f64]) -> Vec<f64> {
    let orbits = integrate(field, method, state, &[], times);
    orbits.states[orbits.states.len() - state.len()..].to_vec()
}

/// `J(x)` of the twisted top.
fn poisson_tensor(p: &Parameters, x: &[f64]) -> [[f64; 9]; 9] {
    let mut tensor = [[0.0; 9]; 9];
    for &(i, j, k, c) in &top_bracket(p.epsilon) {
        tensor[i][j] += c * x[k];
    }
    tensor
}

/// `{x_i, x_j} = c x_k` of the twisted top: `u^ v = u x v`, so the block of u has `u_k` with minus the sign of `ijk`.
fn top_bracket(epsilon: f64) -> Vec<(usize, usize, usize, f64)> {
    let mut bracket = Vec::new();
    for (row, column, block, factor) in
        [(0, 0, 0, 1.0), (0, 1, 1, 1.0), (1, 0, 1, 1.0), (0, 2, 2, 1.0), (2, 0, 2, 1.0), (1, 1, 2, epsilon)]
    {
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            bracket.push((3 * row + i, 3 * column + j, 3 * block + k, -factor));
            bracket.push((3 * row + j, 3 * column + i, 3 * block + k, factor));
        }
    }
    bracket
}

/// Largest size of a product of components, the scale of the Casimirs.
fn scale(states: &[f64]) -> f64 {
    states.iter().fold(1.0, |largest: f64, x| largest.max(x.abs())).powi(2)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn casimirs_are_kept_to_round_off_for_any_step(p in tops(), x in vector9(), order in order(), step in 0.001..5.0_f64) {
        let times: Vec<f64> = (0..=10).map(|k| f64::from(k) * step).collect();
        let orbits = integrate(&p.top(), splitting(order, step), &x, &[], &times);
        let start = p.casimirs(&x);
        // 17 stages with up to five rotations, each of which rounds nine components some ten times
        let bound = 1e-13 * scale(&orbits.states);
        for state in orbits.states.chunks_exact(9) {
            prop_assert!(distance(&p.casimirs(state), &start) < bound, "{:?} {:?} {bound:e}", p.casimirs(state), start);
        }
    }

    /// `D J(x) D^T = J(phi(x))`
    #[test]
    fn a_step_is_a_poisson_map(p in tops(), x in vector9(), order in order(), step in 0.01..1.0_f64) {
        let orbits = integrate(&p.top(), splitting(order, step), &x, &identity(9), &[0.0, step]);
        let (before, after) = (poisson_tensor(&p, &x), poisson_tensor(&p, &orbits.states[9..]));
        // row k: the image of the unit vector k, column k of D
        let image: Vec<&[f64]> = orbits.tangents[81..].chunks_exact(9).collect();
        let size = image.iter().flat_map(|v| v.iter()).fold(1.0, |size: f64, v| size.max(v.abs()));
        let bound = 2e-13 * size * size * scale(&orbits.states);
        for i in 0..9 {
            for j in 0..9 {
                let mut sum = 0.0;
                for k in 0..9 {
                    for m in 0..9 {
                        sum += image[k][i] * before[k][m] * image[m][j];
                    }
                }
                prop_assert!((sum - after[i][j]).abs() < bound, "{i} {j}: {sum} {} {bound:e}", after[i][j]);
            }
        }
    }

    #[test]
    fn running_backwards_returns_to_the_start(p in tops(), x in vector9(), order in order(), step in 0.01..0.5_f64) {
        let (top, method) = (p.top(), splitting(order, step));
        let there = end(&top, method, &x, &[0.0, 4.0 * step]);
        let back = end(&top, method, &there, &[4.0 * step, 0.0]);
        // errors grow with the orbits' instability, at most a few digits in this time
        prop_assert!(distance(&back, &x) < 1e-11 * scale(&there), "{}", distance(&back, &x));
    }

    /// Against central differences of the map itself, whose error is `d^2` and `1e-16 / d`.
    #[test]
    fn tangent_vectors_are_the_derivative_of_the_numerical_map(
        p in tops(), x in vector9(), v in vector9(), order in order(), step in 0.05..2.0_f64,
    ) {
        let (top, method, d) = (p.top(), splitting(order, step), 1e-5);
        let times = [0.0, step];
        let orbits = integrate(&top, method, &x, &v, &times);
        let moved = |sign: f64| -> Vec<f64> { x.iter().zip(&v).map(|(x, v)| x + sign * d * v).collect() };
        let (plus, minus) = (end(&top, method, &moved(1.0), &times), end(&top, method, &moved(-1.0), &times));
        let size = orbits.tangents.iter().fold(1.0, |size: f64, v| size.max(v.abs()));
        for i in 0..9 {
            let difference = (plus[i] - minus[i]) / (2.0 * d);
            // third derivatives grow with the third power of the growth of first ones
            let bound = 1e-7 * size.powi(3) * scale(&orbits.states);
            prop_assert!((difference - orbits.tangents[9 + i]).abs() < bound, "{i}: {difference} {}", orbits.tangents[9 + i]);
        }
    }

    #[test]
    fn small_steps_agree_with_the_power_series(p in tops(), x in vector9(), v in vector9(), order in 1..4_usize) {
        let (top, times) = (p.top(), [0.0, 0.3, 1.0]);
        let series = integrate(&top, taylor(1e-15), &x, &v, &times);
        let split = integrate(&top, splitting(ORDERS[order], 0.005), &x, &v, &times);
        let size = series.tangents.iter().fold(1.0, |size: f64, v| size.max(v.abs())) * scale(&series.states).powi(2);
        let bound = [0.0, 1e-8, 1e-12, 1e-12][order] * size;
        prop_assert!(distance(&series.states, &split.states) < bound, "{} {bound:e}", distance(&series.states, &split.states));
        prop_assert!(distance(&series.tangents, &split.tangents) < bound, "{}", distance(&series.tangents, &split.tangents));
    }

    /// Each flow rounds, and the tops of this test amplify what is rounded by less than a hundred in this time.
    #[test]
    fn single_precision_agrees_within_its_round_off(p in tops(), x in vector9(), v in vector9(), order in order()) {
        let (top, times, method) = (p.top(), [0.0, 0.3, 1.0], splitting(order, 0.1));
        let double = integrate(&top, method, &x, &v, &times);
        let single = integrate(&top, Single(method), &x, &v, &times);
        let size = double.tangents.iter().fold(1.0, |size: f64, v| size.max(v.abs())) * scale(&double.states).powi(2);
        let bound = 100.0 * f64::from(f32::EPSILON) * size;
        prop_assert!(distance(&double.states, &single.states) < bound, "{}", distance(&double.states, &single.states));
        prop_assert!(distance(&double.tangents, &single.tangents) < bound, "{}", distance(&double.tangents, &single.tangents));
    }
}

/// The numerical solution is the exact one of a nearby energy, so the error oscillates instead of growing.
#[test]
fn energy_error_stays_bounded_over_a_hundred_thousand_steps() {
    let times: Vec<f64> = (0..=1_000).map(|k| f64::from(k) * 20.0).collect();
    for p in one_of_each() {
        let x = &starts(2)[9..18];
        let orbits = integrate(&p.top(), splitting(4, 0.2), x, &[], &times);
        let errors: Vec<f64> = orbits.states.chunks_exact(9).map(|y| (p.energy(y) - p.energy(x)).abs()).collect();
        let largest = |part: &[f64]| part.iter().copied().fold(0.0, f64::max);
        let (early, late) = (largest(&errors[..101]), largest(&errors[900..]));
        assert!(late < 2.0 * early && early < 1e-3, "{early:e} in the first tenth, {late:e} in the last");
    }
}

/// Times that no equal step divides; the last step before each is as long as it has to be.
#[test]
fn wanted_times_are_landed_on() {
    let times = [0.0, 0.123_456, 0.5, 0.500_001, 7.77, 8.0];
    for p in one_of_each() {
        let x = &starts(2)[..9];
        let split = integrate(&p.top(), splitting(6, 0.02), x, &[], &times);
        let series = integrate(&p.top(), taylor(1e-15), x, &[], &times);
        assert!(distance(&split.states, &series.states) < 1e-9, "{:e}", distance(&split.states, &series.states));
        let summary = &split.summaries[0];
        // ceil of each interval over the step: 7, 19, 1, 364, 12
        assert_eq!((summary.outcome, summary.time, summary.n_steps), (Outcome::Finished, 8.0, 403));
    }
}

/// Says where the first difference is.
fn assert_same_bits(what: &str, a: &[f64], b: &[f64]) {
    let difference = bits(a).iter().zip(bits(b)).position(|(a, b)| *a != b);
    assert!(difference.is_none(), "{what}: {difference:?} {:e} {:e}", a[difference.unwrap()], b[difference.unwrap()]);
}

/// All instruction sets and numbers of threads, and each trajectory alone, give the same bits.
fn check_bits<F: Space, M: Method<F>>(field: &F, method: M, states: &[f64], tangents: &[f64], n_tangents: usize) {
    let times = [0.0, 0.7, 12.0];
    let ensemble = |states, tangents| Ensemble { field, method, states, tangents, n_tangents, times: &times };
    let all = ensemble(states, tangents);
    let reference = orbits(&all, 1, Simd::Scalar, &Control::default(), false, |_| ()).unwrap();
    let reference_exponents = finite_time_exponents(&all, 1, Simd::Scalar, &Control::default(), |_| ());
    for simd in Simd::ALL.into_iter().filter(|simd| simd.is_available()) {
        for threads in [1, 3] {
            let other = orbits(&all, threads, simd, &Control::default(), false, |_| ()).unwrap();
            assert_same_bits("state", &reference.states, &other.states);
            assert_same_bits("tangent", &reference.tangents, &other.tangents);
            for (a, b) in reference.summaries.iter().zip(&other.summaries) {
                assert_eq!((a.outcome, a.n_steps, a.time.to_bits()), (b.outcome, b.n_steps, b.time.to_bits()));
                assert_same_bits("last state", &a.state, &b.state);
            }
            if let Ok(exponents_there) = finite_time_exponents(&all, threads, simd, &Control::default(), |_| ()) {
                assert_same_bits(
                    "exponent",
                    &reference_exponents.as_ref().unwrap().exponents,
                    &exponents_there.exponents,
                );
            }
        }
    }
    let n = field.n_components();
    for trajectory in 0..all.n_trajectories() {
        let tangents = &tangents[trajectory * n_tangents * n..][..n_tangents * n];
        let alone = ensemble(&states[trajectory * n..][..n], tangents);
        let alone = orbits(&alone, 1, Simd::widest(), &Control::default(), false, |_| ()).unwrap();
        assert_same_bits("state alone", &alone.states, &reference.states[3 * n * trajectory..][..3 * n]);
        assert_eq!(alone.summaries[0].n_steps, reference.summaries[trajectory].n_steps);
    }
}

/// Numbers that are not finite, too large, or so large that the numbers overflow after some steps.
fn bad_numbers() -> impl Strategy<Value = f64> {
    proptest::sample::select(&[f64::NAN, f64::INFINITY, 1e300, 1e-300, 1e150, 1e5, 40.0, -0.0][..])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    #[test]
    fn bits_do_not_depend_on_lanes_threads_or_neighbours(
        p in tops(), trajectories in 1..24_usize, order in order(), step in 0.1..2.0_f64, n_tangents in 0..3_usize,
        bad in proptest::collection::vec((0..24_usize, 0..9_usize, bad_numbers()), 0..6),
    ) {
        let mut states = starts(trajectories);
        let tangents: Vec<f64> = starts(n_tangents * trajectories).iter().rev().copied().collect();
        for (trajectory, component, value) in bad {
            states[(trajectory % trajectories) * 9 + component] = value;
        }
        check_bits(&p.top(), splitting(order, step), &states, &tangents, n_tangents);
        check_bits(&p.top(), Single(splitting(order, step)), &states, &tangents, n_tangents);
    }

    #[test]
    fn bits_of_split_terms_do_not_depend_on_lanes_threads_or_neighbours(
        p in parameters(), trajectories in 1..12_usize,
        bad in proptest::collection::vec((0..12_usize, 0..9_usize, bad_numbers()), 0..3),
    ) {
        let mut states = starts(trajectories);
        let tangents: Vec<f64> = starts(trajectories).iter().rev().copied().collect();
        for (trajectory, component, value) in bad {
            states[(trajectory % trajectories) * 9 + component] = value;
        }
        check_bits(&split_terms_of_top(&p), splitting(2, 0.9), &states, &tangents, 1);
        check_bits(&split_terms_of_top(&p), Single(splitting(2, 0.9)), &states, &tangents, 1);
    }
}

/// A trajectory ends at its last good step, its neighbours go on.
#[test]
fn failing_trajectories_have_outcomes_and_do_not_touch_their_neighbours() {
    let top = TWISTED_KOVALEVSKAYA.top();
    let good = starts(20);
    let mut states = good.clone();
    states[9 * 3] = f64::NAN;
    states[9 * 4 + 1] = f64::INFINITY;
    states[9 * 5 + 4] = 1e156; // drives l, far from any orbit at this step, until |tau l|^2 overflows
    let times = [0.0, 1.0, 100.0];
    let orbits = integrate(&top, splitting(4, 0.1), &states, &[], &times);
    let reference = integrate(&top, splitting(4, 0.1), &good, &[], &times);
    for trajectory in 0..20 {
        let (summary, rows) = (&orbits.summaries[trajectory], &orbits.states[27 * trajectory..27 * trajectory + 27]);
        match trajectory {
            3 | 4 => {
                assert_eq!((summary.outcome, summary.time, summary.n_steps), (Outcome::NotFinite, 0.0, 0));
                assert_eq!(bits(&summary.state), bits(&states[9 * trajectory..9 * trajectory + 9]));
            }
            5 => {
                assert_eq!(summary.outcome, Outcome::NotFinite);
                assert!(summary.n_steps > 0, "{}", summary.n_steps);
                assert!(summary.state.iter().all(|x| x.is_finite()));
            }
            _ => {
                assert_eq!(summary.outcome, Outcome::Finished);
                assert_eq!(rows, &reference.states[27 * trajectory..27 * trajectory + 27]);
            }
        }
    }
}

/// Growth by exp(100 sqrt 2) overflows no number in single precision: powers of two are taken out in time.
#[test]
fn growth_beyond_the_largest_number_is_followed_in_single_precision() {
    let top = TWISTED_KOVALEVSKAYA.top();
    let unstable = [0.0, 0.0, 0.0, -2.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let tangents = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let method = Single(splitting(4, 0.1));
    let ensemble =
        Ensemble { field: &top, method, states: &unstable, tangents: &tangents, n_tangents: 1, times: &[0.0, 100.0] };
    let found = finite_time_exponents(&ensemble, 1, Simd::widest(), &Control::default(), |_| ()).unwrap();
    // l3 = cosh(t sqrt 2), alpha2 = -sqrt 2 sinh(t sqrt 2): |v| = exp(t sqrt 2) sqrt(3) / 2
    let expected = 2.0_f64.sqrt() + (3.0_f64.sqrt() / 2.0).ln() / 100.0;
    assert!((found.exponents[0] - expected).abs() < 1e-5, "{} {expected}", found.exponents[0]);
}

#[test]
fn a_budget_of_steps_is_kept() {
    let method = Splitting::new(2, 0.1, 100).unwrap();
    let orbits = integrate(&TWISTED_KOVALEVSKAYA.top(), method, &starts(3), &[], &[0.0, 1.0, 50.0]);
    for summary in orbits.summaries {
        assert_eq!((summary.outcome, summary.n_steps), (Outcome::MaxSteps, 100));
        assert!((summary.time - 10.0).abs() < 1e-12);
    }
}

#[test]
fn parameters_out_of_range_are_refused() {
    for order in [0, 1, 3, 5, 7, 9, 10] {
        assert_eq!(Splitting::new(order, 0.1, 1), Err(Error::SplittingOrder { got: order }));
    }
    for step in [0.0, -0.1, f64::INFINITY] {
        assert_eq!(Splitting::new(4, step, 1), Err(Error::StepSize { got: step }));
    }
    assert!(Splitting::new(4, f64::NAN, 1).is_err());
    let split_term = |form, generator, derivative| vec![Ridge { form, generator, derivative }];
    let number = |name, got| Err(Error::ParameterNotFinite { name, got });
    let index = |name| Err(Error::ComponentIndex { name, n_components: 2, got: 2 });
    assert_eq!(SplitTerms::new(0, vec![]), Err(Error::Components { got: 0 }));
    assert_eq!(SplitTerms::new(2, split_term(vec![(2, 1.0)], vec![], vec![])), index("form"));
    assert_eq!(SplitTerms::new(2, split_term(vec![], vec![(1, 2, 1.0)], vec![])), index("generator"));
    let infinite = f64::INFINITY;
    assert_eq!(SplitTerms::new(2, split_term(vec![(0, infinite)], vec![], vec![])), number("form", infinite));
    assert_eq!(SplitTerms::new(2, split_term(vec![], vec![(0, 0, infinite)], vec![])), number("generator", infinite));
    assert_eq!(SplitTerms::new(2, split_term(vec![], vec![], vec![infinite])), number("derivative", infinite));
}

/// `a.alpha + b.beta` and the three `l_i^2 / (2 I_i)`, in the order in which the top composes them.
fn split_terms_of_top(p: &Parameters) -> SplitTerms {
    let bracket = top_bracket(p.epsilon);
    let potential = (0..3).flat_map(|i| [(3 + i, p.a[i]), (6 + i, p.b[i])]).collect();
    let axes = (0..3).map(|i| Ridge::of_bracket(&bracket, vec![(i, 1.0)], vec![0.0, 1.0 / p.inertia[i]]));
    let ridges = [Ridge::of_bracket(&bracket, potential, vec![1.0])].into_iter().chain(axes).collect();
    SplitTerms::new(9, ridges).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// Two codes for the same composition of flows.
    #[test]
    fn split_terms_of_a_top_agree_with_the_top(p in parameters(), x in vector9(), v in vector9(), order in order()) {
        let times = [0.0, 0.7, 2.0];
        let top = integrate(&p.top(), splitting(order, 0.3), &x, &v, &times);
        let split_terms = integrate(&split_terms_of_top(&p), splitting(order, 0.3), &x, &v, &times);
        let size = top.tangents.iter().fold(1.0, |size: f64, v| size.max(v.abs())) * scale(&top.states).powi(2);
        prop_assert!(distance(&top.states, &split_terms.states) < 1e-12 * size, "{}", distance(&top.states, &split_terms.states));
        prop_assert!(distance(&top.tangents, &split_terms.tangents) < 1e-12 * size, "{}", distance(&top.tangents, &split_terms.tangents));
    }
}

/// The rigid body in four dimensions with a quartic term: components of so(4) are `m_ab`, a < b, with
/// `{m_ab, m_cd} = d_bc m_ad - d_ac m_bd - d_bd m_ac + d_ad m_bc`.
fn four_dimensional_body() -> SplitTerms {
    let pairs = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)];
    let component = |a: usize, b: usize| {
        let at = |a, b| pairs.iter().position(|&pair| pair == (a, b));
        at(a, b).map(|k| (k, 1.0)).or(at(b, a).map(|k| (k, -1.0)))
    };
    let mut bracket = Vec::new();
    for (i, &(a, b)) in pairs.iter().enumerate() {
        for (j, &(c, d)) in pairs.iter().enumerate() {
            for (equal, m, sign) in
                [(b == c, (a, d), 1.0), (a == c, (b, d), -1.0), (b == d, (a, c), -1.0), (a == d, (b, c), 1.0)]
            {
                if let Some((k, value)) = component(m.0, m.1).filter(|_| equal) {
                    bracket.push((i, j, k, sign * value));
                }
            }
        }
    }
    let mut ridges: Vec<Ridge> =
        (0..6).map(|i| Ridge::of_bracket(&bracket, vec![(i, 1.0)], vec![0.0, 1.0 / (1.0 + 0.3 * i as f64)])).collect();
    ridges.push(Ridge::of_bracket(&bracket, vec![(0, 0.5), (3, -0.4), (5, 0.3)], vec![0.0, 0.0, 0.0, 0.7]));
    SplitTerms::new(6, ridges).unwrap()
}

/// `sum (m_i^2 / (2 J_i))` and a quarter of 0.7 times the fourth power of the form of the last split term.
fn energy_of_body(m: &[f64]) -> f64 {
    let quadratic: f64 = (0..6).map(|i| m[i] * m[i] / (2.0 * (1.0 + 0.3 * i as f64))).sum();
    quadratic + 0.7 / 4.0 * (0.5 * m[0] - 0.4 * m[3] + 0.3 * m[5]).powi(4)
}

/// `sum m_ab^2` and the Pfaffian `m_01 m_23 - m_02 m_13 + m_03 m_12`.
#[test]
fn split_terms_on_so_4_keep_both_casimirs_and_a_nearby_energy() {
    let casimirs = |m: &[f64]| [m.iter().map(|x| x * x).sum::<f64>(), m[0] * m[5] - m[1] * m[4] + m[2] * m[3]];
    let (body, m) = (four_dimensional_body(), [0.9, -0.3, 0.5, 0.8, 0.2, -0.7]);
    let times: Vec<f64> = (0..=100).map(|k| f64::from(k) * 10.0).collect();
    for order in ORDERS {
        let orbits = integrate(&body, splitting(order, 0.25), &m, &[], &times);
        let mut errors = Vec::new();
        for state in orbits.states.chunks_exact(6) {
            assert!(distance(&casimirs(state), &casimirs(&m)) < 1e-11, "order {order}");
            errors.push((energy_of_body(state) - energy_of_body(&m)).abs());
        }
        let largest = |part: &[f64]| part.iter().copied().fold(1e-12, f64::max);
        let bound = [1e-2, 1e-4, 1e-5, 1e-5][order / 2 - 1];
        assert!(largest(&errors) < bound, "order {order}: {:e}", largest(&errors));
        assert!(largest(&errors[50..]) < 2.0 * largest(&errors[..50]), "order {order}");
    }
}

/// With `F''` in play: the derivative of the map against central differences, and the order against a small step.
#[test]
fn split_terms_on_so_4_have_the_right_derivative_and_order() {
    let (body, m, d) = (four_dimensional_body(), [0.9, -0.3, 0.5, 0.8, 0.2, -0.7], 1e-5);
    let times = [0.0, 1.5];
    let orbits = integrate(&body, splitting(4, 0.5), &m, &identity(6), &times);
    for k in 0..6 {
        let moved = |sign: f64| -> [f64; 6] { std::array::from_fn(|i| if i == k { m[i] + sign * d } else { m[i] }) };
        let (plus, minus) =
            (end(&body, splitting(4, 0.5), &moved(1.0), &times), end(&body, splitting(4, 0.5), &moved(-1.0), &times));
        for i in 0..6 {
            let difference = (plus[i] - minus[i]) / (2.0 * d);
            assert!((difference - orbits.tangents[36 + 6 * k + i]).abs() < 1e-8);
        }
    }
    let exact = end(&body, splitting(8, 0.005), &m, &times);
    for order in [2, 4, 6] {
        let error = |step: f64| distance(&end(&body, splitting(order, step), &m, &times), &exact);
        let slope = (error(0.1) / error(0.05)).log2();
        assert!((slope - order as f64).abs() < 0.3, "order {order}: {slope}");
    }
}

/// A flow of one split term is exact, whatever the step and its length: rotation about an axis by many turns.
#[test]
fn one_split_term_is_solved_exactly() {
    let p = TWISTED_KOVALEVSKAYA;
    let axis = Ridge::of_bracket(&top_bracket(p.epsilon), vec![(2, 1.0)], vec![0.0, 2.0]);
    let x = [0.3, -0.2, 0.9, 1.0, 0.0, 0.4, 0.2, 0.1, -0.5];
    let got = end(&SplitTerms::new(9, vec![axis]).unwrap(), splitting(2, 100.0), &x, &[0.0, 100.0]);
    // u' = u x e3 angle': u1 = u1(0) cos + u2(0) sin, u2 = u2(0) cos - u1(0) sin
    let (sine, cosine) = (100.0 * 2.0 * 0.9_f64).sin_cos();
    for at in [0, 3, 6] {
        let expected = [x[at] * cosine + x[at + 1] * sine, x[at + 1] * cosine - x[at] * sine, x[at + 2]];
        assert!(distance(&got[at..at + 3], &expected) < 1e-12, "{got:?} {expected:?}");
    }
}

/// A free rigid body of unequal moments that a linear and a quadratic Hamiltonian shake, damped.
fn noisy_body(damping: f64, path: Path) -> Noisy<SplitTerms> {
    let bracket: Vec<(usize, usize, usize, f64)> =
        (0..3).flat_map(|i| [(i, (i + 1) % 3, (i + 2) % 3, -1.0), ((i + 1) % 3, i, (i + 2) % 3, 1.0)]).collect();
    let ridge =
        |form: &[(usize, f64)], derivative: &[f64]| Ridge::of_bracket(&bracket, form.to_vec(), derivative.to_vec());
    let terms = |ridges: Vec<Ridge>| SplitTerms::new(3, ridges).unwrap();
    let energy = terms((0..3).map(|i| ridge(&[(i, 1.0)], &[0.0, 1.0 / (1.0 + i as f64)])).collect());
    let channels =
        vec![terms(vec![ridge(&[(0, 0.7), (2, 0.2)], &[1.0])]), terms(vec![ridge(&[(1, 1.0)], &[0.1, 0.8])])];
    Noisy::new(energy.clone(), Noise::new(channels, Some((energy, damping)), path).unwrap()).unwrap()
}

fn path() -> Path {
    Path { key: [3, 5], first: 0, n_before: 0, n_increments: 1 }
}

#[test]
fn noise_and_damping_keep_the_casimir_and_tangent_vectors_are_derivatives() {
    let (field, start, times) = (noisy_body(2.0, path()), [0.48, 0.6, 0.64], [0.0, 1.0]);
    let found = integrate(&field, splitting(2, 0.1), &start, &identity(3), &times);
    let length: f64 = found.states[3..].iter().map(|x| x * x).sum();
    assert!((length - 1.0).abs() < 1e-14, "{length}");
    let moved = |j: usize, by: f64| {
        let mut x = start;
        x[j] += by;
        end(&field, splitting(2, 0.1), &x, &times)
    };
    for j in 0..3 {
        let (plus, minus) = (moved(j, 1e-6), moved(j, -1e-6));
        for i in 0..3 {
            // the second differences are of order one, those of the third 1e-12
            let (difference, derivative) = ((plus[i] - minus[i]) / 2e-6, found.tangents[9 + 3 * j + i]);
            assert!((difference - derivative).abs() < 1e-8, "{i} {j}: {difference} {derivative}");
        }
    }
}

#[test]
fn a_path_depends_on_trajectory_and_step_alone() {
    let states: Vec<f64> = (0..11).flat_map(|k| [0.6, 0.8, 0.1 * f64::from(k)]).collect();
    let whole = integrate(&noisy_body(1.0, path()), splitting(4, 0.1), &states, &[], &[0.0, 1.0, 3.0]);
    for k in [0, 4, 10] {
        let first = Path { first: k as u64, ..path() };
        let alone = integrate(&noisy_body(1.0, first), splitting(4, 0.1), &states[3 * k..][..3], &[], &[0.0, 1.0, 3.0]);
        assert_eq!(alone.states, whole.states[9 * k..][..9], "trajectory {k}");
        let onward = Path { n_before: 10, ..first };
        let later = end(&noisy_body(1.0, onward), splitting(4, 0.1), &alone.states[3..6], &[1.0, 3.0]);
        assert_eq!(later, alone.states[6..], "trajectory {k}, gone on with");
    }
    let rotations = |n_increments: u32, step: f64| {
        let turn = Ridge { form: vec![(0, 1.0)], generator: vec![(1, 2, 1.0), (2, 1, -1.0)], derivative: vec![1.0] };
        let axis = SplitTerms::new(3, vec![turn]).unwrap();
        let noise = Noise::new(vec![axis], None, Path { n_increments, ..path() }).unwrap();
        end(
            &Noisy::new(SplitTerms::new(3, vec![]).unwrap(), noise).unwrap(),
            splitting(2, step),
            &states[..3],
            &[0.0, 4.0],
        )
    };
    let (fine, coarse) = (rotations(1, 0.25), rotations(4, 1.0));
    assert!(fine.iter().zip(&coarse).all(|(a, b)| (a - b).abs() < 1e-14), "{fine:?} {coarse:?}");
    assert!((fine[1] - states[1]).abs() > 0.01, "{fine:?}");
}
