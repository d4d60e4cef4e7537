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
        (lp.Top.kovalevskaya(epsilon=1), 3, "not integrable"),
        (lp.catalog.system("zeitlin-3"), 2, "no further polynomial integral"),
    ],
)
def test_every_verdict_is_saved_and_verified(system, degree, verdict, tmp_path):
    made = report(system, degree=degree)
    assert made.verdict == verdict
    path = made.save(tmp_path / "report.json")
    again = load(path, prove_again=True)
    assert str(again).replace("note of the file: ", "") == str(made)
    assert (again.certificate, again.closed) == (made.certificate, made.closed)
    assert again.system.equations == system.equations
    told = load(path)
    assert told.verdict == verdict
    assert ("not proved again" in str(told)) == bool(made.searches)


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
    "no commuting ones": (set_at("commuting", []), "F1 commute and are enough"),
    "the certificate": (set_at("certificate", "hamiltonian", []), "the certificate"),
    "a certificate of another": (set_at("certificate", "system", "another"), "the certificate should be"),
    "what was found": (set_at("searches", 1, "found", 0, "expression", "m1"), "which should be among the"),
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


SEPARABLE = lp.System(lp.canonical(2), "dot(p, p)/2 + q1^2/2 + q1^4 + q2^4/4", name="separable")
HIDDEN = {"name": "F1", "expression": "p1^2/2 + q1^2/2 + q1^4"}


@pytest.fixture(scope="module")
def separable(tmp_path_factory):
    """Of degree 2: the integral of degree 4 besides H is not found."""
    made = report(SEPARABLE, degree=2, time_limit=0.9)
    assert list(made.integrals) == ["H"]
    return json.loads(made.save(tmp_path_factory.mktemp("reports") / "separable.json").read_text())


def with_search_of_degree_4(data, known):
    """As if degree 4 had been searched, with these functions besides H taken as known."""
    found = lp.integrability.first_integrals(
        SEPARABLE, degree=4, known={"H": SEPARABLE.hamiltonian} | {f["name"]: f["expression"] for f in known}
    )
    data = json.loads(json.dumps(data))
    search = json.loads(json.dumps(data["searches"][-1])) | {"degree": 4, "found": []}
    search["known"] += known
    search["proof"] |= {
        "monomials": found.n_monomials,
        "integrals": found.n_integrals,
        "blocks": found.n_blocks,
    }
    data["searches"].append(search)
    data["degree"] = data["searched_degree"] = 4
    data["verdict"], data["not_tried"][0] = "no further polynomial integral", "polynomials above degree 4"
    return data


@pytest.mark.parametrize("prove_again", [False, True])
def test_a_search_cannot_hide_an_integral_among_what_is_known(prove_again, separable, tmp_path):
    path = tmp_path / "report.json"
    path.write_text(json.dumps(with_search_of_degree_4(separable, [HIDDEN])))
    with pytest.raises(DamagedFileError, match=r"takes F1 = .* as known; the report has no such integral"):
        load(path, prove_again=prove_again)


@pytest.mark.parametrize("with_search", [False, True])
def test_an_independent_integral_cannot_be_called_dependent(with_search, separable, tmp_path):
    path = tmp_path / "report.json"
    data = with_search_of_degree_4(separable, [HIDDEN]) if with_search else json.loads(json.dumps(separable))
    data["dependent"] = [HIDDEN]
    path.write_text(json.dumps(data))
    with pytest.raises(DamagedFileError, match="said to depend on the others does not"):
        load(path)


def test_a_search_made_again_must_not_find_more(separable, tmp_path):
    """The number of integrals agrees, since F1 is found either way: the report does not list it."""
    path = tmp_path / "report.json"
    path.write_text(json.dumps(with_search_of_degree_4(separable, [])))
    load(path)
    with pytest.raises(DamagedFileError, match="up to degree 4"):
        load(path, prove_again=True)


@pytest.mark.parametrize(
    ("alter", "words"),
    [
        (set_at("kind", "x"), "the kind of system"),
        (set_at("searches", 0, "on", ["p1"]), "the level of a search"),
        (set_at("searches", 0, "system", "x"), "the system of a search"),
        (set_at("searches", 0, "known", 0, "name", "x"), "as known; the report has no such integral"),
        (set_at("searches", 0, "generic_parameters", ["x"]), "parameter 'x', which the system does not have"),
        (set_at("searches", 0, "degree", -1), "the degree of a search should be a whole number from 1"),
    ],
)
def test_everything_that_a_search_says_of_itself_is_verified(alter, words, separable, tmp_path):
    path = tmp_path / "report.json"
    path.write_text(json.dumps(altered(separable, alter)))
    with pytest.raises(DamagedFileError, match=words):
        load(path)


def test_what_depends_on_the_time_given_contradicts_nothing(separable, tmp_path):
    """Neither is a theorem: a faster machine may find more, a slower one less, in the same file."""
    path = tmp_path / "report.json"
    told = "no obstruction found"
    reason = {"verdict": told, "theorem": "", "statement": "", "steps": []}
    path.write_text(json.dumps(altered(separable, set_at("obstruction", reason))))
    loaded = load(path, prove_again=True, time_limit=0.01)
    assert loaded.verdict == separable["verdict"]
    here = "open" if loaded.obstruction is None else loaded.obstruction.verdict
    assert told == here or f"the differential Galois group: {told} in the file, open here" in loaded.notes
