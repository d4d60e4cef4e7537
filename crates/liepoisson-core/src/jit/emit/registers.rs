//! Which value is in which register, and what becomes of it when the register is wanted.

use super::{Emitter, Register};
use crate::jit::assembler::Place;
use crate::jit::emit::SPILLED;
use crate::lanes::recorded::{Operation, Value};

impl Emitter<'_> {
    /// The first operation from this one on that uses a value.
    pub(super) fn next_use(&self, value: Value, from: usize) -> Option<usize> {
        self.uses[value as usize].iter().rev().copied().find(|&at| at >= from)
    }

    /// Whether nothing uses a value after this operation.
    pub(super) fn ends(&self, value: Value, at: usize) -> bool {
        self.next_use(value, at + 1).is_none()
    }

    /// A register for something new.
    pub(super) fn free_register(&mut self, at: usize) -> Register {
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
    pub(super) fn spill(&mut self, register: Register) {
        let Some(value) = self.contents[register as usize] else { return };
        if self.home[value as usize].is_none() {
            let place = self.spill_place();
            self.assembler.store(register, place);
            self.home[value as usize] = Some(place);
        }
    }

    pub(super) fn spill_place(&mut self) -> Place {
        if let Some(place) = self.unused.pop() {
            return place;
        }
        self.n_spilled += 1;
        Place::Memory(SPILLED, (self.n_spilled as i32 - 1) * self.width)
    }

    pub(super) fn forget(&mut self, register: Register) {
        if let Some(value) = self.contents[register as usize].take() {
            self.register_of[value as usize] = None;
        }
    }

    pub(super) fn put(&mut self, value: Value, register: Register) {
        self.contents[register as usize] = Some(value);
        self.register_of[value as usize] = Some(register);
        self.is_pinned[register as usize] = true;
    }

    /// The register that a value is in, or is loaded into; it stays there during this operation.
    pub(super) fn register(&mut self, value: Value, at: usize) -> Register {
        if let Some(register) = self.register_of[value as usize] {
            self.is_pinned[register as usize] = true;
            return register;
        }
        let register = self.free_register(at);
        self.load(register, value);
        self.put(value, register);
        register
    }

    /// Loads a value from where it is beside registers.
    pub(super) fn load(&mut self, to: Register, value: Value) {
        if self.is_zero(value) {
            return self.assembler.zero(to);
        }
        self.assembler.load(to, self.home[value as usize].expect("a value is in a register or in memory"));
    }

    /// Whether a value is the constant zero, at each order.
    pub(super) fn is_zero(&self, value: Value) -> bool {
        match self.shape.operations[value as usize] {
            Operation::Constant(number) => self.shape.columns[number as usize].iter().all(|&bits| bits == 0),
            _ => false,
        }
    }

    /// Where an operation that may read memory finds a value: there, if nothing else needs it soon.
    pub(super) fn operand(&mut self, value: Value, at: usize) -> Place {
        let is_constant = matches!(self.shape.operations[value as usize], Operation::Constant(_));
        match (self.register_of[value as usize], self.home[value as usize]) {
            (None, Some(place)) if is_constant || self.ends(value, at) => place,
            _ => Place::Register(self.register(value, at)),
        }
    }

    /// A register for the result of an operation; it may be that of an operand that ends here.
    pub(super) fn result(&mut self, value: Value, operands: &[Value], at: usize) -> Register {
        self.finish(operands, at);
        let register = self.free_register(at);
        self.put(value, register);
        register
    }

    /// Gives up the registers of operands that nothing needs after this.
    pub(super) fn finish(&mut self, operands: &[Value], at: usize) {
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
    pub(super) fn pass(&mut self, at: usize) {
        let shape = self.shape;
        let mut pass = |value: Value| {
            let uses = &mut self.uses[value as usize];
            while uses.last().is_some_and(|&last| last <= at) {
                uses.pop();
                if uses.is_empty()
                    && let Some(place @ Place::Memory(SPILLED, _)) = self.home[value as usize]
                {
                    self.unused.push(place);
                }
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

    pub(super) fn give_up_unused(&mut self, value: Value) {
        if self.uses[value as usize].is_empty()
            && let Some(register) = self.register_of[value as usize]
        {
            self.forget(register);
        }
    }

    /// Writes a value, which is in a register, where the memory is to hold it.
    pub(super) fn store(&mut self, value: Value) {
        let register = self.register_of[value as usize].expect("what is stored is in a register");
        for place in std::mem::take(&mut self.stores[value as usize]) {
            self.assembler.store(register, place);
            self.home[value as usize].get_or_insert(place);
        }
    }
}
