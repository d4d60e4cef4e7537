"""A store belongs to the content of its system and its functions, not to their names."""

from functools import partial

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import ParameterError
from liepoisson.sweeps.identity import digest_of
from liepoisson.sweeps.run import sweep
from liepoisson.sweeps.spec import Axis
from liepoisson.sweeps.store import OtherSweepError

GIVEN = {
    "system": "twisted-top",
    "parameters": {"I": [2, 2, 1], "a": [-1, 0, 0], "b": [0, 0, 0]},
    "axes": (Axis("epsilon", (0.5, 1.0)),),
    "n_starts": 2,
    "t_end": 5.0,
    "threads": 1,
}
FACTOR = 1.0


def constant(value):
    return lambda system, x0, **_: np.full(len(x0), value)


def test_a_changed_system_file_is_another_system(tmp_path):
    file, text = tmp_path / "top.toml", lp.catalog.path("twisted-top").read_text()
    file.write_text(text)
    given = {**GIVEN, "system": str(file), "store": tmp_path / "a.zarr"}
    sweep(**given)
    moved = tmp_path / "moved.toml"
    moved.write_text("# the same\n" + text)
    assert sweep(**{**given, "system": moved}).n_reused == 2
    changed = text.replace("dot(a, alpha)", "5*dot(a, alpha)")
    assert changed != text
    file.write_text(changed)
    with pytest.raises(OtherSweepError, match="system"):
        sweep(**given)


def test_a_changed_grid_is_told_by_the_first_place_where_it_differs(tmp_path):
    given = {**GIVEN, "quantity": constant(1.0), "store": tmp_path / "a.zarr"}
    sweep(**{**given, "axes": (Axis.linear("epsilon", 0, 1, 12),)})
    with pytest.raises(
        OtherSweepError, match=r"axes\[0\]\.values\[1\] 0\.0909\d+ instead of 0\.1818\d+\. Use the same"
    ):
        sweep(**{**given, "axes": (Axis.linear("epsilon", 0, 2, 12),)})
    with pytest.raises(OtherSweepError, match=r"axes\[0\]\.values with 12 items instead of 13\. Use"):
        sweep(**{**given, "axes": (Axis.linear("epsilon", 0, 1, 13),)})


def test_a_closure_with_another_value_is_another_quantity(tmp_path):
    given = {**GIVEN, "store": tmp_path / "a.zarr"}
    assert sweep(**given, quantity=constant(1.0)).mean.tolist() == [1, 1]
    assert sweep(**given, quantity=constant(1.0)).n_reused == 2
    with pytest.raises(OtherSweepError, match="quantity"):
        sweep(**given, quantity=constant(2.0))


def with_default(x, k=1.0):
    return x * k


def with_global(x):
    return x * FACTOR


def test_digests_see_constants_defaults_globals_and_arguments(monkeypatch):
    functions = [
        lambda x: x + 1.5,
        lambda x: x + 2.5,
        constant(np.array([1.0])),
        constant(np.array([2.0])),
        partial(with_default, k=2.0),
        partial(with_default, k=3.0),
        lp.Top.kovalevskaya,
        lp.Top.heavy,
    ]
    assert len({digest_of(function) for function in functions}) == len(functions)
    before = digest_of(with_default), digest_of(with_global)
    monkeypatch.setattr(with_default, "__defaults__", (2.0,))
    monkeypatch.setitem(globals(), "FACTOR", 2.0)
    assert digest_of(with_default) != before[0]
    assert digest_of(with_global) != before[1]


def test_a_function_of_unknown_state_has_no_store(tmp_path):
    quantity = constant(iter([1.0]))
    with pytest.raises(ParameterError, match=r"list_iterator.*Name a module function"):
        sweep(**GIVEN, quantity=quantity, store=tmp_path / "a.zarr")
    assert not (tmp_path / "a.zarr").exists()
