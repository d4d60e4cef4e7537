//! Tapes: every rule against closed forms, compositions against naive series, tangent vectors, failures, same bits.

use crate::common::{TWISTED_KOVALEVSKAYA, distance, run, starts, taylor};
use liepoisson_core::analysis::orbit::{Orbits, orbits};
use liepoisson_core::ensemble::{Control, Ensemble, Outcome};
use liepoisson_core::error::Error;
use liepoisson_core::field::{Field, Instruction, Space, Tape};
use liepoisson_core::lanes::Simd;
use liepoisson_core::method::RungeKutta;
use proptest::prelude::*;
use std::f64::consts::FRAC_PI_2;

fn instruction(name: &str, registers: &[usize], numbers: &[f64]) -> Instruction {
    Instruction::from_parts(name, registers, numbers).unwrap()
}

fn tape(n: usize, instructions: &[(&str, &[usize], &[f64])], outputs: &[usize]) -> Tape {
    let list = instructions.iter().map(|&(name, registers, numbers)| instruction(name, registers, numbers)).collect();
    Tape::new(n, list, outputs.to_vec()).unwrap()
}

/// Coefficients `[group][k][component]` up to `order`; groups are the state and the tangent vectors.
fn series(tape: &Tape, start: &[f64], tangents: &[f64], order: usize) -> Vec<Vec<Vec<f64>>> {
    let n = tape.n_components();
    let n_tangents = tangents.len() / n;
    let row = tape.row(n_tangents);
    let mut rows = vec![0.0_f64; tape.registers(n_tangents, order)];
    rows[..n].copy_from_slice(start);
    rows[n..n + tangents.len()].copy_from_slice(tangents);
    for k in 0..order {
        tape.derive_work(&mut rows, n_tangents, k);
        tape.extend(&mut rows, n_tangents, k);
    }
    let group = |g: usize| (0..=order).map(|k| rows[k * row + g * n..][..n].to_vec()).collect();
    (0..=n_tangents).map(group).collect()
}

fn orbit(tape: &Tape, states: &[f64], tangents: &[f64], times: &[f64], simd: Simd, threads: usize) -> Orbits {
    let n_tangents = tangents.len() / states.len();
    let ensemble = Ensemble { field: tape, method: taylor(1e-15), states, tangents, n_tangents, times };
    orbits(&ensemble, threads, simd, &Control::default(), false, |_| ()).unwrap()
}

// ---- naive series, by definition ----

fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    (0..a.len()).map(|k| (0..=k).map(|j| a[j] * b[k - j]).sum()).collect()
}

fn quotient(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut z: Vec<f64> = Vec::new();
    for k in 0..a.len() {
        let sum: f64 = (0..k).map(|j| z[j] * b[k - j]).sum();
        z.push((a[k] - sum) / b[0]);
    }
    z
}

fn factorial(k: usize) -> f64 {
    (1..=k).map(|j| j as f64).product()
}

/// `p (p - 1) ... / k!`
fn binomial(p: f64, k: usize) -> f64 {
    (0..k).map(|j| (p - j as f64) / (j + 1) as f64).product()
}

/// Taylor coefficients of a function at `x`, `n` of them.
fn expansion(name: &str, number: f64, x: f64, n: usize) -> Vec<f64> {
    let by = |f: &dyn Fn(usize) -> f64| (0..n).map(f).collect::<Vec<f64>>();
    let power = |p: f64| by(&|k| binomial(p, k) * x.powf(p - k as f64));
    let sinh = |shift: usize| by(&|k| if (k + shift).is_multiple_of(2) { x.sinh() } else { x.cosh() } / factorial(k));
    let arc = |at_0: f64, sign: f64| {
        // the integral of (1 - x^2)^(-1/2), a power of the series 1 - x^2 - 2 x t - t^2
        let square: Vec<f64> = by(&|k| [1.0 - x * x, -2.0 * x, -1.0].get(k).copied().unwrap_or(0.0));
        let slope = compose(&expansion("power", -0.5, square[0], n), &square);
        by(&|k| if k == 0 { at_0 } else { sign * slope[k - 1] / k as f64 })
    };
    match name {
        "exp" => by(&|k| x.exp() / factorial(k)),
        "sin" => by(&|k| (x + k as f64 * FRAC_PI_2).sin() / factorial(k)),
        "cos" => by(&|k| (x + k as f64 * FRAC_PI_2).cos() / factorial(k)),
        "sinh" => sinh(0),
        "cosh" => sinh(1),
        "tanh" => quotient(&sinh(0), &sinh(1)),
        "log" => by(&|k| if k == 0 { x.ln() } else { -(-1.0 / x).powi(k as i32) / k as f64 }),
        "sqrt" => power(0.5),
        "power" => power(number),
        "asin" => arc(x.asin(), 1.0),
        "acos" => arc(x.acos(), -1.0),
        // atan' = Im 1/(x - i)
        "atan" => by(&|k| match k {
            0 => x.atan(),
            _ => {
                -(-1.0_f64).powi(k as i32) * (k as f64 * 1.0_f64.atan2(x)).sin()
                    / (k as f64 * x.hypot(1.0).powi(k as i32))
            }
        }),
        _ => unreachable!("{name}"),
    }
}

/// `f(a)` from the Taylor coefficients of `f` at `a_0`: Horner's rule in `a - a_0`.
fn compose(f: &[f64], a: &[f64]) -> Vec<f64> {
    let mut shifted = a.to_vec();
    shifted[0] = 0.0;
    let mut sum = vec![0.0; a.len()];
    for &c in f.iter().rev() {
        sum = product(&sum, &shifted);
        sum[0] += c;
    }
    sum
}

fn naive_value(name: &str, registers: &[usize], numbers: &[f64], values: &[Vec<f64>]) -> Vec<f64> {
    let n = values[0].len();
    match name {
        "linear" => (0..n)
            .map(|k| {
                let constant = if k == 0 { numbers[registers.len()] } else { 0.0 };
                registers.iter().zip(numbers).map(|(&r, c)| c * values[r][k]).sum::<f64>() + constant
            })
            .collect(),
        "product" => product(&values[registers[0]], &values[registers[1]]),
        "quotient" => quotient(&values[registers[0]], &values[registers[1]]),
        _ => {
            let a = &values[registers[0]];
            let number = numbers.first().copied().unwrap_or(0.0);
            if name == "power" && number == number.trunc() {
                let mut one = vec![0.0; n];
                one[0] = 1.0;
                let whole = (0..number.abs() as usize).fold(one.clone(), |z, _| product(&z, a));
                return if number < 0.0 { quotient(&one, &whole) } else { whole };
            }
            compose(&expansion(name, number, a[0], n), a)
        }
    }
}

/// One instruction in its parts.
type Parts = (&'static str, Vec<usize>, Vec<f64>);

/// The series of all registers, order by order, by definition.
fn naive_series(n: usize, instructions: &[Parts], outputs: &[usize], start: &[f64], order: usize) -> Vec<Vec<f64>> {
    let mut components: Vec<Vec<f64>> = start.iter().map(|&x| vec![x]).collect();
    loop {
        let mut values = components.clone();
        for (name, registers, numbers) in instructions {
            let value = naive_value(name, registers, numbers, &values);
            values.push(value);
        }
        let k = components[0].len();
        if k > order {
            return values;
        }
        for i in 0..n {
            components[i].push(values[outputs[i]][k - 1] / k as f64);
        }
    }
}

// ---- every rule ----

/// `x' = 1`, `y' = f(x)`: the coefficients of `y` are those of `f` at `x_0`, divided by `k + 1`. A tangent vector along
/// `x` gives those of `f'`.
#[test]
fn every_function_has_its_taylor_series() {
    let order = 24;
    let cases: [(&str, &[f64], f64); 20] = [
        ("exp", &[], 0.7),
        ("exp", &[], -2.0),
        ("log", &[], 1.7),
        ("sin", &[], 0.9),
        ("cos", &[], -2.2),
        ("sinh", &[], 0.4),
        ("cosh", &[], -0.6),
        ("tanh", &[], 0.8),
        ("tanh", &[], -0.1),
        ("asin", &[], 0.3),
        ("acos", &[], -0.4),
        ("atan", &[], 1.3),
        ("atan", &[], -0.2),
        ("sqrt", &[], 1.0),
        ("sqrt", &[], 2.3),
        ("power", &[-1.5], 1.4),
        ("power", &[2.0 / 3.0], 0.9),
        ("power", &[3.0], -1.2),
        ("power", &[-2.0], -1.3),
        ("power", &[7.0], 0.5),
    ];
    for (name, numbers, x) in cases {
        let tape = tape(2, &[("linear", &[], &[1.0]), (name, &[0], numbers)], &[2, 3]);
        let rows = series(&tape, &[x, 0.0], &[1.0, 0.0, 1.0, 0.0], order);
        let number = numbers.first().copied().unwrap_or(0.0);
        let expected = expansion(name, number, x, order + 1);
        for k in 0..order {
            // the recurrences lose a few digits where coefficients of both signs cancel: measured below 40 units
            let bound = 100.0 * f64::EPSILON * expected[..=k + 1].iter().fold(0.0_f64, |size, c| size.max(c.abs()));
            let value = rows[0][k + 1][1] * (k + 1) as f64;
            assert!((value - expected[k]).abs() <= bound, "{name} at {x}, order {k}: {value} {}", expected[k]);
            for tangent in 1..3 {
                let slope = rows[tangent][k + 1][1];
                let wanted = expected[k + 1];
                let bound = bound * (k + 1) as f64;
                assert!((slope - wanted).abs() <= bound, "d {name} at {x}, order {k}: {slope} {wanted}");
            }
        }
    }
}

/// `tan t = sin t / cos t`: 1, 1/3, 2/15, 17/315, 62/2835.
#[test]
fn tangent_is_a_quotient() {
    let tape = tape(
        2,
        &[("linear", &[], &[1.0]), ("sin", &[0], &[]), ("cos", &[0], &[]), ("quotient", &[3, 4], &[])],
        &[2, 5],
    );
    let rows = series(&tape, &[0.0, 0.0], &[], 10);
    let expected = [0.0, 1.0, 0.0, 1.0 / 3.0, 0.0, 2.0 / 15.0, 0.0, 17.0 / 315.0, 0.0, 62.0 / 2835.0];
    for k in 0..10 {
        assert!((rows[0][k + 1][1] * (k + 1) as f64 - expected[k]).abs() < 1e-15, "order {k}");
    }
}

/// `x' = x^2` blows up, `x = 1/(1/x_0 - t)`: all coefficients are powers of `x_0`; and as `x' = 1/x`, `x^2 = x_0^2 + 2t`.
#[test]
fn products_and_reciprocals_of_the_state() {
    let rows = series(&tape(1, &[("product", &[0, 0], &[])], &[1]), &[0.5], &[1.0], 20);
    for k in 0..=20 {
        assert!((rows[0][k][0] / 0.5_f64.powi(k as i32 + 1) - 1.0).abs() < 1e-14);
        // d/dx_0 x_0^(k+1)
        assert!((rows[1][k][0] / ((k + 1) as f64 * 0.5_f64.powi(k as i32)) - 1.0).abs() < 1e-14);
    }
    let rows = series(&tape(1, &[("power", &[0], &[-1.0])], &[1]), &[1.5], &[], 20);
    for k in 0..=20 {
        let expected = binomial(0.5, k) * 2.0_f64.powi(k as i32) * 1.5_f64.powi(1 - 2 * k as i32);
        assert!((rows[0][k][0] / expected - 1.0).abs() < 1e-13, "order {k}: {} {expected}", rows[0][k][0]);
    }
}

// ---- compositions ----

/// Three components, random instructions on random registers, arguments brought into the domain of each function.
fn random_tape() -> impl Strategy<Value = (Vec<Parts>, Vec<usize>, Vec<f64>)> {
    let choice = (0..17_usize, any::<u32>(), any::<u32>(), -1.5..1.5_f64);
    let start = proptest::collection::vec(-1.0..1.0_f64, 3);
    (proptest::collection::vec(choice, 1..9), [any::<u32>(), any::<u32>(), any::<u32>()], start).prop_map(
        |(choices, outputs, start)| {
            let mut parts: Vec<Parts> = Vec::new();
            for (kind, a, b, number) in choices {
                let (a, b) = (a as usize % (3 + parts.len()), b as usize % (3 + parts.len()));
                let mut add = |name, registers: &[usize], numbers: &[f64]| {
                    parts.push((name, registers.to_vec(), numbers.to_vec()));
                    2 + parts.len()
                };
                match kind {
                    0 | 1 => _ = add("product", &[a, b], &[]),
                    2 => _ = add("product", &[a, a], &[]),
                    3 | 4 => _ = add("linear", &[a, b, 0], &[number, -0.7, 0.4, 0.3]),
                    5 => _ = add("power", &[a], &[(number * 2.0).round().abs()]),
                    6..=9 => {
                        let square = add("product", &[b, b], &[]);
                        let positive = add("linear", &[square], &[0.5, 1.2 + number.abs()]);
                        let numbers = [number + 0.01];
                        match kind {
                            6 => _ = add("quotient", &[a, positive], &[]),
                            7 => _ = add("sqrt", &[positive], &[]),
                            8 => _ = add("log", &[positive], &[]),
                            _ => _ = add("power", &[positive], &numbers),
                        }
                    }
                    10 | 11 => {
                        let small = add("linear", &[a], &[0.2, 0.1]);
                        let inside = add("tanh", &[small], &[]);
                        _ = add(if kind == 10 { "asin" } else { "acos" }, &[inside], &[]);
                    }
                    _ => {
                        let calm = add("linear", &[a], &[0.4 * number, 0.2]);
                        _ = add(["sin", "cos", "exp", "atan", "sinh"][kind - 12], &[calm], &[]);
                        _ = add(["cosh", "tanh"][kind % 2], &[calm], &[]);
                    }
                }
            }
            let last = 2 + parts.len();
            let outputs = [outputs[0] as usize % (last + 1), last, outputs[2] as usize % (last + 1)];
            (parts, outputs.to_vec(), start)
        },
    )
}

fn made(parts: &[Parts], outputs: &[usize]) -> Tape {
    let list = parts.iter().map(|(name, registers, numbers)| instruction(name, registers, numbers)).collect();
    Tape::new(3, list, outputs.to_vec()).unwrap()
}

/// The largest coefficient of any register, which sets the scale of the round-off.
fn size(values: &[Vec<f64>]) -> f64 {
    values.iter().flatten().fold(1.0_f64, |size, c| size.max(c.abs()))
}

proptest! {
    #[test]
    fn random_tapes_agree_with_naive_series((parts, outputs, start) in random_tape(), order in 2..14_usize) {
        let naive = naive_series(3, &parts, &outputs, &start, order);
        let size = size(&naive);
        prop_assume!(size < 1e3);
        let rows = series(&made(&parts, &outputs), &start, &[], order);
        for k in 0..=order {
            for i in 0..3 {
                let (value, expected) = (rows[0][k][i], naive[i][k]);
                prop_assert!((value - expected).abs() < 1e-12 * size * size, "order {k}, {i}: {value} {expected}");
            }
        }
    }

    /// The field itself, transported by its flow, stays the field: a tangent vector that starts as `x'` is `x'`.
    #[test]
    fn tangent_vector_along_the_field_is_the_derivative((parts, outputs, start) in random_tape()) {
        let order = 12;
        prop_assume!(size(&naive_series(3, &parts, &outputs, &start, order)) < 1e2);
        let tape = made(&parts, &outputs);
        let first = series(&tape, &start, &[], 1)[0][1].clone();
        let rows = series(&tape, &start, &[first.clone(), first].concat(), order);
        let size = size(&rows[0]);
        for k in 0..order {
            for i in 0..3 {
                let expected = (k + 1) as f64 * rows[0][k + 1][i];
                for tangent in &rows[1..] {
                    prop_assert!((tangent[k][i] - expected).abs() < 1e-10 * size * size, "order {k}: {} {expected}", tangent[k][i]);
                }
            }
        }
    }

    #[test]
    fn tangent_vectors_are_directional_derivatives(
        (parts, outputs, start) in random_tape(),
        v in proptest::collection::vec(-1.0..1.0_f64, 3),
        w in proptest::collection::vec(-1.0..1.0_f64, 3)
    ) {
        let order = 8;
        prop_assume!(size(&naive_series(3, &parts, &outputs, &start, order)) < 1e2);
        let tape = made(&parts, &outputs);
        let rows = series(&tape, &start, &[v.clone(), w.clone()].concat(), order);
        for (vector, tangent) in [v, w].iter().zip(&rows[1..]) {
            let shifted = |h: f64| {
                let x: Vec<f64> = start.iter().zip(vector).map(|(x, v)| x + h * v).collect();
                series(&tape, &x, &[], order).swap_remove(0)
            };
            let (a, b, c, d) = (shifted(-2e-3), shifted(-1e-3), shifted(1e-3), shifted(2e-3));
            // truncation h^4 times a fifth derivative: coefficients up to 1e2 leave eight digits
            let scale = [&a, &d, tangent].iter().fold(1.0_f64, |scale, rows| scale.max(size(rows)));
            for k in 0..=order {
                for i in 0..3 {
                    let slope = (a[k][i] - 8.0 * b[k][i] + 8.0 * c[k][i] - d[k][i]) / 12e-3;
                    prop_assert!((tangent[k][i] - slope).abs() < 1e-7 * scale * scale, "order {k}: {} {slope}", tangent[k][i]);
                }
            }
        }
    }

    #[test]
    fn bits_do_not_depend_on_width_or_threads((parts, outputs, start) in random_tape(), seed in 0..1000_usize) {
        let tape = made(&parts, &outputs);
        let mut states = start;
        states.extend((0..36).map(|i| ((i * 7 + seed) as f64 * 0.618).fract() - 0.5));
        let tangents: Vec<f64> = (0..78).map(|i| ((i * 5 + seed) as f64 * 0.755).fract() - 0.5).collect();
        let ensemble = |simd, threads| {
            let ensemble = Ensemble {
                field: &tape, method: liepoisson_core::method::Taylor::new(1e-9, None, 20).unwrap(),
                states: &states, tangents: &tangents, n_tangents: 2, times: &[0.0, 0.3],
            };
            let orbits = orbits(&ensemble, threads, simd, &Control::default(), false, |_| ()).unwrap();
            let bits = |values: &[f64]| values.iter().map(|x| if x.is_nan() { 0 } else { x.to_bits() }).collect::<Vec<_>>();
            (bits(&orbits.states), bits(&orbits.tangents), orbits.summaries.iter().map(|s| s.n_steps).collect::<Vec<_>>())
        };
        let scalar = ensemble(Simd::Scalar, 1);
        for simd in Simd::ALL {
            prop_assert!(ensemble(simd, 1) == scalar, "{}", simd.name());
        }
        prop_assert!(ensemble(Simd::widest(), 3) == scalar);
    }
}

// ---- known systems ----

/// Two unit masses on unit rods, unit gravity; see `double_pendulum_energy`.
fn double_pendulum() -> Tape {
    tape(
        4,
        &[
            ("linear", &[0, 1], &[1.0, -1.0, 0.0]),    // 4: delta
            ("sin", &[4], &[]),                        // 5: s
            ("cos", &[4], &[]),                        // 6: c
            ("product", &[5, 5], &[]),                 // 7
            ("linear", &[7], &[1.0, 1.0]),             // 8: d = 1 + s^2
            ("product", &[2, 6], &[]),                 // 9: p1 c
            ("product", &[3, 6], &[]),                 // 10: p2 c
            ("linear", &[2, 10], &[1.0, -1.0, 0.0]),   // 11
            ("linear", &[3, 9], &[2.0, -1.0, 0.0]),    // 12
            ("quotient", &[11, 8], &[]),               // 13: theta1'
            ("quotient", &[12, 8], &[]),               // 14: theta2'
            ("product", &[13, 14], &[]),               // 15
            ("product", &[15, 5], &[]),                // 16: theta1' theta2' s
            ("sin", &[0], &[]),                        // 17
            ("sin", &[1], &[]),                        // 18
            ("linear", &[17, 16], &[-2.0, -1.0, 0.0]), // 19: p1'
            ("linear", &[18, 16], &[-1.0, 1.0, 0.0]),  // 20: p2'
        ],
        &[13, 14, 19, 20],
    )
}

/// `H = (p1^2 + 2 p2^2 - 2 p1 p2 c) / (2 (1 + s^2)) - 2 cos theta1 - cos theta2`
fn double_pendulum_energy(x: &[f64]) -> f64 {
    let (s, c) = (x[0] - x[1]).sin_cos();
    let kinetic = x[2] * x[2] + 2.0 * x[3] * x[3] - 2.0 * x[2] * x[3] * c;
    kinetic / (2.0 * (1.0 + s * s)) - 2.0 * x[0].cos() - x[1].cos()
}

#[test]
fn double_pendulum_keeps_its_energy() {
    let start = [2.0, -1.0, 0.4, 0.3];
    let orbit = orbit(&double_pendulum(), &start, &[], &[0.0, 20.0], Simd::widest(), 1);
    assert_eq!(orbit.summaries[0].outcome, Outcome::Finished);
    let drift = (double_pendulum_energy(&orbit.states[4..]) - double_pendulum_energy(&start)).abs();
    assert!(distance(&orbit.states[4..], &start) > 0.5 && drift < 1e-13, "{drift:e}");
}

/// The twisted Kovalevskaya top, written out: l' = l x omega + alpha x a, alpha' = alpha x omega + beta x a,
/// beta' = beta x omega, with omega = (l1/2, l2/2, l3), a = (-1, 0, 0).
fn twisted_top() -> Tape {
    let mut list: Vec<Instruction> = vec![
        instruction("linear", &[0], &[0.5, 0.0]),
        instruction("linear", &[1], &[0.5, 0.0]),
        instruction("linear", &[2], &[1.0, 0.0]),
    ];
    let mut outputs = vec![];
    for vector in 0..3 {
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            list.push(Instruction::Product(3 * vector + j, 9 + k));
            list.push(Instruction::Product(3 * vector + k, 9 + j));
            let at = 9 + list.len();
            let mut terms = vec![(at - 2, 1.0), (at - 1, -1.0)];
            // u x a = (0, -u3, u2) for a = (-1, 0, 0), with u the next vector
            match (vector, i) {
                (0 | 1, 1) => terms.push((3 * vector + 5, -1.0)),
                (0 | 1, 2) => terms.push((3 * vector + 4, 1.0)),
                _ => {}
            }
            list.push(Instruction::Linear { terms, constant: 0.0 });
            outputs.push(at);
        }
    }
    Tape::new(9, list, outputs).unwrap()
}

#[test]
fn twisted_top_as_a_tape_is_the_top() {
    let (states, times) = (starts(16), [0.0, 2.0, 5.0]);
    let tangents: Vec<f64> = states.iter().rev().copied().collect();
    let expected = run(&TWISTED_KOVALEVSKAYA.top(), taylor(1e-15), &states, &tangents, &times, Simd::widest());
    let found = orbit(&twisted_top(), &states, &tangents, &times, Simd::widest(), 1);
    // round-off, stretched by up to e^(5 max|omega|)
    assert!(distance(&found.states, &expected.states) < 1e-12, "{:e}", distance(&found.states, &expected.states));
    let largest = expected.tangents.iter().fold(0.0_f64, |size, c| size.max(c.abs()));
    let difference = distance(&found.tangents, &expected.tangents);
    assert!(difference < 1e-12 * largest, "{difference:e} of {largest}");
}

// ---- failures ----

/// `x' = -1`, `y' = f(x)`: ends where f does, and only in its own lane. Near the end, at `x = 0`, `y` is an analytic
/// function plus some `x^q`; a last step may reach so far beyond that `|x|^q` is still of the size of the tolerance.
#[test]
fn a_failing_lane_ends_alone_at_its_last_good_point() {
    let minus_one: (&str, &[usize], &[f64]) = ("linear", &[], &[-1.0]);
    for (name, numbers, q) in [
        ("sqrt", &[][..], 1.5),
        ("log", &[], 1.0),
        ("power", &[-1.0], 0.0),
        ("power", &[1.5], 2.5),
        ("power", &[-0.7], 0.3),
    ] {
        let beyond = 1e-13_f64.powf(1.0 / q);
        let field = tape(2, &[minus_one, (name, &[0], numbers)], &[2, 3]);
        let states: Vec<f64> = (0..9).flat_map(|m| [if m % 4 == 2 { 1.0 } else { 7.0 + m as f64 }, 0.0]).collect();
        for simd in Simd::ALL {
            let orbits = orbit(&field, &states, &[], &[0.0, 3.0], simd, 1);
            for m in 0..9 {
                let (summary, end) = (&orbits.summaries[m], &orbits.states[4 * m + 2..4 * m + 4]);
                if m % 4 == 2 {
                    let failed =
                        [Outcome::NotFinite, Outcome::StepTooSmall, Outcome::MaxSteps].contains(&summary.outcome);
                    assert!(failed, "{name} {:?}", summary.outcome);
                    let time = summary.time;
                    assert!(time > 0.9 && time <= 1.0 + beyond, "{name} {numbers:?}: ended at {time}, {beyond:e}");
                    assert!(summary.state.iter().all(|x| x.is_finite()) && end.iter().all(|x| x.is_nan()));
                } else {
                    let alone = orbit(&field, &states[2 * m..2 * m + 2], &[], &[0.0, 3.0], Simd::Scalar, 1);
                    assert_eq!((summary.outcome, end), (Outcome::Finished, &alone.states[2..]), "{name}");
                }
            }
        }
    }
}

/// `H = p^2/2 + V(q)` with corners in `V`, each smooth as an analytic function: `V'` of `sqrt(q^2)`, `asin(sin q)`, `acos(cos q)`,
/// `(q^6)^(1/6)` and `|q|^3`. The orbit ends at the first corner, forwards and backwards; up to there its energy is kept.
#[test]
fn a_series_does_not_continue_a_root_on_its_other_branch() {
    type List = Vec<(&'static str, &'static [usize], &'static [f64])>;
    type Kink = (&'static str, List, usize, f64, fn(f64) -> f64);
    use std::f64::consts::PI;
    let kinks: [Kink; 6] = [
        ("sqrt", vec![("product", &[0, 0], &[]), ("sqrt", &[2], &[]), ("quotient", &[0, 3], &[])], 4, 0.0, f64::abs),
        (
            "asin",
            vec![
                ("sin", &[0], &[]),
                ("cos", &[0], &[]),
                ("product", &[2, 2], &[]),
                ("linear", &[4], &[-1.0, 1.0]),
                ("sqrt", &[5], &[]),
                ("quotient", &[3, 6], &[]),
            ],
            7,
            -PI / 2.0,
            |q| q.sin().asin(),
        ),
        (
            "acos",
            vec![
                ("sin", &[0], &[]),
                ("cos", &[0], &[]),
                ("product", &[3, 3], &[]),
                ("linear", &[4], &[-1.0, 1.0]),
                ("sqrt", &[5], &[]),
                ("quotient", &[2, 6], &[]),
            ],
            7,
            0.0,
            |q| q.cos().acos(),
        ),
        (
            "power",
            vec![
                ("power", &[0], &[6.0]),
                ("power", &[2], &[1.0 / 6.0 - 1.0]),
                ("power", &[0], &[5.0]),
                ("product", &[3, 4], &[]),
            ],
            5,
            0.0,
            f64::abs,
        ),
        (
            "cube",
            vec![
                ("product", &[0, 0], &[]),
                ("power", &[2], &[1.5]),
                ("quotient", &[3, 0], &[]),
                ("linear", &[4], &[3.0, 0.0]),
            ],
            5,
            0.0,
            |q| q.abs().powi(3),
        ),
        (
            "weak",
            vec![
                ("product", &[0, 0], &[]),
                ("sqrt", &[2], &[]),
                ("quotient", &[0, 3], &[]),
                ("linear", &[4], &[1e-9, 0.0]),
            ],
            5,
            0.0,
            |q| 1e-9 * q.abs(),
        ),
    ];
    for (name, mut list, force, corner, potential) in kinks {
        list.push(("linear", &[0], &[0.0, 0.0]));
        let (last, terms) = (list.len() + 1, [(force, -1.0)]);
        let mut instructions: Vec<Instruction> = list.iter().map(|(name, r, n)| instruction(name, r, n)).collect();
        instructions[last - 2] = Instruction::Linear { terms: terms.to_vec(), constant: 0.0 };
        let field = Tape::new(2, instructions, vec![1, last]).unwrap();
        for backwards in [1.0, -1.0] {
            // towards the corner from its right
            let states = [[corner + 1.0, -0.9 * backwards], [corner + 1.3, -1.1 * backwards]].concat();
            let times: Vec<f64> = (0..=40).map(|i| backwards * 0.1 * f64::from(i)).collect();
            for (order, tolerance) in [(None, 1e-15), (Some(40), 1e-12), (Some(6), 1e-6)] {
                let method = liepoisson_core::method::Taylor::new(tolerance, order, 100_000).unwrap();
                let ensemble =
                    Ensemble { field: &field, method, states: &states, tangents: &[], n_tangents: 0, times: &times };
                let found = orbits(&ensemble, 1, Simd::widest(), &Control::default(), false, |_| ()).unwrap();
                for m in 0..2 {
                    let summary = &found.summaries[m];
                    let what = format!("{name}, {order:?}, {backwards}: {summary:?}");
                    assert!([Outcome::StepTooSmall, Outcome::NotFinite].contains(&summary.outcome), "{what}");
                    assert!((summary.state[0] - corner).abs() < 1e-6 && summary.time * backwards > 0.5, "{what}");
                    let energy = |x: &[f64]| 0.5 * x[1] * x[1] + potential(x[0]);
                    let start = energy(&states[2 * m..]);
                    for x in found.states[82 * m..82 * (m + 1)].chunks_exact(2).filter(|x| x[0].is_finite()) {
                        assert!((energy(x) - start).abs() < 1e3 * tolerance + 1e-12, "{what}: {:e}", energy(x) - start);
                    }
                }
            }
        }
    }
}

/// `H = p^2/2 + |q|`: away from the corner, however close it starts, the orbit goes on until it comes back.
#[test]
fn a_root_that_has_nearly_vanished_before_the_start_is_no_obstacle() {
    let list: [(&str, &[usize], &[f64]); 4] =
        [("product", &[0, 0], &[]), ("sqrt", &[2], &[]), ("quotient", &[0, 3], &[]), ("linear", &[4], &[-1.0, 0.0])];
    let field = tape(2, &list, &[1, 5]);
    for (distance, direction) in [(1e-3, 1.0), (1e-9, 1.0), (1e-9, -1.0), (-1e-12, 1.0)] {
        let sign = f64::signum(distance) * direction;
        let found = orbit(&field, &[distance, 0.9 * sign], &[], &[0.0, 4.0 * direction], Simd::widest(), 1);
        let (summary, wanted) = (&found.summaries[0], 0.9 + f64::sqrt(0.81 + 2.0 * f64::abs(distance)));
        assert_eq!(summary.outcome, Outcome::StepTooSmall);
        assert!((summary.time * direction - wanted).abs() < 1e-5, "{summary:?}, not {wanted}");
    }
}

/// A root that does not vanish takes no step more than its solution allows, and a pole that cancels is passed through.
#[test]
fn roots_that_do_not_vanish_and_poles_that_cancel_are_no_obstacles() {
    // q' = p, p' = -q / sqrt(1 + q^2); and q' = p, p' = -q^2 / q
    let root: [(&str, &[usize], &[f64]); 5] = [
        ("product", &[0, 0], &[]),
        ("linear", &[2], &[1.0, 1.0]),
        ("sqrt", &[3], &[]),
        ("quotient", &[0, 4], &[]),
        ("linear", &[5], &[-1.0, 0.0]),
    ];
    let pole: [(&str, &[usize], &[f64]); 3] =
        [("product", &[0, 0], &[]), ("quotient", &[2, 0], &[]), ("linear", &[3], &[-1.0, 0.0])];
    let (root, pole) = (tape(2, &root, &[1, 6]), tape(2, &pole, &[1, 4]));
    let found = orbit(&root, &[2.0, 0.3], &[], &[0.0, 30.0], Simd::widest(), 1);
    let energy = |x: &[f64]| 0.5 * x[1] * x[1] + (1.0 + x[0] * x[0]).sqrt();
    assert_eq!(found.summaries[0].outcome, Outcome::Finished);
    assert!((energy(&found.states[2..]) - energy(&[2.0, 0.3])).abs() < 1e-13);
    assert!(found.summaries[0].n_steps < 100, "{}", found.summaries[0].n_steps);
    let found = orbit(&pole, &[1.0, 0.0], &[], &[0.0, 5.0], Simd::widest(), 1);
    assert_eq!(found.summaries[0].outcome, Outcome::Finished);
    assert!((found.states[2] - 5.0_f64.cos()).abs() < 1e-12);
}

#[test]
fn a_start_outside_the_domain_is_not_finite() {
    let outside: [(&str, &[f64], f64); 14] = [
        ("sqrt", &[], -1.0),
        ("sqrt", &[], 0.0),
        ("log", &[], 0.0),
        ("log", &[], -2.0),
        ("asin", &[], 1.5),
        ("asin", &[], 1.0),
        ("acos", &[], -1.5),
        ("power", &[-1.0], 0.0),
        ("power", &[0.5], -1.0),
        ("power", &[1.5], -1.0),
        ("power", &[-0.3], 0.0),
        ("exp", &[], 1000.0),
        ("cosh", &[], 1000.0),
        ("sin", &[], f64::INFINITY),
    ];
    for (name, numbers, x) in outside {
        // x rests, so that nothing but order 0 could tell; and x moves
        for rate in [0.0, 1.0] {
            let field = tape(2, &[("linear", &[], &[rate]), (name, &[0], numbers)], &[2, 3]);
            let orbit = orbit(&field, &[x, 0.0], &[], &[0.0, 1.0], Simd::widest(), 1);
            assert_eq!(orbit.summaries[0].outcome, Outcome::NotFinite, "{name} at {x}, rate {rate}");
            assert_eq!((orbit.summaries[0].time, &orbit.summaries[0].state[..]), (0.0, &[x, 0.0][..]));
        }
    }
}

/// What is divided by a number beyond the range is zero, as `1 / (1e300 x^2)` is to all digits.
#[test]
fn a_reciprocal_beyond_the_range_is_zero() {
    let instructions: [(&str, &[usize], &[f64]); 3] =
        [("product", &[0, 0], &[]), ("linear", &[1], &[1e300, 1.0]), ("power", &[2], &[-1.0])];
    let field = tape(1, &instructions, &[3]);
    let outcome = |x: f64| orbit(&field, &[x], &[], &[0.0, 1.0], Simd::widest(), 1).summaries[0].outcome;
    assert_eq!((outcome(1.0), outcome(1e10)), (Outcome::Finished, Outcome::Finished));
}

#[test]
fn a_constant_that_fails_is_not_finite() {
    for (name, constant) in [("sqrt", -1.0), ("log", 0.0), ("power", 0.0)] {
        let numbers: &[f64] = if name == "power" { &[-1.0] } else { &[] };
        let field = tape(1, &[("linear", &[], &[constant]), (name, &[1], numbers)], &[2]);
        let orbit = orbit(&field, &[1.0], &[], &[0.0, 1.0], Simd::widest(), 1);
        assert_eq!(orbit.summaries[0].outcome, Outcome::NotFinite, "{name}");
    }
}

#[test]
fn malformed_tapes_are_refused() {
    let make = |n, name: &str, registers: &[usize], numbers: &[f64], outputs: &[usize]| {
        Instruction::from_parts(name, registers, numbers)
            .and_then(|instruction| Tape::new(n, vec![instruction], outputs.to_vec()))
            .err()
    };
    assert_eq!(make(1, "sin", &[0], &[], &[1]), None);
    assert_eq!(make(0, "linear", &[], &[1.0], &[]), Some(Error::Components { got: 0 }));
    assert_eq!(make(1, "sinus", &[0], &[], &[1]), Some(Error::UnknownInstruction { name: "sinus".into() }));
    let operands = |name, wanted, got| Some(Error::InstructionOperands { name, wanted, got });
    assert_eq!(make(1, "sin", &[0, 0], &[], &[1]), operands("sin", (1, 0), (2, 0)));
    assert_eq!(make(1, "product", &[0], &[1.0], &[1]), operands("product", (2, 0), (1, 1)));
    assert_eq!(make(1, "power", &[0], &[], &[1]), operands("power", (1, 1), (1, 0)));
    assert_eq!(make(1, "linear", &[0], &[1.0], &[1]), operands("linear", (1, 2), (1, 1)));
    let register = Error::InstructionRegister { index: 0, name: "exp", register: 1, available: 1 };
    assert_eq!(make(1, "exp", &[1], &[], &[1]), Some(register));
    let number = make(1, "linear", &[0], &[f64::INFINITY, 0.0], &[1]);
    assert_eq!(number, Some(Error::InstructionNumber { index: 0, name: "linear", got: f64::INFINITY }));
    assert!(matches!(make(1, "power", &[0], &[f64::NAN], &[1]), Some(Error::InstructionNumber { .. })));
    assert_eq!(make(2, "exp", &[1], &[], &[1]), Some(Error::Outputs { wanted: 2, got: 1 }));
    let output = Error::OutputRegister { component: 1, register: 3, available: 3 };
    assert_eq!(make(2, "exp", &[1], &[], &[2, 3]), Some(output.clone()));
    assert!(output.to_string().contains("wanted a register below 3; got 3"));
}

// ---- the optimiser ----

/// Memory counts the rules that are left: a repeated, an unused or a merely linear instruction adds nothing.
#[test]
fn construction_drops_what_is_not_needed() {
    let plain = tape(2, &[("sin", &[0], &[]), ("product", &[2, 1], &[])], &[1, 3]);
    let wordy = tape(
        2,
        &[
            ("sin", &[0], &[]),
            ("linear", &[0], &[-1.0, 0.0]),
            ("sin", &[3], &[]), // -sin x
            ("cos", &[0], &[]), // unused
            ("linear", &[], &[2.0]),
            ("product", &[4, 6], &[]),              // -2 sin x
            ("log", &[6], &[]),                     // a constant
            ("linear", &[7, 2], &[-0.5, 0.0, 0.0]), // sin x
            ("product", &[1, 9], &[]),
            ("exp", &[10], &[]), // unused
            ("linear", &[10, 8], &[1.0, 0.0, 0.0]),
        ],
        &[1, 12],
    );
    assert_eq!(wordy.registers(1, 20), plain.registers(1, 20));
    let (x, v) = ([0.3, 0.8], [1.0, -0.5]);
    assert_eq!(series(&wordy, &x, &v, 12), series(&plain, &x, &v, 12));
}

/// Factors whose product leaves the range of numbers stay with their operands.
#[test]
fn extreme_factors_are_not_gathered() {
    let instructions: [(&str, &[usize], &[f64]); 3] =
        [("linear", &[0], &[1e200, 0.0]), ("linear", &[1], &[1e200, 0.0]), ("product", &[2, 3], &[])];
    let rows = series(&tape(2, &instructions, &[4, 0]), &[1e-200, 3e-200], &[], 1);
    assert!((rows[0][1][0] - 3.0).abs() < 1e-14, "{}", rows[0][1][0]);
}

/// The tape and the tolerance say which; an order that a caller chose stays.
#[test]
fn the_order_of_a_series_follows_from_the_tape() {
    let order = |tape: &Tape, tolerance: f64, wanted: Option<usize>| {
        liepoisson_core::method::Taylor::new(tolerance, wanted, 1).unwrap().for_tape(tape).order()
    };
    let of = |tape: &Tape| [1e-15, 1e-13, 1e-4].map(|tolerance| order(tape, tolerance, None));
    // where products cost nothing a high order is cheap
    let linear = of(&tape(2, &[("linear", &[0], &[-1.0, 0.0])], &[1, 2]));
    assert_eq!(linear, [25, 25, 24]);
    let pendulum = of(&double_pendulum());
    assert!(pendulum.is_sorted_by(|a, b| a >= b) && pendulum[2] < linear[2], "{pendulum:?}");
    assert_eq!([2, 15, 64].map(|wanted| order(&double_pendulum(), 1e-10, Some(wanted))), [2, 15, 64]);
}

/// Long enough for the expansions to be compiled, where they can be. tests/portable has orbits without compiled code.
#[test]
fn orbits_have_the_same_bits_in_compiled_code_of_any_width() {
    // q'' = -sin q - q/(3 + q^2), with a large angle in the last lane but one
    let parts: [(&str, &[usize], &[f64]); 6] = [
        ("sin", &[0], &[]),
        ("product", &[0, 0], &[]),
        ("linear", &[3], &[1.0, 3.0]),
        ("quotient", &[0, 4], &[]),
        ("linear", &[2, 5], &[-1.0, -1.0, 0.0]),
        ("exp", &[0], &[]),
    ];
    let field = || tape(2, &parts, &[1, 6]);
    let mut states: Vec<f64> = (0..22).map(|i| (f64::from(i) * 0.618).fract() - 0.4).collect();
    states[18] = 2e9;
    let tangents: Vec<f64> = (0..22).map(|i| (f64::from(i) * 0.754).fract()).collect();
    let times = [0.0, 100.0, 700.0];
    let bits = |numbers: &[f64]| numbers.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    let of = |field: &Tape, simd: Simd, threads: usize| {
        let (states, tangents, times) = (&states[..], &tangents[..], &times[..]);
        let by_series = Ensemble { field, method: taylor(1e-10), states, tangents, n_tangents: 1, times };
        let method = RungeKutta::new(1e-8, 1_000_000).unwrap();
        let by_stages = Ensemble { field, method, states, tangents, n_tangents: 1, times };
        let method = RungeKutta::fixed(0.2, 1_000_000).unwrap().compensated();
        let by_equal_steps = Ensemble { method, ..by_stages };
        let control = Control::default();
        let by_equal_steps = orbits(&by_equal_steps, threads, simd, &control, false, |_| ()).unwrap();
        let by_series = orbits(&by_series, threads, simd, &control, false, |_| ()).unwrap();
        let by_stages = orbits(&by_stages, threads, simd, &control, false, |_| ()).unwrap();
        let of = [by_series, by_stages, by_equal_steps].map(|found| [found.states, found.tangents]);
        of.map(|numbers| numbers.map(|numbers| bits(&numbers)))
    };
    let expected = of(&field(), Simd::Scalar, 1);
    for simd in Simd::ALL.into_iter().filter(|simd| simd.is_available()) {
        for threads in [1, 2] {
            let field = field();
            assert_eq!(of(&field, simd, threads), expected, "{}, {threads} threads", simd.name());
            // code for single numbers is made of the same instructions
            let compiles = cfg!(target_os = "linux") && Simd::Avx2.is_available();
            assert_eq!(field.kernel(simd) != simd.name(), compiles, "{}", field.kernel(simd));
        }
    }
}
