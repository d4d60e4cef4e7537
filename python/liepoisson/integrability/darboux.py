r"""Darboux polynomials of a system: invariant hypersurfaces p = 0, and rational integrals made of them.

p is a Darboux polynomial if $\dot p = k p$ with a polynomial k, its cofactor.  A product of powers of some is constant
along the motion if the powers times the cofactors add up to zero.

References: Goriely, Integrability and Nonintegrability of Dynamical Systems (2001), chapter 2.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from dataclasses import field as dataclass_field
from math import lcm
from typing import Any, get_args

from sympy import Expr, I, S, expand

from liepoisson.algebra.coefficients import Coefficients, square_root_element, square_root_field
from liepoisson.algebra.sparse_polynomials import Polynomial
from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import as_deadline
from liepoisson.inputs.calls import shows_progress
from liepoisson.inputs.deadline import CUT_SHORT, SEARCH_LIMIT
from liepoisson.inputs.refusals import shown
from liepoisson.integrability.cofactors import CofactorCases, Field, Values, cofactor_monomials
from liepoisson.integrability.darboux_search import (
    DarbouxSearch,
    RationalIntegral,
    TimeDependentIntegral,
    rational_integrals,
    time_dependent_integrals,
)
from liepoisson.integrability.derivation import (
    in_blocks,
    order,
)
from liepoisson.integrability.search import next_name, tidied
from liepoisson.integrability.search_problem import (
    Equations,
    SearchProblem,
    SizeAsked,
    functions_by_name,
    known_functions,
    where,
    zeros_on_level,
)
from liepoisson.io.display import as_text
from liepoisson.model.equations_of_motion import EquationsOfMotion
from liepoisson.report.printing import Formula

MOST_MONOMIALS = 1000
"""Monomials of the largest search that is begun; the systems of equations contain the cofactor as parameters."""

_WORDS = {
    "complex": "over the complex numbers",
    "real": "over the real numbers",
    "rational": "over the rational numbers",
}


@dataclass(frozen=True)
class DarbouxPolynomial:
    """A polynomial p that was found, with its cofactor k: the rate of p is k p.

    Attributes:
        name: P1, P2, ...
        expression: p, with the smallest whole coefficients if they are rational.
        cofactor: k; zero for a first integral.
        degree: The total degree of p.
    """

    name: str
    expression: Expr
    cofactor: Expr
    degree: int

    @property
    def is_real(self) -> bool:
        """Whether all coefficients are real."""
        return not self.expression.has(I)

    @property
    def equations(self) -> tuple[Expr, ...]:
        """The real polynomials that vanish on the invariant set p = 0: p, or its real and imaginary part."""
        if self.is_real:
            return (self.expression,)
        expanded: Any = expand(self.expression)
        imaginary = expanded.coeff(I)
        return tuple(part for part in (expand(expanded - I * imaginary), expand(imaginary)) if part != S.Zero)


@dataclass(frozen=True, repr=False)
class DarbouxPolynomials:
    """What a search for Darboux polynomials found, and what it proves.

    Attributes:
        system: The system.
        degree: The total degree up to which was searched, or None.
        weight: The weight up to which was searched, or None.
        weights: The weights of the coordinates, if a weight was given.
        on: Functions that vanish on the level set that was searched; empty for all of phase space.
        field: Which numbers the coefficients of cofactors may be: "complex", "real" or "rational".
        known: The integrals that were known, by name.
        found: The Darboux polynomials that are no sums of products of others and of known integrals, lowest degree
            first. They are irreducible, over the numbers of `field`, if the search is complete.
        rational_integrals: Products of powers of these that are constant, from which all others are made.
        time_dependent_integrals: Products whose cofactors add up to a number, with an exponential of the time.
        cofactor_monomials: The monomials of cofactors that were looked for; on all of phase space there are no others.
        n_monomials: Number of monomials of the search.
        n_blocks: Number of blocks, between which the equations do not mix.
        n_cases: Number of cases into which the cofactors were divided.
        left: Cases that were not decided, as conditions on the coefficients of cofactors; empty if all are found.
        is_cut_short: Whether the time limit ended the search.
    """

    system: EquationsOfMotion
    degree: int | None
    weight: int | None
    weights: tuple[int, ...]
    on: tuple[Expr, ...]
    field: Field
    known: dict[str, Expr] = dataclass_field(hash=False)
    found: tuple[DarbouxPolynomial, ...]
    rational_integrals: tuple[RationalIntegral, ...]
    time_dependent_integrals: tuple[TimeDependentIntegral, ...]
    cofactor_monomials: tuple[Expr, ...]
    n_monomials: int
    n_blocks: int
    n_cases: int
    left: tuple[str, ...]
    is_cut_short: bool = False

    @property
    def complete(self) -> bool:
        """Whether it is proved that all others are sums of products of those found and of the known integrals."""
        return not self.left

    @property
    def invariant_hypersurfaces(self) -> tuple[Expr, ...]:
        """The real polynomials p for which p = 0 is invariant, integrals left out: their levels all are."""
        return tuple(p.expression for p in self.found if p.is_real and p.cofactor != 0)

    @property
    def scope(self) -> str:
        """Which polynomials were searched, in words."""
        size = f"degree {self.degree}" if self.weight is None else f"weight {self.weight}"
        return f"polynomials up to {size}" + (f" on {where(self.on)}" if self.on else "")

    def __repr__(self) -> str:
        n = len(self.found)
        state = "complete" if self.complete else "incomplete" + CUT_SHORT * self.is_cut_short
        return f"<DarbouxPolynomials of {self.system.name}: {n} among {self.scope} {_WORDS[self.field]}, {state}>"

    def __str__(self) -> str:
        """The polynomials with their cofactors, the integrals made of them, and what is proved."""
        lines = [f"{self.system.name}: Darboux polynomials among {self.scope}, {_WORDS[self.field]}"]
        lines.append(f"known integrals: {', '.join(self.known) or 'none'}")
        lines += [f"{p.name} = {Formula(p.expression).plain}, cofactor {Formula(p.cofactor).plain}" for p in self.found]
        if not self.found:
            lines.append("no others than the known integrals")
        lines += [f"{r.name} = {r} is constant{r.remark}" for r in self.rational_integrals]
        lines += [f"{e.name} = {e} is constant{e.remark}" for e in self.time_dependent_integrals]
        return "\n".join([*lines, *self._proof()])

    def _proof(self) -> list[str]:
        blocks = f"{self.n_blocks} block{'s' * (self.n_blocks != 1)}"
        cofactors = ", ".join(Formula(m).plain for m in self.cofactor_monomials) or "0"
        effort = f"({self.n_monomials} monomials in {blocks}; cofactors with {cofactors}; {self.n_cases} cases)"
        if self.left:
            left = f"these cofactors k are left{CUT_SHORT * self.is_cut_short}"
            return [f"incomplete {effort}, {left}:", *(f"  {text}" for text in self.left)]
        others = "these and the known integrals" if self.found else "the known integrals"
        such = " with such a cofactor" if self.on else ""
        return [
            f"proved {_WORDS[self.field]}: Every other one{such} is a sum of products of {others}, all with one "
            f"cofactor. {effort}"
        ]

    def _repr_html_(self) -> str:
        """What a notebook shows: the text."""
        return as_text(str(self))


@shows_progress
def darboux_polynomials(
    system: EquationsOfMotion,
    *,
    degree: int | None = None,
    weight: int | None = None,
    on: Equations = (),
    known: Mapping[str, str | Expr] | None = None,
    field: Field = "complex",
    time_limit: float = SEARCH_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> DarbouxPolynomials:
    r"""All Darboux polynomials up to a total degree or a weight: $\dot p = k p$ with a polynomial k, the cofactor.

    p = 0 is then invariant, and products of powers whose cofactors add up to zero are rational integrals; if they add
    up to a number c, the product times $e^{-ct}$ is constant. Cofactors are found by splitting the linear system
    $(D - k) p = 0$, whose parameters are the coefficients of k, into cases; there are finitely many.

    Example:
        >>> body = lp.System(lp.so(3) @ lp.trivial(), "(l1^2 + 2*l2^2 + 6*l3^2)/2")
        >>> found = lp.integrability.darboux_polynomials(body, degree=1, field="real")
        >>> [(str(p.expression), str(p.cofactor)) for p in found.found]
        [('l1 + 2*l3', '2*l2'), ('l1 - 2*l3', '-2*l2')]

    Args:
        system: A system or vector field with polynomial equations and rational numbers in them.
        degree: The total degree; 2 if neither it nor the weight is given.
        weight: The largest weight instead, for equations that are homogeneous for positive weights of the coordinates.
        on: Equations of an invariant level set to which the search is restricted, as for `first_integrals`. There only
            cofactors are looked for that are homogeneous where the equations are.
        known: Integrals by name, of which polynomials are not looked for; by default H and the Casimirs, and none of a
            vector field.
        field: Which numbers the coefficients of cofactors may be: "complex", "real" or "rational". Those that are
            found have rational numbers and square roots; others are named in `left`.
        time_limit: Seconds after which the cases that are left are named; polynomials with the cofactors that were
            found are computed to the end.
        progress: As for `integrate`.

    Raises:
        ParameterError: the equations are no polynomials or their numbers are not rational, a known integral is none,
            the level is not invariant, there is no positive grading for a weight, or the search is too large.
        ExpressionError: a text cannot be read.
        TimeLimitError: there was no time to read the equations and integrals that are known, or to prepare the search.
    """
    if field not in get_args(Field):
        raise ParameterError(f"field: wanted 'complex', 'real' or 'rational'; got {shown(field)}")
    deadline = as_deadline(time_limit)
    with deadline.running():
        given = known_functions(system)
        if known is not None:
            given = {name: system.expression(f) for name, f in functions_by_name(known).items()}
        zeros = zeros_on_level(system, on)
        problem = SearchProblem.of(system, given, zeros)
        problem.check(given)
    derivation = problem.derivation
    if not derivation.field.is_rational:
        raise ParameterError(
            f"darboux_polynomials: wanted rational numbers in the equations; got {system.name} with "
            f"{', '.join(map(str, derivation.field.parameters)) or 'irrational ones'}; give rational values"
        )
    with deadline.running():
        level, size_asked = problem.level, SizeAsked.of(degree, weight)
        gradings = tuple(g for g in problem.gradings if not g.modulus)
        asked, size, weights = size_asked.monomials(derivation, gradings, MOST_MONOMIALS, up_to=True)
        monomials = cofactor_monomials(derivation, gradings, level)
    gradings = problem.gradings_of_known(gradings, weights)
    blocks = in_blocks((m for m in asked if level.is_standard(m)), gradings)
    ordered = sorted(blocks.items(), key=lambda item: len(item[1]))
    listen = progress or (lambda _: None)
    cases = CofactorCases(derivation, level, monomials, field)
    with deadline.running():
        values: list[tuple[Values, ...]] = []
        done, total = 0, sum(len(block) ** 2 for _, block in ordered)
        for _, block in ordered:
            values.append(cases.candidates(sorted(block, key=order, reverse=True)))
            done += len(block) ** 2
            listen(0.7 * done / total)
    numbers = square_root_field(v for of_block in values for one in of_block for v in one)
    search = DarbouxSearch(problem.search(gradings).over(numbers), tuple(monomials))
    for polynomial in problem.known.values():
        search.add_known(polynomial)
    n_known = len(search.factors)
    elements = [[tuple(square_root_element(v, numbers) for v in one) for one in of_block] for of_block in values]
    search.run(
        [(label, block, of_block) for (label, block), of_block in zip(ordered, elements, strict=True)],
        lambda f: listen(0.7 + 0.3 * f),
    )
    new = sorted(search.factors[n_known:], key=lambda f: (f.degree, len(f.polynomial)))
    expressions = [search.search.derivation.expression(_tidied(f.polynomial, numbers)) for f in new]
    taken, names = {*system.component_names, *given}, list[str]()
    for _ in new:
        names.append(next_name(taken, names, letter="P"))
    found = tuple(
        DarbouxPolynomial(name, e, search.cofactor_expression(f), f.degree)
        for name, f, e in zip(names, new, expressions, strict=True)
    )
    return DarbouxPolynomials(
        system=system,
        degree=size_asked.degree,
        weight=weight,
        weights=weights,
        on=tuple(zeros),
        field=field,
        known=given,
        found=found,
        rational_integrals=rational_integrals(search, new, names, expressions, taken),
        time_dependent_integrals=time_dependent_integrals(search, new, names, expressions, taken),
        cofactor_monomials=tuple(derivation.expression({m: derivation.field.one}) for m in monomials),
        n_monomials=size,
        n_blocks=len(ordered),
        n_cases=cases.n_cases,
        left=tuple(dict.fromkeys(cases.left)),
        is_cut_short=cases.is_cut_short,
    )


def _tidied(polynomial: Polynomial, field: Coefficients) -> Polynomial:
    """With whole coefficients as far as possible: without denominators if the leading one is rational."""
    if field.is_rational:
        return tidied(polynomial)
    leading = polynomial[max(polynomial, key=lambda m: (sum(m), m))]
    monic = {m: c / leading for m, c in polynomial.items()}
    numbers: list[Any] = [x for c in monic.values() for x in field.to_sympy(c).as_coefficients_dict().values()]
    scale = field.number(lcm(*(int(x.q) for x in numbers)))
    return {m: c * scale for m, c in monic.items()}
