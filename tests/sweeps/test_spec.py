"""What a sweep is: axes, formulas, files, and what is refused."""

import json
from dataclasses import fields
from fractions import Fraction

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.sweeps.family import as_family
from liepoisson.sweeps.points import Lattice, evaluate_targets
from liepoisson.sweeps.spec import Axis, Refinement, Starts, SweepSpec

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


def test_functions_are_families():
    spec = SweepSpec(system=lp.Top.kovalevskaya, axes=(Axis("epsilon", (0.0, 1.0)),), t_end=1000.0)
    assert targets(spec).parameters["epsilon"].tolist() == [0, 1]
    assert as_family(lp.Top.kovalevskaya).system({"epsilon": 0.5}).epsilon == Fraction(1, 2)


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
    assert SweepSpec(**base, name="other").fingerprint() == prints[0]
    json.dumps(SweepSpec(**base).record())


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
    assert held(["C1"], {"epsilon": "C1"})[0] == "of the starts: nothing but what the axes say"
    assert "epsilon |beta|" in held(["s"], {"epsilon": "s"})[-1]
    assert "epsilon |beta|" not in held(["s"], {"epsilon": 1, "b": ["s", 0, 0]})[-1]
    assert "same state" in held(["s"], {"epsilon": "s"})[0]
    assert held(["energy"], {"epsilon": 1}, casimirs={"C1": "energy", "C3": 1})[1] == "of the starts: C3 = 1"
    assert held(["b1"], {"a": [1, 0, 0], "b": [0, 0, 2]})[0] == "parameters: a = (1, 0, 0), b2 = 0, b3 = 2"
    assert held(["s"], {"b": ["s", 0, 3]})[0] == "parameters: b2 = 0, b3 = 3"


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


def test_values_of_an_axis_may_be_exact():
    assert lp.sweeps.Axis("epsilon", ("1/3", 1, "sqrt(2)")).values == (1 / 3, 1.0, 2**0.5)
    assert lp.sweeps.Axis.linear("epsilon", "-1/2", "1/2", 3).values == (-0.5, 0.0, 0.5)
