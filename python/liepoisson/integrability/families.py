r"""Families: for which parameters does a system have a further first integral?

The search for integrals is a linear system whose matrix contains the parameters. It is split into cases
(`liepoisson.integrability.parameter_cases`), which are proved: in all other cases the null space is not larger. A case
counts if not all integrals in it are polynomials in H and the Casimirs (`liepoisson.integrability.family_cases`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, cast

from flint import fmpq
from sympy import Expr, Function, I, Integer, NumberSymbol, Pow, Symbol, primitive

from liepoisson.algebra.exact_numbers import to_sympy
from liepoisson.algebra.number_fields import as_fraction
from liepoisson.algebra.sparse_polynomials import rational_to_sympy, value_at
from liepoisson.errors import ParameterError
from liepoisson.formula.parameters import read_values
from liepoisson.formula.scalars import as_count, as_deadline
from liepoisson.inputs.calls import shows_progress
from liepoisson.inputs.deadline import CUT_SHORT, FAMILY_LIMIT
from liepoisson.inputs.given import texts
from liepoisson.inputs.refusals import counted
from liepoisson.integrability.derivation import Derivation, in_blocks, n_monomials, order, up_to_degree
from liepoisson.integrability.family_cases import FamilyCases, FurtherCase
from liepoisson.integrability.further_integrals import Block, CasePoints, IntegralsAtPoints, ParameterMatrix
from liepoisson.integrability.parameter_cases import Case, CaseSplitting, Poly
from liepoisson.integrability.polynomial_integrals import first_integrals
from liepoisson.integrability.search import Search
from liepoisson.integrability.search_problem import (
    Equations,
    SearchProblem,
    at_values,
    casimirs_of,
    known_functions,
    where,
    zeros_on_level,
)
from liepoisson.model.equations_of_motion import EquationsOfMotion
from liepoisson.model.system import System
from liepoisson.report.printing import Formula

MOST_MONOMIALS = 3000
_MOST_EXAMPLES = 200
"""Random values that are tried until they are in a case."""


@dataclass(frozen=True)
class ParameterCase:
    """Parameters for which there is a further integral.

    Example:
        >>> top = lp.System(lp.so(3) @ lp.semidirect(2), "(l1^2 + l2^2 + J*l3^2)/2 + a*alpha1", symbols=["J", "a"])
        >>> case = lp.integrability.integrable_families(top, degree=1, positive=["J"]).cases[1]
        >>> case.conditions, case.integrals
        ((J - 1,), (l1,))

    Attributes:
        conditions: Polynomials in the parameters that vanish.
        nonzero: Polynomials that must not vanish for the conditions to suffice, besides what was assumed; where they do
            vanish, the limits of other parameters of the case belong to it.
        example: Random values with these conditions; None where the conditions are not solved by rational numbers.
        integrals: The integrals at these values that are functionally independent of H, the Casimirs and the integrals
            that there are for all parameters; a search there has found them.
        is_independent: Whether there is an integral that is functionally independent of these; others are functions of
            them, though no polynomials in them.
        is_real: Whether real parameters of the case were found; if not, it was not decided whether there are any.
    """

    conditions: tuple[Expr, ...]
    nonzero: tuple[Expr, ...]
    example: dict[Symbol, Expr] | None = field(hash=False)
    integrals: tuple[Expr, ...]
    is_independent: bool = True
    is_real: bool = True

    @property
    def remark(self) -> str:
        """What is missing: an independent integral, a rational example, or any real one; empty if nothing is."""
        remarks = [] if self.is_independent else ["a function of the known ones"]
        if not self.is_real:
            remarks.append("real parameters not decided")
        elif self.example is None:
            remarks.append("no rational example")
        return "; ".join(remarks)

    def __str__(self) -> str:
        words = where(self.conditions) or "all parameters"
        if self.nonzero:
            words += f", where {' and '.join(f'{Formula(c).plain} is not 0' for c in self.nonzero)}"
        return f"{words}   ({self.remark})" if self.remark else words

    def holds_at(self, values: Mapping[str, Any]) -> bool:
        """Whether parameters, by name, satisfy the conditions, and those that must not vanish do not.

        Raises:
            ParameterError: a parameter of the conditions has no value.
        """
        at = {name: to_sympy(cast("Any", v)) for name, v in read_values(values).items()}
        missing = {str(s) for c in (*self.conditions, *self.nonzero) for s in c.free_symbols} - at.keys()
        if missing:
            raise ParameterError(f"values: wanted one for each parameter; got none for {', '.join(sorted(missing))}")
        inserted = [[cast("Any", c).subs(at).expand() for c in part] for part in (self.conditions, self.nonzero)]
        return all(c == 0 for c in inserted[0]) and all(c != 0 for c in inserted[1])


@dataclass(frozen=True)
class FurtherCasimirs:
    """Parameters for which the bracket has more Casimirs than in general; these do not count as further integrals.

    Attributes:
        conditions: Polynomials in the parameters that vanish.
        casimirs: The Casimirs of the bracket there.
    """

    conditions: tuple[Expr, ...]
    casimirs: tuple[Expr, ...]

    def __str__(self) -> str:
        return f"{where(self.conditions)}: {', '.join(Formula(c).plain for c in self.casimirs)}"


@dataclass(frozen=True, repr=False)
class IntegrableFamilies:
    """For which parameters a system has further polynomial integrals.

    Example:
        >>> top = lp.System(lp.so(3) @ lp.semidirect(2), "(l1^2 + l2^2 + J*l3^2)/2 + a*alpha1", symbols=["J", "a"])
        >>> found = lp.integrability.integrable_families(top, degree=1, positive=["J"])
        >>> found.complete, found.n_closed, len(found.cases)
        (True, 6, 2)

    Attributes:
        system: The system.
        degree: The degree of the integrals.
        on: Functions that vanish on the level set that was searched; empty for all of phase space.
        parameters: The parameters.
        assumptions: What was assumed of them, in words.
        general: The integrals besides H and the Casimirs that there are for all parameters.
        cases: The cases with a further integral.
        left: Cases that were not decided, as conditions; empty if the answer is complete.
        n_closed: Number of cases in which it was proved that there is none.
        casimirs: The cases in which the bracket has more Casimirs up to the degree, which do not count.
        is_cut_short: Whether the time limit ended the search.
    """

    system: System
    degree: int
    on: tuple[Expr, ...]
    parameters: tuple[Expr, ...]
    assumptions: str
    general: tuple[Expr, ...]
    cases: tuple[ParameterCase, ...]
    left: tuple[str, ...]
    n_closed: int
    casimirs: tuple[FurtherCasimirs, ...] = ()
    is_cut_short: bool = False

    @property
    def complete(self) -> bool:
        """Whether it is proved that there are no other cases."""
        return not self.left

    def __repr__(self) -> str:
        state = "complete" if self.complete else f"incomplete: {self._what_is_left}"
        cases = counted(len(self.cases), "case")
        return f"<IntegrableFamilies of {self.system.name}, degree {self.degree}: {cases}, {state}>"

    @property
    def scope(self) -> str:
        """Which integrals were looked for, in words."""
        return f"up to degree {self.degree}" + (f" on {where(self.on)}" if self.on else "")

    def __str__(self) -> str:
        """The cases, and what is proved."""
        lines = [f"{self.system.name}: a further polynomial integral {self.scope} exists ({self.assumptions})"]
        if self.general:
            always = ", ".join(Formula(f).plain for f in self.general)
            lines[0] += f", besides what there is for all parameters: {always}"
        lines += [f"  if {case}" for case in self.cases] or [
            "  in no case that was decided" if self.left else "  never"
        ]
        if self.complete:
            lines.append(f"and in no other case: proved ({self.n_closed} cases without)")
        else:
            lines += [f"incomplete, {self._what_is_left}:", *(f"  {text}" for text in self.left)]
        lines += [f"more Casimirs, which do not count, if {case}" for case in self.casimirs]
        return "\n".join(lines)

    @property
    def _what_is_left(self) -> str:
        return f"{counted(len(self.left), 'case is', 'cases are')} left" + CUT_SHORT * self.is_cut_short


@shows_progress
def integrable_families(
    system: System,
    *,
    degree: int = 2,
    on: Equations = (),
    positive: Sequence[str] = (),
    nonzero: Sequence[str] = (),
    time_limit: float = FAMILY_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> IntegrableFamilies:
    """For which values of its parameters does a system have a polynomial integral that it does not have in general?

    Example:
        >>> top = lp.System(lp.so(3) @ lp.semidirect(2), "(l1^2 + l2^2 + J*l3^2)/2 + a*alpha1", symbols=["J", "a"])
        >>> found = lp.integrability.integrable_families(top, degree=1, positive=["J"])
        >>> [str(case) for case in found.cases], found.complete
        (['a = 0', 'J - 1 = 0'], True)

    Args:
        system: A system with symbols for parameters, which are real numbers.
        degree: The total degree of the integrals.
        on: Equations of an invariant level set, such as "C1 = 0", as for `first_integrals`: integrals on it alone.
        positive: Names of parameters that are positive.
        nonzero: Names of parameters that are not zero.
        time_limit: Seconds after which the cases that are left are named; integrals for all parameters are searched to
            the end, and so are those in the cases that were found.
        progress: As for `integrate`.

    Raises:
        ParameterError: the system has no symbols or no polynomial equations, its numbers are not rational, the level is
            not invariant, or the search is too large.
    """
    d, deadline = as_count(degree, "degree", least=1), as_deadline(time_limit)
    known, zeros = known_functions(system), zeros_on_level(system, on)
    check_numbers(system, zeros)
    problem = SearchProblem.of(system, known, zeros)
    derivation = problem.derivation
    check_parameters(system, derivation, "integrable_families")
    names = [str(s) for s in derivation.field.parameters]
    positive = names_among(names, positive, "positive")
    nonzero = names_among(names, nonzero, "nonzero")
    if (size := n_monomials(len(system.variables), d)) > MOST_MONOMIALS:
        raise ParameterError(
            f"degree: wanted at most {MOST_MONOMIALS:,} monomials; {d} has {size:,}; take a smaller one"
        )
    search = problem.search()
    matrix = ParameterMatrix(derivation, problem.zeros, search.level)
    search.run(up_to_degree(len(system.variables), d))
    splitting = CaseSplitting(
        matrix.context,
        frozenset(matrix.names.index(name) for name in positive),
        [
            *(matrix.context.gen(matrix.names.index(name)) for name in (*nonzero, *positive)),
            matrix.denominator,
        ],
        matrix.scalings(),
    )
    h, *casimirs = (
        matrix.without_denominators(search.level.remainder(polynomial)) for polynomial in problem.known.values()
    )
    cases = FamilyCases(
        splitting,
        IntegralsAtPoints(matrix, _blocks(search, matrix, d), d),
        h,
        casimirs,
        [matrix.without_denominators(g.polynomial) for g in search.generators if g.is_new],
        lambda case: [matrix.read(c, system.variables) for c in _casimirs_of(system, case, matrix)],
        deadline,
    )
    cases.search({count.label: count.n_known for count in search.counts}, progress=progress)
    cases.settle()
    general = _general(search, cases, splitting)
    assumed = [f"{', '.join(positive)} > 0"] if positive else []
    assumed += [f"{name} not 0" for name in nonzero]
    assumed += [
        f"{matrix.sympy(q)} not 0" for q in splitting.factors(matrix.denominator) if str(q) not in (*positive, *nonzero)
    ]
    return IntegrableFamilies(
        system=system,
        degree=d,
        on=tuple(zeros),
        parameters=matrix.symbols,
        assumptions="; ".join(dict.fromkeys(["real parameters", *assumed])),
        general=tuple(general.values()),
        cases=tuple(
            _described(case, splitting, matrix, system, degree=d, on=zeros, known=known | general)
            for case in cases.found
        ),
        left=tuple(dict.fromkeys(where(_conditions(c, splitting, matrix)) or "all parameters" for c in cases.left)),
        n_closed=cases.n_closed,
        is_cut_short=cases.is_cut_short and bool(cases.left),
        casimirs=tuple(
            FurtherCasimirs(_conditions(case, splitting, matrix), tuple(_casimirs_of(system, case, matrix)))
            for case in cases.with_casimirs
        ),
    )


def check_numbers(system: System, functions: Sequence[Expr]) -> None:
    """Refuse other numbers than rational ones: between these relations may hide."""
    expressions: list[Any] = [system.hamiltonian, *system.equations.values(), *functions]
    kinds: Any = (Function, NumberSymbol, Pow, type(I))
    others = {a for e in expressions for a in e.atoms(*kinds) if not (a.is_Pow and a.exp.is_Integer)}
    if others:
        named = ", ".join(sorted(Formula(a).plain for a in others))
        raise ParameterError(
            f"integrable_families: wanted symbols for parameters and rational numbers; got {named} in {system.name}; "
            "relations may hide between them; write a symbol for each"
        )


def check_parameters(system: EquationsOfMotion, derivation: Derivation, caller: str) -> None:
    """Refuse a system without symbols."""
    symbols = derivation.field.parameters
    ring: Any = getattr(derivation.field.domain, "domain", None)
    if not symbols or not all(s.is_Symbol for s in symbols) or not (ring.is_QQ or ring.is_ZZ):
        raise ParameterError(
            f"{caller}: wanted a system with symbols for parameters and rational numbers; got "
            f"{system.name} with {', '.join(map(str, symbols)) or 'no symbols'}; leave parameters without values, "
            "symbols=[...], or call first_integrals"
        )


def names_among(known: Sequence[str], given: object, what: str) -> tuple[str, ...]:
    """A sequence of names of parameters."""
    chosen = texts(given, what, f"names of {', '.join(known)}", f"{what}=[{known[0]!r}]")
    if unknown := [name for name in chosen if name not in known]:
        raise ParameterError(f"{what}: wanted names of {', '.join(known)}; got {unknown[0]!r}")
    return chosen


def _blocks(search: Search, matrix: ParameterMatrix, degree: int) -> list[Block]:
    """The blocks with their matrices, small ones first: what lies in a case that is known is not looked at again."""
    monomials = up_to_degree(len(matrix.components), degree)
    standard = (m for m in monomials if any(m) and search.level.is_standard(m))
    blocks = in_blocks(standard, search.gradings)
    ordered = [
        (label, sorted(block, key=order, reverse=True))
        for label, block in sorted(blocks.items(), key=lambda item: len(item[1]))
    ]
    return [Block(label, block, matrix.rows(block)) for label, block in ordered]


def _general(search: Search, cases: FamilyCases, splitting: CaseSplitting) -> dict[str, Expr]:
    """The integrals for all parameters that are no polynomials in H and the Casimirs."""
    drawn = CasePoints(Case(nonzero=splitting.assumed), splitting).modular()
    new = [g for g in search.generators if g.is_new]
    found: dict[str, Expr] = {}
    for g, polynomial in zip(new, cases.general, strict=True):
        known = [cases.hamiltonian, *cases.casimirs]
        if drawn is None or not cases.integrals.contains(drawn[1], drawn[0], known, polynomial):
            found[g.name] = _without_content(search.derivation.expression(g.polynomial), search.derivation.variables)
    return found


def _without_content(function: Expr, variables: Sequence[Symbol]) -> Expr:
    """An integral for all parameters, without a factor or a denominator of parameters alone.

    Where the factor vanishes, and where the denominator does, there still is one.
    """
    above = cast("Any", function).together().as_numer_denom()[0]
    return cast("Any", primitive)(above.expand(), *variables)[1]


def _casimirs_of(system: System, case: Case, matrix: ParameterMatrix) -> list[Expr]:
    """The Casimirs of the bracket in a case that gives values to some of its parameters; empty if it does not."""
    values: dict[str, Any] = {matrix.names[v]: Integer(1) for v, _ in case.scaled}
    values |= {matrix.names[v]: matrix.fraction(a, b) for v, a, b in case.solved}
    own = {name: value for name, value in values.items() if name in set(map(str, system.bracket.symbols))}
    if not own or all(matrix.names[v] not in own for v, _, _ in case.solved):
        return []
    return [c.expand(trace=True) for c in system.bracket.substitute(own).casimirs()]


def _conditions(case: Case, splitting: CaseSplitting, matrix: ParameterMatrix) -> tuple[Expr, ...]:
    """What the parameters of a case satisfy."""
    return tuple(matrix.sympy(q) for q in splitting.conditions(case))


def _described(
    one: FurtherCase,
    splitting: CaseSplitting,
    matrix: ParameterMatrix,
    system: System,
    *,
    degree: int,
    on: Sequence[Expr],
    known: Mapping[str, Expr],
) -> ParameterCase:
    """A case with an example, a random member at which the integrals are found again."""
    case, conditions = one.case, _conditions(one.case, splitting, matrix)
    excepted = _excepted(one, splitting)
    nonzero = tuple(dict.fromkeys(matrix.sympy(q) for q in (*splitting.divisors(case), *excepted)))
    example = _example(case, excepted, splitting, matrix)
    if example is None:
        return ParameterCase(conditions, nonzero, None, (), one.is_independent, one.is_real)
    member = at_values(system, {s: as_fraction(v) for s, v in example.items()})
    tops: dict[str, Any] = {name: f.as_numer_denom()[0] for name, f in known.items()}
    functions = {name: value for name, f in tops.items() if not (value := f.xreplace(example)).is_number}
    if system.bracket.symbols:
        functions |= casimirs_of(member)
    found = first_integrals(member, degree=degree, on=[cast("Expr", f.xreplace(example)) for f in on], known=functions)
    integrals = tuple(f.expression for f in found.independent)
    return ParameterCase(conditions, nonzero, example, integrals, one.is_independent)


def _excepted(one: FurtherCase, splitting: CaseSplitting) -> list[Poly]:
    """Polynomials that vanish, on the parameters of a case, where there is no further integral."""
    found: list[Poly] = []
    divisors = set(map(str, splitting.divisors(one.case)))
    for exception in one.exceptions:
        conditions = splitting.conditions(exception)
        further = [q for p in conditions if (q := splitting.inserted(p, one.closure))]
        equations = [splitting.homogeneous(splitting.without_units(q, one.closure), one.closure) for q in further]
        if any(q.is_constant() for q in equations):
            # a polynomial by which was divided vanishes in the exception
            if any(all(str(f) in divisors for f in splitting.factors(p)) for p in conditions):
                continue
            equations = conditions
        different = list({str(q): q for q in equations}.values())
        # several that do not all vanish: the sum of their squares does not
        found.append(different[0] if len(different) == 1 else sum((q * q for q in different), different[0] * 0))
    return found


def _example(
    case: Case, excepted: Sequence[Poly], splitting: CaseSplitting, matrix: ParameterMatrix
) -> dict[Any, Any] | None:
    """Values of the parameters in a case; None if none is found."""
    points = CasePoints(case, splitting).rational(_MOST_EXAMPLES)
    found = next((p for p in points if all(value_at(q.terms(), p, fmpq) for q in excepted)), None)
    return None if found is None else dict(zip(matrix.symbols, map(rational_to_sympy, found), strict=True))
