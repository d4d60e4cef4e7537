"""What callers give is read in one way: by order, by name or by label; what is none of these is refused.

Each argument that takes several values gets what people have at hand, a dictionary, a set, a generator, a labelled
array in another order, a text, and the answer is that of the plain call, or an error of liepoisson.
"""

import dataclasses
import inspect
import keyword
import re
from collections import UserDict, namedtuple
from functools import cache, singledispatch
from types import MappingProxyType

import matplotlib as mpl
import numpy as np
import pytest
import sympy as sp
import xarray as xr

import liepoisson as lp
from liepoisson.tori.frequencies import main_frequency
from public_calls import ByName, result_of, rows, several

pd = pytest.importorskip("pandas")  # which xarray needs

LiePoissonError = lp.errors.LiePoissonError

SAME, REFUSED, ANY = "the same answer", "refused", "answered or refused"


@pytest.fixture(autouse=True)
def in_a_temporary_folder(monkeypatch, tmp_path):
    """A text in the place of a path is one, and the call writes there."""
    monkeypatch.chdir(tmp_path)


def forms(kind, plain):
    """What an argument may look like, and what is wanted then."""
    return list(forms_by_name(plain, kind) if isinstance(kind, ByName) else forms_in_order(plain, kind))


def forms_in_order(plain, kind):
    if np.ndim(plain) == 0:
        yield "a dictionary", {"a": 1}, REFUSED
        yield "a set", {1, 2}, REFUSED
        return
    items = list(plain)
    yield "a generator", (item for item in items), SAME
    yield "values of a dictionary", dict(enumerate(items)).values(), SAME
    yield "a set", {1, 2, 3}, REFUSED
    yield "a frozen set of texts", frozenset({"l1", "l2"}), REFUSED
    yield "a text", "abc", ANY if kind.text else REFUSED
    yield "bytes", b"abc", REFUSED
    yield "an array of no axes", np.array(0.5), ANY if kind.one else REFUSED
    yield "a number", 7, ANY if kind.one else REFUSED
    yield "a data set", xr.Dataset({"u": ("v", [1.0])}), REFUSED
    if not kind.mapping:
        yield "a dictionary", {str(k): item for k, item in enumerate(items)}, REFUSED
        yield "a user dictionary", UserDict(dict(enumerate(items))), REFUSED
    elif not kind.names:  # equations
        left, right = items[0].split(" = ")
        yield "a dictionary", {left: int(right)}, SAME
        yield "a user dictionary", UserDict({left: right}), SAME
        yield "a series", pd.Series({left: right}), SAME
        return
    yield from forms_with_labels(items, kind)


def forms_with_labels(items, kind):
    flat = all(np.ndim(item) == 0 and not isinstance(item, dict) for item in items)
    numbers = flat and all(isinstance(item, (int, float, np.number)) for item in items)
    dtype = float if numbers and any(isinstance(item, float) for item in items) else object
    if flat:
        yield "a series without labels", pd.Series(items, dtype=dtype), SAME
    if flat and not kind.names:
        yield "a series with labels", pd.Series(items, index=[f"u{k}" for k in range(len(items))], dtype=dtype), REFUSED
        if numbers:
            yield "a labelled array without labels", xr.DataArray(np.array(items)), SAME
    if not kind.names:
        return
    turned = kind.names[::-1]
    others = {"unknown": [*turned[:-1], "gamma"], "missing": turned[:-1], "double": [*turned[:-1], turned[0]]}
    if not flat:  # rows of components
        values = np.array(items)[:, ::-1]
        yield "a table", pd.DataFrame(values, columns=turned), SAME
        placed = xr.DataArray(values.T, dims=("component", "tangent"), coords={"component": list(turned)})
        yield "labelled", placed, SAME
        for word, labels in others.items():
            yield f"{word} labels", pd.DataFrame(values[:, : len(labels)], columns=labels), REFUSED
        return
    back = items[::-1]
    if kind.mapping:
        yield "a dictionary", dict(zip(turned, back, strict=True)), SAME
        yield "a user dictionary", UserDict(zip(turned, back, strict=True)), SAME
        yield "an unknown name", {"gamma": 1}, REFUSED
        yield "a name twice", {turned[0]: 1, sp.Symbol(turned[0]): 1}, REFUSED
    if all(name.isidentifier() for name in turned):
        symbols = [*map(sp.Symbol, turned)]
        yield "a series of symbols", pd.Series(back, index=symbols, dtype=dtype), SAME
        yield "a dictionary of symbols", dict(zip(symbols, back, strict=True)), SAME if kind.mapping else ANY
    yield "a series", pd.Series(back, index=turned, dtype=dtype), SAME
    if all(name.isidentifier() and not keyword.iskeyword(name) for name in turned):
        yield "a named tuple", namedtuple("Named", turned)(*back), SAME
    for word, labels in others.items():
        yield f"{word} labels", pd.Series(back[: len(labels)], index=labels, dtype=dtype), REFUSED
    if numbers:
        record = np.zeros((), dtype=[(name, float) for name in turned])
        for name, value in zip(turned, back, strict=True):
            record[name] = value
        yield "a record", record[()], ANY if dtype is object else SAME
        yield "labelled", xr.DataArray(back, dims="component", coords={"component": list(turned)}), SAME
        yield "labelled otherwise", xr.DataArray(back, dims="name", coords={"name": list(turned)}), SAME
        yield "booleans", [True] * len(items), REFUSED


def forms_by_name(plain, kind):
    keys, values = list(plain), list(plain.values())
    if kind.components:
        labels = {key: [f"{key}{k + 1}" for k in range(np.size(value))] for key, value in plain.items()}
        vectors = {key: pd.Series(value, index=labels[key]) for key, value in plain.items() if np.size(value) > 1}
        yield "labelled components", plain | {key: vector[::-1] for key, vector in vectors.items()}, SAME
        for key, vector in vectors.items():
            yield "other labels", plain | {key: vector.set_axis(list("uvwxyz")[: len(vector)])}, REFUSED
    yield "a user dictionary", UserDict(plain), SAME
    yield "a read-only dictionary", MappingProxyType(plain), SAME
    for word, value in {
        "a list": values, "a set": set(map(str, keys)), "a generator": iter(keys), "a text": "abc", "a number": 7,
        "none of its own": np.array(0.5),
    }.items():  # fmt: skip
        yield word, value, ANY if kind.text else REFUSED
    if all(isinstance(key, str) for key in keys):
        data = np.empty(len(values), dtype=object)
        data[:] = values
        yield "a series", pd.Series(data, index=keys), SAME
        yield "a label twice", pd.Series([*data, *data], index=[*keys, *keys]), REFUSED
        if all(key.isidentifier() for key in keys):
            yield "symbols", {sp.Symbol(key): value for key, value in plain.items()}, SAME
            yield "a name twice", {**plain, sp.Symbol(keys[0]): values[0]}, REFUSED
            yield "a named tuple", namedtuple("Named", keys)(*values), SAME
        if all(isinstance(value, (int, float)) for value in values):
            yield "a data set", xr.Dataset(plain), SAME
            yield "a row of a table", pd.DataFrame([data], columns=keys), SAME


@cache
def answer(key, names=None):
    """The outcome of a call of the table, with the arguments of these names or with all: several tests ask for it."""
    row = rows()[key]
    if names is None:
        return outcome(result_of, {"key": key})
    return outcome(row.function, {name: row.arguments[name] for name in names})


def outcome(function, arguments):
    """What a call gives, so that two calls can be compared; errors of liepoisson by their words."""
    try:
        return "answer", seen(function(**arguments))
    except LiePoissonError as error:
        return "refusal", str(error)


@singledispatch
def seen(value):
    """What can be compared of a value, the same for equal ones."""
    if dataclasses.is_dataclass(value):
        return [seen(getattr(value, f.name)) for f in dataclasses.fields(value) if f.name != "system"]
    return re.sub(r" at 0x\w+", "", f"{type(value).__name__} {value!r}")


seen.register(np.ndarray, lambda array: (array.shape, str(array.tolist())))
seen.register(mpl.axes.Axes, lambda axes: [str(line.get_xydata().tolist()) for line in axes.lines])
seen.register(mpl.figure.Figure, lambda figure: [seen(axes) for axes in figure.axes])
seen.register(dict, lambda values: [(str(key), seen(value)) for key, value in values.items()])
seen.register(list, lambda items: [seen(item) for item in items])
seen.register(tuple, lambda items: [seen(item) for item in items])
seen.register(lp.System, lambda system: seen([system.hamiltonian, system.bracket, dict(system.invariants)]))
seen.register(lp.VectorField, lambda field: seen([field.equations, dict(field.invariants)]))
seen.register(lp.Bracket, lambda bracket: (str(bracket.terms()), bracket.field_names))
seen.register(lp.LieAlgebra, lambda algebra: (str(algebra.brackets), algebra.basis_names))
seen.register(lp.Extension, lambda extension: (str(extension.products), extension.field_names))


@pytest.mark.parametrize("name", several())
def test_each_argument_of_several_values_is_in_the_table(name):
    told = {argument for key, row in rows().items() if key.split(":")[0] == name for argument in row.kinds}
    assert several()[name] <= told, f"say in public_calls.py how {name} reads {several()[name] - told}"


UNANSWERED = {"proofs.find_certificate", "proofs.prove_chaos"}
"""What would take minutes: the calls of the table are refused after their arguments were read."""


@pytest.mark.thorough
@pytest.mark.filterwarnings("ignore")
def test_the_calls_of_the_table_have_answers():
    refused = {key for key in rows() if answer(key)[0] == "refusal"}
    assert refused == UNANSWERED


CALLED = ("systems.DiscreteSymmetry.__call__", "systems.PhaseFunction.__call__")
"""Objects of several states that are called themselves."""


@pytest.mark.thorough
@pytest.mark.parametrize("name", [*several(), *CALLED])
@pytest.mark.filterwarnings("ignore")
def test_what_people_have_at_hand_is_read_or_refused(name):
    wrong = []
    for key, row in rows().items():
        if key.split(":")[0] != name:
            continue
        plain = answer(key)
        for argument, kind in row.kinds.items():
            for word, value, wanted in forms(kind, row.arguments[argument]):
                what = f"{key}({argument}={word})"
                try:
                    found = outcome(row.function, row.arguments | {argument: value})
                except Exception as error:
                    wrong.append(f"{what}: {type(error).__name__}: {error}")
                    continue
                if wanted == SAME and found != plain:
                    wrong.append(f"{what}: wanted {plain!s:.200}\n  got {found!s:.300}")
                if wanted == REFUSED and (found[0] != "refusal" or found == plain):
                    wrong.append(f"{what}: wanted a refusal; got {found!s:.200}")
    assert not wrong, "\n".join(wrong)


@pytest.mark.thorough
@pytest.mark.parametrize("name", several())
@pytest.mark.filterwarnings("ignore")
def test_several_values_in_the_place_of_one_end_in_no_foreign_error(name):
    several_values = {
        "a dictionary": {"a": 1},
        "a table": pd.DataFrame([[1.0, 2.0]]),
        "an array": np.ones(2),
        "a text": "x",
    }
    wrong = []
    for key, row in rows().items():
        if key.split(":")[0] != name:
            continue
        parameters = inspect.signature(row.function).parameters.values()
        for one in parameters:
            if one.name in row.kinds or one.kind in (one.VAR_KEYWORD, one.VAR_POSITIONAL):
                continue
            for word, value in several_values.items():
                try:
                    outcome(row.function, row.arguments | {one.name: value})
                except Exception as error:
                    wrong.append(f"{key}({one.name}={word}): {type(error).__name__}: {error}")
    assert not wrong, "\n".join(wrong)


@pytest.mark.thorough
@pytest.mark.parametrize("name", [*several(), *CALLED])
@pytest.mark.filterwarnings("ignore")
def test_values_are_read_once_whatever_else_is_given(name):
    """What an argument that is left out is made of, such as the window of a fit, may be another one that was read."""
    wrong = []
    for key, row in rows().items():
        if key.split(":")[0] != name:
            continue
        parameters = inspect.signature(row.function).parameters
        for argument, kind in row.kinds.items():
            plain = row.arguments[argument]
            if isinstance(kind, ByName) or np.ndim(plain) == 0:
                continue
            needed = {other for other, one in parameters.items() if one.default is one.empty or other not in row.kinds}
            given = {other: value for other, value in row.arguments.items() if other in {*needed, argument}}
            wanted = answer(key, tuple(given) if len(given) < len(row.arguments) else None)
            found = outcome(row.function, given | {argument: iter(list(plain))})
            if found != wanted:
                wrong.append(f"{key}({argument}=a generator): wanted {wanted!s:.200}\n  got {found!s:.300}")
    assert not wrong, "\n".join(wrong)


STATE = dict(zip(lp.Top.kovalevskaya().component_names, [0.5, -0.25, 1, 0.75, 0.5, -0.5, 0.1, 0.2, 0.3], strict=True))
SORTED = sorted(STATE)


OPTIONS = ("confidence", "degree", "method", "n_starts", "seed", "store", "threads", "time_limit", "tol")


@pytest.mark.parametrize("option", OPTIONS)
def test_an_option_is_read_before_anything_is_computed_or_written(option, monkeypatch, tmp_path):
    """No trajectory is followed and no file is made, whether the call would need the option or not."""

    def computes(*args, **options):
        pytest.fail("something was computed before the options were read")

    table = list(rows().items())  # which are computed themselves
    for name in ("orbits", "sections", "carry_frames", "enclose_flow", "enclose_periodic_orbit"):
        monkeypatch.setattr(lp._core, name, computes)
    n_read = 0
    for _, row in table:
        if option in inspect.signature(row.function).parameters:
            with pytest.raises(LiePoissonError, match=option):
                row.function(**row.arguments | {option: object()})
            n_read += 1
    assert n_read
    assert not list(tmp_path.iterdir())


def test_labels_of_many_starts_decide_their_order():
    top = lp.Top.kovalevskaya(epsilon=1)
    plain = np.array([[*STATE.values()], [*STATE.values()][::-1]])
    frame = pd.DataFrame(plain, columns=list(STATE))[SORTED]
    array = xr.DataArray(
        frame.to_numpy().T, dims=("component", "trajectory"), coords={"component": SORTED, "trajectory": [4, 7]}
    )
    records = frame.to_records(index=False)
    for given in (frame, array, records, list(map(frame.iloc.__getitem__, range(2))), frame.to_dict("records")):
        orbit = lp.integrate(top, given, times=[0, 1])
        np.testing.assert_array_equal(orbit.start, plain)
    assert np.array_equal(top.vector_field(frame), top.vector_field(plain))
    whole = np.array([([1, 2, 3], [4, 5, 6], [7, 8, 9])], dtype=[(name, float, 3) for name in ("l", "alpha", "beta")])
    np.testing.assert_array_equal(lp.integrate(top, whole[::-1], times=[0, 1]).start, [np.arange(1.0, 10)])


def test_a_table_is_never_read_as_its_labels():
    table = pd.DataFrame([[0, 0, 5]])
    bracket = lp.so(3) @ lp.trivial()
    for call in (
        lambda: lp.Top.heavy(inertia=(1, 1, 2), a=table), lambda: lp.catalog.manakov(3, table),
        lambda: lp.catalog.euler_top_on("so(3)", table), lambda: bracket.rank(table), lambda: bracket.translated(table),
    ):  # fmt: skip
        with pytest.raises(lp.errors.ShapeError):
            call()
    pair, formula = lp.so(3) @ lp.semidirect(2), "dot(l, l)/2 + dot(a, M*alpha)"
    for a in (
        pd.Series([2, 0, 1], index=["a3", "a2", "a1"]),
        xr.DataArray([2, 0, 1], dims="u", coords={"component": ("u", ["a3", "a2", "a1"])}),
    ):
        same = lp.System(pair, formula, {"a": a, "M": pd.DataFrame(np.eye(3))})
        assert same.hamiltonian == lp.System(pair, formula, {"a": (1, 0, 2), "M": np.eye(3)}).hamiltonian


def test_numbers_are_not_read_from_texts_booleans_or_keys():
    top = lp.Top.kovalevskaya()
    for times in ("12", UserDict({0: 0.0, 1: 1.0}), {0.0, 1.0}, pd.Series([0.0, 1.0], index=["begin", "end"])):
        with pytest.raises(LiePoissonError, match="times"):
            lp.integrate(top, STATE, times=times)
    for starts in ([True] * 9, np.ones(9, dtype=bool), [True, *[0.5] * 8]):
        with pytest.raises(lp.errors.ParameterError, match="wanted real numbers"):
            lp.integrate(top, starts, t_end=1)
    for degree in ({2: 1}, {2}, "2"):
        with pytest.raises(lp.errors.ParameterError, match="degree"):
            lp.integrability.general_system(lp.so(3) @ lp.trivial(), degree=degree)


def test_columns_are_axes_of_a_sweep_as_lists_are():
    plain = {"system": "twisted-kovalevskaya", "n_starts": 1, "t_end": 10}
    wanted = lp.sweep(**plain, axes={"epsilon": [0, 0.5]})
    for values in (pd.Series(["0", "1/2"]), pd.Index([0.0, 0.5])):
        for axes in ({"epsilon": values}, pd.DataFrame({"epsilon": values})):
            assert lp.sweep(**plain, axes=axes).spec == wanted.spec


SMALL = lp.System(lp.so(3) @ lp.semidirect(2), "dot(l, l)/2 + alpha3")
NAMES = list(SMALL.component_names)
SQUARE = np.arange(36.0).reshape(6, 6) / 40
"""Six states of six components, which no shape tells apart from its transpose."""

PLACED = {
    "columns": (pd.DataFrame(SQUARE[:, ::-1], columns=NAMES[::-1]), SQUARE),
    "columns, and names of the rows": (pd.DataFrame(SQUARE, columns=NAMES, index=list("abcdef")), SQUARE),
    "rows": (pd.DataFrame(SQUARE, index=NAMES), SQUARE.T),
    "rows in another order": (pd.DataFrame(SQUARE[::-1], index=NAMES[::-1]), SQUARE.T),
    "a dimension with the names": (xr.DataArray(SQUARE, dims=("u", "trajectory"), coords={"u": NAMES}), SQUARE.T),
    "called component": (xr.DataArray(SQUARE, dims=("component", "trajectory")), SQUARE.T),
    "a coordinate called component": (
        xr.DataArray(SQUARE[0], dims="u", coords={"component": ("u", NAMES[::-1])}),
        SQUARE[:1, ::-1],
    ),
    "a coordinate called component, not last": (
        xr.DataArray(SQUARE, dims=("u", "trajectory"), coords={"component": ("u", NAMES[::-1])}),
        SQUARE.T[:, ::-1],
    ),
    "a coordinate called index": (pd.DataFrame(SQUARE, columns=NAMES).to_xarray().to_array(), SQUARE),
    "a data set": (pd.DataFrame(SQUARE, columns=NAMES).to_xarray(), SQUARE),
}


@pytest.mark.parametrize(("given", "states"), PLACED.values(), ids=PLACED)
def test_axes_are_found_by_name_wherever_they_stand(given, states):
    np.testing.assert_array_equal(lp.integrate(SMALL, given, t_end=0.1).start, states)
    if not isinstance(given, xr.Dataset):
        np.testing.assert_array_equal(SMALL.vector_field(given).reshape(-1, 6), SMALL.vector_field(states))


NOT_PLACED = {
    "both axes of a table": (pd.DataFrame(SQUARE, index=NAMES, columns=NAMES), "both its rows and its columns"),
    "two dimensions": (
        xr.DataArray(SQUARE, dims=("u", "v"), coords={"u": NAMES, "v": NAMES}),
        "one axis with the labels .* got 'u' and 'v'",
    ),
    "rows of no names": (pd.DataFrame(SQUARE, index=list("abcdef")), "rows with the labels a, b, c, d, e, f"),
    "a dimension of no names": (
        xr.DataArray(SQUARE, dims=("u", "trajectory"), coords={"u": list("abcdef")}),
        "dimension 'u' with the labels a, b, c, d, e, f",
    ),
    "names of nothing beside the components": (
        xr.DataArray(SQUARE, dims=("u", "component"), coords={"u": list("abcdef")}),
        "dimension 'u' with the labels",
    ),
    "a dimension too much": (lp.integrate(SMALL, SQUARE, t_end=0.1).dataset["state"], r"\.isel\(time=-1\)"),
    "a data set without some": (xr.Dataset({"l1": 1.0}), "got no values for l2, l3, alpha1"),
    "data sets without some": ([xr.Dataset({"l1": 1.0})], "got no values for l2, l3, alpha1"),
}


@pytest.mark.parametrize(("given", "message"), NOT_PLACED.values(), ids=NOT_PLACED)
def test_axes_that_belong_to_nothing_are_refused_by_name(given, message):
    with pytest.raises(LiePoissonError, match=message):
        lp.integrate(SMALL, given, t_end=0.1)


def test_tangents_have_their_axes_by_name():
    vectors = np.arange(72.0).reshape(6, 2, 6) + 1
    given = xr.DataArray(vectors, dims=("component", "tangent", "trajectory"), coords={"component": NAMES})
    orbit = lp.integrate(SMALL, SQUARE, t_end=0.1, tangents=given)
    np.testing.assert_array_equal(orbit.start_tangent, vectors.transpose(2, 1, 0))
    with pytest.raises(LiePoissonError, match="dimension 'u' beside 'trajectory'"):
        lp.integrate(SMALL, SQUARE, t_end=0.1, tangents=given.rename(tangent="u"))


MATRICES = {
    "linear_system": lambda m: lp.integrability.linear_system(m, sp.Symbol("x"), names=["a", "b"]),
    "lax_pair": lambda m: lp.integrability.lax_pair(ROTOR, L=m, M=[[0, 0], [0, 0]]),
    "a parameter": lambda m: lp.System(lp.so(3) @ lp.trivial(), "l1^2 + M11", {"M": m}),
    "a matrix of a Lie algebra": lambda m: lp.LieAlgebra.from_matrices([m]),
}
ROTOR = lp.System(lp.so(3) @ lp.trivial(), "l1^2 + 2*l2^2 + 3*l3^2")


@pytest.mark.parametrize("call", MATRICES.values(), ids=MATRICES)
def test_labels_of_a_matrix_are_not_dropped(call):
    entries = [[0, 0], [0, 0]]
    for given in (
        pd.DataFrame(entries, index=["b", "a"]),
        pd.DataFrame(entries, columns=["b", "a"]),
        xr.DataArray(entries, dims=("u", "v"), coords={"u": ["b", "a"]}),
    ):
        with pytest.raises(LiePoissonError, match="b, a"):
            call(given)


TIMES = np.geomspace(1, 100, 40)
CURVES = np.random.default_rng(1).normal(0.1, 0.01, (40, 40)) + 1 / TIMES
MIXED = np.random.default_rng(2).permutation(40)
ALONG = xr.DataArray(CURVES, dims=("trajectory", "time"), coords={"time": TIMES})
TABLE = pd.DataFrame(CURVES, columns=TIMES)
FITS = {
    "finite_time_fit": lambda e: repr(lp.fits.finite_time_fit(TIMES, e)),
    "log_fit": lambda e: repr(lp.fits.log_fit(TIMES, e)),
    "mean_curve": lambda e: lp.fits.mean_curve(TIMES, e).mean.tolist(),
    "fit_goodness": lambda e: repr(lp.fits.fit_goodness(TIMES, e, window=(1, 100), n_degrees=2)),
}


@pytest.mark.parametrize("fit", FITS.values(), ids=FITS)
def test_curves_are_read_at_the_times_that_they_say(fit):
    wanted = fit(CURVES)
    beside = xr.DataArray(CURVES[:, MIXED], dims=("trajectory", "u"), coords={"time": ("u", TIMES[MIXED])})
    renamed = ALONG.rename(time="u", trajectory="v").isel(u=MIXED).T
    for given in (ALONG.isel(time=MIXED).T, renamed, beside, ALONG.drop_vars("time").T, TABLE[TIMES[MIXED]], TABLE.T):
        assert fit(given) == wanted
    for given in (ALONG.assign_coords(time=TIMES + 1), ALONG.isel(time=slice(30)), TABLE.set_axis(TIMES + 1, axis=1)):
        with pytest.raises(LiePoissonError, match="exponent: wanted the labels"):
            fit(given)


def test_a_signal_has_the_interval_that_its_times_say():
    time = np.arange(64) * 0.5
    signal = xr.DataArray(np.cos(time), dims="time", coords={"time": time})
    wanted = main_frequency(signal.to_numpy(), 0.5)
    np.testing.assert_array_equal(main_frequency(signal, 0.5), wanted)
    for given, interval in ((signal.isel(time=np.r_[32:64, 0:32]), 0.5), (signal, 0.25)):
        with pytest.raises(lp.errors.ParameterError, match="signal: wanted samples at times"):
            main_frequency(given, interval)


def test_invariants_are_drawn_at_the_times_that_they_say():
    orbit = lp.integrate(SMALL, SQUARE[1], t_end=1)
    curve = xr.DataArray(orbit.time**2, dims="time", coords={"time": orbit.time})
    drawn = [
        seen(lp.plot.orbit(orbit, invariants={"K": given}))
        for given in (curve.to_numpy(), curve.isel(time=slice(None, None, -1)))
    ]
    assert drawn[0] == drawn[1]


def test_missing_values_of_pandas_are_refused_like_masked_ones():
    table = pd.DataFrame(SQUARE, columns=NAMES).astype("Float64")
    np.testing.assert_array_equal(lp.integrate(SMALL, table, t_end=0.1).start, SQUARE)
    table.loc[2, "l2"] = pd.NA
    for given in (table, table.iloc[2], table.to_numpy(dtype=object)):
        with pytest.raises(LiePoissonError, match=r"wanted (real|an array of) numbers"):
            lp.integrate(SMALL, given, t_end=0.1)


def test_equations_and_invariants_cannot_be_changed():
    for system in (SMALL, lp.catalog.system("henon-heiles")):
        for values in (system.equations, system.invariants):
            with pytest.raises(TypeError, match="cannot be changed"):
                values["H"] = 0
