"""Files that commands write: none over a file that the same command reads, and none over another one."""

from pathlib import Path

import pytest

import liepoisson as lp
from liepoisson.cli.main import COMMANDS, application

SYSTEM = (Path(__file__).parents[2] / "python" / "liepoisson" / "catalog" / "kovalevskaya.toml").read_text()
ORBIT = ("--t-end", "1", "--points", "3")
WRITERS = {
    ("orbit", "--out"): ("a.nc", ORBIT),
    ("orbit", "--figure"): ("a.png", ORBIT),
    ("section", "--out"): ("a.nc", ("--starts", "2")),
    ("section", "--figure"): ("a.png", ("--starts", "2")),
    ("lyapunov", "--out"): ("a.nc", ("--starts", "2")),
    ("lyapunov", "--figure"): ("a.png", ("--starts", "2")),
    ("decide", "--out"): ("a.nc", ("--starts", "2")),
    ("equilibria", "--out"): ("a.csv", ()),
    ("sweep", "--out"): ("a.csv", ()),
    ("sweep", "--figure"): ("a.png", ()),
    ("integrable", "--save"): ("a.json", ()),
    ("integrable", "--certificate"): ("a.json", ()),
    ("prove", "--out"): ("a.json", ("--search",)),
    ("lab", "--export"): ("a.html", ()),
}
"""Commands with the options that name a file to write, with such a name, and what the command needs besides."""
READ = {("prove", "--certificate"), ("lab", "--with")}


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_table_has_every_option_that_names_a_file():
    from typer.main import get_command

    commands = get_command(application()).commands
    options = {
        (name, option.opts[0])
        for name in COMMANDS
        for option in commands[name].params
        if option.param_type_name == "option" and str(option.metavar).startswith("FILE")
    }
    assert options == WRITERS.keys() | READ


@pytest.mark.parametrize("writer", WRITERS, ids=" ".join)
@pytest.mark.parametrize("spelling", ["{}", "./{}", "link-{}"])
def test_no_command_writes_over_its_input(here, command, writer, spelling):
    (name, option), (file, needed) = writer, WRITERS[writer]
    (here / file).write_text(SYSTEM)
    (here / f"link-{file}").symlink_to(file)
    code, out, said = command(name, file, *needed, option, spelling.format(file))
    argument = "FILE.toml" if name == "sweep" else "SYSTEM"
    assert (code, out) == (2, "")
    assert f"{option} must be another file than {argument}" in said
    assert (here / file).read_text() == SYSTEM


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("integrable", "lagrange", "--certificate", "q.json", "--save", "q.json"), "--certificate must be another"),
        (("integrable", "lagrange", "--certificate", "q.json", "--save", "./q.json"), "--certificate must be another"),
        (("orbit", "kovalevskaya", *ORBIT, "--out", "link.csv", "--figure", "s"), "--out must be another"),
        (("orbit", "kovalevskaya", *ORBIT, "--out", "link.csv", "--figure", "s.svg"), "--out must be another"),
    ],
)
def test_no_command_writes_two_outputs_into_one_file(here, command, arguments, said):
    (here / "s.svg").symlink_to("link.csv")
    code, out, error = command(*arguments)
    assert (code, out) == (2, "")
    assert said in error
    assert [path.name for path in here.iterdir()] == ["s.svg"]


def test_files_beside_each_other_are_written(here, command):
    code, _, said = command("orbit", "kovalevskaya", *ORBIT, "--out", "kovalevskaya.nc", "--figure", "kovalevskaya")
    assert code == 0, said
    assert len(list(here.iterdir())) == 4


@pytest.mark.parametrize("store", ["", " "])
def test_an_empty_store_is_not_the_working_folder(here, command, store):
    code, _, said = command("sweep", "s.toml", "--store", store)
    assert (code, list(here.iterdir())) == (2, [])
    assert "--store must name a folder" in said


FEW = ("--starts", 2, "--t-end", 20)
FILES = {
    "orbit": (("orbit", "lagrange", "--t-end", 2, "--points", 3), "nc"),
    "section": (("section", "lagrange", "--starts", 2, "--crossings", 3), "nc"),
    "lyapunov": (("lyapunov", "lagrange", *FEW), "nc"),
    "spectrum": (("lyapunov", "lagrange", "--spectrum", *FEW), "nc"),
    "decide": (("decide", "lagrange", *FEW), "nc"),
    "sweep": (("sweep", "s.toml", "--quiet"), "nc"),
    "equilibria": (("equilibria", "lagrange", "--leaf", "C1=1/2,C2=1"), None),
}
"""Commands that find numbers, and whether their results can be saved and loaded, too."""


@pytest.mark.parametrize("name", FILES)
def test_a_table_has_the_columns_of_the_result(here, command, name):
    (here / "s.toml").write_text(
        'system = "kovalevskaya"\nt_end = 5\nn_starts = 2\naxes = [{ name = "energy", values = [1, 2] }]\n'
        'quantity = "exponent"\n\n[starts]\nC1 = 0\nC2 = 1\n'
    )
    arguments, saved = FILES[name]
    code, _, err = command(*arguments, "--out", here / "table.csv")
    assert code == 0, err
    if saved:
        code, _, _ = command(*arguments, "--out", here / "table.nc")
        result = lp.load(here / "table.nc")
    else:
        result = lp.equilibria(lp.catalog.system("lagrange"), {"C1": 0.5, "C2": 1})
    assert code == 0
    expected = result.to_csv(here / "expected.csv")
    assert (here / "table.csv").read_text() == expected.read_text()
    assert (here / "table.csv").read_text().split("\n")[0].split(",") == list(result.to_dataframe().columns)


ESCAPED = "all orbits left every bounded region, or ran into a singularity (step too small): take a lower energy"


@pytest.mark.parametrize(
    "arguments", [("lyapunov",), ("lyapunov", "--spectrum"), ("decide",), ("decide", "--format", "json")]
)
def test_a_command_without_a_result_says_why_with_exit_code_1(command, arguments):
    name, *options = arguments
    code, out, err = command(name, "henon-heiles", "--start", "3,5,0,0", *options)
    assert code == 1
    assert ESCAPED in err
    assert "nan" not in out.lower()
