"""What both checkers must say of the shipped certificate, and alterations of it that both must refuse."""

from fractions import Fraction


def require_shipped(margins):
    """The loops take 3.187135535704 and 40.6756 on the orbits themselves; theta/pi = 0.716818090706, 0.716818103117.

    The angles are those of multipliers computed with 30 digits, on two levels.
    """
    assert margins.apart_from_orbit > 1.5
    assert margins.apart_from_excursion > 0.4
    assert margins.apart_from_image > 1.5
    assert 3.18713 < margins.loop_times[0] < 3.1875
    assert 40.67 < margins.loop_times[1] < 40.69
    assert 0.0479 < margins.entropy < 0.0481
    assert margins.discriminant < -30
    first, second = margins.rotations
    assert first.lower < 0.716818090706 < first.upper < second.lower < 0.716818103117 < second.upper


def nudge(values, k, by):
    values[k] = (float.fromhex(values[k]) + by).hex()


def scale(factor):
    def change(data):
        for row in (row for entry in data["sets"] for row in entry["frame"]):
            for column in range(len(row)):
                if column in columns(data):
                    row[column] = (float.fromhex(row[column]) * factor).hex()

    return change


def columns(data):
    """The unstable and the stable columns of a frame."""
    k = (len(data["symmetry"]) - 1 - len(data["level"])) // 2
    return [*range(k), *range(k + 1, 2 * k + 1)]


def exchange_columns(data):
    k = len(columns(data)) // 2
    for row in data["sets"][0]["frame"]:
        row[:k], row[k + 1 : 2 * k + 1] = row[k + 1 : 2 * k + 1], row[:k]


def exchange_targets(data):
    data["edges"][2]["to"], data["edges"][3]["to"] = data["edges"][3]["to"], data["edges"][2]["to"]


def change_level(name, by):
    def change(data):
        data["level"][name] = str(Fraction(data["level"][name]) + by)

    return change


CONTROLS = {
    "a center moved by 2e-4": (lambda d: nudge(d["sets"][3]["center"], 0, 2e-4), None),
    "a center off the level by 1e-9": (lambda d: nudge(d["sets"][5]["center"], 0, 1e-9), None),
    "unstable and stable columns exchanged": (exchange_columns, "expansion"),
    "a flag removed": (lambda d: d["edges"][-1].update(symmetry=False), "graph"),
    "two flags exchanged": (
        lambda d: (d["edges"][0].update(symmetry=True), d["edges"][1].update(symmetry=False)),
        "passage",
    ),
    "an edge to the wrong set": (exchange_targets, "graph"),
    "H changed by 1e-6": (change_level("H", Fraction(1, 10**6)), None),
    "C1 changed by 1e-6": (change_level("C1", Fraction(1, 10**6)), None),
    "another value of C2": (change_level("C2", -1), None),
    "a constant too few": (lambda d: d["level"].pop("C2"), None),
    "a ball of levels that is too large": (
        lambda d: d.update(level_radius=str(1000 * Fraction(d.get("level_radius", "3/100000000")))),
        None,
    ),
    "no edges": (lambda d: d.update(edges=[]), "graph"),
    "a missing edge": (lambda d: d["edges"].pop(), "graph"),
    "an edge twice": (lambda d: d["edges"].append(d["edges"][0]), "graph"),
    "another time": (lambda d: d["edges"][0].update(time=(1.7).hex()), None),
    "a singular frame": (lambda d: d["sets"][0].update(frame=[["0x0p+0"] * 9] * 9), "frame"),
    "sets too large": (scale(10.0), None),
    "sets too small": (scale(0.01), "expansion"),
    "a symmetry that is none": (lambda d: d.update(symmetry=[1, -1, -1, 1, -1, -1, 1, -1, 1]), "symmetry"),
    "a symmetry that changes nothing": (lambda d: d.update(symmetry=[1] * len(d["symmetry"])), "symmetry"),
}
"""The alteration, and the check of intervals that it is made for."""
