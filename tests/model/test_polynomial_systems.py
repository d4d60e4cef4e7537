"""What is derived without SymPy is what SymPy derives, for every entry of the catalog that is read as a polynomial."""

from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

import liepoisson as lp
from liepoisson.algebra.rational_polynomials import expression_of, in_words
from liepoisson.compile.lowering import lower
from liepoisson.formula.expression import read_expression
from liepoisson.formula.scope import Scope
from liepoisson.model.known_integrals import known_integrals, known_polynomials
from liepoisson.model.polynomial_view import read_polynomial
from liepoisson.model.system_text import formula_text
from liepoisson.model.top_parameters import match_polynomial_top, match_top, recognised_top
from liepoisson.model.tops import Top

OTHERS = {
    "double-pendulum", "goryachev", "kepler-on-the-sphere", "spring-pendulum", "toda",  # no polynomials
    "lotka-volterra-3", "lotka-volterra-4", "sklyanin", "volterra-lattice-5",  # tensors by formulas
    "reduced-mhd-3", "zeitlin-3", "zeitlin-5",  # irrational structure constants
    "cubic-top-complex", "cubic-top-double", "cubic-top-split", "twisted-top",  # symbols
}  # fmt: skip
READ = tuple(name for name in lp.catalog.names() if name not in OTHERS)


@pytest.mark.parametrize("name", lp.catalog.names())
def test_all_entries_are_read_that_can_be(name):
    is_read = not lp.catalog.entry(name).symbols and lp.catalog.system(name).polynomial_hamiltonian is not None
    assert is_read is (name not in OTHERS)


def by_sympy(name):
    """The same system, given as a SymPy expression."""
    read = lp.catalog.system(name)
    return lp.systems.System(read.bracket, read.hamiltonian, integrals=read.integrals)


def expressions(system, polynomials):
    return [expression_of(polynomial, system.variables) for polynomial in polynomials]


@pytest.mark.parametrize("name", READ)
def test_equations_field_and_invariants_are_those_of_sympy(name):
    system, other = lp.catalog.system(name), by_sympy(name)
    assert other.polynomial_hamiltonian is None
    energy = expression_of(system.polynomial_hamiltonian, system.variables)
    assert sp.expand(energy - other.hamiltonian) == 0
    assert expressions(system, system.polynomial_rates) == [sp.expand(rate) for rate in other.equations.values()]
    assert system.top_parameters == other.top_parameters
    if other.top_parameters is None:
        assert system.field() == lower(other.bracket, other.hamiltonian) == other.field()
    casimirs = system.bracket.polynomial_casimirs()
    assert expressions(system, casimirs) == [sp.expand(casimir) for casimir in other.bracket.casimirs()]
    wanted = [sp.expand(invariant) for invariant in other.invariants.values()]
    assert list(system.polynomial_invariants) == list(other.invariants)
    assert expressions(system, system.polynomial_invariants.values()) == wanted
    for rate, expression in zip(system.polynomial_rates, system.equations.values(), strict=True):
        assert in_words(rate, system.component_names) == formula_text(sp.expand(expression))


@pytest.mark.parametrize("name", READ[::4])
def test_values_and_derivatives_are_those_of_compiled_expressions(name):
    system, other = lp.catalog.system(name), by_sympy(name)
    x = lp.sample_states(system, 5, seed=3)
    mine, theirs = system.functions, other.functions
    pairs = [(mine.energy, theirs.energy), *zip(mine.casimirs.values(), theirs.casimirs.values(), strict=True)]
    for function, compiled in pairs:
        assert (function.polynomial is None, compiled.polynomial is None) == (False, True)
        for part in ("__call__", "gradient", "hessian"):
            found, wanted = getattr(function, part)(x), getattr(compiled, part)(x)
            np.testing.assert_allclose(found, wanted, rtol=1e-13, atol=1e-14)
    np.testing.assert_allclose(system.vector_field(x), other.vector_field(x), rtol=1e-13, atol=1e-14)


SCOPE = Scope(fields={"u": ("1", "2", "3")}, parameters={"k": Fraction(2, 3), "v": (1, "1/2", -2)})
NAMES, SYMBOLS = ("u1", "u2", "u3"), sp.symbols("u1:4")
atoms = st.sampled_from(["u1", "u2", "u3", "k", "v[2]", "2", "1/3", "dot(u, v)", "dot(u, inv(v)*u)"])
formulas = st.recursive(
    atoms,
    lambda inner: st.one_of(
        st.tuples(inner, inner).map(lambda pair: f"({pair[0]} + {pair[1]})"),
        st.tuples(inner, inner).map(lambda pair: f"({pair[0]} - {pair[1]})"),
        st.tuples(inner, inner).map(lambda pair: f"({pair[0]})*({pair[1]})"),
        st.tuples(inner, st.integers(0, 3)).map(lambda pair: f"({pair[0]})^{pair[1]}"),
    ),
    max_leaves=6,
)


@settings(deadline=None, max_examples=40, derandomize=True)
@given(formulas)
def test_formulas_are_read_as_sympy_reads_them(text):
    polynomial = read_polynomial(text, SCOPE, NAMES)
    expression = read_expression(text, SCOPE, insert_values=True)
    assert polynomial is not None
    assert expression_of(polynomial, SYMBOLS) == sp.expand(expression)
    for k, symbol in enumerate(SYMBOLS):
        assert expression_of(polynomial.derivative(k), SYMBOLS) == sp.expand(expression.diff(symbol))


@pytest.mark.parametrize(
    "text", ["sin(u1)", "1/u1", "u1^(1/2)", "pi*u1", "norm(u)", "u1^17", "u1^k", "w*u1", "u1 +", "u", "sqrt(2)*u1"]
)
def test_what_is_no_small_rational_polynomial_is_left_to_sympy(text):
    assert read_polynomial(text, SCOPE, NAMES) is None


@pytest.mark.parametrize(
    "text",
    [
        "(u1^16)^16",
        "((u1 + u2)^16)^16",
        "((((u1^16)^16)^16)^16)^16",
        "((2^100*u1 + u2)^16)^2",
        "(u1 + u2 + u3 + 1)^16*(u1 - u2 + 2*u3 + 3)^16",
        "*".join(["(u1^5 + u1^4*u2 + u1^3*u2^2 + u1^2 + u1*u2 + u2^3 + u2^2 + 1)"] * 6),
    ],
)
def test_powers_of_powers_and_products_of_sums_are_bounded(text):
    """Each exponent is small; what they make together is left to the reader that says what is too large."""
    assert read_polynomial(text, Scope(fields={"u": ("1", "2", "3")}), ("u1", "u2", "u3")) is None


def test_powers_of_sums_do_not_cancel_in_rates_and_tapes():
    """At q = 1 + d the force of (q - 1)^8/8 is -d^7; expanded, its terms of size 35 would leave 1e-15 of them."""
    system = lp.System(lp.canonical(1), "p1^2/2 + (q1 - 1)^8/8")
    assert system.polynomial_rates is not None
    d = 2.0**-10
    assert system.vector_field([1.0 + d, 0.0])[1] == -(d**7)
    tape = system.function_tape("(q1 - 1)^7*p1")
    assert any(name == "power" for name, *_ in tape.instructions)


TOPS = {
    "free, spherical": Top.free_rigid_body((2, 2, 2)),
    "heavy": Top.heavy((2, 3, 4), (1, 2, 3)),
    "Lagrange, first axis": Top(inertia=(1, 2, 2), a=(3, 0, 0), epsilon=2),
    "Lagrange, second axis, charged": Top(inertia=(2, 1, 2), a=(0, 3, 0), b=(0, 5, 0), epsilon=2),
    "Kovalevskaya": Top.kovalevskaya(),
    "two-field Kovalevskaya": Top(inertia=(4, 4, 2), a=(1, 2, 0), b=(3, -1, 0)),
    "parallel fields": Top(inertia=(2, 2, 1), a=(1, 2, 0), b=("2/3", "4/3", 0)),
    "spherical, two fields": Top(inertia=(3, 3, 3), a=(1, 2, -1), b=(0, 1, 4)),
    "spherical, tilted": Top(inertia=(3, 3, 3), a=(1, 2, -1), b=(2, 4, -2), epsilon=2),
    "beta only": Top(inertia=(2, 2, 1), b=(1, 2, 0), epsilon=2),
    "twisted": Top.twisted((2, 3, 4), (1, "-1/3", "2/7"), (0, 0, 1), "-5/3"),
}


def text_of(top, fields=3):
    """The Hamiltonian of the first fields as a user types it."""
    quadratic = [f"l{k}^2/(2*({moment}))" for k, moment in enumerate(top.inertia, start=1)]
    vectors = [("alpha", top.a), ("beta", top.b)][: fields - 1]
    linear = [f"({c})*{name}{k}" for name, vector in vectors for k, c in enumerate(vector, start=1)]
    return " + ".join([*quadratic, *linear])


@pytest.mark.parametrize("name", TOPS)
def test_known_integrals_are_those_of_sympy(name):
    top = TOPS[name]
    typed = lp.System(lp.so(3) @ lp.leibniz(3, top.epsilon), text_of(top))
    assert typed.top_parameters == top.top_parameters
    polynomials = known_polynomials(top.top_parameters)
    expressions = known_integrals(top.top_parameters, *top.bracket.fields.values())
    assert list(polynomials) == list(expressions)
    assert list(typed.polynomial_invariants) == list(typed.invariants)
    for polynomial, expression in zip(polynomials.values(), expressions.values(), strict=True):
        assert expression_of(polynomial, top.variables) == sp.expand(expression)


def random_numbers(rng, n):
    return [Fraction(int(p), int(q)) for p, q in zip(rng.integers(-3, 4, n), rng.integers(1, 4, n), strict=True)]


@pytest.mark.parametrize("fields", [1, 2, 3])
@pytest.mark.parametrize("term", ["", " + l1*l2/5", " + alpha1*l3", " + l1^3", " + l2", " + (l1 + l2)^2 - l1^2"])
def test_the_same_tops_are_found_as_with_sympy(fields, term):
    """Tops with random numbers, as they are and with a term that no top has."""
    if "alpha" in term and fields == 1:
        term = " + l1^2"
    rng = np.random.default_rng(fields)
    moments = [9 + moment for moment in random_numbers(rng, 3)]
    vectors = [random_numbers(rng, 3) if k < fields else [0, 0, 0] for k in (1, 2)]
    top = Top(inertia=moments, a=vectors[0], b=vectors[1])
    system = lp.System(lp.so(3) @ lp.leibniz(fields, "2/3"), text_of(top, fields) + term)
    found = match_polynomial_top(system.bracket, system.polynomial_rates)
    assert found == match_top(system.bracket, system.equations) == recognised_top(system)
    if not term:
        assert found is not None
    if fields == 3:
        assert system.top_parameters == found
