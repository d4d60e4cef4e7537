"""`liepoisson decide`: verdicts of random starts, of a leaf, of one orbit."""

import json
import re

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
