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
from liepoisson.integrability.certificates import certificate, save_certificate
from liepoisson.integrability.derivation import derivation_of
from liepoisson.integrability.modular import gradient_at, modular, random_point
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
        searches: The searches, in their order.
        certificate: Plain data that proves Liouville integrability, for `liepoisson.integrability.checker`; None if
            there is none.
        notes: What else was done, or left.
    """

    system: System
    verdict: str
    rank: int
    integrals: dict[str, Expr]
    commuting: tuple[str, ...]
    searches: tuple[FirstIntegrals, ...]
    certificate: dict[str, Any] | None = field(repr=False)
    notes: tuple[str, ...] = ()

    @property
    def searched_degree(self) -> int:
        """The degree up to which all polynomial integrals are known."""
        return max((s.degree or 0 for s in self.searches if s.complete), default=0)

    def save(self, path: str | Path) -> Path:
        """Write the certificate as JSON; `load_certificate` and the module `checker` read and check it.

        Raises:
            ParameterError: there is none.
            OutputError: the file cannot be written.
        """
        if self.certificate is None:
            raise ParameterError(
                f"wanted a proof of integrability to write; the verdict is {self.verdict!r}. Search to a higher degree"
            )
        return save_certificate(self.certificate, path)

    def __repr__(self) -> str:
        return f"<IntegrabilityReport of {self.system.name}: {self._sentence}>"

    @property
    def _sentence(self) -> str:
        n = self.rank // 2
        if self.verdict == "integrable":
            return f"Liouville integrable, {n} commuting integrals on leaves of dimension {self.rank}: proved"
        if self.verdict == "superintegrable":
            return (
                f"superintegrable, {len(self.integrals)} independent integrals, {n} of them commuting, on leaves of "
                f"dimension {self.rank}: proved"
            )
        if self.verdict == "open":
            return "open"
        return f"no polynomial integral up to degree {self.searched_degree} besides these: proved; integrability open"

    def __str__(self) -> str:
        """The verdict, the integrals, and what was searched."""
        lines = [f"{self.system.name}: {self._sentence}"]
        lines += [f"{name} = {Formula(expression).plain}" for name, expression in self.integrals.items()]
        if self.commuting:
            lines.append(f"commuting: {', '.join(self.commuting)}")
        lines += [
            f"searched: {s.scope}: {len(s.found)} new, " + ("all of them" if s.complete else "perhaps not all")
            for s in self.searches
        ]
        return "\n".join([*lines, *self.notes])


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
        system: A system with polynomial equations.
        degree: The largest degree.
        time_limit: Seconds after which no further degree is begun.
        progress: As for `integrate`.

    Raises:
        ParameterError: the equations are no polynomials.
    """
    most, limit = as_count(degree, "degree", least=1), as_time_limit(time_limit)
    rank = system.bracket.rank()
    casimirs = {f"C{k}": c for k, c in enumerate(system.bracket.casimirs(), start=1)}
    integrals: dict[str, Expr] = {"H": system.hamiltonian}
    searches: list[FirstIntegrals] = []
    notes: list[str] = []
    commuting: tuple[str, ...] = _commuting(system, integrals, rank)
    started, last = time.monotonic(), 0.0
    for d in range(1, most + 1):
        used = time.monotonic() - started
        if commuting or used + _GROWTH * last > limit:
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
        commuting = _commuting(system, integrals, rank)
        if progress:
            progress(d / most)
    proof = None
    if commuting:
        try:
            proof = certificate(system, {name: integrals[name] for name in commuting})
        except ParameterError as error:
            notes.append(f"no certificate: {error}")
    verdict = "open"
    if commuting:
        verdict = "superintegrable" if len(integrals) > rank // 2 else "integrable"
    elif searches and all(s.complete for s in searches):
        verdict = "no further polynomial integral"
    return IntegrabilityReport(system, verdict, rank, integrals, commuting, tuple(searches), proof, tuple(notes))


def _commuting(system: System, integrals: Mapping[str, Expr], rank: int) -> tuple[str, ...]:
    """Names of as many commuting integrals with independent vector fields as half the rank, H among them, if found."""
    names, n = list(integrals), rank // 2
    if len(names) < n or not n:
        return ()
    pairs = {
        frozenset(pair)
        for pair in combinations(names, 2)
        if "H" in pair or system.bracket(integrals[pair[0]], integrals[pair[1]]).expand() == 0
    }
    for others in combinations(names[1:], n - 1):
        chosen = ("H", *others)
        if (
            all(frozenset(pair) in pairs for pair in combinations(chosen, 2))
            and _fields_rank(system, [integrals[c] for c in chosen]) == n
        ):
            return chosen
    return ()


def _fields_rank(system: System, functions: Sequence[Expr]) -> int:
    """The rank of the vector fields of functions at a random point modulo a prime, a lower bound."""
    from liepoisson.exact.linear.linear_algebra import rank_mod

    x = system.variables
    entries = [(i, j, system.bracket(x[i], x[j])) for i, j in combinations(range(len(x)), 2)]
    entries = [(i, j, e) for i, j, e in entries if e != 0]
    derivation, polynomials = derivation_of(system, *functions, *(e for _, _, e in entries))
    residues = derivation.field.residues(seed=1)
    if residues is None:
        return 0
    p, point = residues.p, random_point(len(x), residues.p)
    from liepoisson.integrability.modular import value_at

    slopes = [gradient_at(modular(f, residues), point, p) for f in polynomials[: len(functions)]]
    tensor = [
        (i, j, value_at(modular(e, residues), point, p))
        for (i, j, _), e in zip(entries, polynomials[len(functions) :], strict=True)
    ]
    rows: list[dict[int, int]] = []
    for slope in slopes:
        row: dict[int, int] = {}
        for i, j, value in tensor:
            row[i] = (row.get(i, 0) + value * slope.get(j, 0)) % p
            row[j] = (row.get(j, 0) - value * slope.get(i, 0)) % p
        rows.append({k: v for k, v in row.items() if v})
    return rank_mod(rows, len(x), p)
