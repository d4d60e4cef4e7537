"""The options that runs share: each part has its share of the progress, and what is left of the time."""

import math
import time

import pytest

import liepoisson as lp
from liepoisson.errors import ParameterError
from liepoisson.numeric.run_options import ENSEMBLE_METHOD, RunOptions, part_of


def test_parts_add_up_to_the_whole():
    seen = []
    for k in range(4):
        listen = part_of(seen.append, k / 4, 1 / 4)
        listen(0.5)
        listen(1.0)
    assert seen == [0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0]
    assert part_of(None, 0.0, 1.0) is None


def test_a_part_has_what_is_left_of_the_time_and_its_share_of_the_progress():
    seen = []
    options = RunOptions.read(None, 2, 100, seen.append, seed=3, first=4)
    time.sleep(0.01)
    inner = options.part(0.5, 0.5).inner(0.0, 0.5)
    inner["progress"](1.0)
    assert seen == [0.75]
    assert inner["time_limit"] < 100 == options.time_limit
    assert (inner["method"], inner["threads"], options.drawn) == (ENSEMBLE_METHOD, 2, {"seed": 3, "first": 4})


def test_a_run_must_have_some_time_though_none_is_left():
    options = RunOptions.read(time_limit=1e-9)
    time.sleep(0.001)
    assert options.is_late
    assert options.left > 0
    assert RunOptions.read(time_limit=math.inf).left == math.inf


@pytest.mark.parametrize(
    "wrong", [{"method": "taylor"}, {"threads": 0}, {"time_limit": 0}, {"seed": -1}, {"first": 1.5}], ids=str
)
def test_what_no_run_can_have_is_refused_by_name(wrong):
    (name,) = wrong
    with pytest.raises(ParameterError, match=f"^{name}: wanted"):
        RunOptions.read(**wrong)
    with pytest.raises(ParameterError, match=f"^{name}: wanted"):
        lp.decide(lp.Top.kovalevskaya(), lp.sample_states(lp.Top.kovalevskaya(), 1), **wrong)
