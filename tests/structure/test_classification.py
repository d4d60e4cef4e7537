import pytest
import sympy as sp
from commutative import algebra, assert_normal, in_basis
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from liepoisson.structure.classification import classify
from liepoisson.structure.extension import Extension
from liepoisson.structure.extensions import crmhd, leibniz, semidirect, trivial
from liepoisson.structure.normal_forms import (
    complex_name,
    complex_truncated_polynomials,
    normal_form_named,
    normal_forms,
    null_square,
    truncated_polynomials,
)

numbers = st.fractions(-4, 4, max_denominator=3)
lean = settings(max_examples=15, deadline=None, suppress_health_check=list(HealthCheck))

MIXED = [[1, 2, 0, 1], [0, 1, 1, 3], [1, 1, 2, 0], [0, 0, 1, 1]]
SHEARED = [[int(k - j in (0, 2, 3)) for k in range(6)] for j in range(6)]


@pytest.mark.parametrize(
    ("extension", "name"),
    [
        (leibniz(3), "R[x]/(x^3)"),
        (leibniz(3, "-5/7"), "R[x]/(x^3)"),
        (leibniz(3, 0), "R[x,y]/(x,y)^2"),
        (leibniz(8, 3), "R[x]/(x^8)"),
        (crmhd(1), "R[x,y]/(x^2, y^2)"),
        (semidirect(1), "R"),
        (semidirect(5), "R[x,y,z,t]/(x,y,z,t)^2"),
        (trivial() + leibniz(3), "R[x]/(x^3) + R"),
        (leibniz(2) + leibniz(3), "R[x]/(x^3) + R[x]/(x^2)"),
        # x^3 = x splits into three lines, x^3 = x^2 into a double point and a line
        (algebra(3, {(1, 1): {2: 1}, (1, 2): {1: 1}, (2, 2): {2: 1}}), "R + R + R"),
        (algebra(3, {(1, 1): {2: 1}, (1, 2): {2: 1}, (2, 2): {2: 1}}), "R[x]/(x^2) + R"),
        # x^2 = s, x s = c t, x y = m t, y^2 = b t: y - (m/c) s has square b t
        (algebra(5, {(1, 1): {3: 3}, (1, 3): {4: 2}, (1, 2): {4: -1}, (2, 2): {4: 5}}), "R[x,y]/(x^3 - y^2, xy)"),
        (algebra(5, {(1, 1): {3: 3}, (1, 3): {4: 2}, (1, 2): {4: -1}}), "R[x,y]/(x^4, xy, y^2)"),
        # without a unit one is added
        (algebra(1, {}, unital=False), "maximal ideal of R[x]/(x^2)"),
        (algebra(3, {(0, 0): {1: 1}, (2, 2): {2: 5}}, unital=False), "R + maximal ideal of R[x]/(x^3)"),
        (algebra(3, {(0, 0): {2: 1}, (1, 1): {2: 1}}, unital=False), "maximal ideal of R[x,y]/(x^2 - y^2, xy)"),
        (
            in_basis(complex_truncated_polynomials(2), [[1, 2, 0, 1], [0, 1, 1, 3], [1, 1, 2, 0], [0, 0, 1, 1]]),
            "C[x]/(x^2)",
        ),
        (
            in_basis(complex_truncated_polynomials(3), [[int(k - j in (0, 2, 3)) for k in range(6)] for j in range(6)]),
            "C[x]/(x^3)",
        ),
    ],
    ids=repr,
)
def test_named_extensions_have_their_normal_form(extension, name):
    found = classify(extension)
    assert found.name == name
    assert found.field_extension == "Q"
    assert found.is_local == (" + " not in name and "maximal ideal" not in name)
    assert found.is_unital == ("maximal ideal" not in name)
    assert_normal(extension, found)


@pytest.mark.thorough
@settings(lean, max_examples=4)
@given(st.data())
@pytest.mark.parametrize("form", [form for n in range(1, 6) for form in normal_forms(n)], ids=repr)
def test_a_change_of_basis_is_recognised(form, data):
    n = form.dimension
    rows = data.draw(st.lists(st.lists(numbers, min_size=n, max_size=n), min_size=n, max_size=n))
    moved = in_basis(form, rows)
    assume(moved is not None)
    found = classify(moved)
    assert found.normal_form.name == form.name
    assert found.field_extension == "Q"  # it is possible over Q, so no root may be asked for
    assert in_basis(moved, found.change_of_basis).tensor == form.tensor


@pytest.mark.thorough
@lean
@given(d=st.sampled_from([2, 3]), data=st.data())
def test_a_quadratic_form_decides_by_its_signature(d, data):
    entries = {(i, j): data.draw(st.integers(-6, 6)) for i in range(d) for j in range(i, d)}
    assume(any(entries.values()))
    A = algebra(d + 2, {(i + 1, j + 1): {d + 1: q} for (i, j), q in entries.items() if q})
    (factor,) = classify(A).factors
    form = sp.Matrix(d, d, lambda i, j: entries[min(i, j), max(i, j)])
    # Descartes' rule: all roots of the characteristic polynomial are real
    x = sp.Symbol("x")
    polynomial = sp.Poly(form.charpoly(x).as_expr(), x)
    positive = sum(m for root, m in polynomial.real_roots(multiple=False) if root > 0)
    negative = sum(m for root, m in polynomial.real_roots(multiple=False) if root < 0)
    assert factor.signature == (max(positive, negative), min(positive, negative))
    assert factor.normal_form is not None  # and the change of basis was verified on the way


@settings(lean, max_examples=6)
@given(relation=st.tuples(numbers, numbers, numbers), scales=st.tuples(numbers, numbers))
def test_one_relation_between_two_generators_decides_by_its_discriminant(relation, scales):
    """p x^2 + q xy + r y^2 = 0: a double line, two lines or none."""
    p, q, r = relation
    assume(p and all(scales))
    A = algebra(
        5, {(1, 1): {3: -q / p * scales[0], 4: -r / p * scales[1]}, (1, 2): {3: scales[0]}, (2, 2): {4: scales[1]}}
    )
    (factor,) = classify(A).factors
    discriminant = q * q - 4 * p * r
    names = {0: "R[x,y]/(x^3, x^2 y, y^2)", 1: "R[x,y]/(x^3, xy, y^3)", -1: "R[x,y]/(x^3, x^2 y, x^2 + y^2)"}
    assert factor.name == names[(discriminant > 0) - (discriminant < 0)]


@pytest.mark.parametrize(
    ("squares", "field"),
    [
        ((1, 2), "Q(sqrt(2))"),
        ((2, 8), "Q"),
        ((1, 1, 3), "Q(sqrt(3))"),  # anisotropic at 3, as x^2 + y^2 = -3 z^2 shows
        ((1, 1, -3), "Q(sqrt(3))"),
        ((1, 1, -5), "Q"),  # 1 + 4 = 5
        ((2, 3, 6), "Q"),  # 6, 6, 6 on (1, 1, 0), ... : Witt and Hasse decide
        ((1, sp.sqrt(2)), "Q(sqrt(2), 2**(1/4))"),
    ],
)
def test_square_roots_are_adjoined_only_where_they_are_needed(squares, field):
    n = len(squares) + 2
    A = algebra(n, {(k + 1, k + 1): {n - 1: q} for k, q in enumerate(squares)})
    found = classify(A)
    assert found.is_local
    assert found.field_extension == field
    assert bool(found.adjoined) == (field != "Q")
    assert_normal(A, found)


def test_the_complex_numbers_are_one_field():
    found = classify([[[1, 0], [0, -2]], [[0, 1], [1, 0]]])  # e1 e1 = -2
    assert (found.name, found.complex_name, found.field_extension) == ("C", "C + C", "Q(sqrt(2))")
    assert (found.is_local, found.factors[0].residue_field) == (True, "C")
    assert found.change_of_basis == ((1, 0), (0, sp.sqrt(2) / 2))
    definite, indefinite = (classify(algebra(4, {(1, 1): {3: 1}, (2, 2): {3: sign}})) for sign in (1, -1))
    assert (definite.name, indefinite.name) == ("R[x,y]/(x^2 - y^2, xy)", "R[x,y]/(x^2, y^2)")
    assert definite.complex_name == indefinite.complex_name == "C[x,y]/(x^2, y^2)"


def test_fields_of_higher_degree_are_counted_by_their_places():
    cubic = classify(algebra(3, {(1, 1): {2: 1}, (1, 2): {0: 2}, (2, 2): {1: 2}}))  # x^3 = 2: one real root
    assert (cubic.name, cubic.change_of_basis, cubic.field_extension) == ("C + R", None, "Q(roots of x**3 - 2)")
    real = algebra(3, {(1, 1): {2: 1}, (1, 2): {0: -1, 1: 3}, (2, 2): {1: -1, 2: 3}})  # x^3 = 3 x - 1: three
    assert classify(real).name == "R + R + R"
    split = algebra(4, {(1, 1): {0: 2}, (1, 2): {3: 1}, (1, 3): {2: 2}})  # Q(sqrt 2)[x]/(x^2)
    found = classify(split)
    assert (found.name, found.field_extension) == ("R[x]/(x^2) + R[x]/(x^2)", "Q(sqrt(2))")
    assert_normal(split, found)


def test_a_symbol_gives_the_generic_answer_and_its_exceptions():
    found = classify(leibniz(3, "epsilon"))
    assert found.name == "R[x]/(x^3)"
    assert [str(c) for c in found.conditions] == ["epsilon"]
    assert [(name, value, other.name) for name, value, other in found.exceptional] == [("epsilon", 0, "R[x,y]/(x,y)^2")]
    assert found.change_of_basis[2][2] == sp.Symbol("epsilon")
    assert str(found) == "Leibniz(3, epsilon) is R[x]/(x^3) for epsilon != 0; epsilon = 0: R[x,y]/(x,y)^2"
    assert_normal(leibniz(3, "epsilon"), found)


def test_exceptional_cases_are_told_with_their_own_conditions():
    found = classify(algebra(4, {(1, 1): {2: "s"}, (1, 2): {3: "t"}}))
    head, *cases = str(found).split("; ")
    assert head.endswith("for s != 0, t != 0")
    wanted = {"s = 0, t != 0": (0, 1), "t = 0, s != 0": (1, 0), "s = t = 0": (0, 0)}
    assert {case.split(": ")[0] for case in cases} == set(wanted)
    for case in cases:
        where, name = case.split(": ")
        s, t = wanted[where]
        assert classify(algebra(4, {(1, 1): {2: s}, (1, 2): {3: t}})).name == name


def test_beyond_the_list_invariants_remain():
    A = algebra(6, {(1, 1): {2: 1}, (3, 3): {4: 1}})
    found = classify(A)
    assert found.normal_form is None
    assert found.change_of_basis is None
    (factor,) = found.factors
    assert (factor.dimension, factor.hilbert_function, factor.socle_dimension) == (6, (1, 3, 2), 3)
    assert "Hilbert function (1, 3, 2)" in str(found)


FORMS = [form for n in range(1, 6) for form in normal_forms(n)]


def test_there_are_1_1_2_5_12_real_and_1_1_2_4_9_complex_forms():
    assert [len(normal_forms(n)) for n in range(1, 6)] == [1, 1, 2, 5, 12]
    assert [len({complex_name(form.name) for form in normal_forms(n)}) for n in range(1, 6)] == [1, 1, 2, 4, 9]
    assert len({form.name for form in FORMS}) == len(FORMS)


@pytest.mark.parametrize("form", FORMS, ids=repr)
def test_each_is_commutative_associative_and_local(form):
    Extension(form.tensor)  # raises if not
    n = form.dimension
    assert form.unit() == (1,) + (0,) * (n - 1)
    assert form.residue_field == "R"
    # The basis is adapted: the nilradical is spanned by all but the unit.
    assert {tuple(v) for v in form.nilradical()} == {tuple(int(i == k) for i in range(n)) for k in range(1, n)}


def invariants(form):
    (factor,) = classify(form).factors
    return factor.hilbert_function, factor.socle_dimension, factor.signature


def test_no_two_are_isomorphic():
    """Over C the rank of the deciding quadratic form is all that remains of its signature."""
    found = [(form, *invariants(form)) for form in FORMS]
    assert len({tuple(values) for _, *values in found}) == len(FORMS)
    complex_forms = {(form.dimension, h, s, sum(signature or ())): set() for form, h, s, signature in found}
    for form, h, s, signature in found:
        complex_forms[form.dimension, h, s, sum(signature or ())].add(complex_name(form.name))
    assert all(len(names) == 1 for names in complex_forms.values())
    assert len(complex_forms) == 1 + 1 + 2 + 4 + 9


@pytest.mark.parametrize("n", [1, 2, 3, 6])
def test_families_go_on(n):
    for form in (truncated_polynomials(n), null_square(n)):
        assert Extension(form.tensor).dimension == n  # which it raises if it is none
        assert classify(form).name == form.name
    assert truncated_polynomials(n).hilbert_function() == (1,) * n
    form = complex_truncated_polynomials(n)
    assert (Extension(form.tensor).dimension, form.residue_field) == (2 * n, "C")
    assert normal_form_named("R[x]/(x^3)").tensor == normal_forms(3)[0].tensor


def over(field, extension):
    """The algebra over Q[x]/(p), p = x^n - (the polynomial of these coefficients), as one over Q."""
    n, products = len(field), {}
    powers = [[int(i == k) for k in range(n)] for i in range(n)]
    for _ in range(n):
        *rest, last = powers[-1]
        powers.append([a + last * b for a, b in zip([0, *rest], field, strict=True)])
    for (i, j), row in extension.products.items():
        for a in range(n):
            for b in range(n):
                if i * n + a <= j * n + b or i != j:
                    pair = tuple(sorted((i * n + a, j * n + b)))
                    products[pair] = {k * n + m: w * c for k, w in row.items() for m, c in enumerate(powers[a + b])}
    return Extension.from_products(extension.dimension * n, products)


@pytest.mark.parametrize(
    ("field", "extension", "name"),
    [
        ([1, 1, 0], leibniz(2), "C[x]/(x^2) + R[x]/(x^2)"),  # x^3 = x + 1
        ([-1, 3, 0], leibniz(2), "R[x]/(x^2) + R[x]/(x^2) + R[x]/(x^2)"),  # x^3 = 3 x - 1
        ([2, 0], semidirect(3), "R[x,y]/(x,y)^2 + R[x,y]/(x,y)^2"),
        ([2, 0, 0], semidirect(3), "[local, residue field C, Hilbert function (1, 2)] + R[x,y]/(x,y)^2"),
    ],
)
def test_algebras_over_a_number_field_have_its_places(field, extension, name):
    given = over(field, extension)
    found = classify(given)
    assert found.name == name
    if found.change_of_basis is not None:
        assert len(field) == 2
        assert_normal(given, found)
