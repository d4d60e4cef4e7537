"""Sweeps that are loaded: from their store as far as they are computed, and from a file; nothing is computed."""

import json
import re
import sys

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import DamagedFileError, LiePoissonError, ParameterError

TABLES = {
    "bracket": {"algebra": "so(3)"},
    "parameters": {"u": 1},
    "hamiltonian": {"expression": "dot(l, l)/2 + u*l1^3"},
}
GIVEN = {
    "name": {"system": "twisted-kovalevskaya", "axes": {"energy": [0.0, 0.5, 1.0]}},
    "system": {"system": lp.Top.twisted_kovalevskaya("1/3"), "axes": {"energy": [0.0, 0.5, 1.0]}},
    "function": {"system": lp.Top.kovalevskaya, "axes": {"epsilon": [0.0, 0.5]}},
    "tables": {"system": TABLES, "axes": {"u": [0.0, 1.0]}},
    "refined": {
        "system": lp.Top.kovalevskaya,
        "axes": {"epsilon": [0.0, 0.5, 1.0]},
        "quantity": "chaotic_fraction",
        "rule": lp.chaos.Rule(least_time=1.0),
        "refine": {"levels": 2, "difference": 0.1},
        "name": "a title",
    },
}


def made(kind, **options):
    return lp.sweep(**GIVEN[kind], n_starts=3, t_end=20.0, seed=2, **options)


@pytest.mark.thorough
@pytest.mark.parametrize("kind", GIVEN)
def test_a_sweep_is_loaded_as_it_was(tmp_path, kind):
    store = tmp_path / "sweep.zarr"
    sweep = made(kind, store=store)
    before = {path: path.stat().st_mtime_ns for path in store.rglob("*")}
    loaded, read = lp.load(store), lp.load(sweep.save(tmp_path / "sweep.nc"))
    assert {path: path.stat().st_mtime_ns for path in store.rglob("*")} == before
    for again in (loaded, read, lp.rerun(tmp_path / "sweep.nc"), lp.rerun(store)):
        assert repr(again) == repr(sweep)
        assert again.spec.name == sweep.spec.name
        assert again.places == sweep.places
        np.testing.assert_array_equal(again.value, sweep.value)
        np.testing.assert_array_equal(again.outcome, sweep.outcome)
        assert again.dataset.drop_attrs().identical(sweep.dataset.drop_attrs())
        assert (again.held, again.method) == (sweep.held, sweep.method)
    with pytest.raises(ParameterError, match="time_limit must be left out for a sweep"):
        lp.rerun(store, time_limit=1.0)


def test_a_sweep_that_was_interrupted_is_loaded_as_far_as_it_is(tmp_path):
    store = tmp_path / "sweep.zarr"

    def stop(done):
        if done < 1:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        made("name", store=store, points_per_piece=1, threads=1, progress=stop)
    loaded = lp.load(store)
    assert not loaded.is_complete
    assert np.isfinite(loaded.value).all(axis=1).tolist() == [True, False, False]
    assert "not computed yet" in " ".join(loaded.remarks)
    assert made("name", store=store, threads=1).n_reused >= 1


def own_quantity(states, **_):
    return states[:, 0]


def test_a_function_of_the_caller_is_not_called_by_a_file(tmp_path):
    store = tmp_path / "sweep.zarr"
    sweep = lp.sweep(**GIVEN["name"], n_starts=2, t_end=5.0, quantity=own_quantity, store=store, threads=1)
    with pytest.raises(ParameterError, match=r"quantity: it was the function .*own_quantity of the caller"):
        lp.load(store)
    with pytest.raises(DamagedFileError, match="of the caller"):
        lp.load(sweep.save(tmp_path / "sweep.nc"))


@pytest.mark.parametrize("change", [{"t_end": "soon"}, {"axes": []}, {"system": 5}, {"quantity": {"function": "a:b"}}])
def test_altered_descriptions_are_refused(tmp_path, change):
    record = made("name").spec.record() | change
    store = tmp_path / "sweep.zarr"
    made("name", store=store)
    path = store / "zarr.json"
    content = json.loads(path.read_text())
    content["attributes"]["spec"] = record
    path.write_text(json.dumps(content))
    with pytest.raises(LiePoissonError):
        lp.load(store)


@pytest.mark.parametrize("content", [None, "", "{", "[]", '{"attributes": {"kind": "other"}}', "[" * 100_000])
def test_a_folder_that_is_no_sweep_stays(tmp_path, content):
    """It may be any folder of the user, so no advice removes it."""
    if content is not None:
        (tmp_path / "zarr.json").write_text(content)
    calls = [lambda: lp.load(tmp_path)]
    if content is not None:
        calls.append(lambda: made("name", store=tmp_path))
    for call in calls:
        with pytest.raises(DamagedFileError) as refused:
            call()
        assert not re.search("[Rr]emove|[Dd]elete", str(refused.value))
        assert "Look at the name" in str(refused.value)


def test_a_store_or_a_file_that_was_altered_is_refused(tmp_path):
    sweep = made("name", store=tmp_path / "sweep.zarr")
    path = tmp_path / "sweep.zarr" / "zarr.json"
    path.write_text(path.read_text().replace("20.0", "40.0"))
    with pytest.raises(DamagedFileError, match="was changed"):
        lp.load(tmp_path / "sweep.zarr")
    from liepoisson.io.dataset import dataset_of, save

    whole = dataset_of(sweep)
    for k, part in enumerate(({"point": slice(0, 1)}, {"point": [2, 1, 0]}, {"member": [0]})):
        with pytest.raises(DamagedFileError, match="sweep: wanted"):
            lp.load(save(whole.isel(part), tmp_path / f"{k}.nc"))


@pytest.fixture
def named_module(tmp_path, monkeypatch):
    """The name of a module that says when it is imported, and the file in which it says so."""
    trace = tmp_path / "ran"
    (tmp_path / "module_of_another.py").write_text(
        f"import pathlib\npathlib.Path({str(trace)!r}).write_text('ran')\n"
        "def f(system, x0, **_):\n    return x0[:, 0]\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    yield "module_of_another:f", trace
    sys.modules.pop("module_of_another", None)


SAVED = {
    "file": lambda sweep, folder: sweep.save(folder / "q.nc"),
    "store": lambda sweep, _: sweep.store,
    "dataset": lambda sweep, _: sweep.dataset,
    "result": lambda sweep, _: sweep,
}


@pytest.mark.parametrize("kind", SAVED)
def test_a_saved_sweep_that_names_code_is_repeated_with_consent_alone(tmp_path, named_module, kind):
    name, trace = named_module
    given = {**GIVEN["name"], "n_starts": 2, "t_end": 5.0, "threads": 1, "quantity": name}
    sweep = lp.sweep(**given, store=tmp_path / "q.zarr", allow_code=True)
    source = SAVED[kind](sweep, tmp_path)
    del sys.modules["module_of_another"]
    trace.unlink()
    if kind in ("file", "store"):
        lp.load(source)
    with pytest.raises(ParameterError, match=r"module_of_another:f.*code.*allow_code=True"):
        lp.rerun(source)
    assert not trace.exists()
    np.testing.assert_array_equal(lp.rerun(source, allow_code=True).value, sweep.value)
    assert trace.exists()


def test_a_sweep_imports_no_code_without_consent(named_module):
    name, trace = named_module
    given = {**GIVEN["name"], "n_starts": 2, "t_end": 5.0, "quantity": name}
    for call in (
        lambda: lp.sweep(**given),
        lambda: lp.sweep(**given, allow_code=False),
        lambda: lp.sweep(lp.sweeps.SweepSpec(**given | {"axes": (lp.sweeps.Axis("energy", (0.0, 1.0)),)})),
        lambda: lp.sweep(given),
    ):
        with pytest.raises(LiePoissonError, match="allow_code=True"):
            call()
    assert not trace.exists()
    assert lp.sweep(**given | {"quantity": lambda system, x0, **_: x0[:, 0]}, threads=1).is_complete


@pytest.mark.parametrize("name", ["liepoisson.io.files:os.abort", "liepoisson.saved.rerun:import_module"])
def test_a_record_names_functions_of_this_package_alone(name):
    spec = lp.sweeps.SweepSpec(system=lp.Top.kovalevskaya, axes=(lp.sweeps.Axis("epsilon", (0.0, 1.0)),), t_end=1.0)
    record = spec.record() | {"system": {"function": name}}
    with pytest.raises(ParameterError, match="of the caller"):
        lp.sweeps.SweepSpec.of_record(record, {})
