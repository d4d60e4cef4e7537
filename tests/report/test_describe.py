"""The report on a system: complete, computed now, the same in text, LaTeX and JSON; compared with stored reports."""

import json
import os
from pathlib import Path

import pytest
import sympy as sp

from liepoisson import catalog
from liepoisson.errors import ParameterError
from liepoisson.formula.styles import PLAIN, UNICODE
from liepoisson.model.system import System
from liepoisson.model.tops import Top
from liepoisson.report.describe import describe, inspect
from liepoisson.report.lines import write_line
from liepoisson.structure.extension import Extension
from liepoisson.structure.extensions import leibniz, semidirect, trivial
from liepoisson.structure.lie_algebra import LieAlgebra
from liepoisson.structure.lie_algebras import affine, heisenberg, se, so

SNAPSHOTS = Path(__file__).parents[1] / "snapshots"
SYMBOLIC = Top.twisted(("I1", "I2", "I3"), ("a1", "a2", "a3"), ("b1", "b2", "b3"), "epsilon")


def compare(name, text):
    """With the stored report; LIEPOISSON_UPDATE_SNAPSHOTS=1 stores a new one, to be read before it is kept."""
    path = SNAPSHOTS / name
    if os.environ.get("LIEPOISSON_UPDATE_SNAPSHOTS"):
        path.write_text(text + "\n", encoding="utf-8")
    assert text + "\n" == path.read_text(encoding="utf-8"), f"{path} differs"


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["twisted-top", "twisted-lagrange", "clebsch", "manakov-so4", "goryachev-chaplygin"])
def test_reports_in_unicode(name):
    compare(f"inspect-{name}.txt", inspect(catalog.system(name)).text(UNICODE))


def test_report_in_ascii():
    text = inspect(catalog.system("twisted-top")).text(PLAIN)
    assert text.isascii()
    compare("inspect-twisted-top-ascii.txt", text)


def test_report_in_latex():
    compare("inspect-twisted-top.tex", inspect(catalog.system("twisted-top")).latex())


def test_record_is_json_with_one_object_per_topic():
    record = json.loads(json.dumps(inspect(SYMBOLIC).record()))
    assert list(record) == [
        *("name", "source", "algebra", "extension", "bracket", "casimirs", "rank", "strata", "symmetries"),
        *("hamiltonian", "equations", "integrals", "kernel", "failed"),
    ]
    assert [c["text"] for c in record["casimirs"]["generators"]] == [
        "|alpha|^2 + 2 epsilon l.beta",
        "alpha.beta",
        "|beta|^2",
    ]
    assert record["casimirs"]["verified"] is record["casimirs"]["complete"] is True
    assert record["rank"] == {"lower": 6, "upper": 6, "corank": 3, "proved": True}
    assert [(s["rank"], s["proved"]) for s in record["strata"]] == [(6, True), (4, True), (2, True), (0, True)]
    assert record["equations"]["vector"][0]["text"] == "l' = l x omega + alpha x a + beta x b"
    assert record["equations"]["definitions"][0]["text"] == "omega = I^-1 l"
    assert record["kernel"] == {
        "kind": None,
        "missing_values": ["I1", "I2", "I3", "a1", "a2", "a3", "b1", "b2", "b3", "epsilon"],
        "obstacle": "needs values for I1, I2, I3, a1, a2, a3, b1, b2, b3, epsilon",
    }


def test_component_equations_of_the_record_are_those_of_the_system():
    system = catalog.system("manakov-so4")
    components = inspect(system).record()["equations"]["components"]
    read = {name: sp.sympify(entry["expression"].replace("^", "**")) for name, entry in components.items()}
    assert read == {str(x): value for x, value in system.equations.items()}


def test_a_bracket_of_full_rank_has_no_casimirs():
    """affine(1): [a, b] = b, so that J = -l_b [[0, 1], [-1, 0]] has rank 2 where l_b is not 0."""
    report = inspect(System(affine(1) @ trivial(), lambda l: l.dot(l) / 2))
    assert "  Casimirs         none: J has full rank at generic points\n" in report.text(PLAIN)
    record = report.record()
    assert (record["casimirs"]["generators"], record["casimirs"]["complete"], record["rank"]["corank"]) == ([], True, 0)


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


@pytest.mark.thorough
def test_symbols_of_a_top_that_is_typed_get_the_usual_names():
    """J, c, d instead of I, a, b: the equations are printed with I, a, b, and these are said to be J, c, d."""
    J, c, d = (sp.symbols(f"{name}1:4") for name in "Jcd")
    system = System(
        so(3) @ leibniz(3, "kappa"),
        lambda l, u, v: sum(l[i] ** 2 / (2 * J[i]) + c[i] * u[i] + d[i] * v[i] for i in range(3)),
        symbols=("J[3]", "c[3]", "d[3]"),
    )
    text = inspect(system).text(UNICODE)
    assert "α′ = α × ω + ε β × a" in text
    assert "I = diag(J₁, J₂, J₃)" in text
    assert "ε = κ" in text


def test_a_hamiltonian_with_casimirs_added_is_printed_as_it_is():
    system = System(so(3) @ leibniz(3), lambda l, a, b: l.dot(l) / 2 + a[2] + b.dot(b))
    record = inspect(system).record()
    assert record["hamiltonian"]["text"] == "1/2 |l|^2 + |beta|^2 + alpha3"
    assert record["kernel"]["kind"] == "top"


def test_integrals_are_proved_or_refuted():
    """Chaplygin's integral is constant where l.alpha = 0, and neither it nor l1 is constant elsewhere."""
    good = catalog.system("goryachev-chaplygin")
    (integral,) = inspect(good).record()["integrals"]
    assert integral["proved"]
    assert integral["on"]["text"] == "l.alpha"
    hamiltonian, bracket, G = good.hamiltonian, good.bracket, sp.sympify(integral["expression"].replace("^", "**"))
    claims = inspect(System(bracket, hamiltonian, integrals={"G": G, "l1": sp.Symbol("l1")})).record()["integrals"]
    assert [claim["proved"] for claim in claims] == [False, False]
    assert "l.alpha" not in claims[1]["derivative"]["text"]
    _, alpha = bracket.fields.values()
    elsewhere = System(bracket, hamiltonian, partial_integrals={"G": (G, alpha[2])})
    assert not inspect(elsewhere).record()["integrals"][0]["proved"]


def test_an_integral_on_a_set_that_is_not_invariant_is_not_proved():
    """{l3, H} = alpha2 vanishes on alpha2 = 0, but this set is left at once."""
    system = System(
        so(3) @ semidirect(2),
        lambda l, alpha: l.dot(l) / 2 - alpha[0],
        partial_integrals={"l3": (sp.Symbol("l3"), sp.Symbol("alpha2"))},
    )
    assert not inspect(system).record()["integrals"][0]["proved"]


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


def test_leaves_that_are_not_proved_may_be_incomplete():
    """J of the Heisenberg algebra vanishes where its central coordinate does, which the list does not say."""
    warning = "sets of lower rank that are not listed may exist"
    for bracket in (heisenberg(1) @ trivial(), se(2) @ trivial(), so(4) @ trivial()):
        assert warning in inspect(System(bracket, bracket.variables[0])).text(PLAIN)
    proved = so(3) @ leibniz(2)
    assert warning not in inspect(System(proved, proved.variables[0])).text(PLAIN)


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


@pytest.mark.thorough
def test_long_casimirs_are_written_once():
    text = inspect(catalog.system("zeitlin-3")).text(UNICODE)
    assert "constant on them: |w|², C₂" in text


@pytest.mark.thorough
def test_no_row_of_the_report_is_longer_than_the_page():
    for name in ("steklov", "zeitlin-3", "lyapunov"):
        assert max(map(len, inspect(catalog.system(name)).text(UNICODE).split("\n"))) <= 119


@pytest.mark.thorough
def test_a_full_matrix_of_parameters_is_written_as_one():
    bracket, energy = so(3) @ semidirect(2), "dot(l, l)/2 + dot(alpha, A*alpha)/2"
    system = System(bracket, energy, {"A": [[2, 1, 0], [1, 3, 0], [0, 0, "1/2"]]})
    text = inspect(system).text(UNICODE)
    assert "H = ½ α·A α + ½ |l|²" in text
    assert "A = ((2, 1, 0), (1, 3, 0), (0, 0, 1/2))" in text
    assert "∂H/∂α = A α" in text
    assert r"A &= \begin{pmatrix}2 & 1 & 0 \\ 1 & 3 & 0 \\ 0 & 0 & \frac{1}{2}\end{pmatrix}" in inspect(system).latex()
    skew = System(bracket, energy, {"A": [[2, 1, 0], [0, 3, 0], [0, 0, 1]]})
    assert "∂H/∂α = A α" not in inspect(skew).text(UNICODE)


def test_latex_breaks_long_formulas_in_paragraphs():
    text = inspect(catalog.system("zeitlin-3")).latex()
    displayed = [line for line in text.split("\n") if line.startswith(r"\[")]
    assert any("C_1" in line for line in displayed)
    assert not any("more terms" in line for line in displayed)
    assert "more terms" in text


def test_describe_is_the_short_form():
    assert describe(Top.twisted_lagrange(b3=2)) == "\n".join(
        [
            "twisted Lagrange top",
            "  bracket      so(3) ⊗ Leibniz(3, epsilon = 1)",
            "  parameters   I = (1, 1, 1/2), a = (0, 0, 1), b = (0, 0, 2), epsilon = 1",
            "  Hamiltonian  H = 1/2 l·I^-1 l + a·alpha + b·beta",
            "  equations",
            "    l' = l × omega + alpha × a + beta × b",
            "    alpha' = alpha × omega + epsilon beta × a",
            "    beta' = beta × omega",
            "    omega = I^-1 l",
            "  invariants",
            "    H = l1^2/2 + l2^2/2 + l3^2 + alpha3 + 2*beta3",
            "    C1 = |alpha|^2 + 2 l·beta",
            "    C2 = alpha·beta",
            "    C3 = |beta|^2",
            "    l3 = l3",
            "    P' = l·alpha + 2 l·beta + beta3",
        ]
    )


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["so21-heavy-top", "so21-twisted-top"])
def test_the_scalar_product_of_so21_is_defined_where_it_is_used(name):
    here = catalog.system(name)
    report = inspect(here)
    meaning = "u·v = u₁ v₁ + u₂ v₂ - u₃ v₃"
    topics = {topic.key: topic for topic in report.topics}
    told = {key: any(meaning in write_line(line, UNICODE) for line in topic.lines()) for key, topic in topics.items()}
    has_dot = {key: any("·" in write_line(line, UNICODE) for line in topic.lines()) for key, topic in topics.items()}
    assert told["casimirs"]
    assert not has_dot["hamiltonian"]
    assert told["integrals"] == has_dot["integrals"]
    assert report.record()["casimirs"]["definitions"][0]["unicode"] == meaning
    assert r"\boldsymbol{u}\cdot \boldsymbol{v} = u_1 v_1 + u_2 v_2 - u_3 v_3" in report.latex()
    assert meaning in report.text(UNICODE)
    assert "u·v = u1*v1 + u2*v2 - u3*v3" in describe(here)
    assert "u·v" not in inspect(catalog.system("heavy-top")).text(UNICODE)


def test_no_symmetries_found_says_what_was_searched():
    """Two copies of so(3) have the symmetry that exchanges them, which no family of maps contains."""
    text = inspect(System(so(3) @ (trivial() + trivial()), "dot(l, alpha)")).text(UNICODE)
    assert "no one-parameter family that acts on the fields alone" in text


SEMIDIRECT_TOP = (so(3) @ semidirect(2), "dot(l, l)/2 + alpha[3]")


@pytest.mark.thorough
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


@pytest.mark.parametrize("zero", ["1", "0"])
def test_a_set_that_is_given_by_a_constant_is_refused(zero):
    with pytest.raises(ParameterError, match="function of the coordinates"):
        inspect(System(*SEMIDIRECT_TOP, partial_integrals={"K": ("l1", zero)}))


def test_very_large_and_small_parameters_are_printed_with_a_power_of_ten():
    system = System(so(3) @ trivial(), "c*dot(l, l)/2 + d*l[1]", {"c": "1e200", "d": "1e-320"})
    text = inspect(system).text(PLAIN)
    assert "c = 1e200\n" in text
    assert "d = 1e-320\n" in text
