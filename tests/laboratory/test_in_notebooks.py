"""A real JupyterLab and a real marimo show the widget in a real browser, and what is done there arrives in Python."""

import json
import os
import re
import shutil
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from importlib.util import find_spec
from pathlib import Path

import pytest

import liepoisson as lp

WEB = Path(__file__).resolve().parents[2] / "web"
CHROMIUM = os.environ.get("CHROMIUM", "/usr/bin/chromium")
SECONDS = 90

MAKE = (
    "lp.view(lp.Top.twisted_kovalevskaya(), start=[0.4, 0.2, -0.4, 0.8, 0.6, 0, 0, 0, 1], "
    "state={'theme': 'light'}, playing=False)"
)
SET = "widget.state = {'theme': 'dark', 'view': 'body', 'time': 2.5, 'parameters': {'epsilon': '1/3'}}"

MARIMO = f"""
import marimo

app = marimo.App(width="full")


@app.cell
def _():
    import marimo as mo

    import liepoisson as lp

    widget = mo.ui.anywidget({MAKE})
    widget
    return mo, widget


@app.cell
def _(mo, widget):
    mo.plain_text(f"START {{widget.start}} {{widget.time}} END")


@app.cell
def _(mo, widget):
    def change(_):
        {SET}

    mo.ui.button(label="set", on_click=change)


if __name__ == "__main__":
    app.run()
"""

CELLS = [
    f"import liepoisson as lp\nwidget = {MAKE}\nwidget",
    "print('START', widget.start, widget.time, 'END')",
    SET,
    "typed = lp.view(playing=False)\ntyped",
    "print('TYPED', typed.system.hamiltonian, typed.system.parameters, typed.message, 'END')",
    "typed.state = {'parameters': {'k': '1/3'}}",
]


def notebook():
    cells = [
        {"cell_type": "code", "id": f"cell-{k}", "source": text, "metadata": {}, "outputs": [], "execution_count": None}
        for k, text in enumerate(CELLS)
    ]
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    return {"cells": cells, "metadata": {"kernelspec": kernel}, "nbformat": 4, "nbformat_minor": 5}


def missing(package):
    """What of the things that are needed is not here."""
    if shutil.which("node") is None:
        return "node"
    if not Path(CHROMIUM).exists():
        return "Chromium (the variable CHROMIUM says where it is)"
    if not (WEB / "node_modules" / "playwright-core").is_dir():
        return "playwright-core (npm ci in web/)"
    return None if find_spec(package) else f"{package} (requirements/notebooks.txt)"


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def wait_for(url, server, log):
    end = time.monotonic() + SECONDS
    while time.monotonic() < end and server.poll() is None:
        try:
            urllib.request.urlopen(url, timeout=5).close()
        except (urllib.error.URLError, OSError):
            time.sleep(0.5)
        else:
            return
    pytest.fail(f"the server does not answer:\n{log.read_text()[-2000:]}")


def jupyter(folder, port):
    (folder / "a.ipynb").write_text(json.dumps(notebook()))
    command = [
        "jupyterlab", "--no-browser", "--allow-root", f"--ServerApp.port={port}", "--ServerApp.port_retries=0",
        "--IdentityProvider.token=secret", f"--ServerApp.root_dir={folder}", "--LabApp.expose_app_in_browser=True",
        "--LabApp.extension_manager=readonly", "--LabApp.news_url=None",
    ]  # fmt: skip
    return command, f"http://127.0.0.1:{port}/lab/tree/a.ipynb?token=secret"


def marimo(folder, port):
    (folder / "a.py").write_text(MARIMO)
    command = ["marimo", "run", str(folder / "a.py"), "--headless", "--no-token", f"--port={port}"]
    return command, f"http://127.0.0.1:{port}/"


def driven(kind, folder):
    """What the browser saw and what the cells said."""
    port, log = free_port(), folder / "server.log"
    command, url = {"jupyter": jupyter, "marimo": marimo}[kind](folder, port)
    package = str(Path(lp.__file__).resolve().parents[1])
    home = {name: str(folder) for name in ("HOME", "JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "XDG_CONFIG_HOME")}
    with log.open("w") as out:
        server = subprocess.Popen(
            [sys.executable, "-m", *command],
            cwd=folder, env={**os.environ, **home, "PYTHONPATH": package}, stdout=out, stderr=out,
        )  # fmt: skip
        try:
            wait_for(url, server, log)
            driver = ["node", str(WEB / "test" / "notebook.mjs"), kind, url, str(folder)]
            done = subprocess.run(driver, capture_output=True, text=True, timeout=270, check=False)
        finally:
            server.terminate()
            server.wait(30)
    assert done.returncode == 0, f"{done.stdout}{done.stderr}{log.read_text()[-2000:]}\npictures: {folder}"
    return json.loads(done.stdout)


def told(line):
    """Start and time in the output of the cell."""
    *start, when = map(float, re.findall(r"-?\d+\.\d*(?:e-?\d+)?", line))
    return start, when


@pytest.mark.slow
@pytest.mark.timeout(400)
@pytest.mark.parametrize(("kind", "package"), [("jupyter", "jupyterlab"), ("marimo", "marimo")])
def test_what_is_done_in_the_page_is_in_python_and_what_is_set_is_shown(kind, package, tmp_path):
    pytest.importorskip("anywidget")
    if lacks := missing(package):
        pytest.skip(f"needs {lacks}")
    found = driven(kind, tmp_path)
    assert told(found["first"]) == ([0.4, 0.2, -0.4, 0.8, 0.6, 0, 0, 0, 1], 0)
    assert told(found["afterKey"]) == (found["crossing"], 0)
    assert told(found["afterClick"]) == (found["clicked"], 0)
    assert found["clicked"] != found["crossing"]
    assert found["set"] == {"theme": "dark", "view": "body", "time": 2.5, "start": found["clicked"], "epsilon": "1/3"}
    # the page in its frame sees nothing of the notebook, and asks for nothing
    assert found["isApart"] == "SecurityError"
    assert [one for one in found["asked"] if one["inside"]] == []
    assert found["wrong"] == []
    assert (tmp_path / f"{kind}.png").stat().st_size > 20_000
    if kind == "jupyter":
        assert sorted(re.findall(r"[^ ]*\*y[^ ]*", found["typed"])) == ["x**2*y"]
        assert "'k': Fraction(1, 1)" in found["typed"]
        assert "sen" in found["wronglyTyped"]
        assert found["typed"].split("}")[0] == found["wronglyTyped"].split("}")[0]
        assert "'k': Fraction(1, 3)" in found["slider"]
        assert found["slider"].endswith("}  END")
