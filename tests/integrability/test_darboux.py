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


@pytest.mark.parametrize(("field", "number"), [("complex", 6), ("real", 2), ("rational", 0)])
def test_planes_with_irrational_coefficients(field, number):
    """For J = (1, 2, 5), c^2 = 3."""
    body = lp.System(lp.so(3) @ lp.trivial(), "(l1^2 + 2*l2^2 + 5*l3^2)/2")
    found = darboux_polynomials(body, degree=1, field=field)
    check(found)
    assert (len(found.found), found.complete, found.field) == (number, True, field)


@pytest.mark.parametrize("degree", [2, 3])
def test_products_are_not_listed(degree):
    found = darboux_polynomials(SQUARES_OF_RATIOS, degree=degree)
    assert [p.degree for p in found.found] == [1] * 6
    assert found.complete


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


def test_on_a_level_there_are_more():
    """Goryachev and Chaplygin's integral exists for l.alpha = 0 only; there it has the cofactor zero."""
    system = entry("goryachev-chaplygin")
    claimed, level = system.partial_integrals["G"]
    found = darboux_polynomials(system, degree=3, on="C1 = 0")
    assert (found.on, found.complete) == ((level,), True)
    assert [(sp.expand(p.expression - claimed), p.cofactor) for p in found.found] == [(0, 0)]
    assert [(r.powers, r.is_independent) for r in found.rational_integrals] == [({"P1": 1}, True)]
    assert not darboux_polynomials(system, degree=3).found


def test_chaplygins_integral_is_a_product_of_four_planes():
    """For m.p = 0 the integral is ((m1 + i m2)^2 + p3^2) ((m1 - i m2)^2 + p3^2), and each factor a product."""
    system = entry("chaplygin")
    (claimed, level), *_ = system.partial_integrals.values()
    found = darboux_polynomials(system, degree=1, on="C1 = 0")
    assert (found.on, [p.degree for p in found.found], found.complete) == ((level,), [1] * 4, True)
    for p in found.found:
        rate = sp.expand(system.derivative(p.expression) - p.cofactor * p.expression)
        assert sp.rem(rate, level, *system.variables) == 0
    (product,) = found.rational_integrals
    assert product.powers == {"P1": 1, "P2": 1, "P3": 1, "P4": 1}
    assert product.is_independent
    assert sp.expand(product.expression - claimed) == 0


def test_kovalevskayas_integral_is_a_product():
    """K = |xi|^2 with xi = (l1 + i l2)^2 + 4 (alpha1 + i alpha2) and the rate of xi = -i l3 xi, up to signs."""
    system = entry("kovalevskaya")
    for scope in ({"degree": 2}, {"weight": 2}, {"weight": 4}):
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
    for a in (1, 2, 3):
        found = darboux_polynomials(solvable(a, "x3^2/2 + x1 + x2"), degree=1, known={})
        check(found)
        x1, x2, x3 = found.system.variables
        assert {x1, x2} <= {p.expression for p in found.found}
        casimir = next(r for r in found.rational_integrals if not r.is_polynomial)
        assert sp.cancel(casimir.expression * x2 / x1**a) in (1, sp.cancel(x2**2 / x1 ** (2 * a)))
        assert sp.cancel(found.system.bracket(casimir.expression, x3)) == 0
        assert casimir.is_independent


def test_coordinates_of_a_rattleback_are_darboux_polynomials():
    """x1' = 4 x1 x3 and x2' = -x2 x3: C = x1 x2^4."""
    found = darboux_polynomials(entry("rattleback"), degree=2, field="rational")
    check(found)
    assert [str(r) for r in found.rational_integrals] == ["P1*P2^4"]
    x1, x2, x3 = found.system.variables
    assert {(p.expression, p.cofactor) for p in found.found} == {(x1, 4 * x3), (x2, -x3)}


def test_linear_darboux_polynomials_of_lyapunovs_body():
    """Three pairs, whose products are integrals: among H, the Casimirs and the products one is new."""
    found = darboux_polynomials(entry("lyapunov"), degree=1)
    check(found)
    assert len(found.found) == 6
    assert found.complete
    assert [r.is_independent for r in found.rational_integrals] == [True, False, False]


@pytest.mark.parametrize("seed", range(6))
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


def test_the_lowest_degrees_are_taken():
    """Without gradings l3 and its square are found together."""
    gyrostat = lp.System(lp.so(3) @ lp.trivial(), "(l1^2 + l2^2 + 2*l3^2)/2 + l3", name="gyrostat")
    found = darboux_polynomials(gyrostat, degree=2)
    check(found)
    l3 = gyrostat.variables[2]
    assert [p.degree for p in found.found] == [1, 1, 1]
    rate = sp.expand(sp.I * (l3 + 1))
    assert {sp.expand(p.cofactor) for p in found.found} == {0, rate, sp.expand(-rate)}


def test_on_a_level_its_equations_count():
    """Where C1 = 1 the product of two planes is a function of H, which it is not elsewhere."""
    found = darboux_polynomials(SQUARES_OF_RATIOS, degree=1, on="C1 = 1", field="rational")
    assert [(str(r), r.is_independent) for r in found.rational_integrals] == [("P1*P2", False)]


def test_a_function_of_known_integrals_is_marked():
    """H = p^2/2 is known; p itself has the cofactor zero and depends on it."""
    found = darboux_polynomials(lp.System(lp.canonical(1), "p1^2/2"), degree=1)
    assert [(str(x.expression), x.cofactor) for x in found.found] == [("p1", 0)]
    assert [(str(r), r.is_independent) for r in found.rational_integrals] == [("P1", False)]
    assert found.invariant_hypersurfaces == ()


@pytest.mark.parametrize(
    ("system", "scope"),
    [
        (lambda: lp.System(E3, "(l1^2 + 2*l2^2 + 6*l3^2)/2 + alpha1 + 2*alpha2 - alpha3"), {"degree": 2}),
        (lambda: lp.Top(inertia=(2, 3, 5), a=(1, 2, 3), b=(3, -1, 2), epsilon=1), {"degree": 1}),
        (lambda: entry("henon-heiles"), {"degree": 3}),
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
    assert "these cofactors k are left:" in str(found)
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
        (lambda: darboux_polynomials(HESS, degree=10**12), "degree: wanted at most 6"),
        (lambda: darboux_polynomials(HESS, weight=10**12), "weight: wanted at most"),
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


def test_what_is_printed():
    found = darboux_polynomials(HESS, degree=1)
    assert str(found).splitlines() == [
        "Hess top: Darboux polynomials among polynomials up to degree 1, over the complex numbers",
        "known integrals: H, C1, C2",
        "P1 = 2*l3 + l1, cofactor 2*l2",
        "proved over the complex numbers: Every other one is a sum of products of these and the known integrals, all "
        f"with one cofactor. (6 monomials in 3 blocks; cofactors with l1, l2, l3; {found.n_cases} cases)",
    ]
    assert repr(found) == (
        "<DarbouxPolynomials of Hess top: 1 among polynomials up to degree 1 over the complex numbers, complete>"
    )
    assert found._repr_html_() == f"<pre>{found}</pre>"
