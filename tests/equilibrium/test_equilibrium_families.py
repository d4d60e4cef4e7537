"""Families of equilibria: closed forms along them, bifurcations that are known, branches, ends, refusals."""

from functools import partial

import numpy as np
import pytest
from scipy.optimize import brentq

import liepoisson as lp

follow = lp.phase_space.equilibrium_family
stride = partial(follow, longest_step=1)
"""Steps five times as long as those by default: what lies between two equilibria is located all the same."""

equilibrium = lp.phase_space.equilibrium
HOOP = lp.System(lp.canonical(1), "p1^2/2 - g*cos(q1) - Omega^2*sin(q1)^2/2", {"g": 2, "Omega": 1}, name="hoop")
CUSP = lp.System(lp.canonical(1), "p1^2/2 + q1^4/4 - m*q1^2/2 - h*q1", {"m": 1, "h": 0}, name="cusp")
LAGRANGE = lp.catalog.system("lagrange")
TWISTED = lp.Top.twisted_lagrange()
EXACT = 1e-12


def located(family):
    return [(point.kind, pytest.approx(point.value, abs=EXACT)) for point in family.points]


@pytest.mark.thorough
def test_a_pendulum_on_a_hoop_that_turns():
    """The lowest point is stable up to Omega^2 = g; then it is cos q = g/Omega^2."""
    family = follow(HOOP, equilibrium(HOOP, [0, 0]), along="Omega", until=2)
    assert located(family) == [("branch", np.sqrt(2))]
    assert family.end == "the wanted value"
    assert family.value[-1] == 2
    for value, one in zip(family.value, family, strict=True):
        assert one.linear_stability == ("stable spectrum" if value < np.sqrt(2) else "unstable")
    tilted = follow(HOOP, family.points[0], along="Omega", until=3)
    np.testing.assert_allclose([np.cos(one.state[0]) for one in tilted], 2 / tilted.value**2, rtol=EXACT)
    assert {one.linear_stability for one in tilted} == {"stable spectrum"}


@pytest.mark.thorough
def test_both_folds_of_a_cubic():
    """h = q^3 - m q has its extrema at q^2 = m/3."""
    family = stride(CUSP, equilibrium(CUSP, [1, 0]), along="h", increasing=False, until=-1)
    fold = 2 / np.sqrt(27)
    assert located(family) == [("fold", -fold), ("fold", fold)]
    states = np.array([one.state[0] for one in family])
    np.testing.assert_allclose(states**3 - states, family.value, atol=EXACT)


@pytest.mark.parametrize("longest", [0.2, 0.05])
def test_a_fold_where_the_state_is_zero(longest):
    """All terms of the equations vanish there, m - 2 = q^2, so that round-off is as large as they are."""
    shifted = lp.System(lp.canonical(1), "p1^2/2 + q1^3/3 - (m - 2)*q1", {"m": 3}, name="shifted")
    start = equilibrium(shifted, [1, 0])
    family = follow(shifted, start, along="m", increasing=False, longest_step=longest, max_equilibria=40)
    assert located(family) == [("fold", 2)]
    assert family.points[0].equilibrium.linear_stability in {"undecided", "degenerate"}


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("hamiltonian", "state"),
    [
        ("p1^2/2 + (q1 - 1)^4/4 - (m - 2)*(q1 - 1)^2/2", 2),
        ("p1^2/2 - (q1 - 1)^4/4 + (m - 2)*(q1 - 1)^2/2", 2),
        ("p1^2/2 - cos(q1) - (m - 1)*sin(q1)^2/2", np.arccos(1 / 2)),
    ],
)
def test_a_pitchfork_is_a_branch_from_its_side_branch(hamiltonian, state):
    """The parameter turns on the side branch at m = 2, where the middle one crosses it: (q - q0)^2 ~ m - 2."""
    system = lp.System(lp.canonical(1), hamiltonian, {"m": 3})
    rest = equilibrium(system, [state, 0])
    family = follow(system, rest, along="m", increasing=False, max_equilibria=14)
    assert located(family) == [("branch", 2)]


@pytest.mark.thorough
def test_a_cusp_is_a_branch_where_it_is_symmetric():
    family = stride(CUSP, equilibrium(CUSP, [0, 0]), along="m", increasing=False, until=-1)
    assert located(family) == [("branch", 0)]
    branch = stride(CUSP, family.points[0], along="m", until=1)
    np.testing.assert_allclose([one.state[0] ** 2 for one in branch], branch.value, rtol=EXACT)


@pytest.mark.thorough
def test_the_sleeping_top_falls_at_its_least_spin():
    """l3^2 = 4 I1 a3 alpha3, for the top with other moments, too, and in its weight."""
    family = stride(LAGRANGE, equilibrium(LAGRANGE, [0, 0, 3, 0, 0, 1]), along="C1", increasing=False, until=-3)
    assert located(family) == [("Hamiltonian Hopf", 2), ("Hamiltonian Hopf", -2)]
    other = lp.catalog.system("lagrange", {"I": [3, 3, 2], "a": [0, 0, "1/2"]})
    upright = equilibrium(other, [0, 0, 4, 0, 0, 1])
    family = stride(other, upright, along="C1", increasing=False, until=1)
    assert located(family) == [("Hamiltonian Hopf", np.sqrt(6))]
    family = stride(other, upright, along="a3", until=2)
    assert located(family) == [("Hamiltonian Hopf", 4 / 3)]


@pytest.mark.thorough
def test_a_spinning_hanging_top_tilts():
    """w = mu alpha with mu^2 (I3 - I1) alpha3 = a3; it leaves the vertical where mu^2 = 2."""
    hanging = equilibrium(LAGRANGE, [0, 0, 0, 0, 0, -1])
    family = stride(LAGRANGE, hanging, along="C1", until=1)
    assert located(family) == [("branch", np.sqrt(1 / 2))]
    tilted = stride(LAGRANGE, family.points[0], along="C1", max_equilibria=12)
    assert len(tilted) == 12
    omega, alpha = np.split(np.array([one.state for one in tilted]) * [1, 1, 2, 1, 1, 1], 2, axis=1)
    rate = np.sum(omega * alpha, axis=1)
    np.testing.assert_allclose(omega, rate[:, None] * alpha, atol=EXACT)
    np.testing.assert_allclose(rate**2 * alpha[:, 2], -2, rtol=EXACT)
    assert {one.nullity for one in tilted} == {1}  # a circle of them


@pytest.mark.thorough
def test_the_rotation_of_kovalevskayas_top_about_its_mass_forks():
    """I = (2, 2, 1), a = (-1, 0, 0), the mass above: others leave where w^2 (I1 - I3) = |a|, l = 2 w."""
    top = lp.catalog.system("kovalevskaya")
    family = follow(top, equilibrium(top, [-0.2, 0, 0, -1, 0, 0]), along="C1", until=3)
    assert located(family) == [("branch", 2)]
    turned = follow(top, family.points[0], along="C1", max_equilibria=6)
    omega, alpha = np.split(np.array([one.state for one in turned]) / [2, 2, 1, 1, 1, 1], 2, axis=1)
    np.testing.assert_allclose(np.cross(omega, alpha), 0, atol=EXACT)
    assert np.abs(alpha[:, 2]).min() > 1e-3


def cubic_discriminant(spin, linear, constant):
    return (
        18 * spin * linear * constant - 4 * spin**3 * constant + (spin * linear) ** 2 - 4 * linear**3 - 27 * constant**2
    )


@pytest.mark.thorough
def test_the_twisted_sleeping_top_wakes_where_its_polynomial_has_double_roots():
    """mu^3 + l3 mu^2 + alpha3 mu + epsilon beta3, at alpha3 = 4, beta3 = 1: C1 = 16 + 2 epsilon l3."""
    asleep = equilibrium(TWISTED, [0, 0, -5, 0, 0, 4, 0, 0, 1])
    family = stride(TWISTED, asleep, along="C1", until=26)
    spins = [brentq(cubic_discriminant, *ends, args=(4, 1), xtol=1e-15) for ends in ((-5, -3), (3, 4), (4, 5))]
    tilt = brentq(lambda spin: (-2 * spin) ** 3 + spin * 4 * spin**2 - 8 * spin + 1, 0, 1, xtol=1e-15)
    wanted = [(16 + 2 * spin, "Hamiltonian Hopf") for spin in spins] + [(16 + 2 * tilt, "branch")]
    assert located(family) == [(kind, pytest.approx(value, abs=1e-11)) for value, kind in sorted(wanted)]
    changed = stride(TWISTED, asleep, along="epsilon", until="3/2")
    (point,) = changed.points
    spin = (6 - 16) / (2 * point.value)
    assert abs(cubic_discriminant(spin, 4, point.value)) < 1e-10
    assert point.equilibrium.state[2] == pytest.approx(spin, rel=EXACT)


@pytest.mark.thorough
def test_steady_precessions_in_their_spin():
    """With l.alpha = 1 and u = alpha3, u l3^2 - (1 + u^2) l3 + u + (1 - u^2)^2 = 0; the circle ends upside down."""
    (one,) = lp.equilibria(LAGRANGE, {"C1": 1, "C2": 1}, along=["l3"], values={"l3": 0.9}, n_starts=20)
    family = stride(LAGRANGE, one, along="l3", until=2)
    back = stride(LAGRANGE, one, along="l3", increasing=False, until=-2)
    assert back.end == "a singular level"
    assert -1 < back.value[-1] < -0.9
    for each in (family, back):
        l3, u = each.value, np.array([e.state[5] for e in each])
        np.testing.assert_allclose(u * l3**2 - (1 + u**2) * l3 + u + (1 - u**2) ** 2, 0, atol=1e-12)
        values = np.array([list(e.casimirs.values()) for e in each])
        np.testing.assert_allclose(values, 1, rtol=EXACT)
        assert {e.linear_stability for e in each} == {"stable spectrum"}


@pytest.mark.thorough
def test_precessions_in_the_weight_obey_the_quadratic_equation_of_their_rate():
    """I1 alpha3 W^2 - l3 W + a3 = 0 for the rate W, the multiplier of l.alpha."""
    one = lp.phase_space.equilibrium_near(LAGRANGE, [0.1, 0, 2, 0.3, 0, 0.9], along=("l3",))
    family = stride(LAGRANGE, one, along="a3", until=2)
    assert family.value[-1] == 2
    rate, tilt = (
        np.array(list(values)) for values in ((e.multipliers["C1"] for e in family), (e.state[5] for e in family))
    )
    np.testing.assert_allclose(tilt * rate**2 - 2 * rate + family.value, 0, atol=1e-12)


def test_a_family_ends_where_its_leaf_is_singular():
    body = lp.System(lp.so(3) @ lp.trivial(), "l1^2/2 + l2^2/4 + l3^2/6")
    family = follow(body, equilibrium(body, [0, 1, 0]), along="C1", increasing=False, until=-1)
    assert family.end == "a singular level"
    assert 0 < family.value[-1] < 0.1
    assert not family.points


def test_real_pairs_that_meet_are_a_collision():
    """mu^4 - (1 + c - 2 b^2) mu^2 + (1 + b^2)(c + b^2) = 0 on a saddle that turns at the rate b."""
    plane = lp.canonical(2)
    saddle = lp.System(plane, "(p1^2 + p2^2)/2 + b*(q1*p2 - q2*p1) - q1^2/2 - c*q2^2/2", {"b": 0, "c": 2})
    family = follow(saddle, equilibrium(saddle, [0, 0, 0, 0]), along="b", until=0.3)
    kinds = [point.kind for point in family.points]
    assert kinds == ["collision"]
    b = family.points[0].value
    assert (3 - 2 * b**2) ** 2 == pytest.approx(4 * (1 + b**2) * (2 + b**2), rel=EXACT)


def test_a_table_has_a_row_for_each_equilibrium():
    family = follow(HOOP, equilibrium(HOOP, [0, 0]), along="Omega", max_equilibria=3)
    frame = family.to_dataframe()
    assert list(frame.columns[:4]) == ["Omega", "energy", "q1", "p1"]
    assert len(frame) == len(family) == 3
    assert family.end == "3 equilibria"
    assert repr(family).startswith("3 equilibria of a family of 'hoop', Omega 1 to ")


@pytest.mark.thorough
def test_a_family_goes_on_from_its_last_member():
    first = follow(HOOP, equilibrium(HOOP, [0, 0]), along="Omega", max_equilibria=3)
    again = follow(HOOP, first[-1], along="Omega", until=1.5)
    assert again.value[0] == first.value[-1]
    assert located(again) == [("branch", np.sqrt(2))]


REST = {"system": HOOP, "start": equilibrium(HOOP, [0, 0]), "along": "Omega"}
REFUSED = (
    ({"start": [0, 0]}, "wanted an equilibrium or a point of a family"),
    ({"along": "C1"}, 'along: wanted "g" or "Omega"'),
    ({"system": CUSP, "along": "g"}, "of another system"),
    ({"max_equilibria": 1}, "max_equilibria"),
    ({"longest_step": 0}, "longest_step"),
    ({"until": "x"}, "until"),
    ({"system": CUSP, "start": equilibrium(lp.System(lp.canonical(1), "p1^2/2 + q1^4"), [0, 0])}, "no Casimir"),
    (
        {"system": LAGRANGE, "start": equilibrium(LAGRANGE, [0, 0, 3, 0, 0, 1], along=("l3",)), "along": "l3"},
        "wanted independent gradients of C1, C2, l3",
    ),
    ({"system": LAGRANGE, "start": equilibrium(LAGRANGE, [0, 0, 3, 0, 0, 0]), "along": "C1"}, "regular leaf"),
)


@pytest.mark.parametrize(("given", "words"), REFUSED)
def test_what_is_refused(given, words):
    with pytest.raises(lp.errors.ParameterError, match=words):
        follow(**(REST | given))


@pytest.mark.thorough
def test_no_family_begins_at_a_branch_point_or_leaves_a_fold():
    bare = lp.System(lp.canonical(1), "p1^2/2 + q1^4/4 - m*q1^2/2 - h*q1", {"m": 0, "h": 0})
    with pytest.raises(lp.errors.ParameterError, match="isolated"):
        follow(bare, equilibrium(bare, [0, 0]), along="m")
    family = follow(CUSP, equilibrium(CUSP, [1, 0]), along="h", increasing=False, max_equilibria=14)
    with pytest.raises(lp.errors.ParameterError, match="got a fold"):
        follow(CUSP, family.points[0], along="h")


def test_the_wanted_value_says_the_direction():
    top = lp.catalog.system("lagrange")
    family = lp.phase_space.equilibrium_family(
        top, lp.phase_space.equilibrium(top, [0, 0, 3, 0, 0, 1]), along="C1", until=2.5
    )
    assert (family.end, family.value[-1]) == ("the wanted value", 2.5)
    assert np.all(np.diff(family.value) < 0)
