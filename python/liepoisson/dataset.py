"""The one place where results become labelled datasets and files, and files become runs again.

A dataset carries everything that its run was given: the parameters of the field, the method with all its options, the
starts, the seed, the limit of time, and the version of liepoisson.  `rerun` repeats a run from the file alone and gives
the same bits.
"""

from __future__ import annotations

import json
import math
import warnings
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from liepoisson import _core
from liepoisson.errors import DamagedFileError, OutputError
from liepoisson.field import Field, TapeFunction, field_of, record_of
from liepoisson.files import write_atomically
from liepoisson.netcdf import netcdf, read_netcdf
from liepoisson.numeric._checks import as_time_limit, shown
from liepoisson.numeric.finite_time_exponents import FiniteTimeExponents, finite_time_exponents
from liepoisson.numeric.integrate import Orbit, integrate
from liepoisson.numeric.methods import method_of, method_record
from liepoisson.numeric.section import Section, section
from liepoisson.numeric.spectrum import Spectrum, lyapunov_spectrum
from liepoisson.numeric.structural_zeros import PoissonStructure

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
        "start": (("trajectory", "component"), orbit.start, {"long_name": "state as it was given"}),
        "start_tangent": (
            ("trajectory", "vector", "component"),
            orbit.start_tangent,
            {"long_name": "tangent vectors as they were given"},
        ),
        **_ends(orbit),
    }
    coordinates = {"time": ("time", orbit.time, _TIME), "component": list(orbit.components)}
    kernel = "components" if orbit.kernel == "components" else "lanes"
    return _dataset(
        orbit,
        "orbit",
        {"dense": bool(orbit.series), "kernel": kernel, "start": float(orbit.time[0])},
        variables,
        coordinates,
    )


def growth_dataset(growth: FiniteTimeExponents) -> Dataset:
    """Finite-time exponents with labelled axes."""
    exponent = {"long_name": "finite-time largest Lyapunov exponent", "units": "inverse time, dimensionless"}
    variables: dict[str, Any] = {
        "exponent": (("trajectory", "time"), growth.exponent, exponent),
        "start": (("trajectory", "component"), growth.start, {"long_name": "state at time 0"}),
        "start_tangent": (("trajectory", "component"), growth.start_tangent, {"long_name": "tangent at time 0"}),
        **_ends(growth),
    }
    coordinates = {
        "time": ("time", growth.time, _TIME),
        "component": list(growth.components),
        "trajectory": np.arange(growth.first, growth.first + len(growth.outcome)),
    }
    return _dataset(growth, "growth", {"seed": growth.seed, "first": growth.first}, variables, coordinates)


def section_dataset(section: Section) -> Dataset:
    """Crossings of a surface with labelled axes; the starts and ends of the trajectories beside them."""
    kept = "component" if section.coordinates == section.components else "coordinate"
    state = {"long_name": "what is kept of the crossing", "units": "dimensionless"}
    variables: dict[str, Any] = {
        "state": (("crossing", kept), section.state, state),
        "sign": ("crossing", section.sign, {"long_name": "+1 where the surface function increases, else -1"}),
        "touch_state": (("touch", kept), section.touch_state, {"long_name": "what is kept of a point not decided"}),
        "unbounded_steps": (
            "trajectory",
            section.unbounded_steps,
            {"long_name": "steps with an estimated error of the state"},
        ),
        "unseen_steps": ("trajectory", section.unseen_steps, {"long_name": "steps with a part that was not seen"}),
        "undefined_time": ("trajectory", section.undefined_time, {"long_name": "time without a surface function"}),
        "unresolved_time": (
            "trajectory",
            section.unresolved_time,
            {"long_name": "time for which the surface function could not be followed"},
        ),
        "seen_to": ("trajectory", section.seen_to, {"long_name": "time up to which it was followed without a gap"}),
        "start": (("trajectory", "component"), section.start, {"long_name": "state at time 0"}),
        **_ends(section),
    }
    coordinates = {
        "crossing_trajectory": ("crossing", section.trajectory, {"long_name": "trajectory of the crossing"}),
        "time": ("crossing", section.time, _TIME),
        "touch_trajectory": ("touch", section.touch_trajectory, {"long_name": "trajectory of the point"}),
        "touch_time": ("touch", section.touch_time, _TIME),
        "component": list(section.components),
        kept: list(section.coordinates),
    }
    run = {
        "surface": section.surface,
        "t_end": section.t_end,
        "direction": section.direction,
        "n_crossings": section.n_crossings,
    }
    return _dataset(section, "section", run, variables, coordinates, surface=asdict(section.tape))


def spectrum_dataset(spectrum: Spectrum) -> Dataset:
    """Lyapunov spectra with labelled axes; covariant vectors with times of their own."""
    exponent = {"long_name": "finite-time Lyapunov exponents", "units": "inverse time, dimensionless"}
    variables: dict[str, Any] = {
        "exponent": (("trajectory", "time", "k"), spectrum.exponent, exponent),
        "error": (
            ("trajectory", "k"),
            spectrum.error,
            {"long_name": "standard error at the last time, over the time of each orbit"},
        ),
        "time_scale": ("trajectory", spectrum.time_scale, {"long_name": "natural unit of time of each orbit"}),
        "largest_ratio": ("trajectory", spectrum.largest_ratio, {"long_name": "of stretchings within one interval"}),
        "start": (("trajectory", "component"), spectrum.start, {"long_name": "state at time 0"}),
        **_ends(spectrum),
    }
    if spectrum.structure is not None:
        variables |= {name: ("trajectory", value) for name, value in vars(spectrum.structure).items()}
    coordinates = {
        "time": ("time", spectrum.time, _TIME),
        "component": list(spectrum.components),
        "trajectory": np.arange(spectrum.first, spectrum.first + len(spectrum.outcome)),
    }
    if (vectors := spectrum.covariant) is not None:
        moments = ("trajectory", "covariant_time")
        variables |= {
            "covariant_vector": ((*moments, "k", "component"), vectors.vector, {"long_name": "covariant vectors"}),
            "covariant_state": ((*moments, "component"), vectors.state, {"long_name": "states where they are"}),
            "covariant_growth": (("trajectory", "covariant_interval", "k"), vectors.growth, exponent),
        }
        coordinates["covariant_time"] = ("covariant_time", vectors.time, _TIME)
    run = {
        "seed": spectrum.seed,
        "first": spectrum.first,
        "t_end": float(spectrum.time[-1]),
        "interval": spectrum.interval,
        "transient": spectrum.transient,
        "n_exponents": spectrum.exponent.shape[2],
        "covariant": vectors is not None,
    }
    return _dataset(spectrum, "spectrum", run, variables, coordinates)


def _ends(result: Orbit | FiniteTimeExponents | Section | Spectrum) -> dict[str, Any]:
    return {
        "outcome": ("trajectory", result.outcome, {"long_name": "how the trajectory ended"}),
        "end_time": ("trajectory", result.end_time, {"long_name": "time reached"}),
        "n_steps": ("trajectory", result.n_steps, {"long_name": "accepted steps"}),
        "end_state": (("trajectory", "component"), result.end_state, {"long_name": "last good state"}),
    }


def _dataset(
    result: Orbit | FiniteTimeExponents | Section | Spectrum,
    kind: str,
    run: dict[str, Any],
    variables: dict[str, Any],
    coordinates: dict[str, Any],
    **records: dict[str, Any],
) -> Dataset:
    """The dataset, with all that its run was given in its attributes; a long record becomes a variable."""
    import xarray as xr

    attributes = {
        "format": _FORMAT,
        "kind": kind,
        "system": result.system,
        "method": json.dumps(method_record(result.method)),
        "order": result.order,
        "kernel": result.kernel,
        "run": json.dumps(run | {"time_limit": result.time_limit if math.isfinite(result.time_limit) else None}),
        "version": _core.__version__,
    }
    # the names in the order of the field: a dataset can be put into another one
    order = list(result.components)
    for name, record in {"field": record_of(result.field), "component_order": order, **records}.items():
        # json writes a float with the digits that give the same float back
        text = json.dumps(record)
        if len(text) <= _LONGEST_ATTRIBUTE:
            attributes[name] = text
        else:
            data = np.frombuffer(text.encode(), dtype=np.uint8)
            variables = variables | {name: (f"{name}_byte", data, {"long_name": f"the {name}, as JSON in UTF-8"})}
    return xr.Dataset(variables, coordinates, attributes)


def _record(dataset: Dataset, name: str) -> Any:
    text = dataset.attrs[name] if name in dataset.attrs else dataset[name].to_numpy().tobytes().decode()
    return json.loads(text)


def save(dataset: Dataset, path: str | Path) -> Path:
    """Writes a dataset to a NetCDF file with a checksum, whole or not at all.

    Raises:
        OutputError: The path is none or does not end in .nc, or the file cannot be written; an older file of that name
            is left as it was.
    """
    try:
        path = Path(path)
    except TypeError as error:
        raise OutputError(f"wanted the name of a file; got {shown(path)}; write for example run.nc") from error
    if path.suffix != ".nc":
        raise OutputError(
            f"wanted a name that ends in .nc, as NetCDF is written; got {shown(str(path))}; write for example run.nc"
        )
    write_atomically(path, netcdf(dataset))
    return path


def load(path: str | Path, *, verify: bool = True) -> Dataset:
    """Reads a dataset that liepoisson has written, into memory.

    Args:
        path: The file.
        verify: Refuse a file whose contents do not have the checksum that liepoisson wrote.  False reads what another
            program has changed on purpose; a bit that flipped by accident is then not found either.

    Raises:
        DamagedFileError: There is no such file; it is truncated, damaged or changed; or liepoisson did not write it.
    """
    try:
        path = Path(path)
        found = path.is_file()
    except (TypeError, ValueError, OSError) as error:  # not a path, or a name that no file can have
        raise DamagedFileError(f"wanted the name of a file; got {shown(path)} ({error}); look at the name") from error
    if not found:
        raise DamagedFileError(f"{path}: wanted a file written by liepoisson; there is none of this name")
    dataset = read_netcdf(path, verify=verify)
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
    source: str | Path | Dataset,
    *,
    threads: int | None = None,
    time_limit: float = math.inf,
    progress: Callable[[float], Any] | None = None,
) -> Orbit | FiniteTimeExponents | Section | Spectrum:
    """Repeats the run that made a file (or a dataset), from what it records alone.

    The result has the same bits as the original on any processor, with the same version of liepoisson: starts, tangent
    vectors and times come from the file, and the core computes them all with operations that IEEE 754 rounds correctly.

    How far a run comes within its limit of seconds depends on the machine and cannot be repeated.  Trajectories that
    ended with the outcome "time limit" go on to their end in the rerun, and what they had reached before has the same
    bits.

    Args:
        source: The file, or the dataset of a result.
        threads: By default all processors that the process may use.  Results do not depend on it, bit for bit.
        time_limit: Seconds that the rerun may take; by default as many as it needs.
        progress: Called a few times a second with the fraction that is done.

    Raises:
        DamagedFileError: The file is damaged, or lacks what the run was given.  A dataset may be transposed, have its
            components in another order, or be a part of the trajectories; an orbit without its first time, a part of
            the components, and of a growth or spectrum members that do not follow each other have no run.

    Warns:
        UserWarning: Another version of liepoisson made the file, so the bits may differ; or trajectories were ended by
            the limit of time.
    """
    import xarray as xr

    dataset = source if isinstance(source, xr.Dataset) else load(source)
    try:
        recorded = _recorded_run(dataset)
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
            stacklevel=2,
        )
    if recorded.n_cut:
        given = "" if recorded.time_limit is None else f" of {recorded.time_limit:g} s"
        warnings.warn(
            f"{recorded.n_cut} trajectories of the file were ended by the time limit{given}, which depends on the "
            "machine and cannot be repeated: they go on to their end. Up to its end_time each has the same numbers",
            UserWarning,
            stacklevel=2,
        )
    run: Any = RUNS[recorded.kind]
    options = recorded.arguments | {"time_limit": time_limit, "threads": threads, "progress": progress}
    result = run(recorded.system, **options)
    named: dict[str, Any] = {} if recorded.surface is None else {"surface": recorded.surface}
    if not recorded.n_cut and "time limit" not in result.outcome:
        # the limit ended nothing, here as there: the result is that of the file in this, too
        named["time_limit"] = math.inf if recorded.time_limit is None else recorded.time_limit
    return replace(result, **named)


RUNS = {"growth": finite_time_exponents, "orbit": integrate, "section": section, "spectrum": lyapunov_spectrum}
"""The functions whose results can be saved and rerun, by kind."""


@dataclass(frozen=True)
class Recorded:
    """What a dataset records of its run.

    Attributes:
        kind: Which of `RUNS` it was.
        system: What was integrated.
        arguments: All others by name, but for the limit of time, threads and progress.
        time_limit: Seconds that the run was allowed to take, or None.
        n_cut: Trajectories that it ended.
        surface: How the surface of a section was written.
    """

    kind: str
    system: _Recorded
    arguments: dict[str, Any]
    time_limit: float | None
    n_cut: int
    surface: str | None = None


def _recorded_run(dataset: Dataset) -> Recorded:
    """What a dataset records of its run."""
    attributes = dataset.attrs
    kind, run = attributes["kind"], json.loads(attributes["run"])
    _expect("format", attributes["format"], _FORMAT)
    _expect("kind", kind, *RUNS)
    field = field_of(_record(dataset, "field"))
    names = tuple(map(str, _record(dataset, "component_order")))
    given = list(map(str, dataset["component"].to_numpy()))
    if len(names) != field.n_components or sorted(given) != sorted(names):
        raise ValueError(f"component: wanted {', '.join(names):.60} ({field.n_components} names); got {len(given)}")
    dataset = dataset.isel(component=[given.index(name) for name in names])
    limit = run["time_limit"]
    return Recorded(
        kind=kind,
        system=_Recorded(attributes["system"], field, names),
        arguments={"method": method_of(json.loads(attributes["method"])), **_ARGUMENTS[kind](dataset, run)},
        time_limit=None if limit is None else as_time_limit(limit),
        n_cut=int((dataset["outcome"].to_numpy() == "time limit").sum()),
        surface=str(run["surface"]) if kind == "section" else None,
    )


def _starts(dataset: Dataset) -> Any:
    """The states at the first time, whatever the order of the dataset's dimensions."""
    return dataset["start"].transpose("trajectory", "component").to_numpy()


def _first_member(dataset: Dataset) -> int:
    """The number of the first member; what is drawn for a member follows from its number."""
    members = dataset["trajectory"].to_numpy()
    first = int(members[0]) if len(members) else 0
    if not np.array_equal(members, np.arange(first, first + len(members))):
        raise ValueError(f"trajectory: wanted members one after the other; got {shown(members.tolist())}")
    return first


def _recorded_orbit(dataset: Dataset, run: dict[str, Any]) -> dict[str, Any]:
    """The arguments of `integrate`, but for system and method."""
    times = dataset["time"].to_numpy()
    if float(times[0]) != run["start"]:
        raise ValueError(f"time: wanted times from {run['start']:g} on, where the starts are; got {times[0]:g}")
    tangents = dataset["start_tangent"].transpose("trajectory", "vector", "component")
    return {
        "starts": _starts(dataset),
        "times": times,
        "t_end": None,
        "tangents": tangents.to_numpy() if dataset.sizes["vector"] else None,
        "dense": bool(run["dense"]),
        "kernel": run["kernel"],
    }


def _recorded_growth(dataset: Dataset, run: dict[str, Any]) -> dict[str, Any]:
    """The arguments of `finite_time_exponents`, but for system and method; `t_end` is the last of the times."""
    return {
        "starts": _starts(dataset),
        "t_end": None,
        "times": dataset["time"].to_numpy(),
        "tangents": dataset["start_tangent"].transpose("trajectory", "component").to_numpy(),
        "seed": run["seed"],
        "first": _first_member(dataset),
    }


def _recorded_section(dataset: Dataset, run: dict[str, Any]) -> dict[str, Any]:
    """The arguments of `section`, but for system and method."""
    tape = _record(dataset, "surface")
    kept = dataset["coordinate" if "coordinate" in dataset.coords else "component"].to_numpy()
    return {
        "starts": _starts(dataset),
        "surface": TapeFunction(tape["n_components"], tape["instructions"], tape["outputs"]),
        "keep": tuple(map(str, kept)) if len(tape["outputs"]) > 1 else None,
        "t_end": run["t_end"],
        "direction": run["direction"],
        "n_crossings": run["n_crossings"],
    }


def _recorded_spectrum(dataset: Dataset, run: dict[str, Any]) -> dict[str, Any]:
    """The arguments of `lyapunov_spectrum`, but for system and method; zeros and pairs are those that were found."""
    names = ("n_zeros", "corank", "is_regular")
    known = names[0] in dataset
    return {
        "starts": _starts(dataset),
        "first": _first_member(dataset),
        "structure": PoissonStructure(*(dataset[name].to_numpy() for name in names)) if known else None,
        **{name: run[name] for name in ("t_end", "seed", "interval", "transient", "n_exponents", "covariant")},
    }


_ARGUMENTS = {
    "growth": _recorded_growth,
    "orbit": _recorded_orbit,
    "section": _recorded_section,
    "spectrum": _recorded_spectrum,
}


def _expect(name: str, got: object, *wanted: str) -> None:
    if not isinstance(got, str) or got not in wanted:
        raise ValueError(f"{name}: wanted {' or '.join(wanted)}; got {shown(got)}")
