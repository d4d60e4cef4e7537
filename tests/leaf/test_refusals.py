"""What leaves, samples, starts, bounds and charts refuse, and in which words."""

from functools import partial

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import LeafError, MemoryLimitError, ParameterError, ShapeError
from liepoisson.leaf.chart_orbit import chart_orbit

A, B = (-1, "1/3", "1/5"), ("1/5", "1/2", "-1/3")
TWISTED, CHARGED = (lp.Top(inertia=(2, "3/2", 1), a=A, b=B, epsilon=epsilon) for epsilon in (1, 0))
KOVALEVSKAYA = lp.Top.twisted_kovalevskaya()
HEAVY = lp.catalog.system("kovalevskaya")  # six components: C1 = l.alpha, C2 = |alpha|^2
MANAKOV, BODY = lp.catalog.system("manakov-so4"), lp.catalog.system("free-rigid-body")
X = np.arange(1, 10) / 10
LEAF, LOWER = lp.Leaf.through(TWISTED, X), lp.Leaf.through(TWISTED, [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0, 0, 0])
SPHERE, POINT = lp.Leaf.through(TWISTED, [1, 2, 3, 0, 0, 0, 0, 0, 0]), lp.Leaf.through(TWISTED, np.zeros(9))
SMALL = lp.Leaf(HEAVY, {"C1": 0.3, "C2": 1})
POLE = lp.Leaf.through(lp.System(BODY.bracket, "1/l1"), [0, 0, 0])
HENON_HEILES, RATTLEBACK = lp.catalog.system("henon-heiles"), lp.catalog.system("rattleback")
UNLISTED = lp.Leaf.through(  # [e1, e3] = e1, [e2, e3] = e2/2 has the Casimir x1/x2^2, which is no polynomial
    lp.System(lp.LieAlgebra.from_brackets(3, {(0, 2): {0: 1}, (1, 2): {1: "1/2"}}) @ lp.trivial(), "dot(l, l)/2"),
    [1, 2, 3],
)
# a free body: any extension with the unit e_0 gives the equations of a top, here with other Casimirs
PRODUCTS = {**{(0, k): {k: 1} for k in range(3)}, (1, 1): {1: 1}}
FREE = lp.System(
    lp.so(3) @ lp.Extension.from_products(3, PRODUCTS, field_names=("l", "alpha", "beta")),
    lambda l, alpha, beta: l.dot(l) / 2,
)
VALUES = {"C1": 1, "C2": 0, "C3": 1}
CHART = lp.charts.QuaternionChart(TWISTED, state=X)
leaf, through, bounds, start = (
    lp.Leaf,
    lp.Leaf.through,
    lp.phase_space.bounds,
    partial(lp.phase_space.find_start, HEAVY),
)
NAN, REFUSES_A_LEAF = [np.nan] * 9, partial(bounds, KOVALEVSKAYA, energy=1)

REFUSED = [
    # leaves
    (partial(leaf, TWISTED, VALUES | {"C3": -1}), LeafError, "sum of squares"),
    (partial(leaf, TWISTED, VALUES | {"C3": 0}), LeafError, r"Leaf.through\(system, state\)"),
    (partial(leaf, CHARGED, VALUES | {"C2": 2}), LeafError, "smaller than C1 C3"),
    (partial(leaf, CHARGED, VALUES | {"C2": 1}), LeafError, "parallel vectors"),
    (partial(leaf, MANAKOV, {"C1": 1, "C2": 2}), LeafError, "no state"),  # |Pf| <= |M|^2/2 on so(4)
    (partial(leaf, HEAVY, {"C1": 1, "C2": 0}), LeafError, r"with C1 = l\.alpha = 1, C2 = \|alpha\|\^2 = 0 was found"),
    (partial(leaf, TWISTED, {"C1": 1}), ParameterError, r"C1 = .*, C2 = .*, C3 = "),
    (partial(leaf, TWISTED, VALUES | {"C1": np.inf}), ParameterError, "finite"),
    (partial(leaf, TWISTED, VALUES | {"C2": "a"}), ParameterError, "."),
    (partial(leaf, TWISTED, "a"), ParameterError, "."),
    *((call, ParameterError, "wanted a system|none for I")
      for bad in (None, "kovalevskaya", lp.Top, lp.Top(inertia=("I", 1, 1)))
      for call in (partial(bounds, bad, np.ones(9)), partial(through, bad, np.ones(9)), partial(leaf, bad, {}))),
    (partial(through, TWISTED, np.ones((2, 9))), ShapeError, "one state"),
    (partial(through, TWISTED, NAN), ParameterError, "finite"),
    (partial(through, TWISTED, X * 1e160), ParameterError, "Choose units"),
    (partial(LEAF.project, X, energy=-9), LeafError, r"the energy lies between -2\.\d+ and inf; -9 was asked for"),
    *((partial(LOWER.project, np.eye(9)[0] * bad), LeafError, "relative residuals") for bad in (np.nan, 1e200)),
    *((partial(LEAF.project_tangent, *pair), ParameterError, "must be finite") for pair in ((NAN, X), (X, NAN))),
    *((call, ParameterError, "energy") for bad in ("a", 1j, [1, 2]) for call in (
        partial(LEAF.project, X, energy=bad), partial(LEAF.sample, 2, seed=0, energy=bad),
        partial(LEAF.sample, 2, seed=0, energy_below=bad),
    )),
    (POLE.energy_range, LeafError, "not defined"),
    (partial(POLE.sample, 3, seed=1), LeafError, "not defined"),
    (partial(UNLISTED.project, UNLISTED.state), LeafError, "3 - 2 = 1"),
    (partial(leaf, lp.systems.CanonicalSystem(["x"], ["p"], "p^2", quadratures={"area": "x*x"}), {}), ParameterError,
     "area besides, found by quadrature"),
    # samples
    (partial(LEAF.sample, 1, seed=0), LeafError, "volume is infinite"),
    (partial(lp.Leaf(HENON_HEILES, {}).sample, 4, seed=1), LeafError, "not bounded"),
    (partial(SPHERE.sample, 1, seed=0, energy=8), LeafError, "the energy lies between"),
    (partial(LEAF.sample, 1, seed=0, energy=1, energy_below=1), ParameterError, "not both"),
    (partial(LEAF.sample, -1, seed=0, energy=1), ParameterError, "whole number"),
    (partial(through(RATTLEBACK, [1, 2, 3]).sample, 1, seed=0, energy=9), ParameterError, "unimodular"),
    (partial(POINT.sample, 1, seed=0, energy=1), LeafError, "point"),
    (partial(POINT.sample, 10**14, seed=0, energy_below=2.0), MemoryLimitError, "fits into memory"),
    # starts
    (partial(start, leaf={"C7": 1}), ParameterError, r'Known: C1 = l\.alpha, C2 = .* Write \{"C1": \.\.\., "C2"'),
    (partial(start, leaf={"l1": 1}), ParameterError, "leaf must name Casimirs of kovalevskaya; got 'l1'"),
    (partial(start, leaf={"C1": 1, "l.alpha": 1}), ParameterError, "C1 comes twice"),
    (partial(start, leaf=3), ParameterError, "leaf must be a Leaf or values"),
    (partial(start, start={"alpha3": 2}, leaf=SMALL), LeafError, "a relative residual of .*Write guess instead"),
    (partial(start, start={"alhpa": (0, 0, 1)}), ParameterError, r"Did you mean alpha\? Known: l, alpha, l1, l2"),
    (partial(start, start={"alpha": (0, 0, 1), "alpha1": 1}), ParameterError, "once; alpha1 comes twice"),
    (partial(start, start={"alpha": (0, 1)}), ShapeError, "start alpha must have 3 numbers; got 2"),
    (partial(start, start=(0, 1)), ShapeError, r'must have 6 numbers .*got 2.*start=\{"l1": 1\}'),
    (partial(start, start=[0] * 6, guess=[0] * 6), ParameterError, "start and guess exclude each other"),
    (partial(start, guess=[0, 0, 1, 0, 0, 1]), ParameterError, "guess must come with leaf or energy"),
    (partial(start, start={"alpha3": 1}, energy=2), LeafError, "it has H = 0 instead of 2. Write guess"),
    (partial(start, energy="x"), ParameterError, "energy"),
    # bounds
    (partial(bounds, lp.Top.kovalevskaya(), leaf=LEAF, energy=1), ParameterError, "epsilon = 0; got <Leaf"),
    (partial(REFUSES_A_LEAF, leaf=through(MANAKOV, np.ones(6))), ParameterError, "wanted a leaf of a top"),
    (partial(REFUSES_A_LEAF, leaf=3), ParameterError, "wanted a Leaf"),
    (partial(REFUSES_A_LEAF, leaf=LOWER.casimirs), ParameterError, r"give Leaf\.through\(top, state\)"),
    (partial(REFUSES_A_LEAF, leaf=VALUES | {"C1": None}), ParameterError, "."),
    (partial(bounds, KOVALEVSKAYA, leaf=LEAF), ParameterError, "both leaf= and energy="),
    (partial(bounds, KOVALEVSKAYA, energy=1), ParameterError, "both leaf= and energy="),
    (partial(bounds, KOVALEVSKAYA, X, leaf=LEAF), ParameterError, "not both"),
    (partial(bounds, KOVALEVSKAYA, X, energy=1), ParameterError, "not both"),
    (partial(bounds, KOVALEVSKAYA, leaf=VALUES, energy=np.nan), ParameterError, "."),
    (partial(bounds, KOVALEVSKAYA, leaf=VALUES, energy=-50), LeafError, "no solution"),
    (partial(bounds, KOVALEVSKAYA, leaf=VALUES | {"C3": -1}, energy=0), LeafError, "C3"),
    (partial(bounds, lp.Top.kovalevskaya(), leaf=VALUES | {"C2": 2}, energy=0), LeafError, "C2"),
    (partial(bounds, MANAKOV, np.ones(6)), ParameterError, "known for tops"),
    (partial(bounds, KOVALEVSKAYA, 1e200 * np.eye(9)[0]), ParameterError, "units"),
    (partial(bounds, KOVALEVSKAYA, 1e-150 * np.eye(9)[0]), ParameterError, "lengths from 1e-140 to 1e"),
    (partial(bounds, KOVALEVSKAYA, leaf=VALUES | {"C2": 1e200, "C3": 1e308}, energy=1e308), ParameterError, "overflow"),
    (partial(bounds, FREE, leaf=VALUES, energy=1.0), ParameterError, "but the bracket"),
    (partial(lp.charts.EulerChart, FREE, leaf=VALUES), ParameterError, "but the bracket"),
    # charts
    (partial(chart_orbit, CHART, [X], times=[0, 1]), ShapeError, "one state"),
    (partial(chart_orbit, CHART, X, times=[0, 1], method=lp.RungeKutta()), ParameterError, "Taylor"),
]  # fmt: skip


@pytest.mark.parametrize(("call", "error", "words"), REFUSED)
def test_what_is_refused(call, error, words):
    with pytest.raises(error, match=words):
        call()
