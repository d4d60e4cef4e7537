//! Sets of states and of derivatives that are carried along by interval matrices without being wrapped into boxes.
//!
//! A set of states is `m + C r0 + Q r`: a point, the box of the start in a frame that the flow moves, and what was added by
//! round-off and remainders, in an orthonormal frame. A step with `phi(m)` in `y` and `D phi` in `A` makes of it
//! ```text
//! m' = mid y,  C' = mid(A C),  r' = (Q'^-1 A Q) r + Q'^-1 ((A C - C') r0 + y - m'),
//! ```
//! with `Q'` the orthogonal factor of `mid(A Q)`, its columns sorted by the width that they carry. The derivative is `M + Q R`
//! with a matrix of intervals `R`, in the same way.
//!
//! # References
//! - R. J. Lohner, *Enclosing the solutions of ordinary initial and boundary value problems*, in: Computer Arithmetic, 1987.
//! - P. Zgliczyński, *C1-Lohner algorithm*, Foundations of Computational Mathematics 2 (2002) 429.

use super::interval::Interval;
use super::linear::inverse;
use super::matrix::{IntervalVector, Matrix, combine, dot, mid, points};

/// `Q R`: a point matrix times an interval matrix.
#[derive(Clone, Debug)]
struct Rest {
    frame: Matrix<f64>,
    coefficients: Matrix<Interval>,
}

impl Rest {
    fn none(n: usize, n_columns: usize) -> Rest {
        Rest { frame: Matrix::identity(n), coefficients: Matrix::from_fn(n, n_columns, |_, _| Interval::ZERO) }
    }

    /// `A Q R + added` as `Q' R'`; `None` if no inverse of the new frame was found.
    fn advance(&mut self, by: &Matrix<Interval>, added: &Matrix<Interval>) -> Option<()> {
        let moved = by.times(&self.frame.enclosed());
        let width = |j: usize| self.coefficients.row(j).iter().map(|entry| entry.width()).fold(0.0, f64::max);
        let widths: Vec<f64> = (0..moved.n_columns()).map(width).collect();
        let frame = orthonormal(&moved.mid(), &widths);
        let back = inverse(&frame.enclosed())?;
        self.coefficients = back.times(&moved).times(&self.coefficients).plus(&back.times(added));
        self.frame = frame;
        (!self.coefficients.is_unknown()).then_some(())
    }

    fn hull(&self) -> Matrix<Interval> {
        self.frame.enclosed().times(&self.coefficients)
    }
}

/// An orthonormal frame that begins with the columns that are longest, weighted. Whether it is one exactly is nobody's
/// concern: its inverse is enclosed afterwards.
pub(super) fn orthonormal(columns: &Matrix<f64>, weights: &[f64]) -> Matrix<f64> {
    let n = columns.n_rows();
    let length = |column: &[f64]| column.iter().map(|entry| entry * entry).sum::<f64>().sqrt();
    let mut given: Vec<(f64, Vec<f64>)> =
        (0..columns.n_columns()).map(|j| (weights[j] * length(&columns.column(j)), columns.column(j))).collect();
    given.sort_by(|a, b| b.0.total_cmp(&a.0));
    // unit vectors stand in for columns that depend on those before
    let units = (0..n).map(|i| (0..n).map(|j| if i == j { 1.0 } else { 0.0 }).collect::<Vec<f64>>());
    let mut frame: Vec<Vec<f64>> = vec![];
    for mut column in given.into_iter().map(|(_, column)| column).chain(units) {
        let before = length(&column);
        for _ in 0..2 {
            for other in &frame {
                let product: f64 = other.iter().zip(&column).map(|(a, b)| a * b).sum();
                column.iter_mut().zip(other).for_each(|(entry, other)| *entry -= product * other);
            }
        }
        let after = length(&column);
        if frame.len() < n && after > 1e-8 * before && after.is_finite() {
            frame.push(column.iter().map(|entry| entry / after).collect());
        }
    }
    Matrix::from_fn(n, n, |i, j| frame.get(j).map_or(0.0, |column| column[i]))
}

/// A set of states.
#[derive(Clone, Debug)]
pub struct StateSet {
    center: Vec<f64>,
    frame: Matrix<f64>,
    start: IntervalVector,
    rest: Rest,
}

impl StateSet {
    /// `center + frame box`: a parallelepiped, or a part of one if the frame has fewer columns than rows.
    ///
    /// # Panics
    /// If the shapes do not fit.
    pub fn new(center: &[f64], frame: Matrix<f64>, coordinates: IntervalVector) -> StateSet {
        assert_eq!((frame.n_rows(), frame.n_columns()), (center.len(), coordinates.len()), "shape of the frame");
        StateSet { center: center.to_vec(), rest: Rest::none(center.len(), 1), frame, start: coordinates }
    }

    /// A box.
    pub fn from_box(of: &[Interval]) -> StateSet {
        let center = mid(of);
        let around = combine(of, &points(&center), |component, center| component - center);
        StateSet::new(&center, Matrix::identity(of.len()), around)
    }

    /// The point that the set is described from; it need not belong to it.
    pub fn center(&self) -> &[f64] {
        &self.center
    }

    /// The least box known to contain the set.
    pub fn hull(&self) -> IntervalVector {
        (0..self.center.len())
            .map(|i| {
                let frame = points(self.frame.row(i));
                Interval::point(self.center[i]) + (dot(&frame, &self.start) + self.rest.hull()[(i, 0)])
            })
            .collect()
    }

    /// All values of a function, given its value at the center and its gradient on the hull of the set and its center.
    pub fn range(&self, at_center: Interval, gradient: &[Interval]) -> Interval {
        let along = |matrix: &Matrix<f64>, coordinates: &[Interval]| {
            let form: IntervalVector =
                (0..matrix.n_columns()).map(|j| dot(gradient, &points(&matrix.column(j)))).collect();
            dot(&form, coordinates)
        };
        at_center + (along(&self.frame, &self.start) + along(&self.rest.frame, &self.rest.coefficients.column(0)))
    }

    /// The set after a map that takes the center into `image` and has its derivatives in `by`.
    pub(super) fn advance(&mut self, image: &[Interval], by: &Matrix<Interval>) -> Option<()> {
        let moved = by.times(&self.frame.enclosed());
        let frame = moved.mid();
        let center = mid(image);
        let turned = moved.minus(&frame.enclosed()).apply(&self.start);
        let added = |i: usize| turned[i] + (image[i] - Interval::point(center[i]));
        self.rest.advance(by, &Matrix::from_fn(center.len(), 1, |i, _| added(i)))?;
        (self.center, self.frame) = (center, frame);
        Some(())
    }
}

/// A set of derivatives: matrices with as many rows as there are components.
#[derive(Clone, Debug)]
pub struct DerivativeSet {
    middle: Matrix<f64>,
    rest: Rest,
}

impl DerivativeSet {
    /// One matrix.
    pub fn new(start: Matrix<f64>) -> DerivativeSet {
        DerivativeSet { rest: Rest::none(start.n_rows(), start.n_columns()), middle: start }
    }

    /// A matrix of intervals that contains the set.
    pub fn hull(&self) -> Matrix<Interval> {
        self.middle.enclosed().plus(&self.rest.hull())
    }

    /// The products of the matrices in `by` with those of the set.
    pub(super) fn advance(&mut self, by: &Matrix<Interval>) -> Option<()> {
        let moved = by.times(&self.middle.enclosed());
        let middle = moved.mid();
        self.rest.advance(by, &moved.minus(&middle.enclosed()))?;
        self.middle = middle;
        Some(())
    }
}
