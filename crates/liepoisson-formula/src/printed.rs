//! Expressions that a program has derived and printed, as fields and functions.
//!
//! They are texts in the grammar, in coordinates `x1`, `x2`, ... and in parts `s1`, `s2`, ... that several of them share, each of
//! which may contain those before it. The limits of what is typed do not hold for them.

use super::bracket::{Bracket, Entry};
use super::elementary::Function;
use super::field::{Lowered, Terms, field_of_equations, field_of_hamiltonian, tape, tape_of_hamiltonian};
use super::grammar::{Part, Tree, parse_printed};
use super::graph::{Graph, Node};
use super::lowering::Lines;
use super::rational::Rational;
use super::refusal::Refusal;
use super::scope::Coordinates;

/// Expressions in coordinates, of which some parts are known.
///
/// ```
/// use liepoisson_formula::{Lowered, Printed};
/// let shared = Printed::new(2, &["sin(x1)".to_owned()])?;
/// let Lowered::Tape(lines) = shared.equations(&["s1*x2".to_owned(), "s1".to_owned()], false)? else { panic!() };
/// assert_eq!(lines.instructions.len(), 2);
/// # Ok::<(), liepoisson_formula::Refusal>(())
/// ```
#[derive(Clone, Debug)]
pub struct Printed {
    n: usize,
    graph: Graph,
    parts: Vec<Node>,
}

impl Printed {
    /// Expressions in so many coordinates, with parts that they share.
    ///
    /// # Errors
    /// A text that is not in the grammar, or contains what is no coordinate and no part before it.
    pub fn new(n_components: usize, parts: &[String]) -> Result<Printed, Refusal> {
        let mut printed = Printed { n: n_components, graph: Graph::new(n_components), parts: vec![] };
        for part in parts {
            let node = printed.read(part)?;
            printed.parts.push(node);
        }
        Ok(printed)
    }

    /// The field of a Hamiltonian; as a tape whatever its degree, if that is wanted.
    ///
    /// # Errors
    /// As [`Printed::new`]; terms of no bracket; a coefficient that no double holds; a system that is too large.
    pub fn field(mut self, terms: Vec<Entry>, hamiltonian: &str, as_tape: bool) -> Result<Lowered, Refusal> {
        let names = (1..=self.n).map(|k| format!("x{k}")).collect();
        let mut entries = Terms::new();
        for Entry { i, j, m, c } in Bracket::known(Coordinates::Scalars(names), terms)?.entries {
            let c = self.read(&c)?;
            if !self.graph.is_zero(c) {
                entries.push((i, j, m, c));
            }
        }
        let energy = self.read(hamiltonian)?;
        if as_tape {
            return tape_of_hamiltonian(&mut self.graph, self.n, energy, &entries).map(Lowered::Tape);
        }
        field_of_hamiltonian(&mut self.graph, self.n, energy, &entries)
    }

    /// The field of equations, one for each coordinate; as a tape whatever their degree, if that is wanted.
    ///
    /// # Errors
    /// As [`Printed::field`].
    pub fn equations(mut self, rates: &[String], as_tape: bool) -> Result<Lowered, Refusal> {
        let rates = self.read_all(rates)?;
        if as_tape {
            return tape(&mut self.graph, self.n, &rates).map(Lowered::Tape);
        }
        field_of_equations(&mut self.graph, self.n, &rates)
    }

    /// Functions of the coordinates.
    ///
    /// # Errors
    /// As [`Printed::field`].
    pub fn functions(mut self, functions: &[String]) -> Result<Lines, Refusal> {
        let outputs = self.read_all(functions)?;
        tape(&mut self.graph, self.n, &outputs)
    }

    fn read_all(&mut self, texts: &[String]) -> Result<Vec<Node>, Refusal> {
        texts.iter().map(|text| self.read(text)).collect()
    }

    fn read(&mut self, text: &str) -> Result<Node, Refusal> {
        let tree = parse_printed(text)?;
        self.node(text, &tree)
    }

    /// The expression that a tree stands for, unless it is a constant that is not real, or irrational and beyond the doubles.
    fn node(&mut self, text: &str, tree: &Tree) -> Result<Node, Refusal> {
        let node = self.unchecked(text, tree)?;
        let is_number = self.graph.rational(node).is_some();
        match self.graph.measure(node).value {
            Err(why) if !is_number && self.graph.symbols(node).is_empty() => Err(Refusal::general(format!(
                "a coefficient must be a finite real number; {why}: {}. Check the parameters.",
                self.graph.shown(node, &[])
            ))),
            _ => Ok(node),
        }
    }

    fn unchecked(&mut self, text: &str, tree: &Tree) -> Result<Node, Refusal> {
        let refused = |message: &str| Refusal::general(format!("{message}; got {}.", beginning(text)));
        let sign = |is_inverse: bool| if is_inverse { Rational::integer(-1) } else { Rational::one() };
        match &tree.part {
            Part::Number(number) => Ok(self.graph.number(number.clone())),
            Part::Name(name) if name == "pi" => Ok(self.graph.pi()),
            Part::Name(name) => self.named(name).ok_or_else(|| refused("an expression must have known names")),
            Part::Sum(parts) => {
                let mut terms = vec![];
                for (part, is_negative, _) in parts {
                    terms.push((self.node(text, part)?, sign(*is_negative)));
                }
                Ok(self.graph.sum(Rational::zero(), &terms))
            }
            Part::Product(parts) => {
                let mut factors = vec![];
                for (part, divides, _) in parts {
                    let factor = self.node(text, part)?;
                    if *divides && self.graph.is_zero(factor) {
                        return Err(refused("a divisor must not vanish; this one is 0"));
                    }
                    factors.push((factor, sign(*divides)));
                }
                Ok(self.graph.product(Rational::one(), &factors))
            }
            Part::Negative(of) => {
                let of = self.node(text, of)?;
                Ok(self.graph.negated(of))
            }
            Part::Power(parts) => {
                let (base, exponent) = (self.node(text, &parts[0])?, self.node(text, &parts[1])?);
                let Some(exponent) = self.graph.rational(exponent).cloned() else {
                    return Err(refused("an exponent must be a rational number"));
                };
                if self.graph.is_zero(base) && exponent.is_negative() {
                    return Err(refused("a divisor must not vanish; this one is 0"));
                }
                Ok(self.graph.power(base, exponent))
            }
            Part::Call(name, arguments) => {
                let arguments = arguments.iter().map(|of| self.node(text, of)).collect::<Result<Vec<_>, _>>()?;
                self.call(name, &arguments).ok_or_else(|| refused("an expression must have known functions"))
            }
            Part::Component(..) => Err(refused("an expression must be made of scalars")),
        }
    }

    fn named(&mut self, name: &str) -> Option<Node> {
        let number = |rest: &str| rest.parse::<usize>().ok()?.checked_sub(1);
        match (name.strip_prefix('x').and_then(number), name.strip_prefix('s').and_then(number)) {
            (Some(k), _) if k < self.n => Some(self.graph.symbol(k)),
            (_, Some(k)) => self.parts.get(k).copied(),
            _ => None,
        }
    }

    fn call(&mut self, name: &str, arguments: &[Node]) -> Option<Node> {
        match (name, arguments) {
            ("atan2", &[y, x]) => Some(self.graph.angle(y, x)),
            ("sqrt", &[of]) => Some(self.graph.power(of, Rational::fraction(1, 2))),
            ("tan", &[of]) => {
                let [sine, cosine] = [Function::Sin, Function::Cos].map(|f| self.graph.function(f, of));
                let powers = [(sine, Rational::one()), (cosine, Rational::integer(-1))];
                (!self.graph.is_zero(cosine)).then(|| self.graph.product(Rational::one(), &powers))
            }
            (_, &[of]) => Some(self.graph.function(Function::named(name)?, of)),
            _ => None,
        }
    }
}

fn beginning(text: &str) -> String {
    text.chars().take(60).collect()
}

#[cfg(test)]
mod tests {
    use super::Printed;
    use crate::{Entry, Lowered};

    fn texts(texts: &[&str]) -> Vec<String> {
        texts.iter().map(|&text| text.to_owned()).collect()
    }

    /// The names of the instructions that two functions of two coordinates take.
    fn names(parts: &[&str], functions: &[&str]) -> Vec<&'static str> {
        let lines = Printed::new(2, &texts(parts)).unwrap().functions(&texts(functions)).unwrap();
        lines.instructions.iter().map(|instruction| instruction.0).collect()
    }

    #[test]
    fn a_part_is_computed_once() {
        assert_eq!(
            names(&["x1*x2", "sin(s1)^2"], &["s2 + x1", "s2*x2"]),
            ["product", "sin", "product", "linear", "product"]
        );
        assert_eq!(names(&[], &["(x1*x2)^(1/2)", "exp(x1)*exp(-x1)"]), ["product", "sqrt", "linear"]);
    }

    #[test]
    fn numbers_may_be_of_any_length() {
        let long = format!("{}/{}*x1", "3".repeat(900), "6".repeat(900));
        let lines = Printed::new(1, &[]).unwrap().functions(&[long]).unwrap();
        assert_eq!(lines.instructions, [("linear", vec![0], vec![0.5, 0.0])]);
    }

    #[test]
    fn equations_of_degree_two_are_quadratic() {
        let printed = || Printed::new(2, &[]).unwrap();
        let rates = texts(&["x1*(x1 + x2) - x1^2", "2^(1/2) - x2"]);
        let Lowered::Quadratic { constant, linear, quadratic, .. } = printed().equations(&rates, false).unwrap() else {
            panic!("it is of degree two")
        };
        assert_eq!((constant, linear, quadratic), (vec![(1, 2f64.sqrt())], vec![(1, 1, -1.0)], vec![(0, 0, 1, 1.0)]));
        assert!(matches!(printed().equations(&rates, true).unwrap(), Lowered::Tape(_)));
        assert!(matches!(printed().equations(&texts(&["x1^3", "x2"]), false).unwrap(), Lowered::Tape(_)));
    }

    #[test]
    fn the_field_of_a_casimir_vanishes() {
        let entry = |i, j, m, c: &str| Entry { i, j, m: Some(m), c: c.to_owned() };
        let terms = vec![entry(0, 1, 2, "-1"), entry(0, 2, 1, "1"), entry(1, 2, 0, "-1")];
        // of the last three, terms do not cancel as they are written
        for energy in ["exp(s1)", "1/(1 + s1 + s1^2 + s1^3)", "(s1 + s1^2)^5", "log(2 + s1 + s1^4)/(3 + s1^2)"] {
            let printed = Printed::new(3, &texts(&["x1^2 + x2^2 + x3^2"])).unwrap();
            let Lowered::Tape(lines) = printed.field(terms.clone(), energy, false).unwrap() else {
                panic!("it is not quadratic")
            };
            assert_eq!(lines.instructions, [("linear", vec![], vec![0.0])], "{energy}");
        }
    }

    #[test]
    fn what_has_no_meaning_is_refused() {
        for (text, words) in [
            ("x3", "known names"),
            ("s1", "known names"),
            ("x1^x2", "rational number"),
            ("1/(x1 - x1)", "must not vanish"),
            ("(x1 - x1)^(-2)", "must not vanish"),
            ("(-2)^(1/2)*x1", "finite real number"),
            ("exp(1000)*x1", "finite real number"),
            ("gamma(x1)", "known functions"),
            ("x1[1]", "scalars"),
        ] {
            let refusal = Printed::new(2, &[]).unwrap().functions(&texts(&[text])).unwrap_err();
            assert!(refusal.message.contains(words), "{text}: {}", refusal.message);
            assert_eq!(refusal.position, None);
        }
        let refusal = Printed::new(1, &[]).unwrap().functions(&texts(&["10^400*x1"])).unwrap_err();
        assert!(refusal.message.contains("must fit into a double"), "{}", refusal.message);
    }
}
