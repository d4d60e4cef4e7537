"""Methods of integration by name, and what callers may give as a method."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from importlib import import_module
from typing import Any, ClassVar, Literal, TypeAlias

from liepoisson import _core
from liepoisson.compile.field import Field, PiecesField, QuadraticField, TopField
from liepoisson.errors import ParameterError
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.inputs.refusals import shown
from liepoisson.numeric.method.lagrange_map import NOT_LAGRANGE, LagrangeMap, is_lagrange
from liepoisson.numeric.method.method import ROUND_OFF, Method, as_budget, as_tolerance, keep
from liepoisson.numeric.method.runge_kutta import RungeKutta
from liepoisson.numeric.method.splitting import Splitting
from liepoisson.numeric.method.taylor import Taylor
from liepoisson.numeric.systems import as_field, core_field, has_pieces


def _named(name: str) -> type[Method]:
    import_module(f"liepoisson.numeric.method.{name.replace('-', '_')}")
    return next(kind for kind in Method.__subclasses__() if kind.name == name)


METHODS: Mapping[str, type[Method]] = {name: _named(name) for name in _core.methods()}
"""All methods by name, as results have them, in the order of the core's table."""


@explains_its_methods
@dataclass(frozen=True)
class Auto:
    r"""The cheaper one of `Taylor` and `RungeKutta` for a system and a tolerance; the text "auto" is `Auto()`.

    What is chosen runs as if it had been given: results, files and reruns name it.  Operations are counted, not timed,
    so that all processors choose alike.  A step of Taylor's method, of order N, is $\rho\,\mathrm{tol}^{1/(N-1)}$ long
    in units that depend on the orbit, one of the Runge-Kutta method $c\rho\,\mathrm{tol}^{1/8}$, with c measured, about
    4/3 for all systems.  With $W_T$ and $W_R$ operations in a step, those of the field with one tangent vector and of
    the method itself, the Runge-Kutta method is taken where
    $W_R\,\mathrm{tol}^{-1/8}/c < W_T\,\mathrm{tol}^{-1/(N-1)}$.
    Where power series are needed (sections, dense output) it is always `Taylor`.

    Example:
        >>> top, start = lp.Top.kovalevskaya(), {"l": (1, 0, 1), "alpha3": 1}
        >>> [lp.integrate(top, start, t_end=10, method=lp.Auto(tol=tol)).method.name for tol in (1e-5, 1e-13)]
        ['runge-kutta', 'taylor']

    Args:
        tol: The tolerance of either, from 1.1e-16 to 0.1; by default that of the function's own default method.
        max_steps: Most steps that one trajectory may take; by default as many as with that method.

    Raises:
        ParameterError: A value outside its range.
    """

    name: ClassVar[str] = "auto"

    tol: float | None = None
    max_steps: int | None = None

    def __post_init__(self) -> None:
        """Checks the ranges and keeps plain numbers, which can be written to a file."""
        if self.tol is not None:
            keep(self, tol=as_tolerance(self.tol, ROUND_OFF, "1.1e-16", "try 1e-8"))
        if self.max_steps is not None:
            keep(self, max_steps=as_budget(self.max_steps))

    def __str__(self) -> str:
        return "Taylor or Runge-Kutta method" + ("" if self.tol is None else f", tolerance {self.tol:g}")


MethodChoice: TypeAlias = Method | Auto | Literal["auto"]
"""What callers may give."""
CHOICES: Mapping[str, type[Method | Auto]] = {**METHODS, Auto.name: Auto}
"""What they may name: commands, sweep files and messages have names and options from here."""


def as_choice(method: Any) -> Method | Auto | None:
    """What a caller gives as a method, checked.

    Raises:
        ParameterError: It is not a method object.
    """
    if isinstance(method, str) and method == Auto.name:
        return Auto()
    if method is not None and not isinstance(method, tuple(CHOICES.values())):
        names = ", ".join(kind.__name__ for kind in CHOICES.values())
        raise ParameterError(
            f'method: wanted a method object ({names}) or "auto"; got {shown(method)}; try method=Taylor(tol=1e-13)'
        )
    return method


def as_method(method: Any, default: Taylor, system: Any = None, *, in_series: bool = False) -> Method:
    """The method that runs: the one that a caller gives, the default for None, the cheaper one for `Auto`.

    Args:
        method: What the caller gives.
        default: The method for None; `Auto` has from it what it does not say itself.
        system: What is integrated.
        in_series: Whether power series are needed, so that `Auto` has no choice.

    Raises:
        ParameterError: It is not a method object.
    """
    chosen = as_choice(method)
    if chosen is None:
        return default
    if not isinstance(chosen, Auto):
        return chosen
    tol = default.tol if chosen.tol is None else chosen.tol
    max_steps = default.max_steps if chosen.max_steps is None else chosen.max_steps
    if in_series or not core_field(as_field(system)).prefers_runge_kutta(tol):
        return Taylor(tol=tol, max_steps=max_steps)
    return RungeKutta(tol=tol, max_steps=max_steps)


def field_for(system: Any, field: Field, method: Method) -> Field:
    """The description of the system that the method works on: its field, or the pieces of its Hamiltonian.

    Raises:
        ParameterError: The method does not apply to such a field.
    """
    if isinstance(field, PiecesField):
        if not isinstance(method, Splitting):
            raise ParameterError(
                f"method: wanted Splitting for a field given by its pieces; got {method}; try Splitting(step=0.1)"
            )
        return _with_precision(field, method)
    if isinstance(method, LagrangeMap) and not (isinstance(field, TopField) and is_lagrange(field)):
        instead = "Splitting(step=0.1)" if isinstance(field, TopField) else "Taylor()"
        raise ParameterError(f"method: LagrangeMap {NOT_LAGRANGE}; got another field; try {instead}")
    if isinstance(method, Splitting) and not isinstance(field, TopField):
        if not has_pieces(system):
            raise ParameterError(
                f"method: Splitting wants the pieces of a Hamiltonian; {shown(system.name)} is integrated as a "
                f"{field.name} of {field.n_components} components, which has none; "
                + ("give the system that the field is from, or try Taylor()" if system is field else "try Taylor()")
            )
        return _with_precision(system.pieces(), method)
    return _with_precision(field, method)


def _with_precision(field: Field, method: Method) -> Field:
    precision = getattr(method, "precision", "double")
    allowed = (TopField, QuadraticField) if isinstance(method, RungeKutta) else TopField
    if precision != "double" and not isinstance(field, allowed):
        fields = "tops and quadratic fields" if isinstance(method, RungeKutta) else "tops"
        raise ParameterError(
            f'precision: wanted "double" for a {field.name}; got {precision!r}, which is for {fields}; leave it out'
        )
    return field


def method_record(method: Method | Auto) -> dict[str, Any]:
    """The method as plain data that JSON can write."""
    return {"name": method.name, **asdict(method)}


def method_of(record: Mapping[str, Any]) -> Method:
    """The method that `method_record` has written.

    Raises:
        KeyError, TypeError, ValueError: `method_record` did not write it.
    """
    values = dict(record)
    return METHODS[values.pop("name")](**values)


def choice_of(record: Mapping[str, Any]) -> Method | Auto:
    """The same where it may also be a choice that is still to be made."""
    values = dict(record)
    return CHOICES[values.pop("name")](**values)
