"""What a search for integrals is given: known integrals, a level set, a degree or a weight."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import chain, count
from typing import Any, TypeAlias, cast

from sympy import Expr

from liepoisson.algebra.exact_numbers import is_sympy, to_sympy
from liepoisson.algebra.sparse_polynomials import Polynomial
from liepoisson.errors import ParameterError
from liepoisson.formula.parameters import Parameter, read_parameter
from liepoisson.formula.scalars import as_count
from liepoisson.inputs.given import by_name, listed, named
from liepoisson.inputs.refusals import not_a, shown
from liepoisson.integrability.algebraic_functions import AlgebraicEquations
from liepoisson.integrability.derivation import (
    Derivation,
    Exponents,
    Grading,
    Level,
    derivation_of,
    gradings,
    level_of,
    n_monomials,
    n_of_weights,
    of_weight,
    positive_grading,
    real_points,
    squarefree,
    up_to_degree,
)
from liepoisson.integrability.search import Generator, Search
from liepoisson.model.equations_of_motion import EquationsOfMotion
from liepoisson.model.hamiltonian import symbols_in
from liepoisson.model.system import System
from liepoisson.report.printing import Formula
from liepoisson.structure.bracket import Bracket

Equations: TypeAlias = "str | Expr | Sequence[str | Expr] | Mapping[str, Parameter]"
"""Equations of a level set: texts or functions that vanish, one or several, or values by name."""

_LARGEST_WEIGHT = 10_000


@dataclass(frozen=True)
class SearchProblem:
    """Equations of motion, known integrals, and a level set, as polynomials over one field."""

    equations: AlgebraicEquations
    known: dict[str, Polynomial]  # the integrals that are known, by name
    zeros: list[Polynomial]  # the functions that vanish on the level set; empty for all of phase space

    @classmethod
    def of(cls, system: EquationsOfMotion, known: Mapping[str, Expr], on: Sequence[Expr]) -> SearchProblem:
        """The problem for a system with polynomial equations."""
        derivation, functions = derivation_of(system, *known.values(), *on)
        n = len(known)
        return cls(AlgebraicEquations(derivation, {}, ()), dict(zip(known, functions[:n], strict=True)), functions[n:])

    @property
    def derivation(self) -> Derivation:
        """The equations of motion."""
        return self.equations.derivation

    def check(self, known: Mapping[str, Expr]) -> None:
        """Refuse functions that are no integrals; `known` has them as they were given."""
        for name, polynomial in self.known.items():
            if rate := self.equations.level.remainder(self.derivation(polynomial)):
                raise ParameterError(
                    f"known: wanted integrals; got {name} = {shown(known[name])}, whose derivative "
                    f"{shown(self.equations.expression(rate))} is not zero"
                )

    @cached_property
    def level(self) -> Level:
        """The level set."""
        return level_of(self.derivation, self.zeros)

    @cached_property
    def gradings(self) -> tuple[Grading, ...]:
        """The gradings in which the equations of the level are homogeneous."""
        return tuple(g for g in gradings(self.derivation) if _are_homogeneous(g, self.zeros))

    def gradings_of_known(self, found: Sequence[Grading], weights: tuple[int, ...]) -> tuple[Grading, ...]:
        """Those gradings in which the known integrals are homogeneous, and that of the weights of a search, if any.

        In others the parts of an integral are integrals, too, but need not be polynomials in the known ones.
        """
        kept = tuple(g for g in found if _are_homogeneous(g, self.known.values()))
        return (*kept, Grading(weights, 0)) if weights else kept

    def search(self, found: Sequence[Grading] | None = None) -> Search:
        """The search, by some gradings or by all."""
        remainders = {name: self.level.remainder(polynomial) for name, polynomial in self.known.items()}
        return Search(
            self.derivation,
            self.gradings if found is None else tuple(found),
            self.level,
            tuple(zero for zero in self.zeros if zero),
            [Generator(name, r, is_new=False) for name, r in remainders.items() if any(map(any, r))],
        )


def _are_homogeneous(grading: Grading, polynomials: Iterable[Polynomial]) -> bool:
    return all(len({grading.of(m) for m in polynomial}) <= 1 for polynomial in polynomials)


@dataclass(frozen=True)
class SizeAsked:
    """The total degree up to which is searched, or a weight."""

    degree: int | None  # the degree, or None
    weight: int | None  # the weight, or None

    @classmethod
    def of(cls, degree: int | None, weight: int | None) -> SizeAsked:
        """What a caller asks for; degree 2 if he says nothing."""
        if weight is None:
            return cls(2 if degree is None else as_count(degree, "degree", least=1), None)
        w = as_count(weight, "weight", least=1)
        if degree is not None:
            raise ParameterError(f"wanted a degree or a weight; got both, {degree} and {weight}; leave one out")
        return cls(None, w)

    @property
    def value(self) -> int:
        """The degree or the weight."""
        return (self.degree if self.weight is None else self.weight) or 0

    def n_up_to_degree(self, n: int, most: int) -> int:
        """How many monomials of n coordinates have at most the degree, without 1."""
        d = self.value
        if (size := n_monomials(n, d) - 1) > most:
            fits = next(k for k in count() if n_monomials(n, k + 1) > most)
            raise ParameterError(
                f"degree: wanted at most {fits}, with {n_monomials(n, fits):,} monomials in {n} coordinates; got {d}, "
                f"with {size:,}. Take degree={fits}, or search by weight where the equations are homogeneous"
            )
        return size

    def monomials(
        self, derivation: Derivation, found: Sequence[Grading], most: int, *, up_to: bool = False
    ) -> tuple[Iterator[Exponents], int, tuple[int, ...]]:
        """The monomials of the search, the number of those that are not constant, and the weights of the coordinates.

        Up to a weight, or of it alone; not more than `most`.
        """
        n, w = len(derivation.variables), self.weight
        if w is None:
            size = self.n_up_to_degree(n, most)
            return up_to_degree(n, self.value), size, ()
        grading = positive_grading(found)
        if grading is None:
            raise ParameterError(
                "weight: wanted equations that are homogeneous for positive weights of the coordinates; these are not; "
                "give a degree instead"
            )
        counts = n_of_weights(grading.weights, w) if w <= _LARGEST_WEIGHT else []
        size = sum(counts[1:]) if up_to else counts[w] if counts else 0
        if not counts or size > most:
            raise ParameterError(
                f"weight: wanted at most {most:,} monomials, of a weight up to {_LARGEST_WEIGHT:,}; got {w}"
                f"{f', with {size:,}' if counts else ''}; take a smaller weight"
            )
        every = range(0 if up_to else w, w + 1)
        return chain.from_iterable(of_weight(grading.weights, k) for k in every), size, grading.weights


def functions_by_name(known: object, what: str = "known") -> dict[str, Any]:
    """Functions of the state by name.

    Raises:
        ParameterError: they have no names, a name is no text, or one comes twice.
    """
    found = by_name(known, what, "functions", '{"K": "l3"}')
    for name in found:
        if not isinstance(name, str):
            raise not_a("names of functions", name, what, 'write {"K": "l3"}')
    return found


def known_functions(system: EquationsOfMotion) -> dict[str, Expr]:
    """H and the Casimirs; of a vector field nothing."""
    return {"H": system.hamiltonian} | casimirs_of(system) if isinstance(system, System) else {}


def casimirs_of(system: System) -> dict[str, Expr]:
    """The Casimirs by name."""
    return {f"C{k}": c for k, c in enumerate(system.bracket.casimirs(), start=1)}


def with_hamiltonian(system: System, energy: Expr, bracket: Bracket | None = None) -> System:
    """The system with another Hamiltonian, and perhaps another bracket; without quadratures."""
    symbols = symbols_in(energy, system.component_names)
    return System(bracket or system.bracket, energy, name=system.name, symbols=symbols)


def at_values(system: System, values: Mapping[Any, Fraction]) -> System:
    """The system with rational values for some of its symbols."""
    own = {str(s): value for s, value in values.items() if str(s) in system.bracket.symbols}
    energy = cast("Any", system.hamiltonian).xreplace({s: to_sympy(value) for s, value in values.items()})
    return with_hamiltonian(system, energy, system.bracket.substitute(own))


def where(functions: Sequence[Expr]) -> str:
    """The equations f = 0 in a row."""
    return ", ".join(f"{Formula(f).plain} = 0" for f in functions)


def equations_of(system: EquationsOfMotion, on: Equations) -> tuple[str | Expr, ...]:
    """Equations as a caller gives them: one, several, or values by name, of which "C1 = 1" is made."""
    if isinstance(on, str) or is_sympy(on):
        return (cast("str | Expr", on),)
    if (values := named(on, "on")) is None:
        if (items := listed(on, "on")) is None:
            name = next(reversed(known_functions(system)), system.component_names[0])
            raise not_a("a sequence of equations", on, "on", f'write on="{name} = 0" or on={{"{name}": 0}}')
        return tuple(items)
    exact = {name: read_parameter(value, f"on: {name}") for name, value in values.items()}
    return tuple(
        f"{name} = {value}" if isinstance(name, str) else name - to_sympy(value) for name, value in exact.items()
    )


def zeros_on_level(system: EquationsOfMotion, on: Equations) -> list[Expr]:
    """The functions that vanish where some equations hold: f for "f = 0" and for f alone, H and C1 by name."""
    zeros: list[Expr] = []
    for equation in equations_of(system, on):
        if isinstance(equation, str):
            left, sign, right = equation.partition("=")
            zero: Any = system.function_of_invariants(left)
            zero = zero - system.function_of_invariants(right) if sign else zero
        else:
            zero = system.expression(equation)
        if zero.expand() == 0:
            raise ParameterError(
                f"on: wanted equations of a level set; {shown(equation)} holds everywhere; leave it out"
            )
        real_points(zero, system.variables)
        zeros.append(squarefree(zero, system.variables))
    return zeros
