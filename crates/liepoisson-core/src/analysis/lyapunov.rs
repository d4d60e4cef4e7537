//! The largest Lyapunov exponent of each trajectory as a function of time.

use super::{POISONED, Rows, UNREACHED, filled, name_unreached};
use crate::ensemble::{AnyEnsemble, Control, Observer, Step, Summary, Watch};
use crate::error::Error;
use crate::lanes::Simd;
use std::sync::Mutex;
use std::time::Duration;

/// Growth of one tangent vector per trajectory.
pub struct FiniteTimeExponents {
    /// Finite-time exponents `(trajectory, time)` at the times after the first; NaN at times that a trajectory did not
    /// reach.
    pub exponents: Vec<f64>,
    /// The end of each trajectory.
    pub summaries: Vec<Summary>,
}

/// Finite-time exponents `ln(|v(t)| / |v(t_0)|) / (t - t_0)` of the first tangent vector at each time after the first.
///
/// Tangent vectors are only ever scaled by powers of two, so no interval of renormalisation enters the result.
///
/// # Errors
/// See [`AnyEnsemble::check`]; an ensemble without tangent vectors, or with one that is zero or not finite.
///
/// # References
/// Benettin, Galgani, Giorgilli and Strelcyn, Meccanica 15 (1980) 9.
pub fn finite_time_exponents<'a>(
    ensemble: impl Into<AnyEnsemble<'a>>,
    threads: usize,
    simd: Simd,
    control: &Control,
    mut watch: impl FnMut(&dyn Fn(Duration) -> bool),
) -> Result<FiniteTimeExponents, Error> {
    finite_time_exponents_of(&ensemble.into(), threads, simd, control, &mut watch)
}

fn finite_time_exponents_of(
    ensemble: &AnyEnsemble<'_>,
    threads: usize,
    simd: Simd,
    control: &Control,
    watch: Watch<'_>,
) -> Result<FiniteTimeExponents, Error> {
    ensemble.check()?;
    if ensemble.n_tangents == 0 {
        return Err(Error::Length { name: "tangents", wanted: ensemble.states.len(), got: 0 });
    }
    let (n, trajectories, n_times) = (ensemble.n_components, ensemble.n_trajectories(), ensemble.times.len() - 1);
    // Only the direction of a tangent vector counts, so one whose square would leave the range of numbers is brought
    // near length one by a power of two, exactly.
    let mut tangents = filled(ensemble.tangents.len(), 0.0)?;
    tangents.copy_from_slice(ensemble.tangents);
    let mut initial = Vec::with_capacity(trajectories);
    for (trajectory, vectors) in tangents.chunks_exact_mut(n * ensemble.n_tangents).enumerate() {
        let largest = vectors[..n].iter().fold(0.0_f64, |largest, component| largest.max(component.abs()));
        if largest.is_finite() && !(1e-100..1e100).contains(&largest) {
            let (_, exponent) = libm::frexp(largest);
            vectors[..n].iter_mut().for_each(|component| *component = libm::scalbn(*component, -exponent));
        }
        let norm = euclidean_norm(&vectors[..n]);
        if !(norm.is_finite() && norm > 0.0) {
            return Err(Error::TangentVector { trajectory });
        }
        initial.push(libm::log(norm));
    }
    let mut exponents = filled(trajectories.saturating_mul(n_times), f64::NAN)?;
    let summaries = Mutex::new(filled(trajectories, UNREACHED)?);
    let rows = Rows::new(&mut exponents, trajectories);
    let recorder = |lanes| Recorder {
        summaries: &summaries,
        rows: &rows,
        times: ensemble.times,
        initial: &initial,
        trajectories: vec![0; lanes],
        exponents: (0..lanes).map(|_| Default::default()).collect(),
        tangent: vec![0.0; n],
    };
    let ensemble = ensemble.with_tangents(&tangents);
    ensemble.run(threads, simd, control, recorder, watch)?;
    let mut summaries = summaries.into_inner().expect(POISONED);
    name_unreached(&mut summaries, control);
    Ok(FiniteTimeExponents { exponents, summaries })
}

#[inline(always)]
fn euclidean_norm(vector: &[f64]) -> f64 {
    vector.iter().fold(0.0_f64, |sum, &component| component.mul_add(component, sum)).sqrt()
}

/// `ln(norm 2^scale)`, with the same bits however the product is divided between the two: when a tangent vector was
/// rescaled depends on how many equal steps its neighbours allowed at once.
fn logarithm(norm: f64, scale: i64) -> f64 {
    const WITHOUT_OVERFLOW: i64 = 512;
    let (_, exponent) = libm::frexp(norm);
    let whole = scale.saturating_add(i64::from(exponent));
    if whole.abs() < WITHOUT_OVERFLOW {
        return libm::log(libm::scalbn(norm, scale as i32));
    }
    libm::log(libm::scalbn(norm, -exponent)) + whole as f64 * std::f64::consts::LN_2
}

struct Recorder<'g> {
    summaries: &'g Mutex<Vec<Summary>>,
    rows: &'g Rows<'g>,
    times: &'g [f64],
    /// Logarithm of the initial length of each trajectory's tangent vector.
    initial: &'g [f64],
    trajectories: Vec<usize>,
    exponents: Vec<&'g mut [f64]>,
    tangent: Vec<f64>,
}

impl Observer for Recorder<'_> {
    fn begin(&mut self, lane: usize, trajectory: usize) {
        self.trajectories[lane] = trajectory;
        self.exponents[lane] = self.rows.take(trajectory);
    }

    fn sample(&mut self, lane: usize, index: usize, tau: f64, step: &Step<'_>) {
        if index > 0 {
            let scale = step.tangent(0, tau, &mut self.tangent);
            let length = logarithm(euclidean_norm(&self.tangent), scale);
            let elapsed = self.times[index] - self.times[0];
            self.exponents[lane][index - 1] = (length - self.initial[self.trajectories[lane]]) / elapsed;
        }
    }

    fn end(&mut self, _lane: usize, trajectory: usize, summary: Summary) {
        self.summaries.lock().expect(POISONED)[trajectory] = summary;
    }
}
