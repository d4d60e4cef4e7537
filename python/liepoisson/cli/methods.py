"""Methods of integration by name and options, as the commands take them: whatever `numeric.methods` has."""

from __future__ import annotations

from dataclasses import MISSING, fields
from typing import Any

from liepoisson.errors import ParameterError, UnknownNameError, did_you_mean
from liepoisson.numeric.methods import METHODS, Method, precisions

DEFAULT_STEP = 0.1
"""In natural times of the orbits (`time_scale`)."""

_OPTIONS = ("tol", "step", "order", "precision")
_TOLERANCES = {"taylor": 1e-13}
"""Where many orbits need another tolerance than the one that is the method's own default."""


def _words(names: list[str], last: str) -> str:
    return f" {last} ".join(filter(None, [", ".join(names[:-1]), *names[-1:]]))


def _options_of(kind: type[Method]) -> dict[str, Any]:
    """The options of the commands that a method has, with its defaults."""
    return {field.name: field.default for field in fields(kind) if field.name in _OPTIONS}


def _with(option: str) -> list[str]:
    return [name for name, kind in METHODS.items() if option in _options_of(kind)]


def _precisions_help() -> str:
    takers: dict[str, list[str]] = {}
    for name in _with("precision"):
        for precision in precisions(METHODS[name])[1:]:
            takers.setdefault(precision, []).append(name)
    return "; ".join(["double", *(f"{precision} ({', '.join(names)})" for precision, names in takers.items())]) + "."


METHOD_HELP = _words(list(METHODS), "or") + "."
TOL_HELP = f"Tolerance of {_words(_with('tol'), 'and')}."
STEP_HELP = "Step of the methods with equal steps.  [default: a tenth of a natural time of the orbits]"
PRECISION_HELP = _precisions_help()


def named_method(name: str, *, unit: float = 1.0, **options: Any) -> Method:
    """The method of this name with the options that were given; None stands for an option that was not.

    Args:
        name: Its name.
        unit: Natural unit of time of the orbits, of which a default step is a tenth.
        **options: Its options.

    Raises:
        UnknownNameError: no method has this name.
        ParameterError: an option is not one of this method, or outside its range.
    """
    if name not in METHODS:
        hint = did_you_mean(name, METHODS).strip() or "Try taylor."
        raise UnknownNameError(f"--method must be one of {', '.join(METHODS)}; got {name!r:.60}. {hint}")
    known = _options_of(METHODS[name])
    given = {key: value for key, value in options.items() if value is not None}
    if given.get("precision") == "double":
        del given["precision"]
    if foreign := sorted(given.keys() - known.keys()):
        allowed = ", ".join(f"--{key}" for key in known)
        raise ParameterError(f"--{foreign[0]} is not an option of {name}, which has {allowed}. Leave it out.")
    if name in _TOLERANCES:
        given.setdefault("tol", _TOLERANCES[name])
    if known.get("step") is MISSING:
        given.setdefault("step", float(f"{DEFAULT_STEP * unit:.1e}"))
    return METHODS[name](**given)
