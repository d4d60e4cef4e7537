//! Registers of AVX2 and AVX-512, and a single number on a processor that has the former.

use super::scalar::Inner;
use super::sealed::Sealed;
use super::{Body, Instructions, Lane, Number, Pair, TwoVectors, Vectors, Wide};
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

scalar_lane!(One<f64>, f64, |x| x.0, One, outline_one, Some(Instructions::VexOne));
scalar_lane!(One<f32>, f32, |x| x.0, One, outline_one, None);

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
    ($lane:ident, $number:ty, $width:literal, $registers:literal, $instructions:expr, $splat:ident, $add:ident, $sub:ident, $mul:ident, $fmadd:ident, $fnmadd:ident, $andnot:ident, $div:ident, $sqrt:ident, $outline:ident) => {
        #[allow(clippy::undocumented_unsafe_blocks)]
        impl Lane for $lane {
            type Number = $number;
            const WIDTH: usize = $width;
            const REGISTERS: usize = $registers;
            const INSTRUCTIONS: Option<Instructions> = $instructions;
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
    Some(Instructions::Evex),
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
    None,
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
    Some(Instructions::Vex),
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
    None,
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
