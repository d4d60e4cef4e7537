//! Terms of J grad H that cancel are added before a field is written down.
//!
//! The field of a function of `|l|^2` vanishes, but the products `l2 (l3 f)` and `l3 (l2 f)` are rounded differently by a
//! machine. What is left of them is of the size of terms that the equations do not have, and may be larger than all that they
//! have. The coefficients of equal terms are therefore added here, exactly.

use super::expand::{expanded, n_terms};
use super::graph::{Graph, Node};
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

fn total(coefficients: &[Rational]) -> Rational {
    coefficients.iter().fold(Rational::zero(), |sum, c| sum.plus(c))
}

/// Whether the sum of these numbers is less than a sixteenth of their sizes: four bits or more would be lost.
fn cancel(coefficients: &[Rational]) -> bool {
    let sizes = coefficients.iter().fold(Rational::zero(), |sum, c| sum.plus(&c.size()));
    coefficients.len() > 1 && total(coefficients).size() < sizes.times(&Rational::fraction(1, 16))
}
