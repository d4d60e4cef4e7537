r"""Unstable and stable manifolds of equilibria and of periodic orbits, from their linear spaces.

An orbit of the manifold begins at $p(\theta) + d\,U(\theta)e$, put on the level: $\theta$ is the phase along the
periodic orbit, e a unit vector of the k unstable (stable) directions there, and d an amplitude.  As every orbit of the
manifold passes |a| = d, these starts are on all of them.

How far they are from the manifold is measured: begun earlier, where the linear flow has half the amplitude or less, an
orbit comes nearer to the manifold by the square, so that the distance of both across the tangent space is the error of
the start, $cd^2$ with the largest measured c.  Where the orbit has gone to a distance of order 1, transverse errors
have shrunk to $cd^3$, but for those along elliptic directions, which keep $cd^2$; the round-off of the start has grown
to $\epsilon/d$.  Both are alike at $d = (\epsilon/c)^{1/4}$, or $(\epsilon/c)^{1/3}$ beside elliptic directions; c is
at least 1 there.

References: [krauskopf2005].
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson.errors import OrbitError, ParameterError
from liepoisson.formula.scalars import TIME_LIMIT, as_array, as_count, as_positive, as_seed, as_time
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import explains_its_arguments, explains_its_methods
from liepoisson.inputs.refusals import check_choice
from liepoisson.io.tables import vector_columns
from liepoisson.numeric.integrate import Orbit, integrate
from liepoisson.numeric.run_options import RunOptions
from liepoisson.orbits.saved_orbits import SavedOrbits
from liepoisson.orbits.shooting import Flow
from liepoisson.orbits.unstable_spaces import UnstableSpace, unstable_space
from liepoisson.poincare.section import Section, section
from liepoisson.portable import elementary, linear
from liepoisson.streams import Purpose, stream

if TYPE_CHECKING:
    from liepoisson.model.system import System
    from liepoisson.orbits.unstable_spaces import Base

KINDS = {"unstable": 1, "stable": -1}
_SAMPLES = 16
"""Starts whose error is measured."""
_CORRECTIONS = 4
"""Of the earlier start, so that both are at the same place of the manifold: each leaves about d of the gap."""
_ROUND_OFF = 8 * np.finfo(float).eps
_GOLDEN = (np.sqrt(5.0) - 1) / 2


class _Saved(SavedOrbits):
    kind = "invariant manifold"  # of the file; a manifold has its own
    made_by = "lp.orbits.invariant_manifold"


@explains_its_methods
@dataclass(frozen=True, eq=False)
class InvariantManifold(_Saved):
    r"""The unstable or stable manifold of an equilibrium or a periodic orbit, by orbits from its linear one.

    Example:
        >>> pendulum = lp.System(lp.canonical(1), "p1^2/2 - cos(q1)", name="pendulum")
        >>> upright = lp.phase_space.equilibrium(pendulum, [-np.pi, 0])
        >>> manifold = lp.orbits.invariant_manifold(upright)
        >>> manifold
        <InvariantManifold of 'pendulum': unstable, dimension 1, amplitude 0.00012, error 2e-14 at the start>

    Attributes:
        base: The equilibrium or the periodic orbit.
        kind: "unstable" or "stable".
        space: The linear space; of a periodic orbit, that at its start.
        amplitude: d, in units of the level.
        error: The largest measured distance of a start from the manifold, in units of the level.
    """

    row = "manifold"

    base: Base
    kind: str = field()  # pyright: ignore[reportIncompatibleVariableOverride]
    space: UnstableSpace
    amplitude: float
    error: float

    @property
    def system(self) -> System:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The system."""
        return self.space.level.system

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table, which has one row: which manifold it is, of what, and the error of its starts."""
        listed = ("kind", "dimension", "amplitude", "error")
        values = {name: np.array([getattr(self, name)]) for name in listed} | {"rate": np.array([self.space.rate])}
        return values | vector_columns("base", [self.space.state], self.system.component_names)

    @property
    def n_directions(self) -> int:
        """k, the number of unstable or stable directions."""
        return self.space.basis.shape[1]

    @property
    def dimension(self) -> int:
        """The dimension of the manifold: k, and one more around a periodic orbit."""
        return self.n_directions + (self.space.loop_time > 0)

    def at(self, directions: ArrayLike, phases: ArrayLike = 0.0) -> Array:
        r"""States of the manifold at the amplitude d, on the level to round-off, shape (n, N).

        Args:
            directions: Vectors e, of any length, in the directions of the linear space at the phase, shape (n, k), or
                one of them.
            phases: $\theta$, the parts of the period after the start of the orbit, shape (n,), or one for all; of no
                meaning at an equilibrium.
        """
        e = np.atleast_2d(as_array(directions, "directions"))
        if (
            e.ndim != 2
            or e.shape[1] != self.n_directions
            or not linear.norm(e, axis=1).all()
            or not np.isfinite(e).all()
        ):
            raise ParameterError(
                f"directions: wanted vectors that are not zero, of shape (n, {self.n_directions}); got shape {e.shape}"
            )
        theta = as_array(phases, "phases")
        if theta.shape not in {(), (1,), (len(e),)} or not np.isfinite(theta).all():
            raise ParameterError(f"phases: wanted one, or one for each of {len(e)} directions; got shape {theta.shape}")
        e = self.amplitude * e / linear.norm(e, axis=1, keepdims=True)
        return _states(self.space, *_frames(self.space, np.broadcast_to(theta, len(e))), e)

    def spread(self, n_starts: int, *, seed: int = 0) -> tuple[Array, Array]:
        """Directions, shape (n, k), and phases, shape (n,), spread over all starts.

        With one direction they alternate between both sides, with two they go round evenly, with more they are random.
        """
        return _spread(self.space, as_count(n_starts, "n_starts", least=1), as_seed(seed))

    def starts(self, n_starts: int, *, seed: int = 0) -> Array:
        """So many starts, spread over all, shape (n, N); of a curve there are only two."""
        return self.at(*self.spread(n_starts, seed=seed))

    def followed(self, n_starts: int, t_end: float, *, n_times: int = 1001, seed: int = 0, **options: Any) -> Orbit:
        """Orbits of the manifold from so many starts, as `integrate` returns them; stable ones run backwards.

        Args:
            n_starts: How many.
            t_end: How long they are followed.
            n_times: The number of times at which states are kept.
            seed: Draws directions, where there are more than two.
            **options: As for `integrate`: `threads`, `time_limit`, ...
        """
        n_times = as_count(n_times, "n_times", least=2)
        t_end = self.space.direction * as_time(t_end, "t_end", example=10.0)
        return integrate(
            self.system, self.starts(n_starts, seed=seed), times=np.linspace(0.0, t_end, n_times), **options
        )

    def section(self, surface: Any, *, n_starts: int, t_end: float, seed: int = 0, **options: Any) -> Section:
        """Where orbits of the manifold cross a surface, as `section` returns it; stable ones run backwards.

        Args:
            surface: The surface, as for `section`.
            n_starts: From how many starts.
            t_end: How long they are followed.
            seed: Draws directions, where there are more than two.
            **options: As for `section`: `direction`, `n_crossings`, ...
        """
        t_end = self.space.direction * as_time(t_end, "t_end", example=10.0)
        return section(self.system, self.starts(n_starts, seed=seed), surface=surface, t_end=t_end, **options)

    def errors(self, n_starts: int, t_end: float = 0.0) -> Array:
        """The measured distances from the manifold, in units of the level, after a time, of so many starts, shape (n,).

        They are measured between orbits that begin at d and earlier, at d/2 or less, across the tangent space there.

        Args:
            n_starts: How many.
            t_end: How long they were followed; 0 for the starts.
        """
        time = 0.0 if t_end == 0 else as_time(t_end, "t_end", example=10.0)
        return _errors(self.space, self.amplitude, *_spread(self.space, as_count(n_starts, "n_starts", least=1)), time)

    def __repr__(self) -> str:
        return (
            f"<InvariantManifold of {self.system.name!r}: {self.kind}, dimension {self.dimension}, amplitude "
            f"{self.amplitude:.2g}, error {self.error:.0e} at the start>"
        )


@explains_its_arguments
def invariant_manifold(
    base: Base, kind: str = "unstable", *, amplitude: float | None = None, time_limit: float = TIME_LIMIT
) -> InvariantManifold:
    r"""The unstable or the stable manifold of an equilibrium or a periodic orbit.

    Orbits begin on the linear manifold at an amplitude d, whose error is measured.  Beside elliptic directions it is
    the manifold of the hyperbolic ones.

    Example:
        >>> well = lp.System(lp.canonical(1), "p1^2/2 - q1^2/2 + q1^4/4")
        >>> manifold = lp.orbits.invariant_manifold(lp.phase_space.equilibrium(well, [0, 0]))
        >>> manifold.section("p1", n_starts=2, t_end=20).state[:, 0].round(9)  # sqrt(2)/cosh(t) on both sides
        array([ 1.41421356, -1.41421356])

    Args:
        base: An equilibrium, or a periodic orbit that closes without rotations.
        kind: "unstable", or "stable": that of the flow run backwards.
        amplitude: d, in units of the level; by default $(\epsilon/c)^{1/4}$, or $(\epsilon/c)^{1/3}$ beside elliptic
            directions, for starts whose measured error is $cd^2$, with c at least 1.
        time_limit: Seconds for measuring the error.

    Returns:
        The manifold, which gives starts and follows them.

    Raises:
        ParameterError: the base has no unstable direction, is relative, or is no such thing.
        LeafError: the leaf of the equilibrium is not regular.
        OrbitError: no state of the level is near the linear manifold at this amplitude.
        TimeLimitError: the time limit has passed.

    References: [krauskopf2005].
    """
    check_choice(kind, "kind", tuple(KINDS), "the stable manifold is the unstable one of the flow run backwards")
    run = RunOptions.read(None, 1, time_limit)
    given = None if amplitude is None else as_positive(amplitude, "amplitude", "a positive number", example=1e-4)
    with run.deadline.running(), np.errstate(all="ignore"):
        return manifold_of(base, kind, given)


def manifold_of(base: Base, kind: str, amplitude: float | None = None, name: str = "base") -> InvariantManifold:
    """The manifold of a base that is an argument of this name, with the measured error of its starts."""
    space = unstable_space(base, direction=KINDS[kind], wholly=False, name=name)
    sample = _spread(space, _SAMPLES)
    if amplitude is None:
        least, power = float(np.finfo(float).eps), 4 if space.is_whole else 3
        largest = float(elementary.power(least, 1 / power))
        bend = float(_errors(space, largest, *sample, 0.0).max()) / largest**2
        amplitude = float(elementary.power(least / max(bend, 1.0), 1 / power))
    return InvariantManifold(base, kind, space, amplitude, float(_errors(space, amplitude, *sample, 0.0).max()))


def _spread(space: UnstableSpace, n: int, seed: int = 0) -> tuple[Array, Array]:
    k, numbers = space.basis.shape[1], np.arange(n)
    phases: Array = numbers / n
    if k == 1:  # both sides have the same phases
        phases = (numbers // 2) / max(1, (n + 1) // 2)
        return np.where(numbers % 2, -1.0, 1.0)[:, None], phases
    if k == 2:
        turns = 2 * np.pi * (numbers * _GOLDEN if space.loop_time else phases)
        return np.stack([elementary.cos(turns), elementary.sin(turns)], axis=1), phases
    return stream(seed, Purpose.DIRECTIONS).standard_normal((n, k)), phases


def _frames(space: UnstableSpace, phases: Array) -> tuple[Array, Array]:
    """States of the base and bases of the linear space at phases, in time."""
    travelled = space.direction * phases % 1.0
    return space.frames(Flow(space.level.system, 1), travelled * space.period)


def _states(space: UnstableSpace, points: Array, bases: Array, amplitudes: Array) -> Array:
    """States on the level near the linear manifold, shape (n, N).

    Raises:
        OrbitError: there is none.
    """
    level = space.level
    x, arrived = level.projected(points + linear.einsum("nij,nj->ni", bases, amplitudes), np.diag(level.units))
    # near an equilibrium H hardly varies, and the round-off of its terms is all that is left
    nearby = (x, x + level.units, x - level.units)
    terms = np.max([np.abs(np.stack([f(y) for f in level.functions.values()], axis=-1)) for y in nearby], axis=0)
    arrived |= (np.abs(level.deviations(x)) <= _ROUND_OFF * terms).all(axis=-1)
    if not arrived.all():
        raise OrbitError(
            f"a start must lie on {level.text}; none was found near the linear manifold at the amplitude "
            f"{linear.norm(amplitudes, axis=1).max():.2g}; take a smaller one"
        )
    return x


def _errors(space: UnstableSpace, amplitude: float, directions: Array, phases: Array, time: float) -> Array:
    """The distances after a time of orbits that begin at an amplitude from those that begin earlier, shape (n,)."""
    flow, units, s, n = Flow(space.level.system, 1), space.level.units, space.direction, len(phases)
    travelled, earlier = space.direction * phases % 1.0 * space.period, float(elementary.log(2.0)) / space.rate
    a = amplitude * directions / linear.norm(directions, axis=1, keepdims=True)
    points, bases = space.frames(flow, travelled)
    before, bases_before = space.frames(flow, travelled - earlier)
    times = np.full(n, s * earlier)
    _, moved = flow.ends(before, times, bases_before)
    carried = linear.matmul(np.swapaxes(bases, 1, 2) / units**2, moved)
    a_before = linear.solve(carried, a[..., None])[..., 0]
    x = _states(space, points, bases, a)
    if time:
        x, bases = flow.ends(x, np.full(n, s * time), bases)
    k, gap, times = space.basis.shape[1], x, times + s * time
    if space.loop_time:  # at an equilibrium the flow is one of the unstable directions
        bases = np.concatenate([bases, space.level.system.vector_field(x)[..., None]], axis=2)
    frame, triangle = linear.qr(bases / units[:, None])
    for _ in range(_CORRECTIONS):
        y, _ = flow.ends(_states(space, before, bases_before, a_before), times)
        gap = (y - x) / units
        along = linear.einsum("nij,ni->nj", frame, gap)
        shift = linear.solve(triangle, along[..., None])
        gap = gap - linear.einsum("nij,nj->ni", frame, along)
        a_before = a_before - linear.solve(carried, shift[:, :k])[..., 0]
        times = times - (shift[:, k, 0] if space.loop_time else 0.0)
    return linear.norm(gap, axis=1)
