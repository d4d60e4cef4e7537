//! Gauss collocation: quadratic invariants to round-off, orders 2 to 8, reversibility, tangent maps, failures.

use crate::common::*;
use liepoisson_core::analysis::orbit::orbits;
use liepoisson_core::ensemble::{Control, Ensemble, Outcome};
use liepoisson_core::error::Error;
use liepoisson_core::field::{Instruction, Tape};
use liepoisson_core::lanes::Simd;
use liepoisson_core::method::Gauss;

const GENERAL: Parameters =
    Parameters { inertia: [1.3, 0.7, 2.1], a: [0.4, -0.9, 0.3], b: [-0.2, 0.5, 0.8], epsilon: 0.7 };

/// The twisted Lagrange top: I1 = I2, a along the third axis.
const TWISTED_LAGRANGE: Parameters =
    Parameters { inertia: [1.4, 1.4, 0.8], a: [0.0, 0.0, 0.9], b: [0.0; 3], epsilon: 0.6 };

fn gauss(n_stages: usize, step: f64) -> Gauss {
    Gauss::new(n_stages, step, u64::MAX).unwrap()
}

/// H, C1, C2, C3, and of the twisted Lagrange top `l3` and `P = l.alpha + eps I1 a3 beta3`.
fn quadratic_invariants(p: &Parameters, x: &[f64]) -> Vec<f64> {
    let mut values = vec![p.energy(x)];
    values.extend(p.casimirs(x));
    if p.inertia == TWISTED_LAGRANGE.inertia {
        let l_alpha: f64 = (0..3).map(|i| x[i] * x[3 + i]).sum();
        values.extend([x[2], l_alpha + p.epsilon * p.inertia[0] * p.a[2] * x[8]]);
    }
    values
}

/// 1e4 steps. A random walk of their roundings, some 2^-53 each, comes to a few 1e-14 (3.1e-14 was seen with two stages);
/// the same error in each step would come to 1e-12.
#[test]
fn quadratic_invariants_are_kept_to_round_off() {
    for p in [TWISTED_LAGRANGE, GENERAL] {
        for n_stages in 1..=4 {
            let (states, times) = (starts(8), [0.0, 500.0, 1000.0]);
            let orbits = run(&p.top(), gauss(n_stages, 0.1), &states, &[], &times, Simd::widest());
            for rows in orbits.states.chunks(27) {
                let first = quadratic_invariants(&p, &rows[..9]);
                for row in rows[9..].chunks(9) {
                    for (i, value) in quadratic_invariants(&p, row).iter().enumerate() {
                        let drift = (value - first[i]).abs();
                        assert!(drift < 1e-13, "{n_stages} stages, invariant {i}: {drift:e}");
                    }
                }
            }
        }
    }
}

#[test]
fn running_backwards_returns_to_the_start() {
    let (p, states) = (GENERAL, starts(8));
    for n_stages in 1..=4 {
        let there = run(&p.top(), gauss(n_stages, 0.1), &states, &[], &[0.0, 10.0], Simd::widest());
        let ends: Vec<f64> = there.states.chunks(18).flat_map(|rows| rows[9..].to_vec()).collect();
        let back = run(&p.top(), gauss(n_stages, 0.1), &ends, &[], &[10.0, 0.0], Simd::widest());
        for (start, rows) in states.chunks(9).zip(back.states.chunks(18)) {
            // round-off of 200 steps, grown by the flow
            assert!(distance(start, &rows[9..]) < 1e-12, "{n_stages} stages: {:e}", distance(start, &rows[9..]));
        }
    }
}

/// Central differences of the numerical map itself, with steps so long that it is far from the flow.
#[test]
fn tangent_vectors_are_mapped_by_the_derivative_of_the_step() {
    let (p, x, v) = (GENERAL, starts(1), starts(2)[9..].to_vec());
    for n_stages in 1..=4 {
        let method = gauss(n_stages, 0.3);
        let end = |x: &[f64], v: &[f64]| run(&p.top(), method, x, v, &[0.0, 3.0], Simd::Scalar);
        let delta = 1e-5;
        let moved = |sign: f64| x.iter().zip(&v).map(|(x, v)| x + sign * delta * v).collect::<Vec<f64>>();
        let (plus, minus) = (end(&moved(1.0), &[]).states, end(&moved(-1.0), &[]).states);
        let difference: Vec<f64> = (9..18).map(|i| (plus[i] - minus[i]) / (2.0 * delta)).collect();
        let error = distance(&end(&x, &v).tangents[9..], &difference);
        // truncation delta^2 times third derivatives, rounding 1e-16 / delta
        assert!(error < 1e-7, "{n_stages} stages: {error:e}");
    }
}

/// Fast rotation of a top with moments 1e6 : 1 : 1 within long steps: no contraction, for that trajectory alone.
#[test]
fn a_step_too_long_ends_its_trajectory_only() {
    let p = Parameters { inertia: [1e6, 1.0, 1.0], a: [0.3, 0.1, 0.2], b: [0.1, 0.0, 0.2], epsilon: 1.0 };
    let good: Vec<f64> = starts(12).iter().map(|x| 0.3 * x).collect();
    let mut states = good.clone();
    states[9 * 5..][..3].copy_from_slice(&[1e6, 1e3, 1e3]);
    states[9 * 7] = f64::NAN;
    states[9 * 8] = 1e200;
    for n_stages in 1..=4 {
        let integrate = |states: &[f64]| run(&p.top(), gauss(n_stages, 0.1), states, &[], &[0.0, 2.0], Simd::widest());
        let (orbits, reference) = (integrate(&states), integrate(&good));
        for (trajectory, summary) in orbits.summaries.iter().enumerate() {
            match trajectory {
                5 => {
                    assert_eq!((summary.outcome, summary.n_steps), (Outcome::NoConvergence, 0));
                    assert_eq!(summary.state, states[9 * 5..][..9]);
                }
                7 | 8 => assert!(matches!(summary.outcome, Outcome::NotFinite | Outcome::NoConvergence), "{summary:?}"),
                _ => {
                    assert_eq!(summary.outcome, Outcome::Finished);
                    let rows = 18 * trajectory..18 * (trajectory + 1);
                    assert_eq!(orbits.states[rows.clone()], reference.states[rows]);
                }
            }
        }
    }
}

#[test]
fn bits_do_not_depend_on_lanes_or_threads() {
    let (p, trajectories) = (TWISTED_KOVALEVSKAYA, 21);
    // sizes from 0.1 to 2, so that trajectories need different numbers of sweeps
    let states: Vec<f64> =
        starts(trajectories).iter().enumerate().map(|(i, x)| x * (0.1 + 0.09 * (i / 9) as f64)).collect();
    let tangents = starts(trajectories + 1)[9..].to_vec();
    for n_stages in 1..=4 {
        let (top, method) = (p.top(), gauss(n_stages, 0.11));
        let times = &[0.0, 0.7, 4.0];
        let ensemble = Ensemble { field: &top, method, states: &states, tangents: &tangents, n_tangents: 1, times };
        let results =
            everywhere(|simd, threads| orbits(&ensemble, threads, simd, &Control::default(), false, |_| ()).unwrap());
        assert_same_bits(&results, true);
    }
}

/// `q' = p, p' = -sin q`.
#[test]
fn a_tape_follows_the_taylor_method() {
    let instruction =
        |name: &str, registers: &[usize], numbers: &[f64]| Instruction::from_parts(name, registers, numbers).unwrap();
    let instructions = vec![instruction("sin", &[0], &[]), instruction("linear", &[2], &[-1.0, 0.0])];
    let pendulum = Tape::new(2, instructions, vec![1, 3]).unwrap();
    let (states, tangents) = ([0.3, 1.0, 2.0, -0.5], [1.0, 0.0, 0.3, 1.0]);
    let (field, control, simd) = (&pendulum, Control::default(), Simd::widest());
    let (states, tangents, times) = (&states[..], &tangents[..], &[0.0, 0.7, 3.0][..]);
    let ours = Ensemble { field, method: gauss(4, 0.05), states, tangents, n_tangents: 1, times };
    let ours = orbits(&ours, 1, simd, &control, false, |_| ()).unwrap();
    let exact = Ensemble { field, method: taylor(1e-15), states, tangents, n_tangents: 1, times };
    let exact = orbits(&exact, 1, simd, &control, false, |_| ()).unwrap();
    assert!(distance(&ours.states, &exact.states) < 1e-11, "{:e}", distance(&ours.states, &exact.states));
    assert!(distance(&ours.tangents, &exact.tangents) < 1e-10);
}

#[test]
fn stages_and_steps_outside_their_ranges_are_refused() {
    assert_eq!(Gauss::new(0, 0.1, 1), Err(Error::Stages { got: 0 }));
    assert_eq!(Gauss::new(5, 0.1, 1), Err(Error::Stages { got: 5 }));
    for step in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        assert!(matches!(Gauss::new(2, step, 1), Err(Error::StepSize { .. })), "{step}");
    }
}
