//! Arithmetic on scalars of formulas, with bounds that keep every result small.
//!
//! An operation is refused when its result would be too long, too deep, not finite or not real; constants are judged by
//! their values as doubles, computed from the smallest parts up. The bounds are those of the package in Python, whose algebra
//! has to expand what it compares.

use super::elementary::Function;
use super::graph::{Expression, Graph, Node};
use super::measure::{Measure, NOT_REAL, value_of};
use super::rational::Rational;

pub(super) const MAX_EXPONENT: i64 = 64;
pub(super) const MAX_SIZE: u64 = 200_000;
const MAX_EXPONENT_BITS: u64 = 128;
const MAX_BITS: u64 = 4096;
const MAX_ROOT_BITS: u64 = 512;
const MAX_TERMS: u64 = 20_000;
const MAX_CONSTANT: f64 = 1_000.0;
const MAX_ARGUMENT: u64 = 300;
const MAX_FUNCTIONS: u32 = 3;
const MAX_DEPTH: u32 = 60;
const MAX_WORK: u64 = 100_000;

/// A result, or why an operation has none, or too long a one; who knows the place in the text adds it.
pub(super) type Refused<T> = Result<T, String>;

/// Sums, products, powers and functions of exact scalars; one object serves one formula and counts the work done.
pub(super) struct Arithmetic<'g> {
    pub(super) graph: &'g mut Graph,
    work: u64,
}

impl<'g> Arithmetic<'g> {
    pub(super) fn new(graph: &'g mut Graph) -> Arithmetic<'g> {
        Arithmetic { graph, work: 0 }
    }

    pub(super) fn zero(&mut self) -> Node {
        self.graph.integer(0)
    }

    /// The sum of signed terms.
    pub(super) fn sum(&mut self, terms: &[(Node, bool)]) -> Refused<Node> {
        self.spend(terms.len() as u64)?;
        let signed: Vec<_> = terms
            .iter()
            .map(|&(node, is_negative)| (node, Rational::integer(if is_negative { -1 } else { 1 })))
            .collect();
        let sum = self.graph.sum(Rational::zero(), &signed);
        self.checked(sum)
    }

    /// The product of the factors.
    pub(super) fn product(&mut self, factors: &[Node]) -> Refused<Node> {
        self.spend(factors.len() as u64)?;
        let mut number = Rational::one();
        for &factor in factors {
            if let Some(value) = self.graph.rational(factor) {
                number = number.times(value);
                check_bits(number.bits(), MAX_BITS)?;
            }
        }
        let powers: Vec<_> = factors.iter().map(|&factor| (factor, Rational::one())).collect();
        let product = self.graph.product(Rational::one(), &powers);
        self.checked(product)
    }

    /// The opposite.
    pub(super) fn negative(&mut self, node: Node) -> Refused<Node> {
        self.sum(&[(node, true)])
    }

    /// One over the divisor.
    pub(super) fn reciprocal(&mut self, divisor: Node) -> Refused<Node> {
        let minus_one = self.graph.integer(-1);
        self.power(divisor, minus_one)
    }

    /// The base to an exponent that is a rational number, or made of parameters.
    pub(super) fn power(&mut self, base: Node, exponent: Node) -> Refused<Node> {
        self.spend(1)?;
        self.check_exponent(exponent)?;
        let Some(number) = self.graph.rational(exponent).cloned() else {
            let power = self.graph.power_of_symbols(base, exponent);
            return self.checked(power);
        };
        if self.graph.is_zero(base) && number.is_negative() {
            return Err("a divisor must not vanish; this one is 0".to_owned());
        }
        let measure = self.graph.measure(base).clone();
        let is_number = self.graph.rational(base).is_some();
        if !is_number {
            measure.value?;
        }
        let times = number.size().negated().floor().map_or(u64::MAX, |floor| floor.unsigned_abs());
        check_bits(measure.bits.saturating_mul(times), MAX_BITS)?;
        if !number.is_integer() {
            if measure.functions > 0 || !(is_number || self.is_sum(base)) {
                check_argument(&measure)?;
            }
            self.spend(measure.bits)?;
            check_bits(measure.bits, MAX_ROOT_BITS)?;
        }
        let power = self.graph.power(base, number);
        self.checked(power)
    }

    fn is_sum(&self, node: Node) -> bool {
        match self.graph.expression(node) {
            Expression::Sum { constant, terms } => terms.len() > 1 || !constant.is_zero(),
            _ => false,
        }
    }

    /// An elementary function of the argument.
    pub(super) fn apply(&mut self, name: &str, argument: Node) -> Refused<Node> {
        if name == "sqrt" {
            let half = self.graph.number(Rational::fraction(1, 2));
            return self.power(argument, half);
        }
        self.spend(10)?;
        let measure = self.graph.measure(argument).clone();
        measure.value?;
        check_argument(&measure)?;
        if name == "exp" {
            self.check_logarithms(argument)?;
        }
        if let Some(constant) = measure.value? {
            if name != "log" && constant.abs() > MAX_CONSTANT {
                return Err(format!("a constant argument of {name} must be at most {MAX_CONSTANT} in size"));
            }
            if let Some(function) = Function::named(name) {
                value_of(function, constant)?;
            }
        }
        let result = match Function::named(name) {
            Some(function) => self.graph.function(function, argument),
            None => {
                let [sine, cosine] = [Function::Sin, Function::Cos].map(|f| self.graph.function(f, argument));
                if self.graph.is_zero(cosine) {
                    return Err(NOT_REAL.to_owned());
                }
                let inverse = Rational::integer(-1);
                self.graph.product(Rational::one(), &[(sine, Rational::one()), (cosine, inverse)])
            }
        };
        self.checked(result)
    }

    /// The angle of the point `(x, y)`.
    pub(super) fn angle(&mut self, y: Node, x: Node) -> Refused<Node> {
        self.spend(10)?;
        for part in [y, x] {
            check_argument(self.graph.measure(part))?;
        }
        if self.graph.is_zero(x) && self.graph.is_zero(y) {
            return Err("the point (0, 0) has no angle".to_owned());
        }
        let angle = self.graph.angle(y, x);
        self.checked(angle)
    }

    /// The result, unless it is too large.
    fn checked(&mut self, node: Node) -> Refused<Node> {
        if let Some(number) = self.graph.rational(node) {
            check_bits(number.bits(), MAX_BITS)?;
            return Ok(node);
        }
        let measure = self.graph.measure(node);
        measure.value?;
        check_bits(measure.bits, MAX_BITS)?;
        if measure.terms > MAX_TERMS || measure.size > MAX_SIZE {
            return Err(format!(
                "a formula must have at most {MAX_TERMS} terms and {MAX_SIZE} factors when it is expanded; this part may have \
                 more"
            ));
        }
        if measure.depth > MAX_DEPTH {
            return Err(format!("a formula must be nested at most {MAX_DEPTH} operations deep; this part is deeper"));
        }
        Ok(node)
    }

    fn check_exponent(&self, exponent: Node) -> Refused<()> {
        let is_constant = !matches!(self.graph.measure(exponent).value, Ok(None));
        if self.graph.rational(exponent).is_none() && is_constant {
            let shown = self.graph.shown(exponent, &[]);
            return Err(format!("an exponent must be a rational number or a symbol; got {shown}"));
        }
        let number = self.graph.rational(exponent).cloned();
        for number in number.map_or_else(|| self.graph.numbers_in(exponent), |number| vec![number]) {
            if number.size() > Rational::integer(MAX_EXPONENT) {
                return Err(format!(
                    "an exponent must be between -{MAX_EXPONENT} and {MAX_EXPONENT}; got one that is not"
                ));
            }
            check_bits(number.bits(), MAX_EXPONENT_BITS)?;
        }
        Ok(())
    }

    /// Refuses the exponential of a multiple of a logarithm, which is a power.
    fn check_logarithms(&self, argument: Node) -> Refused<()> {
        let is_logarithm = |node| matches!(self.graph.expression(node), Expression::Function(Function::Log, _));
        for (term, _) in self.graph.terms(argument).1 {
            let factors = self.graph.factors(term);
            let varies = |&(node, _): &(Node, Rational)| matches!(self.graph.measure(node).value, Ok(None));
            if factors.iter().any(|&(node, _)| is_logarithm(node))
                && !factors.iter().filter(|&&(node, _)| !is_logarithm(node)).any(varies)
            {
                return Err("exp of a multiple of log must be written as a power: x^3 for exp(3*log(x))".to_owned());
            }
        }
        Ok(())
    }

    fn spend(&mut self, work: u64) -> Refused<()> {
        self.work = self.work.saturating_add(work);
        if self.work > MAX_WORK {
            return Err(format!("a formula must not take more than {MAX_WORK} operations to read; this one does"));
        }
        Ok(())
    }
}

fn check_argument(measure: &Measure) -> Refused<()> {
    let most = MAX_ARGUMENT / 4u64.saturating_pow(measure.functions);
    if measure.size <= most && measure.functions < MAX_FUNCTIONS {
        return Ok(());
    }
    Err(format!(
        "the argument of a function must have at most {most} factors when expanded ({MAX_ARGUMENT} if there is no function in \
         it), with at most {} functions inside of each other; this one may have more",
        MAX_FUNCTIONS - 1
    ))
}

fn check_bits(bits: u64, limit: u64) -> Refused<()> {
    if bits <= limit {
        return Ok(());
    }
    Err(format!("a number must have at most about {} digits; this one would have more", (limit as f64 * 0.301) as u64))
}
