//! A Hamiltonian system that is typed: a bracket, a formula, parameters; its field `x' = J(x) grad H`.

use super::bracket::Bracket;
use super::cancellation::{MOST_TERMS, Product, sum_of_products};
use super::constant::constant;
use super::derivative::derivative;
use super::expand::{Monomial, Polynomial, expanded, polynomial};
use super::grammar::{Part, Tree, parse};
use super::graph::{Graph, Node};
use super::lowering::{Lines, coefficient, lines};
use super::overflow::without_overflow;
use super::rational::Rational;
use super::reader::Reading;
use super::refusal::Refusal;
use super::scope::{Given, Scope};
use super::top;
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

/// A Hamiltonian system that is typed.
///
/// ```
/// use liepoisson_formula::{Bracket, Given, Lowered, System};
/// let bracket = Bracket::canonical_of(&["theta".to_owned()], None)?;
/// let gravity = ("g".to_owned(), Given::Scalar("9.81".to_owned()));
/// let pendulum = System::new(bracket, "p_theta^2/2 - g*cos(theta)", &[gravity], &[])?;
/// assert_eq!(pendulum.equations()?, ["p_theta", "-g*sin(theta)"]);
/// assert!(matches!(pendulum.field()?, Lowered::Tape(_)));
/// let refusal = System::new(Bracket::canonical(1)?, "p1^2/2 - cos(q2)", &[], &[]).unwrap_err();
/// assert_eq!(refusal.position, Some(13));
/// # Ok::<(), liepoisson_formula::Refusal>(())
/// ```
#[derive(Clone, Debug)]
pub struct System {
    bracket: Bracket,
    scope: Scope,
    text: String,
    tree: Tree,
    /// The coefficients of the bracket.
    coefficients: Vec<Tree>,
}

/// The terms `(i, j, m, c)` of `{x_i, x_j}` in a graph.
type Terms = Vec<(usize, usize, Option<usize>, Node)>;

/// The terms `(m, c)` of one pair of coordinates.
type Row = Vec<(Option<usize>, Node)>;

impl System {
    /// A system; parameters without value are declared, as `epsilon` or `a[3]`.
    ///
    /// # Errors
    /// A formula that is not in the grammar or has no meaning, with its place; names or values that nobody may choose; a bracket
    /// without Jacobi's identity.
    pub fn new(
        bracket: Bracket,
        hamiltonian: &str,
        parameters: &[(String, Given)],
        declared: &[String],
    ) -> Result<System, Refusal> {
        let coefficients = bracket.entries.iter().map(|entry| parse(&entry.c)).collect::<Result<Vec<_>, _>>()?;
        let scope = scope_with(&bracket, &coefficients, parameters, declared)?;
        let tree = parse(hamiltonian)?;
        let system = System { bracket, scope, text: hamiltonian.to_owned(), tree, coefficients };
        for insert_values in [true, false] {
            let mut graph = system.graph();
            system.read(&mut graph, &system.text, &system.tree, insert_values, false)?;
            let terms = system.terms(&mut graph, insert_values)?;
            if insert_values && !system.bracket.is_known {
                system.check_jacobi(&mut graph, &terms)?;
            }
        }
        Ok(system)
    }

    /// The names of the coordinates.
    pub fn coordinates(&self) -> Vec<String> {
        self.bracket.coordinates.names()
    }

    /// The equations `x_i' = ...`, with the parameters by name, as texts in the grammar.
    ///
    /// # Errors
    /// A system that is too large.
    pub fn equations(&self) -> Result<Vec<String>, Refusal> {
        let mut graph = self.graph();
        let energy = self.read(&mut graph, &self.text, &self.tree, false, false)?;
        let terms = self.terms(&mut graph, false)?;
        let rates = self.rates(&mut graph, energy, &terms)?;
        Ok(rates.into_iter().map(|rate| graph.shown(rate, &self.scope.symbols)).collect())
    }

    /// The field with the values of the parameters.
    ///
    /// # Errors
    /// A parameter without value; a coefficient that no double holds; a system that is too large.
    pub fn field(&self) -> Result<Lowered, Refusal> {
        let mut graph = self.graph();
        let energy = self.read(&mut graph, &self.text, &self.tree, true, false)?;
        let terms = self.terms(&mut graph, true)?;
        self.check_numbers(&graph, [energy].into_iter().chain(terms.iter().map(|term| term.3)))?;
        if let Some(field) = self.quadratic(&mut graph, energy, &terms)? {
            return Ok(field);
        }
        let rates = self.rates(&mut graph, energy, &terms)?;
        let rates = without_overflow(&mut graph, &rates);
        lines(&graph, self.n(), &rates).map(Lowered::Tape)
    }

    /// Functions of the coordinates, such as surfaces of section; angles of pairs may occur in them.
    ///
    /// # Errors
    /// As [`System::new`] and [`System::field`].
    pub fn functions(&self, texts: &[&str]) -> Result<Lines, Refusal> {
        let mut graph = self.graph();
        let mut outputs = vec![];
        for text in texts {
            let tree = parse(text)?;
            // as symbols, too, since what is refused must not depend on values alone
            self.read(&mut graph, text, &tree, false, true)?;
            outputs.push(self.read(&mut graph, text, &tree, true, true)?);
        }
        self.check_numbers(&graph, outputs.iter().copied())?;
        let outputs = without_overflow(&mut graph, &outputs);
        lines(&graph, self.n(), &outputs)
    }

    fn n(&self) -> usize {
        self.scope.n_coordinates
    }

    fn graph(&self) -> Graph {
        Graph::new(self.n())
    }

    fn read(
        &self,
        graph: &mut Graph,
        text: &str,
        tree: &Tree,
        insert_values: bool,
        angles: bool,
    ) -> Result<Node, Refusal> {
        Reading { text, scope: &self.scope, insert_values, angles }.scalar(graph, tree)
    }

    fn terms(&self, graph: &mut Graph, insert_values: bool) -> Result<Terms, Refusal> {
        let mut terms = vec![];
        for (entry, tree) in self.bracket.entries.iter().zip(&self.coefficients) {
            let c = self.read(graph, &entry.c, tree, insert_values, false)?;
            if graph.symbols(c).first().is_some_and(|&symbol| symbol < self.n()) {
                return Err(Refusal::new("a structure constant must not depend on the state", &entry.c, 0));
            }
            if !graph.is_zero(c) {
                terms.push((entry.i, entry.j, entry.m, c));
            }
        }
        Ok(terms)
    }

    /// Refuses symbols without numbers.
    fn check_numbers(&self, graph: &Graph, nodes: impl Iterator<Item = Node>) -> Result<(), Refusal> {
        let symbols = nodes.flat_map(|node| graph.symbols(node)).filter(|&symbol| symbol >= self.n());
        let mut names: Vec<&str> = symbols.map(|symbol| self.scope.symbols[symbol].as_str()).collect();
        names.sort_unstable();
        names.dedup();
        if names.is_empty() {
            return Ok(());
        }
        Err(Refusal::general(format!(
            "every parameter must be a number for numerical work; got none for {}. Give values.",
            names.join(", ")
        )))
    }

    /// Refuses structure constants without Jacobi's identity, and constant parts that are no cocycles.
    fn check_jacobi(&self, graph: &mut Graph, terms: &Terms) -> Result<(), Refusal> {
        let n = self.n();
        let mut brackets: BTreeMap<(usize, usize), Row> = BTreeMap::new();
        for &(i, j, m, c) in terms {
            let opposite = graph.negated(c);
            brackets.entry((i, j)).or_default().push((m, c));
            brackets.entry((j, i)).or_default().push((m, opposite));
        }
        for (i, j, k) in (0..n).flat_map(|i| (i + 1..n).flat_map(move |j| (j + 1..n).map(move |k| (i, j, k)))) {
            let mut sums: BTreeMap<Option<usize>, Vec<(Node, Rational)>> = BTreeMap::new();
            for (a, b, c) in [(i, j, k), (j, k, i), (k, i, j)] {
                for &(m, first) in brackets.get(&(a, b)).into_iter().flatten() {
                    let inner = m.and_then(|m| brackets.get(&(m, c)));
                    for &(to, second) in inner.into_iter().flatten() {
                        sums.entry(to).or_default().push((graph.times(first, second), Rational::one()));
                    }
                }
            }
            for terms in sums.into_values() {
                let sum = graph.sum(Rational::zero(), &terms);
                let sum = expanded(graph, sum);
                if graph.is_zero(sum) {
                    continue;
                }
                if !constant(graph, sum).number().is_zero() || !graph.symbols(sum).is_empty() {
                    let names = self.coordinates();
                    return Err(Refusal::general(format!(
                        "a bracket must satisfy Jacobi's identity; the one of {}, {} and {} fails it. Check the structure \
                         constants.",
                        names[i], names[j], names[k]
                    )));
                }
            }
        }
        Ok(())
    }

    /// The rates of change J grad H.
    fn rates(&self, graph: &mut Graph, energy: Node, terms: &Terms) -> Result<Vec<Node>, Refusal> {
        let n_factors: usize =
            graph.reachable(&[energy]).into_iter().map(|node| graph.factors(node).len().pow(2)).sum();
        if n_factors > MOST_FACTORS {
            return Err(Refusal::general(format!(
                "the derivatives of the Hamiltonian must have at most {MOST_FACTORS} factors; they may have {n_factors}. Write \
                 shorter products."
            )));
        }
        let slopes: Vec<Node> = (0..self.n()).map(|k| derivative(graph, energy, k)).collect();
        let mut products: Vec<Vec<Product>> = vec![vec![]; self.n()];
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

    /// The field, if it is one of degree two: that of a quadratic Hamiltonian, or of a cubic one where J is constant.
    fn quadratic(&self, graph: &mut Graph, energy: Node, terms: &Terms) -> Result<Option<Lowered>, Refusal> {
        let is_constant = terms.iter().all(|term| term.2.is_none());
        let Some(energy) = polynomial(graph, energy, self.n(), if is_constant { 3 } else { 2 }) else {
            return Ok(None);
        };
        let slopes: Vec<Polynomial> = (0..self.n()).map(|k| slope(graph, &energy, k)).collect();
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
        let mut exact = top::Terms::new();
        for (key, terms) in sums {
            let sum = graph.sum(Rational::zero(), &terms);
            let number = constant(graph, sum).number();
            if !number.is_zero() {
                exact.insert(key, number);
            }
        }
        if let Some(top::Parameters { inertia, a, b, epsilon }) = self.top(graph, &exact, terms) {
            return Ok(Some(Lowered::Top { inertia, a, b, epsilon }));
        }
        let (mut of_degree_0, mut linear, mut quadratic) = (vec![], vec![], vec![]);
        for ((row, monomial), number) in exact {
            let number = coefficient(&number)?;
            match monomial[..] {
                [] => of_degree_0.push((row, number)),
                [j] => linear.push((row, j, number)),
                [j, k] => quadratic.push((row, j, k, number)),
                _ => return Ok(None),
            }
        }
        Ok(Some(Lowered::Quadratic { n_components: self.n(), constant: of_degree_0, linear, quadratic }))
    }

    /// The top that has these equations.
    fn top(&self, graph: &Graph, equations: &top::Terms, terms: &Terms) -> Option<top::Parameters> {
        if self.n() != 9 {
            return None;
        }
        // {alpha1, alpha2} = -epsilon beta3
        let of_alpha = terms.iter().find(|term| (term.0, term.1, term.2) == (3, 4, Some(8)));
        let strength = of_alpha.map(|term| constant(graph, term.3).number().negated());
        top::recognised(equations, &strength.unwrap_or_else(Rational::zero))
    }
}

/// The scope of a system, in which names that only the bracket has are declared.
fn scope_with(
    bracket: &Bracket,
    coefficients: &[Tree],
    parameters: &[(String, Given)],
    declared: &[String],
) -> Result<Scope, Refusal> {
    let scope = Scope::new(bracket.coordinates.clone(), parameters, declared)?;
    let mut missing = vec![];
    for tree in coefficients {
        names_in(tree, &mut missing);
    }
    missing.retain(|name| scope.meaning(name).is_none() && name != super::names::PI);
    missing.sort_unstable();
    missing.dedup();
    if missing.is_empty() {
        return Ok(scope);
    }
    Scope::new(bracket.coordinates.clone(), parameters, &[declared, &missing].concat())
}

/// The names in a formula, not those of functions.
fn names_in(tree: &Tree, names: &mut Vec<String>) {
    match &tree.part {
        Part::Number(_) => {}
        Part::Name(name) => names.push(name.clone()),
        Part::Sum(parts) | Part::Product(parts) => parts.iter().for_each(|(part, ..)| names_in(part, names)),
        Part::Negative(of) | Part::Component(of, _) => names_in(of, names),
        Part::Power(parts) => parts.iter().for_each(|part| names_in(part, names)),
        Part::Call(_, arguments) => arguments.iter().for_each(|argument| names_in(argument, names)),
    }
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
