r"""Cohomology of Lie algebras with coefficients in a module, exactly.

$H^k(g, M) = Z^k/B^k$ with the cocycles $Z^k = \ker d_k$ and the coboundaries $B^k = \operatorname{im} d_{k-1}$ of
`cochains`.  The complex falls into parts of one weight (`gradings`), of which only those count that are not acyclic.
In each of these:

1. Ranks modulo a prime are at most the true ones, so that $\dim C^k - \operatorname{rank} d_k -
   \operatorname{rank} d_{k-1}$ modulo the prime is at least $\dim H^k$.  Where it is zero, that is a proof.
2. Otherwise the vectors with $d_k f = 0$ and $d_{k-1}^T f = 0$ are computed exactly.  Over the real numbers (and over
   fields of functions with real coefficients) a sum of squares vanishes only if all of them do: these harmonic
   cochains are a complement of $B^k$ in $Z^k$, one for each class.

References: Chevalley and Eilenberg (1948); Hochschild and Serre (1953).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import comb, lcm
from typing import Any, TypeAlias

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.echelon import transposed
from liepoisson.algebra.exact_numbers import Exact
from liepoisson.algebra.linear_algebra import nullspace, nullspace_mod, rank, rank_mod, solve
from liepoisson.algebra.residues import PRIME, Residues
from liepoisson.errors import BracketError, ParameterError
from liepoisson.formula.scalars import as_count, as_deadline
from liepoisson.inputs.calls import explains_its_arguments, explains_its_methods
from liepoisson.inputs.deadline import SEARCH_LIMIT, checkpoint
from liepoisson.inputs.refusals import not_a
from liepoisson.structure.bracket import Bracket
from liepoisson.structure.casimirs import special_values
from liepoisson.structure.lie.cochains import (
    Cochain,
    Differential,
    Indices,
    LieModule,
    Vector,
    check_closed,
    cochain_of,
    field_of,
    integral,
    labels,
    polynomial,
    read_cochain,
    read_module,
)
from liepoisson.structure.lie.gradings import Acyclic, Grading
from liepoisson.structure.lie_algebra import LieAlgebra

MOST_COCHAINS = 2_000_000
"""Basis cochains of the largest complex that is begun, up to the degree that is asked for: they are listed by weight.

A million take 20 s and 0.6 GB for H^10 of heisenberg(10), with 58,786 classes; 0.6 million take 1.3 s for H^3 of so(10)
with adjoint coefficients.
"""

_MOST_PRIMES = 20
"""Primes that are tried until constants have images: all but those that divide a denominator will do."""

AlgebraLike: TypeAlias = "LieAlgebra | Bracket"
"""A Lie algebra, or a bracket that stands for g (x) A."""

Coefficient: TypeAlias = "str | Sequence[object]"
"""The name of a module, or the matrices of a representation."""

CochainLike: TypeAlias = "Cochain | Mapping[Any, Any]"
"""A cochain, or its values by basis elements."""


@explains_its_arguments
def current_algebra(bracket: Bracket) -> LieAlgebra:
    r"""The Lie algebra $g \otimes A$ of a bracket, $[x \otimes a, y \otimes b] = [x, y] \otimes ab$, as one algebra.

    Example:
        >>> motions = lp.algebras.current_algebra(lp.so(3) @ lp.semidirect(2))
        >>> motions.dimension, motions.basis_names
        (6, ('l1', 'l2', 'l3', 'alpha1', 'alpha2', 'alpha3'))

    Args:
        bracket: A bracket without constant part; its coordinates name the basis.

    Raises:
        ParameterError: not a bracket, or there are more than 1000 coordinates.
        BracketError: the bracket has a constant part: its algebra is a central extension.
    """
    if not isinstance(bracket, Bracket):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise not_a("a Bracket", bracket, "bracket", "write for example so(3) @ leibniz(3)")
    if bracket.constant:
        raise BracketError(
            f"bracket: wanted one without constant part; got {bracket!r}. A constant part is a 2-cocycle: take "
            "algebras.central_extension of the bracket without it."
        )
    brackets: dict[tuple[int, int], dict[int, Exact]] = {}
    for i, j, m, c in bracket.entries():  # {x_i, x_j} = -c_ij^m x_m
        row = brackets.setdefault((i, j), {})
        row[m] = row[m] - c if m in row else -c
    names = bracket.coordinate_names_in_order
    return LieAlgebra.from_brackets(bracket.dimension, brackets, repr(bracket), names, check=False)


def read_algebra(given: object) -> LieAlgebra:
    """The Lie algebra that a caller gives, or that of his bracket.

    Raises:
        ParameterError: neither.
        BracketError: a bracket with a constant part, or the Jacobi identity fails.
    """
    algebra = current_algebra(given) if isinstance(given, Bracket) else given
    if not isinstance(algebra, LieAlgebra):
        raise not_a("a LieAlgebra or a Bracket", given, "given", "write for example so(3), or so(3) @ leibniz(3)")
    if residuals := algebra.jacobi_residuals():  # of one made with check=False
        names = ", ".join(labels(algebra.basis_names)[k] for k in next(iter(residuals)))
        raise BracketError(
            f"given: wanted a Lie algebra; in {algebra.name} the Jacobi identity fails for ({names}). Correct its "
            "brackets: without it the square of the differential is not zero."
        )
    return algebra


@explains_its_methods
@dataclass(frozen=True)
class ExceptionalCohomology:
    """Values of parameters at which there is more cohomology than in general.

    Attributes:
        condition: For example "k = -1".
        cohomology: The cohomology there.
    """

    condition: str
    cohomology: LieCohomology


@explains_its_methods
@dataclass(frozen=True, eq=False)
class LieCohomology:
    r"""The cohomology $H^k(g, M) = Z^k/B^k$ of a Lie algebra.

    Example:
        >>> found = lp.algebras.cohomology(lp.algebras.heisenberg(1), 2)
        >>> print(found)
        H^2(heisenberg(1), trivial) has dimension 2: q1^c, p1^c
        >>> found.cocycle_dimension, found.coboundary_dimension
        (3, 1)

    Attributes:
        algebra: The Lie algebra g; that of a bracket has the coordinates as its basis.
        coefficients: "trivial", "adjoint", "coadjoint", or "representation" for a module that was given by matrices.
        degree: k.
        dimension: Of $H^k$.
        cocycle_dimension: Of $Z^k$.
        coboundary_dimension: Of $B^k$.
        representatives: One cocycle for each basis element of $H^k$, orthogonal to all coboundaries in the given basis.
        proved: Whether all this is proved.  It is, unless the constants contain functions of symbols that SymPy can
            only simplify.
        exceptional: Real values of symbols at which the dimension is larger; otherwise symbols are generic.
        examined: All values that had to be looked at; elsewhere the generic answer holds.
        undecided: Conditions on symbols that were not looked at.
        complex: The complex, for computations with cochains.
    """

    algebra: LieAlgebra
    coefficients: str
    degree: int
    dimension: int
    cocycle_dimension: int
    coboundary_dimension: int
    representatives: tuple[Cochain, ...]
    proved: bool
    exceptional: tuple[ExceptionalCohomology, ...]
    examined: tuple[str, ...]
    undecided: tuple[str, ...]
    complex: Complex = field(repr=False)

    def split(self, cocycle: CochainLike) -> tuple[tuple[Exact, ...], Cochain]:
        r"""The class of a cocycle f, and a potential: $f = \sum_r a_r\,$`representatives[r]`$ + d\varphi$.

        Example:
            >>> so3 = lp.so(3)
            >>> classes, potential = lp.algebras.cohomology(so3, 2).split({("1", "2"): 1})
            >>> classes, str(potential)  # (d phi)(x, y) = -phi([x, y])
            ((), '-e3')

        Args:
            cocycle: A cochain, or its values by names or numbers of basis elements, {("e1", "e2"): {"e3": 1}}; numbers
                with trivial coefficients.

        Returns:
            The $a_r$, and $\varphi$, a cochain of one degree less.

        Raises:
            CochainError: it is no cocycle; the error names the basis elements and the residual.
            ParameterError: the degree is 0, or an entry is not exact.
            BracketError: an unknown basis element, or one set of them twice.
        """
        read = read_cochain(self.algebra, self.complex.module, self.degree, cocycle)
        check_closed(read)
        return self.complex.split(read, self.representatives)

    def __str__(self) -> str:
        text, shown = (
            repr(self),
            (", " if self.coefficients == "trivial" else " | ").join(map(str, self.representatives)),
        )
        text += f": {shown}" if shown else ""
        for case in self.exceptional:
            text += f"; {case.condition}: dimension {case.cohomology.dimension}"
        if self.undecided:
            text += f"; not looked at: {', '.join(self.undecided)}"
        return text

    def __repr__(self) -> str:
        return f"H^{self.degree}({self.algebra.name}, {self.coefficients}) has dimension {self.dimension}"


@explains_its_arguments
def cohomology(
    given: AlgebraLike, degree: int, coefficients: Coefficient = "trivial", *, time_limit: float = SEARCH_LIMIT
) -> LieCohomology:
    r"""The cohomology $H^k(g, M)$ of a finite-dimensional Lie algebra, by Chevalley and Eilenberg's complex, exactly.

    $H^2(g, \mathbb R)$ are the central extensions and the constant parts of brackets modulo translations, $H^1(g, g)$
    the outer derivations, $H^2(g, g)$ the infinitesimal deformations, and $H^3(g, g)$ has their obstructions.

    Example:
        >>> galilei = lp.algebras.galilei(3)
        >>> print(lp.algebras.cohomology(galilei, 2))  # the mass
        H^2(galilei(3), trivial) has dimension 1: K1^P1 + K2^P2 + K3^P3
        >>> lp.algebras.cohomology(lp.so(3) @ lp.leibniz(4), 2, "adjoint").dimension  # those of R[z]/z^4
        3

    Args:
        given: A Lie algebra, or a bracket without constant part: its algebra $g \otimes A$.  Symbols are generic.
        degree: k, at least 0.
        coefficients: M: "trivial", "adjoint", "coadjoint", or the matrices of a representation, shape (dim g, m, m).
        time_limit: Seconds after which the search is given up.

    Raises:
        ParameterError: not an algebra, no such module, or the complex is too large; the message says what would fit.
        BracketError: the matrices are no representation (the message names a pair and the residual), the bracket has
            a constant part, or the Jacobi identity fails.
        ShapeError: not one square matrix per basis element.
        TimeLimitError: the time has passed.

    References: Chevalley and Eilenberg (1948).
    """
    with as_deadline(time_limit).running():
        algebra, k = read_algebra(given), as_count(degree, "degree")
        module = read_module(algebra, coefficients)
        _check_size(algebra, module, k)
        return _cohomology(Complex(algebra, module), k)


def _check_size(algebra: LieAlgebra, module: LieModule, degree: int) -> None:
    n, m = algebra.dimension, module.dimension

    def size(k: int) -> int:
        return m * sum(comb(n, j) for j in range(min(k, n) + 1))

    if size(degree) > MOST_COCHAINS:
        fits = next((k for k in range(degree - 1, -1, -1) if size(k) <= MOST_COCHAINS), None)
        instead = f"Degree {fits} would fit, with {size(fits):,}" if fits is not None else "Take a smaller algebra"
        raise ParameterError(
            f"degree: wanted a complex with at most {MOST_COCHAINS:,} basis cochains up to this degree; got degree "
            f"{degree} of {algebra.name}, with {size(degree):,}. {instead}."
        )


def _cohomology(of: Complex, degree: int) -> LieCohomology:
    parts = of.parts(degree)
    vectors: list[Vector] = []
    cocycles = coboundaries = 0
    for part in parts:
        checkpoint("the cohomology")
        found, incoming, outgoing = of.harmonic(part)
        vectors += found
        cocycles += len(part.cochains) - outgoing
        coboundaries += incoming
    exceptional, examined, undecided = _exceptional(of, degree, cocycles - coboundaries)
    return LieCohomology(
        algebra=of.algebra,
        coefficients=of.module.kind,
        degree=degree,
        dimension=len(vectors),
        cocycle_dimension=cocycles,
        coboundary_dimension=coboundaries,
        representatives=tuple(cochain_of(of.algebra, of.module, degree, v, of.field) for v in map(of.tidied, vectors)),
        proved=of.field.decides,
        exceptional=exceptional,
        examined=examined,
        undecided=undecided,
        complex=of,
    )


def _exceptional(
    of: Complex, degree: int, dimension: int
) -> tuple[tuple[ExceptionalCohomology, ...], tuple[str, ...], tuple[str, ...]]:
    """The values of symbols at which the dimension is another one."""
    if not of.field.parameters:
        return (), (), ()
    values, undecided = special_values(of.pivots, of.field)
    cases: list[ExceptionalCohomology] = []
    for condition, substitution in values:
        try:
            algebra = of.algebra.substitute(_known(substitution, of.algebra.symbols))
            module = of.module.substitute(substitution)
        except ParameterError:  # the constants have a pole
            continue
        found = _cohomology(Complex(algebra, module), degree)
        if found.dimension != dimension:
            cases.append(ExceptionalCohomology(condition, found))
    return tuple(cases), tuple(condition for condition, _ in values), undecided


def _known(values: Mapping[str, Exact], names: set[str]) -> dict[str, Exact]:
    return {name: value for name, value in values.items() if name in names}


_Rows: TypeAlias = "tuple[list[dict[int, Any]], list[dict[int, Any]]]"


@dataclass(frozen=True)
class Part:
    """The cochains of one weight in three degrees.

    Attributes:
        below: Basis cochains of the degree below; empty if the part is acyclic.
        cochains: Those of the degree.
        acyclic_rank: The rank of the differential of the degree below; None if the part is not acyclic.
    """

    below: Sequence[tuple[Indices, int]]
    cochains: Sequence[tuple[Indices, int]]
    acyclic_rank: int | None


class Complex:
    """The complex of an algebra and a module.

    Args:
        algebra: The Lie algebra.
        module: The module.

    Attributes:
        field: The field of all constants.
        pivots: What was taken for not zero, elements of a field with parameters.
    """

    def __init__(self, algebra: LieAlgebra, module: LieModule) -> None:
        self.algebra, self.module = algebra, module
        self.field: Coefficients = field_of(algebra, module)
        self.pivots: list[Any] = []
        self._grading = Grading(algebra, module)
        self._acyclic = Acyclic(algebra, module, self.field)

    def __reduce__(self) -> tuple[type[Complex], tuple[LieAlgebra, LieModule]]:
        """What is pickled: the definition."""
        return type(self), (self.algebra, self.module)

    @cached_property
    def _exact(self) -> Differential:
        """The differential; over the rationals times the common denominator, in integers."""
        if not self.field.is_rational:
            return Differential(self.algebra, self.module, self.field.read)
        of_module = (c for rho in self.module.action for row in rho for c in row.values())
        constants = [c for row in self.algebra.brackets.values() for c in row.values()]
        scale = lcm(*(self.field.read(c).denominator for c in (*constants, *of_module)))
        return Differential(self.algebra, self.module, lambda c: int(self.field.read(c) * scale))

    @cached_property
    def _modular(self) -> tuple[Differential, int] | None:
        """The differential modulo a prime, and that; None where constants have no images."""
        if self.field.is_rational:
            return self._exact, PRIME
        for attempt in range(_MOST_PRIMES):
            residues = self.field.residues(1 + attempt, attempt)
            if residues is None:
                return None
            try:
                return Differential(self.algebra, self.module, _images(self.field, residues)), residues.p
            except (ValueError, ZeroDivisionError):  # a denominator vanishes modulo the prime
                continue
        return None

    def parts(self, degree: int) -> list[Part]:
        """The cochains of a degree by their weights."""
        below: dict[int, list[tuple[Indices, int]]] = {}
        here: dict[int, list[tuple[Indices, int]]] = {}
        for into, k in ((below, degree - 1), (here, degree)):
            for weight, place, a in self._grading.parts(k) if k >= 0 else ():
                into.setdefault(weight, []).append((place, a))
        gone = {w for w, cochains in here.items() if self._acyclic(*cochains[0])}
        self.pivots += self._acyclic.pivots
        ranks = dict.fromkeys(gone, 0)
        # in an acyclic part rank d_j = dim C^j - rank d_(j-1)
        for j in range(degree):
            sizes = dict.fromkeys(gone, 0)
            for weight, _, _ in self._grading.parts(j):
                if weight in gone:
                    sizes[weight] += 1
            ranks = {weight: sizes[weight] - r for weight, r in ranks.items()}
        return [
            Part([] if w in gone else below.get(w, []), cochains, ranks.get(w)) for w, cochains in sorted(here.items())
        ]

    def harmonic(self, part: Part) -> tuple[list[Vector], int, int]:
        """The harmonic cochains of a part, the rank of the differential that ends in it, and of the one from it."""
        size = len(part.cochains)
        if part.acyclic_rank is not None:
            return [], part.acyclic_rank, size - part.acyclic_rank
        incoming, outgoing, rows = self._modular_ranks(part)
        if incoming + outgoing == size and not self.field.parameters:
            return [], incoming, outgoing
        if not self.field.is_rational:
            rows = self._rows(self._exact, part)
        found = nullspace([row for pair in rows for row in pair if row], size, self.field)
        if self.field.parameters:  # those of each differential are shorter than those of both together
            self.pivots += [p for side in rows for p in nullspace(side, size, self.field).pivots]
        if incoming + outgoing + found.dimension != size:  # an unlucky prime, or none
            incoming = rank(rows[0], self.field)
            outgoing = size - found.dimension - incoming
        return [{part.cochains[k]: v for k, v in vector.items()} for vector in found.vectors], incoming, outgoing

    def _modular_ranks(self, part: Part) -> tuple[int, int, _Rows]:
        """Lower bounds of the ranks of both differentials, and their rows."""
        if self._modular is None:
            return 0, 0, ([], [])
        d, p = self._modular
        rows, size = self._rows(d, part), len(part.cochains)
        return rank_mod(rows[0], size, p), rank_mod(rows[1], size, p), rows

    def _rows(self, d: Differential, part: Part) -> _Rows:
        """The images of the cochains below, and the rows of the differential on the part; columns are its cochains."""
        number = {cochain: k for k, cochain in enumerate(part.cochains)}
        below, here = ([d(*c) for c in cochains] for cochains in (part.below, part.cochains))
        if d is self._exact and not self.field.decides:
            below, here = ([self._simplified(image) for image in images] for images in (below, here))
        numbered = [{number[key]: v for key, v in image.items() if v} for image in below]
        return numbered, transposed([{key: v for key, v in image.items() if v} for image in here])

    def _simplified(self, image: Vector) -> Vector:
        return {key: v for key, v in image.items() if not self.field.vanishes(v)}

    def tidied(self, vector: Vector) -> Vector:
        """A multiple with coprime integers or coprime polynomials; algebraic numbers stay as they are."""
        if self.field.is_rational:
            return integral(vector)
        return polynomial(vector) if self.field.parameters else vector

    def split(self, cocycle: Cochain, representatives: Sequence[Cochain]) -> tuple[tuple[Exact, ...], Cochain]:
        """See `LieCohomology.split`."""
        if cocycle.degree < 1:
            raise ParameterError("split: wanted a degree of at least 1; a 0-cochain has no potential")
        found = self.solved(cocycle, representatives)
        assert found is not None, "every cocycle is a sum of harmonic ones and a coboundary"
        return found

    def solved(self, target: Cochain, others: Sequence[Cochain] = ()) -> tuple[tuple[Exact, ...], Cochain] | None:
        r"""Numbers $a_r$ and a cochain with $\sum_r a_r f_r + d\varphi$ equal to a target; None if there are none."""
        values = [v for f in (target, *others) for row in f.values.values() for v in row.values()]
        field = field_of(self.algebra, self.module, values)
        d = Differential(self.algebra, self.module, field.read)

        def vector(f: Cochain) -> Vector:
            return {(place, a): field.read(v) for place, row in f.values.items() for a, v in row.items()}

        wanted = vector(target)
        rest = [vector(f) for f in others]
        weights = {(place, a): w for w, place, a in self._grading.parts(target.degree)}
        touched = {weights[key] for v in (wanted, *rest) for key in v}
        below = [(place, a) for w, place, a in self._grading.parts(target.degree - 1) if w in touched]
        columns = [{key: v for key, v in d(*c).items() if not field.vanishes(v)} for c in below]
        chosen = independent_columns(columns, field)
        found = solve([*rest, *(columns[k] for k in chosen)], wanted, field)
        if found is None and len(chosen) < len(columns):  # the prime was unlucky
            chosen = range(len(columns))
            found = solve([*rest, *columns], wanted, field)
        if found is None:
            return None
        numbers = tuple(field.write(c) for c in found[: len(rest)])
        potential: Vector = {below[k]: v for k, v in zip(chosen, found[len(rest) :], strict=True)}
        return numbers, cochain_of(self.algebra, self.module, target.degree - 1, potential, field)


def _images(field: Coefficients, residues: Residues) -> Callable[[Exact], int]:
    return lambda value: residues(field.read(value))


def independent_columns(columns: Sequence[Vector], field: Coefficients) -> Sequence[int]:
    """Columns that are independent, as many as there are modulo a prime; over other fields than Q all."""
    if not field.is_rational:
        return range(len(columns))
    number = {key: k for k, key in enumerate({key: None for column in columns for key in column})}
    rows: list[dict[int, int]] = [{} for _ in number]
    prime = field.residues(1)
    assert prime is not None
    for k, column in enumerate(columns):
        for key, value in column.items():
            rows[number[key]][k] = prime(value)
    free = {max(v) for v in nullspace_mod(rows, len(columns), PRIME)} if rows else set(range(len(columns)))
    return [k for k in range(len(columns)) if k not in free]
