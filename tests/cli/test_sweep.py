"""The command `liepoisson sweep`."""

import re
import signal
import subprocess
import sys
import time

import psutil
import pytest

from liepoisson.cli.main import main

TWIST = """
name = "twist"
system = "twisted-top"
quantity = "chaotic_fraction"
n_starts = 8
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


def test_it_prints_and_draws_the_result_and_keeps_it(run, tmp_path):
    first, second = (run("twist.toml", "--threads", "1", "--figure", "twist.png") for _ in range(2))
    code, out, err = first
    assert (code, err) == (0, "figure twist.png\n")
    assert (tmp_path / "twist.png").stat().st_size > 5000
    assert out.splitlines()[0] == "twist: 3 points, 8 orbits each to t = 200, seed 1"
    assert "outcomes: finished 24" in out
    assert "         1  1.0000  [0.6756, 1.0000]" in out
    assert (tmp_path / "twist.zarr" / "zarr.json").exists()
    line = "3 of 3 points were in the store\n"
    assert line in second[1]
    assert second[1].replace(line, "") == out
    (tmp_path / "twist.toml").write_text(TWIST.replace("seed = 1", "seed = 2"))
    code, out, err = run("twist.toml")
    assert (code, out) == (2, "")
    assert "liepoisson: twist.zarr holds another sweep: seed 1 instead of 2" in err
    assert run("twist.toml", "--store", "other.zarr", "--points-per-piece", "2")[0] == 0
    assert {path.name for path in (tmp_path / "other.zarr" / "level0" / "value").glob("*.0")} == {"0.0", "1.0"}


def test_a_long_table_leaves_rows_out_before_the_last_ones_and_a_part_that_fails_is_reported(run, tmp_path):
    long = TWIST.replace("count = 3", "count = 30").replace("t_end = 200", "t_end = 10")
    long = long.replace("I = [2, 2, 1]", 'I = [2, "2 + epsilon", 1]')
    (tmp_path / "twist.toml").write_text(long.replace("n_starts = 8", "n_starts = 2"))
    code, out, _ = run("twist.toml", "--threads", "1")
    assert code == 0
    assert "varied: I2 = 2 + epsilon\n" in out
    rows = out.splitlines()[-25:]
    assert [row.split()[0] for row in rows[:2]] == ["0", "0.0344828"]
    assert rows[21] == "... 6 more, all in twist.zarr ..."
    assert [row.split()[0] for row in rows[22:]] == ["0.931034", "0.965517", "1"]
    (tmp_path / "twist.toml").write_text(TWIST.replace("chaotic_fraction", "liepoisson.phase_space:bounds"))
    code, _, err = run("twist.toml", "--allow-code", "--fresh")
    assert code == 1
    assert "level 0, point 0: failed: ParameterError" in err


@pytest.mark.thorough
def test_an_interrupt_ends_a_long_piece(tmp_path):
    """The bound: 0.5 s until the main thread sees it, 0.1 s in the core, and the time that Python needs to end."""
    text = TWIST.replace("t_end = 200", "t_end = 1e9").replace("count = 3", "count = 2")
    (tmp_path / "twist.toml").write_text(text)
    # A shell that starts the tests in the background has Ctrl-C ignored, and its children inherit that.
    program = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler); "
    program += "from liepoisson.cli.main import main; main()"
    command = [sys.executable, "-c", program, "sweep", "twist.toml", "--threads", "2"]
    process = subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True)
    while process.poll() is None and not (tmp_path / "twist.zarr" / "level0" / "seconds" / "zarr.json").exists():
        time.sleep(0.1)
    time.sleep(1.0)
    began = time.monotonic()
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert time.monotonic() - began < 5.0
    assert process.returncode == 130
    assert re.fullmatch(r"interrupted; what is finished is in twist.zarr.*\n", err)


def test_points_without_a_system_are_told_by_the_exit_code(run, tmp_path):
    """I3 <= 0: somewhere is a part of the answer, everywhere is a mistake."""
    for axis, wanted in (("[-1.0, 1.0]", 0), ("[-2.0, -1.0]", 1)):
        text = TWIST.replace("from = 0\nto = 1\ncount = 3", f"values = {axis}").replace(
            'name = "epsilon"', 'name = "I3"'
        )
        (tmp_path / "twist.toml").write_text(text.replace("[parameters]", "[parameters]\nepsilon = 1"))
        code, out, err = run("twist.toml", "--fresh")
        assert (code, "no system" in out) == (wanted, True)
        assert "no system at" in err


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["SIGTERM", "SIGKILL"])
def test_processes_end_with_the_command_that_started_them(tmp_path, name):
    """They hold its output, so that whoever reads that sees its end only when they are gone."""
    text = TWIST.replace("t_end = 200", "t_end = 1e9").replace("count = 3", "count = 2")
    (tmp_path / "twist.toml").write_text(text)
    program = "from liepoisson.cli.main import main; main()"
    command = [sys.executable, "-c", program, "sweep", "twist.toml", "--processes", "2"]
    process = subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True)
    started = set()
    while process.poll() is None and len(started) < 5:  # a scheduler, and a nanny with its worker for each process
        time.sleep(0.2)
        started = {child.pid for child in psutil.Process(process.pid).children(recursive=True)}
    time.sleep(1.0)
    started |= {child.pid for child in psutil.Process(process.pid).children(recursive=True)}
    process.send_signal(getattr(signal, name))
    _, err = process.communicate(timeout=60)
    assert process.returncode == {"SIGTERM": 143, "SIGKILL": -9}[name]
    if name == "SIGTERM":
        assert "ended; what is finished is in twist.zarr." in err
    end = time.monotonic() + 15
    while (alive := [pid for pid in started if is_running(pid)]) and time.monotonic() < end:
        time.sleep(0.2)
    assert not alive


def is_running(pid):
    try:
        return psutil.Process(pid).status() != psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return False
