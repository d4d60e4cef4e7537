//! How large an expression is, and the values of constants as doubles.

use super::elementary::Function;
use super::graph::{Expression, Graph, Node};
use super::rational::Rational;

/// A constant that is not finite and real.
pub(super) const NOT_REAL: &str = "a formula must be finite and real; this part is not";

/// A constant beyond the range of doubles.
pub(super) const TOO_LARGE: &str = "a constant must fit into a double (below 1.8e308); this one does not";

/// A count that is over every limit.
const ENDLESS: u64 = 1_000_000_000_000;

/// How large an expression is.
#[derive(Clone, Debug)]
pub(super) struct Measure {
    /// At most so many terms when it is expanded.
    pub(super) terms: u64,
    /// At most so many factors in all of them.
    pub(super) size: u64,
    /// About so many bits in its longest number.
    pub(super) bits: u64,
    /// So many levels of operations.
    pub(super) depth: u32,
    /// So many functions, and roots of such, inside of each other.
    pub(super) functions: u32,
    /// The value of a constant, `None` if a symbol occurs; or why it has none.
    pub(super) value: Result<Option<f64>, &'static str>,
}

/// The measure of an expression, from those of its parts.
pub(super) fn measure(graph: &Graph, expression: &Expression) -> Measure {
    match expression {
        Expression::Number(number) => of_number(number),
        Expression::Pi => Measure { value: Ok(Some(std::f64::consts::PI)), ..of_symbol() },
        Expression::Symbol(_) => of_symbol(),
        Expression::Sum { constant, terms } => of_sum(graph, constant, terms),
        Expression::Product(factors) => of_product(graph, factors),
        Expression::Power(base, exponent) => {
            let (base, exponent) = (graph.measure(*base), graph.measure(*exponent));
            Measure {
                size: base.size + 1,
                depth: 1 + base.depth.max(exponent.depth),
                functions: base.functions.max(exponent.functions) + u32::from(base.functions > 0),
                value: Ok(None),
                ..base.clone()
            }
        }
        Expression::Function(function, of) => {
            let of = graph.measure(*of);
            let value = of.value.and_then(|x| x.map(|x| value_of(*function, x)).transpose());
            Measure { terms: 1, size: of.size + 1, depth: of.depth + 1, functions: of.functions + 1, value, ..*of }
        }
        Expression::Angle(y, x) => {
            let [y, x] = [y, x].map(|&part| graph.measure(part));
            let value = y.value.and_then(|y| Ok(y.zip(x.value?).map(|(y, x)| libm::atan2(y, x))));
            Measure {
                terms: 1,
                size: 1 + y.size + x.size,
                bits: y.bits.max(x.bits),
                depth: 1 + y.depth.max(x.depth),
                functions: 1 + y.functions.max(x.functions),
                value,
            }
        }
    }
}

/// The value of a function at a number, if it has one.
pub(super) fn value_of(function: Function, x: f64) -> Result<f64, &'static str> {
    let value = function.at(x);
    match value {
        _ if value.is_nan() || function == Function::Log && x <= 0.0 => Err(NOT_REAL),
        _ if value.is_infinite() => Err(TOO_LARGE),
        _ => Ok(value),
    }
}

fn of_symbol() -> Measure {
    Measure { terms: 1, size: 1, bits: 1, depth: 1, functions: 0, value: Ok(None) }
}

fn of_number(number: &Rational) -> Measure {
    Measure { bits: number.bits(), value: finite(number.to_f64()).map(Some), ..of_symbol() }
}

fn finite(value: f64) -> Result<f64, &'static str> {
    if value.is_finite() { Ok(value) } else { Err(TOO_LARGE) }
}

fn of_sum(graph: &Graph, constant: &Rational, terms: &[(Node, Rational)]) -> Measure {
    let is_sum = terms.len() > 1 || !constant.is_zero();
    let mut total = Measure { terms: 0, size: 0, bits: 0, depth: 0, functions: 0, value: Ok(Some(0.0)) };
    if !constant.is_zero() {
        total = of_number(constant);
    }
    for (node, c) in terms {
        let term = graph.measure(*node);
        total.terms = total.terms.saturating_add(term.terms);
        total.size = total.size.saturating_add(term.size);
        let (mut bits, mut depth) = (term.bits, term.depth);
        if !c.is_one() {
            total.size = total.size.saturating_add(term.terms);
            bits += c.bits();
            depth += u32::from(!matches!(graph.expression(*node), Expression::Product(_)));
        }
        total.bits = total.bits.max(bits);
        total.depth = total.depth.max(depth);
        total.functions = total.functions.max(term.functions);
        let value = finite(c.to_f64()).and_then(|c| Ok(term.value?.map(|value| c * value)));
        total.value = added(total.value, value);
    }
    total.depth += u32::from(is_sum);
    total
}

fn added(
    total: Result<Option<f64>, &'static str>,
    value: Result<Option<f64>, &'static str>,
) -> Result<Option<f64>, &'static str> {
    let sum = total?.zip(value?).map(|(total, value)| total + value);
    sum.map(finite).transpose()
}

fn of_product(graph: &Graph, factors: &[(Node, Rational)]) -> Measure {
    let parts: Vec<Measure> = factors.iter().map(|(base, exponent)| of_power(graph.measure(*base), exponent)).collect();
    if let [part] = &parts[..] {
        return part.clone();
    }
    let terms = parts.iter().fold(1u64, |product, part| product.saturating_mul(part.terms)).min(ENDLESS);
    let size = parts.iter().map(|part| part.size.saturating_mul(terms / part.terms.max(1)));
    let value = parts.iter().try_fold(Some(1.0), |product, part| {
        product.zip(part.value?).map(|(product, value)| finite(product * value)).transpose()
    });
    Measure {
        terms,
        size: size.fold(0u64, u64::saturating_add).min(ENDLESS),
        bits: parts.iter().map(|part| part.bits).fold(0, u64::saturating_add),
        depth: 1 + parts.iter().map(|part| part.depth).max().unwrap_or(0),
        functions: parts.iter().map(|part| part.functions).max().unwrap_or(0),
        value,
    }
}

fn of_power(base: &Measure, exponent: &Rational) -> Measure {
    if exponent.is_one() {
        return base.clone();
    }
    let value = base.value.and_then(|value| {
        value
            .map(|base| {
                let value = libm::pow(base, exponent.to_f64());
                match value {
                    _ if value.is_nan() || base == 0.0 && value.is_infinite() => Err(NOT_REAL),
                    _ => finite(value),
                }
            })
            .transpose()
    });
    let functions = base.functions + u32::from(base.functions > 0 && !exponent.is_integer());
    let depth = base.depth + 1;
    let times = exponent.size().negated().floor().map_or(u64::MAX, |floor| floor.unsigned_abs());
    if times > super::limits::MAX_SIZE || (base.terms - 1).min(times) > super::limits::MAX_EXPONENT as u64 {
        return Measure { terms: ENDLESS, size: ENDLESS, bits: base.bits, depth, functions, value };
    }
    let terms = monomials(base.terms, times);
    let size = terms.saturating_mul(times).saturating_mul(base.size.div_ceil(base.terms));
    Measure { terms, size, bits: base.bits.saturating_mul(times), depth, functions, value }
}

/// Monomials of a degree in so many unknowns, as the multinomial theorem counts them.
pub(super) fn monomials(unknowns: u64, degree: u64) -> u64 {
    if unknowns > ENDLESS || degree > ENDLESS {
        return ENDLESS;
    }
    let (n, k) = (unknowns + degree - 1, degree.min(unknowns - 1));
    let mut count: u128 = 1;
    for i in 1..=k {
        count = count * u128::from(n - k + i) / u128::from(i);
        if count > u128::from(ENDLESS) {
            return ENDLESS;
        }
    }
    count as u64
}
