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
                    text.push_str(sign(c, text.is_empty()));
                    text.push_str(&self.multiple_shown(*term, &c.size(), names));
                }
                if !constant.is_zero() {
                    text.push_str(&format!("{}{}", sign(constant, false), constant.size()));
                }
                text
            }
            Expression::Product(_) => self.multiple_shown(node, &Rational::one(), names),
            Expression::Power(base, exponent) => {
                format!("{}^{}", self.in_brackets(*base, names), self.in_brackets(*exponent, names))
            }
            Expression::Function(function, of) => format!("{}({})", function.name(), self.shown(*of, names)),
            Expression::Angle(y, x) => format!("atan2({}, {})", self.shown(*y, names), self.shown(*x, names)),
        }
    }

    /// A positive number times an expression that is no sum.
    fn multiple_shown(&self, node: Node, c: &Rational, names: &[String]) -> String {
        let (mut over, mut under) = (vec![], vec![]);
        for (base, exponent) in self.factors(node) {
            let power = self.power_shown(base, &exponent.size(), names);
            if exponent.is_negative() { &mut under } else { &mut over }.push(power);
        }
        let [numerator, denominator] = [c.numerator(), c.denominator()].map(|part| part.digits());
        if over.is_empty() || numerator != "1" {
            over.insert(0, numerator);
        }
        if denominator != "1" {
            under.push(denominator);
        }
        let under: String = under.into_iter().map(|power| format!("/{power}")).collect();
        over.join("*") + &under
    }

    fn power_shown(&self, base: Node, exponent: &Rational, names: &[String]) -> String {
        if *exponent == Rational::fraction(1, 2) {
            return format!("sqrt({})", self.shown(base, names));
        }
        if exponent.is_one() && !matches!(self.expression(base), Expression::Sum { .. } | Expression::Number(_)) {
            return self.shown(base, names);
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

fn sign(number: &Rational, is_first: bool) -> &'static str {
    match (is_first, number.is_negative()) {
        (true, false) => "",
        (true, true) => "-",
        (false, true) => " - ",
        (false, false) => " + ",
    }
}

fn fraction(number: &Rational) -> String {
    if number.is_integer() && !number.is_negative() { number.to_string() } else { format!("({number})") }
}
