//! Flows of split terms `F(xi.x)`: exponentials of constant matrices, by their power series.

use super::coefficients::Scheme;
use super::{PathIndex, Split, spread};
use crate::field::SplitTerms;
use crate::field::split_terms::Prepared;
use crate::lanes::{Body, Lane};

/// Terms of `exp(s M) x` for `|s M| <= 1`: the next is below `1/19! = 8e-18` of x, in single precision `1/12! = 2e-9`.
const TERMS: usize = 18;
const TERMS_SINGLE: usize = 11;

/// Most intervals with `|s M| <= 1` in one flow. A longer one makes the numbers NaN: the step is far beyond sense.
const MOST_INTERVALS: f64 = 4096.0;

impl Split for SplitTerms {
    fn advance<V: Lane>(
        &self,
        scheme: &Scheme,
        groups: &mut [V],
        sizes: &[f64],
        repeats: u64,
        _paths: &mut [PathIndex],
    ) {
        V::outline(Steps { split_terms: self, scheme, groups, sizes, repeats });
    }
}

struct Steps<'s, V> {
    split_terms: &'s SplitTerms,
    scheme: &'s Scheme,
    groups: &'s mut [V],
    sizes: &'s [f64],
    repeats: u64,
}

impl<V: Lane> Body for Steps<'_, V> {
    #[inline(always)]
    fn run(self) {
        let Steps { split_terms, scheme, groups, sizes, repeats } = self;
        let Some((outermost, inner)) = split_terms.ridges.split_first() else { return };
        let step: V = spread(sizes);
        let mut work = Work::new(split_terms.n_components);
        let mut flow = |split_term: &Prepared, part: f64| work.flow(split_term, step.mul(V::splat(part)), groups);
        for _ in 0..repeats {
            flow(outermost, scheme.first);
            for stage in &scheme.stages {
                if let Some((innermost, passed)) = inner.split_last() {
                    passed.iter().for_each(|split_term| flow(split_term, stage.inwards));
                    flow(innermost, stage.innermost);
                    passed.iter().rev().for_each(|split_term| flow(split_term, stage.outwards));
                }
                flow(outermost, stage.outermost);
            }
        }
    }
}

/// Vectors that a flow needs besides the groups.
pub(super) struct Work<V> {
    term: Vec<V>,
    pub(super) image: Vec<V>,
    pub(super) before: Vec<V>,
}

/// A flow for the parameter s in as many equal intervals as a lane needs.
struct Intervals<V> {
    size: V,
    counts: V,
    most: usize,
    terms: usize,
}

impl<V: Lane> Work<V> {
    #[inline(always)]
    pub(super) fn new(n: usize) -> Work<V> {
        let vector = || vec![V::splat(0.0); n];
        Work { term: vector(), image: vector(), before: vector() }
    }

    /// The flow of a split term for the time t: with `s = t F'(y)`, `x -> exp(s M) x` and
    /// `dx -> exp(s M) (dx + t F''(y) (xi.dx) M x)`.
    #[inline(always)]
    pub(super) fn flow(&mut self, split_term: &Prepared, t: V, groups: &mut [V]) {
        let n = self.term.len();
        let (x, tangents) = groups.split_at_mut(n);
        let (first, second) = derivatives(&split_term.ridge.derivative, form(split_term, x));
        let intervals = Intervals::new(split_term, t.mul(first));
        for dx in tangents.chunks_exact_mut(n) {
            if split_term.ridge.derivative.len() > 1 {
                apply(split_term, x, &mut self.image);
                let factor = t.mul(second).mul(form(split_term, dx));
                for (dx, image) in dx.iter_mut().zip(&self.image) {
                    *dx = image.mul_add(factor, *dx);
                }
            }
            self.exponential(split_term, &intervals, dx);
        }
        self.exponential(split_term, &intervals, x);
    }

    /// `u -> exp(s M) u`
    #[inline(always)]
    fn exponential(&mut self, split_term: &Prepared, intervals: &Intervals<V>, u: &mut [V]) {
        for done in 0..intervals.most {
            self.before.copy_from_slice(u);
            self.term.copy_from_slice(u);
            // The change is summed by itself and added once: term by term, the roundings of what is small beside u have a mean,
            // and Casimirs were measured to drift by 1.4e-16 of their size in each step of order 4 of a free rigid body.
            u.fill(V::splat(0.0));
            for k in 1..=intervals.terms {
                apply(split_term, &self.term, &mut self.image);
                let factor = intervals.size.mul(V::splat(1.0 / k as f64));
                for ((u, term), image) in u.iter_mut().zip(&mut self.term).zip(&self.image) {
                    *term = image.mul(factor);
                    *u = u.add(*term);
                }
            }
            for (u, before) in u.iter_mut().zip(&self.before) {
                *u = before.add(*u);
            }
            // lanes that needed fewer intervals stay as they are, to the last bit
            for lane in (0..V::WIDTH).filter(|&lane| intervals.counts.get(lane) <= done as f64) {
                for (u, before) in u.iter_mut().zip(&self.before) {
                    u.as_scalars_mut()[lane] = before.as_scalars()[lane];
                }
            }
        }
    }
}

impl<V: Lane> Intervals<V> {
    #[inline(always)]
    fn new(split_term: &Prepared, s: V) -> Intervals<V> {
        let terms = if size_of::<V::Number>() == size_of::<f32>() { TERMS_SINGLE } else { TERMS };
        let (mut size, mut counts, mut most) = (s, V::splat(1.0), 1);
        if let Some(power) = split_term.nilpotent_from.filter(|&power| power <= terms + 1) {
            return Intervals { size, counts, most, terms: power - 1 };
        }
        for lane in 0..V::WIDTH {
            let bound = s.get(lane).abs() * split_term.norm;
            let count = bound.ceil().max(1.0);
            if count <= MOST_INTERVALS {
                size.set(lane, s.get(lane) / count);
                counts.set(lane, count);
                most = most.max(count as usize);
            } else {
                size.set(lane, f64::NAN);
            }
        }
        Intervals { size, counts, most, terms }
    }
}

/// `xi.u`
#[inline(always)]
pub(super) fn form<V: Lane>(split_term: &Prepared, u: &[V]) -> V {
    let mut sum = V::splat(0.0);
    for &(i, xi) in &split_term.ridge.form {
        sum = u[i].mul_add(V::splat(xi), sum);
    }
    sum
}

/// `image = M u`
#[inline(always)]
pub(super) fn apply<V: Lane>(split_term: &Prepared, u: &[V], image: &mut [V]) {
    image.fill(V::splat(0.0));
    for &(row, column, value) in &split_term.ridge.generator {
        image[row] = u[column].mul_add(V::splat(value), image[row]);
    }
}

/// A polynomial and its derivative at y, by Horner's rule.
#[inline(always)]
pub(super) fn derivatives<V: Lane>(coefficients: &[f64], y: V) -> (V, V) {
    let mut sums = (V::splat(0.0), V::splat(0.0));
    for &coefficient in coefficients.iter().rev() {
        sums = (sums.0.mul_add(y, V::splat(coefficient)), sums.1.mul_add(y, sums.0));
    }
    sums
}
