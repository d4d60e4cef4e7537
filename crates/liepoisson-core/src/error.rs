//! Every reason for which the core refuses a call.

use crate::field::MOST_COMPONENTS;
use crate::modular::MOST_COLUMNS;
use std::fmt;

/// Why a call was refused.
#[derive(Clone, Debug, PartialEq)]
pub enum Error {
    /// A principal moment of inertia is not a positive finite number.
    Inertia {
        /// The three moments that came.
        got: [f64; 3],
    },
    /// A parameter is not finite.
    ParameterNotFinite {
        /// Its name.
        name: &'static str,
        /// What came.
        got: f64,
    },
    /// An entry of a field that names a component which is not there.
    ComponentIndex {
        /// The part of the field that it stands in.
        name: &'static str,
        /// Number of components.
        n_components: usize,
        /// What came.
        got: usize,
    },
    /// A text that is no rational number, or one with a numerator or denominator of more than 127 bits.
    RationalText {
        /// What came.
        got: String,
    },
    /// Rational numbers whose sums or products have more than 127 bits.
    RationalSize,
    /// A tolerance outside `[2^-53, 0.1]`.
    Tolerance {
        /// What came.
        got: f64,
    },
    /// A tolerance below `2^-20` in single precision.
    SingleTolerance {
        /// What came.
        got: f64,
    },
    /// A step that is not positive and finite.
    StepSize {
        /// What came.
        got: f64,
    },
    /// A number of stages of a Gauss method outside `1..=4`.
    Stages {
        /// What came.
        got: usize,
    },
    /// An order of the Taylor series outside `2..=64`.
    Order {
        /// What came.
        got: usize,
    },
    /// An order that no splitting method has.
    SplittingOrder {
        /// What came.
        got: usize,
    },
    /// An option of a method that is none of its values, or is not given.
    MethodOption {
        /// Its name.
        name: &'static str,
        /// What was wanted and what came.
        wrong: &'static str,
    },
    /// Fewer than two times, or times that are not finite and strictly monotone.
    Times {
        /// Index of the first offending time.
        index: usize,
    },
    /// An array that does not hold what the number of trajectories asks for.
    Length {
        /// Its name.
        name: &'static str,
        /// Numbers wanted.
        wanted: usize,
        /// Numbers that came.
        got: usize,
    },
    /// The growth of a tangent vector that is zero or not finite.
    TangentVector {
        /// Trajectory of the ensemble that it belongs to.
        trajectory: usize,
    },
    /// The result, or the dense output on the way to it, does not fit into memory.
    Memory {
        /// Bytes that could not be had.
        bytes: usize,
    },
    /// A field without components, or with more than any memory could hold series of.
    Components {
        /// What came.
        got: usize,
    },
    /// A direction of crossings that is not -1, 0 or 1.
    Direction {
        /// What came.
        got: i8,
    },
    /// Trajectories that are to end before their first crossing.
    NoCrossings,
    /// No thread could be started.
    Threads {
        /// How many were wanted.
        wanted: usize,
    },
    /// The kernel for one orbit, for something else than the state of a top in power series.
    AcrossComponents,
    /// Quadratic fields for trajectories side by side that differ in more than coefficients.
    OtherTerms {
        /// Which field has other terms than the first.
        trajectory: usize,
    },
    /// The name of an instruction that no tape has.
    UnknownInstruction {
        /// What came.
        name: String,
    },
    /// An instruction with the wrong number of registers or numbers.
    InstructionOperands {
        /// Its name.
        name: &'static str,
        /// Registers and numbers wanted.
        wanted: (usize, usize),
        /// Registers and numbers that came.
        got: (usize, usize),
    },
    /// An instruction that reads a register which is not computed before it.
    InstructionRegister {
        /// Position of the instruction in the tape.
        index: usize,
        /// Its name.
        name: &'static str,
        /// The register.
        register: usize,
        /// Number of registers computed before the instruction.
        available: usize,
    },
    /// An instruction with a number that is not finite.
    InstructionNumber {
        /// Position of the instruction in the tape.
        index: usize,
        /// Its name.
        name: &'static str,
        /// What came.
        got: f64,
    },
    /// A number of outputs that is not the number of components.
    Outputs {
        /// Outputs wanted.
        wanted: usize,
        /// Outputs that came.
        got: usize,
    },
    /// Limits of sizes that are not one for each component, or are negative, or all zero.
    SizeLimits {
        /// Limits wanted.
        wanted: usize,
        /// Limits that came.
        got: Vec<f64>,
    },
    /// An output that no instruction computes.
    OutputRegister {
        /// Component whose derivative it should be.
        component: usize,
        /// The register.
        register: usize,
        /// Number of registers of the tape.
        available: usize,
    },
    /// A modulus that is no odd prime below 2^62.
    Prime {
        /// What came.
        got: u64,
    },
    /// A sparse matrix with too many columns.
    MatrixColumns {
        /// What came.
        got: usize,
    },
    /// A sparse matrix with more columns of entries than residues, or fewer.
    MatrixEntries {
        /// Number of columns of entries.
        wanted: usize,
        /// Number of residues.
        got: usize,
    },
    /// Starts of rows that do not divide the entries into rows.
    MatrixStarts {
        /// Number of entries.
        n_entries: usize,
    },
    /// An entry in a column that is not there.
    MatrixColumn {
        /// Which entry.
        entry: usize,
        /// Number of columns.
        n_columns: usize,
        /// What came.
        got: usize,
    },
    /// The discrete Lagrange top for another top.
    NotLagrange,
    /// A method that does not know fields of this kind.
    MethodForField,
    /// `LIEPOISSON_SIMD` names an instruction set that is unknown or that this processor lacks.
    SimdNotAvailable {
        /// What was asked for.
        wanted: String,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::Inertia { got } => {
                write!(
                    f,
                    "inertia: wanted three positive finite moments; got {got:?}; check units and order (I1, I2, I3)"
                )
            }
            Error::ParameterNotFinite { name, got } => {
                write!(f, "{name}: wanted a finite number; got {got}; check the parameters of the system")
            }
            Error::ComponentIndex { name, n_components, got } => write!(
                f,
                "{name}: wanted indices of components from 0 to {}; got {got}; they count from 0",
                n_components - 1
            ),
            Error::RationalText { got } => write!(
                f,
                "number: wanted a fraction such as -1/3, or a decimal such as 0.25, of at most 38 digits; got {got:?}; \
                 write it as text"
            ),
            Error::RationalSize => f.write_str(
                "polynomial: wanted coefficients whose sums and products have at most 38 digits; got longer ones; \
                 try simpler fractions",
            ),
            Error::Tolerance { got } => {
                write!(f, "tol: wanted a number from 1.1e-16 to 0.1; got {got}; try 1e-15 for round-off accuracy")
            }
            Error::SingleTolerance { got } => {
                write!(f, "tol: wanted at least 1e-6 in single precision; got {got}; try double precision")
            }
            Error::StepSize { got } => {
                write!(f, "step: wanted a positive finite number; got {got}; its sign follows from the times")
            }
            Error::Stages { got } => {
                write!(f, "stages: wanted a whole number from 1 to 4; got {got}; the order is twice that number")
            }
            Error::Order { got } => {
                write!(
                    f,
                    "order: wanted a whole number from 2 to 64; got {got}; leave it out to have it chosen from tol"
                )
            }
            Error::SplittingOrder { got } => write!(f, "order: wanted 2, 4, 6 or 8; got {got}; try 4"),
            Error::MethodOption { name, wrong } => write!(f, "{name}: wanted {wrong}"),
            Error::Times { index } => write!(
                f,
                "times: wanted two or more finite times, strictly increasing or strictly decreasing; \
                 the one at index {index} is not; sort them and drop repeated ones"
            ),
            Error::Length { name, wanted, got } => {
                write!(f, "{name}: wanted {wanted} numbers; got {got}; one row per trajectory is needed")
            }
            Error::TangentVector { trajectory } => write!(
                f,
                "tangent vector of trajectory {trajectory}: wanted finite components, not all zero or negligibly small; \
                 leave tangent vectors out to have them drawn from the seed"
            ),
            Error::Memory { bytes } => write!(
                f,
                "the result: wanted memory for {:.2e} bytes more; there is none; \
                 ask for fewer trajectories or times at once, or leave dense output out",
                *bytes as f64
            ),
            Error::Components { got: 0 } => {
                write!(f, "field: wanted one component or more; got none; give it a state")
            }
            Error::Components { got } => {
                write!(f, "field: wanted at most {MOST_COMPONENTS} components; got {got}; try a smaller truncation")
            }
            Error::Direction { got } => write!(f, "direction: wanted -1, 0 or 1; got {got}; try 0 for both"),
            Error::NoCrossings => {
                write!(f, "n_crossings: wanted one or more; got 0; leave it out to have all of them")
            }
            Error::Threads { wanted } => {
                write!(f, "threads: wanted {wanted}; the system starts none; try fewer, or end other programs")
            }
            Error::OtherTerms { trajectory } => write!(
                f,
                "fields: wanted quadratic fields with the same terms; got one, number {trajectory}, with others than the first; \
                 integrate fields with other terms apart"
            ),
            Error::AcrossComponents => write!(
                f,
                "components: wanted a top, Taylor in double precision and no tangent vectors; got another run; try \
                 components=False"
            ),
            Error::UnknownInstruction { name } => write!(
                f,
                "instruction: wanted linear, product, quotient, power, sqrt, exp, log, sin, cos, sinh, cosh, tanh, \
                 asin, acos or atan; got {name:?}; write other functions with these"
            ),
            Error::InstructionOperands { name, wanted, got } => write!(
                f,
                "instruction {name}: wanted {} registers and {} numbers; got {} and {}; see the list of instructions",
                wanted.0, wanted.1, got.0, got.1
            ),
            Error::InstructionRegister { index, name, register, available } => write!(
                f,
                "instruction {index} ({name}): wanted registers below {available}; got {register}; \
                 an instruction reads components and results of earlier instructions only"
            ),
            Error::InstructionNumber { index, name, got } => write!(
                f,
                "instruction {index} ({name}): wanted finite numbers; got {got}; check the parameters of the system"
            ),
            Error::Outputs { wanted, got } => {
                write!(f, "outputs: wanted {wanted}, one register for each component; got {got}; name each derivative")
            }
            Error::SizeLimits { wanted, got } => write!(
                f,
                "size_limits: wanted {wanted} numbers that are not negative, and one that is not zero; got {got:?}; \
                 give infinity where there is no limit"
            ),
            Error::OutputRegister { component, register, available } => write!(
                f,
                "output {component}: wanted a register below {available}; got {register}; \
                 name a component or the result of an instruction"
            ),
            Error::Prime { got } => {
                write!(f, "prime: wanted an odd prime below 2^62; got {got}; try 2^61 - 1")
            }
            Error::MatrixColumns { got } => {
                write!(f, "n_columns: wanted at most {MOST_COLUMNS}; got {got}; split the matrix into blocks")
            }
            Error::MatrixEntries { wanted, got } => write!(
                f,
                "residues: wanted {wanted}, one for each column of an entry; got {got}; columns and residues go together"
            ),
            Error::MatrixStarts { n_entries } => write!(
                f,
                "indptr: wanted ascending numbers from 0 to {n_entries}, the number of entries; got others; it says where \
                 each row begins, and where the last one ends"
            ),
            Error::MatrixColumn { entry, n_columns, got } => {
                write!(f, "columns: wanted numbers below {n_columns}; got {got} at entry {entry}; columns count from 0")
            }
            Error::NotLagrange => write!(
                f,
                "LagrangeMap: wanted a top with I1 = I2 and with a and b along the third axis; got another one; \
                 try Splitting"
            ),
            Error::MethodForField => write!(
                f,
                "method: wanted one that applies to this kind of field; splitting needs a top or pieces, mixed precision \
                 a top, single precision a top or a quadratic field; try the Taylor method in double precision"
            ),
            Error::SimdNotAvailable { wanted } => write!(
                f,
                "LIEPOISSON_SIMD: wanted avx512, avx2, neon or scalar, on a processor that has it; got {wanted:?}; \
                 unset it to have the widest chosen"
            ),
        }
    }
}

impl std::error::Error for Error {}
