r"""A system that depends on parameters, near the values 0 of these.

The parameters p count as further coordinates that do not move: a polynomial in p whose coefficients are polynomials in
x is a polynomial in (x, p), and the equations of motion are one derivation D of these.  Its part of order 0 in p is the
derivation of the system at p = 0.

A **grading** of D gives weights to the coordinates and to the parameters.  With them the equations for a correction
fall into blocks.  Where the weights of all coordinates are positive, a function of one weight has finitely many
corrections, so that nothing has to be said about their degree: other parts of a correction correct nothing.

**The Hamiltonian.**  In first order H may be changed, too: $\{F_1, H_0\}_0 + \{F_0, H_0\}_1 + \{F_0, H_1\}_0 = 0$.
Let bracket and Hamiltonian be homogeneous for weights with which every coordinate has at least the weight $\sigma$ that
$H_1$ should have, the weight of H minus that of the parameter.  Every other part of $H_1$ is heavier.  The part of the
equation of lowest weight therefore has the lightest part of $F_0$, and of $H_1$ the part of weight $\sigma$ alone.  If
no $F_0$ but the polynomials in $H_0$ and in Casimirs of the deformed bracket solves it, then the lightest part of any
solution $F_0$ is such a polynomial.  With its own correction, in which $H_0 + \epsilon H_1$ stands for $H_0$, it is
subtracted, and the next part is the lightest.  So a search with the finitely many monomials of weight $\sigma$ decides
for all polynomials $H_1$; if there are none, for all $H_1$ by a search without any.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import product
from math import gcd, lcm
from typing import Any, cast

from sympy import Expr, Poly, Symbol

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.echelon import Echelon
from liepoisson.algebra.linear_algebra import nullspace
from liepoisson.algebra.sparse_polynomials import Polynomial
from liepoisson.errors import ParameterError
from liepoisson.inputs.deadline import checkpoint
from liepoisson.inputs.given import texts
from liepoisson.inputs.refusals import shown
from liepoisson.integrability.derivation import (
    Derivation,
    Exponents,
    Grading,
    derivation_of_rates,
    gradings,
    n_monomials,
    n_of_weights,
    of_weight,
    polynomial_terms,
    positive_grading,
    undecided,
    up_to_degree,
)
from liepoisson.integrability.search import Label, next_name, products
from liepoisson.integrability.search_problem import at_values, casimirs_of, functions_by_name
from liepoisson.model.system import System

MOST_MONOMIALS = 20_000
"""Monomials of the corrections of one block; 10 000 of a top without gradings take a minute."""
_LARGEST_WEIGHT = 10_000


@dataclass(frozen=True)
class Start:
    """A function at p = 0: a product of known integrals.

    Attributes:
        name: The product in the names of its factors.
        polynomial: It, in the coordinates and the parameters.
        weight: Its weight, or its degree.
    """

    name: Expr
    polynomial: Polynomial
    weight: int


@dataclass(frozen=True)
class Starts:
    """The products of known integrals with the same weights in all gradings; linearly independent.

    Attributes:
        label: The weights.
        others: Those that are no polynomials in the Hamiltonian and the limits of Casimirs.
        trivial: Those that are.
    """

    label: Label
    others: tuple[Start, ...]
    trivial: tuple[Start, ...]

    @property
    def everything(self) -> tuple[Start, ...]:
        """All of them, the trivial ones first: what has corrections may have these added."""
        return (*self.trivial, *self.others)


@dataclass(frozen=True)
class Family:
    """A system near the values 0 of some of its parameters.

    Attributes:
        system: The system.
        start: The system at these values.
        parameters: The parameters.
        derivation: The equations of motion, with the parameters as further coordinates.
        known: Integrals of the system at 0 by name: H, Casimirs and others.
        trivial: Of these H, and further names for the limits of Casimirs.
        by_degree: Whether sizes are total degrees, because they are asked for or there are no positive weights.
        largest_degree: The largest degree of corrections, where sizes are degrees.
    """

    system: System
    start: System
    parameters: tuple[Symbol, ...]
    derivation: Derivation
    known: dict[str, Polynomial]
    trivial: dict[str, Polynomial]
    by_degree: bool
    largest_degree: int = 0

    @property
    def n(self) -> int:
        """The number of coordinates."""
        return len(self.system.variables)

    @cached_property
    def gradings(self) -> tuple[Grading, ...]:
        """The gradings in which all parameters have one weight and all known integrals are homogeneous."""
        functions = [*self.known.values(), *self.trivial.values()]
        found = gradings(self._on_a_line)
        return tuple(
            Grading((*g.weights, *(g.weights[-1],) * (len(self.parameters) - 1)), g.shift, g.modulus)
            for g in found
            if all(len({g.of(m[: self.n + 1]) for m in f}) <= 1 for f in functions)
        )

    @cached_property
    def _on_a_line(self) -> Derivation:
        """The same with one parameter in the place of all, for the weights; coefficients do not count."""
        n = self.n
        components = tuple(
            {(*m[:n], sum(m[n:])): self.derivation.field.one for m in part} for part in self.derivation.components[:n]
        )
        return Derivation(self.derivation.variables[: n + 1], (*components, {}), self.derivation.field)

    @cached_property
    def positive(self) -> Grading | None:
        """A grading with positive weights of the coordinates; None if there is none, or sizes are degrees."""
        return None if self.by_degree else positive_grading(self.gradings, self.n)

    def check(self, most: int, order: int) -> None:
        """Refuse a weight where there are none, and a search that is too large, before anything is written out.

        Args:
            most: The largest weight, or degree, of the starts.
            order: The highest order of corrections.

        Raises:
            ParameterError: there are no positive weights, or too many monomials.
        """
        if self.positive is None and not self.by_degree:
            raise ParameterError(
                "weight: wanted equations that are homogeneous for positive weights of the coordinates, with known "
                "integrals that are; these are not; give a degree instead"
            )
        if (size := self._size(most, order)) > MOST_MONOMIALS:
            what, fits, too_many = ("degree" if self.positive is None else "weight"), 1, most
            while too_many - fits > 1:
                middle = (fits + too_many) // 2
                checkpoint("the size of a search")
                if self._size(middle, order) > MOST_MONOMIALS:
                    too_many = middle
                else:
                    fits = middle
            raise ParameterError(
                f"{what}: wanted corrections of at most {MOST_MONOMIALS:,} monomials; got {most}, with {size:,} up to "
                f"order {order}. Take {what}={fits}, or a lower order"
            )

    def _size(self, most: int, order: int) -> int:
        """How many monomials the corrections up to an order have, before they are told apart by other weights."""
        orders = range(1, order + 1)
        if self.positive is None:
            return n_monomials(self.n, most) * order
        lefts = [most - k * self.weight_of_parameter for k in orders]
        if max(lefts) > _LARGEST_WEIGHT:
            return MOST_MONOMIALS + max(lefts)
        counts = n_of_weights(self.positive.weights[: self.n], max(*lefts, 0))
        return sum(counts[left] for left in lefts if left > 0)

    @cached_property
    def _bounding(self) -> Grading | None:
        """A grading with positive weights of the coordinates and of the parameters; None if there is none."""
        return positive_grading(self.gradings, self.n + 1)

    def last_order(self, starts: Starts) -> int | None:
        """The order above which no correction has a term, by positive weights; None if there are no such weights."""
        if self._bounding is None:
            return None
        one = starts.everything[0].polynomial
        return (self._bounding.of(next(iter(one))) - 1) // self._bounding.weights[-1]

    @property
    def weight_of_parameter(self) -> int:
        """The weight of the parameters in `positive`, 0 without it."""
        return self.positive.weights[-1] if self.positive else 0

    def label(self, polynomial: Polynomial) -> Label:
        """The weights of a homogeneous polynomial."""
        return tuple(g.of(next(iter(polynomial))) for g in self.gradings)

    def weight(self, polynomial: Mapping[Exponents, Any]) -> int:
        """The weight of a polynomial at p = 0, or its degree."""
        weights = self.positive.weights[: self.n] if self.positive else (1,) * self.n
        return max(sum(w * k for w, k in zip(weights, m[: self.n], strict=True)) for m in polynomial)

    def of_order(self, polynomial: Polynomial, order: int) -> Polynomial:
        """The part of one order in the parameters."""
        return {m: c for m, c in polynomial.items() if sum(m[self.n :]) == order}

    def corrections(self, label: Label, weight: int, order: int) -> Iterator[Exponents]:
        """The monomials in x, none of them 1, whose products with order parameters have the weights of a label.

        All of them, whatever their degree, where there are positive weights.
        """
        if self.positive is None:
            found = up_to_degree(self.n, self.largest_degree)
        else:
            left = weight - order * self.weight_of_parameter
            found = of_weight(self.positive.weights[: self.n], left) if left > 0 else iter(())
        power = (order, *(0,) * (len(self.parameters) - 1))
        return (m for m in found if any(m) and tuple(g.of((*m, *power)) for g in self.gradings) == label)

    def starts(self, most: int) -> list[Starts]:
        """The products of known integrals up to a weight, or a degree, by their weights."""
        n_trivial = len(self.trivial)
        named = [*self.trivial.items(), *self.known.items()]
        parts = [(self.weight(f), {m: c for m, c in f.items() if any(m)}) for _, f in named]
        by_label: dict[Label, list[tuple[tuple[int, ...], Polynomial]]] = {}
        for chosen, _, polynomial in products(parts, most):
            by_label.setdefault(self.label(polynomial), []).append((chosen, polynomial))
        found: list[Starts] = []
        for label, given in sorted(by_label.items()):
            span = Echelon(self.derivation.field)
            given.sort(key=lambda item: (max(item[0]) >= n_trivial, len(item[0]), item[0]))
            kept = [(chosen, f) for chosen, f in given if span.insert(f)]
            both: tuple[list[Start], list[Start]] = ([], [])
            for chosen, polynomial in kept:
                name = cast("Expr", _product([Symbol(named[k][0]) for k in chosen]))
                both[max(chosen) < n_trivial].append(Start(name, polynomial, self.weight(polynomial)))
            found.append(Starts(label, tuple(both[0]), tuple(both[1])))
        return found

    def with_trivial(self, polynomial: Polynomial) -> Family:
        """The family with an integral at 0 that survives always: polynomials in it do so, too."""
        name = next((name for name, f in self.known.items() if _are_proportional(f, polynomial)), None)
        rest = {other: f for other, f in self.known.items() if other != name}
        name = name or next_name(self.trivial, self.known, {*map(str, self.derivation.variables)})
        return replace(self, known=rest, trivial={**self.trivial, name: polynomial})

    @cached_property
    def hamiltonian_terms(self) -> tuple[tuple[Exponents, ...], tuple[int, ...]] | None:
        r"""The monomials of $H_1$ that decide for all polynomials $H_1$, and the weights of the proof; None without."""
        found = self._weights_of_both()
        if found is None:
            return None
        weights, most = found
        monomials = of_weight(weights[: self.n], most) if most > 0 else iter(())
        return tuple(m for m in monomials if any(m)), weights

    def _weights_of_both(self) -> tuple[tuple[int, ...], int] | None:
        r"""Weights for which bracket and H are homogeneous, and every coordinate is at least as heavy as $H_1$."""
        n, bracket = self.n, self.system.bracket
        # unknown: the weights of the coordinates and of the parameter, what the bracket adds, the weight of H
        rows: list[dict[int, Fraction]] = []
        for i, j, m, c in bracket.entries():
            rows += [_row([(m, 1), (i, -1), (j, -1), (n + 1, -1), (n, k)]) for k in self._orders(c)]
        for (i, j), c in bracket.constant.items():
            rows += [_row([(i, -1), (j, -1), (n + 1, -1), (n, k)]) for k in self._orders(c)]
        energy = polynomial_terms(self.system.hamiltonian, (*self.system.variables, *self.parameters), "the energy")
        rows += [_row([*enumerate(m[:n]), (n, sum(m[n:])), (n + 2, -1)]) for m in energy if any(m)]
        basis: list[list[int]] = []
        for vector in nullspace(rows, n + 3, Coefficients()).vectors:
            scale = lcm(*(c.denominator for c in vector.values()))
            basis.append([int(vector.get(k, 0) * scale) for k in range(n + 3)])
        functions = [*self.known.values(), *self.trivial.values()]
        bound = 6 if len(basis) <= 2 else 2
        found: list[tuple[int, ...]] = []
        for factors in product(range(-bound, bound + 1), repeat=len(basis)) if len(basis) <= 4 else ():
            w = [sum(f * v[k] for f, v in zip(factors, basis, strict=True)) for k in range(n + 3)]
            grading = Grading(tuple(w[: n + 1]), 0)
            if min(w[:n], default=0) <= 0 or min(w[:n]) < w[n + 2] - w[n]:
                continue
            if all(len({grading.of(m[: n + 1]) for m in f if any(m)}) <= 1 for f in functions):
                found.append(tuple(x // gcd(*w) for x in w))
        best = min(found, key=lambda w: (max(w[n + 2] - w[n], 0) == min(w[:n]), sum(map(abs, w))), default=None)
        return None if best is None else (best[: n + 1], best[n + 2] - best[n])

    def _orders(self, coefficient: Any) -> set[int]:
        """The orders in the parameters of a coefficient of the bracket."""
        if isinstance(coefficient, Fraction):
            return {0}
        return {sum(m) for m in polynomial_terms(coefficient.expand(), self.parameters, "the bracket")}


def _row(entries: Sequence[tuple[int, int]]) -> dict[int, Fraction]:
    row: dict[int, Fraction] = {}
    for k, value in entries:
        row[k] = row.get(k, Fraction(0)) + value
    return {k: value for k, value in row.items() if value}


def _product(factors: Sequence[Any]) -> Any:
    total = factors[0]
    for factor in factors[1:]:
        total = total * factor
    return total


def family_of(
    system: System, parameter: str | Sequence[str], integrals: Mapping[str, str | Expr] | None, *, by_degree: bool
) -> Family:
    """Read a system, the parameters, and integrals at their values 0.

    Raises:
        ParameterError: a parameter is none of the system, the equations are no polynomials, or a function is no
            integral at 0.
    """
    symbols = parameters_of(system, parameter)
    start = at_values(system, dict.fromkeys(symbols, Fraction(0)))
    given: dict[str, Expr] = {"H": start.hamiltonian, **casimirs_of(start)}
    zero = dict.fromkeys(symbols, 0)
    if integrals is None:
        own = {name: cast("Any", f).xreplace(zero) for name, f in system.integrals.items()}
        constant = {name: f for name, f in own.items() if start.is_constant(f)}
        given |= {name: f for name, f in {**start.invariants, **constant}.items() if name not in given}
    else:
        taken = {*given, *map(str, system.variables), *system.bracket.symbols, *map(str, symbols)}
        for name, f in functions_by_name(integrals, "integrals").items():
            function: Any = system.expression(f)
            if name in taken and name != str(function):
                raise ParameterError(
                    f"integrals: wanted names that nothing else has; got {name!r:.60} for {shown(function)}. Call the "
                    "function by another name"
                )
            given[name] = function.xreplace(zero)
    limits = {f"C{k}": limit for k, c in enumerate(system.bracket.casimirs(), start=1) if (limit := _limit(c, symbols))}
    everything = (*given.values(), *limits.values())
    functions: list[Any] = [f.expand(trace=True) for f in cast("Any", everything)]
    variables, rates = (*system.variables, *symbols), list(system.equations.values())
    derivation, read_functions = derivation_of_rates(variables, [*rates, *[0 * s for s in symbols]], functions)
    if not derivation.field.decides:
        raise ParameterError(undecided(derivation.field))
    known = dict(zip(given, read_functions, strict=False))
    trivial = {"H": known.pop("H")} | dict(zip(limits, read_functions[len(given) :], strict=True))
    trivial = {name: f for name, f in trivial.items() if any(map(any, f))}
    known = {
        f"{name}_0" if name in trivial else name: {m: c for m, c in f.items() if any(m)}
        for name, f in known.items()
        if any(map(any, f)) and not any(_are_proportional(f, g) for g in trivial.values())
    }
    if not known:
        raise ParameterError(
            f"integrals: wanted integrals of {system.name} at {', '.join(map(str, symbols))} = 0 besides "
            f"{', '.join(trivial)}, which always survive; none is known. Give some by name, such as those that "
            'first_integrals finds there: integrals={"K": "..."}'
        )
    family = Family(system, start, symbols, derivation, known, trivial, by_degree)
    for name, f in known.items():
        if rate := family.of_order(derivation(f), 0):
            raise ParameterError(
                f"integrals: wanted integrals of {system.name} at {', '.join(map(str, symbols))} = 0; got {name} = "
                f"{shown(derivation.expression(f))}, whose derivative {shown(derivation.expression(rate))} is not zero"
            )
    return family


def _are_proportional(first: Polynomial, second: Polynomial) -> bool:
    """Whether two polynomials that are not 0 are multiples of each other."""
    lead = next(iter(first))
    return first.keys() == second.keys() and not any(
        c * second[lead] - second[m] * first[lead] for m, c in first.items()
    )


def parameters_of(system: System, parameter: str | Sequence[str]) -> tuple[Symbol, ...]:
    """The symbols of the parameters."""
    names = (parameter,) if isinstance(parameter, str) else texts(parameter, "parameter", "names", '["a", "b"]')
    energy: Any = system.hamiltonian
    own = sorted(({str(s) for s in energy.free_symbols} | system.bracket.symbols) - {*map(str, system.variables)})
    for name in names:
        if name not in own:
            raise ParameterError(
                f"parameter: wanted a symbol of {system.name}, {' or '.join(own) or 'which has none'}; got {name!r}. "
                'Leave it without a value, lp.leibniz(3, "epsilon"), or declare it, symbols=["k"]'
            )
    if len({*names}) < len(names) or not names:
        raise ParameterError(f"parameter: wanted different names, at least one; got {', '.join(names) or 'none'}")
    return tuple(Symbol(name) for name in names)


def _limit(casimir: Any, parameters: Sequence[Symbol]) -> Expr | None:
    """The limit at 0 of a Casimir times a power of the parameters; None if it depends on how they tend to 0."""
    top = casimir.expand(trace=True).together().as_numer_denom()[0]
    terms = cast("Any", Poly(top, *parameters)).terms()
    least = min(sum(m) for m, _ in terms)
    lowest = [(m, c) for m, c in terms if sum(m) == least]
    return lowest[0][1].expand() if len(lowest) == 1 and (not least or len(parameters) == 1) else None
