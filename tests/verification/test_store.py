"""What was computed is not computed again; what changed is."""

import numpy as np
import pytest

import store


class Counted:
    """A computation that counts how often it was asked."""

    def __init__(self):
        self.calls = 0

    def __call__(self):
        self.calls += 1
        return {"value": np.arange(3) + self.calls, "name": "x"}


def test_a_piece_is_computed_once(tmp_path):
    compute, settings = Counted(), {"step": 0.1, "samples": [1, 2]}
    first = store.Store(tmp_path).piece("drift a", settings, compute)
    again = store.Store(tmp_path).piece("drift a", dict(reversed(settings.items())), compute)
    assert compute.calls == 1
    assert np.array_equal(first["value"], again["value"])
    assert [path.name for path in tmp_path.iterdir()] == [f"drift-a-{store.digest(settings)}.npz"]


def test_a_changed_setting_or_version_is_another_piece(tmp_path, monkeypatch):
    compute, kept = Counted(), store.Store(tmp_path)
    kept.piece("a", {"step": 0.1}, compute)
    kept.piece("a", {"step": 0.2}, compute)
    monkeypatch.setattr(store.lp, "__version__", "99.0")
    kept.piece("a", {"step": 0.2}, compute)
    assert compute.calls == 3
    assert len(list(tmp_path.iterdir())) == 3


def test_an_interrupted_piece_leaves_nothing_and_is_computed_again(tmp_path):
    def interrupted():
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        store.Store(tmp_path).piece("a", {}, interrupted)
    assert list(tmp_path.iterdir()) == []
    assert store.Store(tmp_path).piece("a", {}, Counted())["value"][0] == 1


def test_an_interrupted_write_has_no_name(tmp_path, monkeypatch):
    def interrupted(file, **arrays):
        file.write(b"half")
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(store.np, "savez_compressed", interrupted)
        with pytest.raises(KeyboardInterrupt):
            store.Store(tmp_path).piece("a", {}, Counted())
    assert list(tmp_path.glob("*.npz")) == []
    assert store.Store(tmp_path).piece("a", {}, Counted())["value"][0] == 1


def test_fresh_computes_once_more_and_then_keeps(tmp_path):
    compute = Counted()
    store.Store(tmp_path).piece("a", {}, compute)
    fresh = store.Store(tmp_path, fresh=True)
    assert fresh.piece("a", {}, compute)["value"][0] == 2
    assert fresh.piece("a", {}, compute)["value"][0] == 2
