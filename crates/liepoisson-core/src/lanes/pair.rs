//! Two registers as one.

use super::sealed::Sealed;
use super::{Body, Lane};

impl<T: Sealed> Sealed for Pair<T> {}

/// Two registers side by side.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct Pair<T>(pub(super) [T; 2]);

impl<T: Lane> Pair<T> {
    /// Two registers as one.
    #[inline(always)]
    pub(crate) fn new(registers: [T; 2]) -> Self {
        Pair(registers)
    }

    /// Them.
    #[inline(always)]
    pub(crate) fn registers(self) -> [T; 2] {
        self.0
    }

    #[inline(always)]
    fn map(self, operation: impl Fn(T) -> T) -> Self {
        Pair([operation(self.0[0]), operation(self.0[1])])
    }
    #[inline(always)]
    fn zip(self, other: Self, operation: impl Fn(T, T) -> T) -> Self {
        Pair([operation(self.0[0], other.0[0]), operation(self.0[1], other.0[1])])
    }
}

impl<T: Lane> Lane for Pair<T> {
    type Number = T::Number;
    const WIDTH: usize = 2 * T::WIDTH;
    const REGISTERS: usize = T::REGISTERS / 2;
    const IS_RECORDED: bool = T::IS_RECORDED;
    #[inline(always)]
    fn splat(x: f64) -> Self {
        Pair([T::splat(x); 2])
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, T::add)
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, T::sub)
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, T::mul)
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        let ([a, b], [c, d], [e, f]) = (self.0, factor.0, addend.0);
        Pair([a.mul_add(c, e), b.mul_add(d, f)])
    }
    #[inline(always)]
    fn neg_mul_add(self, factor: Self, addend: Self) -> Self {
        let ([a, b], [c, d], [e, f]) = (self.0, factor.0, addend.0);
        Pair([a.neg_mul_add(c, e), b.neg_mul_add(d, f)])
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.map(T::abs)
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.zip(other, T::div)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.map(T::sqrt)
    }
    #[inline(always)]
    fn outline<B: Body>(body: B) {
        T::outline(body);
    }
    #[inline(always)]
    fn where_not_zero(self, other: Self) -> Self {
        self.zip(other, T::where_not_zero)
    }
    #[inline(always)]
    fn power_of_two(self) -> Self {
        self.map(T::power_of_two)
    }
    #[inline(always)]
    fn record_call(function: [u64; 2], x: Self) -> Option<[Self; 2]> {
        let [[a, b], [c, d]] = [T::record_call(function, x.0[0])?, T::record_call(function, x.0[1])?];
        Some([Pair([a, c]), Pair([b, d])])
    }
    #[inline(always)]
    fn record_limit(self, most: Self) -> bool {
        self.0[0].record_limit(most.0[0]) && self.0[1].record_limit(most.0[1])
    }
}
