"""Integrals over a grid of parameters: how many further ones there are at each point, exactly.

Where `integrable_families` is out of reach, a grid shows where to look.  At each point all parameters are numbers, so
that what is found there, and that there is nothing else, is proved for this point.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from fractions import Fraction
from hashlib import sha256
from itertools import product
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from liepoisson.algebra.sparse_polynomials import expression
from liepoisson.errors import ParameterError
from liepoisson.formula.parameters import Parameter, read_parameter
from liepoisson.formula.scalars import TIME_LIMIT, as_count, as_deadline, as_threads
from liepoisson.inputs.calls import shows_progress
from liepoisson.inputs.given import listed, named
from liepoisson.inputs.refusals import shown
from liepoisson.integrability.derivation import n_monomials
from liepoisson.integrability.families import check_parameters
from liepoisson.integrability.further_integrals import ParameterMatrix
from liepoisson.integrability.polynomial_integrals import MOST_MONOMIALS
from liepoisson.integrability.scan_points import PointResult, PointSearch, ScanStore, plain, plain_family, results
from liepoisson.integrability.search_problem import (
    Equations,
    SearchProblem,
    equations_of,
    known_functions,
    zeros_on_level,
)
from liepoisson.io.files import exclusive
from liepoisson.io.result import Result, labelled, names_along, recorded
from liepoisson.model.equations_of_motion import EquationsOfMotion
from liepoisson.report.printing import Formula

if TYPE_CHECKING:
    from xarray import DataArray

MOST_POINTS = 1_000_000
_LARGEST_PIECE = 16
"""Points that are computed before they are stored."""
_PIECES_OF_A_PROCESS = 4
"""Of small scans: fewer pieces are not worth the second in which another process begins."""


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class IntegralScan(Result):
    """How many further integrals there are at the points of a grid of parameters.

    Example:
        >>> top = lp.System(lp.so(3) @ lp.semidirect(2), "l1^2 + l2^2 + J*l3^2 + alpha1", symbols=["J"])
        >>> scan = lp.integrability.scan_integrals(top, axes={"J": ["1/2", 1, 2, 3]}, degree=4)
        >>> scan.n_further.tolist(), scan.complete  # l1 at J = 1, and Kovalevskaya's integral at J = 2
        ([0, 1, 1, 0], True)

    Attributes:
        degree: The largest degree of the integrals.
        on: Equations of the level that was searched.
        axes: The values of each parameter, exactly, as text.
        parameter: Names of the parameters.
        value: Values of the parameters, shape (point, parameter), as text.
        n_further: Number of integrals that are functionally independent of H, the Casimirs and each other, shape
            (point,); -1 where it is not known.
        outcome: "finished": counted, and proved that there are no others; "not proved"; "no system": a denominator
            vanishes; "failed": its process ended, as for want of memory; "time limit": not computed.
        found: The integrals that are no polynomials in H and the Casimirs, by the number of the point.
        time_limit: Seconds that the scan might take.
    """

    kind = "integral scan"
    made_by = "scan_integrals"
    rows = ("point",)

    system: EquationsOfMotion
    degree: int
    on: tuple[str, ...]
    axes: dict[str, tuple[str, ...]] = recorded(
        lambda axes: {name: list(values) for name, values in axes.items()},
        lambda axes: {name: tuple(values) for name, values in axes.items()},
    )
    parameter: tuple[str, ...] = names_along("parameter")
    value: NDArray[np.str_] = labelled("point", "parameter", long_name="values of the parameters")
    n_further: NDArray[np.int64] = labelled("point", long_name="number of further integrals")
    outcome: NDArray[np.str_] = labelled("point", long_name="outcome")
    found: dict[int, tuple[str, ...]] = recorded(
        lambda found: {str(point): list(texts) for point, texts in found.items()},
        lambda found: {int(point): tuple(texts) for point, texts in found.items()},
    )
    time_limit: float

    def arguments(self) -> dict[str, Any]:
        """What `scan_integrals` was called with, but for the system."""
        return {"degree": self.degree, "on": self.on, "axes": self.axes, "time_limit": self.time_limit}

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table: of each point the parameters, the outcome, and the integrals that were found."""
        found = ["; ".join(self.found.get(point, ())) for point in range(len(self.outcome))]
        return {**super().columns(), "found": np.array(found)}

    @property
    def complete(self) -> bool:
        """Whether the number at each point that has a system is proved."""
        return bool(np.isin(self.outcome, ("finished", "no system")).all())

    @property
    def special(self) -> tuple[dict[str, str], ...]:
        """The points with further integrals."""
        return tuple(
            dict(zip(self.parameter, map(str, self.value[k]), strict=True)) for k in np.flatnonzero(self.n_further > 0)
        )

    @property
    def grid(self) -> DataArray:
        """The numbers over the axes that have several values, for `grid.plot()`; exact values beside them."""
        from xarray import DataArray

        names = [name for name in self.parameter if len(self.axes[name]) > 1] or list(self.parameter)
        coordinates: dict[str, Any] = {name: [float(Fraction(v)) for v in self.axes[name]] for name in names}
        coordinates |= {f"{name}_exact": (name, list(self.axes[name])) for name in names}
        shape = [len(self.axes[name]) for name in names]
        label = {"long_name": f"further integrals up to degree {self.degree}"}
        return DataArray(self.n_further.reshape(shape), coordinates, names, "n_further", label)

    def __repr__(self) -> str:
        axes = " x ".join(f"{name} ({len(values)})" for name, values in self.axes.items())
        n, missing = int((self.n_further > 0).sum()), int((~np.isin(self.outcome, ("finished", "no system"))).sum())
        state = f", incomplete: {missing} left" if missing else ""
        return (
            f"<IntegralScan of {self.system.name} over {axes}, degree {self.degree}: further integrals at {n} of "
            f"{len(self.n_further)} points{state}>"
        )


@shows_progress
def scan_integrals(
    system: EquationsOfMotion,
    *,
    axes: Mapping[str, Parameter | Sequence[Parameter]],
    degree: int = 2,
    on: Equations = (),
    store: str | Path | None = None,
    fresh: bool = False,
    threads: int | None = None,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> IntegralScan:
    """How many further polynomial integrals there are at each point of a grid of parameters, exactly.

    Example:
        >>> top = lp.System(lp.so(3) @ lp.semidirect(2), "l1^2 + l2^2 + J*l3^2 + alpha1", symbols=["J"])
        >>> scan = lp.integrability.scan_integrals(top, axes={"J": [1, "3/2", 2, 3, 4]}, degree=4)
        >>> scan.special
        ({'J': '1'}, {'J': '2'})

    Args:
        system: A system or vector field with symbols for parameters and rational numbers.
        axes: Values of each parameter, or one value: {"J1": [1, "3/2"], "a1": 1}.  Numbers are exact; 0.1 is 1/10.
        degree: The total degree of the integrals.
        on: Equations of an invariant level set, as for `first_integrals`.
        store: Folder in which points are kept as they are done.  A scan that was interrupted goes on from there.
        fresh: Discard what the store holds.
        threads: Points that are computed at once, in processes of their own where there are many.
        time_limit: Seconds after which the points that are left have the outcome "time limit".
        progress: As for `integrate`.

    Raises:
        ParameterError: a parameter has no values or is none, a value is not rational, or as for `first_integrals`.
        OutputError: the store holds another scan, is in use, or cannot be written.
        DamagedFileError: the store cannot be read.
        KeyboardInterrupt: Ctrl-C; what is stored stays.
    """
    d, deadline, n_at_once = as_count(degree, "degree", least=1), as_deadline(time_limit), as_threads(threads)
    _check_store(store)
    chosen = equations_of(system, on)
    search, names = _search(system, d, chosen)
    grid = _axes(axes, names)
    points = [tuple(map(Fraction, point)) for point in product(*grid.values())]
    ordered = {k: [dict(zip(grid, point, strict=True))[name] for name in names] for k, point in enumerate(points)}
    equations = tuple(map(str, chosen))
    done: dict[int, PointResult] = {}
    # the digest is one of everything that the numbers of the points depend on
    digest = sha256(repr(search).encode()).hexdigest()
    with _opened(store, fresh, {"search": digest, "axes": grid, "degree": d, "on": equations}) as kept:
        if kept is not None:
            done |= {k: result for k, result in kept.known.items() if k in ordered}
        missing = {k: values for k, values in ordered.items() if k not in done}
        for found in results(search, *_pieces(missing, n_at_once), deadline):
            if not found:
                continue
            if kept is not None:
                kept.keep(found)
            done |= found
            if progress:
                progress(len(done) / len(points))
    late = PointResult("time limit")
    whole = [done.get(k, late) for k in range(len(points))]
    return IntegralScan(
        system=system,
        degree=d,
        on=equations,
        axes=grid,
        parameter=tuple(grid),
        value=np.array([[str(v) for v in point] for point in points]),
        n_further=np.array([result.n_further for result in whole], dtype=np.int64),
        outcome=np.array([result.outcome for result in whole]),
        found={
            k: tuple(Formula(expression(p.items(), system.variables)).plain for p in result.found)
            for k, result in enumerate(whole)
            if result.found
        },
        time_limit=deadline.seconds,
    )


def _search(system: EquationsOfMotion, degree: int, on: Equations) -> tuple[PointSearch, list[str]]:
    """The search as plain data, and the names of its parameters."""
    problem = SearchProblem.of(system, known_functions(system), zeros_on_level(system, on))
    derivation = problem.derivation
    check_parameters(system, derivation, "scan_integrals")
    if (size := n_monomials(len(system.variables), degree)) > MOST_MONOMIALS:
        raise ParameterError(
            f"degree: wanted at most {MOST_MONOMIALS:,} monomials; {degree} has {size:,}; take a smaller one"
        )
    level = problem.level
    matrix = ParameterMatrix(derivation, problem.zeros, level)
    search = PointSearch(
        n=len(system.variables),
        degree=degree,
        gradings=problem.gradings,
        components=tuple(map(plain_family, matrix.components)),
        denominator=plain(matrix.denominator),
        zeros=tuple(map(plain_family, matrix.zeros)),
        basis=tuple((lead, plain_family(generator)) for lead, generator in matrix.level.basis),
        known=tuple(
            (name, plain_family(matrix.without_denominators(level.remainder(f)))) for name, f in problem.known.items()
        ),
    )
    return search, matrix.names


def _axes(axes: Mapping[str, Any], names: Sequence[str]) -> dict[str, tuple[str, ...]]:
    """The values of the parameters as texts of fractions."""
    given = named(axes, "axes")
    if given is None or set(given) != set(names):
        example = ", ".join([f'"{names[0]}": [1, "3/2"]', *(f'"{name}": 1' for name in names[1:])])
        raise ParameterError(f"axes: wanted values of {', '.join(names)}, such as {{{example}}}; got {shown(axes)}")
    lists = {name: listed(v, f"axes: {name}") for name, v in given.items()}
    items = {name: [given[name]] if values is None else values for name, values in lists.items()}
    if (n := math.prod(map(len, items.values()))) > MOST_POINTS:
        raise ParameterError(f"axes: wanted at most {MOST_POINTS:,} points; got {n:,}; scan parts of the grid")
    grid: dict[str, tuple[str, ...]] = {}
    for name, several in items.items():
        values = [read_parameter(value, f"axes: {name}") for value in several]
        if not values or not all(isinstance(value, Fraction) for value in values):
            raise ParameterError(
                f"axes: {name}: wanted rational numbers; got {shown(several)}; write for example '3/2'"
            )
        if len(set(values)) < len(values):
            raise ParameterError(
                f"axes: {name}: wanted different values; got {shown(several)}; remove what comes twice"
            )
        grid[name] = tuple(map(str, values))
    return grid


def _pieces(missing: Mapping[int, Sequence[Fraction]], n_at_once: int) -> tuple[list[dict[int, Any]], int]:
    """The points in pieces, and the number of processes; what is found does not depend on either."""
    size = max(1, min(_LARGEST_PIECE, len(missing) // (_PIECES_OF_A_PROCESS * n_at_once)))
    points = list(missing.items())
    pieces = [dict(points[k : k + size]) for k in range(0, len(points), size)]
    return pieces, max(1, min(n_at_once, len(pieces) // _PIECES_OF_A_PROCESS))


def _check_store(store: Any) -> None:
    if store is not None and (not isinstance(store, (str, PathLike)) or not str(store)):  # "" is the working folder
        raise ParameterError(f"store: wanted the path of a folder; got {shown(store)}; write for example 'scan'")


@contextmanager
def _opened(store: Any, fresh: bool, description: Mapping[str, Any]) -> Generator[ScanStore | None]:
    path = None if store is None else Path(cast("str", store))
    with nullcontext() if path is None else exclusive(path):
        yield None if path is None else ScanStore(path, description, fresh=fresh)
