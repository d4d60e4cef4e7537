"""The page of benchmarks: what it says of each processor is what the files in benchmarks/processors/ say."""

import copy
import re
import shutil
from pathlib import Path

import pytest

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


def test_each_table_says_its_processor():
    silent = [
        name for name, text in page().items() if not re.search(r"model \d+|^Not measured yet", text, re.MULTILINE)
    ]
    assert silent == []


@pytest.mark.parametrize("one", FILES, ids=[processors.file_of(one["processor"]) for one in FILES])
def test_a_file_has_all_fields(one):
    assert (processors.FOLDER / processors.file_of(one["processor"])).exists()
    assert {"vendor_id", "cpu family", "model", "model name", "flags"} <= one["processor"].keys()
    assert {"date", "liepoisson", "heyoka", "system", "python", "load_at_start"} <= one["facts"].keys()
    for row in one["rows"].values():
        assert {"title", "date", "rounds", "liepoisson", "heyoka", "lines"} <= row.keys()
        assert row["lines"]
        for line in row["lines"]:
            assert line.keys() == {"kind", "simd", "name", "setting", "errors", "seconds", "rate", "heyoka", "ratios"}
            assert line["heyoka"].keys() == {"name", "seconds", "rate"}
            assert line["ratios"].keys() == {"best", "median", "rounds"}
            # by what is rounded to three digits in each
            assert line["heyoka"]["rate"] is None or line["ratios"]["best"] == pytest.approx(
                line["rate"] / line["heyoka"]["rate"], rel=0.05
            )
    for part in (one["peak"] or {"reached": []})["reached"]:
        assert part.keys() == {"kernel", "simd", "gflops", "fraction"}


def test_a_ratio_below_one_is_marked():
    assert [processors.marked(ratio) for ratio in (0.994, 0.9999, 1.0, 250.3)] == [
        "**0.99**",
        "**1.00**",
        "1.00",
        "250",
    ]
    lost = sum(line["ratios"]["rounds"] < 1 for one in FILES for row in one["rows"].values() for line in row["lines"])
    assert lost > 0
    assert page()["processors"].count("| **") == lost


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


def test_other_tools_have_a_column_for_each_level():
    one = row(SECONDS, model="999")
    tables = {
        f"peers-{level}": one | {"absent": {"slow": "why"} if level == "1e-13" else {}} for level in ("1e-8", "1e-13")
    }
    lines = report.peers(tables, one["facts"])["peers"].splitlines()
    assert lines[2] == "| tool | at 1e-13 | at 1e-8 |"
    assert "| heyoka | 4.40 | 4.40 |" in lines
    assert "| slow | does not reach it |  |" in lines
    assert page()["peers"].splitlines()[1] == lines[0]


def test_an_older_table_does_not_replace_a_newer_row(tmp_path):
    processors.update(tmp_path, {"1e-13": row(SECONDS, model="999")})
    old = row({name: [10.0] for name in SECONDS}, model="999")
    old["facts"]["date"] = "2098-01-01"
    written = (tmp_path / "genuineintel-6-999.json").read_bytes()
    processors.update(tmp_path, {"1e-13": old})
    assert (tmp_path / "genuineintel-6-999.json").read_bytes() == written


def test_a_table_from_another_processor_says_all_its_facts():
    table = row(SECONDS, model="999")
    first = FILES[0]["facts"]
    assert "Load at the start" not in report.blocks({"x": table | {"facts": first}}, FILES[:1])["x"]
    assert "Load at the start" in report.blocks({"x": table}, FILES[:1])["x"]


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


def test_commands_and_spectra_become_tables():
    cases = [
        {"name": "liepoisson orbit", "target": 0.5, "seconds": 0.3},
        {"name": "other", "target": 0.1, "seconds": 1},
    ]
    facts = FILES[0]["facts"]
    commands = {"kind": "commands", "title": "Commands", "numpy": 0.06, "cases": cases, "rounds": 5, "facts": facts}
    shown = report.render(commands)
    assert "| `liepoisson orbit` | 0.30 | 5.0 | 0.25 (MISSED) |" in shown
    one = {"seconds": 3.0, "n_steps": 1_000_000, "interval": 2.0, "integration": 2.5}
    spectra = {"kind": "spectra", "title": "Spectra", "spectra": {"default": one}, "rounds": 1, "facts": facts}
    shown = report.render(spectra | {"states_alone": 0.5, "vectors": {"1": 0.3, "2": 0.2}})
    assert "| spectrum, default | 3.00 | 3.00 us a step" in shown
    assert "| su(5), each of 1 tangent vectors | 0.3000 | 1.50 of the least |" in shown
