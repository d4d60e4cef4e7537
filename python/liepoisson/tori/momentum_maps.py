r"""The momentum map of an integrable system: H and the integrals that commute with it, and their flows.

On a leaf of dimension 2n let $F = (F_1, \dots, F_n)$ be independent integrals in involution.  Their flows commute, and

$$ \Phi^t = \varphi^{t_1}_{F_1}\circ\dots\circ\varphi^{t_n}_{F_n} $$

is the flow of $\sum_k t_kF_k$ over the time 1: an action of $\mathbb R^n$ on the fibres of F, of which the compact ones
without critical points consist of tori [arnold1989].

Some functions commute on one leaf only, such as H and the cubic of Goryachev and Chaplygin where $l\cdot\alpha = 0$.
Flows do not leave a leaf, and on it they are those of the functions restricted to it: their brackets need to vanish
there only.  They do if they are in the ideal of the equations of the leaf.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson.compile.field import Field
from liepoisson.equilibrium.critical_points import HamiltonianFields
from liepoisson.errors import ExpressionError, LeafError, ParameterError, ShapeError
from liepoisson.formula.scalars import TIME_LIMIT, as_array, as_phase_points, as_positive
from liepoisson.inputs.arrays import Array, check_shape
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.deadline import BLOCK, checkpoint, seconds_left
from liepoisson.inputs.given import sequence
from liepoisson.inputs.refusals import check_kind, shown
from liepoisson.leaf._checks import as_system
from liepoisson.leaf.leaf import Leaf
from liepoisson.leaf.leaf_in_units import equations_in_units
from liepoisson.leaf.leaf_projection import CONVERGED, Equations, approach
from liepoisson.model.phase_functions import PhaseFunction
from liepoisson.numeric.integrate import integrate
from liepoisson.numeric.method.taylor import Taylor
from liepoisson.portable import linear

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.model.system import System


_MOST_STEPS = 4096
"""Steps of the series along a flow: some 30 times those of the longest flows on tori; one that escapes takes more."""


@dataclass(frozen=True)
class CommutingFlows:
    r"""The system of (x, t) with $\dot x = \sum_k t_k J\nabla F_k$, $\dot t = 0$.

    Attributes:
        system: The system of x.
        functions: F.
    """

    system: System
    functions: tuple[PhaseFunction, ...]

    @property
    def name(self) -> str:
        """The name of the system of x."""
        return self.system.name

    @property
    def component_names(self) -> tuple[str, ...]:
        """Those of x, and of t."""
        return (*self.system.component_names, *(f"t_{k}" for k in range(len(self.functions))))

    def field(self) -> Field:
        """Quadratic if all flows are linear, else a tape."""
        return self._field

    @cached_property
    def _field(self) -> Field:
        from sympy import Add, Dummy, Integer

        from liepoisson.compile.lowering import field_of_equations

        times = [Dummy(f"t{k}", real=True) for k in range(len(self.functions))]
        flows = [self.system.bracket.vector_field(f.expression) for f in self.functions]
        rates = [Add(*(t * one for t, one in zip(times, rate, strict=True))) for rate in zip(*flows, strict=True)]
        variables = [*self.system.variables, *times]
        rates: list[Expr] = [*rates, *(Integer(0) for _ in times)]
        return field_of_equations(variables, rates)

    def without_value(self, states: Array) -> dict[str, NDArray[np.bool_]]:
        """Where invariants of the system of x are no real numbers, by name."""
        return self.system.without_value(states[..., : len(self.system.component_names)])


@dataclass(frozen=True, eq=False)
class MomentumMap:
    r"""H and integrals that commute with each other, as many as half the dimension of the leaves.

    Example:
        >>> top = lp.Top.twisted_lagrange()
        >>> momentum = lp.tori.momentum_map(top)
        >>> momentum
        <Momentum map (H, l3, P) of 'twisted Lagrange top'>
        >>> momentum([0, 0, 1, 0, 0, 1, 0, 0, 1]).tolist()
        [2.0, 1.0, 2.0]

    Attributes:
        system: The system.
        integrals: The functions by their names, H first.
        leaf: The leaf on which they commute; None if they do everywhere.
    """

    system: System
    integrals: Mapping[str, PhaseFunction]
    leaf: Leaf | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the integrals."""
        return tuple(self.integrals)

    def __call__(self, states: ArrayLike) -> Array:
        """Values of the integrals, shape (..., n), at states of shape (..., N)."""
        return np.stack([f(states) for f in self.integrals.values()], axis=-1)

    @cached_property
    def _fields(self) -> HamiltonianFields:
        return HamiltonianFields(self.system, tuple(self.integrals.values()))

    def fields(self, states: ArrayLike) -> Array:
        r"""The vector fields $J\nabla F_k$ as columns, shape (..., N, n)."""
        return self._fields.fields(self._states(states))

    def derivatives(self, states: ArrayLike) -> Array:
        """The derivatives of the fields, shape (..., N, N, n): that of component i along coordinate j of field k."""
        return self._fields.derivatives(self._states(states))

    def leaf_through(self, state: Array) -> Leaf:
        """The leaf of a state, shape (N,).

        Raises:
            LeafError: it is another one than that on which the integrals commute.
        """
        if self.leaf is None:
            return Leaf.through(self.system, state)
        self._check_on_leaf(state)
        return self.leaf

    def _check_on_leaf(self, states: Array) -> None:
        if self.leaf is None or (on := self.leaf.contains(states)).all():
            return
        raise LeafError(
            f"states: wanted those of {self.leaf!r}, on which alone the map ({', '.join(self.names)}) holds; got "
            f"{np.atleast_2d(states)[~np.atleast_1d(on)][0].tolist()}. Move them there by momentum.leaf.project, or "
            "make a map on their leaf: lp.tori.momentum_map(system, leaf=lp.Leaf(system, {...}))."
        )

    def _states(self, given: ArrayLike) -> Array:
        bracket = self.system.bracket
        return as_phase_points(given, bracket.coordinate_names_in_order, bracket.field_names)

    @cached_property
    def _flows(self) -> tuple[CommutingFlows, Taylor]:
        return CommutingFlows(self.system, tuple(self.integrals.values())), Taylor(max_steps=_MOST_STEPS)

    def flow(self, states: ArrayLike, times: ArrayLike) -> Array:
        r"""$\Phi^t(x)$, computed to round-off; NaN where a flow does not last so long.

        Args:
            states: States x, shape (N,) or (m, N).
            times: The times t of the flows, shape (n,) or (m, n).

        Raises:
            ShapeError: states and times have different numbers of rows.
            LeafError: a state is on another leaf than that on which the integrals commute.
            TimeLimitError: the deadline of the call has passed.
        """
        x, t = self._states(states), as_array(times, "times", self.names)
        check_shape(t.shape[-1:] == (len(self.names),), "times", f"(..., {len(self.names)})", t)
        try:
            m = np.broadcast_shapes(x.shape[:-1], t.shape[:-1])
        except ValueError:
            raise ShapeError(
                f"times: wanted one row, or one for each of the states of shape {x.shape}; got shape {t.shape}"
            ) from None
        starts = np.broadcast_to(x, (*m, x.shape[-1])).reshape(-1, x.shape[-1])
        rates = np.broadcast_to(t, (*m, t.shape[-1])).reshape(-1, t.shape[-1])
        system, method = self._flows
        ends = np.full(starts.shape, np.nan)
        moves = np.isfinite(starts).all(axis=1) & np.isfinite(rates).all(axis=1)
        if moves.any():
            starts, rates = starts[moves], rates[moves]
            self._check_on_leaf(starts)
            # Errors of steps are relative to the whole of (x, t): t is made no larger than x, by a longer run
            sizes = np.abs(starts).max(axis=1), np.abs(rates).max(axis=1)
            duration = float(sizes[1].max() / min(sizes[0][sizes[0] > 0], default=1.0)) or 1.0
            checkpoint("following commuting flows")
            orbit = integrate(
                system,
                np.concatenate([starts, rates / duration], axis=1),
                times=[0.0, duration],
                method=method,
                kernel="lanes",
                time_limit=seconds_left(TIME_LIMIT),
            )
            checkpoint("following commuting flows")
            ends[moves] = orbit.end_state[:, : x.shape[-1]]
        return ends.reshape(*m, x.shape[-1])

    def rank(self, states: ArrayLike, tol: float = 1e-9) -> NDArray[np.intp]:
        """The number of flows that are independent at states, shape (...): below n at critical points.

        Args:
            states: States, shape (..., N).
            tol: Singular values of the fields, of length 1 each, below this are zero.
        """
        least = as_positive(tol, "tol", "a positive number", example=1e-9)
        fields = self.fields(states)
        lengths = linear.norm(fields, axis=-2)
        sizes = linear.svd(fields / np.where(lengths > 0, lengths, 1.0)[..., None, :], compute_uv=False)
        return np.asarray((sizes > least).sum(axis=-1))

    def __repr__(self) -> str:
        values = {} if self.leaf is None else self.leaf.casimirs
        where = ", ".join(f"{name} = {value:.6g}" for name, value in values.items())
        return f"<Momentum map ({', '.join(self.names)}) of {self.system.name!r}{where and ' where '}{where}>"


@explains_its_arguments
def momentum_map(
    system: System, integrals: Sequence[str | Expr | PhaseFunction] | None = None, *, leaf: Leaf | None = None
) -> MomentumMap:
    r"""H and integrals that commute, as many as half the dimension of the leaves, verified exactly.

    With a leaf they need to commute there only: brackets are in the ideal of its equations, Casimirs less their values.

    Example:
        >>> lp.tori.momentum_map(lp.catalog.system("spherical-pendulum"))
        <Momentum map (H, l3) of 'spherical-pendulum'>
        >>> top = lp.catalog.system("goryachev-chaplygin")
        >>> lp.tori.momentum_map(top, leaf=lp.Leaf(top, {"C1": 0, "C2": 1})).names
        ('H', 'G')

    Args:
        system: A system whose parameters are all numbers.
        integrals: The other integrals than H, names or formulas; by default those of `system.invariants` that commute
            and are independent, on a leaf also those of `system.partial_integrals`.
        leaf: A leaf of the open stratum.  If the integrals commute everywhere, the map is one of all leaves.

    Raises:
        ParameterError: there are too few, one is not constant, two do not commute, or they are dependent everywhere.
        LeafError: the leaf is of lower rank.
    """
    from liepoisson.integrability.completeness import are_in_involution, commuting_integrals, fields_rank

    system = as_system(system)
    half = system.bracket.rank() // 2
    functions = system.functions
    on = () if leaf is None else _equations(system, leaf)
    if integrals is None:
        known = {name: f for name, f in system.invariants.items() if name == "H" or not system.is_casimir(f)}
        if names := commuting_integrals(system, known, 2 * half):
            return MomentumMap(system, {name: functions.of(known[name]) for name in names})
        if leaf is not None:
            for name, (f, _) in system.partial_integrals.items():
                if name not in known and are_in_involution(system, [f, system.hamiltonian], on):
                    known[name] = f
            if names := commuting_integrals(system, known, 2 * half, on):
                return MomentumMap(system, {name: functions.of(known[name]) for name in names}, leaf)
        partial = {name: zero for name, (_, zero) in system.partial_integrals.items() if name not in known}
        others = [f"{name} where {zero} = 0" for name, zero in partial.items()]
        raise ParameterError(
            f"integrals: wanted {half} that commute, H among them; of {shown(system)} are known {', '.join(known)}"
            f"{'' if leaf is None else f' on {leaf!r}'}. "
            + (f"On some leaves: {', '.join(others)}; take one, leaf=lp.Leaf(system, {{...}}). " if others else "")
            + "Give the others, or look for them by lp.integrability.first_integrals."
        )
    chosen = {"H": functions.energy}
    for one in sequence(integrals, "integrals", "integrals", '["l3"]'):
        function = _function(system, one)
        chosen[one if isinstance(one, str) else str(function.expression)] = function
    if len(chosen) != half:
        raise ParameterError(
            f"integrals: wanted {half - 1} beside H, as leaves have the dimension {2 * half}; got {len(chosen) - 1}"
        )
    expressions = {name: f.expression for name, f in chosen.items()}
    pairs = [pair for pair in combinations(chosen, 2) if not are_in_involution(system, [expressions[k] for k in pair])]
    if not pairs:
        on, leaf = (), None
    for one, other in pairs:
        if not on or not are_in_involution(system, [expressions[one], expressions[other]], on):
            where = "everywhere" if leaf is None else f"on {leaf!r}"
            hint = ". Where some leaf is meant, give it: leaf=lp.Leaf(system, {...})" if leaf is None else ""
            raise ParameterError(
                f"integrals: wanted functions that commute {where}; {{{one}, {other}}} is not zero there{hint}"
            )
    if (rank := fields_rank(system, list(expressions.values()), on)) < half:
        raise ParameterError(
            f"integrals: wanted {half} that are independent; of {', '.join(chosen)} only {rank} are, the Casimirs apart"
        )
    return MomentumMap(system, chosen, leaf)


def _equations(system: System, leaf: Leaf) -> tuple[Expr, ...]:
    """The functions that vanish on a leaf of the open stratum, with the values of Casimirs as exact numbers.

    Raises:
        ParameterError: it is the leaf of another system.
        LeafError: it is of lower rank.
    """
    from sympy import Rational

    check_kind(leaf, Leaf, "leaf", "a Leaf", "make it by lp.Leaf(system, {...})")
    if leaf.system is not system and leaf.system != system:
        raise ParameterError(f"leaf: wanted one of {system.name!r}; got {leaf!r}. Make it by lp.Leaf(system, {{...}}).")
    if not leaf.is_regular:
        raise LeafError(f"leaf: wanted one of the open stratum; got {leaf!r}. Take another one, or leave it out.")
    values = leaf.casimirs
    return tuple(f.expression - Rational(values[name]) for name, f in leaf.casimir_functions.items())


def _function(system: System, given: str | Expr | PhaseFunction) -> PhaseFunction:
    """A function, or the partial integral of this name."""
    try:
        return system.functions.of(given)
    except ExpressionError:
        if not isinstance(given, str) or given not in system.partial_integrals:
            raise
        return system.functions.of(system.partial_integrals[given][0])


def map_of(given: System | MomentumMap, integrals: Sequence[str | Expr | PhaseFunction] | None) -> MomentumMap:
    """The momentum map of a system, or the one given.

    Raises:
        ParameterError: both a map and integrals are given.
    """
    if not isinstance(given, MomentumMap):
        return momentum_map(given, integrals)
    if integrals is not None:
        raise ParameterError(
            f"integrals: the map has its own, {', '.join(given.names)}. Leave them out, or give a system."
        )
    return given


def on_fibre(momentum: MomentumMap, leaf: Leaf, states: Array, value: Array) -> Array:
    """States of a leaf with one value of the integrals, near given ones, shape (m, N); NaN where none was found."""
    held = zip(momentum.integrals.values(), value.tolist(), strict=True)
    return moved_onto(*unit_equations(leaf, held), states)


def on_leaf(leaf: Leaf, states: Array) -> Array:
    """States of a leaf near given ones, shape (m, N); NaN where none was found."""
    return moved_onto(*unit_equations(leaf), states)


def unit_equations(leaf: Leaf, held: Iterable[tuple[PhaseFunction, float]] = ()) -> tuple[Equations, Array]:
    """The equations of a leaf in coordinates divided by units, and the units, shape (N,).

    Args:
        held: Functions besides, each with its value.
    """
    units, equations = leaf.in_units().units, leaf.equations
    for function, value in held:
        equations = equations.with_function(function, value)
    return equations_in_units(equations, units, leaf.system.bracket), units


def moved_onto(equations: Equations, units: Array, states: Array) -> Array:
    """States near given ones, shape (m, N), for which equations in units hold; NaN where none was found."""
    found, residual = states / units, np.full(len(states), np.inf)
    for first in range(0, len(states), BLOCK):
        checkpoint("looking for states on a leaf or fibre")
        block = slice(first, first + BLOCK)
        found[block], residual[block] = approach(equations, found[block])
    return np.where((residual <= CONVERGED)[:, None], found * units, np.nan)
