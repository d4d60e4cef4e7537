"""Coordinates on circles: which functions are periodic, and modulo what."""

import numpy as np
import pytest
from sympy import Rational, Symbol, cos, exp, pi, sin, sqrt

import liepoisson as lp
from liepoisson.errors import BracketError, ParameterError, ShapeError
from liepoisson.structure.circles import change, modulus, turn

theta, phi, p, w, t = map(Symbol, ("theta", "phi", "p", "w", "t"))
ANGLES = {"theta": (theta, turn()), "phi": (phi, turn())}


@pytest.mark.parametrize(
    ("function", "periodic"),
    [
        (cos(theta), True),
        (sin(3 * theta + phi) * p**2, True),
        (sin(theta / 2) ** 2, True),  # (1 - cos theta)/2
        (exp(sin(theta)) / (2 + cos(theta)), True),
        (sqrt(1 + sin(theta / 2) ** 2), True),
        (sin(theta / 2), False),
        (theta**2, False),
        (cos(w * theta), False),  # of a number w that is generic
        (cos(sqrt(2) * theta), False),
        (cos(Rational(10**6 + 1, 10**6) * theta), False),
        (p * theta, False),
    ],
)
def test_a_function_is_one_on_the_circle_if_it_is_the_same_after_a_turn(function, periodic):
    assert (change(function, theta, turn()) == 0) == periodic


@pytest.mark.parametrize(
    ("function", "wanted"),
    [
        (theta - Rational(1, 2), 2 * pi),
        (theta + sin(theta) * p, 2 * pi),
        (theta - 2 * phi, 2 * pi),
        (2 * theta - 4 * phi, 4 * pi),
        (4 * theta + 6 * phi, 4 * pi),
        (theta / 2 - phi / 3, pi / 3),
        (sin(theta), None),
        (p - 1, None),
    ],
)
def test_an_angle_is_a_function_modulo_a_turn(function, wanted):
    assert modulus(function, ANGLES, (theta, phi, p)) == wanted


def test_an_angle_seen_from_a_turning_frame_is_one_modulo_a_turn():
    circles = {**ANGLES, "t": (t, 2 * pi / w)}
    assert modulus(theta - w * t, circles, (theta, phi, p, t)).subs(w, 3) == 2 * pi


@pytest.mark.parametrize("function", [p * theta, theta + sqrt(2) * phi, theta * sin(phi)])
def test_what_is_no_function_modulo_a_number_is_refused(function):
    with pytest.raises(ParameterError, match="wanted a function on"):
        modulus(function, ANGLES, (theta, phi, p))


def test_brackets_keep_their_angles():
    bracket = lp.canonical(names=["x", "theta"], angles=["theta"])
    assert bracket.angles == ("theta",)
    assert lp.canonical(2, angles=["q2", "q1"]).angles == ("q1", "q2")
    assert bracket.rename("y", "phi", "u", "v").angles == ("phi",)
    magnetic = bracket.with_constant({**bracket.constant, ("p_x", "p_theta"): "B"})
    assert magnetic.substitute({"B": 2}).angles == ("theta",)
    tensor = lp.PoissonTensor(["phi", "z"], {("phi", "z"): "1 + k*cos(phi)"}, symbols=["k"], angles=["phi"])
    assert tensor.substitute({"k": "1/2"}).rename("psi", "z").angles == ("psi",)


A = lp.canonical(names=["a"], angles=["a"])
AB = lp.canonical(names=["a", "b"], angles=["a", "b"])


@pytest.mark.parametrize(
    ("make", "wanted"),
    [
        (lambda: lp.brackets.product(A, lp.canonical(names=["b"], angles=["b"])), ("a", "b")),
        (lambda: AB.dirac_bracket(["sin(a - b)", "p_a - p_b"]), ("a", "b")),
        (A.plus, ("a",)),
        (lambda: A.frozen([0, 0]), ("a",)),
        (lambda: A.translated([1, 0]), ("a",)),
        (lambda: lp.integrability.pencil(A, A.with_angles([])), ("a",)),
        (lambda: lp.brackets.contraction(A, {"p_a": 1}).contracted, ("a",)),
        (lambda: AB.in_invariants({"d": "a - b", "u": "p_a"}, levels={"L": "p_a + p_b"}), ("d",)),
        (
            lambda: AB.in_variables(
                {"d": "b - a + 1/2 + p_a", "p": "p_a", "e": "b", "q": "p_b + p_a"},
                {"a": "e - d + 1/2 + p", "p_a": "p", "b": "e", "p_b": "q - p"},
            ),
            ("d", "e"),
        ),
        (lambda: A.in_variables({"s": "sin(a)", "p": "p_a"}, {"a": "asin(s)", "p_a": "p"}), ()),
    ],
)
def test_brackets_made_of_others_keep_the_angles(make, wanted):
    assert make().angles == wanted


SPUN = {("x", "y"): "2 + cos(a)"}
"""{x, y} = 2 + cos(a): each function of a is a Casimir on the line, those of period 2 pi on the circle."""


@pytest.mark.parametrize(
    "make",
    [
        lambda one: lp.PoissonTensor(["a", "x", "y"], SPUN, casimirs=[one], angles=["a"]),
        lambda one: lp.PoissonTensor(["a", "x", "y"], SPUN, angles=["a"]).with_casimirs([one]),
        lambda one: lp.PoissonTensor(["a", "x", "y"], SPUN, casimirs=[one]).with_angles(["a"]),
        lambda one: lp.canonical(names=["x"], momenta=["y"]).with_constant({("x", "y"): 0}).with_angles(["x"])
        .with_casimirs([one.replace("a", "x")]),
    ],
)  # fmt: skip
def test_casimirs_that_are_given_must_be_functions_on_the_circle(make):
    assert [str(one).replace("x", "a") for one in make("sin(a)").given_casimirs] == ["sin(a)"]
    for wrong in ("a", "sin(a/2)"):
        with pytest.raises(ParameterError, match=r"a Casimir must have the period .*sines and cosines"):
            make(wrong)


def test_a_section_of_an_angle_of_a_dirac_bracket_is_taken_modulo_a_turn():
    held = lp.System(AB.dirac_bracket(["sin(a - b)", "p_a - p_b"]), "(p_a^2 + p_b^2)/2 - cos(a) - cos(b)")
    turns = lp.section(held, [0, 0, 3, 3], surface="a", t_end=10)
    np.testing.assert_allclose(turns.state[:, 0], 2 * np.pi * np.arange(1, 5), rtol=1e-13)


@pytest.mark.parametrize(
    ("make", "error", "words"),
    [
        (lambda: AB.dirac_bracket(["a - b", "p_a - p_b"]), ParameterError, "constraint must have the period"),
        (lambda: A.in_variables({"c": "2*a", "u": "p_a"}, {"a": "c/2", "p_a": "u"}), BracketError, "go round once"),
        (lambda: A.in_variables({"c": "a*p_a", "u": "p_a"}, {"a": "c/u", "p_a": "u"}), BracketError, r"2\*pi\*p_a"),
        (lambda: A.in_variables({"c": "a", "u": "p_a + a"}, {"a": "c", "p_a": "u - c"}), BracketError, "go round once"),
        (lambda: AB.in_invariants({"d": "2*a - 2*b", "u": "p_a"}), BracketError, "go round once"),
        (lambda: lp.brackets.contraction(A, {"a": 1}), BracketError, r"with_angles\(\[\]\)"),
    ],
)
def test_new_coordinates_that_are_none_on_the_circle_are_refused(make, error, words):
    with pytest.raises(error, match=words):
        make()


@pytest.mark.parametrize(
    ("make", "error", "words"),
    [
        (lambda: lp.canonical(names=["theta"], angles=["Theta"]), BracketError, "Did you mean theta"),
        (lambda: lp.canonical(names=["theta"], angles=["theta", "theta"]), BracketError, "named once"),
        (lambda: lp.canonical(names=["theta"], angles="theta"), ShapeError, r'Write for example \["theta"\]'),
        (lambda: (lp.so(3) @ lp.trivial()).with_angles(["l1"]), ParameterError, r"\{l2, l3\} must have the period"),
        (
            lambda: lp.PoissonTensor(["phi", "z"], {("phi", "z"): "phi"}, angles=["phi"]),
            ParameterError,
            r"changes by 2\*pi when phi grows by 2\*pi",
        ),
        (
            lambda: lp.System(lp.canonical(names=["x"], angles=["x"]), "p_x^2/2 + x^2"),
            ParameterError,
            r"the Hamiltonian must have the period 2\*pi in x; .*changes by 4\*pi\*x",
        ),
        (
            lambda: lp.VectorField({"x": "y", "y": "sin(x/2)"}, angles=["x"]),
            ParameterError,
            r"the rate of y must have the period 2\*pi in x",
        ),
        (
            lambda: lp.systems.CanonicalSystem(["x"], ["p"], "p^2/2", quadratures={"s": "x"}, angles=["x"]),
            ParameterError,
            "the rate of s must have the period",
        ),
    ],
)
def test_what_is_no_angle_is_refused_with_the_reason(make, error, words):
    with pytest.raises(error, match=words):
        make()
