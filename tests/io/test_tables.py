"""Results as tables: the rows of each kind, no product of unrelated dimensions, files that give the same numbers."""

import csv
from functools import cache

import numpy as np
import pytest
from test_dataset import ALL as RUNS
from test_dataset import STATES, TOP
from test_dataset import result_of as result_of_run

import liepoisson as lp
from liepoisson.errors import OutputError
from liepoisson.io.result import Result

HENON = lp.catalog.system("henon-heiles")
SPHERE = lp.Leaf(lp.catalog.system("spherical-pendulum"), {"C1": 0, "C2": 1})


def lists_of_all_kinds():
    duffing = lp.System(lp.canonical(1, names=["x"]), "p_x^2/2 - x^2/2 + x^4/4")
    family = lp.System(lp.so(3) @ lp.semidirect(2), "l1^2 + l2^2 + J*l3^2 + alpha1", symbols=["J"])
    return {
        "sweep": lambda: lp.sweep(
            system="twisted-top",
            parameters={"I": [2, 2, 1], "a": [-1, 0, 0], "b": [0, 0, 0]},
            axes={"epsilon": [0, 0.5, 1]},
            n_starts=4,
            t_end=20,
        ),
        "integral scan": lambda: lp.integrability.scan_integrals(family, axes={"J": ["1/2", 2]}, degree=4),
        "equilibria": lambda: lp.equilibria(HENON, {}),
        "periodic orbits": lambda: lp.orbits.symmetric_periodic_orbits(HENON, {}, energy="1/10", n_starts=10),
        "diagram": lambda: lp.tori.diagram(SPHERE, n_starts=20),
        "diagram of the twisted Lagrange top": lambda: lp.tori.lagrange_diagram(
            lp.Leaf(lp.Top.twisted_lagrange(), {"C1": 0.5, "C2": 0.2, "C3": 1})
        ),
        "molecule": lambda: lp.tori.molecule(SPHERE, 0, n_starts=20),
        "critical states": lambda: lp.tori.critical_states(SPHERE, n_starts=10),
        "regions of a diagram": lambda: lp.tori.regions(
            lp.tori.diagram(SPHERE, energy_max=2, n_starts=20),
            n_values=100,
            n_states=5,
        ),
        "rotation numbers": lambda: lp.tori.rotation_number(
            lp.section(HENON, [[0, 0.1, 0.35, 0], [0, 0.2, 0.3, 0]], surface="x", direction=1, t_end=100), ["y", "p_y"]
        ),
        "connecting orbits": lambda: lp.orbits.connecting_orbits(lp.phase_space.equilibrium(duffing, [0, 0])),
        "a family of orbits": lambda: lp.orbits.orbit_family(
            duffing, lp.phase_space.equilibrium(duffing, [1, 0]), max_orbits=4
        ),
        "homoclinic orbits": lambda: lp.orbits.symmetric_homoclinic_orbits(
            lp.phase_space.equilibrium(duffing, [0, 0]), n_starts=20
        ),
    }


LISTS = lists_of_all_kinds()


@cache
def result_of(kind):
    return result_of_run(kind) if kind in RUNS else LISTS[kind]()


def rows_of(result):
    """How many rows a table has, from what the result says of itself."""
    if not isinstance(result, Result):
        return len(result)
    kind = result.kind
    times = {"orbit": "time", "noisy orbits": "time", "attitude": "time", "rod": "arclength"}
    if kind in times:
        orbits = len(result.outcome) if "orbit" in kind else len(STATES)
        return orbits * len(getattr(result, times[kind]))
    if kind in {"chart orbit", "section"}:
        return len(result.time)
    if kind == "sweep":
        return len(result.points)
    if kind == "orbit fit":
        return len(result.unknowns)
    return result.outcome.size


@pytest.mark.parametrize("kind", [*RUNS, *LISTS])
def test_every_result_is_a_table_and_a_file(tmp_path, kind):
    result = result_of(kind)
    frame = result.to_dataframe()
    assert len(frame) == rows_of(result)
    if isinstance(result, lp.results.Result) and hasattr(result, "t_end"):
        assert {"time", "t_end"} & {*frame.columns}, "how long the runs were"
    assert len(frame.columns) > 1
    assert frame.columns.is_unique
    assert set(map(np.ndim, result.columns().values())) == {1}
    with result.to_csv(tmp_path / "table.csv").open(newline="") as file:
        names, *lines = csv.reader(file)
    assert names == list(frame.columns)
    assert len(lines) == len(frame)
    for k, name in enumerate(names):
        given = frame[name].to_numpy()
        read = np.array([line[k] for line in lines])
        if given.dtype.kind == "f":
            np.testing.assert_array_equal(read.astype(float), given, err_msg=name)
        elif given.dtype.kind in "iu":
            np.testing.assert_array_equal(read.astype(np.int64), given, err_msg=name)
        else:
            assert read.tolist() == [str(value) for value in given]


def test_rows_hold_what_belongs_together():
    orbit = lp.integrate(TOP, STATES, times=[0, 0.5, 1])
    table = orbit.columns()
    k, i = 2, 1
    (row,) = np.flatnonzero((table["trajectory"] == k) & (table["time"] == 0.5))
    assert [table[name][row] for name in TOP.component_names] == orbit.state[k, i].tolist()
    crossings = lp.section(TOP, STATES, surface="l3", t_end=10)
    table = crossings.columns()
    np.testing.assert_array_equal(table["trajectory"], crossings.trajectory)
    np.testing.assert_array_equal(table["beta2"], crossings.state[:, 7])
    assert list(table)[:4] == ["trajectory", "time", "sign", "l1"]


def test_curves_give_their_last_values():
    growth = lp.finite_time_exponents(TOP, STATES, t_end=12, first=4)
    table = growth.columns()
    assert table["trajectory"].tolist() == [4, 5, 6]
    np.testing.assert_array_equal(table["exponent"], growth.exponent[:, -1])
    np.testing.assert_array_equal(table["start_l3"], STATES[:, 2])
    assert set(table["time"]) == {12.0}
    spectrum = lp.lyapunov_spectrum(TOP, STATES, t_end=12, n_exponents=2)
    table = spectrum.columns()
    np.testing.assert_array_equal(table["exponent_2"], spectrum.exponent[:, -1, 1])
    found = lp.chaos.decide(TOP, STATES, t_end=20).columns()
    assert [name for name in found if name.startswith("votes")] == [
        "votes_growth_power",
        "votes_megno",
        "votes_sali",
        "votes_averages",
    ]


def test_a_coordinate_that_is_called_like_a_column_has_its_own():
    system = lp.System(lp.canonical(names=["time"]), "p_time^2/2 + time^2/2")
    table = lp.integrate(system, [[0.5, 0]], times=[0, 1]).columns()
    assert table["time"].tolist() == [0, 1]
    assert table["state_time"][0] == 0.5


@pytest.mark.parametrize("path", ["table.txt", "table", None, 5])
def test_other_endings_are_refused(path):
    with pytest.raises(OutputError, match=r"write for example run\.csv"):
        lp.integrate(TOP, STATES, times=[0, 1]).to_csv(path)


def test_no_kind_of_result_is_left_out():
    def kinds(of):
        return {kind for one in of.__subclasses__() for kind in ({one, *kinds(one)})}

    made = {type(result_of(kind)).__name__ for kind in (*RUNS, *LISTS)}
    defined = {kind.__name__ for kind in kinds(Result) if hasattr(kind, "kind") and kind.__module__.startswith("liep")}
    assert defined <= made


def test_the_table_of_exponents_says_below_what_one_counts_as_zero():
    found = lp.lyapunov_exponent(TOP, STATES, t_end=200)
    table = found.columns()
    np.testing.assert_allclose(table["zero_below"], 3 * np.log(found.time / found.time_scale) / found.time)
    np.testing.assert_array_equal(table["is_zero"], table["exponent"] <= table["zero_below"])
