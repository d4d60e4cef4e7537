//! Terms of J grad H that cancel are added before a field is written down.
//!
//! The field of a function of `|l|^2` vanishes, but the products `l2 (l3 f)` and `l3 (l2 f)` are rounded differently by a
//! machine. What is left of them is of the size of terms that the equations do not have, and may be larger than all that they
//! have. The coefficients of equal terms are therefore added here, exactly.

use super::expand::{expanded, n_terms};
use super::graph::{Expression, Graph, Node};
use super::rational::Rational;
use std::collections::{BTreeMap, BTreeSet};

/// Products in one component that would have more terms than this together are not multiplied out.
const MOST_EXPANDED: u64 = 500;

/// A field with more terms is written as it is.
pub(super) const MOST_TERMS: usize = 20_000;

/// A term of a component of J grad H: what stands before a slope, and the slope.
pub(super) type Product = (Node, Node);

/// The sum of the products: with a slope as one factor, unless terms of it cancel with others.
pub(super) fn sum_of_products(graph: &mut Graph, products: &[Product], looks_for_terms: bool) -> Node {
    let regrouped = if looks_for_terms { regrouped(graph, products) } else { None };
    let terms = regrouped.unwrap_or_else(|| {
        products.iter().map(|&(outside, slope)| (graph.times(outside, slope), Rational::one())).collect()
    });
    graph.sum(Rational::zero(), &terms)
}

/// The terms of the sum, in which none cancel; `None` if none do as it stands.
fn regrouped(graph: &mut Graph, products: &[Product]) -> Option<Vec<(Node, Rational)>> {
    let mut terms: Vec<(Rational, Node)> = vec![];
    let mut of_product = vec![];
    for &(outside, slope) in products {
        let start = terms.len();
        let (constant, parts) = graph.terms(slope);
        for (part, c) in parts {
            let term = graph.times(outside, part);
            let (number, rest) = graph.with_coefficient(term);
            terms.push((number.times(&c), rest));
        }
        if !constant.is_zero() {
            let (number, rest) = graph.with_coefficient(outside);
            terms.push((number.times(&constant), rest));
        }
        of_product.push(start..terms.len());
    }
    let (mut changed, mut result) = (BTreeSet::new(), vec![]);
    add_equal(&terms, &mut changed, &mut result);
    add_expanded(graph, &terms, &mut changed, &mut result);
    if changed.is_empty() {
        return None;
    }
    for (&(outside, slope), own) in products.iter().zip(of_product) {
        if own.clone().all(|k| !changed.contains(&k)) {
            // a sum that stays is one factor
            result.push((graph.times(outside, slope), Rational::one()));
        } else {
            result.extend(own.filter(|k| !changed.contains(k)).map(|k| (terms[k].1, terms[k].0.clone())));
        }
    }
    Some(result)
}

/// Adds terms that are multiples of each other, as they are written.
fn add_equal(terms: &[(Rational, Node)], changed: &mut BTreeSet<usize>, result: &mut Vec<(Node, Rational)>) {
    let mut groups: BTreeMap<Node, Vec<usize>> = BTreeMap::new();
    for (k, (_, rest)) in terms.iter().enumerate() {
        groups.entry(*rest).or_default().push(k);
    }
    for (rest, group) in groups {
        let coefficients: Vec<Rational> = group.iter().map(|&k| terms[k].0.clone()).collect();
        if cancel(&coefficients) {
            changed.extend(group);
            result.push((rest, total(&coefficients)));
        }
    }
}

/// Adds products of sums after multiplying them out, where something cancels.
fn add_expanded(
    graph: &mut Graph,
    terms: &[(Rational, Node)],
    changed: &mut BTreeSet<usize>,
    result: &mut Vec<(Node, Rational)>,
) {
    let left: Vec<usize> = (0..terms.len()).filter(|k| !changed.contains(k)).collect();
    let n_expanded = left.iter().map(|&k| n_terms(graph, terms[k].1)).fold(0u64, u64::saturating_add);
    if n_expanded > MOST_EXPANDED {
        return;
    }
    let one = graph.integer(1);
    let mut polynomials: BTreeMap<usize, Vec<(Node, Rational)>> = BTreeMap::new();
    for &k in &left {
        let whole = expanded(graph, terms[k].1);
        let (constant, mut parts) = graph.terms(whole);
        parts.push((one, constant));
        parts.retain(|(_, c)| !c.is_zero());
        parts.iter_mut().for_each(|(_, c)| *c = c.times(&terms[k].0));
        polynomials.insert(k, parts);
    }
    let mut coefficients: BTreeMap<Node, Vec<Rational>> = BTreeMap::new();
    for (monomial, c) in polynomials.values().flatten() {
        coefficients.entry(*monomial).or_default().push(c.clone());
    }
    let lost: BTreeSet<Node> =
        coefficients.iter().filter(|(_, values)| cancel(values)).map(|(&monomial, _)| monomial).collect();
    for (k, polynomial) in polynomials {
        if polynomial.iter().any(|(monomial, _)| lost.contains(monomial)) {
            changed.insert(k);
            result.extend(polynomial);
        }
    }
}

/// A sum below this part of its terms may be zero, and is looked at exactly.
const CANCELLED: f64 = 1e-9;

/// Whether all sums of products vanish identically, as those of a function of Casimirs: a tape would leave round-off.
///
/// Most do not vanish at one state of no special position, and no more is computed for them.
pub(super) fn all_vanish(graph: &mut Graph, n: usize, rows: &[Vec<Product>]) -> bool {
    let state: Vec<f64> = (0..n).map(|k| (2 * k + 3) as f64 / (k + 2) as f64).collect();
    let factors: Vec<Node> = rows.iter().flatten().flat_map(|&(outside, slope)| [outside, slope]).collect();
    let values = values_at(graph, &factors, &state);
    for row in rows {
        let terms: Vec<f64> = row.iter().map(|(outside, slope)| values[outside] * values[slope]).collect();
        let size: f64 = terms.iter().map(|term| term.abs()).sum();
        let sum: f64 = terms.iter().sum();
        // not true of numbers that are none, where something is not defined
        let is_small = sum.abs() <= CANCELLED * size;
        if !is_small {
            return false;
        }
    }
    rows.iter().all(|row| {
        let terms: Vec<_> =
            row.iter().map(|&(outside, slope)| (graph.times(outside, slope), Rational::one())).collect();
        let n_expanded = terms.iter().map(|&(term, _)| n_terms(graph, term)).fold(0u64, u64::saturating_add);
        n_expanded <= MOST_TERMS as u64 && {
            let sum = graph.sum(Rational::zero(), &terms);
            let sum = expanded(graph, sum);
            graph.is_zero(sum)
        }
    })
}

/// The values of expressions in doubles; what is not defined is no number.
fn values_at(graph: &Graph, nodes: &[Node], state: &[f64]) -> BTreeMap<Node, f64> {
    let mut values: BTreeMap<Node, f64> = BTreeMap::new();
    for node in graph.reachable(nodes) {
        let power = |(base, exponent): &(Node, Rational)| libm::pow(values[base], exponent.to_f64());
        let value = match graph.expression(node) {
            Expression::Number(number) => number.to_f64(),
            Expression::Pi => std::f64::consts::PI,
            Expression::Symbol(index) => state.get(*index).copied().unwrap_or(f64::NAN),
            Expression::Sum { constant, terms } => {
                terms.iter().map(|(term, c)| values[term] * c.to_f64()).sum::<f64>() + constant.to_f64()
            }
            Expression::Product(factors) => factors.iter().map(power).product(),
            Expression::Power(base, exponent) => libm::pow(values[base], values[exponent]),
            Expression::Function(function, of) => function.at(values[of]),
            Expression::Angle(y, x) => libm::atan2(values[y], values[x]),
        };
        values.insert(node, value);
    }
    values
}

fn total(coefficients: &[Rational]) -> Rational {
    coefficients.iter().fold(Rational::zero(), |sum, c| sum.plus(c))
}

/// Whether the sum of these numbers is less than a sixteenth of their sizes: four bits or more would be lost.
fn cancel(coefficients: &[Rational]) -> bool {
    let sizes = coefficients.iter().fold(Rational::zero(), |sum, c| sum.plus(&c.size()));
    coefficients.len() > 1 && total(coefficients).size() < sizes.times(&Rational::fraction(1, 16))
}
