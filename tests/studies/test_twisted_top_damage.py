"""What the study of the twisted top says of stored work that is damaged."""

from __future__ import annotations

import dataclasses
import json
import re

import numpy as np
import pytest
from small_study import SMALL, integrate, one_run, stored_piece

from liepoisson.errors import DamagedFileError, ParameterError
from liepoisson.studies.twisted_top import runs
from liepoisson.studies.twisted_top.integration import RunStore


def test_damaged_piece_is_named_and_what_to_do_is_said(tmp_path, monkeypatch):
    store = stored_piece(tmp_path, monkeypatch)
    path = store.piece_path(0, 25)
    content = path.read_bytes()
    generator = np.random.default_rng(3)
    damaged = [b"", content[:100], content[: len(content) // 2], content[:-30], b"x" * len(content)]
    for position in generator.integers(0, len(content), 60):
        flipped = bytearray(content)
        flipped[position] ^= 1 << int(generator.integers(0, 8))
        damaged.append(bytes(flipped))
    for version in damaged:
        path.write_bytes(version)
        with pytest.raises(DamagedFileError, match=f"{re.escape(str(path))}.*start over"):
            store.load(path)


def test_a_piece_that_is_not_recorded_is_computed_again(tmp_path, monkeypatch):
    store = stored_piece(tmp_path, monkeypatch)
    assert store.missing_pieces() == [(25, 25)]
    store.data.with_name("manifest.json").unlink()
    store.piece_path(0, 25).write_bytes(b"not a file of ours")
    assert store.missing_pieces() == [(0, 25), (25, 25)]


def test_pieces_of_another_number_of_members_are_not_lost(tmp_path, monkeypatch):
    store = stored_piece(tmp_path, monkeypatch)
    monkeypatch.setattr(runs, "PIECE_SIZE", 20)
    with pytest.raises(ParameterError, match="another number of trajectories than 40"):
        integrate(tmp_path, dataclasses.replace(SMALL, members=40), "twisted-unit-vectors")
    assert store.piece_path(0, 25).exists()


def test_damaged_data_file_is_found_by_its_checksum(tmp_path):
    integrate(tmp_path, SMALL, "twisted-cube")
    path = tmp_path / "data" / "twisted-cube.nc"
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 4
    path.write_bytes(bytes(content))
    with pytest.raises(DamagedFileError, match=rf"^{re.escape(str(path))} is damaged: its checksum"):
        integrate(tmp_path, SMALL, "twisted-cube")
    path.unlink()
    integrate(tmp_path, SMALL, "twisted-cube")


RECORD = {"fingerprint": {}, "sha256": "0", "seconds": 1.0}


@pytest.mark.parametrize(
    "content",
    [
        *([1], {"run": 5}, {"run": {}}, {"run": {**RECORD, "fingerprint": 5}}, {"run": {**RECORD, "sha256": None}}),
        {"run": {**RECORD, "seconds": 10**400}},
    ],
)
def test_manifest_of_another_form_is_damaged(tmp_path, content):
    store = RunStore(tmp_path, one_run(SMALL, "twisted-cube"))
    store.data.parent.mkdir()
    store.data.write_bytes(b"")
    path = store.data.with_name("manifest.json")
    path.write_text(json.dumps(content).replace("run", store.run.name))
    with pytest.raises(DamagedFileError, match=r"manifest\.json .*every finished run is computed anew"):
        store.missing_pieces()
