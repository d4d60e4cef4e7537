"""Sweep files: a sweep in TOML.

    name = "twist"
    system = "twisted-top"                   # a name of the catalog, a system file, or tables [system.bracket], ...
    quantity = "chaotic_fraction"            # or "exponent"; "package.module:function" only if code is allowed
    n_starts = 64                            # orbits at each point
    t_end = 1000                             # has no default: see liepoisson.orbits.time_scale
    seed = 1
    [parameters]                             # numbers, formulas in the names of the axes, lists of them
    I = [2, 2, 1]
    a = [-1, 0, 0]
    b = [0, 0, 0]
    [[axes]]
    name = "epsilon"                         # a parameter, a component such as "a1", "energy", "C1", or a new name
    from = 0
    to = 1
    count = 21                               # or values = [...]; spacing = "logarithmic"
    label = "twist"
    [starts]
    ensemble = "unit-vectors"
    energy = "1/2"                           # and Casimirs: C1 = 1, C2 = "c"; sampling = "liouville"
    [method]
    name = "taylor"
    tol = 1e-9
    precision = "mixed"
    [refine]
    levels = 2
    difference = 0.1
    [rule]                                   # thresholds of verdicts, see liepoisson.chaos.Rule
    averages = 4e-3

A path of a system file is looked for beside the sweep file.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from fractions import Fraction
from pathlib import Path
from typing import Any, cast

from liepoisson.formula.toml_text import TomlReader, TomlText, read_toml
from liepoisson.indicators.verdict import Rule
from liepoisson.inputs.refusals import shown
from liepoisson.numeric.method.method import Method
from liepoisson.numeric.methods import CHOICES, Auto
from liepoisson.sweeps.spec import Axis, Refinement, Starts, SweepSpec, refinement_of, starts_of

_KEYS = (
    "name", "system", "axes", "parameters", "starts", "n_starts", "t_end", "quantity", "rule", "method", "seed",
    "refine",
)  # fmt: skip
_PLAIN = ("name", "n_starts", "quantity", "seed")
_TABLES = ("parameters", "starts", "method", "refine", "rule")
_AXIS_KEYS = ("name", "values", "from", "to", "count", "spacing", "label")


def read_sweep_file(source: str | Path | Mapping[str, Any], *, allow_code: bool = False) -> SweepSpec:
    """Read a sweep file, or its tables.

    A file is data: nothing that it says runs code, unless `allow_code` lets its quantity be a function,
    "package.module:function", that is imported and called.
    """
    if isinstance(source, Mapping):
        text, folder = TomlText("the sweep", "", dict(source)), None
    else:
        text, folder = read_toml(source), Path(source).parent
    return _Reader(text, folder, allow_code=allow_code).spec()


class _Reader(TomlReader):
    """Turns tables into a spec; every error names the key."""

    def __init__(self, toml: TomlText, folder: Path | None, *, allow_code: bool) -> None:
        super().__init__(toml)
        self.folder = folder
        self.allow_code = allow_code

    def spec(self) -> SweepSpec:
        tables = self.toml.tables
        key = "equations" if "equations" in tables else "hamiltonian"
        if key in tables and "system" not in tables:
            raise self.toml.error(
                (key,),
                "this is a file of a system; a sweep names it: system = 'FILE.toml'. Write a sweep file.",
            )
        self.check_keys((), tables, _KEYS)
        for key in ("system", "axes", "t_end"):
            if key not in tables:
                raise self.toml.error((), f"wanted {key}; there is none. Add it.")
        self.check_quantity(tables.get("quantity"))
        settings: dict[str, Any] = {key: self.number((key,), tables[key]) for key in _PLAIN if key in tables}
        settings["t_end"] = self.real(("t_end",), tables["t_end"])
        parts = {key: self.table((key,), tables.get(key, {})) for key in _TABLES}
        return self.guarded(
            (),
            lambda: SweepSpec(
                system=self.system(tables["system"]),
                axes=self.axes(tables["axes"]),
                parameters=parts["parameters"],
                starts=self.starts(parts["starts"]),
                method=self.method(parts["method"]),
                refine=self.refinement(parts["refine"]),
                rule=self.rule(parts["rule"]),
                **settings,
            ),
        )

    def check_quantity(self, given: object) -> None:
        if isinstance(given, str) and ":" in given and not self.allow_code:
            raise self.toml.error(
                ("quantity",),
                f"{shown(given)} is code, and a sweep file is data. If you trust it, allow it: --allow-code, or "
                "sweep(..., allow_code=True).",
            )

    def system(self, given: object) -> Any:
        if isinstance(given, str) and (given.endswith(".toml") or "/" in given) and self.folder is not None:
            return str(self.folder / given)
        if not isinstance(given, (str, dict)):
            raise self.toml.error(("system",), f"wanted a name or tables; got {shown(given)}. Correct it.")
        return cast("Any", given)

    def axes(self, given: object) -> tuple[Axis, ...]:
        if not isinstance(given, list):
            raise self.toml.error(("axes",), "wanted [[axes]] tables. Use two brackets.")
        return tuple(self.axis(k, table) for k, table in enumerate(cast("list[Any]", given)))

    def axis(self, k: int, table: Any) -> Axis:
        keys = ("axes", k)
        if not isinstance(table, dict):
            raise self.toml.error(keys, "wanted [[axes]] tables. Use two brackets.")
        axis = cast("dict[str, Any]", table)
        self.check_keys(keys, axis, _AXIS_KEYS)
        name, label = axis.get("name"), axis.get("label")
        if "values" in axis:
            values = axis["values"]
            if not isinstance(values, list):
                raise self.toml.error((*keys, "values"), f"wanted a list of numbers; got {shown(values)}.")
            items = cast("list[Any]", values)
            numbers = tuple(self.real((*keys, "values"), value) for value in items)
            return self.guarded(keys, lambda: Axis(cast("str", name), numbers, label))
        missing = [key for key in ("from", "to", "count") if key not in axis]
        if missing:
            raise self.toml.error(keys, f"wanted values, or from, to and count; {missing[0]} is missing. Add it.")
        spacing = axis.get("spacing", "linear")
        if spacing not in ("linear", "logarithmic"):
            raise self.toml.error((*keys, "spacing"), f'wanted "linear" or "logarithmic"; got {shown(spacing)}.')
        make = Axis.linear if spacing == "linear" else Axis.logarithmic
        start, stop = (self.real((*keys, key), axis[key]) for key in ("from", "to"))
        return self.guarded(keys, lambda: make(cast("str", name), start, stop, axis["count"], label))

    def starts(self, table: dict[str, Any]) -> Starts:
        return self.guarded(("starts",), lambda: starts_of(table))

    def method(self, table: dict[str, Any]) -> Method | Auto | None:
        if not table:
            return None
        options = {key: self.number(("method", key), value) for key, value in table.items()}
        name = options.pop("name", None)
        if name not in CHOICES:
            raise self.toml.error(("method", "name"), f"wanted one of {', '.join(CHOICES)}; got {shown(name)}.")
        return self.guarded(("method",), lambda: CHOICES[name](**options))

    def refinement(self, table: dict[str, Any]) -> Refinement | None:
        if not table:
            return None
        values = {key: self.real(("refine", key), v) if key == "difference" else v for key, v in table.items()}
        return self.guarded(("refine",), lambda: refinement_of(values))

    def rule(self, table: dict[str, Any]) -> Rule | None:
        if not table:
            return None
        self.check_keys(("rule",), table, tuple(entry.name for entry in fields(Rule)))
        return self.guarded(("rule",), lambda: Rule(**{key: self.numbers(("rule", key), table[key]) for key in table}))

    def numbers(self, keys: tuple[str | int, ...], given: object) -> Any:
        """A number, or a list of them as a tuple."""
        if isinstance(given, list):
            return tuple(self.real(keys, value) for value in cast("list[Any]", given))
        return self.real(keys, given)

    def real(self, keys: tuple[str | int, ...], given: object) -> float:
        """A number, or a formula without names, such as "pi/2"."""
        from liepoisson.formula.expression import constant

        if isinstance(given, str):
            return self.guarded(keys, lambda: float(constant(given)))
        if isinstance(given, bool) or not isinstance(given, (int, float, Fraction)):
            raise self.toml.error(keys, f"wanted a number; got {shown(given)}. Correct it.")
        try:
            return float(given)
        except OverflowError:
            raise self.toml.error(
                keys, "the number must fit into a double, up to 1.8e308. Write a smaller one."
            ) from None

    def number(self, keys: tuple[str | int, ...], given: Any) -> Any:
        """A decimal as a double; anything else as it is."""
        return self.real(keys, given) if isinstance(given, Fraction) else given
