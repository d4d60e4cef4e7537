"""Is a system integrable? What was searched, found, proved and left open, in one object."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Any

from liepoisson.calls import explains_its_arguments, shows_progress
from liepoisson.errors import ParameterError
from liepoisson.exact.printing import Formula
from liepoisson.integrability.certificates import certificate
from liepoisson.integrability.completeness import (
    ClosedIntegrals,
    closed_integrals,
    commuting_integrals,
    fields_rank,
)
from liepoisson.integrability.monomials import n_monomials
from liepoisson.integrability.polynomial_integrals import FirstIntegrals, first_integrals
from liepoisson.scalars import as_count, as_time_limit

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.exact.system import System

_GROWTH = 12.0
"""How much longer the next degree may take than the last one: it is not begun where the rest of the time is shorter."""


@dataclass(frozen=True, repr=False)
class IntegrabilityReport:
    """What is known of the integrability of a system, with the proofs.

    Attributes:
        system: The system.
        verdict: "integrable", "superintegrable", "no further polynomial integral", or "open".
        rank: Dimension of a generic leaf.
        integrals: Independent integrals besides the Casimirs, by name: H first.
        commuting: Names of those that commute with each other and are as many as half the rank; empty if not found.
        closed: Where no commuting ones were found: integrals that are closed under the bracket, and enough by the
            theorem of Mishchenko and Fomenko (`liepoisson.integrability.completeness` states it); None if not found.
        searches: The searches, in their order.
        certificate: Plain data that proves Liouville integrability, for `liepoisson.integrability.checker`; None if
            there is none.
        notes: What else was done, or left.
        searched_here: Whether the searches were made in this process.  In a report that was loaded they are what the
            file says; integrals, brackets and the certificate are verified all the same.
    """

    system: System
    verdict: str
    rank: int
    integrals: dict[str, Expr]
    commuting: tuple[str, ...]
    closed: ClosedIntegrals | None
    searches: tuple[FirstIntegrals, ...]
    certificate: dict[str, Any] | None = field(repr=False)
    notes: tuple[str, ...] = ()
    searched_here: bool = True

    @property
    def searched_degree(self) -> int:
        """The degree up to which all polynomial integrals are known."""
        return max((s.degree or 0 for s in self.searches if s.complete), default=0)

    @property
    def not_tried(self) -> tuple[str, ...]:
        """What might exist and was not looked for."""
        functions = {f for s in self.searches for f in s.functions}
        kind = "polynomials in these functions" if functions else "polynomials"
        searched = f"{kind} above degree {self.searched_degree}" if self.searches else kind
        return searched, "integrals that are no polynomials", "integrals on one level only"

    def save(self, path: str | Path) -> Path:
        """Write the report as JSON; `load_report` reads it and verifies what it says.

        Raises:
            OutputError: the file cannot be written, or its name does not end in .json.
            SystemFileError: the system has no text, as one that was made with a Python function of other symbols.
        """
        from liepoisson.integrability.saved_reports import save_report

        return save_report(self, path)

    def __repr__(self) -> str:
        return f"<IntegrabilityReport of {self.system.name}: {self._sentence}>"

    @property
    def _sentence(self) -> str:
        n, m, d = self.rank // 2, len(self.integrals), self.searched_degree
        leaves = f"on leaves of dimension {self.rank}"
        proved = "proved" if self.searched_here else "as the file says, not proved again"
        if self.closed is not None:
            closed = f"closed under the bracket, of corank {self.closed.corank}"
            return f"superintegrable, {m} independent integrals {closed}, {leaves}: proved"
        return {
            "integrable": f"Liouville integrable, {n} commuting integral{'s' * (n > 1)} {leaves}: proved",
            "superintegrable": f"superintegrable, {m} independent integrals, {n} of them commuting, {leaves}: proved",
            "no further polynomial integral": f"no polynomial integral up to degree {d} besides these: {proved}; "
            "integrability open",
            "open": "open",
        }[self.verdict]

    def __str__(self) -> str:
        """The verdict, the integrals, and what was searched."""
        lines = [f"{self.system.name}: {self._sentence}"]
        lines += [f"{name} = {Formula(expression).plain}" for name, expression in self.integrals.items()]
        if self.commuting:
            lines.append(f"commuting: {', '.join(self.commuting)}")
        if self.closed is not None:
            lines += [f"{{{a}, {b}}} = {Formula(value).plain}" for (a, b), value in self.closed.brackets.items()]
        again = "" if self.searched_here else ", not proved again"
        lines += [
            f"searched: {s.scope}: {len(s.found)} new, " + (f"all of them{again}" if s.complete else "perhaps not all")
            for s in self.searches
        ]
        return "\n".join([*lines, *self.notes, f"not tried: {'; '.join(self.not_tried)}"])


@explains_its_arguments
@shows_progress
def integrability_report(
    system: System,
    *,
    degree: int = 6,
    time_limit: float = 60.0,
    progress: Callable[[float], Any] | None = None,
) -> IntegrabilityReport:
    """Look for polynomial integrals, degree by degree, until they prove that a system is integrable.

    Example:
        >>> print(lp.integrability.integrability_report(lp.catalog.system("kovalevskaya")).verdict)
        integrable

    Args:
        system: A system as for `first_integrals`.
        degree: The largest degree.
        time_limit: Seconds after which no further degree is begun.
        progress: As for `integrate`.

    Raises:
        ParameterError: the equations are not such as `first_integrals` searches.
    """
    most, limit = as_count(degree, "degree", least=1), as_time_limit(time_limit)
    rank = system.bracket.rank()
    casimirs = {f"C{k}": c for k, c in enumerate(system.bracket.casimirs(), start=1)}
    integrals: dict[str, Expr] = {"H": system.hamiltonian}
    searches: list[FirstIntegrals] = []
    notes: list[str] = []
    commuting, closed = _enough(system, integrals, rank, notes)
    started, last = time.monotonic(), 0.0
    for d in range(1, most + 1):
        used = time.monotonic() - started
        if commuting or closed:
            break
        if used + _GROWTH * last > limit:
            notes.append(f"degree {d} was not searched: it may take longer than the time limit of {limit:g} s")
            break
        try:
            found = first_integrals(system, degree=d, known=casimirs | integrals)
        except ParameterError:
            if d == 1:
                raise
            notes.append(f"degree {d}, {n_monomials(len(system.variables), d):,} monomials, was not searched")
            break
        last = time.monotonic() - started - used
        searches.append(found)
        integrals |= {f"F{len(integrals) + k}": f.expression for k, f in enumerate(found.independent)}
        commuting, closed = _enough(system, integrals, rank, notes)
        if progress:
            progress(d / most)
    proof = None
    if commuting:
        try:
            proof = certificate(system, {name: integrals[name] for name in commuting})
        except ParameterError as error:
            notes.append(f"no certificate: {error}")
    return IntegrabilityReport(
        system,
        verdict_of(rank, integrals, commuting, closed, searches),
        rank,
        integrals,
        commuting,
        closed,
        tuple(searches),
        proof,
        tuple(notes),
    )


def verdict_of(
    rank: int,
    integrals: Mapping[str, Expr],
    commuting: Sequence[str],
    closed: ClosedIntegrals | None,
    searches: Sequence[FirstIntegrals],
) -> str:
    """What these facts prove."""
    if closed is not None:
        return "superintegrable"
    if commuting:
        return "superintegrable" if len(integrals) > rank // 2 else "integrable"
    return "no further polynomial integral" if searches and all(s.complete for s in searches) else "open"


def _enough(
    system: System, integrals: dict[str, Expr], rank: int, notes: list[str]
) -> tuple[tuple[str, ...], ClosedIntegrals | None]:
    """Commuting integrals that are enough; if there are none, closed ones, after independent brackets were added."""
    commuting = commuting_integrals(system, integrals, rank)
    if not commuting:
        notes += _add_brackets(system, integrals, rank)
        commuting = commuting_integrals(system, integrals, rank)
    if commuting or len(integrals) <= rank // 2:
        return commuting, None
    return (), closed_integrals(system, integrals, rank)


def _add_brackets(system: System, integrals: dict[str, Expr], rank: int) -> list[str]:
    """Brackets of integrals that are independent of all, which are integrals by Poisson's theorem; says which."""
    notes: list[str] = []
    while True:
        for a, b in combinations([name for name in integrals if name != "H"], 2):
            bracket = system.bracket(integrals[a], integrals[b]).expand()
            if bracket == 0 or len(integrals) >= rank - 1:
                continue
            if fields_rank(system, [*integrals.values(), bracket]) > len(integrals):
                name = f"F{len(integrals)}"
                integrals[name] = bracket
                notes.append(f"{name} = {{{a}, {b}}}, by Poisson's theorem")
                break
        else:
            return notes
