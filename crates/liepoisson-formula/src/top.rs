//! The charged or twisted top, recognised by its equations, however they were written.
//!
//! The parameters are read off single coefficients, and the equations of the top with these are compared with all terms:
//! `l' = l x omega + alpha x a + beta x b`, `alpha' = alpha x omega + epsilon beta x a`, `beta' = beta x omega`, with
//! `omega_i = l_i / I_i`.

use super::constant::double;
use super::rational::Rational;
use std::collections::BTreeMap;

/// Numbers that differ by less than this part of them are one: irrational ones are known to 60 digits.
const SAME: i64 = 150;

/// Relative error that rounding the moments may leave in their differences, which are the coefficients of `l'`.
const DIFFERENCE: i64 = 30;

/// Equations of degree two: coefficients by component and monomial.
pub(super) type Terms = BTreeMap<(usize, Vec<usize>), Rational>;

/// The parameters of a top as doubles.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Parameters {
    pub(super) inertia: [f64; 3],
    pub(super) a: [f64; 3],
    pub(super) b: [f64; 3],
    pub(super) epsilon: f64,
}

/// The top with these equations in nine coordinates, if there is one whose moments doubles can hold; `epsilon` is that of the
/// bracket, which is taken where the equations do not contain it.
pub(super) fn recognised(terms: &Terms, epsilon: &Rational) -> Option<Parameters> {
    let coefficient = |row: usize, monomial: &[usize]| {
        let mut sorted = monomial.to_vec();
        sorted.sort_unstable();
        terms.get(&(row, sorted)).cloned().unwrap_or_else(Rational::zero)
    };
    // beta_i' contains beta_(i+1) l_(i+2) / I_(i+2), and (alpha x a)_i contains alpha_(i+1) a_(i+2)
    let read = |of: &dyn Fn(usize) -> Rational| [1, 2, 0].map(of);
    let inverse = read(&|i| coefficient(6 + i, &[6 + (i + 1) % 3, (i + 2) % 3]));
    let a = read(&|i| coefficient(i, &[3 + (i + 1) % 3]));
    let b = read(&|i| coefficient(i, &[6 + (i + 1) % 3]));
    if inverse.iter().any(|value| value.is_zero() || value.is_negative()) {
        return None;
    }
    let own = (0..3).find(|&k| !a[k].is_zero());
    let epsilon = own.map_or_else(
        || epsilon.clone(),
        |k| coefficient(3 + (k + 1) % 3, &[6 + (k + 2) % 3]).times(&a[k].reciprocal()),
    );
    let expected = equations(&inverse, &a, &b, &epsilon);
    let keys = expected.keys().chain(terms.keys());
    let zero = Rational::zero();
    let get = |from: &Terms, key| from.get(key).unwrap_or(&zero).clone();
    if !keys.into_iter().all(|key| is_near(&get(&expected, key), &get(terms, key), SAME)) {
        return None;
    }
    let inertia = inverse.map(|value| value.reciprocal());
    let doubles = inertia.each_ref().map(Rational::to_f64);
    let held = doubles.iter().all(|moment| moment.is_finite() && (1.0 / moment).is_finite());
    let is_kept = held
        && (0..3).all(|k| {
            let between = |values: &[Rational; 3]| values[k].plus(&values[(k + 1) % 3].negated());
            is_near(&between(&inertia), &between(&doubles.map(double)), DIFFERENCE)
        });
    let [a, b] = [a, b].map(|vector| vector.map(|value| value.to_f64()));
    is_kept.then(|| Parameters { inertia: doubles, a, b, epsilon: epsilon.to_f64() })
}

/// Whether two numbers differ by at most `2^-bits` of the first.
fn is_near(a: &Rational, b: &Rational, bits: i64) -> bool {
    let difference = a.plus(&b.negated()).size();
    difference.times(&Rational::integer(2).power(bits)) <= a.size()
}

fn equations(inverse: &[Rational; 3], a: &[Rational; 3], b: &[Rational; 3], epsilon: &Rational) -> Terms {
    let mut terms = Terms::new();
    let mut add = |row: usize, mut monomial: Vec<usize>, c: Rational| {
        monomial.sort_unstable();
        let sum = terms.entry((row, monomial)).or_insert_with(Rational::zero);
        *sum = sum.plus(&c);
    };
    for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
        for (p, q, sign) in [(j, k, 1), (k, j, -1)] {
            let sign = Rational::integer(sign);
            for field in [0, 3, 6] {
                add(field + i, vec![field + p, q], inverse[q].times(&sign));
            }
            add(i, vec![3 + p], a[q].times(&sign));
            add(i, vec![6 + p], b[q].times(&sign));
            add(3 + i, vec![6 + p], a[q].times(epsilon).times(&sign));
        }
    }
    terms.retain(|_, c| !c.is_zero());
    terms
}
