"""Results as labelled datasets and files, and back.

A dataset carries everything that its run was given: the system, exactly and as the field that was integrated, the
method with all its options, the starts, the seed, the limit of time, and the version of liepoisson.  What is written
where follows from the labels of the fields of the result (`liepoisson.io.result`).
"""

from __future__ import annotations

import json
import math
from dataclasses import MISSING, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from liepoisson import _core
from liepoisson.errors import DamagedFileError, MissingFileError, OutputError, ParameterError, did_you_mean
from liepoisson.inputs.arrays import read_only
from liepoisson.inputs.refusals import shown
from liepoisson.io.files import another_format, write_atomically
from liepoisson.io.netcdf import netcdf, read_netcdf
from liepoisson.io.result import KEY, ArrayLabel, Kept, NamesLabel, PartLabel, PiecesLabel, RecordLabel, Result, Saved

if TYPE_CHECKING:
    from xarray import DataArray, Dataset

FORMAT = "liepoisson/2"

_LONGEST_ATTRIBUTE = 32_000
"""Characters: HDF5 keeps attributes of up to 64 kB."""


def dataset_of(result: Saved) -> Dataset:
    """The dataset of a result."""
    import xarray as xr

    writer = _Writer()
    if isinstance(result, Kept):
        writer.whole(result)
    else:
        writer.records["run"] = writer.values_of(result)
    system = result.system
    # json writes a float with the digits that give the same float back
    texts = {name: json.dumps(value) for name, value in writer.records.items()}
    attributes = {"format": FORMAT, "kind": type(result).kind, "system": str(system.name), "version": _core.__version__}
    attributes |= texts
    text = getattr(system, "text", None)
    if text is not None:
        attributes |= {"system_file": text, "system_kind": type(system).__name__}
    for name in (*texts, "system_file"):
        if len(attributes.get(name, "")) > _LONGEST_ATTRIBUTE:
            data = np.frombuffer(attributes.pop(name).encode(), dtype=np.uint8)
            writer.variables[name] = (f"{name}_byte", data, {"long_name": f"{name}, as text in UTF-8"})
    first = None if isinstance(result, Kept) else getattr(result, "first", None)
    if first is not None:  # trajectories have numbers, from which what is drawn for them follows
        writer.coordinates["trajectory"] = np.arange(first, first + len(writer.variables["outcome"][1]))
    dataset = xr.Dataset(writer.variables, writer.coordinates, attributes)
    unnumbered = [dim for dim in writer.numbered if dim in dataset.dims and dim not in dataset.coords]
    return dataset.assign_coords({dim: np.arange(dataset.sizes[dim]) for dim in unnumbered})


def columns_of(result: Result) -> dict[str, NDArray[Any]]:
    """The columns of the table of a result: what belongs to its rows; of curves along time the last values.

    Where no column is a time, one says how long the runs were.
    """
    found = [
        (item.name, label, np.asarray(getattr(result, item.name)))
        for item in fields(result)  # pyright: ignore[reportArgumentType]  # results are dataclasses
        if isinstance(label := item.metadata.get(KEY), ArrayLabel) and getattr(result, item.name) is not None
    ]
    rows = _row_dims(result, found)
    sizes = {
        d: n
        for _, label, value in found
        for d, n in zip(_written_dims(label.dims, value.ndim), value.shape, strict=True)
    }
    shape = tuple(sizes[dim] for dim in rows)
    table = {dim: _along_rows(places, dim, rows, shape) for dim, places in _places(result, found, rows, sizes).items()}
    taken = {*table, *(name for name, _, _ in found)}
    vectors: dict[str, NDArray[Any]] = {}
    for name, label, value in sorted(found, key=lambda one: not one[1].is_coordinate):
        dims = _written_dims(label.dims, value.ndim)
        if "time" in dims and "time" not in rows:
            value = value.take(-1, axis=dims.index("time"))  # noqa: PLW2901  # of a curve the last value
            dims = tuple(dim for dim in dims if dim != "time")
        own, extra = [dim for dim in rows if dim in dims], [dim for dim in dims if dim not in rows]
        about_rows = len(own) == len(rows) and not _SERIES.intersection(extra)
        if not about_rows and (extra or not (label.is_coordinate or name == "outcome")):
            continue
        widths = tuple(sizes[dim] for dim in extra)
        spread = (*(n if dim in own else 1 for dim, n in zip(rows, shape, strict=True)), *widths)
        ordered = value.transpose([dims.index(dim) for dim in (*own, *extra)]).reshape(spread)
        values = np.broadcast_to(ordered, (*shape, *widths))
        for place in np.ndindex(widths):
            parts = [_name_along(result, dim, k, sizes[dim]) for dim, k in zip(extra, place, strict=True)]
            is_bare = name == "state" and parts and "_".join(parts) not in taken
            column = "_".join(parts if is_bare else [label.numbers or name, *parts])
            (vectors if extra else table)[column] = values[(..., *place)].reshape(-1)
    if "time" not in table and (end := getattr(result, "t_end", None)) is not None:
        names = list(table)
        after = 1 + names.index("outcome") if "outcome" in names else 0
        ends = np.full(math.prod(shape), float(end))
        table = {name: table.get(name, ends) for name in (*names[:after], "t_end", *names[after:])}
    return table | vectors


_SERIES = {"block", "step"}
"""Dimensions along which a trajectory has a series: no columns of a table."""


def _row_dims(result: Result, found: list[tuple[str, ArrayLabel, Any]]) -> tuple[str, ...]:
    if result.rows != (...,):
        return result.rows
    return next(_written_dims(label.dims, value.ndim) for _, label, value in found if label.dims == (...,))


def _places(
    result: Result, found: list[tuple[str, ArrayLabel, Any]], rows: tuple[str, ...], sizes: dict[str, int]
) -> dict[str, NDArray[np.int64]]:
    """Numbers along the dimensions of rows that have no coordinate: of trajectories, and where there are several."""
    known = {label.dims[0] for _, label, _ in found if label.is_coordinate and len(label.dims) == 1}
    first = getattr(result, "first", 0)
    return {
        dim: np.arange(sizes[dim]) + (first if dim == "trajectory" else 0)
        for dim in rows
        if dim not in known and (dim == "trajectory" or len(rows) > 1)
    }


def _along_rows(places: NDArray[Any], dim: str, rows: tuple[str, ...], shape: tuple[int, ...]) -> NDArray[Any]:
    spread = tuple(-1 if other == dim else 1 for other in rows)
    return np.broadcast_to(places.reshape(spread), shape).reshape(-1)


def _name_along(result: Result, dim: str, k: int, n: int) -> str:
    """The name of a place along a dimension: of a component its own, else its number from 1."""
    for item in fields(result):  # pyright: ignore[reportArgumentType]
        label = item.metadata.get(KEY)
        if isinstance(label, NamesLabel) and label.dim == dim:
            return str(getattr(result, item.name)[k])
    names = result.along.get(dim, ())
    if dim.endswith("component"):
        names = getattr(result.system, "component_names", ())
    return str(names[k]) if len(names) == n else str(k + 1)


class _Writer:
    """Collects the variables and coordinates of a dataset, and what has no label as plain data."""

    def __init__(self) -> None:
        self.variables: dict[str, Any] = {}
        self.coordinates: dict[str, Any] = {}
        self.records: dict[str, Any] = {}
        self.numbered: set[str] = set()
        """Dimensions whose places other arrays have: they are numbered, so that a part of them knows which it is."""

    def values_of(self, owner: Any, prefix: str = "", own_dims: tuple[str, ...] = ()) -> dict[str, Any]:
        values: dict[str, Any] = {}
        for item in fields(owner):
            label, value, name = item.metadata.get(KEY), getattr(owner, item.name), prefix + item.name
            if isinstance(label, ArrayLabel):
                if value is None:
                    values[item.name] = None
                else:
                    self.array(name, value, _renamed(label, prefix, own_dims))
            elif isinstance(label, PartLabel):
                values[item.name] = None if value is None else self.values_of(value, label.prefix, label.own_dims)
            elif isinstance(label, PiecesLabel):
                self.pieces(value, label)
                values[item.name] = len(value)
            elif isinstance(label, NamesLabel):
                self.coordinates[label.dim] = values[item.name] = list(value)
            elif isinstance(label, RecordLabel):
                self.records[name] = label.write(value)
            elif item.name != "system":
                values[item.name] = _plain(value, name)
        return values

    def whole(self, result: Kept) -> None:
        """The columns of its table, those of a state as one array, and the result itself as plain data.

        HDF5 takes a name with "/" for a path; formulas that are names have "÷" there.
        """
        self.records |= result.records()
        row, components = result.row, list(result.system.component_names)
        self.coordinates["component"] = components
        columns = result.columns()
        for name in [one.removesuffix(f"_{components[0]}") for one in columns]:
            parts = [f"{name}_{component}" for component in components]
            if {*parts} <= {*columns}:
                vector = np.stack([columns.pop(part) for part in parts], axis=1)
                self.array(name, vector, ArrayLabel((row, "component"), {"long_name": f"{name}, a state"}))
        for name, column in columns.items():
            label = ArrayLabel((row,), {"long_name": name.replace("_", " ")})
            self.array(name.replace("/", "÷"), column, label)

    def array(self, name: str, value: Any, label: ArrayLabel) -> None:
        dims = _written_dims(label.dims, value.ndim)
        into = self.coordinates if label.is_coordinate else self.variables
        into[name] = (dims, value, label.attributes)
        if label.numbers:
            self.numbered.add(label.numbers)

    def pieces(self, value: Any, label: PiecesLabel) -> None:
        if not value:
            return
        owner = np.repeat(np.arange(len(value)), [len(first) for first, _ in value])
        first, second = label.names
        columns = (owner, np.concatenate([one for one, _ in value]), np.concatenate([other for _, other in value]))
        dims, names = (label.dim,), (f"{label.dim}_trajectory", first, second)
        self.numbered.add("trajectory")
        for name, column, own in zip(names, columns, (dims, dims, (*dims, *label.dims)), strict=True):
            self.variables[name] = (own, read_only(column), {})


def _renamed(label: ArrayLabel, prefix: str, own_dims: tuple[str, ...]) -> ArrayLabel:
    """The label in a part of a result, some of whose dimensions are its own."""
    dims = tuple(f"{prefix}{dim}" if dim in own_dims else dim for dim in label.dims)
    return replace(label, dims=dims) if own_dims else label


def _written_dims(dims: tuple[Any, ...], n: int) -> tuple[str, ...]:
    """Names for all dimensions: `...` stands for none, for "trajectory", or for axis0, axis1, ..."""
    if ... not in dims:
        return dims
    k, extra = dims.index(...), n - len(dims) + 1
    inner = ("trajectory",) if extra == 1 else tuple(f"axis{i}" for i in range(extra))
    return (*dims[:k], *inner, *dims[k + 1 :])


def _plain(value: Any, name: str) -> Any:
    """Numbers, texts, and lists and dictionaries of them."""
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, (list, tuple)):
        return [_plain(item, name) for item in value]
    if isinstance(value, dict):
        return {str(key): _plain(item, name) for key, item in value.items()}
    raise OutputError(f"{name}: a value of type {type(value).__name__} cannot be written to a file; save it yourself")


def result_of(kind: type[Any], dataset: Dataset, system: Any) -> Any:
    """The result of this class that a dataset holds.

    A dataset may be transposed, have names along a dimension in another order, or be a part of the trajectories.

    Raises:
        Exception: of many kinds, if something is missing or altered.
    """
    if issubclass(kind, Kept):
        return kind.of_record(json.loads(text_of(dataset, "record")), system)
    values = json.loads(text_of(dataset, "run"))
    return _read(kind, dataset, values, PartLabel(lambda: kind), system)


def text_of(dataset: Dataset, name: str) -> str:
    """A long text, from an attribute or from a variable of bytes."""
    return str(dataset.attrs[name]) if name in dataset.attrs else stored(dataset, name).to_numpy().tobytes().decode()


def stored(dataset: Dataset, name: str) -> DataArray:
    """A variable that the dataset has; xarray itself counts 0, 1, 2, ... along a dimension that has none.

    Raises:
        KeyError: it has none of this name.
    """
    if name not in dataset.variables:
        raise KeyError(name)
    return dataset[name]


def _read(kind: Any, dataset: Dataset, values: dict[str, Any], within: PartLabel, system: Any) -> Any:
    dataset, prefix = _renumbered(kind, _in_order(kind, dataset, values)), within.prefix
    found: dict[str, Any] = {}
    for item in fields(kind):
        if item.name == "system":
            found["system"] = system
            continue
        label, name = item.metadata.get(KEY), prefix + item.name
        if isinstance(label, ArrayLabel) and (name in dataset.variables or item.default is MISSING):
            found[item.name] = _array(dataset, name, _renamed(label, prefix, within.own_dims))
        elif isinstance(label, PartLabel):
            inner = values[item.name]
            if inner is not None:
                inner = label.with_system(_read(label.made_by(), dataset, inner, label, system), system)
            found[item.name] = inner
        elif isinstance(label, PiecesLabel):
            found[item.name] = _pieces(dataset, label, values[item.name]) if values[item.name] else ()
        elif isinstance(label, RecordLabel):
            found[item.name] = label.read(json.loads(text_of(dataset, name)))
        elif item.name == "first":
            found["first"] = _first_member(dataset)
        elif item.name in values or (item.default is MISSING and item.default_factory is MISSING):
            found[item.name] = _tuples(values[item.name])
    return kind(**found)


def _in_order(kind: Any, dataset: Dataset, values: dict[str, Any]) -> Dataset:
    """The dataset with the names along its dimensions in the order that the result has."""
    for item in fields(kind):
        label = item.metadata.get(KEY)
        if isinstance(label, NamesLabel):
            names, given = list(map(str, values[item.name])), list(map(str, stored(dataset, label.dim).to_numpy()))
            if sorted(names) != sorted(given):
                raise ValueError(f"{label.dim}: wanted {', '.join(names):.60} ({len(names)} names); got {len(given)}")
            if names != given:
                dataset = dataset.isel({label.dim: [given.index(name) for name in names]})
    return dataset


def _renumbered(kind: Any, dataset: Dataset) -> Dataset:
    """The dataset with what belongs to its trajectories, which may be a part of those of the run, in any order."""
    for item in fields(kind):
        label = item.metadata.get(KEY)
        if isinstance(label, ArrayLabel) and label.numbers:
            members, owner = numbers_of(dataset, label.numbers), stored(dataset, item.name).to_numpy()
            if owner.dtype.kind not in "iu":
                raise ValueError(f"{item.name}: wanted whole numbers; got {owner.dtype}")
            order = np.argsort(owner, kind="stable")
            first, end = (np.searchsorted(owner[order], members, side) for side in ("left", "right"))
            counts = end - first
            within = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
            (dim,) = label.dims
            dataset = dataset.isel({dim: order[np.repeat(first, counts) + within]})
            dataset = dataset.assign({item.name: (dim, np.repeat(np.arange(len(members)), counts))})
    return dataset


def numbers_of(dataset: Dataset, dim: str) -> NDArray[np.int64]:
    """The numbers that the places along a dimension have in the whole run, of which the dataset may be a part.

    Raises:
        ValueError: they were dropped, or are none.
    """
    if dim not in dataset.coords:
        raise ValueError(f"{dim}: wanted the numbers of the whole run along it; they were dropped from the dataset")
    numbers = dataset[dim].to_numpy()
    if numbers.dtype.kind not in "iu" or (numbers < 0).any():
        raise ValueError(f"{dim}: wanted the numbers of the whole run along it; got {shown(numbers.tolist())}")
    return numbers


def _array(dataset: Dataset, name: str, label: ArrayLabel) -> Any:
    variable = stored(dataset, name)
    array = variable.transpose(*_written_dims(label.dims, variable.ndim)).to_numpy()
    return array.astype(np.str_) if array.dtype.kind in "OT" else np.array(array, order="C")


def _pieces(dataset: Dataset, label: PiecesLabel, n: int) -> tuple[Any, ...]:
    owner, (first, second) = stored(dataset, f"{label.dim}_trajectory").to_numpy(), label.names
    begins = stored(dataset, first).to_numpy()
    rest = stored(dataset, second).transpose(label.dim, *label.dims).to_numpy()
    # which trajectories of the run these are: the dataset may be a part of it
    rows = numbers_of(dataset, "trajectory") if "trajectory" in dataset.dims else np.arange(1)
    if not (np.isin(rows, np.arange(n)).all() and np.isin(owner, np.arange(n)).all()):
        raise ValueError(f"{label.dim}: wanted those of {n} trajectories; got other numbers")
    return tuple((begins[owner == row], rest[owner == row]) for row in rows)


def _first_member(dataset: Dataset) -> int:
    """The number of the first trajectory; what is drawn for a trajectory follows from its number."""
    members = stored(dataset, "trajectory").to_numpy()
    first = int(members[0]) if len(members) else 0
    if not np.array_equal(members, np.arange(first, first + len(members))):
        raise ValueError(f"trajectory: wanted trajectories one after the other; got {shown(members.tolist())}")
    return first


def _tuples(value: Any) -> Any:
    """Lists as tuples, as results have them."""
    return tuple(map(_tuples, value)) if isinstance(value, list) else value


def save(dataset: Dataset, path: str | Path) -> Path:
    """Writes a dataset to a NetCDF file with a checksum, whole or not at all.

    Raises:
        OutputError: The path is none or does not end in .nc, or the file cannot be written; an older file of that name
            is left as it was.
    """
    try:
        path = Path(path)
    except TypeError as error:
        raise OutputError(f"wanted the name of a file; got {shown(path)}; write for example run.nc") from error
    if path.suffix != ".nc":
        raise OutputError(
            f"wanted a name that ends in .nc, as NetCDF is written; got {shown(str(path))}; write for example run.nc"
        )
    write_atomically(path, netcdf(dataset))
    return path


def read_dataset(path: str | Path, *, verify: bool = True) -> Dataset:
    """Reads a dataset that liepoisson has written, into memory.

    Args:
        path: The file.
        verify: Refuse a file whose contents do not have the checksum that liepoisson wrote.

    Raises:
        ParameterError: It is no path.
        MissingFileError: There is no such file.
        DamagedFileError: It is truncated, damaged or changed; or liepoisson did not write it.
    """
    try:
        if not str(path):  # it would be the working folder
            raise ValueError("an empty text")
        path = Path(path)
        found = path.is_file()
    except (TypeError, ValueError, OSError) as error:  # not a path, or a name that no file can have
        raise ParameterError(
            f"path: wanted the name of a file; got {shown(path)} ({error}); look at the name"
        ) from error
    if not found:
        near = did_you_mean(path.name, _neighbours(path))
        raise MissingFileError(
            f"{path}: wanted a file written by liepoisson; there is none of this name. "
            f"{near or f'Look at the name, and at the folder: {path.absolute().parent}.'}".strip()
        )
    dataset = read_netcdf(path, verify=verify)
    try:
        check_format(dataset)
    except ValueError as error:
        raise DamagedFileError(f"{path}: {error}") from error
    return dataset


def _neighbours(path: Path) -> list[str]:
    """The names in the folder of a path, as far as they can be read."""
    try:
        return [file.name for file in path.absolute().parent.iterdir()]
    except OSError:
        return []


def check_format(dataset: Dataset) -> None:
    """Refuses datasets of other programs and of other versions of the format.

    Raises:
        ValueError: it is one.
    """
    found = dataset.attrs.get("format")
    if isinstance(found, str) and found.startswith("liepoisson/") and found != FORMAT:
        raise ValueError(another_format(found, FORMAT, dataset.attrs.get("version")))
    if not isinstance(found, str) or found != FORMAT:
        raise ValueError(f"wanted a file written by liepoisson (format {FORMAT!r}); got another kind")
