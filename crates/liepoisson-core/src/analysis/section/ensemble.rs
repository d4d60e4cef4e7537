//! The trajectories of a section, with what is known of the errors of their series.

use crate::ensemble::{AnyEnsemble, Ensemble};
use crate::field::{Bounds, Majorant};
use crate::method::{Method, Taylor};

/// An ensemble whose errors can be bounded or estimated along its steps: one of Taylor's method, and of a field whose terms are
/// known.
#[derive(Clone)]
pub struct SectionEnsemble<'a> {
    pub(super) any: AnyEnsemble<'a>,
    pub(super) field: &'a dyn Bounds,
    pub(super) majorant: Option<Majorant>,
}

impl<'a> SectionEnsemble<'a> {
    /// An ensemble of Taylor's method and this field.
    pub(crate) fn new(any: AnyEnsemble<'a>, field: &'a dyn Bounds) -> SectionEnsemble<'a> {
        SectionEnsemble { any, field, majorant: field.majorant() }
    }

    /// Number of trajectories.
    pub fn n_trajectories(&self) -> usize {
        self.any.n_trajectories()
    }
}

impl<'a, F: Bounds> From<&Ensemble<'a, F, Taylor>> for SectionEnsemble<'a>
where
    Taylor: Method<F>,
{
    fn from(ensemble: &Ensemble<'a, F, Taylor>) -> SectionEnsemble<'a> {
        SectionEnsemble::new(ensemble.into(), ensemble.field)
    }
}
