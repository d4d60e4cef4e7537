r"""The critical values of a momentum map as zeros of polynomials, exactly, where all functions are polynomials.

The fields of the integrals $F_1, \dots, F_n$ are dependent at x where, for some k,

$$ X_{F_k} + \sum_{j>k} \lambda_j X_{F_j} = 0. $$

For each k these are polynomial equations for x and the $\lambda_j$, of lower degree than determinants of derivatives.
With the values of Casimirs they generate an ideal, whose zeros fall into components.  On each of them the integrals,
and the Casimirs without a value, are dependent by Sard's theorem.  The polynomials of least degree that vanish at their
values are found by linear algebra among normal forms (`liepoisson.algebra.ideals.operations.Image`).

The values of all real critical states are zeros, but a real zero need not be such a value: an isolated thread, for
instance, is the double point of a curve that is complex around it.
"""

from __future__ import annotations

import sys
from collections.abc import Generator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import gcd, lcm, prod
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.exact_numbers import to_sympy
from liepoisson.algebra.ideals.buchberger import Poly
from liepoisson.algebra.ideals.components import Assumptions, Component, components, irreducible_factors
from liepoisson.algebra.ideals.groebner import new_name, rational_context
from liepoisson.algebra.ideals.limits import Budget, Limits, NotDecidedError
from liepoisson.algebra.ideals.operations import Image
from liepoisson.algebra.ideals.polynomial_system import polynomial
from liepoisson.errors import ParameterError
from liepoisson.formula.parameters import read_parameter
from liepoisson.formula.scalars import as_time_limit
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.deadline import SEARCH_LIMIT, Deadline, checkpoint
from liepoisson.inputs.given import named
from liepoisson.inputs.refusals import shown
from liepoisson.leaf._checks import by_name, formulas
from liepoisson.tori.momentum_maps import MomentumMap, map_of

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.model.phase_functions import PhaseFunction
    from liepoisson.model.system import System

_BY_TIME = Limits(work=sys.maxsize, degree=sys.maxsize)
"""The time limit of the call is the only one."""


@dataclass(frozen=True, eq=False)
class CriticalEquations:
    """Polynomials of which each critical value is a zero.

    Example:
        >>> found = lp.tori.critical_equations(lp.catalog.system("kovalevskaya"), {"C1": 0, "C2": 1})
        >>> [str(one) for one in found.curves]
        ['K', 'K - 1', 'H**2 - K', 'H**2 - K + 1']

    Attributes:
        momentum: The momentum map.
        casimirs: The values of Casimirs, by their names; the others are variables of the polynomials.
        curves: SymPy polynomials with whole coefficients, irreducible over the rationals, by degree: a critical value
            is a zero of one of them, or of all of one of `others`.  Of more than two variables they are surfaces.
        others: Polynomials that vanish together at further critical values, such as those of an equilibrium.
    """

    momentum: MomentumMap
    casimirs: dict[str, Fraction]
    curves: tuple[Expr, ...]
    others: tuple[tuple[Expr, ...], ...]

    def equations(self) -> list[tuple[Expr, ...]]:
        """The polynomials, those that vanish together beside each other."""
        return [*((p,) for p in self.curves), *self.others]

    def __str__(self) -> str:
        from liepoisson.report.printing import Formula

        lines = (" and ".join(f"{Formula(p).plain} = 0" for p in one) for one in self.equations())
        return "\n".join([repr(self)[1:-1], *lines])

    def __repr__(self) -> str:
        at = "".join(f", {name} = {value}" for name, value in self.casimirs.items())
        n = len(self.curves)
        return (
            f"<Critical equations of ({', '.join(self.momentum.names)}) of {self.momentum.system.name!r}{at}: "
            f"{n} curve{'s' * (n != 1)}>"
        )


@explains_its_arguments
def critical_equations(
    system: System | MomentumMap,
    casimirs: Mapping[str, float | str | Fraction] | None = None,
    *,
    integrals: Sequence[str | Expr | PhaseFunction] | None = None,
    time_limit: float = SEARCH_LIMIT,
) -> CriticalEquations:
    r"""The equations of the critical values of an integrable system, exactly, for polynomial integrals.

    Example:
        >>> found = lp.tori.critical_equations(lp.catalog.system("spherical-pendulum"), {"C1": 0, "C2": 1})
        >>> print(*found.curves)
        16*H**4 - 8*H**3*l3**2 - 32*H**2 + 72*H*l3**2 - 27*l3**4 + 16

    Args:
        system: A system, or its momentum map.
        casimirs: Values of Casimirs, rational numbers, by name or formula.  Those without a value are variables of the
            equations.
        integrals: The integrals beside H, for a system; by default the known ones that commute.
        time_limit: Seconds that the call may take.

    Raises:
        ParameterError: the Hamiltonian, an integral or a Casimir is no polynomial with rational coefficients, or a
            name or a value of a Casimir is none.
        TimeLimitError: the time is over.  Curves that are found numerically: `lp.tori.diagram`.
    """
    deadline = Deadline(as_time_limit(time_limit))
    momentum = map_of(system, integrals)
    known = momentum.system.functions.casimirs
    values = _rational(momentum.system, casimirs)
    functions = {name: f.expression for name, f in momentum.integrals.items()}
    free = {name: f.expression for name, f in known.items() if name not in values}
    if both := sorted(functions.keys() & free.keys()):
        raise ParameterError(f"integrals: wanted other names than those of Casimirs without a value; got {both[0]}")
    _check_polynomials(momentum.system, {**functions, **{name: f.expression for name, f in known.items()}})
    levels = [known[name].expression - to_sympy(value) for name, value in values.items()]
    with deadline.running():
        try:
            found = _equations(momentum, functions | free, levels)
        except NotDecidedError:
            checkpoint("looking for the equations of critical values")
            raise
    return CriticalEquations(momentum, values, *found)


def _rational(system: System, casimirs: Mapping[str, Any] | None) -> dict[str, Fraction]:
    """The values of Casimirs that are given, by the names C1, C2, ..."""
    given = {} if casimirs is None else named(casimirs, "casimirs")
    if given is None:
        raise ParameterError(f"casimirs: wanted values by name, {', '.join(formulas(system))}; got {shown(casimirs)}")
    values = dict[str, Fraction]()
    for name, value in by_name(system, given).items():
        number = read_parameter(value, name)
        if not isinstance(number, Fraction):
            raise ParameterError(f"{name}: wanted a rational number; got {shown(value)}")
        values[name] = number
    return values


def _check_polynomials(system: System, functions: Mapping[str, Expr]) -> None:
    context = rational_context([str(v) for v in system.variables])
    for name, f in functions.items():
        try:
            polynomial(f.expand(), context)
        except ParameterError as error:
            raise ParameterError(
                f"{name}: wanted a polynomial with rational coefficients; got {shown(f)}. lp.tori.diagram finds "
                "critical values numerically."
            ) from error


def _equations(
    momentum: MomentumMap, functions: Mapping[str, Expr], levels: Sequence[Expr]
) -> tuple[tuple[Expr, ...], tuple[tuple[Expr, ...], ...]]:
    """The polynomials of one component after the other, the largest first: later ones are mostly parts of the known."""
    from sympy import Symbol

    budget, values = _BY_TIME.budget(), rational_context([f"y{k}" for k in range(len(functions))])
    curves, others = list[Poly](), list[list[Poly]]()
    for part in sorted(_components(momentum, levels, budget), key=lambda part: -part.dimension):
        context = part.basis.context
        image = Image(part.basis, [polynomial(f.expand(), context) for f in functions.values()], values, budget)
        # a component that is not proved to be irreducible may lie on several curves
        if image.vanishes(prod(curves, start=values.constant(1))):
            continue
        found = image.relations()
        if len(found) == 1:
            curves += (p for p in irreducible_factors(found[0]) if p not in curves)
        else:
            others.append(found)
    symbols = [Symbol(name) for name in functions]
    curves.sort(key=lambda p: (int(p.total_degree()), str(p)))
    return (
        tuple(_expression(p, symbols) for p in curves),
        tuple(tuple(_expression(p, symbols) for p in one) for one in others),
    )


def _components(momentum: MomentumMap, levels: Sequence[Expr], budget: Budget) -> Generator[Component]:
    """The components of the critical set, with multipliers."""
    from sympy import Add, Symbol

    system = momentum.system
    names = [str(v) for v in system.variables]
    for _ in momentum.names[1:]:
        names.append(new_name(names))
    n = len(names) - len(system.variables)
    fields = [system.bracket.vector_field(f.expression) for f in momentum.integrals.values()]
    for k, first in enumerate(fields):
        multipliers = names[len(names) - n + k :]
        context = rational_context([*names[: len(names) - n], *multipliers])
        rows = zip(first, *fields[k + 1 :], strict=True)
        sums = [Add(rate, *(Symbol(t) * r for t, r in zip(multipliers, rest, strict=True))) for rate, *rest in rows]
        equations = [polynomial(e.expand(), context) for e in (*levels, *sums)]
        yield from components([e for e in equations if e] or [context.constant(0)], Assumptions(is_real=True), budget)


def _expression(p: Poly, symbols: Sequence[Expr]) -> Expr:
    """The polynomial with whole coefficients without a common divisor."""
    from sympy import Add, Integer, Mul

    terms = [(tuple(map(int, m)), Fraction(int(c.p), int(c.q))) for m, c in p.terms()]
    size = Fraction(gcd(*(c.numerator for _, c in terms)), lcm(*(c.denominator for _, c in terms)))
    size *= 1 if max(terms)[1] > 0 else -1
    return Add(*(Mul(Integer(int(c / size)), *(x**k for x, k in zip(symbols, m, strict=True))) for m, c in terms))
