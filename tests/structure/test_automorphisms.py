import pytest
import sympy as sp

from liepoisson.structure.automorphisms import Automorphism
from liepoisson.structure.canonical_bracket import canonical
from liepoisson.structure.extensions import crmhd, leibniz, semidirect, trivial
from liepoisson.structure.lie_algebras import se, so

epsilon, s, u, d = sp.symbols("epsilon s u d")
TWISTED = so(3) @ leibniz(3, "epsilon")
SHIFT = Automorphism([[1, 0, 0], [0, 1, d], [0, 0, 1]])  # alpha -> alpha + d beta
SCALING = Automorphism([[1, 0, 0], [0, s, 0], [0, 0, u]])


@pytest.mark.parametrize(
    ("map_", "source", "target", "is_poisson"),
    [
        (SHIFT, TWISTED, None, True),
        (SHIFT, so(3) @ semidirect(3), None, True),
        (Automorphism([[1, d, 0], [0, 1, 0], [0, 0, 1]]), TWISTED, None, False),
        (SCALING, TWISTED, so(3) @ leibniz(3, epsilon * s**2 / u), True),
        (SCALING, TWISTED, None, False),
        (SCALING, TWISTED, so(3) @ leibniz(3, epsilon * u / s**2), False),
        # with a constant part: J(x0) goes to J(P x0), and P keeps l
        (SHIFT, TWISTED.translated(["b"] + [0] * 8), None, True),
        (SHIFT, TWISTED.translated([0] * 6 + ["b", 0, 0]), None, False),
        (Automorphism([[0, 1], [-1, 0]]), canonical(2), None, True),
        (Automorphism([[0, 1], [1, 0]]), canonical(2), None, False),
    ],
)
def test_poisson_maps(map_, source, target, is_poisson):
    """{f, g}' o Phi = {f o Phi, g o Phi} for all pairs of coordinates if and only if W says so."""
    assert map_.is_poisson(source, target or source) is is_poisson
    x, target = source.variables, target or source
    pulled = [map_.apply(v, source) for v in x]
    differences = (
        map_.apply(target(x[i], x[j]), source) - source(pulled[i], pulled[j])
        for i in range(0, len(x), 2 if len(x) == 9 else 1)
        for j in range(i)
    )
    assert all(sp.simplify(difference) == 0 for difference in differences) is is_poisson


def test_derivations_of_the_twisted_top():
    grading, nilpotent = TWISTED.derivations()
    assert SHIFT.describe(TWISTED) == "alpha -> alpha + d*beta"
    assert (grading.kind, grading.weights) == ("grading", (0, 1, 2))
    assert str(grading) == "alpha -> s*alpha, beta -> s^2*beta"
    assert (nilpotent.kind, str(nilpotent)) == ("nilpotent", "alpha -> alpha + d*beta")


@pytest.mark.parametrize(
    ("bracket", "n"),
    [
        (so(3) @ leibniz(5), 4),  # z -> a polynomial in z without constant term
        (so(3) @ semidirect(3), 4),  # all linear maps of (alpha, beta)
        (so(3) @ (trivial() + trivial()), 0),
        (se(3) @ crmhd("beta_e"), 4),
    ],
)
def test_derivations_obey_the_product_rule(bracket, n):
    found = bracket.derivations()
    assert len(found) == n
    W, r = bracket.extension.tensor, range(bracket.extension.dimension)
    for D in (derivation.matrix for derivation in found):
        for m in r:
            for v in r:
                for k in r:
                    left = sum(W[c][m][v] * D[c][k] for c in r)
                    right = sum(D[m][c] * W[k][c][v] + D[v][c] * W[k][m][c] for c in r)
                    assert sp.simplify(left - right) == 0


@pytest.mark.parametrize("extension", [leibniz(3, "epsilon"), leibniz(4, "epsilon"), crmhd("epsilon")])
def test_scalings_are_poisson_maps_between_parameters(extension):
    bracket = so(3) @ extension
    found = bracket.scalings()
    assert any(scaling.parameters["epsilon"] for scaling in found)
    for scaling in found:
        n = len(scaling.weights)
        diagonal = Automorphism([[s ** scaling.weights[k] if k == j else 0 for j in range(n)] for k in range(n)])
        target = bracket.substitute({"epsilon": epsilon * s ** scaling.parameters["epsilon"]})
        assert diagonal.is_poisson(bracket, target)


def test_scalings_in_words():
    texts = [str(scaling) for scaling in TWISTED.scalings()]
    assert texts == [
        "alpha -> s*alpha, beta -> s^2*beta changes nothing else",
        "alpha -> s*alpha takes epsilon to s^2*epsilon",
    ]
    assert [str(D) for D in canonical(3).derivations()] == [
        "q -> s*q, p -> s^(-1)*p", "q -> q + d*p", "p -> p + d*q",
    ]  # fmt: skip
    scaled = (so(3) @ semidirect(2)).with_constant({("l1", "alpha2"): "k", ("alpha1", "l2"): "k"})
    assert [scaling.parameters for scaling in scaled.scalings()] == [{"k": 1}]


def test_a_matrix_of_sympy_is_a_matrix():
    rows = [[1, 2], [0, 3]]
    assert Automorphism(sp.Matrix(rows)).matrix == Automorphism(rows).matrix
