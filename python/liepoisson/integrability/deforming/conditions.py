r"""Corrections of an integral in several parameters, order by order: the conditions that the parameters must satisfy.

The part $F_k$ of order k of $F = F_0 + F_1 + \dots$ is a polynomial in x whose coefficients are homogeneous polynomials
of degree k in the parameters.  With $R_k = \sum_{j\ge1} D_j F_{k-j}$ it solves $D_0 F_k = -R_k$.  In each order $D_0$
is one matrix over $\mathbb Q$.  Elimination, which does not look at the parameters, writes each polynomial in x as
$D_0$ of another one and a normal form.  The normal form of $R_k$ must vanish: its coefficients are polynomials in the
parameters, and these are the conditions of order k.  $F_k$ is determined up to integrals at 0.  Of these the
polynomials in $H_0$ and in limits of Casimirs have corrections of all orders and need not be looked at, unless degrees
are limited; each of the others gets an unknown coefficient, which counts like a parameter.

If the coordinates have positive weights and the parameters, too, then $F_k = 0$ from some k on: after finitely many
orders all conditions are known, and F is an integral for all parameters that satisfy them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from flint import fmpq

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.echelon import Echelon
from liepoisson.algebra.ideals.components import Assumptions, Component, components
from liepoisson.algebra.ideals.groebner import rational_context
from liepoisson.algebra.ideals.limits import Limits
from liepoisson.algebra.number_fields import as_fmpq
from liepoisson.algebra.sparse_polynomials import Polynomial, of_exponents
from liepoisson.errors import ParameterError
from liepoisson.inputs.deadline import checkpoint
from liepoisson.inputs.names import free_name
from liepoisson.integrability.deforming.family import Family, Starts
from liepoisson.integrability.derivation import Exponents

_MOST_COLUMNS = 2500
"""Monomials of one order; the elimination over the rationals of 2000 takes a minute."""

Parametric = dict[Exponents, Any]
"""A polynomial in the coordinates whose coefficients are FLINT's polynomials in the parameters."""

OnParameters = dict[Exponents, Any]
"""A polynomial in the parameters: rational coefficients by exponents."""


class Reduction:
    """The derivation at 0 on the monomials of one order: normal forms modulo its image, preimages, null space."""

    def __init__(self, family: Family, monomials: Sequence[Exponents]) -> None:
        if len(monomials) > _MOST_COLUMNS:
            raise ParameterError(
                f"parameter: wanted at most {_MOST_COLUMNS:,} monomials in each order for several parameters; got "
                f"{len(monomials):,}. Take a smaller weight or degree, or one parameter"
            )
        self.monomials = list(monomials)
        zero, echelon = (0,) * len(family.parameters), Echelon(Coefficients())
        columns: list[dict[Any, Any]] = []
        for k, m in enumerate(monomials):
            image = family.of_order(family.derivation({(*m, *zero): family.derivation.field.one}), 0)
            columns.append({(0, key[: family.n]): c for key, c in image.items()} | {(1, (k,)): Coefficients().one})
        for column in sorted(columns, key=len):
            echelon.insert(column)
        rows = {min(row): row for row in echelon.basis()}
        self.null = [{self.monomials[key[1][0]]: c for key, c in row.items()} for lead, row in rows.items() if lead[0]]
        self.rows = {
            lead[1]: (
                {key[1]: as_fmpq(c) for key, c in row.items() if not key[0] and key != lead},
                {self.monomials[key[1][0]]: as_fmpq(c) for key, c in row.items() if key[0]},
            )
            for lead, row in rows.items()
            if not lead[0]
        }

    def of(self, polynomial: Parametric) -> tuple[Parametric, Parametric]:
        """The normal form of a polynomial, and what the derivation maps to the difference of both."""
        rest, preimage = dict(polynomial), Parametric()
        for m in [m for m in polynomial if m in self.rows]:
            factor = rest.pop(m)
            others, sources = self.rows[m]
            _subtract(rest, others, factor)
            _subtract(preimage, sources, -factor)
        return {m: c for m, c in rest.items() if c}, {m: c for m, c in preimage.items() if c}


def _subtract(total: Parametric, row: dict[Exponents, fmpq], factor: Any) -> None:
    for m, c in row.items():
        total[m] = total[m] - factor * c if m in total else -(factor * c)


@dataclass(frozen=True)
class Conditions:
    """What the parameters satisfy if a start has corrections.

    Attributes:
        names: The parameters, and further unknown coefficients: of the starts, and of integrals at 0 in these and in
            corrections.
        by_order: The conditions of each order, from 1.
        function: F, a polynomial in the coordinates and the names.
    """

    names: tuple[str, ...]
    by_order: tuple[tuple[Any, ...], ...]
    function: Parametric


class ParametricEquations:
    """The equations of one block, for several parameters."""

    def __init__(self, family: Family, starts: Starts, highest: int) -> None:
        if not family.derivation.field.is_rational:
            raise ParameterError(
                "parameter: wanted rational coefficients beside several parameters; got "
                f"{', '.join(map(str, family.derivation.field.parameters)) or 'roots'}. Give values, or add the symbols"
            )
        self.family, self.starts = family, starts
        weight = max(s.weight for s in starts.everything)
        last = family.last_order(starts)
        self.is_cut = last is None or last > highest
        self.reductions = [
            Reduction(family, list(family.corrections(starts.label, weight, order)))
            for order in range(1, (highest if last is None else min(last, highest)) + 1)
        ]
        self.new = [self._new_integrals(k, reduction) for k, reduction in enumerate(self.reductions, start=1)]
        coefficients = [f"c{k}" for k in range(1, len(starts.others) + 1)] if len(starts.others) > 1 else []
        self.added = [one.polynomial for one in starts.trivial] if family.by_degree else []
        numbers = [len(self.added), *map(len, self.new)]
        further = [f"n{k}_{j}" for k, n in enumerate(numbers) for j in range(1, n + 1)]
        taken = {*map(str, family.derivation.variables)}
        self.coefficients = [free_name(name, taken) for name in coefficients]
        self.further = [free_name(name, taken) for name in further]
        self.names = (*map(str, family.parameters), *self.coefficients, *self.further)
        self.context = rational_context(self.names)
        self.generators = dict(zip(self.names, self.context.gens(), strict=True))
        self.rates = [self._parametric_rate(k) for k in range(family.n)]
        self.highest_rate = max((k for rate in self.rates for k in rate), default=0)

    def _new_integrals(self, order: int, reduction: Reduction) -> list[Polynomial]:
        """The integrals at 0 among the corrections of an order that are not trivial; all where degrees are limited."""
        starts = self.starts
        if self.family.by_degree or not reduction.null:
            return reduction.null
        span = Echelon(Coefficients())
        weight = max(s.weight for s in starts.everything)
        if self.family.positive is not None:
            weight -= order * self.family.weight_of_parameter
        for group in self.family.starts(weight) if weight > 0 else []:
            for trivial in group.trivial:
                span.insert({m[: self.family.n]: c for m, c in trivial.polynomial.items()})
        return [vector for vector in reduction.null if span.insert(vector)]

    def _parametric_rate(self, k: int) -> dict[int, Parametric]:
        """The rate of a coordinate, by orders."""
        n, found = self.family.n, dict[int, Parametric]()
        for m, c in self.family.derivation.components[k].items():
            coefficient = self.context.from_dict({(*m[n:], *(0,) * (len(self.names) - len(m[n:]))): as_fmpq(c)})
            part = found.setdefault(sum(m[n:]), {})
            part[m[:n]] = part[m[:n]] + coefficient if m[:n] in part else coefficient
        return found

    def _derivative(self, polynomial: Parametric, order: int) -> Parametric:
        """The part of one order of the derivation on a polynomial."""
        total: Parametric = {}
        for m, c in polynomial.items():
            checkpoint("corrections in several parameters")
            for k, power in enumerate(m):
                if not power or order not in self.rates[k]:
                    continue
                lowered = (*m[:k], power - 1, *m[k + 1 :])
                for factor, rate in self.rates[k][order].items():
                    key, value = of_exponents(lowered, factor), c * rate * power
                    total[key] = total[key] + value if key in total else value
        return {m: c for m, c in total.items() if c}

    def solve(self) -> Conditions:
        """The conditions of all orders that there are corrections for, and those after them."""
        start: Parametric = {}
        names = iter(self.further)
        own = self.coefficients or [None]
        given = [(one.polynomial, name) for one, name in zip(self.starts.others, own, strict=True)]
        for polynomial, name in [*given, *((one, next(names)) for one in self.added)]:
            factor = self.context.constant(1) if name is None else self.generators[name]
            _subtract(start, {m[: self.family.n]: as_fmpq(c) for m, c in polynomial.items()}, -factor)
        parts, by_order = [start], list[tuple[Any, ...]]()
        last = len(self.reductions) + (0 if self.is_cut else self.highest_rate)
        for order in range(1, last + 1):
            total: Parametric = {}
            for j in range(1, min(order, self.highest_rate) + 1):
                for m, c in self._derivative(parts[order - j], j).items():
                    total[m] = total[m] + c if m in total else c
            total = {m: c for m, c in total.items() if c}
            correction: Parametric = {}
            if order <= len(self.reductions):
                total, preimage = self.reductions[order - 1].of(total)
                correction = {m: -c for m, c in preimage.items()}
                for vector in self.new[order - 1]:
                    _subtract(correction, {m: as_fmpq(c) for m, c in vector.items()}, -self.generators[next(names)])
            parts.append({m: c for m, c in correction.items() if c})
            by_order.append(_different(total.values()))
        function: Parametric = {}
        for part in parts:
            for m, c in part.items():
                function[m] = function[m] + c if m in function else c
        return Conditions(self.names, tuple(by_order), {m: c for m, c in function.items() if c})

    def cases(self, conditions: Conditions) -> list[tuple[Component, Parametric]]:
        """The parameters that satisfy the conditions, as a union of parts, each with F; real ones where that is seen.

        Where the start has several coefficients, the first of them that is not 0 is 1.
        """
        budget = Limits().budget()
        equations = [p for order in conditions.by_order for p in order]
        c = [self.generators[name] for name in self.coefficients]
        charts = [[*c[:k], c[k] - 1] for k in range(len(c))] or [[]]
        found: list[tuple[Component, Parametric]] = []
        for chart in charts:
            given = [*equations, *chart] or [self.context.constant(0)]
            for part in components(given, Assumptions(is_real=True), budget):
                function = {m: part.basis.remainder(f) for m, f in conditions.function.items()}
                found.append((part, {m: f for m, f in function.items() if f}))
        return found

    def plain(self, part: Component, function: Parametric) -> tuple[list[Any], Parametric, int]:
        """The equations of a part and F without the coefficients of integrals that are determined or free.

        Those that an equation gives as polynomials in others are replaced, and 0 is put for the others, unless further
        equations bind them.

        Returns:
            Equations, the function, and how many dimensions of the part the free ones are.
        """
        first, generators = len(self.names) - len(self.further), list(self.context.gens())
        equations, determined = list(part.equations), 0
        while (found := next(((p, k, c) for p in equations for k, c in _determined(p, first)), None)) is not None:
            p, k, c = found
            images = [*generators[:k], generators[k] - p / c, *generators[k + 1 :]]
            equations = [q for one in equations if (q := one.compose(*images))]
            function = {m: q for m, one in function.items() if (q := one.compose(*images))}
            determined += 1
        if _have_unknowns(equations, first):
            return equations, function, 0
        images = [*generators[:first], *[self.context.constant(0)] * len(self.further)]
        function = {m: q for m, one in function.items() if (q := one.compose(*images))}
        return list(_different(equations)), function, len(self.further) - determined

    def contains(self, part: Component, conditions: Sequence[OnParameters]) -> bool:
        """Whether some conditions on the parameters hold in a part."""
        rest = (0,) * (len(self.names) - len(self.family.parameters))
        polynomials = [self.context.from_dict({(*m, *rest): c for m, c in one.items()}) for one in conditions]
        return not any(part.basis.remainder(p) for p in polynomials)

    def on_parameters(self, equations: Sequence[Any]) -> list[OnParameters] | None:
        """Equations as conditions on the parameters; None if they have other unknowns."""
        n = len(self.family.parameters)
        if _have_unknowns(equations, n):
            return None
        return [{tuple(map(int, m[:n])): c for m, c in p.terms()} for p in equations]

    def holds(self, function: Parametric, part: Component) -> bool:
        """Whether a function is an integral wherever the parameters are in a part: computed anew, to all orders."""
        total: Parametric = {}
        for order in range(self.highest_rate + 1):
            for m, c in self._derivative(function, order).items():
                total[m] = total[m] + c if m in total else c
        return not any(part.basis.remainder(c) for c in total.values())


def _have_unknowns(polynomials: Sequence[Any], first: int) -> bool:
    """Whether there is an unknown from some number on in polynomials."""
    return any(any(m[first:]) for p in polynomials for m in p.monoms())


def _determined(p: Any, first: int) -> list[tuple[int, Any]]:
    """The unknowns from some number on of which a polynomial is linear with a constant coefficient, and this."""
    terms = [(tuple(map(int, m)), c) for m, c in p.terms()]
    alone = [(m.index(1), c) for m, c in terms if sum(m) == 1 and m.index(1) >= first]
    return [(k, c) for k, c in alone if sum(m[k] > 0 for m, _ in terms) == 1]


def _different(polynomials: Any) -> tuple[Any, ...]:
    """Some polynomials up to factors, each once."""
    found = {str(q): q for p in polynomials if p for q in (p / p.leading_coefficient(),)}
    return tuple(sorted(found.values(), key=lambda q: (q.total_degree(), str(q))))
