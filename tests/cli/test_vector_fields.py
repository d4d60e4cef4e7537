"""Commands that follow orbits, and sweeps, of a file with equations in the place of bracket and Hamiltonian."""

import re

import numpy as np
import pytest

import liepoisson as lp

RATES = {"x": "sigma*(y - x)", "y": "x*(rho - z) - y", "z": "x*y - beta*z"}
LORENZ = lp.VectorField(RATES, {"sigma": 10, "rho": 28, "beta": "8/3"}, name="Lorenz")
TURNS = lp.VectorField(
    {"x": "k*y", "y": "-x"}, {"k": 1}, name="turns", integrals={"R": "x^2 + y^2", "S": "x^2 + k*y^2"}
)


@pytest.fixture
def lorenz(tmp_path):
    return lp.systems.write_system(LORENZ, tmp_path / "lorenz.toml")


def test_an_orbit_is_that_of_python_and_integrals_that_others_had_are_left_out(command, tmp_path):
    file, path = lp.systems.write_system(TURNS, tmp_path / "turns.toml"), tmp_path / "orbit.nc"
    _, out, _ = command("orbit", file, "--start", "1,0", "--set", "k=4", "--t-end", 3, "--points", 4, "--out", path)
    assert out.startswith(
        "turns, k = 4: one orbit to t = 3, 4 points\nstart    as given\n  x      1\n  y      0\nmethod "
    )
    assert re.findall(r"^  ([RS])  .e-", out, re.MULTILINE) == ["S"]  # x' = 4 y, y' = -x: x^2 + 4 y^2 alone
    np.testing.assert_allclose(lp.load(path).state[0, :, 0], np.cos(2 * np.arange(4)), atol=1e-14)


def test_a_random_start_is_trajectory_0_and_no_integral_has_no_drift(command, lorenz, tmp_path):
    path = tmp_path / "orbit.nc"
    _, out, _ = command("orbit", lorenz, "--t-end", 1, "--seed", 3, "--out", path)
    assert "trajectory 0 of unit-vectors, seed 3" in out
    assert "drift    no integral is known" in out
    np.testing.assert_array_equal(lp.load(path).state[0, 0], lp.sample_states(LORENZ, 1, seed=3)[0])


def test_crossings_are_those_of_python(command, lorenz, tmp_path):
    path, line = tmp_path / "section.nc", ("--surface", "z - 27", "--direction", "down", "--start", "1,1,20")
    _, out, err = command("section", lorenz, *line, "--crossings", 20, "--t-end", 50, "--out", path)
    assert err == ""
    assert "section  dimension 2\n" in out
    expected = lp.section(LORENZ, [1, 1, 20], surface="z - 27", direction=-1, t_end=50, n_crossings=20)
    np.testing.assert_allclose(lp.load(path).state, expected.state, rtol=1e-6)
    assert len(expected.time) == 20


def test_exponents_and_verdicts(command, lorenz):
    _, out, _ = command("lyapunov", lorenz, "--spectrum", "--starts", 2, "--t-end", 300)
    least, middle, most = sorted(float(row.split()[1]) for row in out.splitlines() if re.match(r" +[123] ", row))
    np.testing.assert_allclose([most, middle, least], [0.9056, 0, -14.5723], atol=0.1)  # of time 300, two starts
    assert "A mean over random starts mixes chaotic and regular orbits: it is not the exponent of one orbit." in out
    _, out, _ = command("decide", lorenz, "--start", "1,1,20", "--t-end", 300)
    assert re.search(r"^    0  chaotic ", out, re.MULTILINE)


def test_a_sweep_is_made_of_single_runs(command, lorenz, tmp_path):
    (tmp_path / "sweep.toml").write_text(
        'system = "lorenz.toml"\nt_end = 20\nn_starts = 3\n[[axes]]\nname = "rho"\nvalues = [10, 28]\n'
    )
    code, out, _ = command("sweep", tmp_path / "sweep.toml", "--quiet")
    assert (code, "outcomes: finished 6" in out) == (0, True)
    result = lp.sweeps.sweep(tmp_path / "sweep.toml")
    for rho, exponents in zip((10, 28), result.value, strict=True):
        field = lp.VectorField(RATES, {"sigma": 10, "rho": rho, "beta": "8/3"})
        starts = lp.sample_states(field, 3, seed=result.spec.seed)
        alone = lp.finite_time_exponents(field, starts, t_end=20, seed=result.spec.seed, method=lp.Taylor(tol=1e-9))
        np.testing.assert_allclose(exponents, alone.exponent[:, -1], rtol=1e-12)


def test_a_sweep_of_a_vector_field_is_kept_and_known_again(tmp_path):
    axes = (lp.sweeps.Axis("unused", (1.0, 2.0)),)
    specs = [lp.sweeps.SweepSpec(system=field, axes=axes, t_end=1, n_starts=1) for field in (LORENZ, TURNS, LORENZ)]
    first, other, again = (spec.fingerprint() for spec in specs)
    assert first == again != other
    found = lp.sweeps.SweepSpec.of_record(specs[0].record(), specs[0].description())
    assert (found.fingerprint(), found.system.equations) == (first, LORENZ.equations)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("orbit FILE --leaf C1=1", "--leaf is for systems with a bracket"),
        ("section FILE --surface z --energy 1", "--energy is for systems with a bracket"),
        ("lyapunov FILE --guess 1,1,1", "--guess is for systems with a bracket"),
        ("section FILE", "--surface must be given for a vector field"),
        ("section FILE --surface 3", "'3' is constant"),
        ("section FILE --surface z --starts 3", "--starts and --start exclude each other"),
        ("orbit FILE --set tau=1", "'Lorenz' has no parameter 'tau'"),
        ("orbit FILE --set x=1", "'Lorenz' has no parameter 'x'"),
        ("orbit FILE --start w=1", "Known: x, y, z"),
        ("equilibria FILE", "A vector field has no bracket"),
    ],
)
def test_what_is_refused(command, lorenz, line, words):
    code, _, err = command(*[lorenz if word == "FILE" else word for word in line.split()])
    assert code != 0
    assert words in err
