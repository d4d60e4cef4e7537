r"""Rods: an orbit read as the shape of an elastic rod that carries a current in a uniform magnetic field.

Kirchhoff's equations of an inextensible, unshearable rod with arclength s, directors d1, d2, d3 = r' and the laws of
force and moment balance are, in space,

$$r' = d_3,\qquad n' = J B\times d_3,\qquad m' = n\times d_3,\qquad B' = 0 ,$$

with the force n and the moment m that the part beyond s exerts, and Lorentz's force $J d_3\times B$ per length, J the
current.  In the frame of the directors, which turns at the rate u (curvatures u1, u2, twist u3),
$m' = m\times u + n\times e_3$, $n' = n\times u + J B\times e_3$, $B' = B\times u$: the twisted top with $\ell = m$,
$\omega = u$, $a_3\alpha = n$, $\epsilon a_3^2\beta = J B$.  The moments of inertia are the stiffnesses.

References: Sinden and van der Heijden, Integrability of a conducting elastic rod in a magnetic field, arXiv:0708.1114
(2007); Kirchhoff, J. reine angew. Math. 56 (1859) 285, for the analogy of rod and top; Antman, Nonlinear Problems of
Elasticity, second edition (2005), chapter 8, for rods.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import TIME_LIMIT, as_array, as_count, as_time
from liepoisson.inputs.arrays import Array, check_finite, check_shape
from liepoisson.inputs.calls import shows_progress
from liepoisson.inputs.refusals import counted
from liepoisson.io.result import Result, labelled, part
from liepoisson.numeric.integrate import integrate
from liepoisson.numeric.starts import StartsLike, as_starts, as_values
from liepoisson.portable import elementary, linear
from liepoisson.rigid_body.frames import Attitude, FrameSystem, attitude_of, check_rotates, extent, initial_quaternions

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.model.system import System
    from liepoisson.numeric.methods import MethodChoice

Weights: TypeAlias = "tuple[Expr, ...]"
"""An element of the extension's algebra A: one exact number per field."""

_POINTS = 401
"""Points along a rod that is given by its length: enough for a smooth picture of some twenty turns."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Rod(Result):
    """Shapes of rods; vectors are in the space frame unless they are called strain.

    Example:
        >>> system = lp.System(lp.so(3) @ lp.semidirect(2), "(l1^2 + l2^2 + l3^2/2)/2 + alpha3")
        >>> ring = lp.orbits.rod(system, [0, 2, 0, 0, 0, 0], length=np.pi)
        >>> round(float(np.ptp(ring.centre_line[0, :, 0])), 4)  # the diameter, with the curvature 2
        1.0

    Attributes:
        attitude: The same runs with the directors as an attitude; `attitude.orbit` is the integrated orbit.
        arclength: Where the points are, shape (point,).
        centre_line: The curve r(s), shape (trajectory, point, 3).
        directors: d1, d2, d3, shape (trajectory, point, director, 3); d3 is the tangent.
        strain: Curvatures u1, u2 and twist u3 in the frame of the directors, shape (trajectory, point, 3).
        moment: m, shape (trajectory, point, 3).
        force: n, shape (trajectory, point, 3).
        field: J B, current times magnetic field, a force per length; shape (trajectory, point, 3), the same at all
            points.
    """

    kind = "rod"
    made_by = "rod"
    rows = ("trajectory", "point")

    attitude: Attitude = part(lambda: Attitude)
    arclength: Array = labelled("point", long_name="arclength", is_coordinate=True)
    centre_line: Array = labelled("trajectory", "point", "axis", long_name="centre line in space")
    directors: Array = labelled("trajectory", "point", "director", "axis", long_name="directors in space")
    strain: Array = labelled("trajectory", "point", "director", long_name="curvatures and twist")
    moment: Array = labelled("trajectory", "point", "axis", long_name="moment in space")
    force: Array = labelled("trajectory", "point", "axis", long_name="force in space")
    field: Array = labelled("trajectory", "point", "axis", long_name="current times magnetic field in space")

    def arguments(self) -> dict[str, Any]:
        """What `rod` was called with."""
        run = self.attitude.arguments()
        origin = self.attitude.orbit.start[:, -3:]
        same = {name: run[name] for name in ("starts", "attitude", "method")}
        return {**same, "arclengths": run["times"], "origin": origin}

    def with_time_limit(self, time_limit: float) -> Rod:
        """The same as the result of a run with another limit of seconds, which ended nothing."""
        return replace(self, attitude=self.attitude.with_time_limit(time_limit))

    @property
    def time_limit(self) -> float:
        """Seconds that the run was allowed to take."""
        return self.attitude.time_limit

    @property
    def system(self) -> System:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The system whose orbit it is."""
        return self.attitude.system

    @property
    def outcome(self) -> NDArray[np.str_]:
        """How each trajectory ended, as in an Orbit."""
        return self.attitude.outcome

    @property
    def curvature(self) -> Array:
        r"""Curvature of the centre line, $|r''| = \sqrt{u_1^2 + u_2^2}$, shape (trajectory, point)."""
        return elementary.hypot(self.strain[..., 0], self.strain[..., 1])

    @property
    def twist(self) -> Array:
        r"""Twist $u_3$, the rate at which d1 turns about the tangent, shape (trajectory, point)."""
        return self.strain[..., 2]

    @property
    def tension(self) -> Array:
        r"""Tension $n\cdot d_3$, negative where the rod is compressed, shape (trajectory, point)."""
        return linear.einsum("...i,...i->...", self.force, self.directors[..., 2, :])

    def __repr__(self) -> str:
        n, points = self.centre_line.shape[:2]
        first, last = self.arclength[0], self.arclength[-1]
        size = f"{extent(n, self.outcome)}, {counted(points, 'point')}"
        return f"<Rod of {self.system.name!r}: {size}, s = {first:g} to {last:g}>"


@shows_progress
def rod(
    system: System,
    starts: StartsLike,
    *,
    length: float | None = None,
    n_points: int = _POINTS,
    arclengths: ArrayLike | None = None,
    attitude: str | ArrayLike | None = None,
    origin: ArrayLike = (0.0, 0.0, 0.0),
    method: MethodChoice | None = None,
    threads: int | None = None,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> Rod:
    r"""Orbits as shapes of elastic rods: arclength for time, the attitude for the directors, $r' = d_3$.

    A system on so(3) (x) A is a rod when $H = W(\ell) + \sum_\mu f_\mu\, x_{\mu,3}$ with $\mu \ge 1$: W is the
    complementary strain energy, $u = \partial W/\partial m$, and with $f = \sum_\mu f_\mu e_\mu$ in A the force is
    $n = \langle x, f\rangle$ and the field $J B = \langle x, f^2\rangle$; B is fixed in space: $f^3 = 0$.  For the top
    with a = (0, 0, a3), b = (0, 0, b3): $n = a_3\alpha + b_3\beta$, $J B = \epsilon a_3^2\beta$.  Unequal I1, I2 are a
    rod with unequal bending stiffnesses; a linear term of W is a rod that is bent or twisted when it is free.

    Example:
        >>> rod = lp.System(lp.so(3) @ lp.semidirect(2), "(l1^2 + l2^2 + l3^2/2)/2 + alpha3")
        >>> ring = lp.orbits.rod(rod, [0, 1, 0, 0, 0, 0], length=2 * np.pi)  # a couple and no force
        >>> bool(np.abs(ring.centre_line[0, -1]).max() < 1e-12), round(float(ring.curvature.max()), 9)
        (True, 1.0)

    Args:
        system: A system of this form.
        starts: State at the beginning of each rod, shape (component,) or (trajectory, component).
        length: Length of the rod; a negative one continues it backwards.
        n_points: Points along it, equally spaced.
        arclengths: In place of the two, strictly monotone, shape (point,); `starts` is the state at the first.
        attitude: Directors at the first arclength, as in `attitude`; "beta" puts the magnetic field upright.
        origin: Beginning of the centre line, shape (3,) or (trajectory, 3).
        method: How; by default `Taylor()`.

    Returns:
        Rod; a trajectory that fails is an outcome in it, not an error.

    Raises:
        ParameterError: the system is not of this form; neither or both of `length` and `arclengths` are given.
        ShapeError: an array has another shape than stated.
    """
    carried = FrameSystem(system, centre_line=True)
    force, field = loads(system)
    n = len(system.component_names)
    states = as_starts(system, starts, n)
    start = np.hstack([states, initial_quaternions(system, states, attitude), _origins(origin, len(states))])
    run: dict[str, Any] = {"method": method, "threads": threads, "time_limit": time_limit, "progress": progress}
    orbit = integrate(carried, start, times=_arclengths(length, n_points, arclengths), **run)
    frames = attitude_of(system, orbit)
    fields = frames.state.reshape(*frames.state.shape[:-1], -1, 3)
    in_space = [
        frames.space(linear.einsum("f,...fi->...i", np.array(weights, dtype=np.float64), fields))
        for weights in (force, field)
    ]
    return Rod(
        attitude=frames,
        arclength=orbit.time,
        centre_line=orbit.state[..., n + 4 :],
        directors=np.swapaxes(frames.rotation, -1, -2),
        strain=frames.angular_velocity,
        moment=frames.space(fields[..., 0, :]),
        force=in_space[0],
        field=in_space[1],
    )


def loads(system: System) -> tuple[Weights, Weights]:
    r"""The elements f and $f^2$ of A with $n = \langle x, f\rangle$ and $J B = \langle x, f^2\rangle$.

    From $x_\nu' = x_\nu\times\omega + \sum_{\lambda\mu} W_\lambda{}^{\nu\mu} f_\mu\, x_\lambda\times e_3$ follow
    $m' = m\times\omega + n\times e_3$, $n' = n\times\omega + \langle x, f^2\rangle\times e_3$ and, for $f^2$ in place
    of f, $\langle x, f^2\rangle' = \langle x, f^2\rangle\times\omega + \langle x, f^3\rangle\times e_3$.

    Raises:
        ParameterError: the Hamiltonian couples to the fields in another way, or $f^3 \ne 0$.
    """
    from sympy import Integer, expand

    check_rotates(system)
    variables, weights = system.variables, [Integer(0)]
    for k in range(3, len(variables), 3):
        slopes: list[Any] = [expand(system.hamiltonian.diff(v)) for v in variables[k : k + 3]]
        if any(slope != 0 for slope in slopes[:2]) or not slopes[2].is_number:
            raise ParameterError(
                "rod: wanted a Hamiltonian W(l) + a3 alpha3 + b3 beta3, in which the fields couple to the tangent "
                f"(0, 0, 1) alone; got the derivatives {slopes!s:.80} along "
                f"({', '.join(map(str, variables[k : k + 3]))}); try a top with a = (0, 0, a3) and b = (0, 0, b3)"
            )
        weights.append(slopes[2])
    force = tuple(weights)
    field = _product(system, force, force)
    if any(value != 0 for value in _product(system, field, force)):
        raise ParameterError(
            f"rod: wanted a field that is fixed in space, that is f^3 = 0 for f = {force!s:.60} in the algebra of "
            f"{system.bracket!r}; got f^3 != 0; try an extension of at most three fields"
        )
    return force, field


def _product(system: System, first: Weights, second: Weights) -> Weights:
    from sympy import Integer, simplify

    from liepoisson.algebra.exact_numbers import to_sympy

    sums: list[Any] = [Integer(0)] * len(first)
    for (mu, nu), row in system.bracket.extension.products.items():
        pairs = {(mu, nu), (nu, mu)}
        weight: Any = sum((first[i] * second[j] for i, j in pairs), Integer(0))
        for k, value in row.items():
            sums[k] += to_sympy(value) * weight
    return tuple(simplify(value) for value in sums)


def _arclengths(length: float | None, n_points: int, given: ArrayLike | None) -> Array:
    if (length is None) == (given is None):
        both = "both" if given is not None else "neither"
        raise ParameterError(f"rod: wanted either length or arclengths; got {both}; try length=20")
    if given is not None:
        return as_values(given, "arclengths")
    end = as_time(length, "length", example=20, forwards=False)
    return np.linspace(0.0, end, as_count(n_points, "n_points", least=2, most=10_000_000, hint="try n_points=401"))


def _origins(origin: ArrayLike, n: int) -> Array:
    values = as_array(origin, "origin")
    check_shape(values.shape in ((3,), (n, 3)), "origin", f"(3,) or ({n}, 3)", values, "One point for each rod.")
    check_finite(values, "origin", "leave it out")
    return np.broadcast_to(values, (n, 3))
