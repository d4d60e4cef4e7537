//! Ensembles: the same bits whatever the threads and lanes, one outcome per trajectory, no poisoned neighbours.

use crate::common::*;
use liepoisson_core::analysis::lyapunov::finite_time_exponents;
use liepoisson_core::analysis::orbit::orbits;
use liepoisson_core::ensemble::{Control, Ensemble, Observer, Outcome, Step, Stop, Summary};
use liepoisson_core::error::Error;
use liepoisson_core::field::{Instruction, Quadratic, Tape};
use liepoisson_core::lanes::Simd;
use liepoisson_core::method::{RungeKutta, Single, Taylor};
use proptest::prelude::*;
use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Every SIMD kernel against the plain loop, on ensembles in which some trajectories fail in various ways.
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
        let ensemble = Ensemble {
            field: &top, method: Taylor::new(1e-12, None, 2_000).unwrap(), states: &states, tangents: &tangents,
            n_tangents: 2, times: &[0.0, 0.7, 4.0],
        };
        let results = everywhere(|simd, threads| {
            let orbits = orbits(&ensemble, threads, simd, &Control::default(), true, |_| ()).unwrap();
            let found = finite_time_exponents(&ensemble, threads, simd, &Control::default(), |_| ()).unwrap();
            (orbits, bits(&found.exponents))
        });
        let (orbits, exponents): (Vec<_>, Vec<_>) = results.into_iter().unzip();
        assert_same_bits(&orbits, true);
        prop_assert!(exponents.iter().all(|other| *other == exponents[0]));
    }
}

#[test]
fn a_trajectory_is_the_same_alone_and_in_company() {
    let top = TWISTED_KOVALEVSKAYA.top();
    let states = starts(50);
    let all = run(&top, taylor(1e-14), &states, &[], &[0.0, 20.0], Simd::widest());
    for trajectory in [0, 17, 49] {
        let alone =
            run(&top, taylor(1e-14), &states[9 * trajectory..9 * trajectory + 9], &[], &[0.0, 20.0], Simd::widest());
        assert_eq!(alone.states, all.states[18 * trajectory..18 * trajectory + 18]);
    }
}

#[test]
fn failing_trajectories_have_outcomes_and_do_not_touch_their_neighbours() {
    let top = TWISTED_KOVALEVSKAYA.top();
    let good = starts(20);
    let mut states = good.clone();
    states[9 * 3] = f64::NAN;
    states[9 * 4 + 1] = f64::INFINITY;
    states[9 * 5 + 2] = 1e200; // its products overflow
    let mut tangents = vec![0.0; 180];
    tangents.fill(0.5);
    let times = [0.0, 1.0, 10.0];
    let orbits = run(&top, taylor(1e-12), &states, &tangents, &times, Simd::widest());
    let reference = run(&top, taylor(1e-12), &good, &tangents, &times, Simd::widest());
    for trajectory in 0..20 {
        let (summary, rows) = (&orbits.summaries[trajectory], &orbits.states[27 * trajectory..27 * trajectory + 27]);
        if (3..=5).contains(&trajectory) {
            assert_eq!((summary.outcome, summary.time, summary.n_steps), (Outcome::NotFinite, 0.0, 0));
            assert!(rows[18..].iter().all(|x| x.is_nan()));
            // the last state is the one that came
            assert_eq!(bits(&summary.state), bits(&states[9 * trajectory..9 * trajectory + 9]));
        } else {
            assert_eq!(summary.outcome, Outcome::Finished);
            assert_eq!(rows, &reference.states[27 * trajectory..27 * trajectory + 27]);
        }
    }
}

#[test]
fn a_budget_of_steps_ends_a_trajectory_at_its_last_good_state() {
    let top = TWISTED_KOVALEVSKAYA.top();
    let states = starts(9);
    let method = Taylor::new(1e-12, None, 10).unwrap();
    let orbits = run(&top, method, &states, &[], &[0.0, 1.0, 1e6], Simd::widest());
    for (trajectory, summary) in orbits.summaries.iter().enumerate() {
        assert_eq!((summary.outcome, summary.n_steps), (Outcome::MaxSteps, 10));
        assert!(summary.time > 1.0 && summary.time < 100.0);
        // the state at the time reached is on the orbit
        let to_there =
            run(&top, taylor(1e-12), &states[9 * trajectory..][..9], &[], &[0.0, summary.time], Simd::Scalar);
        assert!(distance(&to_there.states[9..], &summary.state) < 1e-9);
    }
}

#[test]
fn an_equilibrium_takes_one_step() {
    let top = TWISTED_KOVALEVSKAYA.top();
    let hanging = [0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0]; // alpha along a, at rest
    let orbits = run(&top, taylor(1e-15), &hanging, &[], &[0.0, 1e9], Simd::Scalar);
    assert_eq!(orbits.states[9..], hanging);
    assert_eq!(orbits.summaries[0].n_steps, 1);
}

#[test]
fn cancelling_ends_a_run_soon_and_says_so() {
    let top = TWISTED_KOVALEVSKAYA.top();
    let states = starts(40);
    let method = Taylor::new(1e-15, None, u64::MAX).unwrap();
    let ensemble = Ensemble { field: &top, method, states: &states, tangents: &[], n_tangents: 0, times: &[0.0, 1e12] };
    let control = Control::default();
    let orbits = orbits(&ensemble, 2, Simd::widest(), &control, false, |_| control.cancel()).unwrap();
    assert!(orbits.summaries.iter().all(|summary| summary.outcome == Outcome::Cancelled));
    assert!(control.done() < 40.0);
}

#[test]
fn progress_counts_every_trajectory_once() {
    let top = TWISTED_KOVALEVSKAYA.top();
    let mut states = starts(33);
    states[0] = f64::NAN; // a failed trajectory counts as done
    let ensemble = Ensemble {
        field: &top,
        method: taylor(1e-12),
        states: &states,
        tangents: &[],
        n_tangents: 0,
        times: &[5.0, -40.0],
    };
    let control = Control::default();
    orbits(&ensemble, 2, Simd::widest(), &control, false, |_| ()).unwrap();
    assert!((control.done() - 33.0).abs() < 1e-6, "{}", control.done());
}

#[test]
fn parts_that_do_not_fit_are_refused() {
    let top = TWISTED_KOVALEVSKAYA.top();
    let (states, method) = (starts(2), taylor(1e-12));
    let check = |states: &[f64], tangents: &[f64], times: &[f64]| {
        Ensemble { field: &top, method, states, tangents, n_tangents: 1, times }.check()
    };
    assert_eq!(check(&states, &states, &[0.0, 1.0]), Ok(()));
    assert!(matches!(check(&states[1..], &states, &[0.0, 1.0]), Err(Error::Length { name: "states", .. })));
    assert!(matches!(check(&states, &states[9..], &[0.0, 1.0]), Err(Error::Length { name: "tangents", .. })));
    assert_eq!(check(&states, &states, &[0.0]), Err(Error::Times { index: 1 }));
    assert_eq!(check(&states, &states, &[0.0, 2.0, 1.0]), Err(Error::Times { index: 2 }));
    assert_eq!(check(&states, &states, &[0.0, f64::NAN]), Err(Error::Times { index: 1 }));
    assert_eq!(check(&states, &states, &[0.0, 0.0]), Err(Error::Times { index: 1 }));
}

#[test]
fn a_zero_tangent_vector_is_refused() {
    let top = TWISTED_KOVALEVSKAYA.top();
    let (states, mut tangents) = (starts(3), starts(3));
    tangents[9..18].fill(0.0);
    let ensemble = Ensemble {
        field: &top,
        method: taylor(1e-12),
        states: &states,
        tangents: &tangents,
        n_tangents: 1,
        times: &[0.0, 1.0],
    };
    let refused = finite_time_exponents(&ensemble, 1, Simd::Scalar, &Control::default(), |_| ()).err();
    assert_eq!(refused, Some(Error::TangentVector { trajectory: 1 }));
}

#[test]
fn exponent_is_the_logarithm_of_the_growth_of_the_tangent_vector() {
    let top = TWISTED_KOVALEVSKAYA.top();
    let (states, tangents) = (starts(6), starts(6));
    let times = [0.0, 3.0, 400.0];
    let ensemble = Ensemble {
        field: &top,
        method: taylor(1e-13),
        states: &states,
        tangents: &tangents,
        n_tangents: 1,
        times: &times,
    };
    let found = finite_time_exponents(&ensemble, 1, Simd::Scalar, &Control::default(), |_| ()).unwrap();
    let orbits = run(&top, taylor(1e-13), &states, &tangents, &times, Simd::Scalar);
    let norm = |v: &[f64]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
    for trajectory in 0..6 {
        for index in [1, 2] {
            let end = &orbits.tangents[27 * trajectory + 9 * index..][..9];
            let expected = (norm(end) / norm(&tangents[9 * trajectory..][..9])).ln() / times[index];
            let exponent = found.exponents[2 * trajectory + index - 1];
            assert!((exponent - expected).abs() < 1e-14, "{exponent} {expected}");
        }
    }
}

/// Growth by exp(800 sqrt 2) overflows no number: powers of two are taken out, and counted anew for each trajectory.
#[test]
fn growth_beyond_the_largest_number_is_followed() {
    let top = TWISTED_KOVALEVSKAYA.top();
    let unstable = [0.0, 0.0, 0.0, -2.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let trajectories = 40; // more than there are lanes, so that slots are taken again
    let (states, tangents) =
        (unstable.repeat(trajectories), [[0.0, 0.0, 1.0], [0.0; 3], [0.0; 3]].concat().repeat(trajectories));
    let ensemble = Ensemble {
        field: &top,
        method: taylor(1e-15),
        states: &states,
        tangents: &tangents,
        n_tangents: 1,
        times: &[0.0, 800.0],
    };
    let found = finite_time_exponents(&ensemble, 1, Simd::widest(), &Control::default(), |_| ()).unwrap();
    // l3 = cosh(t sqrt 2), alpha2 = -sqrt 2 sinh(t sqrt 2): |v| = exp(t sqrt 2) sqrt(3) / 2
    let expected = 2.0_f64.sqrt() + (3.0_f64.sqrt() / 2.0).ln() / 800.0;
    for exponent in found.exponents {
        assert!((exponent - expected).abs() < 1e-13, "{exponent} {expected}");
    }
}

#[test]
fn length_of_the_initial_tangent_vector_does_not_count() {
    let top = TWISTED_KOVALEVSKAYA.top();
    let states = starts(3);
    let exponents = |tangents: &[f64]| {
        let ensemble = Ensemble {
            field: &top,
            method: taylor(1e-13),
            states: &states,
            tangents,
            n_tangents: 1,
            times: &[0.0, 0.1, 9.0],
        };
        finite_time_exponents(&ensemble, 1, Simd::Scalar, &Control::default(), |_| ()).unwrap().exponents
    };
    let expected = exponents(&states);
    for scale in [1e-300, 1e-161, 1e160, 1e300] {
        let scaled: Vec<f64> = states.iter().map(|component| component * scale).collect();
        assert!(distance(&exponents(&scaled), &expected) < 1e-13, "{scale:e}");
    }
}

/// Cancels at the first sample, and counts how many it sees.
struct Impatient<'c> {
    control: &'c Control,
    seen: &'c AtomicUsize,
    outcomes: &'c Mutex<Vec<Outcome>>,
}

impl Observer for Impatient<'_> {
    fn begin(&mut self, _lane: usize, _trajectory: usize) {}

    fn sample(&mut self, _lane: usize, _index: usize, _tau: f64, _step: &Step<'_>) {
        self.control.cancel();
        self.seen.fetch_add(1, Ordering::Relaxed);
    }
    fn end(&mut self, _lane: usize, _trajectory: usize, summary: Summary) {
        self.outcomes.lock().unwrap().push(summary.outcome);
    }
}

#[test]
fn cancelling_is_seen_between_the_samples_of_one_step_and_fills_no_slot() {
    let top = TWISTED_KOVALEVSKAYA.top();
    let hanging = [0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0].repeat(3); // one step to any time
    let times: Vec<f64> = (0..100_000).map(f64::from).collect();
    let ensemble =
        Ensemble { field: &top, method: taylor(1e-12), states: &hanging, tangents: &[], n_tangents: 0, times: &times };
    let (control, seen, outcomes) = (Control::default(), AtomicUsize::new(0), Mutex::new(Vec::new()));
    let observer = |_| Impatient { control: &control, seen: &seen, outcomes: &outcomes };
    ensemble.run(1, Simd::Scalar, &control, observer, |_| ()).unwrap();
    assert!(seen.into_inner() < 10_000);
    assert_eq!(outcomes.into_inner().unwrap(), [Outcome::Cancelled]);
}

#[test]
fn a_step_with_millions_of_wanted_times_ends_with_the_limit_of_time() {
    // a body at rest: its series is constant, and all times are in one step
    let rest = Quadratic::new(1, &[], &[], &[]).unwrap();
    let times: Vec<f64> = (0..4_000_000).map(f64::from).collect();
    let ensemble =
        Ensemble { field: &rest, method: taylor(1e-15), states: &[1.0], tangents: &[], n_tangents: 0, times: &times };
    let control = Control::with_time_limit(Duration::from_millis(2));
    let found = orbits(&ensemble, 1, Simd::widest(), &control, false, |_| ()).unwrap();
    assert_eq!(found.summaries[0].outcome, Outcome::TimeLimit);
    assert!(found.states.last().unwrap().is_nan());
}

#[test]
fn a_field_whose_steps_take_long_ends_with_the_limit_of_time() {
    // x' = sin(sin(... x)): a step takes milliseconds, of which 64 were taken between two looks at the clock
    let sines = (0..20_000).map(Instruction::Sin).collect();
    let field = Tape::new(1, sines, vec![20_000]).unwrap();
    let ensemble = Ensemble {
        field: &field,
        method: taylor(1e-15),
        states: &[1.0],
        tangents: &[],
        n_tangents: 0,
        times: &[0.0, 1e9],
    };
    let control = Control::with_time_limit(Duration::from_millis(1));
    let found = orbits(&ensemble, 1, Simd::widest(), &control, false, |_| ()).unwrap();
    assert_eq!(found.summaries[0].outcome, Outcome::TimeLimit);
    assert!(found.summaries[0].n_steps <= 3, "{}", found.summaries[0].n_steps);
}

/// Panics in the third step of trajectory 1.
struct Clumsy(Vec<usize>);

impl Observer for Clumsy {
    fn begin(&mut self, lane: usize, trajectory: usize) {
        self.0[lane] = trajectory;
    }
    fn step(&mut self, lane: usize, step: &Step<'_>) -> ControlFlow<Stop> {
        assert!(self.0[lane] != 1 || step.time < 1.0, "trajectory 1 stumbles");
        ControlFlow::Continue(())
    }
    fn end(&mut self, _lane: usize, _trajectory: usize, _summary: Summary) {}
}

#[test]
fn a_worker_that_panics_stops_the_others_and_its_message_arrives() {
    let top = TWISTED_KOVALEVSKAYA.top();
    let states = starts(40);
    let ensemble = Ensemble {
        field: &top,
        method: Taylor::new(1e-12, None, u64::MAX).unwrap(),
        states: &states,
        tangents: &[],
        n_tangents: 0,
        times: &[0.0, 1e12], // ends with the universe, unless it is stopped
    };
    let control = Control::default();
    let run = || ensemble.run(2, Simd::widest(), &control, |lanes| Clumsy(vec![0; lanes]), |_| ());
    let panic = std::panic::catch_unwind(std::panic::AssertUnwindSafe(run)).unwrap_err();
    assert_eq!(panic.downcast_ref::<&str>(), Some(&"trajectory 1 stumbles"));
}

#[test]
fn no_trajectories_make_an_empty_result() {
    let top = TWISTED_KOVALEVSKAYA.top();
    for n_tangents in [0, 1, usize::MAX] {
        let ensemble =
            Ensemble { field: &top, method: taylor(1e-12), states: &[], tangents: &[], n_tangents, times: &[0.0, 1.0] };
        let found = orbits(&ensemble, 4, Simd::widest(), &Control::default(), true, |_| ()).unwrap();
        assert!(found.states.is_empty() && found.summaries.is_empty());
    }
}

#[test]
fn a_state_below_the_numbers_of_single_precision_fails_and_does_not_rest_at_zero() {
    let top = TWISTED_KOVALEVSKAYA.top();
    let single = Single::<RungeKutta>::new(RungeKutta::fixed(0.1, 1000).unwrap()).unwrap();
    for (scale, outcome) in [(1e-300, Outcome::NotFinite), (1e-30, Outcome::Finished), (0.0, Outcome::Finished)] {
        let states: Vec<f64> = starts(5).iter().map(|x| x * scale).collect();
        let found = run(&top, single, &states, &[], &[0.0, 1.0], Simd::widest());
        assert!(found.summaries.iter().all(|summary| summary.outcome == outcome), "{scale:e}: {:?}", found.summaries);
    }
}
