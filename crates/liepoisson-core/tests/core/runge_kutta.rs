//! The Runge-Kutta method of order 8: its order, its tolerance, single precision, failures, the same bits everywhere.

use crate::common::*;
use liepoisson_core::analysis::lyapunov::finite_time_exponents;
use liepoisson_core::analysis::orbit::{Orbits, orbits};
use liepoisson_core::ensemble::{Control, Ensemble, Outcome};
use liepoisson_core::error::Error;
use liepoisson_core::lanes::Simd;
use liepoisson_core::method::{Method, RungeKutta, Single};
use proptest::prelude::*;

const GENERAL: Parameters =
    Parameters { inertia: [1.3, 0.7, 2.1], a: [0.4, -0.9, 0.3], b: [-0.2, 0.5, 0.8], epsilon: 0.7 };

pub fn adaptive(tolerance: f64) -> RungeKutta {
    RungeKutta::new(tolerance, 1_000_000).unwrap()
}

pub fn fixed(step: f64) -> RungeKutta {
    RungeKutta::fixed(step, u64::MAX).unwrap()
}

pub fn single(method: RungeKutta) -> Single<RungeKutta> {
    Single::<RungeKutta>::new(method).unwrap()
}

/// Orbits on every instruction set, on one thread and on three.
pub fn integrate_all<F: liepoisson_core::field::Space, M: Method<F>>(
    field: &F,
    method: M,
    states: &[f64],
    tangents: &[f64],
) -> Vec<Orbits> {
    let n_tangents = tangents.len() / states.len();
    let ensemble = Ensemble { field, method, states, tangents, n_tangents, times: &[0.0, 0.7, 3.0] };
    everywhere(|simd, threads| orbits(&ensemble, threads, simd, &Control::default(), false, |_| ()).unwrap())
}

/// Largest relative error of the states and of the tangent vectors, against the Taylor method at 1e-15.
fn errors<M: Method<liepoisson_core::field::Top>>(p: &Parameters, method: M, times: &[f64]) -> (f64, f64) {
    let (states, tangents) = (starts(8), starts(9)[9..].to_vec());
    let ours = run(&p.top(), method, &states, &tangents, times, Simd::widest());
    let exact = run(&p.top(), taylor(1e-15), &states, &tangents, times, Simd::widest());
    assert!(ours.summaries.iter().all(|summary| summary.outcome == Outcome::Finished));
    let relative = |u: &[f64], v: &[f64]| distance(u, v) / v.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
    (relative(&ours.states, &exact.states), relative(&ours.tangents, &exact.tangents))
}

/// Errors grow exponentially on these orbits, by some 10 in the first 10 units of time.
#[test]
fn global_error_follows_the_tolerance() {
    for exponent in [4, 6, 8, 10, 12] {
        let tolerance = 10.0_f64.powi(-exponent);
        let (state, tangent) = errors(&TWISTED_KOVALEVSKAYA, adaptive(tolerance), &[0.0, 10.0]);
        assert!(state < 30.0 * tolerance && tangent < 100.0 * tolerance, "{tolerance:e}: {state:e} {tangent:e}");
        assert!(state > 1e-3 * tolerance, "{tolerance:e}: {state:e}, too much work");
    }
}

#[test]
fn single_precision_reaches_its_round_off() {
    let p = TWISTED_KOVALEVSKAYA;
    for (tolerance, bound) in [(1e-4, 3e-3), (1e-6, 3e-4)] {
        let (state, tangent) = errors(&p, single(adaptive(tolerance)), &[0.0, 10.0]);
        assert!(state < bound && tangent < 3.0 * bound, "{tolerance:e}: {state:e} {tangent:e}");
    }
    let (state, _) = errors(&p, single(fixed(0.2)), &[0.0, 10.0]);
    assert!(state < 3e-4, "{state:e}");
}

/// Rows at each wanted time equal those of a run that wants nothing in between, up to the tolerance; and the clock is
/// exact: a run that ends there has the last time itself.
#[test]
fn trajectories_land_on_wanted_times_in_both_directions() {
    let top = TWISTED_KOVALEVSKAYA.top();
    let (states, tangents) = (starts(3), starts(4)[9..].to_vec());
    for method in [adaptive(1e-11), fixed(0.07)] {
        for times in [[0.0, 0.01, 1.0, 1.001, 7.3], [2.0, 1.99, 0.1, -0.1, -6.0]] {
            let ours = run(&top, method, &states, &tangents, &times, Simd::widest());
            let exact = run(&top, taylor(1e-15), &states, &tangents, &times, Simd::widest());
            assert!(distance(&ours.states, &exact.states) < 1e-9, "{:e}", distance(&ours.states, &exact.states));
            assert!(distance(&ours.tangents, &exact.tangents) < 1e-8);
            for summary in &ours.summaries {
                assert_eq!((summary.outcome, summary.time), (Outcome::Finished, times[4]));
            }
        }
    }
}

#[test]
fn steps_recover_after_a_wanted_time() {
    let top = TWISTED_KOVALEVSKAYA.top();
    let n_steps = |times: &[f64]| run(&top, adaptive(1e-8), &starts(1), &[], times, Simd::Scalar).summaries[0].n_steps;
    let mut with_many = vec![0.0];
    with_many.extend((1..=20).flat_map(|k| [f64::from(k) - 1e-6, f64::from(k)]));
    // one extra step for each of the 20 short intervals, and about one for each landing
    assert!(n_steps(&with_many) < n_steps(&[0.0, 20.0]) + 45, "{}", n_steps(&with_many));
}

/// A drift of the energy by rounding: 2^18 steps of 1/2048, whose truncation errors are far below round-off.
#[test]
fn compensated_summation_reduces_the_drift_of_short_steps() {
    let p = GENERAL;
    let states = starts(8);
    let drift = |method: RungeKutta| {
        let orbits = run(&p.top(), method, &states, &[], &[0.0, 128.0], Simd::widest());
        let errors = orbits.states.chunks(18).map(|rows| (p.energy(&rows[9..]) / p.energy(&rows[..9]) - 1.0).abs());
        (errors.sum::<f64>() / 8.0, orbits.summaries[0].n_steps)
    };
    let step = 1.0 / 2048.0;
    let ((plain, n_steps), (compensated, _)) = (drift(fixed(step)), drift(fixed(step).compensated()));
    assert_eq!(n_steps, 1 << 18);
    assert!(compensated < 0.1 * plain, "{plain:e} {compensated:e}");
    assert!(compensated < 4e-15, "{compensated:e}");
}

#[test]
fn tolerances_and_steps_outside_their_ranges_are_refused() {
    for got in [0.0, 1e-17, 0.2, f64::NAN] {
        assert!(matches!(RungeKutta::new(got, 1), Err(Error::Tolerance { .. })), "{got}");
    }
    for got in [0.0, -1.0, f64::INFINITY, f64::NAN] {
        assert!(matches!(RungeKutta::fixed(got, 1), Err(Error::StepSize { .. })), "{got}");
    }
    let refused = Single::<RungeKutta>::new(adaptive(1e-7));
    assert_eq!(refused, Err(Error::SingleTolerance { got: 1e-7 }));
    assert!(refused.unwrap_err().to_string().contains("single precision"));
}

/// Trajectories that fail in various ways, at the start or on the way; their neighbours have the bits of a run without them.
#[test]
fn failing_trajectories_have_outcomes_and_do_not_touch_their_neighbours() {
    fn check<M: Method<liepoisson_core::field::Top>>(method: M) {
        let top = TWISTED_KOVALEVSKAYA.top();
        let good = starts(20);
        let mut states = good.clone();
        (states[9 * 3], states[9 * 4 + 1]) = (f64::NAN, f64::INFINITY);
        (states[9 * 5 + 1], states[9 * 5 + 2]) = (1e200, 1e200); // their product overflows
        let (tangents, times) = (vec![0.5; 180], [0.0, 1.0, 10.0]);
        let orbits = run(&top, method, &states, &tangents, &times, Simd::widest());
        let reference = run(&top, method, &good, &tangents, &times, Simd::widest());
        for trajectory in 0..20 {
            let (summary, rows) = (&orbits.summaries[trajectory], &orbits.states[27 * trajectory..][..27]);
            if (3..=5).contains(&trajectory) {
                assert_eq!((summary.outcome, summary.time, summary.n_steps), (Outcome::NotFinite, 0.0, 0));
                assert!(rows[9..].iter().all(|x| x.is_nan()));
            } else {
                assert_eq!(summary.outcome, Outcome::Finished);
                assert_eq!(bits(rows), bits(&reference.states[27 * trajectory..][..27]));
            }
        }
    }
    check(adaptive(1e-9));
    check(adaptive(1e-9).compensated());
    check(fixed(0.1));
    check(single(adaptive(1e-5)));
    check(single(fixed(0.1)));
}

/// An equilibrium allows any step, but not the linear flow about it that a tangent vector follows.
#[test]
fn an_equilibrium_takes_one_step_and_its_tangent_vectors_more() {
    let top = TWISTED_KOVALEVSKAYA.top();
    let hanging = [0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0]; // alpha along a, at rest
    let orbits = run(&top, adaptive(1e-8), &hanging, &[], &[0.0, 1e9], Simd::Scalar);
    assert_eq!((&orbits.states[9..], orbits.summaries[0].n_steps), (&hanging[..], 1));
    let unstable = hanging.map(|x| -x);
    let pushed = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let orbits = run(&top, adaptive(1e-8), &unstable, &pushed, &[0.0, 5.0], Simd::Scalar);
    // l3'' = 2 l3 about it: l3 = cosh(t sqrt 2)
    let exact = (5.0 * 2.0_f64.sqrt()).cosh();
    assert!((orbits.tangents[11] / exact - 1.0).abs() < 1e-6, "{} {exact}", orbits.tangents[11]);
}

#[test]
fn refused_steps_count() {
    let top = TWISTED_KOVALEVSKAYA.top();
    let states = starts(30);
    let taken = |max_steps: u64| {
        let method = RungeKutta::new(1e-9, max_steps).unwrap();
        run(&top, method, &states, &[], &[0.0, 1e6], Simd::widest()).summaries
    };
    let (few, many) = (taken(100), taken(200));
    for (few, many) in few.iter().zip(&many) {
        assert_eq!((few.outcome, many.outcome), (Outcome::MaxSteps, Outcome::MaxSteps));
        assert!(few.n_steps <= 100 && few.n_steps < many.n_steps && many.n_steps <= 200);
    }
    // some steps of this ensemble are refused, most are not
    let accepted: u64 = many.iter().map(|summary| summary.n_steps).sum();
    assert!(accepted < 200 * 30 && accepted > 150 * 30, "{accepted}");
}

/// Tangent vectors that grow by `exp(800 sqrt 2)` are followed by powers of two taken out, in single precision too.
#[test]
fn growth_beyond_the_largest_number_is_followed() {
    let top = TWISTED_KOVALEVSKAYA.top();
    let unstable = [0.0, 0.0, 0.0, -2.0, 0.0, 0.0, 0.0, 0.0, 0.0].repeat(20);
    let tangents = [[0.0, 0.0, 1.0], [0.0; 3], [0.0; 3]].concat().repeat(20);
    // l3 = cosh(t sqrt 2), alpha2 = -sqrt 2 sinh(t sqrt 2): |v| = exp(t sqrt 2) sqrt(3) / 2
    let expected = 2.0_f64.sqrt() + (3.0_f64.sqrt() / 2.0).ln() / 800.0;
    let times = [0.0, 800.0];
    let exponents = |single_precision: bool| {
        let (states, tangents, times) = (&unstable[..], &tangents[..], &times[..]);
        let (control, simd) = (Control::default(), Simd::widest());
        if single_precision {
            let method = single(adaptive(1e-5));
            let ensemble = Ensemble { field: &top, method, states, tangents, n_tangents: 1, times };
            finite_time_exponents(&ensemble, 1, simd, &control, |_| ()).unwrap().exponents
        } else {
            let method = adaptive(1e-11);
            let ensemble = Ensemble { field: &top, method, states, tangents, n_tangents: 1, times };
            finite_time_exponents(&ensemble, 1, simd, &control, |_| ()).unwrap().exponents
        }
    };
    for (single_precision, bound) in [(false, 1e-9), (true, 1e-5)] {
        for exponent in exponents(single_precision) {
            assert!((exponent - expected).abs() < bound, "{exponent} {expected} {single_precision}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn bits_do_not_depend_on_lanes_or_threads(
        p in parameters(), trajectories in 1..40_usize, scale in prop_oneof![Just(1.0), Just(1e-30), Just(30.0)],
        bad in proptest::collection::vec((0..40_usize, prop_oneof![Just(f64::NAN), Just(f64::INFINITY), Just(1e300), Just(0.0)]), 0..4),
    ) {
        let top = p.top();
        let mut states: Vec<f64> = starts(trajectories).iter().map(|x| x * scale).collect();
        let tangents: Vec<f64> = starts(2 * trajectories).iter().rev().copied().collect();
        for (trajectory, value) in bad {
            states[(trajectory % trajectories) * 9 + trajectory % 9] = value;
        }
        let limited = RungeKutta::new(1e-9, 300).unwrap();
        assert_same_bits(&integrate_all(&top, limited, &states, &tangents), true);
        assert_same_bits(&integrate_all(&top, limited.compensated(), &states, &tangents), true);
        assert_same_bits(&integrate_all(&top, fixed(0.013), &states, &tangents), false);
        assert_same_bits(&integrate_all(&top, single(RungeKutta::new(1e-5, 300).unwrap()), &states, &tangents), true);
        assert_same_bits(&integrate_all(&top, single(fixed(0.013)), &states, &tangents), false);
    }

    #[test]
    fn random_tops_follow_the_taylor_method(p in parameters(), x in vector9(), v in vector9()) {
        let times = [0.0, 1.0, 3.0];
        let exact = run(&p.top(), taylor(1e-15), &x, &v, &times, Simd::widest());
        let ours = run(&p.top(), adaptive(1e-11), &x, &v, &times, Simd::widest());
        let size = |values: &[f64]| values.iter().fold(1.0_f64, |size, value| size.max(value.abs()));
        // errors grow at most as the tangent map of 3 time units, whose size grows with that of the state
        let (states, tangents) = (size(&exact.states), size(&exact.tangents));
        prop_assert!(distance(&ours.states, &exact.states) < 1e-9 * states.powi(3));
        prop_assert!(distance(&ours.tangents, &exact.tangents) < 1e-8 * states.powi(4) * tangents.powi(2));
    }
}
