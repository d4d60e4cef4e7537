//! Sums of products of coefficients, which are loops: nearly all of the work of a series.

use super::{COUNTS, Emitter, Register};
use crate::jit::assembler::{Assembler, Condition, General, MUL_ADD_231, Place, R10, R11, RAX};
use crate::jit::shape::Relative;
use crate::lanes::recorded::{Loop, Value};

/// Registers for coefficients of left series.
const X: usize = 2;

impl Emitter<'_> {
    /// The sums of products of a loop: of as many left series at a time as there are registers for.
    pub(super) fn products(&mut self, value: Value, one: &Loop, number: usize) -> Option<()> {
        let mut results = std::mem::take(&mut self.results[value as usize]);
        let (n_left, n_right) = (one.left.len(), one.right.len());
        let left_of = |index: usize| index / (2 * n_right) % n_left;
        let mut first = 0;
        while first < n_left {
            let (mut end, mut n_registers) = (first, X + 2 * n_right);
            while end < n_left {
                n_registers += results.iter().filter(|(index, _)| left_of(*index) == end).count();
                if end > first && n_registers > self.contents.len() {
                    break;
                }
                end += 1;
            }
            let (now, later) = results.into_iter().partition(|(index, _)| left_of(*index) < end);
            results = later;
            let others: Vec<Value> = results.iter().map(|&(index, _)| one.sums[index]).collect();
            self.some_products(value as usize, (one, number), now, &others)?;
            self.is_pinned.fill(false);
            first = end;
        }
        Some(())
    }

    /// These sums, term by term: as many terms at a time as there are sums for one product, and at least two, so that what was the
    /// right coefficient of one order becomes that of the next without being moved.
    fn some_products(
        &mut self,
        at: usize,
        (one, number): (&Loop, usize),
        results: Vec<(usize, Value)>,
        others: &[Value],
    ) -> Option<()> {
        let (n_left, n_right) = (one.left.len(), one.right.len());
        let n_sums = one.sums.len() / (2 * n_left * n_right);
        let block = n_sums.max(2);
        let mut sums = vec![None; one.sums.len()];
        for (place, &(index, _)) in results.iter().enumerate() {
            let next = results[place + 1..].iter().map(|&(index, _)| one.sums[index]);
            let others: Vec<Value> = next.chain(others.iter().copied()).collect();
            sums[index] = Some(self.summand(one.sums[index], at, &others));
        }
        let x: [Register; X] = std::array::from_fn(|_| self.free_register(at));
        let y: [Vec<Register>; 2] = std::array::from_fn(|_| (0..n_right).map(|_| self.free_register(at)).collect());
        let (left_base, left) = self.addresses(&one.left)?;
        let (right_base, right) = self.addresses(&one.right)?;
        for (&to, &offset) in y[1].iter().zip(&right) {
            self.assembler.load(to, Place::Memory(right_base, offset));
        }
        let step = i32::try_from(one.stride).ok()?.checked_mul(self.width)?;
        step.checked_mul(2 * block as i32)?;
        let terms = |assembler: &mut Assembler, bases: [General; 2], term: usize| {
            let (new, before) = (&y[term % 2], &y[1 - term % 2]);
            for (&to, &offset) in new.iter().zip(&right) {
                assembler.load(to, Place::Memory(bases[1], offset - (1 + term as i32) * step));
            }
            let of_left = 2 * n_right;
            for (a, &offset) in left.iter().enumerate() {
                let first = of_left * (n_left * (term % n_sums) + a);
                let of_sums = &sums[first..first + of_left];
                if of_sums.iter().all(Option::is_none) {
                    continue;
                }
                let x = x[a % X];
                assembler.load(x, Place::Memory(bases[0], offset + term as i32 * step));
                for (index, &sum) in of_sums.iter().enumerate() {
                    let y = if index % 2 == 0 { new[index / 2] } else { before[index / 2] };
                    if let Some(sum) = sum {
                        assembler.operate(MUL_ADD_231, sum, x, Place::Register(y));
                    }
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
                self.assembler.add_to(R10, block as i32 * step);
                self.assembler.subtract_from(R11, block as i32 * step);
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
        for (index, result) in results {
            let register = sums[index].expect("a sum that is formed");
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
            Some(from) => {
                self.assembler.load(register, Place::Register(from));
                self.is_pinned[from as usize] = false;
            }
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
