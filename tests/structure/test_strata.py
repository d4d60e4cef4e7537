from fractions import Fraction

import pytest
import sympy as sp
from commutative import in_basis

from liepoisson.structure.canonical_bracket import canonical
from liepoisson.structure.extensions import leibniz, semidirect, trivial
from liepoisson.structure.lie_algebras import so, su


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
