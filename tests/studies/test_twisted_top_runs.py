"""What the study of the twisted top runs: times, tops, ensembles, options."""

from __future__ import annotations

import numpy as np
import pytest

from liepoisson.errors import ParameterError, UnknownNameError
from liepoisson.studies import check_study
from liepoisson.studies.twisted_top.runs import Settings, plan, sample_times


@pytest.mark.parametrize("end_time", [60.0, 200.0, 250.5, 1000.0, 1e6])
def test_sample_times_reach_the_end_and_are_bounded_in_number(end_time):
    times = sample_times(end_time)
    assert times.size <= 375
    assert times[-1] == end_time
    assert (np.diff(times) > 0).all()
    assert np.isin(np.arange(5.0, min(200.0, end_time) + 1), times).all()
    assert times[0] < 1


def test_plan_covers_both_tops_three_ensembles_and_the_readings_of_the_inertia():
    planned = {run.name: run for run in plan(Settings())}
    for ensemble in ("unit-vectors", "cube", "gaussian"):
        for top, epsilon in (("twisted", 1), ("ordinary", 0)):
            run = planned[f"{top}-{ensemble}"]
            assert (run.epsilon, run.members, run.end_time) == (epsilon, 20_000, 1000.0)
            assert run.window == (20.0, 200.0)
            field = run.top().field()
            assert (field.inertia, field.a, field.b) == ((2.0, 2.0, 1.0), (-1.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    assert planned["twisted-halved-cube"].top().field().inertia == (1.0, 1.0, 0.5)
    assert planned["ordinary-as-printed-unit-vectors"].top().field().inertia == (1.0, 1.0, 2.0)
    assert planned["ordinary-as-printed-unit-vectors"].end_time == 200.0


@pytest.mark.parametrize(
    ("option", "message"),
    [
        ({"members": 1}, "members must be at least 2"),
        ({"end_time": 0.0}, "at least 60"),
        ({"end_time": float("nan")}, "finite"),
        ({"end_time": float("inf")}, "finite"),
        ({"seed": -1}, "seed"),
        ({"threads": 0}, "threads"),
        ({"threads": 4097}, "threads must be at most 4096; got 4097"),
        ({"members": 10**8 + 1}, "members must be at most 100000000; got 100000001"),
    ],
)
def test_bad_settings_are_refused(option, message):
    with pytest.raises(ParameterError, match=message):
        Settings(**option)


def test_unknown_study_is_refused_with_a_suggestion():
    assert check_study("twisted-top") == "twisted-top"
    with pytest.raises(UnknownNameError, match="Did you mean twisted-top"):
        check_study("twisted-tops")
