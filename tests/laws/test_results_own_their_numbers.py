"""Results own their numbers: what a caller or another thread does to its arrays changes no run, result or file."""

import copy
import dataclasses
import inspect
import pickle
import re
from functools import cache

import numpy as np
import pytest
from given_arrays import CASES, STATES, TOP

import liepoisson as lp
from liepoisson import _core, plot
from liepoisson.errors import LiePoissonError

CORE = (
    "orbits",
    "growth",
    "sections",
    "enclose_flow",
    "enclose_section_map",
    "enclose_equilibria",
    "enclose_periodic_orbit",
)


def public_names():
    for chapter in lp.__all__:
        module = getattr(lp, chapter)
        if inspect.ismodule(module) and module is not plot:
            yield from ((name, getattr(module, name)) for name in module.__all__)


def public_callables():
    for name, value in public_names():
        if inspect.isfunction(value):
            yield name, value
        if inspect.isclass(value):
            for member, function in inspect.getmembers(value, callable):
                if not member.startswith("_") or member == "__init__":
                    yield f"{name}.{member}", function
    for name in plot.__all__:
        yield f"plot.{name}", getattr(plot, name)


def takes_arrays(function):
    try:
        parameters = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):  # a class of C
        return False
    words = ("ArrayLike", "StartsLike", "BoxLike")
    return any(word in str(parameter.annotation) for parameter in parameters for word in words)


def test_every_function_that_takes_arrays_is_tried_here():
    assert {name for name, value in public_callables() if takes_arrays(value)} == set(CASES)


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
    elif hasattr(value, "picture"):
        yield f"{path}.picture", value.picture
    elif dataclasses.is_dataclass(value) or isinstance(value, lp.Leaf):
        for key, item in vars(value).items():
            yield from arrays_in(item, f"{path}.{key}", above)
    elif isinstance(value, (float, str)):
        yield path, np.array(value)


def snapshot(result):
    found = {path: array.copy() for path, array in arrays_in(result)}
    assert found, f"nothing to compare in {result!r}"
    return found


def assert_same(found, wanted):
    assert found.keys() == wanted.keys()
    for path, array in wanted.items():
        np.testing.assert_array_equal(found[path], array, err_msg=path)


def copies(name):
    return CASES[name].copies()


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
@pytest.mark.parametrize("name", CASES)
def test_a_result_does_not_depend_on_the_arrays_after_they_were_read_once(name, monkeypatch):
    """They are changed afterwards, and when the core is about to run, as another thread could: all is copied."""
    given = copies(name)
    result = CASES[name].call(**given)
    wanted = snapshot(result)
    spoil(given)
    assert_same(snapshot(result), wanted)
    for path, array in arrays_in(result):
        assert not any(np.shares_memory(array, item) for item in given.values()), path
    given, calls = copies(name), []
    counted = {key: Counted(array) for key, array in given.items()}

    def spoiled_before(function):
        def call(*arguments):
            if not calls:
                spoil(given)
            calls.append(function)
            return function(*arguments)

        return call

    for name_of_function in CORE:
        monkeypatch.setattr(_core, name_of_function, spoiled_before(getattr(_core, name_of_function)))
    assert_same(snapshot(CASES[name].call(**counted)), wanted)
    assert {key: array.n_read for key, array in counted.items()} == dict.fromkeys(given, 1)


WELL = lp.System(lp.canonical(1), "dot(p, p)/2 - q1^2/2 + q1^4/4")
PENDULUM = lp.catalog.system("spherical-pendulum")
SPHERE = lp.Leaf(PENDULUM, {"C1": 0, "C2": 1})


# Parts of one result are looked at in the same one.


@cache
def saddle():
    return next(one for one in lp.equilibria(WELL, {}) if one.linear_stability == "unstable")


@cache
def plane():
    return lp.tori.diagram(SPHERE, energy_max=2, n_starts=20)


@cache
def plane_of_the_top():
    return lp.tori.lagrange_diagram(lp.Leaf(lp.Top.twisted_lagrange(), {"C1": 0.5, "C2": 0.2, "C3": 1}))


@cache
def regions():
    return lp.tori.regions(plane(), n_values=100, n_states=5)


@cache
def graph():
    return lp.tori.molecule(SPHERE, 0)


@cache
def profile():
    leaf = lp.Leaf.through(TOP, STATES[0])
    energy = float(TOP.functions.energy(STATES[0]))
    return lp.chaos.exponents_by_energy(TOP, leaf=leaf, energies=[energy], n_starts=1, t_end=5)


def results():
    """Each kind of result that has arrays, by the name of its class."""
    chart = lp.charts.EulerChart(TOP, state=STATES[0])
    ensemble = np.geomspace(1, 100, 40), np.random.default_rng(1).lognormal(size=(60, 40))
    on_sphere = [0.3, 0.8, 0.2, 0.8, 0, 0.6]
    return {
        "CriticalCurve": lambda: plane_of_the_top().threads[0],
        "CriticalFamily": lambda: plane().families[0],
        "CriticalStates": lambda: lp.tori.critical_states(SPHERE, n_starts=10),
        "Diagram": plane,
        "Fibre": lambda: lp.tori.fibre(SPHERE, [0.5, 0.2], n_states=5),
        "Atom": lambda: graph().atoms[0],
        "Molecule": graph,
        "LagrangeMonodromy": lambda: lp.tori.lagrange_monodromy(plane_of_the_top()),
        "LagrangeDiagram": plane_of_the_top,
        "Monodromy": lambda: lp.tori.monodromy(PENDULUM, on_sphere, [[0, 0.2], [0.2, 0.2], [0.2, 0.1]]),
        "PeriodLattice": lambda: lp.tori.period_lattice(PENDULUM, on_sphere),
        "Region": lambda: regions()[0],
        "Regions": regions,
        "RotationNumbers": lambda: lp.tori.rotation_number(np.stack([np.cos(range(9)), np.sin(range(9))], axis=1)),
        "Agreement": lambda: lp.chaos.agreement(lp.decide(TOP, STATES, t_end=10)),
        "Alignment": lambda: lp.chaos.alignment(TOP, STATES, t_end=2),
        "Attitude": lambda: lp.orbits.attitude(TOP, STATES, times=[0, 1]),
        "ChartOrbit": lambda: lp.orbits.chart_orbit(chart, STATES[0], times=[0.0, 0.1]),
        "EnergyProfile": profile,
        "Equilibrium": lambda: lp.equilibria(TOP, lp.Leaf.through(TOP, STATES[0]))[0],
        "ExponentEstimate": lambda: lp.lyapunov_exponent(TOP, STATES, t_end=50),
        "FiniteTimeExponents": lambda: lp.finite_time_exponents(TOP, STATES, t_end=1),
        "FiniteTimeFit": lambda: lp.fits.finite_time_fit(*ensemble, n_bootstrap=50),
        "FirstReturn": lambda: lp.sections.first_return(TOP, STATES, surface="l3", t_end=2),
        "FitGoodness": lambda: lp.fits.fit_goodness(*ensemble),
        "FrequencyDrift": lambda: lp.chaos.frequency_drift(TOP, STATES, observable="l1", t_end=50),
        "ConnectingOrbit": lambda: lp.orbits.connecting_orbits(saddle(), n_starts=8)[0],
        "InvariantManifold": lambda: lp.orbits.invariant_manifold(saddle()),
        "HomoclinicOrbit": lambda: lp.orbits.symmetric_homoclinic_orbits(saddle(), n_starts=8)[0],
        "LogFit": lambda: lp.fits.log_fit(*ensemble, n_bootstrap=50),
        "MeanCurve": lambda: lp.fits.mean_curve(*ensemble),
        "Megno": lambda: lp.chaos.megno(TOP, STATES, t_end=2),
        "Orbit": lambda: lp.integrate(TOP, STATES, times=[0, 1], dense=True),
        "Rod": lambda: lp.orbits.rod(lp.Top.lagrange(), STATES[0], length=1.0),
        "Section": lambda: lp.section(TOP, STATES, surface="l3", t_end=2),
        "SleepingTop": lambda: lp.phase_space.sleeping_top(lp.Top.lagrange(), l3=3, alpha3=1, beta3=0),
        "Spectrum": lambda: lp.lyapunov_spectrum(TOP, STATES[:1], t_end=5, transient=5, covariant=True),
        "SpectrumResiduals": lambda: lp.lyapunov_spectrum(TOP, STATES, t_end=5).residuals,
        "SymmetricOrbit": lambda: lp.orbits.symmetric_periodic_orbits(WELL, {}, energy=1, n_starts=4)[0],
        "Sweep": lambda: lp.sweep(system="twisted-kovalevskaya", axes={"energy": [0, 1]}, n_starts=2, t_end=2),
        "Verdict": lambda: lp.decide(TOP, STATES, t_end=10),
    }


@pytest.mark.thorough
@pytest.mark.parametrize("kind", sorted(results()))
def test_the_arrays_of_a_result_are_read_only(kind):
    result = results()[kind]()
    assert type(result).__name__ == kind
    # copies of a plain tuple are NumPy's, and a leaf has its own arrays
    copies = copy.deepcopy(result), copy.copy(result), pickle.loads(pickle.dumps(result))
    assert all((type(each), repr(each), str(each)) == (type(result), repr(result), str(result)) for each in copies)
    assert result in {result}
    assert all(each != result or hash(each) == hash(result) for each in copies)
    for each in (result, *(() if isinstance(result, tuple) else copies)):
        for path, array in arrays_in(each):
            if array.ndim and ".leaf" not in path:
                assert not array.flags.writeable, path
    if not isinstance(result, lp.results.Result) or kind == "Sweep":  # whose dataset has means, made for it
        return
    for name in result.dataset.data_vars:
        if result.dataset[name].dtype != object:  # names are copied
            assert not result.dataset[name].to_numpy().flags.writeable, name


ONE = {
    "EnergyProfile": profile,
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


@pytest.mark.parametrize("name", [name for name in CASES if not name.startswith("plot")])
def test_what_is_no_array_of_real_numbers_is_refused(name):
    for harm in HARMFUL.values():
        with pytest.raises(LiePoissonError):
            CASES[name].call(**{key: harm(value) for key, value in copies(name).items()})
