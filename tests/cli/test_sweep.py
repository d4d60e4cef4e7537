"""The command `liepoisson sweep`."""

import sys

import pytest

from liepoisson.cli.main import main

TWIST = """
name = "twist"
system = "twisted-top"
quantity = "chaotic_fraction"
n = 8
t_end = 200
seed = 1
[parameters]
I = [2, 2, 1]
a = [-1, 0, 0]
b = [0, 0, 0]
[[axes]]
name = "epsilon"
from = 0
to = 1
count = 3
"""


@pytest.fixture
def run(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "twist.toml").write_text(TWIST)

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["liepoisson", "sweep", *arguments])
        with pytest.raises(SystemExit) as stopped:
            main()
        captured = capsys.readouterr()
        return stopped.value.code or 0, captured.out, captured.err

    return run


def test_it_prints_the_result_and_keeps_it(run, tmp_path):
    first, second = (run("twist.toml", "--threads", "1") for _ in range(2))
    code, out, err = first
    assert (code, err) == (0, "")
    assert out.splitlines()[0] == "twist: 3 points, 8 orbits each to t = 200, seed 1"
    assert "outcomes: finished 24" in out
    assert "         1  1.0000  [0.6756, 1.0000]" in out
    assert (tmp_path / "twist.zarr" / "zarr.json").exists()
    assert second == first


def test_another_sweep_in_the_folder_is_refused(run, tmp_path):
    run("twist.toml")
    (tmp_path / "twist.toml").write_text(TWIST.replace("seed = 1", "seed = 2"))
    code, out, err = run("twist.toml")
    assert (code, out) == (2, "")
    assert "liepoisson: twist.zarr holds another sweep: seed 1 instead of 2" in err
    assert run("twist.toml", "--fresh")[0] == 0
    assert run("twist.toml", "--store", "other.zarr")[0] == 0


@pytest.mark.thorough
def test_a_figure(run, tmp_path):
    code, _, err = run("twist.toml", "--figure", "twist.png")
    assert code == 0
    assert (tmp_path / "twist.png").stat().st_size > 5000
    assert "figure twist.png" in err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["bogus.toml"], "there is no file bogus.toml"),
        (["twist.toml", "--threads", "0"], "threads"),
        (["twist.toml", "--threads", "1", "--processes", "1"], "one of scheduler, processes and threads"),
        (["twist.toml", "--figure", "x.gif"], "--figure must end in"),
    ],
)
def test_what_can_not_be_done_is_refused(run, arguments, message):
    code, out, err = run(*arguments)
    assert (code, out) == (2, "")
    assert message in err


def test_a_part_that_fails_is_reported(run, tmp_path):
    (tmp_path / "twist.toml").write_text(TWIST.replace("chaotic_fraction", "liepoisson:bounds"))
    code, _, err = run("twist.toml")
    assert code == 1
    assert "level 0, point 0: failed: TypeError" in err
