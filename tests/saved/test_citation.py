"""References: the package, and each work that describes what was used, once."""

import re
import tomllib
from pathlib import Path

import pytest

import liepoisson as lp
from liepoisson.errors import ParameterError, UnknownNameError
from script_folders import modules_of

ROOT = Path(__file__).parents[2]
(citation_file,) = modules_of(ROOT / "docs", "citation_file")
TOP = lp.Top.twisted_kovalevskaya()
PAPER = "twistedtop2001"


def keys(*used):
    return [work.key for work in lp.cite(*used).works]


def test_citation_file_is_what_the_package_says():
    assert citation_file.FILE.read_text(encoding="utf-8") == citation_file.text(), "run docs/citation_file.py"


def test_what_was_used_stands_for_its_system(tmp_path):
    orbit = lp.integrate(TOP, lp.sample_states(TOP, 1, seed=1), t_end=1)
    for used in (TOP, "twisted-top", lp.catalog.entry("twisted-top"), lp.catalog.system("twisted-top"), orbit):
        assert keys(used) == ["liepoisson", PAPER], used
    assert keys(lp.load(orbit.save(tmp_path / "orbit.nc"))) == ["liepoisson", PAPER]


def test_a_top_without_cocycle_is_not_the_twisted_one():
    assert keys(lp.Top(inertia=(1, 1, 2), a=(0, 0, 1))) == ["liepoisson"]
    assert keys(lp.Top(inertia=(1, 1, 2), a=(0, 0, 1), epsilon="epsilon")) == ["liepoisson", PAPER]


def test_each_work_comes_once_and_each_key_belongs_to_one():
    for used in ((TOP, "twisted-lagrange", "twisted-top"), tuple(lp.catalog.names())):
        citation = lp.cite(*used)
        entries = re.findall(r"^@\w+\{(.+),$", citation.bibtex, re.MULTILINE)
        assert entries == [work.key for work in citation.works]
        assert len(set(entries)) == len(entries)
        assert len({work.text for work in citation.works}) == len(entries)


@pytest.mark.parametrize("name", lp.catalog.names())
def test_every_system_of_the_catalog_has_a_key_with_a_name_and_a_year(name):
    for work in lp.cite(name).works[1:]:
        assert re.fullmatch(r"[a-z]+\d{4}[a-z]?", work.key), work
        assert work.bibtex.count("{") == work.bibtex.count("}")


def test_a_source_prints_in_tex_as_it_stands():
    system = lp.System(lp.so(3) @ lp.trivial(), "l1", source=r"A. Smith & B_C, 50% of $x$ {and} \y~z (1999); no author")
    note = r"A. Smith \& B\_C, 50\% of \$x\$ \{and\} \textbackslash{}y\textasciitilde{}z (1999); no author"
    assert f"note = {{{note}}}" in lp.cite(system).bibtex
    assert keys(system) == ["liepoisson", "smith1999"]


def test_what_has_no_system_is_refused():
    for wrong in (3, lp.Top, lp.so(3), None, lp.Taylor()):
        with pytest.raises(ParameterError, match="wanted a system, a system file, a name of the catalog or a result"):
            lp.cite(wrong)
    with pytest.raises(UnknownNameError, match="Did you mean toda"):
        lp.cite("todda")
    with pytest.raises(ParameterError, match="no argument 'format'"):
        lp.cite(format="bibtex")


FILE = lp.catalog.path("twisted-top")
VALUES = {"I": [2, 2, 1], "a": [-1, 0, 0], "b": [0, 0, 0]}


@pytest.mark.parametrize("system", ["twisted-top", FILE, tomllib.loads(FILE.read_text(encoding="utf-8"))])
def test_a_sweep_stands_for_its_system(system, tmp_path):
    found = lp.sweep(system=system, parameters=VALUES, axes={"epsilon": [0, 1]}, n_starts=1, t_end=1)
    assert keys(found) == ["liepoisson", PAPER]
    assert keys(lp.load(found.save(tmp_path / "sweep.nc"))) == ["liepoisson", PAPER]


def test_a_sweep_of_a_file_with_noise_stands_for_its_system(tmp_path):
    file, noise = tmp_path / "top.toml", '[noise]\nnoises = "alpha1"\n'
    file.write_text(FILE.read_text(encoding="utf-8") + noise, encoding="utf-8")
    method = lp.Splitting(step=0.1)
    found = lp.sweep(system=file, parameters=VALUES, axes={"epsilon": [1]}, n_starts=1, t_end=1, method=method)
    assert keys(found) == ["liepoisson", PAPER]


def test_a_sweep_over_a_function_names_no_system():
    found = lp.sweep(system=lp.Top.twisted_kovalevskaya, axes={"epsilon": [0, 1]}, n_starts=1, t_end=1)
    with pytest.raises(ParameterError, match="give one of its systems"):
        lp.cite(found)
