"""The report on a system: complete, computed now, the same in text, LaTeX and JSON; compared with stored reports."""

import json
import os
import time
from pathlib import Path

import pytest
import sympy as sp

from liepoisson import catalog
from liepoisson.errors import ParameterError
from liepoisson.formula.styles import PLAIN, UNICODE
from liepoisson.model.system import System
from liepoisson.model.tops import Top
from liepoisson.report import topics
from liepoisson.report.describe import describe, inspect
from liepoisson.report.integral_facts import is_nonzero_on, is_nonzero_somewhere
from liepoisson.structure.extension import Extension
from liepoisson.structure.extensions import leibniz, semidirect, trivial
from liepoisson.structure.lie_algebra import LieAlgebra
from liepoisson.structure.lie_algebras import abelian, affine, heisenberg, se, so

SNAPSHOTS = Path(__file__).parents[1] / "snapshots"
J, c, d = (sp.symbols(f"{name}1:4") for name in "Jcd")
SYMBOLIC = Top.twisted(("I1", "I2", "I3"), ("a1", "a2", "a3"), ("b1", "b2", "b3"), "epsilon")


def compare(name, text):
    """With the stored report; LIEPOISSON_UPDATE_SNAPSHOTS=1 stores a new one, to be read before it is kept."""
    path = SNAPSHOTS / name
    if os.environ.get("LIEPOISSON_UPDATE_SNAPSHOTS"):
        path.write_text(text + "\n", encoding="utf-8")
    assert text + "\n" == path.read_text(encoding="utf-8"), f"{path} differs"


@pytest.mark.parametrize(
    ("name", "style", "file"),
    [
        *((name, UNICODE, f"inspect-{name}.txt") for name in ("twisted-top", "clebsch", "manakov-so4")),
        *((name, UNICODE, f"inspect-{name}.txt") for name in ("twisted-lagrange", "goryachev-chaplygin")),
        ("twisted-top", PLAIN, "inspect-twisted-top-ascii.txt"),
        ("twisted-top", None, "inspect-twisted-top.tex"),
    ],
)  # fmt: skip
def test_reports(name, style, file):
    report = inspect(catalog.system(name))
    text = report.text(style) if style else report.latex()
    compare(file, text)
    assert text.isascii() or style is UNICODE
    assert style is None or max(map(len, text.split("\n"))) <= 119
    components = report.record()["equations"]["components"]
    read = {key: sp.sympify(entry["expression"].replace("^", "**")) for key, entry in components.items()}
    assert read == {str(x): value for x, value in catalog.system(name).equations.items()}


TYPED = System(
    so(3) @ leibniz(3, "kappa"),
    lambda l, u, v: sum(l[i] ** 2 / (2 * J[i]) + c[i] * u[i] + d[i] * v[i] for i in range(3)),
    symbols=("J[3]", "c[3]", "d[3]"),
)
HEAVY, MATRIX = so(3) @ semidirect(2), "dot(l, l)/2 + dot(alpha, A*alpha)/2"


@pytest.mark.parametrize(
    ("system", "there", "absent"),
    [
        # J, c, d instead of I, a, b: the equations are printed with I, a, b, and these are said to be J, c, d
        (TYPED, ["α′ = α × ω + ε β × a", "I = diag(J₁, J₂, J₃)", "ε = κ"], []),
        (catalog.system("zeitlin-3"), ["constant on them: |w|², C₂"], []),
        (catalog.system("so21-twisted-top"), ["u·v = u₁ v₁ + u₂ v₂ - u₃ v₃"], []),
        (catalog.system("heavy-top"), [], ["u·v"]),
        (System(HEAVY, MATRIX, {"A": [[2, 1, 0], [1, 3, 0], [0, 0, "1/2"]]}),
         ["H = ½ α·A α + ½ |l|²", "A = ((2, 1, 0), (1, 3, 0), (0, 0, 1/2))", "∂H/∂α = A α"], []),
        (System(HEAVY, MATRIX, {"A": [[2, 1, 0], [0, 3, 0], [0, 0, 1]]}), [], ["∂H/∂α = A α"]),
        # two copies of so(3) have the symmetry that exchanges them, which no family of maps contains
        (System(so(3) @ (trivial() + trivial()), "dot(l, alpha)"), ["no one-parameter family that acts on the"], []),
        (System(so(3) @ trivial(), "c*dot(l, l)/2 + d*l[1]", {"c": "1e200", "d": "1e-320"}), ["c = 10²⁰⁰"], []),
        (System(affine(1) @ trivial(), lambda l: l.dot(l) / 2), ["none: J has full rank at generic points"], []),
        # J vanishes where the central coordinate does, which the list does not say
        (System(heisenberg(1) @ trivial(), "lc"), ["sets of lower rank that are not listed may exist"], []),
        (System(so(3) @ leibniz(2), "l1"), [], ["sets of lower rank that are not listed may exist"]),
    ],
)  # fmt: skip
def test_what_a_report_tells(system, there, absent):
    text = inspect(system).text(UNICODE)
    assert [words for words in there if words not in text] == []
    assert [words for words in absent if words in text] == []


@pytest.mark.parametrize(
    ("system", "kind"),
    [
        (Top.twisted_kovalevskaya(), "top"),
        (System(so(3) @ leibniz(3), lambda l, a, b: l.dot(l) / 2 + a.dot(a)), "quadratic"),
        (System(so(3) @ semidirect(2), lambda l, a: l.dot(l) / 2 + sp.sqrt(1 + a[0] ** 2)), "tape"),
    ],
)
def test_the_kernel_follows_the_equations(system, kind):
    assert inspect(system).record()["kernel"]["kind"] == kind


def test_a_bracket_that_is_none_is_said_to_fail():
    """se(3) with one wrong constant, and a product that is not associative: nothing is proved for them."""
    constants = [[list(row) for row in plane] for plane in se(3).structure_constants]
    i, j, k = next((i, j, k) for i in range(6) for j in range(6) for k in range(6) if constants[i][j][k] != 0)
    constants[i][j][k], constants[j][i][k] = 2 * constants[i][j][k], 2 * constants[j][i][k]
    wrong = LieAlgebra(constants, check=False) @ leibniz(1)
    record = inspect(System(wrong, wrong.variables[0] ** 2)).record()
    assert record["bracket"]["jacobi"]["proved"] is False
    assert record["bracket"]["jacobi"]["failures"]
    W = [[list(row) for row in plane] for plane in leibniz(3).tensor]
    W[1][1][2] = W[1][2][1] = 1
    twisted = so(3) @ Extension(W, check=False)
    report = inspect(System(twisted, twisted.variables[0] ** 2))
    assert report.record()["bracket"]["jacobi"]["proved"] is False
    assert "casimirs" not in report.record()
    assert report.record()["failed"] == report.record()["bracket"]["jacobi"]["failures"]
    assert "the Jacobi identity fails for" in report.text(PLAIN)


@pytest.mark.thorough
def test_an_integral_that_is_known_already_is_listed_once():
    """P of the twisted Lagrange top, given with a factor and Casimirs; l3 squared is another one."""
    known = Top.twisted_lagrange()
    P, l3 = known.invariants["P"], known.variables[2]
    casimirs = known.bracket.casimirs()
    for given, listed in (
        (2 * P - casimirs[0] + 3 * known.hamiltonian * casimirs[1], ["l3", "mine"]),
        (P + l3**2, ["l3", "P", "mine"]),
        (casimirs[0], ["l3", "P", "mine"]),
    ):
        system = System(known.bracket, known.hamiltonian, integrals={"mine": given})
        assert [entry["name"] for entry in inspect(system).record()["integrals"]] == listed


SEMIDIRECT_TOP = (so(3) @ semidirect(2), "dot(l, l)/2 + alpha[3]")


@pytest.mark.parametrize(
    ("zero", "verdict"),
    [
        ("dot(alpha, alpha)", "not proved"),  # alpha = 0, where l1' = alpha2 vanishes
        ("l1^2 + 1", "not proved"),  # no real points
        ("l1*alpha2", "NOT constant"),  # where l1 = 0
        ("alpha2", "this set is NOT invariant"),  # alpha2' = l1 alpha3 - l3 alpha1
    ],
)
def test_claims_on_a_set_are_refuted_by_a_real_point_only(zero, verdict):
    report = inspect(System(*SEMIDIRECT_TOP, partial_integrals={"K": ("l1", zero)}))
    assert f": {verdict}, " in report.text(PLAIN)
    assert bool(report.failed) == ("NOT" in verdict)
    assert report.record()["integrals"][0]["refuted"] == ("NOT" in verdict)
    for constant in ("0", "1"):
        with pytest.raises(ParameterError, match="function of the coordinates"):
            inspect(System(*SEMIDIRECT_TOP, partial_integrals={"K": ("l1", constant)}))


def test_record_is_json_with_one_object_per_topic():
    record = json.loads(json.dumps(inspect(SYMBOLIC).record()))
    assert list(record) == [
        *("name", "source", "algebra", "extension", "bracket", "casimirs", "rank", "strata", "symmetries"),
        *("hamiltonian", "equations", "integrals", "kernel", "failed"),
    ]
    texts = [c["text"] for c in record["casimirs"]["generators"]]
    assert texts == ["|alpha|^2 + 2 epsilon l.beta", "alpha.beta", "|beta|^2"]
    assert record["casimirs"]["verified"] is record["casimirs"]["complete"] is True
    assert record["rank"] == {"lower": 6, "upper": 6, "corank": 3, "proved": True}
    assert [(s["rank"], s["proved"]) for s in record["strata"]] == [(6, True), (4, True), (2, True), (0, True)]
    assert record["equations"]["vector"][0]["text"] == "l' = l x omega + alpha x a + beta x b"
    missing = ["I1", "I2", "I3", "a1", "a2", "a3", "b1", "b2", "b3", "epsilon"]
    obstacle = f"needs values for {', '.join(missing)}"
    assert record["kernel"] == {"kind": None, "missing_values": missing, "obstacle": obstacle}


def test_integrals_are_proved_or_refuted():
    """Chaplygin's integral is constant where l.alpha = 0, and neither it nor l1 is constant elsewhere."""
    good = catalog.system("goryachev-chaplygin")
    (integral,) = inspect(good).record()["integrals"]
    assert (integral["proved"], integral["on"]["text"]) == (True, "l.alpha")
    G, (_, alpha) = sp.sympify(integral["expression"].replace("^", "**")), good.bracket.fields.values()
    integrals, partial = {"G": G, "l1": sp.Symbol("l1")}, {"F": (G, alpha[2])}
    wrong = System(good.bracket, good.hamiltonian, integrals=integrals, partial_integrals=partial)
    claims = inspect(wrong).record()["integrals"]
    assert [claim["proved"] for claim in claims] == [False, False, False]
    assert "l.alpha" not in claims[1]["derivative"]["text"]


def test_describe_is_the_short_form():
    lines = describe(Top.twisted_lagrange(b3=2)).split("\n")
    assert lines[:5] == [
        "twisted Lagrange top",
        "  bracket      so(3) ⊗ Leibniz(3, epsilon = 1)",
        "  parameters   I = (1, 1, 1/2), a = (0, 0, 1), b = (0, 0, 2), epsilon = 1",
        "  Hamiltonian  H = 1/2 l·I^-1 l + a·alpha + b·beta",
        "  equations",
    ]
    assert lines[9:12] == [
        "  invariants",
        "    H = l1^2/2 + l2^2/2 + l3^2 + alpha3 + 2*beta3",
        "    C1 = |alpha|^2 + 2 l·beta",
    ]
    assert lines[-1] == "    P' = l·alpha + 2 l·beta + beta3"


def test_many_coordinates():
    began = time.process_time()
    report = inspect(System(abelian(301) @ trivial(), "l[1]^2"))
    assert time.process_time() - began < 10
    for key in ("bracket", "casimirs", "rank", "strata", "symmetries", "equations"):
        assert report.record()[key] == {"not_computed": "301 coordinates (limit 200)"}
    assert report.record()["algebra"] == {"not_computed": "301 dimensions (limit 300)"}
    assert "Casimirs         not computed: 301 coordinates (limit 200)" in report.text(PLAIN)
    assert not report.failed


def test_many_fields():
    bracket = abelian(1) @ leibniz(41)
    record = inspect(System(bracket, bracket.variables[0] ** 2)).record()
    assert record["extension"] == {"not_computed": "41 fields (limit 40)"}
    assert record["symmetries"] == {"not_computed": "41 fields (limit 20)"}
    assert record["casimirs"]["complete"]


def test_a_long_hamiltonian(monkeypatch):
    for part in ("symmetries", "hamiltonian", "equations"):
        monkeypatch.setitem(topics.LIMITS[part], "terms in H", 5)
    bracket = so(3) @ trivial()
    l1, l2, _ = bracket.variables
    energy = sum((l1**i * l2 for i in range(6)), 0 * l1)
    record = inspect(System(bracket, energy)).record()
    assert record["equations"] == record["symmetries"] == {"not_computed": "6 terms in H (limit 5)"}
    assert record["rank"]["proved"]


x, y, z = variables = sp.symbols("x y z")


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("function", "zero", "expected"),
    [
        (y, x, True),
        (y, x**2 + y**2, False),  # the real points are x = y = 0
        (z, x**2 + y**2, True),
        (y, x**2 + 1, False),  # no real points
        (y, x * y, True),  # where x = 0
        (x * (x**2 + y**2), x**3 + x * y**2, False),
        (x - y, x**3 - y**3, False),  # x^2 + x y + y^2 = 0 at the origin only
        (y, sp.sqrt(2) * x - 1, True),
        (y, sp.exp(x) - 2, True),
        (y, sp.exp(x) + 2, False),
        (sp.sin(x) ** 2 + sp.cos(x) ** 2 - 1, sp.exp(y) - 2, False),
        (y, 1 / x, False),  # changes its sign at a pole
        (y, sp.Symbol("c") * x, True),
    ],
)
def test_refuted_by_a_real_point_of_the_set(function, zero, expected):
    assert is_nonzero_on(function, zero, variables) is expected


@pytest.mark.parametrize(
    ("function", "expected"),
    [(x**2 * y, True), (1 / x, True), (sp.sqrt(x), True), (sp.sqrt(x**2) - sp.Abs(x), False), (x - x, False)],
)
def test_refuted_by_any_real_point(function, expected):
    assert is_nonzero_somewhere(function, variables) is expected
