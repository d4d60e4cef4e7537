"""What a run was given, how it ended, and how well it kept the invariants: what numeric results share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liepoisson import _core
from liepoisson.compile.field import Field, field_of, record_of
from liepoisson.errors import ParameterError
from liepoisson.inputs.arrays import Array, read_only
from liepoisson.inputs.refusals import counted, shown
from liepoisson.io.result import Result, labelled, names_along, recorded
from liepoisson.numeric.method.method import Method
from liepoisson.numeric.methods import method_of, method_record
from liepoisson.numeric.systems import HasField, has_invariants


@dataclass(frozen=True, kw_only=True, eq=False)
class Run(Result):
    """Trajectories of one system: what they were given and how they ended."""

    system: HasField
    components: tuple[str, ...] = names_along("component")
    field: Field = recorded(record_of, field_of)
    method: Method = recorded(method_record, method_of)
    start: Array = labelled("trajectory", "component", long_name="state as it was given")
    outcome: NDArray[np.str_] = labelled("trajectory", long_name="how the trajectory ended")
    time_limit: float = np.inf

    def arguments(self) -> dict[str, Any]:
        """The starts and the method."""
        return {"starts": self.start, "method": self.method}


@dataclass(frozen=True, kw_only=True, eq=False)
class IntegratedRun(Run):
    """Trajectories that were integrated by one call of the core."""

    end_time: Array = labelled("trajectory", long_name="time reached")
    n_steps: NDArray[np.int64] = labelled("trajectory", long_name="accepted steps", units="1")
    end_state: Array = labelled("trajectory", "component", long_name="last good state")
    order: int
    kernel: str


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

    @property
    def monotone(self) -> dict[str, Array]:
        """Values of what only falls or rises along the orbits of a `DampedSystem`, by name, shape (..., time) each.

        With a double bracket H, of a metriplectic flow the entropy S; of other systems nothing.
        """
        return {name: read_only(values) for name, (values, _) in self._one_way().items()}

    @property
    def reversals(self) -> dict[str, Array]:
        """The largest change of each of these, from one time to the next, against its law; 0 if none, shape (...).

        What is above round-off is an error of the method.
        """
        found: dict[str, Array] = {}
        for name, (values, sign) in self._one_way().items():
            with np.errstate(all="ignore"):
                steps = -sign * np.diff(values, axis=-1)
            largest = np.where(np.isfinite(steps), steps, 0.0).max(axis=-1, initial=0.0)
            found[name] = read_only(np.where(np.isfinite(steps).any(axis=-1), largest, np.nan))
        return found

    def _one_way(self) -> dict[str, tuple[Array, int]]:
        """The values of what only falls or rises, and its sign along the time of the result."""
        told = getattr(self.system, "one_way_values", None)
        if not callable(told):
            return {}
        time: Any = getattr(self, "time", ())
        forwards = 1 if len(time) < 2 or time[-1] > time[0] else -1
        with np.errstate(all="ignore"):
            values: Any = told(self.state)
        return {name: (found, forwards * sign) for name, (found, sign) in values.items()}


def _largest_change(values: Array, reached: NDArray[np.bool_]) -> Array:
    """Along the last axis, where a time was reached; an invariant that has no value there is NaN."""
    with np.errstate(all="ignore"):  # infinity less infinity
        change = np.abs(values - values[..., :1])
    largest = np.where(reached, change, 0.0).max(axis=-1)
    return np.where(reached.sum(axis=-1) > 1, largest, np.nan)


def whole(time: Array, t_end: float) -> float:
    """The last time, of evenly spaced times up to it.

    Raises:
        ParameterError: they are others: some were cut off or turned round, and the run cannot be made from them.
    """
    n = len(time)
    if not n or not np.allclose(time, t_end * np.arange(1, n + 1) / n, rtol=1e-12, atol=0.0):
        raise ParameterError(f"time: wanted all times of the run, up to {t_end:g}; got {shown(time)}; load the file")
    return t_end


def outcome_names(codes: NDArray[np.int8]) -> NDArray[np.str_]:
    """Outcomes by name."""
    return np.array(_core.outcomes())[codes]


def trajectories(outcome: NDArray[np.str_]) -> str:
    """How many there are, and how many of them failed, as a `repr` says it."""
    failed = int(np.sum(outcome != "finished"))
    return counted(outcome.size, "trajectory", "trajectories") + (f" ({failed} failed)" if failed else "")


def typical(quantity: str, values: Array) -> str:
    """The median of the finite ones among the values, as a `repr` says it: the value itself if there is one."""
    finite = values[np.isfinite(values)]
    if not finite.size:
        return f"no {quantity}"
    return f"{'median ' if finite.size > 1 else ''}{quantity} {np.median(finite):.4g}"
