"""Scans of a grid of parameters: at each point as a search there, on any number of cores, interrupted or not."""

import io
import json
import pickle
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import DamagedFileError, OutputError, ParameterError
from liepoisson.inputs.deadline import Deadline
from liepoisson.integrability import integral_scan, scan_points
from liepoisson.integrability.integral_scan import scan_integrals
from liepoisson.integrability.scan_points import PointSearch

E3 = lp.so(3) @ lp.semidirect(2)
TOP = lp.System(E3, "(l1^2 + l2^2 + J*l3^2)/2 + a1*alpha1 + a3*alpha3", symbols=["J", "a1", "a3"])
AXES = {"J": [1, "4/3", 2, 4], "a1": [0, 1], "a3": ["0", 0.5]}


def test_named_tops_are_found_on_a_grid():
    """J = 1 spherical, a1 = 0 Lagrange and Euler, J = 2 and a3 = 0 Kovalevskaya (Kovalevskaya 1889)."""
    scan = scan_integrals(TOP, axes=AXES, degree=4)
    assert scan.complete
    assert (scan.outcome == "finished").all()
    for point in scan.special:
        j, a1, a3 = (point[name] for name in ("J", "a1", "a3"))
        assert j == "1" or a1 == "0" or (j, a3) == ("2", "0")
    # all J with a1 = 0, J = 1, and Kovalevskaya's
    assert len(scan.special) == 8 + 2 + 1
    # of the free spherical top all of l is constant, of which l1^2 + l2^2 + l3^2 = 2 H is known
    first = scan.grid.sel(J=1, a1=0, a3=0)
    assert int(first) == 2
    assert str(scan.grid.J_exact[1].item()) == "4/3"
    assert scan.grid.dims == ("J", "a1", "a3")


@pytest.mark.parametrize("on", [(), "C1 = 0"])
def test_each_point_has_what_a_search_finds_there(on):
    scan = scan_integrals(TOP, axes={"J": [1, 3, 4], "a1": 1, "a3": [0, "1/3"]}, degree=3, on=on)
    for k, (j, a1, a3) in enumerate(scan.value):
        member = lp.System(E3, str(TOP.hamiltonian).replace("**", "^"), {"J": j, "a1": a1, "a3": a3})
        found = lp.integrability.first_integrals(member, degree=3, on=on)
        assert found.complete
        assert len(found.independent) == scan.n_further[k]
        assert len(found.found) == len(scan.found.get(k, ()))
        for text in scan.found.get(k, ()):
            assert on or member.derivative(text) == 0
    assert scan.grid.dims == ("J", "a3")
    cubic = {"J": "4", "a1": "1", "a3": "0"}
    assert (cubic in scan.special) == bool(on)


def test_a_scan_agrees_with_the_conditions_on_the_parameters():
    families = lp.integrability.integrable_families(TOP, degree=2)
    scan = scan_integrals(TOP, axes=AXES, degree=2)
    for values, n in zip(scan.value, scan.n_further, strict=True):
        point = dict(zip(scan.parameter, map(str, values), strict=True))
        assert (n > 0) == any(case.holds_at(point) for case in families.cases)


def test_it_is_the_same_on_all_cores():
    axes = AXES | {"J": [1, 2, *range(5, 13)]}
    heard = []
    alone = scan_integrals(TOP, axes=axes, degree=2, threads=1)
    together = scan_integrals(TOP, axes=axes, degree=2, threads=2, progress=heard.append)
    assert together.dataset.identical(alone.dataset)
    assert heard == sorted(heard)
    assert heard[-1] == 1


def counted(monkeypatch):
    """The points that are searched from now on."""
    points, search = [], PointSearch.at

    def at(self, values):
        points.append(tuple(values))
        return search(self, values)

    monkeypatch.setattr(PointSearch, "at", at)
    return points


def test_a_scan_that_was_interrupted_goes_on(tmp_path, monkeypatch):
    whole = scan_integrals(TOP, axes=AXES, degree=2, threads=1)

    def interrupt(done):
        if done > 0.4:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        scan_integrals(TOP, axes=AXES, degree=2, threads=1, store=tmp_path / "scan", progress=interrupt)
    points = counted(monkeypatch)
    again = scan_integrals(TOP, axes=AXES, degree=2, threads=1, store=tmp_path / "scan")
    assert again.dataset.identical(whole.dataset)
    assert 0 < len(points) < 10
    scan_integrals(TOP, axes=AXES, degree=2, threads=1, store=tmp_path / "scan")
    assert len(points) < 10
    scan_integrals(TOP, axes=AXES, degree=2, threads=1, store=tmp_path / "scan", fresh=True)
    assert len(points) >= 16


def test_damaged_lines_are_computed_again(tmp_path, monkeypatch):
    store = tmp_path / "scan"
    whole = scan_integrals(TOP, axes=AXES, degree=2, threads=1, store=store)
    path = store / "points.jsonl"
    lines = path.read_bytes().splitlines(keepends=True)
    lines[2] = lines[2].replace(b"1", b"2")
    path.write_bytes(b"".join(lines)[:-3])
    points = counted(monkeypatch)
    for expected in (2, 0):
        points.clear()
        again = scan_integrals(TOP, axes=AXES, degree=2, threads=1, store=store)
        assert again.dataset.identical(whole.dataset)
        assert (len(points) > 0) == (expected > 0)
    path.write_bytes(b"nonsense\n")
    with pytest.raises(DamagedFileError, match="fresh"):
        scan_integrals(TOP, axes=AXES, degree=2, store=store)


@pytest.mark.parametrize(
    "record",
    [
        '["finished",1,[[["1/0",[0,0,1,0,0,0]]]]]',
        '["finished",Infinity,[]]',
        '["finished",' + "[" * 100_000 + "]" * 100_000 + ",[]]",
        '["another",1,[]]',
        '["finished",1]',
        "7",
    ],
    ids=lambda text: text[:30],
)
def test_lines_with_a_right_checksum_that_say_nothing_are_computed_again(tmp_path, record):
    from zlib import crc32

    store = tmp_path / "scan"
    whole = scan_integrals(TOP, axes=AXES, degree=1, threads=1, store=store)
    path = store / "points.jsonl"
    head, *lines = path.read_text().splitlines(keepends=True)
    scan = lines[0].split()[1]
    text = f'{scan} {{"0":{record}}}'
    path.write_text(head + f"{crc32(text.encode()):08x} {text}\n")
    assert scan_integrals(TOP, axes=AXES, degree=1, threads=1, store=store).dataset.identical(whole.dataset)


@pytest.mark.parametrize("text", ["1e999999999", "1E999999999", "1/1e9", "0.5", " 1", "1_0"])
def test_numbers_of_a_line_are_whole_numbers_and_fractions_of_them(text):
    """The exact value of the first would fill the memory."""
    from liepoisson.integrability import scan_store

    assert scan_store._result(["finished", 1, [[["-1/2", [1, 0]]]]]).found == ({(1, 0): Fraction(-1, 2)},)
    with pytest.raises(ValueError, match="numbers are texts such as '-1/2'"):
        scan_store._result(["finished", 1, [[[text, [1, 0]]]]])


def test_a_line_of_another_scan_is_left_out(tmp_path):
    """Its checksum is right: it was copied."""
    other = {"J": [3], "a1": [0, 1], "a3": [1]}
    scan_integrals(TOP, axes=other, degree=1, threads=1, store=tmp_path / "other")
    whole = scan_integrals(TOP, axes=AXES, degree=1, threads=1, store=tmp_path / "scan")
    path = tmp_path / "scan" / "points.jsonl"
    head, foreign = path.read_text().splitlines(keepends=True)[0], (tmp_path / "other" / "points.jsonl").read_text()
    path.write_text(head + "".join(foreign.splitlines(keepends=True)[1:]))
    from liepoisson.integrability.scan_store import ScanStore

    kept = ScanStore(tmp_path / "scan", json.loads(head[9:]))
    assert not kept.known
    assert scan_integrals(TOP, axes=AXES, degree=1, threads=1, store=tmp_path / "scan").dataset.identical(whole.dataset)


def test_a_store_keeps_to_its_scan(tmp_path):
    store = tmp_path / "scan"
    scan_integrals(TOP, axes=AXES, degree=1, threads=1, store=store)
    for other in ({"degree": 2}, {"axes": AXES | {"J": [7]}}, {"on": "C1 = 0"}):
        with pytest.raises(OutputError, match="another scan"):
            scan_integrals(TOP, **{"axes": AXES, "degree": 1} | other, threads=1, store=store)
    changed = lp.System(E3, TOP.hamiltonian + TOP.variables[0], symbols=["J", "a1", "a3"])
    with pytest.raises(OutputError, match="another scan"):
        scan_integrals(changed, axes=AXES, degree=1, threads=1, store=store)
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "thesis.tex").write_text("")
    with pytest.raises(OutputError, match="holds no scan"):
        scan_integrals(TOP, axes=AXES, degree=1, store=tmp_path / "other", fresh=True)


@pytest.mark.parametrize("threads", [1, 2])
def test_a_limit_of_time_leaves_points(tmp_path, threads):
    scan = scan_integrals(TOP, axes=AXES, degree=2, threads=threads, time_limit=1e-9, store=tmp_path / "scan")
    assert not scan.complete
    assert set(scan.outcome) == {"time limit"}
    assert (scan.n_further == -1).all()
    assert "incomplete: 16 points are left" in repr(scan)
    assert scan_integrals(TOP, axes=AXES, degree=2, threads=threads, store=tmp_path / "scan").complete


def test_a_denominator_that_vanishes_is_an_outcome():
    body = lp.System(lp.so(3) @ lp.trivial(), "(l1^2 + 2*l2^2)/(2*I) + l3^2", symbols=["I"])
    scan = scan_integrals(body, axes={"I": [0, 1, "1/2"]}, degree=1)
    assert scan.outcome.tolist() == ["no system", "finished", "finished"]
    # symmetric about an axis: a component of l, which is the root of a sum of H and the Casimir
    assert scan.n_further.tolist() == [-1, 0, 0]
    assert scan.found == {1: ("l1",), 2: ("l2",)}
    assert scan.complete


def test_a_scan_is_saved_loaded_and_repeated(tmp_path):
    scan = scan_integrals(TOP, axes=AXES, degree=2, on="C1 = 0", time_limit=77.0)
    path = scan.save(tmp_path / "scan.nc")
    loaded = lp.load(path)
    assert type(loaded) is lp.results.IntegralScan
    assert loaded.dataset.identical(scan.dataset)
    assert (loaded.axes, loaded.found, loaded.on) == (scan.axes, scan.found, scan.on)
    assert lp.rerun(path).dataset.identical(scan.dataset)
    assert "parameter" in loaded._repr_html_()


def test_errors_in_a_process_are_raised_here():
    search, _ = integral_scan._search(TOP, 2, ())
    broken = replace(search, n="six")
    pieces = [{0: [1, 1, 1]}, {1: [2, 1, 1]}]
    with pytest.raises(TypeError):
        list(scan_points.results(broken, pieces, 2, Deadline(np.inf)))


def test_a_process_that_ends_is_an_outcome(monkeypatch):
    search, _ = integral_scan._search(TOP, 1, ())
    monkeypatch.setattr(scan_points.sys, "executable", "/bin/false")
    found = [f for f in scan_points.results(search, [{0: [1, 1, 1]}, {1: [2, 1, 1]}], 2, Deadline(np.inf)) if f]
    assert sorted((k, r.outcome) for f in found for k, r in f.items()) == [(0, "failed"), (1, "failed")]


def test_what_a_process_does():
    search, names = integral_scan._search(TOP, 1, ())
    assert names == ["a1", "a3", "J"]
    source, sink = io.BytesIO(), io.BytesIO()
    for sent in (search, {3: [0, 0, 1]}):
        pickle.dump(sent, source)
    source.seek(0)
    scan_points.serve(source, sink)
    sink.seek(0)
    assert pickle.load(sink)[3].n_further == 2


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"axes": {"J": [1]}}, "wanted values of"),
        ({"axes": AXES | {"b": 1}}, "wanted values of"),
        ({"axes": AXES | {"J": []}}, "rational numbers"),
        ({"axes": AXES | {"J": ["sqrt(2)"]}}, "rational numbers"),
        ({"axes": AXES | {"J": [1, "2/2"]}}, "different values"),
        ({"axes": AXES | {"J": range(1, 10**6)}}, "scan parts of the grid"),
        ({"axes": AXES, "degree": 60}, "take a smaller one"),
        ({"axes": AXES, "store": 7}, "path of a folder"),
        ({"axes": AXES, "store": ""}, "path of a folder"),
        ({"axes": AXES, "on": "l1 = 0"}, "not invariant"),
    ],
)
def test_what_makes_no_sense_is_refused(options, words):
    with pytest.raises(ParameterError, match=words):
        scan_integrals(TOP, **options)


def test_a_system_without_symbols_is_refused():
    with pytest.raises(ParameterError, match="scan_integrals: wanted a system with symbols"):
        scan_integrals(lp.catalog.system("kovalevskaya"), axes={})
