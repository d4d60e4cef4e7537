//! From a piece's operations to instructions: which value is in which register, and where it is otherwise.
//!
//! Values are computed in the order in which they were recorded. When registers are wanted, the one whose value is needed last is
//! given up; it is written to the spill memory if it is nowhere else.

use super::assembler::*;
use super::constants::Constants;
use super::shape::{Relative, Shape};
use crate::lanes::Instructions;
use crate::lanes::recorded::{Loop, Operation, Value};

/// What each piece of code is called with: addresses and numbers, of eight bytes each.
#[repr(C)]
pub(super) struct Arguments {
    /// The bases of addresses.
    pub(super) bases: [usize; 4],
    /// The constants that depend on the order.
    pub(super) constants: usize,
    /// Memory for values that no register is left for.
    pub(super) spilled: usize,
    /// What the lengths of loops are counted from.
    pub(super) counts: [usize; 3],
}

const BASES: [General; 4] = [RDI, RSI, RDX, R8];
const CONSTANTS: General = RCX;
const SPILLED: General = R9;
/// Where the arguments are, also after a call.
const ARGUMENTS: General = RBX;
const AT_CONSTANTS: i32 = 32;
const AT_SPILLED: i32 = 40;
const AT_COUNTS: i32 = 48;

/// Registers of memory for values that no register is left for: a piece that needs more is not compiled.
pub(super) const MOST_SPILLED: usize = 256;

/// The code of a piece; none if it needs too much memory, or has addresses beyond 31 bits.
pub(super) fn emit(shape: &Shape, constants: &mut Constants, function: usize, assembler: &mut Assembler) -> Option<()> {
    let mut emitter = Emitter::new(shape, constants, function, assembler)?;
    emitter.run()?;
    (emitter.n_spilled <= MOST_SPILLED).then_some(())
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
        let (width, registers) = match assembler.instructions {
            Instructions::Vex => (32, 16),
            Instructions::Evex => (64, 32),
        };
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
        self.assembler.push_rbx();
        self.assembler.address(ARGUMENTS, RDI, 0);
        self.get_addresses();
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
        self.assembler.leave(false);
        if !self.exits.is_empty() {
            for exit in std::mem::take(&mut self.exits) {
                self.assembler.land(exit);
            }
            self.assembler.leave(true);
        }
        Some(())
    }

    fn get_addresses(&mut self) {
        for (i, &base) in BASES.iter().enumerate() {
            self.assembler.get(base, ARGUMENTS, 8 * i as i32);
        }
        self.assembler.get(CONSTANTS, ARGUMENTS, AT_CONSTANTS);
        self.assembler.get(SPILLED, ARGUMENTS, AT_SPILLED);
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
                let mask = self.constants.place(&[i64::MAX as u64], CONSTANTS);
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
            Operation::WhereNotZero(a, b) => {
                let zero = self.constants.place(&[0], CONSTANTS);
                let (from, other) = (self.register(a, at), self.register(b, at));
                let to = self.result(value, &[], at);
                self.assembler.where_not_zero(to, from, other, zero);
                self.finish(&[a, b], at);
            }
            Operation::Call(function, x) => self.call(value, function, x),
            Operation::Loop(one) => self.products(value, &self.shape.loops[one], one)?,
        }
        if self.register_of[at].is_some() {
            self.store(value);
            self.give_up_unused(value);
        }
        Some(())
    }

    // ---- registers ----

    /// The first operation from this one on that uses a value.
    fn next_use(&self, value: Value, from: usize) -> Option<usize> {
        self.uses[value as usize].iter().rev().copied().find(|&at| at >= from)
    }

    /// Whether nothing uses a value after this operation.
    fn ends(&self, value: Value, at: usize) -> bool {
        self.next_use(value, at + 1).is_none()
    }

    /// A register for something new.
    fn free_register(&mut self, at: usize) -> Register {
        let free = (0..self.contents.len()).find(|&r| self.contents[r].is_none() && !self.is_pinned[r]);
        let register = free.unwrap_or_else(|| {
            let candidates = (0..self.contents.len()).filter(|&r| !self.is_pinned[r]);
            let distance = |&r: &usize| {
                let value = self.contents[r].expect("a register that is not free");
                let next = self.next_use(value, at).unwrap_or(usize::MAX) - at;
                // to write it costs as much as to read it again
                if self.home[value as usize].is_some() { next } else { next / 2 }
            };
            let register = candidates.max_by_key(distance).expect("more registers than one operation needs");
            if self.contents[register].is_some_and(|value| self.next_use(value, at).is_some()) {
                self.spill(register as Register);
            }
            self.forget(register as Register);
            register
        });
        self.is_pinned[register] = true;
        register as Register
    }

    /// Writes what is in a register to memory, unless it is there.
    fn spill(&mut self, register: Register) {
        let Some(value) = self.contents[register as usize] else { return };
        if self.home[value as usize].is_none() {
            let place = self.spill_place();
            self.assembler.store(register, place);
            self.home[value as usize] = Some(place);
        }
    }

    fn spill_place(&mut self) -> Place {
        self.n_spilled += 1;
        Place::Memory(SPILLED, (self.n_spilled as i32 - 1) * self.width)
    }

    fn forget(&mut self, register: Register) {
        if let Some(value) = self.contents[register as usize].take() {
            self.register_of[value as usize] = None;
        }
    }

    fn put(&mut self, value: Value, register: Register) {
        self.contents[register as usize] = Some(value);
        self.register_of[value as usize] = Some(register);
        self.is_pinned[register as usize] = true;
    }

    /// The register that a value is in, or is loaded into; it stays there during this operation.
    fn register(&mut self, value: Value, at: usize) -> Register {
        if let Some(register) = self.register_of[value as usize] {
            self.is_pinned[register as usize] = true;
            return register;
        }
        let from = self.home[value as usize].expect("a value is in a register or in memory");
        let register = self.free_register(at);
        self.assembler.load(register, from);
        self.put(value, register);
        register
    }

    /// Where an operation that may read memory finds a value: there, if nothing else needs it soon.
    fn operand(&mut self, value: Value, at: usize) -> Place {
        let is_constant = matches!(self.shape.operations[value as usize], Operation::Constant(_));
        match (self.register_of[value as usize], self.home[value as usize]) {
            (None, Some(place)) if is_constant || self.ends(value, at) => place,
            _ => Place::Register(self.register(value, at)),
        }
    }

    /// A register for the result of an operation; it may be that of an operand that ends here.
    fn result(&mut self, value: Value, operands: &[Value], at: usize) -> Register {
        self.finish(operands, at);
        let register = self.free_register(at);
        self.put(value, register);
        register
    }

    /// Gives up the registers of operands that nothing needs after this.
    fn finish(&mut self, operands: &[Value], at: usize) {
        for &operand in operands {
            if self.ends(operand, at)
                && let Some(register) = self.register_of[operand as usize]
            {
                self.forget(register);
                self.is_pinned[register as usize] = false;
            }
        }
    }

    /// Forgets the uses by this operation.
    fn pass(&mut self, at: usize) {
        let shape = self.shape;
        let mut pass = |value: Value| {
            let uses = &mut self.uses[value as usize];
            while uses.last().is_some_and(|&last| last <= at) {
                uses.pop();
            }
            value
        };
        if let Operation::Loop(one) = shape.operations[at] {
            shape.loops[one].sums.iter().for_each(|&sum| {
                pass(sum);
            });
        }
        shape.operations[at].map(pass);
    }

    fn give_up_unused(&mut self, value: Value) {
        if self.uses[value as usize].is_empty()
            && let Some(register) = self.register_of[value as usize]
        {
            self.forget(register);
        }
    }

    /// Writes a value, which is in a register, where the memory is to hold it.
    fn store(&mut self, value: Value) {
        let register = self.register_of[value as usize].expect("what is stored is in a register");
        for place in std::mem::take(&mut self.stores[value as usize]) {
            self.assembler.store(register, place);
            self.home[value as usize].get_or_insert(place);
        }
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
                let from = self.home[replaced as usize].expect("a value is in a register or in memory");
                let copy = self.free_register(at);
                self.assembler.load(copy, from);
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
        let places = [self.spill_place(), self.spill_place()];
        self.assembler.store(from, places[0]);
        for register in 0..self.contents.len() as Register {
            let is_needed = self.contents[register as usize].is_some_and(|value| !self.ends(value, at));
            if is_needed {
                self.spill(register);
            }
            self.forget(register);
        }
        let Place::Memory(base, offset) = places[0] else { unreachable!("a place to spill to is memory") };
        let at_function = self.constants.shared(&function);
        self.assembler.clear_upper_halves();
        self.assembler.address(RDI, base, offset);
        self.assembler.address_of_constant(RSI, at_function);
        self.assembler.set_rax(self.function as u64);
        self.assembler.call_rax();
        self.get_addresses();
        for (number, result) in std::mem::take(&mut self.results[at]) {
            self.home[result as usize] = Some(places[number]);
            if !self.stores[result as usize].is_empty() {
                self.register(result, at);
                self.store(result);
                self.is_pinned.fill(false);
            }
        }
    }

    // ---- loops ----

    /// The sums of products, term by term: as many terms at a time as there are sums for one product, and at least two, so that what
    /// was the right coefficient of one order becomes that of the next without being moved.
    fn products(&mut self, value: Value, one: &Loop, number: usize) -> Option<()> {
        let at = value as usize;
        let (n_left, n_right) = (one.left.len(), one.right.len());
        let n_sums = one.sums.len() / (2 * n_left * n_right);
        let block = n_sums.max(2);
        let pair_of = |index: usize| ((index / 2) / n_right % n_left, (index / 2) % n_right);
        let is_taken = |index: usize| !(one.skips && pair_of(index) == (1, 1));
        let mut sums = vec![None; one.sums.len()];
        for index in (0..one.sums.len()).filter(|&index| is_taken(index)) {
            sums[index] = Some(self.summand(one.sums[index], at, &one.sums[index + 1..]));
        }
        let x: Vec<Register> = (0..n_left).map(|_| self.free_register(at)).collect();
        let y: [Vec<Register>; 2] = std::array::from_fn(|_| (0..n_right).map(|_| self.free_register(at)).collect());
        let (left_base, left) = self.addresses(&one.left)?;
        let (right_base, right) = self.addresses(&one.right)?;
        for (&to, &offset) in y[1].iter().zip(&right) {
            self.assembler.load(to, Place::Memory(right_base, offset));
        }
        let width = self.width;
        let terms = |assembler: &mut Assembler, bases: [General; 2], term: usize| {
            let (new, before) = (&y[term % 2], &y[1 - term % 2]);
            for (&to, &offset) in x.iter().zip(&left) {
                assembler.load(to, Place::Memory(bases[0], offset + term as i32 * width));
            }
            for (&to, &offset) in new.iter().zip(&right) {
                assembler.load(to, Place::Memory(bases[1], offset - (1 + term as i32) * width));
            }
            let of_term = 2 * n_left * n_right * (term % n_sums);
            for index in of_term..of_term + 2 * n_left * n_right {
                if let Some(sum) = sums[index] {
                    let (a, b) = pair_of(index);
                    let y = if index % 2 == 0 { new[b] } else { before[b] };
                    assembler.operate(MUL_ADD_231, sum, x[a], Place::Register(y));
                }
            }
        };
        let (runs, Relative { base, more }) = self.shape.count(number);
        let (fewest, most) = (*runs.iter().min()?, *runs.iter().max()?);
        let rest = runs.iter().all(|run| run % block == runs[0] % block).then_some(runs[0] % block);
        if fewest == most && most <= block {
            (0..most).for_each(|term| terms(self.assembler, [left_base, right_base], term));
        } else {
            self.assembler.address(R10, left_base, 0);
            self.assembler.address(R11, right_base, 0);
            self.assembler.get(RAX, ARGUMENTS, AT_COUNTS + 8 * base as i32);
            self.assembler.add_to(RAX, i32::try_from(more).ok()? - block as i32);
            let skip = (fewest < block).then(|| {
                self.assembler.compare(RAX, 0);
                self.assembler.jump_if(Condition::Less)
            });
            if most >= block {
                self.assembler.align();
                let start = self.assembler.code.len();
                (0..block).for_each(|term| terms(self.assembler, [R10, R11], term));
                self.assembler.add_to(R10, block as i32 * width);
                self.assembler.subtract_from(R11, block as i32 * width);
                self.assembler.subtract_from(RAX, block as i32);
                self.assembler.jump_back_if(Condition::NotBelow, start);
            }
            if let Some(skip) = skip {
                self.assembler.land(skip);
            }
            match rest {
                Some(rest) => (0..rest).for_each(|term| terms(self.assembler, [R10, R11], term)),
                None => {
                    let mut ends = vec![];
                    for term in 0..block - 1 {
                        self.assembler.compare(RAX, term as i32 - block as i32);
                        ends.push(self.assembler.jump_if(Condition::Equal));
                        terms(self.assembler, [R10, R11], term);
                    }
                    ends.into_iter().for_each(|end| self.assembler.land(end));
                }
            }
        }
        for (number, result) in std::mem::take(&mut self.results[at]) {
            let register = sums[number].expect("a sum that is formed");
            self.put(result, register);
            self.store(result);
            self.give_up_unused(result);
        }
        Some(())
    }

    /// A register that starts with this value and can be overwritten. `others` are values that are yet to be put into such registers.
    fn summand(&mut self, value: Value, at: usize, others: &[Value]) -> Register {
        let bits = match self.shape.operations[value as usize] {
            Operation::Constant(number) => self.shape.columns[number as usize].iter().all(|&bits| bits == 0),
            _ => false,
        };
        if bits {
            let register = self.free_register(at);
            self.assembler.zero(register);
            return register;
        }
        let ends = self.ends(value, at) && !others.contains(&value);
        if let Some(register) = self.register_of[value as usize].filter(|_| ends) {
            self.forget(register);
            self.is_pinned[register as usize] = true;
            return register;
        }
        let from = match self.register_of[value as usize] {
            Some(register) => {
                self.is_pinned[register as usize] = true;
                Place::Register(register)
            }
            None => self.home[value as usize].expect("a value is in a register or in memory"),
        };
        let register = self.free_register(at);
        self.assembler.load(register, from);
        register
    }

    /// The one base of some registers of the memory, and their bytes from there.
    fn addresses(&self, registers: &[Value]) -> Option<(General, Vec<i32>)> {
        let of = |&value: &Value| match self.home[value as usize] {
            Some(Place::Memory(base, offset)) => Some((base, offset)),
            _ => None,
        };
        let places: Vec<(General, i32)> = registers.iter().map(of).collect::<Option<_>>()?;
        let base = places[0].0;
        places.iter().all(|place| place.0 == base).then(|| (base, places.into_iter().map(|place| place.1).collect()))
    }
}
