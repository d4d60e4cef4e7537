"""Every public function and method that takes arrays, with a call for it."""

# ruff: noqa: PLW0108  # nothing is made before it is called

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

import liepoisson as lp

TOP = lp.Top(inertia=(2, 1.5, 1), a=(-1, 0.1, 0.2), b=(0.4, 0, -0.7), epsilon=0.8)
PARTIAL = lp.System(lp.so(3) @ lp.leibniz(3), "dot(l, l)/2 + log(10 + alpha1)", name="with a logarithm")
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
HENON = lp.catalog.system("henon-heiles")
IN_THE_WELL = np.array([0.0, 0.1, 0.3, 0.1])
ORDINARY = np.array([0.3, -0.2, 0.5, 0.6, 0.48, 0.64, 0.0, 0.0, 0.0])
QUATERNION = np.array([0.5, 0.5, -0.5, 0.5])


def ensemble_fits(time, exponent):
    """The fits of an ensemble that is taken in at once."""
    reduction = lp.fits.EnsembleReduction(time, windows=[(5, 100)])
    reduction.add(exponent)
    return reduction.finite_time_fits(), reduction.mean_curve()


@dataclass(frozen=True)
class Case:
    """A call with arrays by name, some of them made when they are needed."""

    call: Callable[..., Any]
    arrays: dict[str, Any]

    def copies(self) -> dict[str, Any]:
        return {name: np.array(value() if callable(value) else value) for name, value in self.arrays.items()}


def back():
    return lp.sections.return_map(HENON, "x", t_end=100)


@cache
def orbit() -> lp.results.Orbit:
    return lp.integrate(TOP, STATES, times=TIMES, dense=True)


def box() -> lp.proofs.Box:
    return lp.proofs.Box.around(STATE, 0.01)


@cache
def attitude() -> lp.results.Attitude:
    return lp.orbits.attitude(TOP, STATES[:1], times=TIMES, dense=True)


@cache
def manifold() -> lp.results.InvariantManifold:
    return lp.orbits.invariant_manifold(lp.phase_space.equilibrium(PENDULUM, [np.pi, 0]))


@cache
def covariant() -> lp.results.CovariantVectors:
    spectrum = lp.lyapunov_spectrum(TOP, STATES[:1], t_end=6, interval=2, transient=4, covariant=True)
    assert spectrum.covariant is not None
    return spectrum.covariant


@cache
def leaf() -> lp.Leaf:
    return lp.Leaf.through(TOP, STATE)


@cache
def chart(kind: str) -> Any:
    return {
        "euler": lambda: lp.charts.EulerChart(TOP, state=STATE),
        "quaternion": lambda: lp.charts.QuaternionChart(TOP, state=STATE),
        "reduced": lambda: lp.charts.ReducedLagrange(LAGRANGE, state=STATE),
        "ordinary": lambda: lp.charts.OrdinaryLagrange(LAGRANGE, state=ORDINARY),
    }[kind]()


@cache
def inside(kind: str) -> Any:
    return np.atleast_2d(chart(kind).from_body(ORDINARY if kind == "ordinary" else STATE))


@cache
def fits() -> Any:
    return lp.fits.finite_time_fit(LONG, CURVES, window=(5, 100)), lp.fits.log_fit(LONG, CURVES, window=(5, 100))


@cache
def crossings() -> lp.results.Section:
    return lp.section(TOP, STATES, surface="l3", t_end=30)


PENDULUM = lp.System(lp.canonical(1), "p1^2/2 - cos(q1)", name="pendulum")
SLEEPING = lp.System(lp.so(3) @ lp.semidirect(2), "dot(l, l)/2 + alpha3", name="sleeping top")


@cache
def equilibrium() -> Any:
    """The sleeping top: l, alpha and beta along the axis."""
    return np.array([0, 0, 1.0, 0, 0, 1.0, 0, 0, 1.0])


def numbers_of(kind: str, x: Any) -> Any:
    """What a chart made from a state is."""
    made = {
        "euler": lp.charts.EulerChart,
        "quaternion": lp.charts.QuaternionChart,
        "reduced": lp.charts.ReducedLagrange,
    }
    leaf_constants = made[kind](LAGRANGE, state=x)
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


@cache
def lagrange_diagram() -> lp.results.LagrangeDiagram:
    return lp.tori.lagrange_diagram(lp.Leaf(lp.Top.twisted_lagrange(), {"C1": 0.5, "C2": 0.2, "C3": 1}))


@cache
def momentum() -> lp.results.MomentumMap:
    return lp.tori.momentum_map(SPHERICAL)


SPHERICAL = lp.catalog.system("spherical-pendulum")
ON_SPHERE = np.array([0.3, 0.8, 0.2, 0.8, 0, 0.6])
TORUS = np.array([3, 0.5, 0.2])

CASES: dict[str, Case] = {
    "Attitude.at": Case(lambda times: attitude().at(times), {"times": TIMES[1:]}),
    "Attitude.body": Case(lambda vectors: attitude().body(vectors), {"vectors": STATE[:3]}),
    "Attitude.space": Case(lambda vectors: attitude().space(vectors), {"vectors": STATE[:3]}),
    "Box.around": Case(
        lambda center, radius: lp.proofs.Box.around(center, radius), {"center": STATE, "radius": np.full(9, 0.01)}
    ),
    "Box.contains": Case(lambda values: str(box().contains(values)), {"values": STATE}),
    "Box.overlaps": Case(lambda other: str(box().overlaps(other)), {"other": STATE}),
    "CanonicalSystem.invariant_values": Case(
        lambda x: chart("euler").system.invariant_values(x), {"x": lambda: inside("euler")}
    ),
    "CanonicalSystem.right_hand_side": Case(
        lambda state: chart("euler").system.right_hand_side(0.0, state), {"state": lambda: inside("euler")[0]}
    ),
    "CanonicalSystem.without_value": Case(
        lambda x: chart("euler").system.without_value(x), {"x": lambda: inside("euler")}
    ),
    "CanonicalSystem.vector_field": Case(
        lambda x: chart("euler").system.vector_field(x), {"x": lambda: inside("euler")}
    ),
    "CovariantVectors.distance_from_centre": Case(
        lambda vectors: covariant().distance_from_centre(vectors, 5), {"vectors": lambda: covariant().state}
    ),
    "EulerChart.__init__": Case(lambda state: numbers_of("euler", state), {"state": STATE}),
    "EulerChart.from_body": Case(lambda states: chart("euler").from_body(states), {"states": STATE[None]}),
    "EulerChart.margins": Case(lambda states: chart("euler").margins(states), {"states": STATES}),
    "EulerChart.to_body": Case(lambda z: chart("euler").to_body(z), {"z": lambda: inside("euler")}),
    "FiniteTimeFit.chi_squared": Case(
        lambda coefficients: fits()[0].chi_squared(coefficients), {"coefficients": np.array([0.1, 1.0, 0.2])}
    ),
    "FiniteTimeFit.curve": Case(lambda time: fits()[0].curve(time), {"time": LONG}),
    "LagrangeMap.integrals": Case(
        lambda states: lp.methods.LagrangeMap(step=0.1).integrals(LAGRANGE, states), {"states": STATES}
    ),
    "ReturnMap.orbit": Case(lambda states: back().orbit(states, 2), {"states": IN_THE_WELL}),
    "ReturnMap.derivative": Case(lambda states: back().derivative(states, ["y", "p_y"]), {"states": IN_THE_WELL}),
    "ReturnMap.density": Case(lambda states: back().density(states, ["y", "p_y"]), {"states": IN_THE_WELL}),
    "ReturnMap.exponents": Case(lambda states: back().exponents(states, 4), {"states": IN_THE_WELL}),
    "Leaf.contains": Case(lambda states: leaf().contains(states), {"states": STATES}),
    "Leaf.project": Case(lambda states: leaf().project(states), {"states": STATE[None] + 0.01}),
    "Leaf.project_tangent": Case(
        lambda states, vectors: leaf().project_tangent(states, vectors), {"states": STATES, "vectors": EACH_TANGENT}
    ),
    "Leaf.residual": Case(lambda states: leaf().residual(states), {"states": STATES}),
    "Leaf.tangent_basis": Case(lambda states: leaf().tangent_basis(states), {"states": STATES}),
    "Leaf.tangent_projector": Case(lambda states: leaf().tangent_projector(states, energy=True), {"states": STATES}),
    "LeafConstants.of": Case(lambda state: numbers_of("euler", state), {"state": STATE}),
    "LogFit.curve": Case(lambda time: fits()[1].curve(time), {"time": LONG}),
    "Orbit.go_on": Case(lambda times: orbit().go_on(times=times), {"times": orbit().time[-1] + LATER}),
    "InvariantManifold.at": Case(
        lambda directions, phases: manifold().at(directions, phases),
        {"directions": np.ones((2, 1)), "phases": np.array([0.25, 0.5])},
    ),
    "Orbit.at": Case(lambda times: orbit().at(times), {"times": TIMES}),
    "OrdinaryLagrange.__init__": Case(
        lambda state: [str(lp.charts.OrdinaryLagrange(LAGRANGE, state=state).hamiltonian)], {"state": ORDINARY}
    ),
    "OrdinaryLagrange.from_body": Case(lambda states: chart("ordinary").from_body(states), {"states": ORDINARY[None]}),
    "OrdinaryLagrange.margins": Case(lambda states: chart("ordinary").margins(states), {"states": ORDINARY[None]}),
    "OrdinaryLagrange.to_body": Case(
        lambda z, psi: chart("ordinary").to_body(z, psi), {"z": lambda: inside("ordinary"), "psi": np.array([0.4])}
    ),
    "PhaseFunction.gradient": Case(lambda states: TOP.functions.of("l1^2*beta2").gradient(states), {"states": STATES}),
    "PhaseFunction.hessian": Case(lambda states: TOP.functions.of("l1^2*beta2").hessian(states), {"states": STATES}),
    "QuaternionChart.__init__": Case(lambda state: numbers_of("quaternion", state), {"state": STATE}),
    "QuaternionChart.from_body": Case(lambda states: chart("quaternion").from_body(states), {"states": STATE[None]}),
    "QuaternionChart.margins": Case(lambda states: chart("quaternion").margins(states), {"states": STATES}),
    "QuaternionChart.to_body": Case(lambda z: chart("quaternion").to_body(z), {"z": lambda: inside("quaternion")}),
    "ReducedLagrange.__init__": Case(lambda state: numbers_of("reduced", state), {"state": STATE}),
    "ReducedLagrange.from_body": Case(lambda states: chart("reduced").from_body(states), {"states": STATE[None]}),
    "ReducedLagrange.margins": Case(lambda states: chart("reduced").margins(states), {"states": STATES}),
    "ReducedLagrange.to_body": Case(
        lambda z, psi: chart("reduced").to_body(z, psi), {"z": lambda: inside("reduced"), "psi": np.array([0.4])}
    ),
    "System.invariant_values": Case(lambda states: TOP.invariant_values(states), {"states": STATES}),
    "System.right_hand_side": Case(lambda state: TOP.right_hand_side(0.0, state), {"state": STATE}),
    "System.without_value": Case(lambda states: PARTIAL.without_value(states), {"states": STATES}),
    "System.vector_field": Case(lambda states: TOP.vector_field(states), {"states": STATES}),
    "Top.invariant_values": Case(lambda states: TOP.invariant_values(states), {"states": STATES}),
    "Top.right_hand_side": Case(lambda state: TOP.right_hand_side(0.0, state), {"state": STATE}),
    "Top.without_value": Case(lambda states: PARTIAL.without_value(states), {"states": STATES}),
    "Top.vector_field": Case(lambda states: TOP.vector_field(states), {"states": STATES}),
    "alignment": Case(
        lambda starts, times: lp.chaos.alignment(TOP, starts, times=times, within="leaf"),
        {"starts": STATES, "times": LATER},
    ),
    "attitude": Case(
        lambda starts, times, attitude: lp.orbits.attitude(TOP, starts, times=times, attitude=attitude),
        {"starts": STATES, "times": TIMES, "attitude": QUATERNION},
    ),
    "bounds": Case(lambda state: lp.phase_space.bounds(TOP, state), {"state": STATE}),
    "chart_orbit": Case(
        lambda start, times: lp.orbits.chart_orbit(chart("euler"), start, times=times), {"start": STATE, "times": TIMES}
    ),
    "time_scale": Case(lambda starts: lp.orbits.time_scale(TOP, starts), {"starts": STATES}),
    "decide": Case(lambda starts: lp.decide(TOP, starts, t_end=20), {"starts": STATES}),
    "exponents_by_energy": Case(
        lambda energies: lp.chaos.exponents_by_energy(TOP, leaf=leaf(), energies=energies, n_starts=2, t_end=5),
        {"energies": np.array([1.5, 2.0])},
    ),
    "EnsembleReduction.__init__": Case(lambda time: ensemble_fits(time, CURVES), {"time": LONG}),
    "EnsembleReduction.add": Case(lambda exponent: ensemble_fits(LONG, exponent), {"exponent": CURVES}),
    "finite_time_fit": Case(
        lambda time, exponent: lp.fits.finite_time_fit(time, exponent, window=(5, 100)),
        {"time": LONG, "exponent": CURVES},
    ),
    "first_return": Case(
        lambda starts: lp.sections.first_return(TOP, starts, surface="l3", t_end=30), {"starts": STATES}
    ),
    "fit_goodness": Case(
        lambda time, exponent: lp.fits.fit_goodness(time, exponent, window=(5, 100), n_degrees=3),
        {"time": LONG, "exponent": CURVES},
    ),
    "frequency_drift": Case(
        lambda starts: lp.chaos.frequency_drift(TOP, starts, observable="l1", t_end=40, n_samples=64),
        {"starts": STATES},
    ),
    "melnikov": Case(
        lambda starts: lp.orbits.melnikov(
            SLEEPING, starts, "l1*l2", origin=lp.phase_space.equilibrium(SLEEPING, [0, 0, 0, 0, 0, 1]), integrals=["l3"]
        ),
        {"starts": np.array([2.0, 0, 0, 0, 0, -1])},
    ),
    "integrate": Case(
        lambda starts, times, tangents: lp.integrate(TOP, starts, times=times, tangents=tangents, dense=True),
        {"starts": STATES, "times": TIMES, "tangents": TANGENTS},
    ),
    "lyapunov_exponent": Case(
        lambda starts: lp.lyapunov_exponent(TOP, starts, t_end=100, block=1, transient=5), {"starts": STATES}
    ),
    "Leaf.through": Case(lambda state: lp.Leaf.through(TOP, state), {"state": STATE}),
    "log_fit": Case(
        lambda time, exponent: lp.fits.log_fit(time, exponent, window=(5, 100)), {"time": LONG, "exponent": CURVES}
    ),
    "finite_time_exponents": Case(
        lambda starts, times, tangents: lp.finite_time_exponents(TOP, starts, times=times, tangents=tangents),
        {"starts": STATES, "times": LATER, "tangents": EACH_TANGENT},
    ),
    "lyapunov_spectrum": Case(lambda starts: lp.lyapunov_spectrum(TOP, starts, t_end=10), {"starts": STATES}),
    "mean_curve": Case(lambda time, exponent: lp.fits.mean_curve(time, exponent), {"time": LONG, "exponent": CURVES}),
    "megno": Case(lambda starts: lp.chaos.megno(TOP, starts, t_end=20, n_samples=64), {"starts": STATES}),
    "enclose_equilibria": Case(
        lambda lower, upper: lp.proofs.enclose_equilibria(HENON, (lower, upper)),
        {"lower": np.full(4, -2.0), "upper": np.full(4, 2.0)},
    ),
    "enclose_flow": Case(
        lambda lower, upper: lp.proofs.enclose_flow(HENON, (lower, upper), time=1.0),
        {"lower": IN_THE_WELL, "upper": IN_THE_WELL + 1e-6},
    ),
    "enclose_section_map": Case(
        lambda box: lp.proofs.enclose_section_map(HENON, box, surface="x"), {"box": IN_THE_WELL}
    ),
    "prove_equilibrium": Case(
        lambda guess: lp.proofs.prove_equilibrium(HENON, guess), {"guess": np.array([0.0, 0.9, 0.0, 0.0])}
    ),
    "prove_periodic_orbit": Case(
        lambda start: lp.proofs.prove_periodic_orbit(HENON, start, period=6.794384826845275, level={"H": "1/10"}),
        {"start": np.array([0.0, -0.1461901394453098704, 0.42017326094069075, 0.0])},
    ),
    "periodic_orbits": Case(
        lambda guesses, periods: lp.orbits.periodic_orbits(HENON, {}, "1/10", guesses=guesses, periods=periods),
        {"guesses": np.array([[0.0, -0.15, 0.42, 0.0], [0.0, 0.0, 0.0, 0.4]]), "periods": np.array([6.8, 6.4])},
    ),
    "equilibrium_near": Case(
        lambda guess: lp.phase_space.equilibrium_near(LAGRANGE, guess, along=("l3",)), {"guess": equilibrium()}
    ),
    "rod": Case(
        lambda starts, arclengths, attitude, origin: lp.orbits.rod(
            LAGRANGE, starts, arclengths=arclengths, attitude=attitude, origin=origin
        ),
        {"starts": STATES, "arclengths": TIMES, "attitude": QUATERNION, "origin": np.array([1.0, 2.0, 3.0])},
    ),
    "section": Case(lambda starts: lp.section(TOP, starts, surface="l3", t_end=20), {"starts": STATES}),
    "is_folded": Case(
        lambda states: np.array([lp.sections.is_folded(TOP, states, "l3", "alpha1", "l2")]), {"states": STATES}
    ),
    "find_start": Case(lambda start: lp.phase_space.find_start(TOP, start=start), {"start": STATE}),
    "section_state": Case(
        lambda guess: lp.sections.section_state(
            leaf(), "l3", float(TOP.functions.energy(STATE)) + 0.1, {}, guess=guess
        ),
        {"guess": STATE},
    ),
    "equilibrium": Case(
        lambda state: lp.phase_space.equilibrium(LAGRANGE, state, along=("l3",)), {"state": equilibrium()}
    ),
    "window_grid": Case(lambda time: lp.fits.window_grid(time), {"time": LONG}),
    "window_scan": Case(lambda time, exponent: lp.fits.window_scan(time, exponent), {"time": LONG, "exponent": CURVES}),
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
    "vorticity": Case(lambda states: lp.catalog.vorticity(states, 8), {"states": STATES[:, :8].copy()}),
    "page_of": Case(lambda start: lp.laboratory.page_of(TOP, start=start), {"start": STATES[0].copy()}),
    "LagrangeDiagram.depth": Case(lambda values: lagrange_diagram().depth(values), {"values": TORUS}),
    "LagrangeDiagram.sextic": Case(lambda values: lagrange_diagram().sextic(values), {"values": TORUS}),
    "MomentumMap.derivatives": Case(lambda states: momentum().derivatives(states), {"states": ON_SPHERE}),
    "MomentumMap.fields": Case(lambda states: momentum().fields(states), {"states": ON_SPHERE}),
    "MomentumMap.flow": Case(
        lambda states, times: momentum().flow(states, times), {"states": ON_SPHERE, "times": np.array([0.5, 1.0])}
    ),
    "MomentumMap.rank": Case(lambda states: momentum().rank(states), {"states": ON_SPHERE}),
    "fibre": Case(
        lambda value: lp.tori.fibre(lp.Leaf(SPHERICAL, {"C1": 0, "C2": 1}), value, n_states=5).states,
        {"value": np.array([0.5, 0.2])},
    ),
    "lagrange_actions": Case(lambda values: lp.tori.lagrange_actions(lagrange_diagram(), values), {"values": TORUS}),
    "lagrange_lattice": Case(lambda values: lp.tori.lagrange_lattice(lagrange_diagram(), values), {"values": TORUS}),
    "lagrange_monodromy": Case(
        lambda loop: lp.tori.lagrange_monodromy(lagrange_diagram(), [loop]).periods,
        {"loop": lambda: lp.tori.thread_loop(lagrange_diagram(), lagrange_diagram().threads[0])},
    ),
    "thread_loop": Case(
        lambda base: lp.tori.thread_loop(lagrange_diagram(), lagrange_diagram().threads[0], base), {"base": TORUS}
    ),
    "monodromy": Case(
        lambda state, loop: lp.tori.monodromy(SPHERICAL, state, loop).periods,
        {"state": ON_SPHERE, "loop": np.array([[0.0, 0.2], [0.2, 0.2], [0.2, 0.1]])},
    ),
    "period_lattice": Case(lambda state: lp.tori.period_lattice(SPHERICAL, state).periods, {"state": ON_SPHERE}),
    "rotation_number": Case(
        lambda orbit, center: lp.tori.rotation_number(orbit, center=center),
        {"orbit": np.stack([np.cos(np.arange(9.0)), np.sin(np.arange(9.0))], axis=1), "center": np.array([0.1, 0.2])},
    ),
    "view": Case(lambda start: tuple(lp.view(TOP, start=start).start), {"start": STATES[0].copy()}),
}
