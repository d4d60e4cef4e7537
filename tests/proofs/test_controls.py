"""Altered certificates and other equations are refused in both arithmetics."""

import copy
import dataclasses
import json
import random
from fractions import Fraction
from pathlib import Path

import pytest
from controls import CONTROLS, columns, nudge

import liepoisson as lp
from liepoisson.errors import CertificateError, DamagedFileError, EnclosureError, LiePoissonError
from liepoisson.proofs.balls.checker import check_in_balls
from liepoisson.proofs.certificate import read_certificate
from liepoisson.proofs.interval_checker import check_in_intervals
from liepoisson.proofs.polynomial_field import polynomial_field

CHECKERS = {"intervals": check_in_intervals, "balls": check_in_balls}
both = pytest.mark.parametrize("check", CHECKERS.values(), ids=CHECKERS)


@both
@pytest.mark.thorough
@pytest.mark.parametrize("name", CONTROLS)
def test_a_changed_certificate_is_refused(altered, twisted, check, name):
    change, wanted = CONTROLS[name]
    change(altered)
    with pytest.raises(LiePoissonError) as refusal:
        check(read_certificate(altered), twisted)
    if wanted is not None and check is check_in_intervals:
        assert getattr(refusal.value, "check", None) == wanted, str(refusal.value)


@both
@pytest.mark.thorough
@pytest.mark.parametrize("name", ["second_level", "heavy_top"])
@pytest.mark.parametrize(
    "what", ["unstable and stable columns exchanged", "H changed by 1e-6", "a ball of levels that is too large"]
)
def test_controls_of_other_levels_are_refused(check, name, what):
    data = json.loads((Path(__file__).parent / f"{name}.json").read_text(encoding="utf-8"))
    field = polynomial_field(lp.Top.twisted_kovalevskaya() if name == "second_level" else heavy_top())
    CONTROLS[what][0](data)
    with pytest.raises(LiePoissonError):
        check(read_certificate(data), field)


def heavy_top():
    return lp.catalog.system("heavy-top", {"I": [1, 1, 2], "a": [1, 0, 0]})


@both
@pytest.mark.parametrize("epsilon", ["999/1000", "-1"])
def test_another_top_is_refused(shipped, check, epsilon):
    top = lp.Top(inertia=(2, 2, 1), a=(-1, 0, 0), b=(0, 0, 0), epsilon=epsilon)
    with pytest.raises(EnclosureError):
        check(read_certificate(shipped), polynomial_field(top))


@both
def test_constants_that_change_along_orbits_are_refused(shipped, twisted, check):
    constants = {**twisted.constants, "C3": {m: 2 * c if m[6] else c for m, c in twisted.constants["C3"].items()}}
    with pytest.raises(EnclosureError, match="C3"):
        check(read_certificate(shipped), dataclasses.replace(twisted, constants=constants))


def altered_at_random(data, rng, size):
    """One number of a certificate changed: of a center, a frame, a time or the level."""
    one, kind = rng.choice(data["sets"]), rng.randrange(4)
    if kind == 0:
        nudge(one["center"], rng.randrange(9), size)
    elif kind == 1:
        nudge(rng.choice(one["frame"]), rng.choice(columns(data)), 1e-4 * size)
    elif kind == 2:
        edge = rng.choice(data["edges"])
        edge["time"] = (float.fromhex(edge["time"]) + size).hex()
    else:
        name = rng.choice(sorted(data["level"]))
        data["level"][name] = str(Fraction(data["level"][name]) + Fraction(size))


def verdict(check, data, field):
    try:
        return check(read_certificate(data), field)
    except (EnclosureError, DamagedFileError, CertificateError):
        return None


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_an_alteration_is_judged_alike(shipped, twisted, seed):
    """Where one accepts what the other refuses, its own covering relations hold by less than 0.15."""
    rng, data = random.Random(seed), copy.deepcopy(shipped)
    altered_at_random(data, rng, rng.choice((-1, 1)) * 10 ** rng.uniform(-12, 0))
    found = [m for m in (verdict(check, data, twisted) for check in CHECKERS.values()) if m is not None]
    if len(found) == 1:
        (margins,) = found
        assert min(margins.expansion - 1, 1 - margins.contraction, margins.cone) < 0.15
