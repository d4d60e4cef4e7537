"""What systems, their functions and their charts refuse: a call, the type of its error, and the words that help."""

import numpy as np
import pytest
import sympy as sp
import sympy.vector

import liepoisson as lp
from liepoisson.errors import (
    BracketError,
    ChartError,
    ExpressionError,
    MissingFileError,
    OutputError,
    ParameterError,
    ShapeError,
    SystemFileError,
)
from liepoisson.model.canonical_system import CanonicalSystem
from liepoisson.model.constructors import read_algebra, read_extension
from liepoisson.model.system_file_reader import read_system_file
from liepoisson.model.system_text import system_text
from liepoisson.systems import discrete_symmetries, write_system

SO3, HEAVY, TWISTED = lp.so(3) @ lp.trivial(), lp.so(3) @ lp.semidirect(2), lp.so(3) @ lp.leibniz(3, "epsilon")
l1, l2, l3 = SO3.variables
k, m, t = sp.symbols("k m t")
EULER, KOVALEVSKAYA = lp.System(SO3, "l1^2 + 2*l2^2 + 3*l3^2"), lp.Top.kovalevskaya()
CHARGED = lp.System(TWISTED, "dot(l, l)/2 + k*alpha1", symbols=["k"])
SLOPE = KOVALEVSKAYA.functions.of("l1 - alpha2/3")
TOP = lp.Top(inertia=(1.3, 0.9, 0.7), a=(0.3, -0.5, 0.8), b=(0.2, 0.1, -0.4), epsilon=0.7)
LAGRANGE = lp.Top(inertia=(1.2, 1.2, 0.7), a=(0, 0, 0.8), b=(0, 0, -0.4), epsilon=1)
X = np.array([0.3, -0.4, 0.5, 0.7, 0.2, -0.3, 0.1, 0.9, 0.4])
ORDINARY = X * [1] * 9
ORDINARY[6:] = 0
TURN, RAISED = np.eye(9)[2] / 10, np.eye(9)[3] / 10
Euler, Quaternion = lp.charts.EulerChart, lp.charts.QuaternionChart
Reduced, Ordinary = lp.charts.ReducedLagrange, lp.charts.OrdinaryLagrange
REDUCED = Reduced(LAGRANGE, state=X)


def of(hamiltonian, *arguments, bracket=HEAVY, **more):
    """A call that makes a system and asks for its Hamiltonian."""
    return lambda: lp.System(bracket, hamiltonian, *arguments, **more).hamiltonian


def canonical(*arguments, **more):
    return lambda: CanonicalSystem(*arguments, **more)


SYSTEMS = [
    *((of(bad), ParameterError, "the Hamiltonian must be") for bad in (3, None, sp.Matrix([1]), int, lp.System)),
    (of(lambda l, alpha: "l1**2"), ParameterError, "must return a SymPy expression; got str"),
    (of(lambda l: l.dot(l)), ParameterError, r"one vector per field, \(l, alpha\)"),
    (of(min), ParameterError, "must take one vector per field"),
    *((of(f), ParameterError, "must compute with SymPy columns; got .*Use functions of SymPy")
      for f in (lambda l, a: np.sin(l[0]), lambda l, a: np.exp(l)[0], lambda l, a: l[0].norm())),
    *((of(l1**2 + c * l2), ParameterError, "must be finite and real")
      for c in (sp.nan, sp.oo, sp.zoo, sp.I, sp.sqrt(-2), sp.Integer(-1) ** sp.Rational(1, 3))),
    (of(lambda l, a: l.dot(l) / m, {"m": 0}), ParameterError, "must be finite and real"),
    (lambda: lp.System(None, "l1"), ParameterError, "bracket: wanted a Bracket; got None"),
    *((of("l1", p), ParameterError, "parameters must be a mapping") for p in (5, ["epsilon"], {1: 2})),
    *((of(lambda l, a, b: l.dot(l), p, bracket=TWISTED), BracketError, rf"\['{name}'\] name both")
      for p, name in (({"l1": 5}, "l1"), ({"epsilon": "beta2"}, "beta2"), ({"m": "alpha3"}, "alpha3"))),
    (of(m * l1, {"n": 1}, symbols=["m"]), ParameterError, "'n' occurs in neither. Known there: .*m"),
    *((of(h, {"k": 2}), ParameterError, "'k' occurs in neither") for h in ("dot(l, l) + k - k", "dot(l, l)*k^0")),
    *((of(l1 * sp.Symbol("k", **a), {"k": v}), ParameterError, r"one that its symbol allows, Symbol\('k', ")
      for a, v in (({"positive": True}, -2), ({"integer": True}, "1/2"), ({"zero": False}, 0))),
    (of("dot(l, l)/2 + gamma[1]"), ExpressionError, "gamma"),
    *((lambda i=i: lp.System(HEAVY, "l1", integrals=i), ParameterError, "integrals")
      for i in (["l3"], "l3", {"K": 3}, {1: "l3"}, {"H": "l3"}, {"C2": "l3"})),
    *((lambda p=p: lp.System(HEAVY, "l1", partial_integrals=p), ParameterError, "partial_integrals")
      for p in (["l3"], {"K": "l3"}, {"K": ("l3",)}, {"H": ("l3", "l1")}, {"K": ("l3", 0)})),
    (lambda: lp.System(HEAVY, "l1^2 + alpha3", integrals={"K": "l1"}).invariants, ParameterError, "K must be constant"),
    *((of("l1", symbols=s), ParameterError, "symbols must be a list") for s in ("qr", "a[3]", [3], 5)),
    *((lambda s=s: lp.System(SO3, "l1", source=s), ParameterError, "source: wanted a text") for s in ("", "  ", 3)),
    *((lambda f=f: f(np.ones(9)), ParameterError, "none for (k, epsilon|epsilon, k|epsilon)")
      for f in (CHARGED.vector_field, CHARGED.functions.poisson_tensor)),
    *((lambda f=f: lp.systems.PhaseFunction(lp.Top.lagrange(), f), error, words)
      for f, error, words in ((3, ParameterError, "a text such as"), ("l4", ExpressionError, "'l4' is unknown"),
                              ("__import__('os')", ExpressionError, ""), ("", ExpressionError, ""))),
    (CHARGED.field, ParameterError, "must be a number.*free symbol"),
    *((lambda f=f, s=s: f(np.zeros(s)), ShapeError, rf"9 components \(l, alpha, beta\); got shape .*{hint}")
      for f in (TOP.vector_field, TOP.invariant_values)
      for s, hint in (((9, 128), r"Transpose it\?"), ((3,), ""), ((), ""))),
    (lambda: KOVALEVSKAYA.expression("K - 1"), ExpressionError, r"Build the expression from system.invariants\['K'\]"),
    (lambda: KOVALEVSKAYA.expression("K2"), ExpressionError, "unknown"),
    *((lambda f=f, bad=bad: f(bad), ParameterError, "must be a text")
      for f in (KOVALEVSKAYA.expression, KOVALEVSKAYA.functions.of)
      for bad in (None, 3, ["l1"], SLOPE.gradient, KOVALEVSKAYA)),
    (lambda: EULER.functions.of(10**400 * l2**2)(np.ones(3)), ParameterError, "fit into doubles .*Rescale the system"),
    (lambda: EULER.functions.of(10**400 * l2**2).gradient(np.ones(3)), ParameterError, "fit into doubles"),
    (lambda: discrete_symmetries(EULER, most=3), ParameterError, "more than 3"),
    (lambda: discrete_symmetries(EULER)[0](np.zeros(4)), ShapeError, "3"),
]  # fmt: skip
CANONICAL = [
    *((canonical(q, p, "p^2"), ShapeError, "one momentum for each")
      for q, p in ((["x"], ["p", "u"]), ([], []), ("x", "p"), (None, ["p"]), (["x"], 3), ([1], ["p"]))),
    (canonical(["x"], ["x"], "x^2"), ParameterError, "given twice"),
    (canonical(["x 1"], ["p"], "p^2"), ParameterError, "letters, digits"),
    (canonical(["x"], ["p"], "p^2 + abs(x)"), ExpressionError, "not smooth"),
    (canonical(["x"], ["p"], "p^2 + y"), ExpressionError, "unknown"),
    (canonical(["x"], ["p"], 3), ParameterError, "must be a text, a SymPy expression"),
    (canonical(["x"], ["p"], "p^2", quadratures=["x"]), ParameterError, "wanted a mapping from names to rates"),
    *((canonical(["x"], ["p"], h, quadratures={"a": r}), ParameterError, f"{what} must be a function of the coord")
      for h, r, what in (("p^2 + a*x", "x", "the Hamiltonian"), (sp.Symbol("a"), "x", "the Hamiltonian"),
                         ("p^2", "x*a", "the rate of a"), ("p^2", sp.Symbol("a"), "the rate of a"))),
    (lambda: CanonicalSystem(["x"], ["p"], "p^2 + k*x", symbols=["k"]).field(), ParameterError, "none for k"),
    (lambda: CanonicalSystem(["x"], ["p"], "p^2").function_tape("phi"), ExpressionError, "phi"),
    (of("p_x^2 + p_z^2", bracket=lp.canonical(names=["x", "y"])), ExpressionError, "Did you mean"),
    (of("2^x + p_x^2", bracket=lp.canonical(names=["x", "y"])), ExpressionError, "exponent"),
    (of("p_x^2 + x", {"x": 2}, bracket=lp.canonical(names=["x"])), BracketError, "rename the parameters"),
]  # fmt: skip
CONSTRUCTORS = [
    *((lambda text=text: read_algebra(text), ExpressionError, words) for text, words in (
        ("so", r"Write for example so\(\.\.\.\)"), ("3", r"Write for example so\(3\)"), ("sos(3)", "Did you mean so"),
        ("so(3) + eval(1)", "'eval' is unknown"), ("so(3) - so(3)", "direct sum"), ("so()", "arguments"),
        ("so(3)*so(3)", "must be a name with its arguments"), ("so(1, 2, 3)", "so"), ("su(n)", "'n' is unknown"),
        ("su(1/2)", "su"), ("su(10^9)", "1000 dimensions"), ("so(-3)", "so"))),
    *((lambda text=text: read_extension(text), ExpressionError, "leibniz|epsilon")
      for text in ("leibniz(0, 1)", "leibniz(3, epsilon)", "leibniz", "leibnitz(3)", "leibniz(10^8)")),
]  # fmt: skip
CHARTS = [
    *((lambda g=g: Euler(TOP, gauge=g), ParameterError, words) for g, words in (
        ("e3, e4", "two of the axes"), ("e3", "two of the axes"), (3, "two of the axes"),
        ("e3, e3", "e_par.e_perp = 1"),
        (((1, 1, 0), (0, 0, 1)), "e_par.e_par = 2"), (((1, 0, 0), (1e-9, 1, 0)), "orthonormal"))),
    (lambda: Euler(TOP, state=X, leaf={"C1": 1, "C2": 0, "C3": 1}), ParameterError, "got both"),
    (lambda: Euler(TOP, state=X, leaf=lp.Leaf.through(TOP, X)), ParameterError, "got both"),
    *((lambda c=c: Euler(TOP, leaf=c), ParameterError, "C1, C2 and C3|must be a Leaf; got")
      for c in ({"C1": 1}, [1, 2, 3], 3, "C1")),
    (lambda: Euler(LAGRANGE, leaf=lp.Leaf.through(TOP, X)), ParameterError, r"epsilon = 1; it has epsilon = 0\.7"),
    *((lambda f=f: Euler(TOP, state=X).from_body(X * f), ParameterError, "other units") for f in (1e300, np.inf)),
    (lambda: Euler(TOP, state=[X, X]), ShapeError, r"one state of shape \(9,\)"),
    (lambda: Euler(lp.catalog.system("manakov-so4")), ParameterError, "charged and the twisted top"),
    (lambda: Euler(TOP, state=X).to_body(X), ShapeError, "6 components"),
    (lambda: Euler(TOP).from_body(X), ParameterError, "v must be a number"),
    (Euler(TOP).system.field, ParameterError, "eta"),
    (lambda: Euler(TOP, leaf={"C1": 1, "C2": 0, "C3": 0}), ChartError, "C3 = 0"),
    (lambda: Euler(TOP, state=ORDINARY), ChartError, "OrdinaryLagrange"),
    (lambda: Euler(TOP, leaf=lp.Leaf.through(TOP, ORDINARY)), ChartError, "integrate the top itself"),
    (lambda: Quaternion(TOP, state=ORDINARY), ChartError, "beta"),
    (lambda: Quaternion(TOP, state=X).to_body(np.zeros(10)), ChartError, "quaternion that is not zero"),
    (lambda: Quaternion(TOP, state=X).from_body(np.zeros(9)), ChartError, "beta != 0"),
    (lambda: Quaternion(TOP, state=X).from_body(X * 1.1), ChartError, "a constant of the chart"),
    (lambda: Quaternion(lp.Top.charged_heavy((1, 2, 2), (1, 0, 0), (0, 0, 0)), leaf={"C1": 0, "C2": 1, "C3": 1}),
     ChartError, "got C1 = 0, C2 = 1, C3 = 1"),
    *((lambda f=f, c=c: f(X * c), ParameterError, r"up to 1e\+75; got .* in other units")
      for f in (Quaternion(TOP, state=X).from_body, Quaternion(TOP, state=X).margins)
      for c in (1e76, 1e300, np.inf, -np.inf)),
    (lambda: Quaternion(TOP, state=X).to_body(np.full(10, 1e76)), ParameterError, r"up to 1e\+75"),
    (lambda: Reduced(KOVALEVSKAYA), ParameterError, "needs a Lagrange top"),
    (lambda: Reduced(LAGRANGE, state=X, l3=1), ParameterError, "Leave l3 out"),
    (lambda: Reduced(LAGRANGE, leaf={"C1": 1, "C2": 0, "C3": 1}), ParameterError, "needs l3"),
    (lambda: Reduced(LAGRANGE, leaf=lp.Leaf.through(LAGRANGE, X)), ParameterError, "needs l3 beside the leaf"),
    (lambda: Reduced(LAGRANGE, state=ORDINARY), ChartError, "OrdinaryLagrange"),
    (lambda: REDUCED.to_body(REDUCED.from_body(X)), ParameterError, "not at all"),
    (lambda: REDUCED.to_body(np.array([REDUCED.from_body(X)] * 2), psi=[1.0, 2.0, 3.0]), ShapeError, "psi must have"),
    (lambda: REDUCED.from_body(X + TURN), ChartError, "l3"),
    (lambda: REDUCED.from_body(X * [1, 1, 1, 1, 1, 1, 1.1, 1.1, 1.1]), ChartError, "leaf"),
    (lambda: Ordinary(LAGRANGE, l3=1), ParameterError, "needs l3, l_n and alpha"),
    (lambda: Ordinary(LAGRANGE, state=X), ChartError, "beta = 0"),
    (lambda: Ordinary(LAGRANGE, state=[ORDINARY]), ShapeError, "one state"),
    *((lambda x=x: Ordinary(LAGRANGE, state=ORDINARY).from_body(x), ChartError, words) for x, words in (
        (ORDINARY + TURN, "l3"), (X, "beta"), (ORDINARY + RAISED, "alpha"), ([0, 0, 0.5, 0, 0, 1, 0, 0, 0], "sin.th"),
        ([0, 0, 0.5, 0, 0, 0, 0, 0, 0], "alpha"))),
    (lambda: Ordinary(LAGRANGE, state=ORDINARY).to_body([0.0, 0.1], 0.0), ChartError, "sin.theta."),
]  # fmt: skip


@pytest.mark.parametrize(("call", "error", "words"), [*SYSTEMS, *CANONICAL, *CONSTRUCTORS, *CHARTS])
def test_refusals(call, error, words):
    with pytest.raises(error, match="(?s)" + words):
        call()


STRANGERS = {
    "mistyped": (sp.Symbol("L1"), "got L1, a SymPy Symbol. Did you mean l1?"),
    "field": (sp.Symbol("l"), "got l, a SymPy Symbol. Did you mean l"),
    "unknown": (sp.Symbol("mass") * l1, "got mass, a SymPy Symbol. Known are l1, l2, l3"),
    "indexed": (sp.IndexedBase("l")[1], r"got l\[1\], a SymPy Indexed. Did you mean l1?"),
    "matrix element": (sp.MatrixSymbol("l", 3, 1)[0, 0], r"got l\[0, 0\], a SymPy MatrixElement"),
    "function of time": (sp.Function("l1")(t), r"got l1\(t\), an undefined function. Did you mean l1?"),
    "undefined function": (sp.Function("V")(l1), r"got V\(l1\), an undefined function"),
    "dummy": (sp.Dummy("l1"), "got _l1, a SymPy Dummy. Did you mean l1?"),
    "wild": (sp.Wild("l1"), "got l1_, a SymPy Wild. Did you mean l1?"),
    "vector component": (sympy.vector.CoordSys3D("N").x, "got N.x, a SymPy BaseScalar"),
    "maximum": (sp.Max(l1, l2), r"must be smooth.*got Max\(l1, l2\)"),
    "pieces": (sp.Piecewise((l1, l1 > 0), (0, True)), "must be smooth.*got Piecewise"),
    "absolute value": (sp.Abs(l1), r"must be smooth.*got Abs\(l1\)"),
    "conjugate": (sp.conjugate(l1), "must be smooth"),
    "remainder": (sp.Mod(l1, 2), "must be smooth"),
    "positive": (sp.Symbol("l1", positive=True), r"takes all real values; got Symbol\('l1', positive=True\)"),
    "imaginary": (sp.Symbol("l3", imaginary=True), r"got Symbol\('l3', imaginary=True\)"),
}
DOORS = {
    "system": lambda f: lp.System(SO3, f),
    "system of a function": lambda f: lp.System(SO3, lambda l: f + l[0]),
    "canonical system": lambda f: CanonicalSystem(["l1", "l2", "l3"], ["p1", "p2", "p3"], f),
    "quadrature": lambda f: CanonicalSystem(["l1", "l2"], ["l3", "p2"], "l1", quadratures={"turns": f}),
    "integrals": lambda f: lp.System(SO3, "l1", integrals={"K": f}).integrals,
    "partial integrals": lambda f: lp.System(SO3, "l1", partial_integrals={"K": (l1, f)}).partial_integrals,
    "expression": EULER.expression,
    "derivative": EULER.derivative,
    "is_constant": EULER.is_constant,
    "is_casimir": EULER.is_casimir,
    "function_tape": EULER.function_tape,
    "functions": EULER.functions.of,
    "section": lambda f: lp.section(EULER, [1.0, 2.0, 3.0], surface=f, t_end=1),
    "first_integrals, known": lambda f: lp.integrability.first_integrals(EULER, degree=1, known={"K": f}),
    "first_integrals, on": lambda f: lp.integrability.first_integrals(EULER, degree=1, on=[f]),
    "lax_pair": lambda f: lp.integrability.lax_pair(EULER, L=[[f, 0], [0, 0]], M=[[0, 0], [0, 0]]),
}


@pytest.mark.parametrize(
    ("door", "stranger"), [*(("system", name) for name in STRANGERS), *((door, "mistyped") for door in DOORS)]
)
def test_what_is_neither_coordinate_nor_parameter_is_refused_by_name(door, stranger):
    function, message = STRANGERS[stranger]
    with pytest.raises(ParameterError, match=message):
        DOORS[door](function)


SO3_BRACKETS = {(0, 1): {2: 1}, (0, 2): {1: -1}, (1, 2): {0: 1}}
MADE = {
    "system": lambda name: lp.System(SO3, "dot(l, l)", name=name),
    "canonical system": lambda name: CanonicalSystem(["x"], ["p"], "p^2 + x^4", name=name),
    "top": lambda name: lp.Top(inertia=(2, 2, 1), a=(1, 0, 0), name=name),
    "integral": lambda name: lp.System(SO3, "l1^2", integrals={name: "l1"}),
    "label": lambda name: lp.sweeps.Axis("epsilon", [0, 1], name),
    "sweep": lambda name: lp.sweeps.SweepSpec("kovalevskaya", [lp.sweeps.Axis("epsilon", [0, 1])], 1.0, name=name),
    "Lie algebra": lambda name: lp.LieAlgebra.from_brackets(3, SO3_BRACKETS, name),
    "extension": lambda name: lp.Extension([[[1]]], name),
    "bracket": lambda name: lp.Bracket(lp.so(3), lp.trivial(), name=name),
}


@pytest.mark.parametrize("make", MADE)
def test_names_that_files_and_terminals_would_change_are_refused(make):
    for name in ("", "   ", "\xa0", " a", "a  b", "a\nb", "a\tb", "a\x00b", "a\u202eb", "a\ud800", 3, b"a"):
        with pytest.raises(ParameterError, match=r"wanted (one line of printable|a text)|must be a mapping"):
            MADE[make](name)
    if make not in ("Lie algebra", "extension", "bracket"):
        MADE[make]("a" * 200)
        with pytest.raises(ParameterError, match="at most 200 characters; got 201"):
            MADE[make]("a" * 201)


def test_files_that_can_not_be_read_or_written_are_refused(tmp_path):
    for name, content in (("latin", b'name = "x"\nsource = "Poincar\xe9"\n'), ("large", b"# " + b"x" * 1_000_000)):
        (tmp_path / f"{name}.toml").write_bytes(content)
    (tmp_path / "result.nc").write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(2_000_000))
    large = lp.LieAlgebra.from_brackets(41, {(0, 1): {2: 1}}, "large")
    for call, error, words in (
        (lambda: read_system_file(tmp_path / "missing.toml"), MissingFileError, "no file"),
        (lambda: read_system_file(tmp_path), SystemFileError, "folder"),
        (lambda: read_system_file(tmp_path / "a\0b"), SystemFileError, "cannot be read"),
        (lambda: read_system_file(tmp_path / "latin.toml"), SystemFileError, "line 2: .*UTF-8"),
        (lambda: read_system_file(tmp_path / "large.toml"), SystemFileError, "1000000 bytes"),
        (
            lambda: read_system_file(tmp_path / "result.nc"),
            SystemFileError,
            r"NetCDF file, .* lp\.load\(.*result\.nc'\)",
        ),
        *((lambda p=p: read_system_file(p), SystemFileError, "given by its path") for p in (None, 5, b"top.toml")),
        (lambda: write_system(TOP, tmp_path / "top.txt"), SystemFileError, r"ends in \.toml"),
        (lambda: write_system(TOP, tmp_path / "latin.toml" / "below.toml"), OutputError, "cannot|not"),
        (lambda: system_text(lp.System(large @ lp.trivial(), "l1^2")), SystemFileError, "its dimension 41 is above 40"),
    ):
        with pytest.raises(error, match=words):
            call()
