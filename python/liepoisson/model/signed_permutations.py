r"""Signed permutations that carry a polynomial vector field to a multiple $\pm1$ of itself.

$(Sx)_j = s_j x_{\pi(j)}$ takes the term $c\,x^m$ of $f_i$ to $c\,s^m x^{\pi m}$, where $\pi m$ has the exponent $m_j$
at $\pi(j)$.  So $f(Sx) = \sigma S f(x)$ says that $f_{\pi(i)}$ has the term $x^{\pi m}$ with the coefficient $c'$, and

$$ c\,s^m = \sigma\,s_i\,c' . $$

Hence $c' = \pm c$, which only concerns $\pi$; the signs then solve one linear equation modulo 2 for each term.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any, TypeAlias

import numpy as np

from liepoisson.algebra.exact_numbers import is_zero
from liepoisson.inputs.arrays import Array
from liepoisson.streams import generator

Term: TypeAlias = tuple[tuple[int, ...], int, int]
"""Exponents, the number of the coefficient up to its sign, and this sign as 0 or 1."""

MOST_TRIED = 14
"""Components of a field that is no polynomial: 2^14 changes of signs at a few states are 0.1 s."""

_STATES = 6
_CLOSE = 1e-9


@dataclass(frozen=True)
class SignedPermutation:
    """The map with components signs[i] * x[permutation[i]]."""

    permutation: tuple[int, ...]
    signs: tuple[int, ...]

    def after(self, first: SignedPermutation) -> SignedPermutation:
        """The composition: `first`, then this."""
        return SignedPermutation(
            tuple(first.permutation[p] for p in self.permutation),
            tuple(s * first.signs[p] for p, s in zip(self.permutation, self.signs, strict=True)),
        )


def of_polynomial_field(
    equations: Sequence[Any], variables: Sequence[Any], *, permutations: bool, most: int
) -> list[tuple[SignedPermutation, bool]]:
    """All of them, at most so many, each with whether it reverses time (both, where the field vanishes).

    Args:
        equations: The right-hand sides, polynomials in the variables.
        variables: The coordinates.
        permutations: Whether components may be exchanged.
        most: The search ends when so many were found.
    """
    field = _terms(equations, variables)
    n = len(variables)
    candidates = _permutations(field) if permutations else iter([tuple(range(n))])
    found: list[tuple[SignedPermutation, bool]] = []
    for permutation in candidates:
        for bits in _signs(field, permutation):
            signs = tuple(-1 if bits >> k & 1 else 1 for k in range(n))
            found.append((SignedPermutation(permutation, signs), bool(bits >> n & 1)))
            if len(found) >= most:
                return found
    return found


def _terms(equations: Sequence[Any], variables: Sequence[Any]) -> list[list[Term]]:
    from sympy import Poly

    numbers: list[Any] = []

    def number(c: Any) -> tuple[int, int]:
        for k, known in enumerate(numbers):
            if c in (known, -known):
                return k, int(c != known)
        for k, known in enumerate(numbers):
            if is_zero(c - known) or is_zero(c + known):
                return k, int(not is_zero(c - known))
        numbers.append(c)
        return len(numbers) - 1, 0

    return [[(m, *number(c)) for m, c in Poly(e, *variables).terms() if c != 0] if e != 0 else [] for e in equations]


def _signs(field: list[list[Term]], permutation: tuple[int, ...]) -> Iterator[int]:
    r"""The signs (bit k: $s_k = -1$; bit N: $\sigma = -1$) that go with a permutation."""
    n = len(field)
    places = [{m: sign for m, _, sign in terms} for terms in field]
    rows: list[int] = []
    for i, terms in enumerate(field):
        for m, _, sign in terms:
            image = _image(m, permutation)
            row = sum(1 << j for j, power in enumerate(m) if power % 2) ^ 1 << i ^ 1 << n
            rows.append(row | (sign ^ places[permutation[i]][image]) << (n + 1))
    yield from _solutions(rows, n + 1)


def _image(m: tuple[int, ...], permutation: tuple[int, ...]) -> tuple[int, ...]:
    image = [0] * len(m)
    for j, power in enumerate(m):
        image[permutation[j]] = power
    return tuple(image)


def _solutions(rows: list[int], n: int) -> Iterator[int]:
    """Solutions of linear equations modulo 2; bit n of a row is its right-hand side."""
    reduced: dict[int, int] = {}
    for given in rows:
        row = given
        for pivot, other in reduced.items():
            if row >> pivot & 1:
                row ^= other
        if not row & ((1 << n) - 1):
            if row:
                return
            continue
        pivot = (row & -row).bit_length() - 1
        for key, other in reduced.items():
            if other >> pivot & 1:
                reduced[key] = other ^ row
        reduced[pivot] = row
    free = [k for k in range(n) if k not in reduced]
    for values in product((0, 1), repeat=len(free)):
        solution = sum(v << k for k, v in zip(free, values, strict=True))
        for pivot, row in reduced.items():
            parity = (row >> n & 1) ^ ((row & solution).bit_count() & 1)
            solution |= parity << pivot
        yield solution


def _permutations(field: list[list[Term]]) -> Iterator[tuple[int, ...]]:
    """Permutations that carry the terms to one another up to signs, by backtracking."""
    n = len(field)
    colours = _colours(field)
    order = sorted(range(n), key=lambda i: (colours.count(colours[i]), colours[i], i))
    known = [{(m, c) for m, c, _ in terms} for terms in field]
    rank = {i: k for k, i in enumerate(order)}
    # a term can be compared as soon as all its components and its equation have images
    ready: list[list[tuple[int, tuple[int, ...], int]]] = [[] for _ in range(n)]
    for i, terms in enumerate(field):
        for m, c, _ in terms:
            last = max([rank[i], *(rank[j] for j, power in enumerate(m) if power)])
            ready[last].append((i, m, c))
    images: dict[int, int] = {}

    def fits(k: int) -> bool:
        for i, m, c in ready[k]:
            image = [0] * n
            for j, power in enumerate(m):
                if power:
                    image[images[j]] = power
            if (tuple(image), c) not in known[images[i]]:
                return False
        return True

    def extend(k: int) -> Iterator[tuple[int, ...]]:
        if k == n:
            yield tuple(images[i] for i in range(n))
            return
        i = order[k]
        taken = set(images.values())
        for target in range(n):
            if target in taken or colours[target] != colours[i]:
                continue
            images[i] = target
            if fits(k):
                yield from extend(k + 1)
            del images[i]

    return extend(0)


def _colours(field: list[list[Term]]) -> list[int]:
    """Numbers of the components, equal only where they play the same part in the equations, refined until stable."""
    n = len(field)
    colours = [0] * n
    while True:
        keys: list[Any] = []
        parts: list[Counter[Any]] = [Counter() for _ in range(n)]
        for i, terms in enumerate(field):
            own: Counter[Any] = Counter()
            for m, c, _ in terms:
                shape = tuple(sorted((colours[j], power) for j, power in enumerate(m) if power))
                own[c, shape, m[i]] += 1
                for j, power in enumerate(m):
                    if power:
                        parts[j][colours[i], c, shape, power] += 1
            keys.append((colours[i], tuple(sorted(own.items()))))
        full = [(key, tuple(sorted(part.items()))) for key, part in zip(keys, parts, strict=True)]
        names = {key: k for k, key in enumerate(sorted(set(full)))}
        refined = [names[key] for key in full]
        if len(names) == len(set(colours)):
            return refined
        colours = refined


def sign_changes_that_may_be(rate: Callable[[Array], Array], n: int) -> Iterator[tuple[tuple[int, ...], int]]:
    """Changes of signs, each with the sign of time, under which a field is equivariant at a few random states."""
    states = generator(0).uniform(-1.0, 1.0, (_STATES, n))
    rates = rate(states)
    size = 1.0 + np.abs(rates).max()
    for signs in product((1, -1), repeat=n):
        s = np.array(signs, dtype=np.float64)
        images = rate(states * s)
        for factor in (1, -1):
            if np.abs(images - factor * s * rates).max() <= _CLOSE * size:
                yield signs, factor
