"""Results as tables: columns of equal length, a DataFrame, a file of comma-separated values."""

from __future__ import annotations

import csv
import io
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from liepoisson.errors import OutputError
from liepoisson.inputs.refusals import shown
from liepoisson.io.files import write_atomically

if TYPE_CHECKING:
    from pandas import DataFrame


class Tabular(ABC):
    """What is a table, too: one row for each thing that was computed, one column for each number or word about it."""

    @abstractmethod
    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table by name, one-dimensional arrays of one length; what has more dimensions has several.

        A vector has a column for each component (`l1`, `l2`, ...; of another vector than the state with its name before
        them, `start_l1`).
        """

    def to_dataframe(self) -> DataFrame:
        """The table as a pandas DataFrame: one row for each trajectory and time, trajectory, crossing, or point.

        What the rows of each kind of result are stands in docs/tables.md.  Curves of exponents and indicators have one
        row for each trajectory, with the values at the last time; `dataset` has the curves.
        """
        from pandas import DataFrame

        return DataFrame(self.columns())

    def to_csv(self, path: str | Path) -> Path:
        """Writes the table as comma-separated values, with a line of names; pandas is not needed.

        Numbers are written with the digits that give the same doubles back, missing ones as nan.

        Raises:
            OutputError: The name does not end in .csv, or the file cannot be written; an older file of that name is
                left as it was.
        """
        return write_csv(path, self.columns())


def vector_columns(
    name: str, vectors: Sequence[Any] | NDArray[Any], names: Sequence[str] | None = None
) -> dict[str, NDArray[Any]]:
    """A column for each component of vectors that are the rows, by the names of the components or numbers from 1."""
    rows = np.array(vectors, dtype=np.float64).reshape(len(vectors), -1 if len(vectors) else len(names or ()))
    labels = range(1, rows.shape[1] + 1) if names is None else names
    return {f"{name}_{label}": column for label, column in zip(labels, rows.T, strict=True)}


def beside(rows: dict[str, NDArray[Any]], names: Sequence[str], values: NDArray[Any]) -> dict[str, NDArray[Any]]:
    """Columns with more of them, which users named; a name that is taken gets an underscore."""
    found = dict(rows)
    for name, column in zip(names, values.T, strict=True):
        while name in found:
            name += "_"  # noqa: PLW2901
        found[name] = column
    return found


def write_csv(path: str | Path, columns: Mapping[str, NDArray[Any]]) -> Path:
    """Writes columns of equal length under their names.

    Raises:
        OutputError: as `Tabular.to_csv`.
    """
    try:
        path = Path(path)
    except TypeError as error:
        raise OutputError(f"wanted the name of a file; got {shown(path)}; write for example run.csv") from error
    if path.suffix != ".csv":
        raise OutputError(f"wanted a name that ends in .csv; got {shown(str(path))}; write for example run.csv")
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*(np.asarray(column).tolist() for column in columns.values()), strict=True))
    write_atomically(path, text.getvalue().encode())
    return path
