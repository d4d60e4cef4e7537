//! Fields as plain data, from expressions: `J(x) grad H` of a Hamiltonian, or equations as they stand.

use super::cancellation::{MOST_TERMS, Product, all_vanish, sum_of_products};
use super::constant::constant;
use super::expand::{Monomial, Polynomial, expanded, n_terms, polynomial};
use super::graph::{Expression, Graph, Node};
use super::lowering::{Lines, coefficient, lines};
use super::overflow::without_overflow;
use super::rational::Rational;
use super::refusal::Refusal;
use super::{derivative::derivative, top};
use std::collections::BTreeMap;

/// Expressions that a system may be made of.
const MOST_EXPRESSIONS: usize = 1_000_000;

/// Factors in the derivatives of all products.
const MOST_FACTORS: usize = 1_000_000;

/// A field as plain data.
#[derive(Clone, Debug, PartialEq)]
pub enum Lowered {
    /// The charged or twisted top.
    Top {
        /// The moments of inertia.
        inertia: [f64; 3],
        /// The centre of mass.
        a: [f64; 3],
        /// The centre of charge.
        b: [f64; 3],
        /// The strength of the cocycle.
        epsilon: f64,
    },
    /// A field of degree two, by its entries.
    Quadratic {
        /// Components of the state.
        n_components: usize,
        /// `(i, constant_i)`
        constant: Vec<(usize, f64)>,
        /// `(i, j, linear_ij)`
        linear: Vec<(usize, usize, f64)>,
        /// `(i, j, k, quadratic_ijk)`
        quadratic: Vec<(usize, usize, usize, f64)>,
    },
    /// Any other, as a tape.
    Tape(Lines),
}

/// The terms `(i, j, m, c)` of `{x_i, x_j}` in a graph; where `m` is `None`, `c` may depend on the state.
pub(super) type Terms = Vec<(usize, usize, Option<usize>, Node)>;

/// The field of a Hamiltonian in the coordinates `0..n`: quadratic where it is of degree two, else a tape.
pub(super) fn field_of_hamiltonian(
    graph: &mut Graph,
    n: usize,
    energy: Node,
    terms: &Terms,
) -> Result<Lowered, Refusal> {
    if depends_on_state(graph, n, terms) {
        let rates = rates(graph, n, energy, terms)?;
        let rates: Vec<Node> = rates.into_iter().map(|rate| without_poles(graph, n, rate)).collect();
        return field_of_equations(graph, n, &rates);
    }
    match equations_of_degree_two(graph, n, energy, terms) {
        Some(equations) => quadratic(n, &equations),
        None => tape_of_hamiltonian(graph, n, energy, terms).map(Lowered::Tape),
    }
}

/// A rate as it stands, or multiplied out where it is a polynomial only then, as `x y (1 - 1/x)` of Lotka and Volterra.
fn without_poles(graph: &mut Graph, n: usize, rate: Node) -> Node {
    if is_polynomial(graph, n, rate) || n_terms(graph, rate) > MOST_TERMS as u64 {
        return rate;
    }
    let multiplied = expanded(graph, rate);
    if is_polynomial(graph, n, multiplied) { multiplied } else { rate }
}

/// Whether an expression is made of coordinates by sums, products and powers alone, as it stands.
fn is_polynomial(graph: &Graph, n: usize, node: Node) -> bool {
    graph.reachable(&[node]).into_iter().all(|part| match graph.expression(part) {
        Expression::Symbol(index) => *index < n,
        Expression::Number(_) | Expression::Pi | Expression::Sum { .. } => true,
        Expression::Product(factors) => {
            factors.iter().all(|(_, exponent)| exponent.to_integer().is_some_and(|k| k > 0))
        }
        _ => false,
    })
}

/// Whether a coefficient of the bracket is a function of the state: the bracket is not linear then.
pub(super) fn depends_on_state(graph: &Graph, n: usize, terms: &Terms) -> bool {
    terms.iter().any(|term| graph.symbols(term.3).first().is_some_and(|&symbol| symbol < n))
}

/// The same as a tape, whatever its degree.
pub(super) fn tape_of_hamiltonian(graph: &mut Graph, n: usize, energy: Node, terms: &Terms) -> Result<Lines, Refusal> {
    let rates = rates(graph, n, energy, terms)?;
    tape(graph, n, &rates)
}

/// The field of equations `x_i' = ...`: quadratic where all are of degree two, else a tape.
pub(super) fn field_of_equations(graph: &mut Graph, n: usize, rates: &[Node]) -> Result<Lowered, Refusal> {
    let mut equations = top::Terms::new();
    for (row, &rate) in rates.iter().enumerate() {
        let Some(polynomial) = polynomial(graph, rate, n, 2) else { return tape(graph, n, rates).map(Lowered::Tape) };
        for (monomial, c) in polynomial {
            equations.insert((row, monomial), constant(graph, c).number());
        }
    }
    equations.retain(|_, number| !number.is_zero());
    quadratic(n, &equations)
}

/// Expressions as instructions.
pub(super) fn tape(graph: &mut Graph, n: usize, outputs: &[Node]) -> Result<Lines, Refusal> {
    let outputs = without_overflow(graph, outputs);
    lines(graph, n, &outputs)
}

/// The rates of change J grad H.
pub(super) fn rates(graph: &mut Graph, n: usize, energy: Node, terms: &Terms) -> Result<Vec<Node>, Refusal> {
    let n_factors: usize = graph.reachable(&[energy]).into_iter().map(|node| graph.factors(node).len().pow(2)).sum();
    if n_factors > MOST_FACTORS {
        return Err(Refusal::general(format!(
            "the derivatives of the Hamiltonian must have at most {MOST_FACTORS} factors; they may have {n_factors}. Write \
             shorter products."
        )));
    }
    let slopes: Vec<Node> = (0..n).map(|k| derivative(graph, energy, k)).collect();
    let mut products: Vec<Vec<Product>> = vec![vec![]; n];
    for &(i, j, m, c) in terms {
        let coordinate = match m {
            Some(m) => graph.symbol(m),
            None => graph.integer(1),
        };
        let outside = graph.times(c, coordinate);
        let opposite = graph.negated(outside);
        for (row, outside, slope) in [(i, outside, slopes[j]), (j, opposite, slopes[i])] {
            if !graph.is_zero(slope) {
                products[row].push((outside, slope));
            }
        }
    }
    if all_vanish(graph, n, &products) {
        return Ok(vec![graph.integer(0); n]);
    }
    let n_terms: usize = products.iter().flatten().map(|&(_, slope)| graph.terms(slope).1.len()).sum();
    let mut rates = vec![];
    for row in &products {
        rates.push(sum_of_products(graph, row, n_terms <= MOST_TERMS));
        if graph.len() > MOST_EXPRESSIONS {
            return Err(Refusal::general(format!(
                "a system must be made of at most {MOST_EXPRESSIONS} expressions; this one has more. Simplify the \
                 Hamiltonian."
            )));
        }
    }
    Ok(rates)
}

/// The equations of a quadratic Hamiltonian, or of a cubic one where J is constant: coefficients by component and monomial.
///
/// The bracket must be linear in the state.
pub(super) fn equations_of_degree_two(graph: &mut Graph, n: usize, energy: Node, terms: &Terms) -> Option<top::Terms> {
    let is_constant = terms.iter().all(|term| term.2.is_none());
    let mut energy = polynomial(graph, energy, n, if is_constant { 3 } else { 2 })?;
    // what is left of irrational numbers that cancel is judged beside these, and not beside other terms of an equation
    energy.retain(|_, c| !constant(graph, *c).number().is_zero());
    let slopes: Vec<Polynomial> = (0..n).map(|k| slope(graph, &energy, k)).collect();
    let mut sums: BTreeMap<(usize, Monomial), Vec<(Node, Rational)>> = BTreeMap::new();
    for &(i, j, m, c) in terms {
        let opposite = graph.negated(c);
        for (row, c, slope) in [(i, c, &slopes[j]), (j, opposite, &slopes[i])] {
            for (monomial, &inner) in slope {
                let mut product: Monomial = monomial.iter().copied().chain(m).collect();
                product.sort_unstable();
                let term = (graph.times(c, inner), Rational::one());
                sums.entry((row, product)).or_default().push(term);
            }
        }
    }
    let mut equations = top::Terms::new();
    for (key, terms) in sums {
        let sum = graph.sum(Rational::zero(), &terms);
        let number = constant(graph, sum).number();
        if !number.is_zero() {
            equations.insert(key, number);
        }
    }
    Some(equations)
}

/// The field of equations of degree two.
pub(super) fn quadratic(n_components: usize, equations: &top::Terms) -> Result<Lowered, Refusal> {
    let (mut constant, mut linear, mut quadratic) = (vec![], vec![], vec![]);
    for ((row, monomial), number) in equations {
        let number = coefficient(number)?;
        match monomial[..] {
            [] => constant.push((*row, number)),
            [j] => linear.push((*row, j, number)),
            [j, k] => quadratic.push((*row, j, k, number)),
            _ => unreachable!("the degree is two at most"),
        }
    }
    Ok(Lowered::Quadratic { n_components, constant, linear, quadratic })
}

/// The derivative of a polynomial with respect to a coordinate.
fn slope(graph: &mut Graph, energy: &Polynomial, coordinate: usize) -> Polynomial {
    let mut slope = Polynomial::new();
    for (monomial, &c) in energy {
        let count = monomial.iter().filter(|&&factor| factor == coordinate).count();
        let Some(place) = monomial.iter().position(|&factor| factor == coordinate) else { continue };
        let mut rest = monomial.clone();
        rest.remove(place);
        slope.insert(rest, graph.scaled(&Rational::integer(count as i64), c));
    }
    slope
}
