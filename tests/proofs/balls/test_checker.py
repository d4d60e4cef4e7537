"""The shipped certificate is accepted in ball arithmetic, and every control is refused."""

import dataclasses
from fractions import Fraction

import pytest
from controls import require_shipped
from flint import arb, arb_mat

from liepoisson.errors import EnclosureError
from liepoisson.proofs.balls import checker as ball_checker
from liepoisson.proofs.balls.checker import check_in_balls
from liepoisson.proofs.balls.field import BallField, working
from liepoisson.proofs.balls.sets import BallSet, _gradients
from liepoisson.proofs.certificate import read_certificate


@pytest.fixture(scope="module")
def margins(shipped, twisted):
    return check_in_balls(read_certificate(shipped), twisted)


def test_the_shipped_certificate_is_accepted(margins):
    assert margins.n_edges == 28
    assert margins.expansion > 1.3
    assert margins.contraction < 0.8
    assert margins.cone > 0.4
    require_shipped(margins)


@pytest.mark.parametrize("component", [0, 4, 8])
def test_a_wrong_sign_in_the_field_is_refused(shipped, twisted, component):
    rates = list(twisted.rates)
    term, value = next(iter(rates[component].items()))
    rates[component] = {**rates[component], term: -value}
    with pytest.raises(EnclosureError):
        check_in_balls(read_certificate(shipped), dataclasses.replace(twisted, rates=tuple(rates)))


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
