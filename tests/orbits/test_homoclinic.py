"""Symmetric homoclinic orbits."""

import numpy as np
import pytest
from numbers_of_the_proof import MIDPOINT

import liepoisson as lp
from liepoisson.orbits import symmetric_homoclinic_orbits


def that_of_the_proof(found):
    """The orbit among others, by its angles."""
    return next(one for one in found if np.abs(one.angles - [0.78271, 1.47679]).max() < 1e-5)


@pytest.mark.thorough
def test_the_homoclinic_orbit_of_the_proof(homoclinic_orbits):
    """The angles between the manifolds were found to be 0.78271 and 1.47679, the distance from the orbit 2.63."""
    one = that_of_the_proof(homoclinic_orbits)
    np.testing.assert_allclose(np.abs(one.midpoint), np.abs([float(v) for v in MIDPOINT]), atol=1e-10)
    np.testing.assert_allclose(one.angles, [0.78271, 1.47679], atol=5e-6)
    assert abs(one.distance - 2.63) < 0.005
    assert one.residual < 1e-11


@pytest.mark.thorough
def test_they_leave_the_periodic_orbit_and_come_back(homoclinic_orbits, twisted_orbits):
    path = twisted_orbits[0].states(2001)
    path = np.concatenate([path, path * np.tile([1, -1, -1], 3), path * np.tile([1, -1, 1], 3)])
    assert len(homoclinic_orbits) > 36  # what an independent search found
    for one in homoclinic_orbits[:4]:
        times, states = one.states(41)
        assert times[20] == 0.0
        near = [np.linalg.norm(path - states[k], axis=1).min() for k in (0, 20, -1)]
        assert near[0] < 5e-3
        assert near[2] < 5e-3
        assert near[1] > 0.05
        # the two halves are one orbit: the second, integrated from the midpoint, is the mirror image of the first
        later = lp.integrate(one.system, one.midpoint, times=[0, 5]).state[0, -1]
        earlier = lp.integrate(one.system, one.midpoint, times=[0, -5]).state[0, -1]
        np.testing.assert_allclose(one.reverser(earlier), later, atol=1e-10)


@pytest.mark.thorough
def test_an_equilibrium_has_homoclinic_orbits():
    """Eigenvalues +-0.61891 +- 1.02466 i, +-0.64323, so W^u is three-dimensional."""
    top = lp.Top.kovalevskaya(epsilon=1)
    leaf = lp.Leaf(top, {"C1": "9.6", "C2": -2, "C3": 1})
    state = np.array([2.8, 0, 0, -2, 0, 0, 1, 0, 0])
    origin = next(one for one in lp.equilibria(top, leaf) if np.abs(one.state - state).max() < 1e-9)
    found = symmetric_homoclinic_orbits(origin, threads=1, n_starts=60)
    assert len(found) > 4
    for one in found[:2]:
        assert one.space.basis.shape == (9, 3)
        _, states = one.states(11)
        np.testing.assert_allclose(states[[0, -1]], [state, state], atol=2e-4)
        np.testing.assert_allclose(top.functions.energy(states), 3.96, atol=1e-10)
        assert (one.angles > 0).all()
        assert one.angles.shape == (2,)


def test_a_double_well_has_one_homoclinic_orbit():
    r"""H = p^2/2 - q^2/2 + q^4/4: from 0 to the midpoint q = sqrt 2, p = 0, $q = \sqrt2/\cosh t$; no angles."""
    system = lp.System(lp.canonical(1), "dot(p, p)/2 - q1^2/2 + q1^4/4")
    saddle = next(one for one in lp.equilibria(system, {}) if one.linear_stability == "unstable")
    found = symmetric_homoclinic_orbits(saddle, n_starts=8)
    assert len(found) == 1
    np.testing.assert_allclose(np.abs(found[0].midpoint), [np.sqrt(2), 0], atol=1e-10)
    times, states = found[0].states(101)
    np.testing.assert_allclose(np.abs(states[:, 0]), np.sqrt(2) / np.cosh(times), atol=1e-8)
    assert found[0].angles.shape == (0,)
