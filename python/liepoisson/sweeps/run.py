"""Sweeps: one quantity over a grid of parameters, energies and Casimirs."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, field, fields
from os import PathLike
from pathlib import Path
from typing import Any, cast

import numpy as np

from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import MOST_THREADS, as_count, as_positive
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import shows_progress
from liepoisson.inputs.given import labelled, named
from liepoisson.inputs.refusals import counted, shown
from liepoisson.io.files import exclusive
from liepoisson.sweeps.execute import PATIENCE, Cluster, Report, Threads, run_pieces
from liepoisson.sweeps.family import Family, as_family
from liepoisson.sweeps.points import Lattice, Place, evaluate_targets, split
from liepoisson.sweeps.result import Sweep
from liepoisson.sweeps.spec import QUANTITIES, Axis, SweepSpec, refinement_of, starts_of
from liepoisson.sweeps.spec_file import read_sweep_file
from liepoisson.sweeps.starts import Meaning, check_casimirs
from liepoisson.sweeps.store import Level, SweepStore
from liepoisson.sweeps.tasks import FAILED, Piece, PieceResult, has_errors, is_noisy, resolve, with_method

PIECE_TIME = 1e6
"""Orbits times their time in a piece: 0.3 s of a core at 3.5e6 a second (tops, default method). A worker adds 3 ms."""
LEAST_PIECES = 16
"""Of a sweep that has as many points, so that several cores have work."""

Progress = Callable[[float], Any]
"""Called with the fraction that is done; each level of a refinement has the same share of the whole."""


@shows_progress
def sweep(
    spec: SweepSpec | str | Path | Mapping[str, Any] | None = None,
    *,
    store: str | Path | None = None,
    scheduler: str | None = None,
    processes: int | None = None,
    threads: int | None = None,
    points_per_piece: int | None = None,
    fresh: bool = False,
    patience: float = PATIENCE,
    progress: Progress | None = None,
    allow_code: bool = False,
    **settings: Any,
) -> Sweep:
    """One quantity over a grid of parameters, energies and Casimirs, on one machine or many.

    The numbers depend on the spec only: not on threads, workers, pieces, or on how often the sweep was interrupted.

    Example:
        >>> lp.sweep(system="twisted-top", parameters={"I": [2, 2, 1], "a": [-1, 0, 0], "b": [0, 0, 0]},
        ...     axes={"epsilon": [0, 0.5, 1]}, n_starts=4, t_end=50)
        <Sweep over epsilon (3): 3 points, 4 orbits each, t = 50>

    Args:
        spec: What to compute: a `SweepSpec`, the path of a sweep file, or its tables; or leave it out and give the
            arguments of `SweepSpec` by name.
        store: Folder (FILE.zarr) in which results are kept piece by piece.  A sweep that was interrupted goes on from
            there; one that is complete is read.
        scheduler: Address of a `dask.distributed` scheduler, such as "tcp://node1:8786", whose workers shall compute.
        processes: Or: this many processes on this machine.
        threads: Or: this many threads of this process; by default all processors that it may use.
        points_per_piece: Points of a task; by default as many as take about 0.3 s, fewer for small sweeps.
        fresh: Discard what the store holds.
        patience: Seconds to wait for a scheduler that does not answer, and for a worker while there is none.
        progress: Called with the fraction that is done, after each piece.  How many points refinement adds is not known
            before, so each level counts as the same share of the whole.
        allow_code: Whether the quantity may be the name of a function, "package.module:function", that is imported and
            called.  Without this a text of somebody else is only data.  A function itself needs no consent.
        **settings: The arguments of `SweepSpec`.  Plain mappings do for some:
            `axes={"epsilon": np.linspace(0, 1, 21)}`, `starts={"energy": 1, "C1": 1}`,
            `refine={"levels": 2, "difference": 0.1}`.

    Returns:
        Sweep.  An orbit that fails is an outcome in it; a point or a piece that fails is tried thrice and reported.

    Raises:
        ParameterError: the spec is not one, names what the system does not have, or names a function and code is not
            allowed.
        SystemFileError: a sweep file cannot be read, or names a function and code is not allowed.
        OtherSweepError: the store holds another sweep, or numbers of another version of liepoisson.
        OutputError: the store cannot be written, or another process is using it.
        DamagedFileError: the description of the store cannot be read.
        SweepError: no scheduler answers, it has no workers, or none of them may compute the sweep.
        KeyboardInterrupt: Ctrl-C; what is stored stays.  Orbits under way on threads end within a second; a user
            function cannot be interrupted and keeps running.
    """
    spec = as_spec(spec, settings, allow_code=allow_code)
    _check_options(store, scheduler, patience)
    for name, count in (("processes", processes), ("threads", threads)):
        if count is not None:
            as_count(count, name, least=1, most=MOST_THREADS, hint="try 2")
    if sum(option is not None for option in (scheduler, processes, threads)) > 1:
        raise ParameterError("wanted one of scheduler, processes and threads; got several. Leave out the others.")
    _check_code(spec, allow_code=allow_code)
    family = as_family(spec.system)
    if spec.quantity not in QUANTITIES:
        resolve(spec.quantity)
    lattice = Lattice(spec)
    # Said before anything is made: wrong names and values.
    if points_per_piece is not None:
        as_count(points_per_piece, "points_per_piece", least=1, most=2**31, hint="leave it out")
    targets = evaluate_targets(spec, family, lattice.coordinates(lattice.grid()))
    meaning = check_casimirs(family, targets, spec.starts.sampling)
    noise = is_noisy(spec, family, targets)
    spec = with_method(spec, family, targets)
    path = None if store is None else Path(store)
    if path is not None:
        spec.fingerprint()
    made: list[Threads | Cluster] = []

    def executor(n_pieces: int) -> Threads | Cluster:
        """Made once, when pieces are to be computed."""
        if not made:
            is_here = scheduler is None and processes is None
            made.append(Threads(threads, n_pieces) if is_here else Cluster(scheduler, processes, patience))
        return made[0]

    with nullcontext() if path is None else exclusive(path):
        kept = None if path is None else SweepStore(path, spec, fresh=fresh)
        try:
            return _Run(spec, family, lattice, kept, noise, executor, points_per_piece, progress, meaning).result()
        finally:
            for one in made:
                one.close()


def read_sweep(path: str | Path) -> Sweep:
    """A sweep from its store, as far as it is computed; nothing is computed and nothing is written."""
    store = SweepStore.as_found(Path(path))
    spec, family, lattice = store.spec, as_family(store.spec.system), Lattice(store.spec)
    targets = evaluate_targets(spec, family, lattice.coordinates(lattice.grid()))
    return _Run(spec, family, lattice, store, is_noisy(spec, family, targets)).result()


def as_spec(spec: Any, settings: Mapping[str, Any], *, allow_code: bool = False) -> SweepSpec:
    """The spec that the arguments of `sweep` stand for."""
    if spec is None:
        known = [entry.name for entry in fields(SweepSpec)]
        if unknown := [name for name in settings if name not in known]:
            held = unknown[0] == "energy" or re.fullmatch(r"C\d+", unknown[0])
            hint = f'Write starts={{"{unknown[0]}": ...}}, or give it an axis.' if held else "Correct the name."
            raise ParameterError(f"a sweep has no setting {unknown[0]!r}; known: {', '.join(known)}. {hint}")
        if missing := [name for name in ("system", "axes", "t_end") if name not in settings]:
            raise ParameterError(f"a sweep must have {' and '.join(missing)}. Give it, or a spec, or a sweep file.")
        return SweepSpec(**_made(settings))
    if settings:
        raise ParameterError(f"wanted a spec or its arguments by name; got a spec and {', '.join(settings)}.")
    return spec if isinstance(spec, SweepSpec) else read_sweep_file(spec, allow_code=allow_code)


def _check_code(spec: SweepSpec, *, allow_code: bool) -> None:
    """Refuse a quantity that is the name of code, unless the caller allows it: a spec may come from a file."""
    if isinstance(spec.quantity, str) and spec.quantity not in QUANTITIES and not allow_code:
        raise ParameterError(
            f"quantity: wanted one of {', '.join(QUANTITIES)}, or a function; got {shown(spec.quantity)}, the name of "
            "code, which would be imported. If you trust it, allow it: allow_code=True; or give the function itself."
        )


def _check_options(store: Any, scheduler: Any, patience: Any) -> None:
    if store is not None and (not isinstance(store, (str, PathLike)) or not str(store)):  # "" is the working folder
        raise ParameterError(f"store: wanted the path of a folder; got {shown(store)}. Write FILE.zarr.")
    if scheduler is not None and not isinstance(scheduler, str):
        raise ParameterError(f"scheduler: wanted an address; got {shown(scheduler)}. Write tcp://node1:8786.")
    as_positive(patience, "patience", "a number of seconds, not negative", example=60, zero=True)


def _columns(axes: object) -> dict[Any, Any] | None:
    """Values by the labels of a table or a Series; None for what has no labels."""
    found = labelled(axes)
    return None if found is None else found.by_label("axes")


def _made(settings: Mapping[str, Any]) -> dict[str, Any]:
    """The arguments of `SweepSpec`, made of the plain mappings that `sweep` takes for them."""
    made = dict(settings)
    axes = made.get("axes")
    if (columns := named(axes, "axes") if isinstance(axes, Mapping) else _columns(axes)) is not None:
        made["axes"] = tuple(Axis(name, values) for name, values in cast("Mapping[str, Any]", columns).items())
    for key, make in (("starts", starts_of), ("refine", refinement_of)):
        if isinstance(given := made.get(key), Mapping):
            made[key] = make(cast("Mapping[str, Any]", given))
    return made


@dataclass
class _Run:
    """A sweep under way, level by level."""

    spec: SweepSpec
    family: Family
    lattice: Lattice
    store: SweepStore | None
    noise: bool
    executor: Callable[[int], Threads | Cluster] | None = None
    points_per_piece: int | None = None
    progress: Progress | None = None
    meaning: Meaning | None = None
    places: list[Place] = field(default_factory=list[Place])
    levels: list[Level] = field(default_factory=list[Level])
    reports: list[Report] = field(default_factory=list[Report])
    n_reused: int = 0

    def result(self) -> Sweep:
        cells, places, statistic = self.lattice.cells(), self.lattice.grid(), dict[Place, float]()
        for number in range(self.lattice.levels + 1):
            level = self._level(number, places)
            self.places += places
            found = self._sweep()
            if number == self.lattice.levels or not level.done.all():
                return found
            if self.reports[-1].failed or self.reports[-1].points:
                self.reports[-1].remarks.append(f"refinement stops at level {number}: a part of it failed")
                return found
            statistic.update(zip(places, found.statistic[-len(level.points) :].tolist(), strict=True))
            assert self.spec.refine is not None
            cells, places = split(cells, statistic, self.spec.refine.difference)
            if not places:
                return found
        return self._sweep()

    def _level(self, number: int, places: Sequence[Place]) -> Level:
        points, n = self.lattice.coordinates(places), self.spec.n_starts
        size = self.points_per_piece or piece_size(self.spec, len(points))
        known = self.store is not None and (self.executor is not None or (self.store.path / f"level{number}").is_dir())
        if self.store and known:
            level = self.store.level(number, points, size, n, errors=self._has_errors)
        else:
            level = Level.empty(points, size, n, errors=self._has_errors)
        self.levels.append(level)
        self.n_reused += int(sum(len(points[level.rows(int(k))]) for k in np.flatnonzero(level.done)))
        missing = np.flatnonzero(~level.done).tolist()
        if missing and self.executor is None:
            self.reports.append(Report(remarks=[f"level {number}: {len(missing)} pieces are not computed yet"]))
        else:
            self.reports.append(self._compute(number, level, missing) if missing else Report())
        return level

    def _compute(self, number: int, level: Level, missing: Sequence[int]) -> Report:
        activity = f"level {number}" if number else (self.spec.name or "sweep")
        told: dict[int, str] = {}

        def keep(result: PieceResult) -> None:
            level.keep(result)
            told.update({level.rows(result.index).start + k: why for k, why in result.failed.items()})
            if self.store is not None:
                self.store.save(number, level, result)
            if self.progress is not None:
                done = sum(len(level.points[level.rows(int(k))]) for k in np.flatnonzero(level.done))
                self.progress((number + done / len(level.points)) / (self.lattice.levels + 1))

        assert self.executor is not None
        report = run_pieces(self.executor(len(missing)), self._pieces(level, missing), keep=keep)
        report.points |= {k: why for k, why in sorted(told.items()) if (level.outcome[k] == FAILED).any()}
        for lack in ("no system", "no start"):
            absent = [why for k, why in sorted(told.items()) if k not in report.points and why.startswith(lack)]
            if absent:
                report.remarks.append(
                    f"{activity}: {lack} at {counted(len(absent), 'point')}; the first of them: {absent[0]}"
                )
        if self.store is not None:
            self.store.save_facts(number, level)
        return report

    def _pieces(self, level: Level, missing: Sequence[int]) -> list[Piece]:
        targets = evaluate_targets(self.spec, self.family, level.points)
        return [
            Piece(index, self.spec, self.family, targets.rows(level.rows(index)), self.meaning, self.noise)
            for index in missing
        ]

    @property
    def _has_errors(self) -> bool:
        return has_errors(self.spec, noise=self.noise)

    def _sweep(self) -> Sweep:
        counts = [len(level.points) for level in self.levels]
        return Sweep(
            spec=self.spec,
            places=tuple(self.places),
            points=_joined([level.points for level in self.levels]),
            level=np.repeat(np.arange(len(counts)), counts),
            value=_joined([level.value for level in self.levels]),
            error=_joined([cast("Array", level.error) for level in self.levels]) if self._has_errors else None,
            outcome_code=np.concatenate([level.outcome for level in self.levels]),
            method=next((level.method for level in self.levels if level.method), str(self.spec.method)),
            held=tuple(self.spec.held(noise=self.noise)),
            reports=tuple(self.reports),
            n_reused=self.n_reused,
            n_damaged=0 if self.store is None else self.store.damaged,
            store=None if self.store is None else self.store.path,
        )


def piece_size(spec: SweepSpec, n_points: int) -> int:
    """Points of a piece; whole rows of the grid where they are short, as points of a row often share a system."""
    by_time = max(1, round(PIECE_TIME / (spec.n_starts * spec.t_end)))
    size = max(1, min(by_time, math.ceil(n_points / LEAST_PIECES)))
    row = spec.shape[-1] if len(spec.shape) == 2 else 1
    return size - size % row if size > row else size


def _joined(parts: Sequence[Array]) -> Array:
    return np.concatenate(parts)
