"""What the searches for orbits refuse, and in which words."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from flint import arb_mat

import liepoisson as lp
from liepoisson.errors import LeafError, OrbitError, ParameterError
from liepoisson.orbits import invariant_manifold, symmetric_homoclinic_orbits, symmetric_periodic_orbits
from liepoisson.orbits.level import level_of
from liepoisson.orbits.precise_flow import PreciseFlow, solved

TOP = lp.Top.kovalevskaya(epsilon=1)
LEVEL = {"C1": 1, "C2": "1/2", "C3": 1}
OSCILLATOR = lp.System(lp.canonical(1), "dot(p, p)/2 + dot(q, q)/2")
PENDULUM = lp.System(lp.canonical(1), "dot(p, p)/2 - cos(q1)")
WELL = lp.System(lp.canonical(1), "dot(p, p)/2 + q1^4/4 + q1^2/2")
LOWER = lp.Leaf.through(TOP, [1, 0, 0, 0, 0, 0, 0, 0, 0])
OTHER = lp.Leaf.through(lp.Top.heavy((2, 2, 1), (1, 0, 0)), [1, 0, 0, 1, 0, 0, 0, 1, 0])
ASYMMETRIC = lp.Top.twisted((3, 2, 1), (1, "1/2", "1/3"), (1, 0, 1))


def orbit(system, energy=1):
    return symmetric_periodic_orbits(system, {}, energy=energy, n_starts=4)[0]


def saddle():
    return lp.phase_space.equilibrium(PENDULUM, [np.pi, 0])


def relative():
    """A relative equilibrium of a spherical pendulum, that turns."""
    top = lp.System(lp.so(3) @ lp.semidirect(2), "dot(l, l)/2 + alpha3")
    return next(one for one in lp.equilibria(top, {"C1": "1/5", "C2": 1}, along=("l3",), values={"l3": 0.5}))


def reversers_that_change_the_level():
    return [one for one in lp.systems.discrete_symmetries(TOP).reversers if not one.keeps_every_level]


def broken():
    """A start that is far from any orbit of this energy, with a time that is much too short."""
    one = orbit(WELL)
    return replace(one, start=3 + one.start, time=1e-2)


def family_along_its_parameter(name):
    """Of a pendulum whose parameter has the name of a function."""
    pendulum = lp.System(lp.canonical(1), f"p1^2/2 - {name}*cos(q1)", {name: 1})
    swing = lp.orbits.periodic_orbit(pendulum, [1, 0], period=7)
    return lp.orbits.orbit_family(pendulum, swing, along=name, until=3)


REFUSED = [
    (partial(symmetric_periodic_orbits, TOP, LEVEL, -100, n_starts=20), LeafError, "none of"),
    (partial(symmetric_periodic_orbits, TOP, LOWER, 0), LeafError, "regular"),
    (partial(symmetric_periodic_orbits, ASYMMETRIC, LEVEL, 1), ParameterError, "must have a reverser"),
    (
        lambda: symmetric_periodic_orbits(TOP, LEVEL, "1/2", reversers=reversers_that_change_the_level()),
        ParameterError,
        "to itself",
    ),
    (partial(symmetric_periodic_orbits, TOP, LEVEL, "1/2", reversers=["R1"]), ParameterError, "reversers: wanted"),
    (partial(symmetric_periodic_orbits, TOP, 3, "1/2"), ParameterError, "leaf must be"),
    (lambda: symmetric_homoclinic_orbits(orbit(OSCILLATOR)), ParameterError, "hyperbolic"),
    (lambda: symmetric_homoclinic_orbits(lp.equilibria(OSCILLATOR, {})[0]), ParameterError, "hyperbolic"),
    (partial(symmetric_homoclinic_orbits, OSCILLATOR), ParameterError, "wanted a symmetric periodic orbit"),
    (partial(invariant_manifold, OSCILLATOR), ParameterError, "base: wanted a periodic orbit or an equilibrium"),
    (lambda: invariant_manifold(lp.equilibria(OSCILLATOR, {})[0]), ParameterError, "base: .* is a centre"),
    (lambda: invariant_manifold(orbit(OSCILLATOR)), ParameterError, "base: .* is a centre"),
    (lambda: invariant_manifold(relative()), ParameterError, "relative"),
    (lambda: invariant_manifold(saddle(), "neutral"), ParameterError, "kind"),
    (lambda: invariant_manifold(saddle(), amplitude=0), ParameterError, "amplitude: wanted a positive number"),
    (lambda: invariant_manifold(saddle()).at([[1.0, 2.0]]), ParameterError, r"shape \(n, 1\)"),
    (lambda: invariant_manifold(saddle()).at([[0.0]]), ParameterError, "not zero"),
    (lambda: invariant_manifold(saddle()).at([[1.0], [2.0]], [0.1] * 3), ParameterError, "phases: wanted"),
    (lambda: invariant_manifold(saddle()).followed(2, -1.0), ParameterError, "t_end"),
    (lambda: invariant_manifold(saddle()).starts(0), ParameterError, "n_starts"),
    (lambda: orbit(PENDULUM, 0).polished(), ParameterError, "polynomials"),
    (lambda: orbit(OSCILLATOR).polished(digits=5), ParameterError, "digits"),
    (lambda: broken().polished(digits=10), OrbitError, "."),
    (partial(level_of, TOP, LOWER, 0), LeafError, "regular"),
    (partial(level_of, TOP, OTHER, 0), ParameterError, "one of"),
    (partial(level_of, TOP, LEVEL, np.inf), ParameterError, "."),
    (partial(PreciseFlow, PENDULUM, 20), ParameterError, "polynomials"),
    (lambda: solved(arb_mat(2, 2, [1, 1, 1, 1]), arb_mat(2, 1, [1, 2])), OrbitError, "regular"),
    (lambda: invariant_manifold(saddle(), amplitude=1e300), OrbitError, "take a smaller one"),
    *((partial(family_along_its_parameter, name), ParameterError, "Rename the parameter") for name in ("H", "energy")),
]


@pytest.mark.parametrize(("call", "error", "words"), REFUSED)
def test_what_is_refused(call, error, words):
    with pytest.raises(error, match=words):
        call()
