//! From a piece's operations to instructions: which value is in which register, and where it is otherwise.
//!
//! Values are computed in the order in which they were recorded. When registers are wanted, the one whose value is needed last is
//! given up; it is written to the spill memory if it is nowhere else.

mod products;
mod products_of_one;
mod registers;
mod sums;

use super::assembler::*;
use super::constants::Constants;
use super::shape::{Relative, Shape};
use crate::lanes::Instructions;
use crate::lanes::recorded::{Loop, Operation, Terms, Value};

/// The bases of addresses.
pub(super) const BASES: [General; 4] = [RDI, RSI, RDX, R8];
/// The constants that depend on the order.
pub(super) const CONSTANTS: General = RCX;
/// Memory for values that no register is left for.
pub(super) const SPILLED: General = R9;
/// What the lengths of loops are counted from.
pub(super) const COUNTS: General = RBX;
/// What a call may change and is needed after it; an odd number of them, so that the stack is as a call expects it.
const KEPT: [General; 7] = [RDI, RSI, RDX, R8, RCX, R9, R10];

/// A number whose lowest bits are those of the whole number that is added to it.
pub(super) const WHOLE: f64 = 6_755_399_441_055_744.0;
/// The bits of a number that are not its sign.
pub(super) const SIZE: u64 = i64::MAX as u64;

/// Registers of memory for values that no register is left for: a piece that needs more is not compiled.
pub(super) const MOST_SPILLED: usize = 256;

/// The code of a piece; none if it needs too much memory, or has addresses beyond 31 bits.
pub(super) fn emit(shape: &Shape, constants: &mut Constants, function: usize, assembler: &mut Assembler) -> Option<()> {
    let mut emitter = Emitter::new(shape, constants, function, assembler)?;
    emitter.run()?;
    (emitter.n_spilled <= MOST_SPILLED).then_some(())
}

/// The code that runs pieces in turn, each given where it begins, its bases, in registers after the first, its constants, and what the
/// lengths of its loops are counted from, these two in bytes from the start of the code. It is called with the addresses of the memory
/// and of that for spilled values; what it returns is zero unless a piece has left it. None where an address is beyond 31 bits.
pub(super) fn emit_turns(turns: &[Turn], assembler: &mut Assembler) -> Option<usize> {
    let (width, _) = registers_of(assembler.instructions);
    assembler.align();
    let start = assembler.code.len();
    assembler.push(COUNTS);
    assembler.address(SPILLED, RSI, 0);
    for turn in turns {
        for (register, base) in BASES[1..].iter().zip(&turn.bases[1..]) {
            assembler.address(*register, BASES[0], i32::try_from(base * width as usize).ok()?);
        }
        assembler.address_of_constant(CONSTANTS, turn.constants);
        assembler.address_of_constant(COUNTS, turn.counts);
        assembler.call(turn.at);
    }
    assembler.leave(0);
    Some(start)
}

/// Bytes that a register takes in memory, and how many registers there are.
pub(super) fn registers_of(instructions: Instructions) -> (i32, usize) {
    match instructions {
        Instructions::Vex => (32, 16),
        Instructions::Evex => (64, 32),
        Instructions::VexOne => (8, 16),
    }
}

/// What a piece of code is called with.
pub(super) struct Turn {
    pub(super) at: usize,
    pub(super) bases: [usize; 4],
    pub(super) constants: i32,
    pub(super) counts: i32,
}

/// A vector register's number.
type Register = u8;

struct Emitter<'a> {
    shape: &'a Shape,
    assembler: &'a mut Assembler,
    constants: &'a mut Constants,
    /// The address of the function that computes calls.
    function: usize,
    /// Bytes of a register.
    width: i32,
    /// Of each value the operations that use it, the last one first.
    uses: Vec<Vec<usize>>,
    register_of: Vec<Option<Register>>,
    /// Where else a value is.
    home: Vec<Option<Place>>,
    contents: Vec<Option<Value>>,
    is_pinned: Vec<bool>,
    n_spilled: usize,
    /// Where calls have their two registers in the spill memory, in bytes.
    called: Option<i32>,
    /// Places in the spill memory whose values are no longer needed.
    unused: Vec<Place>,
    /// The results of each loop and call, by their numbers.
    results: Vec<Vec<(usize, Value)>>,
    /// The stores of each value that are made at once.
    stores: Vec<Vec<Place>>,
    /// Jumps to where the code is left.
    exits: Vec<Jump>,
}

impl<'a> Emitter<'a> {
    fn new(
        shape: &'a Shape,
        constants: &'a mut Constants,
        function: usize,
        assembler: &'a mut Assembler,
    ) -> Option<Emitter<'a>> {
        let n = shape.operations.len();
        let (width, registers) = registers_of(assembler.instructions);
        let mut emitter = Emitter {
            shape,
            assembler,
            constants,
            function,
            width,
            uses: vec![vec![]; n],
            register_of: vec![None; n],
            home: vec![None; n],
            contents: vec![None; registers],
            is_pinned: vec![false; registers],
            n_spilled: 0,
            called: None,
            unused: vec![],
            results: vec![vec![]; n],
            stores: vec![vec![]; n],
            exits: vec![],
        };
        for store in shape.stores.iter().rev().filter(|store| store.is_late) {
            emitter.uses[store.value as usize].push(n);
        }
        for (at, &operation) in shape.operations.iter().enumerate().rev() {
            if let Operation::Loop(one) = operation {
                let Loop { sums, .. } = &shape.loops[one];
                sums.iter().for_each(|&sum| emitter.uses[sum as usize].push(at));
            }
            if let Operation::Result(of, number) = operation {
                emitter.results[of as usize].push((number, at as Value));
                continue;
            }
            operation.map(|value| {
                emitter.uses[value as usize].push(at);
                value
            });
        }
        for store in shape.stores.iter().filter(|store| !store.is_late) {
            let place = emitter.place(store.address())?;
            emitter.stores[store.value as usize].push(place);
        }
        for (at, &operation) in shape.operations.iter().enumerate() {
            match operation {
                Operation::Memory(number) => emitter.home[at] = Some(emitter.place(shape.address(number))?),
                Operation::Constant(number) => {
                    emitter.home[at] = Some(emitter.constants.place(&shape.columns[number as usize], CONSTANTS));
                }
                _ => {}
            }
        }
        Some(emitter)
    }

    fn place(&self, Relative { base, more }: Relative) -> Option<Place> {
        let bytes = i32::try_from(more).ok()?.checked_mul(self.width)?;
        // with room for the terms of a loop
        (bytes.abs() < i32::MAX / 2).then_some(())?;
        Some(Place::Memory(BASES[base], bytes))
    }

    fn run(&mut self) -> Option<()> {
        for at in 0..self.shape.operations.len() {
            // what is stored and not computed here
            let operation = self.shape.operations[at];
            if matches!(operation, Operation::Memory(_) | Operation::Constant(_)) && !self.stores[at].is_empty() {
                self.register(at as Value, 0);
                self.store(at as Value);
                self.give_up_unused(at as Value);
                self.is_pinned.fill(false);
            }
        }
        for at in 0..self.shape.operations.len() {
            self.operation(at)?;
            self.is_pinned.fill(false);
            self.pass(at);
        }
        let (shape, end) = (self.shape, self.shape.operations.len());
        for store in shape.stores.iter().filter(|store| store.is_late) {
            // where it is now may be overwritten by another such store
            if matches!(shape.operations[store.value as usize], Operation::Memory(_)) {
                let (register, place) = (self.register(store.value, end), self.spill_place());
                self.assembler.store(register, place);
                self.home[store.value as usize] = Some(place);
                self.is_pinned.fill(false);
            }
        }
        for store in shape.stores.iter().filter(|store| store.is_late) {
            let register = self.register(store.value, end);
            let to = self.place(store.address())?;
            self.assembler.store(register, to);
            self.is_pinned.fill(false);
        }
        self.assembler.give_back();
        if !self.exits.is_empty() {
            for exit in std::mem::take(&mut self.exits) {
                self.assembler.land(exit);
            }
            self.assembler.drop_return();
            self.assembler.leave(1);
        }
        Some(())
    }

    fn operation(&mut self, at: usize) -> Option<()> {
        let value = at as Value;
        match self.shape.operations[at] {
            Operation::Memory(_) | Operation::Constant(_) | Operation::Result(..) => return Some(()),
            Operation::Add(a, b) => self.binary(ADD, at, a, b),
            Operation::Sub(a, b) => self.binary(SUB, at, a, b),
            Operation::Mul(a, b) => self.binary(MUL, at, a, b),
            Operation::Div(a, b) => self.binary(DIV, at, a, b),
            Operation::Sqrt(a) => {
                let from = self.operand(a, at);
                let to = self.result(value, &[a], at);
                self.assembler.square_root(to, from);
            }
            Operation::Abs(a) => {
                let mask = self.constants.place(&[SIZE], CONSTANTS);
                let from = self.register(a, at);
                let to = self.result(value, &[a], at);
                self.assembler.operate(AND, to, from, mask);
            }
            Operation::Limit(a, b) => {
                let size = self.register(a, at);
                let limit = self.operand(b, at);
                let scratch = self.free_register(at);
                let exit = self.assembler.jump_if_any_is_larger(scratch, size, limit);
                self.exits.push(exit);
                self.finish(&[a, b], at);
            }
            Operation::MulAdd(a, b, c) => {
                self.multiply_add([MUL_ADD_132, MUL_ADD_213, MUL_ADD_231], at, [a, b, c]);
            }
            Operation::NegMulAdd(a, b, c) => {
                self.multiply_add([NEG_MUL_ADD_132, NEG_MUL_ADD_213, NEG_MUL_ADD_231], at, [a, b, c]);
            }
            Operation::PowerOfTwo(a) => {
                let whole = self.constants.place(&[WHOLE.to_bits()], CONSTANTS);
                let one = self.constants.place(&[1.0_f64.to_bits()], CONSTANTS);
                let from = self.register(a, at);
                let to = self.result(value, &[a], at);
                self.assembler.operate(ADD, to, from, whole);
                self.assembler.shift_to_exponents(to, to);
                self.assembler.operate(ADD_OF_INTEGERS, to, to, one);
            }
            Operation::Call(function, x) => self.call(value, function, x),
            Operation::Loop(number) => {
                let one = &self.shape.loops[number];
                match one.terms {
                    Terms::OfOneOrder { ref products, .. } => self.sums(value, one, products, number)?,
                    Terms::OfTwoOrders { skips } if self.assembler.instructions == Instructions::VexOne => {
                        self.products_of_one(value, one, skips, number)?;
                    }
                    Terms::OfTwoOrders { skips } => self.products(value, one, skips, number)?,
                }
            }
        }
        if self.register_of[at].is_some() {
            self.store(value);
            self.give_up_unused(value);
        }
        Some(())
    }

    // ---- arithmetic ----

    fn binary(&mut self, opcode: Opcode, at: usize, a: Value, b: Value) {
        let commutes = opcode == ADD || opcode == MUL;
        let is_memory = |emitter: &Self, value: Value| emitter.register_of[value as usize].is_none();
        let (a, b) = if commutes && is_memory(self, a) && !is_memory(self, b) { (b, a) } else { (a, b) };
        let first = self.register(a, at);
        let second = self.operand(b, at);
        let to = self.result(at as Value, &[a, b], at);
        self.assembler.operate(opcode, to, first, second);
    }

    /// `a b + c` or `c - a b`, in the three forms: which of the operands the result takes the place of.
    fn multiply_add(&mut self, [form_132, form_213, form_231]: [Opcode; 3], at: usize, [a, b, c]: [Value; 3]) {
        let ends = |emitter: &Self, value: Value| emitter.ends(value, at);
        let in_register = |emitter: &Self, value: Value| emitter.register_of[value as usize].is_some();
        let replaced = [c, a, b].into_iter().find(|&value| in_register(self, value) && ends(self, value));
        let replaced = replaced.or_else(|| [c, a, b].into_iter().find(|&value| !in_register(self, value)));
        let replaced = replaced.unwrap_or(c);
        // the others first, while the replaced one is where it is
        if let Some(register) = self.register_of[replaced as usize] {
            self.is_pinned[register as usize] = true;
        }
        let (form, first, second) = if replaced == c {
            let (a, b) = if in_register(self, a) { (a, b) } else { (b, a) };
            (form_231, a, b)
        } else {
            let factor = if replaced == a { b } else { a };
            if in_register(self, factor) { (form_213, factor, c) } else { (form_132, c, factor) }
        };
        let first_register = self.register(first, at);
        // what is replaced is needed in a register before it is overwritten
        let second_place = if second == replaced && !in_register(self, second) {
            Place::Register(self.register(second, at))
        } else {
            self.operand(second, at)
        };
        let to = match self.register_of[replaced as usize] {
            Some(register) if ends(self, replaced) => {
                self.forget(register);
                register
            }
            Some(register) => {
                let copy = self.free_register(at);
                self.assembler.load(copy, Place::Register(register));
                copy
            }
            None => {
                let copy = self.free_register(at);
                self.load(copy, replaced);
                copy
            }
        };
        self.assembler.operate(form, to, first_register, second_place);
        self.finish(&[a, b, c], at);
        self.put(at as Value, to);
    }

    // ---- calls ----

    /// Two results of a function: registers are lost on the way, so that what is in them alone is written first.
    fn call(&mut self, value: Value, function: [u64; 2], x: Value) {
        let at = value as usize;
        let from = self.register(x, at);
        // two registers of the spill memory, side by side, for all calls
        let first = *self.called.get_or_insert_with(|| {
            self.n_spilled += 2;
            (self.n_spilled as i32 - 2) * self.width
        });
        let places = [0, 1].map(|result| Place::Memory(SPILLED, first + result * self.width));
        self.assembler.store(from, places[0]);
        for register in 0..self.contents.len() as Register {
            let is_needed = self.contents[register as usize].is_some_and(|value| !self.ends(value, at));
            if is_needed {
                self.spill(register);
            }
            self.forget(register);
        }
        let at_function = self.constants.shared(&function);
        self.assembler.clear_upper_halves();
        KEPT.into_iter().for_each(|register| self.assembler.push(register));
        self.assembler.address(RDI, SPILLED, first);
        self.assembler.address_of_constant(RSI, at_function);
        self.assembler.set_rax(self.function as u64);
        self.assembler.call_rax();
        KEPT.into_iter().rev().for_each(|register| self.assembler.pop(register));
        for (number, result) in std::mem::take(&mut self.results[at]) {
            let register = self.free_register(at);
            self.assembler.load(register, places[number]);
            self.put(result, register);
            self.store(result);
        }
    }
}
