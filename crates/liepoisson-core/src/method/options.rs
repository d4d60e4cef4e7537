//! The options of a method by name, as Python or a page gives them.

use crate::error::Error;

/// Steps that a trajectory may take unless a caller says otherwise.
const MAX_STEPS: u64 = 10_000_000;

/// The value of an option; yes is 1, no is 0.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)] // each is what its type says
pub enum Setting {
    Number(f64),
    Word(String),
}

/// The options that are given, by the names that they have in Python.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options(pub Vec<(String, Setting)>);

impl Options {
    fn get(&self, name: &str) -> Option<&Setting> {
        self.0.iter().find(|(given, _)| given == name).map(|(_, setting)| setting)
    }

    /// A number.
    pub(crate) fn number(&self, name: &'static str) -> Result<Option<f64>, Error> {
        match self.get(name) {
            None => Ok(None),
            Some(Setting::Number(number)) => Ok(Some(*number)),
            Some(Setting::Word(_)) => Err(Error::MethodOption { name, wrong: "a number; got something else" }),
        }
    }

    /// A whole number.
    pub(crate) fn whole(&self, name: &'static str) -> Result<Option<u64>, Error> {
        match self.number(name)? {
            Some(number) if number < 0.0 || number.fract() != 0.0 => {
                Err(Error::MethodOption { name, wrong: "a whole number from 0; got something else" })
            }
            number => Ok(number.map(|number| number as u64)),
        }
    }

    /// Whether an option is this word, or yes.
    pub(crate) fn says(&self, name: &str, word: &str) -> bool {
        match self.get(name) {
            Some(Setting::Word(given)) => given == word,
            Some(Setting::Number(number)) => *number != 0.0 && word == "yes",
            None => false,
        }
    }

    /// The longest step, which must be given.
    pub(crate) fn step(&self) -> Result<f64, Error> {
        self.number("step")?.ok_or(Error::MethodOption { name: "step", wrong: "a positive number; got none" })
    }

    /// The order.
    pub(crate) fn order(&self) -> Result<Option<usize>, Error> {
        Ok(self.whole("order")?.map(|order| order as usize))
    }

    /// The most steps of a trajectory.
    pub(crate) fn max_steps(&self) -> Result<u64, Error> {
        Ok(self.whole("max_steps")?.unwrap_or(MAX_STEPS))
    }
}
