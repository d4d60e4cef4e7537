r"""The constants of a leaf of the charged or twisted top: v, w and eta in place of the Casimirs.

$C_3 = w^2$, $C_2 = vw$, $C_1 = \eta + v^2$ with $C_1 = |\alpha|^2 + 2\epsilon\,\ell\cdot\beta$.

References: Thiffeault and Morrison (2001), section "Canonical description".
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol, cast

import numpy as np
from numpy.typing import ArrayLike

from liepoisson.algebra.exact_numbers import Exact, as_float, is_zero, symbols_of, to_sympy
from liepoisson.errors import ChartError, ParameterError, ShapeError
from liepoisson.formula.parameters import Parameter, read_parameter
from liepoisson.formula.scalars import as_phase_points
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.inputs.given import named
from liepoisson.model.top_parameters import TopParameters
from liepoisson.portable import linear

if TYPE_CHECKING:
    from sympy import Expr

FIELDS = ("l", "alpha", "beta")
COMPONENTS = tuple(f"{field}{i}" for field in FIELDS for i in (1, 2, 3))

OWN_NAMES = frozenset(
    [f"{field}{i}" for field in FIELDS for i in (1, 2, 3)]
    + [f"{prefix}{angle}" for prefix in ("", "p_", "c_", "s_") for angle in ("phi", "psi", "theta")]
    + [f"{letter}{i}" for letter in "qp" for i in range(4)]
    + ["v", "w", "eta", "r", "X", "Y"]
)
"""Symbols that formulas of the charts are written in, of which no parameter may have the name."""

ON_LEAF = 1e-8
"""How far the Casimirs of a state may be from those of the chart, relative to the terms they are sums of.

Orbits of a million time units keep them to 1e-11; a state that was typed with nine digits passes.
"""


class GivenLeaf(Protocol):
    """A leaf by one of its states and the top that it belongs to, as `liepoisson.Leaf` is."""

    @property
    def system(self) -> Any: ...  # noqa: D102
    @property
    def state(self) -> Array: ...  # noqa: D102


@explains_its_methods
@dataclass(frozen=True, repr=False)
class LeafConstants:
    r"""The constants v, w and eta of a leaf with $\beta\neq0$; symbols if no leaf is given.

    Example:
        >>> top = lp.Top.twisted_kovalevskaya()
        >>> lp.charts.EulerChart(top, leaf={"C1": 2, "C2": 2, "C3": 4}).leaf
        <LeafConstants v = 1, w = 2, eta = 1, epsilon = 1>
        >>> lp.charts.EulerChart(top).leaf.casimirs  # if no leaf is given
        (eta + v**2, v*w, w**2)

    Attributes:
        epsilon: Strength of the cocycle.
        v: The component of alpha along beta, $C_2/w$.
        w: The length of beta, $\sqrt{C_3}$.
        eta: $C_1 - v^2$.
    """

    epsilon: Expr
    v: Expr
    w: Expr
    eta: Expr

    def __post_init__(self) -> None:
        """Reads what is no expression yet: numbers and texts, as parameters are.

        Raises:
            ParameterError: one is none.
        """
        for name in ("epsilon", "v", "w", "eta"):
            given: Any = getattr(self, name)
            if not hasattr(given, "free_symbols"):
                object.__setattr__(self, name, to_sympy(read_parameter(given, name)))

    @classmethod
    def of(
        cls,
        system: Any,
        top: TopParameters,
        state: ArrayLike | None,
        leaf: GivenLeaf | Mapping[str, Parameter] | None = None,
    ) -> LeafConstants:
        """The constants from a leaf or values of C1, C2, C3 of the bracket, from a state, or as symbols.

        Raises:
            ParameterError: both are given, a Casimir is missing, unknown or not exact, the leaf is none of this
                bracket, or Casimirs are given for a bracket that only has the equations of the top in common.
            ShapeError: `state` is not one state of nine components.
            ChartError: beta = 0.
        """
        from sympy import symbols

        epsilon = to_sympy(top.epsilon)
        if state is not None and leaf is not None:
            raise ParameterError("a chart is made with leaf= or with state=; got both. Give one of them.")
        if leaf is not None and (casimirs := named(leaf, "leaf")) is not None:
            return cls(epsilon, *_from_casimirs(system, top, casimirs))
        if leaf is not None:
            # not from its Casimirs: C1 - C2^2/C3 cancels for nearly parallel fields
            state = _state_of(cast("GivenLeaf", leaf), epsilon)
        if state is not None:
            return cls(epsilon, *_from_state(state, as_float(top.epsilon, "epsilon")))
        v, w, eta = symbols("v w eta")
        return cls(epsilon, v, w, eta)

    @property
    def casimirs(self) -> tuple[Expr, Expr, Expr]:
        r"""$C_1 = |\alpha|^2 + 2\epsilon\,\ell\cdot\beta$, $C_2 = \alpha\cdot\beta$ and $C_3 = |\beta|^2$."""
        v, w, eta = (to_any(value) for value in (self.v, self.w, self.eta))
        return eta + v**2, v * w, w**2

    @property
    def numbers(self) -> tuple[float, float, float, float]:
        """(v, w, eta, epsilon) as doubles.

        Raises:
            ParameterError: one of them is symbolic.
        """
        names = ("v", "w", "eta", "epsilon")
        v, w, eta, epsilon = (
            as_float(value, name) for value, name in zip((self.v, self.w, self.eta, self.epsilon), names, strict=True)
        )
        return v, w, eta, epsilon

    def __repr__(self) -> str:
        return f"<LeafConstants {self.describe()}, epsilon = {decimal(self.epsilon)}>"

    def describe(self) -> str:
        """v, w and eta as text: numbers with six digits, symbols as they are."""
        return ", ".join(f"{name} = {decimal(getattr(self, name))}" for name in ("v", "w", "eta"))

    def check_on_leaf(self, states: Array) -> None:
        """Refuse states of other leaves.

        Raises:
            ChartError: a Casimir differs from that of the leaf; the message names it.
        """
        v, w, eta, epsilon = self.numbers
        l, alpha, beta = vectors(states)
        lb, aa, bb = dot(l, beta), dot(alpha, alpha), dot(beta, beta)
        sizes = aa + 2 * abs(epsilon) * np.sqrt(dot(l, l) * bb), np.sqrt(aa * bb), bb
        values = aa + 2 * epsilon * lb, dot(alpha, beta), bb
        wanted = eta + v * v, v * w, w * w
        names = "|alpha|^2 + 2 epsilon l.beta", "alpha.beta", "|beta|^2"
        for name, value, want, size in zip(names, values, wanted, sizes, strict=True):
            refuse(
                np.abs(value - want) > ON_LEAF * (size + abs(want)),
                value,
                "on the leaf",
                f"{name} = {want:.9g}, the value of its leaf",
                quantity=name,
                hint="Make a chart with state=state for the leaf of that state.",
            )


def _from_casimirs(system: Any, top: TopParameters, casimirs: Mapping[str, Parameter]) -> tuple[Any, Any, Any]:
    from sympy import sqrt

    if set(casimirs) != {"C1", "C2", "C3"}:
        raise ParameterError(
            f"leaf must be a Leaf, or give C1, C2 and C3; got {casimirs!r:.60}. Write for example "
            'leaf={"C1": 1, "C2": 0, "C3": 1}, or give a state with state=.'
        )
    C1, C2, C3 = (to_sympy(read_parameter(casimirs[name], name)) for name in ("C1", "C2", "C3"))
    _refuse_own_names((C1, C2, C3))
    if is_zero(C3) or to_any(C3).is_negative:
        raise beta_is_zero(f"C3 = {decimal(C3)}")
    if not top.has_bracket(system.bracket):
        raise ParameterError(
            f"the values of leaf are those of |alpha|^2 + 2 epsilon l.beta, alpha.beta and |beta|^2; the system has "
            f"the equations of a top, but the bracket {system.bracket}. Give a state with state=, or a Leaf."
        )
    w = sqrt(C3)
    return C2 / w, w, C1 - C2**2 / to_any(C3)


def _state_of(leaf: GivenLeaf, epsilon: Expr) -> Array:
    """The state of a leaf of the same bracket, in which epsilon is the only number."""
    if not hasattr(leaf, "state") or not hasattr(leaf, "system"):
        raise ParameterError(
            f"leaf must be a Leaf; got {leaf!r:.60}. Write leaf=Leaf.through(top, state), or "
            "give the values of C1, C2 and C3."
        )
    of_leaf = to_sympy(top_of(leaf.system).epsilon)
    if of_leaf != epsilon:
        raise ParameterError(
            f"the leaf must be one of this top, with epsilon = {decimal(epsilon)}; it has epsilon = "
            f"{decimal(of_leaf)}. Take Leaf.through(top, state) with this top."
        )
    return leaf.state


def _from_state(given: ArrayLike, epsilon: float) -> tuple[Any, Any, Any]:
    state = chart_points(given, COMPONENTS, FIELDS, "state")
    if state.ndim != 1:
        raise ShapeError(
            f"state must be one state of shape (9,); got shape {state.shape}. Every leaf needs its own chart."
        )
    l, alpha, beta = vectors(state)
    w = float(linear.norm(beta))
    if not w > 0:
        raise beta_is_zero(f"|beta| = {w:.3g}")
    v, normal = float(linear.matmul(alpha, beta)) / w, np.cross(alpha, beta) / w
    # |alpha x beta|^2/w^2 instead of |alpha|^2 - v^2, which cancels for nearly parallel fields
    eta = float(linear.matmul(normal, normal) + linear.matmul(2 * epsilon * l, beta))
    v, w, eta = (to_sympy(read_parameter(value, name)) for value, name in ((v, "v"), (w, "w"), (eta, "eta")))
    return v, w, eta


def beta_is_zero(got: str) -> ChartError:
    """The error for a leaf without a second field."""
    return ChartError(
        f"a chart of this kind needs beta != 0; got {got}. On beta = 0 the motion is that of an ordinary heavy top: "
        "integrate the top itself, or use OrdinaryLagrange for a Lagrange top.",
        "beta != 0",
    )


def refuse(failing: Any, values: Any, condition: str, wanted: str, *, quantity: str, hint: str) -> None:
    """Raise a ChartError if any state fails, quoting the first of them.

    Args:
        failing: Which states fail, shape (...).
        values: The quantity of the condition at each state, shape (...).
        condition: The condition of the domain, for the error.
        wanted: What was wanted, in words.
        quantity: What the values are.
        hint: What to try.
    """
    bad = np.atleast_1d(failing).ravel()
    if not bad.any():
        return
    first = int(np.argmax(bad))
    value = np.broadcast_to(np.asarray(values, dtype=np.float64), np.shape(failing)).ravel()[first]
    where = f" at state {first} ({int(bad.sum())} of {bad.size} such)" if bad.size > 1 else ""
    raise ChartError(f"the chart needs {wanted}; got {quantity} = {value:.3g}{where}. {hint}", condition)


LARGEST = 1e75
"""Largest component of a state that a chart takes: the Casimirs are compared by products of four components."""


def chart_points(given: ArrayLike, components: Sequence[str], fields: Sequence[str], name: str = "states") -> Array:
    """States of shape (..., n), each of them NaN or with products that are doubles.

    Raises:
        ParameterError: a component is infinite or larger than 1e75.
        ShapeError: the last axis has another length.
    """
    states = as_phase_points(given, components, fields, name)
    size = np.abs(states)
    if (size > LARGEST).any():
        raise ParameterError(
            f"a chart takes states with components up to {LARGEST:.0e}; got {size[size > LARGEST].max():.3g}. Measure "
            "in other units, so that the largest is about 1."
        )
    return states


def decimal(value: Any) -> str:
    """A number with six digits; anything else as it is."""
    return f"{float(value):.6g}" if value.is_number else str(value)


def vectors(x: Array) -> tuple[Array, Array, Array]:
    """The vectors l, alpha and beta of states of shape (..., 9)."""
    return x[..., 0:3], x[..., 3:6], x[..., 6:9]


def dot(u: Array, v: Array) -> Array:
    """Scalar products along the last axis."""
    return linear.einsum("...i,...i->...", u, v)


def to_any(value: Any) -> Any:
    """The value, whose arithmetic SymPy's annotations do not cover."""
    return value


def top_of(system: Any) -> TopParameters:
    """The parameters of a charged or twisted top.

    Raises:
        ParameterError: the system has not the equations of such a top.
    """
    top = getattr(system, "top_parameters", None)
    if not isinstance(top, TopParameters):
        raise ParameterError(
            "these charts are those of the charged and the twisted top, H = l.I^-1 l/2 + a.alpha + b.beta; got "
            f"{getattr(system, 'name', type(system).__name__)!s:.60}. Use for example Top.twisted_kovalevskaya()."
        )
    _refuse_own_names((*top.inertia, *top.a, *top.b, top.epsilon))
    return top


def _refuse_own_names(values: Sequence[Exact]) -> None:
    """Refuse symbols that the charts would take for their own coordinates, momenta and constants."""
    if taken := sorted(OWN_NAMES & {name for value in values for name in symbols_of(value)}):
        raise ParameterError(
            f"a symbol must stand for one thing; {', '.join(taken)} would be a parameter, and a coordinate or constant "
            "of a chart. Rename the parameter."
        )
