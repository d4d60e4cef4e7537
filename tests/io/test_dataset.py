"""Files: labelled, complete, repeatable bit for bit; damaged ones and full disks are refused by name."""

import importlib
import inspect
import json
from functools import cache

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import DamagedFileError, MissingFileError, OutputError, ParameterError
from liepoisson.io.dataset import save
from liepoisson.numeric.systems import TOP_COMPONENTS
from liepoisson.saved.rerun import _class
from public_calls import RUNS, made, public_names

TOP = lp.Top(inertia=(2, 1.5, 1), a=(-1, 0.1, 0.2), b=(0.4, 0, -0.7), epsilon=0.8)


@cache
def growth(n=7):
    x0 = lp.sample_states(TOP, n, seed=1)
    return lp.finite_time_exponents(TOP, x0, t_end=12, seed=5, first=3, method=lp.Taylor(tol=1e-11))


@cache
def orbit():
    return orbit_with()


def orbit_with(**options):
    return lp.integrate(TOP, lp.sample_states(TOP, 3, seed=1), times=np.linspace(1, -2, 7), **options)


@pytest.mark.thorough
def test_exponents_are_labelled_and_repeat_from_the_file_alone(tmp_path):
    result = growth()
    path = result.save(tmp_path / "deep" / "growth.nc")
    dataset = lp.load(path).dataset
    assert dict(dataset.sizes) == {"trajectory": 7, "time": 200, "component": 9}
    assert list(dataset.component.to_numpy()) == list(TOP_COMPONENTS)
    assert list(dataset.trajectory.to_numpy()) == list(range(3, 10))
    again = lp.rerun(path, threads=1)
    assert np.array_equal(again.exponent, result.exponent)
    assert np.array_equal(dataset.exponent.to_numpy(), result.exponent)
    assert again.method == result.method
    assert again.field == result.field


def test_missing_damaged_and_foreign_files_are_refused(tmp_path):
    path = growth().save(tmp_path / "growth.nc")
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(DamagedFileError, match="may be truncated"):
        lp.load(path)
    path.write_text("not a dataset")
    with pytest.raises(DamagedFileError, match="wanted NetCDF-4"):
        lp.load(path)
    import xarray as xr

    xr.Dataset({"x": ("t", [1.0])}).to_netcdf(path, engine="h5netcdf")
    with pytest.raises(DamagedFileError, match="wanted a checksum"):
        lp.load(path)
    with pytest.raises(DamagedFileError, match="another kind"):
        lp.load(path, verify=False)


@pytest.mark.parametrize("name", [None, 5, "growth.xlsx", "growth", "growth.nc.gz"])
def test_a_name_that_no_netcdf_file_should_have_is_refused(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(OutputError, match=r"wanted (the name of a file|a name that ends in \.nc)"):
        growth(1).save(name)
    assert list(tmp_path.iterdir()) == []


def test_another_version_warns():
    dataset = growth(1).dataset
    dataset.attrs["version"] = "0.0.0"
    with pytest.warns(UserWarning, match=r"made by liepoisson 0\.0\.0"):
        lp.rerun(dataset)


def test_mistakes_of_the_caller_are_not_blamed_on_the_file():
    with pytest.raises(ParameterError, match="threads"):
        lp.rerun(growth(1).dataset, threads=0)


STATES = lp.sample_states(TOP, 3, seed=1)
STRUCTURE = lp.chaos.PoissonStructure([5, 5, 5], [3, 3, 3], [True, False, True])
TAYLOR = lp.Taylor(tol=1e-11, order=17, max_steps=12_345)
COMMON = {"method": TAYLOR, "time_limit": 77.0, "seed": 3, "first": 4}
OF_EACH = {"start_side": [1, 1, 1], "structure": STRUCTURE}
"""What has a value for each of three trajectories."""
# How a run is watched and shared out, on which no number depends.
NOT_RECORDED = {"threads", "progress"}
INSTEAD = {"t_end": "times", "length": "arclengths", "n_points": "arclengths"}
"""What is left out where another argument is given: the end is the last of the times."""
RECORDED = sorted(RUNS.keys() - {"chart orbit", "sweep", "integral scan", "orbit fit"})
"""The first is repeated as an orbit in its coordinates, the others have tests of their own."""


def given(kind):
    """All arguments of a run, other than they are by default; what many functions take is the same for all."""
    row = made()[kind]
    taken, three = inspect.signature(row.function).parameters, dict(OF_EACH)
    if "starts" in taken:
        three["starts"] = np.outer([1, 0.9, 1.1], row.arguments["starts"])
    return {name: value for name, value in (COMMON | row.arguments | three).items() if name in taken}


def run_of(kind, **others):
    """The result of a kind, with some arguments of its call changed."""
    return made()[kind].function(**given(kind) | others)


def test_the_class_of_a_file_is_found_by_its_kind():
    found = [*public_names().saved()]
    assert len(found) > 30
    assert [one for one in found if _class(one.kind) is not one] == []


def plain(value):
    """A value in which two that are the same compare as equal."""
    if isinstance(value, lp.chaos.PoissonStructure):
        return {name: array.tolist() for name, array in vars(value).items()}
    return np.array(value) if isinstance(value, (list, tuple, np.ndarray)) else value


def are_same(found, wanted):
    """Whether what a file has is what was given once, for each trajectory."""
    found, wanted = plain(found), plain(wanted)
    is_array = isinstance(wanted, np.ndarray)
    return np.array_equal(found, np.broadcast_to(wanted, np.shape(found))) if is_array else found == wanted


@pytest.mark.parametrize("kind", RECORDED)
def test_a_file_records_every_argument_of_its_run(saved, kind):
    """An argument that is added later must be given in `public_calls.py`, and recorded."""
    row, arguments = made()[kind], given(kind)
    left_out = {name for name, other in INSTEAD.items() if other in arguments}
    taken = {*inspect.signature(row.function).parameters} - NOT_RECORDED - left_out
    assert taken == arguments.keys(), f"give in public_calls.py what {row.function.__name__} takes"
    system = arguments.pop("system")
    _, loaded = saved(f"{kind}, as given")
    found = loaded.arguments() | {"time_limit": loaded.time_limit}
    if "surface" in arguments:
        tape = system.function_tape(arguments["surface"], *arguments.get("keep", ()))
        assert found["surface"] == tape
        found["surface"] = loaded.surface
    if kind == "energy profile":  # a file has the starts that were drawn on the leaf
        own, drawn, n = arguments.pop("leaf"), found.pop("leaf"), arguments["n_starts"]
        for energy in arguments["energies"]:
            wanted = own.sample(n, seed=arguments["seed"], energy=energy)
            np.testing.assert_array_equal(drawn.sample(n, seed=0, energy=energy), wanted)
        assert drawn.casimirs == own.casimirs
    assert found.keys() - left_out == arguments.keys()
    assert [name for name, value in arguments.items() if not are_same(found[name], value)] == []


def runs_of_all_kinds():
    hostile = STATES.copy()
    hostile[1, 2] = np.inf
    charge = {"times": [0.0, 1.0, 5.0], "method": lp.Taylor(max_steps=3)}
    return {
        **{f"{kind}, as given": lambda kind=kind: run_of(kind) for kind in RECORDED},
        "return of one": lambda: lp.sections.first_return(TOP, STATES[0], surface="l3", t_end=50),
        "return of a table": lambda: lp.sections.first_return(TOP, STATES[None], surface="l3", t_end=50),
        "orbit fit": lambda: made()["orbit fit"].function(**made()["orbit fit"].arguments),
        "orbit": orbit,
        "orbit, dense, with tangents": lambda: orbit_with(dense=True, tangents=np.eye(9)[:2]),
        "orbit, components": lambda: lp.integrate(TOP, STATES[:1], times=[0, 1]),
        "orbit, lanes": lambda: lp.integrate(TOP, STATES[:1], times=[0, 1], kernel="lanes"),
        "orbit, failed": lambda: lp.integrate(TOP, hostile, **charge),
        "orbit, none": lambda: lp.integrate(TOP, np.empty((0, 9)), times=[0, 1]),
        "orbit, splitting": lambda: lp.integrate(TOP, STATES, times=[0, 1], method=lp.Splitting(step=0.1, order=6)),
        "orbit, field": lambda: lp.integrate(
            lp.fields.TopField((1, 2, 3), (1, 0, 0), (0, 1, 0), 1), STATES, times=[0, 1]
        ),
        "growth": growth,
        "growth, failed": lambda: lp.finite_time_exponents(TOP, hostile, t_end=5, method=lp.Taylor(max_steps=3)),
        "growth, none": lambda: lp.finite_time_exponents(TOP, np.empty((0, 9)), t_end=5),
        "section": lambda: lp.section(TOP, STATES, surface="l3", t_end=10),
        "section, kept": lambda: lp.section(TOP, STATES, surface="l3", t_end=10, keep=["l1^2", "dot(l, beta)"]),
        "section, all kept": lambda: lp.section(TOP, STATES, surface="l3", t_end=10, keep=TOP.component_names),
        "section, tape": lambda: lp.section(TOP, STATES, surface=TOP.function_tape("l3", "l1"), t_end=10),
        "section, no crossing": lambda: lp.section(TOP, STATES, surface="l3 - 100", t_end=10),
        "section, failed": lambda: lp.section(TOP, hostile, surface="l3", t_end=9, method=lp.Taylor(max_steps=3)),
        "spectrum": lambda: lp.lyapunov_spectrum(TOP, STATES, t_end=12, interval=2),
        "spectrum, covariant": lambda: lp.lyapunov_spectrum(TOP, STATES, t_end=12, transient=5, covariant=True),
        "spectrum, failed": lambda: lp.lyapunov_spectrum(TOP, hostile, t_end=12, n_exponents=2),
        "spectrum, field": lambda: lp.lyapunov_spectrum(TOP.field(), STATES, t_end=12),
        "spectrum, structure": lambda: lp.lyapunov_spectrum(TOP, STATES, t_end=12, structure=STRUCTURE),
        "chart": lambda: lp.orbits.chart_orbit(lp.charts.EulerChart(TOP, state=STATES[0]), STATES[0], times=[0, 1, 2]),
    }


ALL = runs_of_all_kinds()


@cache
def result_of(kind):
    """A result of all kinds, which does not change: made once for all tests."""
    return ALL[kind]()


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    """The file of a result of all kinds, and what is loaded from it."""
    folder = tmp_path_factory.mktemp("saved")

    @cache
    def file_of(kind):
        path = result_of(kind).save(folder / f"{kind}.nc")
        return path, lp.load(path)

    return file_of


@pytest.mark.thorough
@pytest.mark.parametrize("kind", ALL)
def test_what_is_loaded_is_what_was_saved_and_what_is_rerun(tmp_path, saved, kind):
    result = result_of(kind)
    path, loaded = saved(kind)
    assert type(loaded) is type(result)
    assert loaded.dataset.identical(result.dataset)
    assert loaded.dataset.attrs == result.dataset.attrs
    assert repr(loaded) == repr(result)
    assert loaded.system.name == result.system.name
    again = lp.rerun(path)
    if kind == "chart":  # it does not know where the chart ends
        assert again.dataset.identical(result.run.dataset)
        return
    assert type(again) is type(result)
    assert again.dataset.identical(loaded.dataset)
    assert again.save(tmp_path / "again.nc").read_bytes() == path.read_bytes()


def test_the_last_time_of_a_spectrum_is_the_one_that_was_given():
    """(t n)/n may differ from t by a bit, and a run from it in its last bits."""
    t_end, n = 3.7, 3
    assert t_end * n / n != t_end
    spectrum = lp.lyapunov_spectrum(TOP, STATES[:1], t_end=t_end, interval=1.3, n_exponents=1)
    assert len(spectrum.time) == n
    assert spectrum.time[-1] == t_end


def cut_short(kind):
    states = lp.sample_states(TOP, 64, seed=1)
    return {
        "orbit": lambda: lp.integrate(TOP, states, times=np.linspace(0, 4000, 401), time_limit=0.02, threads=1),
        "growth": lambda: lp.finite_time_exponents(TOP, states, t_end=3000, time_limit=0.03, threads=1),
        "section": lambda: lp.section(TOP, states, surface="l3", t_end=3000, time_limit=0.05, threads=1),
    }[kind]()


@pytest.mark.thorough
@pytest.mark.parametrize("kind", ["orbit", "growth", "section"])
def test_a_rerun_says_that_a_limit_of_time_cannot_be_repeated(tmp_path, kind):
    result = cut_short(kind)
    n_cut = int((result.outcome == "time limit").sum())
    assert n_cut
    path = result.save(tmp_path / "run.nc")
    with pytest.warns(UserWarning, match=f"{n_cut} trajectories of the file were ended by the time limit of 0.0"):
        again = lp.rerun(path)
    assert (again.outcome == "finished").all()
    assert again.time_limit == np.inf
    np.testing.assert_array_equal(again.start, result.start)
    if kind == "section":
        for k in range(result.n_trajectories):
            np.testing.assert_array_equal(again.of(k)[: len(result.of(k))], result.of(k))
        return
    name = {"orbit": "state", "growth": "exponent"}[kind]
    before, after = getattr(result, name), getattr(again, name)
    reached = np.isfinite(before)
    np.testing.assert_array_equal(after[reached], before[reached])


def test_a_rerun_takes_as_long_as_it_needs(monkeypatch):
    """Its own limit is none: a run of more than the default hour is not cut."""
    limits = []
    module = importlib.import_module(RUNS["growth"].__module__)
    run = module.finite_time_exponents

    def noted(*given, time_limit, **options):
        limits.append(time_limit)
        return run(*given, **options)

    monkeypatch.setattr(module, "finite_time_exponents", noted)
    lp.rerun(growth(1).dataset)
    lp.rerun(growth(1).dataset, time_limit=5)
    assert limits == [np.inf, 5]


FIELD = {"kind": "quadratic", "n_components": 2**62, "constant": [], "linear": [], "quadratic": []}
ALTERED = (
    ("format", "liepoisson/9"), ("kind", "other"), ("run", "[]"), ("run", "[" * 100_000), ("method", {"name": "euler"}),
    ("method", {"tol": "a"}), ("method", "5"), ("field", {"kind": "spinning coin"}), ("field", {"inertia": [1, 2]}),
    ("field", {"epsilon": float("nan")}), ("field", FIELD),  # before the core makes room for it
)  # fmt: skip


@pytest.mark.parametrize(("attribute", "change"), ALTERED)
def test_an_altered_record_is_not_rerun(attribute, change):
    dataset = growth(1).dataset
    if isinstance(change, dict):
        change = json.dumps(json.loads(dataset.attrs[attribute]) | change)
    dataset.attrs[attribute] = change
    with pytest.raises(DamagedFileError, match=r"does not record a run|component"):
        lp.rerun(dataset)


def other_system(dataset):
    text = dataset.attrs["system_file"]
    assert "4/5" in text
    return dataset.assign_attrs(system_file=text.replace("4/5", "3/5"))


def spectrum():
    return lp.lyapunov_spectrum(TOP, STATES, t_end=4, interval=1)


def profile():
    return run_of("energy profile")


def crossings():
    top = lp.Top.twisted_kovalevskaya()
    return lp.section(top, lp.sample_states(top, 6, seed=3), surface="l1", t_end=20)


PARTS = (
    (growth, lambda d: d.drop_attrs().assign_attrs({k: v for k, v in d.attrs.items() if k != "method"}), "method"),
    (growth, other_system, "equations are not those"),
    (growth, lambda d: d.isel(component=[0, 1]), "component"),
    (growth, lambda d: d.isel(trajectory=[3, 5]), "one after the other"),
    (spectrum, lambda d: d.isel(trajectory=[0, 2]), "one after the other"),
    (spectrum, lambda d: d.isel(time=slice(None, None, -1)), "time: wanted all times"),
    (spectrum, lambda d: d.isel(time=slice(0, 0)), "time: wanted all times"),
    (profile, lambda d: d.isel(member=[2]), "one after the other"),
    (orbit, lambda d: d.isel(time=slice(1, None)), "from 1 on"),
    (crossings, lambda d: d.isel(trajectory=[2, 3]).drop_vars("trajectory"), None),
    (crossings, lambda d: d.assign_coords(trajectory=-np.arange(6)), None),
    (crossings, lambda d: d.assign_coords(crossing_trajectory=d.crossing_trajectory.astype(float)), None),
    (crossings, lambda d: d.isel(crossing=np.argsort(-d.time.values)), None),
    (crossings, lambda d: d.assign_coords(crossing_trajectory=d.crossing_trajectory // 2), None),  # of joined files
)


@pytest.mark.parametrize(("make", "change", "said"), PARTS)
def test_a_part_of_a_dataset_that_is_no_run_is_not_rerun(make, change, said):
    with pytest.raises(DamagedFileError, match=said):
        lp.rerun(change(make().dataset))


NONSENSE = [None, "", "abc", -1, 0, float("inf"), float("nan"), [], {}, [[]], 2**70, "1", True, {"a": 1}]


def spoiled(dataset):
    """Datasets with something wrong in each attribute, record and variable."""
    run, method = json.loads(dataset.attrs["run"]), json.loads(dataset.attrs["method"])
    for value in NONSENSE:
        for name in run:
            yield dataset.assign_attrs(run=json.dumps(run | {name: value}))
        for name in method:
            yield dataset.assign_attrs(method=json.dumps(method | {name: value}))
    for name in dataset.attrs:
        for value in (*NONSENSE, np.zeros(3)):
            yield dataset.assign_attrs({name: value})
        yield dataset.drop_attrs().assign_attrs({n: v for n, v in dataset.attrs.items() if n != name})
    for name in dataset.variables:
        yield dataset.drop_vars(name)
        yield dataset.assign({name: dataset[name].astype(str)})
        if dataset[name].dtype.kind in "fi":
            yield dataset.assign({name: dataset[name].astype(complex)})
            yield dataset.assign({name: dataset[name] * np.nan})
    for name in dataset.sizes:
        yield dataset.isel({name: slice(0, 1)})
        yield dataset.isel({name: slice(0, 0)})


@pytest.mark.thorough
@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize(
    "kind", ["orbit", "section", *(pytest.param(kind, marks=pytest.mark.slow) for kind in ("growth", "spectrum"))]
)
def test_a_dataset_that_was_spoiled_is_run_or_refused_with_a_sentence(kind):
    refused = 0
    for dataset in spoiled(run_of(kind, **{"t_end": 2.0, "transient": 0.5} if kind == "spectrum" else {}).dataset):
        try:
            lp.rerun(dataset, time_limit=2)
        except lp.errors.LiePoissonError as error:
            refused += 1
            shown = str(error)
            assert 10 < len(shown) < 1000
    assert refused > 50


REARRANGED = {
    "transposed": lambda dataset: dataset.transpose(),
    "components by name": lambda dataset: dataset.sortby("component"),
    "components backwards": lambda dataset: dataset.isel(component=slice(None, None, -1)),
    "a part of the members": lambda dataset: dataset.isel(trajectory=slice(4, 7)),
}


@pytest.mark.thorough
@pytest.mark.parametrize("how", REARRANGED)
@pytest.mark.parametrize("kind", ["growth", "orbit", "section", "spectrum"])
def test_a_rearranged_dataset_has_the_same_rerun(kind, how):
    """As many trajectories as components: a matrix that is read the wrong way round would fit."""
    x0 = lp.sample_states(TOP, 9, seed=1)
    run = {
        "growth": lambda: lp.finite_time_exponents(TOP, x0, t_end=5, first=2),
        "orbit": lambda: lp.integrate(TOP, x0, times=[0, 1, 2], tangents=np.tile(np.eye(9), (9, 1, 1))),
        "section": lambda: lp.section(TOP, x0, surface="l3", t_end=20),
        "spectrum": lambda: lp.lyapunov_spectrum(TOP, x0, t_end=10, interval=1, first=2),
    }[kind]
    original = run().dataset
    changed = REARRANGED[how](original)
    again = lp.rerun(changed).dataset
    for name in ("end_state", "start", "exponent"):
        if name in original:
            wanted = original[name].isel(trajectory=slice(4, 7)) if "part" in how else original[name]
            assert np.array_equal(again[name], wanted, equal_nan=True)
    if kind in {"growth", "spectrum"}:  # whose trajectories have numbers of their own
        assert np.array_equal(again["trajectory"], changed["trajectory"])


@pytest.mark.parametrize("pick", [[5, 0], [2], [], [1, 0, 5, 4, 3, 2]])
def test_a_part_of_a_section_or_of_a_dense_orbit_has_its_own_numbers(tmp_path, pick):
    whole = crossings()
    save(whole.dataset.isel(trajectory=pick), tmp_path / "part.nc")
    part = lp.load(tmp_path / "part.nc")
    assert part.count.tolist() == whole.count[pick].tolist()
    for row, trajectory in enumerate(pick):
        assert np.array_equal(part.of(row), whole.of(trajectory))
    again = lp.rerun(part)
    assert np.array_equal(again.state, part.state)
    assert np.array_equal(again.trajectory, part.trajectory)
    dense = lp.integrate(lp.Top.twisted_kovalevskaya(), whole.start, times=[0, 1, 4], dense=True)
    save(dense.dataset.isel(trajectory=pick), tmp_path / "dense.nc")
    part = lp.load(tmp_path / "dense.nc")
    assert not pick or np.array_equal(part.at([0.5, 3.0]), dense.at([0.5, 3.0])[pick])


@pytest.mark.parametrize("read", [lp.load, lp.rerun])
def test_a_file_that_does_not_exist_is_said_to_be_missing(read, tmp_path):
    orbit = lp.integrate(lp.Top.kovalevskaya(), np.ones(9), times=[0, 1])
    orbit.save(tmp_path / "orbit.nc")
    with pytest.raises(FileNotFoundError, match=r"Did you mean orbit\.nc") as caught:
        read(tmp_path / "orbits.nc")
    assert isinstance(caught.value, lp.errors.LiePoissonError)
    with pytest.raises(MissingFileError, match="Look at the name, and at the folder"):
        read(tmp_path / "no" / "such.nc")
    for name in ("x" * 300, "a\0b", 5, None):
        with pytest.raises((ParameterError, MissingFileError), match=r"wanted (the name of )?a file"):
            read(name)
