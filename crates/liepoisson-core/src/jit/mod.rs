//! Code that is compiled when the program runs: on x86-64 under Linux, for AVX2, with four numbers in a register or one, and AVX-512.
//!
//! What is compiled is recorded from the code that runs otherwise ([`Recorded`]), so it has the same bits: there is no second formula.
//! Orders of a series that differ only in how far it has come share one piece of code ([`shape`]), in which sums of products are
//! loops: unrolled for all orders the code of a double pendulum would have some 100 KB, and the cache of instructions has 32. The code of
//! all orders calls the pieces in turn.
//!
//! The code is a function of integers that are compared with the size of the memory when it is made. Numbers of users are data, in
//! pages that are not executable; so code serves other numbers, too, such as those of another value of a parameter ([`known`]).

mod assembler;
mod constants;
mod emit;
mod known;
mod memory;
mod shape;

pub(crate) use known::{Asked, asked};
pub(crate) use memory::Functions;

use crate::lanes::recorded::{Recording, Trace};
use crate::lanes::{Instructions, Lane};
use assembler::Assembler;
use constants::Constants;
use emit::{Turn, emit, emit_turns, registers_of};
use known::Question;
use memory::Pages;
use shape::{Order, Shape, count_bases, reads};

/// What is recorded for one order of a series, or for a function.
#[derive(Debug)]
pub(crate) struct Source {
    pub(crate) trace: Trace,
    /// Number of the order.
    pub(crate) k: usize,
    /// Registers of the memory from which others are counted, beside the first.
    pub(crate) bases: [usize; 3],
}

/// Compiled code for some orders.
#[derive(Debug)]
pub(crate) struct Code {
    instructions: Instructions,
    /// Registers of the memory that it works on.
    registers: usize,
    pages: Pages,
    /// The first byte of the code that runs all orders.
    at: usize,
    /// The pieces of the orders: where each begins.
    #[cfg(test)]
    pieces: Vec<usize>,
}

impl Code {
    /// Code for registers `V` that does, order by order, what was recorded with memory of so many registers. What it leaves there is
    /// what another order reads or `is_wanted` names. None where it cannot be compiled, or where the system refuses memory for it.
    pub(crate) fn new<V: Lane, F: Functions>(
        registers: usize,
        sources: Vec<Source>,
        is_wanted: impl Fn(usize) -> bool,
    ) -> Option<Code> {
        let question = Question::new::<V, F>(registers, sources, is_wanted)?;
        let known = known::find(&question);
        let program = match known {
            Some(program) => program,
            None => {
                let program = compile(&question)?;
                known::keep(question, program.clone());
                program
            }
        };
        Code::of::<V>(registers, program)
    }

    /// The same, if it was compiled before, for whatever constants.
    pub(crate) fn known<V: Lane, F: Functions>(
        registers: usize,
        sources: Vec<Source>,
        is_wanted: impl Fn(usize) -> bool,
    ) -> Option<Code> {
        Code::of::<V>(registers, known::find(&Question::new::<V, F>(registers, sources, is_wanted)?)?)
    }

    fn of<V: Lane>(registers: usize, program: Program) -> Option<Code> {
        Some(Code {
            instructions: V::INSTRUCTIONS?,
            registers,
            pages: Pages::new(&program.numbers, &program.code)?,
            at: program.at,
            #[cfg(test)]
            pieces: program.pieces,
        })
    }

    /// Runs all orders in turn. False, and nothing that can be relied on, if a number is beyond the limits that the code is made for.
    ///
    /// # Panics
    /// Registers of another kind, or another number of them, than the code was compiled for.
    #[inline]
    pub(crate) fn run<V: Lane>(&self, memory: &mut [V]) -> bool {
        assert!(V::INSTRUCTIONS == Some(self.instructions) && memory.len() == self.registers, "code for other memory");
        // SAFETY: the code was compiled for these instructions, which a processor has that has such registers; `Shape::fits` has
        // compared all addresses of each order with the number of registers.
        unsafe { self.pages.run(self.at, memory.as_mut_ptr()) }
    }
}

/// Constants, code, and where it begins.
#[derive(Clone, Debug, PartialEq)]
struct Program {
    /// The numbers before the code, in whole pages.
    numbers: Vec<u64>,
    code: Vec<u8>,
    at: usize,
    /// The pieces of the orders: where each begins.
    pieces: Vec<usize>,
}

/// None where it cannot be compiled.
fn compile(question: &Question) -> Option<Program> {
    let &Question { instructions, registers, function, .. } = question;
    let mut recordings: Vec<Recording> = question.sources.iter().map(|source| source.trace.recording()).collect();
    recordings.iter_mut().for_each(|recording| recording.join_loops(registers_of(instructions).1));
    let mut is_kept = question.is_wanted.clone();
    for recording in &recordings {
        is_kept.iter_mut().zip(reads(recording)?).for_each(|(is_kept, is_read)| *is_kept |= is_read);
    }
    let mut shapes: Vec<Shape> = vec![];
    for (&Source { k, bases: [a, b, c], .. }, recording) in question.sources.iter().zip(&recordings) {
        let mut shape = Some(Shape::new(recording, Order { k, bases: [0, a, b, c] }, &is_kept)?);
        // the last shapes are the likely ones
        for known in shapes.iter_mut().rev() {
            shape = shape.and_then(|shape| known.merge(shape));
        }
        shapes.extend(shape);
    }
    let (mut assembler, mut constants) = (Assembler::new(instructions), Constants::new(instructions));
    let mut entries = vec![];
    for shape in &shapes {
        if !shape.fits(registers) {
            return None;
        }
        assembler.align();
        let at = assembler.code.len();
        emit(shape, &mut constants, function, &mut assembler)?;
        let starts = constants.end_piece(shape.orders.len());
        for (order, start) in shape.orders.iter().zip(starts) {
            let counts = constants.shared(&count_bases(order.k).map(|count| count as u64));
            entries.push((order, at, start, counts));
        }
    }
    entries.sort_by_key(|(order, ..)| order.k);
    let turn = |&(order, at, start, counts): &(&Order, usize, usize, i32)| Turn {
        at,
        bases: order.bases,
        constants: constants.place_of(start),
        counts,
    };
    let turns: Vec<Turn> = entries.iter().map(turn).collect();
    let at = emit_turns(&turns, &mut assembler)?;
    Some(Program {
        numbers: constants.into_numbers(),
        code: assembler.code,
        at,
        pieces: turns.iter().map(|turn| turn.at).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::recorded::Recorded;
    use crate::lanes::{Simd, Task, Wide, as_scalars, as_scalars_mut, dispatch};

    const REGISTERS: usize = 2000;

    /// No function.
    struct Nothing;

    impl Functions for Nothing {
        fn compute<V: Lane>(_: [u64; 2], x: V) -> [V; 2] {
            [x; 2]
        }
    }

    /// Addresses about those at which displacements become longer, from a fixed base and from moving ones, and more values at a time
    /// than there are registers.
    fn code<V: Lane>(memory: &mut [V], k: usize) {
        let at = |base: usize, more: isize| base.checked_add_signed(more).unwrap();
        let borders =
            [-130, -129, -128, -127, -126, -33, -32, -5, -4, -3, -1, 1, 3, 4, 5, 31, 32, 126, 127, 128, 129, 130];
        let mut sum = V::splat(k as f64);
        for more in borders {
            sum = memory[at(k, more)].mul_add(memory[at(k / 2 + 1000, more)], sum.mul(V::splat(0.5)));
        }
        for fixed in [0, 1, 3, 4, 5, 126, 127, 128, 129, 255, 256] {
            sum = sum.sub(memory[fixed].div(memory[at(3 * k, 3)]));
        }
        let products: Vec<V> = (0..50).map(|i| memory[i].mul(memory[i + 1])).collect();
        for i in 0..50 {
            memory[1700 + i] = products[i].add(products[49 - i].sqrt()).sub(products[i]);
        }
        memory[k] = sum;
        // what is read and then written, and what is moved
        memory.swap(1800, 1801);
    }

    struct Compare;

    impl Task for Compare {
        type Output = ();

        fn run<V: Wide>(self) {
            if V::INSTRUCTIONS.is_none() {
                return;
            }
            let orders = [500, 502, 503, 505];
            let sources = orders.map(|k| Source {
                trace: Recorded::trace(REGISTERS, |memory| code(memory, k)),
                k,
                bases: [k, k / 2, 3 * k],
            });
            let mut memory = vec![V::splat(0.0); REGISTERS];
            for (i, number) in as_scalars_mut(&mut memory).iter_mut().enumerate() {
                *number = if i % 7 == 0 && i < 50 * V::WIDTH { 0.0 } else { (i as f64 * 0.618).fract() + 0.25 };
            }
            let mut compiled = memory.clone();
            orders.iter().for_each(|&k| code(&mut memory, k));
            let made = Code::new::<V, Nothing>(REGISTERS, sources.into(), |_| true).unwrap();
            assert!(made.pieces.iter().all(|&at| at == made.pieces[0]), "one piece of code");
            assert!(made.run(&mut compiled));
            for (i, (x, y)) in as_scalars(&memory).iter().zip(as_scalars(&compiled)).enumerate() {
                assert!(x.to_bits() == y.to_bits(), "{x} {y} in register {}", i / V::WIDTH);
            }
            // other memory is refused
            assert!(std::panic::catch_unwind(|| made.run(&mut [V::splat(0.0); REGISTERS - 1])).is_err());
        }
    }

    #[test]
    fn compiled_code_does_what_was_recorded() {
        for simd in [Simd::Scalar, Simd::Avx2, Simd::Avx512] {
            dispatch(simd, Compare);
        }
    }

    #[test]
    fn a_loop_that_leaves_the_memory_is_not_compiled() {
        struct Compile(usize);
        impl Task for Compile {
            type Output = ();
            fn run<V: Wide>(self) {
                let trace = Recorded::trace(20, |memory| {
                    let mut sums = [Recorded::splat(0.0); 2];
                    Recorded::record_products(&mut sums, &[memory[10]], &[memory[9]], false, self.0);
                    memory[0] = sums[0];
                    memory[19] = sums[1];
                });
                let source = Source { trace, k: 9, bases: [9, 4, 9] };
                let is_compiled = Code::new::<V, Nothing>(20, vec![source], |_| true).is_some();
                assert_eq!(is_compiled, V::INSTRUCTIONS.is_some() && self.0 <= 9);
            }
        }
        // one more reads the register 0, which is read and written: it is late; two more leave the memory
        for count in [1, 8, 9, 10, 11] {
            dispatch(Simd::widest(), Compile(count));
        }
    }
}
