//! Regular, chaotic or undecided: the one rule, and the four indicators that vote in it, from samples along an orbit.
//!
//! Sums run in NumPy's order, which the numbers of earlier versions had: pairwise along a row, one after the other across rows.
//!
//! # References
//! Cincotta and Simó, Astron. Astrophys. Suppl. 147 (2000) 205: MEGNO. Skokos, J. Phys. A 34 (2001) 10029: SALI. Das, Saiki,
//! Sander and Yorke, Nonlinearity 30 (2017) 4111: weighted averages.

use super::lyapunov::finite_time_exponents;
use super::orbit::{Orbits, orbits};
use super::{filled, last_states};
use crate::ensemble::{AnyEnsemble, Control, Integrator, Outcome, Summary};
use crate::error::Error;
use crate::lanes::Simd;
use std::f64::consts::PI;
use std::sync::Arc;

/// Growth power, MEGNO, SALI and the change of averages, in this order; NaN of one that has no value.
pub type Indicators = [f64; 4];

/// What is said of an orbit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The orbit lies on a torus.
    Regular = -1,
    /// The votes do not suffice, or contradict each other, or the run was too short.
    Undecided = 0,
    /// Tangent vectors grow exponentially.
    Chaotic = 1,
}

/// Thresholds (regular, chaotic) of the indicators; a value between the two is no vote.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rule {
    /// Regular below the first, chaotic above the second.
    pub growth_power: [f64; 2],
    /// The same.
    pub megno: [f64; 2],
    /// Regular above the first, chaotic below the second.
    pub sali: [f64; 2],
    /// Settled below; no vote above.
    pub averages: f64,
    /// In natural units; all is undecided in shorter runs.
    pub least_time: f64,
}

impl Rule {
    /// That of which the error rates were measured; where its numbers come from, Python's `Rule` says.
    pub const USUAL: Rule =
        Rule { growth_power: [2.0, 4.0], megno: [3.0, 5.0], sali: [1e-4, 1e-8], averages: 4e-3, least_time: 100.0 };

    /// What each indicator says: -1 regular, 1 chaotic, 0 neither.
    pub fn votes(&self, [growth_power, megno, sali, averages]: Indicators) -> [i8; 4] {
        let vote = |is_regular: bool, is_chaotic: bool| i8::from(is_chaotic && !is_regular) - i8::from(is_regular);
        let rising = |value: f64, [low, high]: [f64; 2]| vote(value < low, value > high);
        [
            rising(growth_power, self.growth_power),
            rising(megno, self.megno),
            vote(sali > self.sali[0], sali < self.sali[1]),
            vote(averages < self.averages, false),
        ]
    }

    /// "Chaotic" are two votes for it and none against it among the first three; "regular" the same for it, and settled averages.
    pub fn kind(&self, votes: [i8; 4], natural_time: f64) -> Kind {
        let [of_vectors @ .., settled] = votes;
        let count = |sign: i8| of_vectors.iter().filter(|vote| vote.signum() == sign).count();
        let (for_chaos, for_order) = (count(1), count(-1));
        match natural_time >= self.least_time {
            true if for_chaos >= 2 && for_order == 0 => Kind::Chaotic,
            true if for_order >= 2 && for_chaos == 0 && settled < 0 => Kind::Regular,
            _ => Kind::Undecided,
        }
    }
}

/// MEGNO and its mean at equally spaced times from the growth `ln|v|` there:
/// `Y(t) = 2 (ln|v| - (1/t) integral of ln|v|)`, by the trapezoidal rule from 0, where the integrands vanish.
pub fn megno(times: &[f64], log_growth: &[f64]) -> [Vec<f64>; 2] {
    let step = times.first().copied().unwrap_or(0.0);
    let integrals = |values: &[f64]| -> Vec<f64> {
        let mut sum = 0.0;
        let integral = values.iter().enumerate().map(|(k, value)| {
            sum = if k == 0 { *value } else { sum + value };
            step * (sum - 0.5 * value)
        });
        integral.collect()
    };
    let of = integrals(log_growth);
    let values: Vec<f64> = log_growth
        .iter()
        .zip(&of)
        .zip(times)
        .map(|((growth, integral), time)| 2.0 * (growth - integral / time))
        .collect();
    let means = integrals(&values).iter().zip(times).map(|(integral, time)| integral / time).collect();
    [values, means]
}

/// Least-squares slope of `ln|v|` against `ln t` over the last decade of the times.
pub fn growth_power(times: &[f64], log_growth: &[f64]) -> f64 {
    // round-off decides for no sample in any unit of time
    let least = times.last().map_or(0.0, |end| 0.1 * (1.0 - 1e-9) * end);
    let (logs, growth): (Vec<f64>, Vec<f64>) = times
        .iter()
        .zip(log_growth)
        .filter(|(time, _)| **time >= least)
        .map(|(time, growth)| (libm::log(*time), *growth))
        .unzip();
    let mean = pairwise(&logs) / logs.len() as f64;
    let centred: Vec<f64> = logs.iter().map(|log| log - mean).collect();
    let products: Vec<f64> = growth.iter().zip(&centred).map(|(growth, log)| growth * log).collect();
    let squares: Vec<f64> = centred.iter().map(|log| log * log).collect();
    pairwise(&products) / pairwise(&squares)
}

/// Closer directions cannot be told apart.
const FLOOR: f64 = 1e-16;

/// The smaller alignment index of two unit vectors: the length of their difference or of their sum.
pub fn sali(one: &[f64], other: &[f64]) -> f64 {
    let length = |combined: fn(f64, f64) -> f64| {
        let squares: Vec<f64> = one.iter().zip(other).map(|(a, b)| combined(*a, *b)).map(|x| x * x).collect();
        pairwise(&squares).sqrt()
    };
    let (difference, sum) = (length(|a, b| a - b), length(|a, b| a + b));
    if difference.is_nan() || sum.is_nan() {
        return f64::NAN;
    }
    difference.min(sum).max(FLOOR)
}

/// The vector, each component in its unit, with length one; first by its largest component, whose square may leave the range
/// of numbers.
fn unit_vector(vector: &[f64], units: &[f64]) -> Vec<f64> {
    let mut scaled: Vec<f64> = vector.iter().zip(units).map(|(x, unit)| x / unit).collect();
    let largest = scaled.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    scaled.iter_mut().for_each(|x| *x /= largest);
    let squares: Vec<f64> = scaled.iter().map(|x| x * x).collect();
    let length = pairwise(&squares).sqrt();
    scaled.iter_mut().for_each(|x| *x /= length);
    scaled
}

/// The first and the last part of a run, of which averages are compared: they share a third, and more tori have settled in
/// 0.6 of a run than in a half of it (of 24 regular orbits of a weakly perturbed top 20 instead of 19, of 80 of another 53
/// and 49).
const PART: f64 = 0.6;
/// A component below this part of the largest one, and a square that varies by less than this part of its size, is round-off:
/// its averages would be those of noise.
const ROUND_OFF: f64 = 1e-10;

/// The largest change of the average square from the first to the last part of a run, over the spread of the square, of
/// `n` functions at equally spaced times `(time, function)`; averages have the window `sin^4`. NaN where a value is not finite.
pub fn average_change(values: &[f64], n: usize) -> f64 {
    let length = values.len().checked_div(n).unwrap_or(0);
    let part = (PART * length as f64) as usize;
    let sines = (0..part).map(|k| libm::sin(PI * (k as f64 + 0.5) / part as f64));
    let mut window: Vec<f64> = sines.map(|sine| sine * sine).map(|square| square * square).collect();
    let total = pairwise(&window);
    window.iter_mut().for_each(|weight| *weight /= total);
    let squares: Vec<f64> = values.iter().map(|value| value * value).collect();
    let mean = |of: &dyn Fn(usize, f64) -> f64| -> Vec<f64> {
        let mut sums = vec![0.0; n];
        for row in squares.chunks_exact(n) {
            sums.iter_mut().zip(row).enumerate().for_each(|(i, (sum, square))| *sum += of(i, *square));
        }
        sums.iter().map(|sum| sum / length as f64).collect()
    };
    let size = mean(&|_, square| square);
    if !size.iter().all(|size| size.is_finite()) {
        return f64::NAN;
    }
    let variance = mean(&|i, square| (square - size[i]) * (square - size[i]));
    let weighted = |rows: &[f64]| {
        let mut sums = vec![0.0; n];
        for (row, weight) in rows.chunks_exact(n).zip(&window) {
            sums.iter_mut().zip(row).for_each(|(sum, square)| *sum += square * weight);
        }
        sums
    };
    let (first, last) = (weighted(&squares[..part * n]), weighted(&squares[(length - part) * n..]));
    let largest = size.iter().fold(0.0_f64, |most, size| most.max(*size));
    let mut most = 0.0_f64;
    for i in 0..n {
        let spread = variance[i].sqrt();
        if spread > ROUND_OFF * size[i] && size[i] > ROUND_OFF * ROUND_OFF * largest {
            let moved = (first[i] - last[i]).abs() / spread;
            most = if moved.is_nan() || most.is_nan() { f64::NAN } else { most.max(moved) };
        }
    }
    most
}

/// The sum in NumPy's order of a row: halves of more than 128 terms, and of each eight sums side by side.
fn pairwise(terms: &[f64]) -> f64 {
    const AT_ONCE: usize = 128;
    let n = terms.len();
    if n < 8 {
        return terms.iter().fold(0.0, |sum, term| sum + term);
    }
    if n > AT_ONCE {
        let half = n / 2 - n / 2 % 8;
        return pairwise(&terms[..half]) + pairwise(&terms[half..]);
    }
    let (eights, rest) = terms.as_chunks::<8>();
    let mut r = eights[0];
    for eight in &eights[1..] {
        r.iter_mut().zip(eight).for_each(|(sum, term)| *sum += term);
    }
    let sum = ((r[0] + r[1]) + (r[2] + r[3])) + ((r[4] + r[5]) + (r[6] + r[7]));
    rest.iter().fold(sum, |sum, term| sum + term)
}

/// Samples of the state in runs of up to 8192 natural times; in longer ones twice as many for each doubling, up to 16 times.
const SAMPLES: usize = 4096;
const MOST_DOUBLINGS: i32 = 4;
/// Samples of the growth: 200 times at which the growth power is fitted, and 22 samples between them.
const STRIDE: usize = 22;
const GROWTH_SAMPLES: usize = 200 * STRIDE;
/// Tangent vectors for SALI are made unit vectors after each of so many parts of the run: they may grow by e^600 in each.
const PIECES: usize = 8;

/// Orbits that are to be decided.
#[derive(Clone, Copy, Debug)]
pub struct Question<'q> {
    /// `(trajectory, component)`, at time 0.
    pub states: &'q [f64],
    /// Three for each trajectory, `(trajectory, vector, component)`: the growth of the first is followed, the angle of the others.
    pub tangents: &'q [f64],
    /// In which angles are taken, `(trajectory, component)`.
    pub units: &'q [f64],
    /// Of components that are points of circles, infinite of others; as many of the first ones as have averages.
    pub periods: &'q [f64],
    /// Length of the run.
    pub end: f64,
    /// The same in natural units, by trajectory.
    pub natural_times: &'q [f64],
    /// Whether orbits lie in a plane, where tangent vectors always align, and SALI does not vote.
    pub is_plane: bool,
}

/// What is said of an orbit, and why.
#[derive(Clone, Copy, Debug)]
pub struct Decision {
    /// How the runs ended.
    pub outcome: Outcome,
    /// Undecided where they did not finish.
    pub kind: Kind,
    /// NaN where they did not finish.
    pub indicators: Indicators,
    /// Finite-time exponent at the end.
    pub exponent: f64,
}

/// What is said of each trajectory.
///
/// # Errors
/// See [`AnyEnsemble::check`]; vectors, units or periods that are not so many.
pub fn decide<'a>(
    rule: &Rule,
    integrator: &Arc<dyn Integrator + 'a>,
    question: &Question<'_>,
    simd: Simd,
) -> Result<Vec<Decision>, Error> {
    let n = integrator.n_components();
    let Question { states, tangents, units, periods, end, natural_times, is_plane } = *question;
    let trajectories = states.len() / n;
    for (name, wanted, got) in [
        ("tangents", 3 * states.len(), tangents.len()),
        ("units", states.len(), units.len()),
        ("periods", periods.len().min(n), periods.len()),
        ("natural times", trajectories, natural_times.len()),
    ] {
        if wanted != got {
            return Err(Error::Length { name, wanted, got });
        }
    }
    let first: Vec<f64> = tangents.chunks_exact(3 * n).flat_map(|vectors| &vectors[..n]).copied().collect();
    let fine = grid(end, GROWTH_SAMPLES);
    let ensemble = AnyEnsemble::new(integrator.clone(), states, &first, 1, &fine);
    let growth = finite_time_exponents(ensemble, 0, simd, &Control::default(), |_| ())?;
    let mut outcomes: Vec<Outcome> = growth.summaries.iter().map(|summary| summary.outcome).collect();
    let mut note = |summaries: &[Summary]| {
        for (outcome, summary) in outcomes.iter_mut().zip(summaries) {
            *outcome = if *outcome == Outcome::Finished { summary.outcome } else { *outcome };
        }
    };
    let angles = alignments(integrator, question, simd, &mut note)?;
    let doublings = |natural: &f64| libm::ceil(libm::log2((natural / (2 * SAMPLES) as f64).max(1.0))) as i32;
    let finest = natural_times.iter().map(doublings).max().unwrap_or(0).min(MOST_DOUBLINGS);
    let count = SAMPLES << finest;
    let sampled = run(integrator, (states, &[]), 0, &grid(end, count), simd)?;
    note(&sampled.summaries);
    let (times, kept) = (&fine[1..], periods.len());
    let mut found = Vec::with_capacity(trajectories);
    for (k, outcome) in outcomes.into_iter().enumerate() {
        if outcome != Outcome::Finished {
            found.push(Decision { outcome, kind: Kind::Undecided, indicators: [f64::NAN; 4], exponent: f64::NAN });
            continue;
        }
        let rates = &growth.exponents[k * GROWTH_SAMPLES..][..GROWTH_SAMPLES];
        let logs: Vec<f64> = rates.iter().zip(times).map(|(rate, time)| rate * time).collect();
        let every = |values: &[f64]| -> Vec<f64> { values.iter().skip(STRIDE - 1).step_by(STRIDE).copied().collect() };
        let [_, means] = megno(times, &logs);
        let stride = 1 << (finest - doublings(&natural_times[k]).min(MOST_DOUBLINGS));
        let mut values = Vec::with_capacity(count / stride * kept);
        let of_orbit = &sampled.states[k * (count + 1) * n..][..count * n];
        for state in of_orbit.chunks_exact(n).step_by(stride) {
            values.extend(state.iter().zip(periods).map(|(x, period)| on_circle(*x, *period)));
        }
        let indicators = [
            growth_power(&every(times), &every(&logs)),
            means[GROWTH_SAMPLES - 1],
            if is_plane { f64::NAN } else { angles[k] },
            average_change(&values, kept),
        ];
        let kind = rule.kind(rule.votes(indicators), natural_times[k]);
        found.push(Decision { outcome, kind, indicators, exponent: logs[GROWTH_SAMPLES - 1] / end });
    }
    Ok(found)
}

/// What is averaged: a component, of a point of a circle the cosine.
fn on_circle(x: f64, period: f64) -> f64 {
    if period.is_finite() { libm::cos(x * (2.0 * PI / period)) } else { x }
}

/// Equally spaced times from 0.
fn grid(end: f64, count: usize) -> Vec<f64> {
    (0..=count).map(|k| end * k as f64 / count as f64).collect()
}

/// Orbits with so many tangent vectors each.
fn run<'a>(
    integrator: &Arc<dyn Integrator + 'a>,
    (states, tangents): (&[f64], &[f64]),
    n_tangents: usize,
    times: &[f64],
    simd: Simd,
) -> Result<Orbits, Error> {
    let ensemble = AnyEnsemble::new(integrator.clone(), states, tangents, n_tangents, times);
    orbits(ensemble, 0, simd, &Control::default(), false, |_| ())
}

/// SALI at the end of each trajectory; NaN where vectors grew out of the range of numbers within a piece.
fn alignments<'a>(
    integrator: &Arc<dyn Integrator + 'a>,
    &Question { states, tangents, units, end, .. }: &Question<'_>,
    simd: Simd,
    note: &mut impl FnMut(&[Summary]),
) -> Result<Vec<f64>, Error> {
    let n = integrator.n_components();
    let mut vectors: Vec<f64> = tangents.chunks_exact(3 * n).flat_map(|vectors| &vectors[n..]).copied().collect();
    let (mut at, ones) = (states.to_vec(), filled(n, 1.0)?);
    let mut is_known = filled(states.len() / n, true)?;
    for times in grid(end, PIECES).windows(2) {
        let begun = vectors.clone();
        let found = run(integrator, (&at, &vectors), 2, times, simd)?;
        note(&found.summaries);
        let ends = found.tangents.chunks_exact(4 * n).flat_map(|pair| &pair[2 * n..]).copied().collect::<Vec<f64>>();
        vectors = ends.chunks_exact(n).flat_map(|vector| unit_vector(vector, &ones)).collect();
        // what cannot go on keeps its place
        for (k, last) in last_states(&found.summaries, n)?.chunks_exact(n).enumerate() {
            let (state, pair) = (k * n..(k + 1) * n, 2 * k * n..2 * (k + 1) * n);
            is_known[k] &= last.iter().chain(&vectors[pair.clone()]).all(|x| x.is_finite());
            if is_known[k] {
                at[state].copy_from_slice(last);
            } else {
                vectors[pair.clone()].copy_from_slice(&begun[pair]);
            }
        }
    }
    let angle = |((pair, units), is_known): ((&[f64], &[f64]), bool)| match is_known {
        true => sali(&unit_vector(&pair[..n], units), &unit_vector(&pair[n..], units)),
        false => f64::NAN,
    };
    Ok(vectors.chunks_exact(2 * n).zip(units.chunks_exact(n)).zip(is_known).map(angle).collect())
}
