//! What is known of the power series of all trajectories of a block at once: sums and sizes, for those who look for crossings.

use crate::lanes::{Body, Wide};
use crate::method::variational::spread;

/// What is known of the power series of all lanes at once, each in units of its step `h`.
#[derive(Clone, Debug, Default)]
pub struct Overview<'f> {
    /// `constant + sum c_i x_i`, terms `(i, c_i)`.
    pub form: (f64, &'f [(usize, f64)]),
    /// Where the components of the form are at the start of the step, `(term, lane)`.
    pub starts: Vec<f64>,
    /// The terms of the series of this form, `(order, lane)`.
    pub values: Vec<f64>,
    /// Of each order the size of the largest component, `(order, lane)`.
    pub largest: Vec<f64>,
    /// Sums over the orders, lane by lane.
    pub sums: Vec<SeriesSums>,
}

/// What the terms of the series of a lane add up to.
#[derive(Clone, Copy, Debug, Default)]
pub struct SeriesSums {
    /// `sum |s_k|` of the form.
    pub total: f64,
    /// The same from the second term on.
    pub rest: f64,
    /// `sum k |s_k|` from the third term on.
    pub bends: f64,
    /// `sum s_k`, from the last term on: the form at the end of the step.
    pub end: f64,
    /// The largest `|s_k|`.
    pub most: f64,
    /// `sum y_k`, where `y_k` is the largest term of a component.
    pub state: f64,
    /// The same from the second term on.
    pub state_rest: f64,
    /// `sum_{i+j >= N} y_i y_j`.
    pub products: f64,
    /// The least of the larger ones of the first two terms of each component, if the first four are not zero.
    pub least: f64,
}

/// So many terms are zero of a component that [`SeriesSums::least`] leaves out: it counts as zero.
pub(crate) const FIRST_TERMS: usize = 4;

/// A linear form in the state and its largest component, order by order.
///
/// What is added up is added up order by order, as for one lane alone, so that a trajectory has the same bits in every width.
pub(super) struct LookOver<'b, 'o, V> {
    /// The coefficients, `row` registers for each order, of which the first `n` are the state's.
    pub(super) rows: &'b [V],
    pub(super) row: usize,
    pub(super) n: usize,
    pub(super) n_orders: usize,
    pub(super) steps: &'b [f64],
    pub(super) of: &'b mut Overview<'o>,
}

impl<V: Wide> Body for LookOver<'_, '_, V> {
    #[inline(always)]
    fn run(self) {
        let LookOver { rows, row, n, n_orders, steps, of } = self;
        let Overview { form: (constant, terms), starts, values, largest, sums } = of;
        values.resize(n_orders * V::WIDTH, 0.0);
        largest.resize(n_orders * V::WIDTH, 0.0);
        starts.clear();
        starts.extend(terms.iter().flat_map(|&(i, _)| rows[i].as_scalars()));
        let (step, zero) = (spread::<V>(steps), V::splat(0.0));
        let (mut power, mut of_form, mut bends, mut most) = (V::splat(1.0), [zero; 2], zero, zero);
        let mut of_state = [zero; 2];
        let orders = rows.chunks_exact(row).zip(values.chunks_exact_mut(V::WIDTH));
        for (k, ((known, value), largest)) in orders.zip(largest.chunks_exact_mut(V::WIDTH)).enumerate() {
            let mut sum = V::splat(if k == 0 { *constant } else { 0.0 });
            for &(i, c) in *terms {
                sum = sum.add(V::splat(c).mul(known[i]));
            }
            let sum = sum.mul(power);
            value.copy_from_slice(sum.as_scalars());
            let mut widest = zero;
            for component in &known[..n] {
                widest = larger(component.abs(), widest);
            }
            let widest = widest.mul(power.abs());
            largest.copy_from_slice(widest.as_scalars());
            of_form[0] = of_form[0].add(sum.abs());
            of_state[0] = of_state[0].add(widest);
            if k > 0 {
                of_form[1] = of_form[1].add(sum.abs());
                of_state[1] = of_state[1].add(widest);
            }
            if k > 1 {
                bends = bends.add(V::splat(k as f64).mul(sum.abs()));
            }
            most = larger(sum.abs(), most);
            power = power.mul(step);
        }
        let (mut end, mut last, mut products) = (zero, zero, zero);
        let of_orders = |of: &[f64], k: usize| spread::<V>(&of[k * V::WIDTH..][..V::WIDTH]);
        for k in 0..n_orders {
            end = end.add(of_orders(values, n_orders - 1 - k));
            last = last.add(of_orders(largest, n_orders - 1 - k));
            products = products.add(of_orders(largest, k).mul(last));
        }
        let mut least = V::splat(f64::INFINITY);
        for i in 0..n {
            let [start, rate] = [rows[i].abs(), rows[row + i].abs()];
            let mut first = start.add(rate);
            for k in 2..n_orders.min(FIRST_TERMS) {
                first = first.add(rows[k * row + i].abs());
            }
            let larger = larger(rate.mul(step.abs()), start);
            for (least, (&larger, &first)) in
                least.as_scalars_mut().iter_mut().zip(larger.as_scalars().iter().zip(first.as_scalars()))
            {
                *least = if first != 0.0 && larger < *least { larger } else { *least };
            }
        }
        sums.clear();
        sums.extend((0..V::WIDTH).map(|lane| SeriesSums {
            total: of_form[0].get(lane),
            rest: of_form[1].get(lane),
            bends: bends.get(lane),
            end: end.get(lane),
            most: most.get(lane),
            state: of_state[0].get(lane),
            state_rest: of_state[1].get(lane),
            products: products.get(lane),
            least: least.get(lane),
        }));
    }
}

/// The larger of two, lane by lane; the second if one is not a number.
#[inline(always)]
fn larger<V: Wide>(size: V, most: V) -> V {
    let mut larger = most;
    for (most, &size) in larger.as_scalars_mut().iter_mut().zip(size.as_scalars()) {
        *most = if size > *most { size } else { *most };
    }
    larger
}
