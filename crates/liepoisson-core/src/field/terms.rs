//! What adds up in the rates of change of a field, component by component.

use super::Enclosure;

/// The sizes of what adds up in each rate of change: where they are far above the rate, its terms cancel.
///
/// Of a field of degree two they are the sums of the absolute values of its terms, apart for each degree but the lowest, so that
/// they bound its growth in any units of the components. Of any other field they are its round-off, in units of the last place.
#[derive(Clone, Debug, Default)]
pub struct Terms {
    /// Of the part of degree one, or of all of a field that is no such polynomial.
    pub linear: Vec<f64>,
    /// Of the part of degree two.
    pub quadratic: Vec<f64>,
    pub(super) work: Vec<Enclosure>,
}

impl Terms {
    /// Forgets what it has, for so many components.
    pub(super) fn clear(&mut self, n_components: usize) {
        for sums in [&mut self.linear, &mut self.quadratic] {
            sums.clear();
            sums.resize(n_components, 0.0);
        }
    }
}
