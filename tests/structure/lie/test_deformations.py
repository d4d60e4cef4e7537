from fractions import Fraction
from itertools import combinations
from random import Random

import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.errors import CochainError, ParameterError, ShapeError
from liepoisson.structure.lie.cochains import check_closed, combination

lie = lp.algebras
EPSILON = sp.Symbol("epsilon")


def first_order(algebra, parameter=EPSILON):
    """The derivative of the constants at zero, by pairs."""
    found = {}
    for pair, row in algebra.brackets.items():
        slopes = {k: sp.diff(sp.sympify(c), parameter).subs(parameter, 0) for k, c in row.items()}
        if any(slopes.values()):
            found[pair] = {k: v for k, v in slopes.items() if v}
    return found


def at_zero(algebra):
    brackets = {p: {k: sp.sympify(c).subs(EPSILON, 0) for k, c in row.items()} for p, row in algebra.brackets.items()}
    return {p: {k: v for k, v in row.items() if v} for p, row in brackets.items() if any(row.values())}


def test_galilei_extended_by_the_mass_is_bargmanns_algebra():
    galilei = lie.galilei(3)
    (mass,) = lie.cohomology(galilei, 2).representatives
    bargmann = lie.central_extension(galilei, mass, "bargmann", ["M"])
    assert bargmann.jacobi_residuals() == {}
    assert bargmann.basis_names == (*galilei.basis_names, "M")
    new = {pair: row for pair, row in bargmann.brackets.items() if 10 in row}
    assert new == {(3 + i, 6 + i): {10: 1} for i in range(3)}
    assert lie.cohomology(bargmann, 2).dimension == 0


@pytest.mark.parametrize("n", [1, 2, 3])
def test_heisenberg_is_a_central_extension_of_the_abelian_algebra(n):
    form = {(i, n + i): 1 for i in range(n)}
    assert lie.central_extension(lie.abelian(2 * n), form).brackets == lie.heisenberg(n).brackets


def test_several_cocycles_extend_at_once():
    """All of H^2 of the plane Galilei algebra; the centre has three dimensions more."""
    galilei = lie.galilei(2)
    found = lie.cohomology(galilei, 2).representatives
    extended = lie.central_extension(galilei, found)
    assert extended.dimension == galilei.dimension + 3
    assert extended.jacobi_residuals() == {}
    assert extended.centre().dimension == galilei.centre().dimension + 3
    assert extended.basis_names[-3:] == ("c1", "c2", "c3")


def test_no_cocycle_no_central_extension():
    with pytest.raises(CochainError, match=r"must be a cocycle, df = 0; at \(J1, K2, P3\) df is -?2") as error:
        lie.central_extension(lie.galilei(3), {("K1", "P1"): 1, ("K2", "P2"): 1, ("K3", "P3"): -1})
    assert error.value.triple == ("J1", "K2", "P3")
    with pytest.raises(ShapeError, match="must be 1 names; got 2"):
        lie.central_extension(lie.abelian(2), {(0, 1): 1}, central_names=["a", "b"])
    with pytest.raises(ShapeError, match="at least one cocycle"):
        lie.central_extension(lie.abelian(2), [])
    for name in ("2", "e2"):
        with pytest.raises(ParameterError, match=f"no basis element of abelian.2. has; got '{name}'"):
            lie.central_extension(lie.abelian(2), {(0, 1): 1}, central_names=[name])


@pytest.mark.parametrize(
    ("algebra", "inner", "outer"),
    [
        (lp.so(3), 3, 0),
        (lp.sl(3), 8, 0),
        (lie.se(3), 6, 1),
        (lie.heisenberg(2), 4, 11),  # sp(4) and the scaling
        (lie.abelian(2), 0, 4),
        (lie.affine(1), 2, 0),
    ],
    ids=str,
)
def test_derivations(algebra, inner, outer):
    found = lie.derivations_of(algebra)
    assert (len(found.inner), len(found.outer), found.dimension) == (inner, outer, inner + outer)
    n = algebra.dimension
    unit = [[int(i == j) for j in range(n)] for i in range(n)]
    for D in (*found.inner, *found.outer):
        columns = list(zip(*D, strict=True))
        for i, j in combinations(range(n), 2):
            bracket = algebra.bracket(unit[i], unit[j])
            left = [sum(D[a][k] * bracket[k] for k in range(n)) for a in range(n)]
            right = [
                a + b
                for a, b in zip(algebra.bracket(columns[i], unit[j]), algebra.bracket(unit[i], columns[j]), strict=True)
            ]
            assert left == right
    if found.dimension:
        assert found.algebra().dimension == found.dimension


def test_derivations_with_symbols_are_expressions_throughout():
    (outer,) = lie.derivations_of(lie.bianchi("VI", "a")).outer
    assert {isinstance(value, sp.Expr) for row in outer for value in row} == {True}
    assert outer == ((0, 0, 0), (0, 1, -sp.Symbol("a")), (0, -sp.Symbol("a"), 1))


def test_motions_of_the_plane_deform_to_rotations():
    """The other way round than a contraction: [t1, t2] = epsilon r gives so(3) and so(2, 1)."""
    found = lie.deformation(lie.se(2), {("t1", "t2"): {"r": 1}})
    assert found.closes
    assert found.decided
    assert not found.is_trivial
    signs = {sign: found.algebra.substitute({"epsilon": sign}).killing_signature() for sign in (1, -1)}
    assert signs == {1: (0, 3, 0), -1: (2, 1, 0)}


def test_poincare_deforms_to_de_sitter_and_back():
    (one,) = lie.cohomology(lie.poincare(3), 2, "adjoint").representatives
    found = lie.deformation(lie.poincare(3), one)
    assert found.closes
    kinds = {found.algebra.substitute({"epsilon": sign}).killing_signature() for sign in (1, -1)}
    assert kinds == {lp.so(4, 1).killing_signature(), lp.so(3, 2).killing_signature()}


def test_a_coboundary_is_undone_by_the_change_of_basis():
    algebra = lie.heisenberg(1)
    found = lie.deformation(algebra, {("q1", "p1"): {"q1": 1, "c": 2}, ("q1", "c"): {"c": 0}, ("p1", "c"): {"c": -1}})
    assert found.closes
    P = sp.Matrix(found.change_of_basis)
    old, new = found.representative, found.algebra
    assert {p: {k: sp.sympify(c) for k, c in r.items()} for p, r in first_order(new).items()} == {
        p: dict(row) for p, row in found.cocycle.values.items()
    }
    assert new.jacobi_residuals() == {}
    rows = P.tolist()
    for i, j in combinations(range(3), 2):
        bracket = sp.Matrix([old.bracket(rows[i], rows[j])])
        row = new.brackets.get((i, j), {})
        again = sum((row[k] * P[k, :] for k in row), sp.zeros(1, 3))
        assert (bracket - again).applyfunc(sp.simplify) == sp.zeros(1, 3)


def test_a_semisimple_algebra_has_trivial_deformations_only():
    """A cocycle of so(3) is a coboundary, and the deformed algebra is so(3) in another basis."""
    so3 = lp.so(3)
    found = lie.deformation(so3, {("1", "2"): {"3": 1}})
    assert found.is_trivial
    assert found.closes
    assert found.representative is so3
    assert found.algebra.killing_form() != so3.killing_form()
    assert at_zero(found.algebra) == {p: dict(row) for p, row in so3.brackets.items()}
    assert first_order(found.algebra) == {(0, 1): {2: 1}}
    assert found.algebra.substitute({"epsilon": Fraction(1, 7)}).jacobi_residuals() == {}


def test_an_obstructed_cocycle_names_its_class():
    """On the abelian algebra every 2-cochain is a cocycle, and d = 0: the obstruction is the Jacobi identity itself."""
    found = lie.deformation(lie.abelian(3), {("e1", "e2"): {"e3": 1}, ("e1", "e3"): {"e1": 1}})
    assert not found.closes
    assert found.decided
    assert found.algebra is None
    assert found.order == 1
    check_closed(found.obstruction)
    # [[e1, e2], e3] + cyclic with [e1, e2] = e3, [e1, e3] = e1, and the sign of the cyclic sum written out
    assert str(found.obstruction) in ("e1^e2^e3 -> e3", "e1^e2^e3 -> -e3")
    assert str(found).startswith("no deformation of abelian(3) of order 2: obstruction")


def test_a_sign_decides_whether_a_deformation_closes():
    good = {("e1", "e2"): {"e3": 1}, ("e2", "e3"): {"e1": 1}, ("e1", "e3"): {"e2": -1}}
    assert lie.deformation(lie.abelian(3), good).closes
    assert lie.deformation(lie.abelian(3), {**good, ("e1", "e3"): {"e2": 1}}).closes  # so(2, 1)
    assert not lie.deformation(lie.abelian(3), {**good, ("e1", "e3"): {"e2": -1, "e1": 1}}).closes


def test_refusals_of_deformations():
    with pytest.raises(CochainError, match="2-cochain of so"):
        lie.deformation(lp.so(4), {("12", "34"): {"12": 1}})
    with pytest.raises(ParameterError, match="parameter: wanted a name that nothing has yet; got 'a'"):
        lie.deformation(lie.bianchi("VI", "a"), {("1", "2"): {"2": 1}}, parameter="a")
    with pytest.raises(ParameterError, match="parameter: wanted a name that nothing has yet; got 'epsilon'"):
        lie.deformation(lie.abelian(3), {("e1", "e2"): {"e3": "epsilon"}})
    with pytest.raises(ParameterError, match="order: wanted"):
        lie.deformation(lp.so(3), {("1", "2"): {"3": 1}}, order=0)


def plain_jacobi(n, *terms):
    """The coefficients of the powers of t in the Jacobi identity of a sum of t^k terms[k], by their definition."""

    def bracket(k, u, v):
        """The k-th term of two vectors."""
        found = [sp.S.Zero] * n
        for (i, j), row in terms[k].items():
            weight = u[i] * v[j] - u[j] * v[i]
            for m, c in row.items() if weight else ():
                found[m] += weight * c
        return found

    unit = [[sp.S(int(i == j)) for j in range(n)] for i in range(n)]
    for power in range(2 * len(terms) - 1):
        pairs = [(a, power - a) for a in range(len(terms)) if 0 <= power - a < len(terms)]
        for x, y, z in combinations(unit, 3):
            cyclic = ((x, y, z), (y, z, x), (z, x, y))
            parts = [bracket(a, bracket(b, u, v), w) for a, b in pairs for u, v, w in cyclic]
            for k in range(n):
                yield power, sp.expand(sum(part[k] for part in parts))


def test_a_term_of_lower_order_is_mended_where_the_next_order_asks_for_it():
    """With the first solution of order 2 there is none of order 3; with another one the deformation closes."""
    algebra = lie.heisenberg(1) + lie.abelian(1)
    first = {(0, 1): {1: 1}, (0, 2): {2: 1}, (1, 3): {3: 2}}
    found = lie.deformation(algebra, first)
    assert found.closes
    assert found.order == 2
    terms = [algebra.brackets, *(term.values for term in found.terms)]
    assert not any(value for _, value in plain_jacobi(algebra.dimension, *terms))
    assert found.algebra.jacobi_residuals() == {}


OBSTRUCTED = {("q1", "q2"): {"p1": 1}, ("q1", "p2"): {"q1": 1, "p1": 1}, ("p1", "p2"): {"p1": -1}}


@pytest.mark.thorough
def test_an_obstruction_of_order_three_holds_for_all_terms_of_order_two():
    """The equations of orders 2 and 3 are linear in both terms together, and have no solution."""
    algebra = lie.heisenberg(2)
    found = lie.deformation(algebra, OBSTRUCTED)
    assert (found.closes, found.order, found.decided) == (False, 2, True)
    n, unknowns = algebra.dimension, []

    def unknown(letter):
        pairs = combinations(range(n), 2)
        term = {pair: {k: sp.Symbol(f"{letter}{pair[0]}{pair[1]}{k}") for k in range(n)} for pair in pairs}
        unknowns.extend(symbol for row in term.values() for symbol in row.values())
        return term

    terms = [algebra.brackets, found.cocycle.values, unknown("a"), unknown("b")]
    linear = [value for power, value in plain_jacobi(n, *terms) if power in (2, 3) and value]
    matrix, right = sp.linear_eq_to_matrix(linear, unknowns)
    ranks = [sp.polys.matrices.DomainMatrix.from_Matrix(m).to_field().rank() for m in (matrix, matrix.row_join(right))]
    assert ranks[0] < ranks[1]


def test_an_obstruction_of_higher_order_is_not_called_decided():
    filiform = lp.LieAlgebra.from_brackets(5, {(0, 1): {2: 1}, (0, 2): {3: 1}, (0, 3): {4: 1}})
    first = {(0, 2): {1: 1}, (0, 3): {2: 1}, (0, 4): {3: 1}, (1, 2): {4: 1}}
    found = lie.deformation(filiform, first)
    assert found.obstruction is not None
    assert found.order == 3
    assert not found.decided
    assert "for the lower orders that were chosen" in str(found)
    short = lie.deformation(filiform, first, order=2)
    assert (short.closes, short.obstruction, short.decided, short.order) == (False, None, False, 2)
    assert str(short).endswith("whether it goes on is undecided")


@pytest.mark.parametrize("algebra", [lp.sl(3), lie.se(3), lie.galilei(2), lie.affine(2)], ids=str)
def test_the_abelian_algebra_deforms_to_every_algebra(algebra):
    """A cochain on it closes if and only if it is a Lie bracket."""
    plane = lie.abelian(algebra.dimension)
    assert lie.deformation(plane, algebra.brackets).closes
    (pair, row), *_ = algebra.brackets.items()
    wrong = {**algebra.brackets, pair: {k: 2 * c for k, c in row.items()}}
    brackets = lp.LieAlgebra.from_brackets(algebra.dimension, wrong, check=False)
    assert brackets.jacobi_residuals()
    assert not lie.deformation(plane, wrong).closes


@pytest.mark.thorough
@pytest.mark.parametrize("algebra", [lie.se(2), lie.bianchi("IV"), lp.sl(2), lie.heisenberg(1)], ids=str)
def test_a_random_coboundary_is_undone(algebra):
    random, n = Random(2), algebra.dimension
    phi = [[Fraction(random.randint(-2, 2)) for _ in range(n)] for _ in range(n)]  # phi(e_i), row by row
    unit = [[int(i == j) for j in range(n)] for i in range(n)]
    values = {}
    for i, j in combinations(range(n), 2):
        bracket = algebra.bracket(unit[i], unit[j])
        of_bracket = [sum(bracket[k] * phi[k][m] for k in range(n)) for m in range(n)]
        first, second = algebra.bracket(phi[i], unit[j]), algebra.bracket(unit[i], phi[j])
        values[i, j] = {m: first[m] + second[m] - of_bracket[m] for m in range(n)}
    found = lie.deformation(algebra, values)
    assert found.is_trivial
    assert found.representative is algebra
    assert first_order(found.algebra) == {p: dict(row) for p, row in found.cocycle.values.items()}
    rows = [[sp.sympify(v) for v in row] for row in found.change_of_basis]
    for i, j in combinations(range(n), 2):
        left = algebra.bracket(rows[i], rows[j])
        row = found.algebra.brackets.get((i, j), {})
        right = [sum(c * rows[k][m] for k, c in row.items()) for m in range(n)]
        assert all(sp.simplify(a - b) == 0 for a, b in zip(left, right, strict=True))


def test_number_fields_and_symbols_deform_too():
    root = sp.sqrt(2)
    algebra = lp.LieAlgebra.from_brackets(3, {(0, 1): {1: 1}, (0, 2): {2: root}})
    found = lie.deformation(algebra, {(0, 2): {2: root}})
    assert found.closes
    assert found.algebra.brackets[0, 2][2] == root + root * EPSILON
    family = lie.bianchi("VII", "a")
    found = lie.deformation(family, {("e1", "e2"): {"e2": -1}, ("e1", "e3"): {"e3": -1}})
    assert found.closes
    assert not found.is_trivial


def test_the_twisted_top_is_a_deformation_of_the_charged_heavy_top():
    charged, twisted = lp.so(3) @ lp.semidirect(3), lp.so(3) @ lp.leibniz(3, "epsilon")
    twist = {(f"alpha{i}", f"alpha{j}"): {f"beta{k}": 1} for i, j, k in ((1, 2, 3), (2, 3, 1), (3, 1, 2))}
    found = lie.deformation(charged, twist)
    assert found.closes
    assert not found.is_trivial
    assert found.algebra.brackets == lie.current_algebra(twisted).brackets


def test_no_twist_of_the_charged_heavy_top_is_obstructed():
    """H^2 is the space of binary cubics, and the products of every one of them close at the second order."""
    charged, orders = lp.so(3) @ lp.semidirect(3), set()
    representatives = lie.cohomology(charged, 2, "adjoint").representatives
    assert len(representatives) == 4
    for weights in ((1, 0, 0, 0), (0, 1, 0, 0), (1, 2, 0, 0), (1, -1, 2, 3)):
        cubic = combination(
            [(Fraction(w), one) for w, one in zip(weights, representatives, strict=True)], representatives[0]
        )
        found = lie.deformation(charged, cubic)
        assert found.closes
        assert found.algebra.jacobi_residuals() == {}
        orders.add(found.order)
    assert max(orders) == 2
