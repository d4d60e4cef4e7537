//! Expressions as a graph in which every one stands once, with exact constants.
//!
//! Sums are flat, and like terms in them are added exactly; products are flat, and powers of one base in them are one
//! power. What a user has put into brackets as a factor stays one: nothing is multiplied out. Both are sorted by the order in
//! which their parts were made, which is that of the text, so that no name decides how something is rounded.

use super::constant::Constant;
use super::elementary::Function;
use super::measure::{Measure, measure};
use super::rational::Rational;
use std::cell::RefCell;
use std::collections::{BTreeMap, HashMap};

/// An expression, by its number in the graph. Its parts have lower numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Node(u32);

/// What an expression is made of.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum Expression {
    Number(Rational),
    Pi,
    /// A coordinate, or a parameter without value.
    Symbol(usize),
    /// `constant + sum of c e`: two summands or more, or one with a factor. No term is a number or a sum.
    Sum {
        constant: Rational,
        terms: Vec<(Node, Rational)>,
    },
    /// Powers: two or more, or one with an exponent that is not 1. No base with a whole exponent is a number, a product, or a
    /// sum of one term.
    Product(Vec<(Node, Rational)>),
    /// A power whose exponent is made of parameters.
    Power(Node, Node),
    Function(Function, Node),
    /// The angle of the point `(x, y)`, given as `(y, x)`.
    Angle(Node, Node),
}

/// The expressions of a system.
#[derive(Clone, Debug, Default)]
pub struct Graph {
    expressions: Vec<Expression>,
    numbers: HashMap<Expression, Node>,
    measures: Vec<Measure>,
    /// Values of constants that have been asked for.
    pub(super) constants: RefCell<HashMap<Node, Constant>>,
}

impl Graph {
    /// A graph of coordinates `0..n`, which are its first nodes.
    pub(super) fn new(n_coordinates: usize) -> Graph {
        let mut graph = Graph::default();
        for k in 0..n_coordinates {
            graph.symbol(k);
        }
        graph
    }

    pub(super) fn expression(&self, node: Node) -> &Expression {
        &self.expressions[node.0 as usize]
    }

    pub(super) fn measure(&self, node: Node) -> &Measure {
        &self.measures[node.0 as usize]
    }

    /// How many expressions there are.
    pub(super) fn len(&self) -> usize {
        self.expressions.len()
    }

    /// The number that a node is, if it is a rational one.
    pub(super) fn rational(&self, node: Node) -> Option<&Rational> {
        match self.expression(node) {
            Expression::Number(number) => Some(number),
            _ => None,
        }
    }

    pub(super) fn is_zero(&self, node: Node) -> bool {
        self.rational(node).is_some_and(Rational::is_zero)
    }

    pub(super) fn node(&mut self, expression: Expression) -> Node {
        if let Some(&known) = self.numbers.get(&expression) {
            return known;
        }
        let node = Node(self.expressions.len() as u32);
        let measure = measure(self, &expression);
        self.measures.push(measure);
        self.expressions.push(expression.clone());
        self.numbers.insert(expression, node);
        node
    }

    pub(super) fn number(&mut self, number: Rational) -> Node {
        self.node(Expression::Number(number))
    }

    pub(super) fn integer(&mut self, value: i64) -> Node {
        self.number(Rational::integer(value))
    }

    pub(super) fn pi(&mut self) -> Node {
        self.node(Expression::Pi)
    }

    pub(super) fn symbol(&mut self, index: usize) -> Node {
        self.node(Expression::Symbol(index))
    }

    /// The constant and the terms of a sum; another expression is one term.
    pub(super) fn terms(&self, node: Node) -> (Rational, Vec<(Node, Rational)>) {
        match self.expression(node) {
            Expression::Number(number) => (number.clone(), vec![]),
            Expression::Sum { constant, terms } => (constant.clone(), terms.clone()),
            _ => (Rational::zero(), vec![(node, Rational::one())]),
        }
    }

    /// The powers of a product; another expression is one power.
    pub(super) fn factors(&self, node: Node) -> Vec<(Node, Rational)> {
        match self.expression(node) {
            Expression::Product(factors) => factors.clone(),
            _ => vec![(node, Rational::one())],
        }
    }

    /// The rational factor of an expression, and the rest.
    pub(super) fn with_coefficient(&mut self, node: Node) -> (Rational, Node) {
        match self.expression(node) {
            Expression::Number(number) => (number.clone(), self.integer(1)),
            Expression::Sum { constant, terms } if constant.is_zero() && terms.len() == 1 => {
                (terms[0].1.clone(), terms[0].0)
            }
            _ => (Rational::one(), node),
        }
    }

    /// `constant + sum of c e`.
    pub(super) fn sum(&mut self, constant: Rational, items: &[(Node, Rational)]) -> Node {
        let mut total = constant;
        let mut sums: BTreeMap<Node, Rational> = BTreeMap::new();
        let mut add = |node: Node, c: Rational| {
            let sum = sums.entry(node).or_insert_with(Rational::zero);
            *sum = sum.plus(&c);
        };
        for (node, c) in items {
            match self.expression(*node) {
                Expression::Number(number) => total = total.plus(&number.times(c)),
                Expression::Sum { constant, terms } => {
                    total = total.plus(&constant.times(c));
                    terms.iter().for_each(|(node, inner)| add(*node, inner.times(c)));
                }
                _ => add(*node, c.clone()),
            }
        }
        let terms: Vec<_> = sums.into_iter().filter(|(_, c)| !c.is_zero()).collect();
        match &terms[..] {
            [] => self.number(total),
            [(node, c)] if c.is_one() && total.is_zero() => *node,
            _ => self.node(Expression::Sum { constant: total, terms }),
        }
    }

    pub(super) fn plus(&mut self, a: Node, b: Node) -> Node {
        self.sum(Rational::zero(), &[(a, Rational::one()), (b, Rational::one())])
    }

    pub(super) fn scaled(&mut self, c: &Rational, node: Node) -> Node {
        self.sum(Rational::zero(), &[(node, c.clone())])
    }

    pub(super) fn negated(&mut self, node: Node) -> Node {
        self.scaled(&Rational::integer(-1), node)
    }

    pub(super) fn times(&mut self, a: Node, b: Node) -> Node {
        self.product(Rational::one(), &[(a, Rational::one()), (b, Rational::one())])
    }

    /// A base to a rational exponent, which is not negative where the base is zero.
    pub(super) fn power(&mut self, base: Node, exponent: Rational) -> Node {
        self.product(Rational::one(), &[(base, exponent)])
    }

    /// `coefficient times powers`; none of them is a negative power of zero.
    pub(super) fn product(&mut self, coefficient: Rational, items: &[(Node, Rational)]) -> Node {
        let mut coefficient = coefficient;
        let mut powers: BTreeMap<Node, Rational> = BTreeMap::new();
        // the argument of all exponentials together
        let mut argument: Option<Node> = None;
        let mut waiting: Vec<(Node, Rational)> = items.iter().rev().cloned().collect();
        while let Some((base, exponent)) = waiting.pop() {
            if exponent.is_zero() {
                continue;
            }
            let whole = exponent.to_integer();
            match self.expression(base).clone() {
                Expression::Number(number) => {
                    let c = self.power_of_number(&number, &exponent, &mut powers);
                    coefficient = coefficient.times(&c);
                    continue;
                }
                Expression::Product(factors) if whole.is_some() => {
                    waiting.extend(factors.iter().rev().map(|(node, inner)| (*node, inner.times(&exponent))));
                    continue;
                }
                Expression::Sum { constant, terms } if constant.is_zero() && terms.len() == 1 => {
                    let (node, c) = &terms[0];
                    if let Some(whole) = whole {
                        coefficient = coefficient.times(&c.power(whole));
                        waiting.push((*node, exponent));
                        continue;
                    }
                    // a positive factor leaves a root where its own root is rational
                    if let Some(root) = exact_power(c, &exponent) {
                        coefficient = coefficient.times(&root);
                        waiting.push((*node, exponent));
                        continue;
                    }
                }
                Expression::Function(Function::Exp, of) => {
                    let of = self.scaled(&exponent, of);
                    argument = Some(argument.map_or(of, |sum| self.plus(sum, of)));
                    continue;
                }
                _ => {}
            }
            // a power that has become whole is looked at once more
            let before = powers.remove(&base);
            let total = before.as_ref().map_or_else(|| exponent.clone(), |before| before.plus(&exponent));
            if before.is_some_and(|before| !before.is_integer()) && total.is_integer() {
                waiting.push((base, total));
            } else if !total.is_zero() {
                powers.insert(base, total);
            }
        }
        if let Some(argument) = argument.filter(|&argument| !self.is_zero(argument)) {
            let exponential = self.function(Function::Exp, argument);
            match self.expression(exponential) {
                Expression::Function(Function::Exp, _) => {
                    powers.insert(exponential, Rational::one());
                }
                _ => {
                    let product: Vec<_> = powers.into_iter().chain([(exponential, Rational::one())]).collect();
                    return self.product(coefficient, &product);
                }
            }
        }
        if coefficient.is_zero() {
            return self.number(coefficient);
        }
        let factors: Vec<_> = powers.into_iter().collect();
        let rest = match &factors[..] {
            [] => return self.number(coefficient),
            [(node, exponent)] if exponent.is_one() => *node,
            _ => self.node(Expression::Product(factors)),
        };
        self.scaled(&coefficient, rest)
    }

    /// A number to an exponent: its rational factor is returned, roots of primes go to `powers`, with exponents below 1.
    fn power_of_number(
        &mut self,
        number: &Rational,
        exponent: &Rational,
        powers: &mut BTreeMap<Node, Rational>,
    ) -> Rational {
        if let Some(whole) = exponent.to_integer() {
            return number.power(whole);
        }
        if number.is_zero() {
            return Rational::zero();
        }
        if number.is_negative() {
            // no real number, which is refused where it is measured
            let node = self.number(number.clone());
            powers.insert(node, exponent.clone());
            return Rational::one();
        }
        let mut coefficient = Rational::one();
        if let Some(root) = exact_power(number, exponent) {
            return root;
        }
        for (part, sign) in [(number.numerator(), 1), (number.denominator(), -1)] {
            for (prime, count) in part.small_factors() {
                let node = self.number(Rational::whole(prime));
                let before = powers.remove(&node).unwrap_or_else(Rational::zero);
                let total = before.plus(&exponent.times(&Rational::integer(sign * count)));
                let whole = total.floor().unwrap_or(0);
                let Expression::Number(prime) = self.expression(node) else { unreachable!("it is a number") };
                coefficient = coefficient.times(&prime.power(whole));
                let rest = total.plus(&Rational::integer(-whole));
                if !rest.is_zero() {
                    powers.insert(node, rest);
                }
            }
        }
        coefficient
    }

    /// A base to an exponent that is made of parameters.
    pub(super) fn power_of_symbols(&mut self, base: Node, exponent: Node) -> Node {
        match self.rational(exponent) {
            Some(number) => {
                let number = number.clone();
                self.power(base, number)
            }
            None if self.rational(base).is_some_and(Rational::is_one) => base,
            None => self.node(Expression::Power(base, exponent)),
        }
    }

    pub(super) fn angle(&mut self, y: Node, x: Node) -> Node {
        self.node(Expression::Angle(y, x))
    }

    /// The parts of an expression.
    pub(super) fn parts(&self, node: Node) -> Vec<Node> {
        match self.expression(node) {
            Expression::Number(_) | Expression::Pi | Expression::Symbol(_) => vec![],
            Expression::Sum { terms: parts, .. } | Expression::Product(parts) => {
                parts.iter().map(|&(part, _)| part).collect()
            }
            Expression::Function(_, of) => vec![*of],
            Expression::Power(a, b) | Expression::Angle(a, b) => vec![*a, *b],
        }
    }

    /// All expressions that these are made of, and they themselves; parts come before what is made of them.
    pub(super) fn reachable(&self, outputs: &[Node]) -> Vec<Node> {
        let mut is_needed = vec![false; self.len()];
        let mut waiting = outputs.to_vec();
        while let Some(node) = waiting.pop() {
            if !std::mem::replace(&mut is_needed[node.0 as usize], true) {
                waiting.extend(self.parts(node));
            }
        }
        (0..self.len() as u32).filter(|&k| is_needed[k as usize]).map(Node).collect()
    }

    /// The symbols in an expression, in order.
    pub(super) fn symbols(&self, node: Node) -> Vec<usize> {
        let symbol = |node: Node| match self.expression(node) {
            Expression::Symbol(index) => Some(*index),
            _ => None,
        };
        let mut found: Vec<usize> = self.reachable(&[node]).into_iter().filter_map(symbol).collect();
        found.sort_unstable();
        found
    }
}

/// A positive number to a rational exponent, where that is a rational number.
fn exact_power(number: &Rational, exponent: &Rational) -> Option<Rational> {
    let order = exponent.denominator().to_u64().filter(|order| (1..=64).contains(order))? as u32;
    let times = exponent.times(&Rational::integer(i64::from(order))).to_integer()?;
    let root = if number.is_negative() || number.is_zero() { None } else { number.exact_root(order) };
    Some(root?.power(times))
}
