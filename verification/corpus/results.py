"""Small results of fixed starts, one of each kind, for hashes and figures."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from verification.corpus.catalogue import states

import liepoisson as lp

TOP = lp.Top(inertia=(2, "3/2", 1), a=(-1, "1/10", "1/5"), b=("2/5", 0, "-7/10"), epsilon="4/5")
LAGRANGE = lp.Top.twisted_lagrange(transverse=1, axial="2/3", a3=1, epsilon="1/2")
WELL = lp.catalog.system("henon-heiles")
DOUBLE_WELL = lp.System(lp.canonical(1), "dot(p, p)/2 - q1^2/2 + q1^4/4")
STARTS = states(9)
IN_THE_WELL = np.array([0.0, 0.125, 0.3125, 0.125])
TIME = np.arange(1.0, 101.0, 2.5)


@cache
def curves() -> np.ndarray:
    """Made-up exponents of 30 members that settle at about 0.1, shape (30, time)."""
    k = np.arange(30)[:, None]
    return 0.1 + (1 + k % 7 / 8) / TIME + 0.01 * np.cos(k * k * TIME / 8) / np.sqrt(TIME)


def sweep(axes: dict[str, Any]) -> Any:
    """A sweep of a few points, whose pieces go to a folder that is thrown away."""
    with tempfile.TemporaryDirectory() as folder:
        return lp.sweep(
            system="twisted-kovalevskaya", axes=axes, n_starts=4, t_end=20, store=Path(folder) / "sweep.zarr"
        )


def leaf() -> Any:
    """The leaf of the first start."""
    return lp.Leaf.through(TOP, STARTS[0])


def energy() -> float:
    """The energy of the first start."""
    return float(TOP.functions.energy(STARTS[0]))


def spectrum() -> Any:
    """All exponents, with covariant vectors."""
    return lp.lyapunov_spectrum(TOP, STARTS[:1], t_end=20, interval=1, transient=10, covariant=True)


def scan() -> Any:
    """Integrals over a grid of two parameters."""
    bracket = lp.so(3) @ lp.semidirect(2)
    family = lp.System(bracket, "(l1^2 + l2^2 + J*l3^2)/2 + a*alpha1", symbols=["J", "a"])
    return lp.integrability.scan_integrals(family, degree=1, axes={"J": [1, 2], "a": [0, 1]}, on=["C1 = 0"])


def saddle() -> Any:
    """The equilibrium between two wells."""
    return next(one for one in lp.equilibria(DOUBLE_WELL, {}) if one.linear_stability == "unstable")


RESULTS: dict[str, Callable[[], Any]] = {
    "Orbit": lambda: lp.integrate(TOP, STARTS, times=np.arange(0.0, 20.25, 0.25)),
    "Orbit, dense": lambda: lp.integrate(TOP, STARTS, times=[0.0, 1.0, 2.0], dense=True).at([0.5, 1.5]),
    "Orbit, with tangents": lambda: lp.integrate(TOP, STARTS, times=[0.0, 1.0, 2.0], tangents=states(9)[:2]),
    "Orbit, backwards": lambda: lp.integrate(TOP, STARTS, times=[0.0, -1.0, -2.0]),
    "Attitude": lambda: lp.orbits.attitude(TOP, STARTS[:1], times=[0.0, 1.0, 2.0]),
    "ChartOrbit": lambda: lp.orbits.chart_orbit(
        lp.charts.EulerChart(TOP, state=STARTS[0]), STARTS[0], times=[0.0, 0.125, 0.25]
    ),
    "Rod": lambda: lp.orbits.rod(LAGRANGE, STARTS[0], length=5.0, n_points=41),
    "FiniteTimeExponents": lambda: lp.finite_time_exponents(TOP, STARTS, times=TIME, seed=1),
    "ExponentEstimate": lambda: lp.lyapunov_exponent(TOP, STARTS, t_end=100, transient=5),
    "Spectrum": lambda: lp.lyapunov_spectrum(TOP, STARTS, t_end=20, interval=1),
    "Spectrum, covariant": lambda: spectrum().covariant,
    "SpectrumResiduals": lambda: lp.lyapunov_spectrum(TOP, STARTS, t_end=20).residuals,
    "Megno": lambda: lp.chaos.megno(TOP, STARTS, t_end=50, n_samples=64),
    "Alignment": lambda: lp.chaos.alignment(TOP, STARTS, t_end=50),
    "Verdict": lambda: lp.decide(TOP, STARTS, t_end=100),
    "Agreement": lambda: lp.chaos.agreement(lp.decide(TOP, STARTS, t_end=100)),
    "FrequencyDrift": lambda: lp.chaos.frequency_drift(TOP, STARTS, observable="l1", t_end=50, n_samples=128),
    "EnergyProfile": lambda: lp.chaos.exponents_by_energy(
        TOP, leaf=leaf(), energies=[energy(), energy() + 0.5], n_starts=3, t_end=50
    ),
    "Section": lambda: lp.section(TOP, STARTS, surface="l3", t_end=60),
    "Section, kept functions": lambda: lp.section(TOP, STARTS, surface="l3", t_end=60, keep=("l1", "dot(l, beta)")),
    "Section of the well": lambda: lp.section(WELL, IN_THE_WELL, surface="x", t_end=200),
    "FirstReturn": lambda: lp.sections.first_return(TOP, STARTS, surface="l3", t_end=30),
    "MeanCurve": lambda: lp.fits.mean_curve(TIME, curves()),
    "FiniteTimeFit": lambda: lp.fits.finite_time_fit(TIME, curves(), window=(5, 98)),
    "LogFit": lambda: lp.fits.log_fit(TIME, curves(), window=(5, 98)),
    "FitGoodness": lambda: lp.fits.fit_goodness(TIME, curves(), window=(5, 98), n_degrees=3),
    "SleepingTop": lambda: lp.phase_space.sleeping_top(LAGRANGE, l3=3, alpha3=1, beta3=0),
    "Bounds": lambda: lp.phase_space.bounds(TOP, STARTS[0]),
    "Start": lambda: lp.phase_space.find_start(TOP, guess=STARTS[0], leaf={"C1": 3, "C2": 1}),
    "Equilibrium": lambda: lp.phase_space.equilibrium(LAGRANGE, [0, 0, 1, 0, 0, 1, 0, 0, 1], along=("l3",)),
    "samples on a level": lambda: leaf().sample(8, seed=0, energy=energy()),
    "tangent basis": lambda: leaf().tangent_basis(STARTS[0]),
    "surface": lambda: lp.sections.default_surface(leaf()),
    "starts on a section": lambda: lp.sections.section_starts(leaf(), "l3", energy=energy(), n_starts=8),
    "time scale": lambda: lp.orbits.time_scale(TOP, STARTS),
    "SymmetricOrbit": lambda: lp.orbits.symmetric_periodic_orbits(WELL, {}, energy=1 / 8, n_starts=8)[0],
    "HomoclinicOrbit": lambda: lp.orbits.symmetric_homoclinic_orbits(saddle(), n_starts=8)[0],
    "Sweep": lambda: sweep({"energy": [0.0, 1.0]}),
    "Sweep of two axes": lambda: sweep({"energy": [0.0, 1.0], "epsilon": [0.0, 0.5, 1.0]}),
    "IntegralScan": scan,
    "EquilibriaEnclosure": lambda: lp.proofs.enclose_equilibria(WELL, (np.full(4, -2.0), np.full(4, 2.0))),
    "EquilibriumEnclosure": lambda: lp.proofs.prove_equilibrium(WELL, [0.0, 0.9, 0.0, 0.0]),
    "FlowEnclosure": lambda: lp.proofs.enclose_flow(WELL, (IN_THE_WELL, IN_THE_WELL + 2.0**-20), time=1.0),
    "SectionMapEnclosure": lambda: lp.proofs.enclose_section_map(WELL, IN_THE_WELL, surface="x"),
    "PeriodicOrbitEnclosure": lambda: lp.proofs.prove_periodic_orbit(
        WELL, [0.0, -0.1461901394453098704, 0.42017326094069075, 0.0], period=6.794384826845275, level={"H": "1/10"}
    ),
}
"""What is computed, by the name of its class where it has one."""


RUNS = (
    *("Orbit", "Orbit, backwards", "Attitude", "ChartOrbit", "Rod", "FiniteTimeExponents", "ExponentEstimate"),
    *("Spectrum", "Megno", "Alignment", "Verdict", "FrequencyDrift", "EnergyProfile", "Section"),
    *("Section, kept functions", "Section of the well", "FirstReturn", "Sweep", "Sweep of two axes", "IntegralScan"),
)
"""Those that `lp.plot.draw` draws."""


@cache
def result(name: str) -> Any:
    """A result, computed once."""
    return RESULTS[name]()
