//! Vectors and matrices of exact scalars, as formulas use them; every operation checks shapes and stays bounded.

use super::expand::expanded;
use super::graph::Node;
use super::limits::{Arithmetic, Refused};
use super::rational::Rational;

const MAX_SYMBOLIC_INVERSE: usize = 4;
const MAX_INVERSE: u64 = 40;

/// A scalar, a vector, or a matrix by its rows.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Scalar(Node),
    Vector(Vec<Node>),
    Matrix(Vec<Vec<Node>>),
}

impl Value {
    /// What a value is, in words for messages.
    pub(super) fn kind(&self) -> String {
        match self {
            Value::Scalar(_) => "a scalar".to_owned(),
            Value::Vector(entries) => format!("a vector of length {}", entries.len()),
            Value::Matrix(rows) => format!("a {} x {} matrix", rows.len(), rows[0].len()),
        }
    }

    /// None of a scalar, one length of a vector, two of a matrix.
    pub(super) fn shape(&self) -> Vec<usize> {
        match self {
            Value::Scalar(_) => vec![],
            Value::Vector(entries) => vec![entries.len()],
            Value::Matrix(rows) => vec![rows.len(), rows[0].len()],
        }
    }

    fn entries(&self) -> Vec<Node> {
        match self {
            Value::Scalar(node) => vec![*node],
            Value::Vector(entries) => entries.clone(),
            Value::Matrix(rows) => rows.concat(),
        }
    }

    /// A value of the same shape with other entries.
    fn with(&self, entries: Vec<Node>) -> Value {
        match self {
            Value::Scalar(_) => Value::Scalar(entries[0]),
            Value::Vector(_) => Value::Vector(entries),
            Value::Matrix(rows) => Value::Matrix(entries.chunks(rows[0].len()).map(<[Node]>::to_vec).collect()),
        }
    }
}

/// The kinds of values, joined by "and".
pub(super) fn kinds(values: &[Value]) -> String {
    values.iter().map(Value::kind).collect::<Vec<_>>().join(" and ")
}

impl Arithmetic<'_> {
    /// The sum of signed terms of one shape.
    pub(super) fn sum_of(&mut self, terms: &[(Value, bool)]) -> Refused<Value> {
        let entries: Vec<Vec<Node>> = terms.iter().map(|(term, _)| term.entries()).collect();
        let sums = (0..entries[0].len()).map(|k| {
            let column: Vec<_> = entries.iter().zip(terms).map(|(entries, (_, sign))| (entries[k], *sign)).collect();
            self.sum(&column)
        });
        let sums = sums.collect::<Refused<Vec<Node>>>()?;
        Ok(terms[0].0.with(sums))
    }

    /// The opposite of a value.
    pub(super) fn opposite(&mut self, value: &Value) -> Refused<Value> {
        let entries = value.entries().into_iter().map(|entry| self.negative(entry)).collect::<Refused<_>>()?;
        Ok(value.with(entries))
    }

    /// A scalar times a value.
    pub(super) fn scaled(&mut self, scalar: Node, value: &Value) -> Refused<Value> {
        let entries =
            value.entries().into_iter().map(|entry| self.product(&[scalar, entry])).collect::<Refused<_>>()?;
        Ok(value.with(entries))
    }

    /// A matrix times a vector or a matrix.
    pub(super) fn product_of(&mut self, left: &Value, right: &Value) -> Refused<Value> {
        let no_meaning = |hint: &str| Err(format!("{} times {} has no meaning; {hint}", left.kind(), right.kind()));
        let Value::Matrix(rows) = left else {
            let is_vector = matches!(right, Value::Vector(_));
            return no_meaning(if is_vector {
                "write dot(u, v), cross(u, v) or diag(u)*v"
            } else {
                "write transpose(M)*v"
            });
        };
        if left.shape()[1] != right.shape()[0] {
            return no_meaning("the lengths must agree");
        }
        match right {
            Value::Matrix(other) => {
                let columns = transposed(other);
                let product = |row: &Vec<Node>| columns.iter().map(|column| self.inner(row, column)).collect();
                Ok(Value::Matrix(rows.iter().map(product).collect::<Refused<_>>()?))
            }
            _ => {
                let vector = right.entries();
                Ok(Value::Vector(rows.iter().map(|row| self.inner(row, &vector)).collect::<Refused<_>>()?))
            }
        }
    }

    /// One of the functions of vectors and matrices.
    pub(super) fn apply_to_tensors(&mut self, function: &str, arguments: &[Value]) -> Refused<Value> {
        let (wanted, n_wanted) = match function {
            "dot" => ("two vectors of one length, dot(u, v)", 2),
            "cross" => ("two vectors of length 3, cross(u, v)", 2),
            "norm" => ("one vector, norm(v)", 1),
            "diag" => ("one vector, diag(v)", 1),
            "inv" => ("one square matrix, or a vector for a diagonal one, inv(M)", 1),
            "transpose" => ("one matrix, transpose(M)", 1),
            _ => ("one square matrix, trace(M)", 1),
        };
        if arguments.len() != n_wanted {
            return Err(format!("{function} takes {wanted}; got {} arguments", arguments.len()));
        }
        match (function, arguments) {
            ("dot", [Value::Vector(u), Value::Vector(v)]) if u.len() == v.len() => Ok(Value::Scalar(self.inner(u, v)?)),
            ("cross", [Value::Vector(u), Value::Vector(v)]) if u.len() == 3 && v.len() == 3 => {
                let minors = [(1, 2), (2, 0), (0, 1)].map(|(i, j)| {
                    let positive = self.product(&[u[i], v[j]])?;
                    let negative = self.product(&[u[j], v[i]])?;
                    self.sum(&[(positive, false), (negative, true)])
                });
                Ok(Value::Vector(minors.into_iter().collect::<Refused<_>>()?))
            }
            ("norm", [Value::Vector(v)]) => {
                let square = self.inner(v, v)?;
                Ok(Value::Scalar(self.apply("sqrt", square)?))
            }
            ("diag", [Value::Vector(v)]) => Ok(self.diagonal(v)),
            ("transpose", [Value::Matrix(rows)]) => Ok(Value::Matrix(transposed(rows))),
            ("trace", [Value::Matrix(rows)]) if rows.len() == rows[0].len() => {
                let diagonal: Vec<_> = rows.iter().enumerate().map(|(i, row)| (row[i], false)).collect();
                Ok(Value::Scalar(self.sum(&diagonal)?))
            }
            ("inv", [Value::Vector(v)]) => self.inverse_of_diagonal(v),
            ("inv", [Value::Matrix(rows)]) if rows.len() == rows[0].len() => self.inverse(rows),
            _ => Err(format!("{function} takes {wanted}; got {}", kinds(arguments))),
        }
    }

    fn diagonal(&mut self, entries: &[Node]) -> Value {
        let zero = self.zero();
        let row = |i: usize| (0..entries.len()).map(|j| if i == j { entries[i] } else { zero }).collect();
        Value::Matrix((0..entries.len()).map(row).collect())
    }

    fn inverse_of_diagonal(&mut self, entries: &[Node]) -> Refused<Value> {
        let inverse = entries.iter().map(|&entry| self.reciprocal(entry)).collect::<Refused<Vec<_>>>()?;
        Ok(self.diagonal(&inverse))
    }

    fn inverse(&mut self, rows: &[Vec<Node>]) -> Refused<Value> {
        let n = rows.len();
        let is_diagonal = (0..n).all(|i| (0..n).all(|j| i == j || self.graph.is_zero(rows[i][j])));
        if is_diagonal {
            let diagonal: Vec<Node> = (0..n).map(|i| rows[i][i]).collect();
            return self.inverse_of_diagonal(&diagonal);
        }
        let numbers = rows.iter().map(|row| row.iter().map(|&entry| self.graph.rational(entry).cloned()).collect());
        if let Some(numbers) = numbers.collect::<Option<Vec<Vec<Rational>>>>() {
            let inverse = rational_inverse(numbers)?;
            let nodes = |row: Vec<Rational>| row.into_iter().map(|number| self.graph.number(number)).collect();
            return Ok(Value::Matrix(inverse.into_iter().map(nodes).collect()));
        }
        if n > MAX_SYMBOLIC_INVERSE {
            return Err(format!(
                "a symbolic matrix must be at most {MAX_SYMBOLIC_INVERSE} x {MAX_SYMBOLIC_INVERSE} to be inverted; got {n} x \
                 {n}. Give the inverse matrix as a parameter instead"
            ));
        }
        // Cramer's rule: the cofactors over the determinant
        let determinant = self.determinant(rows)?;
        let multiplied = expanded(self.graph, determinant);
        if self.graph.is_zero(multiplied) {
            return Err(NOT_INVERTIBLE.to_owned());
        }
        let reciprocal = self.reciprocal(determinant)?;
        let mut inverse = vec![];
        for i in 0..n {
            let mut row = vec![];
            for j in 0..n {
                let cofactor = self.cofactor(rows, j, i)?;
                row.push(self.product(&[reciprocal, cofactor])?);
            }
            inverse.push(row);
        }
        Ok(Value::Matrix(inverse))
    }

    fn determinant(&mut self, rows: &[Vec<Node>]) -> Refused<Node> {
        if rows.len() == 1 {
            return Ok(rows[0][0]);
        }
        let mut terms = vec![];
        for (j, &entry) in rows[0].iter().enumerate() {
            let cofactor = self.cofactor(rows, 0, j)?;
            terms.push((self.product(&[entry, cofactor])?, false));
        }
        self.sum(&terms)
    }

    fn cofactor(&mut self, rows: &[Vec<Node>], i: usize, j: usize) -> Refused<Node> {
        if rows.len() == 1 {
            return Ok(self.graph.integer(1));
        }
        let others = |row: &Vec<Node>| [&row[..j], &row[j + 1..]].concat();
        let minor: Vec<Vec<Node>> =
            rows.iter().enumerate().filter(|&(p, _)| p != i).map(|(_, row)| others(row)).collect();
        let determinant = self.determinant(&minor)?;
        if (i + j).is_multiple_of(2) { Ok(determinant) } else { self.negative(determinant) }
    }

    fn inner(&mut self, u: &[Node], v: &[Node]) -> Refused<Node> {
        let mut terms = vec![];
        for (&x, &y) in u.iter().zip(v) {
            if !self.graph.is_zero(x) && !self.graph.is_zero(y) {
                terms.push((self.product(&[x, y])?, false));
            }
        }
        self.sum(&terms)
    }
}

const NOT_INVERTIBLE: &str = "a matrix must have an inverse; the determinant of this one is 0";

fn transposed(rows: &[Vec<Node>]) -> Vec<Vec<Node>> {
    (0..rows[0].len()).map(|j| rows.iter().map(|row| row[j]).collect()).collect()
}

/// The inverse of a matrix of rational numbers, by elimination.
fn rational_inverse(mut rows: Vec<Vec<Rational>>) -> Refused<Vec<Vec<Rational>>> {
    let n = rows.len();
    let longest = rows.iter().flatten().map(Rational::bits).max().unwrap_or(0);
    if n as u64 * longest > 1000 * MAX_INVERSE {
        return Err(format!("a matrix must be smaller to be inverted; got {n} x {n} with numbers of {longest} bits"));
    }
    for (i, row) in rows.iter_mut().enumerate() {
        row.extend((0..n).map(|j| Rational::integer(i64::from(i == j))));
    }
    for column in 0..n {
        let Some(pivot) = (column..n).find(|&i| !rows[i][column].is_zero()) else {
            return Err(NOT_INVERTIBLE.to_owned());
        };
        rows.swap(column, pivot);
        let scale = rows[column][column].reciprocal();
        let row: Vec<Rational> = rows[column].iter().map(|entry| entry.times(&scale)).collect();
        for (i, other) in rows.iter_mut().enumerate() {
            if i != column && !other[column].is_zero() {
                let factor = other[column].negated();
                for (entry, own) in other.iter_mut().zip(&row) {
                    *entry = entry.plus(&own.times(&factor));
                }
            }
        }
        rows[column] = row;
    }
    Ok(rows.into_iter().map(|row| row[n..].to_vec()).collect())
}
