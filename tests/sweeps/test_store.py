"""Stores: interrupted sweeps go on, damage is found, other sweeps are refused."""

import json
import shutil
import signal
import subprocess
import sys
import textwrap
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import liepoisson as lp
from liepoisson.errors import DamagedFileError, OutputError
from liepoisson.io.files import exclusive
from liepoisson.sweeps.run import sweep
from liepoisson.sweeps.spec import Axis

SPEC = {
    "system": "twisted-top",
    "parameters": {"I": [2, 2, 1], "a": [-1, 0, 0], "b": [0, 0, 0]},
    "axes": (Axis.linear("epsilon", 0, 1, 12),),
    "n_starts": 100,
    "t_end": 20.0,
    "seed": 3,
    "points_per_piece": 2,
}
CHILD = """
    import os, resource, signal, sys
    from liepoisson.sweeps.run import sweep
    from liepoisson.sweeps.spec import Axis
    count = 0
    def progress(*_):
        global count
        count += 1
        if count == 3:
            {then}
    sweep(
        system="twisted-top", parameters={{"I": [2, 2, 1], "a": [-1, 0, 0], "b": [0, 0, 0]}},
        axes=(Axis.linear("epsilon", 0, 1, 12),), n_starts=100, t_end=20.0, seed=3, points_per_piece=2,
        store=sys.argv[1], threads=1, progress=progress,
    )
"""


def child(path, then):
    """A process that computes SPEC and does something to itself after three of six pieces."""
    code = textwrap.dedent(CHILD).format(then=then)
    return subprocess.run([sys.executable, "-c", code, str(path)], capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    path = tmp_path_factory.mktemp("sweep") / "a.zarr"
    return sweep(**SPEC, store=path).value, path


@pytest.fixture
def right(whole):
    return whole[0]


@pytest.fixture
def path(whole, tmp_path):
    """A complete store, which a test may damage."""
    return Path(shutil.copytree(whole[1], tmp_path / "a.zarr"))


def test_a_complete_store_is_read_here_and_by_other_tools(path, right):
    again = sweep(**SPEC, store=path)
    assert (again.n_reused, again.reports[0].n_pieces) == (12, 0)
    np.testing.assert_array_equal(again.value, right)
    with xr.open_dataset(path / "level0", engine="zarr", consolidated=False) as data:
        np.testing.assert_array_equal(data["value"], right)
        assert dict(data.sizes) == {"point": 12, "axis": 1, "member": 100, "piece": 6}
        assert np.isfinite(data["seconds"]).all()


@pytest.mark.thorough
def test_a_killed_sweep_goes_on(tmp_path, right):
    path = tmp_path / "a.zarr"
    done = child(path, "os.kill(os.getpid(), signal.SIGKILL)")
    assert done.returncode == -signal.SIGKILL, done.stderr
    result = sweep(**SPEC, store=path)
    assert result.n_reused == 6
    assert result.reports[0].n_pieces == 3
    np.testing.assert_array_equal(result.value, right)


def test_what_a_killed_sweep_was_writing_is_removed(path):
    left, mine = path / "level0" / "value" / "2.0.4194305.partial", path / "level0" / "value" / "my.partial"
    left.write_bytes(b"half")
    mine.write_bytes(b"mine")
    assert sweep(**SPEC, store=path).n_reused == 12
    assert (left.exists(), mine.exists()) == (False, True)


@pytest.mark.thorough
def test_a_full_disk_is_told_and_what_is_done_is_kept(tmp_path, right):
    path = tmp_path / "a.zarr"
    done = child(path, "resource.setrlimit(resource.RLIMIT_FSIZE, (500, 500))")
    assert done.returncode == 1
    assert "OutputError: could not write" in done.stderr
    assert "what is finished is kept" in done.stderr
    result = sweep(**SPEC, store=path)
    assert result.n_reused == 6
    np.testing.assert_array_equal(result.value, right)


def truncate(file):
    file.write_bytes(file.read_bytes()[:-10])


def flip(file):
    content = bytearray(file.read_bytes())
    content[len(content) // 2] ^= 4
    file.write_bytes(content)


def empty(file):
    file.write_bytes(b"")


@pytest.mark.parametrize("damage", [truncate, flip, empty])
@pytest.mark.parametrize("name", ["value", "outcome"])
def test_damaged_pieces_are_computed_anew(path, right, damage, name):
    (path / "level0" / "seconds" / "0").write_bytes(b"")  # which is no reason to refuse
    damage(path / "level0" / name / "2.0")
    (path / "level0" / name / "4.0").unlink()
    assert "(4 not computed; 1 piece of the store damaged)" in repr(lp.load(path))
    result = sweep(**SPEC, store=path)
    assert (result.n_damaged, result.n_reused, result.reports[0].n_pieces) == (1, 8, 2)
    np.testing.assert_array_equal(result.value, right)
    assert sweep(**SPEC, store=path).n_damaged == 0


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["zarr.json", "level0/zarr.json", "level0/value/zarr.json", "level0/point/0.0"])
def test_a_damaged_description_is_refused_and_fresh_helps(path, right, name):
    truncate(path / name)
    with pytest.raises(DamagedFileError, match="does not help" if name == "zarr.json" else "Start over with fresh"):
        sweep(**SPEC, store=path)
    if name != "zarr.json":  # without which nobody knows whose folder it is
        np.testing.assert_array_equal(sweep(**SPEC, store=path, fresh=True).value, right)


@pytest.mark.thorough
def test_a_piece_in_the_place_of_another_is_told(tmp_path, right):
    path, other = tmp_path / "a.zarr", tmp_path / "b.zarr"
    sweep(**SPEC, store=path)
    sweep(**{**SPEC, "seed": 4}, store=other)
    for name in ("value", "outcome"):
        folder = path / "level0" / name
        shutil.copy(folder / "0.0", folder / "1.0")
        shutil.copy(other / "level0" / name / "2.0", folder / "2.0")
    result = sweep(**SPEC, store=path)
    assert (result.n_damaged, result.n_reused) == (2, 8)
    np.testing.assert_array_equal(result.value, right)


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("value", '"float64"', '"float32"'),
        ("outcome", '"int8"', '"int16"'),
        ("point", '"float64"', '"float32"'),
        ("value", '"little"', '"big"'),
        ("value", '"."', '"/"'),
    ],
)
def test_arrays_described_in_another_way_are_refused(path, name, old, new):
    description = path / "level0" / name / "zarr.json"
    assert old in description.read_text()
    description.write_text(description.read_text().replace(old, new))
    chunk = (path / "level0" / "value" / "0.0").read_bytes()
    with pytest.raises(DamagedFileError, match=rf"of {name} is .* instead of .*fresh"):
        sweep(**SPEC, store=path)
    assert (path / "level0" / "value" / "0.0").read_bytes() == chunk


@pytest.mark.parametrize("name", ["seconds", "point", "seconds/zarr.json", "point/0.0", "zarr.json", "value/zarr.json"])
def test_what_can_be_made_anew_costs_no_piece(path, right, name):
    gone = path / "level0" / name
    shutil.rmtree(gone) if gone.is_dir() else gone.unlink()
    result = sweep(**{**SPEC, "points_per_piece": 3}, store=path)
    assert (result.n_damaged, result.n_reused) == (0, 12)
    np.testing.assert_array_equal(result.value, right)
    assert gone.exists()


@pytest.mark.thorough
def test_fresh_removes_the_sweep_and_nothing_else(path, right):
    (path / "notes.txt").write_text("x")
    (path / "figures").mkdir()
    (path / "figures" / "level0").write_text("x")
    (path / "level3").mkdir()
    np.testing.assert_array_equal(sweep(**SPEC, store=path, fresh=True).value, right)
    assert (path / "notes.txt").read_text() == (path / "figures" / "level0").read_text() == "x"
    assert not (path / "level3").exists()
    assert sweep(**SPEC, store=path).n_reused == 12


def test_foreign_folders_and_files_are_left_alone(tmp_path):
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "precious").write_text("x")
    for path in (tmp_path / "data", tmp_path / "data" / "precious"):
        with pytest.raises(OutputError):
            sweep(**SPEC, store=path, fresh=True)
    (tmp_path / "data" / "zarr.json").write_text(json.dumps({"attributes": {"kind": "other"}}))
    with pytest.raises(DamagedFileError, match="wanted the folder of a sweep"):
        sweep(**SPEC, store=tmp_path / "data", fresh=True)
    assert (tmp_path / "data" / "precious").read_text() == "x"


def test_one_process_writes(tmp_path):
    with exclusive(tmp_path / "a.zarr"), pytest.raises(OutputError, match="another run"):
        sweep(**SPEC, store=tmp_path / "a.zarr")
