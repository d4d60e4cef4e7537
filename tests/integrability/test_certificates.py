"""Certificates: what proves a system integrable is accepted, and nothing that was altered is."""

import ast
import copy
import json
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

import pytest

import liepoisson as lp
from liepoisson.errors import DamagedFileError, MissingFileError, OutputError, ParameterError
from liepoisson.integrability import checker

NAMES = ["kovalevskaya", "clebsch", "twisted-lagrange", "two-field-kovalevskaya", "manakov-so4", "henon-heiles-kdv"]


def certified(name="kovalevskaya"):
    system = lp.catalog.system(name)
    integrals = {"H": system.hamiltonian, **system.integrals}
    return lp.integrability.certificate(system, integrals)


@pytest.mark.thorough
@pytest.mark.parametrize("name", NAMES)
def test_known_integrals_make_a_certificate(name, tmp_path):
    data = certified(name)
    path = lp.integrability.save_certificate(data, tmp_path / "top.json")
    assert lp.integrability.load_certificate(path) == data


def doubled(terms):
    terms[-1][0] = str(2 * Fraction(terms[-1][0]))


def negated(terms):
    for term in terms:
        term[0] = str(-Fraction(term[0]))


def squared(terms):
    terms[-1][1][0] += 1


ALTERED = {
    "a coefficient of an integral": (lambda data: doubled(data["commuting"]["K"]), "K does not commute with H"),
    "an exponent of an integral": (lambda data: squared(data["commuting"]["K"]), "K does not commute with H"),
    "a sign of the bracket": (lambda data: negated(data["poisson_matrix"][0][2]), "the Jacobi identity fails"),
    "a coefficient of the bracket": (lambda data: doubled(data["poisson_matrix"][0][2]), "the Jacobi identity fails"),
    "an entry twice": (lambda data: data["poisson_matrix"].append(data["poisson_matrix"][0]), "one entry for each"),
    "a parameter": (lambda data: doubled(data["hamiltonian"]), "does not commute with H"),
    "a Casimir": (lambda data: doubled(data["casimirs"]["C1"]), "C1 is no Casimir"),
    "a Casimir left out": (lambda data: data["casimirs"].pop("C1"), "Casimirs are missing"),
    "an integral left out": (lambda data: data["commuting"].pop("K"), "fewer independent commuting integrals"),
    "an integral twice": (lambda data: data["commuting"].update(K=data["commuting"]["H"]), "fewer independent"),
    "a singular point": (lambda data: data.update(point=["0"] * 6), "leaf of lower dimension"),
    "a critical point": (lambda data: data.update(point=["0", "0", "0", "1", "0", "0"]), "fewer independent"),
}


@pytest.mark.parametrize("what", ALTERED)
def test_an_altered_certificate_is_refused(what, tmp_path):
    alter, words = ALTERED[what]
    data = certified()
    assert checker.check(data) == ""
    alter(altered := copy.deepcopy(data))
    assert words in checker.check(altered)
    path = tmp_path / "top.json"
    path.write_text(json.dumps(altered))
    with pytest.raises(DamagedFileError, match=words):
        lp.integrability.load_certificate(path)


def test_a_coordinate_of_the_point_that_is_taken_away():
    data = certified()
    data["point"].pop()
    with pytest.raises(ValueError, match="zip"):
        checker.check(data)


@pytest.mark.parametrize("exponents", [[1], [0.5, 0, 0, 0, 0, 0], [-1, 0, 0, 0, 0, 0], ["1", 0, 0, 0, 0, 0]])
def test_exponents_are_whole_numbers_one_for_each_coordinate(exponents):
    data = certified()
    data["commuting"]["K"] = [["1", exponents]]
    with pytest.raises(ValueError, match="exponents are 6 whole numbers"):
        checker.check(data)


@pytest.mark.parametrize(
    "text",
    ["", "[]", "{}", "null", '{"format": 1}', '{"format": "liepoisson certificate of Liouville integrability/1"}'],
)
def test_other_files_are_refused(text, tmp_path):
    path = tmp_path / "top.json"
    path.write_text(text)
    with pytest.raises(DamagedFileError):
        lp.integrability.load_certificate(path)


def test_a_certificate_of_another_format_is_refused(tmp_path):
    path = tmp_path / "top.json"
    path.write_text(json.dumps({**certified(), "format": "another"}))
    with pytest.raises(DamagedFileError, match="format"):
        lp.integrability.load_certificate(path)


def test_files_that_are_missing_or_called_otherwise(tmp_path):
    with pytest.raises(MissingFileError):
        lp.integrability.load_certificate(tmp_path / "none.json")
    with pytest.raises(OutputError, match=r"\.json"):
        lp.integrability.save_certificate(certified(), tmp_path / "top.txt")


def test_what_proves_nothing_makes_no_certificate():
    system = lp.catalog.system("kovalevskaya")
    with pytest.raises(ParameterError, match="fewer independent"):
        lp.integrability.certificate(system, {"H": system.hamiltonian})
    with pytest.raises(ParameterError, match="does not commute with H"):
        lp.integrability.certificate(system, {"H": system.hamiltonian, "l1": system.expression("l1")})


def test_irrational_coefficients_make_no_certificate():
    top = lp.Top(inertia=(1, 1, "sqrt(2)"), a=(0, 0, 1), epsilon=0)
    with pytest.raises(ParameterError, match="rational coefficients"):
        lp.integrability.certificate(top, {"H": top.hamiltonian})


@pytest.mark.thorough
def test_the_checker_is_short_and_stands_alone(tmp_path):
    path = Path(checker.__file__)
    text = path.read_text(encoding="utf-8")
    assert len(text.splitlines()) < 100
    names = {
        getattr(node, "module", None) or alias.name
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.Import | ast.ImportFrom)
        for alias in node.names
    }
    assert names == {"json", "sys", "fractions", "pathlib"}
    good, bad = certified(), certified()
    doubled(bad["hamiltonian"])
    for data, code, words in (
        (good, 0, "accepted: Liouville integrable"),
        (bad, 1, "REFUSED: H does not commute with H"),
    ):
        file = tmp_path / "top.json"
        file.write_text(json.dumps(data))
        ran = subprocess.run([sys.executable, path, file], capture_output=True, text=True, check=False)
        assert (ran.returncode, ran.stdout.strip(), ran.stderr) == (code, words, "")
