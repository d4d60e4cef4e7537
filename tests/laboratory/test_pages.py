"""Pages: what they carry is read back as it was, is never markup, and is refused where it asks for too much."""

import json
import re

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.compile.field import QuadraticField, field_of
from liepoisson.errors import LiePoissonError, OutputError, ParameterError
from liepoisson.laboratory import page_of, page_of_tops, write_page
from liepoisson.laboratory.description import N_POINTS, picture_of
from liepoisson.laboratory.pages import MOST_BYTES, MOST_COMPONENTS, MOST_TERMS, as_data
from liepoisson.poincare.section_arguments import read_tape

KIRCHHOFF = lp.catalog.system("kirchhoff")
START = [1, 0.2, 0, 0, 0.6, 0.8]


def carried(page):
    found = re.search(r'<script type="application/json" id="system">(.*?)</script>', page.html, re.DOTALL)
    return json.loads(found[1])


class Field:
    def __init__(self, name, n, linear=()):
        self.name, self.n, self.linear = name, n, linear

    def field(self):
        return QuadraticField(self.n, (), self.linear, ())


def test_the_description_is_read_back_as_it_was():
    record = carried(page_of(KIRCHHOFF, start=START))
    assert field_of(record["field"]) == KIRCHHOFF.field()
    assert [float(text) for text in record["start"]] == START
    assert record["components"] == list(KIRCHHOFF.component_names)
    assert record["invariants"]["names"] == ["H", "C1", "C2", "m3"]
    assert (record["vector_length"], record["picture"], record["saved"]) == (3, None, None)


def test_the_page_begins_with_the_surface_of_the_section_command():
    record = carried(page_of(KIRCHHOFF, start=START))
    leaf = lp.phase_space.find_start(KIRCHHOFF, start=START).leaf
    tape = KIRCHHOFF.function_tape(lp.sections.default_surface(leaf))
    *components, surface = record["surfaces"]
    assert read_tape(surface["functions"]) == tape
    assert (surface["name"], record["surface"]) == ("rate of p3", 6)
    assert [one["name"] for one in components] == record["components"]
    assert not set(record["axes"]) & {record["surface"]}


CYLINDER = lp.canonical(names=["x"], angles=["x"])


def driven(formula, **more):
    return lp.System(CYLINDER, f"p_x^2/2 - cos(x) + {formula}", name="driven", **more)


def test_a_surface_on_a_circle_is_the_one_of_a_section():
    pendulum = lp.System(lp.canonical(names=["a", "b"], angles=["a", "b"]), "p_a^2/2 + p_b^2/2 - cos(a - 2*b)")
    record = carried(page_of(pendulum, start={"p_a": 1}, surfaces=["a - 2*b - 1/2", "p_a"]))
    names = ["a", "b", "p_a", "p_b", "a - 2*b - 1/2"]
    assert [one["name"] for one in record["surfaces"]] == names
    for one in record["surfaces"]:
        section = lp.section(pendulum, {"p_a": 1}, surface=one["name"], t_end=0.1, threads=1)
        assert read_tape(one["functions"]) == section.tape
    assert [one["modulus"] for one in record["surfaces"]] == ["2π", "2π", None, None, "2π"]
    assert record["turns"] == [[-np.pi, np.pi], [-np.pi, np.pi], None, None]
    assert (record["clock"], record["surface"], record["start"]) == (None, 4, ["0", "0", "1", "0"])


def test_a_driven_system_begins_with_its_stroboscopic_map():
    record = carried(page_of(driven("cos(x)*cos(w*t)", parameters={"w": 3}, period="2*pi/w"), start={"p_x": 1.9}))
    assert (record["components"], record["clock"], record["surface"]) == (["x", "p_x", "t", "p_t"], 2, 2)
    assert record["turns"][2:] == [[0, pytest.approx(2 * np.pi / 3, rel=1e-15)], None]
    assert (record["surfaces"][2]["modulus"], record["axes"]) == ("2π/3", [0, 1])
    assert record["invariants"]["names"] == ["H + p_t"]


def test_time_without_a_period_is_no_circle_and_not_the_surface():
    record = carried(page_of(driven("cos(x)*(cos(t) + cos(sqrt(2)*t))/20"), start={"p_x": 0.9}))
    assert (record["clock"], record["turns"][2], record["surfaces"][2]["modulus"]) == (2, None, None)
    assert record["surfaces"][record["surface"]]["name"] == "rate of p_x"
    assert record["axes"] == [0, 1]


def test_a_plane_is_seen_whole_in_the_section():
    pendulum = lp.System(CYLINDER, "p_x^2/2 - cos(x)")
    assert carried(page_of(pendulum, start=[0, 3], surfaces="x"))["axes"] == [0, 1]


def test_a_system_on_a_tensor_has_a_page():
    tensor = lp.PoissonTensor(["x", "y"], {("x", "y"): "1 + x^2"})
    assert carried(page_of(lp.System(tensor, "x^2 + y^2"), start=[1, 0]))["picture"] is None


def test_a_formula_that_is_none_on_the_circle_is_refused():
    with pytest.raises(ParameterError, match=r"function on the circle of x.*sin\(x\)"):
        page_of(lp.System(CYLINDER, "p_x^2/2 - cos(x)"), start=[0, 3], surfaces="x^2 - 1")


def test_the_unit_of_time_is_twice_that_of_the_orbit():
    for power in (0, 2, 4):
        oscillator = lp.System(lp.canonical(1), f"(q1^2 + p1^2)/(2*10^{power})")
        assert carried(page_of(oscillator, start=[1, 0]))["unit"] == 2 * 10**power


def test_surfaces_that_are_given_come_first_and_components_have_their_own_numbers():
    record = carried(page_of(KIRCHHOFF, start=START, surfaces=["m1", "dot(m, m) - 1/2", "p2"]))
    assert (record["surface"], [one["name"] for one in record["surfaces"][6:]]) == (0, ["dot(m, m) - 1/2"])
    with pytest.raises(ParameterError, match="reads no formulas"):
        page_of(Field("plane", 2), start=[1, 0], surfaces=["x1 - x2"])


@pytest.mark.parametrize("text", ["</script>", "<!--", "<script", "]]>", "&lt;", "\u2028\u2029", 'a"b\\c', "\x00\x1f"])
def test_no_text_is_markup(text):
    written = as_data({"name": text})
    assert not re.search("[<>&\u2028\u2029]", written)
    assert json.loads(written) == {"name": text}


def test_a_hostile_name_stays_in_its_element():
    page = page_of(Field('</script><img src=x onerror="alert(1)">', 2, ((0, 1, 1.0),)), start=[1, 0])
    assert carried(page)["name"] == '</script><img src=x onerror="alert(1)">'
    assert page.html.count("<script") == page_of_tops().html.count("<script") + 1


def test_tops_have_the_page_of_tops_and_their_exact_parameters():
    top = lp.Top(inertia=(2, "5/3", 1), a=(-1, 0, "0.25"), b=(0, 0, 0), epsilon="1/3", name="mine")
    page = page_of(top, start=[1, 0, 0, 0, 1, 0, 0, 0.5, 1])
    assert page.address == "v=1&top=2,5/3,1,-1,0,1/4,0,0,0,1/3&start=1,0,0,0,1,0,0,0.5,1"
    assert f'<script type="text/plain" id="address">{page.address}</script>' in page.html


@pytest.mark.parametrize("epsilon", ["sqrt(2)", "1/90071992547409921", "1e7"])
def test_a_top_that_no_address_can_hold_has_the_page_of_systems(epsilon):
    page = page_of(lp.Top.twisted_kovalevskaya(epsilon=epsilon), start=[1, 0, 0, 0, 1, 0, 0, 0, 1])
    assert page.address == ""
    assert carried(page)["components"][0] == "l1"


@pytest.mark.parametrize("n", [3, 5])
def test_the_picture_of_a_truncation_is_its_vorticity(n):
    state = np.random.default_rng(n).normal(size=n * n - 1)
    picture = picture_of(lp.catalog.zeitlin(n))
    across, up = np.array(picture["across"]), np.array(picture["up"])
    found = sum(c * state[int(k)] * np.outer(up[int(j)], across[int(i)]) for k, i, j, c in picture["terms"])
    wanted = lp.catalog.vorticity(state, N_POINTS)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-9 * np.abs(wanted).max())


def test_what_asks_for_too_much_is_refused():
    with pytest.raises(ParameterError, match=f"at most {MOST_COMPONENTS} components; 'wide' has 500"):
        page_of(Field("wide", 500), start=np.zeros(500))
    linear = tuple((i, j, 1.0) for i in range(360) for j in range(300))
    with pytest.raises(ParameterError, match=f"at most {MOST_TERMS} terms"):
        page_of(Field("dense", 360, linear), start=np.zeros(360))


def test_what_the_page_cannot_have_is_refused():
    for given, words in (
        ({"start": [1, 2]}, "start"), ({"start": [1e7, 0, 0, 0, 0, 0]}, "start"), ({"start": [np.nan] * 6}, "start"),
        ({"surfaces": [["m1"]]}, "formulas"), ({"surfaces": {"m1"}}, "formulas"), ({"surfaces": b"m1"}, "formulas"),
        ({"surfaces": "dot(m, p)"}, "constant on each leaf"), ({"surfaces": ("m1", "H")}, "constant of motion"),
        ({"trajectory": 1}, "trajectory must be left out where there is no result"),
    ):  # fmt: skip
        with pytest.raises(LiePoissonError, match=words):
            page_of(KIRCHHOFF, **given)


def test_a_saved_orbit_goes_with_its_numbers():
    orbit = lp.integrate(KIRCHHOFF, START, times=np.linspace(0, 5, 11), threads=1)
    saved = carried(page_of(KIRCHHOFF, result=orbit))["saved"]
    assert (saved["times"], saved["states"], saved["starts"]) == (
        orbit.time.tolist(), orbit.state[0].tolist(), [START],
    )  # fmt: skip
    assert (saved["kind"], saved["shown_only"], saved["tol"]) == ("orbit", None, orbit.method.tol)


def test_a_saved_section_goes_with_its_surface():
    section = lp.section(KIRCHHOFF, [START, START], surface="m1", t_end=30, direction=-1, threads=1)
    record = carried(page_of(KIRCHHOFF, result=section))
    saved = record["saved"]
    assert saved["times"] == section.time.tolist()
    assert saved["trajectory"] == section.crossing_trajectory.tolist()
    assert (saved["t_end"], saved["direction"], saved["has_states"]) == (30.0, -1, True)
    assert (record["direction"], record["start"]) == (-1, ["1", "0.2", "0", "0", "0.6", "0.8"])


def test_a_long_orbit_is_thinned_and_said_to_be():
    orbit = lp.integrate(KIRCHHOFF, START, times=np.linspace(0, 50, 5001), threads=1)
    saved = carried(page_of(KIRCHHOFF, result=orbit))["saved"]
    assert len(saved["times"]) == 1251
    assert "5001 times" in saved["words"]
    assert "of which 1251 are here" in saved["words"]
    assert saved["shown_only"] is None
    other = lp.integrate(KIRCHHOFF, START, times=[0, 1, 2], method=lp.methods.RungeKutta(), threads=1)
    assert "Taylor" in carried(page_of(KIRCHHOFF, result=other))["saved"]["shown_only"]


def test_a_result_of_another_system_or_kind_is_refused():
    orbit = lp.integrate(lp.catalog.system("clebsch"), START, times=[0, 1], threads=1)
    with pytest.raises(ParameterError, match="another vector field, that of 'clebsch'"):
        page_of(KIRCHHOFF, result=orbit)
    growth = lp.finite_time_exponents(KIRCHHOFF, [START], t_end=2, threads=1)
    with pytest.raises(ParameterError, match="orbit or a section"):
        page_of(KIRCHHOFF, result=growth)


def test_a_page_is_one_small_file_with_the_policy_of_the_built_one(tmp_path):
    file = write_page(page_of(lp.catalog.system("zeitlin-5"), start=np.full(24, 0.1)), tmp_path / "a.html")
    text = file.read_text(encoding="utf-8")
    assert file.stat().st_size < MOST_BYTES
    policy = re.compile(r'http-equiv="Content-Security-Policy" content="([^"]*)"')
    assert policy.findall(text) == policy.findall(page_of_tops().html)
    assert [path.name for path in tmp_path.iterdir()] == ["a.html"]


def test_a_page_that_is_too_large_or_has_no_place_is_refused(tmp_path):
    page = page_of_tops()
    with pytest.raises(ParameterError, match=r"at most 1\.8 MB"):
        write_page(type(page)(page.html + " " * MOST_BYTES, "", "tops"), tmp_path / "a.html")
    with pytest.raises(OutputError, match="folder"):
        write_page(page, tmp_path)
    assert not list(tmp_path.iterdir())
