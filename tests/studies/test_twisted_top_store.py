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
from liepoisson.studies.twisted_top import integration, runs, study
from liepoisson.studies.twisted_top.integration import (
    RunStore,
    Tracker,
    alone_in,
    complete,
    discard,
    fingerprint,
    write_text,
)


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
    spied = integration.integrate_piece
    monkeypatch.setattr(integration, "integrate_piece", lambda *a: (computed.append(a[1:3]), spied(*a)))
    resumed, _ = complete(store, 1, Tracker([store], None))
    assert sorted(computed + kept) == list(store.run.pieces())
    for array in ("exponent", "start", "outcome", "n_steps"):
        np.testing.assert_array_equal(getattr(resumed, array), getattr(whole, array))


def test_finished_run_is_one_netcdf_file_that_can_be_run_again(tmp_path):
    members = integrate(tmp_path, SMALL, "twisted-cube")
    path = tmp_path / "data" / "twisted-cube.nc"
    assert not (tmp_path / "pieces").exists()
    dataset = lp.load(path).dataset
    np.testing.assert_array_equal(dataset["exponent"], members.exponent)
    np.testing.assert_array_equal(lp.rerun(path).exponent, members.exponent)


def test_finished_run_is_read_and_not_integrated_again(tmp_path, monkeypatch):
    store = RunStore(tmp_path, one_run(SMALL, "twisted-cube"))
    first, seconds = complete(store, None, Tracker([store], None))
    monkeypatch.setattr(integration, "integrate_piece", None)
    again, same = complete(store, None, Tracker([store], None))
    assert seconds == same > 0
    assert again.dataset.identical(first.dataset)


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


def test_fresh_leaves_files_of_others_in_data_and_pieces(tmp_path):
    mine = [
        "data/mine.nc",
        "data/twisted-cube.nc.bak",
        "data/notes/twisted-cube.nc",
        "pieces/notes.txt",
        "pieces/twisted-cube/notes.txt",
        "pieces/twisted-cube/my-000000-000049.nc",
        "pieces/my-run/000000-000049.nc",
    ]
    ours = [
        "data/twisted-cube.nc",
        "data/twisted-cube.nc.7-0af3.partial",
        "data/manifest.json",
        "data/manifest.json.partial",
        "pieces/twisted-cube/000000-000049.nc",
        "pieces/twisted-cube/000050-000099.nc.partial",
        "pieces/twisted-cube/000050-000099.nc.12-ab34cd56.partial",
        "pieces/ordinary-cube/99998000-99999999.nc",
    ]
    for name in mine + ours:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("")
    discard(tmp_path)
    assert sorted(str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*") if path.is_file()) == sorted(mine)
    assert not (tmp_path / "pieces" / "ordinary-cube").exists()


def test_a_fingerprint_has_all_that_determines_the_numbers_of_a_run():
    fields = {field.name for field in dataclasses.fields(one_run(SMALL, "twisted-cube"))}
    names = {"run" if name == "name" else name for name in fields - {"members"}}
    assert fingerprint(one_run(SMALL, "twisted-cube")).keys() == names | {"times", "version"}


def test_work_without_a_record_is_never_written_over_by_another_study(tmp_path, monkeypatch):
    """As where the manifest was removed: the same study computes a piece once more, another one is refused."""
    store = stored_piece(tmp_path, monkeypatch)
    piece = store.piece_path(0, 25)
    (tmp_path / "data" / "manifest.json").unlink()
    before = piece.read_bytes()
    for change in ({"seed": 7}, {"end_time": 70.0}, {"tolerance": 1e-12}):
        with pytest.raises(ParameterError, match=f"{next(iter(change))} .* instead of"):
            integrate(tmp_path, dataclasses.replace(SMALL, **change), "twisted-unit-vectors")
        assert piece.read_bytes() == before
    assert (0, 25) in store.missing_pieces()


def test_a_text_is_whole_and_no_link_is_written_through(tmp_path):
    mine, link = tmp_path / "mine.txt", tmp_path / "claims.json.partial"
    mine.write_text("mine")
    link.symlink_to(mine)
    write_text(tmp_path / "claims.json", "{}")
    assert (mine.read_text(), (tmp_path / "claims.json").read_text()) == ("mine", "{}")
    kept = tmp_path / "kept.json"
    kept.symlink_to(tmp_path / "elsewhere.json")
    write_text(kept, "[]")
    assert kept.is_symlink()
    assert kept.read_text() == "[]"
    assert {path.name for path in tmp_path.iterdir()} == {
        "mine.txt", "claims.json.partial", "claims.json", "kept.json", "elsewhere.json"
    }  # fmt: skip


def test_a_second_run_in_the_same_folder_is_refused_before_it_removes_anything(tmp_path):
    integrate(tmp_path, SMALL, "twisted-cube")
    before = {path: path.read_bytes() for path in tmp_path.rglob("*.*") if path.is_file()}
    with alone_in(tmp_path), pytest.raises(OutputError, match=r"another run is using .*: wait for it to end"):
        study.reproduce(SMALL, tmp_path, fresh=True)
    assert before.items() <= {path: path.read_bytes() for path in tmp_path.rglob("*.*") if path.is_file()}.items()


def test_only_what_writes_says_that_it_could_not_write(tmp_path, monkeypatch):
    def fails(*_):
        raise BlockingIOError(11, "no process could be started")

    monkeypatch.setattr(study, "run_all", fails)
    with pytest.raises(BlockingIOError):
        study.reproduce(SMALL, tmp_path)
    (tmp_path / "file").write_text("")
    for writes in (lambda path: write_text(path, ""), lambda path: study.reproduce(SMALL, path)):
        with pytest.raises(OutputError, match=r"could not write .*file.*choose another folder"):
            writes(tmp_path / "file" / "out")


@pytest.mark.thorough
def test_study_killed_without_warning_resumes(tmp_path, monkeypatch):
    code = (
        "from pathlib import Path; import sys, time\n"
        "from liepoisson.studies.twisted_top import integration, runs, study\n"
        "runs.PIECE_SIZE, done = 10, integration.integrate_piece\n"
        "def waits(store, first, *rest):\n"  # it is killed before its end, however busy the machine is
        "    time.sleep(0 if first < 60 else 100)\n"
        "    done(store, first, *rest)\n"
        "integration.integrate_piece = waits\n"
        "study.reproduce(runs.Settings(members=100, end_time=60.0), Path(sys.argv[1]))"
    )
    process = subprocess.Popen([sys.executable, "-c", code, str(tmp_path / "killed")])
    folder = tmp_path / "killed" / "pieces" / "twisted-unit-vectors"
    until = time.monotonic() + 60
    try:
        while not (folder.exists() and len(list(folder.glob("*.nc"))) >= 3):
            assert process.poll() is None
            assert time.monotonic() < until
            time.sleep(0.01)
    finally:
        process.kill()
        process.wait()
    kept = len(list(folder.glob("*.nc")))
    assert kept <= 6
    settings = dataclasses.replace(SMALL, members=100, end_time=60.0)
    run = one_run(settings, "twisted-unit-vectors")
    monkeypatch.setattr(runs, "PIECE_SIZE", 10)
    store = RunStore(tmp_path / "killed", run)
    # The last piece may be written and not yet recorded: then it is computed once more.
    assert len(store.missing_pieces()) in {10 - kept, 11 - kept}
    resumed, _ = complete(store, None, Tracker([store], None))
    np.testing.assert_array_equal(resumed.exponent, integrate(tmp_path / "whole", settings, run.name).exponent)
