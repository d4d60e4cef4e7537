"""What callers give: values in order, values by name, and the labels that data of other packages carry.

A list, a tuple, an array and a generator, which is read once, have an order; a mapping, a set and a text have none.
Labels are the names of the fields of a named tuple or a structured array, the index of a Series, the columns of a
table, the coordinates of an xarray object.  Where names are known, labels decide the order, and those that do not fit
are refused; where none are, labels that are texts are refused.  Numbers of rows are no labels.  A SymPy symbol stands
for its name, wherever names are read.

The axes of a table and of an xarray object are found by name, wherever they stand: a dimension that is called as in
`_AXES` or has a coordinate that is, and the one whose labels are the names that are wanted.  An axis that belongs to
nothing is refused where its place would be a guess.

pandas, polars and xarray are not imported: their objects are known by what they have.
"""

from __future__ import annotations

from collections.abc import ItemsView, Iterable, Iterator, Mapping, MappingView, Sequence, Set
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, TypeGuard, cast

from liepoisson.errors import ParameterError, ShapeError, did_you_mean
from liepoisson.inputs.names import is_identifier
from liepoisson.inputs.refusals import not_a, shown

_AXES = (
    "point", "trajectory", "energy", "member", "crossing", "time", "covariant_time", "tangent", "vector", "k",
    "component",
)  # fmt: skip
"""Dimensions of labelled arrays in the order in which functions take them."""

_NUMBERS = {int, float}
"""Types of most items, which are looked at first."""


@dataclass(frozen=True)
class Labelled:
    """Values with labels along their last axis.

    Attributes:
        labels: One for each place.
        columns: What stands there: numbers, or arrays of one shape.
    """

    labels: tuple[Any, ...]
    columns: tuple[Any, ...]

    def by_label(self, what: str) -> dict[Any, Any]:
        """What each label has.

        Raises:
            ParameterError: a label comes twice.
        """
        return _once(zip(self.labels, self.columns, strict=True), what)

    def ordered(self, names: Sequence[Any], what: str) -> Any:
        """The values in the order of the names: a tuple of numbers, or an array.

        Raises:
            ParameterError: a label is no name or comes twice, or a name has none.
        """
        if names or any(isinstance(label, str) for label in self.labels):
            columns = self._in_order(names, what)
        else:
            columns = self.columns
        if not any(getattr(column, "ndim", 0) for column in columns):
            return columns
        import numpy as np

        return np.stack(columns, axis=-1)

    def _in_order(self, names: Sequence[Any], what: str) -> tuple[Any, ...]:
        columns, wanted = self.by_label(what), {*names}
        if not names:
            raise ParameterError(
                f"{what}: wanted values in order, which have no names; got the labels {_few(self.labels)}; give a list "
                "without labels, or an array such as .to_numpy() makes"
            )
        if unknown := [label for label in columns if label not in wanted]:
            raise ParameterError(
                f"{what}: wanted the labels {_few(names)}; got {_few(unknown)} among them. "
                f"{did_you_mean(unknown[0], names)}Rename or drop it, or give a list without labels."
            )
        if missing := [name for name in names if name not in columns]:
            raise ParameterError(
                f"{what}: wanted the labels {_few(names)}; got none for {_few(missing)}. Give all of them."
            )
        return tuple(columns[name] for name in names)


def _once(pairs: Iterable[tuple[Any, Any]], what: str) -> dict[Any, Any]:
    found = dict[Any, Any]()
    for label, value in pairs:
        if (name := as_name(label)) in found:
            raise ParameterError(f"{what}: wanted each label once; {shown(name)} comes twice. Rename or drop one.")
        found[name] = value
    return found


def as_name(label: Any) -> Any:
    """The name of a SymPy symbol, if a formula could have it; everything else as it is."""
    kind = type(label)
    is_symbol = getattr(kind, "is_Symbol", False) is True and not getattr(kind, "is_Dummy", False)
    return str(label.name) if is_symbol and is_identifier(label.name) else label


def _as_names(labels: Iterable[Any]) -> tuple[Any, ...]:
    return tuple(map(as_name, labels))


def labelled(
    values: object, what: str = "values", names: Sequence[Any] = (), axis: str = "component"
) -> Labelled | None:
    """The values with their labels along an axis; None for values that have none.

    Raises:
        ParameterError: an axis of a table or of a labelled array belongs to nothing.
    """
    given = cast("Any", values)
    if isinstance(values, type):
        return None
    if isinstance(values, tuple):
        fields = getattr(given, "_fields", None)
        return None if fields is None else Labelled(tuple(fields), tuple(given))
    if fields := getattr(getattr(given, "dtype", None), "names", None):
        record = given[()] if getattr(given, "ndim", 0) == 0 else given
        return Labelled(tuple(fields), tuple(record[name] for name in fields))
    if not _has_axes(given):
        return None
    array, labels = _arranged(given, what, names, axis)
    if labels is None or labels == tuple(range(len(labels))):
        return None
    return Labelled(labels, tuple(array[k] if array.ndim == 1 else array[..., k] for k in range(len(labels))))


def ordered(values: Any, what: str, names: Sequence[str] = ()) -> Any:
    """An array, or nested lists, without labels, the last axis in the order of the names.

    Raises:
        ShapeError: a mapping or a set, which have no order.
        ParameterError: labels that do not fit, or a boolean among numbers.
    """
    if type(values) in (list, tuple):
        return values if _NUMBERS.issuperset(map(type, values)) else [ordered(item, what, names) for item in values]
    if isinstance(values, bool) or getattr(getattr(values, "dtype", None), "kind", "") == "b":
        raise ParameterError(f"{what}: wanted real numbers; got {shown(values)}; write 1 or 0")
    if (found := labelled(values, what, names)) is not None:
        plain = found.ordered(names, what)
        return ordered(list(plain), what) if isinstance(plain, tuple) else plain
    if _has_axes(values):
        return _arranged(values, what, names)[0]
    if is_named(values) or is_set(values):
        raise ShapeError(
            f"{what}: wanted an array of numbers; got {type(values).__name__}, which has no order; try a list of floats"
        )
    if not isinstance(values, (list, tuple, Iterator, MappingView)):
        return values
    return ordered(list(cast("Any", values)), what, names)


def at_times(values: Any, what: str, times: Sequence[float]) -> Any:
    """Values at given times, the last axis in the order of the times where it says which ones it has.

    Raises:
        ParameterError: it says others.
    """
    if not _has_axes(values):
        return values
    found = labelled(values, what, times, "time")
    return _arranged(values, what, times, "time")[0] if found is None else found.ordered(times, what)


def at_interval(values: Any, what: str, interval: float) -> Any:
    """Evenly spaced samples without labels, the times in the last axis.

    Raises:
        ParameterError: the samples have times as labels that do not differ by the interval.
    """
    if not _has_axes(values):
        return values
    found = labelled(values, what, (), "time")
    if found is None:
        return _arranged(values, what, (), "time")[0]
    plain, times = found.ordered((), what), found.labels
    if any(abs(after - before - interval) > 1e-6 * interval for before, after in pairwise(times)):  # round-off of times
        raise ParameterError(
            f"{what}: wanted samples at times that differ by the interval {interval:g}; got {_few(times)}. Sort it by "
            "time, or give an array without labels."
        )
    return plain


def listed(values: object, what: str = "values", names: Sequence[str] = ()) -> list[Any] | None:
    """The items of a sequence in order; None for what is none: a number, a text, a mapping, a set, a type.

    Raises:
        ParameterError: labels that do not fit.
    """
    given = cast("Any", values)
    if (found := labelled(values, what, names)) is not None:
        return list(found.ordered(names, what))
    if isinstance(values, (str, bytes, bytearray, type)) or getattr(given, "ndim", 1) == 0:
        return None  # an array without axes has a length to ask for, but none to give
    if _has_axes(values):
        return list(_arranged(values, what, names)[0])
    if is_named(values) or is_set(values):
        return None
    if isinstance(values, (Iterator, MappingView)):
        return list(given)
    return list(given) if hasattr(values, "__len__") and hasattr(values, "__getitem__") else None


def listed_names(values: object, what: str) -> list[Any] | None:
    """The same for a sequence of names, where a SymPy symbol stands for its own."""
    return None if (items := listed(values, what)) is None else [*map(as_name, items)]


def named(values: object, what: str = "values") -> dict[Any, Any] | None:
    """Values by name: those of a mapping, or of one row of labelled values; None for what has no names.

    Raises:
        ParameterError: a label comes twice.
    """
    if (found := labelled(values, what)) is not None:
        columns = found.by_label(what)
        if not _has_rows(values):
            return columns
        is_one = all(len(column) == 1 for column in columns.values())
        return {label: column[0] for label, column in columns.items()} if is_one else None
    return _once(values.items(), what) if is_named(values) else None


def is_named(values: object) -> TypeGuard[Mapping[Any, Any]]:
    """Whether it is a mapping, or like one and not registered as such; data with labels are none."""
    if isinstance(values, (Mapping, type)) or _is_table(values):
        return isinstance(values, Mapping)
    return all(callable(getattr(values, method, None)) for method in ("keys", "items", "__getitem__"))


def is_data_set(values: object) -> bool:
    """Whether it is a data set of xarray: what is missing there was lost; a dictionary leaves out what is zero."""
    return isinstance(values, Mapping) and hasattr(values, "data_vars")


def is_set(values: object) -> bool:
    """Whether its order is nobody's choice; keys of a mapping have the order in which they were written."""
    return isinstance(values, ItemsView) or (isinstance(values, Set) and not isinstance(values, MappingView))


def is_several(value: object) -> bool:
    """Whether it holds several values, in order or not."""
    if isinstance(value, (str, bytes, type)):
        return False
    return isinstance(value, (list, tuple, Set, Iterator)) or is_named(value) or getattr(value, "ndim", 0) > 0


def as_scalar(value: Any) -> Any:
    """The number in an array without axes, also in a labelled one; everything else as it is."""
    if isinstance(value, (type, str, bytes)) or getattr(value, "ndim", None) != 0:
        return value
    array = value.values if _is_labelled_array(value) else value
    return array[()] if hasattr(array, "__array__") else value


def _is_labelled_array(values: Any) -> bool:
    """An array of xarray, or one like it.

    Its type is asked: instances have what they hold as attributes, too, such as a column "dims", a coordinate "index".
    """
    return not isinstance(values, (Mapping, type)) and all(
        hasattr(type(values), name) for name in ("dims", "transpose", "values")
    )


def _is_table(values: Any) -> bool:
    """A Series or a table, also of another package than pandas."""
    if isinstance(values, (Mapping, type)) or not hasattr(values, "__array__") or _is_labelled_array(values):
        return False
    return hasattr(type(values), "columns") or not callable(getattr(type(values), "index", len))


def _has_axes(values: Any) -> bool:
    """Whether its axes can have labels."""
    return _is_table(values) or _is_labelled_array(values)


def _has_rows(values: Any) -> bool:
    """Whether it is a table, a labelled array with two axes or an array of records."""
    is_records = bool(getattr(getattr(values, "dtype", None), "names", None))
    return len(getattr(values, "shape", ())) == (1 if is_records else 2)


def _arranged(
    values: Any, what: str, names: Sequence[Any], axis: str = "component"
) -> tuple[Any, tuple[Any, ...] | None]:
    """The array of a table or a labelled array, axes in the order in which functions take them.

    Args:
        values: The table or the array.
        what: What to call it.
        names: The labels that are wanted.
        axis: What the axis is called that has them; it becomes the last one.

    Returns:
        The array, and the labels of its last axis.
    """
    if _is_table(values):
        return _arranged_table(values, what, names)
    return _arranged_dimensions(values, what, names, axis)


def _arranged_table(values: Any, what: str, names: Sequence[Any]) -> tuple[Any, tuple[Any, ...]]:
    """A table whose rows have the names is transposed; one with missing values, which are no NaN, is refused."""
    kinds = values.dtypes if hasattr(type(values), "columns") else [values.dtype]
    can_miss = any(type(getattr(kind, "na_value", None)).__name__ == "NAType" for kind in kinds)
    if can_miss and values.isna().to_numpy().any():
        raise ParameterError(f"{what}: wanted real numbers; got missing values (pandas.NA) among them; drop these rows")
    index = _as_names(values.index) if not callable(getattr(type(values), "index", len)) else ()
    if not hasattr(type(values), "columns"):
        return values.__array__(), index
    columns = _as_names(values.columns)
    if _are(index, names):
        if _are(columns, names):
            raise _two_axes(what, names, "both its rows and its columns")
        return values.__array__().T, index
    if not _have_texts(columns) and _have_texts(index):
        raise _strange(what, f"rows with the labels {_few(index)}", "Transpose the table if they are its columns")
    return values.__array__(), columns


def _arranged_dimensions(values: Any, what: str, names: Sequence[Any], axis: str) -> tuple[Any, tuple[Any, ...] | None]:
    """A labelled array: the known axes in their order, or the others as they stand, and last the one asked for."""
    dims: tuple[Any, ...] = tuple(values.dims)
    labels = _labels_of_dimensions(values)
    roles = {dim: dim for dim in dims if dim in _AXES}
    coordinates = getattr(values, "coords", {})
    for name in (axis, *_AXES):
        owner = coordinates[name].dims if name in coordinates and name not in dims else ()
        if len(owner) == 1 and owner[0] not in roles:
            roles[owner[0]] = name
            labels[owner[0]] = _as_names(coordinates[name].values.tolist())
    holders = [dim for dim in dims if roles.get(dim) == axis or _are(labels.get(dim, ()), names)]
    if len(holders) > 1:
        raise _two_axes(what, names, " and ".join(map(repr, holders)))
    if not holders and dims and dims[-1] not in roles and _have_texts(labels.get(dims[-1], ())):
        holders = [dims[-1]]  # labels that are no names, which are refused by name
    others = [dim for dim in dims if dim not in holders]
    known = sorted((dim for dim in others if dim in roles), key=lambda dim: _AXES.index(roles[dim]))
    unknown = [dim for dim in others if dim not in roles]
    for dim in unknown:
        if _have_texts(labels.get(dim, ())):
            raise _strange(what, f"a dimension {dim!r} with the labels {_few(labels[dim])}", _RENAME)
        if known:
            raise _strange(what, f"a dimension {dim!r} beside {', '.join(map(repr, known))}", _RENAME)
    array = values.transpose(*known, *unknown, *holders).values
    return array, labels.get(holders[0]) if holders else None


_RENAME = f"Rename the dimension to one of {', '.join(_AXES)}"


def _labels_of_dimensions(values: Any) -> dict[Any, tuple[Any, ...]]:
    """The labels of each dimension that has some."""
    coordinates = getattr(values, "coords", {})
    return {dim: _as_names(coordinates[dim].values.tolist()) for dim in values.dims if dim in coordinates}


def _are(labels: Sequence[Any], names: Sequence[Any]) -> bool:
    """Whether labels are the names, in any order."""
    return len(labels) == len(names) > 0 and {*labels} == {*names}


def _have_texts(labels: Sequence[Any]) -> bool:
    return any(isinstance(label, str) for label in labels)


def _two_axes(what: str, names: Sequence[Any], axes: str) -> ParameterError:
    return ParameterError(
        f"{what}: wanted one axis with the labels {_few(names)}; got {axes}. Remove the labels of one, or give an "
        "array without labels, such as .to_numpy() makes."
    )


def _strange(what: str, got: str, hint: str) -> ParameterError:
    return ParameterError(
        f"{what}: wanted axes that are known by name; got {got}. {hint}, or give an array without labels, such as "
        ".to_numpy() makes."
    )


def _few(labels: Sequence[Any]) -> str:
    few = labels if len(labels) <= 9 else (*labels[:6], "...", *labels[-3:])
    return ", ".join(map(str, few))


def sequence(values: object, what: str, wanted: str, example: str) -> tuple[Any, ...]:
    """The items of a sequence that a caller gives, read once.

    Raises:
        ParameterError: it is no sequence.
    """
    if (items := listed(values, what)) is None:
        raise not_a(f"a sequence of {wanted}", values, what, f"write {example}")
    return tuple(items)


def texts(values: object, what: str, wanted: str, example: str) -> tuple[str, ...]:
    """A sequence of names or other texts.

    Raises:
        ParameterError: it is no sequence, or one of its items is no text.
    """
    items = _as_names(sequence(values, what, wanted, example))
    if wrong := [item for item in items if not isinstance(item, str)]:
        raise not_a(f"a sequence of {wanted}", wrong[0], what, f"write {example}")
    return tuple(map(str, items))


def by_name(values: object, what: str, wanted: str, example: str) -> dict[Any, Any]:
    """Values by name that a caller gives.

    Raises:
        ParameterError: they have no names, or one comes twice.
    """
    if (found := named(values, what)) is None:
        raise not_a(f"a mapping from names to {wanted}", values, what, f"write {example}")
    return found
