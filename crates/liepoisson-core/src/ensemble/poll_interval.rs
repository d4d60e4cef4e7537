//! How often a worker looks at the clock.

use super::clock::Instant;
use std::time::Duration;

/// Turns of the loop between two looks at the clock, and two reports of progress, where turns are short.
const TURNS_PER_REPORT: u64 = 64;

/// How often a worker looks at the clock, and how many equal steps it takes at once: as often and as many as the time that
/// they take allows. It begins carefully, since a step of a large field can take longer than a whole run of a small one.
pub(super) struct PollInterval {
    /// Turns between two looks.
    turns: u64,
    /// Turns that are left up to the next look.
    left: u64,
    /// Equal steps in a turn.
    pub(super) repeats: u64,
    last: Instant,
}

impl PollInterval {
    /// Between two looks there should be so much time: less costs more looks, more is felt as a delay.
    const SHORT: Duration = Duration::from_millis(25);
    const LONG: Duration = Duration::from_millis(100);

    pub(super) fn new() -> PollInterval {
        PollInterval { turns: 1, left: 1, repeats: 1, last: Instant::now() }
    }

    /// Counts a turn; whether it is time for a look.
    #[inline(always)]
    pub(super) fn is_time(&mut self, most_repeats: u64) -> bool {
        self.left -= 1;
        if self.left > 0 {
            return false;
        }
        let now = Instant::now();
        let elapsed = now.duration_since(self.last);
        if elapsed < PollInterval::SHORT {
            // more steps in a turn first: they cost less than more turns
            if self.repeats < most_repeats {
                self.repeats *= 2;
            } else {
                self.turns = (2 * self.turns).min(TURNS_PER_REPORT);
            }
        } else if elapsed > PollInterval::LONG {
            if self.turns > 1 {
                self.turns /= 2;
            } else {
                self.repeats = (self.repeats / 2).max(1);
            }
        }
        (self.left, self.last) = (self.turns, now);
        true
    }
}
