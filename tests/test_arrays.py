import pickle

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.arrays import read_only

ARRAYS = {
    "doubles": np.arange(6.0).reshape(2, 3),
    "transposed": np.arange(6.0).reshape(2, 3).T,
    "backwards": np.arange(6.0)[::-1],
    "one number": np.array(2.0),
    "nothing": np.empty((0, 9)),
    "names": np.array(["finished", "time limit"]),
    "complex": np.array([1j, 2]),
    "bool": np.array([True, False]),
    "int8": np.array([1, -1], dtype=np.int8),
    "big-endian": np.arange(3, dtype=">f8"),
}


@pytest.mark.parametrize("array", ARRAYS.values(), ids=ARRAYS)
def test_a_read_only_array_has_the_same_numbers_and_is_never_writable_again(array):
    view = read_only(array)
    assert view.dtype == array.dtype
    assert view.shape == array.shape
    assert view.strides == array.strides or array.size == 0
    np.testing.assert_array_equal(view, array)
    with pytest.raises(ValueError, match="WRITEABLE"):
        view.setflags(write=True)
    assert array.flags.writeable
    assert view.copy().flags.writeable
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(view)), array)


def test_no_number_is_copied():
    array = np.zeros(3)
    view = read_only(array)
    array[1] = 5
    assert view[1] == 5


def test_dates_are_views_as_before():
    view = read_only(np.array(["2001-01-01"], dtype="datetime64[D]"))
    assert not view.flags.writeable


def test_arrays_of_results_cannot_be_made_writable():
    orbit = lp.integrate(lp.Top.kovalevskaya(), np.ones((2, 9)), times=[0, 1, 2])
    for name in ("state", "time", "outcome", "end_time"):
        with pytest.raises(ValueError, match="WRITEABLE"):
            getattr(orbit, name).setflags(write=True)
    with pytest.raises(ValueError, match="WRITEABLE"):
        pickle.loads(pickle.dumps(orbit)).state.setflags(write=True)
