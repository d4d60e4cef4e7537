r"""Integrals at points of a case of parameters: whether they are polynomials in known ones, in H, Casimirs and others.

**Points.** The free parameters of a case are drawn; where equations are left that no parameter is solved for, so many
of their parameters are drawn that finitely many solutions are left, of which one is a point of the case. Modulo a prime
it is a root of the equation for a linear form (`liepoisson.algebra.ideals.solutions`).

**Integrals.** The known integrals $f_1,\dots,f_r$ generate an algebra A, and the null space N of D up to a degree d is
compared with the part of A up to that degree. Three arguments decide it:

1. An element of N whose gradient is no combination of theirs is functionally independent of them.
2. If the leading forms of the $f_i$ are algebraically independent, nothing cancels in a polynomial in the $f_i$, and
   the part of A is spanned by products of degree at most d.
3. Otherwise high degrees may cancel: at equal moments $H-\tfrac12aC_1 = k\cdot\ell$. Let the $f_i$ be independent. On a
   general plane of dimension r they have finite fibres, and the preimage of a line is a curve of degree at most
   $\delta$, the product of the r - 1 largest degrees (Bézout). Along it coordinates grow at most as $t^\delta$, so
   $F = P(f)$ of degree d has $\deg P\le d\delta$. Products up to that degree are tried, lowest first.

All of it at random points modulo a prime of 61 bits.

**The matrix** of a search has polynomials in the parameters for entries. The equations of motion are multiplied by the
common denominator of their coefficients, which changes the speed of the motion and no integral, where it does not
vanish.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import islice
from math import lcm, prod
from operator import not_
from random import Random
from typing import Any, cast

from flint import arb, fmpq, fmpq_poly, nmod_poly
from sympy import Expr, Symbol
from sympy import Poly as SymPyPoly

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.echelon import Echelon, transposed
from liepoisson.algebra.function_fields import over_common_denominator
from liepoisson.algebra.ideals.groebner import groebner_basis, rational_context
from liepoisson.algebra.ideals.limits import NotDecidedError
from liepoisson.algebra.ideals.operations import in_context
from liepoisson.algebra.ideals.solutions import Solutions, solutions
from liepoisson.algebra.linear_algebra import nullspace_mod, rank_mod
from liepoisson.algebra.number_fields import Element, PrimeField, as_fmpq
from liepoisson.algebra.residues import Residues, primes
from liepoisson.algebra.sparse_polynomials import (
    Polynomial,
    expression,
    gradient_at,
    of_exponents,
    value_at,
    whole_expression,
)
from liepoisson.errors import ParameterError
from liepoisson.integrability.derivation import Derivation, Exponents, Level, gradings
from liepoisson.integrability.parameter_cases import LIMITS, Case, CaseSplitting, Poly, SparseRow
from liepoisson.integrability.search import Label, point_on_level, products, random_point


class ParameterMatrix:
    """The equations of motion, on a level or in all of phase space, with flint's polynomials for coefficients."""

    def __init__(self, derivation: Derivation, zeros: Sequence[Polynomial] = (), level: Level | None = None) -> None:
        self.symbols = derivation.field.parameters
        self.names = [str(s) for s in self.symbols]
        self.context: Any = rational_context(self.names)
        self._zero, self._one = self.context.constant(0), self.context.constant(1)
        self.components, self.denominator = self._cleared(derivation.components)
        self.zeros = [self.without_denominators(zero) for zero in zeros if zero]
        self.level = self._level(level or Level())

    def _read(self, polynomial: Any) -> Poly:
        terms = {tuple(map(int, m)): as_fmpq(c) for m, c in polynomial.terms()}
        return self.context.from_dict(terms)

    def without_denominators(self, polynomial: Polynomial) -> dict[Exponents, Poly]:
        """A polynomial times the common denominator of its coefficients."""
        return self._cleared([polynomial])[0][0]

    def _cleared(self, polynomials: Sequence[Polynomial]) -> tuple[list[dict[Exponents, Poly]], Poly]:
        """Polynomials times the common denominator of the coefficients of all, and that."""
        pairs = [(self._read(c.numer), self._read(c.denom)) for p in polynomials for c in p.values()]
        tops, common = over_common_denominator(pairs, self._one)
        left = iter(tops)
        return [{m: next(left) for m in p} for p in polynomials], common

    def read(self, function: Expr, variables: Sequence[Symbol]) -> dict[Exponents, Poly]:
        """A function, a polynomial whose coefficients are rational functions of the parameters, without denominators.

        Modulo the level.
        """
        n, numerator = len(variables), cast("Any", function).together().as_numer_denom()[0]
        found: dict[Exponents, dict[tuple[int, ...], Any]] = {}
        for m, c in cast("Any", SymPyPoly(numerator, *variables, *self.symbols)).terms():
            found.setdefault(m[:n], {})[m[n:]] = as_fmpq(c)
        return self.level.remainder({m: self.context.from_dict(terms) for m, terms in found.items()})

    def _level(self, level: Level) -> Level:
        """The level over polynomials: division by its basis must be the same for all values of the parameters."""
        basis: list[tuple[Exponents, dict[Exponents, Poly]]] = []
        for lead, generator in level.basis:
            divided = {m: (self._read(c.numer), self._read(c.denom)) for m, c in generator.items()}
            is_constant = all(a.is_constant() for a, _ in divided.values())
            if not all(b.is_constant() for _, b in divided.values()) or (len(self.zeros) > 1 and not is_constant):
                raise ParameterError(
                    "on: wanted one equation whose highest term has a number for its coefficient, or several without "
                    "parameters; got others; give numbers for the parameters of the level"
                )
            basis.append((lead, {m: a / b.leading_coefficient() for m, (a, b) in divided.items()}))
        return Level(tuple(basis))

    def rows(self, block: Sequence[Exponents]) -> list[SparseRow]:
        """The matrix of D on some monomials that are standard on the level."""
        return transposed(self.level.remainder(self._image(monomial)) for monomial in block)

    def _image(self, monomial: Exponents) -> dict[Exponents, Poly]:
        total: dict[Exponents, Poly] = {}
        for k, power in enumerate(monomial):
            if power:
                lowered = (*monomial[:k], power - 1, *monomial[k + 1 :])
                for factor, coefficient in self.components[k].items():
                    key = of_exponents(lowered, factor)
                    total[key] = total.get(key, self._zero) + coefficient * power
        return total

    def scalings(self) -> list[tuple[int, ...]]:
        """Independent weights of the parameters with which the equations, and those of the level, are homogeneous.

        An equation f = 0 is homogeneous if there are weights of the equations with one more coordinate whose rate is f.
        """
        equations = [*self.components, *self.zeros]
        n, k, more = len(self.components), len(self.symbols), len(self.zeros)
        extended: list[dict[Exponents, Any]] = [
            {(*m, *(0,) * more, *map(int, powers)): 1 for m, a in part.items() for powers, _ in a.terms()}
            for part in equations
        ]
        names: Any = tuple(range(n + more + k))  # gradings look at exponents alone
        whole = Derivation(names, (*extended, *({} for _ in range(k))), Coefficients())
        found = Echelon(Coefficients())
        for grading in gradings(whole):
            if not grading.modulus:
                found.insert({i: Fraction(w) for i, w in enumerate(grading.weights[n + more :]) if w})
        scalings: list[tuple[int, ...]] = []
        for vector in found.basis():
            scale = lcm(*(c.denominator for c in vector.values()))
            scalings.append(tuple(int(vector.get(i, Fraction(0)) * scale) for i in range(k)))
        return scalings

    def fraction(self, numerator: Poly, denominator: Poly) -> Expr:
        """A fraction of polynomials in the parameters as an expression."""
        return expression(numerator.terms(), self.symbols) / expression(denominator.terms(), self.symbols)

    def sympy(self, polynomial: Poly) -> Expr:
        """A polynomial in the parameters as an expression with whole coefficients without a common factor."""
        return whole_expression(polynomial.terms(), self.symbols)


_MOST_PRODUCTS = 1500
"""Products of known integrals of one comparison; beyond them it is not decided."""

ParameterPolynomial = dict[Exponents, Poly]
"""A polynomial in the coordinates whose coefficients are polynomials in the parameters."""


@dataclass(frozen=True)
class Block:
    """A block of the search."""

    label: Label  # the weights of its monomials
    monomials: list[Exponents]  # they, largest first
    rows: list[SparseRow]  # the matrix of D on them, with entries in the parameters


@dataclass(frozen=True)
class Comparison:
    """The integrals at a point, compared with polynomials in known ones."""

    is_further: bool | None  # whether there is one that is none; None if it was not decided
    is_independent: bool  # whether there is one that is functionally independent of the known ones
    nullities: dict[Label, int]  # the number of integrals in each block


class IntegralsAtPoints:
    """Null spaces at points of the parameters modulo primes."""

    def __init__(self, matrix: ParameterMatrix, blocks: Sequence[Block], degree: int) -> None:
        self.matrix, self.blocks, self.degree = matrix, blocks, degree

    def compare(self, point: list[Element], p: int, known: Sequence[ParameterPolynomial]) -> Comparison:
        """The integrals at a point and polynomials in known ones."""
        vectors: list[Polynomial] = []
        nullities: dict[Label, int] = {}
        values: dict[str, Element] = {}
        number = PrimeField(p).number

        def value(q: Poly) -> Element:
            text = str(q)
            if text not in values:
                values[text] = value_at(q.terms(), point, number)
            return values[text]

        for block in self.blocks:
            rows = [{c: x for c, q in row.items() if (x := value(q))} for row in block.rows]
            found = nullspace_mod([row for row in rows if row], len(block.monomials), p)
            nullities[block.label] = len(found)
            vectors += [{block.monomials[c]: number(x) for c, x in vector.items()} for vector in found]
        is_further, is_independent = self._algebra(point, p, known).contains(vectors)
        return Comparison(None if is_further is None else not is_further, is_independent, nullities)

    def contains(
        self, point: list[Element], p: int, known: Sequence[ParameterPolynomial], function: ParameterPolynomial
    ) -> bool | None:
        """Whether a function is a polynomial in known ones at a point; None if it was not decided."""
        algebra = self._algebra(point, p, known)
        return algebra.contains([algebra.level.remainder(_at(function, point, p))])[0]

    def _algebra(self, point: list[Element], p: int, known: Sequence[ParameterPolynomial]) -> _Algebra:
        level = self.matrix.level.mapped(lambda generator: _at(generator, point, p))
        zeros = [_at(zero, point, p) for zero in self.matrix.zeros]
        functions = [level.remainder(_at(f, point, p)) for f in known]
        return _Algebra([{m: c for m, c in f.items() if any(m)} for f in functions], level, zeros, self.degree, p)


def _at(polynomial: Mapping[Exponents, Poly], point: list[Element], p: int) -> Polynomial:
    number = PrimeField(p).number
    return {m: c for m, q in polynomial.items() if (c := value_at(q.terms(), point, number))}


class _Algebra:
    """Polynomials in some functions without constant terms, modulo a prime, on a level."""

    def __init__(
        self, functions: Sequence[Polynomial], level: Level, zeros: Sequence[Polynomial], degree: int, p: int
    ) -> None:
        self.level, self.degree, self.residues = level, degree, Residues(p)
        self.zeros = [zero for zero in zeros if zero]
        self.functions = sorted((f for f in functions if f), key=lambda f: (_degree(f), len(f)))

    def contains(self, vectors: Sequence[Polynomial]) -> tuple[bool | None, bool]:
        """Whether all of some polynomials up to the degree are polynomials in the functions; None if not decided.

        And whether one of them is functionally independent of the functions.
        """
        vectors = [v for v in vectors if v]  # what vanishes on the level is zero
        if not vectors:
            return True, False
        n = len(next(iter(vectors[0])))
        place = point_on_level(self.zeros, self.residues, n)
        basis = self._independent(self.functions, place)
        gradients = [gradient_at(f, place) for f in (*self.zeros, *self.functions, *vectors)]
        if rank_mod(gradients, n, self.residues.p) > len(basis) + self._rank(self.zeros, place):
            return False, True
        return self._spans(vectors, basis, n), False

    def _spans(self, vectors: Sequence[Polynomial], basis: Sequence[Polynomial], n: int) -> bool | None:
        degrees = sorted((_degree(f) for f in basis), reverse=True)
        tops = [{m: c for m, c in f.items() if sum(m) == _degree(f)} for f in basis]
        is_exact = len(basis) == len(self.functions) and not self.level.basis
        exact_up_to = self.degree * prod(degrees[:-1]) * max(degrees, default=1) if is_exact else None
        if is_exact and self._rank(tops, random_point(n, self.residues, seed=2)) == len(basis):
            exact_up_to = self.degree
        span, total = Echelon(self.residues.field), 0
        weight = 0
        while True:
            weight += 1
            new = self._products(weight)
            total += len(new)
            if total > _MOST_PRODUCTS:
                return None if is_exact else False
            for product in new:
                span.insert(_by_degree(product))
            if weight < self.degree:
                continue
            if not any(span.reduce(_by_degree(v)) for v in vectors):
                return True
            if exact_up_to is not None and weight >= exact_up_to:
                return False
            # of functions with relations, or on a level, only some more products are tried
            if exact_up_to is None and weight >= self.degree + max(map(_degree, self.functions), default=0):
                return False

    def _products(self, weight: int) -> list[Polynomial]:
        """The products of the functions whose degrees have this sum."""
        factors = [(_degree(f), f) for f in self.functions]
        whole = (product for _, left, product in products(factors, weight) if not left)
        remainders = (self.level.remainder(product) for product in islice(whole, _MOST_PRODUCTS + 1))
        return [{m: c for m, c in f.items() if any(m)} for f in remainders]

    def _independent(self, functions: Sequence[Polynomial], place: list[Element]) -> list[Polynomial]:
        """Functions whose gradients at a point are independent of each other and of those of the level."""
        found: list[Polynomial] = []
        rank = self._rank(self.zeros, place)
        for f in functions:
            if self._rank([*self.zeros, *found, f], place) > rank + len(found):
                found.append(f)
        return found

    def _rank(self, functions: Sequence[Polynomial], place: list[Element]) -> int:
        return rank_mod([gradient_at(f, place) for f in functions], len(place), self.residues.p)


def _by_degree(f: Polynomial) -> Polynomial:
    """The polynomial with minus the degree before the exponents, so that the highest degree comes first."""
    return {(-sum(m), *m): c for m, c in f.items()}


def _degree(f: Mapping[Exponents, Any]) -> int:
    return max(map(sum, f))


_MOST_DRAWS = 60
_PRIMES = tuple(islice(primes(), 10))


class CasePoints:
    """Points of one case."""

    def __init__(self, case: Case, splitting: CaseSplitting) -> None:
        self.case, self.positive = case, splitting.positive
        self.names = tuple(splitting.context.names())
        self._random = Random(1)
        bound = {v for v, _ in case.scaled} | {v for v, _, _ in case.solved}
        self._free = [v for v in range(len(self.names)) if v not in bound]
        occurring = {v for q in case.unsolved for v, k in enumerate(q.degrees()) if k}
        self._tied = [v for v in self._free if v in occurring]

    def modular(self) -> tuple[int, list[Element]] | None:
        """A prime and the parameters modulo it, at a random point of the case; None if none was found."""
        for _ in range(_MOST_DRAWS):
            p = self._random.choice(_PRIMES)
            number = PrimeField(p).number
            values = {v: number(self._random.randrange(2, p)) for v in self._free}
            if self.case.unsolved:
                if not (tied := self._tied_modulo(p)):
                    continue
                values |= tied
            if (point := self._completed(values, number)) is not None:
                return p, point
        return None

    def _tied_modulo(self, p: int) -> dict[int, Element]:
        """The parameters of the unsolved equations at a solution modulo a prime; empty if there is none."""
        rational, rest, found = self._finitely_many()
        number, context, t = PrimeField(p).number, found.quotient.ideal.context, _root(found, p, self._random)

        def at_root(q: fmpq_poly) -> Element:
            return value_at((((k,), c) for k, c in enumerate(q.coeffs())), [t], number)

        if t is None or not (below := at_root(found.numerator(context.constant(1)))):
            return {}
        algebraic = {v: at_root(found.numerator(x)) / below for v, x in zip(rest, context.gens(), strict=True)}
        return algebraic | {v: number(x) for v, x in rational.items()}

    def _completed(
        self, values: Mapping[int, Any], number: Callable[[Any], Any], vanishes: Callable[[Any], bool] = not_
    ) -> list[Any] | None:
        """All parameters, from the free ones; None where something vanishes that must not."""
        point = [values.get(v, number(1)) for v in range(len(self.names))]
        return self.case.completed(point, number, vanishes) if self.case.admits(point, number, vanishes) else None

    def rational(self, most: int) -> Iterator[list[fmpq]]:
        """So many random points with rational coordinates, or fewer; none of a case that is not solved for all."""
        for _ in range(0 if self.case.unsolved else most):
            drawn = {
                v: fmpq(self._random.randint(1, 9) * self._sign(v), self._random.randint(1, 4)) for v in self._free
            }
            if (point := self._completed(drawn, fmpq)) is not None and self._is_positive(point):
                yield point

    def is_real(self) -> bool:
        """Whether a real point was found, with positive values where this is demanded (proved if True)."""
        try:
            return any(self._has_real_point() for _ in range(_MOST_DRAWS))
        except NotDecidedError:
            return False

    def _has_real_point(self) -> bool:
        drawn = {v: fmpq(self._random.randint(1, 12) * self._sign(v), self._random.randint(1, 6)) for v in self._free}
        if not self.case.unsolved:
            return self._is_admissible({v: arb(x) for v, x in drawn.items()})
        rational, rest, found = self._finitely_many(drawn)
        known = {v: arb(x) for v, x in (drawn | rational).items()}
        return any(
            self._is_admissible(known | dict(zip(rest, solution.values, strict=True))) for solution in found.real(60)
        )

    def _is_admissible(self, known: Mapping[int, arb]) -> bool:
        """Whether nothing vanishes that must not, and positive parameters are positive, at balls (proved if True)."""
        point = self._completed(known, arb, lambda x: x.contains(0))
        return point is not None and self._is_positive(point)

    def _is_positive(self, point: Sequence[Any]) -> bool:
        return all(bool(point[v] > 0) for v in self.positive)

    def _sign(self, v: int) -> int:
        return 1 if v in self.positive else self._random.choice((-1, 1))

    def _finitely_many(self, drawn: dict[int, fmpq] | None = None) -> tuple[dict[int, fmpq], list[int], Solutions]:
        """Values for some of the parameters of the equations, the others, and their finitely many solutions."""
        budget = LIMITS.budget()
        rational: dict[int, fmpq] = {}
        rest = list(self._tied)
        self._random.shuffle(rest)
        while True:
            context = rational_context([self.names[v] for v in rest])
            at = {self.names[v]: x for v, x in rational.items()}
            left = [in_context(q.subs(at) if at else q, context) for q in self.case.unsolved]
            basis = groebner_basis(left, budget)
            if basis.dimension <= 0:
                return rational, rest, solutions(basis, budget)
            v = rest.pop()
            rational[v] = drawn[v] if drawn else fmpq(self._random.randint(-50, 50), self._random.randint(1, 20))


def _root(found: Solutions, p: int, random: Random) -> Element | None:
    """A root modulo p of the equation of some solutions, if it has one."""
    numbers = list(range(len(found.factors)))
    random.shuffle(numbers)
    for k in numbers:
        polynomial = nmod_poly([int(c) % p for c in found.factors[k].polynomial.coeffs()], p)
        roots = [-f[0] / f[1] for f, multiplicity in polynomial.factor()[1] if f.degree() == multiplicity == 1]
        if roots:
            return random.choice(roots)
    return None
