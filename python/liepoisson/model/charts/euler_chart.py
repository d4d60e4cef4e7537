r"""The paper's canonical chart: Euler angles and their momenta on a leaf of the charged or twisted top.

$$\beta = w\,A\hat e_\parallel, \qquad \alpha = A\,(v\,\hat e_\parallel + r\,\hat e_\perp), \qquad \ell = Lp, \qquad
  r = \sqrt{\eta - 2\epsilon\,\ell\cdot\beta} .$$

A takes space components to body components, with Goldstein's angles q = (phi, psi, theta), p = (p_phi, p_psi, p_theta).
A gauge is made of the two space-fixed unit vectors, along beta and along the rest of alpha.

References: Thiffeault and Morrison (2001), section "Canonical description"; the domain is ours.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from liepoisson.algebra.exact_numbers import Exact, is_zero, to_sympy
from liepoisson.errors import ParameterError
from liepoisson.formula.parameters import Column, Parameter, read_vector
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.inputs.given import listed
from liepoisson.model.canonical_system import CanonicalSystem
from liepoisson.model.charts.leaf_constants import (
    COMPONENTS,
    FIELDS,
    GivenLeaf,
    LeafConstants,
    chart_points,
    dot,
    refuse,
    top_of,
    vectors,
)
from liepoisson.model.hamiltonian import symbols_in
from liepoisson.portable import elementary, linear

if TYPE_CHECKING:
    from sympy import Expr

ANGLES = ("phi", "psi", "theta")
MOMENTA = ("p_phi", "p_psi", "p_theta")

Turn: TypeAlias = tuple[Any, Any]
"""The cosine and the sine of an angle."""

NEAREST = 1e-10
"""Smallest margin at which a state is still given coordinates: there they have lost ten of their sixteen digits."""

ROUNDING = 1e-14
"""Relative size below which the difference of eta and 2 epsilon l.beta is only rounding."""

_HINTS = {
    "beta != 0": "QuaternionChart has the same limit: integrate the top itself; on beta = 0 a Lagrange top has "
    "OrdinaryLagrange.",
    "alpha x beta != 0": "Use QuaternionChart, which has no such limit.",
    "sin(theta) != 0": "Use EulerChart in another gauge, or QuaternionChart, which has no poles.",
}
"""What to try at each end of the chart."""


@explains_its_methods
class EulerChart:
    r"""Euler angles (phi, psi, theta) and momenta on one leaf, in any gauge.

    $\beta = wA\hat e_\parallel$, $\alpha = A(v\hat e_\parallel + r\hat e_\perp)$, $\ell = Lp$ with
    $r = \sqrt{\eta - 2\epsilon\,\ell\cdot\beta}$, where $w = \sqrt{C_3}$, $v = C_2/w$, $\eta = C_1 - v^2$ and
    $C_1 = |\alpha|^2 + 2\epsilon\,\ell\cdot\beta$.  A takes space to body components (Goldstein's convention).

    The chart is a part of the leaf: it ends where beta = 0, where alpha is parallel to beta (there the root is zero;
    of the momenta only those with $\eta > 2\epsilon\,\ell\cdot\beta$ belong to it) and where $\sin\theta = 0$.
    Orbits do leave it: see `margins`.

    Example:
        >>> chart = lp.charts.EulerChart(lp.Top.twisted_kovalevskaya(), leaf={"C1": 2, "C2": 0, "C3": 1})
        >>> chart.potential
        sqrt(2)*sqrt(1 - p_phi)*(sin(phi)*sin(psi)*cos(theta) - cos(phi)*cos(psi))
        >>> chart.l_dot_beta
        p_phi

    Args:
        system: A charged or twisted top (or a system with its equations); its parameters may be symbolic.
        leaf: A `Leaf`, or the values of C1, C2, C3 of the bracket of the system.
        state: Instead, a state of the leaf, shape (9,).  If neither is given, v, w and eta stay symbols.
        gauge: "e3, e1" or "e1, e3" for the paper's two choices of (parallel, perpendicular), or a pair of constant
            orthonormal vectors.

    Raises:
        ParameterError: the system is no such top, the gauge is not orthonormal, or the Casimirs are not exact numbers.
        ShapeError: `state` is not one state.
        ChartError: the leaf has beta = 0.
    """

    component_names = (*ANGLES, *MOMENTA)
    conditions = ("beta != 0", "alpha x beta != 0", "sin(theta) != 0")

    def __init__(
        self,
        system: Any,
        *,
        state: ArrayLike | None = None,
        leaf: GivenLeaf | Mapping[str, Parameter] | None = None,
        gauge: Given = "e3, e1",
    ) -> None:
        self.top = top_of(system)
        self.top_name: str = system.name
        self.name: str = f"{system.name}, Euler chart"
        self.leaf: LeafConstants = LeafConstants.of(system, self.top, state, leaf)
        self.gauge: Gauge = Gauge.read(gauge)

    @cached_property
    def angular_momentum(self) -> Column:
        r"""$\ell = Lp$ as expressions in angles and momenta."""
        from sympy import Matrix

        _, psi, theta = self._turns
        return Matrix(angular_momentum(psi, theta, self._symbols[3:]))

    @cached_property
    def alpha(self) -> Column:
        r"""$\alpha = A(v\hat e_\parallel + r\hat e_\perp)$."""
        parallel, perpendicular = self.gauge.columns()
        return self._rotation * (self.leaf.v * parallel + self.root * perpendicular)

    @cached_property
    def beta(self) -> Column:
        r"""$\beta = wA\hat e_\parallel$."""
        return self.leaf.w * self._rotation * self.gauge.columns()[0]

    @cached_property
    def l_dot_beta(self) -> Expr:
        r"""$\ell\cdot\beta = p\cdot L^TA\,w\hat e_\parallel$, with the paper's matrix $L^TA$."""
        from sympy import Matrix

        (cf, sf), _, (ct, st) = self._turns
        LTA = Matrix([[-ct / st * sf, ct / st * cf, 1], [sf / st, -cf / st, 0], [cf, sf, 0]])
        return self.leaf.w * Matrix(self._symbols[3:]).dot(LTA * self.gauge.columns()[0])

    @cached_property
    def root(self) -> Expr:
        r"""$r = \sqrt{\eta - 2\epsilon\,\ell\cdot\beta}$, the part of alpha perpendicular to beta."""
        from sympy import sqrt

        return sqrt(self.leaf.eta - 2 * self.leaf.epsilon * self.l_dot_beta)

    @cached_property
    def kinetic_energy(self) -> Expr:
        r"""$\tfrac12\ell\cdot I^{-1}\ell$; with two equal moments as the paper has it, without psi."""
        from sympy import Add

        inertia: Any = [to_sympy(moment) for moment in self.top.inertia]
        if inertia[0] != inertia[1]:
            return Add(*(l**2 / (2 * I) for l, I in zip(self.angular_momentum, inertia, strict=True)))
        p_phi, p_psi, p_theta = self._symbols[3:]
        cosine, sine = self._turns[2]
        horizontal = p_theta**2 / (2 * inertia[0]) + (p_phi - p_psi * cosine) ** 2 / (2 * inertia[0] * sine**2)
        return horizontal + p_psi**2 / (2 * inertia[2])

    @cached_property
    def potential(self) -> Expr:
        r"""$V = (va + wb)\cdot A\hat e_\parallel + r\,a\cdot A\hat e_\perp$."""
        from sympy import Matrix, factor_terms

        a, b = (Matrix([to_sympy(value) for value in vector]) for vector in (self.top.a, self.top.b))
        parallel, perpendicular = (self._rotation * axis for axis in self.gauge.columns())
        fixed: Any = self.leaf.v * a + self.leaf.w * b
        return factor_terms(fixed.dot(parallel) + self.root * a.dot(perpendicular))

    @property
    def hamiltonian(self) -> Expr:
        """The canonical Hamiltonian, kinetic energy plus potential."""
        return self.kinetic_energy + self.potential

    @cached_property
    def system(self) -> CanonicalSystem:
        """The canonical system on the leaf, in (phi, psi, theta, p_phi, p_psi, p_theta)."""
        symbols = symbols_in(self.hamiltonian, (*ANGLES, *MOMENTA))
        return CanonicalSystem(ANGLES, MOMENTA, self.hamiltonian, symbols=symbols, name=self.name)

    def to_body(self, z: ArrayLike) -> Array:
        """States (l, alpha, beta), shape (..., 9), from angles and momenta, shape (..., 6); NaN stays NaN.

        Raises:
            ChartError: sin(theta) = 0, or momenta beyond the half-space eta > 2 epsilon l.beta.
            ParameterError: a constant of the leaf is symbolic.
            ShapeError: the last axis of `z` is not 6.
        """
        points = chart_points(z, self.component_names, self.component_names)
        phi, psi, theta = ((elementary.cos(points[..., k]), elementary.sin(points[..., k])) for k in range(3))
        sine = np.abs(theta[1])
        self._refuse(sine == 0, sine, self.conditions[2], "sin(theta)")
        v, w, eta, epsilon = self.leaf.numbers
        l = np.stack(angular_momentum(psi, theta, [points[..., k] for k in (3, 4, 5)]), axis=-1)
        triad = linear.matmul(_stacked(rotation_rows(phi, psi, theta)), self.gauge.triad())
        beta = w * triad[..., 2]
        fall = 2 * epsilon * dot(l, beta)
        square = eta - fall
        rounding = ROUNDING * (abs(eta) + np.abs(fall))
        half_space = "eta - 2 epsilon l.beta > 0"
        quantity = "eta - 2 epsilon l.beta"
        hint = _HINTS[self.conditions[1]]
        refuse(square < -rounding, square, half_space, f"momenta with {half_space}", quantity=quantity, hint=hint)
        alpha = v * triad[..., 2] + np.sqrt(np.maximum(square, 0.0))[..., None] * triad[..., 0]
        return np.concatenate([l, alpha, beta], axis=-1)

    def from_body(self, states: ArrayLike) -> Array:
        """Angles and momenta, shape (..., 6), of states of the leaf, shape (..., 9); NaN stays NaN.

        The angles phi and psi lie in (-pi, pi], theta in (0, pi).

        Raises:
            ChartError: a state is not on the leaf, or less than 1e-10 from where the chart ends; see `condition`.
            ParameterError: a constant of the leaf is symbolic.
            ShapeError: the last axis of `states` is not 9.
        """
        states = chart_points(states, COMPONENTS, FIELDS)
        margins = self.margins(states)
        quantities = ("|beta|", "|alpha x beta|/|beta|", "sin(theta)")
        sizes = linear.norm(states, axis=-1), linear.norm(states, axis=-1), np.ones(states.shape[:-1])
        for condition, quantity, size in zip(self.conditions[:2], quantities[:2], sizes[:2], strict=True):
            margin = margins[condition]
            self._refuse(margin <= NEAREST * size, margin, condition, quantity)
        self.leaf.check_on_leaf(states)
        sine = margins[self.conditions[2]]
        self._refuse(sine <= NEAREST, sine, self.conditions[2], quantities[2])
        A, l = self._attitude(states), states[..., :3]
        theta = elementary.arctan2(elementary.hypot(A[..., 2, 0], A[..., 2, 1]), A[..., 2, 2])
        phi, psi = elementary.arctan2(A[..., 2, 0], -A[..., 2, 1]), elementary.arctan2(A[..., 0, 2], A[..., 1, 2])
        psi_turn, theta_turn = ((elementary.cos(angle), elementary.sin(angle)) for angle in (psi, theta))
        momenta = momenta_of(psi_turn, theta_turn, [l[..., k] for k in range(3)])
        return np.stack([phi, psi, theta, *momenta], axis=-1)

    def margins(self, states: ArrayLike) -> dict[str, Array]:
        r"""How far states are from where the chart ends: one number for each condition, zero where it fails.

        Args:
            states: States, shape (..., 9).

        Returns:
            $|\beta|$, $|\alpha\times\beta|/|\beta| = r$ and $\sin\theta$, each of shape (...), under the names in
            `conditions`.
        """
        states = chart_points(states, COMPONENTS, FIELDS)
        _, alpha, beta = vectors(states)
        length = linear.norm(beta, axis=-1)
        perpendicular = _quotient(linear.norm(np.cross(alpha, beta), axis=-1), length)
        A = self._attitude(states)
        sizes = length, perpendicular, elementary.hypot(A[..., 2, 0], A[..., 2, 1])
        return {name: np.asarray(size) for name, size in zip(self.conditions, sizes, strict=True)}

    @staticmethod
    def _refuse(failing: Any, margin: Array, condition: str, quantity: str) -> None:
        refuse(failing, margin, condition, condition, quantity=quantity, hint=_HINTS[condition])

    def _attitude(self, states: Array) -> Array:
        """The rotation A, shape (..., 3, 3), from the directions of beta and of the rest of alpha; 0 if undefined."""
        _, alpha, beta = vectors(states)
        third = _quotient(beta, linear.norm(beta, axis=-1, keepdims=True))
        second = np.cross(third, alpha)
        second = _quotient(second, linear.norm(second, axis=-1, keepdims=True))
        triad = np.stack([np.cross(second, third), second, third], axis=-1)
        return linear.matmul(triad, self.gauge.triad().T)

    @cached_property
    def _symbols(self) -> tuple[Any, ...]:
        from sympy import Symbol

        return tuple(Symbol(name) for name in self.component_names)

    @cached_property
    def _turns(self) -> tuple[tuple[Any, Any], ...]:
        from sympy import cos, sin

        return tuple((cos(angle), sin(angle)) for angle in self._symbols[:3])

    @cached_property
    def _rotation(self) -> Any:
        from sympy import Matrix

        phi, psi, theta = self._turns
        return Matrix(rotation_rows(phi, psi, theta))

    def __repr__(self) -> str:
        return f"<EulerChart of {self.top_name!r} in the gauge {self.gauge}: {self.leaf.describe()}>"


def _stacked(rows: list[list[Any]]) -> Array:
    return np.stack([np.stack(np.broadcast_arrays(*row), axis=-1) for row in rows], axis=-2)


def _quotient(values: Array, divisor: Array) -> Array:
    """values/divisor, zero where the divisor vanishes."""
    return np.divide(
        values, divisor, out=np.zeros(np.broadcast_shapes(values.shape, divisor.shape)), where=divisor != 0
    )


Given: TypeAlias = "str | tuple[Sequence[Parameter], Sequence[Parameter]]"
"""A gauge as a caller writes it: "e3, e1", or a pair of vectors."""

ORTHONORMAL = 1e-14
"""How far scalar products of vectors given as floats may be from 0 and 1: some roundings."""

_AXES = {"e1": (1, 0, 0), "e2": (0, 1, 0), "e3": (0, 0, 1)}
_AXIS_NAMES: dict[tuple[Any, ...], str] = {axis: name for name, axis in _AXES.items()}


@dataclass(frozen=True)
class Gauge:
    """Two constant orthonormal vectors in space.

    Attributes:
        parallel: Along beta, exact.
        perpendicular: Along the part of alpha that is perpendicular to beta, exact.
    """

    parallel: tuple[Exact, Exact, Exact]
    perpendicular: tuple[Exact, Exact, Exact]

    @classmethod
    def read(cls, given: Given) -> Gauge:
        """A gauge from its name or from two vectors.

        Raises:
            ParameterError: unknown axes, or vectors that are not orthonormal.
            ShapeError: vectors that do not have three components.
        """
        names = [part.strip() for part in given.split(",")] if isinstance(given, str) else []
        pair: Any = [_AXES.get(name) for name in names] if isinstance(given, str) else given
        pair = listed(pair, "gauge")
        if pair is None or len(pair) != 2 or any(vector is None for vector in pair):
            raise ParameterError(
                'gauge must be two of the axes e1, e2, e3, as in "e3, e1" (along beta, along the rest of alpha), or a '
                f"pair of orthonormal vectors; got {given!r:.60}."
            )
        gauge = cls(read_vector(pair[0], "gauge", "(e1, e2, e3)"), read_vector(pair[1], "gauge", "(f1, f2, f3)"))
        gauge._check()
        return gauge

    def __str__(self) -> str:
        return ", ".join(_AXIS_NAMES.get(v, f"({', '.join(map(str, v))})") for v in (self.parallel, self.perpendicular))

    def columns(self) -> tuple[Any, Any]:
        """Both vectors as SymPy columns."""
        from sympy import Matrix

        first, second = (Matrix([to_sympy(c) for c in v]) for v in (self.parallel, self.perpendicular))
        return first, second

    def triad(self) -> Array:
        """The space-fixed frame with columns (perpendicular, parallel x perpendicular, parallel), shape (3, 3)."""
        parallel, perpendicular = (np.array(v, dtype=np.float64) for v in (self.parallel, self.perpendicular))
        return np.stack([perpendicular, np.cross(parallel, perpendicular), parallel], axis=-1)

    def _check(self) -> None:
        e, f = self.columns()
        products = {"e_par.e_par": (e.dot(e), 1), "e_perp.e_perp": (f.dot(f), 1), "e_par.e_perp": (e.dot(f), 0)}
        for name, (value, wanted) in products.items():
            residual = value - wanted
            if not is_zero(residual) and not (residual.is_number and abs(float(residual)) <= ORTHONORMAL):
                raise ParameterError(
                    f"gauge must be two orthonormal vectors (e_par, e_perp); got {name} = {value!s:.40}. "
                    "Give exact numbers such as (3/5, 4/5, 0), or normalise them."
                )


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
