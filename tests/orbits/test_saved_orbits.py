"""Orbits, tori and what was found of them in files: they come back as they were, with what they share, and go on."""

from dataclasses import is_dataclass
from functools import cache

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.io.result import Kept
from liepoisson.orbits.saved_orbits import class_of, written_by_fields

HENON = lp.catalog.system("henon-heiles")
TOP = lp.catalog.system("lagrange")


@cache
def straight():
    start = lp.orbits.periodic_orbit(HENON, [0, 0, 0, 0.2], period=6.3, energy="1/10")
    return lp.orbits.orbit_family(HENON, start, until=0.14)


def turning():
    start = lp.orbits.periodic_orbit(TOP, [1, 0, 0.5, 0, 0.6, 0.8], period=4, momenta=["l3"])
    return lp.orbits.orbit_family(TOP, start, max_orbits=3)


def symmetric():
    half = next(one for one in lp.systems.discrete_symmetries(HENON) if not one.reverses_time)
    start = lp.orbits.periodic_orbit(HENON, [0.3, 0, 0, 0.2], period=3.1, symmetry=half)
    return lp.orbits.orbit_family(HENON, start, max_orbits=3)


def in_a_parameter():
    pendulum = lp.System(lp.canonical(1), "p1^2/2 - g*cos(q1)", {"g": 1})
    start = lp.orbits.periodic_orbit(pendulum, [1, 0], period=7)
    return lp.orbits.orbit_family(pendulum, start, along="g", until=1.5)


@pytest.mark.parametrize("make", [straight, turning, symmetric, in_a_parameter])
def test_a_family_comes_back_as_it_was(tmp_path, make):
    family = make()
    again = lp.load(family.save(tmp_path / "family.nc"))
    assert repr(again) == repr(family)
    assert [repr(one) for one in again] == [repr(one) for one in family]
    assert again.to_dataframe().equals(family.to_dataframe())
    assert family.to_dataframe()[family.along].tolist() == family.value.tolist()
    pairs = zip((*family, *(p.orbit for p in family.points)), (*again, *(p.orbit for p in again.points)), strict=True)
    for one, other in pairs:
        np.testing.assert_array_equal(other.start, one.start)
        np.testing.assert_array_equal(other.multipliers, one.multipliers)
        np.testing.assert_array_equal(other.level.units, one.level.units)
        assert other.level.values == one.level.values
        assert (other.momenta, other.angles.tolist()) == (one.momenta, one.angles.tolist())
        assert (other.symmetry is None) == (one.symmetry is None)
    for point, other in zip(family.points, again.points, strict=True):
        np.testing.assert_array_equal(other.tangent, point.tangent)
        assert (other.kind, other.after, other.is_located) == (point.kind, point.after, point.is_located)


def test_a_loaded_family_goes_on_branches_and_is_drawn(tmp_path):
    family = straight()
    again = lp.load(family.save(tmp_path / "family.nc"))
    further = [lp.orbits.orbit_family(HENON, one[-1], until=0.15) for one in (family, again)]
    np.testing.assert_array_equal(further[0].period, further[1].period)
    branch = lp.orbits.orbit_family(HENON, again.points[0], max_orbits=2)
    assert branch[0].period == pytest.approx(2 * again.points[0].orbit.period, rel=1e-3)
    assert len(lp.plot.draw(again).axes) == 1
    assert again.dataset["start"].dims == ("orbit", "component")


def test_a_family_is_not_repeated(tmp_path):
    path = straight().save(tmp_path / "family.nc")
    with pytest.raises(lp.errors.ParameterError, match=r"lp\.orbits\.orbit_family looks again, or goes on"):
        lp.rerun(path)
    with pytest.raises(lp.errors.OutputError, match=r"ends in \.nc"):
        straight().save(tmp_path / "family.csv")


KEPT = {
    one.kind: one
    for name in lp.results.__all__
    if isinstance(one := getattr(lp.results, name), type) and issubclass(one, Kept)
}


@cache
def kept():
    """One of each kind of result that is saved whole."""
    well = lp.System(lp.canonical(1, names=["x"]), "p_x^2/2 - x^2/2 + x^4/4")
    saddle = lp.phase_space.equilibrium(well, [0, 0])
    round_top = lp.System(lp.so(3) @ lp.semidirect(2), "dot(l, l)/2 + alpha3")
    upright = lp.phase_space.equilibrium(round_top, [0, 0, 0, 0, 0, 1])
    symmetric_orbits = lp.orbits.symmetric_periodic_orbits(HENON, {}, energy="1/8", n_starts=20)
    homoclinic = lp.orbits.symmetric_homoclinic_orbits(symmetric_orbits[0], n_starts=10)
    orbits = lp.orbits.periodic_orbits(HENON, {}, energy="1/8", n_starts=20)
    connecting = lp.orbits.connecting_orbits(saddle)
    pendulum, state = lp.catalog.system("spherical-pendulum"), [0.3, 0.8, 0.2, 0.8, 0, 0.6]
    sphere = lp.Leaf(pendulum, {"C1": 0, "C2": 1})
    plane = lp.tori.diagram(sphere, energy_max=2, n_starts=20)
    curves = lp.tori.lagrange_diagram(lp.Leaf(lp.Top.twisted_lagrange(), {"C1": 0.5, "C2": 0.2, "C3": 1}))
    back = lp.sections.return_map(HENON, "x", t_end=100)
    found = [
        orbits, orbits[0], orbits[0].polished(), symmetric_orbits, symmetric_orbits[0], symmetric_orbits[0].polished(),
        homoclinic, homoclinic[0], homoclinic[0].polished(digits=16), connecting, connecting[0], connecting[0].unstable,
        turning(), back.cycles({}, "1/12", n_starts=20), back.exponents([[0, 0.1, 0.49, 0.05], [0, 0.1, 0.3, 0]], 8),
        lp.orbits.melnikov(round_top, [2, 0, 0, 0, 0, -1], "l1*l2", origin=upright, integrals=["l3"]),
        lp.tori.critical_states(sphere, n_starts=10), plane, lp.tori.regions(plane, n_values=100, n_states=5),
        lp.tori.fibre(sphere, [0.5, 0.2], n_states=5), lp.tori.period_lattice(pendulum, state, integrals=["l3/2"]),
        lp.tori.monodromy(pendulum, state, [[0, 0.2], [0.2, 0.2], [0.2, 0.1]]),
        lp.tori.molecule(sphere, 0), curves, lp.tori.lagrange_monodromy(curves),
        lp.dissipation.relax(round_top, [0.2, 0, 1, 0.6, 0, 0.8]),
    ]  # fmt: skip
    return {type(one).kind: one for one in found}


def same(one, other):
    """Whether two values are the same, to the last bit, with all that they are made of."""
    if isinstance(one, np.ndarray):
        return one.dtype == other.dtype and one.shape == other.shape and np.array_equal(one, other)
    if isinstance(one, (tuple, dict)):
        pairs = zip(one.items(), other.items(), strict=True) if isinstance(one, dict) else zip(one, other, strict=True)
        return type(one) is type(other) and all(same(a, b) for pair in pairs for a, b in [pair])
    if isinstance(one, lp.System):
        return one.equations == other.equations
    if isinstance(one, lp.Leaf):
        return one.casimirs == other.casimirs and one.rank == other.rank and same(one.state, other.state)
    if hasattr(one, "__dataclass_fields__"):
        names = one.__dataclass_fields__
        return type(one) is type(other) and all(same(getattr(one, n), getattr(other, n)) for n in names)
    return repr(one) == repr(other)


@pytest.mark.parametrize("kind", KEPT)
def test_it_comes_back_as_it_was(tmp_path, kind):
    found = kept()[kind]
    assert type(found) is KEPT[kind]
    path = found.save(tmp_path / "found.nc")
    again = lp.load(path)
    assert type(again) is type(found)
    assert same(found, again)
    assert repr(again) == repr(found)
    assert again._repr_html_()
    assert again.to_dataframe().equals(found.to_dataframe())
    assert again.dataset.equals(found.dataset)
    assert getattr(again, "method", None) == getattr(found, "method", None)
    assert len(found.to_dataframe()) == len(found.dataset[found.row])
    assert found.dataset.component.values.tolist() == list(found.system.component_names)
    with pytest.raises(lp.errors.ParameterError, match=f"got {kind}, whose search is not recorded"):
        lp.rerun(path)
    damaged = bytearray(path.read_bytes())
    damaged[len(damaged) // 2] ^= 1
    path.write_bytes(damaged)
    with pytest.raises(lp.errors.DamagedFileError):
        lp.load(path)


def test_a_file_makes_no_objects_but_those_of_orbits_equilibria_and_tori():
    assert not {"load", "rerun", "Sweep", "Orbit", "LaxPair", "FirstIntegral"} & written_by_fields().keys()
    assert all(is_dataclass(class_of(name)) for name in written_by_fields())


def test_what_is_shared_is_shared_again(tmp_path):
    orbit = lp.load(kept()["connecting orbit"].save(tmp_path / "orbit.nc"))
    assert orbit.unstable.base is orbit.stable.base
    assert "homoclinic" in repr(orbit)
    family = lp.load(kept()["symmetric orbits"].save(tmp_path / "orbits.nc"))
    assert family[0].level is family[1].level
    assert family[0].system is family.system


def test_a_formula_that_is_a_name_may_have_a_slash(tmp_path):
    found = kept()["melnikov integrals"]
    halved = lp.orbits.melnikov(found.system, found.start, "l1*l2", origin=found.origin, integrals=["l3/2"])
    again = lp.load(halved.save(tmp_path / "halved.nc"))
    assert same(halved, again)
    assert list(again.columns())[1] == "M_l3/2"
    assert "M_l3÷2" in again.dataset


def test_what_is_found_of_tori_shares_its_system(tmp_path):
    regions = lp.load(kept()["regions of a diagram"].save(tmp_path / "regions.nc"))
    assert regions[0].fibre.momentum is regions.diagram.momentum
    assert regions.diagram.momentum.system is regions.diagram.leaf.system


def test_no_loops_keep_their_type(tmp_path):
    whole = kept()["monodromy of a twisted Lagrange top"]
    none = lp.results.LagrangeMonodromy(whole.diagram, whole.base, (), (), whole.matrices[:0], whole.periods)
    assert same(none, lp.load(none.save(tmp_path / "none.nc")))


def test_empty_arrays_keep_their_type(tmp_path):
    """Without starts nothing is found: numbers of flows are whole ones, types are texts."""
    found = kept()["critical states"]
    none = lp.results.CriticalStates(
        found.momentum, found.leaf, *(getattr(found, name)[:0] for name in ("states", "values", "weights", "rank")),
        np.array([], dtype=np.str_),
    )  # fmt: skip
    assert same(none, lp.load(none.save(tmp_path / "none.nc")))


def test_tori_that_are_loaded_go_on(tmp_path):
    kinds = ("period lattice", "diagram", "diagram of a twisted Lagrange top")
    torus, plane, curve = (lp.load(kept()[kind].save(tmp_path / "found.nc")) for kind in kinds)
    assert same(lp.tori.period_lattice(torus.momentum, torus.state).periods, torus.periods)
    assert same(lp.tori.regions(plane, n_values=100, n_states=5), kept()["regions of a diagram"])
    both = [lp.tori.lagrange_lattice(one, [3, 0.5, 0.2]) for one in (curve, kept()[type(curve).kind])]
    np.testing.assert_array_equal(*both)


def test_what_is_loaded_goes_on(tmp_path):
    again = {kind: lp.load(one.save(tmp_path / "found.nc")) for kind, one in kept().items()}
    for kind, found in kept().items():
        if callable(getattr(found, "states", None)):
            assert same(again[kind].states(5), found.states(5))
    manifolds = again["invariant manifold"], kept()["invariant manifold"]
    np.testing.assert_array_equal(*(one.followed(2, 5.0).state for one in manifolds))
    np.testing.assert_array_equal(
        *(one.polished().start for one in (again["periodic orbit"], kept()["periodic orbit"]))
    )
    exponents = again["map exponents"]
    more = exponents.back.exponents(exponents.start, exponents.n_returns)
    np.testing.assert_array_equal(more.exponent, kept()["map exponents"].exponent)
    cycles = again["cycles"], kept()["cycles"]
    np.testing.assert_array_equal(*(one.back(one.points[0]).state for one in cycles))
    assert lp.orbits.periodic_orbit(HENON, again["symmetric orbits"][0]).period == pytest.approx(
        kept()["symmetric orbits"][0].period
    )
    np.testing.assert_array_equal(
        *(
            lp.orbits.connecting_orbits(one, n_starts=5)[0].middle
            for one in (again["symmetric orbit"], kept()["symmetric orbit"])
        )
    )


def test_a_record_of_something_else_is_refused(tmp_path):
    found = kept()["periodic orbits"]
    for old, new in (('"PeriodicOrbits"', '"SymmetricOrbits"'), ('"PeriodicOrbit"', '"System"'), ('"whole"', '"all"')):
        dataset = found.dataset
        dataset.attrs["record"] = dataset.attrs["record"].replace(old, new)
        with pytest.raises(lp.errors.DamagedFileError, match="missing or altered"):
            lp.rerun(dataset)


def test_a_system_without_a_text_is_refused(tmp_path, monkeypatch):
    orbit = kept()["periodic orbit"]
    monkeypatch.setitem(vars(orbit.system), "text", None)
    with pytest.raises(lp.errors.OutputError, match=r"no text that it could be read from again.* to_csv\(path\)"):
        orbit.save(tmp_path / "orbit.nc")
