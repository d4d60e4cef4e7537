"""`liepoisson decide`: verdicts of random starts, of a leaf, of one orbit."""

import json
import re

import pytest

import liepoisson as lp

KINDS = ("regular", "chaotic", "undecided")


def test_verdicts_are_those_of_decide(command):
    top = lp.Top.twisted_kovalevskaya()
    verdict = lp.decide(top, lp.sample_states(top, 12, seed=3), t_end=400, seed=3)
    code, out, err = command("decide", "twisted-kovalevskaya", "--starts", 12, "--t-end", 400, "--seed", 3)
    assert (code, err) == (0, "")
    rows = dict(re.findall(r"^  (regular|chaotic|undecided) +(\d+) ", out, re.MULTILINE))
    assert {kind: int(count) for kind, count in rows.items()} == {
        kind: int((verdict.verdict == kind).sum()) for kind in KINDS
    }
    assert "95% intervals over the starts" in out
    assert re.findall(r"^ +\d+  (regular|chaotic|undecided) ", out, re.MULTILINE) == verdict.verdict.tolist()


def test_one_orbit_is_decided_for_programs(command):
    where = ("--start", "l=0,0,3", "--start", "alpha=3/5,0,4/5")
    code, out, err = command("decide", "lagrange", *where, "--t-end", 500, "--format", "json")
    assert (code, err) == (0, "")
    found = json.loads(out)
    (orbit,) = found["orbits"]
    assert (found["system"], found["t_end"], orbit["outcome"]) == ("lagrange", 500, "finished")
    assert orbit["verdict"] in KINDS
    assert orbit["state"] == [0, 0, 3, 0.6, 0, 0.8]
    verdict = lp.decide(lp.catalog.system("lagrange"), orbit["state"], t_end=500)
    assert orbit["mean_megno"] == verdict.mean_megno[0]


def test_starts_of_one_leaf_and_energy(command):
    code, out, _ = command("decide", "lagrange", "--leaf", "C1=1/2,C2=1", "--energy", 2, "--starts", 2, "--t-end", 200)
    assert code == 0
    assert "lagrange: 2 random starts on one leaf and energy (seed 0) to t = 200" in out
    assert "leaf     dimension 4, alpha != 0: C1 = 0.5, C2 = 1\nenergy   H = 2" in out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["twisted-top"], "must have numbers for all parameters"),
        (["lagrang"], "Did you mean lagrange"),
        (["lagrange", "--t-end", "0"], "--t-end must be a positive finite time"),
        (["lagrange", "--starts", "0"], "--starts must be from 1 to"),
        (["lagrange", "--leaf", "C9=1"], "--leaf must name Casimirs of lagrange; got 'C9'. Known: C1 = l.alpha"),
        (["lagrange", "--method", "splittig"], "Did you mean splitting"),
    ],
)
def test_refusals_are_plain(command, arguments, words):
    code, out, err = command("decide", *arguments)
    assert (code, out) == (2, "")
    assert words in err


def test_after_ctrl_c_it_says_how_to_keep_what_is_done(command, monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("liepoisson.indicators.verdict.decide", interrupted)
    code, _, err = command("decide", "lagrange")
    assert (code, "--time-limit SECONDS" in err) == (130, True)
