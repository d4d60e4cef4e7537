//! How fast are fields given as tapes?
//! `cargo run --release --example rate_tape -- [tolerance] [trajectories] [t_end] [repeats] [name] [order]`
//!
//! A double pendulum, the canonical top and a Toda chain, each with one tangent vector, one thread, every instruction set of this
//! processor (or the one in `LIEPOISSON_SIMD`); the best of the repeats. The name of one of them leaves the others out.

use liepoisson_core::analysis::lyapunov;
use liepoisson_core::ensemble::{Control, Ensemble};
use liepoisson_core::error::Error;
use liepoisson_core::field::{Instruction, Tape};
use liepoisson_core::lanes::Simd;
use liepoisson_core::method::Taylor;
use std::time::Instant;

/// Writes instructions; each call answers with the register of its result.
struct Writer {
    n_components: usize,
    instructions: Vec<Instruction>,
}

impl Writer {
    fn add(&mut self, instruction: Instruction) -> usize {
        self.instructions.push(instruction);
        self.n_components + self.instructions.len() - 1
    }

    fn linear(&mut self, terms: &[(usize, f64)], constant: f64) -> usize {
        self.add(Instruction::Linear { terms: terms.to_vec(), constant })
    }

    fn product(&mut self, a: usize, b: usize) -> usize {
        self.add(Instruction::Product(a, b))
    }

    fn quotient(&mut self, a: usize, b: usize) -> usize {
        self.add(Instruction::Quotient(a, b))
    }
}

/// Two unit masses on unit rods, unit gravity; state `(theta1, theta2, p1, p2)`, `s, c` of `theta1 - theta2`:
/// ```text
/// theta1' = (p1 - p2 c) / (1 + s^2),  theta2' = (2 p2 - p1 c) / (1 + s^2),
/// p1' = -2 sin theta1 - A + 2 B s c,  p2' = -sin theta2 + A - 2 B s c,
/// A = p1 p2 s / (1 + s^2),  B = (p1^2 + 2 p2^2 - 2 p1 p2 c) / (2 (1 + s^2)^2)
/// ```
fn double_pendulum() -> Result<Tape, Error> {
    let mut w = Writer { n_components: 4, instructions: vec![] };
    let (theta1, theta2, p1, p2) = (0, 1, 2, 3);
    let delta = w.linear(&[(theta1, 1.0), (theta2, -1.0)], 0.0);
    let (s, c) = (w.add(Instruction::Sin(delta)), w.add(Instruction::Cos(delta)));
    let square = w.product(s, s);
    let d = w.linear(&[(square, 1.0)], 1.0);
    let (p1c, p2c) = (w.product(p1, c), w.product(p2, c));
    let (n1, n2) = (w.linear(&[(p1, 1.0), (p2c, -1.0)], 0.0), w.linear(&[(p2, 2.0), (p1c, -1.0)], 0.0));
    let (rate1, rate2) = (w.quotient(n1, d), w.quotient(n2, d));
    let p1p2 = w.product(p1, p2);
    let p1p2s = w.product(p1p2, s);
    let a = w.quotient(p1p2s, d);
    let (p1p1, p2p2, p1p2c) = (w.product(p1, p1), w.product(p2, p2), w.product(p1p2, c));
    let numerator = w.linear(&[(p1p1, 1.0), (p2p2, 2.0), (p1p2c, -2.0)], 0.0);
    let dd = w.product(d, d);
    let b = w.quotient(numerator, dd);
    let sc = w.product(s, c);
    let bsc = w.product(b, sc);
    let (sin1, sin2) = (w.add(Instruction::Sin(theta1)), w.add(Instruction::Sin(theta2)));
    let force1 = w.linear(&[(sin1, -2.0), (a, -1.0), (bsc, 1.0)], 0.0);
    let force2 = w.linear(&[(sin2, -1.0), (a, 1.0), (bsc, -1.0)], 0.0);
    Tape::new(4, w.instructions, vec![rate1, rate2, force1, force2])
}

/// The twisted Lagrange top in Euler angles, state `(theta, phi, psi, p_theta, p_phi, p_psi)`, with `I1 = 1`,
/// `I3 = 1/2`, `a3 = 1`, `v = 0.3`, `eta = 4`, `2 epsilon w = 1`; `s, c` of theta and `u = (p_phi - p_psi c) / s`:
/// ```text
/// H = (p_theta^2 + u^2) / (2 I1) + p_psi^2 / (2 I3) + a3 (v c + r s sin phi),  r = sqrt(eta - 2 epsilon w p_phi)
/// ```
fn canonical_top() -> Result<Tape, Error> {
    let mut w = Writer { n_components: 6, instructions: vec![] };
    let (theta, phi, p_theta, p_phi, p_psi) = (0, 1, 3, 4, 5);
    let (s, c) = (w.add(Instruction::Sin(theta)), w.add(Instruction::Cos(theta)));
    let (sin_phi, cos_phi) = (w.add(Instruction::Sin(phi)), w.add(Instruction::Cos(phi)));
    let radicand = w.linear(&[(p_phi, -1.0)], 4.0);
    let r = w.add(Instruction::Sqrt(radicand));
    let p_psi_c = w.product(p_psi, c);
    let along = w.linear(&[(p_phi, 1.0), (p_psi_c, -1.0)], 0.0);
    let u = w.quotient(along, s);
    let u_over_s = w.quotient(u, s);
    let s_sin_phi = w.product(s, sin_phi);
    let of_r = w.quotient(s_sin_phi, r);
    let phi_rate = w.linear(&[(u_over_s, 1.0), (of_r, -0.5)], 0.0);
    let u_c_over_s = w.product(u_over_s, c);
    let psi_rate = w.linear(&[(p_psi, 2.0), (u_c_over_s, -1.0)], 0.0);
    let bracket = w.linear(&[(p_psi, 1.0), (u_c_over_s, -1.0)], 0.0);
    let u_bracket = w.product(u, bracket);
    let r_c = w.product(r, c);
    let r_c_sin_phi = w.product(r_c, sin_phi);
    let p_theta_rate = w.linear(&[(u_bracket, -1.0), (s, 0.3), (r_c_sin_phi, -1.0)], 0.0);
    let s_cos_phi = w.product(s, cos_phi);
    let r_s_cos_phi = w.product(r, s_cos_phi);
    let p_phi_rate = w.linear(&[(r_s_cos_phi, -1.0)], 0.0);
    let zero = w.linear(&[], 0.0);
    Tape::new(6, w.instructions, vec![p_theta, phi_rate, psi_rate, p_theta_rate, p_phi_rate, zero])
}

/// The periodic Toda chain of eight, state `(q, p)`: `q_k' = p_k`, `p_k' = exp(q_(k-1) - q_k) - exp(q_k - q_(k+1))`.
fn toda() -> Result<Tape, Error> {
    let mut w = Writer { n_components: 16, instructions: vec![] };
    let springs: Vec<usize> = (0..8)
        .map(|k| {
            let stretch = w.linear(&[(k, 1.0), ((k + 1) % 8, -1.0)], 0.0);
            w.add(Instruction::Exp(stretch))
        })
        .collect();
    let forces = (0..8).map(|k| w.linear(&[(springs[(k + 7) % 8], 1.0), (springs[k], -1.0)], 0.0)).collect::<Vec<_>>();
    Tape::new(16, w.instructions, (8..16).chain(forces).collect())
}

/// A fixed spread of numbers in `[low, high)`, by multiples of an irrational number for each component.
fn spread(k: usize, component: usize, low: f64, high: f64) -> f64 {
    let step = [0.618_033_988_75, 0.754_877_666_25, 0.569_840_290_998, 0.819_172_513_396, 0.671_043_606_704, 0.549_700];
    low + (high - low) * ((k as f64 + 0.5) * step[component % 6] + (component / 6) as f64 * 0.377).fract()
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let tolerance = arguments.next().map_or(Ok(1e-15), |s| s.parse())?;
    let trajectories: usize = arguments.next().map_or(Ok(512), |s| s.parse())?;
    let t_end: f64 = arguments.next().map_or(Ok(50.0), |s| s.parse())?;
    let repeats: usize = arguments.next().map_or(Ok(3), |s| s.parse())?;
    let wanted = arguments.next().unwrap_or_default();
    let order = arguments.next().map(|s| s.parse()).transpose()?;
    let method = Taylor::new(tolerance, order, u64::MAX)?;
    let pendulum_ranges = [(-1.5, 1.5), (-1.5, 1.5), (-1.0, 1.0), (-1.0, 1.0)];
    let top_ranges = [(0.8, 2.3), (-3.0, 3.0), (-3.0, 3.0), (-0.5, 0.5), (-0.5, 0.5), (0.5, 1.5)];
    for (name, tape, ranges) in [
        ("double pendulum", double_pendulum()?, &pendulum_ranges[..]),
        ("canonical top", canonical_top()?, &top_ranges[..]),
        ("Toda chain", toda()?, &[(-1.0, 1.0); 16][..]),
    ] {
        if !name.contains(&wanted) {
            continue;
        }
        let n = ranges.len();
        let states: Vec<f64> =
            (0..trajectories * n).map(|at| spread(at / n, at % n, ranges[at % n].0, ranges[at % n].1)).collect();
        let tangents: Vec<f64> = (0..trajectories * n).map(|at| spread(at / n + 7, at % n, -1.0, 1.0)).collect();
        let (tangents, times) = (&tangents, &[0.0, t_end]);
        let ensemble = Ensemble { field: &tape, method, states: &states, tangents, n_tangents: 1, times };
        let forced = std::env::var_os("LIEPOISSON_SIMD").is_some();
        for simd in Simd::ALL.into_iter().filter(|simd| simd.is_available()) {
            if forced && simd != Simd::from_environment()? {
                continue;
            }
            let mut best = f64::INFINITY;
            let (mut steps, mut mean) = (0, f64::NAN);
            for _ in 0..repeats {
                let start = Instant::now();
                let found = lyapunov::finite_time_exponents(&ensemble, 1, simd, &Control::default(), |_| ())?;
                best = best.min(start.elapsed().as_secs_f64());
                steps = found.summaries.iter().map(|summary| summary.n_steps).sum::<u64>();
                mean = found.exponents.iter().sum::<f64>() / trajectories as f64;
            }
            let units = trajectories as f64 * t_end;
            println!(
                "{name}, {:>6}: order {}, {:.2} steps per unit, {:.4}e6 units/s, {:.0} ns per step, exponent {mean:.12}",
                simd.name(),
                method.for_tape(&tape).order(),
                steps as f64 / units,
                units / best / 1e6,
                best * 1e9 / steps as f64,
            );
        }
    }
    Ok(())
}
