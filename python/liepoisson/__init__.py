"""The laboratory for Lie-Poisson (noncanonical Hamiltonian) dynamics.

Names are loaded when they are first used: importing the package costs numpy's import and no more, so that a new
process has its first ensemble result early.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from liepoisson._core import __version__

if TYPE_CHECKING:
    from liepoisson import catalog, errors, plot
    from liepoisson.dataset import load, rerun
    from liepoisson.exact.bracket import Bracket
    from liepoisson.exact.classification import classify
    from liepoisson.exact.extension import Extension
    from liepoisson.exact.extensions import crmhd, leibniz, semidirect, trivial
    from liepoisson.exact.lie.representations import semidirect_sum
    from liepoisson.exact.lie_algebra import LieAlgebra
    from liepoisson.exact.lie_algebras import abelian, affine, gl, heisenberg, se, sine, sl, so, su
    from liepoisson.exact.normal_forms import normal_forms
    from liepoisson.exact.system import System
    from liepoisson.exact.system_file import SystemFile, load_system_file
    from liepoisson.field import PiecesField, QuadraticField, TapeField, TopField
    from liepoisson.numeric.finite_time_fit import FiniteTimeFit, finite_time_fit, log_fit, mean_curve, window_scan
    from liepoisson.numeric.integrate import Orbit, integrate
    from liepoisson.numeric.lyapunov import Growth, lyapunov_exponent
    from liepoisson.numeric.methods import Gauss, LagrangeMap, RungeKutta, Splitting, Taylor
    from liepoisson.numeric.sampling import sample_states
    from liepoisson.tops import Top

__all__ = [
    "Bracket",
    "Extension",
    "FiniteTimeFit",
    "Gauss",
    "Growth",
    "LagrangeMap",
    "LieAlgebra",
    "Orbit",
    "PiecesField",
    "QuadraticField",
    "RungeKutta",
    "Splitting",
    "System",
    "SystemFile",
    "TapeField",
    "Taylor",
    "Top",
    "TopField",
    "__version__",
    "abelian",
    "affine",
    "catalog",
    "classify",
    "crmhd",
    "errors",
    "finite_time_fit",
    "gl",
    "heisenberg",
    "integrate",
    "leibniz",
    "load",
    "load_system_file",
    "log_fit",
    "lyapunov_exponent",
    "mean_curve",
    "normal_forms",
    "plot",
    "rerun",
    "sample_states",
    "se",
    "semidirect",
    "semidirect_sum",
    "sine",
    "sl",
    "so",
    "su",
    "trivial",
    "window_scan",
]

_HOME = {
    "Bracket": "exact.bracket",
    "Extension": "exact.extension",
    "FiniteTimeFit": "numeric.finite_time_fit",
    "Gauss": "numeric.methods",
    "Growth": "numeric.lyapunov",
    "LagrangeMap": "numeric.methods",
    "LieAlgebra": "exact.lie_algebra",
    "Orbit": "numeric.integrate",
    "PiecesField": "field",
    "QuadraticField": "field",
    "RungeKutta": "numeric.methods",
    "Splitting": "numeric.methods",
    "System": "exact.system",
    "SystemFile": "exact.system_file",
    "TapeField": "field",
    "Taylor": "numeric.methods",
    "Top": "tops",
    "TopField": "field",
    "abelian": "exact.lie_algebras",
    "affine": "exact.lie_algebras",
    "classify": "exact.classification",
    "crmhd": "exact.extensions",
    "finite_time_fit": "numeric.finite_time_fit",
    "gl": "exact.lie_algebras",
    "heisenberg": "exact.lie_algebras",
    "integrate": "numeric.integrate",
    "leibniz": "exact.extensions",
    "load": "dataset",
    "load_system_file": "exact.system_file",
    "log_fit": "numeric.finite_time_fit",
    "lyapunov_exponent": "numeric.lyapunov",
    "mean_curve": "numeric.finite_time_fit",
    "normal_forms": "exact.normal_forms",
    "rerun": "dataset",
    "sample_states": "numeric.sampling",
    "se": "exact.lie_algebras",
    "semidirect": "exact.extensions",
    "semidirect_sum": "exact.lie.representations",
    "sine": "exact.lie_algebras",
    "sl": "exact.lie_algebras",
    "so": "exact.lie_algebras",
    "su": "exact.lie_algebras",
    "trivial": "exact.extensions",
    "window_scan": "numeric.finite_time_fit",
}
_MODULES = ("catalog", "errors", "plot")


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
