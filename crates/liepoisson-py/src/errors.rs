//! Refusals and panics of the core as exceptions of `liepoisson.errors`.

use liepoisson_core::error::Error;
use pyo3::prelude::*;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// A refusal of the core as one of the errors of `liepoisson.errors`. Every kind is named, so that a new one gets a class.
pub(crate) fn translate(error: Error) -> PyErr {
    let class = match error {
        Error::Memory { .. } => "MemoryLimitError",
        Error::Threads { .. } => "ThreadLimitError",
        Error::Length { .. }
        | Error::Outputs { .. }
        | Error::InstructionOperands { .. }
        | Error::MatrixEntries { .. }
        | Error::MatrixStarts { .. } => "ShapeError",
        Error::UnknownInstruction { .. } => "UnknownNameError",
        Error::MethodForField => "UnsupportedFieldError",
        Error::Inertia { .. }
        | Error::ParameterNotFinite { .. }
        | Error::ComponentIndex { .. }
        | Error::Tolerance { .. }
        | Error::SingleTolerance { .. }
        | Error::StepSize { .. }
        | Error::Stages { .. }
        | Error::Order { .. }
        | Error::SplittingOrder { .. }
        | Error::MethodOption { .. }
        | Error::Times { .. }
        | Error::TangentVector { .. }
        | Error::Components { .. }
        | Error::Direction { .. }
        | Error::NoCrossings
        | Error::AcrossComponents
        | Error::OtherTerms { .. }
        | Error::NotLagrange
        | Error::InstructionRegister { .. }
        | Error::InstructionNumber { .. }
        | Error::OutputRegister { .. }
        | Error::Prime { .. }
        | Error::RationalText { .. }
        | Error::RationalSize
        | Error::MatrixColumns { .. }
        | Error::MatrixColumn { .. }
        | Error::SizeLimits { .. }
        | Error::SimdNotAvailable { .. } => "ParameterError",
    };
    exception(class, &error.to_string())
}

pub(crate) fn exception(class: &str, message: &str) -> PyErr {
    Python::attach(|py| {
        let class = py.import("liepoisson.errors").and_then(|errors| errors.getattr(class));
        match class.and_then(|class| class.call1((message,))) {
            Ok(refusal) => PyErr::from_value(refusal),
            Err(failure) => failure,
        }
    })
}

/// A panic of the core, which is a mistake in it, as `liepoisson.errors.CoreError`.
pub(crate) fn broken(panic: &(dyn Any + Send)) -> PyErr {
    let message = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
    let message = message.unwrap_or("without a message");
    exception(
        "CoreError",
        &format!(
            "the compiled core stopped: {message}; this is a mistake in liepoisson, please report how it came about"
        ),
    )
}

/// Runs `work`; a panic becomes an exception.
pub(crate) fn guarded<R>(work: impl FnOnce() -> Result<R, Error>) -> PyResult<R> {
    match catch_unwind(AssertUnwindSafe(work)) {
        Ok(result) => result.map_err(translate),
        Err(panic) => Err(broken(&*panic)),
    }
}
