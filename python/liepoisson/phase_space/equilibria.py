r"""The search for equilibria on symplectic leaves and for relative equilibria.

An equilibrium of a Lie-Poisson system is a relative equilibrium of the system that it was reduced from: a steady
rotation, for a top. It is a critical point of H on its leaf, $\nabla H = \sum_k\lambda_k\nabla C_k$. With a further
integral K (such as $\ell_3$ of a Lagrange top) there are critical points of H on the common level set,
$\nabla H = \sum_k\lambda_k\nabla C_k + \Omega\nabla K$: the motion there is that of $\Omega K$ alone.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import ArrayLike

from liepoisson.arrays import Array
from liepoisson.errors import ParameterError
from liepoisson.numeric._checks import as_count, as_number, shown
from liepoisson.numeric.sampling import as_seed
from liepoisson.phase_space._checks import as_system
from liepoisson.phase_space.critical_points import HamiltonianFields, critical_points
from liepoisson.phase_space.leaf import Leaf, leaf_of
from liepoisson.phase_space.leaf_search import representative
from liepoisson.phase_space.stability import Equilibrium, analysis, integrals_of, not_tiny

if TYPE_CHECKING:
    from liepoisson.exact.phase_functions import PhaseFunction
    from liepoisson.exact.system import System

_FOUND = 1e-11
"""Relative residual up to which a state counts as a critical point that was found."""
_SAME, _SAME_ENERGY = 1e-6, 1e-9


def equilibria(
    system: System,
    leaf: Leaf | Mapping[str, float],
    *,
    along: Sequence[str] = (),
    values: Mapping[str, float] | None = None,
    n_starts: int = 200,
    seed: int = 0,
) -> list[Equilibrium]:
    r"""The equilibria on a leaf that Newton's method finds from many random starts.

    The list is what was found, and no proof that there are no others. `n_found` tells how often each was met; the sum
    over the list is the number of starts that converged, out of `n_starts`. Where many were met only once, another seed
    finds others: take more starts. The starts depend on the values of the Casimirs and the seed; the state from which a
    regular leaf was made does not matter.

    Equilibria that come in families (with the symmetry of the system, as circles) are listed once for each
    family, with the spectrum of one member: states with `nullity` above 0 that agree in energy and signature count as
    one family, so two families that are mirror images of each other are not told apart.

    Args:
        system: A system whose parameters are all numbers.
        leaf: The leaf, or the values of the Casimirs by name.
        along: Integrals, by their names in `system.invariants` or as formulas, for relative equilibria.
        values: Their values, by name.
        n_starts: Number of starts, random states projected to the leaf.
        seed: Draws them.

    Returns:
        The equilibria by increasing energy.

    Raises:
        LeafError: the Casimirs have no state, or the equations of the leaf are not known.
        ParameterError: `leaf` is neither a leaf of the system nor values of its Casimirs; `values` does not name the
            integrals of `along`; one of these is not constant, or has no motion of its own; or `n_starts` or `seed` is
            no whole number.

    References: [holm1985], for the equations.
    """
    system = as_system(system)
    leaf = _leaf(system, leaf)
    n_starts, seed = as_count(n_starts, "n_starts", least=1), as_seed(seed)
    integrals = integrals_of(system, along)
    wanted = _level(integrals, values, None)
    fields = HamiltonianFields(system, [system.functions.energy, *integrals.values()])
    origin = representative(leaf)
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(_STARTS_KEY,)))
    size = float(np.linalg.norm(origin.state)) / np.sqrt(len(origin.state)) or 1.0
    starts = rng.standard_normal((n_starts, len(origin.state))) * size
    starts *= np.exp(rng.uniform(np.log(0.2), np.log(5.0), (len(starts), 1)))
    states, residual = critical_points(origin, fields, starts, wanted)
    states, residual = states[residual <= _FOUND], residual[residual <= _FOUND]
    found: list[Equilibrium] = []
    for state in states[np.argsort(residual)]:
        _add(found, leaf, state, integrals)
    return sorted(found, key=lambda equilibrium: equilibrium.energy)


_STARTS_KEY = 5
"""Tells the stream of random numbers of the starts from other streams with the same seed."""


def _leaf(system: System, given: Any) -> Leaf:
    if isinstance(given, Leaf):
        if given.system is not system:
            raise ParameterError(
                f"leaf must be one of {shown(system)}; got one of {given.system.name!r}. Make it with "
                "leaf_of(system, x) or Leaf(system, casimirs)."
            )
        return given
    if not isinstance(given, Mapping):
        raise ParameterError(
            f"leaf must be a Leaf, or values of the Casimirs by name; got {shown(given)}. Write for example "
            "leaf_of(system, x)."
        )
    return Leaf(system, cast("Mapping[str, float]", given))


def relative_equilibrium(
    system: System,
    x_guess: ArrayLike,
    *,
    along: Sequence[str] = (),
    values: Mapping[str, float] | None = None,
) -> Equilibrium:
    r"""The relative equilibrium that Newton's method reaches from a guess.

    A critical point of H on the leaf of the guess and on the level set of the integrals,
    $f_H = \sum_j\Omega_j f_{K_j}$; without integrals an equilibrium.

    Args:
        system: A system whose parameters are all numbers.
        x_guess: One state, shape (N,); its leaf is kept.
        along: The integrals, by their names in `system.invariants` or as formulas; `along=("l3",)` for the steady
            precessions of a Lagrange top.
        values: Their values, by name; by default those of the guess.

    Raises:
        ParameterError: there is none near the guess, the guess is too near zero, an integral is not constant or has no
            motion of its own, or `values` does not name them.
        LeafError: the equations of the leaf are not known.
        ShapeError: `x_guess` is not one state.
    """
    leaf = not_tiny(leaf_of(system, x_guess), "x_guess")
    integrals = integrals_of(system, along)
    fields = HamiltonianFields(system, [system.functions.energy, *integrals.values()])
    states, residual = critical_points(leaf, fields, leaf.state[None], _level(integrals, values, leaf.state))
    if not len(states) or residual[0] > _FOUND:
        left = f"{residual[0]:.1e}" if len(residual) else "no state of the leaf"
        raise ParameterError(
            f"x_guess must be near a critical point of H on its leaf{_named(integrals)}; Newton's method ends with a "
            f"relative residual of {left}. Search with equilibria(system, leaf, along=..., values=...)."
        )
    return analysis(leaf, states[0], integrals)


def _level(integrals: Mapping[str, PhaseFunction], values: Mapping[str, float] | None, x: Array | None) -> Array:
    """The values of the integrals that are asked for, or those at x."""
    if values is None and x is not None:
        return np.array([float(f(x)) for f in integrals.values()])
    asked: Any = {} if values is None else values
    given: dict[str, Any] = dict(asked) if isinstance(asked, Mapping) else {"": None}
    named = set(given) == set(integrals)
    numbers = {name: as_number(given[name], f"values[{name!r}]", "a finite number") for name in integrals if named}
    if not named or not np.isfinite([*numbers.values()]).all():
        raise ParameterError(
            f"values must give a finite number for each integral of along, {', '.join(integrals) or 'none'}; "
            f"got {shown(asked)}. Write for example values={{'l3': 0.5}} with along=('l3',)."
        )
    return np.array([*numbers.values()])


def _named(integrals: Mapping[str, PhaseFunction]) -> str:
    return f" at fixed {', '.join(integrals)}" if integrals else ""


def _add(found: list[Equilibrium], leaf: Leaf, state: Array, integrals: Mapping[str, PhaseFunction]) -> None:
    """Add a state to the list, or count it where it, or its family, is there already."""
    size = float(np.linalg.norm(state))
    for k, known in enumerate(found):
        if np.linalg.norm(state - known.state) <= _SAME * size:
            found[k] = replace(known, n_found=known.n_found + 1)
            return
    new = analysis(leaf, state, integrals)
    for k, known in enumerate(found):
        if _same_family(known, new):
            found[k] = replace(known, n_found=known.n_found + 1)
            return
    found.append(new)


def _same_family(known: Equilibrium, new: Equilibrium) -> bool:
    """Whether two degenerate critical points agree in energy, constant on a family, and in the signs around them."""
    if not new.nullity or known.nullity != new.nullity or known.signature != new.signature:
        return False
    slope = float(np.linalg.norm(new.system.functions.energy.gradient(new.state)) * np.linalg.norm(new.state))
    return abs(known.energy - new.energy) <= _SAME_ENERGY * slope
