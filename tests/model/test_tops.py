import pickle
import subprocess
import sys
import warnings

import pytest
import sympy as sp

from liepoisson.compile.field import TopField
from liepoisson.errors import BracketError, InertiaWarning, ParameterError, ShapeError
from liepoisson.model.known_integrals import known_integrals
from liepoisson.model.tops import Top

CASES = {
    "free rigid body": (Top.free_rigid_body((2, 3, 4)), {"l.l", "l.alpha", "l.beta"}),
    "free symmetric": (Top.free_rigid_body((2, 2, 3)), {"l.l", "l.alpha", "l.beta", "l3"}),
    "free spherical": (Top.free_rigid_body((2, 2, 2)), {"l.l", "l.alpha", "l.beta", "l1", "l2", "l3"}),
    "heavy": (Top.heavy((2, 3, 4), (1, 2, 3)), {"l.alpha"}),
    "Lagrange": (Top.lagrange(), {"l.alpha", "l3"}),
    "Lagrange, first axis": (Top(inertia=(1, 2, 2), a=(3, 0, 0), epsilon=2), {"l1", "P"}),
    "Lagrange, second axis": (Top(inertia=(2, 1, 2), a=(0, 3, 0), b=(0, 5, 0), epsilon=2), {"l2", "P'"}),
    "Kovalevskaya": (Top.kovalevskaya(), {"l.alpha", "K"}),
    "Kovalevskaya as printed": (Top(inertia=(1, 1, 2), a=(-1, 0, 0)), {"l.alpha"}),
    "charged heavy": (Top.charged_heavy((2, 3, 4), (1, 2, 3), (1, 1, 0)), set()),
    "charged heavy, parallel": (Top.charged_heavy((2, 3, 4), (1, 2, 3), (2, 4, 6)), {"l.gamma"}),
    "charged Lagrange": (Top.charged_lagrange(b3=3), {"l.gamma", "l3"}),
    "two-field Kovalevskaya": (Top(inertia=(4, 4, 2), a=(1, 2, 0), b=(3, -1, 0)), {"K", "G"}),
    "two-field Kovalevskaya, first axis": (Top(inertia=(1, 2, 2), a=(0, 1, 2), b=(0, 3, -1)), {"K", "G"}),
    "two-field Kovalevskaya, second axis": (Top(inertia=(2, 1, 2), a=(1, 0, 2), b=(3, 0, -1)), {"K", "G"}),
    "parallel Kovalevskaya": (Top(inertia=(2, 2, 1), a=(1, 2, 0), b=(2, 4, 0)), {"K", "l.gamma"}),
    "spherical, two fields": (Top(inertia=(3, 3, 3), a=(1, 2, -1), b=(0, 1, 4)), {"S", "T"}),
    "spherical, tilted": (Top(inertia=(3, 3, 3), a=(1, 2, -1), epsilon=2), {"l.a", "P"}),
    "spherical, tilted, charged": (Top(inertia=(3, 3, 3), a=(1, 2, -1), b=(2, 4, -2), epsilon=2), {"l.a", "P'"}),
    "spherical, beta only": (Top(inertia=(3, 3, 3), b=(2, 4, -2), epsilon=2), {"l.b", "l.beta"}),
    "beta only": (Top(inertia=(2, 3, 4), b=(1, 2, 3), epsilon=2), {"l.beta"}),
    "beta only, Lagrange": (Top(inertia=(2, 2, 3), b=(0, 0, 3), epsilon=2), {"l.beta", "l3"}),
    "beta only, Kovalevskaya": (Top(inertia=(2, 2, 1), b=(1, 2, 0), epsilon=2), {"l.beta", "K"}),
    "twisted": (Top.twisted((2, 3, 4), (1, 2, 3)), set()),
    "twisted Lagrange": (Top.twisted_lagrange(), {"l3", "P"}),
    "charged twisted Lagrange": (Top.twisted_lagrange(b3=2, epsilon=3), {"l3", "P'"}),
    "twisted Kovalevskaya": (Top.twisted_kovalevskaya(), set()),
    "twisted spherical, two fields": (Top(inertia=(3, 3, 3), a=(1, 2, -1), b=(0, 1, 4), epsilon=1), set()),
    "twisted two-field Kovalevskaya": (Top(inertia=(2, 2, 1), a=(1, 0, 0), b=(0, 1, 0), epsilon=1), set()),
    "twisted Kovalevskaya, symbolic": (Top.kovalevskaya("epsilon"), set()),
}


@pytest.mark.thorough
@pytest.mark.parametrize("case", CASES)
def test_known_integrals_of_every_case_are_constant(case):
    top, expected = CASES[case]
    found = top.invariants
    assert set(found) == {"H", "C1", "C2", "C3"} | expected
    for name, expression in found.items():
        rate = sp.expand(top.bracket(expression, top.hamiltonian))
        assert rate == 0, f"d/dt {name} = {rate}"


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("top", "names"),
    [
        (Top(inertia=("I1", "I1", "I3"), a=(0, 0, "a3"), epsilon="epsilon"), {"l3", "P"}),
        (Top(inertia=("I1", "I1", "I3"), a=(0, 0, "a3"), b=(0, 0, "b3"), epsilon="epsilon"), {"l3", "P'"}),
        (Top(inertia=[2 * sp.Symbol("k")] * 2 + ["k"], a=("a1", "a2", 0), b=("b1", "b2", 0)), {"K", "G"}),
        (Top(inertia=("I", "I", "I"), a=("a1", "a2", "a3"), b=("b1", "b2", "b3")), {"S", "T"}),
        (Top(inertia=("I", "I", "I"), a=("a1", "a2", "a3"), epsilon="epsilon"), {"l.a", "P"}),
        (Top(inertia=("I1", "I2", "I3"), a=("a1", "a2", "a3"), b=("b1", "b2", "b3"), epsilon="epsilon"), set()),
    ],
)
def test_known_integrals_are_constant_for_symbolic_parameters(top, names):
    found = known_integrals(top.top_parameters, *top.bracket.fields.values())
    assert set(found) == names
    for expression in (*found.values(), top.hamiltonian):
        assert sp.expand(sp.simplify(top.bracket(expression, top.hamiltonian))) == 0


def test_kovalevskayas_quartic_is_the_classical_one():
    top = Top.kovalevskaya()
    l, alpha, _ = top.bracket.fields.values()
    w1, w2 = l[0] / 2, l[1] / 2
    assert sp.expand(top.invariants["K"] - (w1**2 - w2**2 + alpha[0]) ** 2 - (2 * w1 * w2 + alpha[1]) ** 2) == 0


def test_twisted_lagrange_p_is_the_formula_of_the_paper():
    top = Top(inertia=("I1", "I1", "I3"), a=(0, 0, "a3"), epsilon="epsilon")
    l, alpha, beta = top.bracket.fields.values()
    expected = l.dot(alpha) + sp.prod(sp.symbols("epsilon I1 a3")) * beta[2]
    assert sp.expand(top.invariants["P"] - expected) == 0


@pytest.mark.parametrize(
    ("integral", "wrong"),
    [
        ("K", Top.kovalevskaya(epsilon=1)),
        ("K", Top(inertia=(1, 1, 2), a=(-1, 0, 0))),
        ("P", Top.twisted_lagrange(transverse=2)),
        ("G", Top(inertia=(2, 2, 1), a=(1, 0, 0), b=(0, 1, 0), epsilon=1)),
        ("S", Top(inertia=(3, 3, 3), a=(1, 2, -1), b=(0, 1, 4), epsilon=1)),
    ],
)
def test_the_integrals_are_not_constant_for_the_neighbouring_tops(integral, wrong):
    owner = {"K": Top.kovalevskaya(), "P": Top.twisted_lagrange()}.get(integral) or Top(
        inertia=wrong.inertia, a=wrong.a, b=wrong.b
    )
    assert sp.expand(wrong.bracket(owner.invariants[integral], wrong.hamiltonian)) != 0


def test_the_field_of_a_top_is_derived_from_its_bracket():
    top = Top(inertia=("I1", "I2", "I3"), a=("a1", "a2", "a3"), b=("b1", "b2", "b3"), epsilon="epsilon")
    written_out = top.top_parameters.equations(*top.bracket.fields.values())
    derived = top.bracket.vector_field(top.hamiltonian)
    assert list(top.equations.values()) == list(derived)
    assert [sp.expand(w - d) for w, d in zip(written_out, derived, strict=True)] == [0] * 9


def test_named_cases_have_the_parameters_of_the_literature():
    assert Top.kovalevskaya(epsilon=1).field() == TopField((2.0, 2.0, 1.0), (-1.0, 0.0, 0.0), (0.0, 0.0, 0.0), 1.0)
    assert Top.twisted_kovalevskaya().field() == Top.kovalevskaya(1).field()
    assert Top.kovalevskaya().name == "Kovalevskaya top"
    assert Top.kovalevskaya(1).name == "twisted Kovalevskaya top"
    assert Top.lagrange(transverse=3, axial=2, a3=5).inertia == (3, 3, 2)
    assert Top.charged_lagrange(b3=7).b == (0, 0, 7)
    assert Top.twisted_lagrange(epsilon=4).epsilon == 4
    assert Top.free_rigid_body((1, 2, 3)).a == (0, 0, 0)
    assert [Top(inertia=(1, 1, 1), **given).name for given in ({}, {"a": (1, 0, 0)}, {"b": (1, 0, 0)})] == [
        "free rigid body",
        "heavy top",
        "charged heavy top",
    ]
    assert Top(inertia=(1, 1, 1), epsilon=1).name == "twisted top"


@pytest.mark.parametrize(
    ("inertia", "message"),
    [
        ((0, 1, 1), "I1 = 0"),
        ((1, -2, 1), "I2 = -2"),
        ((1, 1, -sp.sqrt(2)), r"I3 = -sqrt\(2\)"),
        ((1, 1, float("nan")), "nan"),
        ((1, 1, float("inf")), "inf"),
    ],
)
def test_moments_of_inertia_are_positive_and_finite(inertia, message):
    with pytest.raises(ParameterError, match=message):
        Top(inertia=inertia)


@pytest.mark.parametrize("name", ["inertia", "a", "b"])
def test_vectors_have_three_components(name):
    with pytest.raises(ShapeError, match=f"{name} must be 3 numbers.*got shape \\(2,\\)"):
        Top(**({"inertia": (1, 1, 1)} | {name: (1, 2)}))


def test_impossible_bodies_are_warned_about_and_integrated_all_the_same():
    with pytest.warns(InertiaWarning, match="I3 = 3 and 1, 1") as caught:
        top = Top(inertia=(1, 1, 3))
    assert caught[0].filename == __file__
    assert top.field().inertia == (1.0, 1.0, 3.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        Top(inertia=(1, 1, 2))
        Top(inertia=("I1", "I2", "I3"))


def test_moments_that_no_double_can_hold_are_refused():
    with pytest.raises(ParameterError, match=r"I3 must be positive"):
        Top(inertia=(1, 1, "1e-320")).field()


def test_a_symbolic_parameter_is_named_by_field():
    with pytest.raises(ParameterError, match=r"epsilon must be a number.*free symbol epsilon"):
        Top.kovalevskaya("epsilon").field()


@pytest.mark.thorough
def test_a_top_needs_no_sympy_until_an_expression_is_asked_for():
    code = (
        "import sys\n"
        "from liepoisson.model.tops import Top\n"
        "top = Top(inertia=(2, 2, 0.5), a=(-1, 0, '1/3'), b=(0, 0, 0), epsilon=1)\n"
        "Top.kovalevskaya(epsilon=1).field(), Top.lagrange().field(), top.field(), repr(top), top.name, top.inertia\n"
        "heavy = {'sympy', 'xarray', 'matplotlib', 'scipy', 'pandas'} & set(sys.modules)\n"
        "assert not heavy, heavy\n"
        "top.equations\n"
        "assert 'sympy' in sys.modules\n"
    )
    subprocess.run([sys.executable, "-W", "error", "-c", code], check=True)


@pytest.mark.parametrize(
    "parameters",
    [
        {"inertia": ("l1", 2, 2)},
        {"inertia": (2, 2, 1), "a": ("alpha1", 0, 0)},
        {"inertia": (2, 2, 1), "b": (0, 2 * sp.Symbol("beta3", positive=True), 0)},
        {"inertia": (2, 2, 1), "epsilon": "l2"},
    ],
)
def test_a_parameter_is_not_named_like_a_coordinate(parameters):
    with pytest.raises((BracketError, ParameterError), match=r"name both|a name must stand for one thing"):
        Top(**parameters)


def test_a_function_is_no_parameter():
    with pytest.raises(ParameterError, match=r"I1 must be a finite real number or name; got f\(1\)"):
        Top(inertia=(sp.Function("f")(1), 1, 1))


def test_a_top_can_be_pickled_at_any_time():
    top = Top(inertia=(2, 3, 4), a=(1, "1/3", 0), epsilon=1)
    x = [0.1] * 9
    expected = top.vector_field(x)
    copy = pickle.loads(pickle.dumps(top))
    assert (copy.vector_field(x) == expected).all()
    assert copy.field() == top.field()


def test_a_warning_about_the_inertia_points_to_the_caller():
    for make in (lambda: Top(inertia=(1, 1, 3)), lambda: Top.heavy(inertia=(1, 1, 3), a=(0, 0, 1))):
        with pytest.warns(InertiaWarning) as caught:
            make()
        assert caught[0].filename == __file__


def test_a_top_is_what_its_parameters_say():
    """Runs know a top by its parameters; they would not see what a subclass changes."""
    with pytest.raises(ParameterError, match="Top cannot have subclasses, as Doubled would be"):

        class Doubled(Top):
            @property
            def hamiltonian(self):
                return super().hamiltonian * 2
