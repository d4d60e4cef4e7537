"""How the study of the twisted top stores its work, resumes it, and keeps its hands off what is not its own."""

from __future__ import annotations

import dataclasses
import subprocess
import sys
import time

import numpy as np
import pytest
from small_study import SMALL, integrate, one_run, stored_piece

import liepoisson as lp
from liepoisson.errors import OutputError, ParameterError
from liepoisson.io.files import exclusive
from liepoisson.studies.twisted_top import integration, runs
from liepoisson.studies.twisted_top.integration import Tracker, complete
from liepoisson.studies.twisted_top.runs import Settings
from liepoisson.studies.twisted_top.store import RunStore, discard, fingerprint, remove_unfinished
from liepoisson.studies.twisted_top.study import reproduce


@pytest.mark.thorough
def test_interrupted_study_resumes_and_gives_the_same_bits(tmp_path, monkeypatch):
    monkeypatch.setattr(runs, "PIECE_SIZE", 10)
    name = "twisted-unit-vectors"
    whole = integrate(tmp_path / "whole", SMALL, name)

    def interrupt(activity, done, total):
        if done >= 0.6 * total:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        integrate(tmp_path / "resumed", SMALL, name, interrupt)
    store = RunStore(tmp_path / "resumed", one_run(SMALL, name))
    kept = [piece for piece in store.run.pieces() if store.piece_path(*piece).exists()]
    assert 2 <= len(kept) < 5
    computed = []
    spied = integration._integrate_piece
    monkeypatch.setattr(integration, "_integrate_piece", lambda *a: (computed.append(a[1:3]), spied(*a)))
    resumed = complete(store, 1, Tracker([store], None))
    assert sorted(computed + kept) == list(store.run.pieces())
    for array in ("exponent", "start", "outcome", "n_steps"):
        np.testing.assert_array_equal(getattr(resumed, array), getattr(whole, array))


def test_pieces_hold_the_members_that_one_call_gives(tmp_path, monkeypatch):
    monkeypatch.setattr(runs, "PIECE_SIZE", 16)
    run = one_run(SMALL, "ordinary-gaussian")
    members = integrate(tmp_path, SMALL, run.name)
    top = run.top()
    x0 = lp.sample_states(top, 50, seed=0, ensemble="gaussian")
    growth = lp.finite_time_exponents(top, x0, times=run.time, seed=0, method=lp.Taylor(tol=run.tolerance))
    np.testing.assert_array_equal(members.exponent, growth.exponent)
    np.testing.assert_array_equal(members.start, x0)


def test_finished_run_is_one_netcdf_file_that_can_be_run_again(tmp_path):
    members = integrate(tmp_path, SMALL, "twisted-cube")
    path = tmp_path / "data" / "twisted-cube.nc"
    assert not (tmp_path / "pieces").exists()
    dataset = lp.load(path).dataset
    np.testing.assert_array_equal(dataset["exponent"], members.exponent)
    np.testing.assert_array_equal(lp.rerun(path).exponent, members.exponent)


def test_finished_run_is_read_and_not_integrated_again(tmp_path, monkeypatch):
    first = integrate(tmp_path, SMALL, "twisted-cube")
    monkeypatch.setattr(integration, "_integrate_piece", None)
    again = integrate(tmp_path, SMALL, "twisted-cube")
    assert dataclasses.asdict(again).keys() == dataclasses.asdict(first).keys()
    np.testing.assert_array_equal(again.exponent, first.exponent)
    assert (again.seconds, again.order, again.kernel) == (first.seconds, first.order, first.kernel)


@pytest.mark.parametrize("change", [{"seed": 1}, {"end_time": 70.0}, {"tolerance": 1e-12}])
def test_work_with_other_options_is_neither_used_nor_overwritten(tmp_path, monkeypatch, change):
    store = stored_piece(tmp_path, monkeypatch)
    other = dataclasses.replace(SMALL, **change)
    with pytest.raises(ParameterError, match="other options"):
        integrate(tmp_path, other, "twisted-unit-vectors")
    assert list(store.folder.iterdir()) == [store.piece_path(0, 25)]
    integrate(tmp_path, SMALL, "twisted-unit-vectors")
    with pytest.raises(ParameterError, match=f"{next(iter(change))} .* instead of"):
        integrate(tmp_path, other, "twisted-unit-vectors")


def test_fresh_discards_stored_work_and_nothing_else(tmp_path):
    integrate(tmp_path, SMALL, "twisted-cube")
    (tmp_path / "notes.txt").write_text("mine")
    discard(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]
    discard(tmp_path / "absent")


def test_fresh_leaves_files_of_others_in_data_and_pieces(tmp_path):
    mine = [
        "data/mine.nc",
        "data/twisted-cube.nc.bak",
        "data/notes/twisted-cube.nc",
        "pieces/notes.txt",
        "pieces/twisted-cube/notes.txt",
        "pieces/twisted-cube/my-000000-000049.npz",
        "pieces/my-run/000000-000049.npz",
    ]
    ours = [
        "data/twisted-cube.nc",
        "data/twisted-cube.nc.7-0af3.partial",
        "data/manifest.json",
        "data/manifest.json.partial",
        "pieces/twisted-cube/000000-000049.npz",
        "pieces/twisted-cube/000050-000099.npz.partial",
        "pieces/twisted-cube/000050-000099.npz.12-ab34cd56.partial",
        "pieces/ordinary-cube/99998000-99999999.npz",
    ]
    for name in mine + ours:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("")
    discard(tmp_path)
    assert sorted(str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*") if path.is_file()) == sorted(mine)
    assert not (tmp_path / "pieces" / "ordinary-cube").exists()


def test_finished_run_leaves_files_of_others_among_its_pieces(tmp_path):
    notes = tmp_path / "pieces" / "twisted-cube" / "notes.txt"
    notes.parent.mkdir(parents=True)
    notes.write_text("mine")
    integrate(tmp_path, SMALL, "twisted-cube")
    assert list(notes.parent.iterdir()) == [notes]


def test_folder_of_another_run_is_neither_used_nor_discarded(tmp_path):
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "twisted-cube.nc").write_text("")
    with exclusive(tmp_path), pytest.raises(OutputError, match="another run is using"):
        reproduce(SMALL, tmp_path, fresh=True, progress=lambda *_: pytest.fail("it started"))
    assert (tmp_path / "data" / "twisted-cube.nc").exists()


def test_output_below_a_file_is_refused(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="choose another folder"):
        reproduce(SMALL, tmp_path / "file" / "out")
    with pytest.raises(OutputError, match="choose another folder"):
        reproduce(SMALL, tmp_path / "file")


@pytest.mark.thorough
def test_study_killed_without_warning_resumes(tmp_path):
    code = (
        "from pathlib import Path; import sys\n"
        "from liepoisson.studies.twisted_top import runs, study\n"
        "runs.PIECE_SIZE = 10\n"
        "study.reproduce(runs.Settings(members=3000, end_time=60.0), Path(sys.argv[1]))"
    )
    process = subprocess.Popen([sys.executable, "-c", code, str(tmp_path)])
    folder = tmp_path / "pieces" / "twisted-unit-vectors"
    until = time.monotonic() + 60
    try:
        while not (folder.exists() and len(list(folder.glob("*.npz"))) >= 3):
            assert process.poll() is None
            assert time.monotonic() < until
            time.sleep(0.01)
    finally:
        process.kill()
        process.wait()
    kept = len(list(folder.glob("*.npz")))
    assert kept < 300, "killed too late for this test"
    settings = Settings(members=3000, end_time=60.0)
    store = RunStore(tmp_path, one_run(settings, "twisted-unit-vectors"))
    runs.PIECE_SIZE, usual = 10, runs.PIECE_SIZE
    try:
        missing = len(store.missing_pieces())
        assert missing == 300 - kept
        resumed = complete(store, None, Tracker([store], None))
    finally:
        runs.PIECE_SIZE = usual
    np.testing.assert_array_equal(
        resumed.exponent, integrate(tmp_path / "whole", settings, "twisted-unit-vectors").exponent
    )


def test_a_run_removes_what_a_killed_one_was_writing_and_nothing_else(tmp_path):
    mine = ["data/my.txt.1-00000000.partial", "notes.1-00000000.partial", "data/x.nc.partial"]
    left = [
        "claims.json.7-0af30af3.partial",
        "report.html.7-0af30af3.partial",
        "data/twisted-cube.nc.7-0af30af3.partial",
        "data/manifest.json.7-0af30af3.partial",
        "pieces/twisted-cube/000050-000099.npz.12-ab34cd56.partial",
    ]
    for name in mine + left:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("")
    remove_unfinished(tmp_path)
    assert sorted(str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*") if path.is_file()) == sorted(mine)
    remove_unfinished(tmp_path / "absent")


def test_a_fingerprint_has_all_that_determines_the_numbers_of_a_run():
    fields = {field.name for field in dataclasses.fields(one_run(SMALL, "twisted-cube"))}
    names = {"run" if name == "name" else name for name in fields - {"members"}}
    assert fingerprint(one_run(SMALL, "twisted-cube")).keys() == names | {"times", "version"}
