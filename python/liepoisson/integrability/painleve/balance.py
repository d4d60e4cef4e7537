"""Balances: leading terms of singular solutions, with their exponents and what the test found about their series."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from liepoisson.algebra.function_fields import FunctionField
from liepoisson.algebra.number_fields import Element
from liepoisson.errors import ParameterError
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.integrability.painleve.expansion import Expansion, FreeConstant, Resonance
from liepoisson.integrability.painleve.exponents import Exponents
from liepoisson.integrability.painleve.laurent import LaurentSeries, laurent_series

if TYPE_CHECKING:
    from sympy import Symbol

Status: TypeAlias = Literal["passes", "passes weakly", "fails", "undecided"]

_MOST_EQUATIONS = 9
"""Equations of a balance that are printed."""

_MOST_CONDITIONS = 2
"""Conditions for a series without logarithms that are printed."""


@dataclass(frozen=True, repr=False)
class Balance:
    r"""Leading terms $x_i = c_i\,\tau^{-g_i}$ of singular solutions: one balance with its conjugates, or a family.

    Attributes:
        variables: The coordinates.
        weights: The orders $g_i$ of the poles, for coordinates whose $c_i$ is not zero.
        equations: Polynomials in the names of the coordinates that vanish at c.
        family: Names of the coordinates whose leading coefficients are free; empty for an isolated balance.
        n_conjugates: How many balances these are, with the same exponents up to conjugation; for a family, how many for
            each value of its parameters.
        kovalevskaya: The exponents.
        resonances: The rational exponents with the dimensions of the kernels and with the conditions of compatibility.
        is_generic: False where a random member of a family was taken.
        obstructions: What makes solutions branch, in words; empty if nothing was found.
        left: What was not decided; empty if nothing is left.
    """

    variables: tuple[Symbol, ...]
    weights: tuple[Fraction, ...]
    equations: tuple[str, ...]
    family: tuple[str, ...]
    n_conjugates: int
    kovalevskaya: Exponents
    resonances: tuple[Resonance, ...]
    is_generic: bool
    obstructions: tuple[str, ...]
    left: str
    _point: tuple[Element, ...] = field(repr=False)
    _field: FunctionField = field(repr=False)
    _parameters: tuple[str, ...] = field(repr=False, default=())
    _expansion: Expansion | None = field(repr=False, default=None, hash=False)

    @property
    def exponents(self) -> tuple[Fraction, ...]:
        """The rational exponents, each as often as its multiplicity, in increasing order."""
        return tuple(r for r, k in self.kovalevskaya.rational for _ in range(k))

    @property
    def other_exponents(self) -> tuple[complex, ...]:
        """The irrational exponents, to double precision, of all conjugates; none where they depend on parameters."""
        return tuple(complex(float(z.real.mid()), float(z.imag.mid())) for z in self.kovalevskaya.others)

    @property
    def kernels(self) -> dict[Fraction, tuple[int, int]]:
        """For each rational exponent its multiplicity and the dimension of the kernel, which must be equal."""
        return {r.exponent: (r.multiplicity, r.kernel) for r in self.resonances}

    @property
    def constants(self) -> tuple[FreeConstant, ...]:
        """The free constants of the series, those of the family and the position of the singularity left out."""
        return () if self._expansion is None else tuple(self._expansion.constants)

    @property
    def n_constants(self) -> int:
        """The number of free constants of the solutions: the position of the singularity, the family, and others."""
        return 1 + len(self.family) + len(self.constants)

    @property
    def is_principal(self) -> bool:
        """Whether these are as many as a general solution has."""
        return self.n_constants == len(self.variables)

    @property
    def n_log_free(self) -> int | None:
        r"""The number of solutions without logarithms of the variational equation of $c\,\tau^{-g}$.

        None if not all exponents are rational.
        """
        if not self.kovalevskaya.all_rational:
            return None
        return sum(r.kernel for r in self.resonances)

    @property
    def has_branch_points(self) -> bool:
        """Whether exponents, or orders of poles, are rational numbers that are not whole."""
        orders = [g for g, c in zip(self.weights, self._point, strict=True) if c]
        rational = (r for r, _ in self.kovalevskaya.rational)
        return any(x.denominator > 1 for x in (*orders, *rational))

    @property
    def is_negative(self) -> bool:
        """Whether there are negative exponents besides -1, or -1 more than once."""
        return any(r < 0 and (r != -1 or k > 1) for r, k in self.kovalevskaya.rational)

    @property
    def symbols(self) -> tuple[str, ...]:
        """The symbols of the system, for general values of which this holds."""
        return self._parameters

    @property
    def status(self) -> Status:
        """What the test says of this balance."""
        if self.obstructions:
            return "fails"
        if self.left:
            return "undecided"
        return "passes weakly" if self.has_branch_points else "passes"

    def __repr__(self) -> str:
        return f"<Balance: exponents {self.kovalevskaya}; {self.status}>"

    def __str__(self) -> str:
        """The leading coefficients, the exponents and what was found."""
        many = f", {self.n_conjugates} conjugate" if self.n_conjugates > 1 else ""
        kind = f"a family, {', '.join(self.family)} free{many}" if self.family else f"isolated{many}"
        kind += "" if self.is_generic else ", at a random member"
        lines = [f"{self.status}: {kind}", f"  {self._leading()}", f"  exponents {self.kovalevskaya}"]
        lines += [f"  {text}" for text in self.obstructions]
        if self.left:
            lines.append(f"  {self.left}")
        if not self.obstructions:
            general = ", as a general solution" if self.is_principal else ""
            lines.append(f"  {self.n_constants} free constants{general}")
        return "\n".join(lines)

    def _leading(self) -> str:
        names = [str(v).lstrip("_") for v in self.variables]
        shown = [(name, self._field.rational(c)) for name, c in zip(names, self._point, strict=True)]
        orders = dict(zip(names, self.weights, strict=True))
        simple = [_leading_term(name, str(c), orders[name]) for name, c in shown if c]
        zero = [name for name, c in shown if c is not None and not c]
        if all(c is not None for _, c in shown):
            return ", ".join(simple)
        rest = [e for e in self.equations if not _is_solved(e)]
        more = f", ... ({len(rest)} equations)" if len(rest) > _MOST_EQUATIONS else ""
        text = [*simple, *(f"{e} = 0" for e in rest[:_MOST_EQUATIONS])]
        return f"{', '.join(text)}{more}" + (f"; {', '.join(zero)} = 0" if zero else "")

    @explains_its_arguments
    def series(
        self,
        constants: Mapping[str, complex] | None = None,
        *,
        n_terms: int = 40,
        conjugate: int = 0,
    ) -> LaurentSeries:
        r"""The series of one solution, $x_i = \tau^{-g_i}\sum_k c_i^{(k)}\tau^k$, to double precision.

        Args:
            constants: Values of the free constants C1, C2, ..., of the coordinates of `family`, and of parameters of
                the system; those that are left out are zero, and 1 for the family.
            n_terms: The number of terms.
            conjugate: Which of the conjugate balances, from 0.

        Raises:
            ParameterError: a name is no free constant, or the series has a logarithm or was not computed.
        """
        if self._expansion is None or self.status == "fails":
            raise ParameterError(
                f"series: wanted a balance whose series has no logarithm; got one that {self.status}; take another"
            )
        return laurent_series(
            self._expansion, self._point, dict(constants or {}), self._parameters, n_terms=n_terms, conjugate=conjugate
        )


def _leading_term(name: str, c: str, order: Fraction) -> str:
    if not order:
        return f"{name} = {c}"
    return (
        f"{name} = {c}/t"
        if order == 1
        else f"{name} = {c}/t^{order}"
        if order.denominator == 1
        else (f"{name} = {c}*t^(-{order})")
    )


def _is_solved(equation: str) -> bool:
    """Whether an equation says that one coordinate is a rational number."""
    from re import fullmatch

    return fullmatch(r"\w+( [+-] [\d/]+)?", equation) is not None


def obstructions_of(exponents: Exponents, resonances: tuple[Resonance, ...], dimension: int) -> tuple[str, ...]:
    """What makes solutions branch."""
    found: list[str] = []
    if not exponents.all_rational:
        depends = exponents.field.parameters and len(exponents.rest) > 1
        whom = " for general values of what they depend on" if depends else ""
        found.append(f"irrational exponents{whom}: infinitely many branches")
    for r in resonances:
        if r.exponent == 0 and r.multiplicity > dimension:
            found.append(
                f"logarithm: the exponent 0 has multiplicity {r.multiplicity}, and the balances have {dimension} free "
                "constants"
            )
        elif r.has_jordan_block:
            found.append(
                f"logarithm: the exponent {r.exponent} has multiplicity {r.multiplicity}, and its kernel has dimension "
                f"{r.kernel}"
            )
        if r.conditions:
            found.append(f"logarithm at the exponent {r.exponent}{_unless(r.conditions, exponents.field.generator)}")
    return tuple(found)


def _unless(conditions: tuple[str, ...], generator: str) -> str:
    """Where there is no logarithm, as words; nothing if there is one in any case."""
    if "1" in conditions:
        return ""
    shown = conditions[:_MOST_CONDITIONS]
    words = ", unless " + " and ".join(f"{_shortened(text)} = 0" for text in shown)
    return words + (f", where {generator}" if any("theta" in text for text in shown) else "")


def _shortened(text: str) -> str:
    return text if len(text) <= 100 else f"{text[:90]} ..."


def as_record(balance: Balance) -> dict[str, Any]:
    """A balance as data that JSON can write."""
    return {
        "status": balance.status,
        "weights": {str(v).lstrip("_"): str(w) for v, w in zip(balance.variables, balance.weights, strict=True)},
        "equations": list(balance.equations),
        "family": list(balance.family),
        "conjugates": balance.n_conjugates,
        "exponents": [str(r) for r in balance.exponents],
        "other_exponents": [[z.real, z.imag] for z in balance.other_exponents],
        "resonances": [
            {
                "exponent": str(r.exponent),
                "multiplicity": r.multiplicity,
                "kernel": r.kernel,
                "conditions": None if r.conditions is None else list(r.conditions),
            }
            for r in balance.resonances
        ],
        "constants": balance.n_constants,
        "principal": balance.is_principal,
        "generic": balance.is_generic,
        "obstructions": list(balance.obstructions),
        "left": balance.left,
    }
