//! Exact derivatives.

use super::elementary::Function;
use super::graph::{Expression, Graph, Node};
use super::rational::Rational;
use std::collections::HashMap;

/// The derivative of an expression with respect to a symbol.
pub(super) fn derivative(graph: &mut Graph, node: Node, symbol: usize) -> Node {
    let zero = graph.integer(0);
    let mut known: HashMap<Node, Node> = HashMap::new();
    for part in graph.reachable(&[node]) {
        let slope = if *graph.expression(part) == Expression::Symbol(symbol) {
            Some(graph.integer(1))
        } else if graph.parts(part).iter().any(|inner| known.contains_key(inner)) {
            let slope = by_parts(graph, part, &known);
            Some(slope).filter(|&slope| slope != zero)
        } else {
            None
        };
        if let Some(slope) = slope {
            known.insert(part, slope);
        }
    }
    known.get(&node).copied().unwrap_or(zero)
}

/// The derivative of an expression from those of its parts; parts without one are constants.
fn by_parts(graph: &mut Graph, node: Node, slopes: &HashMap<Node, Node>) -> Node {
    let one = Rational::one;
    match graph.expression(node).clone() {
        Expression::Sum { terms, .. } => {
            let terms: Vec<_> = terms.iter().filter_map(|(term, c)| Some((*slopes.get(term)?, c.clone()))).collect();
            graph.sum(Rational::zero(), &terms)
        }
        Expression::Product(factors) => {
            let mut terms = vec![];
            for (k, (base, exponent)) in factors.iter().enumerate() {
                let Some(&slope) = slopes.get(base) else { continue };
                let mut others = factors.clone();
                others[k].1 = exponent.plus(&Rational::integer(-1));
                others.push((slope, one()));
                terms.push((graph.product(exponent.clone(), &others), one()));
            }
            graph.sum(Rational::zero(), &terms)
        }
        Expression::Power(base, exponent) => match slopes.get(&base) {
            Some(&slope) => {
                let inverse = (base, Rational::integer(-1));
                graph.product(one(), &[(exponent, one()), (node, one()), inverse, (slope, one())])
            }
            None => graph.integer(0),
        },
        Expression::Function(function, of) => {
            let outer = of_function(graph, function, of, node);
            graph.times(outer, slopes[&of])
        }
        Expression::Angle(y, x) => {
            let two = Rational::integer(2);
            let zero = graph.integer(0);
            let [dy, dx] = [y, x].map(|part| slopes.get(&part).copied().unwrap_or(zero));
            let [up, down] = [graph.times(x, dy), graph.times(y, dx)];
            let [xx, yy] = [x, y].map(|part| graph.power(part, two.clone()));
            let square = graph.plus(xx, yy);
            let turned = graph.sum(Rational::zero(), &[(up, one()), (down, Rational::integer(-1))]);
            graph.product(one(), &[(turned, one()), (square, Rational::integer(-1))])
        }
        Expression::Number(_) | Expression::Pi | Expression::Symbol(_) => graph.integer(0),
    }
}

/// The derivative of a function at its argument; `value` is the function there.
fn of_function(graph: &mut Graph, function: Function, of: Node, value: Node) -> Node {
    let (one, two) = (Rational::one(), Rational::integer(2));
    match function {
        Function::Exp => value,
        Function::Log => graph.power(of, Rational::integer(-1)),
        Function::Sin => graph.function(Function::Cos, of),
        Function::Cos => {
            let sine = graph.function(Function::Sin, of);
            graph.negated(sine)
        }
        Function::Sinh => graph.function(Function::Cosh, of),
        Function::Cosh => graph.function(Function::Sinh, of),
        Function::Tanh => {
            let square = graph.power(value, two);
            graph.sum(one, &[(square, Rational::integer(-1))])
        }
        Function::Asin | Function::Acos => {
            let square = graph.power(of, two);
            let rest = graph.sum(one, &[(square, Rational::integer(-1))]);
            let slope = graph.power(rest, Rational::fraction(-1, 2));
            if function == Function::Asin { slope } else { graph.negated(slope) }
        }
        Function::Atan => {
            let square = graph.power(of, two);
            let sum = graph.sum(one.clone(), &[(square, one)]);
            graph.power(sum, Rational::integer(-1))
        }
    }
}
