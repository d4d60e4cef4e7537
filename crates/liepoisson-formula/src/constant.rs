//! Constants to 50 digits: what becomes a double is rounded once.
//!
//! Rational numbers stay exact. Irrational ones are rounded; a sum in which nothing but what was rounded off is left, measured by
//! its own terms, is zero.

use super::elementary::Function;
use super::graph::{Expression, Graph, Node};
use super::natural::Natural;
use super::rational::Rational;

/// Bits that are kept of an irrational number: 60 digits.
const BITS: i64 = 200;

/// A sum below `2^-SETTLED` of its rounded terms is zero.
const SETTLED: u64 = 160;

/// A constant, and the sizes of the rounded terms in it.
#[derive(Clone, Debug)]
pub(super) struct Constant {
    value: Rational,
    /// Sizes of its rounded terms together, 0 if it is exact.
    inexact: Rational,
}

impl Constant {
    pub(super) fn exact(value: Rational) -> Constant {
        Constant { value, inexact: Rational::zero() }
    }

    fn rounded(value: Rational) -> Constant {
        let value = shortened(&value);
        Constant { inexact: value.size(), value }
    }

    /// The number; 0 where nothing but what was rounded off is left.
    pub(super) fn number(&self) -> Rational {
        let bound = self.inexact.times(&power_of_two(-(SETTLED as i64)));
        if self.value.size() > bound { self.value.clone() } else { Rational::zero() }
    }

    pub(super) fn plus(&self, other: &Constant) -> Constant {
        Constant { value: self.value.plus(&other.value), inexact: self.inexact.plus(&other.inexact) }
    }

    pub(super) fn times(&self, other: &Constant) -> Constant {
        let value = self.value.times(&other.value);
        if self.inexact.is_zero() && other.inexact.is_zero() {
            return Constant::exact(value);
        }
        Constant { inexact: value.size(), value: shortened(&value) }
    }
}

/// The value of an expression without symbols.
pub(super) fn constant(graph: &Graph, node: Node) -> Constant {
    if let Some(number) = graph.rational(node) {
        return Constant::exact(number.clone());
    }
    if let Some(known) = graph.constants.borrow().get(&node) {
        return known.clone();
    }
    let value = computed(graph, node);
    graph.constants.borrow_mut().insert(node, value.clone());
    value
}

fn computed(graph: &Graph, node: Node) -> Constant {
    match graph.expression(node) {
        Expression::Number(number) => Constant::exact(number.clone()),
        Expression::Sum { constant: number, terms } => {
            let scaled = |(term, c): &(Node, Rational)| constant(graph, *term).times(&Constant::exact(c.clone()));
            terms.iter().map(scaled).fold(Constant::exact(number.clone()), |sum, term| sum.plus(&term))
        }
        Expression::Product(factors) => factors
            .iter()
            .map(|(base, exponent)| power(&constant(graph, *base), exponent))
            .fold(Constant::exact(Rational::one()), |product, factor| product.times(&factor)),
        Expression::Pi => Constant::rounded(circle_number()),
        Expression::Function(function, of) => Constant::rounded(value_of(*function, &constant(graph, *of).number())),
        Expression::Angle(y, x) => {
            let [y, x] = [y, x].map(|&part| constant(graph, part).number());
            Constant::rounded(angle(&y, &x))
        }
        Expression::Power(..) | Expression::Symbol(_) => Constant::exact(Rational::zero()),
    }
}

fn power_of_two(exponent: i64) -> Rational {
    let power = Rational::scaled(false, Natural::from_u64(1), exponent.unsigned_abs());
    if exponent < 0 { power } else { power.reciprocal() }
}

/// The number with `BITS` bits of its mantissa.
fn shortened(value: &Rational) -> Rational {
    let bits = BITS - (value.numerator().bits() as i64 - value.denominator().bits() as i64);
    if value.is_zero() {
        return value.clone();
    }
    if bits >= 0 {
        return Rational::scaled(value.is_negative(), value.fixed(bits as u64), bits as u64);
    }
    let scaled = value.times(&power_of_two(bits)).fixed(0);
    Rational::scaled(value.is_negative(), scaled, 0).times(&power_of_two(-bits))
}

pub(super) fn power(base: &Constant, exponent: &Rational) -> Constant {
    let number = base.number();
    match exponent.to_integer() {
        _ if number.is_zero() => Constant::exact(number),
        Some(whole) if base.inexact.is_zero() => Constant::exact(number.power(whole)),
        Some(whole) => Constant::rounded(number.power(whole)),
        None if exponent.denominator().to_u64() == Some(2) => {
            let whole = exponent.floor().unwrap_or(0);
            Constant::rounded(number.power(whole).times(&square_root(&number)))
        }
        None => Constant::rounded(exponential(&logarithm(&number).times(exponent))),
    }
}

fn value_of(function: Function, x: &Rational) -> Rational {
    let half = Rational::fraction(1, 2);
    let pair = || {
        let up = exponential(x);
        let down = up.reciprocal();
        (up, down)
    };
    match function {
        Function::Exp => exponential(x),
        Function::Log => logarithm(x),
        Function::Sin => sine_and_cosine(x).0,
        Function::Cos => sine_and_cosine(x).1,
        Function::Sinh => {
            let (up, down) = pair();
            up.plus(&down.negated()).times(&half)
        }
        Function::Cosh => {
            let (up, down) = pair();
            up.plus(&down).times(&half)
        }
        Function::Tanh => {
            let (up, down) = pair();
            up.plus(&down.negated()).times(&up.plus(&down).reciprocal())
        }
        Function::Atan => angle(x, &Rational::one()),
        Function::Asin | Function::Acos => {
            let rest = Rational::one().plus(&x.times(x).negated());
            let root = square_root(&rest);
            if function == Function::Asin { angle(x, &root) } else { angle(&root, x) }
        }
    }
}

/// The root of a number that is not negative.
fn square_root(x: &Rational) -> Rational {
    let exponent = x.numerator().bits() as i64 - x.denominator().bits() as i64;
    let half = BITS - exponent.div_euclid(2);
    let scaled = x.times(&power_of_two(2 * half)).fixed(0);
    Rational::scaled(false, scaled.square_root(), 0).times(&power_of_two(-half))
}

/// `e^x` by its series at `x / 2^k`, squared k times.
fn exponential(x: &Rational) -> Rational {
    let halvings = 8 + x.size().floor().map_or(64, |floor| 64 - floor.leading_zeros() as i64);
    let small = shortened(&x.times(&power_of_two(-halvings)));
    let (mut sum, mut term) = (Rational::one(), Rational::one());
    for k in 1..=40 {
        term = shortened(&term.times(&small).times(&Rational::fraction(1, k)));
        sum = sum.plus(&term);
    }
    (0..halvings).fold(shortened(&sum), |value, _| shortened(&value.times(&value)))
}

/// The logarithm of a positive number, by Halley's method from that of a double.
fn logarithm(x: &Rational) -> Rational {
    // a mantissa of the size of one, and a power of two
    let exponent = x.numerator().bits() as i64 - x.denominator().bits() as i64;
    let mantissa = x.times(&power_of_two(-exponent));
    let log = |x: &Rational| {
        let mut y = double(libm::log(x.to_f64()));
        for _ in 0..3 {
            let value = exponential(&y);
            let (up, down) = (x.plus(&value.negated()), x.plus(&value));
            y = shortened(&y.plus(&up.times(&down.reciprocal()).times(&Rational::integer(2))));
        }
        y
    };
    let log_two = if exponent == 0 { Rational::zero() } else { log(&Rational::integer(2)) };
    log(&mantissa).plus(&log_two.times(&Rational::integer(exponent)))
}

/// A double as it is.
pub(super) fn double(value: f64) -> Rational {
    let mut exponent = 0;
    let mut mantissa = value;
    while mantissa.fract() != 0.0 {
        mantissa *= 2.0;
        exponent += 1;
    }
    Rational::integer(mantissa as i64).times(&power_of_two(-exponent))
}

/// Four times the angle of one, by Machin's formula.
fn circle_number() -> Rational {
    let angle = |n: i64| {
        let square = Rational::integer(n * n).reciprocal();
        let mut power = Rational::integer(n).reciprocal();
        let mut sum = power.clone();
        for k in 1..60 {
            power = shortened(&power.times(&square).negated());
            sum = sum.plus(&power.times(&Rational::integer(2 * k + 1).reciprocal()));
        }
        shortened(&sum)
    };
    let quarter = angle(5).times(&Rational::integer(4)).plus(&angle(239).negated());
    quarter.times(&Rational::integer(4))
}

/// Sine and cosine, by their series at the angle that is left of multiples of pi/2.
fn sine_and_cosine(x: &Rational) -> (Rational, Rational) {
    let quarter = circle_number().times(&Rational::fraction(1, 2));
    let turns = x.times(&quarter.reciprocal()).plus(&Rational::fraction(1, 2)).floor().unwrap_or(0);
    let rest = shortened(&x.plus(&quarter.times(&Rational::integer(turns)).negated()));
    let (mut sums, mut term) = ([rest.clone(), Rational::one()], Rational::one());
    for k in 1..=50u32 {
        term = shortened(&term.times(&rest).times(&Rational::fraction(1, k)));
        let signed = if k / 2 % 2 == 1 { term.negated() } else { term.clone() };
        if k > 1 {
            let sum = &mut sums[(k as usize + 1) % 2];
            *sum = sum.plus(&signed);
        }
    }
    let [sine, cosine] = sums;
    match turns.rem_euclid(4) {
        0 => (sine, cosine),
        1 => (cosine, sine.negated()),
        2 => (sine.negated(), cosine.negated()),
        _ => (cosine.negated(), sine),
    }
}

/// The angle of the point `(x, y)`, by Newton's method from that of doubles.
fn angle(y: &Rational, x: &Rational) -> Rational {
    let scale = x.size().plus(&y.size());
    if scale.is_zero() {
        return scale;
    }
    let [y, x] = [y, x].map(|part| shortened(&part.times(&scale.reciprocal())));
    let mut angle = double(libm::atan2(y.to_f64(), x.to_f64()));
    for _ in 0..3 {
        let (sine, cosine) = sine_and_cosine(&angle);
        let up = y.times(&cosine).plus(&x.times(&sine).negated());
        let down = x.times(&cosine).plus(&y.times(&sine));
        angle = shortened(&angle.plus(&up.times(&down.reciprocal())));
    }
    angle
}
