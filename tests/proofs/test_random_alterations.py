"""Certificates with one entry altered at random: the two checkers agree, and what they accept is true of sample points.

Both enclose the same numbers, balls more tightly.  Where one accepts what the other refuses, its own covering relations
hold by less than `MARGIN`.  What is accepted is tried on points of the sets, carried by the flow with 25 digits.
"""

import copy
import random
from fractions import Fraction

import pytest
from flint import arb, arb_mat, ctx, fmpq

import liepoisson as lp
from liepoisson.errors import CertificateError, DamagedFileError, EnclosureError
from liepoisson.orbits.precise_flow import PreciseFlow, bits
from liepoisson.proofs.balls.checker import check_in_balls
from liepoisson.proofs.certificate import read_certificate
from liepoisson.proofs.interval_checker import check_in_intervals

pytestmark = pytest.mark.slow  # both checkers, each time

DIGITS = 25
MARGIN = 0.15
N_ALTERATIONS = 40


def nudged(text, by):
    return (float.fromhex(text) + by).hex()


def alter_center(data, rng, size):
    k = rng.randrange(len(data["sets"]))
    place = rng.randrange(9)
    data["sets"][k]["center"][place] = nudged(data["sets"][k]["center"][place], rng.choice((-1, 1)) * size)
    return k


def alter_frame(columns):
    def alter(data, rng, size):
        k, row, column = rng.randrange(len(data["sets"])), rng.randrange(9), rng.choice(columns)
        frame = data["sets"][k]["frame"]
        largest = max(abs(float.fromhex(r[column])) for r in frame)
        frame[row][column] = nudged(frame[row][column], rng.choice((-1, 1)) * size * largest)
        return k

    return alter


def alter_size(data, rng, size):
    k = rng.randrange(len(data["sets"]))
    factor = 1 + rng.choice((-1, 1)) * size
    for row in data["sets"][k]["frame"]:
        for column in (0, 1, 3, 4):
            row[column] = (float.fromhex(row[column]) * factor).hex()
    return k


def alter_time(data, rng, size):
    edge = rng.choice(data["edges"])
    edge["time"] = nudged(edge["time"], rng.choice((-1, 1)) * size)
    return [s["name"] for s in data["sets"]].index(edge["to"])


def alter_level(data, rng, size):
    name = rng.choice(sorted(data["level"]))
    data["level"][name] = str(Fraction(data["level"][name]) + Fraction(rng.choice((-1, 1)) * size))
    return rng.randrange(len(data["sets"]))


def alter_sign(data, rng, _):
    k, column = rng.randrange(len(data["sets"])), rng.randrange(9)
    for row in data["sets"][k]["frame"]:
        row[column] = (-float.fromhex(row[column])).hex()
    return k


def alter_graph(data, rng, _):
    edge = rng.choice(data["edges"])
    kind = rng.randrange(3)
    if kind == 0:
        edge["symmetry"] = not edge["symmetry"]
    elif kind == 1:
        edge["to"] = rng.choice(data["sets"])["name"]
    else:
        data["edges"].remove(edge)
    return 0


KINDS = {
    "center": alter_center,
    "unstable or stable column": alter_frame((0, 1, 3, 4)),
    "column of the flow or a gradient": alter_frame((2, 5, 6, 7, 8)),
    "size of a set": alter_size,
    "time": alter_time,
    "level": alter_level,
    "sign of a column": alter_sign,
    "graph": alter_graph,
}


def verdict(check, data, field):
    try:
        return check(read_certificate(data), field)
    except (EnclosureError, DamagedFileError, CertificateError):
        return None


def slack(margins):
    """How far the covering relations are from being lost."""
    return min(margins.expansion - 1, 1 - margins.contraction, margins.cone)


@pytest.mark.parametrize("seed", range(N_ALTERATIONS))
def test_an_alteration_is_judged_alike_and_rightly(shipped, twisted, seed):
    rng = random.Random(seed)
    name = sorted(KINDS)[seed % len(KINDS)]
    size = 10 ** rng.uniform(-12, 0)
    data = copy.deepcopy(shipped)
    k = KINDS[name](data, rng, size)
    balls, intervals = verdict(check_in_balls, data, twisted), verdict(check_in_intervals, data, twisted)
    accepted = [m for m in (balls, intervals) if m is not None]
    if len(accepted) == 1:
        assert slack(accepted[0]) < MARGIN, f"{name} by {size:.1e}: only {accepted[0].arithmetic} accepts"
    if accepted:
        require_covering_of_points(read_certificate(data), k, rng)


def require_covering_of_points(certificate, k, rng):
    """Points of the sets before and after set k: |q_s'| < 1, and |q_u'| > 1 where |q_u| = 1."""
    with ctx.workprec(bits(DIGITS)):
        flow = PreciseFlow(lp.Top.twisted_kovalevskaya(), DIGITS)
        for edge in certificate.edges:
            if k not in (edge.source, edge.target):
                continue
            for on_boundary in (True, False, True):
                q = point(rng, on_boundary=on_boundary)
                image = coordinates(flow, certificate, edge, q)
                stable = norm(image[3:5])
                assert stable < 1, (edge, q)
                if on_boundary:
                    assert norm(image[:2]) > 1, (edge, q)
                assert all(abs(w) < arb(1) / 1000 for w in image[5:])
                assert abs(image[2]) < arb(10) ** -20


def point(rng, *, on_boundary):
    """A point of |q_u| <= 1, |q_s| <= 1, with |q_u| = 1 on the boundary that is stretched."""
    u, s = ([rng.gauss(0, 1) for _ in range(2)] for _ in range(2))
    size = 1 if on_boundary else rng.random()
    return [arb(x) * size / norm(map(arb, u)) for x in u], [arb(x) * rng.random() / norm(map(arb, s)) for x in s]


def norm(values):
    return sum((v * v for v in values), arb(0)).sqrt()


def coordinates(flow, certificate, edge, q):
    """Where a point of a set arrives: its coordinates (q_u, time, q_s, w) in the next set."""
    start = on_level(certificate, certificate.sets[edge.source], q)
    target = certificate.sets[edge.target]
    frame = arb_mat(9, 9, [arb(v) for row in target.frame for v in row])
    signs = certificate.symmetry if edge.symmetry else (1,) * 9
    time, x = arb(edge.time), flow.end(start, arb(edge.time))[0]
    for _ in range(6):
        away = arb_mat(9, 1, [s * v - arb(c) for s, v, c in zip(signs, x, target.center, strict=True)])
        found = frame.solve(away).entries()
        rate = frame.solve(arb_mat(9, 1, [s * v for s, v in zip(signs, flow.rate(x), strict=True)])).entries()
        step = (-found[2] / rate[2]).mid()
        time, x = time + step, flow.end(x, step)[0]
    return found


def constants(x):
    """H, C1, C2, C3 of the paper."""
    l, alpha, beta = x[:3], x[3:6], x[6:]
    dot = lambda u, v: sum((a * b for a, b in zip(u, v, strict=True)), arb(0))  # noqa: E731
    return [
        (l[0] ** 2 + l[1] ** 2) / 4 + l[2] ** 2 / 2 - alpha[0],
        dot(alpha, alpha) + 2 * dot(l, beta),
        dot(alpha, beta),
        dot(beta, beta),
    ]


def gradients(x):
    l, alpha, beta = x[:3], x[3:6], x[6:]
    zero = [arb(0)] * 3
    return [
        [l[0] / 2, l[1] / 2, l[2], arb(-1), arb(0), arb(0), *zero],
        [2 * v for v in (*beta, *alpha, *l)],
        [*zero, *beta, *alpha],
        [*zero, *zero, *(2 * v for v in beta)],
    ]


def on_level(certificate, one, q):
    """The state of a set with the coordinates q: c + B (q_u, 0, q_s, w), with w such that it lies on the level."""
    frame = [[arb(v) for v in row] for row in one.frame]
    wanted = [
        arb(fmpq(certificate.level[n].numerator, certificate.level[n].denominator)) for n in ("H", "C1", "C2", "C3")
    ]
    w = [arb(0)] * 4
    for _ in range(8):
        place = [*q[0], arb(0), *q[1], *w]
        x = [
            (arb(c) + sum((a * b for a, b in zip(row, place, strict=True)), arb(0))).mid()
            for c, row in zip(one.center, frame, strict=True)
        ]
        left = arb_mat(4, 1, [a - b for a, b in zip(constants(x), wanted, strict=True)])
        slopes = arb_mat(4, 9, [v for row in gradients(x) for v in row]) * arb_mat(
            9, 4, [v for row in frame for v in row[5:]]
        )
        w = [(v - d).mid() for v, d in zip(w, slopes.solve(left).entries(), strict=True)]
    return x
