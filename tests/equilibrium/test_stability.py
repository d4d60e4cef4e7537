"""Stability of given states; the sleeping top against direct eigenvalues and against its polynomial, exactly."""

from fractions import Fraction

import numpy as np
import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st

import liepoisson as lp
from liepoisson.equilibrium.linearisation import LinearFlow, definite_combination
from liepoisson.equilibrium.sleeping import sleeping_top
from liepoisson.errors import ParameterError
from liepoisson.plot.equilibria import sleeping_diagram

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
    turned = sympy.expand((block - t * sympy.eye(6)).det())
    q = mu**3 + l3 * mu**2 + I1 * (a3 * alpha3 + b3 * beta3) * mu + eps * a3**2 * I1**2 * beta3
    one = (sympy.I * q.subs(mu, I1 * (sympy.I * t - l3 / I3)) / I1**3).expand()
    other = one.subs(sympy.I, -sympy.I)
    assert sympy.simplify(turned - sympy.expand(one * other)) == 0


@pytest.mark.thorough
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


@pytest.mark.parametrize("spin", ["1.99", "2.01"])
def test_ordinary_sleeping_top_is_stable_above_the_critical_spin(spin):
    """l3^2 > 4 I1 a3 alpha3, here 4."""
    sleeping = sleeping_top(lp.Top.lagrange(), l3=spin, alpha3=1)
    assert sleeping.discriminant == Fraction(spin) ** 2 - 4
    assert sleeping.linear_stability == ("stable spectrum" if spin > "2" else "unstable")
    found = sleeping.analysis(along=())
    assert found.linear_stability == sleeping.linear_stability
    assert found.growth_rate == pytest.approx(sleeping.growth_rate, abs=1e-12)


def test_critical_spin_itself_is_degenerate_exactly():
    sleeping = sleeping_top(lp.Top.lagrange(), l3=2, alpha3=1)
    assert sleeping.discriminant == 0
    assert sleeping.linear_stability == "degenerate"
    assert sleeping.analysis(along=()).linear_stability == "undecided"


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


def sleeping_tops_with_roots(n):
    """Charged and twisted sleeping tops whose Q has given real roots, 0.2 apart at least; their signs."""
    rng = np.random.default_rng(8)
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
    for sleeping, both_signs in sleeping_tops_with_roots(16):
        seen.add(both_signs)
        assert sleeping.linear_stability == "stable spectrum"
        alone, with_all = sleeping.analysis(along=("l3",)), sleeping.analysis()
        assert alone.linear_stability == with_all.linear_stability == "stable spectrum"
        assert alone.nonlinear_stability == ("stable" if both_signs else "no conclusion")
        assert with_all.nonlinear_stability == "stable"
    assert seen == {True, False}


@pytest.mark.parametrize("spin", ["-4", "0", "3.5"])
def test_unstable_twisted_sleeping_top_has_no_definite_combination(spin):
    sleeping = sleeping_top(lp.Top.twisted_lagrange(), l3=spin, alpha3=4, beta3=1)
    found = sleeping.analysis()
    assert sleeping.linear_stability == found.linear_stability == "unstable"
    assert found.growth_rate == pytest.approx(sleeping.growth_rate, rel=1e-12)
    assert found.nonlinear_stability == "no conclusion"


def test_energy_casimir_alone_does_not_see_gyroscopic_stability():
    sleeping = sleeping_top(lp.Top.lagrange(), l3=3, alpha3=1)
    alone, with_spin = sleeping.analysis(along=()), sleeping.analysis(along=("l3",))
    assert (alone.linear_stability, alone.nonlinear_stability) == ("stable spectrum", "no conclusion")
    assert alone.signature == (2, 2, 0)
    assert with_spin.nonlinear_stability == "stable"
    assert with_spin.signature == (4, 0, 0)
    assert with_spin.combination["H"] != 0


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


@pytest.mark.thorough
def test_symmetry_is_divided_out():
    """The tilted states of the twisted Lagrange top form circles: undecided alone, stable modulo l3."""
    top = lp.catalog.system("twisted-lagrange")
    leaf = lp.Leaf.through(top, lp.sample_states(top, 1, seed=1)[0])
    lowest = lp.equilibria(top, leaf, n_starts=40)[0]
    assert lowest.nonlinear_stability == "undecided"
    modulo = lp.phase_space.equilibrium(top, lowest.state, along=("l3",))
    assert modulo.signature == (4, 0, 0)
    assert len(modulo.spectrum) == 4


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


def test_what_is_no_equilibrium_is_refused():
    top = lp.Top.lagrange()
    with pytest.raises(ParameterError, match=r"\|x'\| = 1 there\. equilibrium_near"):
        lp.phase_space.equilibrium(top, [0, 0, 0, 1, 0, 0, 0, 0, 0])
    with pytest.raises(ParameterError, match="of which 1 is not a motion"):
        lp.phase_space.equilibrium(top, [0, 0, 0, 1, 0, 0, 0, 0, 0], along=("l3",))


@pytest.mark.parametrize("tol", [np.inf, np.nan, -1, "a", None])
def test_a_tolerance_is_a_finite_number(tol):
    with pytest.raises(ParameterError, match="tol: wanted a finite number"):
        lp.phase_space.equilibrium(lp.Top.lagrange(), [0, 0, 1, 0, 0, 1, 0, 0, 0], tol=tol)


@pytest.mark.parametrize("system", [None, 3, "kovalevskaya", lp.Top])
def test_a_system_is_wanted(system):
    for function in (lp.phase_space.equilibrium, lp.phase_space.equilibrium_near, lp.equilibria):
        with pytest.raises(ParameterError, match="wanted a system"):
            function(system, np.zeros(9))


def test_integrals_without_a_motion_of_their_own_are_refused():
    """A Casimir moves nothing, and relative to H, or to 2 H - C1, every state is at rest."""
    top, x = lp.Top.twisted_lagrange(), np.zeros(9)
    for name in ("C1", "C3", "dot(beta, beta)"):
        with pytest.raises(ParameterError, match="is a Casimir"):
            lp.phase_space.equilibrium(top, x, along=(name,))
    energy = "(dot(l, l) + l3^2)/2 + alpha3"
    assert lp.Top.twisted_lagrange().expression(energy) == top.hamiltonian
    for name in ("H", energy, f"-3*({energy}) + alpha1*beta1 + alpha2*beta2 + alpha3*beta3"):
        with pytest.raises(ParameterError, match="is the motion itself"):
            lp.phase_space.equilibrium(top, x, along=(name,))


@pytest.mark.parametrize("along", [None, 3, [1], {"l3"}])
def test_along_is_a_sequence_of_texts(along):
    with pytest.raises(ParameterError, match="along must be a sequence of integrals"):
        lp.phase_space.equilibrium(lp.Top.twisted_lagrange(), np.zeros(9), along=along)


def test_an_integral_at_a_leaf_of_one_state():
    for e in (lp.phase_space.equilibrium, lp.phase_space.equilibrium_near):
        found = e(lp.Top.twisted_lagrange(), np.zeros(9), along=("l3",))
        assert (found.spectrum.shape, found.signature, found.nonlinear_stability) == ((0,), (0, 0, 0), "stable")


def test_refusals_of_the_sleeping_top():
    with pytest.raises(ParameterError, match="I1 = I2"):
        sleeping_top(lp.Top.kovalevskaya(), l3=1, alpha3=1)
    with pytest.raises(ParameterError, match="nine variables"):
        sleeping_top(lp.catalog.system("manakov-so4"), l3=1, alpha3=1)
    with pytest.raises(ParameterError, match="must not be zero"):
        sleeping_top(lp.Top.lagrange(), l3=1, alpha3=0)


def test_definite_combination_finds_a_narrow_cone():
    """diag(1.001, -1) - y diag(1, -1) is definite for 1 < y < 1.001 only; no multiple of diag(1, -1.001) is."""
    matrices = [np.diag([1.001, -1.0]), np.diag([1.0, -1.0])]
    found = definite_combination(matrices)
    assert found is not None
    assert np.all(np.linalg.eigvalsh(found[0] * matrices[0] + found[1] * matrices[1]) > 0)
    assert definite_combination([np.diag([1.0, -1.001]), np.diag([2.0, -2.002])]) is None


def test_defective_zeros_are_removed_before_the_spectrum():
    """A free particle (double zero, one Jordan block) and an oscillator of frequency 2."""
    hessian, form = np.diag([0.0, 1.0, 2.0, 2.0]), np.kron(np.eye(2), [[0.0, -1.0], [1.0, 0.0]])
    flow = LinearFlow(hessian, form)
    assert flow.kernel().shape == (4, 1)
    values, bounds = flow.without_zeros().eigenvalues()
    np.testing.assert_allclose(np.sort(values.imag), [-2, 2], rtol=1e-14)
    assert np.all(values.real == 0)
    assert np.all(bounds == 0)


@pytest.mark.thorough
def test_diagram_shows_the_curves_of_double_roots(monkeypatch):
    monkeypatch.setenv("MPLBACKEND", "Agg")
    ax = sleeping_diagram((0, 2), spin=5)
    assert ax.get_xlim() == (-5, 5)
    assert len(ax.lines) == 4
    for line, u in zip(ax.lines, (0, 0, 2, 2), strict=True):
        for p, q in line.get_xydata()[::500]:
            terms = np.array([18 * p * q * u, -4 * p**3 * u, p**2 * q**2, -4 * q**3, -27 * u**2])
            assert abs(terms.sum()) < 1e-9 * np.abs(terms).max()
    with pytest.raises(ParameterError, match="at least one twist"):
        sleeping_diagram(())


@pytest.mark.thorough
@pytest.mark.parametrize("twists", [(0, 1), (0,), (2,), (1, -1), (0, 0.3, 5)])
def test_the_words_of_the_diagram_are_on_their_sides(monkeypatch, twists):
    monkeypatch.setenv("MPLBACKEND", "Agg")
    words = {text.get_text().split("\n")[0]: text for text in sleeping_diagram(twists).texts}
    assert set(words) == {"stable spectrum", "unstable"}
    for word, text in words.items():
        p, q = 12 * np.array(text.get_position()) - 6  # from parts of the axes
        roots = np.roots([1, p, q, twists[-1]])
        assert (np.abs(roots.imag).max() < 1e-9) == (word == "stable spectrum")
        assert text.get_text().endswith(f"for $u = {twists[-1]:g}$")


@pytest.mark.parametrize("options", [{"twists": "a"}, {"twists": 1}, {"spin": "a"}, {"field": -1}, {"twists": [None]}])
def test_diagrams_of_nothing_are_refused(options):
    with pytest.raises(ParameterError, match="at least one twist and positive ranges"):
        sleeping_diagram(**options)


@pytest.mark.parametrize("size", [5e-324, 1e-200])
def test_states_too_near_zero_are_refused(size):
    """The tensor J(x) is of the order of x, and its inverse of 1/x."""
    top = lp.Top.twisted_kovalevskaya()
    for function in (lp.phase_space.equilibrium, lp.phase_space.equilibrium_near):
        with pytest.raises(ParameterError, match=f"component of at least 1e-100.*{size:.3g}"):
            function(top, np.full(9, size))
    assert lp.phase_space.equilibrium(top, np.zeros(9)).leaf.rank == 0


@pytest.mark.parametrize("scale", [1e-8, 1.0, 1e8])
@pytest.mark.parametrize("hamiltonian", ["dot(l, l)/2", "dot(l, l)^2 - 3/7*dot(l, l)"])
def test_where_h_is_constant_on_the_leaf_nothing_grows_and_every_state_is_an_equilibrium(scale, hamiltonian):
    """The two terms of the linearised flow cancel; their round-off is no second variation."""
    body = lp.System(lp.so(3) @ lp.trivial(), hamiltonian)
    rng = np.random.default_rng(0)
    for x in scale * rng.normal(size=(20, 3)):
        e = lp.phase_space.equilibrium(body, x)
        assert (e.signature, e.linear_stability, e.growth_rate) == ((0, 0, 2), "degenerate", 0.0)


def test_a_pendulum_without_a_position_is_a_body_with_equal_moments():
    pendulum = lp.catalog.system("spherical-pendulum")
    leaf = lp.Leaf.through(pendulum, [0.4, 1.1, -0.3, 0, 0, 0])
    for l in np.random.default_rng(1).normal(size=(20, 3)):
        x = np.append(l * np.linalg.norm(leaf.state) / np.linalg.norm(l), [0, 0, 0])
        assert lp.phase_space.equilibrium(pendulum, x).signature == (0, 0, 2)


def test_sleeping_top_without_weight_and_with_equal_moments():
    """H = l.l/4 there, so the known integral l.l has the motion itself, and is left out by default."""
    top = lp.Top(inertia=(2, 2, 2), a=(0, 0, 0), epsilon="-3/2")
    sleeping = lp.phase_space.sleeping_top(top, l3=3, alpha3=-2, beta3="-5/2")
    assert sleeping.analysis().growth_rate == sleeping.growth_rate == 0


@pytest.mark.parametrize("w", [1.0, 1e6, 1e14, 1e16])
def test_a_saddle_is_unstable_however_fast_its_other_frequencies_are(w):
    """H = (p1^2 + p2^2 - q1^2 + w^2 q2^2)/2 has the eigenvalues 1, -1, iw and -iw."""
    system = lp.System(lp.canonical(2), "(p1^2 + p2^2 - q1^2 + w^2*q2^2)/2", {"w": w})
    found = lp.phase_space.equilibrium(system, [0.0, 0.0, 0.0, 0.0])
    assert found.linear_stability == "unstable"
    assert found.growth_rate == pytest.approx(1.0, rel=1e-6)
    assert found.signature == (3, 1, 0)


@pytest.mark.parametrize("scale", [1.0, 1e-4])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_soft_equilibrium_beside_another_is_itself(sign, scale):
    r"""$V = \pm sq^2 + q^8$ and $V = \pm(q^2 - 1/4)^9$ about q = 0 or 3/2: V'' is twice s, and 18/4^8."""
    line = lp.canonical(names=("q",), momenta=("p",))
    for centre in (0.0, 1.5):
        for potential, curvature in (
            (f"{sign * scale!r}*(q - {centre})^2 + (q - {centre})^8", 2 * sign * scale),
            (f"{sign}*((q - {centre})^2 - 1/4)^9", sign * 18 / 4**8),
        ):
            found = lp.phase_space.equilibrium(lp.System(line, f"p^2/2 + {potential}"), [centre, 0.0])
            assert found.linear_stability == ("stable spectrum" if sign > 0 else "unstable")
            assert found.signature == ((2, 0, 0) if sign > 0 else (1, 1, 0))
            rates = found.frequencies[0] if sign > 0 else found.growth_rate
            assert rates == pytest.approx(abs(curvature) ** 0.5, rel=1e-6)
