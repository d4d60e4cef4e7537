"""Integrals that survive a deformation, against tops whose integrals are known, and proofs that others do not."""

import pytest
import sympy
from sympy import Rational, Symbol, expand, symbols

import liepoisson as lp

HEAVY = lp.so(3) @ lp.semidirect(2)
TWISTED = lp.so(3) @ lp.leibniz(3, "epsilon")
KOVALEVSKAYA = {"I": [2, 2, 1]}
KINETIC = "dot(l, inv(I)*l)/2"


def kovalevskaya(bracket, energy=f"{KINETIC} - alpha1", **options):
    return lp.System(bracket, energy, KOVALEVSKAYA, name="Kovalevskaya", **options)


def surviving(found):
    return {str(f.start): f for f in found.integrals}


def is_integral(system, function):
    """By SymPy's brackets, which share nothing with the search."""
    return expand(system.bracket(function, system.hamiltonian)) == 0


@pytest.fixture(scope="module")
def twisted_kovalevskaya():
    return lp.deformations(kovalevskaya(TWISTED), parameter="epsilon", weight=10, order=1)


def test_no_integral_of_the_kovalevskaya_top_survives_the_twist(twisted_kovalevskaya):
    """The question of the paper, for every polynomial in K, l.alpha, H and Casimirs, of weight at most 10."""
    found = twisted_kovalevskaya
    assert found.weights["epsilon"] == 0
    assert found.weights["l1"], found.weights["beta3"] == (1, 3)
    assert {str(f) for f in found.known} == {"K", "l_alpha"}
    assert found.integrals == ()
    assert len(found.obstructions) == found.n_starts == 46
    assert {o.order for o in found.obstructions} == {1}
    # nothing of weight 2 has beta in it: what is added to the Hamiltonian does not matter
    assert found.hamiltonian_terms == ()


@pytest.mark.parametrize("name", ["K", "l_alpha", "H*K"])
def test_an_obstruction_is_seen_by_brackets_alone(twisted_kovalevskaya, name):
    """The functional vanishes on {m, H}_0 for every monomial of its bidegree, and not on {F0, H}_1."""
    (obstruction,) = (o for o in twisted_kovalevskaya.obstructions if str(o.start) == name)
    system = twisted_kovalevskaya.system
    epsilon = Symbol("epsilon")
    x = system.variables

    def value(function):
        rate = sympy.Poly(expand(system.bracket(function, system.hamiltonian)), *x, epsilon)
        terms = {sympy.prod(v**k for v, k in zip((*x, epsilon), m, strict=True)): c for m, c in rate.terms()}
        return sum(c * obstruction.functional.get(m, 0) for m, c in terms.items() if m.as_powers_dict()[epsilon] <= 1)

    assert value(obstruction.function) == obstruction.value != 0
    weight = max(sum(w * k for w, k in zip([1] * 3 + [2] * 3 + [3] * 3, m, strict=True)) for m in
                 sympy.Poly(obstruction.function, *x).monoms())  # fmt: skip
    lower, vectors = weight - 3, x[:6]
    n = 0
    for m in sympy.itermonomials(vectors, lower):
        if sum(w * k for w, k in zip([1, 1, 1, 2, 2, 2], sympy.Poly(m, *vectors).monoms()[0], strict=True)) == lower:
            for b in x[6:]:
                n += 1
                assert value(epsilon * m * b) == 0
    assert n >= obstruction.n_corrections > 0


def test_what_is_trivial_is_not_counted(twisted_kovalevskaya):
    """The Casimirs of the twisted bracket have limits, which survive with H."""
    assert list(twisted_kovalevskaya.trivial) == ["H", "C1", "C2", "C3"]
    names = {str(o.start) for o in twisted_kovalevskaya.obstructions}
    assert "H" not in names
    assert "C1*H" not in names


def test_the_twisted_lagrange_top_keeps_its_second_integral():
    top = lp.System(TWISTED, f"{KINETIC} + a3*alpha3", {"I": ["I1", "I1", "I3"]}, symbols=["I1", "I3", "a3"])
    found = surviving(lp.deformations(top, parameter="epsilon", weight=3))
    x = dict(zip(map(str, top.variables), top.variables, strict=True))
    i1, a3, epsilon = symbols("I1 a3 epsilon")
    spin = sum(x[f"l{k}"] * x[f"alpha{k}"] for k in (1, 2, 3))
    second = found["l_alpha"].function if "l_alpha" in found else found["P"].function
    assert expand(second - spin - epsilon * i1 * a3 * x["beta3"]) == 0
    assert all(f.is_exact for f in found.values())


def test_the_charged_twisted_lagrange_top_keeps_its_second_integral():
    top = lp.System(
        TWISTED, f"{KINETIC} + a3*alpha3 + b3*beta3", {"I": ["I1", "I1", "I3"]}, symbols=["I1", "I3", "a3", "b3"]
    )
    a3, b3, i1, epsilon = symbols("a3 b3 I1 epsilon")
    l, alpha, beta = (list(top.variables[k : k + 3]) for k in (0, 3, 6))
    at_0 = sum(p * (a3 * q + b3 * r) for p, q, r in zip(l, alpha, beta, strict=True))
    found = lp.deformations(top, parameter="epsilon", integrals={"P0": at_0}, degree=2)
    (second,) = (f for f in found.exact if f.start == Symbol("P0"))
    assert expand(second.function - at_0 - epsilon * a3**2 * i1 * beta[2]) == 0
    assert is_integral(top, second.function)


def test_kovalevskaya_keeps_its_quartic_with_a_rotor_along_the_axis():
    """Yehia's gyrostat, and no other rotor."""
    axial = kovalevskaya(HEAVY, f"{KINETIC} - alpha1 + k*l3", symbols=["k"])
    found = lp.deformations(axial, parameter="k", weight=4)
    (quartic,) = found.integrals
    assert str(quartic.start) == "K"
    assert quartic.is_exact
    assert is_integral(axial, quartic.function)
    k = Symbol("k")
    assert quartic.function.coeff(k, 1) != 0
    for other in ("l1", "l2", "l2 - l3/3"):
        tilted = kovalevskaya(HEAVY, f"{KINETIC} - alpha1 + k*({other})", symbols=["k"])
        assert lp.deformations(tilted, parameter="k", weight=4).exact == ()


def test_rotors_that_keep_the_quartic_are_found_among_all():
    """Three parameters at once: the conditions say k1 = k2 = 0."""
    gyrostat = kovalevskaya(HEAVY, f"{KINETIC} - alpha1 + k1*l1 + k2*l2 + k3*l3", symbols=["k1", "k2", "k3"])
    found = lp.deformations(gyrostat, parameter=["k1", "k2", "k3"], weight=4)
    (case,) = found.cases
    assert {str(c) for c in case.conditions} == {"k1", "k2"}
    assert case.is_exact
    assert case.dimension == 1
    at = gyrostat.hamiltonian.subs({"k1": 0, "k2": 0})
    assert expand(gyrostat.bracket(case.function, at)) == 0


def test_kovalevskaya_survives_on_so4_and_so31():
    """Komarov: so(3) (x) R[z]/z^2 with e1 e1 = t e0 is so(4) for t > 0 and so(3,1) for t < 0."""
    t = Symbol("t")
    extension = lp.Extension.from_products(2, {(0, 0): {0: 1}, (0, 1): {1: 1}, (1, 1): {0: t}})
    top = kovalevskaya(lp.so(3) @ extension)
    (quartic,) = lp.deformations(top, parameter="t", weight=4).integrals
    assert quartic.is_exact
    assert is_integral(top, quartic.function)
    wrong = {**KOVALEVSKAYA, "I": [2, 2, Rational(3, 2)]}
    other = lp.System(lp.so(3) @ extension, f"{KINETIC} - alpha1", wrong, name="another")
    assert lp.deformations(other, parameter="t", weight=4).integrals == ()


def test_a_potential_that_spoils_the_quartic_is_found_out():
    good = kovalevskaya(HEAVY, f"{KINETIC} - alpha1 + k*(alpha1^2 - alpha2^2)", symbols=["k"])
    bad = kovalevskaya(HEAVY, f"{KINETIC} - alpha1 + k*(alpha1^2 + alpha2^2)", symbols=["k"])
    assert not lp.deformations(bad, parameter="k", degree=4).exact
    assert not lp.deformations(good, parameter="k", degree=4).exact  # on C1 = 0 alone (Chaplygin)
