"""Methods of integration by name and options, as the commands take them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from liepoisson.errors import ParameterError, UnknownNameError, did_you_mean

if TYPE_CHECKING:
    from liepoisson.numeric.methods import Method

DEFAULT_STEP = 0.1
"""In natural times of the orbits (`time_scale`)."""

STEP_HELP = "Step of the methods with equal steps.  [default: a tenth of a natural time of the orbits]"

_OPTIONS: dict[str, dict[str, Any]] = {
    "taylor": {"tol": 1e-13, "order": None, "precision": "double"},
    "runge-kutta": {"tol": None, "step": None, "precision": "double"},
    "splitting": {"step": DEFAULT_STEP, "order": 4, "precision": "double"},
    "gauss": {"step": DEFAULT_STEP, "order": 4},
    "lagrange-map": {"step": DEFAULT_STEP},
}
"""The options of each method, with their defaults."""


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
    from liepoisson.numeric.methods import METHODS

    if name not in _OPTIONS:
        hint = did_you_mean(name, _OPTIONS).strip() or "Try taylor."
        raise UnknownNameError(f"--method must be one of {', '.join(_OPTIONS)}; got {name!r:.60}. {hint}")
    known = _OPTIONS[name]
    given = {key: value for key, value in options.items() if value is not None}
    if given.get("precision") == "double":
        del given["precision"]
    if foreign := sorted(given.keys() - known.keys()):
        allowed = ", ".join(f"--{key}" for key in known)
        raise ParameterError(f"--{foreign[0]} is not an option of {name}, which has {allowed}. Leave it out.")
    values = {key: given.get(key, default) for key, default in known.items()}
    if "step" not in given and values.get("step") == DEFAULT_STEP:
        values["step"] = float(f"{DEFAULT_STEP * unit:.1e}")
    return METHODS[name](**values)
