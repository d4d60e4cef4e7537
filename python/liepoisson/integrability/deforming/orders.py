r"""Corrections of an integral in powers of one parameter: linear equations, and what proves that there are none.

With $D = D_0 + \epsilon D_1 + \dots$ the function $F = F_0 + \epsilon F_1 + \dots$ is an integral to order k if
$\sum_j D_j F_{i-j} = 0$ for all $i\le k$.  The unknown coefficients are those of $F_1,\dots,F_k$, and those of $F_0$ in
a space of integrals at 0.  All equations are linear, so that the $F_0$ that have corrections are a subspace.  For the
others there are functionals, combinations of the coefficients of $\sum_j D_j F_{i-j}$, that vanish for all
$F_1,\dots,F_k$ and not for $F_0$: left null vectors.  They are found modulo a prime in as many rows as the rank, lifted
by solving there, and multiplied with the whole matrix.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from liepoisson.algebra.echelon import transposed
from liepoisson.algebra.linear_algebra import nullspace, nullspace_mod, solve
from liepoisson.algebra.number_fields import Element, NumberField
from liepoisson.algebra.sparse_polynomials import Polynomial, add_multiple
from liepoisson.inputs.deadline import checkpoint
from liepoisson.integrability.deforming.family import Family, Starts
from liepoisson.integrability.derivation import Exponents
from liepoisson.integrability.search import residues_of

_MOST_PRIMES = 5
"""Primes that are tried for the rows of functionals; modulo an unlucky one the rank is smaller."""

Functional = dict[Exponents, Element]
"""Weights of the coefficients of a residual, by monomials in the coordinates and the parameter."""


@dataclass(frozen=True)
class Solved:
    """What of the starts of one block has corrections to some order; they are numbered as in `Starts.everything`.

    Attributes:
        solutions: Pairs of the coefficients of the start, by numbers, the last of which is none of a trivial one, and
            of the function.
        missing: The numbers of those that have none, not even with others and trivial ones added.
        n_corrections: The number of unknown coefficients of the corrections.
        functionals: One for each number that is missing: 1 on it, 0 on the others that are missing, on the trivial
            ones and on all corrections.
    """

    solutions: tuple[tuple[dict[int, Element], Polynomial], ...]
    missing: tuple[int, ...]
    n_corrections: int
    functionals: tuple[Functional, ...]


class OrderEquations:
    """The equations of one block, for one parameter."""

    def __init__(self, family: Family, starts: Starts, highest: int) -> None:
        self.family, self.starts = family, starts
        self.columns: list[Polynomial] = []
        self.images: list[Polynomial] = []
        one, weight = family.derivation.field.one, max(s.weight for s in (*starts.others, *starts.trivial))
        self.ends = [0]  # where the corrections of each order end
        for order in range(1, highest + 1):
            for m in family.corrections(starts.label, weight, order):
                self._add({(*m, order): one})
            self.ends.append(len(self.columns))
        for start in starts.everything:
            self._add(start.polynomial)

    def _add(self, polynomial: Polynomial) -> None:
        checkpoint("the equations for corrections")
        self.columns.append(polynomial)
        self.images.append(self.family.derivation(polynomial))

    def solve(self, order: int | None) -> Solved:
        """What has corrections up to an order, or for None up to all orders, with those that there are columns for."""
        n_all = self.ends[-1]
        n = n_all if order is None else self.ends[order]
        chosen = [*range(n), *range(n_all, len(self.columns))]
        images = [self._up_to(self.images[k], order) for k in chosen]
        field, n_trivial = self.family.derivation.field, len(self.starts.trivial)
        null = nullspace(transposed(images), len(chosen), field).vectors
        solutions: list[tuple[dict[int, Element], Polynomial]] = []
        ends = {max(v) for v in null}
        for vector in null:
            if max(vector) >= n + n_trivial:
                total: Polynomial = {}
                for k, c in vector.items():
                    add_multiple(total, self.columns[chosen[k]], c)
                solutions.append(({k - n: c for k, c in vector.items() if k >= n}, total))
        missing = tuple(k for k in range(n_trivial, len(self.starts.everything)) if n + k not in ends)
        independent = [images[k] for k in range(n + n_trivial) if k not in ends]
        targets = [images[n + k] for k in missing]
        found = _functionals(independent, targets, images[: n + n_trivial], self) if missing else []
        return Solved(tuple(solutions), missing, n, tuple(found))

    def _up_to(self, polynomial: Polynomial, order: int | None) -> Polynomial:
        return polynomial if order is None else {m: c for m, c in polynomial.items() if m[-1] <= order}


def _functionals(
    independent: Sequence[Polynomial], targets: Sequence[Polynomial], corrections: Sequence[Polynomial], of: Any
) -> list[Functional]:
    """Functionals that vanish on all corrections and are dual to the targets; the columns given first are a basis."""
    field = of.family.derivation.field
    columns = [*independent, *targets]
    rows = sorted({m for column in columns for m in column})
    number = {m: k for k, m in enumerate(rows)}
    dependent = set[int]()
    for skipped in range(_MOST_PRIMES):
        residues = residues_of(field, columns, skipped)
        modular = [{number[m]: residues(c) for m, c in column.items()} for column in columns]
        dependent = {max(v) for v in nullspace_mod(modular, len(rows), residues.p)}
        if len(rows) - len(dependent) == len(columns):
            break
    kept = [m for k, m in enumerate(rows) if k not in dependent]
    in_rows = [{j: column[m] for j, column in enumerate(columns) if m in column} for m in kept]
    found: list[Functional] = []
    for k in range(len(targets)):
        weights = solve(in_rows, {len(independent) + k: field.one}, field)
        assert weights is not None, "rows of full rank"
        functional = {m: w for m, w in zip(kept, weights, strict=True) if w}
        assert not any(applied(functional, correction, field) for correction in corrections)
        wanted = [field.one if j == k else field.zero for j in range(len(targets))]
        assert not any(applied(functional, t, field) - w for t, w in zip(targets, wanted, strict=True))
        found.append(functional)
    return found


def applied(functional: Functional, polynomial: Polynomial, field: NumberField) -> Element:
    """The value of a functional; 0 if no coefficient counts."""
    total = field.zero
    for m, c in polynomial.items():
        if m in functional:
            total = total + functional[m] * c
    return total
