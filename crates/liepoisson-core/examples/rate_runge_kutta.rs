//! How many units of trajectory time a second, and how accurate?
//! `cargo run --release --example rate_runge_kutta -- [adaptive|fixed] [tolerance or step] [double|single] [t_end]`
//!
//! 512 trajectories of the twisted Kovalevskaya top with one tangent vector, one thread, every instruction set of this
//! processor (or the one in `LIEPOISSON_SIMD`). Errors are medians of the relative errors at time 20, against the Taylor
//! method at 1e-15; evaluations of the field are counted in a run of 64 of them to the same time.

use liepoisson_core::analysis::{lyapunov, orbit};
use liepoisson_core::ensemble::{Control, Ensemble};
use liepoisson_core::field::{Field, SinglePrecision, Space, Top};
use liepoisson_core::lanes::{Lane, Simd};
use liepoisson_core::method::{Method, RungeKutta, Single, Taylor};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

const TRAJECTORIES: usize = 512;
const T_ERROR: f64 = 20.0;

/// A top that counts how often its rates are asked for.
struct Counted {
    top: Top,
    count: AtomicU64,
}

impl Space for Counted {
    fn n_components(&self) -> usize {
        self.top.n_components()
    }
}

impl SinglePrecision for Counted {}

impl Field for Counted {
    fn group(&self) -> usize {
        self.top.group()
    }
    #[inline(always)]
    fn derive_work<V: Lane>(&self, rows: &mut [V], n_tangents: usize, k: usize) {
        self.top.derive_work(rows, n_tangents, k);
    }
    #[inline(always)]
    fn extend<V: Lane>(&self, rows: &mut [V], n_tangents: usize, k: usize) {
        self.top.extend(rows, n_tangents, k);
    }
    #[inline(always)]
    fn rates<V: Lane>(&self, x: &[V], n_tangents: usize, work: &mut [V], rates: &mut [V]) {
        self.count.fetch_add(V::WIDTH as u64, Ordering::Relaxed);
        self.top.rates(x, n_tangents, work, rates);
    }
}

struct Starts {
    states: Vec<f64>,
    tangents: Vec<f64>,
}

impl Starts {
    /// Each vector on the unit sphere, by golden angles.
    fn new() -> Starts {
        let vector = |k: usize| {
            let (z, phase) = (1.0 - 2.0 * ((k as f64 * 0.618_033_988_75) % 1.0), k as f64 * 2.399_963_229_7);
            let radius = (1.0 - z * z).sqrt();
            [radius * phase.cos(), radius * phase.sin(), z]
        };
        Starts {
            states: (0..3 * TRAJECTORIES).flat_map(|k| vector(7 * k + 3)).collect(),
            tangents: (0..3 * TRAJECTORIES).flat_map(|k| vector(5 * k + 1)).collect(),
        }
    }

    fn ensemble<'a, F, M>(
        &'a self,
        trajectories: usize,
        field: &'a F,
        method: M,
        times: &'a [f64],
    ) -> Ensemble<'a, F, M> {
        let (states, tangents) = (&self.states[..9 * trajectories], &self.tangents[..9 * trajectories]);
        Ensemble { field, method, states, tangents, n_tangents: 1, times }
    }
}

fn measure<M>(method: M, t_end: f64) -> Result<(), Box<dyn std::error::Error>>
where
    M: Method<Top> + Method<Counted>,
{
    let top = Top::new([2.0, 2.0, 1.0], [-1.0, 0.0, 0.0], [0.0; 3], 1.0)?;
    let (starts, times) = (Starts::new(), [0.0, T_ERROR]);
    let control = Control::default();
    let reference = Taylor::new(1e-15, None, u64::MAX)?;
    let exact = orbit::orbits(
        &starts.ensemble(TRAJECTORIES, &top, reference, &times),
        1,
        Simd::widest(),
        &control,
        false,
        |_| (),
    )?;
    let ours = orbit::orbits(
        &starts.ensemble(TRAJECTORIES, &top, method, &times),
        1,
        Simd::widest(),
        &control,
        false,
        |_| (),
    )?;
    let (state, tangent) = (median(&ours.states, &exact.states), median(&ours.tangents, &exact.tangents));

    let counted = Counted { top, count: AtomicU64::new(0) };
    orbit::orbits(&starts.ensemble(64, &counted, method, &times), 1, Simd::Scalar, &control, false, |_| ())?;
    let evaluations = counted.count.load(Ordering::Relaxed) as f64 / (64.0 * T_ERROR);
    println!(
        "error of the state {state:.1e}, of the tangent {tangent:.1e}; {evaluations:.1} evaluations per unit time"
    );

    let forced = std::env::var_os("LIEPOISSON_SIMD").is_some();
    for simd in Simd::ALL.into_iter().filter(|simd| simd.is_available()) {
        if forced && simd != Simd::from_environment()? {
            continue;
        }
        let times = [0.0, t_end];
        let ensemble = starts.ensemble(TRAJECTORIES, &top, method, &times);
        let start = Instant::now();
        let found = lyapunov::finite_time_exponents(&ensemble, 1, simd, &control, |_| ())?;
        let seconds = start.elapsed().as_secs_f64();
        let steps: u64 = found.summaries.iter().map(|summary| summary.n_steps).sum();
        println!(
            "{:>7}: {:.3} steps per unit time, {:.3}e6 units/s, {:.0} ns per step",
            simd.name(),
            steps as f64 / (TRAJECTORIES as f64 * t_end),
            TRAJECTORIES as f64 * t_end / seconds / 1e6,
            seconds * 1e9 / steps as f64,
        );
    }
    Ok(())
}

/// Median over trajectories of the largest difference at the last time, over the largest component.
fn median(ours: &[f64], exact: &[f64]) -> f64 {
    let error = |(a, b): (&[f64], &[f64])| {
        let difference = (9..18).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max);
        difference / b[9..].iter().fold(0.0_f64, |size, x| size.max(x.abs()))
    };
    let mut errors: Vec<f64> = ours.chunks(18).zip(exact.chunks(18)).map(error).collect();
    errors.sort_by(f64::total_cmp);
    errors[errors.len() / 2]
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let word = |i: usize, default: &'static str| arguments.get(i).map_or(default, String::as_str);
    let number: f64 = word(1, "1e-8").parse()?;
    let method = match word(0, "adaptive") {
        "adaptive" => RungeKutta::new(number, u64::MAX)?,
        "fixed" => RungeKutta::fixed(number, u64::MAX)?,
        other => return Err(format!("wanted adaptive or fixed; got {other:?}").into()),
    };
    let t_end = word(3, "1000").parse()?;
    match word(2, "double") {
        "double" => measure(method, t_end),
        "single" => measure(Single::<RungeKutta>::new(method)?, t_end),
        other => Err(format!("wanted double or single; got {other:?}").into()),
    }
}
