"""What brackets, Lie algebras and extensions refuse: a call, the type of its error, and the words that help."""

from fractions import Fraction

import pytest
import sympy as sp
from commutative import algebra
from sympy.vector import CoordSys3D

import liepoisson as lp
from liepoisson.errors import BracketError, CocycleError, ParameterError, ShapeError, UnknownNameError
from liepoisson.structure.automorphisms import Automorphism
from liepoisson.structure.bracket import Bracket
from liepoisson.structure.classification import classify
from liepoisson.structure.extension import Extension
from liepoisson.structure.extensions import leibniz, normal_form, semidirect, trivial
from liepoisson.structure.lie_algebra import LieAlgebra
from liepoisson.structure.lie_algebras import ALGEBRAS, semidirect_sum, sine, so
from liepoisson.structure.normal_forms import normal_form_named, normal_forms

TWISTED, HEAVY, SO3 = so(3) @ leibniz(3, "epsilon"), so(3) @ leibniz(2), so(3) @ trivial()
HAT = [[[0, 0, 0], [0, 0, -1], [0, 1, 0]], [[0, 0, 1], [0, 0, 0], [-1, 0, 0]], [[0, -1, 0], [1, 0, 0], [0, 0, 0]]]
SIGMA = [sp.Matrix([[0, 1], [1, 0]]), sp.Matrix([[0, -sp.I], [sp.I, 0]]), sp.Matrix([[1, 0], [0, -1]])]
k, TAN, ROOT = sp.Symbol("k"), sp.tan(13 * sp.pi / 45), sp.Integer(2) ** sp.Rational(1, 3)


def tensor(extension, **entries):
    """That of an extension with entries W[a][b][c] changed, named abc."""
    W = [[list(row) for row in plane] for plane in extension.tensor]
    for name, value in entries.items():
        lam, mu, nu = map(int, name[1:])
        W[lam][mu][nu] = value
    return W


NOT_ASSOCIATIVE = tensor(leibniz(3), W202=-1, W220=-1)


def constants(n, *entries):
    c = [[[0] * n for _ in range(n)] for _ in range(n)]
    for i, j, m in entries:
        c[i][j][m], c[j][i][m] = 1, -1
    return c


def of(n, brackets, **options):
    return lambda: LieAlgebra.from_brackets(n, brackets, **options)


def with_constant(constant, bracket=SO3):
    return lambda: bracket.with_constant(constant)


def canonical(**options):
    return lambda: lp.canonical(**options)


BRACKETS = [
    (lambda: so(3) @ leibniz(3, "l1"), BracketError, r"\['l1'\] name both"),
    (lambda: TWISTED("l1", TWISTED.variables[0]), ParameterError, "must be a SymPy expression; got 'l1'"),
    (lambda: so(3) @ Extension(leibniz(2).tensor, field_names=("x", "x")), BracketError, "distinct names"),
    (lambda: SO3.rename("m", "m"), ShapeError, "must be 1 name"),
    (lambda: (so(3) @ leibniz(2)).rename("m", "m"), BracketError, "distinct names"),
    (lambda: (so(3) @ semidirect(2)).rename("x", "x1"), BracketError, "x1 would be a field and a coordinate"),
    *((lambda n=n: SO3.rename(n), ParameterError, "letters, digits") for n in ("a b", "1x", "", "x(")),
    (lambda: lp.canonical(1) + lp.canonical(1), BracketError, "Add the algebras"),
    (lambda: so(3) @ 5, ParameterError, "extension: wanted an Extension; got 5"),
    (lambda: Bracket(None, leibniz(3, 1)), ParameterError, "algebra: wanted a LieAlgebra; got None"),
    (lambda: SO3.rank((1, 2)), ShapeError, "must be 3 numbers"),
    (lambda: SO3.rank("123"), ShapeError, "must be 3 numbers"),
    (lambda: SO3.rank(("u", 0, 0)), ParameterError, r"must consist of numbers; got the symbols \['u'\]"),
    (lambda: SO3.translated([1, 2]), ShapeError, "point must be 3 numbers"),
    *((lambda d=d: SO3.casimirs(d), ParameterError, "degree must be an integer") for d in (0, 2.0, True, "2")),
    (lambda: TWISTED.casimirs(degree=9), ParameterError, "degree 9 exceeds the size limit"),
    (lambda: TWISTED.substitute({"epsilonn": 2}), ParameterError, "Did you mean epsilon"),
    (lambda: SO3.substitute({"epsilonn": 2}), ParameterError, "there are none"),
    (lambda: TWISTED.substitute({sp.Symbol("epsilon"): 2, "epsilon": 2}), ParameterError, "epsilon.? comes twice"),
    (lambda: Automorphism([[1, 0], [0]]), ShapeError, "matrix must have shape"),
    (lambda: Automorphism([[1, 0], [0, 1]]).is_poisson(TWISTED), ShapeError, "must have 3 rows; got 2"),
    (lambda: Automorphism([[1, 0], [0, 1]]).is_poisson(HEAVY, so(2, 1) @ leibniz(2)), ParameterError, "same Lie alg"),
    *((canonical(n=n), ParameterError, "from 1 to 100") for n in (0, 101, 1.5)),
    (canonical(), ParameterError, "from 1 to 100; got None"),
    (canonical(n=2, names=["x"]), ShapeError, "needs 2 coordinates"),
    (canonical(names="xy"), ShapeError, "sequence of names"),
    (canonical(names=["x"], momenta=["u", "v"]), ShapeError, "one momentum for each"),
    (canonical(n=1, momenta=["u"]), ShapeError, "Give names="),
    (canonical(names=["x", "p_x"]), lp.errors.LiePoissonError, "distinct"),
    (canonical(names=["sin"]), ParameterError, "function or constant"),
]
CONSTANTS = [
    (with_constant({("l1", "ll2"): 1}), BracketError, "Known are l1, l2, l3. Did you mean l2"),
    (with_constant({("l1", 3): 1}), BracketError, "must name coordinates; got 3"),
    (with_constant({("l1", "l2"): 1, ("l2", "l1"): 1}), BracketError, r"\(l2, l1\) twice"),
    (with_constant({("l1", "l1"): 1}), BracketError, "with itself"),
    (with_constant({"l1": 1}), ParameterError, "by pairs of coordinates"),
    (with_constant([("l1", "l2")]), ParameterError, "a mapping from pairs"),
    (with_constant({("l1", "l2"): object()}), ParameterError, r"\{l1, l2\} must be a number, a name or a formula"),
    (with_constant({("l1", "l2"): "l3"}), BracketError, "Rename a parameter"),
    (with_constant({("l1", "l2"): "l1"}), BracketError, r"must not depend on the state; .* H = p1\*f1\(x\)"),
    (with_constant({("l1", "l2"): k * sp.Symbol("l2")}), BracketError, "must not depend on the state"),
    *((with_constant({("l1", "l2"): entry}), ParameterError, "numbers and plain symbols; got")
      for entry in (sp.Dummy("k"), sp.Wild("k"), sp.IndexedBase("k")[1], CoordSys3D("N").x)),
    (with_constant({("l1", "alpha1"): 1}, so(3) @ semidirect(2)), CocycleError, r"\(l1, l2, alpha3\).*is 1 instead"),
    *((lambda make=make, v=v: make(v).rank(), ParameterError, r"field of degree at most 128; .*the degree \d+. Give")
      for make in (lambda v: SO3.with_constant({("l1", "l2"): v}),
                   lambda v: LieAlgebra.from_brackets(3, {(0, 1): {2: v}, (1, 2): {0: 1}, (2, 0): {1: 1}}) @ trivial(),
                   lambda v: so(3) @ Extension([[[1, 0], [0, 0]], [[0, 1], [1, v]]]))
      for v in (TAN + ROOT + 5 ** sp.Rational(1, 7), ROOT - ROOT ** sp.Rational(3, 5) + 3 ** sp.Rational(1, 11))),
]  # fmt: skip
EXTENSIONS_ = [
    (lambda: Extension(tensor(leibniz(3), W101=-1)), BracketError, r"symmetric.*W\[1\]\[0\]\[1\] = -1 and W\[1\]\[1\]"),
    (lambda: Extension(NOT_ASSOCIATIVE), BracketError, r"associative; \(e_\d e_\d\) e_\d and .* differ by -?\d+ along"),
    (lambda: Extension(NOT_ASSOCIATIVE, check=False).unit(), BracketError, "associative"),
    (lambda: classify(NOT_ASSOCIATIVE), BracketError, "associative"),
    (lambda: classify(Extension(NOT_ASSOCIATIVE, check=False)), BracketError, "associative"),
    (lambda: Extension(leibniz(2).tensor, field_names=("l",)), ShapeError, "field_names must be 2 names; got 1"),
    *((lambda n=n: Extension([[[1]]], field_names=n), ShapeError, "must be a sequence") for n in (5, "l", [1])),
    *((lambda W=W: Extension(W, "x"), (ShapeError, ParameterError), "W")
      for W in (None, 5, "abc", [None], [[1]], ["a"], [[None]])),
    *((lambda f=f, n=n: f(n), ParameterError, "n >= 1|at most 100")
      for f in (leibniz, semidirect) for n in (0, -1, 101, 10**12, 2.0, "3", True)),
    *((lambda n=n, p=p: normal_form(n, p), ParameterError, "counted from 1|dimensions 1 to 5")
      for n, p in ((3, 0), (3, 3), (6, 1), (3, True))),
    *((lambda n=n: normal_forms(n), ParameterError, "dimensions 1 to 5") for n in (0, 6, 2.0, True, "3")),
    (lambda: normal_form_named("R[x]/x^3"), UnknownNameError, r"R\[x\]/\(x\^3\)"),
    (lambda: leibniz(2) + 1, ParameterError, "an extension to add"),
    (lambda: Extension.from_products(2, {(0, 1): {1: 1}, (1, 0): {1: 2}}), BracketError, "commutative; got e_1 e_0"),
    (lambda: Extension.from_products(2, {(0, 0): {0: 1}, (0, 1): {1: 2}}), BracketError, "associative"),
    *((lambda p=p: Extension.from_products(2, p), ShapeError, r"0\.\.1|Write for example|Count from 0|Use")
      for p in ({(0, 2): {1: 1}}, {0: 1}, {(0, 0): 1}, {(0, 0, 0): {0: 1}}, {(0, 0.5): {0: 1}}, {(0, 0): {"a": 1}})),
    (lambda: Extension.from_products(2, None), ShapeError, "Use|Write"),
    *((lambda n=n: Extension.from_products(n, {}), ParameterError, "Use|Write") for n in (10**9, 101, 0, 2.5)),
    (lambda: algebra(2, {(1, 1): {0: "q"}}).residue_field, ParameterError, "sign of q"),
    (lambda: classify(algebra(4, {(1, 1): {3: "p"}, (2, 2): {3: "q"}})), ParameterError, "sign of q/p; got no values"),
    *((lambda v=v: classify(algebra(3, {(1, 1): {2: v}})), ParameterError, "rational numbers, algebraic numbers, or")
      for v in (sp.sqrt(k), sp.sin(k), sp.sqrt(2) * k)),
    (lambda: classify(leibniz(41)), ParameterError, "up to 40 fields"),
]  # fmt: skip
ALGEBRAS_ = [
    (lambda: LieAlgebra([[[0, 0], [1, 0]], [[1, 0], [0, 0]]]), BracketError, r"antisymmetric.*c\[0\]\[1\]\[0\] = 1"),
    (lambda: LieAlgebra(constants(5, (0, 1, 2), (2, 3, 4))), BracketError, r"\(0, 1, 3\).*component 1 along e_4"),
    (of(5, {(0, 1): {2: 1}, (2, 3): {4: 1}}), BracketError, r"\(i, j, k\) = \(0, 1, 3\).*component 1 along e_4"),
    *((lambda c=c: LieAlgebra(c), ShapeError, r"shape \(n, n, n\)") for c in ([], [[[1]], [[1]]], [[[0], [0]]])),
    (lambda: LieAlgebra(so(3).structure_constants, basis_names=("x", "y")), ShapeError, "3 names; got 2"),
    (of(3, {(0, 3): {1: 1}}), BracketError, "indices of brackets must be integers from 0 to 2; got 3"),
    (of(3, {(0, True): {1: 1}}), BracketError, "got True"),
    (of(3, {(0, 1): {3: 1}}), BracketError, r"indices of brackets\[0, 1\] must be .* got 3"),
    (of(3, {(1, 1): {0: 1}}), BracketError, r"antisymmetric; got the pair \(1, 1\)"),
    (of(3, {(0, 1): {2: 1}, (1, 0): {2: -1}}), BracketError, "each pair once"),
    (of(3, {0: {2: 1}}), BracketError, r"pairs \(i, j\); got 0"),
    (of(3, {(0, 1): 2}), ShapeError, r"brackets\[0, 1\] must be a mapping"),
    (of(3, [1]), ShapeError, "must be a mapping; got list"),
    (of(3, {(0, 1): {2: "1+"}}), ParameterError, r"brackets\[0, 1\]\[2\]"),
    (of(3, {(0, 1): {2: sp.nan}}), ParameterError, "finite real number"),
    (of(3, {(0, 1): {2: True}}), ParameterError, "a number, a name or a formula"),
    *((of(n, {}), ParameterError, "integer from 1 to 1000") for n in (0, 1001, 2.0, True, "3", None)),
    *((of(2, {}, basis_names=names), ParameterError, words)
      for names, words in ((["2", "1"], "own place"), (["a b", "c"], "letters, digits"), (["a", "a"], "distinct"))),
    (lambda: so(3).bracket((1, 2, 3), (1, 2)), ShapeError, "v must have 3 components; got 2"),
    (lambda: so(21).structure_constants, ParameterError, r"up to 200 dimensions; so\(21\) has 210"),
    (lambda: LieAlgebra.from_brackets(3, {(0, 1): {2: "s"}, (1, 2): {0: 1}, (2, 0): {1: 1}}).killing_signature(),
     ParameterError, "a form of numbers; got the symbols s"),
    *((lambda f=f, n=n: f(n), ParameterError, name) for name, f in sorted(ALGEBRAS.items())
      for n in (True, 2.0, "3", None, -1, Fraction(3), 10**6, 10**30, 0, float("nan"))),
    *((lambda s=s: so(*s), ParameterError, "so") for s in ((2, -1), (2, True), (1, 0), (0, 1), (2, 10**9), (3, 1.0))),
    *((lambda n=n: sine(n), ParameterError, "odd|>= 3") for n in (2, 4, 10)),
    (lambda: sine(1_000_000), ParameterError, "Take a smaller n"),
    (lambda: LieAlgebra.from_matrices([HAT[0], HAT[1], [[a + 2 * b for a, b in zip(r, s, strict=True)]
     for r, s in zip(HAT[1], HAT[0], strict=True)]]), BracketError, r"matrix 2 is a combination .* before it \(0, 1\)"),
    (lambda: LieAlgebra.from_matrices([[[0, 0], [0, 0]]]), BracketError, "it is zero"),
    (lambda: LieAlgebra.from_matrices(HAT[:2]), BracketError, "that of matrices 0 and 1 is outside"),
    (lambda: LieAlgebra.from_matrices(SIGMA), BracketError, "of their real span. Hermitian .* hermitian=True"),
    *((lambda m=m: LieAlgebra.from_matrices(m), ShapeError, "square matri")
      for m in ([], "ab", 3, [1, 2], [[[1, 2]]], [[[1, 2], [3]]], [["ab", "cd"]])),
    (lambda: LieAlgebra.from_matrices([[[1]], [[1, 0], [0, 1]]]), ShapeError, r"one size; got the sizes \[1, 2\]"),
    *((lambda v=v: LieAlgebra.from_matrices([[[v]]]), ParameterError, r"matrices\[0\]")
      for v in (float("nan"), sp.oo, "1+", True, complex(0, float("inf")), sp.oo * sp.I)),
    (lambda: semidirect_sum(so(3), [HAT[0], HAT[1], [[2 * v for v in row] for row in HAT[2]]]),
     BracketError, r"fails for \(i, j\) = \(0, 1\)"),
    (lambda: semidirect_sum(so(3), HAT[:2]), ShapeError, "3 matrices, one per basis element of so"),
]  # fmt: skip


@pytest.mark.timeout(60)
@pytest.mark.parametrize(("call", "error", "words"), [*BRACKETS, *CONSTANTS, *EXTENSIONS_, *ALGEBRAS_])
def test_refusals(call, error, words):
    with pytest.raises(error, match=words):
        call()


NAMED_LIKE_COORDINATES = {
    "a dummy": sp.Dummy("l1"),
    "an entry": sp.IndexedBase("l")[1],
    "a function of time": sp.Function("l1")(sp.Symbol("t")),
    "a field": sp.Symbol("alpha") ** 2,
    "another letter": sp.Symbol("L1"),
}


@pytest.mark.parametrize("function", NAMED_LIKE_COORDINATES.values(), ids=NAMED_LIKE_COORDINATES)
def test_what_has_the_name_of_a_coordinate_and_is_none_is_no_constant(function):
    l1 = TWISTED.variables[0]
    for call in (
        TWISTED.vector_field,
        lambda f: TWISTED(f, l1),
        lambda f: TWISTED(l1, f),
        lambda f: Automorphism(((1, 0, 0), (0, 2, 0), (0, 0, 4))).apply(f, TWISTED),
    ):
        with pytest.raises(ParameterError, match=r"which is like .* and none of them"):
            call(function)
