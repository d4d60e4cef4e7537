"""The shipped certificate is accepted in ball arithmetic, and every control is refused."""

import dataclasses
from fractions import Fraction

import pytest
from flint import arb, arb_mat

import liepoisson as lp
from liepoisson.errors import EnclosureError, LiePoissonError
from liepoisson.proofs.balls import checker as ball_checker
from liepoisson.proofs.balls.checker import check_in_balls
from liepoisson.proofs.balls.field import BallField, working
from liepoisson.proofs.balls.sets import BallSet, _gradients
from liepoisson.proofs.certificate import read_certificate
from liepoisson.proofs.polynomial_field import polynomial_field


@pytest.fixture(scope="module")
def margins(shipped, twisted):
    return check_in_balls(read_certificate(shipped), twisted)


def test_the_shipped_certificate_is_accepted(margins):
    assert margins.n_edges == 28
    assert margins.expansion > 1.3
    assert margins.contraction < 0.8
    assert margins.cone > 0.4
    assert margins.apart_from_orbit > 1.6
    assert margins.apart_from_excursion > 0.5
    assert margins.apart_from_image > 1.5
    # the loops take 3.18714 and 40.6756 on the orbits themselves
    assert 3.18713 < margins.loop_times[0] < 3.1875
    assert 40.67 < margins.loop_times[1] < 40.69
    assert 0.0479 < margins.entropy < 0.0481


def test_rotation_numbers_on_two_levels_differ(margins):
    # theta/pi = 0.716818090706 and 0.716818103117, from multipliers computed with 30 digits
    first, second = margins.rotations
    assert first.lower < 0.716818090706 < first.upper < second.lower < 0.716818103117 < second.upper


def nudged(text, by):
    return (float.fromhex(text) + by).hex()


def moved_center(data):
    data["sets"][3]["center"][0] = nudged(data["sets"][3]["center"][0], 2e-4)


def exchanged_frame(data):
    for row in data["sets"][0]["frame"]:
        row[0], row[1], row[3], row[4] = row[3], row[4], row[0], row[1]


def without_symmetry(data):
    data["edges"][1]["symmetry"] = False


def to_the_wrong_set(data):
    data["edges"][2]["to"], data["edges"][3]["to"] = data["edges"][3]["to"], data["edges"][2]["to"]


def off_the_level(data):
    data["sets"][5]["center"][0] = nudged(data["sets"][5]["center"][0], 1e-9)


CONTROLS = {
    "a center off the level by 1e-9": off_the_level,
    "a center moved by 2e-4": moved_center,
    "unstable and stable columns exchanged": exchanged_frame,
    "the symmetry removed": without_symmetry,
    "an edge to the wrong set": to_the_wrong_set,
    "H changed by 1e-6": lambda d: d["level"].update(H=str(Fraction(1, 2) + Fraction(1, 10**6))),
    "C1 changed by 1e-6": lambda d: d["level"].update(C1=str(1 + Fraction(1, 10**6))),
    "the sign of C2": lambda d: d["level"].update(C2="-1/2"),
    "another level": lambda d: d["level"].update(C3="2"),
    "a Casimir too few": lambda d: d["level"].pop("C3"),
    "no edges": lambda d: d.update(edges=[]),
    "a missing edge": lambda d: d["edges"].pop(),
    "another time": lambda d: d["edges"][0].update(time=(1.7).hex()),
    "a singular frame": lambda d: d["sets"][0].update(frame=[["0x0p+0"] * 9] * 9),
    "a symmetry that is none": lambda d: d.update(symmetry=[1, -1, -1, 1, -1, -1, 1, -1, 1]),
    "no symmetry": lambda d: d.update(symmetry=[1] * 9),
    "all sets ten times as large": lambda d: [
        row.__setitem__(k, (10 * float.fromhex(row[k])).hex())
        for s in d["sets"]
        for row in s["frame"]
        for k in (0, 1, 3, 4)
    ],
}


@pytest.mark.parametrize("change", CONTROLS.values(), ids=CONTROLS)
def test_controls_are_refused(altered, twisted, change):
    change(altered)
    with pytest.raises(LiePoissonError):
        check_in_balls(read_certificate(altered), twisted)


def test_another_field_is_refused(shipped):
    certificate = read_certificate(shipped)
    other = polynomial_field(lp.Top(inertia=(2, 2, 1), a=(-1, 0, 0), epsilon="0.999"))
    with pytest.raises(EnclosureError):
        check_in_balls(certificate, other)


@pytest.mark.parametrize("component", range(9))
def test_a_wrong_sign_in_the_field_is_refused(shipped, twisted, component):
    rates = list(twisted.rates)
    term, value = next(iter(rates[component].items()))
    rates[component] = {**rates[component], term: -value}
    with pytest.raises(EnclosureError):
        check_in_balls(read_certificate(shipped), dataclasses.replace(twisted, rates=tuple(rates)))


def test_constants_that_change_along_orbits_are_refused(shipped, twisted):
    constants = {**twisted.constants, "C3": {m: 2 * c if m[6] else c for m, c in twisted.constants["C3"].items()}}
    with pytest.raises(EnclosureError, match="C3 is not constant"):
        check_in_balls(read_certificate(shipped), dataclasses.replace(twisted, constants=constants))


@pytest.fixture(scope="module")
def checker(shipped, twisted):
    """A checker with its charts and the first edges of its graph."""
    with working():
        found = ball_checker._Checker(read_certificate(shipped), twisted, lambda _: None)
        ends = {found.graph.start, found.graph.other}
        charts = [ball_checker.chart(found.field, s, found.level, s.unit) for s in found.sets]
        edges = [e for e in found.certificate.edges if {e.source, e.target} == ends]
        found.certificate = dataclasses.replace(found.certificate, edges=tuple(edges))
        loop = [found._transition(e, found.sets[e.source], charts[e.source], found.sets[e.target]) for e in edges]
    return found, charts, loop


def test_orbits_visit_each_set_once_at_a_time(checker, monkeypatch):
    found, charts, loop = checker
    with working():
        found._require_single_visits(charts, loop)
        # p_a is mapped to itself by the reverser that changes the signs of l2, alpha2 and beta2
        monkeypatch.setattr(found, "signs", [1, -1, 1] * 3)
        with pytest.raises(EnclosureError, match="may meet its image"):
            found._require_single_visits(charts, loop)


@pytest.mark.parametrize("fault", ["a long window", "a first step that turns"])
def test_orbits_that_may_come_back_within_the_window_are_refused(checker, fault):
    found, charts, loop = checker
    one = loop[0]
    if fault == "a long window":
        changed = dataclasses.replace(one, landing=dataclasses.replace(one.landing, window=arb("0.06")))
    else:
        box = [b.union(arb(0)) for b in one.tubes[0].box]  # the field vanishes at 0
        changed = dataclasses.replace(one, tubes=(dataclasses.replace(one.tubes[0], box=box), *one.tubes[1:]))
    with working(), pytest.raises(EnclosureError, match="come back"):
        found._require_single_visits(charts, [changed, *loop[1:]])


def test_gradients_of_a_cubic_are_enclosed_away_from_the_center(twisted):
    """F = l1^3 has the gradient 3 l1^2, also over a box that does not contain the center from which it is computed."""
    cube = {tuple(3 * (k == 0) for k in range(9)): Fraction(1)}
    field = BallField(dataclasses.replace(twisted, constants={"F": cube, **dict(list(twisted.constants.items())[1:])}))
    with working():
        identity = arb_mat([[int(i == j) for j in range(9)] for i in range(9)])
        whole = BallSet("a set", [arb(1)] + [arb(0)] * 8, identity, 2)
        found = _gradients(field, whole, [arb("0.5"), arb(0), arb(0), arb(0)], [arb(0)] * 4)
    assert found[0, 0].contains(arb("6.75"))
