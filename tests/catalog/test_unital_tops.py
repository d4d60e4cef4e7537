"""Tops on unital algebras: integrals, Lax pairs and completeness of Lagrange's and Kovalevskaya's; binary cubics."""

import pytest
from sympy import I, Matrix, Rational, S, Symbol, expand, symbols

import liepoisson as lp
from liepoisson.catalog.lax_pairs import MADE
from liepoisson.errors import BracketError, LaxPairError, ParameterError, ShapeError, UnknownNameError

cubic = lp.extensions.binary_cubic
known_lax_pair = lp.integrability.known_lax_pair
kovalevskaya_top, lagrange_top = lp.catalog.kovalevskaya_top, lp.catalog.lagrange_top

UNIT = {(0, 0): {0: 1}, (0, 1): {1: 1}}
ORBITS = {
    "R[x,y]/(x,y)^2": (0, 0, 0, 0), "R[x]/(x^3)": (-1, 0, 0, 0), "R[x]/(x^2) + R": (0, 1, 0, 0),
    "R + R + R": (0, 1, -1, 0), "C + R": (0, 1, 0, 1),
}  # fmt: skip
"""A cubic of each of the five real orbits."""


def one_field(kappa):
    """The algebra with e1 e1 = kappa: e(3), so(4), so(3, 1)."""
    return lp.Extension.from_products(2, UNIT | {(1, 1): {0: kappa}}, f"e1^2 = {kappa}")


def four_points(s):
    """The algebra of u^2 = s, v^2 = s for a real s: 1, x, y and g with x^2 = g + s/2, y^2 = g - s/2, xy = 0."""
    half, quarter = Rational(1, 2) * s, Rational(1, 4) * s**2
    products = {(1, 1): {0: half, 3: 1}, (2, 2): {0: -half, 3: 1}, (1, 3): {1: half}, (2, 3): {2: -half}}
    units = {(0, k): {k: 1} for k in range(4)}
    return lp.Extension.from_products(4, units | products | {(3, 3): {0: quarter}}, f"four points, {s}")


def equations_by_hand(system, products, moments, vectors):
    """x_mu' = x_mu x omega + sum over fields of x_(mu nu) x vector, written with SymPy's cross product alone."""
    fields = [Matrix(list(x)) for x in system.bracket.fields.values()]
    omega = Matrix([x / m for x, m in zip(fields[0], moments, strict=True)])
    rates = []
    for mu in range(len(fields)):
        rate = fields[mu].cross(omega)
        for nu, vector in vectors.items():
            if mu == 0:
                product = fields[nu]
            else:
                row = products[min(mu, nu), max(mu, nu)]
                product = sum((c * fields[k] for k, c in row.items()), Matrix([0, 0, 0]))
            rate += product.cross(Matrix(vector))
        rates += list(rate)
    return rates


def test_the_top_of_a_cubic_has_the_equations_written_by_hand():
    a, b, c, d = symbols("a b c d")
    products = {(1, 1): {0: -a * c, 1: b, 2: -a}, (1, 2): {0: -a * d}, (2, 2): {0: -b * d, 1: d, 2: -c}}
    inertia, first, second = symbols("I1:4"), symbols("a1:4"), symbols("b1:4")
    top = lp.catalog.cubic_top((a, b, c, d), inertia, first, second)
    wanted = equations_by_hand(top, products, inertia, {1: first, 2: second})
    assert all(expand(e - w) == 0 for e, w in zip(top.equations.values(), wanted, strict=True))


@pytest.mark.parametrize(("name", "form"), ORBITS.items())
def test_each_orbit_is_its_algebra_with_three_casimirs_and_rank_six(name, form):
    extension = cubic(*form)
    bracket = lp.so(3) @ extension
    assert extension.classify().name == name
    assert bracket.jacobi_certificate().holds
    assert (bracket.rank(), len(bracket.casimirs())) == (6, 3)


def test_every_cubic_has_the_casimirs_of_the_page():
    bracket = lp.so(3) @ cubic()
    l, alpha, beta = (Matrix(list(x)) for x in bracket.fields.values())
    a, b, c, d = symbols("a b c d")
    wanted = [
        alpha.dot(alpha) - 2 * a * l.dot(beta) - a * c * l.dot(l),
        alpha.dot(beta) + c * l.dot(alpha) - b * l.dot(beta) - (a * d + b * c) / 2 * l.dot(l),
        beta.dot(beta) + 2 * d * l.dot(alpha) - b * d * l.dot(l),
    ]
    assert all(expand(f - w) == 0 for f, w in zip(bracket.casimirs(), wanted, strict=True))


def test_three_real_roots_are_three_tops_with_one_angular_velocity():
    """On R^3 the fields alpha, beta, l - alpha - beta commute with each other: three coadjoint orbits of so(3)."""
    bracket = lp.so(3) @ cubic(0, 1, -1, 0)
    l, alpha, beta = (list(x) for x in bracket.fields.values())
    third = [p - q - r for p, q, r in zip(l, alpha, beta, strict=True)]
    for first, second in ((alpha, beta), (alpha, third), (beta, third)):
        assert all(expand(bracket(p, q)) == 0 for p in first for q in second)
    assert all(expand(bracket(x[0], x[1]) + x[2]) == 0 for x in (alpha, beta, third))


def test_no_lower_stratum_is_claimed_where_no_field_spans_an_ideal():
    """e2 spans no ideal for (1, 2, 3, 5): where beta = 0 the rank is 6, not 4."""
    bracket = lp.so(3) @ cubic(1, 2, 3, 5)
    assert bracket.rank([1, 2, 3, 5, 1, -2, 0, 0, 0]) == 6
    assert [(s.rank, str(s.locus)) for s in bracket.strata()] == [(6, "generic"), (0, "beta = 0, alpha = 0, l = 0")]


LAGRANGE = [
    (lp.trivial(), ["c"]),
    (lp.semidirect(2), [0, "c"]), (one_field(1), [0, "c"]), (one_field(-1), [0, "c"]),
    *((cubic(*form), [0, "c", "d"]) for form in ORBITS.values()),
    (lp.trivial() + lp.semidirect(2), ["c", "d", 1]),  # the unit is no element of the basis
    *((form, [0, "c", "d", "e"][: form.dimension]) for form in lp.extensions.normal_forms(4)),
    (four_points(S.One), [0, "c", "d", "e"]),
]  # fmt: skip


def lagrange_id(case):
    return str(case[0])


@pytest.mark.thorough
@pytest.mark.parametrize("case", LAGRANGE, ids=lagrange_id)
def test_lagranges_top_is_integrable_on_every_unital_algebra(case):
    """For symbols: the integrals are constant and commute, the Lax pair holds; with numbers they are complete."""
    extension, element = case
    top = lagrange_top(extension, element, "I1", "I3")
    functions = [top.hamiltonian, *top.integrals.values()]
    assert all(expand(top.bracket(f, g)) == 0 for f in functions for g in functions)
    assert known_lax_pair(top).size == 3
    numbers = lagrange_top(extension, [{"c": 2, "d": 3, "e": -1}.get(e, e) for e in element], 2, 3)
    half = numbers.bracket.rank() // 2
    chosen = dict(list(({"H": numbers.hamiltonian} | numbers.integrals).items())[-half:])
    assert list(lp.integrability.certificate(numbers, chosen)["commuting"]) == list(chosen)


def test_the_integrals_of_lagranges_top_are_those_of_the_catalog():
    top = lagrange_top(lp.leibniz(4), [0, 1, 0, 0], 1, "1/2")
    other = lp.catalog.system("leibniz-lagrange-4")
    renamed = dict(zip(other.variables, top.variables, strict=True))
    P, Q = (other.integrals[name].xreplace(renamed) for name in "PQ")
    assert expand(top.integrals["P2"] - P) == 0
    assert expand(2 * top.integrals["P3"] - Q) == 0
    twisted = lagrange_top(cubic(-Symbol("epsilon"), 0, 0, 0), [0, "a3", "b3"], "I1", "I3")
    charged = lp.Top.twisted_lagrange(transverse="I1", axial="I3", a3="a3", b3="b3", epsilon="epsilon")
    assert expand(twisted.integrals["P2"] - charged.invariants["P'"]) == 0


def test_a_changed_coefficient_of_lagranges_top_is_found():
    top = lagrange_top(cubic(0, 1, -1, 0), [0, 2, 3], 2, 1)
    l1, alpha2 = top.variables[0], top.variables[4]
    assert top.is_constant(top.integrals["P2"])
    assert not top.is_constant(top.integrals["P2"] + alpha2 * l1)
    tilted = lp.System(top.bracket, top.hamiltonian + alpha2 / 7)
    assert not tilted.is_constant(top.integrals["P2"])
    with pytest.raises(ParameterError, match="lagrange_top and catalog"):
        known_lax_pair(tilted)
    pair = known_lax_pair(top)
    L, M = pair.elements
    with pytest.raises(LaxPairError):
        lp.integrability.lax_pair(top, [L[0], -L[1], L[2]], list(M))


KOVALEVSKAYA = {
    "one field": (one_field("kappa"), [0, 1], [0, 0]),
    "one field, turned": (one_field("kappa"), [0, "p"], [0, "q"]),
    "two fields": (lp.semidirect(3), [0, 1, 0], [0, 0, 1]),
    "two fields, twisted": (cubic("a", "b", "a", "b"), [0, 1, 0], [0, 0, 1]),
    "three fields": (lp.extensions.normal_forms(4)[3], [0, 1, 0, 0], [0, 0, 1, 0]),
    "three fields, twisted": (four_points(Symbol("s")), [0, 1, 0, 0], [0, 0, 1, 0]),
}


@pytest.mark.parametrize("name", KOVALEVSKAYA)
def test_kovalevskayas_integral_and_lax_pair_hold_for_symbols_with_a_rotor(name):
    top = kovalevskaya_top(*KOVALEVSKAYA[name], "k")
    assert top.is_constant(top.integrals["K"])
    assert known_lax_pair(top).size == 5


def test_the_proof_of_the_page():
    """xi' = -i l3 xi for k = 0, on the algebra with u^2 = s in which nothing is known of u v."""
    top = kovalevskaya_top(four_points(Symbol("s")), [0, 1, 0, 0], [0, 0, 1, 0])
    (l1, l2, l3), X, Y = (list(x) for x in list(top.bracket.fields.values())[:3])
    xi = expand((l1 / 2 + I * l2 / 2) ** 2 - X[0] - I * X[1] - I * (Y[0] + I * Y[1]) + Symbol("s"))
    rate = sum(xi.diff(x) * right for x, right in top.equations.items())
    assert expand(rate + I * l3 * xi) == 0
    assert expand(rate - I * l3 * xi) != 0


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("extension", "first", "second", "n"),
    [
        (one_field(1), [0, 1], [0, 0], 2), (one_field(-1), [0, 1], [0, 0], 2),
        pytest.param(cubic(0, 1, 0, 1), [0, 1, 0], [0, 0, 1], 3, marks=pytest.mark.slow),
        (lp.extensions.normal_forms(4)[3], [0, 1, 0, 0], [0, 0, 1, 0], 4),
        pytest.param(four_points(S.One), [0, 1, 0, 0], [0, 0, 1, 0], 4, marks=pytest.mark.slow),
    ],
)  # fmt: skip
def test_the_lax_pair_proves_that_they_are_integrable_with_a_rotor(extension, first, second, n):
    found = known_lax_pair(kovalevskaya_top(extension, first, second, 1)).integrals()
    assert (found.n_independent, found.rank, found.in_involution) == (n, 2 * n, True)


@pytest.mark.parametrize("name", MADE)
def test_entries_of_the_catalog_have_certificates_and_lax_pairs(name):
    top = lp.catalog.system(name)
    proof = lp.integrability.certificate(top, {"H": top.hamiltonian} | top.integrals)
    assert 2 * len(proof["commuting"]) == top.bracket.rank()
    assert known_lax_pair(name).size == 5
    if "kappa" in lp.catalog.entry(name).parameters:
        symbolic = lp.catalog.system(name, {"kappa": "kappa"})
        assert symbolic.integrals.keys() == top.integrals.keys()
        assert known_lax_pair(name, parameters={"kappa": "kappa"}).size == 5
        changed = lp.catalog.system(name, {"I": [3, 2, 1]})
        assert not changed.integrals


@pytest.mark.thorough
@pytest.mark.parametrize(("name", "genus"), [*zip(MADE, (11, 10, 17), strict=True)])
def test_the_spectral_curves_have_the_genus_of_the_page(name, genus):
    components = known_lax_pair(name).spectral_curve(seed=1).components
    assert max(component.genus for component in components) == genus


def test_without_a_number_for_the_square_there_is_no_integral():
    for form in ((-1, 0, 0, 0), (0, 1, 0, 0), (0, 1, -1, 0), (0, 1, 0, 2)):
        top = kovalevskaya_top(cubic(*form), [0, 1, 0], [0, 0, 1])
        assert not top.integrals
        with pytest.raises(ParameterError, match="got Kovalevskaya top on"):
            known_lax_pair(top)


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: lagrange_top(lp.semidirect(3), [0, 1]), ShapeError, "element must be 3 numbers"),
        (lambda: lagrange_top(lp.so(3), [0, 1]), ParameterError, "extension"),
        (lambda: lagrange_top(lp.Extension.from_products(2, {(0, 0): {1: 1}}), [0, 1]), BracketError, "with a unit"),
        (lambda: lagrange_top(lp.semidirect(2), [0, 1], 0), ParameterError, "must not vanish"),
        (lambda: kovalevskaya_top(lp.semidirect(3), [0, 1, 0], [0, 1]), ShapeError, "second must be 3 numbers"),
        (lambda: kovalevskaya_top(lp.semidirect(3), [0, 1, 0], [0, 0, 1], None), ParameterError, "rotor"),
        (lambda: lp.catalog.cubic_top((0, 1), [2, 2, 1], [1, 0, 0]), ShapeError, "cubic must be 4 numbers"),
        (lambda: cubic(0, float("nan"), 0, 0), ParameterError, "b"),
        (lambda: known_lax_pair("heavy-top"), UnknownNameError, "no Lax pair"),
        (lambda: known_lax_pair(lp.Top.lagrange(), parameters={"a": 1}), ParameterError, "leave them out"),
    ],
)  # fmt: skip
def test_refusals(call, error, words):
    with pytest.raises(error, match=words):
        call()


@pytest.mark.parametrize(
    "make",
    [
        lambda: lp.catalog.kovalevskaya_top(lp.leibniz(2), [0, 1], [0, 0], "l3"),
        lambda: lp.catalog.lagrange_top(lp.leibniz(3), [0, "l3", 0]),
        lambda: lp.catalog.cubic_top((0, 1, -1, 0), ["l1", 1, 1], [1, 0, 0]),
        lambda: lp.catalog.heavy_top_on("so(3)", [1, 1, 1], ["alpha1", 0, 1]),
        lambda: lp.catalog.euler_top_on("so(3)", ["l1", 1, 1]),
        lambda: lp.catalog.manakov(4, ["M12", 1, 2, 3]),
        lambda: lp.catalog.su_top(3, [lp.catalog.su_top(3).bracket.coordinate_names_in_order[0], 1, 2]),
    ],
)
def test_parameters_are_not_named_like_coordinates(make):
    with pytest.raises(BracketError, match="name both coordinates and parameters"):
        make()
