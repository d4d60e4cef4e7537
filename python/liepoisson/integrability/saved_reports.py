"""Reports of integrability from files, verified when they are read."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, get_args

from sympy import Expr

from liepoisson.algebra.exact_numbers import is_zero
from liepoisson.errors import DamagedFileError, LiePoissonError, MissingFileError, ParameterError
from liepoisson.formula.scalars import as_count, as_time_limit
from liepoisson.inputs.calls import shows_progress
from liepoisson.inputs.deadline import SEARCH_LIMIT
from liepoisson.inputs.refusals import shown
from liepoisson.integrability import checker
from liepoisson.integrability.certificates import MOST_BYTES, certificate
from liepoisson.integrability.completeness import (
    are_integrals,
    closed_integrals,
    commuting_integrals,
    fields_rank,
)
from liepoisson.integrability.galois.obstruction import GaloisObstruction, Verdict, galois_obstruction
from liepoisson.integrability.painleve.singularity_analysis import PainleveTest, painleve_test
from liepoisson.integrability.polynomial_integrals import FirstIntegral, FirstIntegrals, first_integrals, named_formulas
from liepoisson.integrability.report import FORMAT, IntegrabilityReport, report_record, verdict_of
from liepoisson.integrability.search_problem import casimirs_of
from liepoisson.io.files import another_format, read_text
from liepoisson.model.system import System
from liepoisson.model.system_text import read_system_text

TOLD = "note of the file: "
"""Stands before what a file notes."""
_KINDS = ("System", "CanonicalSystem", "Top")
"""Classes of systems that have texts."""


@shows_progress
def load_report(
    path: str | Path,
    *,
    prove_again: bool = False,
    time_limit: float = SEARCH_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> IntegrabilityReport:
    """Read a report and verify it: nothing in the file is trusted.

    The rank, each integral, their independence, their brackets and the certificate are verified, and the verdict is
    drawn anew.  What a search took as known must be among the integrals of the report.  That there are no further
    integrals is proved by the searches only: they are made again on request, or the report says "not proved again".
    Notes are quoted.

    Example:
        >>> from pathlib import Path
        >>> from tempfile import mkdtemp
        >>> report = lp.integrability.integrability_report(lp.catalog.system("lagrange"))
        >>> file = report.save(Path(mkdtemp()) / "lagrange.json")
        >>> again = lp.integrability.load_report(file)
        >>> again.verdict, again.searched_here
        ('integrable', False)

    Args:
        path: A file that `IntegrabilityReport.save` wrote.
        prove_again: Whether to make the searches again.
        time_limit: Seconds after which no further matrix is computed where a proof that the system is not integrable
            is found again; a report of such a system that is not proved again in this time is refused.
        progress: As for `integrate`.

    Raises:
        MissingFileError: there is no such file.
        DamagedFileError: it is no report, or something in it is not true or not proved again; the message says what.
    """
    try:
        data = json.loads(read_text(path, most=MOST_BYTES), object_pairs_hook=checker.once)
        if data["format"] != FORMAT:
            raise ParameterError(another_format(data["format"], FORMAT, data.get("version")))
        return _Reader(data, prove_again, as_time_limit(time_limit), progress).report()
    except FileNotFoundError as error:
        raise MissingFileError(f"{path}: wanted a report; there is no such file; look at the name") from error
    except LiePoissonError as error:
        raise DamagedFileError(f"{path}: the report is refused: {error}") from error
    except (OSError, LookupError, ValueError, TypeError, AttributeError, RecursionError, ArithmeticError) as error:
        raise DamagedFileError(f"{path}: wanted a report; got a file that is none ({error!r:.80})") from error


class _Reader:
    def __init__(
        self,
        data: Mapping[str, Any],
        prove_again: bool,
        time_limit: float,
        progress: Callable[[float], Any] | None,
    ) -> None:
        if data["kind"] not in _KINDS:
            raise ParameterError(f"the kind of system should be one of {', '.join(_KINDS)}; got {shown(data['kind'])}")
        self.data = data
        self.system: System = read_system_text(data["file"], data["kind"])
        self.prove_again = prove_again
        self.time_limit = time_limit
        self.progress = progress
        self.notes: list[str] = []

    def report(self) -> IntegrabilityReport:
        data, system = self.data, self.system
        rank, integrals = system.bracket.rank(), self._expressions(data["integrals"])
        dependent, degree = self._expressions(data["dependent"]), as_count(data["degree"], "degree", least=1)
        functions = integrals | dependent
        if len(functions) < len(integrals) + len(dependent):
            raise ParameterError("two integrals have the same name")
        _agree("the system", data["system"], system.name)
        _agree("the rank", data["rank"], rank)
        self._verify(integrals, dependent)
        commuting, closed = tuple(data["commuting"]), None
        if commuting:
            chosen = {name: functions[name] for name in commuting}
            _agree("the commuting integrals", commuting, commuting_integrals(system, chosen, rank))
        elif found := commuting_integrals(system, functions, rank):
            raise ParameterError(f"the report names no commuting integrals; {', '.join(found)} commute and are enough")
        if data["closed"] is not None:
            closed = closed_integrals(system, integrals, rank)
            if closed is None:
                raise ParameterError("the integrals are not closed under the bracket, or not enough")
        told = data["searches"]
        searches = tuple(self._search(one, integrals, dependent, (k + 1) / len(told)) for k, one in enumerate(told))
        proof = data["certificate"]
        if proof is not None:  # what `certificate` returns was checked
            _agree("the certificate", proof, certificate(system, {name: functions[name] for name in commuting}))
        obstruction, singularities = self._reasons()
        report = IntegrabilityReport(
            system,
            verdict_of(system, integrals, commuting, closed, searches, degree=degree, obstruction=obstruction),
            rank,
            integrals,
            dependent,
            degree,
            commuting,
            closed,
            searches,
            proof,
            (*(_quoted(note) for note in data["notes"]), *self.notes),
            self.prove_again or not searches,
            obstruction,
            singularities,
        )
        written = report_record(report)
        for key in ("verdict", "closed", "searched_degree", "not_tried"):
            _agree(f"the entry {key!r}", data[key], json.loads(json.dumps(written[key])))
        return report

    def _reasons(self) -> tuple[GaloisObstruction | None, PainleveTest | None]:
        """An obstruction is found again; what else was examined is examined again on request."""
        obstruction, singularities = None, None
        given = self.data["obstruction"]
        if given is not None and (self.prove_again or given["verdict"] == "not integrable"):
            obstruction = self._same_obstruction(given["verdict"])
        if self.data["singularities"] is not None and self.prove_again:
            singularities = painleve_test(self.system)
            told = self.data["singularities"]["verdict"]
            if "undecided" not in (told, singularities.verdict):  # which tells of the time that there was
                _agree("what the singularities in complex time say", told, singularities.verdict)
            elif told != singularities.verdict:
                self.notes.append(f"singularities in complex time: {told} in the file, {singularities.verdict} here")
                singularities = None
        return obstruction, singularities

    def _same_obstruction(self, told: str) -> GaloisObstruction | None:
        """What is found again, if it is the same.  Only "not integrable" is a theorem; the others tell of the time."""
        found = galois_obstruction(self.system, time_limit=self.time_limit)
        if told == found.verdict:
            return found
        if told == "not integrable":
            raise ParameterError(
                f"what the differential Galois group says should be {found.verdict!r}; the file says {told!r}. "
                f"If it is true, {self.time_limit:g} s were too short to prove it again: give a longer time_limit"
            )
        if told not in get_args(Verdict):
            raise ParameterError(f"no differential Galois group says {shown(told)}")
        self.notes.append(f"the differential Galois group: {told} in the file, {found.verdict} here")
        return None

    def _expressions(self, entries: list[dict[str, str]]) -> dict[str, Expr]:
        return {entry["name"]: self.system.expression(entry["expression"]) for entry in entries}

    def _verify(self, integrals: Mapping[str, Expr], dependent: Mapping[str, Expr]) -> None:
        """That all are constant along the motion, and those independent that are said to be."""
        if (integrals["H"] - self.system.hamiltonian).expand() != 0:
            raise ParameterError("H is not the Hamiltonian of the system")
        functions = {**integrals, **dependent}
        for (name, f), is_constant in zip(
            functions.items(), are_integrals(self.system, list(functions.values())), strict=True
        ):
            if not is_constant:
                raise ParameterError(f"{name} = {shown(f)} is no integral")
        if fields_rank(self.system, list(integrals.values())) < len(integrals):
            raise ParameterError("the integrals are not independent")
        if dependent and fields_rank(self.system, list(functions.values())) > len(integrals):
            raise ParameterError("an integral that is said to depend on the others does not")

    def _search(
        self, data: Mapping[str, Any], integrals: Mapping[str, Expr], dependent: Mapping[str, Expr], done: float
    ) -> FirstIntegrals:
        """A search as the file says, or made again and compared.

        Nothing is hidden in it: what it took as known or found is an integral of the report.
        """
        _agree("the system of a search", data["system"], self.system.name)
        _agree("the level of a search", data["on"], [])
        casimirs = casimirs_of(self.system)
        of_leaves = [entry for entry in data["known"] if entry["name"] in casimirs]
        _agree("the Casimirs", of_leaves, named_formulas({one["name"]: casimirs[one["name"]] for one in of_leaves}))
        others = self._expressions([entry for entry in data["known"] if entry["name"] not in casimirs])
        both = casimirs | others
        known: dict[str, Expr] = {entry["name"]: both[entry["name"]] for entry in data["known"]}
        found = tuple(
            FirstIntegral(f["name"], self.system.expression(f["expression"]), f["degree"], f["independent"])
            for f in data["found"]
        )
        reported = {**integrals, **dependent}
        for name, f in others.items():
            if name not in reported or not is_zero(f - reported[name]):
                raise ParameterError(f"a search takes {name} = {shown(f)} as known; the report has no such integral")
        for one in found:
            listed, kind = (integrals, "") if one.is_independent else (dependent, "in")
            if not any(is_zero(one.expression - f) for f in listed.values()):
                raise ParameterError(
                    f"a search found {shown(one.expression)}, which should be among the {kind}dependent integrals of "
                    "the report; it is not"
                )
        proof = data["proof"]
        degree, parameters = data["degree"], data["generic_parameters"]
        if type(degree) is not int or degree < 1:
            raise ParameterError(
                f"the degree of a search should be a whole number from 1; the file says {shown(degree)}"
            )
        symbols = {str(symbol) for rate in self.system.equations.values() for symbol in rate.free_symbols}
        unknown = [name for name in parameters if name not in symbols.difference(self.system.component_names)]
        if unknown:
            raise ParameterError(f"a search has the parameter {shown(unknown[0])}, which the system does not have")
        told = FirstIntegrals(
            system=self.system,
            degree=data["degree"],
            weight=None,
            weights=(),
            on=(),
            known=known,
            found=found,
            n_monomials=proof["monomials"],
            n_blocks=proof["blocks"],
            n_integrals=proof["integrals"],
            complete=data["complete"] is True,
            prime=proof["prime"],
            parameters=tuple(data["generic_parameters"]),
            functions=tuple(self.system.expression(f) for f in data["functions"]),
        )
        if not self.prove_again:
            return told
        again = first_integrals(self.system, degree=told.degree, known=known)
        for what in ("complete", "n_integrals", "n_monomials"):
            _agree(f"{what} up to degree {told.degree}", getattr(told, what), getattr(again, what))
        _agree(f"the number of integrals up to degree {told.degree}", len(found), len(again.found))
        functions = [*integrals.values(), *(f.expression for f in again.found)]
        if fields_rank(self.system, functions) > len(integrals):
            raise ParameterError(
                f"a search up to degree {told.degree} finds an independent integral that is not in the report"
            )
        if self.progress:
            self.progress(done)
        return again


def _quoted(note: object) -> str:
    """A note of a file: words that nothing verifies, on one line, so that none of them looks like what is proved."""
    words = "".join(c if c.isprintable() else "\ufffd" for c in " ".join(str(note).split()))
    return words if words.startswith(TOLD) else TOLD + words


def _agree(what: str, given: Any, wanted: Any) -> None:
    if given != wanted:
        raise ParameterError(f"{what} should be {shown(wanted)}; the file says {shown(given)}")
