//! Quotients of exponentials, written so that none of them is infinite over infinite.
//!
//! `e^u / (1 + e^u)^2` tends to zero on both sides, and in doubles it is infinite over infinite for `u > 710`. With `D` the sum of
//! `c_i e^(u_i)` and all `c_i > 0`, `e^(u_i) / D` is one over the sum of `c_j e^(u_j - u_i)`, which is right to all digits, or
//! zero where a term is beyond the range of numbers. Likewise `sinh u / cosh u` is a hyperbolic tangent.

use super::elementary::Function;
use super::expand::expanded;
use super::graph::{Expression, Graph, Node};
use super::rational::Rational;
use std::collections::{BTreeMap, HashMap};

/// Exponentials that are looked for in a product.
const MOST_FACTORS: usize = 4;

/// Exponentials in a sum that is looked at.
const MOST_TERMS: usize = 6;

/// The same expressions of real coordinates, in which no exponential stands over a sum that it is a term of, and angles of pairs
/// are those of one number: half of an angle has the tangent `y / (sqrt(x^2 + y^2) + x)`.
pub(super) fn without_overflow(graph: &mut Graph, outputs: &[Node]) -> Vec<Node> {
    let mut new: HashMap<Node, Node> = HashMap::new();
    for node in graph.reachable(outputs) {
        let value = match graph.expression(node).clone() {
            Expression::Number(_) | Expression::Pi | Expression::Symbol(_) => node,
            Expression::Sum { constant, terms } => {
                let terms: Vec<_> = terms.into_iter().map(|(term, c)| (new[&term], c)).collect();
                graph.sum(constant, &terms)
            }
            Expression::Product(factors) => {
                let factors: Vec<_> = factors.into_iter().map(|(base, exponent)| (new[&base], exponent)).collect();
                let whole = graph.product(Rational::one(), &factors);
                divided(graph, whole)
            }
            Expression::Power(base, exponent) => graph.power_of_symbols(new[&base], new[&exponent]),
            Expression::Function(function, of) => graph.function(function, new[&of]),
            Expression::Angle(y, x) => of_half_angle(graph, new[&y], new[&x]),
        };
        new.insert(node, value);
    }
    outputs.iter().map(|output| new[output]).collect()
}

fn of_half_angle(graph: &mut Graph, y: Node, x: Node) -> Node {
    let one = Rational::one;
    let [xx, yy] = [x, y].map(|part| graph.power(part, Rational::integer(2)));
    let square = graph.plus(xx, yy);
    let length = graph.power(square, Rational::fraction(1, 2));
    let sum = graph.plus(length, x);
    if graph.is_zero(sum) {
        return graph.pi();
    }
    let tangent = graph.product(one(), &[(y, one()), (sum, Rational::integer(-1))]);
    let half = graph.function(Function::Atan, tangent);
    graph.scaled(&Rational::integer(2), half)
}

/// Powers of a product; the exponential in it is kept apart, by its argument.
struct Powers {
    coefficient: Rational,
    of: BTreeMap<Node, Rational>,
    argument: Option<Node>,
}

impl Powers {
    fn read(graph: &mut Graph, node: Node) -> Powers {
        let (coefficient, rest) = graph.with_coefficient(node);
        let mut powers = Powers { coefficient, of: BTreeMap::new(), argument: None };
        for (base, exponent) in graph.factors(rest) {
            match graph.expression(base) {
                Expression::Function(Function::Exp, of) if exponent.is_one() => powers.argument = Some(*of),
                _ => powers.add(base, exponent),
            }
        }
        powers
    }

    fn add(&mut self, base: Node, exponent: Rational) {
        let sum = self.of.entry(base).or_insert_with(Rational::zero);
        *sum = sum.plus(&exponent);
    }

    fn whole(&self, base: Node) -> Option<i64> {
        self.of.get(&base)?.to_integer()
    }

    fn product(self, graph: &mut Graph) -> Node {
        let mut factors: Vec<_> = self.of.into_iter().collect();
        if let Some(argument) = self.argument {
            factors.push((graph.function(Function::Exp, argument), Rational::one()));
        }
        graph.product(self.coefficient, &factors)
    }
}

/// A product whose exponentials and hyperbolic functions are divided by what they stand over.
fn divided(graph: &mut Graph, node: Node) -> Node {
    let mut powers = Powers::read(graph, node);
    divide_hyperbolic(graph, &mut powers);
    divide_sums(graph, &mut powers);
    divide_exponentials(graph, &mut powers);
    powers.product(graph)
}

/// Writes sinh over cosh as tanh, cosh over sinh as one over tanh.
fn divide_hyperbolic(graph: &mut Graph, powers: &mut Powers) {
    let bases: Vec<Node> = powers.of.keys().copied().collect();
    for base in bases {
        let &Expression::Function(Function::Sinh, argument) = graph.expression(base) else { continue };
        let other = graph.function(Function::Cosh, argument);
        let (Some(m), Some(n)) = (powers.whole(base), powers.whole(other)) else { continue };
        if m * n < 0 {
            let common = m.abs().min(n.abs()) * m.signum();
            let tangent = graph.function(Function::Tanh, argument);
            powers.add(base, Rational::integer(-common));
            powers.add(other, Rational::integer(common));
            powers.add(tangent, Rational::integer(common));
        }
    }
}

/// Divides sums of exponentials by sums of exponentials, term by term.
fn divide_sums(graph: &mut Graph, powers: &mut Powers) {
    let bases: Vec<Node> = powers.of.keys().copied().collect();
    for &top in &bases {
        let has_exponential = |graph: &Graph| {
            let is_exponential = |node| matches!(graph.expression(node), Expression::Function(Function::Exp, _));
            matches!(graph.expression(top), Expression::Sum { .. })
                && graph.reachable(&[top]).into_iter().any(is_exponential)
        };
        if powers.whole(top).is_none_or(|n| n <= 0) || !has_exponential(graph) {
            continue;
        }
        for &bottom in &bases {
            let (Some(m), Some(n)) = (powers.whole(top), powers.whole(bottom)) else { continue };
            if m <= 0 || n >= 0 || sum_of_exponentials(graph, bottom).is_none() {
                continue;
            }
            let common = m.min(-n);
            let inverse = (bottom, Rational::integer(-1));
            let (constant, mut terms) = graph.terms(top);
            if !constant.is_zero() {
                terms.push((graph.integer(1), constant));
            }
            let (mut sum, mut is_changed) = (vec![], false);
            for (term, c) in terms {
                let plain = graph.product(c, &[(term, Rational::one()), inverse.clone()]);
                let quotient = divided(graph, plain);
                is_changed |= quotient != plain;
                sum.push((quotient, Rational::one()));
            }
            if is_changed {
                let ratio = graph.sum(Rational::zero(), &sum);
                powers.add(top, Rational::integer(-common));
                powers.add(bottom, Rational::integer(common));
                powers.add(ratio, Rational::integer(common));
            }
        }
    }
}

/// Writes exponentials over sums that they are terms of as one over sums.
fn divide_exponentials(graph: &mut Graph, powers: &mut Powers) {
    let bases: Vec<Node> = powers.of.keys().copied().collect();
    for base in bases {
        let Some(argument) = powers.argument else { return };
        let exponent = powers.of[&base].clone();
        if !exponent.is_negative() {
            continue;
        }
        let Some(terms) = positive_sum(graph, base) else { continue };
        let most = exponent.size().floor().unwrap_or(0) as usize;
        let chosen = chosen(graph, argument, &terms, most);
        if chosen.is_empty() {
            continue;
        }
        let minus = |node: &Node| (*node, Rational::integer(-1));
        let mut left: Vec<_> = chosen.iter().map(minus).collect();
        left.push((argument, Rational::one()));
        let rest = graph.sum(Rational::zero(), &left);
        let is_zero = {
            let multiplied = expanded(graph, rest);
            graph.is_zero(multiplied)
        };
        powers.argument = if is_zero { None } else { Some(rest) };
        powers.add(base, Rational::integer(chosen.len() as i64));
        for own in chosen {
            let mut sum = vec![];
            for (of, c) in &terms {
                let difference = graph.sum(Rational::zero(), &[(*of, Rational::one()), minus(&own)]);
                let exponential = graph.function(Function::Exp, difference);
                sum.push((exponential, c.clone()));
            }
            let divided = graph.sum(Rational::zero(), &sum);
            powers.add(divided, Rational::integer(-1));
        }
    }
}

/// A sum of exponentials with positive coefficients, by argument; also a hyperbolic cosine.
fn positive_sum(graph: &mut Graph, base: Node) -> Option<Vec<(Node, Rational)>> {
    if let &Expression::Function(Function::Cosh, of) = graph.expression(base) {
        let half = Rational::fraction(1, 2);
        let opposite = graph.negated(of);
        return Some(vec![(of, half.clone()), (opposite, half)]);
    }
    sum_of_exponentials(graph, base)
}

fn sum_of_exponentials(graph: &mut Graph, base: Node) -> Option<Vec<(Node, Rational)>> {
    let Expression::Sum { constant, terms } = graph.expression(base).clone() else { return None };
    let count = terms.len() + usize::from(!constant.is_zero());
    if !(2..=MOST_TERMS).contains(&count) || constant.is_negative() {
        return None;
    }
    let mut found = vec![];
    if !constant.is_zero() {
        found.push((graph.integer(0), constant));
    }
    for (term, c) in terms {
        match graph.expression(term) {
            Expression::Function(Function::Exp, of) if !c.is_negative() => found.push((*of, c)),
            _ => return None,
        }
    }
    Some(found)
}

/// At most so many arguments that add up to that of an exponential, or leave a positive multiple of one; else none.
fn chosen(graph: &mut Graph, argument: Node, terms: &[(Node, Rational)], most: usize) -> Vec<Node> {
    let own: Vec<Node> = terms.iter().map(|(of, _)| *of).filter(|&of| !graph.is_zero(of)).collect();
    for &u in &own {
        let Some(ratio) = ratio(graph, argument, u).filter(|ratio| !ratio.is_negative()) else { continue };
        if most == 0 || ratio.is_zero() {
            continue;
        }
        let whole = ratio.floor().map_or(most, |floor| (floor as usize).min(most));
        let mut found = vec![u; whole];
        let rest = ratio.plus(&Rational::integer(-(whole as i64)));
        if whole < most && !rest.is_zero() {
            found.push(graph.scaled(&rest, u));
        }
        return found;
    }
    for count in 2..=most.min(MOST_FACTORS) {
        let mut places = vec![0; count];
        loop {
            let terms: Vec<_> = places.iter().map(|&place| (own[place], Rational::one())).collect();
            if graph.sum(Rational::zero(), &terms) == argument {
                return terms.into_iter().map(|(node, _)| node).collect();
            }
            let Some(k) = places.iter().rposition(|&place| place + 1 < own.len()) else { break };
            let next = places[k] + 1;
            places[k..].fill(next);
        }
    }
    vec![]
}

/// The number by which the second expression is multiplied in the first, if there is one.
fn ratio(graph: &Graph, a: Node, b: Node) -> Option<Rational> {
    let ((constant_a, a), (constant_b, b)) = (graph.terms(a), graph.terms(b));
    let (first, second) = (a.first()?, b.first()?);
    let ratio = first.1.times(&second.1.reciprocal());
    let same = a.len() == b.len() && a.iter().zip(&b).all(|(p, q)| p.0 == q.0 && p.1 == q.1.times(&ratio));
    (same && constant_a == constant_b.times(&ratio)).then_some(ratio)
}
