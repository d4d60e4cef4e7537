"""Sweeps over systems with noise: each point is a run of its own, however the sweep was made."""

import signal
import subprocess
import sys
import textwrap
import tomllib
from pathlib import Path

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import ParameterError
from liepoisson.sweeps.identity import digest_of
from liepoisson.sweeps.store import OtherSweepError

TABLES = tomllib.loads((Path(__file__).parents[1] / "data" / "shaken-body.toml").read_text(), parse_float=str)
STEP = lp.Splitting(step=0.1)
SPEC = {
    "system": TABLES,
    "axes": {"s": [0.25, 0.5], "I3": [3.0, 4.0]},
    "n_starts": 3,
    "t_end": 10.0,
    "seed": 5,
    "method": STEP,
}


def shaken(s=0.25, third=3.0, beta=2):
    body = lp.catalog.euler_top_on("so(3)", [1, 2, third])
    return lp.stochastic.NoisySystem(body, [f"{s}*l{k}" for k in (1, 2, 3)], beta)


def alone(noisy, starts, **options):
    return lp.stochastic.noisy_exponents(noisy.system, starts, **noisy.noise, method=STEP, **options)


@pytest.fixture(scope="module")
def whole():
    return lp.sweep(**SPEC)


def test_a_point_is_a_run_alone_with_the_same_seed(whole):
    for (s, third), exponents, errors in zip(whole.points, whole.value, whole.error, strict=True):
        noisy = shaken(s, third)
        run = alone(noisy, lp.sample_states(noisy.system, 3, seed=5), t_end=10.0, seed=5)
        np.testing.assert_array_equal(exponents, run.exponent)
        np.testing.assert_array_equal(errors, run.error)
    assert whole.outcomes == {"finished": 12}
    assert "the noise: trajectory k follows the same path at every point" in whole.held


@pytest.mark.parametrize("how", [{"threads": 1, "points_per_piece": 3}, {"threads": 3, "points_per_piece": 1}])
def test_bits_do_not_depend_on_how(whole, how):
    again = lp.sweep(**SPEC, **how)
    np.testing.assert_array_equal(again.value, whole.value)
    np.testing.assert_array_equal(again.error, whole.error)


def test_an_inverse_temperature_is_swept(whole):
    found = lp.sweep(**SPEC | {"axes": {"beta": [0.0, 2.0]}})
    assert np.array_equal(found.value[1], whole.value[0])
    assert not np.isclose(found.value[0], found.value[1]).any()


def test_a_trajectory_keeps_its_path_where_others_have_no_start():
    """8 l1^3 - 6 l1 has a local maximum 2 at l1 = -1/2: few of the states near which 4 is looked for lead to it."""
    wells = {**TABLES, "hamiltonian": {"expression": "8*l1^3 - 6*l1 + l3/I[3]"}}
    given = SPEC | {"system": wells, "axes": {"energy": [4.0]}, "starts": {"C1": 2}, "n_starts": 6, "t_end": 1.0}
    found = lp.sweep(**given)
    has_start = found.outcome[0] == "finished"
    assert 0 < has_start.sum() < 6
    assert not has_start[: np.flatnonzero(has_start)[-1]].all()
    seen = lp.sweep(**given, quantity=end_of_path)
    (starts,) = seen_starts
    assert np.array_equal(np.isfinite(starts).all(axis=1), has_start)
    body = lp.System(lp.so(3) @ lp.trivial(), "8*l1^3 - 6*l1 + l3/3")
    noisy = lp.stochastic.NoisySystem(body, shaken().noises, 2)
    np.testing.assert_array_equal(found.value[0], alone(noisy, starts, t_end=1.0, seed=5).exponent)
    run = lp.stochastic.noisy_orbits(body, starts, **noisy.noise, t_end=1.0, seed=5, method=STEP)
    np.testing.assert_array_equal(seen.value[0, has_start], run.end_state[has_start, 0])
    assert seen.error is None


seen_starts = []


def end_of_path(noisy, starts, *, t_end, method, seed, threads):
    seen_starts.append(starts)
    options = {"t_end": t_end, "method": method, "seed": seed, "threads": threads}
    return lp.stochastic.noisy_orbits(noisy.system, starts, **noisy.noise, **options).end_state[:, 0]


GIVEN = {
    "object": {"system": shaken(), "axes": {"energy": [0.2, 0.3]}},
    "function": {"system": shaken, "axes": {"s": [0.25, 0.5]}},
}


@pytest.mark.parametrize("kind", GIVEN)
def test_systems_are_taken_as_objects_and_functions(kind):
    given = SPEC | GIVEN[kind]
    found = lp.sweep(**given)
    wanted = lp.sweep(**given | {"system": TABLES})
    np.testing.assert_array_equal(found.value, wanted.value)
    np.testing.assert_array_equal(found.error, wanted.error)


@pytest.mark.thorough
@pytest.mark.parametrize("system", [TABLES, shaken()], ids=["tables", "object"])
def test_a_store_and_a_file_give_the_sweep_back(tmp_path, system):
    made = lp.sweep(**SPEC | {"system": system, "axes": {"energy": [0.2, 0.3]}}, store=tmp_path / "a.zarr")
    for again in (lp.load(tmp_path / "a.zarr"), lp.load(made.save(tmp_path / "a.nc")), lp.rerun(tmp_path / "a.nc")):
        assert again.dataset.drop_attrs().identical(made.dataset.drop_attrs())
        assert (again.held, again.method) == (made.held, made.method)
    assert made.dataset["error"].dims == ("energy", "member")


COLD, HOT = shaken(beta=3), shaken(beta=1)


def test_noise_and_seed_are_part_of_what_a_sweep_is(tmp_path):
    other = {**TABLES, "noise": {**TABLES["noise"], "inverse_temperature": 3}}
    marks = {
        lp.sweeps.SweepSpec(
            system, axes=(lp.sweeps.Axis("energy", (0.2,)),), t_end=1, n_starts=1, method=STEP, seed=seed
        ).fingerprint()
        for system in (TABLES, other, shaken(), shaken(beta=3), shaken(0.5), shaken(third=4))
        for seed in (0, 1)
    }
    assert len(marks) == 12
    assert digest_of(lambda beta: COLD) != digest_of(lambda beta: HOT)
    store = tmp_path / "a.zarr"
    lp.sweep(**SPEC | {"axes": {"s": [0.5]}}, store=store)
    with pytest.raises(OtherSweepError, match="seed 5 instead of 6"):
        lp.sweep(**SPEC | {"axes": {"s": [0.5]}, "seed": 6}, store=store)


@pytest.mark.parametrize("name", ["value", "error", "outcome"])
def test_a_piece_without_one_of_its_arrays_is_computed_anew(tmp_path, name):
    given, store = SPEC | {"axes": {"s": [0.25, 0.5]}, "t_end": 1.0}, tmp_path / "a.zarr"
    first = lp.sweep(**given, store=store, points_per_piece=1)
    (store / "level0" / name / "1.0").unlink()
    again = lp.sweep(**given, store=store)
    assert again.n_reused == 1
    np.testing.assert_array_equal(again.error, first.error)


def quiet_at_a_half(s):
    return shaken(s).system if s == 0.5 else shaken(s)


def test_a_point_of_amplitude_zero_is_a_run_without_noise(whole):
    found = lp.sweep(**SPEC | {"axes": {"s": [0.0, 0.25]}})
    run = alone(
        lp.stochastic.NoisySystem(shaken().system, []), lp.sample_states(shaken().system, 3, seed=5), t_end=10.0, seed=5
    )
    np.testing.assert_array_equal(found.value, [run.exponent, whole.value[0]])


def test_a_point_without_noise_among_others_has_no_system():
    found = lp.sweep(**SPEC | {"system": quiet_at_a_half, "axes": {"s": [0.25, 0.5]}})
    assert found.outcome[:, 0].tolist() == ["finished", "no system"]
    assert "wanted noise at all points or at none" in found.remarks[0]


REFUSED = {
    "verdicts": ({"quantity": "chaotic_fraction"}, "a path of noise has none"),
    "no method": ({"method": None}, "wanted Splitting in double precision, whose steps noise can enter"),
    "method": ({"method": lp.Taylor()}, "whose steps noise can enter, with a step; got Taylor"),
    "no parameter": ({"axes": {"u": [1.0]}}, "nothing depends on it"),
}


@pytest.mark.parametrize(("change", "words"), REFUSED.values(), ids=[*REFUSED])
def test_what_noise_does_not_have_is_refused(change, words):
    with pytest.raises(ParameterError, match=words):
        lp.sweep(**SPEC | change)


KILLED = """
    import os, signal, sys
    import liepoisson as lp

    n_left = int(sys.argv[3])

    def progress(_):
        global n_left
        n_left -= 1
        if n_left == 0:
            os.kill(os.getpid(), signal.SIGKILL)

    lp.sweep(sys.argv[1], store=sys.argv[2], threads=int(sys.argv[4]), points_per_piece=1, progress=progress)
"""
FILE = """
system = "body.toml"
t_end = 200
n_starts = 8
seed = 5
[[axes]]
name = "s"
from = 0.125
to = 1
count = 8
[method]
name = "splitting"
step = 0.05
"""


@pytest.mark.slow
@pytest.mark.usefixtures("shaken_body")
def test_a_sweep_that_is_killed_three_times_is_the_one_that_was_not(tmp_path):
    (tmp_path / "sweep.toml").write_text(FILE)
    right, store = lp.sweep(tmp_path / "sweep.toml", threads=2), tmp_path / "killed.zarr"
    for pieces, threads in ((2, 1), (3, 2), (1, 1)):
        line = [
            sys.executable,
            "-c",
            textwrap.dedent(KILLED),
            *map(str, (tmp_path / "sweep.toml", store, pieces, threads)),
        ]
        done = subprocess.run(line, capture_output=True, text=True, check=False)
        assert done.returncode == -signal.SIGKILL, done.stderr
    result = lp.sweep(tmp_path / "sweep.toml", store=store)
    assert 6 <= result.n_reused < 8
    for name in ("value", "error", "outcome_code"):
        np.testing.assert_array_equal(getattr(result, name), getattr(right, name))
