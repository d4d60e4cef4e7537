"""The widget's script in a real Chromium, without a notebook: it shows the page, and what is done there is returned."""

import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest

import liepoisson as lp
from liepoisson.compile.field import QuadraticField

WEB = Path(__file__).resolve().parents[2] / "web"
CHROMIUM = os.environ.get("CHROMIUM", "/usr/bin/chromium")
START = [0.4, 0.2, -0.4, 0.8, 0.6, 0, 0, 0, 1]
HOSTILE = '</script><img src=x onerror="alert(1)">'
OTHER = lp.catalog.system("henon-heiles")


class Hostile:
    """An oscillator whose name would be markup."""

    name = HOSTILE

    def field(self):
        return QuadraticField(2, (), ((0, 1, 1.0), (1, 0, -1.0)), ())


SHOWN = {
    "top": (lambda: lp.view(lp.Top.twisted_kovalevskaya(), start=START, playing=False), "A top of your own"),
    "system": (lambda: lp.view(Hostile(), start=[1, 0], playing=False), HOSTILE),
}


def missing():
    """What of the things that are needed is not here."""
    if shutil.which("node") is None:
        return "node"
    if not Path(CHROMIUM).exists():
        return "Chromium (the variable CHROMIUM says where it is)"
    if not (WEB / "node_modules" / "playwright-core").is_dir():
        return "playwright-core (npm ci in web/)"
    return None


def driven(widget, folder):
    """What the browser saw and what the model was told."""
    first = {name: value for name, value in widget.get_state().items() if plain(value)}
    widget = lp.view(widget.system, start=widget.start)
    widget.system = OTHER
    after = {name: widget.get_state()[name] for name in ("_carried", "address", "message")}
    return run("widget.mjs", {**first, "after": after}, folder)


def run(driver, told, folder):
    """What a driver found, which is told this."""
    traits = folder / "traits.json"
    traits.write_text(json.dumps(told))
    command = ["node", str(WEB / "test" / driver), str(traits), str(folder)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=200, check=False)
    assert done.returncode == 0, f"{done.stdout}{done.stderr}\npictures: {folder}"
    return json.loads(done.stdout)


def plain(value):
    return isinstance(value, str | int | float | bool | None)


@pytest.mark.thorough
@pytest.mark.parametrize("shown", SHOWN)
def test_the_script_shows_the_page_and_returns_what_is_done_there(shown, tmp_path):
    pytest.importorskip("anywidget")
    if lacks := missing():
        pytest.skip(f"needs {lacks}")
    make, title = SHOWN[shown]
    widget = make()
    found = driven(widget, tmp_path)
    assert (found["title"], found["images"], found["isApart"]) == (title, 0, "SecurityError")
    assert (tmp_path / "widget.png").stat().st_size > 10_000

    widget.set_state(found["chosen"])
    assert widget.start == tuple(found["crossing"])
    assert (widget.time, widget.message) == (0, "")
    assert found["set"] == {"time": 2.5, "theme": "dark"}
    assert found["echo"] == 0

    # the page keeps its state, and says why
    refused = found["refused"]
    assert refused["said"]["message"] == refused["box"]["text"]
    assert 'has an unknown part "<img src' in refused["box"]["text"]
    assert (refused["box"]["elements"], refused["box"]["hidden"]) == (0, False)
    widget.set_state(refused["said"])
    assert widget.message == refused["box"]["text"]
    assert (widget.start, widget.time, widget.state["theme"]) == (tuple(found["crossing"]), 2.5, "dark")

    assert found["told"] == {"text": '<img src=x onerror="alert(1)"><b>no</b>', "elements": 0, "hidden": False}
    assert found["closed"]["box"]["hidden"]
    assert found["closed"]["said"]["message"] == ""
    assert (found["stray"], found["height"], found["left"]) == (0, 333, [0, 0])

    # another system, which begins where the page says, and moves as Python says
    other = found["other"]
    assert (other["title"], other["refused"]) == ("henon-heiles", 0)
    orbit = lp.integrate(OTHER, other["start"], times=[0, 1], method=lp.Taylor(tol=1e-15))
    assert other["end"] == pytest.approx(list(orbit.state[0, -1]), abs=1e-12)
    assert (found["asked"], found["wrong"]) == ([], [])


RIGHT = "(p_x^2 + p_y^2 + x^2 + y^2)/2 + k*(x^2*y - y^3/3)"
WRONG = "(p_x^2 + p_y^2 + x^2 + y^2)/2 + sen(x)"


@pytest.fixture(scope="module")
def typed(tmp_path_factory):
    """What a driver has typed into the widget and set in it, the widget, and the one in which Python set the same."""
    pytest.importorskip("anywidget")
    if lacks := missing():
        pytest.skip(f"needs {lacks}")
    widget, folder = lp.view(playing=False), tmp_path_factory.mktemp("typed")
    traits = {name: value for name, value in widget.get_state().items() if plain(value)}
    python = lp.view(
        lp.System(lp.canonical(names=["x", "y"]), RIGHT, {"k": 1}), start=[0.1, 0.2, 0.3, 0], playing=False
    )
    python.state = {"parameters": {"k": "1/4"}, "theme": "dark", "time": 2}
    addresses = {"parameters": python.address}
    python.system = lp.catalog.system("heavy-top")
    addresses["other"] = python.address
    wanted = {"right": RIGHT, "wrong": WRONG, "addresses": addresses, "top": lp.view(lp.Top.kovalevskaya()).address}
    found = run("widget_typed.mjs", {"traits": traits, "wanted": wanted}, folder)
    assert (folder / "typed.png").stat().st_size > 10_000
    assert (found["asked"], found["wrong"]) == ([], [])
    return found, widget, python


def told(typed, name):
    """What was seen then; what the page has told is what Python has, and both have the same motion."""
    found, widget, _ = typed
    widget.set_state(found[name]["said"])
    assert widget.message == found[name]["said"]["message"], name
    orbit = lp.integrate(widget.system, widget.start, times=[0, 1], method=lp.Taylor(tol=1e-15))
    assert found[name]["at"] == pytest.approx(list(orbit.state[0, -1]), abs=1e-12)
    assert (found[name]["markup"], found[name]["isUsable"]) == (0, True)
    return found[name]


@pytest.mark.thorough
def test_what_is_typed_in_the_widget_is_in_python(typed):
    widget = typed[1]
    opened = told(typed, "opened")
    assert (opened["title"], opened["message"], widget.message, widget.state["surface"]) == (
        "Hénon–Heiles",
        "",
        "",
        "x",
    )
    told(typed, "right")
    assert widget.system.parameters == {"k": 1}
    right = (widget.system, widget.address, widget.state)
    wrongly = told(typed, "wrongly")
    assert "sen" in widget.message
    assert widget.message in wrongly["wrong"][0]
    assert wrongly["hamiltonian"] == WRONG
    assert (widget.system, widget.address, widget.state) == right
    told(typed, "mended")
    assert (widget.message, widget.system, widget.address) == ("", *right[:2])
    slid = told(typed, "slid")
    assert slid["sliders"] == [["k", widget.state["parameters"]["k"]]]
    assert widget.system.parameters["k"] > 1


@pytest.mark.thorough
def test_what_python_sets_is_typed_and_told_back_at_most_once(typed):
    found, widget, python = typed
    changed = told(typed, "parameters")
    assert changed["sliders"] == [["k", "1/4"]]
    assert (changed["theme"], changed["time"], changed["start"], changed["playing"]) == (
        "dark",
        2,
        [0.1, 0.2, 0.3, 0],
        False,
    )
    assert widget.system.parameters["k"] == 0.25
    other = told(typed, "other")
    assert (other["title"], other["theme"]) == ("heavy-top", "dark")
    assert widget.state["parameters"] == python.state["parameters"]
    # the page may write an address in its own way, once
    assert max(changed["echoes"], other["echoes"]) <= 1
    # the page of tops was shown in between
    assert found["again"]["sliders"] == [["k", "1/4"]]
