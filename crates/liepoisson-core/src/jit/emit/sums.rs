//! Sums of products of one order, whose factors lie apart: those of quadratic fields.

use super::{COUNTS, Emitter, Register};
use crate::jit::assembler::{Assembler, Condition, General, MUL_ADD_231, Place, R10, R11, RAX};
use crate::jit::shape::Relative;
use crate::lanes::recorded::{Loop, Value};

impl Emitter<'_> {
    /// The sums, in as few loops as there are registers for, each with about as many of them.
    pub(super) fn sums(&mut self, value: Value, one: &Loop, products: &[[usize; 3]], number: usize) -> Option<()> {
        let n = one.sums.len();
        // so that no register is taken by what a sum starts with
        if !one.sums.iter().all(|&sum| self.is_zero(sum)) {
            return None;
        }
        let parts = (1..=n).map(|n_parts| n.div_ceil(n_parts)).find(|&size| {
            let starts = (0..n).step_by(size);
            starts
                .map(|start| Part::new(products, start, size.min(n - start)))
                .all(|part| part.registers() <= self.contents.len())
        });
        let size = parts?;
        let mut results = vec![None; n];
        for (result, operation) in std::mem::take(&mut self.results[value as usize]) {
            results[result] = Some(operation);
        }
        for start in (0..n).step_by(size) {
            self.part(value, one, &Part::new(products, start, size.min(n - start)), number, &results)?;
            self.is_pinned.fill(false);
        }
        Some(())
    }

    fn part(&mut self, value: Value, one: &Loop, part: &Part, number: usize, results: &[Option<Value>]) -> Option<()> {
        let at = value as usize;
        let wanted = part.start..part.start + part.n_sums;
        let sums: Vec<Register> = wanted.clone().map(|_| self.free_register(at)).collect();
        sums.iter().for_each(|&sum| self.assembler.zero(sum));
        let right_registers: Vec<Register> = part.right.iter().map(|_| self.free_register(at)).collect();
        let x = part.needs_left.then(|| self.free_register(at));
        let (left_base, left) = self.addresses(&one.left)?;
        let (right_base, right) = self.addresses(&one.right)?;
        let term = |assembler: &mut Assembler, bases: [General; 2]| {
            for (&to, &b) in right_registers.iter().zip(&part.right) {
                assembler.load(to, Place::Memory(bases[1], right[b]));
            }
            for (a, with) in &part.products {
                let mut place = Place::Memory(bases[0], left[*a]);
                if let (Some(x), 2..) = (x, with.len()) {
                    assembler.load(x, place);
                    place = Place::Register(x);
                }
                for &(sum, right) in with {
                    assembler.operate(MUL_ADD_231, sums[sum], right_registers[right], place);
                }
            }
        };
        let (runs, Relative { base, more }) = self.shape.count(number);
        if *runs.iter().min()? == 0 {
            return None;
        }
        let step = i32::try_from(one.step()).ok()?.checked_mul(self.width)?;
        self.assembler.address(R10, left_base, 0);
        self.assembler.address(R11, right_base, 0);
        self.assembler.get(RAX, COUNTS, 8 * base as i32);
        self.assembler.add_to(RAX, i32::try_from(more).ok()? - 1);
        self.assembler.align();
        let start = self.assembler.code.len();
        term(self.assembler, [R10, R11]);
        self.assembler.add_to(R10, step);
        self.assembler.subtract_from(R11, step);
        self.assembler.subtract_from(RAX, 1);
        self.assembler.jump_back_if(Condition::NotBelow, start);
        for (register, sum) in sums.into_iter().zip(wanted) {
            if let Some(result) = results[sum] {
                self.put(result, register);
                self.store(result);
                self.give_up_unused(result);
            } else {
                self.is_pinned[register as usize] = false;
            }
        }
        Some(())
    }
}

/// Some of the sums, from one on.
struct Part {
    start: usize,
    n_sums: usize,
    /// The right series that enter them.
    right: Vec<usize>,
    /// Left series in the order of the terms, with the sums, counted from the first, and the right series, counted in `right`.
    products: Vec<(usize, Vec<(usize, usize)>)>,
    /// Whether a left series enters several of them.
    needs_left: bool,
}

impl Part {
    fn new(all: &[[usize; 3]], start: usize, n_sums: usize) -> Part {
        let (mut right, mut products) = (vec![], Vec::<(usize, Vec<(usize, usize)>)>::new());
        // which left series a sum has had last: its terms keep their order
        let mut last = vec![0; n_sums];
        for &[sum, a, b] in all.iter().filter(|&&[sum, ..]| (start..start + n_sums).contains(&sum)) {
            let place = right.iter().position(|&other| other == b).unwrap_or_else(|| {
                right.push(b);
                right.len() - 1
            });
            let known = products.iter().position(|&(left, _)| left == a);
            let at = known.filter(|&at| at >= last[sum - start]).unwrap_or_else(|| {
                products.push((a, vec![]));
                products.len() - 1
            });
            products[at].1.push((sum - start, place));
            last[sum - start] = at;
        }
        let needs_left = products.iter().any(|(_, with)| with.len() > 1);
        Part { start, n_sums, right, products, needs_left }
    }

    /// How many registers it needs.
    fn registers(&self) -> usize {
        self.n_sums + self.right.len() + usize::from(self.needs_left)
    }
}
