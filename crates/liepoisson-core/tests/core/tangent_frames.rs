//! Frames carried over many intervals: those of one run for each interval, with the same bits everywhere.

use crate::common::*;
use liepoisson_core::analysis::frame::orthonormalise;
use liepoisson_core::analysis::tangent_frames::{Carried, Schedule, carry};
use liepoisson_core::ensemble::{Control, Ensemble, Outcome};
use liepoisson_core::error::Error;
use liepoisson_core::field::Top;
use liepoisson_core::lanes::Simd;
use liepoisson_core::method::{Method, MixedTaylor, RungeKutta, Taylor};
use std::time::Duration;

/// Vectors of a frame.
const K: usize = 3;
const TRAJECTORIES: usize = 21;
/// Enough that trajectories take turns of two.
const INTERVALS: usize = 64;
const DURATION: f64 = 0.3;

/// Everybody's first three axes.
fn frames() -> Vec<f64> {
    (0..TRAJECTORIES * 9 * K).map(|k| f64::from(u8::from(k / K % 9 == k % K))).collect()
}

fn units() -> Vec<f64> {
    (0..TRAJECTORIES * 9).map(|k| 0.5 + (k % 7) as f64).collect()
}

fn carried<M: Method<Top>>(
    method: M,
    keep: bool,
    (simd, threads): (Simd, usize),
    control: &Control,
) -> Result<Carried, Error> {
    let (top, states) = (TWISTED_KOVALEVSKAYA.top(), starts(TRAJECTORIES));
    let times = &[0.0, DURATION];
    let ensemble = Ensemble { field: &top, method, states: &states, tangents: &[], n_tangents: K, times };
    let (frames, units, elapsed) = (frames(), units(), vec![1.0; TRAJECTORIES]);
    let schedule =
        Schedule { frames: &frames, units: &units, elapsed: &elapsed, n_intervals: INTERVALS, per_row: 4, keep };
    carry(&ensemble, &schedule, threads, simd, control, |_| ())
}

/// The states, the frames and the triangles, interval by interval.
fn apart<M: Method<Top>>(method: M) -> [Vec<Vec<f64>>; 3] {
    let (top, units) = (TWISTED_KOVALEVSKAYA.top(), units());
    let (mut states, mut frames) = (starts(TRAJECTORIES), frames());
    let mut kept = [vec![], vec![], vec![]];
    for _ in 0..INTERVALS {
        let tangents: Vec<f64> = (0..TRAJECTORIES * K * 9)
            .map(|at| (at / (K * 9), at / 9 % K, at % 9))
            .map(|(trajectory, j, i)| frames[(trajectory * 9 + i) * K + j] * units[trajectory * 9 + i])
            .collect();
        let orbits = run(&top, method, &states, &tangents, &[0.0, DURATION], Simd::widest());
        let mut triangles = vec![0.0; TRAJECTORIES * K * K];
        for (trajectory, frame) in frames.chunks_exact_mut(9 * K).enumerate() {
            for (at, x) in frame.iter_mut().enumerate() {
                let (i, j) = (at / K, at % K);
                *x = orbits.tangents[((2 * trajectory + 1) * K + j) * 9 + i] / units[trajectory * 9 + i];
            }
            orthonormalise(Simd::Scalar, frame, 9, K, &mut triangles[trajectory * K * K..][..K * K]);
            states[trajectory * 9..][..9].copy_from_slice(&orbits.summaries[trajectory].state);
        }
        kept[0].push(states.clone());
        kept[1].push(frames.clone());
        kept[2].push(triangles);
    }
    kept
}

fn intervals_follow_one_another<M: Method<Top>>(method: M) {
    let wanted = apart(method);
    for found in everywhere(|simd, threads| carried(method, true, (simd, threads), &Control::default()).unwrap()) {
        for (size, found, wanted) in [
            (9, &found.kept_states, &wanted[0]),
            (9 * K, &found.kept_frames, &wanted[1]),
            (K * K, &found.triangles, &wanted[2]),
        ] {
            for (at, row) in found.chunks_exact(size).enumerate() {
                let (trajectory, interval) = (at / INTERVALS, at % INTERVALS);
                assert_eq!(bits(row), bits(&wanted[interval][trajectory * size..][..size]), "{trajectory} {interval}");
            }
        }
        for (at, &growth) in found.growth.iter().enumerate() {
            let (trajectory, row, j) = (at / K / (INTERVALS / 4), at / K % (INTERVALS / 4), at % K);
            let grown =
                (4 * row..4 * (row + 1)).map(|interval| wanted[2][interval][trajectory * K * K + j * K + j].ln());
            assert!((growth - grown.sum::<f64>()).abs() < 1e-14);
        }
        assert_eq!(bits(&found.frames), bits(&wanted[1][INTERVALS - 1]));
        for summary in &found.summaries {
            assert_eq!(summary.outcome, Outcome::Finished);
            assert!((summary.time - 1.0 - INTERVALS as f64 * DURATION).abs() < 1e-12);
        }
    }
}

#[test]
fn intervals_follow_one_another_with_the_bits_of_runs_of_their_own() {
    intervals_follow_one_another(Taylor::new(1e-10, None, 1_000).unwrap());
    intervals_follow_one_another(MixedTaylor(Taylor::new(1e-10, None, 1_000).unwrap()));
    intervals_follow_one_another(RungeKutta::new(1e-6, 1_000).unwrap());
}

#[test]
fn what_cannot_be_completed_ends_where_its_interval_begins() {
    let method = Taylor::new(1e-13, None, 1).unwrap();
    let found = carried(method, true, (Simd::widest(), 2), &Control::default()).unwrap();
    let whole =
        carried(Taylor::new(1e-13, None, 100).unwrap(), true, (Simd::widest(), 2), &Control::default()).unwrap();
    assert!(found.n_complete.iter().any(|&n| 0 < n && n < INTERVALS));
    for (trajectory, (&n, summary)) in found.n_complete.iter().zip(&found.summaries).enumerate() {
        assert_eq!(summary.outcome, if n == INTERVALS { Outcome::Finished } else { Outcome::MaxSteps });
        if n > 0 {
            let at = trajectory * INTERVALS + n - 1;
            assert_eq!(bits(&summary.state), bits(&whole.kept_states[at * 9..][..9]));
            let frame = &found.frames[trajectory * 9 * K..][..9 * K];
            assert_eq!(bits(frame), bits(&whole.kept_frames[at * 9 * K..][..9 * K]));
        }
        let rows = found.growth[trajectory * INTERVALS / 4 * K..][..INTERVALS / 4 * K].chunks_exact(K);
        assert_eq!(rows.filter(|row| row[0].is_finite()).count(), n / 4);
    }
}

#[test]
fn a_run_that_is_stopped_keeps_what_is_complete() {
    let control = Control::with_time_limit(Duration::ZERO);
    let found = carried(Taylor::new(1e-13, None, 100).unwrap(), false, (Simd::widest(), 2), &control).unwrap();
    assert!(found.summaries.iter().all(|summary| summary.outcome == Outcome::TimeLimit));
    assert!(found.summaries.iter().all(|summary| summary.state.len() == 9 && summary.time >= 1.0));
    assert!(found.kept_frames.is_empty() && found.triangles.is_empty() && found.kept_states.is_empty());
}

#[test]
fn schedules_that_do_not_fit_are_refused() {
    let (top, states) = (TWISTED_KOVALEVSKAYA.top(), starts(TRAJECTORIES));
    let (frames, units, elapsed) = (frames(), units(), vec![0.0; TRAJECTORIES]);
    let method = Taylor::new(1e-13, None, 100).unwrap();
    let good = Schedule { frames: &frames, units: &units, elapsed: &elapsed, n_intervals: 6, per_row: 3, keep: false };
    let refused = |schedule: Schedule<'_>, n_tangents, end| {
        let times = &[0.0, end];
        let ensemble = Ensemble { field: &top, method, states: &states, tangents: &[], n_tangents, times };
        carry(&ensemble, &schedule, 1, Simd::widest(), &Control::default(), |_| ()).err()
    };
    assert_eq!(refused(good, K, 1.0), None);
    for (schedule, n_tangents) in [
        (good, K + 1),
        (good, 0),
        (good, 10),
        (Schedule { units: &units[1..], ..good }, K),
        (Schedule { elapsed: &[], ..good }, K),
        (Schedule { n_intervals: 7, ..good }, K),
        (Schedule { n_intervals: 0, ..good }, K),
        (Schedule { per_row: 0, ..good }, K),
    ] {
        assert!(matches!(refused(schedule, n_tangents, 1.0), Some(Error::Length { .. })));
    }
    assert!(matches!(refused(good, K, 0.0), Some(Error::Times { .. })));
    let large = Schedule { n_intervals: usize::MAX / 16, per_row: usize::MAX / 16, keep: true, ..good };
    assert!(matches!(refused(large, K, 1.0), Some(Error::Memory { .. })));
}
