r"""Canonical coordinates without a singularity: quaternions on T*SO(3), and one more pair for the length of alpha.

On $T^*SO(3)\times\mathbb R^2$ with $\{\hat X, \hat Y\} = -\epsilon w$ the map

$$\ell = \tfrac12 G p, \qquad \alpha = A\,(\hat X e_1 + \hat Y e_2 + v e_3), \qquad \beta = w\,A e_3, \qquad
  A = R(q)^T/|q|^2$$

carries the canonical bracket to that of the charged or twisted top.  Unlike the Euler chart it takes no root, so that
alpha may be parallel to beta.

Quaternions, their rotation matrices and the shortest turn to an axis are for arrays and expressions alike:
$q = q_0 + q_1 i + q_2 j + q_3 k$ with $ij = k$; the rotation $v \mapsto q v\bar q$ is $R(q)$ for $|q| = 1$.

References: Marsden and Ratiu, Introduction to Mechanics and Symmetry, second edition (1999), chapter 9.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from liepoisson.algebra.exact_numbers import is_zero
from liepoisson.errors import ChartError
from liepoisson.formula.parameters import Column, Parameter
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.model.canonical_system import CanonicalSystem
from liepoisson.model.charts.leaf_constants import (
    COMPONENTS,
    FIELDS,
    ON_LEAF,
    GivenLeaf,
    LeafConstants,
    chart_points,
    decimal,
    dot,
    refuse,
    top_of,
    vectors,
)
from liepoisson.model.hamiltonian import symbols_in
from liepoisson.portable import elementary, linear

if TYPE_CHECKING:
    from sympy import Expr


def rotation(q: Any) -> list[list[Any]]:
    """The rows of $R(q)$ times $|q|^2$, body to space components, from four components of any kind."""
    q0, q1, q2, q3 = q
    return [
        [q0**2 + q1**2 - q2**2 - q3**2, 2 * (q1 * q2 - q0 * q3), 2 * (q1 * q3 + q0 * q2)],
        [2 * (q1 * q2 + q0 * q3), q0**2 - q1**2 + q2**2 - q3**2, 2 * (q2 * q3 - q0 * q1)],
        [2 * (q1 * q3 - q0 * q2), 2 * (q2 * q3 + q0 * q1), q0**2 - q1**2 - q2**2 + q3**2],
    ]


def body_rotation(q: Any) -> list[list[Any]]:
    """The rows of the transpose, space to body components, times |q|^2."""
    return [list(column) for column in zip(*rotation(q), strict=True)]


def shortest_turn(n: Array) -> Array:
    """Unit quaternions that take e3 in space to n in the body, shape (..., 4): the shortest turn.

    For n3 < 0 it comes after half a turn about the first axis, so that nothing cancels near n = -e3.

    Args:
        n: Unit vectors, shape (..., 3); NaN stays NaN.
    """
    n1, n2, n3 = components(n)
    zero = np.zeros_like(n3)
    above = np.stack([1 + n3, n2, -n1, zero], axis=-1)
    below = np.stack([n2, 1 - n3, zero, n1], axis=-1)
    q = np.where((n3 < 0)[..., None], below, above)
    return q / linear.norm(q, axis=-1, keepdims=True)


def turned(q: Array, angle: Array) -> Array:
    """The quaternions after a turn by -angle about the third axis in space."""
    q0, q1, q2, q3 = components(q)
    c, s = elementary.cos(angle / 2), elementary.sin(angle / 2)
    return np.stack([c * q0 + s * q3, c * q1 + s * q2, c * q2 - s * q1, c * q3 - s * q0], axis=-1)


def left_matrix(q: Any) -> list[list[Any]]:
    """The matrix G of the body angular momentum, l = G p/2."""
    q0, q1, q2, q3 = q
    return [[-q1, q0, q3, -q2], [-q2, -q3, q0, q1], [-q3, q2, -q1, q0]]


def components(vectors: Array) -> tuple[Array, ...]:
    """The components along the last axis."""
    return tuple(np.moveaxis(vectors, -1, 0))


QUATERNION = ("q0", "q1", "q2", "q3")
CONJUGATE = ("p0", "p1", "p2", "p3")


@explains_its_methods
class QuaternionChart:
    r"""Quaternions q with momenta p, and a pair (X, Y): smooth canonical coordinates for beta != 0.

    $\ell = \tfrac12Gp$, $\beta = wAe_3$, $\alpha = A(sX e_1 - (\epsilon w/s)\,Y e_2 + v e_3)$ with
    $A = R(q)^T/|q|^2$ and
    $$G = \begin{pmatrix}-q_1&q_0&q_3&-q_2\\-q_2&-q_3&q_0&q_1\\-q_3&q_2&-q_1&q_0\end{pmatrix}.$$
    The scale $s = \sqrt{|\epsilon|w}$ makes X and Y of one size whatever the sign of epsilon (s = 1 while epsilon or
    w is a symbol).  For epsilon = 0 the pair is absent: the components of alpha in space are then constant, and
    $\alpha = A(\sqrt\eta\,e_1 + v e_3)$.

    Ten coordinates for a leaf of dimension six: $|q|^2$ and $q\cdot p$ commute with l, alpha and beta, and so does
    $C_1 = v^2 + \hat X^2 + \hat Y^2 + 2\epsilon w\,m_3$ (m the angular momentum in space), which generates the turns of
    (q, p, X, Y) about the space-fixed axis of beta that leave the state what it is.  v and w are constants of the
    chart; C1 is the value of a momentum map, so one chart serves all leaves with the same C2 and C3 (epsilon = 0:
    one leaf).  Of the many coordinates of a state `from_body` takes those with $|q| = 1$, $q\cdot p = 0$, and
    $q_3 = 0$, $q_0 > 0$ where $\beta_3\ge0$, $q_2 = 0$, $q_1 > 0$ where $\beta_3<0$; for epsilon = 0 these are turned
    about the axis of beta in space so that $\hat Y = 0$.

    Example:
        >>> chart = lp.charts.QuaternionChart(lp.Top.twisted_kovalevskaya(), leaf={"C1": 2, "C2": 0, "C3": 1})
        >>> chart.component_names
        ('q0', 'q1', 'q2', 'q3', 'X', 'p0', 'p1', 'p2', 'p3', 'Y')
        >>> state = [1, 0, 1, 0, 1, 0, 0, 0, 1]  # at a pole of Euler angles
        >>> bool(np.allclose(chart.to_body(chart.from_body(state)), state))
        True

    Args:
        system: A charged or twisted top (or a system with its equations).
        leaf: A `Leaf`, or the values of C1, C2, C3 of the bracket of the system.
        state: Instead, a state, shape (9,).  If neither is given, v, w and eta stay symbols.

    Raises:
        ParameterError: the system is no such top, or the Casimirs are not exact numbers.
        ShapeError: `state` is not one state.
        ChartError: the leaf has beta = 0, or epsilon = 0 and no alpha has these Casimirs.
    """

    conditions = ("beta != 0",)

    def __init__(
        self,
        system: Any,
        *,
        state: ArrayLike | None = None,
        leaf: GivenLeaf | Mapping[str, Parameter] | None = None,
    ) -> None:
        self.top = top_of(system)
        self.top_name: str = system.name
        self.name: str = f"{system.name}, quaternion chart"
        self.leaf: LeafConstants = LeafConstants.of(system, self.top, state, leaf)
        self.is_twisted: bool = not is_zero(self.leaf.epsilon)
        if not self.is_twisted and self.leaf.eta.is_negative:
            got = ", ".join(f"C{k} = {decimal(value)}" for k, value in enumerate(self.leaf.casimirs, start=1))
            raise ChartError(
                f"the leaf needs (alpha.beta)^2 <= |alpha|^2 |beta|^2, that is C2^2 <= C1 C3, when epsilon = 0; got "
                f"{got}. Give the Casimirs of a state, or the state with state=.",
                "on the leaf",
            )

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates."""
        return (*QUATERNION, "X") if self.is_twisted else QUATERNION

    @property
    def momenta(self) -> tuple[str, ...]:
        """Names of the momenta."""
        return (*CONJUGATE, "Y") if self.is_twisted else CONJUGATE

    @property
    def component_names(self) -> tuple[str, ...]:
        """Names of the components of the state: coordinates, then momenta."""
        return (*self.coordinates, *self.momenta)

    @cached_property
    def scale(self) -> Expr:
        r"""The number s that scales X and Y, $\sqrt{|\epsilon|w}$ rounded to a rational; 1 for symbols."""
        from sympy import Abs, Integer, Rational, sqrt

        square: Any = Abs(self.leaf.epsilon) * self.leaf.w
        return Rational(repr(float(sqrt(square)))) if self.is_twisted and square.is_number else Integer(1)

    @cached_property
    def angular_momentum(self) -> Column:
        r"""$\ell = \tfrac12Gp$ as expressions in q and p."""
        from sympy import Matrix, Rational

        return Rational(1, 2) * Matrix(left_matrix(self._quaternion)) * Matrix(self._momenta[:4])

    @cached_property
    def alpha(self) -> Column:
        """The first field as expressions."""
        from sympy import Matrix

        return self._rotation * Matrix([*self._horizontal(self._pair), self.leaf.v])

    @cached_property
    def beta(self) -> Column:
        """The second field as expressions."""
        return self.leaf.w * self._rotation[:, 2]

    @cached_property
    def hamiltonian(self) -> Expr:
        r"""$H = \tfrac12\ell\cdot I^{-1}\ell + a\cdot\alpha + b\cdot\beta$ in these coordinates: rational."""
        return self.top.hamiltonian(self.angular_momentum, self.alpha, self.beta)

    @cached_property
    def system(self) -> CanonicalSystem:
        """The canonical system in (q0, ..., q3, X, p0, ..., p3, Y), without X and Y if epsilon = 0."""
        symbols = symbols_in(self.hamiltonian, (*self.coordinates, *self.momenta))
        return CanonicalSystem(self.coordinates, self.momenta, self.hamiltonian, symbols=symbols, name=self.name)

    def to_body(self, z: ArrayLike) -> Array:
        """States (l, alpha, beta), shape (..., 9), from coordinates, shape (..., 10), or (..., 8) if epsilon = 0.

        Raises:
            ChartError: a quaternion is zero.
            ParameterError: a constant of the leaf is symbolic.
            ShapeError: the last axis has another length.
        """
        points = chart_points(z, self.component_names, self.component_names)
        q, p, pair = self._parts(points)
        square = dot(q, q)
        refuse(square == 0, square, "q != 0", "a quaternion that is not zero", quantity="|q|^2", hint="Scale q to 1.")
        v, w, _, _ = self.leaf.numbers
        l = 0.5 * linear.einsum(
            "...ij,...j->...i", np.moveaxis(_arrays(left_matrix(components(q))), (0, 1), (-2, -1)), p
        )
        A = np.moveaxis(_arrays(body_rotation(components(q))), (0, 1), (-2, -1)) / square[..., None, None]
        X, Y = self._horizontal(pair, numeric=True)
        alpha = X[..., None] * A[..., 0] + Y[..., None] * A[..., 1] + v * A[..., 2]
        return np.concatenate([l, alpha, w * A[..., 2]], axis=-1)

    def from_body(self, states: ArrayLike) -> Array:
        """Coordinates, shape (..., 10), or (..., 8) if epsilon = 0, of states, shape (..., 9); NaN stays NaN.

        Raises:
            ChartError: beta = 0, or the Casimirs of a state are not those of the chart.
            ParameterError: a constant of the leaf is symbolic.
            ShapeError: the last axis of `states` is not 9.
        """
        states = chart_points(states, COMPONENTS, FIELDS)
        length = self.margins(states)["beta != 0"]
        refuse(length <= 0, length, "beta != 0", "beta != 0", quantity="|beta|", hint="Integrate the top itself.")
        self._check_casimirs(states)
        l, alpha, beta = vectors(states)
        q = shortest_turn(beta / length[..., None])
        horizontal = linear.einsum("ij...,...i->...j", _arrays(body_rotation(components(q))), alpha)
        if not self.is_twisted:
            q = turned(q, elementary.arctan2(horizontal[..., 1], horizontal[..., 0]))
        p = 2 * linear.einsum("ij...,...i->...j", _arrays(left_matrix(components(q))), l)
        if not self.is_twisted:
            return np.concatenate([q, p], axis=-1)
        s = float(self.scale)
        _, w, _, epsilon = self.leaf.numbers
        X, Y = horizontal[..., 0] / s, -horizontal[..., 1] * s / (epsilon * w)
        return np.concatenate([q, X[..., None], p, Y[..., None]], axis=-1)

    def margins(self, states: ArrayLike) -> dict[str, Array]:
        """How far states are from where the chart ends: the length of beta, shape (...), the only condition."""
        return {"beta != 0": np.asarray(linear.norm(vectors(chart_points(states, COMPONENTS, FIELDS))[2], axis=-1))}

    def _check_casimirs(self, states: Array) -> None:
        # C1 is free when epsilon != 0: any value is one of the momentum map.
        leaf = self.leaf
        if not self.is_twisted:
            leaf.check_on_leaf(states)
            return
        v, w, _, _ = leaf.numbers
        _, alpha, beta = vectors(states)
        for name, value, want in (
            ("alpha.beta", dot(alpha, beta), v * w),
            ("|beta|^2", dot(beta, beta), w * w),
        ):
            size = linear.norm(alpha, axis=-1) * w + w * w
            refuse(
                np.abs(value - want) > ON_LEAF * size,
                value,
                "on the leaf",
                f"{name} = {want:.9g}, a constant of the chart",
                quantity=name,
                hint="Make a chart with state=state for that state.",
            )

    def _horizontal(self, pair: Any, *, numeric: bool = False) -> tuple[Any, Any]:
        """The components of alpha along the first two axes in space."""
        if numeric:
            _, w, eta, epsilon = self.leaf.numbers
            s: Any = float(self.scale)
            if not self.is_twisted:
                return np.asarray(np.sqrt(eta)), np.asarray(0.0)
            return s * pair[0], -epsilon * w / s * pair[1]
        from sympy import Integer, sqrt

        if not self.is_twisted:
            return sqrt(self.leaf.eta), Integer(0)
        factor: Any = self.leaf.epsilon
        return self.scale * pair[0], -factor * self.leaf.w / self.scale * pair[1]

    def _parts(self, points: Array) -> tuple[Array, Array, tuple[Array, Array] | None]:
        if not self.is_twisted:
            return points[..., :4], points[..., 4:], None
        return points[..., :4], points[..., 5:9], (points[..., 4], points[..., 9])

    @cached_property
    def _quaternion(self) -> tuple[Any, ...]:
        from sympy import symbols

        return symbols(QUATERNION)

    @cached_property
    def _momenta(self) -> tuple[Any, ...]:
        from sympy import symbols

        return symbols(CONJUGATE)

    @cached_property
    def _pair(self) -> tuple[Any, Any]:
        from sympy import symbols

        return symbols("X Y")

    @cached_property
    def _rotation(self) -> Any:
        from sympy import Add, Matrix

        return Matrix(body_rotation(self._quaternion)) / Add(*(c**2 for c in self._quaternion))

    def __repr__(self) -> str:
        return f"<QuaternionChart of {self.top_name!r}: {self.leaf.describe()}>"


def _arrays(rows: list[list[Any]]) -> Array:
    return np.array(rows, dtype=np.float64)
