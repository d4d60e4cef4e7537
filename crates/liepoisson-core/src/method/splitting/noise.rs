//! Steps with noise: around a step of the Hamiltonian, the exact flows of the noise Hamiltonians, half before and half after.
//!
//! With `N_k(w)` the flow of `H_k` for the time w, `D_k(t)` that of the damping along it and `Phi(h)` a step of the Hamiltonian, a
//! step is `N_1(v_1) .. N_m(v_m) D_m(h/2) .. D_1(h/2) Phi(h) D_1(h/2) .. D_m(h/2) N_m(w_m) .. N_1(w_1)`, where `v_k` and `w_k` are
//! the increments of the path over the halves of the step. They are independent, so that this is Strang's composition of the
//! semigroups of all parts, of weak order 2. Without noise it is the step `Phi(h)` to the last bit.
//!
//! Near a minimum of H the damping relaxes with rates that add up to `(beta/2) sum_k {{H, H_k}, H_k}`. Where a step h is not small
//! against them the stationary law is too wide: in a direction of the rate lambda it has the variance of the law of Gibbs times
//! `1 + 3 (h lambda)^2/8`, up to higher orders. So a step is too large where `h (beta/2) sum_k |{{H, H_k}, H_k}|` exceeds
//! [`LARGEST`], which keeps that factor below 1.1.

use super::coefficients::Scheme;
use super::split_terms::{Work, apply, derivatives, form};
use super::{PathIndex, Split, spread};
use crate::field::split_terms::Prepared;
use crate::field::{Noise, Noisy, Space, SplitTerms};
use crate::lanes::{Body, Lane};

/// The largest step of the damping, in times in which it relaxes.
const LARGEST: f64 = 0.5;

impl<F: Split> Split for Noisy<F> {
    fn advance<V: Lane>(
        &self,
        scheme: &Scheme,
        groups: &mut [V],
        sizes: &[f64],
        repeats: u64,
        paths: &mut [PathIndex],
    ) {
        let n = self.noise.channels.len();
        let mut halves = [vec![V::splat(0.0); n], vec![V::splat(0.0); n]];
        let half: V = spread(&sizes.iter().map(|size| 0.5 * size).collect::<Vec<f64>>());
        for step in 0..repeats {
            for (lane, (path, size)) in paths.iter().zip(sizes).enumerate().filter(|(_, (_, size))| **size != 0.0) {
                let scale = size.abs().sqrt();
                for channel in 0..n {
                    let parts = self.noise.path.halves(path.trajectory, path.n_steps + step, channel);
                    for (half, part) in halves.iter_mut().zip(parts) {
                        half[channel].set(lane, scale * part);
                    }
                }
            }
            let mut share = V::splat(0.0);
            V::outline(Half { noise: &self.noise, times: &halves[0], half, groups, share: Some(&mut share) });
            for (lane, path) in paths.iter_mut().enumerate() {
                path.is_too_large |= share.get(lane) > LARGEST;
            }
            self.field.advance(scheme, groups, sizes, 1, paths);
            V::outline(Half { noise: &self.noise, times: &halves[1], half, groups, share: None });
        }
    }
}

/// The noise in one half of a step.
struct Half<'s, V> {
    noise: &'s Noise,
    /// The times of the flows of the noise Hamiltonians.
    times: &'s [V],
    /// Half of the step.
    half: V,
    groups: &'s mut [V],
    /// In the first half: where to say how large the step is beside the times in which the damping relaxes.
    share: Option<&'s mut V>,
}

impl<V: Lane> Body for Half<'_, V> {
    #[inline(always)]
    fn run(self) {
        let Half { noise, times, half, groups, share } = self;
        let Some(first) = noise.channels.first() else { return };
        let mut along = Along { work: Work::new(first.n_components()), middle: vec![], rates: vec![] };
        if let Some(share) = share {
            for (channel, &time) in noise.channels.iter().zip(times) {
                along.flow(channel, time, groups);
            }
            if let Some((energy, beta)) = &noise.damping {
                let sum = noise
                    .channels
                    .iter()
                    .fold(V::splat(0.0), |sum, channel| sum.add(along.curvature(channel, energy, groups)));
                *share = half.mul(V::splat(*beta)).mul(sum).abs();
                for channel in noise.channels.iter().rev() {
                    along.damp(channel, energy, half.mul(V::splat(-0.5 * beta)), groups);
                }
            }
            return;
        }
        if let Some((energy, beta)) = &noise.damping {
            for channel in &noise.channels {
                along.damp(channel, energy, half.mul(V::splat(-0.5 * beta)), groups);
            }
        }
        for (channel, &time) in noise.channels.iter().zip(times).rev() {
            along.flow(channel, time, groups);
        }
    }
}

/// Motion along the field of a noise Hamiltonian.
struct Along<V> {
    work: Work<V>,
    /// Groups in the middle of a step of the damping, or a state and the field of a noise Hamiltonian there.
    middle: Vec<V>,
    /// `{H, H_k}` and its derivatives along the tangent vectors.
    rates: Vec<V>,
}

impl<V: Lane> Along<V> {
    /// The flow of a noise Hamiltonian.
    #[inline(always)]
    fn flow(&mut self, channel: &SplitTerms, time: V, groups: &mut [V]) {
        for split_term in &channel.ridges {
            self.work.flow(split_term, time, groups);
        }
    }

    /// The damping `x' = rate {H, H_k} {x, H_k}`, for the time that is a factor of the rate: the flow of `H_k` for a time that solves
    /// an equation of its own, `s' = rate {H, H_k}(x(s))`. One step of the midpoint rule for s, so that x moves along the leaf.
    #[inline(always)]
    fn damp(&mut self, channel: &SplitTerms, energy: &SplitTerms, rate: V, groups: &mut [V]) {
        self.rates(channel, energy, groups);
        let mut middle = std::mem::take(&mut self.middle);
        middle.clear();
        middle.extend_from_slice(groups);
        self.go(channel, rate.mul(V::splat(0.5)), &mut middle);
        self.rates(channel, energy, &middle);
        self.middle = middle;
        self.go(channel, rate, groups);
    }

    /// `|{{H, H_k}, H_k}|`: how `{H, H_k}` changes along the field of `H_k`.
    #[inline(always)]
    fn curvature(&mut self, channel: &SplitTerms, energy: &SplitTerms, groups: &[V]) -> V {
        let n = channel.n_components();
        let mut at = std::mem::take(&mut self.middle);
        at.clear();
        at.extend_from_slice(&groups[..n]);
        at.resize(2 * n, V::splat(0.0));
        let (x, field) = at.split_at_mut(n);
        for split_term in &channel.ridges {
            let (first, _) = derivatives(&split_term.ridge.derivative, form(split_term, x));
            apply(split_term, x, &mut self.work.image);
            for (field, image) in field.iter_mut().zip(&self.work.image) {
                *field = image.mul_add(first, *field);
            }
        }
        self.rates(channel, energy, &at);
        self.middle = at;
        self.rates[1].abs()
    }

    /// The flow of `H_k` for the time `factor {H, H_k}`, which depends on the state.
    #[inline(always)]
    fn go(&mut self, channel: &SplitTerms, factor: V, groups: &mut [V]) {
        self.flow(channel, factor.mul(self.rates[0]), groups);
        let n = channel.n_components();
        let (x, tangents) = groups.split_at_mut(n);
        if tangents.is_empty() {
            return;
        }
        for split_term in &channel.ridges {
            let (first, _) = derivatives(&split_term.ridge.derivative, form(split_term, x));
            apply(split_term, x, &mut self.work.image);
            for (dx, rate) in tangents.chunks_exact_mut(n).zip(&self.rates[1..]) {
                let more = factor.mul(*rate).mul(first);
                for (dx, image) in dx.iter_mut().zip(&self.work.image) {
                    *dx = image.mul_add(more, *dx);
                }
            }
        }
    }

    /// `{H, H_k} = grad H . X_k` at the state, and its derivatives along the tangent vectors.
    #[inline(always)]
    fn rates(&mut self, channel: &SplitTerms, energy: &SplitTerms, groups: &[V]) {
        let n = channel.n_components();
        let (x, tangents) = groups.split_at(n);
        self.rates.clear();
        self.rates.resize(1 + tangents.len() / n, V::splat(0.0));
        for split_term in &channel.ridges {
            let (first, second) = derivatives(&split_term.ridge.derivative, form(split_term, x));
            apply(split_term, x, &mut self.work.image);
            let slope = slope(energy, x, &self.work.image);
            self.rates[0] = first.mul_add(slope, self.rates[0]);
            for (k, dx) in tangents.chunks_exact(n).enumerate() {
                apply(split_term, dx, &mut self.work.before);
                let mut change = self::slope(energy, x, &self.work.before);
                for term in &energy.ridges {
                    let (_, second) = derivatives(&term.ridge.derivative, form(term, x));
                    change = second.mul(form(term, dx)).mul_add(form(term, &self.work.image), change);
                }
                let rate = second.mul(form(split_term, dx)).mul_add(slope, self.rates[1 + k]);
                self.rates[1 + k] = first.mul_add(change, rate);
            }
        }
    }
}

/// `grad H . v`
#[inline(always)]
fn slope<V: Lane>(energy: &SplitTerms, x: &[V], v: &[V]) -> V {
    let add = |sum: V, term: &Prepared| {
        let (first, _) = derivatives(&term.ridge.derivative, form(term, x));
        first.mul_add(form(term, v), sum)
    };
    let mut sum = V::splat(0.0);
    for term in &energy.ridges {
        sum = add(sum, term);
    }
    sum
}
