r"""Whether a sum of terms vanishes at a point, in as many digits as the numbers in it need.

With all numbers that occur in the evaluation between $10^{-H}$ and $10^H$, numerators and denominators among them, the
sum is computed in 50 + 2H digits: terms may differ by the factor $10^{2H}$, and an even function of a number of size
$10^{-H}$ by $10^{-2H}$ from its value at 0.  Below $10^{-(30 + 2H)}$ of its terms, multiplied out, it counts as zero,
so that 20 digits may be lost.  Nothing is compared with a number of fixed size: units do not matter.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from liepoisson.errors import ParameterError
from liepoisson.inputs.deadline import checkpoint
from liepoisson.inputs.names import ELEMENTARY_FUNCTIONS

if TYPE_CHECKING:
    from sympy import Expr

_DIGITS, _LOST = 50, 20
_MOST_DIGITS = 10_000
"""A point that needs more is passed over like a pole; exponents in formulas have at most three digits."""

HAVE_VALUES = f"be defined, and not beyond 10^({_MOST_DIGITS // 2}) or its inverse,"
"""What functions must do at the points where they are tried, in messages."""


def vanishes_at(terms: Iterable[Expr], point: Mapping[Any, Any]) -> bool | None:
    """Whether a sum counts as zero at a point; None where a term is not finite.

    Where functions are not real they are continued analytically.

    Args:
        terms: The terms.
        point: Rational numbers by symbols, or by their names.
    """
    from mpmath import mp

    if (found := decimals(terms, point)) is None:
        return None
    values, sizes, digits = found
    with mp.workdps(digits):
        return bool(abs(sum(values)) <= round_off(digits) * sum(sizes))


def vanishes_at_all(terms: Iterable[Expr], points: Iterable[Mapping[Any, Any]]) -> bool | None:
    """Whether a sum counts as zero at all points where it has a value; None where it has none."""
    listed, found = list(terms), None
    for point in points:
        if (vanishes := vanishes_at(listed, point)) is False:
            return False
        found = found or vanishes
    return found


def refuse_sizes(functions: Iterable[Any], name: str) -> None:
    r"""Refuse $\sqrt{p^2} = |p|$ among functions that are tried at points, which do not tell of the other sign of p.

    Raises:
        ParameterError: a root of even order has a base with a factor of even multiplicity.
    """
    from sympy import PolynomialError, Pow, sqf_list

    roots = {e for f in functions for e in f.atoms(Pow) if e.exp.is_Rational and e.exp.q % 2 == 0}
    for root in sorted(roots, key=str):
        checkpoint("roots of squares")
        try:
            factors = [factor for part in root.base.as_numer_denom() for factor in sqf_list(part)[1]]
        except PolynomialError:
            continue
        if any(multiplicity % 2 == 0 and factor.free_symbols for factor, multiplicity in factors):
            raise ParameterError(
                f"{name}: wanted functions without roots of squares, since what is tried where sqrt(p^2) is p is not "
                f"known where it is -p; got {root!s:.60}; write it without the root"
            )


def round_off(digits: int) -> Any:
    """Below which part of its terms a sum of so many digits counts as zero."""
    from mpmath import mpf

    return mpf(10) ** (_LOST - digits)


def decimals(terms: Iterable[Any], point: Mapping[Any, Any]) -> tuple[list[Any], list[Any], int] | None:
    """Terms at a point as numbers of mpmath, their sizes multiplied out, and the digits; None: one is not finite."""
    from mpmath import mp

    checkpoint("values of formulas in decimals")
    listed, at = list(terms), {str(symbol): value for symbol, value in point.items()}
    try:
        with mp.workdps(15):
            rough = _Evaluation(mp, at)
            for term in listed:
                rough.value(term)
        digits = _DIGITS + 2 * rough.size
        with mp.workdps(digits):
            exact = _Evaluation(mp, at)
            values, sizes = [exact.value(term) for term in listed], [exact.sizes[term] for term in listed]
            return (values, sizes, digits) if all(map(mp.isfinite, values)) else None
    except (ZeroDivisionError, OverflowError, ValueError):  # a pole, or a number beyond all sizes
        return None


class _Evaluation:
    """Values of expressions at one point.

    Attributes:
        sizes: For each expression the sum of the sizes of its terms, multiplied out.
        size: H, of all numbers so far.
    """

    def __init__(self, mp: Any, point: Mapping[str, Any]) -> None:
        self._mp, self._point, self._known = mp, point, dict[Any, Any]()
        self.sizes: dict[Any, Any] = {}
        self.size = 0

    def value(self, e: Any) -> Any:
        """The value; it is kept for the next time."""
        if e not in self._known:
            self._known[e] = found = self._atom(e) if not e.args else self._combined(e)
            if not e.is_Add:  # cancels, and its terms are seen
                self._see(found)
            self.sizes[e] = self._size(e, abs(found))
        return self._known[e]

    def _size(self, e: Any, own: Any) -> Any:
        if e.is_Add:
            return self._mp.fsum(self.sizes[part] for part in e.args)
        if e.is_Mul:
            return self._mp.fprod(self.sizes[part] for part in e.args)
        if e.is_Pow and self._known[e.base]:
            return own * self.sizes[e.base] / abs(self._known[e.base])
        return own

    def _see(self, number: Any) -> None:
        if number and self._mp.isfinite(number):
            # by the binary exponent: a logarithm would be computed in all digits
            self.size = max(self.size, abs(int(self._mp.mag(number))) * 3 // 10 + 1)
            if 2 * self.size > _MOST_DIGITS:
                raise OverflowError

    def _atom(self, e: Any) -> Any:
        number = self._point[str(e)] if e.is_Symbol else e
        if not number.is_Rational:
            return self._other(e)
        p, q = self._mp.mpf(int(number.p)), self._mp.mpf(int(number.q))
        self._see(p)
        self._see(q)
        return p / q

    def _combined(self, e: Any) -> Any:
        name = e.func.__name__
        if not (e.is_Add or e.is_Mul or e.is_Pow or name in ELEMENTARY_FUNCTIONS):
            return self._other(e)
        values = [self.value(part) for part in e.args]
        if e.is_Add:
            return self._mp.fsum(values)
        if e.is_Mul:
            return self._mp.fprod(values)
        if e.is_Pow:
            return values[0] ** (int(e.exp) if e.exp.is_Integer else values[1])
        return getattr(self._mp, name)(*values)

    def _other(self, e: Any) -> Any:
        """The value by SymPy's own arithmetic."""
        value = e.xreplace({s: self._point[str(s)] for s in e.free_symbols}).evalf(self._mp.dps)
        real, imaginary = value.as_real_imag()
        if not (real.is_number and imaginary.is_number):
            return self._mp.nan
        return self._mp.mpf(str(real)) if imaginary == 0 else self._mp.mpc(str(real), str(imaginary))
