"""Equilibria of a leaf as a list, with what is known of its completeness."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from liepoisson.inputs.deadline import CUT_SHORT
from liepoisson.io.display import Found
from liepoisson.io.tables import Tabular

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from liepoisson.equilibrium.stability import Equilibrium
    from liepoisson.leaf.leaf import Leaf

EULER = {"point": 1, "circle": 0, "sphere": 2, "all rotations": 0}
"""The Euler characteristic of each kind of family, and the number of its dimensions below."""
_DIMENSION = {"point": 0, "circle": 1, "sphere": 2, "all rotations": 3}


@dataclass(frozen=True, repr=False)
class Equilibria(Found["Equilibrium"], Tabular):
    r"""The equilibria of a leaf by increasing energy, and whether they are all.

    Behaves like a list of `Equilibrium`: one for each isolated equilibrium and for each connected family.

    Example:
        >>> found = lp.equilibria(lp.catalog.system("henon-heiles"), {})
        >>> [round(one.energy, 6) for one in found], found.proved  # the well, and saddles at 1/6
        ([0.0, 0.166667, 0.166667, 0.166667], True)

    Attributes:
        leaf: The leaf.
        found: The equilibria.
        proved: Whether it is proved that there are no others. That is so for tops whose parameters are rational
            numbers, except where the algebra meets an isolated degenerate equilibrium, and for other polynomial
            systems with rational numbers on regular leaves, where the equilibria are finitely many.
        euler_characteristic: That of the leaf, if it is known and H is proper on the leaf; else None.
        euler_found: The sum over the list that must be equal to it if nothing is missing: $(-1)^{\rm index}$ for
            each point, times the Euler characteristic of the family for a family (circle 0, sphere 2). None
            where a degenerate equilibrium has no known share.
        n_starts: How many starts the search took, at most where the time limit ended it; 0 if algebra gave the list.
        is_cut_short: Whether the time limit ended the search.
        n_complex: The number of complex solutions of the equations, with multiplicities, where these were all computed.
    """

    titles = ("energy", "family", "linear", "growth", "signature", "energy-Casimir")
    most_rows = None

    leaf: Leaf
    found: tuple[Equilibrium, ...]
    proved: bool
    euler_characteristic: int | None
    euler_found: int | None
    n_starts: int
    n_complex: int | None = None
    is_cut_short: bool = False

    @property
    def n_undecided(self) -> int:
        """How many of those in the list are "undecided": whether there is an equilibrium, several, a family or none."""
        return sum(e.family == "undecided" for e in self.found)

    @property
    def completeness(self) -> str:
        """What is proved about the list, and what is not, in one sentence."""
        if self.proved:
            families = any(e.family not in {"point", "degenerate"} for e in self.found)
            how = "by algebra" if self.n_complex is None else f"by algebra, from {self.n_complex} complex solutions"
            return f"these are all{', with the families that they form' if families else ''} (proved {how})"
        most = "up to " if self.is_cut_short else ""
        searched = f"found from {most}{self.n_starts} random starts; that there are no others is not proved"
        if self.n_undecided:
            searched += (
                f"; {self.n_undecided} of them undecided, as the linear equations may become singular within the bound "
                "on the distance to a zero"
            )
        if self.is_cut_short:
            return searched + CUT_SHORT
        if self.euler_characteristic is None:
            return f"{searched}, and no check is known"
        if self.euler_found is None:
            return f"{searched}, and degenerate equilibria prevent the check by the Euler characteristic"
        if self.euler_found == self.euler_characteristic:
            return (
                f"{searched}; the signs sum to {self.euler_found}, the Euler characteristic of the leaf, as they must "
                "if none is missing"
            )
        return (
            f"{searched}; some are missing or false, for the signs sum to {self.euler_found} and the Euler "
            f"characteristic of the leaf is {self.euler_characteristic}: take more starts"
        )

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table: of each equilibrium its energy, state, family and stability."""
        return equilibrium_columns(self.found, self.leaf.system.component_names)

    @property
    def hints(self) -> tuple[str, ...]:
        """Where a known integral decides what the energy alone does not: one sentence for each such equilibrium.

        Such are upright tops that spin fast: their second variation is definite when l3 is added to H.
        """
        from liepoisson.equilibrium.stability import integrals_that_decide

        found = ((k, integrals_that_decide(one)) for k, one in enumerate(self.found))
        return tuple(
            f"equilibrium {k} is stable, with an integral added to H: equilibrium(system, state, along={names!r})"
            for k, names in found
            if names
        )

    def _head(self) -> str:
        n = len(self.found) - self.n_undecided
        noun = "equilibrium" if n == 1 else "equilibria"
        noun += f" and {self.n_undecided} undecided" if self.n_undecided else ""
        return f"{n} {noun} of {self.leaf.system.name!r} on a leaf of dimension {self.leaf.rank}: {self.completeness}."

    def _row(self, one: Equilibrium, /) -> tuple[str, ...]:
        linear = one.linear_stability, f"{one.growth_rate:.4g}", str(one.signature)
        return f"{one.energy:.6g}", one.family, *linear, one.nonlinear_stability


def equilibrium_columns(found: Sequence[Equilibrium], names: Sequence[str]) -> dict[str, NDArray[Any]]:
    """The columns of a table of equilibria: energy, state, family and stability of each."""
    states = np.array([one.state for one in found], dtype=float).reshape(len(found), len(names))
    listed = ("family", "linear_stability", "growth_rate", "nullity", "nonlinear_stability", "residual")
    return {
        "energy": np.array([one.energy for one in found], dtype=float),
        **dict(zip(names, states.T, strict=True)),
        **{name: np.array([getattr(one, name) for one in found]) for name in listed},
        **{
            f"signature_{sign}": np.array([one.signature[k] for one in found], dtype=np.int64)
            for k, sign in enumerate(("positive", "negative", "zero"))
        },
    }


def signed_sum(found: Sequence[Equilibrium]) -> int | None:
    r"""The sum of $(-1)^{\rm index}\chi$ over the equilibria and their families, None if a share is not known."""
    total = 0
    for e in found:
        if _DIMENSION.get(e.family, -1) != e.signature[2]:
            return None
        total += (-1) ** e.signature[1] * EULER[e.family]
    return total
