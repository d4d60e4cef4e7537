//! Expressions as they are written: a tree of what a line of print has, and its text in the grammar.

use super::graph::{Expression, Graph, Node};
use super::rational::Rational;
use std::collections::HashMap;
use std::fmt;

/// An expression as it is written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Written {
    /// A rational number, or pi.
    Number(String),
    /// A coordinate or a parameter.
    Name(String),
    /// Summands, each with whether it is subtracted.
    Sum(Vec<(bool, Written)>),
    /// A product of the first over the product of the second, which may be empty.
    Quotient(Vec<Written>, Vec<Written>),
    /// A power.
    Power(Box<Written>, Box<Written>),
    /// A square root.
    Root(Box<Written>),
    /// A function with its arguments.
    Call(&'static str, Vec<Written>),
}

impl fmt::Display for Written {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Written::Number(text) | Written::Name(text) => f.write_str(text),
            Written::Sum(terms) => terms.iter().enumerate().try_for_each(|(k, (is_negative, term))| {
                f.write_str(sign(*is_negative, k == 0))?;
                term.fmt(f)
            }),
            Written::Quotient(over, under) => {
                for (k, factor) in over.iter().enumerate() {
                    write!(f, "{}{}", if k == 0 { "" } else { "*" }, InProduct(factor))?;
                }
                under.iter().try_for_each(|factor| write!(f, "/{}", InProduct(factor)))
            }
            Written::Power(base, exponent) => write!(f, "{}^{}", InPower(base), InPower(exponent)),
            Written::Root(of) => write!(f, "sqrt({of})"),
            Written::Call(function, arguments) => {
                let arguments: Vec<String> = arguments.iter().map(Written::to_string).collect();
                write!(f, "{function}({})", arguments.join(", "))
            }
        }
    }
}

/// A factor: a sum in brackets.
struct InProduct<'w>(&'w Written);

impl fmt::Display for InProduct<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Written::Sum(_) => write!(f, "({})", self.0),
            Written::Number(text) if text.contains(['/', '-']) => write!(f, "({text})"),
            other => other.fmt(f),
        }
    }
}

/// A base or an exponent: in brackets what is more than a name, a whole number or a function.
struct InPower<'w>(&'w Written);

impl fmt::Display for InPower<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Written::Number(text) if text.contains(['/', '-']) => write!(f, "({text})"),
            Written::Number(_) | Written::Name(_) | Written::Call(..) => self.0.fmt(f),
            other => write!(f, "({other})"),
        }
    }
}

impl Graph {
    /// The expression as a text; `names` are those of the symbols, by number.
    pub(super) fn shown(&self, node: Node, names: &[String]) -> String {
        self.written(node, names).to_string()
    }

    /// The expression as it is written.
    pub(super) fn written(&self, node: Node, names: &[String]) -> Written {
        match self.expression(node) {
            Expression::Number(number) => Written::Number(number.to_string()),
            Expression::Pi => Written::Number("pi".to_owned()),
            Expression::Symbol(index) => {
                Written::Name(names.get(*index).cloned().unwrap_or_else(|| format!("x{index}")))
            }
            Expression::Sum { constant, terms } => {
                let term = |(term, c): &(Node, Rational)| (c.is_negative(), self.multiple(*term, &c.size(), names));
                let mut written: Vec<(bool, Written)> = terms.iter().map(term).collect();
                if !constant.is_zero() {
                    written.push((constant.is_negative(), Written::Number(constant.size().to_string())));
                }
                Written::Sum(written)
            }
            Expression::Product(_) => self.multiple(node, &Rational::one(), names),
            Expression::Power(base, exponent) => {
                Written::Power(self.written(*base, names).into(), self.written(*exponent, names).into())
            }
            Expression::Function(function, of) => Written::Call(function.name(), vec![self.written(*of, names)]),
            Expression::Angle(y, x) => Written::Call("atan2", vec![self.written(*y, names), self.written(*x, names)]),
        }
    }

    /// How many parts expressions have as they are written, where those that occur twice count twice.
    pub(super) fn written_size(&self, nodes: &[Node]) -> u64 {
        let mut sizes: HashMap<Node, u64> = HashMap::new();
        for node in self.reachable(nodes) {
            let own = self.parts(node).iter().map(|part| sizes[part]).fold(1, u64::saturating_add);
            sizes.insert(node, own);
        }
        nodes.iter().map(|node| sizes[node]).fold(0, u64::saturating_add)
    }

    /// A positive number times an expression that is no sum.
    fn multiple(&self, node: Node, c: &Rational, names: &[String]) -> Written {
        let (mut over, mut under) = (vec![], vec![]);
        for (base, exponent) in self.factors(node) {
            let power = self.power_written(base, &exponent.size(), names);
            if exponent.is_negative() { &mut under } else { &mut over }.push(power);
        }
        let [numerator, denominator] = [c.numerator(), c.denominator()].map(|part| part.digits());
        if over.is_empty() || numerator != "1" {
            over.insert(0, Written::Number(numerator));
        }
        if denominator != "1" {
            under.push(Written::Number(denominator));
        }
        match (over.len(), under.is_empty()) {
            (1, true) => over.remove(0),
            _ => Written::Quotient(over, under),
        }
    }

    fn power_written(&self, base: Node, exponent: &Rational, names: &[String]) -> Written {
        let base = self.written(base, names);
        if *exponent == Rational::fraction(1, 2) {
            return Written::Root(base.into());
        }
        if exponent.is_one() { base } else { Written::Power(base.into(), Written::Number(exponent.to_string()).into()) }
    }

    /// All rational numbers that are parts of an expression.
    pub(super) fn numbers_in(&self, node: Node) -> Vec<Rational> {
        let of = |part: Node| match self.expression(part) {
            Expression::Number(number) => vec![number.clone()],
            Expression::Sum { constant, terms } => {
                terms.iter().map(|(_, c)| c.clone()).chain([constant.clone()]).collect()
            }
            Expression::Product(factors) => factors.iter().map(|(_, exponent)| exponent.clone()).collect(),
            _ => vec![],
        };
        self.reachable(&[node]).into_iter().flat_map(of).collect()
    }
}

fn sign(is_negative: bool, is_first: bool) -> &'static str {
    match (is_first, is_negative) {
        (true, false) => "",
        (true, true) => "-",
        (false, true) => " - ",
        (false, false) => " + ",
    }
}
