"""The Taylor method where a series leaves the range of numbers, or a root its branch: no orbit finishes wrong."""

import numpy as np
import pytest

import liepoisson as lp

T_END = 6.0


def top_at(rate: float) -> lp.Top:
    """The twisted Kovalevskaya top, `rate` times as fast."""
    return lp.Top(inertia=(2 / rate, 2 / rate, 1 / rate), a=(-rate, 0, 0), epsilon=1)


@pytest.mark.parametrize("method", [lp.Taylor(), lp.Taylor(order=64), lp.Taylor(tol=1e-12, precision="mixed")])
@pytest.mark.parametrize("rate", [1e-40, 1e5, 1e40])
def test_orbits_are_the_same_in_all_units_of_time(rate: float, method: lp.Taylor) -> None:
    starts = lp.sample_states(lp.Top.twisted_kovalevskaya(), 3, seed=3)
    wanted = lp.integrate(lp.Top.twisted_kovalevskaya(), starts, times=[0, T_END]).end_state
    for some in (starts, starts[:1]):
        orbit = lp.integrate(top_at(rate), some, times=[0, T_END / rate], method=method)
        assert set(orbit.outcome) == {"finished"}
        np.testing.assert_allclose(orbit.end_state, wanted[: len(some)], rtol=0, atol=1e-9)


@pytest.mark.parametrize("term", ["sqrt(l1^2)", "acos(cos(3*l1))"])
@pytest.mark.parametrize("tol", [1e-15, 1e-9])
def test_no_orbit_passes_a_corner_on_the_other_branch(term: str, tol: float) -> None:
    system = lp.System(lp.so(3) @ lp.semidirect(2), f"{term} + l2^2/2 + l3^2 + alpha2")
    starts = lp.sample_states(system, 12, seed=1)
    orbit = lp.integrate(system, starts, times=np.linspace(0, 20, 201), method=lp.Taylor(tol=tol))
    energy = system.functions.energy(orbit.state)
    reached = np.isfinite(energy)
    assert np.abs(energy - energy[:, :1])[reached].max() < 1e-6
    ended = orbit.outcome != "finished"
    assert ended.sum() >= 6
    assert set(orbit.outcome[ended]) <= {"step too small", "not finite"}
    assert not np.isfinite(energy[ended, -1]).any()
