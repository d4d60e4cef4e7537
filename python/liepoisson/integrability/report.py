"""Is a system integrable? What was searched, found, proved and left open, in one object."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sympy import Expr

from liepoisson import _core
from liepoisson.errors import OutputError, ParameterError, TimeLimitError
from liepoisson.formula.scalars import as_count, as_deadline
from liepoisson.inputs.calls import shows_progress
from liepoisson.inputs.deadline import SEARCH_LIMIT, Deadline
from liepoisson.inputs.refusals import shown
from liepoisson.integrability.certificates import certificate, unknown_casimirs
from liepoisson.integrability.completeness import (
    ClosedIntegrals,
    closed_integrals,
    commuting_combinations,
    commuting_integrals,
    fields_rank,
)
from liepoisson.integrability.derivation import n_monomials
from liepoisson.integrability.polynomial_integrals import FirstIntegrals, first_integrals, named_formulas, search_record
from liepoisson.integrability.search import next_name
from liepoisson.integrability.search_problem import casimirs_of, with_hamiltonian
from liepoisson.io.files import write_atomically
from liepoisson.model.system import System
from liepoisson.model.system_text import system_text
from liepoisson.report.printing import Formula

if TYPE_CHECKING:
    from liepoisson.integrability.galois.obstruction import GaloisObstruction
    from liepoisson.integrability.painleve.singularity_analysis import PainleveTest

FORMAT = "liepoisson report of integrability/1"
_GROWTH = 12.0
"""How much longer the next degree may take than the last one: it is not begun where the rest of the time is shorter."""

_ONE_DEGREE_OF_FREEDOM = 2
"""Rank of the bracket with which H alone makes a system integrable."""
_LONGEST_TEST = 20.0
"""Seconds for the singularities in complex time, which are evidence only."""
_LEAST_TIME = 1.0
"""Seconds that must be left for the two tests of non-integrability."""


@dataclass(frozen=True, repr=False)
class IntegrabilityReport:
    """What is known of the integrability of a system, with the proofs.

    Example:
        >>> report = lp.integrability.integrability_report(lp.catalog.system("lagrange"))
        >>> report.verdict, report.commuting, report.rank
        ('integrable', ('H', 'F1'), 4)

    Attributes:
        system: The system.
        verdict: "integrable", "superintegrable", "not integrable" (in the sense of Liouville, with meromorphic
            integrals; `obstruction` says where), "no further polynomial integral", or "open".
        rank: Dimension of a generic leaf.
        integrals: Independent integrals besides the Casimirs, by name: H first.
        dependent: Other integrals that were found, by name: functions of those and of Casimirs, though no polynomials
            in what stands before them; and polynomials of degree two that commute where the integrals themselves do
            not.
        degree: The degree up to which was to be searched.
        commuting: Names of integrals that commute with each other and are as many as half the rank; empty if not found.
            With all Casimirs they prove integrability; where some are unknown the verdict is "open", and says so.
        closed: Where none of the integrals commute: integrals that are closed under the bracket, and enough by the
            theorem of Mishchenko and Fomenko (`liepoisson.integrability.completeness` states it); None if not found.
        searches: The searches, in their order.
        certificate: Plain data that proves Liouville integrability, for `liepoisson.integrability.checker`; None if
            there is none.
        notes: What else was done, or left.
        searched_here: Whether the searches were made in this process.  In a report that was loaded they are what the
            file says; integrals, brackets, the certificate and the obstruction are verified all the same.
        obstruction: What `galois_obstruction` says, where integrability was not proved and time was left.
        singularities: What `painleve_test` says, likewise: evidence, of which the verdict makes no use.
    """

    system: System
    verdict: str
    rank: int
    integrals: dict[str, Expr] = field(hash=False)
    dependent: dict[str, Expr] = field(hash=False)
    degree: int
    commuting: tuple[str, ...]
    closed: ClosedIntegrals | None
    searches: tuple[FirstIntegrals, ...]
    certificate: dict[str, Any] | None = field(repr=False, hash=False)
    notes: tuple[str, ...] = ()
    searched_here: bool = True
    obstruction: GaloisObstruction | None = None
    singularities: PainleveTest | None = None

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
        others = "integrals that are no polynomials"
        if self.verdict == "not integrable":
            others = "integrals that are not meromorphic near the curve, and fewer than integrability needs"
        return searched, others, "integrals on one level only"

    def save(self, path: str | Path) -> Path:
        """Write the report as JSON; `load_report` reads it and verifies what it says.

        Raises:
            OutputError: the file cannot be written, or its name does not end in .json.
            SystemFileError: the system has no text, as one that was made with a Python function of other symbols.
        """
        path = Path(path)
        if path.suffix != ".json":
            raise OutputError(f"wanted a name that ends in .json; got {shown(str(path))}; write for example top.json")
        kind, text = type(self.system).__name__, system_text(self.system)
        data = {"format": FORMAT, "version": _core.__version__, "kind": kind, "file": text, **report_record(self)}
        write_atomically(path, (json.dumps(data, indent=1) + "\n").encode())
        return path

    def __repr__(self) -> str:
        return f"<IntegrabilityReport of {self.system.name}: {self._sentence}>"

    @property
    def _sentence(self) -> str:
        n, m, d = self.rank // 2, len(self.integrals), self.searched_degree
        leaves = f"on leaves of dimension {self.rank}"
        proved = "proved" if self.searched_here else "as the file says, not proved again"
        if (casimirs := unknown_casimirs(self.system)) and (self.commuting or self.closed is not None):
            enough = f"{n} commuting" if self.commuting else f"{m} that are closed under the bracket"
            return f"open, {casimirs}; with them the integrals would be enough, {enough}, {leaves}"
        if self.closed is not None:
            closed = f"closed under the bracket, of corank {self.closed.corank}"
            return f"superintegrable, {m} independent integrals {closed}, {leaves}: proved"
        among = (
            "of them commuting" if self.integrals.keys() >= {*self.commuting} else "commuting polynomials in integrals"
        )
        none = f"no polynomial integral up to degree {d} besides polynomials in these{self._and_casimirs}: {proved}"
        return {
            "integrable": f"Liouville integrable, {n} commuting integral{'s' * (n > 1)} {leaves}: proved",
            "superintegrable": f"superintegrable, {m} independent integrals, {n} {among}, {leaves}: proved",
            "not integrable": "not Liouville integrable with meromorphic integrals: proved"
            + (f"; {none}" if d else ""),
            "no further polynomial integral": f"{none}; integrability open",
            "open": f"open, not searched up to degree {self.degree}" + (f"; {none}" if d else ""),
        }[self.verdict]

    @property
    def _and_casimirs(self) -> str:
        return " and the Casimirs" if self.system.bracket.casimirs() else ""

    def __str__(self) -> str:
        """The verdict, the integrals, and what was searched."""
        lines = [f"{self.system.name}: {self._sentence}"]
        lines += [f"{name} = {Formula(expression).plain}" for name, expression in self.integrals.items()]
        lines += [f"{name} = {Formula(f).plain}   (depends on the others)" for name, f in self.dependent.items()]
        if self.commuting:
            lines.append(f"commuting: {', '.join(self.commuting)}")
        if self.closed is not None:
            lines += [f"{{{a}, {b}}} = {Formula(value).plain}" for (a, b), value in self.closed.brackets.items()]
        again = "" if self.searched_here else ", not proved again"
        lines += [
            f"searched: {s.scope}: {len(s.found)} new, " + (f"all of them{again}" if s.complete else "perhaps not all")
            for s in self.searches
        ]
        lines += self.notes
        if self.obstruction is not None:
            lines.append(f"differential Galois group: {self.obstruction.verdict}")
            if self.obstruction.statement:
                lines += [f"- {step}" for step in self.obstruction.steps]
                lines.append(self.obstruction.statement)
        if self.singularities is not None:
            lines.append(f"singularities in complex time: {self.singularities.verdict}. {self.singularities.scope}")
        return "\n".join([*lines, f"not tried: {'; '.join(self.not_tried)}"])


def report_record(report: IntegrabilityReport) -> dict[str, Any]:
    """The verdict with all that it rests on."""
    closed = report.closed
    return {
        "system": report.system.name,
        "verdict": report.verdict,
        "rank": report.rank,
        "degree": report.degree,
        "integrals": named_formulas(report.integrals),
        "dependent": named_formulas(report.dependent),
        "commuting": list(report.commuting),
        "closed": closed
        and {
            "names": list(closed.names),
            "corank": closed.corank,
            "brackets": [[*pair, Formula(value).plain] for pair, value in closed.brackets.items()],
        },
        "searched_degree": report.searched_degree,
        "searches": [search_record(search) for search in report.searches],
        "not_tried": list(report.not_tried),
        "certificate": report.certificate,
        "obstruction": report.obstruction
        and {
            "verdict": report.obstruction.verdict,
            "theorem": report.obstruction.theorem,
            "statement": report.obstruction.statement,
            "steps": [{"text": step.text, "how": step.how} for step in report.obstruction.steps],
        },
        "singularities": report.singularities
        and {"verdict": report.singularities.verdict, "scope": report.singularities.scope},
        "notes": list(report.notes),
    }


@shows_progress
def integrability_report(
    system: System,
    *,
    degree: int = 6,
    time_limit: float = SEARCH_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> IntegrabilityReport:
    """Look for polynomial integrals, degree by degree, until they prove that a system is integrable; else for reasons.

    Where the integrals are not enough, `galois_obstruction` may prove that no meromorphic ones are, and `painleve_test`
    adds what the singularities in complex time say.

    Example:
        >>> print(lp.integrability.integrability_report(lp.catalog.system("kovalevskaya")).verdict)
        integrable

    Args:
        system: A system as for `first_integrals`.
        degree: The largest degree.
        time_limit: Seconds after which the report is made of what is known.  Both other tests share what the searches
            leave.
        progress: As for `integrate`.

    Raises:
        ParameterError: the equations are not such as `first_integrals` searches.
        TimeLimitError: not even the rank and the Casimirs of the bracket were known in time.
    """
    most, deadline = as_count(degree, "degree", least=1), as_deadline(time_limit)
    with deadline.running():
        return _report(system, most, deadline, progress or (lambda _: None))


def _report(system: System, most: int, deadline: Deadline, listen: Callable[[float], Any]) -> IntegrabilityReport:
    """As `integrability_report`, before the deadline of the call."""
    notes: list[str] = []
    system = _without_quadratures(system, notes)
    rank = system.bracket.rank()
    casimirs = casimirs_of(system)
    integrals: dict[str, Expr] = {"H": system.hamiltonian}
    dependent: dict[str, Expr] = {}
    searches: list[FirstIntegrals] = []
    if not any(system.bracket.vector_field(system.hamiltonian)):
        notes.append("nothing moves: H commutes with all functions")
    commuting, closed = _enough(system, integrals, dependent, rank, notes)
    last = 0.0
    for d in range(1, most + 1):
        if commuting or closed:
            break
        if (left := deadline.left) < _GROWTH * last or not left:
            notes.append(
                f"degree {d} was not searched: it may take longer than the time limit of {deadline.seconds:g} s"
            )
            break
        try:
            found = first_integrals(system, degree=d, known=casimirs | integrals | dependent)
        except ParameterError:
            if d == 1:
                raise
            notes.append(f"degree {d}, {n_monomials(len(system.variables), d):,} monomials, was not searched")
            break
        except TimeLimitError:
            notes.append(f"degree {d} was not searched to its end: the time limit of {deadline.seconds:g} s has passed")
            break
        last = left - deadline.left
        searches.append(found)
        for f in found.found:
            (integrals if f.is_independent else dependent)[next_name(system.component_names, integrals, dependent)] = (
                f.expression
            )
        if found.found:
            commuting, closed = _enough(system, integrals, dependent, rank, notes)
        listen(0.7 * d / most)
    proof, obstruction, singularities = None, None, None
    if commuting and not unknown_casimirs(system):
        proof = _certificate(system, {name: (integrals | dependent)[name] for name in commuting}, notes)
    elif not commuting and not closed:
        obstruction, singularities = _reasons(system, deadline.left, notes)
    return IntegrabilityReport(
        system,
        verdict_of(system, integrals, commuting, closed, searches, degree=most, obstruction=obstruction),
        rank,
        integrals,
        dependent,
        most,
        commuting,
        closed,
        tuple(searches),
        proof,
        tuple(notes),
        obstruction=obstruction,
        singularities=singularities,
    )


def _without_quadratures(system: System, notes: list[str]) -> System:
    if len(system.variables) == len(system.bracket.variables):
        return system
    notes.append("quadratures were left out: they are no functions on phase space")
    return with_hamiltonian(system, system.hamiltonian)


def _certificate(system: System, commuting: Mapping[str, Expr], notes: list[str]) -> dict[str, Any] | None:
    try:
        return certificate(system, commuting)
    except (ParameterError, TimeLimitError) as error:
        notes.append(f"no certificate: {error}")
        return None


def _reasons(system: System, seconds: float, notes: list[str]) -> tuple[GaloisObstruction | None, PainleveTest | None]:
    """What the differential Galois group and the singularities in complex time say, where they apply."""
    from liepoisson.integrability.galois.obstruction import galois_obstruction
    from liepoisson.integrability.painleve.singularity_analysis import painleve_test

    obstruction, singularities = None, None
    if system.bracket.rank() <= _ONE_DEGREE_OF_FREEDOM:
        return None, None
    if seconds < _LEAST_TIME:
        notes.append("no time was left for the differential Galois group and for the singularities in complex time")
        return None, None
    if not any(system.bracket.vector_field(system.hamiltonian)):
        return None, None
    try:
        obstruction = galois_obstruction(system, time_limit=seconds / 2)
    except (ParameterError, TimeLimitError) as error:
        notes.append(f"the differential Galois group was not examined: {error}")
    try:
        singularities = painleve_test(system, time_limit=min(seconds / 2, _LONGEST_TEST))
    except (ParameterError, TimeLimitError) as error:
        notes.append(f"singularities in complex time were not examined: {error}")
    return obstruction, singularities


def verdict_of(
    system: System,
    integrals: Mapping[str, Expr],
    commuting: Sequence[str],
    closed: ClosedIntegrals | None,
    searches: Sequence[FirstIntegrals],
    *,
    degree: int,
    obstruction: GaloisObstruction | None = None,
) -> str:
    """What these facts prove.  Where Casimirs are unknown, the rank of the bracket is no more than a lower bound."""
    if unknown_casimirs(system) and (commuting or closed is not None):
        return "open"
    if closed is not None:
        return "superintegrable"
    if commuting:
        return "superintegrable" if len(integrals) > system.bracket.rank() // 2 else "integrable"
    if obstruction is not None and obstruction.verdict == "not integrable":
        return "not integrable"
    searched = all(s.complete for s in searches) and any(s.degree == degree for s in searches)
    return "no further polynomial integral" if searched else "open"


def _enough(
    system: System, integrals: dict[str, Expr], dependent: dict[str, Expr], rank: int, notes: list[str]
) -> tuple[tuple[str, ...], ClosedIntegrals | None]:
    """Commuting integrals that are enough, or closed ones, after independent brackets were added.

    Where none commute, combinations of degree two are looked for.  Where the deadline passes, what was found stays.
    """
    try:
        commuting = commuting_integrals(system, integrals | dependent, rank)
        if not commuting:
            notes += _add_brackets(system, integrals, dependent, rank)
            commuting = commuting_integrals(system, integrals | dependent, rank)
        if commuting or len(integrals) < max(rank // 2, 2):
            return commuting, None
        closed = closed_integrals(system, integrals, rank) if len(integrals) > rank // 2 else None
        chosen: list[str] = []
        for function, formula in commuting_combinations(system, integrals | dependent, rank):
            name = str(formula)
            if name not in integrals | dependent:
                name = next_name(system.component_names, integrals, dependent)
                dependent[name] = function
                notes.append(f"{name} = {Formula(formula).plain}")
            chosen.append(name)
        return tuple(chosen), closed
    except TimeLimitError as error:
        notes.append(f"whether the integrals that were found are enough is not decided: {error}")
        return (), None


def _add_brackets(system: System, integrals: dict[str, Expr], dependent: Mapping[str, Expr], rank: int) -> list[str]:
    """Brackets of integrals that are independent of all, which are integrals by Poisson's theorem; says which."""
    notes: list[str] = []
    while True:
        for a, b in combinations([name for name in integrals if name != "H"], 2):
            bracket = system.bracket(integrals[a], integrals[b]).expand()
            if bracket == 0 or len(integrals) >= rank - 1:
                continue
            if fields_rank(system, [*integrals.values(), bracket]) > len(integrals):
                name = next_name(system.component_names, integrals, dependent)
                integrals[name] = bracket
                notes.append(f"{name} = {{{a}, {b}}}, by Poisson's theorem")
                break
        else:
            return notes
