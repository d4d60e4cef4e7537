"""How the study of the twisted top stores its work, resumes it, and keeps its hands off what is not its own."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from small_study import SMALL, integrate, one_run, stored_piece

import liepoisson as lp
from liepoisson.errors import ParameterError
from liepoisson.studies.twisted_top import integration, runs
from liepoisson.studies.twisted_top.integration import Tracker, complete
from liepoisson.studies.twisted_top.store import RunStore, discard, fingerprint, remove_unfinished


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
