r"""Fits of a model to observed orbits: parameters and starts with their errors, and what the data do not determine."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liepoisson.errors import ParameterError, ShapeError
from liepoisson.formula.scalars import TIME_LIMIT, as_count, as_finite, as_number
from liepoisson.inputs.arrays import Array, check_finite, read_only
from liepoisson.inputs.calls import shows_progress
from liepoisson.inputs.given import by_name, is_named, listed, listed_names, named
from liepoisson.inputs.refusals import counted, not_a_system, shown
from liepoisson.io.result import Result, labelled, names_along, recorded
from liepoisson.io.tables import Tabular
from liepoisson.model.equations_of_motion import EquationsOfMotion
from liepoisson.model.free_parameter import with_values
from liepoisson.numeric.method.method import Method
from liepoisson.numeric.method.taylor import Taylor
from liepoisson.numeric.methods import MethodChoice, method_of, method_record
from liepoisson.numeric.run_options import RunOptions
from liepoisson.numeric.starts import StartsLike, as_states, given_starts
from liepoisson.observations.least_squares import NOTHING, Frame, Minimum, minimum, undetermined
from liepoisson.observations.observations import Observations, as_observations
from liepoisson.observations.sensitivities import Model, Prediction, clock_of, parts_of

_OF_ORBITS = 2.0**-42
"""Relative error of an orbit to round-off: some thousand operations."""
ENDED_WELL = ("converged", "at a bound", "not determined")
"""How a search ends at a minimum, or in a valley of them."""
_N_CURVE = 1001
"""Times of a curve between observations."""


@dataclass(frozen=True, kw_only=True, eq=False)
class OrbitFit(Result):
    r"""A model fitted to observed orbits; `print` shows values, errors, and what is not determined.

    Example:
        >>> pendulum = lp.System(lp.canonical(1, names=["q"]), "p_q^2/2 - g*cos(q)", {"g": 9})
        >>> observed = {"t": [0.0, 0.25, 0.5, 0.75, 1.0], "q": [0.201, 0.143, 0.003, -0.142, -0.200]}
        >>> fit = lp.fits.orbit_fit(pendulum, observed, ["g", "q", "p_q"], starts={"p_q": 0})
        >>> fit
        <OrbitFit of Hamiltonian system: converged, 3 unknowns of 5 values, g = 10.0 ± 0.2, ...>
        >>> {name: round(float(z), 2) for name, z in zip(fit.unknowns, fit.value)}
        {'g': 10.04, 'q(t0)': 0.2, 'p_q(t0)': 0.01}

    Attributes:
        system: The system, as it was given: its parameters are the guess.
        observables: What was observed: components, formulas.
        unknowns: Names of what was looked for: parameters, and components of starts as "theta(t0)".
        wanted: The same as it was given, with names of vectors.
        runs: Names of the runs.
        guess_start: Starts where the search began, shape (trajectory, component).
        start_time: The time of each start, shape (trajectory,).
        run_of: Place of the run of each row, shape (row,).
        time: Times of the observations, shape (row,).
        observed: What was observed, NaN where it is missing, shape (row, observable).
        deviation: Its standard deviations, or numbers proportional to them.
        errors_are_known: Whether the standard deviations were given.
        lower, upper: Bounds of the unknowns, shape (unknown,).
        guess: Where the search began.
        value: The least-squares values of the unknowns, shape (unknown,).
        error: Their standard errors; infinite for what is not determined, NaN at a bound and where the search did not
            converge.
        covariance: Of the unknowns, shape (unknown, unknown).
        null: Directions in the unknowns that change no observed value, shape (direction, unknown).
        singular: Singular values of the derivatives with columns of length 1, falling.
        predicted: What the fitted model says, shape (row, observable).
        residual: Observed less predicted; of an angle within half a turn.
        start: Fitted starts, shape (trajectory, component).
        outcome: How the fitted trajectory of each run ended.
        ending: How the search ended: "converged"; "at a bound"; "not determined" at a minimum from which unknowns can
            change without a change of any observed value (`undetermined` says which), as a guess from which the search
            went astray may lead to; "no progress" where no shorter step helps and the slope is not zero, as on chaotic
            orbits; "most steps"; "no trajectory" where the orbit of the guess ends before the last observation; "time
            limit".
        undetermined: What the data do not tell, in words.
        n_steps: Accepted steps of the search.
        most_steps: How many it might take.
    """

    kind = "orbit fit"
    made_by = "orbit_fit"
    rows = ("unknown",)

    system: Any
    components: tuple[str, ...] = names_along("component")
    observables: tuple[str, ...] = names_along("observable")
    unknowns: tuple[str, ...] = names_along("unknown")
    wanted: tuple[str, ...]
    runs: tuple[str, ...]
    method: Method = recorded(method_record, method_of)
    guess_start: Array = labelled("trajectory", "component", long_name="state where the search began")
    start_time: Array = labelled("trajectory", long_name="time of the start")
    run_of: NDArray[np.int64] = labelled("row", long_name="place of the run", units="1", numbers="trajectory")
    time: Array = labelled("row", long_name="time")
    observed: Array = labelled("row", "observable", long_name="observed value")
    deviation: Array = labelled("row", "observable", long_name="standard deviation")
    errors_are_known: bool
    lower: Array = labelled("unknown", long_name="lower bound")
    upper: Array = labelled("unknown", long_name="upper bound")
    guess: Array = labelled("unknown", long_name="value where the search began")
    value: Array = labelled("unknown", long_name="fitted value")
    error: Array = labelled("unknown", long_name="standard error")
    covariance: Array = labelled("unknown", "other", long_name="covariance")
    null: Array = labelled("null_direction", "unknown", long_name="direction that is not determined")
    singular: Array = labelled("direction", long_name="singular value")
    predicted: Array = labelled("row", "observable", long_name="value of the fitted model")
    residual: Array = labelled("row", "observable", long_name="observed less predicted")
    start: Array = labelled("trajectory", "component", long_name="fitted state at the start")
    outcome: NDArray[np.str_] = labelled("trajectory", long_name="how the fitted trajectory ended")
    ending: str
    undetermined: tuple[str, ...]
    n_steps: int
    most_steps: int
    time_limit: float = np.inf

    def arguments(self) -> dict[str, Any]:
        """What `orbit_fit` was called with."""
        if len(self.guess_start) != len(self.runs):
            raise ParameterError(
                f"starts: wanted those of all {len(self.runs)} runs; got {len(self.guess_start)}; load the file"
            )
        bounds = dict(zip(self.unknowns, zip(self.lower.tolist(), self.upper.tolist(), strict=True), strict=True))
        return {
            "observed": self.observations,
            "unknowns": self.wanted,
            "starts": self.guess_start,
            "start_time": self.start_time,
            "bounds": bounds,
            "most_steps": self.most_steps,
            "method": self.method,
        }

    @property
    def observations(self) -> Observations:
        """What was observed."""
        return Observations.of_arrays(
            names=self.observables, runs=self.runs, run=self.run_of, time=self.time, value=self.observed,
            deviation=self.deviation, errors_are_known=self.errors_are_known,
        )  # fmt: skip

    @property
    def n_values(self) -> int:
        """Number of observed values."""
        return int(np.isfinite(self.observed).sum())

    @property
    def chi_squared(self) -> float:
        r"""$\chi^2 = \sum_{ij}(y_{ij} - f_j(x(t_i)))^2/\sigma_{ij}^2$; without errors the sum of the squares."""
        with np.errstate(all="ignore"):
            return float(np.nansum((self.residual / self.deviation) ** 2))

    @property
    def degrees_of_freedom(self) -> int:
        """Observed values less determined combinations of the unknowns."""
        return self.n_values - int((self.singular > NOTHING * self.singular.max(initial=0.0)).sum())

    @property
    def scatter(self) -> float:
        r"""$\sqrt{\chi^2/\mathrm{dof}}$: near 1 where errors are right; without errors that of a value of weight 1."""
        dof = self.degrees_of_freedom
        return float(np.sqrt(self.chi_squared / dof)) if dof > 0 else float(np.nan)

    @property
    def correlation(self) -> Array:
        """Correlations of the unknowns, shape (unknown, unknown); NaN for what is not determined."""
        with np.errstate(all="ignore"):
            return read_only(self.covariance / np.outer(self.error, self.error))

    @cached_property
    def fitted_system(self) -> Any:
        """The system with the fitted values of its parameters."""
        n = len(self.unknowns) - self._n_of_starts
        values: Any = {name: Fraction(float(z)) for name, z in zip(self.unknowns[:n], self.value[:n], strict=True)}
        return with_values(self.system, values) if n else self.system

    @property
    def _n_of_starts(self) -> int:
        return sum(name not in self._model.parameters for name in self.unknowns)

    @cached_property
    def _model(self) -> Model:
        return Model(self.system, self.observations, self.wanted, self.guess_start)

    def curve(self, run: int = 0, *, n_times: int = _N_CURVE) -> tuple[Array, Array]:
        """What the fitted model says between the start of a run and its last observation.

        Args:
            run: Its place among the runs.
            n_times: How many times, evenly spaced.

        Returns:
            Times, shape (time,), and values, shape (time, observable); NaN where the trajectory ended before.
        """
        as_count(run, "run", most=len(self.runs) - 1)
        n = as_count(n_times, "n_times", least=2, most=10_000_000)
        model, begin = self._model, float(self.start_time[run])
        last = float(self.time[self.run_of == run].max())
        times = np.linspace(begin, last, n) if last > begin else np.array([begin])
        state = model.starts(self.start, self.value)[run]
        found, _, _ = model.orbit(state, np.zeros((0, len(state))), begin, times, method=self.method)
        return times, model.values(found)

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table: of each unknown its name, value, standard error, guess and bounds."""
        named: dict[str, NDArray[Any]] = {"unknown": np.array(self.unknowns, dtype=object)}
        own = ("value", "error", "guess", "lower", "upper")
        return named | {name: getattr(self, name) for name in own}

    def __str__(self) -> str:
        """Values with errors, the goodness of the fit, correlations above 0.9, and what is not determined."""
        width = max(map(len, self.unknowns))
        lines = [repr(self)]
        lines += [
            f"  {name:<{width}} = {with_error(z, e)}"
            for name, z, e in zip(self.unknowns, self.value, self.error, strict=True)
        ]
        dof = self.degrees_of_freedom
        if self.errors_are_known:
            lines.append(f"chi^2 = {self.chi_squared:.4g} with {counted(dof, 'degree')} of freedom")
        else:
            lines.append(
                f"error of a value, from the residuals: {self.scatter:.3g}, with {counted(dof, 'degree')} of freedom"
            )
        near = np.argwhere(np.triu(np.abs(self.correlation) > _CLOSE, 1))
        lines += [
            f"correlation of {self.unknowns[i]} and {self.unknowns[j]}: {self.correlation[i, j]:+.3f}" for i, j in near
        ]
        return "\n".join([*lines, *(f"not determined: {words}" for words in self.undetermined)])

    def __repr__(self) -> str:
        first = f"{self.unknowns[0]} = {with_error(self.value[0], self.error[0])}" + ", ..." * (len(self.unknowns) > 1)
        what = f"{counted(len(self.unknowns), 'unknown')} of {counted(self.n_values, 'value')}"
        return f"<OrbitFit of {self.system.name}: {self.ending}, {what}, {first}>"


_CLOSE = 0.9
"""Correlations above are printed."""


def with_error(value: float, error: float) -> str:
    """A value with its error to one digit, or two where it begins with 1: "9.93 ± 0.08"."""
    if np.isinf(error):
        return f"{value:.6g}, not determined"
    if not np.isfinite(error) or error <= 0:
        return f"{value:.10g}"
    first, _, exponent = f"{error:.0e}".partition("e")
    digits = (first == "1") - int(exponent)
    if not -6 < digits < 16:
        return f"{value:.10g} ± {error:.1g}"
    return f"{value:.{max(digits, 0)}f} ± {error:.{max(digits, 0)}f}"


@shows_progress
def orbit_fit(
    system: Any,
    observed: Observations | str | Path | Tabular | Mapping[str, Any],
    unknowns: Sequence[str],
    *,
    starts: StartsLike | None = None,
    start_time: float | Sequence[float] | None = None,
    bounds: Mapping[str, Sequence[float | None]] | None = None,
    most_steps: int = 100,
    method: MethodChoice | None = None,
    threads: int | None = None,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> OrbitFit:
    r"""Parameters and starts of a model with the least squares of its residuals, with their errors.

    The sum $\chi^2(p, x_0) = \sum_{ij}\big(y_{ij} - f_j(x(t_i; x_0, p), p)\big)^2/\sigma_{ij}^2$ is minimised by the
    method of Levenberg and Marquardt.  Derivatives are exact: tangent vectors of the flow by the start and by the
    parameters.  The covariance of the unknowns is the inverse of $A^TA$, A the derivatives of the residuals in units of
    their errors, times $\chi^2$ over its degrees of freedom where errors were not given.  It is that of the linear
    problem: true for small errors.  The minimum is a local one: the guess should be right to a fraction of a turn at
    the last time.  Starts are fitted freely in phase space, and so is the leaf that they lie on.

    Example:
        >>> body = lp.System(lp.so(3) @ lp.trivial(), "dot(l, inv(I)*l)/2", {"I": [1, 2, 3]})
        >>> run = lp.integrate(body, [1, 0.5, 0.2], times=np.linspace(0, 10, 41))
        >>> rates = {"t": run.time} | {f"l{k}/I{k}": run.state[0, :, k - 1] / k for k in (1, 2, 3)}
        >>> fit = lp.fits.orbit_fit(body, rates, ["I", "l"], starts=[1, 0.5, 0.2])  # what a gyroscope sees
        >>> fit.undetermined
        ('only the ratios of I1, I2, I3, l1(t0), l2(t0), l3(t0)',)
        >>> lp.fits.orbit_fit(body, rates, ["I2", "I3", "l"], starts=[1, 0.5, 0.2]).undetermined
        ()

    Args:
        system: A `System` or a `VectorField` with numbers for all parameters: those that are unknown are the guess.
        observed: The observations, or what `Observations` reads: a CSV file, a table, a mapping.
        unknowns: What is looked for: parameters ("g", "I1", or the vector "I"), and components of the state at the
            start of each run ("l1", or the vector "l").
        starts: States at the start, for all runs or one for each: guesses where they are unknown.  Of components that
            are observed and not given by name the first observed value is taken.  By default all are taken so.
        start_time: Time of the starts, one number or one for each run; by default the first time of each run.
        bounds: Least and largest values of unknowns by name, None for none: `{"g": (0, None)}`.  The guess lies within.
        most_steps: Most steps of the search.
        method: How orbits are integrated, with tangent vectors; by default `Taylor()`, to round-off.

    Returns:
        OrbitFit; a search that fails is an ending in it, not an error.

    Raises:
        ParameterError: an unknown is neither a parameter nor a component, or is given twice; a column is no function of
            the state; there are fewer values than unknowns; a start is not known; a bound is above the other; a guess
            lies outside of its bounds.
        ShapeError: starts have another shape.

    References: Levenberg, Quarterly of Applied Mathematics 2 (1944) 164; Marquardt, SIAM Journal on Applied Mathematics
        11 (1963) 431; Bard, Nonlinear Parameter Estimation (1974).
    """
    options = RunOptions.read(method, threads, time_limit, progress, default=Taylor(), system=system)
    data, wanted = as_observations(observed), _as_names(unknowns)
    if not isinstance(system, EquationsOfMotion):
        raise not_a_system(system)
    n_steps = as_count(most_steps, "most_steps", least=1, most=1_000_000)
    begins = _as_start_times(start_time, data)
    states = _as_guesses(system, data, starts, begins)
    model = Model(system, data, wanted, states)
    guess = np.concatenate(
        [model.numbers, [states[one.run or 0, one.place] for one in model.unknowns if one.run is not None]]
    )
    low, high = _as_bounds(bounds, model)
    _check_guess(model, guess, low, high)
    if data.n_values < len(model.unknowns):
        raise ParameterError(
            f"unknowns: wanted at most as many as there are values; got {counted(len(model.unknowns), 'unknown')} and "
            f"{counted(data.n_values, 'value')}; look for fewer, or give more data"
        )
    seen = np.isfinite(data.value)

    def residuals(u: Array) -> tuple[Array, Array] | None:
        found = model.prediction(model.starts(states, u), begins, options)
        r, J = model.residuals(found.value)[seen], found.derivative[seen]
        if not (np.isfinite(r).all() and np.isfinite(J).all()):
            return None
        return r / data.deviation[seen], J / data.deviation[seen][:, None]

    with options.deadline.running():
        found = minimum(
            residuals,
            guess,
            (low, high),
            size=_length(data),
            accuracy=max(_OF_ORBITS, getattr(options.method, "tol", 0.0)),
            most_steps=n_steps,
            is_late=lambda: options.is_late,
            tell=options.tell,
        )
        prediction = model.prediction(model.starts(states, found.unknown), begins, options)
    return _result(model, found, prediction, options, given={
        "wanted": wanted, "guess_start": states, "start_time": begins, "lower": low, "upper": high, "guess": guess,
        "most_steps": n_steps,
    })  # fmt: skip


def _check_guess(model: Model, guess: Array, low: Array, high: Array) -> None:
    """Refuses a guess outside of its bounds."""
    for one, z, least, most in zip(model.unknowns, guess, low, high, strict=True):
        if not least <= z <= most:
            where = "value in the system" if one.run is None else "start"
            raise ParameterError(
                f"bounds: wanted a guess within them, {least:g} to {most:g} for {one.name}; got {z:g}; give another "
                f"{where}, or other bounds"
            )


def _result(
    model: Model, found: Minimum, prediction: Prediction, options: RunOptions, given: Mapping[str, Any]
) -> OrbitFit:
    """The result of a search that has ended."""
    data, m = model.observed, len(model.unknowns)
    names = tuple(one.name for one in model.unknowns)
    residual = -model.residuals(prediction.value)
    error, covariance = np.full(m, np.nan), np.full((m, m), np.nan)
    null, singular, words = np.zeros((0, m)), np.zeros(0), ()
    seen = np.isfinite(data.value)
    derivative = prediction.derivative[seen] / data.deviation[seen][:, None]
    size = _length(data)
    if np.isfinite(derivative).all():
        frame = Frame.of(derivative, found.held)
        null, singular = frame.null, frame.singular
        words = undetermined(names, found.unknown, frame, size)
        dof = data.n_values - frame.rank
        with np.errstate(all="ignore"):
            variance = (
                1.0 if data.errors_are_known else np.nansum((residual / data.deviation) ** 2) / dof if dof else np.nan
            )
            covariance = frame.covariance * variance
            error = np.sqrt(np.diag(covariance))
        free = np.any(np.abs(null / frame.unit) > NOTHING, axis=0) if len(null) else np.zeros(m, dtype=bool)
        covariance[free, :] = covariance[:, free] = np.nan
        error[free], covariance[free, free] = np.inf, np.inf
        unsaid = frame.held if found.ending in ENDED_WELL else np.ones(m, dtype=bool)
        error[unsaid] = np.nan
        covariance[unsaid, :] = covariance[:, unsaid] = np.nan
    late = found.ending == "time limit"
    ending = "not determined" if words and found.ending == "converged" else found.ending
    return OrbitFit(
        system=model.system,
        components=model.system.component_names,
        observables=data.names,
        unknowns=names,
        runs=data.runs,
        method=options.method,
        run_of=data.run,
        time=data.time,
        observed=data.value,
        deviation=data.deviation,
        errors_are_known=data.errors_are_known,
        value=found.unknown,
        error=error,
        covariance=covariance,
        null=null,
        singular=singular,
        predicted=prediction.value,
        residual=residual,
        start=model.starts(given["guess_start"], found.unknown)[:, : len(model.system.component_names)],
        outcome=np.array(["time limit"] * len(data.runs) if late else prediction.outcome, dtype=np.str_),
        ending=ending,
        undetermined=words,
        n_steps=found.n_steps,
        time_limit=options.time_limit,
        **given,
    )


def _length(data: Observations) -> float:
    """Of the observed values in units of their errors."""
    seen = np.isfinite(data.value)
    return float(np.sqrt(np.sum((data.value[seen] / data.deviation[seen]) ** 2)))


def _as_names(unknowns: Any) -> tuple[str, ...]:
    items = None if isinstance(unknowns, str) else listed_names(unknowns, "unknowns")
    if not items:
        raise ParameterError(f'unknowns: wanted names of parameters and components; got {shown(unknowns)}; write ["g"]')
    return tuple(items)


def _as_start_times(start_time: Any, data: Observations) -> Array:
    """The time of the start of each run, not after its first observation."""
    first = np.array([data.time[data.run == k].min() for k in range(len(data.runs))])
    if start_time is None:
        return first
    items = listed(start_time, "start_time")
    times = np.array([as_finite(one, "start_time") for one in ([start_time] if items is None else items)])
    if len(times) not in (1, len(first)):
        raise ShapeError(f"start_time: wanted one, or one for each of {len(first)} runs; got {len(times)}")
    times = np.broadcast_to(times, first.shape).copy()
    if (late := np.flatnonzero(times > first)).size:
        k = int(late[0])
        raise ParameterError(
            f"start_time: wanted times up to the first of a run, {first[k]:g}; got {times[k]:g}; take an earlier one"
        )
    return times


def _as_guesses(system: EquationsOfMotion, data: Observations, starts: Any, begins: Array) -> Array:
    """A start for each run: as it was given, or the first observed value of a component."""
    parts, clock = parts_of(system), clock_of(system)
    names, n_runs = system.component_names, len(data.runs)
    states = np.zeros((n_runs, len(names)))
    told = np.zeros(len(names), dtype=bool)
    if starts is not None:
        given = given_starts(system, starts)
        states = as_states(given, len(names), names=names)
        if len(states) not in (1, n_runs):
            raise ShapeError(f"starts: wanted one state, or one for each of {n_runs} runs; got {len(states)}")
        states = np.broadcast_to(states, (n_runs, len(names))).copy()
        check_finite(states, "starts", "give finite states")
        by = named(starts, "starts") if is_named(starts) else None
        if by is None:
            told[:] = True
        for name in by or ():
            told[[names.index(part) for part in parts[str(name)]]] = True
    for k, name in enumerate(names):
        if k == clock:
            states[:, k] = begins
        elif not told[k] and name in data.names:
            states[:, k] = [_first_value(data, name, run) for run in range(n_runs)]
        elif not told[k] and starts is None and not (clock is not None and name == "p_t"):
            raise ParameterError(
                f"starts: wanted the start of each component; {name} is not observed, and no start was given; give a "
                f'guess, starts={{"{name}": 0}} (--start {name}=0)'
            )
    return states


def _first_value(data: Observations, name: str, run: int) -> float:
    column = data.value[data.run == run, data.names.index(name)]
    seen = np.isfinite(column)
    if not seen.any():
        raise ParameterError(
            f"starts: wanted the start of {name} in run {data.runs[run]}, which has no value; give starts"
        )
    return float(column[seen][0])


def _as_bounds(bounds: Any, model: Model) -> tuple[Array, Array]:
    m = len(model.unknowns)
    low, high = np.full(m, -np.inf), np.full(m, np.inf)
    if bounds is None:
        return low, high
    places = [one.name for one in model.unknowns]
    components, parts = model.system.component_names, parts_of(model.system)
    for name, pair in by_name(bounds, "bounds", "two numbers", '{"g": (0, None)}').items():
        of = parts.get(name, (name,))
        chosen = [
            k for k, one in enumerate(model.unknowns)
            if one.name == name or (places[k] if one.run is None else components[one.place]) in of
        ]  # fmt: skip
        if not chosen:
            raise ParameterError(f"bounds: wanted unknowns, {', '.join(places):.150}; got {shown(name)}. Leave it out.")
        items = listed(pair, f"bounds of {name}")
        if items is None or len(items) != 2:
            raise ParameterError(f"bounds: wanted two numbers for {name}; got {shown(pair)}; write (0, None)")
        least, most = (
            end if one is None else as_number(one, f"bounds of {name}", "a number or None")
            for one, end in zip(items, (-np.inf, np.inf), strict=True)
        )
        if not least <= most:
            raise ParameterError(f"bounds: wanted the lower bound first; got {shown(pair)} for {name}; exchange them")
        low[chosen], high[chosen] = least, most
    return low, high
