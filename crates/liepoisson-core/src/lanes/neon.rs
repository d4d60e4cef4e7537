//! Registers of NEON, the 128 bits wide SIMD of every 64-bit ARM processor, and lanes of two such registers.

use super::sealed::Sealed;
use super::{Body, Lane, Number, Pair, Vectors, Wide};
use std::arch::aarch64::*;

/// Two trajectories in a NEON register.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct F64x2(float64x2_t);

/// Four trajectories in two registers: what the kernels are compiled for.
///
/// Not one register, although that leaves all 32 to a kernel. Cores of Apple start four fused multiply-adds a cycle and
/// end them four cycles later, so that sixteen that do not wait for one another must be under way; a group of a top has nine
/// components, and of other fields fewer. Two registers make twice as many. And what is done once for all lanes, such as counting
/// orders, is done for four: counted under an emulator, a step of one trajectory takes 10 to 35% fewer instructions
/// on quadratic fields and tapes, by Runge-Kutta, splitting 4 and Gauss, with mixed precision, and about the same otherwise. Only
/// the Taylor method on a top with tangent vectors takes 11% more, since it needs 32 registers to share loads between them.
/// Times on a processor were not measured.
pub type Four = Pair<F64x2>;

/// Four trajectories in a NEON register, in single precision.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct F32x4(float32x4_t);

/// A vector of space and a fourth number in two NEON registers.
#[derive(Clone, Copy)]
pub struct NeonVector(float64x2_t, float64x2_t);

impl Sealed for F64x2 {}
impl Sealed for F32x4 {}
impl Sealed for NeonVector {}

// SAFETY (all blocks of this module): NEON, with fused multiply-add, is part of the baseline of the targets that this
// module is compiled for; so nothing has to be detected. What is read and written through a pointer are four numbers of a
// slice that has them.
macro_rules! lane {
    ($lane:ident, $number:ty, $width:literal, $splat:ident, $add:ident, $sub:ident, $mul:ident, $fma:ident, $fms:ident, $abs:ident, $div:ident, $sqrt:ident) => {
        #[allow(clippy::undocumented_unsafe_blocks)]
        impl Lane for $lane {
            type Number = $number;
            const WIDTH: usize = $width;
            const REGISTERS: usize = 32;
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
                Self(unsafe { $fma(addend.0, self.0, factor.0) })
            }
            #[inline(always)]
            fn neg_mul_add(self, factor: Self, addend: Self) -> Self {
                Self(unsafe { $fms(addend.0, self.0, factor.0) })
            }
            #[inline(always)]
            fn abs(self) -> Self {
                Self(unsafe { $abs(self.0) })
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
                outline_neon(body);
            }
        }
    };
}

#[inline(never)]
fn outline_neon<B: Body>(body: B) {
    body.run();
}

lane!(
    F64x2,
    f64,
    2,
    vdupq_n_f64,
    vaddq_f64,
    vsubq_f64,
    vmulq_f64,
    vfmaq_f64,
    vfmsq_f64,
    vabsq_f64,
    vdivq_f64,
    vsqrtq_f64
);
lane!(
    F32x4,
    f32,
    4,
    vdupq_n_f32,
    vaddq_f32,
    vsubq_f32,
    vmulq_f32,
    vfmaq_f32,
    vfmsq_f32,
    vabsq_f32,
    vdivq_f32,
    vsqrtq_f32
);

#[allow(clippy::undocumented_unsafe_blocks)]
impl Wide for F64x2 {
    type Vector = NeonVector;
    type TwoVectors = [NeonVector; 2];
    type Narrow = F32x4;
    #[inline(always)]
    fn narrow(low: Self, high: Self) -> F32x4 {
        F32x4(unsafe { vcvt_high_f32_f64(vcvt_f32_f64(low.0), high.0) })
    }
    #[inline(always)]
    fn widen(narrow: F32x4) -> (Self, Self) {
        unsafe { (F64x2(vcvt_f64_f32(vget_low_f32(narrow.0))), F64x2(vcvt_high_f64_f32(narrow.0))) }
    }
}

impl Wide for Four {
    type Vector = NeonVector;
    type TwoVectors = [NeonVector; 2];
    type Narrow = Pair<F32x4>;
    #[inline(always)]
    fn narrow(low: Self, high: Self) -> Pair<F32x4> {
        Pair([F64x2::narrow(low.0[0], low.0[1]), F64x2::narrow(high.0[0], high.0[1])])
    }
    #[inline(always)]
    fn widen(narrow: Pair<F32x4>) -> (Self, Self) {
        let (low, high) = (F64x2::widen(narrow.0[0]), F64x2::widen(narrow.0[1]));
        (Pair([low.0, low.1]), Pair([high.0, high.1]))
    }
}

// Both halves are written out: a closure over them was seen to become a function that is called.
#[allow(clippy::undocumented_unsafe_blocks)]
impl Vectors for NeonVector {
    #[inline(always)]
    fn load(numbers: &[f64]) -> Self {
        let numbers: &[f64; 4] = numbers.first_chunk().expect("a vector is stored as four numbers");
        Self(unsafe { vld1q_f64(numbers.as_ptr()) }, unsafe { vld1q_f64(numbers[2..].as_ptr()) })
    }
    #[inline(always)]
    fn store(self, numbers: &mut [f64]) {
        let numbers: &mut [f64; 4] = numbers.first_chunk_mut().expect("a vector is stored as four numbers");
        unsafe {
            vst1q_f64(numbers.as_mut_ptr(), self.0);
            vst1q_f64(numbers[2..].as_mut_ptr(), self.1);
        }
    }
    #[inline(always)]
    fn splat(x: f64) -> Self {
        let both = unsafe { vdupq_n_f64(x) };
        Self(both, both)
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        unsafe { Self(vaddq_f64(self.0, other.0), vaddq_f64(self.1, other.1)) }
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        unsafe { Self(vmulq_f64(self.0, other.0), vmulq_f64(self.1, other.1)) }
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        unsafe { Self(vfmaq_f64(addend.0, self.0, factor.0), vfmaq_f64(addend.1, self.1, factor.1)) }
    }
    #[inline(always)]
    fn neg_mul_add(self, factor: Self, addend: Self) -> Self {
        unsafe { Self(vfmsq_f64(addend.0, self.0, factor.0), vfmsq_f64(addend.1, self.1, factor.1)) }
    }
    #[inline(always)]
    fn rotate(self) -> Self {
        // (1, 2) and (3, 4): the middle two, and the first beside the last
        unsafe { Self(vextq_f64::<1>(self.0, self.1), vcopyq_laneq_f64::<0, 0>(self.1, self.0)) }
    }
}
