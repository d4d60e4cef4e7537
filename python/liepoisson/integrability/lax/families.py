r"""For which parameters has a system a Lax pair of the form in which `search` looks for one?

The parameters are unknowns beside the components of B: the linear equation for L has polynomials in both for
coefficients, and is split into the cases in which it has solutions (`liepoisson.integrability.parameter_cases`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from sympy import Expr, Symbol, factor_list

from liepoisson.algebra.ideals.groebner import rational_context
from liepoisson.algebra.ideals.polynomial_system import polynomial
from liepoisson.algebra.sparse_polynomials import whole_expression
from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import as_count, as_deadline
from liepoisson.inputs.calls import shows_progress
from liepoisson.inputs.deadline import CUT_SHORT, SEARCH_LIMIT, Deadline
from liepoisson.integrability.families import names_among
from liepoisson.integrability.lax.pair import LaxPair
from liepoisson.integrability.lax.search import MOST_DEGREE, Ansatz, member, pairs_with, split, trivial_vectors
from liepoisson.integrability.parameter_cases import Case, Cases, CaseSplitting
from liepoisson.integrability.search_problem import at_values
from liepoisson.model.system import System
from liepoisson.report.printing import Formula


@dataclass(frozen=True)
class LaxFamily:
    """Parameters for which there is a Lax pair.

    Example:
        >>> e3 = lp.so(3) @ lp.semidirect(2)
        >>> top = lp.System(e3, "dot(l, inv(I)*l)/2 + a3*alpha3", symbols=["I[3]", "a3"])
        >>> family = lp.integrability.lax_families(top, nonzero=["a3"], positive=["I1", "I2", "I3"]).families[0]
        >>> family.conditions, family.pair.size  # Lagrange's top
        ((B1, B2, B3 - 1, I1 - I2), 3)

    Attributes:
        conditions: Polynomials in the parameters and the components B1, B2, ... of B that vanish. At special points
            of a case, such as a free body that turns about one axis only, the eigenvalues of all pairs may be Casimirs
            or numbers.
        nonzero: Polynomials that must not vanish for the conditions to suffice, besides what was assumed.
        example: Values of the parameters with these conditions; None if none were found that are rational.
        pair: A pair at these values, verified; None if there is no example, or if the eigenvalues of all pairs there
            are Casimirs or numbers.
    """

    conditions: tuple[Expr, ...]
    nonzero: tuple[Expr, ...]
    example: dict[str, Fraction] | None = field(hash=False)
    pair: LaxPair | None

    def __str__(self) -> str:
        words = ", ".join(map(_equation, self.conditions))
        if self.nonzero:
            words += f", where {' and '.join(f'{Formula(p).plain} is not 0' for p in self.nonzero)}"
        if self.example is None:
            return f"{words}   (no rational example)"
        return words if self.pair is not None else f"{words}   (eigenvalues are Casimirs or numbers)"


def _equation(condition: Any) -> str:
    """A condition as an equation; B1 = 1 for B1 - 1."""
    number, rest = condition.as_coeff_Add()
    return f"{rest} = {-number}" if number and rest.is_Symbol else f"{Formula(condition).plain} = 0"


@dataclass(frozen=True, repr=False)
class LaxFamilies:
    """The parameters for which there are Lax pairs of one form.

    Example:
        >>> e3 = lp.so(3) @ lp.semidirect(2)
        >>> top = lp.System(e3, "dot(l, inv(I)*l)/2 + a3*alpha3", symbols=["I[3]", "a3"])
        >>> found = lp.integrability.lax_families(top, nonzero=["a3"], positive=["I1", "I2", "I3"])
        >>> [str(family) for family in found.families], found.complete
        (['B1 = 0, B2 = 0, B3 = 1, I1 - I2 = 0'], True)

    Attributes:
        system: The system, with parameters as symbols.
        form: "algebra" or "diagonal".
        degree: The largest degree of L in z.
        families: The cases, each with an example.
        nonzero: Polynomials in the parameters that do not vanish, by assumption.
        positive: Parameters that are positive, by assumption.
        complete: Whether it is proved that there are no others.
        n_undecided: Cases that were not decided.
        is_cut_short: Whether the time limit ended the search.
    """

    system: System
    form: str
    degree: int
    families: tuple[LaxFamily, ...]
    nonzero: tuple[Expr, ...]
    positive: tuple[str, ...]
    complete: bool
    n_undecided: int
    is_cut_short: bool = False

    def __repr__(self) -> str:
        n = len(self.families)
        state = "" if self.complete else ", incomplete" + CUT_SHORT * self.is_cut_short
        cases = f"{n} case{'s' * (n != 1)}"
        return f"<LaxFamilies of {self.system.name}: {cases} of degree up to {self.degree}, form {self.form}{state}>"

    def __str__(self) -> str:
        """The cases, and what is proved."""
        where = "in the Lie algebra" if self.form == "algebra" else "diagonal"
        lines = [f"{self.system.name}: L of degree up to {self.degree} in z, M = Omega + z B with B {where}"]
        assumed = [f"{name} > 0" for name in self.positive]
        assumed += [f"{Formula(p).plain} is not 0" for p in self.nonzero if str(p) not in self.positive]
        if assumed:
            lines.append(f"assumed: {', '.join(assumed)}")
        lines += [str(family) for family in self.families]
        proved = "for no other real parameters is there one: proved"
        left = f"not proved that these are all: {self.n_undecided} cases left{CUT_SHORT * self.is_cut_short}"
        lines.append(proved if self.complete else left)
        return "\n".join(lines)


@shows_progress
def lax_families(
    system: System,
    *,
    degree: int = 2,
    form: str = "algebra",
    nonzero: Sequence[str] = (),
    positive: Sequence[str] = (),
    time_limit: float = SEARCH_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> LaxFamilies:
    r"""The parameters for which there is a Lax pair with $M = \Omega + zB$ and L a polynomial in z.

    The form is that of `search_lax_pairs`; the symbols of the system are unknown, too.

    Example:
        >>> e3 = lp.so(3) @ lp.semidirect(2)
        >>> top = lp.System(e3, "dot(l, inv(I)*l)/2 + a3*alpha3", symbols=["I[3]", "a3"])
        >>> found = lp.integrability.lax_families(top, nonzero=["a3"], positive=["I1", "I2", "I3"])
        >>> print(found.families[0])
        B1 = 0, B2 = 0, B3 = 1, I1 - I2 = 0

    Args:
        system: A system as for `search_lax_pairs`, with parameters that are symbols.
        degree: The largest degree of L in z, from 1 to 8.
        form: "algebra" or "diagonal".
        nonzero: Names of parameters that do not vanish.
        positive: Names of parameters that are positive.
        time_limit: Seconds after which cases are left undecided.
        progress: As for `integrate`.

    Raises:
        ParameterError: the system is not such a one, or a name is none of a parameter.
    """
    most = as_count(degree, "degree", least=1, most=MOST_DEGREE)
    deadline = as_deadline(time_limit)
    symbols: list[Any] = sorted(
        {s for e in (*system.equations.values(), system.hamiltonian) for s in e.free_symbols} - set(system.variables),
        key=str,
    )
    names = [str(s) for s in symbols]
    if not symbols:
        raise ParameterError("system: wanted parameters that are symbols; got numbers; call search_lax_pairs")
    nonzero, positive = names_among(names, nonzero, "nonzero"), names_among(names, positive, "positive")
    ansatz = Ansatz(system, form, symbols)
    splitting = _Splitting(ansatz, names, nonzero, positive, most)
    families: list[LaxFamily] = []
    n_undecided, n, is_cut_short = 0, len(ansatz.partners), False
    for first in range(n):
        cases = splitting.cases(first, deadline)
        n_undecided += len(cases.left)
        is_cut_short |= cases.is_cut_short
        families += [splitting.family(case, first) for case in cases.found]
        if progress:
            progress((first + 1) / n)
    assumed = tuple(splitting.expression(q) for q in splitting.assumed)
    return LaxFamilies(
        system, form, most, tuple(families), assumed, tuple(positive), not n_undecided, n_undecided, is_cut_short
    )


class _Splitting:
    """The linear equation for L, split by the parameters and B."""

    def __init__(
        self, ansatz: Ansatz, names: Sequence[str], nonzero: Sequence[str], positive: Sequence[str], degree: int
    ) -> None:
        self.ansatz, self.names, self.degree = ansatz, list(names), degree
        prefix = "B"
        while any(name.startswith(prefix) for name in names):
            prefix += "_"
        self.partners = [f"{prefix}{k + 1}" for k in range(len(ansatz.partners))]
        self.context = rational_context([*names, *self.partners])
        self.symbols: list[Any] = [*ansatz.parameters, *map(Symbol, self.partners)]
        self.positive = frozenset(self.names.index(name) for name in positive)
        given: list[Any] = [self.context.gen(self.names.index(name)) for name in (*nonzero, *positive)]
        divisors = [polynomial(f, self.context) for f, _ in factor_list(ansatz.denominator)[1]]
        self.assumed = list({str(q): q for q in (*given, *divisors)}.values())
        self.trivial = trivial_vectors(ansatz)

    def cases(self, first: int, deadline: Deadline) -> Cases:
        """The cases in which the first component of B that is not zero, and is 1, has this number."""
        n, k = len(self.partners), len(self.names)
        zero, one = self.context.constant(0), self.context.constant(1)
        components = [zero] * first + [one, *(self.context.gen(k + j) for j in range(first + 1, n))]
        splitting = CaseSplitting(self.context, self.positive, self.assumed)
        return split(splitting, self.ansatz, self.degree, components, len(self.trivial), deadline=deadline)

    def family(self, case: Case, first: int) -> LaxFamily:
        """A case with an example."""
        splitting = CaseSplitting(self.context, self.positive, self.assumed)
        k, n = len(self.names), len(self.partners)
        fixed = [(self.symbols[k + j], int(j == first)) for j in range(first + 1)]
        conditions: list[Any] = [s - value for s, value in fixed]
        conditions += [self.expression(q) for q in splitting.conditions(case)]
        nonzero = tuple(dict.fromkeys(self.expression(q) for q in splitting.divisors(case)))
        found = member(case, k + n, self.positive)
        if found is None:
            return LaxFamily(tuple(conditions), nonzero, None, None)
        values = dict(zip(self.names, found[:k], strict=True))
        b = (*(Fraction(0),) * first, Fraction(1), *found[k + first + 1 :])
        return LaxFamily(tuple(conditions), nonzero, values, self._pair(values, b))

    def _pair(self, values: dict[str, Fraction], b: tuple[Fraction, ...]) -> LaxPair | None:
        """The pair of lowest degree at values of the parameters that has integrals."""
        one = at_values(self.ansatz.system, {s: values[str(s)] for s in self.ansatz.parameters})
        ansatz = Ansatz(one, self.ansatz.form)
        known = [(0, v) for v in self.trivial]
        found = (pair for d in range(1, self.degree + 1) for pair in pairs_with(ansatz, d, b, known))
        return next(found, None)

    def expression(self, polynomial: Any) -> Expr:
        """A polynomial as an expression with whole coefficients, the first of them positive."""
        return whole_expression(polynomial.terms(), self.symbols)
