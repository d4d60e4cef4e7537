r"""Regular, chaotic or undecided: a rule made of three indicators, and how well these agree."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson.arrays import Array, as_array
from liepoisson.errors import ParameterError
from liepoisson.field import PiecesField
from liepoisson.numeric._checks import (
    TIME_LIMIT,
    HasField,
    as_field,
    as_number,
    as_states,
    as_time_limit,
    shown,
    trajectories,
)
from liepoisson.numeric.alignment import Alignment, alignment, as_positive_time
from liepoisson.numeric.estimates import Estimate
from liepoisson.numeric.integrate import integrate
from liepoisson.numeric.megno import Megno, megno
from liepoisson.numeric.methods import Method, Taylor
from liepoisson.numeric.proportions import proportion

Kind: TypeAlias = Literal["regular", "chaotic", "undecided"]

KINDS: tuple[Kind, ...] = ("regular", "chaotic", "undecided")
INDICATORS = ("growth_power", "megno", "sali")

# The parts of the run from which the derivative of the field is taken, the first one that changes a tangent vector by
# as much as this; and the members whose matrices are in memory at once.
_SHORT, _LEAST_CHANGE, _CHUNK = (1e-21, 1e-18, 1e-15, 1e-12, 1e-9), 1e-10, 256


@dataclass(frozen=True)
class Rule:
    r"""Thresholds of the three indicators: (regular, chaotic); a value between the two is no vote.

    The growth power is regular below its first number and chaotic above the second, MEGNO likewise; SALI is regular
    above its first number and chaotic below the second.  Two votes for one kind and none for the other are a verdict,
    unless the run is shorter than `least_time`, in natural units (`Verdict.natural_time`).

    Growth power and MEGNO were fixed on a training set of eight integrable tops, 256 starts each, at t = 1000: the
    largest power there was 1.6, the largest mean MEGNO 2.64, where a torus has 1 and 2.  On purely exponential growth
    they are $0.424\,\lambda t$ and $\lambda t/2$: "chaotic" needs $\lambda t > 9.4$ and 10.  The numbers for SALI and
    `least_time` are choices of ours.  docs/chaos.md names the systems and says what other systems reached.
    """

    growth_power: tuple[float, float] = (2.0, 4.0)
    megno: tuple[float, float] = (3.0, 5.0)
    sali: tuple[float, float] = (1e-4, 1e-8)
    least_time: float = 100.0

    def __post_init__(self) -> None:
        for name in INDICATORS:
            try:
                low, high = (as_number(value, f"rule.{name}", "two numbers") for value in getattr(self, name))
            except (TypeError, ValueError):
                low = high = math.nan
            ordered = high < low if name == "sali" else low < high
            if not ordered:
                order = "decreasing" if name == "sali" else "increasing"
                raise ParameterError(
                    f"rule.{name}: wanted two {order} numbers (regular, chaotic); got {shown(getattr(self, name))}; "
                    f"try {getattr(type(self), name)}"
                )
        if not as_number(self.least_time, "rule.least_time", "a number") >= 0.0:
            raise ParameterError(
                f"rule.least_time: wanted a number >= 0; got {shown(self.least_time)}; try {type(self).least_time}"
            )

    def votes(self, growth_power: Array, mean_megno: Array, sali: Array) -> NDArray[np.int8]:
        """What each indicator says: -1 regular, +1 chaotic, 0 neither (or no value), shape (trajectory, indicator)."""
        rising = ((growth_power, self.growth_power), (mean_megno, self.megno))
        columns = [np.where(value < low, -1, np.where(value > high, 1, 0)) for value, (low, high) in rising]
        columns.append(np.where(sali > self.sali[0], -1, np.where(sali < self.sali[1], 1, 0)))
        return np.stack(columns, axis=-1).astype(np.int8)


@dataclass(frozen=True)
class Verdict:
    r"""Regular, chaotic or undecided, for each trajectory.

    Attributes:
        system: Name of the system.
        t_end: Time after which it was decided.
        rule: The thresholds.
        seed: Seed of the tangent vectors.
        first: Number of the first member.
        verdict: "regular", "chaotic" or "undecided", shape (trajectory,); a trajectory that failed is "undecided".
        natural_time: $t\,\|Df(x_0)\|_2$ at `t_end`, a pure number: the time in units of the fastest rate at which
            neighbours of the start move apart or turn, shape (trajectory,).
        growth_power: Slope of $\ln|v|$ against $\ln t$ over [t_end/10, t_end], shape (trajectory,).
        mean_megno: $\bar Y$ at `t_end`, shape (trajectory,).
        sali: SALI at `t_end`, shape (trajectory,).
        exponent: Finite-time exponent at `t_end`, in inverse time, shape (trajectory,).
        votes: -1 regular, +1 chaotic, 0 neither, for growth power, MEGNO and SALI, shape (trajectory, indicator).
        outcome: How each trajectory ended, shape (trajectory,).
    """

    system: str
    t_end: float
    rule: Rule
    seed: int
    first: int
    verdict: NDArray[np.str_]
    natural_time: Array
    growth_power: Array
    mean_megno: Array
    sali: Array
    exponent: Array
    votes: NDArray[np.int8]
    outcome: NDArray[np.str_]

    def fraction(self, kind: Kind, *, confidence: float = 0.95) -> Estimate:
        """The fraction of one kind among the trajectories that finished, with Wilson's interval.

        The interval is that of independent starts.  Whether the verdicts are right is another question.

        Raises:
            ParameterError: an unknown kind, or no trajectory finished.
        """
        if kind not in KINDS:
            raise ParameterError(f"kind: wanted one of {', '.join(KINDS)}; got {shown(kind)}")
        done = self.outcome == "finished"
        return proportion(int(np.sum(self.verdict[done] == kind)), int(done.sum()), confidence=confidence)

    def __str__(self) -> str:
        counts = ", ".join(f"{np.sum(self.verdict == kind)} {kind}" for kind in KINDS)
        return f"{counts}  ({self.system}, t = {self.t_end:g})"

    def __repr__(self) -> str:
        counts = ", ".join(f"{np.sum(self.verdict == kind)} {kind}" for kind in KINDS)
        return f"<Verdict of {self.system}: {trajectories(self.outcome)}, {counts} at t = {self.t_end:g}>"


def decide(
    system: HasField,
    x0: ArrayLike,
    *,
    t_end: float,
    seed: int = 0,
    first: int = 0,
    rule: Rule | None = None,
    method: Method | None = None,
    threads: int | None = None,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> Verdict:
    r"""Decides whether each orbit is regular or chaotic, or says that it cannot tell by `t_end`.

    Three indicators vote:

    - the growth power p, the slope of $\ln|v| = t\,\lambda(t)$ against $\ln t$ over the last decade of time: 1 on a
      torus, $0.424\,\lambda t$ on a chaotic orbit;
    - the mean MEGNO $\bar Y$: 2 on a torus, $\lambda t/2$ on a chaotic orbit;
    - SALI: of order one or falling like a power of t on a torus, exponentially on a chaotic orbit.

    A verdict needs two votes for it and none against it, and a run of at least 100 natural times,
    $t\,\|Df(x_0)\|_2\ge 100$: before that a chaotic orbit cannot be told from a regular one, and all is "undecided".
    Growth power and MEGNO come from the same tangent vector and mostly agree; SALI comes from two others.

    What the rule cannot see: an orbit that has hardly begun to be chaotic by `t_end`.  Sticky orbits are such, and
    exponents below about $10/t$ are "undecided" or "regular", below about $5/t$ "regular".  An unstable periodic orbit
    or equilibrium of an integrable system is "chaotic" though no neighbour of it is; so is any orbit on which the
    tangent vectors grow exponentially.  docs/chaos.md has error rates for t >= 300; between 100 natural times and
    there they were not measured.

    Args:
        system: The system.
        x0: States at time 0, shape (component,) or (trajectory, component), dimensionless; a row that is not finite
            beside good ones ends at once, with the outcome "not finite".
        t_end: Time after which it is decided, in units of the system's own time; some hundred periods at least.  All
            orbits for which it is too short are "undecided".
        seed: Draws the tangent vectors.
        first: Number of the first member: member k has the same verdict in whichever piece of an ensemble it is.
        rule: Other thresholds than those whose error rates were measured.
        method: How; by default `Taylor(tol=1e-13)`.
        threads: By default all processors that the process may use.  Results do not depend on it, bit for bit.
        time_limit: Seconds that the run may take.
        progress: Called a few times a second with the fraction that is done.

    Returns:
        Verdict.

    Raises:
        ShapeError: `x0` has another shape than stated.
        ParameterError: Numbers that are not finite, a time that is not positive, or a rule that is no `Rule`.
        KeyboardInterrupt: Ctrl-C.

    References:
        Benettin, Galgani and Strelcyn, Phys. Rev. A 14 (1976) 2338; Skokos, J. Phys. A 34 (2001) 10029; Cincotta
        and Simó, Astron. Astrophys. Suppl. 147 (2000) 205.
    """
    end, limit = as_positive_time(t_end, "t_end"), as_time_limit(time_limit)
    rule = _as_rule(rule)
    x0 = as_array(x0, "x0")  # once, as three runs start from it
    half = None if progress is None else lambda fraction: progress(0.5 * fraction)
    rest = None if progress is None else lambda fraction: progress(0.5 + 0.5 * fraction)
    deadline = clock.monotonic() + limit
    natural_time = _natural_time(system, x0, end, method, threads, deadline=deadline)
    growth = megno(
        system,
        x0,
        t_end=end,
        seed=seed,
        first=first,
        method=method,
        threads=threads,
        time_limit=_left(deadline),
        progress=half,
    )
    # Eight pieces: a vector may grow by e^600 in each before a piece must be repeated in halves.
    angle = alignment(
        system,
        x0,
        times=end * np.arange(1, 9) / 8,
        seed=seed,
        first=first,
        method=method,
        threads=threads,
        time_limit=_left(deadline),
        progress=rest,
    )
    return _judge(growth, angle, natural_time, rule)


def _left(deadline: float) -> float:
    """Seconds until then; a little where none are left, as a run must have some."""
    return max(deadline - clock.monotonic(), 1e-9)


def _as_rule(rule: Any) -> Rule:
    if rule is None:
        return Rule()
    if not isinstance(rule, Rule):
        raise ParameterError(f"rule: wanted a Rule; got {shown(rule)}; try Rule(megno=(3, 5)), or leave it out")
    return rule


def _natural_time(
    system: HasField, x0: ArrayLike, t_end: float, method: Method | None, threads: int | None, *, deadline: float
) -> Array:
    r"""The time in natural units, $t\,\|Df(x_0)\|_2$, shape (trajectory,); NaN without a start or time left.

    Df is read off the variational equations, $M(h) = 1 + h\,Df + O(h^2)$ at the first of $h = 10^{-21}t, 10^{-18}t,
    \ldots, 10^{-9}t$ at which $\|M(h) - 1\|_2\ge 10^{-10}$.  From 100 to 1e14 natural times that leaves relative errors
    of at most some 1e-7 from the order and 1e-5 from round-off.
    """
    field = as_field(system)
    # whatever the caller's method, but a field that is given by its pieces knows no other
    method = method if isinstance(field, PiecesField) else Taylor(tol=1e-13)
    states = as_states(x0, field.n_components, some_may_fail=True)
    n, result = states.shape[1], np.full(len(states), np.nan)
    good = np.flatnonzero(np.isfinite(states).all(axis=1))
    for start in range(0, len(good), _CHUNK):
        chunk = good[start : start + _CHUNK]
        for share in _SHORT:
            identity = np.tile(np.eye(n), (len(chunk), 1, 1))
            short = integrate(
                system,
                states[chunk],
                t=[0.0, share * t_end],
                tangents=identity,
                method=method,
                threads=threads,
                time_limit=_left(deadline),
            )
            chunk = chunk[arrived := short.outcome == "finished"]
            change = np.linalg.norm(short.tangent[arrived, 1] - np.eye(n), ord=2, axis=(1, 2))
            result[chunk] = change / share
            chunk = chunk[change < _LEAST_CHANGE]
            if not len(chunk):
                break
    return result


def _judge(growth: Megno, angle: Alignment, natural_time: Array, rule: Rule) -> Verdict:
    power, mean, sali = _growth_power(growth), growth.mean[:, -1], angle.sali[:, -1]
    votes = rule.votes(power, mean, sali)
    outcome = np.where(growth.outcome == "finished", angle.outcome, growth.outcome)
    for_chaos, for_order = (votes > 0).sum(axis=1), (votes < 0).sum(axis=1)
    decidable = (outcome == "finished") & (natural_time >= rule.least_time)
    chaotic = decidable & (for_chaos >= 2) & (for_order == 0)
    regular = decidable & (for_order >= 2) & (for_chaos == 0)
    return Verdict(
        system=growth.system,
        t_end=float(growth.time[-1]),
        rule=rule,
        seed=growth.seed,
        first=growth.first,
        verdict=np.where(chaotic, "chaotic", np.where(regular, "regular", "undecided")),
        natural_time=natural_time,
        growth_power=power,
        mean_megno=mean,
        sali=sali,
        exponent=growth.log_growth[:, -1] / growth.time[-1],
        votes=votes,
        outcome=outcome,
    )


def _growth_power(growth: Megno) -> Array:
    """Least-squares slope of ln|v| against ln t over the last decade of time."""
    last = growth.time >= 0.1 * growth.time[-1]
    log_time = np.log(growth.time[last])
    log_time -= log_time.mean()
    # not a product of matrices, whose order of summation depends on the number of rows
    rows = np.ascontiguousarray(growth.log_growth[:, last])
    return (rows * log_time).sum(axis=1) / (log_time**2).sum()


class Disagreement(NamedTuple):
    """A member on which the indicators do not all say the same."""

    member: int
    verdict: str
    votes: dict[str, str]
    values: dict[str, float]

    def __str__(self) -> str:
        parts = (f"{name} {self.values[name]:.3g} {self.votes[name]}" for name in INDICATORS)
        return f"member {self.member}: {', '.join(parts)} -> {self.verdict}"


@dataclass(frozen=True)
class Agreement:
    """How far the indicators of an ensemble agree.

    Attributes:
        indicators: Their names.
        same: Members on which two indicators say the same, shape (indicator, indicator).
        contrary: Members that one of them calls regular and the other chaotic, shape (indicator, indicator).
        n: Members that finished.
        disagreements: Every member on which the three do not all say the same, in order.
    """

    indicators: tuple[str, ...]
    same: NDArray[np.int64]
    contrary: NDArray[np.int64]
    n: int
    disagreements: tuple[Disagreement, ...] = field(repr=False)

    def __str__(self) -> str:
        width = max(map(len, self.indicators)) + 2
        lines = [f"{'same / contrary':{width + 4}}" + "".join(f"{name:>{width + 2}}" for name in self.indicators)]
        for i, name in enumerate(self.indicators):
            cells = (f"{self.same[i, j]} / {self.contrary[i, j]}" for j in range(len(self.indicators)))
            lines.append(f"{name:{width + 4}}" + "".join(f"{cell:>{width + 2}}" for cell in cells))
        lines.append(f"{len(self.disagreements)} of {self.n} members without a unanimous vote")
        return "\n".join([*lines, *map(str, self.disagreements)])


def agreement(verdict: Verdict) -> Agreement:
    """Agreement matrix of the indicators, and every member on which they disagree, with the values.

    Args:
        verdict: Result of `decide`.

    Raises:
        ParameterError: it is none.
    """
    if not isinstance(verdict, Verdict):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise ParameterError(f"verdict: wanted what decide returns; got {shown(verdict)}; call decide first")
    done = np.flatnonzero(verdict.outcome == "finished")
    votes = verdict.votes[done].astype(np.int64)
    same = (votes[:, :, None] == votes[:, None, :]).sum(axis=0)
    contrary = (votes[:, :, None] * votes[:, None, :] == -1).sum(axis=0)
    split = done[(votes != votes[:, :1]).any(axis=1)]
    return Agreement(INDICATORS, same, contrary, len(done), tuple(_disagreement(verdict, int(k)) for k in split))


def _disagreement(verdict: Verdict, k: int) -> Disagreement:
    names = {-1: "regular", 0: "undecided", 1: "chaotic"}
    values = (verdict.growth_power[k], verdict.mean_megno[k], verdict.sali[k])
    return Disagreement(
        member=verdict.first + k,
        verdict=str(verdict.verdict[k]),
        votes={name: names[int(vote)] for name, vote in zip(INDICATORS, verdict.votes[k], strict=True)},
        values=dict(zip(INDICATORS, map(float, values), strict=True)),
    )
