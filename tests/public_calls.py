"""A call of each public function that takes several values in one argument, and how it reads them.

A new function without a row, or a new word for an argument, fails `test_given`.
"""

import importlib.util
import inspect
import tempfile
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import matplotlib as mpl
import matplotlib.figure
import numpy as np
import pytest
import sympy

import liepoisson as lp

DOCS = Path(__file__).parents[1] / "docs"

_ONE = """
    A B C N a3 address algebra allow_code alpha alpha3 amplitude angle arithmetic averages ax axial azimuth b3
    beta3 beta_e bibtex block bracket certificate chart check closed compensated confidence count covariant
    decided_at degree dense description difference digits direction duration elevation energy energy_below
    enlarged ensemble epsilon eta expression extension field figure filled first fit form fresh function
    functions growth hamiltonian height html interval k kappa kernel key keys kind l3 l_n label least_time
    length letter levels max_boxes max_steps mean_megno message method modulo_casimirs most most_starts n
    n_bootstrap n_components n_crossings n_degrees n_exponents n_points n_samples n_sections n_starts n_times
    n_vectors n_zeros name natural_time number order page panels path patience period permutations playing
    points points_per_piece polynomial port precision processes profiles progress prove_again quantity rate
    record reference reference_label refine result reverses_time rod root rule run sampling scheduler seed
    show_levels shown sign size solution source spectral spin spread stem step stop store structure style
    surface symbol system t_end target text threads time_limit title tol toml top trajectory transient
    transverse value variable verdict verify vmax vmin votes w wanted_error weight window_order
    with_cyclic_angle within words xlabel ylabel
"""
PLAIN = frozenset(_ONE.split())
"""Arguments that are one thing: a number, a name, a flag, a system, a method, a path."""

ONE_THING = {
    "algebras.so": {"q"},  # so(p, q)
    "brackets.Bracket.check_parameter_names": {"names"},  # a set of names
    "citations.cite": {"used"},  # each by itself
    "brackets.Bracket.rename": {"field_names"},  # each by itself
    "extensions.Extension.rename": {"field_names"},
    "extensions.Extension.with_symbol": {"make"},
    "laboratory.view": {"point"},  # the number of a point
    "orbits.symmetric_homoclinic_orbits": {"origin", "reversers"},  # an orbit; as symmetric_periodic_orbits
    "plot.draw": {"options"},  # those of other figures
    "plot.convergence": {"colour"},
    "plot.exponent_distribution": {"colour"},
    "plot.sweep": {"colour"},
    "plot.rod": {"radius"},
    "proofs.enclose_flow": {"time"},
    "proofs.enclose_section_map": {"time"},
    "proofs.find_certificate": {"radius"},
    "results.ExponentEstimate.histogram": {"bins"},
    "results.MeanCurve.at": {"time"},
    "results.Orbit.go_on": {"options"},
    "results.Section.go_on": {"options"},
    "results.Section.is_folded": {"x", "y"},
    "sections.is_folded": {"x", "y"},
    "sections.default_surface": {"leaf"},
    "sections.section_starts": {"leaf"},
    "sections.section_state": {"leaf"},
    "chaos.exponents_by_energy": {"leaf"},
    "sweeps.Axis.linear": {"start"},
    "sweeps.Axis.logarithmic": {"start"},
    "sweeps.SweepSpec": {"starts"},
    "systems.PhaseFunction.of_pair": {"pair"},  # two polynomials that the package made
    "sweeps.sweep": {"spec", "settings"},  # those of SweepSpec
    "systems.CanonicalSystem.right_hand_side": {"time"},
}
"""The same word in other places."""

MADE_BY_US = {
    "brackets.CasimirReport", "brackets.Derivation", "brackets.JacobiCertificate", "brackets.Locus",
    "brackets.RankCertificate", "brackets.Stratum", "chaos.PoissonStructure", "chaos.Rule.kinds", "chaos.Rule.votes",
    "charts.LeafConstants", "charts.LeafConstants.of", "charts.LeafConstants.check_on_leaf", "citations.Citation",
    "citations.Work", "extensions.Classification", "extensions.LocalFactor", "fields.PiecesField",
    "fields.QuadraticField", "fields.TapeField", "fields.TopField", "laboratory.Page",
    "laboratory.PageServer.handle_error", "phase_space.Start",
    "sweeps.SweepSpec.of_record", "systems.DiscreteSymmetry", "systems.Integral", "systems.PhaseFunction.of_polynomial",
    "systems.PhaseFunction.gradient_in_balls", "systems.PhaseFunction.value_in_balls", "systems.Reference",
    "systems.Report", "systems.SystemFile", "systems.SystemFile.error",
}  # fmt: skip
"""Records that functions make, and what these call: the fields are taken as they are."""


@dataclass(frozen=True)
class Order:
    """Values in order; where they have names, labels decide.

    `text` says that one text is one item, `mapping` that values by name are taken, too.
    """

    names: tuple[str, ...] = ()
    text: bool = False
    mapping: bool = False
    one: bool = False  # a single value is taken as it is


@dataclass(frozen=True)
class ByName:
    """Values by name; `text` says that a text or a sequence is something else that is taken."""

    text: bool = False


@dataclass(frozen=True)
class Row:
    function: Any
    arguments: dict[str, Any]
    kinds: dict[str, Order | ByName] = field(default_factory=dict)


TOP = lp.Top.kovalevskaya()
PARTIAL = lp.System(lp.so(3) @ lp.leibniz(3), "dot(l, l)/2 + log(10 + alpha1)", name="with a logarithm")
NAMES = TOP.component_names
X = [0.5, -0.25, 1.0, 0.75, 0.5, -0.5, 0.0, 0.0, 0.0]
RIGID = lp.Top.twisted(inertia=(2, 2, 1), a=(1, 0, 0), b=(0, 0.5, 0), epsilon=1)
Y = [0.5, -0.25, 1.0, 0.75, 0.5, -0.5, 0.25, 0.75, 1.0]
E3 = lp.so(3) @ lp.semidirect(2)
FREE = lp.System(lp.so(3) @ lp.trivial(), "(l1^2 + 2*l2^2 + 6*l3^2)/2")
STATES, IN_ORDER, TEXTS, VALUES = Order(NAMES), Order(), Order(), ByName()
STARTS = Order(NAMES, mapping=True)
TIMES = [0.0, 0.25, 0.5]
CURVE = np.linspace(1, 100, 40)


@cache
def family():
    return lp.System(E3, "(l1^2 + l2^2 + J*l3^2)/2 + a*alpha1", symbols=["J", "a"])


@cache
def rod_top():
    return lp.Top.twisted(inertia=(1, 1, 2), a=(0, 0, 1), epsilon=1)


@cache
def crossings():
    return lp.section(TOP, X, surface="l3", t_end=20)


@cache
def orbit():
    return lp.integrate(TOP, X, times=TIMES, dense=True)


@cache
def heavy():
    return lp.catalog.system("heavy-top")


@cache
def exponents():
    rng = np.random.default_rng(1)
    return 0.1 + 1 / CURVE + 0.001 * rng.standard_normal((6, len(CURVE)))


@cache
def attitude():
    return lp.orbits.attitude(rod_top(), Y, times=TIMES, dense=True)


@cache
def chart():
    return lp.charts.EulerChart(RIGID, state=Y)


@cache
def lagrange():
    return lp.Top.twisted_lagrange(transverse=2, axial=1, a3=1, epsilon=1)


@cache
def reduced():
    return lp.charts.ReducedLagrange(lagrange(), state=Y)


@cache
def ordinary():
    return lp.charts.OrdinaryLagrange(lp.Top.lagrange(transverse=2, axial=1, a3=1), state=X)


@cache
def quaternions():
    return lp.charts.QuaternionChart(RIGID, state=Y)


@cache
def leaf():
    return lp.Leaf.through(RIGID, Y)


@cache
def generic_bracket():
    return lp.so(3) @ lp.leibniz(3)


@cache
def heavy_axial():
    return lp.System(E3, "(l1^2 + l2^2)/4 + l3^2/2 + alpha3")


@cache
def lagrange6():
    return lp.catalog.system("lagrange")


@cache
def symbolic_top():
    return lp.System(E3, "dot(l, inv(I)*l)/2 + a3*alpha3", symbols=["I[3]", "a3"])


@cache
def airy():
    return lp.integrability.linear_system([[0, 1], ["x", 0]], sympy.Symbol("x"))


def view(**arguments):
    pytest.importorskip("anywidget")
    return lp.view(**arguments)


def e3_names():
    return E3.coordinate_names_in_order


def numbered(name, n):
    return Order(tuple(f"{name}{k}" for k in range(1, n + 1)))


@cache
def panels():
    return mpl.figure.Figure().subplots(3)


def into_clear_axes(**arguments):
    for axes in panels():
        axes.clear()
    return lp.plot.indicators(**arguments)


def top_row(function, **further):
    arguments = {"inertia": (3, 2.5, 2), "a": (1, 0, 3), **further}
    names = {"inertia": "I", "a": "a", "b": "b"}
    return Row(function, arguments, {name: numbered(names[name], 3) for name in arguments})


@cache
def rows():
    e = (1, 0, 0), (0, 1, 0), (0, 0, 1)
    algebra = lp.so(3)
    epsilon = lp.so(3) @ lp.leibniz(2, "epsilon")
    body = {"states": STATES}
    casimirs = {name: float(f(np.array(Y))) for name, f in RIGID.functions.casimirs.items()}
    heavy_leaf = {"C1": 0.5, "C2": 1}
    z = chart().from_body(Y)
    angles = Order(chart().component_names)
    growth = lp.chaos.megno(TOP, [X, X[::-1]], t_end=20, n_samples=64)
    angle = lp.chaos.alignment(TOP, [X, X[::-1]], t_end=20)
    sleeping = lp.phase_space.sleeping_top(lp.Top.lagrange(transverse=2, axial=1, a3=1), l3=5, alpha3=1)
    fit = lp.fits.finite_time_fit(CURVE, exponents(), window=(2, 90), n_bootstrap=20)
    logarithmic = lp.fits.log_fit(CURVE, exponents(), window=(2, 90), n_bootstrap=20)
    estimate = lp.lyapunov_exponent(TOP, X, t_end=20)
    symmetric = lp.systems.discrete_symmetries(lp.Top.heavy(inertia=(2, 1.5, 1), a=(0, 0, 1))).found[-1]
    case = lp.integrability.integrable_families(family(), degree=1, positive=["J"]).cases[1]
    pair = lp.integrability.known_lax_pair("lagrange")
    point = dict.fromkeys(pair.system.component_names, "1/2")
    page = lp.laboratory.page_of
    flow_box, cube = [0.5, 0.25, 1], lp.proofs.Box([0, 0, 0], [1, 1, 1])
    spectrum = lp.lyapunov_spectrum(TOP, X, t_end=8, interval=1, transient=4, covariant=True).covariant
    along = {"along": TEXTS}
    commuting = {"H": heavy_axial().hamiltonian, "l3": "l3"}
    proof = lp.integrability.certificate(heavy_axial(), commuting)
    return {
        "algebras.LieAlgebra": Row(
            lp.LieAlgebra, {"structure_constants": algebra.structure_constants, "basis_names": ["a", "b", "c"]},
            {"structure_constants": IN_ORDER, "basis_names": TEXTS},
        ),
        "algebras.LieAlgebra.bracket": Row(
            algebra.bracket, {"u": (1, 2, 3), "v": (0, 1, 5)}, dict.fromkeys("uv", Order(algebra.basis_names))
        ),
        "algebras.LieAlgebra.from_brackets": Row(
            lp.LieAlgebra.from_brackets, {"n": 2, "brackets": {(0, 1): {1: 1}}, "basis_names": ["a", "b"]},
            {"brackets": VALUES, "basis_names": TEXTS},
        ),
        "algebras.LieAlgebra.from_matrices": Row(
            lp.LieAlgebra.from_matrices, {"matrices": [[[0, 1], [0, 0]], [[1, 0], [0, -1]]], "basis_names": ["a", "b"]},
            {"matrices": IN_ORDER, "basis_names": TEXTS},
        ),
        "algebras.LieAlgebra.substitute": Row(algebra.substitute, {"values": {"epsilon": 1}}, {"values": VALUES}),
        "algebras.semidirect_sum": Row(
            lp.algebras.semidirect_sum,
            {"algebra": lp.algebras.abelian(1), "representation": [[[0, 1], [-1, 0]]], "module_names": ["x", "y"]},
            {"representation": IN_ORDER, "module_names": TEXTS},
        ),
        "brackets.Automorphism": Row(lp.brackets.Automorphism, {"matrix": [[1, 2], [0, 1]]}, {"matrix": IN_ORDER}),
        "brackets.Bracket": Row(
            lp.Bracket,
            {"algebra": algebra, "extension": lp.trivial(), "field_names": ["m"], "constant": {("m1", "m2"): "k"}},
            {"field_names": TEXTS, "constant": VALUES},
        ),
        "brackets.Bracket.corank": Row(E3.corank, {"point": (1, 2, 3, 0, 1, 0)}, {"point": Order(e3_names())}),
        "brackets.Bracket.frozen": Row(E3.frozen, {"point": (1, 2, 3, 0, 1, 0)}, {"point": Order(e3_names())}),
        "brackets.Bracket.rank": Row(E3.rank, {"point": (1, 2, 3, 0, 1, 0)}, {"point": Order(e3_names())}),
        "brackets.Bracket.substitute": Row(epsilon.substitute, {"values": {"epsilon": 2}}, {"values": VALUES}),
        "brackets.Bracket.translated": Row(E3.translated, {"point": (1, 2, 3, 0, 1, 0)}, {"point": Order(e3_names())}),
        "brackets.Bracket.with_constant": Row(
            E3.with_constant, {"constant": {("l1", "l2"): 1}}, {"constant": VALUES}
        ),
        "brackets.canonical": Row(
            lp.canonical, {"names": ["x", "y"], "momenta": ["u", "v"]}, {"names": TEXTS, "momenta": TEXTS}
        ),
        "catalog.system": Row(
            lp.catalog.system, {"name": "heavy-top", "parameters": {"a": (1, 0, 2)}}, {"parameters": VALUES}
        ),
        "systems.SystemFile.with_parameters": Row(
            lp.catalog.entry("lagrange").with_parameters, {"parameters": {"a": (0, 0, 2)}}, {"parameters": VALUES}
        ),
        "catalog.euler_top_on": Row(
            lp.catalog.euler_top_on, {"algebra": "so(3)", "inertia": (3, 2, 1)}, {"inertia": numbered("I", 3)}
        ),
        "catalog.heavy_top_on": Row(
            lp.catalog.heavy_top_on, {"algebra": "so(3)", "inertia": (3, 2, 1), "a": (1, 0, 2)},
            {"inertia": numbered("I", 3), "a": numbered("a", 3)},
        ),
        "catalog.leibniz_top": Row(
            lp.catalog.leibniz_top, {"n": 3, "inertia": (3, 2, 1), "vectors": [(1, 0, 2), (0, 1, 0)]},
            {"inertia": numbered("I", 3), "vectors": IN_ORDER},
        ),
        "catalog.manakov": Row(lp.catalog.manakov, {"n": 3, "J": (3, 2, 1)}, {"J": numbered("J", 3)}),
        "catalog.su_top": Row(lp.catalog.su_top, {"n": 2, "J": (3, 2)}, {"J": numbered("J", 2)}),
        "catalog.twisted_top_on": Row(
            lp.catalog.twisted_top_on, {"algebra": "so(3)", "inertia": (3, 2, 1), "a": (1, 0, 2), "b": (0, 1, 3)},
            {"inertia": numbered("I", 3), "a": numbered("a", 3), "b": numbered("b", 3)},
        ),
        "catalog.vorticity": Row(lp.catalog.vorticity, {"states": np.arange(8.0), "n_points": 4}, {"states": IN_ORDER}),
        "chaos.Rule": Row(
            lp.chaos.Rule, {"growth_power": (2.0, 3.0), "megno": (2.5, 5.0), "sali": (1e-3, 1e-8)},
            dict.fromkeys(("growth_power", "megno", "sali"), IN_ORDER),
        ),
        "chaos.alignment": Row(
            lp.chaos.alignment, {"system": TOP, "starts": X, "times": [1.0, 2.0], "units": np.arange(1, 10.0)},
            {"starts": STARTS, "times": Order(one=True), "units": STATES},
        ),
        "chaos.decide": Row(lp.decide, {"system": TOP, "starts": X, "t_end": 100}, {"starts": STARTS}),
        "chaos.exponents_by_energy": Row(
            lp.chaos.exponents_by_energy,
            {"system": RIGID, "leaf": leaf(), "energies": [2.0, 3.0], "n_starts": 1, "t_end": 5},
            {"energies": Order(one=True)},
        ),
        "chaos.finite_time_exponents": Row(
            lp.finite_time_exponents, {"system": TOP, "starts": X, "times": [1.0, 2.0], "tangents": np.arange(1, 10.0)},
            {"starts": STARTS, "times": Order(one=True), "tangents": STATES},
        ),
        "chaos.frequency_drift": Row(
            lp.chaos.frequency_drift,
            {"system": TOP, "starts": X, "observable": ["l1", "l2"], "t_end": 10, "n_samples": 64},
            {"starts": STARTS, "observable": Order(text=True)},
        ),
        "chaos.lyapunov_exponent": Row(
            lp.lyapunov_exponent, {"system": TOP, "starts": X, "t_end": 20}, {"starts": STARTS}
        ),
        "chaos.lyapunov_spectrum": Row(
            lp.lyapunov_spectrum, {"system": TOP, "starts": X, "t_end": 4, "interval": 1}, {"starts": STARTS}
        ),
        "chaos.megno": Row(
            lp.chaos.megno, {"system": TOP, "starts": X, "t_end": 5, "n_samples": 64, "tangents": np.arange(1, 10.0)},
            {"starts": STARTS, "tangents": STATES},
        ),
        "charts.EulerChart": Row(
            lp.charts.EulerChart, {"system": RIGID, "leaf": {"C1": 3, "C2": 1, "C3": 2}, "gauge": [e[0], e[1]]},
            {"leaf": VALUES, "gauge": Order(text=True)},
        ),
        "charts.EulerChart:state": Row(lp.charts.EulerChart, {"system": RIGID, "state": Y}, {"state": STATES}),
        "charts.EulerChart.from_body": Row(chart().from_body, {"states": Y}, body),
        "charts.EulerChart.margins": Row(chart().margins, {"states": Y}, body),
        "charts.EulerChart.to_body": Row(chart().to_body, {"z": z}, {"z": angles}),
        "charts.OrdinaryLagrange": Row(
            lp.charts.OrdinaryLagrange, {"system": lp.Top.lagrange(transverse=2, axial=1, a3=1), "state": X},
            {"state": STATES},
        ),
        "charts.OrdinaryLagrange.from_body": Row(ordinary().from_body, {"states": X}, body),
        "charts.OrdinaryLagrange.margins": Row(ordinary().margins, {"states": X}, body),
        "charts.OrdinaryLagrange.to_body": Row(
            ordinary().to_body, {"z": ordinary().from_body(X), "psi": np.array(0.5)},
            {"z": Order(ordinary().component_names), "psi": Order(one=True)},
        ),
        "charts.QuaternionChart": Row(
            lp.charts.QuaternionChart, {"system": RIGID, "leaf": {"C1": 3, "C2": 1, "C3": 2}}, {"leaf": VALUES}
        ),
        "charts.QuaternionChart:state": Row(
            lp.charts.QuaternionChart, {"system": RIGID, "state": Y}, {"state": STATES}
        ),
        "charts.QuaternionChart.from_body": Row(quaternions().from_body, {"states": Y}, body),
        "charts.QuaternionChart.margins": Row(quaternions().margins, {"states": Y}, body),
        "charts.QuaternionChart.to_body": Row(
            quaternions().to_body, {"z": quaternions().from_body(Y)}, {"z": Order(quaternions().component_names)}
        ),
        "charts.ReducedLagrange": Row(
            lp.charts.ReducedLagrange, {"system": lagrange(), "l3": 1, "leaf": {"C1": 3, "C2": 1, "C3": 2}},
            {"leaf": VALUES},
        ),
        "charts.ReducedLagrange:state": Row(
            lp.charts.ReducedLagrange, {"system": lagrange(), "state": Y}, {"state": STATES}
        ),
        "charts.ReducedLagrange.from_body": Row(reduced().from_body, {"states": Y}, body),
        "charts.ReducedLagrange.margins": Row(reduced().margins, {"states": Y}, body),
        "charts.ReducedLagrange.to_body": Row(
            reduced().to_body, {"z": reduced().from_body(Y), "psi": np.array(0.5)},
            {"z": Order(reduced().component_names), "psi": Order(one=True)},
        ),
        "extensions.Extension": Row(
            lp.Extension, {"tensor": lp.semidirect(2).tensor, "field_names": ["u", "v"]},
            {"tensor": IN_ORDER, "field_names": TEXTS},
        ),
        "extensions.Extension.from_products": Row(
            lp.Extension.from_products, {"n": 1, "products": {(0, 0): {0: 1}}, "field_names": ["u"]},
            {"products": VALUES, "field_names": TEXTS},
        ),
        "extensions.Extension.substitute": Row(
            lp.leibniz(2, "epsilon").substitute, {"values": {"epsilon": sympy.Integer(2)}}, {"values": VALUES}
        ),
        "fits.finite_time_fit": Row(
            lp.fits.finite_time_fit, {"time": CURVE, "exponent": exponents(), "window": (2, 90), "n_bootstrap": 20},
            dict.fromkeys(("time", "exponent", "window"), IN_ORDER),
        ),
        "fits.fit_goodness": Row(
            lp.fits.fit_goodness, {"time": CURVE, "exponent": exponents(), "window": (2, 90), "n_degrees": 4},
            dict.fromkeys(("time", "exponent", "window"), IN_ORDER),
        ),
        "fits.log_fit": Row(
            lp.fits.log_fit, {"time": CURVE, "exponent": exponents(), "window": (2, 90), "n_bootstrap": 20},
            dict.fromkeys(("time", "exponent", "window"), IN_ORDER),
        ),
        "fits.mean_curve": Row(
            lp.fits.mean_curve, {"time": CURVE, "exponent": exponents()}, dict.fromkeys(("time", "exponent"), IN_ORDER)
        ),
        "fits.window_scan": Row(
            lp.fits.window_scan,
            {"time": CURVE, "exponent": exponents(), "windows": [(2, 90), (3, 80)], "n_bootstrap": 20},
            dict.fromkeys(("time", "exponent", "windows"), IN_ORDER),
        ),
        "integrability.certificate": Row(
            lp.integrability.certificate, {"system": heavy_axial(), "commuting": commuting}, {"commuting": VALUES}
        ),
        "integrability.darboux_polynomials": Row(
            lp.integrability.darboux_polynomials,
            {"system": FREE, "degree": 1, "field": "real", "on": ["C1 = 1"], "known": {"H": FREE.hamiltonian}},
            {"on": Order(text=True, mapping=True), "known": VALUES},
        ),
        "integrability.first_integrals": Row(
            lp.integrability.first_integrals,
            {"system": FREE, "degree": 1, "on": ["C1 = 1"], "known": {"H": FREE.hamiltonian}},
            {"on": Order(text=True, mapping=True), "known": VALUES},
        ),
        "integrability.general_system": Row(
            lp.integrability.general_system,
            {"bracket": lp.so(3) @ lp.trivial(), "degree": (1, 2), "symmetries": [{"l1": "-l1"}, "l3"]},
            {"degree": Order(one=True), "symmetries": Order(text=True)},
        ),
        "integrability.integrable_families": Row(
            lp.integrability.integrable_families,
            {"system": family(), "degree": 1, "on": ["C1 = 0"], "positive": ["J"], "nonzero": ["a"]},
            {"on": Order(text=True, mapping=True), "positive": TEXTS, "nonzero": TEXTS},
        ),
        "integrability.known_lax_pair": Row(
            lp.integrability.known_lax_pair, {"name": "lagrange", "parameters": {"I": (2, 2, 1)}},
            {"parameters": VALUES},
        ),
        "integrability.lax_families": Row(
            lp.integrability.lax_families,
            {"system": symbolic_top(), "degree": 1, "nonzero": ["a3"], "positive": ["I1", "I2", "I3"]},
            {"nonzero": TEXTS, "positive": TEXTS},
        ),
        "integrability.lax_pair": Row(
            lp.integrability.lax_pair,
            {
                "system": lp.System(lp.so(3) @ lp.trivial(), "l1^2 + l2^2/2"),
                "L": ["l1", "l2", "l3"],
                "M": ["2*l1", "l2", 0],
            },
            {"L": IN_ORDER, "M": IN_ORDER},
        ),
        "integrability.linear_system": Row(
            lp.integrability.linear_system,
            {"matrix": [[0, 1], ["x", 0]], "variable": sympy.Symbol("x"), "names": ["u", "v"]},
            {"matrix": IN_ORDER, "names": TEXTS},
        ),
        "integrability.monodromy": Row(
            lp.integrability.monodromy, {"system": airy(), "corners": [1, 1j, -1, -1j]}, {"corners": IN_ORDER}
        ),
        "integrability.painleve_test": Row(
            lp.integrability.painleve_test, {"system": FREE, "weights": {"l1": 1, "l2": 1, "l3": 1}},
            {"weights": ByName(text=True)},
        ),
        "integrability.particular_solution": Row(
            lp.integrability.particular_solution,
            {"system": FREE, "state": [sympy.Symbol("s"), 0, 0], "variable": sympy.Symbol("s"), "rate": 1},
            {"state": Order(FREE.component_names, mapping=True)},
        ),
        "integrability.save_certificate": Row(
            lambda data: lp.integrability.save_certificate(data, "/nowhere/at/all.txt"), {"data": proof},
            {"data": VALUES},
        ),
        "integrability.scan_integrals": Row(
            lp.integrability.scan_integrals,
            {"system": family(), "degree": 1, "axes": {"J": [1, 2], "a": [1]}, "on": ["C1 = 0"]},
            {"axes": VALUES, "on": Order(text=True, mapping=True)},
        ),
        "laboratory.page_of": Row(
            page, {"system": TOP, "start": X, "surfaces": ["l1", "l2"]},
            {"start": STATES, "surfaces": Order(text=True)},
        ),
        "laboratory.view": Row(
            view, {"shown": TOP, "start": X, "surfaces": ["l1"], "state": {"time": 2}},
            {"start": STATES, "surfaces": Order(text=True), "state": VALUES},
        ),
        "methods.LagrangeMap.integrals": Row(
            lp.methods.LagrangeMap(0.1).integrals,
            {"top": lp.Top.lagrange(transverse=2, axial=1, a3=1), "states": X}, body,
        ),
        "orbits.attitude": Row(
            lp.orbits.attitude, {"system": RIGID, "starts": Y, "times": TIMES, "attitude": (1.0, 0, 0, 0)},
            {"starts": STARTS, "times": Order(one=True), "attitude": IN_ORDER},
        ),
        "orbits.chart_orbit": Row(
            lp.orbits.chart_orbit, {"chart": chart(), "start": Y, "times": TIMES},
            {"start": STATES, "times": Order(one=True)},
        ),
        "orbits.integrate": Row(
            lp.integrate, {"system": TOP, "starts": X, "times": TIMES, "tangents": [X, X[::-1]]},
            {"starts": STARTS, "times": Order(one=True), "tangents": STATES},
        ),
        "orbits.rod": Row(
            lp.orbits.rod,
            {
                "system": rod_top(), "starts": Y, "arclengths": TIMES, "attitude": (1.0, 0, 0, 0),
                "origin": (1.0, 2, 3),
            },
            {"starts": STARTS, "arclengths": Order(one=True), "attitude": IN_ORDER, "origin": IN_ORDER},
        ),
        "orbits.symmetric_periodic_orbits": Row(
            lp.orbits.symmetric_periodic_orbits,
            {"system": heavy(), "leaf": {"C1": 0.2, "C2": 1}, "energy": 1.5, "n_starts": 1, "t_end": 1,
             "reversers": list(lp.systems.discrete_symmetries(heavy()).reversers[:1])},
            {"leaf": VALUES, "reversers": IN_ORDER},
        ),
        "orbits.time_scale": Row(lp.orbits.time_scale, {"system": TOP, "starts": X}, {"starts": STARTS}),
        "phase_space.Leaf": Row(lp.Leaf, {"system": RIGID, "casimirs": casimirs}, {"casimirs": VALUES}),
        "phase_space.Leaf.contains": Row(leaf().contains, {"states": Y}, body),
        "phase_space.Leaf.project": Row(leaf().project, {"states": Y, "energy": 2}, body),
        "phase_space.Leaf.project_tangent": Row(
            leaf().project_tangent, {"states": Y, "vectors": X, "energy": True}, {"states": STATES, "vectors": STATES}
        ),
        "phase_space.Leaf.residual": Row(leaf().residual, {"states": Y}, body),
        "phase_space.Leaf.tangent_basis": Row(leaf().tangent_basis, {"states": Y}, body),
        "phase_space.Leaf.tangent_projector": Row(leaf().tangent_projector, {"states": Y, "energy": True}, body),
        "phase_space.Leaf.through": Row(lp.Leaf.through, {"system": RIGID, "state": Y}, {"state": STATES}),
        "phase_space.bounds": Row(lp.phase_space.bounds, {"system": RIGID, "state": Y}, {"state": STATES}),
        "phase_space.bounds:leaf": Row(
            lp.phase_space.bounds, {"system": RIGID, "leaf": casimirs, "energy": 3}, {"leaf": VALUES}
        ),
        "phase_space.equilibria": Row(
            lp.phase_space.equilibria,
            {
                "system": lagrange6(), "leaf": {"C1": 0.5, "C2": 1}, "along": ["l3"], "values": {"l3": 0.5},
                "n_starts": 4,
            },
            {"leaf": VALUES, "along": TEXTS, "values": VALUES},
        ),
        "phase_space.equilibrium": Row(
            lp.phase_space.equilibrium, {"system": lagrange6(), "state": [0, 0, 2, 0, 0, 1], "along": ["l3"]},
            {"state": Order(lagrange6().component_names), "along": TEXTS},
        ),
        "phase_space.equilibrium_near": Row(
            lp.phase_space.equilibrium_near,
            {"system": lagrange6(), "guess": [0.1, 0, 2, 0.3, 0, 0.9], "along": ["l3"], "values": {"l3": 2}},
            {"guess": Order(lagrange6().component_names), "along": TEXTS, "values": VALUES},
        ),
        "phase_space.find_start": Row(
            lp.phase_space.find_start, {"system": RIGID, "guess": Y, "leaf": {"C1": 3, "C2": 1}},
            {"guess": STARTS, "leaf": VALUES},
        ),
        "phase_space.find_start:start": Row(
            lp.phase_space.find_start, {"system": RIGID, "start": Y}, {"start": STARTS}
        ),
        "plot.exponent_distribution": Row(
            lp.plot.exponent_distribution, {"exponents": exponents()[:, -1], "bins": [0.0, 0.1, 0.2]},
            {"exponents": IN_ORDER, "bins": Order(one=True)},
        ),
        "plot.indicators": Row(
            lp.plot.indicators, {"growth": growth, "angle": angle, "members": [1, 0], "labels": ["u", "v"]},
            {"members": IN_ORDER, "labels": TEXTS},
        ),
        "plot.indicators:axes": Row(
            into_clear_axes, {"growth": growth, "angle": angle, "axes": list(panels())},
            {"axes": IN_ORDER},
        ),
        "plot.orbit": Row(
            lp.plot.orbit, {"run": orbit(), "invariants": {"K": orbit().invariants["H"][0]}}, {"invariants": VALUES}
        ),
        "plot.save_figure": Row(
            lp.plot.save_figure,
            {"figure": lp.plot.orbit(orbit()), "stem": Path(tempfile.mkdtemp()) / "figure", "formats": ["png"]},
            {"formats": TEXTS},
        ),
        "plot.section": Row(
            lp.plot.section,
            {
                "points": crossings(), "x": crossings().state[:, 0], "y": crossings().state[:, 1],
                "trajectories": [0], "colour": ["red"],
            },
            {"x": IN_ORDER, "y": IN_ORDER, "trajectories": Order(one=True), "colour": Order(text=True)},
        ),
        "plot.sleeping_diagram": Row(lp.plot.sleeping_diagram, {"twists": [0, 1]}, {"twists": IN_ORDER}),
        "plot.window_scan": Row(lp.plot.window_scan, {"fits": [fit]}, {"fits": IN_ORDER}),
        "proofs.Box": Row(
            lp.proofs.Box, {"lower": [0.0, 1.0], "upper": [1.0, 2.0]}, dict.fromkeys(("lower", "upper"), IN_ORDER)
        ),
        "proofs.Box.around": Row(
            lp.proofs.Box.around, {"center": [0.0, 1.0], "radius": [1.0, 2.0]},
            {"center": IN_ORDER, "radius": Order(one=True)},
        ),
        "proofs.Box.contains": Row(cube.contains, {"values": flow_box}, {"values": IN_ORDER}),
        "proofs.Box.overlaps": Row(cube.overlaps, {"other": flow_box}, {"other": IN_ORDER}),
        "proofs.enclose_equilibria": Row(
            lp.proofs.enclose_equilibria,
            {"system": FREE, "box": lp.proofs.Box.around([0, 0, 1], 0.25), "level": {"C1": 1}},
            {"level": VALUES},
        ),
        "proofs.enclose_equilibria:box": Row(
            lp.proofs.enclose_equilibria, {"system": FREE, "box": (0.0, 0.0, 1.0)},
            {"box": Order(FREE.component_names)},
        ),
        "proofs.enclose_flow": Row(
            lp.proofs.enclose_flow, {"system": FREE, "box": flow_box, "time": 0.1},
            {"box": Order(FREE.component_names)},
        ),
        "proofs.enclose_section_map": Row(
            lp.proofs.enclose_section_map, {"system": FREE, "box": [0.0, 1, 0.5], "surface": "l1", "time": 5},
            {"box": Order(FREE.component_names)},
        ),
        "proofs.prove_chaos": Row(
            lp.proofs.prove_chaos, {"system": FREE, "certificate": "/nowhere.json", "arithmetics": ["balls"]},
            {"arithmetics": TEXTS},
        ),
        "proofs.find_certificate": Row(
            lp.proofs.find_certificate, {"system": FREE, "leaf": {"C1": 1}, "energy": 1}, {"leaf": VALUES}
        ),
        "proofs.prove_equilibrium": Row(
            lp.proofs.prove_equilibrium, {"system": FREE, "guess": [0.0, 0, 1], "level": {"C1": 1}},
            {"guess": Order(FREE.component_names), "level": VALUES},
        ),
        "proofs.prove_periodic_orbit": Row(
            lp.proofs.prove_periodic_orbit,
            {"system": FREE, "start": [0.5, 0.25, 1], "period": 2.5, "level": {"H": 3, "C1": 1}, "time_limit": 5},
            {"start": Order(FREE.component_names), "level": VALUES},
        ),
        "results.Attitude.at": Row(attitude().at, {"times": TIMES}, {"times": IN_ORDER}),
        "results.Attitude.body": Row(attitude().body, {"vectors": (1.0, 2, 3)}, {"vectors": IN_ORDER}),
        "results.Attitude.space": Row(attitude().space, {"vectors": (1.0, 2, 3)}, {"vectors": IN_ORDER}),
        "results.CovariantVectors.distance_from_centre": Row(
            spectrum.distance_from_centre, {"vectors": TOP.vector_field(spectrum.state), "n_zeros": 5},
            {"vectors": IN_ORDER},
        ),
        "results.ExponentEstimate.quantiles": Row(estimate.quantiles, {"q": [0.5, 0.75]}, {"q": Order(one=True)}),
        "results.FiniteTimeFit.chi_squared": Row(
            fit.chi_squared, {"coefficients": (0.1, 1.0, 0.5)}, {"coefficients": Order(("lambda", "c1", "c0"))}
        ),
        "results.FiniteTimeFit.curve": Row(fit.curve, {"time": [2.0, 3.0]}, {"time": Order(one=True)}),
        "results.LogFit.curve": Row(logarithmic.curve, {"time": [2.0, 3.0]}, {"time": Order(one=True)}),
        "results.LaxPair.spectral_curve": Row(pair.spectral_curve, {"point": point}, {"point": ByName(text=True)}),
        "results.Orbit.at": Row(orbit().at, {"times": [0.1, 0.2]}, {"times": Order(one=True)}),
        "results.Orbit.go_on": Row(orbit().go_on, {"times": [0.75, 1.0]}, {"times": Order(one=True)}),
        "results.ParameterCase.holds_at": Row(case.holds_at, {"values": {"J": 1, "a": 0}}, {"values": VALUES}),
        "results.SleepingTop.analysis": Row(sleeping.analysis, {"along": ["l3"]}, along),
        "sections.first_return": Row(
            lp.sections.first_return, {"system": TOP, "starts": X, "surface": "l3", "t_end": 20}, {"starts": STARTS}
        ),
        "sections.is_folded": Row(
            lp.sections.is_folded,
            {"system": TOP, "states": crossings().state[:3], "surface": "l3", "x": "l1", "y": "l2"},
            body,
        ),
        "sections.section": Row(
            lp.section,
            {"system": TOP, "starts": X, "surface": "l3", "t_end": 20, "start_side": [0], "keep": ["l1", "alpha2"]},
            {"starts": STARTS, "start_side": Order(one=True), "keep": TEXTS},
        ),
        "sections.section_state": Row(
            lp.sections.section_state,
            {"leaf": lp.Leaf(heavy(), heavy_leaf), "surface": "l3", "energy": 1.5, "coordinates": {"l1": 0.2},
             "guess": [0.2, 1, 0, 0, 0, 1]},
            {"coordinates": VALUES, "guess": Order(heavy().component_names, mapping=True)},
        ),
        "sweeps.Axis": Row(lp.sweeps.Axis, {"name": "epsilon", "values": (0.0, 0.5)}, {"values": IN_ORDER}),
        "sweeps.Starts": Row(lp.sweeps.Starts, {"casimirs": {"C1": 1, "C2": 0}}, {"casimirs": VALUES}),
        "sweeps.SweepSpec": Row(
            lp.sweeps.SweepSpec,
            {
                "system": "twisted-top", "axes": (lp.sweeps.Axis("epsilon", (0.0, 0.5)),), "t_end": 10,
                "parameters": {"I": (2, 2, 1), "a": (-1, 0, 0), "b": (0, 0, 0)},
            },
            {"axes": IN_ORDER, "parameters": VALUES},
        ),
        "systems.CanonicalSystem": Row(
            lp.systems.CanonicalSystem,
            {
                "coordinates": ["x"], "momenta": ["p"], "hamiltonian": "p^2/2 + k*x^2/2", "parameters": {"k": 2},
                "quadratures": {"psi": "p"}, "integrals": {"K": "p^2 + 2*x^2"}, "symbols": ["m"],
            },
            {
                "coordinates": TEXTS, "momenta": TEXTS, "parameters": VALUES, "quadratures": VALUES, "symbols": TEXTS,
                "integrals": VALUES,
            },
        ),
        "systems.CanonicalSystem.invariant_values": Row(TOP.invariant_values, {"states": X}, body),
        "systems.CanonicalSystem.right_hand_side": Row(
            TOP.right_hand_side, {"time": 0.0, "state": X}, {"state": STATES}
        ),
        "systems.CanonicalSystem.vector_field": Row(TOP.vector_field, {"states": X}, body),
        "systems.CanonicalSystem.without_value": Row(PARTIAL.without_value, {"states": X}, body),
        "systems.Top.without_value": Row(PARTIAL.without_value, {"states": X}, body),
        "systems.DiscreteSymmetry.meets": Row(symmetric.meets, {"values": {"H": 1, "C1": 0}}, {"values": VALUES}),
        "systems.DiscreteSymmetry.__call__": Row(
            symmetric, {"states": X}, body
        ),
        "systems.PhaseFunction.__call__": Row(TOP.functions.energy, {"states": X}, body),
        "systems.PhaseFunction.gradient": Row(TOP.functions.energy.gradient, {"states": X}, body),
        "systems.PhaseFunction.hessian": Row(TOP.functions.energy.hessian, {"states": X}, body),
        "systems.System": Row(
            lp.System,
            {
                "bracket": E3, "hamiltonian": "dot(l, l)/2 + k*alpha3 + c", "parameters": {"k": 2}, "symbols": ["c"],
                "integrals": {"K": "l3"}, "partial_integrals": {"P": ("l1", "l2")},
            },
            {"parameters": VALUES, "symbols": TEXTS, "integrals": VALUES, "partial_integrals": VALUES},
        ),
        "systems.Top": top_row(lp.Top, b=(1, 2, 3)),
        "systems.Top.charged_heavy": top_row(lp.Top.charged_heavy, b=(1, 2, 3)),
        "systems.Top.free_rigid_body": Row(
            lp.Top.free_rigid_body, {"inertia": (3, 2.5, 2)}, {"inertia": Order(("I1", "I2", "I3"))}
        ),
        "systems.Top.heavy": top_row(lp.Top.heavy),
        "systems.Top.twisted": top_row(lp.Top.twisted, b=(1, 2, 3)),
    }  # fmt: skip


@cache
def public_names():
    spec = importlib.util.spec_from_file_location("public_names", DOCS / "public_names.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@cache
def several():
    """The arguments with several values of each public function: all that are not known to be one thing."""
    found, known = {}, set()
    for dotted, arguments in public_names().callables().items():
        value = public_names().chapters()[dotted.split(".")[0]]
        for part in dotted.split(".")[1:]:
            value = getattr(value, part)
        function = inspect.unwrap(getattr(value, "__func__", value))
        if not str(getattr(function, "__module__", "")).startswith("liepoisson") or function in known:
            continue  # inherited from elsewhere, or met under another name
        known.add(function)
        if issubclass(value, Exception) if isinstance(value, type) else dotted in MADE_BY_US:
            continue
        names = {name for name in arguments if name not in PLAIN | ONE_THING.get(dotted, set())}
        if names and dotted not in MADE_BY_US:
            found[dotted] = names
    return found
