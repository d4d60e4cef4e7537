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
def test_derivatives_are_limits_of_differences_and_null_vectors(name):
    bracket = BRACKETS[name]
    x = np.random.default_rng(1).standard_normal((2, bracket.dimension)) / 2
    J = lp.System(bracket, sum(x**2 for x in bracket.variables)).functions.poisson_tensor(x)
    for f in functions_of(bracket):
        gradient, hessian = f.gradient(x), f.hessian(x)
        np.testing.assert_allclose(gradient[1], differences(f, x[1]), atol=1e-9 * np.abs(gradient).max())
        second = differences(f.gradient, x[1])
        np.testing.assert_allclose(hessian[1], second, atol=1e-9 * max(1, np.abs(hessian).max()))
        flow = np.einsum("...ij,...j->...i", J, gradient)
        assert np.abs(flow).max() < 1e-13 * np.abs(J).max() * np.abs(gradient).max()


def test_sums_and_functions_of_traces():
    bracket = BRACKETS["gl2"]
    system = lp.System(bracket, sum(x**2 for x in bracket.variables))
    x0, x1 = bracket.variables[:2]
    trace = bracket.trace_casimirs.generators[-1]
    x = np.random.default_rng(4).standard_normal((3, 8))
    g, rest = system.functions.of(trace), system.functions.of(x0**2 * x1)
    f = system.functions.of(3 * trace / 2 + x0**2 * x1)
    for part in ("__call__", "gradient", "hessian"):
        values = [getattr(function, part)(x) for function in (f, g, rest)]
        np.testing.assert_allclose(values[0], 1.5 * values[1] + values[2])
    assert TraceSum.of(trace**2, bracket.variables) is None
    square = system.functions.of(trace**2)
    np.testing.assert_allclose(square.gradient(x), 2 * g(x)[:, None] * g.gradient(x))
