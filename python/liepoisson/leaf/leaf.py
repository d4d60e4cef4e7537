r"""Symplectic leaves: the sets on which a Lie-Poisson system lives.

A leaf is the orbit of a state under all Hamiltonian flows (a coadjoint orbit).  Its tangent space at x is the image of
$J(x)$, its dimension the rank of $J$.  On the open stratum it is a level set of the Casimirs; where the rank drops,
fields vanish or are parallel, and other functions are constant.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson.errors import LeafError, ParameterError, ShapeError
from liepoisson.formula.scalars import as_number, as_phase_points
from liepoisson.inputs.arrays import Array, read_only
from liepoisson.inputs.calls import explains_its_arguments, explains_its_methods
from liepoisson.inputs.given import named
from liepoisson.inputs.refusals import shown
from liepoisson.io.display import as_line, as_table
from liepoisson.leaf._checks import as_energy, as_system, by_name, formulas
from liepoisson.leaf.leaf_in_units import LeafInUnits, scaling, unit_groups
from liepoisson.leaf.leaf_projection import CONVERGED, Equations, approach, mixing_of
from liepoisson.leaf.leaf_stratum import Place, open_place, place_of
from liepoisson.model.phase_functions import PhaseFunction
from liepoisson.portable import linear
from liepoisson.structure.casimir_part import difference
from liepoisson.structure.casimirs import shortage

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.algebra.exact_numbers import Exact
    from liepoisson.model.system import System


_ON_LEAF = 1e-10
"""Relative residual up to which `Leaf.contains` says that a state is on a leaf."""


@explains_its_methods
class Leaf:
    r"""A symplectic leaf, given by the values of the Casimirs C1, C2, ... of the open stratum.

    A level set may consist of several leaves, such as the two sheets of a hyperboloid; they are not told apart.
    Leaves of lower rank come from a state, see `Leaf.through`.

    Example:
        >>> leaf = lp.Leaf(lp.catalog.system("heavy-top"), {"l.alpha": 0, "|alpha|^2": 1})
        >>> leaf
        <Leaf of dimension 4 of 'heavy-top', alpha != 0: C1 = 0, C2 = 1>
        >>> round(leaf.energy_range()[0], 9)  # the hanging top
        -1.0

    Args:
        system: A system whose parameters are all numbers.
        casimirs: A value for each Casimir, by name or formula: `{"C1": 1.2, "C2": 0.3, "C3": 1}`, or
            `{"l.alpha": "1/5", "|alpha|^2": 1}` where these are the Casimirs.

    Raises:
        LeafError: no state was found with these values, or those found lie on leaves of lower rank, of which the
            values determine none; or too few Casimirs are known.
        ParameterError: a name is missing or unknown, a value is not finite, or a parameter of the system has no number.

    References: [marsden1999], chapter 14.
    """

    @explains_its_arguments
    def __init__(self, system: System, casimirs: Mapping[str, float | str]) -> None:
        from liepoisson.leaf.leaf_search import find_state

        place = open_place(as_system(system))
        if not place.is_known:
            raise LeafError(_unknown(system, place))
        values = _values(system, casimirs, place)
        moving = system.moving
        own = place if moving is system else open_place(moving)
        self._set(system, place, values, find_state(moving, own, values))

    @classmethod
    def through(cls, system: System, state: ArrayLike) -> Leaf:
        """The symplectic leaf through a state.

        Args:
            system: A system whose parameters are all numbers.
            state: One state, shape (N,). A field is zero where all its components are exactly 0: fields have different
                units, and no number is small by itself. Set to 0 what only round-off keeps from it.

        Raises:
            ShapeError: not one state of N components.
            ParameterError: a component or a Casimir is not finite, or a parameter of the system has no number.
        """
        bracket = as_system(system).bracket
        x = as_phase_points(state, bracket.coordinate_names_in_order, bracket.field_names, "state")
        if x.ndim != 1:
            raise ShapeError(f"state must be one state, shape ({x.shape[-1]},); got shape {x.shape}. Pass one of them.")
        x = _finite(x, "state")
        leaf = cls.__new__(cls)
        place = place_of(system, x)
        with np.errstate(over="ignore", invalid="ignore"):
            values = np.array([float(f(x)) for f in place.casimirs.values()])
        if not np.isfinite(values).all():
            shown_values = dict(zip(place.casimirs, values.tolist(), strict=True))
            raise ParameterError(
                f"the Casimirs at the state must be finite doubles; got {shown_values}. Choose units in which it is "
                "smaller, or a state where they are defined."
            )
        leaf._set(system, place, values, x)
        return leaf

    def _set(self, system: System, place: Place, values: Array, state: Array) -> None:
        self.system: System = system
        self.place: Place = place
        self.state: Array = read_only(state)
        self._values = values

    @cached_property
    def moving(self) -> Leaf:
        """The leaf of the system without what in H is a function of the Casimirs; the leaf itself if nothing is.

        It has the same states and the same motion on them, with other energies, see `moving_energy`.
        """
        system = self.system.moving
        if system is self.system or not self.rank:
            return self
        leaf = type(self).__new__(type(self))
        leaf._set(
            system, open_place(system) if self.is_regular else place_of(system, self.state), self._values, self.state
        )
        leaf.still_energy = self.still_energy
        return leaf

    @cached_property
    def still_energy(self) -> float:
        """What is added to energies of the moving part: the function of the Casimirs in H, on this leaf."""
        return float(cast("Any", self._still))

    @cached_property
    def _still(self) -> Exact:
        part = self.system.casimir_part
        if part.moving is None or not self.rank:
            return Fraction(0)
        functions = self.system.functions.casimirs
        values = self._values if self.is_regular else [float(f(self.state)) for f in functions.values()]
        other = 0.0 if part.other is None else float(self.system.functions.of(part.other)(self.state))
        return part.value([Fraction(float(c)) for c in values], other)

    def moving_energy(self, energy: float) -> float:
        """The energy of the moving part of H where H has this one."""
        if self.moving is self:
            return energy
        return float(cast("Any", difference(Fraction(energy), self._still)))

    @property
    def rank(self) -> int:
        """The dimension of the leaf, an even number."""
        return self.place.rank

    @property
    def stratum(self) -> str:
        """Where in phase space the leaf lies, for example "beta != 0"."""
        return self.place.stratum

    @property
    def is_regular(self) -> bool:
        """Whether the leaf lies in the open stratum, where the rank is the largest."""
        return self.place.is_open

    @property
    def casimirs(self) -> dict[str, float]:
        """The values of the Casimirs: C1, C2, ... on the open stratum, else named by their formulas."""
        return dict(zip(self.place.casimirs, self._values.tolist(), strict=True))

    @property
    def casimir_functions(self) -> dict[str, PhaseFunction]:
        """The functions that are constant on the leaves of this stratum, by the names of `casimirs`."""
        return dict(self.place.casimirs)

    @property
    def caution(self) -> str:
        """Why the values of `casimirs` do not say which leaf this is; empty if they do, with the stratum.

        The leaf is then contained in their level set, and may be smaller.
        """
        if self.place.is_known:
            return ""
        missing = shortage(self.system.bracket) if self.is_regular else "the equations are not known"
        return f"{missing}: the leaf may be a smaller part of this level set"

    @cached_property
    def equations(self) -> Equations:
        """Independent equations of the leaf, N - rank of them.

        Raises:
            LeafError: they are not known, as this set of lower rank is not listed, or too few Casimirs are known.
        """
        if not self.place.is_known:
            raise LeafError(_unknown(self.system, self.place))
        functions, pinned = tuple(self.place.casimirs.values()), self.place.pinned
        mixing = mixing_of(functions, pinned, self.state, len(self.state) - self.rank if self.rank else len(pinned))
        return Equations(pinned, functions, self._values, mixing)

    def in_units(self, energy: float | str | None = None) -> LeafInUnits:
        """The moving leaf in coordinates in which its states, perhaps those of an energy of H, are of order one."""
        if energy is None:
            return self.moving._in_units
        return self.moving._divided(self.moving_energy(as_energy(energy)))

    @cached_property
    def _in_units(self) -> LeafInUnits:
        return self._divided(None)

    def _divided(self, energy: float | None) -> LeafInUnits:
        units = scaling(self.system, self.place.casimirs, self._values, energy, self.state)
        return LeafInUnits(repr(self), self.system, self.rank, self.state, self.constraints, units, self.still_energy)

    def residual(self, states: ArrayLike) -> Array:
        r"""The largest relative violation of the equations, shape (...).

        That of $f = c$ is $|f - c| / (|c| + \sum_b(|x_b| + 2^{-52}u_b)|\nabla_b f|)$ with the fields $x_b$, whose units
        do not matter, and their units $u_b$ on the leaf (see `scaling`): what is left of a field that vanishes is
        no violation.
        On a stratum that is not listed, and where not all Casimirs are known, only the known ones are compared:
        necessary, not sufficient.
        """
        groups = unit_groups(self.system.bracket)
        units = np.zeros(1 + max(groups))
        np.maximum.at(units, list(groups), np.finfo(float).eps * self.in_units().units)
        if self.place.is_known:
            equations = replace(self.equations, groups=groups, unit=units)
        else:
            functions = tuple(self.place.casimirs.values())
            equations = Equations(self.place.pinned, functions, self._values, np.eye(len(functions)), groups, units)
        return equations.residual(self._points(states))

    def contains(self, states: ArrayLike, tol: float = 1e-10) -> NDArray[np.bool_]:
        """Whether the states lie on the leaf to a relative tolerance, shape (...).

        Raises:
            LeafError: a state has the same values of the known functions, and not all equations of the leaf are known.
        """
        close = self.residual(states) <= as_number(tol, "tol", "a number >= 0")
        if not self.place.is_known and np.any(close):
            raise LeafError(_unknown(self.system, self.place))
        return close

    def project(
        self, states: ArrayLike, *, energy: float | None = None, surface: str | Expr | PhaseFunction | None = None
    ) -> Array:
        """States on the leaf near the given ones, by Newton steps of minimum norm, to round-off.

        Lengths are those in units of the fields in which states of the leaf are of order one (see
        `liepoisson.leaf.leaf_in_units`).

        Args:
            states: States, shape (..., N).
            energy: The value that the Hamiltonian shall have.
            surface: A function that shall vanish: text, SymPy expression or PhaseFunction.

        Raises:
            LeafError: Newton's method does not converge for one of the states, so there is most likely no such state
                nearby; the message gives the residuals, or the range of the energy if one outside was asked for.
            ShapeError: the last axis of `states` is not N.
        """
        if self.moving is not self:
            surface = None if surface is None else self.system.functions.of(surface)
            level = None if energy is None else self.moving_energy(as_energy(energy))
            return self.moving.project(states, energy=level, surface=surface)
        states, view = self._points(states), self.in_units(energy)
        equations = view.constraints(energy, surface)
        found, residual = approach(equations, states.reshape(-1, states.shape[-1]) / view.units)
        residual[~are_on(self, found * view.units, energy)] = np.inf
        if found.size and not residual.max() <= CONVERGED:
            self._refuse(equations, found, residual, energy)
        return (found * view.units).reshape(states.shape)

    def constraints(self, energy: float | None, surface: str | Expr | PhaseFunction | None = None) -> Equations:
        """The equations of the leaf, and those of the energy surface and of a surface f = 0."""
        equations, functions = self.equations, self.system.functions
        if energy is not None:
            moving = self.moving.system.functions.energy
            equations = equations.with_function(moving, self.moving_energy(as_energy(energy)))
        if surface is not None:
            equations = equations.with_function(functions.of(surface), 0.0)
        return equations

    def tangent_projector(self, states: ArrayLike, *, energy: bool = False) -> Array:
        """Orthogonal projectors onto the tangent spaces of the leaf (of the energy surface on it), shape (..., N, N).

        The tangent space is the image of J, spanned by the singular vectors of its `rank` largest singular values.
        At an equilibrium, where the energy surface has no tangent space, the one of the leaf is returned.

        Raises:
            LeafError: J has another rank at one of the states.
        """
        states = self._points(states)  # once, as they are read twice
        basis = self.tangent_basis(states)
        projector = linear.matmul(basis, np.swapaxes(basis, -1, -2))
        if not energy:
            return projector
        moving = self.moving.system.functions.energy
        slope = linear.einsum("...ij,...j->...i", projector, moving.gradient(states))
        length = linear.norm(slope, axis=-1, keepdims=True)
        normal = np.divide(slope, length, out=np.zeros_like(slope), where=length > 0)
        return projector - normal[..., :, None] * normal[..., None, :]

    def tangent_basis(self, states: ArrayLike) -> Array:
        """Orthonormal bases of the tangent spaces of the leaf, as columns, shape (..., N, rank).

        Raises:
            LeafError: J has another rank at one of the states.
            ParameterError: a state is not finite.
        """
        states = _finite(self._points(states), "states")
        vectors, sizes, _ = linear.svd(self.system.functions.poisson_tensor(states))
        if self.rank and not np.all(sizes[..., self.rank - 1] > 0):
            raise LeafError(
                f"J must have rank {self.rank} on this leaf; it is lower at one of the states. Project them."
            )
        return vectors[..., : self.rank]

    def project_tangent(self, states: ArrayLike, vectors: ArrayLike, *, energy: bool = False) -> Array:
        """The parts of the vectors, shape (..., N), that are tangent to the leaf (to its energy surface).

        Raises:
            LeafError: J has another rank at one of the states.
            ParameterError: `states` or `vectors` has a NaN or an infinity.
        """
        vectors = _finite(self._points(vectors), "vectors")
        return linear.einsum("...ij,...j->...i", self.tangent_projector(states, energy=energy), vectors)

    def energy_range(self) -> tuple[float, float]:
        """The lowest and the highest energy on the leaf, -inf and inf where the energy is unbounded.

        By minimising from up to 65 states, for at most 5 s of processor time at each end: what is returned was reached,
        but nothing proves that it is the global extremum.  Infinite is what grows with the distance, or comes 10^4
        times as far as the leaf's own state or 10^9 times as deep as the median of |H| at the starts.

        Raises:
            LeafError: the energy is not defined there, or the equations of the leaf are not known.
        """
        return self._energy_range

    @cached_property
    def _energy_range(self) -> tuple[float, float]:
        from liepoisson.leaf.leaf_search import energy_range

        lowest, highest = energy_range(self.moving)
        return (lowest, highest) if self.moving is self else (lowest + self.still_energy, highest + self.still_energy)

    def sample(
        self, n_starts: int, *, seed: int = 0, energy: float | None = None, energy_below: float | None = None
    ) -> Array:
        r"""Random states on the leaf with the Liouville measure, shape (n, N).

        Independent states for a top, unless fewer than one in 50 000 proposals would be accepted, as within about
        1e-3 of the least energy.  There, and for all other systems, a population of Markov chains descends from a large
        set to this one: approximate and correlated.  The share p of a part of the set that no chain leaves has a
        standard error of about $\sqrt{p(1-p)k/2048}$, however large n is, where k counts the halvings of the volume
        after the parts separated (some 5 at usual energies, 30 close to the least one).  A leaf is sampled the same
        way, whether made from values or from a state.  See `liepoisson.leaf.chain_sampling`.

        Warns `MixingWarning` if the chains remember their starts in the largest set: their shares are then arbitrary.

        Args:
            n_starts: How many.
            seed: Draws them.
            energy: Only states of this energy, with the microcanonical measure, which the flow preserves.
            energy_below: Only states of at most this energy.

        Raises:
            LeafError: the set is empty or has infinite volume.
            ParameterError: both energies are given, n or seed is no whole number, or the Lie algebra is not unimodular.
        """
        from liepoisson.leaf.leaf_sampling import sample_leaf

        level, below = (
            None if value is None else self.moving_energy(as_energy(value, name))
            for name, value in (("energy", energy), ("energy_below", energy_below))
        )
        return sample_leaf(self.moving, n_starts, seed=seed, energy=level, energy_below=below)

    def _points(self, x: ArrayLike) -> Array:
        bracket = self.system.bracket
        return as_phase_points(x, bracket.coordinate_names_in_order, bracket.field_names)

    @np.errstate(all="ignore")
    def _refuse(self, equations: Equations, x: Array, residual: Array, energy: float | None) -> None:
        from liepoisson.leaf.leaf_search import check_energy_in_reach

        if energy is not None:
            check_energy_in_reach(self, energy)
        worst = int(np.argmax(np.where(np.isnan(residual), np.inf, residual)))
        parts = np.abs(equations.relative(x[worst])[0])
        failed = int(np.sum(~(residual <= CONVERGED)))
        raise LeafError(
            f"states on {self!r} were wanted; Newton's method ends with relative residuals "
            f"{np.array2string(parts, precision=2)} for {failed} of {len(x)} states. Start nearer to one, or "
            "check that it exists."
        )

    def _repr_html_(self) -> str:
        """What a notebook shows: the line of the leaf, and its Casimirs with their formulas and values."""
        rows = [("Casimir", "formula", "value")]
        rows += [(name, str(self.place.casimirs[name].expression), f"{v:.12g}") for name, v in self.casimirs.items()]
        return as_line(repr(self)) + as_table(rows)

    def __repr__(self) -> str:
        values = ", ".join(f"{name} = {value:.6g}" for name, value in self.casimirs.items())
        caution = f" ({self.caution})" if self.caution else ""
        return (
            f"<Leaf of dimension {self.rank} of {self.system.name!r}, {self.stratum}{': ' if values else ''}{values}"
            f"{caution}>"
        )


def _finite(states: Array, name: str) -> Array:
    if not np.isfinite(states).all():
        raise ParameterError(f"{name} must be finite; got {shown(states)}. Leave out what has failed.")
    return states


def _unknown(system: System, place: Place) -> str:
    """Why the equations of a leaf are not known."""
    if not place.is_open:
        return (
            f"the equations of this leaf are not known: {place.stratum}. Only its tangent spaces are; take a state on "
            "a listed stratum to project or sample."
        )
    n, known = system.bracket.dimension, ", ".join(place.casimirs) or "none"
    n_found = n - place.rank - system.bracket.n_unknown_casimirs
    return (
        f"the equations of the leaves of {system.name!r} are not known: {n} - {place.rank} = {n - place.rank} "
        f"independent Casimirs cut out those of its open stratum, and {n_found} of them were found within the limits "
        f"of the search ({known}). Only tangent spaces are known, from a state: Leaf.through(system, state)."
    )


def _values(system: System, casimirs: Mapping[str, float | str], place: Place) -> Array:
    given = named(casimirs, "casimirs")
    if given is not None and not set(given) <= set(place.casimirs):
        given = by_name(system, given)
    if given is None or set(given) != set(place.casimirs):
        wanted = ", ".join(formulas(system))
        raise ParameterError(
            f"casimirs must give a value by name for each of {wanted}; got {shown(casimirs)}. Those of a state: "
            "Leaf.through(system, state).casimirs."
        )
    values = np.array([as_number(given[name], name, "a finite number") for name in place.casimirs])
    if not np.isfinite(values).all():
        raise ParameterError(f"casimirs must be finite; got {given}.")
    return values


@np.errstate(all="ignore")
def are_on(leaf: Leaf, states: Array, energy: float | None = None) -> NDArray[np.bool_]:
    """Whether states at which Newton's method ended have the values of a leaf and an energy, as `contains` compares.

    Equations in one unit are relative to the longest field: far away in one field, any values of the others would do.
    """
    good = leaf.residual(states) <= _ON_LEAF
    if energy is not None:
        function = leaf.system.functions.energy
        size = abs(energy) + np.abs(states * function.gradient(states)).sum(axis=-1)
        good &= np.abs(function(states) - energy) <= _ON_LEAF * size
    return good


def leaf_of_values(leaf: Leaf, casimirs: Mapping[str, float]) -> Leaf:
    """The same leaf with values of the Casimirs as they were given, which its state has but for round-off.

    Args:
        leaf: The leaf.
        casimirs: The values under the names of `casimirs`.

    Raises:
        ParameterError: a name is missing or unknown.
    """
    if casimirs.keys() != leaf.place.casimirs.keys():
        raise ParameterError(f"casimirs: wanted {', '.join(leaf.place.casimirs)}; got {', '.join(casimirs)}")
    other = Leaf.__new__(Leaf)
    other._set(leaf.system, leaf.place, np.array([casimirs[name] for name in leaf.place.casimirs]), leaf.state)  # pyright: ignore[reportPrivateUsage]
    return other
