"""`lp.phase_space.find_start`: a start that is given, moved onto a leaf and an energy, or random."""

import pytest

import liepoisson as lp

HEAVY = lp.catalog.system("kovalevskaya")  # six components: C1 = l.alpha, C2 = |alpha|^2
find_start = lp.phase_space.find_start


def test_a_state_is_given_by_place_or_by_name_with_exact_numbers():
    by_place = find_start(HEAVY, start=["1/3", 0, "sqrt(2)", 0, 0, 1])
    by_name = find_start(HEAVY, start={"l1": "1/3", "l3": 2**0.5, "alpha": (0, 0, 1)})
    assert by_place.state.tolist() == by_name.state.tolist() == [1 / 3, 0, 2**0.5, 0, 0, 1]
    assert by_place.energy == pytest.approx(1 / 36 + 1)
    assert by_place.leaf.casimirs == pytest.approx({"C1": 2**0.5, "C2": 1})


@pytest.mark.parametrize("name", ["C1", "alpha.l", "l1*alpha1 + alpha2*l2 + l3*alpha3"])
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


def test_without_arguments_it_is_member_0():
    assert find_start(HEAVY, seed=4).state.tolist() == lp.sample_states(HEAVY, 1, seed=4)[0].tolist()


def test_components_with_names_of_their_own_are_named():
    body = lp.System(lp.Bracket(lp.algebras.se(3), lp.extensions.trivial()), "dot(l, l)/2 + lt1")
    assert find_start(body, start={"lr1": 1, "lt3": "1/2"}).state.tolist() == [1, 0, 0, 0, 0, 0.5]
