"""Hamiltonians and other functions that are given as expressions: they may contain what a text may contain."""

import numpy as np
import pytest
import sympy as sp
import sympy.vector

import liepoisson as lp
from liepoisson.errors import ParameterError
from liepoisson.model.canonical_system import CanonicalSystem

so3 = lp.so(3) @ lp.trivial()
l1, l2, l3 = so3.variables
t = sp.Symbol("t")

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
    "sign": (sp.sign(l1), "must be smooth"),
    "floor": (sp.floor(l1), "must be smooth"),
    "remainder": (sp.Mod(l1, 2), "must be smooth"),
    "step": (sp.Heaviside(l1), "must be smooth"),
    "positive": (sp.Symbol("l1", positive=True), r"takes all real values; got Symbol\('l1', positive=True\)"),
    "integer": (sp.Symbol("l2", integer=True), r"got Symbol\('l2', integer=True\)"),
    "imaginary": (sp.Symbol("l3", imaginary=True), r"got Symbol\('l3', imaginary=True\)"),
}

euler = lp.System(so3, "l1^2 + 2*l2^2 + 3*l3^2")

DOORS = {
    "system": lambda f: lp.System(so3, f),
    "system of a function": lambda f: lp.System(so3, lambda l: f + l[0]),
    "canonical system": lambda f: CanonicalSystem(["l1", "l2", "l3"], ["p1", "p2", "p3"], f),
    "quadrature": lambda f: CanonicalSystem(["l1", "l2"], ["l3", "p2"], "l1", quadratures={"turns": f}),
    "integrals": lambda f: lp.System(so3, "l1", integrals={"K": f}).integrals,
    "partial integrals": lambda f: lp.System(so3, "l1", partial_integrals={"K": (l1, f)}).partial_integrals,
    "expression": euler.expression,
    "derivative": euler.derivative,
    "is_constant": euler.is_constant,
    "is_casimir": euler.is_casimir,
    "function_tape": euler.function_tape,
    "functions": euler.functions.of,
    "section": lambda f: lp.section(euler, [1.0, 2.0, 3.0], surface=f, t_end=1),
    "first_integrals, known": lambda f: lp.integrability.first_integrals(euler, degree=1, known={"K": f}),
    "first_integrals, on": lambda f: lp.integrability.first_integrals(euler, degree=1, on=[f]),
    "lax_pair": lambda f: lp.integrability.lax_pair(euler, L=[[f, 0], [0, 0]], M=[[0, 0], [0, 0]]),
}


@pytest.mark.parametrize("stranger", STRANGERS)
@pytest.mark.parametrize("door", DOORS)
def test_what_is_neither_coordinate_nor_parameter_is_refused_by_name(door, stranger):
    function, message = STRANGERS[stranger]
    exact = message if not door.startswith(("canonical", "quadrature")) else message.split(" Known are")[0]
    with pytest.raises(ParameterError, match=exact):
        DOORS[door](function)


@pytest.mark.parametrize(
    "make",
    [
        lambda: lp.System(so3, l1**2 / sp.Symbol("k"), symbols=["k"]),
        lambda: lp.System(so3, lambda l: l[0] ** 2 / sp.Symbol("k"), symbols=["k"]),
        lambda: lp.System(so3, l1**2 / sp.Symbol("k"), {"k": 2}),
        lambda: lp.System(so3, l1**2 / sp.Symbol("k1"), {"k": [1, 2]}),
        lambda: lp.System(so3, l1**2 / sp.Symbol("k2"), symbols=["k[2]"]),
        lambda: lp.System(so3, l1**2 / sp.Symbol("k", positive=True), {"k": 2}),
        lambda: lp.System(so3, l1**2 / sp.Symbol("k"), {"k": "m"}),
        lambda: lp.System(so3.with_constant({("l1", "l2"): "k"}), l1**2 * sp.Symbol("k")),
        lambda: lp.System(so3, sp.Symbol("l1", real=True) ** 2 / 3 + sp.pi * sp.erf(l2)),
        lambda: CanonicalSystem(["q"], ["p"], sp.Symbol("p") ** 2 * sp.Symbol("k"), symbols=["k"]),
        lambda: lp.Top.twisted(("I1", "I2", "I3"), ("a1", 0, 0), epsilon="epsilon"),
    ],
)
def test_coordinates_and_declared_parameters_are_read(make):
    assert make().hamiltonian.free_symbols


def test_the_symbol_of_a_coordinate_may_be_real():
    system = lp.System(so3, sp.Symbol("l1", real=True) ** 2 / 2 + sp.Symbol("l2") ** 2)
    assert system.hamiltonian == l1**2 / 2 + l2**2


@pytest.mark.parametrize(
    ("assumed", "value"), [({"positive": True}, -2), ({"integer": True}, "1/2"), ({"zero": False}, 0)]
)
def test_a_value_that_its_symbol_excludes_is_refused(assumed, value):
    with pytest.raises(ParameterError, match=r"the value of k must be one that its symbol allows, Symbol\('k', "):
        lp.System(so3, l1 * sp.Symbol("k", **assumed), {"k": value})


@pytest.mark.parametrize("given", [int, float, lp.System, dict])
def test_a_class_is_no_hamiltonian(given):
    with pytest.raises(ParameterError, match=r"the Hamiltonian must be a text.*of type type"):
        lp.System(so3, given)


@pytest.mark.parametrize("function", [lambda l: np.sin(l[0]), lambda l: np.exp(l)[0], lambda l: l[0].norm()])
def test_a_function_that_does_not_compute_with_sympy_is_refused_when_the_system_is_made(function):
    with pytest.raises(ParameterError, match=r"must compute with SymPy columns; got .*Use functions of SymPy"):
        lp.System(so3, function)


def test_a_function_without_a_signature_is_refused():
    with pytest.raises(ParameterError, match="must take one vector per field"):
        lp.System(so3, min)
