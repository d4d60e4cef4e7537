//! Lanes: one source for AVX-512, AVX2 and scalar arithmetic. The one file that knows SIMD.
//!
//! A [`Lane`] is a register that holds the same quantity of several trajectories. Only operations that IEEE 754
//! rounds correctly are offered (`+ - * /`, square root, fused multiply-add), so a trajectory has the same bits in a
//! register of any width. Code generic over `V: Lane` reaches the instructions of a processor through [`dispatch`].

use crate::error::Error;

/// A part of a computation that works with one type of register; see [`Lane::outline`].
pub trait Piece {
    /// Does it. Must be `#[inline(always)]`, like everything that it calls.
    fn run(self);
}

/// A vector of space in one register, with a fourth number beside its three components.
///
/// For one trajectory alone: the components of a vector, instead of trajectories, fill the register.
pub trait Triple: Copy {
    /// The first four of `numbers`.
    fn load(numbers: &[f64]) -> Self;
    /// Writes all four numbers to the front of `numbers`.
    fn store(self, numbers: &mut [f64]);
    /// The same number four times.
    fn splat(x: f64) -> Self;
    /// `self + other`.
    fn add(self, other: Self) -> Self;
    /// `self - other`.
    fn sub(self, other: Self) -> Self;
    /// `self * other`, component by component.
    fn mul(self, other: Self) -> Self;
    /// `self * factor + addend`, component by component, rounded once.
    fn mul_add(self, factor: Self, addend: Self) -> Self;
    /// `(2, 3, 1)` of `(1, 2, 3)`; the fourth number stays.
    fn rotate(self) -> Self;
}

/// A register of `WIDTH` double-precision numbers, one per trajectory.
pub trait Lane: Copy + Send + Sync {
    /// Three components in a register, where the code for these lanes may use one.
    type Triple: Triple;
    /// Number of trajectories that the register holds.
    const WIDTH: usize;
    /// Number of such registers that the processor has: what a kernel may keep at hand.
    const REGISTERS: usize;
    /// The same number in every lane.
    fn splat(x: f64) -> Self;
    /// `self + other`.
    fn add(self, other: Self) -> Self;
    /// `self * other`.
    fn mul(self, other: Self) -> Self;
    /// `self * factor + addend`, rounded once.
    fn mul_add(self, factor: Self, addend: Self) -> Self;
    /// `addend - self * factor`, rounded once.
    fn neg_mul_add(self, factor: Self, addend: Self) -> Self;
    /// `|self|`.
    fn abs(self) -> Self;
    /// Runs `piece` as a function of its own, compiled for the instructions of this register.
    ///
    /// What a large piece of code does is compiled once for each register type, however many callers it has.
    fn outline<P: Piece>(piece: P);
    /// `self / other`.
    fn div(self, other: Self) -> Self;
    /// The square root, NaN of a negative number.
    fn sqrt(self) -> Self;

    /// The lanes as numbers.
    #[inline(always)]
    fn as_scalars(&self) -> &[f64] {
        as_scalars(std::slice::from_ref(self))
    }

    /// The lanes as numbers that can be changed.
    #[inline(always)]
    fn as_scalars_mut(&mut self) -> &mut [f64] {
        as_scalars_mut(std::slice::from_mut(self))
    }
}

/// The numbers in a slice of registers, to be changed.
#[inline(always)]
pub fn as_scalars_mut<V: Lane>(registers: &mut [V]) -> &mut [f64] {
    // SAFETY: as for `as_scalars`.
    unsafe { std::slice::from_raw_parts_mut(registers.as_mut_ptr().cast(), registers.len() * V::WIDTH) }
}

/// The numbers in a slice of registers: register by register, lane by lane.
#[inline(always)]
pub fn as_scalars<V: Lane>(registers: &[V]) -> &[f64] {
    // SAFETY: every implementor of Lane (all of them in this file) consists of exactly WIDTH f64, without padding.
    unsafe { std::slice::from_raw_parts(registers.as_ptr().cast(), registers.len() * V::WIDTH) }
}

impl Triple for [f64; 4] {
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
        [self[0] + other[0], self[1] + other[1], self[2] + other[2], self[3] + other[3]]
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        [self[0] - other[0], self[1] - other[1], self[2] - other[2], self[3] - other[3]]
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        [self[0] * other[0], self[1] * other[1], self[2] * other[2], self[3] * other[3]]
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        let mut result = addend;
        for i in 0..4 {
            result[i] = f64::mul_add(self[i], factor[i], addend[i]);
        }
        result
    }
    #[inline(always)]
    fn rotate(self) -> Self {
        [self[1], self[2], self[0], self[3]]
    }
}

impl Lane for f64 {
    type Triple = [f64; 4];
    const WIDTH: usize = 1;
    const REGISTERS: usize = 16;
    #[inline(always)]
    fn splat(x: f64) -> Self {
        x
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self + other
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self * other
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        f64::mul_add(self, factor, addend)
    }
    #[inline(always)]
    fn neg_mul_add(self, factor: Self, addend: Self) -> Self {
        f64::mul_add(-self, factor, addend)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        f64::abs(self)
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self / other
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    #[inline(never)]
    fn outline<P: Piece>(piece: P) {
        piece.run();
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::{Lane, Piece, Triple};
    use std::arch::x86_64::*;

    /// Eight trajectories in an AVX-512 register.
    #[derive(Clone, Copy)]
    #[repr(transparent)]
    pub struct F64x8(__m512d);

    /// Four trajectories in an AVX2 register.
    #[derive(Clone, Copy)]
    #[repr(transparent)]
    pub struct F64x4(__m256d);

    /// One trajectory, on a processor with AVX2.
    #[derive(Clone, Copy)]
    #[repr(transparent)]
    pub struct Single(f64);

    /// Three components and a fourth number in an AVX2 register.
    #[derive(Clone, Copy)]
    pub struct Avx2Triple(__m256d);

    // SAFETY (all blocks of this module): its types are private to this crate and are instantiated only behind
    // `dispatch`, which has checked that the processor has these instructions.
    #[allow(clippy::undocumented_unsafe_blocks)]
    impl Triple for Avx2Triple {
        #[inline(always)]
        fn load(numbers: &[f64]) -> Self {
            let numbers: &[f64; 4] = numbers.first_chunk().expect("a triple is stored as four numbers");
            Self(unsafe { _mm256_loadu_pd(numbers.as_ptr()) })
        }
        #[inline(always)]
        fn store(self, numbers: &mut [f64]) {
            let numbers: &mut [f64; 4] = numbers.first_chunk_mut().expect("a triple is stored as four numbers");
            unsafe { _mm256_storeu_pd(numbers.as_mut_ptr(), self.0) }
        }
        #[inline(always)]
        fn splat(x: f64) -> Self {
            Self(unsafe { _mm256_set1_pd(x) })
        }
        #[inline(always)]
        fn add(self, other: Self) -> Self {
            Self(unsafe { _mm256_add_pd(self.0, other.0) })
        }
        #[inline(always)]
        fn sub(self, other: Self) -> Self {
            Self(unsafe { _mm256_sub_pd(self.0, other.0) })
        }
        #[inline(always)]
        fn mul(self, other: Self) -> Self {
            Self(unsafe { _mm256_mul_pd(self.0, other.0) })
        }
        #[inline(always)]
        fn mul_add(self, factor: Self, addend: Self) -> Self {
            Self(unsafe { _mm256_fmadd_pd(self.0, factor.0, addend.0) })
        }
        #[inline(always)]
        fn rotate(self) -> Self {
            Self(unsafe { _mm256_permute4x64_pd::<0b11_00_10_01>(self.0) })
        }
    }

    #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
    #[inline(never)]
    fn outline_avx512<P: Piece>(piece: P) {
        piece.run();
    }

    #[target_feature(enable = "avx2,fma")]
    #[inline(never)]
    fn outline_avx2<P: Piece>(piece: P) {
        piece.run();
    }

    #[allow(clippy::undocumented_unsafe_blocks)]
    impl Lane for Single {
        type Triple = Avx2Triple;
        const WIDTH: usize = 1;
        const REGISTERS: usize = 16;
        #[inline(always)]
        fn splat(x: f64) -> Self {
            Self(x)
        }
        #[inline(always)]
        fn add(self, other: Self) -> Self {
            Self(self.0 + other.0)
        }
        #[inline(always)]
        fn mul(self, other: Self) -> Self {
            Self(self.0 * other.0)
        }
        #[inline(always)]
        fn mul_add(self, factor: Self, addend: Self) -> Self {
            Self(self.0.mul_add(factor.0, addend.0))
        }
        #[inline(always)]
        fn neg_mul_add(self, factor: Self, addend: Self) -> Self {
            Self((-self.0).mul_add(factor.0, addend.0))
        }
        #[inline(always)]
        fn abs(self) -> Self {
            Self(self.0.abs())
        }
        #[inline(always)]
        fn div(self, other: Self) -> Self {
            Self(self.0 / other.0)
        }
        #[inline(always)]
        fn sqrt(self) -> Self {
            Self(self.0.sqrt())
        }
        #[inline(always)]
        fn outline<P: Piece>(piece: P) {
            unsafe { outline_avx2(piece) }
        }
    }

    macro_rules! lane {
        ($lane:ident, $width:literal, $registers:literal, $splat:ident, $add:ident, $mul:ident, $fmadd:ident, $fnmadd:ident, $andnot:ident, $div:ident, $sqrt:ident, $outline:ident) => {
            #[allow(clippy::undocumented_unsafe_blocks)]
            impl Lane for $lane {
                type Triple = Avx2Triple;
                const WIDTH: usize = $width;
                const REGISTERS: usize = $registers;
                #[inline(always)]
                fn splat(x: f64) -> Self {
                    Self(unsafe { $splat(x) })
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
                fn outline<P: Piece>(piece: P) {
                    unsafe { $outline(piece) }
                }
            }
        };
    }

    lane!(
        F64x8,
        8,
        32,
        _mm512_set1_pd,
        _mm512_add_pd,
        _mm512_mul_pd,
        _mm512_fmadd_pd,
        _mm512_fnmadd_pd,
        _mm512_andnot_pd,
        _mm512_div_pd,
        _mm512_sqrt_pd,
        outline_avx512
    );
    lane!(
        F64x4,
        4,
        16,
        _mm256_set1_pd,
        _mm256_add_pd,
        _mm256_mul_pd,
        _mm256_fmadd_pd,
        _mm256_fnmadd_pd,
        _mm256_andnot_pd,
        _mm256_div_pd,
        _mm256_sqrt_pd,
        outline_avx2
    );
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

    /// The one named by the environment variable `LIEPOISSON_SIMD`, or else the widest.
    ///
    /// # Errors
    /// The variable names no known instruction set, or one that this processor lacks.
    pub fn from_environment() -> Result<Simd, Error> {
        let Ok(wanted) = std::env::var("LIEPOISSON_SIMD") else {
            return Ok(Simd::widest());
        };
        Simd::ALL
            .into_iter()
            .find(|simd| simd.name() == wanted && simd.is_available())
            .ok_or(Error::SimdNotAvailable { wanted })
    }
}

/// A computation that is generic over the register it runs in.
///
/// `run` and everything that it calls per step must be `#[inline(always)]`: only code inlined into the trampolines
/// of [`dispatch`] is compiled for the wider instruction sets.
pub trait Task {
    /// What the computation returns.
    type Output;
    /// Does it with registers of type `V`.
    fn run<V: Lane>(self) -> Self::Output;
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
    task.run::<x86::Single>()
}
