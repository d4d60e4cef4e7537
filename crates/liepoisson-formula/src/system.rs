//! A Hamiltonian system that is typed: a bracket, a formula, parameters; its field `x' = J(x) grad H`.

use super::bracket::{Bracket, Jacobi};
use super::cancellation::MOST_TERMS;
use super::constant::constant;
use super::derivative::derivative;
use super::expand::{expanded, n_terms};
use super::field::{
    Lowered, Terms, depends_on_state, equations_of_degree_two, field_of_hamiltonian, quadratic, rates, tape,
    tape_of_hamiltonian,
};
use super::grammar::{Part, Tree, parse};
use super::graph::{Graph, Node};
use super::lowering::Lines;
use super::rational::Rational;
use super::reader::Reading;
use super::refusal::Refusal;
use super::scope::{Given, Scope};
use super::text::Written;
use super::top;
use std::collections::BTreeMap;

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
            if insert_values {
                match system.bracket.jacobi {
                    Jacobi::Known => {}
                    Jacobi::OfConstants => system.check_jacobi(&mut graph, &terms)?,
                    Jacobi::OfFunctions => system.check_jacobi_of_functions(&mut graph, &terms)?,
                }
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
        let rates = rates(&mut graph, self.n(), energy, &terms)?;
        Ok(rates.into_iter().map(|rate| graph.shown(rate, &self.scope.symbols)).collect())
    }

    /// The Hamiltonian, the rates of change and the entries `{x_i, x_j}` of the Poisson tensor that are not zero, as they are
    /// written, with the parameters by name; `None` where that would be more than `most` parts.
    ///
    /// # Errors
    /// A system that is too large.
    pub fn written(&self, most: u64) -> Result<Option<SystemWritten>, Refusal> {
        let mut graph = self.graph();
        let energy = self.read(&mut graph, &self.text, &self.tree, false, false)?;
        let terms = self.terms(&mut graph, false)?;
        let rates = rates(&mut graph, self.n(), energy, &terms)?;
        let entries = entries_of_tensor(&mut graph, &terms);
        let all: Vec<Node> =
            [energy].into_iter().chain(rates.iter().copied()).chain(entries.values().copied()).collect();
        if graph.written_size(&all) > most {
            return Ok(None);
        }
        let written = |node: Node| graph.written(node, &self.scope.symbols);
        Ok(Some(SystemWritten {
            energy: written(energy),
            rates: rates.into_iter().map(written).collect(),
            tensor: entries.into_iter().map(|((i, j), entry)| (i, j, written(entry))).collect(),
        }))
    }

    /// The names of the parameters on which the Hamiltonian depends, and of its symbols without value.
    ///
    /// # Errors
    /// As [`System::new`].
    pub fn parameters(&self) -> Result<Vec<String>, Refusal> {
        let mut graph = self.graph();
        let energy = self.read(&mut graph, &self.text, &self.tree, false, false)?;
        let symbols = graph.symbols(energy).into_iter().filter(|&symbol| symbol >= self.n());
        Ok(symbols.map(|symbol| self.scope.symbols[symbol].clone()).collect())
    }

    /// The field with the values of the parameters.
    ///
    /// # Errors
    /// A parameter without value; a coefficient that no double holds; a system that is too large.
    pub fn field(&self) -> Result<Lowered, Refusal> {
        let (mut graph, energy, terms) = self.with_values()?;
        if depends_on_state(&graph, self.n(), &terms) {
            return field_of_hamiltonian(&mut graph, self.n(), energy, &terms);
        }
        let Some(equations) = equations_of_degree_two(&mut graph, self.n(), energy, &terms) else {
            return tape_of_hamiltonian(&mut graph, self.n(), energy, &terms).map(Lowered::Tape);
        };
        match self.top(&graph, &equations, &terms) {
            Some(top::Parameters { inertia, a, b, epsilon }) => Ok(Lowered::Top { inertia, a, b, epsilon }),
            None => quadratic(self.n(), &equations),
        }
    }

    /// The same, a top as any other field of degree two.
    ///
    /// # Errors
    /// As [`System::field`].
    pub fn general_field(&self) -> Result<Lowered, Refusal> {
        let (mut graph, energy, terms) = self.with_values()?;
        field_of_hamiltonian(&mut graph, self.n(), energy, &terms)
    }

    /// The Hamiltonian and the terms of the bracket with numbers.
    fn with_values(&self) -> Result<(Graph, Node, Terms), Refusal> {
        let mut graph = self.graph();
        let energy = self.read(&mut graph, &self.text, &self.tree, true, false)?;
        let terms = self.terms(&mut graph, true)?;
        self.check_numbers(&graph, [energy].into_iter().chain(terms.iter().map(|term| term.3)))?;
        Ok((graph, energy, terms))
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
        tape(&mut graph, self.n(), &outputs)
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
            let is_constant = graph.symbols(c).first().is_none_or(|&symbol| symbol >= self.n());
            // what is not checked for Jacobi's identity may be any function of the state
            if !is_constant && (entry.m.is_some() || self.bracket.jacobi == Jacobi::OfConstants) {
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

    /// Refuses entries of a tensor of which Jacobi's identity is not shown by multiplying out.
    fn check_jacobi_of_functions(&self, graph: &mut Graph, terms: &Terms) -> Result<(), Refusal> {
        let n = self.n();
        let entries = entries_of_tensor(graph, terms);
        let entry = |graph: &mut Graph, i: usize, j: usize| match entries.get(&(i.min(j), i.max(j))) {
            Some(&entry) if i < j => entry,
            Some(&entry) => graph.negated(entry),
            None => graph.integer(0),
        };
        for (i, j, k) in (0..n).flat_map(|i| (i + 1..n).flat_map(move |j| (j + 1..n).map(move |k| (i, j, k)))) {
            let mut terms = vec![];
            for (a, b, c) in [(i, j, k), (j, k, i), (k, i, j)] {
                let inner = entry(graph, b, c);
                for l in graph.symbols(inner).into_iter().filter(|&l| l < n) {
                    let (outside, slope) = (entry(graph, a, l), derivative(graph, inner, l));
                    terms.push((graph.times(outside, slope), Rational::one()));
                }
            }
            let sum = graph.sum(Rational::zero(), &terms);
            let is_short = n_terms(graph, sum) <= MOST_TERMS as u64;
            let sum = if is_short { expanded(graph, sum) } else { sum };
            if !graph.symbols(sum).is_empty() || !constant(graph, sum).number().is_zero() {
                let names = self.coordinates();
                return Err(Refusal::general(format!(
                    "a bracket must satisfy Jacobi's identity; multiplying out does not show it of {}, {} and {}. Check the \
                     entries of the tensor.",
                    names[i], names[j], names[k]
                )));
            }
        }
        Ok(())
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

/// A system as it is written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SystemWritten {
    /// The Hamiltonian.
    pub energy: Written,
    /// The rates of change, one for each coordinate.
    pub rates: Vec<Written>,
    /// The entries `{x_i, x_j}`, `i < j`, that are not zero.
    pub tensor: Vec<(usize, usize, Written)>,
}

/// The entries `{x_i, x_j}`, `i < j`, that are not zero.
fn entries_of_tensor(graph: &mut Graph, terms: &Terms) -> BTreeMap<(usize, usize), Node> {
    let mut sums: BTreeMap<(usize, usize), Vec<(Node, Rational)>> = BTreeMap::new();
    for &(i, j, m, c) in terms {
        let term = match m {
            Some(m) => {
                let coordinate = graph.symbol(m);
                graph.times(c, coordinate)
            }
            None => c,
        };
        sums.entry((i, j)).or_default().push((term, Rational::one()));
    }
    let mut entries = BTreeMap::new();
    for (pair, terms) in sums {
        let sum = graph.sum(Rational::zero(), &terms);
        if !graph.is_zero(sum) {
            entries.insert(pair, sum);
        }
    }
    entries
}

/// The names in a formula that are not those of functions, each once, in order.
///
/// # Errors
/// A formula that is not in the grammar, with its place.
pub fn names_of(formula: &str) -> Result<Vec<String>, Refusal> {
    let (mut names, mut found) = (vec![], vec![]);
    names_in(&parse(formula)?, &mut names);
    for name in names {
        if name != super::names::PI && !found.contains(&name) {
            found.push(name);
        }
    }
    Ok(found)
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
