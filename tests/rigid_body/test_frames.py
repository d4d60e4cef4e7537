"""The attitude along an orbit: against scipy's rotations, space-frame laws, Euler angles, reversal, bad input."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

import liepoisson as lp
from liepoisson.rigid_body.frames import quaternion_of, rotation_matrix

HEAVY = lp.Top.heavy(inertia=(2, 1.5, 1), a=(0.3, -0.4, 1))
TWISTED = lp.Top(inertia=(2, 1.5, 1), a=(-1, 0.3, 0.2), b=(0.4, 0, -0.7), epsilon=0.8)
TIMES = np.linspace(0, 10, 201)


def unit_quaternions(n, seed):
    q = np.random.default_rng(seed).standard_normal((n, 4))
    return q / np.linalg.norm(q, axis=1, keepdims=True)


def derivative(t, values):
    """By a cubic spline: error of the order of the third power of the distance of the points."""
    return CubicSpline(t, values, axis=1)(t, 1)


@settings(max_examples=10)
@given(st.integers(0, 10_000))
def test_quaternion_and_rotation_matrix_agree_with_scipy(seed):
    """SciPy has the scalar last and the same rotation, v -> q v q*."""
    q = unit_quaternions(5, seed)
    R = rotation_matrix(q)
    assert np.abs(R - Rotation.from_quat(q[:, [1, 2, 3, 0]]).as_matrix()).max() < 1e-15
    back = quaternion_of(R)
    assert np.abs(back * np.sign(np.sum(back * q, axis=1, keepdims=True)) - q).max() < 1e-15


def test_orbit_is_that_of_the_system_alone():
    """The same field in other kernels: round-off of 10 time units, grown by the exponent of the orbits."""
    x0 = lp.sample_states(TWISTED, 4, seed=3)
    run = lp.orbits.attitude(TWISTED, x0, times=TIMES)
    assert run.state.shape == (4, 201, 9)
    assert run.quaternion.shape == (4, 201, 4)
    assert np.abs(run.state - lp.integrate(TWISTED, x0, times=TIMES).state).max() < 1e-12
    assert np.abs(run.norm_error).max() < 1e-14
    assert set(run.outcome) == {"finished"}
    assert np.abs(run.body(run.space("l")) - run.state[..., :3]).max() < 1e-14
    assert np.abs(run.angular_velocity - run.state[..., :3] / [2, 1.5, 1]).max() < 1e-15


def test_free_rigid_body_keeps_its_momentum_in_space():
    top = lp.Top.free_rigid_body(inertia=(3, 2, 1))
    run = lp.orbits.attitude(top, lp.sample_states(top, 5, seed=1), times=np.linspace(0, 50, 101))
    assert np.ptp(run.space("l"), axis=1).max() < 1e-12


def test_ordinary_top_keeps_its_fields_in_space_and_torque_changes_the_momentum():
    """(R l)' = R (alpha x a) = g x R a with the fixed vector g = R alpha."""
    x0 = lp.sample_states(HEAVY, 3, seed=5)
    run = lp.orbits.attitude(HEAVY, x0, times=np.linspace(0, 10, 2001))
    assert np.ptp(run.space("alpha"), axis=1).max() < 1e-12
    torque = np.cross(run.space("alpha"), run.space([0.3, -0.4, 1]))
    assert np.abs(derivative(run.time, run.space("l")) - torque).max() < 1e-5


def test_twisted_top_keeps_beta_in_space_and_turns_alpha():
    """(R alpha)' = eps R (beta x a): alpha is not fixed in space, so a formula of the ordinary top would fail."""
    run = lp.orbits.attitude(TWISTED, lp.sample_states(TWISTED, 3, seed=5), times=np.linspace(0, 10, 2001))
    assert np.ptp(run.space("beta"), axis=1).max() < 1e-12
    assert np.ptp(run.space("alpha"), axis=1).max() > 0.1
    a, b = run.space([-1, 0.3, 0.2]), run.space([0.4, 0, -0.7])
    alpha, beta = run.space("alpha"), run.space("beta")
    assert np.abs(derivative(run.time, alpha) - 0.8 * np.cross(beta, a)).max() < 1e-5
    assert np.abs(derivative(run.time, run.space("l")) - np.cross(alpha, a) - np.cross(beta, b)).max() < 1e-5


def test_lagrange_top_has_the_euler_angles_of_the_textbook():
    r"""R = Rz(phi) Rx(theta) Rz(psi), phi' = (L - l3 cos theta)/(I1 sin^2 theta), psi' = l3/I3 - phi' cos theta.

    L is the momentum about the vertical; theta'' follows from the energy, and theta is compared by cos theta = alpha3.
    """
    top = lp.Top.lagrange(transverse=1, axial="1/2", a3=1)
    x0 = np.array([0.4, 0.3, 1.5, 0.6, 0.0, 0.8, 0, 0, 0])
    run = lp.orbits.attitude(top, x0, times=[0, 10], attitude="alpha", dense=True)
    l3, vertical = x0[2], x0[:3] @ x0[3:6]

    def rates(t, _):
        cosine = run.at([t]).state[0, 0, 5]
        phi = (vertical - l3 * cosine) / (1 - cosine**2)
        return [phi, 2 * l3 - phi * cosine]

    angles = solve_ivp(rates, (0, 10), [0, 0], method="DOP853", rtol=1e-11, atol=1e-11, t_eval=np.linspace(0, 10, 41))
    R = run.at(angles.t).rotation[0]
    phi = np.unwrap(np.arctan2(R[:, 0, 2], -R[:, 1, 2]))
    psi = np.unwrap(np.arctan2(R[:, 2, 0], R[:, 2, 1]))
    theta = np.arccos(run.at(angles.t).state[0, :, 5])
    assert np.abs(phi - phi[0] - angles.y[0]).max() < 1e-9
    assert np.abs(psi - psi[0] - angles.y[1]).max() < 1e-9
    assert np.abs(R[:, 2, 2] - np.cos(theta)).max() < 1e-12


@pytest.mark.parametrize("sign", [1, -1])
def test_a_named_field_starts_upright(sign):
    x0 = lp.sample_states(TWISTED, 20, seed=2)
    x0[0, 6:] = [0, 0, 2]
    x0[1, 6:] = [1e-9, 0, -2]
    run = lp.orbits.attitude(TWISTED, sign * x0, times=[0, 1], attitude="beta")
    length = np.linalg.norm(x0[:, 6:], axis=1)[:, None]
    assert np.abs(run.space("beta")[:, 0] / length - [0, 0, 1]).max() < 1e-15


def test_attitudes_compose_and_runs_reverse():
    """Another attitude at the start is a rotation of space; the run back ends where it began."""
    x0, q0 = lp.sample_states(TWISTED, 3, seed=4), unit_quaternions(3, 6)
    plain, turned = (
        lp.orbits.attitude(TWISTED, x0, times=TIMES),
        lp.orbits.attitude(TWISTED, x0, times=TIMES, attitude=q0),
    )
    assert np.abs(rotation_matrix(q0)[:, None] @ plain.rotation - turned.rotation).max() < 1e-13
    by_matrix = lp.orbits.attitude(TWISTED, x0, times=TIMES, attitude=rotation_matrix(q0))
    assert np.abs(by_matrix.rotation - turned.rotation).max() < 1e-13
    back = lp.orbits.attitude(TWISTED, turned.state[:, -1], times=TIMES[::-1], attitude=turned.quaternion[:, -1])
    assert np.abs(back.quaternion[:, -1] - q0).max() < 1e-11
    assert np.abs(back.state[:, -1] - x0).max() < 1e-11
    x0[0, 8] = np.inf
    bad = lp.orbits.attitude(TWISTED, x0, times=[0, 1], attitude="beta")
    assert list(bad.outcome) == ["not finite", "finished", "finished"]
    assert np.isnan(bad.quaternion[0, 1]).all()


@pytest.mark.parametrize("name", ["kirchhoff", "zhukovsky-volterra-gyrostat", "goryachev"])
def test_other_systems_on_so3_have_an_attitude(name):
    """omega = dH/dl is not l/I for Kirchhoff's equations or a gyrostat; the last field there is fixed in space."""
    system = lp.catalog.system(name)
    x0 = lp.sample_states(system, 2, seed=7)
    if name == "goryachev":
        x0[:, 5] = 1.0  # its potential has a pole at p3 = 0
    run = lp.orbits.attitude(system, x0, times=[0, 0.3])
    last = system.bracket.field_names[-1]
    fixed = run.space(last)
    assert np.abs(fixed[:, 1] - fixed[:, 0]).max() < 1e-12
    assert run.orbit.field.kind == ("tape" if name == "goryachev" else "quadratic")
