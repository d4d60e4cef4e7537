r"""Regular, chaotic or undecided: the one rule, made of four indicators, and how well these agree.

`decide` applies it to orbits; sweeps, exponents by energy and the command line ask `decide`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from typing import Any, Literal, NamedTuple, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from liepoisson import _core
from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import TIME_LIMIT, as_number, as_time
from liepoisson.indicators.alignment import Alignment, alignment
from liepoisson.indicators.averages import average_drift
from liepoisson.indicators.estimates import Estimate
from liepoisson.indicators.mean_error import proportion
from liepoisson.indicators.megno import Megno, megno
from liepoisson.inputs.arrays import Array, ReadOnlyArrays
from liepoisson.inputs.calls import explains_its_arguments, explains_its_methods, shows_progress
from liepoisson.inputs.given import listed
from liepoisson.inputs.refusals import check_choice, check_kind, not_a, shown
from liepoisson.io.result import labelled, recorded
from liepoisson.numeric.methods import MethodChoice
from liepoisson.numeric.run import Run, trajectories
from liepoisson.numeric.run_options import RunOptions
from liepoisson.numeric.sampling import sample_tangents
from liepoisson.numeric.starts import StartsLike, given_starts
from liepoisson.numeric.systems import HasField, at_equal_times
from liepoisson.numeric.time_scale import orbit_units, unit_of_time

Kind: TypeAlias = Literal["regular", "chaotic", "undecided"]

KINDS: tuple[Kind, ...] = ("regular", "chaotic", "undecided")
INDICATORS = ("growth_power", "megno", "sali", "averages")

_USUAL = _core.usual_rule()

TIME = 1000.0
"""Default time of a run, in natural times of the median orbit: the thresholds of `Rule` were fixed there."""


@explains_its_methods
@dataclass(frozen=True)
class Rule:
    r"""Thresholds of the indicators: (regular, chaotic) for three of them; a value between the two is no vote.

    The growth power is regular below its first number and chaotic above the second, MEGNO likewise; SALI is regular
    above its first number and chaotic below the second.  The change of averages is regular below its one number, and
    no vote above: orbits near a resonance settle slowly, too.

    "Chaotic" are two votes for it and none against it among the first three.  "Regular" are two votes for it and none
    against it among the same three, and settled averages.  All is "undecided" in a run that is shorter than
    `least_time`, in natural units (`Verdict.natural_time`).

    Growth power and MEGNO were fixed on a training set of eight integrable tops, 256 starts each, at t = 1000: the
    largest power there was 1.6, the largest mean MEGNO 2.64, where a torus has 1 and 2.  On purely exponential growth
    they are $0.424\,\lambda t$ and $\lambda t/2$: "chaotic" needs $\lambda t > 9.4$ and 10.  The numbers for SALI and
    `least_time` are choices of the authors.  The one for averages was fixed on two Kovalevskaya tops with a weak twist
    (docs/chaos.md): so that at most 5% of the orbits that are chaotic in a run 100 times longer are "regular".

    Example:
        >>> system = lp.catalog.system("henon-heiles")
        >>> starts = [[0, 0.1, 0.3, 0], [0, -0.1, 0.5, 0]]
        >>> lp.decide(system, starts, t_end=1000).verdict.tolist()
        ['regular', 'chaotic']
        >>> patient = lp.chaos.Rule(least_time=5000)
        >>> lp.decide(system, starts, t_end=1000, rule=patient).verdict.tolist()
        ['undecided', 'undecided']
    """

    growth_power: tuple[float, float] = _USUAL[0]
    megno: tuple[float, float] = _USUAL[1]
    sali: tuple[float, float] = _USUAL[2]
    averages: float = _USUAL[3]
    least_time: float = _USUAL[4]

    def __post_init__(self) -> None:
        for name in INDICATORS[:3]:
            try:
                given = listed(getattr(self, name), f"rule.{name}") or ()
                low, high = (as_number(value, f"rule.{name}", "two numbers") for value in given)
            except (TypeError, ValueError):
                low = high = math.nan
            ordered = high < low if name == "sali" else low < high
            if not ordered:
                order = "decreasing" if name == "sali" else "increasing"
                raise ParameterError(
                    f"rule.{name}: wanted two {order} numbers (regular, chaotic); got {shown(getattr(self, name))}; "
                    f"try {getattr(type(self), name)}"
                )
            if not isinstance(getattr(self, name), tuple):
                object.__setattr__(self, name, (low, high))
        for name in ("averages", "least_time"):
            if not as_number(getattr(self, name), f"rule.{name}", "a number") >= 0.0:
                usual = getattr(type(self), name)
                raise not_a("a number >= 0", getattr(self, name), f"rule.{name}", f"try {usual}")

    def votes(self, growth_power: Array, mean_megno: Array, sali: Array, averages: Array) -> NDArray[np.int8]:
        """What each indicator says: -1 regular, +1 chaotic, 0 neither (or no value), shape (trajectory, indicator)."""
        indicators = np.stack([growth_power, mean_megno, sali, averages], axis=-1).astype(np.float64)
        return _core.votes(self._thresholds, indicators.ravel()).reshape(-1, len(INDICATORS))

    def kinds(self, votes: NDArray[np.int8], natural_time: Array) -> NDArray[np.str_]:
        """The verdicts that votes make, shape (trajectory,); those of failed trajectories are for the caller to drop.

        Args:
            votes: As `votes` returns them, shape (trajectory, indicator).
            natural_time: Length of the run in natural units, shape (trajectory,).
        """
        times = np.ascontiguousarray(np.broadcast_to(natural_time, len(votes)), np.float64)
        said = _core.verdicts(self._thresholds, np.ascontiguousarray(votes, np.int8).ravel(), times)
        return np.where(said > 0, "chaotic", np.where(said < 0, "regular", "undecided"))

    @property
    def _thresholds(self) -> Any:
        """As the core has them."""
        return self.growth_power, self.megno, self.sali, self.averages, self.least_time


def rule_record(rule: Rule) -> dict[str, Any]:
    """The rule as plain data."""
    return asdict(rule)


def rule_of(record: dict[str, Any]) -> Rule:
    """The rule that a file has as data."""
    values: dict[str, Any] = {k: tuple(cast("list[float]", v)) if isinstance(v, list) else v for k, v in record.items()}
    return Rule(**values)


@dataclass(frozen=True, kw_only=True, eq=False)
class Verdict(Run):
    r"""Regular, chaotic or undecided, for each trajectory.

    Example:
        >>> system = lp.catalog.system("henon-heiles")
        >>> found = lp.decide(system, [[0, 0.1, 0.3, 0], [0, -0.1, 0.5, 0]], t_end=1000)
        >>> found.verdict.tolist(), found.votes.tolist()
        (['regular', 'chaotic'], [[-1, -1, -1, -1], [1, 1, 1, 0]])

    Attributes:
        t_end: Time after which it was decided.
        rule: The thresholds.
        verdict: "regular", "chaotic" or "undecided", shape (trajectory,); a trajectory that failed is "undecided".
        natural_time: `t_end` over the time scale of the orbit (`time_scale`), a pure number, shape (trajectory,).
        growth_power: Slope of $\ln|v|$ against $\ln t$ over [t_end/10, t_end], shape (trajectory,).
        mean_megno: $\bar Y$ at `t_end`, shape (trajectory,).
        sali: SALI at `t_end`, shape (trajectory,).
        average_drift: Largest change of a weighted average between the parts of the run, in units of the spread of what
            is averaged, shape (trajectory,).
        exponent: Finite-time exponent at `t_end`, in inverse time, shape (trajectory,).
        votes: -1 regular, +1 chaotic, 0 neither, for growth power, MEGNO, SALI and averages, shape (trajectory,
            indicator).
    """

    kind = "verdict"
    made_by = "decide"
    along = {"indicator": INDICATORS}  # noqa: RUF012

    t_end: float
    rule: Rule = recorded(rule_record, rule_of)
    seed: int
    first: int
    verdict: NDArray[np.str_] = labelled("trajectory", long_name="regular, chaotic or undecided")
    natural_time: Array = labelled("trajectory", long_name="end time over the time scale of the orbit", units="1")
    growth_power: Array = labelled("trajectory", long_name="power of time with which a vector grows", units="1")
    mean_megno: Array = labelled("trajectory", long_name="mean of MEGNO over time", units="1")
    sali: Array = labelled("trajectory", long_name="smaller alignment index", units="1")
    average_drift: Array = labelled("trajectory", long_name="change of weighted averages", units="1")
    exponent: Array = labelled(
        "trajectory", long_name="finite-time largest Lyapunov exponent", units="inverse time, dimensionless"
    )
    votes: NDArray[np.int8] = labelled(
        "trajectory", "indicator", long_name="-1 regular, +1 chaotic, 0 neither", units="1"
    )

    def arguments(self) -> dict[str, Any]:
        """What `decide` was called with."""
        own = {name: getattr(self, name) for name in ("t_end", "rule", "seed", "first")}
        return super().arguments() | own

    def fraction(self, kind: Kind, *, confidence: float = 0.95) -> Estimate:
        """The fraction of one kind among the trajectories that finished, with Wilson's interval.

        The interval is that of independent starts.  Whether the verdicts are right is another question.

        Raises:
            ParameterError: an unknown kind, or no trajectory finished.
        """
        check_choice(kind, "kind", KINDS)
        done = self.outcome == "finished"
        return proportion(int(np.sum(self.verdict[done] == kind)), int(done.sum()), confidence=confidence)

    def __str__(self) -> str:
        counts = ", ".join(f"{np.sum(self.verdict == kind)} {kind}" for kind in KINDS)
        failed = self.outcome[self.outcome != "finished"]
        why = f"; {len(failed)} did not finish: {', '.join(sorted(set(failed.tolist())))}" if len(failed) else ""
        restless = int(np.sum(self._waits_for_averages))
        said = (
            f"\n{restless} undecided only because averages still change: an orbit wanders slowly, which a longer run "
            "settles, or a coordinate runs away, such as an angle that was not declared"
        )
        timeless = int(np.sum((self.outcome == "finished") & np.isnan(self.natural_time)))
        unknown = f"\n{timeless} undecided because the orbit has no time scale: its first stretch did not finish"
        return (
            f"{counts}{why}  ({self.system.name}, t = {self.t_end:g}){said if restless else ''}"
            f"{unknown if timeless else ''}"
        )

    @property
    def _waits_for_averages(self) -> NDArray[np.bool_]:
        """Which trajectories would be regular by the votes of the tangent vectors, if their averages had settled."""
        settled = self.votes.copy()
        settled[:, 3] = -1
        regular = self.rule.kinds(settled, self.natural_time) == "regular"
        return regular & (self.verdict == "undecided") & (self.outcome == "finished")

    def __repr__(self) -> str:
        counts = ", ".join(f"{np.sum(self.verdict == kind)} {kind}" for kind in KINDS)
        return f"<Verdict of {self.system.name}: {trajectories(self.outcome)}, {counts} at t = {self.t_end:g}>"


@shows_progress
def decide(
    system: HasField,
    starts: StartsLike,
    *,
    t_end: float | None = None,
    seed: int = 0,
    first: int = 0,
    rule: Rule | None = None,
    method: MethodChoice | None = None,
    threads: int | None = None,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> Verdict:
    r"""Decides whether each orbit is regular or chaotic, or says that it cannot tell by `t_end`.

    Four indicators vote:

    - the growth power p, the slope of $\ln|v| = t\,\lambda(t)$ against $\ln t$ over the last decade of time: 1 on a
      torus, $0.424\,\lambda t$ on a chaotic orbit;
    - the mean MEGNO $\bar Y$: 2 on a torus, $\lambda t/2$ on a chaotic orbit;
    - SALI: of order one or falling like a power of t on a torus, exponentially on a chaotic orbit;
    - weighted averages of the squares of the components over the first and the last part of the run
      (`liepoisson.indicators.averages`): the same on a torus, different by a few per cent where an orbit wanders.

    "Chaotic" needs two votes of the first three and none against; "regular" needs the same for it, and averages that
    have settled.  The run must be at least 100 natural times long, $t\ge 100\,T$ with T from `time_scale`.  Growth
    power and MEGNO come from the same tangent vector and mostly agree; SALI comes from two others, averages from none.
    SALI does not vote where the leaves or the state have dimension two: it falls there on every orbit, like $1/t^2$.

    Nothing here has units: multiply H by c and divide `t_end` by c, or a component by a constant (tangent vectors are
    drawn and their angles taken in units of the components along the orbit), and the verdicts are the same.

    What the rule cannot see: an orbit that has hardly begun to be chaotic by `t_end`, and whose averages stand still
    until then.  Of orbits that are chaotic in a run 100 times longer at most 5% are called "regular", for the systems
    of docs/chaos.md, at the price of many "undecided" ones.  An unstable periodic orbit or equilibrium of an integrable
    system is "chaotic" though no neighbour of it is; so is any orbit on which the tangent vectors grow exponentially.

    Example:
        >>> top = lp.Top.twisted_kovalevskaya()
        >>> print(lp.decide(top, lp.sample_states(top, 3, seed=1), t_end=1000))
        0 regular, 3 chaotic, 0 undecided  (twisted Kovalevskaya top, t = 1000)

    Args:
        t_end: Time after which it is decided, in units of the system's own time; some hundred periods at least, some
            thousand if "regular" is to be said.  All orbits for which it is too short are "undecided".  By default 1000
            natural times of the median orbit (of the first 256), which is where the rule was fixed; give it if an
            ensemble is computed in pieces.
        rule: Other thresholds than those whose error rates were measured.

    Returns:
        Verdict.

    Raises:
        ShapeError: `starts` has another shape than stated.
        ParameterError: Numbers that are not finite, a time that is not positive, or a rule that is no `Rule`.
        KeyboardInterrupt: Ctrl-C.

    References:
        Benettin, Galgani and Strelcyn, Phys. Rev. A 14 (1976) 2338; Skokos, J. Phys. A 34 (2001) 10029; Cincotta
        and Simó, Astron. Astrophys. Suppl. 147 (2000) 205.
    """
    options = RunOptions.read(method, threads, time_limit, progress, seed=seed, first=first, system=system)
    end = None if t_end is None else as_time(t_end, "t_end", example=1000)
    rule = as_rule(rule)
    starts = given_starts(system, starts)  # once, as several runs start from it
    units = orbit_units(system, starts, options)
    end = TIME * unit_of_time(units.time) if end is None else end
    with np.errstate(divide="ignore"):
        natural_time = end / units.time
    n_all, n = units.component.shape
    tangents = at_equal_times(system, units.component * sample_tangents(n, n_all, **options.drawn))
    growth = megno(system, starts, t_end=end, tangents=tangents, **options.drawn, **options.inner(0, 1 / 3))
    # Eight pieces: a vector may grow by e^600 in each before a piece must be repeated in halves.
    times = end * np.arange(1, 9) / 8
    drawn, second = options.drawn, options.inner(1 / 3, 1 / 3)
    angle = alignment(system, starts, times=times, units=units.component, **drawn, **second)
    last = options.part(2 / 3, 1 / 3)
    averages = average_drift(system, starts, t_end=end, natural_time=natural_time, options=last)
    return _judge(growth, angle, averages, natural_time, rule=rule, options=options)


def as_rule(rule: Any) -> Rule:
    """The rule that is given, or the default one.

    Raises:
        ParameterError: it is no `Rule`.
    """
    return (
        Rule() if rule is None else check_kind(rule, Rule, "rule", "a Rule", "try Rule(megno=(3, 5)), or leave it out")
    )


def _judge(
    growth: Megno,
    angle: Alignment,
    averages: tuple[Array, NDArray[np.str_]],
    natural_time: Array,
    *,
    rule: Rule,
    options: RunOptions,
) -> Verdict:
    power, mean, sali = _growth_power(growth), growth.mean[:, -1], angle.sali[:, -1]
    votes = rule.votes(power, mean, np.full_like(sali, np.nan) if _is_plane(growth) else sali, averages[0])
    outcome = growth.outcome
    for other in (angle.outcome, averages[1]):
        outcome = np.where(outcome == "finished", other, outcome)
    return Verdict(
        **options.given(growth.system, growth.start, growth.field),
        **options.drawn,
        t_end=float(growth.time[-1]),
        rule=rule,
        verdict=np.where(outcome == "finished", rule.kinds(votes, natural_time), "undecided"),
        natural_time=natural_time,
        growth_power=power,
        mean_megno=mean,
        sali=sali,
        average_drift=averages[0],
        exponent=growth.log_growth[:, -1] / growth.time[-1],
        votes=votes,
        outcome=outcome,
    )


def _is_plane(growth: Megno) -> bool:
    """Whether orbits lie in leaves or in a state space of dimension two, where tangent vectors always align."""
    bracket = getattr(growth.system, "bracket", None)
    return (len(growth.components) if bracket is None else bracket.rank()) == 2


def _growth_power(growth: Megno) -> Array:
    """Least-squares slope of ln|v| against ln t over the last decade of time."""
    return _core.growth_powers(np.ascontiguousarray(growth.time), np.ascontiguousarray(growth.log_growth).ravel())


class Disagreement(NamedTuple):
    """A trajectory on which the indicators do not all say the same."""

    member: int
    verdict: str
    votes: dict[str, str]
    values: dict[str, float]

    def __str__(self) -> str:
        parts = (f"{name} {self.values[name]:.3g} {self.votes[name]}" for name in INDICATORS)
        return f"member {self.member}: {', '.join(parts)} -> {self.verdict}"


@dataclass(frozen=True, eq=False)
class Agreement(ReadOnlyArrays):
    """How far the indicators of an ensemble agree.

    Example:
        >>> top = lp.Top.twisted_kovalevskaya()
        >>> verdict = lp.decide(top, lp.sample_states(top, 20, seed=1), t_end=1000)
        >>> found = lp.chaos.agreement(verdict)
        >>> found.indicators[:3], found.same[:3, :3].tolist()
        (('growth_power', 'megno', 'sali'), [[20, 20, 20], [20, 20, 20], [20, 20, 20]])

    Attributes:
        indicators: Their names.
        same: Trajectories on which two indicators say the same, shape (indicator, indicator).
        contrary: Trajectories that one of them calls regular and the other chaotic, shape (indicator, indicator).
        n: Trajectories that finished.
        disagreements: Every trajectory on which the first three do not all say the same, in order.
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
        lines.append(
            f"{len(self.disagreements)} of {self.n} trajectories without a unanimous vote of the tangent vectors"
        )
        return "\n".join([*lines, *map(str, self.disagreements)])


@explains_its_arguments
def agreement(verdict: Verdict) -> Agreement:
    """Agreement matrix of the indicators, and every trajectory on which they disagree, with the values.

    Example:
        >>> top = lp.Top.twisted_kovalevskaya()
        >>> found = lp.chaos.agreement(lp.decide(top, lp.sample_states(top, 20, seed=1), t_end=1000))
        >>> found.n, int(found.contrary.sum()), len(found.disagreements)
        (20, 0, 0)

    Args:
        verdict: Result of `decide`.

    Raises:
        ParameterError: it is none.
    """
    check_kind(verdict, Verdict, "verdict", "what decide returns", "call decide first")
    done = np.flatnonzero(verdict.outcome == "finished")
    votes = verdict.votes[done].astype(np.int64)
    same = (votes[:, :, None] == votes[:, None, :]).sum(axis=0)
    contrary = (votes[:, :, None] * votes[:, None, :] == -1).sum(axis=0)
    # averages never vote for chaos: that they do not vote is no disagreement
    split = done[(votes[:, :3] != votes[:, :1]).any(axis=1)]
    return Agreement(INDICATORS, same, contrary, len(done), tuple(_disagreement(verdict, int(k)) for k in split))


def _disagreement(verdict: Verdict, k: int) -> Disagreement:
    names = {-1: "regular", 0: "undecided", 1: "chaotic"}
    values = (verdict.growth_power[k], verdict.mean_megno[k], verdict.sali[k], verdict.average_drift[k])
    return Disagreement(
        member=verdict.first + k,
        verdict=str(verdict.verdict[k]),
        votes={name: names[int(vote)] for name, vote in zip(INDICATORS, verdict.votes[k], strict=True)},
        values=dict(zip(INDICATORS, map(float, values), strict=True)),
    )
