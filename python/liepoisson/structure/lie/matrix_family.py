"""What a Lie algebra remembers of the matrices that it was made of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from liepoisson.formula.tensors import Brackets


@dataclass(frozen=True)
class MatrixFamily:
    """Which family of matrices an algebra was made as, and its basis.

    Attributes:
        kind: "so", "su", "sl", "gl" or "sine".
        size: Number of rows of the matrices.
        basis: The matrices by their nonzero entries, small Gaussian integers; empty for the adjoint representation (so
            in three dimensions) and for the sine algebra, which has matrices of its own.
    """

    kind: str
    size: int
    basis: tuple[Mapping[tuple[int, int], complex], ...] = ()


class MatrixAlgebra(Protocol):
    """A Lie algebra as its matrices see it; `LieAlgebra` is one."""

    @property
    def name(self) -> str:
        """Its name."""
        ...

    @property
    def dimension(self) -> int:
        """The number of basis elements."""
        ...

    @property
    def brackets(self) -> Brackets:
        """The structure constants."""
        ...

    @property
    def family(self) -> MatrixFamily | None:
        """Which matrices it was made of."""
        ...
