"""Observed values of functions of the state at times, of one or several runs, however a caller has them."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Self, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson.errors import ParameterError, ShapeError, did_you_mean
from liepoisson.formula.scalars import as_number
from liepoisson.inputs.arrays import Array, ReadOnlyArrays
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.inputs.given import is_data_set, labelled, listed_names, named
from liepoisson.inputs.refusals import counted, shown
from liepoisson.io.files import read_text
from liepoisson.io.tables import Tabular

Spread: TypeAlias = "float | str | Mapping[str, float | str]"
"""A number, the name of a column, or one of them for each column."""

_TIMES = ("t", "time")
"""Names of the column of times that need not be said."""
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
_MISSING = frozenset({"", "na", "nan", "n/a", "null", "none", "<na>"})
"""Cells of a file without a value, in small letters."""
_MOST_BYTES = 2**30
"""Of a file of data."""
_UNIT = re.compile(r"(?P<name>.*\S)\s*\[\s*(?P<unit>[^\d\s\]][^\]]*)\]")
"""A label with a unit, "x [mm]"; the index of a vector in a formula begins with a digit."""


@explains_its_methods
class Observations(ReadOnlyArrays):
    r"""Observed values $y_{ij}$ of functions $f_j$ of the state at times $t_i$, some of which may be missing.

    Example:
        >>> observed = lp.fits.Observations({"t": [0, 1, 2], "theta": [0.5, None, -0.25]}, errors=0.01)
        >>> observed
        <Observations of theta: 2 values at 3 times, t = 0 to 2, with errors>

    Args:
        data: A CSV file with a line of names, a table, a data set, a mapping from names to columns, or the result of
            a run with columns (`lp.integrate`), whose trajectories are runs. Numbers are in the units of the
            equations; a cell that is empty or NaN is missing. Of a DataFrame, levels of the index that have a name
            are columns, too.
        time: The column of times; by default the one that is called t or time.
        columns: Those that are compared, by default all that nothing else uses: a sequence of names, or a mapping from
            names to functions of the state, `{"pen": "atan2(alpha2, alpha1)"}`.  A column without such a function is
            called like a component, an invariant or a formula ("l3/alpha3").
        errors: Standard deviations of the values: a number, the name of a column, or a mapping from columns to these.
        weights: The same for weights $w = 1/\sigma^2$ of which only the ratios are known; a weight 0 leaves a value
            out.  Without errors and weights all values have the same error, which the fit estimates.
        run: The column that says to which run a row belongs, by numbers or names; by default all rows are one run.

    Attributes:
        names: What was observed: names and formulas.
        runs: Names of the runs.
        run: Place of the run of each row among `runs`, shape (row,).
        time: Times, increasing in each run, shape (row,).
        value: Observed values, NaN where one is missing, shape (row, observable).
        deviation: Their standard deviations, or numbers that are proportional to these, shape (row, observable).
        errors_are_known: Whether the standard deviations were given, and not only their ratios.

    Raises:
        MissingFileError: There is no such file.
        ParameterError: A column is not known, is given twice, has a unit, an infinity or a text, or has no value; times
            are missing, repeated or out of order; a standard deviation is not positive.
        ShapeError: Columns have different lengths.
    """

    names: tuple[str, ...]
    runs: tuple[str, ...]
    run: NDArray[np.int64]
    time: Array
    value: Array
    deviation: Array
    errors_are_known: bool

    def __init__(
        self,
        data: str | Path | Tabular | Mapping[str, ArrayLike] | Any,
        *,
        time: str | None = None,
        columns: Sequence[str] | Mapping[str, str] | None = None,
        errors: Spread | None = None,
        weights: Spread | None = None,
        run: str | None = None,
    ) -> None:
        table = _table(data)
        if isinstance(data, Tabular) and run is None and "trajectory" in table:
            run = "trajectory"
        if errors is not None and weights is not None:
            raise ParameterError("errors: wanted errors or weights; got both; leave one out")
        spread = errors if errors is not None else weights
        clock = _time_column(time, table)
        own = {clock} if run is None else {clock, _known(run, table, "run")}
        by_column = _by_column(spread, "errors" if weights is None else "weights")
        given = [spread] if by_column is None else [*by_column.values()]
        own |= {_known(one, table, "errors") for one in given if isinstance(one, str)}
        formulas = _formulas(columns, table, own)
        self.names = tuple(formulas.values())
        if len({*self.names}) < len(self.names):
            raise ParameterError(f"columns: wanted each function once; got {shown(self.names)}; leave one out")
        self.value = np.stack([_numbers(table[name], name) for name in formulas], axis=1)
        if (infinite := np.isinf(self.value)).any():
            row, column = np.argwhere(infinite)[0]
            raise ParameterError(
                f"data: wanted finite values; {self.names[column]} is infinite in row {row + 1}; leave the cell empty "
                "if the value is missing"
            )
        self.errors_are_known = errors is not None
        self.deviation = _deviations(spread, formulas, table, self.value, is_weight=weights is not None)
        self.value = np.where(np.isfinite(self.deviation), self.value, np.nan)
        for name, column in zip(formulas, self.value.T, strict=True):
            if not np.isfinite(column).any():
                raise ParameterError(f"data: wanted values; the column {name} has none; leave it out of columns")
        self.time = _numbers(table[clock], clock)
        self.runs, self.run = _runs(table[run] if run is not None else np.zeros(len(self.time), dtype=int))
        self._check_times(clock)
        super().__post_init__()

    def _check_times(self, clock: str) -> None:
        if not np.isfinite(self.time).all():
            row = int(np.argmin(np.isfinite(self.time)))
            raise ParameterError(f"time: wanted a finite time in each row; row {row + 1} of {clock} has none; drop it")
        for k, name in enumerate(self.runs):
            rows = np.flatnonzero(self.run == k)
            wrong = np.flatnonzero(np.diff(self.time[rows]) <= 0)
            if wrong.size:
                before, after = self.time[rows[wrong[0] : wrong[0] + 2]]
                which = f" of run {name}" if len(self.runs) > 1 else ""
                what = "repeated" if before == after else "out of order"
                raise ParameterError(
                    f"time: wanted times that increase{which}; {after:g} in row {rows[wrong[0] + 1] + 1} comes after "
                    f"{before:g} and is {what}; sort the rows, join repeated ones, or say which rows are another run: "
                    'run="column"'
                )

    @property
    def n_values(self) -> int:
        """Number of values that are not missing."""
        return int(np.isfinite(self.value).sum())

    @classmethod
    def of_arrays(cls, **arrays: Any) -> Self:
        """Observations whose attributes are known."""
        made = cls.__new__(cls)
        made.__setstate__(arrays)
        return made

    def __repr__(self) -> str:
        span = f"t = {self.time.min():g} to {self.time.max():g}"
        runs = f" of {counted(len(self.runs), 'run')}" if len(self.runs) > 1 else ""
        errors = ", with errors" if self.errors_are_known else ""
        what = f"{counted(self.n_values, 'value')} at {counted(len(self.time), 'time')}{runs}, {span}{errors}"
        return f"<Observations of {', '.join(self.names):.80}: {what}>"


def as_observations(given: Any) -> Observations:
    """The observations that a caller gives, or that are read from what is given."""
    return given if isinstance(given, Observations) else Observations(given)


def _table(data: Any) -> dict[str, Any]:
    """Columns by name, of equal length."""
    if isinstance(data, (str, Path)):
        return _read_csv(Path(data))
    if isinstance(data, Tabular):
        columns = {name: np.asarray(column) for name, column in data.columns().items()}
        found: dict[Any, Any] = {name: column for name, column in columns.items() if column.dtype.kind != "U"}
    elif is_data_set(data):
        if str(data.attrs.get("format", "")).startswith("liepoisson"):
            raise ParameterError("data: wanted a table; got the data set of a result; give the result itself")
        frame = data.to_dataframe().reset_index()
        found = {name: frame[name].to_numpy() for name in frame.columns}
    elif (columns := getattr(type(data), "columns", None)) is not None and columns is not None:
        index: Any = getattr(data, "index", None)
        levels = [level for level in getattr(index, "names", ()) if level is not None]
        found = {level: index.get_level_values(level) for level in levels} | {name: data[name] for name in data.columns}
    else:
        read = labelled(data, "data")
        by_label = read.by_label("data") if read is not None else named(data, "data")
        if by_label is None:
            raise ParameterError(
                f'data: wanted columns with names; got {shown(data)}; write {{"t": times, "theta": values}}, or give a '
                "DataFrame or the path of a CSV file"
            )
        found = by_label
    table = {str(name): column for name, column in found.items()}
    lengths = {name: len(column) if hasattr(column, "__len__") else -1 for name, column in table.items()}
    if not table or -1 in lengths.values() or any(isinstance(column, str) for column in table.values()):
        raise ShapeError(f"data: wanted a column of values for each name; got {shown(found)}; write lists of numbers")
    if len({*lengths.values()}) > 1:
        words = ", ".join(f"{name} {n}" for name, n in lengths.items())
        raise ShapeError(f"data: wanted columns of one length; got {words:.120}; write NaN for missing values")
    if not next(iter(lengths.values())):
        raise ParameterError("data: wanted at least one row; got none; check the table")
    return table


def _read_csv(path: Path) -> dict[str, Any]:
    """The columns of a file of comma-separated values; lines that begin with # are comments."""
    try:
        text = read_text(path, most=_MOST_BYTES)
    except (OSError, ValueError) as error:
        raise ParameterError(
            f"data: wanted a CSV file; got {str(path)!r:.120}, and {error!s:.80}. Check it."
        ) from error
    try:
        lines = [line for line in io.StringIO(text.removeprefix("\ufeff")) if line.strip() and not line.startswith("#")]
        rows = list(csv.reader(lines, skipinitialspace=True))
    except csv.Error as error:
        raise ParameterError(
            f"data: wanted comma-separated values; {str(path)!r:.120} has none ({error!s:.60}); save the table as CSV"
        ) from error
    if len(rows) < 2:
        raise ParameterError(f"data: wanted a line of names and lines of numbers; got {counted(len(rows), 'line')}")
    names = [name.strip() for name in rows[0]]
    if len(names) == 1 and (other := next((c for c in ";\t" if c in names[0]), None)):
        raise ParameterError(
            f"data: wanted values separated by commas; got {other!r} between them; save it with commas"
        )
    if all(_NUMBER.fullmatch(word) for name in names for word in name.split()):
        raise ParameterError(
            f"data: wanted a line of names first; got numbers, {', '.join(names):.60}; write the names above them, "
            "without #, which begins a comment"
        )
    if twice := sorted({name for name in names if names.count(name) > 1}):
        raise ParameterError(f"data: wanted each name of a column once; {twice[0]!r} comes twice. Rename one.")
    for k, row in enumerate(rows[1:], start=1):
        if len(row) != len(names):
            raise ShapeError(
                f"data: wanted {counted(len(names), 'value')} in each row; row {k} has {len(row)}; leave missing cells "
                "empty, and write decimal points"
            )
    return {name: [row[k].strip() for row in rows[1:]] for k, name in enumerate(names)}


def _known(name: Any, table: Mapping[str, Any], what: str) -> str:
    """The name of a column."""
    if not isinstance(name, str) or name not in table:
        raise ParameterError(
            f"{what}: wanted the name of a column; got {shown(name)}. {did_you_mean(name, table)}"
            f"The columns are {', '.join(table):.200}."
        )
    return name


def _time_column(time: str | None, table: Mapping[str, Any]) -> str:
    if time is not None:
        return _known(time, table, "time")
    found = [name for name in _TIMES if name in table]
    if len(found) != 1:
        raise ParameterError(
            f"time: wanted a column t or time; got {' and '.join(found) or 'neither'}; the columns are "
            f'{", ".join(table):.200}; say which one has the times, time="{next(iter(table))}"'
        )
    return found[0]


def _by_column(given: Any, what: str) -> dict[Any, Any] | None:
    """What is said for each column; None where one thing is said, or names in order."""
    return None if isinstance(given, str) else named(given, what)


def _formulas(columns: Any, table: Mapping[str, Any], own: set[str]) -> dict[str, str]:
    """The function of the state of each column that is compared."""
    if columns is None:
        found = {name: name for name in table if name not in own}
    elif (by := _by_column(columns, "columns")) is not None:
        found = by
    else:
        items = None if isinstance(columns, str) else listed_names(columns, "columns")
        if items is None:
            raise ParameterError(f'columns: wanted a sequence of names; got {shown(columns)}; write ["theta"]')
        found = {name: name for name in items}
    if not found:
        raise ParameterError("columns: wanted a column besides the times; got none; check the table")
    for name, formula in found.items():
        if _known(name, table, "columns") in own:
            raise ParameterError(f"columns: wanted each column for one thing; {name!r} has another use. Leave it out.")
        if not isinstance(formula, str):
            raise ParameterError(
                f"columns: wanted the text of a function of the state; got {shown(formula)} for {name}"
            )
        if unit := _UNIT.fullmatch(formula):
            raise ParameterError(
                f"columns: wanted a function of the state; got {formula!r:.80} with the unit {unit['unit']!r:.20}, and "
                "equations have none: all numbers are in the units of the equations. Say what it is, "
                f'columns={{"{formula}": "1000*{unit["name"]}"}} with the factor of the unit, or rename it.'
            )
    return found


def _numbers(column: Any, name: str) -> Array:
    """A column as doubles; NaN where a value is missing."""
    array = np.ma.asanyarray(column)
    if array.dtype.kind in "mM":
        start = " - start" if array.dtype.kind == "M" else ""
        raise ParameterError(
            f"data: wanted numbers; got {array.dtype} in {name}, whose unit equations do not know; try "
            f'(column{start}) / np.timedelta64(1, "s")'
        )
    plain = array.astype(np.float64).filled(np.nan) if np.ma.is_masked(array) else np.asarray(array.data)
    if plain.ndim != 1:
        raise ShapeError(f"data: wanted one number in each row; {name} has the shape {plain.shape}; give it in columns")
    if plain.dtype.kind in "fiu":
        return plain.astype(np.float64)
    return np.array([_number(value, name, k) for k, value in enumerate(plain.tolist(), start=1)], dtype=np.float64)


def _is_missing(value: Any) -> bool:
    if isinstance(value, str):
        return value.strip().lower() in _MISSING
    if isinstance(value, float):
        return np.isnan(value).item()
    return value is None or type(value).__name__ in ("NAType", "NaTType")


def _number(value: Any, name: str, row: int) -> float:
    if _is_missing(value):
        return np.nan
    if isinstance(value, str):
        try:
            return float(value)
        except ValueError:
            pass  # an exact number, such as 1/3, or none
    return as_number(value, f"data: {name} in row {row}", "a number")


def _deviations(
    spread: Any, formulas: Mapping[str, str], table: Mapping[str, Any], value: Array, *, is_weight: bool
) -> Array:
    """Standard deviations, or numbers proportional to them; NaN of values that have the weight 0."""
    what = "weights" if is_weight else "errors"
    found = np.ones_like(value)
    if spread is None:
        return found
    if (by_column := _by_column(spread, what)) is not None:
        for name in by_column:
            if name not in formulas:
                hint = did_you_mean(name, formulas)
                raise ParameterError(
                    f"{what}: wanted columns that are compared, {', '.join(formulas):.100}; got {shown(name)}. {hint}"
                )
        if missing := [name for name in formulas if name not in by_column]:
            raise ParameterError(f"{what}: wanted one for each column; got none for {missing[0]}. Give all of them.")
    else:
        by_column = dict.fromkeys(formulas, spread)
    for k, name in enumerate(formulas):
        one = by_column[name]
        column = (
            _numbers(table[one], one) if isinstance(one, str) else np.full(len(value), as_number(one, what, "a number"))
        )
        seen = np.isfinite(value[:, k])
        least = column >= 0 if is_weight else column > 0
        if bad := np.flatnonzero(seen & ~(least & np.isfinite(column))).tolist():
            kind = "weights that are not negative" if is_weight else "standard deviations above 0"
            raise ParameterError(
                f"{what}: wanted {kind}; {name} has {column[bad[0]]:g} in row {bad[0] + 1}; leave the value empty if "
                "it is missing"
            )
        with np.errstate(divide="ignore", invalid="ignore"):
            found[:, k] = np.where(column > 0, 1 / np.sqrt(column), np.nan) if is_weight else column
    return found


def _runs(column: Any) -> tuple[tuple[str, ...], NDArray[np.int64]]:
    """Names of the runs in the order in which they begin, and the place of each row among them."""
    values = np.ma.asanyarray(column).tolist()
    if missing := [str(row) for row, value in enumerate(values, start=1) if _is_missing(value)]:
        raise ParameterError(
            f"run: wanted the run of each row; none in rows {', '.join(missing):.100}; fill them in, or drop the rows"
        )
    texts = [repr(value).removesuffix(".0") if isinstance(value, float) else str(value) for value in values]
    names = tuple(dict.fromkeys(texts))
    return names, np.array([names.index(text) for text in texts], dtype=np.int64)
