//! The place of a trajectory in a block: its number, its clock, its steps.

/// One trajectory under way.
pub(super) struct Slot {
    pub(super) trajectory: usize,
    pub(super) occupied: bool,
    /// Time as an unevaluated sum, so that a long run does not lose its clock.
    pub(super) time: f64,
    pub(super) time_low: f64,
    pub(super) next_sample: usize,
    pub(super) n_steps: u64,
    pub(super) n_refused: u64,
    /// Equal steps that are left up to the next wanted time, and their size.
    pub(super) steps_left: u64,
    pub(super) equal_step: f64,
    /// Steps to be taken one by one, because several at once have left the finite numbers: a trajectory that fails does so
    /// at its last good step, however many its neighbours allow at once, and tangent vectors are rescaled in between.
    pub(super) careful_steps: u64,
    /// Exponents of the powers of two taken out of the tangent vectors.
    pub(super) scales: Vec<i64>,
    /// The wanted times within one step, after its start.
    pub(super) taus: Vec<f64>,
    /// Room for what the lane holds of values that are put into it.
    pub(super) stored: Vec<f64>,
    pub(super) reported: u64,
}

impl Slot {
    pub(super) fn empty(n_tangents: usize) -> Slot {
        Slot {
            trajectory: 0,
            occupied: false,
            time: 0.0,
            time_low: 0.0,
            next_sample: 0,
            n_steps: 0,
            n_refused: 0,
            steps_left: 0,
            equal_step: 0.0,
            careful_steps: 0,
            scales: vec![0; n_tangents],
            taus: vec![],
            stored: vec![],
            reported: 0,
        }
    }

    pub(super) fn take(&mut self, trajectory: usize, time: f64) {
        (self.trajectory, self.occupied, self.time, self.time_low) = (trajectory, true, time, 0.0);
        (self.next_sample, self.n_steps, self.n_refused, self.steps_left, self.reported) = (0, 0, 0, 0, 0);
        self.careful_steps = 0;
        self.scales.fill(0);
    }

    /// Time from now to `time`.
    #[inline(always)]
    pub(super) fn until(&self, time: f64) -> f64 {
        (time - self.time) - self.time_low
    }

    /// Adds `size` to the clock; the sum of both parts is exact to twice the working precision.
    #[inline(always)]
    pub(super) fn move_clock(&mut self, size: f64) {
        let sum = self.time + size;
        let virtual_size = sum - self.time;
        let error = (self.time - (sum - virtual_size)) + (size - virtual_size);
        let low = self.time_low + error;
        self.time = sum + low;
        self.time_low = low - (self.time - sum);
    }
}
