r"""The paper's map from canonical coordinates to a leaf, with its square root as a symbol, for exact proofs.

The Euler angles and their momenta are those of `liepoisson.model.charts.euler_angles`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from liepoisson.formula.parameters import Column
from liepoisson.model.charts.euler_angles import EulerAngles


@dataclass(frozen=True)
class CanonicalChart:
    r"""The paper's map (q, p) -> (l, alpha, beta) on a leaf, for a choice of the two space-fixed unit vectors.

    $\beta = w A \hat e_\parallel$, $\alpha = A(v \hat e_\parallel + r \hat e_\perp)$ with
    $r = \sqrt{\eta - 2\epsilon\,\ell\cdot\beta}$.  r is kept as a symbol, and its square is inserted when reducing.

    Attributes:
        parallel: The unit vector along beta, in space.
        perpendicular: A unit vector orthogonal to it.
        epsilon: Strength of the cocycle.
    """

    parallel: Sequence[Any]
    perpendicular: Sequence[Any]
    epsilon: Any

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
    def angular_momentum(self) -> Column:
        """The angular momentum l = L p."""
        return self.angles.L * self.angles.momenta

    @cached_property
    def beta(self) -> Column:
        """The second field."""
        from sympy import Matrix

        _, w, _, _ = self.constants
        return w * self.angles.A * Matrix(self.parallel)

    @cached_property
    def alpha(self) -> Column:
        """The first field."""
        from sympy import Matrix

        v, _, _, r = self.constants
        return self.angles.A * (v * Matrix(self.parallel) + r * Matrix(self.perpendicular))

    @cached_property
    def r_squared(self) -> Any:
        """The square of r as a function of (q, p)."""
        return self.constants[2] - 2 * self.epsilon * self.angles.reduce(self.angular_momentum.dot(self.beta))

    def reduce(self, expression: Any) -> Any:
        """A normal form: even powers of r inserted, then the trigonometric normal form."""
        from sympy import Poly, expand, fraction, together

        r = self.constants[3]
        numerator, denominator = fraction(together(expression))
        terms = Poly(expand(numerator), r).terms()
        inserted = sum(c * self.r_squared ** (k // 2) * r ** (k % 2) for (k,), c in terms)
        return self.angles.reduce(inserted / denominator)
