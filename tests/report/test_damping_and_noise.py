"""Reports on damped systems and systems with noise: what stays constant, and then the system without."""

import json

import liepoisson as lp
from liepoisson.formula.styles import UNICODE

EULER = lp.catalog.euler_top_on("so(3)", [1, 2, 3])
SPIN = lp.System(lp.so(3) @ lp.trivial(), "l3^2/2 + l3", integrals={"K": "l3"}, name="spin")
DAMPED = lp.dissipation.double_bracket(EULER, "1/10")


def rest(report):
    """All but what is said of damping and noise."""
    return {key: value for key, value in report.record().items() if key not in ("name", "damping", "noise")}


def test_a_damped_system_has_its_laws_and_the_report_of_the_system_without():
    report = lp.inspect(DAMPED)
    assert report.name == "damped Euler top on so(3)"
    assert [line[0] for line in report.topics[0].lines[1:]] == [
        "H falls (proved)",
        "C1 is constant (proved)",
        "all that follows is about the system without damping",
    ]
    assert "Damping          double bracket, rate " in report.text(UNICODE)
    record = json.loads(json.dumps(report.record()))["damping"]
    assert record["laws"][0] == {"quantity": "H", "motion": "falls", "known": "proved"}
    assert record["entropy"] is None
    assert set(record["equations"]) == {"l1", "l2", "l3"}
    assert rest(report) == rest(lp.inspect(EULER))
    assert "paragraph{Damping.}" in report.latex()


def test_of_a_metriplectic_flow_the_energy_stays_and_the_entropy_rises():
    first = lp.inspect(lp.dissipation.metriplectic(EULER, "C1")).topics[0]
    assert [line[0] for line in first.lines[1:3]] == ["S rises (proved)", "H is constant (proved)"]
    assert first.record()["entropy"]["expression"] == "l1^2 + l2^2 + l3^2"


def test_with_noise_what_commutes_with_all_is_constant_on_every_path():
    """The noise l3 commutes with K = l3 and H, and l1 with neither."""
    turned = lp.inspect(lp.stochastic.NoisySystem(SPIN, ["l3", "l3^2"]))
    assert turned.topics[0].record()["constant"] == ["H", "C1", "K"]
    shaken = lp.inspect(lp.stochastic.NoisySystem(SPIN, ["l1/2", "l3"], 2))
    record = json.loads(json.dumps(shaken.record()))["noise"]
    assert (record["constant"], record["inverse_temperature"]) == (["C1"], "2")
    assert [one["text"] for one in record["noises"]] == ["l1/2", "l3"]
    words = shaken.text(UNICODE)
    assert "constant on every path: C" in words
    assert "all that follows is about the system without noise" in words
    assert rest(shaken) == rest(lp.inspect(SPIN))


def test_no_noise_is_said():
    assert "noise Hamiltonians none" in lp.inspect(lp.stochastic.NoisySystem(SPIN, [])).text(UNICODE)
