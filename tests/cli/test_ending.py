"""How the command ends: one sentence and an exit code, never a traceback, whatever becomes of its output."""

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
from liepoisson.cli import ending
from liepoisson.errors import OutputError, ParameterError

SYSTEM = """
[bracket]
algebra = "so(3)"
extension = "semidirect(2)"
variables = ["a__b", "c"]
[hamiltonian]
expression = "dot(a__b, a__b)/2 + c[1]"
"""
ORBIT = ("--t-end", "1", "--points", "5")


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def finished(*arguments, **streams):
    """A command in a process of its own, with the given standard streams."""
    call = [sys.executable, "-c", "from liepoisson.cli.main import main; main()", *arguments]
    return subprocess.run(call, timeout=120, check=False, **{"stderr": subprocess.PIPE, **streams})


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
    ],
    ids=lambda value: type(value).__name__ if isinstance(value, BaseException) else "",
)
def test_every_end_is_a_sentence_and_a_code(error, code, said, capsys):
    def fail():
        raise error

    with pytest.raises(SystemExit) as left:
        ending.end(fail)
    printed = capsys.readouterr()
    assert (left.value.code, printed.out) == (code, "")
    assert said in printed.err
    assert bool(printed.err) == bool(said)
    assert "Traceback" not in printed.err
    assert printed.err.count("\n") <= 1


def test_a_message_is_neither_endless_nor_a_command_to_the_terminal(capsys):
    def fail():
        raise ParameterError("\x1b[31m" + "n" * 200_000)

    with pytest.raises(SystemExit):
        ending.end(fail)
    err = capsys.readouterr().err
    assert len(err) < 5000
    assert "\x1b" not in err
    assert r"\x1b[31mnnn" in err


def test_a_traceback_is_printed_for_those_who_ask_for_it(capsys, monkeypatch):
    def fail():
        raise ValueError("inside")

    monkeypatch.setenv(ending.TRACEBACK, "1")
    with pytest.raises(SystemExit) as left:
        ending.end(fail)
    assert left.value.code == 2
    assert "Traceback (most recent call last)" in capsys.readouterr().err


@pytest.mark.thorough
def test_outputs_that_are_closed_or_full_end_quietly_or_with_a_sentence():
    for arguments in (["catalog"], ["inspect", "kovalevskaya"]):
        shell = f"{sys.executable} -c 'from liepoisson.cli.main import main; main()' {' '.join(arguments)}"
        closed = subprocess.run(["sh", "-c", f"{shell} >&-"], stderr=subprocess.PIPE, timeout=120, check=False)
        said = b"liepoisson: the output could not be written: standard output is closed.\n"
        assert (closed.returncode, closed.stderr) == (2, said)
        both = subprocess.run(["sh", "-c", f"{shell} >&- 2>&-"], timeout=120, check=False)
        assert both.returncode == 2
    with open("/dev/full", "wb") as full:
        result = finished("catalog", stdout=full)
    assert result.returncode == 2
    assert result.stderr == b"liepoisson: the output could not be written: No space left on device.\n"
    reader, writer = os.pipe()
    os.close(reader)
    result = finished("catalog", stdout=writer)
    os.close(writer)
    assert (result.returncode, result.stderr) == (141, b"")


@pytest.mark.thorough
@pytest.mark.parametrize("name", [r"x $\nosuch{y}$ ^_%\frac{", "$$", "a$b", "n" * 200, "e\u0301 \U0001f600"])
def test_names_of_systems_and_fields_are_plain_text_in_figures(here, command, name):
    escaped = name.replace("\\", "\\\\")
    (here / "s.toml").write_text(f'name = "{escaped}"\n{SYSTEM}', encoding="utf-8")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of letters that no font has
        assert command("orbit", "s.toml", *ORBIT, "--figure", "f.png")[0] == 0
        section = ("section", "s.toml", "--starts", "2", "--crossings", "3", "--figure", "g.png")
        assert command(*section)[0] == 0
    assert (here / "f.png").stat().st_size > 1000


@pytest.mark.thorough
def test_a_file_name_that_is_no_text(here, command):
    (here / "b\udcff.toml").write_text(SYSTEM)
    code, out, err = command("orbit", "b\udcff.toml", *ORBIT, "--out", "o\udcff.csv", "--plot")
    assert (code, err) == (0, "")
    assert {"o\udcff.csv", "b-orbit.png"} <= {path.name for path in here.iterdir()}
    assert r"wrote    o\udcff.csv" in out


def test_names_that_are_too_long_are_refused(here, command):
    (here / "s.toml").write_text(SYSTEM)
    (here / "long.toml").write_text(f'name = "{"n" * 200_000}"\n{SYSTEM}')
    code, _, err = command("orbit", "s.toml", *ORBIT, "--out", "x" * 300 + ".nc")
    assert (code, err.count("\n")) == (2, 1)
    assert "File name too long. Choose a shorter name" in err
    code, _, err = command("orbit", "long.toml", *ORBIT, "--plot")
    assert code == 2
    assert "name: wanted at most 200 characters; got 200000" in err


def test_times_and_sizes_that_nobody_can_have_are_refused(here, command):
    code, _, err = command("lyapunov", "twisted-kovalevskaya", "--t-end", "5e-324", "--starts", "2")
    assert code == 2
    assert "t_end: wanted a time of at least 1e-300" in err
    axis = '[[axes]]\nname = "{}"\nfrom = 0\nto = 1\ncount = {}\n'
    head = 'system = "twisted-kovalevskaya"\nt_end = 5\n'
    for n, counts, said in (
        (64, (16384, 16384), "wanted at most 16777216 points; got 16384 x 16384"),
        (2**31, (10,), "results of at most 16 GiB; 10 points with n_starts = 2147483648 take 180 GiB"),
    ):
        axes = "".join(axis.format(name, count) for name, count in zip(("epsilon", "a1"), counts, strict=False))
        (here / "big.toml").write_text(f"n_starts = {n}\n{head}{axes}")
        code, _, err = command("sweep", "big.toml")
        assert code == 2
        assert said in err


def test_a_sweep_file_runs_no_code_unless_it_is_allowed(here, command):
    function = "def f(system, starts, **_):\n    return 0 * starts[:, 0]\n"
    (here / "evil.py").write_text(f"open('was-here', 'w').close()\n\n{function}")
    text = 'system = "twisted-kovalevskaya"\nn_starts = 1\nt_end = 1\nquantity = "evil:f"\n'
    (here / "s.toml").write_text(text + '[[axes]]\nname = "epsilon"\nvalues = [1]\n')
    sys.path.insert(0, str(here))
    try:
        code, _, err = command("sweep", "s.toml")
        assert code == 2
        assert "line 4: quantity: 'evil:f' is code, and a sweep file is data" in err
        assert "--allow-code" in err
        assert not (here / "was-here").exists()
        assert command("sweep", "s.toml", "--allow-code", "--threads", "1")[0] == 0
        assert (here / "was-here").exists()
    finally:
        sys.path.remove(str(here))
        sys.modules.pop("evil", None)


def test_a_report_on_a_high_power_of_a_sum_is_short(here, command):
    text = '[bracket]\nalgebra = "so(3)"\n[hamiltonian]\nexpression = "(l1 + l2 + l3)^64"\n'
    (here / "power.toml").write_text(text)
    code, out, _ = command("inspect", "power.toml")
    assert code == 0
    assert "Equations        not computed: 2145 terms in H (limit 400)" in out


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
    def broken(*_, **__):
        raise ValueError("inside")

    monkeypatch.setattr("liepoisson.catalog.names", broken)
    with pytest.raises(ComplaintError, match="an unexpected error"):
        run(["catalog"], {}, tmp_path, seconds=60)


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("arguments", "files"),
    [
        (("orbit", "twisted-kovalevskaya", *ORBIT, "--out", "a.nc", "--figure", "a.png"), {"a.nc", "a.png"}),
        (("section", "twisted-kovalevskaya", "--starts", "2", "--out", "a.nc", "--figure", "a.png"), {"a.nc", "a.png"}),
        (("lyapunov", "twisted-kovalevskaya", "--starts", "2", "--t-end", "9", "--out", "a.nc"), {"a.nc"}),
    ],
)
def test_files_are_written_though_nobody_reads_the_result(here, arguments, files):
    """The reader has gone before the first line."""
    call = [sys.executable, "-c", "from liepoisson.cli.main import main; main()", *arguments]
    process = subprocess.Popen(call, stdout=subprocess.PIPE)
    process.stdout.close()
    assert process.wait(120) == ending.BROKEN_PIPE
    assert {path.name for path in here.iterdir()} == files


def test_files_are_written_though_the_output_is_closed(here):
    shell = f"{sys.executable} -c 'from liepoisson.cli.main import main; main()' orbit kovalevskaya {' '.join(ORBIT)}"
    done = subprocess.run(["sh", "-c", f"{shell} --out a.nc >&-"], stderr=subprocess.PIPE, timeout=120, check=False)
    assert done.returncode == 2
    assert b"standard output is closed" in done.stderr
    assert [path.name for path in here.iterdir()] == ["a.nc"]


@pytest.mark.thorough
def test_figures_do_not_need_the_backend_of_the_environment(here, monkeypatch):
    monkeypatch.setenv("MPLBACKEND", "junk")
    done = finished("orbit", "twisted-kovalevskaya", *ORBIT, "--figure", "a.png", stdout=subprocess.PIPE)
    assert (done.returncode, done.stderr) == (0, b"")
    assert (here / "a.png").exists()


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
        "from liepoisson.cli.ending import end\n"
        "def command():\n"
        f"    sys.path.insert(0, {str(tmp_path)!r})\n"
        "    import dropping\n"
        "    print('went on', flush=True)\n"
        "    time.sleep(30)\n"
        "end(command)\n"
    )
    options = {"preexec_fn": lambda: signal.signal(signal.SIGINT, signal.SIG_DFL), "capture_output": True, "text": True}
    began = time.monotonic()
    done = subprocess.run([sys.executable, "-c", code], check=False, timeout=60, **options)
    assert time.monotonic() - began < 25  # it does not wait for what was going on
    assert done.stdout == "went on\n"
    assert done.returncode == 130
    assert done.stderr == "interrupted.\n"


def test_an_interruption_while_the_command_is_imported_ends_with_a_word(tmp_path):
    """Before the handler of `ending` is there: the module that Ctrl-C meets is the first one that is imported late."""
    for module in ("liepoisson.inputs.calls", "liepoisson.cli.ending", "liepoisson.errors"):
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
        options = {"preexec_fn": lambda: signal.signal(signal.SIGINT, signal.default_int_handler)}
        call = [sys.executable, "-c", code, "catalog"]
        done = subprocess.run(call, capture_output=True, text=True, check=False, timeout=60, **options)
        assert (done.returncode, done.stdout, done.stderr) == (130, "", "interrupted.\n"), module


def test_before_the_command_is_imported_next_to_nothing_is():
    """What is imported until then is where Ctrl-C ends in a traceback."""
    code = "import sys; before = set(sys.modules); import liepoisson.cli; print(*sorted({*sys.modules} - before))"
    package = str(Path(liepoisson.__file__).parents[1])  # without its site, Python does not know where that is
    done = subprocess.run(
        [sys.executable, "-S", "-c", code],
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
        env=os.environ | {"PYTHONPATH": package},
    )
    assert set(done.stdout.split()) <= {"__future__", "liepoisson", "liepoisson._lazy", "liepoisson.cli"}


def test_a_command_leaves_the_handlers_of_its_process_as_they_were():
    before = signal.getsignal(signal.SIGINT), sys.unraisablehook
    with pytest.raises(SystemExit):
        ending.end(lambda: None)
    assert (signal.getsignal(signal.SIGINT), sys.unraisablehook) == before
