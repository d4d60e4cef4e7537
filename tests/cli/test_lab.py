"""The command `liepoisson lab`: pages in files and at addresses, refusals, and how Ctrl-C ends it."""

import os
import re
import signal
import subprocess
import sys
import urllib.error
import urllib.request

import pytest


def test_a_page_is_written_into_a_file(command, tmp_path):
    file = tmp_path / "new" / "kirchhoff.html"
    code, out, err = command("lab", "kirchhoff", "--start", "m=1,1/3,0", "--start", "p3=1", "--export", file)
    assert (code, out, err) == (0, f"wrote    {file}\n", "")
    text = file.read_text(encoding="utf-8")
    assert '"start":["1","0.3333333333333333","0","0","0","1"]' in text
    assert not list(file.parent.glob("*.partial"))


def test_a_saved_orbit_goes_into_the_page(command, tmp_path):
    orbit, page = tmp_path / "o.nc", tmp_path / "o.html"
    command("orbit", "kirchhoff", "--t-end", "5", "--points", "11", "--out", orbit)
    assert command("lab", "--with", orbit, "--export", page)[0] == 0
    assert '"m1 - m3"' not in page.read_text(encoding="utf-8")
    assert command("lab", "--with", orbit, "--surface", "m1 - m3", "--export", page)[0] == 0
    text = page.read_text(encoding="utf-8")
    assert '"m1 - m3"' in text
    assert "Saved: an orbit, 11 times from t = 0 to t = 5" in text
    code, _, err = command("lab", "clebsch", "--with", orbit, "--export", page)
    assert code == 2
    assert "another vector field, that of 'kirchhoff'" in err
    assert page.read_text(encoding="utf-8") == text


def test_parameters_surfaces_and_files_are_read_as_elsewhere(command, tmp_path):
    page = tmp_path / "a.html"
    system = tmp_path / "mine.toml"
    system.write_text(
        'name = "mine"\n[bracket]\nalgebra = "so(3)"\nextension = "trivial()"\nvariables = ["m"]\n'
        '[parameters]\nk = 2\n[hamiltonian]\nexpression = "m1^2 + k*m2^2"\n',
        encoding="utf-8",
    )
    code, _, err = command("lab", system, "--set", "k=3", "--surface", "m1 - m3", "--surface", "m2", "--export", page)
    assert (code, err) == (0, "")
    text = page.read_text(encoding="utf-8")
    assert '"name":"mine, k = 3"' in text
    assert '{"name":"m1 - m3","functions":' in text


def started(*arguments, **environment):
    return subprocess.Popen(
        [sys.executable, "-m", "liepoisson", "lab", *arguments],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env={**os.environ, **environment},
    )  # fmt: skip


@pytest.mark.skipif(os.name == "nt", reason="Windows sends no SIGINT to one process")
@pytest.mark.parametrize(
    ("arguments", "begin"),
    [((), "tops: "), (("three-wave",), "three-wave: "), (("twisted-kovalevskaya",), "twisted-kovalevskaya: ")],
)
def test_the_address_is_printed_and_answers_until_control_c(arguments, begin):
    process = started(*arguments, "--no-open")
    try:
        line = process.stdout.readline()
        assert line.startswith(begin)
        assert process.stdout.readline() == "Ctrl-C ends it.\n"
        url = re.search(r"http://127\.0\.0\.1:\d+/[\w-]{32,}/", line)[0]
        assert ("#v=1&top=2,2,1," in line) == (arguments == ("twisted-kovalevskaya",))
        with urllib.request.urlopen(url, timeout=10) as answer:
            text = answer.read().decode()
        assert ('id="system"' in text.partition('<script type="module"')[0]) == (arguments == ("three-wave",))
        with pytest.raises(urllib.error.HTTPError, match="403"):
            urllib.request.urlopen(url[:-2], timeout=10)
    finally:
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=20)
    assert process.returncode == 0
    assert (out.strip(), err) == ("", "")
