"""Advice of messages, followed to the letter: what a refusal tells the caller to write is a call that runs.

A row is a refused call, the words of its advice, and the call that somebody makes who reads them.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass

import matplotlib
import numpy as np
import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.errors import LiePoissonError

matplotlib.use("Agg")

SO3 = lp.so(3)
PAIR = SO3 @ lp.semidirect(2)
TOP, TWISTED, LAGRANGE = lp.Top.kovalevskaya(), lp.Top.twisted_kovalevskaya(), lp.Top.lagrange()
HEAVY, OSCILLATOR = lp.catalog.system("heavy-top"), lp.catalog.system("henon-heiles")
FREE, TODA = lp.catalog.system("free-rigid-body"), lp.catalog.system("toda")
SYMBOLIC = lp.System(SO3 @ lp.trivial(), "l1^2/A + l2^2/B + l3^2/C", symbols=["A", "B", "C"])
GYROSTAT = (SO3 @ lp.trivial()).with_constant({("l1", "l2"): 1})
X, Y, Z = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0, 0, 1], [0.1, 0.2, 0.3, 0.6, 0, 0.8], [0, 0.1, 0.3, 0]
PAULI = [sp.Matrix([[0, 1], [1, 0]]), sp.Matrix([[0, -sp.I], [sp.I, 0]]), sp.Matrix([[1, 0], [0, -1]])]
UNIT = {"C1": 1, "C2": 0, "C3": 1}


class FieldAlone:
    """What can be integrated and knows nothing else."""

    name = "own"

    def field(self):
        """That of the twisted Kovalevskaya top."""
        return TWISTED.field()


@dataclass
class Advice:
    """A row."""

    refused: Callable[[], object]
    words: str
    followed: Callable[[], object]


def system(hamiltonian, **options):
    """A system with two fields."""
    return lp.System(PAIR, hamiltonian, **options)


def sweep(**options):
    """A small sweep of the heavy top."""
    given = {
        "system": "heavy-top", "starts": {"energy": 1}, "axes": {"a3": [0, 1]}, "n_starts": 2, "t_end": 20,
    }  # fmt: skip
    return lp.sweep(**(given | options))


def view(*given, **options):
    """A view in a notebook."""
    pytest.importorskip("anywidget")
    return lp.view(*given, **options)


def section(**options):
    """A section of the twisted top."""
    return lp.section(TWISTED, X, surface="l3", t_end=50, **options)


def orbit():
    """An orbit of the twisted top."""
    return lp.integrate(TWISTED, X, t_end=5)


EXACT = [
    Advice(
        lambda: lp.inspect(SO3),
        "write System(algebra @ trivial(), hamiltonian)",
        lambda: lp.System(SO3 @ lp.trivial(), "l1"),
    ),
    Advice(
        lambda: lp.inspect(lp.leibniz(2)), "System(so(3) @ extension, ham", lambda: lp.System(SO3 @ lp.leibniz(2), "l1")
    ),
    Advice(
        lambda: lp.inspect({}),
        'liepoisson.catalog.system("kovalevskaya")',
        lambda: lp.inspect(lp.catalog.system("kovalevskaya")),
    ),
    Advice(lambda: lp.System(SO3, "l1"), "write so(3) @ trivial()", lambda: lp.System(SO3 @ lp.trivial(), "l1")),
    Advice(lambda: SO3 @ 1, 'try leibniz(3, "epsilon")', lambda: SO3 @ lp.leibniz(3, "epsilon")),
    Advice(lambda: lp.algebras.sine(4), "Take 3", lambda: lp.algebras.sine(3)),
    Advice(lambda: PAIR + PAIR, "so(3) @ (trivial() + trivial())", lambda: SO3 @ (lp.trivial() + lp.trivial())),
    Advice(lambda: lp.canonical(0), 'canonical(names=("x", "y"))', lambda: lp.canonical(names=("x", "y"))),
    Advice(
        lambda: lp.LieAlgebra.from_matrices(PAULI),
        "Multiply all of them by i",
        lambda: lp.LieAlgebra.from_matrices([sp.I * m for m in PAULI]),
    ),
    Advice(
        lambda: lp.LieAlgebra.from_matrices([[[0, 1], [0, 0]], [[0, 0], [1, 0]]]),
        "Add it to them",
        lambda: lp.LieAlgebra.from_matrices([[[0, 1], [0, 0]], [[0, 0], [1, 0]], [[1, 0], [0, -1]]]),
    ),
    Advice(
        lambda: lp.LieAlgebra.from_matrices([[[0, "I/2"], ["I/2", 0]]]),
        "sympy.I/2 or 0.5j without quotes",
        lambda: (
            lp.LieAlgebra.from_matrices([[[0, sp.I / 2], [sp.I / 2, 0]]]),
            lp.LieAlgebra.from_matrices([[[0, 0.5j], [0.5j, 0]]]),
        ),
    ),
    Advice(
        lambda: lp.LieAlgebra.from_matrices([[["1j"]]]),
        "0.5j without quotes",
        lambda: lp.LieAlgebra.from_matrices([[[0.5j]]]),
    ),
    Advice(
        lambda: lp.LieAlgebra.from_brackets(2, {(0, 1): {0: 1}}, basis_names=["a-b", "c"]),
        "basis_names=['1', '2']",
        lambda: lp.LieAlgebra.from_brackets(2, {(0, 1): {0: 1}}, basis_names=["1", "2"]),
    ),
    Advice(lambda: PAIR.with_constant(3), 'Write {("l1", "l2"): "k"}', lambda: PAIR.with_constant({("l1", "l2"): "k"})),
    Advice(
        lambda: lp.canonical(2).with_constant(3),
        '{("q1", "q2"): "k"}',
        lambda: lp.canonical(2).with_constant({("q1", "q2"): "k"}),
    ),
    Advice(
        lambda: lp.Extension.from_products(1, {(0, 0): 1}),
        "{0: 1}",
        lambda: lp.Extension.from_products(1, {(0, 0): {0: 1}}),
    ),
    Advice(
        lambda: lp.Top(inertia=(1, 1, 2), epsilon="2*"),
        '"2*epsilon"',
        lambda: lp.Top(inertia=(1, 1, 2), epsilon="2*epsilon"),
    ),
    Advice(
        lambda: system(3),
        "'l1^2/2', or lambda l, alpha: l.dot(l) / 2",
        lambda: (system("l1^2/2"), system(lambda l, alpha: l.dot(l) / 2)),
    ),
    Advice(lambda: system("0,5*l1"), "Write decimals with a point: 0.5", lambda: system("0.5*l1")),
    Advice(lambda: system("l1[1]"), "got 1 for a scalar. Leave it out", lambda: system("l1")),
    Advice(lambda: system("l^2"), "Write dot(v, v)", lambda: system("dot(l, l)")),
    Advice(
        lambda: system("dot(l, l/I)", parameters={"I": [1, 2, 3]}),
        "inv(I)*l",
        lambda: system("dot(l, inv(I)*l)", parameters={"I": [1, 2, 3]}),
    ),
    Advice(lambda: system("l1^l2"), "Write exp(y*log(x))", lambda: system("exp(l2*log(l1))")),
    Advice(lambda: system("2l1"), "Write 2*l1", lambda: system("2*l1")),
    Advice(lambda: system("sin*l1"), "Write sin(...)", lambda: system("sin(l1)")),
    Advice(lambda: system("|l|"), "Write norm(v)", lambda: system("norm(l)")),
    Advice(lambda: system("ln(2 + l1^2)"), "Write log(x)", lambda: system("log(2 + l1^2)")),
    Advice(lambda: system("l1", parameters={"k": 1}), "'k' occurs in neither. Leave it out", lambda: system("l1")),
    Advice(lambda: HEAVY.expression(3), "a text such as 'l1 - 1/2'", lambda: HEAVY.expression("l1 - 1/2")),
    Advice(lambda: OSCILLATOR.expression(3), "a text such as 'x - 1/2'", lambda: OSCILLATOR.expression("x - 1/2")),
    Advice(
        lambda: lp.charts.EulerChart(TWISTED, state=[1, 2, 3, 1, 0, 0, 0, 0, 0]),
        "use OrdinaryLagrange for a Lagrange top",
        lambda: lp.charts.OrdinaryLagrange(LAGRANGE, state=[1, 2, 3, 1, 0, 0, 0, 0, 0]),
    ),
    Advice(
        lambda: lp.charts.QuaternionChart(TOP, leaf={"C1": 1, "C2": 5, "C3": 1}),
        "C1 = 1, C2 = 5, C3 = 1. Give the Casimirs of a state, or the state with state=",
        lambda: (
            lp.charts.QuaternionChart(TOP, leaf=lp.Leaf.through(TOP, X).casimirs),
            lp.charts.QuaternionChart(TOP, state=X),
        ),
    ),
    Advice(
        lambda: lp.charts.EulerChart(TWISTED, state=X, gauge="x"),
        '"e3, e1"',
        lambda: lp.charts.EulerChart(TWISTED, state=X, gauge="e3, e1"),
    ),
    Advice(
        lambda: lp.charts.EulerChart(TWISTED, leaf={"C1": 2}),
        'leaf={"C1": 1, "C2": 0, "C3": 1}',
        lambda: lp.charts.EulerChart(TWISTED, leaf={"C1": 1, "C2": 0, "C3": 1}),
    ),
]

CATALOG = [
    Advice(
        lambda: lp.catalog.system("kovalevskaia"),
        "Did you mean kovalevskaya?",
        lambda: lp.catalog.system("kovalevskaya"),
    ),
    Advice(
        lambda: lp.catalog.heavy_top_on("so3", [1, 1, 1], [1, 0, 0]),
        "for example so(3)",
        lambda: lp.catalog.heavy_top_on("so(3)", [1, 1, 1], [1, 0, 0]),
    ),
    Advice(
        lambda: lp.catalog.leibniz_top(2, [1, 1, 1], [[1, 0, 0]] * 2),
        "at most 1, one per field after the first; got 2. Leave out the others",
        lambda: lp.catalog.leibniz_top(2, [1, 1, 1], [[1, 0, 0]]),
    ),
    Advice(
        lambda: lp.read_system("kovalevskaya"),
        'lp.catalog.system("kovalevskaya")',
        lambda: lp.catalog.system("kovalevskaya"),
    ),
    Advice(lambda: lp.cite("todda"), "Did you mean toda?", lambda: lp.cite("toda")),
    Advice(lambda: lp.cite(3), "leave it out", lp.cite),
]

NUMERIC = [
    Advice(
        lambda: lp.integrate(FieldAlone(), X, t_end=1, method=lp.methods.Gauss),
        "try method=Taylor(tol=1e-13)",
        lambda: lp.integrate(FieldAlone(), X, t_end=1, method=lp.Taylor(tol=1e-13)),
    ),
    Advice(
        lambda: lp.integrate(OSCILLATOR, Z, t_end=1, method=lp.methods.LagrangeMap(step=0.1)),
        "try Taylor()",
        lambda: lp.integrate(OSCILLATOR, Z, t_end=1, method=lp.Taylor()),
    ),
    Advice(
        lambda: lp.integrate(TWISTED, X, t_end=1, method=lp.methods.LagrangeMap(step=0.1)),
        "try Splitting(step=0.1)",
        lambda: lp.integrate(TWISTED, X, t_end=1, method=lp.Splitting(step=0.1)),
    ),
    Advice(
        lambda: lp.integrate(TODA, [0, 0.1, 0.2, 0, 0, 0], t_end=1, method=lp.Splitting(step=0.1)),
        "use the Taylor",
        lambda: lp.integrate(TODA, [0, 0.1, 0.2, 0, 0, 0], t_end=1),
    ),
    Advice(
        lambda: lp.integrate(TWISTED, X, t_end=5e-324),
        "t_end: wanted a time of at least 1e-300; got 4.94066e-324; try t_end=100",
        lambda: lp.integrate(TWISTED, X, t_end=100),
    ),
    Advice(lambda: lp.integrate(TWISTED, X), "try t_end=100", lambda: lp.integrate(TWISTED, X, t_end=100)),
    Advice(lambda: lp.integrate(TWISTED, X, t=1), "Write times or t_end", lambda: lp.integrate(TWISTED, X, t_end=1)),
    Advice(
        lambda: lp.integrate(TWISTED, X, t_end=1, tol=1e-9),
        "Write method",
        lambda: lp.integrate(TWISTED, X, t_end=1, method=lp.Taylor(tol=1e-9)),
    ),
    Advice(
        lambda: lp.integrate(TWISTED, np.ones((9, 3)), t_end=1),
        "Transpose it?",
        lambda: lp.integrate(TWISTED, np.ones((9, 3)).T, t_end=1),
    ),
    Advice(
        lambda: orbit().at([0.5]),
        "integrate(..., dense=True)",
        lambda: lp.integrate(TWISTED, X, t_end=1, dense=True).at([0.5]),
    ),
    Advice(
        lambda: orbit().go_on(t_end=-1),
        "integrate from end_state",
        lambda: lp.integrate(TWISTED, orbit().end_state, t_end=-1),
    ),
    Advice(lambda: orbit().go_on(t_end=np.nextafter(5, 6)), "try t_end=10", lambda: orbit().go_on(t_end=10)),
    Advice(
        lambda: lp.section(OSCILLATOR, Z, surface=3, t_end=5),
        "the name of a component as a text",
        lambda: lp.section(OSCILLATOR, Z, surface="x", t_end=5),
    ),
    Advice(
        lambda: lp.section(
            lp.System(lp.algebras.heisenberg(1) @ lp.trivial(), "dot(l, l)"), [1, 2, 3], surface="lc", t_end=5
        ),
        'try a component such as "lq1"',
        lambda: lp.section(
            lp.System(lp.algebras.heisenberg(1) @ lp.trivial(), "dot(l, l)"), [1, 2, 3], surface="lq1", t_end=5
        ),
    ),
    Advice(
        lambda: lp.section(OSCILLATOR, Z, surface="x", keep="y", t_end=5),
        "try ['y']",
        lambda: lp.section(OSCILLATOR, Z, surface="x", keep=["y"], t_end=5),
    ),
    Advice(
        lambda: lp.section(FieldAlone(), X, surface="l3", t_end=5),
        "System.function_tape",
        lambda: lp.section(FieldAlone(), X, surface=TWISTED.function_tape("l3"), t_end=5),
    ),
    Advice(
        lambda: lp.section(TWISTED, X, surface="l3", t_end=1e308),
        "at most 1e+300; got 1e+308; try t_end=1000",
        lambda: lp.section(TWISTED, X, surface="l3", t_end=1000),
    ),
    Advice(
        lambda: lp.lyapunov_exponent(TWISTED, X, t_end=5e-324),
        "try t_end=5",
        lambda: lp.lyapunov_exponent(TWISTED, X, t_end=5),
    ),
    Advice(
        lambda: lp.lyapunov_exponent(TWISTED, X, t_end=1e-4),
        "take a shorter transient",
        lambda: lp.lyapunov_exponent(TWISTED, X, t_end=1e-4, transient=0),
    ),
    Advice(
        lambda: lp.lyapunov_exponent(TWISTED, X, t_end=100, block=50),
        "try block=1",
        lambda: lp.lyapunov_exponent(TWISTED, X, t_end=100, block=1),
    ),
    Advice(
        lambda: lp.lyapunov_spectrum(TWISTED, X, t_end=50, covariant=True),
        "try transient=5",
        lambda: lp.lyapunov_spectrum(TWISTED, X, t_end=50, covariant=True, transient=5),
    ),
    Advice(
        lambda: lp.chaos.megno(TWISTED, X, t_end=5e-324),
        "try t_end=1000",
        lambda: lp.chaos.megno(TWISTED, X, t_end=1000),
    ),
    Advice(
        lambda: lp.chaos.alignment(TWISTED, X, t_end=10, within="leaf", n_vectors=7),
        "within='space'",
        lambda: lp.chaos.alignment(TWISTED, X, t_end=10, within="space", n_vectors=7),
    ),
    Advice(
        lambda: lp.chaos.frequency_drift(OSCILLATOR, Z, t_end=50, observable=3),
        'try "p_y"',
        lambda: lp.chaos.frequency_drift(OSCILLATOR, Z, t_end=50, observable="p_y"),
    ),
    Advice(
        lambda: lp.decide(TWISTED, X, t_end=100, rule=3),
        "try Rule(megno=(3, 5))",
        lambda: lp.decide(TWISTED, X, t_end=100, rule=lp.chaos.Rule(megno=(3, 5))),
    ),
    Advice(
        lambda: lp.sample_states(TWISTED, 3, seed=1, ensemble="cubes"),
        "Did you mean cube?",
        lambda: lp.sample_states(TWISTED, 3, seed=1, ensemble="cube"),
    ),
]

PHASE_SPACE = [
    Advice(
        lambda: lp.integrate(HEAVY, {"l4": 1}, t_end=1),
        "Did you mean one of l1, l2, l3?",
        lambda: [lp.integrate(HEAVY, {name: 1}, t_end=1) for name in ("l1", "l2", "l3")],
    ),
    Advice(
        lambda: lp.integrate(HEAVY, {"l4": (1, 0, 0)}, t_end=1),
        "Did you mean l?",
        lambda: lp.integrate(HEAVY, {"l": (1, 0, 0)}, t_end=1),
    ),
    Advice(
        lambda: lp.phase_space.find_start(OSCILLATOR, leaf={"C1": 1}),
        "Write {}",
        lambda: lp.phase_space.find_start(OSCILLATOR, leaf={}),
    ),
    Advice(
        lambda: lp.phase_space.find_start(OSCILLATOR, leaf=3),
        "Write {}",
        lambda: lp.phase_space.find_start(OSCILLATOR, leaf={}),
    ),
    Advice(
        lambda: lp.integrability.first_integrals(OSCILLATOR, degree=1, on=None),
        'on="H = 0" or on={"H": 0}',
        lambda: [lp.integrability.first_integrals(OSCILLATOR, degree=1, on=on) for on in ("H = 0", {"H": 0})],
    ),
    Advice(
        lambda: lp.Leaf(HEAVY, {"C9": 1}), 'Write {"C1": ..., "C2": ...}', lambda: lp.Leaf(HEAVY, {"C1": 0.5, "C2": 1})
    ),
    Advice(
        lambda: lp.Leaf(HEAVY, {"C1": 0, "C2": -1}),
        "Make it positive, or give a state",
        lambda: (lp.Leaf(HEAVY, {"C1": 0, "C2": 1}), lp.Leaf.through(HEAVY, Y)),
    ),
    Advice(
        lambda: lp.Leaf(TOP, {"C1": 1, "C2": 1, "C3": 1}),
        "For parallel vectors give a state",
        lambda: lp.Leaf.through(TOP, [0, 0, 0, 0, 0, 1, 0, 0, 1]),
    ),
    Advice(
        lambda: lp.equilibria(LAGRANGE, lp.Leaf.through(LAGRANGE, X), along="l3"),
        "Write ('l3',)",
        lambda: lp.equilibria(LAGRANGE, lp.Leaf.through(LAGRANGE, X), along=("l3",), values={"l3": 0.5}, n_starts=5),
    ),
    Advice(
        lambda: lp.equilibria(LAGRANGE, lp.Leaf.through(LAGRANGE, X), along=3),
        "along=('l.alpha',) or along=()",
        lambda: lp.equilibria(
            LAGRANGE, lp.Leaf.through(LAGRANGE, X), along=("l.alpha",), values={"l.alpha": 0.5}, n_starts=5
        ),
    ),
    Advice(
        lambda: lp.equilibria(OSCILLATOR, {}, along=3),
        "Write along=() for",
        lambda: lp.equilibria(OSCILLATOR, {}, along=()),
    ),
    Advice(
        lambda: lp.equilibria(LAGRANGE, lp.Leaf.through(LAGRANGE, X), along=("l1",)),
        "Known: l.alpha, l3",
        lambda: lp.equilibria(LAGRANGE, lp.Leaf.through(LAGRANGE, X), along=("l3",), values={"l3": 0.5}, n_starts=5),
    ),
    Advice(
        lambda: lp.equilibria(LAGRANGE, lp.Leaf.through(LAGRANGE, X), along=("l3",)),
        "values={'l3': 0.5}",
        lambda: lp.equilibria(LAGRANGE, lp.Leaf.through(LAGRANGE, X), along=("l3",), values={"l3": 0.5}, n_starts=5),
    ),
    Advice(
        lambda: lp.equilibria(LAGRANGE, lp.Leaf.through(LAGRANGE, X), values={"l3": 1}),
        "Leave values out",
        lambda: lp.equilibria(LAGRANGE, lp.Leaf.through(LAGRANGE, X)),
    ),
    Advice(
        lambda: lp.phase_space.find_start(HEAVY, start=Y, energy=50),
        "Write guess instead of start",
        lambda: lp.phase_space.find_start(HEAVY, guess=Y, energy=50),
    ),
    Advice(
        lambda: lp.sections.good_surface(lp.Top(inertia=(1, 1, 2), b=(0, 0, 1))),
        'such as "beta3"',
        lambda: lp.section(lp.Top(inertia=(1, 1, 2), b=(0, 0, 1)), X, surface="beta3", t_end=5),
    ),
    Advice(
        lambda: lp.sections.good_surface(HEAVY),
        'or "alpha3", if orbits of your leaf and energy cross it',
        lambda: lp.section(HEAVY, Y, surface="alpha3", t_end=5),
    ),
    Advice(
        lambda: lp.section(LAGRANGE, X, surface="l3 - 0.1", t_end=5),
        'try a component such as "l1"',
        lambda: lp.section(LAGRANGE, X, surface="l1", t_end=5),
    ),
    Advice(
        lambda: lp.phase_space.sleeping_top(lp.catalog.system("lagrange"), l3=1, alpha3=1),
        "Take Top.lagrange(transverse=..., axial=..., a3=...)",
        lambda: lp.phase_space.sleeping_top(lp.Top.lagrange(transverse=1, axial="1/2", a3=1), l3=1, alpha3=1),
    ),
    Advice(
        lambda: lp.phase_space.bounds(OSCILLATOR, Z),
        "leaf.energy_range()",
        lambda: lp.Leaf(OSCILLATOR, {}).energy_range(),
    ),
]

ORBITS = [
    Advice(
        lambda: lp.orbits.attitude(LAGRANGE, X, times=[0, 1], method=lp.Splitting(step=0.1)),
        "13 components, which has none; try Taylor()",
        lambda: lp.orbits.attitude(LAGRANGE, X, times=[0, 1], method=lp.Taylor()),
    ),
    Advice(
        lambda: lp.orbits.rod(LAGRANGE, X, length=5, method=lp.Splitting(step=0.1)),
        "16 components, which has none; try Taylor()",
        lambda: lp.orbits.rod(LAGRANGE, X, length=5, method=lp.Taylor()),
    ),
    Advice(
        lambda: lp.orbits.rod(LAGRANGE, X, length=5e-324),
        "try length=20",
        lambda: lp.orbits.rod(LAGRANGE, X, length=20),
    ),
    Advice(
        lambda: lp.orbits.rod(TOP, X, length=5),
        "a = (0, 0, a3)",
        lambda: lp.orbits.rod(lp.Top(inertia=(2, 2, 1), a=(0, 0, 1)), X, length=5),
    ),
    Advice(
        lambda: lp.orbits.attitude(HEAVY, Y, times=[0, 1], attitude=-np.eye(3)),
        "reverse one column",
        lambda: lp.orbits.attitude(HEAVY, Y, times=[0, 1], attitude=np.diag([-1, -1, 1])),
    ),
    Advice(
        lambda: lp.orbits.attitude(HEAVY, Y, times=[0, 1], attitude="beta"),
        "l, alpha; got 'beta'; give one of them",
        lambda: lp.orbits.attitude(HEAVY, Y, times=[0, 1], attitude="alpha"),
    ),
    Advice(
        lambda: lp.orbits.attitude(lp.System(GYROSTAT, "dot(l, l)/2 + l1^2"), [1, 2, 3], times=[0, 1]),
        "take bracket.translated(-xi) and x - xi in the place of x",
        lambda: lp.orbits.attitude(
            lp.System(GYROSTAT.translated([0, 0, 1]), "(l1^2 + l2^2 + (l3 + 1)^2)/2 + l1^2"), [1, 2, 2], times=[0, 1]
        ),
    ),
    Advice(
        lambda: lp.orbits.symmetric_periodic_orbits(OSCILLATOR, {}, 0.1, n_starts=2, t_end=5e-324),
        "try t_end=11.4",
        lambda: lp.orbits.symmetric_periodic_orbits(OSCILLATOR, {}, 0.1, n_starts=2, t_end=11.4),
    ),
]

SWEEPS = [
    Advice(lambda: sweep(axes={"zz": [0, 1]}), "I1, I2, I3, a1, a2, a3, energy", lambda: sweep(axes={"I1": [1, 2]})),
    Advice(
        lambda: sweep(axes={"zz": [0, 1]}),
        'I = ["1 + zz^2", "1 + zz^2", "1 + zz^2"]',
        lambda: sweep(axes={"zz": [0, 1]}, parameters={"I": ["1 + zz^2"] * 3}),
    ),
    Advice(
        lambda: sweep(axes=lp.sweeps.Axis.linear("a3", 0, 1, 2)),
        "a sequence of one or two of Axis",
        lambda: sweep(axes=[lp.sweeps.Axis.linear("a3", 0, 1, 2)]),
    ),
    Advice(
        lambda: sweep(axes=[1, 2]), "(Axis.linear(...),)", lambda: sweep(axes=(lp.sweeps.Axis.linear("a3", 0, 1, 2),))
    ),
    Advice(
        lambda: sweep(axes={"H": [1, 2]}, starts={}),
        "Call it energy",
        lambda: sweep(axes={"energy": [1, 2]}, starts={}),
    ),
    Advice(
        lambda: sweep(quantity="chaotic_fraction").mean,
        "take chaotic_fraction",
        lambda: sweep(quantity="chaotic_fraction").chaotic_fraction,
    ),
    Advice(lambda: sweep(t_end=-1), "try t_end=1000", lambda: sweep(t_end=1000)),
    Advice(lambda: sweep(threads=1, processes=1), "Leave out the others", lambda: sweep(threads=1)),
]

INTEGRABILITY = [
    Advice(
        lambda: lp.integrability.first_integrals(OSCILLATOR, degree=2, on="x=1"),
        "such as H = 1",
        lambda: lp.integrability.first_integrals(OSCILLATOR, degree=2, on="H = 1"),
    ),
    Advice(
        lambda: lp.integrability.first_integrals(lp.catalog.system("zeitlin-5"), degree=9),
        "Take degree=4, or search by weight",
        lambda: lp.integrability.first_integrals(HEAVY, weight=2),
    ),
    Advice(
        lambda: lp.integrability.integrable_families(FREE, degree=1),
        "leave parameters without values, symbols=[...], or call first_integrals",
        lambda: (
            lp.integrability.integrable_families(SYMBOLIC, degree=1),
            lp.integrability.first_integrals(FREE, degree=1),
        ),
    ),
    Advice(
        lambda: lp.integrability.save_certificate(lp.integrability.integrability_report(FREE, degree=2), "top.json"),
        "or report.certificate",
        lambda: lp.integrability.save_certificate(
            lp.integrability.integrability_report(FREE, degree=2).certificate, "top.json"
        ),
    ),
    Advice(
        lambda: lp.integrability.lax_families(FREE),
        "call search_lax_pairs",
        lambda: lp.integrability.search_lax_pairs(FREE),
    ),
    Advice(
        lambda: lp.integrability.search_lax_pairs(SYMBOLIC),
        "lax_families",
        lambda: lp.integrability.lax_families(SYMBOLIC),
    ),
    Advice(
        lambda: lp.integrability.general_system(SO3, degree=2),
        "so(3) @ semidirect(2)",
        lambda: lp.integrability.general_system(PAIR, degree=2),
    ),
    Advice(
        lambda: lp.integrability.scan_integrals(SYMBOLIC, degree=1, axes={"x": [1]}),
        'such as {"A": [1, "3/2"]}',
        lambda: lp.integrability.scan_integrals(SYMBOLIC, degree=1, axes={"A": [1, "3/2"], "B": [2], "C": [3]}),
    ),
    Advice(
        lambda: lp.integrability.known_lax_pair("kovalevskay"),
        "Did you mean kovalevskaya?",
        lambda: lp.integrability.known_lax_pair("kovalevskaya"),
    ),
    Advice(
        lambda: lp.integrability.monodromy(
            lp.integrability.linear_system([[1 / sp.Symbol("t")]], variable=sp.Symbol("t")),
            [1, 2j, 3j, 3j, 0, float("nan")],
        ),
        "such as [1, 1j, -1, -1j]",
        lambda: lp.integrability.monodromy(
            lp.integrability.linear_system([[1 / sp.Symbol("t")]], variable=sp.Symbol("t")), [1, 1j, -1, -1j]
        ),
    ),
]

PROOFS = [
    Advice(
        lambda: lp.proofs.Box([1], [0]),
        "got 1.0 and 0.0 at (0,), an empty box; exchange them?",
        lambda: lp.proofs.Box([0], [1]),
    ),
    Advice(lambda: lp.proofs.Box(["sqrt(2)"], [3]), "a double below", lambda: lp.proofs.Box([1.414], [3])),
    Advice(
        lambda: lp.proofs.enclose_section_map(OSCILLATOR, Z, surface=3),
        'such as "x - 1/2"',
        lambda: lp.proofs.enclose_section_map(OSCILLATOR, Z, surface="x - 1/20"),
    ),
    Advice(
        lambda: lp.proofs.prove_equilibrium(HEAVY, [0, 0, 0, 0.6, 0, 0.8], level={"C1": "sqrt(2)", "C2": 1}),
        "give a double near it",
        lambda: lp.proofs.prove_equilibrium(HEAVY, [0, 0, 0, 0.6, 0, 0.8], level={"C1": 0.0, "C2": 1}),
    ),
    Advice(
        lambda: lp.proofs.prove_chaos(TWISTED, 3),
        "try what find_certificate returns",
        lambda: lp.proofs.prove_chaos(TWISTED, arithmetics=["intervals"]),
    ),
]

LABORATORY = [
    Advice(lambda: lp.laboratory.page_of(HEAVY, surfaces=None), "leave them out", lambda: lp.laboratory.page_of(HEAVY)),
    Advice(
        lambda: lp.laboratory.page_of(HEAVY, result=orbit()),
        "Leave the system out",
        lambda: lp.laboratory.page_of(TWISTED, result=orbit()),
    ),
    Advice(lambda: view(3), "View lp.Top(...)", lambda: view(lp.Top(inertia=(1, 1, 2), a=(0, 0, 1)))),
    Advice(lambda: view(sweep()), "point=0", lambda: view(sweep(), point=0)),
]

PLOT = [
    Advice(
        lambda: lp.plot.section(3),
        'try section(system, starts, surface="l3", t_end=100)',
        lambda: lp.plot.section(section()),
    ),
    Advice(
        lambda: lp.plot.orbit(3),
        "integrate(system, starts, t_end=100)",
        lambda: lp.plot.orbit(lp.integrate(TWISTED, X, t_end=100)),
    ),
    Advice(
        lambda: lp.plot.section(section(keep=["l1", "l2"]), x="l1*l2"),
        "section(..., keep=[...])",
        lambda: lp.plot.section(section(keep=["l1*l2", "l2"]), x="l1*l2", y="l2"),
    ),
    Advice(
        lambda: lp.plot.section(section(keep=["l1"])),
        "y=points.time",
        lambda: lp.plot.section(section(keep=["l1"]), x="l1", y=section(keep=["l1"]).time),
    ),
    Advice(
        lambda: lp.plot.exponent_distribution(np.ones((3, 2))),
        "exponent[:, -1]",
        lambda: lp.plot.exponent_distribution(np.arange(6.0).reshape(3, 2)[:, -1]),
    ),
    Advice(
        lambda: lp.plot.section(section(), colour="blurple"),
        'Try "#1668b8"',
        lambda: lp.plot.section(section(), colour="#1668b8"),
    ),
]

ROWS = {
    "exact": EXACT,
    "catalog": CATALOG,
    "numeric": NUMERIC,
    "phase_space": PHASE_SPACE,
    "orbits": ORBITS,
    "sweeps": SWEEPS,
    "integrability": INTEGRABILITY,
    "proofs": PROOFS,
    "laboratory": LABORATORY,
    "plot": PLOT,
}


@pytest.mark.parametrize(
    "row",
    [pytest.param(row, id=f"{folder}-{number}") for folder, rows in ROWS.items() for number, row in enumerate(rows)],
)
def test_advice_leads_on(row, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(LiePoissonError, match=re.escape(row.words)):
        row.refused()
    row.followed()
