r"""SALI and GALI: how nearly parallel tangent vectors of an orbit have become."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson import _core
from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import TIME_LIMIT, as_count
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import shows_progress
from liepoisson.inputs.refusals import check_choice, shown
from liepoisson.io.result import labelled
from liepoisson.numeric.integrate import integrate
from liepoisson.numeric.methods import MethodChoice
from liepoisson.numeric.run import Run, trajectories, typical
from liepoisson.numeric.run_options import RunOptions
from liepoisson.numeric.sampling import as_first, sample_alignment_vectors
from liepoisson.numeric.starts import StartsLike, as_forward_times, as_starts, as_states
from liepoisson.numeric.systems import HasField, component_names, has_functions
from liepoisson.portable import elementary, linear

Within: TypeAlias = Literal["space", "leaf", "energy"]

FLOOR = 1e-16
"""Least distance between two unit vectors that doubles resolve: the unit round-off, 1.1e-16, to a power of ten."""

N_TIMES = 100

MOST_BYTES = 4 * 2**30
"""Most memory that the samples of the trajectories that run at once may take."""

# The largest number is e^709.  A vector that grew by more than e^600 within a piece, or may have overflowed, has the
# piece repeated in two halves.
_MOST_GROWTH = 600.0


@dataclass(frozen=True, kw_only=True, eq=False)
class Alignment(Run):
    r"""Alignment indices of unit vectors $\hat v_1, \hat v_2, \ldots$ along trajectories.

    Example:
        >>> system = lp.catalog.system("henon-heiles")
        >>> found = lp.chaos.alignment(system, {"y": 0.1, "p_x": 0.3}, t_end=1000)
        >>> bool(found.sali[0].min() > 1e-3)  # the two vectors never align: a torus
        True

    Attributes:
        unit: Units of the components in which vectors are drawn and angles taken, shape (trajectory, component).
        within: Where the vectors started: "space", "leaf" or "energy".
        time: Times, shape (time,).
        sali: $\min(|\hat v_1 + \hat v_2|, |\hat v_1 - \hat v_2|)$, between 1e-16 and $\sqrt 2$, shape
            (trajectory, time); NaN from where a trajectory failed.
        log_gali: $\ln\mathrm{GALI}_k$ for k = 2, 3, ..., shape (trajectory, time, order).
    """

    kind = "alignment"
    made_by = "alignment"

    seed: int
    first: int
    within: Within
    unit: Array = labelled("trajectory", "component", long_name="unit of each component")
    time: Array = labelled("time", long_name="time", is_coordinate=True)
    sali: Array = labelled("trajectory", "time", long_name="smaller alignment index", units="1")
    log_gali: Array = labelled(
        "trajectory", "time", "order", long_name="logarithms of the alignment indices of 2, 3, ... vectors", units="1"
    )

    def arguments(self) -> dict[str, Any]:
        """What `alignment` was called with."""
        own = {"times": self.time, "units": None if (self.unit == 1).all() else self.unit, "within": self.within}
        drawn = {"seed": self.seed, "first": self.first, "n_vectors": self.log_gali.shape[-1] + 1}
        return super().arguments() | own | drawn

    def gali(self, k: int) -> Array:
        r"""$\mathrm{GALI}_k = |\hat v_1\wedge\cdots\wedge\hat v_k|$, shape (trajectory, time); 0 where it underflows.

        Raises:
            ParameterError: k is not from 2 to the number of vectors.
        """
        k = as_count(k, "k", least=2, most=self.log_gali.shape[-1] + 1)
        return elementary.exp(self.log_gali[..., k - 2])

    def __repr__(self) -> str:
        n_vectors, value = self.log_gali.shape[-1] + 1, typical("SALI", self.sali[:, -1])
        return (
            f"<Alignment of {self.system.name}: {n_vectors} tangent vectors of {trajectories(self.outcome)}, {value} "
            f"at t = {self.time[-1]:g}>"
        )


@shows_progress
def alignment(
    system: HasField,
    starts: StartsLike,
    *,
    t_end: float | None = None,
    times: ArrayLike | None = None,
    n_vectors: int = 2,
    within: Within = "space",
    units: ArrayLike | None = None,
    seed: int = 0,
    first: int = 0,
    method: MethodChoice | None = None,
    threads: int | None = None,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> Alignment:
    r"""Smaller and generalized alignment indices: SALI of two tangent vectors, GALI_k of k.

    Each vector follows the variational equations by itself and is only scaled to length one, never made orthogonal.
    $\mathrm{GALI}_k$ is the volume of the parallelepiped that they span, the product of the diagonal of R in a QR
    decomposition; SALI measures the angle of the first two.  With exponents $\lambda_1\ge\lambda_2\ge\ldots$ a chaotic
    orbit has $\mathrm{SALI}\sim e^{-(\lambda_1-\lambda_2)t}$ and
    $\mathrm{GALI}_k\sim e^{-\sum_{j=2}^k(\lambda_1-\lambda_j)t}$.  On a torus of n dimensions whose frequencies depend
    on all actions, tangent vectors turn into the n directions of the torus.  There $\mathrm{GALI}_k$ stays of order one
    for $k\le n$ and falls like a power of t for more vectors.  Vectors that are tangent to the energy surface, too,
    know one action less: $\mathrm{GALI}_n$ then falls like 1/t.

    Directions closer than the round-off cannot be told apart: SALI and each factor of GALI_k are 1e-16 at least, and
    what has come down to that floor says no more than "at most this".

    Example:
        >>> system = lp.catalog.system("henon-heiles")
        >>> starts = [[0, 0.1, 0.3, 0], [0, -0.1, 0.5, 0]]  # energies 0.05 and 0.13
        >>> sali = lp.chaos.alignment(system, starts, t_end=1000).sali[:, -1]
        >>> sali > 0.1, sali < 1e-10
        (array([ True, False]), array([False,  True]))

    Args:
        t_end: Last time, positive; the indices are then given at 100 times spaced evenly in the logarithm, from
            `t_end`/1000 on.
        times: The times themselves, positive and increasing, shape (time,), instead of `t_end`.
        n_vectors: Number of tangent vectors, from 2 to the number of components.
        within: Where the vectors start: "space", uniform directions in the whole phase space; "leaf", tangent to the
            symplectic leaf, $v = J(x_0)w$ with w uniform; "energy", tangent to the energy surface on the leaf, with
            $w\perp J\nabla H$.  The flow keeps them there.
        units: Unit of each component along each orbit, positive, shape (trajectory, component): angles and lengths are
            those of $v_i/u_i$, and vectors in the whole space are drawn uniformly in these; by default 1.
        seed: Draws the tangent vectors, in a stream of their own: they are independent of the vector of an exponent or
            MEGNO with the same seed.

    Returns:
        Alignment; a trajectory that fails is an outcome in it, not an error.

    Raises:
        ShapeError: An array has another shape than stated.
        ParameterError: Numbers that are not finite, a time that is not positive, both or neither of `t_end` and
            `times`, an unknown `within`, or more vectors than the leaf or its energy surface has dimensions.
        KeyboardInterrupt: Ctrl-C.

    References:
        Skokos, J. Phys. A 34 (2001) 10029; Skokos, Bountis and Antonopoulos, Physica D 231 (2007) 30.
    """
    options = RunOptions.read(method, threads, time_limit, progress, seed=seed, first=first, system=system)
    field = options.tangent_field(system)
    n = field.n_components
    states, wanted = as_starts(system, starts, n), as_forward_times(t_end, times, N_TIMES)
    if n < 2:
        raise ParameterError(
            f"system: wanted one with at least 2 components, as two tangent vectors are compared; {system.name} has "
            f"{n}, and all tangent vectors are parallel"
        )
    k = as_count(n_vectors, "n_vectors", least=2, most=n)
    first = as_first(options.first, len(states))
    size = (
        np.ones(states.shape) if units is None else _as_units(units, states, component_names(system, states.shape[1]))
    )
    sali = np.full((len(states), len(wanted)), np.nan)
    log_gali = np.full((len(states), len(wanted), k - 1), np.nan)
    outcome = np.where(np.isfinite(states).all(axis=1), "finished", "not finite").astype("<U16")
    known: dict[str, Any] = {
        **options.given(system, states.copy(), field),
        **options.drawn, "within": within, "unit": size, "time": wanted,
    }  # fmt: skip
    if options.is_late:  # before vectors are drawn: of many trajectories this takes seconds
        outcome[outcome == "finished"] = "time limit"
        return Alignment(**known, sali=sali, log_gali=log_gali, outcome=outcome)
    drawn = sample_alignment_vectors(n, len(states), k, seed=options.seed, first=first)
    vectors = _first_vectors(system, states, drawn * size[:, None] if within == "space" else drawn, within)
    n_done = 0
    # pieces may be done again in halves: within one, the times before it are what is done
    listen = None if progress is None else lambda _: progress(n_done / len(wanted))
    part = replace(options, progress=listen)
    before, moving = 0.0, system if getattr(system, "clock", None) is None else field
    for i, now in enumerate(wanted.tolist()):
        alive = np.flatnonzero(outcome == "finished")
        if not len(alive):
            break
        states[alive], vectors[alive], outcome[alive] = _carried(
            moving, states[alive], vectors[alive], (before, now), part
        )
        good = np.flatnonzero(outcome == "finished")
        seen = vectors[good] if units is None else _unit(vectors[good] / size[good][:, None])
        sali[good, i], log_gali[good, i] = _sali(seen), _log_gali(seen)
        before, n_done = now, i + 1
        options.tell(n_done / len(wanted))
    return Alignment(**known, sali=sali, log_gali=log_gali, outcome=outcome)


def _carried(
    system: HasField, states: Array, vectors: Array, times: tuple[float, float], options: RunOptions
) -> tuple[Array, Array, NDArray[np.str_]]:
    """States and unit vectors at another time, and outcomes; the vectors come back with length one."""
    orbit = integrate(system, states, times=times, tangents=vectors, **options.inner())
    after, grown, outcome = orbit.state[:, 1].copy(), orbit.tangent[:, 1].copy(), orbit.outcome.copy()
    arrived = outcome == "finished"
    longest = np.abs(grown).max(axis=(1, 2))
    # Halving depends on the trajectory alone, so it is the same in any ensemble.
    again = np.flatnonzero(arrived & ~(longest < elementary.exp(_MOST_GROWTH)))
    start, end = times
    middle = 0.5 * (start + end)
    if len(again) and start < middle < end:
        half, turned, ended = _carried(system, states[again], vectors[again], (start, middle), options)
        after[again], grown[again], outcome[again] = half, turned, ended
        onward = again[ended == "finished"]
        if len(onward):
            there = _carried(system, after[onward], grown[onward], (middle, end), options)
            after[onward], grown[onward], outcome[onward] = there
    return after, _unit(grown), outcome


def _unit(vectors: Array) -> Array:
    """Vectors scaled to length one; first by their largest component, whose square may overflow or underflow."""
    largest = np.abs(vectors).max(axis=-1, keepdims=True)
    vectors = np.divide(vectors, largest, out=np.full_like(vectors, np.nan), where=(largest > 0) & (largest < np.inf))
    return vectors / linear.norm(vectors, axis=-1, keepdims=True)


def _sali(vectors: Array) -> Array:
    return _core.sali(np.ascontiguousarray(vectors[:, :2]).ravel(), vectors.shape[-1])


def _log_gali(vectors: Array) -> Array:
    """Logarithms of the volumes of the first 2, 3, ... unit vectors, shape (trajectory, order)."""
    if not len(vectors):
        return np.empty((0, vectors.shape[1] - 1))
    upper = linear.qr(np.swapaxes(vectors, -1, -2), mode="r")
    heights = np.maximum(np.abs(np.diagonal(upper, axis1=-2, axis2=-1)), FLOOR)
    return np.cumsum(elementary.log(heights[:, 1:]), axis=1)


def _as_units(units: ArrayLike, states: Array, names: Sequence[str]) -> Array:
    """Positive units in the shape of the states."""
    size = np.broadcast_to(as_states(units, states.shape[1], "units", names=names), states.shape)
    if not (size > 0.0).all():
        raise ParameterError("units: wanted positive numbers; got zero or less; leave it out")
    return size


def _first_vectors(system: Any, states: Array, drawn: Array, within: Within) -> Array:
    """Unit tangent vectors made of drawn ones, shape (trajectory, tangent, component)."""
    if within == "space":
        return drawn
    check_choice(within, "within", ("space", "leaf", "energy"), "leave it out")
    if not has_functions(system):
        raise ParameterError(
            f'within: wanted a system with a bracket for "{within}"; got {shown(system)}; try within="space"'
        )
    good = np.flatnonzero(np.isfinite(states).all(axis=1))
    tensor = system.functions.poisson_tensor(states[good])
    covectors = drawn[good]
    if within == "energy":
        # dH(J w) = -w.(J dH): J w is tangent to the energy surface if w is orthogonal to the flow.
        flow = (tensor * system.functions.energy.gradient(states[good])[:, None, :]).sum(axis=-1)
        speed = linear.norm(flow, axis=1, keepdims=True)
        along = np.divide(flow, speed, out=np.zeros_like(flow), where=speed > 0)
        along = along[:, None, :]
        covectors = covectors - (covectors * along).sum(axis=-1, keepdims=True) * along
    drawn[good] = _unit((tensor[:, None] * covectors[:, :, None, :]).sum(axis=-1))
    _refuse_dependent(drawn, good, within)
    return drawn


def _refuse_dependent(vectors: Array, good: NDArray[np.int64], within: Within) -> None:
    """Vectors that span no volume would look like those of a chaotic orbit."""
    k = vectors.shape[1]
    sizes = linear.svd(np.nan_to_num(vectors[good]), compute_uv=False)[:, -1]
    flat = good[~(sizes > 1e-12)]
    if len(flat):
        space = "leaf" if within == "leaf" else "energy surface on its leaf"
        raise ParameterError(
            f"n_vectors: wanted at most as many as there are independent directions; the {space} through trajectory "
            f"{int(flat[0])} has fewer than {k}; take fewer vectors, or within='space'"
        )


def bound_memory(size: int, n_samples: int, n_trajectories: int) -> None:
    """Refuses samples that would take more than 4 GiB.

    Raises:
        ParameterError: they would.
    """
    if size > MOST_BYTES:
        raise ParameterError(
            f"n_samples: wanted at most {MOST_BYTES / 2**30:g} GiB of samples at once; got {size / 2**30:.3g} GiB for "
            f"n_samples={n_samples} of {n_trajectories} trajectories; take fewer samples, or fewer trajectories at a "
            "time"
        )
