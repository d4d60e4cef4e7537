"""What a sweep is: axes, formulas, files, and what is refused."""

import json
import re
from dataclasses import fields
from fractions import Fraction

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import ParameterError, SystemFileError, UnknownNameError
from liepoisson.sweeps.family import as_family
from liepoisson.sweeps.lattice import Lattice
from liepoisson.sweeps.spec import Axis, Refinement, Starts, SweepSpec
from liepoisson.sweeps.spec_file import read_sweep_file
from liepoisson.sweeps.targets import evaluate_targets

KOVALEVSKAYA = {"I": [2, 2, 1], "a": [-1, 0, 0], "b": [0, 0, 0]}


def targets(spec):
    lattice = Lattice(spec)
    return evaluate_targets(spec, as_family(spec.system), lattice.coordinates(lattice.grid()))


def test_formulas_set_vectors():
    spec = SweepSpec(
        system="twisted-top",
        axes=(Axis("ratio", (1.0, 2.0)), Axis("phi", (0.0, 0.5, 1.0))),
        t_end=1000.0,
        parameters={"I": [2, 2, "2/ratio"], "a": ["cos(phi)", "sin(phi)", 0], "b": [0, 0, 0], "epsilon": 1},
    )
    found = targets(spec)
    ratio, phi = np.repeat([1.0, 2.0], 3), np.tile([0.0, 0.5, 1.0], 2)
    np.testing.assert_array_equal(found.parameters["I"], np.stack([2 + 0 * phi, 2 + 0 * phi, 2 / ratio], axis=-1))
    np.testing.assert_array_equal(found.parameters["a"], np.stack([np.cos(phi), np.sin(phi), 0 * phi], axis=-1))
    assert found.energy is None
    assert found.casimirs == {}


def test_axes_set_components_energy_and_casimirs():
    spec = SweepSpec(
        system="twisted-top",
        axes=(Axis("b3", (0.0, 1.0)), Axis("energy", (2.0, 3.0))),
        t_end=1000.0,
        parameters={**KOVALEVSKAYA, "epsilon": 1},
        starts=Starts(casimirs={"C1": "1 + b3"}),
    )
    found = targets(spec)
    np.testing.assert_array_equal(found.parameters["b"], [[0, 0, 0], [0, 0, 0], [0, 0, 1], [0, 0, 1]])
    np.testing.assert_array_equal(found.energy, [2, 3, 2, 3])
    np.testing.assert_array_equal(found.casimirs["C1"], [1, 1, 2, 2])


@pytest.mark.parametrize(
    "system",
    [
        pytest.param("twisted-top", id="catalog"),
        pytest.param(lp.catalog.path("twisted-top"), id="file"),
    ],
)
def test_the_top_of_a_file_is_found_without_building_it(system):
    top = as_family(system).top({"I": (3.0, 2.0, 1.5), "a": (0.0, 1.0, 2.0), "b": (0.5, 0.0, 0.0), "epsilon": 0.25})
    assert top == lp.Top(inertia=(3, 2, 1.5), a=(0, 1, 2), b=(0.5, 0, 0), epsilon=0.25).field()


def test_other_systems_are_not_taken_for_tops():
    family = as_family("clebsch")
    assert family.top({}) is None
    assert family.system({}).field() == lp.catalog.system("clebsch").field()


def test_parameters_of_a_bracket_are_those_that_it_contains():
    assert as_family("gyrostat").bracket_parameters == {"k"}  # its components k1, k2, k3
    assert as_family("kirchhoff").bracket_parameters == set()
    tables = {
        "name": "so(3) and a factor that is written, and not there",
        "bracket": {
            "algebra": "so(3)",
            "W": [[[1, 0], [0, "k - k"]], [[0, 1], [1, 0]]],
            "variables": ["l", "alpha"],
        },
        "hamiltonian": {"expression": "k*dot(l, l) + dot(alpha, alpha)"},
        "parameters": {"k": 1},
    }
    assert as_family(tables).bracket_parameters == set()


def test_functions_are_families():
    spec = SweepSpec(system=lp.Top.kovalevskaya, axes=(Axis("epsilon", (0.0, 1.0)),), t_end=1000.0)
    assert targets(spec).parameters["epsilon"].tolist() == [0, 1]
    assert as_family(lp.Top.kovalevskaya).system({"epsilon": 0.5}).epsilon == Fraction(1, 2)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"axes": (Axis("bogus", (0.0, 1.0)),)}, "nothing depends on it"),
        ({"axes": ()}, "one or two"),
        ({"axes": (Axis("epsilon", (0.0, 1.0)), Axis("epsilon", (2.0, 3.0)))}, "two different names"),
        ({"parameters": {**KOVALEVSKAYA, "a": [1, 0]}}, "shape"),
        ({"parameters": {**KOVALEVSKAYA, "c": 1}}, "no parameter 'c'"),
        ({"parameters": {"I": [2, 2, 1], "a": [1, 0, 0]}}, "b have none"),
        ({"parameters": {**KOVALEVSKAYA, "a": ["log(epsilon)", 0, 0]}}, "not a finite number"),
        ({"parameters": {**KOVALEVSKAYA, "a": ["cos(", 0, 0]}}, "formula"),
        ({"parameters": {**KOVALEVSKAYA, "epsilon": 1}}, "another value"),
        ({"n_starts": 0}, "n_starts"),
        ({"t_end": -1.0}, "t_end"),
        ({"t_end": float("inf")}, "t_end"),
        ({"quantity": 3}, "quantity: wanted one of exponent"),
        ({"starts": "cube"}, "starts: wanted"),
        ({"rule": 0.03}, "rule: wanted a Rule"),
        ({"axes": None}, "axes: wanted a sequence of one or two"),
        ({"axes": 3}, "axes: wanted a sequence of one or two"),
        ({"parameters": None}, "parameters: wanted a mapping"),
        ({"parameters": {**KOVALEVSKAYA, "a": None}}, "a: wanted a number, a formula or a list"),
        ({"parameters": {**KOVALEVSKAYA, "a": [1, [], 0]}}, "a2: wanted .* got an empty list"),
        ({"parameters": {**KOVALEVSKAYA, "a": [10**400, 0, 0]}}, "a1: .*the range of a double"),
        ({"parameters": {**KOVALEVSKAYA, "a": [float("nan"), 0, 0]}}, "a1: wanted finite numbers; got nan"),
        ({"refine": 2}, "refine: wanted Refinement"),
        ({"name": 3}, "name: wanted a text; got 3"),
        ({"system": int}, "system: wanted a function"),
        ({"system": {1: 2}}, "system: wanted tables by name"),
    ],
)
def test_what_is_no_sweep_is_refused(change, message):
    axes = (Axis("epsilon", (0.0, 1.0)),)
    given = {"system": "twisted-top", "axes": axes, "t_end": 1000.0, "parameters": KOVALEVSKAYA, **change}
    with pytest.raises(ParameterError, match=message):
        targets(SweepSpec(**given))


@pytest.mark.parametrize("values", [None, "abc", [10**400], [1j], object(), [[0.0, 1.0]], []])
def test_axes_without_numbers_are_refused(values):
    with pytest.raises(ParameterError, match="axis x: wanted"):
        Axis("x", values)


@pytest.mark.parametrize("end", [None, "a", 10**400, float("nan")])
def test_axes_without_ends_are_refused(end):
    for make in (Axis.linear, Axis.logarithmic):
        with pytest.raises(ParameterError, match="axis x: "):
            make("x", 1, end, 3)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"casimirs": None}, "casimirs: wanted a mapping"),
        ({"casimirs": {"C1": [1, 2]}}, "C1: wanted a number or a formula"),
        ({"casimirs": {"C1": 10**400}}, "C1: .*the range of a double"),
        ({"energy": object()}, "energy: wanted a number or a formula"),
        ({"ensemble": []}, "ensemble: wanted a text"),
        ({"ensemble": "balls"}, "ensemble: wanted one of"),
    ],
)
def test_starts_of_the_wrong_kind_are_refused(given, message):
    with pytest.raises((ParameterError, UnknownNameError), match=message):
        Starts(**given)


def test_other_refusals():
    with pytest.raises(ParameterError, match="axis x: label: wanted a text"):
        Axis("x", (0.0, 1.0), 3)
    for name in (":", "a.:b", ".a:b", "a:", "a:b.c"):
        with pytest.raises(UnknownNameError, match="quantity"):
            SweepSpec(system="twisted-top", axes=(Axis("epsilon", (0.0, 1.0)),), t_end=9.0, quantity=name)
    with pytest.raises(ParameterError, match="function or constant of formulas; got asin"):
        Axis("asin", (0.0, 1.0))
    with pytest.raises(ParameterError, match="starts: wanted ensemble"):
        Starts(casimirs={"foo": 1})
    with pytest.raises(UnknownNameError, match="quantity"):
        SweepSpec(system="twisted-top", axes=(Axis("epsilon", (0.0, 1.0)),), t_end=9.0, quantity="bogus")
    with pytest.raises(UnknownNameError, match="ensemble"):
        Starts(ensemble="bogus")
    with pytest.raises(ParameterError, match="increasing or decreasing"):
        Axis("x", (0.0, 1.0, 1.0))
    with pytest.raises(ParameterError, match="positive"):
        Axis.logarithmic("x", 0, 1, 3)
    with pytest.raises(ParameterError, match="difference"):
        Refinement(levels=1, difference=0)


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
    ("old", "new", "message"),
    [
        ("seed = 5", "sead = 5", "Did you mean seed"),
        ('name = "phi"', 'nam = "phi"', "Did you mean name"),
        ("count = 3", "", "count is missing"),
        ('name = "splitting"', 'name = "split"', "wanted one of"),
        ("step = 0.1", "stepp = 0.1", "Did you mean step"),
        ("levels = 2", "", "levels and difference"),
        ("averages = 1e-3", "average = 1e-3", "Did you mean averages"),
        ("megno = [2.5,", "megno = [7,", r"rule\.megno: wanted two increasing numbers"),
        ("seed = 5", "threshold = 0.03", "the key is unknown"),
        ('energy = "phi"', 'enrgy = "phi"', "Did you mean energy"),
        ("n_starts = 8", "n_starts = 0.5", "n_starts: wanted"),
        ('to = "pi/2"', 'to = "pi/"', "formula"),
        ("values = [0, 0.5, 1]", "values = [1, 1e100, 1e400]", r"line 18: \[axes\]\[2\] values: .*fit into a double"),
        ("t_end =", "t_end = 1e309 #", "t_end: the number must fit into a double"),
        ("t_end =", "t_end = nan #", "t_end: wanted a number; got nan. Correct"),
        ("n_starts = 8", "n_starts = 1e309", "n_starts: the number must fit into a double"),
        ("n_starts = 8", "n_starts = nan", "n_starts: wanted a whole number .*; got nan;"),
        ("step = 0.1", "step = 1e309", "step: the number must fit into a double"),
        ("[parameters]", "[parameters]\nepsilon = nan", "epsilon: wanted .*; got nan;"),
        ("C1 = 1", "C1 = 1e309", "C1: wanted .*the range of a double"),
        ("seed = 5", "name = 3", "name: wanted a text; got 3"),
    ],
)
def test_a_wrong_file_is_refused_with_the_key(tmp_path, old, new, message):
    (tmp_path / "map.toml").write_text(FILE.replace(old, new, 1))
    with pytest.raises(SystemFileError, match=message):
        read_sweep_file(tmp_path / "map.toml")


def test_the_fingerprint_tells_sweeps_apart():
    axes = (Axis("epsilon", (0.0, 1.0)),)
    base = {"system": "twisted-top", "axes": axes, "t_end": 1000.0, "parameters": KOVALEVSKAYA}
    changes = [
        {"seed": 1},
        {"n_starts": 65},
        {"t_end": 999.0},
        {"axes": (Axis("epsilon", (0.0, 2.0)),)},
        {"parameters": {**KOVALEVSKAYA, "a": [1, 0, 0]}},
        {"method": lp.Taylor()},
        {"starts": Starts(ensemble="cube")},
        {"quantity": "json:loads"},
        {"quantity": "chaotic_fraction"},
        {"quantity": "chaotic_fraction", "rule": lp.chaos.Rule(averages=1e-3)},
        {"refine": Refinement(1, 0.5)},
        {"system": lp.Top.kovalevskaya},
    ]
    prints = [SweepSpec(**{**base, **change}).fingerprint() for change in ({}, *changes)]
    assert len(set(prints)) == len(prints)
    assert SweepSpec(**base, rule=lp.chaos.Rule(averages=1e-3), name="other").fingerprint() == prints[0]
    json.dumps(SweepSpec(**base).record())


def test_what_is_held_is_said():
    spec = SweepSpec(
        system="twisted-top",
        axes=(Axis("epsilon", (0.0, 1.0)), Axis("e", (0.0, 1.0))),
        t_end=1000.0,
        parameters=KOVALEVSKAYA,
        starts=Starts(energy="e", casimirs={"C1": 1, "C3": 2}),
    )
    lines = spec.held()
    assert "a = (-1, 0, 0)" in lines[0]
    assert lines[1] == "of the starts: C1 = 1, C3 = 2"
    assert "epsilon |beta|" in lines[2]


def held(axes, parameters, **starts):
    spec = SweepSpec(
        system="twisted-top",
        axes=tuple(Axis(a, (0.0, 1.0)) for a in axes),
        t_end=1000.0,
        parameters=parameters,
        starts=Starts(**starts),
    )
    return spec.held()


def test_what_varies_is_not_said_to_be_held():
    assert held(["C1"], {"epsilon": 1})[1] == "of the starts: nothing but what the axes say"
    assert (
        held(["C1"], {"epsilon": "C1"})[0] == "of the starts: nothing but what the axes say"
    )  # a formula uses it, too
    assert "same state" in held(["s"], {"epsilon": "s"})[0]
    assert held(["energy"], {"epsilon": 1}, casimirs={"C1": "energy", "C3": 1})[1] == "of the starts: C3 = 1"
    assert held(["b1"], {"a": [1, 0, 0], "b": [0, 0, 2]})[0] == "parameters: a = (1, 0, 0), b2 = 0, b3 = 2"
    assert held(["s"], {"b": ["s", 0, 3]})[0] == "parameters: b2 = 0, b3 = 3"


def test_an_epsilon_by_a_formula_is_a_scale_too():
    assert "epsilon |beta|" in held(["s"], {"epsilon": "s"})[-1]
    assert "epsilon |beta|" not in held(["s"], {"epsilon": 1, "b": ["s", 0, 0]})[-1]


def test_a_record_has_all_that_determines_the_numbers():
    """What is added to a spec or to its starts must be recorded: the store of a sweep is read by this record."""
    refine = Refinement(1, 0.1)
    spec = SweepSpec(system="kovalevskaya", axes=(Axis("epsilon", (0.0, 1.0)),), t_end=9.0, refine=refine)
    record = spec.record()
    # The name changes no value that is stored.
    assert {field.name for field in fields(SweepSpec)} - {"name"} == record.keys() - {"version"}
    assert {field.name for field in fields(Starts)} == record["starts"].keys()
    assert {field.name for field in fields(Axis)} - {"label"} == record["axes"][0].keys()
    assert {field.name for field in fields(Refinement)} == record["refine"].keys() - {"by"}


@pytest.mark.parametrize("name", ["energy", "C1", "C3"])
def test_an_axis_of_the_starts_sets_them_though_a_formula_uses_it(name):
    for starts in (Starts(), Starts(casimirs={"C2": f"{name}/10"}), Starts(casimirs={"C2": 0.1})):
        spec = SweepSpec(
            system="twisted-top",
            axes=(Axis(name, (0.5, 1.0)),),
            t_end=10.0,
            parameters={**KOVALEVSKAYA, "epsilon": f"1 + {name}"},
            starts=starts,
        )
        found = targets(spec)
        values = found.energy if name == "energy" else found.casimirs[name]
        np.testing.assert_array_equal(values, [0.5, 1.0])
        np.testing.assert_array_equal(found.parameters["epsilon"], [1.5, 2.0])


@pytest.mark.parametrize(
    ("name", "starts", "message"),
    [
        ("C1", Starts(casimirs={"C1": "2*C1"}), "axis C1: this Casimir of the starts has another value"),
        ("energy", Starts(energy="2*energy"), "axis energy: the energy of the starts has another value"),
        ("H", Starts(), "axis H: nothing depends on it. Call it energy"),
        ("C4", Starts(energy="C4"), "C1, C2, C3; got C4"),
    ],
)
def test_an_axis_that_would_be_two_things_or_none_is_refused(name, starts, message):
    given = {"parameters": {**KOVALEVSKAYA, "epsilon": 1}, "starts": starts, "t_end": 1.0, "n_starts": 1}
    with pytest.raises(ParameterError, match=message):
        lp.sweep(system="twisted-top", axes={name: [0.5, 1.0]}, **given)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ([1j, 1.0, 2.0], "quantity: wanted real numbers; got an array of complex128"),
        ([None, 1.0, 2.0], "quantity: wanted an array of numbers"),
        (None, "quantity: wanted"),
        (np.array(["1", "2", "3"]), "quantity: wanted"),
        (1.5, r"quantity: wanted a number for each of 3 starts; got shape \(\)"),
        ([1.0, 2.0], r"quantity: wanted a number for each of 3 starts; got shape \(2,\)"),
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


def test_values_of_an_axis_may_be_exact():
    assert lp.sweeps.Axis("epsilon", ("1/3", 1, "sqrt(2)")).values == (1 / 3, 1.0, 2**0.5)
    assert lp.sweeps.Axis.linear("epsilon", "-1/2", "1/2", 3).values == (-0.5, 0.0, 0.5)
