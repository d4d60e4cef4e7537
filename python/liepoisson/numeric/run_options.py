"""What all runs of trajectories share, read once: the method, the threads, the time, who hears of it, what is drawn.

A public function has these options as keyword arguments, reads them where it begins, and hands `RunOptions` to what
it is made of.  So one deadline reaches all parts, and each part tells its share of the progress.  What the options mean
for users is said in `liepoisson.inputs.shared_words`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Self, TypeAlias

from liepoisson.compile.field import Field
from liepoisson.formula.scalars import TIME_LIMIT, as_count, as_seed, as_threads, as_time_limit
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.deadline import LEAST, Deadline, seconds_left
from liepoisson.numeric.method.method import Method
from liepoisson.numeric.method.taylor import Taylor
from liepoisson.numeric.methods import MethodChoice, as_method, field_for
from liepoisson.numeric.systems import HasField, as_field, component_names, tangent_field

ENSEMBLE_METHOD = Taylor(tol=1e-13)
"""Default method of runs whose numbers have a statistical error, far above this tolerance."""

Progress: TypeAlias = "Callable[[float], Any] | None"
"""Called with the fraction of a run that is done."""


@dataclass(frozen=True, kw_only=True)
class RunOptions:
    """The options that all runs share, as they were read.

    Attributes:
        method: How trajectories are integrated.
        threads: On how many threads.
        time_limit: Seconds that the whole run may take, as results record it.
        deadline: When they have passed.
        progress: Called with the fraction of the whole that is done.
        seed: Draws what is random.
        first: Number of the first trajectory.
    """

    method: Method
    threads: int
    time_limit: float
    deadline: Deadline
    progress: Progress
    seed: int
    first: int

    @classmethod
    def read(
        cls,
        method: MethodChoice | None = None,
        threads: int | None = None,
        time_limit: float = TIME_LIMIT,
        progress: Progress = None,
        *,
        seed: int = 0,
        first: int = 0,
        default: Taylor = ENSEMBLE_METHOD,
        system: Any = None,
        in_series: bool = False,
    ) -> Self:
        """What a caller gives, checked; the time runs from here.

        Args:
            method: How; None stands for the default.
            threads: On how many threads; None stands for all.
            time_limit: Seconds that the run may take.
            progress: Called with the fraction of the run that is done.
            seed: Draws what is random.
            first: Number of the first trajectory.
            default: The method for None.
            system: What is integrated, for a method that is chosen for it.
            in_series: Whether the run needs power series.

        Raises:
            ParameterError: one of them is not as it must be; the message names it.
        """
        limit = as_time_limit(time_limit)
        return cls(
            method=as_method(method, default, system, in_series=in_series),
            threads=as_threads(threads),
            time_limit=limit,
            deadline=Deadline(limit),
            progress=progress,
            seed=as_seed(seed),
            first=as_count(first, "first"),
        )

    @property
    def left(self) -> float:
        """Seconds until the deadline, or that of a call around it; a little where none are left, for a run needs it."""
        return seconds_left(max(self.deadline.left, LEAST))

    @property
    def is_late(self) -> bool:
        """Whether the deadline has passed."""
        return not self.deadline.lasts()

    @property
    def drawn(self) -> dict[str, Any]:
        """Seed and number of the first trajectory, as functions take them and results record them."""
        return {"seed": self.seed, "first": self.first}

    def tell(self, fraction: float) -> None:
        """Say what fraction of the whole is done, if anybody listens."""
        if self.progress is not None:
            self.progress(fraction)

    def inner(self, done: float = 0.0, share: float = 1.0) -> dict[str, Any]:
        """The options of a run that is part of this one, by name; it begins when the fraction `done` is done."""
        progress = part_of(self.progress, done, share)
        return {"method": self.method, "threads": self.threads, "time_limit": self.left, "progress": progress}

    def part(self, done: float, share: float) -> Self:
        """The same for a part of this run that takes `RunOptions`."""
        return replace(self, progress=part_of(self.progress, done, share))

    def field(self, system: HasField) -> Field:
        """The field of a system as the method integrates it."""
        return field_for(system, as_field(system), self.method)

    def tangent_field(self, system: HasField) -> Field:
        """The field along which tangent vectors are measured (`liepoisson.numeric.systems.tangent_field`)."""
        return tangent_field(system, self.field(system))

    def given(self, system: Any, start: Array, field: Field | None = None) -> dict[str, Any]:
        """The first fields of a `Run`: what it was given."""
        field = self.field(system) if field is None else field
        names = component_names(system, field.n_components)
        own = {"system": system, "components": names, "field": field, "method": self.method, "start": start}
        return own | {"time_limit": self.time_limit}


def part_of(progress: Progress, done: float, share: float) -> Progress:
    """What a part of a run reports to: the part begins when the fraction `done` of the whole is done.

    What `progress` raises ends the part, and so the whole: an interrupt is seen within each of the parts.

    Args:
        progress: Called with the fraction of the whole run that is done, or None.
        done: That fraction when the part begins.
        share: The part's share of the whole.
    """
    return None if progress is None else lambda fraction: progress(done + share * fraction)
