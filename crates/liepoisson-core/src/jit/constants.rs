//! The numbers that compiled code reads: in pages before it, in which nothing is run.

use super::assembler::{General, Place};
use super::memory::PAGE;
use crate::lanes::Instructions;
use std::collections::HashMap;

/// Constants of all pieces of code. Those that do not depend on the order lie just before the code, so that their distance from it
/// does not depend on how many there are.
pub(super) struct Constants {
    /// Numbers that one constant takes: AVX2 reads a whole register, be it one number, AVX-512 spreads one.
    unit: usize,
    /// The numbers before the code, the nearest first.
    before: Vec<u64>,
    known: HashMap<Vec<u64>, i32>,
    /// The constants of the present piece that depend on the order: for each its number at each order.
    varying: Vec<Vec<u64>>,
    /// Those of the orders so far.
    rows: Vec<u64>,
}

impl Constants {
    pub(super) fn new(instructions: Instructions) -> Constants {
        let unit = if instructions == Instructions::Vex { 4 } else { 1 };
        Constants { unit, before: vec![], known: HashMap::new(), varying: vec![], rows: vec![] }
    }

    /// Where a constant is, given its bits at each order; `base` is where those that depend on the order begin.
    pub(super) fn place(&mut self, column: &[u64], base: General) -> Place {
        if column.iter().all(|&bits| bits == column[0]) {
            return Place::Constant(self.shared(&vec![column[0]; self.unit]));
        }
        let at = self.varying.iter().position(|other| other == column).unwrap_or_else(|| {
            self.varying.push(column.to_vec());
            self.varying.len() - 1
        });
        Place::Varying(base, (8 * self.unit * at) as i32)
    }

    /// Where these numbers are, in bytes from the start of the code.
    pub(super) fn shared(&mut self, numbers: &[u64]) -> i32 {
        if let Some(&at) = self.known.get(numbers) {
            return at;
        }
        self.before.extend(numbers.iter().rev());
        while !self.before.len().is_multiple_of(self.unit) {
            self.before.push(0);
        }
        // the padding lies before the numbers
        let padded = numbers.len().next_multiple_of(self.unit) - numbers.len();
        let at = -8 * (self.before.len() - padded) as i32;
        self.known.insert(numbers.to_vec(), at);
        at
    }

    /// Ends a piece: for each order where its own constants begin, in numbers from the start of all.
    pub(super) fn end_piece(&mut self, n_orders: usize) -> Vec<usize> {
        let varying = std::mem::take(&mut self.varying);
        let starts = (0..n_orders).map(|order| {
            let start = self.rows.len();
            self.rows.extend(varying.iter().flat_map(|column| std::iter::repeat_n(column[order], self.unit)));
            start
        });
        starts.collect()
    }

    /// Where a number counted from the start of all is, in bytes from the start of the code, once all are known.
    pub(super) fn place_of(&self, number: usize) -> i32 {
        8 * (number as i32 - self.count() as i32)
    }

    /// Numbers in all, in whole pages.
    fn count(&self) -> usize {
        (self.rows.len() + self.before.len()).next_multiple_of(PAGE / 8)
    }

    /// All numbers as they are to lie before the code.
    pub(super) fn into_numbers(self) -> Vec<u64> {
        let n = self.count();
        let mut numbers = self.rows;
        numbers.resize(n - self.before.len(), 0);
        numbers.extend(self.before.iter().rev());
        numbers
    }
}
