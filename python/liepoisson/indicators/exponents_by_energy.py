"""Exponents energy by energy on one leaf: the mixture behind a mean over random starts, taken apart."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson.errors import ParameterError, TimeLimitError
from liepoisson.formula.scalars import TIME_LIMIT, as_count
from liepoisson.indicators.estimates import Estimate, as_confidence
from liepoisson.indicators.mean_error import mean_interval
from liepoisson.indicators.tangent_frames import as_duration
from liepoisson.indicators.verdict import Kind, Rule, as_rule, decide, rule_of, rule_record
from liepoisson.inputs.arrays import Array, check_shape
from liepoisson.inputs.calls import shows_progress
from liepoisson.inputs.deadline import Deadline
from liepoisson.inputs.refusals import counted, shown
from liepoisson.io.result import labelled, recorded
from liepoisson.numeric.methods import MethodChoice
from liepoisson.numeric.run import Run, typical
from liepoisson.numeric.run_options import RunOptions
from liepoisson.numeric.starts import as_values
from liepoisson.numeric.systems import HasField, as_field, has_functions
from liepoisson.streams import generator

_MOST = 10_000_000


class SampledLeaf(Protocol):
    """What is needed of a `Leaf`: its Casimirs, and random states of an energy with the microcanonical measure."""

    @property
    def casimirs(self) -> dict[str, float]: ...  # noqa: D102
    def sample(self, n_starts: int, *, seed: int, energy: float | None = None) -> Array: ...  # noqa: D102


@dataclass(frozen=True)
class DrawnLeaf:
    """A leaf as a file knows it: the starts that were drawn on it, by energy."""

    casimirs: dict[str, float]
    starts: dict[float, Array]

    def sample(self, n_starts: int, *, seed: int, energy: float | None = None) -> Array:
        """The starts of the file, whatever the seed."""
        return self.starts[float("nan") if energy is None else energy][:n_starts]


def read_estimates(record: list[list[float]]) -> tuple[Estimate, ...]:
    """The numbers with errors that a file has as data."""
    return tuple(Estimate(*item) for item in record)


@dataclass(frozen=True, kw_only=True, eq=False)
class EnergyProfile(Run):
    """Finite-time exponents at several energies of one leaf.

    Example:
        >>> top = lp.Top.twisted_lagrange()
        >>> leaf = lp.Leaf.through(top, [1, 0, 1, 0, 0, 1, 0, 0, 1])
        >>> profile = lp.chaos.exponents_by_energy(top, leaf=leaf, energies=[1, 2], n_starts=4, t_end=300)
        >>> [share.value for share in profile.chaotic], profile.exponent.shape
        ([0.0, 0.0], (2, 4))

    Attributes:
        start: The starts, shape (energy, trajectory, component).
        seed: Seed of the starts and of the tangent vectors.
        confidence: That of the intervals.
        member: Numbers of the starts at each energy, shape (trajectory,).
        casimirs: Values of the Casimirs of the leaf.
        energy: Shape (energy,).
        t_end: Time of each exponent.
        exponent: Exponents at `t_end`, in inverse time, shape (energy, trajectory); NaN for runs that failed.
        outcome: How each run ended, shape (energy, trajectory).
        verdict: "regular", "chaotic" or "undecided" by `rule`, as `decide` says, shape (energy, trajectory).
        rule: Its thresholds.
        mean: Mean exponent at each energy with its standard error, the spread over the starts over the root of their
            number, and Student's interval; of NaN with fewer than two runs.
        chaotic: Share of the chaotic ones among the starts at each energy whose runs finished, with the binomial
            standard error and Wilson's interval; of NaN without runs.
        undecided: Share of the undecided ones, likewise.  What is undecided may be either: the chaotic share of the
            energy surface lies between `chaotic` and `chaotic` + `undecided`, but for the errors of both.
    """

    kind = "energy profile"
    made_by = "exponents_by_energy"
    rows = ("energy", "member")

    start: Array = labelled("energy", "member", "component", long_name="state at time 0")
    outcome: NDArray[np.str_] = labelled("energy", "member", long_name="how the run ended")
    seed: int
    confidence: float
    casimirs: dict[str, float]
    energy: Array = labelled("energy", long_name="energy", is_coordinate=True)
    member: NDArray[np.int64] = labelled("member", long_name="number of the member", units="1", is_coordinate=True)
    t_end: float
    exponent: Array = labelled(
        "energy", "member", long_name="finite-time largest Lyapunov exponent", units="inverse time, dimensionless"
    )
    verdict: NDArray[np.str_] = labelled("energy", "member", long_name="regular, chaotic or undecided")
    rule: Rule = recorded(rule_record, rule_of)
    mean: tuple[Estimate, ...] = recorded(list, read_estimates)
    chaotic: tuple[Estimate, ...] = recorded(list, read_estimates)
    undecided: tuple[Estimate, ...] = recorded(list, read_estimates)

    def arguments(self) -> dict[str, Any]:
        """What `exponents_by_energy` was called with: the leaf as the starts that were drawn on it."""
        n = len(self.member)
        if not np.array_equal(self.member, np.arange(n)):  # what is drawn for a trajectory follows from its number
            raise ParameterError(
                f"member: wanted trajectories from 0 on, one after the other; got {shown(self.member)}"
            )
        names = ("t_end", "seed", "rule", "confidence", "method")
        own = {name: getattr(self, name) for name in names}
        leaf = DrawnLeaf(self.casimirs, dict(zip(self.energy.tolist(), self.start, strict=True)))
        return own | {"leaf": leaf, "energies": self.energy, "n_starts": self.start.shape[1]}

    @property
    def _starts(self) -> str:
        """How many starts there are at each energy, and how many runs failed at all of them together."""
        failed = int(np.sum(self.outcome != "finished"))
        return counted(self.exponent.shape[1], "start") + (
            f" ({failed} of {self.outcome.size} failed)" if failed else ""
        )

    def __str__(self) -> str:
        leaf = ", ".join(f"{name} = {value:.4g}" for name, value in self.casimirs.items())
        lines = [
            f"{self.system.name}, {leaf}; {self._starts} per energy, t = {self.t_end:g}, errors over the starts",
            "  energy  mean exponent      chaotic            undecided",
        ]
        for energy, mean, *shares in zip(self.energy, self.mean, self.chaotic, self.undecided, strict=True):
            texts = (f"{share.value:.2f} [{share.low:.2f}, {share.high:.2f}]" for share in shares)
            lines.append(f"{energy:8.4g}  {mean!s:17}  " + "  ".join(texts))
        return "\n".join(lines)

    def __repr__(self) -> str:
        energies = (
            f"{counted(len(self.energy), 'energy', 'energies')} from {self.energy.min():.4g} to {self.energy.max():.4g}"
        )
        value = typical("exponent", self.exponent.ravel())
        return f"<EnergyProfile of {self.system.name}: {energies}, {self._starts} each, {value} at t = {self.t_end:g}>"


@shows_progress
def exponents_by_energy(
    system: HasField,
    *,
    leaf: SampledLeaf,
    energies: ArrayLike,
    n_starts: int,
    t_end: float,
    rule: Rule | None = None,
    seed: int = 0,
    confidence: float = 0.95,
    method: MethodChoice | None = None,
    threads: int | None = None,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> EnergyProfile:
    r"""Mean exponent, and the chaotic and the undecided share, at each energy of a leaf.

    Starts have the microcanonical measure, which the flow preserves: the fraction of chaotic starts estimates the
    chaotic share of the energy surface.  Each orbit is judged by `decide`, whose docstring says what it cannot see;
    what it leaves undecided is counted by itself.  The same seed is used at each energy.

    Example:
        >>> top = lp.Top.twisted_lagrange()  # integrable
        >>> leaf = lp.Leaf.through(top, [1, 0, 1, 0, 0, 1, 0, 0, 1])
        >>> profile = lp.chaos.exponents_by_energy(top, leaf=leaf, energies=[1], n_starts=16, t_end=300)
        >>> profile.chaotic[0].value, round(profile.chaotic[0].high, 2)  # none of 16, and Wilson's bound
        (0.0, 0.19)

    Args:
        leaf: The leaf, a `Leaf` of the system: of the same one, or of one with the same bracket and field.
        energies: Values of the Hamiltonian, shape (energy,); `leaf.energy_range()` tells which occur.
        n_starts: StartsLike at each energy, at most 10,000,000.
        t_end: Time of the exponents, positive.
        rule: Other thresholds than those of `decide`.
        seed: Draws starts and tangent vectors.
        confidence: Coverage of the intervals.
        time_limit: Seconds that it may take.  Each energy has an equal share of what is left, so that each has some,
            the sampling included.  Energies whose states come too late have the outcome "time limit".

    Raises:
        LeafError: an energy does not occur on the leaf, or its energy surface has infinite volume.
        ShapeError: `energies` is not one-dimensional.
        ParameterError: numbers out of range, or no leaf, or one of another system.

    References: Wilson, J. Amer. Statist. Assoc. 22 (1927) 209.
    """
    _check_leaf(system, leaf)
    options = RunOptions.read(method, threads, time_limit, progress, seed=seed, system=system)
    values, field = np.atleast_1d(as_values(energies, "energies")), options.field(system)
    fits = values.ndim == 1 and values.size > 0
    check_shape(fits, "energies", "(energy,) with one or more energies", values)
    n_starts = as_count(n_starts, "n_starts", least=1, most=_MOST, hint="try n_starts=100")
    t_end = as_duration(t_end, "t_end")
    rule, confidence = as_rule(rule), as_confidence(confidence)
    shape = (len(values), n_starts)
    exponent, outcome = np.full(shape, np.nan), np.full(shape, "time limit", dtype="<U32")
    verdict, drawn = np.full(shape, "undecided", dtype="<U16"), np.full((*shape, field.n_components), np.nan)
    nothing = Estimate(*[float("nan")] * 4)
    share: dict[Kind, list[Estimate]] = {kind: [nothing] * len(values) for kind in ("chaotic", "undecided")}
    for k, energy in enumerate(values):
        if options.is_late:
            break
        own = replace(
            options.part(k / len(values), 1 / len(values)), deadline=Deadline(options.left / (len(values) - k))
        )
        try:
            with own.deadline.running():
                drawn[k] = leaf.sample(n_starts, seed=options.seed, energy=float(energy))
        except TimeLimitError:
            continue
        decided = decide(system, drawn[k], t_end=t_end, rule=rule, seed=options.seed, **own.inner())
        outcome[k], verdict[k] = decided.outcome, decided.verdict
        exponent[k] = np.where(decided.outcome == "finished", decided.exponent, np.nan)
        if (decided.outcome == "finished").any():
            for kind, estimates in share.items():
                estimates[k] = decided.fraction(kind, confidence=confidence)
    finished = [row[np.isfinite(row)] for row in exponent]

    return EnergyProfile(
        **options.given(system, drawn, field),
        seed=options.seed,
        confidence=confidence,
        member=np.arange(n_starts),
        casimirs=leaf.casimirs,
        energy=values,
        t_end=t_end,
        exponent=exponent,
        outcome=outcome,
        verdict=verdict,
        rule=rule,
        mean=tuple(mean_interval(row, confidence=confidence) if len(row) > 1 else nothing for row in finished),
        chaotic=tuple(share["chaotic"]),
        undecided=tuple(share["undecided"]),
    )


def _check_leaf(system: Any, leaf: Any) -> None:
    """Refuses what is no leaf, and leaves of another system: their states have other Casimirs, or another measure."""
    if not hasattr(leaf, "casimirs") or not callable(getattr(leaf, "sample", None)):
        raise ParameterError(f"leaf: wanted a Leaf; got {shown(leaf)}; try Leaf.through(system, state)")
    other = getattr(leaf, "system", system)
    if other is not system and not _are_the_same(system, other):
        raise ParameterError(
            f"leaf: wanted a leaf of the system {shown(system.name)}; got one of {shown(other.name)}, with another "
            "bracket or field; try Leaf.through(system, state)"
        )


def _are_the_same(system: Any, other: Any) -> bool:
    """Whether field and Poisson tensor agree at a few states of no special position."""
    n = as_field(system).n_components
    if as_field(other).n_components != n:
        return False
    if not has_functions(system):  # no bracket to compare
        return as_field(system) == as_field(other)
    states = generator(0).standard_normal((4, n))
    with np.errstate(all="ignore"):  # outside of the domain of a Hamiltonian both are NaN
        pairs = [(s.functions.poisson_tensor(states), s.vector_field(states)) for s in (system, other)]
    # 1e-9: the same formulas in another order differ by round-off
    return all(np.allclose(*both, rtol=1e-9, atol=1e-9, equal_nan=True) for both in zip(*pairs, strict=True))
