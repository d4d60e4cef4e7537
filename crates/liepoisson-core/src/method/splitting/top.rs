//! The top as a sum of two Hamiltonians: kinetic energy, whose flow is made of rotations, and potential, a shear.

use super::coefficients::{Scheme, Stage};
use super::rotation::{Group, OfCayley, OfFlow, turn_about_axis, turn_about_momentum};
use super::{PathIndex, Split, spread};
use crate::field::{Space, Top};
use crate::lanes::{Body, Lane};

/// The flow of the kinetic energy `l1^2/(2 I1) + l2^2/(2 I2) + l3^2/(2 I3)`, or a symmetric composition in its place.
trait Kinetic: Copy {
    /// What a stage of a composition does between two flows of the potential.
    fn flow<V: Lane>(&self, stage: &Stage, step: V, x: &mut Group<V>, tangents: &mut [Group<V>]);
}

/// Three equal moments: alpha and beta turn about l.
#[derive(Clone, Copy)]
struct Spherical {
    inverse: f64,
}

impl Kinetic for Spherical {
    #[inline(always)]
    fn flow<V: Lane>(&self, stage: &Stage, step: V, x: &mut Group<V>, tangents: &mut [Group<V>]) {
        turn_about_momentum::<OfFlow, V>(x, tangents, step.mul(V::splat(stage.innermost * self.inverse)));
    }
}

/// Two equal moments `I`, and `I_AXIS`: `|l|^2/(2 I) + (1/I_AXIS - 1/I) l_AXIS^2/2`, two Hamiltonians that commute.
#[derive(Clone, Copy)]
struct Symmetric<const AXIS: usize> {
    inverse: f64,
    excess: f64,
}

impl<const AXIS: usize> Kinetic for Symmetric<AXIS> {
    #[inline(always)]
    fn flow<V: Lane>(&self, stage: &Stage, step: V, x: &mut Group<V>, tangents: &mut [Group<V>]) {
        turn_about_momentum::<OfFlow, V>(x, tangents, step.mul(V::splat(stage.innermost * self.inverse)));
        turn_about_axis::<AXIS, V>(x, tangents, step.mul(V::splat(stage.innermost * self.excess)));
    }
}

/// A Lagrange top in discrete time: as [`Symmetric`], but alpha and beta turn about l by another angle.
#[derive(Clone, Copy)]
struct Discrete {
    inverse: f64,
    excess: f64,
}

impl Kinetic for Discrete {
    #[inline(always)]
    fn flow<V: Lane>(&self, stage: &Stage, step: V, x: &mut Group<V>, tangents: &mut [Group<V>]) {
        turn_about_momentum::<OfCayley, V>(x, tangents, step.mul(V::splat(stage.innermost * self.inverse)));
        turn_about_axis::<2, V>(x, tangents, step.mul(V::splat(stage.innermost * self.excess)));
    }
}

/// Three different moments: rotations about the axes, `l_i^2/(2 I_i)`, from the first to the third and back.
#[derive(Clone, Copy)]
struct General {
    inverse: [f64; 3],
}

impl Kinetic for General {
    #[inline(always)]
    fn flow<V: Lane>(&self, stage: &Stage, step: V, x: &mut Group<V>, tangents: &mut [Group<V>]) {
        let [i1, i2, i3] = self.inverse;
        turn_about_axis::<0, V>(x, tangents, step.mul(V::splat(stage.inwards * i1)));
        turn_about_axis::<1, V>(x, tangents, step.mul(V::splat(stage.inwards * i2)));
        turn_about_axis::<2, V>(x, tangents, step.mul(V::splat(stage.innermost * i3)));
        turn_about_axis::<1, V>(x, tangents, step.mul(V::splat(stage.outwards * i2)));
        turn_about_axis::<0, V>(x, tangents, step.mul(V::splat(stage.outwards * i1)));
    }
}

/// A top `I1 = I2` with `a` and `b` along the third axis, in discrete time.
#[derive(Clone, Copy, Debug)]
pub(in crate::method) struct DiscreteLagrange(pub(in crate::method) Top);

impl DiscreteLagrange {
    /// Whether this is such a top.
    pub(in crate::method) fn applies_to(top: &Top) -> bool {
        top.asymmetry[2] == 0.0 && [top.a, top.b].iter().all(|v| v[0] == 0.0 && v[1] == 0.0)
    }
}

impl Space for DiscreteLagrange {
    fn n_components(&self) -> usize {
        self.0.n_components()
    }
}

impl Split for DiscreteLagrange {
    fn advance<V: Lane>(
        &self,
        scheme: &Scheme,
        groups: &mut [V],
        sizes: &[f64],
        repeats: u64,
        _paths: &mut [PathIndex],
    ) {
        let inverse = self.0.inverse_inertia;
        let kinetic = Discrete { inverse: inverse[0], excess: inverse[2] - inverse[0] };
        Run { top: &self.0, scheme, groups, sizes, repeats }.with(kinetic);
    }
}

impl Split for Top {
    fn advance<V: Lane>(
        &self,
        scheme: &Scheme,
        groups: &mut [V],
        sizes: &[f64],
        repeats: u64,
        _paths: &mut [PathIndex],
    ) {
        let inverse = self.inverse_inertia;
        let excess = |axis: usize| inverse[axis] - inverse[(axis + 1) % 3];
        let run = Run { top: self, scheme, groups, sizes, repeats };
        match self.asymmetry.map(|asymmetry| asymmetry == 0.0) {
            [true, true, true] => run.with(Spherical { inverse: inverse[0] }),
            [true, ..] => run.with(Symmetric::<0> { inverse: inverse[1], excess: excess(0) }),
            [_, true, _] => run.with(Symmetric::<1> { inverse: inverse[2], excess: excess(1) }),
            [_, _, true] => run.with(Symmetric::<2> { inverse: inverse[0], excess: excess(2) }),
            _ => run.with(General { inverse }),
        }
    }
}

/// Steps that are to be taken.
struct Run<'s, V> {
    top: &'s Top,
    scheme: &'s Scheme,
    groups: &'s mut [V],
    sizes: &'s [f64],
    repeats: u64,
}

impl<V: Lane> Run<'_, V> {
    fn with<K: Kinetic>(self, kinetic: K) {
        match self.groups.len() / 9 {
            1 => V::outline(InRegisters::<_, _, 0> { run: self, kinetic }),
            2 => V::outline(InRegisters::<_, _, 1> { run: self, kinetic }),
            _ => V::outline(InMemory { run: self, kinetic }),
        }
    }

    #[inline(always)]
    fn steps<K: Kinetic>(
        (top, scheme, repeats): (&Top, &Scheme, u64),
        kinetic: K,
        step: V,
        x: &mut Group<V>,
        tangents: &mut [Group<V>],
    ) {
        for _ in 0..repeats {
            shear(top, x, tangents, step.mul(V::splat(scheme.first)));
            for stage in &scheme.stages {
                kinetic.flow(stage, step, x, tangents);
                shear(top, x, tangents, step.mul(V::splat(stage.outermost)));
            }
        }
    }
}

/// State and `N` tangent vectors in local variables, which the compiler keeps in registers as far as they go.
struct InRegisters<'s, K, V, const N: usize> {
    run: Run<'s, V>,
    kinetic: K,
}

impl<K: Kinetic, V: Lane, const N: usize> Body for InRegisters<'_, K, V, N> {
    #[inline(always)]
    fn run(self) {
        let Run { top, scheme, groups, sizes, repeats } = self.run;
        let (groups, _) = groups.as_chunks_mut::<9>();
        let mut x = groups[0];
        let mut tangents: [Group<V>; N] = std::array::from_fn(|k| groups[1 + k]);
        Run::steps((top, scheme, repeats), self.kinetic, spread(sizes), &mut x, &mut tangents);
        groups[0] = x;
        groups[1..].copy_from_slice(&tangents);
    }
}

/// Any number of tangent vectors.
struct InMemory<'s, K, V> {
    run: Run<'s, V>,
    kinetic: K,
}

impl<K: Kinetic, V: Lane> Body for InMemory<'_, K, V> {
    #[inline(always)]
    fn run(self) {
        let Run { top, scheme, groups, sizes, repeats } = self.run;
        let (groups, _) = groups.as_chunks_mut::<9>();
        let (first, tangents) = groups.split_first_mut().expect("there is always a state");
        let mut x = *first;
        Run::steps((top, scheme, repeats), self.kinetic, spread(sizes), &mut x, tangents);
        *first = x;
    }
}

/// The flow of `a.alpha + b.beta`: `alpha += t eps beta x a`, and l by the mean of alpha before and after.
///
/// It is linear, so tangent vectors go the same way.
#[inline(always)]
fn shear<V: Lane>(top: &Top, x: &mut Group<V>, tangents: &mut [Group<V>], t: V) {
    let half = t.mul(V::splat(0.5));
    shear_one(top, x, t, half);
    for dx in tangents {
        shear_one(top, dx, t, half);
    }
}

#[inline(always)]
fn shear_one<V: Lane>(top: &Top, x: &mut Group<V>, t: V, half: V) {
    add_cross_with_constant(x, 3, 6, &top.twist, half);
    add_cross_with_constant(x, 0, 3, &top.a, t);
    add_cross_with_constant(x, 3, 6, &top.twist, half);
    add_cross_with_constant(x, 0, 6, &top.b, t);
}

/// `x[at..] += x[from..] x (t c)`, skipping components of `c` that are zero.
#[inline(always)]
fn add_cross_with_constant<V: Lane>(x: &mut Group<V>, at: usize, from: usize, c: &[f64; 3], t: V) {
    for axis in 0..3 {
        if c[axis] != 0.0 {
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            let factor = t.mul(V::splat(c[axis]));
            x[at + next] = x[from + last].mul_add(factor, x[at + next]);
            x[at + last] = x[from + next].neg_mul_add(factor, x[at + last]);
        }
    }
}
