//! Enclosures of flows, section maps and periodic orbits contain what is known in closed form, or computed by other means.

use crate::common::{TWISTED_KOVALEVSKAYA, run, taylor};
use liepoisson_core::enclosure::chart::Frame;
use liepoisson_core::enclosure::eigenvalues::eigenvalues;
use liepoisson_core::enclosure::failure::Failure;
use liepoisson_core::enclosure::flow::{Bundle, Flow, Options, Tube};
use liepoisson_core::enclosure::interval::Interval;
use liepoisson_core::enclosure::lohner::StateSet;
use liepoisson_core::enclosure::matrix::{IntervalVector, Matrix, points};
use liepoisson_core::enclosure::passage::Level;
use liepoisson_core::enclosure::periodic::{Leg, periodic_orbit};
use liepoisson_core::enclosure::polynomial::{Polynomial, Sign, commutes};
use liepoisson_core::enclosure::program::Program;
use liepoisson_core::enclosure::rational::Rational;
use liepoisson_core::enclosure::section::{Section, section_map};
use liepoisson_core::ensemble::Control;
use liepoisson_core::lanes::Simd;
use proptest::prelude::*;

type Terms<'t> = &'t [(&'t str, &'t [usize])];

fn polynomials(n: usize, rows: &[Terms]) -> Vec<Polynomial> {
    let number = |text: &str| Rational::parse(text).unwrap();
    let row = |terms: &Terms| Polynomial::new(n, terms.iter().map(|&(c, factors)| (number(c), factors.to_vec())));
    rows.iter().map(|terms| row(terms).unwrap()).collect()
}

/// `x' = 10 (y - x), y' = x (28 - z) - y, z' = x y - 8 z / 3`; not a Lie-Poisson system.
fn lorenz() -> Vec<Polynomial> {
    let rows: [Terms; 3] = [
        &[("-10", &[0]), ("10", &[1])],
        &[("28", &[0]), ("-1", &[1]), ("-1", &[0, 2])],
        &[("-8/3", &[2]), ("1", &[0, 1])],
    ];
    polynomials(3, &rows)
}

/// `x' = -y - z, y' = x + y / 5, z' = 1/5 + z (x - 5.7)`.
fn roessler() -> Vec<Polynomial> {
    let rows: [Terms; 3] =
        [&[("-1", &[1]), ("-1", &[2])], &[("1", &[0]), ("0.2", &[1])], &[("0.2", &[]), ("1", &[0, 2]), ("-5.7", &[2])]];
    polynomials(3, &rows)
}

/// The twisted Kovalevskaya top of the tests: `l' = l x omega + alpha x a`, ..., `I = (2, 2, 1)`, `a = (-1, 0, 0)`.
fn top() -> Vec<Polynomial> {
    let rows: [Terms; 9] = [
        &[("1/2", &[1, 2])],
        &[("-1/2", &[0, 2]), ("-1", &[5])],
        &[("1", &[4])],
        &[("1", &[4, 2]), ("-1/2", &[5, 1])],
        &[("1/2", &[5, 0]), ("-1", &[3, 2]), ("-1", &[8])],
        &[("1/2", &[3, 1]), ("-1/2", &[4, 0]), ("1", &[7])],
        &[("1", &[7, 2]), ("-1/2", &[8, 1])],
        &[("1/2", &[8, 0]), ("-1", &[6, 2])],
        &[("1/2", &[6, 1]), ("-1/2", &[7, 0])],
    ];
    polynomials(9, &rows)
}

/// H, C1, C2, C3 of the twisted top.
fn constants() -> Vec<Polynomial> {
    let rows: [Terms; 4] = [
        &[("1/4", &[0, 0]), ("1/4", &[1, 1]), ("1/2", &[2, 2]), ("-1", &[3])],
        &[("1", &[3, 3]), ("1", &[4, 4]), ("1", &[5, 5]), ("2", &[0, 6]), ("2", &[1, 7]), ("2", &[2, 8])],
        &[("1", &[3, 6]), ("1", &[4, 7]), ("1", &[5, 8])],
        &[("1", &[6, 6]), ("1", &[7, 7]), ("1", &[8, 8])],
    ];
    polynomials(9, &rows)
}

fn flow(field: &[Polynomial], options: Options) -> Flow {
    Flow::new(Program::new(field.len(), field), options)
}

fn adaptive(step: f64) -> Options {
    Options { step, tolerance: Some(1e-17), ..Options::default() }
}

fn after(flow: &mut Flow, set: StateSet, time: f64) -> Result<(Bundle, Vec<Tube>), Failure> {
    let n = set.center().len();
    let (mut bundle, mut tubes) = (Bundle::new(vec![set], Matrix::identity(n)), vec![]);
    flow.advance(&mut bundle, time, &Control::default(), |tube| tubes.push(tube.clone()))?;
    Ok((bundle, tubes))
}

fn widest(values: &[Interval]) -> f64 {
    values.iter().map(|value| value.width()).fold(0.0, f64::max)
}

#[test]
fn the_flow_of_a_rotation_contains_sine_and_cosine_and_stays_narrow() {
    let rotation = polynomials(2, &[&[("1", &[1])], &[("-1", &[0])]]);
    for (time, options) in [(3.0, Options::default()), (-7.5, Options::default()), (100.0, adaptive(0.5))] {
        let (bundle, _) = after(&mut flow(&rotation, options), StateSet::from_box(&points(&[0.0, 1.0])), time).unwrap();
        let (sine, cosine) = libm::sincos(time);
        for (bound, value) in bundle.states[0].hull().iter().zip([sine, cosine]) {
            assert!(bound.contains(value) && bound.width() < 1e-12, "{time}: {bound:?} {value}");
        }
        let exact = [cosine, sine, -sine, cosine];
        for (bound, value) in bundle.derivative.hull().entries().iter().zip(exact) {
            assert!(bound.contains(value) && bound.width() < 1e-11, "{time}: {bound:?} {value}");
        }
    }
    // a box is turned, not wrapped: 100 turns of a box of width 0.2 by boxes would multiply it by 2^150
    let square = StateSet::from_box(&[Interval::ball(1.0, 0.1), Interval::ball(0.0, 0.1)]);
    let (bundle, _) = after(&mut flow(&rotation, Options::default()), square, 628.0).unwrap();
    assert!(widest(&bundle.states[0].hull()) < 0.4);
}

#[test]
fn the_flow_of_a_pole_contains_the_solution_and_ends_before_the_pole() {
    let square = polynomials(1, &[&[("1", &[0, 0])]]); // x = x_0 / (1 - x_0 t)
    let start = StateSet::from_box(&[Interval::new(0.9, 1.0)]);
    let (bundle, tubes) = after(&mut flow(&square, adaptive(0.1)), start.clone(), 0.5).unwrap();
    let hull = bundle.states[0].hull()[0];
    assert!(hull.lo() <= 0.9 / 0.55 && hull.hi() >= 2.0 && hull.width() < 0.5, "{hull:?}");
    let derivative = bundle.derivative.hull()[(0, 0)]; // 1 / (1 - x_0 t)^2
    assert!(derivative.contains(4.0) && derivative.contains(1.0 / (0.55 * 0.55)), "{derivative:?}");
    assert!(tubes.iter().all(|tube| tube.time.lo() >= 0.0 && tube.states[0].lo() > 0.8));
    assert!(tubes.windows(2).all(|pair| pair[0].time.hi() >= pair[1].time.lo()), "no gap between steps");
    let failure = after(&mut flow(&square, adaptive(0.1)), start, 1.2).unwrap_err();
    assert!(matches!(failure, Failure::NoStep { time } if time < 1.2), "{failure}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn orbits_of_the_top_stay_in_enclosures_of_boxes(
        center in proptest::collection::vec(-1.0..1.0_f64, 9),
        places in proptest::collection::vec(-1.0..1.0_f64, 9),
        radius in prop_oneof![Just(1e-9), Just(1e-5), Just(1e-3)],
        time in 0.3..2.5_f64,
    ) {
        let set = StateSet::from_box(&center.iter().map(|&x| Interval::ball(x, radius)).collect::<Vec<_>>());
        let (bundle, tubes) = after(&mut flow(&top(), Options::default()), set, time).unwrap();
        let start: Vec<f64> = center.iter().zip(&places).map(|(x, place)| x + 0.999 * radius * place).collect();
        let times: Vec<f64> = (0..=20).map(|k| (time * f64::from(k) / 20.0).min(time)).collect();
        let orbit = run(&TWISTED_KOVALEVSKAYA.top(), taylor(2e-16), &start, &[], &times, Simd::Scalar);
        // the orbit is in doubles: round-off of 2.5 units of time
        let near = |bound: Interval, value: f64| bound.lo() - 1e-12 <= value && value <= bound.hi() + 1e-12;
        let end = &orbit.states[9 * 20..];
        for (bound, value) in bundle.states[0].hull().iter().zip(end) {
            prop_assert!(near(*bound, *value), "{bound:?} {value}");
        }
        for (k, &time) in times.iter().enumerate() {
            let tube = tubes.iter().find(|tube| tube.time.contains(time)).unwrap();
            for (bound, value) in tube.states.iter().zip(&orbit.states[9 * k..9 * k + 9]) {
                prop_assert!(near(*bound, *value), "{time}: {bound:?} {value}");
            }
        }
        // the box is not much wider than it must be: derivatives grow at most by exp(6 t)
        prop_assert!(widest(&bundle.states[0].hull()) < 200.0 * radius * (2.0 * time).exp());
    }

    #[test]
    fn derivatives_of_the_top_are_enclosed(
        center in proptest::collection::vec(-1.0..1.0_f64, 9),
        tangent in proptest::collection::vec(-1.0..1.0_f64, 9),
        time in 0.3..2.0_f64,
    ) {
        let set = StateSet::from_box(&center.iter().map(|&x| Interval::ball(x, 1e-6)).collect::<Vec<_>>());
        let (bundle, _) = after(&mut flow(&top(), Options::default()), set, time).unwrap();
        let orbit = run(&TWISTED_KOVALEVSKAYA.top(), taylor(2e-16), &center, &tangent, &[0.0, time], Simd::Scalar);
        for (bound, value) in bundle.derivative.hull().apply(&points(&tangent)).iter().zip(&orbit.tangents[9..]) {
            prop_assert!(bound.lo() - 1e-11 <= *value && *value <= bound.hi() + 1e-11, "{bound:?} {value}");
            prop_assert!(bound.width() < 1e-2);
        }
    }
}

#[test]
fn constants_symmetries_and_reversers_of_the_top_are_recognised_exactly() {
    let (field, constants) = (top(), constants());
    assert!(constants.iter().all(|constant| constant.along(&field).unwrap().is_zero()));
    let signs = |minus: &[usize]| -> Vec<Sign> {
        (0..9).map(|i| if minus.contains(&(i % 3)) { Sign::Minus } else { Sign::Plus }).collect()
    };
    assert!(commutes(&field, &signs(&[1, 2]), false) && !commutes(&field, &signs(&[1, 2]), true));
    for reverser in [signs(&[1]), signs(&[2])] {
        assert!(commutes(&field, &reverser, true) && !commutes(&field, &reverser, false));
    }
    assert!(!commutes(&field, &signs(&[0]), true) && !commutes(&field, &signs(&[0]), false));
    let mut wrong = field.clone();
    wrong[4] = polynomials(9, &[&[("1/2", &[5, 0]), ("-1", &[3, 2]), ("-999/1000", &[8])]])[0].clone();
    assert!(!constants[1].along(&wrong).unwrap().is_zero());
}

/// The periodic orbit through sections across the flow at states along an orbit in doubles.
fn closed(
    field: &[Polynomial],
    constants: &[Polynomial],
    level: &[&str],
    states: &[Vec<f64>],
    times: &[f64],
    signs: &[Sign],
) -> Result<(Interval, Vec<IntervalVector>, Matrix<Interval>), Failure> {
    let n = field.len();
    let (program, constants) = (Program::new(n, field), Program::new(n, constants));
    let frames: Vec<Frame> = states.iter().map(|state| Frame::around(state, &program, &constants).unwrap()).collect();
    let next = |k: usize| if k + 1 < frames.len() { frames[k + 1].clone() } else { frames[0].reflected(signs) };
    let legs: Vec<Leg> =
        (0..frames.len()).map(|k| Leg { from: frames[k].clone(), to: next(k), time: times[k] }).collect();
    let values = level.iter().map(|value| Rational::parse(value).unwrap().enclosure()).collect();
    let level = Level { constants, values, reach: 1e-3 };
    let start = vec![vec![0.0; frames[0].n_directions()]; legs.len()];
    let orbit = periodic_orbit(&mut Flow::new(program, adaptive(0.1)), &level, &legs, start, &Control::default())?;
    Ok((orbit.period(), orbit.states.clone(), orbit.derivative()))
}

#[test]
fn the_shortest_periodic_orbits_of_lorenz_and_roessler_exist_with_their_multipliers() {
    // D. Viswanath, Physica D 190 (2004) 115: AB, period 1.5586522107162, multiplier 4.71294...
    let start = vec![-13.763_610_682_134_2, -19.578_751_942_451_8, 27.0];
    let (period, _, derivative) =
        closed(&lorenz(), &[], &[], &[start], &[1.558_652_210_716_175], &[Sign::Plus; 3]).unwrap();
    assert!(period.contains(1.558_652_210_716_175) && period.width() < 1e-11, "{period:?}");
    let multipliers = eigenvalues(&derivative).unwrap();
    assert!(multipliers[0].re.contains(4.712_947_273_4) && multipliers[0].re.width() < 1e-6, "{multipliers:?}");
    assert!(multipliers.iter().all(|multiplier| multiplier.is_alone && multiplier.im == Interval::ZERO));
    assert!(multipliers[1].re.contains(1.19e-10), "{multipliers:?}");

    // P. Cvitanovic et al., ChaosBook: period 5.88108845586, multiplier -2.40395353
    let start = vec![0.0, -8.380_941_743_32, 0.029_590_060_58];
    let (period, _, derivative) =
        closed(&roessler(), &[], &[], &[start], &[5.881_088_455_55], &[Sign::Plus; 3]).unwrap();
    assert!(period.contains(5.881_088_455_554) && period.width() < 1e-11, "{period:?}");
    let multipliers = eigenvalues(&derivative).unwrap();
    assert!((multipliers[0].re.mid() + 2.403_953_53).abs() < 1e-7 && multipliers[0].re.width() < 1e-8);
}

/// A periodic orbit of the top with half of its period, followed by the reflection of components 2 and 3.
const GAMMA: [f64; 9] = [
    -0.584_954_690_592_589_2,
    0.0,
    0.803_279_450_579_306_4,
    -0.091_828_064_626_935_84,
    0.0,
    1.032_194_387_546_707_3,
    0.829_694_481_646_400_6,
    0.0,
    0.558_217_759_593_432,
];
const TURN: f64 = 3.187_135_535_704_21;

fn gamma(level: &[&str], time: f64, constants: &[Polynomial]) -> Result<(Interval, Matrix<Interval>), Failure> {
    let signs: Vec<Sign> = (0..9).map(|i| if i % 3 == 0 { Sign::Plus } else { Sign::Minus }).collect();
    closed(&top(), constants, level, &[GAMMA.to_vec()], &[time], &signs).map(|(period, _, matrix)| (period, matrix))
}

#[test]
fn a_periodic_orbit_of_the_top_on_a_level_has_complex_multipliers() {
    let (period, derivative) = gamma(&["1/2", "1", "1/2", "1"], TURN, &constants()).unwrap();
    assert!(period.contains(TURN) && period.width() < 1e-11, "{period:?}");
    let multipliers = eigenvalues(&derivative).unwrap();
    let (real, imaginary) = (-5.086_363_60, 6.275_029_74);
    for multiplier in &multipliers[..2] {
        let found = (multiplier.re.mid(), multiplier.im.mid().abs());
        assert!((found.0 - real).abs() < 1e-7 && (found.1 - imaginary).abs() < 1e-7, "{multipliers:?}");
    }
    let inverse = multipliers[0].modulus() * multipliers[3].modulus();
    assert!(inverse.contains(1.0) && inverse.width() < 1e-6, "{inverse:?}");
    assert!(multipliers.iter().all(|multiplier| multiplier.is_alone), "{multipliers:?}");
}

#[test]
fn what_is_no_periodic_orbit_is_not_enclosed() {
    let level = ["1/2", "1", "1/2", "1"];
    assert!(gamma(&level, 0.7 * TURN, &constants()).is_err());
    assert!(gamma(&["3/5", "1", "1/2", "1"], TURN, &constants()).is_err(), "a level that the chart does not reach");
    // without the constants of motion the orbit is one of a family, and no operator contracts
    assert!(gamma(&[], TURN, &[]).is_err());
}

#[test]
fn a_section_map_contains_crossings_and_its_derivative() {
    // (x, y) turns, z grows: y = 0, with x falling, after half a turn from (1, 0, z)
    let rows: [Terms; 3] = [&[("-1", &[1])], &[("1", &[0])], &[("1/10", &[2])]];
    let section =
        Section::Polynomial(Program::new(3, &polynomials(3, &[&[("1", &[1]), ("1/100", &[0, 0]), ("-1/100", &[])]])));
    let (center, frame) = ([1.0, 0.0, 1.0], Matrix::identity(3));
    let coordinates = [Interval::symmetric(1e-3), Interval::ZERO, Interval::symmetric(1e-3)];
    let mut flow = flow(&polynomials(3, &rows), Options::default());
    let control = Control::default();
    let map = section_map(&mut flow, (&center, &frame, &coordinates), &section, 3.1, &control).unwrap();
    assert!(map.time.contains(std::f64::consts::PI) && map.time.width() < 1e-3, "{:?}", map.time);
    let growth = (0.1 * std::f64::consts::PI).exp();
    for (bound, value) in map.states.iter().zip([-1.0, 0.0, growth]) {
        assert!(bound.contains(value) && bound.width() < 5e-3, "{bound:?} {value}");
    }
    // at (-r, 0): s = y + (x^2 - 1) / 100; tau' = -2 x / 100 / (s') by the change of r
    let derivative = &map.derivative;
    assert!(derivative[(0, 0)].contains(-1.0) && derivative[(1, 0)].contains(-0.02), "{derivative:?}");
    assert!(derivative[(2, 2)].contains(growth) && derivative[(2, 0)].contains(0.1 * growth * 0.02), "{derivative:?}");
    let away = section_map(&mut flow, (&center, &frame, &coordinates), &section, 1.5, &control);
    assert!(away.is_err());
}

#[test]
fn a_long_flight_of_lorenz_stays_narrow() {
    // errors grow as exp(0.9 t), here by 6e7; round-off of a step is some 1e-14
    let start = StateSet::from_box(&points(&[1.0, 2.0, 20.0]));
    let (bundle, _) = after(&mut flow(&lorenz(), adaptive(0.05)), start, 20.0).unwrap();
    assert!(widest(&bundle.states[0].hull()) < 1e-3, "{:?}", bundle.states[0].hull()); // 1.7e-4
}

#[test]
fn a_flight_ends_when_it_is_asked_to() {
    let control = Control::default();
    control.cancel();
    let mut bundle = Bundle::new(vec![StateSet::from_box(&points(&[1.0, 2.0, 20.0]))], Matrix::identity(3));
    let ended = flow(&lorenz(), Options::default()).advance(&mut bundle, 1.0, &control, |_| ());
    assert_eq!(ended, Err(Failure::Stopped));
    let few = Options { max_steps: 3, ..Options::default() };
    let ended = flow(&lorenz(), few).advance(&mut bundle, 1.0, &Control::default(), |_| ());
    assert!(matches!(ended, Err(Failure::Steps { .. })), "{ended:?}");
}
