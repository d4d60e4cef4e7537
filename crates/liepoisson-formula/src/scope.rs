//! The names that a formula may use: coordinates, parameters with their values, symbols without.

use super::grammar::{Tree, parse};
use super::graph::Graph;
use super::names::{MAX_NAME, is_identifier, is_reserved, quoted};
use super::reader::number;
use super::refusal::{Refusal, did_you_mean};
use std::collections::HashMap;

/// The value of a parameter: texts of numbers, such as `1/3` or `sqrt(2)/2`.
#[derive(Clone, Debug, PartialEq)]
pub enum Given {
    /// A number.
    Scalar(String),
    /// A vector.
    Vector(Vec<String>),
    /// A matrix by its rows.
    Matrix(Vec<Vec<String>>),
}

impl Given {
    fn shape(&self) -> Vec<usize> {
        match self {
            Given::Scalar(_) => vec![],
            Given::Vector(entries) => vec![entries.len()],
            Given::Matrix(rows) => vec![rows.len(), rows.first().map_or(0, Vec::len)],
        }
    }

    fn entries(&self) -> Vec<&str> {
        match self {
            Given::Scalar(text) => vec![text],
            Given::Vector(entries) => entries.iter().map(String::as_str).collect(),
            Given::Matrix(rows) => rows.iter().flatten().map(String::as_str).collect(),
        }
    }
}

/// The coordinates of a phase space, as formulas call them.
#[derive(Clone, Debug, PartialEq)]
pub enum Coordinates {
    /// Vectors with the names of their components: `l` with `1`, `2`, `3` has `l1`, `l2`, `l3`.
    Vectors(Vec<(String, Vec<String>)>),
    /// Scalars, each with a name of its own.
    Scalars(Vec<String>),
}

impl Coordinates {
    /// The names of all coordinates, in order.
    pub fn names(&self) -> Vec<String> {
        match self {
            Coordinates::Scalars(names) => names.clone(),
            Coordinates::Vectors(fields) => {
                let of_field = |(name, components): &(String, Vec<String>)| {
                    components.iter().map(|component| format!("{name}{component}")).collect::<Vec<_>>()
                };
                fields.iter().flat_map(of_field).collect()
            }
        }
    }

    fn fields(&self) -> &[(String, Vec<String>)] {
        match self {
            Coordinates::Vectors(fields) => fields,
            Coordinates::Scalars(_) => &[],
        }
    }
}

/// What a name stands for.
pub(super) enum Meaning {
    /// A vector of coordinates, by the number of the first and their count.
    Field(usize, usize),
    /// A parameter or symbol: its number in the scope.
    Parameter(usize),
    /// A coordinate.
    Coordinate(usize),
    /// An entry of a parameter, by the number of the parameter and of the entry.
    Entry(usize, usize),
}

/// A parameter or symbol.
#[derive(Clone, Debug)]
pub(super) struct Parameter {
    pub(super) name: String,
    pub(super) shape: Vec<usize>,
    /// The number of the symbol of its first entry.
    pub(super) first: usize,
    /// The texts of its entries, read; `None` of a symbol.
    pub(super) values: Option<Vec<Tree>>,
}

/// The names that a formula may use.
#[derive(Clone, Debug)]
pub struct Scope {
    coordinates: Coordinates,
    /// Names of all symbols: coordinates first, then the entries of parameters.
    pub(super) symbols: Vec<String>,
    pub(super) n_coordinates: usize,
    pub(super) parameters: Vec<Parameter>,
    components: HashMap<String, (String, usize)>,
}

impl Scope {
    /// A scope with values of parameters, and with declarations of symbols without value: `epsilon`, `a[3]`, `A[3,3]`.
    ///
    /// # Errors
    /// A name that nobody may choose or that stands for two things; a value that is no number; a declaration that is none.
    pub fn new(coordinates: Coordinates, given: &[(String, Given)], declared: &[String]) -> Result<Scope, Refusal> {
        let symbols = coordinates.names();
        let n_coordinates = symbols.len();
        let mut scope = Scope { coordinates, symbols, n_coordinates, parameters: vec![], components: HashMap::new() };
        for (name, value) in given {
            let values = read_values(name, value)?;
            for tree in &values {
                number(&mut Graph::new(0), name, tree)?;
            }
            scope.add(name, value.shape(), Some(values))?;
        }
        for text in declared {
            let (name, shape) = read_declaration(text)?;
            scope.add(&name, shape, None)?;
        }
        scope.name_components()?;
        Ok(scope)
    }

    /// A scope for numbers alone.
    pub(super) fn without_names() -> Scope {
        let coordinates = Coordinates::Scalars(vec![]);
        Scope { coordinates, symbols: vec![], n_coordinates: 0, parameters: vec![], components: HashMap::new() }
    }

    fn add(&mut self, name: &str, shape: Vec<usize>, values: Option<Vec<Tree>>) -> Result<(), Refusal> {
        if self.parameters.iter().any(|parameter| parameter.name == name) {
            return Err(Refusal::general(format!(
                "a name must stand for one thing; {} is given twice. Remove one.",
                quoted(name)
            )));
        }
        check_name(name)?;
        if self.coordinates.fields().iter().any(|(field, _)| field == name) {
            return Err(Refusal::general(format!(
                "a name must stand for one thing; {name} is a field and a parameter. Rename one of them."
            )));
        }
        let first = self.symbols.len();
        self.symbols.extend(entry_names(name, &shape));
        self.parameters.push(Parameter { name: name.to_owned(), shape, first, values });
        Ok(())
    }

    fn name_components(&mut self) -> Result<(), Refusal> {
        let mut listed: Vec<(String, String, usize)> = vec![];
        let mut number = 0;
        for (field, components) in self.coordinates.fields() {
            check_name(field)?;
            for component in components {
                listed.push((format!("{field}{component}"), field.clone(), number));
                number += 1;
            }
        }
        if let Coordinates::Scalars(names) = &self.coordinates {
            for (k, name) in names.iter().enumerate() {
                check_name(name)?;
                listed.push((name.clone(), name.clone(), k));
            }
        }
        for parameter in &self.parameters {
            let shorts = entry_names(&parameter.name, &parameter.shape);
            let vector = shorts.into_iter().enumerate().filter(|_| !parameter.shape.is_empty());
            listed.extend(vector.map(|(k, short)| (short, parameter.name.clone(), k)));
        }
        for (short, owner, number) in listed {
            let other = match self.components.get(&short) {
                Some((other, _)) => Some(other.clone()),
                None => self.parameters.iter().find(|parameter| parameter.name == short).map(|p| p.name.clone()),
            };
            if let Some(other) = other {
                return Err(Refusal::general(format!(
                    "a name must stand for one thing; {short} is a component of {owner} and belongs to {other}, too. Rename \
                     one of them."
                )));
            }
            check_not_reserved(&short, "a name of a component")?;
            self.components.insert(short, (owner, number));
        }
        Ok(())
    }

    /// What a name stands for, itself or as a component.
    pub(super) fn meaning(&self, name: &str) -> Option<Meaning> {
        let mut first = 0;
        for (field, components) in self.coordinates.fields() {
            if field == name {
                return Some(Meaning::Field(first, components.len()));
            }
            first += components.len();
        }
        if let Some(k) = self.parameters.iter().position(|parameter| parameter.name == name) {
            return Some(Meaning::Parameter(k));
        }
        let (owner, number) = self.components.get(name)?;
        match self.parameters.iter().position(|parameter| parameter.name == *owner) {
            Some(k) => Some(Meaning::Entry(k, *number)),
            None => Some(Meaning::Coordinate(*number)),
        }
    }

    /// The names of fields, scalar coordinates, parameters and symbols.
    fn known(&self) -> Vec<&str> {
        let fields = self.coordinates.fields().iter().map(|(name, _)| name.as_str());
        let scalars = match &self.coordinates {
            Coordinates::Scalars(names) => &names[..],
            Coordinates::Vectors(_) => &[],
        };
        let (given, symbols): (Vec<&Parameter>, Vec<&Parameter>) =
            self.parameters.iter().partition(|parameter| parameter.values.is_some());
        fields
            .chain(given.into_iter().map(|parameter| parameter.name.as_str()))
            .chain(scalars.iter().map(String::as_str))
            .chain(symbols.into_iter().map(|parameter| parameter.name.as_str()))
            .collect()
    }

    /// The end of a message about an unknown name: the nearest known ones, and all of them.
    pub(super) fn suggestion(&self, name: &str) -> String {
        let mut known = self.known();
        let hint = match (self.beyond(name), self.counted(name)) {
            (Some(beyond), _) => beyond,
            (None, Some(counted)) => format!("Did you mean {counted}? "),
            _ => {
                // in their order: which of two equally near ones is meant must not change from run to run
                let components = self.components_in_order();
                did_you_mean(name, known.iter().copied().chain(components.iter().map(String::as_str)))
            }
        };
        known.push(super::names::PI);
        let verb = if known.len() > 1 { "are" } else { "is" };
        let more = if known.len() > 40 { ", ..." } else { "" };
        let listed = known.into_iter().take(40).collect::<Vec<_>>().join(", ");
        format!("{hint}Known {verb} {listed}{more}{}", self.components_in_words())
    }

    fn components_in_order(&self) -> Vec<String> {
        let mut names = match &self.coordinates {
            Coordinates::Vectors(_) => self.coordinates.names(),
            Coordinates::Scalars(_) => vec![],
        };
        for parameter in self.parameters.iter().filter(|parameter| !parameter.shape.is_empty()) {
            names.extend(entry_names(&parameter.name, &parameter.shape));
        }
        names
    }

    /// The component that a field with a number stands for where components have names: `lr` for `l1` on se(2).
    fn counted(&self, name: &str) -> Option<String> {
        let (field, number) = name.split_at(name.trim_end_matches(|c: char| c.is_ascii_digit()).len());
        let (_, components) = self.coordinates.fields().iter().find(|(own, _)| own == field)?;
        let index: usize = number.get(..number.len().min(3))?.parse().ok()?;
        components.get(index.checked_sub(1)?).map(|component| format!("{field}{component}"))
    }

    /// How many components a vector has of which a later one is meant: `l4` for `l1`, `l2`, `l3`.
    fn beyond(&self, name: &str) -> Option<String> {
        let (vector, number) = name.split_at(name.trim_end_matches(|c: char| c.is_ascii_digit()).len());
        let field = self.coordinates.fields().iter().find(|(own, _)| own == vector);
        let length = match field {
            Some((_, components)) => components.len(),
            None => match self.parameters.iter().find(|parameter| parameter.name == vector)?.shape[..] {
                [length] => length,
                _ => return None,
            },
        };
        let index: usize = number.get(..number.len().min(3))?.parse().ok()?;
        (!(1..=length).contains(&index)).then(|| format!("{vector} has {length} components. "))
    }

    /// How the components of the fields are called: "; components lr1, lr2, lr3, ..., lt3".
    fn components_in_words(&self) -> String {
        if matches!(self.coordinates, Coordinates::Scalars(_)) {
            return String::new();
        }
        let mut names = self.coordinates.names();
        if names.len() > 6 {
            names.splice(3..names.len() - 3, ["...".to_owned()]);
        }
        if names.is_empty() { String::new() } else { format!("; components {}", names.join(", ")) }
    }
}

/// The short forms of the entries: `I1`; `A12`, or `A1_12` if an index may have two digits; of a scalar its name.
fn entry_names(name: &str, shape: &[usize]) -> Vec<String> {
    match *shape {
        [n] => (1..=n).map(|i| format!("{name}{i}")).collect(),
        [m, n] => {
            let between = if m.max(n) < 10 { "" } else { "_" };
            (1..=m).flat_map(|i| (1..=n).map(move |j| (i, j))).map(|(i, j)| format!("{name}{i}{between}{j}")).collect()
        }
        _ => vec![name.to_owned()],
    }
}

fn read_values(name: &str, value: &Given) -> Result<Vec<Tree>, Refusal> {
    let shape = value.shape();
    if let Given::Matrix(rows) = value
        && (shape.contains(&0) || rows.iter().any(|row| row.len() != shape[1]))
    {
        return Err(Refusal::general(format!("{name} must be a matrix with rows of one length; fill it up.")));
    }
    if shape.contains(&0) {
        return Err(Refusal::general(format!(
            "{name} must have at least one component; got an empty sequence. Give its components."
        )));
    }
    let read = |text: &str| {
        parse(text)
            .map_err(|refusal| Refusal::general(format!("{name} must be a number; got {}: {refusal}", quoted(text))))
    };
    value.entries().into_iter().map(read).collect()
}

/// The name and the shape of a symbol that is declared as `epsilon`, `a[3]` or `A[3,3]`.
fn read_declaration(text: &str) -> Result<(String, Vec<usize>), Refusal> {
    let refused = || {
        let shown = quoted(&text.chars().take(58).collect::<String>());
        Refusal::general(format!(
            "a symbol must be declared by its name, a vector with its length; got {shown}. Write for example \"epsilon\" or \
             \"a[3]\"."
        ))
    };
    let trimmed = text.trim();
    let Some((name, shape)) = trimmed.split_once('[') else {
        return if is_identifier(trimmed) { Ok((trimmed.to_owned(), vec![])) } else { Err(refused()) };
    };
    let read = |length: &str| {
        let digits = length.trim_matches(' ');
        let is_count = (1..=3).contains(&digits.len()) && digits.bytes().all(|byte| byte.is_ascii_digit());
        digits.parse().ok().filter(|&count: &usize| is_count && count > 0 && !digits.starts_with('0'))
    };
    let lengths: Option<Vec<usize>> = shape.strip_suffix(']').ok_or_else(refused)?.split(',').map(read).collect();
    match lengths {
        Some(lengths) if lengths.len() <= 2 && is_identifier(name) => Ok((name.to_owned(), lengths)),
        _ => Err(refused()),
    }
}

/// Refuses a name that nobody may choose.
fn check_name(name: &str) -> Result<(), Refusal> {
    if !is_identifier(name) {
        let shown = quoted(&name.chars().take(58).collect::<String>());
        return Err(Refusal::general(format!(
            "a name must consist of letters, digits and _ (of ASCII), and not begin with a digit; got {shown}. Rename it."
        )));
    }
    if name.len() > MAX_NAME {
        return Err(Refusal::general(format!(
            "a name must have at most {MAX_NAME} characters; got {}: {}... Shorten it.",
            name.len(),
            &name[..20]
        )));
    }
    check_not_reserved(name, "a name")
}

fn check_not_reserved(name: &str, what: &str) -> Result<(), Refusal> {
    if is_reserved(name) {
        return Err(Refusal::general(format!(
            "{what} must not be that of a function or constant of formulas; got {name}. Rename it."
        )));
    }
    Ok(())
}
