r"""Radical, nilradical and Levi factor of a Lie algebra, its subalgebras and its quotients by ideals.

Over a field of characteristic 0, all exact:

* the radical r is the orthogonal complement of [g, g] under the Killing form;
* ad x, x in r, is triangular over the algebraic closure, with weights $\lambda_a(x)$ that vanish on [g, r].  The
  nilradical is the common kernel of the weights.  For s in r with distinct values $\lambda_a(s)$ the traces
  $\operatorname{tr}(\mathrm{ad}_s^{k-1} \mathrm{ad}_x) = \sum_a m_a \lambda_a(s)^{k-1} \lambda_a(x)$, k = 1, ..., n,
  vanish only there, by Vandermonde's determinant.  Of an unlucky s the solutions are an ideal that is not nilpotent,
  which is tested;
* a complement of r is moved by elements of r, of $r' = [r, r]$, ... in turn until it is closed.  Each step is a linear
  system, which has a solution by Whitehead's lemma: Levi's theorem.

References: Humphreys (1972), sections 3 to 6; Rand, Winternitz and Zassenhaus, Linear Algebra Appl. 109 (1988) 197; de
Graaf, Lie Algebras: Theory and Algorithms (2000), sections 2.2, 2.3 and 4.13.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations, count, pairwise
from typing import Any

from liepoisson.algebra.echelon import Echelon, Vector
from liepoisson.algebra.linear_algebra import solve
from liepoisson.errors import BracketError
from liepoisson.formula.tensors import Brackets
from liepoisson.structure.lie.lie_structure import LieStructure


def radical(g: LieStructure) -> list[Vector]:
    """The largest solvable ideal: a reduced echelon basis."""
    whole = g.whole()
    form, equations = g.killing_rows(), Echelon(g.field)
    for v in g.span_of_brackets(whole, whole):
        equations.insert(_combined(g, v, form))
    return Echelon(g.field, equations.null_space(g.dimension)).basis()


def nilradical(g: LieStructure) -> list[Vector]:
    """The largest nilpotent ideal: a reduced echelon basis."""
    whole, r = g.whole(), radical(g)
    inner = Echelon(g.field, [g.bracket(u, v) for u in whole for v in r])
    outside = _complement(inner, r)
    for k in count(1):
        s = _sum(g, [(g.field.number(k**a), v) for a, v in enumerate(outside)])
        kernel = Echelon(g.field, _trace_forms(g, s, outside)).null_space(len(outside))
        ideal = [*inner.basis(), *(_sum(g, [(c, outside[a]) for a, c in row.items()]) for row in kernel)]
        found = Echelon(g.field, ideal).basis()
        if _is_nilpotent(g, found):
            return found
    raise AssertionError


def levi_factor(g: LieStructure) -> list[Vector]:
    """A semisimple subalgebra s with g = s + r: one vector for each basis element that is none of the radical's."""
    r = radical(g)
    modulo_radical = Echelon(g.field, r)
    x = [{k: g.field.one} for k in range(g.dimension) if k not in modulo_radical.rows]
    place = {min(v): a for a, v in enumerate(x)}
    constants = {
        (i, j): {place[k]: c for k, c in modulo_radical.reduce(g.bracket(x[i], x[j])).items()}
        for i, j in combinations(range(len(x)), 2)
    }
    for ideal, next_one in pairwise([*_derived(g, r), []]):
        below = Echelon(g.field, next_one)
        x = _moved(g, x, constants, _complement(below, ideal), below)
    return x


def subalgebra(g: LieStructure, vectors: Sequence[Vector]) -> Brackets:
    """The structure constants of the span of some vectors, which are its basis.

    Raises:
        BracketError: they are linearly dependent, or a bracket is outside of their span.
    """
    end, span = g.dimension, Echelon(g.field)
    for a, v in enumerate(vectors):
        if not any(k < end for k in span.reduce(v)):
            raise BracketError(
                f"vectors must be linearly independent; vectors[{a}] is a combination of those before it. Leave it out."
            )
        span.insert({**v, end + a: g.field.one})
    brackets: Brackets = {}
    for a, b in combinations(range(len(vectors)), 2):
        left = span.reduce(g.bracket(vectors[a], vectors[b]))
        if any(k < end for k in left):
            raise BracketError(
                f"vectors must span a subalgebra; the bracket of vectors[{a}] and vectors[{b}] is outside of their "
                "span. Add it to them."
            )
        if left:
            brackets[a, b] = {k - end: g.field.write(-c, 1) for k, c in sorted(left.items())}
    return brackets


def quotient(g: LieStructure, vectors: Sequence[Vector]) -> tuple[list[int], Brackets]:
    """The numbers of the basis elements that stay a basis modulo an ideal, and their brackets.

    Raises:
        BracketError: the vectors do not span an ideal.
    """
    ideal = Echelon(g.field, vectors)
    for v in vectors:
        for j, e in enumerate(g.whole()):
            if ideal.reduce(g.bracket(v, e)):
                shown = [str(g.field.write(v[k])) if k in v else "0" for k in range(g.dimension)]
                raise BracketError(
                    f"ideal must contain its brackets with all elements; that of ({', '.join(shown):.80}) with basis "
                    f"element {j} is outside of it. Add it to the vectors that span the ideal."
                )
    kept = [k for k in range(g.dimension) if k not in ideal.rows]
    place = {k: a for a, k in enumerate(kept)}
    brackets: Brackets = {}
    for a, b in combinations(range(len(kept)), 2):
        if left := ideal.reduce(g.ad[kept[a]].get(kept[b], {})):
            brackets[a, b] = {place[k]: g.field.write(c, 1) for k, c in sorted(left.items())}
    return kept, brackets


def _moved(
    g: LieStructure,
    x: list[Vector],
    constants: dict[tuple[int, int], dict[int, Any]],
    steps: list[Vector],
    below: Echelon,
) -> list[Vector]:
    r"""The vectors $y_i = x_i + \sum_a u_{ia} q_a$ with $[y_i, y_j] = c_{ij}^k y_k$ modulo the ideal below.

    The q commute modulo it, so that the equations for u are linear.
    """
    n, m = len(x), len(steps)
    if not n or not m:
        return x
    acted = [[below.reduce(g.bracket(v, q)) for q in steps] for v in x]
    columns: list[dict[Any, Any]] = [{} for _ in range(n * m)]
    target: dict[Any, Any] = {}
    for (i, j), row in constants.items():
        gap = _sum(g, [(c, x[k]) for k, c in row.items()] + [(-g.field.one, g.bracket(x[i], x[j]))])
        target |= {(i, j, k): c for k, c in below.reduce(gap).items()}
        for a in range(m):
            _add(columns[j * m + a], (i, j), acted[i][a], g.field.one)
            _add(columns[i * m + a], (i, j), acted[j][a], -g.field.one)
            for k, c in row.items():
                _add(columns[k * m + a], (i, j), below.reduce(steps[a]), -c)
    u = solve(columns, target, g.field)
    assert u is not None, "Whitehead's lemma"
    return [_sum(g, [(g.field.one, v), *((u[i * m + a], q) for a, q in enumerate(steps))]) for i, v in enumerate(x)]


def _add(column: dict[Any, Any], pair: tuple[int, int], vector: Vector, factor: Any) -> None:
    for k, c in vector.items():
        key = (*pair, k)
        total = column[key] + factor * c if key in column else factor * c
        if total:
            column[key] = total
        else:
            column.pop(key)


def _trace_forms(g: LieStructure, s: Vector, vectors: Sequence[Vector]) -> list[Vector]:
    r"""The rows $(\operatorname{tr}(\mathrm{ad}_s^{k-1} \mathrm{ad}_v))_v$, k = 1, ..., n."""
    unit = g.whole()
    maps = [[g.bracket(v, e) for e in unit] for v in vectors]
    power, rows = unit, list[Vector]()  # the columns of ad_s^(k-1)
    for _ in range(g.dimension):
        row: Vector = {}
        for a, columns in enumerate(maps):
            terms = [c * power[l][j] for j, column in enumerate(columns) for l, c in column.items() if j in power[l]]
            if terms and not g.field.vanishes(total := sum(terms[1:], terms[0])):
                row[a] = total
        rows.append(row)
        power = [g.bracket(s, column) for column in power]
    return rows


def _is_nilpotent(g: LieStructure, ideal: list[Vector]) -> bool:
    current = ideal
    while current:
        following = Echelon(g.field, [g.bracket(u, v) for u in ideal for v in current]).basis()
        if len(following) == len(current):
            return False
        current = following
    return True


def _derived(g: LieStructure, ideal: list[Vector]) -> list[list[Vector]]:
    """The derived series of a solvable ideal, without 0."""
    series: list[list[Vector]] = []
    current = ideal
    while current:
        series.append(current)
        current = Echelon(g.field, [g.bracket(u, v) for u, v in combinations(current, 2)]).basis()
    return series


def _complement(inner: Echelon, vectors: Sequence[Vector]) -> list[Vector]:
    """Those of the vectors that complete a span."""
    span = Echelon(inner.field, inner.rows.values())
    return [v for v in vectors if span.insert(v)]


def _combined(g: LieStructure, weights: Vector, rows: Sequence[Vector]) -> Vector:
    return _sum(g, [(c, rows[k]) for k, c in weights.items()])


def _sum(g: LieStructure, terms: Sequence[tuple[Any, Vector]]) -> Vector:
    total: Vector = {}
    for c, vector in terms:
        for k, value in vector.items():
            total[k] = total[k] + c * value if k in total else c * value
    return {k: value for k, value in total.items() if not g.field.vanishes(value)}
