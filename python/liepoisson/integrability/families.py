r"""Families: for which parameters does a system have a further first integral?

The search for integrals is a linear system whose matrix contains the parameters. It is split into cases
(`liepoisson.integrability.parameter_cases`), which are proved: in all other cases there is no further integral.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import chain
from math import lcm
from random import Random
from typing import TYPE_CHECKING, Any, cast

from liepoisson.calls import explains_its_arguments, shows_progress
from liepoisson.errors import ParameterError
from liepoisson.exact.linear.coefficients import Coefficients
from liepoisson.exact.linear.echelon import Echelon
from liepoisson.integrability.derivation import Derivation, Exponents, derivation_of
from liepoisson.integrability.gradings import gradings
from liepoisson.integrability.level import Level, order
from liepoisson.integrability.monomials import in_blocks, n_monomials, of_degree
from liepoisson.integrability.parameter_cases import Case, Cases, CaseSplitting, Poly, SparseRow
from liepoisson.integrability.polynomial_integrals import first_integrals
from liepoisson.integrability.search import Generator, Search
from liepoisson.scalars import as_count, as_time_limit

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from liepoisson.exact.system import System

MOST_MONOMIALS = 3000


@dataclass(frozen=True)
class ParameterCase:
    """Parameters for which there is a further integral.

    Attributes:
        conditions: Polynomials in the parameters that vanish.
        example: Random values with these conditions; None where the conditions are not solved by rational numbers.
        integrals: The integrals at these values that are functionally independent of H and the Casimirs; a search there
            has found them.
    """

    conditions: tuple[Expr, ...]
    example: dict[Symbol, Expr] | None
    integrals: tuple[Expr, ...]

    def __str__(self) -> str:
        return ", ".join(f"{c} = 0" for c in self.conditions) or "all parameters"


@dataclass(frozen=True, repr=False)
class IntegrableFamilies:
    """For which parameters a system has further polynomial integrals.

    Attributes:
        system: The system.
        degree: The degree of the integrals.
        parameters: The parameters.
        assumptions: What was assumed of them, in words.
        cases: The cases with a further integral.
        left: Cases that were not decided, as conditions; empty if the answer is complete.
        n_closed: Number of cases in which it was proved that there is none.
    """

    system: System
    degree: int
    parameters: tuple[Expr, ...]
    assumptions: str
    cases: tuple[ParameterCase, ...]
    left: tuple[str, ...]
    n_closed: int

    @property
    def complete(self) -> bool:
        """Whether it is proved that there are no other cases."""
        return not self.left

    def __repr__(self) -> str:
        state = "complete" if self.complete else f"incomplete: {len(self.left)} cases are left"
        return f"<IntegrableFamilies of {self.system.name}, degree {self.degree}: {len(self.cases)} cases, {state}>"

    def __str__(self) -> str:
        lines = [
            f"{self.system.name}: a further polynomial integral up to degree {self.degree} exists ({self.assumptions})"
        ]
        lines += [f"  if {case}" for case in self.cases] or ["  never"]
        if self.complete:
            lines.append(f"and in no other case: proved ({self.n_closed} cases without)")
        else:
            lines += ["incomplete, these cases are left:", *(f"  {text}" for text in self.left)]
        return "\n".join(lines)


@explains_its_arguments
@shows_progress
def integrable_families(
    system: System,
    *,
    degree: int = 2,
    positive: Sequence[str] = (),
    nonzero: Sequence[str] = (),
    time_limit: float = 600.0,
    progress: Callable[[float], Any] | None = None,
) -> IntegrableFamilies:
    """For which values of its parameters does a system have a polynomial integral that it does not have in general?

    Example:
        >>> body = lp.System(lp.so(3) @ lp.trivial(), "(l1^2 + l2^2 + J*l3^2)/2 + a*l1", symbols=["J", "a"])
        >>> found = lp.integrability.integrable_families(body, degree=1, positive=["J"])
        >>> [str(case) for case in found.cases], found.complete
        (['a = 0', 'J - 1 = 0'], True)

    Args:
        system: A system with symbols for parameters, which are real numbers.
        degree: The total degree of the integrals.
        positive: Names of parameters that are positive.
        nonzero: Names of parameters that are not zero.
        time_limit: Seconds after which the cases that are left are named.
        progress: As for `integrate`.

    Raises:
        ParameterError: the system has no symbols or no polynomial equations, or its numbers are not rational.
    """
    d, limit = as_count(degree, "degree", least=1), as_time_limit(time_limit)
    known = {"H": system.hamiltonian} | {f"C{k}": c for k, c in enumerate(system.bracket.casimirs(), start=1)}
    derivation, polynomials = derivation_of(system, *known.values())
    symbols = derivation.field.parameters
    ring: Any = getattr(derivation.field.domain, "domain", None)
    if not symbols or not (ring.is_QQ or ring.is_ZZ):
        raise ParameterError(
            "integrable_families: wanted a system with symbols for parameters and rational numbers; got "
            f"{system.name} with {', '.join(map(str, symbols)) or 'no symbols'}"
        )
    if (size := n_monomials(len(system.variables), d)) > MOST_MONOMIALS:
        raise ParameterError(
            f"degree: wanted at most {MOST_MONOMIALS:,} monomials; {d} has {size:,}; take a smaller one"
        )
    names = [str(s) for s in symbols]
    for name in (*positive, *nonzero):
        if name not in names:
            raise ParameterError(f"positive, nonzero: wanted names of {', '.join(names)}; got {name!r}")
    work = _Work(derivation, names)
    splitting = CaseSplitting(
        work.context,
        frozenset(names.index(name) for name in positive),
        [*(work.context.gen(names.index(name)) for name in (*nonzero, *positive)), *work.denominators],
        work.scalings(),
    )
    generators = [Generator(name, p, is_new=False) for name, p in zip(known, polynomials, strict=True)]
    search = Search(derivation, gradings(derivation), Level(), (), generators)
    search.run(chain.from_iterable(of_degree(len(system.variables), k) for k in range(1, d + 1)))
    n_known = {count.label: count.n_known for count in search.counts}
    blocks = in_blocks(
        chain.from_iterable(of_degree(len(system.variables), k) for k in range(1, d + 1)), search.gradings
    )
    cases, deadline = Cases(), time.monotonic() + limit
    for k, (label, block) in enumerate(sorted(blocks.items(), key=lambda item: len(item[1]))):
        block.sort(key=order, reverse=True)
        splitting.run(work.rows(block), len(block), n_known[label], cases, lambda: time.monotonic() < deadline)
        if progress:
            progress((k + 1) / len(blocks))
    assumed = [f"{', '.join(positive)} > 0"] if positive else []
    assumed += [f"{name} not 0" for name in nonzero]
    assumed += [f"{work.sympy(q)} not 0" for q in work.denominators if not q.is_constant()]
    return IntegrableFamilies(
        system=system,
        degree=d,
        parameters=tuple(symbols),
        assumptions="; ".join(dict.fromkeys(["real parameters", *assumed])),
        cases=tuple(work.described(case, splitting, system, d) for case in cases.found),
        left=tuple(
            ", ".join(f"{work.sympy(q)} = 0" for q in (*c.equations, *c.unsolved)) or "generic" for c in cases.left
        ),
        n_closed=cases.n_closed,
    )


class _Work:
    """The matrix of a search with polynomials of FLINT for entries."""

    def __init__(self, derivation: Derivation, names: Sequence[str]) -> None:
        from flint import fmpq_mpoly_ctx

        self.context: Any = fmpq_mpoly_ctx.get(list(names), "degrevlex")
        self.symbols = derivation.field.parameters
        self._one = self.context.constant(1)
        self._components: list[dict[Exponents, Poly]] = []
        self.denominators: list[Poly] = []
        for component in derivation.components:
            pairs = {m: (self._read(c.numer), self._read(c.denom)) for m, c in component.items()}
            self.denominators += [b for _, b in pairs.values() if not b.is_constant()]
            self._components.append(pairs)  # type: ignore[arg-type]

    def _read(self, polynomial: Any) -> Poly:
        from flint import fmpq

        terms = {tuple(map(int, m)): fmpq(int(c.numerator), int(c.denominator)) for m, c in polynomial.terms()}
        return self.context.from_dict(terms)

    def rows(self, block: Sequence[Exponents]) -> list[SparseRow]:
        """The matrix of D on some monomials, each row times its denominators."""
        entries: dict[Exponents, dict[int, list[tuple[Poly, Poly]]]] = {}
        for column, monomial in enumerate(block):
            for k, power in enumerate(monomial):
                if not power:
                    continue
                lowered = (*monomial[:k], power - 1, *monomial[k + 1 :])
                for factor, (a, b) in self._components[k].items():  # type: ignore[misc]
                    key = tuple(map(sum, zip(lowered, factor, strict=True)))
                    entries.setdefault(key, {}).setdefault(column, []).append((a * power, b))
        rows: list[SparseRow] = []
        for row in entries.values():
            common = self._one
            for pairs in row.values():
                for _, b in pairs:
                    common = common * (b // common.gcd(b))
            new: SparseRow = {}
            for column, pairs in row.items():
                total = self.context.constant(0)
                for a, b in pairs:
                    total = total + a * (common // b)
                if total:
                    new[column] = total
            if new:
                rows.append(new)
        return rows

    def scalings(self) -> list[tuple[int, ...]]:
        """Independent weights of the parameters with which the equations are homogeneous."""
        if any(not b.is_constant() for pairs in self._components for _, b in pairs.values()):
            return []
        n, k = len(self._components), len(self.symbols)
        extended: list[dict[Exponents, Any]] = [
            {(*m, *map(int, powers)): 1 for m, (a, _) in pairs.items() for powers, _ in a.terms()}  # type: ignore[misc]
            for pairs in self._components
        ]
        names: Any = tuple(range(n + k))  # gradings look at exponents alone
        whole = Derivation(names, (*extended, *({} for _ in range(k))), Coefficients())
        rows = [g.weights[n:] for g in gradings(whole) if not g.modulus]
        found = Echelon(Coefficients())
        for row in rows:
            found.insert({i: Fraction(w) for i, w in enumerate(row) if w})
        scalings: list[tuple[int, ...]] = []
        for vector in found.basis():
            scale = lcm(*(c.denominator for c in vector.values()))
            scalings.append(tuple(int(vector.get(i, Fraction(0)) * scale) for i in range(k)))
        return scalings

    def sympy(self, polynomial: Poly) -> Expr:
        """A polynomial in the parameters as an expression with whole coefficients."""
        from sympy import Add, Mul, Rational

        terms: list[Any] = [
            Mul(Rational(int(c.p), int(c.q)), *(s ** int(k) for s, k in zip(self.symbols, m, strict=True)))
            for m, c in polynomial.terms()
        ]
        whole = Add(*terms).as_numer_denom()[0]
        return -whole if whole.could_extract_minus_sign() else whole

    def described(self, case: Case, splitting: CaseSplitting, system: System, degree: int) -> ParameterCase:
        """A case with an example at which the integral is found again."""
        conditions = tuple(self.sympy(q) for q in splitting.conditions(case))
        example = self._example(case, splitting.positive)
        if example is None:
            return ParameterCase(conditions, None, ())
        values = {str(s): v for s, v in example.items()}
        member = type(system)(
            system.bracket.substitute({name: Fraction(int(v.p), int(v.q)) for name, v in values.items()}),
            cast("Expr", system.hamiltonian.xreplace(example)),
        )
        found = first_integrals(member, degree=degree)
        return ParameterCase(conditions, example, tuple(f.expression for f in found.found))

    def _example(self, case: Case, positive: frozenset[int]) -> dict[Any, Any] | None:
        """Values of the parameters in a case; None if none is found."""
        from flint import fmpq
        from sympy import Rational

        if case.unsolved:
            return None
        bound = {v for v, _ in case.scaled} | {v for v, _, _ in case.solved}
        n, random = len(self.symbols), Random(1)
        for _ in range(200):
            values = [fmpq(1)] * n
            for v in set(range(n)) - bound:
                values[v] = fmpq(
                    random.randint(1, 9) * (1 if v in positive else random.choice((-1, 1))), random.randint(1, 4)
                )
            at = dict(zip(map(str, self.symbols), values, strict=True))
            for v, a, b in case.solved:
                if not (below := _value(b, at)):
                    break
                values[v] = _value(a, at) / below
            else:
                at = dict(zip(map(str, self.symbols), values, strict=True))
                if all(values[v] > 0 for v in positive) and all(_value(q, at) for q in case.nonzero.values()):
                    return {s: Rational(int(x.p), int(x.q)) for s, x in zip(self.symbols, values, strict=True)}
        return None


def _value(polynomial: Poly, at: Mapping[str, Any]) -> Any:
    return polynomial.subs(dict(at)).leading_coefficient() if polynomial else 0
