"""Pages of systems in a browser: they show the numbers that Python has, and what a name says stays text."""

import json
import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.laboratory import page_of, write_page

WEB = Path(__file__).resolve().parents[2] / "web"
CHROMIUM = os.environ.get("CHROMIUM", "/usr/bin/chromium")
HOSTILE = '</script><img src=x onerror="window.ran=1"><!-- <script>\u2028&lt;b&gt;\'`${1}'

CYLINDER = lp.canonical(names=["x"], angles=["x"])
SYSTEMS = {
    **{name: lp.catalog.system(name) for name in ("manakov-so4", "zeitlin-3")},
    "pendulum": lp.System(CYLINDER, "p_x^2/2 - cos(x)", name="pendulum"),
    "shaken pendulum": lp.System(
        CYLINDER, "p_x^2/2 - cos(x) + f*cos(x)*cos(w*t)", {"f": "3/10", "w": 3}, period="2*pi/w", name="shaken"
    ),
    "two frequencies": lp.System(CYLINDER, "p_x^2/2 - cos(x) + cos(x)*(cos(t) + cos(sqrt(2)*t))/20", name="two"),
}
STARTS = {
    "manakov-so4": [1, 0.5, -0.3, 0.2, 0.7, -0.4],
    "zeitlin-3": [1, 0, 0.5, 0, 0.25, 0.1, 0, -0.2],
    "pendulum": [0, 3],
    "shaken pendulum": [0, 0.5, 0, 0],
    "two frequencies": [0, 0.9, 0, 0],
}
CLICKED = {"shaken pendulum": {"click": 40}}
"""The number of a crossing at which an orbit is started."""
SURFACES = {"pendulum": ["x"]}
UNTIL = {
    "manakov-so4": 200.0,
    "zeitlin-3": 100.0,
    "pendulum": 60.0,
    "shaken pendulum": 60.0,
    "two frequencies": 60.0,
}
"""Times up to which rounding stays small: the second is chaotic, its exponent is 0.1, and the others turn."""
BOUND = 1e-9
"""Of differences of times, states and exponents."""


def surface_of(name):
    """That with which the page begins."""
    if name in SURFACES:
        return SURFACES[name][0]
    leaf = lp.phase_space.find_start(SYSTEMS[name], start=STARTS[name]).leaf
    return lp.sections.default_surface(leaf)


class Named:
    """A field with names that somebody else has chosen."""

    name = HOSTILE
    source = HOSTILE
    component_names = (HOSTILE, "<b>p</b>")

    def field(self):
        return lp.fields.QuadraticField(2, (), ((0, 1, 1.0), (1, 0, -1.0)), ())


@pytest.fixture(scope="module")
def shown(tmp_path_factory):
    if shutil.which("node") is None:
        pytest.skip("node is not installed; the pages of systems are not opened")
    if not (WEB / "node_modules" / "playwright-core").is_dir():
        pytest.skip("web/node_modules is missing (npm ci in web); the pages of systems are not opened")
    if not Path(CHROMIUM).exists():
        pytest.skip("Chromium is not installed; the pages of systems are not opened")
    folder = tmp_path_factory.mktemp("pages")
    wanted = []

    def add(name, page, **more):
        file = write_page(page, folder / f"{name}.html")
        wanted.append({"name": name, "file": str(file), **more})
        return file

    for name, start in STARTS.items():
        add(
            name,
            page_of(SYSTEMS[name], start=start, surfaces=SURFACES.get(name, ())),
            until=UNTIL[name],
            **CLICKED.get(name, {}),
        )
    endless, start = SYSTEMS["two frequencies"], STARTS["two frequencies"]
    add("one moment", page_of(endless, start=start, surfaces="t"), remark=True)
    add("never crossed", page_of(SYSTEMS["pendulum"], start=[0, 3], surfaces="p_x"), remark=True)
    kirchhoff = lp.catalog.system("kirchhoff")
    orbit = lp.integrate(kirchhoff, [1, 0.2, 0, 0, 0.6, 0.8], times=np.linspace(0, 40, 81), threads=1)
    file = add("with an orbit", page_of(kirchhoff, result=orbit), width=390)
    add("another system's address", page_of(kirchhoff, start=[1, 0.2, 0, 0, 0.6, 0.8]), hash="#v=1&system=abc&t=1")
    add("hostile", page_of(Named(), start=[1, 0]), until=10)
    add("top", page_of(lp.catalog.system("twisted-kovalevskaya"), start=[1, 0, 0, 0, 1, 0, 0, 0, 1]))
    broken = folder / "broken.html"
    text = file.read_text(encoding="utf-8")
    broken.write_text(text.replace('"components":["m1",', '"components":['), encoding="utf-8")
    wanted.append({"name": "broken", "file": str(broken)})
    (folder / "wanted.json").write_text(json.dumps(wanted), encoding="utf-8")
    done = subprocess.run(
        ["node", "test/systems.mjs", folder / "wanted.json"],
        cwd=WEB, capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.parametrize("name", STARTS)
def test_a_page_has_the_invariants_of_python(shown, name):
    system = SYSTEMS[name]
    wanted = system.invariant_values(np.array(STARTS[name], float))
    assert shown[name]["names"] == [key if system.clock is None else "H + p_t" for key in wanted]
    np.testing.assert_allclose(
        shown[name]["first"], [float(value) for value in wanted.values()], rtol=1e-14, atol=1e-14
    )
    assert shown[name]["wrong"] == []


@pytest.mark.parametrize("name", STARTS)
def test_a_page_finds_the_crossings_of_python(shown, name):
    system, until = SYSTEMS[name], UNTIL[name]
    found = lp.section(system, STARTS[name], surface=surface_of(name), direction=1, t_end=until, threads=1)
    times = [time for time in shown[name]["crossings"]["times"] if time <= until]
    assert len(times) == len(found.time) > 3
    np.testing.assert_allclose(times, found.time, rtol=0, atol=BOUND)
    np.testing.assert_allclose(shown[name]["crossings"]["states"][: len(times)], found.state, rtol=0, atol=BOUND)


@pytest.mark.parametrize("name", STARTS)
def test_a_page_has_the_finite_time_exponents_of_python(shown, name):
    system, start = SYSTEMS[name], np.array(STARTS[name], float)
    times = np.array([time for time in shown[name]["exponent"]["times"] if time <= UNTIL[name]])
    assert len(times) > 10
    n = start.size if system.clock is None else start.size - 2  # of a neighbour at the same time
    tangent = np.concatenate([np.full(n, n**-0.5), np.zeros(start.size - n)])
    growth = lp.finite_time_exponents(system, start[None], times=times, tangents=tangent[None], threads=1)
    np.testing.assert_allclose(shown[name]["exponent"]["values"][: len(times)], growth.exponent[0], rtol=0, atol=BOUND)


def test_a_page_begins_at_the_start_it_was_given(shown):
    for name, start in STARTS.items():
        assert shown[name]["start"] == start


def test_views_are_those_of_the_system(shown):
    assert shown["zeitlin-3"]["views"] == ["picture", "projection", "series"]
    assert shown["manakov-so4"]["views"] == ["projection", "series"]


def test_a_driven_system_shows_its_stroboscopic_map_and_says_what_is_conserved(shown):
    page = shown["shaken pendulum"]
    assert page["charts"]["section"] == ["Stroboscopic map", "tt = 0 mod 2π/3 ↑ · " + page["count"], ""]
    assert "driven with the period 2π/3" in page["subtitle"]
    assert "H depends on time and is not conserved" in page["controls"]
    assert page["drift"] < 1e-9  # measured 2e-12
    assert shown["pendulum"]["charts"]["section"][1].startswith("tx = 0 mod 2π ↑")
    assert "not conserved" not in shown["pendulum"]["controls"]


def test_what_a_page_cannot_show_is_said_in_place(shown):
    assert "Time has no period here" in shown["one moment"]["charts"]["section"][2]
    assert shown["two frequencies"]["charts"]["section"][0] == "Poincaré section"
    assert shown["never crossed"]["charts"]["section"][2].startswith("Up to t = 20000 the orbit does not cross")
    assert shown["hostile"]["charts"]["drift"][2] == "No invariant of this system is known."
    assert all(shown[name]["wrong"] == [] for name in ("one moment", "never crossed"))


def test_a_click_on_a_crossing_starts_within_the_turns(shown):
    """The crossing is the same point of the circles: from it the motion goes on as it did."""
    clicked, page = shown["shaken pendulum"]["clicked"], shown["shaken pendulum"]
    x, p, t, momentum = clicked["start"]
    state = page["crossings"]["states"][clicked["index"]]
    assert (-np.pi <= x <= np.pi, t) == (True, 0)
    assert np.cos([x - state[0], 3 * (t - state[2])]) == pytest.approx([1, 1], abs=1e-12)
    assert (p, momentum) == (state[1], state[3])


def test_views_of_vectors_are_those_of_the_system(shown):
    assert shown["with an orbit"]["views"] == ["vectors", "projection", "series"]


def test_a_saved_orbit_is_computed_again_and_compared(shown):
    page = shown["with an orbit"]
    assert "Saved: an orbit, 81 times from t = 0 to t = 40" in page["saved"]
    assert (
        "the largest difference of 486 numbers is" in page["saved"] or "all 486 numbers are the same" in page["saved"]
    )
    assert page["wide"] == 0
    assert page["wrong"] == []


def test_names_stay_text(shown):
    page = shown["hostile"]
    assert page["heading"] == HOSTILE
    assert page["title"].startswith(HOSTILE[:40])
    assert any("<b>p</b>" in label for label in page["labels"])
    assert (page["markup"], page["ran"], page["wrong"]) == (0, None, [])
    assert page["scripts"] == ["application/json", "module"]


def test_an_address_of_another_system_is_refused_with_a_sentence(shown):
    assert "for another system" in shown["another system's address"]["message"]


def test_a_description_that_is_malformed_gives_a_sentence(shown):
    assert "cannot be shown: its field has 6 components, and there are 5 names" in shown["broken"]["message"]
    assert shown["broken"]["wrong"] == []


def test_a_top_is_shown_by_the_page_of_tops(shown):
    page = shown["top"]
    assert "ε, exact value" in page["labels"]
    assert page["start"] == [1, 0, 0, 0, 1, 0, 0, 0, 1]
    assert page["wrong"] == []
