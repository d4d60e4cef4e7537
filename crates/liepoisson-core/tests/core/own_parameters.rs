//! Fields with parameters of their own side by side: each trajectory as if it were alone.

use crate::common::*;
use liepoisson_core::analysis::orbit::orbits;
use liepoisson_core::ensemble::{Control, Ensemble};
use liepoisson_core::error::Error;
use liepoisson_core::field::{Quadratic, Quadratics, Top, Tops};
use liepoisson_core::lanes::Simd;
use liepoisson_core::method::{Method, MixedTaylor};
use proptest::prelude::*;

const TIMES: [f64; 3] = [0.0, 0.7, 2.0];

fn agree<M: Method<Top> + Method<Tops>>(tops: &[Top], method: M, states: &[f64], tangents: &[f64]) {
    let field = Tops::new(tops.to_vec()).unwrap();
    let together = Ensemble { field: &field, method, states, tangents, n_tangents: 1, times: &TIMES };
    let found = everywhere(|simd, threads| {
        let control = Control::default();
        let together = orbits(&together, threads, simd, &control, true, |_| ()).unwrap();
        for (k, top) in tops.iter().enumerate() {
            let trajectory = 9 * k..9 * (k + 1);
            let (states, tangents) = (&states[trajectory.clone()], &tangents[trajectory]);
            let alone = Ensemble { field: top, method, states, tangents, n_tangents: 1, times: &TIMES };
            let alone = orbits(&alone, 1, simd, &control, true, |_| ()).unwrap();
            let rows = 27 * k..27 * (k + 1);
            // no sign of zero: a constant that is zero is passed over, unless that of a neighbour is not
            let same = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| a == b || a.is_nan() && b.is_nan());
            assert!(same(&together.states[rows.clone()], &alone.states), "{k}");
            assert!(same(&together.tangents[rows], &alone.tangents), "{k}");
            assert_eq!(together.series[k].times, alone.series[0].times);
            assert_eq!(together.summaries[k].outcome, alone.summaries[0].outcome);
        }
        together
    });
    for other in &found[1..] {
        assert_eq!(bits(&found[0].states), bits(&other.states));
        assert_eq!(bits(&found[0].tangents), bits(&other.tangents));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn each_trajectory_is_that_of_its_own_top(
        parameters in prop::collection::vec(parameters(), 1..40), bad in prop::option::of(0..40_usize),
    ) {
        let tops: Vec<Top> = parameters.iter().map(Parameters::top).collect();
        let mut states = starts(tops.len());
        let tangents: Vec<f64> = starts(tops.len()).iter().rev().copied().collect();
        if let Some(trajectory) = bad {
            states[9 * (trajectory % tops.len())] = f64::NAN;
        }
        agree(&tops, taylor(1e-10), &states, &tangents);
        agree(&tops, MixedTaylor(taylor(1e-9)), &states, &tangents);
    }
}

/// Random coefficients for the same terms, whose constants, factors and products enter several components.
fn quadratic(coefficients: &[f64]) -> Quadratic {
    let c = |k: usize| coefficients[k];
    let linear = [(0, 1, c(2)), (1, 2, c(3)), (2, 0, c(4)), (2, 1, c(5))];
    let products = [(0, 1, 2, c(6)), (1, 0, 2, c(7)), (1, 1, 2, c(8)), (2, 0, 1, c(9)), (2, 2, 2, c(10))];
    Quadratic::new(3, &[(0, c(0)), (2, c(1))], &linear, &products).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn quadratic_fields_with_the_same_terms_share_registers(
        coefficients in prop::collection::vec(prop::collection::vec(prop_oneof![-1.0..-0.1_f64, 0.1..1.0_f64], 11), 1..30),
    ) {
        let fields: Vec<Quadratic> = coefficients.iter().map(|c| quadratic(c)).collect();
        let all = Quadratics::new(fields.iter().cloned().map(Ok)).unwrap();
        let states: Vec<f64> = (0..3 * fields.len()).map(|k| 0.3 * libm::sin(k as f64)).collect();
        let tangents: Vec<f64> = (0..3 * fields.len()).map(|k| libm::cos(k as f64)).collect();
        let (method, control) = (taylor(1e-10), Control::default());
        let together =
            Ensemble { field: &all, method, states: &states, tangents: &tangents, n_tangents: 1, times: &TIMES };
        let found = everywhere(|simd, threads| orbits(&together, threads, simd, &control, false, |_| ()).unwrap());
        for other in &found {
            for (k, field) in fields.iter().enumerate() {
                let trajectory = 3 * k..3 * (k + 1);
                let (states, tangents) = (&states[trajectory.clone()], &tangents[trajectory]);
                let alone = Ensemble { field, method, states, tangents, n_tangents: 1, times: &TIMES };
                let alone = orbits(&alone, 1, Simd::widest(), &control, false, |_| ()).unwrap();
                prop_assert_eq!(bits(&other.states[9 * k..9 * (k + 1)]), bits(&alone.states));
                prop_assert_eq!(bits(&other.tangents[9 * k..9 * (k + 1)]), bits(&alone.tangents));
            }
        }
    }
}

#[test]
fn fields_with_other_terms_are_refused() {
    let some = quadratic(&[1.0; 11]);
    let other = Quadratic::new(3, &[], &[], &[(0, 1, 2, 1.0)]).unwrap();
    let refused = Quadratics::new([Ok(some.clone()), Ok(some), Ok(other)]).map(|_| ());
    assert_eq!(refused, Err(Error::OtherTerms { trajectory: 2 }));
    assert!(Quadratics::new([]).is_err());
}

#[test]
fn there_is_one_top_for_each_trajectory() {
    let field = Tops::new(vec![TWISTED_KOVALEVSKAYA.top(); 3]).unwrap();
    let states = starts(2);
    let ensemble =
        Ensemble { field: &field, method: taylor(1e-10), states: &states, tangents: &[], n_tangents: 0, times: &TIMES };
    assert_eq!(ensemble.check(), Err(Error::Length { name: "states", wanted: 27, got: 18 }));
    assert!(Tops::new(vec![]).is_err());
}
