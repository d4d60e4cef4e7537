"""Saved reports: what is true is loaded again, and nothing that was altered is."""

import json

import pytest

import liepoisson as lp
from liepoisson.errors import DamagedFileError, MissingFileError, OutputError

report, load = lp.integrability.integrability_report, lp.integrability.load_report
CENTRAL = lp.System(
    lp.canonical(names=("x", "y", "z")), "(p_x^2 + p_y^2 + p_z^2)/2 + (x^2 + y^2 + z^2)^2", name="central"
)


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("system", "degree", "verdict"),
    [
        (lp.catalog.system("clebsch"), 2, "integrable"),
        (CENTRAL, 2, "superintegrable"),
        (lp.catalog.system("toda"), 3, "integrable"),
        (lp.catalog.system("henon-heiles"), 3, "not integrable"),
        (lp.Top.kovalevskaya(epsilon=1), 3, "not integrable"),
        pytest.param(lp.catalog.system("twisted-top"), 1, "no further polynomial integral", marks=pytest.mark.slow),
        (lp.catalog.system("zeitlin-3"), 2, "no further polynomial integral"),
        (lp.catalog.system("free-rigid-body"), 2, "integrable"),
    ],
)
def test_every_verdict_is_saved_and_verified(system, degree, verdict, tmp_path):
    made = report(system, degree=degree)
    assert made.verdict == verdict
    path = made.save(tmp_path / "report.json")
    again = load(path, prove_again=True)
    assert str(again) == str(made)
    assert (again.certificate, again.closed) == (made.certificate, made.closed)
    assert again.system.equations == system.equations
    told = load(path)
    assert told.verdict == verdict
    assert ("not proved again" in str(told)) == bool(made.searches)
    if verdict == "no further polynomial integral":
        assert "as the file says, not proved again" in repr(told)
        assert "not proved again" not in repr(again)


def altered(data, alter):
    data = json.loads(json.dumps(data))
    alter(data)
    return data


def set_at(*keys_and_value):
    *keys, last, value = keys_and_value

    def alter(data):
        for key in keys:
            data = data[key]
        data[last] = value

    return alter


ALTERED = {
    "verdict": (set_at("verdict", "superintegrable"), "the entry 'verdict' should be 'integrable'"),
    "rank": (set_at("rank", 6), "the rank should be 4"),
    "name": (set_at("system", "another"), "the system should be 'clebsch'"),
    "H": (set_at("integrals", 0, "expression", "m1^2"), "H is not the Hamiltonian"),
    "an integral": (set_at("integrals", 1, "expression", "m1^2"), "F1 = m1**2 is no integral"),
    "a dependent integral": (set_at("integrals", 1, "expression", "p1^2 + p2^2 + p3^2"), "not independent"),
    "the commuting ones": (set_at("commuting", ["F1", "H"]), "the commuting integrals should be"),
    "the certificate": (set_at("certificate", "hamiltonian", []), "the certificate"),
    "a certificate of another": (set_at("certificate", "system", "another"), "the certificate should be"),
    "what was found": (set_at("searches", 1, "found", 0, "expression", "m1"), "no integral"),
    "a Casimir": (set_at("searches", 0, "known", 0, "expression", "m1"), "the Casimirs should be"),
    "the degree": (set_at("searched_degree", 20), "searched_degree"),
    "the system": (set_at("file", "name = 3"), "the system of the file"),
    "an obstruction": (
        set_at("obstruction", {"verdict": "not integrable", "theorem": "", "statement": "", "steps": []}),
        "what the differential Galois group says should be 'open'",
    ),
    "the format": (set_at("format", "another"), "format"),
    "a missing entry": (lambda data: data.pop("searches"), "a file that is none"),
    "a wrong type": (set_at("integrals", 3), "a file that is none"),
}  # fmt: skip


@pytest.fixture(scope="module")
def clebsch(tmp_path_factory):
    path = report(lp.catalog.system("clebsch")).save(tmp_path_factory.mktemp("reports") / "clebsch.json")
    return json.loads(path.read_text())


@pytest.mark.parametrize("what", ALTERED)
def test_an_altered_report_is_refused(what, clebsch, tmp_path):
    alter, words = ALTERED[what]
    path = tmp_path / "report.json"
    path.write_text(json.dumps(altered(clebsch, alter)))
    with pytest.raises(DamagedFileError, match=words.replace("*", r"\*")):
        load(path)


@pytest.mark.parametrize(
    ("keys", "value"),
    [(("complete",), False), (("proof", "integrals"), 7), (("proof", "monomials"), 1), (("found",), [])],
)
def test_what_a_file_says_of_a_search_is_compared_where_it_is_made_again(keys, value, clebsch, tmp_path):
    path = tmp_path / "report.json"
    data = altered(clebsch, set_at("searches", 1, *keys, value))
    if keys == ("complete",):
        data["searched_degree"], data["not_tried"][0] = 1, "polynomials above degree 1"
    path.write_text(json.dumps(data))
    load(path)
    with pytest.raises(DamagedFileError, match="up to degree 2 should be"):
        load(path, prove_again=True)


def test_files_that_are_missing_or_called_otherwise(tmp_path):
    with pytest.raises(MissingFileError):
        load(tmp_path / "none.json")
    with pytest.raises(OutputError, match=r"\.json"):
        report(lp.catalog.system("lagrange")).save(tmp_path / "top.txt")
    (tmp_path / "text.json").write_text("nothing")
    with pytest.raises(DamagedFileError):
        load(tmp_path / "text.json")
