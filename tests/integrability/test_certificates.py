"""Certificates: what proves a system integrable is accepted, and nothing that was altered is."""

import ast
import copy
import json
import subprocess
import sys
from fractions import Fraction
from functools import cache
from pathlib import Path

import pytest

import liepoisson as lp
from liepoisson.errors import DamagedFileError, MissingFileError, OutputError, ParameterError
from liepoisson.integrability import checker

NAMES = ["clebsch", "two-field-kovalevskaya", "henon-heiles-kdv"]


@cache
def certificate_of(name):
    system = lp.catalog.system(name)
    integrals = {"H": system.hamiltonian, **system.integrals}
    return lp.integrability.certificate(system, integrals)


def certified(name="kovalevskaya"):
    """A certificate that may be altered."""
    return copy.deepcopy(certificate_of(name))


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


def renamed(data):
    """The commuting functions under the names of the Casimirs."""
    data["commuting"] = dict(zip(data["casimirs"], data["commuting"].values(), strict=True))


MALFORMED = {
    "an entry twice": (lambda data: data["poisson_matrix"].append(data["poisson_matrix"][0]), "wrong entries"),
    "an entry i > j": (lambda data: data["poisson_matrix"].append([2, 1, [["1", [0] * 6]]]), "wrong entries"),
    "an index that is true": (lambda data: data["poisson_matrix"].append([0, True, []]), "wrong entries"),
    "no coordinate": (lambda data: data["point"].pop(), "a coordinate for each"),
    "no variables": (lambda data: data.update(variables=[], point=[]), "1 to 100 variables"),
    "a variable twice": (lambda data: data["variables"].__setitem__(0, "l2"), "or one twice"),
    "equal names": (renamed, "or one twice"),
    "a name of two lines": (lambda data: data["commuting"].update({"F\n1": []}), "unprintable"),
    "a monomial twice": (lambda data: data["hamiltonian"].insert(0, ["5", data["hamiltonian"][0][1]]), "twice"),
    "an exponent that is true": (lambda data: data["hamiltonian"].append(["1", [True] * 6]), "exponents"),
    "an exponent too few": (lambda data: data["commuting"]["K"].append(["1", [1]]), "exponents are 6 whole numbers"),
    "an exponent without end": (lambda data: data["commuting"]["K"].append(["1", [10**9, 0, 0, 0, 0, 0]]), "at most"),
}  # fmt: skip


@pytest.mark.parametrize("what", MALFORMED)
def test_a_certificate_that_can_be_read_in_two_ways_is_refused(what, tmp_path):
    alter, words = MALFORMED[what]
    alter(data := certified())
    with pytest.raises(ValueError, match=words):
        checker.check(data)
    path = tmp_path / "top.json"
    path.write_text(json.dumps(data))
    with pytest.raises(DamagedFileError, match=words):
        lp.integrability.load_certificate(path)
    with pytest.raises(ParameterError, match=words):
        lp.integrability.save_certificate(data, tmp_path / "again.json")


@pytest.mark.parametrize(
    "number",
    [
        "1e3000000000", "1_0", "\uff11", " 1", "1.5", "1/-2", "", "9" * 1001, 1, True, None, float("nan"),
    ],
)  # fmt: skip
def test_numbers_are_fractions_in_digits(number, tmp_path):
    path = tmp_path / "top.json"
    for place in ("point", "coefficient"):
        data = certified()
        if place == "point":
            data["point"][0] = number
        else:
            data["commuting"]["K"][0][0] = number
        path.write_text(json.dumps(data))
        with pytest.raises(DamagedFileError, match="numbers are texts"):
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
    assert len(text.splitlines()) < 120
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


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("", "it cannot be read"),
        ("[" * 100_000, "it cannot be read"),
        ('{"a": 1, "a": 2}', "a key occurs twice"),
        ("7", "it is none"),
        ("[]", "its entries should be casimirs, commuting"),
        ({"comment": ""}, "its entries should be"),
        ({"format": "liepoisson certificate of Liouville integrability/2"}, "another format"),
        ({"system": 7}, "another format"),
        ({"variables": 7}, "it is none"),
        ({"commuting": {"H": 7}}, "it is none"),
        ({"point": None}, "it is none"),
        ({"poisson_matrix": [[1]]}, "not enough values"),
        ({"hamiltonian": [[]]}, "not enough values"),
    ],
    ids=lambda value: str(value)[:40],
)
def test_the_checker_refuses_what_the_loader_refuses_and_in_a_sentence(tmp_path, content, words):
    path = tmp_path / "top.json"
    path.write_text(content if isinstance(content, str) else json.dumps(certified() | content))
    with pytest.raises(DamagedFileError):
        lp.integrability.load_certificate(path)
    call = [sys.executable, checker.__file__, path]
    ran = subprocess.run(call, capture_output=True, text=True, check=False)
    assert (ran.returncode, ran.stderr) == (1, "")
    assert ran.stdout.startswith("REFUSED: ")
    assert words in ran.stdout
