"""The Kovalevskaya-Painlevé test gives the exponents and verdicts of the literature, and series that are solutions."""

from collections import Counter
from fractions import Fraction
from itertools import count, product
from math import gcd

import numpy as np
import pytest
import sympy as sp
from complex_time import along

import liepoisson as lp
from liepoisson.errors import ParameterError

painleve_test = lp.integrability.painleve_test
entry = lp.catalog.system
HALF = Fraction(1, 2)

KDV, SK, KK = (entry(f"henon-heiles-{name}") for name in ("kdv", "sawada-kotera", "kaup-kupershmidt"))
TWISTED = [-1, 0, 1, 1, 2, 3, 3, 4, 5]
"""Exponents of the principal balance of Lagrange's twisted top: those of the heavy top and 1, 3, 5 of beta."""
TWO_FIELDS = [-1, 0, 0, 1, 2, 2, 3, 4, 4]


def top(inertia, a, b, epsilon):
    with pytest.warns() if max(inertia) * 2 > sum(inertia) else _nothing():
        return lp.Top(inertia=inertia, a=a, b=b, epsilon=epsilon)


def exponents(found):
    """The rational exponents of all balances."""
    return sorted([list(balance.exponents) for balance in found.balances])


def check(found):
    """What holds for every balance: -1 is an exponent, and integrals are constant along the series."""
    for balance in found.balances:
        assert -1 in balance.exponents
        kernels = balance.kernels.values()
        assert all(1 <= kernel <= multiplicity for multiplicity, kernel in kernels)
        if balance.status != "fails":
            assert all(kernel == multiplicity for multiplicity, kernel in kernels)


# Hénon and Heiles: Chang, Tabor and Weiss (1982); [conte2005]


@pytest.mark.parametrize(
    ("system", "expected", "verdict"),
    [
        (KDV, [[-3, -1, 6, 8], [-1, 1, 4, 6]], "passes"),
        (SK, [[-1, -1, 6, 6], [-1, 2, 3, 6], [-1, 2, 3, 6]], "passes"),
        (KK, [[-7, -1, 6, 12], [-1, 3 * HALF, 7 * HALF, 6]], "passes weakly"),
        (entry("henon-heiles"), [[-1, 6], [-1, 6]], "fails"),
    ],
    ids=lambda case: getattr(case, "name", ""),
)
def test_the_systems_of_henon_and_heiles(system, expected, verdict):
    r"""Along $y = 6/(C\tau^2)$: r = -1, 6 and, from $x\sim\tau^{r-2}$, the roots of $(r - 2)(r - 3) = -12/C$."""
    found = painleve_test(system)
    check(found)
    assert (exponents(found), found.verdict) == (expected, verdict)
    assert found.weights == ((2, 2, 3, 3),)


@pytest.mark.thorough
def test_exponents_of_henon_and_heiles_as_functions_of_a_parameter():
    """x'' = -2 x y along y = 6/(C t^2): the exponents r of x satisfy (r - 2)(r - 3) = -12/C."""
    c = sp.Symbol("C")
    system = lp.System(KDV.bracket, "(p_x^2 + p_y^2 + x^2 + y^2)/2 + x^2*y - C*y^3/3", symbols=["C"])
    found = painleve_test(system)
    assert (found.verdict, exponents(found)) == ("fails", [[-1, 6], [-1, 6]])
    assert "for general values of the symbols" in found.scope.lower()
    text = str(found.balances[0].kovalevskaya)
    r = sp.Symbol("r")
    shown = sp.sympify(text[text.index("roots of") + 9 :], locals={"C": c, "r": r})
    assert sp.simplify(shown - ((r - 2) * (r - 3) + 12 / c)) == 0


@pytest.mark.thorough
def test_lower_terms_break_the_compatibility_that_the_dominant_ones_have():
    """Sawada and Kotera's case needs A = B, Kaup and Kupershmidt's B = 16 A; exponents do not tell."""
    for a, b, c, verdict in [(1, 2, -1, "fails"), (3, 3, -1, "passes"), (1, 2, -6, "passes"), (2, 3, -16, "fails"),
                             (2, 32, -16, "passes weakly")]:  # fmt: skip
        found = painleve_test(lp.catalog.henon_heiles(a, b, c))
        assert found.verdict == verdict, (a, b, c)
        assert all(balance.kovalevskaya.all_rational for balance in found.balances)


# tops: Kovalevskaya (1889), Lyapunov (1894), and their twisted forms


def test_eulers_top():
    found = painleve_test(entry("free-rigid-body"))
    check(found)
    (balance,) = found.balances
    assert (exponents(found), found.verdict) == ([[-1, 2, 2]], "passes")
    assert (balance.n_conjugates, balance.n_constants, balance.is_principal) == (4, 3, True)


@pytest.mark.parametrize("name", ["lagrange", "spherical-pendulum", "so21-heavy-top"])
def test_lagranges_top_has_a_family_of_balances(name):
    found = painleve_test(entry(name))
    check(found)
    (balance,) = found.balances
    assert (exponents(found), found.verdict) == ([[-1, 0, 1, 2, 3, 4]], "passes")
    assert len(balance.family) == 1
    assert balance.is_principal


@pytest.mark.thorough
def test_kovalevskayas_top():
    """Two kinds of balances, of six and of five constants, as in her paper; with the gyrostat the same."""
    for name in ("kovalevskaya", "kovalevskaya-gyrostat"):
        found = painleve_test(entry(name))
        check(found)
        assert (exponents(found), found.verdict) == ([[-1, -1, 2, 2, 3, 4], [-1, 0, 1, 2, 3, 4]], "passes")
        assert sorted(balance.n_constants for balance in found.balances) == [5, 6]


@pytest.mark.thorough
def test_a_heavy_top_of_no_special_kind_fails():
    assert painleve_test(entry("heavy-top")).verdict == "fails"


@pytest.mark.thorough
@pytest.mark.parametrize("inertia", [(1, 1, 2), (1, 1, 1)], ids=["symmetric", "spherical"])
def test_lagranges_twisted_top_passes(inertia):
    found = painleve_test(top(inertia, (0, 0, 1), (0, 0, 0), 1))
    check(found)
    assert (exponents(found), found.verdict) == ([TWISTED], "passes")
    (balance,) = found.balances
    assert (balance.n_constants, balance.n_log_free) == (9, 9)


@pytest.mark.thorough
def test_eulers_twisted_top_is_a_heavy_top():
    """a = 0: alpha follows passively, and (l, beta) is the heavy top (I, b)."""
    kovalevskaya = painleve_test(top((2, 2, 1), (0, 0, 0), (1, 0, 0), 1))
    assert kovalevskaya.verdict == "passes"
    assert TWO_FIELDS in exponents(kovalevskaya)
    assert kovalevskaya.weights == ((1, 1, 1, 2, 2, 2, 2, 2, 2),)


@pytest.fixture(scope="module")
def twisted_kovalevskaya():
    return painleve_test(top((2, 2, 1), (1, 0, 0), (0, 0, 0), 1))


@pytest.mark.thorough
def test_kovalevskayas_twisted_top_has_a_logarithm_that_solvability_does_not_show(twisted_kovalevskaya):
    """The pendulum's balance: at the exponent 1 the equations are solvable, and the kernel is too small."""
    check(twisted_kovalevskaya)
    assert twisted_kovalevskaya.verdict == "fails"
    (balance,) = (b for b in twisted_kovalevskaya.balances if list(b.exponents) == TWISTED)
    assert balance.kernels[Fraction(1)] == (2, 1)
    assert next(r for r in balance.resonances if r.exponent == 1).conditions == ()
    assert balance.n_log_free == 7  # 8 at the member with l1 = l2 = 0, where the kernel of the exponent 3 is larger
    control = painleve_test(top((2, 2, 1), (1, 0, 0), (0, 0, 0), 0))
    assert (control.verdict, TWO_FIELDS in exponents(control)) == ("passes", True)


@pytest.mark.thorough
def test_kovalevskayas_twisted_top_has_irrational_exponents(twisted_kovalevskaya):
    r"""The balances with beta: $2r^4 - 4r^3 - (2A+1)r^2 + (2A+3)r + 13A - 36$, $A\in\mathbb Q(\sqrt{19})$."""
    (balance,) = (b for b in twisted_kovalevskaya.balances if not b.kovalevskaya.all_rational)
    assert (balance.n_conjugates, list(balance.exponents)) == (8, [-1, 2, 4, 5, 6])
    a, r = sp.symbols("A r")
    system = twisted_kovalevskaya.system
    sign = 1 if system.hamiltonian.coeff(system.variables[3]) == 1 else -1
    values = sp.Poly(a**2 - sp.Rational(40, 3) * a + 36, a)
    quartic = 2 * r**4 - 4 * r**3 - (2 * a + 1) * r**2 + (2 * a + 3) * r + 13 * a - 36
    norm = sp.Poly(sp.resultant(values.as_expr(), quartic, a), r)
    assert sign == 1
    assert sp.sqrt(19) in [s for f in sp.roots(values, multiple=True) for s in f.atoms(sp.Pow)]
    expected = Counter(np.round(np.array([complex(z) for z in norm.nroots()] * 4), 8))
    assert Counter(np.round(np.array(balance.other_exponents), 8)) == expected


@pytest.mark.thorough
def test_two_fields_that_are_not_parallel():
    """Without the twist the spherical top and Kovalevskaya's top with two fields pass; with it both have logarithms."""
    for inertia in ((1, 1, 1), (2, 2, 1)):
        untwisted, twisted = (painleve_test(top(inertia, (1, 0, 0), (0, 1, 0), epsilon)) for epsilon in (0, 1))
        assert (untwisted.verdict, twisted.verdict) == ("passes", "fails")
        (balance,) = (b for b in twisted.balances if list(b.exponents) == TWO_FIELDS)
        assert balance.obstructions
        assert all(text.startswith("logarithm at the exponent 1,") for text in balance.obstructions)
        assert TWO_FIELDS in exponents(untwisted)
        assert untwisted.weights == ((1, 1, 1, 2, 2, 2, 2, 2, 2),)


@pytest.mark.thorough
def test_lagranges_top_with_a_second_field_fails_without_the_twist():
    assert painleve_test(top((1, 1, 2), (0, 0, 1), (1, 0, 0), 0)).verdict == "fails"


@pytest.mark.thorough
def test_parallel_fields_pass_with_the_twist():
    """b = c a is b = 0 in other coordinates."""
    for c in (2, -1):
        assert painleve_test(top((1, 1, 2), (0, 0, 1), (0, 0, c), 1)).verdict == "passes"


@pytest.mark.slow
@pytest.mark.timeout(3600)
def test_no_further_twisted_top_on_the_grid_of_inertia():
    """33 triples with a = e1, up to exchange and scale: only the eleven of Lagrange's kind, I2 = I3, pass."""
    triples = [i for i in product(range(1, 5), repeat=3) if i[1] <= i[2] and gcd(*i) == 1]
    lagrange = [i for i in triples if i[1] == i[2]]
    assert (len(triples), len(lagrange)) == (33, 11)
    for inertia in triples:
        found = painleve_test(top(inertia, (1, 0, 0), (0, 0, 0), 1), time_limit=600)
        check(found)
        assert found.complete
        with_beta = [b for b in found.balances if not {"beta1", "beta2", "beta3"} <= set(b.equations)]
        if inertia in lagrange:
            assert (found.verdict, with_beta) == ("passes", []), inertia
            continue
        assert found.verdict == "fails", inertia
        assert with_beta
        assert not any(b.family for b in with_beta)
        # five exponents are common to all these balances, and no other one is rational
        assert {b.exponents for b in with_beta} == {(-1, 2, 4, 5, 6)}, inertia
        if inertia == (2, 1, 2):
            assert sum(b.n_conjugates for b in with_beta) == 8


# Toda


def flaschka(n):
    """Toda's open chain in Flaschka's variables: b_i' = 2(a_i^2 - a_{i-1}^2), a_i' = a_i (b_{i+1} - b_i)."""
    brackets = {}
    for i in range(n - 1):
        brackets[i, n + i] = {n + i: -1}
        brackets[i + 1, n + i] = {n + i: 1}
    names = [*(f"b{i + 1}" for i in range(n)), *(f"a{i + 1}" for i in range(n - 1))]
    algebra = lp.LieAlgebra.from_brackets(2 * n - 1, brackets, basis_names=[str(k + 1) for k in range(2 * n - 1)])
    bracket = lp.Bracket(algebra, lp.trivial().rename("x"))
    b, a = [f"x{k + 1}" for k in range(n)], [f"x{n + k + 1}" for k in range(n - 1)]
    hamiltonian = " + ".join([*(f"{x}^2/2" for x in b), *(f"{x}^2" for x in a)])
    return lp.System(bracket, hamiltonian, name=f"Toda's chain of {len(names) // 2 + 1}")


@pytest.mark.thorough
def test_todas_open_chain_in_flaschkas_variables():
    r"""$a\sim\pm i/(2\tau)$ where one pair collides.

    With three, the square of the other a, an exponential of a difference of coordinates, has a simple zero there, so
    that $a\sim\tau^{1/2}$: the exponent 3/2. The integrals tr L^k, of weights 1, 2, ..., show among the exponents.
    """
    two, three = painleve_test(flaschka(2)), painleve_test(flaschka(3))
    check(two)
    check(three)
    assert (two.verdict, exponents(two)) == ("passes", [[-1, 1, 2]])
    assert three.verdict == "passes weakly"
    assert exponents(three) == [[-2, -1, 1, 2, 3]] * 2 + [[-1, 1, 1, 3 * HALF, 2]] * 2
    assert [b.is_principal for b in three.balances] == [b.has_branch_points for b in three.balances]


@pytest.mark.thorough
def test_todas_ring_through_its_exponentials():
    found = painleve_test(entry("toda"))
    check(found)
    assert found.verdict == "passes"
    assert sorted(map(str, found.functions.values())) == sorted(
        str(sp.exp(sp.sympify(f))) for f in ("q1 - q2", "q2 - q3", "q3 - q1")
    )
    assert Counter(map(tuple, exponents(found))) == {(-1, 1, 1, 2, 3, 3): 3, (-2, -1, 1, 2, 3, 6): 3}


# families


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["clebsch", "manakov-so4", "neumann"])
def test_balances_on_an_elliptic_curve_are_one_family(name):
    """No parametrisation by rational functions: the coordinate ring of the curve is used."""
    found = painleve_test(entry(name))
    check(found)
    (balance,) = found.balances
    assert (exponents(found), found.verdict) == ([[-1, 0, 1, 2, 2, 2]], "passes")
    assert (len(balance.family), balance.is_generic, balance.is_principal) == (1, True, True)


@pytest.mark.thorough
def test_the_coordinate_ring_of_a_family_says_what_its_field_of_functions_says(monkeypatch):
    from liepoisson.integrability.painleve import singularity_analysis

    systems = [entry("kovalevskaya"), entry("twisted-lagrange"), top((1, 1, 1), (1, 0, 0), (0, 1, 0), 1)]
    over_fields = [painleve_test(system) for system in systems]
    monkeypatch.setattr(singularity_analysis, "_SIMPLE_DEGREE", 0)
    for system, expected in zip(systems, over_fields, strict=True):
        found = painleve_test(system)
        assert found.verdict == expected.verdict
        for one, other in zip(found.balances, expected.balances, strict=True):
            assert one.exponents == other.exponents
            assert [(r.exponent, r.multiplicity, bool(r.conditions)) for r in one.resonances] == [
                (r.exponent, r.multiplicity, bool(r.conditions)) for r in other.resonances
            ]
            assert one.n_constants == other.n_constants
            assert one.obstructions[:1] == other.obstructions[:1]


# series


CASES = [
    (KDV, {"C1": 0.3, "C2": -0.2, "C3": 0.1}, 0.25),
    (KK, {"C1": 0.4, "C2": -0.1, "C3": 0.05}, 0.25),
    (entry("kovalevskaya"), {"C1": 0.3, "C2": -0.2, "C3": 0.1, "C4": 0.2}, 0.2),
    (entry("twisted-lagrange"), {f"C{k}": 0.1 * (-1) ** k for k in range(1, 8)}, 0.2),
    (entry("neumann"), {"C1": 0.2, "C2": -0.1, "C3": 0.1, "C4": 0.1}, 0.2),
]


@pytest.mark.parametrize("system", [KDV, KK, entry("free-rigid-body"), entry("twisted-lagrange")], ids=lambda s: s.name)
def test_exponents_are_eigenvalues_in_double_precision(system):
    """Of the Jacobian of the dominant part, which is the limit of the Jacobian under scaling."""
    n, jacobian = len(system.variables), sp.lambdify(system.variables, system.jacobian)
    for balance in painleve_test(system).balances:
        g = np.array(list(map(float, balance.weights)))
        c = (
            balance.series({"alpha2": 0.7}).coefficients[:, 0]
            if balance.family
            else balance.series().coefficients[:, 0]
        )
        s = 1e-4
        dominant = s * np.diag(s**g) @ np.array(jacobian(*(c * s**-g)), dtype=complex) @ np.diag(s**-g)
        found = np.linalg.eigvals(dominant + np.diag(g))
        assert np.allclose(sorted(found.real), list(map(float, balance.exponents)), atol=1e-3), balance
        assert np.abs(found.imag).max() < 1e-3
        assert len(found) == n


WORST = 1e-9
"""Error of a series with 45 terms within half its radius, and of an integration of length 1; measured: below 2e-11."""


@pytest.mark.thorough
@pytest.mark.parametrize(("system", "constants", "size"), CASES, ids=lambda case: getattr(case, "name", ""))
def test_series_are_solutions_in_complex_time(system, constants, size):
    """From one point near the singularity to another, on the other side of it, by our integrator."""
    for balance in painleve_test(system).balances:
        given = {name: value for name, value in constants.items() if name in {c.name for c in balance.constants}}
        series = balance.series(given, n_terms=45)
        assert series.radius > 2 * size
        start, middle, end = size, size * (1 + 1j), 1j * size
        reached = along(system, series(start), start, middle, end)
        assert np.abs(reached - series(end)).max() / np.abs(series(end)).max() < WORST


def test_a_way_around_a_pole_leads_back_and_one_around_a_branch_point_does_not():
    path = [0.2 * z for z in (1, 1 + 1j, -1 + 1j, -1 - 1j, 1 - 1j, 1)]
    for system, is_single_valued in ((KDV, True), (KK, False)):
        balance = next(b for b in painleve_test(system).balances if b.is_principal)
        series = balance.series({"C1": 0.5, "C2": 0.4}, n_terms=45)
        start = series(path[0])
        once = along(system, start, *path)
        twice = along(system, once, *path)
        assert (np.abs(once - start).max() < 1e-8) == is_single_valued
        assert np.abs(twice - start).max() < 1e-8  # a square root


@pytest.mark.thorough
def test_integrals_are_constant_along_series():
    balance = next(b for b in painleve_test(entry("kovalevskaya")).balances if b.is_principal)
    series = balance.series({"C1": 0.3, "C2": 1 - 1j, "C4": 0.2, "l2": 0.7}, n_terms=60)
    system = entry("kovalevskaya")
    for name, invariant in system.invariants.items():
        f = sp.lambdify(system.variables, invariant)
        assert f(*series(0.1)) == pytest.approx(f(*series(0.15j)), abs=1e-7), name


# what is refused, and what is left


def test_equations_without_singular_solutions():
    oscillator = lp.systems.CanonicalSystem(["x"], ["p"], "p^2/2 + x^2/2")
    found = painleve_test(oscillator)
    assert (found.verdict, found.balances) == ("no balances", ())
    assert "says nothing" in str(found)


def test_numbers_that_are_not_rational_are_refused():
    system = lp.systems.CanonicalSystem(["x"], ["p"], "p^2/2 + sqrt(2)*x^3")
    with pytest.raises(ParameterError, match="wanted rational numbers and symbols"):
        painleve_test(system)


def test_functions_without_algebraic_equations_are_refused():
    with pytest.raises(ParameterError, match="exp, sin, cos"):
        painleve_test(lp.systems.CanonicalSystem(["x"], ["p"], "p^2/2 + exp(x^2)"))


@pytest.mark.parametrize(
    ("weights", "message"),
    [
        ([2, 2, 3], "one for each of x, y, p_x, p_y"),
        ([2, 2, 3, -1], "none negative"),
        ([3, 3, 3, 3], "exceeds its coordinate by"),
        ({"x": 2}, "one for each of"),
        ([2, 2, "x", 3], "rational numbers"),
        ([2, 2, float("inf"), 3], "rational numbers"),
        ([2, 2, "1e999999999", 3], "rational numbers"),
        ("2233", "one for each of"),
    ],
)
def test_weights_that_do_not_fit_are_refused(weights, message):
    with pytest.raises(ParameterError, match=message):
        painleve_test(KDV, weights=weights)


def test_weights_that_are_given():
    found = painleve_test(KDV, weights={"x": 1, "y": 2, "p_x": 2, "p_y": 3})
    assert (exponents(found), found.verdict) == ([[-1, 0, 3, 6]], "passes")


@pytest.mark.thorough
def test_what_the_time_did_not_suffice_for_is_named():
    found = painleve_test(entry("twisted-top"), time_limit=0.01)
    assert (found.verdict, found.complete) == ("undecided", False)
    assert "left: " in str(found)
    assert "verdict: undecided" in str(found)


@pytest.mark.thorough
def test_balances_in_a_subspace_decide_where_not_all_are_found(monkeypatch):
    """A top with two fields and no symmetry is too much for little work; the heavy top in it, beta = 0, fails."""
    from liepoisson.inputs import deadline

    monkeypatch.setattr(deadline.time, "monotonic", lambda: 0.0)
    found = painleve_test(top((2, 3, 4), (3, 0, 4), (0, 1, 0), 1), time_limit=2)
    assert (found.verdict, found.complete) == ("fails", False)
    assert "besides those above" in found.left[0]
    failing = [balance for balance in found.balances if balance.status == "fails"]
    assert any({"beta1", "beta2", "beta3"} <= set(balance.equations) for balance in failing)


def test_balances_that_are_left_are_named(monkeypatch):
    from liepoisson.inputs import deadline

    n_asked = count()
    monkeypatch.setattr(deadline.time, "monotonic", lambda: 100.0 if next(n_asked) > 60 else 0.0)
    found = painleve_test(KDV, time_limit=60)
    assert found.verdict == "undecided"
    assert found.left
    assert all("the time limit" in text for text in found.left)


def test_a_series_with_a_logarithm_is_refused(twisted_kovalevskaya):
    for balance in twisted_kovalevskaya.balances:
        if balance.status == "fails":
            with pytest.raises(ParameterError, match="no logarithm"):
                balance.series()


def test_wrong_names_of_constants_are_refused():
    balance = painleve_test(KDV).balances[0]
    with pytest.raises(ParameterError, match="C1, C2, C3; got 'C9'"):
        balance.series({"C9": 1})
    with pytest.raises(ParameterError, match="conjugate: wanted"):
        balance.series(conjugate=1)


class _nothing:  # noqa: N801  # a context
    def __enter__(self):
        pass

    def __exit__(self, *_):
        pass


def test_a_logarithm_for_all_constants_comes_without_a_condition():
    """Sawada and Kotera's cubic with A = 2, B = 3: the condition at the exponent 2 is B - A, a number."""
    system = lp.System(lp.catalog.system("henon-heiles").bracket, "(p_x^2 + p_y^2 + 2*x^2 + 3*y^2)/2 + x^2*y + y^3/3")
    found = [balance.obstructions for balance in painleve_test(system).balances]
    assert found == [(), ("logarithm at the exponent 2",), ("logarithm at the exponent 2",)]


def test_what_a_condition_depends_on_is_a_coordinate_or_explained():
    bracket = lp.so(3) @ lp.leibniz(3, 1).rename("l", "alpha", "beta")
    for system in (
        lp.System(bracket, "(l1^2 + l2^2 + 2*l3^2)/2 + alpha1 + beta2"),
        lp.System(lp.so(3) @ lp.semidirect(2), "(l1^2 + 2*l2^2 + 3*l3^2)/2 + alpha1 + 2*alpha2 - alpha3"),
    ):
        texts = [text for balance in painleve_test(system).balances for text in balance.obstructions]
        assert any("unless" in text for text in texts)
        assert all("theta" not in text or "theta is a root of" in text for text in texts), texts


def test_exponents_over_algebraic_functions_say_what_theta_is():
    """V = x^2 y + B x^3, at B = 1: a balance (x, y)/t^2 has -6x = 2xy + 3Bx^2 and -6y = x^2, so x^2 - 9Bx - 18 = 0.

    The linear equation v'' = -V'' v/t^2 has powers r - 2 with (r - 2)(r - 3) = s, where s is the eigenvalue of -V''
    besides 12, which belongs to -1 and 6.
    """
    system = lp.System(lp.catalog.system("henon-heiles").bracket, "(p_x^2+p_y^2)/2 + x^2*y + B*x^3", symbols=["B"])
    (balance,) = painleve_test(system).balances
    assert str(balance.kovalevskaya) == (
        "-1, 6, the roots of r^2 - 5*r + 6 + theta, where theta is a root of theta^2 + (-27*B^2 - 12)*theta + 36"
    )
    x = np.roots([1, -9, -18])
    theta = 12 + 6 * x + 2 * (-(x**2) / 6)  # s = -12 - trace(V''), and theta = -s
    np.testing.assert_allclose(sorted(theta), sorted(np.roots([1, -39, 36])), rtol=1e-12)
