"""What a report leaves out of a large system, and that it says so."""

import time

from liepoisson.formula.styles import PLAIN
from liepoisson.model.system import System
from liepoisson.report import limits
from liepoisson.report.describe import inspect
from liepoisson.structure.extensions import leibniz, trivial
from liepoisson.structure.lie_algebras import abelian, so


def test_many_coordinates():
    began = time.process_time()
    report = inspect(System(abelian(301) @ trivial(), "l[1]^2"))
    assert time.process_time() - began < 10
    for key in ("bracket", "casimirs", "rank", "strata", "symmetries", "equations"):
        assert report.record()[key] == {"not_computed": "301 coordinates (limit 200)"}
    assert report.record()["algebra"] == {"not_computed": "301 dimensions (limit 300)"}
    assert "Casimirs         not computed: 301 coordinates (limit 200)" in report.text(PLAIN)
    assert not report.failed


def test_many_fields():
    bracket = abelian(1) @ leibniz(41)
    record = inspect(System(bracket, bracket.variables[0] ** 2)).record()
    assert record["extension"] == {"not_computed": "41 fields (limit 40)"}
    assert record["symmetries"] == {"not_computed": "41 fields (limit 20)"}
    assert record["casimirs"]["complete"]


def test_a_long_hamiltonian(monkeypatch):
    monkeypatch.setattr(limits, "MOST_TERMS", 5)
    bracket = so(3) @ trivial()
    l1, l2, _ = bracket.variables
    energy = sum((l1**i * l2 for i in range(6)), 0 * l1)
    record = inspect(System(bracket, energy)).record()
    assert record["equations"] == record["symmetries"] == {"not_computed": "6 terms in H (limit 5)"}
    assert record["rank"]["proved"]
