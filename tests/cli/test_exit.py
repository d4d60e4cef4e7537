"""How the command ends: one sentence and an exit code, never a traceback, whatever becomes of its output."""

import importlib
import os
import random
import signal
import subprocess
import sys
import time
import warnings
from pathlib import Path

import pytest
from hostile_commands import ComplaintError, Source, run
from hostile_commands import command as hostile_command
from hypothesis import given, settings
from hypothesis import strategies as st

import liepoisson
from liepoisson.cli import exit as exit_
from liepoisson.errors import OutputError, ParameterError

MAIN = "from liepoisson.cli.main import main; main()"
ORBIT = ("--t-end", "1", "--points", "5")


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def finished(*arguments, code=MAIN, **options):
    """A command in a process of its own, which hears Ctrl-C."""
    options = {"stderr": subprocess.PIPE, "timeout": 120} | options
    hears = {"preexec_fn": lambda: signal.signal(signal.SIGINT, signal.default_int_handler)}
    return subprocess.run([sys.executable, "-c", code, *arguments], check=False, **hears, **options)


def fails(error):
    def fail():
        raise error

    return fail


@pytest.mark.parametrize(
    ("error", "code", "said"),
    [
        (ParameterError("wanted a number."), 2, "liepoisson: wanted a number.\n"),
        (OutputError("no space."), 2, "liepoisson: no space.\n"),
        (MemoryError("Unable to allocate 20.0 GiB"), 2, "liepoisson: not enough memory (Unable to allocate 20.0 GiB)."),
        (MemoryError(), 2, "liepoisson: not enough memory. Ask for less"),
        (RecursionError("maximum"), 2, "nested too deeply. Simplify it."),
        (OSError(28, "No space left on device"), 2, "the output could not be written: No space left on device.\n"),
        (FileNotFoundError(2, "No such file", "x" * 5000), 2, "No such file.\n"),
        (ValueError("a\nb  c"), 2, "liepoisson: ValueError: a b c; this is a mistake in liepoisson: please report it"),
        (KeyboardInterrupt(), 130, "interrupted.\n"),
        (BrokenPipeError(), 141, ""),
        (SystemExit(1), 1, ""),
        (SystemExit(None), 0, ""),
        (SystemExit("why"), 1, "why\n"),
        (ParameterError("\x1b[31m" + "n" * 200_000), 2, r"\x1b[31mnnn"),
    ],
    ids=lambda value: type(value).__name__ if isinstance(value, BaseException) else "",
)
def test_every_end_is_a_sentence_and_a_code(error, code, said, capsys):
    before = signal.getsignal(signal.SIGINT), sys.unraisablehook
    with pytest.raises(SystemExit) as left:
        exit_.end(fails(error))
    printed = capsys.readouterr()
    assert (left.value.code, printed.out) == (code, "")
    assert said in printed.err
    assert bool(printed.err) == bool(said)
    assert not [word for word in ("Traceback", "\x1b") if word in printed.err]
    assert printed.err.count("\n") <= 1
    assert len(printed.err) < 5000
    assert (signal.getsignal(signal.SIGINT), sys.unraisablehook) == before


def test_a_traceback_is_printed_for_those_who_ask_for_it(capsys, monkeypatch):
    monkeypatch.setenv(exit_.TRACEBACK, "1")
    with pytest.raises(SystemExit) as left:
        exit_.end(fails(ValueError("inside")))
    assert left.value.code == 2
    assert "Traceback (most recent call last)" in capsys.readouterr().err


INTERRUPTED = {
    ("orbit",): "numeric.integrate.integrate",
    ("section",): "poincare.section.section",
    ("lyapunov",): "indicators.finite_time_exponents.finite_time_exponents",
    ("lyapunov", "--spectrum"): "indicators.spectrum.lyapunov_spectrum",
    ("decide",): "indicators.verdict.decide",
}


@pytest.mark.parametrize("name", INTERRUPTED, ids=" ".join)
def test_after_ctrl_c_it_says_how_to_keep_what_is_done(command, monkeypatch, name):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    importlib.import_module("liepoisson.numeric.time_scale")  # which integrates, before the run that is replaced
    monkeypatch.setattr(f"liepoisson.{INTERRUPTED[name]}", interrupted)
    code, _, err = command(name[0], "kovalevskaya", *name[1:])
    assert (code, "--time-limit SECONDS" in err) == (130, True)
    monkeypatch.setattr("typer.main.get_command", interrupted)
    assert command(name[0], "kovalevskaya") == (130, "", "interrupted.\n")


@pytest.mark.thorough
def test_outputs_that_are_closed_or_full_end_quietly_or_with_a_sentence(here):
    orbit = f"{sys.executable} -c '{MAIN}' orbit kovalevskaya {' '.join(ORBIT)} --out a.nc"
    closed = subprocess.run(["sh", "-c", f"{orbit} >&-"], stderr=subprocess.PIPE, timeout=120, check=False)
    said = b"liepoisson: the output could not be written: standard output is closed.\n"
    assert (closed.returncode, closed.stderr) == (2, said)
    assert [path.name for path in here.iterdir()] == ["a.nc"], "files are written though the output is closed"
    assert subprocess.run(["sh", "-c", f"{orbit} >&- 2>&-"], timeout=120, check=False).returncode == 2
    with open("/dev/full", "wb") as full:
        result = finished("catalog", stdout=full)
    assert result.returncode == 2
    assert result.stderr == b"liepoisson: the output could not be written: No space left on device.\n"


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("arguments", "files"),
    [
        (("section", "twisted-kovalevskaya", "--starts", "2", "--out", "a.nc", "--figure", "a.png"), {"a.nc", "a.png"}),
        (("lyapunov", "twisted-kovalevskaya", "--starts", "2", "--t-end", "9", "--out", "a.nc"), {"a.nc"}),
    ],
)
def test_files_are_written_though_nobody_reads_the_result(here, monkeypatch, arguments, files):
    """The reader has gone before the first line; the backend of the environment is none."""
    monkeypatch.setenv("MPLBACKEND", "junk")
    process = subprocess.Popen([sys.executable, "-c", MAIN, *arguments], stdout=subprocess.PIPE)
    process.stdout.close()
    assert process.wait(120) == exit_.BROKEN_PIPE
    assert {path.name for path in here.iterdir()} == files


SYSTEM = '[bracket]\nalgebra = "so(3)"\nextension = "semidirect(2)"\nvariables = ["a__b", "c"]\n[hamiltonian]\n'
SYSTEM += 'expression = "dot(a__b, a__b)/2 + c[1]"\n'


@pytest.mark.thorough
@pytest.mark.parametrize("name", [r"x $\nosuch{y}$ ^_%\frac{", "a$b", "e\u0301 \U0001f600"])
def test_names_of_systems_fields_and_files_are_plain_text(here, command, name):
    escaped = name.replace("\\", "\\\\")
    (here / "b\udcff.toml").write_text(f'name = "{escaped}"\n{SYSTEM}', encoding="utf-8")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of letters that no font has
        code, out, err = command("orbit", "b\udcff.toml", *ORBIT, "--figure", "f.png", "--out", "o\udcff.csv")
        assert (code, err) == (0, "")
        assert r"wrote    o\udcff.csv" in out
        section = ("section", "b\udcff.toml", "--starts", "2", "--crossings", "3", "--figure", "g.png")
        assert command(*section)[0] == 0
    assert {path.name for path in here.iterdir()} == {"b\udcff.toml", "o\udcff.csv", "f.png", "g.png"}


def test_a_sweep_file_runs_no_code_unless_it_is_allowed(here, command, monkeypatch):
    function = "def f(system, starts, **_):\n    return 0 * starts[:, 0]\n"
    (here / "evil.py").write_text(f"open('was-here', 'w').close()\n\n{function}")
    text = 'system = "twisted-kovalevskaya"\nn_starts = 1\nt_end = 1\nquantity = "evil:f"\n'
    (here / "s.toml").write_text(text + '[[axes]]\nname = "epsilon"\nvalues = [1]\n')
    monkeypatch.syspath_prepend(here)
    code, _, err = command("sweep", "s.toml")
    assert code == 2
    assert "line 4: quantity: 'evil:f' is code, and a sweep file is data" in err
    assert "--allow-code" in err
    assert not (here / "was-here").exists()
    assert command("sweep", "s.toml", "--allow-code", "--threads", "1")[0] == 0
    assert (here / "was-here").exists()
    sys.modules.pop("evil", None)


class Drawn:
    """Choices that Hypothesis makes, and can make smaller."""

    def __init__(self, data):
        self._data = data

    def pick(self, items):
        return items[self.whole(0, len(items) - 1)]

    def whole(self, least, most):
        return self._data.draw(st.integers(least, most))


@settings(max_examples=15)
@given(data=st.data())
def test_no_hostile_command_ends_with_a_traceback(data, tmp_path_factory):
    arguments, files = hostile_command(Drawn(data))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        run(arguments, files, tmp_path_factory.mktemp("hostile"), seconds=60)


@pytest.mark.slow
def test_no_hostile_command_of_a_thousand_ends_with_a_traceback(tmp_path_factory):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for seed in range(1000):
            run(*hostile_command(Source(random.Random(seed))), tmp_path_factory.mktemp("hostile"), seconds=60)


def test_the_harness_complains_of_an_unexpected_error(tmp_path, monkeypatch):
    monkeypatch.setattr("liepoisson.catalog.names", fails(ValueError("inside")))
    with pytest.raises(ComplaintError, match="an unexpected error"):
        run(["catalog"], {}, tmp_path, seconds=60)


def test_an_interruption_that_an_import_drops_is_repeated(tmp_path):
    """A destructor that runs while a module is imported drops the exception; the command ends all the same."""
    (tmp_path / "dropping.py").write_text(
        "import os, signal\n"
        "class Dropping:\n"
        "    def __del__(self):\n"
        "        os.kill(os.getpid(), signal.SIGINT)\n"
        "        for _ in range(10**6): pass\n"
        "Dropping()\n"
    )
    code = (
        "import sys, time\n"
        "from liepoisson.cli.exit import end\n"
        "def command():\n"
        f"    sys.path.insert(0, {str(tmp_path)!r})\n"
        "    import dropping\n"
        "    print('went on', flush=True)\n"
        "    time.sleep(30)\n"
        "end(command)\n"
    )
    began = time.monotonic()
    done = finished(code=code, stdout=subprocess.PIPE, text=True)
    assert time.monotonic() - began < 25  # it does not wait for what was going on
    assert (done.stdout, done.returncode, done.stderr) == ("went on\n", 130, "interrupted.\n")


@pytest.mark.parametrize("module", ["liepoisson.inputs.calls", "liepoisson.cli.exit", "liepoisson.errors"])
def test_an_interruption_while_the_command_is_imported_ends_with_a_word(module):
    """Before the handler of `ending` is there: the module that Ctrl-C meets is the first one that is imported late."""
    code = (
        "import sys, os, signal\n"
        "class Finder:\n"
        "    def find_spec(self, name, path, target=None):\n"
        f"        if name == {module!r}:\n"
        "            os.kill(os.getpid(), signal.SIGINT)\n"
        "sys.meta_path.insert(0, Finder())\n"
        "from liepoisson.cli import main\n"
        "main()\n"
    )
    done = finished("catalog", code=code, stdout=subprocess.PIPE, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "interrupted.\n")


def test_before_the_command_is_imported_next_to_nothing_is():
    """What is imported until then is where Ctrl-C ends in a traceback."""
    code = "import sys; before = set(sys.modules); import liepoisson.cli; print(*sorted({*sys.modules} - before))"
    package = str(Path(liepoisson.__file__).parents[1])  # without its site, Python does not know where that is
    environment = os.environ | {"PYTHONPATH": package}
    done = subprocess.run([sys.executable, "-S", "-c", code], capture_output=True, check=True, env=environment)
    assert set(done.stdout.decode().split()) <= {"__future__", "liepoisson", "liepoisson._lazy", "liepoisson.cli"}
