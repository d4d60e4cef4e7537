"""Period lattices: whether two are the same, and whether orbits have their frequencies."""

from collections.abc import Sequence
from itertools import combinations, product
from math import gcd

import numpy as np
from numpy.typing import NDArray

import liepoisson as lp
from liepoisson.tori.momentum_maps import MomentumMap


def same_lattice(one: NDArray, other: NDArray) -> float:
    """How far the matrix between two bases is from integers; its determinant has to be one of them."""
    quotient = one @ np.linalg.inv(other)
    assert abs(round(np.linalg.det(quotient))) == 1
    return float(np.abs(quotient - np.round(quotient)).max())


def combinations_up_to(most: int, n: int) -> NDArray:
    return np.array([k for k in product(range(-most, most + 1), repeat=n) if any(k)])


def check_frequencies(momentum: MomentumMap, state: NDArray, signals: Sequence[str]) -> None:
    r"""The lines of signals are integer combinations of the frequencies of the lattice, and generate all of them.

    The error of the analysis falls like a power of the number of periods of the slowest beat in a window.  So windows
    are forty periods of the slowest one of the combinations $k\cdot\omega$ up to $|k| = 5$ of two frequencies, 3 of
    three: the lines of Kovalevskaya's top are strong up to there.  Windows of a fixed length miss slow ones: T = 1000
    is three periods of those of Manakov's, and finds their frequencies to 1e-4, as its drift says.  Samples are 16 to
    the shortest period: with 8 to a period of the free body harmonics are folded onto the line itself, which moves it
    by 2e-9 in both windows, and no drift shows it.
    """
    torus = lp.tori.period_lattice(momentum, state)
    omega = torus.frequencies
    slowest = np.abs(combinations_up_to(5 if len(omega) < 3 else 3, len(omega)) @ omega).min()
    window = 40 * 2 * np.pi / slowest
    n_samples = int(16 * np.abs(omega).sum() * window / np.pi)
    candidates, found = combinations_up_to(8, len(omega)), []
    for signal in signals:
        seen = lp.chaos.frequency_drift(
            momentum.system, torus.state, observable=signal, t_end=2 * window, window_order=3, n_samples=n_samples
        )
        distance = np.abs(candidates @ omega - seen.frequency[0, 0])
        assert distance.min() < 1e-9, (momentum, state, signal, seen.drift)  # measured up to 2e-10
        found.append(candidates[distance.argmin()])
    minors = [round(np.linalg.det([found[i] for i in some])) for some in combinations(range(len(found)), len(omega))]
    assert gcd(*minors) <= 1, "a lattice of which this is a part"  # 0: the strongest lines are dependent
