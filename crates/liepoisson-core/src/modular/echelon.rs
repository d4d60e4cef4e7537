//! Sparse rows in echelon form, each with its pivot in its first column, and the reduction of a further row by them.

use super::prime::Prime;
use super::rows::Rows;
use crate::error::Error;

const NONE: u32 = u32::MAX;

/// Rows with distinct first columns, and one row that is being reduced.
pub(super) struct Echelon {
    prime: Prime,
    /// What stands right of the pivots, which are one; a row may have entries at pivots of others.
    rows: Rows,
    /// The row that has its pivot in a column.
    row_of: Vec<u32>,
    /// The row that is being reduced: sums of products, and which of them may not be zero.
    sums: Vec<u128>,
    marked: Vec<u64>,
    /// The first word of `marked` that may not be zero.
    first: usize,
    /// Products so far.
    pub(super) work: u64,
}

/// `n` copies, or a refusal.
pub(super) fn filled<T: Clone>(n: usize, with: T) -> Result<Vec<T>, Error> {
    let mut numbers = Vec::new();
    numbers.try_reserve_exact(n).map_err(|_| Error::Memory { bytes: n.saturating_mul(size_of::<T>()) })?;
    numbers.resize(n, with);
    Ok(numbers)
}

impl Echelon {
    pub(super) fn new(prime: Prime, n_columns: usize) -> Result<Echelon, Error> {
        Ok(Echelon {
            prime,
            rows: Rows::new(),
            row_of: filled(n_columns, NONE)?,
            sums: filled(n_columns, 0)?,
            marked: filled(n_columns.div_ceil(64), 0)?,
            first: 0,
            work: 0,
        })
    }

    pub(super) fn rank(&self) -> usize {
        self.rows.len()
    }

    pub(super) fn n_entries(&self) -> u64 {
        self.rows.n_entries()
    }

    pub(super) fn has_pivot(&self, column: usize) -> bool {
        self.row_of[column] != NONE
    }

    /// What stands right of the pivot in a column.
    pub(super) fn right_of(&self, pivot: usize) -> Option<impl Iterator<Item = (usize, u64)>> {
        let row = self.row_of[pivot];
        (row != NONE).then(|| self.rows.entries(row as usize))
    }

    /// Length of the newest row.
    pub(super) fn newest_length(&self) -> usize {
        self.rows.row(self.rank() - 1).0.len()
    }

    /// Adds a multiple of a row to the row that is being reduced.
    pub(super) fn add(&mut self, row: impl Iterator<Item = (usize, u64)>, scaled: u64) {
        let Echelon { prime, sums, marked, first, work, .. } = self;
        for (column, residue) in row {
            sums[column] = prime.add_product(sums[column], residue, scaled);
            marked[column / 64] |= 1 << (column % 64);
            *first = (*first).min(column / 64);
            *work += 1;
        }
    }

    /// Takes the first entry of the row that is being reduced.
    fn take_first(&mut self) -> Option<(usize, u64)> {
        while let Some(&word) = self.marked.get(self.first) {
            if word == 0 {
                self.first += 1;
                continue;
            }
            let column = 64 * self.first + word.trailing_zeros() as usize;
            self.marked[self.first] = word & (word - 1);
            let residue = self.prime.reduce(std::mem::take(&mut self.sums[column]));
            if residue != 0 {
                return Some((column, residue));
            }
        }
        None
    }

    /// Subtracts a multiple of a row from the row that is being reduced.
    fn subtract(&mut self, row: u32, residue: u64) {
        let Echelon { prime, rows, sums, marked, work, .. } = self;
        let scaled = prime.scaled(prime.negative(residue));
        let (columns, residues) = rows.row(row as usize);
        for (&column, &residue) in columns.iter().zip(residues) {
            let column = column as usize;
            sums[column] = prime.add_product(sums[column], residue, scaled);
            marked[column / 64] |= 1 << (column % 64);
        }
        *work += columns.len() as u64;
    }

    /// Reduces until the first entry has no pivot above it; the row is then a row of the echelon form. Whether there is
    /// such an entry.
    pub(super) fn absorb(&mut self) -> Result<bool, Error> {
        while let Some((column, residue)) = self.take_first() {
            match self.row_of[column] {
                NONE => {
                    let scaled = self.prime.scaled(self.prime.inverse(residue));
                    // entries further right stay as they are: this keeps rows sparse
                    while let Some((column, residue)) = self.take_first() {
                        self.rows.push(column, self.prime.product(residue, scaled))?;
                    }
                    self.row_of[column] = self.rank() as u32;
                    self.rows.end_row();
                    return Ok(true);
                }
                row => self.subtract(row, residue),
            }
        }
        Ok(false)
    }

    /// Reduces by all rows; hands what is left to `take`.
    pub(super) fn reduce(&mut self, mut take: impl FnMut(usize, u64)) {
        while let Some((column, residue)) = self.take_first() {
            match self.row_of[column] {
                NONE => take(column, residue),
                row => self.subtract(row, residue),
            }
        }
    }

    /// Makes a row of what stands right of a pivot.
    pub(super) fn push(&mut self, pivot: usize, entries: &[(usize, u64)]) -> Result<(), Error> {
        self.row_of[pivot] = self.rank() as u32;
        for &(column, residue) in entries {
            self.rows.push(column, residue)?;
        }
        self.rows.end_row();
        Ok(())
    }
}
