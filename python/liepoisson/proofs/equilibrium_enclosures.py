r"""Equilibria of polynomial systems, proved: on a level of the Casimirs, by Krawczyk's operator.

On a level $C = c$ the N equations $f(x) = 0$ depend on each other, as $\nabla C_k\cdot f = 0$. Let P be a matrix of as
many rows as a level has dimensions, and $F = (Pf, C - c)$, as many equations as unknowns. Every equilibrium of it
is a zero of F; and a zero of F at which the matrix M of the rows of P and the gradients of the Casimirs is regular is
an equilibrium, since there $Mf = 0$. At an equilibrium $\nabla C\cdot Df = 0$, so in the coordinates Mx the derivative
of f has zeros in the rows of the Casimirs, and the first block of $M\,Df\,M^{-1}$ has the eigenvalues of the flow
linearised on the level.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from liepoisson import _core
from liepoisson.errors import EnclosureError, ParameterError
from liepoisson.formula.scalars import TIME_LIMIT, as_count
from liepoisson.inputs.arrays import Array, ReadOnlyArrays
from liepoisson.inputs.calls import shows_progress
from liepoisson.portable import linear
from liepoisson.proofs.box import Box, BoxLike
from liepoisson.proofs.interval_checker import core_terms
from liepoisson.proofs.polynomial_field import PolynomialField, Terms
from liepoisson.proofs.rigorous import (
    PRECISION,
    Arithmetic,
    Means,
    as_ball,
    box_of_states,
    equations_and_constants,
    level_values,
    name_of,
    one_state,
)
from liepoisson.streams import generator

if TYPE_CHECKING:
    from flint import arb, arb_mat
    from numpy.typing import NDArray

    from liepoisson.model.system import System
    from liepoisson.proofs.balls.field import BallField

_NEWTON_STEPS = 30
_RADII = tuple(10.0**-k for k in range(1, 15))
"""Half-widths of the boxes that are tried, in units of the state."""
_DIRECTIONS = 2**10
"""Denominator of the entries of P."""
_CUT = 0.4873
"""Where a box is cut: not in the middle, where zeros of symmetric systems like to be."""


@dataclass(frozen=True, eq=False)
class EquilibriumEnclosure(ReadOnlyArrays):
    """An equilibrium that was proved to exist, and to be the only one of its level in a box.

    Example:
        >>> top = lp.catalog.system("lagrange")
        >>> upright = lp.proofs.prove_equilibrium(top, [0, 0, 0, 0, 0, 1], level={"C1": 0, "C2": 1})
        >>> upright.state.contains([0, 0, 0, 0, 0, 1]), bool(upright.eigenvalues_real.lower[0] > 0.99)
        (True, True)

    Attributes:
        system: The name of the system.
        level: The exact values of the Casimirs, by name.
        state: A box that contains it, shape (N,).
        unique_within: A larger box in which it is the only equilibrium of the level.
        eigenvalues_real: Boxes of the real parts of the eigenvalues of the flow linearised on the level, shape (d,)
            with d the dimension of the level, the largest first.
        eigenvalues_imaginary: Boxes of their imaginary parts.
        is_simple: Whether a box contains one eigenvalue only; boxes that overlap contain as many as they are.
        arithmetic: "intervals" or "balls"; eigenvalues are always enclosed in balls.
    """

    system: str
    level: Mapping[str, Fraction]
    state: Box
    unique_within: Box
    eigenvalues_real: Box
    eigenvalues_imaginary: Box
    is_simple: NDArray[np.bool_]
    arithmetic: Arithmetic

    def __repr__(self) -> str:
        return (
            f"<EquilibriumEnclosure of {self.system!r}{on_level(self.level)}: exactly one in a box of widths "
            f"{self.unique_within.width.min():.2g}, known to {self.state.width.max():.2g}; largest real part "
            f"{self.eigenvalues_real[:1]!r}>"
        )


@dataclass(frozen=True, eq=False)
class EquilibriaEnclosure(ReadOnlyArrays):
    """All equilibria of a level in a box.

    Example:
        >>> system = lp.catalog.system("henon-heiles")
        >>> found = lp.proofs.enclose_equilibria(system, ([-0.5, 0.5, -1, -1], [0.5, 2, 1, 1]))
        >>> [one.state.contains([0, 1, 0, 0]) for one in found.equilibria], found.is_complete
        ([True], True)

    Attributes:
        system: The name of the system.
        level: The exact values of the Casimirs, by name.
        box: Where they were searched.
        equilibria: Those that were proved; outside of `undecided` there are no others in the box.
        undecided: Boxes of which nothing is known: there may be none, one, or a whole family.
        arithmetic: "intervals" or "balls".
    """

    system: str
    level: Mapping[str, Fraction]
    box: Box
    equilibria: tuple[EquilibriumEnclosure, ...]
    undecided: tuple[Box, ...]
    arithmetic: Arithmetic

    @property
    def is_complete(self) -> bool:
        """Whether these are proved to be all equilibria of the level in the box."""
        return not self.undecided

    def __repr__(self) -> str:
        left = "these are all" if self.is_complete else f"{len(self.undecided)} boxes are undecided"
        return (
            f"<EquilibriaEnclosure of {self.system!r}{on_level(self.level)}: {len(self.equilibria)} in the box, {left}>"
        )


def on_level(level: Mapping[str, Fraction]) -> str:
    """A level in words; doubles as such."""
    shown = (f"{name} = {v if v.denominator < 10_000 else float(v)}" for name, v in level.items())
    return f" on {', '.join(shown)}" if level else ""


@shows_progress
def prove_equilibrium(
    system: System | PolynomialField,
    guess: BoxLike,
    *,
    level: Mapping[str, float | str] | None = None,
    arithmetic: Arithmetic = "intervals",
    precision: int = PRECISION,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> EquilibriumEnclosure:
    """Prove that near a guess there is exactly one equilibrium on a level of the Casimirs, and enclose its eigenvalues.

    Newton's method improves the guess, then Krawczyk's operator proves: boxes from a tenth of the size of the state
    downward are tried. Without Casimirs, as for canonical systems, the level is the whole phase space.

    Example:
        >>> top = lp.System(lp.so(3) @ lp.semidirect(2), "l1^2/2 + l2^2/4 + l3^2/6 + alpha3")
        >>> upright = lp.proofs.prove_equilibrium(top, [0, 0, 0, 0, 0, 0.99], level={"C1": 0, "C2": 1})
        >>> upright.state.contains([0, 0, 0, 0, 0, 1]), upright.eigenvalues_real[0].contains(1)
        (True, True)

    Args:
        system: A system whose equations and Casimirs are polynomials with rational coefficients.
        guess: A state near it, shape (N,).
        level: Exact values of the Casimirs, by name; by default the doubles nearest to those of the guess.
        arithmetic: "intervals" of doubles, in the compiled core, or "balls" of any precision, by Arb.
        precision: Bits of the balls, 53 to 10,000.
        time_limit: Seconds that the run may take.
        progress: Called with the fraction that is done.

    Raises:
        EnclosureError: no box is mapped into itself: there is no equilibrium nearby, or it is not isolated on its
            level, or the Casimirs depend on each other there.
        ParameterError: the system is not polynomial or has symbols, the level is not as it must be, or a number is not
            finite.
        ShapeError: the guess has another shape.

    References: [krawczyk1969]; [neumaier1990].
    """
    field = equations_and_constants(system)
    means = Means.of(arithmetic, precision=precision, time_limit=time_limit, progress=progress)
    state, names = one_state(guess, field, "guess"), _casimirs(field)
    values = level_values(level, field, names, state.tolist())
    problem = _Problem(field, values, means)
    state = problem.improved(state)
    size = float(np.abs(state).max(initial=0.0)) or 1.0
    for radius in _RADII:
        around = Box.around(state, radius * size)
        if (found := problem.only_zero(around)) is not None:
            return problem.result(name_of(system), found, around)
    raise EnclosureError(
        f"equilibrium: wanted exactly one near {np.round(state, 6).tolist()}{on_level(values)}; Newton's operator maps "
        "no box into itself: there is none, or it is not isolated on its level (a family), or the gradients of the "
        "Casimirs depend on each other there. Try another guess or level, such as those of lp.equilibria"
    )


@shows_progress
def enclose_equilibria(
    system: System | PolynomialField,
    box: BoxLike,
    *,
    level: Mapping[str, float | str] | None = None,
    max_boxes: int = 100_000,
    arithmetic: Arithmetic = "intervals",
    precision: int = PRECISION,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> EquilibriaEnclosure:
    """Find all equilibria of a level of the Casimirs in a box: each is proved, and so is that there are no others.

    The box is cut until Krawczyk's operator decides each part. Families of equilibria, and those at which the Casimirs
    depend on each other, stay undecided.

    Example:
        >>> system = lp.catalog.system("henon-heiles")
        >>> found = lp.proofs.enclose_equilibria(system, ([-2, -2, -2, -2], [2, 2, 2, 2]))
        >>> len(found.equilibria), found.is_complete  # the well and three saddles
        (4, True)

    Args:
        system: A system whose equations and Casimirs are polynomials with rational coefficients.
        box: Where they are searched: a `Box`, or a tuple of lower and upper bounds, shape (N,).
        level: Exact values of the Casimirs, by name; must be given if there are any.
        max_boxes: How many boxes are looked at before the rest is left undecided.
        arithmetic: "intervals" of doubles, in the compiled core, or "balls" of any precision, by Arb, which is slow.
        precision: Bits of the balls, 53 to 10,000.
        time_limit: Seconds that the run may take.
        progress: Called with the fraction that is done.

    Raises:
        EnclosureError: the time limit has passed.
        ParameterError: the system is not polynomial or has symbols, the level is not as it must be, or the box is
            empty.
        ShapeError: the box has another shape.

    References: [krawczyk1969]; [neumaier1990].
    """
    field = equations_and_constants(system)
    means = Means.of(arithmetic, precision=precision, time_limit=time_limit, progress=progress)
    region, most = box_of_states(box, field), as_count(max_boxes, "max_boxes", least=1)
    names = _casimirs(field)
    if level is None and names:
        raise ParameterError(
            f"level: wanted values of {', '.join(names)}, as equilibria are isolated on levels of the Casimirs only; "
            f"got none; write level={{{', '.join(f'{n!r}: ...' for n in names)}}}"
        )
    values = level_values(level, field, names, region.midpoint.tolist())
    problem = _Problem(field, values, means)
    zeros, undecided = problem.zeros(region, most)
    found: list[EquilibriumEnclosure] = []
    for zero, around in zeros:
        if problem.is_certain(zero):
            found.append(problem.result(name_of(system), zero, around))
        else:
            undecided.append(zero)
    rest = tuple(one for one in undecided if problem.may_be_at_rest(one))
    return EquilibriaEnclosure(name_of(system), values, region, tuple(found), rest, means.arithmetic)


def _casimirs(field: PolynomialField) -> list[str]:
    return [name for name in field.constants if name != "H"]


class _Problem:
    """Zeros of F = (P f, C - c)."""

    def __init__(self, field: PolynomialField, values: Mapping[str, Fraction], means: Means) -> None:
        from liepoisson.proofs.balls.field import BallField, working

        self.field, self.values, self.means, self.n = field, values, means, len(field.names)
        self.casimirs = [field.constants[name] for name in values]
        plain = PolynomialField(field.names, field.rates, {name: field.constants[name] for name in values}, ())
        with working(means.precision):
            self.balls = BallField(plain)
        self.directions = self._any_directions()

    @property
    def dimension(self) -> int:
        """The dimension of the level."""
        return self.n - len(self.values)

    def _any_directions(self) -> NDArray[np.int64]:
        """P for all of the phase space, times its denominator."""
        if not self.values:
            return np.eye(self.n, dtype=np.int64) * _DIRECTIONS
        rng = generator(0)
        return rng.integers(-8, 9, (self.dimension, self.n)) * (_DIRECTIONS // 8)

    def _directions_at(self, state: Array) -> NDArray[np.int64]:
        """P for the surroundings of a state: nearly tangent to the level."""
        from liepoisson.proofs.balls.field import working

        if not self.values:
            return self.directions
        with working(self.means.precision):
            rows = self.balls.gradients(_exact(state)).tolist()
        _, _, basis = linear.svd(np.array([[float(e.mid()) for e in row] for row in rows], float))
        return np.rint(basis[len(self.values) :] * _DIRECTIONS).astype(np.int64)

    def improved(self, guess: Array) -> Array:
        """Newton's method, without proof, from a guess; the directions follow it."""
        from flint import arb, arb_mat

        from liepoisson.proofs.balls.field import as_column, working

        state = guess
        with working(self.means.precision):
            x = _exact(state)
            for _ in range(_NEWTON_STEPS):
                self.directions = self._directions_at(state)
                system = self._system()
                try:
                    change = arb_mat(system.jacobian(x)).mid().solve(as_column(system.rates(x))).entries()
                except ZeroDivisionError:
                    break
                x = [arb((a - b.mid()).mid()) for a, b in zip(x, change, strict=True)]
                before, state = state, np.array([float(c) for c in x], float)
                if not np.all(np.isfinite(state)):
                    return guess
                if np.abs(state - before).max(initial=0.0) <= 1e-15 * (np.abs(state).max(initial=0.0) or 1.0):
                    break
        self.directions = self._directions_at(state)
        return state

    def rows(self) -> tuple[Terms, ...]:
        """The polynomials of F."""
        along = (
            _combined([(Fraction(int(p), _DIRECTIONS), rate) for p, rate in zip(row, self.field.rates, strict=True)])
            for row in self.directions
        )
        one = {(0,) * self.n: Fraction(1)}
        off = (
            _combined([(Fraction(1), c), (-v, one)]) for c, v in zip(self.casimirs, self.values.values(), strict=True)
        )
        return (*along, *off)

    def _system(self) -> BallField:
        from liepoisson.proofs.balls.field import BallField

        return BallField(PolynomialField(self.field.names, self.rows(), {}, ()))

    def only_zero(self, box: Box) -> Box | None:
        """The narrow box of the only zero in a box that is certainly an equilibrium; none if that is not proved."""
        zeros, _ = self.zeros(box, 1)
        if len(zeros) == 1 and self.is_certain(zeros[0][0]):
            return zeros[0][0]
        return None

    def zeros(self, box: Box, most: int) -> tuple[list[tuple[Box, Box]], list[Box]]:
        """Narrow boxes with one zero each and the boxes in which it is alone; and boxes of which nothing is known."""
        if self.means.arithmetic == "balls":
            from liepoisson.proofs.balls.field import working
            from liepoisson.proofs.balls.zeros import zeros

            with working(self.means.precision):
                return zeros(self._system(), box, most, _CUT, self.means)
        found = _core.enclose_equilibria(
            [core_terms(row) for row in self.rows()],
            box.lower,
            box.upper,
            most,
            self.means.time_limit,
            self.means.progress,
        )

        def boxes(name: str) -> list[Box]:
            sides = (found[f"{name}lower"].reshape(-1, self.n), found[f"{name}upper"].reshape(-1, self.n))  # type: ignore[literal-required]
            return [Box(a, b) for a, b in zip(*sides, strict=True)]

        return list(zip(boxes(""), boxes("unique_"), strict=True)), boxes("undecided_")

    def may_be_at_rest(self, box: Box) -> bool:
        """Whether no component of f and no Casimir rules out an equilibrium of the level in a box."""
        from liepoisson.proofs.balls.field import ball, working

        with working(self.means.precision):
            x = _wide(box)
            off = [v - ball(c) for v, c in zip(self.balls.constants(x), self.values.values(), strict=True)]
            return all(v.contains(0) for v in (*self.balls.rates(x), *off))

    def _coordinates(self, x: Sequence[arb]) -> arb_mat:
        """M."""
        from flint import arb_mat, fmpq

        p = [[fmpq(int(e), _DIRECTIONS) for e in row] for row in self.directions]
        return arb_mat([*p, *(self.balls.gradients(x).tolist() if self.values else [])])

    def is_certain(self, box: Box) -> bool:
        """Whether zeros of F in a box are equilibria."""
        from liepoisson.proofs.balls.field import working

        with working(self.means.precision):
            try:
                self._coordinates(_wide(box)).inv()
            except ZeroDivisionError:
                return False
        return True

    def result(self, name: str, zero: Box, around: Box) -> EquilibriumEnclosure:
        """What was proved, with the eigenvalues."""
        from flint import arb_mat

        from liepoisson.proofs.balls.field import working
        from liepoisson.proofs.rigorous import eigenvalue_boxes

        d = self.dimension
        with working(self.means.precision):
            x = _wide(zero)
            coordinates = self._coordinates(x)
            whole = coordinates * self.balls.jacobian(x) * coordinates.inv()
            real, imaginary, simple = eigenvalue_boxes(arb_mat([row[:d] for row in whole.tolist()[:d]]))
        return EquilibriumEnclosure(
            name, dict(self.values), zero, around, real, imaginary, simple, self.means.arithmetic
        )


def _combined(parts: Sequence[tuple[Fraction, Terms]]) -> Terms:
    """A linear combination of polynomials."""
    total: Terms = {}
    for factor, terms in parts:
        for m, c in terms.items():
            total[m] = total.get(m, Fraction(0)) + factor * c
    return {m: c for m, c in total.items() if c}


def _exact(state: Array) -> list[arb]:
    from flint import arb

    return [arb(float(v)) for v in state]


def _wide(box: Box) -> list[arb]:
    return [as_ball(float(a), float(b)) for a, b in zip(box.lower, box.upper, strict=True)]
