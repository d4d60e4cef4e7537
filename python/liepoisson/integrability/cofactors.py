r"""Which cofactors can Darboux polynomials have, and which have some up to a degree?

A Darboux polynomial p satisfies $D p = k p$ with a polynomial k, its cofactor. For given k this is a linear system for
p; the coefficients of k are its parameters, and `liepoisson.integrability.parameter_cases` splits it into cases. There
are finitely many cofactors of polynomials of bounded degree: along a curve on which k went to infinity the equation
$D p = k p$, divided by the size of k, would become $0 = k p$.

Which monomials k has: the terms $x^e\,\partial_k$ of D add $e - 1_k$ to the exponents of p. For any weights of the
coordinates the parts of highest weight of $k p$ and $D p$ agree, so that the exponents of k lie in the convex hull of
the $e - 1_k$.

References: Goriely, Integrability and Nonintegrability of Dynamical Systems (2001), chapter 2.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import islice, product
from typing import TYPE_CHECKING, Literal, TypeAlias

from liepoisson.algebra.coefficients import quadratic_roots, square_root_element, square_root_field
from liepoisson.algebra.ideals.limits import NotDecidedError
from liepoisson.algebra.linear_algebra import nullspace_mod
from liepoisson.algebra.number_fields import Element, PrimeField, as_fmpq
from liepoisson.algebra.residues import primes
from liepoisson.algebra.sparse_polynomials import Polynomial, of_exponents, value_at
from liepoisson.errors import TimeLimitError
from liepoisson.inputs.deadline import checkpoint
from liepoisson.integrability.derivation import Derivation, Exponents, Grading, of_degree
from liepoisson.integrability.level import Level
from liepoisson.integrability.parameter_cases import Case, Cases, CaseSplitting, Poly, SparseRow, State

if TYPE_CHECKING:
    from sympy import Expr

Field: TypeAlias = Literal["complex", "real", "rational"]
Values: TypeAlias = "tuple[Expr, ...]"
"""The coefficients of a cofactor, rational or with square roots, in the order of its monomials."""

_MOST_PRIMES = 50
"""Primes modulo which zeros of irreducible equations are looked for."""
_MOST_STEPS = 2000
"""Steps of the search for weights that exclude a monomial; where it does not end, the monomial stays."""


def cofactor_monomials(derivation: Derivation, gradings: Sequence[Grading], level: Level) -> list[Exponents]:
    """The monomials that cofactors can have.

    On a level, which may have several components, these are the cofactors that are looked for.
    """
    n = len(derivation.variables)
    found = [
        m
        for degree in range(derivation.degree)
        for m in of_degree(n, degree)
        if level.is_standard(m) and all(g.of(m) == g.shift for g in gradings)
    ]
    found.sort(reverse=True)
    if level.basis:
        return found
    shifts = {tuple(e - (i == k) for i, e in enumerate(m)) for k, c in enumerate(derivation.components) for m in c}
    return [m for m in found if not _separates(m, sorted(shifts))]


def _separates(monomial: Exponents, shifts: Sequence[Exponents]) -> bool:
    """Whether weights are found in which a monomial is heavier than all shifts: a perceptron."""
    differences = [tuple(a - b for a, b in zip(monomial, shift, strict=True)) for shift in shifts]
    weights = [0] * len(monomial)
    for _ in range(_MOST_STEPS):
        checkpoint("the monomials of cofactors")
        wrong = next((d for d in differences if sum(w * x for w, x in zip(weights, d, strict=True)) <= 0), None)
        if wrong is None:
            return True
        weights = [w + x for w, x in zip(weights, wrong, strict=True)]
    return False


def image(
    derivation: Derivation, cofactor: Mapping[Exponents, Element], monomial: Exponents, level: Level
) -> Polynomial:
    """The polynomial (D - k) m for a monomial m."""
    total = derivation({monomial: derivation.field.one})
    for m, c in cofactor.items():
        key = of_exponents(m, monomial)
        total[key] = total[key] - c if key in total else -c
    return level.remainder(total)


@dataclass(frozen=True)
class Candidates:
    """What the splitting of one block gave.

    Attributes:
        values: Coefficients of cofactors, among them all that occur, but for those in `left`.
        left: Cases that were not decided, as conditions.
        n_cases: Number of cases that were looked at.
        is_cut_short: Whether the time limit ended the splitting.
    """

    values: tuple[Values, ...]
    left: tuple[str, ...]
    n_cases: int
    is_cut_short: bool


class CofactorCases(CaseSplitting):
    """The splitting of the system $(D - k) p = 0$ by the coefficients of k.

    Args:
        derivation: The equations, with rational coefficients.
        level: The level set, or all of phase space.
        monomials: Those of the cofactor.
        field: Which numbers the coefficients of the cofactor may be.
    """

    def __init__(
        self,
        derivation: Derivation,
        level: Level,
        monomials: Sequence[Exponents],
        field: Field,
    ) -> None:
        from flint import fmpq_mpoly_ctx

        self.derivation, self.level, self.monomials = derivation, level, tuple(monomials)
        self.number_field: Field = field
        names = [f"k_{'_'.join(_name(derivation, m)) or '0'}" for m in monomials]
        super().__init__(fmpq_mpoly_ctx.get(names, "degrevlex"), frozenset(), [])

    def candidates(self, block: Sequence[Exponents]) -> Candidates:
        """The cofactors of polynomials with the monomials of a block; what is not decided by the deadline is left."""
        if not self.monomials:
            return Candidates(((),), (), 1, False)
        every = Case(nonzero=self.assumed)
        try:
            stack = [State(every, self._rows(block), 0)]
        except TimeLimitError:
            return Candidates((), (self._text(every),), 0, True)
        values: list[Values] = []
        left = Cases()
        n_cases = 0
        while stack:
            state = stack.pop()
            n_cases += 1
            try:
                further = self._impose(state)
                if further is not None:
                    stack += further
                    continue
                self._eliminate(state, len(block))
                if state.rank >= len(block):
                    continue
                if state.rows and not self._is_finite(state.case):
                    stack += self._split(state)
                    continue
                points = self._points(state.case)
                if points is None and self._has_none(state.case, block):
                    continue
            except NotDecidedError:
                left.leave(state.case)
                continue
            except TimeLimitError:
                left.leave(*(s.case for s in (state, *stack)))
                break
            if points is None:
                left.leave(state.case)
            else:
                values += points
        texts = tuple(map(self._text, left.left))
        return Candidates(tuple(dict.fromkeys(values)), texts, n_cases, left.is_cut_short)

    def _rows(self, block: Sequence[Exponents]) -> list[SparseRow]:
        rows: dict[Exponents, SparseRow] = {}
        one = self.derivation.field.one
        for column, monomial in enumerate(block):
            parts = [(self._one, image(self.derivation, {}, monomial, self.level))]
            for v, m in enumerate(self.monomials):
                parts.append((-self.context.gen(v), self.level.remainder({of_exponents(m, monomial): one})))
            for factor, part in parts:
                for key, value in part.items():
                    row = rows.setdefault(key, {})
                    row[column] = row.get(column, self._zero) + factor * as_fmpq(value)
        return [{c: p for c, p in row.items() if p} for row in rows.values()]

    # the numbers that coefficients may be

    def _definite_terms(self, q: Poly) -> list[Poly] | None:
        if self.number_field == "complex":
            return [self._one] if q.is_constant() else None
        return super()._definite_terms(q)

    def _has_real_zero(self, q: Poly) -> bool:
        if self.number_field == "complex":
            return True
        if self.number_field == "rational" and sum(degree > 0 for degree in q.degrees()) == 1:
            return False  # irreducible and not linear
        return super()._has_real_zero(q)

    # the splitting

    def _with_solved(self, state: State, case: Case, v: int, numerator: Poly, denominator: Poly) -> State:
        # an equation that was irreducible may split, be of degree one or contradict the others after the insertion
        waiting = State(state.case, state.rows, state.rank, [*case.unsolved, *state.pending])
        return super()._with_solved(waiting, replace(case, unsolved=()), v, numerator, denominator)

    def _vanishing(self, q: Poly, state: State) -> list[State]:
        own = self._own(q)
        if own is not None and own in self._equations(state.case):
            return []  # two irreducible polynomials in one coefficient have no common zero
        if own is not None:
            # the others may be simpler, or reducible, modulo this one
            waiting = [u for u in state.case.unsolved if u.degrees()[own] > 0]
            others = tuple(u for u in state.case.unsolved if u.degrees()[own] == 0)
            state = State(replace(state.case, unsolved=others), state.rows, state.rank, [*waiting, *state.pending])
        return super()._vanishing(q, state)

    def _components(self, state: State) -> list[State]:
        return [self._reduced_state(state)]  # each coefficient has an equation of its own, over any field

    def _own(self, q: Poly) -> int | None:
        """The coefficient that is alone in an equation."""
        occurring = [v for v, degree in enumerate(q.degrees()) if degree > 0]
        return occurring[0] if len(occurring) == 1 else None

    def _is_finite(self, case: Case) -> bool:
        """Whether each coefficient is solved for, or has an equation of its own."""
        return set(range(self.n)) == {v for v, _, _ in case.solved} | set(self._equations(case))

    def _equations(self, case: Case) -> dict[int, Poly]:
        """The unsolved equations in one coefficient, by this."""
        found: dict[int, Poly] = {}
        for q in case.unsolved:
            if (own := self._own(q)) is not None:
                found[own] = q
        return found

    def _points(self, case: Case) -> list[Values] | None:
        """The coefficients in a case; None where they are not found, having others than square roots."""
        equations = self._equations(case)
        if not self._is_finite(case) or any(q.degrees()[v] != 2 for v, q in equations.items()):
            return None
        choices = {v: self._roots(q, v) for v, q in equations.items()}
        field = square_root_field(root for pair in choices.values() for root in pair)
        found: list[Values] = []
        for chosen in product(*choices.values()):
            values = [field.zero] * self.n
            for v, root in zip(choices, chosen, strict=True):
                values[v] = square_root_element(root, field)
            point = case.completed(values, field.number)
            if point is not None and not any(value_at(q.terms(), point, field.number) for q in case.unsolved):
                found.append(tuple(map(field.to_sympy, point)))
        return found

    def _has_none(self, case: Case, block: Sequence[Exponents]) -> bool:
        """Whether a case in which coefficients are other than square roots has no Darboux polynomial; proved if True.

        Modulo a prime ranks can only drop. The zeros of one irreducible equation are all alike, so that one of them
        modulo the prime suffices; with several equations all must be there.
        """
        from flint import nmod_poly

        equations = self._equations(case)
        if not self._is_finite(case):
            return False
        for p in islice(primes(), _MOST_PRIMES):
            number = PrimeField(p).number
            choices: dict[int, list[Element]] = {}
            for v, q in equations.items():
                coefficients = [0] * (q.degrees()[v] + 1)
                for monomial, c in q.terms():
                    coefficients[int(monomial[v])] = int(number(c))
                factors = nmod_poly(coefficients, p).factor()[1]
                choices[v] = [-f[0] / f[1] for f, _ in factors if f.degree() == 1]
            if len(equations) == 1 and all(choices.values()):
                choices = {v: zeros[:1] for v, zeros in choices.items()}
            elif any(len(zeros) < equations[v].degrees()[v] for v, zeros in choices.items()):
                continue
            return all(
                self._nullity(dict(zip(choices, chosen, strict=True)), case, block, p) == 0
                for chosen in product(*choices.values())
            )
        return False

    def _nullity(self, given: Mapping[int, Element], case: Case, block: Sequence[Exponents], p: int) -> int:
        """The dimension modulo a prime of the Darboux polynomials with the cofactor that some coefficients give."""
        number = PrimeField(p).number
        point = case.completed([given.get(v, number(0)) for v in range(self.n)], number)
        if point is None:  # a denominator that does not vanish may do so modulo the prime
            return len(block)
        rows = [
            {c: x for c, q in row.items() if (x := value_at(q.terms(), point, number))} for row in self._rows(block)
        ]
        return len(nullspace_mod(rows, len(block), p))

    def _roots(self, q: Poly, v: int) -> tuple[Expr, ...]:
        coefficients = [Fraction(0)] * 3
        for monomial, c in q.terms():
            coefficients[int(monomial[v])] = Fraction(int(c.p), int(c.q))
        return quadratic_roots(
            *reversed(coefficients)
        )  # real if that is wanted: `_has_real_zero` has excluded the others

    def _text(self, case: Case) -> str:
        return ", ".join(f"{q} = 0" for q in self.conditions(case)) or "generic cofactors"


def _name(derivation: Derivation, monomial: Exponents) -> list[str]:
    return [f"{x}" if k == 1 else f"{x}{k}" for x, k in zip(derivation.variables, monomial, strict=True) if k]
