r"""Reduced Lagrange tops: the twisted and charged one with two degrees of freedom, the ordinary one with one.

In the gauge $(e_3, e_1)$ the angle psi does not occur and $p_\psi = \ell_3$ is constant:

$$H = \frac{p_\theta^2}{2I_1} + \frac{(p_\phi - \ell_3\cos\theta)^2}{2I_1\sin^2\theta} + \frac{\ell_3^2}{2I_3}
  + (a_3v + b_3w)\cos\theta + a_3\,r\sin\theta\sin\phi, \qquad r^2 = \eta - 2\epsilon w\,p_\phi .$$

On beta = 0, with the length of alpha, only the nutation is left, in an effective potential:

$$H = \frac{p_\theta^2}{2I_1} + U(\theta), \qquad
  U = \frac{(\ell_n - \ell_3\cos\theta)^2}{2I_1\sin^2\theta} + \frac{\ell_3^2}{2I_3} + a_3|\alpha|\cos\theta .$$
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from liepoisson.algebra.exact_numbers import as_float, is_zero, to_sympy
from liepoisson.errors import ChartError, ParameterError, ShapeError
from liepoisson.formula.parameters import Parameter, read_parameter
from liepoisson.formula.scalars import as_array
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.model.canonical_system import CanonicalSystem
from liepoisson.model.charts.euler_chart import NEAREST, EulerChart, angular_momentum
from liepoisson.model.charts.leaf_constants import (
    COMPONENTS,
    FIELDS,
    GivenLeaf,
    chart_points,
    decimal,
    dot,
    refuse,
    top_of,
    vectors,
)
from liepoisson.model.hamiltonian import symbols_in
from liepoisson.model.top_parameters import TopParameters
from liepoisson.portable import elementary, linear

if TYPE_CHECKING:
    from sympy import Expr


def check_lagrange(top: TopParameters) -> None:
    """Refuse tops without a symmetry axis.

    Raises:
        ParameterError: the first two moments differ, or a or b is not along the third axis.
    """
    first, second, _ = (to_sympy(value) for value in top.inertia)
    off_axis = [value for vector in (top.a, top.b) for value in vector[:2] if not is_zero(value)]
    if first != second or off_axis:
        raise ParameterError(
            "the reduction needs a Lagrange top: I1 = I2 and a, b along the third axis; got "
            f"{top.describe()}. Use EulerChart for other tops."
        )


def conserved_l3(l3: Parameter | None, state: ArrayLike | None, *, symbolic: bool) -> Any:
    """The value of l3: as given, from the state, or a symbol.

    Raises:
        ParameterError: it is given twice, or missing beside a leaf.
    """
    if state is not None and l3 is not None:
        raise ParameterError("l3 is known from the state; got both. Leave l3 out.")
    if state is not None:
        return to_sympy(read_parameter(float(as_array(state, "state", COMPONENTS)[2]), "l3"))
    if l3 is None and not symbolic:
        raise ParameterError("the reduction needs l3 beside the leaf; got none. Give l3=, or a state with state=.")
    return to_sympy(read_parameter("l3" if l3 is None else l3, "l3"))


def cyclic_angle(within: Array, given: ArrayLike | None, shape: tuple[int, ...]) -> Array:
    """The angle psi: the last component of the states, or as given beside them.

    Raises:
        ParameterError: neither or both.
        ShapeError: another shape.
    """
    if (given is None) == (within.shape[-1] == 0):
        raise ParameterError(
            "the state in the body needs psi once; got it "
            + ("not at all. Give psi=, or reduce with_cyclic_angle=True." if given is None else "twice. Leave psi out.")
        )
    if given is None:
        return within[..., 0]
    angle = as_array(given, "psi")
    try:
        return np.broadcast_to(angle, shape)
    except ValueError:
        raise ShapeError(f"psi must have shape {shape}, one for each state; got shape {angle.shape}.") from None


def check_l3(states: Array, l3: Expr) -> None:
    """Refuse states with another l3 than that of the reduction.

    Raises:
        ChartError: with the condition "l3".
    """
    wanted, l = as_float(l3, "l3"), states[..., :3]
    size = 1e-8 * (linear.norm(l, axis=-1) + abs(wanted) + 1e-300)
    hint = "Reduce with state=state for that state."
    refuse(np.abs(l[..., 2] - wanted) > size, l[..., 2], "l3", f"l3 = {wanted:.9g}", quantity="l3", hint=hint)


class _Reduction(ABC):
    """A system in coordinates and momenta, without the cyclic angle psi or with it as a quadrature."""

    coordinates: ClassVar[tuple[str, ...]]
    momenta: ClassVar[tuple[str, ...]]
    with_cyclic_angle: bool
    name: str

    @cached_property
    @abstractmethod
    def hamiltonian(self) -> Expr:
        """The reduced Hamiltonian."""

    @cached_property
    @abstractmethod
    def rate_of_psi(self) -> Expr:
        """The rate of the cyclic angle."""

    @property
    def component_names(self) -> tuple[str, ...]:
        """Names of the components of the state."""
        return (*self.coordinates, *self.momenta, *(("psi",) if self.with_cyclic_angle else ()))

    @cached_property
    def system(self) -> CanonicalSystem:
        """The reduced system, followed by psi if it was asked for."""
        quadratures = {"psi": self.rate_of_psi} if self.with_cyclic_angle else None
        symbols = symbols_in(self.hamiltonian, (*self.coordinates, *self.momenta))
        return CanonicalSystem(
            self.coordinates, self.momenta, self.hamiltonian, quadratures=quadratures, symbols=symbols, name=self.name
        )


@explains_its_methods
class ReducedLagrange(_Reduction):
    r"""The twisted (or charged) Lagrange top, $I_1 = I_2$ with a and b along the axis, with psi reduced away.

    Coordinates (phi, theta) with momenta (p_phi, p_theta), at fixed $\ell_3 = p_\psi$ and Casimirs; the gauge is
    $(e_3, e_1)$, in which $\ell\cdot\beta = w p_\phi$.  The domain is that of `EulerChart`.  On beta = 0 one degree of
    freedom is left: `OrdinaryLagrange`.

    Example:
        >>> chart = lp.charts.ReducedLagrange(lp.Top.twisted_lagrange())
        >>> chart.component_names, chart.rate_of_psi
        (('phi', 'theta', 'p_phi', 'p_theta'), 2*l3 - (-l3*cos(theta) + p_phi)*cos(theta)/sin(theta)**2)

    Args:
        system: A Lagrange top, twisted or charged.
        l3: The conserved third component of the angular momentum, if no state is given.
        leaf: A `Leaf`, or the values of C1, C2, C3 of the bracket of the system; l3 is not known from it.
        state: Instead of both, a state, shape (9,).  If nothing is given, l3, v, w and eta stay symbols.
        with_cyclic_angle: Append psi to the state, $\dot\psi = \partial H/\partial p_\psi$, so that the state in the
            body is known.

    Raises:
        ParameterError: the system is no such top, or l3 is given twice or missing.
        ShapeError: `state` is not one state.
        ChartError: the leaf has beta = 0.
    """

    coordinates, momenta = ("phi", "theta"), ("p_phi", "p_theta")

    def __init__(
        self,
        system: Any,
        *,
        l3: Parameter | None = None,
        state: ArrayLike | None = None,
        leaf: GivenLeaf | Mapping[str, Parameter] | None = None,
        with_cyclic_angle: bool = False,
    ) -> None:
        check_lagrange(top_of(system))
        state = None if state is None else as_array(state, "state", COMPONENTS)  # once, as it is read twice
        self.chart: EulerChart = EulerChart(system, leaf=leaf, state=state, gauge="e3, e1")
        self.l3: Expr = conserved_l3(l3, state, symbolic=leaf is None)
        self.with_cyclic_angle: bool = with_cyclic_angle
        self.name: str = f"{system.name}, reduced"

    @property
    def conditions(self) -> tuple[str, ...]:
        """The conditions of the domain."""
        return self.chart.conditions

    @cached_property
    def hamiltonian(self) -> Expr:
        """The reduced Hamiltonian, in which p_psi is the constant l3."""
        return self._at_l3(self.chart.hamiltonian)

    @cached_property
    def rate_of_psi(self) -> Expr:
        r"""$\dot\psi = \partial H/\partial p_\psi$, a function of (phi, theta, p_phi, p_theta)."""
        H: Any = self.chart.hamiltonian
        return self._at_l3(H.diff(self._p_psi))

    def to_body(self, z: ArrayLike, psi: ArrayLike | None = None) -> Array:
        """States (l, alpha, beta), shape (..., 9).

        Args:
            z: Reduced states, shape (..., 4), or (..., 5) with the cyclic angle.
            psi: The cyclic angle, shape (...), where the state does not contain it.

        Raises:
            ParameterError: psi is missing or given twice, or l3 is symbolic.
            ChartError: as for `EulerChart.to_body`.
            ShapeError: the last axis of `z` has another length.
        """
        points = chart_points(z, self.component_names, self.component_names)
        angle = cyclic_angle(points[..., 4:], psi, points.shape[:-1])
        phi, theta, p_phi, p_theta = (points[..., k] for k in range(4))
        l3 = np.full(points.shape[:-1], as_float(self.l3, "l3"))
        return self.chart.to_body(np.stack([phi, angle, theta, p_phi, l3, p_theta], axis=-1))

    def from_body(self, states: ArrayLike) -> Array:
        """Reduced states, shape (..., 4), or (..., 5) with the cyclic angle, of states of shape (..., 9).

        Raises:
            ChartError: as for `EulerChart.from_body`, or l3 is not that of the reduction (condition "l3").
        """
        states = chart_points(states, COMPONENTS, FIELDS)
        check_l3(states, self.l3)
        full = self.chart.from_body(states)
        return full[..., [0, 2, 3, 5, *((1,) if self.with_cyclic_angle else ())]]

    def margins(self, states: ArrayLike) -> dict[str, Array]:
        """How far states are from where the chart ends; as `EulerChart.margins`."""
        return self.chart.margins(states)

    @property
    def _p_psi(self) -> Any:
        from sympy import Symbol

        return Symbol("p_psi")

    def _at_l3(self, expression: Any) -> Expr:
        return expression.xreplace({self._p_psi: self.l3})

    def __repr__(self) -> str:
        return f"<ReducedLagrange of {self.chart.top_name!r}: l3 = {decimal(self.l3)}, {self.chart.leaf.describe()}>"


_TRY = "Integrate the top itself there."


@explains_its_methods
class OrdinaryLagrange(_Reduction):
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

    coordinates, momenta = ("theta",), ("p_theta",)
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
