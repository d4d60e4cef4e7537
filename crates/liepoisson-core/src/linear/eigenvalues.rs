//! Eigenvalues and eigenvectors of real matrices: balancing (Osborne 1960; James, Langou and Lowery 2014), Hessenberg's form,
//! Francis's double steps with the shifts of LAPACK's `dlahqr`, and substitution in the real Schur form (Golub and Van Loan,
//! Matrix Computations, chapter 7).

use super::singular::power_of_two_above;

/// Double steps for one eigenvalue or pair; with exceptional shifts at each tenth, some three are usual.
const MOST_STEPS: usize = 300;

/// Eigenvalues and eigenvectors; pairs stand together, the positive imaginary part first.
pub struct Eigen {
    /// Real and imaginary part of each value.
    pub values: Vec<[f64; 2]>,
    /// The vectors as rows, of length one, the largest component real.
    pub vectors: Vec<[f64; 2]>,
}

/// Eigenvalues and eigenvectors of a matrix of shape (n, n); none where an entry is not finite or the steps do not converge.
///
/// # Panics
/// If the slice has another length.
pub fn eigen(matrix: &[f64], n: usize) -> Option<Eigen> {
    assert_eq!(matrix.len(), n * n, "a square matrix");
    if matrix.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let scale = power_of_two_above(matrix.iter().fold(0.0, |size: f64, x| size.max(x.abs())));
    let mut schur = Schur { n, t: matrix.iter().map(|x| x / scale).collect(), z: vec![0.0; n * n] };
    (0..n).for_each(|k| schur.z[k * n + k] = 1.0);
    let units = schur.balance();
    schur.reduce();
    schur.iterate()?;
    let values = schur.values();
    let vectors = (0..n).flat_map(|k| schur.vector(k, &values, &units)).collect();
    Some(Eigen { values: values.iter().map(|&[re, im]| [re * scale, im * scale]).collect(), vectors })
}

/// Two shifts, centre +- sqrt(s), with s as a product of two numbers: s itself may be too small for a double.
struct Shifts {
    centre: f64,
    squares: [f64; 2],
}

/// A = Z T Z^T, T on its way to triangular form with blocks of two for pairs of complex eigenvalues.
struct Schur {
    n: usize,
    t: Vec<f64>,
    z: Vec<f64>,
}

impl Schur {
    /// Divides rows and multiplies columns by powers of two until both have like lengths; the powers.
    ///
    /// The diagonal counts: a row of round-off beside a diagonal entry would otherwise be taken for a small one.
    fn balance(&mut self) -> Vec<f64> {
        let n = self.n;
        let mut units = vec![1.0; n];
        for _ in 0..100 {
            let mut changed = false;
            for k in 0..n {
                let (row, column) = (0..n).fold((0.0, 0.0), |(row, column), j| {
                    (libm::hypot(row, self.t[k * n + j]), libm::hypot(column, self.t[j * n + k]))
                });
                if row == 0.0 || column == 0.0 {
                    continue;
                }
                let exponent = libm::rint(0.5 * libm::log2(row / column));
                let factor = libm::scalbn(1.0, exponent as i32);
                let unit = units[k] * factor;
                // gained at least a twentieth, within the range in which powers are exact
                if row / factor + column * factor < 0.95 * (row + column) && (1e-100..1e100).contains(&unit) {
                    units[k] = unit;
                    for j in 0..n {
                        self.t[k * n + j] /= factor;
                        self.t[j * n + k] *= factor;
                    }
                    changed = true;
                }
            }
            if !changed {
                break;
            }
        }
        units
    }

    /// Reflects rows `first..` and the same columns by 1 - 2 v v^T / v^T v, within the given columns and rows.
    fn reflect(&mut self, first: usize, v: &[f64], from_column: usize, to_row: usize) {
        let square = v.iter().fold(0.0, |sum, x| sum + x * x);
        if square == 0.0 {
            return;
        }
        let (n, weight) = (self.n, 2.0 / square);
        for j in from_column..n {
            let share = v.iter().enumerate().fold(0.0, |sum, (i, x)| sum + x * self.t[(first + i) * n + j]) * weight;
            v.iter().enumerate().for_each(|(i, x)| self.t[(first + i) * n + j] -= share * x);
        }
        reflect_columns(&mut self.t[..to_row * n], n, first, v, weight);
        reflect_columns(&mut self.z, n, first, v, weight);
    }

    fn reduce(&mut self) {
        let n = self.n;
        for k in 0..n.saturating_sub(2) {
            let column: Vec<f64> = (k + 1..n).map(|i| self.t[i * n + k]).collect();
            if column[1..].iter().all(|&x| x == 0.0) {
                continue;
            }
            self.reflect(k + 1, &normal(&column), k, n);
            (k + 2..n).for_each(|i| self.t[i * n + k] = 0.0);
        }
    }

    /// Francis's steps until every block has one or two rows.
    fn iterate(&mut self) -> Option<()> {
        let n = self.n;
        let (mut end, mut steps) = (n, 0);
        while end > 0 {
            let last = end - 1;
            let mut start = last;
            while start > 0 {
                if self.t[start * n + start - 1].abs() <= f64::EPSILON * self.size_around(start) {
                    self.t[start * n + start - 1] = 0.0;
                    break;
                }
                start -= 1;
            }
            if last - start < 2 {
                if last > start {
                    self.split(start);
                }
                (end, steps) = (start, 0);
            } else {
                steps += 1;
                if steps > MOST_STEPS {
                    return None;
                }
                let shifts = match steps % 20 {
                    10 => self.exceptional_shifts(start, start),
                    0 => self.exceptional_shifts(last, last - 2),
                    _ => self.shifts(last - 1),
                };
                self.step(start, last, shifts);
            }
        }
        Some(())
    }

    /// The sizes of the entries beside a subdiagonal one: on the diagonal, or if these vanish, below it.
    fn size_around(&self, row: usize) -> f64 {
        let t = |i: usize, j: usize| self.t[i * self.n + j].abs();
        let near = t(row, row) + t(row - 1, row - 1);
        if near > 0.0 {
            return near;
        }
        let before = if row > 1 { t(row - 1, row - 2) } else { 0.0 };
        let after = if row + 1 < self.n { t(row + 1, row) } else { 0.0 };
        if before + after > 0.0 { before + after } else { f64::MIN_POSITIVE / f64::EPSILON }
    }

    /// The eigenvalues of the block of two rows at `k`; of two real ones the one nearer to the last entry, twice (Day 1996).
    fn shifts(&self, k: usize) -> Shifts {
        let (a, b, c, d) = self.block(k);
        let size = a.abs() + b.abs() + c.abs() + d.abs();
        if size == 0.0 {
            return Shifts { centre: 0.0, squares: [0.0, 1.0] };
        }
        let (p, mean) = (0.5 * (a / size - d / size), 0.5 * (a / size + d / size));
        let q = p * p + (b / size) * (c / size);
        if q >= 0.0 {
            let nearer = if p < 0.0 { mean + q.sqrt() } else { mean - q.sqrt() };
            Shifts { centre: nearer * size, squares: [0.0, 1.0] }
        } else {
            Shifts { centre: mean * size, squares: [q * size, size] }
        }
    }

    /// A pair beside a diagonal entry, at a distance of the subdiagonal entries at `below` and after it.
    fn exceptional_shifts(&self, row: usize, below: usize) -> Shifts {
        let t = |i: usize, j: usize| self.t[i * self.n + j];
        let size = t(below + 1, below).abs() + t(below + 2, below + 1).abs();
        Shifts { centre: t(row, row) + 0.75 * size, squares: [-0.4375 * size, size] }
    }

    /// One double step on rows `start..=last`.
    fn step(&mut self, start: usize, last: usize, shifts: Shifts) {
        let n = self.n;
        let t = |i: usize, j: usize| self.t[i * n + j];
        let (a, b, c, d) = (t(start, start), t(start, start + 1), t(start + 1, start), t(start + 1, start + 1));
        // the first column of (T - centre)^2 - squares, over its own size: products of small entries would vanish
        let (Shifts { centre, squares: [one, other] }, below) = (shifts, t(start + 2, start + 1));
        let size = (a - centre).abs() + c.abs() + one.abs().sqrt() * other.sqrt();
        let size = if size == 0.0 { 1.0 } else { size };
        let (across, down) = ((a - centre) / size, c / size);
        let mut bulge = vec![
            (a - centre) * across + b * down - one * (other / size),
            down * ((a - centre) + (d - centre)),
            down * below,
        ];
        for k in start..last {
            self.reflect(k, &normal(&bulge), k.saturating_sub(1).max(start), (k + 4).min(last + 1));
            if k > start {
                (k + 1..(k + 3).min(last + 1)).for_each(|i| self.t[i * n + k - 1] = 0.0);
            }
            bulge = (k + 1..(k + 4).min(last + 1)).map(|i| self.t[i * n + k]).collect();
        }
    }

    /// Makes a block of two rows triangular if its eigenvalues are real.
    fn split(&mut self, k: usize) {
        let n = self.n;
        let (a, b, c, d) = self.block(k);
        let p = 0.5 * (a - d);
        let q = p * p + b * c;
        if q < 0.0 || c == 0.0 {
            return;
        }
        // (lambda - d, c) is an eigenvector; away from cancellation
        let x = if p < 0.0 { p - q.sqrt() } else { p + q.sqrt() };
        let length = libm::hypot(x, c);
        let (cosine, sine) = (x / length, c / length);
        for j in k..n {
            let (one, other) = (self.t[k * n + j], self.t[(k + 1) * n + j]);
            (self.t[k * n + j], self.t[(k + 1) * n + j]) = (cosine * one + sine * other, cosine * other - sine * one);
        }
        for rows in [&mut self.t[..(k + 2) * n], &mut self.z[..]] {
            for row in rows.chunks_exact_mut(n) {
                (row[k], row[k + 1]) = (cosine * row[k] + sine * row[k + 1], cosine * row[k + 1] - sine * row[k]);
            }
        }
        self.t[(k + 1) * n + k] = 0.0;
    }

    fn block(&self, k: usize) -> (f64, f64, f64, f64) {
        let (n, t) = (self.n, &self.t);
        (t[k * n + k], t[k * n + k + 1], t[(k + 1) * n + k], t[(k + 1) * n + k + 1])
    }

    /// Whether rows `k` and `k + 1` belong to a pair.
    fn is_pair(&self, k: usize) -> bool {
        k + 1 < self.n && self.t[(k + 1) * self.n + k] != 0.0
    }

    fn values(&self) -> Vec<[f64; 2]> {
        let mut values = Vec::with_capacity(self.n);
        while values.len() < self.n {
            let k = values.len();
            if self.is_pair(k) {
                let (a, b, c, d) = self.block(k);
                let p = 0.5 * (a - d);
                let imaginary = (-(p * p + b * c)).max(0.0).sqrt();
                values.extend([[d + p, imaginary], [d + p, -imaginary]]);
            } else {
                values.push([self.t[k * self.n + k], 0.0]);
            }
        }
        values
    }

    /// The eigenvector of the value with number `k`, in the units before balancing.
    fn vector(&self, k: usize, values: &[[f64; 2]], units: &[f64]) -> Vec<[f64; 2]> {
        let n = self.n;
        let mut x = vec![[0.0; 2]; n];
        let mut row = k;
        if values[k][1] == 0.0 {
            x[k] = [1.0, 0.0];
        } else {
            row -= usize::from(values[k][1] < 0.0);
            let (a, b, c, d) = self.block(row);
            let value = values[k];
            if b.abs() >= c.abs() {
                (x[row], x[row + 1]) = ([1.0, 0.0], [(value[0] - a) / b, value[1] / b]);
            } else {
                (x[row], x[row + 1]) = ([(value[0] - d) / c, value[1] / c], [1.0, 0.0]);
            }
        }
        self.substitute(&mut x, row, values[k]);
        let mut vector: Vec<[f64; 2]> = (0..n)
            .map(|i| {
                (0..n).fold([0.0; 2], |sum, j| {
                    [sum[0] + self.z[i * n + j] * x[j][0], sum[1] + self.z[i * n + j] * x[j][1]]
                })
            })
            .zip(units)
            .map(|([re, im], unit)| [re * unit, im * unit])
            .collect();
        normalise(&mut vector);
        vector
    }

    /// Solves (T - lambda) x = 0 upwards from the row above `row`.
    fn substitute(&self, x: &mut [[f64; 2]], row: usize, [re, im]: [f64; 2]) {
        let n = self.n;
        let least = f64::EPSILON * self.t.iter().fold(f64::MIN_POSITIVE, |size: f64, t| size.max(t.abs()));
        let mut i = row;
        while i > 0 {
            let pair = i > 1 && self.is_pair(i - 2);
            let first = i - 1 - usize::from(pair);
            let left = |i: usize, x: &[[f64; 2]]| {
                (first + 1 + usize::from(pair)..n).fold([0.0; 2], |sum, j| {
                    [sum[0] - self.t[i * n + j] * x[j][0], sum[1] - self.t[i * n + j] * x[j][1]]
                })
            };
            if pair {
                let (a, b, c, d) = self.block(first);
                let (r, s) = (left(first, x), left(first + 1, x));
                let rows = [([a - re, -im], [b, 0.0], r), ([c, 0.0], [d - re, -im], s)];
                let [top, bottom] = if size(rows[0].0) >= c.abs() { rows } else { [rows[1], rows[0]] };
                let factor = over(bottom.0, at_least(top.0, least));
                let pivot = minus(bottom.1, times(factor, top.1));
                x[first + 1] = over(minus(bottom.2, times(factor, top.2)), at_least(pivot, least));
                x[first] = over(minus(top.2, times(top.1, x[first + 1])), at_least(top.0, least));
            } else {
                let pivot = [self.t[first * n + first] - re, -im];
                x[first] = over(left(first, x), at_least(pivot, least));
            }
            let largest = x.iter().fold(0.0, |largest: f64, z| largest.max(size(*z)));
            if largest > 1e150 {
                x.iter_mut().for_each(|z| *z = [z[0] / largest, z[1] / largest]);
            }
            i = first;
        }
    }
}

/// The normal of the reflection that takes `x` to a multiple of the first component.
fn normal(x: &[f64]) -> Vec<f64> {
    let size = x.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
    if size == 0.0 {
        return vec![0.0; x.len()];
    }
    let mut normal: Vec<f64> = x.iter().map(|x| x / size).collect();
    let length = normal.iter().fold(0.0, |sum, x| sum + x * x).sqrt();
    normal[0] += if normal[0] < 0.0 { -length } else { length };
    normal
}

fn reflect_columns(rows: &mut [f64], n: usize, first: usize, v: &[f64], weight: f64) {
    for row in rows.chunks_exact_mut(n) {
        let part = &mut row[first..first + v.len()];
        let share = part.iter().zip(v).fold(0.0, |sum, (x, y)| sum + x * y) * weight;
        part.iter_mut().zip(v).for_each(|(x, y)| *x -= share * y);
    }
}

/// To length one, with a real largest component.
fn normalise(vector: &mut [[f64; 2]]) {
    let mut largest = [0.0, 0.0];
    for &z in vector.iter() {
        if size(z) > size(largest) {
            largest = z;
        }
    }
    if size(largest) == 0.0 {
        return;
    }
    let is_real = vector.iter().all(|z| z[1] == 0.0);
    if is_real {
        let unit = largest[0].abs();
        vector.iter_mut().for_each(|z| z[0] /= unit);
    } else {
        vector.iter_mut().for_each(|z| *z = over(*z, largest));
    }
    let length = vector.iter().fold(0.0, |sum, z| sum + z[0] * z[0] + z[1] * z[1]).sqrt();
    vector.iter_mut().for_each(|z| *z = [z[0] / length, z[1] / length]);
}

fn size([re, im]: [f64; 2]) -> f64 {
    libm::hypot(re, im)
}

/// A pivot, or in its place the least one that can be seen.
fn at_least(pivot: [f64; 2], least: f64) -> [f64; 2] {
    if size(pivot) < least { [least, 0.0] } else { pivot }
}

fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn times(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

/// a / b, by Smith's method.
fn over(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    if b[0].abs() >= b[1].abs() {
        let ratio = b[1] / b[0];
        let whole = b[0] + b[1] * ratio;
        [(a[0] + a[1] * ratio) / whole, (a[1] - a[0] * ratio) / whole]
    } else {
        let ratio = b[0] / b[1];
        let whole = b[0] * ratio + b[1];
        [(a[0] * ratio + a[1]) / whole, (a[1] * ratio - a[0]) / whole]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// |A v - lambda v|, largest over all pairs, and the sizes of the vectors less one.
    fn check(matrix: &[f64], n: usize, bound: f64) -> Result<(), TestCaseError> {
        let Eigen { values, vectors } = eigen(matrix, n).expect("converged");
        let norm = matrix.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
        for (value, vector) in values.iter().zip(vectors.chunks_exact(n)) {
            let length: f64 = vector.iter().map(|z| z[0] * z[0] + z[1] * z[1]).sum();
            prop_assert!((length - 1.0).abs() < 1e-12, "{vector:?}");
            for i in 0..n {
                let image = (0..n).fold([0.0; 2], |sum, j| {
                    [sum[0] + matrix[i * n + j] * vector[j][0], sum[1] + matrix[i * n + j] * vector[j][1]]
                });
                let error = size(minus(image, times(*value, vector[i])));
                prop_assert!(error <= bound * norm, "{error:e} of {norm:e}: {value:?}");
            }
        }
        let trace: f64 = (0..n).map(|k| matrix[k * n + k]).sum();
        let sum: f64 = values.iter().map(|value| value[0]).sum();
        prop_assert!((trace - sum).abs() <= 1e-13 * n as f64 * norm);
        Ok(())
    }

    proptest! {
        #[test]
        fn vectors_are_eigenvectors(
            n in 1_usize..13, entries in prop::collection::vec(-1.0..1.0_f64, 144), exponent in -200..200_i32
        ) {
            let matrix: Vec<f64> = entries[..n * n].iter().map(|x| x * libm::scalbn(1.0, exponent)).collect();
            check(&matrix, n, 1e-13)?;
        }

        #[test]
        fn whole_numbers_with_many_zeros(n in 1_usize..9, entries in prop::collection::vec(-2..3_i8, 64)) {
            let matrix: Vec<f64> = entries[..n * n].iter().map(|&x| f64::from(x / 2)).collect();
            check(&matrix, n, 1e-12)?;
        }
    }

    /// The matrix in other orthogonal coordinates: reflected along (1, 2, ..., n).
    fn turned(matrix: &[f64], n: usize) -> Vec<f64> {
        let v: Vec<f64> = (1..=n).map(|k| k as f64).collect();
        let weight = 2.0 / v.iter().map(|x| x * x).sum::<f64>();
        let mut turned = matrix.to_vec();
        for j in 0..n {
            let share = (0..n).map(|i| v[i] * turned[i * n + j]).sum::<f64>() * weight;
            (0..n).for_each(|i| turned[i * n + j] -= share * v[i]);
        }
        reflect_columns(&mut turned, n, 0, &v, weight);
        turned
    }

    #[test]
    fn known_values() {
        let rotation = eigen(&[0.0, -2.0, 2.0, 0.0], 2).unwrap();
        assert_eq!(rotation.values, [[0.0, 2.0], [0.0, -2.0]]);
        // the companion matrix of (x - 1)(x - 2)(x - 3)(x^2 + 1)
        let n = 5;
        let mut companion = vec![0.0; n * n];
        companion[..n].copy_from_slice(&[6.0, -12.0, 12.0, -11.0, 6.0]);
        (1..n).for_each(|i| companion[i * n + i - 1] = 1.0);
        let mut values = eigen(&companion, n).unwrap().values;
        values.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        for (value, wanted) in values.iter().zip([[0.0, -1.0], [0.0, 1.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0]]) {
            assert!(size(minus(*value, wanted)) < 1e-13, "{value:?} {wanted:?}");
        }
        assert!(eigen(&[f64::NAN], 1).is_none());
        assert!(eigen(&[], 0).unwrap().values.is_empty());
        check(&[1.0, 1e12, 1e-12, 1.0], 2, 1e-15).unwrap(); // balanced
        // zeros that are round-off, which balancing must not take for sizes (an eigenvector was wrong by its own length)
        check(&[-2.0, 2.0, 1e-16, 1e-16, 2.0, 0.0, -2.0, -2.0, -2.0], 3, 1e-14).unwrap();
        // a pair beside a real value, and two pairs that nearly coincide: the shifts of one block wander (Day 1996)
        check(&[1.0, 1.0, 0.0, -2.0, 2.0, -1.0, 0.0, 2.0, 1.0], 3, 1e-14).unwrap();
        for exponent in 1..17 {
            let h = libm::exp10(-f64::from(exponent));
            let saddle = [1.0, h, 0.0, 0.0, -h, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0, h, 0.0, 0.0, -h, -1.0];
            check(&turned(&saddle, 4), 4, 1e-14).unwrap();
        }
        // three blocks, one of them far below the others
        let mut blocks = vec![0.0; 16];
        blocks[0] = 1.0;
        (0..3).for_each(|i| blocks[(i + 1) * 4 + (i + 1) % 3 + 1] = 1e-160);
        check(&blocks, 4, 1e-14).unwrap();
        // a permutation of n letters needs an exceptional shift
        let mut cycle = vec![0.0; 16];
        (0..4).for_each(|i| cycle[i * 4 + (i + 1) % 4] = 1.0);
        check(&cycle, 4, 1e-14).unwrap();
    }
}
