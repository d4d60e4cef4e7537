r"""Melnikov's integrals of sleeping tops, ordinary and twisted, against closed forms and the splitting itself.

With $M(\lambda) = \lambda^3e_3 + \lambda^2\ell + \lambda\alpha + \epsilon\beta$ ($I_1 = a_3 = 1$) the sleeping top is
$M = Q e_3$ with $Q = (\lambda - \mu)(\lambda^2 + l\lambda + A_0)$ and $\kappa^2 = A_0 - l^2/4 > 0$; $\mu = 0$ is the
ordinary top.  On its homoclinic surface $\ell_1 + i\ell_2 = 2\kappa\,\mathrm{sech}(\kappa t)\,e^{i(\psi - \Omega t)}$,
$\Omega = \ell_3(1/I_3 - 1/2) - \mu/2$.
"""

import time

import mpmath
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


def wells(rate):
    """Two double wells, turned against each other by 0.7 rad, with the rates 1 and `rate`; and an integral of both."""
    c, s = np.cos(0.7), np.sin(0.7)
    x, y, px, py = (f"({c}*{a} {sign} {s}*{b})" for a, b, sign in
                    (("x", "y", "-"), ("y", "x", "+"), ("px", "py", "-"), ("py", "px", "+")))  # fmt: skip
    second = f"{py}^2/2 - {rate}^2*{y}^2/2 + {y}^4/4"
    system = lp.System(lp.canonical(names=["x", "y"], momenta=["px", "py"]), f"{px}^2/2 - {x}^2/2 + {x}^4/4 + {second}")
    turn = np.kron(np.eye(2), [[c, s], [-s, c]])
    return system, second, f"{x}*{y}", turn


def on_loops(rate, times, delay):
    """States of the first well at some times and of the second one later by a delay, (x, y, px, py)."""
    x, y = 1 / np.cosh(times), rate / np.cosh(rate * (times + delay))
    return 2**0.5 * np.stack([x, y, -x * np.tanh(times), -rate * y * np.tanh(rate * (times + delay))], axis=-1)


RATES = (1, 1.5, 2, 2.25, 2.5, 3, 4, 6, 8)


@pytest.mark.parametrize("rate", RATES)
def test_rates_of_any_ratio(rate):
    """Of xy, with a quadrature of the exact orbits: along a ray round-off grows by up to e^(8t), while x falls by e^t.

    The value is that of the orbit, wherever on it the start is.
    """
    delay = 0.3
    system, integral, product, turn = wells(rate)
    origin = lp.phase_space.equilibrium(system, [0] * 4)
    starts = on_loops(rate, np.array([-1.5, -0.4, 0.0, 0.1, 0.5, 0.9]), delay) @ turn.T

    def integrand(t):
        late = rate * (t + delay)
        return 2 * rate**2 * mpmath.sech(t) * mpmath.sech(late) * mpmath.tanh(late)

    wanted = float(mpmath.quad(integrand, [-40, -10, -3, -1, 0, 1, 3, 10, 40]))
    found = lp.orbits.melnikov(system, starts, product, origin=origin, integrals=[integral])
    off = np.abs(found.value[:, 0] - wanted)
    assert off[2] < 5e-14, off
    assert (off <= found.error[:, 0]).all(), (off, found.error)
    assert found.error[1:4].max() < 1e-12, found.error


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("size", [1e-14, 1e-11, 1e-9])
def test_errors_of_starts_are_in_the_error(rate, size):
    """Starts beside the loops, on levels of both energies: the nearest homoclinic orbit is the exact one."""
    system, integral, product, turn = wells(rate)
    origin = lp.phase_space.equilibrium(system, [0] * 4)
    exact = on_loops(rate, np.zeros(1), 0.3)[0]
    slopes = exact[:2] ** 3 - np.array([1, rate**2]) * exact[:2]
    first, second = np.array([slopes[0], 0, exact[2], 0]), np.array([0, slopes[1], 0, exact[3]])
    sides = [a * first / np.linalg.norm(first) + b * second / np.linalg.norm(second) for a in (-1, 1) for b in (-1, 1)]
    starts = (exact + size * np.array([np.zeros(4), *sides])) @ turn.T
    found = lp.orbits.melnikov(system, starts, product, origin=origin, integrals=[integral])
    off = np.abs(found.value[1:, 0] - found.value[0, 0])
    assert (off <= found.error[1:, 0]).all(), (off, found.error)
    assert found.error.max() < 1e-10 + 1e3 * size


@pytest.mark.parametrize("turning", [0.3, 1, 5])
def test_saddle_foci(turning):
    r"""A double well in the plane that turns: of $x^2$, $\int 2xy\,dt = 4\pi\Omega\sin2\psi/\sinh\pi\Omega$."""
    system = lp.System(
        lp.canonical(names=["x", "y"], momenta=["px", "py"]),
        f"(px^2 + py^2)/2 - (x^2 + y^2)/2 + (x^2 + y^2)^2/4 + {turning}*(x*py - y*px)",
    )
    times = np.array([-2.5, -0.7, 0, 0.2, 1.0, 2.5])
    angle, r = 0.4 + turning * times, 2**0.5 / np.cosh(times)
    axes = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    starts = np.concatenate([r[:, None] * axes, -(r * np.tanh(times))[:, None] * axes], axis=1)
    origin = lp.phase_space.equilibrium(system, [0] * 4)
    found = lp.orbits.melnikov(system, starts, "x^2", origin=origin, integrals=["x*py - y*px"])
    wanted = 4 * np.pi * turning / np.sinh(np.pi * turning) * np.sin(0.8)
    off = np.abs(found.value[:, 0] - wanted)
    assert (off <= found.error[:, 0]).all(), (off, found.error)
    assert off.max() < 1e-14


def beside_the_flow(system, states, integral):
    """The length of X_K orthogonal to the flow."""
    gradient = system.functions.of(integral).gradient(states)
    field = np.einsum("nij,nj->ni", system.functions.poisson_tensor(states), gradient)
    flow = system.vector_field(states)
    flow /= np.linalg.norm(flow, axis=1, keepdims=True)
    return np.linalg.norm(field - (field * flow).sum(axis=1, keepdims=True) * flow, axis=1)


def adjoint_cases():
    """Systems, starts on homoclinic surfaces, equilibria, perturbations, integrals."""
    for rate in (1, 1.5, 3):
        system, integral, product, turn = wells(rate)
        starts = np.concatenate([on_loops(rate, np.array([-0.4, 0.2]), d) for d in (-0.6, -0.1, 0.3)]) @ turn.T
        yield system, starts, np.zeros(4), product, integral
    for case in TOPS:
        top, rest, middle = sleeping(*case)
        yield top, middle[[0, 1, 2, 5]], rest, "l1*l2 + alpha1", "l3"


@pytest.mark.parametrize("case", list(adjoint_cases()))
def test_the_adjoint_equation_has_the_gradient_of_the_integral(case):
    """With $X_K = aX_H + bv$, M_K is b times the integral of v, and b has one sign, as the orientation has."""
    system, starts, rest, perturbation, integral = case
    origin = lp.phase_space.equilibrium(system, rest)
    wanted = lp.orbits.melnikov(system, starts, perturbation, origin=origin, integrals=[integral])
    found = lp.orbits.melnikov(system, starts, perturbation, origin=origin)
    assert found.integrals == ("adjoint",)
    beside = beside_the_flow(system, starts, integral)
    sign = np.sign((wanted.value * found.value).sum())
    off = np.abs(wanted.value[:, 0] - sign * beside * found.value[:, 0])
    assert np.abs(wanted.value).max() > 1e-3
    assert (off <= wanted.error[:, 0] + beside * found.error[:, 0]).all(), (off, found.error)
    assert found.error.max() < 1e-11


def test_an_orbit_that_persists_has_no_integral():
    system = lp.System(
        lp.canonical(names=["x", "y"], momenta=["px", "py"]),
        "px^2/2 - x^2/2 + x^4/4 + py^2/2 - y^2 + y^4/4 + x^2*y^2/7",
    )
    origin = lp.phase_space.equilibrium(system, [0] * 4)
    with pytest.raises(lp.errors.OrbitError, match=r"orbit 0 are 1\.\d+ rad apart beside the flow"):
        lp.orbits.melnikov(system, [2**0.5, 0, 0, 0], "x*y", origin=origin)


def test_a_plane_has_nothing_beside_the_flow():
    duffing = lp.System(lp.canonical(1, names=["x"]), "p_x^2/2 - x^2/2 + x^4/4")
    with pytest.raises(lp.errors.ParameterError, match="two growing directions"):
        lp.orbits.melnikov(duffing, [2**0.5, 0], "x", origin=lp.phase_space.equilibrium(duffing, [0, 0]))


def test_orbits_that_were_found_by_newtons_method():
    """Middles that are known to 1e-9 only serve: the error says so."""
    system, integral, _, _ = wells(2.5)
    origin = lp.phase_space.equilibrium(system, [0] * 4)
    orbit = lp.orbits.symmetric_homoclinic_orbits(origin, n_starts=20)[0]
    found = lp.orbits.melnikov(system, orbit.midpoint, "x*px^2", origin=origin, integrals=[integral])
    assert found.error.max() < 1e-6


def test_many_starts_end_in_time():
    top = lp.System(lp.so(3) @ lp.semidirect(2), "dot(l, l)/2 + alpha3")
    upright = lp.phase_space.equilibrium(top, [0, 0, 0, 0, 0, 1])
    many = np.broadcast_to([2.0, 0, 0, 0, 0, -1], (300_000, 6))
    begin = time.process_time()
    with pytest.raises(lp.errors.TimeLimitError):
        lp.orbits.melnikov(top, many, "l1*l2", origin=upright, integrals=["l3"], time_limit=0.5, threads=1)
    assert time.process_time() - begin < 1.5


def test_the_same_bits_among_many():
    """Orbits are computed in blocks: the value of one does not depend on the others."""
    top, rest, middle = sleeping(*TOPS[0])
    given = {"origin": lp.phase_space.equilibrium(top, rest), "integrals": ["l3"]}
    many = lp.orbits.melnikov(top, np.tile(middle, (60, 1)), "alpha1", **given)
    alone = np.array([lp.orbits.melnikov(top, one, "alpha1", **given).value[0, 0] for one in middle])
    np.testing.assert_array_equal(many.value[:, 0], np.tile(alone, 60))


def test_no_starts():
    top, rest, _ = sleeping(*TOPS[0])
    limit = lp.phase_space.equilibrium(top, rest)
    found = lp.orbits.melnikov(top, np.zeros((0, 9)), "alpha1", origin=limit, integrals=["l3"])
    assert found.value.shape == found.error.shape == (0, 1)
    assert repr(found).startswith("<Melnikov: 0 orbits")
    assert lp.orbits.melnikov(top, np.zeros((0, 9)), "alpha1", origin=limit).value.shape == (0, 1)


def test_an_orbit_that_does_not_fit_into_memory(monkeypatch):
    top, rest, middle = sleeping(*TOPS[0])
    limit = lp.phase_space.equilibrium(top, rest)
    monkeypatch.setattr("liepoisson.inputs.arrays._memory", lambda: 4 * 4096.0)
    with pytest.raises(lp.errors.MemoryLimitError, match="origin"):
        lp.orbits.melnikov(top, middle, "alpha1", origin=limit, integrals=["l3"])


@pytest.mark.parametrize("slip", [0, 1e-6, 0.3, 2])
def test_rates_without_eigenvectors(slip):
    r"""The variations u of a double well with $c(p^2/2 + V)$ added: u = (a + ct)x', and Jordan blocks at the saddle.

    With $x = \sqrt2\,\mathrm{sech}\,t$; of $xu^2$, $-2\int uxx'dt = -2a\int xx'^2dt = -a\pi/\sqrt2$; c's part is odd.
    """
    energy = "pu^2/2 - x^2/2 + x^4/4"
    system = lp.System(lp.canonical(names=["x", "u"], momenta=["px", "pu"]), f"px*pu + (x^3 - x)*u + {slip}*({energy})")
    origin = lp.phase_space.equilibrium(system, [0] * 4)
    found = lp.orbits.melnikov(system, [2**0.5, 0, -0.4 * 2**0.5, 0], "u^2*x", origin=origin, integrals=[energy])
    assert abs(found.value[0, 0] + 0.4 * np.pi / 2**0.5) < 2e-15
    assert found.error[0, 0] < 1e-13


def on_the_first_top(time):
    """A state of the first of TOPS long after the middle of its orbit."""
    top, _, middle = sleeping(*TOPS[0])
    return lp.integrate(top, middle[0], times=[0, time]).state[0, -1]


REFUSED = (
    ({"integrals": ["l1"]}, "wanted constants of motion; l1 is none"),
    ({"integrals": []}, "at least one"),
    ({"integrals": "l3"}, "integrals"),
    ({"starts": [1.0, 0, 1, 0, 0, 1, 0, 0, 0]}, "no nearer than"),
    ({"origin": [0, 0, 1]}, "origin: wanted an equilibrium"),
    ({"perturbation": "l4"}, "l4"),
    (
        {"perturbation": "log(l1)"},
        "smooth at the equilibrium; the integrand of M for l3 has no derivative there, at l1 = 0",
    ),
    ({"perturbation": "log(l1)", "integrals": None}, "equilibrium; the integrand of M for adjoint has no derivative"),
    ({"perturbation": "sqrt(l1^2 + l2^2)*l1*l2/(l1^2 + l2^2)"}, "smooth at the equilibrium"),
    (
        {"perturbation": "l1*sqrt(alpha3)"},
        "smooth along the orbits; the integrand of M for l3 is no finite number at l1 = ",
    ),
    ({"starts": sleeping(*TOPS[0])[1]}, "orbit 0 starts at the equilibrium itself"),
    ({"starts": sleeping(*TOPS[0])[2] + 1e-6}, "at most 1.5e-08 of their size off; orbit 0 comes no nearer than"),
    ({"starts": on_the_first_top(8.0)}, "equilibrium is reached to 1e-07 of the orbit's size by t = -"),
    ({"starts": [1.0, 0, 1]}, "starts must have shape"),
    ({"starts": np.full(9, np.nan)}, "starts: wanted finite numbers"),
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
