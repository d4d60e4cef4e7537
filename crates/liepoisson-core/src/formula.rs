//! Systems that are typed, as fields of the core.
//!
//! ```
//! use liepoisson_core::choice::AnyField;
//! use liepoisson_core::formula::{Bracket, System};
//! let pendulum = System::new(Bracket::canonical(1)?, "p1^2/2 - cos(q1)", &[], &[])?;
//! let field = AnyField::try_from(pendulum.field()?)?;
//! assert_eq!(field.n_components(), 2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::choice::AnyField;
use crate::error::Error;
use crate::field::{Functions, Instruction, Quadratic, Tape, Top};
#[doc(inline)]
pub use liepoisson_formula::{
    Bracket, Coordinates, Entry, Given, Lines, Lowered, Printed, Rational, Refusal, Scope, System, SystemWritten,
    Written, names_of,
};

impl TryFrom<Lowered> for AnyField {
    type Error = Error;

    fn try_from(field: Lowered) -> Result<AnyField, Error> {
        match field {
            Lowered::Top { inertia, a, b, epsilon } => Top::new(inertia, a, b, epsilon).map(AnyField::Top),
            Lowered::Quadratic { n_components, constant, linear, quadratic } => {
                Quadratic::new(n_components, &constant, &linear, &quadratic).map(AnyField::Quadratic)
            }
            Lowered::Tape(lines) => {
                Tape::new(lines.n_components, instructions(&lines)?, lines.outputs).map(AnyField::Tape)
            }
        }
    }
}

impl TryFrom<Lines> for Functions {
    type Error = Error;

    fn try_from(lines: Lines) -> Result<Functions, Error> {
        Functions::new(lines.n_components, instructions(&lines)?, lines.outputs)
    }
}

fn instructions(lines: &Lines) -> Result<Vec<Instruction>, Error> {
    lines
        .instructions
        .iter()
        .map(|(name, registers, numbers)| Instruction::from_parts(name, registers, numbers))
        .collect()
}
