"""Laws of the brackets of the catalogue and of tops, at random rational points and parameters, in exact arithmetic."""

from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from liepoisson import catalog
from liepoisson.model.system import System
from liepoisson.model.tops import Top
from liepoisson.structure.bracket import Bracket
from liepoisson.structure.extension import Extension
from liepoisson.structure.extensions import leibniz, semidirect
from liepoisson.structure.lie_algebras import so

exactly = settings(deadline=None, max_examples=12, derandomize=True)

rational = st.fractions(min_value=-3, max_value=3, max_denominator=7)
positive = st.fractions(min_value=Fraction(1, 7), max_value=3, max_denominator=7)
vector = st.tuples(rational, rational, rational)


ALL = {str(bracket): bracket for bracket in (catalog.system(name).bracket for name in catalog.names())}
BRACKETS = {text: bracket for text, bracket in ALL.items() if bracket.dimension <= 12}
named = st.sampled_from(sorted(BRACKETS))


@st.composite
def bracket_and_polynomials(draw):
    """A bracket and three polynomials with three terms of degree at most two."""
    bracket = BRACKETS[draw(named)]
    variable = st.sampled_from((sp.S.One, *bracket.variables))
    term = st.tuples(rational, variable, variable)
    return bracket, *(
        sum(
            (
                sp.Rational(c.numerator, c.denominator) * u * v
                for c, u, v in draw(st.lists(term, min_size=1, max_size=3))
            )
        )
        for _ in range(3)
    )


@pytest.mark.thorough
@settings(exactly, max_examples=30)
@given(bracket_and_polynomials())
def test_brackets_are_antisymmetric_derivations_and_obey_the_jacobi_identity(drawn):
    bracket, f, g, h = drawn
    assert sp.expand(bracket(f, g) + bracket(g, f)) == 0
    assert sp.expand(bracket(f * g, h) - f * bracket(g, h) - bracket(f, h) * g) == 0
    cyclic = bracket(bracket(f, g), h) + bracket(bracket(g, h), f) + bracket(bracket(h, f), g)
    assert sp.expand(cyclic) == 0


@pytest.mark.thorough
@pytest.mark.parametrize("name", ALL)
def test_the_certificates_of_jacobi_and_rank(name):
    """The rank is even; with a complete list it is what the Casimirs leave."""
    bracket = ALL[name]
    assert bracket.jacobi_certificate().holds
    certificate = bracket.rank_certificate()
    assert certificate.lower % 2 == 0
    if bracket.casimir_report().complete:
        assert certificate.proved
        assert certificate.lower == bracket.rank() == bracket.dimension - bracket.casimir_report().independent


@pytest.mark.parametrize("name", BRACKETS)
def test_gradients_of_casimirs_are_null_vectors_of_an_antisymmetric_tensor(name):
    bracket = BRACKETS[name]
    J = bracket.poisson_tensor()
    assert (J + J.T).is_zero_matrix
    assert set(bracket.jacobi_residuals().values()) <= {0}
    for casimir in bracket.casimirs():
        assert set(bracket.vector_field(casimir)) == {0}
        assert not any((J * sp.Matrix([casimir.diff(x) for x in bracket.variables])).expand())


@exactly
@given(named, st.data())
def test_the_rank_at_a_point_is_even_and_bounded(name, data):
    bracket = BRACKETS[name]
    point = data.draw(st.lists(rational, min_size=bracket.dimension, max_size=bracket.dimension))
    rank = bracket.rank(point)
    assert rank % 2 == 0
    assert rank <= bracket.rank()


@exactly
@given(st.lists(st.sampled_from([(i, j) for i in range(3) for j in range(i, 3)]), max_size=2), rational, st.data())
def test_the_jacobi_certificate_agrees_with_the_residuals(changed, value, data):
    products = {pair: dict(row) for pair, row in leibniz(3).products.items()}
    for pair in changed:
        products[pair] = {data.draw(st.integers(0, 2)): value}
    bracket = so(3) @ Extension.from_products(3, products, check=False)
    holds = set(bracket.jacobi_residuals().values()) == {0}
    certificate = bracket.jacobi_certificate()
    assert certificate.holds is holds
    assert bool(certificate.failures) is not holds


def flipped(*entries):
    """The Leibniz bracket with the sign of some entries W[lam][mu][nu] flipped."""
    W = [[list(row) for row in plane] for plane in leibniz(3, "epsilon").tensor]
    for lam, mu, nu in entries:
        W[lam][mu][nu] = -W[lam][mu][nu]
    return Bracket(so(3), Extension(W, check=False))


def test_a_flipped_cocycle_changes_the_casimirs():
    # epsilon -> -epsilon is again a Leibniz bracket (beta -> -beta), so Jacobi holds; the Casimir C1 does not.
    bracket, right = flipped((2, 1, 1)), so(3) @ leibniz(3, "epsilon")
    assert set(bracket.jacobi_residuals().values()) == {0}
    assert any(value != 0 for value in bracket.vector_field(right.casimirs()[0]))


# Tops.


def hand_written_field(x, inertia, a, b, epsilon):
    """The equations of the paper with NumPy cross products."""
    l, alpha, beta = x[..., :3], x[..., 3:6], x[..., 6:]
    omega = l / inertia
    dl = np.cross(l, omega) + np.cross(alpha, a) + np.cross(beta, b)
    dalpha = np.cross(alpha, omega) + epsilon * np.cross(beta, a)
    return np.concatenate([dl, dalpha, np.cross(beta, omega)], axis=-1)


tops = st.builds(
    lambda inertia, a, b, epsilon: Top(inertia=inertia, a=a, b=b, epsilon=epsilon),
    inertia=st.tuples(positive, positive, positive).filter(lambda i: 2 * max(i) <= sum(i)),
    a=vector,
    b=vector,
    epsilon=rational,
)


@pytest.mark.thorough
@exactly
@given(tops, st.lists(rational, min_size=9, max_size=9))
def test_hand_written_field_is_j_grad_h_is_the_symbolic_field(top, point):
    x = np.array([float(value) for value in point])
    at = {v: sp.Rational(p.numerator, p.denominator) for v, p in zip(top.variables, point, strict=True)}
    gradient = sp.Matrix([top.hamiltonian.diff(v) for v in top.variables])
    exact = (top.bracket.poisson_tensor() * gradient).subs(at)
    assert list(exact) == [value.subs(at) for value in top.equations.values()]
    plain = top.field()
    numbers = [np.array(v) for v in (plain.inertia, plain.a, plain.b)]
    # At most six products of numbers below 3 * 3 * 7, each rounded a few times.
    bound = 1e-13
    for computed in (hand_written_field(x, *numbers, plain.epsilon), top.vector_field(x)):
        np.testing.assert_allclose(computed, np.array(exact, dtype=float)[:, 0], rtol=0, atol=bound)


@pytest.mark.thorough
@exactly
@given(tops)
def test_matching_finds_the_parameters_again_and_energy_and_casimirs_are_constant(top):
    again = System(top.bracket, top.hamiltonian)
    assert again.top_parameters == top.top_parameters
    assert again.field() == top.field()
    for name in ("H", "C1", "C2", "C3"):
        assert top.bracket(top.invariants[name], top.hamiltonian) == 0


@pytest.mark.thorough
@exactly
@given(tops)
def test_no_twist_is_the_charged_heavy_top(top):
    twisted = Top(inertia=top.inertia, a=top.a, b=top.b, epsilon="epsilon")
    charged = Top.charged_heavy(top.inertia, top.a, top.b)
    assert [e.subs("epsilon", 0) for e in twisted.equations.values()] == list(charged.equations.values())
    assert [e.subs("epsilon", 0) for e in twisted.bracket.casimirs()] == (so(3) @ semidirect(3)).casimirs()
