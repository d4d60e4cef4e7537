//! The echelon form of what is left when sparse rows have filled up: dense rows in the columns without a pivot.
//!
//! Sixteen rows make a block. A further row is reduced by a whole block at once: each of its entries gets a sum of sixteen
//! products and one reduction.

use super::echelon::filled;
use super::prime::Prime;
use super::rows::Rows;
use crate::error::Error;

const NONE: u32 = u32::MAX;

/// Rows of a block.
const BLOCK: usize = 16;

/// Vectors side by side.
pub(super) const VECTORS: usize = 16;

/// Sixteen rows, each one at its own pivot and zero at those of the others and of earlier blocks.
struct Block {
    pivots: [u32; BLOCK],
    /// The other columns, and the entries of all rows there.
    columns: Vec<u32>,
    lines: Vec<[u64; BLOCK]>,
}

/// Dense rows in echelon form.
pub(super) struct Dense {
    prime: Prime,
    n_columns: usize,
    blocks: Vec<Block>,
    /// Rows that do not make a block yet, with their pivots, each zero at the pivots of the others.
    pending: Vec<(usize, Vec<u64>)>,
    is_pivot: Vec<bool>,
    rank: usize,
    /// Products so far.
    pub(super) work: u64,
}

impl Dense {
    pub(super) fn new(prime: Prime, n_columns: usize) -> Result<Dense, Error> {
        let is_pivot = filled(n_columns, false)?;
        Ok(Dense { prime, n_columns, blocks: Vec::new(), pending: Vec::new(), is_pivot, rank: 0, work: 0 })
    }

    pub(super) fn rank(&self) -> usize {
        self.rank
    }

    pub(super) fn has_pivot(&self, column: usize) -> bool {
        self.is_pivot[column]
    }

    /// Products that one vector costs.
    pub(super) fn n_entries(&self) -> u64 {
        self.blocks.iter().map(|block| (BLOCK * block.lines.len()) as u64).sum::<u64>()
            + (self.pending.len() * self.n_columns) as u64
    }

    /// Reduces a row, which becomes a row of the echelon form if anything is left. Whether there is.
    pub(super) fn absorb(&mut self, mut row: Vec<u64>) -> Result<bool, Error> {
        let prime = self.prime;
        for block in &self.blocks {
            self.work += block.subtract(prime, &mut row);
        }
        for (pivot, other) in &self.pending {
            subtract(prime, &mut row, *pivot, other);
        }
        self.work += (self.pending.len() * self.n_columns) as u64;
        let Some(pivot) = row.iter().position(|&residue| residue != 0) else { return Ok(false) };
        let inverse = prime.scaled(prime.inverse(row[pivot]));
        for residue in &mut row {
            *residue = prime.product(*residue, inverse);
        }
        for (_, other) in &mut self.pending {
            subtract(prime, other, pivot, &row);
        }
        self.pending.push((pivot, row));
        self.rank += 1;
        if self.pending.len() == BLOCK {
            self.end_block()?;
        }
        Ok(true)
    }

    /// Makes a block of the rows that are pending.
    pub(super) fn end_block(&mut self) -> Result<(), Error> {
        if self.pending.is_empty() {
            return Ok(());
        }
        let pending = std::mem::take(&mut self.pending);
        let mut pivots = [NONE; BLOCK];
        for (t, (pivot, _)) in pending.iter().enumerate() {
            pivots[t] = *pivot as u32;
            self.is_pivot[*pivot] = true;
        }
        let columns: Vec<u32> = (0..self.n_columns as u32).filter(|&column| !self.is_pivot[column as usize]).collect();
        let mut lines = filled(columns.len(), [0; BLOCK])?;
        for (line, &column) in lines.iter_mut().zip(&columns) {
            for (entry, (_, row)) in line.iter_mut().zip(&pending) {
                *entry = row[column as usize];
            }
        }
        self.blocks.push(Block { pivots, columns, lines });
        Ok(())
    }

    /// Writes the rows, whose columns are `names`. No rows are pending.
    pub(super) fn write(&self, names: &[u32], rows: &mut Rows) -> Result<(), Error> {
        debug_assert!(self.pending.is_empty());
        for block in &self.blocks {
            for (t, &pivot) in block.pivots.iter().enumerate().filter(|(_, pivot)| **pivot != NONE) {
                rows.push(names[pivot as usize] as usize, 1)?;
                for (line, &column) in block.lines.iter().zip(&block.columns).filter(|(line, _)| line[t] != 0) {
                    rows.push(names[column as usize] as usize, line[t])?;
                }
                rows.end_row();
            }
        }
        Ok(())
    }

    /// Gives vectors the values at the pivots with which they are null vectors; the values elsewhere are given. No rows are
    /// pending.
    pub(super) fn complete(&self, values: &mut [[u64; VECTORS]]) {
        debug_assert!(self.pending.is_empty());
        let prime = self.prime;
        for block in self.blocks.iter().rev() {
            let mut sums = [[0; VECTORS]; BLOCK];
            for (line, &column) in block.lines.iter().zip(&block.columns) {
                for (sums, &entry) in sums.iter_mut().zip(line) {
                    for (sum, &value) in sums.iter_mut().zip(&values[column as usize]) {
                        *sum = prime.add_product(*sum, entry, value);
                    }
                }
            }
            for (&pivot, sums) in block.pivots.iter().zip(sums).filter(|(pivot, _)| **pivot != NONE) {
                values[pivot as usize] = sums.map(|sum| prime.negative(prime.scaled(prime.reduce(sum))));
            }
        }
    }
}

/// Subtracts the multiple of `other`, which is one at `pivot`, that makes `row` zero there.
fn subtract(prime: Prime, row: &mut [u64], pivot: usize, other: &[u64]) {
    if row[pivot] != 0 {
        let scaled = prime.scaled(prime.negative(row[pivot]));
        for (residue, &entry) in row.iter_mut().zip(other) {
            *residue = prime.add(*residue, prime.product(entry, scaled));
        }
    }
}

impl Block {
    /// Makes a row zero at the pivots. Returns the number of products.
    fn subtract(&self, prime: Prime, row: &mut [u64]) -> u64 {
        let mut factors = [0; BLOCK];
        for (factor, &pivot) in factors.iter_mut().zip(&self.pivots).filter(|(_, pivot)| **pivot != NONE) {
            let residue = std::mem::take(&mut row[pivot as usize]);
            *factor = prime.scaled(prime.negative(residue));
        }
        if factors == [0; BLOCK] {
            return 0;
        }
        for (line, &column) in self.lines.iter().zip(&self.columns) {
            let sum = line.iter().zip(&factors).map(|(&entry, &factor)| u128::from(entry) * u128::from(factor)).sum();
            let residue = &mut row[column as usize];
            *residue = prime.add(*residue, prime.reduce_16(sum));
        }
        (BLOCK * self.lines.len()) as u64
    }
}
