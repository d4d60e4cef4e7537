"""Lax pairs: those of the catalog hold and their integrals are enough; a changed sign in any entry is found."""

import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.catalog.lax_pairs import LAX_PAIRS
from liepoisson.errors import ExpressionError, LaxPairError, ParameterError, ShapeError, UnknownNameError

lax_pair = lp.integrability.lax_pair
known_lax_pair = lp.integrability.known_lax_pair
entry = lp.catalog.system


def residual(system, L, M):
    """dL/dt - [L, M], with the derivative by the Poisson tensor and the products by SymPy: nothing shared."""
    rates = system.bracket.poisson_tensor() * sp.Matrix([sp.diff(system.hamiltonian, x) for x in system.variables])
    moved = L.applyfunc(lambda e: sum(sp.diff(e, x) * rate for x, rate in zip(system.variables, rates, strict=True)))
    return (moved - L * M + M * L).applyfunc(sp.expand)


@pytest.mark.thorough
@pytest.mark.parametrize("name", LAX_PAIRS)
def test_pairs_of_the_catalog_hold_and_prove_integrability(name):
    pair = known_lax_pair(name)
    assert residual(pair.system, sp.Matrix(pair.L), sp.Matrix(pair.M)) == sp.zeros(pair.size)
    found = pair.integrals()
    assert found.is_complete
    assert found.has_energy
    assert found.in_involution
    assert found.n_independent == found.rank // 2
    for c in found.coefficients:
        assert sp.expand(pair.system.derivative(c.expression)) == 0
        if c.formula is not None:
            values = {"H": pair.system.hamiltonian} | {k: v for k, v in pair.system.invariants.items() if k[0] == "C"}
            values |= {d.name: d.expression for d in found.coefficients if d.name}
            written = c.formula.subs({sp.Symbol(k): v for k, v in values.items()}, simultaneous=True)
            assert sp.expand(written - c.expression) == 0


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["lagrange", "kovalevskaya", "three-wave", "toda"])
def test_a_changed_sign_in_any_entry_is_found(name):
    pair = known_lax_pair(name)
    given = [pair.L, pair.M] if pair.elements is None else [sp.Matrix(e) for e in pair.elements]
    for which, matrix in enumerate(given):
        for place, value in enumerate(matrix):
            if value == 0:
                continue
            changed = sp.Matrix(matrix)
            changed[place] = -value
            L, M = [changed, given[1]] if which == 0 else [given[0], changed]
            with pytest.raises(LaxPairError, match=r"at entry \(\d"):
                lax_pair(pair.system, L, M)


def test_what_the_integrals_are():
    found = known_lax_pair("kovalevskaya").integrals()
    assert [(c.place, c.kind, str(c.formula)) for c in found.coefficients] == [
        ("w^2", "known", "8*H"),
        ("w^2 z^-2", "Casimir", "-2*C2"),
        ("1", "integral", "None"),
        ("z^-2", "known", "4*C1**2 - 8*C2*H"),
        ("z^-4", "Casimir", "C2**2"),
    ]
    [K] = found.integrals.values()
    assert sp.expand(K - 16 * entry("kovalevskaya").integrals["K"]) == 0
    twisted = known_lax_pair("twisted-lagrange").integrals()
    assert [sp.expand(f) for f in twisted.integrals.values()] == [
        sp.expand(2 * f) for f in entry("twisted-lagrange").integrals.values()
    ]


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("twisted-lagrange", {"I": ["p", "p", "q"], "a": [0, 0, "g"], "epsilon": "e"}),
        ("kovalevskaya", {"a": ["g", 0, 0]}),
        pytest.param("two-field-kovalevskaya", {"a": ["g", 0, 0], "b": [0, "h", 0]}, marks=pytest.mark.thorough),
        ("neumann", {"A": ["p", "q", "r"]}),
        pytest.param("manakov-so4", {"J": ["p", "q", "r", "s"]}, marks=pytest.mark.thorough),
        ("three-wave", {"V": "v"}),
        pytest.param(
            "leibniz-lagrange-4", {"epsilon": "e", "a3": "g", "I": ["p", "p", "q"]}, marks=pytest.mark.thorough
        ),
    ],
)
def test_pairs_hold_for_symbols_in_the_place_of_parameters(name, values):
    pair = known_lax_pair(name, parameters=values)
    difference = residual(pair.system, sp.Matrix(pair.L), sp.Matrix(pair.M)).applyfunc(sp.simplify)
    assert difference == sp.zeros(pair.size)


@pytest.mark.parametrize(
    ("name", "values"),
    [("lagrange", {"I": [1, 2, 3]}), ("kovalevskaya", {"I": [2, 2, 3]}), ("kovalevskaya", {"a": [1, 1, 0]})],
)
def test_pairs_do_not_hold_for_other_parameters(name, values):
    with pytest.raises(LaxPairError):
        known_lax_pair(name, parameters=values)


def test_complex_entries_give_real_and_imaginary_parts():
    """With i L in the place of L the eigenvalues are imaginary, and the coefficients the same up to powers of i."""
    pair = known_lax_pair("three-wave")
    turned = lax_pair(pair.system, sp.I * pair.L, pair.M).integrals()
    assert {c.place for c in turned.coefficients} == {"w", "z, imaginary part", "1, imaginary part"}
    straight = {c.place: c.expression for c in pair.integrals().coefficients}
    for c in turned.coefficients:
        assert sp.expand(c.expression + straight[c.place.partition(",")[0]]) == 0  # i^2 = -1, i^3 = -i


def test_an_error_names_the_entry_and_the_residual():
    top = entry("lagrange")
    L, M = "I1*a*z^2 + l*z + alpha", "inv(I)*l + a*z"
    with pytest.raises(LaxPairError, match=r"residual dL/dt - \[L, M\] is") as caught:
        lax_pair(top, "I1*a*z^2 + l*z - alpha", M)
    assert caught.value.entry == (1,)
    assert not caught.value.reverses
    with pytest.raises(LaxPairError, match=r"give -M in the place of M") as caught:
        lax_pair(top, L, "-inv(I)*l - a*z")
    assert caught.value.reverses
    pair = lax_pair(top, L, M)
    wrong = sp.Matrix(pair.L)
    wrong[1, 2] *= 2
    with pytest.raises(LaxPairError) as caught:
        lax_pair(top, wrong, pair.M)
    i, j = caught.value.entry
    by_hand = residual(top, wrong, sp.Matrix(pair.M))
    assert by_hand[i - 1, j - 1] != 0
    assert sp.expand(sp.sympify(caught.value.residual.replace("^", "**")) - by_hand[i - 1, j - 1]) == 0
    assert caught.value.n_failures == sum(e != 0 for e in by_hand)


@pytest.mark.parametrize(
    ("L", "M", "options", "error", "words"),
    [
        ("l*z", "l1", {}, ExpressionError, "M must be a matrix"),
        ([1, 2], [1, 2], {}, ShapeError, "the 3 components of an element of so"),
        ([[1, 2], [3]], [[1, 2], [3, 4]], {}, ShapeError, "square matrix"),
        ([[1, 2], [3, 4]], "l", {}, ShapeError, "2 x 2 and a vector of 3"),
        (3, "l", {}, ShapeError, "rows of a matrix"),
        ("l", "l", {"spectral": "alpha"}, ParameterError, "a name that the system does not use"),
        ("l", "l", {"spectral": "w"}, ParameterError, "w is the eigenvalue"),
        ("l/(z - 1) + alpha", "l", {}, ParameterError, "multiply L by its denominator"),
        ("exp(z)*l", "l", {}, ParameterError, "polynomials in z and 1/z"),
        ("l1*z", "l", {}, ExpressionError, r"L must be a matrix, or an element of so\(3\)"),
        ("l, alpha", "l", {}, ExpressionError, "',' is not expected here"),
        ("l), (l", "l", {}, ExpressionError, r"column 2\)"),
        ("l*y", "l", {}, ExpressionError, "'y' is unknown"),
    ],
)
def test_what_is_no_pair_of_matrices_is_refused(L, M, options, error, words):
    with pytest.raises(error, match=words):
        lax_pair(entry("lagrange"), L, M, **options)


def test_unknown_names():
    with pytest.raises(UnknownNameError, match="Did you mean kovalevskaya"):
        known_lax_pair("kovalevskaia")
    with pytest.raises(UnknownNameError, match="has no Lax pair in the package"):
        known_lax_pair("heavy-top")
