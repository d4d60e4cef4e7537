r"""The time scale of an orbit: the time in which neighbours of the orbit turn or move apart by a factor of order e.

$$ T = 1\,/\,\mathrm{median}_k\,\rho\bigl(Df(x(t_k))\bigr) $$

with the spectral radius of the derivative of the field at 8 times of the first stretch of the orbit.  Multiply H by c
and T is divided by c; scale each component of the state by a number of its own and T stays.  So t/T is a pure number,
the length of a run in natural units, and whatever is said of t/T is said whatever the units.

Where all eigenvalues vanish, $\sqrt{\frac12\sum_{ij}|A_{ij}A_{ji}|}$ takes the place of the spectral radius; where this
vanishes, too, as for x' = p, p' = 0, a norm of Df: the smaller one of the Euclidean norm and of that with each
component in units of its own root mean square along the stretch.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson.compile.field import Field, PiecesField
from liepoisson.formula.scalars import TIME_LIMIT
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.numeric.integrate import Orbit, integrate
from liepoisson.numeric.methods import MethodChoice
from liepoisson.numeric.run_options import ENSEMBLE_METHOD, RunOptions
from liepoisson.numeric.starts import StartsLike, as_starts
from liepoisson.numeric.systems import HasField, as_field, n_of_time, periods_of_components, tangent_field
from liepoisson.portable import elementary, linear

N_POINTS = 8
"""Points of the orbit at which the derivative of the field is taken: those of a stretch of some 32 natural times."""

N_MEDIAN = 256
"""Orbits whose median natural time is the unit of default times: each costs about 1 ms."""

_STRETCH = 32.0
# Df is read off M(h) = 1 + h Df + O(h^2) at the first rung h at which |M(h) - 1| is this large: then it is at most
# 1e-6, and Df has relative errors of that size from the order and of 1e-8 from round-off.
_LEAST_CHANGE, _RUNG = 1e-8, 1e2
_LOWEST, _HIGHEST = 1e-60, 1e60
# Below this part of the coupling all eigenvalues count as zero: those of a nilpotent matrix of three rows, with errors
# of 1e-8 in its entries, are some 1e-3 of its norm.  Where neither is above round-off the matrix is triangular.
_NILPOTENT, _ROUND_OFF = 1e-2, 1e-12
# A change of unit that makes row and column smaller by less than a twentieth is not worth it, as in LAPACK.
_SWEEPS, _GAIN = 100, 0.95
_CHUNK, _TOGETHER = 256, 32
_NO_UNIT = 1e-6


@explains_its_arguments
def time_scale(
    system: HasField,
    starts: StartsLike,
    *,
    method: MethodChoice | None = None,
    threads: int | None = None,
    time_limit: float = TIME_LIMIT,
) -> Array:
    r"""The natural unit of time of each orbit, $T = 1/\mathrm{median}_k\,\rho(Df(x(t_k)))$.

    The median is over 8 points of the first 32 natural times or so of the orbit, and $\rho$ is the spectral
    radius.  For a linear oscillator T is 1 over its angular frequency, beside a saddle 1 over the largest exponent.

    Example:
        >>> oscillator = lp.System(lp.canonical(1), "dot(p, p)/2 + 9*dot(q, q)/2")
        >>> lp.orbits.time_scale(oscillator, [1, 0]).round(9)  # 1 over the angular frequency
        array([0.33333333])

    Args:
        starts: States at time 0, shape (component,) or (trajectory, component).
        method: How; needed for a field that is given by its pieces, else power series are used.
        time_limit: Seconds that it may take.

    Returns:
        Shape (trajectory,), in units of the system's own time; infinite where Df vanishes, NaN where the start or the
        orbit is not finite, or no time was left.

    Raises:
        ShapeError: `starts` has another shape than stated.
        ParameterError: no start is finite.
    """
    return orbit_units(system, starts, RunOptions.read(method, threads, time_limit, system=system)).time


class OrbitUnits(NamedTuple):
    """Natural units of orbits.

    Attributes:
        time: As `time_scale` returns it, shape (trajectory,).
        component: Root mean square of each component of the state along the first stretch, shape (trajectory,
            component), at most a radian of an angle, which may turn.  Of components that are zero or less than 1e-6 of
            the largest one the size is no unit, as it may be round-off: they have the unit of the largest one, or a
            smaller one in which they act on the others about as strongly as these on them, if that is less than 1e-6
            of it.  The largest unit is 1 where all components are zero, and all are where the orbit failed.
    """

    time: Array
    component: Array

    def of_frames(self) -> Array:
        """Units of tangent vectors that are made orthogonal, shape (trajectory, component).

        Powers of two, for which vectors change without round-off; 1 for all components that have not a unit of another
        order than the largest one, so that vectors in ordinary units are as they are.
        """
        part = self.component / self.component.max(axis=1, keepdims=True)
        return np.where(part > _NO_UNIT, 1.0, elementary.exp2(np.round(elementary.log2(part))))


@np.errstate(all="ignore")  # what overflows or vanishes has no unit, which is said by NaN or infinity
def orbit_units(system: HasField, starts: StartsLike, options: RunOptions) -> OrbitUnits:
    """Natural units of time and of each component along orbits, before the deadline of the options.

    Raises:
        ShapeError: `starts` has another shape than stated.
        ParameterError: no start is finite.
    """
    field = tangent_field(system, as_field(system))
    # whatever the caller's method, but a field that is given by its pieces knows no other
    how = options.method if isinstance(field, PiecesField) else ENSEMBLE_METHOD
    states, n_of = as_starts(system, starts, field.n_components), n_of_time(system)
    if n_of:
        states[:, -1] = 0.0  # the momentum of time is at rest, and its size tells nothing
    run = _Run(system.name, field, replace(options, method=how, progress=None), n_of)
    rate, size = np.full(len(states), np.nan), np.full(states.shape, np.nan)
    slopes = np.full((*states.shape, states.shape[1]), np.nan)
    good = np.flatnonzero(np.isfinite(states).all(axis=1))
    for start in range(0, len(good), _CHUNK):
        if options.is_late:
            break
        chunk = good[start : start + _CHUNK]
        rate[chunk], size[chunk], slopes[chunk] = _rates(run, states[chunk])
    radian = periods_of_components(system, states.shape[1]) / (2 * np.pi)
    size = np.minimum(size, radian)
    units, n = np.ones_like(size), size.shape[1] - n_of
    units[:, :n] = _units(size[:, :n], slopes[:, :n, :n])
    if n_of:  # time is known exactly, and its size is no measure of the others
        units[:, n] = np.where(size[:, n] > 0.0, size[:, n], 1.0)
        units[:, n + 1] = units[:, :n].max(axis=1)
    return OrbitUnits(1.0 / rate, units)


def zero_threshold(time: ArrayLike, scale: ArrayLike) -> Array:
    r"""$3\ln(t/T)/t$: finite-time exponents below are consistent with zero; $3/t$ before t = e T, infinite at t = 0.

    Tangent vectors grow like t/T on a regular torus, and the factor 3 leaves room.  It bounds no exponent: any orbit
    may be below at time t and above later.  It is no verdict, either: that is what `decide` is for.

    Args:
        time: Averaging times.
        scale: The time scales T, of a shape that goes with that of the times; NaN gives NaN.
    """
    t, unit = np.broadcast_arrays(np.asarray(time, np.float64), np.asarray(scale, np.float64))
    with np.errstate(divide="ignore", invalid="ignore"):
        logarithm = elementary.log(np.maximum(t / unit, math.e))
        return np.where(t > 0, 3.0 * logarithm / t, np.where(np.isnan(unit), np.nan, np.inf))


def natural_duration(n: float, scale: Array, *, fastest: bool = False, otherwise: float) -> float:
    """About n natural times of the median orbit or of the fastest one, to two significant digits.

    Args:
        n: How many.
        scale: Time scales, shape (trajectory,).
        fastest: Of the fastest orbit.
        otherwise: What is taken where no orbit has a time scale, as where the field vanishes.
    """
    known = scale[np.isfinite(scale) & (scale > 0)]
    if not len(known):
        return otherwise
    return float(f"{n * float(known.min() if fastest else np.median(known)):.1e}")


def unit_of_time(scale: Array) -> float:
    """The natural time of the median orbit, to two digits; 1 where none has one, as at rest in no field.

    Default times and steps are taken in it, so that they suit systems that are fast or slow.

    Args:
        scale: Time scales, shape (trajectory,), of which the first 256 count.
    """
    return natural_duration(1.0, scale[:N_MEDIAN], otherwise=1.0)


class _Run:
    """Short integrations of a system before a deadline."""

    def __init__(self, name: str, field: Field, options: RunOptions, n_of_time: int) -> None:
        self.name, self._n_of_time = name, n_of_time
        self._field, self._options = field, options
        # Steps of power series do not depend on the wanted times; those of a splitting end there.
        self.together = 1 if isinstance(field, PiecesField) else _TOGETHER

    def field(self) -> Field:
        return self._field

    def states(self, starts: Array, times: Array) -> Array:
        """States of each trajectory at its own times, shape (trajectory, time); NaN at times that it did not reach."""
        every, places = np.unique(np.concatenate([[0.0], times.ravel()]), return_inverse=True)
        state = self._integrated(starts, every, None).state
        return state[np.arange(len(starts))[:, None], places[1:].reshape(times.shape)]

    def changes(self, starts: Array, h: float) -> Array:
        """M(h) - 1, shape (trajectory, component, component); NaN where a trajectory failed."""
        n = starts.shape[1]
        identity = np.diag(np.arange(n) < n - self._n_of_time).astype(float)  # time has no neighbours
        orbit = self._integrated(starts, [0.0, h], np.tile(identity, (len(starts), 1, 1)))
        # tangents are rows; a transposed matrix has the same eigenvalues, but not the same scaled norm
        return np.swapaxes(orbit.tangent[:, 1], 1, 2) - identity

    def _integrated(self, starts: Array, times: ArrayLike, tangents: Array | None) -> Orbit:
        return integrate(
            self,
            starts,
            times=times,
            tangents=tangents,
            kernel="lanes",  # the same bits however the ensemble is cut
            **self._options.inner(),
        )


def _units(size: Array, slopes: Array) -> Array:
    """Sizes of components that can be units, and others by the derivatives of the field, (trajectory, row, column)."""
    known = np.where(np.isfinite(size), size, 0.0)
    largest = known.max(axis=1, keepdims=True)
    is_unit = known > _NO_UNIT * largest
    units = np.where(is_unit, known, np.where(largest > 0.0, largest, 1.0))
    some = np.flatnonzero(~is_unit.all(axis=1) & np.isfinite(slopes).all(axis=(1, 2)))
    if len(some):
        scaled = slopes[some] * units[some, None, :] / units[some, :, None]
        part = balanced(scaled, ~is_unit[some])[1]
        part /= np.where(largest[some] > 0.0, 1.0, part.max(axis=1, keepdims=True))  # at the origin all are free
        units[some] *= np.where(part < _NO_UNIT, part, 1.0)
    return units


def _rates(run: _Run, starts: Array) -> tuple[Array, Array, Array]:
    """What is known of the first stretch of each orbit.

    Returns:
        The median spectral radius of Df, the sizes of the components and those of the entries of Df.
    """
    at_start, rung = _derivatives(run, starts, np.full(len(starts), _LOWEST))
    radius, coupling = _radius(at_start, np.abs(starts)), _coupling(at_start)
    # where components act on each other in longer circles only, what is left of the coupling is round-off
    first = np.where(coupling > _NILPOTENT * radius, coupling, radius)
    doubtful = np.flatnonzero((first < _NILPOTENT * (most := _norm(at_start, np.abs(starts)))) & np.isfinite(most))
    for start in range(0, len(doubtful), run.together):
        some = doubtful[start : start + run.together]
        first[some] = _first_turn(run, starts[some], first[some], most[some], rung[some])
    rates, sizes, slopes = first.copy(), np.abs(starts), np.abs(at_start)
    moving = np.flatnonzero((first > 0.0) & np.isfinite(first))
    lengths = _STRETCH / first[moving]
    # A few trajectories with stretches of about the same length run together, each seen at times of its own.
    octave = np.floor(elementary.log2(lengths))
    for which in sorted({*octave.tolist()}):
        alike = np.flatnonzero(octave == which)
        for start in range(0, len(alike), run.together):
            some = alike[start : start + run.together]
            members = moving[some]
            orbit = run.states(starts[members], lengths[some, None] * np.arange(N_POINTS) / (N_POINTS - 1))
            sizes[members] = np.sqrt((orbit**2).mean(axis=1))
            rates[members], slopes[members] = _median_radius(run, orbit, sizes[members], rung[members])
    return rates, sizes, slopes


def _first_turn(run: _Run, starts: Array, least: Array, most: Array, rung: Array) -> Array:
    r"""The inverse of the first time $\tau$ with $\tau\rho(Df(x(\tau))) \ge 1$, among $4^k$ over `most`.

    At a start at which Df happens to be nilpotent or nearly so its spectral radius, `least`, tells nothing of the
    orbit: a particle in the potential $x^4$ at x = 0 has none.  The result is not below it.
    """
    rate, left = least.copy(), np.arange(len(starts))
    tau = 1.0 / most
    while len(left := left[tau[left] * least[left] < 1.0]):
        states = run.states(starts[left], tau[left, None])[:, 0]
        reached = np.isfinite(states).all(axis=1)
        turned = np.full(len(left), np.inf)  # an orbit that ends before is not followed so far
        if reached.any():
            derivatives, _ = _derivatives(run, states[reached], rung[left[reached]] / _RUNG)
            turned[reached] = tau[left[reached]] * _radius(derivatives, np.abs(states[reached]))
        done = ~(turned < 1.0)
        rate[left[done]] = 1.0 / tau[left[done]]
        left = left[~done]
        tau[left] *= 4.0
    return rate


def _median_radius(run: _Run, orbit: Array, sizes: Array, rung: Array) -> tuple[Array, Array]:
    """Median over the points of orbits, shape (trajectory, time, component), of the spectral radius of Df.

    Returns:
        It, and the mean sizes of the entries of Df.
    """
    scale = np.repeat(sizes, N_POINTS, axis=0)
    points = orbit.reshape(-1, orbit.shape[2])
    reached = np.isfinite(points).all(axis=1)
    found, slopes = np.full(len(points), np.nan), np.full((*points.shape, points.shape[1]), np.nan)
    if reached.any():
        derivatives, _ = _derivatives(run, points[reached], np.repeat(rung, N_POINTS)[reached] / _RUNG)
        found[reached], slopes[reached] = _radius(derivatives, scale[reached]), np.abs(derivatives)
    each = slopes.reshape(len(orbit), N_POINTS, *slopes.shape[1:])
    return np.median(found.reshape(len(orbit), N_POINTS), axis=1), each.mean(axis=1)


def _derivatives(run: _Run, states: Array, lowest: Array) -> tuple[Array, Array]:
    """Df at states, from a rung of times h upwards, and the rung that was taken; zero where nothing changes."""
    n = states.shape[1]
    derivatives, rung = np.zeros((len(states), n, n)), lowest.copy()
    left = np.arange(len(states))
    while len(left):
        for h in sorted({*rung[left].tolist()}):
            here = left[rung[left] == h]
            change = run.changes(states[here], float(h))
            derivatives[here] = change / h
            size = linear.norm(change, axis=(1, 2)) if len(here) else np.zeros(0)
            done = ~(size < _LEAST_CHANGE)
            left = np.setdiff1d(left, here[done], assume_unique=True)
            rung[here[~done]] *= _RUNG
        gone = rung[left] > _HIGHEST
        derivatives[left[gone]] = 0.0
        left = left[~gone]
    return derivatives, rung


def _coupling(matrices: Array) -> Array:
    r"""$\sqrt{\frac12\sum_{ij}|A_{ij}A_{ji}|}$, shape (matrix,): 1 for a rotation, as is its spectral radius.

    It knows no units of components, either, and unlike the spectral radius it hardly changes with small errors where
    eigenvalues coincide.
    """
    products = np.abs(matrices * np.swapaxes(matrices, 1, 2))
    return np.sqrt(0.5 * products.sum(axis=(1, 2)))


def _radius(matrices: Array, scale: Array) -> Array:
    """Spectral radii, shape (matrix,); of nilpotent matrices the coupling, or if this is zero, too, a norm."""
    result = np.full(len(matrices), np.nan)
    good = np.isfinite(matrices).all(axis=(1, 2))
    if good.any():
        result[good] = _finite_radius(matrices[good], scale[good])
    return result


def _finite_radius(matrices: Array, scale: Array) -> Array:
    scaled, coupling = balanced(matrices)[0], _coupling(matrices)
    radius = np.abs(linear.eigvals(scaled)).max(axis=1)
    rate = np.where(radius > _NILPOTENT * coupling, radius, coupling)
    known = rate > _ROUND_OFF * linear.norm(scaled, axis=(1, 2))
    return np.where(known, rate, _norm(matrices, scale))


def _norm(matrices: Array, scale: Array) -> Array:
    """Euclidean norms, shape (matrix,), or those with components in units of `scale` where they are smaller."""
    largest = scale.max(axis=1, keepdims=True)
    units = np.where(scale > 0.0, scale, np.where(largest > 0.0, largest, 1.0))
    scaled = matrices * units[:, None, :] / units[:, :, None]
    return np.minimum(*(linear.norm(each, axis=(1, 2)) for each in (matrices, scaled)))


def balanced(matrices: Array, which: NDArray[np.bool_] | None = None) -> tuple[Array, Array]:
    """Matrices with each component in a unit of its own, a power of two, so that row and column are about equal.

    So the norm can be compared with eigenvalues whatever the units: the size of a component at one moment is no unit,
    as it may vanish there.  The iteration is that of Osborne, as in LAPACK; a component on which nothing depends, or
    that depends on nothing, keeps its unit.

    Args:
        matrices: Shape (matrix, component, component).
        which: Components that may have a unit of their own, shape (matrix, component); by default all.

    Returns:
        The matrices and the units, shape (matrix, component).
    """
    result, units = matrices.copy(), np.ones(matrices.shape[:2])
    for _ in range(_SWEEPS):
        is_changed = False
        for k in range(result.shape[1]):
            diagonal = np.abs(result[:, k, k])
            row, column = (np.abs(each).sum(axis=1) - diagonal for each in (result[:, k, :], result[:, :, k]))
            unit = elementary.exp2(np.round(0.5 * (elementary.log2(row) - elementary.log2(column))))
            gains = (row > 0.0) & (column > 0.0) & (row / unit + column * unit < _GAIN * (row + column))
            if which is not None:
                gains &= which[:, k]
            unit = np.where(gains, unit, 1.0)[:, None]
            result[:, k, :] /= unit
            result[:, :, k] *= unit
            units[:, k] *= unit[:, 0]
            is_changed |= bool(gains.any())
        if not is_changed:
            break
    return result, units
