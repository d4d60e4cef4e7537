"""No name that a user chooses changes a number: every name gives the bits of a harmless one, or a typed error."""

from functools import cache

import numpy as np
import pytest
import sympy as sp
from hostile_names import FAMOUS, REFUSED, accepted

import liepoisson as lp
from liepoisson.cli.systems import with_settings
from liepoisson.errors import LiePoissonError, ParameterError
from liepoisson.inputs.names import CONSTANTS, FUNCTIONS, MAX_NAME
from liepoisson.model.canonical_system import CanonicalSystem
from liepoisson.model.system_file_reader import parse_system_file
from liepoisson.structure.extension import Extension
from liepoisson.structure.lie_algebra import LieAlgebra
from liepoisson.sweeps.family import FileFamily
from liepoisson.sweeps.spec import Axis, Starts, SweepSpec
from liepoisson.sweeps.targets import evaluate_targets

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
    return lp.System(
        lp.so(3) @ lp.trivial(), f"uu_l({FORMULA})".replace("uu_l(", "l1*l2*(").format(name), {name: "1/3"}
    )


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


@pytest.mark.slow
@pytest.mark.parametrize("place", PLACES, ids=lambda place: place.__name__)
def test_no_famous_name_changes_a_bit(place):
    changed = [name for name in FAMOUS if not is_taken(place, name) and numbers_of(place(name)) != right_numbers(place)]
    assert changed == []


@pytest.mark.slow
@pytest.mark.parametrize("place", PLACES, ids=lambda place: place.__name__)
def test_no_name_of_sympy_numpy_or_python_changes_a_bit(place):
    names = [name for name in accepted() if not is_taken(place, name)]
    assert [name for name in names if numbers_of(place(name)) != right_numbers(place)] == []


@pytest.mark.thorough
@pytest.mark.parametrize("place", PLACES, ids=lambda place: place.__name__)
def test_names_of_functions_and_constants_and_what_is_no_name_are_refused(place):
    names = (
        [*REFUSED, *FUNCTIONS]
        if place not in (with_integral, with_expression, with_coordinate)
        else [*FUNCTIONS, *CONSTANTS]
    )
    for name in names:
        if place is with_integral:
            continue  # it has a label and no name: nothing reads it in formulas
        with pytest.raises(LiePoissonError):
            place(name)


def test_a_coordinate_may_not_be_called_like_the_constant():
    for name in ("pi", "sin", "sqrt", "atan", "inv"):
        with pytest.raises(ParameterError, match=f"function or constant of formulas; got {name}"):
            with_coordinate(name)


def test_a_file_names_the_line_of_a_refused_name():
    text = '[bracket]\nalgebra = "so(3)"\n[parameters]\na = 1\npi = 3\n[hamiltonian]\nexpression = "a*l1"\n'
    with pytest.raises(LiePoissonError, match=r"line 5: .parameters. pi: .*constant of formulas"):
        parse_system_file(text)
    text = '[bracket]\nstructure_constants = [[[0]]]\nbasis_names = ["i"]\nvariables = ["p"]\n[hamiltonian]\n'
    text += 'expression = "p[1]"\n'
    with pytest.raises(LiePoissonError, match=r"line 4: .bracket. variables: .*constant of formulas; got pi"):
        parse_system_file(text)


def canonical_numbers(q, p, angle):
    energy = f"{p}^2/2*exp(1) + pi*{q}^4 + asin({q}/9)*{p}"
    system = CanonicalSystem([q], [p], energy, quadratures={angle: f"{p}*{q}*exp(1)"})
    rates, jacobian = system.vector_field(STATES), system.functions.jacobian(STATES)
    return rates.tobytes(), jacobian.tobytes(), system.functions.energy(STATES).tobytes(), system.field()


@pytest.mark.parametrize("name", QUICK)
def test_canonical_coordinates_may_have_any_name(name):
    right = canonical_numbers("qq", "pp", "aa")
    assert canonical_numbers(name, "pp", "aa") == canonical_numbers("qq", name, "aa") == right
    assert canonical_numbers("qq", "pp", name) == right


@pytest.mark.thorough
def test_canonical_coordinates_and_axes_may_have_any_famous_name():
    right, others = canonical_numbers("qq", "pp", "aa"), targets(HARMLESS, FORMULA, TABLES)
    assert [name for name in FAMOUS if canonical_numbers(name, "pp", "aa") != right] == []
    # An axis called energy is the energy of the starts, so that no other formula may give it.
    names = [name for name in FAMOUS if name != "energy"]
    assert [name for name in names if targets(name, FORMULA, TABLES) != others] == []
    with pytest.raises(LiePoissonError, match="axis energy: the energy of the starts has another"):
        targets("energy", FORMULA, TABLES)


def test_canonical_systems_refuse_what_is_no_name():
    for name in (*REFUSED, "q[3]"):
        for names in ((name, "pp"), ("qq", name)):
            with pytest.raises(LiePoissonError):
                CanonicalSystem([names[0]], [names[1]], "1")


def test_a_free_symbol_of_a_canonical_system_is_no_constant_of_numpy():
    system = CanonicalSystem(["q"], ["p"], sp.Symbol("e") * sp.Symbol("q") ** 2 + sp.Symbol("p") ** 2, symbols=["e"])
    for name in ("jacobian", "energy"):
        with pytest.raises(ParameterError, match="e has none"):
            getattr(system.functions, name)(np.ones((2, 2)))


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


@pytest.mark.parametrize("name", QUICK)
def test_axes_may_have_any_name(name):
    assert targets(name, FORMULA, TABLES) == targets(HARMLESS, FORMULA, TABLES)


def test_axes_refuse_what_is_no_name():
    for name in (*REFUSED, None, 3, ["e"]):
        with pytest.raises(ParameterError):
            Axis(name, (0.0, 1.0))


def top_tables(name):
    return {
        "bracket": {"algebra": "so(3)", "extension": f"leibniz(3, {name})"},
        "parameters": {"I": [2, 2, 1], name: 1},
        "hamiltonian": {"expression": f"dot(l, inv(I)*l)/2 + exp(1)*{name}*alpha1"},
    }


@pytest.mark.parametrize("name", ["e", "lambda", "arcsin", "_0"])
def test_a_sweep_over_a_parameter_of_a_top_is_the_same_under_any_name(name):
    def mean(axis):
        return lp.sweep(system=top_tables(axis), axes={axis: [0.5, 1, 2]}, n_starts=4, t_end=20, seed=1, threads=1).mean

    np.testing.assert_array_equal(mean(name), mean(HARMLESS))


def test_symbols_of_extensions_are_replaced_all_at_once():
    s, t = sp.symbols("s t")
    extension = Extension([[[s, 0], [0, 0]], [[0, s], [s, t]]], check=False)
    exchanged = extension.substitute({"s": t, "t": s})
    assert (exchanged.tensor[0][0][0], exchanged.tensor[1][1][1]) == (t, s)
    algebra = LieAlgebra([[[0, 0], [s, t]], [[-s, -t], [0, 0]]], check=False).substitute({"s": t, "t": s})
    assert algebra.brackets == {(0, 1): {0: t, 1: s}}


def test_a_value_may_not_be_the_name_of_another_parameter():
    with pytest.raises(ParameterError, match="must not depend on another one that has a value; u = v"):
        lp.System(lp.so(3) @ lp.trivial(), "u*l1 + v*l2", {"u": "v", "v": 2})


def test_one_name_may_not_stand_for_two_numbers():
    with pytest.raises(ParameterError, match="I1 would be"):
        lp.System(lp.so(3) @ lp.trivial(), lambda l: sp.Symbol("I1") * l[0], {"I": [1, 2, 3], "I1": 5})


def test_a_name_alone_that_is_an_invariant_and_something_else_is_refused():
    system = lp.System(lp.so(3) @ lp.trivial(), "C1*l1 + C2*l2", {"C": [2, 3]})
    with pytest.raises(ParameterError, match="a name must stand for one thing; C1 is 2 in formulas"):
        system.functions.of("C1")
    assert system.expression("1*C1") == 2
    labelled = lp.System(lp.so(3) @ lp.trivial(), "l3", integrals={"l1": "l3"})
    with pytest.raises(ParameterError, match="l1 is l1 in formulas, and the invariant l3"):
        labelled.expression("l1")


def test_functions_that_are_called_like_ours_are_others():
    x = sp.Symbol("l1")
    mine = sp.Function("sin")(x)
    system = lp.System(lp.so(3) @ lp.trivial(), "dot(l, l)")
    for use in (system.function_tape, lambda f: system.functions.of(f)(STATES)):
        with pytest.raises(ParameterError, match=r"got sin\(l1\), an undefined function"):
            use(mine)
    bound = sp.Sum(x ** sp.Symbol("e"), (sp.Symbol("e"), 1, 3))
    with pytest.raises(lp.errors.UnsupportedFieldError, match="no variable of its own"):
        system.functions.of(bound)(STATES)


def test_systems_with_one_text_have_different_records():
    from liepoisson.sweeps.identity import system_record

    bracket = lp.so(3) @ lp.trivial()
    constant, symbol = (lp.System(bracket, c * bracket.variables[0], symbols=["E"]) for c in (sp.E, sp.Symbol("E")))
    assert str(constant.hamiltonian) == str(symbol.hamiltonian)
    assert system_record(constant) != system_record(symbol)
    pair = lp.so(3) @ lp.semidirect(2)
    one, other = (lp.System(pair.rename(*names), "u1*v2 + u3^2") for names in ("uv", "vu"))
    assert str(one.hamiltonian) == str(other.hamiltonian)
    assert system_record(one) != system_record(other)


@pytest.mark.parametrize("name", ["phi", "p_theta", "v", "eta", "q0", "X", "c_phi"])
def test_charts_refuse_symbols_that_are_their_own(name):
    from liepoisson.model.charts.euler_chart import EulerChart

    with pytest.raises(ParameterError, match=f"{name} would be a parameter, and a coordinate or constant of a chart"):
        EulerChart(lp.Top(inertia=(2, 2, 1), a=(-1, 0, 0), b=(0, 0, 0), epsilon=name))


def test_an_axis_may_not_be_a_casimir_and_a_parameter():
    for name, parameters, term in (("C1", {"C": [1, 2]}, "dot(C, C)*l2"), ("energy", {"energy": 1}, "energy*l2")):
        tables = {
            "bracket": {"algebra": "so(3)"},
            "parameters": parameters,
            "hamiltonian": {"expression": f"dot(l, l) + {term}"},
        }
        spec = SweepSpec(tables, (Axis(name, (1.0, 2.0)),), t_end=9.0)
        with pytest.raises(ParameterError, match=f"axis {name}: a name must stand for one thing"):
            evaluate_targets(spec, FileFamily(tables, "tables"), np.array([[1.0], [2.0]]))


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["mean", "member", "outcome", "exponent"])
def test_the_dataset_of_a_sweep_has_room_for_axes_of_any_name(name):
    result = lp.sweep(system=top_tables(name), axes={name: [0.5, 1]}, n_starts=2, t_end=2, threads=1)
    assert result.dataset["mean"].dims == (f"axis_{name}",)
    np.testing.assert_array_equal(result.dataset[f"axis_{name}"], [0.5, 1])


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
