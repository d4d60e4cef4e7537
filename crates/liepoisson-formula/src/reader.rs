//! The meaning of formulas: names, vectors, matrices and functions, read into the graph from the leaves up.

use super::grammar::{Part, Tree};
use super::graph::{Graph, Node};
use super::limits::{Arithmetic, Refused};
use super::names::{
    ANGLE, ELEMENTARY, OF_MATRICES, PI, constant_instead, function_instead, functions, is_not_smooth, quoted,
};
use super::refusal::{Refusal, did_you_mean};
use super::scope::{Meaning, Scope};
use super::tensors::{Value, kinds};

/// How a formula is read.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reading<'s> {
    pub(super) text: &'s str,
    pub(super) scope: &'s Scope,
    /// Whether parameters are read as their values, and not as symbols.
    pub(super) insert_values: bool,
    /// Whether `atan2(y, x)` may occur.
    pub(super) angles: bool,
}

impl Reading<'_> {
    /// The scalar that a tree stands for.
    pub(super) fn scalar(&self, graph: &mut Graph, tree: &Tree) -> Result<Node, Refusal> {
        let mut arithmetic = Arithmetic::new(graph);
        match self.value(&mut arithmetic, tree)? {
            Value::Scalar(node) => Ok(node),
            other => {
                let message = format!("a formula must be a scalar; got {}. Write for example dot(u, v)", other.kind());
                Err(self.refusal(message, tree.position))
            }
        }
    }

    fn refusal(&self, message: impl Into<String>, position: usize) -> Refusal {
        Refusal::new(message, self.text, position)
    }

    fn value(&self, scalars: &mut Arithmetic, tree: &Tree) -> Result<Value, Refusal> {
        let here = |refused: String| self.refusal(refused, tree.position);
        match &tree.part {
            Part::Number(number) => Ok(Value::Scalar(scalars.graph.number(number.clone()))),
            Part::Name(name) => self.named(scalars, name, tree.position),
            Part::Sum(terms) => self.sum(scalars, tree, terms),
            Part::Product(factors) => self.product(scalars, tree, factors),
            Part::Negative(of) => {
                let value = self.value(scalars, of)?;
                scalars.opposite(&value).map_err(here)
            }
            Part::Power(parts) => {
                let base = self.value(scalars, &parts[0])?;
                let exponent = self.value(scalars, &parts[1])?;
                self.power(scalars, &base, &exponent).map_err(here)
            }
            Part::Component(of, indices) => {
                let whole = self.value(scalars, of)?;
                component(&whole, indices).map_err(here)
            }
            Part::Call(function, arguments) => {
                let values = arguments.iter().map(|argument| self.value(scalars, argument));
                let values = values.collect::<Result<Vec<_>, _>>()?;
                self.call(scalars, function, &values).map_err(here)
            }
        }
    }

    fn named(&self, scalars: &mut Arithmetic, name: &str, position: usize) -> Result<Value, Refusal> {
        match self.scope.meaning(name) {
            Some(Meaning::Field(first, count)) => {
                Ok(Value::Vector((first..first + count).map(|k| scalars.graph.symbol(k)).collect()))
            }
            Some(Meaning::Coordinate(k)) => Ok(Value::Scalar(scalars.graph.symbol(k))),
            Some(Meaning::Entry(parameter, k)) => Ok(Value::Scalar(self.entry(scalars, parameter, k)?)),
            Some(Meaning::Parameter(k)) => {
                let shape = &self.scope.parameters[k].shape;
                let entries = (0..shape.iter().product()).map(|entry| self.entry(scalars, k, entry));
                let entries = entries.collect::<Result<Vec<_>, _>>()?;
                Ok(match shape[..] {
                    [] => Value::Scalar(entries[0]),
                    [_, columns] => Value::Matrix(entries.chunks(columns).map(<[Node]>::to_vec).collect()),
                    _ => Value::Vector(entries),
                })
            }
            None if name == PI => Ok(Value::Scalar(scalars.graph.pi())),
            None => Err(self.refusal(self.unknown_name(name), position)),
        }
    }

    /// An entry of a parameter: its value, or its symbol.
    fn entry(&self, scalars: &mut Arithmetic, parameter: usize, entry: usize) -> Result<Node, Refusal> {
        let parameter = &self.scope.parameters[parameter];
        match &parameter.values {
            Some(values) if self.insert_values => number(scalars.graph, &parameter.name, &values[entry]),
            _ => Ok(scalars.graph.symbol(parameter.first + entry)),
        }
    }

    fn sum(&self, scalars: &mut Arithmetic, tree: &Tree, parts: &[(Tree, bool, usize)]) -> Result<Value, Refusal> {
        let mut terms: Vec<(Value, bool)> = vec![];
        for (part, is_negative, _) in parts {
            terms.push((self.value(scalars, part)?, *is_negative));
        }
        for ((term, _), (_, _, position)) in terms.iter().zip(parts) {
            let first = &terms[0].0;
            if term.shape() != first.shape() {
                let message = format!("terms of a sum must have one shape; got {} and {}", first.kind(), term.kind());
                return Err(self.refusal(message, *position));
            }
        }
        scalars.sum_of(&terms).map_err(|refused| self.refusal(refused, tree.position))
    }

    fn product(&self, scalars: &mut Arithmetic, tree: &Tree, parts: &[(Tree, bool, usize)]) -> Result<Value, Refusal> {
        let mut values = vec![];
        for (part, ..) in parts {
            values.push(self.value(scalars, part)?);
        }
        let (mut numbers, mut tensor) = (vec![], None);
        for (value, (_, divides, position)) in values.iter().zip(parts) {
            let mut multiply = || -> Refused<()> {
                match (value, &tensor) {
                    (_, _) if *divides => {
                        let divisor = as_divisor(value)?;
                        numbers.push(scalars.reciprocal(divisor)?);
                    }
                    (Value::Scalar(node), _) => numbers.push(*node),
                    (_, None) => tensor = Some(value.clone()),
                    (_, Some(left)) => tensor = Some(scalars.product_of(left, value)?),
                }
                Ok(())
            };
            multiply().map_err(|refused| self.refusal(refused, *position))?;
        }
        let multiply = || -> Refused<Value> {
            let scalar = scalars.product(&numbers)?;
            tensor.map_or(Ok(Value::Scalar(scalar)), |tensor| scalars.scaled(scalar, &tensor))
        };
        multiply().map_err(|refused| self.refusal(refused, tree.position))
    }

    fn power(&self, scalars: &mut Arithmetic, base: &Value, exponent: &Value) -> Refused<Value> {
        let (&Value::Scalar(node), &Value::Scalar(power)) = (base, exponent) else {
            let got = if matches!(base, Value::Scalar(_)) { exponent } else { base };
            return Err(format!(
                "a power must be one of scalars; got {}. Write dot(v, v) for the square of a vector",
                got.kind()
            ));
        };
        let is_number = scalars.graph.rational(power).is_some();
        if !is_number && scalars.graph.symbols(power).iter().any(|&symbol| symbol < self.scope.n_coordinates) {
            return Err("an exponent must not depend on the state. Write exp(y*log(x)) for x^y".to_owned());
        }
        scalars.power(node, power).map(Value::Scalar)
    }

    fn call(&self, scalars: &mut Arithmetic, name: &str, arguments: &[Value]) -> Refused<Value> {
        if OF_MATRICES.contains(&name) {
            return scalars.apply_to_tensors(name, arguments);
        }
        let got = || if arguments.is_empty() { "nothing".to_owned() } else { kinds(arguments) };
        if name == ANGLE {
            if !self.angles {
                return Err(format!(
                    "{ANGLE} jumps by 2*pi where its angle is pi, and the equations of motion need derivatives. Use it in \
                     functions of sections and figures only; here write x and y themselves"
                ));
            }
            let [Value::Scalar(y), Value::Scalar(x)] = arguments else {
                return Err(format!(
                    "{ANGLE} takes two scalars, y and x; got {}. Write for example {ANGLE}(l2, l1)",
                    got()
                ));
            };
            return scalars.angle(*y, *x).map(Value::Scalar);
        }
        if !ELEMENTARY.contains(&name) {
            return Err(self.unknown_function(name));
        }
        match arguments {
            [Value::Scalar(argument)] => scalars.apply(name, *argument).map(Value::Scalar),
            _ => Err(format!("{name} takes one scalar; got {}", got())),
        }
    }

    fn unknown_name(&self, name: &str) -> String {
        let suggestion = self.scope.suggestion(name);
        if matches!(name, "t" | "time") {
            return format!(
                "the name {} is unknown. Time is t, and in the Hamiltonian of a Python System alone. {suggestion}",
                quoted(name)
            );
        }
        if functions().any(|function| function == name) {
            return format!("{name} is a function and needs its arguments. Write {name}(...)");
        }
        let constant = constant_instead(name).map_or_else(String::new, |hint| format!("{hint}. "));
        format!("the name {} is unknown. {constant}{suggestion}", quoted(name))
    }

    fn unknown_function(&self, name: &str) -> String {
        if self.scope.meaning(name).is_some() || name == PI {
            return format!("{name} is no function. Write {name}*(...) for a product, {name}[1] for a component");
        }
        if is_not_smooth(name) {
            return format!(
                "{name} is not smooth, and the equations of motion need derivatives. Use smooth functions only"
            );
        }
        if let Some(instead) = function_instead(name) {
            return format!("the function {} is unknown. Write {instead}", quoted(name));
        }
        let hint = did_you_mean(name, functions());
        let known = functions().collect::<Vec<_>>().join(", ");
        format!("the function {} is unknown. {hint}Known are {known}", quoted(name))
    }
}

/// The value of an entry of the parameter `name`, a formula without names.
pub(super) fn number(graph: &mut Graph, name: &str, tree: &Tree) -> Result<Node, Refusal> {
    let nothing = Scope::without_names();
    let reading = Reading { text: "", scope: &nothing, insert_values: true, angles: false };
    let refused = |refusal: Refusal| Refusal::general(format!("{name} must be a number; {}.", refusal.message));
    reading.scalar(graph, tree).map_err(refused)
}

fn as_divisor(value: &Value) -> Refused<Node> {
    match value {
        Value::Scalar(node) => Ok(*node),
        Value::Vector(_) => {
            Err(format!("a divisor must be a scalar; got {}. Write inv(I)*l for l1/I1, l2/I2, ...", value.kind()))
        }
        Value::Matrix(_) => Err(format!("a divisor must be a scalar; got {}. Write inv(M)*v", value.kind())),
    }
}

/// A component of a vector or a matrix, counted from 1.
fn component(whole: &Value, indices: &[usize]) -> Refused<Value> {
    let shape = whole.shape();
    if shape.len() != indices.len() {
        let hint = if shape.is_empty() { "Leave it out".to_owned() } else { format!("Write {} of them", shape.len()) };
        return Err(format!(
            "a vector has components with one index and a matrix with two; got {} for {}. {hint}",
            indices.len(),
            whole.kind()
        ));
    }
    if indices.iter().zip(&shape).any(|(index, length)| index > length) {
        return Err(format!("an index must not exceed the shape; got {indices:?} for {}", whole.kind()));
    }
    Ok(Value::Scalar(match whole {
        Value::Scalar(node) => *node,
        Value::Vector(entries) => entries[indices[0] - 1],
        Value::Matrix(rows) => rows[indices[0] - 1][indices[1] - 1],
    }))
}
