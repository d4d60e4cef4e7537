//! Sums of products where a register holds one number: those of two orders side by side in one register.
//!
//! The coefficients that the two orders multiply one number with are neighbours in memory, so they are loaded at once, and one operation adds
//! to both sums. Each sum gets the same terms in the same order as elsewhere.

use super::{COUNTS, Emitter, Register};
use crate::jit::assembler::{Assembler, Condition, General, Place, R10, R11, RAX};
use crate::jit::shape::Relative;
use crate::lanes::recorded::{Loop, Value};

/// Terms in a turn of a loop: as many as there are sums for one product at most.
const BLOCK: usize = 4;

impl Emitter<'_> {
    /// As [`Emitter::products`].
    pub(super) fn products_of_one(&mut self, value: Value, one: &Loop, skips: bool, number: usize) -> Option<()> {
        let at = value as usize;
        let (n_left, n_right) = (one.left.len(), one.right.len());
        let n_products = n_left * n_right;
        let n_sums = one.sums.len() / (2 * n_products);
        if !BLOCK.is_multiple_of(n_sums) {
            return None;
        }
        let is_taken = |pair: usize| !(skips && pair % n_products == n_right + 1);
        let mut pairs = vec![None; one.sums.len() / 2];
        for pair in (0..pairs.len()).filter(|&pair| is_taken(pair)) {
            pairs[pair] = Some(self.two_summands(&one.sums[2 * pair..], at));
        }
        let x: Vec<Register> = (0..n_left).map(|_| self.free_register(at)).collect();
        let y = self.free_register(at);
        let (left_base, left) = self.addresses(&one.left)?;
        let (right_base, right) = self.addresses(&one.right)?;
        let width = self.width;
        let term = |assembler: &mut Assembler, bases: [General; 2], term: usize, is_first: bool| {
            for (&to, &offset) in x.iter().zip(&left) {
                assembler.load_twice(to, Place::Memory(bases[0], offset + term as i32 * width));
            }
            for (b, &offset) in right.iter().enumerate() {
                let mut two = Place::Memory(bases[1], offset - (1 + term as i32) * width);
                if is_first {
                    // what was written as one number a moment ago could not be read along with another one before it is in the cache
                    assembler.load(y, two);
                    assembler.load_second(y, Place::Memory(bases[1], offset - term as i32 * width));
                    two = Place::Register(y);
                }
                for (a, &x) in x.iter().enumerate() {
                    if let Some(sums) = pairs[term % n_sums * n_products + a * n_right + b] {
                        assembler.multiply_add_two(sums, x, two);
                    }
                }
            }
        };
        let (runs, Relative { base, more }) = self.shape.count(number);
        let (fewest, most) = (*runs.iter().min()?, *runs.iter().max()?);
        if fewest == most && most <= BLOCK {
            (0..most).for_each(|i| term(self.assembler, [left_base, right_base], i, i == 0));
        } else {
            self.assembler.address(R10, left_base, 0);
            self.assembler.address(R11, right_base, 0);
            self.assembler.get(RAX, COUNTS, 8 * base as i32);
            // what is left after the first term and a turn of the loop
            self.assembler.add_to(RAX, i32::try_from(more).ok()? - 1 - BLOCK as i32);
            let mut ends = vec![];
            if fewest == 0 {
                self.assembler.compare(RAX, -1 - BLOCK as i32);
                ends.push(self.assembler.jump_if(Condition::Equal));
            }
            term(self.assembler, [R10, R11], 0, true);
            if most > BLOCK {
                let skip = (fewest <= BLOCK).then(|| {
                    self.assembler.compare(RAX, 0);
                    self.assembler.jump_if(Condition::Less)
                });
                self.assembler.align();
                let start = self.assembler.code.len();
                (1..=BLOCK).for_each(|i| term(self.assembler, [R10, R11], i, false));
                self.assembler.add_to(R10, BLOCK as i32 * width);
                self.assembler.subtract_from(R11, BLOCK as i32 * width);
                self.assembler.subtract_from(RAX, BLOCK as i32);
                self.assembler.jump_back_if(Condition::NotBelow, start);
                skip.into_iter().for_each(|skip| self.assembler.land(skip));
            }
            // what can be left after whole turns
            let may_be_left = |n: usize| runs.iter().any(|&run| run > 0 && (run - 1) % BLOCK == n);
            for i in (1..BLOCK).filter(|&i| (i..BLOCK).any(may_be_left)) {
                if may_be_left(i - 1) {
                    self.assembler.compare(RAX, i as i32 - 1 - BLOCK as i32);
                    ends.push(self.assembler.jump_if(Condition::Equal));
                }
                term(self.assembler, [R10, R11], i, false);
            }
            ends.into_iter().for_each(|end| self.assembler.land(end));
        }
        for (sum, result) in std::mem::take(&mut self.results[at]) {
            let sums = pairs[sum / 2].expect("a sum that is formed");
            let register = if sum % 2 == 0 { sums } else { self.free_register(at) };
            if sum % 2 == 1 {
                self.assembler.take_second(register, sums);
            }
            self.put(result, register);
            self.store(result);
            self.give_up_unused(result);
        }
        Some(())
    }

    /// A register that starts with the first two of these values and can be overwritten; the others are yet to be put into such registers.
    fn two_summands(&mut self, values: &[Value], at: usize) -> Register {
        let (first, second) = (values[0], values[1]);
        if self.is_zero(first) && self.is_zero(second) {
            let register = self.free_register(at);
            self.assembler.zero(register);
            return register;
        }
        let register = self.summand(first, at, &values[1..]);
        if self.is_zero(second) {
            self.assembler.clear_second(register);
        } else {
            let second = self.register(second, at);
            self.assembler.put_second(register, second);
        }
        register
    }
}
