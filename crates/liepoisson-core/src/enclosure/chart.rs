//! Coordinates on a section within a level of constants of motion.
//!
//! A frame is a point `c` and a matrix `B`, whose columns are directions `q` in which sets extend, the flow, and directions
//! `w`, as many as there are constants of motion `G`. The chart is
//! ```text
//! chi(q) = c + B (q, 0, w(q)),   G(chi(q)) = level,   |w_k| <= reach .
//! ```
//! All exact numbers are doubles, so the section, on which the coordinate of the flow is zero, is known exactly; its normal
//! is a row of the inverse of `B`, which is enclosed.

use super::failure::Failure;
use super::interval::Interval;
use super::linear::{approximate_inverse, inverse};
use super::lohner::orthonormal;
use super::matrix::{IntervalVector, Matrix, combine, is_inside, meet, mid, points};
use super::polynomial::Sign;
use super::program::Program;
use super::section::Section;

/// Coordinates around a point, of which nothing is assumed but that `B` is regular.
#[derive(Clone, Debug)]
pub struct Frame {
    center: Vec<f64>,
    columns: Matrix<f64>,
    /// Contains the inverse of the columns.
    back: Matrix<Interval>,
    /// The columns of the directions in which sets extend.
    directions: Vec<usize>,
    flow: usize,
    constants: Vec<usize>,
}

/// What is known of a chart on a box of `q`.
#[derive(Clone, Debug)]
pub struct Lift {
    /// Values of `w`.
    pub w: IntervalVector,
    /// Derivatives of `w` by `q`.
    pub slope: Matrix<Interval>,
    /// All coordinates in the order of the columns.
    pub coordinates: IntervalVector,
    /// A box that contains the states.
    pub states: IntervalVector,
}

impl Frame {
    /// The frame whose columns are `n_first` directions, the flow, further directions, and `n_constants` for the constants.
    ///
    /// # Errors
    /// It is not sure that the matrix is regular.
    ///
    /// # Panics
    /// If the shapes do not fit.
    pub fn new(center: &[f64], columns: Matrix<f64>, n_first: usize, n_constants: usize) -> Result<Frame, Failure> {
        let n = center.len();
        assert!(columns.n_rows() == n && columns.n_columns() == n && n_first + n_constants < n, "shape of the frame");
        let back = inverse(&columns.enclosed()).ok_or(Failure::Singular)?;
        let is_unknown = points(center).iter().any(|component| component.is_unknown());
        if is_unknown || back.is_unknown() {
            return Err(Failure::Singular);
        }
        let directions = (0..n - n_constants).filter(|&column| column != n_first).collect();
        let constants = (n - n_constants..n).collect();
        Ok(Frame { center: center.to_vec(), columns, back, directions, flow: n_first, constants })
    }

    /// Coordinates around a point: orthonormal directions `q` across the flow and the gradients, the flow, the gradients.
    ///
    /// # Errors
    /// The gradients and the flow may be dependent at the point, as at an equilibrium.
    pub fn around(point: &[f64], field: &Program, constants: &Program) -> Result<Frame, Failure> {
        let (n, m) = (point.len(), constants.n_rows());
        let at = points(point);
        let gradients = constants.jacobian(&at).mid();
        let rates = mid(&field.values(&at));
        if m + 1 >= n || rates.iter().chain(gradients.entries()).any(|entry| !entry.is_finite()) {
            return Err(Failure::Singular);
        }
        let across = Matrix::from_fn(n, m + 1, |i, j| if j == 0 { rates[i] } else { gradients[(j - 1, i)] });
        let basis = orthonormal(&across, &vec![1.0; m + 1]);
        let n_directions = n - m - 1;
        let columns =
            Matrix::from_fn(
                n,
                n,
                |i, j| {
                    if j < n_directions { basis[(i, m + 1 + j)] } else { across[(i, j - n_directions)] }
                },
            );
        Frame::new(point, columns, n_directions, m)
    }

    /// The center.
    pub fn center(&self) -> &[f64] {
        &self.center
    }

    /// The matrix.
    pub fn columns(&self) -> &Matrix<f64> {
        &self.columns
    }

    /// Number of coordinates `q`.
    pub fn n_directions(&self) -> usize {
        self.directions.len()
    }

    /// The image under a reflection `S`: `S c`, `S B`.
    pub fn reflected(&self, signs: &[Sign]) -> Frame {
        let n = self.center.len();
        Frame {
            center: self.center.iter().zip(signs).map(|(&component, sign)| sign.of(component)).collect(),
            columns: Matrix::from_fn(n, n, |i, j| signs[i].of(self.columns[(i, j)])),
            back: Matrix::from_fn(n, n, |i, j| signs[j].of(self.back[(i, j)])),
            ..self.clone()
        }
    }

    /// The hyperplane on which the coordinate of the flow is zero.
    pub fn section(&self) -> Section {
        Section::Affine { normal: self.back.row(self.flow).to_vec(), through: self.center.clone() }
    }

    /// Rows of the inverse that give the coordinates `q`.
    pub(super) fn to_directions(&self) -> Matrix<Interval> {
        self.back.block(&self.directions, &(0..self.center.len()).collect::<Vec<_>>())
    }

    /// Rows of the inverse that give the coordinates `w`.
    pub(super) fn to_constants(&self) -> Matrix<Interval> {
        self.back.block(&self.constants, &(0..self.center.len()).collect::<Vec<_>>())
    }

    /// Differences from the center.
    pub(super) fn relative(&self, states: &[Interval]) -> IntervalVector {
        combine(states, &points(&self.center), |state, center| state - center)
    }

    /// Columns of the coordinates `q`, and of `w`.
    pub(super) fn split(&self, matrix: &Matrix<Interval>) -> (Matrix<Interval>, Matrix<Interval>) {
        let rows: Vec<usize> = (0..matrix.n_rows()).collect();
        (matrix.block(&rows, &self.directions), matrix.block(&rows, &self.constants))
    }

    fn coordinates(&self, q: &[Interval], w: &[Interval]) -> IntervalVector {
        let mut coordinates = vec![Interval::ZERO; self.center.len()];
        self.directions.iter().zip(q).for_each(|(&place, &value)| coordinates[place] = value);
        self.constants.iter().zip(w).for_each(|(&place, &value)| coordinates[place] = value);
        coordinates
    }

    fn states(&self, coordinates: &[Interval]) -> IntervalVector {
        let moved = self.columns.enclosed().apply(coordinates);
        combine(&points(&self.center), &moved, |center, moved| center + moved)
    }

    /// A double near a small lift, the states of a lift described from there, and their coordinates in the frame `[B, I]`:
    /// `m + B (y - y_m) + (c + B y_m - m)`.
    pub(super) fn described(&self, lift: &Lift, from: &Lift) -> (Vec<f64>, IntervalVector) {
        let middle = mid(&from.coordinates);
        let exact = self.states(&points(&middle));
        let center = mid(&exact);
        let moved = combine(&lift.coordinates, &points(&middle), |y, middle| y - middle);
        let rounded = combine(&exact, &points(&center), |exact, center| exact - center);
        (center, [moved, rounded].concat())
    }

    /// `[B, I]`.
    pub(super) fn columns_and_identity(&self) -> Matrix<f64> {
        let n = self.center.len();
        let unit = |i: usize, j: usize| if i == j { 1.0 } else { 0.0 };
        Matrix::from_fn(n, 2 * n, |i, j| if j < n { self.columns[(i, j)] } else { unit(i, j - n) })
    }

    /// Proves that for every `q` of a box and every value of the constants in `level` there is exactly one `w` with
    /// `|w_k| <= reach`, and encloses it.
    ///
    /// Krawczyk's operator for the equations `G(c + B (q, 0, w)) = level` in `w`, with `q` and the level as parameters.
    ///
    /// # Errors
    /// It is not sure that there is exactly one.
    pub fn lift(&self, constants: &Program, level: &[Interval], q: &[Interval], reach: f64) -> Result<Lift, Failure> {
        let jacobians = |q: &[Interval], w: &[Interval]| {
            let states = self.states(&self.coordinates(q, w));
            self.split(&constants.jacobian(&states).times(&self.columns.enclosed()))
        };
        let around = |box_: &[Interval], middle: &[Interval]| combine(box_, middle, |box_, middle| box_ - middle);
        let q_middle = points(&mid(q));
        let mut w = vec![Interval::symmetric(reach); self.constants.len()];
        for improvement in 0..4 {
            let (by_q, by_w) = jacobians(q, &w);
            let guess = approximate_inverse(&by_w.mid()).ok_or(Failure::Singular)?.enclosed();
            let middle = points(&mid(&w));
            let values = constants.values(&self.states(&self.coordinates(&q_middle, &middle)));
            let defect = combine(&around(&values, level), &by_q.apply(&around(q, &q_middle)), |a, b| a + b);
            let unit = Matrix::identity(w.len()).enclosed();
            let rest = unit.minus(&guess.times(&by_w)).apply(&around(&w, &middle));
            let step = combine(&rest, &guess.apply(&defect), |rest, newton| rest - newton);
            let image = combine(&middle, &step, |middle, step| middle + step);
            if improvement == 0 && !is_inside(&image, &w) {
                return Err(Failure::NotContracted);
            }
            w = meet(&image, &w);
        }
        let (by_q, by_w) = jacobians(q, &w);
        let slope = inverse(&by_w).ok_or(Failure::Singular)?.times(&by_q).map(|entry| -entry);
        let coordinates = self.coordinates(q, &w);
        let states = self.states(&coordinates);
        Ok(Lift { w, slope, coordinates, states })
    }
}
