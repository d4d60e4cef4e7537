"""Solutions in complex time by our integrator: real and imaginary parts along straight paths are a real system."""

from itertools import pairwise

import numpy as np

import liepoisson as lp
from liepoisson.fields import QuadraticField


class _Along:
    """Equations of degree two at most with x = u + iv and t = t0 + s d, as rates of (u, v) by s."""

    def __init__(self, system, direction):
        self.name = f"{system.name} in complex time"
        self._field = doubled(system, direction)

    def field(self):
        return self._field


def doubled(system, d):
    """The real field of twice the dimension."""
    import sympy as sp

    x = system.variables
    n = len(x)
    constant, linear, quadratic = [], [], []
    for i, rate in enumerate(system.equations.values()):
        for powers, coefficient in sp.Poly(rate, *x).terms() if rate != 0 else ():
            where = [k for k, power in enumerate(powers) for _ in range(power)]
            c = complex(coefficient) * d
            if not where:
                constant += [(i, c.real), (n + i, c.imag)]
            elif len(where) == 1:
                (j,) = where
                linear += [(i, j, c.real), (i, n + j, -c.imag), (n + i, j, c.imag), (n + i, n + j, c.real)]
            else:
                j, k = where
                parts = [((j, k), 1), ((n + j, n + k), -1), ((j, n + k), 1j), ((k, n + j), 1j)]
                for pair, factor in parts:
                    value = c * factor
                    quadratic += [(i, *sorted(pair), value.real), (n + i, *sorted(pair), value.imag)]
    return QuadraticField(2 * n, tuple(constant), tuple(linear), tuple(quadratic))


def along(system, state, *path):
    """The state after a path of straight segments between complex times."""
    n = len(state)
    now = np.concatenate([np.real(state), np.imag(state)])
    for start, end in pairwise(path):
        length = abs(end - start)
        run = lp.integrate(_Along(system, (end - start) / length), now, times=[0, length], method=lp.Taylor(tol=1e-15))
        assert list(run.outcome) == ["finished"]
        now = run.end_state[0]
    return now[:n] + 1j * now[n:]
