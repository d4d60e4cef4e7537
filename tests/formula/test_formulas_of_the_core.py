"""The reader of formulas in the core is that of Python: one table of values and refusals, the same fields."""

import tomllib
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

import liepoisson as lp
from liepoisson import _core
from liepoisson.compile.field import TapeFunction, record_of
from liepoisson.compile.tape_values import values_of_tape
from liepoisson.errors import ExpressionError, ParameterError
from liepoisson.formula.expression import read_expression
from liepoisson.formula.scope import Scope

ROOT = Path(__file__).resolve().parents[2]
TABLE = ROOT / "crates" / "liepoisson-core" / "tests" / "core" / "formulas.txt"
CATALOG = Path(lp.__file__).parent / "catalog"

FIELDS = {"l": "123", "alpha": "123", "beta": "123", "M": ("12", "13", "14", "23", "24", "34")}
PARAMETERS = {
    "I": (2, 2, 1),
    "a": (-1, 0, Fraction(1, 2)),
    "A": ((1, 2, 0), (0, 1, 0), (0, 0, 3)),
    "g": Fraction(1, 3),
    "Z": ((1, 2), (2, 4)),
}
WITHOUT_VALUES = {"epsilon": Fraction(1, 5), "n": 3, "b": (Fraction(1, 2), -1, 2), "B": ((2, 1), (Fraction(1, 3), -1))}
DECLARED = ("epsilon", "n", "b[3]", "B[2,2]")
COORDINATES = [f"{field}{component}" for field, components in FIELDS.items() for component in components]
STATE = {name: Fraction(k + 3, 7) * (-1) ** k for k, name in enumerate(COORDINATES)}


def rows():
    lines = [line for line in TABLE.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    return [tuple(part.replace("\\n", "\n").replace("\\t", "\t").replace("\\\\", "\\") for part in line.split("\t"))
            for line in lines]  # fmt: skip


@pytest.mark.parametrize(("text", "place", "wanted"), rows())
def test_the_table_of_the_core_holds_in_python(text, place, wanted):
    scope = Scope(FIELDS, PARAMETERS, DECLARED)
    if place != "=":
        with pytest.raises(ExpressionError) as caught:
            read_expression(text, scope)
        assert (caught.value.message, caught.value.position) == (wanted, int(place))
        return
    expression = read_expression(text, Scope(FIELDS, PARAMETERS | WITHOUT_VALUES), insert_values=True)
    assert read_expression(text, scope) is not None
    at_state = expression.xreplace({sp.Symbol(k): sp.Rational(x.numerator, x.denominator) for k, x in STATE.items()})
    value = complex(at_state.evalf(30))
    assert repr(value.real if value.imag == 0 else np.nan) == wanted


def texts(value):
    return [texts(entry) for entry in value] if isinstance(value, (tuple, list)) else str(value)


def typed(bracket, text, parameters):
    """A system of the core on a bracket of the package."""
    scalars = list(bracket.field_names)
    names = scalars if bracket.has_scalar_fields else [(f, list(bracket.algebra.basis_names)) for f in scalars]
    terms = [(i, j, m, str(c)) for i, j, m, c in bracket.entries()]
    terms += [(i, j, None, str(c)) for (i, j), c in bracket.constant.items()]
    return _core.TypedSystem(names, terms, text, [(name, texts(value)) for name, value in parameters.items()], [])


def rates_of(record, states):
    return values_of_tape(TapeFunction(record["n_components"], record["instructions"], record["outputs"]), states)


def test_what_the_core_refuses_is_an_error_of_python():
    with pytest.raises(ExpressionError) as caught:
        typed(lp.canonical(1), "p1^2/2 -\n cos(q2)", {})
    assert (caught.value.position, caught.value.line, caught.value.column) == (14, 2, 6)
    assert str(caught.value).endswith("\n     cos(q2)\n         ^")
    with pytest.raises(ParameterError, match="m must be a number"):
        typed(lp.canonical(1), "p1^2/(2*m)", {"m": "x"})


# The smallest and largest of them take SymPy some seconds each.
@pytest.mark.parametrize("file", sorted(CATALOG.glob("*.toml")), ids=lambda file: file.stem)
def test_catalogued_systems_have_the_field_that_python_derives(file):
    toml = tomllib.loads(file.read_text(encoding="utf-8"))
    text = toml["hamiltonian"].get("expression")
    if text is None or "symbols" in toml.get("parameters", {}) or "tensor" in toml["bracket"]:
        pytest.skip("its Hamiltonian or its parameters are not written in the file, or its bracket is not linear")
    system = lp.catalog.system(file.stem)
    field, record = system.field(), typed(system.bracket, text, toml.get("parameters", {})).field()
    assert record["kind"] == field.kind
    if field.kind == "tape":
        states = np.random.default_rng(1).uniform(0.2, 1, (20, field.n_components))
        rates = system.vector_field(states)
        np.testing.assert_allclose(rates_of(record, states), rates, rtol=1e-13, atol=1e-13 * np.abs(rates).max())
        assert len(record["instructions"]) <= len(field.instructions)
        return
    wanted = record_of(field)
    assert record.keys() == wanted.keys()
    for name, value in wanted.items():
        own = record[name]
        assert own == value or sorted(own) == sorted(value), name


def combined(inner):
    return st.one_of(
        st.tuples(inner, st.sampled_from("+-*"), inner).map(lambda p: f"({p[0]} {p[1]} {p[2]})"),
        st.tuples(inner, inner).map(lambda p: f"({p[0]})/(2 + ({p[1]})^2)"),
        st.tuples(inner, st.integers(2, 3)).map(lambda p: f"({p[0]})^{p[1]}"),
        st.tuples(st.sampled_from(("sin", "cos", "tanh", "atan", "exp")), inner).map(lambda p: f"{p[0]}({p[1]}/5)"),
        inner.map(lambda p: f"sqrt(2 + cos({p}))"),
        st.tuples(inner, inner).map(lambda p: f"dot(l, ({p[0]})*alpha - inv(I)*l*({p[1]}))"),
    )


FORMULAS = st.recursive(
    st.one_of(
        st.sampled_from(("l1", "l2", "l3", "alpha1", "alpha2", "k", "norm(alpha + l)", "pi/3", "sqrt(2)")),
        st.fractions(0, 3, max_denominator=9).map(lambda q: f"({q})"),
    ),
    combined,
    max_leaves=5,
)


def refusal_of(make):
    try:
        make()
    except ExpressionError as error:
        return error
    return None


@settings(max_examples=25, deadline=None)
@given(FORMULAS, st.lists(st.floats(-1, 1), min_size=6, max_size=6))
def test_a_formula_has_the_rates_that_python_derives(text, state):
    parameters = {"I": (2, "3/2", 1), "k": "2/7"}
    bracket = lp.so(3) @ lp.semidirect(2)
    text = f"{text} + alpha3*l1^3 + k*l2/I1"  # never of degree two, with all parameters
    refusal = refusal_of(lambda: lp.System(bracket, text, parameters=parameters))
    own_refusal = refusal_of(lambda: typed(bracket, text, parameters))
    if refusal or own_refusal:
        # both count terms, in expressions that each of them has simplified in its own way
        assert {refusal is None, own_refusal is None} == {False} or "at most" in str(refusal or own_refusal)
        return
    system = lp.System(bracket, text, parameters=parameters)
    states = np.array([state]) + 1e-3  # roots of zero have no slope
    rates = system.vector_field(states)
    own = rates_of(typed(bracket, text, parameters).field(), states)
    np.testing.assert_allclose(own, rates, rtol=1e-11, atol=1e-11 * (1 + np.abs(rates).max()))
