"""Inputs that no method can like end with an outcome for each trajectory: no hang, no crash, no poisoned neighbours."""

from __future__ import annotations

import time

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import liepoisson as lp

TOP = lp.Top.twisted_kovalevskaya()
METHODS = [
    lp.Taylor(max_steps=20_000),
    lp.Taylor(tol=1e-8, precision="mixed", max_steps=20_000),
    lp.RungeKutta(tol=1e-8, max_steps=20_000),
    lp.RungeKutta(step=0.1, max_steps=20_000),
    lp.RungeKutta(tol=1e-5, precision="single", max_steps=20_000),
    lp.Splitting(step=0.1, order=6, max_steps=20_000),
    lp.Splitting(step=0.1, precision="single", max_steps=20_000),
    lp.Gauss(step=0.1, max_steps=5_000),
]
OUTCOMES = {"finished", "step too small", "not finite", "max steps", "no convergence", "time limit"}
every_method = pytest.mark.parametrize("method", METHODS, ids=str)


ENDS = {"f": "finished", "s": "max steps", "n": "not finite", "c": "no convergence"}
"""What a letter below stands for, one for each of `METHODS`."""
ACCURACY = [1e-11, 1e-6, 1e-6, 1e-7, 1e-3, 1e-7, 1e-4, 1e-3]
"""Error of each method at t = 1 where it is at home, relative to the largest number: at least five times what was
measured, except for what is round-off."""
IS_SINGLE = [getattr(method, "precision", "double") == "single" for method in METHODS]
IS_SPLITTING = [isinstance(method, lp.Splitting) for method in METHODS]


def check(orbit: lp.results.Orbit) -> None:
    """Every trajectory has an outcome that agrees with its numbers."""
    assert set(orbit.outcome) <= OUTCOMES
    finished = orbit.outcome == "finished"
    assert np.isfinite(orbit.state[finished]).all()
    assert (orbit.end_time[finished] == orbit.time[-1]).all()
    # what failed has no state at the last time, and keeps the last good one
    assert np.isnan(orbit.state[~finished, -1]).all()
    assert (np.abs(orbit.end_time[~finished]) < abs(orbit.time[-1])).all()


def ended(system: lp.System, x0: np.ndarray, method: lp.Taylor, ends: str) -> tuple[lp.results.Orbit, int]:
    """The orbits to t = 1, which end as the letter of the method says, and the position of the method."""
    which = METHODS.index(method)
    orbit = lp.integrate(system, x0, times=[0, 0.5, 1], method=method)
    check(orbit)
    if ends[which] == "m":  # most of them; the others happen to move slowly
        assert set(orbit.outcome) <= {"max steps", "finished"}
        assert (orbit.outcome == "max steps").sum() >= 0.75 * len(x0)
    else:
        assert list(orbit.outcome) == [ENDS[ends[which]]] * len(x0)
    return orbit, which


def drift(values: dict[str, np.ndarray], before: dict[str, np.ndarray], names: list[str]) -> float:
    """Largest change of some invariants, in units of their sizes."""
    return max(float((np.abs(values[n] - before[n]) / np.abs(before[n]).max()).max()) for n in names)


def check_accuracy(system: lp.Top, x0: np.ndarray, orbit: lp.results.Orbit, which: int) -> None:
    """The invariants are kept, and the states are those of SciPy's method."""
    before, after = (system.invariant_values(x) for x in (x0, orbit.state[:, -1]))
    assert drift(after, before, list(before)) < 100 * ACCURACY[which], "invariants are sums of large and small numbers"
    for k in (0, 7):
        size = np.abs(x0[k]).max()
        rates = solve_ivp(
            lambda _, x, unit: system.vector_field(unit * x) / unit,
            (0, 1), x0[k] / size, args=(size,), method="DOP853", rtol=1e-12, atol=1e-13,
        )  # fmt: skip
        wanted = rates.y[:, -1]
        assert np.abs(orbit.state[k, -1] / size - wanted).max() < ACCURACY[which] * np.abs(wanted).max() + 1e-10


HOME, STIFF = "ffffffff", "mmmnmffc"
"""A method of equal steps fails at rates of 10^6, an adaptive one needs too many, splitting turns any way in a step."""


@pytest.mark.filterwarnings("ignore::liepoisson.errors.InertiaWarning")  # no rigid body has these moments
@every_method
@pytest.mark.parametrize(
    ("inertia", "ends"),
    [((1e6, 1.0, 0.5), HOME), ((1e6, 1e6, 1.0), HOME), ((1.0, 1.0, 1e6), HOME), ((1e-6, 1.0, 1.0), STIFF)],
    ids=str,
)
def test_stiff_inertia(method: lp.Taylor, inertia: tuple[float, float, float], ends: str) -> None:
    top = lp.Top(inertia=inertia, a=(1, 0.5, 0), b=(0, 0, 1), epsilon=1)
    x0 = lp.sample_states(top, 20, seed=1)
    orbit, which = ended(top, x0, method, ends)
    if ends == HOME:
        check_accuracy(top, x0, orbit, which)
    elif IS_SPLITTING[which]:
        before, after = (top.invariant_values(x) for x in (x0, orbit.state[:, -1]))
        assert drift(after, before, ["C1", "C2", "C3"]) < (1e-3 if IS_SINGLE[which] else 1e-10)


@every_method
@pytest.mark.parametrize(("epsilon", "ends"), [(0, HOME), (1e-12, HOME), (1e6, "fffnfffc")])
def test_extreme_twist(method: lp.Taylor, epsilon: float, ends: str) -> None:
    top = lp.Top(inertia=(2, 2, 1), a=(-1, 0, 0), b=(0, 0, 0), epsilon=epsilon)
    x0 = lp.sample_states(top, 20, seed=1)
    orbit, which = ended(top, x0, method, ends)
    if ends == HOME:
        check_accuracy(top, x0, orbit, which)
    elif which < 3:
        # numbers of 10^6 that come from numbers of 1: measured 4e-10, 1e-3, 5e-4
        energy = top.functions.energy
        errors = np.abs(energy(orbit.state[:, -1]) / energy(x0) - 1)
        assert errors.max() < [1e-8, 1e-2, 1e-2][which]


@every_method
def test_a_tiny_twist_is_nearly_none(method: lp.Taylor) -> None:
    tops = [lp.Top(inertia=(2, 2, 1), a=(-1, 0, 0), b=(0, 0, 0), epsilon=e) for e in (0, 1e-12)]
    x0 = lp.sample_states(TOP, 8, seed=2)
    ends = [lp.integrate(top, x0, times=[0, 2], method=method).state[:, -1] for top in tops]
    precision = 1e-4 if getattr(method, "precision", "double") == "single" else 1e-9
    assert np.abs(ends[0] - ends[1]).max() < precision


@every_method
@pytest.mark.parametrize(
    ("scale", "ends"),
    [
        (1e-300, "ffffnfnf"),  # single precision ends at 1e-38: such a state is none
        (1e-30, HOME),
        (1e-8, HOME),
        (1e3, "fffnfffc"),
        (1e15, "sssnsffc"),  # 1e15 turns
        (1e150, "nnsnnfnc"),
        (1e300, "nnnnnnnn"),
    ],
)
def test_huge_and_tiny_states(method: lp.Taylor, scale: float, ends: str) -> None:
    x0 = scale * lp.sample_states(TOP, 20, seed=1)
    orbit, which = ended(TOP, x0, method, ends)
    if scale < 1:
        # the flow is that of the linear part: states are proportional
        unit = 1e-8 * lp.sample_states(TOP, 20, seed=1)
        wanted = lp.integrate(TOP, unit, times=[0, 1]).state[:, -1] / 1e-8
        finished = orbit.outcome == "finished"
        np.testing.assert_allclose(
            orbit.state[finished, -1] / scale, wanted[finished], atol=max(ACCURACY[which], 1e-7) * np.abs(wanted).max()
        )
    elif scale == 1e3 and (which < 3 or which == 4):
        energy = TOP.functions.energy
        errors = np.abs(energy(orbit.state[:, -1]) / energy(x0) - 1)
        assert errors.max() < [1e-12, 1e-6, 1e-8, np.nan, 1e-2][which]
    elif scale == 1e3 and IS_SPLITTING[which]:
        before, after = (TOP.invariant_values(x) for x in (x0, orbit.state[:, -1]))
        assert drift(after, before, ["C1", "C2", "C3"]) < (1e-3 if IS_SINGLE[which] else 1e-10)


@every_method
def test_bad_members_do_not_touch_their_neighbours(method: lp.Taylor) -> None:
    x0 = lp.sample_states(TOP, 40, seed=3)
    tangents = np.ones((40, 1, 9))
    good = lp.integrate(TOP, x0, times=[0, 1, 3], tangents=tangents, method=method)
    bad = {2: (0, np.nan), 3: (4, np.inf), 17: (5, 1e300), 30: (8, -np.inf), 39: (1, 1e200)}
    for member, (component, value) in bad.items():
        x0[member, component] = value
    orbit = lp.integrate(TOP, x0, times=[0, 1, 3], tangents=tangents, method=method)
    check(orbit)
    kept = [member for member in range(40) if member not in bad]
    assert (orbit.outcome[kept] == "finished").all()
    assert orbit.state[kept].tobytes() == good.state[kept].tobytes()
    assert orbit.tangent[kept].tobytes() == good.tangent[kept].tobytes()
    assert (orbit.outcome[[2, 3, 30]] == "not finite").all()
    assert (orbit.outcome[[17, 39]] != "finished").all()


@every_method
def test_an_end_time_out_of_reach_ends_with_the_budget_of_steps(method: lp.Taylor) -> None:
    orbit = lp.integrate(TOP, lp.sample_states(TOP, 20, seed=1), times=[0, 1, 1e9], method=method)
    assert (orbit.outcome == "max steps").all()
    assert np.isfinite(orbit.state[:, 1]).all()
    check(orbit)


@pytest.mark.thorough
@every_method
def test_a_limit_of_time_ends_a_run_and_keeps_what_is_done(method: lp.Taylor) -> None:
    patient = type(method)(**{**vars(method), "max_steps": 10**15})
    x0 = lp.sample_states(TOP, 200, seed=1)
    begin = time.perf_counter()
    orbit = lp.integrate(TOP, x0, times=[0, 1, 1e9], method=patient, time_limit=0.4, threads=2)
    # a worker looks at the clock every few milliseconds; the allowance is for a machine with other work
    assert time.perf_counter() - begin < 5.0
    assert (orbit.outcome == "time limit").all()
    started = ~np.isnan(orbit.end_time)
    assert 0 < started.sum() < 200
    assert np.isfinite(orbit.end_state[started]).all()
    assert np.isnan(orbit.end_state[~started]).all()


def test_default_budgets_end_an_endless_exponent(monkeypatch: pytest.MonkeyPatch) -> None:
    """The defaults at work, with the number of steps lowered to what a test can wait for."""
    assert lp.Taylor().max_steps == 10_000_000
    growth = lp.finite_time_exponents(
        TOP, lp.sample_states(TOP, 4, seed=1), t_end=1e9, method=lp.Taylor(tol=1e-13, max_steps=5_000)
    )
    assert (growth.outcome == "max steps").all()
    assert (growth.n_steps == 5_000).all()
    assert np.isnan(growth.exponent[:, -1]).all()
