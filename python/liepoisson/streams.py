"""Random numbers: every purpose has a stream of its own for each seed.

Two purposes with one number would draw the same numbers, and what should be independent would not be: hence all of them
are here.  The numbers are part of what a seed means; one that has been used keeps its purpose.
"""

from __future__ import annotations

from enum import IntEnum

import numpy as np


class Purpose(IntEnum):
    """What random numbers are drawn for."""

    STATES = 0
    TANGENTS = 1
    FRAMES = 2
    TRIANGLES = 3
    """Coefficients of covariant vectors at the end of a run."""
    ALIGNMENT = 4
    EQUILIBRIA = 5
    """Starts of a search for equilibria."""
    LEAF = 10
    """Independent states on a leaf."""
    CHAINS = 11
    """Markov chains on a leaf."""
    SYMMETRIC_ORBITS = 12
    """Starts in the fixed sets of reversers."""
    HOMOCLINIC_ORBITS = 13
    """Amplitudes on linear unstable spaces."""
    SECTION = 0x5EC7
    """Starts on a surface of section."""


def seeds(seed: int, purpose: Purpose, *place: int) -> np.random.SeedSequence:
    """What a stream begins with."""
    return np.random.SeedSequence(seed, spawn_key=(int(purpose), *place))


def stream(seed: int, purpose: Purpose, *place: int) -> np.random.Generator:
    """The random numbers of a seed for a purpose, at a place: the number of a block, a member or a trial."""
    return np.random.default_rng(seeds(seed, purpose, *place))
