//! Lanes: one source for AVX-512, AVX2, NEON, WebAssembly and scalar arithmetic. The one folder that knows SIMD.
//!
//! A [`Lane`] is a register that holds the same quantity of several trajectories. Only operations that IEEE 754
//! rounds correctly are offered (`+ - * /`, square root, fused multiply-add), so a trajectory has the same bits in a
//! register of any width. Code generic over `V: Lane` reaches the instructions of a processor through [`dispatch`].
//!
//! WebAssembly has no fused multiply-add, and one in software was measured to take 23 times as long as the two operations. There it
//! rounds twice ([`IS_FUSED`]), so bits are others than elsewhere; what needs an exact remainder asks for
//! [`Lane::fused_mul_add`].

#[macro_use]
mod scalar;
#[cfg(target_arch = "aarch64")]
mod neon;
mod pair;
#[cfg(all(target_arch = "x86_64", target_os = "linux"))]
pub(crate) mod recorded;
mod simd;
mod vectors;
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
mod wasm;
#[cfg(target_arch = "x86_64")]
mod x86;

pub use pair::Pair;
pub(crate) use simd::dispatch_widest;
pub use simd::{Simd, Task, dispatch};

/// Whether a multiply-add is rounded once.
pub const IS_FUSED: bool = !cfg!(target_family = "wasm");

/// How often a multiply-add is rounded: what bounds of round-off are multiplied by.
pub const ROUNDINGS: f64 = if IS_FUSED { 1.0 } else { 2.0 };

/// What unsafe code relies on is implemented in this folder alone.
mod sealed {
    pub trait Sealed {}
}
use sealed::Sealed;

/// The body of a function that works with one type of register; see [`Lane::outline`].
pub trait Body {
    /// Does it. Must be `#[inline(always)]`, like everything that it calls.
    fn run(self);
}

/// A few numbers of one trajectory in one register: its components, instead of trajectories, fill the register.
///
/// The numbers come in vectors of space, each with a fourth number beside its three components.
pub trait Vectors: Sealed + Copy + 'static {
    /// The first numbers of `numbers`, as many as there are.
    fn load(numbers: &[f64]) -> Self;
    /// Writes all numbers to the front of `numbers`.
    fn store(self, numbers: &mut [f64]);
    /// The same number in all places.
    fn splat(x: f64) -> Self;
    /// `self + other`.
    fn add(self, other: Self) -> Self;
    /// `self * other`, component by component.
    fn mul(self, other: Self) -> Self;
    /// `self * factor + addend`, component by component, rounded as [`Lane::mul_add`] is.
    fn mul_add(self, factor: Self, addend: Self) -> Self;
    /// `addend - self * factor`, component by component, rounded likewise.
    fn neg_mul_add(self, factor: Self, addend: Self) -> Self;
    /// `(2, 3, 1)` of each vector `(1, 2, 3)`; the fourth number stays.
    fn rotate(self) -> Self;
}

/// Two vectors of space in one register.
pub trait TwoVectors<One: Vectors>: Vectors {
    /// One vector twice.
    fn both(vector: One) -> Self;
    /// The first vector.
    fn first(self) -> One;
    /// The second vector.
    fn second(self) -> One;
    /// The second vector, then the first.
    fn swap(self) -> Self;
}

/// Instructions that code can be compiled to when the program runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instructions {
    /// AVX2 with fused multiply-add: 16 registers of 4 doubles.
    Vex,
    /// AVX-512: 32 registers of 8 doubles.
    Evex,
    /// Those of AVX2 for single numbers: 16 registers of one double.
    VexOne,
}

/// What a lane holds: `f64` or `f32`.
pub trait Number: Sealed + Copy + Send + Sync {
    /// The nearest such number.
    fn of(x: f64) -> Self;
    /// The same number in double precision.
    fn to_f64(self) -> f64;
    /// `self * factor + addend`, rounded as [`Lane::mul_add`] does.
    fn multiply_add(self, factor: Self, addend: Self) -> Self;
}

impl Number for f64 {
    #[inline(always)]
    fn of(x: f64) -> Self {
        x
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        self
    }
    #[inline(always)]
    fn multiply_add(self, factor: Self, addend: Self) -> Self {
        if IS_FUSED { self.mul_add(factor, addend) } else { self * factor + addend }
    }
}

impl Number for f32 {
    #[inline(always)]
    fn of(x: f64) -> Self {
        x as f32
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
    #[inline(always)]
    fn multiply_add(self, factor: Self, addend: Self) -> Self {
        if IS_FUSED { self.mul_add(factor, addend) } else { self * factor + addend }
    }
}

/// A register of `WIDTH` numbers, one per trajectory. Sealed: [`as_scalars`] relies on what its types consist of.
///
/// ```compile_fail,E0277
/// # use liepoisson_core::lanes::{Lane, Body};
/// #[derive(Clone, Copy)]
/// struct Mine(f64);
/// impl Lane for Mine {
///     type Number = f64;
///     const WIDTH: usize = 1_000_000; // a lie that reading would follow
///     const REGISTERS: usize = 16;
///     fn splat(x: f64) -> Self { Mine(x) }
///     fn add(self, _: Self) -> Self { self }
///     fn sub(self, _: Self) -> Self { self }
///     fn mul(self, _: Self) -> Self { self }
///     fn mul_add(self, _: Self, _: Self) -> Self { self }
///     fn neg_mul_add(self, _: Self, _: Self) -> Self { self }
///     fn abs(self) -> Self { self }
///     fn outline<B: Body>(body: B) { body.run() }
///     fn div(self, _: Self) -> Self { self }
///     fn sqrt(self) -> Self { self }
/// }
/// ```
pub trait Lane: Sealed + Copy + Send + Sync + 'static {
    /// What the register holds.
    type Number: Number;
    /// Number of trajectories that the register holds.
    const WIDTH: usize;
    /// Number of such registers that the processor has: what a kernel may keep at hand.
    const REGISTERS: usize;
    /// The same number in every lane, rounded to what a lane holds.
    fn splat(x: f64) -> Self;
    /// `self + other`.
    fn add(self, other: Self) -> Self;
    /// `self - other`.
    fn sub(self, other: Self) -> Self;
    /// `self * other`.
    fn mul(self, other: Self) -> Self;
    /// `self * factor + addend`, rounded once where [`IS_FUSED`] says so.
    fn mul_add(self, factor: Self, addend: Self) -> Self;
    /// `addend - self * factor`, rounded likewise.
    fn neg_mul_add(self, factor: Self, addend: Self) -> Self;
    /// `|self|`.
    fn abs(self) -> Self;
    /// Runs `body` as a function of its own, compiled for the instructions of this register.
    ///
    /// What a large piece of code does is compiled once for each register type, however many callers it has.
    fn outline<B: Body>(body: B);
    /// `self / other`.
    fn div(self, other: Self) -> Self;
    /// The square root, NaN of a negative number.
    fn sqrt(self) -> Self;

    /// The instructions that code for this register can be compiled to when the program runs.
    const INSTRUCTIONS: Option<Instructions> = None;

    /// Whether operations are written down instead of done.
    const IS_RECORDED: bool = false;

    /// `self`, zero in the lanes where `other` is zero.
    #[inline(always)]
    fn where_not_zero(mut self, other: Self) -> Self {
        for (to, other) in self.as_scalars_mut().iter_mut().zip(other.as_scalars()) {
            *to = if other.to_f64() == 0.0 { Self::Number::of(0.0) } else { *to };
        }
        self
    }

    /// `2^self` for whole numbers from -1022 to 1023; NaN for NaN, and any number for others.
    #[inline(always)]
    fn power_of_two(mut self) -> Self {
        for lane in self.as_scalars_mut() {
            let exponent = lane.to_f64();
            let biased = ((exponent as i64).clamp(-1022, 1023) + 1023) as u64;
            *lane = Self::Number::of(f64::from_bits(biased << 52) + 0.0 * exponent);
        }
        self
    }

    /// Records a function that is not made of operations of this trait, `function` being what the caller knows it by, with two results.
    /// None: to be computed.
    #[inline(always)]
    fn record_call(_function: [u64; 2], _x: Self) -> Option<[Self; 2]> {
        None
    }

    /// Records that the code is to be left where a lane is larger than that of `most`. False: to be looked at.
    #[inline(always)]
    fn record_limit(self, _most: Self) -> bool {
        false
    }

    /// Records a loop over `count` terms. Term `i` adds to the sums `[s][a][b]`, two numbers each, `s` being `i` modulo the number of
    /// those, the products of the left series `a`, whose first coefficients are given, with two of the right series `b`:
    /// `left[a]_i right[b]_(-1-i)` and `left[a]_i right[b]_(-i)`. `skips` leaves `a = b = 1` out. False: to be computed.
    #[inline(always)]
    fn record_products(_sums: &mut [Self], _left: &[Self], _right: &[Self], _skips: bool, _count: usize) -> bool {
        false
    }

    /// Records a loop over `count` terms. Term `i` adds to each sum `s` of the `products` `[s, a, b]`, in their order,
    /// `left[a]_i right[b]_i`: what lies `i step` registers behind a first left one, times what lies as many before a first right one.
    /// False: to be computed.
    #[inline(always)]
    fn record_sums(
        _sums: &mut [Self],
        _left: &[Self],
        _right: &[Self],
        _products: Vec<[usize; 3]>,
        _step: usize,
        _count: usize,
    ) -> bool {
        false
    }

    /// `self * factor + addend`, rounded once everywhere, in double precision: for what would be lost otherwise, and not for
    /// sums, since it is slow where it is done in software.
    #[inline(always)]
    fn fused_mul_add(self, factor: Self, addend: Self) -> Self {
        if IS_FUSED { self.mul_add(factor, addend) } else { fused_by_software(self, factor, addend) }
    }

    /// `addend - self * factor`, rounded likewise.
    #[inline(always)]
    fn fused_neg_mul_add(self, factor: Self, addend: Self) -> Self {
        if IS_FUSED {
            self.neg_mul_add(factor, addend)
        } else {
            fused_by_software(self.mul(Self::splat(-1.0)), factor, addend)
        }
    }

    /// The lanes as numbers.
    #[inline(always)]
    fn as_scalars(&self) -> &[Self::Number] {
        as_scalars(std::slice::from_ref(self))
    }

    /// The lanes as numbers that can be changed.
    #[inline(always)]
    fn as_scalars_mut(&mut self) -> &mut [Self::Number] {
        as_scalars_mut(std::slice::from_mut(self))
    }

    /// One lane in double precision.
    #[inline(always)]
    fn get(&self, lane: usize) -> f64 {
        self.as_scalars()[lane].to_f64()
    }

    /// Sets one lane, rounded to what it holds.
    #[inline(always)]
    fn set(&mut self, lane: usize, value: f64) {
        self.as_scalars_mut()[lane] = Self::Number::of(value);
    }
}

/// The fused multiply-add lane by lane, which Rust computes in software where a processor has none.
fn fused_by_software<V: Lane>(a: V, factor: V, addend: V) -> V {
    let mut result = addend;
    for lane in 0..V::WIDTH {
        result.set(lane, f64::mul_add(a.get(lane), factor.get(lane), addend.get(lane)));
    }
    result
}

/// A register of double-precision numbers, and the registers of the same size that go with it.
pub trait Wide: Lane<Number = f64> {
    /// A vector of space in a register.
    type Vector: Vectors;
    /// Two of them.
    type TwoVectors: TwoVectors<Self::Vector>;
    /// Single precision: twice as many lanes.
    type Narrow: Lane<Number = f32>;
    /// Rounds two registers into one: the lanes of `low`, then those of `high`.
    fn narrow(low: Self, high: Self) -> Self::Narrow;
    /// The inverse of `narrow`, which rounds nothing.
    fn widen(narrow: Self::Narrow) -> (Self, Self);
}

/// The numbers in a slice of registers, to be changed.
#[inline(always)]
pub fn as_scalars_mut<V: Lane>(registers: &mut [V]) -> &mut [V::Number] {
    // SAFETY: as for `as_scalars`.
    unsafe { std::slice::from_raw_parts_mut(registers.as_mut_ptr().cast(), registers.len() * V::WIDTH) }
}

/// The numbers in a slice of registers: register by register, lane by lane.
#[inline(always)]
pub fn as_scalars<V: Lane>(registers: &[V]) -> &[V::Number] {
    // SAFETY: every implementor of Lane (all of them in this folder) consists of exactly WIDTH numbers, without padding.
    unsafe { std::slice::from_raw_parts(registers.as_ptr().cast(), registers.len() * V::WIDTH) }
}

/// `c0 + z (c1 + z (...))`
#[inline(always)]
pub(crate) fn polynomial<V: Lane, const N: usize>(coefficients: &[f64; N], z: V) -> V {
    let mut sum = V::splat(coefficients[N - 1]);
    for i in (0..N - 1).rev() {
        sum = sum.mul_add(z, V::splat(coefficients[i]));
    }
    sum
}

/// Numbers as registers that hold one each.
///
/// # Panics
/// A register holds more than one.
#[inline(always)]
pub fn as_single_registers<V: Lane>(numbers: &mut [V::Number]) -> &mut [V] {
    assert!(V::WIDTH == 1 && align_of::<V>() == align_of::<V::Number>(), "registers of one number");
    // SAFETY: every implementor of Lane consists of exactly WIDTH numbers, without padding, and any bits are valid in
    // them; the alignment has just been compared.
    unsafe { std::slice::from_raw_parts_mut(numbers.as_mut_ptr().cast(), numbers.len()) }
}

impl Sealed for f64 {}
impl Sealed for f32 {}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers through registers and back.
    struct ThereAndBack;

    impl Task for ThereAndBack {
        type Output = ();

        fn run<V: Wide>(self) {
            let mut registers = vec![V::splat(0.0); 3];
            let numbers: Vec<f64> = (0..3 * V::WIDTH).map(|i| 0.5 + i as f64).collect();
            as_scalars_mut(&mut registers).copy_from_slice(&numbers);
            assert_eq!(as_scalars(&registers), numbers);
            for (i, &number) in numbers.iter().enumerate() {
                assert_eq!(registers[i / V::WIDTH].get(i % V::WIDTH), number);
            }
            registers[1].set(V::WIDTH - 1, -7.0);
            assert_eq!(as_scalars(&registers)[2 * V::WIDTH - 1], -7.0);
            let narrow = V::narrow(registers[0], registers[2]);
            assert_eq!(<V::Narrow as Lane>::WIDTH, 2 * V::WIDTH);
            assert_eq!(narrow.get(V::WIDTH), f64::from(numbers[2 * V::WIDTH] as f32));
            let (low, high) = V::widen(narrow);
            assert_eq!((low.as_scalars(), high.as_scalars()), (&numbers[..V::WIDTH], &numbers[2 * V::WIDTH..]));
        }
    }

    #[test]
    fn the_numbers_of_registers_are_those_of_the_slice() {
        for simd in Simd::ALL {
            dispatch(simd, ThereAndBack);
        }
    }

    #[test]
    fn numbers_are_registers_of_one() {
        let mut numbers = [1.0, 2.0, 3.0];
        as_single_registers::<f64>(&mut numbers)[1] = 5.0;
        assert_eq!(numbers, [1.0, 5.0, 3.0]);
        assert!(std::panic::catch_unwind(|| as_single_registers::<Pair<f64>>(&mut [1.0, 2.0]).len()).is_err());
    }

    #[test]
    fn vectors_of_space_turn() {
        struct Turn;
        impl Task for Turn {
            type Output = ();
            fn run<V: Wide>(self) {
                let numbers: Vec<f64> = (1..=8).map(f64::from).collect();
                let mut turned = vec![0.0; 8];
                V::TwoVectors::load(&numbers).rotate().store(&mut turned);
                assert_eq!(turned, [2.0, 3.0, 1.0, 4.0, 6.0, 7.0, 5.0, 8.0]);
                let mut second = vec![0.0; 4];
                V::TwoVectors::load(&numbers).swap().first().store(&mut second);
                assert_eq!(second, [5.0, 6.0, 7.0, 8.0]);
            }
        }
        Simd::ALL.into_iter().for_each(|simd| dispatch(simd, Turn));
    }
}
