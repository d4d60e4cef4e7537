r"""The stratum that a state lies on: which fields vanish or are parallel, and what is constant on its leaf.

The conditions of `Bracket.strata` are read as numbers here.  Fields have units of their own, which may differ by any
factor, so a field is zero if all its components are exactly zero; what is left of one by round-off is a field, and a
caller who means zero writes zero.  Two fields are parallel if they are to 1e-13, each relative to its own length, and
the rank is that of J in units in which its blocks are of order one.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from liepoisson.inputs.arrays import Array
from liepoisson.model.phase_functions import PhaseFunction, gradients_of
from liepoisson.portable import linear

if TYPE_CHECKING:
    from liepoisson.model.system import System
    from liepoisson.structure.bracket import Bracket
    from liepoisson.structure.locus import Locus, Stratum

PARALLEL, RANK = 1e-13, 1e-11
_BALANCING = 60
"""Steps in which the blocks of J are balanced; the distance from 1 of their logarithms is halved in each."""
MOST_COORDINATES = 16
"""Brackets beyond this size are not asked for their strata, which can take minutes; the rank of J decides."""


@dataclass(frozen=True)
class Place:
    """Where a state lies.

    Attributes:
        stratum: The condition in words, for example "beta = 0, alpha != 0".
        rank: The dimension of the leaf.
        is_open: Whether this is the open stratum, where the Casimirs C1, C2, ... of the bracket fix the leaf.
        casimirs: Functions that are constant on the leaf, by name.
        pinned: Orthonormal rows; their products with a state vanish on the leaf, shape (k, N).
        is_known: Whether functions and rows cut out the leaf; False for a set of lower rank that is not listed, and on
            the open stratum if fewer Casimirs are known than cut out its leaves.
    """

    stratum: str
    rank: int
    is_open: bool
    casimirs: dict[str, PhaseFunction]
    pinned: Array
    is_known: bool


def place_of(system: System, x: Array) -> Place:
    """The place of one state, shape (N,).

    Where J is linear without a constant part, the conditions are homogeneous: x and any multiple of it lie on one
    stratum, and the multiple by a power of two neither overflows nor underflows, for which the largest and the smallest
    field are as far above one as below it.
    """
    if system.bracket.is_linear and not system.bracket.constant and x.any():
        largest = np.abs(x.reshape(-1, system.bracket.field_lengths[0])).max(axis=1)
        exponents = np.frexp(largest[largest > 0])[1]
        x = np.ldexp(x, -int(exponents.max() + exponents.min()) // 2)
    rank = numeric_rank(system, x)
    listed = strata_of(system.bracket)
    for k, stratum in enumerate(listed):
        by_rank = bool(stratum.locus.vanishing or stratum.locus.not_all_vanish)
        if (stratum.rank == rank or (stratum.proved and not by_rank)) and _holds(stratum.locus, system.bracket, x):
            place = _place(system, stratum, x, is_open=k == 0)
            if _cuts_out(place, x, system.bracket):
                return place
            is_open = k == 0 and rank == stratum.rank and system.bracket.n_unknown_casimirs > 0
            return replace(place, is_known=False) if is_open else _unlisted(system, rank)
    if not listed and rank == system.bracket.rank():
        place = open_place(system)
        return place if not place.is_known or _cuts_out(place, x, system.bracket) else _unlisted(system, rank)
    return _unlisted(system, rank)


def open_place(system: System) -> Place:
    """The open stratum, whose leaves are level sets of the Casimirs."""
    listed = strata_of(system.bracket)
    words, rank = (listed[0].condition, listed[0].rank) if listed else ("generic", system.bracket.rank())
    n, casimirs = system.bracket.dimension, system.functions.casimirs
    return Place(words, rank, True, casimirs, np.zeros((0, n)), is_known=not system.bracket.n_unknown_casimirs)


def numeric_rank(system: System, x: Array) -> int:
    """The rank of J at one state; singular values below 1e-11 of the largest count as zero, in balanced units."""
    poisson = system.functions.poisson_tensor(x)
    n = system.bracket.field_lengths[0]
    sizes = linear.svd(_balanced(np.asarray(poisson), n), compute_uv=False)
    return int(np.sum(sizes > RANK * sizes[0])) if sizes.size and sizes[0] > 0 else 0


def _balanced(poisson: Array, n: int) -> Array:
    r"""$DJD$ with one number for each field in D, such that the largest entry of each row of blocks is about 1."""
    k = len(poisson) // n
    blocks = np.abs(poisson).reshape(k, n, k, n).max(axis=(1, 3))
    units = np.ones(k)
    for _ in range(_BALANCING):
        rows = (units[:, None] * blocks * units).max(axis=1)
        units = np.where(rows > 0, units / np.sqrt(np.where(rows > 0, rows, 1.0)), units)
    factors = np.repeat(units, n)
    return factors[:, None] * poisson * factors


@lru_cache(maxsize=32)
def strata_of(bracket: Bracket) -> tuple[Stratum, ...]:
    """The strata of a bracket, computed once; none for a large one."""
    return tuple(bracket.strata()) if bracket.dimension <= MOST_COORDINATES else ()


def _place(system: System, stratum: Stratum, x: Array, *, is_open: bool) -> Place:
    functions = system.functions
    if is_open:
        casimirs = functions.casimirs
    else:
        from liepoisson.report.vector_notation import VectorNotation

        notation = VectorNotation(system.bracket)
        # Where J vanishes the coordinates are constant, and the rows say so already.
        own = stratum.casimirs if stratum.rank else ()
        # They have no other name than what they are: l.alpha.
        casimirs = {notation.formula(casimir).plain: functions.of(casimir) for casimir in own}
    functions_there = [functions.of(f) for f in stratum.locus.vanishing]
    pinned = np.concatenate([_pinned(stratum.locus, system.bracket, x), gradients_of(functions_there, x)])
    pinned = pinned[linear.norm(pinned, axis=-1) > 0]
    return Place(stratum.condition, stratum.rank, is_open, casimirs, pinned, is_known=True)


def _unlisted(system: System, rank: int) -> Place:
    words = f"J has rank {rank} here; a stratum that is not listed"
    pinned = np.zeros((0, system.bracket.dimension))
    return Place(words, rank, False, system.functions.casimirs, pinned, is_known=False)


def _cuts_out(place: Place, x: Array, bracket: Bracket) -> bool:
    """Whether gradients and rows span the normal space of the leaf, of dimension N - rank, at this state."""
    if not place.rank:
        return True
    lengths = linear.norm(x.reshape(-1, bracket.field_lengths[0]), axis=1)
    units = np.repeat(np.where(lengths > 0, lengths, lengths.max() or 1.0), bracket.field_lengths[0])
    rows = gradients_of(list(place.casimirs.values()), x) * units
    largest = np.abs(rows).max(axis=-1, keepdims=True, initial=0.0)  # whose squares may overflow or underflow
    rows = np.divide(rows, largest, out=np.zeros_like(rows), where=largest > 0)
    lengths = linear.norm(rows, axis=-1, keepdims=True)
    rows = np.divide(rows, lengths, out=np.zeros_like(rows), where=lengths > 0)
    pinned = place.pinned * units
    pinned /= linear.norm(pinned, axis=-1, keepdims=True)
    sizes = linear.svd(np.concatenate([pinned, rows]), compute_uv=False)
    return int(np.sum(sizes > RANK)) == len(x) - place.rank


def _field(bracket: Bracket, name: str, x: Array) -> Array:
    n, k = bracket.field_lengths[0], bracket.field_names.index(name)
    return x[k * n : (k + 1) * n]


def _holds(locus: Locus, bracket: Bracket, x: Array) -> bool:
    fields = {name: _field(bracket, name, x) for name in bracket.field_names}
    return (
        not any(fields[name].any() for name in locus.zero)
        and all(any(fields[name].any() for name in names) for names in locus.nonzero)
        and all(_are_parallel(fields[u], fields[v]) for u, v in locus.parallel)
        and not any(_are_parallel(fields[u], fields[v]) for u, v in locus.not_parallel)
    )


def _are_parallel(u: Array, v: Array) -> bool:
    directions = [w / np.abs(w).max() if w.any() else w for w in (u, v)]
    sizes = linear.svd(np.stack(directions), compute_uv=False)
    return bool(sizes[1] <= PARALLEL * sizes[0])


def _pinned(locus: Locus, bracket: Bracket, x: Array) -> Array:
    """The linear equations of the set: fields that vanish, and p u - q v = 0 for two parallel ones."""
    n, names, N = bracket.field_lengths[0], bracket.field_names, bracket.dimension
    weights: list[Any] = [np.eye(len(names))[names.index(name)] for name in locus.zero]
    for pair in locus.parallel:
        fields = np.stack([_field(bracket, name, x) for name in pair])
        row = np.zeros(len(names))
        row[[names.index(name) for name in pair]] = linear.svd(fields)[0][:, 1]
        weights.append(row)
    rows: list[Array] = [np.kron(row[None, :], np.eye(n)) for row in weights]
    return np.concatenate(rows) if rows else np.zeros((0, N))
