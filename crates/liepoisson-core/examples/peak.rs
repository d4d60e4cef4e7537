//! How fast can a core multiply and add? `cargo run --release --example peak`
//!
//! Fused multiply-adds on registers alone, two operations for each lane, for every instruction set of this processor (or
//! the one in `LIEPOISSON_SIMD`); the best of many short runs, in GFLOP/s. A kernel that loads its factors from memory
//! cannot reach it: it is the yardstick for those that share what they load.

use liepoisson_core::lanes::{Lane, Simd, Task, Wide, dispatch};
use std::hint::black_box;
use std::time::Instant;

/// Sums that do not wait for one another: two multiply-adds a cycle times a latency of four to five cycles need ten, and
/// with the two factors twelve still fit into the 16 registers of AVX2.
const SUMS: usize = 12;
const TERMS: usize = 20_000;
const RUNS: usize = 2_000;

/// `TERMS` multiply-adds to each of the sums, in double precision, or in single precision with the narrow registers.
struct Sums {
    single: bool,
}

impl Task for Sums {
    /// Lanes of a register.
    type Output = usize;

    #[inline(always)]
    fn run<V: Wide>(self) -> usize {
        if self.single { add_up::<V::Narrow>() } else { add_up::<V>() }
    }
}

#[inline(always)]
fn add_up<V: Lane>() -> usize {
    // sums stay near 1: the fixed point of s -> 0.5 s + 0.5
    let (factor, addend) = (V::splat(black_box(0.5)), V::splat(black_box(0.5)));
    let mut sums = [factor; SUMS];
    for sum in &mut sums {
        *sum = V::splat(black_box(1.0)); // each from its own: equal sums would be one to the compiler
    }
    for _ in 0..TERMS {
        for sum in &mut sums {
            *sum = sum.mul_add(factor, addend);
        }
    }
    black_box(&sums);
    V::WIDTH
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let forced = std::env::var_os("LIEPOISSON_SIMD").is_some();
    let only = Simd::from_environment()?;
    let wide = Simd::ALL.into_iter().filter(|&simd| simd.is_available() && (!forced || simd == only));
    // The compiler would join scalar sums into registers, which is no peak of scalar code: scalars only if asked for.
    for simd in wide.filter(|&simd| forced || simd != Simd::Scalar || only == Simd::Scalar) {
        for single in [false, true] {
            let mut best = f64::INFINITY;
            let mut lanes = 0;
            for _ in 0..RUNS {
                let start = Instant::now();
                lanes = dispatch(simd, Sums { single });
                best = best.min(start.elapsed().as_secs_f64());
            }
            let operations = (2 * SUMS * TERMS * lanes) as f64;
            let number = if single { "f32" } else { "f64" };
            println!("{} {number} {:.2} GFLOP/s", simd.name(), operations / best / 1e9);
        }
    }
    Ok(())
}
