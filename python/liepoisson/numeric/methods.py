"""Methods of integration, as data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cache
from typing import Any, ClassVar, Literal, TypeAlias, get_args, get_type_hints

import numpy as np
from numpy.typing import ArrayLike

from liepoisson import _core
from liepoisson.compile.field import Field, PiecesField, QuadraticField, TopField
from liepoisson.errors import ParameterError, ShapeError
from liepoisson.formula.scalars import as_array, as_count, as_number
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.inputs.refusals import check_choice, shown
from liepoisson.numeric.systems import TOP_COMPONENTS, as_field, core_field, has_pieces

ROUND_OFF = 2.0**-53
SINGLE_TOLERANCE = 2.0**-20
"""Least tolerance in single precision, 16 units of round-off."""
MAX_ORDER = 64
MAX_STEPS = 10_000_000
"""Default budget: most steps that one trajectory may take."""


@explains_its_methods
@dataclass(frozen=True)
class Taylor:
    r"""The adaptive Taylor method: the default, to round-off or any tolerance, with dense output.

    Each step expands the solution in powers of time, $x(t+\tau) = \sum_{k\le N} x_k\tau^k$, and is as long as
    $\|x_k\|\,|\tau|^k \le \mathrm{tol}\,\|x_0\|$ allows for $k = N-1, N$, where $\|\cdot\|$ is the sum of the absolute
    values of the components of the state; likewise for each tangent vector, so a trajectory with tangent vectors
    takes other steps than one without, and agrees with it to the accuracy of the method.

    Example:
        >>> top, start = lp.Top.kovalevskaya(), {"l": (1, 0, 1), "alpha3": 1}
        >>> runs = [lp.integrate(top, start, t_end=100, method=lp.Taylor(tol=tol)) for tol in (1e-15, 1e-6)]
        >>> [run.order for run in runs], [bool(run.drift["H"].max() < 1e-12) for run in runs]
        ([24, 12], [True, False])

    Args:
        tol: Relative size of the last retained terms, from 1.1e-16 to 0.1.  The local error is smaller by about
            $h/\rho$, the step over the radius of convergence (about 0.15).
        order: $N$, from 2 to 64; by default the cheapest for `tol` and, of a system without a kernel of its own, for
            its counted operations.
        precision: "double", or "mixed" (tops only): terms of the state's series below $2^{22}\,\mathrm{tol}$ of the
            state, and all of the tangent vectors, in single precision.  The state is as accurate as in double
            precision; a tangent vector gains a relative error of $\max(6\cdot10^{-8}, \mathrm{tol})$ in a
            step, so an exponent after $n$ steps and time T one of about $\sqrt n/T$ times that.
        max_steps: Most steps that one trajectory may take; one that needs more ends with the outcome "max steps".

    Raises:
        ParameterError: A value outside its range.

    References:
        Jorba and Zou, Experimental Mathematics 14 (2005) 99.
    """

    name: ClassVar[str] = "taylor"

    tol: float = 1e-15
    order: int | None = None
    precision: Literal["double", "mixed"] = "double"
    max_steps: int = MAX_STEPS

    def __post_init__(self) -> None:
        """Checks the ranges and keeps plain numbers, which can be written to a file."""
        _keep(self, tol=_as_tolerance(self.tol, ROUND_OFF, "1.1e-16", "try 1e-15"))
        if self.order is not None:
            _keep(self, order=as_count(self.order, "order", least=2, most=MAX_ORDER, hint="leave it out to be chosen"))
        _check_precision(self)
        _keep(self, max_steps=_as_budget(self.max_steps))

    def core(self) -> _core.Method:
        """The method as the core takes it."""
        return _core.Method.taylor(self.tol, self.order, self.precision == "mixed", self.max_steps)

    def __str__(self) -> str:
        return f"Taylor method, tolerance {self.tol:g}" + _in_precision(self.precision)


@explains_its_methods
@dataclass(frozen=True)
class RungeKutta:
    r"""The explicit Runge-Kutta method of order 8 of Dormand and Prince, for coarse and middle accuracy and any field.

    Twelve evaluations of the field a step.  Steps adapt to `tol`, by the embedded estimates of orders 5 and 3, or are
    equal.  They end at every wanted time.  No conserved quantity is kept beyond the accuracy of the solution.

    Example:
        >>> oscillator = lp.System(lp.canonical(1), "dot(p, p)/2 + dot(q, q)/2")
        >>> turn = lp.integrate(oscillator, [1, 0], times=[0, 2 * np.pi], method=lp.RungeKutta(tol=1e-9))
        >>> bool(np.abs(turn.end_state - turn.start).max() < 1e-8), int(turn.n_steps[0])
        (True, 16)

    Args:
        tol: Error of a step relative to the size of the state, and of each tangent vector, from 1.1e-16 to 0.1.
        step: Equal steps of at most this size, instead of `tol`.
        precision: "double", or "single" (tops and quadratic fields): everything in single precision, twice as many
            trajectories to a register; each step rounds to 6e-8 of the state, and `tol` is at least 9.6e-7.
        compensated: Carry the rounding error of the sums $x + h\sum_i b_i k_i$ of the state from step to step.
        max_steps: Most steps that one trajectory may take, steps that were refused included.

    Raises:
        ParameterError: A value outside its range, or both `tol` and `step`.

    References:
        Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, 2nd ed. (1993), DOP853.
    """

    name: ClassVar[str] = "runge-kutta"

    tol: float | None = None
    step: float | None = None
    precision: Literal["double", "single"] = "double"
    compensated: bool = False
    max_steps: int = MAX_STEPS

    def __post_init__(self) -> None:
        """Checks the ranges and keeps plain numbers, which can be written to a file."""
        _check_precision(self)
        if self.tol is not None and self.step is not None:
            raise ParameterError(
                "RungeKutta: wanted tol for adaptive steps or step for equal ones; got both; leave out one"
            )
        if self.step is not None:
            _keep(self, step=_as_step(self.step))
        else:
            least, name = (ROUND_OFF, "1.1e-16") if self.precision == "double" else (SINGLE_TOLERANCE, "9.6e-7")
            default = 1e-8 if self.precision == "double" else 1e-5
            _keep(self, tol=_as_tolerance(default if self.tol is None else self.tol, least, name, f"try {default:g}"))
        if self.compensated not in (True, False):
            raise ParameterError(f"compensated: wanted True or False; got {shown(self.compensated)}")
        if self.compensated and self.precision == "single":
            raise ParameterError('compensated: wanted precision="double"; got "single"; leave one of them out')
        _keep(self, max_steps=_as_budget(self.max_steps))

    def core(self) -> _core.Method:
        """The method as the core takes it."""
        return _core.Method.runge_kutta(
            self.tol, self.step, self.precision == "single", self.compensated, self.max_steps
        )

    def __str__(self) -> str:
        how = f"tolerance {self.tol:g}" if self.step is None else f"step {self.step:g}"
        compensated = ", compensated sums" if self.compensated else ""
        return f"Runge-Kutta method of order 8, {how}{compensated}" + _in_precision(self.precision)


@explains_its_methods
@dataclass(frozen=True)
class Splitting:
    r"""Composition of the exact flows of the pieces of the Hamiltonian: a Poisson map that keeps every Casimir.

    For a top $H = T + V$: T flows by rotations (two for equal moments, else three), $V = a\cdot\alpha + b\cdot\beta$ by
    a polynomial in time.  For any other `System` the Hamiltonian must be a polynomial, a sum of powers of linear forms:
    $F(\xi\cdot x)$ flows by $\exp(t F'(\xi\cdot x)\,\mathrm{ad}^*_\xi)$.  The energy is not kept, but its error stays
    bounded over very long times.  Steps are equal and end at every wanted time.

    Example:
        >>> top, start = lp.Top.kovalevskaya(), {"l": (1, 0, 1), "alpha3": 1}
        >>> run = lp.integrate(top, start, t_end=1000, method=lp.Splitting(step=0.05))
        >>> bool(run.drift["C1"].max() < 1e-12), bool(run.drift["H"].max() < 1e-8)  # a Poisson map
        (True, True)

    Args:
        step: Largest step, in units of the system's own time.
        order: 2, 4, 6 or 8.
        precision: "double", or "single" (tops only): everything in single precision.
        max_steps: Most steps that one trajectory may take.

    Raises:
        ParameterError: A value outside its range.

    References:
        McLachlan, Phys. Rev. Lett. 71 (1993) 3043 (Lie-Poisson splitting); Strang (1968); Blanes and Moan, J. Comput.
        Appl. Math. 142 (2002) 313 (orders 4 and 6); Kahan and Li, Math. Comp. 66 (1997) 1089 (order 8).
    """

    name: ClassVar[str] = "splitting"

    step: float
    order: int = 4
    precision: Literal["double", "single"] = "double"
    max_steps: int = MAX_STEPS

    def __post_init__(self) -> None:
        """Checks the ranges and keeps plain numbers, which can be written to a file."""
        _keep(self, step=_as_step(self.step), order=_as_even_order(self.order), max_steps=_as_budget(self.max_steps))
        _check_precision(self)

    def core(self) -> _core.Method:
        """The method as the core takes it."""
        return _core.Method.splitting(self.order, self.step, self.precision == "single", self.max_steps)

    def __str__(self) -> str:
        return f"splitting of order {self.order}, step {self.step:g}" + _in_precision(self.precision)


@explains_its_methods
@dataclass(frozen=True)
class Gauss:
    r"""Gauss collocation: implicit, keeps every linear and quadratic invariant to round-off, at any step.

    Order 2 is the implicit midpoint rule $x' = x + h f((x + x')/2)$.  For a canonical bracket these maps are
    symplectic; for a Lie-Poisson bracket they are not Poisson maps.  The implicit equations are solved to round-off;
    where that fails the trajectory ends with the outcome "no convergence".  Steps are equal and end at every wanted
    time.

    Example:
        >>> body = lp.catalog.euler_top_on("so(3)", [1, 2, 3])
        >>> run = lp.integrate(body, [1, 1, 1], t_end=100, method=lp.Gauss(step=0.1, order=2))
        >>> {name: bool(drift.max() < 1e-13) for name, drift in run.drift.items()}  # both are quadratic
        {'H': True, 'C1': True}

    Args:
        step: Largest step, in units of the system's own time.
        order: 2, 4, 6 or 8: twice the number of stages.
        max_steps: Most steps that one trajectory may take.

    Raises:
        ParameterError: A value outside its range.

    References:
        Hairer, Lubich and Wanner, Geometric Numerical Integration, 2nd ed. (2006), II.1.3 and IV.2; Ge and Marsden,
        Phys. Lett. A 133 (1988) 134; Hairer, McLachlan and Razakarivony, BIT 48 (2008) 231 (iteration, sums).
    """

    name: ClassVar[str] = "gauss"

    step: float
    order: int = 4
    max_steps: int = MAX_STEPS

    def __post_init__(self) -> None:
        """Checks the ranges and keeps plain numbers, which can be written to a file."""
        _keep(self, step=_as_step(self.step), order=_as_even_order(self.order), max_steps=_as_budget(self.max_steps))

    def core(self) -> _core.Method:
        """The method as the core takes it."""
        return _core.Method.gauss(self.order // 2, self.step, self.max_steps)

    def __str__(self) -> str:
        name = "implicit midpoint rule" if self.order == 2 else f"Gauss method of order {self.order}"
        return f"{name}, step {self.step:g}"


@explains_its_methods
@dataclass(frozen=True)
class LagrangeMap:
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

    def __post_init__(self) -> None:
        """Checks the ranges and keeps plain numbers, which can be written to a file."""
        _keep(self, step=_as_step(self.step), max_steps=_as_budget(self.max_steps))

    def core(self) -> _core.Method:
        """The method as the core takes it."""
        return _core.Method.lagrange_map(self.step, self.max_steps)

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
        if not isinstance(field, TopField) or not _is_lagrange(field) or field.a[2] == 0.0:
            raise ParameterError(f"integrals: {_NOT_LAGRANGE}, a not zero; got {shown(top)}")
        states = as_array(states, "states", TOP_COMPONENTS)
        if states.ndim == 0 or states.shape[-1] != 9:
            raise ShapeError(
                f"states must end in 9 components (l, alpha, beta); got shape {states.shape}. Transpose it?"
            )
        return _lax_coefficients(field, self.step, states)

    def __str__(self) -> str:
        return f"discrete Lagrange top, step {self.step:g}"


_NOT_LAGRANGE = "wanted a top with I1 = I2 and with a and b along the third axis"


def _is_lagrange(field: TopField) -> bool:
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


Method: TypeAlias = Taylor | RungeKutta | Splitting | Gauss | LagrangeMap
METHODS: Mapping[str, type[Method]] = {method.name: method for method in get_args(Method)}
"""All methods by name, as results have them."""


@explains_its_methods
@dataclass(frozen=True)
class Auto:
    r"""The cheaper one of `Taylor` and `RungeKutta` for a system and a tolerance; the text "auto" is `Auto()`.

    What is chosen runs as if it had been given: results, files and reruns name it.  Operations are counted, not timed,
    so that all processors choose alike.  A step of Taylor's method, of order N, is $\rho\,\mathrm{tol}^{1/(N-1)}$ long
    in units that depend on the orbit, one of the Runge-Kutta method $c\rho\,\mathrm{tol}^{1/8}$, with c measured, about
    4/3 for all systems.  With $W_T$ and $W_R$ operations in a step, those of the field with one tangent vector and of
    the method itself, the Runge-Kutta method is taken where
    $W_R\,\mathrm{tol}^{-1/8}/c < W_T\,\mathrm{tol}^{-1/(N-1)}$.
    Where power series are needed (sections, dense output) it is always `Taylor`.

    Example:
        >>> top, start = lp.Top.kovalevskaya(), {"l": (1, 0, 1), "alpha3": 1}
        >>> [lp.integrate(top, start, t_end=10, method=lp.Auto(tol=tol)).method.name for tol in (1e-5, 1e-13)]
        ['runge-kutta', 'taylor']

    Args:
        tol: The tolerance of either, from 1.1e-16 to 0.1; by default that of the function's own default method.
        max_steps: Most steps that one trajectory may take; by default as many as with that method.

    Raises:
        ParameterError: A value outside its range.
    """

    name: ClassVar[str] = "auto"

    tol: float | None = None
    max_steps: int | None = None

    def __post_init__(self) -> None:
        """Checks the ranges and keeps plain numbers, which can be written to a file."""
        if self.tol is not None:
            _keep(self, tol=_as_tolerance(self.tol, ROUND_OFF, "1.1e-16", "try 1e-8"))
        if self.max_steps is not None:
            _keep(self, max_steps=_as_budget(self.max_steps))

    def __str__(self) -> str:
        return "Taylor or Runge-Kutta method" + ("" if self.tol is None else f", tolerance {self.tol:g}")


MethodChoice: TypeAlias = Method | Auto | Literal["auto"]
"""What callers may give."""
CHOICES: Mapping[str, type[Method | Auto]] = {**METHODS, Auto.name: Auto}
"""What they may name: commands, sweep files and messages have names and options from here."""


@cache
def precisions(kind: type[Method | Auto]) -> tuple[str, ...]:
    """The precisions that a method has, the default one first."""
    return get_args(get_type_hints(kind).get("precision")) or ("double",)


def as_choice(method: Any) -> Method | Auto | None:
    """What a caller gives as a method, checked.

    Raises:
        ParameterError: It is not a method object.
    """
    if isinstance(method, str) and method == Auto.name:
        return Auto()
    if method is not None and not isinstance(method, tuple(CHOICES.values())):
        names = ", ".join(kind.__name__ for kind in CHOICES.values())
        raise ParameterError(
            f'method: wanted a method object ({names}) or "auto"; got {shown(method)}; try method=Taylor(tol=1e-13)'
        )
    return method


def as_method(method: Any, default: Taylor, system: Any = None, *, in_series: bool = False) -> Method:
    """The method that runs: the one that a caller gives, the default for None, the cheaper one for `Auto`.

    Args:
        method: What the caller gives.
        default: The method for None; `Auto` has from it what it does not say itself.
        system: What is integrated.
        in_series: Whether power series are needed, so that `Auto` has no choice.

    Raises:
        ParameterError: It is not a method object.
    """
    chosen = as_choice(method)
    if chosen is None:
        return default
    if not isinstance(chosen, Auto):
        return chosen
    tol = default.tol if chosen.tol is None else chosen.tol
    max_steps = default.max_steps if chosen.max_steps is None else chosen.max_steps
    if in_series or not core_field(as_field(system)).prefers_runge_kutta(tol):
        return Taylor(tol=tol, max_steps=max_steps)
    return RungeKutta(tol=tol, max_steps=max_steps)


def field_for(system: Any, field: Field, method: Method) -> Field:
    """The description of the system that the method works on: its field, or the pieces of its Hamiltonian.

    Raises:
        ParameterError: The method does not apply to such a field.
    """
    if isinstance(field, PiecesField):
        if not isinstance(method, Splitting):
            raise ParameterError(
                f"method: wanted Splitting for a field given by its pieces; got {method}; try Splitting(step=0.1)"
            )
        return _with_precision(field, method)
    if isinstance(method, LagrangeMap) and not (isinstance(field, TopField) and _is_lagrange(field)):
        instead = "Splitting(step=0.1)" if isinstance(field, TopField) else "Taylor()"
        raise ParameterError(f"method: LagrangeMap {_NOT_LAGRANGE}; got another field; try {instead}")
    if isinstance(method, Splitting) and not isinstance(field, TopField):
        if not has_pieces(system):
            raise ParameterError(
                f"method: Splitting wants the pieces of a Hamiltonian; {shown(system.name)} is integrated as a "
                f"{field.name} of {field.n_components} components, which has none; "
                + ("give the system that the field is from, or try Taylor()" if system is field else "try Taylor()")
            )
        return _with_precision(system.pieces(), method)
    return _with_precision(field, method)


def _with_precision(field: Field, method: Method) -> Field:
    precision = getattr(method, "precision", "double")
    allowed = (TopField, QuadraticField) if isinstance(method, RungeKutta) else TopField
    if precision != "double" and not isinstance(field, allowed):
        fields = "tops and quadratic fields" if isinstance(method, RungeKutta) else "tops"
        raise ParameterError(
            f'precision: wanted "double" for a {field.name}; got {precision!r}, which is for {fields}; leave it out'
        )
    return field


def method_record(method: Method | Auto) -> dict[str, Any]:
    """The method as plain data that JSON can write."""
    return {"name": method.name, **asdict(method)}


def method_of(record: Mapping[str, Any]) -> Method:
    """The method that `method_record` has written.

    Raises:
        KeyError, TypeError, ValueError: `method_record` did not write it.
    """
    values = dict(record)
    return METHODS[values.pop("name")](**values)


def choice_of(record: Mapping[str, Any]) -> Method | Auto:
    """The same where it may also be a choice that is still to be made."""
    values = dict(record)
    return CHOICES[values.pop("name")](**values)


def _keep(method: Method | Auto, **values: object) -> None:
    for name, value in values.items():
        object.__setattr__(method, name, value)


def _as_tolerance(value: Any, least: float, least_name: str, hint: str) -> float:
    tol = as_number(value, "tol", f"a number from {least_name} to 0.1")
    if not least <= tol <= 0.1:
        raise ParameterError(f"tol: wanted a number from {least_name} to 0.1; got {tol!r}; {hint}")
    return tol


def _as_step(value: Any) -> float:
    step = as_number(value, "step", "a positive number")
    if not 1e-300 <= step <= 1e300:
        raise ParameterError(f"step: wanted a positive number, from 1e-300 to 1e300; got {step!r}; try 0.1")
    return step


def _as_even_order(value: Any) -> int:
    check_choice(value, "order", (2, 4, 6, 8), "try 4")
    return int(value)


def _as_budget(value: Any) -> int:
    return as_count(value, "max_steps", least=1, hint="try 1_000_000")


def _check_precision(method: Taylor | RungeKutta | Splitting) -> None:
    choices = precisions(type(method))
    if method.precision not in choices:
        wanted = " or ".join(f'"{choice}"' for choice in choices)
        raise ParameterError(
            f"precision: wanted {wanted}; got {shown(method.precision)}; leave it out for {choices[0]} precision"
        )


def _in_precision(precision: str) -> str:
    return "" if precision == "double" else f", {precision} precision"
