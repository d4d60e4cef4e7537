"""Rods: the equations of balance, Kirchhoff's analogy, elastica and helices in closed form, bad input."""

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline
from scipy.special import ellipeinc, ellipj

import liepoisson as lp
from liepoisson.errors import ParameterError, ShapeError
from liepoisson.rigid_body.rod import loads

ANISOTROPIC = lp.Top(inertia=(2, 1.5, 1), a=(0, 0, -0.7), b=(0, 0, 0.4), epsilon=0.8)
LAGRANGE = lp.Top.twisted_lagrange(transverse=1, axial="2/3", a3=1, epsilon="1/2")


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


def test_loads_of_a_top_are_those_of_the_dictionary():
    top = lp.Top(inertia=(2, 1, 1), a=(0, 0, "3/2"), b=(0, 0, -2), epsilon="1/3")
    assert loads(top) == ((0, sp.Rational(3, 2), -2), (0, 0, sp.Rational(3, 4)))


@settings(max_examples=10)
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


def test_local_equations_hold_in_space():
    """r' = d3, d_i' = u x d_i, m' = n x d3, by splines with points 0.0025 apart; their error is below 1e-5."""
    rod = lp.orbits.rod(ANISOTROPIC, lp.sample_states(ANISOTROPIC, 3, seed=8), length=5, n_points=2001)
    d3 = rod.directors[..., 2, :]
    darboux = np.einsum("tpd,tpdi->tpi", rod.strain, rod.directors)
    assert np.abs(along(rod.arclength, rod.centre_line) - d3).max() < 1e-5
    assert np.abs(along(rod.arclength, rod.moment) - np.cross(rod.force, d3)).max() < 1e-5
    for k in range(3):
        d = rod.directors[..., k, :]
        assert np.abs(along(rod.arclength, d) - np.cross(darboux, d)).max() < 1e-5
    assert np.abs(np.linalg.norm(np.cross(d3, along(rod.arclength, d3)), axis=-1) - rod.curvature).max() < 1e-5


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


def test_isotropic_rod_keeps_its_twist():
    rod = lp.orbits.rod(LAGRANGE, lp.sample_states(LAGRANGE, 3, seed=1), length=20)
    assert repr(rod) == f"<Rod of {LAGRANGE.name!r}: 3 trajectories, 401 points, s = 0 to 20>"
    assert np.ptp(rod.twist, axis=1).max() < 1e-12


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


@pytest.mark.parametrize(("kappa", "nu"), [(0.8, 0.6), (-1.3, 0.4), (0.5, -1.1)])
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


def test_steady_precession_of_the_lagrange_top_is_kirchhoffs_helix():
    r"""$l = B\kappa\alpha + (a_3/\kappa)e_3$ precesses at $\kappa|\alpha|$ about the force, the axis of the helix."""
    top = lp.Top.lagrange(transverse="3/2", axial="2/3", a3=1)
    kappa, e3, alpha = 0.9, np.array([0, 0, 1.0]), np.array([0.6, 0.3, -0.8])
    rod = lp.orbits.rod(top, [*(1.5 * kappa * alpha + e3 / kappa), *alpha, 0, 0, 0], length=30, n_points=301)
    size = np.linalg.norm(alpha)
    assert np.abs(rod.centre_line[0] - helix(rod.arclength, alpha / size, kappa * size, e3)).max() < 1e-12
    assert np.abs(rod.field).max() == 0


def test_intrinsic_curvature_makes_a_free_rod_a_circle():
    """H = l.l/2 + l1/R: without load and moment the curvature is 1/R, and the rod closes after 2 pi R."""
    system = lp.System(lp.so(3) @ lp.leibniz(2), "dot(l, l)/2 + l1/2 + alpha3")
    rod = lp.orbits.rod(system, np.zeros(6), arclengths=[0, np.pi, 4 * np.pi])
    assert np.abs(rod.curvature - 0.5).max() < 1e-15
    assert np.abs(rod.centre_line[0, 1:] - [[0, -2, 2], [0, 0, 0]]).max() < 1e-12


def test_charge_is_an_automorphism():
    """alpha -> alpha + (b3/a3) beta takes b to 0: the same rod, with the same force and the same field."""
    plain = lp.Top.twisted_lagrange(a3=2, b3=0)
    charged = lp.Top.twisted_lagrange(a3=2, b3=3)
    x0 = lp.sample_states(charged, 2, seed=5)
    moved = x0.copy()
    moved[:, 3:6] += 1.5 * x0[:, 6:]
    first, second = lp.orbits.rod(charged, x0, length=10), lp.orbits.rod(plain, moved, length=10)
    for name in ("centre_line", "directors", "force", "moment", "field"):
        assert np.abs(getattr(first, name) - getattr(second, name)).max() < 1e-11, name


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


def test_a_rod_knows_its_system_and_outcome():
    x0 = lp.sample_states(ANISOTROPIC, 2, seed=3)
    x0[1, 0] = np.nan
    rod = lp.orbits.rod(ANISOTROPIC, x0, length=1)
    assert rod.system is ANISOTROPIC
    assert list(rod.outcome) == ["finished", "not finite"]
    assert rod.attitude.orbit.components[-3:] == ("r1", "r2", "r3")
    assert np.isnan(rod.centre_line[1, 1:]).all()


@pytest.mark.parametrize(
    ("system", "words"),
    [
        (lp.Top.twisted_kovalevskaya(), "tangent"),
        (lp.catalog.system("kirchhoff"), "tangent"),
        (lp.catalog.system("leibniz-lagrange-4"), r"f\^3"),
        (lp.catalog.system("manakov-so4"), "rotation"),
    ],
    ids=["a across", "quadratic in the field", "four fields", "so(4)"],
)
def test_systems_that_are_no_rods_are_refused(system, words):
    with pytest.raises(ParameterError, match=words):
        lp.orbits.rod(system, np.ones(len(system.component_names)), length=1)


@pytest.mark.parametrize(
    ("options", "error", "words"),
    [
        ({}, ParameterError, "neither"),
        ({"length": 1, "arclengths": [0, 1]}, ParameterError, "both"),
        ({"length": 0}, ParameterError, "length"),
        ({"length": np.nan}, ParameterError, "length"),
        ({"length": "long"}, ParameterError, "length"),
        ({"length": 1, "n_points": 1}, ParameterError, "n_points"),
        ({"arclengths": [0, 1, 1]}, ParameterError, "strictly"),
        ({"length": 1, "origin": [0, 0]}, ShapeError, "origin"),
        ({"length": 1, "origin": [0, 0, np.inf]}, ParameterError, "origin"),
    ],
)
def test_mistakes_are_refused(options, error, words):
    with pytest.raises(error, match=words):
        lp.orbits.rod(LAGRANGE, np.ones(9), **options)
