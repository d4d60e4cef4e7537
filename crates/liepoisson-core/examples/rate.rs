//! How many units of trajectory time a second? `cargo run --release --example rate -- [options]`
//!
//! Options `tol=1e-13 order=0 trajectories=512 t_end=200 mixed`. Twisted Kovalevskaya top with one tangent vector, one thread,
//! every instruction set of this processor (or the one in `LIEPOISSON_SIMD`). Order 0 stands for the one that the
//! tolerance asks for. Errors are medians and largest values over the trajectories at T = 20, against tolerance 1e-15.

use liepoisson_core::analysis::{lyapunov, orbit};
use liepoisson_core::ensemble::{Control, Ensemble};
use liepoisson_core::error::Error;
use liepoisson_core::field::Top;
use liepoisson_core::lanes::Simd;
use liepoisson_core::method::{Method, MixedTaylor, Taylor};
use std::time::Instant;

struct Problem {
    top: Top,
    states: Vec<f64>,
    tangents: Vec<f64>,
    t_end: f64,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (mut tolerance, mut order, mut trajectories, mut t_end, mut mixed) = (1e-13, 0, 512, 200.0, false);
    for argument in std::env::args().skip(1) {
        match argument.split_once('=') {
            Some(("tol", value)) => tolerance = value.parse()?,
            Some(("order", value)) => order = value.parse()?,
            Some(("trajectories", value)) => trajectories = value.parse()?,
            Some(("t_end", value)) => t_end = value.parse()?,
            None if argument == "mixed" => mixed = true,
            _ => return Err(format!("unknown option {argument}; see the first lines of this example").into()),
        }
    }
    // A fixed spread of starts: each vector on the unit sphere, by golden angles.
    let vector = |k: usize| {
        let (z, phase) = (1.0 - 2.0 * ((k as f64 * 0.618_033_988_75) % 1.0), k as f64 * 2.399_963_229_7);
        let radius = (1.0 - z * z).sqrt();
        [radius * phase.cos(), radius * phase.sin(), z]
    };
    let problem = Problem {
        top: Top::new([2.0, 2.0, 1.0], [-1.0, 0.0, 0.0], [0.0; 3], 1.0)?,
        states: (0..3 * trajectories).flat_map(|k| vector(7 * k + 3)).collect(),
        tangents: (0..3 * trajectories).flat_map(|k| vector(5 * k + 1)).collect(),
        t_end,
    };
    let method = Taylor::new(tolerance, (order > 0).then_some(order), u64::MAX)?;
    println!("order {}, tolerance {tolerance:e}{}", method.order(), if mixed { ", mixed precision" } else { "" });
    let forced = std::env::var_os("LIEPOISSON_SIMD").is_some();
    for simd in Simd::ALL.into_iter().filter(|simd| simd.is_available()) {
        if !forced || simd == Simd::from_environment()? {
            if mixed { report(&problem, MixedTaylor(method), simd)? } else { report(&problem, method, simd)? }
        }
    }
    Ok(())
}

fn report<M: Method<Top>>(problem: &Problem, method: M, simd: Simd) -> Result<(), Error> {
    let Problem { top, states, tangents, t_end } = problem;
    let times = [0.0, *t_end];
    let ensemble = Ensemble { field: top, method, states, tangents, n_tangents: 1, times: &times };
    let start = Instant::now();
    let found = lyapunov::finite_time_exponents(&ensemble, 1, simd, &Control::default(), |_| ())?;
    let seconds = start.elapsed().as_secs_f64();
    let steps: u64 = found.summaries.iter().map(|summary| summary.n_steps).sum();
    let time = t_end * found.summaries.len() as f64;
    let mean = found.exponents.iter().sum::<f64>() / found.exponents.len() as f64;
    println!(
        "{:>7}: {:.3}e6 units/s, {:.2} steps per unit time, {:.0} ns per step, mean exponent {mean:.15}",
        simd.name(),
        time / seconds / 1e6,
        steps as f64 / time,
        seconds * 1e9 / steps as f64,
    );
    errors(problem, method, simd)
}

fn errors<M: Method<Top>>(problem: &Problem, method: M, simd: Simd) -> Result<(), Error> {
    const TIMES: [f64; 2] = [0.0, 20.0];
    let Problem { top, states, tangents, .. } = problem;
    let ensemble = Ensemble { field: top, method, states, tangents, n_tangents: 1, times: &TIMES };
    let run = orbit::orbits(&ensemble, 1, simd, &Control::default(), false, |_| ())?;
    let reference = Ensemble {
        field: top,
        method: Taylor::new(1e-15, None, u64::MAX)?,
        states,
        tangents,
        n_tangents: 1,
        times: &TIMES,
    };
    let exact = orbit::orbits(&reference, 1, simd, &Control::default(), false, |_| ())?;
    let norm = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let relative = |values: &[f64], exact: &[f64]| -> Vec<f64> {
        let pairs = values.chunks(18).zip(exact.chunks(18));
        pairs
            .map(|(u, v)| norm(&u[9..].iter().zip(&v[9..]).map(|(a, b)| a - b).collect::<Vec<_>>()) / norm(&v[9..]))
            .collect()
    };
    let exponents: Vec<f64> = run
        .tangents
        .chunks(18)
        .zip(exact.tangents.chunks(18))
        .map(|(u, v)| (norm(&u[9..]) / norm(&v[9..])).ln().abs() / TIMES[1])
        .collect();
    let quantities = [relative(&run.states, &exact.states), relative(&run.tangents, &exact.tangents), exponents];
    for (name, mut errors) in ["state", "tangent", "exponent"].into_iter().zip(quantities) {
        errors.sort_by(f64::total_cmp);
        print!("         {name} error {:.1e} (largest {:.1e})", errors[errors.len() / 2], errors[errors.len() - 1]);
    }
    println!();
    Ok(())
}
