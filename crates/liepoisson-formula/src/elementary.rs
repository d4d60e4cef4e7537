//! Elementary functions of one argument, and what is known of their values.

use super::graph::{Expression, Graph, Node};
use super::rational::Rational;

/// A function of one argument; `tan` is the quotient of two, `sqrt` a power.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Function {
    Exp,
    Log,
    Sin,
    Cos,
    Sinh,
    Cosh,
    Tanh,
    Asin,
    Acos,
    Atan,
}

impl Function {
    /// The function of this name.
    pub(super) fn named(name: &str) -> Option<Function> {
        Some(match name {
            "exp" => Function::Exp,
            "log" => Function::Log,
            "sin" => Function::Sin,
            "cos" => Function::Cos,
            "sinh" => Function::Sinh,
            "cosh" => Function::Cosh,
            "tanh" => Function::Tanh,
            "asin" => Function::Asin,
            "acos" => Function::Acos,
            "atan" => Function::Atan,
            _ => return None,
        })
    }

    /// Its name in the grammar.
    pub(super) fn name(self) -> &'static str {
        match self {
            Function::Exp => "exp",
            Function::Log => "log",
            Function::Sin => "sin",
            Function::Cos => "cos",
            Function::Sinh => "sinh",
            Function::Cosh => "cosh",
            Function::Tanh => "tanh",
            Function::Asin => "asin",
            Function::Acos => "acos",
            Function::Atan => "atan",
        }
    }

    /// The value at a double.
    pub(super) fn at(self, x: f64) -> f64 {
        match self {
            Function::Exp => libm::exp(x),
            Function::Log => libm::log(x),
            Function::Sin => libm::sin(x),
            Function::Cos => libm::cos(x),
            Function::Sinh => libm::sinh(x),
            Function::Cosh => libm::cosh(x),
            Function::Tanh => libm::tanh(x),
            Function::Asin => libm::asin(x),
            Function::Acos => libm::acos(x),
            Function::Atan => libm::atan(x),
        }
    }

    fn is_odd(self) -> bool {
        use Function::{Asin, Atan, Sin, Sinh, Tanh};
        matches!(self, Sin | Sinh | Tanh | Asin | Atan)
    }

    fn is_even(self) -> bool {
        matches!(self, Function::Cos | Function::Cosh)
    }
}

impl Graph {
    /// A function of an expression; known values, signs and inverses are taken out.
    pub(super) fn function(&mut self, function: Function, of: Node) -> Node {
        if let Some(value) = self.known_value(function, of) {
            return value;
        }
        match (function, self.expression(of)) {
            (Function::Exp, &Expression::Function(Function::Log, inner))
            | (Function::Log, &Expression::Function(Function::Exp, inner))
            | (Function::Sin, &Expression::Function(Function::Asin, inner))
            | (Function::Cos, &Expression::Function(Function::Acos, inner)) => return inner,
            _ => {}
        }
        if (function.is_odd() || function.is_even()) && self.begins_with_minus(of) {
            let opposite = self.negated(of);
            let value = self.function(function, opposite);
            return if function.is_odd() { self.negated(value) } else { value };
        }
        self.node(Expression::Function(function, of))
    }

    /// Values at zero and one, and of sine and cosine at multiples of pi/2 and pi/6 that are rational.
    fn known_value(&mut self, function: Function, of: Node) -> Option<Node> {
        use Function::{Acos, Asin, Atan, Cos, Cosh, Exp, Log, Sin, Sinh, Tanh};
        if self.is_zero(of) {
            return match function {
                Exp | Cos | Cosh => Some(self.integer(1)),
                Sin | Sinh | Tanh | Asin | Atan => Some(self.integer(0)),
                Acos => {
                    let pi = self.pi();
                    Some(self.scaled(&Rational::fraction(1, 2), pi))
                }
                Log => None,
            };
        }
        if self.rational(of).is_some_and(Rational::is_one) && matches!(function, Log | Acos) {
            return Some(self.integer(0));
        }
        if !matches!(function, Sin | Cos) {
            return None;
        }
        let (c, rest) = self.with_coefficient(of);
        if *self.expression(rest) != Expression::Pi {
            return None;
        }
        // the angle of the sine in units of pi/6
        let sixths = c.times(&Rational::integer(6)).to_integer()? + if function == Cos { 3 } else { 0 };
        let twice = match sixths.rem_euclid(12) {
            0 | 6 => 0,
            1 | 5 => 1,
            3 => 2,
            7 | 11 => -1,
            9 => -2,
            _ => return None,
        };
        Some(self.number(Rational::fraction(twice, 2)))
    }

    /// Whether the first term of an expression has a minus sign.
    fn begins_with_minus(&self, node: Node) -> bool {
        match self.expression(node) {
            Expression::Number(number) => number.is_negative(),
            Expression::Sum { terms, .. } => terms[0].1.is_negative(),
            _ => false,
        }
    }
}
