"""Euler characteristics of leaves, against known ones."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.equilibrium.euler_characteristic import euler_characteristic


def quadratic(bracket):
    return lp.System(bracket, " + ".join(f"{k + 2}*{x}^2" for k, x in enumerate(bracket.coordinate_names_in_order)))


@pytest.mark.parametrize(("algebra", "expected"), [(lp.so(3), 2), (lp.so(4), 4), (lp.su(3), 6)])
def test_regular_orbits_of_compact_algebras_have_the_order_of_the_weyl_group(algebra, expected):
    system = quadratic(algebra @ lp.trivial())
    x = np.random.default_rng(0).normal(size=algebra.dimension)
    assert euler_characteristic(lp.Leaf.through(system, x)) == expected


def test_singular_orbit_of_su3_is_the_complex_projective_plane():
    system = quadratic(lp.su(3) @ lp.trivial())
    x = np.zeros(8)
    x[-1] = 1  # diag(1, 1, -2)
    leaf = lp.Leaf.through(system, x)
    assert leaf.rank == 4
    assert euler_characteristic(leaf) == 3


@pytest.mark.parametrize(
    ("name", "expected"),
    [("heavy-top", 2), ("kirchhoff", 2), ("manakov-so4", 4), ("twisted-kovalevskaya", 2), ("charged-heavy-top", 0)],
)
def test_leaves_of_the_catalogue(name, expected):
    system = lp.catalog.system(name)
    assert euler_characteristic(lp.Leaf.through(system, lp.sample_states(system, 1, seed=2)[0])) == expected


def test_nothing_is_said_where_h_may_not_be_proper():
    for name in ("so21-heavy-top", "rattleback"):
        system = lp.catalog.system(name)
        assert euler_characteristic(lp.Leaf.through(system, lp.sample_states(system, 1, seed=2)[0])) is None
    indefinite = lp.System(lp.so(3) @ lp.semidirect(2), "l1^2 + l2^2 - l3^2 + alpha1")
    assert euler_characteristic(lp.Leaf.through(indefinite, [1, 0, 0, 0, 1, 0.5])) is None
    assert euler_characteristic(lp.Leaf.through(indefinite, np.zeros(6))) == 1
