"""`liepoisson prove`: the theorem for people and for programs, and what is refused."""

import json
from importlib.resources import files

import pytest


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


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("kovalevskaya",), "no certificate is shipped"),
        (("twisted-kovalevskaya", "--certificate", "none.json"), "no such file"),
        (("twisted-kovalevskaya", "--level", "H=1/2"), "belong to --search"),
        (("twisted-kovalevskaya", "--search", "--certificate", "x.json"), "got both"),
        (("twisted-kovalevskaya", "--search", "--level", "C1=1"), "the value of H"),
        (("twisted-kovalevskaya", "--search", "--level", "H"), "NAME=VALUE"),
    ],
)
def test_what_is_refused(command, arguments, message):
    code, out, err = command("prove", *arguments)
    assert (code, out) == (2, "")
    assert message in err
