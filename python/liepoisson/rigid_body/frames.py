r"""Frames: the attitude of the body along an orbit, and vectors in the space frame.

The equations of a system on so(3) (x) A are those of the body frame.  The rotation R that takes body vectors to space
obeys $\dot R = R\,\hat\omega$ with $\hat\omega v = \omega\times v$ and $\omega = \partial H/\partial\ell$, so a vector
with $\dot\beta = \beta\times\omega$ is at rest in space.  R is carried as a unit quaternion.

References: Marsden and Ratiu, Introduction to Mechanics and Symmetry, second edition (1999), chapter 9 for quaternions
and chapter 15 for reconstruction; Thiffeault and Morrison (2001) for the tops.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson.compile.field import Field
from liepoisson.errors import ParameterError, ShapeError
from liepoisson.formula.scalars import TIME_LIMIT, as_array
from liepoisson.inputs.arrays import Array, check_shape, read_only
from liepoisson.inputs.calls import shows_progress
from liepoisson.inputs.refusals import counted, not_a_system, shown
from liepoisson.io.result import Result, labelled, part
from liepoisson.model.charts.quaternion_chart import components, rotation, shortest_turn
from liepoisson.model.system import System
from liepoisson.numeric.integrate import Orbit, integrate
from liepoisson.numeric.run import KeepsInvariants
from liepoisson.numeric.starts import StartsLike, as_starts, as_values
from liepoisson.portable import linear
from liepoisson.structure.lie_algebras import so

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from liepoisson.numeric.methods import MethodChoice

_UNIT = 1e-6
"""How far from a rotation a given attitude may be: what six printed digits leave.  It is then made one exactly."""


def _carried(orbit: Orbit, system: System) -> Orbit:
    """The run of a file as one of the system with its frame."""
    centre_line = len(orbit.components) > len(system.component_names) + 4
    return replace(orbit, system=FrameSystem(system, centre_line=centre_line))


@dataclass(frozen=True, kw_only=True, eq=False)
class Attitude(Result, KeepsInvariants):
    r"""Orbits with the attitude of the body along them.

    Example:
        >>> body = lp.catalog.euler_top_on("so(3)", [1, 1, 2])
        >>> found = lp.orbits.attitude(body, [0, 0, 1], times=[0, np.pi])  # a quarter of a turn
        >>> found.quaternion[0, -1].round(6).tolist()
        [0.707107, 0.0, 0.0, 0.707107]

    Attributes:
        system: The system.
        orbit: The run, with the components q0, q1, q2, q3 after those of the system.
        time: Times, shape (time,).
        state: States, shape (trajectory, time, component).
        quaternion: Unit quaternions (q0, q1, q2, q3) with the scalar first, shape (trajectory, time, 4).
        norm_error: $|q| - 1$ of the integrated quaternions before they were made unit again, shape (trajectory, time):
            the equations keep it at zero, so it measures the integration.
    """

    kind = "attitude"
    made_by = "attitude"
    rows = ("trajectory", "time")

    system: System
    orbit: Orbit = part(lambda: Orbit, "run_", own_dims=("time",), with_system=_carried)
    time: Array = labelled("time", long_name="time", is_coordinate=True)
    state: Array = labelled("trajectory", "time", "own_component", long_name="state")
    quaternion: Array = labelled("trajectory", "time", "quaternion", long_name="unit quaternion of the attitude")
    norm_error: Array = labelled("trajectory", "time", long_name="norm of the quaternion before, less 1", units="1")

    @property
    def time_limit(self) -> float:
        """Seconds that the run was allowed to take."""
        return self.orbit.time_limit

    def with_time_limit(self, time_limit: float) -> Attitude:
        """The same as the result of a run with another limit of seconds, which ended nothing."""
        return replace(self, orbit=self.orbit.with_time_limit(time_limit))

    def arguments(self) -> dict[str, Any]:
        """What `attitude` was called with."""
        n, run = len(self.system.component_names), self.orbit.arguments()
        start = run.pop("starts")
        same = {name: run[name] for name in ("method", "times", "dense")}
        return {**same, "starts": start[:, :n], "attitude": start[:, n : n + 4]}

    @property
    def outcome(self) -> NDArray[np.str_]:
        """How each trajectory ended, as in an Orbit; states and quaternions are NaN from there on."""
        return self.orbit.outcome

    def __repr__(self) -> str:
        n, times = self.state.shape[:2]
        return f"<Attitude of {self.system.name!r}: {extent(n, self.outcome)}, {counted(times, 'time')}>"

    @cached_property
    def rotation(self) -> Array:
        """Rotation matrices R from body to space, shape (trajectory, time, 3, 3); column k is the body's axis k."""
        return read_only(rotation_matrix(self.quaternion))

    @cached_property
    def angular_velocity(self) -> Array:
        r"""Angular velocity $\omega = \partial H/\partial\ell$ in the body frame, shape (trajectory, time, 3)."""
        return read_only(self.system.functions.energy.gradient(self.state)[..., :3])

    def space(self, vectors: str | ArrayLike) -> Array:
        """Body vectors seen in the space frame, R v.

        Args:
            vectors: The name of a field of the system ("l", "beta"), or vectors of a shape that broadcasts to
                (trajectory, time, 3); (0, 0, 1) is the body's third axis.

        Returns:
            Shape (trajectory, time, 3).

        Raises:
            ShapeError: the vectors have another shape.
            ParameterError: the system has no field of this name.
        """
        return linear.einsum("...ij,...j->...i", self.rotation, self._vectors(vectors))

    def body(self, vectors: ArrayLike) -> Array:
        r"""Space vectors seen in the body frame, $R^T v$, shape (trajectory, time, 3).

        Raises:
            ShapeError: the vectors do not broadcast to (trajectory, time, 3).
        """
        return linear.einsum("...ji,...j->...i", self.rotation, self._vectors(vectors))

    def at(self, times: ArrayLike) -> Attitude:
        """The same at other times within the run, from the power series of its steps.

        Args:
            times: Times, shape (time,), in any order.

        Raises:
            ParameterError: the run was made without `dense=True`, or a time lies outside it.
            ShapeError: the times do not have shape (time,).
        """
        times = as_values(times, "times")
        check_shape(times.ndim == 1, "times", "(time,)", times, "Give a list of times.")
        values = self.orbit.at(times)
        return replace(self, time=times, **_parts(values, self.system))

    def _vectors(self, vectors: str | ArrayLike) -> Array:
        if isinstance(vectors, str):
            start = 3 * field_number(self.system, vectors)
            return self.state[..., start : start + 3]
        values = as_array(vectors, "vectors")
        shape = self.rotation.shape[:-1]
        try:
            if values.ndim == 0:
                raise ValueError("a number is no vector")
            return np.broadcast_to(values, shape)
        except ValueError as error:
            raise ShapeError(
                f"vectors must broadcast to (trajectory, time, 3) = {shape}; got shape {values.shape}. Transpose them?"
            ) from error


def extent(n: int, outcome: NDArray[np.str_]) -> str:
    """How many trajectories there are, and how many of them did not finish, for a repr."""
    failed = int((outcome != "finished").sum())
    return counted(n, "trajectory", "trajectories") + (f" ({failed} not finished)" if failed else "")


@shows_progress
def attitude(
    system: System,
    starts: StartsLike,
    *,
    times: ArrayLike,
    attitude: str | ArrayLike | None = None,
    method: MethodChoice | None = None,
    dense: bool = False,
    threads: int | None = None,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> Attitude:
    r"""Orbits and the attitude of the body, as one field: $\dot x = J\nabla H$, $\dot q = \tfrac12 q\,\omega$.

    The product is Hamilton's ($ij = k$), $\omega = \partial H/\partial\ell$ is a pure quaternion in the body frame, and
    $v \mapsto q v \bar q$ takes body vectors to space.  For a top the field is quadratic with 13 components.

    Example:
        >>> body = lp.catalog.euler_top_on("so(3)", [1, 2, 3])
        >>> found = lp.orbits.attitude(body, [0.1, 1, 0.1], times=np.linspace(0, 50, 101))  # it tumbles
        >>> bool(np.ptp(found.space("l"), axis=1).max() < 1e-12)  # the angular momentum is fixed in space
        True

    Args:
        system: A system on so(3) (x) A, where A = R e_0 + m with the unit e_0 and an ideal m: all tops, Kirchhoff's
            equations, the Leibniz extensions of any length.
        starts: States at time `t[0]`, shape (component,) or (trajectory, component).
        times: Times at which states are wanted, strictly monotone, shape (time,).
        attitude: Attitude at `t[0]`: a unit quaternion, shape (4,) or (trajectory, 4); a rotation matrix from body to
            space, shape (3, 3) or (trajectory, 3, 3); or the name of a field of the system, "beta", whose vector then
            points along the third axis of space.  By default the two frames coincide at `t[0]`.
        method: How; by default `Taylor()`.  Methods that need a top or pieces of a Hamiltonian do not apply.
        dense: Keep the power series, so that `.at(t)` answers for any time.

    Returns:
        Attitude; a trajectory that fails is an outcome in it, not an error.

    Raises:
        ParameterError: the system is on another algebra, or has a parameter without a number; the attitude is no
            rotation; the method does not apply.
        ShapeError: an array has another shape than stated.
        UnsupportedFieldError: the Hamiltonian contains a function that is not smooth.
    """
    carried = FrameSystem(system)
    states = as_starts(system, starts, len(system.component_names))
    start = np.hstack([states, initial_quaternions(system, states, attitude)])
    run: dict[str, Any] = {"method": method, "threads": threads, "time_limit": time_limit, "progress": progress}
    orbit = integrate(carried, start, times=times, dense=dense, **run)
    return attitude_of(system, orbit)


def attitude_of(system: System, orbit: Orbit) -> Attitude:
    """What a run of a `FrameSystem` says about the attitude."""
    return Attitude(system=system, orbit=orbit, time=orbit.time, **_parts(orbit.state, system))


def _parts(values: Array, system: System) -> dict[str, Array]:
    n = len(system.component_names)
    quaternion = values[..., n : n + 4]
    norm = linear.norm(quaternion, axis=-1)
    return {"state": values[..., :n], "quaternion": quaternion / norm[..., None], "norm_error": norm - 1.0}


class FrameSystem:
    r"""A system with the quaternion of its attitude, and on demand the centre line $\dot r = R e_3$, as one field.

    Args:
        system: A system on so(3) (x) A with the unit of A first.
        centre_line: Whether three more components r are carried.

    Raises:
        ParameterError: another algebra, or a parameter without a number.
    """

    def __init__(self, system: System, *, centre_line: bool = False) -> None:
        check_rotates(system)
        self.name: str = system.name
        self._system = system
        self._centre_line = centre_line

    @property
    def component_names(self) -> tuple[str, ...]:
        """The coordinates of the system, q0 to q3, and r1, r2, r3."""
        own = self._system.component_names
        added = [f"q{i}" for i in range(4)] + [f"r{i}" for i in (1, 2, 3)] * self._centre_line
        # A system may have fields called q or r.
        return (*own, *(f"frame_{name}" if name in own else name for name in added))

    def field(self) -> Field:
        """Quadratic if the Hamiltonian is of degree two, else a tape."""
        from sympy import Dummy

        from liepoisson.compile.lowering import field_of_equations

        q = [Dummy(f"q{i}", real=True) for i in range(4)]
        r = [Dummy(f"r{i}", real=True) for i in range(3)] if self._centre_line else []
        rates = [*self._system.equations.values(), *quaternion_rates(q, angular_velocity(self._system))]
        if self._centre_line:
            rates += third_director(q)
        variables = [*self._system.variables, *q, *r]
        return field_of_equations(variables, rates)


def angular_velocity(system: System) -> list[Expr]:
    r"""The components of $\omega = \partial H/\partial\ell$ as expressions."""
    return [cast("Expr", system.hamiltonian.diff(variable)) for variable in system.variables[:3]]


def quaternion_rates(q: Sequence[Symbol], omega: Sequence[Expr]) -> list[Any]:
    r"""The components of $\dot q = \tfrac12 q\,\omega$ by Hamilton's product."""
    from sympy import Rational

    q0, q1, q2, q3 = cast("Any", q)
    w1, w2, w3 = cast("Any", omega)
    product = (
        -q1 * w1 - q2 * w2 - q3 * w3,
        q0 * w1 + q2 * w3 - q3 * w2,
        q0 * w2 + q3 * w1 - q1 * w3,
        q0 * w3 + q1 * w2 - q2 * w1,
    )
    return [Rational(1, 2) * component for component in product]


def third_director(q: Sequence[Any]) -> list[Any]:
    """The body's third axis in space, the last column of R(q)."""
    return [row[2] for row in rotation(q)]


def check_rotates(system: object) -> None:
    r"""Refuse a system without an attitude in SO(3).

    The rotations are a quotient of the group of so(3) (x) A when A = R e_0 + m with an ideal m; then
    $\omega = \partial H/\partial x_0$.  A sum such as R + R has two rotations, the complex numbers none.

    Raises:
        ParameterError: the algebra is not so(3), A is not of this form, or a parameter has no number.
    """
    from liepoisson.compile.lowering import check_numeric

    if not isinstance(system, System):
        raise not_a_system(system)
    algebra, extension = system.bracket.algebra, system.bracket.extension
    has_unit = all(extension.products.get((0, k)) == {k: 1} for k in range(extension.dimension))
    ideal = not any(0 in row for (first, _), row in extension.products.items() if first > 0)
    if algebra.structure_constants != so(3).structure_constants or not has_unit or not ideal:
        raise ParameterError(
            "system: wanted one on so(3) (x) A, where the first basis element of A is its unit and the others span an "
            f"ideal; got {system.bracket!r}, whose group has no single rotation; take one on so(3) @ leibniz(n, ...)"
        )
    if system.bracket.constant:
        raise ParameterError(
            f"system: wanted a bracket without a constant part, whose group acts on the attitude; got "
            f"{system.bracket!r}; if bracket.coboundary() gives a point xi, take bracket.translated(-xi) and x - xi "
            "in the place of x in the Hamiltonian"
        )
    check_numeric(system.bracket, system.hamiltonian)


def field_number(system: System, name: str) -> int:
    """Which field of the system has this name."""
    names = system.bracket.field_names
    if name not in names:
        raise ParameterError(f"wanted a field of {system.name}: {', '.join(names)}; got {name!r:.60}; give one of them")
    return names.index(name)


def initial_quaternions(system: System, states: Array, given: str | ArrayLike | None) -> Array:
    """Unit quaternions, shape (trajectory, 4), from what the caller gives for an attitude."""
    n = len(states)
    if given is None:
        return np.tile([1.0, 0.0, 0.0, 0.0], (n, 1))
    if isinstance(given, str):
        start = 3 * field_number(system, given)
        return _upright(states[:, start : start + 3], given)
    values = as_array(given, "attitude")
    if values.shape in ((4,), (n, 4)):
        quaternions = _checked_quaternions(values)
    elif values.shape in ((3, 3), (n, 3, 3)):
        quaternions = quaternion_of(values)
    else:
        raise ShapeError(
            f"attitude must have shape (4,), ({n}, 4), (3, 3) or ({n}, 3, 3); got shape {values.shape}. One for each "
            "trajectory, or one for all."
        )
    return np.broadcast_to(quaternions, (n, 4))


def _checked_quaternions(values: Array) -> Array:
    norm = linear.norm(values, axis=-1, keepdims=True)
    if not (np.abs(norm - 1.0) < _UNIT).all():
        raise ParameterError(f"attitude: wanted unit quaternions; got lengths {shown(norm.ravel())}; divide by them")
    # one that is a unit already stays as it is, so that a run is repeated bit for bit
    return np.where(np.abs(norm - 1.0) <= 1e-15, values, values / norm)


def _upright(vectors: Array, name: str) -> Array:
    """Quaternions that turn each vector to the third axis the shortest way; rows that are not finite stay so."""
    length = linear.norm(vectors, axis=-1, keepdims=True)
    if (length == 0).any():
        raise ParameterError(f"attitude: wanted a vector to put upright; got {name} = 0; give a quaternion")
    with np.errstate(invalid="ignore"):  # a row that is not finite ends at once, with its outcome
        v = vectors / length
    return shortest_turn(v)


def rotation_matrix(q: ArrayLike) -> Array:
    r"""The rotation $v \mapsto q v \bar q$ of unit quaternions of shape (..., 4), shape (..., 3, 3)."""
    rows = rotation(components(as_array(q, "q")))
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def quaternion_of(rotation: Array) -> Array:
    r"""The unit quaternions of rotation matrices of shape (..., 3, 3), with the largest component positive.

    The matrix $K_{\mu\nu} = 4 q_\mu q_\nu$ is linear in R; its row with the largest diagonal entry is a multiple of q
    that does not cancel (Shepperd 1978).

    Raises:
        ParameterError: a matrix is not orthogonal, or reflects.
    """
    R = rotation
    defect = np.abs(linear.einsum("...ki,...kj->...ij", R, R) - np.eye(3)).max()
    if not defect < _UNIT:
        raise ParameterError(
            f"attitude: wanted rotation matrices; got one with |R^T R - 1| = {defect:.1e}; orthonormalise its columns"
        )
    if not (linear.det(R) > 0).all():
        raise ParameterError("attitude: wanted rotations; got a reflection, det R < 0; reverse one column")
    K = np.empty((*R.shape[:-2], 4, 4))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        K[..., i + 1, i + 1] = 1 + R[..., i, i] - R[..., j, j] - R[..., k, k]
        K[..., 0, i + 1] = K[..., i + 1, 0] = R[..., k, j] - R[..., j, k]
        K[..., j + 1, k + 1] = K[..., k + 1, j + 1] = R[..., j, k] + R[..., k, j]
    K[..., 0, 0] = 1 + np.trace(R, axis1=-2, axis2=-1)
    largest = np.argmax(np.diagonal(K, axis1=-2, axis2=-1), axis=-1)
    q = np.take_along_axis(K, largest[..., None, None], axis=-2)[..., 0, :]
    return q / linear.norm(q, axis=-1, keepdims=True)
