"""Sets of states: a `Locus` by its fields, which vanish, which do not, which are parallel; a `Stratum` of one rank."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, TypeAlias

from liepoisson.inputs.calls import explains_its_methods

if TYPE_CHECKING:
    from sympy import Expr

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
        vanishing: Polynomials in the coordinates that vanish.
        not_all_vanish: Polynomials of which one at least does not vanish; none if there is no such condition.
    """

    zero: Fields = ()
    parallel: tuple[Fields, ...] = ()
    nonzero: tuple[Fields, ...] = ()
    not_parallel: tuple[Fields, ...] = ()
    is_generic: bool = False
    vanishing: tuple[str, ...] = ()
    not_all_vanish: tuple[str, ...] = ()

    @property
    def is_everywhere(self) -> bool:
        """Whether there is no condition."""
        return self == Locus()

    def __str__(self) -> str:
        """The conditions, for example "beta = 0, alpha != 0"; "generic" and "everywhere" if there is none to name."""
        conditions = [
            *(f"{field} = 0" for field in (*self.zero, *self.vanishing)),
            *(f"{' x '.join(pair)} = 0" for pair in self.parallel),
            *(
                f"{some[0] if len(some) == 1 else '(' + ', '.join(some) + ')'} != 0"
                for some in (*self.nonzero, self.not_all_vanish)
                if some
            ),
            *(f"{' x '.join(pair)} != 0" for pair in self.not_parallel),
            *(["generic"] if self.is_generic else []),
        ]
        return ", ".join(conditions) or "everywhere"


@explains_its_methods
@dataclass(frozen=True)
class Stratum:
    """A set of states on which the rank is constant (proved) or constant at generic points.

    Example:
        >>> for stratum in (lp.so(3) @ lp.semidirect(2)).strata()[:2]:
        ...     print(f"{stratum.condition}: rank {stratum.rank}, Casimirs {list(stratum.casimirs)}")
        alpha != 0: rank 4, Casimirs [alpha1*l1 + alpha2*l2 + alpha3*l3, alpha1**2 + alpha2**2 + alpha3**2]
        alpha = 0, l != 0: rank 2, Casimirs [l1**2 + l2**2 + l3**2]

    Attributes:
        locus: The fields that vanish there, that do not, that are parallel.
        rank: The rank of the Poisson tensor, the dimension of the leaves.
        functions: Makes `casimirs`.
        certificate: What was computed.
        proved: Whether the rank is this one everywhere in the set.
        complete: Whether the functions are as many as cut out the leaves (not decided for parallel fields: True).
    """

    locus: Locus
    rank: int
    functions: Callable[[], Sequence[Expr]] = field(repr=False, compare=False)
    certificate: str
    proved: bool
    complete: bool = True

    @cached_property
    def casimirs(self) -> tuple[Expr, ...]:
        """Functions that are constant on the leaves in this set."""
        return tuple(self.functions())

    def __repr__(self) -> str:
        known = f"casimirs={self.casimirs}, certificate={self.certificate!r}"
        return (
            f"Stratum(locus={self.locus!r}, rank={self.rank}, {known}, proved={self.proved}, complete={self.complete})"
        )

    @property
    def condition(self) -> str:
        """The locus as text, for example "beta = 0, alpha != 0"."""
        return str(self.locus)
