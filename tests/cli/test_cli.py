"""The command line as a person meets it, in processes: versions, studies, full disks, Ctrl-C, progress."""

import importlib
import os
import pty
import resource
import signal
import subprocess
import sys
import time

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
    return done.stderr


def test_version_help_and_refusals_need_no_heavy_imports():
    code = (
        "import sys, atexit\n"
        "heavy = ('sympy', 'xarray', 'matplotlib', 'jinja2')\n"
        "atexit.register(lambda: print([name for name in heavy if name in sys.modules], file=sys.stderr))\n" + MAIN
    )
    done = run("--version", code=code)
    assert (done.returncode, done.stdout) == (0, f"liepoisson {liepoisson.__version__}\n")
    assert done.stderr.strip() == "[]"
    assert run("reproduce", "tops", code=code).stderr.strip().endswith("[]")
    as_module = subprocess.run([sys.executable, "-m", "liepoisson", "--help"], check=True, capture_output=True)
    assert b"reproduce" in as_module.stdout


def test_second_run_in_the_same_folder_is_refused(tmp_path):
    with exclusive(tmp_path):
        message = refusal(run(*STUDY, "--quick", "--fresh", "--out", tmp_path))
    assert f"another run is using {tmp_path}: wait for it" in message


def limit_file_size():
    # Without this the process would be killed by the signal instead of seeing the error of a full disk.
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (50_000, 50_000))


def test_disk_that_fills_up_is_an_error_with_advice(tmp_path):
    done = run(*STUDY, "--members", 500, "--end-time", 60, "--out", tmp_path, preexec_fn=limit_file_size)
    message = refusal(done)
    assert "could not write" in message
    assert "000000-000499.npz" in message
    assert "another folder" in message
    assert list((tmp_path / "pieces" / "twisted-unit-vectors").iterdir()) == [], "no half-written file is left"


def hear_control_c():
    # A background job of a shell ignores Ctrl-C, and its children inherit that.
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def test_progress_is_shown_on_a_terminal_and_control_c_says_how_to_go_on(tmp_path):
    master, slave = pty.openpty()
    command = [sys.executable, "-c", SMALL_PIECES + MAIN, *STUDY, "--members", "40000", "--out", str(tmp_path)]
    # Tests start processes from one thread, so code between fork and exec is safe.
    options = {"preexec_fn": hear_control_c, "env": {**os.environ, "TERM": "xterm", "COLUMNS": "140"}}
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=slave, **options)
    os.close(slave)
    folder = tmp_path / "pieces" / "twisted-unit-vectors"
    try:
        until = time.monotonic() + 120
        while not (folder.exists() and list(folder.glob("*.npz"))):
            assert process.poll() is None
            assert time.monotonic() < until
            time.sleep(0.02)
        time.sleep(1.0)
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
        assert process.communicate(timeout=60)[0] == b""
    finally:
        os.close(master)
        process.kill()
    assert process.returncode == 130
    text = shown.decode()
    for words in ("twisted-unit-vectors", "%", "M/s", "Run the same command again"):
        assert words in text
    assert "Traceback" not in text
    assert all(path.suffix == ".npz" for path in folder.iterdir())


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
    with pytest.raises(SystemExit) as stopped:
        main_module.main()
    assert stopped.value.code == 2
    assert "RuntimeError: a mistake of ours; this is a mistake in liepoisson" in capsys.readouterr().err


@pytest.mark.slow
def test_quick_study_prints_a_table_and_is_silent_if_it_shall_be(tmp_path):
    study = (*STUDY, "--quick", "--members", 100, "--quiet", "--out", tmp_path)
    done = run(*study)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("The twisted top: 100 starts per ensemble, to t = 200, seed 0")
    assert "claims of the paper:" in done.stdout
    assert (tmp_path / "report.html").exists()
    # Another seed in the same folder would mix two studies.
    assert "other options: seed 0 instead of 1" in refusal(run(*study, "--seed", 1))
