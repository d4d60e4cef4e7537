"""Random numbers: every purpose has a stream of its own for each seed.

Numbers are the same bits on every processor.  Whole numbers, and doubles in [0, 1), NumPy makes of the generator's bits
alone.  What needs a logarithm, or a sum beside a product, which compilers fuse on some processors, is made here.

Two purposes with one number would draw the same numbers, and what should be independent would not be: hence all of them
are here.  The numbers are part of what a seed means; one that has been used keeps its purpose.
"""

from __future__ import annotations

from enum import IntEnum, unique
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from liepoisson.portable import elementary


@unique
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
    PERIODIC_ORBITS = 14
    """States of a level whose returns are looked at."""
    CONNECTING_ORBITS = 15
    """Amplitudes on the linear spaces of source and target, and the surface on which orbits from both are compared."""
    DIRECTIONS = 16
    """Directions of invariant manifolds with more than two of them."""
    PERIOD_LATTICE = 17
    """Times of commuting flows from which closing ones are looked for."""
    CRITICAL_POINTS = 18
    """States from which critical points of a momentum map are looked for."""
    FIBRES = 19
    """States of a fibre, of which those that flows join are one torus."""
    NOISE = 30
    """The key of the paths that shake a system, whose numbers the core makes by trajectory, step and channel."""
    SECTION = 0x5EC7
    """Starts on a surface of section."""


_TAIL, _INVERSE = 3.6541528853610088, 0.2736612373297583
"""Where the tail of the normal distribution begins in NumPy's ziggurat of 256 layers (Marsaglia and Tsang 2000)."""
_AT_A_TIME = 4096
"""Normal numbers between two states of the generator that are kept: they are drawn again for one in the tail."""


class Random(np.random.Generator):
    """Random numbers that are the same bits on every processor."""

    def uniform(self, low: ArrayLike = 0.0, high: ArrayLike = 1.0, size: Any = None) -> Any:
        """Numbers between two bounds."""
        low, high = np.asarray(low, dtype=np.float64), np.asarray(high, dtype=np.float64)
        shape = np.broadcast_shapes(low.shape, high.shape) if size is None else size
        return (low + (high - low) * self.random(shape))[()]

    def standard_normal(self, size: Any = None) -> Any:  # pyright: ignore[reportIncompatibleMethodOverride]
        """Normal numbers with mean 0 and variance 1: those of NumPy, with a tail by the core's logarithm."""
        values = np.empty(() if size is None else size)
        flat = values.reshape(-1)
        for start in range(0, flat.size, _AT_A_TIME):
            self._fill(flat[start : start + _AT_A_TIME])
        return values[()]

    def normal(self, loc: ArrayLike = 0.0, scale: ArrayLike = 1.0, size: Any = None) -> Any:
        """Normal numbers with a mean and a standard deviation."""
        mean, scale = np.asarray(loc, dtype=np.float64), np.asarray(scale, dtype=np.float64)
        if (scale < 0).any():
            raise ValueError("scale: wanted standard deviations, which are not negative")
        shape = np.broadcast_shapes(mean.shape, scale.shape) if size is None else size
        return (mean + scale * np.asarray(self.standard_normal(shape)))[()]

    def _fill(self, values: Any) -> None:
        bits: Any = self.bit_generator
        before = bits.state
        values[:] = super().standard_normal(len(values))
        far = np.flatnonzero(np.abs(values) > _TAIL)
        if not far.size:
            return
        after = bits.state
        for k in far:
            bits.state = before
            super().standard_normal(k)
            values[k] = self._tail()
        bits.state = after

    def _tail(self) -> float:
        """A number in the tail, from the bits that NumPy takes for it: layer and sign, then pairs."""
        bits: Any = self.bit_generator
        while (first := int(bits.random_raw())) & 0xFF:  # another layer, which was then refused by one number
            self.random()
        while True:
            beyond, height = (-float(elementary.log1p(-u)) for u in self.random(2))
            beyond *= _INVERSE
            if 2 * height > beyond * beyond:
                return -(_TAIL + beyond) if first >> 17 & 1 else _TAIL + beyond


def seeds(seed: int, purpose: Purpose, *place: int) -> np.random.SeedSequence:
    """What a stream begins with."""
    return np.random.SeedSequence(seed, spawn_key=(int(purpose), *place))


def generator(seed: int | list[int] | np.random.SeedSequence) -> Random:
    """Random numbers of a seed."""
    return Random(np.random.PCG64(seed))


def stream(seed: int, purpose: Purpose, *place: int) -> Random:
    """The random numbers of a seed for a purpose, at a place: the number of a block, a trajectory or a trial."""
    return generator(seeds(seed, purpose, *place))
