"""What the structure constants of a Lie algebra decide: Jacobi, the Killing form, the central and derived series.

Everything is computed from the sparse brackets in exact arithmetic (`algebra.coefficients`); symbols are taken as
generic.
References: Humphreys, Introduction to Lie Algebras and Representation Theory (1972), sections 1-5.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations, pairwise
from operator import mul
from typing import Any, TypeAlias

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.echelon import Echelon, Vector
from liepoisson.algebra.exact_numbers import Exact, ExactMatrix, symbols_of
from liepoisson.algebra.number_fields import Element
from liepoisson.algebra.quadratic_forms import diagonalise
from liepoisson.algebra.real_fields import RealRationals, real_field
from liepoisson.errors import ParameterError
from liepoisson.inputs.calls import explains_its_methods

_FEW = 100  # distinct constants up to which products are remembered: at most 4 x 10^4 of them

Triple: TypeAlias = tuple[int, int, int]


@explains_its_methods
@dataclass(frozen=True)
class Subspace:
    """A linear subspace of a Lie algebra by a basis in its coordinates; of an ideal a reduced echelon one.

    Example:
        >>> lp.algebras.se(2).radical().dimension
        3

    Attributes:
        basis: The vectors, shape (m, n).
    """

    basis: ExactMatrix

    @property
    def dimension(self) -> int:
        """Number of basis vectors."""
        return len(self.basis)


class LieStructure:
    r"""The structure constants of an algebra, read into the field that they generate.

    Args:
        dimension: The dimension n.
        brackets: $c_{ij}^k$ for i < j, the nonzero ones.
        more: Other numbers that the field is to contain.
    """

    def __init__(
        self,
        dimension: int,
        brackets: Mapping[tuple[int, int], Mapping[int, Exact]],
        more: Iterable[Exact] = (),
    ) -> None:
        self.dimension = dimension
        self.field = Coefficients.containing([*(c for row in brackets.values() for c in row.values()), *more])
        self.zero: Exact = self.field.write(self.field.zero)
        self.brackets: dict[tuple[int, int], Vector] = {}
        self.ad: list[dict[int, Vector]] = [{} for _ in range(dimension)]
        # Equal constants share one number, so that products of the same two need to be made only once.
        numbers = {c: _without_denominator(self.field.read(c)) for row in brackets.values() for c in row.values()}
        opposite = {c: numbers.get(-c, -number) for c, number in numbers.items()}
        self._multiply = _remembered_product() if len(numbers) <= _FEW else mul
        for (i, j), row in brackets.items():
            self.brackets[i, j] = self.ad[i][j] = {k: numbers[c] for k, c in row.items()}
            self.ad[j][i] = {k: opposite[c] for k, c in row.items()}

    def jacobi_residuals(self) -> dict[Triple, dict[int, Exact]]:
        r"""The components of $[[e_i, e_j], e_k]$ + cyclic that are not zero, by i < j < k, then by component."""
        sums: dict[Triple, Vector] = {}
        multiply = self._multiply
        for (i, j), row in self.brackets.items():
            for s, first in row.items():
                for k, second in self.ad[s].items():
                    if k in (i, j):
                        continue  # [[e_i, e_j], e_i] + cyclic vanishes by antisymmetry alone
                    residual = sums.setdefault(tuple(sorted((i, j, k))), {})  # pyright: ignore[reportArgumentType]
                    # For i < k < j the cyclic sum of (i, k, j) has [[e_j, e_i], e_k] = c_ij^s [e_k, e_s].
                    for m, value in (self.ad[k][s] if i < k < j else second).items():
                        term = multiply(first, value)
                        residual[m] = residual[m] + term if m in residual else term
        nonzero = {triple: self._nonzero(sums[triple]) for triple in sorted(sums)}
        write = self.field.write
        return {t: {m: write(v, 2) for m, v in sorted(row.items())} for t, row in nonzero.items() if row}

    def killing_form(self) -> ExactMatrix:
        r"""The matrix $\kappa_{ij} = \operatorname{tr}(\mathrm{ad}_i\, \mathrm{ad}_j) = c_{ik}^l c_{jl}^k$."""
        return tuple(self._dense(row, 2) for row in self.killing_rows())

    def killing_rank(self) -> int:
        """The rank of the Killing form; the algebra is semisimple when it is the dimension (Cartan)."""
        span = Echelon(self.field)
        for row in self.killing_rows():
            span.insert(row)
        return len(span)

    def derived_series(self) -> tuple[Subspace, ...]:
        r"""The ideals $g \supset [g, g] \supset [[g, g], [g, g]] \supset \dots$ until they repeat or vanish."""
        return self._series(lambda ideal: self.span_of_brackets(ideal, ideal))

    def lower_central_series(self) -> tuple[Subspace, ...]:
        r"""The ideals $g \supset [g, g] \supset [g, [g, g]] \supset \dots$ until they repeat or vanish."""
        whole = self.whole()
        return self._series(lambda ideal: self.span_of_brackets(whole, ideal))

    def centre(self) -> Subspace:
        r"""The elements z with $[z, e_j] = 0$ for all j."""
        equations = Echelon(self.field)
        for j in range(self.dimension):
            components: dict[int, Vector] = {}
            for i, row in self.ad[j].items():
                for k, c in row.items():
                    components.setdefault(k, {})[i] = c
            for row in components.values():
                equations.insert(row)
        centre = Echelon(self.field)
        for vector in equations.null_space(self.dimension):
            centre.insert(vector)
        return self.subspace(centre.basis())

    def killing_rows(self) -> list[Vector]:
        """The Killing form as sparse rows of elements of the field."""
        by_entry: dict[tuple[int, int], list[tuple[int, Element]]] = {}
        for j, rows in enumerate(self.ad):
            for l, row in rows.items():
                for k, c in row.items():
                    by_entry.setdefault((l, k), []).append((j, c))
        form: list[Vector] = [{} for _ in range(self.dimension)]
        for i, rows in enumerate(self.ad):
            for k, row in rows.items():
                for l, c in row.items():
                    for j, d in by_entry.get((l, k), ()):
                        form[i][j] = form[i][j] + c * d if j in form[i] else c * d
        return [self._nonzero(row) for row in form]

    def _series(self, following: Callable[[list[Vector]], list[Vector]]) -> tuple[Subspace, ...]:
        series = [self.whole()]
        while series[-1]:
            ideal = following(series[-1])
            if len(ideal) == len(series[-1]):
                break
            series.append(ideal)
        return tuple(self.subspace(ideal) for ideal in series)

    def whole(self) -> list[Vector]:
        """The basis itself."""
        return [{i: self.field.one} for i in range(self.dimension)]

    def span_of_brackets(self, first: list[Vector], second: list[Vector]) -> list[Vector]:
        """The reduced echelon basis of [a, b], a and b bases of ideals with a containing b."""
        span = Echelon(self.field)
        if len(first) == len(second) == self.dimension:
            vectors: Iterable[Vector] = self.brackets.values()
        elif first is second:
            vectors = (self.bracket(u, v) for u, v in combinations(first, 2))
        else:
            vectors = (self.bracket(u, v) for u in first for v in second)
        for vector in vectors:
            span.insert(vector)
            if len(span) == len(second):
                break  # an ideal contains its brackets with anything
        return span.basis()

    def bracket(self, u: Vector, v: Vector) -> Vector:
        """The bracket of two elements."""
        result: Vector = {}
        for i, a in u.items():
            for j in v.keys() & self.ad[i].keys():
                for k, c in self.ad[i][j].items():
                    result[k] = result[k] + a * v[j] * c if k in result else a * v[j] * c
        return self._nonzero(result)

    def _nonzero(self, vector: Vector) -> Vector:
        return {k: value for k, value in vector.items() if not self.field.vanishes(value)}

    def subspace(self, vectors: list[Vector]) -> Subspace:
        """The span of a reduced echelon basis."""
        # Scaling all structure constants does not move a subspace: its basis is homogeneous of degree 0.
        return Subspace(tuple(self._dense(vector, 0) for vector in vectors))

    def _dense(self, vector: Vector, degree: int) -> tuple[Exact, ...]:
        write = self.field.write
        return tuple(write(vector[k], degree) if k in vector else self.zero for k in range(self.dimension))


def signature(form: ExactMatrix) -> tuple[int, int, int]:
    r"""Numbers of positive, negative and zero eigenvalues of a symmetric form.

    Of a rational form all roots of the characteristic polynomial are real, so that Descartes' rule of signs counts the
    positive ones exactly.  Another one is made diagonal in the field of its entries, by Sylvester's law of inertia.

    Raises:
        ParameterError: symbols leave the signature open, or there is no exact field of real numbers with the entries.
    """
    from flint import fmpq, fmpq_mat

    entries = [value for row in form for value in row]
    if names := sorted(set[str]().union(*map(symbols_of, entries))):
        raise ParameterError(
            f"a signature needs a form of numbers; got the symbols {', '.join(names)}. Give values to them with "
            "substitute."
        )
    n, field = len(form), real_field(entries)
    if not isinstance(field, RealRationals):
        read = [[field.read(value) for value in row] for row in form]
        signs = [field.sign(q) for _, q in diagonalise(field, read)]
        return signs.count(1), signs.count(-1), n - len(signs)
    rational: Any = [field.write(field.read(value)) for value in entries]
    matrix: Any = fmpq_mat(n, n, [fmpq(value.numerator, value.denominator) for value in rational])
    signs = [c > 0 for c in matrix.charpoly().coeffs() if c != 0]
    positive = sum(first != second for first, second in pairwise(signs))
    rank = int(matrix.rref()[1])
    return positive, rank - positive, n - rank


def _remembered_product() -> Callable[[Element, Element], Element]:
    """Multiplication that makes each product once; for the few numbers that one `LieStructure` keeps alive."""
    products: dict[tuple[int, int], Element] = {}

    def multiply(a: Element, b: Element) -> Element:
        key = (id(a), id(b))
        if key not in products:
            products[key] = a * b
        return products[key]

    return multiply


def _without_denominator(number: Element) -> Element:
    """An int in place of a whole Fraction: sums and products take half the time; only quotients are to be avoided."""
    return number.numerator if isinstance(number, Fraction) and number.denominator == 1 else number
