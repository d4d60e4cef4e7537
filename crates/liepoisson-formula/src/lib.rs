//! From the text of a Hamiltonian to the field of a bracket, as plain data: a tape, the coefficients of a quadratic field, a top.
//!
//! A text is read by the [`grammar`](MAX_CHARACTERS), given a meaning by a [`Scope`], and becomes an expression of a graph in which
//! every one stands once, with exact constants.

mod bracket;
mod cancellation;
mod constant;
mod derivative;
mod elementary;
mod expand;
mod field;
mod grammar;
mod graph;
mod limits;
mod lowering;
mod measure;
mod names;
mod natural;
mod overflow;
mod printed;
mod products;
mod rational;
mod reader;
mod refusal;
mod scope;
mod system;
mod tensors;
mod text;
mod top;

pub use bracket::{Bracket, Entry};
pub use field::Lowered;
pub use grammar::MAX_CHARACTERS;
pub use lowering::{Instruction, Lines};
pub use printed::Printed;
pub use rational::Rational;
pub use refusal::Refusal;
pub use scope::{Coordinates, Given, Scope};
pub use system::{System, SystemWritten, names_of};
pub use text::Written;
