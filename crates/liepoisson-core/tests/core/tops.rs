//! Tops with parameters of their own side by side: each trajectory as if it were alone.

use crate::common::*;
use liepoisson_core::analysis::orbit::orbits;
use liepoisson_core::ensemble::{Control, Ensemble};
use liepoisson_core::error::Error;
use liepoisson_core::field::{Top, Tops};
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
            let member = 9 * k..9 * (k + 1);
            let (states, tangents) = (&states[member.clone()], &tangents[member]);
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
        if let Some(member) = bad {
            states[9 * (member % tops.len())] = f64::NAN;
        }
        agree(&tops, taylor(1e-10), &states, &tangents);
        agree(&tops, MixedTaylor(taylor(1e-9)), &states, &tangents);
    }
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
