//! Units of time far from those of the motion: the coefficients of the power series leave the range of numbers.

use crate::common::*;
use liepoisson_core::analysis::orbit::{Orbits, orbits};
use liepoisson_core::analysis::section::{Surface, sections};
use liepoisson_core::ensemble::{Control, Ensemble, Outcome};
use liepoisson_core::field::{Functions, Instruction, Quadratic, Space, Tape};
use liepoisson_core::lanes::Simd;
use liepoisson_core::method::{AcrossComponents, Method, MixedTaylor, Taylor};

const T_END: f64 = 6.0;
const TRAJECTORIES: usize = 3;

/// The twisted Kovalevskaya top, `rate` times as fast.
fn parameters_at(rate: f64) -> Parameters {
    Parameters { inertia: [2.0 / rate, 2.0 / rate, 1.0 / rate], a: [-rate, 0.0, 0.0], b: [0.0; 3], epsilon: 1.0 }
}

/// Its equations: `l' = l x omega + alpha x a`, `alpha' = alpha x omega + beta x a`, `beta' = beta x omega`.
#[allow(clippy::type_complexity)]
fn equations(rate: f64) -> (Vec<(usize, usize, f64)>, Vec<(usize, usize, usize, f64)>) {
    let (mut linear, mut quadratic) = (vec![], vec![]);
    let inverse = [0.5 * rate, 0.5 * rate, rate];
    for vector in 0..3 {
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            quadratic.push((3 * vector + i, 3 * vector + j, k, inverse[k]));
            quadratic.push((3 * vector + i, 3 * vector + k, j, -inverse[j]));
        }
    }
    for vector in 0..2 {
        // u x a = (0, -u3, u2) rate for a = (-rate, 0, 0), with u the next vector
        linear.push((3 * vector + 1, 3 * vector + 5, -rate));
        linear.push((3 * vector + 2, 3 * vector + 4, rate));
    }
    (linear, quadratic)
}

fn quadratic(rate: f64) -> Quadratic {
    let (linear, quadratic) = equations(rate);
    Quadratic::new(9, &[], &linear, &quadratic).unwrap()
}

fn tape(rate: f64) -> Tape {
    let (linear, quadratic) = equations(rate);
    let mut list: Vec<Instruction> = quadratic.iter().map(|&(_, j, k, _)| Instruction::Product(j, k)).collect();
    let outputs = (0..9).map(|i| {
        let products =
            quadratic.iter().enumerate().filter(|(_, entry)| entry.0 == i).map(|(m, entry)| (9 + m, entry.3));
        let components = linear.iter().filter(|entry| entry.0 == i).map(|&(_, j, c)| (j, c));
        list.push(Instruction::Linear { terms: products.chain(components).collect(), constant: 0.0 });
        8 + list.len()
    });
    let outputs = outputs.collect();
    Tape::new(9, list, outputs).unwrap()
}

fn orbits_at<F: Space, M: Method<F>>(field: &F, method: M, rate: f64, n_tangents: usize) -> Orbits {
    let states = starts(TRAJECTORIES);
    let tangents: Vec<f64> = if n_tangents > 0 { states.iter().rev().copied().collect() } else { vec![] };
    let times = [0.0, 0.3 / rate, T_END / rate];
    let ensemble = Ensemble { field, method, states: &states, tangents: &tangents, n_tangents, times: &times };
    orbits(&ensemble, 1, Simd::widest(), &Control::default(), false, |_| ()).unwrap()
}

/// Every orbit that is said to have finished is right; whether all have.
fn assert_right(found: &Orbits, wanted: &Orbits, bound: f64, what: &str) -> bool {
    let mut all = true;
    for (m, summary) in found.summaries.iter().enumerate() {
        if summary.outcome == Outcome::Finished {
            let error = distance(&found.states[27 * m..27 * m + 27], &wanted.states[27 * m..27 * m + 27]);
            assert!(error < bound, "{what}: {error:e}");
            if !found.tangents.is_empty() {
                let error = distance(&found.tangents[27 * m..27 * m + 27], &wanted.tangents[27 * m..27 * m + 27]);
                assert!(error < 1e3 * bound, "{what}, tangent vector: {error:e}");
            }
        } else {
            all = false;
        }
    }
    all
}

/// All kernels, in units of time from 1e-250 to 1e250 of the motion's own. With 10,000 steps the orbit is finished while five
/// terms of the series are within the range of numbers, the mixed method, which scales time, finishes everywhere.
#[test]
fn an_orbit_that_is_said_to_be_finished_is_right_in_all_units_of_time() {
    let everywhere = [-250, -200, -150, -100, -75, -50, -30, -20, -16, -10, 0, 10, 14, 20, 30, 50, 75, 100, 250];
    for (order, tolerance, exponents, range) in [
        (None, 1e-14, &everywhere[..], -50..=50),
        (Some(64), 1e-15, &[-20, -6, 5, 20], -50..=50),
        (Some(8), 1e-10, &[-75, -40, 40, 75], -75..=75),
    ] {
        let method = Taylor::new(tolerance, order, 10_000).unwrap();
        let bound = 1e3 * tolerance;
        for n_tangents in [0, 1] {
            let wanted =
                orbits_at(&parameters_at(1.0).top(), Taylor::new(1e-15, None, 10_000).unwrap(), 1.0, n_tangents);
            for &exponent in exponents {
                let rate = 10.0_f64.powi(exponent);
                let (top, quadratic, tape) = (parameters_at(rate).top(), quadratic(rate), tape(rate));
                let mut runs = vec![
                    ("top", orbits_at(&top, method, rate, n_tangents)),
                    ("quadratic", orbits_at(&quadratic, method, rate, n_tangents)),
                    ("tape", orbits_at(&tape, method, rate, n_tangents)),
                ];
                if n_tangents == 0 {
                    runs.push(("one orbit", orbits_at(&top, AcrossComponents(method), rate, 0)));
                }
                for (name, run) in runs {
                    let what = format!("{name}, order {order:?}, rate 1e{exponent}, {n_tangents} tangent vectors");
                    let finished = assert_right(&run, &wanted, bound, &what);
                    assert!(finished || !range.contains(&exponent), "{what}: {:?}", run.summaries[0]);
                }
                if n_tangents == 0 {
                    let run = orbits_at(&top, MixedTaylor(method), rate, 0);
                    assert!(
                        assert_right(&run, &wanted, bound, "mixed"),
                        "mixed, rate 1e{exponent}: {:?}",
                        run.summaries[0]
                    );
                }
            }
        }
    }
}

/// Dense output in units in which its highest terms vanish, or are not finite.
#[test]
fn power_series_of_steps_are_those_of_the_orbit_in_all_units() {
    let wanted = orbits_at(&parameters_at(1.0).top(), taylor(1e-14), 1.0, 0);
    for exponent in [-40, -20, -12, 0, 13, 20, 40] {
        let rate = 10.0_f64.powi(exponent);
        let (top, method, states) = (parameters_at(rate).top(), taylor(1e-14), starts(TRAJECTORIES));
        let times = [0.0, T_END / rate];
        let ensemble = Ensemble { field: &top, method, states: &states, tangents: &[], n_tangents: 0, times: &times };
        let run = orbits(&ensemble, 1, Simd::widest(), &Control::default(), true, |_| ()).unwrap();
        for (trajectory, series) in run.series.iter().enumerate() {
            let (step, order) = (series.times.len() - 1, method.order());
            let coefficients = &series.coefficients[step * (order + 1) * 9..];
            let tau = times[1] - series.times[step];
            for i in 0..9 {
                let value = (0..=order).rev().fold(0.0, |sum, k| sum * tau + coefficients[9 * k + i]);
                let error = (value - wanted.states[27 * trajectory + 18 + i]).abs();
                assert!(error < 1e-11, "rate 1e{exponent}: {error:e}");
            }
        }
    }
}

/// Crossings of `l1 = 0` are as many, and at the same times in units of the motion.
#[test]
fn sections_are_the_same_in_all_units() {
    let function = Functions::new(9, vec![], vec![0]).unwrap();
    let surface = Surface { function, kept: None, guard: None, direction: 0, n_crossings: None, sides: vec![] };
    let of = |rate: f64| {
        let (top, states, times) = (parameters_at(rate).top(), starts(TRAJECTORIES), [0.0, 20.0 / rate]);
        let method = taylor(1e-14);
        let ensemble = Ensemble { field: &top, method, states: &states, tangents: &[], n_tangents: 0, times: &times };
        sections(&ensemble, &surface, 1, Simd::widest(), &Control::default(), |_| ()).unwrap()
    };
    let wanted = of(1.0);
    for exponent in [-40, -20, -14, 14, 20, 40] {
        let rate = 10.0_f64.powi(exponent);
        let found = of(rate);
        assert_eq!(found.crossing_counts, wanted.crossing_counts, "rate 1e{exponent}");
        let seen: f64 =
            found.uncertified.iter().map(|uncertified| uncertified.unresolved_time + uncertified.undefined_time).sum();
        assert_eq!(seen, 0.0, "rate 1e{exponent}");
        for (found, wanted) in found.crossings.times.iter().zip(&wanted.crossings.times) {
            assert!((found * rate - wanted).abs() < 1e-9, "rate 1e{exponent}: {} for {wanted}", found * rate);
        }
    }
}
