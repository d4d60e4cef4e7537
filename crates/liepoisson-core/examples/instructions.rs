//! A fixed piece of work for each hot kernel, to count its instructions: `instructions KERNEL T_END`, or `instructions list`.
//!
//! Prints the steps that all trajectories took. `benchmarks/instructions.py` runs it under a counting emulator.

use liepoisson_core::analysis::orbit::orbits;
use liepoisson_core::analysis::section::{Surface, sections};
use liepoisson_core::ensemble::{Control, Ensemble};
use liepoisson_core::error::Error;
use liepoisson_core::field::{Functions, Instruction, Quadratic, Space, Tape, Top, Tops};
use liepoisson_core::lanes::Simd;
use liepoisson_core::method::{
    AcrossComponents, Gauss, LagrangeMap, Method, MixedTaylor, RungeKutta, Single, Splitting, Taylor,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let kernels = kernels()?;
    let [name, t_end] = arguments.as_slice() else {
        println!("{}", kernels.map(|(name, _)| name).join("\n"));
        return Ok(());
    };
    let (_, steps) = kernels.into_iter().find(|(known, _)| known == name).ok_or(format!("no kernel {name}"))?;
    println!("{}", steps(t_end.parse()?)?);
    Ok(())
}

/// The steps that all trajectories take up to a time.
type Steps = Box<dyn Fn(f64) -> Result<u64, Error>>;

fn kernels() -> Result<[(&'static str, Steps); 18], Box<dyn std::error::Error>> {
    let kovalevskaya = Top::new([2.0, 2.0, 1.0], [-1.0, 0.0, 0.0], [0.0; 3], 1.0)?;
    let general = Top::new([1.7, 1.1, 0.6], [0.4, -0.3, 0.9], [0.2, 0.5, -0.1], 1.0)?;
    let lagrange = Top::new([2.0, 2.0, 1.0], [0.0, 0.0, 1.0], [0.0; 3], 1.0)?;
    let (series, max) = (Taylor::new(1e-13, None, u64::MAX)?, u64::MAX);
    let tops = Tops::new((0..64).map(|_| kovalevskaya).collect())?;
    let same_tops = tops.clone();
    Ok([
        ("taylor", Box::new(move |t_end| run(&kovalevskaya, series, 1, 64, t_end))),
        ("taylor-state", Box::new(move |t_end| run(&kovalevskaya, series, 0, 64, t_end))),
        ("taylor-mixed", Box::new(move |t_end| run(&kovalevskaya, MixedTaylor(series), 1, 64, t_end))),
        ("taylor-tops", Box::new(move |t_end| run(&tops, series, 1, 64, t_end))),
        ("taylor-mixed-tops", Box::new(move |t_end| run(&same_tops, MixedTaylor(series), 1, 64, t_end))),
        ("taylor-grid", Box::new(move |t_end| run_at(&kovalevskaya, series, 0, 64, &grid(t_end)))),
        ("taylor-section", Box::new(move |t_end| section(&kovalevskaya, series, 64, t_end))),
        ("taylor-components", Box::new(move |t_end| run(&kovalevskaya, AcrossComponents(series), 0, 1, 16.0 * t_end))),
        ("taylor-quadratic", Box::new(move |t_end| run(&kovalevskaya_as_quadratic()?, series, 1, 64, t_end))),
        ("taylor-tape", Box::new(move |t_end| run(&pendulum()?, series, 1, 64, t_end))),
        ("taylor-barriers", Box::new(move |t_end| run(&oscillator_at_a_steep_barrier()?, series, 1, 64, t_end))),
        ("runge-kutta", Box::new(move |t_end| run(&kovalevskaya, RungeKutta::fixed(0.25, max)?, 1, 64, t_end))),
        ("runge-kutta-adaptive", Box::new(move |t_end| run(&kovalevskaya, RungeKutta::new(1e-8, max)?, 1, 64, t_end))),
        ("splitting-4", Box::new(move |t_end| run(&kovalevskaya, Splitting::new(4, 0.25, max)?, 1, 64, t_end))),
        (
            "splitting-4-single",
            Box::new(move |t_end| run(&kovalevskaya, Single(Splitting::new(4, 0.25, max)?), 1, 64, t_end)),
        ),
        ("splitting-6-general", Box::new(move |t_end| run(&general, Splitting::new(6, 0.25, max)?, 1, 64, t_end))),
        ("gauss-4", Box::new(move |t_end| run(&kovalevskaya, Gauss::new(2, 0.125, max)?, 1, 64, t_end))),
        ("lagrange-map", Box::new(move |t_end| run(&lagrange, LagrangeMap::new(0.25, max)?, 1, 64, t_end))),
    ])
}

fn run<F: Space, M: Method<F>>(
    field: &F,
    method: M,
    n_tangents: usize,
    trajectories: usize,
    t_end: f64,
) -> Result<u64, Error> {
    run_at(field, method, n_tangents, trajectories, &[0.0, t_end])
}

/// Any fixed number of modest size.
fn number(k: usize) -> f64 {
    0.7 * (1.0 - 2.0 * ((k as f64 * 0.618_033_988_75) % 1.0))
}

/// Some twenty times to a step.
fn grid(t_end: f64) -> Vec<f64> {
    (0..=(64.0 * t_end) as usize).map(|k| k as f64 / 64.0).collect()
}

/// Crossings of `l3 = 0`.
fn section(field: &Top, method: Taylor, trajectories: usize, t_end: f64) -> Result<u64, Error> {
    let (function, kept) = Functions::new(9, vec![], vec![2])?.split_first();
    let surface = Surface { function, kept, guard: None, direction: 0, n_crossings: None, sides: vec![] };
    let states: Vec<f64> = (0..9 * trajectories).map(number).collect();
    let ensemble = Ensemble { field, method, states: &states, tangents: &[], n_tangents: 0, times: &[0.0, t_end] };
    let found = sections(&ensemble, &surface, 1, Simd::from_environment()?, &Control::default(), |_| ())?;
    Ok(found.summaries.iter().map(|summary| summary.n_steps).sum())
}

fn run_at<F: Space, M: Method<F>>(
    field: &F,
    method: M,
    n_tangents: usize,
    trajectories: usize,
    times: &[f64],
) -> Result<u64, Error> {
    let n = field.n_components();
    let states: Vec<f64> = (0..n * trajectories).map(number).collect();
    let tangents: Vec<f64> = (1..=n * trajectories * n_tangents).map(number).collect();
    let ensemble = Ensemble { field, method, states: &states, tangents: &tangents, n_tangents, times };
    let run = orbits(&ensemble, 1, Simd::from_environment()?, &Control::default(), false, |_| ())?;
    Ok(run.summaries.iter().map(|summary| summary.n_steps).sum())
}

/// The twisted Kovalevskaya top as a sparse tensor.
fn kovalevskaya_as_quadratic() -> Result<Quadratic, Error> {
    let inverse = [0.5, 0.5, 1.0];
    let cyclic = [(0, 1, 2), (1, 2, 0), (2, 0, 1)];
    let mut products = vec![(0, 1, 2, inverse[2] - inverse[1]), (1, 0, 2, inverse[0] - inverse[2])];
    for vector in [3, 6] {
        for (i, j, k) in cyclic {
            products.push((vector + i, k, vector + j, inverse[k]));
            products.push((vector + i, j, vector + k, -inverse[j]));
        }
    }
    // alpha x a and eps beta x a for a = (-1, 0, 0)
    let linear = [(1, 5, -1.0), (2, 4, 1.0), (4, 8, -1.0), (5, 7, 1.0)];
    Quadratic::new(9, &[], &linear, &products)
}

/// `q' = p`, `p' = -sin q`.
fn pendulum() -> Result<Tape, Error> {
    let sine = Instruction::from_parts("sin", &[0], &[])?;
    let minus = Instruction::from_parts("linear", &[2], &[-1.0, 0.0])?;
    Tape::new(2, vec![sine, minus], vec![1, 3])
}

/// `q' = p`, `p' = exp(-q) - q`: a field that may hide a steep barrier, which is looked for along each step.
fn oscillator_at_a_steep_barrier() -> Result<Tape, Error> {
    let minus = Instruction::from_parts("linear", &[0], &[-1.0, 0.0])?;
    let exponential = Instruction::from_parts("exp", &[2], &[])?;
    let force = Instruction::from_parts("linear", &[3, 0], &[1.0, -1.0, 0.0])?;
    Tape::new(2, vec![minus, exponential, force], vec![1, 4])
}
