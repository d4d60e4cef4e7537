//! Code that is compiled when the program runs: on x86-64 under Linux, for AVX2 and AVX-512.
//!
//! What is compiled is recorded from the code that runs otherwise ([`Recorded`]), so it has the same bits: there is no second formula.
//! Orders of a series that differ only in how far it has come share one piece of code ([`shape`]), in which sums of products are
//! loops: unrolled for all orders the code of a double pendulum would have some 100 KB, and the cache of instructions has 32.
//!
//! The code is a function of integers that are compared with the size of the memory when it is made. Numbers of users are data, in
//! pages that are not executable.

mod assembler;
mod constants;
mod emit;
mod memory;
mod shape;

pub(crate) use memory::Functions;

use crate::lanes::recorded::Recording;
use crate::lanes::{Instructions, Lane};
use assembler::Assembler;
use constants::Constants;
use emit::{Arguments, emit};
use memory::{PAGE, Pages, caller};
use shape::{Order, Shape, count_bases};

/// What is recorded for one order of a series, or for a function.
pub(crate) struct Source {
    pub(crate) recording: Recording,
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
    orders: Vec<Entry>,
}

/// The piece that completes an order.
#[derive(Clone, Copy, Debug)]
struct Entry {
    /// Its first byte.
    at: usize,
    /// Its own constants.
    constants: usize,
    order: Order,
}

impl Code {
    /// Code for registers `V` that does, order by order, what was recorded with memory of so many registers, of which it writes those
    /// that `is_kept` names. None where it cannot be compiled, or where the system refuses memory for it.
    pub(crate) fn new<V: Lane, F: Functions>(
        registers: usize,
        sources: impl Iterator<Item = Source>,
        is_kept: impl Fn(usize) -> bool,
    ) -> Option<Code> {
        let instructions = V::INSTRUCTIONS?;
        let mut shapes: Vec<Shape> = vec![];
        for Source { recording, k, bases: [a, b, c] } in sources {
            let mut shape = Some(Shape::new(&recording, Order { k, bases: [0, a, b, c] }, &is_kept)?);
            // the last shapes are the likely ones
            for known in shapes.iter_mut().rev() {
                shape = shape.and_then(|shape| known.merge(shape).err());
            }
            shapes.extend(shape);
        }
        let (mut assembler, mut constants) = (Assembler::new(instructions), Constants::new(instructions));
        let mut orders = vec![];
        for shape in &shapes {
            if !shape.fits(registers) {
                return None;
            }
            assembler.align();
            let at = assembler.code.len();
            emit(shape, &mut constants, caller::<V, F>(), &mut assembler)?;
            let starts = constants.end_piece(shape.orders.len());
            orders.extend(shape.orders.iter().zip(starts).map(|(&order, constants)| Entry { at, constants, order }));
        }
        orders.sort_by_key(|entry| entry.order.k);
        let pages = Pages::new(&constants.into_numbers(PAGE / 8), &assembler.code)?;
        Some(Code { instructions, registers, pages, orders })
    }

    /// Runs all orders in turn.
    ///
    /// # Panics
    /// Registers of another kind, or another number of them, than the code was compiled for.
    #[inline]
    pub(crate) fn run<V: Lane>(&self, memory: &mut [V]) {
        assert!(V::INSTRUCTIONS == Some(self.instructions) && memory.len() == self.registers, "code for other memory");
        let start = memory.as_mut_ptr();
        for entry in &self.orders {
            let mut arguments = Arguments {
                bases: entry.order.bases.map(|base| start as usize + base * size_of::<V>()),
                constants: self.pages.constant(entry.constants),
                spilled: 0,
                counts: count_bases(entry.order.k),
            };
            // SAFETY: the code was compiled for these instructions, which a processor has that has such registers; `Shape::fits` has
            // compared all addresses of this order with the number of registers.
            unsafe { self.pages.run::<V>(entry.at, &mut arguments) };
        }
    }
}
