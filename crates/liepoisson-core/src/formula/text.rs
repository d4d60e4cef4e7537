//! Expressions as texts in the grammar.

use super::graph::{Expression, Graph, Node};
use super::rational::Rational;

impl Graph {
    /// The expression as a text; `names` are those of the symbols, by number.
    pub(super) fn shown(&self, node: Node, names: &[String]) -> String {
        match self.expression(node) {
            Expression::Number(number) => number.to_string(),
            Expression::Pi => "pi".to_owned(),
            Expression::Symbol(index) => names.get(*index).cloned().unwrap_or_else(|| format!("x{index}")),
            Expression::Sum { constant, terms } => {
                let mut text = String::new();
                for (term, c) in terms {
                    let sign = match (text.is_empty(), c.is_negative()) {
                        (true, false) => "",
                        (true, true) => "-",
                        (false, true) => " - ",
                        (false, false) => " + ",
                    };
                    let size = c.size();
                    let factor = if size.is_one() { String::new() } else { format!("{}*", fraction(&size)) };
                    text.push_str(&format!("{sign}{factor}{}", self.shown(*term, names)));
                }
                if !constant.is_zero() {
                    let sign = if constant.is_negative() { "-" } else { "+" };
                    text.push_str(&format!(" {sign} {}", constant.size()));
                }
                text
            }
            Expression::Product(factors) => {
                let over: Vec<String> = factors
                    .iter()
                    .filter(|(_, e)| !e.is_negative())
                    .map(|(b, e)| self.power_shown(*b, e, names))
                    .collect();
                let under: Vec<String> = factors
                    .iter()
                    .filter(|(_, e)| e.is_negative())
                    .map(|(b, e)| format!("/{}", self.power_shown(*b, &e.negated(), names)))
                    .collect();
                let over = if over.is_empty() { "1".to_owned() } else { over.join("*") };
                format!("{over}{}", under.concat())
            }
            Expression::Power(base, exponent) => {
                format!("{}^({})", self.in_brackets(*base, names), self.shown(*exponent, names))
            }
            Expression::Function(function, of) => format!("{}({})", function.name(), self.shown(*of, names)),
            Expression::Angle(y, x) => format!("atan2({}, {})", self.shown(*y, names), self.shown(*x, names)),
        }
    }

    fn power_shown(&self, base: Node, exponent: &Rational, names: &[String]) -> String {
        if *exponent == Rational::fraction(1, 2) {
            return format!("sqrt({})", self.shown(base, names));
        }
        let base = self.in_brackets(base, names);
        if exponent.is_one() { base } else { format!("{base}^{}", fraction(exponent)) }
    }

    fn in_brackets(&self, node: Node, names: &[String]) -> String {
        let text = self.shown(node, names);
        match self.expression(node) {
            Expression::Symbol(_) | Expression::Pi | Expression::Function(..) | Expression::Angle(..) => text,
            Expression::Number(number) if number.is_integer() && !number.is_negative() => text,
            _ => format!("({text})"),
        }
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

fn fraction(number: &Rational) -> String {
    if number.is_integer() && !number.is_negative() { number.to_string() } else { format!("({number})") }
}
