r"""Euler angles and their momenta: the rotation and the angular momentum, for numbers, arrays and expressions.

The paper's convention (Goldstein): A takes space components to body components, $\ell = L p$, $\beta = A w$,
$\alpha = A v$, with q = (phi, psi, theta) and p = (p_phi, p_psi, p_theta).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias

from liepoisson.formula.parameters import Column

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


@dataclass(frozen=True)
class EulerAngles:
    """Cosines and sines as symbols (c, s with c^2 + s^2 = 1), so that identities reduce to zero exactly."""

    @cached_property
    def phi(self) -> Turn:
        """(cos phi, sin phi)."""
        return _pair("phi")

    @cached_property
    def psi(self) -> Turn:
        """(cos psi, sin psi)."""
        return _pair("psi")

    @cached_property
    def theta(self) -> Turn:
        """(cos theta, sin theta)."""
        return _pair("theta")

    @cached_property
    def momenta(self) -> Column:
        """The column (p_phi, p_psi, p_theta)."""
        from sympy import Matrix, symbols

        return Matrix(symbols("p_phi p_psi p_theta"))

    @cached_property
    def A(self) -> Any:
        """The rotation matrix as printed."""
        from sympy import Matrix

        return Matrix(rotation_rows(self.phi, self.psi, self.theta))

    @cached_property
    def L_inverse(self) -> Any:
        """The inverse of L as printed."""
        from sympy import Matrix

        (cp, sp), (ct, st) = self.psi, self.theta
        return Matrix([[st * sp, st * cp, ct], [0, 0, 1], [cp, -sp, 0]])

    @cached_property
    def L(self) -> Any:
        """The matrix L itself, from its printed inverse."""
        return self.L_inverse.inv().applyfunc(self.reduce)

    def reduce(self, expression: Any) -> Any:
        """A normal form: cos^2 replaced by 1 - sin^2 above and below the fraction line, common factors out."""
        from sympy import cancel, fraction, together

        numerator, denominator = fraction(together(expression))
        return cancel(self._without_squares(numerator) / self._without_squares(denominator))

    def bracket(self, f: Any, g: Any) -> Any:
        """The canonical bracket, the sum of df/dq dg/dp - df/dp dg/dq over the three pairs."""
        pairs = ((k, k + 3) for k in range(3))
        return sum(
            self.derivative(f, q) * self.derivative(g, p) - self.derivative(f, p) * self.derivative(g, q)
            for q, p in pairs
        )

    def _without_squares(self, polynomial: Any) -> Any:
        from sympy import Poly, expand

        result = expand(polynomial)
        for cosine, sine in (self.phi, self.psi, self.theta):
            if result.has(cosine):
                terms = Poly(result, cosine).terms()
                result = expand(sum(c * (1 - sine**2) ** (k // 2) * cosine ** (k % 2) for (k,), c in terms))
        return result

    def derivative(self, f: Any, coordinate: int) -> Any:
        """The partial derivative along q (0, 1, 2) or p (3, 4, 5)."""
        if coordinate >= 3:
            return f.diff(self.momenta[coordinate - 3])
        cosine, sine = (self.phi, self.psi, self.theta)[coordinate]
        return f.diff(sine) * cosine - f.diff(cosine) * sine


def _pair(angle: str) -> Turn:
    from sympy import symbols

    return symbols(f"c_{angle} s_{angle}")
