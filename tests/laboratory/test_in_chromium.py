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
    traits = folder / "traits.json"
    first = {name: value for name, value in widget.get_state().items() if plain(value)}
    widget = lp.view(widget.system, start=widget.start)
    widget.system = OTHER
    after = {name: widget.get_state()[name] for name in ("_carried", "address", "message")}
    traits.write_text(json.dumps({**first, "after": after}))
    command = ["node", str(WEB / "test" / "widget.mjs"), str(traits), str(folder)]
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
