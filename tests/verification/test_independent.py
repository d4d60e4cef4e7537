"""The comparison with an independent integrator would notice a bias, and is passed over where there is no other one."""

import numpy as np
import pytest

import independent
import liepoisson as lp
from store import Store


def exponents(seed, shift=0.0, share=0.05, n=8192):
    """Made-up exponents of a sea with a share of sticky orbits."""
    rng = np.random.default_rng(seed)
    sea, sticky = rng.normal(0.168, 0.010, n), rng.uniform(0.09, 0.145, n)
    return np.where(rng.uniform(size=n) < share, sticky, sea) + shift


def test_a_bias_of_the_size_in_question_is_many_errors():
    same = independent._difference({"a": exponents(1), "b": exponents(2)}, "a", "b")
    assert abs(same["mean"]) < 4 * same["standard_error"]
    assert abs(same["sticky"]) < 4 * same["sticky_error"]
    biased = independent._difference({"a": exponents(1), "b": exponents(2, shift=0.002)}, "a", "b")
    assert abs(biased["mean"]) > 7 * biased["standard_error"]
    fewer = independent._difference({"a": exponents(1), "b": exponents(2, share=0.035)}, "a", "b")
    assert fewer["sticky"] > 3 * fewer["sticky_error"]


def test_the_sticky_error_counts_starts_that_only_one_calls_sticky():
    one, other = np.array([0.1, 0.1, 0.2, 0.2]), np.array([0.1, 0.2, 0.2, 0.1])
    found = independent._difference({"a": one, "b": other}, "a", "b")
    assert (found["sticky"], found["sticky_error"]) == (0, pytest.approx(np.sqrt(2)))


def test_starts_are_points_of_one_orbit_on_its_leaf_at_its_energy(tmp_path):
    top, start = lp.Top(**independent.TOP), np.array(independent.START)
    starts = independent._starts(4, Store(tmp_path))
    assert starts.shape == (4, 9)
    functions = top.invariant_values(start)
    for name in ("H", "C1", "C2", "C3"):
        assert top.invariant_values(starts)[name] == pytest.approx(float(functions[name]), abs=1e-12)


def test_the_question_is_passed_over_without_the_other_integrator(monkeypatch):
    monkeypatch.setenv("HEYOKA_PYTHON", "/nowhere/python")
    assert "/nowhere/python does not exist" in (independent.missing() or "")
