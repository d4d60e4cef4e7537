//! Mixed precision: the state as accurate as in double precision, exponents with the error that it states.

use crate::common::*;
use liepoisson_core::analysis::lyapunov::finite_time_exponents;
use liepoisson_core::analysis::orbit::orbits;
use liepoisson_core::ensemble::{Control, Ensemble, Outcome};
use liepoisson_core::field::Top;
use liepoisson_core::lanes::Simd;
use liepoisson_core::method::{MixedTaylor, RungeKutta, Single, Taylor};
use proptest::prelude::*;

fn mixed(tolerance: f64) -> MixedTaylor {
    MixedTaylor(taylor(tolerance))
}

fn size(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |size, x| size.max(x.abs()))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Up to T = 3 the tangent vectors of these tops grow by less than 1e4, and errors with them.
    #[test]
    fn state_is_as_accurate_as_in_double_precision(p in parameters(), x in vector9(), v in vector9(), exponent in 6..14_i32) {
        let (top, tolerance) = (p.top(), libm::exp10(f64::from(-exponent)));
        let times = [0.0, 1.3, 3.0];
        let exact = run(&top, taylor(1e-15), &x, &v, &times, Simd::Scalar);
        let run = run(&top, mixed(tolerance), &x, &v, &times, Simd::widest());
        let (scale, tangent_scale) = (size(&exact.states), size(&exact.tangents));
        let growth = (tangent_scale / size(&v)).max(1.0) * scale.max(1.0);
        let bound = 1e3 * growth * (tolerance + 1e-15) * scale;
        prop_assert!(distance(&run.states, &exact.states) < bound, "{:e} {bound:e}", distance(&run.states, &exact.states));
        let bound = 1e3 * growth * libm::sqrt(tolerance).max(6e-8) * tangent_scale;
        prop_assert!(distance(&run.tangents, &exact.tangents) < bound);
    }

    #[test]
    fn bits_do_not_depend_on_lanes_or_threads(
        p in parameters(), trajectories in 1..70_usize, scale in prop_oneof![Just(1.0), Just(1e-30), Just(30.0), Just(1e12)],
        bad in proptest::collection::vec((0..70_usize, prop_oneof![Just(f64::NAN), Just(f64::INFINITY), Just(1e300), Just(1e-300)]), 0..4),
    ) {
        let top = p.top();
        let mut states: Vec<f64> = starts(trajectories).iter().map(|x| x * scale).collect();
        let tangents: Vec<f64> = starts(2 * trajectories).iter().rev().copied().collect();
        for (trajectory, value) in bad {
            states[(trajectory % trajectories) * 9 + trajectory % 9] = value;
        }
        let method = MixedTaylor(Taylor::new(1e-10, None, 300).unwrap());
        let ensemble = Ensemble {
            field: &top, method, states: &states, tangents: &tangents, n_tangents: 2, times: &[0.0, 0.7 / scale, 2.0 / scale],
        };
        let results =
            everywhere(|simd, threads| orbits(&ensemble, threads, simd, &Control::default(), true, |_| ()).unwrap());
        assert_same_bits(&results, true);
    }
}

/// The coefficients of a top this fast leave the range of single precision unless time is scaled.
#[test]
fn fast_tops_do_not_overflow() {
    let fast = Parameters { inertia: [2e-6, 2e-6, 1e-6], ..TWISTED_KOVALEVSKAYA };
    let (states, times) = (starts(20), [0.0, 2e-5]);
    let exact = run(&fast.top(), taylor(1e-15), &states, &states, &times, Simd::widest());
    let run = run(&fast.top(), mixed(1e-12), &states, &states, &times, Simd::widest());
    assert!(run.summaries.iter().all(|summary| summary.outcome == Outcome::Finished));
    assert!(distance(&run.states, &exact.states) < 1e-9, "{:e}", distance(&run.states, &exact.states));
}

#[test]
fn dense_output_is_the_series_of_the_state() {
    let (top, states) = (TWISTED_KOVALEVSKAYA.top(), starts(3));
    let ensemble = Ensemble {
        field: &top,
        method: mixed(1e-13),
        states: &states,
        tangents: &[],
        n_tangents: 0,
        times: &[0.0, 5.0],
    };
    let run = orbits(&ensemble, 1, Simd::widest(), &Control::default(), true, |_| ()).unwrap();
    for (trajectory, series) in run.series.iter().enumerate() {
        let step = series.times.len() - 1;
        let order = ensemble.method.0.order();
        let coefficients = &series.coefficients[step * (order + 1) * 9..];
        let tau = 5.0 - series.times[step];
        for i in 0..9 {
            let value = (0..=order).rev().fold(0.0, |sum, k| sum * tau + coefficients[9 * k + i]);
            assert!((value - run.states[18 * trajectory + 9 + i]).abs() < 1e-12);
        }
    }
}

/// Median error at T = 20 below 1e-6 at tolerance 1e-13: two of the digits that the statistics of exponents need.
#[test]
fn exponents_have_the_error_that_is_stated() {
    let (top, states, tangents) = (TWISTED_KOVALEVSKAYA.top(), starts(128), starts(256)[1152..].to_vec());
    let exponents = |top: &Top, exact: bool| {
        let (states, tangents, times) = (&states, &tangents, &[0.0, 20.0]);
        let run = if exact {
            let ensemble = Ensemble { field: top, method: taylor(1e-15), states, tangents, n_tangents: 1, times };
            finite_time_exponents(&ensemble, 1, Simd::widest(), &Control::default(), |_| ())
        } else {
            let ensemble = Ensemble { field: top, method: mixed(1e-13), states, tangents, n_tangents: 1, times };
            finite_time_exponents(&ensemble, 1, Simd::widest(), &Control::default(), |_| ())
        };
        run.unwrap().exponents
    };
    let mut errors: Vec<f64> =
        exponents(&top, false).iter().zip(exponents(&top, true)).map(|(a, b)| (a - b).abs()).collect();
    errors.sort_by(f64::total_cmp);
    assert!(errors[64] < 1e-6 && errors[127] < 1e-4, "{:e} {:e}", errors[64], errors[127]);
    assert!(errors[64] > 1e-12, "these are the errors of single precision");
}

/// The equations of a tangent vector are linear: its length, `2^-1060` to `2^1000` here, says nothing about its growth.
#[test]
fn exponents_do_not_depend_on_the_length_of_tangent_vectors() {
    let (top, trajectories) = (Top::new([2.0, 2.0, 1.0], [-1.0, 0.0, 0.0], [0.0; 3], 1.0).unwrap(), 19);
    let (states, unit) = (starts(trajectories), starts(trajectories));
    let exponents = |precision: usize, power: i32| {
        let tangents: Vec<f64> = unit.iter().map(|v| libm::scalbn(*v, power)).collect();
        let (states, tangents, times) = (&states, &tangents, &[0.0, 1.0, 20.0]);
        let fixed = RungeKutta::fixed(0.05, 1_000_000).unwrap();
        macro_rules! run {
            ($method:expr) => {{
                let ensemble = Ensemble { field: &top, method: $method, states, tangents, n_tangents: 1, times };
                finite_time_exponents(&ensemble, 1, Simd::widest(), &Control::default(), |_| ()).unwrap().exponents
            }};
        }
        match precision {
            0 => run!(taylor(1e-13)),
            1 => run!(mixed(1e-9)),
            _ => run!(Single::<RungeKutta>::new(fixed).unwrap()),
        }
    };
    for precision in 0..3 {
        let wanted = exponents(precision, 0);
        // a few digits of subnormal numbers are left at 2^-1060
        for (power, bound) in
            [(-1060, 1e-3), (-300, 1e-6), (-150, 1e-6), (-140, 1e-6), (-40, 1e-6), (130, 1e-6), (1000, 1e-6)]
        {
            let got = exponents(precision, power);
            let worst = wanted.iter().zip(&got).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(worst < bound, "precision {precision}, 2^{power}: {worst:e}");
            assert!(got.iter().all(|exponent| exponent.is_finite()));
        }
    }
}
