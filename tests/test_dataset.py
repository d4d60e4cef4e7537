"""Files: labelled, complete, repeatable bit for bit; damaged ones and full disks are refused by name."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import DamagedFileError, OutputError, ParameterError
from liepoisson.numeric._checks import TOP_COMPONENTS

TOP = lp.Top(inertia=(2, 1.5, 1), a=(-1, 0.1, 0.2), b=(0.4, 0, -0.7), epsilon=0.8)


def growth(n=7):
    x0 = lp.sample_states(TOP, n, seed=1)
    return lp.lyapunov_exponent(TOP, x0, t_end=12, seed=5, first=3, method=lp.Taylor(tol=1e-11))


def orbit(**options):
    return lp.integrate(TOP, lp.sample_states(TOP, 3, seed=1), t=np.linspace(1, -2, 7), **options)


@pytest.mark.thorough
def test_exponents_are_labelled_and_repeat_from_the_file_alone(tmp_path):
    result = growth()
    path = result.save(tmp_path / "deep" / "growth.nc")
    dataset = lp.load(path)
    assert dict(dataset.sizes) == {"trajectory": 7, "time": 200, "component": 9}
    assert list(dataset.component.to_numpy()) == list(TOP_COMPONENTS)
    assert list(dataset.trajectory.to_numpy()) == list(range(3, 10))
    again = lp.rerun(path, threads=1)
    assert np.array_equal(again.exponent, result.exponent)
    assert np.array_equal(dataset.exponent.to_numpy(), result.exponent)
    assert again.method == result.method
    assert again.field == result.field


@pytest.mark.parametrize("options", [{}, {"dense": True}, {"tangents": np.eye(9)[:2]}])
def test_orbits_are_labelled_and_repeat_from_the_file_alone(tmp_path, options):
    result = orbit(**options)
    again = lp.rerun(result.save(tmp_path / "orbit.nc"))
    assert np.array_equal(again.state, result.state)
    assert np.array_equal(again.tangent, result.tangent)
    assert bool(again.series) == bool(result.series)


def test_a_single_orbit_repeats_with_its_own_kernel(tmp_path):
    result = lp.integrate(TOP, lp.sample_states(TOP, 1, seed=2), t=[0, 30])
    again = lp.rerun(result.save(tmp_path / "orbit.nc"))
    assert np.array_equal(again.state, result.state)
    assert again.kernel == result.kernel


def test_a_file_can_be_read_by_others(tmp_path):
    """Plain NetCDF-4: any HDF5 reader finds the variables."""
    import h5py

    with h5py.File(growth().save(tmp_path / "growth.nc")) as file:
        assert file["exponent"].shape == (7, 200)
        assert file.attrs["format"] == "liepoisson/1"


def test_missing_damaged_and_foreign_files_are_refused(tmp_path):
    with pytest.raises(DamagedFileError, match="there is none of this name"):
        lp.load(tmp_path / "nothing.nc")
    path = growth().save(tmp_path / "growth.nc")
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(DamagedFileError, match="may be truncated"):
        lp.load(path)
    path.write_text("not a dataset")
    with pytest.raises(DamagedFileError, match="can not be read as NetCDF"):
        lp.load(path)
    import xarray as xr

    xr.Dataset({"x": ("t", [1.0])}).to_netcdf(path, engine="h5netcdf")
    with pytest.raises(DamagedFileError, match="another kind"):
        lp.load(path)


def test_a_dataset_without_its_parameters_is_not_rerun():
    dataset = growth().dataset
    del dataset.attrs["method"]
    with pytest.raises(DamagedFileError, match="method"):
        lp.rerun(dataset)


def test_a_path_below_a_file_is_refused(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="could not write"):
        growth().save(tmp_path / "file" / "growth.nc")


@pytest.mark.thorough
def test_a_full_disk_leaves_the_older_file_as_it_was(tmp_path):
    """A limit on the size of files stands for the full disk."""
    path = growth().save(tmp_path / "growth.nc")
    before = path.read_bytes()
    program = f"""
import resource, signal
import liepoisson as lp
from liepoisson.errors import OutputError
top = lp.Top.kovalevskaya()
growth = lp.lyapunov_exponent(top, lp.sample_states(top, 500, seed=1), t_end=1)
growth.dataset  # imports now, since writing byte code would meet the limit too
import h5py, h5netcdf
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))
try:
    growth.save({str(path)!r})
except OutputError as error:
    print(error)
"""
    result = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False,
        env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"},
    )  # fmt: skip
    assert "growth.nc: File too large" in result.stdout, result.stderr
    assert result.returncode == 0
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


def test_a_name_that_no_file_can_have_is_refused():
    for name in ("x" * 300, "a\0b", 5, None):
        with pytest.raises(DamagedFileError):
            lp.load(name)
    with pytest.raises(DamagedFileError, match="wanted the name of a file; got 5"):
        lp.rerun(5)


@pytest.mark.parametrize("name", [None, 5, "growth.xlsx", "growth", "growth.nc.gz"])
def test_a_name_that_no_netcdf_file_should_have_is_refused(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(OutputError, match=r"wanted (the name of a file|a name that ends in \.nc)"):
        growth(1).save(name)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("attribute", "change"),
    [
        ("format", "liepoisson/9"),
        ("kind", "other"),
        ("kind", 5),
        ("run", "[]"),
        ("method", {"name": "euler"}),
        ("method", {"tol": "a"}),
        ("method", "5"),
        ("field", {"kind": "spinning coin"}),
        ("field", {"inertia": [1, 2]}),
        ("field", {"inertia": "abc"}),
        ("field", {"a": [1, 2, "b"]}),
        ("field", {"epsilon": None}),
        ("field", {"epsilon": float("nan")}),
    ],
)
def test_an_altered_record_is_not_rerun(attribute, change):
    dataset = growth(1).dataset
    if isinstance(change, dict):
        change = json.dumps(json.loads(dataset.attrs[attribute]) | change)
    dataset.attrs[attribute] = change
    with pytest.raises(DamagedFileError, match="does not record a run"):
        lp.rerun(dataset)


def test_another_version_warns():
    dataset = growth(1).dataset
    dataset.attrs["version"] = "0.0.0"
    with pytest.warns(UserWarning, match=r"made by liepoisson 0\.0\.0"):
        lp.rerun(dataset)


def test_mistakes_of_the_caller_are_not_blamed_on_the_file():
    with pytest.raises(ParameterError, match="threads"):
        lp.rerun(growth(1).dataset, threads=0)
