from fractions import Fraction
from itertools import combinations

import pytest
import sympy as sp
from commutative import in_basis

from liepoisson.structure.canonical_bracket import canonical
from liepoisson.structure.extensions import leibniz, semidirect, trivial
from liepoisson.structure.lie_algebras import so, su
from liepoisson.structure.poisson.pfaffians import PfaffianIdeal, casimirs_on_parallel_fields, vanish_on_parallel_fields
from liepoisson.structure.poisson.polynomials import expression_of


def listed(bracket):
    return [(stratum.condition, stratum.rank, stratum.proved) for stratum in bracket.strata()]


@pytest.mark.parametrize(
    ("bracket", "strata"),
    [
        (so(3) @ leibniz(3, "epsilon"), [
            ("beta != 0", 6, True),
            ("beta = 0, alpha != 0", 4, True),
            ("beta = 0, alpha = 0, l != 0", 2, True),
            ("beta = 0, alpha = 0, l = 0", 0, True),
        ]),
        (so(3) @ semidirect(3), [
            ("alpha x beta != 0", 6, True),
            ("alpha x beta = 0, (alpha, beta) != 0", 4, True),
            ("beta = 0, alpha = 0, l != 0", 2, True),
            ("beta = 0, alpha = 0, l = 0", 0, True),
        ]),
        (so(3) @ (trivial() + trivial()), [
            ("alpha != 0, l != 0", 4, True),
            ("alpha = 0, l != 0", 2, True),
            ("l = 0, alpha != 0", 2, True),
            ("alpha = 0, l = 0", 0, True),
        ]),
        (su(3) @ leibniz(2), [("generic", 12, False), ("alpha = 0, generic", 6, False), ("alpha = 0, l = 0", 0, True)]),
        (canonical(2), [("everywhere", 4, True)]),
    ],
    ids=str,
)  # fmt: skip
def test_known_strata(bracket, strata):
    assert sorted(listed(bracket), key=str) == sorted(strata, key=str)
    assert [rank for _, rank, _ in listed(bracket)] == sorted((rank for _, rank, _ in strata), reverse=True)
    assert listed(so(2, 1) @ leibniz(3)) == listed(so(3) @ leibniz(3))  # whatever the metric
    assert "epsilon != 0" in (so(3) @ leibniz(3, "epsilon")).strata()[0].certificate


def test_casimirs_on_the_strata():
    twisted, charged = so(3) @ leibniz(3), so(3) @ semidirect(3)
    l, alpha, beta = twisted.fields.values()
    assert set(twisted.strata()[1].casimirs) == {l.dot(alpha), alpha.dot(alpha)}
    collinear = charged.strata()[1].casimirs
    assert {l.dot(alpha), l.dot(beta)} < set(collinear)
    n = sp.Matrix(sp.symbols("n1:4"))
    s, t = sp.symbols("s t")
    on_it = dict(zip((*alpha, *beta), (*(s * n), *(t * n)), strict=True))
    for casimir in collinear:
        assert {sp.expand(value.subs(on_it)) for value in charged.vector_field(casimir)} == {0}
    assert any(value != 0 for value in charged.vector_field(l.dot(alpha)))


@pytest.mark.parametrize("extension", [leibniz(3), semidirect(3), trivial() + leibniz(2), leibniz(4), leibniz(2)])
def test_ranks_of_strata_are_ranks_at_their_points(extension):
    bracket = so(3) @ extension
    n = bracket.extension.dimension
    names = bracket.field_names
    for stratum in bracket.strata():
        zero = stratum.locus.zero
        blocks = [(0, 0, 0) if name in zero else (k + 1, 2 - k * k, 3) for k, name in enumerate(names)]
        if stratum.locus.parallel:
            blocks = [(1, 2, 3), (1, 0, 1), (2, 0, 2)]
        assert len(blocks) == n
        assert bracket.rank([c for block in blocks for c in block]) == stratum.rank


def test_an_unadapted_basis_is_not_claimed():
    """alpha and beta exchanged for alpha + beta, beta: alpha' = beta' is none of the candidates."""
    rows = [[Fraction(v) for v in row] for row in ((1, 0, 0), (0, 1, 0), (0, 1, 1))]
    first = (so(3) @ in_basis(leibniz(3), rows)).strata()[0]
    assert (first.rank, first.condition, first.proved) == (6, "generic", False)


CHARGED, TWISTED = so(3) @ semidirect(3), so(3) @ leibniz(3, "epsilon")
ALPHA, BETA = (3, 4, 5), (6, 7, 8)


@pytest.mark.parametrize("size", [2, 4])
def test_squares_of_pfaffians_are_principal_minors(size):
    bracket = so(3) @ leibniz(2)
    J = bracket.poisson_tensor()
    minors = {J.extract(list(r), list(r)).det().expand() for r in combinations(range(6), size)} - {0}
    pfaffians = PfaffianIdeal(bracket.tensor, size, 3).generators
    # Up to a factor, in which generators of an ideal are free.
    squares = {
        sp.Poly(expression_of(p, bracket.variables, bracket.tensor.field) ** 2).primitive()[1].as_expr()
        for p in pfaffians
    }
    assert squares == {sp.Poly(minor).primitive()[1].as_expr() for minor in minors}


@pytest.mark.parametrize(
    ("bracket", "assumption"), [(so(3) @ leibniz(3), ""), (CHARGED, None), (TWISTED, "epsilon != 0")]
)
def test_powers_of_beta_are_pfaffians_only_with_a_twist(bracket, assumption):
    beta = [{(i,): bracket.tensor.field.one} for i in BETA]
    assert PfaffianIdeal(bracket.tensor, 6, 3).contains_powers_of(beta) == assumption


def test_many_coordinates_leave_the_blocks_with_two_components_of_every_field():
    tensor = (so(3) @ leibniz(4)).tensor  # twelve coordinates
    largest = PfaffianIdeal(tensor, 8, 3)
    assert not largest.is_full
    # J of x1, x2 of four fields is an arrangement of third components: each Pfaffian is a polynomial in these alone
    assert [{i % 3 for monomial in g for i in monomial} for g in largest.generators] == [{0}, {1}, {2}]
    assert PfaffianIdeal(tensor, 6, 3).generators == []


def test_the_rank_of_the_charged_top_drops_on_parallel_fields_and_that_of_the_twisted_top_does_not():
    assert vanish_on_parallel_fields(PfaffianIdeal(CHARGED.tensor, 6, 3).generators, (ALPHA, BETA))
    assert not vanish_on_parallel_fields(PfaffianIdeal(CHARGED.tensor, 4, 3).generators, (ALPHA, BETA))
    assert not vanish_on_parallel_fields(PfaffianIdeal(TWISTED.tensor, 6, 3).generators, (ALPHA, BETA))


def test_the_charged_top_has_five_quadratic_casimirs_there():
    """l.alpha = s l.n and l.beta = t l.n beside those of alpha, beta; alpha_1 beta_2 - alpha_2 beta_1 = 0 is none."""
    l, alpha, beta = CHARGED.fields.values()
    polynomials = casimirs_on_parallel_fields(CHARGED.tensor, (ALPHA, BETA))
    found = {expression_of(p, CHARGED.variables, CHARGED.tensor.field) for p in polynomials}
    assert found == {l.dot(alpha), l.dot(beta), alpha.dot(alpha), alpha.dot(beta), beta.dot(beta)}
