"""The numbers of a sweep, and that they depend on the spec only."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import ParameterError
from liepoisson.indicators.mean_error import wilson_interval
from liepoisson.numeric.sampling import sample_tangents
from liepoisson.sweeps.points import Cell, split
from liepoisson.sweeps.run import sweep
from liepoisson.sweeps.spec import DEFAULT_METHOD, Axis, Refinement, Starts

KOVALEVSKAYA = {"I": [2, 2, 1], "a": [-1, 0, 0], "b": [0, 0, 0]}
TWIST = {"system": "twisted-top", "parameters": KOVALEVSKAYA, "n_starts": 5, "t_end": 30.0, "seed": 3}
MAP = {
    **TWIST,
    "axes": (Axis.linear("epsilon", 0, 1, 3), Axis.linear("energy", 0, 1, 4)),
    "starts": Starts(casimirs={"C1": 1, "C2": 0.2, "C3": 1}),
}


def test_a_point_is_what_lyapunov_exponent_says():
    result = sweep(**TWIST, axes=(Axis("epsilon", (0.0, 0.5, 1.0)),))
    top = lp.Top.kovalevskaya(epsilon="1/2")
    growth = lp.finite_time_exponents(
        top, lp.sample_states(top, 5, seed=3), times=[30.0], seed=3, method=DEFAULT_METHOD
    )
    np.testing.assert_array_equal(result.value[1], growth.exponent[:, -1])
    assert result.outcomes == {"finished": 15}
    np.testing.assert_array_equal(sample_tangents(9, 5, seed=3), growth.start_tangent)


@pytest.mark.parametrize("how", [{"threads": 1}, {"threads": 3}, {"points_per_piece": 1}, {"points_per_piece": 5}])
def test_bits_do_not_depend_on_how(how):
    np.testing.assert_array_equal(sweep(**MAP, **how).value, sweep(**MAP, threads=2).value)


@pytest.mark.thorough
def test_liouville_starts_lie_on_the_leaf():
    result = sweep(
        **{**TWIST, "quantity": first_casimir, "t_end": 1.0, "n_starts": 3},
        axes=(Axis("epsilon", (0.7, 1.0)),),
        starts=Starts(casimirs={"C1": 1, "C2": 0.2, "C3": 1}, energy=0.5, sampling="liouville"),
    )
    np.testing.assert_allclose(result.value, 1.0, atol=1e-11)


def first_casimir(system, x0, **_):
    return np.sum(x0[:, 3:6] ** 2 + 2 * float(system.epsilon) * x0[:, :3] * x0[:, 6:], axis=-1)


def test_states_that_do_not_exist_are_outcomes():
    result = sweep(**{**TWIST, "parameters": {**KOVALEVSKAYA, "epsilon": 1}}, axes=(Axis("C3", (-1.0, 1.0)),))
    assert (result.outcome[0] == "no start").all()
    assert (result.outcome[1] == "finished").all()
    assert np.isnan(result.statistic[0])
    assert result.is_complete


@pytest.mark.parametrize("points_per_piece", [1, 2, 3])
def test_a_failing_quantity_is_told_of_its_point_and_the_rest_done(tmp_path, points_per_piece):
    given = {**TWIST, "quantity": fails_at_one, "n_starts": 2, "axes": (Axis("epsilon", (0.0, 1.0, 2.0)),)}
    result = sweep(**given, points_per_piece=points_per_piece, store=tmp_path / "a.zarr")
    assert result.outcome[:, 0].tolist() == ["finished", "failed", "finished"]
    assert not result.is_complete
    assert result.failed == ("level 0, point 1: failed: ArithmeticError: no",)
    assert result.reports[0].retried == 2
    again = sweep(**given, store=tmp_path / "a.zarr")
    assert again.failed == result.failed  # tried again
    assert again.n_reused == {1: 2, 2: 1, 3: 0}[points_per_piece]


@pytest.mark.parametrize("quantity", ["exponent", "median"])
def test_a_point_without_a_system_is_marked_by_itself(tmp_path, quantity):
    """I3 = 1 - s is no moment at s = 1; the other points have the numbers that they have alone."""
    given = {
        **TWIST,
        "quantity": first_momentum if quantity == "median" else quantity,
        "parameters": {**KOVALEVSKAYA, "I": [2, 2, "1 - s"], "epsilon": 1},
        "axes": (Axis("s", (0.0, 0.25, 1.0, 1.5)),),
    }
    results = [sweep(**given, points_per_piece=k) for k in (1, 2, 4)]
    for result in results:
        assert result.outcome[:, 0].tolist() == ["finished", "finished", "no system", "no system"]
        np.testing.assert_array_equal(result.value, results[0].value)
        assert np.isfinite(result.value[:2]).all()
        assert result.is_complete
        assert "no system at 2 points; the first of them: no system: ParameterError" in result.remarks[0]
        reasons = result.columns()["reason"].tolist()
        assert reasons[:2] == ["", ""]
        for reason, moment in zip(reasons[2:], ("0.0", "-0.5"), strict=True):
            assert reason.startswith("no system: twisted-top must have finite parameters and positive moments")
            assert f"(2.0, 2.0, {moment})" in reason
    assert sweep(**given, store=tmp_path / "a.zarr").outcomes == results[0].outcomes
    assert sweep(**given, store=tmp_path / "a.zarr").n_reused == 4


def first_momentum(system, x0, **_):
    return x0[:, 0]


def fails_at_one(system, x0, **_):
    if system.epsilon == 1:
        raise ArithmeticError("no")
    return np.zeros(len(x0))


def test_the_chaotic_fraction_is_that_of_the_one_rule():
    given = {**TWIST, "n_starts": 40, "t_end": 300.0, "quantity": "chaotic_fraction"}
    result = sweep(**given, axes=(Axis("epsilon", (0.0, 1.0)),))
    low, high = result.interval()
    assert result.statistic[0] == 0.0
    assert high[0] < 0.1
    assert low[1] > 0.7
    for epsilon, point in zip((0.0, 1.0), result.verdict, strict=True):
        top = lp.Top.kovalevskaya(epsilon=epsilon)
        x0 = lp.sample_states(top, 40, seed=result.spec.seed)
        assert (lp.decide(top, x0, t_end=300.0, seed=result.spec.seed).verdict == point).all()
    assert result.undecided_fraction == pytest.approx((result.verdict == "undecided").mean(axis=1))
    assert result.chaotic_fraction == pytest.approx((result.verdict == "chaotic").mean(axis=1))
    for name in ("mean", "standard_error"):  # of -1, 0 and 1 they would be taken for those of the fraction
        with pytest.raises(ParameterError, match="take chaotic_fraction"):
            getattr(result, name)
    assert set(result.dataset) >= {
        "verdict",
        "chaotic_fraction",
        "undecided_fraction",
        "chaotic_fraction_low",
        "chaotic_fraction_high",
    }


def test_a_sweep_of_exponents_has_no_verdicts():
    result = sweep(**{**TWIST, "n_starts": 4, "t_end": 20.0}, axes=(Axis("epsilon", (0.0, 1.0)),))
    with pytest.raises(ParameterError, match="take quantity="):
        _ = result.chaotic_fraction
    low, high = result.interval(0.95)
    assert (high - low) / 2 == pytest.approx(3.182446 * result.standard_error, rel=1e-3)  # Student's t, 3 degrees


def test_wilson_interval_known_values():
    """Roots of (p - q)^2 = z^2 q (1 - q)/n, which define the interval."""
    for k, n in ((0, 10), (3, 10), (10, 10), (500, 1000)):
        low, high = wilson_interval(k, n)
        roots = np.sort(np.roots([1 + 1.959963984540054**2 / n, -(2 * k / n + 1.959963984540054**2 / n), (k / n) ** 2]))
        np.testing.assert_allclose([float(low), float(high)], roots.real, atol=1e-12)
    assert np.isnan(wilson_interval(0, 0)).all()


def test_refinement_finds_a_step_in_one_dimension():
    """|x - 0.3| jumps nowhere; a step at 0.3 is enclosed by cells of side 1/(4 * 2^3)."""
    result = sweep(
        system=step_family,
        axes=(Axis.linear("x", 0, 1, 5),),
        n_starts=1,
        t_end=1.0,
        quantity=where_is_the_step,
        refine=Refinement(levels=3, difference=0.5),
    )
    x, y = result.points[:, 0], result.statistic
    assert len(x) == 5 + 3
    left, right = x[y < 0.5].max(), x[y > 0.5].min()
    assert left < 0.3 < right
    assert right - left == pytest.approx(0.25 / 8)
    assert sorted(result.level) == [0] * 5 + [1, 2, 3]


def step_family(x):
    return lp.Top.heavy((2, 2, 1), (x, 0, 0))


def where_is_the_step(system, x0, **_):
    return np.full(len(x0), float(system.a[0] > 0.3))


def test_refinement_in_two_dimensions_halves_the_cells_that_differ():
    cells = [Cell((0, 0), 4), Cell((4, 0), 4)]
    statistic = {(0, 0): 0.0, (0, 4): 0.0, (4, 0): 0.0, (4, 4): 0.0, (8, 0): 1.0, (8, 4): 0.0}
    halves, places = split(cells, statistic, 0.5)
    assert sorted(c.corner for c in halves) == [(4, 0), (4, 2), (6, 0), (6, 2)]
    assert places == [(4, 2), (6, 0), (6, 2), (6, 4), (8, 2)]
