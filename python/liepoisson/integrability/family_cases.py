r"""The cases of parameters in which there is a further integral, from those in which a null space is larger.

Where a null space is larger than in general, H may have a lower degree, so that more of its powers fit, or the bracket
more Casimirs. In each case the integrals are compared with polynomials in H and the Casimirs of that case. Where all
are such, the search goes on inside of the case. Where some are not, they may become polynomials in H and the Casimirs
for special parameters of the case, for which the leading forms of these become dependent. Such parameters are excepted,
and searched by themselves.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from random import Random
from typing import Any

from liepoisson.algebra.ideals.limits import NotDecidedError
from liepoisson.algebra.matrices import determinant
from liepoisson.inputs.deadline import Deadline
from liepoisson.integrability.further_integrals import CasePoints, Comparison, IntegralsAtPoints, ParameterPolynomial
from liepoisson.integrability.parameter_cases import Case, Cases, CaseSplitting, Poly
from liepoisson.integrability.search import Label

_POINTS = 2
"""Random points of a case at which integrals are compared."""
_MOST_MINORS = 8


@dataclass
class FurtherCase:
    """Parameters for which there is a further integral.

    Attributes:
        case: They.
        closure: They and their limits, without what does not vanish in the case.
        exceptions: Cases inside of the closure in which there is none, except where other cases say so.
        is_independent: Whether one is functionally independent of the known ones.
        is_real: Whether real parameters of the case were found.
    """

    case: Case
    closure: Case
    exceptions: list[Case]
    is_independent: bool
    is_real: bool


@dataclass
class FamilyCases:
    """The search for cases.

    Attributes:
        splitting: Splits the parameters.
        integrals: The integrals at points.
        hamiltonian: H.
        casimirs: The Casimirs for generic parameters.
        general: Other integrals that there are for all parameters.
        casimirs_of: The Casimirs of the bracket of a case.
        deadline: After it nothing more is split; what was found is compared to the end.
        found: The cases with a further integral.
        with_casimirs: Cases whose bracket has more Casimirs, up to the degree.
        left: Cases that were not decided.
        n_closed: Number of cases without further integrals.
        is_cut_short: Whether the time limit ended a search, and cases were left.
    """

    splitting: CaseSplitting
    integrals: IntegralsAtPoints
    hamiltonian: ParameterPolynomial
    casimirs: list[ParameterPolynomial]
    general: list[ParameterPolynomial]
    casimirs_of: Callable[[Case], list[ParameterPolynomial]]
    deadline: Deadline
    found: list[FurtherCase] = field(default_factory=list["FurtherCase"])
    with_casimirs: list[Case] = field(default_factory=list[Case])
    left: list[Case] = field(default_factory=list[Case])
    n_closed: int = 0
    is_cut_short: bool = False

    def search(
        self,
        n_known: dict[Label, int],
        equations: Sequence[Poly] = (),
        progress: Callable[[float], Any] | None = None,
    ) -> None:
        """Find the cases in which there are more integrals than the known ones, of all blocks, small ones first.

        Args:
            n_known: The number of known integrals in each block.
            equations: Polynomials that vanish on the parameters to which the search is restricted.
            progress: Told the fraction that is done.
        """
        whole = [one.case for one in self.found if not one.exceptions]
        cases = Cases(found=list(whole))
        blocks = self.integrals.blocks
        for k, block in enumerate(blocks):
            n = len(block.monomials)
            with self.deadline.running():
                self.splitting.run(block.rows, n, n_known[block.label], cases, equations=equations)
            if progress:
                progress((k + 1) / len(blocks))
        self.splitting.settle(cases)
        self.left += cases.left
        self.n_closed += cases.n_closed
        self.is_cut_short |= cases.is_cut_short
        without: list[tuple[Case, dict[Label, int]]] = []
        for case in cases.found:
            if any(case is other for other in whole):
                continue
            compared = self._compared(case)
            if compared is None or compared.is_further is None:
                self.left.append(case)
            elif compared.is_further:
                closure, exceptions = self._closure_and_exceptions(case)
                is_real = CasePoints(case, self.splitting.context, self.splitting.positive).is_real()
                self.found.append(FurtherCase(case, closure, exceptions, compared.is_independent, is_real))
            else:
                self.n_closed += 1
                without.append((case, compared.nullities))
        for case, nullities in without:
            self.search(nullities, self.splitting.conditions(case))

    def settle(self) -> None:
        """Drop what lies in another case that was found."""
        kept: list[FurtherCase] = []
        for one in self.found:
            if not any(self._covers(other, one.case) for other in kept):
                kept = [other for other in kept if not self._covers(one, other.case)] + [one]
        self.found = kept
        self.left = [case for case in self.left if not any(self._covers(other, case) for other in self.found)]

    def _covers(self, one: FurtherCase, case: Case) -> bool:
        lies_in = self.splitting.lies_in
        return lies_in(case, one.case) and not any(case is e or lies_in(case, e) for e in one.exceptions)

    def _compared(self, case: Case) -> Comparison | None:
        """The integrals of a case at random points; None where these do not agree, or none was found."""
        own = self.casimirs_of(case)
        known = [self.hamiltonian, *self.casimirs, *own, *self.general]
        points = CasePoints(case, self.splitting.context, self.splitting.positive)
        found: list[Comparison] = []
        try:
            for _ in range(_POINTS):
                if (drawn := points.modular()) is None:
                    return None
                p, point = drawn
                found.append(self.integrals.compare(point, p, known))
                if own and not any(case is other for other in self.with_casimirs):
                    degree = self.integrals.degree
                    small = [c for c in own if max(map(sum, c), default=0) <= degree]
                    if any(self.integrals.contains(point, p, self.casimirs, c) is False for c in small):
                        self.with_casimirs.append(case)
        except NotDecidedError:
            return None
        return found[0] if all(other == found[0] for other in found) else None

    # parameters of a case for which H and the Casimirs have dependent leading forms

    def _closure_and_exceptions(self, case: Case) -> tuple[Case, list[Case]]:
        """The closure of a case with a further integral, and cases in it without."""
        closure, found = case, list[Case]()
        try:
            parts = self.splitting.closure(case)
        except NotDecidedError:
            parts = [case]
        for part in parts:
            if not self.splitting.lies_in(case, part):
                self._add_exceptions(part, found)
                continue
            closure = part
            for equations in self._degenerate(part):
                self._add_parts(part, equations, found)
        return closure, found

    def _add_parts(self, case: Case, equations: list[Poly], found: list[Case], depth: int = 0) -> None:
        try:
            parts = self.splitting.subcases(case, equations)
        except NotDecidedError:
            self.left.append(case)
            return
        for part in parts:
            self._add_exceptions(part, found, depth)

    def _add_exceptions(self, part: Case, found: list[Case], depth: int = 0) -> None:
        """Add a part of a case, or parts of it, in which no integral is further."""
        if any(self.splitting.lies_in(part, other) for other in found):
            return
        compared = self._compared(part)
        if compared is None or compared.is_further is None:
            self.left.append(part)
        elif not compared.is_further:
            found.append(part)
            self.search(compared.nullities, self.splitting.conditions(part))
        elif depth < self.splitting.n:
            for equations in self._degenerate(part):
                self._add_parts(part, equations, found, depth + 1)

    def _degenerate(self, case: Case) -> list[list[Poly]]:
        r"""Equations for parameters where the parts of H from some degree on depend on the Casimirs.

        $\det(\nabla f_i\cdot u_j)$ for the leading forms $f_i$ of the Casimirs and a part of H, at random points and
        random vectors $u_j$.
        """
        (h,) = self.splitting.rows_in([self.hamiltonian], case)
        tops: list[ParameterPolynomial] = []
        random = Random(1)
        for c in self.casimirs:
            (on_case,) = self.splitting.rows_in([c], case)
            if on_case and any(map(any, on_case)):
                degree = max(map(sum, on_case))
                top = {m: q for m, q in on_case.items() if sum(m) == degree}
                if any(self._minor([*tops, top], random) for _ in range(3)):
                    tops.append(top)
        loci: list[list[Poly]] = []
        equations: list[Poly] = []
        for degree in sorted({sum(m) for m in h if any(m)}, reverse=True):
            part = {m: q for m, q in h.items() if sum(m) == degree}
            n = min(_MOST_MINORS, 2 + self.splitting.n)
            minors = [self.splitting.reduced(self._minor([*tops, part], random), case) for _ in range(n)]
            equations = equations + [q for q in minors if q]
            if any(q.is_constant() for q in equations):
                break
            if equations:
                loci.append(equations)
        return loci

    def _minor(self, functions: Sequence[ParameterPolynomial], random: Random) -> Poly:
        n = len(next(iter(functions[0])))
        if len(functions) > n:
            return self.splitting.context.constant(0)
        x = [random.randint(-9, 9) or 1 for _ in range(n)]
        directions = [[random.randint(-9, 9) for _ in range(n)] for _ in functions]
        zero = self.splitting.context.constant(0)
        rows: list[list[Poly]] = []
        for f in functions:
            gradient = [zero] * n
            for m, q in f.items():
                for i, k in enumerate(m):
                    if k:
                        value = k * x[i] ** (k - 1)
                        for j, power in enumerate(m):
                            value *= x[j] ** power if j != i else 1
                        gradient[i] = gradient[i] + q * value
            rows.append([sum((g * u for g, u in zip(gradient, d, strict=True)), zero) for d in directions])
        return determinant(rows, zero)
