"""Certificates of another level of the twisted top and of an untwisted top: what both arithmetics accept and refuse."""

import json
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.cli.systems import read_system
from liepoisson.errors import EnclosureError
from liepoisson.proofs.balls import checker as ball_checker
from liepoisson.proofs.balls.checker import check_in_balls
from liepoisson.proofs.balls.field import working
from liepoisson.proofs.certificate import load_covering_certificate, read_certificate
from liepoisson.proofs.interval_checker import check_in_intervals
from liepoisson.proofs.polynomial_field import polynomial_field
from liepoisson.proofs.search import find_certificate

FOLDER = Path(__file__).parent
"""Both files were written by `liepoisson prove SYSTEM --search --level ... --out`."""
HEAVY_LEVEL = ({"C1": "1/2", "C2": 1}, 1)


def heavy_top():
    """The untwisted top with the inertia (1, 1, 2) and the centre of mass on the first axis."""
    return read_system("heavy-top", ["I=1,1,2", "a=1,0,0"])


SYSTEMS = {"second_level": lp.Top.twisted_kovalevskaya, "heavy_top": heavy_top}
CHECKERS = {"intervals": check_in_intervals, "balls": check_in_balls}


@pytest.fixture(params=SYSTEMS)
def case(request):
    """The data of a file, and the field that it is about."""
    data = json.loads((FOLDER / f"{request.param}.json").read_text(encoding="utf-8"))
    return data, polynomial_field(SYSTEMS[request.param]())


@pytest.fixture(params=CHECKERS)
def check(request):
    return CHECKERS[request.param]


def checked(name, check):
    return check(load_covering_certificate(FOLDER / f"{name}.json"), polynomial_field(SYSTEMS[name]()))


def require_second_level(margins):
    """The multipliers of half a loop are -12.56100081 +- 7.93328571 i; the loops take 3.20172 and 47.7984 on the orbits
    themselves.
    """
    assert (margins.n_unstable, margins.level_radius, margins.n_edges) == (2, "3/1000000000", 32)
    assert margins.expansion > 1.15
    assert margins.contraction < 0.97
    assert 3.2017 < margins.loop_times[0] < 3.2019
    assert 47.798 < margins.loop_times[1] < 47.8
    assert 0.0429 < margins.entropy < 0.043
    assert margins.discriminant < -60
    first, second = margins.rotations
    angle = np.angle(-12.56100081 + 7.93328571j) / np.pi
    assert first.upper < second.lower
    assert abs(first.lower - angle) < 2e-9
    assert first.upper - first.lower < 1e-9
    assert margins.excludes_integrals


def require_heavy_top(margins):
    """The unstable multiplier of half a loop is 29.13; the loops take 5.57298 and 42.0829 on the orbits themselves."""
    assert (margins.n_unstable, margins.level_radius, margins.n_edges) == (1, "3/100000000", 18)
    assert margins.expansion > 3.1
    assert margins.contraction < 0.34
    assert margins.cone > 0.9
    assert 5.5729 < margins.loop_times[0] < 5.5733
    assert 42.082 < margins.loop_times[1] < 42.085
    assert 0.0388 < margins.entropy < 0.0389
    assert (margins.discriminant, margins.rotations, margins.undecided) == (None, None, "")
    assert margins.reversers in (((1, 1, -1) * 2, (1, -1, 1) * 2), ((1, -1, 1) * 2, (1, 1, -1) * 2))
    assert margins.excludes_integrals


@pytest.fixture(scope="module")
def proof():
    """Of the second level, in intervals."""
    top = lp.Top.twisted_kovalevskaya()
    return lp.proofs.prove_chaos(top, FOLDER / "second_level.json", arithmetics=["intervals"])


@pytest.mark.thorough
def test_intervals_accept_the_second_level(proof):
    require_second_level(proof.margins[0])


@pytest.mark.slow
def test_balls_accept_the_second_level():
    require_second_level(checked("second_level", check_in_balls))


@pytest.mark.thorough
def test_both_arithmetics_accept_the_heavy_top(check):
    require_heavy_top(checked("heavy_top", check))


def test_a_ball_of_levels_must_be_one(case, check):
    data, field = case
    with pytest.raises(ValueError, match="level_radius"):
        read_certificate({**data, "level_radius": "-1/10"})
    with pytest.raises(EnclosureError, match="radius"):
        check(replace(read_certificate(data), level_radius=Fraction(0)), field)


@pytest.mark.thorough
def test_balls_say_nothing_about_integrals_where_angles_are_not_known(shipped, twisted, monkeypatch):
    """From sets as large as half of those of the chain the angles are known to few digits."""
    with working():
        checker = ball_checker._Checker(read_certificate(shipped), twisted, lambda _: None)
        _, _, loop = checker._small_loop()
        monkeypatch.setattr(ball_checker, "TINY", Fraction(1, 2))
        discriminant, rotations, undecided = checker._rotation_margins(
            loop, dict(zip(checker.graph.short, loop, strict=True))
        )
    assert discriminant < -30
    assert rotations is None
    assert any(words in undecided for words in ("may be equal", "not provably"))


@pytest.mark.thorough
def test_the_theorem_is_about_the_level_of_the_certificate(proof):
    """Nothing of the shipped level is in it; where the angles are not known, nothing is said about integrals."""
    text = " ".join(str(proof).split())
    assert "Let E be the level H = 4, C1 = 10, C2 = -2, C3 = 1, and R the change" in text
    assert "entropy of the flow is greater than 0.0429" in text
    assert "there is no further analytic constant of motion" in text
    unknown = replace(proof.margins[0], rotations=None, discriminant=None, undecided="angles: unknown")
    open_text = " ".join(str(replace(proof, margins=(unknown,))).split())
    assert "dF ^" not in open_text


@pytest.mark.slow  # quick is the search for that of the twisted top, in test_search.py
def test_a_short_search_finds_a_certificate_of_the_heavy_top():
    leaf, energy = HEAVY_LEVEL
    found = find_certificate(heavy_top(), leaf, energy, n_starts=5)
    margins = check_in_intervals(read_certificate(found.chain.record()), polynomial_field(heavy_top()))
    assert margins.expansion > 1.5
    assert margins.entropy > 0.03
