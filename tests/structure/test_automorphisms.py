import pytest
import sympy as sp

from liepoisson.errors import ParameterError, ShapeError
from liepoisson.structure.automorphisms import Automorphism
from liepoisson.structure.extensions import crmhd, leibniz, semidirect, trivial
from liepoisson.structure.lie_algebras import se, so

epsilon, s, u, d = sp.symbols("epsilon s u d")
TWISTED = so(3) @ leibniz(3, "epsilon")
SHIFT = Automorphism([[1, 0, 0], [0, 1, d], [0, 0, 1]])  # alpha -> alpha + d beta
SCALING = Automorphism([[1, 0, 0], [0, s, 0], [0, 0, u]])


def test_adding_beta_to_alpha_is_a_symmetry():
    assert SHIFT.is_poisson(TWISTED)
    assert SHIFT.is_poisson(so(3) @ semidirect(3))
    assert SHIFT.describe(TWISTED) == "alpha -> alpha + d*beta"
    assert not Automorphism([[1, d, 0], [0, 1, 0], [0, 0, 1]]).is_poisson(TWISTED)


def test_scalings_change_epsilon():
    assert SCALING.is_poisson(TWISTED, so(3) @ leibniz(3, epsilon * s**2 / u))
    assert not SCALING.is_poisson(TWISTED)
    assert not SCALING.is_poisson(TWISTED, so(3) @ leibniz(3, epsilon * u / s**2))


@pytest.mark.parametrize(("map_", "target"), [(SHIFT, TWISTED), (SCALING, so(3) @ leibniz(3, epsilon * s**2 / u))])
def test_the_condition_on_w_is_the_condition_on_brackets(map_, target):
    # {f, g}' o Phi = {f o Phi, g o Phi} for all pairs of coordinates.
    x = TWISTED.variables
    pulled = [map_.apply(v, TWISTED) for v in x]
    for i in range(0, 9, 2):
        for j in range(i):
            left = map_.apply(target(x[i], x[j]), TWISTED)
            assert sp.simplify(left - TWISTED(pulled[i], pulled[j])) == 0


def test_casimirs_go_to_casimirs():
    moved = SHIFT.apply(TWISTED.casimirs()[0], TWISTED)
    C1, C2, C3 = TWISTED.casimirs()
    assert sp.expand(moved - C1 - 2 * d * C2 - d**2 * C3) == 0


def test_derivations_of_the_twisted_top():
    grading, nilpotent = TWISTED.derivations()
    assert (grading.kind, grading.weights) == ("grading", (0, 1, 2))
    assert str(grading) == "alpha -> s*alpha, beta -> s^2*beta"
    assert (nilpotent.kind, str(nilpotent)) == ("nilpotent", "alpha -> alpha + d*beta")


@pytest.mark.parametrize(
    ("bracket", "n"),
    [
        (so(3) @ leibniz(3), 2),
        (so(3) @ leibniz(5), 4),  # z -> a polynomial in z without constant term
        (so(3) @ semidirect(3), 4),  # all linear maps of (alpha, beta)
        (so(3) @ semidirect(4), 9),
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


def test_flows_of_nilpotent_derivations_are_automorphisms():
    bracket = so(3) @ leibniz(4)
    texts = [str(D) for D in bracket.derivations() if D.kind == "nilpotent"]
    assert texts == ["x1 -> x1 + d*x3", "x1 -> x1 + d*x2 + d^2*x3, x2 -> x2 + 2*d*x3"]
    flow = Automorphism([[1, 0, 0, 0], [0, 1, d, d**2], [0, 0, 1, 2 * d], [0, 0, 0, 1]])
    assert flow.is_poisson(bracket)
    assert not Automorphism([[1, 0, 0, 0], [0, 1, d, d**2], [0, 0, 1, d], [0, 0, 0, 1]]).is_poisson(bracket)


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


def test_wrong_arguments_are_refused():
    with pytest.raises(ShapeError, match="matrix must have shape"):
        Automorphism([[1, 0], [0]])
    with pytest.raises(ShapeError, match="must have 3 rows; got 2"):
        Automorphism([[1, 0], [0, 1]]).is_poisson(TWISTED)
    with pytest.raises(ParameterError, match="same Lie algebra"):
        SHIFT.is_poisson(TWISTED, so(2, 1) @ leibniz(3))
