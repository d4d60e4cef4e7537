"""Answers are written down without what changes from run to run, and a difference of one digit is found."""

import json
import subprocess
import sys
import tempfile
import warnings
from pathlib import Path

import numpy as np
import pytest

from script_folders import modules_of

answer, compare = modules_of(Path(__file__).parents[2] / "verification" / "corpus", "answer", "compare")


def test_addresses_and_temporary_paths_are_masked():
    text = f"<object at {hex(id(answer))}> in {tempfile.mkdtemp()}/a.nc, {answer.ROOT}/tests"
    assert answer.masked(text) == "<object at 0x...> in (temporary path), (repository)/tests"


def test_doubles_that_differ_read_differently_and_arrays_have_other_hashes():
    one, other = np.full(50, 0.1), np.full(50, 0.1)
    other[7] = np.nextafter(0.1, 1)
    assert answer.plain(one[7]) == 0.1 != answer.plain(other[7])
    assert answer.plain(one)["sha256"] != answer.plain(other)["sha256"]
    assert answer.rounded_digest(one) == answer.rounded_digest(other)
    assert answer.rounded_digest([0.0, -1e-3]) == answer.rounded_digest([-0.0, -1e-3])
    assert answer.rounded_digest([1e-3]) != answer.rounded_digest([-1e-3])


def test_an_error_is_an_answer_and_warnings_stand_beside_one():
    def warned():
        warnings.warn("take care", UserWarning, stacklevel=1)
        return {"b": (1, np.float64(2.5)), "a": "two\nlines"}

    assert answer.answer(lambda: {}["x"]) == {"raises": "KeyError", "message": "'x'"}
    found = {"b": [1, 2.5], "a": ["two", "lines"]}
    assert answer.answer(warned) == {"answer": found, "warnings": ["UserWarning: take care"]}


@pytest.mark.parametrize(("new", "status"), [(0.1, 0), (0.1000000001, 1), (None, 1)])
def test_the_exit_status_says_whether_there_is_a_difference(tmp_path, monkeypatch, capsys, new, status):
    for folder, number in (("old", 0.1), ("new", new)):
        (tmp_path / folder).mkdir()
        record = {"lagrange": {"values": {"H": number, "none": float("nan"), "text": ["one", "two"]}}}
        if number is None:
            del record["lagrange"]["values"]["H"]
        (tmp_path / folder / "catalogue.json").write_text(json.dumps(record))
    monkeypatch.setattr(sys, "argv", ["compare", str(tmp_path / "old"), str(tmp_path / "new")])
    assert compare.main() == status
    printed = capsys.readouterr().out
    assert ("== catalogue: lagrange / values / H\n" in printed) == bool(status)
    assert ("-0.1\n" in printed) == bool(status)
    assert (f"+{new}\n" in printed) == (status == 1 and new is not None)


def test_a_question_that_takes_too_long_is_named_and_others_are_answered():
    script = """
import json
from verification.corpus.catalogue import of_system
asked = ["values", "Lax pair"]
print(json.dumps([of_system("free-rigid-body", asked, seconds) for seconds in (0.01, 60)]))
"""
    done = subprocess.run([sys.executable, "-c", script], cwd=answer.ROOT, capture_output=True, text=True, check=True)
    short, long = json.loads(done.stdout)
    assert short.keys() == long.keys() == {"values", "Lax pair"}
    assert all(str(said).startswith("no answer within") for said in short.values())
    assert long["values"]["states"]["0"] == [0.125, -0.75, 0.5]
    assert "free-rigid-body, values: no answer within" in done.stderr
