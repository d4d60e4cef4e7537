"""Brackets with a constant part: known answers, what is kept by copies, and what is refused."""

import pickle

import pytest
import sympy as sp
from sympy.vector import CoordSys3D

import liepoisson as lp
from liepoisson.errors import BracketError, CocycleError, LeafError, ParameterError, ShapeError, UnsupportedFieldError
from liepoisson.formula.styles import LATEX, PLAIN, UNICODE
from liepoisson.model.system_file_reader import parse_system_file
from liepoisson.report.describe import inspect
from liepoisson.structure.automorphisms import Automorphism

GYROSTAT = (lp.so(3) @ lp.trivial()).with_constant({("l1", "l2"): "k3", ("l2", "l3"): "k1", ("l3", "l1"): "k2"})


def test_the_constant_is_added_to_the_bracket_of_the_coordinates():
    l1, l2, l3 = GYROSTAT.variables
    k1, k2, k3 = sp.symbols("k1 k2 k3")
    assert [GYROSTAT(l1, l2), GYROSTAT(l2, l3), GYROSTAT(l3, l1)] == [k3 - l3, k1 - l1, k2 - l2]
    assert GYROSTAT.vector_field(l3) == (l2 - k2, k1 - l1, 0)
    assert GYROSTAT.poisson_tensor()[0, 1] == k3 - l3
    assert GYROSTAT.symbols == {"k1", "k2", "k3"}
    assert repr(GYROSTAT) == "so(3) ⊗ trivial + constant part"


def test_the_casimir_of_the_gyrostat_is_that_of_the_sphere_moved():
    l, k = sp.Matrix(GYROSTAT.variables), sp.Matrix(sp.symbols("k1:4"))
    report = GYROSTAT.casimir_report()
    assert report.generators == (sp.expand(l.dot(l) - 2 * k.dot(l)),)
    assert report.complete
    assert report.verified
    assert report.exceptional == ()
    assert GYROSTAT.coboundary() == tuple(-k)
    assert str((lp.so(3) @ lp.trivial()).coboundary()) == "(0, 0, 0)"  # numbers print as they are written
    assert str((lp.so(3) @ lp.trivial()).with_constant({("l1", "l2"): "1/2"}).coboundary()) == "(0, 0, -1/2)"


def test_entries_may_be_formulas_in_symbols():
    bracket = (lp.so(3) @ lp.trivial()).with_constant({("l1", "l2"): "2*k", ("l2", "l3"): "-m", ("l1", "l3"): "k*m"})
    k, m = sp.symbols("k m")
    assert bracket.constant == {(0, 1): 2 * k, (0, 2): k * m, (1, 2): -m}


def test_a_casimir_that_is_not_homogeneous():
    """{q, p} = -c, {q, c} = k, no coboundary: C = c^2 + 2 k p."""
    bracket = (lp.algebras.heisenberg(1) @ lp.trivial()).rename("x").with_constant({("xq1", "xc"): "k"})
    q, p, c = bracket.variables
    k = sp.Symbol("k")
    assert [bracket(q, p), bracket(q, c), bracket(p, c)] == [-c, k, 0]
    report = bracket.casimir_report()
    assert [sp.expand(casimir) for casimir in report.generators] == [c**2 + 2 * k * p]
    assert report.complete
    assert bracket.coboundary() is None
    assert [case.condition for case in report.exceptional] == ["k = 0"]
    assert report.exceptional[0].generators == [c]


def test_constants_alone_leave_the_null_directions_as_casimirs():
    bracket = (lp.algebras.abelian(3) @ lp.trivial()).with_constant({("l1", "l2"): 1, ("l2", "l3"): 2})
    l1, _, l3 = bracket.variables
    assert bracket.casimirs() == [l1 + l3 / 2]
    assert bracket.rank_certificate().proved
    assert bracket.rank([0, 0, 0]) == 2


def test_the_rank_depends_on_the_point():
    numbers = GYROSTAT.substitute({name: sp.Integer(n) for name, n in (("k1", 1), ("k2", 2), ("k3", 3))})
    assert numbers.rank([1, 2, 3]) == 0
    assert numbers.rank([0, 0, 0]) == 2
    assert not numbers.symbols


def test_what_is_no_cocycle_names_the_triple():
    with pytest.raises(CocycleError, match=r"\(l1, l2, alpha3\).*is 1 instead of 0") as caught:
        (lp.so(3) @ lp.semidirect(2)).with_constant({("l1", "alpha1"): 1})
    assert caught.value.triple == ("l1", "l2", "alpha3")
    again = pickle.loads(pickle.dumps(caught.value))
    assert (again.triple, again.residual, str(again)) == (("l1", "l2", "alpha3"), "1", str(caught.value))
    unchecked = (lp.so(3) @ lp.semidirect(2)).with_constant({("l1", "alpha1"): 1}, check=False)
    assert not unchecked.jacobi_certificate().holds
    assert "(l1, l2, alpha3): 1 instead of 0" in str(unchecked.jacobi_certificate())


@pytest.mark.parametrize(
    ("constant", "error", "message"),
    [
        ({("l1", "ll2"): 1}, BracketError, "Known are l1, l2, l3. Did you mean l2"),
        ({("l1", 3): 1}, BracketError, "must name coordinates; got 3"),
        ({("l1", "l2"): 1, ("l2", "l1"): 1}, BracketError, r"\(l2, l1\) twice"),
        ({("l1", "l1"): 1}, BracketError, "with itself"),
        ({"l1": 1}, ParameterError, "by pairs of coordinates"),
        ([("l1", "l2")], ParameterError, "a mapping from pairs"),
        ({("l1", "l2"): object()}, ParameterError, r"\{l1, l2\} must be a number, a name or a formula"),
        ({("l1", "l2"): "l3"}, BracketError, "Rename a parameter"),
    ],
)
def test_wrong_constants_are_refused(constant, error, message):
    with pytest.raises(error, match=message):
        (lp.so(3) @ lp.trivial()).with_constant(constant)


def test_copies_keep_the_constant_part():
    for other in (pickle.loads(pickle.dumps(GYROSTAT)), GYROSTAT.rename("M"), GYROSTAT.substitute({})):
        assert other.constant == GYROSTAT.constant
    assert GYROSTAT.rename("M").coordinate_names_in_order == ("M1", "M2", "M3")
    assert GYROSTAT.substitute({"k3": sp.Integer(5)}).constant[0, 1] == 5
    assert (lp.so(3) @ lp.trivial()).with_constant({("l1", "l2"): 0}).constant == {}
    with pytest.raises(ShapeError, match="point must be 3 numbers"):
        GYROSTAT.translated([1, 2])


def test_symmetries_keep_the_constant_part():
    """On fields: q -> s q, p -> p/s and the shears of sl(2), but no scaling of both."""
    assert [str(d) for d in lp.canonical(3).derivations()] == [
        "q -> s*q, p -> s^(-1)*p", "q -> q + d*p", "p -> p + d*q",
    ]  # fmt: skip
    assert Automorphism([[0, 1], [-1, 0]]).is_poisson(lp.canonical(2))
    assert not Automorphism([[0, 1], [1, 0]]).is_poisson(lp.canonical(2))
    twisted = lp.so(3) @ lp.leibniz(3, "epsilon")
    shift = Automorphism([[1, 0, 0], [0, 1, "d"], [0, 0, 1]])
    assert shift.is_poisson(twisted)
    assert shift.is_poisson(twisted.translated(["b"] + [0] * 8))  # J(x0) goes to J(P x0), and P keeps l
    assert not shift.is_poisson(twisted.translated([0] * 6 + ["b", 0, 0]))
    assert [str(d) for d in GYROSTAT.derivations()] == []
    scaled = (lp.so(3) @ lp.semidirect(2)).with_constant({("l1", "alpha2"): "k", ("alpha1", "l2"): "k"})
    assert [s.parameters for s in scaled.scalings()] == [{"k": 1}]


def test_strata():
    (everywhere,) = lp.canonical(2).strata()
    assert (everywhere.condition, everywhere.rank, everywhere.proved) == ("everywhere", 4, True)
    (generic,) = GYROSTAT.strata()
    assert (generic.condition, generic.rank, generic.proved) == ("generic", 2, False)
    assert "coboundary" in generic.certificate
    # {l, b} = b and {l, c} = 1, {b, c} = 0: J is never zero, though its linear part is at b = 0
    lines = (lp.algebras.affine(1) + lp.algebras.abelian(1)) @ lp.trivial()
    names = lines.coordinate_names_in_order
    (nowhere_less,) = lines.with_constant({(names[0], names[2]): 1}).strata()
    assert (nowhere_less.condition, nowhere_less.rank, nowhere_less.proved) == ("everywhere", 2, True)
    assert "Pfaffians" in nowhere_less.certificate


def test_the_report_tells_the_constant_part():
    system = lp.System(GYROSTAT, "dot(l, inv(I)*l)/2", {"I": [1, 2, 3], "k3": 1, "k1": 0, "k2": "1/2"})
    report = inspect(system)
    assert "constant part {l1, l2} = 1, {l1, l3} = -1/2" in report.text(PLAIN)
    assert "{l₁, l₂} = 1" in report.text(UNICODE) or "{ℓ₁, ℓ₂} = 1" in report.text(UNICODE)
    assert r"\{" in report.text(LATEX)
    record = next(topic.record() for topic in report.topics if topic.key == "bracket")
    assert [entry["of"] for entry in record["constant_part"]] == [["l1", "l2"], ["l1", "l3"]]
    assert record["jacobi"]["proved"]
    assert "Jacobi identity proved" in report.text(PLAIN)


FILE = """
[bracket]
algebra = "so(3)"
variables = ["M"]
constant.M1.M2 = "k[3]"
constant.M2.M3 = "k[1]"
constant.M3.M1 = "k[2]"
[parameters]
I = [1, 2, "5/2"]
k = ["1/2", "1/3", "1/4"]
[hamiltonian]
expression = "dot(M, inv(I)*M)/2"
"""


def test_a_file_has_the_constant_part():
    file = parse_system_file(FILE)
    assert file.bracket.symbols == {"k1", "k2", "k3"}
    system = file.system()
    M1, M2, M3 = system.variables
    half, third, quarter = sp.Rational(1, 2), sp.Rational(1, 3), sp.Rational(1, 4)
    assert system.bracket(M1, M2) == quarter - M3
    # M' = (M - k) x omega
    assert sp.expand(system.equations[M1] - ((M2 - third) * M3 * sp.Rational(2, 5) - (M3 - quarter) * M2 / 2)) == 0
    assert sp.expand(system.bracket.casimirs()[0] - (M1**2 + M2**2 + M3**2 - M1 - 2 * M2 / 3 - M3 / 2)) == 0
    assert half == system.parameters["k1"]


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        ("constant.M1.M2", "constant.M1.N2", "N2"),
        ('"k[3]"', '"h"', "h"),
        ('constant.M1.M2 = "k[3]"', "constant.M1 = 3", r"\[bracket\] constant M1: wanted a table"),
        ('constant.M3.M1 = "k[2]"', 'constant.M3.M1 = "k[2]"\nconstant.M1.M3 = 1', "twice"),
    ],
)
def test_a_wrong_constant_in_a_file_is_told_with_its_key(before, after, message):
    with pytest.raises(lp.errors.SystemFileError, match=message):
        parse_system_file(FILE.replace(before, after))


def test_a_file_that_is_no_cocycle():
    text = FILE.replace('algebra = "so(3)"', 'algebra = "so(3)"\nextension = "semidirect(2)"')
    text = text.replace('variables = ["M"]', 'variables = ["M", "a"]').replace("constant.M1.M2", "constant.M1.a1")
    with pytest.raises(lp.errors.SystemFileError, match="2-cocycle"):
        parse_system_file(text)


def test_splitting_and_attitudes_say_why_not():
    system = lp.System(GYROSTAT.substitute({f"k{i}": sp.Integer(i) for i in (1, 2, 3)}), "dot(l, l)/2 + l1^2")
    with pytest.raises(UnsupportedFieldError, match="has a constant part"):
        system.pieces()
    with pytest.raises(ParameterError, match="coboundary"):
        lp.orbits.attitude(system, [1.0, 0, 0], times=[0, 1])


def test_a_constant_part_makes_no_top():
    shifted = (lp.so(3) @ lp.leibniz(3, 1)).translated([1] + [0] * 8)
    system = lp.System(shifted, "l1^2/2 + l2^2/4 + l3^2/6 + alpha1")
    assert system.top_parameters is None
    assert isinstance(system.field(), lp.fields.QuadraticField)
    with pytest.raises(LeafError):
        lp.Leaf(system, {"C1": 0, "C2": 0, "C3": -1})


def test_a_generator_of_a_lower_degree_is_not_found_again():
    """One of degree one beside one of degree two, which is not homogeneous: two generators, not three."""
    bracket = ((lp.so(3) + lp.algebras.abelian(1)) @ lp.trivial()).with_constant({("l2", "l1"): 1})
    l1, l2, l3, l4 = bracket.variables
    report = bracket.casimir_report(3)
    assert report.generators == (l4, l1**2 + l2**2 + l3**2 + 2 * l3)
    assert report.degrees == (1, 2)
    assert report.dimensions == {1: 1, 2: 3, 3: 5}  # x, then x^2 and C, then x^3 and x C, where x = l4


@pytest.mark.parametrize("entry", ["l1", sp.Symbol("l1") ** 2, sp.Symbol("k") * sp.Symbol("l2") * sp.Symbol("l3")])
def test_an_entry_that_depends_on_the_state_is_refused_with_a_way_on(entry):
    with pytest.raises(BracketError, match=r"must not depend on the state; got \{l1, l2\} = .* H = p1\*f1\(x\)"):
        (lp.so(3) @ lp.trivial()).with_constant({("l1", "l2"): entry})


def test_that_way_leads_on():
    """dx/dt = x - x y, dy/dt = x y - y, whose bracket {x, y} = x y is quadratic, as a canonical system."""
    bracket = lp.canonical(names=("x", "y"), momenta=("p1", "p2"))
    system = lp.System(bracket, "p1*(x - x*y) + p2*(x*y - y)", integrals={"V": "x + y - log(x*y)"})
    orbit = lp.integrate(system, {"x": 1, "y": 2}, t_end=20)
    assert orbit.drift["V"].max() < 1e-13


@pytest.mark.parametrize(
    "entry",
    [sp.Dummy("k"), sp.Wild("k"), sp.IndexedBase("k")[1], sp.MatrixSymbol("k", 2, 2)[0, 0], CoordSys3D("N").x],
    ids=str,
)
def test_an_entry_consists_of_numbers_and_plain_symbols(entry):
    with pytest.raises(ParameterError, match="must consist of numbers and plain symbols; got"):
        (lp.so(3) @ lp.trivial()).with_constant({("l1", "l2"): entry})


TAN, ROOT = sp.tan(13 * sp.pi / 45), sp.Integer(2) ** sp.Rational(1, 3)
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
    bracket = (lp.so(3) @ lp.trivial()).with_constant({("l1", "l2"): value})
    assert bool(bracket.constant) is not vanishes
    (casimir,) = bracket.casimirs()
    l = sp.Matrix(bracket.variables)
    assert float((casimir - l.dot(l) + 2 * value * l[2]).subs(l[2], 1)) == pytest.approx(0, abs=1e-12)
    scaled = (lp.so(3) @ lp.trivial()).with_constant({("l1", "l2"): sp.Symbol("k") * value})
    assert bool(scaled.constant) is not vanishes
    brackets = {(0, 1): {2: value}, (1, 2): {0: 1}, (2, 0): {1: 1}}
    assert bool((0, 1) in lp.LieAlgebra.from_brackets(3, brackets).brackets) is not vanishes


@pytest.mark.timeout(60)
@pytest.mark.parametrize(
    "value",
    [
        TAN + ROOT + sp.Integer(5) ** sp.Rational(1, 7),
        ROOT - ROOT ** sp.Rational(3, 5) + sp.Integer(3) ** sp.Rational(1, 11),
        ROOT * (TAN - SINE / COSINE).expand(),
    ],
    ids=["tangent", "roots", "undecided"],
)
def test_numbers_of_large_fields_are_refused(value):
    makers = [
        lambda: (lp.so(3) @ lp.trivial()).with_constant({("l1", "l2"): value}),
        lambda: lp.LieAlgebra.from_brackets(3, {(0, 1): {2: value}, (1, 2): {0: 1}, (2, 0): {1: 1}}) @ lp.trivial(),
        lambda: lp.so(3) @ lp.Extension([[[1, 0], [0, 0]], [[0, 1], [1, value]]]),
    ]
    for make in makers:
        with pytest.raises(ParameterError, match=r"field of degree at most 128; got .*the degree \d+. Give rational"):
            _ = make().rank()


LARGE = "(2^(1/3) + 5^(1/7) + tan(13*pi/45))"


@pytest.mark.timeout(60)
@pytest.mark.parametrize(
    "search",
    [
        lambda s: lp.integrability.first_integrals(lp.System(s, f"{LARGE}*l1^2 + l2^2"), degree=2),
        lambda s: lp.integrability.first_integrals(lp.System(s, "3*l1^2 + l2^2"), degree=2, on=f"C1 = {LARGE}"),
        lambda s: lp.integrability.first_integrals(lp.System(s, f"sqrt({LARGE} + l1^2) + l2"), degree=2),
        lambda s: lp.integrability.darboux_polynomials(lp.System(s, f"{LARGE}*l1^2 + l2^2"), degree=1),
        lambda s: lp.integrability.integrability_report(lp.System(s, f"{LARGE}*l1^2 + l2^2")),
    ],
)
def test_searches_over_such_fields_are_refused(search):
    with pytest.raises(ParameterError, match="field of degree at most 128"):
        search(lp.so(3) @ lp.trivial())
