"""Elementary functions of arrays with the same bits on every processor, under NumPy's names.

NumPy computes them by vector instructions of the processor at hand, or by the system's library, which has a way of its
own for processors with fused multiply-add; last digits differ.  These are the core's (`libm`, FreeBSD's msun in Rust).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from liepoisson import _core

_BY_PRODUCTS = 8
"""Whole exponents up to this are products: as accurate within their number of units in the last place, and faster."""


def _one(name: str, x: ArrayLike) -> Any:
    array = _real(x)
    values = _core.elementary_of_one(name, np.ascontiguousarray(array).reshape(-1))
    return values.reshape(array.shape)[()]


def _two(name: str, x: ArrayLike, y: ArrayLike) -> Any:
    one, other = np.broadcast_arrays(_real(x), _real(y))
    flat = (np.ascontiguousarray(each).reshape(-1) for each in (one, other))
    return _core.elementary_of_two(name, *flat).reshape(one.shape)[()]


def _real(x: ArrayLike) -> Any:
    if np.iscomplexobj(x):
        raise TypeError("the core has this function for real numbers")
    return np.asarray(x, dtype=np.float64)


def of_parts(real: Any, imaginary: Any) -> Any:
    """A complex number or array; 1j times an infinite number, or a zero with a sign, would be something else."""
    result = np.empty(np.broadcast_shapes(np.shape(real), np.shape(imaginary)), dtype=np.complex128)
    result.real, result.imag = real, imaginary
    return result[()]


def exp(x: ArrayLike) -> Any:
    """The exponential function; of complex numbers, too."""
    array: Any = np.asarray(x)
    if np.iscomplexobj(array):
        half = exp(0.5 * array.real)  # its square may overflow where the products do not
        size, (cosine, sine) = exp(array.real), (cos(array.imag), sin(array.imag))
        with np.errstate(invalid="ignore", over="ignore"):
            real, imaginary = (
                np.where(np.isfinite(size), size * part, np.where(part == 0, part, half * (half * part)))
                for part in (cosine, sine)
            )
        return of_parts(real, imaginary)
    return _one("exp", array)


def exp2(x: ArrayLike) -> Any:
    """Powers of two."""
    return _one("exp2", x)


def expm1(x: ArrayLike) -> Any:
    """The exponential function less one."""
    return _one("expm1", x)


def log(x: ArrayLike) -> Any:
    """The natural logarithm."""
    return _one("log", x)


def log2(x: ArrayLike) -> Any:
    """The logarithm to base two."""
    return _one("log2", x)


def log10(x: ArrayLike) -> Any:
    """The logarithm to base ten."""
    return _one("log10", x)


def log1p(x: ArrayLike) -> Any:
    """The natural logarithm of 1 + x."""
    return _one("log1p", x)


def sin(x: ArrayLike) -> Any:
    """The sine."""
    return _one("sin", x)


def cos(x: ArrayLike) -> Any:
    """The cosine."""
    return _one("cos", x)


def tan(x: ArrayLike) -> Any:
    """The tangent."""
    return _one("tan", x)


def arcsin(x: ArrayLike) -> Any:
    """The inverse of the sine."""
    return _one("arcsin", x)


def arccos(x: ArrayLike) -> Any:
    """The inverse of the cosine."""
    return _one("arccos", x)


def arctan(x: ArrayLike) -> Any:
    """The inverse of the tangent."""
    return _one("arctan", x)


def sinh(x: ArrayLike) -> Any:
    """The hyperbolic sine."""
    return _one("sinh", x)


def cosh(x: ArrayLike) -> Any:
    """The hyperbolic cosine."""
    return _one("cosh", x)


def tanh(x: ArrayLike) -> Any:
    """The hyperbolic tangent."""
    return _one("tanh", x)


def arcsinh(x: ArrayLike) -> Any:
    """The inverse of the hyperbolic sine."""
    return _one("arcsinh", x)


def arccosh(x: ArrayLike) -> Any:
    """The inverse of the hyperbolic cosine."""
    return _one("arccosh", x)


def arctanh(x: ArrayLike) -> Any:
    """The inverse of the hyperbolic tangent."""
    return _one("arctanh", x)


def cbrt(x: ArrayLike) -> Any:
    """The cube root."""
    return _one("cbrt", x)


def arctan2(y: ArrayLike, x: ArrayLike) -> Any:
    """The angle of (x, y)."""
    return _two("arctan2", y, x)


def hypot(x: ArrayLike, y: ArrayLike) -> Any:
    """The length of (x, y)."""
    return _two("hypot", x, y)


def power(x: ArrayLike, exponent: ArrayLike) -> Any:
    """Powers of real numbers; of complex ones, and small whole powers, by products."""
    if isinstance(exponent, int) and (abs(exponent) <= _BY_PRODUCTS or np.iscomplexobj(x)):
        return whole_power(x, exponent)
    return _two("power", x, exponent)


def whole_power(x: Any, exponent: int) -> Any:
    """A power by squares and products."""
    x = np.asarray(x) if isinstance(x, (list, tuple)) else x
    square, result = (x if exponent >= 0 else 1.0 / np.asarray(x)), None
    left = abs(exponent)
    while left:
        if left & 1:
            result = square if result is None else result * square
        left >>= 1
        square = square * square if left else square
    return np.ones_like(x) if result is None else result


def geomspace(start: float, stop: float, num: int = 50) -> Any:
    """Positive numbers from `start` to `stop` at equal ratios; both ends are exact."""
    if not (start > 0 and stop > 0):
        raise ValueError(f"wanted positive ends; got {start} and {stop}")
    if num < 2:
        return np.full(num, float(start))
    first, last = log10(start), log10(stop)
    values = power(10.0, first + np.arange(num) * ((last - first) / (num - 1)))
    values[0], values[-1] = start, stop
    return values


def interp(x: ArrayLike, places: ArrayLike, values: ArrayLike) -> Any:
    """Values at x, linear between those at rising places; beyond them, the first and the last."""
    given = np.asarray(x, dtype=np.float64)
    at, f = np.asarray(places, dtype=np.float64), np.asarray(values, dtype=np.float64)
    if len(at) == 1:
        return np.full(given.shape, f[0])[()]
    inside = np.clip(given, at[0], at[-1])
    k = np.clip(np.searchsorted(at, inside, side="right") - 1, 0, len(at) - 2)
    slope = (f[k + 1] - f[k]) / (at[k + 1] - at[k])
    return np.where(inside >= at[-1], f[-1], slope * (inside - at[k]) + f[k])[()]


FUNCTIONS = {
    function.__name__: function
    for function in (
        *(exp, exp2, expm1, log, log2, log10, log1p, sin, cos, tan, arcsin, arccos, arctan, arctan2),
        *(sinh, cosh, tanh, arcsinh, arccosh, arctanh, cbrt, hypot, power),
    )
}
"""By name, for formulas that are compiled."""
