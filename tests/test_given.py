"""What callers give is read in one way: by order, by name or by label; what is none of these is refused.

Each argument that takes several values gets what people have at hand, a dictionary, a set, a generator, a labelled
array in another order, a text, and the answer is that of the plain call, or an error of liepoisson.
"""

import dataclasses
import inspect
import keyword
import re
from collections import UserDict, namedtuple
from functools import singledispatch
from types import MappingProxyType

import matplotlib as mpl
import numpy as np
import pytest
import xarray as xr

import liepoisson as lp
from public_calls import ByName, rows, several

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
        yield (
            "labelled",
            xr.DataArray(values.T, dims=("component", "tangent"), coords={"component": list(turned)}),
            SAME,
        )
        for word, labels in others.items():
            yield f"{word} labels", pd.DataFrame(values[:, : len(labels)], columns=labels), REFUSED
        return
    back = items[::-1]
    if kind.mapping:
        yield "a dictionary", dict(zip(turned, back, strict=True)), SAME
        yield "a user dictionary", UserDict(zip(turned, back, strict=True)), SAME
        yield "an unknown name", {"gamma": 1}, REFUSED
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
            yield "a named tuple", namedtuple("Named", keys)(*values), SAME
        if all(isinstance(value, (int, float)) for value in values):
            yield "a data set", xr.Dataset(plain), SAME
            yield "a row of a table", pd.DataFrame([data], columns=keys), SAME


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
seen.register(lp.Bracket, lambda bracket: (str(bracket.entries()), bracket.field_names))
seen.register(lp.LieAlgebra, lambda algebra: (str(algebra.brackets), algebra.basis_names))
seen.register(lp.Extension, lambda extension: (str(extension.products), extension.field_names))


@pytest.mark.parametrize("name", several())
def test_each_argument_of_several_values_is_in_the_table(name):
    told = {argument for key, row in rows().items() if key.split(":")[0] == name for argument in row.kinds}
    assert several()[name] <= told, f"say in the table of this file how {name} reads {several()[name] - told}"


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
        plain = outcome(row.function, row.arguments)
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
    wrong = []
    for key, row in rows().items():
        if key.split(":")[0] != name:
            continue
        parameters = inspect.signature(row.function).parameters.values()
        for one in parameters:
            if one.name in row.kinds or one.kind in (one.VAR_KEYWORD, one.VAR_POSITIONAL):
                continue
            for word, value in several_values().items():
                try:
                    outcome(row.function, row.arguments | {one.name: value})
                except Exception as error:
                    wrong.append(f"{key}({one.name}={word}): {type(error).__name__}: {error}")
    assert not wrong, "\n".join(wrong)


def several_values():
    return {
        "a dictionary": {"a": 1}, "a user dictionary": UserDict(a=1), "a set": {1, 2}, "a generator": iter((1, 2)),
        "a series": pd.Series([1.0, 2.0]), "a table": pd.DataFrame([[1.0, 2.0]]), "an array": np.array([1.0, 2.0]),
        "a data set": xr.Dataset({"u": ("v", [1.0])}), "a text": "abc",
    }  # fmt: skip


GORYACHEV = lp.catalog.system("goryachev-chaplygin")
ON_A_LEVEL = {
    "a text": "C1 = 1", "a list": ["C1 = 1"], "a dictionary": {"C1": 1}, "a text as value": {"C1": "1"},
    "a user dictionary": UserDict(C1=1), "a series": pd.Series({"C1": 1}), "a row": pd.DataFrame([{"C1": 1}]),
    "a data set": xr.Dataset({"C1": 1}), "a named tuple": namedtuple("Level", ["C1"])(1),
}  # fmt: skip


@pytest.mark.parametrize("on", ON_A_LEVEL.values(), ids=ON_A_LEVEL)
def test_a_level_has_the_value_that_was_given(on):
    """The cubic of Goryachev and Chaplygin is an integral where C1 = 0, and not where C1 = 1."""
    found = lp.integrability.first_integrals(GORYACHEV, degree=3, on=on)
    (zero,) = found.on
    assert zero.subs(dict.fromkeys(GORYACHEV.variables, 0)) == -1
    assert found.found == ()
    (zero,) = lp.integrability.darboux_polynomials(GORYACHEV, degree=1, on=on).on
    assert zero.subs(dict.fromkeys(GORYACHEV.variables, 0)) == -1


def test_the_level_zero_by_name_has_the_cubic():
    (cubic,) = lp.integrability.first_integrals(GORYACHEV, degree=3, on={"C1": 0}).found
    assert cubic.degree == 3


def test_assumptions_survive_a_generator():
    system = lp.System(lp.so(3) @ lp.trivial(), "p*l1^2 + q*l2^2 + r*l3^2 + s*l1*l2", symbols=["p", "q", "r", "s"])
    names = lp.integrability.integrable_families(system, degree=1, positive=["p", "q", "r"], nonzero=["s"])
    read = lp.integrability.integrable_families(
        system, degree=1, positive=(name for name in "pqr"), nonzero=(name for name in "s")
    )
    assert (read.assumptions, list(map(str, read.cases))) == (names.assumptions, list(map(str, names.cases)))
    assert "p, q, r > 0" in read.assumptions


STATE = dict(zip(lp.Top.kovalevskaya().component_names, [0.5, -0.25, 1, 0.75, 0.5, -0.5, 0.1, 0.2, 0.3], strict=True))
SORTED = sorted(STATE)


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


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"l1": "gamma"}, "got 'gamma'"),
        ({"l1": "l2"}, "'l2' comes twice"),
        ({"l1": None}, "no values for l1"),
    ],
)
def test_labels_that_do_not_fit_are_named(change, words):
    labels = {change.get(name, name): value for name, value in STATE.items() if name not in change}
    (name,) = change
    data = [*labels.values(), *([0.5] if change[name] else [])]
    series = pd.Series(data, index=[*labels, *([change[name]] if change[name] else [])])
    with pytest.raises(lp.errors.ParameterError, match=words):
        lp.integrate(lp.Top.kovalevskaya(), series, t_end=1)


def test_a_table_is_never_read_as_its_labels():
    table = pd.DataFrame([[0, 0, 5]])
    for call in (
        lambda: lp.Top.heavy(inertia=(1, 1, 2), a=table),
        lambda: lp.catalog.manakov(3, table),
        lambda: lp.catalog.euler_top_on("so(3)", table),
        lambda: (lp.so(3) @ lp.trivial()).rank(table),
        lambda: (lp.so(3) @ lp.trivial()).frozen(table),
        lambda: (lp.so(3) @ lp.trivial()).translated(table),
    ):
        with pytest.raises(lp.errors.ShapeError):
            call()
    system = lp.System(lp.so(3) @ lp.semidirect(2), "dot(l, l)/2 + dot(a, M*alpha)", {"a": (1, 0, 2), "M": np.eye(3)})
    same = lp.System(
        lp.so(3) @ lp.semidirect(2),
        "dot(l, l)/2 + dot(a, M*alpha)",
        {"a": pd.Series([2, 0, 1], index=["a3", "a2", "a1"]), "M": pd.DataFrame(np.eye(3))},
    )
    assert same.hamiltonian == system.hamiltonian


def test_what_is_kept_of_a_section_does_not_depend_on_a_hash():
    for keep in ({"l1", "l2", "alpha1"}, {"l1": 1, "l2": 2}, "l1"):
        with pytest.raises(lp.errors.ParameterError, match="keep: wanted a sequence"):
            lp.section(lp.Top.kovalevskaya(), STATE, surface="l3", t_end=10, keep=keep)


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


@pytest.mark.parametrize("values", [pd.Series([0.0, 0.5]), pd.Series(["0", "1/2"]), pd.Index([0.0, 0.5])], ids=repr)
def test_columns_are_axes_of_a_sweep_as_lists_are(values):
    plain = {"system": "twisted-kovalevskaya", "n_starts": 1, "t_end": 10}
    wanted = lp.sweep(**plain, axes={"epsilon": [0, 0.5]})
    for axes in ({"epsilon": values}, pd.DataFrame({"epsilon": values}), pd.Series({"epsilon": values})):
        assert lp.sweep(**plain, axes=axes).spec == wanted.spec
    spec = lp.sweeps.SweepSpec("twisted-top", wanted.spec.axes, 10, parameters={"a": pd.Series([-1, 0, 0])})
    assert spec.parameters == {"a": (-1, 0, 0)}


def test_an_axis_with_labels_is_refused():
    with pytest.raises(lp.errors.ParameterError, match="axis epsilon: wanted values in order"):
        lp.sweeps.Axis("epsilon", pd.Series([0.0, 0.5], index=["u", "v"]))
