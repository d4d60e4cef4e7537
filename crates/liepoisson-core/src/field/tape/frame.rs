//! Where the coefficients of one order are, in the memory of a program.

use super::program::{Program, Size};
use super::steps::{Form, Slot};
use crate::lanes::Lane;

/// Where things are for one order of the series.
pub(super) struct Frame {
    pub(super) n_orders: usize,
    pub(super) n_tangents: usize,
    pub(super) k: usize,
    /// Whether the sums of this order were formed along with those of the order before.
    pub(super) is_second: bool,
}

/// Registers of one group: the state, or one tangent vector.
#[derive(Clone, Copy)]
pub(super) struct Group {
    pub(super) n_orders: usize,
    pub(super) k: usize,
    /// Number of its first series.
    first: usize,
    /// Its first single register.
    pub(super) singles: usize,
}

impl Frame {
    /// For order `k`, given the number of registers of components and work together.
    #[inline(always)]
    pub(super) fn new(program: &Program, registers: usize, row: usize, n_tangents: usize, k: usize) -> Frame {
        let singles = program.state.singles + n_tangents * program.tangent.singles;
        let series = program.state.series + n_tangents * program.tangent.series;
        let n_orders = (registers - singles) / (row + series);
        assert!(k < n_orders, "order {k} of a series of {n_orders}");
        Frame { n_orders, n_tangents, k, is_second: Frame::is_second(k, n_orders) }
    }

    /// Whether the sums of an order are formed along with those of the order before: sums are formed for two orders at once, so that
    /// the last order that needs some (`n_orders - 2`) is a second one. Orders 0 and 1 have no sums, and order 2 those of one term.
    #[inline(always)]
    pub(super) fn is_second(k: usize, n_orders: usize) -> bool {
        k > 2 && (n_orders - k).is_multiple_of(2)
    }

    #[inline(always)]
    pub(super) fn state(&self, program: &Program) -> Group {
        let singles = (program.state.series + self.n_tangents * program.tangent.series) * self.n_orders;
        Group { n_orders: self.n_orders, k: self.k, first: 0, singles }
    }

    #[inline(always)]
    pub(super) fn tangent(&self, program: &Program, tangent: usize) -> Group {
        let state = self.state(program);
        Group {
            first: program.state.series + tangent * program.tangent.series,
            singles: state.singles + program.state.singles + tangent * program.tangent.singles,
            ..state
        }
    }
}

impl Program {
    /// Registers for series of `n_orders` coefficients.
    pub(super) fn registers(&self, n_tangents: usize, n_orders: usize) -> usize {
        let of = |size: Size| size.series * n_orders + size.singles;
        of(self.state) + n_tangents * of(self.tangent)
    }
}

impl Group {
    #[inline(always)]
    pub(super) fn start(&self, series: usize) -> usize {
        (self.first + series) * self.n_orders
    }

    #[inline(always)]
    pub(super) fn series<'w, V>(&self, work: &'w [V], series: usize) -> &'w [V] {
        &work[self.start(series)..][..self.n_orders]
    }

    #[inline(always)]
    pub(super) fn at(&self, slot: Slot) -> usize {
        if slot.is_series { self.start(slot.index) + self.k } else { self.singles + slot.index }
    }

    /// The sum of products formed for this order.
    #[inline(always)]
    pub(super) fn formed<V: Lane>(&self, work: &[V], sums: usize, frame: &Frame) -> V {
        work[self.singles + sums + usize::from(frame.is_second)]
    }

    /// The coefficient of this order of a constant.
    #[inline(always)]
    pub(super) fn constant(&self, constant: f64) -> f64 {
        // A constant that is not finite, folded from instructions that fail, fails at every order.
        if self.k == 0 || !constant.is_finite() { constant } else { 0.0 }
    }

    #[inline(always)]
    pub(super) fn form<V: Lane>(&self, work: &[V], form: &Form) -> V {
        let constant = self.constant(form.constant);
        let (mut sum, mut terms) = (V::splat(constant), &form.terms[..]);
        if constant == 0.0
            && let Some((&(slot, c), others)) = terms.split_first()
        {
            (sum, terms) = (work[self.at(slot)].mul(V::splat(c)), others);
        }
        for &(slot, c) in terms {
            sum = work[self.at(slot)].mul_add(V::splat(c), sum);
        }
        sum
    }
}
