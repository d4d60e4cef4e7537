//! Rotations of the vectors of a top and their derivatives, without square root and division.
//!
//! `u' = u x v` with constant `v` has the solution `u + c1 u x v + c2 (u x v) x v` after the time one, where
//! `c_n(z) = sum_k (-z)^k / (2k + n)!` at `z = |v|^2` are the functions of Stumpff: `c1 = sin|v| / |v|` and
//! `c2 = (1 - cos|v|) / |v|^2`, smooth at `v = 0`.

use crate::lanes::{Body, Lane, Number, polynomial};

/// l, alpha, beta, or a tangent vector to them.
pub(super) type Group<V> = [V; 9];

/// Largest `z` that the polynomials are made for.
const LIMIT: f64 = 0.5;
/// Two doublings of the angle multiply `z` by this.
const TWO_DOUBLINGS: f64 = 16.0;

/// Chebyshev approximations of `c3` on `[0, 1/2]`, to 6e-18 and 1.2e-11.
const C3: [f64; 6] = [
    0.166_666_666_666_666_66,
    -0.008_333_333_333_332_497,
    0.000_198_412_698_393_199_82,
    -2.755_731_755_965_103e-6,
    2.505_146_609_199_108_7e-8,
    -1.594_473_086_996_564_5e-10,
];
const C3_SINGLE: [f64; 4] =
    [0.166_666_666_654_512_35, -0.008_333_332_555_378_962, 0.000_198_404_914_654_414_55, -2.730_789_909_897_160_7e-6];
/// Chebyshev approximations of `c4` on `[0, 1/2]`, to 4e-19 and 1.0e-12.
const C4: [f64; 6] = [
    0.041_666_666_666_666_664,
    -0.001_388_888_888_888_836_7,
    2.480_158_730_036_791_3e-5,
    -2.755_731_818_318_879e-7,
    2.087_635_535_097_581_8e-9,
    -1.139_927_264_675_137_7e-11,
];
const C4_SINGLE: [f64; 4] =
    [0.041_666_666_665_652_88, -0.001_388_888_824_000_881_6, 2.480_093_812_029_699_7e-5, -2.734_933_832_966_970_5e-7];

/// `c1`, `c2`, `c3` for `z` up to the limit.
#[inline(always)]
fn near_zero<V: Lane>(z: V) -> [V; 3] {
    let (c3, c4) = if size_of::<V::Number>() == size_of::<f32>() {
        (polynomial(&C3_SINGLE, z), polynomial(&C4_SINGLE, z))
    } else {
        (polynomial(&C3, z), polynomial(&C4, z))
    };
    [z.neg_mul_add(c3, V::splat(1.0)), z.neg_mul_add(c4, V::splat(0.5)), c3]
}

/// `c1`, `c2`, `c3` at any `z`; what a lane gets does not depend on the others.
#[inline(always)]
fn stumpff<V: Lane>(z: V) -> [V; 3] {
    let mut functions = near_zero(z);
    let beyond = z.as_scalars().iter().fold(false, |beyond, lane| beyond | (lane.to_f64() > LIMIT));
    if beyond {
        // a copy, so that the usual case keeps its numbers in registers
        let mut corrected = functions;
        V::outline(LargeAngles { z, functions: &mut corrected });
        functions = corrected;
    }
    functions
}

/// The lanes whose angle is too large for the polynomials.
struct LargeAngles<'c, V> {
    z: V,
    functions: &'c mut [V; 3],
}

impl<V: Lane> Body for LargeAngles<'_, V> {
    #[inline(always)]
    fn run(self) {
        let LargeAngles { z, functions } = self;
        let mut quarter = z.mul(V::splat(1.0 / TWO_DOUBLINGS));
        let mut doubled = near_zero(quarter);
        for _ in 0..2 {
            doubled = double_angle(quarter, doubled);
            quarter = quarter.mul(V::splat(4.0));
        }
        for lane in 0..V::WIDTH {
            let z = z.get(lane);
            if z > LIMIT {
                let far = z > TWO_DOUBLINGS * LIMIT;
                let values = if far { by_sine_and_cosine(z) } else { doubled.map(|function| function.get(lane)) };
                for (function, value) in functions.iter_mut().zip(values) {
                    function.set(lane, value);
                }
            }
        }
    }
}

/// `c1`, `c2`, `c3` at `4 z` from those at `z`: `sin 2x = 2 sin x cos x`, `1 - cos 2x = 2 sin^2 x`.
#[inline(always)]
fn double_angle<V: Lane>(z: V, [c1, c2, c3]: [V; 3]) -> [V; 3] {
    let c0 = z.neg_mul_add(c2, V::splat(1.0));
    [c0.mul(c1), c1.mul(c1).mul(V::splat(0.5)), c0.mul_add(c3, c2).mul(V::splat(0.25))]
}

/// `c1`, `c2`, `c3` at a `z` that is not small; NaN at infinity.
fn by_sine_and_cosine(z: f64) -> [f64; 3] {
    let angle = z.sqrt();
    let (sine, cosine) = libm::sincos(angle);
    let c1 = sine / angle;
    [c1, (1.0 - cosine) / z, (1.0 - c1) / z]
}

/// `sum[at..] += u x v`
#[inline(always)]
fn add_cross<V: Lane>(sum: &mut Group<V>, at: usize, u: [V; 3], v: [V; 3]) {
    for i in 0..3 {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        sum[at + i] = u[j].mul_add(v[k], sum[at + i]);
        sum[at + i] = u[k].neg_mul_add(v[j], sum[at + i]);
    }
}

/// `u x v`
#[inline(always)]
fn cross<V: Lane>(u: [V; 3], v: [V; 3]) -> [V; 3] {
    let mut product = u;
    // loops: what is called through `map` is not compiled for these registers
    for i in 0..3 {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        product[i] = u[k].neg_mul_add(v[j], u[j].mul(v[k]));
    }
    product
}

/// `factor u`
#[inline(always)]
fn times<V: Lane>(mut u: [V; 3], factor: V) -> [V; 3] {
    for component in &mut u {
        *component = component.mul(factor);
    }
    u
}

/// One of the three vectors of a group.
#[inline(always)]
fn vector<V: Lane>(x: &Group<V>, at: usize) -> [V; 3] {
    [x[at], x[at + 1], x[at + 2]]
}

/// `x[at..] += matrix x[at..]`
#[inline(always)]
fn add_transformed<V: Lane>(x: &mut Group<V>, at: usize, matrix: &[[V; 3]; 3]) {
    let u = vector(x, at);
    for i in 0..3 {
        for j in 0..3 {
            x[at + i] = matrix[i][j].mul_add(u[j], x[at + i]);
        }
    }
}

/// `u -> u + c1 u x v + c2 (u x v) x v` as a matrix, less the identity, which would cost digits at small angles.
#[inline(always)]
fn rotation_less_identity<V: Lane>(v: [V; 3], c1: V, c2: V) -> [[V; 3]; 3] {
    let [v1, v2, v3] = v;
    let [s1, s2, s3] = times(v, c1);
    let [p1, p2, p3] = times(v, c2);
    let zero = V::splat(0.0);
    let (q1, q2, q3) = (p1.neg_mul_add(v1, zero), p2.neg_mul_add(v2, zero), p3.neg_mul_add(v3, zero));
    [
        [q2.add(q3), p1.mul_add(v2, s3), p1.mul_add(v3, zero.sub(s2))],
        [p1.mul_add(v2, zero.sub(s3)), q3.add(q1), p2.mul_add(v3, s1)],
        [p1.mul_add(v3, s2), p2.mul_add(v3, zero.sub(s1)), q1.add(q2)],
    ]
}

/// The angle by which alpha and beta turn about l, and how it changes with l.
///
/// With `v = tau l` and the rotation `R(v) u = u + c1 u x v + c2 (u x v) x v`, a change of v turns what was rotated by
/// `w = k0 dv + k1 dv x v + k2 (dv x v) x v`, so that `alpha -> R alpha` has the derivative `R dalpha + (R alpha) x w`.
pub(super) trait Angle {
    /// `[c1, c2], [k0, k1, k2]` at `z = |v|^2`.
    fn coefficients<V: Lane>(z: V) -> ([V; 2], [V; 3]);
}

/// `|v|`: the flow of `|l|^2 / 2`.
pub(super) struct OfFlow;

impl Angle for OfFlow {
    #[inline(always)]
    fn coefficients<V: Lane>(z: V) -> ([V; 2], [V; 3]) {
        let [c1, c2, c3] = stumpff(z);
        ([c1, c2], [V::splat(1.0), c2, c3])
    }
}

/// `2 arctan(|v| / 2)`, the rotation `(u' - u) = (u' + u)/2 x v` of Cayley: the flow of another function of `|l|`.
pub(super) struct OfCayley;

impl Angle for OfCayley {
    #[inline(always)]
    fn coefficients<V: Lane>(z: V) -> ([V; 2], [V; 3]) {
        let c1 = V::splat(1.0).div(z.mul_add(V::splat(0.25), V::splat(1.0)));
        let half = c1.mul(V::splat(0.5));
        ([c1, half], [c1, half, V::splat(0.0)])
    }
}

/// The flow of a function of `|l|^2` for the time `tau`: alpha and beta turn about l.
#[inline(always)]
pub(super) fn turn_about_momentum<A: Angle, V: Lane>(x: &mut Group<V>, tangents: &mut [Group<V>], tau: V) {
    let v = times(vector(x, 0), tau);
    let z = v[2].mul_add(v[2], v[1].mul_add(v[1], v[0].mul(v[0])));
    let ([c1, c2], [k0, k1, k2]) = A::coefficients(z);
    let matrix = rotation_less_identity(v, c1, c2);
    for at in [3, 6] {
        add_transformed(x, at, &matrix);
    }
    for dx in tangents {
        let dv = times(vector(dx, 0), tau);
        let first = cross(dv, v);
        let second = cross(first, v);
        let mut w = times(dv, k0);
        for i in 0..3 {
            w[i] = second[i].mul_add(k2, first[i].mul_add(k1, w[i]));
        }
        for at in [3, 6] {
            add_transformed(dx, at, &matrix);
            add_cross(dx, at, vector(x, at), w);
        }
    }
}

/// The flow of `l_i^2 / 2` for the time `tau`, i being `AXIS`: all vectors turn about that axis by `tau l_i`.
#[inline(always)]
pub(super) fn turn_about_axis<const AXIS: usize, V: Lane>(x: &mut Group<V>, tangents: &mut [Group<V>], tau: V) {
    let angle = x[AXIS].mul(tau);
    let [c1, c2, _] = stumpff(angle.mul(angle));
    let (sine, one_less_cosine) = (angle.mul(c1), angle.mul(angle).mul(c2));
    let (j, k) = ((AXIS + 1) % 3, (AXIS + 2) % 3);
    let turn = |y: &mut Group<V>, at: usize| {
        let (u, w) = (y[at + j], y[at + k]);
        y[at + j] = w.mul_add(sine, u.neg_mul_add(one_less_cosine, u));
        y[at + k] = u.neg_mul_add(sine, w.neg_mul_add(one_less_cosine, w));
    };
    for at in [0, 3, 6] {
        turn(x, at);
    }
    for dx in tangents {
        let more = dx[AXIS].mul(tau);
        for at in [0, 3, 6] {
            turn(dx, at);
            dx[at + j] = x[at + k].mul_add(more, dx[at + j]);
            dx[at + k] = x[at + j].neg_mul_add(more, dx[at + k]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The defining series, which for `z < 200` loses at most the digits of its largest term.
    fn series(n: u32, z: f64) -> f64 {
        let mut term = 1.0 / (1..=n).map(f64::from).product::<f64>();
        let mut sum = 0.0;
        for k in 0..60 {
            sum += term;
            let m = f64::from(2 * k + n);
            term *= -z / ((m + 1.0) * (m + 2.0));
        }
        sum
    }

    proptest! {
        #[test]
        fn functions_are_their_series(z in prop_oneof![0.0..0.5_f64, 0.5..8.0_f64, 8.0..40.0_f64]) {
            // the largest term at z = 40 is 20, and two doublings cost two digits at most
            let bound = 1e-15 * (1.0 + z);
            for (n, value) in (1..).zip(stumpff(z)) {
                prop_assert!((value - series(n, z)).abs() < bound, "c{n}({z}) = {value}, {}", series(n, z));
            }
            for (n, value) in (1..).zip(stumpff(z as f32)) {
                let bound = 4.0 * f64::from(f32::EPSILON) * (1.0 + z / 8.0);
                prop_assert!((f64::from(value) - series(n, z)).abs() < bound, "single c{n}({z}) = {value}");
            }
        }

        /// Otherwise the lengths of alpha and beta would drift.
        #[test]
        fn sine_and_cosine_lie_on_the_circle(z in prop_oneof![0.0..0.5_f64, 0.5..8.0_f64, 8.0..1e30_f64]) {
            let [c1, c2, _] = stumpff(z);
            let cosine = 1.0 - z * c2;
            prop_assert!((z * c1 * c1 + cosine * cosine - 1.0).abs() < 4e-15, "{z}");
        }
    }
}
