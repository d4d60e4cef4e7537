//! Products of power series, several at a time and two orders at once: nearly all of the work of a quadratic field.
//!
//! Coefficient `m` of a product is the sum over `j` of `l_j r_(m-j)`, and along a tangent vector that of `l_j dr_(m-j) + dl_j r_(m-j)`;
//! where both factors are the same, terms `j` and `m - j` are equal and are formed once. The terms of orders `k` and `k + 1` that need
//! no coefficient of order `k` are summed together, so that each coefficient that is loaded serves both orders, and products that share
//! a factor share what is loaded of it. The terms left out are few and are added when each order is completed.
//!
//! The order of summation of a product depends neither on what else is formed with it nor on the tangent vectors.

use super::is_second;
use crate::lanes::Lane;
use std::cmp::Reverse;
use std::collections::BTreeSet;

/// Most products that are formed together: with 32 registers three sums of two orders each.
pub(super) const MOST_ROWS: usize = 4;

/// Products of some components, the rows, with another one, the column; or the square of one.
#[derive(Clone, Debug)]
pub(super) struct Panel {
    column: usize,
    rows: Vec<usize>,
    /// The number of its first product.
    first: usize,
}

/// Panels of some products (pairs of components, the smaller one first), each of which is in one of them. The component with most
/// products that are left is the next column; of several that are equal the first is taken.
pub(super) fn panels(n_components: usize, products: &[[usize; 2]]) -> Vec<Panel> {
    let mut partners = vec![vec![]; n_components];
    for &[i, j] in products.iter().filter(|[i, j]| i != j) {
        partners[i].push(j);
        partners[j].push(i);
    }
    let (mut panels, mut first) = (vec![], 0);
    let mut add = |column, rows: &[usize]| {
        panels.push(Panel { column, rows: rows.to_vec(), first });
        first += rows.len();
    };
    products.iter().filter(|[i, j]| i == j).for_each(|&[i, _]| add(i, &[i]));
    let mut by_degree: BTreeSet<(Reverse<usize>, usize)> = partners
        .iter()
        .enumerate()
        .filter(|(_, others)| !others.is_empty())
        .map(|(i, o)| (Reverse(o.len()), i))
        .collect();
    while let Some((_, column)) = by_degree.pop_first() {
        let rows = std::mem::take(&mut partners[column]);
        for &row in &rows {
            by_degree.remove(&(Reverse(partners[row].len()), row));
            partners[row].retain(|&other| other != column);
            by_degree.insert((Reverse(partners[row].len()), row));
        }
        rows.chunks(MOST_ROWS).for_each(|rows| add(column, rows));
    }
    panels
}

/// The coefficients up to order `k`: one row of registers for each order, with `group` registers for the state and then for every
/// tangent vector.
#[derive(Clone, Copy)]
pub(super) struct Known<'r, V> {
    rows: &'r [V],
    row: usize,
    group: usize,
    n_tangents: usize,
    n_products: usize,
    k: usize,
    is_second: bool,
    /// Orders 0, 1, `k - 1`, `k` and half of it, as far as they are there.
    ends: [Reader<V>; 5],
}

/// Sums of a product for orders `k` and `k + 1`: of the state, of `l dr`, and of `dl r`.
#[derive(Clone, Copy)]
struct Sums<V> {
    state: [V; 2],
    right: [V; 2],
    left: [V; 2],
}

impl<'r, V: Lane> Known<'r, V> {
    /// The first `k + 1` rows of a series of `n_orders`, of a field with so many components and products.
    ///
    /// # Panics
    /// The rows are not there.
    #[inline(always)]
    pub(super) fn new(
        rows: &'r [V],
        (group, n_products): (usize, usize),
        n_tangents: usize,
        (k, n_orders): (usize, usize),
    ) -> Self {
        let row = group * (1 + n_tangents);
        assert!(rows.len() == row * (k + 1) && k < n_orders);
        let mut ends = [Reader(rows.as_ptr()); 5];
        for (end, order) in ends.iter_mut().zip([0, k.min(1), k.saturating_sub(1), k, k / 2]) {
            assert!(order <= k);
            // moved, since a pointer to a part of the rows may not be used outside of that part
            end.0 = rows.as_ptr().wrapping_add(order * row);
        }
        Known { rows, row, group, n_tangents, n_products, k, is_second: is_second(k, n_orders), ends }
    }

    /// Where the coefficient of this order of a product is put.
    #[inline(always)]
    fn value(&self, group: usize, product: usize) -> usize {
        group * self.n_products + product
    }

    /// Where its sum for the next order is kept.
    #[inline(always)]
    fn next(&self, group: usize, product: usize) -> usize {
        (1 + self.n_tangents + group) * self.n_products + product
    }

    /// Component `i` of group `g` at an order.
    #[inline(always)]
    fn at(&self, order: usize, g: usize, i: usize) -> V {
        self.rows[order * self.row + g * self.group + i]
    }

    /// Sums of `l_j r_(m-j)` for `m = k` from `j = 1` and for `m = k + 1` from `j = 2`, up to `last`, of which the second is the first or
    /// one more; of the state, and along tangent vector `t`.
    #[inline(always)]
    fn sums<const R: usize, const STATE: bool, const TANGENT: bool>(
        &self,
        rows: &[usize; R],
        column: usize,
        t: usize,
        last: [usize; 2],
    ) -> [Sums<V>; R] {
        let (k, zero) = (self.k, [V::splat(0.0); 2]);
        assert!(t <= self.n_tangents && last[0] < k);
        let mut sums = [Sums { state: zero, right: zero, left: zero }; R];
        if last[0] >= 1 {
            for r in 0..R {
                let x = self.at(1, 0, rows[r]);
                if STATE {
                    sums[r].state[0] = x.mul(self.at(k - 1, 0, column));
                }
                if TANGENT {
                    sums[r].right[0] = x.mul(self.at(k - 1, t, column));
                    sums[r].left[0] = self.at(1, t, rows[r]).mul(self.at(k - 1, 0, column));
                }
            }
        }
        let n = last[0].saturating_sub(1); // terms from j = 2 that both orders have
        // a loop over nothing is recorded, too, so that the first orders share the code of the others
        if V::IS_RECORDED && k > 2 {
            self.record::<R, TANGENT>(&mut sums, rows, column, t, n);
        } else if n > 0 {
            let d = t * self.group;
            let (mut x, mut y) = (Reader(self.rows.as_ptr().wrapping_add(2 * self.row)), self.ends[2]);
            // SAFETY: see `Reader`.
            let [mut before, mut d_before] = unsafe { [y.at(column), y.at(d + column)] };
            for _ in 0..n {
                y.back(self.row);
                // SAFETY: see `Reader`.
                let [v, dv] = unsafe { [y.at(column), y.at(d + column)] };
                for r in 0..R {
                    let sum = &mut sums[r];
                    // SAFETY: see `Reader`.
                    let [u, du] = unsafe { [x.at(rows[r]), x.at(d + rows[r])] };
                    if STATE {
                        sum.state = [u.mul_add(v, sum.state[0]), u.mul_add(before, sum.state[1])];
                    }
                    if TANGENT {
                        sum.right = [u.mul_add(dv, sum.right[0]), u.mul_add(d_before, sum.right[1])];
                        sum.left = [du.mul_add(v, sum.left[0]), du.mul_add(before, sum.left[1])];
                    }
                }
                (before, d_before) = (v, dv);
                x.forward(self.row);
            }
        }
        if last[1] > last[0] && last[1] >= 2 {
            let (j, i) = (last[1], k + 1 - last[1]);
            for r in 0..R {
                let (sum, x) = (&mut sums[r], self.at(j, 0, rows[r]));
                if STATE {
                    sum.state[1] = x.mul_add(self.at(i, 0, column), sum.state[1]);
                }
                if TANGENT {
                    sum.right[1] = x.mul_add(self.at(i, t, column), sum.right[1]);
                    sum.left[1] = self.at(j, t, rows[r]).mul_add(self.at(i, 0, column), sum.left[1]);
                }
            }
        }
        sums
    }

    /// Where code is recorded: the terms from `j = 2` on, as a loop.
    fn record<const R: usize, const TANGENT: bool>(
        &self,
        sums: &mut [Sums<V>; R],
        rows: &[usize; R],
        column: usize,
        t: usize,
        n: usize,
    ) {
        let groups = if TANGENT { &[0, t][..] } else { &[0] };
        let left: Vec<V> = rows.iter().flat_map(|&i| groups.iter().map(move |&g| self.at(2, g, i))).collect();
        let right: Vec<V> = groups.iter().map(|&g| self.at(self.k - 1, g, column)).collect();
        let nothing = [V::splat(0.0); 2]; // of the products of two tangent vectors, which nothing reads
        let mut recorded: Vec<V> = sums
            .iter()
            .flat_map(
                |sum| if TANGENT { [sum.state, sum.right, sum.left, nothing].concat() } else { sum.state.to_vec() },
            )
            .collect();
        V::record_products(&mut recorded, &left, &right, self.row, n);
        for (sum, recorded) in sums.iter_mut().zip(recorded.chunks(2 * groups.len() * groups.len())) {
            let pair = |at: usize| [recorded[at], recorded[at + 1]];
            sum.state = pair(0);
            if TANGENT {
                (sum.right, sum.left) = (pair(2), pair(4));
            }
        }
    }
}

impl Panel {
    /// The two factors of each product.
    pub(super) fn products(&self) -> impl Iterator<Item = [usize; 2]> {
        self.rows.iter().map(|&row| [row, self.column])
    }

    fn is_square(&self) -> bool {
        self.rows[..] == [self.column]
    }

    /// Puts coefficient `k` of the products into the work registers, and keeps there what is formed for the next order.
    #[inline(always)]
    pub(super) fn extend<V: Lane>(&self, known: &Known<'_, V>, work: &mut [V]) {
        // six sums and their factors fill 16 registers
        let is_alone = known.n_tangents > 0 && V::REGISTERS < 32 && !V::IS_RECORDED;
        let at_once = if is_alone { 1 } else { MOST_ROWS };
        for (first, rows) in (self.first..).step_by(at_once).zip(self.rows.chunks(at_once)) {
            match *rows {
                [a] => self.extend_rows(known, [a], first, work),
                [a, b] => self.extend_rows(known, [a, b], first, work),
                [a, b, c] => self.extend_rows(known, [a, b, c], first, work),
                [a, b, c, d] => self.extend_rows(known, [a, b, c, d], first, work),
                _ => unreachable!("a panel has no more rows"),
            }
        }
    }

    /// The same for these rows, which begin with product `first`.
    #[inline(always)]
    fn extend_rows<V: Lane, const R: usize>(
        &self,
        known: &Known<'_, V>,
        rows: [usize; R],
        first: usize,
        work: &mut [V],
    ) {
        assert!(self.column < known.group);
        for r in 0..R {
            assert!(rows[r] < known.group);
        }
        if known.k > 1 && !known.is_second {
            self.form(known, &rows, first, work);
        }
        for g in 0..=known.n_tangents {
            let mut sums = [V::splat(0.0); R];
            if known.k > 1 {
                let from = if known.is_second { known.next(g, first) } else { known.value(g, first) };
                sums.copy_from_slice(&work[from..from + R]);
            }
            match (self.is_square(), g) {
                (true, 0) => complete_square(known, self.column, &mut sums[0]),
                (true, t) => complete_square_along(known, self.column, t, &mut sums[0]),
                (false, 0) => complete(known, &rows, self.column, &mut sums),
                (false, t) => complete_along(known, &rows, self.column, t, &mut sums),
            }
            work[known.value(g, first)..][..R].copy_from_slice(&sums);
        }
    }

    /// Sums for order `k` and the next.
    #[inline(always)]
    fn form<V: Lane, const R: usize>(&self, known: &Known<'_, V>, rows: &[usize; R], first: usize, work: &mut [V]) {
        let k = known.k;
        let last = if self.is_square() { [(k - 1) / 2, k / 2] } else { [k - 1; 2] };
        if known.n_tangents == 0 {
            let sums = known.sums::<R, true, false>(rows, self.column, 0, last);
            for r in 0..R {
                put(known, work, (0, first + r), sums[r].state);
            }
            return;
        }
        let sums = known.sums::<R, true, true>(rows, self.column, 1, last);
        for r in 0..R {
            put(known, work, (0, first + r), sums[r].state);
            put(known, work, (1, first + r), sums[r].along());
        }
        for t in 2..=known.n_tangents {
            let sums = known.sums::<R, false, true>(rows, self.column, t, last);
            for r in 0..R {
                put(known, work, (t, first + r), sums[r].along());
            }
        }
    }
}

#[inline(always)]
fn put<V: Lane>(known: &Known<'_, V>, work: &mut [V], (group, product): (usize, usize), sums: [V; 2]) {
    work[known.value(group, product)] = sums[0];
    work[known.next(group, product)] = sums[1];
}

impl<V: Lane> Sums<V> {
    /// Along the tangent vector.
    #[inline(always)]
    fn along(&self) -> [V; 2] {
        [self.right[0].add(self.left[0]), self.right[1].add(self.left[1])]
    }
}

// No closures in what follows: one that the compiler does not inline is compiled without the wide registers.

/// Late terms and ends of the sums of products of some rows with a column.
#[inline(always)]
fn complete<V: Lane, const R: usize>(known: &Known<'_, V>, rows: &[usize; R], column: usize, sums: &mut [V; R]) {
    let [start, first, before, last, _] = known.ends;
    // SAFETY: see `Reader`.
    unsafe {
        let (r0, rk) = (start.at(column), last.at(column));
        if known.is_second {
            let (r1, rb) = (first.at(column), before.at(column));
            for r in 0..R {
                let (l1, lb) = (first.at(rows[r]), before.at(rows[r]));
                sums[r] = lb.mul_add(r1, l1.mul_add(rb, sums[r]));
            }
        }
        if known.k > 0 {
            for r in 0..R {
                sums[r] = last.at(rows[r]).mul_add(r0, sums[r]);
            }
        }
        for r in 0..R {
            sums[r] = start.at(rows[r]).mul_add(rk, sums[r]);
        }
    }
}

/// The same along tangent vector `t`; two sums for each product, so that one does not wait for the other.
#[inline(always)]
fn complete_along<V: Lane, const R: usize>(
    known: &Known<'_, V>,
    rows: &[usize; R],
    column: usize,
    t: usize,
    sums: &mut [V; R],
) {
    let ([start, first, before, last, _], d) = (known.ends, t * known.group);
    let mut others = [V::splat(0.0); R];
    // SAFETY: see `Reader`.
    unsafe {
        let (r0, rk) = (start.at(column), last.at(column));
        let (dr0, drk) = (start.at(d + column), last.at(d + column));
        for r in 0..R {
            others[r] = start.at(d + rows[r]).mul(rk);
        }
        if known.is_second {
            let (r1, rb) = (first.at(column), before.at(column));
            let (dr1, drb) = (first.at(d + column), before.at(d + column));
            for r in 0..R {
                let (l1, lb) = (first.at(rows[r]), before.at(rows[r]));
                let (dl1, dlb) = (first.at(d + rows[r]), before.at(d + rows[r]));
                sums[r] = lb.mul_add(dr1, l1.mul_add(drb, sums[r]));
                others[r] = dlb.mul_add(r1, dl1.mul_add(rb, others[r]));
            }
        }
        if known.k > 0 {
            for r in 0..R {
                sums[r] = last.at(rows[r]).mul_add(dr0, sums[r]);
                others[r] = last.at(d + rows[r]).mul_add(r0, others[r]);
            }
        }
        for r in 0..R {
            sums[r] = start.at(rows[r]).mul_add(drk, sums[r]).add(others[r]);
        }
    }
}

/// Twice the sum of half of the terms of a square, and the middle one.
#[inline(always)]
fn complete_square<V: Lane>(known: &Known<'_, V>, i: usize, sum: &mut V) {
    let [start, first, before, last, middle] = known.ends;
    let mut half = *sum;
    // SAFETY: see `Reader`.
    unsafe {
        if known.is_second {
            half = first.at(i).mul_add(before.at(i), half);
        }
        if known.k > 0 {
            half = start.at(i).mul_add(last.at(i), half);
        }
        *sum = half.add(half);
        if known.k.is_multiple_of(2) {
            let middle = middle.at(i);
            *sum = middle.mul_add(middle, *sum);
        }
    }
}

/// Twice the sum of all terms `x_j dx_(k-j)`.
#[inline(always)]
fn complete_square_along<V: Lane>(known: &Known<'_, V>, i: usize, t: usize, sum: &mut V) {
    let ([start, first, before, last, middle], di) = (known.ends, i + t * known.group);
    // SAFETY: see `Reader`.
    unsafe {
        if known.is_second {
            *sum = first.at(di).mul_add(before.at(i), first.at(i).mul_add(before.at(di), *sum));
        }
        if known.k > 0 {
            *sum = start.at(di).mul_add(last.at(i), start.at(i).mul_add(last.at(di), *sum));
        }
        if known.k.is_multiple_of(2) {
            *sum = middle.at(i).mul_add(middle.at(di), *sum);
        }
    }
    *sum = sum.add(*sum);
}

/// One row of coefficients.
///
/// Reading is unchecked: a check for every coefficient would cost as much as the arithmetic. It is sound because [`Panel::extend_rows`]
/// compares all indices with the length of a group, tangent vectors are counted up to their number, and readers are at orders up to `k`
/// of the rows that [`Known::new`] has found to be there: [`Known::sums`] moves them between the orders 1 and `k`.
#[derive(Clone, Copy)]
struct Reader<V>(*const V);

impl<V: Lane> Reader<V> {
    /// # Safety
    /// `i` is a component of a group that there is, and the reader is at an order of the series.
    #[inline(always)]
    unsafe fn at(&self, i: usize) -> V {
        // SAFETY: so the caller says.
        unsafe { *self.0.add(i) }
    }

    /// To the next order.
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
    use proptest::prelude::*;

    /// The products of panels, each as (smaller, larger), sorted.
    fn formed(panels: &[Panel]) -> Vec<[usize; 2]> {
        let mut formed: Vec<[usize; 2]> =
            panels.iter().flat_map(Panel::products).map(|[i, j]| [i.min(j), i.max(j)]).collect();
        formed.sort_unstable();
        formed
    }

    proptest! {
        #[test]
        fn every_product_is_formed_exactly_once(
            n in 1..40_usize, pairs in prop::collection::vec((0..40_usize, 0..40_usize), 0..400)
        ) {
            let mut products: Vec<[usize; 2]> =
                pairs.iter().map(|&(i, j)| [(i % n).min(j % n), (i % n).max(j % n)]).collect();
            products.sort_unstable();
            products.dedup();
            let panels = panels(n, &products);
            let firsts: Vec<usize> = panels.iter().map(|panel| panel.first).collect();
            let lengths = panels.iter().map(|panel| panel.rows.len());
            prop_assert!(firsts.iter().copied().eq(lengths.scan(0, |sum, n| Some(std::mem::replace(sum, *sum + n)))));
            prop_assert_eq!(formed(&panels), products);
        }
    }

    #[test]
    fn products_of_a_large_dense_field_fill_their_panels() {
        let products: Vec<[usize; 2]> = (0..120).flat_map(|i| (i + 1..120).map(move |j| [i, j])).collect();
        let panels = panels(120, &products);
        // measured: 3.9 products in a panel, of at most 4
        let mean = products.len() as f64 / panels.len() as f64;
        assert!(mean > 3.8, "{mean} products in a panel");
    }
}
