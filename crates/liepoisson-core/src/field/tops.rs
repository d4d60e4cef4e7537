//! Tops of one kind with parameters of their own, one for each trajectory: a register holds trajectories of different tops.

use super::top::{self, Constant, Constants, GROUP, N};
use super::{Field, Instance, Instantiate, Space, Top};
use crate::error::Error;
use crate::lanes::{Lane, Number};

/// Most trajectories that a block advances: a register of single precision holds them.
pub(super) const MOST_LANES: usize = 16;

/// The top of each trajectory of an ensemble, in their order.
#[derive(Clone, Debug, PartialEq)]
pub struct Tops {
    tops: Vec<Top>,
    /// Which constants vanish for all of them.
    vanish: [[bool; 3]; Constant::COUNT],
}

impl Tops {
    /// One top for each trajectory.
    ///
    /// # Errors
    /// No top.
    pub fn new(tops: Vec<Top>) -> Result<Tops, Error> {
        if tops.is_empty() {
            return Err(Error::Length { name: "tops", wanted: 1, got: 0 });
        }
        let vanishes = |constant: Constant, axis: usize| tops.iter().all(|top| top.vector(constant)[axis] == 0.0);
        let vanish = Constant::ALL.map(|constant| [0, 1, 2].map(|axis| vanishes(constant, axis)));
        Ok(Tops { tops, vanish })
    }
}

impl Space for Tops {
    fn n_components(&self) -> usize {
        N
    }

    fn n_trajectories(&self) -> Option<usize> {
        Some(self.tops.len())
    }
}

impl Instantiate for Tops {
    type Instance<'f> = LaneTops<'f>;

    fn instantiate(&self) -> LaneTops<'_> {
        LaneTops { tops: self, trajectories: [0; MOST_LANES], lanes: [[[0.0; MOST_LANES]; 3]; Constant::COUNT] }
    }
}

/// The tops of the trajectories that a block advances.
#[derive(Clone, Debug)]
pub struct LaneTops<'f> {
    tops: &'f Tops,
    /// Which top each lane has.
    trajectories: [usize; MOST_LANES],
    /// Their constants, lane by lane; zero for a lane that was always empty.
    lanes: [[[f64; MOST_LANES]; 3]; Constant::COUNT],
}

impl Constants for LaneTops<'_> {
    #[inline(always)]
    fn of<V: Lane>(&self, constant: Constant, axis: usize, first_lane: usize) -> V {
        let mut register = V::splat(0.0);
        let numbers = &self.lanes[constant as usize][axis][first_lane..first_lane + V::WIDTH];
        for (to, &number) in register.as_scalars_mut().iter_mut().zip(numbers) {
            *to = V::Number::of(number);
        }
        register
    }

    #[inline(always)]
    fn vanishes(&self, constant: Constant, axis: usize) -> bool {
        self.tops.vanish[constant as usize][axis]
    }

    fn in_lane(&self, lane: usize) -> &Top {
        &self.tops.tops[self.trajectories[lane]]
    }
}

impl Space for LaneTops<'_> {
    fn n_components(&self) -> usize {
        N
    }
}

impl Instance for LaneTops<'_> {
    fn assign(&mut self, lane: usize, trajectory: usize) {
        self.trajectories[lane] = trajectory;
        let top = &self.tops.tops[trajectory];
        for constant in Constant::ALL {
            for (numbers, &number) in self.lanes[constant as usize].iter_mut().zip(top.vector(constant)) {
                numbers[lane] = number;
            }
        }
    }
}

impl Field for LaneTops<'_> {
    fn group(&self) -> usize {
        GROUP
    }

    #[inline(always)]
    fn derive_work<V: Lane>(&self, rows: &mut [V], n_tangents: usize, k: usize) {
        let row = self.row(n_tangents);
        top::derive_work(self, &mut rows[k * row..(k + 1) * row]);
    }

    #[inline(always)]
    fn extend<V: Lane>(&self, rows: &mut [V], n_tangents: usize, k: usize) {
        top::extend(self, rows, n_tangents, k);
    }

    #[inline(always)]
    fn expand<V: Lane>(&self, rows: &mut [V], n_tangents: usize, order: usize) {
        top::expand(self, rows, n_tangents, order);
    }
}
