"""Rods: the equations of balance, Kirchhoff's analogy, elastica and helices in closed form, bad input."""

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline
from scipy.special import ellipeinc, ellipj

import liepoisson as lp

ANISOTROPIC = lp.Top(inertia=(2, 1.5, 1), a=(0, 0, -0.7), b=(0, 0, 0.4), epsilon=0.8)


def along(s, values):
    """Derivative by a cubic spline: error of the order of the third power of the distance of the points."""
    return CubicSpline(s, values, axis=1)(s, 1)


def test_balance_of_force_and_moment_is_the_twisted_top():
    """In the directors' frame v' = (v')_space + v x u: m' = n x d3, n' = I B x d3, B' = 0, for any stiffnesses."""
    a3, b3, epsilon = sp.symbols("a3 b3 epsilon", nonzero=True)
    top = lp.Top(inertia=("B1", "B2", "C"), a=(0, 0, a3), b=(0, 0, b3), epsilon=epsilon)
    l, alpha, beta = top.bracket.fields.values()
    dl, dalpha, dbeta = (sp.Matrix(list(top.equations.values())[k : k + 3]) for k in (0, 3, 6))
    strain = sp.Matrix([l[i] / sp.Symbol(name) for i, name in enumerate(("B1", "B2", "C"))])
    force, field, tangent = a3 * alpha + b3 * beta, epsilon * a3**2 * beta, sp.Matrix([0, 0, 1])
    balance = [
        dl - l.cross(strain) - force.cross(tangent),
        a3 * dalpha + b3 * dbeta - force.cross(strain) - field.cross(tangent),
        epsilon * a3**2 * dbeta - field.cross(strain),
    ]
    assert [sp.simplify(residual) for residual in balance] == [sp.zeros(3, 1)] * 3


@settings(max_examples=5)
@given(st.integers(0, 10_000))
def test_equilibrium_of_any_piece(seed):
    """Integrated balance, n - n0 = I B x (r - r0): the force follows from the centre line without any integration.

    Both sides are integrated to round-off, over 15 lengths of order one.
    """
    rod = lp.orbits.rod(ANISOTROPIC, lp.sample_states(ANISOTROPIC, 3, seed=seed), length=15, n_points=31)
    start = rod.centre_line[:, :1]
    residual = rod.force - rod.force[:, :1] - np.cross(rod.field, rod.centre_line - start)
    scale = np.abs(rod.force).max() + np.abs(rod.centre_line).max()
    assert np.abs(residual).max() < 1e-12 * scale
    assert np.ptp(rod.field, axis=1).max() < 1e-12 * scale


def test_material_law_and_energy():
    r"""$m = B_1u_1d_1 + B_2u_2d_2 + Cu_3d_3$; $\tfrac12 m\cdot u$ + tension is H, the same at all points.

    So are the Casimirs, in the words of the rod: $|n|^2/2 + m\cdot IB$, $n\cdot IB$ and $|IB|$.
    """
    rod = lp.orbits.rod(ANISOTROPIC, lp.sample_states(ANISOTROPIC, 3, seed=8), length=10)
    moment = np.einsum("tpd,d,tpdi->tpi", rod.strain, [2, 1.5, 1], rod.directors)
    assert np.abs(rod.moment - moment).max() < 1e-13
    energy = np.einsum("tpd,d,tpd->tp", rod.strain, [1, 0.75, 0.5], rod.strain) + rod.tension
    assert np.ptp(energy, axis=1).max() < 1e-12
    assert np.abs(rod.twist - rod.strain[..., 2]).max() == 0
    first = np.sum(rod.force**2 / 2 + rod.moment * rod.field, axis=-1)
    second = np.sum(rod.force * rod.field, axis=-1)
    assert np.ptp([first, second], axis=-1).max() < 1e-12


def test_planar_elastica_is_eulers():
    r"""A heavy top in a plane is a pendulum: $B\vartheta'' = -P\sin\vartheta$ under the thrust P (force $n = -Pe_z$).

    From $\vartheta = 0$, with $w = \sqrt{P/B}$ and modulus k: $\sin(\vartheta/2) = k\,\mathrm{sn}(ws)$ and
    $y = (2k/w)(\mathrm{cn}(ws) - 1)$, $z = (2/w)E(\mathrm{am}(ws)) - s$ (Love 1927, section 263).
    """
    stiffness, thrust, k = 1.5, 2.0, 0.8
    top = lp.Top.heavy(inertia=(stiffness, 2, 1), a=(0, 0, 1))
    w = np.sqrt(thrust / stiffness)
    rod = lp.orbits.rod(top, [2 * k * w * stiffness, 0, 0, 0, 0, -thrust, 0, 0, 0], length=12, n_points=97)
    sn, cn, dn, am = ellipj(w * rod.arclength, k**2)
    y, z = 2 * k / w * (cn - 1), 2 / w * ellipeinc(am, k**2) - rod.arclength
    assert np.abs(rod.centre_line[0] - np.stack([0 * y, y, z], axis=-1)).max() < 1e-12
    assert np.abs(rod.strain[0, :, 0] - 2 * k * w * cn).max() < 1e-12
    assert np.abs(rod.tension[0] + thrust * (1 - 2 * k**2 * sn**2)).max() < 1e-12
    assert np.abs(rod.directors[0, :, 2, 1] + 2 * k * sn * dn).max() < 1e-12


def helix(s, axis, wave_number, tangent):
    r"""The curve through 0 whose tangent turns about the unit vector `axis` by `wave_number` per length.

    With $t_\parallel$ along the axis and $t_\perp$ across, $r = t_\parallel s + t_\perp\sin(ks)/k +
    (\mathrm{axis}\times t_\perp)(1 - \cos ks)/k$: radius $|t_\perp|/k$, pitch $2\pi|t_\parallel|/k$.
    """
    k, s = wave_number, s[:, None]
    parallel = (tangent @ axis) * axis
    across = tangent - parallel
    return parallel * s + across * np.sin(k * s) / k + np.cross(axis, across) * (1 - np.cos(k * s)) / k


@pytest.mark.parametrize(("kappa", "nu"), [(0.8, 0.6), (0.5, -1.1)])
def test_relative_equilibria_of_the_twisted_top_are_helices_about_the_field(kappa, nu):
    r"""$l = I_1\kappa\beta - (a_3\nu/\kappa^2)e_3$, $\alpha = (\epsilon a_3e_3 - \nu\beta)/\kappa$.

    The tangent precesses about beta at the rate $\kappa|\beta|$.  The first of them is unstable, by exp(0.36 s): an
    error of 5e-12 was measured at length 30.
    """
    top = lp.Top.twisted_lagrange(transverse="3/2", axial="2/3", a3="4/5", epsilon="1/2")
    e3, beta = np.array([0, 0, 1.0]), np.array([0.7, -0.2, 0.5])
    l = 1.5 * kappa * beta - 0.8 * nu / kappa**2 * e3
    alpha = (0.4 * e3 - nu * beta) / kappa
    rod = lp.orbits.rod(top, [*l, *alpha, *beta], length=12, n_points=121)
    size = np.linalg.norm(beta)
    assert np.abs(rod.centre_line[0] - helix(rod.arclength, beta / size, kappa * size, e3)).max() < 1e-12
    assert np.ptp(rod.curvature) < 1e-12
    assert np.ptp(rod.tension) < 1e-12
    assert np.abs(rod.field[0] - 0.5 * 0.8**2 * beta).max() < 1e-12


def test_a_rod_can_be_continued_and_reversed():
    x0 = lp.sample_states(ANISOTROPIC, 2, seed=3)
    there = lp.orbits.rod(ANISOTROPIC, x0, length=6, attitude="beta", origin=[1, 2, 3])
    end = there.attitude
    back = lp.orbits.rod(
        ANISOTROPIC, end.state[:, -1], length=-6, attitude=end.quaternion[:, -1], origin=there.centre_line[:, -1]
    )
    assert np.abs(back.centre_line - there.centre_line[:, ::-1]).max() < 1e-11
    assert np.abs(there.centre_line[:, 0] - [1, 2, 3]).max() == 0
    field = there.field[:, 0]
    assert np.abs(field[:, :2]).max() < 1e-15
    assert (field[:, 2] > 0).all()
    x0[1, 0] = np.nan
    assert list(lp.orbits.rod(ANISOTROPIC, x0, length=1).outcome) == ["finished", "not finite"]
