r"""Coordinates on circles: which coordinates are angles, and whether a function is one on the circle.

A function of a coordinate $\theta$ of period $P$ is one on the circle if $f(\theta + P) = f(\theta)$.  That is proved
where the difference vanishes once it is multiplied out, as for trigonometric polynomials; else it is tried at 10
random points, in as many digits as its numbers need (`liepoisson.algebra.decimals`).
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from math import gcd, lcm
from random import Random
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.decimals import vanishes_at_all
from liepoisson.errors import BracketError, ParameterError, ShapeError, did_you_mean
from liepoisson.inputs.deadline import checkpoint
from liepoisson.inputs.given import listed_names

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.structure.coordinates import Coordinates


def read_angles(given: Sequence[str] | None, names: Sequence[str]) -> tuple[str, ...]:
    """The coordinates that are angles, in the order of the coordinates.

    Raises:
        ShapeError: not a sequence of names.
        BracketError: a name is that of no coordinate, or is given twice.
    """
    items = [] if given is None else listed_names(given, "angles")
    if items is None or not all(isinstance(item, str) for item in items):
        raise ShapeError(f'angles must be a sequence of names; got {given!r:.60}. Write for example ["theta"].')
    for name in items:
        if name not in names:
            shown = ", ".join(names[:20]) + (", ..." if len(names) > 20 else "")
            hint = did_you_mean(name, names).strip() or "Write one of these."
            raise BracketError(f"angles must name coordinates; got {name!r:.60}. Known are {shown}. {hint}")
    if len({*items}) < len(items):
        raise BracketError(f"each angle must be named once; got {list(items)!s:.60}. Remove one.")
    return tuple(name for name in names if name in items)


def turn() -> Expr:
    r"""The period of an angle, $2\pi$."""
    from sympy import pi

    return 2 * pi


def change(function: Expr, coordinate: Expr, period: Expr) -> Expr:
    r"""The change $f(\theta + P) - f(\theta)$, multiplied out; 0 where it is found to vanish."""
    from sympy import Add, S, expand

    checkpoint("whether a function is one on the circle")
    if coordinate not in function.free_symbols:
        return S.Zero
    moved: Any = function.subs(coordinate, coordinate + period)
    after, before = expand(moved), expand(function)
    found: Any = after - before
    if found == 0:
        return S.Zero
    return S.Zero if _vanishes_at_points([*Add.make_args(after), *Add.make_args(-before)]) else found


def _vanishes_at_points(terms: Sequence[Any]) -> bool:
    """Whether a sum is round-off at random points where it has a value."""
    from sympy import Rational

    from liepoisson.structure.poisson.poisson_tensor import SEEDS
    from liepoisson.structure.poisson.tensor_entries import N_POINTS

    symbols, random = sorted({s for term in terms for s in term.free_symbols}, key=str), Random(SEEDS[0])
    points = ({x: Rational(random.randint(1, 1 << 30), 1 << 29) for x in symbols} for _ in range(N_POINTS))
    return bool(vanishes_at_all(terms, points))


def angles_among(functions: Mapping[str, Expr], old: Sequence[Expr]) -> tuple[str, ...]:
    r"""Which of new coordinates y(x) are angles, where the old ones have angles.

    With $y_a(\theta_b + 2\pi) = y_a + 2\pi n_{ab}$ and integers n those are angles whose rows of n are not zero, if the
    rows are part of a basis of the integer vectors: then all functions on the circles of y are those of x that are
    functions of y.

    Args:
        functions: The new coordinates by name, functions of the old ones.
        old: The old coordinates that are angles.

    Raises:
        BracketError: a function is changed by a turn by anything else, or the rows are no part of a basis.
    """
    from sympy import ZZ, Matrix
    from sympy.matrices.normalforms import smith_normal_form

    rows: dict[str, list[int]] = {}
    hint = (
        "Take functions of sines and cosines of it, or the angle itself; or take a bracket without angles, "
        "bracket.with_angles([])."
    )
    for name, function in functions.items():
        windings: list[Any] = [change(function, x, turn()) / turn() for x in old]
        for x, n in zip(old, windings, strict=True):
            if not n.is_Integer:
                raise BracketError(
                    f"new coordinates must be functions on the circle of {x}, or angles; got {name} = "
                    f"{function!s:.60}, which changes by {n * turn()!s:.60} when {x} grows by a turn. {hint}"
                )
        if any(windings):
            rows[name] = [int(n) for n in windings]
    if rows:
        normal: Any = smith_normal_form(Matrix([*rows.values()]), domain=ZZ)
        if len(rows) > len(old) or any(abs(normal[k, k]) != 1 for k in range(len(rows))):
            x = ", ".join(map(str, old))
            raise BracketError(
                f"new angles must be as many independent ones as go round once; got {', '.join(rows)} for the "
                f"angle{'s' * (len(old) > 1)} {x}, with the windings {[*rows.values()]}. {hint}"
            )
    return tuple(rows)


def check_on_circles(
    functions: Iterable[tuple[str, Expr]], periods: Mapping[str, tuple[Expr, Expr]], hint: str
) -> None:
    """Refuse functions that are not periodic in coordinates on circles.

    Args:
        functions: Each with what it is, at the beginning of a message.
        periods: The symbol and the period of each such coordinate, by name.
        hint: What else may be done, at the end of a message, with {name} for the coordinate.

    Raises:
        ParameterError: one is not; the message has the difference after a period.
    """
    for what, function in functions:
        for name, (symbol, period) in periods.items():
            if (found := change(function, symbol, period)) != 0:
                raise ParameterError(
                    f"{what} must have the period {period} in {name}; got {function!s:.80}, which changes by "
                    f"{found!s:.80} when {name} grows by {period}. {hint.format(name=name)}"
                )


def check_casimirs_on_circles(bracket: Coordinates, casimirs: Iterable[Expr]) -> None:
    """Refuse Casimirs that are no functions on the circles of the angles of a bracket.

    Raises:
        ParameterError: one is not; the message has the difference after a turn.
    """
    periods: Any = {str(x): (x, turn()) for x in bracket.angle_variables}
    hint = "Write it by sines and cosines, sin({name}) for {name}, or leave {name} out of angles."
    check_on_circles((("a Casimir", casimir) for casimir in casimirs), periods, hint)


def modulus(function: Expr, periods: Mapping[str, tuple[Expr, Expr]], variables: Collection[Expr]) -> Expr | None:
    r"""The number modulo which a function is one on the circles: $2\pi$ for $\theta - 1/2$ or $\theta_1 - 2\theta_2$.

    It changes by a multiple of it whenever a coordinate grows by its period; None where it does not change.

    Args:
        function: The function.
        periods: The symbol and the period of each coordinate on a circle, by name.
        variables: All coordinates.

    Raises:
        ParameterError: a change is no constant, or two changes have no common measure.
    """
    from sympy import Abs, Rational, nsimplify, simplify

    found: list[Any] = []
    for name, (symbol, period) in periods.items():
        moved: Any = change(function, symbol, period)
        if moved.free_symbols & {*variables}:
            moved = simplify(moved)
        if moved.free_symbols & {*variables}:
            raise ParameterError(
                f"wanted a function on the circle of {name}, or one that a turn changes by a constant, such as "
                f"{name} - 1/2; got {function!s:.60}, which changes by {moved!s:.60}. Write it by sin({name}) and "
                f"cos({name})."
            )
        if moved != 0:
            found.append(Abs(moved))
    if not found:
        return None
    ratios = [nsimplify(simplify(one / found[0])) for one in found]
    if not all(ratio.is_Rational for ratio in ratios):
        raise ParameterError(
            f"wanted a function on circles modulo one number; got {function!s:.60}, which changes by "
            f"{', '.join(map(str, found))} after turns, of which no number is a common measure."
        )
    return found[0] * Rational(gcd(*(int(ratio.p) for ratio in ratios)), lcm(*(int(ratio.q) for ratio in ratios)))
