"""Systems with noise as files: read, written, run, saved; refusals with their places."""

from fractions import Fraction

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import ParameterError, SystemFileError
from liepoisson.stochastic import NoisySystem, noisy_orbits, read_noisy_system

BODY = lp.catalog.euler_top_on("so(3)", [1, 2, 3])
X = [0.48, 0.6, 0.64]
TOP = lp.catalog.system("heavy-top")
SYSTEMS = {
    "one": NoisySystem(BODY, "l1/2"),
    "damped": NoisySystem(BODY, ["(l1 + 2*l3)^2", "l2"], "1/3"),
    "of parameters": NoisySystem(TOP, ["alpha1 + alpha2^2", "a1*l3"], 0.1),
    "no noise": NoisySystem(BODY, []),
    "of amplitude zero": NoisySystem(BODY, ["l1/2", "0"], 2),
    "irrational": NoisySystem(BODY, "sqrt(2)*l1", "sqrt(3)"),
}


def test_a_file_is_read_with_the_values_of_its_parameters(shaken_body):
    found = read_noisy_system(shaken_body)
    assert (found.name, found.noises, found.inverse_temperature) == ("shaken body", ("l1/4", "l2/4", "l3/4"), 2)
    assert isinstance(found.inverse_temperature, Fraction)
    assert found.system.equations == BODY.equations
    options = {"t_end": 1, "seed": 7, "method": lp.Splitting(0.1)}
    alone = noisy_orbits(BODY, X, noises=["l1/4", "l2/4", "l3/4"], inverse_temperature=2, **options)
    assert (noisy_orbits(found.system, X, **found.noise, **options).state == alone.state).all()


@pytest.mark.parametrize("noisy", SYSTEMS.values(), ids=[*SYSTEMS])
def test_what_is_written_is_read_back(noisy, tmp_path):
    found = read_noisy_system(lp.systems.write_system(noisy, tmp_path / "noisy.toml"))
    assert (found.noises, found.inverse_temperature) == (noisy.noises, noisy.inverse_temperature)
    assert (found.name, found.system.text) == (noisy.name, noisy.system.text)


def test_a_saved_orbit_knows_its_noise_and_seed(shaken_body, tmp_path):
    noisy = read_noisy_system(shaken_body)
    run = noisy_orbits(noisy.system, X, **noisy.noise, t_end=1, seed=7, method=lp.Splitting(0.1))
    path = run.save(tmp_path / "orbit.nc")
    found = lp.load(path)
    assert (found.noises, found.seed, found.inverse_temperature) == (noisy.noises, 7, 2)
    assert np.array_equal(lp.rerun(path).state, run.state)


WRONG = {
    "key": ("noises =", "noisses =", "the key is unknown; known are noises, inverse_temperature. Did you mean noises"),
    "no noises": ('noises = ["s*l1", "s*l2", "s*l3"]', "", "wanted the key noises"),
    "a number": ('"s*l1"', "1", "wanted a text in quotes"),
    "a name": ('"s*l1"', '"s*m1"', "m1"),
    "grammar": ('"s*l1"', '"s*l1*"', "column 6 of the formula"),
    "no exact flow": ('"s*l1"', '"s*l1*l2"', "has no exact flow"),
    "a Casimir": ('"s*l1"', '"s"', "move something"),
    "unused": ('"s*l1", "s*l2", "s*l3"', '"l1"', "s occurs neither"),
    "negative": ('"beta"', '"-beta"', "a number >= 0"),
    "no number": ('"beta"', '"beta*l1"', "inverse_temperature"),
    "a list": ('"beta"', "[1]", "wanted one number or formula"),
    "no value": ("s = 0.25", 'symbols = ["s"]', "needs numbers for all parameters; got none for s"),
    "damping": ("[noise]", '[damping]\nkind = "double bracket"\n[noise]', "noise has its own damping"),
}


@pytest.mark.parametrize(("old", "new", "words"), WRONG.values(), ids=[*WRONG])
def test_what_is_wrong_is_said_with_its_place(old, new, words, shaken_body):
    text = shaken_body.read_text()
    assert old in text
    path = shaken_body.with_name("wrong.toml")
    path.write_text(text.replace(old, new))
    with pytest.raises(SystemFileError) as caught:
        read_noisy_system(path)
    assert words in str(caught.value)
    assert "wrong.toml, line " in str(caught.value)


def test_where_a_system_without_noise_is_wanted_the_table_is_named(shaken_body):
    for read in (lp.read_system, lp.systems.read_system_file):
        with pytest.raises(SystemFileError, match=r"line 11: noise: wanted a system without noise"):
            read(shaken_body)


def test_a_file_without_noise_is_not_noisy():
    with pytest.raises(SystemFileError, match=r"wanted the table \[noise\]"):
        read_noisy_system(lp.catalog.path("lagrange"))


def test_a_vector_field_has_no_noise(tmp_path):
    path = tmp_path / "field.toml"
    path.write_text('[equations]\nx = "-x"\n[noise]\nnoises = ["x"]\n')
    with pytest.raises(SystemFileError, match="a vector field has none"):
        lp.read_system(path)
    with pytest.raises(SystemFileError, match="A vector field has no bracket"):
        read_noisy_system(path)
    with pytest.raises(ParameterError):
        NoisySystem(lp.VectorField({"x": "-x"}), "x")
