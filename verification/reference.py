r"""Reference orbits in as many digits as are asked for: a Taylor series in the arithmetic of python-flint's `arb`.

With $\omega = I^{-1}\ell$, the equations of a top as they are printed,

$$\dot\ell = \ell\times\omega + \alpha\times a + \beta\times b,\quad
  \dot\alpha = \alpha\times\omega + \epsilon\,\beta\times a,\quad \dot\beta = \beta\times\omega,$$

and the tangent equations, their derivative, give each coefficient of the power series from those before it.  Nothing
is shared with the integrators under test: neither code nor arithmetic.  The parameters are the doubles that those
use, taken as exact numbers, and so are the starts.

The digits of a result are measured by computing it twice, with other precision and order (`agreed_digits`).  Balls of
`arb` would bound the round-off rigorously, but over many steps they grow far faster than errors do; so each step
starts from their centres.

`python verification/reference.py` writes verification/reference_orbits.json.
"""

from __future__ import annotations

import json
import math
from collections.abc import Generator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from flint import arb, arb_mat, ctx

import liepoisson as lp
from problems import NONLINEAR, TOPS, Array, first_tangents, starts

FILE = Path(__file__).with_name("reference_orbits.json")
DIGITS, STRICT_DIGITS = 60, 80
"""Working precision in decimal digits; a chaotic orbit loses about 6 of them until t = 100."""
KEPT_DIGITS = 40
ORBIT_TIMES = (20.0, 100.0)
N_ORBITS = 3

Vector: TypeAlias = list[Any]
"""Numbers of type `arb`: a state of 9 components, or a state and a tangent vector, 18."""


@contextmanager
def decimal_digits(digits: int) -> Generator[None]:
    """A `with` block in which flint computes with so many decimal digits and a few to spare."""
    before = ctx.prec
    ctx.prec = math.ceil(math.log2(10) * digits) + 16
    try:
        yield
    finally:
        ctx.prec = before


def flow(
    field: lp.fields.TopField,
    x0: Sequence[Any],
    times: Sequence[float],
    *,
    digits: int = DIGITS,
    order: int | None = None,
) -> list[Vector]:
    """States at increasing times after 0, from the state at time 0.

    Args:
        field: The top.
        x0: State of 9 components, or state and tangent vector, 18; doubles or `arb`.
        times: Times, positive and increasing.
        digits: Decimal digits of the arithmetic; the truncation error is kept below them, step by step.
        order: Of the series; by default near the one that costs least.

    Returns:
        One vector for each time.
    """
    order = order or math.ceil(1.15 * digits) + 2
    with decimal_digits(digits):
        top, tolerance = _Top(field), float(f"1e-{digits}")
        value, now, found = [arb(c) for c in x0], arb(0), []
        for time in times:
            left = arb(time) - now
            while left > 0:
                series = top.series(value, order)
                h = _step(series, tolerance)
                h = left if left < 1.01 * h else arb(h)
                value = [_horner(coefficients, h).mid() for coefficients in series]
                left = (left - h).mid()
            now = arb(time)
            found.append(value)
    return found


class _Top:
    """The recursion for the power series of one top, in the current precision."""

    def __init__(self, field: lp.fields.TopField) -> None:
        self.moments = [arb(c) for c in field.inertia]
        self.a, self.b = [arb(c) for c in field.a], [arb(c) for c in field.b]
        self.epsilon = arb(field.epsilon)

    def series(self, value: Vector, order: int) -> list[Vector]:
        """Coefficients 0..order of each component of the solution through `value`."""
        series = [[c] for c in value]
        groups = range(0, len(value), 9)  # the state, and the tangent vector if there is one
        omega: list[Vector] = [[] for _ in range(3 * len(groups))]
        for k in range(order):
            for g, first in enumerate(groups):
                for i in range(3):
                    omega[3 * g + i].append(series[first + i][k] / self.moments[i])
            # Sums over j of x_m^(j) omega_n^(k-j) for all m and n: one product of matrices; most entries are used.
            sums = (arb_mat(series) * arb_mat([[w[k - j] for w in omega] for j in range(k + 1)])).tolist()
            rate = self._rate([row[k] for row in series], sums)
            for row, r in zip(series, rate, strict=True):
                row.append(r / (k + 1))
        return series

    def _rate(self, x: Vector, sums: list[Vector]) -> Vector:
        """Coefficient k of the derivative, from coefficient k of the state and the sums of products."""
        rate: Vector = []
        for first in range(0, len(x), 9):
            for row in (first, first + 3, first + 6):
                rate += _cross_of_sums(sums, row % 9, first // 3)
                if first:  # the product rule: d(u x omega) = u x d omega + du x omega
                    rate[-3:] = _add(rate[-3:], _cross_of_sums(sums, row, 0))
            alpha, beta = x[first + 3 : first + 6], x[first + 6 : first + 9]
            torque = _add(_cross(alpha, self.a), _cross(beta, self.b))
            rate[first : first + 3] = _add(rate[first : first + 3], torque)
            twist = [self.epsilon * c for c in _cross(beta, self.a)]
            rate[first + 3 : first + 6] = _add(rate[first + 3 : first + 6], twist)
        return rate


def _cross(u: Vector, v: Vector) -> Vector:
    return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]


def _cross_of_sums(sums: list[Vector], row: int, column: int) -> Vector:
    """The coefficient of u x omega, for u that begins at `row` and omega at `column` of the table of products."""
    pairs = ((1, 2), (2, 0), (0, 1))
    return [sums[row + i][column + j] - sums[row + j][column + i] for i, j in pairs]


def _add(u: Vector, v: Vector) -> Vector:
    return [p + q for p, q in zip(u, v, strict=True)]


def _step(series: list[Vector], tolerance: float) -> float:
    """The longest step for which the last two terms are below tolerance times the first, as doubles.

    Logarithms of sizes, since coefficients of 80 digits would underflow.
    """
    sizes = [_log_size([row[k] for row in series]) for k in (0, -2, -1)]
    order = len(series[0]) - 1
    bounds = [
        (math.log(tolerance) + sizes[0] - size) / k for k, size in zip((order - 1, order), sizes[1:], strict=True)
    ]
    return math.exp(min([*bounds, math.log(1e3)]))  # an equilibrium allows any step


def _log_size(vector: Vector) -> float:
    total = sum((abs(c) for c in vector), arb(0)).mid()
    return float(total.log()) if total > 0 else -1e300


def _horner(coefficients: Vector, h: Any) -> Any:
    value = coefficients[-1]
    for c in coefficients[-2::-1]:
        value = value * h + c
    return value


def as_two_doubles(values: list[Vector]) -> tuple[Array, Array]:
    """Numbers as sums of two doubles each, 32 digits: their nearest doubles and what is left."""
    high = np.array([[float(c.mid()) for c in row] for row in values])
    with decimal_digits(STRICT_DIGITS):
        low = np.array(
            [[float((c - arb(h)).mid()) for c, h in zip(*rows, strict=True)] for rows in zip(values, high, strict=True)]
        )
    return high, low


def agreed_digits(first: Vector, second: Vector) -> int:
    """Decimal digits to which two vectors agree, relative to the larger component of either."""
    with decimal_digits(STRICT_DIGITS):
        size = max(float(abs(c).mid()) for c in second)
        distance = max((abs(p - q).mid() for p, q in zip(first, second, strict=True)), key=float)
        return (
            STRICT_DIGITS if not distance > 0 else math.floor(math.log10(size) - float(distance.log()) / math.log(10))
        )


def orbit_record(top: str, x0: Array, tangent: Array) -> dict[str, Any]:
    """One reference orbit as plain data: doubles that go in, decimal strings that come out, digits that are right."""
    field = TOPS[top].field()
    assert isinstance(field, lp.fields.TopField)
    start = [*x0.tolist(), *tangent.tolist()]
    coarse = flow(field, start, ORBIT_TIMES, digits=DIGITS)
    strict = flow(field, start, ORBIT_TIMES, digits=STRICT_DIGITS, order=STRICT_DIGITS)
    return {
        "top": top,
        "inertia": field.inertia,
        "a": field.a,
        "b": field.b,
        "epsilon": field.epsilon,
        "state": x0.tolist(),
        "tangent": tangent.tolist(),
        "at": [
            {
                "t": time,
                "state": decimals(exact[:9]),
                "state digits": min(agreed_digits(other[:9], exact[:9]), KEPT_DIGITS),
                "tangent": decimals(exact[9:]),
                "tangent digits": min(agreed_digits(other[9:], exact[9:]), KEPT_DIGITS),
            }
            for time, other, exact in zip(ORBIT_TIMES, coarse, strict, strict=True)
        ],
    }


def decimals(vector: Vector) -> list[str]:
    """Each number with the digits that are kept."""
    with decimal_digits(STRICT_DIGITS):
        return [c.mid().str(KEPT_DIGITS, radius=False) for c in vector]


def write_orbits(path: Path = FILE) -> None:
    """Write the reference orbits; a test recomputes one of them."""
    orbits = [
        orbit_record(top, x0, tangent)
        for top in NONLINEAR
        for x0, tangent in zip(starts(top, N_ORBITS), first_tangents(N_ORBITS), strict=True)
    ]
    content = {
        "what": "Reference orbits and tangent vectors of two twisted tops, x = (l, alpha, beta), dimensionless. What "
        "goes in are doubles; digits are those to which two precisions and orders agree.",
        "made by": "python verification/reference.py",
        "precisions": [DIGITS, STRICT_DIGITS],
        "orbits": orbits,
    }
    path.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    write_orbits()
