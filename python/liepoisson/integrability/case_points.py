r"""Random points of a case of parameters: modulo a prime, and real ones.

The free parameters of a case are drawn; where equations are left that no parameter is solved for, so many of their
parameters are drawn that finitely many solutions are left, of which one is a point of the case. Modulo a prime it is a
root of the equation for a linear form (`liepoisson.algebra.ideals.solutions`).
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import islice
from random import Random
from typing import Any

from flint import arb, fmpq, fmpq_poly, nmod_poly

from liepoisson.algebra.ideals.groebner import groebner_basis, rational_context
from liepoisson.algebra.ideals.limits import NotDecidedError
from liepoisson.algebra.ideals.operations import in_context
from liepoisson.algebra.ideals.solutions import Solutions, solutions
from liepoisson.algebra.number_fields import Element, PrimeField
from liepoisson.algebra.residues import primes
from liepoisson.algebra.sparse_polynomials import value_at
from liepoisson.integrability.parameter_cases import LIMITS, Case

_MOST_DRAWS = 60
_PRIMES = tuple(islice(primes(), 10))


class CasePoints:
    """Points of one case.

    Args:
        case: The case.
        context: FLINT's context of the parameters.
        positive: Indices of parameters that are positive.
        seed: Of the random numbers.
    """

    def __init__(self, case: Case, context: Any, positive: frozenset[int], seed: int = 1) -> None:
        self.case, self.context, self.positive = case, context, positive
        self.names = tuple(context.names())
        self._random = Random(seed)
        bound = {v for v, _ in case.scaled} | {v for v, _, _ in case.solved}
        self._free = [v for v in range(len(self.names)) if v not in bound]
        occurring = {v for q in case.unsolved for v, k in enumerate(q.degrees()) if k}
        self._tied = [v for v in self._free if v in occurring]

    def modular(self) -> tuple[int, list[Element]] | None:
        """A prime and the parameters modulo it, at a random point of the case; None if none was found.

        Raises:
            NotDecidedError: the limits were reached.
        """
        for _ in range(_MOST_DRAWS):
            p = self._random.choice(_PRIMES)
            number = PrimeField(p).number
            values = {v: number(self._random.randrange(2, p)) for v in self._free}
            if self.case.unsolved:
                rational, rest, found = self._finitely_many()
                t = _root(found, p, self._random)
                if t is None:
                    continue

                def at_root(q: fmpq_poly, t: Element = t, number: Callable[[Any], Element] = number) -> Element:
                    return value_at((((k,), c) for k, c in enumerate(q.coeffs())), [t], number)

                below = at_root(found.numerator(found.quotient.ideal.context.constant(1)))
                gens = dict(zip(rest, found.quotient.ideal.context.gens(), strict=True))
                if not below:
                    continue
                for v, x in gens.items():
                    values[v] = at_root(found.numerator(x)) / below
                for v, x in rational.items():
                    values[v] = number(x)
            if (point := self._completed(values, number)) is not None:
                return p, point
        return None

    def _completed(self, values: dict[int, Element], number: Callable[[Any], Element]) -> list[Element] | None:
        """All parameters, with those that are solved for; None where something vanishes that must not."""
        point = [values.get(v, number(1)) for v in range(len(self.names))]
        if any(not value_at(q.terms(), point, number) for q in self.case.nonzero.values()):
            return None
        solved: dict[int, Element] = {}
        for v, a, b in self.case.solved:
            if not (below := value_at(b.terms(), point, number)):
                return None
            solved[v] = value_at(a.terms(), point, number) / below
        return [solved.get(v, x) for v, x in enumerate(point)]

    def is_real(self) -> bool:
        """Whether a real point was found, with positive values where this is demanded (proved if True)."""
        try:
            return any(self._has_real_point() for _ in range(_MOST_DRAWS))
        except NotDecidedError:
            return False

    def _has_real_point(self) -> bool:
        drawn = {
            v: fmpq(
                self._random.randint(1, 12) * (1 if v in self.positive else self._sign()), self._random.randint(1, 6)
            )
            for v in self._free
        }
        known = {v: arb(x) for v, x in drawn.items()}
        if not self.case.unsolved:
            return self._is_admissible(known)
        rational, rest, found = self._finitely_many(drawn)
        known |= {v: arb(x) for v, x in rational.items()}
        return any(
            self._is_admissible(known | dict(zip(rest, solution.values, strict=True))) for solution in found.real(60)
        )

    def _is_admissible(self, known: dict[int, arb]) -> bool:
        """Whether nothing vanishes that must not, and positive parameters are positive, at balls (proved if True)."""
        at = [known.get(v, arb(1)) for v in range(len(self.names))]
        if any(value_at(q.terms(), at, arb).contains(0) for q in self.case.nonzero.values()):
            return False
        for v, a, b in self.case.solved:
            below = value_at(b.terms(), at, arb)
            if below.contains(0):
                return False
            known = known | {v: value_at(a.terms(), at, arb) / below}
        return all(v not in known or bool(known[v] > 0) for v in self.positive)

    def _sign(self) -> int:
        return self._random.choice((-1, 1))

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
