"""The one place where arrays become labelled datasets and files, and files become runs again.

A dataset carries everything that its run depended on: the parameters of the field, the method, the seed, the starts and
the version of liepoisson.  `rerun` repeats a run from the file alone and gives the same bits.
"""

from __future__ import annotations

import json
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from liepoisson import _core
from liepoisson.errors import DamagedFileError
from liepoisson.field import Field, field_of, record_of
from liepoisson.files import write_atomically
from liepoisson.numeric._checks import shown
from liepoisson.numeric.integrate import Orbit, integrate
from liepoisson.numeric.lyapunov import Growth, lyapunov_exponent
from liepoisson.numeric.methods import Method, method_of, method_record

if TYPE_CHECKING:
    from collections.abc import Callable

    from xarray import Dataset

_FORMAT = "liepoisson/1"

_LONGEST_ATTRIBUTE = 32_000
"""Characters: HDF5 keeps attributes of up to 64 kB."""
_TIME = {"long_name": "time", "units": "dimensionless"}


def orbit_dataset(orbit: Orbit) -> Dataset:
    """An orbit with labelled axes."""
    variables: dict[str, Any] = {
        "state": (("trajectory", "time", "component"), orbit.state, {"long_name": "state", "units": "dimensionless"}),
        "tangent": (("trajectory", "time", "vector", "component"), orbit.tangent, {"long_name": "tangent vectors"}),
        **_ends(orbit),
    }
    coordinates = {"time": ("time", orbit.time, _TIME), "component": list(orbit.components)}
    return _dataset(orbit, "orbit", {"dense": bool(orbit.series)}, variables, coordinates)


def growth_dataset(growth: Growth) -> Dataset:
    """Finite-time exponents with labelled axes."""
    exponent = {"long_name": "finite-time largest Lyapunov exponent", "units": "inverse time, dimensionless"}
    variables: dict[str, Any] = {
        "exponent": (("trajectory", "time"), growth.exponent, exponent),
        "initial_state": (("trajectory", "component"), growth.initial_state, {"long_name": "state at time 0"}),
        "initial_tangent": (("trajectory", "component"), growth.initial_tangent, {"long_name": "tangent at time 0"}),
        **_ends(growth),
    }
    coordinates = {
        "time": ("time", growth.time, _TIME),
        "component": list(growth.components),
        "trajectory": np.arange(growth.first, growth.first + len(growth.outcome)),
    }
    return _dataset(growth, "growth", {"seed": growth.seed, "first": growth.first}, variables, coordinates)


def _ends(result: Orbit | Growth) -> dict[str, Any]:
    return {
        "outcome": ("trajectory", result.outcome.astype(object), {"long_name": "how the trajectory ended"}),
        "end_time": ("trajectory", result.end_time, {"long_name": "time reached"}),
        "n_steps": ("trajectory", result.n_steps, {"long_name": "accepted steps"}),
        "final_state": (("trajectory", "component"), result.final_state, {"long_name": "last good state"}),
    }


def _dataset(
    result: Orbit | Growth, kind: str, run: dict[str, Any], variables: dict[str, Any], coordinates: dict[str, Any]
) -> Dataset:
    """The dataset, with all that its run depended on in its attributes; a long field becomes a variable."""
    import xarray as xr

    # json writes a float with the digits that give the same float back
    field = json.dumps(record_of(result.field))
    attributes = {
        "format": _FORMAT,
        "kind": kind,
        "system": result.system,
        "method": json.dumps(method_record(result.method)),
        "order": result.order,
        "kernel": result.kernel,
        "run": json.dumps(run),
        "version": _core.__version__,
    }
    if len(field) <= _LONGEST_ATTRIBUTE:
        attributes["field"] = field
    else:
        text = np.frombuffer(field.encode(), dtype=np.uint8)
        variables = variables | {"field": ("byte", text, {"long_name": "the vector field, as JSON in UTF-8"})}
    return xr.Dataset(variables, coordinates, attributes)


def _recorded_field(dataset: Dataset) -> Field:
    text = dataset.attrs["field"] if "field" in dataset.attrs else dataset["field"].to_numpy().tobytes().decode()
    return field_of(json.loads(text))


def netcdf(dataset: Dataset) -> memoryview:
    """The content of a NetCDF file.

    Made in memory: HDF5 does not survive a disk that fills up under a file that it has open.
    """
    return memoryview(dataset.to_netcdf(engine="h5netcdf"))


def save(dataset: Dataset, path: str | Path) -> Path:
    """Writes a dataset to a NetCDF file, whole or not at all.

    Raises:
        OutputError: The file can not be written; an older file of that name is left as it was.
    """
    path = Path(path)
    write_atomically(path, netcdf(dataset))
    return path


def load(path: str | Path) -> Dataset:
    """Reads a dataset that liepoisson has written, into memory.

    Raises:
        DamagedFileError: There is no such file, or it is not a whole file of ours.
    """
    import xarray as xr

    try:
        path = Path(path)
        found = path.is_file()
    except (TypeError, ValueError, OSError) as error:  # not a path, or a name that no file can have
        raise DamagedFileError(f"wanted the name of a file; got {shown(path)} ({error}); look at the name") from error
    if not found:
        raise DamagedFileError(f"{path}: wanted a file written by liepoisson; there is none of this name")
    try:
        with xr.open_dataset(path, engine="h5netcdf") as file:
            dataset = file.load()
    except Exception as error:  # whatever HDF5 and its wrappers raise on a truncated or foreign file
        raise DamagedFileError(
            f"{path}: can not be read as NetCDF ({error}); it may be truncated: make it again"
        ) from error
    if dataset.attrs.get("format") != _FORMAT:
        raise DamagedFileError(f"{path}: wanted a file written by liepoisson (format {_FORMAT!r}); got another kind")
    return dataset


class _Recorded:
    """A system known by the field that a file records."""

    def __init__(self, name: str, field: Field, component_names: tuple[str, ...]) -> None:
        self.name = name
        self.component_names = component_names
        self._field = field

    def field(self) -> Field:
        return self._field


def rerun(
    source: str | Path | Dataset, *, threads: int | None = None, progress: Callable[[float], Any] | None = None
) -> Orbit | Growth:
    """Repeats the run that made a file (or a dataset), from what it records alone.

    The result has the same bits as the original on any processor, with the same version of liepoisson: starts, tangent
    vectors and times come from the file, and the core computes them all with operations that IEEE 754 rounds correctly.

    Raises:
        DamagedFileError: The file lacks what the run depended on, or records it in a way that is not ours.

    Warns:
        UserWarning: Another version of liepoisson made the file, so the bits may differ.
    """
    import xarray as xr

    dataset = source if isinstance(source, xr.Dataset) else load(source)
    try:
        system, method, kind, options = _recorded_run(dataset)
    except (KeyError, TypeError, ValueError, AttributeError, IndexError) as error:
        raise DamagedFileError(
            f"the file does not record a run that can be repeated: {error!r} is missing or altered; make it again"
        ) from error
    version = dataset.attrs.get("version")
    if version != _core.__version__:
        warnings.warn(
            f"the file was made by liepoisson {version}, this is {_core.__version__}: the results may differ in their "
            "last bits",
            UserWarning,
            stacklevel=2,
        )
    run: Any = lyapunov_exponent if kind == "growth" else integrate
    return run(system, method=method, threads=threads, progress=progress, **options)


def _recorded_run(dataset: Dataset) -> tuple[_Recorded, Method, str, dict[str, Any]]:
    """What a dataset records of its run: system, method, kind and the other arguments."""
    attributes = dataset.attrs
    kind, run = attributes["kind"], json.loads(attributes["run"])
    method, field = method_of(json.loads(attributes["method"])), _recorded_field(dataset)
    _expect("format", attributes["format"], _FORMAT)
    _expect("kind", kind, "growth", "orbit")
    system = _Recorded(attributes["system"], field, tuple(map(str, dataset["component"].to_numpy())))
    times = dataset["time"].to_numpy()
    if kind == "growth":
        return system, method, kind, {
            "x0": dataset["initial_state"].to_numpy(),
            "times": times,
            "tangents": dataset["initial_tangent"].to_numpy(),
            "seed": run["seed"],
            "first": run["first"],
        }  # fmt: skip
    return system, method, kind, {
        "x0": dataset["state"].to_numpy()[:, 0],
        "t": times,
        "tangents": dataset["tangent"].to_numpy()[:, 0] if dataset.sizes["vector"] else None,
        "dense": bool(run["dense"]),
        "kernel": "components" if attributes["kernel"] == "components" else "lanes",
    }  # fmt: skip


def _expect(name: str, got: object, *wanted: str) -> None:
    if got not in wanted:
        raise ValueError(f"{name}: wanted {' or '.join(wanted)}; got {shown(got)}")
