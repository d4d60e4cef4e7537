"""States of the page in Python: what an address says, what can be set, and what is refused before the page sees it."""

import re
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import liepoisson as lp
from liepoisson.errors import LiePoissonError, ParameterError, ShapeError, UnknownNameError
from liepoisson.laboratory import states
from liepoisson.laboratory.pages import page_of
from liepoisson.laboratory.states import Addresses
from liepoisson.laboratory.tops import presets

WEB = Path(__file__).resolve().parents[2] / "web" / "src"
START = (1.0, 0.2, 0.0, 0.0, 0.6, 0.8)


@pytest.fixture(scope="module")
def tops():
    return Addresses.of(None)


@pytest.fixture(scope="module")
def kirchhoff():
    record = page_of(lp.catalog.system("kirchhoff"), start=START, surfaces=["dot(m, m) - 1/2"]).record
    return Addresses.of(record)


WHOLE_TOP = (
    "v=1&top=2,5/3,1,-1,0,1/4,0,0,0,1/3&start=1,0,0,0,1,0,0,0.5,1&section=l3,-1&axes=l1,alpha2&theme=dark&t=2.5&"
    "speed=0.5&method=taylor,1e-12&frame=rod&shadow=0"
)
"""As `state/url.ts` writes one, but for the order."""


def test_an_address_of_a_top_is_read_and_written_as_it_was(tops):
    state = tops.read(WHOLE_TOP)
    assert state["parameters"]["epsilon"] == "1/3"
    assert state["start"] == (1, 0, 0, 0, 1, 0, 0, 0.5, 1)
    assert (state["surface"], state["direction"], state["axes"]) == ("l3", -1, ("l1", "alpha2"))
    assert (state["view"], state["shadow"], state["tol"], state["time"]) == ("rod", False, 1e-12, 2.5)
    assert tops.write(state) == WHOLE_TOP


def test_an_address_of_a_system_is_read_and_written_as_it_was(kirchhoff):
    address = (
        f"v=1&system={kirchhoff.system}&start=1,0.2,0,0,0.6,0.8&section=7,0&axes=1,4&theme=auto&t=3&speed=2&"
        "view=projection&space=1,2,0&series=2,5&fan=20&orbits=0.5,-1,0.25,2&tol=1e-10"
    )
    state = kirchhoff.read(address)
    assert (state["surface"], state["axes"]) == ("dot(m, m) - 1/2", ("m1", "p1"))
    assert (state["projection"], state["series"]) == (("m1", "m2"), ("m2", "p2"))
    assert (state["fan"], state["orbits"]) == (20, ((0.5, -1), (0.25, 2)))
    assert kirchhoff.write(state) == address


@pytest.mark.parametrize("preset", presets()[:3], ids=lambda preset: preset["key"])
def test_a_preset_has_its_parameters_and_its_start(tops, preset):
    state = tops.read(f"v=1&preset={preset['key']}&section=l1,1")
    assert list(state["parameters"].values()) == preset["parameters"]
    assert state["start"] == tuple(float(Fraction(text)) for text in preset["start"])
    assert tops.write(state) == f"v=1&preset={preset['key']}&section=l1,1"
    moved = tops.changed(state, {"start": [1] * 9})
    assert (moved["preset"], moved["time"]) == (None, 0)
    assert tops.write(moved).startswith(f"v=1&top={','.join(preset['parameters'])}&start=1,1,")


def test_a_section_of_tops_has_many_orbits(tops):
    state = tops.read("v=1&preset=charged&fan=20&orbits=0.5,-1")
    assert (state["fan"], state["orbits"]) == (20, ((0.5, -1.0),))
    assert tops.write(tops.changed(state, {"fan": 10})) == "v=1&preset=charged&fan=10&orbits=0.5,-1"


def test_a_change_keeps_the_rest_and_another_orbit_begins_again(tops):
    state = tops.read(WHOLE_TOP)
    assert tops.changed(state, {"theme": "light"}) == {**state, "theme": "light"}
    assert tops.changed(state, {"start": state["start"]}) == state
    other = tops.changed(state, {"parameters": {"epsilon": 0.25}})
    assert other == {**state, "time": 0, "preset": None, "parameters": {**state["parameters"], "epsilon": "1/4"}}
    assert tops.changed(state, {"start": [1] * 9, "time": 4})["time"] == 4


@pytest.mark.parametrize(
    ("change", "error", "words"),
    [
        ({"tim": 1}, UnknownNameError, "Did you mean time"),
        ({"theme": "drak"}, UnknownNameError, "Did you mean dark"),
        ({"surface": "p1"}, UnknownNameError, "there is no 'p1'"),
        ({"view": "series"}, UnknownNameError, "Known: space, body"),
        ({"projection": ["l1", "l2"]}, UnknownNameError, "no part 'projection'"),
        ({"preset": "lagrang"}, UnknownNameError, "Did you mean lagrange"),
        ({"start": [1, 2]}, ShapeError, "9 components"),
        ({"start": [float("nan")] * 9}, ParameterError, "up to 1e"),
        ({"start": [1e7] * 9}, ParameterError, "up to 1e"),
        ({"time": -1}, ParameterError, "from 0 to 10000"),
        ({"time": [1, 2]}, ParameterError, "from 0 to 10000"),
        ({"speed": 100}, ParameterError, "to 16"),
        ({"tol": 1}, ParameterError, "tol"),
        ({"direction": 2}, ParameterError, "-1, 0 or 1"),
        ({"direction": True}, ParameterError, "-1, 0 or 1"),
        ({3: 4}, LiePoissonError, ""),
        ("time", LiePoissonError, ""),
        ({"axes": [np.zeros(2), np.zeros(2)]}, LiePoissonError, ""),
        ({"time": 10**400}, LiePoissonError, ""),
        ({"axes": ["l1"]}, ParameterError, "2 components"),
        ({"axes": 3}, ParameterError, "2 components"),
        ({"parameters": {"I1": 0}}, ParameterError, "at least 0.01"),
        ({"parameters": {"I4": 1}}, UnknownNameError, "Known: I1, I2"),
        ({"parameters": {"epsilon": "sqrt(2)"}}, ParameterError, "must be a number"),
        ({"parameters": {"epsilon": "1/0"}}, ParameterError, "must be a number"),
        ({"parameters": {"epsilon": "1e999999999"}}, ParameterError, "must be a number"),
        ({"parameters": [1, 2]}, ShapeError, "must be 10"),
        ({"parameters": "1"}, ParameterError, "by name"),
    ],
)
def test_what_cannot_be_is_refused_with_a_reason(tops, change, error, words):
    with pytest.raises(error, match=re.escape(words) or None):
        tops.changed(tops.read(WHOLE_TOP), change)


SCRAPS = (
    "v=1", "&", "=", ",", "1", "-1", "0", "1e5", "1e400", "1/3", "1/0", "l1", "%00", "%ff", ";", "#", "<", "\u2028",
    "x", "dark", "lagrange", "taylor,", *("&" + name + "=" for name in ("top", "start", "section", "axes", "theme", "t",
    "speed", "method", "frame", "shadow", "view", "space", "series", "fan", "orbits", "tol", "preset")),
)  # fmt: skip


@given(st.lists(st.sampled_from(SCRAPS), max_size=12).map("".join), st.booleans())
def test_any_text_is_an_address_or_is_refused(tops, kirchhoff, text, is_top):
    page = tops if is_top else kirchhoff
    try:
        state = page.read(f"v=1{'' if is_top else f'&system={page.system}'}{text}")
    except LiePoissonError:
        return
    assert page.read(page.write(state)) is not None


def test_some_parameters_are_not_enough_where_the_others_are_not_known(tops):
    assert tops.changed({}, {"parameters": {}}) == {}
    with pytest.raises(ParameterError, match="the page has not yet said its own; got epsilon"):
        tops.changed(tops.read("v=1&t=2"), {"parameters": {"epsilon": 1}})


def test_what_a_system_cannot_show_is_refused(kirchhoff):
    for change, error in (
        ({"preset": "lagrange"}, UnknownNameError),
        ({"surface": "p4"}, UnknownNameError),
        ({"series": ["m1"] * 9}, ParameterError),
        ({"projection": ["m1"]}, ParameterError),
        ({"view": "body"}, UnknownNameError),
        ({"view": "picture"}, UnknownNameError),
        ({"fan": 9}, ParameterError),
        ({"fan": 41}, ParameterError),
        ({"orbits": [[1, 2, 3]]}, ShapeError),
        ({"orbits": [[0, 1]] * 41}, ParameterError),
        ({"orbits": [[0, np.inf]]}, ParameterError),
    ):
        with pytest.raises(error):
            kirchhoff.changed({}, change)


@pytest.mark.parametrize(
    "address",
    ["", "v=2", "v=1&system=0", "v=1&x=1", "v=1&top=1,2", "v=1&start=a", "v=1&start=1/0", "v=1&section=l3", "v=1&t=x",
     "v=1&preset=none", "v=1&theme=<img>", "v=1&section=l3,1&section=l1,x", "v=1&frame=", "v=1&t=1e99"],
)  # fmt: skip
def test_what_is_no_address_of_the_page_is_refused(tops, address):
    with pytest.raises(LiePoissonError):
        tops.read(address)


def test_words_and_limits_are_those_of_the_page():
    def words(file, name):
        text = (WEB / file).read_text(encoding="utf-8")
        return tuple(re.findall(r'"(\w+)"', re.search(rf"export const {name} = \[([^\]]*)\]", text)[1]))

    assert words("state/everyday.ts", "THEMES") == states.THEMES
    assert words("state/laboratory.ts", "FRAMES") == states.VIEWS_OF_TOPS
    assert words("systems/state.ts", "VIEWS") == states.VIEWS_OF_SYSTEMS

    def number(file, name):
        text = re.search(rf"const {name} = ([^;]+);", (WEB / file).read_text(encoding="utf-8"))[1]
        above, _, below = text.partition("/")
        return float(above) / float(below or 1)

    assert number("state/laboratory.ts", "HORIZON") == number("systems/state.ts", "UNITS") == states.HORIZON
    assert number("systems/state.ts", "MOST_SERIES") == states.MOST_SERIES
    assert number("state/everyday.ts", "MOST_ADDED") == states.MOST_ADDED
    fans = re.search(r"FANS = \[(\d+), .*?(\d+)\]", (WEB / "state/everyday.ts").read_text(encoding="utf-8"))
    assert tuple(map(int, fans.groups())) == states.FANS
    assert tuple(number("state/everyday.ts", name) for name in ("SLOWEST", "FASTEST")) == states.SPEEDS
    vectors = re.search(r"own % 3 === 0 && own <= (\d+)", (WEB / "systems/state.ts").read_text(encoding="utf-8"))
    assert int(vectors[1]) == states.MOST_IN_VECTORS
    assert number("notebook/protocol.ts", "LONGEST_MESSAGE") == states.LONGEST_MESSAGE
    assert lp.Top.twisted_kovalevskaya().component_names == states.COMPONENTS
