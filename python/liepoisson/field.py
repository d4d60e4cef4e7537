"""Plain descriptions of vector fields: what the exact wing hands to the numeric wing.  Data, no code."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

Vector3: TypeAlias = tuple[float, float, float]


@dataclass(frozen=True)
class TopField:
    r"""The charged or twisted top with diagonal inertia.

    With $x = (\ell, \alpha, \beta)$ and $\omega_i = \ell_i / I_i$,

    $$\dot\ell = \ell\times\omega + \alpha\times a + \beta\times b,\quad
      \dot\alpha = \alpha\times\omega + \epsilon\,\beta\times a,\quad
      \dot\beta = \beta\times\omega .$$

    Source: Thiffeault and Morrison (2001), equations of the section "The twisted top".
    """

    inertia: Vector3
    a: Vector3
    b: Vector3
    epsilon: float

    @property
    def n_components(self) -> int:
        """Dimension of the state, 9."""
        return 9
