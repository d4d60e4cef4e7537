//! Formulas: the table that Python's reader is tested with, too; fields against difference quotients; laws of brackets.

use liepoisson_core::field::Functions;
use liepoisson_core::formula::{Bracket, Coordinates, Entry, Given, Lines, Lowered, System};
use proptest::prelude::*;

/// Relative error of a value that is computed in some tens of operations.
const ROUND_OFF: f64 = 1e-14;

fn scalar(text: &str) -> Given {
    Given::Scalar(text.to_owned())
}

fn vector(texts: &[&str]) -> Given {
    Given::Vector(texts.iter().map(|&text| text.to_owned()).collect())
}

fn matrix(rows: &[&[&str]]) -> Given {
    Given::Matrix(rows.iter().map(|row| row.iter().map(|&text| text.to_owned()).collect()).collect())
}

fn named(given: &[(&str, Given)]) -> Vec<(String, Given)> {
    given.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).collect()
}

/// Functions or rates of change of the state.
fn function(lines: Lines) -> impl Fn(&[f64]) -> Vec<f64> {
    let functions = Functions::try_from(lines).unwrap();
    move |state| {
        let mut values = vec![0.0; functions.n_functions()];
        functions.series(state, &mut vec![], &mut values);
        values
    }
}

fn at(lines: &Lines, state: &[f64]) -> Vec<f64> {
    function(lines.clone())(state)
}

fn tape(system: &System) -> Lines {
    match system.field().unwrap() {
        Lowered::Tape(lines) => lines,
        other => panic!("wanted a tape; got {other:?}"),
    }
}

fn value_at(system: &System, text: &str, state: &[f64]) -> f64 {
    at(&system.functions(&[text]).unwrap(), state)[0]
}

/// The scope of the table: vectors l, alpha, beta and M; parameters with values, and four without.
fn table_scope(
    declared: &[&str],
    more: &[(&str, Given)],
    text: &str,
) -> Result<System, liepoisson_core::formula::Refusal> {
    let three = || ["1", "2", "3"].map(str::to_owned).to_vec();
    let mut fields: Vec<_> = ["l", "alpha", "beta"].map(|field| (field.to_owned(), three())).to_vec();
    fields.push(("M".to_owned(), ["12", "13", "14", "23", "24", "34"].map(str::to_owned).to_vec()));
    let mut parameters = named(&[
        ("I", vector(&["2", "2", "1"])),
        ("a", vector(&["-1", "0", "1/2"])),
        ("A", matrix(&[&["1", "2", "0"], &["0", "1", "0"], &["0", "0", "3"]])),
        ("g", scalar("1/3")),
        ("Z", matrix(&[&["1", "2"], &["2", "4"]])),
    ]);
    parameters.extend(named(more));
    let declared: Vec<String> = declared.iter().map(|&text| text.to_owned()).collect();
    System::new(Bracket::new(Coordinates::Vectors(fields), vec![])?, text, &parameters, &declared)
}

#[test]
fn the_table_holds() {
    let state: Vec<f64> = (0..15).map(|k| f64::from(k + 3) / 7.0 * if k % 2 == 0 { 1.0 } else { -1.0 }).collect();
    let values = [
        ("epsilon", scalar("1/5")),
        ("n", scalar("3")),
        ("b", vector(&["1/2", "-1", "2"])),
        ("B", matrix(&[&["2", "1"], &["1/3", "-1"]])),
    ];
    let (mut n_values, mut n_refusals) = (0, 0);
    for line in include_str!("formulas.txt").lines().filter(|line| !line.starts_with('#')) {
        let unescaped = |text: &str| text.replace("\\n", "\n").replace("\\t", "\t").replace("\\\\", "\\");
        let [formula, place, wanted] = line.split('\t').map(unescaped).collect::<Vec<_>>().try_into().unwrap();
        let read = table_scope(&["epsilon", "n", "b[3]", "B[2,2]"], &[], &formula);
        if place == "=" {
            read.unwrap_or_else(|refusal| panic!("{formula}: {refusal}"));
            let system = table_scope(&[], &values, "l1").unwrap();
            let (got, wanted) = (value_at(&system, &formula, &state), wanted.parse::<f64>().unwrap());
            let is_near = (got - wanted).abs() <= ROUND_OFF * (1.0 + wanted.abs());
            assert!(is_near || got.is_nan() && wanted.is_nan(), "{formula}: {got} for {wanted}");
            n_values += 1;
        } else {
            let refusal = read.expect_err(&formula);
            assert_eq!((refusal.message, refusal.position), (wanted, Some(place.parse().unwrap())), "{formula}");
            n_refusals += 1;
        }
    }
    assert!(n_values > 50 && n_refusals > 100, "{n_values} values and {n_refusals} refusals");
}

#[test]
fn a_place_in_a_text_of_several_lines_has_a_line_and_a_column() {
    let refusal = System::new(Bracket::semidirect(1).unwrap(), "l1 +\n  2*$ + 1", &[], &[]).unwrap_err();
    assert_eq!((refusal.position, refusal.line_and_column()), (Some(9), Some((2, 5))));
    assert!(refusal.to_string().ends_with("(line 2, column 5)."));
}

#[test]
fn names_must_stand_for_one_thing() {
    let system = |given: &[(&str, Given)], declared: &[&str]| {
        let declared: Vec<String> = declared.iter().map(|&text| text.to_owned()).collect();
        System::new(Bracket::semidirect(1).unwrap(), "l1", &named(given), &declared).unwrap_err().message
    };
    for (message, words) in [
        (system(&[("l1", scalar("2"))], &[]), "l1 is a component of l and belongs to l1"),
        (system(&[("I", vector(&["1", "2"]))], &["I1"]), "I1 is a component of I"),
        (system(&[("l", scalar("2"))], &[]), "a field and a parameter"),
        (system(&[("a", scalar("2"))], &["a[3]"]), "given twice"),
        (system(&[("sin", scalar("2"))], &[]), "function or constant"),
        (system(&[("2a", scalar("2"))], &[]), "letters"),
        (system(&[("a", scalar("1/x"))], &[]), "a must be a number"),
        (system(&[("a", scalar("1/"))], &[]), "a must be a number"),
        (system(&[("a", matrix(&[&["1", "2"], &["3"]]))], &[]), "rows of one length"),
        (system(&[], &["a[0]"]), "declared by"),
        (system(&[], &["a[3][3]"]), "declared by"),
        (system(&[], &["a[1000]"]), "declared by"),
        (system(&[], &["a b"]), "declared by"),
    ] {
        assert!(message.contains(words), "{message}");
    }
}

#[test]
fn a_parameter_without_value_is_named_where_numbers_are_needed() {
    let system =
        System::new(Bracket::leibniz(3, "epsilon").unwrap(), "kappa*l1^4", &[], &["kappa".to_owned()]).unwrap();
    assert!(system.field().unwrap_err().message.contains("got none for epsilon, kappa"));
    // {l1, l2} = -l3: l2' = J21 dH/dl1 = l3 dH/dl1
    assert_eq!(system.equations().unwrap()[..3], ["0", "4*l1^3*l3*kappa", "-4*l1^3*l2*kappa"]);
}

#[test]
fn a_quadratic_field_has_the_nearest_doubles_of_exact_coefficients() {
    let inertia = ("I", vector(&["0.1", "1/3", "sqrt(2)"]));
    let system = System::new(Bracket::semidirect(1).unwrap(), "dot(l, inv(I)*l)/2", &named(&[inertia]), &[]).unwrap();
    let Lowered::Quadratic { quadratic, linear, constant, .. } = system.field().unwrap() else { panic!("a tape") };
    assert!(linear.is_empty() && constant.is_empty());
    // l1' = l2 l3 (1/I3 - 1/I2), with 1/sqrt(2) = 0.70710678118654752440...
    let expected = [(0, 1, 2, -2.292_893_218_813_452_4), (1, 0, 2, 9.292_893_218_813_452), (2, 0, 1, -7.0)];
    assert_eq!(quadratic, expected);
}

#[test]
fn functions_of_casimirs_have_no_field() {
    for hamiltonian in
        ["sqrt(1 + dot(l, l))", "exp(dot(l, l)/7)*dot(l, l)^4", "sin(l1^2 + l2^2 + l3^2)/(2 + dot(l, l))"]
    {
        let system = System::new(Bracket::semidirect(1).unwrap(), hamiltonian, &[], &[]).unwrap();
        assert_eq!(at(&tape(&system), &[0.3, 1.7, -0.9]), [0.0; 3], "{hamiltonian}");
        assert_eq!(system.equations().unwrap(), ["0", "0", "0"]);
    }
}

#[test]
fn exponentials_beyond_the_range_of_doubles_do_not_spoil_a_field() {
    for (hamiltonian, q, wanted) in [
        ("log(1 + exp(q1))", 800.0, -1.0),
        ("1/(1 + exp(q1))", 800.0, 0.0),
        ("log(cosh(q1))", 800.0, -1.0),
        ("-1/(exp(q1) + exp(-q1))^2", -900.0, 0.0),
        ("log(exp(q1) + exp(2*q1) + 3)", 500.0, -2.0),
    ] {
        let system = System::new(Bracket::canonical(1).unwrap(), hamiltonian, &[], &[]).unwrap();
        let rates = at(&tape(&system), &[q, 0.0]);
        assert_eq!(rates[1], wanted, "{hamiltonian}: {rates:?}");
    }
}

#[test]
fn products_that_rates_have_in_common_are_formed_once() {
    let text = "(2*p1^2 + p2^2 - 2*p1*p2*cos(q1 - q2))/(2*(1 + sin(q1 - q2)^2)) - 2*cos(q1) - cos(q2)";
    let lines = tape(&System::new(Bracket::canonical(2).unwrap(), text, &[], &[]).unwrap());
    let n_of = |wanted: &[&str]| lines.instructions.iter().filter(|(name, ..)| wanted.contains(name)).count();
    // sine and cosine of three angles; s^2, p1^2, p2^2, p1 p2, p1 p2 c; s times p1 p2, c times s: each quotient once
    assert_eq!(n_of(&["sin", "cos"]), 4, "{lines:?}");
    assert!(n_of(&["product", "quotient"]) <= 14, "{lines:?}");
}

#[test]
fn structure_constants_must_obey_jacobi() {
    let three = || Coordinates::Vectors(vec![("x".to_owned(), ["1", "2", "3"].map(str::to_owned).to_vec())]);
    let constants =
        |c: &str| [(0, 1, 2, "1"), (1, 2, 0, c), (0, 2, 1, "-1")].map(|(i, j, k, c)| (i, j, k, c.to_owned())).to_vec();
    let so3 = Bracket::lie_poisson(three(), &constants("1")).unwrap();
    let given = System::new(so3, "x1^2/2 + x2^2/3 + exp(x3)", &[], &[]).unwrap();
    let known = System::new(Bracket::semidirect(1).unwrap(), "l1^2/2 + l2^2/3 + exp(l3)", &[], &[]).unwrap();
    assert_eq!(tape(&given), tape(&known));
    let mut wrong = constants("1");
    wrong.push((0, 1, 0, "1/7".to_owned()));
    let refusal = System::new(Bracket::lie_poisson(three(), &wrong).unwrap(), "x1", &[], &[]).unwrap_err();
    assert!(refusal.message.contains("Jacobi's identity; the one of x1, x2 and x3"), "{refusal}");
    let outside = Bracket::new(three(), vec![Entry { i: 0, j: 3, m: None, c: "1".to_owned() }]);
    assert!(outside.unwrap_err().message.contains("got i = 0, j = 3"));
}

/// A bracket of three coordinates by its entries.
fn tensor(entries: [&str; 3]) -> Bracket {
    let names = ["x", "y", "z"].map(str::to_owned).to_vec();
    let pairs = [(0, 1), (0, 2), (1, 2)];
    let entry = |((i, j), c): ((usize, usize), &str)| Entry { i, j, m: None, c: c.to_owned() };
    Bracket::known(Coordinates::Scalars(names), pairs.into_iter().zip(entries).map(entry).collect()).unwrap()
}

#[test]
fn entries_of_a_bracket_may_be_functions_of_the_state() {
    // three species: x' = a x y - x z and so on, whatever the logarithms are written for
    let given = named(&[("a", scalar("3/2"))]);
    let species = System::new(tensor(["a*x*y", "-x*z", "y*z"]), "x + y + z - log(x) - 2*log(y)", &given, &[]).unwrap();
    let Lowered::Quadratic { linear, quadratic, .. } = species.field().unwrap() else { panic!("of degree two") };
    assert_eq!(
        quadratic,
        [(0, 0, 1, 1.5), (0, 0, 2, -1.0), (1, 0, 1, -1.5), (1, 1, 2, 1.0), (2, 0, 2, 1.0), (2, 1, 2, -1.0)]
    );
    assert_eq!(linear, [(0, 0, -3.0), (1, 1, 1.5), (2, 2, 1.0)]);
    assert_eq!(species.general_field().unwrap(), species.field().unwrap());
    // x' = exp(x) cos(z) H_y - y H_z / (1 + x^2), by hand
    let smooth = System::new(tensor(["exp(x)*cos(z)", "-y/(1 + x^2)", "0"]), "x*y + z^3", &[], &[]).unwrap();
    let (x, y, z) = (0.3f64, -0.7f64, 1.1f64);
    let (turn, tilt) = (x.exp() * z.cos(), -y / (1.0 + x * x));
    let wanted = [turn * x + tilt * 3.0 * z * z, -turn * y, -tilt * y];
    for (value, wanted) in at(&tape(&smooth), &[x, y, z]).into_iter().zip(wanted) {
        assert!((value - wanted).abs() <= ROUND_OFF * wanted.abs(), "{value} {wanted}");
    }
    // where they are typed by a user they are structure constants
    let names = ["x", "y"].map(str::to_owned).to_vec();
    let typed = Bracket::new(Coordinates::Scalars(names), vec![Entry { i: 0, j: 1, m: None, c: "x".to_owned() }]);
    let refusal = System::new(typed.unwrap(), "x", &[], &[]).unwrap_err();
    assert!(refusal.message.contains("must not depend on the state"), "{refusal}");
}

#[test]
fn derivatives_have_their_known_forms() {
    for (potential, force) in [
        ("q1^4/4", "-q1^3"),
        ("2/q1^3", "6/q1^4"),
        ("sqrt(q1)", "-1/sqrt(q1)/2"),
        ("k*q1^n", "-k*n*q1^n/q1"),
        ("exp(k*q1)/k", "-exp(q1*k)"),
        ("log(q1)", "-1/q1"),
        ("sin(2*q1)*sin(-q1)", "2*sin(q1)*cos(2*q1) + sin(2*q1)*cos(q1)"),
        ("tan(q1)", "-sin(q1)^2/cos(q1)^2 - 1"),
        ("sinh(q1) + cosh(q1)", "-sinh(q1) - cosh(q1)"),
        ("tanh(q1)", "tanh(q1)^2 - 1"),
        ("asin(q1) + atan(q1)", "-1/sqrt(-q1^2 + 1) - 1/(q1^2 + 1)"),
        ("acos(q1)", "1/sqrt(-q1^2 + 1)"),
        ("(1 + q1^2)^(5/2)", "-5*q1*(q1^2 + 1)^(3/2)"),
        ("cos(pi/3)*q1 + sin(2*pi)*q1^2 - q1/2", "0"),
    ] {
        let declared = ["k", "n"].map(str::to_owned);
        let system = System::new(Bracket::canonical(1).unwrap(), potential, &[], &declared).unwrap();
        assert_eq!(system.equations().unwrap(), ["0", force], "{potential}");
    }
}

/// Texts of smooth functions of q1, q2, p1, p2 whose values stay in the range of doubles.
fn formulas() -> impl Strategy<Value = String> {
    let leaf = prop_oneof![
        prop::sample::select(vec!["q1", "q2", "p1", "p2", "a", "pi/3"]).prop_map(str::to_owned),
        (1u32..9, 1u32..9).prop_map(|(n, d)| format!("{n}/{d}")),
    ];
    leaf.prop_recursive(4, 24, 2, |inner| {
        prop_oneof![
            (inner.clone(), inner.clone(), prop::sample::select(vec!["+", "-", "*"]))
                .prop_map(|(a, b, sign)| format!("({a} {sign} {b})")),
            (inner.clone(), inner.clone()).prop_map(|(a, b)| format!("({a})/(2 + ({b})^2)")),
            (inner.clone(), 2u32..4).prop_map(|(a, n)| format!("({a})^{n}")),
            (inner.clone(), prop::sample::select(vec!["sin", "cos", "tanh", "atan"]))
                .prop_map(|(a, name)| format!("{name}({a})")),
            inner.clone().prop_map(|a| format!("sqrt(1 + ({a})^2)")),
            inner.clone().prop_map(|a| format!("exp(sin({a}))")),
            inner.prop_map(|a| format!("log(3 + cos({a}))")),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, ..ProptestConfig::default() })]

    #[test]
    fn rates_are_slopes_of_the_energy(formula in formulas(), state in prop::array::uniform4(-1.0f64..1.0)) {
        let given = named(&[("a", scalar("0.7"))]);
        // x q1^4: never of degree two
        let text = format!("{formula} + q1^4");
        let Ok(system) = System::new(Bracket::canonical(2).unwrap(), &text, &given, &[]) else { return Ok(()) };
        let rates = at(&tape(&system), &state);
        let energy = function(system.functions(&[&text]).unwrap());
        for (k, (row, sign)) in [(2, -1.0), (3, -1.0), (0, 1.0), (1, 1.0)].into_iter().enumerate() {
            // quotients at two distances, combined so that the error is of the fourth order
            let quotient = |h: f64| {
                let (mut up, mut down) = (state, state);
                (up[k], down[k]) = (state[k] + h, state[k] - h);
                (energy(&up)[0] - energy(&down)[0]) / (2.0 * h)
            };
            let combined = |h: f64| (4.0 * quotient(h / 2.0) - quotient(h)) / 3.0;
            let (coarse, slope) = (combined(1e-3), combined(5e-4));
            let scale = 1.0 + slope.abs() + energy(&state)[0].abs();
            // sixteen times less than what the coarse one misses
            let error = 1e-7 * scale + (slope - coarse).abs();
            prop_assert!((rates[row] - sign * slope).abs() <= error, "{text} at {state:?}, coordinate {k}: {rates:?}, {slope}");
        }
    }

    #[test]
    fn a_parameter_has_the_effect_of_its_value(formula in formulas(), state in prop::array::uniform4(-1.0f64..1.0)) {
        let text = format!("{formula} + q1^4");
        let system = |text: &str, given: &[(&str, Given)]| System::new(Bracket::canonical(2).unwrap(), text, &named(given), &[]);
        let written = text.replace('a', "\u{0}").replace("t\u{0}n", "tan").replace("\u{0}t", "at").replace('\u{0}', "(7/10)");
        let (Ok(given), Ok(written)) = (system(&text, &[("a", scalar("0.7"))]), system(&written, &[])) else { return Ok(()) };
        let (p, q) = (at(&tape(&given), &state), at(&tape(&written), &state));
        for (p, q) in p.iter().zip(&q) {
            prop_assert!((p - q).abs() <= 1e-12 * (1.0 + p.abs()), "{text}: {p} and {q}");
        }
    }

    #[test]
    fn no_text_stops_the_reader(text in "[-+*/^(),.\\[\\]0-9 lqp1αe_=]{0,60}|\\PC{0,30}") {
        let read = System::new(Bracket::semidirect(2).unwrap(), &text, &[], &[]);
        if let Err(refusal) = read {
            prop_assert!(refusal.position.is_some_and(|position| position <= text.chars().count()));
            prop_assert!(!refusal.message.is_empty());
        } else if let Ok(system) = read {
            let _ = system.field();
        }
    }

    #[test]
    fn casimirs_are_kept_by_every_hamiltonian(
        formula in formulas(),
        epsilon in 1u32..9,
        state in prop::array::uniform9(-1.0f64..1.0),
    ) {
        let names = [("q1", "l1"), ("q2", "alpha2"), ("p1", "beta1"), ("p2", "l3"), ("a", "2")];
        let mut text = formula.replace("tan", "@").replace('a', "2").replace('@', "tan");
        for (old, new) in &names[..4] {
            text = text.replace(old, new);
        }
        let text = format!("{text} + l1^4");
        let bracket = Bracket::leibniz(3, &format!("{epsilon}/4")).unwrap();
        let Ok(system) = System::new(bracket, &text, &[], &[]) else { return Ok(()) };
        let rates = at(&tape(&system), &state);
        let dot = |i: usize, j: usize| (0..3).map(|k| state[i + k] * rates[j + k]).sum::<f64>();
        let strength = f64::from(epsilon) / 4.0;
        let size = 1.0 + rates.iter().fold(0.0, |size, rate: &f64| rate.abs().max(size));
        // |beta|^2, alpha . beta, |alpha|^2 + 2 epsilon l . beta
        for casimir in [dot(6, 6), dot(3, 6) + dot(6, 3), dot(3, 3) + strength * (dot(0, 6) + dot(6, 0))] {
            prop_assert!(casimir.abs() <= 1e-13 * size, "{text}: {casimir}");
        }
    }
}
