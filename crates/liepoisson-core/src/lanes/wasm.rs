//! Registers of WebAssembly: 128 bits, without a fused multiply-add.

use super::sealed::Sealed;
use super::{Body, Lane, Number, Wide};
use std::arch::wasm32::*;

/// Two trajectories in a register.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct F64x2(v128);

/// Four trajectories in a register, in single precision.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct F32x4(v128);

impl Sealed for F64x2 {}
impl Sealed for F32x4 {}

#[inline(never)]
fn outlined<B: Body>(body: B) {
    body.run();
}

macro_rules! lane {
    ($lane:ident, $number:ty, $width:literal, $splat:ident, $add:ident, $sub:ident, $mul:ident, $abs:ident, $div:ident, $sqrt:ident) => {
        impl Lane for $lane {
            type Number = $number;
            const WIDTH: usize = $width;
            // those of the processors that browsers run on, of which many have no more
            const REGISTERS: usize = 16;
            #[inline(always)]
            fn splat(x: f64) -> Self {
                Self($splat(<$number as Number>::of(x)))
            }
            #[inline(always)]
            fn add(self, other: Self) -> Self {
                Self($add(self.0, other.0))
            }
            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                Self($sub(self.0, other.0))
            }
            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                Self($mul(self.0, other.0))
            }
            #[inline(always)]
            fn mul_add(self, factor: Self, addend: Self) -> Self {
                Self($add($mul(self.0, factor.0), addend.0))
            }
            #[inline(always)]
            fn neg_mul_add(self, factor: Self, addend: Self) -> Self {
                Self($sub(addend.0, $mul(self.0, factor.0)))
            }
            #[inline(always)]
            fn abs(self) -> Self {
                Self($abs(self.0))
            }
            #[inline(always)]
            fn div(self, other: Self) -> Self {
                Self($div(self.0, other.0))
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                Self($sqrt(self.0))
            }
            #[inline(always)]
            fn outline<B: Body>(body: B) {
                outlined(body);
            }
        }
    };
}

lane!(F64x2, f64, 2, f64x2_splat, f64x2_add, f64x2_sub, f64x2_mul, f64x2_abs, f64x2_div, f64x2_sqrt);
lane!(F32x4, f32, 4, f32x4_splat, f32x4_add, f32x4_sub, f32x4_mul, f32x4_abs, f32x4_div, f32x4_sqrt);

impl Wide for F64x2 {
    type Vector = [f64; 4];
    type TwoVectors = [[f64; 4]; 2];
    type Narrow = F32x4;
    #[inline(always)]
    fn narrow(low: Self, high: Self) -> F32x4 {
        let (low, high) = (f32x4_demote_f64x2_zero(low.0), f32x4_demote_f64x2_zero(high.0));
        F32x4(i32x4_shuffle::<0, 1, 4, 5>(low, high))
    }
    #[inline(always)]
    fn widen(narrow: F32x4) -> (Self, Self) {
        let high = i32x4_shuffle::<2, 3, 2, 3>(narrow.0, narrow.0);
        (F64x2(f64x2_promote_low_f32x4(narrow.0)), F64x2(f64x2_promote_low_f32x4(high)))
    }
}
