"""`lp.phase_space.find_start`: a start that is given, moved onto a leaf and an energy, or random."""

import pytest

import liepoisson as lp
from liepoisson.errors import LeafError, ParameterError, ShapeError

TOP = lp.Top.heavy((2, 2, 1), (-1, 0, 0))
HEAVY = lp.catalog.system("kovalevskaya")  # six components: C1 = l.alpha, C2 = |alpha|^2
find_start = lp.phase_space.find_start


def test_a_state_is_given_by_place_or_by_name_with_exact_numbers():
    by_place = find_start(HEAVY, start=["1/3", 0, "sqrt(2)", 0, 0, 1])
    by_name = find_start(HEAVY, start={"l1": "1/3", "l3": 2**0.5, "alpha": (0, 0, 1)})
    assert by_place.state.tolist() == by_name.state.tolist() == [1 / 3, 0, 2**0.5, 0, 0, 1]
    assert by_place.energy == pytest.approx(1 / 36 + 1)
    assert by_place.leaf.casimirs == pytest.approx({"C1": 2**0.5, "C2": 1})
    assert repr(by_place).startswith("<Start, as given: H = 1.02778 on <Leaf of dimension 4 of 'kovalevskaya'")


@pytest.mark.parametrize("name", ["C1", "l.alpha", "alpha.l", "dot(l, alpha)", "l1*alpha1 + alpha2*l2 + l3*alpha3"])
def test_a_casimir_is_named_or_written_as_a_formula(name):
    found = find_start(HEAVY, leaf={name: "1/5"}, energy="3/2", seed=2)
    assert found.leaf.casimirs["C1"] == 0.2
    assert found.energy == pytest.approx(1.5)
    assert found.state[:3] @ found.state[3:] == pytest.approx(0.2)
    assert lp.Leaf(HEAVY, {name: "1/5", "|alpha|^2": 1}).casimirs == {"C1": 0.2, "C2": 1}


def test_a_leaf_may_be_given_as_such():
    leaf = lp.Leaf(HEAVY, {"C1": 0.3, "C2": 1})
    found = find_start(HEAVY, leaf=leaf, energy=1)
    assert found.leaf is leaf
    assert leaf.contains(found.state)
    assert find_start(HEAVY, start=found.state, leaf=leaf).origin == "as given"
    with pytest.raises(LeafError, match=r"a relative residual of .*Write guess instead of start"):
        find_start(HEAVY, start={"alpha3": 2}, leaf=leaf)


def test_without_arguments_it_is_member_0():
    assert find_start(HEAVY, seed=4).state.tolist() == lp.sample_states(HEAVY, 1, seed=4)[0].tolist()


@pytest.mark.parametrize(
    ("given", "error", "message"),
    [
        (
            {"leaf": {"C7": 1}},
            ParameterError,
            r'leaf must .*Known: C1 = l\.alpha, C2 = \|alpha\|\^2\. Write \{"C1": \.\.\., "C2": \.\.\.\}',
        ),
        ({"leaf": {"l1": 1}}, ParameterError, "leaf must name Casimirs of kovalevskaya; got 'l1'"),
        ({"leaf": {"C1": 1, "l.alpha": 1}}, ParameterError, "C1 comes twice"),
        ({"leaf": 3}, ParameterError, "leaf must be a Leaf or values"),
        ({"start": {"alhpa": (0, 0, 1)}}, ParameterError, r"Did you mean alpha\? Known: l, alpha, l1, l2"),
        ({"start": {"alpha": (0, 0, 1), "alpha1": 1}}, ParameterError, "each component once; alpha1 comes twice"),
        ({"start": {"alpha": (0, 1)}}, ShapeError, "start alpha must have 3 numbers; got 2"),
        ({"start": (0, 1)}, ShapeError, r'must have 6 numbers .*got 2.*start=\{"l1": 1\}'),
        ({"start": [float("nan")] * 6}, ParameterError, "finite"),
        ({"start": [0] * 6, "guess": [0] * 6}, ParameterError, "start and guess exclude each other"),
        ({"guess": [0, 0, 1, 0, 0, 1]}, ParameterError, "guess must come with leaf or energy"),
        ({"start": {"alpha3": 1}, "energy": 2}, LeafError, "it has H = 0 instead of 2. Write guess"),
        ({"energy": "x"}, ParameterError, "energy"),
    ],
)
def test_refusals_say_what_to_write(given, error, message):
    with pytest.raises(error, match=message):
        find_start(HEAVY, **given)


def test_components_with_names_of_their_own_are_named():
    body = lp.System(lp.Bracket(lp.algebras.se(3), lp.extensions.trivial()), "dot(l, l)/2 + lt1")
    assert find_start(body, start={"lr1": 1, "lt3": "1/2"}).state.tolist() == [1, 0, 0, 0, 0, 0.5]
    with pytest.raises(ParameterError, match="Known: l, lr1, lr2, lr3, lt1, lt2, lt3"):
        find_start(body, start={"l1": 1})
