r"""MEGNO: the mean exponential growth of nearby orbits, which tends to 2 on a torus and grows with t in chaos."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson import _core
from liepoisson.formula.scalars import TIME_LIMIT, as_count, as_time
from liepoisson.indicators.alignment import bound_memory
from liepoisson.indicators.finite_time_exponents import finite_time_exponents
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import shows_progress
from liepoisson.io.result import labelled
from liepoisson.numeric.methods import MethodChoice
from liepoisson.numeric.run import Run, trajectories, typical, whole
from liepoisson.numeric.run_options import RunOptions
from liepoisson.numeric.sampling import as_first, sample_tangents
from liepoisson.numeric.starts import StartsLike, as_starts, as_states
from liepoisson.numeric.systems import HasField, at_equal_times, component_names

_N_TIMES = 200
# Trajectories whose fine samples are in memory at once: 256 x 4,096 numbers are 8 MB.
_CHUNK = 256
# Arrays of doubles of that size at once: exponents, logarithms, Y, its mean, and what they are made from.  Measured: 45
# bytes for each sample.
_ARRAYS = 6


@dataclass(frozen=True, kw_only=True, eq=False)
class Megno(Run):
    r"""MEGNO along trajectories.

    Example:
        >>> oscillator = lp.System(lp.canonical(1), "dot(p, p)/2 + dot(q, q)/2 + dot(q, q)^2/4")
        >>> found = lp.chaos.megno(oscillator, [1, 0], t_end=1000)
        >>> round(float(found.mean[0, -1]), 1)  # the frequency depends on the action
        2.0

    Attributes:
        start_tangent: Tangent vectors at time 0, shape (trajectory, component).
        n_samples: Samples of each trajectory.
        t_end: The last time.
        time: Times, evenly spaced up to `t_end`, shape (time,).
        megno: $Y(t)$, shape (trajectory, time); NaN from where a trajectory failed.
        mean: $\bar Y(t) = t^{-1}\int_0^t Y\,ds$, shape (trajectory, time).
        log_growth: $\ln(|v(t)|/|v(0)|)$, that is t times the finite-time exponent, shape (trajectory, time).
        quadrature_error: The largest change of Y at any of the times when only every second sample is used, shape
            (trajectory,); the error of Y is most likely smaller.
    """

    kind = "megno"
    made_by = "megno"

    seed: int
    first: int
    n_samples: int
    t_end: float
    start_tangent: Array = labelled("trajectory", "component", long_name="tangent vector at time 0")
    time: Array = labelled("time", long_name="time", is_coordinate=True)
    megno: Array = labelled("trajectory", "time", long_name="MEGNO", units="1")
    mean: Array = labelled("trajectory", "time", long_name="mean of MEGNO over time", units="1")
    log_growth: Array = labelled("trajectory", "time", long_name="logarithm of the growth", units="1")
    quadrature_error: Array = labelled("trajectory", long_name="change with half as many samples", units="1")

    def arguments(self) -> dict[str, Any]:
        """What `megno` was called with."""
        own = {name: getattr(self, name) for name in ("seed", "first", "n_samples")}
        return super().arguments() | own | {"t_end": whole(self.time, self.t_end), "tangents": self.start_tangent}

    def __repr__(self) -> str:
        value = typical("averaged MEGNO", self.mean[:, -1])
        return f"<Megno of {self.system.name}: {trajectories(self.outcome)}, {value} at t = {self.time[-1]:g}>"


@shows_progress
def megno(
    system: HasField,
    starts: StartsLike,
    *,
    t_end: float,
    n_samples: int = 4096,
    tangents: ArrayLike | None = None,
    seed: int = 0,
    first: int = 0,
    method: MethodChoice | None = None,
    threads: int | None = None,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> Megno:
    r"""Mean exponential growth factor of nearby orbits along each trajectory.

    For a tangent vector v,

    $$Y(t) = \frac2t\int_0^t\frac{d\ln|v|}{ds}\,s\,ds = 2\Bigl[\ln\frac{|v(t)|}{|v(0)|}
      - \frac1t\int_0^t\ln\frac{|v(s)|}{|v(0)|}\,ds\Bigr],\qquad \bar Y(t) = \frac1t\int_0^t Y\,ds.$$

    $\bar Y\to 2$ where v grows linearly, as on a torus whose frequencies depend on the actions; 2p where it grows like
    $t^p$; 0 where it stays bounded (isochronous motion, a stable equilibrium); $\bar Y\sim\lambda t/2$ and
    $Y\sim\lambda t$ on an orbit with exponent $\lambda > 0$.

    The second form needs no derivative.  Its integral is taken by the trapezoidal rule on equal steps of
    `t_end/n_samples`; `quadrature_error` says how much the result changes with half as many.

    Example:
        >>> system = lp.catalog.system("henon-heiles")
        >>> starts = [[0, 0.1, 0.3, 0], [0, -0.1, 0.5, 0]]  # energies 0.05 and 0.13
        >>> lp.chaos.megno(system, starts, t_end=1000).mean[:, -1].round(1)  # about 2 on a torus
        array([ 1.7, 31.8])

    Args:
        t_end: Last time, positive, in units of the system's own time.
        n_samples: Samples of $\ln|v|$, at least 8, rounded up to a multiple of twice the number of times returned.
        tangents: Tangent vectors at time 0, shape (trajectory, component), not zero, instead of random ones.
        seed: Draws the tangent vectors, uniform on the unit sphere of the phase space.
        method: How; by default `Taylor(tol=1e-13)`.  Methods without power series step to every sample.

    Returns:
        Megno, at 200 times (fewer if `n_samples` is below 400); a trajectory that fails is an outcome in it.

    Raises:
        ShapeError: `starts` has another shape than stated.
        ParameterError: Numbers that are not finite, a time that is not positive, a count that is none, or samples of
            more than 4 GiB for the 256 trajectories that run at once.
        KeyboardInterrupt: Ctrl-C.

    References:
        Cincotta and Simó, Astron. Astrophys. Suppl. 147 (2000) 205; Cincotta, Giordano and Simó, Physica D
        182 (2003) 151.
    """
    options = RunOptions.read(method, threads, time_limit, progress, seed=seed, first=first, system=system)
    field = options.tangent_field(system)
    states = as_starts(system, starts, n := field.n_components)
    end = as_time(t_end, "t_end", example=1000)
    samples = as_count(n_samples, "n_samples", least=8, most=2**26, hint="try n_samples=4096")
    first = as_first(options.first, len(states))
    drawn = at_equal_times(system, sample_tangents(n, len(states), **options.drawn))
    vectors = drawn if tangents is None else tangents
    vectors = np.broadcast_to(as_states(vectors, n, "tangents", names=component_names(system, n)), states.shape)
    n_times = min(_N_TIMES, samples // 2)
    stride = 2 * -(-samples // (2 * n_times))
    at_once = min(_CHUNK, len(states))
    bound_memory(8 * _ARRAYS * (at_once + 1) * stride * n_times, samples, at_once)
    fine = end * np.arange(1, stride * n_times + 1) / (stride * n_times)
    parts: list[tuple[Array, ...]] = []
    outcome: list[NDArray[np.str_]] = []
    spare = states[np.isfinite(states).all(axis=1)][:1]
    for start in range(0, max(1, len(states)), _CHUNK):  # once for no states: empty arrays of the right shapes
        chunk = states[start : start + _CHUNK]
        if parts and options.is_late:  # the first one gives the shapes
            parts.append(tuple(np.full((len(chunk), *column.shape[1:]), np.nan) for column in parts[0]))
            outcome.append(np.where(np.isfinite(chunk).all(axis=1), "time limit", "not finite"))
            continue
        growth = finite_time_exponents(
            system,
            # an ensemble may have bad rows, but not only bad ones: a good one stands beside them and is dropped
            np.concatenate([chunk, spare]),
            times=fine,
            tangents=np.concatenate([vectors[start : start + _CHUNK], vectors[:1]])[: len(chunk) + len(spare)],
            **options.inner(start / max(1, len(states)), len(chunk) / max(1, len(states))),
        )
        parts.append(_indicators(fine, growth.exponent[: len(chunk)] * fine, stride))
        outcome.append(growth.outcome[: len(chunk)])
    values, means, logs, errors = (np.concatenate(column) for column in zip(*parts, strict=True))
    return Megno(
        **options.given(system, states, field),
        seed=options.seed,
        first=first,
        n_samples=samples,
        t_end=end,
        start_tangent=vectors,
        time=fine[stride - 1 :: stride],
        megno=values,
        mean=means,
        log_growth=logs,
        quadrature_error=errors,
        outcome=np.concatenate(outcome),
    )


def _indicators(time: Array, log_growth: Array, stride: int) -> tuple[Array, Array, Array, Array]:
    """Y, its mean, ln|v| at every `stride`-th time, and the change of Y with every second sample."""
    values, means = _of_growth(time, log_growth)
    every, pairs = slice(stride - 1, None, stride), slice(1, None, 2)
    coarse, _ = _of_growth(time[pairs], log_growth[:, pairs])
    change = np.abs(coarse[:, stride // 2 - 1 :: stride // 2] - values[:, every])
    return values[:, every], means[:, every], log_growth[:, every], change.max(axis=1)


def _of_growth(time: Array, log_growth: Array) -> tuple[Array, Array]:
    """Y and its mean at each of the equally spaced times, of which the first one is a step."""
    values, means = _core.megno(np.ascontiguousarray(time), np.ascontiguousarray(log_growth).ravel())
    return values.reshape(log_growth.shape), means.reshape(log_growth.shape)
