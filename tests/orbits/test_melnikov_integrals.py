r"""Melnikov's integrals of sleeping tops, ordinary and twisted, against closed forms and the splitting itself.

With $M(\lambda) = \lambda^3e_3 + \lambda^2\ell + \lambda\alpha + \epsilon\beta$ ($I_1 = a_3 = 1$) the sleeping top is
$M = Q e_3$ with $Q = (\lambda - \mu)(\lambda^2 + l\lambda + A_0)$ and $\kappa^2 = A_0 - l^2/4 > 0$; $\mu = 0$ is the
ordinary top.  On its homoclinic surface $\ell_1 + i\ell_2 = 2\kappa\,\mathrm{sech}(\kappa t)\,e^{i(\psi - \Omega t)}$,
$\Omega = \ell_3(1/I_3 - 1/2) - \mu/2$.
"""

import numpy as np
import pytest

import liepoisson as lp

PSI = 2 * np.pi * np.arange(8) / 8
TOPS = [(0.6, 0.8, 0.3, 1.0), (1.0, 0.8, -0.5, 0.9), (0.7, -0.4, 0.2, 1.3), (2.0, 0.3, 0.0, 1.0), (0.5, 1.7, 0.0, 1.0)]
"""I3, l, mu, A0; the last but one has Omega = 0."""
EPSILON = 0.7


def sleeping(inertia, l, mu, height):
    """The top, its equilibrium, and the middles of homoclinic orbits with the angles PSI."""
    top = lp.Top(inertia=(1, 1, inertia), a=(0, 0, 1), b=(0, 0, 0), epsilon=EPSILON)
    rest = [0, 0, l - mu, 0, 0, height - mu * l, 0, 0, -mu * height / EPSILON]
    kappa = np.sqrt(height - l**2 / 4)
    turn = np.stack([np.cos(PSI), np.sin(PSI), 0 * PSI], axis=1)
    axis = np.array([0, 0, 1.0])
    m = 2 * kappa * turn + l * axis
    b = l * kappa * turn + (height - 2 * kappa**2) * axis
    return top, rest, np.concatenate([m - mu * axis, b - mu * m, -mu * b / EPSILON], axis=1)


@pytest.mark.parametrize("case", TOPS)
def test_closed_forms(case):
    r"""Of inertia, $-4\pi\kappa k/\sinh(\pi k/2)\sin2\psi$ with $k = 2\Omega/\kappa$; of tilt, with a cosh below."""
    inertia, l, mu, height = case
    top, rest, middle = sleeping(*case)
    limit = lp.phase_space.equilibrium(top, rest)
    kappa, omega = np.sqrt(height - l**2 / 4), (l - mu) * (1 / inertia - 0.5) - mu / 2
    k = 2 * omega / kappa
    weight = k / np.sinh(np.pi * k / 2) if abs(k) > 1e-12 else 2 / np.pi
    found = lp.orbits.melnikov(top, middle, "(l1^2 - l2^2)/2", origin=limit, integrals=["l3"])
    np.testing.assert_allclose(found.value[:, 0], -4 * np.pi * kappa * weight * np.sin(2 * PSI), atol=1e-12)
    assert found.error.max() < 1e-10
    tilted = lp.orbits.melnikov(top, middle, "alpha1", origin=limit, integrals=["l3"])
    wanted = 2 * np.pi * (l - mu) * (1 / inertia - 1) / np.cosh(np.pi * omega / 2 / kappa) * np.sin(PSI)
    np.testing.assert_allclose(tilted.value[:, 0], wanted, atol=1e-12)
    if inertia == 1:  # I1 = I3: any axis is one of symmetry, and the tilted top is integrable
        assert np.abs(tilted.value).max() < 1e-14


def splitting(system, rest, direction):
    """The value of l3 on a manifold where alpha3 is least, as a function of the angle of l: coefficients of Fourier."""
    values, vectors = np.linalg.eig(system.functions.jacobian(rest))
    v = vectors[:, np.argmax(direction * values.real)]
    phases = np.exp(2j * np.pi * np.arange(48) / 48)
    starts = rest + 1e-7 * (phases[:, None] * v / np.abs(v).max()).real
    run = lp.section(
        system, starts, surface="l1*alpha2 - l2*alpha1", direction=0, t_end=direction * 60, n_crossings=1,
        method=lp.Taylor(tol=1e-15),
    )  # fmt: skip
    state = run.state.reshape(48, -1)
    psi = np.arctan2(state[:, 1], state[:, 0])
    modes = np.arange(-10, 11)
    return np.linalg.lstsq(np.exp(1j * psi[:, None] * modes), state[:, 2].astype(complex), rcond=None)[0], modes


@pytest.mark.thorough
@pytest.mark.parametrize("case", [TOPS[0], (0.6, 0.8, 0.0, 1.0)])
def test_manifolds_split_by_it_up_to_the_square_of_the_perturbation(case):
    top, rest, middle = sleeping(*case)
    rest = np.array(rest)
    limit = lp.phase_space.equilibrium(top, rest)
    wanted = lp.orbits.melnikov(top, middle, "(l1^2 - l2^2)/2", origin=limit, integrals=["l3"]).value[:, 0]
    off = []
    for size in (1e-2, 1e-3, 1e-4):
        tilted = lp.Top(inertia=(1 / (1 + size), 1 / (1 - size), case[0]), a=(0, 0, 1), b=(0, 0, 0), epsilon=EPSILON)
        unstable, modes = splitting(tilted, rest, 1)
        stable, _ = splitting(tilted, rest, -1)
        at = (np.exp(1j * PSI[:, None] * modes) @ (unstable - stable)).real / size
        off.append(np.abs(at - wanted).max() / np.abs(wanted).max())
    assert off[0] < 1e-3
    np.testing.assert_allclose(off[1:], [off[0] / 100, off[0] / 10_000], rtol=0.01)


REFUSED = (
    ({"integrals": ["l1"]}, "wanted constants of motion; l1 is none"),
    ({"integrals": []}, "at least one"),
    ({"integrals": "l3"}, "integrals"),
    ({"starts": [1.0, 0, 1, 0, 0, 1, 0, 0, 0]}, "no nearer than"),
    ({"origin": [0, 0, 1]}, "origin: wanted an equilibrium"),
    ({"perturbation": "l4"}, "l4"),
)


@pytest.mark.parametrize(("given", "words"), REFUSED)
def test_what_is_refused(given, words):
    top, rest, middle = sleeping(*TOPS[0])
    limit = lp.phase_space.equilibrium(top, rest)
    given = {"starts": middle, "perturbation": "alpha1", "origin": limit, "integrals": ["l3"]} | given
    with pytest.raises(lp.errors.LiePoissonError, match=words):
        lp.orbits.melnikov(top, **given)


def test_a_stable_sleeping_top_has_no_homoclinic_orbits():
    top, _, middle = sleeping(*TOPS[0])
    limit = lp.phase_space.equilibrium(top, [0, 0, 3, 0, 0, 1, 0, 0, 0])
    with pytest.raises(lp.errors.ParameterError, match="growing direction"):
        lp.orbits.melnikov(top, middle, "alpha1", origin=limit, integrals=["l3"])
