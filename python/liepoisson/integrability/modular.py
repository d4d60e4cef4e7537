r"""Polynomials, and the matrix of D on monomials, modulo a prime.  What is independent there is independent exactly.

A term $c\,x^e\,\partial_k$ of D sends $x^m$ to $c\,m_k\,x^{m + e - 1_k}$: one entry of the matrix for each term and
each monomial with $m_k > 0$.  All entries of a term are made at once, as the compiled elimination takes them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from math import inf
from random import Random
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.number_fields import Element
from liepoisson.algebra.residues import Residues
from liepoisson.algebra.sparse_polynomials import Polynomial
from liepoisson.errors import ParameterError
from liepoisson.integrability.derivation import Derivation, Exponents

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

_MOST_PRIMES = 20


def modular(polynomial: Polynomial, residues: Residues) -> Polynomial:
    """The polynomial over the field of the prime."""
    number = residues.field.number
    image = {m: number(residues(c)) for m, c in polynomial.items()}
    return {m: c for m, c in image.items() if c}


def residues_of(field: Coefficients, polynomials: Iterable[Polynomial], skipped: int = 0) -> Residues:
    """The homomorphism modulo the first prime, after some that are skipped, modulo which no coefficient vanishes."""
    values = [c for polynomial in polynomials for c in polynomial.values()]
    for attempt in range(_MOST_PRIMES):
        found = field.residues(seed=1 + attempt, skipped=attempt)
        if found is None:
            break
        if _all_nonzero(found, values):
            if not skipped:
                return found
            skipped -= 1
    raise ParameterError(
        "the coefficients have no images modulo primes, which every search begins with; give rational numbers or roots"
    )


def _all_nonzero(residues: Residues, values: Iterable[Element]) -> bool:
    try:
        return all(residues(value) for value in values)
    except (ValueError, ZeroDivisionError):  # a denominator vanishes modulo the prime
        return False


def random_point(n: int, residues: Residues, seed: int = 1) -> list[Element]:
    """Numbers of the field of the prime; the same for the same seed."""
    random = Random(seed)
    return [residues.field.number(random.randrange(1, residues.p)) for _ in range(n)]


_LARGEST_KEY = 2**62


def modular_nullity(
    derivation: Derivation,
    residues: Residues,
    monomials: Sequence[Exponents],
    progress: Callable[[float], Any] | None = None,
) -> int:
    """Dimension of the null space of D on some monomials; those of low degree come first, which costs least."""
    import numpy as np

    from liepoisson import _core

    parts = list(_entries(derivation, residues, np.array(sorted(monomials, key=lambda m: (sum(m), m)), dtype=np.int64)))
    if not parts:
        return len(monomials)
    columns, images, values = (np.concatenate(part) for part in zip(*parts, strict=True))
    rows = _numbered(images)
    order = np.lexsort((columns, rows))
    starts = np.searchsorted(rows[order], np.arange(rows.max() + 2))
    matrix = starts.astype(np.uint64), columns[order].astype(np.uint32), values[order]
    found = _core.modular_null_space(*matrix, len(monomials), residues.p, None, inf, progress)
    return len(monomials) - found["rank"]


def _entries(derivation: Derivation, residues: Residues, monomials: NDArray[np.int64]) -> Iterator[Any]:
    """For each term of D the columns, the monomials of the rows and the residues of its entries."""
    import numpy as np

    p = residues.p
    for k, component in enumerate(derivation.components):
        columns = np.flatnonzero(monomials[:, k])
        powers = monomials[columns, k]
        for factor, coefficient in component.items():
            residue = residues(coefficient) % p
            if not residue or not len(columns):
                continue
            # residues of 61 bits times powers would overflow: a table of Python's integers
            table = np.array([residue * m % p for m in range(int(powers.max()) + 1)], dtype=np.uint64)
            images = monomials[columns] + np.array(factor)
            images[:, k] -= 1
            yield columns, images, table[powers]


def _numbered(monomials: NDArray[np.int64]) -> NDArray[np.int64]:
    """A number for each monomial from 0, the same for equal ones."""
    import numpy as np

    base = int(monomials.max(initial=0)) + 1
    keys, size = np.zeros(len(monomials), dtype=np.int64), 1
    for exponents in monomials.T:
        if size * base > _LARGEST_KEY:
            keys = np.unique(keys, return_inverse=True)[1]
            size = int(keys.max()) + 1
        keys, size = keys * base + exponents, size * base
    return np.unique(keys, return_inverse=True)[1]
