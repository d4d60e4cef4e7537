"""The page of benchmarks: what it says of each processor is what the files in benchmarks/processors/ say."""

import copy
import re
import shutil
from pathlib import Path

from script_folders import modules_of

ROOT = Path(__file__).parent.parent
FOLDER = ROOT / "benchmarks"


report, processors, kernels = modules_of(FOLDER, "report", "processors", "kernels")
FILES = processors.load()
KNOWN = next(one for one in FILES if one["processor"]["vendor_id"] == "GenuineIntel")
BLOCK = re.compile(r"<!-- table ([\w.-]+) -->\n(.*?)<!-- end of table -->", re.DOTALL)


def page(*documents):
    texts = [document.read_text(encoding="utf-8") for document in documents or (report.DOCUMENT, report.DETAILS)]
    return dict(BLOCK.findall("".join(texts)))


def test_the_page_shows_what_the_files_say():
    shown = page()
    for name, text in report.blocks({}, FILES).items():
        assert shown[name] == f"\n{text}\n", name


def row(seconds, model):
    """A table of the ensembles as `run.py` writes it: who, of what kind, with which instructions, and how long."""
    measured = []
    for (name, kind, simd), times in seconds.items():
        request = {"method": {"tol": 1e-13, "name": name.removesuffix(", AVX2")}}
        setting = {"request": request, "order": 20, "state": 2e-14, "tangent": 3e-14, "meets": True}
        contender = {"name": name, "side": name.split()[0].strip(","), "kind": kind, "simd": simd, "work": None}
        contender |= {"request": request, "setting": setting}
        measured.append({"contender": contender, "seconds": times, "answers": [{}]})
    facts = copy.deepcopy(KNOWN["facts"]) | {"date": "2099-01-02T03:04"}
    facts["processor"]["model"] = model
    head = {"kind": "row", "title": "Ensemble", "work": 1e5, "wall": False, "absent": {}, "rounds": 3}
    return head | {"measured": measured, "facts": facts}


SECONDS = {
    ("heyoka", "", None): [2.0, 2.2, 2.4],
    ("heyoka, fast_math", "", None): [1.0, 1.2, 1.5],
    ("liepoisson Taylor", "double", None): [0.5, 0.5, 0.5],
    ("liepoisson Taylor, mixed precision", "mixed", None): [0.25, 0.2, 0.25],
    ("liepoisson Taylor, both errors at most heyoka's", "", None): [0.1, 0.1, 0.1],
    ("liepoisson Taylor, AVX2", "", "avx2"): [2.0, 2.0, 2.0],
}


def test_a_new_run_renews_its_own_rows_and_takes_the_head(tmp_path):
    folder, documents = tmp_path / "processors", [tmp_path / "benchmarks.md", tmp_path / "tables.md"]
    shutil.copytree(processors.FOLDER, folder)
    for document, known in zip(documents, (report.DOCUMENT, report.DETAILS), strict=True):
        shutil.copy(known, document)
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    tables = {"1e-13": row(SECONDS, model="999")}
    assert processors.update(folder, tables) == ["genuineintel-6-999.json"]
    assert all((folder / name).read_bytes() == content for name, content in before.items())
    files = processors.load(folder)
    found = next(one for one in files if one["processor"]["model"] == "999")["rows"]["1e-13"]["lines"]
    said = [(line["kind"], line["simd"], line["ratios"]["rounds"], line["heyoka"]["name"]) for line in found]
    peer = "heyoka, fast_math"
    assert said == [("double", "avx512", 2.4, peer), ("mixed", "avx512", 6.0, peer), ("double", "avx2", 0.6, peer)]

    for document in documents:
        report.write_document(document, report.blocks(tables, files))
    shown = page(*documents)
    assert "The detailed tables are of GenuineIntel family 6 model 999" in shown["head"]
    assert shown["summary"].startswith("\nMeasured on GenuineIntel family 6 model 999, 2099-01-02.")
    assert "model 999" in shown["environment"]
    assert "model 999" in shown["1e-13"]
    first = shown["processors"].splitlines()
    cells = dict(zip(first[3].split(" | "), first[5].split(" | "), strict=True))
    assert cells["GenuineIntel family 6 model 999, AVX-512"] == "2.40"
    assert {ratio for column, ratio in cells.items() if column.startswith("GenuineIntel family 6 model 999, AVX2")} == {
        "**0.60** |"
    }
    for name, text in page().items():  # what was not measured again stays, with its processor
        if name not in ("head", "summary", "environment", "processors", "1e-13"):
            assert shown[name] == text, name


def test_an_older_table_does_not_replace_a_newer_row(tmp_path):
    processors.update(tmp_path, {"1e-13": row(SECONDS, model="999")})
    old = row({name: [10.0] for name in SECONDS}, model="999")
    old["facts"]["date"] = "2098-01-01"
    written = (tmp_path / "genuineintel-6-999.json").read_bytes()
    processors.update(tmp_path, {"1e-13": old})
    assert (tmp_path / "genuineintel-6-999.json").read_bytes() == written


def test_mixed_precision_does_less_than_double():
    order, tol = 22, 5.6e-14
    mixed, double = kernels.mixed_taylor_operations(order, tol), kernels.taylor_operations(order)
    assert mixed["f64"] < 0.2 * double  # the state up to half the order is a quarter of a third
    assert 0.3 * double < sum(mixed.values()) < 0.8 * double


def test_a_kernel_of_two_precisions_is_compared_with_both_peaks():
    request = {"method": {"tol": 1e-9}}
    contender = {"name": "Mixed, avx512", "simd": "avx512", "setting": {"request": request}}
    one = {"contender": contender, "seconds": [6.0, 5.0], "answers": [{"n_steps": 10**9}]}
    data = {
        "peaks": {"avx512 f64": 100.0, "avx512 f32": 200.0},
        "operations": {"Mixed, avx512": {"f64": 100, "f32": 300}},
    }
    facts = {"date": "2099-01-01"}
    reached = processors.peak_of(data | {"measured": [one], "rounds": 2}, facts)["reached"]
    # at the peaks a step would take 1 + 1.5 ns, and it takes 5
    assert reached == [{"kernel": "Mixed", "simd": "avx512", "gflops": 80.0, "fraction": 0.5}]
    assert kernels.lines(data | {"measured": [one]})[1][2:] == ["5.0", "80.0", "160.0 (avx512 f64 and f32)", "50%"]
