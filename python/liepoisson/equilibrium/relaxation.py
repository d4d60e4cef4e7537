r"""Relaxation: damping leads a state down to an equilibrium of its leaf, and Newton's method ends the way.

A double bracket lowers H and keeps the leaf, so its orbits go to critical points of H on the leaf, and nearly all of
them to minima. The approach is exponential where the minimum is nondegenerate; where the orbit has come near, Newton's
method on the leaf gives the equilibrium to round-off, with its error.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Self, cast

import numpy as np
from numpy.typing import NDArray

from liepoisson.algebra.exact_numbers import to_sympy
from liepoisson.compile.symbols import evaluated
from liepoisson.damping.damped_system import DampedSystem, double_bracket
from liepoisson.equilibrium.critical_points import HamiltonianFields
from liepoisson.equilibrium.leaf_equilibria import equilibrium_near
from liepoisson.equilibrium.linearisation import ComplexArray
from liepoisson.equilibrium.second_variation import Symmetries
from liepoisson.equilibrium.stability import integrals_of
from liepoisson.errors import LeafError, ParameterError, ShapeError, TimeLimitError
from liepoisson.formula.parameters import Parameter, read_parameter
from liepoisson.formula.scalars import TIME_LIMIT, as_deadline, as_number, as_time
from liepoisson.inputs.arrays import Array, norm
from liepoisson.inputs.calls import explains_its_arguments, explains_its_methods
from liepoisson.inputs.deadline import has_passed, seconds_left
from liepoisson.inputs.given import named
from liepoisson.inputs.names import MAX_TITLE
from liepoisson.inputs.refusals import not_a
from liepoisson.io.result import Kept
from liepoisson.leaf._checks import as_system
from liepoisson.leaf.leaf import Leaf
from liepoisson.model.system import System
from liepoisson.numeric.integrate import integrate
from liepoisson.numeric.methods import MethodChoice
from liepoisson.numeric.starts import StartsLike, as_starts
from liepoisson.numeric.time_scale import time_scale
from liepoisson.portable import linear

if TYPE_CHECKING:
    from liepoisson.equilibrium.stability import Equilibrium

FIRST, LONGEST = 32.0, 1e4
"""The first stretch of the orbit and, by default, its length, in natural times; a stretch is as long as all before."""

_N_TIMES = 65
"""States that are kept of each stretch."""


@explains_its_methods
@dataclass(frozen=True, eq=False)
class Relaxation(Kept):
    r"""The way of a state down to an equilibrium of its leaf.

    Example:
        >>> found = lp.dissipation.relax(lp.catalog.system("heavy-top"), {"l": (0, 0, 1), "alpha": (0.6, 0, 0.8)})
        >>> found.outcome, found.equilibrium.nonlinear_stability, round(found.equilibrium.energy, 6)
        ('arrived', 'stable', -0.776616)

    A file has the orbit; the equilibrium is found anew, from its end, when it is read.

    Attributes:
        flow: The damped system whose orbit it is.
        leaf: The leaf of the start.
        time: Times, shape (time,).
        state: The orbit, shape (time, component).
        energy: H along it, less $\sum_j\Omega_j K_j$ where integrals were given, shape (time,).
        outcome: "arrived" at a minimum; "saddle": it is at an equilibrium that is none; "undecided": it is at rest, and
            second derivatives do not tell whether at a minimum: the equilibrium is "undecided", or H has directions
            without a second derivative that are none of known integrals; "not arrived" by the end of the time, as where
            minima are degenerate; "time limit"; or how the orbit failed, as where H is not bounded on the leaf: "step
            too small", "not finite", "max steps".
        equilibrium: The equilibrium that Newton's method reaches from the end of the orbit, with its stability, its
            residual and a bound on its error (`distance`), or None where it reaches none or the orbit failed.
        gap: How far the end of the orbit is from it, in units in which states of the leaf are of order one.
    """

    kind = "relaxation"
    made_by = "lp.dissipation.relax"
    row = "time"

    flow: DampedSystem
    leaf: Leaf
    time: Array
    state: Array
    energy: Array
    outcome: str
    equilibrium: Equilibrium | None
    gap: float

    @property
    def system(self) -> DampedSystem:
        """The damped system."""
        return self.flow

    def records(self) -> dict[str, Any]:
        """The orbit, how it ended, and whether an equilibrium is near its end."""
        orbit = {name: getattr(self, name).tolist() for name in ("time", "state", "energy")}
        others = {"outcome": self.outcome, "gap": self.gap, "has_end": self.equilibrium is not None}
        return {"record": orbit | others | {"undamped": self.flow.undamped.name}}

    @classmethod
    def of_record(cls, record: Any, system: Any) -> Self:
        """The relaxation of a file; Newton's method finds the equilibrium again.

        Raises:
            Exception: of many kinds, if something is missing or altered.
        """
        time, state, energy = (np.array(record[name]) for name in ("time", "state", "energy"))
        system.undamped.name = record["undamped"]  # the text of a damped system has one name alone
        leaf = Leaf.through(system.undamped, state[0])
        end = equilibrium_near(leaf.system, state[-1]) if record["has_end"] else None
        return cls(system, leaf, time, state, energy, record["outcome"], end, record["gap"])

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table: time, energy and state along the orbit."""
        return {"time": self.time, "energy": self.energy} | dict(
            zip(self.flow.component_names, self.state.T, strict=True)
        )

    @cached_property
    def spectrum(self) -> ComplexArray:
        r"""Eigenvalues of the damped flow at the equilibrium, along the leaf, by decreasing real part.

        As $J\nabla H = 0$ there, the flow is $(1 + \gamma J g)A$ to first order, with $A = D(J\nabla H)$. Of an
        equilibrium in a family the zeros belong to the family.
        """
        if self.equilibrium is None:
            return np.zeros(0, complex)
        x, flow, system = self.equilibrium.state, self.flow, self.flow.undamped
        n = len(x)
        entries: Any = [flow.rate, *cast("Any", flow.metric), *system.jacobian]
        rate, *others = evaluated(system.variables, entries, x)
        metric, derivative = np.reshape(others, (2, n, n))
        turned = np.eye(n) + rate * linear.matmul(system.functions.poisson_tensor(x), metric)
        basis = self.leaf.tangent_basis(x)
        values = linear.eigvals(linear.matmul(linear.matmul(basis.T, linear.matmul(turned, derivative)), basis))
        return values[np.lexsort((values.imag, -values.real))]

    @property
    def decay(self) -> float:
        """The rate of the approach: the smallest decay rate of the flow at the equilibrium, apart from its family."""
        values = self.spectrum
        nullity = 0 if self.equilibrium is None else self.equilibrium.nullity
        others = np.delete(values, np.argsort(np.abs(values))[:nullity])
        return float(-others.real.max()) if len(others) else np.nan

    @property
    def is_at_rest(self) -> bool:
        """Whether the end of the orbit is within the tolerance of the equilibrium."""
        return self.outcome in ("arrived", "saddle", "undecided")

    def __repr__(self) -> str:
        where = "" if self.equilibrium is None or not self.is_at_rest else f" at energy {self.equilibrium.energy:.6g}"
        falls = f"from {self.energy[0]:.6g} to {self.energy[-1]:.6g} in t = {self.time[-1]:g}"
        return f"<Relaxation of {self.flow.undamped.name!r}: {self.outcome}{where}; {falls}>"


@explains_its_arguments
def relax(
    system: System | DampedSystem,
    start: StartsLike,
    *,
    along: Mapping[str, Parameter] | None = None,
    t_end: float | None = None,
    tol: float = 1e-6,
    method: MethodChoice | None = None,
    time_limit: float = TIME_LIMIT,
) -> Relaxation:
    r"""The equilibrium to which a state relaxes on its leaf: a minimum of H, or of $H - \sum_j\Omega_j K_j$.

    The orbit of the double bracket, $\dot x = J\nabla H + \gamma J g J\nabla H$, is followed until Newton's method on
    the leaf of the start finds an equilibrium within `tol` of it that is a minimum. Of a system, $\gamma = 1/|J|$ at
    the start and g is the identity, in units in which states of the leaf are of order one; a damped system has its own.

    Example:
        >>> body = lp.catalog.euler_top_on("so(3)", [1, 2, 3])
        >>> found = lp.dissipation.relax(lp.dissipation.double_bracket(body, "1/10"), [1, 1, 1])
        >>> found.outcome, found.equilibrium.state.round(9) ** 2, round(found.decay, 9)
        ('arrived', array([0., 0., 3.]), 0.125)

    Args:
        system: A system whose parameters are all numbers, or one damped by a double bracket.
        start: One state, shape (N,), or vectors and components by name, the others being zero.
        along: Values of $\Omega_j$ by integrals, by their names in `system.invariants` or as formulas: with
            {"l3": "1/2"} a steady rotation at this rate is sought, a minimum of $H - \Omega\,\ell_3$.
        t_end: The longest orbit; by default 10,000 natural times of its start, or of its end where these are longer,
            but at most 10,000 times as long.
        tol: How near the orbit must come, in units in which states of the leaf are of order one.
        method: How; by default `Taylor()`.

    Raises:
        ParameterError: the system is none, is metriplectic or depends on time, or an integral of `along` is not
            constant or has no motion of its own; a number is wrong.
        ShapeError: not one state.
        LeafError: the equations of the leaf are not known.
        TimeLimitError: the time limit passes before the orbit begins.

    References: [bloch1996].
    """
    tol = as_number(tol, "tol", "a number between 0 and 1")
    if not 0 < tol < 1:
        raise ParameterError(f"tol: wanted a number between 0 and 1; got {tol:g}; try tol=1e-6")
    longest = None if t_end is None else as_time(t_end, "t_end", example=1000)
    own = _undamped(system)
    states = as_starts(own, start, len(own.component_names))
    if len(states) != 1:
        raise ShapeError(f"start: wanted one state, shape ({states.shape[-1]},); got {len(states)}; relax them in turn")
    with as_deadline(time_limit).running():
        lowered = _lowered(own, along)
        leaf = Leaf.through(lowered, states[0])
        _ = leaf.equations  # refused before anything is computed
        flow = system if isinstance(system, DampedSystem) and lowered is own else _damped(system, leaf)
        return _relaxed(flow, leaf, longest, tol, method)


def _undamped(system: Any) -> System:
    if not isinstance(system, DampedSystem):
        return as_system(system)
    if system.entropy is not None:
        raise ParameterError(
            f"system: wanted one whose energy falls; {system.name} is metriplectic, and keeps it; integrate it, and "
            "see end_state"
        )
    if not system.rate:
        raise ParameterError(f"system: wanted one that is damped; {system.name} has the rate 0; give a positive one")
    if not any(cast("Any", system.metric)):
        raise ParameterError(f"system: wanted one that is damped; the metric of {system.name} is 0; leave metric out")
    return as_system(system.undamped)


def _lowered(system: System, along: Any) -> System:
    r"""The system with the Hamiltonian $H - \sum_j\Omega_j K_j$."""
    given = named({} if along is None else along, "along")
    if given is None:
        raise not_a("a rate for each integral by name", along, "along", 'write for example along={"l3": "1/2"}')
    energy: Any = system.hamiltonian
    integrals: dict[str, Any] = {name: system.expression(name) for name in integrals_of(system, tuple(given))}
    rates = {name: read_parameter(value, f"along: {name}") for name, value in given.items()}
    for name, integral in integrals.items():
        energy -= to_sympy(rates[name]) * integral
    if not given:
        return system
    words = " - ".join(["H", *(f"{value}*{name}" for name, value in rates.items())])
    found = System(system.bracket, energy, name=f"{system.name}, {words}"[:MAX_TITLE])
    others = [f for name, f in system.invariants.items() if name not in {"H", *system.functions.casimirs}]
    all_known = dict.fromkeys([*integrals.values(), *others])
    known = {f"K{k}": f for k, f in enumerate(all_known, start=1) if found.is_constant(f)}
    return System(found.bracket, energy, name=found.name, integrals=known)


def _damped(given: System | DampedSystem, leaf: Leaf) -> DampedSystem:
    """The system with the damping that was given, or with the double bracket of the identity in the units of the leaf.

    With y = x/u the bracket is J/(u u^T), and the identity for y is the form with 1/u^2 on velocities of x.
    """
    if isinstance(given, DampedSystem):
        values = {name: value for name, value in given.values.items() if given.is_of_damping(name)}
        return DampedSystem(leaf.system, given.damping, values)
    units = leaf.in_units().units
    size = float(norm(leaf.system.functions.poisson_tensor(leaf.state) / units / units[:, None]))
    rate = float(f"{1 / size:.3g}") if 0 < size < np.inf else 1
    return double_bracket(leaf.system, rate, metric=None if (units == 1).all() else [*(1 / units**2)])


@np.errstate(over="ignore", invalid="ignore")  # of an orbit without bounds
def _relaxed(
    flow: DampedSystem, leaf: Leaf, longest: float | None, tol: float, method: MethodChoice | None
) -> Relaxation:
    x, units = leaf.state, leaf.in_units().units
    unit = _natural_time(flow, x, method)
    end_is_given, longest = longest is not None, LONGEST * unit if longest is None else longest
    times, states, t = [np.zeros(1)], [x[None]], 0.0
    found: Equilibrium | None = None
    outcome, gap = "not arrived", np.inf
    while t < longest and outcome == "not arrived":
        if has_passed():
            outcome = "time limit"
            break
        found, gap = None, np.inf
        end = min(max(2 * t, FIRST * unit), longest)
        run = integrate(
            flow, x, times=np.linspace(t, end, _N_TIMES), method=method, time_limit=seconds_left(TIME_LIMIT)
        )
        reached = np.isfinite(run.state[0]).all(axis=-1)
        times.append(run.time[1:][reached[1:]])
        states.append(run.state[0, 1:][reached[1:]])
        x, t = run.end_state[0], end
        if run.outcome[0] != "finished":
            outcome = str(run.outcome[0])
            if run.end_time[0] > np.concatenate(times)[-1]:  # its last good state
                times.append(run.end_time)
                states.append(run.end_state)
        elif (found := _near(leaf, x)) is not None:
            gap = float(norm((x - found.state) / units))
            if gap <= tol and _is_minimum(found):
                outcome = "arrived"
        elif has_passed():
            outcome = "time limit"
        if t >= longest and outcome == "not arrived" and not end_is_given:  # high above a minimum all is faster
            longest = max(longest, LONGEST * min(_natural_time(flow, x, method), LONGEST * unit))
    if outcome == "not arrived" and found is not None and gap <= tol:
        outcome = "saddle" if found.signature[1] else "undecided"
    path = np.concatenate(states)
    energy = leaf.system.functions.energy(path)
    return Relaxation(flow, leaf, np.concatenate(times), path, energy, outcome, found, gap)


def _natural_time(flow: DampedSystem, x: Array, method: MethodChoice | None) -> float:
    unit = float(time_scale(flow, x, method=method, time_limit=seconds_left(TIME_LIMIT))[0])
    return unit if 0 < unit < np.inf else 1.0  # all that is near is at rest


def _near(leaf: Leaf, x: Array) -> Equilibrium | None:
    """What Newton's method finds from a state, on its leaf: that of the start, up to the drift of the Casimirs."""
    try:
        return equilibrium_near(leaf.system, x)
    except (LeafError, ParameterError, TimeLimitError):
        return None


def _is_minimum(found: Equilibrium) -> bool:
    """Whether H rises in all directions but those in which the motions of known integrals carry the equilibrium.

    Others without a second derivative tell nothing: of H = p^2 - q^4 the origin is no minimum.
    """
    _, falling, flat = found.signature
    if falling or not flat or found.family == "undecided":
        return not falling and found.family != "undecided"
    view = found.leaf.in_units()
    along = HamiltonianFields(view.system, [view.system.functions.energy])
    return Symmetries.of(view, along).combinations(found.state / view.units).shape[1] == flat
