r"""Families: for which parameters does a system have a further first integral?

The search for integrals is a linear system whose matrix contains the parameters. It is split into cases
(`liepoisson.integrability.parameter_cases`), which are proved: in all other cases there is no further integral.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import chain
from random import Random
from typing import TYPE_CHECKING, Any, cast

from liepoisson.calls import explains_its_arguments, shows_progress
from liepoisson.errors import ParameterError
from liepoisson.exact.printing import Formula
from liepoisson.integrability.derivation import Derivation, Exponents, derivation_of
from liepoisson.integrability.level import level_of, order
from liepoisson.integrability.monomials import in_blocks, n_monomials, of_degree
from liepoisson.integrability.parameter_cases import Case, Cases, CaseSplitting, Poly
from liepoisson.integrability.parameter_matrix import ParameterMatrix
from liepoisson.integrability.polynomial_integrals import (
    first_integrals,
    gradings_of_level,
    known_functions,
    zeros_on_level,
)
from liepoisson.integrability.search import Generator, Search
from liepoisson.scalars import as_count, as_time_limit

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from liepoisson.exact.system import System

MOST_MONOMIALS = 3000
_MOST_EXAMPLES = 200
"""Random values that are tried until they are in a case."""


@dataclass(frozen=True)
class ParameterCase:
    """Parameters for which there is a further integral.

    Attributes:
        conditions: Polynomials in the parameters that vanish.
        nonzero: Polynomials that must not vanish for the conditions to suffice, besides what was assumed; where they do
            vanish, the limits of other parameters of the case belong to it.
        example: Random values with these conditions; None where the conditions are not solved by rational numbers.
        integrals: The integrals at these values that are functionally independent of H, the Casimirs and the integrals
            that there are for all parameters; a search there has found them.
    """

    conditions: tuple[Expr, ...]
    nonzero: tuple[Expr, ...]
    example: dict[Symbol, Expr] | None
    integrals: tuple[Expr, ...]

    @property
    def remark(self) -> str:
        """What the example does not show; empty where it shows an independent integral."""
        if self.example is None:
            return "no rational example"
        return "" if self.integrals else "a function of the known ones at the example"

    def __str__(self) -> str:
        words = ", ".join(f"{Formula(c).plain} = 0" for c in self.conditions) or "all parameters"
        if self.nonzero:
            words += f", where {' and '.join(f'{Formula(c).plain} is not 0' for c in self.nonzero)}"
        return f"{words}   ({self.remark})" if self.remark else words

    def holds_at(self, values: Mapping[str, Any]) -> bool:
        """Whether parameters, by name, satisfy the conditions, and those that must not vanish do not.

        Raises:
            ParameterError: a parameter of the conditions has no value.
        """
        from liepoisson.exact.parameters import to_sympy
        from liepoisson.exact.values import read_values

        at = {name: to_sympy(cast("Any", v)) for name, v in read_values(values).items()}
        missing = {str(s) for c in (*self.conditions, *self.nonzero) for s in c.free_symbols} - at.keys()
        if missing:
            raise ParameterError(f"values: wanted one for each parameter; got none for {', '.join(sorted(missing))}")
        inserted = [[cast("Any", c).subs(at).expand() for c in part] for part in (self.conditions, self.nonzero)]
        return all(c == 0 for c in inserted[0]) and all(c != 0 for c in inserted[1])


@dataclass(frozen=True, repr=False)
class IntegrableFamilies:
    """For which parameters a system has further polynomial integrals.

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

    @property
    def complete(self) -> bool:
        """Whether it is proved that there are no other cases."""
        return not self.left

    def __repr__(self) -> str:
        state = "complete" if self.complete else f"incomplete: {_counted(len(self.left))} left"
        return f"<IntegrableFamilies of {self.system.name}, degree {self.degree}: {len(self.cases)} cases, {state}>"

    @property
    def scope(self) -> str:
        """Which integrals were looked for, in words."""
        where = f" on {', '.join(f'{Formula(f).plain} = 0' for f in self.on)}" if self.on else ""
        return f"up to degree {self.degree}{where}"

    def __str__(self) -> str:
        """The cases, and what is proved."""
        lines = [f"{self.system.name}: a further polynomial integral {self.scope} exists ({self.assumptions})"]
        lines += [f"  if {case}" for case in self.cases] or [
            "  in no case that was decided" if self.left else "  never"
        ]
        if self.complete:
            lines.append(f"and in no other case: proved ({self.n_closed} cases without)")
        else:
            lines += [f"incomplete, {_counted(len(self.left))} left:", *(f"  {text}" for text in self.left)]
        return "\n".join(lines)


def _counted(n: int) -> str:
    return "1 case is" if n == 1 else f"{n} cases are"


@explains_its_arguments
@shows_progress
def integrable_families(
    system: System,
    *,
    degree: int = 2,
    on: Sequence[str | Expr] = (),
    positive: Sequence[str] = (),
    nonzero: Sequence[str] = (),
    time_limit: float = 600.0,
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
        time_limit: Seconds after which the cases that are left are named.
        progress: As for `integrate`.

    Raises:
        ParameterError: the system has no symbols or no polynomial equations, its numbers are not rational, the level is
            not invariant, or the search is too large.
    """
    d, limit = as_count(degree, "degree", least=1), as_time_limit(time_limit)
    known, zeros = known_functions(system), zeros_on_level(system, on)
    derivation, polynomials = derivation_of(system, *known.values(), *zeros)
    check_parameters(system, derivation, "integrable_families")
    names = [str(s) for s in derivation.field.parameters]
    for name in (*positive, *nonzero):
        if name not in names:
            raise ParameterError(f"positive, nonzero: wanted names of {', '.join(names)}; got {name!r}")
    if (size := n_monomials(len(system.variables), d)) > MOST_MONOMIALS:
        raise ParameterError(
            f"degree: wanted at most {MOST_MONOMIALS:,} monomials; {d} has {size:,}; take a smaller one"
        )
    zero_polynomials = polynomials[len(known) :]
    search = Search(
        derivation,
        gradings_of_level(derivation, zero_polynomials),
        level_of(derivation, zero_polynomials),
        tuple(z for z in zero_polynomials if z),
        [],
    )
    for name, polynomial in zip(known, polynomials[: len(known)], strict=True):
        if any(map(any, remainder := search.level.remainder(polynomial))):
            search.generators.append(Generator(name, remainder, is_new=False))
    matrix = ParameterMatrix(derivation, zero_polynomials, search.level)
    search.run(_monomials(len(system.variables), d))
    splitting = CaseSplitting(
        matrix.context,
        frozenset(matrix.names.index(name) for name in positive),
        [
            *(matrix.context.gen(matrix.names.index(name)) for name in (*nonzero, *positive)),
            matrix.denominator,
        ],
        matrix.scalings(),
    )
    cases = _split(search, splitting, matrix, degree=d, time_limit=limit, progress=progress)
    general = {g.name: derivation.expression(g.polynomial) for g in search.generators if g.is_new}
    members = _Members(system, d, zeros, known | general)
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
        cases=tuple(members.described(case, splitting, matrix) for case in cases.found),
        left=tuple(_words(case, splitting, matrix) for case in cases.left),
        n_closed=cases.n_closed,
    )


def check_parameters(system: System, derivation: Derivation, caller: str) -> None:
    """Refuse a system without symbols, or with other numbers than rational ones."""
    symbols = derivation.field.parameters
    ring: Any = getattr(derivation.field.domain, "domain", None)
    if not symbols or not (ring.is_QQ or ring.is_ZZ):
        raise ParameterError(
            f"{caller}: wanted a system with symbols for parameters and rational numbers; got "
            f"{system.name} with {', '.join(map(str, symbols)) or 'no symbols'}"
        )


def _monomials(n: int, degree: int) -> Iterator[Exponents]:
    return chain.from_iterable(of_degree(n, k) for k in range(1, degree + 1))


def _split(
    search: Search,
    splitting: CaseSplitting,
    matrix: ParameterMatrix,
    *,
    degree: int,
    time_limit: float,
    progress: Callable[[float], Any] | None,
) -> Cases:
    """The cases of all blocks, small ones first: what lies in a case that is known is not looked at again."""
    n_known = {count.label: count.n_known for count in search.counts}
    standard = (m for m in _monomials(len(matrix.components), degree) if search.level.is_standard(m))
    blocks = in_blocks(standard, search.gradings)
    cases, deadline = Cases(), time.monotonic() + time_limit
    for k, (label, block) in enumerate(sorted(blocks.items(), key=lambda item: len(item[1]))):
        block.sort(key=order, reverse=True)
        splitting.run(matrix.rows(block), len(block), n_known[label], cases, lambda: time.monotonic() < deadline)
        if progress:
            progress((k + 1) / len(blocks))
    splitting.settle(cases)
    return cases


def _words(case: Case, splitting: CaseSplitting, matrix: ParameterMatrix) -> str:
    """The equations of a case that was left."""
    return ", ".join(f"{Formula(matrix.sympy(q)).plain} = 0" for q in splitting.conditions(case)) or "all parameters"


class _Members:
    """Random members of the cases, at which integrals are searched again."""

    def __init__(self, system: System, degree: int, on: Sequence[Expr], known: Mapping[str, Expr]) -> None:
        self.system, self.degree, self.on, self.known = system, degree, on, known

    def described(self, case: Case, splitting: CaseSplitting, matrix: ParameterMatrix) -> ParameterCase:
        """A case with an example at which the integrals are found again."""
        conditions = tuple(matrix.sympy(q) for q in splitting.conditions(case))
        nonzero = tuple(matrix.sympy(q) for q in splitting.divisors(case))
        example = _example(case, splitting.positive, matrix)
        if example is None:
            return ParameterCase(conditions, nonzero, None, ())
        found = first_integrals(
            self._member(example),
            degree=self.degree,
            on=[cast("Expr", f.xreplace(example)) for f in self.on],
            known={name: value for name, f in self.known.items() if not (value := _at(f, example)).is_number},
        )
        return ParameterCase(conditions, nonzero, example, tuple(f.expression for f in found.independent))

    def _member(self, example: Mapping[Any, Any]) -> System:
        from liepoisson.exact.system import System

        values = {str(s): Fraction(int(v.p), int(v.q)) for s, v in example.items()}
        return System(
            self.system.bracket.substitute(values),
            cast("Expr", self.system.hamiltonian.xreplace(dict(example))),
            name=self.system.name,
        )


def _at(function: Expr, example: Mapping[Any, Any]) -> Expr:
    """A function, whose coefficients have no denominators, at values of the parameters."""
    return cast("Expr", cast("Any", function).as_numer_denom()[0].xreplace(dict(example)))


def _example(case: Case, positive: frozenset[int], matrix: ParameterMatrix) -> dict[Any, Any] | None:
    """Values of the parameters in a case; None if none is found."""
    from flint import fmpq
    from sympy import Rational

    if case.unsolved:
        return None
    bound = {v for v, _ in case.scaled} | {v for v, _, _ in case.solved}
    n, random = len(matrix.symbols), Random(1)
    for _ in range(_MOST_EXAMPLES):
        values = [fmpq(1)] * n
        for v in set(range(n)) - bound:
            values[v] = fmpq(
                random.randint(1, 9) * (1 if v in positive else random.choice((-1, 1))), random.randint(1, 4)
            )
        at = dict(zip(matrix.names, values, strict=True))
        for v, a, b in case.solved:
            if not (below := _value(b, at)):
                break
            values[v] = _value(a, at) / below
        else:
            at = dict(zip(matrix.names, values, strict=True))
            if all(values[v] > 0 for v in positive) and all(_value(q, at) for q in case.nonzero.values()):
                return {s: Rational(int(x.p), int(x.q)) for s, x in zip(matrix.symbols, values, strict=True)}
    return None


def _value(polynomial: Poly, at: Mapping[str, Any]) -> Any:
    return polynomial.subs(dict(at)).leading_coefficient() if polynomial else 0
