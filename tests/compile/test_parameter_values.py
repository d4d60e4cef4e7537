"""Systems that differ in the value of a parameter alone share compiled code: the bits are those of the kernels."""

import json
import os
import subprocess
import sys

import pytest

import liepoisson as lp

VALUES = (0.7, 1.3, 0.0, -0.0, 1.0, -1.0, 2.0, 0.5, 0.25, 1e-300, -1e-300, 1e300, 2.0**-1000, 1 / 3, 1.3)
"""The first is compiled; at 0 terms vanish, at 1 and -1 a factor, at 2 the sum of two terms, and others are numbers
that all systems have; the last was there before."""
HAMILTONIAN = "p_q^2*(1 + (r - 2)*q^2/20)/2 - r*cos(q) + q^4/4 + r*q^2/(5*(3 + sin(q)))"
METHODS = (lp.Taylor(tol=1e-12, max_steps=4000), lp.RungeKutta(tol=1e-9, max_steps=4000))


def run(value, method):
    """Three orbits, long enough for their code to be compiled where they do not end early."""
    system = lp.System(lp.canonical(names=["q"]), HAMILTONIAN, {"r": value})
    starts = 0.3 * lp.sample_states(system, 3, seed=4)
    return lp.integrate(system, starts, times=[0, 400], tangents=[[1, 0.5]], method=method, threads=1)


def bits():
    """States, tangent vectors and ends of all values in turn, by hexadecimal digits."""
    found = []
    for method in METHODS:
        for value in VALUES:
            orbits = run(value, method)
            numbers = (orbits.state, orbits.tangent, orbits.end_state, orbits.end_time)
            found.append(
                [*(part.tobytes().hex() for part in numbers), orbits.n_steps.tolist(), orbits.outcome.tolist()]
            )
    return found


def test_orbits_are_long_enough_for_their_code():
    kernels = {run(value, method).kernel for value in VALUES[:5] for method in METHODS}
    assert len(kernels) == 1


@pytest.mark.thorough
def test_code_for_another_value_has_the_bits_of_the_kernels():
    program = "import json, test_parameter_values as this; print(json.dumps(this.bits()))"
    path = os.pathsep.join([os.path.dirname(__file__), *sys.path])
    environment = os.environ | {"LIEPOISSON_JIT": "0", "PYTHONPATH": path}
    command = [sys.executable, "-c", program]
    without = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    cases = [(method, value) for method in METHODS for value in VALUES]
    for case, ours, others in zip(cases, bits(), json.loads(without.stdout), strict=True):
        assert ours == others, case
