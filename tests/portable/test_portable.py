"""What a seed decides is the same bits on every processor, and nothing in the package asks a library that is not."""

import ast
import itertools
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import liepoisson
from liepoisson import streams
from liepoisson.orbits import unstable_spaces
from liepoisson.portable import elementary, linear

ROOT = Path(liepoisson.__file__).parent
REPOSITORY = Path(__file__).parents[2]
RECORD = Path(__file__).parent / "portable.json"
"""Hashes of what `portable_cases.py` makes; `python tests/portable/portable_cases.py` prints them."""


PROCESSORS = ("native", "avx2", "no-avx")
TWINS = ("leaf of zeitlin-3", "leaf of manakov-so4", "energy of heavy-top", "energy of clebsch")
"""Cases that do what another one does, on a bracket of another dimension."""


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("processor", "without"),
    [
        *[(processor, TWINS) for processor in PROCESSORS],
        *[pytest.param(processor, (), marks=pytest.mark.slow) for processor in PROCESSORS],
    ],
)
def test_a_seed_means_the_same_bits_on_every_processor(processor, without):
    """Starts of eleven systems, fits, frequencies, factors, tori, as on processors without AVX-512 and without AVX."""
    if processor != "native" and not (sys.platform == "linux" and os.uname().machine == "x86_64"):
        pytest.skip("other processors are imitated on Linux on x86-64")
    program = [sys.executable, "tests/portable/portable_cases.py", *without]
    command = [sys.executable, ".ci/as_processor.py", processor, *program]
    done = subprocess.run(command, cwd=REPOSITORY, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    wanted = json.loads(RECORD.read_text())
    assert json.loads(done.stdout) == {name: wanted[name] for name in wanted if name not in without}


def test_normal_numbers_are_those_of_numpy():
    """To the last two units: NumPy's tail has the logarithm of the system's library."""
    found, wanted = streams.generator(1).standard_normal(300_000), np.random.default_rng(1).standard_normal(300_000)
    assert (np.abs(wanted) > 3.6541528853610088).sum() > 50
    assert np.allclose(found, wanted, rtol=1e-15, atol=0)
    for seed in range(20):  # what follows a number in the tail is the same
        one, other = streams.generator(seed), np.random.default_rng(seed)
        one.standard_normal(1000), other.standard_normal(1000)
        assert one.random() == other.random()


# Files that draw figures or word numbers, after everything was computed; the last one checks what it finds exactly.
DISPLAY = ("plot", "laboratory", "cli", "studies", "integrability/painleve/balance.py")
# Here @ joins an algebra and an extension.
OF_ALGEBRAS = {
    "catalog/families.py", "catalog/unital_tops.py", "structure/casimirs.py", "report/motion_facts.py",
    "model/bracket_reader.py",
    "model/top_parameters.py", "structure/trace_casimirs.py", "equilibrium/euler_characteristic.py", "model/tops.py",
}  # fmt: skip
FORBIDDEN = {
    "einsum", "dot", "vdot", "inner", "matmul", "tensordot", "roots", "poly", "polyfit", "cov", "corrcoef", "convolve",
    "correlate", "interp", "geomspace", "logspace", "power", "float_power", *elementary.FUNCTIONS,
}  # fmt: skip
"""Functions of NumPy whose rounding depends on the processor, its instruction set or its compiler."""
ALLOWED = {
    *("random.SeedSequence", "random.PCG64", "random.Generator"),
    "catalog/families.py: einsum",  # the vorticity of states on a grid, for pictures
}


def uses(path):
    """Names of NumPy's functions that are forbidden, and products of matrices, with their lines."""
    own = path.relative_to(ROOT).as_posix()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.MatMult) and own not in OF_ALGEBRAS:
            yield "@", node.lineno
        elif isinstance(node, ast.Attribute):
            name = ast.unparse(node)
            if name.startswith(("np.linalg.", "np.fft.", "np.random.", "numpy.linalg", "scipy.")):
                yield name.removeprefix("np."), node.lineno
            elif name.startswith("np.") and name[3:] in FORBIDDEN:
                yield name[3:], node.lineno


def test_nothing_between_a_seed_and_a_result_depends_on_the_processor():
    """No BLAS, no LAPACK, no function of NumPy with kernels for several processors, but in what draws and words."""
    found = []
    for path in sorted(ROOT.rglob("*.py")):
        own = path.relative_to(ROOT).as_posix()
        if not own.startswith(DISPLAY):
            found += [f"{own}:{line}: {name}" for name, line in uses(path) if not {name, f"{own}: {name}"} & ALLOWED]
    assert not found, "use liepoisson.portable or liepoisson.streams:\n" + "\n".join(found)


SHAPES = [
    *[((3,), (3,)), ((2, 3), (3,)), ((3,), (3, 4)), ((2, 3), (3, 4)), ((0, 3), (3, 2)), ((2, 0), (0, 3))],
    *[((5, 2, 3), (3, 4)), ((2, 3), (5, 3, 4)), ((7, 1, 2, 3), (5, 3, 4))],
]


@pytest.mark.parametrize(("one", "other"), SHAPES)
@pytest.mark.parametrize("unit", [1.0, 1.0 + 0.5j])
def test_products_are_those_of_numpy(one, other, unit):
    draw = np.random.default_rng(0)
    a, b = draw.normal(size=one) * unit, draw.normal(size=other)
    assert np.shape(linear.matmul(a, b)) == np.shape(a @ b)
    assert np.allclose(linear.matmul(a, b), a @ b, rtol=1e-14, atol=1e-14)


SUMS = {
    "...i,...i->...": [(4, 3), (4, 3)],
    "i,i->": [(3,), (3,)],
    "ni,nij,nj->n": [(5, 3), (5, 3, 3), (5, 3)],
    "mij,...j->...im": [(3, 2, 5), (4, 5)],
    "rimj,rj->rim": [(4, 3, 2, 5), (4, 5)],
    "ij...,...i->...j": [(3, 2, 7), (7, 3)],
    "...ii->...": [(4, 3, 3)],
    "...m,mij->...ij": [(6, 4, 3), (3, 2, 5)],
    "...b,...ib->...i": [(4, 3), (6, 4, 2, 3)],
    "...ij,...j->...i": [(6, 4, 2, 3), (4, 3)],
    "...ij,...ji->...": [(4, 3, 3), (4, 3, 3)],
    "iab,jba->ij": [(3, 3, 3), (3, 3, 3)],
    "ai,abk,bj->ijk": [(3, 2), (3, 3, 4), (3, 2)],
    "...mn,mx,ny->...yx": [(2, 3, 3), (3, 4), (3, 5)],
}


@pytest.mark.parametrize("subscripts", SUMS)
def test_sums_by_indices_are_those_of_numpy(subscripts):
    draw = np.random.default_rng(1)
    operands = [draw.normal(size=shape) for shape in SUMS[subscripts]]
    assert np.allclose(linear.einsum(subscripts, *operands), np.einsum(subscripts, *operands), rtol=1e-13, atol=1e-14)


@pytest.mark.parametrize("shape", [(3, 3), (4, 3), (3, 4), (6, 5, 3), (6, 3, 5), (0, 3, 3), (3, 0), (2, 9, 9)])
def test_factors_multiply_to_the_matrix(shape):
    a = np.random.default_rng(2).normal(size=shape)
    for full in (False, True):
        U, S, Vh = linear.svd(a, full_matrices=full)
        assert [part.shape for part in (U, S, Vh)] == [part.shape for part in np.linalg.svd(a, full_matrices=full)]
        k = S.shape[-1]
        assert np.allclose((U[..., :k] * S[..., None, :]) @ Vh[..., :k, :], a)
        assert np.allclose(np.swapaxes(U, -1, -2) @ U, np.eye(U.shape[-1]))
    for mode in ("reduced", "complete"):
        Q, R = linear.qr(a, mode=mode)
        assert [Q.shape, R.shape] == [part.shape for part in np.linalg.qr(a, mode=mode)]
        assert np.allclose(Q @ R, a)
        assert np.allclose(np.swapaxes(Q, -1, -2) @ Q, np.eye(Q.shape[-1]))
    assert np.allclose(linear.pinv(a), np.linalg.pinv(a))


def test_solutions_determinants_and_eigenvalues_are_those_of_numpy():
    draw = np.random.default_rng(3)
    a, b, c = draw.normal(size=(5, 4, 4)), draw.normal(size=(5, 4, 2)), draw.normal(size=(6, 3)) + 1j
    square = a @ np.swapaxes(a, 1, 2)
    hermitian = c.conj().T @ c
    for mine, theirs in [
        (linear.solve(a, b), np.linalg.solve(a, b)),
        (linear.solve(a[0], b[0, :, 0]), np.linalg.solve(a[0], b[0, :, 0])),
        (linear.inv(a), np.linalg.inv(a)),
        (linear.det(a), np.linalg.det(a)),
        (linear.slogdet(a)[1], np.linalg.slogdet(a)[1]),
        (linear.cholesky(square), np.linalg.cholesky(square)),
        (linear.eigvalsh(square), np.linalg.eigvalsh(square)),
        (linear.eigvalsh(hermitian), np.linalg.eigvalsh(hermitian)),
        (linear.pinv(c), np.linalg.pinv(c)),
        (linear.solve(hermitian, c[:3]), np.linalg.solve(hermitian, c[:3])),
        (linear.lstsq(a[0, :, :3], b[0])[0], np.linalg.lstsq(a[0, :, :3], b[0])[0]),
        (linear.cond(a), np.linalg.cond(a)),
        (np.sort_complex(linear.eigvals(a[0])), np.sort_complex(np.linalg.eigvals(a[0]))),
        (np.sort_complex(linear.roots([0, 1, 2, 3, 4, 0])), np.sort_complex(np.roots([0, 1, 2, 3, 4, 0]))),
        (linear.cov(b[:, :, 0]), np.cov(b[:, :, 0], rowvar=False)),
        (linear.poly([1, 2j, -2j]), np.poly([1, 2j, -2j])),
        (linear.fft(b[0, :, 0], 8), np.fft.fft(b[0, :, 0], 8)),
    ]:
        assert np.shape(mine) == np.shape(theirs)
        assert np.allclose(mine, theirs, rtol=1e-9, atol=1e-11)
    values, vectors = linear.eig(a)
    assert np.allclose(a @ vectors, vectors * values[:, None, :])


def test_what_has_no_factors_is_refused_or_unknown():
    bad = np.array([[np.nan, 1.0], [0.0, 1.0]])
    for function in (linear.svd, linear.eigvals, linear.pinv):
        with pytest.raises(linear.LinAlgError):
            function(bad)
    with pytest.raises(linear.LinAlgError):
        linear.solve(np.ones((2, 2)), np.ones(2))
    with pytest.raises(linear.LinAlgError):
        linear.cholesky(-np.eye(2))
    assert np.isnan(linear.qr(bad).Q).all()
    assert np.isnan(linear.solve(bad, np.ones(2))).all()


@pytest.mark.parametrize("name", sorted({*elementary.FUNCTIONS} - {"arctan2", "hypot", "power", "arccosh"}))
def test_elementary_functions_are_right_to_two_units(name):
    x = np.random.default_rng(4).uniform(0.01, 0.99, 1000)
    assert np.allclose(elementary.FUNCTIONS[name](x), getattr(np, name)(x), rtol=5e-16, atol=0)


def test_eigenvectors_where_francis_steps_and_balancing_are_hard():
    """Of saddle foci +-1 +- ih, whose shifts wander (Day 1996), and beside zeros that are round-off."""
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(4, 4)))[0]
    cases = [turn @ np.kron(np.diag([1, -1]), [[1, 10.0**-k], [-(10.0**-k), 1]]) @ turn.T for k in range(1, 17)]
    cases += [np.array([[-2, 2, 1e-16], [1e-16, 2, 0], [-2, -2, -2]]), np.array([[1.0, 1, 0], [-2, 2, -1], [0, 2, 1]])]
    for matrix in cases:
        values, vectors = linear.eig(matrix)
        assert np.abs(matrix @ vectors - vectors * values).max() < 1e-13


def test_the_unstable_space_of_a_defective_saddle():
    """q' = J q with Jordan blocks 1 and -1: the space of the block of 1 is q1, q2, however its vectors are ordered."""
    jordan = np.array([[1.0, 1, 0, 0], [0, 1, 0, 0], [0, 0, -1, 0], [0, 0, 1, -1]])
    for order in itertools.permutations(range(4)):
        basis, rates = unstable_spaces._invariant(jordan[np.ix_(order, order)], 2, of_rates=True)
        assert np.allclose(np.linalg.eigvals(rates), 1, atol=1e-7)
        assert np.allclose(basis[[order.index(2), order.index(3)]], 0, atol=1e-7)


def test_complex_numbers_at_the_ends_of_the_range():
    found = elementary.exp(np.array([1000 + 0j, 709.9 + 0.5j, -1000 + 1j, complex(0, -0.0)]))
    assert found[0] == np.inf
    assert found[0].imag == 0
    assert np.allclose(found[1], np.exp(709.9 + 0.5j), rtol=1e-13)
    assert found[2] == 0
    assert np.signbit(found[3].imag)


def test_what_these_functions_do_not_have_is_refused():
    for call in (
        lambda: elementary.sin(1j),
        lambda: elementary.geomspace(0, 1),
        lambda: linear.einsum("aaa->", np.zeros((2, 2, 2))),
        lambda: linear.einsum("i...->i...", np.zeros((2, 2))),
        lambda: linear.norm([1.0], ord=1),
        lambda: linear.det(np.zeros((3, 0))),
        lambda: linear.cholesky(np.zeros((3, 0))),
        lambda: streams.generator(0).normal(0, -1),
    ):
        with pytest.raises((TypeError, ValueError, linear.LinAlgError)):
            call()
    assert elementary.geomspace(1, 1000, 4).tolist() == [1, 10, 100, 1000]
    assert elementary.interp([-1, 0, 0.5, 1, 3], [0, 1, 2], [3.0, 5.0, 1.0]).tolist() == [3, 3, 4, 5, 1]
    assert np.isclose(linear.pinv(np.diag([1, -1.1e-15]))[1, 1], -1 / 1.1e-15)
    assert np.isclose(linear.lstsq(np.diag([1, -1e-17]), np.array([0.0, 1]), rcond=1e-20)[0][1], -1e17)
    assert linear.norm(np.array([250, 250], dtype=np.uint8)) == np.hypot(250, 250)
    assert np.array_equal(elementary.power([1.0, 2.0], 2), [1, 4])
    assert len(set(streams.generator(0).normal(np.zeros(5)).tolist())) == 5
    assert linear.cond(np.zeros((2, 2))) == np.inf


def test_streams_keep_their_numbers():
    """A seed gives the same starts for ever: a purpose that is new gets a number that was never used."""
    assert {one.name: one.value for one in streams.Purpose} == {
        "STATES": 0, "TANGENTS": 1, "FRAMES": 2, "TRIANGLES": 3, "ALIGNMENT": 4, "EQUILIBRIA": 5, "LEAF": 10,
        "CHAINS": 11, "SYMMETRIC_ORBITS": 12, "HOMOCLINIC_ORBITS": 13, "PERIODIC_ORBITS": 14, "CONNECTING_ORBITS": 15,
        "DIRECTIONS": 16, "PERIOD_LATTICE": 17, "CRITICAL_POINTS": 18, "FIBRES": 19, "NOISE": 30, "SECTION": 0x5EC7,
    }  # fmt: skip
