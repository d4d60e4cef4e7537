//! Splitting methods: compositions of the exact flows of split terms of a Hamiltonian, of order 2, 4, 6 and 8.
//!
//! Every flow is a Poisson map, so a method keeps all Casimirs for any step, is a Poisson map itself, and keeps a nearby
//! energy for exponentially long times. Tangent vectors are advanced by the derivative of the numerical map.
//!
//! # References
//! McLachlan and Quispel, *Splitting methods*, Acta Numerica 11 (2002); McLachlan, *On the numerical integration of
//! ordinary differential equations by symmetric composition methods*, SIAM J. Sci. Comput. 16 (1995): splittings into
//! two split terms and compositions with the adjoint have the same conditions on their coefficients.

mod coefficients;
mod noise;
mod rotation;
mod split_terms;
mod top;

use crate::error::Error;
use crate::field::Space;
use crate::lanes::{Body, Lane, Number, Wide};
use crate::method::variational::spread;
use crate::method::{AnyMethod, Block, Method, Options, Precision, Series, Single, StepOutcome, Stepping};
use coefficients::{ORDERS, Scheme};
pub(super) use top::DiscreteLagrange;

/// Steps between two looks at whether the numbers are finite; the work between two turns of the ensemble's loop.
const MOST_REPEATS: u64 = 64;

/// The method as data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Splitting {
    order: usize,
    step: f64,
    max_steps: u64,
}

impl Splitting {
    /// The method of order 2 (Strang), 4 and 6 (Blanes and Moan) or 8 (Kahan and Li), with equal steps of at most `step`
    /// in units of time that end at every wanted time, and at most `max_steps` of them per trajectory.
    ///
    /// # Errors
    /// Order not one of 2, 4, 6, 8; a step that is not positive and finite.
    pub fn new(order: usize, step: f64, max_steps: u64) -> Result<Splitting, Error> {
        if !ORDERS.contains(&order) {
            return Err(Error::SplittingOrder { got: order });
        }
        if !(step.is_finite() && step > 0.0) {
            return Err(Error::StepSize { got: step });
        }
        Ok(Splitting { order, step, max_steps })
    }

    /// The method with the options `order`, `step`, `precision` ("single") and `max_steps`.
    pub(crate) fn with_options(options: &Options) -> Result<AnyMethod, Error> {
        let method = Splitting::new(options.order()?.unwrap_or(4), options.step()?, options.max_steps()?)?;
        Ok(if options.says("precision", "single") { Single(method).into() } else { method.into() })
    }

    /// Order of the composition.
    pub fn order(&self) -> usize {
        self.order
    }
}

/// Where a lane is on the path of its noise, and whether it cannot go on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PathIndex {
    /// The number of the trajectory.
    pub trajectory: usize,
    /// The steps that it has taken.
    pub n_steps: u64,
    /// Whether a step was too large for the damping.
    pub is_too_large: bool,
}

/// A field whose Hamiltonian is a sum of split terms with known flows.
pub trait Split: Space {
    /// Takes `repeats` steps of each lane's size: `groups` holds the state and then the tangent vectors. `paths` are the places of
    /// the lanes where there is noise.
    fn advance<V: Lane>(&self, scheme: &Scheme, groups: &mut [V], sizes: &[f64], repeats: u64, paths: &mut [PathIndex]);
}

impl<F: Split> Split for &F {
    fn advance<V: Lane>(
        &self,
        scheme: &Scheme,
        groups: &mut [V],
        sizes: &[f64],
        repeats: u64,
        paths: &mut [PathIndex],
    ) {
        (**self).advance(scheme, groups, sizes, repeats, paths);
    }
}

impl<F: Split> Method<F> for Splitting {
    fn block<'f, V: Wide>(&self, field: &'f F, n_tangents: usize) -> Box<dyn Block + 'f> {
        Box::new(SplittingBlock::<&F, V>::new(field, *self, n_tangents))
    }

    fn registers(&self, field: &F, n_tangents: usize) -> usize {
        registers(field.n_components(), n_tangents)
    }

    fn max_steps(&self) -> u64 {
        self.max_steps
    }
}

impl<F: Split> Method<F> for Single<Splitting> {
    fn block<'f, V: Wide>(&self, field: &'f F, n_tangents: usize) -> Box<dyn Block + 'f> {
        Box::new(SplittingBlock::<&F, V::Narrow>::new(field, self.0, n_tangents))
    }

    fn registers(&self, field: &F, n_tangents: usize) -> usize {
        registers(field.n_components(), n_tangents)
    }

    fn max_steps(&self) -> u64 {
        self.0.max_steps
    }
}

/// The groups, the same before the last steps, and the vectors that a flow needs.
fn registers(n_components: usize, n_tangents: usize) -> usize {
    n_components * (2 * (1 + n_tangents) + 3)
}

/// Trajectories with their tangent vectors.
pub(super) struct SplittingBlock<F, V> {
    field: F,
    scheme: Scheme,
    step: f64,
    /// State and tangent vectors, one after the other.
    groups: Vec<V>,
    /// The same before the last steps.
    before: Vec<V>,
    paths: Vec<PathIndex>,
}

impl<F: Split, V: Lane> SplittingBlock<F, V> {
    #[inline(always)]
    pub(super) fn new(field: F, method: Splitting, n_tangents: usize) -> Self {
        let groups = vec![V::splat(0.0); field.n_components() * (1 + n_tangents)];
        let scheme = Scheme::of_order(method.order);
        let paths = vec![PathIndex::default(); V::WIDTH];
        SplittingBlock { field, scheme, step: method.step, before: groups.clone(), groups, paths }
    }

    fn group(&self, group: usize) -> std::ops::Range<usize> {
        let n = self.field.n_components();
        group * n..(group + 1) * n
    }
}

impl<F: Split, V: Lane> Block for SplittingBlock<F, V> {
    fn n_lanes(&self) -> usize {
        V::WIDTH
    }

    fn stepping(&self) -> Stepping {
        Stepping::Fixed { longest: self.step, most_repeats: MOST_REPEATS }
    }

    fn precision(&self) -> Precision {
        Precision::of::<V::Number>()
    }

    fn load(&mut self, lane: usize, trajectory: usize, group: usize, values: &[f64]) {
        if group == 0 {
            self.paths[lane] = PathIndex { trajectory, ..PathIndex::default() };
        }
        let at = self.group(group);
        for (register, &value) in self.groups[at].iter_mut().zip(values) {
            register.set(lane, value);
        }
    }

    fn read(&self, lane: usize, group: usize, values: &mut [f64]) {
        for (register, value) in self.groups[self.group(group)].iter().zip(values) {
            *value = register.get(lane);
        }
    }

    fn prepare(&mut self, _ahead: &[f64], longest: &mut [f64]) {
        longest.fill(f64::INFINITY);
    }

    fn advance(&mut self, sizes: &[f64], repeats: u64, outcomes: &mut [StepOutcome]) {
        self.before.copy_from_slice(&self.groups);
        self.field.advance(&self.scheme, &mut self.groups, sizes, repeats, &mut self.paths);
        let mut all_finite = true;
        V::outline(Finite { groups: &self.groups, answer: &mut all_finite });
        outcomes.fill(StepOutcome::Taken);
        for path in &mut self.paths {
            path.n_steps += repeats;
        }
        if all_finite && !self.paths.iter().any(|path| path.is_too_large) {
            return;
        }
        for (lane, outcome) in outcomes.iter_mut().enumerate() {
            let is_too_large = std::mem::take(&mut self.paths[lane].is_too_large);
            let is_finite = self.groups.iter().all(|register| register.get(lane).is_finite());
            if is_too_large || !is_finite {
                *outcome = if is_too_large { StepOutcome::TooLarge } else { StepOutcome::NotFinite };
                self.paths[lane].n_steps -= repeats;
                for (register, before) in self.groups.iter_mut().zip(&self.before) {
                    register.as_scalars_mut()[lane] = before.as_scalars()[lane];
                }
            }
        }
    }

    fn norms(&self, group: usize, norms: &mut [f64]) {
        V::outline(Norms { group: &self.groups[self.group(group)], norms });
    }

    fn scale_tangent(&mut self, lane: usize, group: usize, exponent: i32) {
        let at = self.group(group);
        for register in &mut self.groups[at] {
            register.set(lane, libm::scalbn(register.get(lane), exponent));
        }
    }

    fn series(&self) -> Option<&dyn Series> {
        None
    }
}

/// Whether all numbers are finite.
struct Finite<'b, V> {
    groups: &'b [V],
    answer: &'b mut bool,
}

impl<V: Lane> Body for Finite<'_, V> {
    #[inline(always)]
    fn run(self) {
        // zero times infinity is NaN
        let zero = V::splat(0.0);
        let defect = self.groups.iter().fold(zero, |defect, register| register.mul_add(zero, defect));
        *self.answer = defect.as_scalars().iter().all(|lane| lane.to_f64() == 0.0);
    }
}

/// Sizes of one group of all lanes: sums of the absolute values of the components, which do not overflow before these.
struct Norms<'b, V> {
    group: &'b [V],
    norms: &'b mut [f64],
}

impl<V: Lane> Body for Norms<'_, V> {
    #[inline(always)]
    fn run(self) {
        let norms = &mut self.norms[..V::WIDTH];
        norms.fill(0.0);
        for register in self.group {
            for (norm, lane) in norms.iter_mut().zip(register.abs().as_scalars()) {
                *norm += lane.to_f64();
            }
        }
    }
}
