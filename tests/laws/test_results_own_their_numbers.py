"""Results own their numbers: what a caller or another thread does to its arrays changes no run, result or file."""

import copy
import dataclasses
import inspect
import pickle
import re

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

import liepoisson as lp
from liepoisson import _core
from liepoisson.errors import LiePoissonError
from public_calls import makers, result_of, rows, several

TOP = lp.Top(inertia=(2, 1.5, 1), a=(-1, 0.1, 0.2), b=(0.4, 0, -0.7), epsilon=0.8)
STATES = lp.sample_states(TOP, 3, seed=1)

CORE = (
    "orbits",
    "growth",
    "sections",
    "enclose_flow",
    "enclose_section_map",
    "enclose_equilibria",
    "enclose_periodic_orbit",
)


ARRAYS = re.compile(r"^(?!.*(Mapping|Sequence)).*(Array|Starts|Box)Like")
"""Annotations of arguments that may be arrays of numbers."""


def array_of(value):
    """The array that a value is, if it is one of numbers."""
    try:
        return np.array(value, dtype=float)
    except (TypeError, ValueError):
        return None


def cases(name):
    """The calls of a function with its arguments that are arrays."""
    for key, row in rows().items():
        if key.partition(":")[0] == name:
            taken = inspect.signature(row.function).parameters
            words = [word for word in row.arguments if ARRAYS.search(str(taken[word].annotation))]
            arrays = {word: array for word in words if (array := array_of(row.arguments[word])) is not None}
            if arrays:
                yield (lambda row=row, **given: row.function(**row.arguments | given)), arrays


TAKE_ARRAYS = sorted(several(ARRAYS))


@pytest.mark.parametrize("name", TAKE_ARRAYS)
def test_every_argument_that_may_be_an_array_is_one_here(name):
    missing = several(ARRAYS)[name] - {word for _, arrays in cases(name) for word in arrays}
    assert not missing, f"no call of {name} in public_calls.py has {', '.join(missing)}"


def arrays_in(value, path="", above=()):
    """Every array in a result, by its place."""
    if id(value) in above:
        return
    above = (*above, id(value))
    if isinstance(value, np.ndarray):
        yield path, value
    elif isinstance(value, dict):
        for key, item in value.items():
            yield from arrays_in(item, f"{path}[{key!r}]", above)
    elif isinstance(value, (tuple, list)):
        for k, item in enumerate(value):
            yield from arrays_in(item, f"{path}[{k}]", above)
    elif isinstance(value, (Axes, Figure)):
        canvas = FigureCanvasAgg(value if isinstance(value, Figure) else value.figure)
        canvas.draw()
        yield path, np.array(canvas.buffer_rgba())
    elif dataclasses.is_dataclass(value) or isinstance(value, (lp.Leaf, lp.fits.EnsembleReduction)):
        for key, item in vars(value).items():
            yield from arrays_in(item, f"{path}.{key}", above)
    elif isinstance(value, (float, str)):
        yield path, np.array(value)
    elif value is None or isinstance(value, (bool, int, np.generic)):
        yield path, np.array(str(value))
    else:  # a chart, a page, a picture that can be turned
        yield from (
            (path, np.array(str(getattr(value, name)))) for name in ("hamiltonian", "start") if hasattr(value, name)
        )


def snapshot(result):
    found = {path: array.copy() for path, array in arrays_in(result)}
    assert found, f"nothing to compare in {result!r}"
    return found


def assert_same(found, wanted):
    assert found.keys() == wanted.keys()
    for path, array in wanted.items():
        np.testing.assert_array_equal(found[path], array, err_msg=path)


def copies(arrays):
    return {word: array.copy() for word, array in arrays.items()}


def spoil(arrays):
    for array in arrays.values():
        array[...] = 0.125 - 0.5 * array


class Counted:
    """An array that counts how often it is read: what is read twice may be two things."""

    def __init__(self, array):
        self.array, self.n_read = array, 0

    def __array__(self, dtype=None, copy=None):
        self.n_read += 1
        return np.array(self.array, dtype=dtype)


@pytest.mark.thorough
@pytest.mark.parametrize("name", TAKE_ARRAYS)
def test_a_result_does_not_depend_on_the_arrays_after_they_were_read_once(name, monkeypatch):
    """They are changed afterwards, and when the core is about to run, as another thread could: all is copied."""
    calls = []

    def spoiled_before(function):
        def call(*arguments):
            if not calls:
                spoil(given)
            calls.append(function)
            return function(*arguments)

        return call

    for call, arrays in cases(name):
        given = copies(arrays)
        result = call(**given)
        wanted = snapshot(result)
        spoil(given)
        assert_same(snapshot(result), wanted)
        for path, array in arrays_in(result):
            assert not any(np.shares_memory(array, item) for item in given.values()), path
        given = copies(arrays)
        calls.clear()
        counted = {word: Counted(array) for word, array in given.items()}
        with monkeypatch.context() as patch:
            for name_of_function in CORE:
                patch.setattr(_core, name_of_function, spoiled_before(getattr(_core, name_of_function)))
            assert_same(snapshot(call(**counted)), wanted)
        assert {word: array.n_read for word, array in counted.items()} == dict.fromkeys(given, 1)


def parts_of(value, seen):
    """A result and the results that it is made of, one of each class."""
    if isinstance(value, dict):
        value = tuple(value.values())
    if isinstance(value, (tuple, list)):
        for item in value:
            yield from parts_of(item, seen)
    elif dataclasses.is_dataclass(value) and type(value) not in seen:
        seen.add(type(value))
        if type(value).__name__ in lp.results.__all__:
            yield value
        yield from parts_of(vars(value), seen)


@pytest.mark.thorough
@pytest.mark.parametrize("name", makers())
def test_the_arrays_of_a_result_are_read_only(name):
    found = [result_of(key) for key in rows() if key.partition(":")[0] == name]
    parts = [*parts_of(found, set())]
    assert parts, f"no call in public_calls.py makes a result by {name}"
    for result in parts:
        # copies of a plain tuple are NumPy's, and a leaf has its own arrays
        copies = copy.deepcopy(result), copy.copy(result), pickle.loads(pickle.dumps(result))
        assert all((type(each), repr(each), str(each)) == (type(result), repr(result), str(result)) for each in copies)
        assert result in {result}
        assert all(each != result or hash(each) == hash(result) for each in copies)
        for each in (result, *(() if isinstance(result, tuple) else copies)):
            for path, array in arrays_in(each):
                if array.ndim and ".leaf" not in path:
                    assert not array.flags.writeable, path
        if isinstance(result, lp.results.Result) and not isinstance(result, lp.results.Sweep):  # which makes means
            for variable, values in result.dataset.data_vars.items():
                if values.dtype != object:  # names are copied
                    assert not values.to_numpy().flags.writeable, variable


ONE = {
    "EnergyProfile": lambda: lp.chaos.exponents_by_energy(
        TOP,
        leaf=lp.Leaf.through(TOP, STATES[0]),
        energies=[float(TOP.functions.energy(STATES[0]))],
        n_starts=1,
        t_end=5,
    ),
    "Orbit": lambda: lp.integrate(TOP, STATES[0], times=[0, 1], tangents=STATES[1:2]),
    "Rod": lambda: lp.orbits.rod(lp.Top.lagrange(), STATES[0], length=1.0),
    "Section": lambda: lp.section(TOP, STATES[0], surface="l3", t_end=50, n_crossings=1),
    "Sweep": lambda: lp.sweep(system="twisted-kovalevskaya", axes={"energy": [1]}, n_starts=1, t_end=2),
    "Attitude": lambda: lp.orbits.attitude(TOP, STATES[0], times=[0, 1]),
}


@pytest.mark.parametrize("kind", ONE)
def test_a_result_of_one_has_the_noun_of_one(kind):
    result = ONE[kind]()
    assert type(result).__name__ == kind
    assert not re.search(r"(?<![\w.])1 \w+s\b", repr(result)), repr(result)


def test_a_spectrum_and_a_sweep_keep_the_values_that_they_were_given():
    n_zeros = np.array([5, 5, 5])
    structure = lp.chaos.PoissonStructure(n_zeros, np.array([3, 3, 3]), np.array([True, True, True]))
    spectrum = lp.lyapunov_spectrum(TOP, STATES, t_end=5, structure=structure)
    n_zeros[:] = 0
    assert spectrum.structure.n_zeros.tolist() == [5, 5, 5]
    values, a, casimirs = np.array([0.0, 1.0]), np.array([0.1, 0.2, 0.123456789012]), {"C1": np.float64(1.0)}
    starts = lp.sweeps.Starts(casimirs=casimirs)
    axes = (lp.sweeps.Axis("epsilon", values),)
    spec = lp.sweeps.SweepSpec(system="twisted-top", axes=axes, t_end=9.0, parameters={"a": a}, starts=starts)
    record, digest = spec.record(), spec.fingerprint()
    values *= 2
    a *= 2
    casimirs["C1"] = 7
    assert spec.record() == record
    assert spec.fingerprint() == digest
    assert record["parameters"]["a"] == [0.1, 0.2, 0.123456789012]


HARMFUL = {
    "masked": lambda array: np.ma.MaskedArray(array, mask=array > 0),
    "complex": lambda array: array + 1j,
    "dates": lambda array: np.full(array.shape, np.datetime64("2020-01-01")),
    "texts": lambda array: array.astype(str),
    "nothing": lambda array: np.full(array.shape, None),
}


@pytest.mark.parametrize("name", [name for name in TAKE_ARRAYS if not name.startswith("plot.")])
def test_what_is_no_array_of_real_numbers_is_refused(name):
    for call, arrays in cases(name):
        for harm in HARMFUL.values():
            with pytest.raises(LiePoissonError):
                call(**{word: harm(array) for word, array in copies(arrays).items()})
