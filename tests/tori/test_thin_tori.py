"""Thin, large and uneven tori: lattices whole or refused, counts that do not depend on Newton's luck, walls seen."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import OrbitError

TWO = lp.System(lp.canonical(names=["a", "b"]), "(p_a^2 + a^2)/2 + sqrt(2)*(p_b^2 + b^2)/2")
MOMENTUM = lp.tori.momentum_map(TWO, ["(p_a^2 + a^2)/2"])
BASIS = 2 * np.pi * np.array([[0, 1], [1 / np.sqrt(2), -1 / np.sqrt(2)]])
"""Periods of H and of the first oscillator: its own turn, and that of the second one."""


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("amplitude", [1e-2, 1e-4, 5e-6, 1e-7])
def test_a_thin_torus_has_its_whole_lattice_or_is_refused(amplitude, seed):
    try:
        found = lp.tori.period_lattice(MOMENTUM, [1, amplitude, 0, 0], seed=seed)
    except OrbitError as error:
        assert amplitude < 2e-5
        assert "doubles resolve" in str(error)
        return
    quotient = found.periods @ np.linalg.inv(BASIS)
    np.testing.assert_allclose(quotient, np.round(quotient), atol=1e-9)
    assert abs(np.linalg.det(quotient)) == pytest.approx(1, rel=1e-9)


@pytest.mark.parametrize("amplitude", [1e-3, 1, 30, 1e5])
def test_large_tori_have_their_period(amplitude):
    oscillator = lp.System(lp.canonical(names=["q"]), "(p_q^2 + q^2)/2")
    found = lp.tori.period_lattice(oscillator, [amplitude, 0])
    assert abs(found.periods[0, 0]) == pytest.approx(2 * np.pi, rel=1e-12)


@pytest.mark.parametrize("energy", [0.2, 0.5])
def test_a_torus_around_three_wells_is_one(energy):
    """q^2 (q^2 - 1)^2 has the barriers 4/27; the orbit above is slow over them and quick in the wells."""
    wells = lp.Leaf(lp.System(lp.canonical(names=["q"]), "p_q^2/2 + q^2*(q^2 - 1)^2"), {})
    assert [lp.tori.fibre(wells, [one]).n_tori for one in (energy, 0.1)] == [1, 3]


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.slow) for seed in (1, 2, 3))])
def test_a_loop_through_a_wall_is_refused(seed):
    """A double well beside an oscillator: at H - K = 0 two tori become one.  Corners are on both sides of it."""
    system = lp.System(lp.canonical(names=["a", "b"]), "p_a^2/2 - a^2/2 + a^4/4 + (p_b^2 + b^2)/2")
    momentum = lp.tori.momentum_map(system, ["(p_b^2 + b^2)/2"])
    draw = np.random.default_rng(seed)
    well = np.array([1, -1, -1, 1]) * draw.uniform([0.03, 0.03, 0.03, 0.03], [0.3, 0.2, 0.2, 0.3])
    other = 0.5 + draw.uniform(0, 0.2, size=4)
    loop = np.stack([well + other, other], axis=1)
    with pytest.raises(OrbitError, match="cannot be carried beyond"):
        lp.tori.monodromy(momentum, [1.2, 1, 0.1, 0], loop)
