"""What is reported about the leaves of a bracket and its symmetries."""

# ruff: noqa: D102 - lines() and record() are described once, in Topic

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, final

from liepoisson.algebra.exact_numbers import is_zero, to_sympy
from liepoisson.report.bracket_facts import CasimirFacts, Topic
from liepoisson.report.lines import (
    MOST_TERMS,
    Conditions,
    Line,
    Name,
    Statement,
    Written,
    definition_lines,
    joined,
    record_of_formula,
    shortened,
)

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.report.vector_notation import VectorNotation
    from liepoisson.structure.bracket import Bracket
    from liepoisson.structure.derivations import Derivation
    from liepoisson.structure.strata import Stratum

_MOST_COORDINATES = 16
"""Strata are looked for up to this size: each costs a search for Casimirs."""


@final
class RankFacts(Topic):
    """The generic rank of the Poisson tensor, between two bounds that follow from the search for Casimirs."""

    key, title = "rank", "Rank"

    def __init__(self, bracket: Bracket, casimirs: CasimirFacts) -> None:
        report, n = casimirs.report, bracket.dimension
        self.dimension = n
        self.lower = n - report.corank
        self.upper = min(n - report.independent, n - n % 2)

    @property
    def proved(self) -> bool:
        """Whether the bounds meet."""
        return self.lower == self.upper

    def lines(self) -> list[Line]:
        n, rank = self.dimension, self.lower
        if not self.proved:
            return [
                (f"at least {rank} (at one point), at most {self.upper} ({n} coordinates less the Casimirs found)",)
            ]
        return [(f"rank {rank}, corank {n - rank} at generic points: leaves of dimension {rank}",), (self.method,)]

    @property
    def method(self) -> str:
        """Where the bounds come from."""
        return f"proved: J has rank {self.lower} at one point; its antisymmetry and the Casimirs allow no more"

    def record(self) -> dict[str, Any]:
        return {
            "lower": self.lower,
            "upper": self.upper,
            "corank": self.dimension - self.lower if self.proved else None,
            "proved": self.proved,
        }


@final
class StrataFacts(Topic):
    """The leaves of lower dimension: where the rank drops, and what is constant there."""

    key, title = "strata", "Leaves"

    def __init__(self, bracket: Bracket, notation: VectorNotation, casimirs: CasimirFacts) -> None:
        from sympy import Add

        self.bracket = bracket
        # Only long ones are called by their names: the others say more as they are.
        self.named = {e: name for name, _, e in casimirs.formulas if len(Add.make_args(e)) > MOST_TERMS}
        self.strata = bracket.strata() if bracket.dimension <= _MOST_COORDINATES else None
        self.notation = notation
        formulas = [notation.formula(e) for stratum in self.strata or () for e in stratum.casimirs]
        self.definitions = [] if casimirs.definitions else notation.definitions(formulas)

    def lines(self) -> list[Line]:
        if self.strata is None:
            return [(f"not examined for more than {_MOST_COORDINATES} coordinates",)]
        found = [self._line(stratum) for stratum in self.strata] + definition_lines(self.definitions)
        if not all(stratum.proved for stratum in self.strata):
            found.append(("sets of lower rank that are not listed may exist",))
        if self.bracket.symbols:
            found.append(("parameters are generic here: " + ", ".join(sorted(self.bracket.symbols)),))
        return found

    def _line(self, stratum: Stratum) -> Line:
        named = replace(stratum.locus, is_generic=False)
        if stratum.locus.is_everywhere:
            line: Line = (f"dimension {stratum.rank} everywhere",)
        elif named.is_everywhere:
            line = (f"dimension {stratum.rank} at generic points",)
        else:
            adverb = "" if stratum.proved else "generically "
            where = Conditions(named, are_vectors=not self.bracket.has_scalar_fields)
            line = (f"dimension {stratum.rank} {adverb}where ", where)
        if stratum.casimirs and stratum.rank:
            line = (
                *line,
                ", constant on them: " if stratum.complete else ", constant on them (there are others): ",
                *joined(map(self._casimir, stratum.casimirs)),
            )
        return (*line, " (proved)") if stratum.proved else line

    def _casimir(self, casimir: Expr) -> Written:
        name = self.named.get(casimir)
        return Name(name) if name else shortened(self.notation.formula(casimir))

    def record(self) -> list[dict[str, Any]] | None:
        if self.strata is None:
            return None
        return [
            {
                "condition": stratum.condition,
                "rank": stratum.rank,
                "proved": stratum.proved,
                "certificate": stratum.certificate,
                "complete": stratum.complete,
                "casimirs": [record_of_formula(self.notation.formula(e), e) for e in stratum.casimirs],
            }
            for stratum in self.strata
        ]


@final
class SymmetryFacts(Topic):
    """Linear maps of the fields that keep the bracket, besides those of the group of g, and whether they keep H."""

    key, title = "symmetries", "Symmetries"

    def __init__(self, bracket: Bracket, hamiltonian: Expr) -> None:
        self.bracket = bracket
        self.derivations = [(found, _keeps(found, bracket, hamiltonian)) for found in bracket.derivations()]
        self.scalings = [found for found in bracket.scalings() if any(found.parameters.values())]

    def lines(self) -> list[Line]:
        lines: list[Line] = [
            (Statement.about(str(found), self.bracket), f": keeps the bracket{' and H' if keeps else ''}")
            for found, keeps in self.derivations
        ]
        lines += [(Statement.about(str(found), self.bracket),) for found in self.scalings]
        return lines or [("no one-parameter family that acts on the fields alone",)]

    def record(self) -> list[dict[str, Any]]:
        found = [
            {"text": str(d), "kind": d.kind, "matrix": [[str(v) for v in row] for row in d.matrix], "keeps_H": keeps}
            for d, keeps in self.derivations
        ]
        return found + [
            {"text": str(s), "kind": "scaling", "weights": list(s.weights), "parameters": dict(s.parameters)}
            for s in self.scalings
        ]


def _keeps(derivation: Derivation, bracket: Bracket, hamiltonian: Expr) -> bool:
    """Whether the derivative of H along the infinitesimal symmetry vanishes."""
    from sympy import S

    columns = [list(column) for column in bracket.fields.values()]
    total = S.Zero
    for row, column in zip(derivation.matrix, columns, strict=True):
        for i, x in enumerate(column):
            motion = sum((to_sympy(v) * other[i] for v, other in zip(row, columns, strict=True)), S.Zero)
            total += motion * hamiltonian.diff(x)
    return is_zero(total)
