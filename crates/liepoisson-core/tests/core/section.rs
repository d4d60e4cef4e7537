//! Surfaces of section: crossings of known solutions, tangencies, and what does not depend on how the work is done.

use crate::common::{TWISTED_KOVALEVSKAYA, taylor};
use liepoisson_core::analysis::orbit::orbits;
use liepoisson_core::analysis::section::{Sections, Surface, sections};
use liepoisson_core::ensemble::{Control, Ensemble, Outcome};
use liepoisson_core::error::Error;
use liepoisson_core::field::{Bounds, Functions, Instruction, Quadratic, Tape};
use liepoisson_core::lanes::Simd;
use liepoisson_core::method::{Method, Taylor};
use proptest::prelude::*;
use std::f64::consts::PI;
use std::time::Duration;

const TOLERANCE: f64 = f64::EPSILON;

/// `x' = y, y' = -x`, as data.
fn oscillator() -> Quadratic {
    Quadratic::new(2, &[], &[(0, 1, 1.0), (1, 0, -1.0)], &[]).unwrap()
}

/// The surface `c . x + constant = 0`.
fn plane(coefficients: &[f64], constant: f64) -> Surface {
    let terms = coefficients.iter().copied().enumerate().collect();
    surface(coefficients.len(), vec![Instruction::Linear { terms, constant }])
}

/// The surface on which the last of some instructions is zero.
fn surface(n: usize, instructions: Vec<Instruction>) -> Surface {
    let output = n + instructions.len() - 1;
    Surface {
        function: Functions::new(n, instructions, vec![output]).unwrap(),
        kept: None,
        guard: None,
        direction: 0,
        n_crossings: None,
        sides: vec![],
    }
}

fn run<F: Bounds>(field: &F, states: &[f64], times: [f64; 2], surface: &Surface, threads: usize, simd: Simd) -> Sections
where
    Taylor: Method<F>,
{
    let ensemble = Ensemble { field, method: taylor(TOLERANCE), states, tangents: &[], n_tangents: 0, times: &times };
    sections(&ensemble, surface, threads, simd, &Control::default(), |_| ()).unwrap()
}

fn alone<F: Bounds>(field: &F, start: &[f64], times: [f64; 2], surface: &Surface) -> Sections
where
    Taylor: Method<F>,
{
    run(field, start, times, surface, 1, Simd::widest())
}

#[test]
fn an_oscillator_crosses_where_its_cosine_is_zero() {
    // x = cos t, from (1, 0): zero at pi/2 + k pi, falling first
    for end in [40.0, -40.0] {
        let found = alone(&oscillator(), &[1.0, 0.0], [0.0, end], &plane(&[1.0, 0.0], 0.0));
        assert_eq!(found.crossing_counts, [13]);
        for (k, (time, sign)) in found.crossings.times.iter().zip(&found.crossings.signs).enumerate() {
            let wanted = (0.5 + k as f64) * PI * end.signum();
            assert!((time - wanted).abs() < 2e-14, "{time} for {wanted}");
            assert_eq!(*sign, if k % 2 == 0 { -1 } else { 1 });
        }
        assert!(found.crossings.states.chunks(2).all(|state| state[0].abs() < 1e-15));
        assert_eq!(found.touch_counts, [0]);
        assert_eq!(found.uncertified[0].n_unbounded, 0);
    }
}

#[test]
fn a_pair_of_crossings_at_the_top_of_a_swing_is_found_down_to_round_off() {
    // x = cos t meets x = 1 - d twice a period, 2 sqrt(2 d) apart, and x = 1 + d never
    let turns = 50;
    let end = turns as f64 * 2.0 * PI;
    for d in [1e-4, 1e-6, 1e-8, 1e-10, 1e-12] {
        let inside = alone(&oscillator(), &[-1.0, 0.0], [0.0, end], &plane(&[1.0, 0.0], d - 1.0));
        assert_eq!(inside.crossing_counts, [2 * turns], "d = {d}");
        for pair in inside.crossings.times.chunks(2) {
            let wanted = 2.0 * libm::acos(1.0 - d);
            // a double zero moves as the square root of the round-off of the state
            assert!((pair[1] - pair[0] - wanted).abs() < 1e-13 / d.sqrt(), "d = {d}: {pair:?}");
        }
        let outside = alone(&oscillator(), &[-1.0, 0.0], [0.0, end], &plane(&[1.0, 0.0], -d - 1.0));
        assert_eq!((outside.crossing_counts, outside.touch_counts), (vec![0], vec![0]), "d = {d}");
    }
}

#[test]
fn a_tangency_is_a_touch_or_a_pair_and_never_one_crossing() {
    let end = 40.0 * PI;
    let found = alone(&oscillator(), &[-1.0, 0.0], [0.0, end + 1.0], &plane(&[1.0, 0.0], -1.0));
    assert_eq!(found.crossing_counts[0] % 2, 0);
    assert_eq!(found.crossing_counts[0] / 2 + found.touch_counts[0], 20);
    for time in &found.touches.times {
        assert!(((time / PI).rem_euclid(2.0) - 1.0).abs() < 1e-6, "{time}");
    }
}

#[test]
fn a_start_on_the_surface_is_no_crossing() {
    let found = alone(&oscillator(), &[0.0, 1.0], [0.0, 3.0], &plane(&[1.0, 0.0], 0.0));
    assert_eq!((found.crossing_counts, found.touch_counts), (vec![0], vec![0]));
    let found = alone(&oscillator(), &[0.0, 1.0], [0.0, 4.0], &plane(&[1.0, 0.0], 0.0));
    assert_eq!(found.crossing_counts, [1]);
    assert!((found.crossings.times[0] - PI).abs() < 1e-14);
}

#[test]
fn an_orbit_that_lies_in_the_surface_is_told_from_one_that_misses_it() {
    // x^2 + y^2 is 1
    let circle = |constant: f64| {
        let sum = Instruction::Linear { terms: vec![(2, 1.0), (3, 1.0)], constant };
        surface(2, vec![Instruction::Product(0, 0), Instruction::Product(1, 1), sum])
    };
    for (constant, is_in_surface) in [(-1.0, true), (-1.0 - 1e-9, false), (-1.0 + 1e-9, false)] {
        let found = alone(&oscillator(), &[0.6, 0.8], [0.0, 20.0], &circle(constant));
        assert_eq!((found.crossing_counts, found.touch_counts), (vec![0], vec![0]));
        assert_eq!(found.uncertified[0].is_in_surface, is_in_surface);
    }
}

#[test]
fn an_orbit_in_a_surface_beside_which_others_move_lies_in_it_whatever_the_last_step_is() {
    // x'' = -x at rest, y'' = -y
    let pair = Quadratic::new(4, &[], &[(0, 1, 1.0), (1, 0, -1.0), (2, 3, 1.0), (3, 2, -1.0)], &[]).unwrap();
    for instruction in [line(0, 1.0, 0.0), Instruction::Sin(0)] {
        for end in [3.7e-3, 3.7, 370.0] {
            let found = alone(&pair, &[0.0, 0.0, 1.0, 0.0], [0.0, end], &surface(4, vec![instruction.clone()]));
            let told = (found.uncertified[0].is_in_surface, found.uncertified[0].unresolved_time);
            assert_eq!(told, (true, 0.0), "{instruction:?}, end = {end}");
        }
    }
    // y^64 has no term up to the order of the series, and does not vanish
    let power = [2, 4, 5, 6, 7, 8].map(|register| Instruction::Product(register, register));
    let found = alone(&pair, &[0.0, 0.0, 0.0, 1.0], [0.0, 1e-3], &surface(4, power.to_vec()));
    assert!(!found.uncertified[0].is_in_surface);
}

#[test]
fn direction_and_number_of_crossings_are_kept_to() {
    let all = alone(&oscillator(), &[1.0, 0.0], [0.0, 40.0], &plane(&[1.0, 0.0], 0.0));
    for direction in [-1, 1] {
        let surface = Surface { direction, n_crossings: Some(4), ..plane(&[1.0, 0.0], 0.0) };
        let found = alone(&oscillator(), &[1.0, 0.0], [0.0, 40.0], &surface);
        let wanted = all.crossings.times.iter().zip(&all.crossings.signs);
        let wanted: Vec<f64> = wanted.filter(|pair| *pair.1 == direction).map(|pair| *pair.0).take(4).collect();
        assert_eq!(found.crossings.times, wanted);
        assert_eq!(found.summaries[0].outcome, Outcome::Finished);
        assert!(found.summaries[0].time >= wanted[3] && found.summaries[0].time < wanted[3] + 4.0);
    }
}

#[test]
fn a_run_of_so_many_crossings_ends_between_the_last_one_and_the_next() {
    // many crossings in each step
    let function = vec![line(0, 50.0, 0.0), Instruction::Sin(2)];
    let all = alone(&oscillator(), &[1.0, 0.1], [0.0, 20.0], &surface(2, function.clone())).crossings;
    for n in 1..all.times.len() {
        let surface = Surface { n_crossings: Some(n), ..surface(2, function.clone()) };
        let found = alone(&oscillator(), &[1.0, 0.1], [0.0, 20.0], &surface);
        let end = found.summaries[0].time;
        assert_eq!(found.crossings.times, all.times[..n]);
        assert!(all.times[n - 1] < end && end < all.times[n], "{n}: {end}");
        assert!(end - all.times[n - 1] < 1e-10, "{n}: {end}");
        assert_eq!(found.sides, [all.signs[n - 1]]);
        // going on finds the next one, and not the same again
        let onward = Surface { n_crossings: Some(1), sides: found.sides, ..surface };
        let next = alone(&oscillator(), &found.summaries[0].state, [end, 20.0], &onward);
        assert!((next.crossings.times[0] - all.times[n]).abs() < 1e-12, "{n}");
        assert_eq!((next.crossings.signs[0], next.touch_counts[0]), (all.signs[n], 0));
    }
}

#[test]
fn a_start_on_the_surface_is_a_crossing_if_it_comes_from_the_other_side() {
    for (side, count) in [(-1, 1), (0, 0), (1, 0)] {
        let surface = Surface { sides: vec![side], ..plane(&[1.0, 0.0], 0.0) };
        let found = alone(&oscillator(), &[0.0, 1.0], [0.0, 3.0], &surface);
        assert_eq!((found.crossing_counts, found.touch_counts), (vec![count], vec![0]), "from {side}");
        assert_eq!(found.sides, [1]);
    }
    assert_eq!(
        refused(Surface { sides: vec![1, 1], ..plane(&[1.0, 0.0], 0.0) }),
        Some(Error::Length { name: "sides", wanted: 1, got: 2 })
    );
}

#[test]
fn a_component_is_followed_however_small_it_is_beside_the_others() {
    // x' = y/u, y' = -u x: y = -u sin t, which touches no round-off of x
    for u in [1.0, 1e-3, 1e-8, 1e-13, 1e-16, 1e-30, 1e-150] {
        let field = Quadratic::new(2, &[], &[(0, 1, 1.0 / u), (1, 0, -u)], &[]).unwrap();
        let found = alone(&field, &[libm::cos(0.1), -u * libm::sin(0.1)], [0.1, 40.0], &plane(&[0.0, 1.0], 0.0));
        assert_eq!((found.crossing_counts, found.touch_counts), (vec![12], vec![0]), "u = {u:e}");
        for (k, time) in found.crossings.times.iter().enumerate() {
            assert!((time - (k + 1) as f64 * PI).abs() < 1e-13, "u = {u:e}: {time}");
        }
        // the depth of a pair is judged in the units of the component
        let top = plane(&[0.0, 1.0], (1.0 - 1e-9) * u);
        let pairs = alone(&field, &[libm::cos(0.1), -u * libm::sin(0.1)], [0.1, 40.0], &top);
        assert_eq!((pairs.crossing_counts, pairs.touch_counts), (vec![14], vec![0]), "u = {u:e}");
        // near a thousandth of the largest component the error is in units of that one, in which no bound is sharp
        assert!(u == 1e-3 || pairs.uncertified[0].n_unbounded == 0, "u = {u:e}");
    }
}

#[test]
fn kept_numbers_are_functions_of_the_state_at_the_crossing() {
    let kept = Functions::new(2, vec![Instruction::Product(1, 1), Instruction::Sin(1)], vec![2, 3, 0]).unwrap();
    let surface = Surface { kept: Some(kept), ..plane(&[1.0, 0.0], 0.0) };
    let states = alone(&oscillator(), &[1.0, 0.0], [0.0, 40.0], &plane(&[1.0, 0.0], 0.0)).crossings.states;
    let found = alone(&oscillator(), &[1.0, 0.0], [0.0, 40.0], &surface).crossings.states;
    assert_eq!(found.len(), 3 * 13);
    for (kept, state) in found.chunks(3).zip(states.chunks(2)) {
        assert!((kept[0] - state[1] * state[1]).abs() < 1e-15);
        assert!((kept[1] - libm::sin(state[1])).abs() < 1e-15);
        assert_eq!(kept[2], state[0]);
    }
}

#[test]
fn an_angle_is_crossed_once_in_every_turn() {
    // theta' = p, p' = 0; the surface theta = 0 modulo a turn
    let rotor = Quadratic::new(2, &[], &[(0, 1, 1.0)], &[]).unwrap();
    let guard = Functions::new(2, vec![Instruction::Cos(0)], vec![2]).unwrap();
    let angle = Surface { guard: Some(guard), ..surface(2, vec![Instruction::Sin(0)]) };
    for (p, sign) in [(0.7, 1), (-40.0, -1)] {
        let found = alone(&rotor, &[0.3, p], [0.0, 50.0], &angle);
        let first = if p > 0.0 { 1 } else { 0 };
        let n = (0.3 + 50.0 * p).abs().div_euclid(2.0 * PI) as usize + 1 - first;
        assert_eq!((found.crossing_counts, found.touch_counts), (vec![n], vec![0]), "p = {p}");
        for (k, time) in found.crossings.times.iter().enumerate() {
            let wanted = (2.0 * PI * f64::from(sign) * (k + first) as f64 - 0.3) / p;
            assert!((time - wanted).abs() < 1e-13 * 50.0, "p = {p}: {time} for {wanted}");
        }
        assert!(found.crossings.signs.iter().all(|&found| i32::from(found) == sign));
    }
    let few = Surface { n_crossings: Some(3), ..angle.clone() };
    let found = alone(&rotor, &[0.3, 1.0], [0.0, 50.0], &few);
    assert_eq!(found.crossing_counts, [3]);
    assert!(found.summaries[0].time < 6.5 * PI);
    for (theta, is_in_surface) in [(0.0, true), (PI, false)] {
        let found = alone(&rotor, &[theta, 0.0], [0.0, 1.0], &angle).uncertified[0];
        assert_eq!((found.is_in_surface, found.unresolved_time), (is_in_surface, 0.0), "theta = {theta}");
    }
}

/// `factor x + constant`
fn line(register: usize, factor: f64, constant: f64) -> Instruction {
    Instruction::Linear { terms: vec![(register, factor)], constant }
}

/// What is found on the surface over ten turns of `x = cos t`, which begin beside a zero of no function below.
fn ten_turns(instructions: Vec<Instruction>) -> Sections {
    let start = [libm::cos(0.1), -libm::sin(0.1)];
    alone(&oscillator(), &start, [0.1, 0.1 + 20.0 * PI], &surface(2, instructions))
}

#[test]
fn steep_functions_are_followed_on_shorter_parts_of_a_step() {
    let zeros_of_sine = |factor: f64| (factor / PI).floor() as usize * 2 + 1;
    for factor in [5.0, 20.0, 50.0, 200.0] {
        let found = ten_turns(vec![line(0, factor, 0.0), Instruction::Sin(2)]);
        assert_eq!(found.crossing_counts, [20 * zeros_of_sine(factor)], "sin({factor} x)");
        assert!(found.crossings.states.chunks(2).all(|x| libm::sin(factor * x[0]).abs() < 2e-14 * factor));
        let found = ten_turns(vec![line(0, factor, 0.0), Instruction::Tanh(2)]);
        assert_eq!(found.crossing_counts, [20], "tanh({factor} x)");
        let farthest = found.crossings.states.chunks(2).fold(0.0_f64, |farthest, x| farthest.max(x[0].abs()));
        assert!(farthest < 1e-14, "tanh({factor} x): {farthest:e}");
        assert_eq!(found.uncertified[0].n_unseen, 0);
    }
}

#[test]
fn crossings_on_a_peak_that_is_much_narrower_than_a_step_are_found() {
    // exp(-k (x - 1/10)^2) = 1/2 where x = 1/10 +- sqrt(ln 2 / k); elsewhere it is 0 to all digits
    for k in [1e2, 1e4, 1e6] {
        let found = ten_turns(vec![
            line(0, 1.0, -0.1),
            Instruction::Product(2, 2),
            line(3, -k, 0.0),
            Instruction::Exp(4),
            line(5, 1.0, -0.5),
        ]);
        assert_eq!((found.crossing_counts, found.touch_counts), (vec![40], vec![0]), "k = {k:e}");
        let wanted = (core::f64::consts::LN_2 / k).sqrt();
        for state in found.crossings.states.chunks(2) {
            let error = (state[0] - 0.1).abs() - wanted;
            assert!(error.abs() < 1e-14, "k = {k:e}: {error:e}");
        }
        assert_eq!((found.uncertified[0].n_unseen, found.uncertified[0].n_unbounded), (0, 0));
    }
}

#[test]
fn a_polynomial_of_high_degree_is_followed() {
    // x^12 = 1/1000 where |x| = 1000^(-1/12)
    let power = Instruction::Power(0, 12.0);
    let found = ten_turns(vec![power, line(2, 1.0, -1e-3)]);
    assert_eq!((found.crossing_counts, found.touch_counts), (vec![40], vec![0]));
    assert_eq!(found.uncertified[0].n_unbounded, 0);
}

#[test]
fn close_pairs_on_the_long_steps_of_a_free_body_are_found() {
    // l1 swings between +-1/2, since the start is its largest value: l1' = 0 and the body turns about the third axis
    let body = liepoisson_core::field::Top::new([1.0, 2.0, 3.0], [0.0; 3], [0.0; 3], 0.0).unwrap();
    let start = [0.5, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let mut normal = [0.0; 9];
    normal[0] = 1.0;
    let zeros = alone(&body, &start, [0.0, 200.0], &plane(&normal, 0.0)).crossings.times;
    // a swing from zero to zero on the positive side holds one pair
    let swings = zeros.windows(2).skip(1).step_by(2).count();
    let end = zeros[2 * swings];
    for depth in [1e-6, 1e-9, 1e-11] {
        let found = alone(&body, &start, [0.0, end], &plane(&normal, depth - 0.5));
        // and the first way down from the start, which is on the other side of the surface
        assert_eq!(found.crossing_counts[0], 1 + 2 * swings, "depth {depth:e}");
    }
}

#[test]
fn a_pole_is_no_crossing() {
    let reciprocal = |constant: f64| vec![line(0, 0.0, 1.0), Instruction::Quotient(2, 0), line(3, 1.0, constant)];
    let found = ten_turns(reciprocal(0.0));
    assert_eq!(found.crossing_counts, [0]);
    let uncertified = found.uncertified[0];
    // a pole is in a step, which is a few of its 16384 parts
    assert!((20..=60).contains(&uncertified.n_unseen), "{uncertified:?}");
    assert!((0.0..0.02).contains(&uncertified.unresolved_time) && uncertified.unresolved_time > 0.0, "{uncertified:?}");
    assert!((uncertified.seen_to - PI / 2.0).abs() < 0.01, "{uncertified:?}");
    // 1/x = 2 where x = 1/2
    let found = ten_turns(reciprocal(-2.0));
    assert_eq!(found.crossing_counts, [20]);
    assert!(found.crossings.states.chunks(2).all(|x| (x[0] - 0.5).abs() < 1e-12));
}

#[test]
fn where_the_surface_does_not_exist_nothing_is_found_and_it_is_counted() {
    // sqrt(x) - 1/2 exists for x >= 0 only; every turn has two crossings of x = 1/4
    let found = ten_turns(vec![Instruction::Sqrt(0), line(2, 1.0, -0.5)]);
    assert_eq!(found.crossing_counts, [20]);
    assert!(found.crossings.states.chunks(2).all(|state| (state[0] - 0.25).abs() < 1e-12));
    let uncertified = found.uncertified[0];
    // x is negative half of the time; where it becomes so the root has no series
    assert!((uncertified.undefined_time - 10.0 * PI).abs() < 0.01, "{uncertified:?}");
    assert!(uncertified.unresolved_time > 0.0 && uncertified.unresolved_time < 0.02, "{uncertified:?}");
    assert!(uncertified.n_unseen < found.summaries[0].n_steps);
    // sqrt(x) is zero where it ends, and never crosses
    assert_eq!(ten_turns(vec![Instruction::Sqrt(0)]).crossing_counts, [0]);
}

/// `sin(factor x)`
fn sine_of(factor: f64) -> Vec<Instruction> {
    vec![line(0, factor, 0.0), Instruction::Sin(2)]
}

#[test]
fn a_function_that_cannot_be_followed_is_not_said_to_be_missed() {
    // faster than its error allows; larger than numbers go, or zero below them: no crossing, and no word of none
    for instructions in [sine_of(1e12), sine_of(1e17), vec![Instruction::Power(0, 1e308)]] {
        let found = alone(&oscillator(), &[0.9, 0.0], [0.0, 2.0], &surface(2, instructions.clone()));
        let (uncertified, n_steps) = (found.uncertified[0], found.summaries[0].n_steps);
        assert_eq!(found.summaries[0].outcome, Outcome::Finished);
        assert!((2.0 - uncertified.unresolved_time).abs() < 0.01, "{instructions:?}: {uncertified:?}");
        assert!(
            uncertified.n_unseen <= n_steps && !uncertified.is_in_surface,
            "{instructions:?}: {uncertified:?} in {n_steps}"
        );
        assert!(uncertified.seen_to < 0.01, "{instructions:?}: {uncertified:?}");
    }
}

#[test]
fn a_function_that_is_below_the_smallest_numbers_is_not_seen_there() {
    // x exp(-k x^2) has the sign of x = cos t; its numbers end where x^2 = 745/k, which is at 1 for the first of them
    let square = [Instruction::Product(0, 0)].into_iter();
    for (k, share) in [(600.0, 0.0), (1e4, 0.824), (1e6, 0.983)] {
        let rest = [line(2, -k, 0.0), Instruction::Exp(3), Instruction::Product(0, 4)];
        let found = ten_turns(square.clone().chain(rest).collect());
        assert_eq!((found.crossing_counts, found.touch_counts), (vec![20], vec![0]), "k = {k:e}");
        assert!(found.crossings.states.chunks(2).all(|x| x[0].abs() < 1e-14), "k = {k:e}");
        let unseen = found.uncertified[0].unresolved_time / (20.0 * PI);
        assert!((unseen - share).abs() < 0.01, "k = {k:e}: {unseen}");
    }
}

#[test]
fn the_inverse_of_what_is_beyond_the_largest_number_is_zero_there_only() {
    // 1/cosh(k x) = 1/2 where |x| = arcosh(2)/k; where k x > 710 the divisor is infinite
    let instructions = vec![
        line(0, 1e3, 0.0),
        Instruction::Cosh(2),
        line(0, 0.0, 1.0),
        Instruction::Quotient(4, 3),
        line(5, 1.0, -0.5),
    ];
    let found = ten_turns(instructions);
    assert_eq!(found.crossing_counts, [40]);
    let wanted = libm::acosh(2.0) / 1e3;
    assert!(found.crossings.states.chunks(2).all(|x| (x[0].abs() - wanted).abs() < 1e-13));
}

#[test]
fn a_change_of_sign_that_is_not_seen_is_counted_and_that_of_a_pole_is_not() {
    let steep = |factor: f64| ten_turns(vec![line(0, factor, 0.0), Instruction::Tanh(2)]);
    for factor in [1e4, 1e6, 1e8] {
        let found = steep(factor);
        assert_eq!((found.crossing_counts[0], found.uncertified[0].n_lost_changes), (20, 0), "tanh({factor:e} x)");
        assert_eq!(found.uncertified[0].unresolved_time, 0.0, "tanh({factor:e} x)");
    }
    // steeper than round-off of the state allows
    let found = steep(1e16);
    assert_eq!((found.crossing_counts[0], found.uncertified[0].n_lost_changes), (0, 20));
    assert!(found.uncertified[0].seen_to < PI / 2.0 && found.uncertified[0].unresolved_time > 0.0);
    let found = ten_turns(vec![line(0, 0.0, 1.0), Instruction::Quotient(2, 0)]);
    assert_eq!((found.crossing_counts[0], found.uncertified[0].n_lost_changes), (0, 0));
    assert!(found.uncertified[0].unresolved_time > 0.0);
}

#[test]
fn a_function_that_is_seen_all_the_way_says_so() {
    let found = alone(&oscillator(), &[1.0, 0.0], [0.0, 40.0], &plane(&[1.0, 0.0], -3.0));
    let uncertified = found.uncertified[0];
    assert_eq!((uncertified.n_unseen, uncertified.undefined_time, uncertified.unresolved_time), (0, 0.0, 0.0));
    assert_eq!(uncertified.seen_to, 40.0);
}

#[test]
fn a_step_of_long_work_ends_with_the_limit_of_time() {
    // a step of the oscillator has thousands of parts for these functions, and there are thousands of steps
    let (field, start) = (oscillator(), [libm::cos(0.1), -libm::sin(0.1)]);
    for factor in [3e4, 1e12] {
        let times = [0.1, 0.1 + 2e3 * PI];
        let ensemble = Ensemble {
            field: &field,
            method: taylor(TOLERANCE),
            states: &start,
            tangents: &[],
            n_tangents: 0,
            times: &times,
        };
        let surface = surface(2, sine_of(factor));
        // a machine with other work, or an emulated one, finds nothing in a short time
        let cut_within = |limit: Duration| {
            let control = Control::with_time_limit(limit);
            let begin = std::time::Instant::now();
            let cut = sections(&ensemble, &surface, 1, Simd::widest(), &control, |_| ()).unwrap();
            // to the end it would take minutes
            assert!(begin.elapsed() < 10 * limit + Duration::from_secs(3), "{:?}", begin.elapsed());
            cut
        };
        let limits: &[u64] = if factor > 1e10 { &[150] } else { &[150, 600, 2400] };
        let mut cut = cut_within(Duration::from_millis(limits[0]));
        for &limit in &limits[1..] {
            if cut.crossings.times.is_empty() {
                cut = cut_within(Duration::from_millis(limit));
            }
        }
        let end = &cut.summaries[0];
        assert_eq!(end.outcome, Outcome::TimeLimit);
        assert!(end.time > times[0] && end.time < times[1], "{}", end.time);
        assert!(cut.uncertified[0].seen_to <= end.time);
        // the end is where it says, and what was found up to there is what is found without a limit
        assert!((end.state[0] - libm::cos(end.time)).abs() < 1e-12);
        let whole = alone(&field, &start, [times[0], end.time], &surface);
        let n = cut.crossings.times.len();
        assert!(cut.crossings.times.iter().all(|&time| time <= end.time));
        assert!(whole.crossings.times.len() <= n + 1 && n <= whole.crossings.times.len() + 1, "{n}");
        assert!(factor > 1e10 || n > 0, "nothing was found");
        assert!(cut.crossings.times.iter().zip(&whole.crossings.times).all(|(a, b)| (a - b).abs() < 1e-12));
    }
}

/// What a section of an orbit of the oscillator is refused for.
fn refused(surface: Surface) -> Option<Error> {
    let (field, start) = (oscillator(), [1.0, 0.0]);
    let ensemble = Ensemble {
        field: &field,
        method: taylor(TOLERANCE),
        states: &start,
        tangents: &[],
        n_tangents: 0,
        times: &[0.0, 1.0],
    };
    sections(&ensemble, &surface, 1, Simd::Scalar, &Control::default(), |_| ()).err()
}

#[test]
fn directions_and_numbers_of_crossings_that_are_none_are_refused() {
    let plane = plane(&[1.0, 0.0], 0.0);
    assert_eq!(refused(Surface { direction: 5, ..plane.clone() }), Some(Error::Direction { got: 5 }));
    assert_eq!(refused(Surface { n_crossings: Some(0), ..plane }), Some(Error::NoCrossings));
}

#[test]
fn a_surface_of_another_dimension_is_refused() {
    assert_eq!(
        refused(plane(&[1.0; 3], 0.0)),
        Some(Error::Length { name: "variables of the surface", wanted: 2, got: 3 })
    );
}

#[test]
fn a_tape_has_the_same_section_with_estimated_errors() {
    let minus = Instruction::Linear { terms: vec![(0, -1.0)], constant: 0.0 };
    let tape = Tape::new(2, vec![minus], vec![1, 2]).unwrap();
    let found = alone(&tape, &[1.0, 0.0], [0.0, 40.0], &plane(&[1.0, 0.0], 0.0));
    let wanted = alone(&oscillator(), &[1.0, 0.0], [0.0, 40.0], &plane(&[1.0, 0.0], 0.0));
    assert_eq!(found.crossings.signs, wanted.crossings.signs);
    assert!(found.crossings.times.iter().zip(&wanted.crossings.times).all(|(a, b)| (a - b).abs() < 1e-13));
    assert!(found.uncertified[0].n_unbounded > 0);
}

/// `a . (alpha x beta)` for `a = -e1`.
fn good_surface() -> Surface {
    let difference = Instruction::Linear { terms: vec![(9, -1.0), (10, 1.0)], constant: 0.0 };
    surface(9, vec![Instruction::Product(4, 8), Instruction::Product(5, 7), difference])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// The count is that of sign changes on a grid much finer than any two crossings.
    #[test]
    fn crossings_of_the_twisted_top_are_those_of_a_fine_grid(start in prop::array::uniform9(-1.0_f64..1.0)) {
        let top = TWISTED_KOVALEVSKAYA.top();
        let found = alone(&top, &start, [0.0, 50.0], &good_surface());
        let times: Vec<f64> = (0..=50_000).map(|k| f64::from(k) * 1e-3).collect();
        let ensemble = Ensemble {
            field: &top, method: taylor(TOLERANCE), states: &start, tangents: &[], n_tangents: 0, times: &times,
        };
        let orbit = orbits(&ensemble, 1, Simd::widest(), &Control::default(), false, |_| ()).unwrap();
        let s = |x: &[f64]| x[5] * x[7] - x[4] * x[8];
        let values: Vec<f64> = orbit.states.chunks(9).map(s).collect();
        let changes: Vec<usize> = (1..values.len()).filter(|&k| (values[k] > 0.0) != (values[k - 1] > 0.0)).collect();
        let extra = found.crossing_counts[0] - changes.len();
        // pairs within one interval of the grid
        prop_assert!(extra.is_multiple_of(2) && extra <= 2, "{} and {}", found.crossing_counts[0], changes.len());
        prop_assert!(found.crossings.states.chunks(9).all(|x| s(x).abs() < 1e-15));
        prop_assert_eq!(found.uncertified[0].n_unbounded, 0);
    }
}

#[test]
fn sections_are_the_same_for_every_number_of_threads_and_every_instruction_set() {
    let top = TWISTED_KOVALEVSKAYA.top();
    let states: Vec<f64> = (0..9 * 37).map(|k| libm::sin(f64::from(k) * 1.7)).collect();
    for surface in [good_surface(), two_components()] {
        let surface = Surface { n_crossings: Some(11), direction: 1, ..surface };
        let wanted = run(&top, &states, [0.0, 60.0], &surface, 1, Simd::Scalar);
        assert!(wanted.crossing_counts.iter().sum::<usize>() > 200);
        for simd in Simd::ALL {
            for threads in [1, 2, 3] {
                let found = run(&top, &states, [0.0, 60.0], &surface, threads, simd);
                assert_eq!(found.crossings, wanted.crossings);
                assert_eq!(found.crossing_counts, wanted.crossing_counts);
                assert_eq!(found.touches, wanted.touches);
                assert_eq!(found.uncertified, wanted.uncertified);
                assert_eq!(found.summaries, wanted.summaries);
            }
        }
    }
}

/// `l3 + alpha1/2 = 1/10`
fn two_components() -> Surface {
    plane(&[0.0, 0.0, 1.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0], -0.1)
}

#[test]
fn a_linear_surface_is_seen_as_a_function_with_the_same_zeros_that_is_not_linear() {
    // looked over for all lanes at once, and step by step, since a product with 1 + l1^2 is no linear form; orbits with steps of all
    // lengths, of beta = 0, of a free body, of a top that sleeps, and backwards
    let top = TWISTED_KOVALEVSKAYA.top();
    let mut states: Vec<f64> = (0..9 * 21).map(|k| libm::sin(f64::from(k) * 1.7) * f64::from(1 + k / 27)).collect();
    states[6..9].fill(0.0);
    states[9 * 5 + 3..9 * 6].fill(0.0);
    states[9 * 9..9 * 10].copy_from_slice(&[0.0, 0.0, 0.3, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let form = two_components().function;
    let (constant, terms) = form.linear_form().unwrap();
    let form = Instruction::Linear { terms: terms.to_vec(), constant };
    let factor = Instruction::Linear { terms: vec![(9, 1.0)], constant: 1.0 };
    let unknown = surface(9, vec![Instruction::Product(0, 0), factor, form, Instruction::Product(10, 11)]);
    assert!(unknown.function.linear_form().is_none());
    for end in [80.0, -80.0] {
        let found = run(&top, &states, [0.0, end], &two_components(), 1, Simd::widest());
        let wanted = run(&top, &states, [0.0, end], &unknown, 1, Simd::widest());
        assert!(found.crossing_counts.iter().sum::<usize>() > 400);
        assert_eq!(found.crossing_counts, wanted.crossing_counts);
        assert_eq!((&found.crossings.signs, &found.touch_counts), (&wanted.crossings.signs, &wanted.touch_counts));
        assert_eq!(found.sides, wanted.sides);
        for (time, same) in found.crossings.times.iter().zip(&wanted.crossings.times) {
            assert!((time - same).abs() < 1e-11, "{time} and {same}");
        }
        for (uncertified, same) in found.uncertified.iter().zip(&wanted.uncertified) {
            assert_eq!((uncertified.n_unbounded, uncertified.n_unseen), (same.n_unbounded, same.n_unseen));
        }
    }
}
