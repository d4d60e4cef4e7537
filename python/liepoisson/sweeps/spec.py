"""What a sweep is: axes, starts, a quantity and a method, as data that determine every number."""

from __future__ import annotations

import hashlib
import json
import math
import re
from collections.abc import Callable, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from importlib import import_module
from typing import Any, Literal, TypeAlias, cast

import numpy as np

from liepoisson import __version__
from liepoisson.errors import ParameterError, ShapeError, SystemFileError, UnknownNameError, did_you_mean
from liepoisson.formula.parameters import names_of_places
from liepoisson.formula.scalars import as_array, as_count, as_number, as_seed, as_time
from liepoisson.formula.toml_text import parse_toml
from liepoisson.indicators.verdict import Rule, as_rule, rule_of
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.inputs.given import as_scalar, listed, named
from liepoisson.inputs.names import check_name, check_title
from liepoisson.inputs.refusals import check_choice, not_a, shown
from liepoisson.model.equations_of_motion import EquationsOfMotion
from liepoisson.model.system_file_reader import read_equations
from liepoisson.noise.noisy_system import NoisySystem
from liepoisson.numeric.method.taylor import Taylor
from liepoisson.numeric.methods import MethodChoice, as_choice, choice_of, method_record
from liepoisson.numeric.sampling import ENSEMBLES, unknown_ensemble
from liepoisson.portable import elementary
from liepoisson.sweeps.identity import function_record, system_record, system_tables

Value: TypeAlias = "float | int | str | Fraction | Sequence[float | int | str | Fraction]"
"""A number, a formula in the names of the axes, or a list of them."""

DEFAULT_METHOD = Taylor(tol=1e-9, precision="mixed")
"""For tops. Largest error of 512 orbits of the twisted Kovalevskaya top at T = 20: 3.4e-7 (median 6e-9)."""
DEFAULT_GENERAL = Taylor(tol=1e-9)
"""For systems that are no tops, which have no kernel of mixed precision."""

QUANTITIES = ("exponent", "chaotic_fraction")
DEFAULT_ENSEMBLE = "unit-vectors"
_MOST_POINTS = 2**24
MOST_BYTES = 2**34
"""Memory that the results of a grid may take: 9 bytes for each orbit of each point, which are in memory together.

Errors of exponents with noise, 8 bytes each, come on top."""
CASIMIR = re.compile(r"C[1-9][0-9]?")
"""Names of Casimirs."""
COMPONENT = re.compile(r"(.*?)_?([1-9][0-9]?)")
"""Names of components: a2 or a_2."""
_DOTTED = re.compile(r"[^\W\d]\w*(\.[^\W\d]\w*)*:[^\W\d]\w*")


@explains_its_methods
@dataclass(frozen=True)
class Axis:
    """A named list of values over which a sweep runs.

    Example:
        >>> lp.sweeps.Axis.logarithmic("energy", 0.01, 1, 3).values
        (0.01, 0.1, 1.0)

    Args:
        name: A parameter of the system ("epsilon"), a component of one ("a1", "I3"), "energy" or a Casimir ("C1"),
            which it sets; or any other name that formulas of the sweep use.
        values: Increasing or decreasing, shape (point,).
        label: How figures call it; mathematical text in dollar signs is set as such.

    Raises:
        ParameterError: the name is none that a user may choose (`liepoisson.inputs.names`), or the values are not
            finite and strictly monotonic.
    """

    name: str
    values: tuple[float, ...]
    label: str | None = None

    def __post_init__(self) -> None:
        check_name(self.name, "the name of an axis")
        if self.label is not None:
            check_title(self.label, f"axis {self.name}: label")
        try:
            given = listed(self.values, f"axis {self.name}")
            values = as_array(self.values if given is None else given, f"axis {self.name}")
        except ShapeError as error:
            raise ParameterError(f"{error}.") from error
        steps = np.diff(values) if values.ndim == 1 else np.zeros(1)
        monotonic = np.all(steps > 0) or np.all(steps < 0)
        if values.ndim != 1 or not values.size or not np.isfinite(values).all() or not monotonic:
            raise ParameterError(
                f"axis {self.name}: wanted finite values, increasing or decreasing; got {shown(self.values)}. "
                "Sort them and remove equal ones."
            )
        object.__setattr__(self, "values", tuple(values.tolist()))

    @classmethod
    def linear(cls, name: str, start: float, stop: float, count: int, label: str | None = None) -> Axis:
        """`count` values at equal distances from start to stop, both included."""
        return cls(name, _spaced(name, start, stop, count, np.linspace), label)

    @classmethod
    def logarithmic(cls, name: str, start: float, stop: float, count: int, label: str | None = None) -> Axis:
        """`count` values at equal ratios from start to stop, both positive and included."""
        least, most = _ends(name, start, stop)
        if not (least > 0 and most > 0):
            raise ParameterError(f"axis {name}: a logarithmic axis runs between positive values; got {start}, {stop}.")
        return cls(name, _spaced(name, start, stop, count, elementary.geomspace), label)


def _spaced(name: str, start: float, stop: float, count: int, space: Callable[..., Any]) -> tuple[float, ...]:
    least, most = _ends(name, start, stop)
    n = as_count(count, f"axis {name}: count", least=1, most=_MOST_POINTS, hint="try 21")
    return tuple(space(least, most, n).tolist())


def _ends(name: str, start: float, stop: float) -> tuple[float, float]:
    ends = as_number(start, f"axis {name}: from", "a number"), as_number(stop, f"axis {name}: to", "a number")
    if not (math.isfinite(ends[0]) and math.isfinite(ends[1])):
        raise ParameterError(f"axis {name}: wanted finite ends; got {shown(start)}, {shown(stop)}. Correct them.")
    return ends


@explains_its_methods
@dataclass(frozen=True)
class Starts:
    r"""Where the orbits of a point of the grid start, from the same random numbers at every point.

    Member k is member k of an ensemble of `sample_states`.  Where an energy or Casimirs are given, it is moved to the
    nearest state that has them (Newton steps of least norm), so that it depends smoothly on the point; the measure
    is then not the Liouville measure.  With `sampling="liouville"` all Casimirs must be given, the states are those of
    `Leaf.sample`, with the same seed at every point, and there is no ensemble.

    Example:
        >>> starts = lp.sweeps.Starts(energy="e", casimirs={"C1": 0, "C2": 1})
        >>> lp.sweep(system="heavy-top", starts=starts, axes={"e": [0, 1, 2]}, n_starts=4, t_end=20).held
        ('of the starts: C1 = 0, C2 = 1',)

    Args:
        ensemble: "unit-vectors", "cube" or "gaussian".
        energy: Value of the Hamiltonian: a number, or a formula in the names of the axes.
        casimirs: Values of Casimirs by name, likewise: {"C1": 1, "C2": "c"}; what is not named is not prescribed.
        sampling: "projection" or "liouville".

    Raises:
        UnknownNameError: no such ensemble.
        ParameterError: no such kind of sampling, another ensemble than the default beside "liouville", or a name that
            is none of a Casimir.
    """

    ensemble: str = DEFAULT_ENSEMBLE
    energy: Value | None = None
    casimirs: Mapping[str, Value] = field(default_factory=dict[str, Value], hash=False)
    sampling: Literal["projection", "liouville"] = "projection"

    def __post_init__(self) -> None:
        if not isinstance(self.ensemble, str) or self.ensemble not in ENSEMBLES:  # pyright: ignore[reportUnnecessaryIsInstance]
            raise unknown_ensemble(self.ensemble)
        check_choice(self.sampling, "sampling", ("projection", "liouville"))
        if self.sampling == "liouville" and self.ensemble != DEFAULT_ENSEMBLE:
            raise ParameterError(
                f'ensemble={self.ensemble!r} and sampling="liouville" exclude each other: on a leaf states follow the '
                "Liouville measure. Leave one out."
            )
        if (casimirs := named(self.casimirs, "casimirs")) is None:
            raise ParameterError(f'casimirs: wanted a mapping, such as {{"C1": 1}}; got {shown(self.casimirs)}.')
        if self.energy is not None:
            _check_value(self.energy, "energy", is_one=True)
        for name, value in casimirs.items():
            if not (isinstance(name, str) and CASIMIR.fullmatch(name)):  # pyright: ignore[reportUnnecessaryIsInstance]
                hint = did_you_mean(str(name), ("ensemble", "energy", "sampling")).strip() or "Correct the name."
                raise ParameterError(
                    f"starts: wanted ensemble, energy, sampling, C1, C2, ...; got {shown(name)}. {hint}"
                )
            _check_value(value, name, is_one=True)
        object.__setattr__(self, "casimirs", _all_owned(casimirs))


@explains_its_methods
@dataclass(frozen=True)
class Refinement:
    """Where a sweep looks closer: cells whose corners differ are halved, level by level.

    Example:
        >>> closer = lp.sweeps.Refinement(levels=2, difference=0.02)
        >>> found = lp.sweep(system="twisted-top", parameters={"I": [2, 2, 1], "a": [-1, 0, 0], "b": [0, 0, 0]},
        ...     axes={"epsilon": [0, 0.5, 1]}, n_starts=4, t_end=50, refine=closer)
        >>> np.sort(found.points[:, 0]).tolist()
        [0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0]

    Args:
        levels: How often a cell may be halved.
        difference: Least difference of the statistic (mean exponent, or chaotic fraction) between corners.

    Raises:
        ParameterError: `levels` is not a whole number from 1 to 12, or `difference` is not positive.
    """

    levels: int
    difference: float

    def __post_init__(self) -> None:
        as_count(self.levels, "refine levels", least=1, most=12, hint="try 2")
        if not as_number(self.difference, "refine difference", "a positive number") > 0:
            raise not_a("a positive number", self.difference, "refine difference", "try 0.1")


def starts_of(given: Mapping[str, Any]) -> Starts:
    """Starts of plain values by name, with Casimirs among them or all in `casimirs`."""
    given = named(given, "starts") or {}
    known = {key: given[key] for key in ("ensemble", "energy", "sampling") if key in given}
    beside = {key: value for key, value in given.items() if key not in known and key != "casimirs"}
    if beside and given.get("casimirs"):
        raise ParameterError(f"starts: wanted {', '.join(map(str, beside))} beside energy, or all in casimirs.")
    return Starts(**known, casimirs=given.get("casimirs") or beside)


def refinement_of(given: Mapping[str, Any]) -> Refinement:
    """A refinement of plain values by name."""
    if {*given} != {"levels", "difference"}:
        raise ParameterError(f"refine: wanted levels and difference; got {', '.join(map(str, given)) or 'neither'}.")
    return Refinement(**given)


@explains_its_methods
@dataclass(frozen=True)
class SweepSpec:
    """Everything that determines the numbers of a sweep.

    Example:
        >>> energies = lp.sweeps.Axis.linear("energy", 0, 2, 3)
        >>> spec = lp.sweeps.SweepSpec("kovalevskaya", axes=(energies,), n_starts=4, t_end=50)
        >>> lp.sweep(spec)
        <Sweep over energy (3): 3 points, 4 orbits each, t = 50>

    Args:
        system: Name of the catalog, path of a system file, tables of one, a system without free parameters, or a
            function of parameters (by keyword) that returns a system, such as `lp.Top.kovalevskaya`.  Each of the last
            four may be with noise, as `lp.stochastic.NoisySystem` is, at all points.
        axes: One or two.
        parameters: Values of the system's other parameters: numbers, formulas in the names of the axes, lists of them,
            such as `{"a": ["cos(phi)", "sin(phi)", 0]}`.
        starts: Where the orbits start.
        n_starts: Orbits at each point.
        t_end: Time of each orbit, in units of the system's own time.  It has no default, as no time suits all systems:
            `lp.orbits.time_scale` has the natural unit of time of an orbit, of which some 1,000 are a long run.
        quantity: "exponent"; "chaotic_fraction", where each orbit is judged by `lp.decide`; the dotted name
            "package.module:function", or a function `f(system, starts, *, t_end, method, seed, threads)` that returns a
            number for each start, shape (start,).  With noise there are no verdicts, exponents are those of
            `lp.stochastic.noisy_exponents`, and a function is given the `NoisySystem` and all starts in their order,
            NaN where there is none.
        rule: Thresholds of the verdicts for "chaotic_fraction", and for no other; by default those of `lp.decide`.
        method: How orbits are integrated; by default `Taylor(tol=1e-9, precision="mixed")` for tops, in double
            precision for other systems; for "chaotic_fraction" that of `lp.decide`.  Exponents with noise need
            `Splitting`, whose step has no default.
        seed: Draws starts, tangent vectors and the paths of noise.  Start, tangent vector and path k are the same at
            every point, so that a point is what one run gives with its starts and this seed, bit for bit.
        refine: Where to look closer, or None.
        name: How the sweep is called.

    Raises:
        ParameterError: a value outside its range; what a formula or a system says wrong comes from `sweep`.
    """

    system: Any = field(hash=False)
    axes: tuple[Axis, ...]
    t_end: float
    parameters: Mapping[str, Value] = field(default_factory=dict[str, Value], hash=False)
    starts: Starts = field(default_factory=Starts)
    n_starts: int = 64
    quantity: str | Callable[..., Any] = "exponent"
    rule: Rule | None = None
    method: MethodChoice | None = None
    seed: int = 0
    refine: Refinement | None = None
    name: str | None = None

    def __post_init__(self) -> None:
        # Copies: what a caller does to its lists and arrays later is not what was asked.
        if (axes := listed(self.axes, "axes")) is not None:
            object.__setattr__(self, "axes", tuple(axes))
        if (parameters := named(self.parameters, "parameters")) is not None:
            object.__setattr__(self, "parameters", _all_owned(parameters))
        self._check_types()
        if self.name is not None:
            check_title(self.name, "the name of a sweep")
        if isinstance(self.system, Mapping):
            object.__setattr__(self, "system", deepcopy(cast("Any", self.system)))
        if len(self.axes) not in (1, 2) or not all(isinstance(axis, Axis) for axis in self.axes):  # pyright: ignore[reportUnnecessaryIsInstance]
            raise ParameterError(
                f"axes: wanted one or two of Axis; got {shown(self.axes)}. Write "
                "for example a mapping of names to values, or (Axis.linear(...),)."
            )
        if len({axis.name for axis in self.axes}) != len(self.axes):
            raise ParameterError(f"axes: wanted two different names; got {self.axes[0].name!r} twice.")
        if math.prod(self.shape) > _MOST_POINTS:
            raise ParameterError(f"axes: wanted at most {_MOST_POINTS} points; got {' x '.join(map(str, self.shape))}.")
        n = as_count(self.n_starts, "n_starts", least=1, most=2**31, hint="try 64")
        if (size := 9 * n * math.prod(self.shape)) > MOST_BYTES:
            raise ParameterError(
                f"a sweep must have results of at most {MOST_BYTES / 2**30:g} GiB; a grid of "
                f"{' x '.join(map(str, self.shape))} with n_starts = {n} takes {size / 2**30:.4g} GiB. Take fewer "
                "orbits, or parts of the grid."
            )
        as_seed(self.seed)
        as_time(self.t_end, "t_end", example=1000)
        as_rule(self.rule)
        if self.rule is not None and not self.is_verdict:
            raise ParameterError(
                f'rule belongs to quantity="chaotic_fraction"; got quantity={shown(self.quantity)}. Leave it out.'
            )
        object.__setattr__(self, "method", as_choice(self.method))
        self._check_quantity()

    def _check_types(self) -> None:
        """What the annotations say, for callers without a type checker."""
        wanted: dict[str, tuple[Any, str]] = {
            "axes": (Sequence, "a sequence of one or two of Axis, or a mapping of names to values"),
            "parameters": (Mapping, 'a mapping of names to values, such as {"epsilon": 1}'),
            "starts": (Starts, 'Starts or a mapping, such as {"C1": 1}'),
            "refine": ((Refinement, type(None)), 'Refinement or a mapping, such as {"levels": 2, "difference": 0.1}'),
            "name": ((str, type(None)), "a text"),
        }
        for key, (kind, what) in wanted.items():
            given = getattr(self, key)
            if not isinstance(given, kind):
                raise ParameterError(f"{key}: wanted {what}; got {shown(given)}. Correct it.")
        for name, value in self.parameters.items():
            _check_value(value, str(name))

    def _check_quantity(self) -> None:
        given, wanted = self.quantity, f"one of {', '.join(QUANTITIES)}, a function, or package.module:function"
        if isinstance(given, str) and given not in QUANTITIES and not _DOTTED.fullmatch(given):
            hint = did_you_mean(given, QUANTITIES).strip() or "Correct it."
            raise UnknownNameError(f"quantity: wanted {wanted}; got {shown(given)}. {hint}")
        if not isinstance(given, str) and not callable(given):  # pyright: ignore[reportUnnecessaryComparison]
            raise ParameterError(f"quantity: wanted {wanted}; got {shown(given)}")

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values of each axis."""
        return tuple(len(axis.values) for axis in self.axes)

    @property
    def is_exponent(self) -> bool:
        """Whether the values are finite-time exponents."""
        return self.quantity == "exponent"

    @property
    def is_verdict(self) -> bool:
        """Whether the values are verdicts: -1 regular, 0 undecided, +1 chaotic."""
        return self.quantity == "chaotic_fraction"

    def record(self) -> dict[str, Any]:
        """The spec as plain data that JSON can write; system files by their tables, functions by name and digest."""
        return {
            "system": self._system_record,
            "axes": [{"name": axis.name, "values": list(axis.values)} for axis in self.axes],
            "parameters": _plain(self.parameters),
            "starts": _plain(vars(self.starts)),
            "n_starts": int(self.n_starts),
            "t_end": float(self.t_end),
            "quantity": _plain(self.quantity),
            "rule": _plain(vars(as_rule(self.rule))) if self.is_verdict else None,
            "method": None if (method := as_choice(self.method)) is None else method_record(method),
            "seed": int(self.seed),
            "refine": None if self.refine is None else {**vars(self.refine), "by": self._refined_by()},
            "version": __version__,
        }

    def description(self) -> dict[str, Any]:
        """The record with what changes no number: the names of the sweep and its axes, and the system as a text."""
        labels = [axis.label for axis in self.axes]
        return {"name": self.name, "labels": labels, "system_file": _file_text(self.system)}

    @classmethod
    def of_record(cls, record: Mapping[str, Any], description: Mapping[str, Any] | None = None) -> SweepSpec:
        """The spec that `record` and `description` have written; a function of the caller no record keeps."""
        said: dict[str, Any] = {
            "name": None,
            "labels": [None] * len(record["axes"]),
            "system_file": None,
            **(description or {}),
        }
        system = record["system"]
        if said["system_file"] is not None:
            system = read_equations(parse_toml(said["system_file"], "the system of the sweep"), noise=True).system()
        elif isinstance(system, Mapping) and "function" in system:
            system = _own_function("system", cast("Mapping[str, Any]", system))
        quantity, rule, method, refine = (record[name] for name in ("quantity", "rule", "method", "refine"))
        if isinstance(quantity, Mapping):
            quantity = _own_function("quantity", cast("Mapping[str, Any]", quantity))
        return cls(
            system=system,
            axes=tuple(
                Axis(axis["name"], tuple(axis["values"]), label)
                for axis, label in zip(record["axes"], said["labels"], strict=True)
            ),
            t_end=record["t_end"],
            parameters=record["parameters"],
            starts=Starts(**record["starts"]),
            n_starts=record["n_starts"],
            quantity=quantity,
            rule=None if rule is None else rule_of(rule),
            method=None if method is None else choice_of(method),
            seed=record["seed"],
            refine=None if refine is None else Refinement(refine["levels"], refine["difference"]),
            name=said["name"],
        )

    def fingerprint(self) -> str:
        """Digest of everything that determines the numbers, the version of the package included.

        Raises:
            ParameterError: a function depends on something of which no digest is known.
        """
        for key, value in (("system", self._system_record), ("quantity", _plain(self.quantity))):
            if isinstance(value, dict) and "unknown" in value:
                raise ParameterError(
                    f"{key}: what the function {value['function']} computes cannot be recorded, as "
                    f"{value['unknown']}. Name a module function, or leave out the store."
                )
        return hashlib.sha256(json.dumps(self.record(), sort_keys=True).encode()).hexdigest()

    @cached_property
    def _system_record(self) -> Any:
        """Read once: a file that is changed while the sweep runs does not change what the sweep is."""
        return _plain(system_tables(self.system))

    def _refined_by(self) -> list[Any]:
        return ["chaotic_fraction"] if self.is_verdict else ["mean"]

    def held(self, *, noise: bool = False) -> list[str]:
        """What is the same at all points, in words."""
        fixed = [line for name, value in self.parameters.items() for line in self._fixed(name, value)]
        prescribed = {**self.starts.casimirs, **({} if self.starts.energy is None else {"H": self.starts.energy})}
        held = [f"{name} = {_text(value)}" for name, value in prescribed.items() if not _varies(value, self.axes)]
        lines = [f"parameters: {', '.join(fixed)}"] if fixed else []
        if prescribed or self._axes_of_starts():
            lines.append(f"of the starts: {', '.join(held) or 'nothing but what the axes say'}")
        else:
            lines.append(f"the starts: trajectory k of {self.starts.ensemble!r} is the same state at every point")
        if any(axis.name == "epsilon" for axis in self.axes) or _varies(self.parameters.get("epsilon", 0), self.axes):
            lines.append("epsilon by itself is a scale: what varies is epsilon |beta|, at the |beta| of the starts")
        if noise:
            lines.append("the noise: trajectory k follows the same path at every point")
        return lines

    def formulas(self) -> list[str]:
        """What follows from the axes by a formula, such as "I2 = 1 + r"."""
        items: list[tuple[str, object]] = [*self.starts.casimirs.items(), ("H", self.starts.energy)]
        for name, value in self.parameters.items():
            if isinstance(value, Sequence) and not isinstance(value, str):
                items += [(f"{name}{k}", item) for k, item in enumerate(value, 1)]
            else:
                items.append((name, value))
        return [f"{name} = {item}" for name, item in items if isinstance(item, str) and _varies(item, self.axes)]

    def _axes_of_starts(self) -> set[str]:
        """Axes that set the energy or a Casimir."""
        return {axis.name for axis in self.axes if axis.name == "energy" or CASIMIR.fullmatch(axis.name)}

    def _fixed(self, name: str, value: Value) -> list[str]:
        """A parameter in words, or its components that no axis changes."""
        found = [COMPONENT.fullmatch(axis.name) for axis in self.axes]
        set_by_axis = {int(match[2]) for match in found if match is not None and match[1] == name}
        if not isinstance(value, Sequence) or isinstance(value, str):
            return [] if _varies(value, self.axes) else [f"{name} = {_text(value)}"]
        same = [k for k, item in enumerate(value, 1) if k not in set_by_axis and not _varies(item, self.axes)]
        if len(same) == len(value):
            return [f"{name} = {_text(value)}"]
        return [f"{name}{k} = {_text(value[k - 1])}" for k in same]


def _check_value(value: Any, name: str, *, is_one: bool = False) -> None:
    """Refuse what is no number, no formula, and no list of them, and numbers that no double holds."""
    if isinstance(value, (Sequence, np.ndarray)) and not isinstance(value, (str, bytes)) and not is_one:
        if not len(cast("Sequence[Any]", value)):
            raise ParameterError(f"{name}: wanted a number, a formula or a list of them; got an empty list.")
        for k, item in enumerate(cast("Sequence[Any]", value)):
            _check_value(item, f"{name}{k + 1}")
    elif not isinstance(value, str):
        what = "a number or a formula" if is_one else "a number, a formula or a list of them"
        number = as_number(value, name, f"{what}, each within the range of a double")
        if not math.isfinite(number):
            raise ParameterError(f"{name}: wanted finite numbers; got {shown(value)}. Correct it.")


def _all_owned(values: Mapping[Any, Any]) -> dict[Any, Any]:
    return {name: _owned(value, str(name)) for name, value in values.items()}


def _owned(value: Any, name: str) -> Any:
    """A copy in plain numbers and tuples: an array would be recorded by its text, which has eight digits."""
    value = as_scalar(value)
    if (items := listed(value, name, names_of_places(value, name))) is not None:
        return tuple(_owned(item, name) for item in items)
    return cast("Any", value).item() if isinstance(value, np.generic) else value


def _varies(value: Value, axes: Sequence[Axis]) -> bool:
    from liepoisson.formula.grammar import names_in, parse

    items = value if isinstance(value, Sequence) and not isinstance(value, str) else [value]
    names = {name for item in items if isinstance(item, str) for name in names_in(parse(item))}
    return bool(names & {axis.name for axis in axes})


def _text(value: Value) -> str:
    if isinstance(value, Sequence) and not isinstance(value, str):
        return f"({', '.join(map(_text, value))})"
    return f"{float(value):g}" if isinstance(value, (float, Fraction)) else str(value)


def _own_function(what: str, record: Mapping[str, Any]) -> Any:
    """A function of this package by its name; no record of a file makes another one run."""
    module, _, name = str(record["function"]).partition(":")
    found: Any = None
    if module.split(".")[0] == __name__.split(".")[0]:
        found = import_module(module)
        for part in name.split("."):
            found = getattr(found, part, None)
    # a module has the names that it imports, too: os.abort is none of its functions
    if not callable(found) or (getattr(found, "__module__", ""), getattr(found, "__qualname__", "")) != (module, name):
        raise ParameterError(
            f"{what}: it was the function {record['function']!s:.80} of the caller, which no file keeps. Call sweep "
            "with it and this store."
        )
    return found


def _plain(value: Any) -> Any:
    """Plain data that stand for a value in a fingerprint: the same in every process."""
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in cast("Mapping[Any, Any]", value).items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in cast("Sequence[Any]", value)]
    if callable(value):
        return cast("Any", function_record(value))
    if isinstance(value, (EquationsOfMotion, NoisySystem)):
        return cast("Any", system_record(value))
    return str(value)


def _file_text(system: Any) -> str | None:
    """The text of a file of a system that was given as such; None where there is none."""
    if not isinstance(system, NoisySystem):
        return getattr(system, "text", None)
    try:
        return system.file_text()
    except SystemFileError:
        return None
