//! The fused kernel of the tops is the vector field of the bracket, and keeps what the bracket and the field keep.

use crate::common::*;
use liepoisson_core::error::Error;
use liepoisson_core::field::{Field, Top};
use liepoisson_core::lanes::Simd;
use liepoisson_core::method::{AcrossComponents, Method, Taylor};
use proptest::prelude::*;

/// Coefficients of order 0 and 1 of the series of a state and one tangent vector.
fn first_coefficients(top: &Top, x: &[f64], v: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let row = top.row(1);
    let mut rows = vec![0.0_f64; 2 * row];
    rows[..9].copy_from_slice(x);
    rows[top.group()..top.group() + 9].copy_from_slice(v);
    top.derive_work(&mut rows, 1, 0);
    top.extend(&mut rows, 1, 0);
    (rows[row..row + 9].to_vec(), rows[row + top.group()..row + top.group() + 9].to_vec())
}

proptest! {
    #[test]
    fn kernel_equals_poisson_tensor_times_gradient(p in parameters(), x in vector9(), v in vector9()) {
        let (field, along) = first_coefficients(&p.top(), &x, &v);
        let expected = p.hamiltonian_vector_field(&x);
        // products of numbers up to 1.5, sums of up to 12 of them: 50 units of round-off are generous
        prop_assert!(distance(&field, &expected) < 50.0 * f64::EPSILON * 10.0, "{field:?} {expected:?}");
        // A quadratic field obeys D f(x) v = (f(x + v) - f(x - v)) / 2 exactly.
        let shifted = |sign: f64| -> Vec<f64> { x.iter().zip(&v).map(|(x, v)| x + sign * v).collect() };
        let (plus, minus) = (p.hamiltonian_vector_field(&shifted(1.0)), p.hamiltonian_vector_field(&shifted(-1.0)));
        let expected: Vec<f64> = plus.iter().zip(&minus).map(|(a, b)| (a - b) / 2.0).collect();
        prop_assert!(distance(&along, &expected) < 100.0 * f64::EPSILON * 10.0, "{along:?} {expected:?}");
    }

    /// Agreement to round-off in every coefficient: each is a sum of up to 2 (k + 1) products of coefficients.
    #[test]
    fn kernel_for_one_trajectory_agrees_with_the_kernel_for_many(p in parameters(), x in vector9()) {
        let (top, method) = (p.top(), Taylor::new(1e-12, Some(20), 1).unwrap());
        let series = |simd: Simd, alone: bool| {
            let mut block = if alone {
                AcrossComponents(method).block_for(simd, &top, 0)
            } else {
                method.block_for(simd, &top, 0)
            };
            let mut longest = vec![0.0; block.n_lanes()];
            block.load(0, 0, 0, &x);
            block.prepare(&vec![1.0; longest.len()], &mut longest);
            let mut coefficients = Vec::new();
            block.series().unwrap().copy(0, usize::MAX, &mut coefficients).unwrap();
            (coefficients, longest[0])
        };
        let (many, step) = series(Simd::Scalar, false);
        for simd in Simd::ALL.into_iter().filter(|simd| simd.is_available()) {
            let (one, longest) = series(simd, true);
            prop_assert_eq!(&one, &series(Simd::Scalar, true).0, "the same bits whatever the registers");
            prop_assert!((longest / step - 1.0).abs() < 1e-9, "{longest} {step}");
            for k in 1..=20 {
                let size = many[..9 * (k + 1)].iter().fold(1.0_f64, |size, c| size.max(c.abs()));
                let bound = 4.0 * k as f64 * f64::EPSILON * size * size;
                prop_assert!(distance(&one[9 * k..9 * k + 9], &many[9 * k..9 * k + 9]) < bound, "order {k}");
            }
        }
    }

    #[test]
    fn orbit_of_the_kernel_for_one_trajectory_is_the_orbit(p in parameters(), x in vector9(), order in 2..30_usize) {
        let times = [0.0, 0.01, 3.0];
        let many = run(&p.top(), taylor(1e-15), &x, &[], &times, Simd::Scalar);
        let alone = |method| run(&p.top(), AcrossComponents(method), &x, &[], &times, Simd::widest());
        let one = alone(taylor(1e-15));
        let size = x.iter().chain(&many.states[9..]).fold(1.0_f64, |size, c| size.max(c.abs()));
        prop_assert!(distance(&one.states, &many.states) < 1e-11 * size.powi(3), "{:?} {:?}", one.states, many.states);
        // every order, even and odd, sums its series rightly: the truncation error of one short step
        let short = alone(Taylor::new(0.1, Some(order), 1_000_000).unwrap());
        let same = run(&p.top(), Taylor::new(0.1, Some(order), 1_000_000).unwrap(), &x, &[], &times, Simd::Scalar);
        prop_assert!(distance(&short.states[..18], &same.states[..18]) < 1e-12 * size.powi(3));
    }

    #[test]
    fn orbit_keeps_energy_and_casimirs(p in parameters(), x in vector9()) {
        let orbit = run(&p.top(), taylor(1e-15), &x, &[], &[0.0, 5.0], Simd::Scalar);
        let end = &orbit.states[9..];
        let size = 1.0 + end.iter().chain(&x).fold(0.0_f64, |size, c| size.max(c.abs()));
        // 20 to 60 steps with errors of a few units of round-off each, relative to the square of the size
        let bound = 2e-13 * size * size;
        prop_assert!((p.energy(end) - p.energy(&x)).abs() < bound, "{} {bound}", p.energy(end) - p.energy(&x));
        prop_assert!(distance(&p.casimirs(end), &p.casimirs(&x)) < bound);
    }

    #[test]
    fn symmetric_top_with_axial_vectors_keeps_l3_exactly(
        p in parameters(), moment in 0.5..2.0_f64, x in vector9()
    ) {
        let lagrange = Parameters { inertia: [moment, moment, p.inertia[2]], a: [0.0, 0.0, p.a[2]], b: [0.0, 0.0, p.b[2]], ..p };
        let orbit = run(&lagrange.top(), taylor(1e-15), &x, &[], &[0.0, 5.0], Simd::Scalar);
        prop_assert_eq!(orbit.states[9 + 2], x[2]);
    }
}

#[test]
fn bad_parameters_are_refused_by_name() {
    let [one, zero] = [[1.0; 3], [0.0; 3]];
    assert_eq!(Top::new([1.0, 0.0, 1.0], zero, zero, 0.0), Err(Error::Inertia { got: [1.0, 0.0, 1.0] }));
    assert!(matches!(Top::new([1.0, f64::NAN, 1.0], zero, zero, 0.0), Err(Error::Inertia { .. })));
    let infinite = [0.0, f64::INFINITY, 0.0];
    assert_eq!(Top::new(one, infinite, zero, 0.0), Err(Error::ParameterNotFinite { name: "a", got: f64::INFINITY }));
    assert!(matches!(Top::new(one, zero, zero, f64::NAN), Err(Error::ParameterNotFinite { name: "epsilon", .. })));
}
