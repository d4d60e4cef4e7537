r"""Euler angles and their momenta: the rotation and the angular momentum, for numbers, arrays and expressions.

The paper's convention (Goldstein): A takes space components to body components, $\ell = L p$, $\beta = A w$,
$\alpha = A v$, with q = (phi, psi, theta) and p = (p_phi, p_psi, p_theta).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

Turn: TypeAlias = tuple[Any, Any]
"""The cosine and the sine of an angle."""


def rotation_rows(phi: Turn, psi: Turn, theta: Turn) -> list[list[Any]]:
    """The rows of the paper's matrix A, from cosines and sines of any kind (symbols, expressions, arrays)."""
    (cf, sf), (cp, sp), (ct, st) = phi, psi, theta
    return [
        [cp * cf - ct * sf * sp, cp * sf + ct * cf * sp, sp * st],
        [-sp * cf - ct * sf * cp, -sp * sf + ct * cf * cp, cp * st],
        [st * sf, -st * cf, ct],
    ]


def angular_momentum(psi: Turn, theta: Turn, momenta: Sequence[Any]) -> list[Any]:
    r"""The three components of $\ell = Lp$, with p = (p_phi, p_psi, p_theta)."""
    (cp, sp), (ct, st) = psi, theta
    p_phi, p_psi, p_theta = momenta
    horizontal = (p_phi - p_psi * ct) / st
    return [sp * horizontal + cp * p_theta, cp * horizontal - sp * p_theta, p_psi]


def momenta_of(psi: Turn, theta: Turn, l: Sequence[Any]) -> list[Any]:
    r"""The momenta $p = L^{-1}\ell$, with the paper's matrix $L^{-1}$; $\det L^{-1} = \sin\theta$."""
    (cp, sp), (ct, st) = psi, theta
    return [st * (sp * l[0] + cp * l[1]) + ct * l[2], l[2], cp * l[0] - sp * l[1]]
