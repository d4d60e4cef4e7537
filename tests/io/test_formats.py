"""Files that earlier versions wrote are read, or refused with the version that reads them; docs/saved-results.md."""

import json
import re
import shutil
import warnings
from pathlib import Path

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import DamagedFileError, LiePoissonError
from liepoisson.integrability import certificates, report, scan_points
from liepoisson.io import dataset
from liepoisson.proofs import certificate
from liepoisson.sweeps import store
from script_folders import modules_of

ROOT = Path(__file__).parents[2]
SAVED = Path(__file__).parents[1] / "data" / "saved"
(MAKER,) = modules_of(SAVED, "make")
VERSION = re.escape(lp.__version__)

WRITTEN = {
    "result": dataset.FORMAT,
    "orbits": dataset.FORMAT,
    "sweep": str(store._FORMAT),
    "integrability-certificate": certificates.FORMAT,
    "integrability-report": report.FORMAT,
    "covering-certificate": certificate.FORMAT,
    "integral-scan": scan_points.FORMAT,
}
"""Kind of file, and the format that this version writes."""

GROWTH = [[0.26294994, 0.27253518, 0.08056468], [0.24384967, 0.19260535, 0.02957618]]
EXPONENTS = [[0.1773002, 0.45028129], [0.33452017, 0.17622273]]
"""Of result-2 and sweep-2, printed when it was made."""


def number(text):
    """The number with which the name of a format ends."""
    return re.search("[0-9]+$", text)[0]


def test_a_file_of_each_format_that_is_written_is_kept():
    """When a format gets a new number, a file of the old one is here already, and must be read or refused by name."""
    kept = {path.stem for path in SAVED.iterdir()} - {"make", "__pycache__"}
    assert {f"{kind}-{number(text)}" for kind, text in WRITTEN.items()} <= kept
    assert kept == {
        *(f"{kind}-{number(text)}" for kind, text in WRITTEN.items()),
        "result-1",
        "sweep-1",
        "integral-scan-1",
    }


def test_a_result_is_read_with_its_numbers_and_repeated():
    growth = lp.load(SAVED / "result-2.nc")
    assert (growth.outcome == "finished").all()
    assert growth.time.tolist() == [1, 2, 5]
    np.testing.assert_allclose(growth.exponent, GROWTH, atol=5e-9)
    assert growth.system.equations == lp.Top.twisted_kovalevskaya().equations
    with warnings.catch_warnings():  # a later version warns that it is another one
        warnings.simplefilter("ignore", UserWarning)
        again = lp.rerun(growth)
    np.testing.assert_allclose(again.exponent, growth.exponent, rtol=1e-10)


def test_orbits_are_read_and_go_on():
    found = lp.load(SAVED / "orbits-2.nc")
    assert [round(one.period, 8) for one in found] == [6.79438483, 6.11049968, 7.10595715, 42.21783987]
    assert lp.orbits.periodic_orbit(found.system, found[0]).period == pytest.approx(found[0].period, rel=1e-12)


def test_a_sweep_is_read_with_its_numbers():
    sweep = lp.load(SAVED / "sweep-2")
    assert sweep.is_complete
    np.testing.assert_allclose(sweep.value, EXPONENTS, atol=5e-9)


def test_an_integrability_certificate_is_read_and_checked():
    data = lp.integrability.load_certificate(SAVED / "integrability-certificate-1.json")
    assert set(data["commuting"]) == {"H", "F1", "F2"}
    assert ["1", [0, 0, 1, *[0] * 6]] in data["commuting"]["F1"]  # l3


def test_an_integrability_report_is_read_and_verified():
    found = lp.integrability.load_report(SAVED / "integrability-report-1.json")
    assert found.certificate == lp.integrability.load_certificate(SAVED / "integrability-certificate-1.json")


def test_a_scan_of_integrals_goes_on_from_its_points(tmp_path):
    folder = tmp_path / "scan"
    shutil.copytree(SAVED / "integral-scan-2", folder)
    before = (folder / "points.jsonl").read_bytes()
    scan = lp.integrability.scan_integrals(MAKER.scanned(), degree=2, axes={"J": [1, 2]}, store=folder)
    assert scan.complete
    assert (folder / "points.jsonl").read_bytes() == before


def test_a_result_of_format_1_is_refused_with_the_version_that_reads_it():
    words = rf"format liepoisson/1, and liepoisson {VERSION} reads liepoisson/2 alone; .* wrote it \(.*0\.1\.0"
    with pytest.raises(DamagedFileError, match=words):
        lp.load(SAVED / "result-1.nc")


def test_a_sweep_of_format_1_is_refused_with_the_version_that_reads_it(tmp_path):
    words = rf"format 1, and liepoisson {VERSION} reads 2 alone; .* wrote it \(.*0\.1\.0"
    with pytest.raises(LiePoissonError, match=words):
        lp.load(SAVED / "sweep-1")
    folder = tmp_path / "sweep"
    shutil.copytree(SAVED / "sweep-1", folder)
    with pytest.raises(LiePoissonError, match=words + r".*--fresh"):
        lp.sweep(
            system="twisted-kovalevskaya", axes={"energy": [0.0, 1.0]}, n_starts=2, t_end=5.0, seed=2, store=folder
        )


READERS = {
    "integrability-certificate": lp.integrability.load_certificate,
    "integrability-report": lp.integrability.load_report,
    "covering-certificate": lp.proofs.load_covering_certificate,
}


@pytest.mark.parametrize("kind", READERS)
def test_a_later_format_is_refused_with_the_version_that_reads_the_present_one(tmp_path, kind):
    data = json.loads((SAVED / f"{kind}-1.json").read_text())
    later = data["format"].removesuffix("/1") + "/7"
    path = tmp_path / "later.json"
    path.write_text(json.dumps(data | {"format": later}))
    with pytest.raises(DamagedFileError, match=rf"format {later}, and liepoisson {VERSION} reads .*/1 alone"):
        READERS[kind](path)


def test_a_later_version_reads_a_sweep_and_does_not_go_on_with_it(tmp_path, monkeypatch):
    for module in ("liepoisson.sweeps.spec", "liepoisson.sweeps.store"):
        monkeypatch.setattr(f"{module}.__version__", "9.9.9")
    folder = tmp_path / "sweep"
    shutil.copytree(SAVED / "sweep-2", folder)
    sweep = lp.load(folder)
    assert sweep.is_complete
    np.testing.assert_allclose(sweep.value, EXPONENTS, atol=5e-9)
    with pytest.raises(LiePoissonError, match=r"holds another sweep: .*version"):
        lp.sweep(
            system="twisted-kovalevskaya", axes={"energy": [0.0, 1.0]}, n_starts=2, t_end=5.0, seed=2, store=folder
        )
