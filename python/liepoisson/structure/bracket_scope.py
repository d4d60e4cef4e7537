"""The names that a formula on a bracket may use."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from liepoisson.formula.scope import Scope

if TYPE_CHECKING:
    from liepoisson.formula.parameters import GivenValue
    from liepoisson.structure.bracket import Bracket


def scope_of(
    bracket: Bracket, parameters: Mapping[str, GivenValue] | None = None, symbols: Sequence[str] = ()
) -> Scope:
    """The names of the coordinates of a bracket, its own symbols, and the given parameters and symbols.

    Raises:
        ParameterError: as for a scope.
    """
    scalars = bracket.field_names if bracket.has_scalar_fields else ()
    fields = {} if scalars else dict.fromkeys(bracket.field_names, bracket.algebra.basis_names)
    symbols = (*scalars, *symbols)
    remark = _about_fields(bracket)
    known = Scope(fields, parameters or {}, symbols, scalars, remark)
    missing = sorted(bracket.symbols - set(known.shapes) - set(known.components))
    return Scope(fields, parameters or {}, (*symbols, *missing), scalars, remark) if missing else known


def _about_fields(bracket: Bracket) -> str:
    """How the fields of a bracket get other names; and for se(3), where one field has two vectors, how they get any."""
    if bracket.has_scalar_fields:
        return ""
    if bracket.algebra.name == "se(3)" and len(bracket.field_names) == 1:
        return "Write so(3) @ semidirect(2) for se(3)* with two vectors, l and alpha"
    names = ", ".join(f'"{name}"' for name in ("m", "p", "q", "r")[: len(bracket.field_names)])
    return f"Other names: bracket.rename({names})" if len(bracket.field_names) <= 4 else ""
