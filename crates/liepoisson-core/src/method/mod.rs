//! How a field is advanced in time: one method per file, each a [`Method`] that makes a [`Block`].

mod cheaper;
mod components;
mod dop853;
mod estimates;
mod gauss_legendre;
mod known_terms;
mod mixed_taylor;
mod momentum_of_time;
mod options;
mod overview;
mod series_sum;
mod step_end;
mod taylor_of_tape;
mod variational;

pub(crate) use cheaper::runge_kutta_is_cheaper;
pub use components::AcrossComponents;
pub use mixed_taylor::MixedTaylor;
pub use options::{Options, Setting};
pub(crate) use overview::FIRST_TERMS;
pub use overview::{Overview, SeriesSums};
pub(crate) use series_sum::sum_series;
pub use splitting::{PathIndex, Split};
pub(crate) use taylor::MAX_ORDER;

use crate::choice::{AnyField, methods};
use crate::ensemble::{Integration, Integrator};
use crate::error::Error;
use crate::lanes::{Number, Simd, Task, Wide, dispatch, dispatch_widest};
use std::collections::TryReserveError;
use std::sync::Arc;

// Each by the name that it has in Python, where `numeric/method` has a file of that name, with the fields that it applies to. It has
// `with_options` and `order`.
methods! {
    "taylor" taylor::Taylor for [Top Quadratic Tape] outside the browser also [Tops Quadratics];
    "runge-kutta" runge_kutta::RungeKutta for [] outside the browser also [Top Quadratic Tape];
    "splitting" splitting::Splitting for [Top SplitTerms] outside the browser also [NoisyTop NoisyTerms];
    "gauss" gauss::Gauss for [] outside the browser also [Top Quadratic Tape];
    "lagrange-map" lagrange_map::LagrangeMap for [] outside the browser also [Top];
    // of these, outside the browser:
    variants:
    MixedTaylor(MixedTaylor) for [Top Tops];
    AcrossComponents(AcrossComponents) for [Top];
    SingleRungeKutta(Single<RungeKutta>) for [Top Quadratic];
    SingleSplitting(Single<Splitting>) for [Top];
}

/// A method of integration, for vector fields of type `F`.
pub trait Method<F>: Copy + Send + Sync {
    /// Room for as many trajectories as the registers `V` hold, at rest at the origin.
    fn block<'f, V: Wide>(&self, field: &'f F, n_tangents: usize) -> Box<dyn Block + 'f>;

    /// Registers that such a block takes, about: what is asked for before it is made.
    fn registers(&self, field: &F, n_tangents: usize) -> usize;

    /// Most steps that a trajectory may take.
    fn max_steps(&self) -> u64;

    /// [`Method::block`] with the registers of `simd`.
    fn block_for<'f>(&self, simd: Simd, field: &'f F, n_tangents: usize) -> Box<dyn Block + 'f>
    where
        Self: Sized,
    {
        let task = MakeBlock { method: self, field, n_tangents };
        // In WebAssembly a register of two numbers was measured to take as long as one number, so that one kernel does for both;
        // with the other the program would be twice as large.
        if cfg!(all(target_arch = "wasm32", target_feature = "simd128")) {
            return dispatch_widest(task);
        }
        dispatch(simd, task)
    }
}

/// The same method in single precision: twice as many trajectories in a register.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Single<M>(pub M);

struct MakeBlock<'m, 'f, M, F> {
    method: &'m M,
    field: &'f F,
    n_tangents: usize,
}

impl<'f, F, M: Method<F>> Task for MakeBlock<'_, 'f, M, F> {
    type Output = Box<dyn Block + 'f>;

    fn run<V: Wide>(self) -> Box<dyn Block + 'f> {
        self.method.block::<V>(self.field, self.n_tangents)
    }
}

/// How the steps of a block come about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stepping {
    /// Each step is as long as its power series allows, and the series gives the state at any time inside it.
    Series,
    /// Steps are tried and may be refused; they end at every wanted time.
    Trial,
    /// Equal steps that end at every wanted time.
    Fixed {
        /// They are at most this long.
        longest: f64,
        /// [`Block::advance`] can take as many at once.
        most_repeats: u64,
    },
}

impl Stepping {
    /// Steps that [`Block::advance`] can take at once.
    pub fn most_repeats(self) -> u64 {
        match self {
            Stepping::Fixed { most_repeats, .. } => most_repeats,
            Stepping::Series | Stepping::Trial => 1,
        }
    }
}

/// The numbers in which a block keeps tangent vectors; where there are no power series, the state and its steps, too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// `f64`
    Double,
    /// `f32`
    Single,
}

impl Precision {
    /// That of the numbers `N`.
    fn of<N: Number>() -> Precision {
        if size_of::<N>() == size_of::<f32>() { Precision::Single } else { Precision::Double }
    }

    /// The number closest to `x`.
    pub fn nearest(self, x: f64) -> f64 {
        match self {
            Precision::Double => x,
            Precision::Single => f64::from(x as f32),
        }
    }

    /// Tangent vectors whose norm leaves `[2^-r, 2^r)` for this r are to be rescaled: far enough from overflow for the growth of
    /// many steps, a quarter of the exponents that there are.
    pub fn range_exponent(self) -> i32 {
        match self {
            Precision::Double => 256,
            Precision::Single => 32,
        }
    }
}

/// What became of a step of one trajectory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepOutcome {
    /// It was taken.
    Taken,
    /// It was too long: the trajectory is where it was, and [`Block::prepare`] will propose a shorter one.
    TooLong,
    /// It led to numbers that are not finite: the trajectory is where it was.
    NotFinite,
    /// Its implicit equation was not solved: the trajectory is where it was.
    NoConvergence,
    /// It was too large for what it would mean, and no shorter one will be proposed: the trajectory is where it was.
    TooLarge,
}

/// Trajectories side by side, one in each lane, advanced together, each by steps of its own.
///
/// A trajectory consists of groups: the state (group 0) and its tangent vectors (1, 2, ...).
pub trait Block {
    /// Number of trajectories.
    fn n_lanes(&self) -> usize;

    /// How their steps come about.
    fn stepping(&self) -> Stepping;

    /// In which numbers.
    fn precision(&self) -> Precision;

    /// Puts values into one group of a lane; into group 0 (which comes first) those of a new trajectory, that of this number.
    fn load(&mut self, lane: usize, trajectory: usize, group: usize, values: &[f64]);

    /// The present values of one group of a lane.
    fn read(&self, lane: usize, group: usize, values: &mut [f64]);

    /// For each lane the longest step that the method allows; NaN where a number is not finite. `ahead` are the times, with their
    /// signs, up to where the trajectories are to end, zero for a lane that stays.
    fn prepare(&mut self, ahead: &[f64], longest: &mut [f64]);

    /// Advances each lane by `repeats` steps of its size (zero: the lane stays), and says what became of them.
    fn advance(&mut self, sizes: &[f64], repeats: u64, outcomes: &mut [StepOutcome]);

    /// For each lane the sum of the absolute values of the components of one group.
    fn norms(&self, group: usize, norms: &mut [f64]);

    /// Multiplies a tangent vector (group 1, 2, ...) of one lane by a power of two, which rounds nothing.
    fn scale_tangent(&mut self, lane: usize, group: usize, exponent: i32);

    /// The power series of the steps that were prepared; none where [`Block::stepping`] is another one.
    fn series(&self) -> Option<&dyn Series>;
}

/// Power series of the steps of a [`Block`], about their starts.
pub trait Series {
    /// One group of a lane at several times after the start of its step: `n` components each, whose values begin a `stride` apart.
    fn evaluate(&self, lane: usize, group: usize, taus: &[f64], n: usize, values: &mut [f64], stride: usize);

    /// Whether the tangent vectors after a step are, bit for bit, what [`Series::evaluate`] gave for its end.
    fn keeps_tangents_whole(&self) -> bool;

    /// Appends the first orders of the series of one lane's state, order by order, its components.
    ///
    /// # Errors
    /// There is no memory for it.
    fn copy(&self, lane: usize, n_orders: usize, to: &mut Vec<f64>) -> Result<(), TryReserveError>;

    /// Of the series of all lanes' states, on these steps, some sums and sizes; false, and nothing, where they are not computed
    /// side by side.
    fn look_over(&self, steps: &[f64], of: &mut Overview<'_>) -> bool;
}
