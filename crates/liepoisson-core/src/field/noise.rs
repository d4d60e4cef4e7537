//! Systems that are shaken: `dx = {x, H} dt + sum_k {x, H_k} o dW_k`, on request damped along the noise.
//!
//! The noise is that of Stratonovich, so each path of it is a Hamiltonian with a time-dependent coefficient, and the motion stays
//! on its leaf. With the damping `-(beta/2) sum_k {H, H_k} {x, H_k} dt` the law `exp(-beta H)`, with respect to the volume of
//! Liouville on a leaf, is stationary: the generator becomes `{f, H} + 1/2 sum_k e^(beta H) X_k (e^(-beta H) X_k f)` with
//! `X_k f = {f, H_k}`, and the fields `X_k` keep that volume.
//!
//! # References
//! Lázaro-Camí and Ortega, Rep. Math. Phys. 61 (2008) 65; Arnaudon, De Castro and Holm, J. Nonlinear Sci. 28 (2018) 91.

use super::{Space, SplitTerms};
use crate::error::Error;
use crate::random::two_normals;

/// Of which numbers the increments of a Brownian path consist: functions of trajectory, step and channel alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Path {
    /// What the numbers are drawn by.
    pub key: [u32; 2],
    /// Number of the first trajectory.
    pub first: u64,
    /// Steps that were taken before the first one.
    pub n_before: u64,
    /// Increments of the path that each step adds up: steps m times as long, of m increments each, follow the same path.
    pub n_increments: u32,
}

impl Path {
    /// The parts of an increment that fall into the two halves of a step of the length one.
    pub(crate) fn halves(&self, trajectory: usize, step: u64, channel: usize) -> [f64; 2] {
        let trajectory = self.first + trajectory as u64;
        let at = [trajectory as u32, (channel as u32) << 16 | (trajectory >> 32) as u32];
        let n = u64::from(self.n_increments);
        let mut halves = [0.0; 2];
        for k in 0..n {
            let fine = (self.n_before + step) * n + k;
            let numbers = two_normals(self.key, [fine as u32, (fine >> 32) as u32, at[0], at[1]]);
            for (half, number) in (2 * k..).zip(numbers) {
                halves[usize::from(half >= n)] += number;
            }
        }
        let scale = (0.5 / n as f64).sqrt();
        halves.map(|half| half * scale)
    }
}

/// Most noise Hamiltonians: what a counter has room for.
const MOST_CHANNELS: usize = 1 << 16;

/// What shakes a system.
#[derive(Clone, Debug, PartialEq)]
pub struct Noise {
    /// The noise Hamiltonians, each a sum of split terms whose flows commute.
    pub(crate) channels: Vec<SplitTerms>,
    /// The Hamiltonian itself, and beta: for the damping.
    pub(crate) damping: Option<(SplitTerms, f64)>,
    pub(crate) path: Path,
}

impl Noise {
    /// Some noise Hamiltonians, and what is damped: a Hamiltonian and the inverse temperature beta.
    ///
    /// That the flows of the split terms of each noise Hamiltonian commute is not checked.
    ///
    /// # Errors
    /// Terms of different dimensions, an inverse temperature that is not finite, no increments, more channels than 65,536.
    pub fn new(channels: Vec<SplitTerms>, damping: Option<(SplitTerms, f64)>, path: Path) -> Result<Noise, Error> {
        let energy = damping.iter().map(|(energy, _)| energy);
        let mut sizes = channels.iter().chain(energy).map(Space::n_components);
        if let Some(wanted) = sizes.next()
            && let Some(got) = sizes.find(|&got| got != wanted)
        {
            return Err(Error::Length { name: "noise", wanted, got });
        }
        if channels.len() > MOST_CHANNELS {
            return Err(Error::Length { name: "noise", wanted: MOST_CHANNELS, got: channels.len() });
        }
        if path.n_increments == 0 {
            return Err(Error::Length { name: "increments", wanted: 1, got: 0 });
        }
        match damping {
            Some((_, got)) if !got.is_finite() => Err(Error::ParameterNotFinite { name: "inverse_temperature", got }),
            damping => Ok(Noise { channels, damping, path }),
        }
    }
}

/// A field with noise.
#[derive(Clone, Debug)]
pub struct Noisy<F> {
    pub(crate) field: F,
    pub(crate) noise: Noise,
}

impl<F: Space> Noisy<F> {
    /// A field, shaken.
    ///
    /// # Errors
    /// The noise has another dimension.
    pub fn new(field: F, noise: Noise) -> Result<Noisy<F>, Error> {
        let wanted = field.n_components();
        match noise.channels.first().map(Space::n_components) {
            Some(got) if got != wanted => Err(Error::Length { name: "noise", wanted, got }),
            _ => Ok(Noisy { field, noise }),
        }
    }
}

impl<F: Space> Space for Noisy<F> {
    fn n_components(&self) -> usize {
        self.field.n_components()
    }
}
