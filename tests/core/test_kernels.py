"""Every instruction set of this processor, chosen by the environment: the same bits, and honest names."""

import os
import subprocess
import sys

import pytest

from liepoisson import _core

PROGRAM = """
import hashlib, numpy as np, liepoisson as lp
top = lp.Top(inertia=(2, 1.5, 1), a=(-1, 0.3, 0.2), b=(0.4, 0, -0.7), epsilon=0.8)
energies = "l1^2/3 + l2^2/2 + l1*alpha2 + alpha3^2", "sqrt(1 + dot(l, l)) + sin(alpha1)/(3 + alpha2) + exp(l3/5)"
systems = [lp.System(lp.so(3) @ lp.semidirect(2), energy) for energy in energies]
x0 = lp.sample_states(top, 37, seed=1)
for threads in THREADS:
    growth = lp.finite_time_exponents(top, x0, t_end=30, threads=threads)
    orbit = lp.integrate(top, x0, times=[0, 5], tangents=np.eye(9)[:3], threads=threads)
    single = lp.integrate(top, x0[0], times=[0, 5], threads=threads)
    alone = lp.integrate(top, x0[0], times=[0, 5], kernel="lanes", threads=threads)
    assert np.array_equal(alone.state[0], lp.integrate(top, x0, times=[0, 5]).state[0])
    results = [growth.exponent, orbit.state, orbit.tangent, single.state]
    for method in (lp.Taylor(), lp.Taylor(precision="mixed")):
        spectrum = lp.lyapunov_spectrum(top, x0, t_end=30, interval=0.4, method=method, threads=threads)
        results += [spectrum.exponent, spectrum.end_state, spectrum.largest_ratio]
    for system in systems:
        start = lp.sample_states(system, 19, seed=2)
        other = lp.integrate(system, start, times=[0, 3], tangents=np.eye(6)[:2], threads=threads)
        assert (other.outcome == "finished").all()
        results += [other.state, other.tangent]
    print(growth.kernel, single.kernel, *(hashlib.sha256(array.tobytes()).hexdigest() for array in results))
"""


def run(simd, *threads):
    """The program with some numbers of threads, each of which prints a line."""
    program, environment = PROGRAM.replace("THREADS", str(threads)), {**os.environ, "LIEPOISSON_SIMD": simd}
    command = [sys.executable, "-c", program]
    return subprocess.run(command, env=environment, capture_output=True, text=True, check=False)


@pytest.mark.thorough
def test_bits_do_not_depend_on_the_instruction_set_or_the_threads():
    assert _core.available_simd()[-1] == "scalar"
    widest, single, *expected = run("", 1).stdout.split()  # a variable that is set to nothing counts as not set
    assert widest == _core.available_simd()[0]
    assert single == "components"
    for simd in _core.available_simd():
        lines = run(simd, 1, 2).stdout.splitlines()
        assert len(lines) == 2
        for line in lines:
            assert line.split() == [simd, "components", *expected]


COMPILED = """
import hashlib, liepoisson as lp
kinetic = "(p1^2 + 2*p2^2 - 2*p1*p2*cos(q1 - q2))/(2*(1 + sin(q1 - q2)^2))"
pendulum = lp.System(lp.canonical(2), f"{kinetic} - 2*cos(q1) - cos(q2)")
driven = lp.System(lp.canonical(names=["a", "x"], angles=["a"]), "(p_a^2 + p_x^2)/2 - cos(a)*cos(t) + x^4")
for system, start in ((pendulum, [0.4, -0.3, 0.2, 0.5]), (driven, [0.4, -0.3, 2.2, 0.5, 0, 0])):
    for method in (lp.Taylor(), lp.RungeKutta(tol=1e-9)):
        growth = lp.finite_time_exponents(system, [start] * 3, t_end=400, method=method)
        print(growth.kernel.split(",")[-1].strip(), hashlib.sha256(growth.exponent.tobytes()).hexdigest())
"""


@pytest.mark.thorough
@pytest.mark.skipif(
    not {"avx2", "avx512"} & set(_core.available_simd()) or sys.platform != "linux", reason="not compiled"
)
@pytest.mark.parametrize("simd", ["scalar", "avx2"])
def test_compiled_code_has_the_bits_of_the_kernels_and_says_that_it_ran(simd):
    results = {}
    for compiles in ("0", "1"):
        environment = {**os.environ, "LIEPOISSON_JIT": compiles, "LIEPOISSON_SIMD": simd}
        command = [sys.executable, "-c", COMPILED]
        output = subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout
        results[compiles] = [line.split() for line in output.splitlines()]
    assert [kernel for kernel, _ in results["0"]] == [simd] * 4
    assert [kernel for kernel, _ in results["1"]] == ["compiled"] * 4
    assert [bits for _, bits in results["0"]] == [bits for _, bits in results["1"]]


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["AVX512", "avx512" if "neon" in _core.available_simd() else "neon", "fast"])
def test_an_instruction_set_that_is_not_there_is_refused(name):
    result = run(name, 1)
    assert result.returncode != 0
    assert "ParameterError" in result.stderr
    assert f'wanted avx512, avx2, neon or scalar, on a processor that has it; got "{name}"' in result.stderr
