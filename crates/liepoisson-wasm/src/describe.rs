//! Fields, functions and methods from their descriptions: the records that Python's `field.record_of` makes, as JSON.

use crate::json::{self, Value};
use crate::refusal::{Kind, Refusal};
use liepoisson_core::choice::{AnyField, AnyMethod};
use liepoisson_core::field::{Functions, Instruction, Quadratic, Ridge, SplitTerms, Tape, Top};
use liepoisson_core::method::{Options, Setting};
use std::borrow::Cow;

/// A vector field.
pub(crate) fn read_field(text: &[u8]) -> Result<AnyField, Refusal> {
    let record = Record::read("field", text)?;
    match record.kind()? {
        "top" => {
            let [inertia, a, b] = ["inertia", "a", "b"].map(|name| record.get(name)?.triple());
            Ok(AnyField::Top(Top::new(inertia?, a?, b?, record.get("epsilon")?.number()?)?))
        }
        "quadratic" => {
            let constant = record.get("constant")?.each(|entry| entry.entry().map(|([i], c)| (i, c)))?;
            let linear = record.get("linear")?.each(|entry| entry.entry().map(|([i, j], c)| (i, j, c)))?;
            let quadratic = record.get("quadratic")?.each(|entry| entry.entry().map(|([i, j, k], c)| (i, j, k, c)))?;
            Ok(AnyField::Quadratic(Quadratic::new(record.n_components()?, &constant, &linear, &quadratic)?))
        }
        "tape" => {
            let (instructions, outputs) = record.lines()?;
            let tape = Tape::new(record.n_components()?, instructions, outputs)?;
            Ok(AnyField::Tape(match record.optional("size_limits") {
                Some(limits) => tape.with_size_limits(limits.each(Part::limit)?)?,
                None => tape,
            }))
        }
        "pieces" => {
            let ridges = record.get("pieces")?.each(|piece| {
                let [form, derivative, generator] = piece.items()?;
                Ok(Ridge {
                    form: form.each(|entry| entry.entry().map(|([i], c)| (i, c)))?,
                    derivative: derivative.each(Part::number)?,
                    generator: generator.each(|entry| entry.entry().map(|([i, k], c)| (i, k, c)))?,
                })
            })?;
            Ok(AnyField::SplitTerms(SplitTerms::new(record.n_components()?, ridges)?))
        }
        other => Err(record.unknown(other, "top, quadratic, tape or pieces")),
    }
}

/// Functions on phase space: the record of a tape without its kind.
pub(crate) fn read_functions(text: &[u8]) -> Result<Functions, Refusal> {
    let record = Record::read("functions", text)?;
    let (instructions, outputs) = record.lines()?;
    Ok(Functions::new(record.n_components()?, instructions, outputs)?)
}

/// A method of integration, one of those that are in the browser.
pub(crate) fn read_method(text: &[u8]) -> Result<AnyMethod, Refusal> {
    let record = Record::read("method", text)?;
    let kind = record.kind()?;
    let given = record.entries.iter().filter(|(_, value)| *value != Value::Null).map(|(name, value)| {
        let setting = match value {
            Value::Number(number) => Setting::Number(*number),
            Value::Text(word) => Setting::Word(word.clone()),
            Value::Flag(flag) => Setting::Number(f64::from(u8::from(*flag))),
            _ => return Err(Part { name, value }.wrong("a number, a word, true or false")),
        };
        Ok((name.clone(), setting))
    });
    let options = Options(given.collect::<Result<_, _>>()?);
    let known: Vec<&str> = AnyMethod::NAMES.iter().filter(|(_, here)| *here).map(|(name, _)| *name).collect();
    match AnyMethod::named(kind, &options).filter(|_| known.contains(&kind)) {
        Some(made) => Ok(made?),
        None => Err(record.unknown(kind, &known.join(" or "))),
    }
}

/// A record, and what it describes.
pub(crate) struct Record<'v> {
    what: &'v str,
    entries: Cow<'v, [(String, Value)]>,
}

/// A part of a record, and what it is called.
#[derive(Clone, Copy)]
pub(crate) struct Part<'v> {
    pub(crate) name: &'v str,
    pub(crate) value: &'v Value,
}

impl<'v> Record<'v> {
    pub(crate) fn read(what: &'v str, text: &[u8]) -> Result<Record<'v>, Refusal> {
        match json::read(text) {
            Ok(Value::Record(entries)) => Ok(Record { what, entries: Cow::Owned(entries) }),
            Ok(_) => Err(Refusal::description(what, "wanted a record { ... }; got something else")),
            Err(wrong) => Err(Refusal::description(what, &wrong)),
        }
    }

    /// An entry that is there and not null.
    pub(crate) fn optional<'r>(&'r self, name: &'r str) -> Option<Part<'r>> {
        let (_, value) = self.entries.iter().find(|(key, value)| key == name && *value != Value::Null)?;
        Some(Part { name, value })
    }

    pub(crate) fn get<'r>(&'r self, name: &'r str) -> Result<Part<'r>, Refusal> {
        let absent = || Refusal::description(self.what, &format!("wanted an entry {name:?}; there is none"));
        self.optional(name).ok_or_else(absent)
    }

    fn kind(&self) -> Result<&str, Refusal> {
        self.get("kind")?.text()
    }

    fn n_components(&self) -> Result<usize, Refusal> {
        self.get("n_components")?.whole()
    }

    pub(crate) fn unknown(&self, got: &str, wanted: &str) -> Refusal {
        let got: String = got.chars().take(60).collect();
        Refusal::new(Kind::UnknownName, format!("kind of {}: wanted {wanted}; got {got:?}", self.what))
    }

    /// The instructions and the outputs of a tape.
    fn lines(&self) -> Result<(Vec<Instruction>, Vec<usize>), Refusal> {
        let instructions = self.get("instructions")?.each(|line| {
            let [name, registers, numbers] = line.items()?;
            let (registers, numbers) = (registers.each(Part::whole)?, numbers.each(Part::number)?);
            Ok(Instruction::from_parts(name.text()?, &registers, &numbers)?)
        })?;
        Ok((instructions, self.get("outputs")?.each(Part::whole)?))
    }
}

impl<'v> Part<'v> {
    pub(crate) fn wrong(self, wanted: &str) -> Refusal {
        Refusal::description(self.name, &format!("wanted {wanted}; got something else"))
    }

    /// The entries of a record, each with its name.
    pub(crate) fn entries(self) -> Result<Vec<Part<'v>>, Refusal> {
        match self.value {
            Value::Record(entries) => Ok(entries.iter().map(|(name, value)| Part { name, value }).collect()),
            _ => Err(self.wrong("a record { ... }")),
        }
    }

    /// A record in a record.
    pub(crate) fn record(self) -> Result<Record<'v>, Refusal> {
        match self.value {
            Value::Record(entries) => Ok(Record { what: self.name, entries: Cow::Borrowed(entries) }),
            _ => Err(self.wrong("a record { ... }")),
        }
    }

    /// A number, infinity for null.
    fn limit(self) -> Result<f64, Refusal> {
        if *self.value == Value::Null { Ok(f64::INFINITY) } else { self.number() }
    }

    fn number(self) -> Result<f64, Refusal> {
        match self.value {
            Value::Number(number) => Ok(*number),
            _ => Err(self.wrong("a number")),
        }
    }

    /// A whole number that an index can be.
    pub(crate) fn whole(self) -> Result<usize, Refusal> {
        match self.value {
            Value::Number(number) if *number >= 0.0 && *number <= f64::from(u32::MAX) && number.fract() == 0.0 => {
                Ok(*number as usize)
            }
            _ => Err(self.wrong("a whole number from 0 to 4294967295")),
        }
    }

    pub(crate) fn text(self) -> Result<&'v str, Refusal> {
        match self.value {
            Value::Text(text) => Ok(text),
            _ => Err(self.wrong("a text")),
        }
    }

    fn list(self) -> Result<&'v [Value], Refusal> {
        match self.value {
            Value::List(values) => Ok(values),
            _ => Err(self.wrong("a list")),
        }
    }

    pub(crate) fn each<T>(self, read: impl Fn(Part<'v>) -> Result<T, Refusal>) -> Result<Vec<T>, Refusal> {
        self.list()?.iter().map(|value| read(Part { value, ..self })).collect()
    }

    /// A list of so many.
    pub(crate) fn items<const N: usize>(self) -> Result<[Part<'v>; N], Refusal> {
        let values: &[Value; N] = self.list()?.try_into().map_err(|_| self.wrong(&format!("lists of {N} entries")))?;
        Ok(values.each_ref().map(|value| Part { value, ..self }))
    }

    fn triple(self) -> Result<[f64; 3], Refusal> {
        let [first, second, third] = self.items()?;
        Ok([first.number()?, second.number()?, third.number()?])
    }

    /// Indices and a number.
    fn entry<const N: usize>(self) -> Result<([usize; N], f64), Refusal> {
        let values = self.list()?;
        let Some((last, first)) = values.split_last().filter(|(_, first)| first.len() == N) else {
            return Err(self.wrong(&format!("entries of {N} indices and a number")));
        };
        let mut indices = [0; N];
        for (index, value) in indices.iter_mut().zip(first) {
            *index = Part { value, ..self }.whole()?;
        }
        Ok((indices, Part { value: last, ..self }.number()?))
    }
}
