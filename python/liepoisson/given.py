"""What callers give: values in order, values by name, and the labels that data of other packages carry.

A list, a tuple, an array and a generator, which is read once, have an order; a mapping, a set and a text have none.
Labels are the names of the fields of a named tuple or a structured array, the index of a Series, the columns of a
table, the coordinate of an xarray object along `component` or its last dimension.  Where names are known, labels decide
the order, and those that do not fit are refused; where none are, labels that are texts are refused.  Numbers of rows
are no labels.

pandas, polars and xarray are not imported: their objects are known by what they have.
"""

from __future__ import annotations

from collections.abc import ItemsView, Iterator, Mapping, MappingView, Sequence, Set
from dataclasses import dataclass
from typing import Any, TypeGuard, cast

from liepoisson.errors import ParameterError, ShapeError, did_you_mean
from liepoisson.wrong_values import not_a, shown

_AXES = ("point", "trajectory", "energy", "time", "tangent", "vector", "component")
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
        for k, label in enumerate(self.labels):
            if label in self.labels[:k]:
                raise ParameterError(f"{what}: wanted each label once; {shown(label)} comes twice. Rename or drop one.")
        return dict(zip(self.labels, self.columns, strict=True))

    def ordered(self, names: Sequence[str], what: str) -> Any:
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

    def _in_order(self, names: Sequence[str], what: str) -> tuple[Any, ...]:
        columns = self.by_label(what)
        if not names:
            raise ParameterError(
                f"{what}: wanted values in order, which have no names; got the labels {_few(self.labels)}; give a list "
                "without labels, or an array such as .to_numpy() makes"
            )
        if unknown := [label for label in columns if label not in names]:
            raise ParameterError(
                f"{what}: wanted the labels {_few(names)}; got {_few(unknown)} among them. "
                f"{did_you_mean(unknown[0], names)}Rename or drop it, or give a list without labels."
            )
        if missing := [name for name in names if name not in columns]:
            raise ParameterError(
                f"{what}: wanted the labels {_few(names)}; got none for {_few(missing)}. Give all of them."
            )
        return tuple(columns[name] for name in names)


def labelled(values: object) -> Labelled | None:
    """The values with their labels; None for values that have none."""
    given = cast("Any", values)
    if isinstance(values, type):
        return None
    if isinstance(values, tuple):
        fields = getattr(given, "_fields", None)
        return None if fields is None else Labelled(tuple(fields), tuple(given))
    if fields := getattr(getattr(given, "dtype", None), "names", None):
        record = given[()] if getattr(given, "ndim", 0) == 0 else given
        return Labelled(tuple(fields), tuple(record[name] for name in fields))
    labels = _labels_of_last_axis(given)
    if labels is None or labels == tuple(range(len(labels))):
        return None
    array = without_labels(given)
    return Labelled(labels, tuple(array[k] if array.ndim == 1 else array[..., k] for k in range(len(labels))))


def without_labels(values: Any) -> Any:
    """The array of a table or a labelled array, dimensions in the order in which functions take them."""
    if not _is_labelled_array(values):
        return values.__array__()
    known = [axis for axis in _AXES if axis in values.dims]
    if len(known) == len(values.dims):
        values = values.transpose(*known)
    elif "component" in known:
        values = values.transpose(..., "component")
    return values.values


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
    if (found := labelled(values)) is not None:
        plain = found.ordered(names, what)
        return ordered(list(plain), what) if isinstance(plain, tuple) else plain
    if _is_table(values) or _is_labelled_array(values):
        return without_labels(values)
    if is_named(values) or is_set(values):
        raise ShapeError(
            f"{what}: wanted an array of numbers; got {type(values).__name__}, which has no order; try a list of floats"
        )
    if not isinstance(values, (list, tuple, Iterator, MappingView)):
        return values
    return ordered(list(cast("Any", values)), what, names)


def listed(values: object, what: str = "values", names: Sequence[str] = ()) -> list[Any] | None:
    """The items of a sequence in order; None for what is none: a number, a text, a mapping, a set, a type.

    Raises:
        ParameterError: labels that do not fit.
    """
    given = cast("Any", values)
    if (found := labelled(values)) is not None:
        return list(found.ordered(names, what))
    if isinstance(values, (str, bytes, bytearray, type)) or getattr(given, "ndim", 1) == 0:
        return None  # an array without axes has a length to ask for, but none to give
    if _is_table(values) or _is_labelled_array(values):
        return list(without_labels(values))
    if is_named(values) or is_set(values):
        return None
    if isinstance(values, (Iterator, MappingView)):
        return list(given)
    return list(given) if hasattr(values, "__len__") and hasattr(values, "__getitem__") else None


def named(values: object, what: str = "values") -> dict[Any, Any] | None:
    """Values by name: those of a mapping, or of one row of labelled values; None for what has no names.

    Raises:
        ParameterError: a label comes twice.
    """
    if (found := labelled(values)) is not None:
        columns, rows = found.by_label(what), _n_rows(values)
        if rows is None:
            return columns
        return {label: column[0] for label, column in columns.items()} if rows == 1 else None
    return dict(values.items()) if is_named(values) else None


def is_named(values: object) -> TypeGuard[Mapping[Any, Any]]:
    """Whether it is a mapping, or like one and not registered as such; data with labels are none."""
    if isinstance(values, (Mapping, type)) or _is_table(values):
        return isinstance(values, Mapping)
    return all(callable(getattr(values, method, None)) for method in ("keys", "items", "__getitem__"))


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
    """An array of xarray, or one like it."""
    return not isinstance(values, (Mapping, type)) and all(
        hasattr(values, name) for name in ("dims", "coords", "transpose", "values")
    )


def _is_table(values: Any) -> bool:
    """A Series or a table, also of another package than pandas."""
    if isinstance(values, (Mapping, type)) or not hasattr(values, "__array__"):
        return False
    return hasattr(values, "columns") or not callable(getattr(values, "index", len))


def _n_rows(values: Any) -> int | None:
    """The number of rows of a table, of a labelled array with two axes and of an array of records; else None."""
    shape: tuple[int, ...] = tuple(getattr(values, "shape", ()))
    is_records = bool(getattr(getattr(values, "dtype", None), "names", None))
    rows = 1 if is_records else 2
    return next(iter(shape)) if len(shape) == rows else None


def _labels_of_last_axis(values: Any) -> tuple[Any, ...] | None:
    if _is_labelled_array(values):
        axis = "component" if "component" in values.dims else (*values.dims, None)[len(values.dims) - 1]
        labels = tuple(values.coords[axis].values.tolist()) if axis in values.coords else ()
        return labels if axis == "component" or any(isinstance(label, str) for label in labels) else None
    if not _is_table(values):
        return None
    return tuple(values.columns if hasattr(values, "columns") else values.index)


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
    items = sequence(values, what, wanted, example)
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
