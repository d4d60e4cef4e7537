"""Files that commands write: none over a file that the same command reads, and none over another one."""

from pathlib import Path

import pytest

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
