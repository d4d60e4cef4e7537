//! Systems, fields and functions as JSON, for a page: what [`describe`](crate::describe) reads again.

use liepoisson_core::formula::{Lines, Lowered, SystemWritten, Written};

/// Parts of a system that is shown at most: some pages of print.
const MOST_PARTS: u64 = 6_000;

/// The coordinates of a system, and its Hamiltonian, equations and Poisson tensor as trees; these are null where they are too
/// long to be read.
pub(crate) fn system(system: &liepoisson_core::formula::System) -> Result<String, liepoisson_core::formula::Refusal> {
    let names = list(system.coordinates().iter().map(|name| text(name)));
    Ok(match system.written(MOST_PARTS)? {
        Some(SystemWritten { energy, rates, tensor }) => {
            let rates = list(rates.iter().map(tree));
            let tensor = list(tensor.iter().map(|(i, j, entry)| format!("[{i},{j},{}]", tree(entry))));
            format!(r#"{{"names":{names},"energy":{},"rates":{rates},"tensor":{tensor}}}"#, tree(&energy))
        }
        None => format!(r#"{{"names":{names},"energy":null,"rates":null,"tensor":null}}"#),
    })
}

/// A field as its record.
pub(crate) fn field(field: &Lowered) -> String {
    match field {
        Lowered::Top { inertia, a, b, epsilon } => {
            let [inertia, a, b] = [inertia, a, b].map(|vector| numbers(vector));
            format!(r#"{{"kind":"top","inertia":{inertia},"a":{a},"b":{b},"epsilon":{epsilon:e}}}"#)
        }
        Lowered::Quadratic { n_components, constant, linear, quadratic } => {
            let constant = list(constant.iter().map(|(i, c)| format!("[{i},{c:e}]")));
            let linear = list(linear.iter().map(|(i, j, c)| format!("[{i},{j},{c:e}]")));
            let quadratic = list(quadratic.iter().map(|(i, j, k, c)| format!("[{i},{j},{k},{c:e}]")));
            format!(
                r#"{{"kind":"quadratic","n_components":{n_components},"constant":{constant},"linear":{linear},"quadratic":{quadratic}}}"#
            )
        }
        Lowered::Tape(lines) => format!(r#"{{"kind":"tape",{}}}"#, of_lines(lines)),
    }
}

/// Functions as their record.
pub(crate) fn functions(lines: &Lines) -> String {
    format!("{{{}}}", of_lines(lines))
}

fn of_lines(Lines { n_components, instructions, outputs }: &Lines) -> String {
    let instructions = list(instructions.iter().map(|(name, registers, constants)| {
        format!("[{},{},{}]", text(name), list(registers.iter().map(usize::to_string)), numbers(constants))
    }));
    let outputs = list(outputs.iter().map(usize::to_string));
    format!(r#""n_components":{n_components},"instructions":{instructions},"outputs":{outputs}"#)
}

/// A number or a name is a text; everything else a list that begins with what it is: "+" with terms `[sign, term]`, "/" with two
/// lists of factors, "^", "sqrt", or the name of a function.
fn tree(written: &Written) -> String {
    match written {
        Written::Number(number) => format!(r#"["number",{}]"#, text(number)),
        Written::Name(name) => text(name),
        Written::Sum(terms) => {
            let terms = terms
                .iter()
                .map(|(is_negative, term)| format!(r#"["{}",{}]"#, if *is_negative { "-" } else { "+" }, tree(term)));
            format!(r#"["+",{}]"#, list(terms))
        }
        Written::Quotient(over, under) => {
            format!(r#"["/",{},{}]"#, list(over.iter().map(tree)), list(under.iter().map(tree)))
        }
        Written::Power(base, exponent) => format!(r#"["^",{},{}]"#, tree(base), tree(exponent)),
        Written::Root(of) => format!(r#"["sqrt",{}]"#, tree(of)),
        Written::Call(function, arguments) => format!(r#"["{function}",{}]"#, list(arguments.iter().map(tree))),
    }
}

fn list(items: impl Iterator<Item = String>) -> String {
    format!("[{}]", items.collect::<Vec<_>>().join(","))
}

fn numbers(values: &[f64]) -> String {
    list(values.iter().map(|value| format!("{value:e}")))
}

/// A name in quotes: letters, digits and `_` of ASCII, and signs of numbers.
fn text(name: &str) -> String {
    debug_assert!(name.bytes().all(|byte| byte.is_ascii_graphic() && byte != b'"' && byte != b'\\'));
    format!("\"{name}\"")
}
