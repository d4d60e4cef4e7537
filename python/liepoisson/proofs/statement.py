"""The theorem in words, with the margins of each check."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from textwrap import wrap
from typing import TYPE_CHECKING

from liepoisson.proofs.certificate import Margins

if TYPE_CHECKING:
    from liepoisson.proofs.theorem import ChaosProof

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
