"""The search finds the pairs of the literature that have its form, and proves where there are none."""

import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.errors import ParameterError

search_lax_pairs = lp.integrability.search_lax_pairs
entry = lp.catalog.system


@pytest.mark.parametrize(
    ("name", "degree", "form"),
    [
        ("lagrange", 2, "algebra"),
        ("twisted-lagrange", 3, "algebra"),
        pytest.param("charged-twisted-lagrange", 3, "algebra", marks=pytest.mark.thorough),
        ("free-rigid-body", 1, "diagonal"),
        pytest.param("manakov-so4", 1, "diagonal", marks=pytest.mark.thorough),
    ],
)
def test_pairs_of_the_literature_are_found(name, degree, form):
    """Up to a factor of L, a scaling of z and multiples of the identity: the integrals are the same."""
    found = search_lax_pairs(entry(name), degree=degree, form=form)
    assert found.complete
    [pair] = found.pairs
    known = lp.integrability.known_lax_pair(name)
    assert pair.integrals().is_complete
    assert pair.integrals().n_independent == known.integrals().n_independent
    assert [c.genus for c in pair.spectral_curve().components] == [c.genus for c in known.spectral_curve().components]
    if pair.elements is not None:
        z = sp.Symbol("z")
        scale = known.elements[1][2].coeff(z)  # B = e3 in what is found, a in the catalog
        ratio = {
            sp.cancel(a.subs(z, scale * z) / b) for a, b in zip(*(p.elements[0] for p in (pair, known)), strict=True)
        }
        assert len(ratio) == 1


@pytest.mark.parametrize("degree", [1, 2])
def test_below_the_degree_of_the_pair_there_is_none(degree):
    found = search_lax_pairs(entry("twisted-lagrange"), degree=degree)
    assert found.complete
    assert not found.pairs


@pytest.mark.parametrize("name", ["kovalevskaya", "kirchhoff", "twisted-kovalevskaya"])
def test_where_there_is_none_it_is_proved(name):
    found = search_lax_pairs(entry(name), degree=3)
    assert found.complete
    assert not found.pairs


def test_pairs_without_integrals_are_left_out():
    """Where nothing but a rotation happens, constant matrices commute with M: their eigenvalues are numbers."""
    found = search_lax_pairs(lp.System(lp.so(3) @ lp.trivial(), "l3"), degree=1)
    assert found.complete
    assert not found.pairs


def test_families_are_counted_and_have_members():
    """A ball has pairs for every B: all directions, in three families by the first component that is not zero."""
    found = search_lax_pairs(lp.catalog.euler_top_on("so(3)", [1, 1, 1]), degree=1)
    assert found.complete
    assert found.n_families == 2
    assert len(found.pairs) == 3


@pytest.mark.parametrize(
    ("system", "options", "words"),
    [
        (lambda: entry("toda"), {}, "whose fields are matrices"),
        (lambda: entry("gyrostat"), {}, "without a constant part"),
        (lambda: entry("twisted-top"), {}, "give numbers for parameters"),
        (lambda: lp.System(lp.so(3) @ lp.trivial(), "l1^3"), {}, "whose derivative by l1 is linear"),
        (lambda: entry("lagrange"), {"form": "matrix"}, '"algebra" or "diagonal"'),
        (lambda: entry("lagrange"), {"degree": 0}, "from 1 to 8"),
    ],
)
def test_what_is_not_searched_is_refused(system, options, words):
    with pytest.raises(ParameterError, match=words):
        search_lax_pairs(system(), **options)
