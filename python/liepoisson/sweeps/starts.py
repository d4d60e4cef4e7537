r"""Starts of a sweep: states with prescribed energy and Casimirs, from the same random numbers at every point."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from liepoisson.compile.field import TopField
from liepoisson.errors import LeafError, ParameterError
from liepoisson.inputs.arrays import Array
from liepoisson.portable import linear
from liepoisson.sweeps.family import Family, NumericTop, quiet

if TYPE_CHECKING:
    from liepoisson.sweeps.points import Targets

Bools: TypeAlias = NDArray[np.bool_]
Functions: TypeAlias = Callable[[Array, NDArray[np.int64]], tuple[Array, Array]]
"""Values (row, function) and gradients (row, function, component) at states; which rows of the whole they are."""

_CONVERGED = 1e-12
_STAGES = 16
"""Parts in which values are approached where one leap fails."""
_MOST_STEPS, _MOST_HALVINGS = 50, 12
_ONE_UNIT = 1024.0
"""Lengths that differ by less are in one unit."""


@dataclass(frozen=True)
class TopRows:
    r"""Tops with a row of parameters for each state: energy and Casimirs, without the exact algebra.

    $C_1 = |\alpha|^2 + 2\epsilon\,\ell\cdot\beta$, $C_2 = \alpha\cdot\beta$, $C_3 = |\beta|^2$, whatever epsilon.
    """

    inertia: Array  # shape (row, 3), as a and b
    a: Array  # centre of mass
    b: Array  # centre of charge
    epsilon: Array  # shape (row, 1)

    @classmethod
    def of(cls, tops: Sequence[TopField], repeats: int) -> TopRows:
        """The parameters of these tops, each for `repeats` states in turn."""
        columns = ([top.inertia for top in tops], [top.a for top in tops], [top.b for top in tops])
        inertia, a, b = (np.repeat(np.array(column), repeats, axis=0) for column in columns)
        return cls(inertia, a, b, np.repeat(np.array([[top.epsilon] for top in tops]), repeats, axis=0))

    def functions(self, names: Sequence[str]) -> Functions:
        """The functions of these names, "energy" or a Casimir, in this order."""
        forms = {"energy": self._energy, "C1": self._first, "C2": self._second, "C3": self._third}
        if unknown := [name for name in names if name not in forms]:
            raise ParameterError(f"a top has the Casimirs C1, C2 and C3; got {', '.join(unknown)}. Correct the name.")

        def evaluate(x: Array, rows: NDArray[np.int64]) -> tuple[Array, Array]:
            found = [forms[name](x[:, :3], x[:, 3:6], x[:, 6:], rows) for name in names]
            gradients = [np.concatenate(parts, axis=-1) for _, parts in found]
            return np.stack([value for value, _ in found], axis=-1), np.stack(gradients, axis=1)

        return evaluate

    def _energy(self, l: Array, alpha: Array, beta: Array, rows: Any) -> tuple[Array, tuple[Array, ...]]:
        omega, a, b = l / self.inertia[rows], self.a[rows], self.b[rows]
        return (l * omega / 2 + a * alpha + b * beta).sum(-1), (omega, a, b)

    def _first(self, l: Array, alpha: Array, beta: Array, rows: Any) -> tuple[Array, tuple[Array, ...]]:
        twice = 2 * self.epsilon[rows]
        return (alpha**2 + twice * l * beta).sum(-1), (twice * beta, 2 * alpha, twice * l)

    def _second(self, l: Array, alpha: Array, beta: Array, rows: Any) -> tuple[Array, tuple[Array, ...]]:
        return (alpha * beta).sum(-1), (0 * l, beta, alpha)

    def _third(self, l: Array, alpha: Array, beta: Array, rows: Any) -> tuple[Array, tuple[Array, ...]]:
        return (beta**2).sum(-1), (0 * l, 0 * alpha, 2 * beta)


def is_top(system: Any) -> bool:
    """Whether this is known to be a top, so that `TopRows` has its energy and Casimirs."""
    from liepoisson.model.tops import Top

    return isinstance(system, (NumericTop, Top))


def check_casimirs(family: Family, targets: Targets, sampling: str = "projection") -> Meaning | None:
    """Refuse Casimirs that the systems do not have, or that are other functions at one point than at another.

    And fewer than all of them where starts are drawn on a leaf.

    Looked at are the formulas of a file, and the first, middle and last point; the others are looked at when they are
    computed, see `require_meaning`.  Returns what C1, C2, ... mean at all points; None where none are prescribed, or
    the bracket is the same at the points looked at.
    """
    if not targets.casimirs and sampling != "liouville":
        return None
    n, systems = len(targets), list[Any]()
    for point in sorted({0, n // 2, n - 1}):
        with suppress(Exception):  # told of its point when it is computed
            systems.append(quiet(family.numeric(targets.values(point))))
    others = [system for system in systems if not is_top(system)]
    known = {name for system in systems for name in _all_casimirs(system)}
    if systems and (unknown := [name for name in targets.casimirs if name not in known]):
        has = ", ".join(sorted(known)) or "no Casimirs"
        raise ParameterError(f"{family.name} has {has}; got {', '.join(unknown)}. Correct the name.")
    if sampling == "liouville":
        left = [sorted({*_all_casimirs(system)} - {*targets.casimirs}) for system in systems]
        if left and all(left):
            raise ParameterError(
                f'starts: sampling="liouville" draws on a leaf, of which all Casimirs must be given; got none for '
                f"{', '.join(left[0])}. Add them, or leave sampling out."
            )
    if not targets.casimirs:
        return None
    varying = {name for name, values in targets.parameters.items() if (values != values[:1]).any()}
    names = sorted(varying & {*family.bracket_parameters})
    brackets = {str(s.bracket.terms()) for s in others if hasattr(s, "bracket")}
    if not others or not (names or len(brackets) > 1 or len(others) < len(systems)):
        return None
    first = meaning(systems[0])
    for system in systems[1:]:
        require_meaning(system, first)
    return first


Meaning: TypeAlias = "tuple[tuple[int, ...], ...]"
"""The leading monomials of C1, C2, ...: generators with the same ones depend continuously on the bracket."""


def meaning(system: Any) -> Meaning:
    """What the names C1, C2, ... mean for a system."""
    if is_top(system):
        return (3, 3), (3, 6), (6, 6)
    from liepoisson.structure.casimirs import leading_monomials

    return leading_monomials(system.bracket) if hasattr(system, "bracket") else ()


def require_meaning(system: Any, wanted: Meaning) -> None:
    """Refuse a system whose Casimirs are other functions than those of the other points."""
    if (found := meaning(system)) != wanted:
        raise ParameterError(
            f"C1, C2, ... must be the same functions at all points where they are prescribed; {system.bracket} has "
            f"{len(found)} with the leading monomials {found}, other points have {len(wanted)} with {wanted}. Leave "
            "out the exceptional value of the parameter (`liepoisson inspect` lists them), or hold the bracket."
        )


def _all_casimirs(system: Any) -> Sequence[str]:
    """The names of the Casimirs of a system."""
    if is_top(system):
        return ("C1", "C2", "C3")
    return tuple(system.functions.casimirs) if hasattr(system, "functions") else ()


def system_functions(system: Any, names: Sequence[str]) -> Functions:
    """The energy and Casimirs of any system, as `TopRows.functions`."""
    known = {"energy": system.functions.energy, **system.functions.casimirs}
    if unknown := [name for name in names if name not in known]:
        raise ParameterError(
            f"{system.name} has the Casimirs {', '.join(system.functions.casimirs)}; got {unknown[0]}."
        )

    def evaluate(x: Array, rows: NDArray[np.int64]) -> tuple[Array, Array]:
        values = np.stack([known[name](x) for name in names], axis=-1)
        return values, np.stack([known[name].gradient(x) for name in names], axis=1)

    return evaluate


@np.errstate(all="ignore")
def project(functions: Functions, wanted: Array, x: Array, length: int = 0) -> tuple[Array, Bools]:
    r"""States near x, shape (row, component), at which functions have the wanted values, shape (row, function).

    By Newton steps of minimum norm, $\delta = -G^+ F$; where that fails, along values that lead from those at x to the
    wanted ones.  Each row is worked on by itself, whatever rows are beside it: its bits do not depend on them.  Fields
    of `length` components may have units of their own; 0: all are in one unit.  Returns the states, and for which of
    them the largest relative residual is below 1e-12.
    """
    found, is_there = _leap(functions, wanted, x, length)
    left = np.flatnonzero(~is_there)
    if left.size:
        there, reached = x[left], is_there[left]
        begin = functions(there, left)[0]
        for stage in range(1, _STAGES + 1):
            values = begin + stage / _STAGES * (wanted[left] - begin) if stage < _STAGES else wanted[left]
            there, reached = _leap(lambda x, rows: functions(x, left[rows]), values, there, length)
        found[left[reached]], is_there[left] = there[reached], reached
    return found, is_there


def _leap(functions: Functions, wanted: Array, x: Array, length: int) -> tuple[Array, Bools]:
    """`project` by Newton's method alone."""
    x = x.copy()
    rows = np.arange(len(x))
    residual = _residual(functions, wanted, x, rows)
    active = rows
    for _ in range(_MOST_STEPS):
        active = active[(residual[active] > 4e-16) & np.isfinite(residual[active])]
        if not active.size:
            break
        values, gradients = functions(x[active], active)
        inverse = _right_inverse(gradients, _units(x[active], length))
        step = (inverse * (wanted[active] - values)[:, None, :]).sum(-1)
        moved, reached = _residual_after(functions, wanted, x, step, active)
        for k in range(1, _MOST_HALVINGS + 1):
            worse = ~(reached < residual[active])
            if not worse.any():
                break
            again = _residual_after(functions, wanted, x, step[worse] / 2**k, active[worse])
            moved[worse], reached[worse] = again
        better = reached < residual[active]
        x[active[better]], residual[active[better]] = moved[better], reached[better]
        active = active[better]
    return x, residual <= _CONVERGED


def _units(x: Array, length: int) -> Array:
    """The sizes of the fields, powers of two, of the shape of x; 1 where they are in one unit."""
    if not length or x.shape[1] == length:
        return np.ones_like(x)
    sizes = np.abs(x).reshape(len(x), -1, length).max(axis=2)
    sizes = np.where(sizes > 0, sizes, sizes.max(axis=1, keepdims=True))
    differ = _ONE_UNIT * sizes.min(axis=1, keepdims=True) < sizes.max(axis=1, keepdims=True)
    return np.repeat(np.ldexp(1.0, np.where(differ, np.frexp(sizes)[1], 0)), length, axis=1)


def _right_inverse(gradients: Array, units: Array) -> Array:
    """The pseudoinverse of each matrix (row, function, component), for components and functions in units of their own.

    Powers of two, and only where they matter: what is in one unit keeps its bits.
    """
    scaled = gradients * units[:, None, :]
    lengths = np.sqrt((scaled**2).sum(-1))
    differ = _ONE_UNIT * lengths.min(axis=-1, keepdims=True) < lengths.max(axis=-1, keepdims=True)
    exponents = np.where(differ, np.frexp(lengths)[1], 0)
    inverse = linear.pinv(np.ldexp(scaled, -exponents[..., None])) * np.ldexp(1.0, -exponents)[:, None, :]
    return np.asarray(units[:, :, None] * inverse)


def _residual_after(
    functions: Functions, wanted: Array, x: Array, step: Array, rows: NDArray[np.int64]
) -> tuple[Array, Array]:
    """Some of the states after a step, and their residuals."""
    moved = x[rows] + step
    return moved, _residual(functions, wanted, moved, rows)


def _residual(functions: Functions, wanted: Array, x: Array, rows: NDArray[np.int64]) -> Array:
    r"""The largest of $|f - c|/(|c| + |x||\nabla f|)$, shape (row,); infinite where it does not exist.

    Where $\sum_i|x_i\,\partial_i f|$ is much smaller than the product of the lengths, it stands in its place.
    """
    values, gradients = functions(x, rows)
    goal = wanted[rows]
    size = np.sqrt((x**2).sum(-1))[:, None] * np.sqrt((gradients**2).sum(-1))
    # the product of whole lengths says nothing where the fields are in units of their own
    own = np.abs(x[:, None, :] * gradients).sum(-1)
    size = np.where(_ONE_UNIT * own < size, own, size) + np.abs(goal)
    relative = np.abs(values - goal) / np.where(size > 0, size, 1.0)
    return np.where(np.isfinite(relative) & np.isfinite(size), relative, np.inf).max(axis=-1)


def liouville(system: Any, n: int, seed: int, casimirs: dict[str, float], energy: float | None) -> Array:
    """States on a leaf with the Liouville measure; NaN where there is no such leaf or energy, shape (n, N)."""
    from liepoisson.leaf.leaf import Leaf

    try:
        return Leaf(system, casimirs).sample(n, seed=seed, energy=energy)
    except LeafError:
        return np.full((n, system.bracket.dimension), np.nan)
