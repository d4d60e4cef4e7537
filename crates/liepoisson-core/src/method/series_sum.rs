//! Sums of one power series at many times: times side by side in a register, coefficients in all of its lanes.

use crate::lanes::{Body, Simd, Task, Wide, dispatch};
use std::marker::PhantomData;

/// Where the coefficients of a series are: those of order `k` of component `i` at `k * order + i * component`.
#[derive(Clone, Copy)]
pub(super) struct Strides {
    pub(super) order: usize,
    pub(super) component: usize,
}

/// Fewer times are summed one by one.
pub(super) const FEW: usize = 2;

/// Values of a series of `n` components at `taus`: `n` numbers each, a `stride` apart.
///
/// By Horner's rule with fused operations, from the last term on: the same bits in a register of any width.
pub(super) struct Sums<'s, V> {
    pub(super) coefficients: &'s [f64],
    pub(super) strides: Strides,
    pub(super) order: usize,
    pub(super) n: usize,
    pub(super) taus: &'s [f64],
    pub(super) values: &'s mut [f64],
    pub(super) stride: usize,
    pub(super) registers: PhantomData<V>,
}

impl<V: Wide> Body for Sums<'_, V> {
    #[inline(always)]
    fn run(mut self) {
        for first in (0..self.taus.len()).step_by(V::WIDTH) {
            let taus = &self.taus[first..];
            let count = taus.len().min(V::WIDTH);
            let mut tau = V::splat(0.0);
            tau.as_scalars_mut()[..count].copy_from_slice(&taus[..count]);
            let mut i = 0;
            while i < self.n {
                i += match self.n - i {
                    9.. => self.components::<9>(i, tau, (first, count)),
                    6.. => self.components::<6>(i, tau, (first, count)),
                    3.. => self.components::<3>(i, tau, (first, count)),
                    _ => self.components::<1>(i, tau, (first, count)),
                };
            }
        }
    }
}

impl<V: Wide> Sums<'_, V> {
    /// Some components at the times of a register; as many as were computed.
    #[inline(always)]
    fn components<const M: usize>(&mut self, i: usize, tau: V, (first, count): (usize, usize)) -> usize {
        let Strides { order: row, component } = self.strides;
        let coefficients = |k: usize| &self.coefficients[k * row + i * component..][..(M - 1) * component + 1];
        let last = coefficients(self.order);
        let mut sums = [V::splat(0.0); M];
        for j in 0..M {
            sums[j] = V::splat(last[j * component]);
        }
        for k in (0..self.order).rev() {
            let terms = coefficients(k);
            for j in 0..M {
                sums[j] = sums[j].mul_add(tau, V::splat(terms[j * component]));
            }
        }
        for (lane, row) in self.values[first * self.stride..].chunks_mut(self.stride).take(count).enumerate() {
            for (value, sum) in row[i..i + M].iter_mut().zip(&sums) {
                *value = sum.as_scalars()[lane];
            }
        }
        M
    }
}

/// Values of a series that is kept, `(order, component)`, at `taus`, row by row; with the bits of a run that sums it on its way.
pub(crate) fn sum_series(simd: Simd, coefficients: &[f64], n: usize, taus: &[f64], values: &mut [f64]) {
    struct Outlined<'s>(&'s [f64], usize, &'s [f64], &'s mut [f64]);
    impl Task for Outlined<'_> {
        type Output = ();
        fn run<V: Wide>(self) {
            let Outlined(coefficients, n, taus, values) = self;
            let (strides, order) = (Strides { order: n, component: 1 }, coefficients.len() / n - 1);
            V::outline(Sums::<V> { coefficients, strides, order, n, taus, values, stride: n, registers: PhantomData });
        }
    }
    dispatch(simd, Outlined(coefficients, n, taus, values));
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn many_times_at_once_have_the_bits_of_one(
            n in 1_usize..20,
            order in 1_usize..30,
            taus in prop::collection::vec(-1.0_f64..1.0, 1..40),
            seed in 1_u64..1000,
        ) {
            let number = |k: u64| (seed.wrapping_mul(k + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 11) as f64 / 2.0_f64.powi(53) - 0.5;
            let coefficients: Vec<f64> = (0..(order + 1) * n).map(|k| number(k as u64)).collect();
            let wanted: Vec<f64> = taus.iter().flat_map(|tau| {
                let sum = |i: usize| {
                    let terms = coefficients[i..].iter().step_by(n).rev();
                    terms.copied().reduce(|sum, c| sum.mul_add(*tau, c)).unwrap_or(f64::NAN)
                };
                (0..n).map(sum).collect::<Vec<_>>()
            }).collect();
            for simd in Simd::ALL {
                let mut values = vec![f64::NAN; taus.len() * n];
                sum_series(simd, &coefficients, n, &taus, &mut values);
                prop_assert_eq!(&values, &wanted);
            }
        }
    }
}
