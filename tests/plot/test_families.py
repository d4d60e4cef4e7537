"""The figure of a family: axes that say what they show."""

import pytest

import liepoisson as lp
from liepoisson.errors import ParameterError

PENDULUM = lp.System(lp.canonical(1), "p1^2/2 - cos(q1)", name="pendulum")
OTHER = lp.System(lp.canonical(1), "p1^2/2 - 2*cos(q1)", name="other pendulum")


def family(system, until):
    return lp.orbits.orbit_family(system, lp.phase_space.equilibrium(system, [0, 0]), until=until)


def test_a_second_family_keeps_no_false_title_and_no_other_axis():
    ax = lp.plot.draw(family(PENDULUM, 0)).axes[0]
    assert ax.get_title(loc="left") == "pendulum"
    lp.plot.family(family(PENDULUM, 0.5), ax=ax)
    assert ax.get_title(loc="left") == "pendulum"
    lp.plot.family(family(OTHER, 0), ax=ax)
    assert ax.get_title(loc="left") == ""
    ax.set_xlabel("$C_{1}$")
    with pytest.raises(ParameterError, match="along what these axes show"):
        lp.plot.family(family(PENDULUM, 0), ax=ax)


def test_a_family_in_a_parameter_has_a_figure():
    heavy = lp.System(lp.canonical(1), "p1^2/2 - g*cos(q1)", {"g": 1}, name="heavy")
    start = lp.orbits.periodic_orbit(heavy, [1, 0], period=7)
    ax = lp.plot.family(lp.orbits.orbit_family(heavy, start, along="g", until=1.2))
    assert ax.get_xlabel() == "$g$"
    assert ax.get_title(loc="left").startswith("heavy")


def test_each_orbit_has_a_dot():
    """Lines only join them: the corners are where something was computed."""
    found = family(PENDULUM, 0.5)
    (line,) = lp.plot.family(found).lines
    assert (line.get_marker(), line.get_linestyle()) == (".", "-")
    assert line.get_xydata().tolist() == [[x, T] for x, T in zip(found.value, found.period, strict=True)]
