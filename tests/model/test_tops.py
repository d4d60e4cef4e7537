import pickle
import warnings

import pytest
import sympy as sp

from liepoisson import catalog, read_system
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
        assert sp.expand(top.bracket(expression, top.hamiltonian)) == 0


def test_kovalevskayas_quartic_is_the_classical_one():
    top = Top.kovalevskaya()
    l, alpha, _ = top.bracket.fields.values()
    w1, w2 = l[0] / 2, l[1] / 2
    assert sp.expand(top.invariants["K"] - (w1**2 - w2**2 + alpha[0]) ** 2 - (2 * w1 * w2 + alpha[1]) ** 2) == 0


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


def test_impossible_bodies_are_warned_about_and_integrated_all_the_same():
    with pytest.warns(InertiaWarning, match="I3 = 3 and 1, 1") as caught:
        top = Top(inertia=(1, 1, 3))
    assert caught[0].filename == __file__
    assert top.field().inertia == (1.0, 1.0, 3.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        Top(inertia=(1, 1, 2))
        Top(inertia=("I1", "I2", "I3"))


@pytest.mark.parametrize("name", ["heavy-top", "free-rigid-body", "twisted-kovalevskaya"])
def test_impossible_bodies_are_warned_about_wherever_the_inertia_of_a_top_is_read(name, tmp_path):
    with pytest.warns(InertiaWarning, match="I3 = 5/2 and 1, 4/5") as caught:
        top = catalog.system(name, {"I": (1, "4/5", "5/2")})
    assert [one.filename for one in caught] == [__file__]
    assert top.bracket.dimension in {3, 6, 9}
    file = tmp_path / "mine.toml"
    file.write_text(catalog.path("lagrange").read_text().replace('[1, 1, "1/2"]', "[1, 1, 3]"))
    with pytest.warns(InertiaWarning, match="I3 = 3 and 1, 1"):
        read_system(file)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        catalog.system("so21-heavy-top", {"I": (1, 1, 3)})  # no body in space


def test_a_top_can_be_pickled_at_any_time():
    top = Top(inertia=(2, 3, 4), a=(1, "1/3", 0), epsilon=1)
    x = [0.1] * 9
    expected = top.vector_field(x)
    copy = pickle.loads(pickle.dumps(top))
    assert (copy.vector_field(x) == expected).all()
    assert copy.field() == top.field()


def test_a_top_is_what_its_parameters_say():
    """Runs know a top by its parameters; they would not see what a subclass changes."""
    with pytest.raises(ParameterError, match="Top cannot have subclasses, as Doubled would be"):

        class Doubled(Top):
            @property
            def hamiltonian(self):
                return super().hamiltonian * 2


@pytest.mark.parametrize(
    ("make", "message"),
    [
        *((lambda n=n: Top(inertia=(n, 1, 1)), f"I1 = {n}") for n in (0, -2)),
        (lambda: Top(inertia=(1, 1, -sp.sqrt(2))), r"I3 = -sqrt\(2\)"),
        (lambda: Top(inertia=(1, 1, float("nan"))), "nan"),
        (lambda: Top(inertia=(1, 1, float("inf"))), "inf"),
        (lambda: Top(inertia=(1, 1, "1e-320")).field(), "I3 must be positive"),
        (lambda: Top(inertia=(sp.Function("f")(1), 1, 1)), r"I1 must be a finite real number or name; got f\(1\)"),
        *((lambda name=name: Top(**{"inertia": (1, 1, 1), name: (1, 2)}), f"{name} must be 3 n") for name in "ab"),
        (lambda: Top.kovalevskaya("epsilon").field(), r"epsilon must be a number.*free symbol epsilon"),
        (lambda: Top(inertia=("l1", 2, 2)), "name both|a name must stand for one thing"),
        (lambda: Top(inertia=(2, 2, 1), epsilon="l2"), "name both|a name must stand for one thing"),
    ],
)
def test_what_is_no_top_is_refused(make, message):
    with pytest.raises((BracketError, ParameterError, ShapeError), match=message):
        make()
