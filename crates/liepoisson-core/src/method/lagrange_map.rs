//! The Lagrange top in discrete time.

use crate::error::Error;
use crate::field::Top;
use crate::lanes::Wide;
use crate::method::splitting::{DiscreteLagrange, SplittingBlock};
use crate::method::{AnyMethod, Block, Method, Options, Splitting};

/// An integrable top in discrete time: the (charged, twisted) Lagrange top, `I1 = I2` with `a` and `b` along the third axis.
///
/// Strang's splitting, but alpha and beta turn about l by `2 arctan(h |l| / (2 I1))` instead of `h |l| / I1`, which is the
/// flow of another function of `|l|`: so it is explicit, a Poisson map, and keeps all Casimirs and `l3`. With `s = a3 I1`,
/// `u = eps a3^2 I1^2`, `k = -h/(2 I1)` and `e` the axis, after a turn and before the next kick,
/// ```text
/// L(z) = (e + k l x e + k^2 s alpha) + (l + k^2 u beta)/z + s alpha/z^2 + u beta/z^3
/// ```
/// becomes `(1 + k z e) L(z) (1 + k z e)^-1` in a step (in space, vectors as quaternions). So the coefficients of `|L(z)|^2`
/// are constant to round-off: a deformed energy and a deformed `P = l.alpha + eps I1 a3 beta3` are among them. If b is
/// not zero, alpha stands for `alpha + (b3/a3) beta`. For `eps = 0` it is the discrete top of Bobenko and Suris.
///
/// # References
/// Bobenko and Suris, *Discrete time Lagrangian mechanics on Lie groups, with an application to the Lagrange top*,
/// Commun. Math. Phys. 204 (1999), for the ordinary top; the twisted one was derived from this Lax pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LagrangeMap(Splitting);

impl LagrangeMap {
    /// The map with equal steps of at most `step` that end at every wanted time.
    ///
    /// # Errors
    /// A step that is not positive and finite.
    pub fn new(step: f64, max_steps: u64) -> Result<LagrangeMap, Error> {
        Splitting::new(2, step, max_steps).map(LagrangeMap)
    }

    /// The map with the options `step` and `max_steps`.
    pub(crate) fn with_options(options: &Options) -> Result<AnyMethod, Error> {
        Ok(LagrangeMap::new(options.step()?, options.max_steps()?)?.into())
    }

    /// Order of the map.
    pub fn order(&self) -> usize {
        self.0.order()
    }

    /// Whether the top is one that this is made for.
    pub fn applies_to(top: &Top) -> bool {
        DiscreteLagrange::applies_to(top)
    }
}

impl Method<Top> for LagrangeMap {
    /// # Panics
    /// The top is not one that [`LagrangeMap::applies_to`].
    fn block<'f, V: Wide>(&self, field: &'f Top, n_tangents: usize) -> Box<dyn Block + 'f> {
        assert!(LagrangeMap::applies_to(field), "a Lagrange top: I1 = I2, a and b along the third axis");
        Box::new(SplittingBlock::<_, V>::new(DiscreteLagrange(*field), self.0, n_tangents))
    }

    fn registers(&self, field: &Top, n_tangents: usize) -> usize {
        self.0.registers(field, n_tangents)
    }

    fn max_steps(&self) -> u64 {
        Method::<Top>::max_steps(&self.0)
    }
}
