r"""Relaxation ends at the minima that the theory and the algebra name, at the rate of the linearised flow."""

import matplotlib.pyplot as plt
import numpy as np
import pytest
import sympy

import liepoisson as lp

EULER = lp.catalog.euler_top_on("so(3)", [1, 2, 3])
HEAVY = lp.catalog.system("heavy-top")
LAGRANGE = lp.catalog.system("lagrange")
START = {"l": (0.2, 0, 1), "alpha": (0.6, 0, 0.8)}
relax = lp.dissipation.relax


def test_the_body_relaxes_to_the_axis_of_the_largest_moment_at_the_rate_of_the_linearised_flow():
    """The decay is c L^2 (1/I1 + 1/I2 - 2/I3)/2; energies fall at twice that."""
    found = relax(lp.dissipation.double_bracket(EULER, "1/10"), [1, 1, 1])
    one = found.equilibrium
    assert found.outcome == "arrived"
    assert one.nonlinear_stability == "stable"
    assert np.abs(np.abs(one.state) - [0, 0, np.sqrt(3)]).max() <= 1e-15 + one.distance
    assert found.decay == pytest.approx(0.1 * 3 * (1 + 1 / 2 - 2 / 3) / 2, rel=1e-12)
    assert (np.diff(found.energy) <= 1e-15).all()
    late = (found.energy - one.energy > 1e-12) & (found.time > 20)
    slope = np.polyfit(found.time[late], np.log(found.energy[late] - one.energy), 1)[0]
    assert slope == pytest.approx(-2 * found.decay, rel=0.02)


def test_the_spectrum_is_that_of_the_derivative_of_the_damped_equations():
    damped = lp.dissipation.double_bracket(HEAVY, "1/3", metric=[1, 2, 3, 4, 5, 6])
    found = relax(damped, START)
    x = found.equilibrium.state
    jacobian = np.array(damped.jacobian.subs(dict(zip(damped.variables, x, strict=True))), float)
    basis = found.leaf.tangent_basis(x)
    wanted = np.linalg.eigvals(basis.T @ jacobian @ basis)
    assert np.abs(np.sort_complex(found.spectrum) - np.sort_complex(wanted)).max() < 1e-12


@pytest.mark.parametrize("casimirs", [{"C1": 0, "C2": 1}, None])
def test_the_heavy_top_relaxes_on_its_leaf_to_the_lowest_equilibrium(casimirs):
    """The lowest of those that the algebra lists; without momentum about the vertical it hangs."""
    start = lp.Leaf(HEAVY, casimirs).project([0.3, 1, 0.2, 0.5, 0.1, 0.9]) if casimirs else START
    found = relax(HEAVY, start)
    lowest = min(lp.equilibria(HEAVY, found.leaf), key=lambda one: one.energy)
    assert found.outcome == "arrived"
    assert np.abs(found.equilibrium.state - lowest.state).max() < 1e-10
    for name, casimir in found.leaf.casimir_functions.items():
        assert np.ptp(casimir(found.state)) < 1e-14, name
    assert found.time[-1] < 200
    if casimirs:
        assert found.equilibrium.energy == pytest.approx(-1, abs=1e-14)


def test_with_an_integral_it_relaxes_to_a_steady_rotation():
    """A minimum of H - W l3 is a relative equilibrium that turns with W about the axis of the body."""
    found = relax(LAGRANGE, START, along={"l3": "1/2"})
    one = lp.phase_space.equilibrium(LAGRANGE, found.equilibrium.state, along=("l3",))
    assert found.outcome == "arrived"
    assert one.omega["l3"] == pytest.approx(0.5, rel=1e-9)
    damped = lp.dissipation.double_bracket(LAGRANGE, "c", metric=[1, 1, 1, 2, 2, 2], parameters={"c": "1/2"})
    other = relax(damped, START, along={"l3": "1/2"})
    assert other.equilibrium.energy == pytest.approx(one.energy - one.state[2] / 2, abs=1e-12)


def test_outcomes_say_where_it_did_not_arrive():
    at_saddle = relax(EULER, [0, 1, 0], t_end=100)
    assert (at_saddle.outcome, at_saddle.equilibrium.linear_stability) == ("saddle", "unstable")
    assert at_saddle.decay < 0
    fluid = relax(lp.catalog.system("zeitlin-3"), np.arange(8) / 7, t_end=300)  # a family without known symmetry
    assert (fluid.outcome, fluid.equilibrium.family) == ("undecided", "undecided")
    unbounded = relax(lp.System(lp.canonical(1), "dot(p, p)/2 - q1^4/4"), [1, 0])
    assert (unbounded.outcome, unbounded.equilibrium) == ("step too small", None)
    assert relax(EULER, [1, 1, 1], t_end=1).outcome == "not arrived"
    flat = relax(lp.System(lp.canonical(1), "dot(p, p)/2 + q1^4/4"), [1, 0], t_end=100)
    assert flat.outcome == "not arrived"
    assert "not arrived" in repr(flat)
    away = relax(EULER, [0, 1, 1e-9])  # from beside the saddle, it does not stay there
    assert away.outcome == "arrived"


@pytest.mark.parametrize("energy", ["p1^2/2 - q1^4/4", "p1^2/2 + q1^3", "q1^2*p1^2 - q1^5"])
def test_where_second_derivatives_vanish_no_minimum_is_claimed(energy):
    """At the origin, which is none: the second variation is semidefinite."""
    found = relax(lp.System(lp.canonical(1), energy), [0, 0], t_end=40)
    assert (found.outcome, found.equilibrium.signature[1]) == ("undecided", 0)


def test_a_minimum_may_lie_in_the_circle_that_an_integral_makes():
    body = lp.System(lp.so(3) @ lp.trivial(), "l1^2 + l2^2 + 2*l3^2", integrals={"K": "l3"})
    found = relax(body, [1, 1, 1])
    assert (found.outcome, found.equilibrium.signature) == ("arrived", (1, 0, 1))


def test_along_the_motions_of_known_integrals_the_second_variation_may_vanish():
    """The circle |q| = 1 of minima, with and without the angular momentum."""
    well = "dot(p, p)/2 + (dot(q, q) - 1)^2"
    known = relax(lp.System(lp.canonical(2), well, integrals={"M": "q1*p2 - q2*p1"}), [0.3, 0.4, 0.1, -0.2])
    assert (known.outcome, known.equilibrium.signature) == ("arrived", (3, 0, 1))
    assert relax(lp.System(lp.canonical(2), well), [0.3, 0.4, 0.1, -0.2], t_end=200).outcome == "undecided"


@pytest.mark.thorough
def test_an_orbit_that_fails_has_no_equilibrium_of_an_earlier_time():
    """From beside the saddle of p^2/2 - q^2/2 - q^4 it stays for a while, and then runs to infinity."""
    found = relax(lp.System(lp.canonical(1), "p1^2/2 - q1^2/2 - q1^4"), [1e-16, 0])
    assert (found.outcome, found.equilibrium, found.gap) == ("step too small", None, np.inf)
    assert found.energy[-1] < -1e4  # at its last good state
    far = relax(lp.System(lp.canonical(1), "p1^2/2 + exp(-q1^2)"), [1e-12, 0], t_end=60)
    assert far.outcome == "not arrived"
    assert "at energy" not in repr(far)


def test_the_time_limit_may_pass_within_newtons_method(monkeypatch):
    def late(*_):
        raise lp.errors.TimeLimitError("late")

    monkeypatch.setattr("liepoisson.equilibrium.relaxation.equilibrium_near", late)
    assert relax(EULER, [1, 1, 1], t_end=1).equilibrium is None


@pytest.mark.thorough
def test_from_high_above_a_minimum_it_has_the_time_of_the_minimum():
    """In the well (q^2 - 1)^2 the natural time at |q| = 100 is a thousandth of that at the bottom."""
    found = relax(lp.System(lp.canonical(1), "p1^2/2 + (q1^2 - 1)^2"), [100, 0])
    assert found.outcome == "arrived"
    assert np.abs(np.abs(found.equilibrium.state) - [1, 0]).max() < 1e-12


@pytest.mark.thorough
@pytest.mark.parametrize(("momentum", "field"), [(1e8, 1), (1, 1e8), (1e6, 1e-6)])
def test_fields_in_units_of_their_own_relax_alike(momentum, field):
    """(l, alpha) -> (c l, d alpha) with H(l/c, alpha/d) c: the motion is the same."""
    units = np.repeat([momentum, field], 3)
    scaled = HEAVY.hamiltonian.subs(
        {x: x / sympy.Rational(u) for x, u in zip(HEAVY.variables, units, strict=True)}, simultaneous=True
    )
    system = lp.System(HEAVY.bracket, scaled * sympy.Rational(momentum))
    start = np.array([0.3, 1, 0.2, 0.5, 0.1, 0.9])
    found = relax(system, start * units)
    assert found.outcome == "arrived"
    assert np.abs(found.equilibrium.state / units - relax(HEAVY, start).equilibrium.state).max() < 1e-12


def test_in_other_units_it_arrives_alike():
    c = 1e6
    one, other = relax(EULER, [1, 1, 1]), relax(EULER, [c, c, c])
    assert other.outcome == "arrived"
    assert np.abs(np.abs(other.equilibrium.state) / c - np.abs(one.equilibrium.state)).max() < 1e-12


WAYS = {
    "own damping": (lp.dissipation.double_bracket(HEAVY, "g", parameters={"g": "1/3"}), START, {}),
    "along an integral": (LAGRANGE, START, {"along": {"l3": "1/2"}}),
    "no equilibrium": (lp.System(lp.canonical(1), "dot(p, p)/2 - q1^4/4"), [1, 0], {}),
    "not arrived": (EULER, [1, 1, 1], {"t_end": 1}),
}


@pytest.mark.thorough
@pytest.mark.parametrize(("system", "start", "options"), WAYS.values(), ids=[*WAYS])
def test_a_file_gives_the_relaxation_back(system, start, options, tmp_path):
    found = relax(system, start, **options)
    again = lp.load(found.save(tmp_path / "way.nc"))
    assert repr(again) == repr(found)
    assert again.to_dataframe().equals(found.to_dataframe())
    assert repr(again.equilibrium) == repr(found.equilibrium)
    if found.equilibrium is not None:
        np.testing.assert_array_equal(again.equilibrium.state, found.equilibrium.state)
        np.testing.assert_array_equal(again.spectrum, found.spectrum)


@pytest.mark.thorough
def test_the_figure_shows_the_energy_above_the_equilibrium():
    found = relax(lp.dissipation.double_bracket(EULER, "1/10"), [1, 1, 1])
    (axes,) = lp.plot.draw(found).axes
    time, above = axes.lines[0].get_data()
    assert (axes.get_yscale(), axes.get_ylabel()) == ("log", "energy above the equilibrium")
    np.testing.assert_array_equal(above, found.energy[np.isin(found.time, time)] - found.equilibrium.energy)
    (axes,) = lp.plot.draw(relax(lp.System(lp.canonical(1), "p1^2/2 - q1^4/4"), [1, 0])).axes
    assert (axes.get_yscale(), axes.get_ylabel()) == ("linear", "energy")
    plt.close("all")


WRONG = {
    "metriplectic": (lambda: relax(lp.dissipation.metriplectic(EULER, "C1"), [1, 1, 1]), "metriplectic"),
    "no damping": (lambda: relax(lp.dissipation.double_bracket(EULER, 0), [1, 1, 1]), "rate 0"),
    "no metric": (lambda: relax(lp.dissipation.double_bracket(EULER, 1, metric=[0, 0, 0]), [1, 1, 1]), "is 0"),
    "no system": (lambda: relax(lp.VectorField({"x": "-x"}), [1]), "wanted a system"),
    "many states": (lambda: relax(EULER, np.eye(3)), "wanted one state"),
    "no integral": (lambda: relax(HEAVY, START, along={"l1": 1}), "not constant"),
    "a Casimir": (lambda: relax(HEAVY, START, along={"C1": 1}), "C1 is a Casimir"),
    "the energy": (lambda: relax(HEAVY, START, along={"H": "1/2"}), "H is the motion itself"),
    "no mapping": (lambda: relax(HEAVY, START, along="l3"), "by name"),
    "tolerance": (lambda: relax(EULER, [1, 1, 1], tol=0), "tol"),
    "time": (lambda: relax(EULER, [1, 1, 1], t_end=-1), "t_end"),
}


@pytest.mark.parametrize(("call", "words"), WRONG.values(), ids=[*WRONG])
def test_what_cannot_relax_is_refused(call, words):
    with pytest.raises((lp.errors.ParameterError, lp.errors.ShapeError)) as caught:
        call()
    assert words in str(caught.value)
