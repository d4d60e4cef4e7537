r"""Laws of damping: the energy falls, or the entropy rises, at the stated rate, and what is to be kept is kept."""

import pickle
import re

import numpy as np
import pytest
import sympy

import liepoisson as lp
from liepoisson.damping.symmetric_forms import semidefinite

EULER = lp.catalog.euler_top_on("so(3)", [1, 2, 3])
SPECIES = lp.System(
    lp.PoissonTensor(["x", "y", "z"], {("x", "y"): "x*y", ("y", "z"): "y*z", ("z", "x"): "z*x"}), "x + y + z"
)
OSCILLATOR = lp.System(lp.canonical(1), "dot(p, p)/2 + k*dot(q, q)/2", {"k": 3})
SYSTEMS = {
    "body": EULER,
    "heavy top": lp.catalog.system("heavy-top"),
    "twisted": lp.catalog.system("twisted-kovalevskaya"),
    "sl(2)": lp.System(lp.sl(2) @ lp.trivial(), "le12^2/2 + lh1^2 + le12*le21 + le21"),
    "species": SPECIES,
    "oscillator": OSCILLATOR,
}
FORM = [[2, 1, 0], [1, 3, 0], [0, 0, "1 + l1^2"]]


def total(function):
    return sympy.simplify(sympy.expand(function))


@pytest.mark.parametrize("system", SYSTEMS.values(), ids=[*SYSTEMS])
def test_the_energy_falls_at_its_rate_and_casimirs_are_kept(system):
    """dH/dt = -rate |J dH|^2, dC/dt = 0, in exact numbers."""
    damped = lp.dissipation.double_bracket(system, "1/3")
    velocity = sympy.Matrix(list(system.equations.values()))
    assert total(damped.derivative(system.hamiltonian) + velocity.dot(velocity) / 3) == 0
    assert total(damped.production - velocity.dot(velocity) / 3) == 0
    for casimir in system.bracket.casimirs():
        assert damped.derivative(casimir) == 0
    assert [*damped.falling] == ["H"]
    assert {law.known for law in damped.laws} == {"proved"}
    assert len(damped.invariants) >= len(system.bracket.casimirs())


@pytest.mark.parametrize("name", ["body", "heavy top", "twisted", "sl(2)"])
@pytest.mark.parametrize("of_forms", [False, True])
def test_a_metriplectic_flow_keeps_energy_and_makes_entropy(name, of_forms):
    """dH/dt = 0 and dS/dt = rate dS.G dS, in exact numbers."""
    system = SYSTEMS[name]
    n = system.bracket.dimension
    forms = ([1] * n, [*range(1, n + 1)]) if of_forms else None
    flow = lp.dissipation.metriplectic(system, "C1", "1/3", forms=forms)
    assert flow.derivative(system.hamiltonian) == 0
    assert total(flow.derivative(system.bracket.casimirs()[0]) - flow.production) == 0
    assert [*flow.rising] == ["S"]
    assert "H" in flow.invariants
    assert {law.known for law in flow.laws} == {"proved"}
    states = np.random.default_rng(1).normal(size=(20, n))
    values = sympy.lambdify(system.variables, flow.production)(*states.T)
    assert (np.asarray(values) >= -1e-12).all()


def test_the_damped_body_is_that_of_the_books():
    """l' = l x w + rate l x (l x w), and with a form g: rate l x g(l x w)."""
    l = sympy.Matrix(EULER.variables)
    w = sympy.Matrix([l[k] / (k + 1) for k in range(3)])
    v = l.cross(w)
    found = sympy.Matrix(list(lp.dissipation.double_bracket(EULER, "1/10").equations.values()))
    assert (found - v - l.cross(v) / 10).expand() == sympy.zeros(3, 1)
    found = sympy.Matrix(list(lp.dissipation.double_bracket(EULER, "l2^2", metric=FORM).equations.values()))
    g = sympy.Matrix([[2, 1, 0], [1, 3, 0], [0, 0, 1 + l[0] ** 2]])
    assert (found - v - l[1] ** 2 * l.cross(g * v)).expand() == sympy.zeros(3, 1)


def test_the_metriplectic_body_is_that_of_the_books():
    """G = |w|^2 - w w^T from the Lie algebra, twice that from identities, and if it is given [morrison1986]."""
    l = sympy.Matrix(EULER.variables)
    w = sympy.Matrix([l[k] / (k + 1) for k in range(3)])
    G = w.dot(w) * sympy.eye(3) - w * w.T
    wanted = l.cross(w) + G * l / 10
    identity = [1, 1, 1]
    for options in ({}, {"forms": (identity, [[s / 2 for s in row] for row in np.eye(3)])}, {"matrix": G}):
        found = lp.dissipation.metriplectic(EULER, "dot(l, l)/2", "1/10", **options)
        assert (sympy.Matrix(list(found.equations.values())) - wanted).expand() == sympy.zeros(3, 1)
    killing = lp.dissipation.metriplectic(EULER, "dot(l, l)/2", "1/20", metric="killing")  # 2 on so(3)
    assert (sympy.Matrix(list(killing.equations.values())) - wanted).expand() == sympy.zeros(3, 1)


def test_a_degenerate_metric_gives_friction():
    """q' = p, p' = -k q - rate q'."""
    damped = lp.dissipation.double_bracket(OSCILLATOR, "c", metric=[1, 0], parameters={"c": "1/5"})
    q, p = OSCILLATOR.variables
    assert [rate.expand() for rate in damped.equations.values()] == [p, -3 * q - p / 5]
    assert damped.parameters == {"k": 3, "c": sympy.Rational(1, 5)}


def test_the_killing_form_on_velocities_is_inverted():
    one, other = (lp.dissipation.double_bracket(EULER, rate, metric=g) for rate, g in ((2, "killing"), (1, None)))
    pairs = zip(one.equations.values(), other.equations.values(), strict=True)
    assert all((a - b).expand() == 0 for a, b in pairs)


# The rigid body


def test_the_damped_body_ends_on_the_axis_of_the_largest_moment_at_the_rate_of_the_theory():
    """About L e3 the eigenvalues are -c L (a + b)/2 +- sqrt(c^2 L^2 (a - b)^2/4 - a b), a = L(1/I2 - 1/I3),
    b = L(1/I1 - 1/I3); along the axis 0, as the sphere is kept."""
    rate, L = 0.1, np.sqrt(3)
    damped = lp.dissipation.double_bracket(EULER, "1/10")
    orbit = lp.integrate(damped, [1, 1, 1], t_end=400)
    assert np.abs(np.abs(orbit.end_state[0]) - [0, 0, L]).max() < 1e-12
    assert orbit.drift["C1"][0] < 1e-13
    a, b = L * (1 / 2 - 1 / 3), L * (1 - 1 / 3)
    assert rate**2 * L**2 * (a - b) ** 2 / 4 < a * b
    decay = -rate * L * (a + b) / 2
    spectrum = lp.lyapunov_spectrum(damped, orbit.end_state, t_end=2000)
    assert np.abs(np.sort(spectrum.exponent[0, -1]) - [decay, decay, 0]).max() < 2e-3  # of the order 1/t


def test_volumes_change_by_the_trace():
    """det(Dx(t)/Dx(0)) = exp of the integral of the divergence."""
    damped = lp.dissipation.double_bracket(SYSTEMS["heavy top"], "1/10")
    times = np.linspace(0, 3, 601)
    orbit = lp.integrate(damped, {"l": (1, 0.5, 1), "alpha": (0.6, 0, 0.8)}, times=times, tangents=np.eye(6))
    trace = sympy.lambdify(damped.variables, damped.divergence)(*orbit.state[0].T)
    wanted = (times[1] / 3) * (trace[0] + 4 * trace[1::2].sum() + 2 * trace[2:-1:2].sum() + trace[-1])  # Simpson
    assert np.log(np.linalg.det(orbit.tangent[0, -1])) == pytest.approx(wanted, rel=1e-9)
    assert abs(wanted) > 0.1


@pytest.mark.parametrize("transient", [0, 5])
def test_exponents_add_up_to_the_mean_divergence(transient):
    """Along an orbit, and after a transient, with the integral by Simpson's rule as the third."""
    damped = lp.dissipation.double_bracket(SYSTEMS["heavy top"], "1/10")
    found = lp.lyapunov_spectrum(damped, {"l": (1, 0.5, 1), "alpha": (0.6, 0, 0.8)}, t_end=20, transient=transient)
    orbit = lp.integrate(damped, found.start, times=np.linspace(0, 20 + transient, 4001))
    trace = sympy.lambdify(damped.variables, damped.divergence)(*orbit.state[0, orbit.time >= transient - 1e-9].T)
    assert len(trace) % 2 == 1
    step = orbit.time[1]
    wanted = step / 3 * (trace[0] + 4 * trace[1::2].sum() + 2 * trace[2:-1:2].sum() + trace[-1]) / 20
    assert found.mean_divergence[0] == pytest.approx(wanted, rel=1e-9)
    assert found.end_exponent[0].sum() == pytest.approx(wanted, rel=1e-9)
    assert f"{wanted:.6f}"[:6] in found.check()


def test_the_metriplectic_body_keeps_its_energy_and_its_entropy_never_falls():
    """It ends on the axis of the largest moment, with l3^2 = 2 I3 H."""
    flow = lp.dissipation.metriplectic(EULER, "C1", "1/10")
    orbit = lp.integrate(flow, [[1, 1, 1], [2, -1, 0.3]], t_end=300)
    energy = (orbit.start**2 / [1, 2, 3]).sum(axis=1) / 2
    assert orbit.drift["H"].max() < 1e-14 * energy.max() * 10
    assert (np.diff(orbit.monotone["S"]) >= -1e-14).all()
    assert np.abs(orbit.end_state[:, 2] ** 2 - 6 * energy).max() < 1e-12


def test_what_falls_is_seen_along_an_orbit():
    damped = lp.dissipation.double_bracket(SYSTEMS["heavy top"], "1/10")
    orbit = lp.integrate(damped, {"l": (1, 0.5, 1), "alpha": (0.6, 0, 0.8)}, t_end=50)
    assert [*orbit.drift] == ["C1", "C2"]
    assert [*orbit.monotone] == ["H"]
    assert orbit.monotone["H"][0, 0] == pytest.approx(SYSTEMS["heavy top"].functions.energy(orbit.start[0]))
    assert orbit.monotone["H"][0, -1] < orbit.monotone["H"][0, 0] - 0.5
    assert orbit.reversals["H"][0] < 1e-14
    backwards = lp.integrate(damped, orbit.end_state, t_end=-1)
    assert backwards.reversals["H"][0] == 0  # it rises into the past
    assert lp.integrate(EULER, [1, 1, 1], t_end=1).monotone == {}


def test_a_body_in_other_units_is_damped_alike():
    """x -> c x and t -> t/c, with the rate over c: the metric is one of velocities."""
    c = 1e6
    small, large = (lp.dissipation.double_bracket(EULER, rate) for rate in (0.1, 0.1 / c))
    one = lp.integrate(small, [1, 1, 1], t_end=30).end_state
    other = lp.integrate(large, [c, c, c], t_end=30 / c).end_state
    assert np.abs(other / c - one).max() < 1e-12


def test_names_of_the_system_work_and_it_is_pickled():
    damped = lp.dissipation.double_bracket(SYSTEMS["heavy top"], "g", parameters={"g": "1/10"})
    again = pickle.loads(pickle.dumps(damped))
    start = {"l": (1, 0.5, 1), "alpha": (0.6, 0, 0.8)}
    assert (lp.integrate(again, start, t_end=5).end_state == lp.integrate(damped, start, t_end=5).end_state).all()
    points = lp.section(damped, start, surface="dot(l, alpha) - l3*alpha3 - l1*alpha1", t_end=20)
    assert len(points.state) > 1
    assert "H falls (proved)" in str(damped)
    assert "damped heavy-top" in repr(damped)


def test_rates_and_forms_may_depend_on_the_state_and_have_no_value():
    sampled = lp.dissipation.double_bracket(EULER, "l1^2")
    assert [str(law) for law in sampled.laws] == ["H falls (sampled)", "C1 is constant (proved)"]
    symbolic = lp.dissipation.double_bracket(EULER, "g", symbols=["g"])
    assert str(symbolic.laws[0]) == "H falls (undecided)"
    assert "g" in str(symbolic)
    still = lp.dissipation.double_bracket(EULER, 0)
    assert [*still.invariants] == ["H", "C1"]
    assert not still.falling


def test_matrices_are_kept_as_they_were_when_the_damping_was_made():
    form = [[2, 1, 0], [1, 3, 0], [0, 0, 1]]
    damped = lp.dissipation.double_bracket(EULER, 1, metric=form)
    form[0][0] = -7
    assert damped.damping.metric == ((2, 1, 0), (1, 3, 0), (0, 0, 1))
    once = lp.dissipation.metriplectic(EULER, "C1", forms=(iter(form) for form in ([1, 1, 1], [1, 2, 3])))
    assert pickle.loads(pickle.dumps(once)).damping.forms == ((1, 1, 1), (1, 2, 3))
    assert "forms" in once.file_text()


def test_what_a_refusal_of_an_entropy_advises_is_taken():
    with pytest.raises(lp.errors.BracketError) as caught:
        lp.dissipation.metriplectic(EULER, "l1^2")
    advised = re.findall(r'entropy="([^"]+)"', str(caught.value))
    assert advised == ["C1", "(l1^2 + l2^2 + l3^2)^2"]
    for entropy in advised:
        assert str(lp.dissipation.metriplectic(EULER, entropy).laws[0]) == "S rises (proved)"


def test_what_needs_a_bracket_is_told_where_it_is():
    with pytest.raises(AttributeError, match=r"system\.undamped"):
        _ = lp.dissipation.double_bracket(EULER).bracket
    with pytest.raises(lp.errors.ParameterError, match=r"give system\.undamped"):
        lp.Leaf(lp.dissipation.double_bracket(EULER), {})


def test_semidefinite_forms_are_known():
    x = sympy.Symbol("x")
    assert semidefinite(sympy.Matrix([[1, 1], [1, 1]]), []).known == "proved"
    assert semidefinite(sympy.Matrix([[1, sympy.sqrt(2)], [sympy.sqrt(2), 2]]), []).known == "proved"
    assert semidefinite(sympy.Matrix([[1, 2], [2, 1]]), []).negative_at == {}
    assert semidefinite(sympy.Matrix([[1, x], [x, x**2]]), [x]).known == "sampled"
    assert semidefinite(sympy.Matrix([[x, 0], [0, 1]]), [x]).negative_at is not None


# Refusals

double, metriplectic = lp.dissipation.double_bracket, lp.dissipation.metriplectic
WRONG = {
    "negative rate": (lambda: double(EULER, "-1/10"), lp.errors.ParameterError, "rate: wanted one that is never"),
    "rate nan": (lambda: double(EULER, np.nan), lp.errors.ParameterError, "rate"),
    "rate of the state": (lambda: double(EULER, "l1"), lp.errors.ParameterError, "negative at"),
    "negative far from zero": (lambda: double(EULER, "4 - l1^2"), lp.errors.ParameterError, "negative at"),
    "rate nan of SymPy": (lambda: double(EULER, sympy.nan), lp.errors.ParameterError, "rate must be finite and real"),
    "entry imaginary": (
        lambda: double(EULER, 1, metric=[1, 1, sympy.I]), lp.errors.ParameterError, "metric[3] must be finite and real"
    ),
    "entropy of a double bracket": (
        lambda: lp.dissipation.DampedSystem(EULER, lp.dissipation.Damping("double bracket", 1, "C1")),
        lp.errors.ParameterError, "entropy: wanted none",
    ),
    "two brackets in a damping": (
        lambda: lp.dissipation.DampedSystem(
            EULER, lp.dissipation.Damping("metriplectic", 1, "C1", metric=[1, 1, 1], forms=([1, 1, 1], [1, 1, 1]))
        ),
        lp.errors.ParameterError, "leave one",
    ),
    "forms a text": (lambda: metriplectic(EULER, "C1", forms="ab"), lp.errors.ParameterError, "two symmetric"),
    "unknown name": (lambda: double(EULER, "gamma"), lp.errors.ExpressionError, "rate: "),
    "not symmetric": (
        lambda: double(EULER, 1, metric=[[1, 1, 0], [0, 1, 0], [0, 0, 1]]), lp.errors.ParameterError, "symmetric matrix"
    ),
    "not definite": (lambda: double(EULER, 1, metric=[1, 1, -1]), lp.errors.ParameterError, "negative eigenvalue"),
    "shape": (lambda: double(EULER, 1, metric=[1, 1]), lp.errors.ShapeError, "3 entries"),
    "other word": (lambda: double(EULER, 1, metric="identity"), lp.errors.ParameterError, "killing"),
    "no system": (lambda: double(lp.so(3) @ lp.trivial(), 1), lp.errors.ParameterError, "bracket"),
    "driven": (
        lambda: double(lp.System(lp.canonical(1), "dot(p, p)/2 + cos(t)*q1"), 1), lp.errors.ParameterError, "time",
    ),
    "killing of no semisimple": (
        lambda: double(SYSTEMS["heavy top"], 1, metric="killing"), lp.errors.BracketError, "semisimple",
    ),
    "killing of sl(2)": (
        lambda: metriplectic(SYSTEMS["sl(2)"], "C1", metric="killing"), lp.errors.ParameterError, "negative eigenvalue",
    ),
    "no Casimir": (lambda: metriplectic(EULER, "l1^2"), lp.errors.BracketError, 'try entropy="C1"'),
    "no Casimir at all": (lambda: metriplectic(OSCILLATOR, "C1"), lp.errors.BracketError, "none is known"),
    "kind": (
        lambda: lp.dissipation.DampedSystem(EULER, lp.dissipation.Damping("friction")), lp.errors.ParameterError,
        "a Damping of the kind",
    ),
    "constant": (lambda: metriplectic(EULER, "2"), lp.errors.BracketError, "depends on the state"),
    "no entropy": (lambda: metriplectic(EULER, 1), lp.errors.ParameterError, "entropy"),
    "not degenerate": (
        lambda: metriplectic(EULER, "C1", matrix=[1, 1, 1]), lp.errors.ParameterError, "G grad H = 0",
    ),
    "two brackets": (
        lambda: metriplectic(EULER, "C1", metric=[1, 1, 1], matrix=[1, 1, 1]), lp.errors.ParameterError, "leave one",
    ),
    "one form": (lambda: metriplectic(EULER, "C1", forms=[[1, 1, 1]]), lp.errors.ParameterError, "forms"),
    "no algebra": (lambda: metriplectic(SPECIES, "C1"), lp.errors.BracketError, "forms=(sigma, mu)"),
    "idle parameter": (lambda: double(EULER, 1, parameters={"g": 1}), lp.errors.ParameterError, "occurs nowhere"),
    "other value": (
        lambda: double(OSCILLATOR, "k", parameters={"k": 2}), lp.errors.ParameterError, "has a value",
    ),
}  # fmt: skip


@pytest.mark.parametrize(("call", "error", "words"), WRONG.values(), ids=[*WRONG])
def test_what_is_no_damping_is_refused(call, error, words):
    with pytest.raises(error) as caught:
        call()
    assert words in str(caught.value)


@pytest.mark.parametrize("unit", ["1e-200", "1e-40", "1", "1e40"])
def test_smooth_forms_are_judged_in_every_unit(unit):
    def corner(a, b, c):
        return [[f"{unit}*{a}", f"{unit}*{b}", 0], [f"{unit}*{b}", f"{unit}*{c}", 0], [0, 0, 0]]

    with pytest.raises(lp.errors.ParameterError, match="G grad H = 0"):
        metriplectic(EULER, "C1", matrix=corner("exp(l1)", "0", "0"))
    nothing = corner("(sin(l1)^2 + cos(l1)^2 - 1)", "0", "0")
    assert metriplectic(EULER, "C1", matrix=nothing).laws[1].motion == "constant"
    assert double(EULER, 1, metric=corner("exp(l1)", "exp(l1)/2", "exp(l1)")).laws[0].known == "sampled"
    for entries in (("exp(l1)", "2*exp(l1)", "exp(l1)"), ("(sin(l1) - 1/2)", "0", "1")):
        with pytest.raises(lp.errors.ParameterError, match="negative eigenvalue"):
            double(EULER, 1, metric=corner(*entries))
