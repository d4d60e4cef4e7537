r"""The ordinary Lagrange top with one degree of freedom: the nutation in an effective potential.

$$H = \frac{p_\theta^2}{2I_1} + U(\theta), \qquad
  U = \frac{(\ell_n - \ell_3\cos\theta)^2}{2I_1\sin^2\theta} + \frac{\ell_3^2}{2I_3} + a_3|\alpha|\cos\theta .$$
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from liepoisson.algebra.exact_numbers import as_float, to_sympy
from liepoisson.errors import ChartError, ParameterError, ShapeError
from liepoisson.formula.parameters import Parameter, read_parameter
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.model.canonical_system import CanonicalSystem
from liepoisson.model.charts.euler_angles import angular_momentum
from liepoisson.model.charts.euler_chart import NEAREST
from liepoisson.model.charts.lagrange_reduction import check_l3, check_lagrange, conserved_l3, cyclic_angle
from liepoisson.model.charts.leaf_constants import COMPONENTS, FIELDS, chart_points, dot, refuse, top_of, vectors
from liepoisson.model.hamiltonian import symbols_in
from liepoisson.portable import elementary, linear

if TYPE_CHECKING:
    from sympy import Expr

_TRY = "Integrate the top itself there."


@explains_its_methods
class OrdinaryLagrange:
    r"""The Lagrange top in one field, on the invariant set beta = 0: theta alone, with two cyclic angles.

    $\alpha = |\alpha|\,(\sin\psi\sin\theta, \cos\psi\sin\theta, \cos\theta)$; the conserved momenta are
    $p_\psi = \ell_3$ and $p_\phi = \ell_n = \ell\cdot\alpha/|\alpha|$.  Twist and charge do not act where beta = 0.
    Where $\sin\theta = 0$ the chart ends; orbits with $\ell_n\neq\pm\ell_3$ never come there.

    Example:
        >>> lp.charts.OrdinaryLagrange(lp.Top.lagrange()).effective_potential
        alpha*cos(theta) + l3**2 + (-l3*cos(theta) + l_n)**2/(2*sin(theta)**2)

    Args:
        system: A Lagrange top.
        l3: The third component of the angular momentum.
        l_n: The component of the angular momentum along alpha.
        alpha: The length of alpha.
        state: Instead of the three, one with beta = 0, shape (9,).  If nothing is given, all stay symbols.
        with_cyclic_angle: Append psi to the state.

    Raises:
        ParameterError: the system is no Lagrange top, or values are missing or given twice.
        ShapeError: `state` is not one state.
        ChartError: `state` has beta != 0 or alpha = 0.
    """

    conditions = ("alpha != 0", "sin(theta) != 0")

    def __init__(
        self,
        system: Any,
        *,
        l3: Parameter | None = None,
        l_n: Parameter | None = None,
        alpha: Parameter | None = None,
        state: ArrayLike | None = None,
        with_cyclic_angle: bool = False,
    ) -> None:
        self.top = top_of(system)
        check_lagrange(self.top)
        self.name: str = f"{system.name}, one degree of freedom"
        self.with_cyclic_angle: bool = with_cyclic_angle
        values: dict[str, Any] = {"l3": l3, "l_n": l_n, "alpha": alpha}
        given = [name for name, value in values.items() if value is not None]
        if given and (len(given) < 3 or state is not None):
            raise ParameterError(
                f"the reduction needs l3, l_n and alpha, or a state; got {', '.join(given)}"
                f"{' and a state' if state is not None else ''}. Give all three, or the state alone."
            )
        numbers = _of_state(state) if state is not None else values
        self.l3: Expr = conserved_l3(numbers["l3"], None, symbolic=True)
        self.l_n: Expr = to_sympy(read_parameter("l_n" if numbers["l_n"] is None else numbers["l_n"], "l_n"))
        self.length: Expr = to_sympy(read_parameter("alpha" if numbers["alpha"] is None else numbers["alpha"], "alpha"))

    @property
    def component_names(self) -> tuple[str, ...]:
        """Names of the components of the state."""
        return ("theta", "p_theta", *(("psi",) if self.with_cyclic_angle else ()))

    @cached_property
    def effective_potential(self) -> Expr:
        r"""$U(\theta)$, with the constant $\ell_3^2/2I_3$."""
        from sympy import cos, sin

        transverse, axial, a3, l3, l_n, length, theta = self._expressions
        centrifugal = (l_n - l3 * cos(theta)) ** 2 / (2 * transverse * sin(theta) ** 2)
        return centrifugal + l3**2 / (2 * axial) + a3 * length * cos(theta)

    @cached_property
    def hamiltonian(self) -> Expr:
        r"""$H = p_\theta^2/2I_1 + U(\theta)$."""
        from sympy import Symbol

        p_theta: Any = Symbol("p_theta")
        return p_theta**2 / (2 * self._expressions[0]) + self.effective_potential

    @cached_property
    def rate_of_psi(self) -> Expr:
        r"""$\dot\psi = \ell_3/I_3 - \cos\theta\,(\ell_n - \ell_3\cos\theta)/(I_1\sin^2\theta)$."""
        from sympy import cos, sin

        transverse, axial, _, l3, l_n, _, theta = self._expressions
        return l3 / axial - cos(theta) * (l_n - l3 * cos(theta)) / (transverse * sin(theta) ** 2)

    @cached_property
    def system(self) -> CanonicalSystem:
        """The reduced system, followed by psi if it was asked for."""
        quadratures = {"psi": self.rate_of_psi} if self.with_cyclic_angle else None
        coordinates, momenta = ("theta",), ("p_theta",)
        symbols = symbols_in(self.hamiltonian, (*coordinates, *momenta))
        return CanonicalSystem(
            coordinates, momenta, self.hamiltonian, quadratures=quadratures, symbols=symbols, name=self.name
        )

    def to_body(self, z: ArrayLike, psi: ArrayLike | None = None) -> Array:
        """States (l, alpha, 0), shape (..., 9), from reduced states, shape (..., 2), or (..., 3) with psi.

        Raises:
            ParameterError: psi is missing or given twice, or a constant is symbolic.
            ChartError: sin(theta) = 0.
            ShapeError: the last axis of `z` has another length.
        """
        points = chart_points(z, self.component_names, self.component_names)
        angle = cyclic_angle(points[..., 2:], psi, points.shape[:-1])
        (cp, sp), (ct, st) = ((elementary.cos(value), elementary.sin(value)) for value in (angle, points[..., 0]))
        sine = np.abs(st)
        refuse(sine == 0, sine, self.conditions[1], self.conditions[1], quantity="sin(theta)", hint=_TRY)
        l3, l_n, length = self._numbers
        shape = points.shape[:-1]
        l = angular_momentum((cp, sp), (ct, st), [np.full(shape, l_n), np.full(shape, l3), points[..., 1]])
        alpha = [length * sp * st, length * cp * st, length * ct]
        return np.stack([*l, *alpha, *(np.zeros(shape) for _ in range(3))], axis=-1)

    def from_body(self, states: ArrayLike) -> Array:
        """Reduced states, shape (..., 2), or (..., 3) with psi, of states with beta = 0, shape (..., 9).

        Raises:
            ChartError: beta != 0, sin(theta) = 0, or another l3, l_n or |alpha| than those of the reduction.
        """
        states = chart_points(states, COMPONENTS, FIELDS)
        l, alpha, _ = vectors(states)
        check_beta_is_zero(states)
        margins = self.margins(states)
        for condition, quantity in zip(self.conditions, ("|alpha|", "sin(theta)"), strict=True):
            refuse(
                margins[condition] <= NEAREST, margins[condition], condition, condition, quantity=quantity, hint=_TRY
            )
        check_l3(states, self.l3)
        _, l_n, length = self._numbers
        size = linear.norm(alpha, axis=-1)
        along = dot(l, alpha) / size
        for name, value, wanted in (("|alpha|", size, length), ("l.alpha/|alpha|", along, l_n)):
            far = np.abs(value - wanted) > 1e-8 * (abs(wanted) + linear.norm(l, axis=-1) + size)
            hint = "Reduce with state=state for that state."
            refuse(far, value, "on the leaf", f"{name} = {wanted:.9g}", quantity=name, hint=hint)
        n1, n2, n3 = (alpha[..., k] / size for k in range(3))
        horizontal = elementary.hypot(n1, n2)
        p_theta = (n2 * l[..., 0] - n1 * l[..., 1]) / horizontal
        parts = [elementary.arctan2(horizontal, n3), p_theta, elementary.arctan2(n1, n2)]
        return np.stack(parts[: len(self.component_names)], axis=-1)

    def margins(self, states: ArrayLike) -> dict[str, Array]:
        r"""How far states are from where the chart ends: $|\alpha|$ and $\sin\theta$, each of shape (...)."""
        _, alpha, _ = vectors(chart_points(states, COMPONENTS, FIELDS))
        size = linear.norm(alpha, axis=-1)
        sine = np.divide(elementary.hypot(alpha[..., 0], alpha[..., 1]), size, out=np.zeros_like(size), where=size != 0)
        return {name: np.asarray(value) for name, value in zip(self.conditions, (size, sine), strict=True)}

    @property
    def _numbers(self) -> tuple[float, float, float]:
        return as_float(self.l3, "l3"), as_float(self.l_n, "l_n"), as_float(self.length, "alpha")

    @property
    def _expressions(self) -> tuple[Any, ...]:
        from sympy import Symbol

        transverse, _, axial = (to_sympy(value) for value in self.top.inertia)
        return transverse, axial, to_sympy(self.top.a[2]), self.l3, self.l_n, self.length, Symbol("theta")

    def __repr__(self) -> str:
        return f"<OrdinaryLagrange {self.name!r}>"


def _of_state(given: ArrayLike) -> dict[str, float]:
    state = chart_points(given, COMPONENTS, FIELDS, "state")
    if state.ndim != 1:
        raise ShapeError(
            f"state must be one state of shape (9,); got shape {state.shape}. Reduce each state by itself."
        )
    check_beta_is_zero(state)
    l, alpha, _ = vectors(state)
    length = float(linear.norm(alpha))
    if not length > 0:
        raise ChartError(f"the reduction needs alpha != 0; got |alpha| = {length:.3g}. {_TRY}", "alpha != 0")
    return {"l3": float(l[2]), "l_n": float(linear.matmul(l, alpha)) / length, "alpha": length}


def check_beta_is_zero(states: Array) -> None:
    """Refuse states with a second field.

    Raises:
        ChartError: with the condition "beta = 0".
    """
    size = linear.norm(vectors(states)[2], axis=-1)
    refuse(size != 0, size, "beta = 0", "beta = 0", quantity="|beta|", hint="Use ReducedLagrange.")
