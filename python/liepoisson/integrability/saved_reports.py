"""Reports of integrability from files, verified when they are read."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from liepoisson.calls import explains_its_arguments, shows_progress
from liepoisson.errors import DamagedFileError, LiePoissonError, MissingFileError, ParameterError
from liepoisson.exact.system_text import read_system_text
from liepoisson.integrability import checker
from liepoisson.integrability.certificates import certificate
from liepoisson.integrability.completeness import (
    are_integrals,
    closed_integrals,
    commuting_integrals,
    fields_rank,
)
from liepoisson.integrability.galois.obstruction import GaloisObstruction, galois_obstruction
from liepoisson.integrability.painleve.singularity_analysis import PainleveTest, painleve_test
from liepoisson.integrability.polynomial_integrals import FirstIntegral, FirstIntegrals, first_integrals
from liepoisson.integrability.records import named
from liepoisson.integrability.report import FORMAT, IntegrabilityReport, report_record, verdict_of
from liepoisson.scalars import as_count
from liepoisson.wrong_values import shown

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.exact.system import System


@explains_its_arguments
@shows_progress
def load_report(
    path: str | Path, *, prove_again: bool = False, progress: Callable[[float], Any] | None = None
) -> IntegrabilityReport:
    """Read a report and verify it: nothing in the file is trusted.

    The rank, each integral, their independence, their brackets and the certificate are verified, and the verdict is
    drawn anew.  That there are no further integrals is proved by the searches only: they are made again on request, or
    the report says "not proved again".

    Args:
        path: A file that `IntegrabilityReport.save` wrote.
        prove_again: Whether to make the searches again.
        progress: As for `integrate`.

    Raises:
        MissingFileError: there is no such file.
        DamagedFileError: it is no report, or something in it is not true; the message says what.
    """
    try:
        data = json.loads(Path(path).read_text(encoding="utf-8"), object_pairs_hook=checker.once)
        if data["format"] != FORMAT:
            raise ParameterError("it has another format")
        return _Reader(data, prove_again=prove_again, progress=progress).report()
    except FileNotFoundError as error:
        raise MissingFileError(f"{path}: wanted a report; there is no such file; look at the name") from error
    except LiePoissonError as error:
        raise DamagedFileError(f"{path}: the report is refused: {error}") from error
    except (
        OSError,
        ValueError,
        KeyError,
        TypeError,
        IndexError,
        AttributeError,
        RecursionError,
        ArithmeticError,
    ) as error:
        raise DamagedFileError(f"{path}: wanted a report; got a file that is none ({error!r:.80})") from error


class _Reader:
    def __init__(self, data: Mapping[str, Any], *, prove_again: bool, progress: Callable[[float], Any] | None) -> None:
        self.data = data
        self.system: System = read_system_text(data["file"], data["kind"])
        self.prove_again = prove_again
        self.progress = progress

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
        if data["closed"] is not None:
            closed = closed_integrals(system, integrals, rank)
            if closed is None:
                raise ParameterError("the integrals are not closed under the bracket, or not enough")
        searches = tuple(self._search(one, k / len(data["searches"])) for k, one in enumerate(data["searches"]))
        proof = data["certificate"]
        if proof is not None:
            if wrong := checker.check(proof):
                raise ParameterError(f"the certificate fails: {wrong}")
            _agree("the certificate", proof, certificate(system, {name: functions[name] for name in commuting}))
        obstruction, singularities = self._reasons()
        report = IntegrabilityReport(
            system,
            verdict_of(rank, integrals, commuting, closed, searches, degree=degree, obstruction=obstruction),
            rank,
            integrals,
            dependent,
            degree,
            commuting,
            closed,
            searches,
            proof,
            tuple(map(str, data["notes"])),
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
            obstruction = galois_obstruction(self.system)
            _agree("what the differential Galois group says", given["verdict"], obstruction.verdict)
        if self.data["singularities"] is not None and self.prove_again:
            singularities = painleve_test(self.system)
            wanted = self.data["singularities"]["verdict"]
            _agree("what the singularities in complex time say", wanted, singularities.verdict)
        return obstruction, singularities

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

    def _search(self, data: Mapping[str, Any], done: float) -> FirstIntegrals:
        """A search as the file says, or made again and compared."""
        casimirs = {f"C{k}": c for k, c in enumerate(self.system.bracket.casimirs(), start=1)}
        of_leaves = [entry for entry in data["known"] if entry["name"] in casimirs]
        _agree("the Casimirs", of_leaves, named({entry["name"]: casimirs[entry["name"]] for entry in of_leaves}))
        others = self._expressions([entry for entry in data["known"] if entry["name"] not in casimirs])
        both = casimirs | others
        known: dict[str, Expr] = {entry["name"]: both[entry["name"]] for entry in data["known"]}
        found = tuple(
            FirstIntegral(f["name"], self.system.expression(f["expression"]), f["degree"], f["independent"])
            for f in data["found"]
        )
        claimed = [*others.values(), *(f.expression for f in found)]
        if not all(are_integrals(self.system, claimed)):
            raise ParameterError(f"the search up to degree {data['degree']} has a function that is no integral")
        proof = data["proof"]
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
        if self.progress:
            self.progress(done)
        return again


def _agree(what: str, given: Any, wanted: Any) -> None:
    if given != wanted:
        raise ParameterError(f"{what} should be {shown(wanted)}; the file says {shown(given)}")
