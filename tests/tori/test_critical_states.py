"""Types of critical states that are known: degenerate ones by their powers, others whatever the masses."""

import numpy as np
import pytest

import liepoisson as lp

ROUND = "(p_b^2 + b^2)/2"


def types_at_rest_of_a(potential, mass="1"):
    """The types at a = p_a = 0, on orbits of the other oscillator."""
    system = lp.System(lp.canonical(names=["a", "b"]), f"p_a^2/(2*{mass}) + {potential} + {ROUND}")
    momentum = lp.tori.momentum_map(system, [ROUND])
    found = lp.tori.critical_states(lp.Leaf(system, {}), momentum=momentum, n_starts=60)
    moves = np.hypot(found.states[:, 1], found.states[:, 3]) > 0.01
    here = moves & (np.abs(found.states[:, 0]) < 0.01)
    assert here.any()
    return set(found.type[here].tolist())


@pytest.mark.parametrize("potential", ["a^4/4", "a^3/3", "-a^4", "a^6"])
def test_a_higher_power_is_degenerate(potential):
    assert types_at_rest_of_a(potential) == {"degenerate"}


@pytest.mark.parametrize("mass", ["1", "10^6", "10^(-6)"])
@pytest.mark.parametrize(("sign", "kind"), [("", "elliptic"), ("-", "hyperbolic")])
def test_a_square_is_not(sign, kind, mass):
    assert types_at_rest_of_a(f"{sign}a^2/2", mass) == {kind}
