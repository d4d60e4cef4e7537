r"""Families whose period grows beyond all bounds, since their orbits pass equilibria ever more slowly.

Of a homoclinic orbit an orbit nearby differs by $\epsilon$ where both are far from the equilibrium.  It comes to the
distance $d \sim \sqrt\epsilon$ from it, and its period is about $2\ln(1/d)/\alpha$ longer than the time that both spend
elsewhere, for eigenvalues $\pm\alpha$ as for $\pm\alpha\pm i\omega$, where the energy turns again and again.

References: [henrard1973].
"""

from __future__ import annotations

import numpy as np

from liepoisson.equilibrium.leaf_equilibria import equilibrium_near
from liepoisson.errors import LeafError, ParameterError, TimeLimitError
from liepoisson.inputs.arrays import Array
from liepoisson.orbits.closed_orbits import SAME
from liepoisson.orbits.family_loops import FamilyLoop
from liepoisson.portable import linear

_NEAR = 3e-3
"""The distance, relative to the size of an orbit, at which it passes an equilibrium that its family ends at: steps are
given up when they are shorter than 1e-7, so that d is about the root of that, 3e-4; ten times as much is near, too."""
_PLACES = 2000
"""States of an orbit among which the slowest are looked for, about: it is slow there for a good part of its period."""
_SLOW, _MOST = 0.1, 16
"""States that are slower than this part of the fastest may be near an equilibrium; so many of them are tried."""


def slow_passages(loop: FamilyLoop) -> str:
    """The equilibria that a loop passes, in words as the end of a family; nothing where it passes none."""
    curve, chain = loop.curve, loop.loops.state[0]
    if curve.problem.momenta:  # these would be relative equilibria
        return ""
    try:
        part = np.full(len(chain), float(loop.loops.time[0]) / len(chain))
        path = curve.closing.flow.paths(chain, part, -(-_PLACES // len(chain)))[:, :-1].reshape(-1, chain.shape[1])
        found = _passed(loop, path)
    except TimeLimitError:
        return ""
    if not found:
        return ""
    if len(found) > 1:
        return f"orbits heteroclinic between {len(found)} equilibria"
    return f"orbits homoclinic to the equilibrium ({', '.join(f'{x:.6g}' for x in found[0])})"


def _passed(loop: FamilyLoop, path: Array) -> list[Array]:
    """The unstable equilibria near states of a loop, and their images under the symmetry that closes it."""
    curve, system, units = loop.curve, loop.curve.problem.system, loop.curve.units
    if curve.variable is not None:
        system, path, units = curve.variable.at(float(path[0, -1])), path[:, :-1], units[:-1]
    speed = linear.norm(system.vector_field(path) / units, axis=1)
    is_slow = (speed <= np.roll(speed, 1)) & (speed < np.roll(speed, -1)) & (speed < _SLOW * speed.max())
    slow = np.nonzero(is_slow)[0]
    found: list[Array] = []
    for k in slow[np.argsort(speed[slow], kind="stable")][:_MOST]:
        try:
            rest = equilibrium_near(system, path[k])
        except (ParameterError, LeafError):
            continue
        size = linear.norm((path - rest.state) / units, axis=1).max()
        if not (rest.growth_rate > 0 and linear.norm((path[k] - rest.state) / units) < _NEAR * size):
            continue
        image = rest.state if curve.problem.symmetry is None else curve.problem.symmetry(rest.state)
        for one in (rest.state, image):
            if not any(linear.norm((one - other) / units) < SAME * size for other in found):
                found.append(np.where(np.abs(one / units) < SAME * size, 0.0, one))
    return found
