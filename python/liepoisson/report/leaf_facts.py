"""What is reported about the Casimirs of a bracket, its leaves and its symmetries."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.exact_numbers import is_zero, to_sympy
from liepoisson.report.lines import (
    MOST_TERMS,
    Equation,
    Line,
    Name,
    Statement,
    Written,
    definition_lines,
    joined,
    record_of,
    record_of_formula,
    shortened,
)
from liepoisson.report.printing import Formula
from liepoisson.report.topics import Topic

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.report.vector_notation import VectorNotation
    from liepoisson.structure.bracket import Bracket
    from liepoisson.structure.casimirs import CasimirReport
    from liepoisson.structure.derivations import Derivation
    from liepoisson.structure.locus import Stratum

_MOST_COORDINATES = 16
"""Strata are looked for up to this size: each costs a search for Casimirs."""


@dataclass(frozen=True)
class Casimirs:
    """Generators of the Casimirs, verified, and whether they are all."""

    bracket: Bracket
    notation: VectorNotation

    @cached_property
    def report(self) -> CasimirReport:
        """What was found."""
        return self.bracket.casimir_report()

    @cached_property
    def formulas(self) -> list[tuple[str, Formula, Expr]]:
        """Name, formula and expression of each generator."""
        found = enumerate(self.report.generators, start=1)
        return [(f"C{k}", self.notation.formula(expression), expression) for k, expression in found]

    @cached_property
    def definitions(self) -> list[Equation]:
        """What the scalar products in the formulas are where they are not the usual ones."""
        special = [self.notation.formula(e) for case in self.report.exceptional for e in case.generators]
        return self.notation.definitions([*(formula for _, formula, _ in self.formulas), *special])

    def topic(self) -> Topic:
        """The Casimirs in a report."""
        report = self.report
        lines: list[Line] = [(Equation(Name(name), formula),) for name, formula, _ in self.formulas]
        lines += definition_lines(self.definitions)
        lines += [(f"with {meaning}",) for meaning in self._meanings]
        if self.formulas:
            verified = "proved: J grad C = 0 for each" if report.verified else "NOT verified: J grad C is not zero"
            lines.append((f"{verified} ({report.method})",))
        lines.append((self._completeness(),))
        for case in report.exceptional:
            at = Statement.about(case.condition, self.bracket)
            formulas = joined(shortened(self.notation.formula(generator)) for generator in case.generators)
            lines.append(("there are others for ", at, ": ", *formulas))
            if case.jumps:
                lines.append((*joined(map(Name, case.jumps)), " jump at ", at, ": other functions than near by"))
        if report.examined and not report.exceptional:
            looked_at = joined(Statement.about(condition, self.bracket) for condition in report.examined)
            lines.append(("no more for special values either; examined: ", *looked_at))
        if report.undecided:
            lines.append((f"not decided: {'; '.join(report.undecided)}",))
        return Topic("casimirs", lines, self._record)

    @property
    def _meanings(self) -> list[str]:
        """What the fields are as matrices, where traces occur: one sentence, or one for each summand of the algebra."""
        field, meanings = self.bracket.field_names[0], self.report.meanings
        numbers = [f" in tr{k}" if len(meanings) > 1 else "" for k in range(1, len(meanings) + 1)]
        others = " (the other fields likewise)" if len(self.bracket.field_names) > 1 else ""
        return [meaning.format(x=field) + n + others for meaning, n in zip(meanings, numbers, strict=True)]

    def _completeness(self) -> str:
        report = self.report
        if report.complete and not report.independent:
            return "none: J has full rank at generic points"
        if report.complete:
            return f"complete: {report.independent} independent, as many as the corank of J allows"
        return f"perhaps not all: {report.independent} independent, of at most {report.corank}; {report.limits}"

    def _record(self) -> dict[str, Any]:
        report = self.report
        return {
            "generators": [{"name": n, **record_of_formula(f, e)} for n, f, e in self.formulas],
            "definitions": [record_of(definition) for definition in self.definitions],
            "matrices": self._meanings,
            "verified": report.verified,
            "complete": report.complete,
            "independent": report.independent,
            "corank": report.corank,
            "method": report.method,
            "limits": report.limits or None,
            "exceptional": [
                {
                    "condition": case.condition,
                    "generators": [record_of_formula(self.notation.formula(e), e) for e in case.generators],
                    "jumps": list(case.jumps),
                }
                for case in report.exceptional
            ],
            "examined": list(report.examined),
            "undecided": list(report.undecided),
        }


def rank_topic(casimirs: Casimirs) -> Topic:
    """The generic rank of the Poisson tensor, between two bounds that follow from the search for Casimirs."""
    report, n = casimirs.report, casimirs.bracket.dimension
    rank, upper = n - report.corank, min(n - report.independent, n - n % 2)
    proved = rank == upper
    lines: list[Line] = [
        (f"rank {rank}, corank {n - rank} at generic points: leaves of dimension {rank}",),
        (f"proved: J has rank {rank} at one point; its antisymmetry and the Casimirs allow no more",),
    ]
    if not proved:
        lines = [(f"at least {rank} (at one point), at most {upper} ({n} coordinates less the Casimirs found)",)]
    corank = n - rank if proved else None
    return Topic("rank", lines, lambda: {"lower": rank, "upper": upper, "corank": corank, "proved": proved})


def strata_topic(casimirs: Casimirs) -> Topic:
    """The leaves of lower dimension: where the rank drops, and what is constant there."""
    from sympy import Add

    bracket, notation = casimirs.bracket, casimirs.notation
    if bracket.dimension > _MOST_COORDINATES:
        return Topic("strata", [(f"not examined for more than {_MOST_COORDINATES} coordinates",)], lambda: None)
    # Only long ones are called by their names: the others say more as they are.
    named = {e: name for name, _, e in casimirs.formulas if len(Add.make_args(e)) > MOST_TERMS}
    strata = bracket.strata()

    def casimir(expression: Expr) -> Written:
        name = named.get(expression)
        return Name(name) if name else shortened(notation.formula(expression))

    def line_of(stratum: Stratum) -> Line:
        line = _place_of(stratum, bracket)
        if stratum.casimirs and stratum.rank:
            more = "" if stratum.complete else " (there are others)"
            line = (*line, f", constant on them{more}: ", *joined(map(casimir, stratum.casimirs)))
        return (*line, " (proved)") if stratum.proved else line

    formulas = [notation.formula(e) for stratum in strata for e in stratum.casimirs]
    lines = [line_of(stratum) for stratum in strata]
    lines += definition_lines([] if casimirs.definitions else notation.definitions(formulas))
    if not all(stratum.proved for stratum in strata):
        lines.append(("sets of lower rank that are not listed may exist",))
    if bracket.symbols:
        lines.append(("parameters are generic here: " + ", ".join(sorted(bracket.symbols)),))
    return Topic(
        "strata",
        lines,
        lambda: [
            {
                "condition": stratum.condition,
                "rank": stratum.rank,
                "proved": stratum.proved,
                "certificate": stratum.certificate,
                "complete": stratum.complete,
                "casimirs": [record_of_formula(notation.formula(e), e) for e in stratum.casimirs],
            }
            for stratum in strata
        ],
    )


def _place_of(stratum: Stratum, bracket: Bracket) -> Line:
    """Where the leaves have which dimension."""
    named = replace(stratum.locus, is_generic=False)
    if stratum.locus.is_everywhere:
        return (f"dimension {stratum.rank} everywhere",)
    if named.is_everywhere:
        return (f"dimension {stratum.rank} at generic points",)
    adverb = "" if stratum.proved else "generically "
    return (f"dimension {stratum.rank} {adverb}where ", Statement.about(str(named), bracket))


def symmetry_topic(bracket: Bracket, hamiltonian: Expr) -> Topic:
    """Linear maps of the fields that keep the bracket, besides those of the group of g, and whether they keep H."""
    derivations = [(found, _keeps(found, bracket, hamiltonian)) for found in bracket.derivations()]
    scalings = [found for found in bracket.scalings() if any(found.parameters.values())]
    lines: list[Line] = [
        (Statement.about(str(found), bracket), f": keeps the bracket{' and H' if keeps else ''}")
        for found, keeps in derivations
    ]
    lines += [(Statement.about(str(found), bracket),) for found in scalings]
    record: list[dict[str, Any]] = [
        {"text": str(d), "kind": d.kind, "matrix": [[str(v) for v in row] for row in d.matrix], "keeps_H": keeps}
        for d, keeps in derivations
    ]
    record += [
        {"text": str(s), "kind": "scaling", "weights": list(s.weights), "parameters": dict(s.parameters)}
        for s in scalings
    ]
    return Topic("symmetries", lines or [("no one-parameter family that acts on the fields alone",)], lambda: record)


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
