//! The Runge-Kutta method of order 8 on tapes and quadratic fields: closed forms, the Taylor method, singularities.

use crate::common::*;
use crate::runge_kutta::{adaptive, fixed, integrate_all, single};
use liepoisson_core::analysis::orbit::orbits;
use liepoisson_core::ensemble::{Control, Ensemble, Outcome};
use liepoisson_core::field::{Instruction, Quadratic, Tape};
use liepoisson_core::lanes::Simd;
use liepoisson_core::method::RungeKutta;

/// `x' = 1 + x^2` from 0 is `tan t`: infinite at pi/2. Neighbours start at -2 and get to `tan(2 - atan 2)`.
#[test]
fn blowing_up_ends_a_trajectory_only() {
    let field = Quadratic::new(1, &[(0, 1.0)], &[], &[(0, 0, 0, 1.0)]).unwrap();
    let states = [0.0, -2.0, 0.0, -2.0, -2.0];
    let integrate = |method: RungeKutta, states: &[f64]| {
        let ensemble = Ensemble { field: &field, method, states, tangents: &[], n_tangents: 0, times: &[0.0, 2.0] };
        orbits(&ensemble, 1, Simd::widest(), &Control::default(), false, |_| ()).unwrap()
    };
    for (method, outcome) in [(adaptive(1e-10), Outcome::StepTooSmall), (fixed(0.01), Outcome::NotFinite)] {
        let (mixed, alone) = (integrate(method, &states), integrate(method, &[-2.0]));
        for (trajectory, summary) in mixed.summaries.iter().enumerate() {
            if states[trajectory] == 0.0 {
                assert_eq!(summary.outcome, outcome);
                assert!(summary.time < 2.0 && summary.state[0].is_finite(), "{summary:?}");
            } else {
                assert_eq!(mixed.states[2 * trajectory + 1].to_bits(), alone.states[1].to_bits());
                let exact = (2.0 - 2.0_f64.atan()).tan();
                assert!((alone.states[1] - exact).abs() < 1e-8, "{} {exact}", alone.states[1]);
            }
        }
    }
    let time = integrate(adaptive(1e-10), &[0.0]).summaries[0].time;
    assert!((time - std::f64::consts::FRAC_PI_2).abs() < 1e-8, "{time}");
}

/// From the origin a constant force moves the state: `x' = 1, y' = x`.
#[test]
fn the_origin_can_be_left() {
    let field = Quadratic::new(2, &[(0, 1.0)], &[(1, 0, 1.0)], &[]).unwrap();
    for t0 in [0.0, 5.0] {
        let ensemble = Ensemble {
            field: &field,
            method: adaptive(1e-10),
            states: &[0.0, 0.0],
            tangents: &[],
            n_tangents: 0,
            times: &[t0, t0 + 3.0],
        };
        let orbits = orbits(&ensemble, 1, Simd::Scalar, &Control::default(), false, |_| ()).unwrap();
        assert!(distance(&orbits.states[2..], &[3.0, 4.5]) < 1e-9, "{:?}", orbits.states);
    }
}

/// The pendulum `q' = p, p' = -sin q` as a tape, and a chain of quadratic triads.
#[test]
fn tapes_and_quadratic_fields_follow_the_taylor_method() {
    fn check<F>(field: &F, states: &[f64], tangents: &[f64])
    where
        F: liepoisson_core::field::Field,
        liepoisson_core::method::Taylor: liepoisson_core::method::Method<F>,
    {
        let n_tangents = tangents.len() / states.len();
        let exact = Ensemble { field, method: taylor(1e-15), states, tangents, n_tangents, times: &[0.0, 0.7, 3.0] };
        let exact = orbits(&exact, 1, Simd::widest(), &Control::default(), false, |_| ()).unwrap();
        let results = integrate_all(field, adaptive(1e-11), states, tangents);
        assert!(distance(&results[0].states, &exact.states) < 1e-9);
        assert!(distance(&results[0].tangents, &exact.tangents) < 1e-8);
        assert_same_bits(&results, true);
        assert_same_bits(&integrate_all(field, fixed(0.01), states, tangents), true);
    }
    let instruction =
        |name: &str, registers: &[usize], numbers: &[f64]| Instruction::from_parts(name, registers, numbers).unwrap();
    let pendulum = vec![instruction("sin", &[0], &[]), instruction("linear", &[2], &[-1.0, 0.0])];
    let pendulum = Tape::new(2, pendulum, vec![1, 3]).unwrap();
    let states = [0.3, 1.0, 2.0, -0.5, 3.0, 0.1, -1.0, 2.5, 0.0, 0.0];
    check(&pendulum, &states, &states.iter().rev().flat_map(|&x| [x, 1.0 - x]).collect::<Vec<_>>());

    let n = 23;
    let (mut quadratic, mut linear) = (Vec::new(), Vec::new());
    for i in 0..n {
        let (j, k) = ((i + 1) % n, (i + 2) % n);
        quadratic.extend([(i, j, k, 0.5), (j, i, k, 0.3), (k, i, j, -0.8)]);
        linear.extend([(i, j, 0.1), (j, i, -0.1)]);
    }
    let chain = Quadratic::new(n, &[(3, 0.2)], &linear, &quadratic).unwrap();
    let states: Vec<f64> = (0..6 * n).map(|i| (1.7 * i as f64).sin()).collect();
    check(&chain, &states, &states.iter().map(|x| 1.0 - x).collect::<Vec<_>>());
    let exact = integrate_all(&chain, taylor(1e-15), &states, &[]);
    let single_precision = integrate_all(&chain, single(adaptive(1e-6)), &states, &[]);
    assert_same_bits(&single_precision, true);
    assert!(distance(&single_precision[0].states, &exact[0].states) < 1e-3);
}
