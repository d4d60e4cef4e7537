//! Fields and methods that a caller chooses when the program runs, and which method applies to which field.

use crate::analysis::section::SectionEnsemble;
use crate::ensemble::{AnyEnsemble, Integration, Integrator};
use crate::error::Error;
use crate::field::{Bounds, Quadratic, Quadratics, Space, SplitTerms, Tape, Top, Tops};
use crate::method::{AcrossComponents, Gauss, LagrangeMap, MixedTaylor, RungeKutta, Single, Splitting, Taylor};
use std::sync::Arc;

/// A vector field of any kind.
#[derive(Clone, Debug)]
#[allow(missing_docs)] // each is what its type says
pub enum AnyField {
    Top(Top),
    Tops(Tops),
    Quadratic(Quadratic),
    Quadratics(Quadratics),
    Tape(Tape),
    SplitTerms(SplitTerms),
}

/// A method of any kind.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)] // each is what its type says
pub enum AnyMethod {
    Taylor(Taylor),
    MixedTaylor(MixedTaylor),
    AcrossComponents(AcrossComponents),
    RungeKutta(RungeKutta),
    SingleRungeKutta(Single<RungeKutta>),
    Splitting(Splitting),
    SingleSplitting(Single<Splitting>),
    Gauss(Gauss),
    LagrangeMap(LagrangeMap),
}

impl AnyMethod {
    /// Its order.
    pub fn order(self) -> usize {
        match self {
            AnyMethod::Taylor(method)
            | AnyMethod::MixedTaylor(MixedTaylor(method))
            | AnyMethod::AcrossComponents(AcrossComponents(method)) => method.order(),
            AnyMethod::RungeKutta(_) | AnyMethod::SingleRungeKutta(_) => 8,
            AnyMethod::Splitting(method) | AnyMethod::SingleSplitting(Single(method)) => method.order(),
            AnyMethod::Gauss(method) => method.order(),
            AnyMethod::LagrangeMap(_) => 2,
        }
    }
}

impl AnyField {
    /// Number of components of the state.
    pub fn n_components(&self) -> usize {
        match self {
            AnyField::Top(field) => field.n_components(),
            AnyField::Tops(field) => field.n_components(),
            AnyField::Quadratic(field) => field.n_components(),
            AnyField::Quadratics(field) => field.n_components(),
            AnyField::Tape(field) => field.n_components(),
            AnyField::SplitTerms(field) => field.n_components(),
        }
    }

    /// The field with a method for it.
    ///
    /// Inlined, so that the kernels are compiled with the program that asks for them. That for the browser asks for Taylor and
    /// splitting alone: with all methods it would be several times as large.
    ///
    /// # Errors
    /// A method that does not apply to this field.
    #[inline]
    pub fn with(&self, method: AnyMethod) -> Result<Arc<dyn Integrator + '_>, Error> {
        macro_rules! table {
            ({ $($field:ident: $($method:ident)+;)+ } not in the browser { $($more:ident: $($other:ident)+;)+ }) => {
                match (self, method) {
                    $($((AnyField::$field(field), AnyMethod::$method(method)) => Ok(Arc::new(Integration { field, method })),)+)+
                    $($(
                        #[cfg(not(target_family = "wasm"))]
                        (AnyField::$more(field), AnyMethod::$other(method)) => Ok(Arc::new(Integration { field, method })),
                    )+)+
                    _ => Err(Error::MethodForField),
                }
            };
        }
        if let (AnyField::Top(top), AnyMethod::LagrangeMap(_)) = (self, method)
            && !LagrangeMap::applies_to(top)
        {
            return Err(Error::NotLagrange);
        }
        table!({
            Top: Taylor Splitting;
            Quadratic: Taylor;
            Tape: Taylor;
            SplitTerms: Splitting;
        } not in the browser {
            Top: MixedTaylor AcrossComponents RungeKutta SingleRungeKutta SingleSplitting Gauss LagrangeMap;
            Tops: Taylor MixedTaylor;
            Quadratic: RungeKutta SingleRungeKutta Gauss;
            Quadratics: Taylor;
            Tape: RungeKutta Gauss;
        })
    }

    /// What a section is made of.
    ///
    /// # Errors
    /// A field whose terms are not known, a method other than Taylor's.
    #[inline]
    pub fn section<'a>(
        &'a self,
        method: AnyMethod,
        states: &'a [f64],
        times: &'a [f64],
    ) -> Result<SectionEnsemble<'a>, Error> {
        let field: &dyn Bounds = match (self, method) {
            (AnyField::Top(field), AnyMethod::Taylor(_)) => field,
            (AnyField::Quadratic(field), AnyMethod::Taylor(_)) => field,
            (AnyField::Tape(field), AnyMethod::Taylor(_)) => field,
            _ => return Err(Error::MethodForField),
        };
        Ok(SectionEnsemble::new(AnyEnsemble::new(self.with(method)?, states, &[], 0, times), field))
    }
}
