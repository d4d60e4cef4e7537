"""Scans of a grid of parameters: at each point as a search there, on any number of cores, interrupted or not."""

from dataclasses import replace

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


def test_each_point_has_what_a_search_finds_there():
    on = "C1 = 0"
    scan = scan_integrals(TOP, axes={"J": [1, 3, 4], "a1": 1, "a3": [0, "1/3"]}, degree=3, on=on)
    for k, (j, a1, a3) in enumerate(scan.value):
        member = lp.System(E3, str(TOP.hamiltonian).replace("**", "^"), {"J": j, "a1": a1, "a3": a3})
        found = lp.integrability.first_integrals(member, degree=3, on=on)
        assert found.complete
        assert len(found.independent) == scan.n_further[k]
        assert len(found.found) == len(scan.found.get(k, ()))
    assert scan.grid.dims == ("J", "a3")
    cubic = {"J": "4", "a1": "1", "a3": "0"}
    assert cubic in scan.special


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
        '["finished",1,[[["1e999999999",[0,0,1,0,0,0]]]]]',
        '["another",1,[]]',
        '["finished",1]',
    ],
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


def test_a_limit_of_time_leaves_points(tmp_path):
    scan = scan_integrals(TOP, axes=AXES, degree=2, threads=2, time_limit=1e-9, store=tmp_path / "scan")
    assert not scan.complete
    assert set(scan.outcome) == {"time limit"}
    assert (scan.n_further == -1).all()
    assert scan_integrals(TOP, axes=AXES, degree=2, threads=2, store=tmp_path / "scan").complete


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


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"axes": {"J": [1]}}, "wanted values of"),
        ({"axes": AXES | {"J": []}}, "rational numbers"),
        ({"axes": AXES | {"J": ["sqrt(2)"]}}, "rational numbers"),
        ({"axes": AXES | {"J": [1, "2/2"]}}, "different values"),
        ({"axes": AXES | {"J": range(1, 10**6)}}, "scan parts of the grid"),
        ({"axes": AXES, "degree": 60}, "take a smaller one"),
        ({"axes": AXES, "store": 7}, "path of a folder"),
        ({"axes": AXES, "on": "l1 = 0"}, "not invariant"),
    ],
)
def test_what_makes_no_sense_is_refused(options, words):
    with pytest.raises(ParameterError, match=words):
        scan_integrals(TOP, **options)


@pytest.mark.parametrize("option", [{"store": ""}, {"threads": "x"}, {"time_limit": 0}, {"degree": 0}], ids=str)
def test_options_are_read_before_the_search_is_prepared(monkeypatch, option):
    monkeypatch.setattr(integral_scan, "_search", lambda *_: pytest.fail("it was prepared"))
    with pytest.raises(ParameterError, match=next(iter(option))):
        scan_integrals(TOP, axes=AXES, **option)


def test_a_denominator_that_vanishes_is_an_outcome():
    body = lp.System(lp.so(3) @ lp.trivial(), "(l1^2 + 2*l2^2)/(2*I) + l3^2", symbols=["I"])
    scan = scan_integrals(body, axes={"I": [0, 1, "1/2"]}, degree=1)
    assert scan.outcome.tolist() == ["no system", "finished", "finished"]
    # symmetric about an axis: a component of l, which is the root of a sum of H and the Casimir
    assert scan.n_further.tolist() == [-1, 0, 0]
    assert scan.found == {1: ("l1",), 2: ("l2",)}
    assert scan.complete
