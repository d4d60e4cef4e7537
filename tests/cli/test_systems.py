"""The argument SYSTEM and the option --set."""

from fractions import Fraction

import pytest

from liepoisson.cli.systems import read_file, read_numeric_system, read_system
from liepoisson.errors import MissingFileError, ParameterError, UnknownNameError


def test_a_name_means_the_catalog_and_a_path_a_file(tmp_path, monkeypatch):
    path = tmp_path / "lagrange"
    path.write_text('[bracket]\nalgebra = "so(3)"\nvariables = ["l"]\n[hamiltonian]\nexpression = "l1^2"\n')
    assert read_file("lagrange").source.startswith("J.-L. Lagrange")
    assert read_file(str(path)).bracket.dimension == 3
    monkeypatch.chdir(tmp_path)
    assert read_file("lagrange").bracket.dimension == 3  # a file of this very name comes first
    with pytest.raises(MissingFileError):
        read_file("heavy-top.toml")
    with pytest.raises(UnknownNameError, match="heavy-top"):
        read_file("heavy-topp")


def test_settings_give_exact_values_and_may_override():
    system = read_system("twisted-kovalevskaya", ["epsilon=0.1", "I=[4, 4, sqrt(4)]", "a = 1/3,0,0"])
    assert system.parameters["epsilon"] == Fraction(1, 10)
    assert system.top_parameters.inertia == (4, 4, 2)
    assert system.top_parameters.a == (Fraction(1, 3), 0, 0)


def test_the_name_of_a_system_to_compute_with_says_what_was_set():
    assert read_numeric_system("twisted-kovalevskaya", []).name == "twisted-kovalevskaya"
    changed = read_numeric_system("twisted-kovalevskaya", ["epsilon = 1/3", "a=[1,0, sqrt(2)]"])
    assert changed.name == "twisted-kovalevskaya, epsilon = 1/3, a = (1, 0, sqrt(2))"


def test_an_integral_of_other_values_is_left_out_where_one_computes_and_refuted_where_one_inspects():
    assert list(read_numeric_system("kovalevskaya", ["I=1,2,3"]).invariants) == ["H", "C1", "C2"]
    assert "K" in read_numeric_system("manakov-so4", ["J=1,2,3,7/2"]).invariants
    assert "K" in read_system("kovalevskaya", ["I=1,2,3"]).integrals


@pytest.mark.parametrize("setting", ["epsilon=1e-400", "a=1,0,1e-400"])
def test_numbers_below_all_doubles_are_exact_but_no_numbers_to_compute_with(setting):
    assert read_system("twisted-kovalevskaya", [setting]).top_parameters is not None
    with pytest.raises(ParameterError, match=r"(epsilon|a3) must be zero or at least 4.9e-324"):
        read_numeric_system("twisted-kovalevskaya", [setting])


@pytest.mark.filterwarnings("default::liepoisson.errors.InertiaWarning")
def test_moments_that_no_body_has_are_said_in_one_sentence(command):
    code, _, err = command("inspect", "heavy-top", "--set", "I=1,4/5,5/2")
    assert code == 0
    assert err == (
        "liepoisson: a rigid body has moments with I3 at most the sum of the other two; got I3 = 5/2 and 1, 4/5. The "
        "equations are integrated as they stand.\n"
    )
