r"""Time beside a bracket: the coordinate t and its momentum $p_t$, with $\{t, p_t\} = 1$, which commute with all else.

A Hamiltonian $H(x, t)$ becomes $K = H + p_t$ on the suspension, which is autonomous:

$$\dot x = \{x, H\}, \qquad \dot t = 1, \qquad \dot p_t = -\partial H/\partial t .$$

K is constant, so that $-p_t$ is the energy H up to a constant: what the drive has given.

References: [marsden1999], section 2.2; Arnold, Mathematical Methods of Classical Mechanics, section 45.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Self

from liepoisson.algebra.exact_numbers import substituted, to_sympy
from liepoisson.formula.parameters import values_of_symbols
from liepoisson.inputs.names import MOMENTUM_OF_TIME, TIME
from liepoisson.structure.bracket import Bracket
from liepoisson.structure.given_functions import read_variables
from liepoisson.structure.tensor_bracket import PoissonTensor

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.algebra.exact_numbers import Coefficient


class Suspension(PoissonTensor):
    """A bracket with time and its momentum.

    Args:
        base: The bracket; its coordinates come first.
        period: After which Hamiltonians repeat themselves; None: they do not.

    Attributes:
        base: The bracket.
        period: The period, exact, perhaps with symbols.

    Raises:
        BracketError: the bracket has a coordinate t or p_t.
    """

    clock: ClassVar[str | None] = TIME

    def __init__(self, base: Bracket, period: Expr | None = None) -> None:
        from sympy import S

        names = read_variables((*base.coordinate_names_in_order, TIME, MOMENTUM_OF_TIME))
        self.base, self.period, n = base, period, base.dimension
        J, one = base.poisson_tensor(), S.One
        entries: dict[tuple[int, int], Any] = {(i, j): J[i, j] for j in range(n) for i in range(j) if J[i, j] != 0}
        self._define(names, {**entries, (n, n + 1): one}, f"{base!r} and time")
        self._jacobi = base.jacobi if isinstance(base, PoissonTensor) else "proved"
        self.angles = base.angles

    @cached_property
    def given_casimirs(self) -> tuple[Expr, ...]:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The Casimirs of the bracket, but for traces, which are searched as polynomials."""
        from sympy import Trace

        return tuple(casimir for casimir in self.base.casimirs() if not casimir.has(Trace))

    @property
    def vectors(self) -> Mapping[str, Sequence[str]]:
        """The fields of the bracket that are vectors, with the names of their components."""
        return self.base.vectors

    @property
    def symbols(self) -> set[str]:
        """Names of the parameters kept symbolic, also those of the period."""
        own = set[str]() if self.period is None else {str(s) for s in self.period.free_symbols}
        return super().symbols | own

    def substitute(self, values: Mapping[str, Coefficient]) -> Suspension:
        """The same with values for some of its symbols.

        Raises:
            ParameterError: as for `PoissonTensor.substitute`.
        """
        read: Any = values_of_symbols(values, self.symbols)
        if not read:
            return self
        base = self.base.substitute({name: value for name, value in values.items() if str(name) in self.base.symbols})
        return Suspension(base, None if self.period is None else to_sympy(substituted(self.period, read)))

    def with_angles(self, angles: Sequence[str]) -> Self:
        """The same, where these coordinates of the bracket are angles; time is none.

        Raises:
            LiePoissonError: as for `Bracket.with_angles`.
        """
        return type(self)(self.base.with_angles(angles), self.period)

    def with_casimirs(
        self, casimirs: Sequence[str | Expr] | Mapping[str, str | Expr], *, symbols: Sequence[str] = ()
    ) -> Self:
        """The same with these known Casimirs of the bracket; none depends on time or its momentum.

        Raises:
            LiePoissonError: as for `Bracket.with_casimirs`.
        """
        return type(self)(self.base.with_casimirs(casimirs, symbols=symbols), self.period)

    def __getstate__(self) -> dict[str, Any]:
        """What is pickled: that of a tensor, the bracket and the period."""
        return {**super().__getstate__(), "base": self.base, "period": self.period}
