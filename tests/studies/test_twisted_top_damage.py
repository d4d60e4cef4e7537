"""What the study of the twisted top says of stored work that is damaged."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest
from small_study import SMALL, integrate, one_run, stored_piece

from liepoisson.errors import DamagedFileError
from liepoisson.studies.twisted_top.store import RunStore, fingerprint


def refusal_of(store):
    try:
        store.load_piece(0, 25)
    except DamagedFileError as error:
        return str(error)
    return None


def test_damaged_piece_is_named_and_what_to_do_is_said(tmp_path, monkeypatch):
    store = stored_piece(tmp_path, monkeypatch)
    path = store.piece_path(0, 25)
    sound, content = store.load_piece(0, 25)[0], path.read_bytes()
    generator = np.random.default_rng(3)
    damaged = [b"", content[:100], content[: len(content) // 2], content[:-30], b"x" * len(content)]
    for position in generator.integers(0, len(content), 60):
        flipped = bytearray(content)
        flipped[position] ^= 1 << int(generator.integers(0, 8))
        damaged.append(bytes(flipped))
    n_refused = 0
    for version in damaged:
        path.write_bytes(version)
        message = refusal_of(store)
        if message is None:
            # A bit of the archive that carries no data, such as a time stamp, was hit.
            for name, array in store.load_piece(0, 25)[0].items():
                np.testing.assert_array_equal(array, sound[name])
        else:
            n_refused += 1
            assert str(path) in message
            assert "--fresh" in message
    assert n_refused >= 55


def test_piece_with_altered_numbers_is_found_by_its_checksum(tmp_path, monkeypatch):
    store = stored_piece(tmp_path, monkeypatch)
    path = store.piece_path(0, 25)
    with np.load(path) as archive:
        arrays = dict(archive)
    arrays["exponent"][3, 4] += 1e-9
    np.savez(path, **arrays)
    with pytest.raises(DamagedFileError, match="checksum"):
        store.load_piece(0, 25)


def test_damaged_data_file_is_found_by_its_checksum(tmp_path):
    integrate(tmp_path, SMALL, "twisted-cube")
    path = tmp_path / "data" / "twisted-cube.nc"
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 4
    path.write_bytes(bytes(content))
    with pytest.raises(DamagedFileError, match=re.escape(str(path))):
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


@pytest.mark.parametrize(
    "change", [{"fingerprint": 5}, {"fingerprint": [1]}, {"sha256": 5}, {"seconds": "x"}, {"order": "x"}, {"kernel": 1}]
)
def test_piece_that_says_something_of_another_form_is_damaged(tmp_path, change):
    store = RunStore(tmp_path, one_run(SMALL, "twisted-cube"))
    store.folder.mkdir(parents=True)
    path = store.piece_path(0, 50)
    facts = {**RECORD, "fingerprint": fingerprint(store.run), "order": 20, "kernel": "scalar"}
    np.savez(path, facts=np.array(json.dumps(facts)))
    assert store.missing_pieces() == []
    np.savez(path, facts=np.array(json.dumps({**facts, **change})))
    with pytest.raises(DamagedFileError, match=re.escape(str(path))):
        store.missing_pieces()
