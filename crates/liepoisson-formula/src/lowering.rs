//! Expressions in coordinates as instructions: each once, constants rounded once, products shared.

use super::constant::{Constant, constant};
use super::graph::{Expression, Graph, Node};
use super::products::{Factor, Made, Shared, shared};
use super::rational::Rational;
use super::refusal::Refusal;
use std::collections::{BTreeMap, HashMap};

/// Powers up to this one are written as products, which others may share.
const MOST_FACTORS: i64 = 3;

/// An instruction that writes the next register: its name, the registers that it reads, its numbers, as tapes of the core have
/// them: of `linear` a coefficient for each register, then the constant.
pub type Instruction = (&'static str, Vec<usize>, Vec<f64>);

/// Instructions, and the register of each output.
#[derive(Clone, Debug, PartialEq)]
pub struct Lines {
    /// Components of the state, which are the first registers.
    pub n_components: usize,
    /// The instructions.
    pub instructions: Vec<Instruction>,
    /// The registers of the functions, or of the rates of change.
    pub outputs: Vec<usize>,
}

/// Writes expressions whose symbols are the coordinates `0..n`.
pub(super) fn lines(graph: &Graph, n_components: usize, outputs: &[Node]) -> Result<Lines, Refusal> {
    let mut writer = Writer::new(graph, n_components, outputs);
    let outputs = outputs.iter().map(|&output| writer.register(output)).collect::<Result<_, _>>()?;
    Ok(Lines { n_components, instructions: writer.instructions, outputs })
}

/// The double nearest to a coefficient, with all its digits.
pub(super) fn coefficient(number: &Rational) -> Result<f64, Refusal> {
    let value = number.to_f64();
    if !value.is_finite() {
        return Err(Refusal::general(
            "a coefficient must fit into a double (below 1.8e308); got a larger number. Rescale the system.",
        ));
    }
    if value.abs() < f64::MIN_POSITIVE && !number.is_zero() {
        return Err(Refusal::general(
            "a coefficient must fit into a double (above 2.2e-308); got a smaller number. Rescale the system, or set what is \
             nearly 0 to 0.",
        ));
    }
    Ok(value)
}

/// A base to an exponent that is not negative: what multiplies or divides in products.
type Power = (Node, Rational);

struct Writer<'g> {
    graph: &'g Graph,
    n_components: usize,
    instructions: Vec<Instruction>,
    /// The constant factor of a product, and its other factors.
    constants: HashMap<Node, Constant>,
    powers: Vec<Power>,
    products: Shared,
    /// The place of each product with a factor that varies among all such.
    place: HashMap<Node, usize>,
    of_node: HashMap<Node, usize>,
    of_factor: HashMap<usize, usize>,
    one: Option<usize>,
}

impl<'g> Writer<'g> {
    fn new(graph: &'g Graph, n_components: usize, outputs: &[Node]) -> Writer<'g> {
        let mut powers: Vec<Power> = vec![];
        let mut numbers: HashMap<Power, usize> = HashMap::new();
        let (mut constants, mut place, mut factors_of) = (HashMap::new(), HashMap::new(), vec![]);
        for node in graph.reachable(outputs) {
            let Expression::Product(parts) = graph.expression(node) else { continue };
            let mut own = Constant::exact(Rational::one());
            let mut factors: Vec<Factor> = vec![];
            for (base, exponent) in parts {
                if is_constant(graph, *base) {
                    own = own.times(&super::constant::power(&constant(graph, *base), exponent));
                    continue;
                }
                for power in written(*base, exponent) {
                    let next = powers.len();
                    let number = *numbers.entry(power.clone()).or_insert(next);
                    if number == next {
                        powers.push(power);
                    }
                    factors.push((number, exponent.is_negative()));
                }
            }
            constants.insert(node, own);
            if !factors.is_empty() {
                place.insert(node, factors_of.len());
                factors_of.push(factors);
            }
        }
        let products = shared(powers.len(), &factors_of);
        Writer {
            graph,
            n_components,
            instructions: vec![],
            constants,
            powers,
            products,
            place,
            of_node: HashMap::new(),
            of_factor: HashMap::new(),
            one: None,
        }
    }

    fn add(&mut self, instruction: Instruction) -> usize {
        self.instructions.push(instruction);
        self.n_components + self.instructions.len() - 1
    }

    /// The register of an expression.
    fn register(&mut self, node: Node) -> Result<usize, Refusal> {
        if let Some(&known) = self.of_node.get(&node) {
            return Ok(known);
        }
        let register = self.write(node)?;
        self.of_node.insert(node, register);
        Ok(register)
    }

    fn write(&mut self, node: Node) -> Result<usize, Refusal> {
        if is_constant(self.graph, node) {
            return self.linear(&[], constant(self.graph, node));
        }
        match self.graph.expression(node).clone() {
            Expression::Symbol(index) => Ok(index),
            Expression::Sum { constant, terms } => self.linear(&terms, Constant::exact(constant)),
            Expression::Product(_) => self.linear(&[(node, Rational::one())], Constant::exact(Rational::zero())),
            Expression::Function(function, of) => {
                let of = self.register(of)?;
                Ok(self.add((function.name(), vec![of], vec![])))
            }
            Expression::Number(_) | Expression::Pi | Expression::Power(..) | Expression::Angle(..) => {
                unreachable!("constants are written above, the others have been replaced")
            }
        }
    }

    /// A linear combination; a plain register stays what it is.
    fn linear(&mut self, terms: &[(Node, Rational)], mut total: Constant) -> Result<usize, Refusal> {
        let mut sums: Vec<(usize, Constant)> = vec![];
        let mut places: BTreeMap<usize, usize> = BTreeMap::new();
        for (node, c) in terms {
            let mut c = Constant::exact(c.clone());
            if is_constant(self.graph, *node) {
                total = total.plus(&c.times(&constant(self.graph, *node)));
                continue;
            }
            let register = match self.place.get(node) {
                Some(&place) => {
                    c = c.times(&self.constants[node]);
                    self.factor(self.products.products[place])?
                }
                None => self.register(*node)?,
            };
            match places.get(&register) {
                Some(&k) => sums[k].1 = sums[k].1.plus(&c),
                None => {
                    places.insert(register, sums.len());
                    sums.push((register, c));
                }
            }
        }
        let mut kept = vec![];
        for (register, c) in sums {
            let number = coefficient(&c.number())?;
            if number != 0.0 {
                kept.push((register, number));
            }
        }
        let constant = coefficient(&total.number())?;
        match kept[..] {
            [(register, 1.0)] if constant == 0.0 => Ok(register),
            _ => {
                let (registers, mut numbers): (Vec<usize>, Vec<f64>) = kept.into_iter().unzip();
                numbers.push(constant);
                Ok(self.add(("linear", registers, numbers)))
            }
        }
    }

    /// The register of a factor of products, or of what is made of several.
    fn factor(&mut self, factor: usize) -> Result<usize, Refusal> {
        if let Some(&known) = self.of_factor.get(&factor) {
            return Ok(known);
        }
        let register = match factor.checked_sub(self.powers.len()) {
            None => self.power(factor)?,
            Some(k) => match self.products.made[k] {
                Made::Product(a, b) => {
                    let (a, b) = (self.factor(a)?, self.factor(b)?);
                    self.add(("product", vec![a, b], vec![]))
                }
                Made::Quotient(a, b) => {
                    let (a, b) = (self.factor(a)?, self.factor(b)?);
                    self.add(("quotient", vec![a, b], vec![]))
                }
                Made::Reciprocal(of) => {
                    let of = self.factor(of)?;
                    let one = self.one()?;
                    self.add(("quotient", vec![one, of], vec![]))
                }
            },
        };
        self.of_factor.insert(factor, register);
        Ok(register)
    }

    fn one(&mut self) -> Result<usize, Refusal> {
        let one = match self.one {
            Some(one) => one,
            None => self.linear(&[], Constant::exact(Rational::one()))?,
        };
        self.one = Some(one);
        Ok(one)
    }

    fn power(&mut self, number: usize) -> Result<usize, Refusal> {
        let (base, exponent) = self.powers[number].clone();
        let of = self.register(base)?;
        if exponent.is_one() {
            return Ok(of);
        }
        if exponent == Rational::fraction(1, 2) {
            return Ok(self.add(("sqrt", vec![of], vec![])));
        }
        let exponent = coefficient(&exponent)?;
        Ok(self.add(("power", vec![of], vec![exponent])))
    }
}

fn is_constant(graph: &Graph, node: Node) -> bool {
    match graph.measure(node).value {
        Ok(value) => value.is_some(),
        // a number in it that no double holds
        Err(_) => graph.symbols(node).is_empty(),
    }
}

/// The factors that a power is written as: small whole powers one by one, and of half-integer ones the root apart, since a root
/// has a value where the base is beyond the range, and what is divided by it is zero.
fn written(base: Node, exponent: &Rational) -> Vec<Power> {
    let size = exponent.size();
    let whole = if size.times(&Rational::integer(2)).is_integer() { size.floor() } else { None };
    let Some(whole) = whole else { return vec![(base, size)] };
    let mut powers = match whole {
        0..=MOST_FACTORS => vec![(base, Rational::one()); whole as usize],
        _ => vec![(base, Rational::integer(whole))],
    };
    if !size.is_integer() {
        powers.push((base, Rational::fraction(1, 2)));
    }
    powers
}
