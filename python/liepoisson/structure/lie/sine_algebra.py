r"""The sine algebra: Zeitlin's truncation of the two-dimensional Euler equation on the torus to su(N), N odd.

The vorticity has Fourier coefficients $w_n$, n in $\mathbb Z_N^2$ without 0, with $w_{-n} = \overline{w_n}$, and

$$\{w_m, w_n\} = \frac{N}{2\pi} \sin\Bigl(\frac{2\pi}{N}\, m \times n\Bigr)\, w_{m+n}, \qquad
  m \times n = m_1 n_2 - m_2 n_1,$$

indices modulo N, which tends to the bracket of the ideal fluid, $m \times n\, w_{m+n}$, as N grows.  The Jacobi
identity is the addition theorem $\sum_{cyc} \sin(a \times b) \sin((a + b) \times c) = 0$.

References: Fairlie, Fletcher and Zachos, Phys. Lett. B 218 (1989) 203; Zeitlin, Physica D 49 (1991) 353.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations
from typing import TypeAlias

from liepoisson.algebra.symbol_polynomials import Irrational, SymbolPolynomial

Mode: TypeAlias = tuple[int, int]


def sine_modes(N: int) -> list[Mode]:
    """One wave vector n of each pair (n, -n), components from -(N-1)/2 to (N-1)/2, by increasing length.

    The coordinates of `sine(N)` are the real and imaginary parts of $w_n$ in this order: mode number r has the
    coordinates number 2r and 2r + 1, counted from 0.
    """
    half = range(-(N // 2), N // 2 + 1)
    positive = ((n1, n2) for n1 in half for n2 in half if (n1, n2) > (0, 0))
    return sorted(positive, key=lambda n: (n[0] ** 2 + n[1] ** 2, -n[0], -n[1]))


def sine_energy(N: int) -> tuple[Fraction, ...]:
    r"""The coefficients $h_i$ of the kinetic energy $H = \tfrac12 \sum_n |w_n|^2/|n|^2 = \sum_i h_i x_i^2$.

    The sum over n counts n and -n, so that $h_i = 1/|n|^2$ for both coordinates of the mode n.
    """
    return tuple(Fraction(1, n1**2 + n2**2) for n1, n2 in sine_modes(N) for _ in range(2))


def sine_names(N: int) -> tuple[str, ...]:
    """Names of the coordinates: c10, s10 are the real and imaginary part of $w_{(1, 0)}$; c1m1 belongs to (1, -1)."""
    separator = "_" if N // 2 > 9 else ""
    numbers = [[f"m{-k}" if k < 0 else str(k) for k in n] for n in sine_modes(N)]
    return tuple(f"{part}{separator.join(n)}" for n in numbers for part in "cs")


def sine_brackets(N: int) -> dict[tuple[int, int], dict[int, SymbolPolynomial]]:
    r"""The brackets of the algebra of the module for odd N, without a check of N: see `structure.lie_algebras.sine`.

    With $w_n = c_n + i s_n$ and $S = \frac{N}{2\pi} \sin(2\pi\, m \times n/N)$ the brackets of the coordinates are

    $$\{c_m, c_n\} = \tfrac S2 (c_{m+n} - c_{m-n}), \quad \{c_m, s_n\} = \tfrac S2 (s_{m+n} + s_{m-n}), \quad
      \{s_m, s_n\} = -\tfrac S2 (c_{m+n} + c_{m-n}),$$

    where $c_{-n} = c_n$, $s_{-n} = -s_n$; the structure constants are their negatives (minus Lie-Poisson bracket).
    """
    modes = sine_modes(N)
    place = {mode: r for r, mode in enumerate(modes)}
    half = _half_sines(N)
    brackets: dict[tuple[int, int], dict[int, SymbolPolynomial]] = {}

    def find(n1: int, n2: int) -> tuple[int, int]:
        """Number of the mode that stands for n, and the sign of s_n in terms of it."""
        n = ((n1 + N // 2) % N - N // 2, (n2 + N // 2) % N - N // 2)
        return (place[n], 1) if n in place else (place[-n[0], -n[1]], -1)

    for (p, m), (q, n) in combinations(enumerate(modes), 2):
        cross = (m[0] * n[1] - m[1] * n[0]) % N
        if cross == 0:
            continue
        up, down = half[cross], half[-cross % N]  # S/2 and -S/2: the same two objects for all pairs
        (plus, sign), (minus, other) = find(m[0] + n[0], m[1] + n[1]), find(m[0] - n[0], m[1] - n[1])
        brackets[2 * p, 2 * q] = {2 * plus: down, 2 * minus: up}
        brackets[2 * p, 2 * q + 1] = {
            2 * plus + 1: down if sign > 0 else up,
            2 * minus + 1: down if other > 0 else up,
        }
        # {s_m, c_n} = -{c_n, s_m} has S(n, m) = -S(m, n) and s_{n-m} = -s_{m-n}.
        brackets[2 * p + 1, 2 * q] = {
            2 * plus + 1: down if sign > 0 else up,
            2 * minus + 1: up if other > 0 else down,
        }
        brackets[2 * p + 1, 2 * q + 1] = {2 * plus: up, 2 * minus: up}
    return brackets


def _half_sines(N: int) -> list[SymbolPolynomial]:
    r"""The numbers $\frac{N}{4\pi} \sin(2\pi k/N)$, k = 0, ..., N - 1."""
    above_pi = Irrational("pi", Fraction(-1))
    first = [SymbolPolynomial({(above_pi, _sine(Fraction(2 * k, N))): Fraction(N, 4)}) for k in range(1, N // 2 + 1)]
    return [SymbolPolynomial({}), *first, *(-number for number in reversed(first))]


def _sine(q: Fraction) -> Irrational:
    """The sine of pi q, 0 < q < 1, by an angle of the first quadrant."""
    return Irrational("sin", min(q, 1 - q))
