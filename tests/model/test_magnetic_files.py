"""Files of brackets in magnetic fields: they keep the field, and what is decided is its divergence."""

import pickle

import pytest

import liepoisson as lp
from liepoisson.errors import SystemFileError
from liepoisson.model.system_file_reader import parse_system_file
from liepoisson.model.system_text import read_system_text, system_text

BOTTLE = ["-x*z/4", "-y*z/4", "1 + z^2/4"]
WAVY = ["0", "sin(z)", "b + exp(x)"]
CENTRE, CHARGE = "u^2/2 + mu*z", "(v_x^2 + v_y^2 + v_z^2)/2"
made = lp.brackets


def written_out(bracket):
    x, _, _, u = bracket.variables
    return lp.System(bracket, u**2 / 2 + x)


SYSTEMS = {
    "bottle": lambda: lp.System(made.guiding_centre(BOTTLE, charge=40), CENTRE, {"mu": 2}),
    "wavy": lambda: lp.System(made.guiding_centre(WAVY, charge="q", symbols=["b", "q"]), CENTRE,
                              {"mu": 2, "b": 3, "q": 2}),
    "written out": lambda: written_out(made.guiding_centre(WAVY, mass="m", symbols=["b", "m"])),
    "charge": lambda: lp.System(made.magnetic(BOTTLE, charge="1/3", mass=2), CHARGE),
    "plane": lambda: lp.System(made.magnetic(["1 + exp(x)"]), "v_x^2 + v_y^2"),
    "driven": lambda: lp.System(made.magnetic(["w"], symbols=["w"]), "v_x^2 + v_y^2 + x*cos(w*t)", {"w": 2},
                                period="2*pi/w"),
    "angle": lambda: lp.System(made.magnetic(["1 + cos(x)"]).with_angles(["x"]), "v_x^2 + v_y^2"),
    "renamed": lambda: lp.System(made.guiding_centre(["0", "0", "1 + y"]).rename("X", "Y", "Z", "v"), "v^2/2"),
}  # fmt: skip


@pytest.mark.parametrize("name", SYSTEMS)
def test_what_is_read_back_is_the_same_and_the_tensor_is_not_decided_again(name, monkeypatch):
    system = SYSTEMS[name]()
    with monkeypatch.context() as patch:
        patch.setattr(lp.PoissonTensor, "jacobi_certificate", None)
        text = system_text(system)
        again = read_system_text(text)
    assert "tensor" not in text
    assert again.component_names == system.component_names
    assert again.bracket.poisson_tensor() == system.bracket.poisson_tensor()
    assert again.bracket.jacobi == system.bracket.jacobi
    assert again.bracket.angles == system.bracket.angles
    assert again.hamiltonian == system.hamiltonian


def test_copies_keep_the_field_and_other_coordinates_do_not():
    bracket = made.guiding_centre(WAVY, symbols=["b"])
    fixed = pickle.loads(pickle.dumps(bracket)).substitute({"b": 2})
    assert fixed.origin == made.guiding_centre([*WAVY[:2], "2 + exp(x)"]).origin
    assert bracket.with_casimirs([]).origin == bracket.origin
    there = {"X": "x + y", "y": "y", "v_x": "v_x", "v_y": "v_y"}
    back = {"x": "X - y", "y": "y", "v_x": "v_x", "v_y": "v_y"}
    assert made.magnetic(["1"]).in_variables(there, back).origin is None


def test_a_field_that_comes_to_lie_along_an_axis_is_written_by_its_tensor():
    """|B| = sqrt(k^2 + 1) becomes 1, b = -e_z; made of (0, 0, -1) alone the bracket would have b = e_z."""
    turned = made.guiding_centre(["k", "0", "-1"], symbols=["k"]).substitute({"k": 0})
    x, y, z, u = turned.variables
    assert (turned(x, y), turned(z, u)) == (1, -1)
    assert made.guiding_centre(["0", "0", "-1"])(z, u) == 1
    again = read_system_text(system_text(lp.System(turned, "u^2/2 + x"))).bracket
    assert again.poisson_tensor() == turned.poisson_tensor()


FIELD = 'guiding_centre = ["-x*z/4", "-y*z/4", "1 + z^2/4"]'
REFUSED = {
    "a tensor beside the field": (f'{FIELD}\ntensor.x.y = "1"', "tensor.*guiding_centre is given by"),
    "an algebra beside it": (f'{FIELD}\nalgebra = "so(3)"', "algebra"),
    "two fields": (f'{FIELD}\nmagnetic = ["0", "0", "1"]', "exclude each other"),
    "a divergence": ('guiding_centre = ["x", "0", "1"]', "guiding_centre.*div B"),
    "a divergence for a charge": ('magnetic = ["x", "0", "1"]', "magnetic.*div B"),
    "one formula": ('magnetic = "1"', "magnetic.*three formulas"),
    "a wrong name": ('magnetic = ["0", "0", "k"]', "magnetic.*k"),
    "no mass": (f"{FIELD}\nmass = 0", "mass: wanted a positive number; got 0"),
    "a charge without a field": ('algebra = "so(3)"\ncharge = 2', "charge.*only a bracket"),
    "a false Casimir": (f'{FIELD}\ncasimirs = ["x"]', "casimirs"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_what_contradicts_itself_is_refused(case):
    table, words = REFUSED[case]
    with pytest.raises(SystemFileError, match=words):
        parse_system_file(f'[bracket]\n{table}\n[hamiltonian]\nexpression = "1"\n')


def test_a_tensor_by_hand_is_still_decided():
    """That of B = (0, 0, 1 + z) for a charge: div B = 1."""
    rows = 'tensor.x.v_x = 1\ntensor.y.v_y = 1\ntensor.z.v_z = 1\ntensor.v_x.v_y = "1 + z"'
    names = 'variables = ["x", "y", "z", "v_x", "v_y", "v_z"]'
    with pytest.raises(SystemFileError, match="Jacobi"):
        parse_system_file(f'[bracket]\n{names}\n{rows}\n[hamiltonian]\nexpression = "v_x"\n')
