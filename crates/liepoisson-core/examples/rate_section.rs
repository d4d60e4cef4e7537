//! Crossings per second of the Kovalevskaya top with the surface `alpha3 = 0`, on one thread, and what a step costs.
//!
//! `cargo run --release --example rate_section -- [trajectories] [crossings of each]`

use liepoisson_core::analysis::section::{Surface, sections};
use liepoisson_core::ensemble::{Control, Ensemble};
use liepoisson_core::field::{Functions, Top};
use liepoisson_core::lanes::Simd;
use liepoisson_core::method::Taylor;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1).map(|argument| argument.parse::<usize>());
    let trajectories = arguments.next().transpose()?.unwrap_or(256);
    let n_crossings = arguments.next().transpose()?.unwrap_or(1000);
    let top = Top::new([2.0, 2.0, 1.0], [-1.0, 0.0, 0.0], [0.0; 3], 0.0)?;
    // alpha of length one, beta = 0: the ordinary top
    let states: Vec<f64> = (0..trajectories)
        .flat_map(|k| {
            let (angle, height) = (k as f64, 0.9 * libm::sin(1.7 * k as f64));
            let radius = (1.0 - height * height).sqrt();
            let alpha = [radius * libm::cos(angle), radius * libm::sin(angle), height];
            let l = [0.4, 0.9, 1.3].map(|w| libm::sin(w * k as f64 + w));
            [l[0], l[1], l[2], alpha[0], alpha[1], alpha[2], 0.0, 0.0, 0.0]
        })
        .collect();
    let method = Taylor::new(f64::EPSILON, None, u64::MAX)?;
    let ensemble = Ensemble { field: &top, method, states: &states, tangents: &[], n_tangents: 0, times: &[0.0, 1e7] };
    let function = Functions::new(9, vec![], vec![5])?;
    let surface =
        Surface { function, kept: None, guard: None, direction: 0, n_crossings: Some(n_crossings), sides: vec![] };
    let start = Instant::now();
    let found = sections(&ensemble, &surface, 1, Simd::from_environment()?, &Control::default(), |_| ())?;
    let elapsed = start.elapsed().as_secs_f64();
    let crossings = found.crossings.times.len() as f64;
    let steps: u64 = found.summaries.iter().map(|summary| summary.n_steps).sum();
    println!("{:.0} crossings/s, {:.0} ns per step", crossings / elapsed, 1e9 * elapsed / steps as f64);
    Ok(())
}
