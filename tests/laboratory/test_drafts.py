"""Systems that are typed: their addresses, the system files that they stand for, and which systems can be typed."""

import re
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import liepoisson as lp
from liepoisson.errors import LiePoissonError, ParameterError, UnknownNameError
from liepoisson.laboratory import drafts
from liepoisson.laboratory.drafts import Draft, example, joined, number_text
from liepoisson.laboratory.states import Addresses

DRAFT_TS = Path(__file__).resolve().parents[2] / "web" / "src" / "systems" / "typing" / "draft.ts"
PENDULUM = Draft(
    "canonical",
    "p_u^2/2 - g*cos(u)",
    'é ↦ 𝔤\\"',
    "u",
    angles="u",
    parameters={"g": "9/10"},
    start=("0.3", "0"),
    unit=1e-6,
)
"""With characters beyond 16 bits, and a unit that Python and JavaScript write in different ways."""
TOP = example("heavy-top")

texts = st.text(st.characters(codec="utf-8"), max_size=20)


def address(draft):
    return joined(draft.written())


@settings(max_examples=20)
@given(texts, texts, st.integers(-60, 60), st.sampled_from([1e-6, 0.5, 2.0, 1e6]))
def test_a_draft_is_read_from_its_address_as_it_was(name, hamiltonian, n, unit):
    draft = replace(
        PENDULUM, name=name, hamiltonian=hamiltonian, parameters={"g": str(n), "I": ("1/3", "-2")}, unit=unit
    )
    draft = replace(draft, ranges={"g": ("-60", "60.5", "1e-2")})
    assert Draft.read(address(draft)) == draft


def test_the_checksum_is_that_of_the_page():
    # computed by checksum() of draft.ts in node
    assert PENDULUM.checksum == "882773a3"
    with pytest.raises(ParameterError, match="checksum"):
        Draft.read(address(PENDULUM).replace("cos", "sin"))


def test_a_draft_is_the_system_of_its_file():
    system = PENDULUM.system
    assert system.component_names == ("u", "p_u")
    assert str(system.hamiltonian) == "p_u**2/2 - 9*cos(u)/10"
    assert list(system.periods) == ["u"]
    tensor = Draft("tensor", "x + y", coordinates="x, y", entries="(x,y) = c*x*y", parameters={"c": "2"})
    assert str(next(iter(tensor.system.equations.values()))) == "2*x*y"
    counted = Draft("canonical", "dot(p, p)/2 + q1^2", coordinates="3")
    assert (counted.vector_length, counted.system.component_names[3]) == (3, "p1")


def test_parameters_that_no_formula_names_are_kept_in_the_draft_and_not_in_the_file():
    draft = replace(TOP, parameters={**TOP.parameters, "k": "1", "J": ("1", "2")})
    assert set(draft.system.values) == {"I", "a"}
    assert "J2" in draft.numbers


def test_single_numbers_are_set_and_the_rest_stays():
    other = TOP.with_numbers({"I1": "5/2", "a3": "0"})
    assert other.parameters == {"I": ("5/2", "3/2", "1"), "a": ("3/5", "0", "0")}
    assert other.system.parameters["I1"] == Fraction(5, 2)
    assert TOP.with_numbers(TOP.numbers) is TOP


@pytest.mark.parametrize("key", ["toda", "heavy-top", "leibniz-top-4", "sklyanin", "spring-pendulum"])
def test_systems_of_the_package_are_typed_as_the_same_system(key):
    system = lp.catalog.system(key)
    start = example(key).start
    draft = Draft.of_system(system, start, 2.0)
    assert draft.system is system
    assert replace(draft, parameters={"k": "1"}).with_numbers({"k": "2"}).given is None
    read = Draft.read(address(draft)).system
    assert read is not system
    state = [float(Fraction(text)) for text in start]
    assert (read.vector_field([state]) == system.vector_field([state])).all()
    assert Addresses.of_draft(draft).read(address(draft))["start"] == tuple(state)


def test_what_cannot_be_typed_has_no_draft():
    energy = "(p_x^2 + x^2)/2"
    bracket = lp.canonical(names=["x"])
    for system in (
        lp.System(bracket, f"{energy} + k*x", {"k": "sqrt(2)"}),  # no rational number
        lp.System(bracket, f"{energy} + k*x", symbols=["k"]),  # without a value
        lp.System(bracket, f"{energy} + k*x*cos(t)", {"k": 1}),  # depends on time
        lp.catalog.system("kirchhoff"),  # its fields are called m and p
        lp.catalog.system("zeitlin-3"),
        lp.VectorField({"x": "k*x"}, {"k": 1}),
        object(),
    ):
        assert Draft.of_system(system, ["1"] * 2, 1.0) is None
    assert Draft.of_system(lp.System(bracket, f"{energy} + k*x", {"k": "1/3"}), ["1"] * 2, 1.0) is not None


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("own=2&bracket=so3", "own=1"),
        ("own=1&bracket=so3&sum=0", "checksum"),
        ("own=1&bracket=so5&sum=0", "so5"),
        ("own=1&bracket=__proto__&sum=0", "__proto__"),
        ("own=1&bracket=so3&hamiltonian=" + "x" * 5_000, "at most 4000"),
        ("own=1&bracket=so3&hamiltonian=" + "x" * 1_000_000, "at most 16000"),
        ("own=1&bracket=so3&parameters=__proto__:1&sum=0", "names"),
        ("own=1&bracket=so3&parameters=k:1;k:2&sum=0", "each once"),
        ("own=1&bracket=so3&parameters=k:sqrt(2)&sum=0", "must be a number"),
        ("own=1&bracket=so3&parameters=k:1/0&sum=0", "must be a number"),
        ("own=1&bracket=so3&parameters=k:" + "1," * 30 + "&sum=0", "entries"),
        ("own=1&bracket=so3&ranges=k:1,0,1&sum=0", "slider"),
        ("own=1&bracket=so3&unit=1e9&sum=0", "unit"),
        ("own=1&bracket=so3&unit=nan&sum=0", "unit"),
        ("own=1&bracket=so3&from=here&sum=0", "from"),
        ("own=1&own=1", "twice"),
        ("own=1&example=<img>", "no example"),
    ],
)
def test_what_is_no_address_of_a_typed_system_is_refused(text, words):
    with pytest.raises((ParameterError, UnknownNameError), match=re.escape(words)):
        Draft.read(text)


@pytest.mark.parametrize(
    "draft",
    [
        Draft("so3", "__import__('os').system('false')"),
        Draft("so3", "l1.__class__"),
        Draft("so3", ""),
        Draft("so3", "(" * 1_000 + "l1" + ")" * 1_000),
        Draft("so3", "k*l1"),
        Draft("canonical", "x", coordinates="x, x"),
        Draft("canonical", "x", coordinates="<script>"),
        Draft("canonical", "p_x", coordinates="x", angles="y"),
        Draft("tensor", "x", coordinates="x, y", entries="x, y"),
        Draft("tensor", "x", coordinates="x, y, z", entries="{x, y} = z\n{y, z} = x*y\n{x, z} = y"),
    ],
    ids=lambda draft: (draft.hamiltonian or "nothing")[:20],
)
def test_what_describes_no_system_is_refused_by_the_reader_of_files(draft):
    with pytest.raises(LiePoissonError):
        Addresses.of_draft(Draft.read(address(draft)))


@pytest.mark.parametrize("text", ["2", "-0.25", "1e-3", ".5", "5.", "+1/3", "−2"])
def test_numbers_are_those_of_the_page(text):
    found = number_text(f" {text} ")
    assert Fraction(found) == Fraction(text.replace("−", "-"))


@pytest.mark.parametrize("text", ["", "1/0", "1e7", "0x1", "1_0", "١", "1/9007199254740993", "nan", "1" * 65, "1 2"])
def test_other_texts_are_no_numbers(text):
    assert number_text(text) is None


def test_words_and_limits_are_those_of_the_page():
    text = DRAFT_TS.read_text(encoding="utf-8")
    most = re.search(r"const MOST = {([^}]+)}", text)[1].replace("_", "")
    assert {name: int(n) for name, n in re.findall(r"(\w+): (\d+)", most)} == drafts._MOST
    for name in ("_MOST_PARAMETERS", "_MOST_ENTRIES", "_MOST_NUMBERS", "LONGEST"):
        found = re.search(rf"const {name.removeprefix('_')} = ([\d_]+);", text)[1]
        assert int(found.replace("_", "")) == getattr(drafts, name), name
