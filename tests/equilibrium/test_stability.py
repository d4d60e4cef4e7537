"""Stability of given states; the sleeping top against direct eigenvalues and against its polynomial, exactly."""

from fractions import Fraction

import numpy as np
import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st

import liepoisson as lp
from liepoisson.equilibrium.linearisation import definite_combination
from liepoisson.equilibrium.sleeping import sleeping_top
from liepoisson.errors import ParameterError
from liepoisson.plot.rigid_body import sleeping_diagram

TENTHS = st.integers(-30, 30).map(lambda n: Fraction(n, 10))


@pytest.mark.thorough
def test_characteristic_polynomial_is_the_product_of_two_conjugate_q():
    """det(A - t) = q(t) conj(q)(t) with q(t) = Q(I1 (i t - l3/I3)) i/I1^3, for all parameters."""
    I1, I3 = sympy.symbols("I1 I3", positive=True)
    a3, b3, eps, l3, alpha3, beta3 = sympy.symbols("a3 b3 eps l3 alpha3 beta3", real=True)
    top = lp.Top(inertia=(I1, I1, I3), a=(0, 0, a3), b=(0, 0, b3), epsilon=eps)
    at = dict(zip(top.variables, (0, 0, l3, 0, 0, alpha3, 0, 0, beta3), strict=True))
    transverse = [0, 1, 3, 4, 6, 7]
    block = top.jacobian.subs(at).extract(transverse, transverse)
    mu, t = sympy.symbols("mu t")
    # The eigenvalue of a root lambda is -i (l3/I3 + lambda/I1); Q and its conjugate give all six.
    turned = (block - t * sympy.eye(6)).det(method="berkowitz")
    q = mu**3 + l3 * mu**2 + I1 * (a3 * alpha3 + b3 * beta3) * mu + eps * a3**2 * I1**2 * beta3
    one = (sympy.I * q.subs(mu, I1 * (sympy.I * t - l3 / I3)) / I1**3).expand()
    other = one.subs(sympy.I, -sympy.I)
    assert sympy.expand(turned - one * other) == 0


@pytest.mark.thorough
@settings(max_examples=25)
@given(
    st.tuples(st.integers(5, 20), st.integers(5, 20), TENTHS, TENTHS, TENTHS),
    st.integers(-60, 60),
    st.tuples(TENTHS, TENTHS),
)
def test_sleeping_top_has_the_direct_eigenvalues(top_parameters, spin, fields):
    (I1, I3, a3, b3, epsilon), (alpha3, beta3) = top_parameters, fields
    if not alpha3 and not beta3:
        return
    top = lp.Top(inertia=(I1, I1, min(I3, 2 * I1)), a=(0, 0, a3), b=(0, 0, b3), epsilon=epsilon)
    sleeping = sleeping_top(top, l3=Fraction(spin, 10), alpha3=alpha3, beta3=beta3)
    jacobian = top.functions.jacobian(sleeping.state)
    direct = np.linalg.eigvals(jacobian)
    scale = np.abs(jacobian).max() + 1e-300
    for frequency in sleeping.frequencies:
        # A threefold root scatters by the cube root of the round-off, 6e-6.
        assert np.abs(direct + 1j * frequency).min() < 1e-4 * scale
    assert sleeping.growth_rate <= direct.real.max() + 1e-4 * scale
    assert direct.real.max() <= sleeping.growth_rate + 1e-4 * scale


@pytest.mark.parametrize(("spin", "verdict"), [("1.99", "unstable"), ("2", "degenerate"), ("2.01", "stable spectrum")])
def test_ordinary_sleeping_top_is_stable_above_the_critical_spin(spin, verdict):
    """l3^2 > 4 I1 a3 alpha3, here 4."""
    sleeping = sleeping_top(lp.Top.lagrange(), l3=spin, alpha3=1)
    assert sleeping.discriminant == Fraction(spin) ** 2 - 4
    assert sleeping.linear_stability == verdict
    found = sleeping.analysis(along=())
    assert found.linear_stability == ("undecided" if verdict == "degenerate" else verdict)
    assert found.growth_rate == pytest.approx(sleeping.growth_rate, abs=1e-12)


def sleeping_tops_with_roots(n):
    """Charged and twisted sleeping tops whose Q has given real roots, 0.2 apart at least; their signs."""
    rng = np.random.default_rng(0)
    while n:
        roots = np.sort(rng.choice([-1, 1], 3) * rng.integers(2, 30, 3)) * Fraction(1, 10)
        moment, a3, b3, epsilon = (Fraction(int(k), 10) for k in rng.integers(5, 15, 4))
        if min(np.diff(roots)) < Fraction(1, 5):
            continue
        n -= 1
        x, y, z = roots
        top = lp.Top(inertia=(moment, moment, 1), a=(0, 0, a3), b=(0, 0, b3), epsilon=epsilon)
        beta3 = -x * y * z / (epsilon * a3**2 * moment**2)
        alpha3 = ((x * y + y * z + z * x) / moment - b3 * beta3) / a3
        yield sleeping_top(top, l3=-(x + y + z), alpha3=alpha3, beta3=beta3), len({root > 0 for root in roots}) == 2


@pytest.mark.thorough
@pytest.mark.filterwarnings("ignore::liepoisson.errors.InertiaWarning")
def test_energy_momentum_proves_every_stable_twisted_sleeping_top():
    """With l3 alone where Q has roots of both signs, with P besides where all have the same sign."""
    seen = set()
    for sleeping, both_signs in sleeping_tops_with_roots(4):
        seen.add(both_signs)
        assert sleeping.linear_stability == "stable spectrum"
        alone, with_all = sleeping.analysis(along=("l3",)), sleeping.analysis()
        assert alone.linear_stability == with_all.linear_stability == "stable spectrum"
        assert alone.nonlinear_stability == ("stable" if both_signs else "no conclusion")
        assert with_all.nonlinear_stability == "stable"
    assert seen == {True, False}


@pytest.mark.parametrize("spin", ["-4", "3.5"])
def test_unstable_twisted_sleeping_top_has_no_definite_combination(spin):
    sleeping = sleeping_top(lp.Top.twisted_lagrange(), l3=spin, alpha3=4, beta3=1)
    found = sleeping.analysis()
    assert sleeping.linear_stability == found.linear_stability == "unstable"
    assert found.growth_rate == pytest.approx(sleeping.growth_rate, rel=1e-12)
    assert found.nonlinear_stability == "no conclusion"


@pytest.mark.thorough
def test_second_variation_is_that_of_the_lagrangian_restricted_to_the_leaf():
    """Signature of Hess(H - sum lambda C) on the tangent space of the leaf, computed with the Casimirs."""
    system = lp.catalog.system("twisted-kovalevskaya")
    leaf = lp.Leaf.through(system, lp.sample_states(system, 1, seed=1)[0])
    for e in lp.equilibria(system, leaf, n_starts=40):
        hessian = system.functions.energy.hessian(e.state)
        for name, casimir in system.functions.casimirs.items():
            hessian = hessian - e.multipliers[name] * casimir.hessian(e.state)
        basis = leaf.tangent_basis(e.state)
        values = np.linalg.eigvalsh(basis.T @ hessian @ basis)
        assert e.signature == ((values > 1e-9).sum(), (values < -1e-9).sum(), (np.abs(values) <= 1e-9).sum())


def test_an_integral_at_a_leaf_of_one_state():
    for e in (lp.phase_space.equilibrium, lp.phase_space.equilibrium_near):
        found = e(lp.Top.twisted_lagrange(), np.zeros(9), along=("l3",))
        assert (found.spectrum.shape, found.signature, found.nonlinear_stability) == ((0,), (0, 0, 0), "stable")


def test_definite_combination_finds_a_narrow_cone():
    """diag(1.001, -1) - y diag(1, -1) is definite for 1 < y < 1.001 only; no multiple of diag(1, -1.001) is."""
    matrices = [np.diag([1.001, -1.0]), np.diag([1.0, -1.0])]
    found = definite_combination(matrices)
    assert found is not None
    assert np.all(np.linalg.eigvalsh(found[0] * matrices[0] + found[1] * matrices[1]) > 0)
    assert definite_combination([np.diag([1.0, -1.001]), np.diag([2.0, -2.002])]) is None


@pytest.mark.thorough
def test_diagram_shows_the_curves_of_double_roots(monkeypatch):
    monkeypatch.setenv("MPLBACKEND", "Agg")
    ax = sleeping_diagram((0, 2), spin=5)
    for line, u in zip(ax.lines, (0, 0, 2, 2), strict=True):
        for p, q in line.get_xydata()[::500]:
            terms = np.array([18 * p * q * u, -4 * p**3 * u, p**2 * q**2, -4 * q**3, -27 * u**2])
            assert abs(terms.sum()) < 1e-9 * np.abs(terms).max()
    for options in ({"twists": ()}, {"twists": 1}, {"spin": "a"}, {"field": -1}):
        with pytest.raises(ParameterError, match="at least one twist"):
            sleeping_diagram(**options)


def test_twisted_discriminant_is_that_of_q():
    top = lp.Top.twisted_lagrange()
    sleeping = sleeping_top(top, l3=Fraction(7, 3), alpha3=Fraction(1, 5), beta3=Fraction(-2, 7))
    x = sympy.symbols("x")
    q = sum(
        sympy.Rational(c.numerator, c.denominator) * x**k
        for k, c in zip((3, 2, 1, 0), sleeping.polynomial, strict=True)
    )
    assert sympy.discriminant(q, x) == sympy.Rational(
        sleeping.discriminant.numerator, sleeping.discriminant.denominator
    )


def test_a_dependent_integral_gets_no_multiplier():
    """At relative equilibria the vector fields of l3 and P are parallel: the motion is described by the first one."""
    top = lp.Top.twisted_lagrange()
    x = lp.phase_space.equilibrium_near(top, [0.9, 0.2, 0.4, 0.7, 0.1, 1.2, 0.8, 0.3, 0.6], along=("l3",)).state
    alone, both = (
        lp.phase_space.equilibrium(top, x, along=("l3",)),
        lp.phase_space.equilibrium(top, x, along=("l3", "P")),
    )
    assert both.omega == {"l3": pytest.approx(alone.omega["l3"]), "P": 0}
    np.testing.assert_allclose(both.frequencies, alone.frequencies, rtol=1e-6)
