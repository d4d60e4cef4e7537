//! Expressions multiplied out, and polynomials in the coordinates.

use super::graph::{Expression, Graph, Node};
use super::measure::monomials;
use super::rational::Rational;
use std::collections::BTreeMap;

/// The expression with all products and whole powers of sums in it multiplied out; what is inside of functions, roots and
/// divisors stays as it is. To be asked of what has few terms: see [`n_terms`].
pub(super) fn expanded(graph: &mut Graph, node: Node) -> Node {
    match graph.expression(node).clone() {
        Expression::Sum { constant, terms } => {
            let terms: Vec<_> = terms.into_iter().map(|(term, c)| (expanded(graph, term), c)).collect();
            graph.sum(constant, &terms)
        }
        Expression::Product(factors) => {
            let mut product = graph.integer(1);
            for (base, exponent) in factors {
                let is_sum = matches!(graph.expression(base), Expression::Sum { .. });
                match exponent.to_integer() {
                    Some(times @ 1..) if is_sum => {
                        let base = expanded(graph, base);
                        for _ in 0..times {
                            product = multiplied(graph, product, base);
                        }
                    }
                    _ => {
                        let power = graph.power(base, exponent);
                        product = multiplied(graph, product, power);
                    }
                }
            }
            product
        }
        _ => node,
    }
}

/// The product of two expressions, term by term.
fn multiplied(graph: &mut Graph, a: Node, b: Node) -> Node {
    let one = graph.integer(1);
    let [a, b] = [a, b].map(|node| {
        let (constant, mut terms) = graph.terms(node);
        if !constant.is_zero() {
            terms.push((one, constant));
        }
        terms
    });
    let mut terms = vec![];
    for (p, c) in &a {
        for (q, d) in &b {
            terms.push((graph.times(*p, *q), c.times(d)));
        }
    }
    graph.sum(Rational::zero(), &terms)
}

/// At most so many terms has an expression when it is multiplied out.
pub(super) fn n_terms(graph: &Graph, node: Node) -> u64 {
    match graph.expression(node) {
        Expression::Sum { constant, terms } => {
            let of_constant = u64::from(!constant.is_zero());
            terms.iter().map(|&(term, _)| n_terms(graph, term)).fold(of_constant, u64::saturating_add)
        }
        Expression::Product(factors) => {
            let of_power = |(base, exponent): &(Node, Rational)| match exponent.to_integer() {
                Some(times @ 1..) => monomials(n_terms(graph, *base), times as u64),
                _ => 1, // what is divided by stays as it is
            };
            factors.iter().map(of_power).fold(1, u64::saturating_mul)
        }
        _ => 1,
    }
}

/// The factors of a monomial, by their numbers, in order.
pub(super) type Monomial = Vec<usize>;

/// A polynomial in coordinates: constant coefficients by monomial.
pub(super) type Polynomial = BTreeMap<Monomial, Node>;

/// The polynomial in the coordinates `0..n` that an expression is, of at most this degree in every product; `None` for others.
pub(super) fn polynomial(graph: &mut Graph, node: Node, n: usize, degree: usize) -> Option<Polynomial> {
    if let Ok(Some(_)) = graph.measure(node).value {
        return Some(if graph.is_zero(node) { Polynomial::new() } else { Polynomial::from([(vec![], node)]) });
    }
    match graph.expression(node).clone() {
        Expression::Symbol(index) if index < n => {
            (degree > 0).then(|| Polynomial::from([(vec![index], graph.integer(1))]))
        }
        Expression::Sum { constant, terms } => {
            let mut sums: BTreeMap<Monomial, Vec<(Node, Rational)>> = BTreeMap::new();
            for (term, c) in terms {
                for (monomial, coefficient) in polynomial(graph, term, n, degree)? {
                    sums.entry(monomial).or_default().push((coefficient, c.clone()));
                }
            }
            if !constant.is_zero() {
                let node = graph.number(constant);
                sums.entry(vec![]).or_default().push((node, Rational::one()));
            }
            Some(added(graph, sums))
        }
        Expression::Product(factors) => {
            let mut product = Polynomial::from([(vec![], graph.integer(1))]);
            for (base, exponent) in factors {
                if let Ok(Some(_)) = graph.measure(base).value {
                    let power = graph.power(base, exponent);
                    product = times(graph, &product, &Polynomial::from([(vec![], power)]));
                    continue;
                }
                let count = exponent.to_integer().filter(|&count| count > 0)? as usize;
                let base = polynomial(graph, base, n, degree)?;
                for _ in 0..count {
                    product = times(graph, &product, &base);
                    if product.keys().any(|monomial| monomial.len() > degree) {
                        return None;
                    }
                }
            }
            Some(product)
        }
        _ => None,
    }
}

fn times(graph: &mut Graph, a: &Polynomial, b: &Polynomial) -> Polynomial {
    let mut sums: BTreeMap<Monomial, Vec<(Node, Rational)>> = BTreeMap::new();
    for (left, c) in a {
        for (right, d) in b {
            let mut monomial = [&left[..], &right[..]].concat();
            monomial.sort_unstable();
            sums.entry(monomial).or_default().push((graph.times(*c, *d), Rational::one()));
        }
    }
    added(graph, sums)
}

fn added(graph: &mut Graph, sums: BTreeMap<Monomial, Vec<(Node, Rational)>>) -> Polynomial {
    let mut total = Polynomial::new();
    for (monomial, terms) in sums {
        let sum = graph.sum(Rational::zero(), &terms);
        if !graph.is_zero(sum) {
            total.insert(monomial, sum);
        }
    }
    total
}
