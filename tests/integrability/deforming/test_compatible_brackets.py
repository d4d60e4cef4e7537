"""Pencils of brackets and what is in involution, against Manakov's integrals and theorems on shifts."""

import pytest
from sympy import Matrix, Symbol, expand, symbols, sympify

import liepoisson as lp
from liepoisson.errors import CompatibilityError, ParameterError, ShapeError

PAIRS = [(1, 2), (1, 3), (1, 4), (2, 3), (2, 4), (3, 4)]


def so4_of(weights):
    """The Lie algebra of antisymmetric matrices with [X, Y] = X B Y - Y B X, B diagonal, in the basis E_ij - E_ji."""

    def basis(i, j):
        m = Matrix.zeros(4, 4)
        m[i - 1, j - 1], m[j - 1, i - 1] = 1, -1
        return m

    b = Matrix.diag(*weights)
    brackets = {}
    for p in range(6):
        for q in range(p + 1, 6):
            x, y = basis(*PAIRS[p]), basis(*PAIRS[q])
            m = x * b * y - y * b * x
            if row := {k: m[i - 1, j - 1] for k, (i, j) in enumerate(PAIRS) if m[i - 1, j - 1]}:
                brackets[p, q] = row
    return lp.LieAlgebra.from_brackets(6, brackets, "so(4)_B", [f"{i}{j}" for i, j in PAIRS])


def manakov():
    return so4_of([1, 1, 1, 1]) @ lp.trivial(), so4_of([1, 2, 3, 4]) @ lp.trivial()


def test_the_chains_of_so4_are_manakovs_integrals():
    first, second = manakov()
    found = lp.integrability.lenard_chains(first, second)
    assert found.is_complete
    assert found.n_independent == 4
    m = dict(zip(PAIRS, first.variables, strict=True))
    # Euler's top with the moments J_i + J_j has H = sum m_ij^2 / (J_i + J_j): it commutes with all of them
    j = (5, 3, 2, 7)  # any, in place of the B of the pencil: related by Manakov's formula only if B = J^2
    energy = sum(x**2 / (j[p - 1] + j[q - 1]) for (p, q), x in m.items())
    assert any(expand(first(f, energy)) != 0 for f in found.functions.values())
    squares = so4_of([k**2 for k in j]) @ lp.trivial()
    chains = lp.integrability.lenard_chains(first, squares)
    assert all(expand(first(f, energy)) == 0 for f in chains.functions.values())
    assert chains.is_complete


@pytest.mark.parametrize("name", ["so(3) x R", "heavy", "charged", "twisted", "so(4)", "sl(3)"])
def test_shifted_casimirs_commute_in_both_brackets(name):
    bracket, complete = {
        "so(3) x R": (lp.so(3) @ lp.trivial(), True),
        "heavy": (lp.so(3) @ lp.semidirect(2), True),
        "charged": (lp.so(3) @ lp.semidirect(3), True),
        "twisted": (lp.so(3) @ lp.leibniz(3), True),
        "so(4)": (lp.so(4) @ lp.trivial(), True),
        "sl(3)": (lp.sl(3) @ lp.trivial(), True),
    }[name]
    point = [(3 * k * k + k) % 7 - 2 for k in range(1, bracket.dimension + 1)]
    found = lp.integrability.argument_shift(bracket, point)
    functions = list(found.functions.values())
    for f in functions[:4]:
        for g in functions:
            assert expand(found.bracket(f, g)) == 0
            assert expand(found.other(f, g)) == 0
    assert found.is_complete is complete


def test_a_singular_shift_is_not_complete():
    """At a point of lower rank the shifted Casimirs are fewer."""
    found = lp.integrability.argument_shift(lp.so(3) @ lp.semidirect(3), [1, 2, 3, 0, 0, 0, 0, 0, 0])
    assert not found.is_complete


def test_a_shift_makes_a_certificate():
    """Independent commuting functions of the shift make one of them integrable, by the separate checker."""
    bracket = lp.so(3) @ lp.leibniz(3)
    found = lp.integrability.argument_shift(bracket, [1, 2, 0, 0, 1, 3, 2, 0, 1])
    new = {name: f for name, f in found.functions.items() if any(bracket(f, x) != 0 for x in bracket.variables)}
    energy = next(iter(new.values())) ** 2 + list(new.values())[-1]
    proof = lp.integrability.certificate(lp.System(bracket, energy), new)
    assert len(proof["casimirs"]) == 3


def test_brackets_that_are_not_compatible_are_refused_with_the_triple():
    first = lp.so(3) @ lp.trivial()
    heisenberg = lp.LieAlgebra.from_brackets(6, {(0, 1): {5: 1}}, "h", [f"{i}{j}" for i, j in PAIRS])
    four, _ = manakov()
    with pytest.raises(CompatibilityError, match="compatible") as caught:
        lp.integrability.pencil(four, heisenberg @ lp.trivial())
    names, residual = caught.value.triple, caught.value.residual
    by_name = dict(zip(map(str, four.variables), four.variables, strict=True))
    x, y, z = (by_name[name] for name in names)
    total, t = 0, Symbol("t")
    other = heisenberg @ lp.trivial()
    for u, v, w in ((x, y, z), (y, z, x), (z, x, y)):
        total += four(four(u, v) + t * other(u, v), w) + t * other(four(u, v) + t * other(u, v), w)
    assert expand(total) != 0
    assert expand(total - sympify(residual, {**by_name, "t": t})) == 0
    assert lp.integrability.pencil(first, first).casimirs()


def test_what_has_other_coordinates_is_refused():
    with pytest.raises(ParameterError, match="coordinates"):
        lp.integrability.pencil(lp.so(3) @ lp.trivial(), lp.so(3) @ lp.semidirect(2))
    with pytest.raises(ParameterError, match="a name that nothing has yet; got 'alpha'"):
        lp.integrability.pencil(lp.so(3) @ lp.semidirect(2), lp.so(3) @ lp.semidirect(2), "alpha")
    with pytest.raises(ShapeError, match="9 numbers"):
        lp.integrability.argument_shift(lp.so(3) @ lp.leibniz(3), [1, 2, 3])


def test_extensions_make_pencils():
    """All Leibniz brackets of one order are compatible, and so are all twists by one cubic."""
    s, t = symbols("s t")
    found = lp.integrability.pencil(lp.so(3) @ lp.leibniz(3, 2), lp.so(3) @ lp.leibniz(3, 5), "s")
    assert found.extension.products[1, 1][2] == 2 + 5 * s
    assert t not in found.symbols


def test_points_and_strengths_that_are_roots():
    """C = |alpha|^2 and l.alpha, shifted by a = (sqrt(2), 0, 0; 0, 0, 1)."""
    E3 = lp.so(3) @ lp.semidirect(2)
    found = lp.integrability.argument_shift(E3, ["sqrt(2)", 0, 0, 0, 0, 1])
    assert found.is_complete
    l3, alpha1 = E3.variables[2], E3.variables[3]
    assert expand(found.functions["F1_1"] - l3 - sympify("sqrt(2)") * alpha1) == 0
    chains = lp.integrability.lenard_chains(lp.so(3) @ lp.leibniz(3, "sqrt(2)"), lp.so(3) @ lp.semidirect(3))
    assert any(f.has(sympify("sqrt(2)")) for f in chains.functions.values())


def test_a_symbol_of_the_point_is_not_the_parameter_of_the_pencil():
    E3 = lp.so(3) @ lp.semidirect(2)
    found = lp.integrability.argument_shift(E3, ["t", 0, 0, 0, 0, 1])
    assert expand(found.functions["F1_1"] - E3.variables[2] - Symbol("t") * E3.variables[3]) == 0
