r"""The theorem that a top is chaotic: a certificate, checked by two arithmetics, and what follows from it.

Is a level of H and the Casimirs regular? Decided exactly, over the complex numbers.

A level $F = c$ is regular where the differentials of H and the Casimirs are independent. They are dependent at a point
of it if $\sum_k m_k\nabla F_k = 0$ with some $m \ne 0$, of which one component may be taken to be 1. So a level is
regular if, for each k, the equations $\sum_k m_k\nabla F_k = 0$, $F = c$, $m_k = 1$ have no solution: their ideal
contains 1.

Is a certificate about this system? Its equations are compared with those that the system has.

The theorem in words, with the margins of each check.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from importlib.resources import files
from itertools import chain, repeat
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any, cast

from liepoisson.algebra.ideals.limits import NotDecidedError
from liepoisson.algebra.ideals.polynomial_system import PolynomialSystem
from liepoisson.algebra.sparse_polynomials import derivative, expression, rational_to_sympy
from liepoisson.errors import CertificateError, EnclosureError, ExpressionError, ParameterError
from liepoisson.formula.expression import read_expression
from liepoisson.formula.scope import Scope
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.given import texts
from liepoisson.inputs.refusals import not_a, shown
from liepoisson.proofs.certificate import CoveringCertificate, Margins, load_covering_certificate, read_certificate
from liepoisson.proofs.polynomial_field import PolynomialField, polynomial_field, rational_terms
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


def is_regular(field: PolynomialField, level: Mapping[str, Fraction]) -> bool:
    """Whether the differentials of H and the Casimirs are independent at all points of a level, also complex ones.

    Raises:
        NotDecidedError: the Gröbner bases cost too much.
    """
    from sympy import Add, Symbol

    x = [Symbol(name) for name in field.names]
    m = [Symbol(f"m_{k}") for k in range(len(field.constants))]
    on_level: list[Any] = [
        Add(expression(f.items(), x), -rational_to_sympy(level[name])) for name, f in field.constants.items()
    ]
    functions = list(field.constants.values())
    for k in range(len(m)):
        # the multipliers before the k-th vanish in what is left
        factors = [0] * k + [1] + m[k + 1 :]
        dependent = [
            Add(
                *(
                    factor * expression(derivative(f, j).items(), x)
                    for factor, f in zip(factors, functions, strict=True)
                )
            )
            for j in range(len(x))
        ]
        unknowns = [*x, *m[k + 1 :]]
        if not PolynomialSystem.of([*dependent, *on_level], unknowns).is_inconsistent:
            return False
    return True


_LEFT_SIDE = re.compile(r"^\s*(?:d\s*)?([A-Za-z]\w*?)\s*(?:'|/\s*dt|_dot|\.)?\s*=")


def compare_equations(equations: object, field: PolynomialField) -> str:
    """Compare the equations in a certificate with those of a system; a sentence that says what was found.

    The proof is about the system's own equations. Those of the certificate are compared with them where they are
    formulas in the grammar of system files, given by the names of the coordinates, as a list or as lines.

    Raises:
        CertificateError: they are formulas, and another system's, or one is missing.
    """
    formulas = _right_sides(equations, field.names)
    if formulas is None:
        return "The equations in the file are not written in this package's grammar and were not compared."
    from sympy import Symbol

    variables = [Symbol(name) for name in field.names]
    for name, text, rate in zip(field.names, formulas, field.rates, strict=True):
        try:
            given = rational_terms(
                read_expression(text.replace("**", "^"), Scope(symbols=field.names)), variables, f"the rate of {name}"
            )
        except ExpressionError:
            return "The equations in the file are not written in this package's grammar and were not compared."
        if given != rate:
            raise CertificateError(
                f"the certificate is about another system: its rate of {name} is {shown(text)}, that of this system "
                f"{shown(field.equations[field.names.index(name)].partition('=')[2].strip())}"
            )
    return "The equations in the file are those of the system."


def _right_sides(equations: object, names: Sequence[str]) -> list[str] | None:
    """The formulas in the order of the coordinates, or None where they are in another form.

    Raises:
        CertificateError: a coordinate has none, or another number of them is listed.
    """
    is_list = isinstance(equations, list)
    if isinstance(equations, str):
        equations = [line for line in re.split(r"[\n;]", equations) if line.strip()]
    if isinstance(equations, Mapping):
        given = cast("Mapping[Any, Any]", equations)
        named = {_name(key, names): value for key, value in given.items()}
    elif isinstance(equations, list):
        lines = cast("list[Any]", equations)
        if not all(isinstance(line, str) for line in lines):
            return None
        sides = [cast("str", line).rpartition("=") for line in lines]
        if not any(head for head, _, _ in sides) and is_list and len(lines) != len(names):
            raise CertificateError(
                f"the certificate is refused: wanted an equation for each of {', '.join(names)}; got {len(lines)}"
            )
        heads = [_LEFT_SIDE.match(f"{head}=") if head else None for head, _, _ in sides]
        named = {
            (_name(head[1], names) if head else name): side[2]
            for head, side, name in zip(heads, sides, chain(names, repeat("")), strict=False)
        }
    else:
        return None
    if (missing := [name for name in names if name not in named]) and len(missing) < len(names):
        raise CertificateError(f"the certificate is refused: its equations lack the rate of {missing[0]}")
    if missing or set(named) != set(names) or not all(isinstance(f, str) for f in named.values()):
        return None
    return [named[name] for name in names]


def _name(text: object, names: Sequence[str]) -> str:
    """A coordinate from the left side of an equation, such as dl1/dt, l1' or l1."""
    plain = re.sub(r"(?:'|/\s*dt|_dot)$", "", str(text).strip())
    return plain if plain in names else plain.removeprefix("d")


_WIDTH = 110
_ROWS: tuple[tuple[str, Callable[[Margins], str]], ...] = (
    ("covering: images reach out to (> 1)", lambda m: f"{m.expansion:.4f}"),
    ("covering: stable size of images (< 1)", lambda m: f"{m.contraction:.4f}"),
    ("cone condition, least margin (> 0)", lambda m: f"{m.cone:.4f}"),
    ("symmetry of gamma (< 1)", lambda m: f"{m.symmetric_q:.4f}"),
    ("distance of the middle set to gamma (> 0)", lambda m: f"{m.apart_from_orbit:.4f}"),
    ("... to the excursion at other times (> 0)", lambda m: f"{m.apart_from_excursion:.4f}"),
    ("... to its image under R (> 0)", lambda m: f"{m.apart_from_image:.4f}"),
    ("flight time of the loop of gamma (<=)", lambda m: f"{m.loop_times[0]:.5f}"),
    ("flight time of the excursion (<=)", lambda m: f"{m.loop_times[1]:.5f}"),
    ("multipliers: T^2/4 - S + 2 (< 0)", lambda m: "" if m.discriminant is None else f"{m.discriminant:.3f}"),
    ("rotation number theta/pi, lower level", lambda m: f"{m.rotations[0].lower:.13f}" if m.rotations else ""),
    ("", lambda m: f"to {m.rotations[0].upper:.13f}" if m.rotations else ""),
    ("rotation number theta/pi, upper level", lambda m: f"{m.rotations[1].lower:.13f}" if m.rotations else ""),
    ("", lambda m: f"to {m.rotations[1].upper:.13f}" if m.rotations else ""),
    ("rigorous steps", lambda m: str(m.n_steps)),
    ("seconds", lambda m: f"{m.seconds:.1f}"),
)


def statement(proof: ChaosProof) -> str:
    """The theorem, what was verified, and what is not proved."""
    return "\n".join(_lines(proof))


def _lines(proof: ChaosProof) -> Iterator[str]:
    yield f"Theorem. {proof.system.name}:"
    yield from (f"    {line}" for line in proof.field.equations)
    yield from wrap(_theorem(proof), _WIDTH)
    yield ""
    yield f"Verified for {len(proof.certificate.sets)} sets and {len(proof.certificate.edges)} covering relations:"
    width = max(len(label) for label, _ in _ROWS) + 2
    yield " " * width + "".join(f"{m.arithmetic:>20}" for m in proof.margins)
    for label, show in _ROWS:
        shown = [show(m) for m in proof.margins]
        if any(shown):  # what no arithmetic has verified is not mentioned
            yield f"{label:{width}}" + "".join(f"{text:>20}" for text in shown)
    yield ""
    for note in proof.notes:
        yield from wrap(note, _WIDTH)
    yield "The lemmas are in docs/proof.md."


def _theorem(proof: ChaosProof) -> str:
    entropy = math.floor(proof.entropy * 1e6) / 1e6
    moved = _signs(proof, proof.certificate.symmetry)
    sentences = [
        f"Let E be the level {proof.level}, and R the change of the {moved}.",
        f"There is a hyperbolic periodic orbit gamma on E, with {_multipliers(proof)}.",
        f"R maps it to itself{_reversers(proof)}.",
        "There is an orbit homoclinic to gamma, along which its stable and unstable manifolds intersect transversally "
        "in E.",
        "In E/R a map along orbits on a compact set is conjugate to the full shift on two symbols.",
        f"On a compact invariant set in E the topological entropy of the flow is greater than {entropy:.6f}.",
        f"The same holds on all levels whose values differ from these by at most {_radius(proof)}.",
    ]
    return " ".join([*sentences, *([_no_integral(proof)] if proof.excludes_integrals else [])])


def _no_integral(proof: ChaosProof) -> str:
    wedge = " ^ ".join(f"d{name}" for name in ("F", *proof.certificate.level))
    return (
        "A function F that is analytic on a connected neighbourhood of gamma and the homoclinic orbit and constant "
        f"along orbits satisfies {wedge} = 0: there is no further analytic constant of motion."
    )


def _multipliers(proof: ChaosProof) -> str:
    if proof.margins[0].n_unstable == 1:
        return "one unstable and one stable multiplier"
    not_real = all(m.discriminant is not None for m in proof.margins)
    return "two unstable and two stable multipliers" + (
        "; none of those of its return in E/R is real" if not_real else ""
    )


def _signs(proof: ChaosProof, signs: Sequence[int]) -> str:
    changed = [name for name, sign in zip(proof.field.names, signs, strict=True) if sign < 0]
    return f"signs of {', '.join(changed)}"


def _reversers(proof: ChaosProof) -> str:
    """The reversers of gamma that all arithmetics have verified."""
    first, *others = proof.margins
    common = [_signs(proof, one) for one in first.reversers if all(one in m.reversers for m in others)]
    if not common:
        return ""
    return f", and so do the changes of the {' and of the '.join(common)}, which map orbits to orbits run backward"


def _radius(proof: ChaosProof) -> str:
    return str(min(Fraction(m.level_radius) for m in proof.margins))
