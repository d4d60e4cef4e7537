//! What is computed along trajectories: observers of the ensemble runner, one analysis per file.

pub mod lyapunov;
pub mod orbit;
