"""Files that were damaged or made to harm: refused with a sentence before anything of them is used."""

import io
import os
import signal
import threading
import time
import tracemalloc
import warnings
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr

import liepoisson as lp
from liepoisson.errors import DamagedFileError, OutputError
from liepoisson.io.dataset import read_dataset
from liepoisson.io.netcdf import Trial, netcdf, read_netcdf

TOP = lp.Top(inertia=(2, 1.5, 1), a=(-1, 0.1, 0.2), b=(0.4, 0, -0.7), epsilon=0.8)
STATES = lp.sample_states(TOP, 3, seed=1)

RUNS = {
    "orbit": lambda: lp.integrate(TOP, STATES, times=np.linspace(1, -2, 7), tangents=np.eye(9)[:2]),
    "growth": lambda: lp.finite_time_exponents(TOP, STATES, t_end=3),
    "section": lambda: lp.section(TOP, STATES, surface="l3", t_end=10, keep=["l1", "l2*l3"]),
    "spectrum": lambda: lp.lyapunov_spectrum(TOP, STATES, t_end=10, transient=5, covariant=True),
}


@pytest.fixture
def path(tmp_path):
    return RUNS["growth"]().save(tmp_path / "growth.nc")


def refused_or_the_same(path, whole, **options):
    """Whether a file is refused; one that is read must have the contents of the whole file."""
    try:
        found = read_dataset(path, **options)
    except DamagedFileError:
        return True
    assert found.identical(whole)
    return False


@pytest.mark.thorough
@pytest.mark.parametrize("kind", RUNS)
def test_no_flipped_bit_changes_what_is_read(tmp_path, kind):
    path = RUNS[kind]().save(tmp_path / "run.nc")
    whole, content = read_dataset(path), path.read_bytes()
    random = np.random.default_rng(1)
    for bit in random.choice(8 * len(content), 300, replace=False).tolist():
        damaged = bytearray(content)
        damaged[bit // 8] ^= 1 << bit % 8
        path.write_bytes(damaged)
        assert refused_or_the_same(path, whole), f"bit {bit} is not covered by the checksum"


@pytest.mark.thorough
@pytest.mark.parametrize("kind", RUNS)
def test_a_damaged_file_that_is_read_without_its_checksum_is_refused_with_a_sentence(tmp_path, kind):
    """Then numbers may be wrong, but no error of another kind comes out, from `rerun` neither."""
    path = RUNS[kind]().save(tmp_path / "run.nc")
    content = path.read_bytes()
    n_flips = int(os.environ.get("LIEPOISSON_FLIPS", "150"))
    random, said, n_read, trial = np.random.default_rng(2), [], 0, Trial()
    for bit in random.choice(8 * len(content), n_flips, replace=False).tolist():
        damaged = bytearray(content)
        damaged[bit // 8] ^= 1 << bit % 8
        path.write_bytes(damaged)
        try:
            dataset = read_netcdf(path, verify=False, trial=trial)
        except DamagedFileError as error:
            said.append(str(error))
            if "does not come to an end" in said[-1]:
                trial.__exit__()
                trial = Trial()
            continue
        dataset.to_dict()
        n_read += 1
    trial.__exit__()
    assert said
    assert all(str(path) in sentence for sentence in said)
    assert n_read


NEVER_RETURNS = Path(__file__).parent / "data" / "hdf5-never-returns.nc"
"""A saved result with one bit flipped, on which HDF5 1.14 loops with the interpreter's lock held."""


def test_a_file_that_hdf5_never_ends_is_refused_within_seconds():
    begin = time.monotonic()
    with pytest.raises(DamagedFileError, match="does not come to an end"):
        lp.load(NEVER_RETURNS, verify=False)
    assert time.monotonic() - begin < 60  # 7 seconds on a quiet machine
    with pytest.raises(DamagedFileError, match="checksum"):
        lp.load(NEVER_RETURNS)


@pytest.mark.thorough
def test_ctrl_c_ends_the_wait_for_hdf5():
    threading.Timer(1.5, os.kill, (os.getpid(), signal.SIGINT)).start()
    begin = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        lp.load(NEVER_RETURNS, verify=False)
    assert time.monotonic() - begin < 4


@pytest.mark.thorough
def test_a_truncated_file_is_refused(path):
    content = path.read_bytes()
    for length in [*range(0, len(content), len(content) // 60), len(content) - 1, len(content) - 84]:
        path.write_bytes(content[:length])
        for verify in (True, False):
            if verify or length < len(content) - 84:
                with pytest.raises(DamagedFileError):
                    read_dataset(path, verify=verify)


def test_what_is_added_is_refused(path):
    path.write_bytes(path.read_bytes() + b"\n")
    with pytest.raises(DamagedFileError, match="wanted a checksum"):
        read_dataset(path)


def test_a_file_is_in_memory_once_while_it_is_made():
    numbers = xr.Dataset({"x": ("k", np.zeros(2_000_000))})
    netcdf(numbers.isel(k=slice(2)))  # what is imported and kept by the first call
    tracemalloc.start()
    try:
        content = netcdf(numbers)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < 1.5 * len(content)  # a buffer that grows has room for an eighth more


def test_a_file_with_a_checksum_is_plain_netcdf(path):
    import xarray as xr

    with h5py.File(path) as file, xr.open_dataset(path, engine="h5netcdf") as dataset:
        assert file["exponent"].shape == (3, 200)
        assert dataset.load().identical(read_dataset(path))


def test_a_file_that_was_changed_on_purpose_can_be_read_and_run(path):
    with h5py.File(path, "r+") as file:
        file["start"][0, 0] = 0.5
    with pytest.raises(DamagedFileError, match="verify=False"):
        read_dataset(path)
    with pytest.raises(DamagedFileError, match="verify=False"):
        lp.rerun(path)
    assert lp.rerun(read_dataset(path, verify=False)).start[0, 0] == 0.5


def test_a_file_that_xarray_wrote_can_be_read_and_run(path):
    dataset = read_dataset(path)
    dataset["start"][0, 0] = 0.5
    dataset.to_netcdf(path, engine="h5netcdf")
    with pytest.raises(DamagedFileError, match="verify=False"):
        read_dataset(path)
    assert lp.rerun(read_dataset(path, verify=False)).start[0, 0] == 0.5


@pytest.mark.parametrize("kind", RUNS)
def test_a_file_without_one_of_its_variables_is_refused(tmp_path, kind):
    """Along a dimension without its variable xarray counts 0, 1, 2, ...: such times would be read as times."""
    dataset = RUNS[kind]().dataset
    for name in dataset.variables:
        path = tmp_path / f"{name}.nc"
        dataset.drop_vars(name).to_netcdf(path, engine="h5netcdf")
        with pytest.raises(DamagedFileError, match=name):
            lp.load(path, verify=False)


def altered(path, change):
    """The file with its HDF5 part changed, and a checksum that is right."""
    import hashlib

    buffer = io.BytesIO(path.read_bytes())
    with h5py.File(buffer, "r+") as file:
        change(file)
    content = buffer.getvalue()
    path.write_bytes(content + b"\nliepoisson sha256 " + hashlib.sha256(content).hexdigest().encode() + b"\n")


def outside(path):
    """Another file on this machine, with numbers that shall not be read."""
    other = path.with_name("secret.h5")
    with h5py.File(other, "w") as file:
        file["x"] = np.full((3, 9), 7.0)
    other.with_suffix(".raw").write_bytes(np.full((3, 9), 7.0).tobytes())
    return other


def virtual(file, other):
    layout = h5py.VirtualLayout((3, 9), np.float64)
    layout[:] = h5py.VirtualSource(str(other), "x", (3, 9))
    file.create_virtual_dataset("secret", layout)


def external_storage(file, other):
    file.create_dataset("secret", (3, 9), np.float64, external=[(str(other.with_suffix(".raw")), 0, 216)])


def external_link(file, other):
    file["secret"] = h5py.ExternalLink(str(other), "x")


def soft_link(file, other):
    file["secret"] = h5py.SoftLink("/end_state")


def group(file, other):
    file.create_group("secret")["x"] = 1.0


def named_type(file, other):
    file["secret"] = np.dtype(np.float64)


def references(file, other):
    file.create_dataset("secret", (2,), dtype=h5py.ref_dtype)[0] = file["end_state"].ref


def regions(file, other):
    file.create_dataset("secret", (2,), dtype=h5py.regionref_dtype)


def vectors(file, other):
    file.create_dataset("secret", (2,), dtype=h5py.vlen_dtype(np.float64))


def records(file, other):
    file.create_dataset("secret", (2,), dtype=[("x", float)])


def enumeration(file, other):
    file.create_dataset("secret", (2,), dtype=h5py.enum_dtype({"a": 1}))


def compressed(file, other):
    file.create_dataset("secret", (3, 9), np.float64, compression="gzip")[:] = 0


def never_written(file, other):
    file.create_dataset("secret", (10**6, 10**6), np.float64)


def never_written_in_pieces(file, other):
    file.create_dataset("secret", (10**6, 10**6), np.float64, chunks=(1000, 1000))


def texts_in_pieces(file, other):
    file.create_dataset("secret", (4,), h5py.string_dtype(), chunks=(2,))[:] = "x"


def a_huge_attribute(file, other):
    space, kind = h5py.h5s.create_simple((8000,)), h5py.h5t.py_create(h5py.string_dtype(), logical=True)
    h5py.h5a.create(file.id, b"secret", kind, space)


def a_reference_as_attribute(file, other):
    file.attrs["secret"] = file["end_state"].ref


HARMFUL = [
    virtual, external_storage, external_link, soft_link, group, named_type, references, regions, vectors, records,
    enumeration, compressed, never_written, never_written_in_pieces, texts_in_pieces, a_huge_attribute,
    a_reference_as_attribute,
]  # fmt: skip


@pytest.mark.parametrize("harm", HARMFUL, ids=lambda harm: harm.__name__)
def test_only_what_liepoisson_writes_is_read(path, harm):
    other = outside(path)
    altered(path, lambda file: harm(file, other))
    for verify in (True, False):
        with pytest.raises(DamagedFileError, match="liepoisson did not write it"):
            read_dataset(path, verify=verify)


def test_texts_that_claim_one_place_are_refused(path):
    """A text of a megabyte and ten thousand records that name it would take ten gigabytes."""

    def repeated(file):
        texts = file.create_dataset("secret", (10_000,), h5py.string_dtype())
        texts[0] = "x" * 1_000_000
        nonlocal start
        file.flush()
        start = texts.id.get_offset()

    start = 0
    altered(path, repeated)
    content = bytearray(path.read_bytes())
    content[start : start + 160_000] = bytes(content[start : start + 16]) * 10_000
    path.write_bytes(content)
    with pytest.raises(DamagedFileError, match="larger than the file"):
        read_dataset(path, verify=False)


def test_variables_that_claim_one_place_are_refused(path):
    """A hard link is a second name of the same numbers."""

    def named_often(file):
        file["big"] = np.zeros((2000, 9))
        for k in range(20):
            file[f"again{k}"] = file["big"]

    altered(path, named_often)
    with pytest.raises(DamagedFileError, match="larger than the file"):
        read_dataset(path)


def test_a_dataset_that_is_read_is_the_one_that_was_written(path):
    dataset = read_dataset(path)
    path.write_bytes(netcdf(dataset))
    assert read_netcdf(path).identical(dataset)
    assert path.read_bytes() == netcdf(dataset)  # no times of writing: the same bytes


@pytest.mark.parametrize("name", ["a\0b", "\ud800"])
def test_a_name_that_netcdf_cannot_hold_is_refused(tmp_path, name):
    dataset = RUNS["growth"]().dataset.assign_attrs(system=name)
    with pytest.raises(OutputError, match="look at the names"):
        netcdf(dataset)


def test_no_warning_comes_from_below(path):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        again = lp.rerun(path)
    assert again.dataset.identical(read_dataset(path))
