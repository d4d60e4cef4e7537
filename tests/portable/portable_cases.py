"""Prints a hash of each kind of numbers that a seed decides: `test_portable.py` runs it as on other processors.

Names that are given are left out.
"""

import hashlib
import json
import sys
import warnings
from functools import partial

import numpy as np

import liepoisson as lp
from liepoisson import streams
from liepoisson.indicators.mean_error import mean_error
from liepoisson.numeric.sampling import sample_tangents
from liepoisson.portable import elementary, linear


def _start(system):
    return lp.sample_states(system, 1, seed=3)[0]


def _energy(system):
    return float(system.functions.energy(_start(system)))


def _starts(name, **options):
    return lp.sample_states(lp.catalog.system(name), 1000, seed=7, **options)


def _on_leaf(name):
    system = lp.catalog.system(name)
    return lp.Leaf.through(system, _start(system)).sample(16, seed=0)


def _on_level(system):
    system = lp.catalog.system(system) if isinstance(system, str) else system
    return lp.Leaf.through(system, _start(system)).sample(16, seed=0, energy=_energy(system))


def _fit():
    time = elementary.geomspace(10, 1000, 60)
    draw = streams.generator(1)
    curves = draw.normal(0.1, 0.01, (50, 1)) + draw.uniform(0.5, 2, (50, 1)) / np.sqrt(time)
    fit = lp.fits.finite_time_fit(time, curves, window=(10, 1000))
    return [[one.value, one.standard_error] for one in fit.estimates.values()]


def _frequencies():
    system = lp.catalog.system("henon-heiles")
    starts = 0.2 * lp.sample_states(system, 5, seed=2, ensemble="cube")
    return lp.chaos.frequency_drift(system, starts, t_end=200, observable=system.component_names[0]).frequency


def _mean_errors():
    walk = np.cumsum(streams.generator(3).standard_normal((3, 200)), axis=1)
    return mean_error(walk)


def _section_starts():
    system = lp.catalog.system("heavy-top")
    leaf = lp.Leaf.through(system, _start(system))
    return lp.sections.section_starts(leaf, "l3", energy=_energy(system), n_starts=20)


def _angles():
    top = lp.Top.twisted_kovalevskaya()
    states = lp.sample_states(top, 50, seed=1)
    return np.stack([lp.charts.EulerChart(top, state=x).from_body(x) for x in states])


def _vector_field():
    system = lp.catalog.system("double-pendulum")
    return system.vector_field(lp.sample_states(system, 1000, ensemble="cube"))


def _factors():
    matrices = streams.generator(2).standard_normal((50, 7, 7))
    U, S, Vh = linear.svd(matrices)
    found = linear.eig(matrices)
    parts = [U, S, Vh, *linear.qr(matrices), linear.inv(matrices), found.eigenvalues.real, found.eigenvectors.imag]
    return np.concatenate([part.ravel() for part in parts])


CASES = {
    "unit vectors": partial(_starts, "kovalevskaya"),
    "cube": partial(_starts, "zeitlin-3", ensemble="cube"),
    "gaussian": partial(_starts, "toda", ensemble="gaussian"),
    "gaussian, canonical": partial(_starts, "henon-heiles", ensemble="gaussian"),
    "unit vectors of three waves": partial(_starts, "three-wave"),
    "tangents": partial(sample_tangents, 9, 1000, seed=4),
    "normal numbers": lambda: streams.generator(5).standard_normal(100_000),
    "bootstrap of a fit": _fit,
    "frequencies": _frequencies,
    "mean errors": _mean_errors,
    "starts on a section": _section_starts,
    "Euler angles": _angles,
    "the field of a double pendulum": _vector_field,
    "singular vectors, roots, eigenvectors": _factors,
    **{f"leaf of {name}": partial(_on_leaf, name) for name in ("free-rigid-body", "zeitlin-3", "manakov-so4")},
    **{f"energy of {name}": partial(_on_level, name) for name in ("free-rigid-body", "heavy-top", "clebsch")},
    "energy of a twisted top": lambda: _on_level(lp.Top.twisted_kovalevskaya()),
}


def hash_of(numbers):
    return hashlib.sha256(np.ascontiguousarray(numbers, dtype=np.float64).tobytes()).hexdigest()[:16]


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    print(json.dumps({name: hash_of(numbers()) for name, numbers in CASES.items() if name not in sys.argv[1:]}))
