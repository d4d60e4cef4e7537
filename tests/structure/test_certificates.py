from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from liepoisson.structure.bracket import Bracket
from liepoisson.structure.extension import Extension
from liepoisson.structure.extensions import leibniz, semidirect, trivial
from liepoisson.structure.lie_algebra import LieAlgebra
from liepoisson.structure.lie_algebras import abelian, affine, se, sine, so, su

ALGEBRAS = {"se(3)": se(3), "su(3)": su(3), "so(4)": so(4)}


def flipped(algebra, pair):
    brackets = {p: {k: -c if p == pair else c for k, c in row.items()} for p, row in algebra.brackets.items()}
    return LieAlgebra.from_brackets(algebra.dimension, brackets, algebra.name, algebra.basis_names, check=False)


def test_the_certificate_counts_triples():
    certificate = (so(3) @ leibniz(3, "epsilon")).jacobi_certificate()
    assert certificate.holds
    assert certificate.n_triples == 84
    assert certificate.method == "computed: all 84 triples of coordinates"
    one, none = so(3) @ leibniz(1), abelian(2) @ leibniz(1)
    assert one.jacobi_certificate().method == "computed: the one triple of coordinates"
    assert none.jacobi_certificate().method == "computed: pairs; there are no triples of coordinates"
    assert str(certificate).startswith("Jacobi identity proved")


def test_jacobi_of_su5_with_a_leibniz_extension():
    certificate = (su(5) @ leibniz(3)).jacobi_certificate()
    assert (certificate.holds, certificate.n_triples) == (True, 59640)


@pytest.mark.thorough
def test_jacobi_over_a_cyclotomic_field():
    assert (sine(5) @ trivial()).jacobi_certificate().holds


@settings(deadline=None, max_examples=40, derandomize=True)
@given(st.sampled_from(sorted(ALGEBRAS)), st.data())
def test_a_flipped_structure_constant_breaks_jacobi(name, data):
    # so(3) would not do: every diagonal bracket in three dimensions obeys Jacobi.
    algebra = ALGEBRAS[name]
    wrong = flipped(algebra, data.draw(st.sampled_from(sorted(algebra.brackets))))
    assert (algebra @ trivial()).jacobi_certificate().holds
    certificate = (wrong @ trivial()).jacobi_certificate()
    assert not certificate.holds
    assert certificate.failures[0].residual != 0


@pytest.mark.parametrize("pair", [(0, 1), (0, 2), (1, 1)])
def test_a_wrong_product_breaks_jacobi(pair):
    products = {p: dict(row) for p, row in leibniz(3).products.items()} | {pair: {0: Fraction(1)}}
    bracket = so(3) @ Extension.from_products(3, products, check=False)
    assert not bracket.jacobi_certificate().holds


def test_the_first_failure_is_named_with_its_residual():
    wrong = flipped(se(3), (0, 4))
    bracket = wrong @ trivial()
    failure = bracket.jacobi_certificate().failures[0]
    x = {str(v): v for v in bracket.variables}
    u, v, w = (x[name] for name in failure.coordinates)
    nested = bracket(bracket(u, v), w) + bracket(bracket(v, w), u) + bracket(bracket(w, u), v)
    assert sp.expand(nested - failure.residual) == 0
    assert "the Jacobi identity fails for" in str(failure)


def test_a_residual_keeps_the_powers_of_pi():
    # The sines of this algebra are divided by pi: the residual is quadratic in them.
    algebra = sine(3)
    wrong = flipped(algebra, next(iter(algebra.brackets)))
    bracket = wrong @ trivial()
    failure = bracket.jacobi_certificate().failures[0]
    x = {str(v): v for v in bracket.variables}
    u, v, w = (x[name] for name in failure.coordinates)
    nested = bracket(bracket(u, v), w) + bracket(bracket(v, w), u) + bracket(bracket(w, u), v)
    assert sp.expand(nested - failure.residual) == 0
    assert failure.residual.has(sp.pi)


def test_a_tensor_that_is_not_symmetric_breaks_antisymmetry():
    W = [[list(row) for row in plane] for plane in leibniz(2).tensor]
    W[1][0][1] = Fraction(3)
    certificate = Bracket(so(3), Extension(W, check=False)).jacobi_certificate()
    assert not certificate.holds
    assert "antisymmetry fails for" in str(certificate)


@pytest.mark.parametrize("seed", range(5))
def test_random_antisymmetric_brackets_fail(seed):
    rng = np.random.default_rng(seed)
    brackets = {pair: {k: int(rng.integers(-2, 3)) for k in range(5)} for pair in combinations(range(5), 2)}
    algebra = LieAlgebra.from_brackets(5, brackets, check=False)
    assert not (algebra @ trivial()).jacobi_certificate().holds


def test_a_relation_between_coefficients_is_seen():
    # e0 acts on (e2, e3) by diag(s^2 + c^2, 1) and e1 by a shift: they commute because sin^2 + cos^2 = 1.
    t = sp.Symbol("t")
    for one, holds in ((sp.sin(t) ** 2 + sp.cos(t) ** 2, True), (sp.sin(t) ** 2 - sp.cos(t) ** 2, False)):
        brackets = {(0, 2): {2: one}, (0, 3): {3: 1}, (1, 2): {3: 1}}
        bracket = LieAlgebra.from_brackets(4, brackets, check=False) @ trivial()
        assert bracket.jacobi_certificate().holds is holds


@pytest.mark.parametrize(
    ("bracket", "rank"),
    [
        (so(3) @ leibniz(3, "epsilon"), 6),
        (so(3) @ semidirect(4), 6),
        (su(3) @ leibniz(2), 12),
        (affine(1) @ trivial(), 2),
    ],
)
def test_rank_certificates_meet(bracket, rank):
    certificate = bracket.rank_certificate()
    assert (certificate.lower, certificate.upper, certificate.proved) == (rank, rank, True)
    assert f"rank {rank} proved" in str(certificate)


def test_a_rank_that_is_not_proved_says_so():
    # x' = x, y' = y + x, z' = -z under e0: the invariant y/x - log x is no polynomial, and neither is its power.
    brackets = {(0, 1): {1: 1}, (0, 2): {1: 1, 2: 1}, (0, 3): {3: 2}}
    certificate = (LieAlgebra.from_brackets(4, brackets) @ trivial()).rank_certificate()
    assert (certificate.lower, certificate.proved) == (2, False)
    assert "rank at least 2, at most 4" in str(certificate)
