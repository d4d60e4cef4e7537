"""Canonical brackets: the signs of Hamilton's equations, names, files, and what is refused."""

import pickle
from itertools import product

import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.errors import BracketError, ParameterError, ShapeError, SystemFileError
from liepoisson.formula.styles import LATEX, PLAIN
from liepoisson.model.system_file_reader import parse_system_file
from liepoisson.report.describe import inspect


@pytest.mark.parametrize(
    "bracket", [lp.canonical(2), lp.canonical(names=("a", "b")), lp.canonical(2, names=("a", "b"), momenta=("u", "v"))]
)
def test_a_coordinate_and_its_momentum_have_the_bracket_one(bracket):
    for (i, x), (j, y) in product(enumerate(bracket.variables), repeat=2):
        assert bracket(x, y) == (1 if j == i + 2 else -1 if i == j + 2 else 0)
    assert not bracket.entries()
    assert bracket.jacobi_certificate().holds
    assert bracket.casimir_report().complete
    assert bracket.casimirs() == []
    assert bracket.rank_certificate().proved
    assert [(s.condition, s.rank, s.proved) for s in bracket.strata()] == [("everywhere", 4, True)]


def test_names():
    assert lp.canonical(2).coordinate_names_in_order == ("q1", "q2", "p1", "p2")
    assert lp.canonical(2).field_names == ("q", "p")
    assert repr(lp.canonical(2)) == "canonical(2)"
    named = lp.canonical(names=["theta", "phi"])
    assert named.coordinate_names_in_order == named.field_names == ("theta", "phi", "p_theta", "p_phi")
    assert lp.canonical(names=["x"], momenta=["u"]).coordinate_names_in_order == ("x", "u")
    for bracket in (lp.canonical(2), named):
        again = pickle.loads(pickle.dumps(bracket))
        assert (again.coordinate_names_in_order, again.constant, repr(again)) == (
            bracket.coordinate_names_in_order,
            bracket.constant,
            repr(bracket),
        )
    assert lp.canonical(1).rename("x", "y").coordinate_names_in_order == ("x1", "y1")
    assert lp.canonical(1).rename("x", "y").constant == {(0, 1): 1}


def test_formulas_know_vectors_or_scalars():
    vectors = lp.System(lp.canonical(2), "dot(p, p)/(2*m) + k*dot(q, q)/2 + q[1]*q2", {"m": 2, "k": 3})
    q1, q2, p1, _ = vectors.variables
    assert vectors.equations[q1] == p1 / 2
    assert vectors.equations[p1] == -3 * q1 - q2
    scalars = lp.System(lp.canonical(names=["x", "y"]), "(p_x^2 + p_y^2)/2 + c*cos(x - y)", {"c": "1/2"})
    x, y, p_x, _ = scalars.variables
    assert scalars.equations[p_x] == sp.sin(x - y) / 2
    assert scalars.vector_length == 4
    with pytest.raises(lp.errors.ExpressionError, match="Did you mean"):
        lp.System(lp.canonical(names=["x", "y"]), "p_x^2 + p_z^2")
    with pytest.raises(lp.errors.ExpressionError, match="exponent"):
        lp.System(lp.canonical(names=["x", "y"]), "2^x + p_x^2")
    with pytest.raises(BracketError, match="rename the parameters"):
        lp.System(lp.canonical(names=["x"]), "p_x^2 + x", {"x": 2})


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"n": 0}, ParameterError, "from 1 to 100"),
        ({"n": 101}, ParameterError, "from 1 to 100"),
        ({"n": 1.5}, ParameterError, "from 1 to 100"),
        ({}, ParameterError, "from 1 to 100; got None"),
        ({"n": 2, "names": ["x"]}, ShapeError, "needs 2 coordinates"),
        ({"names": "xy"}, ShapeError, "sequence of names"),
        ({"names": ["x"], "momenta": ["u", "v"]}, ShapeError, "one momentum for each"),
        ({"n": 1, "momenta": ["u"]}, ShapeError, "Give names="),
        ({"names": ["x", "x"]}, lp.errors.LiePoissonError, "distinct"),
        ({"names": ["x", "p_x"]}, lp.errors.LiePoissonError, "distinct"),
        ({"names": ["sin"]}, ParameterError, "function or constant"),
        ({"names": ["x 1"]}, ParameterError, "letters, digits"),
    ],
)
def test_wrong_arguments_are_refused(arguments, error, message):
    with pytest.raises(error, match=message):
        lp.canonical(**arguments)


FILE = """
name = "oscillator"
[bracket]
canonical = ["x", "y"]
[parameters]
k = 2
[hamiltonian]
expression = "(p_x^2 + p_y^2 + k*x^2 + y^4)/2"
[[reference]]
state = {x = 1, y = 2, p_x = [3], p_y = 4}
quantity = "H"
value = "43/2"
"""


def test_a_file_has_a_canonical_bracket():
    file = parse_system_file(FILE)
    assert repr(file.bracket) == "canonical bracket of x, y, p_x, p_y"
    assert file.references[0].state == (1, 2, 3, 4)
    assert file.system().hamiltonian.subs(dict(zip(file.bracket.variables, (1, 2, 3, 4), strict=True))) == sp.Rational(
        43, 2
    )
    numbered = parse_system_file(FILE.replace('["x", "y"]', "2").replace("_x", "1").replace("_y", "2").replace(
        "*x^2", "*q1^2").replace("y^4", "q2^4").split("[[ref")[0])  # fmt: skip
    assert repr(numbered.bracket) == "canonical(2)"
    renamed = parse_system_file(FILE.replace("canonical =", 'momenta = ["u", "v"]\ncanonical =').replace(
        "p_x", "u").replace("p_y", "v"))  # fmt: skip
    assert renamed.bracket.coordinate_names_in_order == ("x", "y", "u", "v")


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        ('canonical = ["x", "y"]', 'canonical = ["x", "y"]\nalgebra = "so(3)"', "algebra"),
        ('canonical = ["x", "y"]', "canonical = 1.5", "from 1 to 100"),
        ('canonical = ["x", "y"]', 'canonical = ["x", "y"]\nmomenta = ["u"]', "one momentum for each"),
        ('canonical = ["x", "y"]', 'canonical = "x"', "canonical"),
        ("x = 1, ", "", "wanted a vector for each field; x has none"),
        ("x = 1, ", "x = [1, 2], ", "wanted 1 components"),
    ],
)
def test_a_wrong_file_is_refused(before, after, message):
    with pytest.raises(SystemFileError, match=message):
        parse_system_file(FILE.replace(before, after))


def test_the_report_has_no_algebra_and_writes_momenta_with_their_coordinates():
    system = lp.System(lp.canonical(names=["theta1", "x"]), "p_theta1^2/2 + p_x^2/2 + cos(theta1)*x")
    report = inspect(system)
    assert [topic.key for topic in report.topics][:2] == ["bracket", "casimirs"]
    assert "constant part {theta1, p_theta1} = 1, {x, p_x} = 1" in report.text(PLAIN)
    assert "dimension 4 everywhere (proved)" in report.text(PLAIN)
    assert r"p_{\theta_1}" in report.text(LATEX)
    assert "theta1' = p_theta1" in str(system)


def test_cubic_hamiltonians_have_quadratic_fields():
    cubic = lp.System(lp.canonical(1), "p1^2/2 + q1^3/3 - q1*p1^2")
    assert cubic.field() == lp.fields.QuadraticField(
        2, (), ((0, 1, 1.0),), ((0, 0, 1, -2.0), (1, 0, 0, -1.0), (1, 1, 1, 1.0))
    )
    assert isinstance(lp.System(lp.canonical(1), "p1^2/2 + q1^4").field(), lp.fields.TapeField)
    assert isinstance(lp.System(lp.canonical(1), "p1^2/2 + cos(q1)").field(), lp.fields.TapeField)


def test_a_canonical_system_is_a_system_on_it():
    system = lp.systems.CanonicalSystem(
        ["x"], ["u"], "u^2/2 - cos(x)", integrals={"E": "u^2 - 2*cos(x)"}, source="here"
    )
    assert isinstance(system, lp.System)
    assert system.bracket.constant == {(0, 1): 1}
    assert list(system.invariants) == ["H", "E"]
    assert system.component_names == ("x", "u")
    other = lp.System(lp.canonical(names=["x"], momenta=["u"]), "u^2/2 - cos(x)")
    assert list(other.equations.items()) == list(system.equations.items())
