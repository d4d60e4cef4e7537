"""Observations are read from files, tables, data sets and mappings, and refused with what to try."""

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import liepoisson as lp
from liepoisson.errors import ParameterError, ShapeError
from liepoisson.observations.observations import Observations

T, X = [0.0, 0.5, 1.5], [1.0, None, 3.0]
TEXT = '# a comment\nt, x ,"atan2(y, x)",sx\n0,1,0.5,0.1\n0.5,,NaN,0.1\n1.5,3,1e-1,0.2\n'


def written(tmp_path, text, encoding="utf-8"):
    path = tmp_path / "data.csv"
    path.write_text(text, encoding=encoding)
    return path


def test_a_file_is_read_with_its_gaps(tmp_path):
    seen = Observations(written(tmp_path, TEXT, "utf-8-sig"), errors={"x": "sx", "atan2(y, x)": 0.25})
    assert (seen.names, seen.runs, seen.n_values) == (("x", "atan2(y, x)"), ("0",), 4)
    np.testing.assert_array_equal(seen.time, T)
    np.testing.assert_array_equal(seen.value, [[1, 0.5], [np.nan, np.nan], [3, 0.1]])
    np.testing.assert_array_equal(seen.deviation, [[0.1, 0.25], [0.1, 0.25], [0.2, 0.25]])
    assert seen.errors_are_known


ORBIT = lp.integrate(lp.catalog.system("henon-heiles"), [0.1, 0, 0, 0.2], times=[0.0, 0.5, 1.5])
HAVE = {
    "mapping": {"t": T, "x": X},
    "frame": pd.DataFrame({"t": T, "x": X}),
    "times as the index of a frame": pd.DataFrame({"x": X}, index=pd.Index(T, name="t")),
    "missing values of pandas": pd.DataFrame({"t": T, "x": pd.array([1, None, 3], dtype="Int64")}),
    "data set": xr.Dataset({"x": ("t", [1, np.nan, 3])}, {"t": T}),
    "masked": {"t": T, "x": np.ma.masked_values([1.0, -9, 3], -9)},
    "records": np.array([(0.0, 1), (0.5, np.nan), (1.5, 3)], dtype=[("t", float), ("x", float)]),
}


@pytest.mark.parametrize("name", HAVE)
def test_what_people_have_is_read(name):
    seen = Observations(HAVE[name])
    assert seen.names == ("x",)
    np.testing.assert_array_equal(seen.time, T)
    np.testing.assert_array_equal(seen.value[:, 0], [1, np.nan, 3])


def test_a_run_of_ours_is_read_by_its_columns():
    seen = Observations(ORBIT, columns=["x", "p_y"], run="trajectory")
    np.testing.assert_array_equal(seen.value, ORBIT.state[0][:, [0, 3]])


def test_trajectories_of_a_run_of_ours_are_runs():
    seen = Observations(ORBIT)
    assert seen.names == ORBIT.system.component_names
    np.testing.assert_array_equal(seen.value[seen.run == 0], ORBIT.state[0])
    with pytest.raises(ParameterError, match="give the result itself"):
        Observations(ORBIT.dataset)


def test_weights_leave_values_out_and_runs_have_names():
    seen = Observations(
        {"time": [0, 1, 0], "x": [1, 2, 3], "of": ["b", "b", "a"], "w": [4, 0, 1]}, weights="w", run="of"
    )
    assert (seen.runs, seen.run.tolist(), seen.n_values, seen.errors_are_known) == (("b", "a"), [0, 0, 1], 2, False)
    assert seen.deviation[[0, 2], 0].tolist() == [0.5, 1]


WRONG = {
    "out of order": (
        {"t": [0, 2, 1], "x": [1, 2, 3]},
        {},
        "times that increase; 1 in row 3 comes after 2 and is out of",
    ),
    "repeated": ({"t": [0, 1, 1], "x": [1, 2, 3]}, {}, "and is repeated; sort the rows, .* run="),
    "no time": ({"s": [0, 1], "x": [1, 2]}, {}, 'column t or time; got neither; the columns are s, x; .* time="s"'),
    "two times": ({"t": [0], "time": [0], "x": [1]}, {}, "got t and time"),
    "missing time": ({"t": [0, None], "x": [1, 2]}, {}, "a finite time in each row; row 2 of t has none"),
    "unknown column": ({"t": [0], "theta": [1]}, {"columns": ["thet"]}, "got 'thet'. Did you mean theta"),
    "nothing": ({"t": [0, 1], "x": [None, "nan"]}, {}, "the column x has none; leave it out"),
    "infinite": ({"t": [0, 1], "x": [1, np.inf]}, {}, "x is infinite in row 2; leave the cell empty"),
    "a unit": ({"t": [0], "x [mm]": [1]}, {}, r"with the unit 'mm', and equations have none"),
    "no number": ({"t": [0], "x": ["much"]}, {}, "x in row 1: .*much"),
    "only times": ({"t": [0]}, {}, "a column besides the times"),
    "no errors": ({"t": [0], "x": [1]}, {"errors": 0}, "standard deviations above 0; x has 0 in row 1"),
    "weights": ({"t": [0], "x": [1]}, {"weights": -1}, "weights that are not negative"),
    "both": ({"t": [0], "x": [1]}, {"weights": 1, "errors": 1}, "errors or weights; got both"),
    "errors of another": ({"t": [0], "x": [1]}, {"errors": {"y": 1}}, "wanted columns that are compared, x; got 'y'"),
    "error missing": ({"t": [0], "x": [1], "y": [1]}, {"errors": {"y": 1}}, "one for each column; got none for x"),
    "not a table": ([1, 2], {}, "columns with names"),
    "other use": ({"t": [0], "x": [1]}, {"columns": ["t"]}, "'t' has another use"),
    "no rows": ({"t": [], "x": []}, {}, "at least one row"),
}


@pytest.mark.parametrize("name", WRONG)
def test_data_that_mean_nothing_are_refused_with_what_to_try(name):
    data, options, message = WRONG[name]
    with pytest.raises(ParameterError, match=message):
        Observations(data, **options)


FILES = {
    "semicolons": ("t;x\n0;1\n", ParameterError, "separated by commas; got ';'"),
    "short row": ("t,x\n0,1\n2\n", ShapeError, "2 values in each row; row 2 has 1"),
    "decimal commas": ("t,x\n0,1,5\n", ShapeError, "write decimal points"),
    "twice": ("t,x,x\n0,1,2\n", ParameterError, "'x' comes twice"),
    "empty": ("", ParameterError, "a line of names and lines of numbers"),
}


@pytest.mark.parametrize("name", FILES)
def test_files_that_are_no_tables_are_refused(name, tmp_path):
    text, error, message = FILES[name]
    with pytest.raises(error, match=message):
        Observations(written(tmp_path, text))


def test_a_file_that_is_not_there_and_columns_of_other_lengths_are_refused(tmp_path):
    with pytest.raises(ParameterError, match=r"wanted a CSV file; got .*nothing\.csv"):
        Observations(tmp_path / "nothing.csv")
    with pytest.raises(ShapeError, match="columns of one length; got t 1, x 2"):
        Observations({"t": [0], "x": [1, 2]})


def test_runs_have_all_digits_of_their_labels():
    seen = Observations(
        {"t": [0, 1, 0, 1], "x": [1, 2, 3, 4], "g": [0.1234567, 0.1234567, 0.1234568, 0.1234568]}, run="g"
    )
    assert seen.runs == ("0.1234567", "0.1234568")
    assert Observations({"t": T, "x": X, "g": [2.0, 2.0, 1.0]}, run="g").runs == ("2", "1")


@pytest.mark.parametrize(
    "labels",
    [[1, np.nan, np.nan], ["a", None, ""], np.ma.masked_values([1, -9, -9], -9)],
    ids=["NaN", "none", "masked"],
)
def test_a_row_without_a_run_is_refused(labels):
    with pytest.raises(ParameterError, match=r"none in rows 2, 3"):
        Observations({"t": T, "x": X, "g": labels}, run="g")


@pytest.mark.parametrize(("kind", "hint"), [("M8[ns]", "column - start"), ("m8[s]", "column")])
def test_dates_are_no_numbers(kind, hint):
    when = np.array([0, 1, 2], dtype=kind)
    for data in ({"t": when, "x": X}, {"t": T, "x": pd.Series(when)}):
        with pytest.raises(ParameterError, match=rf"{hint}\) / np.timedelta64"):
            Observations(data)


@pytest.mark.parametrize("text", ["# t x\n0 1\n1 2\n", "# t,x\n0,1\n.5,-2e-1\n"])
def test_names_in_a_comment_are_refused(tmp_path, text):
    with pytest.raises(ParameterError, match="without #"):
        Observations(written(tmp_path, text))
