//! Orbits: states and tangent vectors at given times, and the power series of every step on request.

use super::{POISONED, Rows, UNREACHED, filled, name_unreached};
use crate::ensemble::{AnyEnsemble, Control, Observer, Step, Stop, Summary, Watch};
use crate::error::Error;
use crate::lanes::Simd;
use crate::method::sum_series;
use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

/// States at the times of an ensemble. What a trajectory did not reach is NaN; its outcome says why.
pub struct Orbits {
    /// `(trajectory, time, component)`.
    pub states: Vec<f64>,
    /// `(trajectory, time, tangent, component)`, of the size that they have at that time.
    pub tangents: Vec<f64>,
    /// The end of each trajectory.
    pub summaries: Vec<Summary>,
    /// Dense output of each trajectory, if it was asked for.
    pub series: Vec<Series>,
}

/// Dense output: the accepted steps of one trajectory, each with the power series of the state about its start.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// Time at the start of each step.
    pub times: Vec<f64>,
    /// `(step, order, component)`.
    pub coefficients: Vec<f64>,
}

/// Dense output that somebody else keeps: one trajectory.
#[derive(Clone, Copy, Debug)]
pub struct Kept<'k> {
    /// Time at the start of each step, in the order of travel.
    pub times: &'k [f64],
    /// `(step, order, component)`.
    pub coefficients: &'k [f64],
    /// Time that the trajectory reached.
    pub end: f64,
}

/// States of trajectories with dense output at `times`, `(trajectory, time, component)`; NaN at times beyond their end.
///
/// Times that follow one another within a step are summed side by side, so that times in order are quickest.
///
/// # Errors
/// No memory for the states; coefficients that are not so many for each step.
pub fn states_at(kept: &[Kept<'_>], n: usize, times: &[f64], backwards: bool, simd: Simd) -> Result<Vec<f64>, Error> {
    let size = times.len().saturating_mul(n);
    let mut states = filled(kept.len().saturating_mul(size), f64::NAN)?;
    if size == 0 {
        return Ok(states);
    }
    let mut taus = Vec::new();
    for (kept, states) in kept.iter().zip(states.chunks_exact_mut(size)) {
        let Some(per_step) = kept.coefficients.len().checked_div(kept.times.len()) else { continue };
        if per_step < n || !per_step.is_multiple_of(n) || per_step * kept.times.len() != kept.coefficients.len() {
            return Err(Error::Length {
                name: "coefficients",
                wanted: n * kept.times.len(),
                got: kept.coefficients.len(),
            });
        }
        let is_before = |a: f64, b: f64| if backwards { a > b } else { a < b };
        let (mut first, mut step) = (0, 0);
        while first < times.len() {
            if is_before(kept.end, times[first]) {
                first += 1;
                continue;
            }
            step = step_at(kept.times, step, |start| !is_before(times[first], start));
            let (start, next) = (kept.times[step], kept.times.get(step + 1).copied());
            let is_within = |time: f64| {
                !is_before(kept.end, time) && !is_before(time, start) && next.is_none_or(|next| is_before(time, next))
            };
            taus.clear();
            taus.push(times[first] - start);
            taus.extend(times[first + 1..].iter().take_while(|&&time| is_within(time)).map(|time| time - start));
            let series = &kept.coefficients[step * per_step..][..per_step];
            sum_series(simd, series, n, &taus, &mut states[first * n..(first + taus.len()) * n]);
            first += taus.len();
        }
    }
    Ok(states)
}

/// The last step, or the first, that has begun; it is mostly `near` or the one after it.
fn step_at(starts: &[f64], near: usize, has_begun: impl Fn(f64) -> bool) -> usize {
    let is_step = |k: usize| has_begun(starts[k]) && starts.get(k + 1).is_none_or(|&next| !has_begun(next));
    match (near..starts.len().min(near + 2)).find(|&k| is_step(k)) {
        Some(step) => step,
        None => starts.partition_point(|&start| has_begun(start)).saturating_sub(1),
    }
}

/// Integrates the ensemble and keeps its states at each of its times.
///
/// # Errors
/// See [`AnyEnsemble::check`].
pub fn orbits<'a>(
    ensemble: impl Into<AnyEnsemble<'a>>,
    threads: usize,
    simd: Simd,
    control: &Control,
    dense: bool,
    mut watch: impl FnMut(&dyn Fn(Duration) -> bool),
) -> Result<Orbits, Error> {
    orbits_of(&ensemble.into(), threads, simd, control, dense, &mut watch)
}

fn orbits_of(
    ensemble: &AnyEnsemble<'_>,
    threads: usize,
    simd: Simd,
    control: &Control,
    dense: bool,
    watch: Watch<'_>,
) -> Result<Orbits, Error> {
    ensemble.check()?;
    let (n, n_times, n_tangents) = (ensemble.n_components, ensemble.times.len(), ensemble.n_tangents);
    let trajectories = ensemble.n_trajectories();
    let numbers = trajectories.saturating_mul(n_times).saturating_mul(n);
    let mut states = filled(numbers, f64::NAN)?;
    let mut tangents = filled(numbers.saturating_mul(n_tangents), f64::NAN)?;
    let ended = Mutex::new(Ended {
        summaries: filled(trajectories, UNREACHED)?,
        series: filled(if dense { trajectories } else { 0 }, Series::default())?,
    });
    let refused = AtomicUsize::new(0);
    let (state_rows, tangent_rows) = (Rows::new(&mut states, trajectories), Rows::new(&mut tangents, trajectories));
    ensemble.run(
        threads,
        simd,
        control,
        |lanes| Recorder {
            shared: &ended,
            rows: [&state_rows, &tangent_rows],
            n,
            n_tangents,
            states: empty_rows(lanes),
            tangents: empty_rows(lanes),
            series: vec![Series::default(); lanes],
            dense,
            control,
            refused: &refused,
        },
        watch,
    )?;
    let bytes = refused.into_inner();
    if bytes > 0 {
        return Err(Error::Memory { bytes });
    }
    let Ended { mut summaries, series } = ended.into_inner().expect(POISONED);
    name_unreached(&mut summaries, control);
    Ok(Orbits { states, tangents, summaries, series })
}

/// What is known of trajectories that have ended, beside their rows.
struct Ended {
    summaries: Vec<Summary>,
    series: Vec<Series>,
}

fn empty_rows<'r>(lanes: usize) -> Vec<&'r mut [f64]> {
    (0..lanes).map(|_| Default::default()).collect()
}

struct Recorder<'o> {
    shared: &'o Mutex<Ended>,
    /// Where states and tangent vectors of all trajectories belong.
    rows: [&'o Rows<'o>; 2],
    n: usize,
    n_tangents: usize,
    states: Vec<&'o mut [f64]>,
    tangents: Vec<&'o mut [f64]>,
    series: Vec<Series>,
    dense: bool,
    control: &'o Control,
    /// Bytes that dense output could not have, because the memory is used up; the run is then cancelled.
    refused: &'o AtomicUsize,
}

impl Observer for Recorder<'_> {
    fn begin(&mut self, lane: usize, trajectory: usize) {
        (self.states[lane], self.tangents[lane]) = (self.rows[0].take(trajectory), self.rows[1].take(trajectory));
        self.series[lane] = Series::default();
    }

    fn step(&mut self, lane: usize, step: &Step<'_>) -> ControlFlow<Stop> {
        if self.dense {
            let Series { times, coefficients } = &mut self.series[lane];
            if times.try_reserve(1).is_err() || step.copy_series(usize::MAX, coefficients).is_err() {
                self.refused.store((8 * coefficients.len()).max(1), Ordering::Relaxed);
                self.control.cancel();
                self.series[lane] = Series::default();
                return ControlFlow::Break(Stop::Served { after: step.size });
            }
            times.push(step.time);
        }
        ControlFlow::Continue(())
    }

    fn sample(&mut self, lane: usize, index: usize, tau: f64, step: &Step<'_>) {
        self.samples(lane, index, &[tau], step);
    }

    fn samples(&mut self, lane: usize, first: usize, taus: &[f64], step: &Step<'_>) {
        let (n, n_tangents, count) = (self.n, self.n_tangents, taus.len());
        step.states(taus, &mut self.states[lane][first * n..(first + count) * n]);
        let tangents = &mut self.tangents[lane][first * n_tangents * n..(first + count) * n_tangents * n];
        for k in 0..n_tangents {
            let stride = n_tangents * n;
            let scale = step.tangents(k, taus, n, &mut tangents[k * n..], stride).clamp(-5000, 5000) as i32;
            if scale != 0 {
                for tangent in tangents[k * n..].chunks_mut(stride) {
                    tangent[..n].iter_mut().for_each(|component| *component = libm::scalbn(*component, scale));
                }
            }
        }
    }

    fn end(&mut self, lane: usize, trajectory: usize, summary: Summary) {
        let mut shared = self.shared.lock().expect(POISONED);
        shared.summaries[trajectory] = summary;
        if self.dense {
            shared.series[trajectory] = std::mem::take(&mut self.series[lane]);
        }
    }
}
