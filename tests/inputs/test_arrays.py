import pickle
import time

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import MemoryLimitError
from liepoisson.inputs.arrays import norm, read_only

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


def test_norms_of_numbers_whose_squares_are_no_doubles():
    rng = np.random.default_rng(1)
    values = rng.normal(size=(4, 3, 5))
    for axis in (None, -1, (0, 2)):
        assert np.array_equal(norm(values, axis=axis), np.linalg.norm(values, axis=axis))
        for power in (-1000, -600, 600, 1000):
            scaled = norm(np.ldexp(values, power), axis=axis)
            assert np.ldexp(scaled, -power) == pytest.approx(np.linalg.norm(values, axis=axis), rel=1e-14)
    mixed = norm(np.array([[3e-200, 4e-200], [3.0, 4.0], [0.0, 0.0], [np.inf, 1.0], [3e300, -4e300]]), axis=1)
    assert mixed == pytest.approx([5e-200, 5, 0, np.inf, 5e300], rel=1e-14)


HUGE = np.broadcast_to(lp.sample_states(lp.Top.kovalevskaya(), 1, seed=1), (10**11, 9))
"""72 bytes, and 6.7 TiB as a copy."""


@pytest.mark.parametrize(
    "call",
    [
        lambda top: lp.integrate(top, HUGE, t_end=1),
        lambda top: lp.integrate(top, HUGE[0], times=np.broadcast_to(1.0, 10**12)),
        lambda top: lp.integrate(top, HUGE[0], t_end=1, tangents=HUGE),
        lambda top: lp.decide(top, HUGE),
        lambda top: lp.lyapunov_spectrum(top, HUGE, t_end=1),
        lambda top: lp.sample_states(top, 10**12),
        lambda top: lp.Leaf.through(top, HUGE[0]).sample(10**12, seed=0),
        lambda top: lp.fits.window_scan(np.broadcast_to(1.0, 10**12), [[1]]),
        lambda top: lp.fits.finite_time_fit(np.geomspace(1, 100, 9), np.ones((3, 9)), n_bootstrap=10**12),
    ],
)
def test_what_does_not_fit_into_memory_is_refused_before_it_is_copied(call):
    began = time.monotonic()
    with pytest.raises(MemoryLimitError, match=r"wanted what fits into memory; got [\d,]+ bytes"):
        call(lp.Top.kovalevskaya())
    assert time.monotonic() - began < 20
