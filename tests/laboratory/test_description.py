"""Descriptions of systems: all numbers are read back exactly, and what a system does not have is None."""

import json

import pytest

import liepoisson as lp
from liepoisson.compile.field import TapeField, TapeFunction, field_of
from liepoisson.laboratory.description import description_of


def read_back(description):
    return json.loads(json.dumps(description, allow_nan=False))


@pytest.mark.parametrize(
    "system",
    [lp.Top.twisted_kovalevskaya(epsilon="1/3"), lp.catalog.system("henon-heiles"), lp.catalog.toda(3)],
    ids=lambda system: system.name,
)
def test_the_field_is_read_back_as_it_was(system):
    description = read_back(description_of(system))
    assert field_of(description["field"]) == system.field()
    assert description["components"] == list(system.component_names)


def test_invariants_have_their_names_and_their_functions():
    top = lp.Top.twisted_kovalevskaya()
    invariants = read_back(description_of(top))["invariants"]
    assert invariants["names"] == ["H", "C1", "C2", "C3"]
    tape = top.function_tape(*(top.invariants[name] for name in invariants["names"]))
    functions = invariants["functions"]
    assert TapeFunction(functions["n_components"], functions["instructions"], functions["outputs"]) == tape


def test_a_field_alone_has_no_invariants():
    field = TapeField(2, (("sin", (0,), ()),), (1, 2))
    description = read_back(description_of(field))
    assert (description["invariants"], description["pieces"]) == (None, None)
    assert description["components"] == ["x1", "x2"]
