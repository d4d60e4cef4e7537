r"""The paper's Euler angles and its map from canonical coordinates to a leaf, in symbols, for exact proofs.

The paper's convention (Goldstein): A takes space components to body components, $\ell = L p$, $\beta = A w$,
$\alpha = A v$, with q = (phi, psi, theta) and p = (p_phi, p_psi, p_theta).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from liepoisson.studies.twisted_top.claims.phase_space import column


class EulerAngles:
    """Cosines and sines as symbols (c, s with c^2 + s^2 = 1), so that identities reduce to zero exactly."""

    def __init__(self) -> None:
        from sympy import Matrix, symbols

        self.phi, self.psi, self.theta = (symbols(f"c_{angle} s_{angle}") for angle in ("phi", "psi", "theta"))
        (cf, sf), (cp, sp), (ct, st) = self.phi, self.psi, self.theta
        self.momenta: Any = column(*symbols("p_phi p_psi p_theta"))
        self.A: Any = Matrix(
            [
                [cp * cf - ct * sf * sp, cp * sf + ct * cf * sp, sp * st],
                [-sp * cf - ct * sf * cp, -sp * sf + ct * cf * cp, cp * st],
                [st * sf, -st * cf, ct],
            ]
        )
        self.L_inverse: Any = Matrix([[st * sp, st * cp, ct], [0, 0, 1], [cp, -sp, 0]])

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
        return sum(
            self.derivative(f, k) * self.derivative(g, k + 3) - self.derivative(f, k + 3) * self.derivative(g, k)
            for k in range(3)
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


@dataclass(frozen=True)
class CanonicalChart:
    r"""The paper's map (q, p) -> (l, alpha, beta) on a leaf, for a choice of the two space-fixed unit vectors.

    $\beta = w A \hat e_\parallel$, $\alpha = A(v \hat e_\parallel + r \hat e_\perp)$ with
    $r = \sqrt{\eta - 2\epsilon\,\ell\cdot\beta}$.  r is kept as a symbol, and its square is inserted when reducing.
    """

    parallel: Sequence[int]  # the unit vector along beta, in space
    perpendicular: Sequence[int]  # a unit vector orthogonal to it

    @cached_property
    def angles(self) -> EulerAngles:
        """The Euler angles."""
        return EulerAngles()

    @cached_property
    def constants(self) -> tuple[Any, Any, Any, Any]:
        """The symbols v, w, eta and r."""
        from sympy import symbols

        return symbols("v w eta r")

    @cached_property
    def angular_momentum(self) -> Any:
        """The angular momentum l = L p."""
        return self.angles.L * self.angles.momenta

    @cached_property
    def beta(self) -> Any:
        """The second field."""
        _, w, _, _ = self.constants
        return w * self.angles.A * column(*self.parallel)

    @cached_property
    def alpha(self) -> Any:
        """The first field."""
        v, _, _, r = self.constants
        return self.angles.A * (v * column(*self.parallel) + r * column(*self.perpendicular))

    @cached_property
    def r_squared(self) -> Any:
        """The square of r as a function of (q, p)."""
        from sympy import Symbol

        along = self.angles.reduce(self.angular_momentum.dot(self.beta))
        return self.constants[2] - 2 * Symbol("epsilon") * along

    def reduce(self, expression: Any) -> Any:
        """A normal form: even powers of r inserted, then the trigonometric normal form."""
        from sympy import Poly, expand, fraction, together

        r = self.constants[3]
        numerator, denominator = fraction(together(expression))
        terms = Poly(expand(numerator), r).terms()
        inserted = sum(c * self.r_squared ** (k // 2) * r ** (k % 2) for (k,), c in terms)
        return self.angles.reduce(inserted / denominator)
