"""Every public function and method that takes arrays, with a call for it."""

# ruff: noqa: PLW0108  # nothing is made before it is called

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

import liepoisson as lp

TOP = lp.Top(inertia=(2, 1.5, 1), a=(-1, 0.1, 0.2), b=(0.4, 0, -0.7), epsilon=0.8)
LAGRANGE = lp.Top.twisted_lagrange(transverse=1, axial="2/3", a3=1, epsilon="1/2")
FINE = lp.Taylor(tol=1e-11)

STATES = lp.sample_states(TOP, 3, seed=1)
STATE = STATES[0].copy()
TANGENTS = lp.sample_states(TOP, 2, seed=2)
EACH_TANGENT = lp.sample_states(TOP, 3, seed=4)
TIMES = np.array([0.0, 0.5, 1.25, 2.0])
LATER = np.array([1.0, 2.0, 4.0])
LONG = np.geomspace(1.0, 100.0, 40)
CURVES = 0.1 + 1 / np.sqrt(LONG) + np.random.default_rng(0).normal(0.2, 0.02, (40, 40)) / LONG
ORDINARY = np.array([0.3, -0.2, 0.5, 0.6, 0.48, 0.64, 0.0, 0.0, 0.0])
QUATERNION = np.array([0.5, 0.5, -0.5, 0.5])


@dataclass(frozen=True)
class Case:
    """A call with arrays by name, some of them made when they are needed."""

    call: Callable[..., Any]
    arrays: dict[str, Any]

    def copies(self) -> dict[str, Any]:
        return {name: np.array(value() if callable(value) else value) for name, value in self.arrays.items()}


@cache
def orbit() -> lp.Orbit:
    return lp.integrate(TOP, STATES, t=TIMES, dense=True)


@cache
def attitude() -> lp.Attitude:
    return lp.attitude(TOP, STATES[:1], t=TIMES, dense=True)


@cache
def covariant() -> lp.CovariantVectors:
    spectrum = lp.lyapunov_spectrum(TOP, STATES[:1], t_end=6, interval=2, transient=4, covariant=True)
    assert spectrum.covariant is not None
    return spectrum.covariant


@cache
def leaf() -> lp.Leaf:
    return lp.leaf_of(TOP, STATE)


@cache
def chart(kind: str) -> Any:
    return {
        "euler": lambda: lp.EulerChart(TOP, x=STATE),
        "quaternion": lambda: lp.QuaternionChart(TOP, x=STATE),
        "reduced": lambda: lp.ReducedLagrange(LAGRANGE, x=STATE),
        "ordinary": lambda: lp.OrdinaryLagrange(LAGRANGE, x=ORDINARY),
    }[kind]()


@cache
def inside(kind: str) -> Any:
    return np.atleast_2d(chart(kind).from_body(ORDINARY if kind == "ordinary" else STATE))


@cache
def fits() -> Any:
    return lp.finite_time_fit(LONG, CURVES, window=(5, 100)), lp.log_fit(LONG, CURVES, window=(5, 100))


@cache
def crossings() -> lp.Section:
    return lp.section(TOP, STATES, surface="l3", t_end=30)


@cache
def equilibrium() -> Any:
    """The sleeping top: l, alpha and beta along the axis."""
    return np.array([0, 0, 1.0, 0, 0, 1.0, 0, 0, 1.0])


def numbers_of(kind: str, x: Any) -> Any:
    """What a chart made from a state is."""
    made = {"euler": lp.EulerChart, "quaternion": lp.QuaternionChart, "reduced": lp.ReducedLagrange}
    leaf_constants = made[kind](LAGRANGE, x=x)
    constants = leaf_constants.chart.leaf if kind == "reduced" else leaf_constants.leaf
    return [str(value) for value in (constants.v, constants.w, constants.eta)], constants


def drawn(draw: Callable[[], Any]) -> Any:
    """The picture, as numbers."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    found = draw()
    figure = getattr(found, "figure", found)

    class Drawn:
        @property
        def picture(self) -> Any:
            canvas = FigureCanvasAgg(figure)
            canvas.draw()
            return np.asarray(canvas.buffer_rgba())

    return Drawn()


CASES: dict[str, Case] = {
    "Attitude.at": Case(lambda t: attitude().at(t), {"t": TIMES[1:]}),
    "Attitude.body": Case(lambda vectors: attitude().body(vectors), {"vectors": STATE[:3]}),
    "Attitude.space": Case(lambda vectors: attitude().space(vectors), {"vectors": STATE[:3]}),
    "CanonicalSystem.invariant_values": Case(
        lambda x: chart("euler").system.invariant_values(x), {"x": lambda: inside("euler")}
    ),
    "CanonicalSystem.vector_field": Case(
        lambda x: chart("euler").system.vector_field(x), {"x": lambda: inside("euler")}
    ),
    "CovariantVectors.distance_from_centre": Case(
        lambda vectors: covariant().distance_from_centre(vectors, 5), {"vectors": lambda: covariant().state}
    ),
    "EulerChart.__init__": Case(lambda x: numbers_of("euler", x), {"x": STATE}),
    "EulerChart.from_body": Case(lambda x: chart("euler").from_body(x), {"x": STATE[None]}),
    "EulerChart.margins": Case(lambda x: chart("euler").margins(x), {"x": STATES}),
    "EulerChart.to_body": Case(lambda z: chart("euler").to_body(z), {"z": lambda: inside("euler")}),
    "FiniteTimeFit.chi_squared": Case(
        lambda coefficients: fits()[0].chi_squared(coefficients), {"coefficients": np.array([0.1, 1.0, 0.2])}
    ),
    "FiniteTimeFit.curve": Case(lambda time: fits()[0].curve(time), {"time": LONG}),
    "LagrangeMap.integrals": Case(lambda x: lp.LagrangeMap(step=0.1).integrals(LAGRANGE, x), {"x": STATES}),
    "Leaf.contains": Case(lambda x: leaf().contains(x), {"x": STATES}),
    "Leaf.project": Case(lambda x: leaf().project(x), {"x": STATE[None] + 0.01}),
    "Leaf.project_tangent": Case(lambda x, v: leaf().project_tangent(x, v), {"x": STATES, "v": EACH_TANGENT}),
    "Leaf.residual": Case(lambda x: leaf().residual(x), {"x": STATES}),
    "Leaf.tangent_basis": Case(lambda x: leaf().tangent_basis(x), {"x": STATES}),
    "Leaf.tangent_projector": Case(lambda x: leaf().tangent_projector(x, energy=True), {"x": STATES}),
    "LeafConstants.of": Case(lambda x: numbers_of("euler", x), {"x": STATE}),
    "LogFit.curve": Case(lambda time: fits()[1].curve(time), {"time": LONG}),
    "Orbit.at": Case(lambda t: orbit().at(t), {"t": TIMES}),
    "OrdinaryLagrange.__init__": Case(lambda x: [str(lp.OrdinaryLagrange(LAGRANGE, x=x).hamiltonian)], {"x": ORDINARY}),
    "OrdinaryLagrange.from_body": Case(lambda x: chart("ordinary").from_body(x), {"x": ORDINARY[None]}),
    "OrdinaryLagrange.margins": Case(lambda x: chart("ordinary").margins(x), {"x": ORDINARY[None]}),
    "OrdinaryLagrange.to_body": Case(
        lambda z, psi: chart("ordinary").to_body(z, psi), {"z": lambda: inside("ordinary"), "psi": np.array([0.4])}
    ),
    "QuaternionChart.__init__": Case(lambda x: numbers_of("quaternion", x), {"x": STATE}),
    "QuaternionChart.from_body": Case(lambda x: chart("quaternion").from_body(x), {"x": STATE[None]}),
    "QuaternionChart.margins": Case(lambda x: chart("quaternion").margins(x), {"x": STATES}),
    "QuaternionChart.to_body": Case(lambda z: chart("quaternion").to_body(z), {"z": lambda: inside("quaternion")}),
    "ReducedLagrange.__init__": Case(lambda x: numbers_of("reduced", x), {"x": STATE}),
    "ReducedLagrange.from_body": Case(lambda x: chart("reduced").from_body(x), {"x": STATE[None]}),
    "ReducedLagrange.margins": Case(lambda x: chart("reduced").margins(x), {"x": STATES}),
    "ReducedLagrange.ordinary": Case(
        lambda x: [str(lp.ReducedLagrange.ordinary(LAGRANGE, x=x).hamiltonian)], {"x": ORDINARY}
    ),
    "ReducedLagrange.to_body": Case(
        lambda z, psi: chart("reduced").to_body(z, psi), {"z": lambda: inside("reduced"), "psi": np.array([0.4])}
    ),
    "System.invariant_values": Case(lambda x: TOP.invariant_values(x), {"x": STATES}),
    "System.vector_field": Case(lambda x: TOP.vector_field(x), {"x": STATES}),
    "Top.invariant_values": Case(lambda x: TOP.invariant_values(x), {"x": STATES}),
    "Top.vector_field": Case(lambda x: TOP.vector_field(x), {"x": STATES}),
    "alignment": Case(
        lambda x0, times: lp.alignment(TOP, x0, times=times, within="leaf"), {"x0": STATES, "times": LATER}
    ),
    "attitude": Case(
        lambda x0, t, attitude: lp.attitude(TOP, x0, t=t, attitude=attitude),
        {"x0": STATES, "t": TIMES, "attitude": QUATERNION},
    ),
    "bounds": Case(lambda x: lp.bounds(TOP, x), {"x": STATE}),
    "chart_orbit": Case(lambda x0, t: lp.chart_orbit(chart("euler"), x0, t=t), {"x0": STATE, "t": TIMES}),
    "time_scale": Case(lambda x0: lp.time_scale(TOP, x0), {"x0": STATES}),
    "decide": Case(lambda x0: lp.decide(TOP, x0, t_end=20), {"x0": STATES}),
    "exponents_by_energy": Case(
        lambda energies: lp.exponents_by_energy(TOP, leaf=leaf(), energies=energies, n=2, t_end=5),
        {"energies": np.array([1.5, 2.0])},
    ),
    "finite_time_fit": Case(
        lambda time, exponent: lp.finite_time_fit(time, exponent, window=(5, 100)), {"time": LONG, "exponent": CURVES}
    ),
    "first_return": Case(lambda x: lp.first_return(TOP, x, surface="l3", t_end=30), {"x": STATES}),
    "fit_goodness": Case(
        lambda time, exponent: lp.fit_goodness(time, exponent, window=(5, 100), n_degrees=3),
        {"time": LONG, "exponent": CURVES},
    ),
    "frequency_drift": Case(
        lambda x0: lp.frequency_drift(TOP, x0, observable="l1", t_window=20, n_samples=64), {"x0": STATES}
    ),
    "integrate": Case(
        lambda x0, t, tangents: lp.integrate(TOP, x0, t=t, tangents=tangents, dense=True),
        {"x0": STATES, "t": TIMES, "tangents": TANGENTS},
    ),
    "largest_exponent": Case(lambda x0: lp.largest_exponent(TOP, x0, t_end=100, block=1, transient=5), {"x0": STATES}),
    "leaf_of": Case(lambda x: lp.leaf_of(TOP, x), {"x": STATE}),
    "log_fit": Case(
        lambda time, exponent: lp.log_fit(time, exponent, window=(5, 100)), {"time": LONG, "exponent": CURVES}
    ),
    "lyapunov_exponent": Case(
        lambda x0, times, tangents: lp.lyapunov_exponent(TOP, x0, times=times, tangents=tangents),
        {"x0": STATES, "times": LATER, "tangents": EACH_TANGENT},
    ),
    "lyapunov_spectrum": Case(lambda x0: lp.lyapunov_spectrum(TOP, x0, t_end=10), {"x0": STATES}),
    "mean_curve": Case(lambda time, exponent: lp.mean_curve(time, exponent), {"time": LONG, "exponent": CURVES}),
    "megno": Case(lambda x0: lp.megno(TOP, x0, t_end=20, n_samples=64), {"x0": STATES}),
    "relative_equilibrium": Case(
        lambda x_guess: lp.relative_equilibrium(LAGRANGE, x_guess, along=("l3",)), {"x_guess": equilibrium()}
    ),
    "rod": Case(
        lambda x0, s, attitude, origin: lp.rod(LAGRANGE, x0, s=s, attitude=attitude, origin=origin),
        {"x0": STATES, "s": TIMES, "attitude": QUATERNION, "origin": np.array([1.0, 2.0, 3.0])},
    ),
    "section": Case(lambda x0: lp.section(TOP, x0, surface="l3", t_end=20), {"x0": STATES}),
    "section_state": Case(
        lambda guess: lp.section_state(leaf(), "l3", float(TOP.functions.energy(STATE)) + 0.1, {}, guess=guess),
        {"guess": STATE},
    ),
    "stability": Case(lambda x: lp.stability(LAGRANGE, x, along=("l3",)), {"x": equilibrium()}),
    "window_scan": Case(lambda time, exponent: lp.window_scan(time, exponent), {"time": LONG, "exponent": CURVES}),
    "plot.exponent_distribution": Case(
        lambda exponents: drawn(lambda: lp.plot.exponent_distribution(exponents)), {"exponents": CURVES[:, -1]}
    ),
    "plot.orbit": Case(
        lambda H: drawn(lambda: lp.plot.orbit(orbit(), invariants={"H": H})), {"H": np.array([1.0, 1.1, 1.3, 1.2])}
    ),
    "plot.section": Case(
        lambda x, y: drawn(lambda: lp.plot.section(crossings(), x, y)),
        {"x": lambda: crossings().state[:, 0], "y": lambda: crossings().state[:, 4]},
    ),
}
