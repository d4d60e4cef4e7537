r"""Proofs about a bracket as objects that say what was computed: the Jacobi identity, the rank, and Casimirs."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import combinations
from math import comb, lcm
from operator import mul
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.exact_numbers import Coefficient, Exact, is_zero, product_of
from liepoisson.algebra.linear_algebra import rank
from liepoisson.algebra.symbol_polynomials import SymbolPolynomial
from liepoisson.errors import CocycleError
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.structure.poisson.poisson_tensor import CONSTANT, LinearPoissonTensor

if TYPE_CHECKING:
    from sympy import Expr


_FORWARD = ((0, 1, 2), (1, 2, 0), (2, 0, 1))


@dataclass(frozen=True)
class Failure:
    r"""A pair or a triple of coordinates at which antisymmetry or the Jacobi identity fails.

    Attributes:
        coordinates: Their names.
        residual: $\{x_i, x_j\} + \{x_j, x_i\}$ for a pair, the cyclic sum of $\{\{x_i, x_j\}, x_k\}$ for a triple.
    """

    coordinates: tuple[str, ...]
    residual: Expr

    def __str__(self) -> str:
        law = "antisymmetry" if len(self.coordinates) == 2 else "the Jacobi identity"
        return f"{law} fails for ({', '.join(self.coordinates)}): {self.residual} instead of 0"


@explains_its_methods
@dataclass(frozen=True)
class JacobiCertificate:
    """Whether the bracket is antisymmetric and obeys the Jacobi identity, decided entry by entry.

    Example:
        >>> wrong = lp.LieAlgebra.from_brackets(3, {(0, 1): {2: 1}, (0, 2): {0: 1}}, check=False)
        >>> certificate = (wrong @ lp.trivial()).jacobi_certificate()
        >>> certificate.holds
        False
        >>> print(certificate.failures[0])
        the Jacobi identity fails for (l1, l2, l3): -l3 instead of 0

    Attributes:
        holds: The verdict.
        n_triples: Number of triples i < j < k of coordinates.
        method: What was computed, in words.
        failures: The first pair or triple that fails; empty if the identity holds.
        n_points: Random points at which it was only tried, where it is not decided; 0 where it is.
    """

    holds: bool
    n_triples: int
    method: str
    failures: tuple[Failure, ...] = ()
    n_points: int = 0

    @property
    def proved(self) -> bool:
        """Whether the identity holds and was decided, not only tried at points."""
        return self.holds and not self.n_points

    def __str__(self) -> str:
        if not self.holds:
            return "; ".join(str(f) for f in self.failures)
        return f"Jacobi identity {'not refuted' if self.n_points else 'proved'} ({self.method})"


@explains_its_methods
@dataclass(frozen=True)
class RankCertificate:
    """Bounds of the rank of the Poisson tensor at a generic point.

    Example:
        >>> certificate = (lp.so(3) @ lp.leibniz(3)).rank_certificate()
        >>> certificate.lower, certificate.upper, certificate.proved
        (6, 6, True)

    Attributes:
        lower: Rank at one point, hence proved.
        upper: Number of coordinates minus the independent Casimirs found, or the largest even number; proved.
        dimension: Number of coordinates.
        method: Where the bounds come from, in words.
    """

    lower: int
    upper: int
    dimension: int
    method: str

    @property
    def proved(self) -> bool:
        """Whether the bounds meet."""
        return self.lower == self.upper

    def __str__(self) -> str:
        if self.proved:
            return f"rank {self.lower} proved ({self.method})"
        return f"rank at least {self.lower}, at most {self.upper} ({self.method})"


@explains_its_methods
@dataclass(frozen=True)
class CasimirCertificate:
    r"""Whether a function is a Casimir, $\{x_i, C\} = 0$ for all coordinates.

    Example:
        >>> bracket = lp.algebras.bianchi("VII") @ lp.trivial()
        >>> bracket.casimir_certificate("sqrt(l2^2 + l3^2)").proved
        True
        >>> print(bracket.casimir_certificate("l2"))
        l2 is no Casimir: {l1, l2} = -l3

    Attributes:
        function: The function.
        holds: The verdict.
        proved: Whether it is exact; if not, it was tried at random points in decimals.
        residual: A bracket $\{x_i, C\}$ that is not zero, by the name of the coordinate.
        method: How it was decided, in words.
    """

    function: Expr
    holds: bool
    proved: bool
    residual: Mapping[str, Expr] = field(hash=False)
    method: str

    def __str__(self) -> str:
        if self.holds:
            return f"{self.function} is a Casimir ({self.method})"
        name, value = next(iter(self.residual.items()))
        return f"{self.function} is no Casimir: {{{name}, {self.function}}} = {value}"


def jacobi_certificate(tensor: LinearPoissonTensor, names: tuple[str, ...]) -> JacobiCertificate:
    """Antisymmetry of all pairs, then the Jacobi identity of all triples of coordinates, from the entries."""
    n_triples = comb(tensor.dimension, 3)
    counted = {0: "pairs; there are no triples", 1: "the one triple"}.get(n_triples, f"all {n_triples} triples")
    method = f"computed: {counted} of coordinates"

    def failed(indices: tuple[int, ...], residual: dict[int, Any]) -> JacobiCertificate:
        coordinates = tuple(names[i] for i in indices)
        # For pairs linear, for triples quadratic in the coefficients of the bracket.
        failure = Failure(coordinates, _form(tensor, residual, names, len(indices) - 1))
        return JacobiCertificate(False, n_triples, method, (failure,))

    for i, row in enumerate(tensor.rows):
        for j in row:
            if residual := _nonzero(tensor, _collect((*row[j], *tensor.rows[j].get(i, ())))):
                return failed((i, j), residual)
    rows, scale = _integers(tensor)
    times = _remembered_products()
    for triple in combinations(range(tensor.dimension), 3):
        if residual := _nonzero(tensor, _cyclic_sum(rows, triple, times)):
            square = None if scale is None else scale**2
            exact = residual if square is None else {m: Fraction(v, square) for m, v in residual.items()}
            return failed(triple, exact)
    return JacobiCertificate(True, n_triples, method)


def check_cocycle(tensor: LinearPoissonTensor, names: tuple[str, ...]) -> None:
    """Verify that the constant part is a 2-cocycle of the linear part, whether or not that obeys the Jacobi identity.

    Raises:
        CocycleError: it is none; the error names the first triple that fails.
    """
    rows, scale = _integers(tensor)
    times = _remembered_products()
    for triple in combinations(range(tensor.dimension), 3):
        total = _nonzero(tensor, _cyclic_sum(rows, triple, times))
        if CONSTANT in total:
            value = total[CONSTANT]
            exact = value if scale is None else Fraction(value, scale**2)
            residual = _form(tensor, {CONSTANT: exact}, names, 2)
            raise CocycleError(tuple(names[i] for i in triple), str(residual))


def is_cocycle(dimension: int, coefficients: Iterable[tuple[int, int, int | None, Coefficient]]) -> bool:
    """Whether the constant part is a 2-cocycle for all values of the symbols; False where this takes SymPy, too.

    Args:
        dimension: Number of coordinates.
        coefficients: The bracket, all (i, j, m, c) with i < j; m is None in the constant part.
    """
    rows: list[dict[int, list[tuple[int, Coefficient]]]] = [{} for _ in range(dimension)]
    for i, j, m, c in coefficients:
        if not isinstance(c, (Fraction, SymbolPolynomial)):
            return False
        place = CONSTANT if m is None else m
        rows[i].setdefault(j, []).append((place, c))
        rows[j].setdefault(i, []).append((place, -c))
    triples = combinations(range(dimension), 3)
    return all(is_zero(_cyclic_sum(rows, triple, mul).get(CONSTANT, Fraction(0))) for triple in triples)


def _cyclic_sum(rows: Any, triple: tuple[int, int, int], times: Callable[[Any, Any], Any]) -> dict[int, Any]:
    total: dict[int, Any] = {}
    for a, b, c in _FORWARD:
        for m, u in rows[triple[a]].get(triple[b], ()):
            if m == CONSTANT:  # it commutes with everything
                continue
            for k, v in rows[m].get(triple[c], ()):
                product = times(u, v)
                total[k] = total[k] + product if k in total else product
    return {k: value for k, value in total.items() if value}


def _nonzero(tensor: LinearPoissonTensor, residual: dict[int, Any]) -> dict[int, Any]:
    """What is left after the relations that the field hides."""
    return {m: value for m, value in residual.items() if not tensor.field.vanishes(value)}


def _integers(tensor: LinearPoissonTensor) -> tuple[Any, int | None]:
    """The coefficients multiplied by their common denominator, which is faster; over other fields as they are."""
    if not tensor.field.is_rational:
        return tensor.rows, None
    scale = lcm(*(c.denominator for *_, c in tensor.terms()))
    return [{j: [(m, int(c * scale)) for m, c in form] for j, form in row.items()} for row in tensor.rows], scale


def _remembered_products() -> Callable[[Any, Any], Any]:
    """Multiplication that remembers: structure constants have few different values, and some are slow to multiply."""
    known: dict[tuple[int, int], tuple[Any, Any, Any]] = {}

    def times(u: Any, v: Any) -> Any:
        if isinstance(u, int):
            return u * v
        key = id(u), id(v)
        if key not in known:
            known[key] = u, v, u * v  # the factors are kept alive, so that their ids stay theirs
        return known[key][2]

    return times


def _collect(form: tuple[tuple[int, Any], ...]) -> dict[int, Any]:
    total: dict[int, Any] = {}
    for m, c in form:
        total[m] = total[m] + c if m in total else c
    return {m: c for m, c in total.items() if c}


def _form(tensor: LinearPoissonTensor, residual: dict[int, Any], names: tuple[str, ...], degree: int) -> Expr:
    from sympy import S, Symbol

    terms = (
        tensor.field.to_sympy(c, degree) * (S.One if m == CONSTANT else Symbol(names[m])) for m, c in residual.items()
    )
    return sum(terms, S.Zero)


def rank_at(dimension: int, terms: Sequence[tuple[int, int, int, Exact]], point: Sequence[Exact]) -> int:
    """The exact rank at a point; parameters in the terms are generic.

    Args:
        dimension: Number of coordinates.
        terms: All (i, j, m, c) with J_ij the sum of c x_m; m is `CONSTANT` for the constant part.
        point: One exact number per coordinate.
    """
    point = [*point, Fraction(1)]
    sums: dict[tuple[int, int], list[Exact]] = {}
    for i, j, m, c in terms:
        if not is_zero(point[m]):
            sums.setdefault((i, j), []).append(product_of(c, point[m]))
    field = Coefficients.containing(value for values in sums.values() for value in values)
    rows: list[dict[int, Any]] = [{} for _ in range(dimension)]
    for (i, j), values in sums.items():
        elements = [field.read(value) for value in values]
        if total := sum(elements[1:], elements[0]):
            rows[i][j] = total
    return rank([row for row in rows if row], field)
