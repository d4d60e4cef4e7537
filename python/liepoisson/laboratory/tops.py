r"""Descriptions of tops with their parameters left open, so that the page can move them without a formula of its own.

A parameter is one more component, after the nine of the state, in the order of `PARAMETERS`; in a field its rate is
zero.  So one tape serves every top.  The attitude of the body follows from the angular velocity $\omega$ in the body
frame by

$$\dot q = \tfrac12\, q\,(0, \omega),$$

where the unit quaternion q turns vectors of the body into vectors of space.  The path along the third axis of the body,

$$\dot r = q\,(0, e_3)\,\bar q,$$

is the centre line of the rod that Kirchhoff's analogy makes of the orbit, with arclength for time.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING, Any

from liepoisson.compile.field import record_of
from liepoisson.compile.lowering import tape_of_equations, tape_of_functions
from liepoisson.model.tops import Top

if TYPE_CHECKING:
    from sympy import Expr, Symbol

VERSION = 2
"""Of the format, which the page looks at."""

PARAMETERS = ("I1", "I2", "I3", "a1", "a2", "a3", "b1", "b2", "b3", "epsilon")
"""In the order in which they follow the state."""

ATTITUDE = ("q0", "q1", "q2", "q3")
"""The quaternion, real part first."""

POSITION = ("r1", "r2", "r3")
"""Along the centre line, in space."""


@cache
def presets() -> list[dict[str, Any]]:
    """The tops with which the page tells its story, as `presets.toml` has them."""
    text = files("liepoisson.laboratory").joinpath("presets.toml").read_text(encoding="utf-8")
    return tomllib.loads(text)["presets"]


@dataclass(frozen=True)
class Family:
    """Tops that have invariants of their own."""

    name: str  # how the family is called
    top: Top  # a trajectory with its parameters left open; it knows the invariants
    conditions: tuple[str, ...]  # what vanishes for the trajectories


def families() -> list[Family]:
    """The tops that the page knows invariants of, the special ones after the more general."""
    inertia, a, b = (tuple(PARAMETERS[first : first + 3]) for first in (0, 3, 6))
    no_charge, no_twist = ("b1", "b2", "b3"), ("epsilon",)
    axial = ("I1 - I2", "a1", "a2", "b1", "b2")
    kovalevskaya = ("I1 - 2", "I2 - 2", "I3 - 1", "a3", *no_twist)
    symmetric: dict[str, Any] = {"transverse": "I1", "axial": "I3", "a3": "a3"}
    return [
        Family("top", Top(inertia=inertia, a=a, b=b, epsilon="epsilon"), ()),
        Family("heavy top", Top.heavy(inertia, a), (*no_charge, *no_twist)),
        Family("twisted Lagrange", Top.twisted_lagrange(**symmetric, b3="b3", epsilon="epsilon"), axial),
        Family("charged Lagrange", Top.charged_lagrange(**symmetric, b3="b3"), (*axial, *no_twist)),
        Family("Lagrange", Top.lagrange(**symmetric), (*axial, "b3", *no_twist)),
        Family("Kovalevskaya", Top.heavy((2, 2, 1), ("a1", "a2", 0)), (*kovalevskaya, *no_charge)),
        Family(
            "two-field Kovalevskaya",
            Top.charged_heavy((2, 2, 1), (-1, 0, 0), (0, -1, 0)),
            (*kovalevskaya, "a1 + 1", "a2", "b1", "b2 + 1", "b3"),
        ),
    ]


def _symbols(names: Sequence[str]) -> list[Symbol]:
    from sympy import Symbol

    return [Symbol(name, real=True) for name in names]


def _in_symbols(expression: Expr, symbols: Mapping[str, Symbol]) -> Expr:
    """The same expression in the symbols of the page, which are told by their names."""
    known: dict[Any, Any] = {symbol: symbols[str(symbol)] for symbol in expression.free_symbols}
    renamed: Any = expression.xreplace(known)
    return renamed


def description_of_tops() -> dict[str, Any]:
    """All tops as plain data.

    Returns:
        - `version`: of this format;
        - `package`: the version of liepoisson that wrote it;
        - `components`, `parameters`, `attitude`, `position`: names, in the order in which the tapes have them;
        - `moving`: state, attitude, position and parameters as one field;
        - `ellipsoid`: functions of state and parameters: the squares of the three half axes of the ellipsoid of angular
          momenta that have the kinetic energy of the state, and the square of the angular momentum;
        - `families`: each with `name`, `conditions` (functions of state and parameters, all zero for a trajectory),
          `names` and `functions` of invariants.  The last
          family that a top belongs to has all of its known invariants.
    """
    from sympy import Integer

    from liepoisson import __version__
    from liepoisson.formula.expression import read_expression
    from liepoisson.formula.scope import Scope

    general = families()[0].top
    names = [*general.component_names, *PARAMETERS]
    variables = _symbols(names)
    symbols, scope = dict(zip(names, variables, strict=True)), Scope(symbols=names)

    def tape(functions: Sequence[Expr]) -> dict[str, Any]:
        return asdict(tape_of_functions(variables, [_in_symbols(function, symbols) for function in functions]))

    known: list[dict[str, Any]] = []
    for family in families():
        conditions = [_in_symbols(read_expression(condition, scope), symbols) for condition in family.conditions]
        invariants = family.top.invariants
        known.append(
            {
                "name": family.name,
                "conditions": tape(conditions) if conditions else None,
                "names": list(invariants),
                "functions": tape(list(invariants.values())),
            }
        )
    rates = [_in_symbols(rate, symbols) for rate in general.equations.values()]
    attitude, position = _symbols(ATTITUDE), _symbols(POSITION)
    turning = _rate_of_attitude(attitude, [symbols[f"l{k}"] / symbols[f"I{k}"] for k in (1, 2, 3)])
    moving = tape_of_equations(
        [*variables[:9], *attitude, *position, *variables[9:]],
        [*rates, *turning, *_third_axis(attitude), *[Integer(0)] * len(PARAMETERS)],
    )
    hamiltonian = _in_symbols(general.hamiltonian, symbols)
    return {
        "version": VERSION,
        "package": __version__,
        "components": list(general.component_names),
        "parameters": list(PARAMETERS),
        "attitude": list(ATTITUDE),
        "position": list(POSITION),
        "moving": record_of(moving),
        "ellipsoid": tape(_ellipsoid(hamiltonian, variables[:3])),
        "families": known,
    }


def _rate_of_attitude(q: Sequence[Expr], omega: Sequence[Expr]) -> list[Expr]:
    """Half of the product of the quaternions q and (0, omega)."""
    q0, q1, q2, q3 = q
    w1, w2, w3 = omega
    twice = [
        -q1 * w1 - q2 * w2 - q3 * w3,
        q0 * w1 + q2 * w3 - q3 * w2,
        q0 * w2 + q3 * w1 - q1 * w3,
        q0 * w3 + q1 * w2 - q2 * w1,
    ]
    return [rate / 2 for rate in twice]


def _third_axis(q: Sequence[Expr]) -> list[Expr]:
    """The third axis of the body in space, the last column of the rotation of a unit quaternion."""
    q0, q1, q2, q3 = q
    return [2 * (q1 * q3 + q0 * q2), 2 * (q2 * q3 - q0 * q1), q0**2 - q1**2 - q2**2 + q3**2]


def _ellipsoid(hamiltonian: Expr, momenta: Sequence[Symbol]) -> list[Expr]:
    """Squares of the half axes of `T(l) = T` with the kinetic energy `T = H - H(l = 0)`, and of `|l|`."""
    from sympy import Integer, cancel, expand

    rest: Any = dict.fromkeys(momenta, Integer(0))
    kinetic = expand(hamiltonian - hamiltonian.xreplace(rest))
    squares = [cancel(kinetic / kinetic.xreplace({**rest, momentum: Integer(1)})) for momentum in momenta]
    total: Any = sum((momentum**2 for momentum in momenta), Integer(0))
    return [*map(expand, squares), total]
