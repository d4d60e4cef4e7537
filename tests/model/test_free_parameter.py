"""A parameter that varies: numbers, components of vectors and matrices, of systems and tops."""

import pytest

import liepoisson as lp
from liepoisson.model.free_parameter import FreeParameter, with_values

MATRIX = lp.System(lp.so(3) @ lp.leibniz(3, "epsilon"), "dot(l, M*l)/2 + dot(a, alpha)",
    {"epsilon": 1, "M": [[1, 0, 0], [0, 2, 0], [0, 0, 3]], "a": [0, 0, 1]})  # fmt: skip


@pytest.mark.parametrize(("name", "value"), [("epsilon", 1), ("M22", 2), ("a3", 1)])
def test_one_number_changes(name, value):
    variable = FreeParameter(MATRIX, name)
    assert variable.value == value
    assert variable.at(value).equations == MATRIX.equations
    assert variable.at("1/7").parameters == {
        **MATRIX.parameters,
        name: lp.System(lp.canonical(1), "k*q1^2 + p1^2", {"k": "1/7"}).parameters["k"],
    }
    assert {str(s) for s in variable.symbolic.hamiltonian.free_symbols} - {*MATRIX.component_names} <= {name}


@pytest.mark.parametrize("name", ["I1", "a3", "b2", "epsilon"])
def test_parameters_of_tops_have_the_names_of_the_paper(name):
    top = lp.Top(inertia=(1, 2, 2), a=(0, 0, 1), b=(0, 3, 0), epsilon=1)
    variable = FreeParameter(top, name)
    assert variable.at(variable.value).equations == top.equations
    assert isinstance(variable.symbolic, lp.Top)
    assert variable.symbolic.top_parameters.symbols == {name}


def test_parameters_of_a_drive_and_of_a_vector_field_change_and_time_goes_on():
    drive = lp.System(lp.canonical(1), "p1^2/2 + k*q1^2/2 - F*q1*cos(w*t)", {"k": 2, "F": 1, "w": 3}, period="2*pi/w")
    assert with_values(drive, {"k": 2}).equations == drive.equations
    assert FreeParameter(drive, "w").symbolic.equations[drive.variables[2]] == 1
    by_expression = lp.System(drive.bracket.base, drive.hamiltonian - drive.variables[3])
    assert with_values(by_expression, {}).equations == drive.equations
    field = lp.VectorField({"x": "k*y", "y": "-a2*x", "th": "1"}, {"k": 2, "a": [1, 3]}, angles=["th"])
    other = with_values(field, {"a2": "1/2"})
    assert (other.parameters["a2"], other.parameters["k"], other.angles) == (lp.systems.System(
        lp.canonical(1), "c*p1^2", {"c": "1/2"}).parameters["c"], 2, ("th",))  # fmt: skip
