"""No text that a caller or a file gives runs as Python code.

SymPy's own conversions do run texts: `sympify` and what calls it, such as `Matrix`, `Poly`, `subs` and `sin`.  Values
from outside come into SymPy through `as_expression` and through the grammar alone.
"""

import ast
from collections import UserDict
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.algebra.exact_numbers import as_expression
from liepoisson.algebra.ideals.polynomial_system import PolynomialSystem
from liepoisson.compile.symbols import in_compiler_symbols
from liepoisson.errors import LiePoissonError
from liepoisson.model.canonical_system import CanonicalSystem

ROOT = Path(lp.__file__).parent

FORBIDDEN = {"sympify", "_sympify", "eval", "exec", "parse_expr", "parse_latex", "parse_mathematica", "dill", "marshal"}
"""Names that the package uses nowhere: they run texts, or make objects of bytes."""

HOMES = {
    "lambdify": {"compile/symbols.py"},
    "loads": {"sweeps/family.py", "sweeps/remote.py"},
    "Unpickler": set[str](),
    "pickle": {
        *("sweeps/family.py", "sweeps/remote.py", "integrability/scan_points.py"),
        "algebra/flint_pickles.py",  # how numbers of FLINT are pickled; it reads none
    },
    "cloudpickle": {"sweeps/remote.py"},
}
"""Names with the only files that may use them.

`lambdify` gets expressions in private symbols.  What is unpickled was pickled by this process, its parent or the
scheduler of Dask that a user chose; see SECURITY.md.
"""

TEXT = "__import__('os').getcwd()"


def names_in(tree: ast.AST) -> list[tuple[str, int]]:
    """All names, attributes and imports with their lines; the methods of a regular expression are other things."""
    found: list[tuple[str, int]] = []
    for node in ast.walk(tree):
        match node:
            case ast.Name(id=name) | ast.Attribute(attr=name):
                found.append((name, node.lineno))
            case ast.Import(names=imported) | ast.ImportFrom(names=imported):
                parts = [*(one.name for one in imported), getattr(node, "module", None) or ""]
                found += [(word, node.lineno) for part in parts for word in part.split(".")]
            case _:
                pass
    return found


def calls_in(tree: ast.AST) -> list[ast.Call]:
    """All calls."""
    return [node for node in ast.walk(tree) if isinstance(node, ast.Call)]


def faults_in(tree: ast.AST, where: str) -> list[str]:
    """What a file has and must not have."""
    faults = [
        f"{where}:{line}: {name}"
        for name, line in names_in(tree)
        if name in FORBIDDEN or (name in HOMES and where not in HOMES[name] and name != "loads")
    ]
    for call in calls_in(tree):
        match call.func:
            case ast.Name(id="S" | "compile" | "__import__" as name):
                faults.append(f"{where}:{call.lineno}: {name}(...)")
            case ast.Attribute(value=ast.Name(id="pickle" | "cloudpickle" as module), attr="load" | "loads"):
                if where not in HOMES["pickle"]:
                    faults.append(f"{where}:{call.lineno}: {module}")
            case ast.Attribute(value=ast.Name(id="np" | "numpy"), attr="load"):
                safe = {k.arg: ast.unparse(k.value) for k in call.keywords}.get("allow_pickle") == "False"
                faults += [] if safe else [f"{where}:{call.lineno}: np.load"]
            case ast.Attribute(attr="read_pickle" | "load_pickle"):
                faults.append(f"{where}:{call.lineno}: {ast.unparse(call.func)}")
            case _:
                pass
    return faults


def test_no_file_of_the_package_hands_texts_to_an_interpreter():
    files = sorted(ROOT.rglob("*.py"))
    trees = {str(path.relative_to(ROOT)): ast.parse(path.read_text("utf-8")) for path in files}
    assert len(trees) > 300
    assert [fault for where, tree in trees.items() for fault in faults_in(tree, where)] == []


@pytest.mark.parametrize(
    "code",
    [
        "from sympy import sympify", "import sympy; sympy.sympify(x)", "eval(x)", "exec(x)", "S(x)", "compile(x)",
        "from sympy.parsing.sympy_parser import parse_expr", "lambdify(x, y)", "import pickle", "import cloudpickle",
        "np.load(f)", "np.load(f, allow_pickle=True)", "pd.read_pickle(f)", "__import__(x)",
    ],
)  # fmt: skip
def test_the_test_finds(code):
    assert faults_in(ast.parse(code), "a.py")


class Told:
    """An object whose text is code."""

    def __str__(self) -> str:
        return TEXT

    __repr__ = __str__


class Converted:
    """An object that tells SymPy what to take it for."""

    def _sympy_(self) -> str:
        return TEXT


PAYLOADS = {
    "text": TEXT,
    "list": [TEXT],
    "nested list": [[TEXT]],
    "tuple": (TEXT,),
    "set": {TEXT},
    "frozenset": frozenset({TEXT}),
    "dict": {TEXT: TEXT},
    "mapping": UserDict({TEXT: TEXT}),
    "array": np.array([TEXT]),
    "array without axes": np.array(TEXT),
    "array of objects": np.array(TEXT, dtype=object),
    "NumPy text": np.str_(TEXT),
    "bytes": TEXT.encode(),
    "told": Told(),
    "converted": Converted(),
    "generator": (text for text in [TEXT]),
    "range of names": SimpleNamespace(free_symbols=set[object](), expand=lambda: TEXT),
}

so3 = lp.so(3) @ lp.trivial()
euler = lp.System(so3, "l1^2 + 2*l2^2 + 3*l3^2")
l1 = so3.variables[0]
s = sp.Symbol("s")

DOORS = {
    "as_expression": lambda x: as_expression(x, "x"),
    "lax_pair L": lambda x: lp.integrability.lax_pair(euler, L=[[x, 0], [0, 0]], M=[[0, 0], [0, 0]]),
    "lax_pair M": lambda x: lp.integrability.lax_pair(euler, L=[[0, 0], [0, 0]], M=[[x, 0], [0, 0]]),
    "lax_pair matrix": lambda x: lp.integrability.lax_pair(euler, L=x, M=x),
    "lax_pair vector": lambda x: lp.integrability.lax_pair(euler, L=[x, 0, 0], M=[0, 0, 0]),
    "lax_pair spectral": lambda x: lp.integrability.lax_pair(euler, L="l", M="l", spectral=x),
    "bracket": lambda x: so3(x, l1),
    "bracket, second": lambda x: so3(l1, x),
    "bracket.vector_field": so3.vector_field,
    "bracket.with_constant": lambda x: so3.with_constant({("l1", "l2"): x}),
    "bracket.with_constant, pair": lambda x: so3.with_constant({("l1", x if isinstance(x, str) else "l9"): 1}),
    "bracket.frozen": lambda x: so3.frozen([x, 0, 0]),
    "bracket.rank": lambda x: so3.rank([x, 0, 0]),
    "system": lambda x: lp.System(so3, x),
    "system of a function": lambda x: lp.System(so3, lambda l: x).hamiltonian,
    "system parameters": lambda x: lp.System(so3, "k*l1", {"k": x}),
    "system parameters, vector": lambda x: lp.System(so3, "dot(k, l)", {"k": [x, 0, 0]}),
    "system symbols": lambda x: lp.System(so3, "l1", symbols=[x]),
    "system integrals": lambda x: lp.System(so3, "l1^2", integrals={"K": x}).integrals,
    "system partial integrals": lambda x: lp.System(so3, "l1^2", partial_integrals={"K": (x, x)}).partial_integrals,
    "system.expression": euler.expression,
    "system.is_constant": euler.is_constant,
    "system.is_casimir": euler.is_casimir,
    "system.derivative": euler.derivative,
    "system.function_tape": euler.function_tape,
    "system.functions.of": euler.functions.of,
    "function_of_invariants": euler.function_of_invariants,
    "canonical": lambda x: lp.System(lp.canonical(1), x),
    "canonical quadratures": lambda x: CanonicalSystem(["q"], ["p"], "p^2/2", quadratures={"a": x}),
    "top": lambda x: lp.Top(inertia=(x, 1, 1)),
    "top a": lambda x: lp.Top(inertia=(1, 1, 1), a=x),
    "top epsilon": lambda x: lp.Top(inertia=(1, 1, 1), epsilon=x),
    "leibniz": lambda x: lp.leibniz(3, x),
    "automorphism": lambda x: lp.brackets.Automorphism([[x]]),
    "automorphism.apply": lambda x: lp.brackets.Automorphism([[1]]).apply(x, so3),
    "algebra of matrices": lambda x: lp.LieAlgebra.from_matrices([[[x]]]),
    "algebra of brackets": lambda x: lp.LieAlgebra.from_brackets(2, {(0, 1): {0: x}}),
    "algebra of brackets, rows": lambda x: lp.LieAlgebra.from_brackets(2, {(0, 1): x}),
    "algebra of constants": lambda x: lp.LieAlgebra([[[0, x], [0, 0]], [[0, 0], [0, 0]]]),
    "extension": lambda x: lp.Extension([[[x]]]),
    "tensor": lambda x: lp.PoissonTensor(["x", "y"], {("x", "y"): x}),
    "tensor, variables": lambda x: lp.PoissonTensor([x, "y"], {(0, 1): 1}),
    "tensor, parameters": lambda x: lp.PoissonTensor(["x", "y"], {("x", "y"): "k*x"}, {"k": x}),
    "tensor, symbols": lambda x: lp.PoissonTensor(["x", "y"], {("x", "y"): "x"}, symbols=[x]),
    "tensor, Casimirs": lambda x: lp.PoissonTensor(["x", "y", "z"], {("x", "y"): 1}, casimirs=[x]),
    "tensor, rank": lambda x: lp.PoissonTensor(["x", "y"], {("x", "y"): "x"}).rank([x, 1]),
    "log_canonical": lambda x: lp.brackets.log_canonical([[0, x], [x, 0]]),
    "nambu": lambda x: lp.brackets.nambu(x, ["x", "y", "z"]),
    "nambu, factor": lambda x: lp.brackets.nambu("x", ["x", "y", "z"], factor=x),
    "dirac_bracket": lambda x: lp.canonical(1).dirac_bracket(["q1", x]),
    "dirac_bracket, parameters": lambda x: lp.canonical(1).dirac_bracket(["q1 - k", "p1"], {"k": x}),
    "dirac_bracket, symbols": lambda x: lp.canonical(1).dirac_bracket(["q1", "p1"], symbols=[x]),
    "magnetic": lambda x: lp.brackets.magnetic([x]),
    "magnetic, charge": lambda x: lp.brackets.magnetic(["x"], charge=x),
    "guiding_centre": lambda x: lp.brackets.guiding_centre(["0", "0", x]),
    "guiding_centre, mass": lambda x: lp.brackets.guiding_centre(["0", "0", "1"], mass=x),
    "in_invariants": lambda x: lp.canonical(1).in_invariants({"a": x}),
    "in_invariants, levels": lambda x: lp.canonical(1).in_invariants({"a": "q1"}, levels={"L": x}),
    "in_variables": lambda x: so3.in_variables({"u": x, "v": "l2", "w": "l3"}, {"l1": "u", "l2": "v", "l3": "w"}),
    "linear_system": lambda x: lp.integrability.linear_system([[x]], s),
    "linear_system, matrix": lambda x: lp.integrability.linear_system(x, s),
    "linear_system, variable": lambda x: lp.integrability.linear_system([[s]], x),
    "particular_solution": lambda x: lp.integrability.particular_solution(euler, [x, 0, 0], variable=s),
    "first_integrals known": lambda x: lp.integrability.first_integrals(euler, degree=1, known={"K": x}),
    "first_integrals on": lambda x: lp.integrability.first_integrals(euler, degree=1, on=[x]),
    "darboux on": lambda x: lp.integrability.darboux_polynomials(euler, degree=1, on=[x]),
    "integrable_families positive": lambda x: lp.integrability.integrable_families(euler, degree=1, positive=[x]),
    "polynomial system": lambda x: PolynomialSystem.of([x], ["x"]),
    "private symbols": lambda x: in_compiler_symbols([l1], [x]),
    "section": lambda x: lp.section(euler, [[1.0, 2.0, 3.0]], t_end=1, surface=x),
    "section, keep": lambda x: lp.section(euler, [[1.0, 2.0, 3.0]], t_end=1, surface="l1", keep=[x]),
    "enclosure of a section": lambda x: lp.proofs.enclose_section_map(euler, [1, 2, 3], surface=x),
    "enclosure": lambda x: lp.proofs.enclose_flow(euler, [x, 2, 3], time=1),
    "leaf": lambda x: lp.Leaf(euler, {"C1": x}),
}


@pytest.fixture
def read_by_sympy(monkeypatch):
    """The texts that came to SymPy's own parser, which runs them."""
    from sympy.parsing import sympy_parser

    texts: list[str] = []

    def refused(text: str, *_: object, **__: object):
        texts.append(str(text))
        raise sp.SympifyError(text)

    monkeypatch.setattr(sympy_parser, "parse_expr", refused)
    monkeypatch.setattr(sympy_parser, "eval_expr", refused)
    return texts


@pytest.mark.parametrize("door", DOORS)
def test_no_door_hands_what_it_is_given_to_the_parser_of_sympy(door, read_by_sympy):
    for payload, value in PAYLOADS.items():
        with pytest.raises(LiePoissonError):
            DOORS[door](value)
        assert read_by_sympy == [], payload


@pytest.mark.parametrize("kind", ["nested list", "set", "mapping", "array without axes"])
def test_an_entry_of_a_lax_pair_runs_no_code(kind, tmp_path):
    ran = tmp_path / "ran"
    code = f"open({str(ran)!r}, 'w')"
    entry = {"nested list": [[code]], "set": {code}, "mapping": {code: 1}, "array without axes": np.array(code)}[kind]
    with pytest.raises(LiePoissonError):
        lp.integrability.lax_pair(euler, L=[[entry, 0, 0], [0, 0, 0], [0, 0, 0]], M=[[0] * 3] * 3)
    assert not ran.exists()


def test_numbers_and_expressions_are_read_exactly():
    assert as_expression(0.1, "x") == sp.Rational(1, 10)
    assert as_expression(np.int64(3), "x") == 3
    assert as_expression(l1 + 1, "x") is not None
    assert as_expression(sp.pi, "x") == sp.pi
