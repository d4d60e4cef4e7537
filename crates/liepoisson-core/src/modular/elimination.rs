//! Elimination, first of sparse rows, then of dense ones, that passes over most rows that would reduce to zero.
//!
//! A row depends on the rows so far if all their null vectors are null vectors of it, too. Sixteen random null vectors
//! cost sixteen substitutions, and then tell of each row at the price of a few products whether it is independent.

use super::dense::{Dense, VECTORS};
use super::echelon::{Echelon, filled};
use super::prime::Prime;
use super::rows::Rows;
use crate::ensemble::Control;
use crate::error::Error;
use std::cmp::Reverse;

/// After so many new rows it is decided whether to go on with dense ones: where these have so large a part of the columns
/// without a pivot.
const WINDOW: usize = 32;
const FULL: f64 = 0.2;

/// How an elimination ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum End {
    /// No row is left that is known to be independent.
    Exhausted,
    EnoughRank,
    Stopped,
}

/// Entries of sixteen vectors, column by column.
type Vectors = Vec<[u64; VECTORS]>;

/// The dense rows, and which column each of theirs is.
struct Rest {
    dense: Dense,
    columns: Vec<u32>,
}

/// Rows, and an echelon form of those that were reduced.
pub(super) struct Elimination<'r> {
    prime: Prime,
    rows: &'r Rows,
    n_columns: usize,
    echelon: Echelon,
    rest: Option<Rest>,
    /// State of the random numbers, which are the same in every run.
    random: u64,
    /// Rows that passed the test for dependence.
    skipped: Vec<u32>,
}

impl<'r> Elimination<'r> {
    pub(super) fn new(prime: Prime, rows: &'r Rows, n_columns: usize) -> Result<Elimination<'r>, Error> {
        let echelon = Echelon::new(prime, n_columns)?;
        Ok(Elimination { prime, rows, n_columns, echelon, rest: None, random: 0, skipped: Vec::new() })
    }

    pub(super) fn rank(&self) -> usize {
        self.echelon.rank() + self.rest.as_ref().map_or(0, |rest| rest.dense.rank())
    }

    /// The columns that have a pivot.
    pub(super) fn pivots(&mut self) -> Result<Vec<bool>, Error> {
        let mut pivots = filled(self.n_columns, false)?;
        for (column, is_pivot) in pivots.iter_mut().enumerate() {
            *is_pivot = self.echelon.has_pivot(column);
        }
        if let Some(Rest { dense, columns }) = &mut self.rest {
            dense.end_block()?;
            for (index, &column) in columns.iter().enumerate() {
                pivots[column as usize] = dense.has_pivot(index);
            }
        }
        Ok(pivots)
    }

    /// Reduces all rows: last first columns first, and the shortest first of those with the same. So the first row of a
    /// column comes before all rows that have to be reduced by it, and becomes a row of the echelon form as it is.
    pub(super) fn run(&mut self, enough: usize, control: &Control) -> Result<End, Error> {
        let rows = self.rows;
        let mut queue: Vec<u32> = (0..rows.len() as u32).collect();
        queue.sort_by_cached_key(|&row| {
            let columns = rows.row(row as usize).0;
            (Reverse(columns[0]), columns.len(), row)
        });
        self.work_off(queue, enough, control)
    }

    fn work_off(&mut self, mut queue: Vec<u32>, enough: usize, control: &Control) -> Result<End, Error> {
        let (mut next, mut wasted) = (0, 0);
        let (mut n_new, mut length) = (0, 0);
        loop {
            if let Some(end) = self.end(enough, control) {
                return Ok(end);
            }
            if next < queue.len() && wasted > self.cost_of_test(&queue[next..]) {
                queue = self.independent_first(&queue[next..])?;
                (next, wasted) = (0, 0);
            }
            if next == queue.len() {
                return Ok(End::Exhausted);
            }
            let before = self.work();
            self.echelon.add(self.rows.entries(queue[next] as usize), self.prime.scaled(1));
            next += 1;
            if !self.absorb()? {
                wasted += self.work() - before;
            } else if self.rest.is_none() {
                (n_new, length) = (n_new + 1, length + self.echelon.newest_length());
                if n_new == WINDOW {
                    let places = WINDOW * (self.n_columns - self.rank());
                    if length > WINDOW * WINDOW && length as f64 > FULL * places as f64 {
                        self.go_on_dense()?;
                        if self.absorb_sums(&queue[next..], enough, control)? {
                            wasted = u64::MAX;
                        }
                    }
                    (n_new, length) = (0, 0);
                }
            }
        }
    }

    /// Why no more rows are needed, if they are not.
    fn end(&self, enough: usize, control: &Control) -> Option<End> {
        control.set_done(self.rank() as f64 / self.n_columns.min(self.rows.len()).max(1) as f64);
        if self.rank() >= enough {
            return Some(End::EnoughRank);
        }
        if self.rank() == self.n_columns {
            return Some(End::Exhausted);
        }
        control.look_at_clock().map(|_| End::Stopped)
    }

    /// Products so far.
    fn work(&self) -> u64 {
        self.echelon.work + self.rest.as_ref().map_or(0, |rest| rest.dense.work)
    }

    /// Reduces the row that was added to the echelon form. Whether anything is left.
    fn absorb(&mut self) -> Result<bool, Error> {
        let Some(Rest { dense, columns }) = &mut self.rest else { return self.echelon.absorb() };
        let mut row = filled(columns.len(), 0)?;
        let mut is_zero = true;
        self.echelon.reduce(|column, residue| {
            let index = columns.binary_search(&(column as u32)).expect("a column without a pivot is one of these");
            row[index] = residue;
            is_zero = false;
        });
        if is_zero { Ok(false) } else { dense.absorb(row) }
    }

    fn go_on_dense(&mut self) -> Result<(), Error> {
        let has_none = |column: &u32| !self.echelon.has_pivot(*column as usize);
        let columns: Vec<u32> = (0..self.n_columns as u32).filter(has_none).collect();
        self.rest = Some(Rest { dense: Dense::new(self.prime, columns.len())?, columns });
        Ok(())
    }

    /// If there are more rows than columns, absorbs as many sums of random multiples of rows as there are columns: nearly
    /// always these have the rank of all rows. Whether it did.
    fn absorb_sums(&mut self, queue: &[u32], enough: usize, control: &Control) -> Result<bool, Error> {
        let n_sums = self.n_columns - self.rank();
        if queue.len() <= n_sums {
            return Ok(false);
        }
        let mut wasted = 0;
        for first in 0..n_sums {
            if self.end(enough, control).is_some() || wasted > self.cost_of_test(queue) {
                break;
            }
            let before = self.work();
            for &row in queue.iter().skip(first).step_by(n_sums) {
                let factor = self.random_residue();
                self.echelon.add(self.rows.entries(row as usize), factor);
            }
            if !self.absorb()? {
                wasted += self.work() - before;
            }
        }
        Ok(true)
    }

    /// What it costs to find out which of the rows are independent, and to prove at the end that the others are not.
    fn cost_of_test(&self, queue: &[u32]) -> u64 {
        let n_entries = self.echelon.n_entries() + self.rest.as_ref().map_or(0, |rest| rest.dense.n_entries());
        let average = self.rows.n_entries() / self.rows.len() as u64 + 1;
        let (vectors, nullity) = (VECTORS as u64, (self.n_columns - self.rank()) as u64);
        vectors * n_entries + queue.len() as u64 * ((vectors + nullity) * average + vectors * vectors / 2)
    }

    /// The rows that are left after those that the test finds dependent; those that it finds independent come first. It ends
    /// when it has found as many as it can.
    fn independent_first(&mut self, queue: &[u32]) -> Result<Vec<u32>, Error> {
        let prime = self.prime;
        let pivots = self.pivots()?;
        let mut vectors = filled(self.n_columns, [0; VECTORS])?;
        for (values, _) in vectors.iter_mut().zip(pivots).filter(|(_, is_pivot)| !is_pivot) {
            *values = std::array::from_fn(|_| self.random_residue());
        }
        self.complete(&mut vectors);
        let mut found: Vec<(usize, [u64; VECTORS])> = Vec::new();
        let mut independent = Vec::new();
        for (place, &row) in queue.iter().enumerate() {
            let mut products = self.products(row, &vectors);
            for (pivot, other) in &found {
                let scaled = prime.scaled(prime.negative(products[*pivot]));
                for (product, &entry) in products.iter_mut().zip(other) {
                    *product = prime.add(*product, prime.product(entry, scaled));
                }
            }
            if let Some(pivot) = products.iter().position(|&product| product != 0) {
                let inverse = prime.scaled(prime.inverse(products[pivot]));
                found.push((pivot, products.map(|product| prime.product(product, inverse))));
                independent.push(row);
                if found.len() == VECTORS {
                    independent.extend_from_slice(&queue[place + 1..]);
                    break;
                }
            } else {
                self.skipped.push(row);
            }
        }
        Ok(independent)
    }

    /// Products of a row with vectors, up to a common factor.
    fn products(&self, row: u32, vectors: &Vectors) -> [u64; VECTORS] {
        let mut sums = [0; VECTORS];
        for (column, residue) in self.rows.entries(row as usize) {
            for (sum, &value) in sums.iter_mut().zip(&vectors[column]) {
                *sum = self.prime.add_product(*sum, residue, value);
            }
        }
        sums.map(|sum| self.prime.reduce(sum))
    }

    /// Gives vectors the values at the pivots with which they are null vectors; the values elsewhere are given.
    fn complete(&self, vectors: &mut Vectors) {
        let prime = self.prime;
        if let Some(Rest { dense, columns }) = &self.rest {
            let mut values: Vectors = columns.iter().map(|&column| vectors[column as usize]).collect();
            dense.complete(&mut values);
            for (&column, values) in columns.iter().zip(values) {
                vectors[column as usize] = values;
            }
        }
        for pivot in (0..self.n_columns).rev() {
            let Some(entries) = self.echelon.right_of(pivot) else { continue };
            let mut sums = [0; VECTORS];
            for (column, residue) in entries {
                for (sum, &value) in sums.iter_mut().zip(&vectors[column]) {
                    *sum = prime.add_product(*sum, residue, value);
                }
            }
            vectors[pivot] = sums.map(|sum| prime.negative(prime.scaled(prime.reduce(sum))));
        }
    }

    /// Whether the rows that were passed over depend on the others. If a null vector tells that some do not, these are reduced,
    /// and so on. `basis` is given all vectors of a basis of the null space, each one at one of the columns without a pivot,
    /// and zero at the others. False if there was no time.
    pub(super) fn prove(&mut self, mut basis: Option<&mut Rows>, control: &Control) -> Result<bool, Error> {
        'again: loop {
            if self.skipped.is_empty() && basis.is_none() {
                return Ok(true);
            }
            let pivots = self.pivots()?;
            let free: Vec<usize> = (0..self.n_columns).filter(|&column| !pivots[column]).collect();
            if let Some(basis) = &mut basis {
                basis.clear();
            }
            let mut vectors = filled(self.n_columns, [0; VECTORS])?;
            for free in free.chunks(VECTORS) {
                if control.look_at_clock().is_some() {
                    return Ok(false);
                }
                vectors.fill([0; VECTORS]);
                for (vector, &column) in free.iter().enumerate() {
                    vectors[column][vector] = 1;
                }
                self.complete(&mut vectors);
                let skipped = std::mem::take(&mut self.skipped);
                let (dependent, independent): (_, Vec<u32>) =
                    skipped.into_iter().partition(|&row| self.products(row, &vectors) == [0; VECTORS]);
                self.skipped = dependent;
                if !independent.is_empty() {
                    if self.work_off(independent, usize::MAX, control)? == End::Stopped {
                        return Ok(false);
                    }
                    continue 'again;
                }
                let Some(basis) = &mut basis else { continue };
                for vector in 0..free.len() {
                    for (column, values) in vectors.iter().enumerate().filter(|(_, values)| values[vector] != 0) {
                        basis.push(column, values[vector])?;
                    }
                    basis.end_row();
                }
            }
            return Ok(true);
        }
    }

    /// The echelon form.
    pub(super) fn echelon_form(&mut self) -> Result<Rows, Error> {
        let mut form = Rows::new();
        for pivot in 0..self.n_columns {
            let Some(entries) = self.echelon.right_of(pivot) else { continue };
            form.push(pivot, 1)?;
            for (column, residue) in entries {
                form.push(column, residue)?;
            }
            form.end_row();
        }
        if let Some(Rest { dense, columns }) = &mut self.rest {
            dense.end_block()?;
            dense.write(columns, &mut form)?;
        }
        Ok(form)
    }

    /// Random residues, not zero: the generator of Steele, Lea and Flood (2014).
    fn random_residue(&mut self) -> u64 {
        self.random = self.random.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.random;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        self.prime.nonzero_residue(bits ^ (bits >> 31))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Five rows of rank four, of which the test for dependence should have passed over one.
    #[test]
    fn rows_passed_over_by_accident_are_reduced() {
        let prime = Prime::new(101).unwrap();
        let mut rows = Rows::new();
        for first in [0, 1, 2, 3, 1] {
            rows.push(first, 1).unwrap();
            rows.push(first + 1, 100).unwrap();
            rows.end_row();
        }
        let mut elimination = Elimination::new(prime, &rows, 5).unwrap();
        elimination.skipped = vec![0, 1, 2, 3, 4];
        let mut basis = Rows::new();
        assert!(elimination.prove(Some(&mut basis), &Control::default()).unwrap());
        assert_eq!((elimination.rank(), basis.len()), (4, 1));
        assert_eq!(basis.row(0), (&[0, 1, 2, 3, 4][..], &[1; 5][..]));
    }

    /// Its only null vector that tells so is in the third group of sixteen, when a part of the basis is written.
    #[test]
    fn basis_is_written_anew_when_a_row_was_passed_over_by_accident() {
        let prime = Prime::new(101).unwrap();
        let mut rows = Rows::new();
        rows.push(39, 1).unwrap();
        rows.end_row();
        let mut elimination = Elimination::new(prime, &rows, 40).unwrap();
        elimination.skipped = vec![0];
        let mut basis = Rows::new();
        assert!(elimination.prove(Some(&mut basis), &Control::default()).unwrap());
        assert_eq!(basis.columns, (0..39).collect::<Vec<_>>());
    }
}
