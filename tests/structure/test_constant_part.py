"""Brackets with a constant part: known answers, canonical brackets, and numbers whose vanishing is hard to see."""

import pickle
from itertools import product

import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.errors import CocycleError, LeafError, ParameterError, UnsupportedFieldError

SO3 = lp.so(3) @ lp.trivial()
GYROSTAT = SO3.with_constant({("l1", "l2"): "k3", ("l2", "l3"): "k1", ("l3", "l1"): "k2"})


def test_the_gyrostat_is_a_sphere_moved():
    l, k = sp.Matrix(GYROSTAT.variables), sp.Matrix(sp.symbols("k1:4"))
    l1, l2, l3 = l
    assert [GYROSTAT(l1, l2), GYROSTAT(l2, l3), GYROSTAT(l3, l1)] == [k[2] - l3, k[0] - l1, k[1] - l2]
    assert GYROSTAT.vector_field(l3) == (l2 - k[1], k[0] - l1, 0)
    assert GYROSTAT.symbols == {"k1", "k2", "k3"}
    assert repr(GYROSTAT) == "so(3) ⊗ trivial + constant part"
    report = GYROSTAT.casimir_report()
    assert report.generators == (sp.expand(l.dot(l) - 2 * k.dot(l)),)
    assert (report.complete, report.verified, report.exceptional) == (True, True, ())
    assert GYROSTAT.coboundary() == tuple(-k)
    numbers = GYROSTAT.substitute({"k1": sp.Integer(1), "k2": sp.Integer(2), "k3": sp.Integer(3)})
    assert [numbers.rank(point) for point in ([1, 2, 3], [0, 0, 0])] == [0, 2]
    (generic,) = GYROSTAT.strata()
    assert (generic.condition, generic.rank, generic.proved) == ("generic", 2, False)
    assert "coboundary" in generic.certificate
    assert str(SO3.with_constant({("l1", "l2"): "1/2"}).coboundary()) == "(0, 0, -1/2)"


def test_entries_may_be_formulas_in_symbols_and_copies_keep_them():
    k, m = sp.symbols("k m")
    bracket = SO3.with_constant({("l1", "l2"): "2*k", ("l2", "l3"): "-m", ("l1", "l3"): "k*m"})
    assert bracket.constant == {(0, 1): 2 * k, (0, 2): k * m, (1, 2): -m}
    for other in (pickle.loads(pickle.dumps(bracket)), bracket.rename("M"), bracket.substitute({})):
        assert other.constant == bracket.constant
    assert bracket.substitute({"k": sp.Integer(5)}).constant[0, 1] == 10
    assert SO3.with_constant({("l1", "l2"): 0}).constant == {}


@pytest.mark.parametrize(
    ("proper", "constant", "generators", "exceptional"),
    [
        # {q, p} = -c, {q, c} = k, no coboundary: C = c^2 + 2 k p
        (lp.algebras.heisenberg(1), {("lq1", "lc"): "k"}, ["2*k*lp1 + lc**2"], ["k = 0"]),
        (lp.algebras.abelian(3), {("l1", "l2"): 1, ("l2", "l3"): 2}, ["l1 + l3/2"], []),  # null directions
        # one of degree one beside one of degree two, which is not homogeneous
        (lp.so(3) + lp.algebras.abelian(1), {("l2", "l1"): 1}, ["l4", "l1**2 + l2**2 + l3**2 + 2*l3"], []),
    ],
)
def test_casimirs_that_are_not_homogeneous(proper, constant, generators, exceptional):
    bracket = (proper @ lp.trivial()).with_constant(constant)
    report = bracket.casimir_report(3)
    assert [str(casimir) for casimir in report.generators] == generators
    assert [case.condition for case in report.exceptional] == exceptional
    assert bracket.rank_certificate().proved
    assert (bracket.coboundary() is None) is (len(generators) == 1)


def test_a_rank_that_never_drops():
    """{l, b} = b and {l, c} = 1, {b, c} = 0: J is never zero, though its linear part is at b = 0."""
    lines = (lp.algebras.affine(1) + lp.algebras.abelian(1)) @ lp.trivial()
    names = lines.coordinate_names_in_order
    (nowhere_less,) = lines.with_constant({(names[0], names[2]): 1}).strata()
    assert (nowhere_less.condition, nowhere_less.rank, nowhere_less.proved) == ("everywhere", 2, True)
    assert "Pfaffians" in nowhere_less.certificate


def test_what_is_no_cocycle_names_the_triple():
    with pytest.raises(CocycleError) as caught:
        (lp.so(3) @ lp.semidirect(2)).with_constant({("l1", "alpha1"): 1})
    again = pickle.loads(pickle.dumps(caught.value))
    assert (again.triple, again.residual, str(again)) == (("l1", "l2", "alpha3"), "1", str(caught.value))
    unchecked = (lp.so(3) @ lp.semidirect(2)).with_constant({("l1", "alpha1"): 1}, check=False)
    assert "(l1, l2, alpha3): 1 instead of 0" in str(unchecked.jacobi_certificate())


def test_what_a_constant_part_excludes():
    system = lp.System(GYROSTAT.substitute({f"k{i}": sp.Integer(i) for i in (1, 2, 3)}), "dot(l, l)/2 + l1^2")
    with pytest.raises(UnsupportedFieldError, match="has a constant part"):
        system.pieces()
    with pytest.raises(ParameterError, match="coboundary"):
        lp.orbits.attitude(system, [1.0, 0, 0], times=[0, 1])
    shifted = (lp.so(3) @ lp.leibniz(3, 1)).translated([1] + [0] * 8)
    system = lp.System(shifted, "l1^2/2 + l2^2/4 + l3^2/6 + alpha1")
    assert system.top_parameters is None
    assert isinstance(system.field(), lp.fields.QuadraticField)
    with pytest.raises(LeafError):
        lp.Leaf(system, {"C1": 0, "C2": 0, "C3": -1})


@pytest.mark.parametrize(
    ("bracket", "coordinates", "fields", "text"),
    [
        (lp.canonical(2), ("q1", "q2", "p1", "p2"), ("q", "p"), "canonical(2)"),
        (lp.canonical(names=["t", "phi"]), ("t", "phi", "p_t", "p_phi"), ("t", "phi", "p_t", "p_phi"), None),
        (lp.canonical(2, names=("a", "b"), momenta=("u", "v")), ("a", "b", "u", "v"), ("a", "b", "u", "v"), None),
        (lp.canonical(2).rename("x", "y"), ("x1", "x2", "y1", "y2"), ("x", "y"), None),
    ],
)
def test_canonical_brackets(bracket, coordinates, fields, text):
    """A coordinate and its momentum have the bracket one; there are no Casimirs."""
    for each in (bracket, pickle.loads(pickle.dumps(bracket))):
        assert (each.coordinate_names_in_order, each.field_names) == (coordinates, fields)
        assert text in (None, repr(each))
    for (i, x), (j, y) in product(enumerate(bracket.variables), repeat=2):
        assert bracket(x, y) == (1 if j == i + 2 else -1 if i == j + 2 else 0)
    assert not bracket.entries()
    assert not bracket.casimirs()
    assert bracket.jacobi_certificate().holds
    assert bracket.casimir_report().complete
    assert bracket.rank_certificate().proved


TAN = sp.tan(13 * sp.pi / 45)
SINE, COSINE = sp.sin(13 * sp.pi / 45), sp.cos(13 * sp.pi / 45)
A, B = sp.tan(sp.pi / 9), sp.tan(8 * sp.pi / 45)

DISGUISED = {
    "a quotient": (TAN - SINE / COSINE, True),
    "the theorem of addition": (TAN - (A + B) / (1 - A * B), True),
    "roots of it": (sp.sqrt(3) * TAN - sp.sqrt(6) * SINE / COSINE / sp.sqrt(2), True),
    "another tangent": (TAN - sp.sqrt(5) * sp.tan(2 * sp.pi / 45), False),
    "roots beside it": (TAN + sp.sqrt(2) + sp.sqrt(3) + sp.sqrt(5), False),
    "a sine of another angle": (TAN * sp.sin(sp.pi / 7), False),
}


@pytest.mark.timeout(60)
@pytest.mark.parametrize("case", DISGUISED)
def test_sums_of_tangents_and_roots_are_decided(case):
    """In a cyclotomic field; SymPy was not seen to find the field that they generate."""
    value, vanishes = DISGUISED[case]
    bracket = SO3.with_constant({("l1", "l2"): value})
    assert bool(bracket.constant) is not vanishes
    (casimir,) = bracket.casimirs()
    l = sp.Matrix(bracket.variables)
    assert float((casimir - l.dot(l) + 2 * value * l[2]).subs(l[2], 1)) == pytest.approx(0, abs=1e-12)
    scaled = SO3.with_constant({("l1", "l2"): sp.Symbol("k") * value})
    assert bool(scaled.constant) is not vanishes
    brackets = {(0, 1): {2: value}, (1, 2): {0: 1}, (2, 0): {1: 1}}
    assert bool((0, 1) in lp.LieAlgebra.from_brackets(3, brackets).brackets) is not vanishes


LARGE = "(2^(1/3) + 5^(1/7) + tan(13*pi/45))"


@pytest.mark.timeout(60)
@pytest.mark.parametrize(
    "search",
    [
        lambda: lp.integrability.first_integrals(lp.System(SO3, f"{LARGE}*l1^2 + l2^2"), degree=2),
        lambda: lp.integrability.first_integrals(lp.System(SO3, "3*l1^2 + l2^2"), degree=2, on=f"C1 = {LARGE}"),
        lambda: lp.integrability.first_integrals(lp.System(SO3, f"sqrt({LARGE} + l1^2) + l2"), degree=2),
    ],
)
def test_searches_over_numbers_of_large_fields_are_refused(search):
    with pytest.raises(ParameterError, match="field of degree at most 128"):
        search()
