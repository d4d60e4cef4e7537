"""Makes the stored files of the formats that this version writes; run it only when a format gets a new number.

python tests/data/saved/make.py

Its files are kept as they are, since tests/io/test_formats.py asks whether later versions read them. So it refuses
to write over one. `result-1.nc`, `sweep-1` and `integral-scan-1` were written by the states of 0.1.0 that wrote these
formats.
"""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import liepoisson as lp
from liepoisson.integrability import certificates, report
from liepoisson.proofs.certificate import FORMAT as COVERING_FORMAT

FOLDER = Path(__file__).parent
COVERING = FOLDER.parents[1] / "proofs" / "heavy_top.json"


def number(text: str) -> str:
    """The number of a format, with which the name of its file ends."""
    return text.rpartition("/")[2]


def free(name: str) -> Path:
    """A path at which nothing is."""
    path = FOLDER / name
    if path.exists():
        raise SystemExit(f"{path} is there, and stays: later versions are asked whether they read it")
    return path


def scanned() -> lp.System:
    """The system of the scan of integrals: a Lagrange top, for each J."""
    return lp.System(lp.so(3) @ lp.leibniz(2, epsilon=0), "(l1^2 + l2^2 + J*l3^2)/2 + alpha3", symbols=["J"])


def main() -> None:
    """Writes one file of each kind."""
    top = lp.Top.twisted_kovalevskaya()
    growth = lp.finite_time_exponents(top, lp.sample_states(top, 2, seed=1), times=[1, 2, 5], seed=3)
    growth.save(free("result-2.nc"))
    henon = lp.catalog.system("henon-heiles")
    lp.orbits.symmetric_periodic_orbits(henon, {}, energy="1/10", n_starts=3).save(free("orbits-2.nc"))
    axes = {"energy": [0.0, 1.0]}
    store = free("sweep-2")
    lp.sweep(system="twisted-kovalevskaya", axes=axes, n_starts=2, t_end=5.0, seed=2, store=store, threads=1)
    (store / ".lock").unlink(missing_ok=True)
    found = lp.integrability.integrability_report(lp.Top.lagrange())
    found.save(free(f"integrability-report-{number(report.FORMAT)}.json"))
    proof = free(f"integrability-certificate-{number(certificates.FORMAT)}.json")
    lp.integrability.save_certificate(found.certificate, proof)
    covering = free(f"covering-certificate-{number(COVERING_FORMAT)}.json")
    record = json.loads(COVERING.read_text(encoding="utf-8"))
    covering.write_text(json.dumps({"format": COVERING_FORMAT} | record, indent=1) + "\n", encoding="utf-8")
    scan = free("integral-scan-2")
    lp.integrability.scan_integrals(scanned(), degree=2, axes={"J": [1, 2]}, store=scan)
    (scan / ".lock").unlink(missing_ok=True)


if __name__ == "__main__":
    main()
    shutil.rmtree(FOLDER / "__pycache__", ignore_errors=True)
