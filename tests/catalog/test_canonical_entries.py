"""The canonical systems of the catalog against known facts."""

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp

import liepoisson as lp
from liepoisson import catalog


@pytest.mark.thorough
def test_henon_heiles_has_its_four_equilibria():
    """The centre, and three saddles at the energy of escape, 1/6, in the corners of a triangle [henonheiles1964]."""
    system = catalog.system("henon-heiles")
    found = lp.equilibria(system, lp.Leaf(system, {}))
    assert [e.energy for e in found] == pytest.approx([0, 1 / 6, 1 / 6, 1 / 6], abs=1e-12)
    corners = sorted(e.state.tolist() for e in found[1:])
    half = np.sqrt(3) / 2
    np.testing.assert_allclose(corners, [[-half, -0.5, 0, 0], [0, 1, 0, 0], [half, -0.5, 0, 0]], atol=1e-10)
    assert found[0].frequencies == pytest.approx([1, 1])
    assert [e.linear_stability for e in found] == ["stable spectrum", "unstable", "unstable", "unstable"]
    # one unstable direction each: (q1'' = q1, q2'' = -3 q2) at (0, 1)
    assert [e.growth_rate for e in found[1:]] == pytest.approx([1, 1, 1])
    assert [e.frequencies for e in found[1:]] == [pytest.approx([np.sqrt(3)])] * 3


@pytest.mark.thorough
@pytest.mark.parametrize(("n", "closed"), [(3, True), (4, True), (2, False), (3, False), (4, False)])
def test_the_integrals_of_the_toda_lattice_are_in_involution(n, closed):
    """P, H, T3, ..., Tn: n independent functions that commute, in exact arithmetic."""
    lattice = catalog.toda(n, closed=closed)
    functions = [lattice.hamiltonian, *lattice.integrals.values()]
    assert len(functions) == n
    for k, f in enumerate(functions):
        for g in functions[:k]:
            assert sp.expand(lattice.bracket(f, g)) == 0, (f, g)
    point = {x: k**2 % 7 for k, x in enumerate(lattice.variables, start=1)}
    gradients = sp.Matrix([[f.diff(x).subs(point) for x in lattice.variables] for f in functions]).evalf(30)
    assert min(float(s) for s in np.linalg.svd(np.array(gradients, dtype=float), compute_uv=False)) > 1e-3


@pytest.mark.parametrize(
    ("parameters", "name"),
    [((2, 2, -1), "sawada-kotera"), ((1, "3/2", -6), "kdv"), (("2/3", "32/3", -16), "kaup-kupershmidt")],
)
def test_the_integrable_cases_of_henon_heiles(parameters, name):
    system = catalog.henon_heiles(*parameters)
    assert system.is_constant(system.integrals["K"])
    assert set(catalog.system(f"henon-heiles-{name}").integrals) == {"K"}
    other = catalog.henon_heiles(*parameters[:2], 1)
    assert not other.integrals
    assert not other.is_constant(system.integrals["K"])


@pytest.mark.parametrize(("V", "pump", "signal"), [(1, 1.0, 0.5), (2, 1.5, 0.1)])
def test_a_pump_wave_gives_its_energy_away_and_takes_it_back_in_the_period_of_the_sine_amplitude(V, pump, signal):
    r"""With a1 = a, a2 = b, a3 = i c real at first they stay so: a' = V b c, b' = V a c, c' = -V a b.

    By the integrals of Manley and Rowe $c'^2 = V^2 (A^2 - c^2)(A^2 + B^2 - c^2)$ for a = 0, b = B, c = A at first, so
    $c = A\,\mathrm{cd}(\Omega t | m)$ with $\Omega = V\sqrt{A^2 + B^2}$, $m = A^2/(A^2 + B^2)$.
    """
    from scipy.special import ellipj, ellipk

    system = catalog.entry("three-wave").system() if V == 1 else replace_parameters(catalog.entry("three-wave"), V=V)
    rate, m = V * np.hypot(pump, signal), pump**2 / (pump**2 + signal**2)
    times = np.linspace(0, 4 * ellipk(m) / rate, 41)
    orbit = lp.integrate(system, {"q2": signal, "p3": pump}, times=times)
    _, cn, dn, _ = ellipj(rate * times, m)
    names = orbit.components
    np.testing.assert_allclose(orbit.state[0, :, names.index("p3")], pump * cn / dn, atol=1e-12)
    np.testing.assert_allclose(orbit.state[0, -1], orbit.state[0, 0], atol=1e-12)
    assert all(change.max() < 1e-14 for change in orbit.drift.values())


def replace_parameters(entry, **values):
    return replace(entry, parameters=dict(entry.parameters) | values).system()


def starts_of(name):
    """In the chaotic sea of Hénon and Heiles at H = 1/8; the double pendulum held out."""
    k = np.arange(64)
    if name == "double-pendulum":
        return np.stack([2 + 0 * k, 2 + 1e-6 * k, 0 * k, 0 * k], axis=-1)
    y = -0.25 + 1e-5 * k
    return np.stack([0 * y, y, np.sqrt(2 * (0.125 - y**2 / 2 + y**3 / 3)), 0 * y], axis=-1)


@pytest.mark.thorough
@pytest.mark.parametrize(("name", "begin", "end"), [("henon-heiles", 500.0, 2500.0), ("double-pendulum", 50.0, 450.0)])
def test_exponents_are_those_of_another_integrator(name, begin, end):
    """What 64 orbits of DOP853 with own variational equations gave."""
    reference = next(r for r in catalog.entry(name).references if r.quantity == "lyapunov")
    growth = lp.finite_time_exponents(catalog.system(name), starts_of(name), times=[begin, end])
    rate = (growth.exponent[:, 1] * end - growth.exponent[:, 0] * begin) / (end - begin)
    own = rate.std(ddof=1) / np.sqrt(len(rate))
    assert abs(rate.mean() - float(reference.value)) < 3 * np.hypot(own, float(reference.tolerance))


@pytest.mark.slow
def test_the_exponent_of_the_twisted_kovalevskaya_top_is_the_printed_one():
    reference = next(r for r in catalog.entry("twisted-kovalevskaya").references if r.quantity == "lyapunov")
    top = catalog.system("twisted-kovalevskaya")
    starts = lp.sample_states(top, 2000, seed=1, ensemble="unit-vectors")
    growth = lp.finite_time_exponents(top, starts, times=np.arange(5.0, 201.0, 5.0), seed=2)
    fit = lp.fits.finite_time_fit(growth.time, growth.exponent, window=(20.0, 200.0), n_bootstrap=50)
    assert fit.estimates["lambda"].standard_error < 0.003
    assert fit.estimates["lambda"].value == pytest.approx(float(reference.value), abs=float(reference.tolerance))
