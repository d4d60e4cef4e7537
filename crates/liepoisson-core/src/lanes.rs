//! Lanes: one source for AVX-512, AVX2 and scalar arithmetic. The one file that knows SIMD.
//!
//! A [`Lane`] is a register that holds the same quantity of several trajectories. Only operations that IEEE 754
//! rounds correctly are offered (`+ - *`, fused multiply-add), so a trajectory has the same bits in a register of
//! any width. Code generic over `V: Lane` reaches the instructions of a processor through [`dispatch`].

use crate::error::Error;

/// A register of `WIDTH` double-precision numbers, one per trajectory.
pub trait Lane: Copy + Send + Sync {
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

    /// The lanes as numbers.
    #[inline(always)]
    fn as_scalars(&self) -> &[f64] {
        as_scalars(std::slice::from_ref(self))
    }

    /// The lanes as numbers that can be changed.
    #[inline(always)]
    fn as_scalars_mut(&mut self) -> &mut [f64] {
        // SAFETY: every implementor is `repr(transparent)` or a primitive made of exactly WIDTH f64.
        unsafe { std::slice::from_raw_parts_mut(std::ptr::from_mut(self).cast(), Self::WIDTH) }
    }
}

/// The numbers in a slice of registers: register by register, lane by lane.
#[inline(always)]
pub fn as_scalars<V: Lane>(registers: &[V]) -> &[f64] {
    // SAFETY: every implementor of Lane (all of them in this file) consists of exactly WIDTH f64, without padding.
    unsafe { std::slice::from_raw_parts(registers.as_ptr().cast(), registers.len() * V::WIDTH) }
}

impl Lane for f64 {
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
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::Lane;
    use std::arch::x86_64::*;

    /// Eight trajectories in an AVX-512 register.
    #[derive(Clone, Copy)]
    #[repr(transparent)]
    pub struct F64x8(__m512d);

    /// Four trajectories in an AVX2 register.
    #[derive(Clone, Copy)]
    #[repr(transparent)]
    pub struct F64x4(__m256d);

    macro_rules! lane {
        ($lane:ident, $width:literal, $registers:literal, $splat:ident, $add:ident, $mul:ident, $fmadd:ident, $fnmadd:ident, $andnot:ident) => {
            // SAFETY (all blocks below): the types are private to this crate and are instantiated only behind
            // `dispatch`, which has checked that the processor has these instructions.
            #[allow(clippy::undocumented_unsafe_blocks)]
            impl Lane for $lane {
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
        _mm512_andnot_pd
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
        _mm256_andnot_pd
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
            // SAFETY: the guard has just found the instruction.
            Simd::Scalar if is_x86_feature_detected!("fma") => unsafe { run_fma(task) },
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
#[target_feature(enable = "fma")]
fn run_fma<T: Task>(task: T) -> T::Output {
    task.run::<f64>()
}
