//! The threads of a run: how many have not ended yet, and what a panic of one does to the others.

use super::control::Control;
use crate::error::Error;
use std::sync::{Condvar, Mutex};
use std::time::Duration;

/// Stops the other workers when the one that holds it panics.
pub(super) struct CancelOnPanic<'c>(pub(super) &'c Control);

impl Drop for CancelOnPanic<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.cancel();
        }
    }
}

/// Workers that have not ended yet.
pub(super) struct Running {
    count: Mutex<usize>,
    all_ended: Condvar,
}

impl Running {
    pub(super) fn new(count: usize) -> Running {
        Running { count: Mutex::new(count), all_ended: Condvar::new() }
    }

    /// Counts one worker down when dropped, also when it panics.
    pub(super) fn guard(&self) -> impl Drop + Send + '_ {
        struct Guard<'r>(&'r Running);
        impl Drop for Guard<'_> {
            fn drop(&mut self) {
                let mut count = self.0.count.lock().expect("nobody panics while counting");
                *count -= 1;
                if *count == 0 {
                    self.0.all_ended.notify_all();
                }
            }
        }
        Guard(self)
    }

    pub(super) fn wait(&self, at_most: Duration) -> bool {
        let count = self.count.lock().expect("nobody panics while counting");
        let (count, _) = self
            .all_ended
            .wait_timeout_while(count, at_most, |count| *count > 0)
            .expect("nobody panics while counting");
        *count == 0
    }
}

/// Runs `work` on a thread of its own, and `watch` on the calling thread: the function that it is given waits for the end, at
/// most so long, and says whether it has come.
///
/// # Errors
/// No thread.
///
/// # Panics
/// As `work` does.
pub(crate) fn beside<R: Send>(
    control: &Control,
    watch: impl FnOnce(&dyn Fn(Duration) -> bool),
    work: impl FnOnce() -> R + Send,
) -> Result<R, Error> {
    let running = Running::new(1);
    std::thread::scope(|scope| {
        let counted = running.guard();
        let work = move || {
            let _counted = counted;
            let _cancels = CancelOnPanic(control);
            work()
        };
        let worker = std::thread::Builder::new().spawn_scoped(scope, work).map_err(|_| Error::Threads { wanted: 1 })?;
        watch(&|at_most| running.wait(at_most));
        worker.join().map_err(|panic| std::panic::resume_unwind(panic))
    })
}
