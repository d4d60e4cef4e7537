r"""Frequency analysis after Laskar: the main frequency of an orbit in two windows of time, and how far it moved."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson.errors import ParameterError, ShapeError
from liepoisson.formula.scalars import TIME_LIMIT, as_count, as_positive, as_time
from liepoisson.indicators.alignment import bound_memory
from liepoisson.inputs.arrays import Array, check_finite, check_shape
from liepoisson.inputs.calls import shows_progress
from liepoisson.inputs.given import as_name, at_interval, listed_names, ordered
from liepoisson.inputs.refusals import shown
from liepoisson.io.result import labelled, recorded
from liepoisson.numeric.integrate import integrate
from liepoisson.numeric.methods import MethodChoice
from liepoisson.numeric.run import Run, trajectories, typical
from liepoisson.numeric.run_options import RunOptions
from liepoisson.numeric.starts import StartsLike, as_starts
from liepoisson.numeric.systems import HasField, component_names, has_functions
from liepoisson.poincare.section_arguments import check_that_it_varies, why_constant
from liepoisson.portable import elementary, linear

Signal: TypeAlias = NDArray[np.complex128]
Observable: TypeAlias = str | Sequence[str] | Callable[[Array], ArrayLike]

# Trajectories whose samples are in memory at once: 64 x 4,097 states of nine numbers are 19 MB.
_CHUNK = 64
# Samples of windows that are analysed before the clock is looked at: some 0.2 s on one core (measured).
_ANALYSED = 2**17
_MOST_ORDER = 8
# Bytes for each sample of a window: states of two windows, twice, and signals, spectra on the finer grid, squares.
# Measured for nine components: 432.
_STATE_BYTES, _SIGNAL_BYTES = 32, 300


class _Forgotten:
    """A function of the caller, of which a file has the name only."""

    def __init__(self, name: str) -> None:
        self.name = name


def _observable_record(given: Any) -> Any:
    return {"function": getattr(given, "__qualname__", type(given).__name__)} if callable(given) else list(given)


def _observable_of(record: Any) -> Any:
    return _Forgotten(str(record["function"])) if isinstance(record, dict) else tuple(map(str, record))


@dataclass(frozen=True, kw_only=True, eq=False)
class FrequencyDrift(Run):
    r"""The main frequency along trajectories, in two windows of the same length, one after the other.

    Example:
        >>> top, start = lp.Top.lagrange(), [0.5, 0, 1, 0.6, 0, 0.8, 0, 0, 0]
        >>> found = lp.chaos.frequency_drift(top, start, observable=("alpha1", "alpha2"), t_end=400)
        >>> found.frequency.round(4), bool(found.drift[0] < 1e-6)
        (array([[-1.7776, -1.7776]]), True)

    Attributes:
        observable: The signal, as it was given; the name of a function of the caller.
        n_samples: Samples in each window.
        window_order: Power of the Hanning window.
        window: Length T of each window, half of the run.
        frequency: Angular frequency in [0, T] and in [T, 2T], in radians per time, shape (trajectory, window); NaN
            where a trajectory failed.
        amplitude: Amplitude of the line in each window, shape (trajectory, window).
        nyquist: $\pi$ over the time between samples: lines beyond it would be taken for others.
        high_power: Share of the power of the signal at frequencies beyond half of `nyquist`, shape (trajectory,).  If
            it is not small, the signal has parts that are sampled too coarsely: raise `n_samples`.
    """

    kind = "frequency drift"
    made_by = "frequency_drift"

    observable: Observable = recorded(_observable_record, _observable_of)
    n_samples: int
    window_order: int
    window: float
    frequency: Array = labelled(
        "trajectory", "window", long_name="angular frequency", units="radians per time, dimensionless"
    )
    amplitude: Array = labelled("trajectory", "window", long_name="amplitude of the line")
    nyquist: float
    high_power: Array = labelled("trajectory", long_name="share of the power at high frequencies", units="1")

    def arguments(self) -> dict[str, Any]:
        """What `frequency_drift` was called with."""
        if isinstance(self.observable, _Forgotten):
            raise ParameterError(
                f"observable: it was the function {self.observable.name} of the caller, which no file keeps; call "
                "frequency_drift again with it"
            )
        own = {name: getattr(self, name) for name in ("observable", "n_samples", "window_order")}
        return super().arguments() | own | {"t_end": 2 * self.window}

    @property
    def drift(self) -> Array:
        r"""$|f_2 - f_1|$, in radians per time, shape (trajectory,)."""
        return np.abs(self.frequency[:, 1] - self.frequency[:, 0])

    def __repr__(self) -> str:
        value = f"{typical('drift', self.drift)} between two windows of {self.window:g}"
        return f"<FrequencyDrift of {self.system.name}: {trajectories(self.outcome)}, {value}>"


@shows_progress
def frequency_drift(
    system: HasField,
    starts: StartsLike,
    *,
    observable: Observable,
    t_end: float,
    n_samples: int = 2048,
    window_order: int = 1,
    method: MethodChoice | None = None,
    threads: int | None = None,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> FrequencyDrift:
    r"""How far the main frequency of an orbit moves from one window of time to the next.

    In each window the frequency is where $|\int f(t)\,e^{-i\sigma t}\chi(t)\,dt|$ is largest near the line that is
    strongest in both windows together (the largest product of the amplitudes).  $\chi$ is the Hanning window to the
    power `window_order`.  The mean of the signal in each window is taken off first: a constant has no frequency that
    could move.

    On a torus the frequency is constant, and both values differ by the error of the analysis only, of order
    $T^{-2p-2}$ for the window order p once the lines of the signal are many $2\pi/T$ apart.  On a chaotic orbit the
    lines wander.  Both searches start from the common line, so the drift is seldom larger than a few $2\pi/T$: it ranks
    orbits, and is no rate of diffusion.

    A function that is constant along every orbit has no line, and is refused where its bracket with H says so.  Others
    may be constant along one orbit: where `amplitude` is not above the errors of the integration, the frequency is that
    of noise.

    The signal is sampled `n_samples` times per window.  A line at a frequency beyond $\pi\,n/T$ appears at a wrong one
    (aliasing); so do the harmonics of a signal that is no pure rotation.

    Example:
        >>> top, start = lp.Top.lagrange(), [0.5, 0, 1, 0.6, 0, 0.8, 0, 0, 0]
        >>> found = lp.chaos.frequency_drift(top, start, observable=("alpha1", "alpha2"), t_end=400)
        >>> round(float(found.frequency[0, 0]), 4), bool(found.drift[0] < 1e-6)  # a torus
        (-1.7776, True)

    Args:
        observable: The signal f: two names or formulas for real and imaginary part, such as ("beta1", "beta2"); one for
            a real signal; or a function of states, shape (..., component),
            with values of shape (...).  Formulas need a system with a bracket.
        t_end: Length 2T of the run, positive: two windows of length T.
        n_samples: Samples per window, at least 16.
        window_order: Power p of the Hanning window, 1 to 8.  More suppresses neighbouring lines faster and resolves
            them worse.

    Returns:
        FrequencyDrift; a trajectory that fails is an outcome in it, not an error.

    Raises:
        ShapeError: An array has another shape than stated.
        ParameterError: Numbers that are not finite, an unknown name in the observable, one that is a Casimir or a
            constant of motion, a count out of range, or samples of more than 4 GiB for the 64 trajectories that run
            at once.
        KeyboardInterrupt: Ctrl-C.

    References:
        Laskar, Icarus 88 (1990) 266; Laskar, Physica D 67 (1993) 257.
    """
    options = RunOptions.read(method, threads, time_limit, progress, system=system)
    observable = _texts_of(observable)
    field = options.field(system)
    n = field.n_components
    states, window = as_starts(system, starts, n), as_time(t_end, "t_end", example=1000) / 2
    samples = as_count(n_samples, "n_samples", least=16, most=2**24, hint="try n_samples=2048")
    at_once = min(_CHUNK, len(states))
    bound_memory((_STATE_BYTES * n + _SIGNAL_BYTES) * samples * (at_once + 1), samples, at_once)
    order = as_count(window_order, "window_order", least=1, most=_MOST_ORDER)
    evaluate = _as_observable(system, n, observable)
    spare = states[np.isfinite(states).all(axis=1)][:1]
    times = window * np.arange(2 * samples + 1) / samples
    lines, high = np.full((2, 2, len(states)), np.nan), np.full(len(states), np.nan)
    outcome = np.full(len(states), "finished", dtype="<U16")
    for start in range(0, len(states), _CHUNK):
        here = slice(start, min(start + _CHUNK, len(states)))
        if start and options.is_late:
            outcome[start:] = "time limit"
            break
        orbit = integrate(
            system,
            np.concatenate([states[here], spare]),  # a chunk may have bad rows only; the good one is dropped below
            times=times,
            kernel="lanes",  # the same bits however the ensemble is cut
            **options.inner(start / len(states), (here.stop - start) / len(states)),
        )
        outcome[here] = orbit.outcome[:-1]
        good = np.flatnonzero(orbit.outcome[:-1] == "finished")
        few = max(1, _ANALYSED // samples)
        for some in (good[k : k + few] for k in range(0, len(good), few)):
            if options.is_late:
                outcome[start + some] = "time limit"
                continue
            signal, real = evaluate(orbit.state[some])
            halves = np.stack([signal[:, : samples + 1], signal[:, samples:]])
            lines[:, :, start + some], high[start + some] = _common_line(halves, window / samples, order, real)
        options.tell(here.stop / len(states))
    return FrequencyDrift(
        **options.given(system, states, field),
        observable=observable,
        n_samples=samples,
        window_order=order,
        window=window,
        frequency=lines[0].T.copy(),
        amplitude=lines[1].T.copy(),
        nyquist=np.pi * samples / window,
        high_power=high,
        outcome=outcome,
    )


def main_frequency(signal: ArrayLike, interval: float, *, window_order: int = 1) -> tuple[Array, Array]:
    r"""The frequency at which the windowed Fourier transform of evenly sampled signals is largest, and its amplitude.

    The mean is taken off first.

    Args:
        signal: Samples, complex or real, shape (sample,) or (trajectory, sample), 17 or more.
        interval: Time between samples, positive.
        window_order: Power p of the Hanning window; the error falls like $T^{-2p-2}$ with the length T of the signal.

    Returns:
        Angular frequencies in radians per time, between $-\pi$ and $\pi$ over the interval (for a real signal,
        above 0), and amplitudes, each of shape (trajectory,).

    Raises:
        ShapeError: The signal has another shape than stated.
        ParameterError: The signal is not finite, the interval is not positive, or the signal has times as labels that
            do not differ by it.
    """
    step = as_positive(interval, "interval", "a positive time between two samples", example=0.1)
    values = np.atleast_2d(np.array(ordered(at_interval(signal, "signal", step), "signal")))
    fits = values.ndim == 2 and values.shape[1] >= 17 and values.dtype.kind in "iufc"
    wanted = "(sample,) or (trajectory, sample), numbers, 17 samples or more"
    check_shape(fits, "signal", wanted, values, f"They are of {values.dtype}. Sample it for longer.")
    check_finite(values, "signal", "leave these trajectories out")
    order = as_count(window_order, "window_order", least=1, most=_MOST_ORDER)
    real = values.dtype.kind != "c"
    lines, _ = _common_line(values.astype(np.complex128)[None], step, order, real)
    return lines[0, 0], lines[1, 0]


def _common_line(signals: Signal, step: float, order: int, real: bool) -> tuple[Array, Array]:
    """Frequency and amplitude in each window, shape (2, window, trajectory), and the share of high frequencies.

    The signals have shape (window, trajectory, sample).
    """
    n = signals.shape[-1] - 1
    window = _hanning(n, order)
    weighted = signals * window
    weighted -= weighted.sum(axis=-1, keepdims=True) * window
    # the grid is finer than the peak, whose half width is 2 pi/T or more: Newton's method converges
    n_grid = linear.power_of_two(4 * n)
    spectrum = _size(linear.fft(weighted, n_grid))
    k = np.arange(n_grid)
    sigma: Array = (2.0 * np.pi / step) * ((k - n_grid * (k >= n_grid // 2)) / n_grid)
    # sums along rows of their own: over several axes their order depends on the number of trajectories
    power = spectrum**2
    high = np.ascontiguousarray(power[..., np.abs(sigma) > 0.5 * np.pi / step]).sum(axis=-1).sum(axis=0)
    total = power.sum(axis=-1).sum(axis=0)
    product = np.prod(spectrum, axis=0)
    if real:
        product[:, sigma <= 0] = -1.0
    guess = sigma[np.argmax(product, axis=1)]
    lines = np.array([_refine(part, step, guess) for part in weighted])
    if real:  # a line of amplitude A is two complex ones of A/2
        lines[:, 1] *= 2.0
    share = np.divide(high, total, out=np.zeros_like(total), where=total > 0)
    return np.swapaxes(lines, 0, 1), share


def _hanning(n: int, order: int) -> Array:
    """The Hanning window to a power on n + 1 samples, with the mean 1 over n intervals."""
    window = elementary.power(1.0 + elementary.cos(np.pi * np.linspace(-1.0, 1.0, n + 1)), order)
    return window / window[:-1].sum()


def _refine(weighted: Signal, step: float, sigma: Array) -> Array:
    r"""Newton's method for the maximum of $|A(\sigma)|^2$, $A = \sum_j w_j f_j e^{-i\sigma t_j}$, near each guess."""
    n = weighted.shape[1] - 1
    t = step * (np.arange(n + 1) - 0.5 * n)  # from the middle, where A hardly turns with sigma
    furthest = 0.5 * np.pi / (n * step)
    for _ in range(12):
        turned = linear.times(weighted, elementary.exp(-1j * sigma[:, None] * t))
        # sums and not products of matrices, whose order of summation depends on the number of rows
        value, slope, curvature = turned.sum(axis=1), -1j * (turned * t).sum(axis=1), -(turned * t**2).sum(axis=1)
        rise, bend = _dot(value, slope), _dot(slope, slope) + _dot(value, curvature)
        # not at a maximum, where the bend is negative, a short step uphill
        change = np.where(bend < 0, -rise / np.where(bend < 0, bend, 1.0), np.sign(rise) * furthest)
        sigma = sigma + np.clip(change, -furthest, furthest)
    amplitude = _size(linear.times(weighted, elementary.exp(-1j * sigma[:, None] * t)).sum(axis=1))
    return np.array([sigma, amplitude])


def _dot(a: Signal, b: Signal) -> Array:
    """The real part of the product of one with the conjugate of the other."""
    return a.real * b.real + a.imag * b.imag


def _size(a: Signal) -> Array:
    return np.sqrt(_dot(a, a))


def _texts_of(observable: Any) -> Any:
    """One or several texts as a tuple; a function as it is."""
    if callable(observable):
        return observable
    found = listed_names(observable, "observable")
    return (as_name(observable),) if found is None else tuple(found)


def _as_observable(system: Any, n: int, observable: Observable) -> Callable[[Array], tuple[Signal, bool]]:
    """The signal as a function of states, which also says whether it is real."""
    if callable(observable):
        return _from_function(observable)
    texts: Any = observable
    if len(texts) not in (1, 2) or not all(isinstance(text, str) for text in texts):
        raise ParameterError(
            f"observable: wanted one name or formula, two for real and imaginary part, or a function; got "
            f'{shown(observable)}; try "{component_names(system, n)[-1]}"'
        )
    if all(why_constant(system, text) for text in texts):
        check_that_it_varies(system, texts[0], "observable")
    names = component_names(system, n)
    parts = [component_or_formula(system, names, text, "observable", "a function of states") for text in texts]

    def values(states: Array) -> tuple[Signal, bool]:
        signal = parts[0](states).astype(np.complex128)
        if len(parts) == 2:
            signal += 1j * parts[1](states)
        return signal, len(parts) == 1

    return values


def component_or_formula(
    system: Any, names: Sequence[str], text: str, what: str, instead: str
) -> Callable[[Array], Array]:
    """One of the components of states, by name, or a formula in them as a function of states.

    Raises:
        ParameterError: it is neither, or the system has no formulas.
    """
    if text in names:
        index = names.index(text)
        return lambda states: states[..., index]
    if has_functions(system):
        return system.functions.of(text)
    raise ParameterError(f"{what}: wanted one of {', '.join(names)}; got {shown(text)}; or give {instead}")


def _from_function(function: Callable[[Array], ArrayLike]) -> Callable[[Array], tuple[Signal, bool]]:
    def values(states: Array) -> tuple[Signal, bool]:
        signal = np.asarray(function(states))
        if signal.shape != states.shape[:-1] or signal.dtype.kind not in "iufc":
            raise ShapeError(
                f"observable: a function of states of shape {states.shape} must give numbers of shape "
                f"{states.shape[:-1]}; got shape {signal.shape} of {signal.dtype}. Index the last axis?"
            )
        check_finite(signal, "observable", "choose another function")
        return signal.astype(np.complex128), signal.dtype.kind != "c"

    return values
