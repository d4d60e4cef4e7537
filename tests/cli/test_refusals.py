"""What commands refuse: exit code 2, nothing on standard output, and a sentence with the words that matter."""

import re
import shlex
from dataclasses import fields
from functools import cache
from importlib import import_module
from pathlib import Path

import pytest

import liepoisson as lp
from liepoisson.cli.main import COMMANDS, application
from liepoisson.numeric.methods import CHOICES

MATRIX = '[bracket]\nalgebra = "so(3)"\n[parameters]\nA = [[1, 0, 0], [0, 2, 0], [0, 0, 3]]\n[hamiltonian]\n'
TWIST = (
    'system = "twisted-top"\nn_starts = 1\nt_end = 1\nparameters = {I = [2, 2, 1], a = [-1, 0, 0], b = [0, 0, 0]}\n'
    'axes = [{name = "epsilon", values = [1]}]\n'
)
REFUSED = (
    # the argument SYSTEM and the option --set: cli/systems.py
    ("inspect twistedtop", "no system 'twistedtop'"),
    ("inspect missing.toml", "missing.toml"),
    ("inspect /", "/ must be a file; it is a folder. Give the path of a TOML file."),
    ("inspect twisted-top --format html", "html"),
    ("inspect twisted-top --set epsilom=1", "'twisted-top' has no parameter 'epsilom'. Did you mean epsilon?"),
    ("inspect twisted-top --set q=1", "Known: epsilon, I, a, b"),
    ("inspect twisted-top --set epsilon", "--set must be name=value; got 'epsilon'"),
    ("inspect twisted-top --set =1", "--set must be name=value"),
    ("inspect twisted-top --set epsilon=", "--set must be name=value"),
    ("inspect twisted-top --set epsilon=1,2", "must have one number; got 2 components"),
    ("inspect twisted-top --set a=1", "must have 3 components; got one number"),
    ("inspect twisted-top --set a=1,0", "a must have 3 components; got 2 components. Give for example [1, 2, 3]."),
    ("inspect twisted-top --set 'a=0, 0, 1 + x'", "(column 5 of the formula)"),
    ("inspect twisted-top --set epsilon=1 --set epsilon=2", "must give each parameter once; epsilon comes twice"),
    ("""inspect twisted-top --set 'epsilon=__import__("os")'""", "__import__"),
    ("inspect matrix.toml --set A=1,2,3", "A is a matrix. Write it into a system file"),
    ("orbit twisted-top", "must have numbers for all parameters; got none for epsilon, I[3], a[3], b[3]"),
    ("orbit twisted-kovalevskaya --set epsilon=1e-400", "epsilon must be zero or at least 4.9e-324"),
    ("cite todda", "Did you mean toda"),
    ("cite no.nc", "no.nc"),
    ("cite ' '", "empty"),
    # starts, leaves and energies: cli/starts.py
    ("orbit kovalevskaya --start l1=1 --seed 0", "Leave --seed out"),
    ("orbit kovalevskaya --start 1,2,3", "must have 6 numbers (l1, l2, l3, alpha1, alpha2, alpha3); got 3"),
    ("orbit kovalevskaya --start l=1,2", "--start l must have 3 numbers; got 2"),
    ("orbit kovalevskaya --start gamma=1", "must name a field or a component; got 'gamma'. Known: l, alpha, l1"),
    ("orbit kovalevskaya --start l=1,2,3 --start l2=1", "each component once; l2 comes twice"),
    ("orbit kovalevskaya --start l=1,2,3,l2=1", "each component once; l2 comes twice"),
    ("orbit kovalevskaya --start 1,l2=1", "must be name=value; got '1'"),
    ("orbit kovalevskaya --start l=1,2,x", "x: the name 'x' is unknown"),
    ("orbit kovalevskaya --start 1,2,3 --start l=1,2,3", "must be name=value; got '1,2,3'"),
    ("orbit kovalevskaya --start alpha=0,0,1 --leaf C2=2", "it has C2 = 1 instead of 2"),
    ("orbit kovalevskaya --start alpha=0,0,1 --leaf C2=1.000001", "it has C2 = 1 instead of 1.000001"),
    ("orbit kovalevskaya --start alpha=0,0,1 --energy 1", "it has H = 0 instead of 1"),
    ("orbit kovalevskaya --start l=1,0,0 --guess l=1,0,0", "exclude each other"),
    ("orbit kovalevskaya --guess l=1,0,0", "--guess must come with --leaf or --energy"),
    ("orbit twisted-kovalevskaya --start alpha=1e200,0,0", "Casimirs"),
    ("orbit twisted-kovalevskaya --leaf C3=0", "--start STATE, without --leaf"),
    ("orbit kovalevskaya --leaf C2=-1", "C2"),
    ("orbit kovalevskaya --leaf C7=1", "must name Casimirs of kovalevskaya; got 'C7'. Known: C1 = l.alpha, C2 ="),
    ("orbit kovalevskaya --leaf C1=1,C1=2", "C1 comes twice"),
    ("orbit kovalevskaya --leaf C1=1 --leaf C1=2", "C1 comes twice"),
    ("orbit kovalevskaya --leaf 1,2", "--leaf must be name=value; got '1'. Write for example --leaf C1=1,C2=0"),
    ("orbit kovalevskaya --energy 1 --energy 2", "--energy must be given once; it comes twice. Remove one"),
    ("orbit kovalevskaya --energy -5", "On this leaf the energy lies between"),
    ("lyapunov lagrange --start 1,0,0,0,0,1 --starts 3", "--starts and --start exclude each other"),
    ("lyapunov lagrange --ensemble cube --energy 1", "--ensemble and --energy exclude each other"),
    ("decide lagrange --ensemble cube --leaf C1=1", "--ensemble and --leaf exclude each other"),
    ("lyapunov lagrange --ensemble cube --start 1,0,0,0,0,1", "--ensemble and --start exclude each other"),
    ("lyapunov lagrange --ensemble sphere", "wanted one of unit-vectors, cube, gaussian; got 'sphere'"),
    # times and methods
    ("orbit kovalevskaya --t-end 0", "--t-end must be a finite time other than 0"),
    ("orbit kovalevskaya --t-end nan", "--t-end must be a finite time other than 0"),
    ("section kovalevskaya --t-end nan", "--t-end must be a finite time other than 0; got nan. Leave it out."),
    ("lyapunov lagrange --t-end -5", "--t-end must be a positive finite time"),
    ("lyapunov lagrange --t-end nan", "--t-end must be a positive finite time"),
    ("lyapunov lagrange --t-end 5e-324 --starts 2", "t_end: wanted a time of at least 1e-300"),
    ("lyapunov lagrange --spectrum --t-end 1e12 --time-limit 3", "at most 10000000 intervals"),
    ("lyapunov lagrange --tol 2", "tol"),
    ("orbit kovalevskaya --points 1", "--points must be from 2"),
    ("orbit kovalevskaya --method euler", "--method must be one of taylor, "),
    ("decide lagrange --method splittig", "Did you mean splitting"),
    ("section kovalevskaya --crossings 0", "--crossings must be from 1 to 1000000000; got 0. Try 500."),
    ("section kovalevskaya --direction left", "left"),
    # surfaces and axes
    ("section kovalevskaya --surface 'l3 - q'", "the name 'q' is unknown"),
    ("section kovalevskaya --surface 'abs(l3)'", "abs"),
    ("section kovalevskaya --surface '1 - 1'", "a function of the state was wanted; '1 - 1' is constant"),
    ("section kovalevskaya --surface 'dot(l,alpha)'", "constant on each leaf: its bracket with every component is"),
    ("section lagrange --surface 'l3^2 + dot(l, alpha)'", "a constant of motion: its bracket with H is zero"),
    ("section kovalevskaya --keep l7", "l7"),
    ("section kovalevskaya --plot --keep l1 --x l2", "--x and --y must be kept; 'l2' is not"),
    ("section kovalevskaya --plot --keep l1", "two functions for its axes; only 'l1' is there"),
    ("section kovalevskaya --x l1", "--x and --y belong to a figure; add --plot or --figure FILE"),
    ("section kovalevskaya --y nonsense --out a.csv", "--x and --y belong to a figure"),
    ("section kovalevskaya --plot --x q", "the name 'q' is unknown"),
    # files: cli/output.py
    ("orbit kovalevskaya --out orbit.txt", "--out must end in one of .nc, .csv; got 'orbit.txt'"),
    ("orbit kovalevskaya --out ' '", "--out must name a file"),
    ("orbit kovalevskaya --out .", "--out must be a file; . is a folder"),
    ("orbit kovalevskaya --figure a.jpg", "--figure must end in one of .png, .svg, .pdf"),
    ("orbit kovalevskaya --t-end 5 --start l=1e200,0,0 --figure a.png", "liepoisson: "),
    ("orbit kovalevskaya --t-end 1 --out " + "x" * 300 + ".nc", "File name too long. Choose a shorter name"),
    ("orbit long.toml --plot", "name: wanted at most 200 characters; got 200000"),
    ("section kovalevskaya --out /proc/section.nc", "could not write /proc/section.nc"),
    ("sweep twist.toml --store ''", "--store must name a folder"),
    ("sweep twist.toml --figure x.gif", "--figure must end in"),
    ("sweep twist.toml --threads 1 --processes 1", "one of scheduler, processes and threads"),
    ("sweep twist.toml --patience 5", "--patience belongs to --scheduler or --processes"),
    ("sweep bogus.toml", "there is no file bogus.toml"),
    ("sweep many.toml", "wanted at most 16777216 points; got 16384 x 16384"),
    ("sweep large.toml", "results of at most 16 GiB; a grid of 1 with n_starts = 2147483648 takes"),
    # exact commands
    ("darboux toda", "wanted a polynomial"),
    ("darboux rattleback --degree 2 --weight 2", "got both"),
    ("darboux rattleback --field octonions", "field"),
    ("darboux twisted-top", "wanted rational numbers"),
    ("families kovalevskaya", "must have parameters without a value"),
    ("families clebsch --free b", "--free must name a parameter of 'clebsch'"),
    ("families clebsch --free a --positive a", "wanted names of a1, a2, a3"),
    ("families clebsch --free a --on m1", "not invariant"),
    ("families clebsch --free a --degree 0", "degree"),
    ("families free.toml --set k=2 --free k --degree 1", "--set and --free exclude each other; k has both"),
    ("families clebsch --set a=1,2,3 --free a", "--set and --free exclude each other; a has both"),
    ("integrals log.toml", "wanted a polynomial"),
    ("integrals clebsch --degree 2 --weight 2", "got both"),
    ("integrals clebsch --on m1=0", "orbits do not leave"),
    ("integrals clebsch --on C9=0", "C9"),
    ("integrable log.toml", "wanted a polynomial"),
    ("integrable clebsch --certificate clebsch.txt", "--certificate"),
    ("painleve henon-heiles-kdv --weights 1,2", "one for each of x, y, p_x, p_y"),
    ("painleve henon-heiles-kdv --weights a,b,c,d", "rational numbers"),
    ("painleve henon-heiles-kdv --free nosuch", "--free must name a parameter"),
    ("painleve free.toml --free k --set k=3", "--set and --free exclude each other; k has both"),
    ("equilibria lagrange --along l3", "--along must be name=value; got 'l3'. Write for example --along l3=1/2"),
    ("equilibria kovalevskaya --start alpha=0,0,1 --leaf C2=2", "--start and --leaf exclude each other"),
    ("equilibria lagrange --along l4=1", "the name 'l4' is unknown. l has 3 components. Known are"),
    ("prove kovalevskaya", "no certificate is shipped"),
    ("prove twisted-kovalevskaya --certificate none.json", "no such file"),
    ("prove twisted-kovalevskaya --level H=1/2", "belong to --search"),
    ("prove twisted-kovalevskaya --seed 1", "belong to --search"),
    ("prove twisted-kovalevskaya --search --certificate x.json", "got both"),
    ("prove twisted-kovalevskaya --search --level C1=1", "got none of H, C2, C3; add for example --level H=1,"),
    ("prove kovalevskaya --search", "wanted a level of kovalevskaya"),
    # the laboratory
    ("lab kirchhoff --no-open --surface 'm1 +'", "m1 +"),
    ("lab kirchhoff --no-open --start m1=1e7", "Rescale"),
    ("lab --no-open --start l=1,0,0", "SYSTEM must be given"),
    ("lab kirchhoff --no-open --seed -1", "--seed"),
    ("lab kirchhoff --no-open --start m1=1 --seed 0", "Leave --seed out"),
    ("lab kirchhoff --export a.pdf", ".html"),
    ("lab kirchhoff --export a.html --no-open", "exclude"),
    ("lab kirchhoff --no-open --with missing.nc", "missing.nc"),
    # fits
    ("fit lagrange no.csv --unknown a3", "wanted a CSV file; got 'no.csv'"),
    ("fit lagrange data.csv --start 1,0,0,0,0,1 --unknown apha", "Did you mean alpha"),
    ("fit lagrange data.csv --unknown a3 --time s", "time: wanted the name of a column; got 's'"),
    ("fit lagrange data.csv --unknown a3 --column l7", "got 'l7'"),
    ("fit lagrange data.csv --unknown a3 --error l1=much", "got 'much'"),
    ("fit lagrange data.csv --unknown a3 --bound a3=1", "--bound must be name=low:high"),
    (
        "fit lagrange data.csv --unknown a3",
        'l2 is not observed, and no start was given; give a guess, starts={"l2": 0} (--start l2=0)',
    ),
    ("fit lagrange data.csv --unknown a3 --unknown l --start alpha3=1", "4 unknowns and 2 values"),
    # studies
    ("reproduce twistedtop", "no study 'twistedtop'"),
    ("reproduce twisted-top --members many --out out", "Invalid value for '--members'"),
    ("reproduce twisted-top --members 1 --out out", "members must be at least 2"),
    ("reproduce twisted-top --end-time nan --out out", "end time must be finite"),
    ("reproduce twisted-top --member 5 --out out", "--member"),
    ("reproduce twisted-top --quick --fresh --out ' '", "--out must name a folder"),
    ("reproduce twisted-top --quick --out log.toml/out", "choose another folder"),
)


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A folder with the files that the table names."""
    monkeypatch.chdir(tmp_path)
    lp.systems.write_system(lp.System(lp.canonical(2), "dot(p, p)/2 + q1*log(q2)", name="log"), "log.toml")
    axes = [f'{{name = "{name}", from = 0, to = 1, count = 16384}}' for name in ("epsilon", "a1")]
    for name, text in {
        "matrix": MATRIX + 'expression = "dot(l, A*l)"\n',
        "long": f'name = "{"n" * 200_000}"\n{MATRIX}expression = "dot(l, A*l)"\n',
        "free": MATRIX.replace("A = [[1, 0, 0], [0, 2, 0], [0, 0, 3]]", "k = 1") + 'expression = "k*l1^2 + l2^2"\n',
        "twist": TWIST,
        "shaken": MATRIX + 'expression = "dot(l, A*l)"\n[noise]\nnoises = "l1"\n',
        "many": TWIST.replace('{name = "epsilon", values = [1]}', ", ".join(axes)),
        "large": TWIST.replace("n_starts = 1", "n_starts = 2147483648"),
    }.items():
        (tmp_path / f"{name}.toml").write_text(text)
    (tmp_path / "data.csv").write_text("t,l1\n0,0.5\n1,0.25\n")
    return tmp_path


@cache
def options_of(name):
    """The options of a command."""
    from typer.main import get_command

    command = get_command(application()).commands[name]
    return {
        "--help",
        *(option for parameter in command.params for option in (*parameter.opts, *parameter.secondary_opts)),
    }


def options_that_are_not_there(name, text):
    """Options that a message of a command names, and the command does not have."""
    return {*re.findall(r"(?<![\w-])--[a-z][a-z-]*", text)} - options_of(name)


@pytest.mark.parametrize(("line", "words"), REFUSED, ids=[line[:60] for line, _ in REFUSED])
def test_a_refusal_is_a_sentence_and_writes_nothing(here, command, line, words):
    before = {path: path.read_bytes() for path in here.iterdir()}
    code, out, err = command(*shlex.split(line))
    assert (code, out) == (2, "")
    assert words in " ".join(err.split())
    assert "Traceback" not in err
    assert len(err.strip().splitlines()) <= 6
    name, *given = shlex.split(line)
    assert not options_that_are_not_there(name, err) - {*given}
    for pair in re.findall(r"(--[a-z-]+) and (--[a-z-]+) exclude each other", " ".join(err.split())):
        assert {*pair} <= {*given}, "it speaks of an option that was not given"
    assert {path: path.read_bytes() for path in here.iterdir()} == before


OUT_OF_RANGE = {"--seed": ("-1",), "--threads": ("0", "9" * 23), "--time-limit": ("0", "-1", "nan"), "--starts": ("0",)}


def test_every_command_refuses_numbers_that_no_run_can_have(here, command, lines, parameters):
    """The options that many commands share, wherever they are."""
    tried = set()
    for name, taken in parameters.items():
        for option in {option for parameter in taken for option in parameter.opts} & OUT_OF_RANGE.keys():
            for value in OUT_OF_RANGE[option]:
                code, out, err = command(name, *lines[name], option, value)
                assert (code, out) == (2, ""), (name, option, value)
                assert option.strip("-").replace("-", " ") in err.replace("_", " ").replace("-", " "), (name, err)
                tried.add((name, option))
    assert len(tried) > 25


@pytest.mark.parametrize("module", sorted({*COMMANDS.values()}))
def test_a_file_of_commands_names_options_that_they_have(module):
    written = Path(import_module(f"liepoisson.cli.{module}").__file__).read_text(encoding="utf-8")
    commands = [name for name, file in COMMANDS.items() if file == module]
    assert not set.intersection(*(options_that_are_not_there(name, written) for name in commands))


OF_METHODS = {"--tol": "1e-9", "--step": "0.1", "--order": "4", "--precision": "single"}


@pytest.mark.parametrize("name", [name for name in COMMANDS if "--method" in options_of(name)])
def test_options_of_another_method_are_refused_with_those_that_the_command_has(command, name):
    for method, kind in CHOICES.items():
        known = {f"--{field.name}" for field in fields(kind)}
        for option in (OF_METHODS.keys() & options_of(name)) - known:
            code, out, err = command(name, "kovalevskaya", "--method", method, option, OF_METHODS[option])
            assert (code, out) == (2, ""), (method, option)
            assert f"{option} is not an option of {method}, which has --" in err
            assert not options_that_are_not_there(name, err), err


def test_a_limit_of_a_millionth_of_a_second_ends_every_command_that_has_one(here, command, lines, parameters):
    tried = [name for name, taken in parameters.items() if any("--time-limit" in one.opts for one in taken)]
    for name in tried:
        _, out, err = command(name, *lines[name], "--time-limit", "1e-6")
        said = "incomplete" if name == "families" else "time limit"
        assert said in " ".join((out + err).split()), (name, out, err)
    assert len(tried) > 7
