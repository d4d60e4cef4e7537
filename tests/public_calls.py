"""The table of examples: a call of each public function that takes several values or makes a result, and how it reads.

Annotations say which functions and arguments these are; one without a call fails `test_given.py` or
`test_results_own_their_numbers.py`.  The tests of files, tables, figures and limits have their calls from here, too.
"""

import functools
import importlib.util
import inspect
import re
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
from numpy.typing import ArrayLike

import liepoisson as lp
from liepoisson.io.result import Result

RUNS = {
    one.kind: one
    for name in lp.results.__all__
    if isinstance(one := getattr(lp.results, name), type) and issubclass(one, Result) and one is not Result
}
"""The classes of what is repeated from a file, by kind."""
DOCS = Path(__file__).parents[1] / "docs"
SEVERAL = re.compile(r"(Array|Starts|Box)Like|Sequence|Mapping|Equations\b|Window|Weights|\bGiven\b|Observable|tuple\[")
"""In annotations of arguments that hold several values."""
NOT_READ = {
    "algebras.GeneratedAlgebra", "algebras.Cochain", "algebras.Derivations", "algebras.Identification",
    "algebras.LieCohomology", "algebras.LieDeformation", "algebras.Subspace", "brackets.CasimirCertificate",
    "brackets.CasimirReport", "brackets.ContractedBracket", "brackets.Derivation", "brackets.JacobiCertificate",
    "brackets.Locus", "brackets.SemiInvariant", "brackets.Stratum", "charts.LeafConstants.of", "citations.Citation",
    "extensions.ChangeOfVariables", "extensions.Classification", "extensions.Deformation", "extensions.LocalFactor",
    "extensions.Obstruction", "extensions.TwistOrbits", "fields.PiecesField", "fields.QuadraticField",
    "fields.TapeField", "laboratory.Page", "systems.DiscreteSymmetry", "sweeps.SweepSpec.of_record", "sweeps.sweep",
    "systems.PhaseFunction.gradient_in_balls", "systems.Reference", "systems.PhaseFunction.of_pair",
    "systems.PhaseFunction.value_in_balls", "systems.Report", "systems.SystemFile", "systems.SystemFile.error",
    "orbits.symmetric_homoclinic_orbits",
}  # fmt: skip
"""Records that functions make, and what these call: the fields are taken as they are.  Settings of a sweep are those of
`SweepSpec`, and homoclinic orbits are searched for like periodic ones."""


@dataclass(frozen=True)
class Order:
    """Values in order; where they have names, labels decide.

    `text` says that one text is one item, `mapping` that values by name are taken, too, `one` that a single value is.
    """

    names: tuple[str, ...] = ()
    text: bool = False
    mapping: bool = False
    one: bool = False


@dataclass(frozen=True)
class ByName:
    """Values by name.

    `text` says that a text or a sequence is something else that is taken, `components` that a value is a number or a
    vector whose components have names.
    """

    text: bool = False
    components: bool = False


@dataclass(frozen=True)
class Row:
    function: Any
    arguments: dict[str, Any]
    kinds: dict[str, Order | ByName] = field(default_factory=dict)


TOP = lp.Top.kovalevskaya()
PARTIAL = lp.System(lp.so(3) @ lp.leibniz(3), "dot(l, l)/2 + log(10 + alpha1)", name="with a logarithm")
X = [0.5, -0.25, 1.0, 0.75, 0.5, -0.5, 0.0, 0.0, 0.0]
RIGID = lp.Top.twisted(inertia=(2, 2, 1), a=(1, 0, 0), b=(0, 0.5, 0), epsilon=1)
Y = [0.5, -0.25, 1.0, 0.75, 0.5, -0.5, 0.25, 0.75, 1.0]
ROUND = lp.catalog.euler_top_on("so(3)", [1, 2, 3])
E3 = lp.so(3) @ lp.semidirect(2)
FREE = lp.System(lp.so(3) @ lp.trivial(), "(l1^2 + 2*l2^2 + 6*l3^2)/2")
HENON = lp.catalog.system("henon-heiles")
SPHERICAL = lp.System(E3, "dot(l, l)/2 + alpha3 + alpha1^2/4", name="a pendulum in a plane")
TIMES = [0.0, 0.25, 0.5]
CURVE = np.linspace(1, 100, 40)
TANGENT = np.arange(1, 10.0)


def numbered(name, n):
    return tuple(f"{name}{k}" for k in range(1, n + 1))


def kinds(words, names):
    """Kinds by short words: N names decide, S names or a mapping, o an order, 1 one or several, t texts, e equations.

    v are values by name, c those of parameters, and w those or a text.  Names are those of a state, or of one argument
    in a dict.
    """
    found = {}
    for word in words.split():
        argument, _, kind = word.partition(":")
        own = names.get(argument, TOP.component_names) if isinstance(names, dict) else names
        found[argument] = {
            "N": Order(own), "S": Order(own, mapping=True), "o": Order(), "1": Order(one=True), "t": Order(text=True),
            "e": Order(text=True, mapping=True), "v": ByName(), "c": ByName(components=True), "w": ByName(text=True),
        }[kind]  # fmt: skip
    return found


@cache
def panels():
    return mpl.figure.Figure().subplots(3)


def in_bounds(lower: ArrayLike, upper: ArrayLike):
    return lp.proofs.enclose_equilibria(HENON, (lower, upper))


def around_a_loop(loop: ArrayLike):
    return lp.tori.lagrange_monodromy(round_diagram(), [loop])


def with_an_invariant(values: ArrayLike):
    return lp.plot.orbit(lp.integrate(TOP, X, times=TIMES), invariants={"K": values})


def into_clear_axes(**arguments):
    for axes in panels():
        axes.clear()
    return lp.plot.indicators(**arguments)


@functools.wraps(lp.view)
def view(**arguments):
    pytest.importorskip("anywidget")
    return lp.view(**arguments)


@cache
def rows():
    """The calls, by dotted name, or by this and a word behind a colon."""
    found = {}

    def add(dotted, words, of=None, names=TOP.component_names, function=None, /, **arguments):
        value = of
        for part in dotted.partition(":")[0].split(".")[0 if of is None else -1 :]:
            if part != "__call__":
                value = getattr(lp if value is None else value, part)
        found[dotted] = Row(function or value, arguments, kinds(words, names))

    _of_algebras(add)
    _of_systems(add)
    _of_runs(add)
    _of_orbits_and_sections(add)
    _of_leaves_and_charts(add)
    _of_damping(add)
    _of_integrals(add)
    _of_tori(add)
    _of_results(add)
    return found


def _of_algebras(add):
    so3 = lp.so(3)
    add(
        "algebras.LieAlgebra", "structure_constants:o basis_names:o", structure_constants=so3.structure_constants,
        basis_names=["a", "b", "c"],
    )  # fmt: skip
    add("algebras.LieAlgebra.bracket", "u:N v:N", so3, so3.basis_names, u=(1, 2, 3), v=(0, 1, 5))
    add(
        "algebras.LieAlgebra.from_brackets", "brackets:v basis_names:o", n=2, brackets={(0, 1): {1: 1}},
        basis_names=["a", "b"],
    )  # fmt: skip
    matrices = [[[0, 1], [0, 0]], [[1, 0], [0, -1]]]
    add("algebras.LieAlgebra.from_matrices", "matrices:o basis_names:o", matrices=matrices, basis_names=["a", "b"])
    add(
        "algebras.LieAlgebra.substitute",
        "values:v",
        lp.LieAlgebra.from_brackets(2, {(0, 1): {1: "k"}}),
        values={"k": 1},
    )
    first = lp.algebras.affine(1)
    add("algebras.LieAlgebra.subalgebra", "vectors:o", first, vectors=[[1, 0]])
    add("algebras.LieAlgebra.quotient", "ideal:o", first, ideal=[[0, 1]])
    add("algebras.closure", "generators:o basis_names:o", generators=matrices, basis_names=["a", "b"])
    turn = [[[0, 1], [-1, 0]]]
    add(
        "algebras.semidirect_sum", "representation:o module_names:o", algebra=lp.algebras.abelian(1),
        representation=turn, module_names=["x", "y"],
    )  # fmt: skip
    add(
        "algebras.central_extension", "cocycles:v central_names:o", given=lp.algebras.abelian(2),
        cocycles={("1", "2"): 1}, central_names=["c"],
    )  # fmt: skip
    add("algebras.cohomology", "coefficients:o", given=lp.algebras.abelian(1), degree=1, coefficients=turn)
    add("algebras.deformation", "cocycle:v", given=lp.algebras.abelian(2), cocycle={("1", "2"): {"1": 1}})
    _of_brackets(add)


def _of_brackets(add):
    so3, e3 = lp.so(3), E3.coordinate_names_in_order
    add("brackets.Automorphism", "matrix:o", matrix=[[1, 2], [0, 1]])
    add(
        "brackets.Bracket", "field_names:o constant:v casimirs:w", algebra=so3, extension=lp.trivial(),
        field_names=["m"], constant={("m1", "m2"): "k"}, casimirs={"C": "dot(m, m) - 2*k*m3"},
    )  # fmt: skip
    for name in ("corank", "frozen", "rank", "translated"):
        add(f"brackets.Bracket.{name}", "point:N", E3, e3, point=(1, 2, 3, 0, 1, 0))
    add("brackets.Bracket.substitute", "values:v", so3 @ lp.leibniz(3, "epsilon"), values={"epsilon": 2})
    add(
        "brackets.Bracket.with_casimirs",
        "casimirs:w symbols:o",
        E3,
        casimirs={"C": "k*dot(alpha, alpha)"},
        symbols=["k"],
    )
    for name in ("casimir_certificate", "is_casimir"):
        add(f"brackets.Bracket.{name}", "symbols:o", E3, function="k*alpha1", symbols=["k"])
    add("brackets.Bracket.with_constant", "constant:v", E3, constant={("l1", "l2"): 1})
    add(
        "brackets.contraction", "weights:S algebra_weights:S integrals:o", None,
        {"weights": ("l", "alpha"), "algebra_weights": ("1", "2", "3")}, bracket=E3, weights=[0, 2],
        algebra_weights=[1, 1, 0], integrals=[E3.variables[0]],
    )  # fmt: skip
    add("brackets.contraction:matrix", "matrix:o", bracket=E3, matrix=[[1, 0], [0, "t"]])
    add("brackets.canonical", "names:o momenta:o angles:o", names=["x", "y"], momenta=["u", "v"], angles=["y"])
    flat = lp.PoissonTensor(["x", "y", "z"], {("x", "y"): "cos(z)"})
    for name, of, angle in (("Bracket", lp.canonical(2), "q2"), ("PoissonTensor", flat, "z")):
        add(f"brackets.{name}.with_angles", "angles:o", of, angles=[angle])
    cycle = {("x", "y"): "k*x*y", ("y", "z"): "y*z", ("x", "z"): "-x*z"}
    tensor = lp.PoissonTensor(["x", "y", "z"], cycle, symbols=["k"])
    add(
        "brackets.PoissonTensor", "variables:o entries:v parameters:c symbols:o casimirs:w angles:o", angles=["z"],
        variables=["x", "y", "z"], entries={("x", "y"): "a1*k*x*y"}, parameters={"a": [1, 2]}, symbols=["k"],
        casimirs={"C": "cos(z)"},
    )  # fmt: skip
    for name in ("corank", "rank"):
        add(f"brackets.PoissonTensor.{name}", "point:N", tensor, tensor.coordinate_names_in_order, point=(1, 2, 3))
    add("brackets.PoissonTensor.substitute", "values:v", tensor, values={"k": 2})
    known = {"C": "log(x) + log(y) + k*log(z)"}
    add("brackets.PoissonTensor.with_casimirs", "casimirs:w symbols:o", tensor, casimirs=known, symbols=["b"])
    for name in ("casimir_certificate", "is_casimir"):
        add(f"brackets.PoissonTensor.{name}", "symbols:o", tensor, function="b*x", symbols=["b"])
    bent = {"variables": {"u": "l1", "v": "l2 + l1^2", "w": "l3"}, "inverse": {"l1": "u", "l2": "v - u^2", "l3": "w"}}
    for name, given in (("Bracket", so3 @ lp.trivial()), ("PoissonTensor", tensor)):
        turned = {"variables": {"u": "x", "v": "y", "w": "z"}, "inverse": {"x": "u", "y": "v", "z": "w"}}
        add(f"brackets.{name}.in_variables", "variables:v inverse:v", given, **(bent if name == "Bracket" else turned))
    rods = {"C": "x - k", "D": "y*z - b - a1"}
    pins = {"C": "l1 + b + a1", "D": "l2"}
    words, values = "constraints:w parameters:c symbols:o", {"parameters": {"a": [1, 2]}, "symbols": ["b"]}
    for name, given, constraints in (("Bracket", so3 @ lp.trivial(), pins), ("PoissonTensor", tensor, rods)):
        add(f"brackets.{name}.dirac_bracket", words, given, constraints=constraints, **values)
    for name, given, one in (("Bracket", so3 @ lp.trivial(), "l3"), ("PoissonTensor", tensor, "x + z")):
        parts = {"u": one, "v": f"({one})^2"}
        add(f"brackets.{name}.in_invariants", "invariants:v levels:v", given, invariants=parts, levels={"L": one})
    field = {"field": ["k*x", "-k*y", "a1"], "parameters": {"a": [1, 2]}, "symbols": ["k"], "mass": 2, "charge": 3}
    words = "field:o variables:o parameters:c symbols:o"
    add("brackets.magnetic", words, **field, variables=["x", "y", "z", "vx", "vy", "vz"])
    add("brackets.guiding_centre", words, **field, variables=["x", "y", "z", "w"])
    add("brackets.log_canonical", "matrix:o variables:o", matrix=[[0, 1], [-1, 0]], variables=["x", "y"])
    add(
        "brackets.nambu", "variables:o parameters:c symbols:o", casimir="x*y + k*z + a1*x", variables=["x", "y", "z"],
        parameters={"a": [1, 2]}, symbols=["k"],
    )  # fmt: skip
    twists = lp.cocycles(lp.so(3) @ lp.semidirect(3))
    add("extensions.Twists.cocycle", "products:v", twists, products={(1, 1): {2: 1}})
    add("extensions.Twists.combination", "coefficients:o", twists, coefficients=[1, 2, 3, 5])
    for name in ("conditions", "deformation"):
        add(f"extensions.Twists.{name}", "parameters:o", twists, parameters=["p", "q", "r", "s"])
    add("extensions.Extension", "tensor:o field_names:o", tensor=lp.semidirect(2).tensor, field_names=["u", "v"])
    add(
        "extensions.Extension.from_products", "products:v field_names:o", n=1, products={(0, 0): {0: 1}},
        field_names=["u"],
    )  # fmt: skip
    add("extensions.Extension.substitute", "values:v", lp.leibniz(3, "epsilon"), values={"epsilon": sympy.Integer(2)})


def _of_systems(add):
    I3, a3, b3 = (numbered(name, 3) for name in "Iab")
    add("catalog.system", "parameters:c", name="heavy-top", parameters={"a": (1, 0, 2)})
    add("systems.SystemFile.with_parameters", "parameters:c", lp.catalog.entry("lagrange"), parameters={"a": (0, 0, 2)})
    names = {"inertia": I3, "a": a3, "b": b3, "J": numbered("J", 3)}
    add("catalog.euler_top_on", "inertia:N", None, names, algebra="so(3)", inertia=(3, 2, 1))
    add("catalog.heavy_top_on", "inertia:N a:N", None, names, algebra="so(3)", inertia=(3, 2, 1), a=(1, 0, 2))
    add(
        "catalog.twisted_top_on", "inertia:N a:N b:N", None, names, algebra="so(3)", inertia=(3, 2, 1), a=(1, 0, 2),
        b=(0, 1, 3),
    )  # fmt: skip
    add(
        "catalog.leibniz_top", "inertia:N vectors:o", None, names, n=3, inertia=(3, 2, 1),
        vectors=[(1, 0, 2), (0, 1, 0)],
    )  # fmt: skip
    add(
        "catalog.cubic_top", "cubic:N inertia:N a:N b:N", None, names | {"cubic": numbered("c", 4)}, cubic=(1, 2, 3, 5),
        inertia=(3, 2, 1), a=(1, 0, 2), b=(0, 1, 3),
    )  # fmt: skip
    add(
        "catalog.lagrange_top",
        "element:N",
        None,
        {"element": numbered("c", 2)},
        extension=lp.semidirect(2),
        element=(2, 3),
    )
    add(
        "catalog.kovalevskaya_top", "first:N second:N", None, {"first": numbered("x", 2), "second": numbered("y", 2)},
        extension=lp.semidirect(2), first=(0, 1), second=(0, 2),
    )  # fmt: skip
    add("catalog.manakov", "J:N", None, names, n=3, J=(3, 2, 1))
    add("catalog.su_top", "J:N", None, numbered("J", 2), n=2, J=(3, 2))
    add("catalog.vorticity", "states:o", states=np.arange(8.0), n_points=4)
    for name in ("Top", "Top.charged_heavy", "Top.twisted"):
        add(f"systems.{name}", "inertia:N a:N b:N", None, names, inertia=(3, 2.5, 2), a=(1, 0, 3), b=(1, 2, 3))
    add("systems.Top.heavy", "inertia:N a:N", None, names, inertia=(3, 2.5, 2), a=(1, 0, 3))
    add("systems.Top.free_rigid_body", "inertia:N", None, names, inertia=(3, 2.5, 2))
    add(
        "systems.CanonicalSystem", "coordinates:o momenta:o parameters:c quadratures:v symbols:o angles:o integrals:v",
        coordinates=["x"], momenta=["p"], hamiltonian="p^2/2 + k*cos(x)", parameters={"k": 2}, quadratures={"psi": "p"},
        integrals={"K": "p^2 + 4*cos(x)"}, symbols=["m"], angles=["x"],
    )  # fmt: skip
    add(
        "systems.System", "parameters:c symbols:o integrals:v partial_integrals:v", bracket=E3,
        hamiltonian="dot(l, l)/2 + k*alpha3 + c", parameters={"k": 2}, symbols=["c"], integrals={"K": "l3"},
        partial_integrals={"P": ("l1", "l2")},
    )  # fmt: skip
    add(
        "systems.VectorField", "equations:v parameters:c symbols:o angles:o integrals:v", symbols=["c"], angles=["z"],
        equations={"x": "k*y + c", "y": "-x", "z": "x"}, parameters={"k": 2}, integrals={"K": "x^2 + 2*y^2 + 2*c*y"},
    )  # fmt: skip
    add("systems.CanonicalSystem.invariant_values", "states:N", TOP, states=X)
    add("systems.CanonicalSystem.right_hand_side", "state:N", TOP, time=0.0, state=X)
    add("systems.CanonicalSystem.vector_field", "states:N", TOP, states=X)
    add("systems.CanonicalSystem.without_value", "states:N", PARTIAL, states=X)
    add("systems.Top.without_value", "states:N", PARTIAL, states=X)
    symmetry = lp.systems.discrete_symmetries(lp.Top.heavy(inertia=(2, 1.5, 1), a=(0, 0, 1))).found[-1]
    add("systems.discrete_symmetries", "", system=HENON)
    add("systems.DiscreteSymmetry.meets", "values:v", symmetry, values={"H": 1, "C1": 0})
    add("systems.DiscreteSymmetry.__call__", "states:N", symmetry, states=X)
    energy = TOP.functions.energy
    for name in ("__call__", "gradient", "hessian"):
        add(f"systems.PhaseFunction.{name}", "states:N", energy, states=X)
    add("sweeps.Axis", "values:o", name="epsilon", values=(0.0, 0.5))
    add("sweeps.Starts", "casimirs:v", casimirs={"C1": 1, "C2": 0})
    parameters = {"I": (2, 2, 1), "a": (-1, 0, 0), "b": (0, 0, 0)}
    axes = (lp.sweeps.Axis("epsilon", (0.0, 0.5)),)
    add("sweeps.sweep", "", system="twisted-top", axes=axes, t_end=10, n_starts=2, parameters=parameters)
    add("sweeps.SweepSpec", "axes:o parameters:c", system="twisted-top", axes=axes, t_end=10, parameters=parameters)


def _of_noise(add, run):
    noise = {"noises": ["l1", "l2/2"], "inverse_temperature": 0.5, "method": lp.Splitting(step=0.05)}
    add(
        "stochastic.noisy_orbits",
        "starts:S times:o",
        None,
        ROUND.component_names,
        **run,
        **noise,
        times=TIMES,
        increments=2,
    )
    until = {**run, **noise, "t_end": 5}
    names = ("starts:S", None, ROUND.component_names)
    add("stochastic.noisy_exponents", *names, **until, n_blocks=8)
    add("stochastic.first_passages", *names, **until, function="l3")
    add("stochastic.NoisySystem", "noises:o", system=ROUND, noises=["l1", "l2/2"], inverse_temperature=0.5)
    counted = {"edges": [-1.0, 0.0, 1.5], "transient": 1, "n_samples": 16}
    add("stochastic.stationary_law", "starts:S edges:o", None, ROUND.component_names, **until, function="l3", **counted)


def _of_runs(add):
    run = {"system": TOP, "starts": X}
    thresholds = {"growth_power": (2.0, 3.0), "megno": (2.5, 5.0), "sali": (1e-3, 1e-8)}
    add("chaos.Rule", "growth_power:o megno:o sali:o", **thresholds)
    later, rule = {"times": [1.0, 2.0]}, lp.chaos.Rule(megno=(3.0, 5.0))
    add("chaos.alignment", "starts:S times:1 units:N", **run, **later, units=TANGENT, n_vectors=3, within="space")
    add("chaos.agreement", "", verdict=lp.decide(TOP, [X, X[::-1]], t_end=20))
    add("chaos.decide", "starts:S", **run, t_end=20, rule=rule)
    of_each = {"leaf": lp.Leaf.through(RIGID, Y), "n_starts": 3, "t_end": 5, "rule": rule, "confidence": 0.9}
    add("chaos.exponents_by_energy", "energies:1", system=RIGID, energies=[2.0, 3.0], **of_each)
    add("chaos.finite_time_exponents", "starts:S times:1 tangents:N", **run, **later, tangents=TANGENT, seed=2**100)
    signal = {"t_end": 10, "n_samples": 64, "window_order": 2}
    add("chaos.frequency_drift", "starts:S observable:t", **run, observable=["l1", "l2*l3"], **signal)
    add("chaos.lyapunov_exponent", "starts:S", **run, t_end=20, wanted_error=0.5, block=0.25, transient=3)
    structure = lp.chaos.PoissonStructure([5], [3], [True])
    vectors = {"n_exponents": 9, "covariant": True, "structure": structure}
    add("chaos.lyapunov_spectrum", "starts:S", **run, t_end=7.3, interval=1.1, transient=2.3, **vectors)

    @functools.wraps(lp.lyapunov_spectrum)
    def residuals(**options):
        return lp.lyapunov_spectrum(**options).residuals

    add("chaos.lyapunov_spectrum:residuals", "", None, (), residuals, **run, t_end=5)
    _of_noise(add, {"system": ROUND, "starts": [0.5, -0.25, 1.0]})
    add("chaos.megno", "starts:S tangents:N", **run, t_end=5, n_samples=64, tangents=TANGENT)
    curves = {"time": CURVE, "exponent": exponents()}
    windows = {"windows": [(2, 90), (3, 80)], "log_windows": [(2, 90)]}
    add("fits.EnsembleReduction", "time:o windows:o log_windows:o", time=CURVE, **windows)
    add("fits.EnsembleReduction.add", "exponent:o", lp.fits.EnsembleReduction(CURVE), exponent=exponents())
    table = {"t": TIMES, "l1": [0.5, 0.5, 0.6], "l2": [-0.25, 0.0, 0.25]}
    add(
        "fits.Observations", "data:v columns:w errors:w", data=table | {"s": [0.1] * 3},
        columns={"l1": "l1", "l2": "l2"}, errors={"l1": "s", "l2": 0.2},
    )  # fmt: skip
    add(
        "fits.orbit_fit", "observed:v unknowns:o starts:S start_time:1 bounds:v", system=TOP, observed=table,
        unknowns=["I3", "l1"], starts=X, start_time=[-0.5], bounds={"I3": (0.5, None)}, most_steps=20,
    )  # fmt: skip
    add("fits.window_grid", "time:o starts:o ends:o", time=CURVE, starts=[2.0, 3.0], ends=[50.0, 90.0])
    add("fits.finite_time_fit", "time:o exponent:o window:o", **curves, window=(2, 90), n_bootstrap=20)
    add("fits.fit_goodness", "time:o exponent:o window:o", **curves, window=(2, 90), n_degrees=4)
    add("fits.log_fit", "time:o exponent:o window:o", **curves, window=(2, 90), n_bootstrap=20)
    add("fits.mean_curve", "time:o exponent:o", **curves)
    add("fits.window_scan", "time:o exponent:o windows:o", **curves, windows=[(2, 90), (3, 80)], n_bootstrap=20)
    top, unit = lp.Top.lagrange(transverse=2, axial=1, a3=1), (1.0, 0, 0, 0)
    add("methods.LagrangeMap.integrals", "states:N", lp.methods.LagrangeMap(0.1), top=top, states=X)
    back = {"times": [1.0, 0.5, -2.0], "dense": True}
    add("orbits.attitude", "starts:S times:1 attitude:o", system=RIGID, starts=Y, attitude=unit, **back)
    add("orbits.chart_orbit", "start:N times:1", chart=lp.charts.EulerChart(RIGID, state=Y), start=Y, times=TIMES)
    add("orbits.integrate", "starts:S times:1 tangents:N", **run, **back, tangents=[X, X[::-1]], kernel="lanes")


def _of_orbits_and_sections(add):
    run = {"system": TOP, "starts": X}
    rod = {"system": lp.Top.twisted(inertia=(1, 1, 2), a=(0, 0, 1), epsilon=1), "starts": Y, "arclengths": TIMES}
    add("orbits.rod", "starts:S arclengths:1 attitude:o origin:o", **rod, attitude=(1.0, 0, 0, 0), origin=(1.0, 2, 3))
    heavy = lp.catalog.system("heavy-top")
    reversers = list(lp.systems.discrete_symmetries(heavy).reversers[:1])
    search = {"system": heavy, "leaf": {"C1": 0.2, "C2": 1}, "energy": 1.5, "n_starts": 1, "t_end": 1}
    add("orbits.symmetric_periodic_orbits", "leaf:v reversers:o", **search, reversers=reversers)
    level = {"leaf": {"C1": 0.0, "C2": 1.0}, "energy": -0.5}
    add("orbits.periodic_orbit", "leaf:v", system=SPHERICAL, guess=[1.0, 0, 0, 0, 0.1, -1], period=6.5, **level)
    add("orbits.periodic_orbits", "leaf:v", **search)
    near = {"system": SPHERICAL, "guesses": [1.0, 0, 0, 0, 0.1, -1], "periods": [6.5]}
    words, names = "leaf:v guesses:S periods:1", SPHERICAL.component_names
    add("orbits.periodic_orbits:guesses", words, None, names, **near, **level)
    sleeping, middle = lp.Top.lagrange(transverse=1, axial=1, a3=1), [2.0, 0, 0, 0, 0, -1, 0, 0, 0]
    splits = {"system": sleeping, "starts": middle, "perturbation": "l1*l2", "integrals": ["l3"]}
    upright = lp.phase_space.equilibrium(sleeping, [0, 0, 0, 0, 0, 1, 0, 0, 0])
    add("orbits.melnikov", "starts:S integrals:o", **splits, origin=upright)
    add("orbits.time_scale", "starts:S", **run)
    well = lp.System(lp.canonical(1), "dot(p, p)/2 - q1^2/2 + q1^4/4")
    saddle, bottom = (lp.phase_space.equilibrium(well, [q, 0]) for q in (0, 1))
    add("orbits.connecting_orbits", "", source=saddle, n_starts=8)
    add("orbits.invariant_manifold", "", base=saddle)
    add("orbits.symmetric_periodic_orbits:some", "", system=well, leaf={}, energy=1, n_starts=4)
    add("orbits.orbit_family", "", system=well, start=bottom, max_orbits=2)
    add("orbits.symmetric_homoclinic_orbits", "", origin=saddle, n_starts=8)
    crossed = {"surface": "dot(l, beta) + l3", "t_end": -20, "direction": -1}
    add("sections.first_return", "starts:S", **run, **crossed)
    back, pendulum = lp.sections.return_map(HENON, "x", t_end=100), lp.sections.return_map(SPHERICAL, "l1", t_end=50)
    inside, point, given = HENON.component_names, {"states": [0.0, 0.1, 0.3, 0.1]}, {"coordinates": ["y", "p_y"]}
    add("results.ReturnMap.orbit", "states:S", back, inside, **point, n_returns=2)
    add("results.ReturnMap.derivative", "states:S coordinates:o", back, inside, **point, **given)
    add("results.ReturnMap.density", "states:S coordinates:o", back, inside, **point, **given)
    add("results.ReturnMap.exponents", "states:S", back, inside, **point, n_returns=2)
    add("results.ReturnMap.cycles", "leaf:v", pendulum, **level, n_starts=1)
    add("sections.return_map", "", system=HENON, surface="x", t_end=100)
    add("sections.is_folded", "states:N", system=TOP, states=crossings().state[:3], surface="l3", x="l1", y="l2")
    kept = {"n_crossings": 2, "start_side": [1], "keep": ["l1", "alpha2*l3"]}
    add("sections.section", "starts:S start_side:1 keep:o", **run, **crossed, **kept)
    add(
        "sections.section_state", "coordinates:v guess:S", None, heavy.component_names, surface="l3", energy=1.5,
        leaf=lp.Leaf(heavy, {"C1": 0.5, "C2": 1}), coordinates={"l1": 0.2}, guess=[0.2, 1, 0, 0, 0, 1],
    )  # fmt: skip


def _of_leaves_and_charts(add):
    leaf, values, charts = lp.Leaf.through(RIGID, Y), {"C1": 3, "C2": 1, "C3": 2}, lp.charts
    casimirs = {name: float(f(np.array(Y))) for name, f in RIGID.functions.casimirs.items()}
    add("phase_space.Leaf", "casimirs:v", system=RIGID, casimirs=casimirs)
    for name in ("contains", "residual", "tangent_basis"):
        add(f"phase_space.Leaf.{name}", "states:N", leaf, states=Y)
    add("phase_space.Leaf.project", "states:N", leaf, states=Y, energy=2)
    add("phase_space.Leaf.project_tangent", "states:N vectors:N", leaf, states=Y, vectors=X, energy=True)
    add("phase_space.Leaf.tangent_projector", "states:N", leaf, states=Y, energy=True)
    add("phase_space.Leaf.through", "state:N", system=RIGID, state=Y)
    add("phase_space.bounds", "state:N", system=RIGID, state=Y)
    add("phase_space.bounds:leaf", "leaf:v", system=RIGID, leaf=casimirs, energy=3)
    lagrange = lp.catalog.system("lagrange")
    along = {"system": lagrange, "along": ["l3"]}
    level = {"leaf": {"C1": 0.5, "C2": 1}, "values": {"l3": 0.5}, "n_starts": 4}
    add("phase_space.equilibria", "leaf:v along:o values:v", **along, **level)
    six = lagrange.component_names
    add("phase_space.equilibrium", "state:N along:o", None, six, **along, state=[0, 0, 2, 0, 0, 1])
    near = {"guess": [0.1, 0, 2, 0.3, 0, 0.9], "values": {"l3": 2}}
    add("phase_space.equilibrium_near", "guess:N along:o values:v", None, six, **along, **near)
    at_rest = lp.phase_space.equilibrium(lagrange, [0, 0, 3, 0, 0, 1])
    add("phase_space.equilibrium_family", "", system=lagrange, start=at_rest, along="C1", max_equilibria=2)
    add("phase_space.sleeping_top", "", system=lp.Top.lagrange(), l3=3, alpha3=1)
    add("phase_space.find_start", "guess:S leaf:v", system=RIGID, guess=Y, leaf={"C1": 3, "C2": 1})
    add("phase_space.find_start:start", "start:S", system=RIGID, start=Y)
    twisted = lp.Top.twisted_lagrange(transverse=2, axial=1, a3=1, epsilon=1)
    ordinary = {"system": lp.Top.lagrange(transverse=2, axial=1, a3=1), "state": X}
    add("charts.EulerChart", "leaf:v gauge:t", system=RIGID, leaf=values, gauge=[(1, 0, 0), (0, 1, 0)])
    add("charts.QuaternionChart", "leaf:v", system=RIGID, leaf=values)
    add("charts.ReducedLagrange", "leaf:v", system=twisted, l3=1, leaf=values)
    for name, given in {
        "EulerChart": {"system": RIGID, "state": Y}, "QuaternionChart": {"system": RIGID, "state": Y},
        "ReducedLagrange": {"system": twisted, "state": Y}, "OrdinaryLagrange": ordinary,
    }.items():  # fmt: skip
        chart, body = getattr(charts, name)(**given), {"states": given["state"]}
        add(f"charts.{name}" + ("" if given is ordinary else ":state"), "state:N", **given)
        add(f"charts.{name}.from_body", "states:N", chart, **body)
        add(f"charts.{name}.margins", "states:N", chart, **body)
        angle = {"psi": np.array(0.5)} if "Lagrange" in name else {}
        own = {"z": tuple(chart.component_names)}
        z = chart.from_body(given["state"])
        add(f"charts.{name}.to_body", "z:N psi:1" if angle else "z:N", chart, own, z=z, **angle)


def _of_damping(add):
    diagonal, further = range(1, 7), {"parameters": {"g": "1/10", "h": 2}, "symbols": ["k"]}
    six, words = lp.catalog.system("lagrange"), "parameters:c symbols:o"
    damping = lp.dissipation.Damping("double bracket", "g*h + k")
    add("dissipation.DampedSystem", words, undamped=six, damping=damping, **further)
    of_form = {"system": six, "rate": "g*h + k", "metric": diagonal, **further}
    add("dissipation.double_bracket", f"metric:N {words}", None, six.component_names, **of_form)
    forms = (range(1, 7), range(2, 8))
    options = {"system": six, "entropy": "C1", "rate": "g*h + k", **further}
    add("dissipation.metriplectic", f"forms:o {words}", forms=forms, **options)
    add("dissipation.metriplectic:metric", f"metric:N {words}", None, six.component_names, metric=diagonal, **options)
    still = lp.System(lp.so(3) @ lp.trivial(), "dot(l, l)/2 + l3")
    matrix = {"system": still, "entropy": "C1", "matrix": [[0, 0, 0], [0, 0, 0], [0, 0, 0]]}
    add("dissipation.metriplectic:matrix", "matrix:o", **matrix)
    states = [0.1, 0, 2, 0.3, 0, 0.9]
    damped = lp.dissipation.double_bracket(six)
    partial = lp.dissipation.double_bracket(PARTIAL)
    add("dissipation.DampedSystem.without_value", "states:N", partial, states=X)
    for name in ("one_way_values", "invariant_values", "vector_field"):
        add(f"dissipation.DampedSystem.{name}", "states:N", damped, six.component_names, states=states)
    right = {"time": 0.0, "state": states}
    add("dissipation.DampedSystem.right_hand_side", "state:N", damped, six.component_names, **right)
    add("dissipation.relax", "start:S along:v", None, six.component_names, system=six, start=states, along={"l3": 0.5})


def _of_integrals(add):
    of = lp.integrability
    search = {"system": FREE, "degree": 1, "on": ["C1 = 1"], "known": {"H": FREE.hamiltonian}}
    family = {"system": lp.System(E3, "(l1^2 + l2^2 + J*l3^2)/2 + a*alpha1", symbols=["J", "a"]), "degree": 1}
    axial = lp.System(E3, "(l1^2 + l2^2)/4 + l3^2/2 + alpha3")
    commuting = {"H": axial.hamiltonian, "l3": "l3"}
    add("integrability.certificate", "commuting:v", system=axial, commuting=commuting)
    add("integrability.darboux_polynomials", "on:e known:v", **search, field="real")
    rotor = lp.System(lp.so(3) @ lp.semidirect(2), "(l1^2 + l2^2)/4 + l3^2/2 + alpha3 + k*l3", symbols=["k"])
    deformed = {"system": rotor, "parameter": ["k"], "degree": 1, "integrals": {"l3": "l3"}}
    add("integrability.deformations", "parameter:t integrals:v", **deformed)
    names = E3.coordinate_names_in_order
    add("integrability.argument_shift", "point:N", None, names, bracket=E3, point=[1, 2, 3, 0, 1, 1])
    add("integrability.first_integrals", "on:e known:v", **search)
    symmetries = [{"l1": "-l1"}, "l3"]
    general = {"bracket": lp.so(3) @ lp.trivial(), "degree": (1, 2), "symmetries": symmetries}
    add("integrability.general_system", "degree:1 symmetries:t", **general)
    conditions = {"positive": ["J"], "nonzero": ["a"]}
    add("integrability.integrable_families", "on:e positive:o nonzero:o", **family, on=["C1 = 0"], **conditions)
    add("integrability.known_lax_pair", "parameters:c", system="lagrange", parameters={"I": (2, 2, 1)})
    symbolic = lp.System(E3, "dot(l, inv(I)*l)/2 + a3*alpha3", symbols=["I[3]", "a3"])
    given = {"system": symbolic, "degree": 1, "nonzero": ["a3"], "positive": ["I1", "I2", "I3"]}
    add("integrability.lax_families", "nonzero:o positive:o", **given)
    rotor = lp.System(lp.so(3) @ lp.trivial(), "l1^2 + l2^2/2")
    add("integrability.lax_pair", "L:o M:o", system=rotor, L=["l1", "l2", "l3"], M=["2*l1", "l2", 0])
    airy = {"matrix": [[0, 1], ["x", 0]], "variable": sympy.Symbol("x")}
    add("integrability.linear_system", "matrix:o names:o", **airy, names=["u", "v"])
    add("integrability.monodromy", "corners:o", system=of.linear_system(**airy), corners=[1, 1j, -1, -1j])
    add("integrability.painleve_test", "weights:w", system=FREE, weights={"l1": 1, "l2": 1, "l3": 1})
    x, free, saddle = sympy.Symbol("x"), FREE.component_names, lp.System(lp.canonical(1), "(p1^2 - q1^2)/2")
    along = {"system": saddle, "state": [x, x], "variable": x, "rate": x}  # where x is exp(t)
    add("integrability.particular_solution", "state:S", None, ("q1", "p1"), **along)
    file = Path(tempfile.mkdtemp()) / "certificate.json"
    add(
        "integrability.save_certificate", "data:v", None, (), lambda data: of.save_certificate(data, file),
        data=of.certificate(axial, commuting),
    )  # fmt: skip
    add("integrability.scan_integrals", "axes:v on:e", **family, axes={"J": [1, 2], "a": [1]}, on=["C1 = 0"])
    box, point = [0.5, 0.25, 1], {"C1": 1}
    cube, around = lp.proofs.Box([0, 0, 0], [1, 1, 1]), lp.proofs.Box.around([0, 0, 1], 0.25)
    add("proofs.Box", "lower:o upper:o", lower=[0.0, 1.0], upper=[1.0, 2.0])
    add("proofs.Box.around", "center:o radius:1", center=[0.0, 1.0], radius=[1.0, 2.0])
    add("proofs.Box.contains", "values:o", cube, values=box)
    add("proofs.Box.overlaps", "other:o", cube, other=box)
    add("proofs.enclose_equilibria", "level:v", system=FREE, box=around, level=point)
    add("proofs.enclose_equilibria:box", "box:N", None, free, system=FREE, box=(0.0, 0.0, 1.0), level=point)
    add("proofs.enclose_equilibria:bounds", "", None, (), in_bounds, lower=[-2.0] * 4, upper=[2.0] * 4)
    add("proofs.enclose_flow", "box:N", None, free, system=FREE, box=box, time=0.1)
    add("proofs.enclose_section_map", "box:N", None, free, system=FREE, box=[0.0, 1, 0.5], surface="l1")
    add("proofs.prove_chaos", "arithmetics:o", system=FREE, certificate="/nowhere.json", arithmetics=["balls"])
    add("proofs.find_certificate", "leaf:v", system=FREE, leaf=point, energy=1)
    add("proofs.prove_equilibrium", "guess:N level:v", None, free, system=FREE, guess=[0.0, 0, 1], level=point)
    loop = {"start": [0, -0.1461901394453099, 0.4201732609406907, 0], "period": 6.794384826845275}
    add(
        "proofs.prove_periodic_orbit",
        "start:N level:v",
        None,
        HENON.component_names,
        system=HENON,
        **loop,
        level={"H": "1/10"},
    )


def _of_results(add):
    orbit = lp.integrate(TOP, X, times=TIMES, dense=True)
    shown = {"start": X, "surfaces": ["l1", "l2"]}
    add("laboratory.page_of", "start:N surfaces:t", system=TOP, **shown)
    add(
        "laboratory.view", "start:N surfaces:t state:v", None, TOP.component_names, view, shown=TOP, **shown,
        state={"time": 2},
    )  # fmt: skip
    growth = lp.chaos.megno(TOP, [X, X[::-1]], t_end=20, n_samples=64)
    two = {"growth": growth, "angle": lp.chaos.alignment(TOP, [X, X[::-1]], t_end=20)}
    add("plot.exponent_distribution", "exponents:o bins:1", exponents=exponents()[:, -1], bins=[0.0, 0.1, 0.2])
    add("plot.indicators", "members:o labels:o", **two, members=[1, 0], labels=["u", "v"])
    add("plot.indicators:axes", "axes:o", None, (), into_clear_axes, **two, axes=list(panels()))
    add("plot.orbit:values", "", None, (), with_an_invariant, values=[1.0, 1.1, 1.3])
    add("plot.orbit", "invariants:v", run=orbit, invariants={"K": orbit.invariants["H"][0]})
    stem = Path(tempfile.mkdtemp()) / "figure"
    add("plot.save_figure", "formats:o", figure=lp.plot.orbit(orbit), stem=stem, formats=["png"])
    points = {"points": crossings(), "x": crossings().state[:, 0], "y": crossings().state[:, 1]}
    add("plot.section", "x:o y:o trajectories:1 colour:t", **points, trajectories=[0], colour=["red"])
    add("plot.sleeping_diagram", "twists:o", twists=[0, 1])
    fits, curves = lp.fits, {"time": CURVE, "exponent": exponents(), "window": (2, 90), "n_bootstrap": 20}
    fit, logarithmic = fits.finite_time_fit(**curves), fits.log_fit(**curves)
    add("plot.window_scan", "fits:o", fits=[fit])
    attitude = lp.orbits.attitude(RIGID, Y, times=TIMES, dense=True)
    add("results.Attitude.at", "times:o", attitude, times=TIMES)
    add("results.Attitude.body", "vectors:o", attitude, vectors=(1.0, 2, 3))
    add("results.Attitude.space", "vectors:o", attitude, vectors=(1.0, 2, 3))
    covariant = lp.lyapunov_spectrum(TOP, X, t_end=8, interval=1, transient=4, covariant=True).covariant
    field = TOP.vector_field(covariant.state)
    add("results.CovariantVectors.distance_from_centre", "vectors:o", covariant, vectors=field, n_zeros=5)
    add("results.ExponentEstimate.quantiles", "q:1", lp.lyapunov_exponent(TOP, X, t_end=20), q=[0.5, 0.75])
    names = ("lambda", "c1", "c0")
    add("results.FiniteTimeFit.chi_squared", "coefficients:N", fit, names, coefficients=(0.1, 1.0, 0.5))
    add("results.FiniteTimeFit.curve", "time:1", fit, time=[2.0, 3.0])
    add("results.LogFit.curve", "time:1", logarithmic, time=[2.0, 3.0])
    pair = lp.integrability.known_lax_pair("lagrange")
    well = lp.System(lp.canonical(2), "(dot(p, p) - dot(q, q))/2 + q1^4", name="hill")
    manifold = lp.orbits.invariant_manifold(lp.phase_space.equilibrium(well, [0] * 4))
    add("results.InvariantManifold.at", "directions:o phases:1", manifold, directions=[1.0, 0.5], phases=0.0)
    add("results.LaxPair.spectral_curve", "point:w", pair, point=dict.fromkeys(pair.system.component_names, "1/2"))
    add("results.Orbit.at", "times:1", orbit, times=[0.1, 0.2])
    add("results.Orbit.go_on", "times:1", orbit, times=[0.75, 1.0])
    family = lp.System(E3, "(l1^2 + l2^2 + J*l3^2)/2 + a*alpha1", symbols=["J", "a"])
    case = lp.integrability.integrable_families(family, degree=1, positive=["J"]).cases[1]
    add("results.ParameterCase.holds_at", "values:v", case, values={"J": 1, "a": 0})
    sleeping = lp.phase_space.sleeping_top(lp.Top.lagrange(transverse=2, axial=1, a3=1), l3=5, alpha3=1)
    add("results.SleepingTop.analysis", "along:o", sleeping, along=["l3"])


def _of_tori(add):
    pendulum = lp.catalog.system("spherical-pendulum")
    on = {"states": (0.3, 0.8, 0.2, 0.8, 0, 0.6)}
    momentum = lp.tori.momentum_map(pendulum)
    coordinates = pendulum.bracket.coordinate_names_in_order
    names = {"state": coordinates, "states": coordinates, "value": ("H", "l3"), "loop": ("H", "l3")}
    add("tori.momentum_map", "integrals:o", system=pendulum, integrals=["l3"])
    add("tori.critical_equations", "casimirs:v integrals:o", system=pendulum, casimirs={"C1": 0}, integrals=["l3"])
    for method in ("fields", "derivatives", "rank"):
        add(f"results.MomentumMap.{method}", "states:N", momentum, names, **on)
    add(
        "results.MomentumMap.flow", "states:N times:N", momentum, names | {"times": ("H", "l3")}, **on, times=(0.5, 1.0)
    )
    torus = {"system": pendulum, "state": on["states"], "integrals": ["l3"]}
    add("tori.period_lattice", "state:N integrals:o", None, names, **torus)
    loop = [[0.0, 0.2], [0.2, 0.2], [0.2, 0.1]]
    add("tori.monodromy", "state:N loop:N integrals:o", None, names, **torus, loop=loop)
    run = lp.integrate(pendulum, on["states"], t_end=5)
    plane = ("alpha1", "alpha2")
    add("tori.rotation_number", "plane:o center:N", None, plane, orbit=run, plane=plane, center=(0.1, 0.2))
    square = [[1.0, 0.1], [0.1, 1.0], [-1.0, 0.1], [0.1, -1.0], [1.0, 0.2]]
    add("tori.rotation_number:of points", "orbit:o", orbit=square, center=(0, 0))
    leaf = lp.Leaf(pendulum, {"C1": 0, "C2": 1})
    add("tori.fibre", "value:N", None, names, leaf=leaf, value=[0.5, 0.2], n_states=5)
    plane = lp.tori.diagram(leaf, energy_max=2, n_starts=20)
    add("tori.regions", "", found=plane, n_values=50, n_states=5)
    add("tori.critical_states", "", leaf=leaf, n_starts=10)
    add("tori.molecule", "", leaf=leaf, energy=0, n_starts=20)
    toda = lp.Leaf(lp.catalog.system("toda"), {})
    add("tori.diagram", "at:v", leaf=toda, at={"P": 0}, energy_max=3.2, n_starts=2)
    add("plot.diagram", "found:1 regions:o", found=plane, regions=list(lp.tori.regions(plane, n_values=50, n_states=5)))
    diagram = round_diagram()
    add("tori.lagrange_diagram", "", leaf=diagram.leaf)
    given = {"values": [3.0, 0.5, 0.2]}
    for method in ("depth", "sextic"):
        add(f"results.LagrangeDiagram.{method}", "values:N", diagram, diagram.integrals, **given)
    for function in ("lagrange_lattice", "lagrange_actions"):
        add(f"tori.{function}", "values:N", None, diagram.integrals, diagram=diagram, **given)
    thread = diagram.threads[0]
    add("tori.thread_loop", "base:N", None, diagram.integrals, diagram=diagram, thread=thread, base=given["values"])
    loop = lp.tori.thread_loop(diagram, thread)
    add("tori.lagrange_monodromy", "loops:o", None, diagram.integrals, diagram=diagram, loops=[loop])
    add("tori.lagrange_monodromy:of a loop", "", None, (), around_a_loop, loop=loop)


@cache
def round_diagram():
    return lp.tori.lagrange_diagram(lp.Leaf(lp.Top.twisted_lagrange(), {"C1": 0.5, "C2": 0.2, "C3": 1}))


@cache
def result_of(key):
    """What a call of the table returns, made once for all tests that look at it: results do not change."""
    row = rows()[key]
    return row.function(**row.arguments)


@cache
def makers():
    """The public functions that make results with numbers, by what they say that they return."""
    found = []
    for dotted in public_names().callables():
        chapter, *names = dotted.split(".")
        value = getattr(public_names().chapters()[chapter], names[0])
        if len(names) == 1 and chapter not in {"integrability", "results"} and inspect.isfunction(value):
            says = str(inspect.unwrap(value).__annotations__.get("return"))
            if {*re.findall(r"\w+", says)} & {*lp.results.__all__}:
                found.append(dotted)
    return found


@cache
def keys_made():
    """The names in the table of the calls of what is repeated from a file, by the kind of the result."""
    named = {key.partition(".")[2]: key for key in rows() if not key.startswith("plot.")}
    missing = {kind for kind, one in RUNS.items() if one.made_by not in named}
    assert not missing, f"no call in public_calls.py makes {', '.join(missing)}"
    return {kind: named[one.made_by] for kind, one in RUNS.items()}


def made():
    """These calls."""
    return {kind: rows()[key] for kind, key in keys_made().items()}


@cache
def crossings():
    return lp.section(TOP, X, surface="l3", t_end=20)


@cache
def exponents():
    rng = np.random.default_rng(1)
    return 0.1 + 1 / CURVE + 0.001 * rng.standard_normal((40, len(CURVE)))


@cache
def public_names():
    spec = importlib.util.spec_from_file_location("public_names", DOCS / "public_names.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@cache
def several(words=SEVERAL):
    """The arguments of each public function whose annotations have such words, by default those of several values."""
    found, known = {}, set()
    for dotted in public_names().callables():
        value = public_names().chapters()[dotted.split(".")[0]]
        for part in dotted.split(".")[1:]:
            value = getattr(value, part)
        function = inspect.unwrap(getattr(value, "__func__", value))
        if not str(getattr(function, "__module__", "")).startswith("liepoisson") or function in known:
            continue  # inherited from elsewhere, or met under another name
        known.add(function)
        if (isinstance(value, type) and issubclass(value, Exception)) or dotted in NOT_READ:
            continue
        parameters = inspect.signature(function).parameters.values()
        names = {one.name for one in parameters if words.search(str(one.annotation))} - {"root"}
        if names:
            found[dotted] = names
    return found
