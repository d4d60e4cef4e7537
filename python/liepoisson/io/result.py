"""What all results have in common: labels for their arrays, a dataset, a file, a picture, a line and a table.

A result is a frozen dataclass.  What each of its fields is in a dataset stands beside the field:

    @dataclass(frozen=True, kw_only=True)
    class Megno(Run):
        kind = "megno"
        made_by = "megno"
        time: Array = labelled("time", long_name="time")
        megno: Array = labelled("trajectory", "time", long_name="MEGNO")
        first: int

Fields without a label are plain values.  `liepoisson.io.dataset` writes and reads results from this alone, and
`arguments` says what the function that made the result is to be called with to make it again.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import MISSING, dataclass, field, replace
from functools import cache
from inspect import get_annotations
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Self

from liepoisson._lazy import homes_of
from liepoisson.errors import OutputError
from liepoisson.inputs.arrays import ReadOnlyArrays
from liepoisson.inputs.shared_words import ATTRIBUTES, completed
from liepoisson.io.display import as_line
from liepoisson.io.tables import Tabular

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from xarray import Dataset


@cache
def homes_of_results() -> dict[str, str]:
    """The module of each class of a result, as the chapter `results` has it."""
    return homes_of(str(Path(__file__).parents[1] / "results.pyi"))


KEY = "label"
"""Where the metadata of a dataclass field have its label."""


@dataclass(frozen=True)
class ArrayLabel:
    """An array of a dataset.

    Attributes:
        dims: The names of its dimensions; one that is `...` stands for any number, as of the starts of a map.
        attributes: What the dataset says about it.
        is_coordinate: Whether it is a coordinate of the dataset.
        numbers: The dimension whose places the values are, or none: of each crossing, the trajectory.
    """

    dims: tuple[Any, ...]
    attributes: dict[str, str]
    is_coordinate: bool = False
    numbers: str = ""


@dataclass(frozen=True)
class NamesLabel:
    """Names of the values along a dimension, which may come back in another order."""

    dim: str


@dataclass(frozen=True)
class PartLabel:
    """A dataclass of labelled arrays inside the result, or None; its arrays have a prefix in the dataset.

    Attributes:
        made_by: Gives the class.
        prefix: Put before the names of its fields.
        own_dims: Dimensions that are not those of the result: they have the prefix, too.
        with_system: Makes the part that was read one of the system of the result.
    """

    made_by: Callable[..., Any]
    prefix: str = ""
    own_dims: tuple[str, ...] = ()
    with_system: Callable[[Any, Any], Any] = lambda found, _: found


@dataclass(frozen=True)
class RecordLabel:
    """A value that is written as plain data and read from them."""

    write: Callable[[Any], Any]
    read: Callable[[Any], Any]


@dataclass(frozen=True)
class PiecesLabel:
    """Two arrays for each trajectory, of different lengths: the starts and the series of its steps."""

    dim: str
    names: tuple[str, str]
    dims: tuple[str, ...]


def labelled(
    *dims: Any,
    long_name: str,
    units: str = "dimensionless",
    is_coordinate: bool = False,
    numbers: str = "",
    default: Any = MISSING,
) -> Any:
    """A dataclass field that is an array with these dimensions (see `ArrayLabel`); with the default None, or none."""
    label = ArrayLabel(dims, {"long_name": long_name, "units": units}, is_coordinate, numbers)
    return field(default=default, metadata={KEY: label})


def names_along(dim: str, *, default: Any = MISSING) -> Any:
    """A dataclass field with the names of what stands along a dimension."""
    return field(default=default, metadata={KEY: NamesLabel(dim)})


def part(made_by: Callable[..., Any], prefix: str = "", *, default: Any = MISSING, **more: Any) -> Any:
    """A dataclass field that has labelled fields itself, or is None (see `PartLabel`)."""
    return field(default=default, metadata={KEY: PartLabel(made_by, prefix, **more)})


def recorded(write: Callable[[Any], Any], read: Callable[[Any], Any]) -> Any:
    """A dataclass field that is written as plain data."""
    return field(metadata={KEY: RecordLabel(write, read)})


def pieces(dim: str, names: tuple[str, str], dims: tuple[str, ...]) -> Any:
    """A dataclass field with two arrays for each trajectory; empty by default."""
    return field(default=(), metadata={KEY: PiecesLabel(dim, names, dims)})


class Saved(ReadOnlyArrays, Tabular):
    """What has a labelled dataset and a file from which it is read again: the result of a run, or what is kept."""

    kind: ClassVar[str]
    """What files call it."""
    made_by: ClassVar[str]
    """The function of its module that repeats the run; of what is not repeated, what looks again."""
    system: Any
    """The system, exactly as it was given."""

    @property
    def dataset(self) -> Dataset:
        """The same as a labelled xarray Dataset, whose attributes suffice to make it again."""
        from liepoisson.io.dataset import dataset_of

        return dataset_of(self)

    def save(self, path: str | Path) -> Path:
        """Writes a NetCDF file, from which `liepoisson.load` gives the same object.

        `liepoisson.rerun` repeats a run.

        Raises:
            OutputError: The name does not end in .nc, or the file cannot be written.
        """
        from liepoisson.io.dataset import save

        return save(self.dataset, path)

    def _repr_html_(self) -> str:
        """What a notebook shows: the line of the result, and its dataset."""
        return as_line(repr(self)) + self.dataset._repr_html_()  # pyright: ignore[reportPrivateUsage]  # IPython's protocol


class Result(Saved):
    """A result: arrays that cannot be changed, with a dataset, a file, a picture, and the run that made it.

    Example:
        >>> run = lp.integrate(lp.catalog.system("henon-heiles"), {"y": 0.1, "p_x": 0.3}, t_end=10)
        >>> dict(run.dataset["state"].sizes), run.dataset["component"].values.tolist()
        ({'trajectory': 1, 'time': 1001, 'component': 4}, ['x', 'y', 'p_x', 'p_y'])
    """

    rows: ClassVar[tuple[Any, ...]] = ("trajectory",)
    """The dimensions whose places are the rows of its table; `...` stands for those of the starts of a map."""
    along: ClassVar[Mapping[str, Sequence[str]]] = {}
    """Names of the places of dimensions without a label, for columns of the table."""

    def __init_subclass__(cls) -> None:
        """Describes the attributes that its docstring leaves out as others are."""
        super().__init_subclass__()
        names = [name for base in reversed(cls.__mro__) for name in get_annotations(base)]
        cls.__doc__ = completed(cls.__doc__, "Attributes", names, ATTRIBUTES)

    @abstractmethod
    def arguments(self) -> dict[str, Any]:
        """What the function that made this is called with to make it again, but for the system."""

    def with_time_limit(self, time_limit: float) -> Self:
        """The same as the result of a run with another limit of seconds, which ended nothing.

        Raises:
            ParameterError: it is no positive number.
        """
        from liepoisson.formula.scalars import as_time_limit

        return replace(self, time_limit=as_time_limit(time_limit))  # pyright: ignore[reportArgumentType, reportCallIssue]  # a dataclass

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table by name, one-dimensional arrays; vectors have one column for each component."""
        from liepoisson.io.dataset import columns_of

        return columns_of(self)


class Kept(Saved):
    """A result that is written whole, as plain data beside its table; it is read again, and not repeated."""

    row: ClassVar[str] = "orbit"
    """What a row of its table is about."""

    @abstractmethod
    def records(self) -> dict[str, Any]:
        """Plain data that JSON can write, by name: as "record" all of it, and what readers of the file may look for."""

    @classmethod
    @abstractmethod
    def of_record(cls, record: Any, system: Any) -> Self:
        """The result whose "record" was written, of the system of its file."""

    def save(self, path: str | Path) -> Path:
        """Writes a NetCDF file, from which `liepoisson.load` gives the same object.

        Raises:
            OutputError: The name does not end in .nc, or the file cannot be written; or the system has no text.
        """
        if self.system.text is None:
            raise OutputError(
                f"{self.system.name!r} has no text that it could be read from again; keep the table, to_csv(path)"
            )
        return super().save(path)
