"""Files become results again, and results runs."""

from __future__ import annotations

import json
import math
import warnings
from collections.abc import Callable, Mapping
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from liepoisson import _core
from liepoisson.compile.field import Field, TapeField, TapeFunction, field_of
from liepoisson.compile.tape_values import values_of_tape
from liepoisson.errors import DamagedFileError, ParameterError
from liepoisson.formula.scalars import as_time_limit
from liepoisson.inputs.calls import explains_its_arguments, level_of_the_caller
from liepoisson.inputs.refusals import shown
from liepoisson.io.dataset import check_format, read_dataset, result_of, stored, text_of
from liepoisson.io.result import Kept, Saved, homes_of_results
from liepoisson.numeric.methods import field_for
from liepoisson.numeric.run import Run
from liepoisson.numeric.sampling import sample_states
from liepoisson.numeric.systems import as_field

if TYPE_CHECKING:
    from xarray import Dataset

_ROUND_OFF = 1e-10
"""Of two texts of one system, relative to the largest component of a rate: some hundred operations that cancel."""
_N_COMPARED = 32

CLASSES = {
    "growth": "FiniteTimeExponents",
    "exponent": "ExponentEstimate",
    "melnikov integrals": "Melnikov",
    "regions of a diagram": "Regions",
    "monodromy of a twisted Lagrange top": "LagrangeMonodromy",
    "diagram of a twisted Lagrange top": "LagrangeDiagram",
}
"""Of kinds of results that are not the name of their class in words, as "frequency drift" is of `FrequencyDrift`."""


@explains_its_arguments
def load(path: str | Path, *, verify: bool = True) -> Any:
    """Reads a file that a result has written: the result as it was, with its system.

    Example:
        >>> from pathlib import Path
        >>> from tempfile import mkdtemp
        >>> run = lp.integrate(lp.Top.kovalevskaya(), {"l": (1, 0, 1), "alpha3": 1}, t_end=10)
        >>> file = run.save(Path(mkdtemp()) / "orbit.nc")
        >>> lp.load(file)
        <Orbit of Kovalevskaya top: 1 trajectory, 1001 times, t = 0 to 10>

    Args:
        path: The file, or the folder of a sweep.
        verify: Refuse a file whose contents do not have the checksum that liepoisson wrote.  False reads what another
            program has changed on purpose; a bit that flipped by accident is then not found either.

    Returns:
        An object of the class that was saved; its `dataset` is the labelled dataset of the file.

    Raises:
        MissingFileError: There is no such file.
        DamagedFileError: It is truncated, damaged or changed; or liepoisson did not write it.
    """
    if _is_folder(path):
        from liepoisson.sweeps.run import read_sweep

        return read_sweep(path)
    dataset = read_dataset(path, verify=verify)
    try:
        return _result(dataset)
    except Exception as error:  # records that were altered fail in many ways, one nested too deeply in its own
        raise DamagedFileError(f"{path}: {error!r:.200} is missing or altered; make it again") from error


@explains_its_arguments
def rerun(
    source: str | Path | Dataset | Saved,
    *,
    threads: int | None = None,
    time_limit: float = math.inf,
    progress: Callable[[float], Any] | None = None,
    allow_code: bool = False,
) -> Any:
    """Repeats the run that made a result, a file or a dataset, from what it records alone.

    The result has the same bits as the original on any processor, with the same version of liepoisson: starts, tangent
    vectors and times come from the file, and the core computes them all with operations that IEEE 754 rounds correctly.

    How far a run comes within its limit of seconds depends on the machine and cannot be repeated.  Trajectories that
    ended with the outcome "time limit" go on to their end in the rerun, and what they had reached before has the same
    bits.

    Example:
        >>> from pathlib import Path
        >>> from tempfile import mkdtemp
        >>> growth = lp.finite_time_exponents(lp.Top.twisted_kovalevskaya(), [1, 0, 1, 0, 0, 1, 0, 0, 1], t_end=50)
        >>> again = lp.rerun(growth.save(Path(mkdtemp()) / "growth.nc"))
        >>> bool(np.array_equal(again.exponent, growth.exponent))  # bit for bit
        True

    Args:
        source: The file, the dataset of a result, or the result.
        threads: By default all processors that the process may use.  Results do not depend on it, bit for bit.
        time_limit: Seconds that the rerun may take; by default as many as it needs.  A sweep has none: what it has
            computed is kept in its store, and it can be interrupted.
        progress: Called a few times a second with the fraction that is done.
        allow_code: Whether a sweep whose quantity is the name of a function, "package.module:function", may import and
            call it.  Without this what somebody else has saved is only data.

    An orbit in a chart is repeated as an orbit in the coordinates of the chart, which no file keeps.

    Raises:
        DamagedFileError: The file is damaged, or lacks what the run was given.  A dataset may be transposed, have its
            components in another order, or be a part of the trajectories; an orbit without its first time, a part of
            the components, and of a growth or spectrum trajectories that do not follow each other have no run.
        ParameterError: It is a sweep that names a function, and code is not allowed; or a sweep with a time limit.

    Warns:
        UserWarning: Another version of liepoisson made the file, so the bits may differ; or trajectories were ended by
            the limit of time.
    """
    given: Any = source
    spec = _spec_of_table(source)
    if spec is None and not isinstance(source, Saved):
        given = load(cast("Path", source)) if _is_folder(source) else _recorded(source)
    if spec is not None or given.kind == "sweep":
        from liepoisson.sweeps.run import sweep

        if as_time_limit(time_limit) != math.inf:
            raise ParameterError(
                f"time_limit must be left out for a sweep; got {time_limit!r:.40}. Interrupt it when you like: "
                "lp.sweep(spec, store=...) keeps what is computed and goes on from there."
            )
        return sweep(spec or given.spec, threads=threads, progress=progress, allow_code=allow_code)
    if isinstance(given, Kept):
        kind = type(given).kind
        raise ParameterError(
            f"source: wanted a run; got {kind}, whose search is not recorded and cannot be repeated. lp.load reads the "
            f"file; {given.made_by} looks again, or goes on from what was found."
        )
    given = getattr(given, "run", given)  # an orbit in a chart, which is not in the file, as one in its coordinates
    try:
        arguments, n_cut = given.arguments(), int((given.outcome == "time limit").sum())
        limit = as_time_limit(given.time_limit)
    except Exception as error:  # as above
        raise DamagedFileError(f"the file does not record a run that can be repeated: {error!s:.200}") from error
    if n_cut:
        words = f" of {limit:g} s" if math.isfinite(limit) else ""
        warnings.warn(
            f"{n_cut} trajectories of the file were ended by the time limit{words}, which depends on the "
            "machine and cannot be repeated: they go on to their end. Up to its end_time each has the same numbers",
            UserWarning,
            stacklevel=level_of_the_caller(),
        )
    options = arguments | {"time_limit": time_limit, "threads": threads, "progress": progress}
    system = given.system
    if isinstance(given, Run):
        system = FieldSystem(given.system.name, given.components, given.field, given.system)
    found = getattr(import_module(type(given).__module__), given.made_by)(system, **options)
    if isinstance(found, Run):
        found = replace(found, system=given.system, **{n: getattr(given, n) for n in ("surface",) if hasattr(given, n)})
    # where the limit ended nothing, here as there, the result is that of the file in this, too
    return found.with_time_limit(limit) if not n_cut and "time limit" not in found.outcome else found


def _is_folder(path: Any) -> bool:
    """Whether it is the folder of a sweep."""
    try:
        return isinstance(path, (str, Path)) and path != "" and Path(path).is_dir()
    except (ValueError, OSError):  # a name that no file can have
        return False


def _spec_of_table(source: Any) -> Any:
    """The spec that the dataset of a sweep has as text: a table of its grid, and not the record that a file is."""
    attributes: Any = getattr(source, "attrs", None)
    if not isinstance(attributes, Mapping) or "spec" not in attributes or "format" in attributes:
        return None
    from liepoisson.sweeps.spec import SweepSpec

    try:
        record, description = (json.loads(attributes[name]) for name in ("spec", "description"))
        return SweepSpec.of_record(record, description)
    except ParameterError:
        raise
    except Exception as error:  # records that were altered fail in many ways
        raise DamagedFileError(
            f"the dataset does not record a sweep that can be repeated: {error!r:.200} is missing or altered; repeat "
            "the sweep or its file"
        ) from error


def _recorded(source: str | Path | Dataset) -> Any:
    """The result that a file or a dataset holds."""
    import xarray as xr

    dataset = source if isinstance(source, xr.Dataset) else read_dataset(source)
    try:
        check_format(dataset)
        found = _result(dataset)
    except Exception as error:  # records that were altered fail in many ways, one nested too deeply in its own
        raise DamagedFileError(
            f"the file does not record a run that can be repeated: {error!r:.200} is missing or altered; make it again"
        ) from error
    version = str(dataset.attrs.get("version"))  # of a damaged file it may be anything
    if version != _core.__version__:
        warnings.warn(
            f"the file was made by liepoisson {version:.60}, this is {_core.__version__}: the results may differ in "
            "their last bits",
            UserWarning,
            stacklevel=level_of_the_caller(),
        )
    return found


def _result(dataset: Dataset) -> Any:
    """The result that a dataset holds; errors are of many kinds."""
    kind = dataset.attrs["kind"]
    system = None if kind == "sweep" else _system(dataset)
    found = result_of(_class(kind), dataset, system)
    if kind == "sweep":
        _check_sweep(found)
    if isinstance(found, Run) and len(found.components) != found.field.n_components:
        raise ValueError(f"component: wanted {found.field.n_components} names; got {len(found.components)}")
    if isinstance(found, Run) and dataset.attrs["version"] == _core.__version__:
        _check_system(found)
    return found


def _class(kind: Any) -> Any:
    """The class of a result of this kind."""
    name = CLASSES.get(kind, kind.title().replace(" ", "")) if isinstance(kind, str) else ""
    homes = homes_of_results()
    found = getattr(import_module(homes[name]), name) if name in homes else None
    if getattr(found, "kind", None) != kind:
        raise ValueError(f"kind: wanted that of a result; got {shown(kind)}")
    return found


def _check_system(found: Run) -> None:
    """Refuses a file whose system is not the one that was integrated: one of the two was altered."""
    if isinstance(found.system, FieldSystem):
        return
    field = field_for(found.system, as_field(found.system), found.method)
    if field != found.field and not _have_equal_values(field, found):
        raise ValueError("system_file: its equations are not those of the field that was integrated")


def _have_equal_values(field: Field, found: Run) -> bool:
    """Whether a tape that is written otherwise, as by an earlier compiler, has the values of the one of a file.

    They are compared at the starts of the file and at random states, to `_ROUND_OFF` of the largest component: texts of
    one system that are grouped in two ways differ by the round-off of some hundred operations.
    """
    if not (isinstance(field, TapeField) and isinstance(found.field, TapeField)) or (
        field.n_components != found.field.n_components
    ):
        return False
    random = sample_states(found.system, _N_COMPARED, ensemble="gaussian")
    states = np.concatenate([np.reshape(found.start, (-1, field.n_components)), random])
    with np.errstate(all="ignore"):
        here, there = (
            values_of_tape(TapeFunction(tape.n_components, tape.instructions, tape.outputs), states)
            for tape in (field, found.field)
        )
        known = np.isfinite(here)
        largest = np.max(np.where(known, np.abs(here), 0), axis=-1, keepdims=True)
        near = np.where(known, np.abs(here - there) <= _ROUND_OFF * largest, ~np.isfinite(there))
    return bool(near.all())


def _check_sweep(found: Any) -> None:
    """Refuses a part of a sweep: its points are those of its description."""
    n, spec = len(found.points), found.spec
    complete = spec.refine is not None or n == math.prod(spec.shape)
    if not complete or found.value.shape != (n, spec.n_starts) or len(found.places) != n or len(found.level) != n:
        raise ValueError(f"sweep: wanted all points and trajectories of its description; got {found.value.shape}")
    from liepoisson.sweeps.points import Lattice

    if not np.array_equal(found.points, Lattice(spec).coordinates(found.places)):
        raise ValueError("sweep: wanted the points of its description; got others")


def _system(dataset: Dataset) -> Any:
    """The system of a file, exactly; one that was known by its field alone, or that cannot be written, by its field."""
    try:
        text = text_of(dataset, "system_file")
    except KeyError:
        prefix = "" if "field" in dataset.attrs or "field" in dataset else "run_"
        field = field_of(json.loads(text_of(dataset, f"{prefix}field")))
        return FieldSystem(
            str(dataset.attrs["system"]), tuple(map(str, stored(dataset, "component").to_numpy())), field
        )
    from liepoisson.model.system_text import read_system_text, read_vector_field_text

    kind = str(dataset.attrs.get("system_kind"))
    if kind in ("VectorField", "DampedSystem"):
        return read_vector_field_text(text)
    system = read_system_text(text, kind)
    if kind != "Top" or system.top_parameters is None:
        return system
    from liepoisson.model.tops import Top

    top = system.top_parameters
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of moments that no body has, the first run has warned
        return Top(inertia=top.inertia, a=top.a, b=top.b, epsilon=top.epsilon, name=system.name)


class FieldSystem:
    """A system by its field: of a file that has nothing else, or with the field that was integrated then.

    Another version may write another field for the same system, which has everything else.
    """

    def __init__(self, name: str, component_names: tuple[str, ...], field: Field, system: Any = None) -> None:
        self.name = name
        self.component_names = component_names
        self._field = field
        self._system = system

    def field(self) -> Field:
        """The vector field."""
        return self._field

    def __getattr__(self, name: str) -> Any:
        system = vars(self).get("_system")  # none while it is copied
        if system is None:
            raise AttributeError(f"{name}: the file of this system has its field alone, no bracket and no Hamiltonian")
        return getattr(system, name)

    def __repr__(self) -> str:
        return f"<system {self.name!r} with {self._field.n_components} components, known by its field>"
