"""Equations of critical values against closed forms, computed here by resultants, and against critical states."""

import pytest
import sympy as sp

import liepoisson as lp

H, K, L3, C1, C2 = sp.symbols("H K l3 C1 C2")
S, M, ELL = sp.symbols("s m ell")


def factors(*polynomials):
    """The irreducible factors that are no monomials, up to constants."""
    found = {sp.Poly(f, H, K, L3, C1, C2).monic() for p in polynomials for f, _ in sp.factor_list(sp.expand(p))[1]}
    return {f for f in found if len(f.terms()) > 1 or f.as_expr() == K}


def equations(name, casimirs, **options):
    found = lp.tori.critical_equations(lp.catalog.system(name), casimirs, **options)
    assert found.others == ()
    return factors(*found.curves)


def kovalevskaya(ell):
    """K = 0, K = (H - 2 l^2)^2, and H = s + l^2/s^2, K = 1 - 2 l^2/s + l^4/s^4, l = (l.alpha)/2 (Kharlamov 1988)."""
    ends = S**2 * (S - H) + ell**2, S**4 * (1 - K) - 2 * ell**2 * S**3 + ell**4
    return factors(K, K - (H - 2 * ell**2) ** 2, sp.resultant(*ends, S))


@pytest.mark.parametrize("constant", [sp.Rational(3, 5), pytest.param(sp.Rational(11, 10), marks=pytest.mark.slow), 2])
def test_the_kovalevskaya_top(constant):
    found = equations("kovalevskaya", {"C1": str(constant), "C2": 1})
    assert found == kovalevskaya(constant / sp.Integer(2))


def test_the_kovalevskaya_top_for_every_constant_of_areas():
    found = lp.tori.critical_equations(lp.catalog.system("kovalevskaya"))
    assert factors(*(p.subs(C2, 1) for p in found.curves)) == kovalevskaya(C1 / 2)


def test_the_spherical_pendulum_is_a_discriminant():
    """Of the height z: z'^2/2 = (H - z)(1 - z^2) - l3^2/2; critical where this has double zeros."""
    wanted = sp.discriminant((H - S) * (1 - S**2) - L3**2 / 2, S)
    assert equations("spherical-pendulum", {"C1": 0, "C2": 1}) == factors(wanted)


def test_the_lagrange_top_is_a_discriminant():
    """l1^2 + l2^2 and C1 give z'^2 = (2 H - l3^2/I3 - 2 z)(C2 - z^2) - (C1 - l3 z)^2 with I1 = 1."""
    top = lp.catalog.system("lagrange")
    inertia = {name: sp.Rational(str(value)) for name, value in top.parameters.items()}
    assert inertia["I1"] == 1
    energy = 2 * H - L3**2 / inertia["I3"]
    wanted = sp.discriminant((energy - 2 * inertia["a3"] * S) * (C2 - S**2) - (C1 - L3 * S) ** 2, S)
    assert factors(wanted) == equations("lagrange", {})


def test_separated_oscillators_have_lines():
    """Two double wells: a state is critical where one of them is, at 0 or -1/4 of its energy."""
    wells = lp.System(lp.canonical(2), "p1^2/2 - q1^2/2 + q1^4/4 + p2^2/2 - q2^2 + q2^4")
    first = "p1^2/2 - q1^2/2 + q1^4/4"
    momentum = lp.tori.momentum_map(wells, [first])
    e = sp.Symbol(first)
    found = lp.tori.critical_equations(momentum)
    assert {sp.Poly(p, H, e).monic() for p in found.curves} == {
        sp.Poly(p, H, e).monic() for p in (e, e + sp.Rational(1, 4), H - e, H - e + sp.Rational(1, 4))
    }


@pytest.mark.parametrize(
    ("name", "casimirs"),
    [("clebsch", {"C1": 0, "C2": 1}), ("henon-heiles-kdv", {}), ("manakov-so4", {"C1": 2, "C2": "1/3"})],
)
def test_critical_states_are_zeros(name, casimirs):
    """A polynomial at a state that is critical to 1e-9 is small beside its terms: they cancel."""
    system = lp.catalog.system(name)
    found = lp.tori.critical_equations(system, casimirs)
    states = lp.tori.critical_states(lp.Leaf(system, casimirs), n_starts=40)
    symbols = [sp.Symbol(n) for n in found.momentum.names]
    assert len(states.states) > 10
    for value in states.values:
        at = dict(zip(symbols, map(sp.Float, value), strict=True))
        terms = [[term.subs(at) for term in sp.Add.make_args(p)] for p in found.curves]
        assert any(abs(sum(one)) <= 1e-8 * max(map(abs, one)) for one in terms)


def test_bad_input():
    pendulum = lp.catalog.system("spherical-pendulum")
    with pytest.raises(lp.errors.ParameterError, match="rational number"):
        lp.tori.critical_equations(pendulum, {"C1": 0, "C2": "sqrt(2)"})
    with pytest.raises(lp.errors.ParameterError, match="Casimirs"):
        lp.tori.critical_equations(pendulum, {"C3": 0})
    with pytest.raises(lp.errors.ParameterError, match="polynomial"):
        lp.tori.critical_equations(lp.catalog.system("toda"), {})
    with pytest.raises(lp.errors.TimeLimitError):
        lp.tori.critical_equations(lp.catalog.system("twisted-lagrange"), {"C1": 1, "C2": 0, "C3": 1}, time_limit=0.3)
