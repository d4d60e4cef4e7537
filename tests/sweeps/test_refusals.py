"""What is no sweep: the error of each description, file and call, with the words that matter."""

import re

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import LiePoissonError, ParameterError, SystemFileError, UnknownNameError
from liepoisson.sweeps.family import as_family
from liepoisson.sweeps.points import Lattice, evaluate_targets
from liepoisson.sweeps.run import sweep
from liepoisson.sweeps.spec import Axis, Refinement, Starts, SweepSpec
from liepoisson.sweeps.spec_file import read_sweep_file

AXES = (Axis("epsilon", (0.0, 1.0)),)
TOP = {"I": [2, 2, 1], "a": [-1, 0, 0], "b": [0, 0, 0]}
BAD_SPEC = (
    ({"axes": (Axis("bogus", (0.0, 1.0)),)}, "nothing depends on it"),
    ({"axes": (Axis("H", (0.0, 1.0)),), "parameters": {**TOP, "epsilon": 1}}, "Call it energy"),
    ({"axes": ()}, "one or two"),
    ({"axes": None}, "axes: wanted a sequence of one or two"),
    ({"axes": (Axis("epsilon", (0.0, 1.0)), Axis("epsilon", (2.0, 3.0)))}, "two different names"),
    ({"parameters": None}, "parameters: wanted a mapping"),
    ({"parameters": {**TOP, "a": [1, 0]}}, "shape"),
    ({"parameters": {**TOP, "c": 1}}, "no parameter 'c'"),
    ({"parameters": {"I": [2, 2, 1], "a": [1, 0, 0]}}, "got none for b. Give them in parameters"),
    ({"parameters": {**TOP, "epsilon": 1}}, "another value"),
    ({"parameters": {**TOP, "a": ["log(epsilon)", 0, 0]}}, "not a finite number"),
    ({"parameters": {**TOP, "a": ["cos(", 0, 0]}}, "formula"),
    ({"parameters": {**TOP, "a": None}}, "a: wanted a number, a formula or a list"),
    ({"parameters": {**TOP, "a": [1, [], 0]}}, "a2: wanted .* got an empty list"),
    ({"parameters": {**TOP, "a": [10**400, 0, 0]}}, "a1: .*the range of a double"),
    ({"parameters": {**TOP, "a": [float("nan"), 0, 0]}}, "a1: wanted finite numbers; got nan"),
    ({"n_starts": 0}, "n_starts"),
    ({"t_end": -1.0}, "t_end"),
    ({"t_end": float("inf")}, "t_end"),
    ({"quantity": 3}, "quantity: wanted one of exponent"),
    ({"quantity": "a:b.c"}, "quantity"),
    ({"quantity": "bogus"}, "quantity"),
    ({"starts": "cube"}, "starts: wanted"),
    ({"rule": 0.03}, "rule: wanted a Rule"),
    ({"rule": lp.chaos.Rule()}, "rule belongs to quantity=.chaotic_fraction.; got quantity='exponent'"),
    ({"rule": lp.chaos.Rule(), "quantity": "a:b"}, "rule belongs to quantity="),
    ({"refine": 2}, "refine: wanted Refinement"),
    ({"name": 3}, "name: wanted a text; got 3"),
    ({"system": int}, "system: wanted a function"),
    ({"system": {1: 2}}, "system: wanted tables by name"),
)
BAD_PARTS = (
    *((lambda values=values: Axis("x", values), "axis x: wanted") for values in (None, "abc", [10**400], [1j], [])),
    (lambda: Axis("x", (0.0, 1.0, 1.0)), "increasing or decreasing"),
    (lambda: Axis("x", (0.0, 1.0), 3), "axis x: label: wanted a text"),
    (lambda: Axis("asin", (0.0, 1.0)), "function or constant of formulas; got asin"),
    (lambda: Axis.linear("x", 1, "a", 3), "axis x: "),
    (lambda: Axis.logarithmic("x", 1, float("nan"), 3), "axis x: "),
    (lambda: Axis.logarithmic("x", 0, 1, 3), "positive"),
    (lambda: Refinement(levels=1, difference=0), "difference"),
    (lambda: Starts(casimirs=None), "casimirs: wanted a mapping"),
    (lambda: Starts("cube", energy=2, casimirs={"C1": 1}, sampling="liouville"), "exclude each other: on a leaf"),
    (lambda: Starts(casimirs={"C1": [1, 2]}), "C1: wanted a number or a formula"),
    (lambda: Starts(casimirs={"foo": 1}), "starts: wanted ensemble"),
    (lambda: Starts(energy=object()), "energy: wanted a number or a formula"),
    (lambda: Starts(ensemble="balls"), "ensemble: wanted one of"),
)
BAD_CALLS = (
    ({"store": 3}, "store: wanted the path"),
    ({"scheduler": 3}, "scheduler: wanted an address"),
    ({"patience": float("nan")}, "patience: wanted"),
    ({"progress": 3}, "progress: wanted a function"),
    ({"threads": "x"}, "threads: wanted"),
    ({"processes": 0}, "processes: wanted"),
    ({"threads": 1, "processes": 1}, "one of scheduler"),
    ({"points_per_piece": 0.5}, "points_per_piece"),
    ({"quantity": "os:sep", "allow_code": True}, "wanted a function"),
    ({"quantity": "os:getcwd"}, "code, which would be imported"),
    ({"bogus": 1}, "no setting 'bogus'"),
    ({"C2": 1}, "a sweep has no setting 'C2'.* Write starts="),
    ({"refine": {"levels": 2}}, "levels and difference"),
    ({"starts": {"C4": 1}}, "C1, C2, C3; got C4"),
    ({"starts": Starts(sampling="liouville")}, "all Casimirs must be given; got none for C1, C2, C3"),
    ({"starts": Starts(casimirs={"C1": 1, "C3": 1}, sampling="liouville")}, "got none for C2. Add them"),
    ({"system": "clebsch", "axes": {"C1": [0, 1]}, "parameters": {}, "starts": {"sampling": "liouville"}}, "for C2. A"),
    ({"starts": {"foo": 1}}, "got 'foo'"),
    ({"starts": {"C1": 0.2, "casimirs": {"C2": 1}}}, "starts: wanted C1 beside energy, or all in casimirs"),
    ({"starts": {"C1": "2*C1"}, "axes": {"C1": [0.5, 1]}}, "axis C1: this Casimir of the starts has another value"),
    ({"starts": {"energy": "2*energy"}, "axes": {"energy": [0, 1]}}, "axis energy: the energy of the starts has"),
)
FILE = """
system = "twisted-top"
quantity = "chaotic_fraction"
n_starts = 8
t_end = "100*2"
seed = 5
[parameters]
I = [2, 2, "1"]
a = ["-cos(phi)", 0, 0]
b = [0, 0, 0]
[[axes]]
name = "phi"
from = 0
to = "pi/2"
count = 3
[[axes]]
name = "epsilon"
values = [0, 0.5, 1]
label = "twist"
[starts]
ensemble = "gaussian"
energy = "phi"
C1 = 1
[method]
name = "splitting"
step = 0.1
order = 6
[refine]
levels = 2
difference = 0.25
[rule]
megno = [2.5, "2*3"]
averages = 1e-3
"""
BAD_FILE = (
    ("seed = 5", "sead = 5", "Did you mean seed"),
    ("seed = 5", "threshold = 0.03", "the key is unknown"),
    ("seed = 5", "name = 3", "name: wanted a text; got 3"),
    ('name = "phi"', 'nam = "phi"', "Did you mean name"),
    ("count = 3", "", "count is missing"),
    ('name = "splitting"', 'name = "split"', "wanted one of"),
    ("step = 0.1", "stepp = 0.1", "Did you mean step"),
    ("step = 0.1", "step = 1e309", "step: the number must fit into a double"),
    ("levels = 2", "", "levels and difference"),
    ("averages = 1e-3", "average = 1e-3", "Did you mean averages"),
    ("megno = [2.5,", "megno = [7,", r"rule\.megno: wanted two increasing numbers"),
    ('energy = "phi"', 'enrgy = "phi"', "Did you mean energy"),
    ("C1 = 1", "C1 = 1e309", "C1: wanted .*the range of a double"),
    ('to = "pi/2"', 'to = "pi/"', "formula"),
    ("values = [0, 0.5, 1]", "values = [1, 1e100, 1e400]", r"line 18: \[axes\]\[2\] values: .*fit into a double"),
    ("t_end =", "t_end = 1e309 #", "t_end: the number must fit into a double"),
    ("t_end =", "t_end = nan #", "t_end: wanted a number; got nan. Correct"),
    ("n_starts = 8", "n_starts = 0.5", "n_starts: wanted"),
    ("n_starts = 8", "n_starts = nan", "n_starts: wanted a whole number .*; got nan;"),
    ("[parameters]", "[parameters]\nepsilon = nan", "epsilon: wanted .*; got nan;"),
)


def targets(spec):
    lattice = Lattice(spec)
    return evaluate_targets(spec, as_family(spec.system), lattice.coordinates(lattice.grid()))


@pytest.mark.parametrize(("change", "message"), BAD_SPEC)
def test_what_is_no_sweep_is_refused(change, message):
    given = {"system": "twisted-top", "axes": AXES, "t_end": 1000.0, "parameters": TOP, **change}
    with pytest.raises((ParameterError, UnknownNameError), match=message):
        targets(SweepSpec(**given))


@pytest.mark.parametrize(("make", "message"), BAD_PARTS)
def test_parts_of_a_description_are_refused_by_name(make, message):
    with pytest.raises((ParameterError, UnknownNameError), match=message):
        make()


@pytest.mark.parametrize(("change", "message"), BAD_CALLS)
def test_a_call_is_refused_before_anything_is_made(tmp_path, change, message):
    axis = {} if "axes" in change else {"axes": {"I1": [2, 3]}}
    given = {"system": "twisted-top", "parameters": {**TOP, "I": [2, 2, 1], "epsilon": 1}, "n_starts": 2, "t_end": 1.0}
    given["parameters"] |= {"I": ["I1", 2, 1]} if axis else {}
    with pytest.raises(LiePoissonError, match=message):
        sweep(**{**given, **axis, "store": tmp_path / "a.zarr", **change})
    assert not (tmp_path / "a.zarr").exists()
    with pytest.raises(ParameterError, match="got a spec and n"):
        sweep({"system": "twisted-top"}, n_starts=1)


@pytest.mark.parametrize(("old", "new", "message"), BAD_FILE)
def test_a_wrong_file_is_refused_with_the_key(tmp_path, old, new, message):
    (tmp_path / "map.toml").write_text(FILE.replace(old, new, 1))
    with pytest.raises(SystemFileError, match=message) as refused:
        read_sweep_file(tmp_path / "map.toml")
    assert not re.search(r"\b(\w+): \1: ", str(refused.value))  # the key is named once


def test_a_file_says_the_same_as_python(tmp_path):
    (tmp_path / "map.toml").write_text(FILE)
    wanted = SweepSpec(
        system="twisted-top",
        axes=(Axis.linear("phi", 0, np.pi / 2, 3), Axis("epsilon", (0.0, 0.5, 1.0))),
        parameters={"I": [2, 2, "1"], "a": ["-cos(phi)", 0, 0], "b": [0, 0, 0]},
        starts=Starts(ensemble="gaussian", energy="phi", casimirs={"C1": 1}),
        n_starts=8,
        t_end=200.0,
        quantity="chaotic_fraction",
        rule=lp.chaos.Rule(megno=(2.5, 6.0), averages=1e-3),
        method=lp.Splitting(step=0.1, order=6),
        seed=5,
        refine=Refinement(2, 0.25),
    )
    found = read_sweep_file(tmp_path / "map.toml")
    assert found.fingerprint() == wanted.fingerprint()
    assert found.axes[1].label == "twist"


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ([1j, 1.0, 2.0], "quantity: wanted real numbers; got an array of complex128"),
        (np.array(["1", "2", "3"]), "quantity: wanted"),
        (1.5, r"quantity: wanted a number for each of 3 starts; got shape \(\)"),
        ([[1.0], [2.0], [3.0]], r"got shape \(3, 1\)"),
        (np.ma.array([1.0, 2.0, 3.0], mask=[0, 1, 0]), "quantity: wanted real numbers; got a masked array"),
    ],
)
def test_a_quantity_that_gives_no_number_for_each_start_has_failed(given, message):
    found = lp.sweep(
        system="twisted-kovalevskaya", axes={"energy": [0.0]}, n_starts=3, t_end=1.0, quantity=lambda *_, **__: given
    )
    assert found.outcomes == {"failed": 3}
    assert np.isnan(found.value).all()
    assert re.search(message, found.failed[0])
