//! The bits of every kernel, as recorded: the same on every processor and for every compiler.
//!
//! Ensembles with fixed starts go through each method on each kind of field, in every instruction set that the processor has,
//! and hashes of the bits of the results are compared with those in `same_bits.txt`. Where the arithmetic is changed on purpose,
//! `LIEPOISSON_RECORD_BITS=1 cargo test -p liepoisson-core --test core same_bits` writes them anew.
//!
//! Nothing here asks the C library for a sine or a logarithm, whose last bits differ from one system to the next: the core itself
//! uses such functions of its own, or of the crate libm. The one thing that processors do in ways of their own is the sign
//! of a NaN that they make: every NaN counts as the same.

use crate::common::{Parameters, TWISTED_KOVALEVSKAYA};
use liepoisson_core::analysis::frame::orthonormalise;
use liepoisson_core::analysis::lyapunov::finite_time_exponents;
use liepoisson_core::analysis::orbit::orbits;
use liepoisson_core::analysis::section::{Surface, sections};
use liepoisson_core::enclosure::flow::{Bundle, Flow, Options};
use liepoisson_core::enclosure::interval::Interval;
use liepoisson_core::enclosure::lohner::StateSet;
use liepoisson_core::enclosure::matrix::Matrix;
use liepoisson_core::enclosure::polynomial::Polynomial;
use liepoisson_core::enclosure::program::Program;
use liepoisson_core::enclosure::rational::Rational;
use liepoisson_core::ensemble::{Control, Ensemble, Outcome, Summary};
use liepoisson_core::field::{
    Bounds, Functions, Instruction, Noise, Noisy, Path, Quadratic, Ridge, Space, SplitTerms, Tape,
};
use liepoisson_core::lanes::Simd;
use liepoisson_core::method::{
    AcrossComponents, Gauss, LagrangeMap, Method, MixedTaylor, RungeKutta, Single, Splitting, Taylor,
};
use std::fmt::Write;

/// More than the widest register holds, and not a multiple: slots are taken again, and some stay free.
const TRAJECTORIES: usize = 19;
const MAX: u64 = 1_000_000;

const GENERAL: Parameters =
    Parameters { inertia: [1.7, 1.1, 0.6], a: [0.4, -0.3, 0.9], b: [0.2, 0.5, -0.1], epsilon: 0.8 };
const LAGRANGE: Parameters = Parameters { inertia: [1.4, 1.4, 0.8], a: [0.0, 0.0, 0.9], b: [0.0; 3], epsilon: 0.6 };

/// The hash FNV-1a of numbers, byte by byte.
struct Hash(u64);

impl Hash {
    fn new() -> Hash {
        Hash(0xcbf2_9ce4_8422_2325)
    }

    fn bits(&mut self, bits: u64) {
        for byte in bits.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    fn numbers(&mut self, numbers: &[f64]) {
        for number in numbers {
            self.bits(if number.is_nan() { f64::NAN.to_bits() } else { number.to_bits() });
        }
    }

    fn summaries(&mut self, summaries: &[Summary]) {
        for summary in summaries {
            let outcome = Outcome::ALL.iter().position(|&outcome| outcome == summary.outcome).unwrap();
            self.bits(outcome as u64);
            self.bits(summary.n_steps);
            self.numbers(&[summary.time]);
            self.numbers(&summary.state);
        }
    }
}

/// Fixed numbers of modest size, from products and remainders alone.
fn numbers(count: usize, first: usize) -> Vec<f64> {
    (first..first + count).map(|k| 0.8 * (1.0 - 2.0 * ((k as f64 * 0.618_033_988_75) % 1.0))).collect()
}

/// The hashes so far, with the names of what they stand for.
struct Hashes {
    simd: Simd,
    lines: Vec<(String, u64)>,
}

impl Hashes {
    fn add(&mut self, name: &str, fill: impl FnOnce(&mut Hash)) {
        let mut hash = Hash::new();
        fill(&mut hash);
        self.lines.push((name.into(), hash.0));
    }

    /// Orbits with tangent vectors and, where the method has them, the series.
    fn orbits<F: Space, M: Method<F>>(&mut self, name: &str, field: &F, method: M, n_tangents: usize, t_end: f64) {
        let n = field.n_components();
        self.orbits_from(name, field, method, &numbers(n * TRAJECTORIES, 1), n_tangents, t_end);
    }

    fn orbits_from<F: Space, M: Method<F>>(
        &mut self,
        name: &str,
        field: &F,
        method: M,
        states: &[f64],
        n_tangents: usize,
        t_end: f64,
    ) {
        let tangents = numbers(states.len() * n_tangents, 1000);
        let times = [0.0, 0.3 * t_end, t_end];
        let ensemble = Ensemble { field, method, states, tangents: &tangents, n_tangents, times: &times };
        let found = orbits(&ensemble, 1, self.simd, &Control::default(), true, |_| ()).unwrap();
        self.add(name, |hash| {
            hash.numbers(&found.states);
            hash.numbers(&found.tangents);
            hash.summaries(&found.summaries);
            // equal steps are taken in batches, whose times depend on the neighbours; series do not
            for series in found.series.iter().filter(|series| !series.coefficients.is_empty()) {
                hash.numbers(&series.times);
                hash.numbers(&series.coefficients);
            }
        });
    }

    fn exponents<F: Space, M: Method<F>>(&mut self, name: &str, field: &F, method: M, t_end: f64) {
        let (states, tangents) =
            (numbers(field.n_components() * TRAJECTORIES, 1), numbers(field.n_components() * TRAJECTORIES, 1000));
        let times = [0.0, 0.3 * t_end, t_end];
        let ensemble = Ensemble { field, method, states: &states, tangents: &tangents, n_tangents: 1, times: &times };
        let found = finite_time_exponents(&ensemble, 1, self.simd, &Control::default(), |_| ()).unwrap();
        self.add(name, |hash| {
            hash.numbers(&found.exponents);
            hash.summaries(&found.summaries);
        });
    }

    /// Crossings of the surface on which the first component is 0.1.
    fn section<F: Bounds>(&mut self, name: &str, field: &F, t_end: f64)
    where
        Taylor: Method<F>,
    {
        let n = field.n_components();
        let plane = Instruction::Linear { terms: vec![(0, 1.0)], constant: -0.1 };
        let function = Functions::new(n, vec![plane], vec![n]).unwrap();
        let surface = Surface { function, kept: None, guard: None, direction: 0, n_crossings: None, sides: vec![] };
        let states = numbers(n * TRAJECTORIES, 1);
        let ensemble =
            Ensemble { field, method: taylor(), states: &states, tangents: &[], n_tangents: 0, times: &[0.0, t_end] };
        let found = sections(&ensemble, &surface, 1, self.simd, &Control::default(), |_| ()).unwrap();
        assert!(found.crossing_counts.iter().sum::<usize>() > TRAJECTORIES / 2, "{name}");
        self.add(name, |hash| {
            for points in [&found.crossings, &found.touches] {
                hash.numbers(&points.times);
                hash.numbers(&points.states);
            }
            found.crossing_counts.iter().for_each(|&count| hash.bits(count as u64));
            hash.numbers(&found.first_steps);
            hash.summaries(&found.summaries);
        });
    }
}

fn taylor() -> Taylor {
    Taylor::new(1e-13, None, MAX).unwrap()
}

/// The same top as a sparse tensor.
fn as_quadratic(p: &Parameters) -> Quadratic {
    let inverse = p.inertia.map(|moment| 1.0 / moment);
    let (mut linear, mut quadratic) = (vec![], vec![]);
    for i in 0..3 {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        for vector in [0, 3, 6] {
            quadratic.push((vector + i, vector + j, k, inverse[k]));
            quadratic.push((vector + i, vector + k, j, -inverse[j]));
        }
        for (vector, next, constant) in [(0, 3, p.a), (0, 6, p.b), (3, 6, p.a.map(|x| p.epsilon * x))] {
            linear.push((vector + i, next + j, constant[k]));
            linear.push((vector + i, next + k, -constant[j]));
        }
    }
    Quadratic::new(9, &[], &linear, &quadratic).unwrap()
}

/// `q' = p, p' = -q - f / 2`, where f is a function of q, or of 1 + q^2 in register 3.
fn driven(function: &str, argument: &[usize], number: &[f64]) -> Tape {
    let instruction =
        |name: &str, registers: &[usize], numbers: &[f64]| Instruction::from_parts(name, registers, numbers).unwrap();
    let list = vec![
        instruction("product", &[0, 0], &[]),
        instruction("linear", &[2], &[1.0, 1.0]),
        instruction("linear", &[0], &[0.2, 0.0]),
        instruction(function, argument, number),
        instruction("linear", &[0, 5], &[-1.0, -0.5, 0.0]),
    ];
    Tape::new(2, list, vec![1, 6]).unwrap()
}

/// A free rigid body with a cubic term: split terms that are functions of linear forms.
fn split_terms() -> SplitTerms {
    let bracket: Vec<(usize, usize, usize, f64)> =
        (0..3).flat_map(|i| [(i, (i + 1) % 3, (i + 2) % 3, -1.0), ((i + 1) % 3, i, (i + 2) % 3, 1.0)]).collect();
    let mut ridges: Vec<Ridge> =
        (0..3).map(|i| Ridge::of_bracket(&bracket, vec![(i, 1.0)], vec![0.0, 1.0 / GENERAL.inertia[i]])).collect();
    ridges.push(Ridge::of_bracket(&bracket, vec![(0, 0.5), (1, -0.4), (2, 0.3)], vec![0.1, 0.0, 0.7]));
    SplitTerms::new(3, ridges).unwrap()
}

/// A noise Hamiltonian.
fn split_term() -> SplitTerms {
    let generator = vec![(0, 1, 0.7), (1, 0, -0.7), (1, 2, 0.4), (2, 1, -0.4)];
    SplitTerms::new(3, vec![Ridge { form: vec![(0, 0.4), (2, 0.7)], generator, derivative: vec![0.8, 0.5] }]).unwrap()
}

/// Tops by every method.
fn tops(hashes: &mut Hashes) {
    let (kovalevskaya, general) = (TWISTED_KOVALEVSKAYA.top(), GENERAL.top());
    for n_tangents in 0..=2 {
        hashes.orbits(&format!("top, Taylor, {n_tangents} tangents"), &general, taylor(), n_tangents, 1.5);
        hashes.orbits(
            &format!("top, mixed Taylor, {n_tangents} tangents"),
            &general,
            MixedTaylor(taylor()),
            n_tangents,
            1.5,
        );
    }
    hashes.orbits_from("top, across components", &general, AcrossComponents(taylor()), &numbers(9, 1), 0, 10.0);
    hashes.exponents("top, Taylor, exponents", &kovalevskaya, taylor(), 8.0);
    hashes.exponents("top, mixed Taylor, exponents", &kovalevskaya, MixedTaylor(taylor()), 8.0);
    hashes.section("top, section", &kovalevskaya, 8.0);

    let mut failing = numbers(9 * TRAJECTORIES, 1);
    for (trajectory, value) in [(2, f64::NAN), (3, f64::INFINITY), (7, 1e200), (11, 0.0), (12, 1e-320), (18, 1e300)] {
        failing[9 * trajectory + 4] = value;
    }
    hashes.orbits_from("top, Taylor, failures", &general, taylor(), &failing, 1, 1.0);

    let (fixed, adaptive) = (RungeKutta::fixed(0.125, MAX).unwrap(), RungeKutta::new(1e-9, MAX).unwrap());
    let coarse = RungeKutta::new(1e-4, MAX).unwrap();
    hashes.orbits("top, Runge-Kutta, fixed", &general, fixed, 2, 2.0);
    hashes.orbits("top, Runge-Kutta, compensated", &general, fixed.compensated(), 2, 2.0);
    hashes.orbits("top, Runge-Kutta, adaptive", &general, adaptive, 2, 2.0);
    hashes.orbits("top, Runge-Kutta, single, fixed", &general, Single::<RungeKutta>::new(fixed).unwrap(), 1, 2.0);
    hashes.orbits("top, Runge-Kutta, single, adaptive", &general, Single::<RungeKutta>::new(coarse).unwrap(), 1, 2.0);
    hashes.exponents("top, Runge-Kutta, exponents", &kovalevskaya, adaptive, 5.0);

    let [i1, i2, i3] = GENERAL.inertia;
    let kinds = [[i1, i2, i3], [i1, i1, i1], [i1, i2, i2], [i1, i2, i1], [i1, i1, i3]];
    for (kind, inertia) in kinds.into_iter().enumerate() {
        let top = Parameters { inertia, ..GENERAL }.top();
        for order in [2, 4, 6, 8] {
            let method = Splitting::new(order, 0.2, MAX).unwrap();
            hashes.orbits(&format!("top of kind {kind}, splitting {order}"), &top, method, 1, 2.0);
        }
        let method = Single(Splitting::new(4, 0.2, MAX).unwrap());
        hashes.orbits(&format!("top of kind {kind}, splitting 4, single"), &top, method, 1, 2.0);
    }
    hashes.exponents("top, splitting, exponents", &kovalevskaya, Splitting::new(4, 0.2, MAX).unwrap(), 8.0);
    hashes.orbits("Lagrange top, discrete", &LAGRANGE.top(), LagrangeMap::new(0.1, MAX).unwrap(), 1, 2.0);
    for n_stages in 1..=4 {
        let method = Gauss::new(n_stages, 0.125, MAX).unwrap();
        hashes.orbits(&format!("top, Gauss, {n_stages} stages"), &general, method, 2, 1.0);
    }
}

/// Fields that are data.
fn fields(hashes: &mut Hashes) {
    let (fixed, adaptive) = (RungeKutta::fixed(0.125, MAX).unwrap(), RungeKutta::new(1e-9, MAX).unwrap());
    let quadratic = as_quadratic(&GENERAL);
    for n_tangents in 0..=2 {
        hashes.orbits(&format!("quadratic, Taylor, {n_tangents} tangents"), &quadratic, taylor(), n_tangents, 1.5);
    }
    hashes.orbits("quadratic, Runge-Kutta, fixed", &quadratic, fixed, 1, 1.0);
    hashes.orbits("quadratic, Runge-Kutta, adaptive", &quadratic, adaptive, 1, 1.0);
    hashes.section("quadratic, section", &quadratic, 8.0);
    let path = Path { key: [1, 2], first: 3, n_before: 4, n_increments: 3 };
    let noise = Noise::new(vec![split_term(), split_term()], Some((split_terms(), 0.5)), path).unwrap();
    let shaken = Noisy::new(split_terms(), noise).unwrap();
    hashes.orbits("pieces with noise, splitting 4", &shaken, Splitting::new(4, 0.2, MAX).unwrap(), 1, 4.0);
    for order in [2, 4, 6, 8] {
        hashes.orbits(
            &format!("pieces, splitting {order}"),
            &split_terms(),
            Splitting::new(order, 0.2, MAX).unwrap(),
            1,
            4.0,
        );
    }

    let functions: [(&str, &[usize], &[f64]); 16] = [
        ("linear", &[0, 1], &[0.3, -0.1, 0.2]),
        ("product", &[0, 2], &[]),
        ("quotient", &[0, 3], &[]),
        ("power", &[0], &[3.0]),
        ("power", &[3], &[-1.3]),
        ("sqrt", &[3], &[]),
        ("exp", &[0], &[]),
        ("log", &[3], &[]),
        ("sin", &[0], &[]),
        ("cos", &[0], &[]),
        ("sinh", &[0], &[]),
        ("cosh", &[0], &[]),
        ("tanh", &[0], &[]),
        ("asin", &[4], &[]),
        ("acos", &[4], &[]),
        ("atan", &[0], &[]),
    ];
    for (name, argument, number) in functions {
        let tape = driven(name, argument, number);
        hashes.orbits(&format!("tape, {name} of {argument:?}, {number:?}"), &tape, taylor(), 1, 1.0);
    }
    let pendulum = driven("sin", &[0], &[]);
    // angles and exponents beyond those that the polynomials are for
    let (mut far, few) = (numbers(2 * TRAJECTORIES, 1), Taylor::new(1e-13, None, 5).unwrap());
    (0..TRAJECTORIES).for_each(|trajectory| far[2 * trajectory] *= 1e10);
    hashes.orbits_from("tape, sin of large angles", &pendulum, few, &far, 1, 1e-3);
    far.iter_mut().step_by(2).for_each(|x| *x *= 8.8e-8);
    hashes.orbits_from("tape, exp of large numbers", &driven("exp", &[0], &[]), few, &far, 1, 1e-3);
    hashes.orbits("tape, Runge-Kutta, fixed", &pendulum, fixed, 1, 1.0);
    hashes.orbits("tape, Runge-Kutta, adaptive", &pendulum, adaptive, 1, 1.0);
    hashes.orbits("tape, Gauss", &pendulum, Gauss::new(2, 0.125, MAX).unwrap(), 1, 1.0);
    hashes.section("tape, section", &pendulum, 8.0);
}

/// Frames, and enclosures, which no register is for.
fn others(hashes: &mut Hashes) {
    let (mut matrix, mut triangle) = (numbers(63, 1), vec![0.0; 49]);
    orthonormalise(hashes.simd, &mut matrix, 9, 7, &mut triangle);
    hashes.add("frame", |hash| {
        hash.numbers(&matrix);
        hash.numbers(&triangle);
    });

    let number = |text: &str| Rational::parse(text).unwrap();
    let lorenz: [&[(&str, &[usize])]; 3] = [
        &[("-10", &[0]), ("10", &[1])],
        &[("28", &[0]), ("-1", &[1]), ("-1", &[0, 2])],
        &[("-8/3", &[2]), ("1", &[0, 1])],
    ];
    let polynomial = |terms: &&[(&str, &[usize])]| {
        Polynomial::new(3, terms.iter().map(|&(c, factors)| (number(c), factors.to_vec()))).unwrap()
    };
    let field: Vec<Polynomial> = lorenz.iter().map(polynomial).collect();
    let start = StateSet::from_box(&[1.0, 1.0, 20.0].map(|x| Interval::ball(x, 1e-6)));
    let mut bundle = Bundle::new(vec![start], Matrix::identity(3));
    let mut flow = Flow::new(Program::new(3, &field), Options::default());
    flow.advance(&mut bundle, 0.2, &Control::default(), |_| ()).unwrap();
    hashes.add("enclosure of a flow", |hash| {
        for bound in bundle.states[0].hull().iter().chain(bundle.derivative.hull().entries()) {
            hash.numbers(&[bound.lo(), bound.hi()]);
        }
    });
}

fn text(simd: Simd) -> String {
    let mut hashes = Hashes { simd, lines: vec![] };
    tops(&mut hashes);
    fields(&mut hashes);
    others(&mut hashes);
    hashes.lines.iter().fold(String::new(), |mut text, (name, hash)| {
        writeln!(text, "{hash:016x} {name}").unwrap();
        text
    })
}

#[test]
fn results_have_the_recorded_bits_on_every_processor() {
    if std::env::var_os("LIEPOISSON_RECORD_BITS").is_some() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/core/same_bits.txt");
        std::fs::write(file, text(Simd::widest())).unwrap();
        return;
    }
    let recorded = include_str!("same_bits.txt");
    for simd in Simd::ALL.into_iter().filter(|simd| simd.is_available()) {
        let found = text(simd);
        let different: Vec<&str> = found.lines().filter(|line| !recorded.lines().any(|one| one == *line)).collect();
        assert!(different.is_empty(), "{}: other bits than in same_bits.txt:\n{}", simd.name(), different.join("\n"));
        assert_eq!(found.lines().count(), recorded.lines().count());
    }
}
