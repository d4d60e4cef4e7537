r"""Rotation numbers as weighted Birkhoff averages of the angle that an orbit turns by from one point to the next.

An orbit of a map on an invariant circle turns about a point inside of it by $\Delta_k$ in step k.  Its rotation number

$$ \rho = \lim_{n\to\infty}\frac1{2\pi n}\sum_{k<n}\Delta_k $$

is approached like 1/n by plain means, and faster than any power of n by those with the weights

$$ w(t) = \exp\Bigl(-\frac1{t(1 - t)}\Bigr), \qquad t = \frac{k + 1/2}n , $$

if map and circle are smooth and $\rho$ is far from fractions of small denominators [das2017].  On tori of more
dimensions the same holds for the mean turn in a plane.

Each $\Delta_k$ is known up to a whole turn.  On a circle it is a continuous function of the point: its values are an
arc, and where they are not all turns there is one gap, in which they are cut.  If there is none, the cut values jump,
and the average converges no faster than plain means do, which the error shows.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson.errors import ParameterError, ShapeError
from liepoisson.formula.scalars import as_array
from liepoisson.inputs.arrays import Array, ReadOnlyArrays, check_finite
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.given import texts
from liepoisson.inputs.refusals import counted
from liepoisson.io.tables import Tabular
from liepoisson.numeric.integrate import Orbit
from liepoisson.poincare.section import Section
from liepoisson.portable import elementary
from liepoisson.tori.frequencies import component_or_formula

_LEAST = 4
"""Steps: two for each half."""


@dataclass(frozen=True, eq=False)
class RotationNumbers(ReadOnlyArrays, Tabular):
    r"""Mean turns of orbits in a plane.

    Example:
        >>> system = lp.catalog.system("henon-heiles")
        >>> points = lp.section(system, [0, 0.1, 0.35, 0], surface="x", direction=1, t_end=4000)
        >>> lp.tori.rotation_number(points, ["y", "p_y"])
        <Rotation number of 1 orbit: 0.12938, error 1e-10>

    Attributes:
        value: Turns per step, from the first coordinate of the plane to the second, shape (trajectory,): between -1/2
            and 1/2, as whole turns are not seen.  NaN where there are fewer than 4 steps or a point has no angle.
        error: The larger one of the distances from the averages over the first and the second half of the steps, but
            not less than round-off, shape (trajectory,).  An orbit that is not quasi-periodic has a large one.
        n_steps: Number of steps, shape (trajectory,).
        interval: Time between the points of an orbit; None for maps.
    """

    value: Array
    error: Array
    n_steps: NDArray[np.intp]
    interval: float | None

    def __len__(self) -> int:
        """How many orbits."""
        return len(self.value)

    @property
    def frequency(self) -> Array:
        r"""$2\pi$ times the value over the interval: the mean turn in radians per time, shape (trajectory,).

        Raises:
            ParameterError: the points were those of a map.
        """
        if self.interval is None:
            raise ParameterError("frequency: wanted an orbit in time; these are points of a map, without an interval")
        return 2 * np.pi * self.value / self.interval

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table: of each orbit its number, rotation number, error and number of steps."""
        rows: dict[str, NDArray[Any]] = {"trajectory": np.arange(len(self))}
        return rows | {"rotation_number": self.value, "error": self.error, "n_steps": self.n_steps}

    def __repr__(self) -> str:
        of = counted(len(self), "orbit")
        if len(self) == 1:
            return f"<Rotation number of {of}: {self.value[0]:.6g}, error {self.error[0]:.0e}>"
        good = self.error[np.isfinite(self.error)]
        largest = f"errors up to {good.max():.0e}" if len(good) else "no errors"
        return f"<Rotation numbers of {of}, {largest}>"


@explains_its_arguments
def rotation_number(
    orbit: Section | Orbit | ArrayLike,
    plane: Sequence[str] | None = None,
    *,
    center: ArrayLike | None = None,
) -> RotationNumbers:
    r"""Rotation numbers of orbits of a map or a flow, with errors, by weighted Birkhoff averages.

    Of a section the turn per crossing; take crossings of one direction.  On an invariant circle of the map of return it
    is $\pm\omega_2/\omega_1$ but for a whole number, with the frequencies $\omega_1$ of the returns and $\omega_2$.  Of
    an orbit at equal times `frequency` is the mean turn in radians per time, if it turns by less than half a turn in an
    interval: an integer combination of the frequencies of the torus, unless the torus meets the center.  Where it does
    the mean is no such combination, and converges slowly, as the error says.

    Errors of the points, such as those of the integration, are not in the error.

    Example:
        >>> angle = 2 * np.pi * (5**0.5 - 1) / 2 * np.arange(2001)  # the golden mean, on an ellipse
        >>> found = lp.tori.rotation_number(np.stack([2 * np.cos(angle), np.sin(angle)], axis=1), center=[0.3, 0.2])
        >>> bool(abs(found.value[0] + 1 - (5**0.5 - 1) / 2) < 1e-14), bool(found.error[0] < 1e-12)
        (True, True)

    Args:
        orbit: What `section` or `integrate` returned; or points of a plane in the order of the map, shape (n, 2) or
            (trajectory, n, 2).
        plane: Two names or formulas, the coordinates of the plane; not for points.
        center: The point of the plane about which turns are counted, shape (2,).  It has to be inside of the invariant
            circle: from outside the value is 0.  By default the mean of the points of each orbit.

    Raises:
        ShapeError: points or the center have another shape.
        ParameterError: the plane is not two names or formulas, or the times are not equally far apart.

    References: [das2017].
    """
    points, interval, names = _points(orbit, plane)
    middle = None
    if center is not None:
        middle = as_array(center, "center", names)
        if middle.shape != (2,):
            raise ShapeError(f"center: wanted a point of the plane, shape (2,); got shape {middle.shape}")
        check_finite(middle, "center", "leave it out")
    with np.errstate(all="ignore"):
        found = [_average(each, middle) for each in points]
    numbers = np.array(found, dtype=np.float64).reshape(len(found), 2)
    steps = np.array([max(len(each) - 1, 0) for each in points], dtype=np.intp)
    return RotationNumbers(numbers[:, 0].copy(), numbers[:, 1].copy(), steps, interval)


def _points(given: Any, plane: Any) -> tuple[list[Array], float | None, tuple[str, ...]]:
    """The points of each orbit in the plane, shape (n, 2), the time between them, and the names of the plane."""
    if not isinstance(given, (Section, Orbit)):
        if plane is not None:
            raise ParameterError("plane: wanted it for a section or an orbit; points are in a plane. Leave it out.")
        points = as_array(given, "orbit")
        if points.ndim not in (2, 3) or points.shape[-1] != 2:
            raise ShapeError(f"orbit: wanted points of a plane, shape (n, 2) or (trajectory, n, 2); got {points.shape}")
        return list(points.reshape(-1, *points.shape[-2:])), None, ()
    names = () if plane is None else texts(plane, "plane", "names or formulas", '["y", "p_y"]')
    if len(names) != 2:
        raise ParameterError(f'plane: wanted two names or formulas, such as ["y", "p_y"]; got {plane!r:.60}')
    known = given.coordinates if isinstance(given, Section) else given.components
    system = given.system if known == given.components else None  # other functions of states are not in a section
    functions = [component_or_formula(system, known, name, "plane", "the points themselves") for name in names]
    if isinstance(given, Section):
        states, interval = [given.of(k) for k in range(given.n_trajectories)], None
    else:
        states, interval = list(given.state), _interval(given.time)
    return [np.stack([f(each) for f in functions], axis=-1) for each in states], interval, names


def _interval(time: Array) -> float:
    """The time between samples.

    Raises:
        ParameterError: it is not the same everywhere, but for round-off.
    """
    n = len(time) - 1
    step = float(time[-1] - time[0]) / max(n, 1)
    even = time[0] + step * np.arange(n + 1)
    if not np.abs(time - even).max() <= 4 * np.spacing(np.abs(time).max()):
        raise ParameterError(
            "orbit: wanted times equally far apart; these are not. Give times=np.linspace(...) to integrate."
        )
    return step


def _average(points: Array, center: Array | None) -> tuple[float, float]:
    """The rotation number of one orbit, and its error."""
    if len(points) <= _LEAST or not np.isfinite(points).all():
        return np.nan, np.nan
    x, y = np.ascontiguousarray(points.T)
    x, y = (x - x.mean(), y - y.mean()) if center is None else (x - center[0], y - center[1])
    if not (elementary.hypot(x, y) > 0).all():
        return np.nan, np.nan
    turns = _lifted(np.diff(elementary.arctan2(y, x)) / (2 * np.pi) % 1.0)
    half = len(turns) // 2
    whole = _weighted_mean(turns)
    error = max(abs(_weighted_mean(part) - whole) for part in (turns[:half], turns[-half:]))
    return whole - float(np.round(whole)), max(error, float(np.spacing(1.0)))


def _lifted(turns: Array) -> Array:
    """Turns that are known up to whole ones, cut where none of them is."""
    places = np.sort(turns)
    gaps = np.diff(places, append=places[0] + 1)
    first = places[(int(gaps.argmax()) + 1) % len(places)]
    return first + (turns - first) % 1.0


def _weighted_mean(values: Array) -> float:
    t = (np.arange(len(values)) + 0.5) / len(values)
    weights = elementary.exp(-1.0 / (t * (1 - t)))
    return float((weights * values).sum() / weights.sum())
