//! Fields and methods that a caller chooses when the program runs, and which method applies to which field.

use crate::analysis::section::SectionEnsemble;
use crate::ensemble::{AnyEnsemble, Integrator};
use crate::error::Error;
use crate::field::{Bounds, Noise, Noisy, Quadratic, Quadratics, Space, SplitTerms, Tape, Top, Tops};
use crate::lanes::Simd;
pub use crate::method::AnyMethod;
use crate::method::{LagrangeMap, Taylor, runge_kutta_is_cheaper};
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
    NoisyTop(Noisy<Top>),
    NoisyTerms(Noisy<SplitTerms>),
}

/// Makes of the table of methods, in [`crate::method`], their files, one type for all of them, and what applies to what.
macro_rules! methods {
    ($(
        $name:literal $file:ident::$method:ident for [$($field:ident)*] outside the browser also [$($more:ident)*];
    )+ variants: $(
        $variant:ident($type:ty) for [$($of:ident)*];
    )+) => {
        $(mod $file;
        pub use $file::$method;)+

        /// A method of any kind.
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[allow(missing_docs)] // each is what its type says
        pub enum AnyMethod {
            $($method($method),)+
            $($variant($type),)+
        }

        $(impl From<$method> for AnyMethod {
            fn from(method: $method) -> AnyMethod {
                AnyMethod::$method(method)
            }
        })+

        $(impl From<$type> for AnyMethod {
            fn from(method: $type) -> AnyMethod {
                AnyMethod::$variant(method)
            }
        })+

        impl AnyMethod {
            /// The names by which methods are chosen, and whether they are in the browser, too.
            pub const NAMES: &[(&str, bool)] = &[$(($name, !<[&str]>::is_empty(&[$(stringify!($field)),*])),)+];

            /// The method of this name with these options; none where no method has the name.
            pub fn named(name: &str, options: &Options) -> Option<Result<AnyMethod, Error>> {
                match name {
                    $($name => Some($method::with_options(options)),)+
                    _ => None,
                }
            }

            /// Its order, unless it depends on the field: [`AnyField::order`].
            pub(crate) fn order(self) -> usize {
                match self {
                    $(AnyMethod::$method(method) => method.order(),)+
                    $(AnyMethod::$variant(method) => method.0.order(),)+
                }
            }
        }

        impl AnyField {
            #[inline]
            pub(crate) fn in_table(&self, method: AnyMethod) -> Result<Arc<dyn Integrator + '_>, Error> {
                match (self, method) {
                    $($((AnyField::$field(field), AnyMethod::$method(method)) => Ok(Arc::new(Integration { field, method })),)*)+
                    $($(
                        #[cfg(not(target_family = "wasm"))]
                        (AnyField::$more(field), AnyMethod::$method(method)) => Ok(Arc::new(Integration { field, method })),
                    )*)+
                    $($(
                        #[cfg(not(target_family = "wasm"))]
                        (AnyField::$of(field), AnyMethod::$variant(method)) => Ok(Arc::new(Integration { field, method })),
                    )*)+
                    _ => Err(Error::MethodForField),
                }
            }
        }
    };
}
pub(crate) use methods;

impl AnyField {
    /// The field with noise.
    ///
    /// # Errors
    /// A field that no splitting method applies to, noise of another dimension.
    pub fn with_noise(&self, noise: Noise) -> Result<AnyField, Error> {
        match self {
            AnyField::Top(field) => Noisy::new(*field, noise).map(AnyField::NoisyTop),
            AnyField::SplitTerms(field) => Noisy::new(field.clone(), noise).map(AnyField::NoisyTerms),
            _ => Err(Error::MethodForField),
        }
    }

    /// Number of components of the state.
    pub fn n_components(&self) -> usize {
        match self {
            AnyField::Top(field) => field.n_components(),
            AnyField::Tops(field) => field.n_components(),
            AnyField::Quadratic(field) => field.n_components(),
            AnyField::Quadratics(field) => field.n_components(),
            AnyField::Tape(field) => field.n_components(),
            AnyField::SplitTerms(field) => field.n_components(),
            AnyField::NoisyTop(field) => field.n_components(),
            AnyField::NoisyTerms(field) => field.n_components(),
        }
    }

    /// What its runs have been computed with so far, given the instruction set: the name of that, or of code compiled for it.
    pub fn kernel(&self, simd: Simd) -> &'static str {
        match self {
            AnyField::Quadratic(field) => field.kernel(simd),
            AnyField::Tape(field) => field.kernel(simd),
            _ => simd.name(),
        }
    }

    /// The order of a method for this field.
    pub fn order(&self, method: AnyMethod) -> usize {
        match (self, method) {
            (AnyField::Tape(tape), AnyMethod::Taylor(taylor)) => taylor.for_tape(tape).order(),
            _ => method.order(),
        }
    }

    /// Whether, of the two adaptive methods, that of Runge and Kutta takes less work at a tolerance, by counted operations; not for
    /// fields to which it does not apply.
    ///
    /// # Errors
    /// Tolerance outside `[2^-53, 0.1]`.
    pub fn prefers_runge_kutta(&self, tolerance: f64) -> Result<bool, Error> {
        let taylor = Taylor::new(tolerance, None, 1)?;
        Ok(match self {
            AnyField::Top(field) => runge_kutta_is_cheaper(field, taylor),
            AnyField::Quadratic(field) => runge_kutta_is_cheaper(field, taylor),
            AnyField::Tape(field) => runge_kutta_is_cheaper(field, taylor),
            _ => false,
        })
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
        if let (AnyField::Top(top), AnyMethod::LagrangeMap(_)) = (self, method)
            && !LagrangeMap::applies_to(top)
        {
            return Err(Error::NotLagrange);
        }
        self.in_table(method)
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
