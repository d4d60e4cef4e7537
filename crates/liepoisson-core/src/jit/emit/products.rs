//! Sums of products of coefficients, which are loops: nearly all of the work of a series.

use super::{COUNTS, Emitter, Register};
use crate::jit::assembler::{Assembler, Condition, General, MUL_ADD_231, Place, R10, R11, RAX};
use crate::jit::shape::Relative;
use crate::lanes::recorded::{Loop, Value};

impl Emitter<'_> {
    /// The sums of products, term by term: as many terms at a time as there are sums for one product, and at least two, so that what
    /// was the right coefficient of one order becomes that of the next without being moved.
    pub(super) fn products(&mut self, value: Value, one: &Loop, skips: bool, number: usize) -> Option<()> {
        let at = value as usize;
        let (n_left, n_right) = (one.left.len(), one.right.len());
        let n_sums = one.sums.len() / (2 * n_left * n_right);
        let block = n_sums.max(2);
        let pair_of = |index: usize| ((index / 2) / n_right % n_left, (index / 2) % n_right);
        let is_taken = |index: usize| !(skips && pair_of(index) == (1, 1));
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
            self.assembler.get(RAX, COUNTS, 8 * base as i32);
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
    pub(super) fn summand(&mut self, value: Value, at: usize, others: &[Value]) -> Register {
        let ends = self.ends(value, at) && !others.contains(&value);
        if let Some(register) = self.register_of[value as usize].filter(|_| ends) {
            self.forget(register);
            self.is_pinned[register as usize] = true;
            return register;
        }
        let of_value = self.register_of[value as usize];
        of_value.into_iter().for_each(|register| self.is_pinned[register as usize] = true);
        let register = self.free_register(at);
        match of_value {
            Some(from) => self.assembler.load(register, Place::Register(from)),
            None => self.load(register, value),
        }
        register
    }

    /// The one base of some registers of the memory, and their bytes from there.
    pub(super) fn addresses(&self, registers: &[Value]) -> Option<(General, Vec<i32>)> {
        let of = |&value: &Value| match self.home[value as usize] {
            Some(Place::Memory(base, offset)) => Some((base, offset)),
            _ => None,
        };
        let places: Vec<(General, i32)> = registers.iter().map(of).collect::<Option<_>>()?;
        let base = places[0].0;
        places.iter().all(|place| place.0 == base).then(|| (base, places.into_iter().map(|place| place.1).collect()))
    }
}
