"""The widget of notebooks without a notebook: its traits, the page in it, and what cannot be viewed."""

import json
import re
import subprocess
import sys
from dataclasses import replace
from fractions import Fraction
from importlib.resources import files

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.compile.field import QuadraticField
from liepoisson.errors import LiePoissonError, MissingPackageError, ParameterError, ShapeError, UnknownNameError
from liepoisson.laboratory.drafts import Draft, joined
from liepoisson.numeric.sampling import sample_tangents

START = [1, 0.2, 0, 0, 0.6, 0.8, 0, 0, 1]
TOP = lp.Top.twisted_kovalevskaya(epsilon="1/3")
PAGE = files("liepoisson.laboratory").joinpath("page", "index.html").read_text(encoding="utf-8")


class Hostile:
    name = '</script><img src=x onerror="alert(1)">'

    def field(self):
        return QuadraticField(2, (), ((0, 1, 1.0), (1, 0, -1.0)), ())


@pytest.fixture
def widget():
    pytest.importorskip("anywidget")
    return lp.view(TOP, start=START)


def sent(widget):
    """All that goes to the notebook, by name."""
    return widget.get_state()


def test_the_page_of_the_widget_is_the_page_of_the_wheel(widget):
    page = re.search(r"^const PAGE = (.*);$", sent(widget)["_esm"], re.MULTILINE)[1]
    assert json.loads(page) == PAGE
    assert not re.search("[<>&\u2028\u2029]", page)


def test_state_start_and_time_follow_what_the_page_says(widget):
    seen = []
    widget.observe(lambda change: seen.append((change["name"], change["new"])), names=["start", "time"])
    parts = "section=l3,1&axes=l1,l2&method=taylor,1e-15&frame=space&shadow=1&theme=auto&t=2.5&speed=1"
    widget.set_state({"address": f"v=1&top=2,2,1,-1,0,0,0,0,0,1/3&start=1/2,0,0,1,0,0,0,0,1&{parts}", "playing": False})
    assert widget.start == (0.5, 0, 0, 1, 0, 0, 0, 0, 1)
    assert (widget.time, widget.playing, widget.state["surface"]) == (2.5, False, "l3")
    assert ("start", widget.start) in seen
    assert ("time", 2.5) in seen
    assert np.asarray(lp.integrate(widget.system, widget.start, times=[0, 1]).state).shape == (1, 2, 9)


def test_what_is_set_goes_to_the_page(widget):
    widget.time = 7
    assert sent(widget)["address"].endswith("&t=7")
    widget.start = ["1/2", *START[1:]]
    assert (widget.time, widget.start[0]) == (0, 0.5)
    assert "start=0.5,0.2,0," in sent(widget)["address"]
    widget.state = {"surface": "beta1", "direction": 0, "theme": "projector", "parameters": {"epsilon": "2/3"}}
    assert "section=beta1,0&theme=projector" in widget.address
    assert str(widget.system.epsilon) == "2/3"
    assert widget.state["start"] == widget.start
    before = widget.address
    widget.state = dict(widget.state)
    assert widget.address == before


def test_what_cannot_be_is_refused_and_nothing_changes(widget):
    before = (widget.address, widget.state, widget.start, widget.time)
    for name, value, error in (
        ("start", [1, 2], ShapeError),
        ("start", "here", LiePoissonError),
        ("time", -1, ParameterError),
        ("time", "soon", LiePoissonError),
        ("state", {"theme": "pink"}, UnknownNameError),
        ("state", 3, ParameterError),
        ("address", "v=1&theme=<script>", LiePoissonError),
        ("height", 5, ParameterError),
    ):
        with pytest.raises(error):
            setattr(widget, name, value)
        assert (widget.address, widget.state, widget.start, widget.time) == before, name


@pytest.mark.parametrize(
    ("said", "words"),
    [
        ({"address": "v=1&start=1,2"}, "start must have 9 components"),
        ({"address": "v=1&theme=<img>", "playing": False}, "theme"),
        ({"address": 3}, "address cannot be 3"),
        ({"address": "v=1", "playing": "yes"}, "playing cannot be 'yes'"),
        ({"address": "v=1&t=" + "1" * 20_000}, "at most 16000 characters"),
        ({"address": "v=1&t=1&t=2"}, "'t' twice"),
        ({"message": None}, "message cannot be None"),
    ],
)
def test_a_state_from_the_page_that_cannot_be_changes_nothing_and_is_answered(widget, monkeypatch, said, words):
    before = (widget.address, widget.state, widget.start, widget.playing)
    answers = []
    monkeypatch.setattr(widget, "send_state", lambda key=None: answers.append(key))
    widget.set_state(said)
    assert (widget.address, widget.state, widget.start, widget.playing) == before
    assert "Python cannot take this state" in widget.message
    assert words in widget.message
    assert len(widget.message) <= 1000
    assert ["address", "playing", "message"] in answers


def test_what_the_page_says_is_a_message_and_only_the_state_can_be_changed_by_it(widget):
    carried, script = sent(widget)["_carried"], sent(widget)["_esm"]
    widget.set_state({"message": "The orbit ends at t = 3" + "!" * 5000, "_esm": "", "_carried": "{}", "height": 9})
    assert widget.message.startswith("The orbit ends at t = 3!!")
    assert len(widget.message) == 1000
    assert (sent(widget)["_carried"], sent(widget)["_esm"], widget.height) == (carried, script, 460)
    widget.state = {"theme": "dark"}
    assert widget.message == ""


def test_the_first_state_is_part_of_the_address():
    pytest.importorskip("anywidget")
    widget = lp.view(TOP, start=START, state={"view": "rod", "time": 3}, panels="all", height=700, playing=False)
    assert widget.address.endswith("&t=3&frame=rod")
    assert (sent(widget)["_options"], widget.height, sent(widget)["playing"]) == ("", 700, False)
    assert sent(lp.view(TOP, start=START))["_options"] == "embed=1"


def test_a_hostile_name_is_data_and_never_markup():
    pytest.importorskip("anywidget")
    widget = lp.view(Hostile(), start=[1, 0])
    assert json.loads(sent(widget)["_carried"])["name"] == Hostile.name
    assert Hostile.name not in sent(widget)["_esm"]
    html = widget._repr_mimebundle_()
    assert Hostile.name not in str(html)
    with pytest.raises(UnknownNameError):
        widget.state = {"surface": Hostile.name}


def test_an_orbit_and_a_section_are_viewed_with_their_states():
    pytest.importorskip("anywidget")
    starts = [[0.5, *START[1:]], START]
    orbit = lp.integrate(TOP, starts, times=[0, 1, 2])
    section = lp.section(TOP, starts, surface="l3", t_end=20)
    for result, kind in ((orbit, "orbit"), (section, "section")):
        widget = lp.view(result, trajectory=1)
        record = json.loads(sent(widget)["_carried"])
        assert record["saved"]["kind"] == kind
        assert "of 2 orbits" in record["saved"]["words"]
        assert widget.start == tuple(START)
        assert widget.system is result.system
        with pytest.raises(ParameterError, match="those of the result"):
            lp.view(result, start=START)


def test_a_rod_is_viewed_as_a_rod_from_its_start():
    pytest.importorskip("anywidget")
    top = lp.Top.twisted_lagrange(axial="3/5", a3=1, b3=0, epsilon="1/3")
    rod = lp.orbits.rod(top, [START, [0.5, *START[1:]]], length=2)
    widget = lp.view(rod, trajectory=1, state={"theme": "light"})
    assert (widget.state["view"], widget.state["theme"], widget.start[0]) == ("rod", "light", 0.5)
    assert (widget.time, widget.state["surface"]) == (2, "l1")
    assert str(widget.system.epsilon) == "1/3"


TWISTED = {"system": "twisted-top", "parameters": {"I": [2, 2, 1], "a": [-1, 0, 0], "b": [0, 0, 0]}}


def test_an_orbit_of_a_sweep_is_viewed_at_its_point():
    pytest.importorskip("anywidget")
    axes = {"epsilon": [0, 1 / 3], "energy": [0.5, 9]}
    sweep = lp.sweep(**TWISTED, axes=axes, starts={"C3": 1}, n_starts=3, t_end=20)
    for point, (epsilon, energy) in enumerate(sweep.points):
        widget = lp.view(sweep, point=point, trajectory=2)
        system, start = widget.system, np.array(widget.start)
        assert float(system.epsilon) == epsilon
        assert lp.integrate(system, start, times=[0, 1]).invariants["H"][0, 0] == pytest.approx(energy, abs=1e-11)
        growth = lp.finite_time_exponents(
            system, start, times=[20], method=lp.Taylor(tol=1e-9, precision="mixed"),
            tangents=sample_tangents(9, 3, seed=0)[[2]],
        )  # fmt: skip
        assert growth.exponent[0, 0] == sweep.value[point, 2]


def test_what_cannot_be_viewed_is_refused():
    orbit = lp.integrate(TOP, START, times=[0, 1])
    growth = lp.finite_time_exponents(TOP, [START], t_end=5)
    rod = lp.orbits.rod(lp.Top.lagrange(axial="sqrt(2)", a3=1), START, length=2)
    parameters = {"I": ["moment", 2, 1], "a": [-1, 0, 0], "b": [0, 0, 0], "epsilon": 1}
    sweep = lp.sweep(system="twisted-top", parameters=parameters, axes={"moment": [-1, 2]}, n_starts=2, t_end=20)
    noisy = lp.stochastic.NoisySystem(lp.System(lp.so(3) @ lp.trivial(), "l3"), "l1")
    path = lp.stochastic.noisy_orbits(noisy.system, [1, 0, 0], **noisy.noise, t_end=1, method=lp.Splitting(0.5))
    noises = lp.sweep(system=noisy, axes={"energy": [0.1]}, n_starts=1, t_end=1, method=lp.Splitting(0.5))
    one_of = r"at one of its points.*from point=0 \(moment = -1\) to point=1 \(moment = 2\)"
    for shown, given, words in (
        (3, {}, "a system, a top, an orbit, a section, a rod or a sweep; got"), (lp.Top, {}, "or a sweep; got"),
        (noisy, {}, r"got 'NoisySystem'. View its `\.system` instead"), (path, {}, r"View its `\.system` instead"),
        (noises, {}, r"a path of noise has none. View a system without its noise, lp\.view\(noisy\.system\)"),
        (growth, {}, r"got 'FiniteTimeExponents'. View its `\.system` instead"),
        (rod, {}, r"parameters that are fractions or decimals.*lp\.plot\.rod"),
        (TOP, {"point": 0}, "is one of a"), (orbit, {"point": 0}, "is one of a"), (TOP, {"trajectory": 1}, "one of a"),
        (orbit, {"trajectory": 1}, "from 0 to 0"), (sweep, {}, one_of), (sweep, {"point": 2}, one_of),
        (sweep, {"point": True}, one_of), (sweep, {"point": 0}, "its outcome is 'no system'"),
        (TOP, {"panels": "three"}, "panels"), (TOP, {"height": 0.5}, "height"), (TOP, {"state": {"t": 1}}, "'t'"),
        (TOP, {"playing": "no"}, "playing: wanted True or False"), (TOP, {"surfaces": None}, "surfaces"),
    ):  # fmt: skip
        with pytest.raises(LiePoissonError, match=words):
            lp.view(shown, **given)


def test_without_anywidget_the_error_says_how_to_install_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "anywidget", None)
    monkeypatch.delitem(sys.modules, "liepoisson.laboratory.widget", raising=False)
    with pytest.raises(MissingPackageError, match=r'pip install "liepoisson\[notebook\]"') as caught:
        lp.view(TOP)
    assert isinstance(caught.value, ImportError)


def test_only_a_view_loads_the_libraries_of_notebooks():
    """An orbit shows a page only where it is asked to."""
    program = (
        "import sys, liepoisson as lp\n"
        f"orbit = lp.integrate(lp.Top.twisted_kovalevskaya(), {START}, times=[0, 1])\n"
        "lp.view, repr(orbit), getattr(orbit, '_repr_html_', str)()\n"
        "print(*[name for name in ('anywidget', 'ipywidgets', 'traitlets', 'IPython') if name in sys.modules])\n"
        "print([name for name in ('_repr_mimebundle_', '_ipython_display_') if hasattr(orbit, name)])\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.split("\n")[:2] == ["", "[]"]


def heavier(strength):
    """Hénon and Heiles's system with another strength of the cubic term."""
    hamiltonian = f"(p_x^2 + p_y^2 + x^2 + y^2)/2 + {strength}*(x^2*y - y^3/3)"
    return lp.System(bracket=lp.catalog.system("henon-heiles").bracket, hamiltonian=hamiltonian)


def test_another_system_is_shown_from_the_same_start_and_nothing_changes_where_it_cannot_be():
    pytest.importorskip("anywidget")
    widget = lp.view(heavier(1), start=[0.1, 0.2, 0.3, 0], state={"theme": "dark", "surface": "y", "time": 3})
    first, began = json.loads(sent(widget)["_carried"]), widget.address
    other = heavier("1/2")
    widget.system = other
    record = json.loads(sent(widget)["_carried"])
    assert record["field"] != first["field"]
    assert record["id"] in widget.address
    assert (widget.system, widget.start, widget.time) == (other, (0.1, 0.2, 0.3, 0), 0)
    assert (widget.state["theme"], widget.state["surface"]) == ("dark", "y")
    # what the page of the last system still says is not taken
    widget.set_state({"address": began})
    assert "cannot take this state" in widget.message
    assert widget.system is other
    before = (widget.address, sent(widget)["_carried"])
    for wrong in (3, lp.System, "<img src=x>", lp.integrate(other, widget.start, times=[0, 1])):
        with pytest.raises(ParameterError, match="system must be a system or a top"):
            widget.system = wrong
        assert (widget.address, sent(widget)["_carried"]) == before
    widget.system = TOP  # has a page of its own
    assert (sent(widget)["_carried"], str(widget.system.epsilon), widget.state["theme"]) == ("", "1/3", "dark")


def test_a_direction_without_a_surface_is_refused(widget):
    with pytest.raises(ParameterError, match="direction is that in which orbits cross a surface"):
        lp.view(TOP, state={"direction": -1})
    address = widget.address
    with pytest.raises(ParameterError, match="direction is that"):
        widget.state = {"direction": -1}
    assert widget.address == address
    widget.state = {"surface": "l3", "direction": -1}
    assert "section=l3,-1" in widget.address
    widget.state = {"direction": 1}
    assert "section=l3,1" in widget.address


def spring(k="4"):
    """A spring pendulum, whose parameters are k and l0."""
    formula = "(p_x^2 + p_y^2)/2 + k*(sqrt(x^2 + y^2) - l0)^2/2 + y"
    return lp.System(lp.canonical(names=["x", "y"]), formula, {"k": k, "l0": "3/4"}, name="spring")


def typed(**changes):
    """The address of a typed system, as the page tells it."""
    draft = replace(Draft("canonical", "(p_x^2 + x^2)/2 + k*x^4", coordinates="x", parameters={"k": "1/3"}), **changes)
    return joined({**draft.written(), "v": "1", "system": draft.checksum, "start": "0.5,0", "theme": "dark", "t": "2"})


def test_without_a_system_one_is_typed_and_what_is_typed_is_in_python():
    pytest.importorskip("anywidget")
    widget = lp.view()
    assert sent(widget)["address"].startswith("own=1&")
    assert sent(widget)["_carried"] == ""
    assert widget.system.component_names == ("x", "y", "p_x", "p_y")
    seen = []
    widget.observe(lambda change: seen.append(change["name"]), names=["start", "state"])
    widget.set_state({"address": typed(), "playing": False, "message": ""})
    assert str(widget.system.hamiltonian) == "p_x**2/2 + x**4/3 + x**2/2"
    assert (widget.start, widget.time, widget.state["parameters"]) == ((0.5, 0), 2, {"k": "1/3"})
    assert (widget.state["theme"], set(seen)) == ("dark", {"start", "state"})
    assert np.asarray(lp.integrate(widget.system, widget.start, times=[0, 1]).state).shape == (1, 2, 2)
    # a wrong formula: the page tells the address of the last right one, and says what is wrong
    right = widget.system
    widget.set_state({"address": widget.address, "message": "x5 is not known. Did you mean x?"})
    assert (widget.message, widget.system) == ("x5 is not known. Did you mean x?", right)


def test_parameters_of_a_system_that_can_be_typed_are_set_from_both_sides():
    pytest.importorskip("anywidget")
    system = spring()
    widget = lp.view(system, start=[1, 0, 0, 0.5], state={"theme": "light"})
    assert widget.system is system
    assert widget.state["parameters"] == {"k": "4", "l0": "3/4"}
    assert widget.start == (1, 0, 0, 0.5)
    widget.time = 3
    widget.state = {"parameters": {"k": 0.5}}
    assert widget.system.parameters == {"k": Fraction(1, 2), "l0": Fraction(3, 4)}
    assert (widget.time, widget.start, widget.state["theme"]) == (0, (1, 0, 0, 0.5), "light")
    assert "parameters=k:0.5;l0:3/4&" in sent(widget)["address"]
    draft = Draft.read(widget.address).with_numbers({"k": "2"})
    address = joined({**draft.written(), "v": "1", "system": draft.checksum, "start": "1,0,0,0.5"})
    widget.set_state({"address": address})
    assert (widget.state["parameters"]["k"], widget.system.parameters["k"], widget.address) == ("2", 2, address)
    # what needs another page is shown as before
    assert json.loads(sent(lp.view(system, surfaces=["x*y"]))["_carried"])["name"] == "spring"
    assert json.loads(sent(lp.view(lp.integrate(system, widget.start, times=[0, 1])))["_carried"])["saved"] is not None


def test_the_address_of_a_typed_system_opens_it():
    pytest.importorskip("anywidget")
    for widget in (
        lp.view(typed()),
        lp.view(f"https://liepoisson.test/lab.html#{typed()}"),
        lp.view(TOP),
        lp.view(heavier(1)),
    ):
        widget.address = typed()
        assert (widget.start, widget.time, widget.system.component_names) == ((0.5, 0), 2, ("x", "p_x"))
        widget.address = "own=1&example=heavy-top"
        assert (widget.start, widget.system.name) == ((1, 2, 3, 1, 1, -1), "Heavy top")
        widget.system = spring()
        assert widget.state["parameters"] == {"k": "4", "l0": "3/4"}
        widget.system = TOP
        assert (widget.address.startswith("v=1&top="), sent(widget)["_carried"]) == (True, "")


@pytest.mark.parametrize(
    ("said", "words"),
    [
        ({"address": typed(hamiltonian="__import__('os')")}, "cannot"),
        ({"address": typed(hamiltonian="<img src=x>")}, "cannot"),
        ({"address": typed(parameters={})}, "k"),
        ({"address": typed().replace("sum=", "sum=1")}, "checksum"),
        ({"address": typed(coordinates="x" * 10**6)}, "at most 16000"),
        ({"address": typed() + "&__proto__=1"}, "__proto__"),
        ({"address": "own=1&example=__proto__"}, "no example"),
        ({"address": "v=1&start=0,0"}, "one of the page that is shown"),
        ({"address": ["own=1"]}, "address cannot be"),
        ({"address": typed(), "playing": 1}, "playing cannot be 1"),
        ({"address": typed(), "message": {"text": "x"}}, "message cannot be"),
    ],
)
def test_a_typed_system_from_the_page_that_cannot_be_changes_nothing_and_is_answered(said, words):
    pytest.importorskip("anywidget")
    widget = lp.view(spring(), start=[1, 0, 0, 0.5])
    before = (widget.address, widget.state, widget.start, widget.time, widget.system, widget.playing)
    widget.set_state(said)
    assert (widget.address, widget.state, widget.start, widget.time, widget.system, widget.playing) == before
    assert "Python cannot take this state" in widget.message
    assert words in widget.message
    assert len(widget.message) <= 1000


def test_parameters_with_which_there_is_no_system_are_refused():
    pytest.importorskip("anywidget")
    widget = lp.view(lp.catalog.system("heavy-top"))
    before = (widget.address, widget.state, widget.start, widget.system)
    for wrong, error in (
        ({"I1": 0}, LiePoissonError), ({"I4": 1}, UnknownNameError), ({"I1": "sqrt(2)"}, ParameterError),
        ({"I1": [1]}, ParameterError), ({"I1": True}, ParameterError), ([1], ShapeError), ("<b>", ParameterError),
    ):  # fmt: skip
        with pytest.raises(error):
            widget.state = {"parameters": wrong}
        assert (widget.address, widget.state, widget.start, widget.system) == before, wrong
    with pytest.raises(ParameterError, match="belong to a system or a result"):
        lp.view(start=[1, 2])
    with pytest.raises(ParameterError, match="got 'str'"):
        lp.view("henon-heiles")
