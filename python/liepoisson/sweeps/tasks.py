"""One piece of a sweep, wherever it runs: starts, integration, and what came out, as plain arrays."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from importlib import import_module
from typing import TYPE_CHECKING, Any, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from liepoisson import __version__, _core
from liepoisson.compile.field import QuadraticField, TopField
from liepoisson.errors import LiePoissonError, ParameterError
from liepoisson.formula.scalars import as_array
from liepoisson.indicators.finite_time_exponents import exponents_of_many, finite_time_exponents
from liepoisson.indicators.verdict import decide
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.refusals import shown
from liepoisson.noise.noisy_exponents import noisy_exponents
from liepoisson.noise.noisy_system import NoisySystem
from liepoisson.numeric.method.method import Method
from liepoisson.numeric.method.splitting import Splitting
from liepoisson.numeric.method.taylor import Taylor
from liepoisson.numeric.methods import Auto, as_choice, as_method
from liepoisson.numeric.run_options import ENSEMBLE_METHOD, RunOptions
from liepoisson.numeric.sampling import sample_states, sample_tangents
from liepoisson.numeric.systems import at_equal_times, n_of_time
from liepoisson.sweeps.family import Family, NumericTop, quiet
from liepoisson.sweeps.spec import DEFAULT_GENERAL, DEFAULT_METHOD, QUANTITIES
from liepoisson.sweeps.starts import Meaning, TopRows, is_top, liouville, project, require_meaning, system_functions

if TYPE_CHECKING:
    from liepoisson.sweeps.points import Targets
    from liepoisson.sweeps.spec import SweepSpec

OUTCOMES: tuple[str, ...] = (*_core.outcomes(), "no start", "not computed", "no system", "failed")
"""How orbits end; "no start": no state with the wanted energy and Casimirs was found; "no system": the system cannot
be made at the point, as where a moment is not positive; "failed": its quantity raised an error."""
NO_START, NOT_COMPUTED, NO_SYSTEM, FAILED = range(len(OUTCOMES) - 4, len(OUTCOMES))
POINT_TRIES = 3
"""How often a point is tried whose quantity raises an error."""
_NOT_FINITE = OUTCOMES.index("not finite")
_NO_SYSTEM = (LiePoissonError, ValueError, ArithmeticError)
"""Errors that say that there is no such system; any other is a failure of what makes it."""


class WorkerVersionError(LiePoissonError):
    """A worker has another version of liepoisson than the sweep that asks it; its bits could be others."""


@dataclass(frozen=True)
class Piece:
    """A task: some points of a sweep, with everything that their numbers depend on."""

    index: int  # which piece of its level
    spec: SweepSpec  # what is asked of each point
    family: Family  # the systems
    targets: Targets  # parameters, energy and Casimirs of the points
    # what the prescribed Casimirs mean at all points; None if they can mean one thing only
    meaning: Meaning | None = None
    noise: bool = False  # whether the systems have noise
    threads: int | None = 1  # threads of the core
    version: str = __version__  # version of liepoisson that may compute it


@dataclass
class PieceResult:
    """What a piece gives."""

    index: int  # which piece
    value: Array  # shape (point, member); NaN where an orbit failed
    outcome: NDArray[np.int8]  # codes of `OUTCOMES`, shape (point, member)
    # standard error over time of each exponent with noise, shape (point, member); None of other values
    error: Array | None = None
    seconds: float = 0.0  # time that it took
    method: str = ""  # how it was integrated, in words
    # why points failed, have no system or other Casimirs, by their number in the piece
    failed: dict[int, str] = field(default_factory=dict[int, str])
    retried: int = 0  # how many tries of points failed and were repeated


Listener: TypeAlias = Callable[[float], Any]
"""Called several times a second while orbits are integrated, and before each system and point."""


class Stopped(BaseException):
    """What a listener raises to end a piece; no failure of a point, so that no point is tried again."""


def run_piece(piece: Piece, listen: Listener | None = None) -> PieceResult:
    """Compute a piece; what `listen` raises ends it.

    The core looks for Ctrl-C in the main thread only, so that threads need a listener.
    """
    began = time.perf_counter()
    if __version__ != piece.version:
        raise WorkerVersionError(
            f"the sweep needs liepoisson {piece.version} on all workers; this one has {__version__}. "
            "Install the same version there."
        )
    if piece.spec.quantity not in QUANTITIES:
        resolve(piece.spec.quantity)
    points = _Points(piece, listen or _silent)
    points.compute()
    points.found.seconds = time.perf_counter() - began
    return points.found


def _silent(_: float) -> None: ...


class _Points:
    """The points of a piece: if one has no system or no start it is marked; the others are still computed."""

    def __init__(self, piece: Piece, listen: Listener) -> None:
        self.piece = piece
        self.listen = listen
        shape = len(piece.targets), piece.spec.n_starts
        errors = np.full(shape, np.nan) if has_errors(piece.spec, noise=piece.noise) else None
        self.found = PieceResult(piece.index, np.full(shape, np.nan), np.full(shape, NO_START, np.int8), errors)
        self.systems = _systems(piece, listen)

    def compute(self) -> None:
        """All points: together where it is the exponent, unless one of them fails."""
        good = [point for point, system in enumerate(self.systems) if not isinstance(system, Exception)]
        for point, system in enumerate(self.systems):
            if isinstance(system, Exception):
                self._mark(point, NO_SYSTEM if isinstance(system, _NO_SYSTEM) else FAILED, system)
        good = [point for point in good if self._has_meaning(point)]
        if self.piece.spec.quantity == "exponent" and good:
            try:
                self._together(good)
            except Exception:
                pass
            else:
                return
        for point in good:
            self._alone(point)

    def _has_meaning(self, point: int) -> bool:
        """Whether the prescribed Casimirs are the same functions as at the other points."""
        if self.piece.meaning is None:
            return True
        self.listen(0.0)
        try:
            require_meaning(quiet(self.systems[point]), self.piece.meaning)
        except ParameterError as error:
            self._mark(point, NO_START, error)
            return False
        return True

    def _alone(self, point: int) -> None:
        for tried in range(1, POINT_TRIES + 1):
            self.listen(0.0)
            try:
                return self._together([point])
            except Exception as error:
                if tried == POINT_TRIES:
                    return self._mark(point, FAILED, error)
                self.found.retried += 1
        return None

    def _mark(self, point: int, code: int, error: Exception) -> None:
        self.found.value[point], self.found.outcome[point] = np.nan, code
        if self.found.error is not None:
            self.found.error[point] = np.nan
        self.found.failed[point] = f"{OUTCOMES[code]}: {type(error).__name__}: {error}"

    def _together(self, chosen: list[int]) -> None:
        piece = replace(self.piece, targets=self.piece.targets.rows(chosen))
        systems, done = [self.systems[point] for point in chosen], self.found
        x0, found = _starts(piece, systems, self.listen)
        groups = _groups(systems)
        if piece.spec.quantity == "exponent" and len(groups) > 1 and (fields := _of_one_kind(piece, systems)):
            done.method = str(_method(piece, systems[0]))
            done.value[chosen], done.outcome[chosen] = _exponents_of_many(piece, fields, x0, found, self.listen)
            return
        for rows in groups:
            system, points = systems[rows[0]], [chosen[row] for row in rows]
            if piece.spec.quantity == "chaotic_fraction":
                done.method = str(piece.spec.method or ENSEMBLE_METHOD)
                for row, point in zip(rows, points, strict=True):
                    done.value[point], done.outcome[point] = _verdicts(piece, system, x0[row], found[row], self.listen)
                continue
            if piece.spec.quantity != "exponent":
                done.method = str(piece.spec.method or "the default of the quantity")
                for row, point in zip(rows, points, strict=True):
                    done.value[point], done.outcome[point] = _call(piece, system, x0[row], found[row])
                continue
            done.method = str(_method(piece, system))
            if done.error is not None:
                for row, point in zip(rows, points, strict=True):
                    given = system, x0[row], found[row], self.listen
                    done.value[point], done.error[point], done.outcome[point] = _noisy_exponents(piece, *given)
                continue
            if found[rows].any():
                given = x0[rows], found[rows]
                done.value[points], done.outcome[points] = _exponents(piece, system, *given, self.listen)


def system_and_starts(piece: Piece) -> tuple[Any, Array]:
    """The system of the only point of a piece, and its starts as in `run_piece`, shape (trajectory, component)."""
    system = piece.family.system(piece.targets.values(0))
    numeric = system if piece.spec.quantity not in QUANTITIES else piece.family.numeric(piece.targets.values(0))
    states, _ = _starts(piece, [numeric], _silent)
    return system, states[0]


def _systems(piece: Piece, listen: Listener) -> list[Any]:
    """The system of each point, as numbers where that is enough, or why there is none; equal points share one."""
    known: dict[str, Any] = {}
    systems: list[Any] = []
    for point in range(len(piece.targets)):
        values = piece.targets.values(point)
        key = repr(values)
        if key not in known:
            listen(0.0)
            make = piece.family.numeric if piece.spec.quantity in QUANTITIES else piece.family.system
            try:
                known[key] = _of_its_kind(piece, make(values))
            except Exception as error:
                known[key] = error
        systems.append(known[key])
    return systems


def _of_its_kind(piece: Piece, system: Any) -> Any:
    """The system, with noise where those of the other points have it: exponents of both kinds are not compared."""
    if isinstance(system, NoisySystem) != piece.noise:
        kind, other = ("without", "with") if piece.noise else ("with", "without")
        raise ParameterError(
            f"system: wanted noise at all points or at none; got one {kind} noise where the first is {other}. Leave "
            "out the points of one kind, or give NoisySystem(system, []) for one without noise."
        )
    return system


def _groups(systems: list[Any]) -> list[list[int]]:
    groups: dict[int, list[int]] = {}
    for point, system in enumerate(systems):
        groups.setdefault(id(system), []).append(point)
    return list(groups.values())


def _starts(piece: Piece, systems: list[Any], listen: Listener) -> tuple[Array, NDArray[np.bool_]]:
    """States, shape (point, member, component), and which of them have the prescribed energy and Casimirs."""
    targets, n, systems = piece.targets, piece.spec.n_starts, [quiet(system) for system in systems]
    if piece.spec.starts.sampling == "liouville":
        return _liouville(piece, systems, listen)
    shape = (len(piece.targets), n)
    drawn = sample_states(systems[0], n, seed=piece.spec.seed, ensemble=piece.spec.starts.ensemble)
    x = np.tile(drawn, (len(piece.targets), 1))
    prescribed = {**({} if targets.energy is None else {"energy": targets.energy}), **targets.casimirs}
    if not prescribed:
        return x.reshape(*shape, -1), np.ones(shape, bool)
    wanted = np.repeat(np.stack([*prescribed.values()], axis=-1), n, axis=0)
    names, fields = tuple(prescribed), [system.field() for system in systems]
    if all(is_top(system) for system in systems):
        tops = [data for data in fields if isinstance(data, TopField)]
        x, found = project(TopRows.of(tops, n).functions(names), wanted, x, length=3)
        return x.reshape(*shape, -1), found.reshape(shape)
    x, found = x.reshape(*shape, -1), np.zeros(shape, bool)
    for points in _groups(systems):
        states, good = project(
            system_functions(systems[points[0]], names),
            wanted.reshape(*shape, -1)[points].reshape(len(points) * n, -1),
            x[points].reshape(len(points) * n, -1),
            length=getattr(systems[points[0]], "vector_length", 0),
        )
        x[points], found[points] = states.reshape(len(points), n, -1), good.reshape(len(points), n)
    return x, found


def _liouville(piece: Piece, systems: list[Any], listen: Listener) -> tuple[Array, NDArray[np.bool_]]:
    targets = piece.targets
    x: list[Array] = []
    for point, system in enumerate(systems):
        listen(0.0)
        whole = piece.family.system(piece.targets.values(point)) if isinstance(system, NumericTop) else system
        casimirs = {name: float(values[point]) for name, values in targets.casimirs.items()}
        energy = None if targets.energy is None else float(targets.energy[point])
        x.append(liouville(whole, piece.spec.n_starts, piece.spec.seed, casimirs, energy))
    states = np.stack(x)
    return states, np.asarray(np.isfinite(states).all(axis=-1), np.bool_)


def is_noisy(spec: SweepSpec, family: Family, targets: Targets) -> bool:
    """Whether the systems have noise, as the first point that has a system says.

    Raises:
        ParameterError: they have, and the sweep asks for verdicts, or for exponents by another method than splitting.
    """
    for point in range(len(targets)):
        try:
            noise = family.has_noise(targets.values(point))
        except Exception:  # each such point says why it has none when it is computed
            continue
        if noise:
            _check_noise(spec)
        return noise
    return False


def _check_noise(spec: SweepSpec) -> None:
    if spec.is_verdict:
        raise ParameterError(
            'quantity: "chaotic_fraction" is of equations of motion, and a path of noise has none; try "exponent", or '
            "a function"
        )
    method = as_choice(spec.method)
    if spec.is_exponent and not (isinstance(method, Splitting) and method.precision == "double"):
        raise ParameterError(
            "method: wanted Splitting in double precision, whose steps noise can enter, with a step; got "
            f"{'none' if method is None else method}; try Splitting(step=0.01), in a sweep file name = "
            '"splitting" and step = 0.01 below [method]'
        )


def has_errors(spec: SweepSpec, *, noise: bool) -> bool:
    """Whether each value has an error over its time."""
    return noise and spec.is_exponent


def with_method(spec: SweepSpec, family: Family, targets: Targets) -> SweepSpec:
    """The spec with the method that `Auto` chooses for the first point that has a system: the same at all points.

    Exponents of tops and of quadratic fields have power series: orbits of many points share a register then.
    """
    if not isinstance(as_choice(spec.method), Auto):
        return spec
    default = ENSEMBLE_METHOD if spec.is_verdict else DEFAULT_GENERAL
    for point in range(len(targets)):
        try:
            field = family.numeric(targets.values(point)).field()
        except Exception:  # each such point says why it has none when it is computed
            continue
        in_series = spec.is_exponent and isinstance(field, (TopField, QuadraticField))
        return replace(spec, method=as_method(spec.method, default, field, in_series=in_series))
    return replace(spec, method=default)


def _method(piece: Piece, system: Any) -> Method:
    return cast("Method | None", piece.spec.method) or (
        DEFAULT_METHOD if isinstance(system.field(), TopField) else DEFAULT_GENERAL
    )


def _of_one_kind(piece: Piece, systems: list[Any]) -> list[TopField] | list[QuadraticField]:
    """The fields of the systems, if orbits of all can share a register; else none."""
    if not isinstance(_method(piece, systems[0]), Taylor) or n_of_time(systems[0]):
        return []
    fields = [system.field() for system in systems]
    tops = [data for data in fields if isinstance(data, TopField)]
    if len(tops) == len(systems):
        return tops
    quadratic = [data for data in fields if isinstance(data, QuadraticField)]
    terms = {
        tuple(entry[:-1] for part in (data.constant, data.linear, data.quadratic) for entry in part)
        for data in quadratic
    }
    return quadratic if len(quadratic) == len(systems) and len(terms) == 1 else []


def _exponents_of_many(
    piece: Piece,
    fields: list[TopField] | list[QuadraticField],
    x0: Array,
    found: NDArray[np.bool_],
    listen: Listener,
) -> tuple[Array, NDArray[np.int8]]:
    """Exponents and outcomes of points with a field of their own, shape (point, member): all in the same registers."""
    value, outcome = np.full(found.shape, np.nan), np.full(found.shape, NO_START, np.int8)
    point, member = np.nonzero(found)
    if len(point):
        value[found], ended = exponents_of_many(
            cast("list[TopField]", [fields[k] for k in point]),
            x0[found],
            t_end=float(piece.spec.t_end),
            tangents=sample_tangents(x0.shape[-1], piece.spec.n_starts, seed=piece.spec.seed)[member],
            options=RunOptions.read(_method(piece, fields[0]), piece.threads, math.inf, listen),
        )
        outcome[found] = _ORDER[np.searchsorted(_SORTED, ended)]
    return value, outcome


def _exponents(
    piece: Piece, system: Any, x0: Array, found: NDArray[np.bool_], listen: Listener
) -> tuple[Array, NDArray[np.int8]]:
    """Exponents and outcomes of points that share a system, shape (point, member)."""
    value, outcome = np.full(found.shape, np.nan), np.full(found.shape, NO_START, np.int8)
    member = np.broadcast_to(np.arange(piece.spec.n_starts), found.shape)[found]
    drawn = sample_tangents(x0.shape[-1], piece.spec.n_starts, seed=piece.spec.seed)
    growth = finite_time_exponents(
        system,
        x0[found],
        times=[float(piece.spec.t_end)],
        tangents=at_equal_times(system, drawn)[member],
        method=_method(piece, system),
        threads=piece.threads,
        time_limit=math.inf,
        progress=listen,
    )
    value[found] = growth.exponent[:, -1]  # NaN where an orbit failed
    outcome[found] = _ORDER[np.searchsorted(_SORTED, growth.outcome)]
    return value, outcome


def _noisy_exponents(
    piece: Piece, system: NoisySystem, x0: Array, found: NDArray[np.bool_], listen: Listener
) -> tuple[Array, Array, NDArray[np.int8]]:
    """Exponents, errors over time and outcomes of one point, shape (trajectory,): those of `noisy_exponents`.

    Trajectory k follows path k of the seed at every point.
    """
    shape = piece.spec.n_starts
    if not found.any():
        return np.full(shape, np.nan), np.full(shape, np.nan), np.full(shape, NO_START, np.int8)
    run = noisy_exponents(
        system.system,
        # trajectory k keeps its path; rows without a start end at once
        np.where(found[:, None], x0, np.nan),
        **system.noise,
        t_end=float(piece.spec.t_end),
        method=cast("Splitting", piece.spec.method),
        seed=piece.spec.seed,
        threads=piece.threads,
        time_limit=math.inf,
        progress=listen,
    )
    codes = np.where(found, _ORDER[np.searchsorted(_SORTED, run.outcome)], NO_START).astype(np.int8)
    return np.where(codes == 0, run.exponent, np.nan), np.where(codes == 0, run.error, np.nan), codes


def _verdicts(
    piece: Piece, system: Any, x0: Array, found: NDArray[np.bool_], listen: Listener
) -> tuple[Array, NDArray[np.int8]]:
    """Verdicts of one point as numbers, -1 regular, 0 undecided, +1 chaotic, and outcomes, shape (trajectory,)."""
    value, outcome = np.full(piece.spec.n_starts, np.nan), np.full(piece.spec.n_starts, NO_START, np.int8)
    if not found.any():
        return value, outcome
    verdict = decide(
        system,
        # trajectory k keeps its tangent vectors; rows without a start end at once
        np.where(found[:, None], x0, np.nan),
        t_end=float(piece.spec.t_end),
        seed=piece.spec.seed,
        rule=piece.spec.rule,
        method=piece.spec.method,
        threads=piece.threads,
        time_limit=math.inf,
        progress=listen,
    )
    codes = _ORDER[np.searchsorted(_SORTED, verdict.outcome)]
    numbers = (verdict.verdict == "chaotic").astype(np.float64) - (verdict.verdict == "regular")
    return np.where(found & (codes == 0), numbers, np.nan), np.where(found, codes, outcome).astype(np.int8)


_ORDER = np.argsort(np.array(OUTCOMES))
_SORTED = np.array(OUTCOMES)[_ORDER]


def _call(piece: Piece, system: Any, x0: Array, found: NDArray[np.bool_]) -> tuple[Array, NDArray[np.int8]]:
    """The values of a function of the user for one point; one that is not finite is an outcome."""
    spec, function = piece.spec, resolve(piece.spec.quantity)
    values, codes = np.full(spec.n_starts, np.nan), np.full(spec.n_starts, NO_START, np.int8)
    if found.any():
        options = {"t_end": float(spec.t_end), "method": spec.method, "seed": spec.seed, "threads": piece.threads}
        asked = found | piece.noise  # with noise trajectory k keeps its path; where it has no start its row is NaN
        given = function(system, np.where(found[:, None], x0, np.nan)[asked], **options)
        returned = as_array(given, "quantity")
        if returned.shape != (int(asked.sum()),):
            raise ParameterError(
                f"quantity: wanted a number for each of {int(asked.sum())} starts; got shape {returned.shape}."
            )
        values[asked] = returned
        codes[found] = np.where(np.isfinite(values[found]), 0, _NOT_FINITE)
    return np.where(codes == 0, values, np.nan), codes


def resolve(quantity: str | Callable[..., Any]) -> Callable[..., Any]:
    """The function that a dotted name "package.module:function" stands for."""
    if callable(quantity):
        return quantity
    module, _, name = quantity.partition(":")
    try:
        function = getattr(import_module(module), name)
    except (ImportError, AttributeError) as error:
        raise ParameterError(f"quantity: wanted package.module:function; {quantity!r} is none ({error}).") from error
    if not callable(function):
        raise ParameterError(f"quantity: wanted a function; {quantity} is {shown(function)}. Correct the name.")
    return function
