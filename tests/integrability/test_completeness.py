"""Enough integrals: commuting ones, or closed ones by the theorem of Mishchenko and Fomenko."""

import pytest

import liepoisson as lp
from liepoisson.integrability.completeness import (
    are_integrals,
    closed_integrals,
    commuting_integrals,
)

SPACE = lp.canonical(names=("x", "y", "z"))
KEPLER = lp.System(SPACE, "(p_x^2 + p_y^2 + p_z^2)/2 - k/sqrt(x^2 + y^2 + z^2)", symbols=["k"], name="Kepler")
ROTATIONS = {"L1": "y*p_z - z*p_y", "L2": "z*p_x - x*p_z", "L3": "x*p_y - y*p_x"}


def functions(system, texts):
    return {"H": system.hamiltonian} | {name: system.expression(text) for name, text in texts.items()}


def test_rotations_close_and_are_enough():
    found = closed_integrals(KEPLER, functions(KEPLER, ROTATIONS), 6)
    assert (found.names, found.corank) == (("H", "L1", "L2", "L3"), 2)
    assert {pair: str(value) for pair, value in found.brackets.items()} == {
        ("L1", "L2"): "L3", ("L1", "L3"): "-L2", ("L2", "L3"): "L1",
    }  # fmt: skip


@pytest.mark.parametrize(
    ("left_out", "names"), [((), ("H", "L1", "L2", "L3")), (("L3",), None), (("H",), None), (("L1", "L2", "L3"), None)]
)
def test_too_few_are_not_enough(left_out, names):
    integrals = {name: f for name, f in functions(KEPLER, ROTATIONS).items() if name not in left_out}
    found = closed_integrals(KEPLER, integrals, 6)
    assert (found and found.names) == names


def test_commuting_integrals_are_the_case_of_full_corank():
    system = lp.catalog.system("clebsch")
    integrals = {"H": system.hamiltonian, **system.integrals}
    assert commuting_integrals(system, integrals, 4) == ("H", "K")
    found = closed_integrals(system, integrals, 4)
    assert (found.corank, found.brackets) == (2, {})


def test_functions_that_do_not_commute_are_not_taken():
    system = lp.System(SPACE, "(p_x^2 + p_y^2 + p_z^2)/2 + (x^2 + y^2 + z^2)^2")
    integrals = functions(system, ROTATIONS)
    assert commuting_integrals(system, integrals, 6) == ()
    squared = integrals | {"L": system.expression("(y*p_z - z*p_y)^2 + (z*p_x - x*p_z)^2 + (x*p_y - y*p_x)^2")}
    assert len(commuting_integrals(system, squared, 6)) == 3
    assert are_integrals(system, [system.expression("x"), *integrals.values()]) == [False, True, True, True, True]


LINE = "p1^2/2 + p2^2/2 + p3^2/2 + "
DIFFERENCES = ("q1 - q2", "q2 - q3", "q3 - q1")


@pytest.mark.parametrize(
    "potential",
    [
        "exp(q1 - q2) + exp(q2 - q3)",  # the open Toda lattice
        "cosh(q1 - q2) + sinh(q1 - q2) + exp(q2 - q3)",  # the open lattice, written in another way
        " + ".join(f"1/sinh({f})^2" for f in DIFFERENCES),  # Calogero and Sutherland
    ],
)
def test_exponentials_of_differences_are_integrable_however_they_are_written(potential):
    """Three integrals in involution of degrees 1, 2, 3, whose fields have rank 3."""
    found = lp.integrability.integrability_report(lp.System(lp.canonical(3), LINE + potential), degree=3)
    assert found.verdict == "integrable"
    assert len(found.commuting) == 3
