r"""The set where constraints $\phi_1, \dots, \phi_m$ vanish, and whether they are second class there.

They are where the determinant of $C_{ab} = \{\phi_a, \phi_b\}$ does not vanish identically on the set; else there are
functions $\lambda_a$ with $\sum_a\lambda_a\{\phi_a, \phi_b\} = 0$ on it, a combination of first class.

With rational coefficients that is decided: the set is split into components, over the rational numbers and without
those that have no real points, and a polynomial vanishes on one where it lies in the radical of its ideal.  Parameters
are further variables, and components where they obey an equation are left out: parameters are generic.  Where there is
one component, a state of it with det C != 0 is enough, in 50 digits, which Newton's method finds; so are functions of
other kinds tried.

References: Dirac, Canad. J. Math. 2 (1950) 129; [marsden1999], section 8.5.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from random import Random
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.ideals.components import Assumptions, Component, components
from liepoisson.algebra.ideals.groebner import rational_context
from liepoisson.algebra.ideals.limits import Budget, Limits, NotDecidedError
from liepoisson.algebra.ideals.operations import eliminated, radical_contains
from liepoisson.algebra.ideals.polynomial_system import polynomial
from liepoisson.errors import BracketError, ConstraintError, ParameterError
from liepoisson.inputs.deadline import checkpoint

if TYPE_CHECKING:
    from sympy import Expr, Symbol

_DIGITS = 50
_ROUND_OFF = 10.0**-20
"""A determinant below this part of its terms at a random state counts as zero.

What vanishes on the set is of the order of 1e-45 at a state that Newton's method finds, which ends with steps of that
size.  What does not and is less counts as zero, too: constraints are then refused that might do.
"""
_N_POINTS = 10
_N_TRIALS, _N_ITERATIONS = 20, 40
"""Starts of Newton's method, and its iterations: near a solution it doubles the digits, so that some ten are usual."""

Polynomials = list[list[Any]]


@dataclass(frozen=True)
class ConstraintSurface:
    """The set, as far as it is needed for this question.

    Attributes:
        variables: The coordinates.
        functions: The constraints.
        slopes: Their gradients, one row for each.
        brackets: The matrix C.
        entries: Those of the Poisson tensor, by (i, j) with i < j.
    """

    variables: tuple[Symbol, ...]
    functions: tuple[Expr, ...]
    slopes: tuple[tuple[Expr, ...], ...]
    brackets: tuple[tuple[Expr, ...], ...]
    entries: Mapping[tuple[int, int], Expr]

    def check_second_class(self) -> None:
        """Refuse constraints of which a combination is first class, or that contradict or repeat each other.

        Raises:
            ConstraintError: there is such a combination; the error names it.
            BracketError: there is no such set, it was not found, or the question was not decided within its limits.
        """
        budget = Limits().budget()
        try:
            exact = self._polynomials()
            parts = [] if exact is None else exact.parts(budget)
            if len(parts) == 1 and self._at_points() == (True, 1):
                return
            if exact is not None:
                return exact.check(parts, budget)
        except NotDecidedError:
            pass
        holds, tried = self._at_points()
        if holds:
            return
        if not tried:
            raise BracketError(
                "whether the constraints are second class is not decided: no state was found at which they vanish "
                f"and have independent gradients, from {_N_TRIALS} random starts. Correct them, or write them as "
                "polynomials."
            )
        raise ConstraintError("", f"at all {tried} states that were tried", is_proved=False)

    def _polynomials(self) -> _PolynomialSurface | None:
        """The same in polynomials over the rational numbers; None where it is not made of such."""
        from sympy import fraction, together

        flat = [*self.functions, *(c for row in (*self.slopes, *self.brackets) for c in row)]
        names = sorted({str(s) for f in flat for s in f.free_symbols} - {*map(str, self.variables)})
        context = rational_context([*map(str, self.variables), *names])
        try:
            read: list[tuple[Any, Any]] = [
                tuple(polynomial(part, context) for part in fraction(together(f))) for f in flat
            ]
        except ParameterError:
            return None
        m, n = len(self.functions), len(self.variables)
        # of a row the common denominator is left out; where a denominator vanishes there is no bracket
        rows: Polynomials = []
        begin = m
        for width in (*[n] * m, *[m] * m):
            row = read[begin : begin + width]
            common = context.constant(1)
            for _, denominator in row:
                common = common * (denominator / common.gcd(denominator))
            rows.append([numerator * (common / denominator) for numerator, denominator in row])
            begin += width
        denominators = tuple(d for _, d in read if not d.is_constant())
        return _PolynomialSurface(
            tuple(map(str, self.functions)),
            [p for p, _ in read[:m]],
            denominators,
            rows[:m],
            rows[m:],
            frozenset(names),
        )

    # Points of the set

    def _at_points(self) -> tuple[bool, int]:
        """Whether the determinant does not vanish at a state of the set, and how many states were tried."""
        from mpmath import mp

        tried = 0
        with mp.workdps(_DIGITS):
            for start, at in self._points():
                tried += 1
                units = self._units(at)
                C, terms = mp.matrix([[_value(c, at) for c in row] for row in self.brackets]), self._terms(start)
                for a in range(C.rows):
                    for b in range(C.rows):
                        C[a, b] /= units[a] * units[b]
                        terms[a, b] /= units[a] * units[b]
                if abs(mp.det(C)) > _ROUND_OFF * mp.fprod(sum(terms[a, :]) for a in range(C.rows)):
                    return True, tried
                if tried == _N_POINTS:
                    break
        return False, tried

    def _units(self, at: dict[Any, Any]) -> list[Any]:
        """The lengths of the gradients, in which the constraints are of one size; 1 for one that is zero."""
        from mpmath import mp

        return [mp.norm([_value(c, at) for c in row]) or mp.mpf(1) for row in self.slopes]

    def _terms(self, at: dict[Any, Any]) -> Any:
        r"""The sums of the sizes $|\partial_i\phi_a\,J_{ij}\,\partial_j\phi_b|$."""
        from mpmath import mp

        slopes = mp.matrix([[abs(_value(c, at)) for c in row] for row in self.slopes])
        J = mp.zeros(len(self.variables))
        for (i, j), entry in self.entries.items():
            J[i, j] = J[j, i] = abs(_value(entry, at))
        return slopes * J * slopes.T

    def _points(self) -> Iterator[tuple[dict[Any, Any], dict[Any, Any]]]:
        """States at which the constraints vanish and have independent gradients, each after its start.

        By Newton's method with the shortest steps, from random states, with random parameters.
        """
        from mpmath import mp

        random = Random(1)
        names = sorted({s for f in self.functions for s in f.free_symbols} | {*self.variables}, key=str)
        for _ in range(_N_TRIALS):
            checkpoint("states at which the constraints vanish")
            at: dict[Any, Any] = {
                s: mp.mpf(random.uniform(-1, 1) if s in self.variables else random.uniform(0, 1)) for s in names
            }
            start = dict(at)
            for _ in range(_N_ITERATIONS):
                units = self._units(at)
                values = mp.matrix([_value(f, at) / unit for f, unit in zip(self.functions, units, strict=True)])
                slopes = mp.matrix(
                    [[_value(c, at) / unit for c in row] for row, unit in zip(self.slopes, units, strict=True)]
                )
                try:
                    step = slopes.T * mp.lu_solve(slopes * slopes.T, values)
                except (ZeroDivisionError, ValueError):
                    break
                if not all(mp.isfinite(c) and mp.im(c) == 0 for c in step):
                    break
                for k, variable in enumerate(self.variables):
                    at[variable] = at[variable] - step[k]
                if mp.norm(step) < mp.mpf(10) ** (5 - _DIGITS):
                    gram = slopes * slopes.T
                    if mp.det(gram) > _ROUND_OFF * mp.fprod(gram[a, a] for a in range(gram.rows)):
                        yield start, at
                    break


def _value(f: Any, at: dict[Any, Any]) -> Any:
    """The value in 50 digits."""
    from mpmath import mp
    from sympy import Float

    value: Any = f.xreplace({s: Float(at[s], _DIGITS) for s in f.free_symbols if s in at}).evalf(_DIGITS)
    real, imaginary = value.as_real_imag()
    if not (real.is_Float or real.is_Integer or real.is_Rational):
        return mp.nan
    return mp.mpf(str(real)) if imaginary == 0 else mp.mpc(str(real), str(imaginary))


@dataclass(frozen=True)
class _PolynomialSurface:
    """Constraints, gradients and brackets without their denominators."""

    names: tuple[str, ...]
    equations: list[Any]
    denominators: tuple[Any, ...]
    slopes: Polynomials
    brackets: Polynomials
    parameters: frozenset[str]

    def parts(self, budget: Budget) -> list[Component]:
        """The components, at least one."""
        assumptions = Assumptions(self.denominators, is_real=True)
        found = [c for c in components(self.equations, assumptions, budget) if self._is_generic(c, budget)]
        if not found:
            raise BracketError(
                f"the constraints contradict each other: there is no state at which {_listed(self.names)} vanish. "
                "Correct one of them."
            )
        return found

    def check(self, parts: Sequence[Component], budget: Budget) -> None:
        """Refuse dependent gradients, and a combination that is first class, on any component."""
        for part in parts:
            where = "" if len(parts) == 1 else f" on the part {_equations(part)} of the set where they vanish"
            if (dependent := self._relation(self.slopes, part, budget)) is not None:
                raise BracketError(
                    f"wanted constraints with independent gradients; that of {dependent} vanishes"
                    f"{where or ' where they do'}. Leave one out, or give it without its square."
                )
            if (combination := self._relation(self.brackets, part, budget)) is not None:
                raise ConstraintError(combination, where.strip())

    def _is_generic(self, part: Component, budget: Budget) -> bool:
        """Whether the parameters obey no equation."""
        if not self.parameters or not part.equations:
            return True
        others = [name for name in part.basis.names if name not in self.parameters]
        return not eliminated(part.equations, others, budget).polynomials

    def _relation(self, rows: Polynomials, part: Component, budget: Budget) -> str | None:
        r"""A combination $\sum_a\lambda_a\phi_a$ whose row vanishes on a component, as text; None if there is none.

        By elimination without division, each row beside the combination of the constraints that it belongs to.
        """
        m, one = len(rows), part.basis.context.constant(1)
        width = len(rows[0])
        left = [
            [part.basis.remainder(p, budget) for p in row] + [one * int(a == b) for b in range(m)]
            for a, row in enumerate(rows)
        ]
        for k, row in enumerate(left):  # the simplest answer first
            if all(_vanishes(p, part, budget) for p in row[:width]):
                return f"({self.names[k]})"
        for column in range(width):
            pivots = [r for r in left if not _vanishes(r[column], part, budget)]
            if not pivots:
                continue
            pivot = min(pivots, key=lambda r: len(r[column]))
            rest = [r for r in left if r is not pivot]
            left = [self._eliminated(r, pivot, column, part, budget) if r in pivots else r for r in rest]
        if not left:
            return None
        factors = left[0][width:]
        terms = [
            f"({p})*({name})" if p != one else f"({name})" for p, name in zip(factors, self.names, strict=True) if p
        ]
        return " + ".join(terms)

    @staticmethod
    def _eliminated(row: list[Any], pivot: list[Any], column: int, part: Component, budget: Budget) -> list[Any]:
        first, second = pivot[column], row[column]
        found = [part.basis.remainder(first * a - second * b, budget) for a, b in zip(row, pivot, strict=True)]
        common = found[0] * 0
        for p in found:
            common = common.gcd(p)
        return found if not common or common.is_constant() else [p / common for p in found]


def _vanishes(p: Any, part: Component, budget: Budget) -> bool:
    """Whether a polynomial vanishes on a component."""
    return part.basis.contains(p) or (not part.is_irreducible and radical_contains(part.basis, p, budget))


def _equations(part: Component) -> str:
    return ", ".join(f"{p} = 0" for p in part.equations[:3])


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names) if len(names) < 2 else f"{', '.join(names[:-1])} and {names[-1]}"
