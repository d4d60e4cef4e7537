import pickle
from fractions import Fraction

import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.structure.bracket import Bracket
from liepoisson.structure.extension import Extension
from liepoisson.structure.extensions import leibniz, semidirect, trivial
from liepoisson.structure.lie_algebra import LieAlgebra
from liepoisson.structure.lie_algebras import abelian, affine, se, sine, so, su
from liepoisson.structure.poisson.poisson_tensor import LinearPoissonTensor

EPSILON = sp.Symbol("epsilon")


def hat(u):
    """The matrix of v -> u x v."""
    return sp.Matrix([[0, -u[2], u[1]], [u[2], 0, -u[0]], [-u[1], u[0], 0]])


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


def test_entries_are_the_upper_half_of_the_poisson_tensor():
    bracket = so(3) @ leibniz(3, "epsilon")
    J = sp.zeros(9, 9)
    for i, j, m, c in bracket.entries():
        assert i < j
        J[i, j] += c * bracket.variables[m]
        J[j, i] -= c * bracket.variables[m]
    assert bracket.poisson_tensor() == J
    assert all(isinstance(c, Fraction) for *_, c in (so(3) @ leibniz(3)).entries())


@pytest.mark.parametrize(
    ("extension", "point", "rank"),
    [
        # epsilon != 0: rank 6 whenever beta != 0, also where alpha is parallel to beta
        (leibniz(3), (1, 2, -1, 0, 0, 2, 0, 0, 1), 6),
        (leibniz(3, "epsilon"), (0, 0, 0, 0, 0, 0, 0, 0, 1), 6),
        (leibniz(3), (1, 2, -1, 0, "1/3", 2, 0, 0, 0), 4),
        (leibniz(3), (1, 2, -1, 0, 0, 0, 0, 0, 0), 2),
        (leibniz(3), (0,) * 9, 0),
        (leibniz(3), (1, 0, 2, sp.sqrt(2), 0, 0, 0, 0, 0), 4),
        # epsilon = 0: rank 6 only where alpha x beta != 0
        (semidirect(3), (1, 2, -1, 0, 0, 2, 0, 0, 1), 4),
        (semidirect(3), (1, 2, -1, 0, 1, 2, 0, 0, 1), 6),
    ],
)
def test_rank_at_a_point(extension, point, rank):
    bracket = so(3) @ extension
    assert bracket.rank(point) == rank
    assert bracket.corank(point) == 9 - rank
    values = dict(zip(bracket.variables, map(sp.sympify, point), strict=True))
    assert bracket.poisson_tensor().subs(values).rank() == rank


TWISTED = lp.so(3) @ lp.leibniz(3, "epsilon")


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


def test_copies_and_renamed_brackets():
    TWISTED.casimir_report()
    again = pickle.loads(pickle.dumps(TWISTED))
    assert again.entries() == TWISTED.entries()
    assert set(again.__dict__) <= {"algebra", "extension", "constant_rows", "_name", "_terms", "_kept_terms"}
    bracket = (so(3) @ leibniz(2)).rename("m", "p")
    assert (bracket.coordinate_names_in_order, bracket.field_lengths) == (("m1", "m2", "m3", "p1", "p2", "p3"), (3, 3))
    m, p = bracket.fields.values()
    assert bracket.casimirs() == [m.dot(p), p.dot(p)]
    for key in ("epsilon", sp.Symbol("epsilon"), sp.Symbol("epsilon", positive=True)):
        assert TWISTED.substitute({key: 2}).symbols == set()


def flipped(algebra, pair):
    brackets = {p: {k: -c if p == pair else c for k, c in row.items()} for p, row in algebra.brackets.items()}
    return LieAlgebra.from_brackets(algebra.dimension, brackets, algebra.name, algebra.basis_names, check=False)


def test_the_certificate_counts_triples():
    certificate = (so(3) @ leibniz(3, "epsilon")).jacobi_certificate()
    assert certificate.holds
    assert certificate.n_triples == 84
    assert certificate.method == "computed: all 84 triples of coordinates"
    one, none = so(3) @ leibniz(1), abelian(2) @ leibniz(1)
    assert one.jacobi_certificate().method == "computed: the one triple of coordinates"
    assert none.jacobi_certificate().method == "computed: pairs; there are no triples of coordinates"
    assert str(certificate).startswith("Jacobi identity proved")
    large = (su(5) @ leibniz(3)).jacobi_certificate()
    assert (large.holds, large.n_triples) == (True, 59640)


@pytest.mark.parametrize(("algebra", "pair"), [(se(3), (0, 4)), (sine(3), (0, 2))])
def test_the_first_failure_is_named_with_its_residual(algebra, pair):
    """The sines of the second are divided by pi: its residual is quadratic in them."""
    bracket = flipped(algebra, pair) @ trivial()
    certificate = bracket.jacobi_certificate()
    failure, x = certificate.failures[0], {str(v): v for v in bracket.variables}
    u, v, w = (x[name] for name in failure.coordinates)
    nested = bracket(bracket(u, v), w) + bracket(bracket(v, w), u) + bracket(bracket(w, u), v)
    assert sp.expand(nested - failure.residual) == 0
    assert failure.residual.has(sp.pi) is (algebra.name == "sine(3)")
    assert "the Jacobi identity fails for" in str(failure)


def test_a_tensor_that_is_not_symmetric_breaks_antisymmetry():
    W = [[list(row) for row in plane] for plane in leibniz(2).tensor]
    W[1][0][1] = Fraction(3)
    certificate = Bracket(so(3), Extension(W, check=False)).jacobi_certificate()
    assert not certificate.holds
    assert "antisymmetry fails for" in str(certificate)


# x' = x, y' = y + x, z' = -z under e0: the invariant y/x - log x is no polynomial, and neither is its power.
SHEARED = LieAlgebra.from_brackets(4, {(0, 1): {1: 1}, (0, 2): {1: 1, 2: 1}, (0, 3): {3: 2}})


@pytest.mark.parametrize(
    ("bracket", "lower", "upper", "words"),
    [
        (so(3) @ leibniz(3, "epsilon"), 6, 6, "rank 6 proved"),
        (so(3) @ semidirect(4), 6, 6, "rank 6 proved"),
        (su(3) @ leibniz(2), 12, 12, "rank 12 proved"),
        (affine(1) @ trivial(), 2, 2, "rank 2 proved"),
        (SHEARED @ trivial(), 2, 4, "rank at least 2, at most 4"),
    ],
)
def test_rank_certificates_say_what_is_proved(bracket, lower, upper, words):
    certificate = bracket.rank_certificate()
    assert (certificate.lower, certificate.upper, certificate.proved) == (lower, upper, lower == upper)
    assert words in str(certificate)


def test_the_rank_of_the_tensor_is_found_with_and_without_images_modulo_primes():
    """x' = (a log(2) + sqrt(a)) y: a field that SymPy only simplifies in."""
    twisted, heavy = (so(3) @ leibniz(3)).tensor, (so(3) @ semidirect(2)).tensor
    assert twisted.generic_rank.rank == twisted.rank_at_a_point == 6
    assert twisted.restricted(range(6)).rows == twisted.restricted([0, 1, 2, 6, 7, 8]).rows == heavy.rows
    a = sp.Symbol("a", positive=True)
    c = a * sp.log(2) + sp.sqrt(a)
    tensor = LinearPoissonTensor.of(3, [(0, 1, 2, c), (1, 0, 2, -c)])
    assert (tensor.generic_rank, tensor.rank_at_a_point) == (None, 2)
