"""Signed permutations that take orbits to orbits, decided from the equations."""

from itertools import permutations, product

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.systems import discrete_symmetries

TWISTED = lp.Top.kovalevskaya(epsilon=1)
R1, RHO2, RHO3 = (np.tile(signs, 3) for signs in ((1, -1, -1), (1, -1, 1), (1, 1, -1)))
"""What changes sign for a along e1, b = 0: components 2 and 3, 2, 3 of each vector."""


def with_signs(found, signs):
    return next(one for one in found if one.signs == tuple(signs) and one.permutation == tuple(range(len(signs))))


def test_the_twisted_kovalevskaya_top_has_seven():
    """l, beta -> -l, -beta with t -> -t, rho2 and rho3 generate the group of eight."""
    found = discrete_symmetries(TWISTED)
    assert len(found) == 7
    assert len(found.reversers) == 4
    assert all(one.permutation == tuple(range(9)) for one in found)
    time = with_signs(found, (-1,) * 3 + (1,) * 3 + (-1,) * 3)
    assert time.reverses_time
    assert time.bracket == "anti-Poisson"
    assert dict(time.invariants) == {"H": 1, "C1": 1, "C2": -1, "C3": 1}
    assert time.meets({"C2": 0})
    assert not time.meets({"C2": "1/2"})
    assert "l2, alpha2, beta2 -> -l2, -alpha2, -beta2; t -> -t" in repr(found)


@pytest.mark.parametrize(
    ("signs", "reverses", "bracket", "dimension"),
    [(R1, False, "Poisson", 0), (RHO2, True, "anti-Poisson", 2), (RHO3, True, "anti-Poisson", 2)],
)
def test_those_that_keep_every_level_of_the_twisted_top(signs, reverses, bracket, dimension):
    """R1 turns by pi about e1; rho2 and rho3 reflect, which reverses cross products.

    Fix R1 is three-dimensional, and H, C1, C2, C3 have rank 3 on it; Fix rho2 has 6 - 4 dimensions.
    """
    one = with_signs(discrete_symmetries(TWISTED), signs)
    assert one.reverses_time is reverses
    assert one.bracket == bracket
    assert one.keeps_every_level
    assert one.order == 2
    assert one.is_reverser is reverses
    assert one.fixed_dimension == dimension


@pytest.mark.thorough
def test_they_are_those_of_the_field_at_random_states():
    """f(S x) = +-S f(x), evaluated in doubles, for systems with few and with many symmetries."""
    systems = [
        TWISTED,
        lp.catalog.system("heavy-top"),
        lp.catalog.system("three-wave"),
        lp.Top.free_rigid_body((3, 2, 1)),
    ]
    for system in systems:
        states = np.random.default_rng(3).uniform(-1, 1, (5, len(system.variables)))
        rate = system.vector_field(states)
        for one in discrete_symmetries(system, most=4000):
            wanted = (-1 if one.reverses_time else 1) * one(rate)
            np.testing.assert_allclose(system.vector_field(one(states)), wanted, atol=1e-12, err_msg=repr(one))


def test_no_signed_permutation_of_three_components_is_missed():
    """Of the 2^3 3! signed permutations those of Euler's top (2, 2, 1), tried one by one."""
    system = lp.System(lp.so(3) @ lp.trivial(), "l1^2/4 + l2^2/4 + l3^2/2")
    states = np.random.default_rng(0).uniform(-1, 1, (4, 3))
    rate = system.vector_field(states)
    wanted = {
        (p, s, factor == -1)
        for p, s, factor in product(permutations(range(3)), product((1, -1), repeat=3), (1, -1))
        if np.allclose(system.vector_field(states[:, p] * s), factor * rate[:, p] * s, atol=1e-12)
    } - {((0, 1, 2), (1, 1, 1), False)}
    assert {(one.permutation, one.signs, one.reverses_time) for one in discrete_symmetries(system)} == wanted
    assert len(discrete_symmetries(system, permutations=False)) == sum(p == (0, 1, 2) for p, _, _ in wanted)


@pytest.mark.thorough
def test_symbolic_parameters_are_generic_and_a_sine_is_tried():
    assert len(discrete_symmetries(lp.Top.twisted(("I1", "I2", "I3"), ("a1", 0, 0), epsilon="epsilon"))) == 7
    found = discrete_symmetries(lp.System(lp.canonical(1), "dot(p, p)/2 - cos(q1)"))
    assert {(one.signs, one.reverses_time) for one in found} == {((-1, -1), False), ((1, -1), True), ((-1, 1), True)}
    assert not found.with_permutations
    assert "changes of signs" in repr(found)


def test_fixed_states_and_levels():
    """q1 -> -q2, q2 -> -q1 fixes q1 = -q2; a cycle whose signs multiply to -1 fixes 0 only."""
    rho2 = with_signs(discrete_symmetries(TWISTED), RHO2)
    basis = np.array(rho2.fixed_space)
    assert basis.shape == (6, 9)
    np.testing.assert_array_equal(rho2(basis.astype(float)), basis)
    np.testing.assert_array_equal(rho2.matrix @ np.arange(9.0), rho2(np.arange(9.0)))
    found = discrete_symmetries(lp.System(lp.canonical(2), "dot(p, p)/2 + dot(q, q)/2"))
    fixed = {s.signs: s.fixed_space for s in found if s.permutation == (1, 0, 3, 2)}
    assert set(fixed[-1, -1, -1, -1]) == {(1, -1, 0, 0), (0, 0, 1, -1)}
    assert fixed[-1, 1, -1, 1] == ()
