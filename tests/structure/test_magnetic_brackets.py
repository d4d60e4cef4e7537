"""Charged particles in magnetic fields: Lorentz's force, and guiding centres against full orbits."""

import pickle

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import solve_ivp

import liepoisson as lp
from liepoisson.errors import BracketError, ExpressionError, JacobiError, ParameterError, ShapeError

BOTTLE = ["-x*z/4", "-y*z/4", "1 + z^2/4"]
"""B = (1 + z^2/4) e_z near the axis, twice as strong at z = 2."""
DIPOLE = [f"{p}/(x^2 + y^2 + z^2)^(5/2)" for p in ("3*x*z", "3*y*z", "(2*z^2 - x^2 - y^2)")]
TIGHT = {"rtol": 1e-10, "atol": 1e-12}


def bottle(x):
    return np.array([-x[0] * x[2] / 4, -x[1] * x[2] / 4, 1 + x[2] ** 2 / 4])


def lorentz(field, charge, mass=1, force=lambda x: np.zeros(3)):
    """m v' = e v x B + F, as in books."""
    return lambda _, s: [*s[3:], *(charge * np.cross(s[3:], field(s[:3])) + force(s[:3])) / mass]


def test_the_bracket_of_velocities_gives_lorentz_force():
    bracket = lp.brackets.magnetic(BOTTLE, charge=3, mass=2)
    x, v = bracket.variables[:3], bracket.variables[3:]
    assert bracket.jacobi == "proved"
    assert bracket(x[0], v[0]) == sp.Rational(1, 2)
    assert sp.expand(bracket(v[0], v[1]) - sp.Rational(3, 4) * (1 + x[2] ** 2 / 4)) == 0
    assert sp.expand(bracket(v[1], v[2]) + sp.Rational(3, 4) * x[0] * x[2] / 4) == 0
    system = lp.System(bracket, "v_x^2 + v_y^2 + v_z^2 + x*y + z")
    start = [0.2, -0.3, 0.1, 0.5, 0.4, 0.7]
    full = lorentz(bottle, 3, 2, lambda x: -np.array([x[1], x[0], 1.0]))
    np.testing.assert_allclose(system.vector_field(start), full(0, np.array(start)), rtol=1e-14)
    wanted = solve_ivp(full, (0, 5), start, **TIGHT).y[:, -1]
    np.testing.assert_allclose(lp.integrate(system, start, t_end=5).end_state[0], wanted, atol=1e-7)


@pytest.mark.parametrize("field", [BOTTLE, DIPOLE, ["sin(y)*cos(z)", "exp(z)", "x"]])
def test_fields_without_divergence_are_proved(field):
    bracket = lp.brackets.magnetic(field)
    assert bracket.jacobi == "proved"
    assert bracket.jacobi_certificate().proved
    tensor = lp.PoissonTensor(bracket.coordinate_names_in_order, bracket.formulas.entries, check=False)
    assert tensor.jacobi_certificate().proved
    assert (bracket.rank(), bracket.casimirs()) == (6, [])


def test_a_field_with_a_divergence_is_refused_with_the_residual():
    with pytest.raises(JacobiError, match="q/m\\*\\*3 div B") as caught:
        lp.brackets.magnetic(["x*y", "y", "z^2"], charge="q", mass="m", symbols=["q", "m"])
    q, m, y, z = sp.symbols("q m y z")
    assert caught.value.triple == ("v_x", "v_y", "v_z")
    assert sp.simplify(sp.sympify(caught.value.residual) - q / m**3 * (y + 1 + 2 * z)) == 0
    assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)
    # the residual is that of the tensor itself
    wrong = {("x", "v_x"): "1/m", ("y", "v_y"): "1/m", ("z", "v_z"): "1/m", ("v_x", "v_y"): "q/m^2*z^2",
             ("v_y", "v_z"): "q/m^2*x*y", ("v_z", "v_x"): "q/m^2*y"}  # fmt: skip
    tensor = lp.PoissonTensor(["x", "y", "z", "v_x", "v_y", "v_z"], wrong, symbols=["q", "m"], check=False)
    (residual,) = [r for r in tensor.jacobi_residuals().values() if r != 0]
    assert sp.simplify(residual - sp.sympify(caught.value.residual)) == 0
    with pytest.raises(JacobiError) as caught:
        lp.brackets.guiding_centre(["x", "0", "1"])
    assert caught.value.triple == ("x", "y", "z")


def test_identities_between_functions_are_tried():
    """div B = sin 2y - 2 sin y cos y."""
    assert lp.brackets.magnetic(["x*sin(2*y)", "cos(y)^2", "0"]).jacobi == "sampled"
    with pytest.raises(JacobiError):
        lp.brackets.magnetic(["x*sin(2*y)", "2*cos(y)^2", "0"])


def test_the_identity_of_a_guiding_centre_follows_from_that_of_its_field():
    """What a certificate says of the field holds for the entries, at random points in decimals."""
    bracket = lp.brackets.guiding_centre(["0", "sin(z)", "exp(x) - 3"], charge=2)
    certificate = bracket.jacobi_certificate()
    assert certificate.proved
    assert (
        str(certificate)
        == "Jacobi identity proved (computed: div B = 0, from which it follows for all 4 triples of coordinates)"
    )
    for triple in bracket.formulas.triples():
        assert bracket.formulas.jacobi_fails_at_a_point(triple) is None
    sampled = lp.brackets.guiding_centre(["x*sin(2*y)", "cos(y)^2", "0"]).jacobi_certificate()
    assert (sampled.holds, sampled.proved) == (True, False)
    assert lp.brackets.magnetic(["1 + x"]).jacobi_certificate().proved


def test_a_plane_has_one_component():
    system = lp.System(lp.brackets.magnetic(["1 + x"], charge=2), "(v_x^2 + v_y^2)/2")
    x, y, vx, vy = system.bracket.variables
    assert system.equations == {x: vx, y: vy, vx: sp.expand(2 * vy * (1 + x)), vy: sp.expand(-2 * vx * (1 + x))}


def test_the_guiding_centre_drifts_with_the_gradient():
    """B = (1 + y) e_z: the drift mu/(e |B|) b x grad |B| = -mu/(e (1 + y)) e_x of textbooks."""
    bracket = lp.brackets.guiding_centre(["0", "0", "1 + y"], charge=5)
    x, y, z, u = bracket.variables
    assert bracket.jacobi == "proved"
    assert (bracket(x, y), bracket(z, u), bracket(x, u)) == (-1 / (5 * y + 5), 1, 0)
    system = lp.System(bracket, "u^2/2 + 2*(1 + y) + 5*z*x/10")  # and E x B drift, with E = -(z, 0, x)/10
    np.testing.assert_allclose(system.vector_field([0.3, 1.0, 0.7, 0.2]), [-2 / 10, 0.07 / 2, 0.2, -0.15], rtol=1e-14)


def test_the_bracket_is_littlejohns_in_any_field():
    """-eps_ijk b_k/(e B*_par) and B*_i/(m B*_par), with b, curl b and B* by differences: the inverse of a form."""
    bracket = lp.brackets.guiding_centre(["y*z + 1", "z - x^2", "2 + x*y"], charge="3/2", mass=2)
    assert bracket.jacobi == "proved"
    J = sp.lambdify(bracket.variables, bracket.poisson_tensor().tolist(), "numpy")

    def unit(x):
        B = np.array([x[1] * x[2] + 1, x[2] - x[0] ** 2, 2 + x[0] * x[1]])
        return B, B / np.linalg.norm(B)

    rng, h = np.random.default_rng(4), 1e-6
    for state in rng.uniform(-1, 1, (5, 4)):
        x, u = state[:3], state[3]
        B, b = unit(x)
        slope = np.stack([(unit(x + h * d)[1] - unit(x - h * d)[1]) / (2 * h) for d in np.eye(3)])  # d_i b_j
        curl = np.array([slope[1, 2] - slope[2, 1], slope[2, 0] - slope[0, 2], slope[0, 1] - slope[1, 0]])
        star = B + 2 / 1.5 * u * curl
        along, matrix = b @ star, np.zeros((4, 4))
        matrix[:3, :3] = -np.array([[0, b[2], -b[1]], [-b[2], 0, b[0]], [b[1], -b[0], 0]]) / (1.5 * along)
        matrix[:3, 3], matrix[3, :3] = star / (2 * along), -star / (2 * along)
        np.testing.assert_allclose(J(*state), matrix, rtol=1e-7, atol=1e-8)
        # e eps_ijk B*_k and -m b_i: its inverse, which is closed where div B = 0
        form = np.zeros((4, 4))
        form[:3, :3] = 1.5 * np.array([[0, star[2], -star[1]], [-star[2], 0, star[0]], [star[1], -star[0], 0]])
        form[:3, 3], form[3, :3] = -2 * b, 2 * b
        np.testing.assert_allclose(J(*state) @ form, np.eye(4), atol=1e-7)


@pytest.mark.thorough
def test_in_a_magnetic_bottle_the_error_halves_with_the_radius_of_gyration():
    """From one place and velocity with the charges 40, 80, 160 in turn; |x - X| after a bounce, 2 to 1."""
    x, v = np.array([0.6, 0, 0.3]), np.array([0.7, 0, 0.4])
    errors = []
    for charge in (40, 80, 160):
        B = bottle(x)
        size = np.linalg.norm(B)
        b = B / size
        u = v @ b
        centre = x + np.cross(v, b) / (charge * size)
        mu = (v @ v - u**2) / (2 * size)
        full = solve_ivp(lorentz(bottle, charge), (0, 8), [*x, *v], method="DOP853", rtol=1e-9, atol=1e-11).y[:3, -1]
        system = lp.System(
            lp.brackets.guiding_centre(BOTTLE, charge=charge),
            "u^2/2 + mu*sqrt((x*z/4)^2 + (y*z/4)^2 + (1 + z^2/4)^2)", {"mu": float(mu)},
        )  # fmt: skip
        end = lp.integrate(system, [*centre, u], t_end=8).end_state[0]
        errors.append(np.linalg.norm(full - end[:3]))
        assert errors[-1] < 3 * np.linalg.norm(v) / charge
    ratios = np.array(errors[:-1]) / errors[1:]
    np.testing.assert_allclose(ratios, 2, atol=0.01)  # measured 2.0011, 2.0009


@pytest.mark.thorough
def test_over_long_times_the_drift_is_right_to_first_order():
    """B = (1 + y/2) e_z for the time 2/radius: the drift is of order one, its error of the order of the radius."""
    errors = []
    for charge in (10, 20, 40):
        x, v = np.array([0.0, 0, 0]), np.array([0.8, 0.6, 0])
        t_end = 2 * charge
        full = solve_ivp(
            lorentz(lambda x: np.array([0, 0, 1 + x[1] / 2]), charge), (0, t_end), [*x, *v], method="DOP853",
            rtol=1e-9, atol=1e-11,
        ).y[:2, -1]  # fmt: skip
        centre = x + np.cross(v, [0, 0, 1]) / charge
        bracket = lp.brackets.guiding_centre(["0", "0", "1 + y/2"], charge=charge)
        end = lp.integrate(lp.System(bracket, "u^2/2 + 1/2*(1 + y/2)"), [*centre, 0], t_end=t_end).end_state[0]
        assert abs(end[0]) > 0.4
        errors.append(np.linalg.norm(full - end[:2]))
    assert errors[2] < errors[0] / 2.5
    assert errors[0] < 4 / 10


REFUSED = {
    "no field": (lambda: lp.brackets.guiding_centre(["0", "0", "0"]), BracketError, "B = 0"),
    "no components": (lambda: lp.brackets.magnetic("x"), ShapeError, "three formulas"),
    "two components": (lambda: lp.brackets.magnetic(["x", "y"]), ShapeError, "three formulas"),
    "one for a guiding centre": (lambda: lp.brackets.guiding_centre(["x"]), ShapeError, "three components"),
    "names": (lambda: lp.brackets.magnetic(["0", "0", "1"], ["x", "y"]), ShapeError, "6 names"),
    "names of a guiding centre": (lambda: lp.brackets.guiding_centre(["0", "0", "1"], ["x"]), ShapeError, "four"),
    "a velocity": (lambda: lp.brackets.magnetic(["0", "0", "v_x"]), BracketError, "v_x"),
    "no mass": (lambda: lp.brackets.magnetic(["0", "0", "1"], mass=0), ParameterError, "mass"),
    "a negative mass": (lambda: lp.brackets.magnetic(["0", "0", "1"], mass="sqrt(2) - 2"), ParameterError, "positive"),
    "a negative mass of a guiding centre": (
        lambda: lp.brackets.guiding_centre(["0", "0", "1"], mass=-1),
        ParameterError,
        "positive",
    ),
    "a negative value of a mass": (
        lambda: lp.brackets.magnetic(["0", "0", "1"], mass="m", symbols=["m"]).substitute({"m": -1}),
        ParameterError,
        "positive",
    ),
    "no charge": (lambda: lp.brackets.guiding_centre(["0", "0", "1"], charge=0), ParameterError, "charge"),
    "an unknown name": (lambda: lp.brackets.magnetic(["0", "0", "B"]), ExpressionError, "B"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_no_magnetic_field_is_refused(case):
    call, error, words = REFUSED[case]
    with pytest.raises(error, match=words):
        call()
