"""Files that commands write: none over a file that the same command reads, and none over another one."""

import re
from pathlib import Path

import pytest

import liepoisson as lp
from liepoisson.cli.main import COMMANDS

SYSTEM = (Path(__file__).parents[2] / "python" / "liepoisson" / "catalog" / "kovalevskaya.toml").read_text()
ORBIT = ("--t-end", "1", "--points", "3")
READ = {("prove", "--certificate"), ("lab", "--with")}
"""Options that name a file to read."""


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_no_command_writes_over_its_input(here, command, lines, parameters):
    writers = {
        (name, option.opts[0])
        for name, options in parameters.items()
        for option in options
        if option.param_type_name == "option" and str(option.metavar).startswith("FILE")
    }
    assert writers > READ
    for name, option in writers - READ:
        needed = lines[name][1:]
        (here / "a.x").write_text(SYSTEM)
        _, _, said = command(name, "a.x", *needed, option, "b.x")
        ending = re.search(r"must end in (?:one of )?(\.\w+)", said)
        assert ending, f"{name} {option}: {said}; what it must be given is in LINES of conftest.py"
        file = "a" + ending[1]
        (here / file).write_text(SYSTEM)
        (here / f"link-{file}").unlink(missing_ok=True)
        (here / f"link-{file}").symlink_to(file)
        for spelling in (file, f"link-{file}"):
            code, out, said = command(name, file, *needed, option, spelling)
            argument = "FILE.toml" if name == "sweep" else "SYSTEM"
            assert (code, out) == (2, ""), (name, option, said)
            assert f"{option} must be another file than {argument}" in said
            assert (here / file).read_text() == SYSTEM


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("integrable", "lagrange", "--certificate", "q.json", "--save", "./q.json"), "--certificate must be another"),
        (("orbit", "kovalevskaya", *ORBIT, "--out", "link.csv", "--figure", "s"), "--out must be another"),
    ],
)
def test_no_command_writes_two_outputs_into_one_file(here, command, arguments, said):
    (here / "s.svg").symlink_to("link.csv")
    code, out, error = command(*arguments)
    assert (code, out) == (2, "")
    assert said in error
    assert [path.name for path in here.iterdir()] == ["s.svg"]


FEW = ("--starts", 2, "--t-end", 20)
FILES = {
    "orbit": ("orbit", "lagrange", "--t-end", 2, "--points", 3),
    "section": ("section", "lagrange", "--starts", 2, "--crossings", 3),
    "lyapunov": ("lyapunov", "lagrange", *FEW),
    "spectrum": ("lyapunov", "lagrange", "--spectrum", *FEW),
    "decide": ("decide", "lagrange", *FEW),
    "sweep": ("sweep", "s.toml", "--quiet"),
}
"""Commands whose results are numbers."""


@pytest.mark.parametrize("name", FILES)
def test_a_table_has_the_columns_of_the_result(here, command, name):
    (here / "s.toml").write_text(
        'system = "kovalevskaya"\nt_end = 5\nn_starts = 2\naxes = [{ name = "energy", values = [1, 2] }]\n'
        'quantity = "exponent"\n\n[starts]\nC1 = 0\nC2 = 1\n'
    )
    for table in ("table.csv", "table.nc"):
        code, _, err = command(*FILES[name], "--out", here / table)
        assert code == 0, err
    expected = lp.load(here / "table.nc").to_csv(here / "expected.csv")
    assert (here / "table.csv").read_text() == expected.read_text()


def test_a_diagram_is_read_again_with_its_regions(here, command):
    given = ("diagram", "spherical-pendulum", "--leaf", "C1=0,C2=1", "--energy-max", 2)
    assert command(*given, "--out", "plane.nc")[0] == 0
    assert command(*given, "--regions", "--out", "regions.nc")[0] == 0
    plane, regions = lp.load("plane.nc"), lp.load("regions.nc")
    assert regions[0].fibre.n_tori == 1
    assert regions.diagram.to_dataframe().equals(plane.to_dataframe())


def test_a_slice_of_three_integrals_is_looked_for_and_read_again(here, command):
    given = ("diagram", "toda", "--at", "P=0", "--energy-max", 4)
    code, text, _ = command(*given, "--out", "slice.nc")
    assert code == 0
    assert "relative equilibrium, elliptic, elliptic: H = 3" in text
    assert lp.load("slice.nc").at == {"P": 0}
    for wrong in (("--at", "P"), ("--at", "Q=0"), (), ("--at", "P=0", "--cut", 1)):
        code, _, err = command("diagram", "toda", *wrong)
        assert code != 0, err
        assert "at" in err or "--cut" in err


ESCAPED = "all orbits left every bounded region, or ran into a singularity (step too small): take a lower energy"


@pytest.mark.parametrize("arguments", [("lyapunov",), ("lyapunov", "--spectrum"), ("decide", "--format", "json")])
def test_a_command_without_a_result_says_why_with_exit_code_1(command, arguments):
    name, *options = arguments
    code, out, err = command(name, "henon-heiles", "--start", "3,5,0,0", *options)
    assert code == 1
    assert ESCAPED in err
    assert "nan" not in out.lower()


def test_every_command_has_a_place_on_the_page():
    page = (Path(__file__).parents[2] / "docs" / "command-line.md").read_text(encoding="utf-8")
    assert [name for name in COMMANDS if f"liepoisson {name}" not in page and f"`{name}`" not in page] == []


def test_every_kind_of_figure_has_a_name_of_its_own(here, command):
    """What one command draws must not stand where another one, or itself with another option, drew something else."""
    kinds = ("orbit", "section", "lyapunov", "lyapunov --spectrum")
    for kind in kinds:
        starts = () if kind in {"orbit", "section"} else ("--starts", "1")
        code, _, said = command(*kind.split(), "kovalevskaya", "--plot", "--t-end", "20", *starts)
        assert code == 0, said
    assert len(list(here.glob("*.png"))) == len(kinds)
