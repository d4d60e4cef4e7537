"""What a surface of section is asked for: the function, the direction, the sides of the starts, the end."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson.compile.field import TapeFunction
from liepoisson.compile.tape_values import values_of_tape
from liepoisson.errors import LiePoissonError, ParameterError
from liepoisson.formula.scalars import as_array, as_time
from liepoisson.inputs.arrays import check_shape
from liepoisson.inputs.given import listed
from liepoisson.inputs.refusals import check_choice, shown
from liepoisson.model.equations_of_motion import EquationsOfMotion, HasExpression
from liepoisson.numeric.integrate import integrate
from liepoisson.numeric.method.taylor import Taylor
from liepoisson.numeric.sampling import sample_states
from liepoisson.numeric.systems import has_bracket, reads_formulas

if TYPE_CHECKING:
    from sympy import Expr

Function: TypeAlias = "str | Expr | HasExpression"
"""A function of the state."""

_STEPS, _LONG = 4, 1e9
"""Steps of Taylor's method after which a function is looked at again; each goes as far as its series converges well."""
_CHANGE = 1e-6
"""Part of its values at random states by which a function has changed then; a constant has changed by some 1e-15."""


def read_tape(record: dict[str, Any]) -> TapeFunction:
    """The functions that a file has as data."""
    return TapeFunction(record["n_components"], record["instructions"], record["outputs"], record.get("guard"))


def surface_alone(surface: Function | TapeFunction) -> Function | TapeFunction:
    """The surface without further outputs, so that whole states are kept."""
    if not isinstance(surface, TapeFunction):
        return surface
    return TapeFunction(surface.n_components, surface.instructions, surface.outputs[:1], surface.guard)


def as_formula(given: Any, what: str) -> str | Expr:
    """A function of the state as text or expression."""
    formula = given if isinstance(given, str) else getattr(given, "expression", given)
    if not isinstance(formula, str) and not (hasattr(formula, "free_symbols") and hasattr(formula, "diff")):
        raise ParameterError(
            f"{what}: wanted a function of the state; got {shown(given)}; try the name of a component as a text, or an "
            "expression in system.variables"
        )
    return formula


def check_that_it_varies(
    system: Any, function: str | Expr, what: str = "surface", *, noises: Sequence[str] = ()
) -> None:
    """Refuses a function that is proved constant on every leaf or along every orbit: no orbit crosses a level of it.

    Raises:
        ParameterError: it is a number, a Casimir or a constant of motion, with noise of all its Hamiltonians.
    """
    if _is_seen_to_vary(system, function) or (reason := why_constant(system, function, noises)) is None:
        return
    names = system.component_names
    moves = next((name for name in names if why_constant(system, name, noises) is None), None)
    hint = "nothing moves here" if moves is None else f'try a component such as "{moves}"'
    raise ParameterError(
        f"{what}: wanted a function that changes along orbits; got {shown(function)}, {reason}; {hint}"
    )


def _is_seen_to_vary(system: Any, function: str | Expr) -> bool:
    """Whether a function that is no polynomial changes in a few steps of an orbit, far beyond their errors.

    No proof is needed then; False where a bracket has to tell, which for such functions takes SymPy.
    """
    whole: Any = system
    if not has_bracket(system) or not isinstance(function, str) or whole.polynomial(function) is not None:
        return False
    try:
        tape = whole.function_tape(function)
        starts = sample_states(system, 2, ensemble="gaussian")
        orbits = integrate(system, starts, times=[0, _LONG], method=Taylor(max_steps=_STEPS))
    except LiePoissonError:
        return False
    first, last = values_of_tape(tape, np.array([starts, orbits.end_state]))[..., 0]
    return bool(np.abs(last - first).max() > _CHANGE * (np.abs(first) + np.abs(last)).max())


def why_constant(system: Any, function: str | Expr, noises: Sequence[str] = ()) -> str | None:
    """Why a function is constant along every orbit, or path with noise, where its brackets prove it; else None.

    They say nothing about components that are found by quadrature, which stand in no bracket.
    """
    whole: Any = system
    if not has_bracket(system):
        is_constant = isinstance(system, EquationsOfMotion) and _is_constant_of_motion(system, function)
        return "which is constant along each orbit" if is_constant else None
    n = whole.bracket.dimension
    if n < len(whole.component_names) and system.expression(function).free_symbols & {*whole.variables[n:]}:
        return None
    if system.is_casimir(function):
        occurs = system.expression(function).free_symbols
        kind = "its bracket with every component is zero" if occurs else "no component occurs in it"
        return f"which is constant on each leaf: {kind}"
    if not _is_constant_of_motion(system, function) or not _commutes(system, function, noises):
        return None
    if noises:
        return "a constant of motion: its brackets with H and all noises are zero"
    return "a constant of motion: its bracket with H is zero, and each orbit lies in one of its levels"


def _commutes(system: Any, function: str | Expr, others: Sequence[str]) -> bool:
    """Whether its bracket with each of these functions is zero when multiplied out."""
    f = system.expression(function)
    return all(system.bracket(f, system.expression(other)).expand() == 0 for other in others)


def _is_constant_of_motion(system: Any, function: str | Expr) -> bool:
    """Whether the rate is zero: certain for polynomials, and for others if it is when multiplied out."""
    if isinstance(function, str) and system.polynomial(function) is not None:
        return bool(system.is_constant(function))
    whole: Any = system
    f = whole.expression(function)
    if has_bracket(system):
        return bool(whole.bracket(f, whole.hamiltonian).expand() == 0)
    rate: Any = sum(f.diff(x) * rate for x, rate in whole.equations.items())
    return bool(rate.expand() == 0)


def as_surface(system: Any, surface: Any, keep: Sequence[Any] | None) -> tuple[TapeFunction, tuple[str, ...] | None]:
    """Surface function and kept functions as data, and the names of the latter; None for whole states."""
    given = None if keep is None else listed(keep, "keep")
    if keep is not None and not given:
        hint = f"try [{shown(keep)}]" if isinstance(keep, str) and keep else "leave it out for whole states"
        raise ParameterError(f"keep: wanted a sequence of functions; got {shown(keep)}; {hint}")
    kept = None if given is None else [as_formula(function, "keep") for function in given]
    names = None if kept is None else tuple(map(str, kept))
    if isinstance(surface, TapeFunction):
        further = len(surface.outputs) - 1
        if further < 0:
            raise ParameterError("surface: wanted a tape with one output at least, the surface function; got none")
        if names is None and further:
            names = tuple(f"y{k + 1}" for k in range(further))
        if further != (0 if names is None else len(names)):
            raise ParameterError(
                f"keep: wanted names for the {further} further outputs of the surface; got {shown(keep)}"
            )
        return surface, names
    if not reads_formulas(system):
        raise ParameterError(
            f"surface: wanted a TapeFunction, since {shown(system)} cannot read formulas; got {shown(surface)}; "
            "try a System, or System.function_tape"
        )
    formula = as_formula(surface, "surface")
    if "atan2" in str(formula):
        raise ParameterError(
            f"surface: wanted a smooth function; got {shown(surface)}, and atan2 jumps by 2*pi; try "
            "sin(c)*x - cos(c)*y, which vanishes where atan2(y, x) is c, and where it is c + pi"
        )
    check_that_it_varies(system, formula)
    return tape_of_surface(system, formula, kept or []), names


def tape_of_surface(system: Any, formula: str | Expr, kept: Sequence[str | Expr] = ()) -> TapeFunction:
    """The surface where a function of a system vanishes, of a function on circles modulo its period, and what is kept.

    Raises:
        ParameterError: the function is none on the circles of the system.
    """
    if (turn := modulus_of_surface(system, formula)) is not None:
        return _modulo(system, formula, turn, kept)
    return system.function_tape(formula, *kept)


def modulus_of_surface(system: Any, formula: str | Expr) -> Expr | None:
    """The number modulo which a function of coordinates on circles is given; None where it is a number itself.

    Raises:
        ParameterError: it is none of both.
    """
    if not (periods := getattr(system, "periods", {})):
        return None
    from liepoisson.structure.circles import modulus

    circles = {str(x): (x, periods[str(x)]) for x in system.variables if str(x) in periods}
    try:
        return modulus(system.expression(formula), circles, system.variables)
    except ParameterError as error:
        raise ParameterError(f"surface: {error}") from None


def _modulo(system: Any, formula: str | Expr, turn: Expr, kept: Sequence[str | Expr]) -> TapeFunction:
    r"""The surface where a function s vanishes modulo m: $\sin(2\pi s/m) = 0$ with a positive cosine."""
    from sympy import cos, pi, sin

    rate: Any = 2 * pi / turn
    if isinstance(formula, str):
        argument = f"({formula})" if rate == 1 else f"({str(rate).replace('**', '^')})*({formula})"
        both: list[Any] = [f"sin({argument})", f"cos({argument})"]
    else:
        both = [function(rate * system.expression(formula)) for function in (sin, cos)]
    tape = system.function_tape(*both, *kept)
    first, guard, *others = tape.outputs
    return TapeFunction(tape.n_components, tape.instructions, (first, *others), guard)


def as_end(t_end: Any) -> float:
    """The time at which trajectories end."""
    return as_time(t_end, "t_end", example=1000, forwards=False)


def as_sides(sides: ArrayLike, n_trajectories: int) -> NDArray[np.int8]:
    """The sign of the surface function before each start."""
    given = as_array(sides, "start_side")
    check_shape(
        given.shape in ((), (n_trajectories,)), "start_side", f"() or ({n_trajectories},), a sign for each", given
    )
    if not np.isin(given, (-1, 0, 1)).all():
        raise ParameterError(f"start_side: wanted +1, -1 or 0; got {shown(sides)}; try the end_side of a section")
    return np.broadcast_to(given, n_trajectories).astype(np.int8)


def as_direction(direction: Any) -> int:
    """Which crossings are wanted."""
    check_choice(
        direction, "direction", (-1, 0, 1), "write +1 where the surface function increases, -1 where it decreases"
    )
    return int(direction)
