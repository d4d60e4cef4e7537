//! The compiled code of a field, on processors and systems for which there is some.

#[cfg(all(target_arch = "x86_64", target_os = "linux"))]
use super::plans::Plans;
use super::{Field, Straight};
use crate::lanes::{Lane, Simd};

/// A field whose series is compiled.
#[cfg_attr(not(all(target_arch = "x86_64", target_os = "linux")), allow(dead_code))]
pub(super) trait Compile: Field {
    /// Operations of its rates of change, for the state.
    fn n_operations(&self) -> usize;

    /// Of the registers of a series of so many orders the first ones that are kept once it is expanded.
    fn n_kept(&self, n_tangents: usize, n_orders: usize) -> usize;

    /// Registers from which those that the code of order `k` reads and writes are counted, beside the first.
    fn bases(&self, n_tangents: usize, k: usize) -> [usize; 3];
}

/// Code for each kind of registers and purpose; clones share it.
#[derive(Clone, Debug, Default)]
pub(super) struct Compiled {
    #[cfg(all(target_arch = "x86_64", target_os = "linux"))]
    plans: std::sync::Arc<Plans>,
}

#[cfg(all(target_arch = "x86_64", target_os = "linux"))]
impl Compiled {
    pub(super) const IS_POSSIBLE: bool = true;

    /// Expands a field up to `order`, as [`Field::expand`] does, if the code for that is there. False, and nothing, if not.
    #[inline(always)]
    pub(super) fn expand<V: Lane>(
        &self,
        field: &impl Compile,
        rows: &mut [V],
        n_tangents: usize,
        order: usize,
    ) -> bool {
        self.plans.expand(field, rows, n_tangents, order)
    }

    /// Runs straight code: [`Field::run_compiled`], of a field whose rates take so many operations.
    #[inline(always)]
    pub(super) fn run<V: Lane>(&self, n_operations: usize, straight: &impl Straight, memory: &mut [V]) -> bool {
        self.plans.run(n_operations, straight, memory)
    }

    /// The name of an instruction set, or that of code compiled for it, if there is some.
    pub(super) fn kernel(&self, simd: Simd) -> &'static str {
        self.plans.kernel(simd)
    }
}

#[cfg(not(all(target_arch = "x86_64", target_os = "linux")))]
impl Compiled {
    pub(super) const IS_POSSIBLE: bool = false;

    #[inline(always)]
    pub(super) fn expand<V: Lane>(&self, _: &impl Compile, _: &mut [V], _: usize, _: usize) -> bool {
        false
    }

    #[inline(always)]
    pub(super) fn run<V: Lane>(&self, _: usize, _: &impl Straight, _: &mut [V]) -> bool {
        false
    }

    pub(super) fn kernel(&self, simd: Simd) -> &'static str {
        simd.name()
    }
}
