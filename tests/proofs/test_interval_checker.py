"""The shipped certificate is accepted in intervals, and every control is refused by the check that it is made for."""

import dataclasses
from fractions import Fraction

import numpy as np
import pytest
from controls import require_shipped

import liepoisson as lp
from liepoisson import _core
from liepoisson.errors import EnclosureError
from liepoisson.proofs import interval_checker
from liepoisson.proofs.certificate import read_certificate
from liepoisson.proofs.interval_checker import check_in_intervals, core_terms, energy_shift


@pytest.fixture(scope="module")
def margins(shipped, twisted):
    return check_in_intervals(read_certificate(shipped), twisted)


def test_the_shipped_certificate_is_accepted(margins):
    assert margins.n_edges == 28
    assert margins.n_steps == 448
    assert margins.expansion > 1.2
    assert margins.contraction < 0.95
    assert margins.cone > 0.4
    assert margins.symmetric_q < 0.6
    require_shipped(margins)


@pytest.mark.parametrize(
    ("place", "value"), [(("sets", 2, "center", 4), float("nan")), (("edges", 3, "time"), float("inf"))]
)
def test_numbers_that_are_not_finite_are_refused(shipped, twisted, place, value):
    certificate = read_certificate(shipped)
    if place[0] == "edges":
        edges = list(certificate.edges)
        edges[place[1]] = dataclasses.replace(edges[place[1]], time=value)
        certificate = dataclasses.replace(certificate, edges=tuple(edges))
    else:
        sets = list(certificate.sets)
        center = list(sets[place[1]].center)
        center[place[3]] = value
        sets[place[1]] = dataclasses.replace(sets[place[1]], center=tuple(center))
        certificate = dataclasses.replace(certificate, sets=tuple(sets))
    with pytest.raises(EnclosureError, match="finite"):
        check_in_intervals(certificate, twisted)


@pytest.mark.parametrize(
    ("setting", "words"),
    [
        (("SMALL", 0.9999), "reversal"),
        (("NEAR", 2.0), "short against the loops"),
        (("REACH", 10.0), "chart"),
        (("COMPLEX", 3), "sections of dimension"),
    ],
)
@pytest.mark.thorough
def test_settings_cannot_weaken_what_is_proved(shipped, twisted, monkeypatch, setting, words):
    monkeypatch.setattr(interval_checker, *setting)
    with pytest.raises(EnclosureError, match=words):
        check_in_intervals(read_certificate(shipped), twisted)


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("shift", "words"),
    [(Fraction(1, 10**6), "two levels of the ball"), (Fraction(1, 10**13), "different angles")],
)
def test_without_two_angles_nothing_is_said_about_integrals(shipped, twisted, monkeypatch, shift, words):
    """The shift and the entropy do not depend on the angles of the multipliers."""
    monkeypatch.setattr(interval_checker, "energy_shift", lambda _: shift)
    found = check_in_intervals(read_certificate(shipped), twisted)
    assert words in found.undecided
    assert (found.rotations, found.discriminant, found.excludes_integrals) == (None, None, False)
    assert found.expansion > 1.2
    assert 0.0479 < found.entropy < 0.0481


def test_energies_are_compared_within_the_ball_of_levels():
    assert energy_shift(Fraction(3, 10**8)) == Fraction(1, 2**26)
    for radius in (Fraction(7), Fraction(1, 10**9), Fraction(1, 2**30)):
        assert radius / 4 < energy_shift(radius) <= radius / 2 or energy_shift(radius) == 1


TIMES = ((3.1870, 3.1873), (40.674, 40.677))


def test_orbits_visit_each_set_once_at_a_time(shipped, twisted):
    certificate = read_certificate(shipped)
    interval_checker._require_single_visits(certificate, twisted, TIMES)
    # p_a is mapped to itself by the reverser that changes the signs of l2, alpha2 and beta2
    reversed_ = dataclasses.replace(certificate, symmetry=(1, -1, 1) * 3)
    with pytest.raises(EnclosureError, match="set p_a: it may meet its image"):
        interval_checker._require_single_visits(reversed_, twisted, TIMES)


def test_orbits_that_may_come_back_to_a_section_are_refused(shipped, twisted):
    certificate = read_certificate(shipped)
    with pytest.raises(EnclosureError, match="differ by more"):
        interval_checker._require_single_visits(certificate, twisted, ((3.1, 3.2), TIMES[1]))
    # the flow keeps H: with the columns of the flow and of grad H exchanged it is tangent to the section
    one = certificate.sets[4]
    frame = tuple((*row[:2], row[5], *row[3:5], row[2], *row[6:]) for row in one.frame)
    sets = (*certificate.sets[:4], dataclasses.replace(one, frame=frame), *certificate.sets[5:])
    with pytest.raises(EnclosureError, match=f"set {one.name}: orbits may come back"):
        interval_checker._require_single_visits(dataclasses.replace(certificate, sets=sets), twisted, TIMES)


def test_visits_are_a_part_of_the_check(shipped, twisted, monkeypatch):
    monkeypatch.setattr(interval_checker, "VISIT", 1e-4)
    with pytest.raises(EnclosureError, match="visits"):
        check_in_intervals(read_certificate(shipped), twisted)


def test_the_normal_of_a_section_is_exact():
    frame = [[float((3 * i + 5 * j * j + i * j) % 7) + (i == j) / 8 for j in range(9)] for i in range(9)]
    normal = interval_checker._normal(frame, 2)
    products = [sum(n * Fraction(row[k]) for n, row in zip(normal, frame, strict=True)) for k in range(9)]
    assert products == [Fraction(k == 2) for k in range(9)]


def test_orbits_of_points_of_a_set_stay_in_its_enclosure(shipped, twisted):
    """Random points of a set, integrated by the other arithmetic of the package, arrive within the bounds."""
    certificate = read_certificate(shipped)
    chosen, edge = certificate.sets[9], next(e for e in certificate.edges if e.source == 9)
    frame = np.array(chosen.frame)[:, [0, 1, 3, 4]]
    field, box = [core_terms(rate) for rate in twisted.rates], np.ones(4)
    how = (20, 0.1, None, 1000)
    found = _core.enclose_flow(
        field, np.array(chosen.center), frame.ravel(), -box, box, edge.time, how, False, 60.0, None
    )
    places = np.random.default_rng(5).uniform(-1, 1, (50, 4))
    starts = np.array(chosen.center) + places @ frame.T
    ends = lp.integrate(lp.Top.twisted_kovalevskaya(), starts, times=[0, edge.time]).state[:, -1]
    margin = 1e-12  # round-off of the orbits
    assert np.all(ends > found["lower"] - margin)
    assert np.all(ends < found["upper"] + margin)
    # and they fill a good part of the enclosure
    assert np.all(ends.max(axis=0) - ends.min(axis=0) > 0.1 * (found["upper"] - found["lower"]))
