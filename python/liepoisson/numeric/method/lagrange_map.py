"""The Lagrange top in discrete time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from liepoisson.compile.field import TopField
from liepoisson.errors import ParameterError, ShapeError
from liepoisson.formula.scalars import as_array
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.inputs.refusals import shown
from liepoisson.numeric.method.method import MAX_STEPS, Method
from liepoisson.numeric.systems import TOP_COMPONENTS


@explains_its_methods
@dataclass(frozen=True)
class LagrangeMap(Method):
    r"""The (charged, twisted) Lagrange top in discrete time: an integrable Poisson map, of order 2.

    For tops with $I_1 = I_2$ and with a and b along the third axis.  As `Splitting(order=2)`, but $\alpha$ and $\beta$
    turn about $\ell$ by $2\arctan(h|\ell|/2I_1)$, which is the flow of another function of $|\ell|$.  Besides the
    Casimirs and $\ell_3$ it keeps deformed integrals, to round-off: with $s = a_3I_1$, $u = \epsilon a_3^2I_1^2$,
    $k = -h/2I_1$, and with a half kick by the potential taken back, the coefficients of $|L(z)|^2$ in

    $$L(z) = (e_3 + k\,\ell\times e_3 + k^2s\,\alpha) + (\ell + k^2u\,\beta)/z + s\,\alpha/z^2 + u\,\beta/z^3,$$

    which for $h\to0$ are those of the Lax matrix of the top.  `integrals` computes them.

    Example:
        >>> top, map = lp.Top.lagrange(), lp.methods.LagrangeMap(step=0.5)
        >>> run = lp.integrate(top, {"l": (0.5, 0, 1), "alpha": (0.6, 0, 0.8)}, times=[0, 5000], method=map)
        >>> change = map.integrals(top, run.state[0, 1]) - map.integrals(top, run.state[0, 0])
        >>> bool(np.abs(change).max() < 1e-11)  # after 10,000 long steps
        True

    Args:
        step: Largest step, in units of the system's own time; steps are equal and end at every wanted time.
        max_steps: Most steps that one trajectory may take.

    Raises:
        ParameterError: A value outside its range.

    References:
        Bobenko and Suris, Commun. Math. Phys. 204 (1999) 147, for $\epsilon = 0$; for the twisted top, the Lax pair
        above (docs/methods.md derives it).
    """

    name: ClassVar[str] = "lagrange-map"

    step: float
    max_steps: int = MAX_STEPS

    def integrals(self, top: Any, states: ArrayLike) -> Array:
        r"""The integrals of the map: coefficients of $z^0, z^{-1}, \dots, z^{-6}$ in $|L(z)|^2$.

        Args:
            top: A top with $I_1 = I_2$, and with a and b along the third axis, $a \ne 0$.
            states: States, shape (..., 9), dimensionless.

        Returns:
            Shape (..., 7); exact for steps of exactly `step`.

        Raises:
            ParameterError: Another top.
            ShapeError: The last axis of `states` is not 9.
        """
        field = top.field() if callable(getattr(top, "field", None)) else None
        if not isinstance(field, TopField) or not is_lagrange(field) or field.a[2] == 0.0:
            raise ParameterError(f"integrals: {NOT_LAGRANGE}, a not zero; got {shown(top)}")
        states = as_array(states, "states", TOP_COMPONENTS)
        if states.ndim == 0 or states.shape[-1] != 9:
            raise ShapeError(
                f"states must end in 9 components (l, alpha, beta); got shape {states.shape}. Transpose it?"
            )
        return _lax_coefficients(field, self.step, states)

    def __str__(self) -> str:
        return f"discrete Lagrange top, step {self.step:g}"


NOT_LAGRANGE = "wanted a top with I1 = I2 and with a and b along the third axis"


def is_lagrange(field: TopField) -> bool:
    """Whether the field is that of a Lagrange top."""
    return field.inertia[0] == field.inertia[1] and not any((*field.a[:2], *field.b[:2]))


def _lax_coefficients(field: TopField, h: float, x: Array) -> Array:
    """See `LagrangeMap.integrals`."""
    axis = np.array([0.0, 0.0, 1.0])
    a3, inertia = field.a[2], field.inertia[0]
    beta = x[..., 6:]
    alpha = x[..., 3:6] + field.b[2] / a3 * beta
    # half a kick back: alpha += t eps beta x a, l += t (mean of alpha) x a
    earlier = alpha - h / 2 * field.epsilon * a3 * np.cross(beta, axis)
    l = x[..., :3] - h / 4 * a3 * np.cross(alpha + earlier, axis)
    s, u, k = a3 * inertia, field.epsilon * a3**2 * inertia**2, -h / (2 * inertia)
    terms = [axis + k * np.cross(l, axis) + k**2 * s * earlier, l + k**2 * u * beta, s * earlier, u * beta]
    products = [[(u * v).sum(-1) for v in terms] for u in terms]
    sums = [sum(products[i][m - i] for i in range(4) if 0 <= m - i < 4) for m in range(7)]
    return np.stack(np.broadcast_arrays(*sums), axis=-1)
