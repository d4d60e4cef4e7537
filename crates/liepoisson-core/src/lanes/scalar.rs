//! A number as a register of one lane.

use super::{Body, Instructions, Lane, Number, Pair, Wide};

macro_rules! scalar_lane {
    ($lane:ty, $number:ty, |$inner:ident| $value:expr, $make:path, $outline:path, $instructions:expr) => {
        impl Lane for $lane {
            type Number = $number;
            const WIDTH: usize = 1;
            const REGISTERS: usize = 16;
            const INSTRUCTIONS: Option<Instructions> = $instructions;
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
                $make(self.number().multiply_add(factor.number(), addend.number()))
            }
            #[inline(always)]
            fn neg_mul_add(self, factor: Self, addend: Self) -> Self {
                $make((-self.number()).multiply_add(factor.number(), addend.number()))
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
pub(super) trait Inner {
    type Number;
    fn number(self) -> Self::Number;
}

#[inline(never)]
fn outline_plain<B: Body>(body: B) {
    body.run();
}

scalar_lane!(f64, f64, |x| x, std::convert::identity, outline_plain, None);
scalar_lane!(f32, f32, |x| x, std::convert::identity, outline_plain, None);

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
