//! Systems that are typed, from their descriptions: a bracket by name or structure constants, a formula, parameters.

use crate::describe::{Part, Record};
use crate::json::Value;
use crate::refusal::{Kind, Refusal};
use liepoisson_core::formula::{Bracket, Coordinates, Entry, Given, System};

/// A system.
pub(crate) fn read_system(text: &[u8]) -> Result<System, Refusal> {
    let record = Record::read("system", text)?;
    let bracket = read_bracket(record.get("bracket")?)?;
    let parameters = match record.optional("parameters") {
        Some(given) => given.entries()?.into_iter().map(read_parameter).collect::<Result<_, _>>()?,
        None => vec![],
    };
    let declared = record.optional("declared").map_or(Ok(vec![]), |names| names.each(Part::owned))?;
    Ok(System::new(bracket, record.get("hamiltonian")?.text()?, &parameters, &declared)?)
}

/// Texts of functions: a list.
pub(crate) fn read_texts(text: &[u8]) -> Result<Vec<String>, Refusal> {
    let record = Record::read("functions", text)?;
    record.get("functions")?.each(Part::owned)
}

/// The text of one formula.
pub(crate) fn read_text(text: &[u8]) -> Result<String, Refusal> {
    Record::read("formula", text)?.get("formula")?.owned()
}

/// A bracket by its name: `canonical` with `n` or `coordinates` (and `momenta`), `so3`, `e3`, `semidirect` and `leibniz` with `n`
/// (and `epsilon`), `lie_poisson` with `coordinates` or `fields` and `constants`, `tensor` with these and `entries`; and `known`
/// with `terms` that the package has written, whose Jacobi identity holds.
fn read_bracket(part: Part) -> Result<Bracket, Refusal> {
    let record = part.record()?;
    let count = || record.get("n")?.whole();
    let names = || record.get("coordinates")?.each(Part::owned);
    Ok(match record.get("name")?.text()? {
        "canonical" => match record.optional("coordinates") {
            Some(_) => {
                let momenta = record.optional("momenta").map(|momenta| momenta.each(Part::owned)).transpose()?;
                Bracket::canonical_of(&names()?, momenta.as_deref())?
            }
            None => Bracket::canonical(count()?)?,
        },
        "so3" => Bracket::semidirect(1)?,
        "e3" => Bracket::semidirect(2)?,
        "semidirect" => Bracket::semidirect(count()?)?,
        "leibniz" => {
            let epsilon = record.optional("epsilon").map_or(Ok("1".to_owned()), Part::owned)?;
            Bracket::leibniz(count()?, &epsilon)?
        }
        "lie_poisson" => {
            let constants = record.get("constants")?.each(|entry| {
                let [i, j, k, c] = entry.items()?;
                Ok((i.whole()?, j.whole()?, k.whole()?, c.owned()?))
            })?;
            Bracket::lie_poisson(read_coordinates(&record)?, &constants)?
        }
        "tensor" => {
            let entries = record.get("entries")?.each(|entry| {
                let [i, j, c] = entry.items()?;
                Ok((i.whole()?, j.whole()?, c.owned()?))
            })?;
            Bracket::tensor(read_coordinates(&record)?, &entries)?
        }
        "known" => {
            let terms = record.get("terms")?.each(|entry| {
                let [i, j, m, c] = entry.items()?;
                Ok(Entry { i: i.whole()?, j: j.whole()?, m: Some(m.whole()?), c: c.owned()? })
            })?;
            Bracket::known(read_coordinates(&record)?, terms)?
        }
        other => {
            return Err(record.unknown(other, "canonical, so3, e3, semidirect, leibniz, lie_poisson, tensor or known"));
        }
    })
}

/// Vectors, each with the names of its components, or scalars.
fn read_coordinates(record: &Record) -> Result<Coordinates, Refusal> {
    Ok(match record.optional("fields") {
        Some(fields) => Coordinates::Vectors(
            fields
                .entries()?
                .into_iter()
                .map(|field| Ok((field.name.to_owned(), field.each(Part::owned)?)))
                .collect::<Result<_, Refusal>>()?,
        ),
        None => Coordinates::Scalars(record.get("coordinates")?.each(Part::owned)?),
    })
}

/// A number, a vector or a matrix, of numbers or texts.
fn read_parameter(part: Part) -> Result<(String, Given), Refusal> {
    let given = match part.value {
        Value::List(rows) if rows.iter().any(|row| matches!(row, Value::List(_))) => {
            Given::Matrix(part.each(|row| row.each(Part::owned))?)
        }
        Value::List(_) => Given::Vector(part.each(Part::owned)?),
        _ => Given::Scalar(part.owned()?),
    };
    Ok((part.name.to_owned(), given))
}

impl From<liepoisson_core::formula::Refusal> for Refusal {
    fn from(refusal: liepoisson_core::formula::Refusal) -> Refusal {
        let kind = if refusal.position.is_some() { Kind::Expression } else { Kind::Parameter };
        // all before it is ASCII, of which JavaScript counts the same characters
        let place = refusal.position.map(|position| position as i32);
        Refusal { kind, message: refusal.to_string(), place }
    }
}

impl Part<'_> {
    /// A text, or a number as the decimal that it prints as.
    pub(crate) fn owned(self) -> Result<String, Refusal> {
        match self.value {
            Value::Text(text) => Ok(text.clone()),
            Value::Number(number) => Ok(format!("{number:e}")),
            _ => Err(self.wrong("a number or a text")),
        }
    }
}
