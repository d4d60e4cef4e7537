//! Memory that holds code, and the two ways between it and the rest: the one file of this folder with unsafe code.

use super::emit::MOST_SPILLED;
use crate::lanes::{Body, Lane};
use std::ffi::{c_int, c_void};
use std::marker::PhantomData;
use std::mem::MaybeUninit;

/// Bytes of a page.
pub(super) const PAGE: usize = 4096;

const READ: c_int = 1;
const WRITE: c_int = 2;
const EXECUTE: c_int = 4;
/// Memory of this process alone, without a file.
const PRIVATE: c_int = 0x22;

// SAFETY: as the C library declares them on 64-bit Linux.
unsafe extern "C" {
    fn mmap(at: *mut c_void, length: usize, protection: c_int, flags: c_int, file: c_int, offset: i64) -> *mut c_void;
    fn mprotect(at: *mut c_void, length: usize, protection: c_int) -> c_int;
    fn munmap(at: *mut c_void, length: usize) -> c_int;
}

/// Constants, and code after them; written once, then readable and executable.
#[derive(Debug)]
pub(super) struct Pages {
    start: *mut c_void,
    n_constants: usize,
    length: usize,
}

// SAFETY: nothing writes to the pages after they are made.
unsafe impl Send for Pages {}
// SAFETY: as above.
unsafe impl Sync for Pages {}

impl Pages {
    /// Pages with these numbers, which fill whole pages, and this code; none if the system refuses them.
    pub(super) fn new(constants: &[u64], code: &[u8]) -> Option<Pages> {
        let n_constants = size_of_val(constants);
        assert!(n_constants.is_multiple_of(PAGE) && !code.is_empty());
        let length = n_constants + code.len().next_multiple_of(PAGE);
        // SAFETY: new memory at a place that the system chooses.
        let start = unsafe { mmap(std::ptr::null_mut(), length, READ | WRITE, PRIVATE, -1, 0) };
        if start as isize == -1 {
            return None;
        }
        let pages = Pages { start, n_constants, length };
        // SAFETY: the pages are `length` bytes of this process, long enough for both, and nothing else knows of them. First they
        // are written, then none is writable.
        let is_protected = unsafe {
            let bytes: *mut u8 = start.cast();
            std::ptr::copy_nonoverlapping(constants.as_ptr().cast(), bytes, n_constants);
            std::ptr::copy_nonoverlapping(code.as_ptr(), bytes.add(n_constants), code.len());
            (n_constants == 0 || mprotect(start, n_constants, READ) == 0)
                && mprotect(bytes.add(n_constants).cast(), length - n_constants, READ | EXECUTE) == 0
        };
        is_protected.then_some(pages)
    }

    /// Runs the code from this byte on, on memory and with more for what it spills; whether up to its end.
    ///
    /// # Safety
    /// The byte is the first of code that was compiled for registers `V`, which this processor has, and all that it reads and writes
    /// is inside of memory that the caller may write.
    pub(super) unsafe fn run<V: Lane>(&self, at: usize, memory: *mut V) -> bool {
        let mut spilled = MaybeUninit::<[V; MOST_SPILLED]>::uninit();
        // SAFETY: the caller has said so; code reads what it has spilled, and spills at most so many registers.
        unsafe {
            let code: unsafe extern "sysv64" fn(*mut V, *mut V) -> u32 =
                std::mem::transmute(self.start.byte_add(self.n_constants + at));
            code(memory, spilled.as_mut_ptr().cast()) == 0
        }
    }
}

impl Drop for Pages {
    fn drop(&mut self) {
        // SAFETY: they were mapped by `new`, and nothing runs them any more.
        unsafe { munmap(self.start, self.length) };
    }
}

/// What computes the functions that recorded code calls.
pub(crate) trait Functions {
    /// Two results of a function.
    fn compute<V: Lane>(function: [u64; 2], x: V) -> [V; 2];
}

/// The address of what compiled code calls for a function.
pub(super) fn caller<V: Lane, F: Functions>() -> usize {
    call::<V, F> as *const () as usize
}

/// Replaces the first of two registers by the first result of a function, and the second by the second.
unsafe extern "sysv64" fn call<V: Lane, F: Functions>(registers: *mut [V; 2], function: *const [u64; 2]) {
    // SAFETY: compiled code gives two registers of its spill memory, of which the first is written, and two constants.
    let (x, function) = unsafe { (registers.cast::<V>().read(), *function) };
    let mut results = [x; 2];
    V::outline(Call { function, results: &mut results, functions: PhantomData::<F> });
    // SAFETY: as above.
    unsafe { registers.write(results) };
}

struct Call<'r, V, F> {
    function: [u64; 2],
    results: &'r mut [V; 2],
    functions: PhantomData<F>,
}

impl<V: Lane, F: Functions> Body for Call<'_, V, F> {
    #[inline(always)]
    fn run(self) {
        *self.results = F::compute(self.function, self.results[0]);
    }
}
