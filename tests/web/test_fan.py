"""Many orbits in a section of the page, in Chromium: Python's verdicts, one picture for a link, clicks, hints."""

import json
import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import liepoisson as lp

WEB = Path(__file__).resolve().parents[2] / "web"
PAGE = WEB.parent / "python" / "liepoisson" / "laboratory" / "page" / "index.html"
CHROMIUM = os.environ.get("CHROMIUM", "/usr/bin/chromium")
ENERGIES = (1 / 12, 1 / 8, 1 / 6)
HAMILTONIAN = "(p_x^2 + p_y^2 + x^2 + y^2)/2 + x^2*y - y^3/3"
"""As the page has it first: Hénon-Heiles."""

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        shutil.which("node") is None or not Path(CHROMIUM).exists() or not (WEB / "node_modules").is_dir(),
        reason="needs node, npm ci in web/ and Chromium",
    ),
]


def start_at(energy: float) -> list[str]:
    """x = p_y = 0, y = -1/10, and p_x from the energy."""
    y = -0.1
    return ["0", str(y), repr(float(np.sqrt(2 * energy - y**2 + 2 * y**3 / 3))), "0"]


@pytest.fixture(scope="module")
def shown(tmp_path_factory):
    wanted = tmp_path_factory.mktemp("fan") / "wanted.json"
    wanted.write_text(json.dumps({"starts": [start_at(energy) for energy in ENERGIES]}), encoding="utf-8")
    command = ["node", "test/fan.mjs", str(PAGE), str(wanted)]
    done = subprocess.run(command, cwd=WEB, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_nothing_is_wrong(shown):
    assert shown["wrong"] == []


@pytest.mark.parametrize("k", range(len(ENERGIES)))
def test_verdicts_are_those_of_python(shown, k):
    system = lp.System(lp.canonical(names=("x", "y")), HAMILTONIAN)
    fan = shown["fans"][k]
    starts = np.array([orbit["start"] for orbit in fan["orbits"]])
    assert len(starts) == 20
    np.testing.assert_allclose(system.functions.energy(starts), ENERGIES[k], rtol=0, atol=1e-10)
    found = lp.decide(system, starts, t_end=fan["about"]["end"])
    print(f"H = {ENERGIES[k]:.4f}: {found}; {fan['took']:.0f} ms in Chromium")
    assert [orbit["verdict"] for orbit in fan["orbits"]] == found.verdict.tolist()


def test_the_same_link_shows_the_same_picture(shown):
    assert shown["again"]["orbits"] == shown["fans"][-1]["orbits"]


def test_a_click_adds_an_orbit_through_the_point(shown):
    clicked = shown["clicked"]
    (point,) = clicked["added"]
    assert len(clicked["orbits"]) == 21
    np.testing.assert_allclose(np.array(clicked["orbits"][-1]["start"])[[1, 3]], point, rtol=0, atol=1e-12)
    assert "orbits=" in clicked["address"]


def test_the_pointer_tells_the_orbit(shown):
    hovered = shown["hovered"]
    assert hovered["chosen"] == hovered["index"]
    assert f"Orbit {hovered['index'] + 1}: regular, λ = " in hovered["status"]
    assert len(shown["listed"]) == 21
    assert hovered["before"] == hovered["after"], "the section keeps its size"


def test_a_slider_makes_a_new_fan(shown):
    before, after = map(np.array, shown["slid"].values())
    assert before.shape == after.shape
    assert not np.array_equal(before, after)
    assert "crossings" in shown["single"]


def test_a_telephone_has_room(shown):
    assert shown["phone"]["wide"] <= 0
    assert shown["phone"]["fits"]
    assert shown["phone"]["plot"] > 150
