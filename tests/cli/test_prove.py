"""`liepoisson prove`: the theorem for people and for programs, and what is refused."""

import json
from importlib.resources import files

import pytest


@pytest.mark.slow  # what it prints is in docs/proof.md, and compared there
def test_the_theorem_is_printed(command):
    code, out, err = command("prove", "twisted-kovalevskaya", "--quiet")
    assert (code, err) == (0, "")
    assert "intervals" in out
    assert "Arb balls" in out
    assert "conjugate to the full shift on two symbols" in " ".join(out.split())
    assert "Not proved" in out


def test_an_altered_certificate_is_refused(command, tmp_path):
    data = json.loads(files("liepoisson.proofs").joinpath("twisted_kovalevskaya.json").read_text(encoding="utf-8"))
    data["edges"][1]["symmetry"] = False
    path = tmp_path / "proof.json"
    path.write_text(json.dumps(data))
    code, out, err = command("prove", "twisted-kovalevskaya", "--certificate", str(path))
    assert (code, out) == (2, "")
    assert "refused" in err


SEARCHES = {
    "second level": ("twisted-kovalevskaya", "H=4,C1=10,C2=-2,C3=1", "1000000000"),
    "heavy top": ("heavy-top --set I=1,1,2 --set a=1,0,0", "H=1,C1=1/2,C2=1", "100000000"),
    "three moments of inertia": (
        "twisted-top --set I=3,2,1 --set a=-1,0,0 --set b=0,0,0 --set epsilon=1",
        "H=1/2,C1=1,C2=1/2,C3=1",
        "100000000",
    ),
    "henon-heiles": ("henon-heiles", "H=4/25", "100000000"),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", SEARCHES)
def test_a_search_ends_with_a_theorem(command, tmp_path, name):
    """From the name of a system and a level to the theorem, and again from the file that was written."""
    system, level, ball = SEARCHES[name]
    path = tmp_path / "proof.json"
    arguments = ["prove", *system.split()]
    code, out, err = command(*arguments, "--search", "--level", level, "--out", str(path), "--quiet")
    assert (code, err) == (0, "")
    text = " ".join(out.split())
    assert f"Let E be the level {level.replace('=', ' = ').replace(',', ', ')}, and R" in text
    assert f"at most 3/{ball}." in text
    assert "there is no further analytic constant of motion" in text
    code, out, err = command(*arguments, "--certificate", str(path), "--quiet", "--format", "json")
    assert (code, err) == (0, "")
    proof = json.loads(out)
    assert [one["arithmetic"] for one in proof["accepted_by"]] == ["intervals", "Arb balls"]
    assert proof["excludes_further_analytic_integrals"] is True
    assert f"{proof['entropy_above']:.10f}"[:6] in text


@pytest.mark.slow
def test_the_search_fails_for_an_integrable_top(command):
    code, out, err = command("prove", "kovalevskaya", "--search", "--level", "H=1,C1=1/2,C2=1", "--quiet")
    assert (code, out) == (2, "")
    assert "no chain of sets was found on H = 1, C1 = 1/2, C2 = 1" in err
