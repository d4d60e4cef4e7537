//! Expansions of a tape as compiled code: made when a run turns out to be long, once for all threads.

use super::Tape;
use super::elementary::Called;
use crate::field::Field;
use crate::jit::{Code, Functions, Source};
use crate::lanes::recorded::Recorded;
use crate::lanes::{Instructions, Lane};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

/// Expansions after which they are compiled: what compiling takes, over what it saves in each. Both grow with the tape and the order, so
/// that one number does: of a double pendulum with a tangent vector 2 ms over 4.3 us at order 21, 1.7 ms over 3.4 us at order 15, and
/// 0.13 ms over 0.3 us for the rates of a Runge-Kutta method, in registers of AVX2 and AVX-512 alike. A run then takes at most twice as
/// long as it would, had its length been known.
const WORTH_IT: u64 = 500;

/// Instructions of a tape, for the state and each tangent vector and order, that are compiled at most: what is recorded of them takes some
/// 100 MB.
const MOST_WORK: usize = 1 << 17;

/// Code of a tape for each kind of registers, number of tangent vectors and order that it is expanded to.
#[derive(Debug, Default)]
pub(super) struct Compiled(OnceLock<Box<Plan>>);

#[derive(Debug)]
struct Plan {
    instructions: Instructions,
    n_tangents: usize,
    order: usize,
    registers: usize,
    /// How often it was asked for.
    runs: AtomicU64,
    /// None inside where it cannot be compiled.
    code: OnceLock<Option<Code>>,
    next: Compiled,
}

impl Compiled {
    /// Expands a tape up to `order`, as [`Field::expand`] does, if the code for that is there. False, and nothing, if not.
    #[inline(always)]
    pub(super) fn expand<V: Lane>(&self, tape: &Tape, rows: &mut [V], n_tangents: usize, order: usize) -> bool {
        let Some(instructions) = V::INSTRUCTIONS else { return false };
        let plan = self.plan(instructions, n_tangents, order, rows.len());
        if let Some(code) = plan.code.get() {
            code.as_ref().is_some_and(|code| code.run(rows))
        } else {
            plan.count::<V>(tape);
            false
        }
    }

    /// Whether there is code for these instructions.
    pub(super) fn has_code(&self, instructions: Instructions) -> bool {
        self.0.get().is_some_and(|plan| {
            let is_compiled = plan.code.get().is_some_and(Option::is_some);
            (plan.instructions == instructions && is_compiled) || plan.next.has_code(instructions)
        })
    }

    fn plan(&self, instructions: Instructions, n_tangents: usize, order: usize, registers: usize) -> &Plan {
        let make = || {
            let (runs, code, next) = (AtomicU64::new(0), OnceLock::new(), Compiled::default());
            Box::new(Plan { instructions, n_tangents, order, registers, runs, code, next })
        };
        let mut plan = self.0.get_or_init(make);
        while (plan.instructions, plan.n_tangents, plan.order, plan.registers)
            != (instructions, n_tangents, order, registers)
        {
            plan = plan.next.0.get_or_init(make);
        }
        plan
    }
}

impl Plan {
    /// Counts an expansion by other means, and compiles if they were many.
    #[inline(never)]
    fn count<V: Lane>(&self, tape: &Tape) {
        if self.runs.fetch_add(1, Ordering::Relaxed) == WORTH_IT {
            self.code.get_or_init(|| if is_wanted() { self.compile::<V>(tape) } else { None });
        }
    }

    fn compile<V: Lane>(&self, tape: &Tape) -> Option<Code> {
        let Plan { n_tangents, order, registers, .. } = *self;
        if tape.instructions.len() * (1 + n_tangents) * order > MOST_WORK {
            return None;
        }
        let row = tape.row(n_tangents);
        let source = |k: usize| Source {
            recording: Recorded::record(registers, |rows| {
                tape.derive_work(rows, n_tangents, k);
                tape.extend(rows, n_tangents, k);
            }),
            k,
            bases: [k, k / 2, k * row],
        };
        // the rest of the memory matters as far as a later order reads it
        let (n_orders, work) = (order + 1, row * (order + 1));
        let in_branches = |register: usize| {
            register >= work && tape.program.branches.iter().any(|series| (register - work) / n_orders == *series)
        };
        let sources: Vec<Source> = (0..order).map(source).collect();
        Code::new::<V, Elementary>(registers, &sources, |register| register < work || in_branches(register))
    }
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
    use crate::field::{Instruction, Space};
    use crate::lanes::{Simd, Task, Wide, as_scalars, as_scalars_mut, dispatch};
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
            let Some(instructions) = V::INSTRUCTIONS else { return };
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
            let own = Compiled::default();
            let plan = own.plan(instructions, n_tangents, order, registers);
            let code = plan.compile::<V>(tape).expect("a tape that can be compiled");
            if !code.run(&mut compiled) {
                // an angle that is too large for the code
                assert!(starts.iter().any(|x| x.abs() > 1.0));
                return;
            }
            let numbers = as_scalars(&rows).iter().zip(as_scalars(&compiled));
            let n_orders = order + 1;
            for (i, (x, y)) in numbers.enumerate() {
                let work = (i / V::WIDTH).checked_sub(n_orders * row);
                if work.is_some_and(|at| !tape.program.branches.contains(&(at / n_orders)) || at % n_orders == order) {
                    continue;
                }
                let at = (i / V::WIDTH / row, i / V::WIDTH % row, i % V::WIDTH, i / V::WIDTH < (order + 1) * row);
                assert!(x.to_bits() == y.to_bits() || x.is_nan() && y.is_nan(), "{x} {y} at {at:?}");
            }
        }
    }

    fn compare(tape: &Tape, n_tangents: usize, order: usize, starts: &[f64]) {
        for simd in [Simd::Avx2, Simd::Avx512] {
            dispatch(simd, Both { tape, n_tangents, order, starts });
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
