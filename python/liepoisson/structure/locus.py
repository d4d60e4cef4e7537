"""Sets of states given by their fields: which vanish, which do not, which are parallel."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from liepoisson.inputs.calls import explains_its_methods

Fields: TypeAlias = "tuple[str, ...]"


@explains_its_methods
@dataclass(frozen=True)
class Locus:
    """States whose fields meet some conditions, all of them; all states if there are none.

    Example:
        >>> for stratum in (lp.so(3) @ lp.leibniz(3)).strata():
        ...     print(f"rank {stratum.rank} where {stratum.locus}")
        rank 6 where beta != 0
        rank 4 where beta = 0, alpha != 0
        rank 2 where beta = 0, alpha = 0, l != 0
        rank 0 where beta = 0, alpha = 0, l = 0

    Attributes:
        zero: Fields that vanish.
        parallel: Pairs of fields that are parallel; a field that vanishes is parallel to any.
        nonzero: Sets of fields, in each of which one at least does not vanish.
        not_parallel: Pairs of fields that are not parallel.
        is_generic: Whether the states are generic among these: no more is known about where they lie.
    """

    zero: Fields = ()
    parallel: tuple[Fields, ...] = ()
    nonzero: tuple[Fields, ...] = ()
    not_parallel: tuple[Fields, ...] = ()
    is_generic: bool = False

    @property
    def is_everywhere(self) -> bool:
        """Whether there is no condition."""
        return self == Locus()

    def __str__(self) -> str:
        """The conditions, for example "beta = 0, alpha != 0"; "generic" and "everywhere" if there is none to name."""
        conditions = [
            *(f"{field} = 0" for field in self.zero),
            *(f"{' x '.join(pair)} = 0" for pair in self.parallel),
            *(f"{some[0] if len(some) == 1 else '(' + ', '.join(some) + ')'} != 0" for some in self.nonzero),
            *(f"{' x '.join(pair)} != 0" for pair in self.not_parallel),
            *(["generic"] if self.is_generic else []),
        ]
        return ", ".join(conditions) or "everywhere"
