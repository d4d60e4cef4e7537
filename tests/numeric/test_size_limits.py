r"""The size that tolerances are relative to: without time and its momentum, with angles within a turn."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.compile.field import QuadraticField, TapeField, with_size_limits
from liepoisson.errors import ParameterError


class Plain:
    """A system that is a field alone."""

    name = "plain"

    def __init__(self, field):
        self.field = lambda: field


METHODS = [lp.Taylor(), lp.RungeKutta(tol=1e-12), lp.Gauss(step=0.01)]


@pytest.mark.parametrize("method", METHODS, ids=["taylor", "runge-kutta", "gauss"])
@pytest.mark.parametrize("unit", [1, 1e-8, 1e8])
def test_a_forced_oscillator_is_as_exact_in_any_unit_of_time(method, unit):
    r"""$x'' + x = \cos(\tau/2)$ in $\tau = s t$: $x = A\cos\tau + B\sin\tau + \frac43\cos(\tau/2)$."""
    system = lp.System(
        lp.canonical(names=["x"]), "s*(p_x^2/2 + x^2/2 - x*cos(s*t/2))", {"s": unit}, period=f"4*pi/{unit!r}"
    )
    if isinstance(method, lp.Gauss):
        method = lp.Gauss(step=method.step / unit)
    run = lp.integrate(system, {"x": 0.3, "p_x": 0.1}, times=[0, 30 / unit], method=method)
    exact = (0.3 - 4 / 3) * np.cos(30) + 0.1 * np.sin(30) + 4 / 3 * np.cos(15)
    error = {lp.Taylor: 1e-14, lp.RungeKutta: 1e-11, lp.Gauss: 1e-9}[type(method)]
    assert run.outcome[0] == "finished"
    assert abs(run.end_state[0, 0] - exact) < error


def test_a_drive_whose_momentum_overflows_shortens_steps():
    """The momentum of time grows like s^2: its series overflows where that of the state does not."""
    system = lp.System(lp.canonical(names=["x"]), "s*(p_x^2/2 - x*cos(s*t))", {"s": 1e16}, period="2*pi/1e16")
    run = lp.integrate(system, {"x": 1, "p_x": 0}, times=[0, 1e-15])
    assert run.outcome[0] == "finished"
    assert run.end_state[0, 0] == pytest.approx(2 - np.cos(10), abs=1e-13)  # x'' = cos(tau)


def shaken(f):
    """A pendulum whose support is shaken, f of its weight."""
    angle = lp.canonical(names=["x"], angles=["x"])
    return lp.System(angle, "p_x^2/2 - cos(x) + f*cos(x)*cos(w*t)", {"f": f, "w": 30}, period="2*pi/w")


@pytest.mark.parametrize("method", [lp.Taylor(), lp.RungeKutta(tol=1e-12)])
@pytest.mark.parametrize("f", [1e-9, 1, 1e3])
def test_the_momentum_of_time_along_a_pendulum_at_rest_is_that_of_the_drive(f, method):
    r"""$p_t' = f w \sin(wt)$, $p_t = f (1 - \cos wt)$, of which $x = 0$ says nothing.

    A step errs by the tolerance of the momentum, and time by its rounding.
    """
    run = lp.integrate(shaken(f), {"x": 0}, times=[0, 1, 100], method=method)
    error = run.n_steps[0] * method.tol + np.sqrt(run.n_steps[0]) * 30 * 100 * 2.0**-53
    assert np.abs(run.state[0, :, -1] - f * (1 - np.cos(30 * run.time))).max() < error * f


@pytest.mark.parametrize("f", ["1/10^9", "3/10", 20])
def test_the_momentum_of_time_is_as_exact_as_the_state(f):
    """H + p_t is kept to round-off, and of a weak drive p_t is known relative to itself."""
    weak = shaken(f)
    run, fine = (lp.integrate(weak, {"p_x": 1.9}, times=[0, 10], method=lp.Taylor(tol=tol)) for tol in (1e-15, 1e-13))
    change = np.abs(run.end_state - fine.end_state)[0]
    assert run.drift["H"].max() < 3e-12
    assert change[-1] < 1e-9 * np.abs(run.end_state[0, -1])


def test_rates_of_the_momentum_that_cancel_shorten_no_steps():
    r"""$p_t' = (|l|^2 - 1) \sin t$ is round-off on the unit sphere."""
    free = "l1^2/2 + l2^2/3 + l3^2/5"
    driven = lp.System(lp.so(3) @ lp.trivial(), f"{free} + (l1^2 + l2^2 + l3^2 - 1)*cos(t)", period="2*pi")
    alone = lp.System(lp.so(3) @ lp.trivial(), free)
    for method, most in ((lp.Taylor(), 2), (lp.RungeKutta(tol=1e-12), 2)):
        runs = [lp.integrate(system, {"l": (0.6, 0, 0.8)}, t_end=100, method=method) for system in (driven, alone)]
        assert (runs[0].outcome[0], runs[0].n_steps[0] < most * runs[1].n_steps[0]) == ("finished", True)
        assert np.abs(runs[0].state[..., -1]).max() < 1e-10


def test_a_pulse_that_is_yet_to_come_ends_no_run():
    """The momentum is below the smallest normal number at first."""
    pulse = lp.System(lp.canonical(names=["x"]), "p_x^2/2 + x^2/2 - x*exp(-(t - 40)^2)")
    for method, error in ((lp.Taylor(), 1e-14), (lp.RungeKutta(tol=1e-12), 1e-11)):
        run = lp.integrate(pulse, {"x": 0.3, "p_x": 0.1}, times=[0, 80], method=method)
        assert run.outcome[0] == "finished"
        assert run.drift["H"].max() < error


def test_a_rotating_angle_loosens_no_tolerance():
    """After 5,000 turns, and from 1,000 turns on."""
    pendulum = lp.System(lp.canonical(names=["q"], angles=["q"]), "p_q^2/2 - cos(q)")
    run = lp.integrate(pendulum, [[0, 3], [2000 * np.pi, 3]], times=[0, 10_000])
    assert run.drift["H"].max() < 2e-10


def test_limits_are_those_of_angles_and_time_and_make_a_tape():
    driven = lp.System(lp.canonical(names=["q", "r"], angles=["r"]), "p_q^2/2 + p_r^2/2 + q*t")
    field = driven.field()
    assert field.size_limits == (None, 2 * np.pi, None, None, 0.0, 0.0)
    assert lp.System(lp.canonical(names=["q"]), "p_q^2/2").field().kind == "quadratic"
    quadratic = QuadraticField(2, ((0, 3.0),), ((0, 1, 2.0), (1, 0, -1.0)), ((1, 0, 1, 5.0), (0, 1, 1, -2.0)))
    tape = with_size_limits(quadratic, (None, 1.0))
    assert isinstance(tape, TapeField)
    runs = [lp.integrate(Plain(f), [0.1, 0.2], t_end=1) for f in (quadratic, tape)]
    assert np.allclose(runs[0].state, runs[1].state, rtol=0, atol=1e-14)
    for wrong in ((1.0,), (0.0, 0.0), (-1.0, None)):
        with pytest.raises(ParameterError, match="size_limits"):
            lp.integrate(Plain(with_size_limits(quadratic, wrong)), [0.1, 0.2], t_end=1)
