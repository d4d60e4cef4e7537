"""The command `liepoisson lyapunov`: largest exponents from random starts."""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from liepoisson.cli.methods import named_method
from liepoisson.cli.progress import progress_bar
from liepoisson.cli.systems import SET_HELP, SYSTEM_HELP, read_file, with_settings
from liepoisson.errors import OutputError, ParameterError

if TYPE_CHECKING:
    from collections.abc import Callable

    from liepoisson.exact.system import System
    from liepoisson.exact.system_file import SystemFile
    from liepoisson.numeric.estimates import FloatArray
    from liepoisson.numeric.lyapunov import Growth
    from liepoisson.numeric.methods import Method

INTERRUPTED = 130
OUT_HELP = "Also write the curves to this file; a folder that is missing is made."
_QUANTILES = (0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0)


def lyapunov(
    system: Annotated[str, typer.Argument(help=SYSTEM_HELP, metavar="SYSTEM")],
    *,
    n: Annotated[int, typer.Option("--n", help="Random starts.")] = 64,
    t_end: Annotated[float, typer.Option(help="Time of each run, in units of the system's own time.")] = 1000.0,
    seed: Annotated[int, typer.Option(help="Seed of starts and tangent vectors.")] = 0,
    ensemble: Annotated[
        str, typer.Option(help="How starts are drawn: unit-vectors, cube or gaussian.")
    ] = "unit-vectors",
    method: Annotated[str, typer.Option(help="taylor, runge-kutta, splitting, gauss or lagrange-map.")] = "taylor",
    tol: Annotated[
        float | None, typer.Option(help="Tolerance of taylor and runge-kutta.  [default: 1e-13, 1e-8]")
    ] = None,
    step: Annotated[float | None, typer.Option(help="Step of the methods with equal steps.  [default: 0.1]")] = None,
    order: Annotated[int | None, typer.Option(help="Order of the method, where it has several.")] = None,
    precision: Annotated[str, typer.Option(help="double; mixed (taylor); single (runge-kutta, splitting).")] = "double",
    time_limit: Annotated[float, typer.Option(help="Seconds that the runs may take, all together.")] = 3600.0,
    threads: Annotated[int | None, typer.Option(help="Worker threads.  [default: all cores]")] = None,
    out: Annotated[str | None, typer.Option(metavar="FILE.nc", help=OUT_HELP)] = None,
    settings: Annotated[list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help=SET_HELP)] = None,
) -> None:
    """Print largest Lyapunov exponents of random starts.

    Finite-time exponents: their mean with its standard error, quantiles, and how the runs ended.
    """
    if n < 1:
        raise ParameterError(f"--n must be at least 1; got {n}. Try 64.")
    if out is not None and not out.strip():
        raise ParameterError(f"--out must name a file; got {out!r}. Write for example --out exponents.nc.")
    if out is not None and Path(out).is_dir():  # said before the runs, not after them
        raise OutputError(f"--out must be a file; {out} is a folder. Write for example --out {out}/exponents.nc.")
    file = with_settings(read_file(system), settings or ())
    _check_values(file)
    chosen = file.system()
    how = named_method(method, tol=tol, step=step, order=order, precision=precision)
    try:
        with progress_bar() as bar:
            listen = None if bar is None else (lambda done: bar("integrating", done * n * t_end, n * t_end))
            growth = _growth(
                chosen,
                n,
                t_end,
                seed=seed,
                ensemble=ensemble,
                method=how,
                threads=threads,
                time_limit=time_limit,
                progress=listen,
            )
    except KeyboardInterrupt:
        print("interrupted; nothing was written.", file=sys.stderr)
        raise typer.Exit(INTERRUPTED) from None
    if out is not None:
        growth.save(Path(out))
    print("\n".join(summary(growth, ensemble)))


def summary(growth: Growth, ensemble: str) -> list[str]:
    """The lines that the command prints."""
    import numpy as np

    n, t_end = len(growth.outcome), growth.time[-1]
    finished = growth.exponent[growth.outcome == "finished", -1]
    method = f"{growth.method}, order {growth.order}, {growth.field.kind} kernel"
    lines = [
        f"{growth.system}: {n} random starts ({ensemble}, seed {growth.seed}) to t = {t_end:g}",
        f"{method} ({growth.kernel})",
        "outcomes: " + ", ".join(f"{name} {np.sum(growth.outcome == name)}" for name in np.unique(growth.outcome)),
    ]
    if not finished.size:
        return [*lines, "no run finished: there is no exponent to tell"]
    lines.append(f"largest exponent at t = {t_end:g}, in inverse time, of the {finished.size} finished runs:")
    lines.append(f"  mean {_mean(finished)}")
    quantiles = zip(_QUANTILES, np.quantile(finished, _QUANTILES), strict=True)
    lines += [f"  {_quantile_name(q):<7} {value:.6f}" for q, value in quantiles]
    lines += [
        "A mean over random starts mixes leaves and energies, chaotic and regular orbits: it is not the exponent of",
        "one orbit. Finite-time values are biased upwards: a regular orbit has one of about ln(t)/t"
        + (f" = {math.log(t_end) / t_end:.2g}." if t_end > 1 else "."),
    ]
    return lines


def _growth(
    system: System,
    n: int,
    t_end: float,
    *,
    seed: int,
    ensemble: str,
    method: Method,
    threads: int | None,
    time_limit: float,
    progress: Callable[[float], object] | None,
) -> Growth:
    from liepoisson.numeric.lyapunov import lyapunov_exponent
    from liepoisson.numeric.sampling import sample_states

    x0 = sample_states(system, n, seed=seed, ensemble=ensemble)
    return lyapunov_exponent(
        system, x0, t_end=t_end, seed=seed, method=method, threads=threads, time_limit=time_limit, progress=progress
    )


def _check_values(file: SystemFile) -> None:
    """Refuse symbols at once, all of them together."""
    if file.symbols:
        from liepoisson.exact.formula.scope import read_declaration

        name, shape = read_declaration(file.symbols[0])
        value = ",".join("1" * shape[0]) if shape else "1"
        raise ParameterError(
            f"{file.name} must have numbers for all parameters; {', '.join(file.symbols)} have none. "
            f"Give them, for example --set {name}={value}."
        )


def _mean(exponents: FloatArray) -> str:
    if exponents.size < 2:
        return f"{exponents.mean():.6f} (one run: no standard error)"
    error = exponents.std(ddof=1) / math.sqrt(exponents.size)
    return f"{exponents.mean():.6f}, standard error over starts {error:.2g}"


def _quantile_name(q: float) -> str:
    return {0.0: "least", 0.5: "median", 1.0: "largest"}.get(q, f"{100 * q:g}%")
