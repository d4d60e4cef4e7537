"""The command line as a person meets it: exit codes, plain messages, nothing but results on standard output."""

from __future__ import annotations

import importlib
import os
import pty
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import liepoisson
from liepoisson.io.files import exclusive

main_module = importlib.import_module("liepoisson.cli.main")  # the package's `main` is the function

pytestmark = pytest.mark.thorough  # most of these start a process

MAIN = "from liepoisson.cli import main; main()"
SMALL_PIECES = "import liepoisson.studies.twisted_top.runs as runs; runs.PIECE_SIZE = 50; "
STUDY = ("reproduce", "twisted-top")


def run(*arguments, code=MAIN, **options):
    return subprocess.run(
        [sys.executable, "-c", code, *map(str, arguments)], check=False, capture_output=True, text=True, **options
    )


def refusal(done):
    """The message of a refused call: exit code 2, nothing on standard output, a few lines and no traceback."""
    assert done.returncode == 2, (done.returncode, done.stdout, done.stderr)
    assert done.stdout == ""
    assert "Traceback" not in done.stderr
    assert 1 <= len(done.stderr.strip().splitlines()) <= 6
    return done.stderr


def test_version_is_printed():
    done = run("--version")
    assert (done.returncode, done.stdout) == (0, f"liepoisson {liepoisson.__version__}\n")


@pytest.mark.parametrize("module", ["liepoisson", "liepoisson.cli.main"])
def test_modules_run_as_the_command(module):
    command = [sys.executable, "-m", module, "--version"]
    done = subprocess.run(command, check=False, capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (0, f"liepoisson {liepoisson.__version__}\n", "")


def test_help_lists_commands_and_options():
    assert "reproduce" in run("--help").stdout
    text = run("reproduce", "--help").stdout
    for option in ("--members", "--end-time", "--seed", "--threads", "--out", "--quick", "--fresh"):
        assert option in text


def test_a_refusal_needs_no_heavy_imports():
    code = (
        "import sys, atexit\n"
        "heavy = ('sympy', 'xarray', 'matplotlib', 'jinja2')\n"
        "atexit.register(lambda: print([name for name in heavy if name in sys.modules], file=sys.stderr))\n" + MAIN
    )
    assert run("--version", code=code).stderr.strip() == "[]"
    assert run("reproduce", "tops", code=code).stderr.strip().endswith("[]")


def test_unknown_study_is_refused_with_a_suggestion():
    message = refusal(run("reproduce", "twistedtop"))
    assert "no study 'twistedtop'" in message
    assert "twisted-top" in message


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--members", "1"), "members must be at least 2"),
        (("--members", "-5"), "members"),
        (("--members", "many"), "Invalid value for '--members'"),
        (("--end-time", "0"), "end time must be finite and at least 60"),
        (("--end-time=-100",), "end time"),
        (("--end-time", "nan"), "end time must be finite"),
        (("--members", "9" * 23), "members must be at most 100000000"),
        (("--threads", "9" * 23), "threads: wanted a whole number from 1 to 4096"),
        (("--seed", "-1"), "seed"),
        (("--threads", "0"), "threads: wanted a whole number from 1 to 4096"),
        (("--member", "5"), "--member"),
    ],
)
def test_bad_numbers_are_refused(tmp_path, options, words):
    message = refusal(run(*STUDY, *options, "--out", tmp_path / "out"))
    assert words in message
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("out", ["", " "])
def test_empty_output_folder_is_refused(tmp_path, out):
    message = refusal(run(*STUDY, "--quick", "--fresh", "--out", out, cwd=tmp_path))
    assert "--out must name a folder" in message
    assert "results/twisted-top-quick" in message
    assert list(tmp_path.iterdir()) == []


def test_second_run_in_the_same_folder_is_refused(tmp_path):
    with exclusive(tmp_path):
        message = refusal(run(*STUDY, "--quick", "--fresh", "--out", tmp_path))
    assert f"another run is using {tmp_path}" in message
    assert "wait for it" in message


def test_output_below_a_file_is_refused(tmp_path):
    (tmp_path / "file").write_text("")
    for out in (tmp_path / "file", tmp_path / "file" / "out"):
        message = refusal(run(*STUDY, "--quick", "--out", out))
        assert str(out) in message
        assert "choose another folder" in message


def test_output_folder_inside_a_device_without_room_is_refused():
    message = refusal(run(*STUDY, "--quick", "--out", "/proc/liepoisson"))
    assert "/proc/liepoisson" in message


def limit_file_size(size):
    def apply():
        # Without this the process would be killed by the signal instead of seeing the error of a full disk.
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))

    return apply


def test_disk_that_fills_up_at_the_first_piece_is_an_error_with_advice(tmp_path):
    done = run(*STUDY, "--members", 500, "--end-time", 60, "--out", tmp_path, preexec_fn=limit_file_size(50_000))
    message = refusal(done)
    assert "could not write" in message
    assert "000000-000499.nc" in message
    assert "another folder" in message
    assert list((tmp_path / "pieces" / "twisted-unit-vectors").iterdir()) == [], "no half-written file is left"


def test_disk_that_fills_up_later_keeps_what_is_finished(tmp_path):
    arguments = (*STUDY, "--members", 500, "--end-time", 60, "--out", tmp_path)
    message = refusal(run(*arguments, code=SMALL_PIECES + MAIN, preexec_fn=limit_file_size(200_000)))
    assert "twisted-unit-vectors.nc" in message
    pieces = sorted((tmp_path / "pieces" / "twisted-unit-vectors").iterdir())
    assert len(pieces) == 10
    assert [path.name for path in (tmp_path / "data").iterdir()] == ["manifest.json"]


def wait_for_piece(process, folder: Path):
    until = time.monotonic() + 120
    while not (folder.exists() and list(folder.glob("*.nc"))):
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < until
        time.sleep(0.02)


def hear_control_c():
    # A background job of a shell ignores Ctrl-C, and its children inherit that.
    signal.signal(signal.SIGINT, signal.SIG_DFL)


@pytest.fixture
def start():
    """Starts a study in a process of its own, which does not outlive the test."""
    processes = []

    def popen(*arguments, code=MAIN, **options):
        command = [sys.executable, "-c", code, *STUDY, *map(str, arguments)]
        # Tests start processes from one thread, so code between fork and exec is safe.
        options |= {"preexec_fn": hear_control_c, "stdout": subprocess.PIPE}
        processes.append(subprocess.Popen(command, **options))
        return processes[-1]

    yield popen
    for process in processes:
        if process.poll() is None:
            process.kill()
            process.communicate()


@pytest.mark.thorough
def test_control_c_stops_cleanly_and_says_how_to_go_on(start, tmp_path):
    process = start("--out", tmp_path, code=SMALL_PIECES + MAIN, stderr=subprocess.PIPE, text=True)
    folder = tmp_path / "pieces" / "twisted-unit-vectors"
    wait_for_piece(process, folder)
    process.send_signal(signal.SIGINT)
    started = time.monotonic()
    out, err = process.communicate(timeout=60)
    assert time.monotonic() - started < 20
    assert process.returncode == 130
    assert out == ""
    assert "Traceback" not in err
    assert "Run the same command again" in err
    names = [path.name for path in folder.iterdir()]
    assert names
    assert all(name.endswith(".nc") for name in names)


def test_control_c_in_the_first_second_is_one_line():
    begun = "from liepoisson.cli import main; print('begun', flush=True); main()"
    command = [sys.executable, "-c", begun, "section", "twisted-kovalevskaya", "--crossings", "1000000"]
    options = {"preexec_fn": hear_control_c, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    for delay in (0.0, 0.1, 0.2, 0.3, 0.5, 0.8):
        process = subprocess.Popen(command, **options)
        assert process.stdout.readline() == "begun\n"
        time.sleep(delay + 0.01)
        process.send_signal(signal.SIGINT)
        err = process.communicate(timeout=60)[1]
        assert process.returncode == 130, err
        assert len(err.splitlines()) == 1
        assert err.startswith("interrupted")


def test_control_c_while_a_class_is_made_is_one_line(monkeypatch, capsys):
    # __set_name__ of a descriptor, where Python 3.11 turns any exception into a RuntimeError
    class Interrupted:
        def __set_name__(self, owner, name):
            raise KeyboardInterrupt

    monkeypatch.setattr(main_module, "application", lambda _: type("Made", (), {"at": Interrupted()}))
    with pytest.raises(SystemExit) as stopped:
        main_module.main()
    assert stopped.value.code == 130
    assert capsys.readouterr().err == "interrupted.\n"


def test_errors_that_are_no_interruption_are_not_hidden(monkeypatch, capsys):
    def application(_):
        raise RuntimeError("a mistake of ours") from ValueError("its cause")

    monkeypatch.setattr(main_module, "application", application)
    for shown in (False, True):
        if shown:
            monkeypatch.setenv("LIEPOISSON_TRACEBACK", "1")
        with pytest.raises(SystemExit) as stopped:
            main_module.main()
        assert stopped.value.code == 2
        err = capsys.readouterr().err
        assert "RuntimeError: a mistake of ours; this is a mistake in liepoisson" in err
        assert ("ValueError: its cause" in err and "in application" in err) == shown


def test_manifest_of_another_form_is_refused_with_true_advice(tmp_path):
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "manifest.json").write_text("[1]")
    message = refusal(run(*STUDY, "--quick", "--out", tmp_path))
    assert f"{tmp_path / 'data' / 'manifest.json'} is damaged" in message
    assert "every finished run is computed anew" in message


@pytest.mark.slow
def test_quick_study_prints_a_table_and_is_silent_if_it_shall_be(tmp_path):
    done = run(*STUDY, "--quick", "--members", 100, "--quiet", "--out", tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    assert done.stdout.startswith("The twisted top: 100 starts per ensemble, to t = 200, seed 0")
    assert "as printed" in done.stdout
    assert "claims of the paper:" in done.stdout
    assert (tmp_path / "report.html").exists()
    # Another seed in the same folder would mix two studies.
    assert "other options: seed 0 instead of 1" in refusal(
        run(*STUDY, "--quick", "--members", 100, "--seed", 1, "--out", tmp_path)
    )


@pytest.mark.thorough
def test_progress_is_shown_on_a_terminal(start, tmp_path):
    master, slave = pty.openpty()
    environment = {**os.environ, "TERM": "xterm", "COLUMNS": "140"}
    process = start("--members", 40_000, "--out", tmp_path, stderr=slave, env=environment)
    os.close(slave)
    wait_for_piece(process, tmp_path / "pieces" / "twisted-unit-vectors")
    time.sleep(1.5)
    process.send_signal(signal.SIGINT)
    shown = b""
    while True:
        try:
            block = os.read(master, 65536)
        except OSError:  # how Linux reports that the other side is closed
            break
        if not block:
            break
        shown += block
    os.close(master)
    assert process.communicate()[0] == b""
    assert process.returncode == 130
    text = shown.decode()
    assert "twisted-unit-vectors" in text
    assert "%" in text
    assert "M/s" in text
