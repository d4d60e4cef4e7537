//! Why a call was refused: a kind, whose name is that of the exception in Python, and a message.

use liepoisson_core::error::Error;

/// The kind of a refusal; negative, as calls return it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub(crate) enum Kind {
    Shape = -1,
    Parameter = -2,
    UnknownName = -3,
    UnsupportedField = -4,
    Memory = -5,
    Description = -6,
    Handle = -7,
    Expression = -8,
}

impl Kind {
    /// All of them: that of number `-k` is at place `k - 1`.
    pub(crate) const NAMES: [&str; 8] = [
        "ShapeError",
        "ParameterError",
        "UnknownNameError",
        "UnsupportedFieldError",
        "MemoryLimitError",
        "DescriptionError",
        "HandleError",
        "ExpressionError",
    ];
}

/// A refusal.
#[derive(Debug)]
pub(crate) struct Refusal {
    pub(crate) kind: Kind,
    pub(crate) message: String,
    /// The place in a formula, as JavaScript counts.
    pub(crate) place: Option<i32>,
}

impl Refusal {
    pub(crate) fn new(kind: Kind, message: impl Into<String>) -> Refusal {
        Refusal { kind, message: message.into(), place: None }
    }

    /// A description that is none.
    pub(crate) fn description(what: &str, wrong: &str) -> Refusal {
        Refusal::new(Kind::Description, format!("{what}: {wrong}"))
    }
}

impl From<Error> for Refusal {
    fn from(error: Error) -> Refusal {
        let kind = match error {
            Error::Memory { .. } => Kind::Memory,
            Error::Length { .. } | Error::Outputs { .. } | Error::InstructionOperands { .. } => Kind::Shape,
            Error::UnknownInstruction { .. } => Kind::UnknownName,
            Error::MethodOption { .. } => Kind::Description,
            Error::MethodForField => Kind::UnsupportedField,
            _ => Kind::Parameter,
        };
        Refusal::new(kind, error.to_string())
    }
}
