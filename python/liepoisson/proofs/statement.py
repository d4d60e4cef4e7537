"""The theorem in words, with the margins of each check."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from textwrap import wrap
from typing import TYPE_CHECKING

from liepoisson.proofs.margins import Margins

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
    ("multipliers: T^2/4 - S + 2 (< 0)", lambda m: f"{m.discriminant:.3f}"),
    ("rotation number theta/pi, lower level", lambda m: f"{m.rotations[0].lower:.13f}"),
    ("", lambda m: f"to {m.rotations[0].upper:.13f}"),
    ("rotation number theta/pi, upper level", lambda m: f"{m.rotations[1].lower:.13f}"),
    ("", lambda m: f"to {m.rotations[1].upper:.13f}"),
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
        yield f"{label:{width}}" + "".join(f"{show(m):>20}" for m in proof.margins)
    yield ""
    for note in proof.notes:
        yield from wrap(note, _WIDTH)
    yield "The lemmas are in docs/proof.md."


def _theorem(proof: ChaosProof) -> str:
    signs = zip(proof.field.names, proof.certificate.symmetry, strict=True)
    changed = [name for name, sign in signs if sign < 0]
    constants = list(proof.certificate.level)
    entropy = math.floor(proof.entropy * 1e6) / 1e6
    return (
        f"Let E be the level {proof.level}, and R the change of the signs of {', '.join(changed)}. "
        "There is a hyperbolic periodic orbit gamma on E, symmetric under R and two reversers, with multipliers that "
        "are not real, and an orbit homoclinic to it, along which its stable and unstable manifolds intersect "
        "transversally in E. In E/R a map along orbits on a compact set is conjugate to the full shift on two symbols. "
        f"The topological entropy of the flow on E is greater than {entropy:.6f}. The same holds on all levels whose "
        f"values differ from these by at most {proof.margins[0].level_radius}. A function F that is analytic on a "
        "connected neighbourhood of gamma and the homoclinic orbit and constant along orbits satisfies "
        f"dF ^ d{' ^ d'.join(constants)} = 0: there is no further analytic constant of motion."
    )
