"""Hashes of numbers, bit by bit: what a seed decides, runs of ten systems, and each kind of result.

A run is hashed as it is, and as its Dataset; what it prints stands beside it.
"""

from __future__ import annotations

import runpy
from collections.abc import Callable
from typing import Any

import numpy as np
from verification.corpus.answer import ROOT, answer, answers, digest, plain
from verification.corpus.catalogue import states
from verification.corpus.results import LAGRANGE, RESULTS, STARTS, result

import liepoisson as lp

PORTABLE = ROOT / "tests" / "portable" / "portable_cases.py"
"""What the tests hash, on each processor alike."""
SYSTEMS = (
    *("kovalevskaya", "twisted-kovalevskaya", "clebsch", "manakov-so4", "rattleback", "three-wave"),
    *("henon-heiles", "toda", "double-pendulum", "zeitlin-3", "goryachev", "compressible-reduced-mhd"),
)
METHODS: dict[str, Callable[[], Any]] = {
    "Taylor": lp.Taylor,
    "Taylor, mixed": lambda: lp.Taylor(tol=1e-9, precision="mixed"),
    "Runge-Kutta": lp.RungeKutta,
    "Runge-Kutta, equal steps": lambda: lp.RungeKutta(step=1 / 32),
    "Gauss": lambda: lp.Gauss(step=1 / 32),
    "splitting": lambda: lp.Splitting(order=6, step=1 / 32),
}
NOT_COMPARED = {"seconds", "kernel", "version", "created", "reports"}
"""Fields and attributes that tell of the machine and the day."""


def record() -> dict[str, Any]:
    """All hashes."""
    return {
        "portable": answer(portable),
        "systems": {name: answer(lambda name=name: of_system(name)) for name in SYSTEMS},
        "Lagrange's map": answer(
            lambda: run(lp.integrate(LAGRANGE, STARTS, times=[0, 2], method=lp.methods.LagrangeMap(0.125)))
        ),
        "results": {name: answer(lambda name=name: described(result(name))) for name in RESULTS},
    }


def portable() -> dict[str, Any]:
    """The cases of the tests."""
    cases = runpy.run_path(str(PORTABLE))["CASES"]
    return {name: answer(lambda make=make: digest(make())) for name, make in cases.items()}


def of_system(name: str) -> dict[str, Any]:
    """Orbits by each method, exponents and a section, from starts of quarters."""
    system = lp.catalog.system(name)
    starts = states(len(system.component_names)) / 2
    times, first = np.arange(0.0, 4.25, 0.25), system.component_names[0]
    return {
        **{
            f"orbit by {method}": answer(
                lambda make=make: run(lp.integrate(system, starts, times=times, method=make()))
            )
            for method, make in METHODS.items()
        },
        **answers(
            {
                "exponents": lambda: run(lp.finite_time_exponents(system, starts, times=[1.0, 2.0, 4.0], seed=2)),
                "largest exponent": lambda: run(lp.lyapunov_exponent(system, starts, t_end=20, seed=2)),
                "spectrum": lambda: run(lp.lyapunov_spectrum(system, starts[:1], t_end=4, interval=1, seed=2)),
                "section": lambda: run(lp.section(system, starts, surface=first, t_end=20)),
                "default surface": lambda: lp.sections.default_surface(lp.Leaf.through(system, starts[0])),
            }
        ),
    }


def run(result: Any) -> dict[str, Any]:
    """The variables of a result's Dataset, and how the runs ended."""
    data = result.dataset
    variables = {str(name): of_array(data[name].to_numpy()) for name in sorted([*data.variables], key=str)}
    return {"outcome": plain(getattr(result, "outcome", None)), **variables}


def of_array(values: np.ndarray) -> Any:
    """The hash of numbers, or the texts."""
    return digest(values) if values.dtype.kind in "biufc" else plain(values)


def described(result: Any) -> Any:
    """A result: its fields, what it prints, its Dataset with the names that it has."""
    fields = plain(result)
    if isinstance(fields, dict):
        fields = {name: value for name, value in fields.items() if name not in NOT_COMPARED}
    found: dict[str, Any] = {"fields": fields, "printed": str(result).replace("\n", " | ")}
    if hasattr(result, "dataset"):
        data = result.dataset
        attributes = {name: plain(value) for name, value in data.attrs.items() if name not in NOT_COMPARED}
        units = {str(name): plain(dict(data[name].attrs)) for name in data.variables}
        found |= {"variables": run(result), "attributes": attributes, "labels": units, "sizes": dict(data.sizes)}
    return plain(found)
