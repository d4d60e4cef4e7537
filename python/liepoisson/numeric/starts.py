"""States and times that a caller gives, as arrays of the shapes that runs take."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, TypeAlias, cast

import numpy as np
from numpy.typing import ArrayLike

from liepoisson.errors import ParameterError, ShapeError, did_you_mean
from liepoisson.formula.scalars import as_array, as_time
from liepoisson.inputs.arrays import Array, check_shape
from liepoisson.inputs.given import is_data_set, is_named, is_several, labelled, listed, named
from liepoisson.inputs.refusals import shown
from liepoisson.numeric.systems import as_field, component_names, vector_length, without_value
from liepoisson.portable import elementary

StartsLike: TypeAlias = "ArrayLike | Mapping[str, ArrayLike] | Sequence[Mapping[str, ArrayLike]]"
"""States as arrays, or by the names of vectors and components, the others being zero."""


def as_starts(system: Any, starts: StartsLike, n_components: int) -> Array:
    """A copy of the starts of a run, shape (trajectory, component).

    Raises:
        ParameterError: A name is none of the system's, no start is finite, or the Hamiltonian or a given integral is no
            real number at one.
        ShapeError: They have another shape.
    """
    names = component_names(system, n_components)
    states = as_states(given_starts(system, starts), n_components, names=names, some_may_fail=True)
    for name, lost in without_value(system, states).items():
        if lost.any():
            k = int(lost.argmax())
            raise ParameterError(
                f"starts: wanted states at which the invariants of {system.name} are real numbers; {name} is none at "
                f"{dict(zip(names, states[k].tolist(), strict=True))!s:.200} (trajectory {k}): see its logarithms and "
                "roots. Start elsewhere, or write the real function that is meant, such as log(x^2)/2."
            )
    return states


def given_starts(system: Any, starts: StartsLike, name: str = "starts") -> Array:
    """A copy of states as they were given, those that were given by name with all their components.

    `{"l": (1, 0, 0), "beta3": "1/3"}` is one state, and many if a component has many values or a vector many rows;
    a list of such mappings is many.  Of data with labels, such as a table or a data set, each component must have one.

    Raises:
        ParameterError: A name is none of the system's, or a component is given twice.
        ShapeError: A vector has another number of components, or numbers of trajectories differ.
    """
    names = component_names(system, as_field(system).n_components)
    if (found := labelled(starts, name, names)) is not None:
        if len(dims := getattr(starts, "dims", ())) > 2:
            raise ShapeError(
                f"{name} must have shape ({len(names)},) or (trajectory, {len(names)}); got the dimensions "
                f"{', '.join(map(str, dims))}. Choose one place of the others, such as .isel(time=-1)."
            )
        return states_by_name(system, found.by_label(name), name, whole=True)
    if is_named(starts):
        return states_by_name(system, named(starts, name) or {}, name, whole=is_data_set(starts))
    rows = listed(starts, name) if isinstance(starts, (list, tuple, Iterator)) else None
    if rows and all(is_named(row) or labelled(row, name, names) for row in rows):
        return np.concatenate([np.atleast_2d(given_starts(system, row, name)) for row in rows])
    return as_array(cast("Any", starts if rows is None else rows), name)


def states_by_name(
    system: Any, given: Mapping[str, Any], what: str, *, one: bool = False, whole: bool = False
) -> Array:
    """States from vectors and components by name, the others being zero: shape (component,) or (trajectory, component).

    Raises:
        ParameterError: A name is none of the system's, a component is given twice, or one is missing where the whole
            state is wanted.
        ShapeError: A vector has another number of components, or numbers of trajectories differ.
    """
    places = component_places(system)
    read = dict[str, Array]()
    seen = dict[int, str]()
    for name, numbers in given.items():
        if name not in places:
            raise ParameterError(
                f"{what} must name a field or a component; got {shown(name)}. {_meant(name, numbers, places)}"
                f"Known: {', '.join(places)}."
            )
        place, values = places[name], as_array(numbers, f"{what} {name}")
        if len(place) == 1 and (not one or values.ndim == 0):
            values = values[..., None]
        if values.shape[-1:] != (len(place),) or values.ndim > (1 if one else 2):
            got = f"{values.shape[-1]}" if values.ndim == 1 else f"shape {values.shape}"
            raise ShapeError(f"{what} {name} must have {len(place)} numbers; got {got}.")
        if twice := seen.keys() & {*place}:
            raise ParameterError(
                f"{what} must give each component once; {name} comes twice, also in {seen[min(twice)]}. Remove one."
            )
        seen |= dict.fromkeys(place, name)
        read[name] = values
    if whole and len(seen) < (n := max(place.stop for place in places.values())):
        missing = [name for name, place in places.items() if len(place) == 1 and place[0] not in seen]
        raise ParameterError(
            f"{what} must have all {n} components; got no values for {', '.join(missing)}. Give all of them, or a "
            "dictionary, in which the others are zero."
        )
    counts = {name: len(values) for name, values in read.items() if values.ndim == 2}
    many = tuple({*counts.values()})
    if len(many) > 1:
        words = ", ".join(f"{name} {n}" for name, n in counts.items())
        raise ShapeError(f"{what} must have one number of trajectories; got {words}. Make them equal.")
    states = np.zeros((*many, max(place.stop for place in places.values())))
    for name, values in read.items():
        states[..., list(places[name])] = values
    return states


def _meant(name: object, numbers: Any, places: Mapping[str, range]) -> str:
    """The question that begins a hint, about a name that takes such numbers: one number is that of a component."""
    hint = did_you_mean(name, places)
    if is_several(numbers):
        return hint
    for field, place in places.items():
        if len(place) > 1 and hint == did_you_mean(field, [field]):
            components = [known for known, of in places.items() if len(of) == 1 and of[0] in place]
            return f"Did you mean one of {', '.join(components)}? "
    return hint


def component_places(system: Any) -> dict[str, range]:
    """Where the vectors and the components of a state are, by name."""
    names = component_names(system, as_field(system).n_components)
    if getattr(system, "clock", None) is not None:  # time and its momentum come after the vectors
        vectors: tuple[str, ...] = tuple(system.bracket.vectors)
        size = vector_length(system, len(names))
    else:
        vectors, size = tuple(getattr(system, "parts_of_state", ())), vector_length(system, len(names))
        if len(vectors) * size != len(names) or vectors == names:
            vectors = ()
    places = {vector: range(k * size, (k + 1) * size) for k, vector in enumerate(vectors)}
    return places | {name: range(k, k + 1) for k, name in enumerate(names)}


def as_states(
    starts: ArrayLike,
    n_components: int,
    name: str = "starts",
    *,
    names: Sequence[str] = (),
    some_may_fail: bool = False,
) -> Array:
    """A copy of states as an array of shape (trajectory, component); one state may come without the first axis.

    Where some may fail, rows that are not finite are kept beside good ones: their trajectories end at once, with an
    outcome, and the others run.
    """
    states = as_array(starts, name, names)
    if states.ndim not in (1, 2) or states.shape[-1] != n_components:
        hint = "Transpose it?" if states.ndim == 2 and states.shape[0] == n_components else _component_hint(names)
        check_shape(False, name, f"({n_components},) or (trajectory, {n_components})", states, hint)
    states = np.atleast_2d(states)
    bad = ~np.isfinite(states).all(axis=1)
    if bad.any() and (bad.all() or not some_may_fail):
        raise ParameterError(
            f"{name}: wanted finite numbers; trajectory {int(np.argmax(bad))} of {len(states)} has a NaN or an "
            f"infinity ({int(bad.sum())} such in all); drop these rows"
        )
    return states


def _component_hint(names: Sequence[str]) -> str:
    few = names if len(names) <= 9 else (*names[:6], "...", *names[-3:])
    return f"The components are {', '.join(few)}." if names else ""


def as_times(times: ArrayLike, name: str, *, least: int) -> Array:
    """A copy of finite, strictly monotone times, at least `least` of them."""
    times = np.atleast_1d(as_values(times, name))
    fits = times.ndim == 1 and len(times) >= least
    check_shape(fits, name, f"(time,) with {least} or more times", times)
    steps = np.diff(times)
    if not np.isfinite(times).all() or not (np.all(steps > 0) or np.all(steps < 0)):
        raise ParameterError(
            f"{name}: wanted finite, strictly increasing or strictly decreasing times; got {_abridged(times)}; "
            "sort them and drop repeated ones"
        )
    return times


def as_forward_times(t_end: float | None, times: ArrayLike | None, n: int) -> Array:
    """A copy of positive increasing times; or n times spaced evenly in the logarithm, from `t_end`/1000 to `t_end`.

    Raises:
        ParameterError: both or neither are given, or they are no such times.
    """
    if (t_end is None) == (times is None):
        raise ParameterError("wanted either t_end or times; got both or neither; try t_end=1000")
    if times is None:
        end = as_time(t_end, "t_end", example=1000)
        wanted = elementary.geomspace(end / 1000.0, end, n)
        wanted[-1] = end
        return wanted
    wanted = as_times(times, "times", least=1)
    if wanted[0] <= 0.0 or wanted[-1] < wanted[0]:
        raise ParameterError(
            f"times: wanted positive increasing times; got {wanted[0]} to {wanted[-1]}; time starts at 0"
        )
    return wanted


def as_values(values: ArrayLike, name: str) -> Array:
    """A copy of numbers without names, such as times, one or many.

    Raises:
        ShapeError: It is no array of numbers, or a text.
    """
    if isinstance(values, (str, bytes)):
        raise ShapeError(f"{name}: wanted an array of numbers; got the text {values!r:.60}; give a list of numbers")
    return as_array(values, name)


def _abridged(values: Sequence[float] | Array) -> str:
    return np.array2string(np.asarray(values), threshold=6, edgeitems=3)
