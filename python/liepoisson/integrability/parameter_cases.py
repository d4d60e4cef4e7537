r"""For which parameters does a linear system have more solutions than it has in general? Split into cases, all proved.

The matrix has polynomials in the parameters for entries. Entries that cannot vanish are eliminated; where none is left,
the simplest other entry is assumed not to vanish, and then, factor by factor, to vanish. An equation is solved for a
parameter that occurs in it with degree one; several that are not are taken apart by
`liepoisson.algebra.ideals.components`, and entries are reduced by their Gröbner basis. A case ends where the rank is
so large that there are no further solutions, or where no row is left.

Parameters are real. A sum of terms of one sign that are products of squares and of positive parameters vanishes only
with all of its terms: so a_1^2 + a_2^2 = 0 is a_1 = a_2 = 0, and I_1 + I_2 is never zero for positive moments. Of
quadratic polynomials completed squares show the same.

Scalings of the coordinates, of time and of the parameters that keep the equations keep the number of solutions. So a
parameter that does not vanish is set to 1 where a scaling allows it; equations are made homogeneous again when they are
written down.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from operator import not_
from typing import Any, TypeAlias

from flint import fmpq, fmpq_poly

from liepoisson.algebra.ideals.buchberger import remainder
from liepoisson.algebra.ideals.certified_roots import real_roots
from liepoisson.algebra.ideals.components import Assumptions, components, irreducible_factors
from liepoisson.algebra.ideals.groebner import GroebnerBasis
from liepoisson.algebra.ideals.limits import Limits, NotDecidedError
from liepoisson.algebra.ideals.operations import radical_contains
from liepoisson.algebra.ideals.signs import vanishing_parts
from liepoisson.algebra.sparse_polynomials import value_at
from liepoisson.errors import TimeLimitError
from liepoisson.inputs.deadline import checkpoint, has_passed

Poly: TypeAlias = Any
"""A polynomial in the parameters, flint.fmpq_mpoly."""
SparseRow: TypeAlias = "dict[int, Poly]"

LIMITS = Limits(work=3_000_000)
"""What one question about several equations that are not solved for a parameter may cost."""

MOST_CASES = 20_000
"""Cases after which the rest is left and said to be."""


@dataclass(frozen=True)
class Case:
    """A set of parameters: equations that hold, solved as far as possible, and polynomials that do not vanish.

    Attributes:
        equations: Irreducible polynomials that vanish, in the order in which they were imposed, each reduced by those
            before it; homogeneous.
        solved: Parameters that the equations give: index -> (numerator, denominator), the denominator not zero.
        unsolved: Equations that are of degree one in no parameter.
        scaled: Parameters that were set to 1, with the weights of all parameters in the scaling that did it.
        nonzero: Irreducible polynomials that do not vanish, monic, by their text (flint's polynomials have no hash).
    """

    equations: tuple[Poly, ...] = ()
    solved: tuple[tuple[int, Poly, Poly], ...] = ()
    unsolved: tuple[Poly, ...] = ()
    scaled: tuple[tuple[int, tuple[int, ...]], ...] = ()
    nonzero: Mapping[str, Poly] = field(default_factory=dict[str, Poly])

    def admits(
        self, point: Sequence[Any], number: Callable[[Any], Any], vanishes: Callable[[Any], bool] = not_
    ) -> bool:
        """Whether nothing vanishes at a point that must not."""
        return not any(vanishes(value_at(q.terms(), point, number)) for q in self.nonzero.values())

    def completed(
        self, point: Sequence[Any], number: Callable[[Any], Any], vanishes: Callable[[Any], bool] = not_
    ) -> list[Any] | None:
        """A point with the parameters that are solved for; None where a denominator vanishes.

        Args:
            point: Numbers for all parameters, those of parameters that are solved for without a meaning.
            number: Maps rational numbers to such numbers.
            vanishes: Whether a number is zero, or may be.
        """
        found = list(point)
        for v, a, b in self.solved:
            below = value_at(b.terms(), point, number)
            if vanishes(below):
                return None
            found[v] = value_at(a.terms(), point, number) / below
        return found


@dataclass
class State:
    """A case with the rows that are left of the matrix.

    Attributes:
        case: The case.
        rows: The rows.
        rank: The rank of those that were eliminated.
        pending: Equations that wait.
    """

    case: Case
    rows: list[SparseRow]
    rank: int
    pending: list[Poly] = field(default_factory=list)

    def copy(self, case: Case, pending: Sequence[Poly]) -> State:
        """A copy with another case and other equations that wait."""
        return State(case, [dict(row) for row in self.rows], self.rank, list(pending))


@dataclass
class Cases:
    """The cases in which there are more solutions.

    Attributes:
        found: Cases with more solutions than in general; as far as is seen none lies in the closure of another.
        left: Cases that were not decided.
        n_closed: Number of cases in which there are no further solutions.
        is_cut_short: Whether the time limit ended a search, and cases were left.
    """

    found: list[Case] = field(default_factory=list)
    left: list[Case] = field(default_factory=list)
    n_closed: int = 0
    is_cut_short: bool = False

    def leave(self, *cases: Case) -> None:
        """Keep cases that were not decided, and whether that is for want of time."""
        self.left += cases
        self.is_cut_short |= has_passed()


class CaseSplitting:
    """Splits the parameters of one linear system.

    Args:
        context: flint's context of the parameters.
        positive: Indices of parameters that are positive.
        nonzero: Polynomials that do not vanish.
        scalings: Weights of the parameters, one row for each independent scaling.
    """

    factors = staticmethod(irreducible_factors)

    def __init__(
        self,
        context: Any,
        positive: frozenset[int],
        nonzero: Sequence[Poly],
        scalings: Sequence[tuple[int, ...]] = (),
    ) -> None:
        self.scalings = tuple(scalings)
        self.context = context
        self.n = context.nvars()
        self.positive = positive
        self._zero, self._one = context.constant(0), context.constant(1)
        self.assumed = {str(q): q for p in nonzero for q in self.factors(p)}

    def run(
        self,
        rows: Sequence[SparseRow],
        n_columns: int,
        n_known: int,
        into: Cases,
        *,
        equations: Sequence[Poly] = (),
    ) -> None:
        """Find all cases in which the null space is larger than `n_known`; what is not decided by the deadline is left.

        Args:
            rows: The matrix.
            n_columns: Number of unknowns.
            n_known: Dimension of the null space in general, or of that part of it which is known everywhere.
            into: Cases found before, of other systems; those inside of them are not looked at again.
            equations: Polynomials that vanish on all parameters that are looked at.
        """
        stack = [State(Case(nonzero=self.assumed), [dict(row) for row in rows], 0, list(equations))]
        n_cases = 0
        while stack:
            state = stack.pop()
            n_cases += 1
            if n_cases > MOST_CASES or has_passed():
                into.leave(*(self._left(s) for s in (state, *stack)))
                return
            try:
                further = self._impose(state)
            except NotDecidedError:
                into.leave(self._left(state))
                continue
            if further is not None:
                stack += further
                continue
            state = self._scaled(state)
            if state.pending:
                stack.append(state)
                continue
            if any(self.lies_in(state.case, case) for case in into.found):
                continue
            try:
                self._eliminate(state, n_columns - n_known)
            except TimeLimitError:
                into.leave(*(self._left(s) for s in (state, *stack)))
                return
            if state.rank >= n_columns - n_known:
                into.n_closed += 1
            elif not state.rows:
                into.found = [c for c in into.found if not self.lies_in(c, state.case)] + [state.case]
            else:
                try:
                    stack += self._split(state)
                except NotDecidedError:
                    into.leave(state.case)

    def closure(self, case: Case) -> list[Case]:
        """The cases into which the conditions of a case fall, without what does not vanish in it.

        Raises:
            NotDecidedError: the limits were reached.
        """
        return self.subcases(Case(nonzero=self.assumed), self.conditions(case))

    def subcases(self, case: Case, equations: Sequence[Poly]) -> list[Case]:
        """The cases in which more polynomials vanish, which are reduced on the case.

        Raises:
            NotDecidedError: the limits were reached.
        """
        stack, found = [State(case, [], 0, list(equations))], list[Case]()
        while stack:
            further = self._impose(state := stack.pop())
            if further is not None:
                stack += further
                continue
            state = self._scaled(state)
            if state.pending:
                stack.append(state)
            elif not any(self.lies_in(state.case, other) for other in found):
                found = [c for c in found if not self.lies_in(c, state.case)] + [state.case]
        return found

    def rows_in(self, rows: Sequence[Mapping[Any, Poly]], case: Case) -> list[dict[Any, Poly]]:
        """Rows, each times a polynomial that does not vanish, on the parameters of a case."""
        inserted = [dict(row) for row in rows]
        for v, _ in case.scaled:
            inserted = [self._inserted_row(row, v, self._one, self._one) for row in inserted]
        for v, numerator, denominator in reversed(case.solved):
            inserted = [self._inserted_row(row, v, numerator, denominator) for row in inserted]
        return [{c: r for c, p in row.items() if (r := self.reduced(p, case))} for row in inserted]

    def settle(self, cases: Cases) -> None:
        """Drop what was left and lies in a case that was found, and what was left twice."""
        left = {tuple(map(str, self.conditions(case))): case for case in cases.left}
        cases.left = [case for case in left.values() if not any(self.lies_in(case, other) for other in cases.found)]

    def _left(self, state: State) -> Case:
        """The case of a state that is not decided, with the equations that wait."""
        waiting = (p for q in state.pending if (p := self.reduced(q, state.case)))
        return replace(state.case, unsolved=(*state.case.unsolved, *waiting))

    # equations

    def _impose(self, state: State) -> list[State] | None:
        """The cases in which the next equation that waits holds; None if none waits."""
        while state.pending:
            p = self.reduced(state.pending[0], state.case)
            rest = state.pending[1:]
            if not p:
                state.pending = rest
                continue
            if self._is_unit(p, state.case):
                return []
            found: list[State] = []
            nonzero = state.case.nonzero
            for q in self.factors(p):
                if self._is_unit(q, state.case):
                    continue
                case = replace(state.case, nonzero=nonzero)
                found += self._vanishing(q, state.copy(case, rest))
                nonzero = {**nonzero, str(q): q}
            return found
        return None

    def _vanishing(self, q: Poly, state: State) -> list[State]:
        """The cases in which an irreducible polynomial vanishes."""
        if (terms := self._definite_terms(q)) is not None:
            if any(term.is_constant() for term in terms):
                return []
            return [state.copy(state.case, [*terms, *state.pending])]
        equation = self.homogeneous(q, state.case)
        is_known = any(equation == known for known in state.case.equations)
        case = state.case if is_known else replace(state.case, equations=(*state.case.equations, equation))
        degrees = q.degrees()
        linear = [v for v in range(self.n) if degrees[v] == 1]
        parts = {v: self._in_powers(q, v) for v in linear}
        for v in sorted(linear, key=lambda v: (len(parts[v][1].coeffs()), v)):
            if self._is_unit(parts[v][1], case):
                return [self._with_solved(state, case, v, -parts[v][0], parts[v][1])]
        if linear:
            v = min(linear, key=lambda v: (len(parts[v][1].coeffs()), v))
            rest, slope = parts[v][0], parts[v][1]
            unequal = replace(case, nonzero={**case.nonzero, **{str(f): f for f in self.factors(slope)}})
            return [
                state.copy(state.case, [slope, rest, *state.pending]),
                self._with_solved(state, unequal, v, -rest, slope),
            ]
        if not self._has_real_zero(q):
            return []
        new = state.copy(replace(case, unsolved=(*case.unsolved, q)), state.pending)
        return [self._reduced_state(new)] if len(new.case.unsolved) == 1 else self._components(new)

    def _components(self, state: State) -> list[State]:
        """The cases into which several equations fall that were not solved, each with a Gröbner basis of them.

        An element of a basis may be of degree one in a parameter: then they wait to be solved.

        Raises:
            NotDecidedError: the limits were reached.
        """
        case, found = state.case, list[State]()
        assumptions = Assumptions(tuple(case.nonzero.values()), self.positive, is_real=True)
        for component in components(case.unsolved, assumptions, LIMITS.budget()):
            basis = sorted(component.equations, key=lambda p: 1 not in p.degrees())
            if any(1 in p.degrees() for p in basis):
                found.append(state.copy(replace(case, unsolved=()), [*basis, *state.pending]))
            else:
                settled = replace(case, unsolved=component.equations)
                found.append(self._reduced_state(state.copy(settled, state.pending)))
        return found

    # scalings

    def _free_scalings(self, case: Case) -> list[tuple[int, ...]]:
        """The scalings that leave the parameters at 1 which were set to it."""
        rows = [list(weights) for weights in self.scalings]
        for v, _ in case.scaled:
            pivot = next((row for row in rows if abs(row[v]) == 1), None)
            if pivot is None:
                continue
            rows = [
                [a - b * row[v] * pivot[v] for a, b in zip(row, pivot, strict=True)] for row in rows if row is not pivot
            ]
        return [tuple(row) for row in rows if any(row)]

    def _scaled(self, state: State) -> State:
        """The state with parameters that do not vanish set to 1 where a scaling allows it."""
        while True:
            done = {v for v, _ in state.case.scaled} | {v for v, _, _ in state.case.solved}
            choice = next(
                (
                    (v, weights)
                    for weights in self._free_scalings(state.case)
                    for v in range(self.n)
                    if abs(weights[v]) == 1
                    and v not in done
                    and self._keeps_signs(v, weights)
                    and self._is_unit(self.context.gen(v), state.case)
                ),
                None,
            )
            if choice is None:
                return state
            v, weights = choice
            equations = state.case.equations
            case = replace(state.case, scaled=(*state.case.scaled, (v, weights)))
            state = self._with_solved(state, case, v, self._one, self._one)
            state.case = replace(
                state.case, equations=equations, solved=tuple(s for s in state.case.solved if s[0] != v)
            )

    def _keeps_signs(self, v: int, weights: tuple[int, ...]) -> bool:
        """Whether positive parameters stay positive when this one becomes 1, which may have been negative."""
        return v in self.positive or all(weights[w] % 2 == 0 for w in self.positive)

    def conditions(self, case: Case) -> list[Poly]:
        """What the parameters of a case satisfy, each solved parameter in terms of the others; homogeneous."""
        solved = (self.homogeneous(b * self.context.gen(v) - a, case) for v, a, b in case.solved)
        return [*solved, *(self.homogeneous(q, case) for q in case.unsolved)]

    def divisors(self, case: Case) -> list[Poly]:
        """Irreducible polynomials by which was divided: where they vanish the conditions say too little.

        None of one irreducible condition, of which they are no factor.
        """
        found: dict[str, Poly] = {}
        for p, (v, _, _) in zip(self.conditions(case), case.solved, strict=False):
            for q in self.factors(self._in_powers(p, v)[1]):
                if len(case.equations) > 1 and not self._is_unit(q, Case(nonzero=self.assumed)):
                    found[str(q)] = q
        return list(found.values())

    def homogeneous(self, p: Poly, case: Case) -> Poly:
        """A polynomial in which parameters were set to 1 with powers of these that make it homogeneous."""
        for v, weights in reversed(case.scaled):
            terms: dict[tuple[int, ...], Any] = {}
            totals: list[tuple[int, tuple[int, ...], Any]] = []
            for monomial, coefficient in p.terms():
                powers = tuple(int(k) for k in monomial)
                totals.append(
                    (sum(w * k for w, k in zip(weights, powers, strict=True)) * weights[v], powers, coefficient)
                )
            top = max(total for total, _, _ in totals)
            for total, powers, coefficient in totals:
                terms[(*powers[:v], powers[v] + top - total, *powers[v + 1 :])] = coefficient
            p = self.context.from_dict(terms)
        return p

    def _with_solved(self, state: State, case: Case, v: int, numerator: Poly, denominator: Poly) -> State:
        """The state with a parameter expressed by the others, in everything."""
        common = numerator.gcd(denominator)
        numerator, denominator = numerator // common, denominator // common
        solved = [(w, *self._inserted_fraction(a, b, v, numerator, denominator)) for w, a, b in case.solved]
        insert = lambda p: self._inserted(p, v, numerator, denominator)  # noqa: E731
        nonzero = {str(q): q for p in case.nonzero.values() for q in self.factors(insert(p))}
        new = replace(
            case,
            solved=(*solved, (v, numerator, denominator)),
            unsolved=tuple(p for p in case.unsolved if not p.degrees()[v]),
            nonzero=nonzero,
        )
        # what was not solved for has other factors now, or a parameter of degree one
        again = [insert(p) for p in case.unsolved if p.degrees()[v]]
        if any(not insert(p) for p in case.nonzero.values()) or any(map(self._is_negative, new.solved)):
            return State(new, [], 0, [self._one])  # contradicts itself
        rows = [self._inserted_row(row, v, numerator, denominator) for row in state.rows]
        return self._reduced_state(State(new, rows, state.rank, [*again, *(insert(p) for p in state.pending)]))

    def _inserted_row(self, row: Mapping[Any, Poly], v: int, numerator: Poly, denominator: Poly) -> dict[Any, Poly]:
        power = max((p.degrees()[v] for p in row.values()), default=0)
        return {c: self._inserted(p, v, numerator, denominator, power) for c, p in row.items()}

    def _inserted(self, p: Poly, v: int, numerator: Poly, denominator: Poly, power: int | None = None) -> Poly:
        """The polynomial times a power of the denominator, with numerator/denominator for a parameter."""
        parts = self._in_powers(p, v)
        top = max(parts) if power is None else power
        total = self._zero
        for k, part in parts.items():
            total = total + part * numerator**k * denominator ** (top - k)
        return total

    def _inserted_fraction(self, a: Poly, b: Poly, v: int, numerator: Poly, denominator: Poly) -> tuple[Poly, Poly]:
        power = max(a.degrees()[v], b.degrees()[v])
        a, b = (self._inserted(p, v, numerator, denominator, power) for p in (a, b))
        common = a.gcd(b) if a else b
        return a // common, b // common

    def _in_powers(self, p: Poly, v: int) -> dict[int, Poly]:
        """The coefficients of the powers of a parameter."""
        parts: dict[int, dict[tuple[int, ...], Any]] = {0: {}}
        for monomial, coefficient in p.terms():
            key = tuple(int(k) for k in monomial)
            parts.setdefault(key[v], {})[(*key[:v], 0, *key[v + 1 :])] = coefficient
        return {k: self.context.from_dict(terms) for k, terms in parts.items()}

    def reduced(self, p: Poly, case: Case) -> Poly:
        """What is left of a polynomial modulo the equations of a case that were not solved."""
        return remainder(p, (q for q in case.unsolved if q))

    def _reduced_state(self, state: State) -> State:
        state.rows = [{c: r for c, p in row.items() if (r := self.reduced(p, state.case))} for row in state.rows]
        return state

    # elimination

    def _eliminate(self, state: State, enough: int) -> None:
        """Eliminate by entries that do not vanish, as long as there are any.

        Raises:
            TimeLimitError: the deadline of the call has passed.
        """
        state.rows = [cleaned for row in state.rows if (cleaned := self._cleaned(row, state.case))]
        while state.rows and state.rank < enough:
            checkpoint("an elimination")
            pivot = self._pivot(state)
            if pivot is None:
                break
            number, column = pivot
            pivot_row = state.rows.pop(number)
            p = pivot_row[column]
            state.rank += 1
            rows = (
                self._subtracted(row, pivot_row, column, p, state.case) if column in row else row for row in state.rows
            )
            state.rows = [row for row in rows if row]

    def _subtracted(self, row: SparseRow, pivot_row: SparseRow, column: int, p: Poly, case: Case) -> SparseRow:
        checkpoint("an elimination")
        e = row[column]
        common = e.gcd(p)
        a, b = p // common, e // common
        new: SparseRow = {}
        for c in row.keys() | pivot_row.keys():
            if c == column:
                continue
            value = self._zero
            if c in row:
                value = value + a * row[c]
            if c in pivot_row:
                value = value - b * pivot_row[c]
            value = self.reduced(value, case)
            if value:
                new[c] = value
        return self._cleaned(new, case)

    def _cleaned(self, row: SparseRow, case: Case) -> SparseRow:
        """The row divided by what all of its entries have in common and does not vanish."""
        row = {c: p for c, p in row.items() if p}
        if not row:
            return row
        common = self._zero
        for p in row.values():
            common = common.gcd(p)
            if common.is_constant():
                break
        divisor = self._one
        if not common.is_constant():
            for q, power in common.factor()[1]:
                if self._is_unit(q, case):
                    divisor = divisor * q**power
        if len(row) == 1 and not common.is_constant():
            # a multiple of one unknown: only its squarefree part matters
            ((c, p),) = row.items()
            return {c: self.without_units(p, case)}
        leading = next(iter(row.values())).leading_coefficient()
        return {c: (p // divisor) / leading for c, p in row.items()}

    def _pivot(self, state: State) -> tuple[int, int] | None:
        """The row and column of an entry that does not vanish, with little fill-in; constants first."""
        counts: dict[int, int] = {}
        for row in state.rows:
            for c in row:
                counts[c] = counts.get(c, 0) + 1
        best: tuple[tuple[int, int], int, int] | None = None
        for only_constants in (True, False):
            for k, row in enumerate(state.rows):
                for c, p in row.items():
                    cost = ((len(row) - 1) * (counts[c] - 1), 0 if p.is_constant() else p.total_degree())
                    if best is not None and cost >= best[0]:
                        continue
                    if p.is_constant() or (not only_constants and self._is_unit(p, state.case)):
                        best = (cost, k, c)
            if best is not None:
                return best[1], best[2]
        return None

    def _split(self, state: State) -> list[State]:
        """Two kinds of cases: the simplest entry vanishes, by one of its factors, or it does not (looked at first)."""
        candidates: dict[str, tuple[Poly, int]] = {}
        for row in state.rows:
            for p in row.values():
                for q in self.factors(p):
                    if not self._is_unit(q, state.case):
                        candidates[str(q)] = (q, candidates.get(str(q), (q, 0))[1] + 1)
        q = min(
            candidates.values(),
            key=lambda found: (found[0].total_degree(), len(found[0].coeffs()), -found[1], str(found[0])),
        )[0]
        copy = [dict(row) for row in state.rows]
        zero = State(state.case, copy, state.rank, [q])
        if len(state.case.unsolved) > 1 and self._vanishes_everywhere(q, state.case):
            return [zero]
        other = replace(state.case, nonzero={**state.case.nonzero, str(q): q})
        return [zero, State(other, state.rows, state.rank)]

    # what vanishes

    def _vanishes_everywhere(self, q: Poly, case: Case) -> bool:
        """Whether a polynomial vanishes at all complex parameters of a case.

        Raises:
            NotDecidedError: the limits were reached.
        """
        for p in case.nonzero.values():
            q = q * p
        return radical_contains(GroebnerBasis(self.context, case.unsolved), q, LIMITS.budget())

    def without_units(self, p: Poly, case: Case) -> Poly:
        """The product of the irreducible factors of a polynomial that may vanish."""
        product = self._one
        for q in self.factors(p):
            if not self._is_unit(q, case):
                product = product * q
        return product

    def _is_unit(self, p: Poly, case: Case) -> bool:
        """Whether a polynomial is known not to vanish."""
        if not p:
            return False
        if p.is_constant():
            return True
        return all(str(q) in case.nonzero or self._never_vanishes(q) for q in self.factors(p))

    def _never_vanishes(self, q: Poly) -> bool:
        terms = self._definite_terms(q)
        return terms is not None and any(term.is_constant() for term in terms)

    def _definite_terms(self, q: Poly) -> list[Poly] | None:
        """Its terms without positive parameters and powers, or its squares, if all have one sign and are several.

        For real parameters they vanish together with the polynomial.
        """
        return vanishing_parts(q, self.positive)

    def _has_real_zero(self, q: Poly) -> bool:
        """False if a polynomial in one parameter has no real (or no positive) zero; True if there may be one."""
        occurring = [v for v, degree in enumerate(q.degrees()) if degree > 0]
        if len(occurring) != 1:
            return True
        (v,) = occurring
        coefficients = [fmpq(0)] * (int(q.degrees()[v]) + 1)
        for m, c in q.terms():
            coefficients[int(m[v])] = c
        # irreducible and not linear, so that zero is no root
        return any(v not in self.positive or bool(root > 0) for root in real_roots(fmpq_poly(coefficients)))

    def _is_negative(self, solved: tuple[int, Poly, Poly]) -> bool:
        """Whether a positive parameter would have to be negative or zero, whatever the others are."""
        v, numerator, denominator = solved
        if v not in self.positive:
            return False
        product = numerator * denominator
        if not product:
            return True
        if product.is_constant():
            return bool(product.leading_coefficient() < 0)
        return self._definite_terms(product) is not None and bool(product.leading_coefficient() < 0)

    def lies_in(self, case: Case, other: Case) -> bool:
        """Whether all parameters of a case lie in the closure of another one (proved if True)."""
        if case is other:
            return False
        if any(self.inserted(p, case) for p in (*other.equations, *other.unsolved)):
            return False
        if len(other.equations) <= 1:
            return True  # an irreducible hypersurface
        # several equations may have other solutions, too, where a coefficient by which one was divided vanishes; that
        # of the homogeneous equation counts, since a parameter that was set to 1 may vanish in the closure
        for p, (v, _, _) in zip(self.conditions(other), other.solved, strict=False):
            if self.inserted(p, case) or not self.inserted(self._in_powers(p, v)[1], case):
                return False
        return True

    def inserted(self, p: Poly, case: Case) -> Poly:
        """The numerator of a polynomial on the parameters of a case."""
        for v, _ in case.scaled:
            p = self._inserted(p, v, self._one, self._one)
        for v, numerator, denominator in reversed(case.solved):
            p = self._inserted(p, v, numerator, denominator)
        return self.reduced(p, case)
