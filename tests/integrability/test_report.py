"""The report: verdicts, their certificates, and what is left open."""

from itertools import count

import pytest
from searched_systems import TOP

import liepoisson as lp
from liepoisson.errors import ParameterError
from liepoisson.integrability import checker
from liepoisson.integrability.report import _add_brackets

report = lp.integrability.integrability_report


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("name", "commuting"),
    [
        ("free-rigid-body", 1), ("kovalevskaya", 2), ("manakov-so4", 2), ("twisted-lagrange", 3), ("three-wave", 3),
    ],
)  # fmt: skip
def test_integrable_systems_are_proved_to_be(name, commuting):
    found = report(lp.catalog.system(name))
    assert (found.verdict, len(found.commuting), found.rank) == ("integrable", commuting, 2 * commuting)
    assert found.commuting[0] == "H"
    assert checker.check(found.certificate) == ""


def test_a_round_oscillator_is_superintegrable():
    found = report(lp.System(lp.canonical(2), "(p1^2 + p2^2 + q1^2 + q2^2)/2", name="oscillator"))
    assert found.verdict == "superintegrable"
    assert len(found.integrals) == 3
    assert checker.check(found.certificate) == ""


@pytest.mark.parametrize(
    ("system", "verdict"),
    [(TOP, "no further polynomial integral"), (lp.catalog.system("henon-heiles"), "not integrable")],
)
def test_where_there_are_no_integrals_the_degree_is_said(system, verdict):
    found = report(system, degree=4)
    assert (found.verdict, found.searched_degree) == (verdict, 4)
    assert (found.certificate, found.commuting) == (None, ())
    assert all(search.complete for search in found.searches)
    assert "no polynomial integral up to degree 4" in repr(found)
    assert found.not_tried[0] == "polynomials above degree 4"
    # of the generic top it depends on the speed of the machine whether all balances are found in time
    assert found.singularities.verdict in ({"fails"} if verdict == "not integrable" else {"fails", "undecided"})
    assert (found.obstruction.verdict == "not integrable") == (verdict == "not integrable")
    assert ("not Liouville integrable with meromorphic integrals" in str(found)) == (verdict == "not integrable")


def test_the_limit_of_time_is_kept(monkeypatch):
    from liepoisson.inputs import deadline

    n_asked = count()
    monkeypatch.setattr(deadline.time, "monotonic", lambda: 100.0 if next(n_asked) > 200 else 0.0)
    found = report(TOP, degree=20)
    assert len(found.searches) < 5
    assert found.verdict == "open"


def test_systems_with_other_functions_have_a_verdict_and_no_certificate():
    found = report(lp.catalog.system("toda"))
    assert (found.verdict, found.commuting, found.searched_degree) == ("integrable", ("H", "F1", "F2"), 3)
    assert found.certificate is None
    assert "no certificate" in found.notes[-1]
    assert found.not_tried[0] == "polynomials in these functions above degree 3"


E3 = lp.so(3) @ lp.semidirect(2).rename("l", "alpha")


def test_generators_are_found_once():
    found = report(lp.System(E3, "dot(l, alpha)"), degree=3)
    assert [len(s.found) for s in found.searches] == [6, 0, 0]
    assert "besides polynomials in these and the Casimirs: proved" in repr(found)


@pytest.mark.parametrize(
    ("bracket", "hamiltonian", "degree"),
    [
        # central forces: H, L3 and L^2; so(4) in so(5): H, the Pfaffian, l12 and l34
        (lp.canonical(3), "(p1^2 + p2^2 + p3^2)/2 + (q1^2 + q2^2 + q3^2)^2", 2),
        (lp.so(5) @ lp.trivial(), "l12^2 + l13^2 + l14^2 + l23^2 + l24^2 + l34^2", 2),
    ],
)
def test_combinations_that_commute_are_found(bracket, hamiltonian, degree, tmp_path):
    system = lp.System(bracket, hamiltonian)
    found = report(system, degree=degree)
    assert found.verdict == "superintegrable"
    assert len(found.commuting) == found.rank // 2
    functions = [(found.integrals | found.dependent)[name] for name in found.commuting]
    assert all(system.bracket(f, g).expand() == 0 for f in functions for g in functions)
    assert checker.check(found.certificate) == ""
    again = lp.integrability.load_report(found.save(tmp_path / "report.json"), prove_again=True)
    assert str(again).replace("note of the file: ", "") == str(found)


@pytest.mark.parametrize(
    ("bracket", "hamiltonian"),
    [
        (lp.canonical(names=("H", "F1")), "(p_H^2 + H^2)/2 + p_F1^2 + F1^2"),
        ((lp.so(3) @ lp.semidirect(2)).rename("C", "F"), "C1^2 + (C2^2 + C3^2)/2 + F1"),
    ],
)
def test_integrals_and_casimirs_are_not_called_like_coordinates(bracket, hamiltonian):
    found = report(lp.System(bracket, hamiltonian), degree=2)
    assert found.certificate is not None
    names = {*found.integrals, *found.certificate["casimirs"]} - {"H"}
    assert not names & set(found.system.component_names)


def test_where_casimirs_are_unknown_nothing_is_called_proved(tmp_path):
    """[e1, e3] = e1, [e2, e3] = e2, whose Casimir x1/x2 is no polynomial."""
    algebra = lp.LieAlgebra.from_brackets(3, {(0, 2): {0: 1}, (1, 2): {1: 1}})
    system = lp.System(algebra @ lp.trivial(), "l1*l2 + l3")
    assert system.is_casimir(system.variables[0] / system.variables[1])
    assert (system.bracket.casimirs(), system.bracket.n_unknown_casimirs, system.bracket.corank()) == ([], 1, 1)
    found = report(system, degree=2)
    assert (found.verdict, found.commuting, found.certificate) == ("open", ("H",), None)
    assert "1 of 1 Casimirs is unknown" in str(found)
    assert "proved" not in str(found)
    assert "certificate" not in str(found)
    loaded = lp.integrability.load_report(found.save(tmp_path / "open.json"))
    assert (loaded.verdict, str(loaded).splitlines()[0]) == ("open", str(found).splitlines()[0])
    with pytest.raises(
        ParameterError, match="wanted a bracket of which all Casimirs are known; 1 of 1 Casimirs is unknown"
    ):
        lp.integrability.certificate(system, {"H": "l1*l2 + l3"})


def test_brackets_of_integrals_are_integrals():
    algebra = lp.canonical(names=("x", "y", "z"))
    system = lp.System(algebra, "(p_x^2 + p_y^2 + p_z^2)/2 + (x^2 + y^2 + z^2)^2")
    integrals = {
        name: system.expression(f) for name, f in [("H", "H"), ("F1", "y*p_z - z*p_y"), ("F2", "z*p_x - x*p_z")]
    }
    notes = _add_brackets(system, integrals, {}, 6)
    assert notes == ["F3 = {F1, F2}, by Poisson's theorem"]
    assert integrals["F3"] in {system.expression("x*p_y - y*p_x"), system.expression("y*p_x - x*p_y")}
