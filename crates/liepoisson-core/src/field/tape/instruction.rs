//! What a tape is made of: instructions that read registers and write the next one.

use crate::error::Error;
use crate::field::check_components;

/// One instruction of a [`Tape`](super::Tape): it reads registers and writes the next one.
#[derive(Clone, Debug, PartialEq)]
pub enum Instruction {
    /// `constant + sum of c r` over the pairs `(r, c)`.
    Linear {
        /// Registers and their coefficients.
        terms: Vec<(usize, f64)>,
        /// The constant.
        constant: f64,
    },
    /// `a b`
    Product(usize, usize),
    /// `a / b`
    Quotient(usize, usize),
    /// `a^p` for a real number `p`; for a whole number, `a` may be zero or negative.
    Power(usize, f64),
    /// The square root of `a`.
    Sqrt(usize),
    /// `e^a`
    Exp(usize),
    /// The natural logarithm of `a`.
    Log(usize),
    /// The sine of `a`.
    Sin(usize),
    /// The cosine of `a`.
    Cos(usize),
    /// The hyperbolic sine of `a`.
    Sinh(usize),
    /// The hyperbolic cosine of `a`.
    Cosh(usize),
    /// The hyperbolic tangent of `a`.
    Tanh(usize),
    /// The arc sine of `a`.
    Asin(usize),
    /// The arc cosine of `a`.
    Acos(usize),
    /// The arc tangent of `a`.
    Atan(usize),
}

impl Instruction {
    /// The instruction called `name`: `linear` has any number `m` of registers and `m + 1` numbers, the constant last;
    /// `product` and `quotient` have two registers, `power` one register and one number, the rest one register.
    ///
    /// # Errors
    /// A name that is not one of `linear product quotient power sqrt exp log sin cos sinh cosh tanh asin acos atan`, or
    /// the wrong number of registers or numbers.
    pub fn from_parts(name: &str, registers: &[usize], numbers: &[f64]) -> Result<Instruction, Error> {
        let wrong = |name: &'static str, wanted: (usize, usize)| Error::InstructionOperands {
            name,
            wanted,
            got: (registers.len(), numbers.len()),
        };
        let unary = |name: &'static str, make: fn(usize) -> Instruction| match (registers, numbers) {
            (&[a], &[]) => Ok(make(a)),
            _ => Err(wrong(name, (1, 0))),
        };
        let binary = |name: &'static str, make: fn(usize, usize) -> Instruction| match (registers, numbers) {
            (&[a, b], &[]) => Ok(make(a, b)),
            _ => Err(wrong(name, (2, 0))),
        };
        match name {
            "linear" => match numbers {
                [coefficients @ .., constant] if coefficients.len() == registers.len() => Ok(Instruction::Linear {
                    terms: registers.iter().copied().zip(coefficients.iter().copied()).collect(),
                    constant: *constant,
                }),
                _ => Err(wrong("linear", (registers.len(), registers.len() + 1))),
            },
            "power" => match (registers, numbers) {
                (&[a], &[exponent]) => Ok(Instruction::Power(a, exponent)),
                _ => Err(wrong("power", (1, 1))),
            },
            "product" => binary("product", Instruction::Product),
            "quotient" => binary("quotient", Instruction::Quotient),
            "sqrt" => unary("sqrt", Instruction::Sqrt),
            "exp" => unary("exp", Instruction::Exp),
            "log" => unary("log", Instruction::Log),
            "sin" => unary("sin", Instruction::Sin),
            "cos" => unary("cos", Instruction::Cos),
            "sinh" => unary("sinh", Instruction::Sinh),
            "cosh" => unary("cosh", Instruction::Cosh),
            "tanh" => unary("tanh", Instruction::Tanh),
            "asin" => unary("asin", Instruction::Asin),
            "acos" => unary("acos", Instruction::Acos),
            "atan" => unary("atan", Instruction::Atan),
            _ => Err(Error::UnknownInstruction { name: name.to_owned() }),
        }
    }

    fn name(&self) -> &'static str {
        match self {
            Instruction::Linear { .. } => "linear",
            Instruction::Product(..) => "product",
            Instruction::Quotient(..) => "quotient",
            Instruction::Power(..) => "power",
            Instruction::Sqrt(_) => "sqrt",
            Instruction::Exp(_) => "exp",
            Instruction::Log(_) => "log",
            Instruction::Sin(_) => "sin",
            Instruction::Cos(_) => "cos",
            Instruction::Sinh(_) => "sinh",
            Instruction::Cosh(_) => "cosh",
            Instruction::Tanh(_) => "tanh",
            Instruction::Asin(_) => "asin",
            Instruction::Acos(_) => "acos",
            Instruction::Atan(_) => "atan",
        }
    }

    pub(super) fn registers(&self) -> Vec<usize> {
        match *self {
            Instruction::Linear { ref terms, .. } => terms.iter().map(|&(register, _)| register).collect(),
            Instruction::Product(a, b) | Instruction::Quotient(a, b) => vec![a, b],
            Instruction::Power(a, _)
            | Instruction::Sqrt(a)
            | Instruction::Exp(a)
            | Instruction::Log(a)
            | Instruction::Sin(a)
            | Instruction::Cos(a)
            | Instruction::Sinh(a)
            | Instruction::Cosh(a)
            | Instruction::Tanh(a)
            | Instruction::Asin(a)
            | Instruction::Acos(a)
            | Instruction::Atan(a) => vec![a],
        }
    }

    fn numbers(&self) -> Vec<f64> {
        match self {
            Instruction::Linear { terms, constant } => terms.iter().map(|&(_, c)| c).chain([*constant]).collect(),
            Instruction::Power(_, exponent) => vec![*exponent],
            _ => vec![],
        }
    }

    fn check(&self, index: usize, available: usize) -> Result<(), Error> {
        let name = self.name();
        if let Some(register) = self.registers().into_iter().find(|&register| register >= available) {
            return Err(Error::InstructionRegister { index, name, register, available });
        }
        match self.numbers().into_iter().find(|number| !number.is_finite()) {
            Some(got) => Err(Error::InstructionNumber { index, name, got }),
            None => Ok(()),
        }
    }
}

/// Refuses instructions and outputs that read what is not there.
pub(super) fn check(n_components: usize, instructions: &[Instruction], outputs: &[usize]) -> Result<(), Error> {
    check_components(n_components)?;
    for (index, instruction) in instructions.iter().enumerate() {
        instruction.check(index, n_components + index)?;
    }
    let available = n_components + instructions.len();
    match outputs.iter().position(|&register| register >= available) {
        Some(component) => Err(Error::OutputRegister { component, register: outputs[component], available }),
        None => Ok(()),
    }
}
