//! The Taylor method: known solutions, order, reversal, tangent vectors.

use crate::common::*;
use liepoisson_core::error::Error;
use liepoisson_core::lanes::Simd;
use liepoisson_core::method::{AcrossComponents, MixedTaylor, RungeKutta, Taylor};
use proptest::prelude::*;

/// Free symmetric top: `l1 + i l2` turns at the rate `(1/I1 - 1/I3) l3`, `l3` is constant.
#[test]
fn free_symmetric_top_precesses_at_the_known_rate() {
    let p = Parameters { inertia: [2.0, 2.0, 0.7], a: [0.0; 3], b: [0.0; 3], epsilon: 0.0 };
    let start = [0.6, -0.3, 0.9, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let t = 37.0;
    let orbit = run(&p.top(), taylor(1e-15), &start, &[], &[0.0, t], Simd::Scalar);
    // l1' = l2 omega3 - l3 omega2 = (1/I3 - 1/I1) l3 l2
    let angle = (1.0 / 0.7 - 1.0 / 2.0) * 0.9 * t;
    let expected = [0.6 * angle.cos() - 0.3 * angle.sin(), -0.3 * angle.cos() - 0.6 * angle.sin(), 0.9];
    assert!(distance(&orbit.states[9..12], &expected) < 1e-13, "{:?} {expected:?}", &orbit.states[9..12]);
}

/// Homoclinic orbit of the heavy top inside beta = 0: `l3 = 2 k I3 sech(k t)`, a family of the plane l = (0, 0, z).
#[test]
fn planar_homoclinic_orbit_follows_the_hyperbolic_secant() {
    let (i3, k) = (1.0_f64, 0.5_f64);
    let p = TWISTED_KOVALEVSKAYA;
    // z' = -a1 y, x' = y z / I3, y' = -x z / I3 with a1 = -1; a1 x + z^2/(2 I3) is the energy, I3 k^2 at the saddle.
    let state = |t: f64| {
        let z = 2.0 * i3 * k / (k * t).cosh();
        let x = z * z / (2.0 * i3) - i3 * k * k;
        let y = -k * z * (k * t).tanh();
        [0.0, 0.0, z, x, y, 0.0, 0.0, 0.0, 0.0]
    };
    let orbit = run(&p.top(), taylor(1e-15), &state(-6.0), &[], &[-6.0, 0.0, 3.0], Simd::Scalar);
    // the saddle stretches errors by exp(6 k) = 20 on the way in
    assert!(distance(&orbit.states[9..18], &state(0.0)) < 1e-13);
    assert!(distance(&orbit.states[18..27], &state(3.0)) < 1e-13);
}

/// The error of a fixed number of units of time falls with the tolerance, and is near it.
#[test]
fn error_follows_tolerance() {
    let top = TWISTED_KOVALEVSKAYA.top();
    let (starts, times) = (starts(32), [0.0, 10.0]);
    let reference = run(&top, Taylor::new(1.2e-16, Some(30), 1_000_000).unwrap(), &starts, &[], &times, Simd::Scalar);
    for exponent in [4, 6, 8, 10, 12] {
        let tolerance = 10.0_f64.powi(-exponent);
        let orbits = run(&top, taylor(tolerance), &starts, &[], &times, Simd::Scalar);
        let mut errors: Vec<f64> = (0..32)
            .map(|m| distance(&orbits.states[18 * m + 9..18 * m + 18], &reference.states[18 * m + 9..18 * m + 18]))
            .collect();
        errors.sort_by(f64::total_cmp);
        // measured: the median error at t = 10 is 0.38 to 0.55 times the tolerance
        assert!(errors[16] < 10.0 * tolerance, "tolerance {tolerance:e}: median error {:e}", errors[16]);
        assert!(errors[16] > 0.01 * tolerance, "tolerance {tolerance:e}: median error {:e}", errors[16]);
    }
}

/// Work counters: steps of 32 trajectories to t = 10, with and without a tangent vector. A change here is a change of
/// speed; it must be meant.
#[test]
fn numbers_of_steps_are_as_recorded() {
    let top = TWISTED_KOVALEVSKAYA.top();
    let (states, times) = (starts(32), [0.0, 10.0]);
    let steps = |tolerance: f64, tangents: &[f64]| -> u64 {
        let orbits = run(&top, taylor(tolerance), &states, tangents, &times, Simd::Scalar);
        orbits.summaries.iter().map(|summary| summary.n_steps).sum()
    };
    let counted = [1e-4, 1e-8, 1e-13].map(|tolerance| (steps(tolerance, &[]), steps(tolerance, &starts(32))));
    assert_eq!(counted, [(677, 840), (756, 884), (883, 998)]);
}

proptest! {
    #[test]
    fn running_back_returns_to_the_start(p in parameters(), x in vector9()) {
        let top = p.top();
        let forth = run(&top, taylor(1e-15), &x, &[], &[0.0, 3.0], Simd::Scalar);
        let back = run(&top, taylor(1e-15), &forth.states[9..], &[], &[3.0, 0.0], Simd::Scalar);
        // the tangent map of 3 time units stretches by up to exp(3 max|omega|), so the bound follows the size
        let size = x.iter().chain(&forth.states[9..]).fold(1.0_f64, |size, c| size.max(c.abs()));
        prop_assert!(distance(&back.states[9..], &x) < 1e-11 * size.powi(3), "{}", distance(&back.states[9..], &x));
    }

    #[test]
    fn flow_composes(p in parameters(), x in vector9(), middle in 0.5..2.5_f64) {
        let top = p.top();
        let whole = run(&top, taylor(1e-15), &x, &[], &[0.0, middle, 3.0], Simd::Scalar);
        let second = run(&top, taylor(1e-15), &whole.states[9..18], &[], &[middle, 3.0], Simd::Scalar);
        let size = whole.states.iter().fold(1.0_f64, |size, c| size.max(c.abs()));
        prop_assert!(distance(&whole.states[18..], &second.states[9..]) < 1e-11 * size.powi(3));
    }

    #[test]
    fn tangent_vectors_are_derivatives_of_the_flow(p in parameters(), x in vector9(), v in vector9(), w in vector9()) {
        let top = p.top();
        let times = [0.0, 2.0];
        let tangents: Vec<f64> = v.iter().chain(&w).copied().collect();
        let orbit = run(&top, taylor(1e-15), &x, &tangents, &times, Simd::Scalar);
        for (k, vector) in [&v, &w].into_iter().enumerate() {
            let end = |h: f64| {
                let start: Vec<f64> = x.iter().zip(vector).map(|(x, v)| x + h * v).collect();
                run(&top, taylor(1e-15), &start, &[], &times, Simd::Scalar).states[9..].to_vec()
            };
            // fourth-order differences with h = 1e-3: truncation h^4 times a fifth derivative, round-off 1e-16/h
            let (a, b, c, d) = (end(-2e-3), end(-1e-3), end(1e-3), end(2e-3));
            let difference: Vec<f64> = (0..9).map(|i| (a[i] - 8.0 * b[i] + 8.0 * c[i] - d[i]) / 12e-3).collect();
            let tangent = &orbit.tangents[18 + 9 * k..27 + 9 * k];
            let size = tangent.iter().fold(1.0_f64, |size, c| size.max(c.abs()));
            prop_assert!(distance(tangent, &difference) < 1e-7 * size.powi(5), "{tangent:?} {difference:?}");
        }
    }
}

/// A heavy top at rest with alpha = (c, 0, 0) along a = (-1, 0, 0): `l3' = alpha2`, `alpha2' = -c l3` (I3 = 1), so for
/// c = -2 (potential energy largest, upright) l3 grows as `cosh(t sqrt 2)`, for c = 2 (hanging) it goes as `cos(t sqrt 2)`.
/// The state itself stays: its own series would allow a step of any length.
#[test]
fn tangent_vectors_at_an_equilibrium_follow_the_linear_flow() {
    let top = TWISTED_KOVALEVSKAYA.top();
    let at_rest = |c: f64| [0.0, 0.0, 0.0, c, 0.0, 0.0, 0.0, 0.0, 0.0];
    let tangent = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let grown = |c: f64, t: f64| {
        let orbit = run(&top, taylor(1e-15), &at_rest(c), &tangent, &[0.0, t], Simd::Scalar);
        assert_eq!(orbit.states[9..], at_rest(c));
        orbit.tangents[9 + 2]
    };
    assert!((grown(-2.0, 5.0) / (5.0 * 2.0_f64.sqrt()).cosh() - 1.0).abs() < 1e-13);
    assert!((grown(2.0, 5.0) - (5.0 * 2.0_f64.sqrt()).cos()).abs() < 1e-13);
}

/// A run of 1e5 units of time keeps its clock: a plain sum of some 3e5 steps would be off by about 1e-9.
#[test]
fn clock_does_not_drift() {
    let p = Parameters { inertia: [2.0, 2.0, 0.7], a: [0.0; 3], b: [0.0; 3], epsilon: 0.0 };
    let start = [0.6, 0.0, 0.9, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let t = 1e5;
    let orbit = run(&p.top(), taylor(1e-15), &start, &[], &[0.0, t], Simd::Scalar);
    let angle = (1.0 / 0.7 - 1.0 / 2.0) * 0.9 * t;
    let phase = orbit.states[9].hypot(orbit.states[10]).recip() * orbit.states[9];
    // the angle itself is rounded at 8e4 radians: 1.5e-11
    assert!((phase - angle.cos()).abs() < 1e-10, "{}", phase - angle.cos());
}

#[test]
fn tolerance_and_order_out_of_range_are_refused() {
    assert_eq!(Taylor::new(1e-20, None, 1), Err(Error::Tolerance { got: 1e-20 }));
    assert!(matches!(Taylor::new(f64::NAN, None, 1), Err(Error::Tolerance { .. })));
    assert_eq!(Taylor::new(1e-10, Some(1), 1), Err(Error::Order { got: 1 }));
    assert_eq!(Taylor::new(1e-10, Some(65), 1), Err(Error::Order { got: 65 }));
}

/// `l = alpha = 0`, `beta` across `a`: a planar motion in which only every sixth order of a component is not zero, so that
/// for many orders the last two terms of all components vanish together.
#[test]
fn a_symmetric_motion_whose_last_terms_vanish_takes_no_endless_step() {
    let p = Parameters { inertia: [2.0, 1.5, 1.0], a: [0.0, 0.0, 1.0], b: [0.0; 3], epsilon: 1.0 };
    let start = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0];
    let tangent = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0]; // a symmetric one
    let times = [0.0, 10.0];
    let reference = run(&p.top(), RungeKutta::new(1e-14, 1_000_000).unwrap(), &start, &[], &times, Simd::Scalar);
    for order in 8..=40 {
        let method = Taylor::new(1e-15, Some(order), 1_000_000).unwrap();
        let runs = [
            run(&p.top(), method, &start, &[], &times, Simd::Scalar),
            run(&p.top(), method, &start, &tangent, &times, Simd::Scalar),
            run(&p.top(), AcrossComponents(method), &start, &[], &times, Simd::Scalar),
            run(&p.top(), MixedTaylor(method), &start, &[], &times, Simd::Scalar),
        ];
        for orbit in runs {
            let error = distance(&orbit.states[9..18], &reference.states[9..18]);
            assert!(error < 1e-11, "order {order}: {error:e} in {} steps", orbit.summaries[0].n_steps);
        }
    }
}
