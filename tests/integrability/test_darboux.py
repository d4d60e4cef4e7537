"""Darboux polynomials: those of the literature are found, all are checked, and where there are none it is proved."""

from random import Random

import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.errors import ParameterError

darboux_polynomials = lp.integrability.darboux_polynomials
entry = lp.catalog.system
E3 = lp.so(3) @ lp.semidirect(2).rename("l", "alpha")
SQUARES_OF_RATIOS = lp.System(lp.so(3) @ lp.trivial(), "(l1^2 + 2*l2^2 + 6*l3^2)/2", name="rigid body")
HESS = lp.System(E3, "(l1^2 + 2*l2^2 + 6*l3^2)/2 + alpha1 + 2*alpha3", name="Hess top")


def solvable(a, hamiltonian):
    """{x1, x3} = -x1, {x2, x3} = -a x2, whose Casimir x1^a / x2 is rational for a positive integer a."""
    algebra = lp.LieAlgebra.from_brackets(3, {(0, 2): {0: 1}, (1, 2): {1: a}}, basis_names=["1", "2", "3"])
    return lp.System(lp.Bracket(algebra, lp.trivial().rename("x")), hamiltonian, name="solvable")


def check(found):
    """All that was found is what it is said to be."""
    system = found.system
    for p in found.found:
        assert sp.expand(system.derivative(p.expression) - p.cofactor * p.expression) == 0
        assert sp.Poly(p.expression, *system.variables).total_degree() == p.degree
    names = {p.name: p.expression for p in found.found}
    for r in found.rational_integrals:
        product = sp.prod([names[name] ** n for name, n in r.powers.items()])
        assert sp.cancel(sp.together(r.expression / product)) == 1
        assert sp.cancel(sp.together(system.derivative(r.expression))) == 0


def lines(polynomials):
    """Polynomials up to factors."""
    return {sp.Poly(p, *sorted(p.free_symbols, key=str), extension=True).monic().as_expr() for p in polynomials}


def test_planes_of_a_rigid_body_through_its_separatrices():
    """For l1 + c l3 the rate l2 ((J3 - J2) l3 + c (J2 - J1) l1), up to a sign, is c (J2 - J1) l2 times l1 + c l3 if
    c^2 = (J3 - J2)/(J2 - J1): 4 for J = (1, 2, 6). The other two pairs of planes are complex.
    """
    real = darboux_polynomials(SQUARES_OF_RATIOS, degree=1, field="rational")
    check(real)
    l1, l2, l3 = real.system.variables
    assert lines(real.invariant_hypersurfaces) == {l1 + 2 * l3, l1 - 2 * l3}
    assert {p.cofactor / l2 for p in real.found} == {2, -2}
    everything = darboux_polynomials(SQUARES_OF_RATIOS, degree=1)
    check(everything)
    i = sp.I * sp.sqrt(5)
    assert len(everything.found) == 6
    assert {p.cofactor for p in everything.found} == {2 * l2, -2 * l2, i * l1, -i * l1, 2 * i * l3, -2 * i * l3}
    assert [r.is_polynomial for r in everything.rational_integrals] == [True] * 3
    assert not any(r.is_independent for r in everything.rational_integrals)
    assert everything.complete


def test_the_invariant_relation_of_hess():
    """For p = a.l the rate is det(a, l, J l) up to a sign; with a = (a1, 0, a3) this is
    l2 (a1 (J3 - J2) l3 + a3 (J2 - J1) l1), a multiple of p if a1^2 (J3 - J2) = a3^2 (J2 - J1).
    """
    l1, l2, l3 = HESS.variables[:3]
    for on in ((), "C1 = 0"):
        found = darboux_polynomials(HESS, degree=2, on=on)
        check(found)
        assert [(p.expression, sp.Abs(p.cofactor / l2)) for p in found.found] == [(l1 + 2 * l3, 2)]
        assert found.invariant_hypersurfaces == (l1 + 2 * l3,)
        assert found.complete
    other = lp.System(E3, "(l1^2 + 2*l2^2 + 6*l3^2)/2 + alpha1 + 3*alpha3")
    assert not darboux_polynomials(other, degree=2).found


def test_kovalevskayas_integral_is_a_product():
    """K = |xi|^2 with xi = (l1 + i l2)^2 + 4 (alpha1 + i alpha2) and the rate of xi = -i l3 xi, up to signs."""
    system = entry("kovalevskaya")
    for scope in ({"degree": 2}, {"weight": 4}):
        found = darboux_polynomials(system, **scope)
        check(found)
        l3 = system.variables[2]
        assert {p.cofactor for p in found.found} == {sp.I * l3, -sp.I * l3}
        (product,) = found.rational_integrals
        assert product.powers == {"P1": 1, "P2": 1}
        assert product.is_polynomial
        assert product.is_independent
        (known,) = [f for name, f in system.integrals.items() if name == "K"]
        ratio = sp.cancel(product.expression / known)
        assert ratio.is_number
        assert found.complete
        assert found.invariant_hypersurfaces == ()
        first, second = found.found[0].equations
        assert sp.expand(first + sp.I * second - found.found[0].expression) == 0
    assert not darboux_polynomials(system, degree=2, field="real").found


def test_the_casimir_of_a_solvable_algebra_is_rational():
    for a in (1, 3):
        found = darboux_polynomials(solvable(a, "x3^2/2 + x1 + x2"), degree=1, known={})
        check(found)
        x1, x2, x3 = found.system.variables
        assert {x1, x2} <= {p.expression for p in found.found}
        casimir = next(r for r in found.rational_integrals if not r.is_polynomial)
        assert sp.cancel(casimir.expression * x2 / x1**a) in (1, sp.cancel(x2**2 / x1 ** (2 * a)))
        assert sp.cancel(found.system.bracket(casimir.expression, x3)) == 0
        assert casimir.is_independent


@pytest.mark.parametrize("seed", range(3))
def test_factors_of_the_hamiltonian_are_darboux_polynomials(seed):
    """{f, f g} = f {f, g}: f is a Darboux polynomial of H = f g with the cofactor {f, g}."""
    random, bracket = Random(seed), lp.canonical(1)
    q, p = bracket.variables
    f = p * random.randint(1, 3) + q**2 * random.randint(1, 3) + random.randint(-3, 3)
    g = q * random.randint(1, 3) + random.randint(1, 3) * p + random.randint(1, 3)
    found = darboux_polynomials(lp.System(bracket, sp.expand(f * g)), degree=2)
    check(found)
    assert lines([f, g]) <= lines([x.expression for x in found.found])
    cofactors = [x.cofactor for x in found.found]
    assert sp.expand(bracket(f, g)) in cofactors
    assert sp.expand(-bracket(f, g)) in cofactors
    assert found.complete


@pytest.mark.parametrize(
    ("system", "scope"),
    [
        (lambda: lp.System(E3, "(l1^2 + 2*l2^2 + 6*l3^2)/2 + alpha1 + 2*alpha2 - alpha3"), {"degree": 2}),
        (lambda: lp.Top(inertia=(2, 3, 5), a=(1, 2, 3), b=(3, -1, 2), epsilon=1), {"degree": 1}),
        (lp.Top.twisted_kovalevskaya, {"weight": 4}),
    ],
)
def test_where_there_are_none_it_is_proved(system, scope):
    found = darboux_polynomials(system(), **scope)
    assert (found.found, found.rational_integrals, found.complete) == ((), (), True)


def test_cofactors_that_are_left_are_named():
    found = darboux_polynomials(HESS, degree=4, time_limit=0.3)
    assert not found.complete
    assert found.left
    assert "incomplete" in repr(found)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: darboux_polynomials(entry("toda")), "wanted a polynomial in q1, q2, q3, p1, p2, p3; got exp"),
        (
            lambda: darboux_polynomials(entry("twisted-top")),
            "wanted rational numbers in the equations; got twisted-top with a1",
        ),
        (lambda: darboux_polynomials(entry("zeitlin-3")), "irrational ones"),
        (lambda: darboux_polynomials(HESS, degree=40), "degree: wanted at most 6"),
        (lambda: darboux_polynomials(HESS, degree=0), "degree"),
        (lambda: darboux_polynomials(HESS, degree=2, weight=2), "got both"),
        (lambda: darboux_polynomials(HESS, weight=100), "weight: wanted at most"),
        (lambda: darboux_polynomials(entry("henon-heiles"), weight=4), "homogeneous for positive weights"),
        (lambda: darboux_polynomials(HESS, field="quaternions"), "field: wanted 'complex', 'real' or 'rational'"),
        (lambda: darboux_polynomials(HESS, known={"x": "l1"}), "known: wanted integrals; got x = l1"),
        (lambda: darboux_polynomials(HESS, on="l1"), "orbits do not leave"),
        (lambda: darboux_polynomials(HESS, time_limit=-1), "time_limit"),
    ],
)
def test_what_cannot_be_searched_is_refused(call, words):
    with pytest.raises(ParameterError, match=words):
        call()
