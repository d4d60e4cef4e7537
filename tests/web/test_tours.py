"""What the tours of the laboratory say: each number and claim in their words, against the package."""

import json
import math
import os
import re
import shutil
import subprocess
from fractions import Fraction
from pathlib import Path
from urllib.parse import parse_qs

import numpy as np
import pytest
from scipy.special import ellipk

import liepoisson as lp
from liepoisson.laboratory import page_of, write_page

ROOT = Path(__file__).resolve().parents[2]
WEB = ROOT / "web"
CHROMIUM = os.environ.get("CHROMIUM", "/usr/bin/chromium")
METHOD = lp.Taylor(tol=1e-15)
TOURS = {
    file.stem.split("-", 1)[1]: json.loads(file.read_text(encoding="utf-8"))
    for file in sorted((WEB / "src" / "data" / "tours").glob("*.json"))
}
PRESETS = {
    one["key"]: one for one in json.loads((WEB / "src" / "data" / "tops.json").read_text(encoding="utf-8"))["presets"]
}
UNTIL = 10240.0
"""The last time of the chart of exponents."""


def step(tour, k):
    """Words, top and start of a step, counted from 1."""
    found = TOURS[tour]["steps"][k - 1]
    query = {name: values[0] for name, values in parse_qs(found["state"]).items()}
    preset = PRESETS.get(query.get("preset"), {})
    numbers = query["top"].split(",") if "top" in query else preset["parameters"]
    start = query["start"].split(",") if "start" in query else preset["start"]
    values = [Fraction(one) for one in numbers]
    top = lp.Top(inertia=values[:3], a=values[3:6], b=values[6:9], epsilon=values[9])
    return found["words"], top, [float(Fraction(one)) for one in start]


def motion(top, start, until, n=6001):
    """Times and states."""
    times = np.linspace(0, until, n)
    return times, lp.integrate(top, start, times=times, method=METHOD).state.reshape(n, -1)


def zeros(times, values):
    """Where a function changes its sign, by straight lines."""
    k = np.flatnonzero(np.diff(np.sign(values)))
    return times[k] - values[k] * (times[k + 1] - times[k]) / (values[k + 1] - values[k])


def precession(top, start, until=60.0):
    """Mean rate of the third axis about alpha, and the least and largest angle between the two, in degrees."""
    times, states = motion(top, start, until)
    alpha, beta = states[:, 3:6], states[:, 6:9]
    azimuth = np.unwrap(np.arctan2(np.cross(alpha, beta)[:, 2], beta[:, 2]))
    angles = np.degrees(np.arccos(states[:, 5]))
    return abs(azimuth[-1] - azimuth[0]) / times[-1], angles.min(), angles.max()


def exponent(system, start, until=UNTIL):
    """As the page computes it."""
    ones = np.ones(len(start))
    return lp.finite_time_exponents(system, start, times=[until], tangents=ones, method=METHOD).exponent.item()


def test_precession_nods_and_turns_as_it_says():
    _, top, start = step("precession", 1)
    assert start[:3] == [0, 0, 0]
    assert f"{math.degrees(math.acos(start[5])):.1f}°" == "36.9°"
    words, top, start = step("precession", 2)
    _, least, largest = precession(top, start)
    assert f"between {least:.1f}° and {largest:.1f}°" in words
    for k, rate in ((3, 1 / 2), (4, 5 / 2)):
        # Omega^2 cos(theta) - l3 Omega + 1 = 0
        assert rate**2 * 4 / 5 - 12 / 5 * rate + 1 == pytest.approx(0, abs=1e-15)
        words, top, start = step("precession", k)
        found, least, largest = precession(top, start)
        assert found == pytest.approx(rate, abs=1e-9)
        assert largest - least < 1e-6
        assert f"{2 * math.pi / rate:.2f} time units" in words
    words, top, start = step("precession", 5)
    found, _, largest = precession(top, start)
    assert f"dips to {largest:.1f}° only" in words
    assert f"a rate of {found:.2f} on average" in words
    assert 2 * found < precession(*step("precession", 2)[1:])[0]


def test_a_free_body_turns_over_at_the_times_of_jacobi():
    between = {}
    for k in (1, 4):
        words, top, start = step("kick", k)
        times, states = motion(top, start, 100.0, 20001)
        turned = zeros(times, states[:, 1])
        between[k] = np.diff(turned).mean()
        if k == 1:
            assert 9 < turned[0] < 10
            assert "For nine time units" in words
    words = step("kick", 4)[0]
    assert f"{between[4]:.2f} here, {between[1]:.2f} before" in words
    rate = 2 * math.sqrt((1 - 1 / 2) * (1 / 2 - 1 / 3))
    assert rate == pytest.approx(1 / math.sqrt(3))
    assert f"{2 * math.log(10) / rate:.2f} time units" in words
    words, _, start = step("kick", 5)
    delta = start[0]
    jacobi = 2 * ellipk(1 / (1 + delta**2)) / math.sqrt((1 + delta**2) / 3)
    assert jacobi == pytest.approx(between[1], abs=1e-6)
    assert f"at the start: {jacobi:.2f}" in words
    words, top, start = step("kick", 3)
    for first in (start, start[2::-1] + start[3:]):
        _, states = motion(top, first, 200.0)
        axis = int(np.argmax(np.abs(first[:3])))
        away = np.degrees(np.arccos(states[:, axis] / np.linalg.norm(first[:3]))).max()
        assert away < 1.2
    assert "within 1.2°" in words


@pytest.mark.parametrize(
    ("k", "energy", "least", "largest"),
    [
        (1, "1/12", 0, 1e-3),
        (2, "1/12", 0, 1e-3),
        (3, "1/8", 0, 1e-3),
        (4, "1/8", 0.035, 0.045),
        (5, "1/6", 0.125, 0.135),
    ],
)
def test_a_star_has_the_energy_and_the_exponent_that_are_told(k, energy, least, largest):
    system = lp.catalog.system("henon-heiles")
    start = [float(one) for one in parse_qs(TOURS["henon-heiles"]["steps"][k - 1]["state"])["start"][0].split(",")]
    assert system.invariant_values(np.array(start))["H"] == pytest.approx(float(Fraction(energy)), abs=1e-15)
    assert least < exponent(system, start, 10_000.0) < largest


def test_casimirs_are_those_of_every_body_and_invariants_of_one():
    names = [list(step("casimir", k)[1].invariants) for k in (1, 2, 3, 4)]
    assert names[0] == names[1] == names[3] == ["H", "C1", "C2", "C3"]
    assert set(names[2]) - set(names[0]) == {"l.alpha", "K"}
    values = [step("casimir", k)[1].invariant_values(np.array(step("casimir", k)[2])) for k in (1, 2)]
    for name in ("C1", "C2", "C3"):
        assert values[0][name] == values[1][name]
    assert values[0]["H"] != values[1]["H"]
    other = lp.Top(inertia=(2, 2, 1), a=(-1, 0, 0), b=(0, 0, "1/10"), epsilon=0)
    assert list(other.invariants) == names[0]
    assert "b₃ = 1/10" in step("casimir", 3)[0]
    twisted = step("casimir", 4)[1]
    x = np.array([1, 2, 3, 4, 5, 6, 7, 8, 10.0])
    assert twisted.invariant_values(x)["C1"] == x[3:6] @ x[3:6] + 2 * x[:3] @ x[6:]
    _, states = motion(twisted, step("casimir", 4)[2], 20.0)
    lengths = np.linalg.norm(states[:, 3:6], axis=1)
    assert lengths.max() > 1.1 * lengths.min()


def test_the_twisted_tops_have_the_exponents_that_are_told():
    words, top, start = step("twisted-top", 3)
    chaotic = exponent(top, start)
    assert f"is {chaotic:.2f} at t = 10,000" in words
    assert 7 < 1 / chaotic < 8.5
    words, top, start = step("twisted-top", 4)
    assert f"falls to {exponent(top, start):.4f} at t = 10,000" in words
    assert "l3" in top.invariants
    assert len(top.invariants) == 6
    assert {"l.alpha", "K"} <= set(step("twisted-top", 1)[1].invariants)


def test_the_orbits_of_the_proof_stay_and_return_when_they_are_said_to():
    file = ROOT / "python" / "liepoisson" / "proofs" / "twisted_kovalevskaya.json"
    certificate = json.loads(file.read_text(encoding="utf-8"))
    centres = {one["name"]: [float.fromhex(value) for value in one["center"]] for one in certificate["sets"]}
    period = 2 * sum(float.fromhex(edge["time"]) for edge in certificate["edges"][:2])
    words, top, start = step("proof", 2)
    assert start == centres["p_a"]
    values = top.invariant_values(np.array(start))
    assert [values[name] for name in ("H", "C1", "C2", "C3")] == pytest.approx([0.5, 1, 0.5, 1], abs=1e-14)
    assert f"closes after {period:.3f} time units" in words
    _, gamma = motion(top, start, period, 2001)
    assert np.abs(gamma[-1] - gamma[0]).max() < 1e-9

    def away(first):
        times, states = motion(top, first, 60.0, 601)
        return times, np.array([np.linalg.norm(gamma - state, axis=1).min() for state in states])

    times, distance = away(start)
    assert distance[times <= 7 * period].max() < 0.01
    assert distance[times >= 52].min() > 0.03
    words, _, start = step("proof", 3)
    assert start == centres["q1"]
    times, distance = away(start)
    assert 17 < times[: int(np.flatnonzero(times <= 40)[-1])][np.argmax(distance[times < 40])] < 21
    assert distance[(times > 30) & (times < 30 + 3 * period)].max() < 0.02
    assert distance[np.argmin(np.abs(times - 1.6 * period))] > 0.02


def test_the_margins_of_the_proof_are_those_of_its_page():
    page = (ROOT / "docs" / "proof.md").read_text(encoding="utf-8")
    words = step("proof", 4)[0]
    assert "Verified for 27 sets" in page
    assert "27 small sets" in words
    out = [float(one) for one in re.search(r"images reach out to \(> 1\) +(\S+) +(\S+)", page).groups()]
    stable = [float(one) for one in re.search(r"size of images \(< 1\) +(\S+) +(\S+)", page).groups()]
    assert min(out) >= 1.27
    assert max(stable) <= 0.89
    assert "at least 1.27" in words
    assert "at most 0.89" in words
    assert "greater than 0.0479" in page
    assert "greater than 0.0479" in step("proof", 5)[0]


@pytest.mark.thorough
def test_the_page_of_a_system_goes_through_its_tour(tmp_path):
    if shutil.which("node") is None or not Path(CHROMIUM).exists():
        pytest.skip("node or Chromium is not installed; no page is opened")
    if not (WEB / "node_modules" / "playwright-core").is_dir():
        pytest.skip("web/node_modules is missing (npm ci in web); no page is opened")
    file = write_page(page_of(lp.catalog.system("henon-heiles"), start=[0, 0.1, 0.2, 0]), tmp_path / "page.html")
    command = ["node", "test/tours.mjs", str(file), ""]
    done = subprocess.run(command, cwd=WEB, capture_output=True, text=True, timeout=200, check=False)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert (found["wrong"], found["before"]) == ([], found["after"])
    assert len(found["steps"]) == 5
    for told, shown in zip(TOURS["henon-heiles"]["steps"], found["steps"], strict=True):
        assert (shown["title"].split(": ", 1)[1], shown["pointed"], shown["message"]) == (told["title"], told["at"], "")
        wanted = parse_qs(told["state"])["start"][0].split(",")
        assert [one["value"] for one in shown["state"]["start"]] == [float(one) for one in wanted]
        assert (shown["state"]["surface"], shown["state"]["axes"]) == (0, [1, 3])
