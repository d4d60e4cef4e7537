import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import ParameterError

TOP = lp.Top.kovalevskaya()
STARTS = lp.sample_states(TOP, 3, seed=1)


def test_invariants_along_an_orbit_are_those_of_its_system():
    orbit = lp.integrate(TOP, STARTS, t_end=10)
    assert list(orbit.invariants) == list(TOP.invariants)
    assert {values.shape for values in orbit.invariants.values()} == {(3, 1001)}
    np.testing.assert_array_equal(orbit.invariants["H"], TOP.invariant_values(orbit.state)["H"])
    with pytest.raises(ValueError, match="read-only"):
        orbit.invariants["H"][0, 0] = 1


def test_drift_is_the_largest_change_since_the_start():
    orbit = lp.integrate(TOP, STARTS, times=np.arange(0, 21), method=lp.methods.RungeKutta(step=1.0))
    assert list(orbit.drift) == list(TOP.invariants)
    for name, values in TOP.invariant_values(orbit.state).items():
        np.testing.assert_array_equal(orbit.drift[name], np.abs(values - values[:, :1]).max(axis=1))
    assert (orbit.drift["H"] > 1e-12).all()  # a method of order 8 at a long step
    assert all((change < 1e-12).all() for change in lp.integrate(TOP, STARTS, t_end=10).drift.values())


def test_times_that_were_not_reached_count_for_nothing():
    starts = np.array([STARTS[0], np.full(9, np.nan)])
    orbit = lp.integrate(TOP, starts, t_end=5)
    assert orbit.drift["H"][0] < 1e-12
    assert np.isnan(orbit.drift["H"][1])
    short = lp.integrate(TOP, STARTS[0], t_end=50, method=lp.Taylor(max_steps=20))
    assert short.outcome[0] == "max steps"
    assert short.drift["H"][0] < 1e-12


SPIN = lp.so(3) @ lp.trivial()


def test_an_orbit_ends_where_its_hamiltonian_stops_being_real():
    """A step of this method leads over the pole of dp/dt = -1/q; the rates are real beyond it, and H is not."""
    system = lp.systems.CanonicalSystem(["q"], ["p"], "p + log(q)")
    times = np.linspace(0, -3, 7)
    orbit = lp.integrate(system, [[1, 0], [9, 0]], times=times, tangents=np.eye(2), method=lp.RungeKutta(step=0.4))
    assert orbit.outcome.tolist() == ["not finite", "finished"]
    assert orbit.end_time.tolist() == [-0.5, -3]
    assert orbit.end_state[0, 0] == pytest.approx(0.5)
    assert np.isnan(orbit.state[0, 2:]).all()
    assert np.isnan(orbit.tangent[0, 2:]).all()
    assert np.isfinite(orbit.state[0, :2]).all()
    assert np.isfinite(orbit.state[1]).all()
    assert np.isfinite(orbit.drift["H"]).all()


WITHOUT = "log(-l1^2 - 1)"


@pytest.mark.parametrize(
    ("hamiltonian", "start"),
    [(WITHOUT, [1, 2, 3]), ("log(sin(5*l1))", [-0.2, 0, 1]), ("l1^2 + asin(dot(l, l))", [1, 2, 3])],
)
def test_a_start_at_which_the_hamiltonian_is_no_real_number_is_refused(hamiltonian, start):
    system = lp.System(SPIN, hamiltonian)
    with pytest.raises(ParameterError, match=r"starts: wanted states .* real numbers; H is none at \{'l1': .*roots"):
        lp.integrate(system, start, t_end=1)


@pytest.mark.parametrize(
    "run",
    [
        lambda system, start: lp.section(system, start, surface="l2", t_end=1),
        lambda system, start: lp.lyapunov_exponent(system, start, t_end=1),
        lambda system, start: lp.lyapunov_spectrum(system, start, t_end=1),
        lambda system, start: lp.finite_time_exponents(system, start, t_end=1),
        lambda system, start: lp.chaos.megno(system, start, t_end=1),
        lambda system, start: lp.chaos.frequency_drift(system, start, observable="l1", t_end=1),
    ],
)
def test_every_run_asks_for_it(run):
    with pytest.raises(ParameterError, match="H is none at"):
        run(lp.System(SPIN, WITHOUT), [1, 2, 3])


def test_a_given_integral_that_is_no_real_number_is_named():
    system = lp.System(SPIN, "l1^2/2", integrals={"K": "log(l1)"})
    with pytest.raises(ParameterError, match=r"K is none at \{'l1': -1.0, 'l2': 0.0, 'l3': 2.0\} \(trajectory 1\)"):
        lp.integrate(system, [[1, 0, 2], [-1, 0, 2]], t_end=1)
