"""What the methods of integration have in common."""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields
from functools import cache
from typing import Any, ClassVar, get_args, get_type_hints

from liepoisson import _core
from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import as_count, as_number
from liepoisson.inputs.refusals import check_choice, shown

ROUND_OFF = 2.0**-53
MAX_STEPS = 10_000_000
"""Default budget: most steps that one trajectory may take."""


@dataclass(frozen=True)
class Method:
    """A method of integration, as data: its options are the fields of a dataclass.

    Each is in a file of this folder that has its name, with `_` for `-`; the core's table of methods
    (`crates/liepoisson-core/src/method/mod.rs`) lists them.
    """

    name: ClassVar[str]

    def __post_init__(self) -> None:
        """Checks the ranges and keeps plain numbers, which can be written to a file."""
        read = {"step": as_step, "order": self._as_order, "precision": self._as_precision, "max_steps": as_budget}
        for option in fields(self):
            value = getattr(self, option.name)
            if option.name in read and not (value is None and option.default is None):
                keep(self, **{option.name: read[option.name](value)})

    def core(self) -> _core.Method:
        """The method as the core takes it."""
        return _core.Method(self.name, asdict(self))

    def _as_order(self, value: Any) -> int:
        check_choice(value, "order", (2, 4, 6, 8), "try 4")
        return int(value)

    def _as_precision(self, value: Any) -> Any:
        choices = precisions(type(self))
        if value not in choices:
            wanted = " or ".join(f'"{choice}"' for choice in choices)
            raise ParameterError(
                f"precision: wanted {wanted}; got {shown(value)}; leave it out for {choices[0]} precision"
            )
        return value

    def _in_precision(self) -> str:
        precision = getattr(self, "precision", "double")
        return "" if precision == "double" else f", {precision} precision"


@cache
def precisions(kind: type[Any]) -> tuple[str, ...]:
    """The precisions that a method has, the default one first."""
    return get_args(get_type_hints(kind).get("precision")) or ("double",)


def keep(method: object, **values: object) -> None:
    """Sets options of a method that is frozen."""
    for name, value in values.items():
        object.__setattr__(method, name, value)


def as_tolerance(value: Any, least: float, least_name: str, hint: str) -> float:
    """A tolerance in its range."""
    tol = as_number(value, "tol", f"a number from {least_name} to 0.1")
    if not least <= tol <= 0.1:
        raise ParameterError(f"tol: wanted a number from {least_name} to 0.1; got {tol!r}; {hint}")
    return tol


def as_step(value: Any) -> float:
    """The size of a step."""
    step = as_number(value, "step", "a positive number")
    if not 1e-300 <= step <= 1e300:
        raise ParameterError(f"step: wanted a positive number, from 1e-300 to 1e300; got {step!r}; try 0.1")
    return step


def as_budget(value: Any) -> int:
    """A number of steps."""
    return as_count(value, "max_steps", least=1, hint="try 1_000_000")
