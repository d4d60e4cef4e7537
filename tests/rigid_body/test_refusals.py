"""What has no single rotation, is no attitude, or is no rod."""

from functools import partial

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import ParameterError, ShapeError

TWISTED = lp.Top(inertia=(2, 1.5, 1), a=(-1, 0.3, 0.2), b=(0.4, 0, -0.7), epsilon=0.8)
LAGRANGE = lp.Top.twisted_lagrange(transverse=1, axial="2/3", a3=1, epsilon="1/2")
X0 = [1.0, 0, 0, 1, 0, 0, 0, 0, 0]
# so(3) (x) C = so(3, 1) is simple: e1 e1 = -e0, so e1 spans no ideal and there is no quotient of rotations
COMPLEX = lp.Extension.from_products(2, {(0, 0): {0: 1}, (0, 1): {1: 1}, (1, 1): {0: -1}})


def attitude(system=TWISTED, **options):
    x0 = options.pop("x0", np.ones(len(system.component_names)))
    return lp.orbits.attitude(system, x0, times=[0, 1], **options)


def rod(system=LAGRANGE, **options):
    return lp.orbits.rod(system, np.ones(len(system.component_names)), **options)


REFUSED = [
    *((partial(attitude, lp.catalog.system(name)), ParameterError, "no single rotation")
      for name in ("manakov-so4", "so21-heavy-top", "rattleback", "zeitlin-3")),
    (partial(attitude, lp.System(lp.so(3) @ COMPLEX, "dot(l, l)/2 + alpha3")), ParameterError, "no single rotation"),
    *((partial(attitude, x0=X0, attitude=bad), error, words) for bad, error, words in (
        ([1, 1, 0, 0], ParameterError, "unit quaternions"),
        ([np.nan, 0, 0, 1], ParameterError, "unit quaternions"),
        (-np.eye(3), ParameterError, "det R"),
        (2 * np.eye(3), ParameterError, "rotation matrices"),
        (np.ones((2, 4)) / 2, ShapeError, "attitude must have shape"),
        ("gravity", ParameterError, "alpha"),
        ("beta", ParameterError, "beta = 0"),
    )),
    (partial(lp.orbits.attitude, TWISTED.field(), X0, times=[0, 1]), ParameterError, "wanted a system"),
    (partial(attitude, lp.Top.heavy(inertia=("I1", 1, 1), a=(0, 0, 1))), ParameterError, "I1"),
    (partial(attitude, method=lp.Splitting(step=0.1, order=2)), ParameterError, "pieces"),
    (lambda: attitude().space(np.ones((5, 3))), ShapeError, "broadcast"),
    (lambda: attitude().at([0.5]), ParameterError, "dense"),
    (partial(rod, lp.Top.twisted_kovalevskaya(), length=1), ParameterError, "tangent"),  # a across
    (partial(rod, lp.catalog.system("kirchhoff"), length=1), ParameterError, "tangent"),  # quadratic in the field
    (partial(rod, lp.catalog.system("leibniz-lagrange-4"), length=1), ParameterError, r"f\^3"),  # four fields
    (partial(rod, lp.catalog.system("manakov-so4"), length=1), ParameterError, "rotation"),
    (rod, ParameterError, "neither"),
    (partial(rod, length=1, arclengths=[0, 1]), ParameterError, "both"),
    *((partial(rod, length=bad), ParameterError, "length") for bad in (0, np.nan, "long")),
    (partial(rod, length=1, n_points=1), ParameterError, "n_points"),
    (partial(rod, arclengths=[0, 1, 1]), ParameterError, "strictly"),
    (partial(rod, length=1, origin=[0, 0]), ShapeError, "origin"),
    (partial(rod, length=1, origin=[0, 0, np.inf]), ParameterError, "origin"),
]  # fmt: skip


@pytest.mark.parametrize(("call", "error", "words"), REFUSED)
def test_what_is_refused(call, error, words):
    with pytest.raises(error, match=words):
        call()
