"""Surfaces of section: the crossings of a surface along orbits, to round-off."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson import _core
from liepoisson.compile.field import TapeFunction
from liepoisson.errors import ParameterError, ShapeError, SurfaceWarning
from liepoisson.formula.scalars import TIME_LIMIT, as_count
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import explains_its_arguments, level_of_the_caller, shows_progress
from liepoisson.inputs.refusals import counted
from liepoisson.io.result import labelled, names_along, recorded
from liepoisson.numeric.method.taylor import Taylor
from liepoisson.numeric.methods import MethodChoice
from liepoisson.numeric.run import IntegratedRun, outcome_names, trajectories
from liepoisson.numeric.run_options import RunOptions
from liepoisson.numeric.starts import StartsLike, as_starts
from liepoisson.numeric.systems import HasField, component_names, core_field
from liepoisson.poincare.equal_steps import check_method, crossings_in_equal_steps, takes_equal_steps
from liepoisson.poincare.section_arguments import (
    Function,
    as_direction,
    as_end,
    as_formula,
    as_sides,
    as_surface,
    read_tape,
)

_GAP = 1e-3
"""Share of the time from which on a surface that could not be followed is warned of: a pole costs a ten-thousandth of
the step that it is in."""
_PIECE = 2**16
"""Points that are looked at together."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Section(IntegratedRun):
    """Crossings of a surface $s(x) = 0$ along trajectories, ordered by trajectory, then in the order of travel.

    The arrays are read-only; `.copy()` gives one that can be changed.

    Example:
        >>> system = lp.catalog.system("henon-heiles")
        >>> crossings = lp.section(system, {"y": 0.1, "p_x": 0.3}, surface="x", t_end=100, direction=1)
        >>> crossings.coordinates, crossings.state.shape
        (('x', 'y', 'p_x', 'p_y'), (16, 4))

    Attributes:
        coordinates: Names of what is kept of each crossing: the components, or the functions in `keep`.
        surface: The function $s$ as it was written, for labels.
        tape: It and the kept functions as data.
        direction: Which crossings were wanted: +1 where $s$ increases in the order of travel, -1 where it decreases,
            0 both.
        n_crossings: After how many a trajectory was ended, or None.
        start_side: The sign of $s$ before each start, as it was given; 0: not known.  Shape (trajectory,).
        t_end: Time at which a trajectory ended at the latest.
        crossing_trajectory: Trajectory of each crossing, shape (crossing,); `trajectory` for short.
        time: Its time, shape (crossing,).
        state: Its state, or the kept functions there, shape (crossing, coordinate).
        sign: +1 where $s$ increases in the order of travel, else -1, shape (crossing,).
        touch_trajectory, touch_time, touch_state: Like the crossings: points where $s$ comes closer to zero than its
            error and leaves to the side that it came from; whether it crossed in between is not decided.
        unbounded_steps: Steps of each trajectory in which the error of the state was estimated and not bounded, shape
            (trajectory,).
        unseen_steps: Steps of each trajectory with a part on which crossings are not found, since $s$ has no value
            there or could not be followed, shape (trajectory,).
        undefined_time: For how long $s$ had no value, shape (trajectory,).
        unresolved_time: For how long $s$ had values but could not be followed: it varies faster than its error allows,
            a singularity of it is near, or its numbers are below the smallest.  Shape (trajectory,).
        seen_to: Time up to which $s$ was followed without such a gap: where the first began, or `end_time`.  Shape
            (trajectory,).
        outcome: How each trajectory ended, shape (trajectory,); "finished" also after `n_crossings` crossings.
        end_time: Time that each trajectory reached, shape (trajectory,).  After `n_crossings` crossings it is that of
            the last one, but for the round-off by which the trajectory has left the surface, so that the sign of $s$
            is known: later than the last crossing, and earlier than any further one.
        first_step: Length of its first step, NaN if it took none, shape (trajectory,).
        end_state: Last good state of each trajectory, at `end_time`, shape (trajectory, component).
        end_side: The last known sign of $s$ of each trajectory, 0 if there is none.  Where a trajectory ends within the
            error of the surface, it is the side that it came from.  Shape (trajectory,).
    """

    kind = "section"
    made_by = "section"
    rows = ("crossing",)

    coordinates: tuple[str, ...] = names_along("coordinate")
    surface: str
    tape: TapeFunction = recorded(asdict, read_tape)
    direction: int
    n_crossings: int | None
    start_side: NDArray[np.int8] = labelled(
        "trajectory", long_name="sign of the surface function before the start", units="1"
    )
    t_end: float
    crossing_trajectory: NDArray[np.int64] = labelled(
        "crossing", long_name="trajectory of the crossing", units="1", is_coordinate=True, numbers="trajectory"
    )
    time: Array = labelled("crossing", long_name="time", is_coordinate=True)
    state: Array = labelled("crossing", "coordinate", long_name="what is kept of the crossing")
    sign: NDArray[np.int8] = labelled(
        "crossing", long_name="+1 where the surface function increases, else -1", units="1"
    )
    touch_trajectory: NDArray[np.int64] = labelled(
        "touch", long_name="trajectory of the point", units="1", is_coordinate=True, numbers="trajectory"
    )
    touch_time: Array = labelled("touch", long_name="time", is_coordinate=True)
    touch_state: Array = labelled("touch", "coordinate", long_name="what is kept of a point not decided")
    unbounded_steps: NDArray[np.int64] = labelled(
        "trajectory", long_name="steps with an estimated error of the state", units="1"
    )
    unseen_steps: NDArray[np.int64] = labelled("trajectory", long_name="steps with a part that was not seen", units="1")
    undefined_time: Array = labelled("trajectory", long_name="time without a surface function")
    unresolved_time: Array = labelled(
        "trajectory", long_name="time for which the surface function could not be followed"
    )
    seen_to: Array = labelled("trajectory", long_name="time up to which it was followed without a gap")
    first_step: Array = labelled("trajectory", long_name="length of the first step")
    end_side: NDArray[np.int8] = labelled("trajectory", long_name="last known sign of the surface function", units="1")

    def __post_init__(self) -> None:
        """Refuses crossings that are not in the order of travel, as of datasets that were joined as they are."""
        if not _is_in_order_of_travel(self.crossing_trajectory, self.time):
            raise ParameterError(
                "section: wanted the crossings of each trajectory in the order of travel; got another order: were two "
                "files joined without new numbers for their trajectories, or crossings sorted?"
            )
        super().__post_init__()

    def arguments(self) -> dict[str, Any]:
        """What `section` was called with."""
        own = {name: getattr(self, name) for name in ("t_end", "direction", "n_crossings", "start_side")}
        keep = self.coordinates if len(self.tape.outputs) > 1 else None
        return super().arguments() | own | {"surface": self.tape, "keep": keep}

    @property
    def trajectory(self) -> NDArray[np.int64]:
        """Trajectory of each crossing, shape (crossing,)."""
        return self.crossing_trajectory

    @explains_its_arguments
    def go_on(self, *, t_end: float, **options: Any) -> Section:
        """Further crossings of the same orbits, of the same or another surface, from where they ended.

        Times count from there.

        Each further crossing is found once: those that `n_crossings` left out, and one at the very end, where this run
        has a touch, since it did not see to which side the orbit goes on.

        Args:
            t_end: Time at which each trajectory ends at the latest, from its end on.
            **options: As for `section`, in place of those of this run, all but `starts`; `n_crossings` counts anew,
                and with another surface other functions may be kept.

        Raises:
            ParameterError: A trajectory has not finished, or `starts` are given.
        """
        if "starts" in options:
            raise ParameterError("go_on: wanted other arguments than starts, which are where the orbits ended")
        if not (self.outcome == "finished").all():
            raise ParameterError("go_on: wanted trajectories that finished; got some that did not (see outcome)")
        run: dict[str, Any] = {
            **self.arguments(),
            "starts": self.end_state,
            "start_side": 0 if "surface" in options else self.end_side,  # the side of this surface
            "t_end": t_end,
            **options,
        }
        again = section(self.system, **run)
        return again if "surface" in options else replace(again, surface=self.surface)

    @property
    def n_trajectories(self) -> int:
        """Number of trajectories."""
        return len(self.outcome)

    @property
    def count(self) -> NDArray[np.int64]:
        """Number of crossings of each trajectory, shape (trajectory,)."""
        return np.bincount(self.trajectory, minlength=self.n_trajectories)

    @property
    def n_short(self) -> int:
        """How many trajectories ended at `t_end` before they had `n_crossings` crossings; 0 if none were wanted."""
        if self.n_crossings is None:
            return 0
        return int(((self.outcome == "finished") & (self.count < self.n_crossings)).sum())

    @property
    def unresolved_share(self) -> float:
        """Share of the time of all trajectories for which $s$ could not be followed; crossings then are not found."""
        return _share(self.unresolved_time, self.end_time)

    @property
    def undefined_share(self) -> float:
        """Share of the time of all trajectories for which $s$ had no value."""
        return _share(self.undefined_time, self.end_time)

    def of(self, trajectory: int) -> Array:
        """Crossings of one trajectory, shape (crossing, coordinate), in the order of travel.

        Raises:
            ParameterError: there is no such trajectory.
        """
        k = as_count(trajectory, "trajectory", most=self.n_trajectories - 1, hint="they count from 0")
        first, end = np.searchsorted(self.trajectory, (k, k + 1))
        return self.state[first:end]

    def __repr__(self) -> str:
        n, of = counted(len(self.time), "crossing"), trajectories(self.outcome)
        gap = f", not followed in {as_percent(self.unresolved_share)} of the time" if self.unresolved_share else ""
        short = f", {self.n_short} ended by t = {self.t_end:g} before {self.n_crossings}" if self.n_short else ""
        return f"<Section {self.surface} = 0 of {self.system.name}: {n} of {of}{short}{gap}>"

    def __str__(self) -> str:
        """What was found and what not, and whether the figure of it folds the section, in a few lines."""
        from liepoisson.poincare.section_coordinates import levels_of

        found = counted(len(self.time), "crossing")
        lines = [f"{self.system.name}: {found} of {self.surface} = 0, {self._of_each()}"]
        if (levels := levels_of(self)) is not None and levels.warning:
            lines.append(levels.warning)
        if (self.outcome != "finished").any():
            names, counts = np.unique(self.outcome, return_counts=True)
            lines.append("outcomes: " + ", ".join(f"{name} {n}" for name, n in zip(names, counts, strict=True)))
        if self.n_short:
            lines.append(
                f"{self.n_short} of {self.n_trajectories} orbits ended at t = {self.t_end:g}, before their "
                f"{self.n_crossings} crossings: give a later t_end for more"
            )
        for share, words in (
            (self.undefined_share, "does not exist"),
            (self.unresolved_share, "could not be followed"),
        ):
            if share:
                lines.append(f"the function {words} in {as_percent(share)} of the time, where crossings are not found")
        if n := len(self.touch_time):
            lines.append(f"{counted(n, 'touch', 'touches')}, of which it is not decided whether the surface is crossed")
        return "\n".join([*lines, *self._about_figures()])

    def _of_each(self) -> str:
        count = self.count
        if len(count) < 2:
            return "1 orbit" if len(count) else "no orbit"
        least, most = count.min(), count.max()
        return f"{least if least == most else f'{least} to {most}'} of each of {len(count)} orbits"

    def _about_figures(self) -> list[str]:
        from liepoisson.poincare.section_coordinates import dimension_of_section, figure_axes, fold

        dimension = dimension_of_section(self)
        if dimension is None or dimension < 2:
            return []
        top = getattr(self.system, "top_parameters", None)
        if top is not None and any(map(float, top.a)) and not any(map(float, (*top.b, top.epsilon))):
            return [
                f"the section has dimension {dimension}, and beta acts on nothing: take "
                'lp.catalog.system("heavy-top", ...), without beta, for sections of a heavy top'
            ]
        if dimension > 2:
            return [
                f"the section has dimension {dimension}: a plane shows a projection, which proves neither tori nor "
                "chaos"
            ]
        axes = figure_axes(self)
        x, y = axes.x, axes.y
        if axes.sheets:
            return [f"a figure of {x} and {y}, the axes by default, has two sheets, which it draws side by side"]
        if axes.is_graph or not fold(self, x, y):
            return []
        return [
            f"a figure of {x} and {y}, the axes by default, folds the section: different states may lie at one point"
        ]

    @property
    def default_axes(self) -> tuple[str, str]:
        """What a figure has along its axes where none are named, across and up (`liepoisson.plot.section`).

        Of a section of dimension 2 they are coordinates on it, if components or angles of two of them are: different
        states lie at different points.  Of kept functions they are the first and the last.
        """
        from liepoisson.poincare.section_coordinates import figure_axes

        axes = figure_axes(self)
        return axes.x, axes.y

    def is_folded(self, x: Function | None = None, y: Function | None = None) -> bool:
        """Whether a figure with these functions along its axes folds the section (`liepoisson.sections.is_folded`).

        Then different states may lie at one point of it.

        Args:
            x: The function along one axis; by default that of `liepoisson.plot.section`.
            y: The function along the other, likewise.

        Raises:
            ParameterError: The section has not dimension 2, has no crossings or was made without whole states, or its
                system or surface cannot be told from its record.
            ExpressionError: A formula cannot be read.
        """
        from liepoisson.poincare.section_coordinates import dimension_of_section, fold

        if (dimension := dimension_of_section(self)) != 2:
            has = "of which it is not known" if dimension is None else f"of dimension {dimension}"
            raise ParameterError(
                f"is_folded: wanted a section of dimension 2 with whole states of a System; got one {has}; make it "
                "with a text for its surface and without keep, of orbits on leaves of dimension 4"
            )
        across, up = self.default_axes
        return fold(self, across if x is None else x, up if y is None else y)


def as_percent(share: float) -> str:
    """A share for people: two digits, and never 0% or 100% for one that is not."""
    if 0.9999 <= share < 1:
        return "over 99.99%"
    return f"{100 * share:.2g}%" if share < 0.99 else f"{100 * share:.4g}%"


def _share(part: Array, end_time: Array) -> float:
    whole = float(np.nansum(np.abs(end_time)))
    return min(float(np.sum(part)) / whole, 1.0) if whole > 0 else 0.0


@shows_progress
def section(
    system: HasField,
    starts: StartsLike,
    *,
    surface: Function | TapeFunction,
    t_end: float,
    direction: int = 0,
    n_crossings: int | None = None,
    start_side: ArrayLike = 0,
    keep: Sequence[Function] | None = None,
    method: MethodChoice | None = None,
    threads: int | None = None,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> Section:
    r"""Crossings of the surface $s(x) = 0$ along orbits that start at time 0, to round-off.

    s may be any smooth function.  Along a step of the Taylor method it is a power series $s(t)$.  What is certain, and
    what not:

    - Every crossing, and every pair of crossings between which s goes beyond its error, is found, however close they
      are and however narrow the features of s: the step is divided until on each part an exclusion test shows that the
      polynomial has one sign, is monotone, or stays within the error.
    - The error is what the series of s leaves out, how far the error of the state moves s, and round-off.  The first is
      bounded, for every smooth s.  The second is bounded by a majorant if the field is of degree two at most and the
      steps are not so long that the bound is of no use; else it is estimated from the last terms of the series of the
      state, and `unbounded_steps` counts these steps.  Round-off is estimated.
    - Where s has no value (the square root of a negative number), or cannot be followed (next to a pole or to the end
      of a root, where it varies faster than the error of the state allows, or where its numbers are below the
      smallest), nothing is found.  `undefined_time` and `unresolved_time` say for how long, `seen_to` up to when there
      was no such gap, and a `SurfaceWarning` tells when it is more than a thousandth of the time, or when s has the
      other sign after it.  A pole, at which s changes its sign, is no crossing, and not warned of.
    - Where $|s|$ falls below the error and returns to the side that it came from, the point is reported as a touch and
      not decided.  A tangency is one.

    A start on the surface, within the error, is not counted, unless `start_side` says that it is a crossing, and orbits
    that lie in the surface, within the error, from start to end cross it nowhere, which a `SurfaceWarning` tells; where
    `t_end` is below round-off, all that start on it do.  An orbit that never meets the surface runs to `t_end`,
    whatever `n_crossings`; `time_limit` ends it sooner.  Errors that accumulate from step to step are those of
    `integrate`.

    Example:
        >>> system = lp.catalog.system("henon-heiles")
        >>> crossings = lp.section(system, {"y": 0.1, "p_x": 0.3}, surface="x", t_end=100, direction=1)
        >>> print(crossings)
        henon-heiles: 16 crossings of x = 0, 1 orbit

    Args:
        system: What is integrated.
        surface: The function $s$: a text like that of a Hamiltonian ("dot(l, beta)"), a SymPy expression in the
            variables of the system, a function of `System.functions`, or a `TapeFunction`, whose first output is $s$
            and whose further ones are kept.  Where a coordinate is an angle or periodic time, s may change by a
            constant m after each turn, as "theta - 1/2" and "theta1 - theta2" do by $2\pi$; then the surface is
            $s = 0$ modulo m: $\sin(2\pi s/m) = 0$ with a positive cosine.
        t_end: Time at which each trajectory ends at the latest; negative: backwards.
        direction: +1 for crossings where $s$ increases in the order of travel, -1 where it decreases, 0 for both.
        n_crossings: End each trajectory after so many crossings: at the last one, as soon as the sign of $s$ after it
            is known.
        start_side: The sign of $s$ before the start, +1, -1, or 0 where it is not known; one for all or one for each
            trajectory.  A trajectory that starts on the surface crosses it there if it goes on to the other side; for
            one that starts elsewhere it says nothing.
        keep: Functions whose values are kept of each crossing instead of the state (texts or expressions); with a
            `TapeFunction`, the names of its further outputs.
        method: `Taylor()`, in double precision, by default to round-off; or one of equal steps, `Gauss(step=...)`,
            `Splitting(step=...)`, `RungeKutta(step=...)`: crossings are then changes of the sign of $s$ from one step
            to the next, met by a shorter step, and nothing of what is said above is certain.

    Returns:
        Section; without any crossing if the orbits meet none.

    Raises:
        ExpressionError: A text is not a formula, or names what the system does not have.
        UnsupportedFieldError: The surface is not smooth.
        ShapeError: `starts` has another shape than stated.
        ParameterError: Another method, a direction that is none, numbers that are not finite, a surface that is no
            function, is constant along every orbit of the bracket (a number, a Casimir) or of the system (a constant of
            motion, which is in involution with H).
        KeyboardInterrupt: Ctrl-C.
    """
    options = RunOptions.read(method, threads, time_limit, progress, default=Taylor(), in_series=True)
    method = options.method
    check_method(method)
    field = options.field(system)
    n = field.n_components
    states = as_starts(system, starts, n)
    sides = as_sides(start_side, len(states))
    tape, names = as_surface(system, surface, keep)
    if tape.n_components != n:
        raise ShapeError(f"surface: wanted a function of {n} components; got one of {tape.n_components}")
    coordinates = component_names(system, n) if names is None else names
    wanted = None if n_crossings is None else as_count(n_crossings, "n_crossings", least=1)
    end, sense = as_end(t_end), as_direction(direction)
    raw: Any
    if takes_equal_steps(method):
        raw = crossings_in_equal_steps(
            system, states, tape, options, t_end=end, direction=sense, n_crossings=wanted, sides=sides
        )
    else:
        raw = _core.sections(
            core_field(field),
            method.core(),
            (tape.n_components, list(tape.instructions), list(tape.with_guard.outputs)),
            tape.guard is not None,
            states.ravel(),
            np.array([0.0, end]),
            sense,
            wanted,
            sides.tolist() if sides.any() else [],
            options.threads,
            options.left,
            progress,
        )
    width, members = len(coordinates), np.arange(len(states))
    label = "s" if isinstance(surface, TapeFunction) else str(as_formula(surface, "surface"))
    _warn_of_orbits_in_the_surface(label, raw["in_surface"])
    _warn_of_gaps(label, _share(raw["unresolved_time"], raw["end_time"]), int(raw["lost_changes"].sum()))
    return Section(
        **options.given(system, states, field),
        coordinates=coordinates,
        surface=label,
        tape=tape,
        direction=sense,
        n_crossings=wanted,
        start_side=sides,
        t_end=end,
        crossing_trajectory=np.repeat(members, raw["count"]),
        time=raw["time"],
        state=raw["state"].reshape(len(raw["time"]), width),
        sign=raw["sign"],
        touch_trajectory=np.repeat(members, raw["touch_count"]),
        touch_time=raw["touch_time"],
        touch_state=raw["touch_state"].reshape(len(raw["touch_time"]), width),
        unbounded_steps=raw["unbounded_steps"],
        unseen_steps=raw["unseen_steps"],
        undefined_time=raw["undefined_time"],
        unresolved_time=raw["unresolved_time"],
        seen_to=raw["seen_to"],
        end_side=raw["side"],
        first_step=raw["first_step"],
        outcome=outcome_names(raw["outcome"]),
        end_time=raw["end_time"],
        n_steps=raw["n_steps"],
        end_state=raw["final_state"].reshape(len(states), n),
        order=raw["order"],
        kernel=raw["kernel"],
    )


def _is_in_order_of_travel(trajectory: NDArray[np.int64], time: Array) -> bool:
    """Whether times grow in size along each trajectory; in pieces, so that millions of points need no more memory."""
    for first in range(0, len(time), _PIECE):
        piece = slice(first, first + _PIECE + 1)  # with the first of the next one
        later = np.diff(np.abs(time[piece])) >= 0
        if not (later | (np.diff(trajectory[piece]) > 0)).all():
            return False
    return True


def _warn_of_orbits_in_the_surface(surface: str, in_surface: NDArray[np.bool_]) -> None:
    n = int(in_surface.sum())
    if n:
        lie, cross = (
            ("the orbit lies", "crosses") if len(in_surface) == 1 else (f"{n} of {len(in_surface)} orbits lie", "cross")
        )
        warnings.warn(
            f"{lie} in the surface {surface} = 0 to round-off, from start to end, and {cross} it nowhere; try another "
            "surface, or a larger t_end",
            SurfaceWarning,
            stacklevel=level_of_the_caller(),
        )


def _warn_of_gaps(surface: str, share: float, n_changes: int) -> None:
    if share > _GAP or n_changes:
        changes = f", and its sign changes {n_changes} times meanwhile" if n_changes else ""
        warnings.warn(
            f"the surface function {surface} could not be followed in {as_percent(share)} of the time, where crossings "
            f"are not found{changes}: it varies too fast, is singular nearby, or is beyond the range of numbers; try a "
            "smoother one",
            SurfaceWarning,
            stacklevel=level_of_the_caller(),
        )
