//! How many units of trajectory time a second? `cargo run --release --example rate -- [tolerance] [order] [members] [t_end]`
//!
//! Twisted Kovalevskaya top with one tangent vector, one thread, every instruction set of this processor (or the one in
//! `LIEPOISSON_SIMD`). Order 0 stands for the one that the tolerance asks for.

use liepoisson_core::analysis::lyapunov;
use liepoisson_core::ensemble::{Control, Ensemble};
use liepoisson_core::field::Top;
use liepoisson_core::lanes::Simd;
use liepoisson_core::method::Taylor;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let tolerance = arguments.next().map_or(Ok(1e-13), |s| s.parse())?;
    let order = arguments.next().map(|s| s.parse()).transpose()?.filter(|&order: &usize| order > 0);
    let members: usize = arguments.next().map_or(Ok(512), |s| s.parse())?;
    let t_end: f64 = arguments.next().map_or(Ok(200.0), |s| s.parse())?;

    let top = Top::new([2.0, 2.0, 1.0], [-1.0, 0.0, 0.0], [0.0; 3], 1.0)?;
    // A fixed spread of starts: each vector on the unit sphere, by golden angles.
    let vector = |k: usize| {
        let (z, phase) = (1.0 - 2.0 * ((k as f64 * 0.618_033_988_75) % 1.0), k as f64 * 2.399_963_229_7);
        let radius = (1.0 - z * z).sqrt();
        [radius * phase.cos(), radius * phase.sin(), z]
    };
    let states: Vec<f64> = (0..3 * members).flat_map(|k| vector(7 * k + 3)).collect();
    let tangents: Vec<f64> = (0..3 * members).flat_map(|k| vector(5 * k + 1)).collect();
    let method = Taylor::new(tolerance, order, u64::MAX)?;
    let ensemble =
        Ensemble { field: &top, method, states: &states, tangents: &tangents, n_tangents: 1, times: &[0.0, t_end] };
    let forced = std::env::var_os("LIEPOISSON_SIMD").is_some();
    for simd in Simd::ALL.into_iter().filter(|simd| simd.is_available()) {
        if forced && simd != Simd::from_environment()? {
            continue;
        }
        let start = Instant::now();
        let growth = lyapunov::growth(&ensemble, 1, simd, &Control::default(), |_| ())?;
        let seconds = start.elapsed().as_secs_f64();
        let steps: u64 = growth.summaries.iter().map(|summary| summary.n_steps).sum();
        let mean = growth.exponents.iter().sum::<f64>() / members as f64;
        println!(
            "{:>7}: order {}, {:.2} steps per unit time, {:.3}e6 units/s, {:.0} ns per step, mean exponent {mean:.15}",
            simd.name(),
            method.order(),
            steps as f64 / (members as f64 * t_end),
            members as f64 * t_end / seconds / 1e6,
            seconds * 1e9 / steps as f64,
        );
    }
    Ok(())
}
