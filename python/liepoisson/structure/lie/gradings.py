r"""The gradings of a Lie algebra and a module in their bases, and which parts of a complex carry no cohomology.

The universal grading has the group $G = \langle w_i, v_a \rangle$ with the relations $w_i + w_j = w_k$ wherever
$c_{ij}^k \ne 0$ and $w_i + v_a = v_b$ wherever $e_i v_a$ has a component $v_b$: an abelian group, with torsion as for
so(n), whose signs of coordinates are the gradings.  The differential keeps the weight $v_a - \sum_{s \in S} w_s$ of
$e^S \otimes v_a$, so that the complex is the sum of its parts of one weight.

By Cartan's formula $L_h = d\,i_h + i_h\,d$ every h in g acts by zero on the cohomology.  A part on which $L_h$ is
invertible is therefore acyclic.  Two kinds of basis elements are looked for:

* h acts diagonally on g and on M.  On a part $L_h$ is one number;
* $\operatorname{ad}_h^2$ and $\rho_h^2$ are diagonal with entries 0 and one $\lambda \ne 0$, as rotations and boosts
  are.  On $e^S \otimes v_a$ the eigenvalues of $L_h$ are multiples of $\sqrt\lambda$ with integers, all of the parity
  of the number of basis elements among the $e_s$ and $v_a$ that h does not annihilate; odd ones are not zero.

References: Hochschild and Serre, Annals of Math. 57 (1953) 591, for reductive subalgebras in general.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.inputs.deadline import checkpoint

if TYPE_CHECKING:
    from liepoisson.structure.lie.cochains import Indices, LieModule
    from liepoisson.structure.lie_algebra import LieAlgebra

_FEW = 4096
"""Sets between two looks at the clock."""


class Grading:
    """Weights of basis cochains in the universal grading, numbered as they occur.

    Args:
        algebra: The Lie algebra.
        module: The module.
    """

    def __init__(self, algebra: LieAlgebra, module: LieModule) -> None:
        n, m = algebra.dimension, module.dimension
        self._n = n
        relations: set[tuple[tuple[int, int], ...]] = set()
        for (i, j), row in algebra.brackets.items():
            relations.update(_relation(i, j, k) for k in row)
        trivial = module.kind == "trivial"
        for i, rho in enumerate(module.action):
            relations.update(_relation(i, n + a, n + b) for a, row in enumerate(rho) for b in row)
        self._rows, images = _quotient(n + (0 if trivial else m), sorted(relations))
        self._numbers: dict[tuple[int, ...], int] = {}
        self._weights: list[tuple[int, ...]] = []
        self._sums: dict[tuple[int, int], int] = {}
        zero = (0,) * (len(images[0]) if images else 0)
        self.zero = self._number(zero)
        self._minus = [self._number(self._reduced([-c for c in images[i]])) for i in range(n)]
        self._of_module = [self.zero] if trivial else [self._number(images[n + a]) for a in range(m)]

    def parts(self, degree: int) -> Iterator[tuple[int, Indices, int]]:
        """All basis cochains (S, a) of a degree, each with the number of its weight."""
        sums: dict[Indices, int] = {(): self.zero}
        for k, place in enumerate(combinations(range(self._n), degree)):
            if not k % _FEW:
                checkpoint("the list of cochains")
            known = next((end for end in range(degree - 1, 0, -1) if place[:end] in sums), 0)
            weight = sums[place[:known]]
            for at in range(known, degree):
                weight = self._sum(weight, self._minus[place[at]])
                if at + 1 < degree:
                    sums[place[: at + 1]] = weight
            for a, of_module in enumerate(self._of_module):
                yield self._sum(weight, of_module), place, a

    def _number(self, weight: tuple[int, ...]) -> int:
        if weight not in self._numbers:
            self._numbers[weight] = len(self._weights)
            self._weights.append(weight)
        return self._numbers[weight]

    def _sum(self, first: int, second: int) -> int:
        key = first, second
        if key not in self._sums:
            pairs = zip(self._weights[first], self._weights[second], strict=True)
            self._sums[key] = self._number(self._reduced([a + b for a, b in pairs]))
        return self._sums[key]

    def _reduced(self, vector: list[int]) -> tuple[int, ...]:
        """The representative of a weight: nonnegative below the pivots of the relations."""
        for pivot, row in self._rows:
            if quotient := vector[pivot] // row[pivot]:
                vector = [a - quotient * b for a, b in zip(vector, row, strict=True)]
        return tuple(vector)


def _relation(i: int, j: int, k: int) -> tuple[tuple[int, int], ...]:
    """The relation w_i + w_j - w_k = 0 by its nonzero coefficients."""
    row: dict[int, int] = {}
    for place, sign in ((i, 1), (j, 1), (k, -1)):
        row[place] = row.get(place, 0) + sign
    return tuple(sorted((place, c) for place, c in row.items() if c))


def _quotient(
    n: int, relations: Sequence[tuple[tuple[int, int], ...]]
) -> tuple[list[tuple[int, list[int]]], list[tuple[int, ...]]]:
    """The group of n generators modulo relations: rows of Hermite's form with their pivots, and the generators in it.

    Columns with the pivot 1 are left out, since reduced weights are zero there.
    """
    from flint import fmpz_mat

    reduced: list[list[int]] = []
    if relations:
        matrix = fmpz_mat(len(relations), n)
        for r, row in enumerate(relations):
            for place, c in row:
                matrix[r, place] = c
        reduced = [[int(c) for c in row] for row in matrix.hnf().tolist()]
    rows = [(next(p for p, c in enumerate(row) if c), row) for row in reduced if any(row)]
    gone = {p for p, row in rows if row[p] == 1}
    kept = [p for p in range(n) if p not in gone]
    images: list[tuple[int, ...]] = []
    for generator in range(n):
        vector = [int(k == generator) for k in range(n)]
        for p, row in rows:
            if quotient := vector[p] // row[p]:
                vector = [a - quotient * b for a, b in zip(vector, row, strict=True)]
        images.append(tuple(vector[p] for p in kept))
    return [(kept.index(p), [row[q] for q in kept]) for p, row in rows if p not in gone], images


class Acyclic:
    """Which parts of one weight have no cohomology, by the two rules of the module.

    Args:
        algebra: The Lie algebra.
        module: The module.
        field: The field of the constants.

    Attributes:
        pivots: What must not vanish for what was said, elements of the field.
    """

    def __init__(self, algebra: LieAlgebra, module: LieModule, field: Coefficients) -> None:
        self._field = field
        self._diagonal: list[tuple[list[Any], list[Any]]] = []
        self._parity: list[tuple[set[int], set[int], Any]] = []
        self.pivots: list[Any] = []
        n = algebra.dimension
        ad: list[list[dict[int, Any]]] = [[{} for _ in range(n)] for _ in range(n)]
        for (i, j), row in algebra.brackets.items():
            for k, c in row.items():
                value = field.read(c)
                ad[i][j][k], ad[j][i][k] = value, -value
        for h in range(n):
            rho = [{b: field.read(c) for b, c in row.items()} for row in module.action[h]]
            if not any(ad[h]) and not any(rho):
                continue
            if all(set(row) <= {k} for maps in (ad[h], rho) for k, row in enumerate(maps)):
                weights = [[row.get(k, field.zero) for k, row in enumerate(maps)] for maps in (ad[h], rho)]
                self._diagonal.append((weights[0], weights[1]))
            elif (found := self._moved(ad[h], rho)) is not None:
                self._parity.append(found)

    def _moved(
        self, first: list[dict[int, Any]], second: list[dict[int, Any]]
    ) -> tuple[set[int], set[int], Any] | None:
        """What two maps do not annihilate, and their square there, if it is one number; None if it is not."""
        scale: Any = None
        moved: list[set[int]] = []
        for maps in (first, second):
            here: set[int] = set()
            for k, row in enumerate(maps):
                square: dict[int, Any] = {}
                for b, value in row.items():
                    for c, other in maps[b].items():
                        square[c] = square[c] + value * other if c in square else value * other
                left = {c: value for c, value in square.items() if not self._field.vanishes(value)}
                if not row:
                    continue
                if set(left) != {k} or (scale is not None and not self._field.vanishes(left[k] - scale)):
                    return None
                scale = left[k]
                here.add(k)
            moved.append(here)
        return moved[0], moved[1], scale

    def __call__(self, place: Indices, a: int) -> bool:
        """Whether the part that contains a basis cochain is acyclic; symbols are generic."""
        for moved, of_module, scale in self._parity:
            if (sum(s in moved for s in place) + (a in of_module)) % 2:
                self.pivots.append(scale)
                return True
        for weights, of_module in self._diagonal:
            total = of_module[a]
            for s in place:
                total = total - weights[s]
            if not self._field.vanishes(total):
                self.pivots.append(total)
                return True
        return False
