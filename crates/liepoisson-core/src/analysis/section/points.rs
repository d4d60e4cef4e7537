//! Points of a section, of one trajectory and of many: flat arrays, each number once in memory.

use crate::analysis::filled;
use crate::error::Error;

/// Points of one or many trajectories; of many, trajectory by trajectory, each in the order of travel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Points {
    /// Times.
    pub times: Vec<f64>,
    /// `(point, kept number)`.
    pub states: Vec<f64>,
    /// The sign of the function afterwards, in the order of travel: 1 or -1.
    pub signs: Vec<i8>,
}

impl Points {
    /// Adds a point.
    ///
    /// # Errors
    /// The bytes for which there is no memory.
    pub(super) fn push(&mut self, time: f64, kept: &[f64], sign: i8) -> Result<(), usize> {
        self.reserve(1, kept.len())?;
        self.times.push(time);
        self.states.extend_from_slice(kept);
        self.signs.push(sign);
        Ok(())
    }

    fn reserve(&mut self, points: usize, numbers: usize) -> Result<(), usize> {
        let has_room = self.times.try_reserve(points).is_ok()
            && self.states.try_reserve(numbers).is_ok()
            && self.signs.try_reserve(points).is_ok();
        if has_room { Ok(()) } else { Err((8 * (self.states.len() + numbers)).max(1)) }
    }

    fn clear(&mut self) {
        self.times.clear();
        self.states.clear();
        self.signs.clear();
    }
}

/// Points of many trajectories in the order in which these end.
#[derive(Default)]
pub(super) struct Collected {
    points: Points,
    /// Where the points of each trajectory are: the first, and how many.
    places: Vec<(usize, usize)>,
}

impl Collected {
    pub(super) fn new(trajectories: usize) -> Result<Collected, Error> {
        Ok(Collected { places: filled(trajectories, (0, 0))?, ..Collected::default() })
    }

    /// Takes the points of a trajectory, and leaves its arrays empty.
    ///
    /// # Errors
    /// The bytes for which there is no memory.
    pub(super) fn take(&mut self, trajectory: usize, points: &mut Points) -> Result<(), usize> {
        self.points.reserve(points.times.len(), points.states.len())?;
        self.places[trajectory] = (self.points.times.len(), points.times.len());
        self.points.times.extend_from_slice(&points.times);
        self.points.states.extend_from_slice(&points.states);
        self.points.signs.extend_from_slice(&points.signs);
        points.clear();
        Ok(())
    }

    /// The points trajectory by trajectory, and the number of points of each trajectory.
    ///
    /// In place, along the cycles of the permutation: a second copy of millions of states would double the memory.
    ///
    /// # Errors
    /// There is no memory for a list of the points.
    pub(super) fn arrange(self, width: usize) -> Result<(Points, Vec<usize>), Error> {
        let Collected { mut points, places } = self;
        let counts = places.iter().map(|&(_, count)| count).collect();
        let mut source: Vec<usize> = Vec::new();
        let n_points = points.times.len();
        source.try_reserve_exact(n_points).map_err(|_| Error::Memory { bytes: 8 * n_points })?;
        source.extend(places.into_iter().flat_map(|(first, count)| first..first + count));
        let mut row = vec![0.0; width];
        for start in 0..source.len() {
            if source[start] == start {
                continue;
            }
            row.copy_from_slice(&points.states[start * width..][..width]);
            let (time, sign) = (points.times[start], points.signs[start]);
            let mut to = start;
            loop {
                let from = std::mem::replace(&mut source[to], to);
                if from == start {
                    break;
                }
                points.states.copy_within(from * width..(from + 1) * width, to * width);
                points.times[to] = points.times[from];
                points.signs[to] = points.signs[from];
                to = from;
            }
            points.states[to * width..][..width].copy_from_slice(&row);
            (points.times[to], points.signs[to]) = (time, sign);
        }
        Ok((points, counts))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_come_trajectory_by_trajectory_in_whatever_order_trajectories_end() {
        let counts = [3, 0, 2, 1, 4];
        for ending in [[0, 1, 2, 3, 4], [4, 3, 2, 1, 0], [2, 4, 1, 0, 3], [3, 0, 4, 2, 1]] {
            let mut collected = Collected::new(counts.len()).unwrap();
            for trajectory in ending {
                let mut points = Points::default();
                for k in 0..counts[trajectory] {
                    let number = (10 * trajectory + k) as f64;
                    points.push(number, &[number, -number], if k % 2 == 0 { 1 } else { -1 }).unwrap();
                }
                collected.take(trajectory, &mut points).unwrap();
                assert_eq!(points, Points::default());
            }
            let (points, found) = collected.arrange(2).unwrap();
            assert_eq!(found, counts);
            let wanted: Vec<f64> = (0..5).flat_map(|m| (0..counts[m]).map(move |k| (10 * m + k) as f64)).collect();
            assert_eq!(points.times, wanted);
            assert_eq!(points.states, wanted.iter().flat_map(|&number| [number, -number]).collect::<Vec<_>>());
            assert_eq!(points.signs, [1, -1, 1, 1, -1, 1, 1, -1, 1, -1]);
        }
    }
}
