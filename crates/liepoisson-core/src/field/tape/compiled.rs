//! Expansions of a field, and straight code that asks for its rates, as compiled code: made when a run turns out to be long, once for
//! all threads.

use super::Tape;
use super::elementary::Called;
use super::frame::Frame;
use crate::field::{Field, Straight};
use crate::jit::{self, Asked, Code, Functions, Source};
use crate::lanes::recorded::Recorded;
use crate::lanes::{Instructions, Lane, Simd};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

/// Runs after which code is compiled: what compiling takes, over what it saves in each. Both grow with the tape and the order, so
/// that one number does: of a double pendulum with a tangent vector 2 ms over 4.3 us at order 21, 1.7 ms over 3.4 us at order 15, and
/// 0.13 ms over 0.3 us for rates, in registers of AVX2 and AVX-512 alike. A run then takes at most twice as long as it would, had its
/// length been known.
const WORTH_IT: u64 = 500;

/// Runs after which code for the same operations with other constants is looked for, as of another value of a parameter: what that takes,
/// 0.65 ms for the series of a double pendulum, over what code saves in each run, 4 to 12 us. Where so many tapes have asked in vain
/// that these runs add up to [`WORTH_IT`], it is compiled.
const WORTH_A_LOOK: u64 = 100;

/// Instructions of a tape, for the state and each tangent vector and order, that are compiled at most: what is recorded of them takes some
/// 100 MB.
const MOST_WORK: usize = 1 << 17;

/// Code of a field for each kind of registers and purpose.
#[derive(Debug, Default)]
pub(in crate::field) struct Compiled(OnceLock<Box<Plan>>);

/// What tells code from other code for the same tape: its registers, what it does, and on how much memory, as one number each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Key {
    purpose: u64,
    registers: usize,
}

impl Key {
    /// The series up to an order, with so many tangent vectors.
    #[inline(always)]
    fn series(instructions: Instructions, n_tangents: usize, order: usize, registers: usize) -> Key {
        Key { purpose: (n_tangents as u64) << 16 | (order as u64) << 3 | instructions as u64, registers }
    }

    /// Straight code with a key of its own.
    #[inline(always)]
    fn straight(instructions: Instructions, key: u64, registers: usize) -> Key {
        Key { purpose: key << 3 | 4 | instructions as u64, registers }
    }
}

/// A field whose expansion is compiled.
pub(in crate::field) trait Expanded: Field {
    /// Instructions that its rates take.
    fn work(&self) -> usize;

    /// Whether an order of a series of so many is one piece of code with the order before.
    fn is_second(&self, _k: usize, _n_orders: usize) -> bool {
        false
    }

    /// So many registers are kept to the end; others as far as a later order reads them.
    fn n_kept(&self, n_tangents: usize, order: usize) -> usize;
}

impl Expanded for Tape {
    fn work(&self) -> usize {
        self.instructions.len()
    }

    /// Its sums are formed along with those of the order before.
    fn is_second(&self, k: usize, n_orders: usize) -> bool {
        Frame::is_second(k, n_orders)
    }

    /// Series are kept up to the last order, so that it shares code.
    fn n_kept(&self, n_tangents: usize, order: usize) -> usize {
        let n_series = self.program.state.series + n_tangents * self.program.tangent.series;
        (self.row(n_tangents) + n_series) * (order + 1)
    }
}

#[derive(Debug)]
struct Plan {
    key: Key,
    /// How often it was asked for.
    runs: AtomicU64,
    /// None inside where it cannot be compiled.
    code: OnceLock<Option<Code>>,
    next: Compiled,
}

impl Compiled {
    /// Expands a field up to `order`, as [`Field::expand`] does, if the code for that is there. False, and nothing, if not.
    #[inline(always)]
    pub(in crate::field) fn expand<V: Lane>(
        &self,
        field: &impl Expanded,
        rows: &mut [V],
        n_tangents: usize,
        order: usize,
    ) -> bool {
        let Some(instructions) = V::INSTRUCTIONS else { return false };
        let key = Key::series(instructions, n_tangents, order, rows.len());
        self.run_for(key, rows, |stage| compile_series::<V>(field, n_tangents, order, key.registers, stage))
    }

    /// Runs straight code: [`Field::run_compiled`], of a field whose rates take so many instructions.
    #[inline(always)]
    pub(in crate::field) fn run<V: Lane>(
        &self,
        field: &impl Expanded,
        straight: &impl Straight,
        memory: &mut [V],
    ) -> bool {
        let Some(instructions) = V::INSTRUCTIONS else { return false };
        let key = Key::straight(instructions, straight.key(), memory.len());
        self.run_for(key, memory, |stage| compile_straight::<V>(field.work(), straight, key.registers, stage))
    }

    #[inline(always)]
    fn run_for<V: Lane>(&self, key: Key, memory: &mut [V], compile: impl FnOnce(Stage) -> Option<Code>) -> bool {
        let plan = self.plan(key);
        if let Some(code) = plan.code.get() {
            code.as_ref().is_some_and(|code| code.run(memory))
        } else {
            plan.count::<V>(compile);
            false
        }
    }

    /// The name of an instruction set, or that of code compiled for it, if there is some.
    pub(in crate::field) fn kernel(&self, simd: Simd) -> &'static str {
        match simd {
            Simd::Avx512 if self.has_code(Instructions::Evex) => "avx512, compiled",
            Simd::Avx2 if self.has_code(Instructions::Vex) => "avx2, compiled",
            Simd::Scalar if self.has_code(Instructions::VexOne) => "scalar, compiled",
            _ => simd.name(),
        }
    }

    /// Whether there is code for these instructions.
    fn has_code(&self, instructions: Instructions) -> bool {
        self.0.get().is_some_and(|plan| {
            let is_compiled = plan.code.get().is_some_and(Option::is_some);
            (plan.key.purpose & 3 == instructions as u64 && is_compiled) || plan.next.has_code(instructions)
        })
    }

    #[inline(always)]
    fn plan(&self, key: Key) -> &Plan {
        let make = || Box::new(Plan { key, runs: AtomicU64::new(0), code: OnceLock::new(), next: Compiled::default() });
        let mut plan = self.0.get_or_init(make);
        while plan.key != key {
            plan = plan.next.0.get_or_init(make);
        }
        plan
    }
}

impl Plan {
    /// Counts a run by other means, and compiles if they were many.
    #[inline(never)]
    fn count<V: Lane>(&self, compile: impl FnOnce(Stage) -> Option<Code>) {
        match self.runs.fetch_add(1, Ordering::Relaxed) {
            WORTH_A_LOOK if is_wanted() => {
                let stage = match jit::asked::<V>(self.key.registers) {
                    Asked::Known => Stage::Look,
                    Asked::Unknown { times } if times * WORTH_A_LOOK >= WORTH_IT => Stage::Compile,
                    Asked::Unknown { .. } => return,
                };
                if let Some(code) = compile(stage) {
                    self.code.get_or_init(|| Some(code));
                }
            }
            WORTH_IT => {
                self.code.get_or_init(|| if is_wanted() { compile(Stage::Compile) } else { None });
            }
            _ => {}
        }
    }
}

/// How much is done for code.
#[derive(Clone, Copy)]
enum Stage {
    /// It is looked for among what was compiled for tapes that differ in their constants alone.
    Look,
    /// What is not found there is compiled.
    Compile,
}

impl Stage {
    fn make<V: Lane>(self, registers: usize, sources: Vec<Source>, is_wanted: impl Fn(usize) -> bool) -> Option<Code> {
        match self {
            Stage::Look => Code::known::<V, Elementary>(registers, sources, is_wanted),
            Stage::Compile => Code::new::<V, Elementary>(registers, sources, is_wanted),
        }
    }
}

fn compile_series<V: Lane>(
    field: &impl Expanded,
    n_tangents: usize,
    order: usize,
    registers: usize,
    stage: Stage,
) -> Option<Code> {
    if field.work() * (1 + n_tangents) * order > MOST_WORK {
        return None;
    }
    let is_second = |k: usize| k < order && field.is_second(k, order + 1);
    let source = |k: usize| Source {
        trace: Recorded::trace(registers, |rows| {
            for k in k..=k + usize::from(is_second(k + 1)) {
                field.derive_work(rows, n_tangents, k);
                field.extend(rows, n_tangents, k);
            }
        }),
        k,
        bases: [k, k / 2, k * field.row(n_tangents)],
    };
    let sources: Vec<Source> = (0..order).filter(|&k| !is_second(k)).map(source).collect();
    let n_kept = field.n_kept(n_tangents, order);
    stage.make::<V>(registers, sources, |register| register < n_kept)
}

fn compile_straight<V: Lane>(work: usize, straight: &impl Straight, registers: usize, stage: Stage) -> Option<Code> {
    if work * straight.n_rates() > MOST_WORK {
        return None;
    }
    let trace = Recorded::trace(registers, |memory| straight.run(memory));
    stage.make::<V>(registers, vec![Source { trace, k: 0, bases: [0; 3] }], |_| true)
}

/// Whether the environment variable `LIEPOISSON_JIT` is anything but `0`.
fn is_wanted() -> bool {
    std::env::var_os("LIEPOISSON_JIT").is_none_or(|value| value != "0")
}

/// The elementary functions of tapes.
struct Elementary;

impl Functions for Elementary {
    #[inline(always)]
    fn compute<V: Lane>(function: [u64; 2], x: V) -> [V; 2] {
        Called::from_code(function).compute(x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::tape::enclosure::enclose;
    use crate::field::{Instruction, Quadratic, Space};
    use crate::lanes::{Task, Wide, as_scalars, as_scalars_mut, dispatch};
    use proptest::prelude::*;

    /// Expands by both executors, and compares all coefficients.
    struct Both<'t> {
        tape: &'t Tape,
        n_tangents: usize,
        order: usize,
        starts: &'t [f64],
    }

    impl Task for Both<'_> {
        type Output = ();

        fn run<V: Wide>(self) {
            let Both { tape, n_tangents, order, starts } = self;
            if V::INSTRUCTIONS.is_none() {
                return;
            }
            let registers = tape.registers(n_tangents, order);
            let mut rows = vec![V::splat(f64::NAN); registers];
            let row = tape.row(n_tangents);
            let mut numbers = starts.iter().cycle();
            as_scalars_mut(&mut rows[..row]).fill_with(|| *numbers.next().unwrap());
            let mut compiled = rows.clone();
            for k in 0..order {
                tape.derive_work(&mut rows, n_tangents, k);
                tape.extend(&mut rows, n_tangents, k);
            }
            let code = compile_series::<V>(tape, n_tangents, order, registers, Stage::Compile)
                .expect("a tape that can be compiled");
            if !code.run(&mut compiled) {
                // an angle or an exponent that is too large for the code
                assert!((0..V::WIDTH).any(|lane| is_large(tape, |i| compiled[i].get(lane))));
                return;
            }
            let numbers = as_scalars(&rows).iter().zip(as_scalars(&compiled));
            let (n_orders, program) = (order + 1, &tape.program);
            let n_series = program.state.series + n_tangents * program.tangent.series;
            for (i, (x, y)) in numbers.enumerate() {
                let work = (i / V::WIDTH).checked_sub(n_orders * row);
                if work.is_some_and(|at| at / n_orders >= n_series || at % n_orders == order) {
                    continue;
                }
                let at = (i / V::WIDTH / row, i / V::WIDTH % row, i % V::WIDTH, i / V::WIDTH < (order + 1) * row);
                assert!(x.to_bits() == y.to_bits() || x.is_nan() && y.is_nan(), "{x} {y} at {at:?}");
            }
        }
    }

    /// Whether a register of the tape is beyond what exponentials are compiled for.
    fn is_large(tape: &Tape, component: impl Fn(usize) -> f64) -> bool {
        let state: Vec<f64> = (0..tape.n_components()).map(component).collect();
        let mut found = vec![];
        enclose(&tape.instructions, &state, |_| (0.0, 0.0), f64::EPSILON.into(), &mut found);
        found.iter().any(|register| register.value.is_nan() || register.value.abs() > 700.0)
    }

    /// Two steps of the midpoint rule, the first register of the memory after the values being the size of the step.
    struct Midpoints<'t, F> {
        field: &'t F,
        n_tangents: usize,
    }

    impl<F: Field> Straight for Midpoints<'_, F> {
        fn key(&self) -> u64 {
            self.n_tangents as u64
        }

        fn n_rates(&self) -> usize {
            4
        }

        fn run<V: Lane>(&self, memory: &mut [V]) {
            let Midpoints { field, n_tangents } = *self;
            let row = field.n_components() * (1 + n_tangents);
            let mut rates = vec![V::splat(0.0); row];
            let mut work = vec![V::splat(0.0); field.registers(n_tangents, 1)];
            let (values, rest) = memory.split_at_mut(row);
            for _ in 0..2 {
                let mut x = values.to_vec();
                field.rates(&x, n_tangents, &mut work, &mut rates);
                for i in 0..row {
                    x[i] = rates[i].mul_add(rest[0].mul(V::splat(0.5)), values[i]);
                }
                field.rates(&x, n_tangents, &mut work, &mut rates);
                for i in 0..row {
                    values[i] = rates[i].mul_add(rest[0], values[i]);
                }
            }
        }
    }

    /// Two steps by both executors, with the same bits.
    struct BothStraight<'t, F>(Midpoints<'t, F>, &'t [f64]);

    impl<F: Field> Task for BothStraight<'_, F> {
        type Output = ();

        fn run<V: Wide>(self) {
            let BothStraight(straight, starts) = self;
            if V::INSTRUCTIONS.is_none() {
                return;
            }
            let row = straight.field.n_components() * (1 + straight.n_tangents);
            let mut memory = vec![V::splat(1.0 / 64.0); row + 1];
            let mut numbers = starts.iter().cycle();
            as_scalars_mut(&mut memory[..row]).fill_with(|| *numbers.next().unwrap());
            let mut compiled = memory.clone();
            straight.run(&mut memory);
            let code =
                compile_straight::<V>(1, &straight, row + 1, Stage::Compile).expect("a field that can be compiled");
            if code.run(&mut compiled) {
                for (i, (x, y)) in as_scalars(&memory).iter().zip(as_scalars(&compiled)).enumerate() {
                    let (register, lane) = (i / V::WIDTH, i % V::WIDTH);
                    assert!(x.to_bits() == y.to_bits() || x.is_nan() && y.is_nan(), "{x} {y} at {register}, {lane}");
                }
            }
        }
    }

    fn compare(tape: &Tape, n_tangents: usize, order: usize, starts: &[f64]) {
        for simd in [Simd::Scalar, Simd::Avx2, Simd::Avx512] {
            dispatch(simd, Both { tape, n_tangents, order, starts });
            dispatch(simd, BothStraight(Midpoints { field: tape, n_tangents }, starts));
        }
    }

    /// One instruction of a kind, with what it reads chosen by numbers.
    fn instruction(kind: usize, [a, b, c]: [usize; 3], number: f64) -> Instruction {
        match kind {
            0 => Instruction::Linear { terms: vec![(a, number), (b, -0.5), (c, 1.0)], constant: 0.0 },
            1 => Instruction::Linear { terms: vec![(a, 2.0), (b, number)], constant: number },
            2 | 3 => Instruction::Product(a, b),
            4 => Instruction::Product(a, a),
            5 | 6 => Instruction::Quotient(a, b),
            7 => Instruction::Power(a, number),
            8 => Instruction::Power(a, -2.0),
            9 => Instruction::Sqrt(a),
            10 => Instruction::Exp(a),
            11 => Instruction::Log(a),
            12 => Instruction::Sin(a),
            13 => Instruction::Cos(b),
            14 => Instruction::Sinh(a),
            15 => Instruction::Cosh(a),
            16 => Instruction::Tanh(a),
            17 => Instruction::Asin(a),
            18 => Instruction::Acos(a),
            _ => Instruction::Atan(a),
        }
    }

    prop_compose! {
        fn any_tape()(
            n in 1..5_usize,
            parts in proptest::collection::vec((0..20_usize, any::<[u16; 3]>(), -2.0..2.0_f64), 1..14),
            outputs in any::<[u16; 5]>(),
        ) -> Tape {
            let instructions: Vec<Instruction> = parts
                .iter()
                .enumerate()
                .map(|(i, &(kind, reads, number))| instruction(kind, reads.map(|at| at as usize % (n + i)), number))
                .collect();
            let available = n + instructions.len();
            // the last instructions rather than the components
            let outputs = outputs[..n].iter().map(|&at| available - 1 - at as usize % (available.min(6))).collect();
            Tape::new(n, instructions, outputs).unwrap()
        }
    }

    /// The same of a field of degree two, all of whose registers are components.
    struct BothOfDegreeTwo<'f> {
        field: &'f Quadratic,
        n_tangents: usize,
        order: usize,
        starts: &'f [f64],
    }

    impl Task for BothOfDegreeTwo<'_> {
        type Output = ();

        fn run<V: Wide>(self) {
            let BothOfDegreeTwo { field, n_tangents, order, starts } = self;
            if V::INSTRUCTIONS.is_none() {
                return;
            }
            let (registers, row, group) = (field.registers(n_tangents, order), field.row(n_tangents), field.group());
            let mut rows = vec![V::splat(0.0); registers];
            let mut numbers = starts.iter().cycle();
            for first in (0..row).step_by(group) {
                let components = &mut rows[first..first + field.n_components()];
                as_scalars_mut(components).fill_with(|| *numbers.next().unwrap());
            }
            let mut compiled = rows.clone();
            (0..order).for_each(|k| field.extend(&mut rows, n_tangents, k));
            let code = compile_series::<V>(field, n_tangents, order, registers, Stage::Compile)
                .expect("a field that can be compiled");
            assert!(code.run(&mut compiled));
            for (i, (x, y)) in as_scalars(&rows).iter().zip(as_scalars(&compiled)).enumerate() {
                let at = (i / V::WIDTH / row, i / V::WIDTH % row, i % V::WIDTH);
                assert!(x.to_bits() == y.to_bits() || x.is_nan() && y.is_nan(), "{x} {y} at {at:?}");
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(100))]

        #[test]
        fn compiled_series_of_degree_two_have_the_bits_of_the_kernels(
            n in 1..10_usize,
            parts in proptest::collection::vec((any::<[u16; 3]>(), prop_oneof![3 => -2.0..2.0_f64, 1 => Just(1.0), 1 => Just(-4.0)]), 1..60),
            n_tangents in 0..4_usize,
            order in 1..30_usize,
            starts in proptest::collection::vec(
                prop_oneof![8 => -1.5..1.5_f64, 1 => Just(0.0), 1 => Just(-0.0), 1 => Just(1e300), 1 => Just(f64::NAN)], 1..40
            ),
        ) {
            let at = |indices: &[u16; 3], i: usize| indices[i] as usize % n;
            let linear: Vec<_> = parts.iter().step_by(3).map(|(on, c)| (at(on, 0), at(on, 1), *c)).collect();
            let quadratic: Vec<_> = parts.iter().map(|(on, c)| (at(on, 0), at(on, 1), at(on, 2), *c)).collect();
            let field = Quadratic::new(n, &[(0, 0.5)], &linear, &quadratic).unwrap();
            for simd in [Simd::Scalar, Simd::Avx2, Simd::Avx512] {
                dispatch(simd, BothOfDegreeTwo { field: &field, n_tangents, order, starts: &starts });
            }
        }

        #[test]
        fn compiled_rates_of_degree_two_have_the_bits_of_the_kernels(
            n in 1..8_usize,
            parts in proptest::collection::vec((any::<[u16; 3]>(), prop_oneof![3 => -2.0..2.0_f64, 1 => Just(1.0), 1 => Just(-1.0)]), 1..30),
            n_tangents in 0..3_usize,
            starts in proptest::collection::vec(
                prop_oneof![8 => -1.5..1.5_f64, 1 => Just(0.0), 1 => Just(-0.0), 1 => Just(1e300), 1 => Just(f64::NAN)], 1..40
            ),
        ) {
            let at = |indices: &[u16; 3], i: usize| indices[i] as usize % n;
            let linear: Vec<_> = parts.iter().step_by(3).map(|(on, c)| (at(on, 0), at(on, 1), *c)).collect();
            let quadratic: Vec<_> = parts.iter().map(|(on, c)| (at(on, 0), at(on, 1), at(on, 2), *c)).collect();
            let field = Quadratic::new(n, &[(0, 0.5)], &linear, &quadratic).unwrap();
            for simd in [Simd::Scalar, Simd::Avx2, Simd::Avx512] {
                dispatch(simd, BothStraight(Midpoints { field: &field, n_tangents }, &starts));
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(300))]

        #[test]
        fn compiled_code_has_the_bits_of_the_kernels(
            tape in any_tape(),
            n_tangents in 0..4_usize,
            order in 1..30_usize,
            starts in proptest::collection::vec(
                prop_oneof![8 => -1.5..1.5_f64, 1 => Just(0.0), 1 => Just(-0.0), 1 => Just(1.0), 1 => Just(1e300), 1 => Just(-3e9), 1 => Just(f64::NAN), 1 => Just(f64::INFINITY)],
                1..40
            ),
        ) {
            prop_assert!(tape.n_components() > 0);
            compare(&tape, n_tangents, order, &starts);
        }
    }
}
