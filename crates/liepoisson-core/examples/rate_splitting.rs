//! How fast, and how far off? `cargo run --release --example rate_splitting -- [order] [step] [f64|f32] [trajectories] [t_end]`
//!
//! Twisted Kovalevskaya top with one tangent vector, one thread, every instruction set of this processor (or the one in
//! `LIEPOISSON_SIMD`): units of trajectory time a second, and the median errors of state and tangent vector at T = 20,
//! relative to the size of each, against the Taylor method at 1e-15.

use liepoisson_core::analysis::{lyapunov, orbit};
use liepoisson_core::ensemble::{Control, Ensemble};
use liepoisson_core::field::Top;
use liepoisson_core::lanes::Simd;
use liepoisson_core::method::{Method, Single, Splitting, Taylor};
use std::time::Instant;

/// Time at which the errors are measured.
const T_COMPARE: f64 = 20.0;

struct Starts {
    top: Top,
    states: Vec<f64>,
    tangents: Vec<f64>,
}

impl Starts {
    /// A fixed spread of starts: each vector on the unit sphere, by golden angles.
    fn new(trajectories: usize) -> Result<Starts, Box<dyn std::error::Error>> {
        let vector = |k: usize| {
            let (z, phase) = (1.0 - 2.0 * ((k as f64 * 0.618_033_988_75) % 1.0), k as f64 * 2.399_963_229_7);
            let radius = (1.0 - z * z).sqrt();
            [radius * phase.cos(), radius * phase.sin(), z]
        };
        Ok(Starts {
            top: Top::new([2.0, 2.0, 1.0], [-1.0, 0.0, 0.0], [0.0; 3], 1.0)?,
            states: (0..3 * trajectories).flat_map(|k| vector(7 * k + 3)).collect(),
            tangents: (0..3 * trajectories).flat_map(|k| vector(5 * k + 1)).collect(),
        })
    }

    fn ensemble<'a, M: Method<Top>>(&'a self, method: M, times: &'a [f64]) -> Ensemble<'a, Top, M> {
        Ensemble { field: &self.top, method, states: &self.states, tangents: &self.tangents, n_tangents: 1, times }
    }

    /// States and tangent vectors at the time of comparison.
    fn ends<M: Method<Top>>(&self, method: M) -> Result<[Vec<f64>; 2], Box<dyn std::error::Error>> {
        let times = [0.0, T_COMPARE];
        let ensemble = self.ensemble(method, &times);
        let orbits = orbit::orbits(&ensemble, 1, Simd::widest(), &Control::default(), false, |_| ())?;
        let last = |values: &[f64]| values.chunks_exact(18).flat_map(|rows| rows[9..].to_vec()).collect();
        Ok([last(&orbits.states), last(&orbits.tangents)])
    }

    fn report<M: Method<Top>>(&self, method: M, t_end: f64) -> Result<(), Box<dyn std::error::Error>> {
        let (exact, got) = (self.ends(Taylor::new(1e-15, None, u64::MAX)?)?, self.ends(method)?);
        println!(
            "median relative error at T = {T_COMPARE}: state {:.2e}, tangent vector {:.2e}",
            median_error(&exact[0], &got[0]),
            median_error(&exact[1], &got[1])
        );
        let forced = std::env::var_os("LIEPOISSON_SIMD").is_some();
        for simd in Simd::ALL.into_iter().filter(|simd| simd.is_available()) {
            if forced && simd != Simd::from_environment()? {
                continue;
            }
            let times = [0.0, t_end];
            let start = Instant::now();
            let found =
                lyapunov::finite_time_exponents(&self.ensemble(method, &times), 1, simd, &Control::default(), |_| ())?;
            let seconds = start.elapsed().as_secs_f64();
            let steps: u64 = found.summaries.iter().map(|summary| summary.n_steps).sum();
            println!(
                "{:>7}: {:.3}e6 units/s, {:.1} ns per step, mean exponent {:.15}",
                simd.name(),
                found.summaries.len() as f64 * t_end / seconds / 1e6,
                seconds * 1e9 / steps as f64,
                found.exponents.iter().sum::<f64>() / found.exponents.len() as f64,
            );
        }
        Ok(())
    }
}

/// Median over the trajectories of the largest error of a component, divided by the largest component.
fn median_error(exact: &[f64], got: &[f64]) -> f64 {
    let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, |a: f64, b| a.max(b.abs()));
    let mut errors: Vec<f64> = exact
        .chunks_exact(9)
        .zip(got.chunks_exact(9))
        .map(|(x, y)| largest(&mut x.iter().zip(y).map(|(a, b)| a - b)) / largest(&mut x.iter().copied()))
        .collect();
    errors.sort_by(f64::total_cmp);
    errors[errors.len() / 2]
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let order: usize = arguments.next().map_or(Ok(4), |s| s.parse())?;
    let step: f64 = arguments.next().map_or(Ok(0.65), |s| s.parse())?;
    let single = arguments.next().is_some_and(|s| s == "f32");
    let trajectories: usize = arguments.next().map_or(Ok(512), |s| s.parse())?;
    let t_end: f64 = arguments.next().map_or(Ok(2_000.0), |s| s.parse())?;
    let (starts, method) = (Starts::new(trajectories)?, Splitting::new(order, step, u64::MAX)?);
    if single { starts.report(Single(method), t_end) } else { starts.report(method, t_end) }
}
