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
    from liepoisson.exact.canonical_bracket import canonical
    from liepoisson.exact.canonical_system import CanonicalSystem
    from liepoisson.exact.charts.euler_chart import EulerChart
    from liepoisson.exact.charts.lagrange_reduction import ReducedLagrange
    from liepoisson.exact.charts.leaf_constants import LeafConstants
    from liepoisson.exact.charts.ordinary_lagrange import OrdinaryLagrange
    from liepoisson.exact.charts.quaternion_chart import QuaternionChart
    from liepoisson.exact.classification import Classification, classify
    from liepoisson.exact.extension import Extension
    from liepoisson.exact.extensions import crmhd, leibniz, semidirect, trivial
    from liepoisson.exact.lie.representations import semidirect_sum
    from liepoisson.exact.lie_algebra import LieAlgebra
    from liepoisson.exact.lie_algebras import abelian, affine, gl, heisenberg, se, sine, sl, so, su
    from liepoisson.exact.normal_forms import normal_forms
    from liepoisson.exact.system import System
    from liepoisson.exact.system_file import SystemFile, load_system_file
    from liepoisson.field import PiecesField, QuadraticField, TapeField, TopField
    from liepoisson.numeric.alignment import Alignment, alignment
    from liepoisson.numeric.covariant_vectors import CovariantVectors
    from liepoisson.numeric.estimates import LogFit, MeanCurve
    from liepoisson.numeric.exponent_estimate import ExponentEstimate, largest_exponent
    from liepoisson.numeric.exponents_by_energy import EnergyProfile, exponents_by_energy
    from liepoisson.numeric.finite_time_fit import FiniteTimeFit, finite_time_fit, log_fit, mean_curve, window_scan
    from liepoisson.numeric.fit_goodness import FitGoodness, fit_goodness
    from liepoisson.numeric.frequencies import FrequencyDrift, frequency_drift
    from liepoisson.numeric.integrate import Orbit, integrate
    from liepoisson.numeric.lyapunov import Growth, lyapunov_exponent
    from liepoisson.numeric.megno import Megno, megno
    from liepoisson.numeric.methods import Gauss, LagrangeMap, RungeKutta, Splitting, Taylor
    from liepoisson.numeric.sampling import sample_states
    from liepoisson.numeric.section import FirstReturn, Section, first_return, section
    from liepoisson.numeric.spectrum import Spectrum, lyapunov_spectrum
    from liepoisson.numeric.structural_zeros import PoissonStructure
    from liepoisson.numeric.time_scale import time_scale
    from liepoisson.numeric.verdict import Agreement, Rule, Verdict, agreement, decide
    from liepoisson.phase_space.bounds import Bounds, bounds
    from liepoisson.phase_space.chart_orbit import ChartOrbit, chart_orbit
    from liepoisson.phase_space.equilibria import equilibria, relative_equilibrium
    from liepoisson.phase_space.equilibrium_list import Equilibria
    from liepoisson.phase_space.frames import Attitude, attitude
    from liepoisson.phase_space.leaf import Leaf, leaf_of
    from liepoisson.phase_space.rod import Rod, rod
    from liepoisson.phase_space.sleeping_top import SleepingTop, sleeping_top
    from liepoisson.phase_space.stability import Equilibrium, stability
    from liepoisson.phase_space.surfaces import good_surface, section_starts, section_state
    from liepoisson.sweeps.result import Sweep
    from liepoisson.sweeps.run import sweep
    from liepoisson.sweeps.spec import Axis, Refinement, Starts, SweepSpec
    from liepoisson.tops import Top

__all__ = [
    "Agreement",
    "Alignment",
    "Attitude",
    "Axis",
    "Bounds",
    "Bracket",
    "CanonicalSystem",
    "ChartOrbit",
    "Classification",
    "CovariantVectors",
    "EnergyProfile",
    "Equilibria",
    "Equilibrium",
    "EulerChart",
    "ExponentEstimate",
    "Extension",
    "FiniteTimeFit",
    "FirstReturn",
    "FitGoodness",
    "FrequencyDrift",
    "Gauss",
    "Growth",
    "LagrangeMap",
    "Leaf",
    "LeafConstants",
    "LieAlgebra",
    "LogFit",
    "MeanCurve",
    "Megno",
    "Orbit",
    "OrdinaryLagrange",
    "PiecesField",
    "PoissonStructure",
    "QuadraticField",
    "QuaternionChart",
    "ReducedLagrange",
    "Refinement",
    "Rod",
    "Rule",
    "RungeKutta",
    "Section",
    "SleepingTop",
    "Spectrum",
    "Splitting",
    "Starts",
    "Sweep",
    "SweepSpec",
    "System",
    "SystemFile",
    "TapeField",
    "Taylor",
    "Top",
    "TopField",
    "Verdict",
    "__version__",
    "abelian",
    "affine",
    "agreement",
    "alignment",
    "attitude",
    "bounds",
    "canonical",
    "catalog",
    "chart_orbit",
    "classify",
    "crmhd",
    "decide",
    "equilibria",
    "errors",
    "exponents_by_energy",
    "finite_time_fit",
    "first_return",
    "fit_goodness",
    "frequency_drift",
    "gl",
    "good_surface",
    "heisenberg",
    "integrate",
    "largest_exponent",
    "leaf_of",
    "leibniz",
    "load",
    "load_system_file",
    "log_fit",
    "lyapunov_exponent",
    "lyapunov_spectrum",
    "mean_curve",
    "megno",
    "normal_forms",
    "plot",
    "relative_equilibrium",
    "rerun",
    "rod",
    "sample_states",
    "se",
    "section",
    "section_starts",
    "section_state",
    "semidirect",
    "semidirect_sum",
    "sine",
    "sl",
    "sleeping_top",
    "so",
    "stability",
    "su",
    "sweep",
    "time_scale",
    "trivial",
    "window_scan",
]

_HOME = {
    "Agreement": "numeric.verdict",
    "Alignment": "numeric.alignment",
    "Attitude": "phase_space.frames",
    "Axis": "sweeps.spec",
    "Bounds": "phase_space.bounds",
    "Bracket": "exact.bracket",
    "CanonicalSystem": "exact.canonical_system",
    "ChartOrbit": "phase_space.chart_orbit",
    "Classification": "exact.classification",
    "CovariantVectors": "numeric.covariant_vectors",
    "EnergyProfile": "numeric.exponents_by_energy",
    "Equilibria": "phase_space.equilibrium_list",
    "Equilibrium": "phase_space.stability",
    "EulerChart": "exact.charts.euler_chart",
    "ExponentEstimate": "numeric.exponent_estimate",
    "Extension": "exact.extension",
    "FiniteTimeFit": "numeric.finite_time_fit",
    "FirstReturn": "numeric.section",
    "FitGoodness": "numeric.fit_goodness",
    "FrequencyDrift": "numeric.frequencies",
    "Gauss": "numeric.methods",
    "Growth": "numeric.lyapunov",
    "LagrangeMap": "numeric.methods",
    "Leaf": "phase_space.leaf",
    "LeafConstants": "exact.charts.leaf_constants",
    "LieAlgebra": "exact.lie_algebra",
    "LogFit": "numeric.estimates",
    "MeanCurve": "numeric.estimates",
    "Megno": "numeric.megno",
    "Orbit": "numeric.integrate",
    "OrdinaryLagrange": "exact.charts.ordinary_lagrange",
    "PiecesField": "field",
    "PoissonStructure": "numeric.structural_zeros",
    "QuadraticField": "field",
    "QuaternionChart": "exact.charts.quaternion_chart",
    "ReducedLagrange": "exact.charts.lagrange_reduction",
    "Refinement": "sweeps.spec",
    "Rod": "phase_space.rod",
    "Rule": "numeric.verdict",
    "RungeKutta": "numeric.methods",
    "Section": "numeric.section",
    "SleepingTop": "phase_space.sleeping_top",
    "Spectrum": "numeric.spectrum",
    "Splitting": "numeric.methods",
    "Starts": "sweeps.spec",
    "Sweep": "sweeps.result",
    "SweepSpec": "sweeps.spec",
    "System": "exact.system",
    "SystemFile": "exact.system_file",
    "TapeField": "field",
    "Taylor": "numeric.methods",
    "Top": "tops",
    "TopField": "field",
    "Verdict": "numeric.verdict",
    "abelian": "exact.lie_algebras",
    "affine": "exact.lie_algebras",
    "agreement": "numeric.verdict",
    "alignment": "numeric.alignment",
    "attitude": "phase_space.frames",
    "bounds": "phase_space.bounds",
    "canonical": "exact.canonical_bracket",
    "chart_orbit": "phase_space.chart_orbit",
    "classify": "exact.classification",
    "crmhd": "exact.extensions",
    "decide": "numeric.verdict",
    "equilibria": "phase_space.equilibria",
    "exponents_by_energy": "numeric.exponents_by_energy",
    "finite_time_fit": "numeric.finite_time_fit",
    "first_return": "numeric.section",
    "fit_goodness": "numeric.fit_goodness",
    "frequency_drift": "numeric.frequencies",
    "gl": "exact.lie_algebras",
    "good_surface": "phase_space.surfaces",
    "heisenberg": "exact.lie_algebras",
    "integrate": "numeric.integrate",
    "largest_exponent": "numeric.exponent_estimate",
    "leaf_of": "phase_space.leaf",
    "leibniz": "exact.extensions",
    "load": "dataset",
    "load_system_file": "exact.system_file",
    "log_fit": "numeric.finite_time_fit",
    "lyapunov_exponent": "numeric.lyapunov",
    "lyapunov_spectrum": "numeric.spectrum",
    "mean_curve": "numeric.finite_time_fit",
    "megno": "numeric.megno",
    "normal_forms": "exact.normal_forms",
    "relative_equilibrium": "phase_space.equilibria",
    "rerun": "dataset",
    "rod": "phase_space.rod",
    "sample_states": "numeric.sampling",
    "se": "exact.lie_algebras",
    "section": "numeric.section",
    "section_starts": "phase_space.surfaces",
    "section_state": "phase_space.surfaces",
    "semidirect": "exact.extensions",
    "semidirect_sum": "exact.lie.representations",
    "sine": "exact.lie_algebras",
    "sl": "exact.lie_algebras",
    "sleeping_top": "phase_space.sleeping_top",
    "so": "exact.lie_algebras",
    "stability": "phase_space.stability",
    "su": "exact.lie_algebras",
    "sweep": "sweeps.run",
    "time_scale": "numeric.time_scale",
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
