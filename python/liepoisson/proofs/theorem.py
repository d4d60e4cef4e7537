"""The theorem that a top is chaotic: a certificate, checked by two arithmetics, and what follows from it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.ideals.limits import NotDecidedError
from liepoisson.errors import CertificateError, EnclosureError, ParameterError
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.given import texts
from liepoisson.inputs.refusals import not_a, shown
from liepoisson.proofs.certificate import CoveringCertificate, load_covering_certificate, read_certificate
from liepoisson.proofs.claimed_system import compare_equations
from liepoisson.proofs.margins import Margins
from liepoisson.proofs.polynomial_field import PolynomialField, polynomial_field
from liepoisson.proofs.regularity import is_regular
from liepoisson.proofs.search import CertificateCandidate

if TYPE_CHECKING:
    from liepoisson.model.system import System
    from liepoisson.structure.bracket import Bracket

ARITHMETICS = ("intervals", "balls")
SHIPPED = {"twisted-kovalevskaya": "twisted_kovalevskaya.json"}
"""Certificates that come with the package, by the names of systems in the catalogue."""
_MEASURE = (
    "Not proved: anything about the measure of the chaotic set, or about typical states. Lyapunov exponents are "
    "measured."
)


@dataclass(frozen=True)
class ChaosProof:
    """A certificate that was accepted, and the theorem that it proves.

    Attributes:
        system: The system.
        certificate: What was checked.
        field: The exact equations and constants of motion that were used.
        margins: What each arithmetic has verified.
        notes: What else is to be said.
    """

    system: System
    certificate: CoveringCertificate
    field: PolynomialField
    margins: tuple[Margins, ...]
    notes: tuple[str, ...]

    @property
    def entropy(self) -> float:
        """A lower bound of the topological entropy of the flow on a compact invariant set of the level."""
        return max(m.entropy for m in self.margins)

    @property
    def excludes_integrals(self) -> bool:
        """Whether it is proved, too, that there is no further analytic constant of motion."""
        return all(m.excludes_integrals for m in self.margins)

    @property
    def level(self) -> str:
        """The level as text."""
        return ", ".join(f"{name} = {value}" for name, value in self.certificate.level.items())

    def __str__(self) -> str:
        from liepoisson.proofs.statement import statement

        return statement(self)

    __repr__ = __str__


@explains_its_arguments
def prove_chaos(
    system: System,
    certificate: CertificateCandidate | CoveringCertificate | str | Path | None = None,
    *,
    arithmetics: Sequence[str] = ARITHMETICS,
    progress: Callable[[float], object] | None = None,
) -> ChaosProof:
    """Verify a certificate of chaos by covering relations; the theorem is in docs/proof.md.

    Example:
        >>> proof = lp.proofs.prove_chaos(lp.Top.twisted_kovalevskaya(), arithmetics=["intervals"])
        >>> round(proof.entropy, 4), proof.excludes_integrals  # a lower bound of the topological entropy
        (0.048, True)

    Args:
        system: A polynomial system with rational constants; its levels of H and the Casimirs have the dimension 3 or 5.
        certificate: A certificate, what `find_certificate` found, or a file; the one that is shipped, if there is one
            for the system.
        arithmetics: "intervals" (doubles with outward rounding) and "balls" (Arb), which share no code.
        progress: Called with the fraction that is done.

    Raises:
        CertificateError: it is about another system, or a check fails; the message names the first one.
        DamagedFileError: the file has another format.
        ParameterError: the system is not polynomial or has symbols, or an arithmetic has another name.
    """
    chosen = tuple(dict.fromkeys(texts(arithmetics, "arithmetics", "arithmetics", repr(ARITHMETICS))))
    if not chosen or set(chosen) - set(ARITHMETICS):
        raise ParameterError(f"arithmetics: wanted one or both of {ARITHMETICS}; got {shown(arithmetics)}")
    field = polynomial_field(system)
    if certificate is None:
        certificate = shipped_certificate(system)
    elif isinstance(certificate, CertificateCandidate):
        certificate = read_certificate(certificate.chain.record())
    elif isinstance(certificate, (str, Path)):
        certificate = load_covering_certificate(certificate)
    elif not isinstance(certificate, CoveringCertificate):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise not_a("a certificate or the path of one", certificate, "certificate", "try what find_certificate returns")
    notes = [compare_equations(certificate.equations, field)]
    if not keeps_bracket(system.bracket, certificate.symmetry):
        raise CertificateError(
            "the certificate is refused: its symmetry does not keep the bracket of the system, so that multipliers "
            "need not come in pairs"
        )
    _check_level(field, certificate)
    margins: list[Margins] = []
    for number, name in enumerate(chosen):

        def listen(done: float, number: int = number) -> None:
            if progress is not None:
                progress((number + done) / len(chosen))

        try:
            margins.append(_checkers()[name](certificate, field, listen))
        except EnclosureError as error:
            raise CertificateError(f"the certificate is refused by {_NAMES[name]}: {error}") from error
    notes.append(_regularity(field, certificate))  # last: a Gröbner basis takes long, and refuses nothing
    if progress is not None:
        progress(1.0)
    return ChaosProof(system, certificate, field, tuple(margins), (*notes, *_undecided(margins), _MEASURE))


def _undecided(margins: Sequence[Margins]) -> list[str]:
    """Why the theorem on integrals is missing, if it is."""
    reasons = [f"{m.arithmetic}: {m.undecided}" for m in margins if not m.excludes_integrals]
    if not reasons:
        return []
    return [
        "Not proved: that there is no further analytic constant of motion. For two unstable multipliers the proof asks "
        f"for complex ones, and for an angle that depends on the level ({'; '.join(reasons)})."
    ]


def keeps_bracket(bracket: Bracket, signs: Sequence[int]) -> bool:
    """Whether x -> (s_k x_k) is a Poisson map: s_i s_j {x_i, x_j}(x) = {x_i, x_j}(s x), exactly."""
    if len(signs) != bracket.dimension:
        return False
    linear = all(signs[i] * signs[j] == signs[m] for i, j, m, _ in bracket.entries())
    return linear and all(signs[i] * signs[j] == 1 for i, j in bracket.constant)


def _check_level(field: PolynomialField, certificate: CoveringCertificate) -> None:
    """Refuse a level without values of H and all Casimirs.

    Raises:
        CertificateError: it is one.
    """
    if set(certificate.level) != set(field.constants):
        raise CertificateError(
            f"the certificate is refused: wanted a level with values of {', '.join(field.constants)}; got "
            f"{', '.join(certificate.level)}"
        )


def _regularity(field: PolynomialField, certificate: CoveringCertificate) -> str:
    """What is known of the level, exactly."""
    try:
        regular = is_regular(field, certificate.level)
    except NotDecidedError:
        return (
            "Whether all of the level is regular was not decided within the limit of work. The theorem does not depend "
            "on it: H and the Casimirs are independent along all orbits that meet a set."
        )
    if not regular:
        return (
            "The level has critical points, perhaps complex ones. H and the Casimirs are independent along all orbits "
            "that meet a set, and no more is needed."
        )
    return "The level is regular: the ideal of its critical points contains 1, exactly."


def shipped_certificate(system: System) -> CoveringCertificate:
    """The certificate that comes with the package for a system.

    Raises:
        CertificateError: there is none.
    """
    file = _shipped_file(system)
    if file is None:
        raise CertificateError(
            f"no certificate is shipped for {shown(system.name)}; give one, or search for one. There are certificates "
            f"for {', '.join(SHIPPED)}"
        )
    return load_covering_certificate(Path(str(files("liepoisson.proofs").joinpath(file))))


def has_shipped_certificate(system: System) -> bool:
    """Whether a certificate for a system comes with the package."""
    return _shipped_file(system) is not None


def _shipped_file(system: System) -> str | None:
    from liepoisson import catalog

    field = polynomial_field(system)
    return next((file for name, file in SHIPPED.items() if polynomial_field(catalog.system(name)) == field), None)


_NAMES = {"balls": "Arb balls", "intervals": "intervals"}


def _checkers() -> dict[str, Callable[[CoveringCertificate, PolynomialField, Callable[[float], Any]], Margins]]:
    from liepoisson.proofs.balls.checker import check_in_balls
    from liepoisson.proofs.interval_checker import check_in_intervals

    return {"balls": check_in_balls, "intervals": check_in_intervals}
