import numpy as np
import pytest

import liepoisson as lp

TOP = lp.Top.kovalevskaya()
STATE = [1, 0, 0.5, 0, 0, 1, 0, 0, 1 / 3]
NAMED = {"l": (1, 0, 0.5), "alpha3": 1, "beta3": "1/3"}

RUNS = {
    "integrate": lambda x: lp.integrate(TOP, x, t_end=1).state,
    "section": lambda x: lp.section(TOP, x, surface="l2", t_end=20).state,
    "finite_time_exponents": lambda x: lp.finite_time_exponents(TOP, x, t_end=10).exponent,
    "lyapunov_spectrum": lambda x: lp.lyapunov_spectrum(TOP, x, t_end=20).exponent,
    "alignment": lambda x: lp.chaos.alignment(TOP, x, t_end=20).sali,
    "decide": lambda x: lp.decide(TOP, x, t_end=100).sali,
    "frequency_drift": lambda x: lp.chaos.frequency_drift(TOP, x, observable="l1", t_end=100).drift,
    "time_scale": lambda x: lp.orbits.time_scale(TOP, x),
    "attitude": lambda x: lp.orbits.attitude(TOP, x, times=[0, 1]).quaternion,
}


@pytest.mark.parametrize("run", RUNS.values(), ids=RUNS)
def test_starts_by_name_are_those_by_number(run):
    np.testing.assert_array_equal(run(NAMED), run(STATE))


def test_many_starts_by_name():
    by_columns = {"l1": [1, 2, 3], "alpha": np.eye(3), "beta3": 1}
    by_rows = [{"l1": k + 1, "alpha": np.eye(3)[k], "beta3": 1} for k in range(3)]
    states = np.zeros((3, 9))
    states[:, 0], states[:, 3:6], states[:, 8] = [1, 2, 3], np.eye(3), 1
    for given in (by_columns, by_rows):
        np.testing.assert_array_equal(lp.integrate(TOP, given, times=[0, 1]).start, states)


def test_systems_without_vectors_and_fields_alone_have_the_names_of_their_components():
    oscillator = lp.catalog.system("henon-heiles")
    assert lp.integrate(oscillator, {"x": 0.1, "p_y": 0.2}, t_end=1).start.tolist() == [[0.1, 0, 0, 0.2]]

    class Field:
        name = "a field"

        def field(self):
            return TOP.field()

    assert lp.integrate(Field(), {"l2": 1}, t_end=1).start.tolist() == [[0, 1, 0, 0, 0, 0, 0, 0, 0]]
