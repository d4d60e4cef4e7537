"""Systems that are typed into the page, in Chromium: they have Python's numbers; what is wrong is said in place."""

import importlib.util
import json
import os
import shutil
import subprocess
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import liepoisson as lp

WEB = Path(__file__).resolve().parents[2] / "web"
PAGE = WEB.parent / "python" / "liepoisson" / "laboratory" / "page" / "index.html"
CHROMIUM = os.environ.get("CHROMIUM", "/usr/bin/chromium")
EPSILON = float(np.finfo(float).eps)
UNITS = 8
"""Of the last place, to which a step may round a state: WebAssembly has no fused multiply-add."""
KNOWN = 1e-7
"""Beyond such an error a state is no longer compared."""

PENDULUM = (
    "(p_u^2 + 2*p_v^2 - 2*p_u*p_v*cos(u - v))/(2*(1 + sin(u - v)^2)) - g*(2*cos(u) + cos(v))"  # unit masses and lengths
)
TOP = "l1^2/(2*I1) + l2^2/(2*I2) + l3^2/(2*I3)"
OWN = "\n".join(
    f"{{{a}, {b}}} = (1 + c*x^2)*{rest}" for a, b, rest in (("x", "y", "z"), ("y", "z", "x"), ("z", "x", "y"))
)
"""A factor times the bracket of so(3): a Poisson tensor in three dimensions, whatever the factor."""
SYSTEMS = [
    {
        "name": "Hénon–Heiles",
        "bracket": "canonical",
        "fields": {"coordinates": "x, y"},
        "hamiltonian": "(p_x^2 + p_y^2 + x^2 + y^2)/2 + x^2*y - y^3/3",
        "start": ["0", "0.1", "0.3", "0"],
        "until": 100,
    },
    {
        "name": "double pendulum",
        "bracket": "canonical",
        "fields": {"coordinates": "u, v", "angles": "u, v"},
        "hamiltonian": PENDULUM,
        "parameters": {"g": "9/10"},
        "start": ["0.3", "0.5", "0", "0"],
        "until": 100,
    },
    {
        "name": "free rigid body",
        "bracket": "so3",
        "hamiltonian": TOP.replace("I1", "A").replace("I2", "B").replace("I3", "C"),
        "parameters": {"A": "1", "B": "2", "C": "5/2"},
        "start": ["0.5", "0.3", "2"],
        "until": 150,
    },
    {
        "name": "heavy top",
        "bracket": "e3",
        "hamiltonian": "dot(l, inv(I)*l)/2 + dot(a, alpha)",
        "parameters": {"I₁": "2", "I₂": "3/2", "I₃": "1", "a₁": "0.6", "a₂": "0", "a₃": "0.8"},
        "start": ["1", "2", "3", "1", "1", "-1"],
        "until": 60,
    },
    {
        "name": "twisted top",
        "bracket": "leibniz3",
        "hamiltonian": "dot(l, inv(I)*l)/2 - a*alpha1",
        "parameters": {"ε": "1/3", "I₁": "2", "I₂": "2", "I₃": "1", "a": "1"},
        "start": ["0.3", "0.2", "0.5", "1", "0", "0", "0", "1", "0"],
        "until": 300,
    },
    {
        "name": "own bracket",
        "bracket": "tensor",
        "fields": {"coordinates": "x, y, z", "entries of the bracket, one a line": OWN},
        "hamiltonian": "x^2/2 + y^2/4 + z^2/5",
        "parameters": {"c": "1/2"},
        "start": ["0.4", "0.3", "1"],
        "until": 500,
    },
]  # fmt: skip
MISTAKES = {
    "dot(l, inv(I)*l)/2 + dot(a, alpah)": ("Did you mean alpha?", 28),
    "dot(l, inv(I)*l)/2 + alpha4": ("alpha has 3 components", 21),
    "dot(l, l)/2 + ": ("", 14),
    "dot(l, l)/2 + sen(alpha1)": ("sin", 14),
    "dot(l, l)/2 + abs(alpha1)": ("", 14),
    "dot(l, l)/(l1 - 1)": ("not a finite number at the start", None),
    "1 + 2": ("none of the coordinates", None),
    "": ("Type a Hamiltonian", None),
    "dot(l, l) + t": ("t is the time", 12),
    "(" * 300 + "l1" + ")" * 300: ("", None),
    "(l1 + l2 + l3 + 1)^200*(alpha1 + alpha2 + alpha3 + l1 + 2)^200": ("", None),
}
"""What the message says, and the letter that it points at."""
HOSTILE = '"><img src=x onerror="window.ran=1"><script>window.ran=1</script>'
SENTENCES = {
    "other version": ("#own=7&bracket=canonical", "version 7"),
    "damaged": ("#own=1&bracket=canonical&coordinates=x&hamiltonian=p_x^2&unit=1&sum=00000000", "checksum is wrong"),
    "too long": ("#own=1&hamiltonian=" + "x" * 20_000, "too long"),
    "long text": ("#own=1&bracket=tensor&hamiltonian=" + "x" * 5_000, "at most 4000"),
    "markup": (f"#own=1&bracket={HOSTILE.replace('&', '')}&sum=1", "at most 20"),
    "prototype": ("#own=1&bracket=canonical&parameters=__proto__.x:1&sum=1", "something else than a name"),
    "unit": ("#own=1&bracket=canonical&unit=1e99&sum=1", "unit of time"),
    "no numbers": ("#own=1&bracket=so3&parameters=" + ";".join(f"k{k}:1" for k in range(99)) + "&sum=1", "at most 40"),
}


def test_brackets_and_examples_are_those_of_the_package():
    spec = importlib.util.spec_from_file_location("build_systems", WEB / "build_systems.py")
    build = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(build)
    assert build.FILE.read_text(encoding="utf-8") == build.text(), "run `python web/build_systems.py`"


@pytest.fixture(scope="module")
def page(request, tmp_path_factory):
    here = [item for item in request.session.items if item.path == request.path]
    is_whole = any(item.get_closest_marker("slow") for item in here)
    node = shutil.which("node")
    if node is None or not Path(CHROMIUM).exists() or not (WEB / "node_modules" / "playwright-core").is_dir():
        pytest.skip("to type into the page, install node, Chromium and, in web/, the packages (npm ci)")
    wanted = tmp_path_factory.mktemp("typed") / "wanted.json"
    asked = {
        "systems": SYSTEMS if is_whole else SYSTEMS[:1],
        "mistakes": list(MISTAKES),
        "links": {name: link for name, (link, _) in SENTENCES.items()} if is_whole else {},
        "tries": is_whole,
    }
    wanted.write_text(json.dumps(asked), encoding="utf-8")
    command = [node, str(WEB / "test" / "typed.mjs"), str(PAGE), str(wanted)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=400, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.fixture(scope="module")
def systems(page, tmp_path_factory):
    """The systems as the package reads the files that the page has written."""
    folder = tmp_path_factory.mktemp("files")
    found = {}
    for name, typed in page["found"].items():
        file = folder / f"{len(found)}.toml"
        file.write_text(typed["file"], encoding="utf-8")
        found[name] = lp.read_system(file)
    return found


slow = pytest.mark.slow
each = pytest.mark.parametrize(
    "case", [pytest.param(case, id=case["name"], marks=[slow] if k else []) for k, case in enumerate(SYSTEMS)]
)


def start_of(case):
    return np.array([float(Fraction(text)) for text in case["start"]])


def errors(system, start, times):
    """How far two computations of the orbit may be apart at each time, by round-off."""
    n = len(start)
    orbit = lp.integrate(system, start, times=times, tangents=np.eye(n)[None], threads=1)
    flow = orbit.tangent[0].swapaxes(-1, -2)
    back = np.linalg.pinv(flow)
    size = np.abs(orbit.state[0]).max()
    stretched = [max(np.linalg.norm(flow[k] @ back[j], 2) for j in range(k + 1)) for k in range(len(times))]
    steps = np.maximum(orbit.n_steps[0] * times / times[-1], 1)
    return UNITS * EPSILON * steps * size * np.array(stretched)


@each
def test_a_typed_system_has_the_invariants_of_python(page, systems, case):
    typed, system, start = page["found"][case["name"]], systems[case["name"]], start_of(case)
    assert typed["start"] == start.tolist()
    values = {name: value[0] for name, value in system.invariant_values(start[None]).items()}
    known = dict(zip(typed["names"], typed["first"], strict=True))
    assert known["H"] == pytest.approx(values["H"], rel=UNITS * EPSILON, abs=UNITS * EPSILON)
    casimirs = [value for name, value in values.items() if name.startswith("C")]
    if case["bracket"] != "tensor":  # of which the page does not search any
        shown = [value for name, value in known.items() if name != "H"]
        assert shown == pytest.approx(casimirs, rel=UNITS * EPSILON, abs=UNITS * EPSILON)
    assert typed["drift"] < 1e-10


@each
def test_a_typed_system_has_the_crossings_of_python(page, systems, case):
    typed, system, start = page["found"][case["name"]], systems[case["name"]], start_of(case)
    surface = system.component_names[0]
    section = lp.section(system, start, surface=surface, direction=1, t_end=case["until"], threads=1)
    error = errors(system, start, np.concatenate([[0.0], section.time]))[1:]
    n = int(np.searchsorted(error, KNOWN))
    assert n >= 5
    crossings = typed["crossings"]
    for k in range(n):
        rates = system.vector_field(section.state[k])
        bound = error[k] * (1 + (1 + np.abs(rates).max()) / abs(rates[0]))
        assert abs(crossings["times"][k] - section.time[k]) <= bound, f"time of crossing {k}"
        assert np.abs(np.array(crossings["states"][k]) - section.state[k]).max() <= bound, f"crossing {k}"


@each
def test_a_link_opens_the_same_system(page, case):
    typed = page["found"][case["name"]]
    again = typed["again"]
    for part in ("names", "first", "start", "file"):
        assert again[part] == typed[part], part
    n = min(len(again["crossings"]["times"]), len(typed["crossings"]["times"]))
    assert again["crossings"]["times"][:n] == typed["crossings"]["times"][:n]


@slow
def test_the_lines_of_python_compute_the_orbit(page, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    typed = page["found"]["twisted top"]
    variables = {}
    exec(compile(typed["lines"], "<copied>", "exec"), variables)
    assert variables["orbit"].invariants["H"][0, 0] == pytest.approx(typed["first"][0], rel=1e-14)
    assert "crossings; the first" in capsys.readouterr().out


@slow
def test_equations_and_tensor_are_derived_by_the_core(page):
    equations, tensor, casimirs = page["found"]["free rigid body"]["shown"]
    assert "ℓ.1=" in equations
    assert tensor.startswith("{ℓ1,ℓ2}=−ℓ3")
    assert casimirs == "C1=ℓ12+ℓ22+ℓ32"


@pytest.mark.parametrize("text", MISTAKES, ids=lambda text: text[:30])
def test_a_mistake_is_said_below_its_letter_and_the_last_picture_stays(page, text):
    words, place = MISTAKES[text]
    said = page["mistakes"][text[:40]]
    assert words in said["text"]
    assert said["kept"]
    assert said["first"]
    if place is not None:
        line, mark = said["mark"].split("\n")
        assert line[mark.index("^") : mark.index("^") + 1] == text[place : place + 1]


def test_a_wrong_formula_is_kept_in_the_address(page):
    text = next(iter(MISTAKES))
    assert page["mistakes"]["again"]["text"] == text
    assert "Did you mean" in page["mistakes"]["again"]["said"]


@slow
@pytest.mark.parametrize("name", SENTENCES)
def test_a_hostile_link_gets_a_sentence_and_does_nothing(page, name):
    found = page["links"][name]
    assert SENTENCES[name][1] in found["message"]
    assert (found["markup"], found["ran"], found["shown"]) == (0, None, "Hénon–Heiles")


@slow
def test_a_name_becomes_a_slider_and_a_picture_follows(page):
    tried = page["tried"]
    assert tried["parameters"] == ["k"]
    assert len(tried["waits"]) > 3  # a time is no fact of a machine that others use, too
    assert tried["k"] != "1"
    x, y = 0.1, -0.25
    assert tried["after"] - tried["before"] == pytest.approx((float(tried["k"]) - 1) * x**4 * y**2 / 1000, rel=1e-3)
    assert tried["clicked"][0] == x


@slow
def test_the_page_can_be_read_and_asks_for_nothing(page):
    assert page["wrong"] == []
    for name, look in page["looks"].items():
        assert look == {"axe": [], "small": [], "wide": 0}, name
