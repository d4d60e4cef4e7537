//! How quick is one trajectory? `cargo run --release --example rate_single -- [tolerance] [order] [t_end]`
//!
//! Twisted Kovalevskaya top without tangent vectors: the kernel across components against the kernel for many with one
//! lane in use. Order 0 stands for the one that the tolerance asks for.

use liepoisson_core::analysis::orbit::orbits;
use liepoisson_core::ensemble::{Control, Ensemble};
use liepoisson_core::error::Error;
use liepoisson_core::field::Top;
use liepoisson_core::lanes::Simd;
use liepoisson_core::method::{AcrossComponents, Method, Taylor};
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let tolerance = arguments.next().map_or(Ok(1e-15), |s| s.parse())?;
    let order = arguments.next().map(|s| s.parse()).transpose()?.filter(|&order: &usize| order > 0);
    let t_end: f64 = arguments.next().map_or(Ok(100_000.0), |s| s.parse())?;
    let method = Taylor::new(tolerance, order, u64::MAX)?;
    let simd = Simd::from_environment()?;
    time("components", AcrossComponents(method), simd, t_end)?;
    time("lanes", method, simd, t_end)?;
    Ok(())
}

fn time<M: Method<Top>>(name: &str, method: M, simd: Simd, t_end: f64) -> Result<(), Error> {
    let top = Top::new([2.0, 2.0, 1.0], [-1.0, 0.0, 0.0], [0.0; 3], 1.0)?;
    let states = [0.48, 0.64, 0.6, 0.6, 0.0, 0.8, 0.0, 0.28, 0.96];
    let times = [0.0, t_end];
    let ensemble = Ensemble { field: &top, method, states: &states, tangents: &[], n_tangents: 0, times: &times };
    let start = Instant::now();
    let run = orbits(&ensemble, 1, simd, &Control::default(), false, |_| ())?;
    let seconds = start.elapsed().as_secs_f64();
    let n_steps = run.summaries[0].n_steps as f64;
    println!(
        "{name:>10} ({}): {:.0} ns per step, {:.2} steps and {:.3} us per unit time",
        simd.name(),
        seconds * 1e9 / n_steps,
        n_steps / t_end,
        seconds * 1e6 / t_end
    );
    Ok(())
}
