"""The report: verdicts, their certificates, and what is left open."""

import pytest
from searched_systems import TOP, toda

import liepoisson as lp
from liepoisson.errors import ParameterError
from liepoisson.integrability import checker
from liepoisson.integrability.report import _add_brackets

report = lp.integrability.integrability_report


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("name", "commuting"),
    [
        ("free-rigid-body", 1), ("lagrange", 2), ("kovalevskaya", 2), ("clebsch", 2), ("steklov", 2),
        ("manakov-so4", 2), ("twisted-lagrange", 3), ("two-field-kovalevskaya", 3), ("three-wave", 3),
        ("henon-heiles-kaup-kupershmidt", 2),
    ],
)  # fmt: skip
def test_integrable_systems_are_proved_to_be(name, commuting):
    found = report(lp.catalog.system(name))
    assert (found.verdict, len(found.commuting), found.rank) == ("integrable", commuting, 2 * commuting)
    assert found.commuting[0] == "H"
    assert checker.check(found.certificate) == ""


def test_the_toda_lattice_is_integrable():
    found = report(toda())
    assert (found.verdict, found.commuting, found.searched_degree) == ("integrable", ("H", "F1"), 3)


def test_a_round_oscillator_is_superintegrable():
    found = report(lp.System(lp.canonical(2), "(p1^2 + p2^2 + q1^2 + q2^2)/2", name="oscillator"))
    assert found.verdict == "superintegrable"
    assert len(found.integrals) == 3
    assert checker.check(found.certificate) == ""


@pytest.mark.parametrize("system", [TOP, lp.catalog.system("henon-heiles")])
def test_where_there_are_no_integrals_the_degree_is_said(system):
    found = report(system, degree=4)
    assert (found.verdict, found.searched_degree) == ("no further polynomial integral", 4)
    assert (found.certificate, found.commuting) == (None, ())
    assert all(search.complete for search in found.searches)
    assert "no polynomial integral up to degree 4" in repr(found)
    assert found.not_tried[0] == "polynomials above degree 4"


def test_the_limit_of_time_is_kept():
    found = report(TOP, degree=20, time_limit=0.01)
    assert len(found.searches) < 5
    assert found.verdict == "no further polynomial integral"


def test_too_large_degrees_are_left_out_with_a_note():
    found = report(lp.catalog.system("henon-heiles"), degree=40, time_limit=0.5)
    assert found.searched_degree < 40
    assert found.notes[-1].startswith(f"degree {found.searched_degree + 1}")
    with pytest.raises(ParameterError, match=r"wanted a polynomial .* got log\(q2\)"):
        report(lp.System(lp.canonical(2), "dot(p, p)/2 + q1*log(q2)"))


def test_what_a_report_prints():
    text = str(report(lp.catalog.system("clebsch")))
    assert text.startswith("clebsch: Liouville integrable, 2 commuting integrals on leaves of dimension 4: proved")
    assert "commuting: H, F1" in text
    assert text.endswith(
        "not tried: polynomials above degree 2; integrals that are no polynomials; integrals on one level only"
    )


def test_systems_with_other_functions_have_a_verdict_and_no_certificate():
    found = report(lp.catalog.system("toda"))
    assert (found.verdict, found.commuting, found.searched_degree) == ("integrable", ("H", "F1", "F2"), 3)
    assert found.certificate is None
    assert "no certificate" in found.notes[-1]
    assert found.not_tried[0] == "polynomials in these functions above degree 3"


def test_brackets_of_integrals_are_integrals():
    algebra = lp.canonical(names=("x", "y", "z"))
    system = lp.System(algebra, "(p_x^2 + p_y^2 + p_z^2)/2 + (x^2 + y^2 + z^2)^2")
    integrals = {
        name: system.expression(f) for name, f in [("H", "H"), ("F1", "y*p_z - z*p_y"), ("F2", "z*p_x - x*p_z")]
    }
    notes = _add_brackets(system, integrals, 6)
    assert notes == ["F3 = {F1, F2}, by Poisson's theorem"]
    assert integrals["F3"] in {system.expression("x*p_y - y*p_x"), system.expression("y*p_x - x*p_y")}
