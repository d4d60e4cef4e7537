r"""The sleeping top: a symmetric top that spins upright, ordinary, charged or twisted.

With $I_1 = I_2$ and $a, b$ along the axis, $\ell, \alpha, \beta$ parallel to it is an equilibrium. A perturbation
$(\ell, \alpha, \beta)_1 + i(\ell, \alpha, \beta)_2$ turns as $\exp(-i(\ell_3/I_3 + \mu/I_1)t)$ with $\mu$ a
root of

$$Q(\mu) = \mu^3 + \ell_3\mu^2 + I_1(a_3\alpha_3 + b_3\beta_3)\mu + \epsilon a_3^2 I_1^2\beta_3 .$$
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from liepoisson.algebra.exact_numbers import Exact, as_float, is_zero
from liepoisson.equilibrium.linearisation import ComplexArray
from liepoisson.equilibrium.stability import Equilibrium, equilibrium, has_own_motion
from liepoisson.errors import ParameterError
from liepoisson.formula.parameters import Parameter, read_parameter
from liepoisson.inputs.arrays import Array, ReadOnlyArrays
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.portable import linear

if TYPE_CHECKING:
    from liepoisson.model.system import System
    from liepoisson.model.top_parameters import TopParameters


@dataclass(frozen=True, eq=False)
class SleepingTop(ReadOnlyArrays):
    r"""A sleeping top and the polynomial Q that decides on its stability.

    Example:
        >>> slow = lp.phase_space.sleeping_top(lp.Top.lagrange(), l3=1, alpha3=1)
        >>> [str(number) for number in slow.polynomial], slow.linear_stability, round(slow.growth_rate, 6)
        (['1', '1', '1', '0'], 'unstable', 0.866025)

    Attributes:
        system: The top.
        state: The state $(0, 0, \ell_3, 0, 0, \alpha_3, 0, 0, \beta_3)$, shape (9,).
        polynomial: The exact coefficients of Q, from that of $\mu^3$ = 1 down.
        inertia: The moments $I_1$ and $I_3$.
    """

    system: System
    state: Array
    polynomial: tuple[Exact, Exact, Exact, Exact]
    inertia: tuple[Exact, Exact]

    @property
    def _essential(self) -> tuple[Exact, ...]:
        """Q, without a root 0.

        That root occurs where epsilon a3 beta3 = 0. It belongs to a perturbation that leaves the leaf, or that tilts a
        field which does not act on the others.
        """
        return self.polynomial[:3] if is_zero(self.polynomial[3]) else self.polynomial

    @cached_property
    def discriminant(self) -> Exact:
        r"""The exact discriminant: positive if and only if all roots are real and distinct.

        That of Q; if its constant term vanishes, that of $Q/\mu$, $\ell_3^2 - 4I_1(a_3\alpha_3 + b_3\beta_3)$.
        """
        _, p, q, *rest = self._essential
        if not rest:
            return p**2 - 4 * q
        r = rest[0]
        return 18 * p * q * r - 4 * p**3 * r + p**2 * q**2 - 4 * q**3 - 27 * r**2

    @property
    def linear_stability(self) -> str:
        """By the sign of the discriminant, exactly: "stable spectrum", "unstable"; "degenerate" where it vanishes."""
        if is_zero(self.discriminant):
            return "degenerate"
        return "stable spectrum" if self.discriminant > 0 else "unstable"

    @cached_property
    def roots(self) -> ComplexArray:
        """The roots of Q, or of Q divided by mu; three or two."""
        found = linear.roots([as_float(c, "Q") for c in self._essential])
        return np.sort_complex(found.astype(np.complex128))

    @property
    def frequencies(self) -> ComplexArray:
        r"""The frequencies $\ell_3/I_3 + \mu/I_1$ of the perturbations in the body frame, complex if unstable."""
        first, third = (as_float(moment, "I") for moment in self.inertia)
        return self.state[2] / third + self.roots / first

    @property
    def growth_rate(self) -> float:
        r"""The growth rate $\max|\operatorname{Im}\mu|/I_1$, 0 if the spectrum is stable."""
        if self.linear_stability != "unstable":
            return 0.0
        return float(np.abs(self.roots.imag).max()) / as_float(self.inertia[0], "I1")

    def analysis(self, along: Sequence[str] | None = None) -> Equilibrium:
        """The same state by its linearisation in numbers, with the energy-Casimir test; see `equilibrium`.

        Args:
            along: The integrals that may be added to H, all of them critical here; by default l3 and the others that
                are known and have a motion of their own.
        """
        if along is None:
            along = [name for name in self.system.invariants if has_own_motion(self.system, name)]
        return equilibrium(self.system, self.state, along=along)


@explains_its_arguments
def sleeping_top(system: System, *, l3: Parameter, alpha3: Parameter, beta3: Parameter = 0) -> SleepingTop:
    r"""A symmetric top with $\ell$, $\alpha$ and $\beta$ along its axis.

    Example:
        >>> top = lp.Top.lagrange()
        >>> [lp.phase_space.sleeping_top(top, l3=spin, alpha3=1).linear_stability for spin in (1, 2, 3)]
        ['unstable', 'degenerate', 'stable spectrum']

    Args:
        system: A top with $I_1 = I_2$ and a, b along the third axis.
        l3: Spin. Numbers are read exactly: 0.1 is 1/10.
        alpha3: First field.
        beta3: Second field.

    Raises:
        ParameterError: the system is no such top, a parameter has no number, or all of the fields vanish.

    References: Audin (1996), for the ordinary top; Q of the charged top by the automorphism
    $\alpha \to \alpha + (b_3/a_3)\beta$ of the bracket.
    """
    top = _symmetric_top(system)
    spin, alpha, beta = (read_parameter(v, n) for v, n in ((l3, "l3"), (alpha3, "alpha3"), (beta3, "beta3")))
    a3, b3, moment = top.a[2], top.b[2], top.inertia[0]
    linear = moment * (a3 * alpha + b3 * beta)
    constant = top.epsilon * a3**2 * moment**2 * beta
    state = np.zeros(9)
    state[2::3] = [as_float(v, n) for v, n in ((spin, "l3"), (alpha, "alpha3"), (beta, "beta3"))]
    if not state[5] and not state[8]:
        raise ParameterError("alpha3 or beta3 must not be zero: without a field there is no upright. Give one.")
    return SleepingTop(system, state, (read_parameter(1, "1"), spin, linear, constant), (moment, top.inertia[2]))


def _symmetric_top(system: System) -> TopParameters:
    top = system.top_parameters
    if top is None or top.symbols or len(system.variables) != 9:
        raise ParameterError(
            f"a sleeping top must be a Top of nine variables with numbers for parameters; got {system.name!r}. Take "
            "Top.lagrange(transverse=..., axial=..., a3=...), or Top.twisted_lagrange."
        )
    if not is_zero(top.inertia[0] - top.inertia[1]) or not all(is_zero(v) for v in (*top.a[:2], *top.b[:2])):
        raise ParameterError(
            "a sleeping top must have I1 = I2 and a, b along the third axis; got inertia "
            f"{tuple(map(str, top.inertia))}, a = {tuple(map(str, top.a))}, b = {tuple(map(str, top.b))}. "
            "Use Top.lagrange or Top.twisted_lagrange."
        )
    return top
