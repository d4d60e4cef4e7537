import pytest
import sympy as sp

from liepoisson.structure.extension import Extension
from liepoisson.structure.extensions import leibniz, semidirect, trivial
from liepoisson.structure.lie_algebras import so, su


def listed(bracket):
    return [(stratum.condition, stratum.rank, stratum.proved) for stratum in bracket.strata()]


def test_strata_of_the_twisted_top():
    strata = (so(3) @ leibniz(3, "epsilon")).strata()
    assert [(s.condition, s.rank) for s in strata] == [
        ("beta != 0", 6),
        ("beta = 0, alpha != 0", 4),
        ("beta = 0, alpha = 0, l != 0", 2),
        ("beta = 0, alpha = 0, l = 0", 0),
    ]
    assert all(s.proved for s in strata)
    assert "epsilon != 0" in strata[0].certificate


def test_strata_of_the_charged_heavy_top():
    assert listed(so(3) @ semidirect(3)) == [
        ("alpha x beta != 0", 6, True),
        ("alpha x beta = 0, (alpha, beta) != 0", 4, True),
        ("beta = 0, alpha = 0, l != 0", 2, True),
        ("beta = 0, alpha = 0, l = 0", 0, True),
    ]


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


def test_a_sum_of_algebras_drops_where_one_of_the_fields_vanishes():
    conditions = listed(so(3) @ (trivial() + trivial()))
    assert [rank for _, rank, _ in conditions] == [4, 2, 2, 0]
    assert conditions[0] == ("alpha != 0, l != 0", 4, True)
    assert ("alpha = 0, l != 0", 2, True) in conditions
    assert ("l = 0, alpha != 0", 2, True) in conditions


def test_the_metric_does_not_matter():
    assert listed(so(2, 1) @ leibniz(3)) == listed(so(3) @ leibniz(3))


def test_other_algebras_follow_the_coordinates_and_claim_less():
    strata = (su(3) @ leibniz(2)).strata()
    assert [(s.condition, s.rank, s.proved) for s in strata] == [
        ("generic", 12, False),
        ("alpha = 0, generic", 6, False),
        ("alpha = 0, l = 0", 0, True),
    ]


def test_an_unadapted_basis_is_not_claimed():
    # alpha and beta exchanged for alpha + beta, beta: the degenerate set alpha' = beta' is none of the candidates.
    P = sp.Matrix([[1, 0, 0], [0, 1, 0], [0, 1, 1]])
    inverse, W, r = P.inv(), leibniz(3).tensor, range(3)
    moved = [
        [[sum(inverse[k, c] * P[m, a] * P[v, b] * W[k][a][b] for k in r for a in r for b in r) for v in r] for m in r]
        for c in r
    ]
    first = (so(3) @ Extension(moved)).strata()[0]
    assert (first.rank, first.condition, first.proved) == (6, "generic", False)
