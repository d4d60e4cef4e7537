"""What is refused, and advice followed to the letter: what a message tells the caller to write is a call that runs."""

import ast
import re
from itertools import pairwise
from pathlib import Path

import matplotlib
import numpy as np
import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.errors import LiePoissonError

matplotlib.use("Agg")

SO3 = lp.so(3)
PAIR, SE2 = SO3 @ lp.semidirect(2), lp.algebras.se(2) @ lp.trivial()
TOP, TWISTED, LAGRANGE = lp.Top.kovalevskaya(), lp.Top.twisted_kovalevskaya(), lp.Top.lagrange()
HEAVY, OSCILLATOR = lp.catalog.system("heavy-top"), lp.catalog.system("henon-heiles")
PENDULUM = lp.System(lp.canonical(1), "p1^2/2 - cos(q1)")
FREE, TODA = lp.catalog.system("free-rigid-body"), lp.catalog.system("toda")
SYMBOLIC = lp.System(SO3 @ lp.trivial(), "l1^2/A + l2^2/B + l3^2/C", symbols=["A", "B", "C"])
GYROSTAT = (SO3 @ lp.trivial()).with_constant({("l1", "l2"): 1})
X, Y, Z = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0, 0, 1], [0.1, 0.2, 0.3, 0.6, 0, 0.8], [0, 0.1, 0.3, 0]
PAULI = [sp.Matrix([[0, 1], [1, 0]]), sp.Matrix([[0, -sp.I], [sp.I, 0]]), sp.Matrix([[1, 0], [0, -1]])]


class FieldAlone:
    """What can be integrated and knows nothing else."""

    name = "own"

    def field(self):
        """That of the twisted Kovalevskaya top."""
        return TWISTED.field()


def system(hamiltonian, **options):
    """A system with two fields."""
    return lp.System(PAIR, hamiltonian, **options)


def sweep(**options):
    """A small sweep of the heavy top."""
    given = {"system": "heavy-top", "starts": {"energy": 1}, "axes": {"a3": [0, 1]}, "n_starts": 2, "t_end": 20}
    return lp.sweep(**(given | options))


def view(*given, **options):
    """A view in a notebook."""
    pytest.importorskip("anywidget")
    return lp.view(*given, **options)


def section(**options):
    """A section of the twisted top."""
    return lp.section(TWISTED, X, surface="l3", t_end=50, **options)


def loop():
    """A periodic orbit of the pendulum."""
    return lp.orbits.periodic_orbit(PENDULUM, [1, 0], period=7)


def loops():
    """Periodic orbits of it that a search found."""
    return lp.orbits.periodic_orbits(PENDULUM, {}, energy=0, n_starts=5)


def drawn_as_said(orbit):
    """What a refusal of `draw` says."""
    return lp.plot.orbit(lp.integrate(orbit.system, orbit.start, t_end=orbit.period))


def orbit():
    """An orbit of the twisted top."""
    return lp.integrate(TWISTED, X, t_end=5)


# A refused call, the words of its advice, and the call that somebody makes who reads them.
# fmt: off
ADVICE = (
    # exact
    (lambda: lp.inspect(SO3), "write System(algebra @ trivial(), hamiltonian)",
     lambda: lp.System(SO3 @ lp.trivial(), "l1")),
    (lambda: lp.inspect(lp.leibniz(2)), "System(so(3) @ extension, ham", lambda: lp.System(SO3 @ lp.leibniz(2), "l1")),
    (lambda: lp.inspect({}), 'liepoisson.catalog.system("kovalevskaya")',
     lambda: lp.inspect(lp.catalog.system("kovalevskaya"))),
    (lambda: lp.System(SO3, "l1"), "write so(3) @ trivial()", lambda: lp.System(SO3 @ lp.trivial(), "l1")),
    (lambda: SO3 @ 1, 'try leibniz(3, "epsilon")', lambda: SO3 @ lp.leibniz(3, "epsilon")),
    (lambda: PAIR + PAIR, "so(3) @ (trivial() + trivial())", lambda: SO3 @ (lp.trivial() + lp.trivial())),
    (lambda: lp.canonical(0), 'canonical(names=("x", "y"))', lambda: lp.canonical(names=("x", "y"))),
    (lambda: lp.LieAlgebra.from_matrices(PAULI), "write hermitian=True",
     lambda: lp.LieAlgebra.from_matrices(PAULI, hermitian=True)),
    (lambda: lp.LieAlgebra.from_matrices([[[0, 1], [0, 0]], [[0, 0], [1, 0]]]), "Add it to them",
     lambda: lp.LieAlgebra.from_matrices([[[0, 1], [0, 0]], [[0, 0], [1, 0]], [[1, 0], [0, -1]]])),
    (lambda: lp.LieAlgebra.from_matrices([[[0, "I/2"], ["I/2", 0]]]),
     "sympy.I/2 or 0.5j without quotes",
     lambda: (lp.LieAlgebra.from_matrices([[[0, sp.I / 2], [sp.I / 2, 0]]]), lp.LieAlgebra.from_matrices([[[0, 0.5j],
         [0.5j, 0]]]))),
    (lambda: lp.LieAlgebra.from_brackets(2, {(0, 1): {0: 1}}, basis_names=["a-b", "c"]), "basis_names=['1', '2']",
     lambda: lp.LieAlgebra.from_brackets(2, {(0, 1): {0: 1}}, basis_names=["1", "2"])),
    (lambda: lp.canonical(2).with_constant(3), '{("q1", "q2"): "k"}',
     lambda: lp.canonical(2).with_constant({("q1", "q2"): "k"})),
    (lambda: lp.Extension.from_products(1, {(0, 0): 1}), "{0: 1}",
     lambda: lp.Extension.from_products(1, {(0, 0): {0: 1}})),
    (lambda: lp.Top(inertia=(1, 1, 2), epsilon="2*"), '"2*epsilon"',
     lambda: lp.Top(inertia=(1, 1, 2), epsilon="2*epsilon")),
    (lambda: system("0,5*l1"), "Write decimals with a point: 0.5", lambda: system("0.5*l1")),
    (lambda: system("l^2"), "Write dot(v, v)", lambda: system("dot(l, l)")),
    (lambda: system("dot(l, l/I)", parameters={"I": [1, 2, 3]}), "inv(I)*l",
     lambda: system("dot(l, inv(I)*l)", parameters={"I": [1, 2, 3]})),
    (lambda: system("l1^l2"), "Write exp(y*log(x))", lambda: system("exp(l2*log(l1))")),
    (lambda: system("2l1"), "Write 2*l1", lambda: system("2*l1")),
    (lambda: system("l1", parameters={"k": 1}), "'k' occurs in neither. Leave it out", lambda: system("l1")),
    (lambda: HEAVY.expression(3), "a text such as 'l1 - 1/2'", lambda: HEAVY.expression("l1 - 1/2")),
    (lambda: lp.charts.EulerChart(TWISTED, state=[1, 2, 3, 1, 0, 0, 0, 0, 0]),
     "use OrdinaryLagrange for a Lagrange top",
     lambda: lp.charts.OrdinaryLagrange(LAGRANGE, state=[1, 2, 3, 1, 0, 0, 0, 0, 0])),
    (lambda: lp.charts.QuaternionChart(TOP, leaf={"C1": 1, "C2": 5, "C3": 1}),
     "C1 = 1, C2 = 5, C3 = 1. Give the Casimirs of a state, or the state with state=",
     lambda: (lp.charts.QuaternionChart(TOP, leaf=lp.Leaf.through(TOP, X).casimirs), lp.charts.QuaternionChart(TOP,
         state=X))),
    (lambda: lp.charts.EulerChart(TWISTED, leaf={"C1": 2}), 'leaf={"C1": 1, "C2": 0, "C3": 1}',
     lambda: lp.charts.EulerChart(TWISTED, leaf={"C1": 1, "C2": 0, "C3": 1})),
    # catalog
    (lambda: lp.catalog.leibniz_top(2, [1, 1, 1], [[1, 0, 0]] * 2),
     "at most 1, one per field after the first; got 2. Leave out the others",
     lambda: lp.catalog.leibniz_top(2, [1, 1, 1], [[1, 0, 0]])),
    (lambda: lp.read_system("kovalevskaya"), 'lp.catalog.system("kovalevskaya")',
     lambda: lp.catalog.system("kovalevskaya")),
    # numeric
    (lambda: lp.integrate(FieldAlone(), X, t_end=1, method=lp.methods.Gauss), "try method=Taylor(tol=1e-13)",
     lambda: lp.integrate(FieldAlone(), X, t_end=1, method=lp.Taylor(tol=1e-13))),
    (lambda: lp.integrate(TWISTED, X, t_end=1, method=lp.methods.LagrangeMap(step=0.1)), "try Splitting(step=0.1)",
     lambda: lp.integrate(TWISTED, X, t_end=1, method=lp.Splitting(step=0.1))),
    (lambda: lp.integrate(TODA, [0, 0.1, 0.2, 0, 0, 0], t_end=1, method=lp.Splitting(step=0.1)), "use the Taylor",
     lambda: lp.integrate(TODA, [0, 0.1, 0.2, 0, 0, 0], t_end=1)),
    (lambda: lp.integrate(TWISTED, X, t_end=5e-324),
     "t_end: wanted a time of at least 1e-300; got 4.94066e-324; try t_end=100",
     lambda: lp.integrate(TWISTED, X, t_end=100)),
    (lambda: lp.integrate(TWISTED, X, t_end=1, tol=1e-9), "Write method=liepoisson.Taylor(tol=1e-09).",
     lambda: lp.integrate(TWISTED, X, t_end=1, method=lp.Taylor(tol=1e-9))),
    (lambda: lp.integrate(TWISTED, np.ones((9, 3)), t_end=1), "Transpose it?",
     lambda: lp.integrate(TWISTED, np.ones((9, 3)).T, t_end=1)),
    (lambda: orbit().at([0.5]), "integrate(..., dense=True)",
     lambda: lp.integrate(TWISTED, X, t_end=1, dense=True).at([0.5])),
    (lambda: orbit().go_on(t_end=-1), "integrate from end_state",
     lambda: lp.integrate(TWISTED, orbit().end_state, t_end=-1)),
    (lambda: lp.section(OSCILLATOR, Z, surface=3, t_end=5), "the name of a component as a text",
     lambda: lp.section(OSCILLATOR, Z, surface="x", t_end=5)),
    (lambda: lp.section(lp.System(lp.algebras.heisenberg(1) @ lp.trivial(), "dot(l, l)"), [1, 2, 3], surface="lc",
         t_end=5),
     'try a component such as "lq1"',
     lambda: lp.section(lp.System(lp.algebras.heisenberg(1) @ lp.trivial(), "dot(l, l)"), [1, 2, 3], surface="lq1",
         t_end=5)),
    (lambda: lp.section(FieldAlone(), X, surface="l3", t_end=5), "System.function_tape",
     lambda: lp.section(FieldAlone(), X, surface=TWISTED.function_tape("l3"), t_end=5)),
    (lambda: lp.lyapunov_exponent(TWISTED, X, t_end=1e-4), "take a shorter transient",
     lambda: lp.lyapunov_exponent(TWISTED, X, t_end=1e-4, transient=0)),
    (lambda: lp.lyapunov_exponent(TWISTED, X, t_end=100, block=50), "try block=1",
     lambda: lp.lyapunov_exponent(TWISTED, X, t_end=100, block=1)),
    (lambda: lp.lyapunov_spectrum(TWISTED, X, t_end=50, covariant=True), "try transient=5",
     lambda: lp.lyapunov_spectrum(TWISTED, X, t_end=50, covariant=True, transient=5)),
    (lambda: lp.chaos.alignment(TWISTED, X, t_end=10, within="leaf", n_vectors=7), "within='space'",
     lambda: lp.chaos.alignment(TWISTED, X, t_end=10, within="space", n_vectors=7)),
    (lambda: lp.chaos.frequency_drift(OSCILLATOR, Z, t_end=50, observable=3), 'try "p_y"',
     lambda: lp.chaos.frequency_drift(OSCILLATOR, Z, t_end=50, observable="p_y")),
    (lambda: lp.decide(TWISTED, X, t_end=100, rule=3), "try Rule(megno=(3, 5))",
     lambda: lp.decide(TWISTED, X, t_end=100, rule=lp.chaos.Rule(megno=(3, 5)))),
    # phase space
    (lambda: lp.integrate(HEAVY, {"l4": 1}, t_end=1), "Did you mean one of l1, l2, l3?",
     lambda: [lp.integrate(HEAVY, {name: 1}, t_end=1) for name in ("l1", "l2", "l3")]),
    (lambda: lp.integrability.first_integrals(OSCILLATOR, degree=1, on=None), 'on="H = 0" or on={"H": 0}',
     lambda: [lp.integrability.first_integrals(OSCILLATOR, degree=1, on=on) for on in ("H = 0", {"H": 0})]),
    (lambda: lp.Leaf(HEAVY, {"C9": 1}), 'Write {"C1": ..., "C2": ...}', lambda: lp.Leaf(HEAVY, {"C1": 0.5, "C2": 1})),
    (lambda: lp.Leaf(HEAVY, {"C1": 0, "C2": -1}), "Make it positive, or give a state",
     lambda: (lp.Leaf(HEAVY, {"C1": 0, "C2": 1}), lp.Leaf.through(HEAVY, Y))),
    (lambda: lp.Leaf(TOP, {"C1": 1, "C2": 1, "C3": 1}), "For parallel vectors give a state",
     lambda: lp.Leaf.through(TOP, [0, 0, 0, 0, 0, 1, 0, 0, 1])),
    (lambda: lp.equilibria(LAGRANGE, lp.Leaf.through(LAGRANGE, X), along="l3"), "Write ('l3',)",
     lambda: lp.equilibria(LAGRANGE, lp.Leaf.through(LAGRANGE, X), along=("l3",), values={"l3": 0.5}, n_starts=5)),
    (lambda: lp.equilibria(LAGRANGE, lp.Leaf.through(LAGRANGE, X), along=("l1",)), "Known: l.alpha, l3",
     lambda: lp.equilibria(LAGRANGE, lp.Leaf.through(LAGRANGE, X), along=("l3",), values={"l3": 0.5}, n_starts=5)),
    (lambda: lp.equilibria(LAGRANGE, lp.Leaf.through(LAGRANGE, X), along=("l3",)), "values={'l3': 0.5}",
     lambda: lp.equilibria(LAGRANGE, lp.Leaf.through(LAGRANGE, X), along=("l3",), values={"l3": 0.5}, n_starts=5)),
    (lambda: lp.equilibria(LAGRANGE, lp.Leaf.through(LAGRANGE, X), values={"l3": 1}), "Leave values out",
     lambda: lp.equilibria(LAGRANGE, lp.Leaf.through(LAGRANGE, X))),
    (lambda: lp.phase_space.find_start(HEAVY, start=Y, energy=50), "Write guess instead of start",
     lambda: lp.phase_space.find_start(HEAVY, guess=Y, energy=50)),
    (lambda: lp.sections.good_surface(lp.Top(inertia=(1, 1, 2), b=(0, 0, 1))), 'such as "beta3"',
     lambda: lp.section(lp.Top(inertia=(1, 1, 2), b=(0, 0, 1)), X, surface="beta3", t_end=5)),
    (lambda: lp.sections.good_surface(HEAVY), 'or "alpha3", if orbits of your leaf and energy cross it',
     lambda: lp.section(HEAVY, Y, surface="alpha3", t_end=5)),
    (lambda: lp.section(LAGRANGE, X, surface="l3 - 0.1", t_end=5), 'try a component such as "l1"',
     lambda: lp.section(LAGRANGE, X, surface="l1", t_end=5)),
    (lambda: lp.phase_space.sleeping_top(lp.catalog.system("lagrange"), l3=1, alpha3=1),
     "Take Top.lagrange(transverse=..., axial=..., a3=...)",
     lambda: lp.phase_space.sleeping_top(lp.Top.lagrange(transverse=1, axial="1/2", a3=1), l3=1, alpha3=1)),
    (lambda: lp.phase_space.bounds(OSCILLATOR, Z), "leaf.energy_range()",
     lambda: lp.Leaf(OSCILLATOR, {}).energy_range()),
    # orbits
    (lambda: lp.orbits.attitude(LAGRANGE, X, times=[0, 1], method=lp.Splitting(step=0.1)),
     "13 components, which has none; try Taylor()",
     lambda: lp.orbits.attitude(LAGRANGE, X, times=[0, 1], method=lp.Taylor())),
    (lambda: lp.orbits.rod(TOP, X, length=5), "a = (0, 0, a3)",
     lambda: lp.orbits.rod(lp.Top(inertia=(2, 2, 1), a=(0, 0, 1)), X, length=5)),
    (lambda: lp.orbits.attitude(HEAVY, Y, times=[0, 1], attitude=-np.eye(3)), "reverse one column",
     lambda: lp.orbits.attitude(HEAVY, Y, times=[0, 1], attitude=np.diag([-1, -1, 1]))),
    (lambda: lp.orbits.attitude(HEAVY, Y, times=[0, 1], attitude="beta"), "l, alpha; got 'beta'; give one of them",
     lambda: lp.orbits.attitude(HEAVY, Y, times=[0, 1], attitude="alpha")),
    (lambda: lp.orbits.attitude(lp.System(GYROSTAT, "dot(l, l)/2 + l1^2"), [1, 2, 3], times=[0, 1]),
     "take bracket.translated(-xi) and x - xi in the place of x",
     lambda: lp.orbits.attitude(lp.System(GYROSTAT.translated([0, 0, 1]), "(l1^2 + l2^2 + (l3 + 1)^2)/2 + l1^2"), [1,
         2, 2], times=[0, 1])),
    # sweeps
    (lambda: lp.sweeps.Axis(sp.Symbol("a3"), (0, 1)), 'got a3. Write the text "a3"',
     lambda: lp.sweeps.Axis("a3", (0, 1))),
    (lambda: lp.integrate(HEAVY, {sp.Dummy("l1"): 1}, t_end=1), "got _l1",
     lambda: lp.integrate(HEAVY, {sp.Symbol("l1"): 1}, t_end=1)),
    (lambda: lp.integrate(HEAVY, {HEAVY.variables[0] + 1: 1}, t_end=1), "got l1 + 1",
     lambda: lp.integrate(HEAVY, {HEAVY.variables[0]: 1}, t_end=1)),
    (lambda: sweep(axes={"zz": [0, 1]}), "I1, I2, I3, a1, a2, a3, energy", lambda: sweep(axes={"I1": [1, 2]})),
    (lambda: sweep(axes={"zz": [0, 1]}), 'I = ["1 + zz^2", "1 + zz^2", "1 + zz^2"]',
     lambda: sweep(axes={"zz": [0, 1]}, parameters={"I": ["1 + zz^2"] * 3})),
    (lambda: sweep(axes=[1, 2]), "(Axis.linear(...),)", lambda: sweep(axes=(lp.sweeps.Axis.linear("a3", 0, 1, 2),))),
    (lambda: sweep(quantity="chaotic_fraction").mean, "take chaotic_fraction",
     lambda: sweep(quantity="chaotic_fraction").chaotic_fraction),
    # integrability
    (lambda: lp.integrability.first_integrals(OSCILLATOR, degree=2, on="x=1"), "such as H = 1",
     lambda: lp.integrability.first_integrals(OSCILLATOR, degree=2, on="H = 1")),
    (lambda: lp.integrability.first_integrals(lp.catalog.system("zeitlin-5"), degree=9),
     "Take degree=4, or search by weight", lambda: lp.integrability.first_integrals(HEAVY, weight=2)),
    (lambda: lp.integrability.integrable_families(FREE, degree=1),
     "leave parameters without values, symbols=[...], or call first_integrals",
     lambda: (lp.integrability.integrable_families(SYMBOLIC, degree=1), lp.integrability.first_integrals(FREE,
         degree=1))),
    (lambda: lp.integrability.save_certificate(lp.integrability.integrability_report(FREE, degree=2), "top.json"),
     "or report.certificate",
     lambda: lp.integrability.save_certificate(lp.integrability.integrability_report(FREE, degree=2).certificate,
         "top.json")),
    (lambda: lp.integrability.lax_families(FREE), "call search_lax_pairs",
     lambda: lp.integrability.search_lax_pairs(FREE)),
    (lambda: lp.integrability.general_system(SO3, degree=2), "so(3) @ semidirect(2)",
     lambda: lp.integrability.general_system(PAIR, degree=2)),
    (lambda: lp.integrability.scan_integrals(SYMBOLIC, degree=1, axes={"A": [1, 2]}),
     'such as {"A": [1, "3/2"], "B": 1, "C": 1}',
     lambda: lp.integrability.scan_integrals(SYMBOLIC, degree=1, axes={"A": [1, "3/2"], "B": 1, "C": 1})),
    # proofs
    (lambda: lp.proofs.Box([1], [0]), "got 1.0 and 0.0 at (0,), an empty box; exchange them?",
     lambda: lp.proofs.Box([0], [1])),
    (lambda: lp.proofs.Box(["sqrt(2)"], [3]), "a double below", lambda: lp.proofs.Box([1.414], [3])),
    (lambda: lp.proofs.enclose_section_map(OSCILLATOR, Z, surface=3), 'such as "x - 1/2"',
     lambda: lp.proofs.enclose_section_map(OSCILLATOR, Z, surface="x - 1/20")),
    (lambda: lp.proofs.prove_equilibrium(HEAVY, [0, 0, 0, 0.6, 0, 0.8], level={"C1": "sqrt(2)", "C2": 1}),
     "give a double near it",
     lambda: lp.proofs.prove_equilibrium(HEAVY, [0, 0, 0, 0.6, 0, 0.8], level={"C1": 0.0, "C2": 1})),
    (lambda: lp.proofs.prove_chaos(TWISTED, 3), "try what find_certificate returns",
     lambda: lp.proofs.prove_chaos(TWISTED, arithmetics=["intervals"])),
    # laboratory
    (lambda: view(3), "View lp.Top(...)", lambda: view(lp.Top(inertia=(1, 1, 2), a=(0, 0, 1)))),
    # plot
    (lambda: lp.plot.section(3), 'try section(system, starts, surface="l3", t_end=100)',
     lambda: lp.plot.section(section())),
    (lambda: lp.plot.section(section(keep=["l1", "l2"]), x="l1*l2"), "section(..., keep=[...])",
     lambda: lp.plot.section(section(keep=["l1*l2", "l2"]), x="l1*l2", y="l2")),
    (lambda: lp.plot.section(section(keep=["l1"])), "y=points.time",
     lambda: lp.plot.section(section(keep=["l1"]), x="l1", y=section(keep=["l1"]).time)),
    (lambda: lp.plot.exponent_distribution(np.ones((3, 2))), "exponent[:, -1]",
     lambda: lp.plot.exponent_distribution(np.arange(6.0).reshape(3, 2)[:, -1])),
    (lambda: lp.plot.section(section(), colour="blurple"), 'Try "#1668b8"',
     lambda: lp.plot.section(section(), colour="#1668b8")),
    (lambda: lp.plot.draw(loop()), "write lp.plot.orbit(lp.integrate(orbit.system, orbit.start, t_end=orbit.period))",
     lambda: drawn_as_said(loop())),
    (lambda: lp.plot.draw(loops()),
     "orbit = found[0]: lp.plot.orbit(lp.integrate(orbit.system, orbit.start, t_end=orbit.period))",
     lambda: (loops().columns(), loops().to_dataframe(), drawn_as_said(loops()[0]))),
    (lambda: lp.plot.draw(lp.equilibria(PENDULUM, {})), "found.to_dataframe() is a table",
     lambda: lp.equilibria(PENDULUM, {}).to_dataframe()),
)

# A refused call and the words that matter.
REFUSED = (
    # how a call is written
    (lambda: lp.integrate(TOP, X), "wanted times or t_end"),
    (lambda: lp.integrate(TOP, X, 10), "write integrate(system, starts, times=...)"),
    (lambda: lp.integrate(TOP, X, t=10), "no argument 't'. Write times or t_end."),
    (lambda: lp.integrate(TOP, x0=X, t_end=1), "no argument 'x0'. Write starts."),
    (lambda: lp.section(TOP, X, "l3", 100), "write section(system, starts, surface=..., t_end=...)"),
    (lambda: lp.section(TOP, X), "section must have surface and t_end; write section"),
    (lambda: lp.section(TOP, X, surfaces="l3", t_end=1), "Did you mean surface?"),
    (lambda: lp.sample_states(TOP, n=3), "Write n_starts."),
    (lambda: lp.sample_states(TOP, 3, leaf=lp.Leaf.through(TOP, X)), "Write leaf.sample(n, energy=...)."),
    (lambda: lp.section(TOP, X, surface="l3", t_end=1, dt=0.1), "Write method=liepoisson.Splitting(step=0.1)."),
    (lambda: lp.Leaf(TOP), "Leaf must have casimirs; write Leaf(system, casimirs)"),
    (lambda: lp.Top(I=(1, 1, 1)), "Top has no argument 'I'. Write inertia."),
    (lambda: lp.Top((1, 1, 1)), "Top takes nothing by place, and got 1 values; write Top(inertia=...)"),
    (lambda: lp.Taylor(toll=1e-9), "Taylor has no argument 'toll'. Did you mean tol"),
    (lambda: PAIR("l1"), "bracket must have g; write bracket(f, g)"),
    (lambda: PAIR.rename(names=("m", "p")), "Bracket.rename has no argument 'names'"),
    (lambda: lp.LieAlgebra.from_brackets(3), "must have brackets; write LieAlgebra.from_brackets(n, brackets)"),
    (lambda: lp.Leaf.through(TOP), "must have state; write Leaf.through(system, state)"),
    (lambda: TOP.vector_field(X, 0.0), ".vector_field(states)"),
    (lambda: lp.trivial(3), "trivial takes nothing by place"),
    # what is no system
    (lambda: lp.System(lp.trivial(), "l1"), "write so(3) @ extension"),
    (lambda: lp.System(lp.algebras.se(3), "l1"), "so(3) @ semidirect(2), the same with two vectors"),
    (lambda: lp.integrate(PAIR, [1], t_end=1), "write System(bracket, hamiltonian)"),
    (lambda: lp.integrate(SO3, [1], t_end=1), "write System(algebra @ trivial(), hamiltonian)"),
    (lambda: lp.integrate("kovalevskaya", [1], t_end=1), "catalog.system"),
    (lambda: lp.integrate(lp.Top, [1], t_end=1), "call it to make one"),
    (lambda: lp.inspect(TOP.field()), "a field does not know its bracket"),
    (lambda: lp.inspect(3), "wanted a system"),
    (lambda: lp.sections.good_surface(3), "wanted a system"),
    (lambda: lp.System(PAIR, "l1", name=""), 'wanted a text that is not empty; got \'\'; write for example "heavy'),
    (lambda: lp.plot.draw(orbit(), title=5), "title: wanted a text; got 5"),
    (lambda: lp.plot.draw(section(), title=5), "title: wanted a text; got 5"),
    (lambda: lp.plot.draw(section(), x="l1", y="l2", trajectories=[]), "trajectories must be at least one"),
    (lambda: lp.plot.save_figure(lp.plot.orbit(orbit()), 5), "stem: wanted a path"),
    # what is no algebra, extension, leaf, result
    (lambda: lp.trivial() @ SO3, "write algebra @ extension, as in so(3) @ trivial()"),
    (lambda: SO3 @ SO3, "extension: wanted an Extension; got so(3); try leibniz"),
    (lambda: lp.Bracket("so(3)", lp.trivial()), "algebra: wanted a LieAlgebra; got 'so(3)'; try so(3)"),
    (lambda: SO3 + 3, "wanted a Lie algebra to add; got 3"),
    (lambda: lp.trivial() + 3, "wanted an extension to add; got 3"),
    (lambda: lp.algebras.semidirect_sum(3, [[[1]]]), "got 3, which has no 'dimension'"),
    (lambda: lp.sections.section_starts(3, "l1", energy=1, n_starts=2), "leaf: wanted a Leaf; got 3"),
    (lambda: lp.sections.default_surface(TOP), "leaf: wanted a Leaf"),
    (lambda: lp.orbits.chart_orbit(3, [1] * 9, times=[0, 1]), "chart: got 3, which has no 'system'"),
    (lambda: lp.plot.convergence(3), "got 3, which has no 'exponent'; convergence wants another kind of thing"),
    (lambda: lp.integrate(TOP, [1, 2], t_end=1), "got shape (2,). The components are l1, l2, l3, alpha1"),
    (lambda: lp.orbits.rod(lp.Top.lagrange(), [1, 2], length=1), "The components are l1, l2, l3, alpha1"),
    (lambda: orbit().with_time_limit("x"), "time_limit: wanted"),
    (lambda: lp.laboratory.serve(lp.laboratory.page_of_tops(), port="80"), "port: wanted"),
    (lambda: lp.integrability.general_system(SO3 @ lp.trivial(), degree=1, letter=b"h"), "letter: wanted a text"),
    # names
    (lambda: lp.System(SO3 @ lp.trivial(), "l4"), "'l4' is unknown. l has 3 components. Known"),
    (lambda: lp.System(SO3 @ lp.trivial(), "l0"), "'l0' is unknown. l has 3 components. Known"),
    (lambda: lp.System(lp.algebras.se(3) @ lp.trivial(), "lt4"), "Did you mean lt3? Known are l, pi; components lr1"),
    (lambda: lp.System(lp.algebras.se(3) @ lp.trivial(), "dot(m, p)"), "Write so(3) @ semidirect(2) for se(3)"),
    (lambda: lp.System(SE2.rename("x"), "x1"), "Did you mean xr?"),
    (lambda: system("dot(m, p)"), 'Other names: bracket.rename("m", "p")'),
    (lambda: system("cos(time)*l1"), "Time is t, and in the Hamiltonian of a Python System alone"),
    (lambda: lp.catalog.system("Kovalevskaia"), "Did you mean kovalevskaya"),
    (lambda: lp.read_system("gyrostat.toml"), "Check the path."),
    # nothing of a text is a function or a constant
    *((lambda name=name: system(f"2*{name}*l1"), f"{name}' is unknown") for name in ("I", "sine", "p", "cosine")),
    (lambda: lp.proofs.Box(["2*epsilon"], [1]), "the name 'epsilon' is unknown"),
)
# fmt: on
OF = lp.integrability
SEARCHES = (
    lambda system: OF.first_integrals(system, degree=1), lambda system: OF.darboux_polynomials(system, degree=1),
    OF.integrability_report, OF.integrable_families, OF.galois_obstruction, OF.painleve_test, OF.search_lax_pairs,
    lambda system: OF.scan_integrals(system, axes={"k": [1]}, degree=1), lp.proofs.prove_chaos,
    lambda system: OF.lax_pair(system, L="l", M="l"), lambda system: OF.certificate(system, {"H": "l1"}),
)  # fmt: skip


@pytest.mark.parametrize(("refused", "words", "followed"), ADVICE, ids=[words[:40] for _, words, _ in ADVICE])
def test_advice_leads_on(refused, words, followed, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(LiePoissonError, match=re.escape(words)):
        refused()
    followed()


@pytest.mark.parametrize(("call", "words"), REFUSED, ids=[words[:40] for _, words in REFUSED])
def test_a_wrong_call_is_told_what_was_wanted(call, words):
    with pytest.raises(LiePoissonError, match=re.escape(words)):
        call()


@pytest.mark.parametrize("search", SEARCHES)
def test_a_search_wants_a_whole_system(search):
    for wrong, words in (
        (TOP.field(), "a field does not know its bracket"), (PAIR, "write System(bracket, hamiltonian)"),
        (FieldAlone(), "a vector field only; the equations"),
    ):  # fmt: skip
        with pytest.raises(LiePoissonError, match=re.escape(words)):
            search(wrong)


VERB = re.compile(r" (is|are|has|have|was|were|does|do|takes?|needs?|lacks?|occurs?|vanish(es)?)\b")


def sentences_with_a_list_before_a_verb(tree):
    """Texts that join names and go on with a verb, which is wrong for one name or for several."""
    for node in ast.walk(tree):
        values = node.values if isinstance(node, ast.JoinedStr) else []
        for part, after in pairwise(values):
            joins = re.search(r"\.join\(", ast.unparse(part)) and isinstance(part, ast.FormattedValue)
            if joins and isinstance(after, ast.Constant) and VERB.match(after.value):
                yield f"line {node.lineno}: {ast.unparse(part)}{after.value[:40]}"


def test_no_sentence_has_a_verb_behind_a_list_of_any_length():
    root = Path(lp.__file__).parent
    found = {
        str(path.relative_to(root)): wrong
        for path in sorted(root.rglob("*.py"))
        if (wrong := [*sentences_with_a_list_before_a_verb(ast.parse(path.read_text(encoding="utf-8")))])
    }
    assert not found
    assert [*sentences_with_a_list_before_a_verb(ast.parse("f\"{', '.join(names)} have none\""))]
