//! What is integrated: vector fields, asked for their power series.

mod convolution;
mod cover;
mod noise;
mod quadratic;
mod quadratics;
pub(crate) mod split_terms;
mod tape;
mod terms;
pub(crate) mod top;
mod tops;

pub use noise::{Noise, Noisy, Path};
pub use quadratic::Quadratic;
pub use quadratics::{LaneQuadratics, Quadratics};
pub use split_terms::{Ridge, SplitTerms};
pub(crate) use tape::OF_A_STEP;
pub use tape::{Enclosure, Functions, Instruction, Rounding, Tape};
pub use terms::Terms;
pub use top::Top;
pub use tops::{LaneTops, Tops};

use crate::error::Error;
use crate::lanes::{Body, IS_FUSED, Lane};

/// Most components that a field may have: far more than any system here, and few enough that lists of them fit into memory.
pub const MOST_COMPONENTS: usize = 1 << 20;

/// Refuses a number of components before anything of that length is made.
fn check_components(got: usize) -> Result<(), Error> {
    if (1..=MOST_COMPONENTS).contains(&got) { Ok(()) } else { Err(Error::Components { got }) }
}

/// Where a system lives.
pub trait Space: Sync {
    /// Number of components of the state.
    fn n_components(&self) -> usize;

    /// For how many trajectories it is made, where each has parameters of its own.
    fn n_trajectories(&self) -> Option<usize> {
        None
    }
}

impl<S: Space> Space for &S {
    fn n_components(&self) -> usize {
        (**self).n_components()
    }

    fn n_trajectories(&self) -> Option<usize> {
        (**self).n_trajectories()
    }
}

/// A space with a field of whose rates of change it is known how large they are.
pub trait Bounds: Space {
    /// What they are bounded by, if they are polynomials of degree two.
    fn majorant(&self) -> Option<Majorant>;

    /// The sizes of what adds up in each of them where components are within `rest` of those of `state`.
    fn terms(&self, state: &[f64], rest: &[f64], to: &mut Terms);
}

/// Bounds of a field of degree two: with `|x|` the largest absolute value of a component, every component of the part of
/// degree one is at most `linear |x|`, and of that of degree two `quadratic |x|^2`; sums of absolute coefficients, so they
/// hold for power series in place of numbers, too.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Majorant {
    /// Of the part of degree one.
    pub linear: f64,
    /// Of the part of degree two.
    pub quadratic: f64,
}

/// An autonomous vector field whose solutions are expanded in powers of time.
///
/// The coefficients of one order form a *row*: the state, then work quantities that the field derives from it, then
/// the same for each tangent vector (a field with tangent vectors attached is again a field). Rows follow one another
/// from order 0 upwards.
pub trait Field: Space {
    /// Registers that one group (the state, or one tangent vector) takes in a row: components and work quantities.
    fn group(&self) -> usize;

    /// The largest size with which each component of the state counts in the size of the state that tolerances are relative to: a
    /// turn of an angle, which is a point of a circle however large it has become. The last components may have zero, as time and its
    /// momentum have, in whose units the others are not: they count nowhere. The error of the very last of them, the momentum, is judged
    /// by its own size. Empty: all count as they are.
    fn size_limits(&self) -> &[f64] {
        &[]
    }

    /// How far the round-off of a state and of what is computed may move the rate of a component; zero if that is not known.
    fn round_off_of_rate(&self, _state: &[f64], _component: usize) -> f64 {
        0.0
    }

    /// Registers in a row with `n_tangents` tangent vectors.
    fn row(&self, n_tangents: usize) -> usize {
        self.group() * (1 + n_tangents)
    }

    /// Registers that the series up to `order` take in all: the rows, and after them what else the field keeps.
    fn registers(&self, n_tangents: usize, order: usize) -> usize {
        self.row(n_tangents) * (order + 1)
    }

    /// Completes row `k`: work quantities from the components.
    fn derive_work<V: Lane>(&self, rows: &mut [V], n_tangents: usize, k: usize);

    /// From the complete rows `0..=k` computes the components of row `k + 1`, of the state and of every tangent vector.
    fn extend<V: Lane>(&self, rows: &mut [V], n_tangents: usize, k: usize);

    /// From the components of row 0 all rows up to `order`, of which the last one has no work quantities.
    #[inline(always)]
    fn expand<V: Lane>(&self, rows: &mut [V], n_tangents: usize, order: usize) {
        for k in 0..order {
            self.derive_work(rows, n_tangents, k);
            self.extend(rows, n_tangents, k);
        }
    }

    /// Whether [`Field::run_compiled`] can do anything.
    const IS_COMPILED: bool = false;

    /// Runs `code` on `memory` as it has been compiled, once it was asked for often. False, and nothing that can be relied on, where it
    /// has not been; other code must have another key.
    #[inline(always)]
    fn run_compiled<V: Lane>(&self, _code: &impl Straight, _memory: &mut [V]) -> bool {
        false
    }

    /// The vector field itself: from `x`, the state and every tangent vector, their rates of change; in both the components
    /// of group after group, and nothing else.
    ///
    /// `work` has room for the rows 0 and 1 of a series. A function of its own for each register ([`Lane::outline`]): the code
    /// of a large field, once for every method that asks for it, would be compiled for minutes.
    #[inline(always)]
    fn rates<V: Lane>(&self, x: &[V], n_tangents: usize, work: &mut [V], rates: &mut [V])
    where
        Self: Sized,
    {
        V::outline(Rates { field: self, x, n_tangents, work, rates });
    }

    /// The rates at a point that is yet to be computed; `x` and `work` have room for what [`Field::rates`] wants.
    #[inline(always)]
    fn rates_at<V: Lane>(&self, point: &impl Point<V>, n_tangents: usize, x: &mut [V], work: &mut [V], rates: &mut [V])
    where
        Self: Sized,
    {
        point.write(x);
        self.rates(x, n_tangents, work, rates);
    }
}

/// Code that does the same at every call, without a look at its numbers.
pub trait Straight {
    /// What tells it from other code for the same field, below `2^61`.
    fn key(&self) -> u64;

    /// How often it asks for the rates of the field.
    fn n_rates(&self) -> usize;

    /// Does it: reads registers of the memory, and writes some.
    fn run<V: Lane>(&self, memory: &mut [V]);
}

/// A state with its tangent vectors, group after group, that a field can ask for in parts: what is computed in registers need not
/// go through memory.
pub trait Point<V> {
    /// The components from `first` on.
    fn components<const M: usize>(&self, first: usize) -> [V; M];

    /// Writes all components.
    fn write(&self, to: &mut [V]);
}

/// A field as each block of trajectories holds it: shared, or with the parameters of its own trajectories.
pub trait Instantiate: Space {
    /// What a block holds.
    type Instance<'f>: Instance
    where
        Self: 'f;

    /// Makes it.
    fn instantiate(&self) -> Self::Instance<'_>;
}

/// What a block holds of a field.
pub trait Instance: Field {
    /// A trajectory takes a lane: where each has parameters of its own, they are those of this lane from now on.
    fn assign(&mut self, lane: usize, trajectory: usize);
}

impl<F: Field> Instance for &F {
    fn assign(&mut self, _lane: usize, _trajectory: usize) {}
}

impl<F: Field> Field for &F {
    const IS_COMPILED: bool = F::IS_COMPILED;

    #[inline(always)]
    fn run_compiled<V: Lane>(&self, code: &impl Straight, memory: &mut [V]) -> bool {
        (**self).run_compiled(code, memory)
    }

    fn group(&self) -> usize {
        (**self).group()
    }

    fn size_limits(&self) -> &[f64] {
        (**self).size_limits()
    }

    fn round_off_of_rate(&self, state: &[f64], component: usize) -> f64 {
        (**self).round_off_of_rate(state, component)
    }

    fn registers(&self, n_tangents: usize, order: usize) -> usize {
        (**self).registers(n_tangents, order)
    }

    #[inline(always)]
    fn derive_work<V: Lane>(&self, rows: &mut [V], n_tangents: usize, k: usize) {
        (**self).derive_work(rows, n_tangents, k);
    }

    #[inline(always)]
    fn extend<V: Lane>(&self, rows: &mut [V], n_tangents: usize, k: usize) {
        (**self).extend(rows, n_tangents, k);
    }

    #[inline(always)]
    fn expand<V: Lane>(&self, rows: &mut [V], n_tangents: usize, order: usize) {
        (**self).expand(rows, n_tangents, order);
    }

    #[inline(always)]
    fn rates<V: Lane>(&self, x: &[V], n_tangents: usize, work: &mut [V], rates: &mut [V]) {
        (**self).rates(x, n_tangents, work, rates);
    }

    #[inline(always)]
    fn rates_at<V: Lane>(
        &self,
        point: &impl Point<V>,
        n_tangents: usize,
        x: &mut [V],
        work: &mut [V],
        rates: &mut [V],
    ) {
        (**self).rates_at(point, n_tangents, x, work, rates);
    }
}

/// Orders up to this one are divided with the remainder.
const CAREFUL_ORDER: usize = 8;

/// Whether the rounded inverse of `order` would leave a bias in the sum of a series.
#[inline(always)]
pub(crate) fn needs_remainder(order: usize) -> bool {
    order <= CAREFUL_ORDER && !order.is_power_of_two()
}

/// `sum / order`, a coefficient of a series from the one before.
///
/// The product with the inverse of 3, 5, 6 or 7 has a relative error of the same sign in every step. Over a long time that
/// is a drift: the errors of the Casimirs of a top grew as `t^0.8` instead of `t^0.5`. So the remainder of the division,
/// which the fused operation gives exactly, corrects the quotient; where that is not to be had, a division takes more time and is
/// as good. Terms of higher order are too small for it to matter.
#[inline(always)]
pub(crate) fn over<V: Lane>(sum: V, order: usize) -> V {
    if !IS_FUSED && needs_remainder(order) {
        return sum.div(V::splat(order as f64));
    }
    let inverse = V::splat(1.0 / order as f64);
    let quotient = sum.mul(inverse);
    if needs_remainder(order) {
        quotient.neg_mul_add(V::splat(order as f64), sum).mul_add(inverse, quotient)
    } else {
        quotient
    }
}

/// The same without a bias at any order, so that orders differ in numbers alone: they share compiled code. The inverse is a number and
/// what that lacks, so the quotient is off by half a unit of the last place and 2^-53 of one.
#[inline(always)]
pub(crate) fn over_uniformly<V: Lane>(sum: V, order: usize) -> V {
    let order = order as f64;
    if order == 1.0 {
        return sum;
    }
    if !IS_FUSED {
        return sum.div(V::splat(order));
    }
    let inverse = 1.0 / order;
    let lacking = f64::mul_add(-inverse, order, 1.0) * inverse;
    sum.mul_add(V::splat(inverse), sum.mul(V::splat(lacking)))
}

/// The vector field as the first coefficient of its series.
struct Rates<'a, F, V> {
    field: &'a F,
    x: &'a [V],
    n_tangents: usize,
    work: &'a mut [V],
    rates: &'a mut [V],
}

impl<F: Field, V: Lane> Body for Rates<'_, F, V> {
    #[inline(always)]
    fn run(self) {
        let Rates { field, x, n_tangents, work, rates } = self;
        let (row, group, n) = (field.row(n_tangents), field.group(), field.n_components());
        for (to, from) in work.chunks_mut(group).zip(x.chunks_exact(n)) {
            to[..n].copy_from_slice(from);
        }
        field.derive_work(work, n_tangents, 0);
        field.extend(work, n_tangents, 0);
        for (to, from) in rates.chunks_exact_mut(n).zip(work[row..].chunks(group)) {
            to.copy_from_slice(&from[..n]);
        }
    }
}

/// A field that keeps its meaning in single precision: polynomials do, elementary functions are written for doubles.
pub trait SinglePrecision {}
