"""How good is the reference itself?  Two precisions, two orders, and orbits that are known in closed form.

The orbits of verification/reference_orbits.json carry the digits to which two computations agree.  Here three of them
more are made: the free rigid body in Jacobi's elliptic functions, the energy and the Casimirs, and the ensembles'
references (32 digits) against 60.
"""

from __future__ import annotations

import json
from typing import Any

import mpmath
from flint import arb

import liepoisson as lp
from problems import NONLINEAR, TOPS, first_tangents, starts
from reference import DIGITS, FILE, Vector, agreed_digits, decimal_digits, flow
from references import DIGITS as ENSEMBLE_DIGITS
from settings import Settings
from store import Store

T_END = 20.0


def measure(settings: Settings, store: Store) -> dict[str, Any]:
    """Digits of the stored orbits, of the closed form, and of the references of the ensembles."""
    n = settings.choose(quick=1, full=4)
    orbits = json.loads(FILE.read_text(encoding="utf-8"))["orbits"]
    points = [point for orbit in orbits for point in orbit["at"]]
    return {
        "stored": {
            f"{point['t']:g}": min(
                min(other["state digits"], other["tangent digits"]) for other in points if other["t"] == point["t"]
            )
            for point in points
        },
        "orbits": len(orbits),
        "closed form": {f"{t:g}": agreed_digits(*_free_body(t)) for t in (T_END, 5 * T_END)},
        "ensembles": min(_ensemble_digits(top, k) for top in NONLINEAR for k in range(n)),
    }


def _ensemble_digits(top: str, k: int) -> int:
    field = TOPS[top].field()
    assert isinstance(field, lp.fields.TopField)
    start = [*starts(top, k + 1)[k].tolist(), *first_tangents(k + 1)[k].tolist()]
    first, second = (flow(field, start, [T_END], digits=digits)[0] for digits in (ENSEMBLE_DIGITS, DIGITS))
    return min(agreed_digits(first[part], second[part]) for part in (slice(9), slice(9, 18)))


def _free_body(t_end: float) -> tuple[Vector, Vector]:
    """The free rigid body at one time, by the reference integrator and in closed form."""
    inertia, l0 = (3.0, 2.0, 1.0), (0.5, 0.0, 1.5)
    field = lp.fields.TopField(inertia=inertia, a=(0.0, 0.0, 0.0), b=(0.0, 0.0, 0.0), epsilon=0.0)
    (value,) = flow(field, [*l0, *[0.0] * 6], [t_end], digits=50)
    return value[:3], free_rigid_body(inertia, l0, t_end, digits=60)


def free_rigid_body(inertia: tuple[float, ...], l0: tuple[float, ...], t: float, digits: int) -> Vector:
    r"""Euler's top in closed form, for $I_1 > I_2 > I_3$, $\ell_2(0) = 0$, rotating mostly about its third axis.

    $\ell_1 = A_1\,\mathrm{cn}(pt), \ell_2 = A_2\,\mathrm{sn}(pt), \ell_3 = A_3\,\mathrm{dn}(pt)$ with modulus m;
    putting these into $\dot\ell = \ell\times I^{-1}\ell$ gives $A_1 = \ell_1(0)$, $A_3 = \ell_3(0)$, $p =
    A_3\sqrt{(1/I_3 - 1/I_2)(1/I_3 - 1/I_1)}$ and $A_2$, $m$ below [Landau and Lifshitz, Mechanics, section 37].
    """
    with mpmath.workdps(digits):
        r1, r2, r3 = (1 / mpmath.mpf(moment) for moment in inertia)
        A1, A3 = mpmath.mpf(l0[0]), mpmath.mpf(l0[2])
        p = A3 * mpmath.sqrt((r3 - r2) * (r3 - r1))
        A2 = A1 * A3 * (r1 - r3) / p  # d l2/dt = A1 A3 (1/I1 - 1/I3) cn dn
        m = -A1 * A2 * (r2 - r1) / (p * A3)  # d l3/dt = A1 A2 (1/I2 - 1/I1) cn sn
        names = ("cn", "sn", "dn")
        values = [A * mpmath.ellipfun(name, p * t, m=m) for A, name in zip((A1, A2, A3), names, strict=True)]
        with decimal_digits(digits):
            return [arb(mpmath.nstr(value, digits)) for value in values]


def table(result: dict[str, Any]) -> str:
    """Digits, one row for each comparison."""
    rows = [
        (f"{result['orbits']} stored orbits and tangent vectors, t = {t}: 60 against 80 digits, other order", digits)
        for t, digits in result["stored"].items()
    ]
    rows += [
        (f"free rigid body in elliptic functions, t = {t}: 50 digits", digits)
        for t, digits in result["closed form"].items()
    ]
    rows.append(
        (f"references of the ensembles, t = {T_END:g}: {ENSEMBLE_DIGITS} against {DIGITS} digits", result["ensembles"])
    )
    return "\n".join(
        ["| comparison | digits that agree, at least |", "|---|---|", *(f"| {what} | {d} |" for what, d in rows)]
    )
