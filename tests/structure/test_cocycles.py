"""Cocycles of commutative algebras: dimensions, representatives, deformations and obstructions."""

import pickle
import re
import time
from fractions import Fraction
from functools import cache
from itertools import combinations_with_replacement, product

import pytest
import sympy as sp
from commutative import algebra, in_basis
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

import liepoisson as lp
from liepoisson.algebra.coefficients import Coefficients
from liepoisson.errors import BracketError, CocycleError, ObstructionError, ParameterError, ShapeError, TimeLimitError
from liepoisson.structure.classification import classify
from liepoisson.structure.cohomology.commutative_complex import CommutativeComplex
from liepoisson.structure.normal_forms import complex_truncated_polynomials, normal_form_named, normal_forms

numbers = st.integers(-3, 3)
lean = settings(max_examples=15, deadline=None, suppress_health_check=list(HealthCheck))

CHARGED = lp.so(3) @ lp.semidirect(3)
NAMES = ["a", "b", "c", "d"]
SHEARED = [[1, 2, 3], [1, 1, 0], [0, 2, 5]]


@cache
def twists(extension):
    return lp.cocycles(extension)


def null(r):
    """The algebra of dimension r with all products zero: it has no unit."""
    return lp.Extension.from_products(r, {}, f"null({r})")


def tensor_product(A, B):
    n, m = A.dimension, B.dimension
    products = {}
    for (i, j), (k, l) in product(product(range(n), repeat=2), product(range(m), repeat=2)):
        if (i * m + k) <= (j * m + l):
            first = A.products.get((min(i, j), max(i, j)), {})
            second = B.products.get((min(k, l), max(k, l)), {})
            products[i * m + k, j * m + l] = {p * m + q: v * w for p, v in first.items() for q, w in second.items()}
    return lp.Extension.from_products(n * m, products)


KNOWN = [
    *((lp.leibniz(n), n - 1) for n in range(1, 9)),  # x^n = s_0 + ... + s_(n-2) x^(n-2)
    *((null(r), r * r * (r + 1) // 2) for r in range(1, 5)),  # every symmetric map
    (lp.semidirect(3), 4),
    (lp.trivial() + lp.trivial(), 0),
    (complex_truncated_polynomials(1), 0),
    (lp.trivial() + lp.trivial() + lp.trivial(), 0),
    (lp.leibniz(3) + lp.leibniz(4), 2 + 3),
    (complex_truncated_polynomials(2), 2),  # R[x]/(x^2) over C, as a real space
    # A complete intersection R[x, y]/(x^2, y^2): one equation for each of its two relations, modulo derivatives
    (tensor_product(lp.leibniz(2), lp.leibniz(2)), 4),
    (tensor_product(lp.leibniz(3), complex_truncated_polynomials(1)), 4),
    (tensor_product(lp.leibniz(3), lp.trivial() + lp.trivial()), 4),
]


@pytest.mark.parametrize(("extension", "dimension"), KNOWN, ids=str)
def test_known_dimensions(extension, dimension):
    assert twists(extension).dimension == dimension


def tjurina(relation, x, y):
    """The dimension of R[x, y] modulo a polynomial and its derivatives: deformations of a plane curve's germ."""
    basis = sp.groebner([relation, sp.diff(relation, x), sp.diff(relation, y)], x, y)
    assert basis.is_zero_dimensional
    leads = [sp.Poly(p, x, y).monoms()[0] for p in basis.exprs]
    return sum(not any(a >= m and b >= n for m, n in leads) for a, b in product(range(12), repeat=2))


@pytest.mark.parametrize("n", [2, 3, 4, 5])
def test_hypersurfaces_have_as_many_classes_as_the_jacobian_algebra_has_dimensions(n):
    """Of A = R[x]/(p) they are A/(p')."""
    x = sp.Symbol("x")
    p = x ** (n - 1) * (x - 1)
    products = {}
    for i, j in combinations_with_replacement(range(n), 2):
        rest = sp.Poly(sp.rem(x ** (i + j), p, x), x)
        products[i, j] = {k: Fraction(int(c)) for (k,), c in rest.terms() if c}
    found = twists(lp.Extension.from_products(n, products))
    common = sp.gcd(p, sp.diff(p, x))
    assert found.dimension == sp.degree(common, x)


def by_hand(extension):
    """Dimensions of the spaces of cocycles and coboundaries by SymPy's dense linear algebra, without units left out."""
    n, W = extension.dimension, extension.tensor
    pairs = list(combinations_with_replacement(range(n), 2))
    place = {(*pair, k): i for i, (pair, k) in enumerate(product(pairs, range(n)))}
    rows = []
    for a, b, c, m in product(range(n), repeat=4):
        row = [0] * len(place)

        def add(i, j, k, value, row=row):
            row[place[min(i, j), max(i, j), k]] += value

        for k in range(n):
            add(b, c, k, W[m][a][k])
            add(k, c, m, -W[k][a][b])
            add(a, k, m, W[k][b][c])
            add(a, b, k, -W[m][k][c])
        if any(row):
            rows.append(row)
    boundaries = []
    for i, k in product(range(n), repeat=2):
        row = []
        for (p, q), m in product(pairs, range(n)):
            row.append((q == i) * W[m][p][k] + (p == i) * W[m][k][q] - (m == k) * W[i][p][q])
        boundaries.append(row)

    def rank(matrix):
        entries = [
            [sp.Rational(v.numerator, v.denominator) if isinstance(v, Fraction) else v for v in r] for r in matrix
        ]
        return sp.polys.matrices.DomainMatrix.from_Matrix(sp.Matrix(entries)).to_field().rank() if matrix else 0

    return len(place) - rank(rows), rank(boundaries)


@pytest.mark.parametrize(
    "extension",
    [
        lp.leibniz(4),
        lp.semidirect(3),
        normal_form_named("R[x,y]/(x^2 - y^2, xy)"),
        in_basis(normal_form_named("R[x,y]/(x^3, xy, y^2)"), [[1, 2, 0, 1], [0, 1, 1, 3], [1, 1, 2, 0], [0, 0, 1, 1]]),
        algebra(3, {(0, 0): {1: 1}, (2, 2): {2: 5}}, unital=False),
        null(2),
    ],
    ids=str,
)
def test_dimensions_agree_with_linear_algebra_by_hand(extension):
    found = lp.cocycles(extension)
    assert (found.cocycle_dimension, found.coboundary_dimension) == by_hand(extension)
    assert found.derivation_dimension == len((lp.so(3) @ extension).derivations())


@pytest.mark.parametrize("n", range(2, 7))
def test_representatives_of_truncated_polynomials_are_the_deformed_relation(n):
    r"""$x^n = x^i$, read to first order: $f(x^a, x^b) = x^{a+b-n+i}$."""
    found = [f.products for f in twists(lp.leibniz(n)).basis]
    wanted = []
    for i in range(n - 1):
        f = {}
        for a, b in combinations_with_replacement(range(1, n), 2):
            if a + b >= n and a + b - n + i < n:
                f[a, b] = {a + b - n + i: 1}
        wanted.append(f)
    assert found == wanted


def test_representatives_of_null_algebras_are_monomials():
    for f in (*twists(null(3)).basis, *twists(lp.semidirect(4)).basis):
        assert len(f.products) <= 2, f
        assert {value for row in f.products.values() for value in row.values()} <= {1, -1}, f
    assert all(len(f.products) == 1 for f in twists(null(3)).basis)


@pytest.mark.parametrize("extension", [lp.leibniz(4), lp.semidirect(4), lp.leibniz(2) + null(2)], ids=str)
def test_representatives_are_normalised_cocycles(extension):
    for f in twists(extension).basis:
        f.check()
        if extension.is_unital:
            unit = extension.unit()
            n = range(extension.dimension)
            assert not any(sum(unit[m] * f.tensor[k][m][v] for m in n) for k in n for v in n)


FORMS = [form for n in (2, 3, 4) for form in normal_forms(n)]


@pytest.mark.thorough
@lean
@given(st.sampled_from(FORMS), st.data())
def test_dimensions_do_not_depend_on_the_basis(form, data):
    n = form.dimension
    rows = data.draw(st.lists(st.lists(numbers, min_size=n, max_size=n), min_size=n, max_size=n))
    moved = in_basis(form, rows)
    assume(moved is not None)
    found, wanted = lp.cocycles(moved), twists(form)
    assert (found.dimension, found.coboundary_dimension) == (wanted.dimension, wanted.coboundary_dimension)
    for f in found.basis:
        f.check()


@lean
@given(st.sampled_from([*FORMS, null(3), lp.trivial() + lp.leibniz(2)]), st.data())
def test_the_differential_of_a_coboundary_vanishes(extension, data):
    """Of any linear map, the image of the unit included; and the map that comes back has the same coboundary."""
    n, W = extension.dimension, extension.tensor
    g = data.draw(st.lists(st.lists(numbers, min_size=n, max_size=n), min_size=n, max_size=n))
    products = {}
    for i, j in combinations_with_replacement(range(n), 2):
        row = {}
        for m in range(n):
            row[m] = sum(g[j][k] * W[m][i][k] + g[i][k] * W[m][j][k] - W[k][i][j] * g[k][m] for k in range(n))
        products[i, j] = row
    f = twists(extension).cocycle(products)
    assert f.is_coboundary
    assert not any(f.coordinates)
    again = f.coboundary_map()
    for i, j in combinations_with_replacement(range(n), 2):
        for m in range(n):
            value = sum(
                again[j][k] * W[m][i][k] + again[i][k] * W[m][j][k] - W[k][i][j] * again[k][m] for k in range(n)
            )
            assert value == f.tensor[m][i][j]


# From a more degenerate algebra (the tensor has more zeros in the limit) to each local normal form but the null ones.
REACHED = [
    ("R[x,y]/(x,y)^2", {(1, 1): {2: 1}}, "R[x]/(x^3)"),
    ("R[x,y]/(x^3, xy, y^2)", {(1, 3): {2: 1}}, "R[x]/(x^4)"),
    ("R[x,y,z]/(x,y,z)^2", {(1, 1): {3: 1}}, "R[x,y]/(x^3, xy, y^2)"),
    ("R[x,y,z]/(x,y,z)^2", {(1, 2): {3: 1}}, "R[x,y]/(x^2, y^2)"),
    ("R[x,y]/(x^3, xy, y^2)", {(2, 2): {3: 1}}, "R[x,y]/(x^2 - y^2, xy)"),
    ("R[x,y]/(x^3, xy, y^2)", {(2, 2): {3: -1}}, "R[x,y]/(x^2, y^2)"),
    ("R[x,y]/(x^4, xy, y^2)", {(1, 4): {2: 1}, (3, 3): {2: 1}}, "R[x]/(x^5)"),
    ("R[x,y]/(x^4, xy, y^2)", {(2, 2): {4: 1}}, "R[x,y]/(x^3 - y^2, xy)"),
    ("R[x,y,z]/(x^3, xy, xz, y^2, yz, z^2)", {(1, 4): {3: 1}}, "R[x,y]/(x^4, xy, y^2)"),
    ("R[x,y,z]/(x^3, xy, xz, y^2, yz, z^2)", {(1, 2): {3: 1}}, "R[x,y]/(x^3, x^2 y, y^2)"),
    ("R[x,y,z]/(x^3, xy, xz, y^2, yz, z^2)", {(2, 2): {3: 1}}, "R[x,y]/(x^3, xy, y^3)"),
    ("R[x,y]/(x^3, x^2 y, y^2)", {(2, 2): {3: -1}}, "R[x,y]/(x^3, x^2 y, x^2 + y^2)"),
    ("R[x,y]/(x^3, x^2 y, y^2)", {(2, 2): {3: 1}}, "R[x,y]/(x^3, xy, y^3)"),
    ("R[x,y,z,t]/(x,y,z,t)^2", {(1, 1): {4: 1}}, "R[x,y,z]/(x^3, xy, xz, y^2, yz, z^2)"),
    ("R[x,y,z]/(x^3, xy, xz, y^2, yz, z^2)", {(2, 2): {4: -1}}, "R[x,y,z]/(x^2, xz, y^2, yz, z^2)"),
    ("R[x,y,z]/(x^3, xy, xz, y^2, yz, z^2)", {(2, 2): {4: 1}}, "R[x,y,z]/(x^2 - y^2, xy, xz, yz, z^2)"),
    ("R[x,y,z]/(x^2, xz, y^2, yz, z^2)", {(3, 3): {4: 1}}, "R[x,y,z]/(x^2, xy - z^2, xz, y^2, yz)"),
    ("R[x,y,z]/(x^2 - y^2, xy, xz, yz, z^2)", {(3, 3): {4: 1}}, "R[x,y,z]/(x^2 - y^2, x^2 - z^2, xy, xz, yz)"),
]


@pytest.mark.parametrize(
    ("start", "products", "name"), REACHED, ids=lambda value: value if isinstance(value, str) else ""
)
def test_a_normal_form_is_a_deformation_of_a_more_degenerate_one(start, products, name):
    """By a class that is not zero; more derivations, and a smaller orbit, are what makes the start more degenerate."""
    found = twists(normal_form_named(start))
    f = found.cocycle(products)
    assert not f.is_coboundary
    deformed = f.extension(1)
    assert classify(deformed).name == name
    assert lp.cocycles(deformed).derivation_dimension < found.derivation_dimension
    assert classify(f.extension(Fraction(1, 7))).name == name


def test_every_normal_form_but_those_of_the_null_algebras_is_reached():
    reached = {name for _, _, name in REACHED}
    null_ones = {"R", "R[x]/(x^2)", "R[x,y]/(x,y)^2", "R[x,y,z]/(x,y,z)^2", "R[x,y,z,t]/(x,y,z,t)^2"}
    assert reached == {form.name for n in range(1, 6) for form in normal_forms(n)} - null_ones


def test_all_unital_twists_of_two_fields():
    """FACTS: e1 e1 = -a c + b e1 - a e2, e2 e2 = -b d + d e1 - c e2, e1 e2 = -a d, for any a, b, c, d."""
    a, b, c, d = sp.symbols("a b c d")
    f = twists(CHARGED).cocycle({(1, 1): {1: b, 2: -a}, (2, 2): {1: d, 2: -c}})
    deformed = f.deformation("t")
    assert deformed.ends
    assert deformed.order == 2
    products = deformed.extension([1]).products
    table = {(1, 1): {0: -a * c, 1: b, 2: -a}, (2, 2): {0: -b * d, 1: d, 2: -c}, (1, 2): {0: -a * d}}
    assert {pair: row for pair, row in products.items() if pair[0]} == table
    lp.Extension.from_products(3, products)  # associative: verified anew


def test_the_cocycle_alone_is_no_bracket():
    f = twists(CHARGED).cocycle({(1, 1): {1: 2, 2: -1}, (2, 2): {1: 5, 2: -3}})
    rows = {pair: dict(row) for pair, row in CHARGED.extension.products.items()} | f.products
    with pytest.raises(BracketError, match="associative"):
        lp.Extension.from_products(3, rows)
    bracket = f.bracket("t")
    assert bracket.jacobi_certificate().holds
    assert bracket.symbols == {"t"}
    assert bracket.field_names == ("l", "alpha", "beta")
    assert repr(bracket) == "so(3) ⊗ semidirect(3) deformed"


CUBICS = [
    ((0, 0, 0, 0), "R[x,y]/(x,y)^2"),
    ((1, 0, 0, 0), "R[x]/(x^3)"),  # X^3
    ((8, 12, 6, 1), "R[x]/(x^3)"),  # (2 X + Y)^3
    ((0, 1, 0, 0), "R[x]/(x^2) + R"),  # X^2 Y
    ((0, 0, 1, 0), "R[x]/(x^2) + R"),
    ((1, 1, -1, -1), "R[x]/(x^2) + R"),  # (X + Y)^2 (X - Y)
    ((0, 1, 1, 0), "R + R + R"),  # X Y (X + Y)
    ((1, 0, -1, 0), "R + R + R"),
    ((1, 0, -3, 1), "R + R + R"),  # irreducible, three real roots
    ((1, 0, 1, 0), "C + R"),
    ((1, 0, 0, 1), "C + R"),
    ((1, 0, 0, -2), "C + R"),  # irreducible, one real root
]


@pytest.mark.parametrize(("cubic", "name"), CUBICS)
@pytest.mark.parametrize("strength", [1, Fraction(-2, 3)])
def test_the_roots_of_the_cubic_say_what_the_twist_is(cubic, name, strength):
    a, b, c, d = cubic
    f = twists(CHARGED).cocycle({(1, 1): {1: b, 2: -a}, (2, 2): {1: d, 2: -c}})
    assert f.bracket(strength).extension.classify().name == name


def test_a_coboundary_is_undone_exactly():
    bracket = lp.so(3) @ lp.leibniz(3)
    f = twists(bracket).cocycle({(1, 1): {2: 1}})
    change = f.change_of_variables()
    assert change.is_exact
    assert change.text == "beta -> (epsilon + 1)*beta"
    assert change.map().is_poisson(f.bracket("epsilon"), bracket)
    assert not change.map().is_poisson(bracket, f.bracket("epsilon"))
    assert not change.map("1/2").is_poisson(f.bracket("1/3"), bracket)
    with pytest.raises(ParameterError, match=re.escape("whose class has the coordinates (1, 0)")):
        twists(bracket).basis[0].change_of_variables()


def test_a_nilpotent_change_ends_at_an_order_of_its_own():
    """x -> x + t x^2 on R[x]/(x^4): the products change up to t^2, and the way back is a polynomial, too."""
    found = twists(lp.so(3) @ lp.leibniz(4))
    g = [[0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 1], [0, 0, 0, 0]]  # x^2 -> x^2 + t x^3
    f = found.cocycle({(1, 1): {3: -1}})
    assert f.is_coboundary
    change = f.change_of_variables()
    assert change.is_exact
    assert change.map("t").is_poisson(f.bracket("t"), found.given)
    assert change.matrices == (tuple(tuple(-Fraction(v) for v in row) for row in g),)


def test_a_change_of_variables_may_be_the_inverse_of_one_that_ends():
    """e0 e0 = (1 + t) e0: the fields go to l/(1 + t)."""
    bracket = lp.so(3) @ (lp.trivial() + lp.trivial())
    f = twists(bracket).cocycle({(0, 0): {0: 1}})
    change = f.change_of_variables()
    assert change.is_exact
    assert change.is_inverse
    assert change.text == "l -> (1 - epsilon)*l"
    assert change.map("t").is_poisson(f.bracket("t"), bracket)
    assert change.map(2).matrix[0][0] == Fraction(1, 3)


def test_a_coboundary_whose_series_does_not_end_is_undone_exactly_too():
    bracket = lp.so(3) @ in_basis(lp.leibniz(3), SHEARED)
    found = lp.cocycles(bracket)
    g = [[0, 1, 2], [1, 0, -1], [3, 1, 1]]
    W, n = bracket.extension.tensor, range(3)
    products = {}
    for i, j in combinations_with_replacement(n, 2):
        products[i, j] = {
            m: sum(g[j][k] * W[m][i][k] + g[i][k] * W[m][j][k] - W[k][i][j] * g[k][m] for k in n) for m in n
        }
    f = found.cocycle(products)
    change = f.change_of_variables()
    assert change.is_exact
    assert change.map("1/7").is_poisson(f.bracket("1/7"), bracket)


def test_the_first_order_holds_where_no_series_ends():
    """e0 - e1 has a square root in front: the change of variables is no rational function."""
    found = twists(lp.trivial() + lp.trivial())
    f = found.cocycle({(0, 0): {0: 1, 1: 1}, (0, 1): {0: -1, 1: -1}, (1, 1): {0: 1, 1: 1}})
    change = f.change_of_variables()
    assert not change.is_exact
    assert not change.is_inverse
    t = sp.Symbol("t")
    P, n = change.map("t").matrix, range(2)
    deformed = f.extension("t")
    for i, j, m in product(n, repeat=3):  # psi(a b) = psi(a) * psi(b), up to the first power of t
        left = sum(sp.sympify(found.extension.tensor[k][i][j]) * P[k][m] for k in n)
        right = sum(P[i][a] * P[j][b] * sp.sympify(deformed.tensor[m][a][b]) for a in n for b in n)
        assert all(sp.Poly(sp.expand(left - right), t).coeff_monomial(t**k) == 0 for k in (0, 1))


def test_obstructions_of_the_null_algebra_are_associativity():
    found = twists(null(2))
    f = found.cocycle({(0, 0): {1: 1}, (0, 1): {0: 1}})
    obstruction = f.obstruction()
    assert obstruction.order == 2
    assert obstruction.is_proved
    assert obstruction.triple == (0, 0, 1)
    with pytest.raises(ObstructionError, match=r"at order 2 the residual for \(e_0, e_0, e_1\) is -e1") as caught:
        f.extension("t")
    assert (caught.value.order, caught.value.triple) == (2, ("e_0", "e_0", "e_1"))
    assert found.cocycle({(0, 0): {1: 1}}).obstruction() is None


@pytest.mark.thorough
@lean
@given(st.lists(numbers, min_size=6, max_size=6))
def test_conditions_vanish_where_and_only_where_products_are_associative(values):
    found = twists(null(2))
    general = found.deformation()
    s = sp.symbols("s1:7")
    vanish = all(condition.subs(dict(zip(s, values, strict=True))) == 0 for condition in general.conditions)
    f = found.combination(values)
    try:
        lp.Extension.from_products(2, f.products)
        associative = True
    except BracketError:
        associative = False
    assert vanish == associative == (f.obstruction() is None)
    if vanish:
        assert general.extension(values).products == f.products
    else:
        with pytest.raises(BracketError, match="its conditions vanish"):
            general.extension(values)


def test_an_obstruction_beyond_the_square():
    """The conditions of R[x,y,z]/(x,y,z)^2 are quadratic and vanish on each curve that a deformation follows."""
    found = twists(lp.semidirect(4))
    conditions = found.conditions()
    assert conditions
    s = sp.symbols("s1:16")
    assert {sp.Poly(p, *s).total_degree() for p in conditions} <= {2, 3, 4}
    along = found.cocycle({(1, 1): {2: 1}, (1, 2): {3: 1}})
    values = dict(zip(s, along.coordinates, strict=True))
    assert all(p.subs(values) == 0 for p in conditions)
    assert classify(along.extension(1)).name == "R[x]/(x^4)"


@pytest.mark.thorough
@pytest.mark.parametrize("form", [form for n in range(2, 6) for form in normal_forms(n)][:-1], ids=str)
def test_only_algebras_with_three_generators_have_obstructions(form):
    """Points of a surface: their Hilbert scheme is smooth (Fogarty 1968).  Of four points in space there is a cone."""
    general = twists(form).deformation()
    assert general.ends
    if form.hilbert_function()[1:2] <= (2,):
        assert general.conditions == ()
    elif form.hilbert_function() == (1, 3):
        assert len(general.conditions) == 15  # Pluecker's relations of lines in five-space, and no others


@pytest.mark.thorough
def test_a_term_of_second_order_may_have_to_contain_a_cocycle():
    """The square of f is a differential, but the straight line of classes is obstructed at order three."""
    found = twists(normal_form_named("R[x,y,z]/(x^3, xy, xz, y^2, yz, z^2)"))
    f = found.cocycle({(1, 2): {3: 1}, (1, 3): {2: 1}})
    deformed = f.deformation("t")
    assert deformed.ends
    lp.Extension.from_products(5, deformed.extension().products)  # associative: verified anew
    assert f.obstruction() is None
    general = found.deformation()
    straight = dict(zip(general.parameters, f.coordinates, strict=True))
    assert any(condition.subs(straight) != 0 for condition in general.conditions)


@pytest.mark.parametrize(
    "form", [lp.leibniz(4), lp.trivial() + lp.leibniz(3), complex_truncated_polynomials(2)], ids=str
)
def test_the_unit_is_put_into_no_argument(form):
    """In any basis: one basis element is left out, and what is left has the same cohomology as all cochains."""
    moved = in_basis(form, [[1, 2, 0, 1], [0, 1, 1, 3], [1, 1, 2, 0], [0, 0, 1, 1]])
    complex_ = CommutativeComplex.of(4, moved.products, Coefficients())
    assert tuple(complex_.unit) == moved.unit()
    assert len(complex_.arguments) == 3
    assert len(complex_.plain.arguments) == 4
    assert len(complex_.basis) == len(complex_.plain.basis) == twists(form).dimension
    assert complex_.n_coboundaries == complex_.plain.n_coboundaries
    for f in complex_.basis:
        assert not complex_.plain.of_cochain(complex_.with_unit(f))
        assert complex_.is_normalised(complex_.with_unit(f))
    for D in complex_.derivations:
        assert not complex_.plain.of_map(D)


def test_the_general_deformation_of_a_truncated_algebra_has_all_roots():
    """x^n = s_0 + ... + s_(n-2) x^(n-2): associative for all values, and any roots with sum zero are reached."""
    found = twists(lp.leibniz(4))
    general = found.deformation(["p", "q", "r"])
    assert general.conditions == ()
    assert general.ends
    lp.Extension.from_products(4, general.extension().products)
    x = sp.Symbol("x")
    polynomial = sp.Poly((x - 1) * (x - 2) * (x + 4) * (x + 1) - 0, x)  # the sum of the roots is -2: shift
    shifted = sp.Poly(polynomial.as_expr().subs(x, x - sp.Rational(1, 2)), x)
    _, third, *rest = shifted.all_coeffs()
    assert third == 0
    values = [-c for c in reversed(rest)]
    assert general.extension(values).classify().name == "R + R + R + R"


@pytest.mark.thorough
@pytest.mark.parametrize("form", [lp.semidirect(3), lp.leibniz(3)], ids=str)
def test_in_any_basis_a_twist_is_an_algebra_for_every_value_of_its_parameter(form):
    """The grading is hidden there, and the series need not end: rational functions then."""
    found = lp.cocycles(in_basis(form, SHEARED))
    t = sp.Symbol("t")
    for f in found.basis:
        deformed = f.extension("t")
        lp.Extension.from_products(3, f.extension("1/5").products)  # associative: verified anew
        for i, j, k in product(range(3), repeat=3):
            slope = sp.diff(sp.sympify(deformed.tensor[k][i][j]), t).subs(t, 0)
            assert slope == sp.sympify(f.tensor[k][i][j])
    general = found.deformation()
    assert general.conditions == ()
    assert general.ends or general.closed_form is not None
    values = list(range(1, found.dimension + 1))
    lp.Extension.from_products(3, general.extension(values).products)


def test_symbols_are_generic_and_exceptional_values_are_told():
    found = twists(lp.leibniz(4, "epsilon"))
    assert found.dimension == 3
    assert [(case.condition, case.twists.dimension) for case in found.exceptional] == [("epsilon = 0", 15)]
    assert found.examined == ("epsilon = 0",)
    assert found.undecided == ()
    assert twists(lp.extensions.crmhd()).exceptional[0].condition == "beta_e = 0"
    assert twists(lp.leibniz(4)).exceptional == ()
    # x^2 = p x + q: two points unless p^2 + 4 q = 0, which is solved for q
    quadratic = lp.cocycles(algebra(2, {(1, 1): {0: "q", 1: "p"}}))
    assert quadratic.dimension == 0
    assert [(case.condition, case.twists.dimension) for case in quadratic.exceptional] == [("q = -p**2/4", 1)]


@pytest.mark.parametrize("entry", ["sqrt(2)", "2*cos(2*pi/7)", "pi", "3^(1/3)"])
def test_fields_beyond_the_rational_numbers(entry):
    extension = algebra(3, {(1, 1): {2: entry}})
    found = lp.cocycles(extension)
    assert found.dimension == 2
    assert found.derivation_dimension == 2
    f = found.combination([1, entry])
    assert f.deformation().ends
    assert [
        sp.simplify(sp.sympify(c) - w)
        for c, w in zip(f.coordinates, (1, sp.sympify(entry.replace("^", "**"))), strict=True)
    ] == [0, 0]
    square = found.cocycle({(1, 1): {2: 1}})
    assert square.is_coboundary


def test_cocycles_and_deformations_are_pickled():
    found = lp.cocycles(lp.so(3) @ lp.leibniz(3, "epsilon"))
    f = found.combination(["k", 2])
    assert f.coordinates == (sp.Symbol("k"), 2)
    again = pickle.loads(pickle.dumps(f))
    assert again.products == f.products
    assert again.twists.dimension == 2
    general = pickle.loads(pickle.dumps(found.deformation()))
    assert general.extension([1, 0]).products == found.deformation().extension([1, 0]).products


def test_cocycles_are_combined():
    f, g, *_ = twists(CHARGED).basis
    assert (2 * f - g).products == {(1, 1): {2: 2}, (1, 2): {2: -1}}
    assert (f - f).products == {}
    assert (f * "k").products == {(1, 1): {2: sp.Symbol("k")}}
    assert (2 * f - g).coordinates == (2, -1, 0, 0)
    assert (-f).tensor[2][1][1] == -1
    assert sum(twists(CHARGED).basis) == twists(CHARGED).combination([1, 1, 1, 1])
    assert f / 2 == f * "1/2" != f
    assert len({f, 1 * f, lp.cocycles(CHARGED).basis[0], g}) == 2
    assert f != "f"


def test_a_cocycle_that_moves_the_unit_has_its_class_all_the_same():
    """f = product + basis element: the product itself is the coboundary of the identity, up to derivations."""
    found = twists(lp.semidirect(3))
    f = found.cocycle(lp.semidirect(3).products) + found.basis[2]
    assert f.coordinates == (0, 0, 1, 0)
    assert f.representative.products == found.basis[2].products
    assert f.coboundary_map()[0] == (1, 0, 0)
    assert classify(f.extension(1)).name == "R[x]/(x^3)"


@pytest.mark.parametrize(
    ("extension", "products", "triple"),
    [
        (lp.leibniz(3), {(1, 2): {0: 1}, (2, 2): {1: -1}}, "(e_1, e_1, e_2)"),  # a sign flipped
        (lp.leibniz(3), {(1, 2): {0: 1}, (2, 2): {1: 2}}, "(e_1, e_1, e_2)"),  # a coefficient changed
        (lp.semidirect(3), {(1, 1): {0: 1}}, "(e_1, e_1, e_2)"),
        (lp.semidirect(3), {(0, 0): {0: 1}}, "(e_0, e_0, e_1)"),
    ],
)
def test_a_cochain_that_is_no_cocycle_is_refused(extension, products, triple):
    with pytest.raises(CocycleError, match=re.escape(f"for {triple} this is ")) as caught:
        twists(extension).cocycle(products)
    assert f"({', '.join(caught.value.triple)})" == triple
    assert caught.value.residual != "0"


def test_refusals():
    found = twists(CHARGED)
    with pytest.raises(ParameterError, match="wanted a Bracket or an Extension"):
        lp.cocycles(lp.so(3))
    with pytest.raises(ShapeError, match="coefficients must be 4"):
        found.combination([1, 2])
    with pytest.raises(ParameterError, match="parameters: wanted different names"):
        found.deformation(["alpha1", "b", "c", "d"])
    with pytest.raises(ShapeError, match="parameters must be 4 names"):
        found.deformation(["a"])
    with pytest.raises(ParameterError, match="parameter: wanted a name that nothing has yet"):
        found.basis[0].deformation("alpha")
    with pytest.raises(ParameterError, match="needs a Lie algebra"):
        twists(lp.semidirect(3)).basis[0].bracket()
    moving = (lp.so(3) @ lp.semidirect(3)).with_constant({("l1", "l2"): 1, ("l1", "l3"): 2})
    for bracket in (moving, lp.canonical(2)):
        with pytest.raises(BracketError, match="wanted a bracket without constant part"):
            lp.cocycles(bracket)
    with pytest.raises(ParameterError, match="cocycles of one algebra"):
        found.basis[0] + 1
    with pytest.raises(ParameterError, match="cocycles of one algebra"):
        1 + found.basis[0]
    with pytest.raises(ParameterError, match="must not be 0"):
        found.basis[0] / 0
    with pytest.raises(ParameterError, match="cocycles are added if they are of one algebra"):
        found.basis[0] + twists(lp.leibniz(3)).basis[0]
    with pytest.raises(ParameterError, match="order must be an integer"):
        found.basis[0].deformation(order=0)
    general = found.deformation(NAMES)
    with pytest.raises(ShapeError, match="values must be 4"):
        general.extension([1])
    with pytest.raises(ParameterError, match="wanted the parameters a, b, c, d"):
        general.extension({"e": 1})
    assert general.extension({"a": 1, "b": 0, "c": 0, "d": 0}).classify().name == "R[x]/(x^3)"
    with pytest.raises(BracketError, match="associative"):
        lp.cocycles(lp.Extension([[[0, 1], [1, 0]], [[1, 0], [0, 0]]], check=False))


@pytest.mark.thorough
def test_a_call_ends_soon_after_its_limit():
    began = time.process_time()
    with pytest.raises(TimeLimitError, match="time limit"):
        lp.cocycles(lp.leibniz(60), time_limit=0.2)
    with pytest.raises(TimeLimitError, match="time limit"):
        lp.cocycles(lp.semidirect(30), time_limit=0.2)
    with pytest.raises(TimeLimitError, match="time limit"):
        twists(lp.semidirect(7)).deformation(time_limit=0.2)
    assert time.process_time() - began < 2 * 2


def test_products_have_no_value_at_a_pole():
    """The products of this coboundary of R[x]/(x^2) have the denominator t^2 - 1."""
    f = twists(lp.semidirect(2)).cocycle({(0, 0): {1: 1}, (1, 1): {1: 2}})
    assert classify(f.extension("1/2")).name == "R[x]/(x^2)"
    for call in (lambda: f.extension(1), lambda: f.change_of_variables().map(-1)):
        with pytest.raises(ParameterError, match="as at a pole of the products"):
            call()


def test_a_coboundary_is_never_obstructed():
    """Orders of one power of t each do not mend it; the pull-back by 1 + t g does."""
    algebra = lp.Extension.from_products(4, {(0, 0): {1: 1}, (2, 2): {3: 1}})
    f = twists(algebra).cocycle({(0, 2): {3: 1}, (0, 3): {1: 1}, (2, 2): {0: -1, 2: -1}, (2, 3): {3: 1}})
    assert f.is_coboundary
    assert f.obstruction() is None
    assert f.change_of_variables().is_exact
    deformed = lp.Extension.from_products(4, f.extension("t").products)  # associative: verified anew
    t = sp.Symbol("t")
    rates = {
        pair: {k: sp.sympify(value).diff(t).subs(t, 0) for k, value in row.items()}
        for pair, row in deformed.products.items()
    }
    assert {pair: kept for pair, row in rates.items() if (kept := {k: v for k, v in row.items() if v})} == f.products


def test_the_change_of_one_field_is_exact():
    """e0 -> (1 + t) e0."""
    assert lp.cocycles(lp.trivial()).cocycle({(0, 0): {0: 1}}).change_of_variables().is_exact
