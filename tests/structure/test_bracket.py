import pickle
import subprocess
import sys
from fractions import Fraction

import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.errors import BracketError, ParameterError, ShapeError
from liepoisson.structure.bracket import Bracket
from liepoisson.structure.extension import Extension
from liepoisson.structure.extensions import leibniz, semidirect
from liepoisson.structure.lie_algebra import LieAlgebra
from liepoisson.structure.lie_algebras import so

EPSILON = sp.Symbol("epsilon")


def hat(u):
    """The matrix of v -> u x v."""
    return sp.Matrix([[0, -u[2], u[1]], [u[2], 0, -u[0]], [-u[1], u[0], 0]])


def test_the_coordinates_are_l_alpha_beta():
    bracket = so(3) @ leibniz(3, "epsilon")
    assert [str(v) for v in bracket.variables] == [f + i for f in ("l", "alpha", "beta") for i in "123"]
    assert list(bracket.fields) == ["l", "alpha", "beta"]
    assert bracket.fields["alpha"] == sp.Matrix(sp.symbols("alpha1:4"))


def test_the_poisson_tensor_of_the_twisted_top():
    bracket = so(3) @ leibniz(3, "epsilon")
    l, alpha, beta = (hat(v) for v in bracket.fields.values())
    zero = sp.zeros(3, 3)
    expected = sp.Matrix(sp.BlockMatrix([[l, alpha, beta], [alpha, EPSILON * beta, zero], [beta, zero, zero]]))
    assert bracket.poisson_tensor() == expected


def test_the_bracket_is_the_formula_of_the_paper():
    bracket = so(3) @ leibniz(3, "epsilon")
    l, alpha, beta = bracket.fields.values()
    f = l[0] * alpha[1] + beta[2] ** 2 * l[2] + alpha[0] * alpha[2]
    g = l[1] ** 2 + alpha[2] * beta[0] + alpha[1] * l[2]

    def gradient(h, v):
        return sp.Matrix([h.diff(component) for component in v])

    f_l, f_a, f_b = (gradient(f, v) for v in (l, alpha, beta))
    g_l, g_a, g_b = (gradient(g, v) for v in (l, alpha, beta))
    semi = -l.dot(f_l.cross(g_l)) - alpha.dot(f_l.cross(g_a) + f_a.cross(g_l))
    semi -= beta.dot(f_l.cross(g_b) + f_b.cross(g_l))
    assert sp.expand(bracket(f, g) - semi + EPSILON * beta.dot(f_a.cross(g_a))) == 0
    assert sp.expand((so(3) @ semidirect(3))(f, g) - semi) == 0


def test_casimirs_of_the_leibniz_bracket_in_the_order_of_the_paper():
    bracket = so(3) @ leibniz(3, "epsilon")
    l, alpha, beta = bracket.fields.values()
    expected = [alpha.dot(alpha) + 2 * EPSILON * l.dot(beta), alpha.dot(beta), beta.dot(beta)]
    assert [sp.expand(c) for c in bracket.casimirs()] == [sp.expand(c) for c in expected]


@pytest.mark.parametrize("n", [1, 2, 3, 4])
def test_casimirs_of_leibniz_extensions_are_the_convolutions(n):
    bracket = so(3) @ leibniz(n)
    x = list(bracket.fields.values())
    expected = [sum(x[i].dot(x[n - 1 + k - i]) for i in range(n) if n - 1 + k - i < n) for k in range(n)]
    found = bracket.casimirs()
    assert len(found) == n
    span = [sp.Poly(c, *bracket.variables) for c in found + expected]
    monomials = sorted({m for p in span for m in p.monoms()})
    assert sp.Matrix([[p.coeff_monomial(m) for m in monomials] for p in span]).rank() == n


def test_linear_casimirs_are_the_centre():
    # Heisenberg: [e0, e1] = e2, whose centre is e2.
    c = [[[0] * 3 for _ in range(3)] for _ in range(3)]
    c[0][1][2], c[1][0][2] = 1, -1
    bracket = LieAlgebra(c, "heisenberg") @ leibniz(1)
    x3 = bracket.variables[2]
    assert bracket.casimirs() == [x3]


def test_the_abelian_bracket_keeps_everything():
    abelian = LieAlgebra([[[0]]], "R") @ leibniz(2)
    assert abelian.casimirs()[:2] == list(abelian.variables)


def test_jacobi_residuals_list_all_84_triples():
    residuals = (so(3) @ leibniz(3, "epsilon")).jacobi_residuals()
    assert len(residuals) == 84
    assert set(residuals.values()) == {0}


@pytest.mark.thorough
def test_jacobi_residuals_agree_with_nested_brackets():
    W = [[list(row) for row in plane] for plane in leibniz(3, 2).tensor]
    W[2][0][2], W[2][2][0] = -W[2][0][2], -W[2][2][0]
    wrong = Bracket(so(3), Extension(W, check=False))
    residuals = wrong.jacobi_residuals()
    assert any(value != 0 for value in residuals.values())
    for (u, v, w), value in residuals.items():
        nested = wrong(wrong(u, v), w) + wrong(wrong(v, w), u) + wrong(wrong(w, u), v)
        assert sp.expand(nested - value) == 0


def test_a_parameter_may_not_have_the_name_of_a_coordinate():
    with pytest.raises(BracketError, match=r"\['l1'\] name both"):
        so(3) @ leibniz(3, "l1")


def test_a_string_is_not_a_function():
    bracket = so(3) @ leibniz(3)
    with pytest.raises(ParameterError, match="must be a SymPy expression; got 'l1'"):
        bracket("l1", bracket.variables[0])


def test_equal_coordinate_names_are_refused():
    with pytest.raises(BracketError, match="distinct names"):
        so(3) @ Extension(leibniz(2).tensor, field_names=("x", "x"))


def test_the_tensor_that_is_handed_out_is_a_copy():
    bracket = so(3) @ leibniz(3)
    bracket.poisson_tensor()[0, 1] = 17
    assert bracket.poisson_tensor()[0, 1] != 17


def test_entries_are_the_upper_half_of_the_poisson_tensor():
    bracket = so(3) @ leibniz(3, "epsilon")
    J = sp.zeros(9, 9)
    for i, j, m, c in bracket.entries():
        assert i < j
        J[i, j] += c * bracket.variables[m]
        J[j, i] -= c * bracket.variables[m]
    assert bracket.poisson_tensor() == J
    assert all(isinstance(c, Fraction) for *_, c in (so(3) @ leibniz(3)).entries())


def test_fields_can_be_renamed():
    bracket = (so(3) @ leibniz(2)).rename("m", "p")
    assert bracket.coordinate_names_in_order == ("m1", "m2", "m3", "p1", "p2", "p3")
    assert bracket.field_lengths == (3, 3)
    m, p = bracket.fields.values()
    assert bracket.casimirs() == [m.dot(p), p.dot(p)]
    with pytest.raises(ShapeError, match="must be 2 names; got 1"):
        (so(3) @ leibniz(2)).rename("m")
    with pytest.raises(BracketError, match="distinct names"):
        (so(3) @ leibniz(2)).rename("m", "m")


@pytest.mark.parametrize(
    ("extension", "point", "rank"),
    [
        # epsilon != 0: rank 6 whenever beta != 0, also where alpha is parallel to beta
        (leibniz(3), (1, 2, -1, 0, 0, 2, 0, 0, 1), 6),
        (leibniz(3, "epsilon"), (0, 0, 0, 0, 0, 0, 0, 0, 1), 6),
        (leibniz(3), (1, 2, -1, 0, "1/3", 2, 0, 0, 0), 4),
        (leibniz(3), (1, 2, -1, 0, 0, 0, 0, 0, 0), 2),
        (leibniz(3), (0,) * 9, 0),
        # epsilon = 0: rank 6 only where alpha x beta != 0
        (semidirect(3), (1, 2, -1, 0, 0, 2, 0, 0, 1), 4),
        (semidirect(3), (1, 2, -1, 0, 1, 2, 0, 0, 1), 6),
    ],
)
def test_rank_at_a_point(extension, point, rank):
    bracket = so(3) @ extension
    assert bracket.rank(point) == rank
    assert bracket.corank(point) == 9 - rank
    values = dict(zip(bracket.variables, map(sp.Rational, point), strict=True))
    assert bracket.poisson_tensor().subs(values).rank() == rank


def test_the_rank_takes_points_that_are_not_rational():
    # On beta = 0, alpha = (sqrt(2), 0, 0) the rank is 4.
    assert (so(3) @ leibniz(3)).rank((1, 0, 2, sp.sqrt(2), 0, 0, 0, 0, 0)) == 4


def test_generic_rank_and_corank():
    assert (so(3) @ leibniz(3, "epsilon")).rank() == 6
    assert (so(3) @ semidirect(4)).corank() == 6


@pytest.mark.parametrize("point", [(1, 2), "123456789", None])
def test_a_point_has_one_number_per_coordinate(point):
    bracket = so(3) @ leibniz(3)
    if point is None:
        with pytest.raises(ParameterError, match=r"must consist of numbers; got the symbols \['u'\]"):
            bracket.rank(("u", *(0,) * 8))
    else:
        with pytest.raises(ShapeError, match="must be 9 numbers"):
            bracket.rank(point)


def test_brackets_are_pickled_by_their_definition():
    bracket = so(3) @ leibniz(3, "epsilon")
    bracket.casimir_report()
    again = pickle.loads(pickle.dumps(bracket))
    assert again.entries() == bracket.entries()
    assert set(again.__dict__) <= {"algebra", "extension", "constant", "_name", "_terms"}


@pytest.mark.skipif(sys.platform == "emscripten", reason="a browser has no processes")
def test_entries_do_not_import_sympy():
    code = (
        "import sys; from liepoisson.structure.lie_algebras import so; "
        "from liepoisson.structure.extensions import leibniz;"
        "(so(3) @ leibniz(3)).entries(); sys.exit('sympy' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_names_that_a_formula_could_not_use_are_refused():
    """x1 would be the first component of x and the second field."""
    with pytest.raises(BracketError, match="x1 would be a field and a coordinate"):
        (so(3) @ semidirect(2)).rename("x", "x1")
    for name in ("a b", "1x", "", "x("):
        with pytest.raises(ParameterError, match="letters, digits"):
            (so(3) @ semidirect(2)).rename("x", name)


def test_brackets_are_not_added():
    with pytest.raises(BracketError, match="Add the algebras"):
        lp.canonical(1) + lp.canonical(1)


TWISTED = lp.so(3) @ lp.leibniz(3, "epsilon")
LIKE_COORDINATES = {
    "another case": sp.Symbol("L1") ** 2,
    "an underscore": sp.Symbol("l_1"),
    "a dummy": sp.Dummy("l1"),
    "an entry": sp.IndexedBase("l")[1],
    "a function of time": sp.Function("l1")(sp.Symbol("t")),
    "a field": sp.Symbol("alpha") ** 2,
}


@pytest.mark.parametrize("function", LIKE_COORDINATES.values(), ids=LIKE_COORDINATES)
def test_what_is_like_a_coordinate_and_none_is_no_constant(function):
    l1 = TWISTED.variables[0]
    for call in (
        TWISTED.vector_field,
        lambda f: TWISTED(f, l1),
        lambda f: TWISTED(l1, f),
        lambda f: lp.brackets.Automorphism(((1, 0, 0), (0, 2, 0), (0, 0, 4))).apply(f, TWISTED),
    ):
        with pytest.raises(ParameterError, match=r"is like (l1|the field alpha) and none of them"):
            call(function)


def test_coefficients_of_functions_stay():
    l1, l2, *_ = TWISTED.variables
    a, epsilon, V = sp.Symbol("a"), sp.Symbol("epsilon"), sp.Function("V")
    assert TWISTED(l2, a * l1) == sp.expand(a * TWISTED(l2, l1))
    assert TWISTED(l2, epsilon * l1) == sp.expand(epsilon * TWISTED(l2, l1))
    assert TWISTED(l2, V(l1)) == V(l1).diff(l1) * TWISTED(l2, l1)
    scaling = lp.brackets.Automorphism(((1, 0, 0), (0, 2, 0), (0, 0, 4)))
    doubled = scaling.apply(sp.Symbol("alpha1", positive=True), TWISTED)
    assert doubled == 2 * TWISTED.variables[3]
    system = lp.System(lp.so(3) @ lp.trivial(), "L1*l1^2 + l2^2", symbols=["L1"])
    for one in (system, pickle.loads(pickle.dumps(system))):
        assert one.bracket(one.hamiltonian, one.variables[2]) != 0
        assert sp.Symbol("L1") in one.equations[one.variables[1]].free_symbols


@pytest.mark.parametrize("of", [TWISTED, TWISTED.extension, lp.so(3), lp.so(3) @ lp.trivial()])
def test_values_for_unknown_symbols_are_refused(of):
    hint = "Did you mean epsilon" if of.symbols else "there are none"
    with pytest.raises(ParameterError, match=hint):
        of.substitute({"epsilonn": 2})
    for key in (sp.Symbol("epsilon"), sp.Symbol("epsilon", positive=True)):
        if of.symbols:
            assert of.substitute({key: 2}).symbols == set()
            with pytest.raises(ParameterError, match="epsilon comes twice"):
                of.substitute({key: 2, "epsilon": 2})
