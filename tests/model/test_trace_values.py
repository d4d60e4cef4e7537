"""Gradients and second derivatives of traces, against differences, and traces along orbits."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.model.trace_values import TraceSum

BRACKETS = {
    "twisted": lp.so(3) @ lp.leibniz(3, "1/3"),
    "su3": lp.su(3) @ lp.trivial(),
    "sine3": lp.algebras.sine(3) @ lp.trivial(),
    "su3-passive": lp.su(3) @ lp.semidirect(3),
    "gl2": lp.algebras.gl(2) @ lp.leibniz(2),
    "so22": lp.so(2, 2) @ lp.trivial(),
    "sum": (lp.su(3) + lp.sl(2)) @ lp.leibniz(2),
}


def functions_of(bracket):
    system = lp.System(bracket, sum(x**2 for x in bracket.variables))
    return [system.functions.of(generator) for generator in bracket.trace_casimirs.generators]


def differences(f, x, step=1e-5):
    shifts = step * np.eye(len(x))
    return np.moveaxis((f(x + shifts) - f(x - shifts)) / (2 * step), 0, -1)


@pytest.mark.parametrize("name", BRACKETS)
def test_derivatives_are_the_limits_of_differences(name):
    bracket = BRACKETS[name]
    x = np.random.default_rng(1).standard_normal(bracket.dimension) / 2
    for f in functions_of(bracket):
        gradient, hessian = f.gradient(x), f.hessian(x)
        np.testing.assert_allclose(gradient, differences(f, x), atol=1e-9 * np.abs(gradient).max())
        np.testing.assert_allclose(hessian, differences(f.gradient, x), atol=1e-9 * max(1, np.abs(hessian).max()))


@pytest.mark.parametrize("name", BRACKETS)
def test_the_bracket_annihilates_the_gradients(name):
    bracket = BRACKETS[name]
    x = np.random.default_rng(2).standard_normal((5, bracket.dimension))
    system = lp.System(bracket, sum(x**2 for x in bracket.variables))
    J = system.functions.poisson_tensor(x)
    for f in functions_of(bracket):
        flow = np.einsum("...ij,...j->...i", J, f.gradient(x))
        assert np.abs(flow).max() < 1e-13 * np.abs(J).max() * np.abs(f.gradient(x)).max()


def test_many_states_have_the_values_of_each():
    bracket = BRACKETS["su3-passive"]
    x = np.random.default_rng(3).standard_normal((2, 3, bracket.dimension))
    for f in functions_of(bracket):
        assert (f(x).shape, f.gradient(x).shape, f.hessian(x).shape) == ((2, 3), (2, 3, 24), (2, 3, 24, 24))
        np.testing.assert_allclose(f.hessian(x)[1, 2], f.hessian(x[1, 2]), atol=1e-12)


def test_sums_of_traces_and_other_functions():
    bracket = BRACKETS["gl2"]
    system = lp.System(bracket, sum(x**2 for x in bracket.variables))
    x0, x1 = bracket.variables[:2]
    trace = bracket.trace_casimirs.generators[-1]
    x = np.random.default_rng(4).standard_normal((3, 8))
    f = system.functions.of(3 * trace / 2 + x0**2 * x1)
    g, rest = system.functions.of(trace), system.functions.of(x0**2 * x1)
    np.testing.assert_allclose(f(x), 1.5 * g(x) + rest(x))
    np.testing.assert_allclose(f.gradient(x), 1.5 * g.gradient(x) + rest.gradient(x))
    np.testing.assert_allclose(f.hessian(x), 1.5 * g.hessian(x) + rest.hessian(x))


def test_other_functions_of_traces_are_compiled():
    bracket = BRACKETS["gl2"]
    system = lp.System(bracket, sum(x**2 for x in bracket.variables))
    trace = bracket.trace_casimirs.generators[-1]
    assert TraceSum.of(trace**2, bracket.variables) is None
    x = np.random.default_rng(5).standard_normal((3, 8))
    f, g = system.functions.of(trace**2), system.functions.of(trace)
    np.testing.assert_allclose(f(x), g(x) ** 2)
    np.testing.assert_allclose(f.gradient(x), 2 * g(x)[:, None] * g.gradient(x))


@pytest.mark.thorough
def test_all_traces_are_kept_along_an_orbit_of_the_fluid():
    """tr W^k, k = 2, ..., 7, in 48 variables, to round-off."""
    fluid = lp.catalog.zeitlin(7)
    orbit = lp.integrate(fluid, np.random.default_rng(6).standard_normal(48) / 3, times=np.linspace(0, 10, 21))
    values = fluid.invariant_values(orbit.state)
    assert list(values) == ["H", "C1", "C2", "C3", "C4", "C5", "C6"]
    for name, value in values.items():
        assert np.ptp(value) < 1e-12 * np.abs(value).max(), name
