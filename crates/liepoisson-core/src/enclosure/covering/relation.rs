//! One set covers another: the covering relation and the cone condition of an edge.
//!
//! In the charts the map is `q' = o + R(q) q` with `R(q)` in a matrix of intervals, in blocks uu, us, su, ss. With `K` the
//! inverse of uu and `r` the radius of both sets,
//! ```text
//! (r - |K o_u| - |K| |us| r) / (|K| r) > 1     on |q_u| = r images have |q'_u| > r,
//! (|o_s| + (|su| + |ss|) r) / r < 1            images have |q'_s| < r,
//! ```
//! which stay true along the homotopy `(1 - t)(o + R(q) q) + t (uu_0 q_u, 0)`, `uu_0` in uu: a covering relation of degree
//! plus or minus one (Zgliczyński and Gidea 2004). For two points at distance `d` and their images, with `a = 1/|K|` and
//! `Q(d) = |d_u|^2 - |d_s|^2`,
//! ```text
//! Q(d') - Q(d) >= (a^2 - |su|^2 - 1) |d_u|^2 - 2 (a |us| + |su| |ss|) |d_u| |d_s| + (1 + |us|^2 - |ss|^2) |d_s|^2
//! ```
//! if `a |d_u| >= |us| |d_s|`. Otherwise `Q(d') - Q(d) >= |d_s|^2 - |d_u|^2 - (|su| |d_u| + |ss| |d_s|)^2`, which falls with
//! `|d_u|` and is at the end, `a |d_u| = |us| |d_s|`, the form before. So it is enough that this is positive definite.
//! The numbers `|us|`, `|su|`, `|ss|` may be upper bounds and `a` a lower one, the same in each place.
//!
//! # References
//! - P. Zgliczyński, M. Gidea, *Covering relations for multidimensional dynamical systems*, J. Differential Equations 202
//!   (2004) 32.
//! - P. Zgliczyński, *Covering relations, cone conditions and the stable manifold theorem*, ibid. 246 (2009) 1774.

use super::{Check, Place, Refusal};
use crate::enclosure::interval::Interval;
use crate::enclosure::linear::{euclidean_norm, inverse, spectral_norm};
use crate::enclosure::matrix::{Matrix, dot};

/// How far a set covers another.
#[derive(Clone, Copy, Debug)]
pub struct Relation {
    /// Least `|q'_u| / r` of images of `|q_u| = r`; above one.
    pub expansion: f64,
    /// Greatest `|q'_s| / r` of images; below one.
    pub contraction: f64,
    /// The least eigenvalue of the form of the cone condition; positive.
    pub cone: f64,
}

/// The relation of a map `o + R q` on `|q_u| <= radius`, `|q_s| <= radius`, of which the first `n_unstable` are `q_u`.
///
/// # Errors
/// A condition does not hold, or is not certain.
pub fn relation(
    offset: &[Interval],
    derivative: &Matrix<Interval>,
    n_unstable: usize,
    radius: f64,
    place: Place,
) -> Result<Relation, Refusal> {
    let (u, s): (Vec<usize>, Vec<usize>) = (0..offset.len()).partition(|&i| i < n_unstable);
    let block = |rows: &[usize], columns: &[usize]| derivative.block(rows, columns);
    let norm = |matrix: &Matrix<Interval>| Interval::point(spectral_norm(matrix));
    let [us, su, ss] = [(&u, &s), (&s, &u), (&s, &s)].map(|(rows, columns)| norm(&block(rows, columns)));
    let require = |is_so: bool, check, wanted, value: f64| match is_so {
        true => Ok(()),
        false => Err(Refusal::new(check, place, wanted).with_value(value)),
    };

    let regular = "the unstable directions of the image to be regular";
    let back = inverse(&block(&u, &u)).ok_or(Refusal::new(Check::Expansion, place, regular))?;
    let (size, r) = (norm(&back), Interval::point(radius));
    let shift = euclidean_norm(&back.apply(&offset[..n_unstable]));
    let expansion = ((r - shift - size * us * r) / (size * r)).lo();
    require(expansion > 1.0, Check::Expansion, "an expansion above 1", expansion)?;
    let contraction = ((euclidean_norm(&offset[n_unstable..]) + (su + ss) * r) / r).hi();
    require(contraction < 1.0, Check::Contraction, "a contraction below 1", contraction)?;
    let cone = cone(Interval::point((Interval::ONE / size).lo()), us, su, ss).lo();
    require(cone > 0.0, Check::Cones, "a positive definite form", cone)?;
    Ok(Relation { expansion, contraction, cone })
}

/// The least eigenvalue of the form in `|d_u|`, `|d_s|`.
fn cone(a: Interval, us: Interval, su: Interval, ss: Interval) -> Interval {
    let unstable = a.sqr() - su.sqr() - Interval::ONE;
    let stable = Interval::ONE + us.sqr() - ss.sqr();
    let mixed = dot(&[a, su], &[us, ss]);
    let half = Interval::point(0.5);
    let spread = euclidean_norm(&[(unstable - stable) * half, mixed]);
    (unstable + stable) * half - spread
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn enclosed(rows: &[[f64; 4]; 4]) -> Matrix<Interval> {
        Matrix::from_fn(4, 4, |i, j| Interval::point(rows[i][j]))
    }

    fn of(offset: [f64; 4], rows: &[[f64; 4]; 4]) -> Result<Relation, Check> {
        let offset = offset.map(Interval::point);
        relation(&offset, &enclosed(rows), 2, 1.0, Place::Everywhere).map_err(|refusal| refusal.check)
    }

    const HYPERBOLIC: [[f64; 4]; 4] =
        [[3.0, -4.0, 0.0, 0.0], [4.0, 3.0, 0.0, 0.0], [0.0, 0.0, 0.3, 0.4], [0.0, 0.0, -0.4, 0.3]];

    #[test]
    fn a_turn_with_expansion_and_contraction_has_its_own_margins() {
        let relation = of([1.0, 0.0, 0.0, 0.2], &HYPERBOLIC).unwrap();
        assert!(4.0 - 1e-12 < relation.expansion && relation.expansion <= 4.0, "{relation:?}");
        assert!((0.7..0.7 + 1e-12).contains(&relation.contraction), "{relation:?}");
        assert!(0.75 - 1e-12 < relation.cone && relation.cone <= 0.75, "{relation:?}"); // 1 - 0.5^2, 25 - 1
    }

    #[test]
    fn each_condition_can_fail_alone() {
        assert_eq!(of([4.0, 0.0, 0.0, 0.0], &HYPERBOLIC).unwrap_err(), Check::Expansion);
        assert_eq!(of([0.0, 0.0, 0.5, 0.0], &HYPERBOLIC).unwrap_err(), Check::Contraction);
        let mut singular = HYPERBOLIC;
        singular[1] = singular[0];
        assert_eq!(of([0.0; 4], &singular).unwrap_err(), Check::Expansion);
        let mut sheared = HYPERBOLIC; // covers, but a difference may leave the cone
        (sheared[0], sheared[1]) = ([1.3, 0.0, 0.25, 0.0], [0.0, 1.3, 0.0, 0.0]);
        (sheared[2], sheared[3]) = ([0.9, 0.0, 0.05, 0.0], [0.0, 0.0, 0.0, 0.0]);
        assert_eq!(of([0.0; 4], &sheared).unwrap_err(), Check::Cones);
        assert_eq!(of([f64::NAN, 0.0, 0.0, 0.0], &HYPERBOLIC).unwrap_err(), Check::Expansion);
        assert_eq!(of([0.0, 0.0, f64::NAN, 0.0], &HYPERBOLIC).unwrap_err(), Check::Contraction);
    }

    proptest! {
        #[test]
        fn accepted_maps_do_what_the_margins_say(
            entries in proptest::collection::vec(-0.3..0.3_f64, 16),
            offset in proptest::array::uniform4(-0.1..0.1_f64),
            turns in proptest::collection::vec((0.0..6.3_f64, 0.0..6.3_f64, 0.0..1.5_f64), 20),
        ) {
            let rows: [[f64; 4]; 4] = std::array::from_fn(|i| {
                std::array::from_fn(|j| entries[4 * i + j] + if i == j && i < 2 { 1.8 } else { 0.0 })
            });
            let Ok(relation) = of(offset, &rows) else { return Ok(()) };
            let apply = |q: [f64; 4]| -> [f64; 4] { std::array::from_fn(|i| (0..4).map(|j| rows[i][j] * q[j]).sum()) };
            let sizes = |q: [f64; 4]| (q[0].hypot(q[1]), q[2].hypot(q[3]));
            for (phi, psi, share) in turns {
                let q = [phi.cos(), phi.sin(), share.min(1.0) * psi.cos(), share.min(1.0) * psi.sin()];
                let image = apply(q);
                let (u, s) = sizes(std::array::from_fn(|i| image[i] + offset[i]));
                prop_assert!(u >= relation.expansion - 1e-12 && s <= relation.contraction + 1e-12);
                let difference = [share * phi.cos(), share * phi.sin(), psi.cos(), psi.sin()];
                let ((u, s), (u2, s2)) = (sizes(difference), sizes(apply(difference)));
                let growth = u2 * u2 - s2 * s2 - u * u + s * s;
                prop_assert!(growth >= relation.cone * (u * u + s * s) - 1e-12, "{growth} {relation:?}");
            }
        }
    }
}
