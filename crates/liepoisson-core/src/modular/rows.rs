//! Sparse rows, one after the other.

use super::Matrix;
use super::prime::Prime;
use crate::error::Error;

/// Rows of columns and residues.
#[derive(Clone, Debug, PartialEq)]
pub struct Rows {
    /// Where each row begins, and the end.
    pub starts: Vec<u64>,
    /// Columns, ascending within a row.
    pub columns: Vec<u32>,
    /// Residues, none zero.
    pub residues: Vec<u64>,
}

impl Default for Rows {
    fn default() -> Rows {
        Rows::new()
    }
}

impl Rows {
    pub(super) fn new() -> Rows {
        Rows { starts: vec![0], columns: Vec::new(), residues: Vec::new() }
    }

    pub(super) fn clear(&mut self) {
        *self = Rows::new();
    }

    pub(super) fn len(&self) -> usize {
        self.starts.len() - 1
    }

    pub(super) fn n_entries(&self) -> u64 {
        self.columns.len() as u64
    }

    pub(super) fn row(&self, row: usize) -> (&[u32], &[u64]) {
        let range = self.starts[row] as usize..self.starts[row + 1] as usize;
        (&self.columns[range.clone()], &self.residues[range])
    }

    pub(super) fn entries(&self, row: usize) -> impl Iterator<Item = (usize, u64)> {
        let (columns, residues) = self.row(row);
        columns.iter().map(|&column| column as usize).zip(residues.iter().copied())
    }

    /// An entry more in the row that is being written.
    pub(super) fn push(&mut self, column: usize, residue: u64) -> Result<(), Error> {
        let refused = |bytes| move |_| Error::Memory { bytes };
        self.columns.try_reserve(1).map_err(refused(8 * self.columns.len()))?;
        self.residues.try_reserve(1).map_err(refused(16 * self.residues.len()))?;
        self.columns.push(column as u32);
        self.residues.push(residue);
        Ok(())
    }

    /// Ends the row that was being written.
    pub(super) fn end_row(&mut self) {
        self.starts.push(self.columns.len() as u64);
    }

    /// The rows of a matrix that are not zero, their columns moved to `position`; equal columns are added.
    pub(super) fn cleaned(matrix: &Matrix<'_>, prime: Prime, position: &[u32]) -> Result<Rows, Error> {
        let mut rows = Rows::new();
        let mut row: Vec<(u32, u64)> = Vec::new();
        for ends in matrix.starts.windows(2) {
            let range = ends[0] as usize..ends[1] as usize;
            let columns = matrix.columns[range.clone()].iter().map(|&column| position[column as usize]);
            row.clear();
            row.extend(columns.zip(matrix.residues[range].iter().map(|&residue| prime.residue(residue))));
            row.sort_unstable_by_key(|&(column, _)| column);
            let n_before = rows.columns.len();
            for equal in row.chunk_by(|first, second| first.0 == second.0) {
                let residue = equal.iter().fold(0, |sum, &(_, residue)| prime.add(sum, residue));
                if residue != 0 {
                    rows.push(equal[0].0 as usize, residue)?;
                }
            }
            if rows.columns.len() > n_before {
                rows.end_row();
            }
        }
        Ok(rows)
    }
}
