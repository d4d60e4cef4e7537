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


def _on_tori():
    pendulum, state = lp.catalog.system("spherical-pendulum"), [0.3, 0.8, 0.2, 0.8, 0, 0.6]
    sphere = lp.Leaf(pendulum, {"C1": 0, "C2": 1})
    plane = lp.tori.diagram(sphere, energy_max=2, n_starts=20)
    (region,) = lp.tori.regions(plane, n_values=50, n_states=10)
    crossings = lp.section(pendulum, state, surface="l1*alpha2 - l2*alpha1", direction=1, t_end=400)
    turns = lp.tori.rotation_number(crossings, ["alpha1", "alpha2"], center=[0, 0])
    found = [
        lp.tori.critical_states(sphere, n_starts=20).states,
        *(family.states for family in plane.families),
        plane.rest_states,
        region.values,
        region.fibre.states,
        region.fibre.torus,
        lp.tori.monodromy(pendulum, state, [[0, 0.2], [0.2, 0.2], [0.2, 0.1]]).periods,
        turns.value,
        turns.error,
    ]
    return np.concatenate([np.ravel(one) for one in found])


def _density():
    system = lp.catalog.system("kovalevskaya")
    states = lp.sample_states(system, 200, seed=2)
    return lp.sections.return_map(system, "alpha3", t_end=10).density(states, ["l1", "l2"])


def _on_spectral_curves():
    diagram = lp.tori.lagrange_diagram(lp.Leaf(lp.Top.twisted_lagrange(), {"C1": 0.5, "C2": 0.2, "C3": 1}))
    some = [[3 + k / 20, 0.5 - k / 77, 0.2 + k / 100] for k in range(25)]
    top = diagram.leaf.system
    found = [
        *(curve.values for curve in diagram.curves),
        *(curve.states for curve in diagram.curves),
        diagram.hopf_values,
        *diagram.boundary(0.3),
        diagram.depth(some),
        *(lp.tori.lagrange_lattice(diagram, values) for values in some),
        *(lp.tori.lagrange_actions(diagram, values) for values in some),
        *(lp.tori.period_lattice(top, x).periods for x in lp.sample_states(top, 3, seed=1)),
    ]
    return np.concatenate([np.ravel(one) for one in found])


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
    "measures of a map of return": _density,
    "diagrams, fibres and lattices": _on_tori,
    "diagrams and lattices on spectral curves": _on_spectral_curves,
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
