from fractions import Fraction

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
    large = (su(5) @ leibniz(3)).jacobi_certificate()
    assert (large.holds, large.n_triples) == (True, 59640)


@settings(deadline=None, max_examples=15, derandomize=True)
@given(st.sampled_from(sorted(ALGEBRAS)), st.data())
def test_a_flipped_structure_constant_breaks_jacobi(name, data):
    # so(3) would not do: every diagonal bracket in three dimensions obeys Jacobi.
    algebra = ALGEBRAS[name]
    wrong = flipped(algebra, data.draw(st.sampled_from(sorted(algebra.brackets))))
    assert (algebra @ trivial()).jacobi_certificate().holds
    certificate = (wrong @ trivial()).jacobi_certificate()
    assert not certificate.holds
    assert certificate.failures[0].residual != 0


def test_a_relation_between_coefficients_is_seen():
    # e0 acts on (e2, e3) by diag(s^2 + c^2, 1) and e1 by a shift: they commute because sin^2 + cos^2 = 1.
    t = sp.Symbol("t")
    for one, holds in ((sp.sin(t) ** 2 + sp.cos(t) ** 2, True), (sp.sin(t) ** 2 - sp.cos(t) ** 2, False)):
        brackets = {(0, 2): {2: one}, (0, 3): {3: 1}, (1, 2): {3: 1}}
        bracket = LieAlgebra.from_brackets(4, brackets, check=False) @ trivial()
        assert bracket.jacobi_certificate().holds is holds


@pytest.mark.parametrize(("algebra", "pair"), [(se(3), (0, 4)), (sine(3), (0, 2))])
def test_the_first_failure_is_named_with_its_residual(algebra, pair):
    """The sines of the second are divided by pi: its residual is quadratic in them."""
    bracket = flipped(algebra, pair) @ trivial()
    certificate = bracket.jacobi_certificate()
    failure, x = certificate.failures[0], {str(v): v for v in bracket.variables}
    u, v, w = (x[name] for name in failure.coordinates)
    nested = bracket(bracket(u, v), w) + bracket(bracket(v, w), u) + bracket(bracket(w, u), v)
    assert sp.expand(nested - failure.residual) == 0
    assert failure.residual.has(sp.pi) is (algebra.name == "sine(3)")
    assert "the Jacobi identity fails for" in str(failure)


def test_a_tensor_that_is_not_symmetric_breaks_antisymmetry():
    W = [[list(row) for row in plane] for plane in leibniz(2).tensor]
    W[1][0][1] = Fraction(3)
    certificate = Bracket(so(3), Extension(W, check=False)).jacobi_certificate()
    assert not certificate.holds
    assert "antisymmetry fails for" in str(certificate)


# x' = x, y' = y + x, z' = -z under e0: the invariant y/x - log x is no polynomial, and neither is its power.
SHEARED = LieAlgebra.from_brackets(4, {(0, 1): {1: 1}, (0, 2): {1: 1, 2: 1}, (0, 3): {3: 2}})


@pytest.mark.parametrize(
    ("bracket", "lower", "upper", "words"),
    [
        (so(3) @ leibniz(3, "epsilon"), 6, 6, "rank 6 proved"),
        (so(3) @ semidirect(4), 6, 6, "rank 6 proved"),
        (su(3) @ leibniz(2), 12, 12, "rank 12 proved"),
        (affine(1) @ trivial(), 2, 2, "rank 2 proved"),
        (SHEARED @ trivial(), 2, 4, "rank at least 2, at most 4"),
    ],
)
def test_rank_certificates_say_what_is_proved(bracket, lower, upper, words):
    certificate = bracket.rank_certificate()
    assert (certificate.lower, certificate.upper, certificate.proved) == (lower, upper, lower == upper)
    assert words in str(certificate)
