"""Levels: the states with given values of the Hamiltonian and of the Casimirs, on which orbits of one energy live."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from liepoisson.algebra.exact_numbers import Exact, to_sympy
from liepoisson.errors import LeafError, ParameterError
from liepoisson.formula.parameters import read_parameter
from liepoisson.inputs.arrays import Array, ReadOnlyArrays
from liepoisson.inputs.given import named
from liepoisson.inputs.refusals import shown
from liepoisson.leaf._checks import are_equal, as_energy, as_system, by_name
from liepoisson.leaf.leaf import Leaf
from liepoisson.leaf.leaf_in_units import unit_groups
from liepoisson.model.phase_functions import PhaseFunction
from liepoisson.numeric.time_scale import balanced
from liepoisson.portable import elementary, linear
from liepoisson.structure.casimir_part import ORDINARY, difference

if TYPE_CHECKING:
    from liepoisson.model.system import System

_MOST_STEPS = 60
_ON_LEVEL = 1e-13
_INDEPENDENT = 1e-9


@dataclass(frozen=True, eq=False)
class Level(ReadOnlyArrays):
    """The states of a regular leaf with one energy.

    Attributes:
        system: The system.
        leaf: The leaf.
        values: The values of H and of the Casimirs by name, exact: texts as they were given, doubles as the rational
            numbers that they are.
        units: Sizes of the components, in which states of the level are of order one, shape (N,).
    """

    system: System
    leaf: Leaf
    values: Mapping[str, Exact]
    units: Array

    @property
    def functions(self) -> dict[str, PhaseFunction]:
        """The moving part of H, see `System.moving`, and the Casimirs, by name."""
        return {"H": self.system.moving.functions.energy, **self.system.functions.casimirs}

    @cached_property
    def constants(self) -> Mapping[str, Exact]:
        """The exact values of `functions`."""
        still = self._still
        return self.values if still == 0 else {**self.values, "H": difference(self.values["H"], still)}

    @cached_property
    def _still(self) -> Exact:
        """What H is more than its moving part."""
        part, casimirs = self.system.casimir_part, [self.values[name] for name in self.system.functions.casimirs]
        other = 0.0 if part.other is None else float(self.system.functions.of(part.other)(self.leaf.state))
        return part.value(casimirs, other)

    def through(self, state: Array) -> Level:
        """The level of the same leaf with the energy of a state, without the round-off of what does not move."""
        return self.through_each(state[None])[0]

    def through_each(self, states: Array) -> list[Level]:
        """Those of several states, shape (n, N)."""
        less = difference(Fraction(0), self._still)
        moving = map(Fraction, self.functions["H"](states).tolist())
        return [replace(self, values={**self.values, "H": difference(energy, less)}) for energy in moving]

    def in_units_of(self, states: Array) -> Level:
        r"""The level in units that are the sizes of states, such as those of an orbit; itself where it nearly is.

        Sizes are root mean squares.  Components of one field have one size, the largest in it.  Canonical coordinates
        have each their own, and one of them may be small by accident; of them the ratios are those that make rows and
        columns of Df about equal, and $u_q u_p$ is the same for all pairs.
        """
        states = states[np.isfinite(states).all(axis=1)]
        if not len(states):
            return self
        largest = np.abs(states).max(axis=0, initial=0.0)
        sizes = largest * np.sqrt(((states / np.where(largest > 0, largest, 1.0)) ** 2).mean(axis=0))
        bracket = self.system.bracket
        if not bracket.is_linear or bracket.entries():
            groups = np.array(unit_groups(bracket))
            sizes = np.array([sizes[groups == k].max() for k in groups])
        else:
            ratios = self._ratios(states)
            sizes = ratios * (sizes / ratios).max()
        sizes = np.where((sizes > 0) & np.isfinite(sizes), sizes, self.units)
        units = elementary.exp2(np.round(elementary.log2(sizes)))
        is_near = np.abs(elementary.log2(units / self.units)).max() < elementary.log2(ORDINARY)
        return self if is_near else replace(self, units=units)

    def _ratios(self, states: Array) -> Array:
        """Units of canonical coordinates, up to a common factor, in which they act on one another equally strongly."""
        slopes = np.abs(self.system.functions.jacobian(states))
        slopes = slopes[np.isfinite(slopes).all(axis=(1, 2))]
        if not len(slopes):
            return self.units
        ratios = self.units * balanced(np.median(slopes, axis=0)[None] * self.units / self.units[:, None])[1][0]
        pairs = [pair for pair in self.system.bracket.constant if pair[0] < pair[1]]
        if len({k for pair in pairs for k in pair}) == 2 * len(pairs):
            for i, j in pairs:
                action = np.sqrt(ratios[i] * ratios[j])
                ratios[i], ratios[j] = ratios[i] / action, ratios[j] / action
        return ratios

    def constant(self, name: str) -> float:
        """The value of one of `functions` as a double."""
        return _double(self.constants[name])

    def number(self, name: str) -> float:
        """The value of H or of a Casimir as a double."""
        return _double(self.values[name])

    @property
    def dimension(self) -> int:
        """The dimension of the level, rank J - 1."""
        return self.leaf.rank - 1

    @property
    def text(self) -> str:
        """The values in words: "H = 1/2, C1 = 1"."""
        return ", ".join(f"{name} = {short(value)}" for name, value in self.values.items())

    def deviations(self, states: Array) -> Array:
        """How far H and the Casimirs are from their values, shape (..., function)."""
        wanted = [*map(_double, self.constants.values())]
        return np.stack([f(states) - c for f, c in zip(self.functions.values(), wanted, strict=True)], axis=-1)

    def gradients(self, states: Array) -> Array:
        """The gradients of H and the Casimirs, shape (..., function, N)."""
        return np.stack([f.gradient(states) for f in self.functions.values()], axis=-2)

    @np.errstate(all="ignore")  # functions need not exist at guesses; such states do not converge
    def projected(self, states: Array, directions: Array) -> tuple[Array, np.ndarray[Any, np.dtype[np.bool_]]]:
        """States moved onto the level along some directions by Newton steps of minimum norm, and which arrived.

        Args:
            states: Guesses, shape (n, N).
            directions: Columns along which they may be moved, shape (N, d) or (n, N, d).
        """
        x, is_ordinary = states.copy(), bool((self.units == 1).all())
        if not is_ordinary:
            directions = directions * linear.norm(directions * self.units[:, None], axis=-2)[..., None, :]
        for _ in range(_MOST_STEPS):
            rest = self.deviations(x)
            slopes = linear.matmul(self.gradients(x), directions)
            good = np.isfinite(rest).all(axis=-1) & np.isfinite(slopes).all(axis=(-1, -2))
            if not is_ordinary:
                lengths = np.maximum(linear.norm(slopes, axis=-1), np.finfo(float).tiny)
                slopes, rest = slopes / lengths[..., None], rest / lengths
            slopes[~good], rest[~good] = 0.0, 0.0
            move = -linear.einsum("nij,nj->ni", linear.pinv(slopes, rcond=1e-10), rest)
            step = linear.einsum("...ij,...j->...i", directions, move)
            size = linear.norm(step / self.units, axis=-1, keepdims=True)
            x = x + step / np.maximum(1.0, 2.0 * size)
            if size.max(initial=0.0) < 1e-15:
                break
        return x, self.distance(x) < _ON_LEVEL

    def distance(self, states: Array) -> Array:
        """The largest deviation of H and the Casimirs, relative to the size of their terms, shape (...)."""
        scale = linear.matmul(np.abs(self.gradients(states)), self.units)
        with np.errstate(divide="ignore", invalid="ignore"):
            found = np.abs(self.deviations(states)) / np.maximum(scale, 1e-300)
        return np.where(np.isfinite(found), found, np.inf).max(axis=-1)

    def is_regular_at(self, states: Array) -> np.ndarray[Any, np.dtype[np.bool_]]:
        """Whether dH and the dC are independent at states, shape (...)."""
        slopes = self.gradients(states) * self.units
        slopes = slopes / np.maximum(linear.norm(slopes, axis=-1, keepdims=True), 1e-300)
        return linear.svd(slopes, compute_uv=False)[..., -1] > _INDEPENDENT


def _double(value: Exact) -> float:
    return float(cast("Any", to_sympy(value)))


def short(value: Exact) -> str:
    """A value as text: a fraction if it is a short one, else a decimal of twelve digits."""
    if isinstance(value, Fraction):
        return str(value) if value.denominator < 10**6 and abs(value) < 10**12 else f"{float(value):.12g}"
    return str(value)


def level_of(system: System, leaf: Leaf | Mapping[str, float | str], energy: float | str) -> Level:
    """A level of a system.

    Args:
        system: A system whose parameters are all numbers.
        leaf: The leaf, or the values of the Casimirs by name.
        energy: The value of the Hamiltonian.

    Raises:
        LeafError: no state has these values of the Casimirs, or the leaf is not regular.
        ParameterError: `leaf` is neither a leaf of the system nor values of its Casimirs, a value is not finite, or the
            Hamiltonian depends on time.
    """
    system = as_system(system)
    if system.clock is not None:
        raise ParameterError(
            f"system: wanted one whose Hamiltonian does not depend on time, so that orbits close; got {system.name}, "
            f'whose t grows. The derivative of return_map(system, "{system.clock}", t_end=...) leads to fixed points.'
        )
    given: Any = leaf
    if isinstance(given, Leaf):
        if not are_equal(given.system, system):
            raise ParameterError(f"leaf must be one of {shown(system)}; got one of {given.system.name!r}.")
        values: dict[str, Any] = {name: Fraction(value) for name, value in given.casimirs.items()}
    elif (casimirs := named(given, "leaf")) is not None:
        values = {name: _as_exact(value, name) for name, value in by_name(system, casimirs).items()}
        given = Leaf(system, casimirs)
    else:
        raise ParameterError(
            f"leaf must be a Leaf, or values of the Casimirs by name; got {shown(given)}. Write for example "
            "Leaf.through(system, state)."
        )
    if not given.is_regular or not given.place.is_known:
        raise LeafError(
            f"leaf must be a regular one, where J has its largest rank and H and all Casimirs say which states belong "
            f"to a level; got {given!r}"
        )
    number = as_energy(energy)
    exact = {"H": _as_exact(energy, "energy"), **{name: values[name] for name in system.functions.casimirs}}
    return Level(system, given, exact, np.array(given.in_units(number).units, dtype=np.float64))


def _as_exact(value: Any, name: str) -> Exact:
    """The number as it was given: a text is exact, a double is the rational number that it is."""
    if isinstance(value, str):
        return read_parameter(value, name)
    return Fraction(as_energy(value, name))
