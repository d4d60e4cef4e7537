//! Null spaces modulo a prime against elimination of dense matrices as it is written in textbooks.

use liepoisson_core::ensemble::Control;
use liepoisson_core::error::Error;
use liepoisson_core::modular::{MOST_COLUMNS, Matrix, NullSpace, Rows, null_space};
use proptest::prelude::*;
use std::time::Duration;

const PRIMES: [u64; 6] = [3, 5, 101, 65_537, (1 << 61) - 1, (1 << 62) - 57];

/// Rows of columns and entries.
type Entries = Vec<Vec<(u32, u64)>>;

/// A matrix that owns its parts.
#[derive(Clone, Debug)]
struct Sparse {
    rows: Rows,
    n_columns: usize,
}

impl Sparse {
    fn new(entries: &Entries, n_columns: usize) -> Sparse {
        let mut rows = Rows::default();
        for row in entries {
            rows.columns.extend(row.iter().map(|entry| entry.0));
            rows.residues.extend(row.iter().map(|entry| entry.1));
            rows.starts.push(rows.columns.len() as u64);
        }
        Sparse { rows, n_columns }
    }

    fn matrix(&self) -> Matrix<'_> {
        let Rows { starts, columns, residues } = &self.rows;
        Matrix { starts, columns, residues, n_columns: self.n_columns }
    }

    fn null_space(&self, prime: u64) -> NullSpace {
        null_space(&self.matrix(), prime, None, &Control::default(), |_| ()).unwrap()
    }
}

fn product(a: u64, b: u64, p: u64) -> u64 {
    if p < 1 << 32 { a * b % p } else { (u128::from(a) * u128::from(b) % u128::from(p)) as u64 }
}

fn power(a: u64, exponent: u64, p: u64) -> u64 {
    (0..64).rev().fold(1, |result, bit| {
        let square = product(result, result, p);
        if exponent >> bit & 1 == 1 { product(square, a, p) } else { square }
    })
}

/// The same from the reduced echelon form of a dense matrix.
fn by_definition(entries: &Entries, n_columns: usize, p: u64) -> NullSpace {
    let mut matrix = vec![vec![0; n_columns]; entries.len()];
    for (dense, row) in matrix.iter_mut().zip(entries) {
        for &(column, entry) in row {
            dense[column as usize] = (dense[column as usize] + entry % p) % p;
        }
    }
    let mut pivots = Vec::new();
    for column in 0..n_columns {
        let Some(row) = (pivots.len()..matrix.len()).find(|&row| matrix[row][column] != 0) else { continue };
        matrix.swap(row, pivots.len());
        let inverse = power(matrix[pivots.len()][column], p - 2, p);
        let pivot: Vec<u64> = matrix[pivots.len()].iter().map(|&entry| product(entry, inverse, p)).collect();
        for row in matrix.iter_mut().filter(|row| row[column] != 0) {
            let factor = p - row[column];
            for (entry, &other) in row.iter_mut().zip(&pivot) {
                *entry = (*entry + product(factor, other, p)) % p;
            }
        }
        matrix[pivots.len()] = pivot;
        pivots.push(column as u32);
    }
    let free: Vec<u32> = (0..n_columns as u32).filter(|column| !pivots.contains(column)).collect();
    let vector = |&free: &u32| {
        let entry = |(row, &pivot): (usize, &u32)| (pivot, (p - matrix[row][free as usize]) % p);
        let mut vector: Vec<(u32, u64)> = pivots.iter().enumerate().map(entry).filter(|entry| entry.1 != 0).collect();
        vector.push((free, 1));
        vector.sort_unstable();
        vector
    };
    let basis = Sparse::new(&free.iter().map(vector).collect(), n_columns).rows;
    NullSpace { rank: pivots.len(), pivots, free, basis: Some(basis) }
}

fn agrees(entries: &Entries, n_columns: usize, p: u64) -> Result<(), TestCaseError> {
    let (found, wanted) = (Sparse::new(entries, n_columns).null_space(p), by_definition(entries, n_columns, p));
    prop_assert_eq!(found, wanted);
    Ok(())
}

/// Random numbers from a seed.
fn numbers(seed: u64) -> impl FnMut(u64) -> u64 {
    let mut state = seed;
    move |below| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((u128::from(state) * u128::from(below)) >> 64) as u64
    }
}

/// Rows with `per_row` entries in random columns, small numbers and large ones.
fn random_rows(n_rows: usize, n_columns: usize, per_row: usize, seed: u64) -> Entries {
    let mut below = numbers(seed);
    let mut entry = |_| (below(n_columns as u64) as u32, if below(2) == 0 { 1 + below(3) } else { below(u64::MAX) });
    (0..n_rows).map(|_| (0..per_row).map(&mut entry).collect()).collect()
}

/// Sums of random multiples of rows, among the rows themselves: so many of the result as there were before are independent.
fn with_sums_of_rows(rows: &Entries, n_sums: usize, p: u64, seed: u64) -> Entries {
    let mut below = numbers(seed);
    let sums = (0..n_sums).map(|_| {
        let mut sum = Vec::new();
        for _ in 0..3 {
            let (row, factor) = (&rows[below(rows.len() as u64) as usize], below(p));
            sum.extend(row.iter().map(|&(column, entry)| (column, product(entry % p, factor, p))));
        }
        sum
    });
    let mut all: Entries = rows.iter().cloned().chain(sums).collect();
    for place in (1..all.len()).rev() {
        all.swap(place, below(place as u64 + 1) as usize);
    }
    all
}

proptest! {
    /// Zero rows, equal rows, equal columns of a row, entries that cancel: small matrices have them all.
    #[test]
    fn small_matrices(
        which in 0usize..PRIMES.len(),
        n_columns in 1usize..12,
        rows in prop::collection::vec(prop::collection::vec((0u32..100, prop_oneof![0u64..4, any::<u64>()]), 0..6), 0..12),
    ) {
        let entries = rows.into_iter().map(|row| row.into_iter().map(|(c, e)| (c % n_columns as u32, e)).collect()).collect();
        agrees(&entries, n_columns, PRIMES[which])?;
    }

    #[test]
    fn sparse_matrices_of_middle_size(
        which in 0usize..PRIMES.len(), n_rows in 1usize..60, n_columns in 1usize..60, per_row in 1usize..8, seed in any::<u64>(),
    ) {
        agrees(&random_rows(n_rows, n_columns, per_row, seed), n_columns, PRIMES[which])?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Rows that fill up, so that dense ones follow, and many rows that depend on others, so that these are passed over.
    #[test]
    fn sparse_matrices_that_fill_up(
        which in 0usize..PRIMES.len(),
        n_rows in 100usize..160,
        n_columns in 120usize..180,
        per_row in 6usize..9,
        n_sums in 0usize..300,
        seed in any::<u64>(),
    ) {
        let rows = random_rows(n_rows, n_columns, per_row, seed);
        agrees(&with_sums_of_rows(&rows, n_sums, PRIMES[which], seed ^ 1), n_columns, PRIMES[which])?;
    }

    /// The null space is larger than the row space, which is dense.
    #[test]
    fn wide_matrices(
        which in 0usize..PRIMES.len(), n_rows in 60usize..90, n_sums in 0usize..500, seed in any::<u64>(),
    ) {
        let rows = random_rows(n_rows, 200, 20, seed);
        agrees(&with_sums_of_rows(&rows, n_sums, PRIMES[which], seed ^ 1), 200, PRIMES[which])?;
    }

    /// The order of rows, and of columns that keep their order, is no part of the question.
    #[test]
    fn result_does_not_depend_on_the_order_of_rows(which in 0usize..PRIMES.len(), seed in any::<u64>()) {
        let rows = random_rows(80, 100, 4, seed);
        let space = Sparse::new(&rows, 100).null_space(PRIMES[which]);
        let reversed: Entries = rows.into_iter().rev().collect();
        prop_assert_eq!(Sparse::new(&reversed, 100).null_space(PRIMES[which]), space);
    }
}

#[test]
fn empty_matrices_have_the_whole_space() {
    for (n_rows, n_columns) in [(0, 0), (0, 3), (3, 0), (2, 3)] {
        let entries = vec![Vec::new(); n_rows];
        let space = Sparse::new(&entries, n_columns).null_space(101);
        assert_eq!(space, by_definition(&entries, n_columns, 101));
        assert_eq!((space.rank, space.free.len()), (0, n_columns));
    }
}

#[test]
fn matrices_of_full_rank_have_no_null_vectors() {
    let triangle: Entries = (0..200).map(|i| (i..200).map(|j| (j, 1 + u64::from(i * j))).collect()).collect();
    let space = Sparse::new(&triangle, 200).null_space((1 << 61) - 1);
    assert_eq!((space.rank, space.free, space.basis.map(|basis| basis.columns.len())), (200, vec![], Some(0)));
}

/// The second differences of 3000 numbers, each twice: the null space is that of the arithmetic progressions.
#[test]
fn known_null_space_of_a_long_band() {
    let p = (1 << 61) - 1;
    let n = 3000;
    let rows: Entries = (0..2 * (n - 2)).map(|i| i / 2).map(|i| vec![(i, 1), (i + 1, p - 2), (i + 2, 1)]).collect();
    let space = Sparse::new(&rows, n as usize).null_space(p);
    assert_eq!((space.rank, &*space.free), (n as usize - 2, &[n - 2, n - 1][..]));
    let basis = space.basis.unwrap();
    let (first, second) = basis.residues.split_at(basis.starts[1] as usize);
    // v_(n-2) and v_(n-1) are progressions of step -1 and 1, without the entries that are zero
    assert_eq!(first, (1..n).rev().map(u64::from).collect::<Vec<_>>());
    assert_eq!(second, (0..n - 2).rev().map(|k| p - 1 - u64::from(k)).chain([1]).collect::<Vec<_>>());
}

#[test]
fn elimination_ends_at_a_rank_that_is_enough() {
    let sparse = Sparse::new(&random_rows(300, 200, 4, 1), 200);
    let all = sparse.null_space(101);
    for enough in [0, 1, 50, all.rank - 1, all.rank] {
        let space = null_space(&sparse.matrix(), 101, Some(enough), &Control::default(), |_| ()).unwrap();
        assert_eq!((space.rank, space.pivots.len(), space.free.len()), (enough, enough, 200 - enough));
        assert!(space.basis.is_none());
    }
    let space = null_space(&sparse.matrix(), 101, Some(all.rank + 1), &Control::default(), |_| ()).unwrap();
    assert_eq!(space, all);
}

#[test]
fn cancelled_elimination_says_what_it_knows() {
    let sparse = Sparse::new(&random_rows(3000, 2000, 6, 1), 2000);
    let control = Control::with_time_limit(Duration::ZERO);
    let space = null_space(&sparse.matrix(), 101, None, &control, |_| ()).unwrap();
    assert!(space.basis.is_none() && space.rank < 2000);
    assert_eq!(space.pivots.len() + space.free.len(), 2000);
}

#[test]
fn bad_matrices_are_refused() {
    let refusal = |starts: &[u64], columns: &[u32], residues: &[u64], n_columns, p| {
        let matrix = Matrix { starts, columns, residues, n_columns };
        null_space(&matrix, p, None, &Control::default(), |_| ()).unwrap_err()
    };
    assert_eq!(refusal(&[0, 1], &[0], &[1], 1, 4), Error::Prime { got: 4 });
    assert_eq!(refusal(&[0, 1], &[0], &[1, 2], 1, 3), Error::MatrixEntries { wanted: 1, got: 2 });
    assert_eq!(refusal(&[0, 1], &[1], &[1], 1, 3), Error::MatrixColumn { entry: 0, n_columns: 1, got: 1 });
    for starts in [&[][..], &[1, 1], &[0, 2], &[0, 0], &[0, u64::MAX, 1]] {
        assert_eq!(refusal(starts, &[0], &[1], 1, 3), Error::MatrixStarts { n_entries: 1 });
    }
    assert_eq!(refusal(&[0], &[], &[], MOST_COLUMNS + 1, 3), Error::MatrixColumns { got: MOST_COLUMNS + 1 });
}
