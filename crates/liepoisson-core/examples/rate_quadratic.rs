//! How near does a field given at run time come to a kernel written for it? `cargo run --release --example rate_quadratic`
//!
//! One tangent vector, one thread, every instruction set of this processor (or the one in `LIEPOISSON_SIMD`). The twisted
//! Kovalevskaya top as `Top` and as `Quadratic`, interleaved, the best of many short runs of each, because other work on
//! the machine changes the clock and the caches within seconds; then larger fields, with the rate of the multiply-adds of
//! the distinct products (two operations each) beside the time of a step.

use liepoisson_core::analysis::lyapunov;
use liepoisson_core::ensemble::{Control, Ensemble};
use liepoisson_core::field::{Instantiate, Quadratic, Top};
use liepoisson_core::lanes::Simd;
use liepoisson_core::method::Taylor;
use std::collections::BTreeSet;
use std::time::Instant;

/// A sequence without a pattern, in [-1, 1).
fn spread(k: usize) -> f64 {
    let x = (k as f64 + 1.0) * 0.618_033_988_749_894_9;
    2.0 * ((x + 37.0 * x * (k % 101) as f64) % 1.0) - 1.0
}

/// Trajectories, their states and tangent vectors, and how long they run.
struct Starts {
    states: Vec<f64>,
    tangents: Vec<f64>,
    t_end: f64,
}

impl Starts {
    fn new(n: usize, trajectories: usize, size: f64, t_end: f64) -> Starts {
        let states = (0..n * trajectories).map(|k| size * spread(k)).collect();
        Starts { states, tangents: (0..n * trajectories).map(|k| spread(3 * k + 1)).collect(), t_end }
    }

    /// Nanoseconds for a step of one trajectory.
    fn time<F: Instantiate>(&self, field: &F, method: Taylor, simd: Simd) -> f64 {
        let times = [0.0, self.t_end];
        let (states, tangents) = (&self.states, &self.tangents);
        let ensemble = Ensemble { field, method, states, tangents, n_tangents: 1, times: &times };
        let start = Instant::now();
        let found = lyapunov::finite_time_exponents(&ensemble, 1, simd, &Control::default(), |_| ())
            .expect("the ensemble is sound");
        let steps: u64 = found.summaries.iter().map(|summary| summary.n_steps).sum();
        start.elapsed().as_secs_f64() * 1e9 / steps as f64
    }
}

type Entries = Vec<(usize, usize, usize, f64)>;

/// The equations of the twisted top, entry by entry.
fn quadratic_top(inertia: [f64; 3], a: [f64; 3], epsilon: f64) -> Quadratic {
    let (mut linear, mut quadratic) = (Vec::new(), Vec::new());
    for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
        for vector in [0, 3, 6] {
            quadratic.push((vector + i, vector + j, k, 1.0 / inertia[k]));
            quadratic.push((vector + i, vector + k, j, -1.0 / inertia[j]));
        }
        for (to, from, factor) in [(0, 3, 1.0), (3, 6, epsilon)] {
            linear.push((to + i, from + j, factor * a[k]));
            linear.push((to + i, from + k, -factor * a[j]));
        }
    }
    Quadratic::new(9, &[], &linear, &quadratic).expect("the entries are sound")
}

/// Manakov's top on so(n): `M' = [M, Omega]`, `Omega_ij = M_ij / (J_i + J_j)`, `J_i = i`; components `M_ij`, `i < j`.
fn manakov(n: usize) -> (usize, Entries) {
    let pairs: Vec<(usize, usize)> = (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j))).collect();
    let position = |i: usize, j: usize| {
        let at = pairs.iter().position(|&pair| pair == (i.min(j), i.max(j))).expect("every pair is there");
        (at, if i < j { 1.0 } else { -1.0 })
    };
    let mut entries = Vec::new();
    for (component, &(i, j)) in pairs.iter().enumerate() {
        for k in (0..n).filter(|&k| k != i && k != j) {
            let ((first, s), (second, t)) = (position(i, k), position(k, j));
            // M_ik Omega_kj - Omega_ik M_kj
            let factor = 1.0 / (k + j + 2) as f64 - 1.0 / (i + k + 2) as f64;
            entries.push((component, first, second, s * t * factor));
        }
    }
    (pairs.len(), entries)
}

/// Every product of two components, in `targets` equations each.
fn dense(n: usize, targets: usize) -> (usize, Entries) {
    let pairs = (0..n).flat_map(|j| (j..n).map(move |k| (j, k)));
    let entry = |(m, (j, k)): (usize, (usize, usize))| {
        (0..targets).map(move |t| ((7 * m + 5 * t * n / targets + j) % n, j, k, spread(m + t) / n as f64))
    };
    (n, pairs.enumerate().flat_map(entry).collect())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let forced = std::env::var_os("LIEPOISSON_SIMD").map(|_| Simd::from_environment()).transpose()?;
    let top = Top::new([2.0, 2.0, 1.0], [-1.0, 0.0, 0.0], [0.0; 3], 1.0)?;
    let derived = quadratic_top([2.0, 2.0, 1.0], [-1.0, 0.0, 0.0], 1.0);
    for simd in Simd::ALL.into_iter().filter(|&simd| simd.is_available() && forced.is_none_or(|forced| simd == forced))
    {
        for tolerance in [1e-13, 1e-8] {
            let method = Taylor::new(tolerance, None, u64::MAX)?;
            let starts = Starts::new(9, 512, 1.0, 1.0);
            let (mut by_hand, mut at_run_time) = (f64::MAX, f64::MAX);
            for _ in 0..150 {
                by_hand = by_hand.min(starts.time(&top, method, simd));
                at_run_time = at_run_time.min(starts.time(&derived, method, simd));
            }
            println!(
                "{:>6} {tolerance:e} twisted top: by hand {by_hand:.0} ns per step, at run time {at_run_time:.0}, rate {:.2}",
                simd.name(),
                by_hand / at_run_time
            );
        }
        let systems = [
            ("Manakov so(4)", manakov(4)),
            ("Manakov so(7)", manakov(7)),
            ("dense", dense(24, 24)),
            ("dense, two targets", dense(120, 2)),
        ];
        for (name, (n, entries)) in systems {
            let products = entries.iter().map(|&(_, j, k, _)| (j.min(k), j.max(k))).collect::<BTreeSet<_>>().len();
            let start = Instant::now();
            let field = Quadratic::new(n, &[], &[], &entries)?;
            let made = start.elapsed().as_secs_f64() * 1e3;
            let method = Taylor::new(1e-13, None, u64::MAX)?;
            let starts = Starts::new(n, if n < 50 { 128 } else { 8 }, 0.5, if n < 50 { 1.0 } else { 0.2 });
            let best = (0..30).map(|_| starts.time(&field, method, simd)).fold(f64::MAX, f64::min);
            let operations = (2 * 3 * products * method.order() * (method.order() + 1) / 2) as f64;
            println!(
                "{:>6} {:e} {name}: {n} components, {products} products, made in {made:.1} ms, {best:.0} ns per step, {:.1} GFLOP/s",
                simd.name(),
                1e-13,
                operations / best
            );
        }
    }
    Ok(())
}
