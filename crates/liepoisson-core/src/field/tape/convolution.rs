//! Sums of products of coefficients, two orders at once: nearly all of the work of a tape.
//!
//! At order `k` the terms `l_j r_(m-j)` of `m = k` and of `m = k + 1` that need no coefficient of order `k` are summed
//! together. Each coefficient that is loaded serves both orders, so that the sums are limited by arithmetic rather than
//! by loads. The terms left out are few and are added where order `k + 1` is completed.

use crate::lanes::Lane;

/// Sums for the orders `k` and `k + 1`.
pub(super) type Sums<V> = [V; 2];

/// `[a][b][m]`: sum over `j` of `left[a]_j right[b]_(k+m-j)`, for `m = 0` from `j = 1`, for `m = 1` from `j = 2`, up to
/// `last[m]`, where `last[1]` is `last[0]` or one more.
///
/// `SKIP` leaves the product of the second left and the second right series out. Terms are taken `BLOCK` at a time, and
/// in turn added to `SUMS` sums, so that as many additions are under way at once as their latency needs.
#[inline(always)]
fn convolve<V: Lane, const L: usize, const R: usize, const BLOCK: usize, const SUMS: usize, const SKIP: bool>(
    left: [&[V]; L],
    right: [&[V]; R],
    k: usize,
    last: [usize; 2],
) -> [[Sums<V>; R]; L] {
    let mut sums = [[[[V::splat(0.0); 2]; R]; L]; SUMS];
    if last[0] >= 1 {
        for a in 0..L {
            for b in (0..R).filter(|b| !(SKIP && a * b == 1)) {
                sums[0][a][b][0] = left[a][1].mul(right[b][k - 1]);
            }
        }
    }
    let n = last[0].saturating_sub(1); // terms from j = 2 that both orders have
    // a loop over nothing is recorded, too, so that the first orders share the code of the others
    let is_recorded = V::IS_RECORDED && k > 2 && record_terms::<V, L, R, SUMS, SKIP>(&mut sums, left, right, k, n);
    if n > 0 && !is_recorded {
        let lefts = left.map(|series| series[2..2 + n].as_chunks::<BLOCK>());
        let rights = right.map(|series| series[k - 1 - n..k - 1].as_rchunks::<BLOCK>());
        let mut before = right.map(|series| series[k - 1]);
        let blocks = n / BLOCK;
        let left_blocks = lefts.map(|(blocks_of, _)| &blocks_of[..blocks]);
        let right_blocks = rights.map(|(_, blocks_of)| &blocks_of[..blocks]);
        for (i, from_end) in (0..blocks).zip((0..blocks).rev()) {
            for u in 0..BLOCK {
                let x: [V; L] = std::array::from_fn(|a| left_blocks[a][i][u]);
                let y: [V; R] = std::array::from_fn(|b| right_blocks[b][from_end][BLOCK - 1 - u]);
                add_term::<V, L, R, SKIP>(&mut sums[u % SUMS], x, y, before);
                before = y;
            }
        }
        for i in 0..n % BLOCK {
            let x: [V; L] = std::array::from_fn(|a| lefts[a].1[i]);
            let y: [V; R] = std::array::from_fn(|b| rights[b].0[n % BLOCK - 1 - i]);
            add_term::<V, L, R, SKIP>(&mut sums[i % SUMS], x, y, before);
            before = y;
        }
    }
    if last[1] > last[0] && last[1] >= 2 {
        for a in 0..L {
            for b in (0..R).filter(|b| !(SKIP && a * b == 1)) {
                let j = last[1];
                sums[0][a][b][1] = left[a][j].mul_add(right[b][k + 1 - j], sums[0][a][b][1]);
            }
        }
    }
    let mut total = sums[0];
    for other in &sums[1..] {
        for a in 0..L {
            for b in 0..R {
                for m in 0..2 {
                    total[a][b][m] = total[a][b][m].add(other[a][b][m]);
                }
            }
        }
    }
    total
}

/// Where code is recorded: the terms from `j = 2` on, as a loop.
#[inline(always)]
fn record_terms<V: Lane, const L: usize, const R: usize, const SUMS: usize, const SKIP: bool>(
    sums: &mut [[[Sums<V>; R]; L]; SUMS],
    left: [&[V]; L],
    right: [&[V]; R],
    k: usize,
    n: usize,
) -> bool {
    let first = (left.map(|series| series[2]), right.map(|series| series[k - 1]));
    let sums = sums.as_flattened_mut().as_flattened_mut().as_flattened_mut();
    V::record_products(sums, &first.0, &first.1, SKIP, n)
}

#[inline(always)]
fn add_term<V: Lane, const L: usize, const R: usize, const SKIP: bool>(
    sums: &mut [[Sums<V>; R]; L],
    x: [V; L],
    y: [V; R],
    before: [V; R],
) {
    for a in 0..L {
        for b in 0..R {
            if !(SKIP && a * b == 1) {
                sums[a][b][0] = x[a].mul_add(y[b], sums[a][b][0]);
                sums[a][b][1] = x[a].mul_add(before[b], sums[a][b][1]);
            }
        }
    }
}

#[inline(always)]
fn plus<V: Lane>(x: Sums<V>, y: Sums<V>) -> Sums<V> {
    [x[0].add(y[0]), x[1].add(y[1])]
}

/// Sums of `l_j r_(m-j)`.
#[inline(always)]
pub(super) fn product<V: Lane>(l: &[V], r: &[V], k: usize) -> Sums<V> {
    convolve::<V, 1, 1, 4, 4, false>([l], [r], k, [k - 1; 2])[0][0]
}

/// Sums of `l_j r_(m-j)` and of `l_j dr_(m-j) + dl_j r_(m-j)`.
#[inline(always)]
pub(super) fn product_with_tangent<V: Lane>(l: [&[V]; 2], r: [&[V]; 2], k: usize) -> [Sums<V>; 2] {
    let [[state, first], [second, _]] = convolve::<V, 2, 2, 2, 1, true>(l, r, k, [k - 1; 2]);
    [state, plus(first, second)]
}

/// The last `j` below `m - j`, for `m = k` and `m = k + 1`.
#[inline(always)]
fn halves(k: usize) -> [usize; 2] {
    [(k - 1) / 2, k / 2]
}

/// Sums of `a_j a_(m-j)`: twice those of `j < m - j`, and the middle one.
#[inline(always)]
pub(super) fn square<V: Lane>(a: &[V], k: usize) -> Sums<V> {
    let half = convolve::<V, 1, 1, 4, 4, false>([a], [a], k, halves(k))[0][0];
    with_middle(plus(half, half), a, a, k)
}

/// Sums of `a_j a_(m-j)` and of `a_j da_(m-j)`.
#[inline(always)]
pub(super) fn square_with_tangent<V: Lane>(a: [&[V]; 2], k: usize) -> [Sums<V>; 2] {
    let [[half, first], [second, _]] = convolve::<V, 2, 2, 2, 1, true>(a, a, k, halves(k));
    [with_middle(plus(half, half), a[0], a[0], k), with_middle(plus(first, second), a[0], a[1], k)]
}

#[inline(always)]
fn with_middle<V: Lane>(mut sums: Sums<V>, a: &[V], b: &[V], k: usize) -> Sums<V> {
    let m = k % 2; // k + m is the even one of k and k + 1
    let middle = (k + m) / 2;
    sums[m] = a[middle].mul_add(b[middle], sums[m]);
    sums
}

/// Sums of `left_j r_(m-j)` for two left series.
#[inline(always)]
pub(super) fn two_by_one<V: Lane>(left: [&[V]; 2], r: &[V], k: usize) -> [Sums<V>; 2] {
    convolve::<V, 2, 1, 2, 2, false>(left, [r], k, [k - 1; 2]).map(|[sums]| sums)
}

/// Sums of `l_j right_(m-j)` for two right series.
#[inline(always)]
pub(super) fn one_by_two<V: Lane>(l: &[V], right: [&[V]; 2], k: usize) -> [Sums<V>; 2] {
    convolve::<V, 1, 2, 2, 2, false>([l], right, k, [k - 1; 2])[0]
}

/// Sums of `left_j right_(m-j)` for two left and two right series.
#[inline(always)]
pub(super) fn two_by_two<V: Lane>(left: [&[V]; 2], right: [&[V]; 2], k: usize) -> [[Sums<V>; 2]; 2] {
    convolve::<V, 2, 2, 2, 1, false>(left, right, k, [k - 1; 2])
}
