//! Products of power series, several at a time: tiles of products whose sums stay in registers.
//!
//! Coefficient `k` of the product `x_i x_j` of two components is `sum over s of x_i[s] x_j[k - s]`, and along a tangent
//! vector `d` it is `sum over s of (x_i[s] dx_j[k - s] + dx_i[s] x_j[k - s])`. A [`Tile`] forms several products that
//! share factors, so that a coefficient, once loaded, enters several sums: on AVX-512 processors about 1.3 registers can
//! be loaded a cycle beside two multiply-adds (measured), which makes the loads the bottleneck of small tiles.

use crate::lanes::Lane;

/// Most products in a tile.
pub(super) const MOST_PRODUCTS: usize = 12;
const MOST_COLUMNS: usize = 3;
const MOST_ROWS: usize = 6;

/// Number, columns, shared rows and single rows of every shape with a kernel.
macro_rules! with_shapes {
    ($then:ident) => {
        $then! {
            0: 1 0 1, 1: 1 0 2, 2: 1 0 4, 3: 1 0 6,
            4: 2 1 2, 5: 2 2 0, 6: 2 2 2, 7: 2 3 0, 8: 2 3 3, 9: 2 4 0, 10: 2 6 0,
            11: 3 3 0, 12: 3 4 0,
        }
    };
}

macro_rules! array_of_shapes {
    ($($index:literal: $columns:literal $shared:literal $single:literal,)*) => {
        [$(Shape { columns: $columns, shared: $shared, single: $single },)*]
    };
}

/// The shapes with a kernel.
pub(super) const SHAPES: [Shape; 13] = with_shapes!(array_of_shapes);

/// The outline of a tile: `shared` rows, each multiplied with every one of `columns`, then `single` rows, multiplied
/// with the first column alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Shape {
    pub columns: usize,
    pub shared: usize,
    pub single: usize,
}

impl Shape {
    pub const fn n_rows(self) -> usize {
        self.shared + self.single
    }

    pub const fn n_products(self) -> usize {
        self.columns * self.shared + self.single
    }

    /// Cycles for one term of all its sums, for the state and one tangent vector on AVX-512: two multiply-adds (measured
    /// 1.3 loads) a cycle, eight cycles of latency for the two that a sum of the tangent vector takes, and its share of
    /// what a tile costs once per order. It ranks shapes; nothing depends on it otherwise.
    pub fn cost(self) -> f64 {
        let arithmetic = 1.5 * self.n_products() as f64;
        let loads = 2.0 * (self.columns + self.n_rows()) as f64 / 1.3;
        arithmetic.max(loads).max(8.0) + 3.5
    }
}

/// Products of components, by index: `rows[p] columns[q]` in the order that [`Tile::products`] gives.
///
/// The factor from `rows` is read from order 0 upwards, the one from `columns` from order `k` downwards: the order of
/// summation of a product does not depend on the tile that it is in.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tile {
    /// Position in [`SHAPES`].
    shape: usize,
    columns: [usize; MOST_COLUMNS],
    rows: [usize; MOST_ROWS],
    /// All indices are below this.
    n_components: usize,
}

impl Tile {
    /// The tile with these factors.
    ///
    /// # Panics
    /// There is no kernel of that shape, or an index is not below `n_components`.
    pub fn new(columns: &[usize], rows: &[usize], shared: usize, n_components: usize) -> Tile {
        let wanted = Shape { columns: columns.len(), shared, single: rows.len() - shared };
        let shape =
            SHAPES.iter().position(|&shape| shape == wanted).expect("a tile has one of the shapes with a kernel");
        assert!(columns.iter().chain(rows).all(|&i| i < n_components), "a tile multiplies components");
        let mut tile = Tile { shape, columns: [0; MOST_COLUMNS], rows: [0; MOST_ROWS], n_components };
        tile.columns[..columns.len()].copy_from_slice(columns);
        tile.rows[..rows.len()].copy_from_slice(rows);
        tile
    }

    #[inline(always)]
    fn first_columns<const Q: usize>(&self) -> [usize; Q] {
        *self.columns.first_chunk().expect("no shape has more columns")
    }

    pub fn shape(&self) -> Shape {
        SHAPES[self.shape]
    }

    /// The two factors of each product, row first.
    pub fn products(&self) -> Vec<[usize; 2]> {
        let Shape { columns, shared, .. } = self.shape();
        let (both, single) = self.rows[..self.shape().n_rows()].split_at(shared);
        let shared = both.iter().flat_map(|&row| self.columns[..columns].iter().map(move |&column| [row, column]));
        shared.chain(single.iter().map(|&row| [row, self.columns[0]])).collect()
    }

    /// Runs `kernel` with the shape of this tile as constants.
    #[inline(always)]
    pub fn run(&self, kernel: impl Kernel) {
        macro_rules! call {
            ($($index:literal: $columns:literal $shared:literal $single:literal,)*) => {
                match self.shape {
                    $($index => kernel.run::<$columns, $shared, $single>(self),)*
                    _ => unreachable!("a tile has one of the shapes with a kernel"),
                }
            };
        }
        with_shapes!(call)
    }
}

/// What is done with a tile: `Q` columns, `S` rows shared by all of them, `A` rows of the first column alone.
pub(super) trait Kernel {
    fn run<const Q: usize, const S: usize, const A: usize>(self, tile: &Tile);
}

/// The sums of one tile, for the state or for one tangent vector.
#[derive(Clone, Copy)]
pub(super) struct Sums<V, const Q: usize, const S: usize, const A: usize> {
    pub shared: [[V; Q]; S],
    pub single: [V; A],
}

impl<V: Lane, const Q: usize, const S: usize, const A: usize> Sums<V, Q, S, A> {
    #[inline(always)]
    fn zero() -> Self {
        let zero = V::splat(0.0);
        Sums { shared: [[zero; Q]; S], single: [zero; A] }
    }

    /// The sums in the order of [`Tile::products`].
    #[inline(always)]
    pub fn in_order(&self) -> [V; MOST_PRODUCTS] {
        let mut sums = [V::splat(0.0); MOST_PRODUCTS];
        for p in 0..S {
            for q in 0..Q {
                sums[p * Q + q] = self.shared[p][q];
            }
        }
        for p in 0..A {
            sums[S * Q + p] = self.single[p];
        }
        sums
    }

    /// `sum += row column` for one row and all its columns.
    #[inline(always)]
    fn add(&mut self, p: usize, row: V, columns: &[V; Q]) {
        if p < S {
            for q in 0..Q {
                self.shared[p][q] = row.mul_add(columns[q], self.shared[p][q]);
            }
        } else {
            self.single[p - S] = row.mul_add(columns[0], self.single[p - S]);
        }
    }
}

/// The coefficients of orders `0..=k`: one row of registers for each, with `group` registers for the state and then for
/// every tangent vector.
#[derive(Clone, Copy)]
pub(super) struct Series<'r, V> {
    known: &'r [V],
    row: usize,
    group: usize,
    k: usize,
}

impl<'r, V: Lane> Series<'r, V> {
    /// # Panics
    /// The rows are not there.
    #[inline(always)]
    pub fn new(known: &'r [V], row: usize, group: usize, k: usize) -> Self {
        assert!(group <= row && row * (k + 1) <= known.len());
        Series { known, row, group, k }
    }

    /// Two readers of group number `group`, from order 0 upwards and from order `k` downwards, for the indices of `tile`.
    #[inline(always)]
    fn readers(&self, group: usize, tile: &Tile) -> (Reader<V>, Reader<V>) {
        assert!((group + 1) * self.group <= self.row && tile.n_components <= self.group);
        // Both pointers are those of all rows, moved: a pointer to a part of them may not be used outside of that part.
        let first = self.known.as_ptr().wrapping_add(group * self.group);
        (Reader(first), Reader(first.wrapping_add(self.k * self.row)))
    }

    /// Coefficient `k` of the products.
    #[inline(always)]
    pub fn of_state<const Q: usize, const S: usize, const A: usize>(&self, tile: &Tile) -> Sums<V, Q, S, A> {
        let mut sums = Sums::zero();
        if V::IS_RECORDED && self.is_recorded(&mut [&mut sums], &[(0, Factors::State)], 0, tile) {
            return sums;
        }
        let (mut x, mut y) = self.readers(0, tile);
        let (rows, columns) = (tile.rows, tile.first_columns());
        for _ in 0..self.k + 1 {
            // SAFETY: see `Reader`.
            unsafe {
                let v = y.columns(&columns);
                for p in 0..S + A {
                    sums.add(p, x.at(rows[p]), &v);
                }
            }
            x.forward(self.row);
            y.back(self.row);
        }
        sums
    }

    /// Coefficient `k` of the products along tangent vector `t` (from 1).
    #[inline(always)]
    pub fn of_tangent<const Q: usize, const S: usize, const A: usize>(
        &self,
        tile: &Tile,
        t: usize,
    ) -> Sums<V, Q, S, A> {
        let mut sums = Sums::zero();
        let parts = [(0, Factors::RightTangent), (0, Factors::LeftTangent)];
        if V::IS_RECORDED && self.is_recorded(&mut [&mut sums], &parts, t, tile) {
            return sums;
        }
        let ((mut x, mut y), (mut dx, mut dy)) = (self.readers(0, tile), self.readers(t, tile));
        let (rows, columns) = (tile.rows, tile.first_columns());
        for _ in 0..self.k + 1 {
            // SAFETY: see `Reader`.
            unsafe {
                let (v, dv) = (y.columns(&columns), dy.columns(&columns));
                for p in 0..S + A {
                    sums.add(p, x.at(rows[p]), &dv);
                    sums.add(p, dx.at(rows[p]), &v);
                }
            }
            x.forward(self.row);
            dx.forward(self.row);
            y.back(self.row);
            dy.back(self.row);
        }
        sums
    }

    /// Both [`Series::of_state`] and [`Series::of_tangent`] for the first tangent vector, with the same sums term by term,
    /// sharing what they load.
    #[inline(always)]
    pub fn of_both<const Q: usize, const S: usize, const A: usize>(&self, tile: &Tile) -> [Sums<V, Q, S, A>; 2] {
        let (mut sums, mut d_sums) = (Sums::zero(), Sums::zero());
        let parts = [(0, Factors::State), (1, Factors::RightTangent), (1, Factors::LeftTangent)];
        if V::IS_RECORDED && self.is_recorded(&mut [&mut sums, &mut d_sums], &parts, 1, tile) {
            return [sums, d_sums];
        }
        let ((mut x, mut y), (mut dx, mut dy)) = (self.readers(0, tile), self.readers(1, tile));
        let (rows, columns) = (tile.rows, tile.first_columns());
        for _ in 0..self.k + 1 {
            // SAFETY: see `Reader`.
            unsafe {
                let (v, dv) = (y.columns(&columns), dy.columns(&columns));
                for p in 0..S + A {
                    let u = x.at(rows[p]);
                    sums.add(p, u, &v);
                    d_sums.add(p, u, &dv);
                    d_sums.add(p, dx.at(rows[p]), &v);
                }
            }
            x.forward(self.row);
            dx.forward(self.row);
            y.back(self.row);
            dy.back(self.row);
        }
        [sums, d_sums]
    }

    /// Whether a loop is recorded that adds to these sums the products of these factors, in turn, along tangent vector `t` (from 1).
    /// From order 1 on: what a loop reads is memory, as it is not in straight code that asks for rates.
    fn is_recorded<const Q: usize, const S: usize, const A: usize>(
        &self,
        to: &mut [&mut Sums<V, Q, S, A>],
        parts: &[(usize, Factors)],
        t: usize,
        tile: &Tile,
    ) -> bool {
        if self.k == 0 {
            return false;
        }
        // the coefficients of the state, then those of the tangent vector
        let of = |order: usize, indices: &[usize]| -> Vec<V> {
            let starts = [0, t * self.group].map(|group| order * self.row + group);
            starts.iter().flat_map(|&start| indices.iter().map(move |&i| self.known[start + i])).collect()
        };
        let (left, right) = (of(0, &tile.rows[..S + A]), of(self.k, &tile.columns[..Q]));
        let mut products = vec![];
        for p in 0..S + A {
            for &(sums, factors) in parts {
                for q in 0..if p < S { Q } else { 1 } {
                    let sum = sums * (Q * S + A) + if p < S { p * Q + q } else { Q * S + p - S };
                    products.push(match factors {
                        Factors::State => [sum, p, q],
                        Factors::RightTangent => [sum, p, Q + q],
                        Factors::LeftTangent => [sum, S + A + p, q],
                    });
                }
            }
        }
        let mut sums: Vec<V> = to.iter().flat_map(|sums| sums.in_order()[..Q * S + A].to_vec()).collect();
        if !V::record_sums(&mut sums, &left, &right, products, self.row, self.k + 1) {
            return false;
        }
        for (to, sums) in to.iter_mut().zip(sums.chunks_exact(Q * S + A)) {
            to.shared.as_flattened_mut().copy_from_slice(&sums[..Q * S]);
            to.single.copy_from_slice(&sums[Q * S..]);
        }
        true
    }
}

/// Whose coefficients are multiplied: those of the state, or one of the two those of a tangent vector.
#[derive(Clone, Copy)]
enum Factors {
    State,
    RightTangent,
    LeftTangent,
}

/// One group of one row of coefficients.
///
/// Reading is unchecked: a check for every coefficient would cost as much as the arithmetic. It is sound because the
/// indices of a [`Tile`] are below the number of components, which is at most the length of a group, and because a loop
/// from order 0 to `k` stays in the rows that [`Series::new`] has found to be there. Before the first row and after the last
/// the pointer is moved once more, and not read.
struct Reader<V>(*const V);

impl<V: Lane> Reader<V> {
    #[inline(always)]
    /// # Safety
    /// `i` is an index of the tile that the reader was made for, and the reader is at an order of the series.
    unsafe fn at(&self, i: usize) -> V {
        // SAFETY: so the caller says.
        unsafe { *self.0.add(i) }
    }

    /// # Safety
    /// As for [`Reader::at`], for each of the indices.
    #[inline(always)]
    unsafe fn columns<const Q: usize>(&self, columns: &[usize; Q]) -> [V; Q] {
        let mut values = [V::splat(0.0); Q];
        for q in 0..Q {
            // SAFETY: so the caller says.
            values[q] = unsafe { self.at(columns[q]) };
        }
        values
    }

    /// To the next order; one past the last after the last.
    #[inline(always)]
    fn forward(&mut self, row: usize) {
        self.0 = opaque(self.0.wrapping_add(row));
    }

    /// To the order before.
    #[inline(always)]
    fn back(&mut self, row: usize) {
        self.0 = opaque(self.0.wrapping_sub(row));
    }
}

/// The same pointer, of which the compiler does not know where it came from.
///
/// Left to itself it keeps a moving address for every factor instead of two for all, more than there are registers, and
/// a term takes 1.2 times as long (measured on AVX-512, twisted top). No instruction; on other processors nothing at all.
#[inline(always)]
#[allow(clippy::pointers_in_nomem_asm_block)] // nothing is read through it there
fn opaque<T>(pointer: *const T) -> *const T {
    #[cfg(all(target_arch = "x86_64", not(miri)))]
    {
        let mut pointer = pointer;
        // SAFETY: there is no instruction in it.
        unsafe {
            std::arch::asm!("/* {0} */", inout(reg) pointer, options(pure, nomem, nostack, preserves_flags));
        }
        pointer
    }
    #[cfg(any(not(target_arch = "x86_64"), miri))] // Miri runs no assembly
    pointer
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{Simd, Task, Wide, dispatch};
    use proptest::prelude::*;

    /// The sums of a tile in every way that there is, from coefficients `(order, group, component)` without a number more.
    struct EverySum<'s> {
        tile: &'s Tile,
        group: usize,
        n_tangents: usize,
        k: usize,
        numbers: &'s [f64],
    }

    impl Task for EverySum<'_> {
        type Output = Vec<Vec<f64>>;

        fn run<V: Wide>(self) -> Vec<Vec<f64>> {
            let rows: Box<[V]> = self.numbers.iter().map(|&number| V::splat(number)).collect();
            let series = Series::new(&rows, self.group * (1 + self.n_tangents), self.group, self.k);
            let mut sums = Vec::new();
            self.tile.run(Collect { series, n_tangents: self.n_tangents, to: &mut sums });
            sums
        }
    }

    struct Collect<'s, V> {
        series: Series<'s, V>,
        n_tangents: usize,
        to: &'s mut Vec<Vec<f64>>,
    }

    impl<V: Lane> Kernel for Collect<'_, V> {
        fn run<const Q: usize, const S: usize, const A: usize>(self, tile: &Tile) {
            let mut keep = |sums: Sums<V, Q, S, A>| {
                self.to.push(sums.in_order()[..tile.shape().n_products()].iter().map(|sum| sum.get(0)).collect());
            };
            keep(self.series.of_state(tile));
            (1..=self.n_tangents).for_each(|t| keep(self.series.of_tangent(tile, t)));
            if self.n_tangents > 0 {
                self.series.of_both(tile).into_iter().for_each(keep);
            }
        }
    }

    proptest! {
        /// Also where the rows end exactly with the last coefficient that is read, and begin with the first.
        #[test]
        fn a_tile_of_every_shape_forms_its_products(
            k in 0_usize..5, spare in 0_usize..3, n_tangents in 0_usize..3,
            numbers in prop::collection::vec(-1.0_f64..1.0, 5 * 3 * 11),
        ) {
            for shape in SHAPES {
                let n_components = shape.columns + shape.n_rows();
                let indices: Vec<usize> = (0..n_components).rev().collect();
                let (columns, rows) = indices.split_at(shape.columns);
                let tile = Tile::new(columns, rows, shape.shared, n_components);
                let group = n_components + spare;
                let row = group * (1 + n_tangents);
                let coefficients: Vec<f64> = numbers.iter().copied().cycle().take(row * (k + 1)).collect();
                let x = |order: usize, group_number: usize, i: usize| coefficients[order * row + group_number * group + i];
                let state = |[i, j]: [usize; 2]| (0..=k).fold(0.0, |sum, s| x(s, 0, i).mul_add(x(k - s, 0, j), sum));
                let tangent = |t: usize, [i, j]: [usize; 2]| (0..=k).fold(0.0, |sum, s| {
                    let sum = x(s, 0, i).mul_add(x(k - s, t, j), sum);
                    x(s, t, i).mul_add(x(k - s, 0, j), sum)
                });
                let products = tile.products();
                let mut wanted = vec![products.iter().map(|&product| state(product)).collect::<Vec<f64>>()];
                for t in (1..=n_tangents).chain([0, 1].into_iter().filter(|_| n_tangents > 0)) {
                    let of = |&product: &[usize; 2]| if t == 0 { state(product) } else { tangent(t, product) };
                    wanted.push(products.iter().map(of).collect());
                }
                for simd in Simd::ALL {
                    let task = EverySum { tile: &tile, group, n_tangents, k, numbers: &coefficients };
                    prop_assert_eq!(&dispatch(simd, task), &wanted, "{:?} {:?}", shape, simd);
                }
            }
        }
    }
}
