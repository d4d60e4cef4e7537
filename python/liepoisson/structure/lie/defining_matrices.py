r"""The matrices behind a Lie algebra with a name: coordinates become one matrix whose traces are Casimirs.

For a Lie algebra of matrices $e_j$ the coordinates of a state are written into one matrix, $X = \sum_k x_k F^k$, with

$$[e_j, F^k] = \sum_i c_{ij}{}^k F^i \qquad\text{for all j and k.} \tag{1}$$

Then $\{X, x_j\} = -\sum_{ik} c_{ij}{}^k x_k F^i = [X, e_j]$: coadjoint motion is conjugation, and the coefficients of
$\det(\lambda - X)$, the traces $\operatorname{tr} X^k$ and the Pfaffian of an antisymmetric X are constant.  The $F^k$
are the dual basis of the trace form.  `DefiningMatrices.defect` verifies (1) entry by entry in exact arithmetic; what
is built here is trusted nowhere else.

References: Marsden and Ratiu, Introduction to Mechanics and Symmetry (1999), section 14.1.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any, TypeAlias

from liepoisson.algebra.coefficients import Coefficients

if TYPE_CHECKING:
    from liepoisson.structure.lie.matrix_family import MatrixAlgebra

Roots: TypeAlias = tuple[tuple[Fraction, int], ...]
r"""A number $\sum q\,\zeta^a$ by its pairs (q, a), with $\zeta = e^{2\pi i/n}$ for an order n kept beside it."""

Entries: TypeAlias = dict[tuple[int, int], Roots]
"""A matrix by its nonzero entries."""

_Rational: TypeAlias = dict[tuple[int, int], Fraction]


@dataclass(frozen=True)
class DefiningMatrices:
    r"""The matrices $F^k$ of $X = \sum_k x_k F^k$, those that move X, and which functions of X are Casimirs.

    Attributes:
        matrices: The $F^k$.
        movers: The matrices $e_j$, by j; for all j, or for some that generate the algebra.
        size: Number of rows.
        order: Of the root of unity in the entries; 1 if they are rational.
        copies: How often each eigenvalue of X is counted: 2 where complex matrices are written as real ones.
        degrees: Degrees k of the traces that generate the invariants, the Pfaffian aside.
        pfaffian: The degree of the Pfaffian; 0 if there is none.
        meaning: What X is, in words and formulas of plain text, with {x} for its name.
    """

    matrices: tuple[Entries, ...]
    movers: dict[int, Entries]
    size: int
    order: int
    copies: int
    degrees: tuple[int, ...]
    pfaffian: int
    meaning: str

    def defect(self, algebra: MatrixAlgebra) -> str:
        """Where (1) fails for this algebra, in words; empty if it holds for all j and k.

        If movers are given for some j only, it is also verified that these generate the algebra: the linear functions
        that commute with a Casimir form a subalgebra.
        """
        constants = [c for row in algebra.brackets.values() for c in row.values()]
        field = Coefficients.containing(constants)
        if not holds_roots(field, self.order):
            return f"the structure constants of {algebra.name} are not in the field of the matrices"
        elements = [in_field(matrix, field, self.order) for matrix in self.matrices]
        table = _coadjoint(algebra, field)
        having: dict[int, set[int]] = {}
        for k, matrix in enumerate(elements):
            for place in matrix:
                for index in place:
                    having.setdefault(index, set()).add(k)
        for j, mover in self.movers.items():
            moving = in_field(mover, field, self.order)
            # Matrices without a common index commute.
            touched = {k for place in moving for index in place for k in having.get(index, ())}
            for k in sorted(touched | set(table[j])):
                left = _commutator(moving, elements[k])
                for i, c in table[j].get(k, ()):
                    for place, value in elements[i].items():
                        left[place] = left[place] - c * value if place in left else -(c * value)
                if any(not field.vanishes(value) for value in left.values()):
                    return f"[e_j, F^k] is not the combination of the F^i for (j, k) = ({j}, {k})"
        if len(self.movers) < algebra.dimension and not _generate(algebra, list(self.movers), field):
            return "the moved coordinates do not generate the algebra"
        return ""


def defining_matrices(algebra: MatrixAlgebra) -> DefiningMatrices | None:
    """The matrices of an algebra that was made by a constructor of `structure.lie_algebras`; None for all others."""
    family = algebra.family
    if family is None:
        return None
    if family.kind == "sine":
        return _sine_matrices(family.size)
    basis = [dict(matrix) for matrix in family.basis] or _adjoint(algebra)
    return _BUILDERS[family.kind](basis, family.size)


def holds_roots(field: Coefficients, order: int) -> bool:
    """Whether a field has the roots of unity of an order."""
    return order == 1 or (field.is_cyclotomic and field.domain.order % order == 0)


def in_field(matrix: Mapping[tuple[int, int], Roots], field: Coefficients, order: int) -> dict[tuple[int, int], Any]:
    """The matrix with entries in a field that `holds_roots`."""
    return {place: _element(roots, field, order) for place, roots in matrix.items()}


def _element(roots: Roots, field: Coefficients, order: int) -> Any:
    if order == 1:
        return field.number(sum((q for q, _ in roots), Fraction(0)))
    step = field.domain.order // order
    total = field.zero
    for q, power in roots:
        total = total + field.number(q) * field.domain.root(power * step)
    return total


def _orthogonal(basis: list[Any], size: int) -> DefiningMatrices:
    # tr(E_ij E_ij) = -2 eta_i eta_j: with the factor -2, X is the sum of eta_i eta_j x_ij E_ij.
    even = tuple(range(2, size if size % 2 else size - 1, 2))
    meaning = "{x}_i = -tr({x} e_i)/2, an antisymmetric matrix times the metric"
    half = 0 if size % 2 else size // 2
    return _with_dual(basis, basis, size, Fraction(-2), degrees=even, pfaffian=half, meaning=meaning)


def _linear(basis: list[Any], size: int) -> DefiningMatrices:
    return _with_dual(
        basis, basis, size, Fraction(1), degrees=tuple(range(1, size + 1)), meaning="{x}_i = tr({x} e_i), a real matrix"
    )


def _special_linear(basis: list[Any], size: int) -> DefiningMatrices:
    meaning = "{x}_i = tr({x} e_i), a real traceless matrix"
    return _with_dual(basis, basis, size, Fraction(1), degrees=tuple(range(2, size + 1)), meaning=meaning)


def _special_unitary(basis: list[Any], size: int) -> DefiningMatrices:
    """The hermitian matrices -i e_k, as real ones of twice the size, in which i is a matrix that commutes with all."""
    hermitian = [{place: -1j * value for place, value in matrix.items()} for matrix in basis]
    return _with_dual(
        [_real(matrix, size) for matrix in basis],
        [_real(matrix, size) for matrix in hermitian],
        2 * size,
        Fraction(4),  # 2 for the copies, and 2 so that the off-diagonal entries are s_jk - i a_jk
        copies=2,
        degrees=tuple(range(2, size + 1)),
        meaning="{x}_i = tr({x} e_i)/(2 sqrt(-1)), a hermitian traceless matrix",
    )


_BUILDERS = {"so": _orthogonal, "gl": _linear, "sl": _special_linear, "su": _special_unitary}


def _with_dual(
    movers: list[Any],
    span: list[Any],
    size: int,
    factor: Fraction,
    *,
    degrees: tuple[int, ...],
    meaning: str,
    pfaffian: int = 0,
    copies: int = 1,
) -> DefiningMatrices:
    """The dual basis of a span of matrices under the trace form, times a factor."""
    read = [{place: _fraction(value) for place, value in matrix.items()} for matrix in span]
    given = [_roots({place: _fraction(value) for place, value in matrix.items()}) for matrix in movers]
    dual = [{place: factor * value for place, value in matrix.items()} for matrix in _dual_basis(read)]
    return DefiningMatrices(
        tuple(map(_roots, dual)), dict(enumerate(given)), size, 1, copies, degrees, pfaffian, meaning
    )


def _fraction(value: Any) -> Fraction:
    return value if isinstance(value, Fraction) else Fraction(int(complex(value).real))


def _roots(matrix: _Rational) -> Entries:
    return {place: ((value, 0),) for place, value in sorted(matrix.items()) if value}


def _dual_basis(basis: list[_Rational]) -> list[_Rational]:
    """Matrices F^k in the span with tr(F^k M_l) = delta_kl, block by block of the Gram matrix."""
    from flint import fmpq, fmpq_mat

    at: dict[tuple[int, int], list[tuple[int, Fraction]]] = {}
    for k, matrix in enumerate(basis):
        for (i, j), value in matrix.items():
            at.setdefault((j, i), []).append((k, value))
    gram: list[dict[int, Fraction]] = []
    for matrix in basis:
        row: dict[int, Fraction] = {}
        for place, value in matrix.items():
            for k, other in at.get(place, ()):
                row[k] = row.get(k, Fraction(0)) + value * other
        gram.append({k: value for k, value in row.items() if value})
    dual: list[_Rational] = [{} for _ in basis]
    for block in _connected(gram):
        rows = [[gram[k].get(l, Fraction(0)) for l in block] for k in block]
        inverse = fmpq_mat([[fmpq(v.numerator, v.denominator) for v in row] for row in rows]).inv()
        for a, k in enumerate(block):
            for b, l in enumerate(block):
                weight = Fraction(int(inverse[a, b].p), int(inverse[a, b].q))
                for place, value in basis[l].items() if weight else ():
                    dual[k][place] = dual[k].get(place, Fraction(0)) + weight * value
    return dual


def _connected(rows: list[dict[int, Fraction]]) -> Iterator[list[int]]:
    left = set(range(len(rows)))
    while left:
        block, front = set[int](), {min(left)}
        while front:
            block |= front
            front = {l for k in front for l in rows[k]} - block
        left -= block
        yield sorted(block)


def _real(matrix: Mapping[tuple[int, int], complex], m: int) -> _Rational:
    """The matrix [[Re, -Im], [Im, Re]] of a complex one."""
    found: _Rational = {}
    for (i, j), value in matrix.items():
        z = complex(value)
        for place, part in (((i, j), z.real), ((i + m, j + m), z.real), ((i, j + m), -z.imag), ((i + m, j), z.imag)):
            if part:
                found[place] = Fraction(int(part))
    return found


def _adjoint(algebra: MatrixAlgebra) -> list[Any]:
    matrices: list[Any] = [{} for _ in range(algebra.dimension)]
    for (i, j), row in algebra.brackets.items():
        for k, c in row.items():
            matrices[i][k, j] = c
            matrices[j][k, i] = -c
    return matrices


def _sine_matrices(N: int) -> DefiningMatrices:
    r"""$W = \sum_n w_n T_n$ with $T_n = q^{n_1 n_2} g^{n_1} h^{n_2}$, $q = e^{2\pi i/N}$, $hg = q^2 gh$, hermitian.

    $T_m T_n = q^{-m \times n}\, T_{m+n}$, g is the shift of a basis and h is diagonal; $T_{-n} = T_n^\dagger$.
    The matrix of $c_n$ is $T_n + T_{-n}$, that of $s_n$ is $i(T_n - T_{-n})$, and they move W by themselves, times
    $N/(8i)$ (and the inverse of pi, which is set aside as the scale of the structure constants).
    """
    from liepoisson.structure.lie.sine_algebra import sine_modes

    matrices: list[Entries] = []
    for n1, n2 in sine_modes(N):
        forward, backward = _clock_and_shift(N, n1, n2), _clock_and_shift(N, -n1, -n2)
        matrices.append(_sum_of_roots(forward, backward, Fraction(1), 0))
        matrices.append(_sum_of_roots(forward, backward, Fraction(-1), N))
    eighth = Fraction(N, 8)
    first = [2 * r + part for r, n in enumerate(sine_modes(N)) if n in ((1, 0), (0, 1)) for part in (0, 1)]
    movers = {
        j: {p: tuple((eighth * q, (a + 3 * N) % (4 * N)) for q, a in roots) for p, roots in matrices[j].items()}
        for j in first
    }
    meaning = "{x} = sum of {x}_n T_n over all n, hermitian, with the clock and shift matrices T_n"
    return DefiningMatrices(tuple(matrices), movers, N, 4 * N, 1, tuple(range(2, N + 1)), 0, meaning)


def _clock_and_shift(N: int, n1: int, n2: int) -> dict[tuple[int, int], int]:
    r"""$T_n$ by the powers of $e^{2\pi i/4N}$ in its entries: $g_{r+1,r} = 1$, $h_{rr} = q^{2r}$."""
    return {((r + n1) % N, r): 4 * (n1 * n2 + 2 * r * n2) % (4 * N) for r in range(N)}


def _sum_of_roots(
    first: dict[tuple[int, int], int], second: dict[tuple[int, int], int], weight: Fraction, turn: int
) -> Entries:
    """The sum of `first` and `weight` times `second`, both times the root to the power `turn`; i is `order`/4."""
    found: dict[tuple[int, int], list[tuple[Fraction, int]]] = {}
    order = 4 * len(first)
    for matrix, q in ((first, Fraction(1)), (second, weight)):
        for place, power in matrix.items():
            found.setdefault(place, []).append((q, (power + turn) % order))
    return {place: tuple(roots) for place, roots in sorted(found.items())}


def _coadjoint(algebra: MatrixAlgebra, field: Coefficients) -> list[dict[int, list[tuple[int, Any]]]]:
    """The $c_{ij}^k$ by j, then by k: pairs of i and the constant."""
    table: list[dict[int, list[tuple[int, Any]]]] = [{} for _ in range(algebra.dimension)]
    for (i, j), row in algebra.brackets.items():
        for k, value in row.items():
            c = field.read(value)
            table[j].setdefault(k, []).append((i, c))
            table[i].setdefault(k, []).append((j, -c))
    return table


def _commutator(a: Mapping[tuple[int, int], Any], b: Mapping[tuple[int, int], Any]) -> dict[tuple[int, int], Any]:
    result = sparse_product(a, b)
    for place, value in sparse_product(b, a).items():
        result[place] = result[place] - value if place in result else -value
    return result


def sparse_product(a: Mapping[tuple[int, int], Any], b: Mapping[tuple[int, int], Any]) -> dict[tuple[int, int], Any]:
    """The product of two matrices by their nonzero entries."""
    rows: dict[int, list[tuple[int, Any]]] = {}
    for (i, j), value in b.items():
        rows.setdefault(i, []).append((j, value))
    result: dict[tuple[int, int], Any] = {}
    for (i, j), value in a.items():
        for k, other in rows.get(j, ()):
            term = value * other
            result[i, k] = result[i, k] + term if (i, k) in result else term
    return result


def _generate(algebra: MatrixAlgebra, chosen: list[int], field: Coefficients) -> bool:
    """Whether basis elements generate the algebra: proved modulo a prime, where a dimension can only be lower."""
    from flint import nmod_mat

    residues = field.residues(1)
    if residues is None:
        return False
    d, p = algebra.dimension, residues.p
    action: dict[int, dict[int, list[tuple[int, int]]]] = {j: {} for j in chosen}
    for (i, j), row in algebra.brackets.items():
        for a, b, sign in ((i, j, 1), (j, i, -1)):
            if a in action:
                action[a][b] = [(k, sign * residues(field.read(c)) % p) for k, c in row.items()]
    rows = [[int(k == j) for k in range(d)] for j in chosen]
    rank = 0
    while len(rows) > rank:
        rank = len(rows)
        moved = [_moved(row, action[j], p) for row in rows for j in chosen]
        reduced, n = nmod_mat(rows + moved, p).rref()
        rows = [[int(reduced[r, c]) for c in range(d)] for r in range(n)]
    return rank == d


def _moved(row: list[int], action: dict[int, list[tuple[int, int]]], p: int) -> list[int]:
    result = [0] * len(row)
    for b, value in enumerate(row):
        if value:
            for k, c in action.get(b, ()):
                result[k] = (result[k] + c * value) % p
    return result
