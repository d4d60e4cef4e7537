"""The flow in the arithmetic of Arb, against closed solutions and the core."""

import numpy as np
from flint import arb, arb_mat, ctx

import liepoisson as lp
from liepoisson.orbits.precise_flow import PreciseFlow, bits


def test_a_harmonic_oscillator_to_fifty_digits():
    """q = cos t, p = -sin t; the tangent vectors are the solutions themselves."""
    system = lp.System(lp.canonical(1), "dot(p, p)/2 + dot(q, q)/2")
    with ctx.workprec(bits(50)):
        time = arb(7) / 3
        x, V = PreciseFlow(system, 50).end([arb(1), arb(0)], time, arb_mat(2, 2, [1, 0, 0, 1]))
        wanted = [time.cos(), -time.sin(), time.sin(), time.cos()]
        for got, value in zip([*x, V[0, 1], V[1, 1]], wanted, strict=True):
            assert abs(float(got - value)) < 1e-50


def test_tangent_vectors_of_the_twisted_top_are_those_of_the_core():
    top = lp.Top.kovalevskaya(epsilon=1)
    start = np.random.default_rng(2).uniform(-1, 1, 9)
    wanted = lp.integrate(top, start, times=[0, 3], tangents=np.eye(9))
    with ctx.workprec(bits(20)):
        identity = arb_mat(9, 9, [int(i == j) for i in range(9) for j in range(9)])
        x, V = PreciseFlow(top, 20).end([arb(float(v)) for v in start], arb(3), identity)
    np.testing.assert_allclose([float(v) for v in x], wanted.state[0, -1], atol=1e-13)
    got = [[float(V[i, j]) for j in range(9)] for i in range(9)]
    np.testing.assert_allclose(got, wanted.tangent[0, -1].T, atol=1e-12)


def test_irrational_coefficients_have_all_digits():
    """H = sqrt(2) (p^2 + q^2) / 2 turns with the angular velocity sqrt(2)."""
    system = lp.System(lp.canonical(1), "sqrt(2)*(dot(p, p) + dot(q, q))/2")
    with ctx.workprec(bits(40)):
        x, _ = PreciseFlow(system, 40).end([arb(1), arb(0)], arb(1))
        assert abs(float(x[0] - arb(2).sqrt().cos())) < 1e-40
