//! Which instructions a processor has, and how a computation gets the registers that go with them.

use super::Wide;
#[cfg(target_arch = "aarch64")]
use super::neon;
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
use super::wasm;
#[cfg(target_arch = "x86_64")]
use super::x86;
use crate::error::Error;

/// An instruction set that the kernels are compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Simd {
    /// Eight trajectories at once.
    Avx512,
    /// Four trajectories at once.
    Avx2,
    /// Four trajectories at once, on ARM.
    Neon,
    /// Two trajectories at once, in WebAssembly.
    Wasm,
    /// One trajectory at a time.
    Scalar,
}

impl Simd {
    /// All of them, of each processor the widest first.
    pub const ALL: [Simd; 5] = [Simd::Avx512, Simd::Avx2, Simd::Neon, Simd::Wasm, Simd::Scalar];

    /// Its name in `LIEPOISSON_SIMD` and in results.
    pub fn name(self) -> &'static str {
        match self {
            Simd::Avx512 => "avx512",
            Simd::Avx2 => "avx2",
            Simd::Neon => "neon",
            Simd::Wasm => "simd128",
            Simd::Scalar => "scalar",
        }
    }

    /// Number of trajectories that go through the kernels at once.
    pub fn width(self) -> usize {
        match self {
            Simd::Avx512 => 8,
            Simd::Avx2 | Simd::Neon => 4,
            Simd::Wasm => 2,
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
                Simd::Neon | Simd::Wasm => false,
                Simd::Scalar => true,
            }
        }
        #[cfg(not(target_arch = "x86_64"))]
        {
            // every 64-bit ARM processor has NEON; Miri does not run all of its instructions
            self == Simd::Scalar
                || (self == Simd::Neon && cfg!(all(target_arch = "aarch64", not(miri))))
                || (self == Simd::Wasm && cfg!(all(target_arch = "wasm32", target_feature = "simd128")))
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

    /// The one for so many trajectories: [`Simd::from_environment`], but where the variable names none that with the fewest lanes for all
    /// of them. Lanes without a trajectory cost as much as others: one orbit of five typed systems was measured to take 1.5 to 1.9 times as
    /// long in registers of AVX-512 as number by number, and 1.1 to 1.5 times in those of AVX2; of four quadratic fields 1.07 to 1.2 times.
    ///
    /// # Errors
    /// As there.
    pub fn for_trajectories(count: usize) -> Result<Simd, Error> {
        let simd = Simd::from_environment()?;
        let is_named = std::env::var("LIEPOISSON_SIMD").is_ok_and(|wanted| !wanted.is_empty());
        Ok(match (simd, count) {
            _ if is_named => simd,
            (Simd::Avx512 | Simd::Avx2, 1) => Simd::Scalar,
            (Simd::Avx512, 2..=4) => Simd::Avx2,
            _ => simd,
        })
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
            Simd::Neon | Simd::Wasm | Simd::Scalar => task.run::<f64>(),
        }
    }
    #[cfg(target_arch = "aarch64")]
    {
        match simd {
            Simd::Neon if simd.is_available() => task.run::<neon::Four>(),
            _ => task.run::<f64>(),
        }
    }
    #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
    {
        match simd {
            #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
            Simd::Wasm => task.run::<wasm::F64x2>(),
            _ => task.run::<f64>(),
        }
    }
}

/// The same with the widest registers; where these are known without a processor, nothing else is compiled.
pub(crate) fn dispatch_widest<T: Task>(task: T) -> T::Output {
    #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
    return task.run::<wasm::F64x2>();
    #[cfg(not(all(target_arch = "wasm32", target_feature = "simd128")))]
    dispatch(Simd::widest(), task)
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
