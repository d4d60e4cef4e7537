"""Enough integrals: commuting ones, or closed ones by the theorem of Mishchenko and Fomenko."""

import pytest

import liepoisson as lp
from liepoisson.integrability.completeness import (
    are_integrals,
    closed_integrals,
    commuting_integrals,
    fields_rank,
)

SPACE = lp.canonical(names=("x", "y", "z"))
KEPLER = lp.System(SPACE, "(p_x^2 + p_y^2 + p_z^2)/2 - k/sqrt(x^2 + y^2 + z^2)", symbols=["k"], name="Kepler")
ROTATIONS = {"L1": "y*p_z - z*p_y", "L2": "z*p_x - x*p_z", "L3": "x*p_y - y*p_x"}
RUNGE_LENZ = "p_y*L3 - p_z*L2 - k*x/sqrt(x^2 + y^2 + z^2)"


def functions(system, texts):
    return {"H": system.hamiltonian} | {name: system.expression(text) for name, text in texts.items()}


def test_rotations_close_and_are_enough():
    found = closed_integrals(KEPLER, functions(KEPLER, ROTATIONS), 6)
    assert (found.names, found.corank) == (("H", "L1", "L2", "L3"), 2)
    assert {pair: str(value) for pair, value in found.brackets.items()} == {
        ("L1", "L2"): "L3", ("L1", "L3"): "-L2", ("L2", "L3"): "L1",
    }  # fmt: skip


def test_the_runge_lenz_vector_closes_with_the_energy_and_rotations():
    texts = ROTATIONS | {"A1": RUNGE_LENZ.replace("L3", "(x*p_y - y*p_x)").replace("L2", "(z*p_x - x*p_z)")}
    integrals = functions(KEPLER, texts)
    assert all(are_integrals(KEPLER, list(integrals.values())))
    assert closed_integrals(KEPLER, integrals, 6) is None  # the other components are missing
    flat = lp.System(lp.canonical(names=("x", "y")), "(p_x^2 + p_y^2)/2 - 1/sqrt(x^2 + y^2)")
    planar = functions(
        flat,
        {"L": "x*p_y - y*p_x", "A1": "p_y*(x*p_y - y*p_x) - x/sqrt(x^2 + y^2)"},
    )
    other = {"A2": flat.expression("-p_x*(x*p_y - y*p_x) - y/sqrt(x^2 + y^2)")}
    assert closed_integrals(flat, planar, 4) is None
    assert closed_integrals(flat, planar | other, 4) is None  # four functions with three independent ones
    assert fields_rank(flat, list((planar | other).values())) == 3


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


def test_brackets_with_a_power_of_pi_are_numbers():
    system = lp.catalog.system("zeitlin-3")
    assert fields_rank(system, [system.hamiltonian]) == 1
    assert fields_rank(system, list(system.variables)) == 6


LINE = "p1^2/2 + p2^2/2 + p3^2/2 + "
DIFFERENCES = ("q1 - q2", "q2 - q3", "q3 - q1")


@pytest.mark.parametrize(
    "potential",
    [
        "exp(q1 - q2) + exp(q2 - q3)",  # the open Toda lattice
        "exp(q2 - q1) + exp(q3 - q2)",
        "exp(q2 - q1) + exp(q3 - q2) + exp(q1 - q3)",  # the ring
        "cosh(q1 - q2) + sinh(q1 - q2) + exp(q2 - q3)",  # the open lattice, written in another way
        " + ".join(f"1/sinh({f})^2" for f in DIFFERENCES),  # Calogero and Sutherland
        " + ".join(f"1/sin({f})^2" for f in DIFFERENCES),
    ],
)
def test_exponentials_of_differences_are_integrable_however_they_are_written(potential):
    """Three integrals in involution of degrees 1, 2, 3, whose fields have rank 3."""
    found = lp.integrability.integrability_report(lp.System(lp.canonical(3), LINE + potential), degree=3)
    assert found.verdict == "integrable"
    assert len(found.commuting) == 3


def test_ranks_do_not_depend_on_how_exponentials_are_written():
    system = lp.System(lp.canonical(3), LINE + "exp(q1 - q2) + exp(q2 - q3)")
    momentum, third = "p1 + p2 + p3", "p1*p2*p3 - exp(q2 - q3)*p1 - exp(q1 - q2)*p3"
    split = "p1*p2*p3 - exp(q2)*exp(-q3)*p1 - exp(q1)*exp(-q2)*p3"
    integrals = [system.hamiltonian, *map(system.expression, (momentum, third))]
    assert fields_rank(system, integrals) == 3
    assert fields_rank(system, [*integrals, system.expression(split)]) == 3  # the last one is the third once more
    assert fields_rank(system, [system.expression(third), system.expression(split)]) == 1
