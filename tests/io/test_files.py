"""Writing files whole or not at all, never over something that is no file, and one process to a folder."""

from __future__ import annotations

import errno
import os
import stat
import subprocess
import sys
from pathlib import Path

import pytest

import liepoisson as lp
from liepoisson.errors import OutputError
from liepoisson.io.files import exclusive, write_atomically

HOLD = (
    "import sys, pathlib; from liepoisson.io.files import exclusive\n"
    "with exclusive(pathlib.Path(sys.argv[1])):\n    print('held', flush=True); sys.stdin.read()"
)


def test_file_is_written_replaced_and_nothing_else_is_left(tmp_path):
    path = tmp_path / "new" / "file"
    for content in (b"one", b"two"):
        write_atomically(path, content)
        assert path.read_bytes() == content
    assert list(path.parent.iterdir()) == [path]


def test_unfinished_write_leaves_the_old_file(tmp_path, monkeypatch):
    path = tmp_path / "file"
    write_atomically(path, b"old")

    def full(descriptor):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OutputError, match="Free some space"):
        write_atomically(path, b"new")
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("name", ["", ".", "..", "/", "a\0b", "\ud800"])
def test_name_of_no_file_is_refused(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(OutputError, match="could not write"):
        write_atomically(Path(name), b"content")
    assert list(tmp_path.iterdir()) == []


def test_folder_pipe_and_link_to_itself_are_refused_and_stay(tmp_path):
    (tmp_path / "folder").mkdir()
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "link").symlink_to(tmp_path / "pipe")
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    before = {path: path.lstat().st_mode for path in tmp_path.iterdir()}
    for name, words in (("folder", "got a folder"), ("pipe", "a regular file"), ("link", "pipe"), ("loop", "loop")):
        with pytest.raises(OutputError, match=words):
            write_atomically(tmp_path / name, b"content")
    assert {path: path.lstat().st_mode for path in tmp_path.iterdir()} == before


def test_device_is_refused_and_stays(monkeypatch):
    # Should the check be gone, the device of this machine must not be replaced by the test.
    monkeypatch.setattr(Path, "replace", lambda *_: pytest.fail("the device would have been replaced"))
    with pytest.raises(OutputError, match=r"/dev/null.*got a device"):
        write_atomically(Path("/dev/null"), b"content")
    assert stat.S_ISCHR(os.stat("/dev/null").st_mode)


@pytest.mark.parametrize("exists", [True, False])
def test_link_stays_and_its_target_is_written(tmp_path, exists):
    target, link = tmp_path / "target", tmp_path / "link"
    link.symlink_to("target")
    if exists:
        target.write_bytes(b"old")
    write_atomically(link, b"new")
    assert link.is_symlink()
    assert target.read_bytes() == b"new"
    assert sorted(tmp_path.iterdir()) == [link, target]


def test_folder_is_made_held_by_one_and_free_again(tmp_path):
    folder = tmp_path / "new" / "out"
    for _ in range(2):
        with exclusive(folder):
            with pytest.raises(OutputError, match=r"another run is using .*out: wait for it to end, or choose"):
                exclusive(folder).__enter__()
            assert (folder / ".lock").exists()
        assert list(folder.iterdir()) == []


def test_process_that_is_killed_gives_the_folder_free(tmp_path):
    command = [sys.executable, "-c", HOLD, str(tmp_path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        assert process.stdout.readline() == b"held\n"
        with pytest.raises(OutputError, match="another run"):
            exclusive(tmp_path).__enter__()
        process.kill()
        process.wait()
    with exclusive(tmp_path):
        pass
    assert list(tmp_path.iterdir()) == []


def test_lock_removed_by_its_last_holder_is_taken_anew(tmp_path, monkeypatch):
    import fcntl

    usual, calls = fcntl.flock, []

    def late(descriptor, operation):
        if not calls:
            (tmp_path / ".lock").unlink()
        calls.append(descriptor)
        usual(descriptor, operation)

    monkeypatch.setattr(fcntl, "flock", late)
    with exclusive(tmp_path):
        assert len(calls) == 2
        assert (tmp_path / ".lock").exists()


KILLED = (
    "import os, sys, pathlib; from liepoisson.io.files import write_atomically\n"
    "os.fsync = lambda _: (print('writes', flush=True), sys.stdin.read())\n"
    "write_atomically(pathlib.Path(sys.argv[1]), b'half')"
)


@pytest.fixture
def writer(tmp_path):
    """A process in the middle of writing `file`."""
    process = subprocess.Popen(
        [sys.executable, "-c", KILLED, str(tmp_path / "file")], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    )
    assert process.stdout.readline() == b"writes\n"
    yield process
    process.kill()
    process.communicate()


def test_what_a_killed_process_has_left_is_removed_by_the_next_one_that_writes_the_file(tmp_path, writer):
    path, other = tmp_path / "file", tmp_path / "other"
    write_atomically(path, b"new")
    write_atomically(other, b"new")
    assert len(list(tmp_path.glob("*.partial"))) == 1  # it is alive
    writer.kill()
    writer.communicate()
    write_atomically(other, b"new")
    assert len(list(tmp_path.glob("*.partial"))) == 1  # of another file
    write_atomically(path, b"newer")
    assert sorted(tmp_path.iterdir()) == [path, other]


def test_what_is_no_regular_file_is_not_waited_for(tmp_path):
    pipe = tmp_path / "pipe"
    if hasattr(os, "mkfifo"):
        os.mkfifo(pipe)
    for read in (
        lp.integrability.load_certificate,
        lp.integrability.load_report,
        lp.proofs.load_covering_certificate,
    ):
        for path in (Path("/dev/zero"), pipe):
            if path.exists():
                with pytest.raises(lp.errors.DamagedFileError):
                    read(path)


def test_the_signature_of_a_large_file_is_read_first(tmp_path):
    path = tmp_path / "large.nc"
    with path.open("wb") as file:
        file.truncate(2**40)  # sparse: it takes no room, and no memory could hold it
    with pytest.raises(lp.errors.DamagedFileError, match="another kind of file"):
        lp.load(path)
