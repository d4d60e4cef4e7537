//! Exact linear algebra modulo a prime: rank and null space of large sparse matrices.
//!
//! The columns of the matrices in mind are monomials, the rows equations for their coefficients: five to sixty entries in
//! a row, more rows than columns, a null space of small dimension. What is said modulo p holds over the rationals in one
//! direction: the rank modulo p is at most the rank, the dimension of the null space at least that over the rationals.
//!
//! # How
//! 1. A row that is the first to have its first entry in a column needs no reduction: it is a row of the echelon form as
//!    it is (Faugère and Lachartre 2010). Columns are read from the left or from the right, whichever gives more of these.
//! 2. The other rows are reduced one after the other, each in a vector of all columns (the algorithm of Gilbert and Peierls,
//!    as in SpaSM, Bouillaguet and Delaplace 2016), until its first entry has no pivot above it. What follows this entry
//!    stays as it is.
//! 3. When new rows have filled up, the columns that are left are dense, and sixteen rows are subtracted at once. If there
//!    are more rows than columns, their random sums go first (Bouillaguet, Delaplace and Voge 2017).
//! 4. Reductions to zero are most of the work where there are more rows than columns. When they have cost more than a test
//!    of all rows by random null vectors, the test is made, and only rows that are surely independent are reduced.
//! 5. The null space of the rows that were reduced is computed, and the rows that were not are multiplied by all of it. So
//!    the result does not depend on luck.
//! 6. The basis is brought to the form that does not depend on what came before: its free columns are those that the
//!    elimination from left to right leaves without a pivot. Bases modulo several primes can then be combined.
//!
//! The order of the columns decides how many rows need no reduction. For the derivation `x'.grad` of a field with a linear
//! and a quadratic part, monomials of low degree should come first, and each degree in lexicographic order: the quadratic
//! part raises the degree by one and has nearly all pivots.
//!
//! A call works on one thread; several primes can have one thread each.
//!
//! # References
//! - J.-C. Faugère, S. Lachartre, *Parallel Gaussian elimination for Gröbner bases computations in finite fields*, PASCO 2010.
//! - C. Bouillaguet, C. Delaplace, *Sparse Gaussian elimination modulo p: an update*, CASC 2016.
//! - C. Bouillaguet, C. Delaplace, M.-E. Voge, *Parallel sparse PLUQ factorization modulo p*, PASCO 2017.
//!
//! ```
//! use liepoisson_core::ensemble::Control;
//! use liepoisson_core::modular::{Matrix, null_space};
//!
//! // x + 2 y + 3 z = 0, 2 x + 4 y + 7 z = 0
//! let matrix =
//!     Matrix { starts: &[0, 3, 6], columns: &[0, 1, 2, 0, 1, 2], residues: &[1, 2, 3, 2, 4, 7], n_columns: 3 };
//! let space = null_space(&matrix, 101, None, &Control::default(), |_| ())?;
//! assert_eq!((space.pivots, space.free), (vec![0, 2], vec![1]));
//! let basis = space.basis.unwrap();
//! assert_eq!((basis.columns, basis.residues), (vec![0, 1], vec![101 - 2, 1]));
//! # Ok::<(), liepoisson_core::error::Error>(())
//! ```

mod dense;
mod echelon;
mod elimination;
mod prime;
mod reduced;
mod rows;

pub use rows::Rows;

use crate::ensemble::{Control, beside};
use crate::error::Error;
use echelon::filled;
use elimination::{Elimination, End};
use prime::Prime;
use reduced::Reduced;
use std::time::Duration;

/// The most columns that a matrix may have.
pub const MOST_COLUMNS: usize = 1 << 22;

/// A sparse matrix, row by row. Entries of equal place are added.
#[derive(Clone, Copy, Debug)]
pub struct Matrix<'a> {
    /// Where each row begins in the entries, and the end.
    pub starts: &'a [u64],
    /// Column of each entry.
    pub columns: &'a [u32],
    /// The entries, of which the residues modulo the prime are taken.
    pub residues: &'a [u64],
    /// Number of columns.
    pub n_columns: usize,
}

impl Matrix<'_> {
    /// Checks that the parts fit together.
    ///
    /// # Errors
    /// Starts that do not begin with 0, descend, or do not end with the number of entries; arrays of different lengths;
    /// columns that are not there; more than [`MOST_COLUMNS`] columns.
    pub fn check(&self) -> Result<(), Error> {
        let n_entries = self.columns.len();
        if self.n_columns > MOST_COLUMNS {
            return Err(Error::MatrixColumns { got: self.n_columns });
        }
        if self.residues.len() != n_entries {
            return Err(Error::MatrixEntries { wanted: n_entries, got: self.residues.len() });
        }
        let ascend = self.starts.windows(2).all(|pair| pair[0] <= pair[1]);
        if !ascend || self.starts.first() != Some(&0) || self.starts.last() != Some(&(n_entries as u64)) {
            return Err(Error::MatrixStarts { n_entries });
        }
        match self.columns.iter().position(|&column| column as usize >= self.n_columns) {
            Some(entry) => {
                Err(Error::MatrixColumn { entry, n_columns: self.n_columns, got: self.columns[entry] as usize })
            }
            None => Ok(()),
        }
    }
}

/// Rank and null space of a matrix modulo a prime.
#[derive(Clone, Debug, PartialEq)]
pub struct NullSpace {
    /// The rank, or what is known of it if the end came before: a lower bound.
    pub rank: usize,
    /// The columns, ascending, that are no combinations of columns before them. Where `basis` is absent: independent columns,
    /// as many as `rank` says.
    pub pivots: Vec<u32>,
    /// The other columns, ascending.
    pub free: Vec<u32>,
    /// A vector for each free column, in this order: one there, zero at the other free columns. Absent if the elimination
    /// ended before all rows were seen.
    pub basis: Option<Rows>,
}

/// Rank and null space of a matrix modulo an odd prime below 2^62.
///
/// With `enough_rank` the elimination ends at this rank: who knows so many independent null vectors that the rank cannot be
/// larger has all of them. It ends, too, when `control` says so. `watch` runs on the calling thread meanwhile: the function
/// that it is given waits for the end, at most so long, and says whether it has come.
///
/// # Errors
/// See [`Matrix::check`]; a number that is no odd prime below 2^62; no memory, no thread.
///
/// # Panics
/// As the elimination does, which would be a mistake in it.
pub fn null_space(
    matrix: &Matrix<'_>,
    prime: u64,
    enough_rank: Option<usize>,
    control: &Control,
    watch: impl FnOnce(&dyn Fn(Duration) -> bool),
) -> Result<NullSpace, Error> {
    matrix.check()?;
    let prime = Prime::new(prime)?;
    beside(control, watch, || solve(matrix, prime, enough_rank.unwrap_or(usize::MAX), control))?
}

fn solve(matrix: &Matrix<'_>, prime: Prime, enough: usize, control: &Control) -> Result<NullSpace, Error> {
    let n_columns = matrix.n_columns;
    let position = positions(matrix)?;
    let rows = Rows::cleaned(matrix, prime, &position)?;
    let mut elimination = Elimination::new(prime, &rows, n_columns)?;
    let mut is_complete = elimination.run(enough, control)? == End::Exhausted;
    // the smaller one of row space and null space is brought to the form that does not depend on the order of work
    let from_null_space = 2 * elimination.rank() >= n_columns;
    let mut vectors = Rows::new();
    is_complete = is_complete && elimination.prove(from_null_space.then_some(&mut vectors), control)?;
    let form = match (is_complete, from_null_space) {
        (false, _) => None,
        (true, true) => Reduced::of(prime, &moved(&vectors, prime, &position, true)?, n_columns, control)?,
        (true, false) => {
            vectors = elimination.echelon_form()?;
            Reduced::of(prime, &moved(&vectors, prime, &position, false)?, n_columns, control)?
        }
    };
    let mut is_pivot = filled(n_columns, false)?;
    match &form {
        Some(form) if from_null_space => {
            is_pivot.fill(true);
            form.pivots.iter().for_each(|&place| is_pivot[n_columns - 1 - place as usize] = false);
        }
        Some(form) => form.pivots.iter().for_each(|&column| is_pivot[column as usize] = true),
        None => {
            let has_pivot = elimination.pivots()?;
            (0..n_columns).for_each(|column| is_pivot[column] = has_pivot[position[column] as usize]);
        }
    }
    let (pivots, free) = (0..n_columns as u32).partition::<Vec<u32>, _>(|&column| is_pivot[column as usize]);
    let basis = match form {
        Some(form) if from_null_space => Some(turned(&form, n_columns)?),
        Some(form) => Some(transposed(&form, &free, prime)?),
        None => None,
    };
    Ok(NullSpace { rank: pivots.len(), pivots, free, basis })
}

/// Where each column goes: those that are first in a row come first, in their order, from the left or from the right.
fn positions(matrix: &Matrix<'_>) -> Result<Vec<u32>, Error> {
    let n_columns = matrix.n_columns;
    let mut is_first = [filled(n_columns, false)?, filled(n_columns, false)?];
    for ends in matrix.starts.windows(2) {
        let row = &matrix.columns[ends[0] as usize..ends[1] as usize];
        if let (Some(&least), Some(&most)) = (row.iter().min(), row.iter().max()) {
            is_first[0][least as usize] = true;
            is_first[1][most as usize] = true;
        }
    }
    let [n_left, n_right] = [0, 1].map(|side| is_first[side].iter().filter(|&&is_first| is_first).count());
    let side = usize::from(n_right > n_left);
    let mut position = filled(n_columns, 0)?;
    let mut next = 0;
    for wanted in [true, false] {
        for column in 0..n_columns {
            let column = if side == 1 { n_columns - 1 - column } else { column };
            if is_first[side][column] == wanted {
                position[column] = next;
                next += 1;
            }
        }
    }
    Ok(position)
}

/// Rows with their columns where they belong, or, `from_right`, column `n - 1 - k` at `k`.
fn moved(rows: &Rows, prime: Prime, position: &[u32], from_right: bool) -> Result<Rows, Error> {
    let n_columns = position.len();
    let mut place = filled(n_columns, 0)?;
    for (column, &position) in position.iter().enumerate() {
        place[position as usize] = if from_right { n_columns - 1 - column } else { column } as u32;
    }
    let matrix = Matrix { starts: &rows.starts, columns: &rows.columns, residues: &rows.residues, n_columns };
    Rows::cleaned(&matrix, prime, &place)
}

/// The basis of the null space, given its reduced echelon form from the right. The last entry of a null vector is at a column
/// that depends on columns before it, so the pivots of this form are the free columns.
fn turned(form: &Reduced, n_columns: usize) -> Result<Rows, Error> {
    let mut basis = Rows::new();
    for row in (0..form.rows.len()).rev() {
        let (columns, residues) = form.rows.row(row);
        for (&place, &residue) in columns.iter().zip(residues).rev() {
            basis.push(n_columns - 1 - place as usize, residue)?;
        }
        basis.push(n_columns - 1 - form.pivots[row] as usize, 1)?;
        basis.end_row();
    }
    Ok(basis)
}

/// The basis of the null space, given the reduced echelon form of the row space: `v_f = e_f - sum r_if e_i` over the pivots i.
fn transposed(form: &Reduced, free: &[u32], prime: Prime) -> Result<Rows, Error> {
    let mut entries = Vec::new();
    entries
        .try_reserve_exact(form.rows.columns.len())
        .map_err(|_| Error::Memory { bytes: 16 * form.rows.columns.len() })?;
    for (row, &pivot) in form.pivots.iter().enumerate() {
        entries.extend(form.rows.entries(row).map(|(column, residue)| (column as u32, pivot, prime.negative(residue))));
    }
    entries.sort_unstable();
    let mut basis = Rows::new();
    let mut entries = entries.into_iter().peekable();
    for &free in free {
        while let Some((_, pivot, residue)) = entries.next_if(|entry| entry.0 == free) {
            basis.push(pivot as usize, residue)?;
        }
        basis.push(free as usize, 1)?;
        basis.end_row();
    }
    Ok(basis)
}
