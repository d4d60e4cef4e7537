"""Hamiltonians that depend on time: how they are told from others, and the autonomous system that they become.

Time is the name t in a formula, where no coordinate and no parameter has it.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, cast

from liepoisson.algebra.exact_numbers import read_number, to_sympy
from liepoisson.errors import ParameterError
from liepoisson.formula.parameters import GivenValue
from liepoisson.formula.scope import Scope
from liepoisson.inputs.names import MOMENTUM_OF_TIME, TIME
from liepoisson.model.hamiltonian import Hamiltonian, apply_function, is_expression, scope_of
from liepoisson.structure.bracket import Bracket

if TYPE_CHECKING:
    from sympy import Expr

_WITH_MOMENTUM = f" + {MOMENTUM_OF_TIME}"
_NAME = re.compile(r"[A-Za-z_]\w*")


def suspended(
    bracket: Bracket,
    hamiltonian: Hamiltonian,
    parameters: Mapping[str, GivenValue] | None,
    symbols: Sequence[str],
    period: Any,
) -> tuple[Bracket, Hamiltonian]:
    r"""The bracket and the Hamiltonian $H + p_t$ of the autonomous system; both as they are where H knows no time.

    A Python function is asked for its formula only where a period is given.

    Raises:
        ParameterError: a period is given, and H does not depend on time, or the period is no number or formula; or H
            contains the momentum of time.
        BracketError: the bracket has a coordinate p_t.
        ExpressionError: the period is not in the grammar, or a name in it is not known.
    """
    if period is not None and callable(hamiltonian) and not is_expression(hamiltonian):
        hamiltonian = apply_function(hamiltonian, bracket)
    if not _occurs(hamiltonian) or scope_of(bracket, parameters, symbols).owner(TIME) is not None:
        if period is not None:
            raise ParameterError(
                f"period: wanted a Hamiltonian that depends on time t; got {hamiltonian!s:.80}, where t "
                f"{'is no time' if _occurs(hamiltonian) else 'does not occur'}. Leave the period out, or write t for "
                "time and for nothing else."
            )
        return bracket, hamiltonian
    if (
        _occurs(hamiltonian, MOMENTUM_OF_TIME)
        and scope_of(bracket, parameters, symbols).owner(MOMENTUM_OF_TIME) is None
    ):
        raise ParameterError(
            f"wanted a Hamiltonian H of the coordinates and of time {TIME}; got {hamiltonian!s:.80} with "
            f"{MOMENTUM_OF_TIME}, the momentum of time, which is added by itself: K = H + {MOMENTUM_OF_TIME}. Leave it "
            "out."
        )
    from liepoisson.structure.suspension import Suspension

    whole = Suspension(
        bracket, None if period is None else _read_period(period, scope_of(bracket, parameters, symbols))
    )
    if isinstance(hamiltonian, str):
        return whole, hamiltonian + _WITH_MOMENTUM
    from sympy import Symbol

    return whole, cast("Any", hamiltonian) + Symbol(MOMENTUM_OF_TIME)


def _occurs(hamiltonian: Any, name: str = TIME) -> bool:
    """Whether the name of time, or of its momentum, is in a formula."""
    if isinstance(hamiltonian, str):
        return name in _NAME.findall(hamiltonian)
    return any(str(symbol) == name for symbol in getattr(hamiltonian, "free_symbols", ()))


def _read_period(given: Any, scope: Scope) -> Expr:
    """The period as an expression in parameters."""
    from liepoisson.formula.expression import read_expression

    if isinstance(given, str):
        found: Any = read_expression(given, scope)
    elif is_expression(given):
        found = given
    else:
        found = to_sympy(read_number(given, "period"))
    inside = sorted(str(symbol) for symbol in found.free_symbols)
    if unknown := [name for name in inside if name in scope.coordinates() or name not in scope.numbers()]:
        raise ParameterError(
            f"period: wanted a number, or a formula in parameters; got {given!s:.60} with {unknown[0]}, which is none. "
            'Write for example "2*pi/w".'
        )
    return cast("Expr", found)


def check_rate_of_time(energy: Expr, momentum: Expr) -> None:
    r"""Refuse a Hamiltonian on a bracket with time that does not let it pass, $\dot t = 1$.

    Raises:
        ParameterError: it is not H + p_t.
    """
    if energy.diff(momentum) != 1:
        raise ParameterError(
            f"wanted a Hamiltonian H(x, t) + {momentum} for a bracket with time, so that t' = 1; got {energy!s:.80}. "
            f"Give the bracket without time, bracket.base: {momentum} is added by itself there."
        )


def check_period(energy: Expr, time: Expr, period: Expr) -> None:
    """Refuse what is no period of a Hamiltonian.

    Raises:
        ParameterError: it is not positive, or the Hamiltonian is another one after it.
    """
    from liepoisson.structure.circles import change

    found: Any = period
    if found.is_number and not (found.is_finite and found.is_positive):
        raise ParameterError(f"period: wanted a positive number; got {found}. Write for example 2*pi/w.")
    if (moved := change(energy, time, period)) != 0:
        from sympy.calculus.util import periodicity

        try:
            known: Any = periodicity(energy, time)
        except (NotImplementedError, ValueError, TypeError):
            known = None
        is_one = known is not None and change(energy, time, known) == 0
        hint = f"The formula has the period {known}." if is_one else "Leave the period out of a formula that has none."
        raise ParameterError(
            f"period: wanted one of the Hamiltonian; got {period}, after which {energy!s:.80} changes by "
            f"{moved!s:.80}. {hint}"
        )


def given_text(text: str) -> str:
    """The formula of the Hamiltonian as it was given, without the momentum of time."""
    return text.removesuffix(_WITH_MOMENTUM)
