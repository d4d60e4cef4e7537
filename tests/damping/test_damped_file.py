"""Files of damped systems: read, written, saved with results, swept."""

import numpy as np
import pytest
import sympy

import liepoisson as lp
from liepoisson.errors import SystemFileError

TEXT = """
name = "damped top"
[bracket]
algebra = "so(3)"
extension = "semidirect(2)"
[parameters]
I = [2, 1.5, 1]
a = [0.6, 0, 0.8]
gamma = 0.1
[hamiltonian]
expression = "dot(l, inv(I)*l)/2 + dot(a, alpha)"
[integrals]
E = "dot(l, inv(I)*l)/2 + dot(a, alpha) + dot(alpha, alpha)"
[damping]
kind = "double bracket"
rate = "gamma"
"""
TOP = lp.catalog.system("heavy-top")
EULER = lp.catalog.euler_top_on("so(3)", [1, 2, 3])
START = {"l": (1, 0, 1), "alpha": (0.6, 0, 0.8)}
double, metriplectic = lp.dissipation.double_bracket, lp.dissipation.metriplectic
SYSTEMS = {
    "parameters": double(TOP, "g*l1^2", metric=[1, 1, "k", 2, 2, 0], parameters={"g": "1/10", "k": 3}),
    "a top": double(lp.Top.kovalevskaya(epsilon=1), 0.1, metric=np.eye(9)),
    "killing": double(EULER, "1/3", metric="killing"),
    "entropy": metriplectic(TOP, "k*dot(l, alpha)", "k", parameters={"k": 2}),
    "forms": metriplectic(EULER, "C1", forms=([1, 1, 1], sympy.eye(3))),
    "matrix": metriplectic(EULER, "C1", matrix=[["l2^2/4 + l3^2/9", "-l1*l2/2", "-l1*l3/3"],
        ["-l1*l2/2", "l1^2 + l3^2/9", "-l2*l3/6"], ["-l1*l3/3", "-l2*l3/6", "l1^2 + l2^2/4"]]),
    "a vector of symbols": double(EULER, "c1^2 + c2^2", symbols=["c[2]"]),
    "symbols": double(lp.System(lp.canonical(1), "dot(p, p)/2 - cos(q1)"), "c", symbols=["c"], metric=[1, 0]),
}  # fmt: skip


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "top.toml"
    path.write_text(TEXT)
    return path


def test_a_file_is_read(file):
    found = lp.read_system(file)
    wanted = double(TOP, "1/10")
    assert found.equations == wanted.equations
    assert [*found.invariants] == ["C1", "C2"]  # E is none with damping
    assert found.name == "damped top"
    assert found.parameters["gamma"] == sympy.Rational(1, 10)


@pytest.mark.parametrize("system", SYSTEMS.values(), ids=[*SYSTEMS])
def test_what_is_written_is_read_back(system, tmp_path):
    found = lp.read_system(lp.systems.write_system(system, tmp_path / "damped.toml"))
    assert (found.equations, found.parameters, found.laws) == (system.equations, system.parameters, system.laws)
    assert (found.name, found.text) == (system.name, system.text)


def test_a_saved_orbit_knows_the_damped_system(tmp_path):
    system = SYSTEMS["parameters"]
    orbit = lp.integrate(system, START, t_end=1)
    orbit.save(tmp_path / "orbit.nc")
    found = lp.load(tmp_path / "orbit.nc")
    assert isinstance(found.system, lp.dissipation.DampedSystem)
    assert (found.monotone["H"] == orbit.monotone["H"]).all()
    assert (lp.rerun(tmp_path / "orbit.nc").end_state == orbit.end_state).all()


def test_the_rate_is_swept(file, tmp_path):
    (tmp_path / "sweep.toml").write_text(
        'system = "top.toml"\nt_end = 20\nn_starts = 2\n[[axes]]\nname = "gamma"\nvalues = [0.1, 1]\n'
    )
    result = lp.sweeps.sweep(tmp_path / "sweep.toml")
    for rate, exponents in zip((0.1, 1), result.value, strict=True):
        one = double(TOP, rate)
        starts = lp.sample_states(one, 2, seed=result.spec.seed)
        alone = lp.finite_time_exponents(one, starts, t_end=20, seed=result.spec.seed, method=lp.Taylor(tol=1e-9))
        np.testing.assert_allclose(exponents, alone.exponent[:, -1], rtol=1e-9)


WRONG = {
    "kind": ('kind = "double bracket"', 'kind = "friction"', "wanted one of double bracket, metriplectic"),
    "no kind": ('kind = "double bracket"', "", "wanted one of double bracket, metriplectic"),
    "key": ("rate =", "speed =", "the key is unknown"),
    "rate": ("gamma = 0.1", "gamma = -0.1", "never negative"),
    "name": ('rate = "gamma"', 'rate = "gama"', "gama"),
    "unused": ('rate = "gamma"', "rate = 1", "gamma occurs neither"),
    "entropy": ('rate = "gamma"', 'rate = "gamma"\nentropy = "C1"', "a double bracket has none"),
    "no entropy": ('kind = "double bracket"', 'kind = "metriplectic"', "wanted the key entropy"),
    "no Casimir": ('kind = "double bracket"', 'kind = "metriplectic"\nentropy = "l1"', "wanted a Casimir"),
    "two brackets": (
        'kind = "double bracket"',
        'kind = "metriplectic"\nentropy = "C1"\nmetric = [1, 1, 1, 1, 1, 1]\nmatrix = [0, 0, 0, 0, 0, 0]',
        "leave one",
    ),
    "metric": ('rate = "gamma"', 'rate = "gamma"\nmetric = [1, 1]', "6 entries"),
}


@pytest.mark.parametrize(("old", "new", "words"), WRONG.values(), ids=[*WRONG])
def test_what_is_wrong_is_said_with_its_place(old, new, words, tmp_path):
    assert old in TEXT
    path = tmp_path / "wrong.toml"
    path.write_text(TEXT.replace(old, new))
    with pytest.raises(SystemFileError) as caught:
        lp.read_system(path)
    assert words in str(caught.value)
    assert "wrong.toml, line " in str(caught.value)


def test_where_a_system_without_damping_is_wanted_the_table_is_named(file):
    with pytest.raises(SystemFileError, match="wanted a system without damping"):
        lp.systems.read_system_file(file)
