"""The laboratory for Lie-Poisson (noncanonical Hamiltonian) dynamics.

Names are loaded when they are first used: importing the package costs numpy's import and no more, so that a new
process has its first ensemble result early.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from liepoisson._core import __version__

if TYPE_CHECKING:
    from liepoisson import errors, plot
    from liepoisson.dataset import load, rerun
    from liepoisson.exact.bracket import Bracket
    from liepoisson.exact.extension import Extension, leibniz, semidirect
    from liepoisson.exact.lie_algebra import LieAlgebra, so
    from liepoisson.exact.system import System
    from liepoisson.numeric.finite_time_fit import FiniteTimeFit, finite_time_fit, log_fit, mean_curve, window_scan
    from liepoisson.numeric.integrate import Orbit, integrate
    from liepoisson.numeric.lyapunov import Growth, lyapunov_exponent
    from liepoisson.numeric.methods import Taylor
    from liepoisson.numeric.sampling import sample_states
    from liepoisson.tops import Top

__all__ = [
    "Bracket",
    "Extension",
    "FiniteTimeFit",
    "Growth",
    "LieAlgebra",
    "Orbit",
    "System",
    "Taylor",
    "Top",
    "__version__",
    "errors",
    "finite_time_fit",
    "integrate",
    "leibniz",
    "load",
    "log_fit",
    "lyapunov_exponent",
    "mean_curve",
    "plot",
    "rerun",
    "sample_states",
    "semidirect",
    "so",
    "window_scan",
]

_HOME = {
    "Bracket": "exact.bracket",
    "Extension": "exact.extension",
    "FiniteTimeFit": "numeric.finite_time_fit",
    "Growth": "numeric.lyapunov",
    "LieAlgebra": "exact.lie_algebra",
    "Orbit": "numeric.integrate",
    "System": "exact.system",
    "Taylor": "numeric.methods",
    "Top": "tops",
    "finite_time_fit": "numeric.finite_time_fit",
    "integrate": "numeric.integrate",
    "leibniz": "exact.extension",
    "load": "dataset",
    "log_fit": "numeric.finite_time_fit",
    "lyapunov_exponent": "numeric.lyapunov",
    "mean_curve": "numeric.finite_time_fit",
    "rerun": "dataset",
    "sample_states": "numeric.sampling",
    "semidirect": "exact.extension",
    "so": "exact.lie_algebra",
    "window_scan": "numeric.finite_time_fit",
}
_MODULES = ("errors", "plot")


def __getattr__(name: str) -> object:
    """Loads a public name on first use (PEP 562)."""
    if name in _MODULES:
        return import_module(f"liepoisson.{name}")
    if name not in _HOME:
        raise AttributeError(f"module 'liepoisson' has no attribute {name!r}; dir(liepoisson) lists what it has")
    value = getattr(import_module(f"liepoisson.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
