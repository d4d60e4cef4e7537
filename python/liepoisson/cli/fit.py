"""The command `fit`: parameters and starts of a model from an observed orbit in a file."""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any

import typer

from liepoisson.cli.options import Common, Files, Format, FormatOption, SystemArgument, show
from liepoisson.cli.output import result_files, write_figure, write_result
from liepoisson.cli.runs import NO_RUN, TimeLimitOption, check_limits, running
from liepoisson.cli.starts import assignments, state_of
from liepoisson.cli.systems import read_numeric_equations
from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import TIME_LIMIT, as_double

if TYPE_CHECKING:
    from liepoisson.observations.orbit_fit import OrbitFit

DATA_HELP = "The observations, a CSV file with a line of names."
UNKNOWN_HELP = "What is looked for: a parameter or a component of the start, or a vector of them.  Repeat it for more."
TIME_HELP = "The column of times.  [default: t or time]"
RUN_HELP = "The column that says to which run a row belongs.  [default: all rows are one run]"
COLUMN_HELP = (
    "A column that is compared, and which function of the state it is: --column theta, or --column pen=180/pi*theta.  "
    "[default: all columns, by their names]"
)
ERROR_HELP = (
    "Standard deviations: of all values, --error 0.01, or of a column, --error theta=0.01, or in a column, --error "
    "theta=dtheta.  [default: from the residuals]"
)
BOUND_HELP = "Least and largest value of an unknown: --bound g=0:20, or g=0: with one end.  Repeat it for more."
START_HELP = (
    "The start, a guess where it is unknown: all numbers, or by name, --start theta=0.5.  [default: the first observed "
    "values]"
)
START_TIME_HELP = "Time of the start.  [default: that of the first observation of each run]"


def fit(
    system: SystemArgument,
    data: Annotated[str, typer.Argument(help=DATA_HELP, metavar="DATA.csv")],
    *,
    unknown: Annotated[list[str], typer.Option(metavar="NAME", help=UNKNOWN_HELP)],
    time: Annotated[str | None, typer.Option(metavar="COLUMN", help=TIME_HELP)] = None,
    run: Annotated[str | None, typer.Option(metavar="COLUMN", help=RUN_HELP)] = None,
    column: Annotated[list[str] | None, typer.Option(metavar="COLUMN=FORMULA", help=COLUMN_HELP)] = None,
    error: Annotated[list[str] | None, typer.Option(metavar="COLUMN=NUMBER", help=ERROR_HELP)] = None,
    start: Annotated[list[str] | None, typer.Option(metavar="STATE", help=START_HELP)] = None,
    start_time: Annotated[float | None, typer.Option(help=START_TIME_HELP)] = None,
    bound: Annotated[list[str] | None, typer.Option(metavar="NAME=LOW:HIGH", help=BOUND_HELP)] = None,
    time_limit: TimeLimitOption = TIME_LIMIT,
    files: Files,
    format_: FormatOption = Format.TEXT,
    common: Common,
) -> None:
    """Fit parameters and starts of a system to an observed orbit, and say what the data do not determine.

    The parameters of the system, with --set, are the guess.  Values come with standard errors.
    """
    from liepoisson.observations.observations import Observations
    from liepoisson.observations.orbit_fit import ENDED_WELL, orbit_fit

    check_limits(time_limit=time_limit)
    chosen = read_numeric_equations(system, common.values)
    path, stem = result_files(files, chosen, common.values, "fit")
    seen = Observations(data, time=time, run=run, columns=_columns(column), errors=_errors(error))
    with running("fitting", 1.0, quiet=common.quiet) as listen:
        found = orbit_fit(
            chosen,
            seen,
            unknown,
            starts=_start(state_of(start or (), "--start", chosen.component_names[0])),
            start_time=start_time,
            bounds=_bounds(bound or ()),
            time_limit=time_limit,
            progress=listen,
        )
    written = [] if path is None else [write_result(found, path)]
    if stem is not None:
        from liepoisson.plot.fits import orbit_fit as draw

        written += write_figure(draw(found), stem)
    show(found, format_, fit_record, text=lambda _: "\n".join([str(found), *(f"wrote    {one}" for one in written)]))
    if found.ending not in ENDED_WELL:
        print(f"liepoisson: the search did not converge ({found.ending}); try another guess.", file=sys.stderr)
        raise typer.Exit(NO_RUN)


def fit_record(found: OrbitFit) -> dict[str, Any]:
    """The fit as data that JSON can write."""
    return {
        "system": found.system.name,
        "ending": found.ending,
        "values": {
            name: {"value": float(value), "error": _or_null(error)}
            for name, value, error in zip(found.unknowns, found.value, found.error, strict=True)
        },
        "covariance": [[_or_null(value) for value in row] for row in found.covariance],
        "chi_squared": found.chi_squared,
        "degrees_of_freedom": found.degrees_of_freedom,
        "errors_are_known": found.errors_are_known,
        "undetermined": list(found.undetermined),
    }


def _or_null(value: float) -> float | None:
    """A number that JSON has."""
    return float(value) if math.isfinite(value) else None


def _columns(given: Sequence[str] | None) -> dict[str, str] | None:
    """Columns with their functions of the state; alone, a name is both."""
    if not given:
        return None
    words = [one if "=" in one else f"{one}={one}" for one in given]
    return assignments(words, "--column", "--column pen=180/pi*theta", "column")


def _errors(given: Sequence[str] | None) -> Any:
    """A number, or numbers and names of columns by column."""
    if not given:
        return None
    if len(given) == 1 and "=" not in given[0]:
        return _number_or_name(given[0], "--error")
    found = assignments(given, "--error", "--error theta=0.01", "column")
    return {name: _number_or_name(text, "--error") for name, text in found.items()}


def _number_or_name(text: str, option: str) -> float | str:
    """A number; the name of a column where it begins like one."""
    return text if text[:1].isalpha() or text[:1] == "_" else as_double(text, option)


def _start(given: Any) -> Any:
    """One state, of which each component is a number."""
    if isinstance(given, dict):
        return {name: value[0] if len(value) == 1 else value for name, value in given.items()}
    return given


def _bounds(given: Sequence[str]) -> dict[str, tuple[float | None, float | None]]:
    """Pairs of numbers, of which one may be left out."""
    found: dict[str, tuple[float | None, float | None]] = {}
    for name, text in assignments(given, "--bound", "--bound g=0:20", "unknown").items():
        low, colon, high = text.partition(":")
        if not colon:
            raise ParameterError(f"--bound must be name=low:high; got {name}={text!s:.60}. Write for example g=0:20.")
        found[name] = _end(low), _end(high)
    return found


def _end(text: str) -> float | None:
    return as_double(text, "--bound") if text.strip() else None
