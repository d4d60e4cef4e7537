r"""Laws of brackets with a constant part, $\{f, g\} + c(df, dg)$, with random 2-cocycles in exact arithmetic."""

from fractions import Fraction
from itertools import combinations

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

import liepoisson as lp
from liepoisson.errors import CocycleError

exactly = settings(deadline=None, max_examples=5, derandomize=True)
rational = st.fractions(min_value=-3, max_value=3, max_denominator=5)

PROPER = {
    "rotations": lp.so(3) @ lp.trivial(),
    "heavy top": lp.so(3) @ lp.semidirect(2),
    "twisted top": lp.so(3) @ lp.leibniz(3, "2/3"),
    "Heisenberg": lp.algebras.heisenberg(1) @ lp.trivial(),
    "plane": lp.algebras.se(2) @ lp.trivial(),
    "lines": lp.algebras.affine(1) @ lp.leibniz(2),
    "abelian": lp.algebras.abelian(4) @ lp.trivial(),
}


def cocycles(bracket):
    """A basis of all 2-cocycles, as SymPy solves c([x, y], z) + cyclic = 0: another way than the package's."""
    N = bracket.dimension
    unknown = {pair: sp.Symbol(f"k{pair[0]}_{pair[1]}") for pair in combinations(range(N), 2)}
    linear = {}
    for i, j, m, c in bracket.entries():
        linear.setdefault((i, j), []).append((m, sp.sympify(c)))
        linear.setdefault((j, i), []).append((m, -sp.sympify(c)))

    def c(i, j):
        return 0 if i == j else unknown[i, j] if i < j else -unknown[j, i]

    conditions = [
        sum(value * c(m, z) for x, y, z in ((i, j, k), (j, k, i), (k, i, j)) for m, value in linear.get((x, y), []))
        for i, j, k in combinations(range(N), 3)
    ]
    symbols = list(unknown.values())
    solution = sp.linsolve([e for e in conditions if e != 0] or [sp.S.Zero * symbols[0]], symbols)
    (general,) = solution if solution else (tuple(symbols),)
    free = sorted({s for value in general for s in value.free_symbols}, key=str)
    return [dict(zip(unknown, (sp.sympify(v).coeff(f) for v in general), strict=True)) for f in free]


SMALL = ("rotations", "heavy top", "Heisenberg", "plane", "abelian")
COCYCLES = {name: cocycles(bracket) for name, bracket in PROPER.items()}


@st.composite
def with_cocycle(draw, names=tuple(PROPER)):
    name = draw(st.sampled_from(names))
    basis = COCYCLES[name]
    weights = draw(st.lists(rational, min_size=len(basis), max_size=len(basis)))
    constant = {pair: sum(sp.sympify(w) * c[pair] for w, c in zip(weights, basis, strict=True)) for pair in basis[0]}
    return PROPER[name].with_constant(constant)


@exactly
@given(with_cocycle(tuple(name for name in PROPER if name != "abelian")), rational, st.randoms(use_true_random=False))
def test_what_is_no_cocycle_is_refused_with_the_triple(bracket, added, random):
    N, constant = bracket.dimension, dict(bracket.constant)
    pair = random.choice(list(combinations(range(N), 2)))
    constant[pair] = constant.get(pair, 0) + added
    wrong = bracket.with_constant(constant, check=False)
    failing = [triple for triple, residual in wrong.jacobi_residuals().items() if residual != 0]
    assert wrong.jacobi_certificate().holds is not bool(failing)
    if failing:
        with pytest.raises(CocycleError) as caught:
            bracket.with_constant(constant)
        assert caught.value.triple == tuple(map(str, failing[0]))
        assert sp.sympify(caught.value.residual) == wrong.jacobi_residuals()[failing[0]]
    else:
        assert bracket.with_constant(constant).constant == wrong.constant


@pytest.mark.thorough
@exactly
@given(with_cocycle(SMALL))
def test_casimirs_commute_with_everything_and_are_as_many_as_the_corank(bracket):
    J, report = bracket.poisson_tensor(), bracket.casimir_report(3)
    for casimir in report.generators:
        assert not any((J * sp.Matrix([casimir.diff(x) for x in bracket.variables])).expand())
    assert report.verified
    assert report.independent <= report.corank == bracket.dimension - J.rank()


@exactly
@given(st.sampled_from([name for name in PROPER if name != "lines"]), st.data())
def test_a_coboundary_is_a_translation(name, data):
    """J(y + x0) is the bracket with the constant part J(x0); its Casimirs are C(y + x0) up to constants."""
    proper = PROPER[name]
    x0 = data.draw(st.lists(rational, min_size=proper.dimension, max_size=proper.dimension))
    moved = proper.translated(x0)
    there = {x: x + sp.sympify(a) for x, a in zip(proper.variables, x0, strict=True)}
    assert moved.poisson_tensor() == proper.poisson_tensor().subs(there, simultaneous=True)
    xi = moved.coboundary()
    back = {x: x + sp.sympify(a) for x, a in zip(proper.variables, xi, strict=True)}
    assert moved.poisson_tensor() == proper.poisson_tensor().subs(back, simultaneous=True)
    zero = dict.fromkeys(moved.variables, 0)
    for casimir in proper.casimirs():
        shifted = sp.expand(casimir.subs(there, simultaneous=True))
        assert not any(moved.vector_field(shifted))
        degree = sp.Poly(casimir, *proper.variables).total_degree()
        if degree == 2 and len(proper.casimirs()) == 1:
            assert sp.expand(shifted - shifted.subs(zero) - moved.casimirs()[0]) == 0


@exactly
@given(st.sampled_from(tuple(PROPER)), st.data())
def test_a_frozen_bracket_is_compatible_with_its_own(name, data):
    """Every combination of the two is a bracket: J(x) + s J(x0)."""
    proper = PROPER[name]
    x0 = data.draw(st.lists(rational, min_size=proper.dimension, max_size=proper.dimension))
    frozen = proper.frozen(x0)
    at_x0 = dict(zip(proper.variables, map(sp.sympify, x0), strict=True))
    assert frozen.poisson_tensor() == proper.poisson_tensor().subs(at_x0)
    pencil = proper.with_constant({pair: Fraction(7, 3) * c for pair, c in frozen.constant.items()})
    assert pencil.jacobi_certificate().holds
