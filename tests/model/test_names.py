"""Names that files would not keep are refused where they are given."""

import pytest

import liepoisson as lp
from liepoisson.errors import ParameterError

SO3 = {(0, 1): {2: 1}, (0, 2): {1: -1}, (1, 2): {0: 1}}
MADE = {
    "system": lambda name: lp.System(lp.so(3) @ lp.trivial(), "dot(l, l)", name=name),
    "canonical system": lambda name: lp.systems.CanonicalSystem(["x"], ["p"], "p^2 + x^4", name=name),
    "top": lambda name: lp.Top(inertia=(2, 2, 1), a=(1, 0, 0), name=name),
    "Lie algebra": lambda name: lp.LieAlgebra.from_brackets(3, SO3, name),
    "extension": lambda name: lp.Extension([[[1]]], name),
    "bracket": lambda name: lp.Bracket(lp.so(3), lp.trivial(), name=name),
    "integral": lambda name: lp.System(lp.so(3) @ lp.trivial(), "l1^2", integrals={name: "l1"}),
    "label": lambda name: lp.sweeps.Axis("epsilon", [0, 1], name),
    "sweep": lambda name: lp.sweeps.SweepSpec("kovalevskaya", [lp.sweeps.Axis("epsilon", [0, 1])], 1.0, name=name),
}
BAD = ["", "   ", "\xa0", " a", "a  b", "a\nb", "a\tb", "a\x00b", "a\u202eb", "a\ud800", 3, b"a"]


@pytest.mark.parametrize("make", MADE.values(), ids=MADE)
@pytest.mark.parametrize("name", BAD, ids=ascii)
def test_names_that_files_and_terminals_would_change_are_refused(make, name):
    with pytest.raises(ParameterError, match=r"wanted (one line of printable|a text)|must be a mapping"):
        make(name)


@pytest.mark.parametrize("kind", ["system", "canonical system", "top", "integral", "label", "sweep"])
def test_the_longest_name_is_that_of_files(kind):
    MADE[kind]("a" * 200)
    with pytest.raises(ParameterError, match="at most 200 characters; got 201"):
        MADE[kind]("a" * 201)


@pytest.mark.parametrize("kind", ["system", "canonical system", "top"])
@pytest.mark.parametrize("name", ["a" * 200, "Größe α, β = (1, 2)", "a.b/c", '"quoted"'])
def test_files_keep_the_others_exactly(kind, name, tmp_path):
    system = MADE[kind](name)
    assert lp.read_system(lp.systems.write_system(system, tmp_path / "a.toml")).name == name
    start = [0.1 * k for k in range(len(system.component_names))]
    loaded = lp.load(lp.integrate(system, start, times=[0, 1]).save(tmp_path / "a.nc"))
    assert loaded.system.name == name
    assert type(loaded.system) is type(system)


@pytest.mark.parametrize("source", ["", "  ", 3, "a\ud800"])
def test_a_source_is_a_text(source):
    with pytest.raises(ParameterError, match="source: wanted a text"):
        lp.System(lp.so(3) @ lp.trivial(), "dot(l, l)", source=source)
