//! Vectors of space where no register holds them: as arrays, and two registers for two.

use super::sealed::Sealed;
use super::{Number, TwoVectors, Vectors};

impl Sealed for [f64; 4] {}
impl<T: Sealed> Sealed for [T; 2] {}

impl Vectors for [f64; 4] {
    #[inline(always)]
    fn load(numbers: &[f64]) -> Self {
        [numbers[0], numbers[1], numbers[2], numbers[3]]
    }
    #[inline(always)]
    fn store(self, numbers: &mut [f64]) {
        numbers[..4].copy_from_slice(&self);
    }
    #[inline(always)]
    fn splat(x: f64) -> Self {
        [x; 4]
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        std::array::from_fn(|i| self[i] + other[i])
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        std::array::from_fn(|i| self[i] * other[i])
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        std::array::from_fn(|i| self[i].multiply_add(factor[i], addend[i]))
    }
    #[inline(always)]
    fn neg_mul_add(self, factor: Self, addend: Self) -> Self {
        std::array::from_fn(|i| (-self[i]).multiply_add(factor[i], addend[i]))
    }
    #[inline(always)]
    fn rotate(self) -> Self {
        [self[1], self[2], self[0], self[3]]
    }
}

/// Two vectors where no register holds both.
impl<T: Vectors> Vectors for [T; 2] {
    #[inline(always)]
    fn load(numbers: &[f64]) -> Self {
        [T::load(numbers), T::load(&numbers[4..])]
    }
    #[inline(always)]
    fn store(self, numbers: &mut [f64]) {
        self[0].store(numbers);
        self[1].store(&mut numbers[4..]);
    }
    #[inline(always)]
    fn splat(x: f64) -> Self {
        [T::splat(x); 2]
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        [self[0].add(other[0]), self[1].add(other[1])]
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        [self[0].mul(other[0]), self[1].mul(other[1])]
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        [self[0].mul_add(factor[0], addend[0]), self[1].mul_add(factor[1], addend[1])]
    }
    #[inline(always)]
    fn neg_mul_add(self, factor: Self, addend: Self) -> Self {
        [self[0].neg_mul_add(factor[0], addend[0]), self[1].neg_mul_add(factor[1], addend[1])]
    }
    #[inline(always)]
    fn rotate(self) -> Self {
        [self[0].rotate(), self[1].rotate()]
    }
}

impl<T: Vectors> TwoVectors<T> for [T; 2] {
    #[inline(always)]
    fn both(vector: T) -> Self {
        [vector; 2]
    }
    #[inline(always)]
    fn first(self) -> T {
        self[0]
    }
    #[inline(always)]
    fn second(self) -> T {
        self[1]
    }
    #[inline(always)]
    fn swap(self) -> Self {
        [self[1], self[0]]
    }
}
