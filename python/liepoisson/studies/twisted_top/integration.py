"""The integration of one run, piece by piece, taking up what is stored already."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from liepoisson.studies.twisted_top.runs import FloatArray, Run
from liepoisson.studies.twisted_top.store import MEMBER_ARRAYS, AnyArray, RunStore

if TYPE_CHECKING:
    from collections.abc import Sequence

    from liepoisson.indicators.finite_time_exponents import FiniteTimeExponents


class Progress(Protocol):
    """Hears how far the study is: what it is doing, and trajectories x time done and to do in this process."""

    def __call__(self, activity: str, done: float, total: float) -> None: ...  # noqa: D102


@dataclass(frozen=True)
class Members:
    """What the study keeps of a run: the curves of all its members, and how they began and ended.

    Attributes:
        exponent: Finite-time exponents, shape (trajectory, time).
        start: Shape (trajectory, 9).
        outcome: Shape (trajectory,).
        n_steps: Shape (trajectory,).
        seconds: Wall time of the integration.
        order: Order of the Taylor series.
        kernel: Instruction set that computed them.
    """

    exponent: FloatArray
    start: FloatArray
    outcome: AnyArray
    n_steps: AnyArray
    seconds: float
    order: int
    kernel: str


class Tracker:
    """Adds up the work of all runs for a progress bar."""

    def __init__(self, stores: Sequence[RunStore], progress: Progress | None) -> None:
        self._progress = progress
        self._total = sum(count * store.run.end_time for store in stores for _, count in store.missing_pieces())
        self._done = 0.0

    def piece(self, run: Run, count: int) -> Callable[[float], None]:
        """A listener for the fraction done of a piece with `count` members."""
        before, work = self._done, count * run.end_time

        def listen(fraction: float) -> None:
            self._done = before + fraction * work
            self.tell(run.name)

        return listen

    def tell(self, activity: str) -> None:
        """Report an activity, with the work done so far."""
        if self._progress is not None:
            self._progress(activity, self._done, self._total)


def complete(store: RunStore, threads: int | None, tracker: Tracker) -> Members:
    """All members of a run: read if they are stored, else integrated, stored and returned.

    Raises:
        DamagedFileError: a stored file is truncated or altered.
        OutputError: a file could not be written.
        KeyboardInterrupt: Ctrl-C; finished pieces stay.
    """
    if store.is_complete():
        growth, seconds = store.load_whole()
    else:
        for first, count in store.missing_pieces():
            _integrate_piece(store, first, count, threads, tracker)
        growth, seconds = _join(store)
        store.save_whole(growth, seconds)
    return Members(growth.exponent, growth.start, growth.outcome, growth.n_steps, seconds, growth.order, growth.kernel)


def _integrate_piece(store: RunStore, first: int, count: int, threads: int | None, tracker: Tracker) -> None:
    from liepoisson.indicators.finite_time_exponents import finite_time_exponents
    from liepoisson.numeric.methods import Taylor
    from liepoisson.numeric.sampling import sample_states

    run, top = store.run, store.run.top()
    listen = tracker.piece(run, count)
    started = time.perf_counter()
    growth = finite_time_exponents(
        top,
        sample_states(top, count, seed=run.seed, ensemble=run.ensemble, first=first),
        times=run.time,
        seed=run.seed,
        first=first,
        method=Taylor(tol=run.tolerance),
        threads=threads,
        time_limit=math.inf,  # what is stored must not depend on how quick the machine is
        progress=listen,
    )
    seconds = time.perf_counter() - started
    store.save_piece(growth, seconds)
    listen(1.0)


def _join(store: RunStore) -> tuple[FiniteTimeExponents, float]:
    """All pieces of a run as one growth of all members, and the seconds that they took."""
    from liepoisson.indicators.finite_time_exponents import FiniteTimeExponents
    from liepoisson.numeric.methods import Taylor

    run, top = store.run, store.run.top()
    joined: dict[str, AnyArray] = {}
    facts: dict[str, Any] = {}
    seconds = 0.0
    for first, count in run.pieces():
        arrays, facts = store.load_piece(first, count)
        seconds += float(facts["seconds"])
        for name in MEMBER_ARRAYS:
            # The longest outcome of one piece may be longer than that of the first.
            kind = "<U32" if name == "outcome" else arrays[name].dtype
            whole = joined.setdefault(name, np.empty((run.members, *arrays[name].shape[1:]), dtype=kind))
            whole[first : first + count] = arrays[name]
    growth = FiniteTimeExponents(
        system=top,
        components=top.component_names,
        field=top.field(),
        method=Taylor(tol=run.tolerance),
        seed=run.seed,
        first=0,
        time=run.time,
        order=int(facts["order"]),
        kernel=str(facts["kernel"]),
        time_limit=math.inf,
        **joined,
    )
    return growth, seconds
