//! Lanes: one source for AVX-512, AVX2 and scalar arithmetic. The one file that knows SIMD.
//!
//! A [`Lane`] is a register that holds the same quantity of several trajectories. Only operations that IEEE 754
//! rounds correctly are offered (`+ - * /`, square root, fused multiply-add), so a trajectory has the same bits in a
//! register of any width. Code generic over `V: Lane` reaches the instructions of a processor through [`dispatch`].

use crate::error::Error;

/// What unsafe code relies on is implemented in this file alone.
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
    /// `self * factor + addend`, component by component, rounded once.
    fn mul_add(self, factor: Self, addend: Self) -> Self;
    /// `addend - self * factor`, component by component, rounded once.
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

/// What a lane holds: `f64` or `f32`.
pub trait Number: Sealed + Copy + Send + Sync {
    /// The nearest such number.
    fn of(x: f64) -> Self;
    /// The same number in double precision.
    fn to_f64(self) -> f64;
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
    /// `self * factor + addend`, rounded once.
    fn mul_add(self, factor: Self, addend: Self) -> Self;
    /// `addend - self * factor`, rounded once.
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
    // SAFETY: every implementor of Lane (all of them in this file) consists of exactly WIDTH numbers, without padding.
    unsafe { std::slice::from_raw_parts(registers.as_ptr().cast(), registers.len() * V::WIDTH) }
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
impl Sealed for [f64; 4] {}
impl<T: Sealed> Sealed for [T; 2] {}
impl<T: Sealed> Sealed for Pair<T> {}

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
        std::array::from_fn(|i| f64::mul_add(self[i], factor[i], addend[i]))
    }
    #[inline(always)]
    fn neg_mul_add(self, factor: Self, addend: Self) -> Self {
        std::array::from_fn(|i| f64::mul_add(-self[i], factor[i], addend[i]))
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

macro_rules! scalar_lane {
    ($lane:ty, $number:ty, |$inner:ident| $value:expr, $make:path, $outline:path) => {
        impl Lane for $lane {
            type Number = $number;
            const WIDTH: usize = 1;
            const REGISTERS: usize = 16;
            #[inline(always)]
            fn splat(x: f64) -> Self {
                $make(<$number as Number>::of(x))
            }
            #[inline(always)]
            fn add(self, other: Self) -> Self {
                $make(self.number() + other.number())
            }
            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                $make(self.number() - other.number())
            }
            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                $make(self.number() * other.number())
            }
            #[inline(always)]
            fn mul_add(self, factor: Self, addend: Self) -> Self {
                $make(<$number>::mul_add(self.number(), factor.number(), addend.number()))
            }
            #[inline(always)]
            fn neg_mul_add(self, factor: Self, addend: Self) -> Self {
                $make(<$number>::mul_add(-self.number(), factor.number(), addend.number()))
            }
            #[inline(always)]
            fn abs(self) -> Self {
                $make(<$number>::abs(self.number()))
            }
            #[inline(always)]
            fn div(self, other: Self) -> Self {
                $make(self.number() / other.number())
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                $make(<$number>::sqrt(self.number()))
            }
            #[inline(always)]
            fn outline<B: Body>(body: B) {
                $outline(body)
            }
        }

        impl Inner for $lane {
            type Number = $number;
            #[inline(always)]
            fn number(self) -> $number {
                let $inner = self;
                $value
            }
        }
    };
}

/// The number in a register that holds one.
trait Inner {
    type Number;
    fn number(self) -> Self::Number;
}

#[inline(never)]
fn outline_plain<B: Body>(body: B) {
    body.run();
}

scalar_lane!(f64, f64, |x| x, std::convert::identity, outline_plain);
scalar_lane!(f32, f32, |x| x, std::convert::identity, outline_plain);

/// Two registers side by side.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct Pair<T>([T; 2]);

impl<T: Lane> Pair<T> {
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
        let [a, b] = [0, 1].map(|i| self.0[i].mul_add(factor.0[i], addend.0[i]));
        Pair([a, b])
    }
    #[inline(always)]
    fn neg_mul_add(self, factor: Self, addend: Self) -> Self {
        let [a, b] = [0, 1].map(|i| self.0[i].neg_mul_add(factor.0[i], addend.0[i]));
        Pair([a, b])
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
}

impl Wide for f64 {
    type Vector = [f64; 4];
    type TwoVectors = [[f64; 4]; 2];
    type Narrow = Pair<f32>;
    #[inline(always)]
    fn narrow(low: Self, high: Self) -> Pair<f32> {
        Pair([low as f32, high as f32])
    }
    #[inline(always)]
    fn widen(narrow: Pair<f32>) -> (Self, Self) {
        (narrow.0[0].into(), narrow.0[1].into())
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::{Body, Inner, Lane, Number, Pair, Sealed, TwoVectors, Vectors, Wide};
    use std::arch::x86_64::*;

    /// Eight trajectories in an AVX-512 register.
    #[derive(Clone, Copy)]
    #[repr(transparent)]
    pub struct F64x8(__m512d);

    /// Four trajectories in an AVX2 register.
    #[derive(Clone, Copy)]
    #[repr(transparent)]
    pub struct F64x4(__m256d);

    /// Sixteen trajectories in an AVX-512 register, in single precision.
    #[derive(Clone, Copy)]
    #[repr(transparent)]
    pub struct F32x16(__m512);

    /// Eight trajectories in an AVX2 register, in single precision.
    #[derive(Clone, Copy)]
    #[repr(transparent)]
    pub struct F32x8(__m256);

    /// One number, on a processor with AVX2.
    #[derive(Clone, Copy)]
    #[repr(transparent)]
    pub struct One<T>(T);

    /// A vector of space and a fourth number in an AVX2 register.
    #[derive(Clone, Copy)]
    pub struct Avx2Vector(__m256d);

    /// Two of them in an AVX-512 register.
    #[derive(Clone, Copy)]
    pub struct Avx512Vectors(__m512d);

    impl Sealed for F64x8 {}
    impl Sealed for F64x4 {}
    impl Sealed for F32x16 {}
    impl Sealed for F32x8 {}
    impl<T: Sealed> Sealed for One<T> {}
    impl Sealed for Avx2Vector {}
    impl Sealed for Avx512Vectors {}

    // SAFETY (all blocks of this module): its types are private to this crate and are instantiated only behind
    // `dispatch`, which has checked that the processor has these instructions.
    macro_rules! vectors {
        ($vectors:ident, $count:literal, $load:ident, $store:ident, $set1:ident, $add:ident, $mul:ident, $fmadd:ident, $fnmadd:ident, $permute:ident) => {
            #[allow(clippy::undocumented_unsafe_blocks)]
            impl Vectors for $vectors {
                #[inline(always)]
                fn load(numbers: &[f64]) -> Self {
                    let numbers: &[f64; $count] = numbers.first_chunk().expect("a vector is stored as four numbers");
                    Self(unsafe { $load(numbers.as_ptr()) })
                }
                #[inline(always)]
                fn store(self, numbers: &mut [f64]) {
                    let numbers: &mut [f64; $count] =
                        numbers.first_chunk_mut().expect("a vector is stored as four numbers");
                    unsafe { $store(numbers.as_mut_ptr(), self.0) }
                }
                #[inline(always)]
                fn splat(x: f64) -> Self {
                    Self(unsafe { $set1(x) })
                }
                #[inline(always)]
                fn add(self, other: Self) -> Self {
                    Self(unsafe { $add(self.0, other.0) })
                }
                #[inline(always)]
                fn mul(self, other: Self) -> Self {
                    Self(unsafe { $mul(self.0, other.0) })
                }
                #[inline(always)]
                fn mul_add(self, factor: Self, addend: Self) -> Self {
                    Self(unsafe { $fmadd(self.0, factor.0, addend.0) })
                }
                #[inline(always)]
                fn neg_mul_add(self, factor: Self, addend: Self) -> Self {
                    Self(unsafe { $fnmadd(self.0, factor.0, addend.0) })
                }
                #[inline(always)]
                fn rotate(self) -> Self {
                    Self(unsafe { $permute::<0b11_00_10_01>(self.0) })
                }
            }
        };
    }

    vectors!(
        Avx2Vector,
        4,
        _mm256_loadu_pd,
        _mm256_storeu_pd,
        _mm256_set1_pd,
        _mm256_add_pd,
        _mm256_mul_pd,
        _mm256_fmadd_pd,
        _mm256_fnmadd_pd,
        _mm256_permute4x64_pd
    );
    vectors!(
        Avx512Vectors,
        8,
        _mm512_loadu_pd,
        _mm512_storeu_pd,
        _mm512_set1_pd,
        _mm512_add_pd,
        _mm512_mul_pd,
        _mm512_fmadd_pd,
        _mm512_fnmadd_pd,
        _mm512_permutex_pd
    );

    #[allow(clippy::undocumented_unsafe_blocks)]
    impl TwoVectors<Avx2Vector> for Avx512Vectors {
        #[inline(always)]
        fn both(vector: Avx2Vector) -> Self {
            Self(unsafe { _mm512_broadcast_f64x4(vector.0) })
        }
        #[inline(always)]
        fn first(self) -> Avx2Vector {
            Avx2Vector(unsafe { _mm512_castpd512_pd256(self.0) })
        }
        #[inline(always)]
        fn second(self) -> Avx2Vector {
            Avx2Vector(unsafe { _mm512_extractf64x4_pd::<1>(self.0) })
        }
        #[inline(always)]
        fn swap(self) -> Self {
            Self(unsafe { _mm512_shuffle_f64x2::<0b01_00_11_10>(self.0, self.0) })
        }
    }

    #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
    #[inline(never)]
    fn outline_avx512<B: Body>(body: B) {
        body.run();
    }

    #[target_feature(enable = "avx2,fma")]
    #[inline(never)]
    fn outline_avx2<B: Body>(body: B) {
        body.run();
    }

    #[inline(always)]
    fn outline_one<B: Body>(body: B) {
        // SAFETY: as all blocks of this module.
        unsafe { outline_avx2(body) }
    }

    scalar_lane!(One<f64>, f64, |x| x.0, One, outline_one);
    scalar_lane!(One<f32>, f32, |x| x.0, One, outline_one);

    impl Wide for One<f64> {
        type Vector = Avx2Vector;
        type TwoVectors = [Avx2Vector; 2];
        type Narrow = Pair<One<f32>>;
        #[inline(always)]
        fn narrow(low: Self, high: Self) -> Self::Narrow {
            Pair([One(low.0 as f32), One(high.0 as f32)])
        }
        #[inline(always)]
        fn widen(narrow: Self::Narrow) -> (Self, Self) {
            (One(narrow.0[0].0.into()), One(narrow.0[1].0.into()))
        }
    }

    macro_rules! lane {
        ($lane:ident, $number:ty, $width:literal, $registers:literal, $splat:ident, $add:ident, $sub:ident, $mul:ident, $fmadd:ident, $fnmadd:ident, $andnot:ident, $div:ident, $sqrt:ident, $outline:ident) => {
            #[allow(clippy::undocumented_unsafe_blocks)]
            impl Lane for $lane {
                type Number = $number;
                const WIDTH: usize = $width;
                const REGISTERS: usize = $registers;
                #[inline(always)]
                fn splat(x: f64) -> Self {
                    Self(unsafe { $splat(<$number as Number>::of(x)) })
                }
                #[inline(always)]
                fn add(self, other: Self) -> Self {
                    Self(unsafe { $add(self.0, other.0) })
                }
                #[inline(always)]
                fn sub(self, other: Self) -> Self {
                    Self(unsafe { $sub(self.0, other.0) })
                }
                #[inline(always)]
                fn mul(self, other: Self) -> Self {
                    Self(unsafe { $mul(self.0, other.0) })
                }
                #[inline(always)]
                fn mul_add(self, factor: Self, addend: Self) -> Self {
                    Self(unsafe { $fmadd(self.0, factor.0, addend.0) })
                }
                #[inline(always)]
                fn neg_mul_add(self, factor: Self, addend: Self) -> Self {
                    Self(unsafe { $fnmadd(self.0, factor.0, addend.0) })
                }
                #[inline(always)]
                fn abs(self) -> Self {
                    Self(unsafe { $andnot($splat(-0.0), self.0) })
                }
                #[inline(always)]
                fn div(self, other: Self) -> Self {
                    Self(unsafe { $div(self.0, other.0) })
                }
                #[inline(always)]
                fn sqrt(self) -> Self {
                    Self(unsafe { $sqrt(self.0) })
                }
                #[inline(always)]
                fn outline<B: Body>(body: B) {
                    unsafe { $outline(body) }
                }
            }
        };
    }

    lane!(
        F64x8,
        f64,
        8,
        32,
        _mm512_set1_pd,
        _mm512_add_pd,
        _mm512_sub_pd,
        _mm512_mul_pd,
        _mm512_fmadd_pd,
        _mm512_fnmadd_pd,
        _mm512_andnot_pd,
        _mm512_div_pd,
        _mm512_sqrt_pd,
        outline_avx512
    );
    lane!(
        F32x16,
        f32,
        16,
        32,
        _mm512_set1_ps,
        _mm512_add_ps,
        _mm512_sub_ps,
        _mm512_mul_ps,
        _mm512_fmadd_ps,
        _mm512_fnmadd_ps,
        _mm512_andnot_ps,
        _mm512_div_ps,
        _mm512_sqrt_ps,
        outline_avx512
    );
    lane!(
        F64x4,
        f64,
        4,
        16,
        _mm256_set1_pd,
        _mm256_add_pd,
        _mm256_sub_pd,
        _mm256_mul_pd,
        _mm256_fmadd_pd,
        _mm256_fnmadd_pd,
        _mm256_andnot_pd,
        _mm256_div_pd,
        _mm256_sqrt_pd,
        outline_avx2
    );
    lane!(
        F32x8,
        f32,
        8,
        16,
        _mm256_set1_ps,
        _mm256_add_ps,
        _mm256_sub_ps,
        _mm256_mul_ps,
        _mm256_fmadd_ps,
        _mm256_fnmadd_ps,
        _mm256_andnot_ps,
        _mm256_div_ps,
        _mm256_sqrt_ps,
        outline_avx2
    );

    #[allow(clippy::undocumented_unsafe_blocks)]
    impl Wide for F64x8 {
        type Vector = Avx2Vector;
        type TwoVectors = Avx512Vectors;
        type Narrow = F32x16;
        #[inline(always)]
        fn narrow(low: Self, high: Self) -> F32x16 {
            unsafe {
                let low = _mm512_castps256_ps512(_mm512_cvtpd_ps(low.0));
                F32x16(_mm512_insertf32x8::<1>(low, _mm512_cvtpd_ps(high.0)))
            }
        }
        #[inline(always)]
        fn widen(narrow: F32x16) -> (Self, Self) {
            unsafe {
                let (low, high) = (_mm512_castps512_ps256(narrow.0), _mm512_extractf32x8_ps::<1>(narrow.0));
                (F64x8(_mm512_cvtps_pd(low)), F64x8(_mm512_cvtps_pd(high)))
            }
        }
    }

    #[allow(clippy::undocumented_unsafe_blocks)]
    impl Wide for F64x4 {
        type Vector = Avx2Vector;
        type TwoVectors = [Avx2Vector; 2];
        type Narrow = F32x8;
        #[inline(always)]
        fn narrow(low: Self, high: Self) -> F32x8 {
            unsafe { F32x8(_mm256_set_m128(_mm256_cvtpd_ps(high.0), _mm256_cvtpd_ps(low.0))) }
        }
        #[inline(always)]
        fn widen(narrow: F32x8) -> (Self, Self) {
            unsafe {
                let (low, high) = (_mm256_castps256_ps128(narrow.0), _mm256_extractf128_ps::<1>(narrow.0));
                (F64x4(_mm256_cvtps_pd(low)), F64x4(_mm256_cvtps_pd(high)))
            }
        }
    }
}

/// An instruction set that the kernels are compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Simd {
    /// Eight trajectories at once.
    Avx512,
    /// Four trajectories at once.
    Avx2,
    /// One trajectory at a time.
    Scalar,
}

impl Simd {
    /// All of them, widest first.
    pub const ALL: [Simd; 3] = [Simd::Avx512, Simd::Avx2, Simd::Scalar];

    /// Its name in `LIEPOISSON_SIMD` and in results.
    pub fn name(self) -> &'static str {
        match self {
            Simd::Avx512 => "avx512",
            Simd::Avx2 => "avx2",
            Simd::Scalar => "scalar",
        }
    }

    /// Number of trajectories in one register.
    pub fn width(self) -> usize {
        match self {
            Simd::Avx512 => 8,
            Simd::Avx2 => 4,
            Simd::Scalar => 1,
        }
    }

    /// Whether this processor has it.
    pub fn is_available(self) -> bool {
        #[cfg(target_arch = "x86_64")]
        {
            match self {
                Simd::Avx512 => {
                    is_x86_feature_detected!("avx512f")
                        && is_x86_feature_detected!("avx512dq")
                        && is_x86_feature_detected!("avx512vl")
                        && Simd::Avx2.is_available()
                }
                Simd::Avx2 => is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma"),
                Simd::Scalar => true,
            }
        }
        #[cfg(not(target_arch = "x86_64"))]
        {
            self == Simd::Scalar
        }
    }

    /// The widest that this processor has.
    pub fn widest() -> Simd {
        Simd::ALL.into_iter().find(|simd| simd.is_available()).unwrap_or(Simd::Scalar)
    }

    /// The one named by the environment variable `LIEPOISSON_SIMD`, or else, also where that is empty, the widest.
    ///
    /// # Errors
    /// The variable names no known instruction set, or one that this processor lacks.
    pub fn from_environment() -> Result<Simd, Error> {
        let Ok(wanted) = std::env::var("LIEPOISSON_SIMD") else {
            return Ok(Simd::widest());
        };
        if wanted.is_empty() {
            return Ok(Simd::widest());
        }
        Simd::ALL
            .into_iter()
            .find(|simd| simd.name() == wanted && simd.is_available())
            .ok_or(Error::SimdNotAvailable { wanted })
    }
}

/// A computation that is generic over the register it runs in.
///
/// What it calls must be `#[inline(always)]` or go through [`Lane::outline`]: only code inlined into the trampolines of
/// [`dispatch`], or outlined, is compiled for the wider instruction sets.
pub trait Task {
    /// What the computation returns.
    type Output;
    /// Does it with registers of type `V`.
    fn run<V: Wide>(self) -> Self::Output;
}

/// Runs `task` with the registers of `simd`, or with scalars where the processor lacks them.
pub fn dispatch<T: Task>(simd: Simd, task: T) -> T::Output {
    #[cfg(target_arch = "x86_64")]
    {
        let simd = if simd.is_available() { simd } else { Simd::Scalar };
        match simd {
            // SAFETY: `is_available` has just found these instructions.
            Simd::Avx512 => unsafe { run_avx512(task) },
            // SAFETY: as above.
            Simd::Avx2 => unsafe { run_avx2(task) },
            // SAFETY: the guard has just found the instructions.
            Simd::Scalar if Simd::Avx2.is_available() => unsafe { run_single(task) },
            Simd::Scalar => task.run::<f64>(),
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    {
        let _ = simd;
        task.run::<f64>()
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
fn run_avx512<T: Task>(task: T) -> T::Output {
    task.run::<x86::F64x8>()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn run_avx2<T: Task>(task: T) -> T::Output {
    task.run::<x86::F64x4>()
}

/// Scalars with the fused multiply-add instruction; without it the operation is emulated, slowly, with the same bits.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn run_single<T: Task>(task: T) -> T::Output {
    task.run::<x86::One<f64>>()
}

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
