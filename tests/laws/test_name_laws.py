"""No name that a user chooses changes a number: every name gives the bits of a harmless one, or a typed error."""

from functools import cache

import numpy as np
import pytest
import sympy as sp
from hostile_names import FAMOUS, REFUSED, accepted

import liepoisson as lp
from liepoisson.cli.systems import with_settings
from liepoisson.errors import LiePoissonError
from liepoisson.inputs.names import CONSTANTS, FUNCTIONS, MAX_NAME
from liepoisson.model.canonical_system import CanonicalSystem
from liepoisson.model.charts.euler_chart import EulerChart
from liepoisson.model.system_file_reader import parse_system_file
from liepoisson.structure.extension import Extension
from liepoisson.structure.lie_algebra import LieAlgebra
from liepoisson.sweeps.family import FileFamily
from liepoisson.sweeps.identity import system_record
from liepoisson.sweeps.points import evaluate_targets
from liepoisson.sweeps.spec import Axis, Starts, SweepSpec

HARMLESS = "harmless"
QUICK = ("e", "lambda", "arcsin", "__debug__", "_c0")
STATES = np.random.default_rng(12).uniform(0.1, 0.9, (4, 3))
ROTATIONS = [[[0, 0, 0], [0, 0, 1], [0, -1, 0]], [[0, 0, -1], [0, 0, 0], [1, 0, 0]], [[0, 1, 0], [-1, 0, 0], [0, 0, 0]]]
# Constants that NumPy has, and functions that it calls otherwise.
FORMULA = "exp(1)*{0} + pi*{0}^2 + asin({0}/10)*sqrt({0}^2 + 1)"


def numbers_of(system):
    """Everything that is evaluated or lowered: values, derivatives, tapes."""
    energy, functions = system.functions.energy, system.functions
    arrays = system.vector_field(STATES), energy(STATES), energy.gradient(STATES), energy.hessian(STATES)
    whole = (*arrays, functions.jacobian(STATES), *system.invariant_values(STATES).values())
    return [array.tobytes() for array in whole], system.field(), system.function_tape(system.hamiltonian)


def with_parameter(name):
    return lp.System(lp.so(3) @ lp.trivial(), f"l1*l2*({FORMULA})".format(name), {name: "1/3"})


def with_vector(name):
    return lp.System(lp.so(3) @ lp.trivial(), f"dot({name}, l)*dot(l, inv({name})*l)*exp(1)*pi", {name: [1, 2, "1/3"]})


def with_field(name):
    bracket = (lp.so(3) @ lp.trivial()).rename(name)
    return lp.System(bracket, f"dot({name}, {name})*exp(1) + pi*asin({name}[2]/9)*{name}[1]")


def with_coordinate(name):
    algebra = LieAlgebra(ROTATIONS, basis_names=[name[-1], "rest", "more"])
    bracket = (algebra @ lp.trivial()).rename(name[:-1])
    rest = f"{name[:-1]}rest"
    # without a root: its second derivatives would take most of the time
    return lp.System(bracket, f"exp(1)*{name} + pi*{name}^2 + asin({name}/10) + {name}*{rest} + {rest}^4")


def with_expression(name):
    x = (lp.so(3) @ lp.trivial()).rename("uu").variables
    energy = sp.E * sp.Symbol(name) * x[0] + sp.pi * x[1] ** 3 * sp.asin(x[0] / 9)
    return lp.System((lp.so(3) @ lp.trivial()).rename("uu"), energy, {name: 2})


def with_algebra_symbol(name):
    scaled = [[[0 if c == 0 else c * sp.Symbol(name) for c in row] for row in matrix] for matrix in ROTATIONS]
    return lp.System(LieAlgebra(scaled) @ lp.trivial(), "l1^2 + exp(1)*l2^3 + asin(l3/9)", {name: "1/3"})


def with_integral(name):
    return lp.System(lp.so(3) @ lp.trivial(), "dot(l, l)*pi + exp(l3)", integrals={name: "exp(1)*asin(l3)"})


def with_file_parameter(name):
    return file_with(name).system()


def file_with(name):
    return parse_system_file(
        f'[bracket]\nalgebra = "so(3)"\nvariables = ["uu"]\n[parameters]\n{name} = "1/3"\n[hamiltonian]\n'
        f'expression = "dot(uu, uu)/2 + exp(1)*{name}*uu1 + pi*asin({name})*uu2^3"\n'
    )


def with_setting(name):
    return with_settings(file_with(name), [f"{name}=2/7*exp(1)"]).system()


PLACES = (
    with_parameter, with_vector, with_field, with_coordinate, with_expression, with_algebra_symbol, with_integral,
    with_file_parameter, with_setting,
)  # fmt: skip


@cache
def right_numbers(place):
    return numbers_of(place(HARMLESS))


def is_taken(place, name):
    """Whether the text of a place uses the name for something else, or the place cannot spell it."""
    if place is with_coordinate:
        longest = MAX_NAME - len("est")  # of the coordinate that is called after it, ...rest
        return (
            not 2 <= len(name) <= longest
            or not name[:-1].isidentifier()
            or name[-1].isdigit()
            or name[:-1] in (*FUNCTIONS, *CONSTANTS)
        )
    used = {"l", "l1", "l2", "l3", "uu", "uu1", "uu2", "uu3", "symbols", "H"}
    return name in used and place is not with_field


@pytest.mark.parametrize("place", PLACES, ids=lambda place: place.__name__)
@pytest.mark.parametrize("name", QUICK)
def test_a_name_changes_no_bit(place, name):
    if not is_taken(place, name):
        assert numbers_of(place(name)) == right_numbers(place)


def canonical_numbers(q, p, angle):
    energy = f"{p}^2/2*exp(1) + pi*{q}^4 + asin({q}/9)*{p}"
    system = CanonicalSystem([q], [p], energy, quadratures={angle: f"{p}*{q}*exp(1)"})
    rates, jacobian = system.vector_field(STATES), system.functions.jacobian(STATES)
    return rates.tobytes(), jacobian.tobytes(), system.functions.energy(STATES).tobytes(), system.field()


def targets(axis, formula, tables):
    axes = Axis(axis, (0.25, 0.5)), Axis("other", (0.1, 0.2))
    starts = Starts(casimirs={"C1": f"exp(1)*{axis} + other"}, energy=f"pi*{axis}*other")
    spec = SweepSpec(
        tables,
        axes,
        t_end=9.0,
        parameters={"uu": formula.format(axis), "vv": ["other", f"{axis}^2", 1]},
        starts=starts,
    )
    points = np.array([[0.25, 0.1], [0.5, 0.2], [0.25, 0.2]])
    found = evaluate_targets(spec, FileFamily(tables, "tables"), points)
    arrays = (*found.parameters.values(), *found.casimirs.values(), found.energy)
    return [array.tobytes() for array in arrays]


TABLES = {
    "bracket": {"algebra": "so(3)"},
    "parameters": {"uu": 1, "vv": [1, 2, 3]},
    "hamiltonian": {"expression": "dot(l, inv(vv)*l) + uu*l1^3"},
}


def top_tables(name):
    return {
        "bracket": {"algebra": "so(3)", "extension": f"leibniz(3, {name})"},
        "parameters": {"I": [2, 2, 1], name: 1},
        "hamiltonian": {"expression": f"dot(l, inv(I)*l)/2 + exp(1)*{name}*alpha1"},
    }


@pytest.mark.parametrize("name", ["e", "_0"])
def test_a_sweep_over_a_parameter_of_a_top_is_the_same_under_any_name(name):
    def mean(axis):
        return lp.sweep(system=top_tables(axis), axes={axis: [0.5, 1, 2]}, n_starts=4, t_end=20, seed=1, threads=1).mean

    np.testing.assert_array_equal(mean(name), mean(HARMLESS))


def test_systems_with_one_text_have_different_records():
    bracket = lp.so(3) @ lp.trivial()
    constant, symbol = (lp.System(bracket, c * bracket.variables[0], symbols=["E"]) for c in (sp.E, sp.Symbol("E")))
    assert str(constant.hamiltonian) == str(symbol.hamiltonian)
    assert system_record(constant) != system_record(symbol)
    pair = lp.so(3) @ lp.semidirect(2)
    one, other = (lp.System(pair.rename(*names), "u1*v2 + u3^2") for names in ("uv", "vu"))
    assert str(one.hamiltonian) == str(other.hamiltonian)
    assert system_record(one) != system_record(other)


def test_a_parameter_of_a_symmetry_is_not_called_like_one_of_the_bracket():
    d = sp.Symbol("d")
    extension = Extension([[[1, 0], [0, 0]], [[0, 1], [1, 0]]])
    texts = [str(found) for found in (lp.so(3) @ extension.rename("d", "u")).derivations()]
    assert not any("d*d" in text for text in texts), texts
    scaled = Extension(
        [[[1, 0, 0], [0, 0, 0], [0, 0, 0]], [[0, 1, 0], [1, 0, 0], [0, 0, 0]], [[0, 0, 1], [0, d, 0], [1, 0, 0]]]
    )
    nilpotent = [s for s in (lp.so(3) @ scaled).derivations() if s.kind == "nilpotent"]
    assert nilpotent
    assert all("d_" in str(found) for found in nilpotent)


@pytest.mark.parametrize("name", QUICK)
def test_canonical_coordinates_and_axes_may_have_any_name(name):
    right = canonical_numbers("qq", "pp", "aa")
    assert canonical_numbers(name, "pp", "aa") == canonical_numbers("qq", name, "aa") == right
    assert canonical_numbers("qq", "pp", name) == right
    assert targets(name, FORMULA, TABLES) == targets(HARMLESS, FORMULA, TABLES)


@pytest.mark.slow
def test_canonical_coordinates_and_axes_may_have_any_famous_name():
    """An axis called energy is the energy of the starts, so that no other formula may give it."""
    right, others = canonical_numbers("qq", "pp", "aa"), targets(HARMLESS, FORMULA, TABLES)
    assert [name for name in FAMOUS if canonical_numbers(name, "pp", "aa") != right] == []
    names = [name for name in FAMOUS if name != "energy"]
    assert [name for name in names if targets(name, FORMULA, TABLES) != others] == []


@pytest.mark.thorough
@pytest.mark.parametrize(
    "place",
    [
        *(place for place in PLACES if place not in (with_expression, with_coordinate, with_integral)),
        lambda name: CanonicalSystem([name], ["pp"], "1"),
        lambda name: CanonicalSystem(["qq"], [name], "1"),
        lambda name: Axis(name, (0.0, 1.0)),
    ],
)
def test_what_is_no_name_is_refused(place):
    for name in REFUSED:
        with pytest.raises(LiePoissonError):
            place(name)


def swept(axis, **parameters):
    terms = {"C": "dot(C, C)*l2", "energy": "energy*l2"}
    energy = " + ".join(["dot(l, l)", *(terms[name] for name in parameters)])
    tables = {"bracket": {"algebra": "so(3)"}, "parameters": parameters, "hamiltonian": {"expression": energy}}
    spec = SweepSpec(tables, (Axis(axis, (1.0, 2.0)),), t_end=9.0)
    return evaluate_targets(spec, FileFamily(tables, "tables"), np.array([[1.0], [2.0]]))


SO3, l1 = lp.so(3) @ lp.trivial(), sp.Symbol("l1")
FREE = CanonicalSystem(["q"], ["p"], sp.Symbol("e") * sp.Symbol("q") ** 2 + sp.Symbol("p") ** 2, symbols=["e"])
TWICE = lp.System(SO3, "C1*l1 + C2*l2", {"C": [2, 3]})
LABELLED = lp.System(SO3, "l3", integrals={"l1": "l3"})
ROUND = lp.System(SO3, "dot(l, l)")
A_FILE = '[bracket]\nalgebra = "so(3)"\n[parameters]\na = 1\npi = 3\n[hamiltonian]\nexpression = "a*l1"\n'


@pytest.mark.parametrize(
    ("call", "words"),
    [
        *((lambda n=n: with_coordinate(n), f"constant of formulas; got {n}") for n in ("pi", "sin", "atan")),
        (lambda: parse_system_file(A_FILE), r"line 5: .parameters. pi: .*constant of formulas"),
        (lambda: FREE.functions.jacobian(np.ones((2, 2))), "none for e"),
        (lambda: FREE.functions.energy(np.ones((2, 2))), "none for e"),
        (lambda: lp.System(SO3, "u*l1 + v*l2", {"u": "v", "v": 2}), "on another one that has a value; u = v"),
        (lambda: lp.System(SO3, lambda l: sp.Symbol("I1") * l[0], {"I": [1, 2, 3], "I1": 5}), "I1 would be"),
        (lambda: TWICE.functions.of("C1"), "a name must stand for one thing; C1 is 2 in formulas"),
        (lambda: LABELLED.expression("l1"), "l1 is l1 in formulas, and the invariant l3"),
        (lambda: ROUND.function_tape(sp.Function("sin")(l1)), r"got sin\(l1\), an undefined function"),
        (lambda: ROUND.functions.of(sp.Function("sin")(l1))(STATES), r"got sin\(l1\), an undefined function"),
        (lambda: ROUND.functions.of(sp.Sum(l1 ** sp.Symbol("e"), (sp.Symbol("e"), 1, 3)))(STATES), "of its own"),
        *((lambda n=n: EulerChart(lp.Top(inertia=(2, 2, 1), a=(-1, 0, 0), epsilon=n)), f"{n} would be a parameter,")
          for n in ("phi", "p_theta", "v", "eta", "q0", "X", "c_phi")),
        (lambda: swept("C1", C=[1, 2]), "axis C1: a name must stand for one thing"),
        (lambda: swept("energy", energy=1), "axis energy: a name must stand for one thing"),
        (lambda: targets("energy", FORMULA, TABLES), "axis energy: the energy of the starts has another"),
    ],
)  # fmt: skip
def test_one_name_stands_for_one_thing(call, words):
    with pytest.raises(LiePoissonError, match=words):
        call()
    assert TWICE.expression("1*C1") == 2


@pytest.mark.slow
@pytest.mark.parametrize("place", PLACES, ids=lambda place: place.__name__)
def test_no_name_of_sympy_numpy_or_python_changes_a_bit(place):
    names = [name for name in accepted() if not is_taken(place, name)]
    assert [name for name in names if numbers_of(place(name)) != right_numbers(place)] == []
