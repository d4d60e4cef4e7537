r"""Two criteria which prove that the identity component $G^0$ of a differential Galois group is not abelian.

Monodromy matrices belong to G, and a power of each element of G lies in $G^0$; a unipotent element lies in it itself.

**Exact.** Let all exponents at one point be rational, so that a power of the local monodromy is unipotent, with the
logarithm N up to a factor.  On a quotient $F_b/F_a$ of a flag let N map $F_b/F_{b-1}$ to $F_{a+1}/F_a$, not to zero,
and everything else to zero.  Let g be the local monodromy at another point.  If $G^0$ were abelian some power $g^m$
would commute with N, and $g^m$ would have a common eigenvalue on the image of N and on $F_b/F_{b-1}$: some difference
of an exponent on $F_{a+1}/F_a$ and one on $F_b/F_{b-1}$ would be rational.  It is checked exactly that none is (for
$a + 1 = b$: no difference of two of the exponents).

**Enclosed.** If no quotient of two different eigenvalues of g is a root of unity, g is a polynomial in each of its
powers $g^m$, and what commutes with $g^m$ commutes with g.  So if neither g nor h has such quotients, and $G^0$ is
abelian, then g and h commute.  From the exponents at a regular singular point follows exactly a power of the local
monodromy without such quotients (`Exponents.neat_power`); that two of these powers do not commute is proved by their
matrices in balls, if 0 is not in some ball of $gh - hg$.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

from flint import ctx, fmpq_poly
from sympy.polys.matrices import DomainMatrix

from liepoisson.algebra.function_fields import over_common_denominator
from liepoisson.errors import EnclosureError
from liepoisson.integrability.galois.linear_systems import LinearSystem, fraction
from liepoisson.integrability.galois.local_solutions import LocalSystem
from liepoisson.integrability.galois.monodromy import PRECISION, Monodromy, continued, generators, loop_around_all
from liepoisson.integrability.galois.variational import Flag

_MOST_TERMS = 64
"""Terms of local series in which solutions are compared with a flag."""

_MOST_LOOPS = 12
"""Singular points around which monodromy matrices are computed."""


@dataclass(frozen=True)
class LogarithmOnFlag:
    """The logarithm N of the local monodromy on a quotient F_high / F_low on which it is minimal."""

    point: Any  # the irreducible polynomial of the singular point; None for infinity
    low: int  # a
    high: int  # b
    rank: int  # the rank of the map from F_b / F_(b-1) to F_(a+1) / F_a


@dataclass(frozen=True)
class ExactObstruction:
    """The exact criterion, with the points at which it holds."""

    logarithm: LogarithmOnFlag  # N
    other: Any  # the irreducible polynomial of the other point; None for infinity
    image: Any  # the exponents there on F_(a+1) / F_a
    source: Any  # those on F_b / F_(b-1)


@dataclass(frozen=True)
class NeatElement:
    """An element of the Galois group none of whose quotients of two different eigenvalues is a root of unity."""

    name: str  # where it comes from
    balls: Any  # its matrix, enclosed


@dataclass(frozen=True)
class Commutator:
    """The commutator of two such elements.

    Attributes:
        first: The name of g.
        second: The name of h.
        size: The largest lower bound of an entry of |gh - hg|: if it is above 0 they do not commute.
        error: The largest upper bound of an entry.
        scale: The largest entry of |gh|.
    """

    first: str
    second: str
    size: float
    error: float
    scale: float

    @property
    def is_proved(self) -> bool:
        """Whether it is proved that they do not commute."""
        return self.size > 0

    @property
    def text(self) -> str:
        """The result in words."""
        names = f"{self.first} and {self.second}"
        if self.is_proved:
            return f"{names} do not commute: an entry of gh - hg is at least {self.size:.3g} in absolute value"
        return f"{names}: all entries of gh - hg are at most {self.error:.1e}, those of gh up to {self.scale:.1e}"


def logarithms(flag: Flag, point: Any) -> tuple[LogarithmOnFlag, ...]:
    """The minimal quotients of a flag on which the local monodromy at a point is not trivial; exponents are rational.

    It is empty if the point is not recognised as regular, or has other exponents.
    """
    local = flag.system.local(point)
    if not local.is_regular or not local.exponents.all_rational:
        return ()
    if local.n_without_logarithm == flag.system.n:
        return ()
    dimensions = flag.dimensions
    terms = 4
    while True:
        classes = [_chain(flag, local, e, terms) for e in local.exponents.classes]
        if all(sum(chain[k].shape[0] for _, chain in classes) == d for k, d in enumerate(dimensions)):
            break
        terms *= 2
        if terms > _MOST_TERMS:
            return ()
    ranks = _ranks(len(flag.sizes), classes, local)
    found: list[LogarithmOnFlag] = []
    for low in range(len(ranks)):
        for high in range(low + 1, len(ranks) + 1):
            inside = range(low, high)
            if [(i, j) for i in inside for j in inside if ranks[i][j]] == [(low, high - 1)]:
                found.append(LogarithmOnFlag(point, low, high, ranks[low][high - 1]))
    return tuple(found)


def _ranks(r: int, classes: Sequence[tuple[Any, list[Any]]], local: LocalSystem) -> list[list[int]]:
    """The ranks of the blocks of N between the quotients of a flag, from where (column) to where (row)."""
    ranks = [[0] * r for _ in range(r)]
    for nilpotent, chain in classes:
        columns: list[Any] = []
        places: list[int] = []
        for k in range(r):
            for row in chain[k + 1].to_dense().rep.to_list():
                trial = DomainMatrix([*columns, row], (len(columns) + 1, len(row)), local.field)
                if trial.rank() == len(columns) + 1:
                    columns.append(row)
                    places.append(k)
        basis = DomainMatrix(columns, (len(columns), len(columns)), local.field).transpose()
        adapted = (basis.inv() * nilpotent.to_dense() * basis).to_dense()
        inside = [[m for m, p in enumerate(places) if p == k] for k in range(r)]
        for i, j in product(range(r), repeat=2):
            if inside[i] and inside[j]:
                ranks[i][j] += int(adapted.extract(inside[i], inside[j]).rank())
    return ranks


def exact_obstruction(flag: Flag) -> ExactObstruction | None:
    """The exact criterion on a flag; None where it says nothing."""
    system = flag.system
    for point in system.points:
        for log in logarithms(flag, point):
            for other in system.points:
                if other is point:
                    continue
                image = flag.quotient(log.low, log.low + 1).local(other)
                source = flag.quotient(log.high - 1, log.high).local(other)
                if not (image.is_regular and source.is_regular):
                    continue
                if log.high - log.low == 1:
                    enough = image.exponents.pairwise_irrational
                else:
                    enough = image.exponents.differ_irrationally(source.exponents)
                if enough:
                    return ExactObstruction(log, other, image.exponents, source.exponents)
    return None


def commutators(system: LinearSystem) -> tuple[tuple[Commutator, ...], tuple[str, ...]]:
    """Commutators of powers of local monodromies and of their conjugates, up to one that is not 0; what is left."""
    found: list[Commutator] = []
    left: list[str] = []
    before = ctx.prec
    ctx.prec = 3 * PRECISION
    try:
        for first, second in _pairs(system, left):
            found.append(commutator(first, second))
            if found[-1].is_proved:
                break
    finally:
        ctx.prec = before
    return tuple(found), tuple(left)


def _pairs(system: LinearSystem, left: list[str]) -> Iterator[tuple[NeatElement, NeatElement]]:
    """Pairs of elements that commute if the identity component is abelian; what was left out is added to a list."""
    loops = generators(system)
    if len(loops) > _MOST_LOOPS:
        left.append(f"{len(loops) - _MOST_LOOPS} of {len(loops)} singular points were left out, and infinity")
        loops = loops[:_MOST_LOOPS]
    elements: list[NeatElement] = []
    matrices: list[Monodromy] = []
    base = loops[0][1].corners[0] if loops else None
    for f, loop in loops:
        if loop.corners[0] != base:
            raise EnclosureError(f"the loop around {loop.name}: it has another base point than the first one")
        matrices.append(continued(system, loop))
        if sum(abs(w) for _, w in matrices[-1].windings) != 1:
            raise EnclosureError(
                f"the loop around {loop.name}: it goes around other singular points, too; give polygons to `monodromy`"
            )
        if not system.local(f).is_regular:
            left.append(f"{loop.name} is not recognised as regular singular")
            continue
        new = _neat(loop.name, matrices[-1].balls, system.local(f).exponents.neat_power)
        yield from ((other, new) for other in elements)
        elements.append(new)
    if system.infinity_is_singular and not left:
        if system.local().is_regular:
            outer = continued(system, loop_around_all(system, loops[0][1]))
            if any(winding != 1 for _, winding in outer.windings) or outer.loop.corners[0] != base:
                raise EnclosureError(
                    "the loop around infinity does not go once around each singular point, from the base"
                )
            new = _neat("infinity", outer.balls, system.local().exponents.neat_power)
            yield from ((other, new) for other in elements)
            elements.append(new)
        else:
            left.append("infinity is not recognised as regular singular")
    for element, matrix in product(elements, matrices):
        moved = matrix.balls * element.balls * matrix.balls.inv()
        yield element, NeatElement(f"its conjugate along {matrix.loop.name}", moved)


def commutator(first: NeatElement, second: NeatElement) -> Commutator:
    """The commutator of two elements with the same base point."""
    g, h = first.balls, second.balls
    product = g * h
    entries = (product - h * g).entries()
    size = max(float(entry.abs_lower()) for entry in entries)
    error = max(float(entry.abs_upper()) for entry in entries)
    return Commutator(first.name, second.name, size, error, max(float(e.abs_upper()) for e in product.entries()))


def _neat(name: str, balls: Any, power: int) -> NeatElement:
    """A power of the monodromy around a point."""
    text = f"the monodromy around {name}"
    return NeatElement(text if power == 1 else f"power {power} of {text}", balls**power)


def _chain(flag: Flag, local: LocalSystem, exponent: Any, terms: int) -> tuple[Any, list[Any]]:
    """N of a class of exponents, and for each subspace of the flag its solutions, as rows of coefficients."""
    found = local.solutions(exponent, terms=terms)
    weights: Sequence[int] = local.weights or ()
    n, count, field = flag.system.n, found.n, local.field
    size = len(found.coefficients)
    rows = [_local_row(row, local, size + max(weights)) for row in flag.annihilators.to_dense().rep.to_list()]
    entries = [[u.to_dense().rep.to_list() for u in row] for row in found.coefficients]
    chain: list[Any] = []
    powers = len(found.coefficients[0])
    # conditions[i]: the coefficients of row i applied to the solutions
    conditions: list[list[Any]] = []
    shift = max(weights)
    for row in rows:
        lines: list[Any] = []
        for j in range(powers):
            for m in range(size):
                total = [field.zero] * count
                for i in range(n):
                    offset = shift - weights[i]
                    for k in range(m + 1 - offset):
                        c = row[i][m - offset - k]
                        if c:
                            total = [t + c * e if e else t for t, e in zip(total, entries[k][j][i], strict=True)]
                lines.append(total)
        conditions.append(lines)
    for d in flag.dimensions:
        left = [line for lines in conditions[d:] for line in lines if any(line)]
        if left:
            chain.append(DomainMatrix(left, (len(left), count), field).nullspace().to_dense())
        else:
            chain.append(DomainMatrix.eye(count, field).to_dense())
    return found.nilpotent, chain


def _local_row(row: list[Any], local: LocalSystem, count: int) -> list[list[Any]]:
    """A row of rational functions, times their common denominator, as series at the point."""
    tops, _ = over_common_denominator(list(map(fraction, row)), fmpq_poly([1]))
    if local.point is None:
        size = max((top.degree() for top in tops), default=0)
        tops = [fmpq_poly([top[size - k] for k in range(size + 1)]) for top in tops]
    return [local.series(top, count) for top in tops]
