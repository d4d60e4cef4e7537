"""What runs refuse, and in which words; and what must come out as a plain number."""

import json
from functools import partial

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import ParameterError, ShapeError, UnknownNameError
from liepoisson.indicators.finite_time_fit import Resampling
from liepoisson.methods import LagrangeMap
from liepoisson.orbits import time_scale

TOP, KOVALEVSKAYA = lp.Top.twisted_kovalevskaya(), lp.Top.kovalevskaya()
X0 = [0.1] * 9
MANAKOV = lp.catalog.system("manakov-so4")
SIX = [0.1] * 6


class OnlyAField:
    """A system of which nothing but the field is known."""

    name = "only a field"

    def __init__(self, *names):
        if names:
            self.component_names = names

    def field(self):
        return TOP.field()


def run(system=TOP, x0=X0, **options):
    return lp.integrate(system, x0, **({"times": [0, 1]} | options))


def exponent(**options):
    return lp.finite_time_exponents(TOP, X0, **({"t_end": 1} | options))


def named(**starts):
    return lp.integrate(KOVALEVSKAYA, starts, t_end=1)


dense = partial(run, dense=True)

REFUSED = [
    # numbers
    *((partial(exponent, t_end=bad), ParameterError, r"t_end: wanted a positive finite time; got .{1,80}; give")
      for bad in ("5 s", [1, 2], 10**5000, True, 1j, np.datetime64(1, "s"), object())),
    *((partial(exponent, **{name: bad}), ParameterError, f"{name}: wanted a whole number")
      for name in ("seed", "first") for bad in (None, 1.5, -1, True)),
    (partial(exponent, first=2**63 - 1), ParameterError, "first: wanted"),
    (partial(exponent, seed=2**128), ParameterError, "seed: wanted"),
    *((partial(exponent, threads=bad), ParameterError, "threads: wanted a whole number") for bad in (1.5, 0, 2**80)),
    *((partial(lp.sample_states, TOP, bad, seed=1), ParameterError, "n_starts: wanted a whole number")
      for bad in (2.0, "2", -1)),
    *((partial(lp.sample_states, TOP, 1, seed=1, ensemble=bad), (ParameterError, UnknownNameError), "ensemble: wanted")
      for bad in (None, "balls")),
    # systems, methods, kernels
    *((partial(call, bad), ParameterError, "system: wanted a system")
      for call in (run, partial(lp.sample_states, n_starts=1, seed=1)) for bad in (None, lp.Top, "top")),
    *((partial(run, method=bad), ParameterError, "method: wanted a method object") for bad in ("taylor", lp.Taylor, 0)),
    (partial(exponent, method="taylor"), ParameterError, "method: wanted a method object"),
    *((partial(lp.Taylor, tol=bad), ParameterError, "tol: wanted") for bad in ("a", 0.0, 1e-17, 0.5, np.nan)),
    *((partial(lp.Taylor, order=bad), ParameterError, "order: wanted a whole number") for bad in (2.5, 1, 65)),
    *((partial(lp.Taylor, max_steps=bad), ParameterError, "max_steps: wanted") for bad in (0, 2**70, None)),
    (partial(lp.RungeKutta, tol=1e-8, step=0.1), ParameterError, "got both"),
    (partial(lp.RungeKutta, tol=9e-7, precision="single"), ParameterError, "from 9.6e-7"),
    (partial(lp.RungeKutta, precision="mixed"), ParameterError, 'wanted "double" or "single"'),
    (partial(lp.Taylor, precision="single"), ParameterError, 'wanted "double" or "mixed"'),
    (partial(lp.Splitting, step=0), ParameterError, "step: wanted a positive number"),
    (partial(lp.Splitting, step=0.1, order=5), ParameterError, "order: wanted 2, 4, 6 or 8"),
    (partial(lp.Gauss, step="a"), ParameterError, "step: wanted a positive number"),
    (partial(lp.RungeKutta, compensated=True, precision="single"), ParameterError, "compensated"),
    (partial(run, MANAKOV, SIX, method=lp.Taylor(precision="mixed")), ParameterError, "which is for tops"),
    (partial(run, MANAKOV.field(), SIX, method=lp.Splitting(step=0.1)), ParameterError, "give the system that the"),
    (partial(run, MANAKOV.pieces(), SIX), ParameterError, "wanted Splitting for a field given by its pieces"),
    (partial(dense, method=lp.RungeKutta()), ParameterError, "wanted the Taylor method, which has power series"),
    (partial(run, KOVALEVSKAYA, method=LagrangeMap(step=0.1)), ParameterError, "wanted a top with I1 = I2"),
    (partial(LagrangeMap(step=0.1).integrals, KOVALEVSKAYA, X0), ParameterError, "wanted a top with I1 = I2"),
    (partial(LagrangeMap(step=0.1).integrals, lp.Top.twisted_lagrange(), SIX), ShapeError, "must end in 9 components"),
    (partial(run, x0=[X0, X0], kernel="components"), ParameterError, "for 2 trajectories with 0 tangent vectors"),
    (partial(run, tangents=np.eye(9), kernel="components"), ParameterError, "for 1 trajectory with 9 tangent"),
    (partial(run, kernel="fast"), ParameterError, "got 'fast'"),
    (partial(run, OnlyAField("x", "y")), ParameterError, "wanted 9 names"),
    (lambda: run(OnlyAField()).drift, ParameterError, "wanted a system with a bracket.*got only a field"),
    # arrays
    (partial(run, x0=np.zeros((9, 128))), ShapeError, r"got shape \(9, 128\). Transpose it\?"),
    (partial(run, x0=np.zeros((2, 3, 9))), ShapeError, r"got shape \(2, 3, 9\)"),
    (partial(run, x0=np.zeros(8)), ShapeError, r"must have shape \(9,\) or \(trajectory, 9\); got shape \(8,\)"),
    (partial(run, x0=np.full((4, 9), np.inf)), ParameterError, "trajectory 0 of 4 has a NaN"),
    *((partial(run, x0=bad), ShapeError, "starts: wanted an array of numbers") for bad in ("nine", ["x"] * 9)),
    (partial(run, x0=["sqrt", *X0[1:]]), ShapeError, "starts: wanted an array of numbers; sqrt: .*needs its arguments"),
    *((call, ParameterError, r"real numbers; got (a masked array|an array of)")
      for bad in (np.array(X0) + 0j, np.zeros(9, "m8[s]"), np.ma.masked_array(X0, mask=[True] + [False] * 8))
      for call in (partial(run, x0=bad), partial(run, times=bad), partial(TOP.vector_field, bad))),
    *((partial(run, times=bad), ParameterError, "strictly increasing or strictly decreasing")
      for bad in ([0, 0], [0, 1, 0.5], [0, np.inf])),
    (partial(run, times=[0]), ShapeError, "2 or more times"),
    (partial(run, tangents=np.zeros(9)), ShapeError, r"tangents must have shape \(tangent, 9\) or \(1, tangent, 9\)"),
    (lambda: run().at(0.5), ParameterError, "dense=True"),
    (lambda: dense().at([0.5, 1.5]), ParameterError, r"from 0\.0 to 1\.0"),
    (lambda: dense().at(np.nan), ParameterError, r"from 0\.0 to 1\.0"),
    (lambda: dense().at("a"), ShapeError, "times: wanted an array of numbers"),
    (partial(time_scale, TOP, X0[:8]), ShapeError, "9"),
    (partial(time_scale, TOP, [np.nan] * 9), ParameterError, "NaN"),
    # starts by name
    (partial(named, L1=1), ParameterError, r"starts must name a field or a component; got 'L1'\. Did you mean l1\?"),
    (partial(named, alfa=1), ParameterError, r"Did you mean one of alpha1, alpha2, alpha3\? Known: l, alpha, beta, l1"),
    (partial(named, l=1), ShapeError, r"starts l must have 3 numbers; got shape \(\)"),
    (partial(named, l=(1, 2)), ShapeError, "starts l must have 3 numbers; got 2"),
    (partial(named, l=np.zeros((2, 3)), beta1=[1, 2, 3]), ShapeError, "one number of trajectories; got l 2, beta1 3"),
    (partial(named, l=(1, 0, 0), l1=1), ParameterError, "l1 comes twice, also in l"),
    (partial(named, l1=np.nan), ParameterError, "wanted finite numbers"),
    (partial(named, l1="one"), ShapeError, "starts l1: wanted an array of numbers"),
]  # fmt: skip


@pytest.mark.parametrize(("call", "error", "words"), REFUSED)
def test_what_is_refused(call, error, words):
    with pytest.raises(error, match=words):
        call()


def test_exact_numbers_may_be_written_as_texts():
    exact = ["1/3", 0, "sqrt(2)/2", 0, 0, 1, "1e-1", "-pi", 2.5]
    inexact = [1 / 3, 0, 2**0.5 / 2, 0, 0, 1, 0.1, -np.pi, 2.5]
    assert run(x0=exact, times=[0, "1/2"]).state.tolist() == run(x0=inexact, times=[0, 0.5]).state.tolist()
    assert exponent(t_end="7/2").time[-1] == 3.5
    assert lp.Taylor(tol="1e-9").tol == 1e-9
    assert exponent(first=2**63 - 2).dataset.trajectory.to_numpy()[0] == 2**63 - 2


def test_numbers_of_numpy_become_plain_ones_and_can_be_saved(tmp_path):
    method = lp.Taylor(tol=np.float32(1e-10), order=np.int64(20), max_steps=np.int32(1000))
    assert [type(v) for v in (method.tol, method.order, method.max_steps)] == [float, int, int]
    growth = exponent(seed=np.int64(5), first=np.int64(3), method=method)
    assert (type(growth.seed), type(growth.first)) == (int, int)
    attributes = lp.load(growth.save(tmp_path / "growth.nc")).dataset.attrs
    assert [json.loads(attributes["run"])[name] for name in ("seed", "first", "time_limit")] == [5, 3, 3600.0]
    resampling = Resampling(np.int64(10), np.float32(0.5), np.int64(1))
    values = (resampling.n_bootstrap, resampling.confidence, resampling.seed)
    assert [type(v) for v in values] == [int, float, int]


def test_a_repr_tells_of_vectors_and_states():
    orbit = run(times=np.linspace(0, 2, 5), tangents=np.eye(9)[:2])
    assert repr(orbit) == f"<Orbit of {TOP.name}: 1 trajectory, 5 times, t = 0 to 2, 2 tangent vectors each>"
