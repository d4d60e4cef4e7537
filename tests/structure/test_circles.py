"""Coordinates on circles: which functions are periodic, and modulo what."""

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
