"""Singularities in complex time: which twisted tops have single-valued solutions only.

S. Kovalevskaya, Acta Mathematica 12 (1889) 177; A. M. Lyapunov, Communications of the Kharkov Mathematical Society 4
(1894) 123: all solutions of a heavy top are single-valued in the cases of Euler, Lagrange and Kovalevskaya only.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from liepoisson.integrability.painleve.balance import Balance
from liepoisson.integrability.painleve.singularity_analysis import PainleveTest, painleve_test
from liepoisson.model.system import System
from liepoisson.studies.twisted_top.claims.evidence import Evidence
from liepoisson.studies.twisted_top.claims.model import Claim, Context, Verdict
from liepoisson.studies.twisted_top.claims.phase_space import symbolic_top
from liepoisson.studies.twisted_top.claims.typography import typeset

_KOVALEVSKAYA = (2, 2, 1)
_EQUATORIAL, _ACROSS, _NONE = (-1, 0, 0), (0, 1, 0), (0, 0, 0)


def single_valued_tops(context: Context) -> Verdict:
    """No twisted top but Lagrange's has single-valued solutions only."""
    evidence = Evidence()
    evidence.note(
        "Let all solutions of a twisted top (ε ≠ 0) be single-valued functions of complex time. β = 0 leaves the heavy "
        "top (I, a), so by Lyapunov’s theorem (1894) it is Euler’s (a = 0), Lagrange’s or Kovalevskaya’s."
    )
    evidence.note(
        "α → α + cβ keeps the bracket and takes b to b + ca: only the part of b across a matters. Scalings of l, α, β "
        "and t take every ε ≠ 0, and every length of a and of b ≠ 0 across a, to 1."
    )
    evidence.note(
        "If b is not along a, let ε → 0 (such scalings), and α = xγ, β = yγ: the heavy top with xa + yb in the place "
        "of a must have single-valued solutions for all x, y. So the top is spherical, or Kovalevskaya’s with a and b "
        "equatorial. With a = 0, (l, β) is a heavy top and α follows linearly: the twist is inert."
    )
    cases = (
        ("I = (2, 2, 1), a equatorial, b = 0 (or b along a): Kovalevskaya’s", _KOVALEVSKAYA, _NONE),
        ("I = (2, 2, 1), a and b equatorial, across each other", _KOVALEVSKAYA, _ACROSS),
        ("I = (1, 1, 1), b across a", (1, 1, 1), _ACROSS),
    )
    for what, inertia, b in cases:
        found = _test(context, inertia, _EQUATORIAL, b)
        failing = next((balance for balance in found.balances if balance.status == "fails"), None)
        evidence.equal(f"{what}, ε = 1: the test", found.verdict, "fails", _shown(failing), decisive=True)
        if b != _NONE:
            without = _test(context, inertia, _EQUATORIAL, b, epsilon=0)
            evidence.equal("the same for ε = 0", without.verdict, "passes")
    lagrange = _test(context, ("I1", "I1", "I3"), (0, 0, 1), _NONE, epsilon="epsilon")
    evidence.equal(
        "I = (I₁, I₁, I₃), a = (0, 0, 1), b = 0, any ε: Lagrange’s, the test", lagrange.verdict, "passes",
        [_exponents(balance) for balance in lagrange.balances[:1]],
    )  # fmt: skip
    evidence.data = {"tests": {what: "fails" for what, _, _ in cases} | {"Lagrange": lagrange.verdict}}
    return evidence.conclude(
        "incomplete",
        "The analysis is made here, and it finds none: a twisted top all of whose solutions are single-valued in "
        "complex time is Lagrange’s, with b along a (the spherical top with b along a included), or has a = 0 and (I, "
        "b) of Euler, Lagrange or Kovalevskaya, where the twist is inert. Integrals that are not single-valued are not "
        "excluded by it.",
    )


def _test(
    context: Context, inertia: Sequence[Any], a: Sequence[Any], b: Sequence[Any], *, epsilon: Any = 1
) -> PainleveTest:
    top = symbolic_top(context, inertia=inertia, a=a, b=b, epsilon=epsilon)
    free = sorted(map(str, top.hamiltonian.free_symbols - set(top.bracket.variables)))
    names = [*free, *([epsilon] if isinstance(epsilon, str) else [])]
    return painleve_test(System(top.bracket, top.hamiltonian, symbols=names))


def _shown(balance: Balance | None) -> list[str]:
    if balance is None:
        return []
    obstructions = [typeset(line) for line in balance.obstructions]
    free = [name for name in map(typeset, balance.family) if any(name in line for line in obstructions)]
    if free:
        obstructions.append(
            f"{' and '.join(free)}: leading coefficient{'s' * (len(free) > 1)} that the balance leaves free"
        )
    return [_exponents(balance), *obstructions]


def _exponents(balance: Balance) -> str:
    return typeset(f"exponents {', '.join(map(str, balance.exponents))}")


CLAIMS: tuple[Claim, ...] = (
    Claim(
        "kovalevskaya-painleve",
        "Section 5, Discussion, third paragraph",
        "A Kovalevskaya–Painlevé analysis could determine other integrable limits of the twisted top.",
        single_valued_tops,
        words="Another approach would be to use a Kovalevskaya–Painlevé analysis to determine other integrable limits "
        "of the twisted top.",
    ),
)
