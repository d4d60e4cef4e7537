//! One trajectory under way: its crossings, and on which side of the surface it is.

use super::survey::Mark;
use super::{Points, Uncertified};

/// One trajectory under way.
#[derive(Clone)]
pub(super) struct Slot {
    pub(super) crossings: Points,
    pub(super) touches: Points,
    pub(super) uncertified: Uncertified,
    /// The last sign of the function that is known, 0 if none is; at first, that before the start.
    pub(super) side: i8,
    /// Whether one was since the start.
    pub(super) had_side: bool,
    /// Whether the run ended before all of its last step was looked at.
    pub(super) is_cut: bool,
    /// What was known of the function before it was lost, until its sign is known again.
    pub(super) lost: Option<Lost>,
    /// The same once the sign is known again, and is the other one and one that is wanted.
    pub(super) regained: Option<Lost>,
    /// The point nearest to the surface since then, where the sign is not known.
    nearest: Option<Nearest>,
    /// Where in the step the last crossing that is wanted is behind it and its side is known, in units of the step.
    pub(super) served_at: f64,
    /// The length of its first step, NaN before it.
    pub(super) first_step: f64,
    /// Bytes for its points that could not be had.
    pub(super) refused: usize,
}

impl Default for Slot {
    fn default() -> Slot {
        let (crossings, touches) = (Points::default(), Points::default());
        Slot {
            crossings,
            touches,
            uncertified: Uncertified::NONE,
            side: 0,
            had_side: false,
            is_cut: false,
            lost: None,
            regained: None,
            nearest: None,
            served_at: 1.0,
            first_step: f64::NAN,
            refused: 0,
        }
    }
}

/// The function before a part on which it was lost.
#[derive(Clone, Copy)]
pub(super) struct Lost {
    /// Its sign.
    pub(super) side: i8,
    /// When it was lost.
    pub(super) time: f64,
}

/// A start is on the surface if the function there is within this multiple of its error.
const FAR: f64 = 1e3;

/// A place where the function is zero, or nearly so.
#[derive(Clone)]
pub(super) struct Found {
    pub(super) time: f64,
    pub(super) kept: Vec<f64>,
    /// Whether it belongs to the surface, by its guard.
    pub(super) is_on_surface: bool,
}

#[derive(Clone)]
struct Nearest {
    /// The size of the function.
    size: f64,
    found: Found,
}

impl Slot {
    /// Ends the stay near the surface without a decision: a touch, if it came from a side and did not start there.
    pub(super) fn leave_the_nearest(&mut self) {
        if let Some(Nearest { found, .. }) = self.nearest.take()
            && self.side != 0
            && self.had_side
        {
            self.touch(&found, self.side);
        }
    }

    /// Forgets the side that was given for a start which is far from the surface, on the other side.
    ///
    /// Near the surface the side is that of a run before, whose error was another one.
    pub(super) fn forget_refuted_side(&mut self, value: f64, error: f64) {
        if !self.had_side && value.abs() > FAR * error && self.side == -sign(value > 0.0) {
            self.side = 0;
        }
    }

    /// Draws the conclusion from what is known of the sign at a place of the step.
    pub(super) fn note(&mut self, mark: Mark, direction: i8, keep: &mut impl FnMut(f64) -> Found) {
        match mark {
            Mark::Near { at, size } => {
                if self.side != 0 && self.nearest.as_ref().is_none_or(|nearest| size < nearest.size) {
                    self.nearest = Some(Nearest { size, found: keep(at) });
                }
            }
            Mark::Zero { at, positive, .. } => self.cross(sign(positive), direction, &keep(at)),
            Mark::Sign { at, positive } => self.note_sign(sign(positive), direction, || keep(at)),
        }
    }

    /// The function has this sign from a place on that `keep` knows.
    fn note_sign(&mut self, side: i8, direction: i8, keep: impl FnOnce() -> Found) {
        let starts_here = !std::mem::replace(&mut self.had_side, true);
        self.regained =
            self.lost.take().filter(|lost| lost.side == -side && [0, side].contains(&direction)).or(self.regained);
        match self.nearest.take() {
            Some(Nearest { found, .. }) if self.side != side => self.cross(side, direction, &found),
            Some(_) if starts_here => {}
            Some(Nearest { found, .. }) => self.touch(&found, side),
            // between two steps, whose ends differ in round-off
            None if self.side == -side => self.cross(side, direction, &keep()),
            None => self.side = side,
        }
    }

    fn cross(&mut self, side: i8, direction: i8, found: &Found) {
        if found.is_on_surface && (direction == 0 || direction == side) {
            let pushed = self.crossings.push(found.time, &found.kept, side);
            self.refused = self.refused.max(pushed.err().unwrap_or(0));
        }
        (self.side, self.had_side, self.nearest) = (side, true, None);
    }

    fn touch(&mut self, found: &Found, side: i8) {
        if found.is_on_surface {
            let pushed = self.touches.push(found.time, &found.kept, side);
            self.refused = self.refused.max(pushed.err().unwrap_or(0));
        }
    }
}

fn sign(positive: bool) -> i8 {
    if positive { 1 } else { -1 }
}
