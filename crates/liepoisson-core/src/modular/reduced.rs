//! Reduced echelon forms.

use super::echelon::Echelon;
use super::prime::Prime;
use super::rows::Rows;
use crate::ensemble::Control;
use crate::error::Error;
use std::cmp::Reverse;

/// A reduced echelon form: the pivots, ascending, and what stands right of each, which is zero at the other pivots.
pub(super) struct Reduced {
    pub(super) pivots: Vec<u32>,
    pub(super) rows: Rows,
}

impl Reduced {
    /// The reduced echelon form of rows, if there is time for it.
    pub(super) fn of(prime: Prime, rows: &Rows, n_columns: usize, control: &Control) -> Result<Option<Reduced>, Error> {
        let mut queue: Vec<usize> = (0..rows.len()).filter(|&row| !rows.row(row).0.is_empty()).collect();
        queue.sort_by_cached_key(|&row| {
            let columns = rows.row(row).0;
            (Reverse(columns[0]), columns.len(), row)
        });
        let mut echelon = Echelon::new(prime, n_columns)?;
        for row in queue {
            if control.look_at_clock().is_some() {
                return Ok(None);
            }
            echelon.add(rows.entries(row), prime.scaled(1));
            echelon.absorb()?;
        }
        // from the last row up, so that each is reduced by rows that are reduced already
        let mut reduced = Echelon::new(prime, n_columns)?;
        let mut entries = Vec::new();
        for pivot in (0..n_columns).rev() {
            let Some(right) = echelon.right_of(pivot) else { continue };
            if control.look_at_clock().is_some() {
                return Ok(None);
            }
            reduced.add(right, prime.scaled(1));
            entries.clear();
            reduced.reduce(|column, residue| entries.push((column, residue)));
            reduced.push(pivot, &entries)?;
        }
        let pivots: Vec<u32> =
            (0..n_columns).filter(|&column| reduced.has_pivot(column)).map(|column| column as u32).collect();
        let mut rows = Rows::new();
        for &pivot in &pivots {
            for (column, residue) in reduced.right_of(pivot as usize).into_iter().flatten() {
                rows.push(column, residue)?;
            }
            rows.end_row();
        }
        Ok(Some(Reduced { pivots, rows }))
    }
}
