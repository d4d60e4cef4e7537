"""Work counters: how many steps each method takes, and of which order, on fixed starts.

The numbers are the same on every machine. They change when the choice of steps does: then look whether the error
follows the tolerance as before (`make audit`), and put in the new ones.
"""

from __future__ import annotations

import numpy as np
import pytest

import liepoisson as lp

TOP = lp.Top.twisted_kovalevskaya()
WORK = [
    (lp.Taylor(), 24, 2231),
    (lp.Taylor(tol=1e-13), 21, 2260),
    (lp.Taylor(tol=1e-8), 15, 1982),
    (lp.Taylor(tol=1e-9, precision="mixed"), 16, 1873),
    (lp.RungeKutta(tol=1e-8), 8, 3094),
    (lp.RungeKutta(tol=1e-12), 8, 9630),
    (lp.RungeKutta(tol=1e-5, precision="single"), 8, 1358),
    (lp.Splitting(step=0.3), 4, 16 * 167),  # ceil(50 / 0.3)
    (lp.Gauss(step=0.3), 4, 16 * 167),
]


@pytest.mark.parametrize(("method", "order", "n_steps"), WORK, ids=[str(method) for method, *_ in WORK])
def test_steps_and_order_are_as_recorded(method: lp.Taylor, order: int, n_steps: int) -> None:
    x0 = lp.sample_states(TOP, 16, seed=4)
    orbit = lp.integrate(TOP, x0, times=[0, 50], tangents=np.eye(9)[:1], method=method)
    assert (orbit.order, int(orbit.n_steps.sum())) == (order, n_steps)


def test_steps_of_a_quadratic_field_are_as_recorded() -> None:
    manakov = lp.catalog.system("manakov-so4")
    orbit = lp.integrate(manakov, lp.sample_states(manakov, 16, seed=4), times=[0, 50], method=lp.Taylor(tol=1e-13))
    assert (orbit.order, int(orbit.n_steps.sum())) == (21, 125)
