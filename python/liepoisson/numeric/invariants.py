"""Invariants along orbits, and how well an integration kept them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from liepoisson.errors import ParameterError
from liepoisson.inputs.arrays import Array, read_only
from liepoisson.numeric.systems import has_invariants


class KeepsInvariants:
    """A result with states along time, shape (..., time, component): what its system keeps constant.

    Attributes:
        system: The system.
        state: The states; NaN at times that were not reached.
    """

    system: Any
    state: Array

    @property
    def invariants(self) -> dict[str, Array]:
        """Values of the Hamiltonian, the Casimirs and the known integrals by name, shape (..., time) each.

        The names are those of `system.invariants`.  Values are NaN at times that were not reached.

        Raises:
            ParameterError: The system is only a field, which knows no invariants.
        """
        if not has_invariants(self.system):
            raise ParameterError(
                f"invariants: wanted a system with a bracket and a Hamiltonian; got {self.system.name}, which is only "
                "a field; evaluate your own functions at .state"
            )
        with np.errstate(all="ignore"):  # where no state was reached there are NaNs
            values = self.system.invariant_values(self.state)
        return {name: read_only(value) for name, value in values.items()}

    @property
    def drift(self) -> dict[str, Array]:
        r"""Largest change of each invariant along each trajectory, $\max_t|f(x(t)) - f(x(0))|$, shape (...).

        Only the times of the result are looked at.  A trajectory of which no time beyond the first was reached has NaN.

        Raises:
            ParameterError: The system is only a field, which knows no invariants.
        """
        reached: NDArray[np.bool_] = np.asarray(np.isfinite(self.state).all(axis=-1))
        return {name: read_only(_largest_change(values, reached)) for name, values in self.invariants.items()}


def _largest_change(values: Array, reached: NDArray[np.bool_]) -> Array:
    """Along the last axis, where a time was reached; an invariant that has no value there is NaN."""
    with np.errstate(all="ignore"):  # infinity less infinity
        change = np.abs(values - values[..., :1])
    largest = np.where(reached, change, 0.0).max(axis=-1)
    return np.where(reached.sum(axis=-1) > 1, largest, np.nan)
