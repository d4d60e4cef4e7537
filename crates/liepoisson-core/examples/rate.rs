//! How many units of trajectory time a second? `cargo run --release --example rate -- [options]`
//!
//! Options `method=taylor|mixed|runge-kutta|splitting|gauss tol=1e-13 order=0 step=0 trajectories=512 t_end=200 single`. Twisted
//! Kovalevskaya top with one tangent vector, one thread, every instruction set of this processor (or the one in
//! `LIEPOISSON_SIMD`). Order 0 stands for the one that the tolerance asks for, or for 4; step 0 for steps by the tolerance, or for
//! 0.65. Errors are medians and largest values over the trajectories at T = 20, against the Taylor method at 1e-15.

use liepoisson_core::analysis::{lyapunov, orbit};
use liepoisson_core::ensemble::{Control, Ensemble};
use liepoisson_core::error::Error;
use liepoisson_core::field::Top;
use liepoisson_core::lanes::Simd;
use liepoisson_core::method::{Gauss, Method, MixedTaylor, RungeKutta, Single, Splitting, Taylor};
use std::time::Instant;

struct Problem {
    top: Top,
    states: Vec<f64>,
    tangents: Vec<f64>,
    t_end: f64,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (mut name, mut tolerance, mut order, mut step) = ("taylor".to_owned(), 1e-13, 0, 0.0);
    let (mut trajectories, mut t_end, mut single) = (512, 200.0, false);
    for argument in std::env::args().skip(1) {
        match argument.split_once('=') {
            Some(("method", value)) => name = value.to_owned(),
            Some(("tol", value)) => tolerance = value.parse()?,
            Some(("order", value)) => order = value.parse()?,
            Some(("step", value)) => step = value.parse()?,
            Some(("trajectories", value)) => trajectories = value.parse()?,
            Some(("t_end", value)) => t_end = value.parse()?,
            None if argument == "single" => single = true,
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
    let taylor = || Taylor::new(tolerance, (order > 0).then_some(order), u64::MAX);
    let (step_or_usual, order_or_4) = (if step > 0.0 { step } else { 0.65 }, if order > 0 { order } else { 4 });
    match (name.as_str(), single) {
        ("taylor", false) => problem.report(taylor()?)?,
        ("mixed", false) => problem.report(MixedTaylor(taylor()?))?,
        ("runge-kutta", single) => {
            let adaptive = || RungeKutta::new(tolerance, u64::MAX);
            let method = if step > 0.0 { RungeKutta::fixed(step, u64::MAX) } else { adaptive() }?;
            if single { problem.report(Single::<RungeKutta>::new(method)?)? } else { problem.report(method)? }
        }
        ("splitting", single) => {
            let method = Splitting::new(order_or_4, step_or_usual, u64::MAX)?;
            if single { problem.report(Single(method))? } else { problem.report(method)? }
        }
        ("gauss", false) => problem.report(Gauss::new(order_or_4 / 2, step_or_usual, u64::MAX)?)?,
        _ => return Err(format!("no method {name} in this precision; see the first lines of this example").into()),
    }
    Ok(())
}

impl Problem {
    fn ensemble<'a, M: Method<Top>>(&'a self, method: M, times: &'a [f64]) -> Ensemble<'a, Top, M> {
        Ensemble { field: &self.top, method, states: &self.states, tangents: &self.tangents, n_tangents: 1, times }
    }

    fn report<M: Method<Top>>(&self, method: M) -> Result<(), Error> {
        self.errors(method)?;
        let forced = std::env::var_os("LIEPOISSON_SIMD").is_some();
        for simd in Simd::ALL.into_iter().filter(|simd| simd.is_available()) {
            if forced && simd != Simd::from_environment()? {
                continue;
            }
            let times = [0.0, self.t_end];
            let start = Instant::now();
            let control = Control::default();
            let found = lyapunov::finite_time_exponents(&self.ensemble(method, &times), 1, simd, &control, |_| ())?;
            let seconds = start.elapsed().as_secs_f64();
            let steps: u64 = found.summaries.iter().map(|summary| summary.n_steps).sum();
            let time = self.t_end * found.summaries.len() as f64;
            let mean = found.exponents.iter().sum::<f64>() / found.exponents.len() as f64;
            println!(
                "{:>7}: {:.3}e6 units/s, {:.2} steps per unit time, {:.1} ns per step, mean exponent {mean:.15}",
                simd.name(),
                time / seconds / 1e6,
                steps as f64 / time,
                seconds * 1e9 / steps as f64,
            );
        }
        Ok(())
    }

    fn errors<M: Method<Top>>(&self, method: M) -> Result<(), Error> {
        const TIMES: [f64; 2] = [0.0, 20.0];
        let (simd, control) = (Simd::widest(), Control::default());
        let run = orbit::orbits(&self.ensemble(method, &TIMES), 1, simd, &control, false, |_| ())?;
        let reference = Taylor::new(1e-15, None, u64::MAX)?;
        let exact = orbit::orbits(&self.ensemble(reference, &TIMES), 1, simd, &control, false, |_| ())?;
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
            print!("{name} error {:.1e} (largest {:.1e})  ", errors[errors.len() / 2], errors[errors.len() - 1]);
        }
        println!();
        Ok(())
    }
}
