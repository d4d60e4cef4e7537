r"""States where a Hamiltonian is flat only because it decays: $e^q$ has no critical point, but at q = -38 it looks so.

Newton's method runs along such a tail until the slope is below round-off, and there every residual is small. What
tells a tail from a critical point is how the slope changes: at a critical point it vanishes, or is a power of the
distance; on a tail it is a smooth function that has no zero nearby, and decays by a share of itself on the way of a
share of the length of the state. Doubles do not see this (the slope of tanh(q) is zero to round-off from q = 19 on),
so it is evaluated with more digits.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from liepoisson.arrays import Array

if TYPE_CHECKING:
    from liepoisson.exact.phase_functions import PhaseFunction

_WINDOW = np.linspace(-0.002, 0.002, 5)
"""Where the slope is compared, relative to the length of the state."""
_LEAST, _MOST = 0.02, 7.0
"""What ln|slope| changes by on the window: a constant slope is none of a tail, and 7 is more than tails have that reach
round-off; near a critical point of any degree it is more, or the slope changes its sign."""
_CURVED = 0.1
"""Third differences of ln|slope| relative to the first ones; those of noise are as large as they are."""
_DIGITS = 50


def is_on_a_tail(energy: PhaseFunction, state: Array, directions: Array, length: float) -> bool:
    r"""Whether the Hamiltonian decays along the flat directions at a state, instead of being critical there.

    Args:
        energy: The Hamiltonian H; a polynomial has no such tails.
        state: The state, shape (N,).
        directions: Directions in which the second variation is soft or flat, shape (N, n).
        length: The length of the state, by which distances are measured.
    """
    from sympy import log

    if not directions.shape[1]:
        return False
    along = directions @ (directions.T @ energy.exact_gradient(state, digits=_DIGITS))
    size = max(map(abs, along))
    if not size:
        return False
    direction = np.array([float(part / size) for part in along])
    direction /= np.linalg.norm(direction)
    nearby = state + np.outer(_WINDOW * length, direction)
    slopes = [sum(direction * energy.exact_gradient(x, digits=_DIGITS)) for x in nearby]
    if not (all(slope > 0 for slope in slopes) or all(slope < 0 for slope in slopes)):
        return False
    logarithms = np.array([float(log(abs(slope))) for slope in slopes])
    steps = np.diff(logarithms)
    monotonic = bool((steps > 0).all() or (steps < 0).all())
    smooth = np.abs(np.diff(steps, 2)).max() <= _CURVED * np.abs(steps).min()
    return monotonic and smooth and _LEAST <= abs(steps.sum()) <= _MOST
