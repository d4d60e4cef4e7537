"""Brackets that are given by formulas: known ones, random ones, and those that are none."""

import pickle
import re
from itertools import combinations
from random import Random

import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.errors import BracketError, ExpressionError, JacobiError, ParameterError, ShapeError

CYCLE = {("x", "y"): "x*y", ("y", "z"): "y*z", ("z", "x"): "z*x"}
"""The Lotka-Volterra bracket of three species, each of which eats the next."""
SO3 = {("l1", "l2"): "-l3", ("l1", "l3"): "l2", ("l2", "l3"): "-l1"}
SO3_BENT = {("x", "y"): "-z", ("x", "z"): "y - x^2", ("y", "z"): "2*x*(y - x^2) - x"}
BODY = "l1^2/4 + l2^2/6 + l3^2/2 + l1*l3/7"


def tensor(names, entries, **options):
    return lp.PoissonTensor(names.split(), entries, **options)


def test_three_species_keep_the_product_of_their_numbers():
    bracket = tensor("x y z", CYCLE)
    x, y, z = bracket.variables
    assert bracket.jacobi == "proved"
    assert bracket.casimirs() == [x * y * z]
    assert bracket.poisson_tensor() == sp.Matrix([[0, x * y, -x * z], [-x * y, 0, y * z], [x * z, -y * z, 0]])
    system = lp.System(bracket, "x + y + z")
    assert [sp.factor(rate) for rate in system.equations.values()] == [x * (y - z), -y * (x - z), z * (x - y)]
    assert system.vector_field([2, 3, 5]).tolist() == [-4, 9, -5]
    assert list(system.invariants.values()) == [x + y + z, x * y * z]


def test_so3_as_a_tensor_is_so3_to_the_last_bit():
    linear, wanted = lp.System(tensor("l1 l2 l3", SO3), BODY), lp.System(lp.so(3) @ lp.trivial(), BODY)
    assert linear.bracket.is_linear
    assert linear.bracket.entries() == wanted.bracket.entries()
    assert linear.equations == wanted.equations
    assert linear.bracket.casimirs() == wanted.bracket.casimirs()
    assert linear.field() == wanted.field()
    runs = [lp.integrate(one, [0.3, -0.4, 1.2], t_end=20).state for one in (linear, wanted)]
    assert (runs[0] == runs[1]).all()
    assert linear.bracket.rank([0, 0, 0]) == 0
    assert linear.bracket.rank() == linear.bracket.rank([0, 0, 1]) == 2


def test_the_sklyanin_bracket_has_its_two_quadratic_casimirs():
    """{S1, S2} = 2 S0 S3, {S1, S0} = 2 (a3 - a2) S2 S3, and so on in turn."""
    a = ["a1", "a2", "a3"]
    entries = {}
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        entries[f"S{i + 1}", f"S{j + 1}"] = f"2*S0*S{k + 1}"
        entries[f"S{i + 1}", "S0"] = f"2*({a[k]} - {a[j]})*S{j + 1}*S{k + 1}"
    bracket = tensor("S0 S1 S2 S3", entries, symbols=a)
    S = bracket.variables
    found = bracket.casimirs()
    squares = sum(v**2 for v in S[1:])
    weighted = S[0] ** 2 + sum(sp.Symbol(name) * v**2 for name, v in zip(a, S[1:], strict=True))
    report = bracket.casimir_report()
    assert (report.degrees, report.independent, report.corank, report.verified) == ((2, 2), 2, 2, True)
    for known in (squares, weighted):  # both are combinations of those that are found
        p, q = sp.symbols("p q")
        rest = sp.Poly(sp.numer(sp.together(known - p * found[0] - q * found[1])), *S).coeffs()
        assert sp.solve(rest, [p, q], dict=True)
    assert bracket.rank_certificate().proved
    assert bracket.rank() == 2


def test_a_nambu_bracket_turns_about_its_casimir():
    bracket = lp.brackets.nambu("x^2*y + z^3/3 + k*x*z", ["x", "y", "z"], {"k": 2}, factor="1 + y^2")
    x, y, z = bracket.variables
    C, H = x**2 * y + z**3 / 3 + 2 * x * z, x * y + z**2
    gradients = [sp.Matrix([f.diff(v) for v in (x, y, z)]) for f in (C, H)]
    wanted = (1 + y**2) * gradients[0].cross(gradients[1])
    assert sp.Matrix(bracket.vector_field(H)).expand() == wanted.expand()
    assert [sp.expand(c - C) for c in bracket.casimirs()] == [0]
    assert bracket.jacobi_certificate().proved
    sphere = lp.brackets.nambu("(l1^2 + l2^2 + l3^2)/2", ["l1", "l2", "l3"])
    assert sphere.poisson_tensor() == (lp.so(3) @ lp.trivial()).poisson_tensor()


# Random brackets: Lie-Poisson ones in new coordinates, against a check that shares no code with the package

SOURCES = {
    "so(3)": lambda: lp.so(3) @ lp.trivial(),
    "sl(2)": lambda: lp.sl(2) @ lp.trivial(),
    "Heisenberg": lambda: lp.algebras.heisenberg(1) @ lp.trivial(),
    "se(2)": lambda: lp.algebras.se(2) @ lp.trivial(),
    "four": lambda: (lp.algebras.affine(1) + lp.algebras.affine(1)) @ lp.trivial(),
}


def bent(name, random):
    """A bracket in coordinates y_k = x_k + p_k(x_1, ..., x_(k-1)), with its names and the polynomials p."""
    source = SOURCES[name]()
    old = source.variables
    new = sp.symbols(f"y1:{len(old) + 1}")
    shifts, back = [], []
    for k in range(len(old)):
        monomials = [a * b for i, a in enumerate(old[:k]) for b in old[i:k]]
        chosen = random.sample(monomials, min(len(monomials), 2))
        shifts.append(sum((random.randint(-3, 3) * m for m in chosen), sp.S.Zero))
        known = dict(zip(old, back, strict=False))
        back.append(sp.expand(new[k] - shifts[k].xreplace(known)))
    forward = {str(v): x + p for v, x, p in zip(new, old, shifts, strict=True)}
    return source, source.in_variables(forward, {str(x): b for x, b in zip(old, back, strict=True)})


def worst_residual(names, matrix, random):
    """The largest cyclic sum at a random state, by differences of the values of the entries."""
    n, h = len(names), 1e-4
    values = sp.lambdify(names, matrix.tolist(), "math")
    state = [random.uniform(-1, 1) for _ in names]

    def moved(m, step):
        return values(*(x + step * (k == m) for k, x in enumerate(state)))

    J, ahead, behind = values(*state), [moved(m, h) for m in range(n)], [moved(m, -h) for m in range(n)]
    slope = [[[(a - b) / (2 * h) for a, b in zip(*rows, strict=True)] for rows in zip(p, q, strict=True)]
             for p, q in zip(ahead, behind, strict=True)]  # fmt: skip
    worst = 0.0
    for i, j, k in combinations(range(n), 3):
        turns = ((i, j, k), (j, k, i), (k, i, j))
        terms = [slope[m][a][b] * J[m][c] for a, b, c in turns for m in range(n)]
        worst = max(worst, abs(sum(terms)) / (1 + sum(map(abs, terms))))
    return worst


@pytest.mark.parametrize("n", [pytest.param(40, marks=pytest.mark.thorough), pytest.param(200, marks=pytest.mark.slow)])
def test_random_brackets_pass_and_keep_rank_and_casimirs(n):
    random, casimirs = Random(5), 0
    for k in range(n):
        source, found = bent(list(SOURCES)[k % len(SOURCES)], random)
        assert found.jacobi == "proved"
        assert worst_residual(found.variables, found.poisson_tensor(), random) < 1e-6
        again = lp.PoissonTensor(found.coordinate_names_in_order, texts_of(found), casimirs=found.given_casimirs)
        assert again.rank() == source.rank()
        assert again.rank_certificate().proved
        assert len(again.given_casimirs) == len(source.casimirs())
        casimirs += len(again.given_casimirs)
    assert casimirs > n / 2


def texts_of(bracket):
    J, names = bracket.poisson_tensor(), bracket.coordinate_names_in_order
    pairs = combinations(range(len(names)), 2)
    return {(names[i], names[j]): str(J[i, j]).replace("**", "^") for i, j in pairs}


@pytest.mark.parametrize("n", [pytest.param(10, marks=pytest.mark.thorough), pytest.param(50, marks=pytest.mark.slow)])
def test_perturbed_brackets_are_refused(n):
    random, refused = Random(6), 0
    while refused < n:
        _, found = bent(random.choice(["so(3)", "sl(2)", "se(2)", "four"]), random)
        entries, names = texts_of(found), found.coordinate_names_in_order
        pair = random.choice(list(entries))
        entries[pair] += f" + {random.choice(names)}*{random.choice(names)}"
        wrong = lp.PoissonTensor(names, entries, check=False)
        if worst_residual(wrong.variables, wrong.poisson_tensor(), random) < 1e-3:
            continue
        refused += 1
        with pytest.raises(JacobiError) as caught:
            lp.PoissonTensor(names, entries)
        assert set(caught.value.triple) <= set(names)
        i, j, k = (sp.Symbol(name) for name in caught.value.triple)
        cyclic = sum(wrong(wrong(a, b), c) for a, b, c in ((i, j, k), (j, k, i), (k, i, j)))
        assert sp.expand(cyclic - sp.sympify(caught.value.residual)) == 0


def test_entries_may_be_rational_functions():
    """{x, y} = z, {y, z} = x, {z, x} = y, divided by a Casimir and by what is none."""
    R = "(x^2 + y^2 + z^2)"
    bracket = tensor("x y z", {("x", "y"): f"z/{R}", ("y", "z"): f"x/{R}", ("z", "x"): f"y/{R}"})
    x, y, z = bracket.variables
    assert bracket.jacobi == "proved"
    assert bracket.casimirs() == [x**2 + y**2 + z**2]
    other = tensor("x y z", {("x", "y"): "z/(1 + x)", ("y", "z"): "x/(1 + x)", ("z", "x"): "y/(1 + x)"})
    assert other.casimirs() == [x**2 + y**2 + z**2]  # in three dimensions any factor will do
    with pytest.raises(ParameterError, match="finite"):
        other.rank([-1, 0, 0])


def test_smooth_entries_are_proved_where_no_relation_is_needed_and_else_tried():
    plane = tensor("q p", {("q", "p"): "exp(q)*(2 + sin(p))"})
    assert plane.jacobi == "proved"
    proved = tensor("x y z", {("x", "y"): "exp(x)*sin(z)", ("y", "z"): "0", ("x", "z"): "0"})
    assert proved.jacobi == "proved"
    # the Nambu bracket of x sin(2 y) + z^2, one derivative of which is written otherwise
    entries = {("x", "y"): "-2*z", ("x", "z"): "2*x*(2*cos(y)^2 - 1)", ("y", "z"): "-2*sin(y)*cos(y)"}
    sampled = tensor("x y z", entries)
    assert sampled.jacobi == "sampled"
    certificate = sampled.jacobi_certificate()
    assert certificate.holds
    assert not certificate.proved
    assert "10 random points" in str(certificate)
    with pytest.raises(JacobiError):
        tensor("x y z", entries | {("x", "z"): "2*x*(2*cos(y)^2 - 2)"})


REFUSED = {
    "both orders disagree": (CYCLE | {("y", "x"): "x*y"}, BracketError, "antisymmetric"),
    "a coordinate with itself": ({("x", "x"): "1"}, BracketError, "itself"),
    "an unknown coordinate": ({("x", "w"): "1"}, BracketError, "must name coordinates; got 'w'"),
    "an unknown name": ({("x", "y"): "k*x"}, ExpressionError, "k"),
    "no formula": ({("x", "y"): "x**y"}, ExpressionError, "column"),
    "not finite": ({("x", "y"): float("nan")}, ParameterError, "finite"),
    "a Boolean": ({("x", "y"): True}, ParameterError, "number"),
    "not smooth": ({("x", "y"): "abs(x)"}, ExpressionError, "abs"),
    "no pair": ({"xy": "x"}, ParameterError, "pairs"),
    "no mapping": ([("x", "y", "1")], ParameterError, "mapping"),
    "another symbol": ({("x", "y"): sp.Symbol("w")}, ParameterError, "w, which is none"),
    "another function": ({("x", "y"): sp.Function("f")(sp.Symbol("x"))}, ParameterError, "none of them"),
    "an infinity of SymPy": ({("x", "y"): sp.oo}, ParameterError, "finite and real"),
    "no number of SymPy": ({("x", "y"): sp.nan * sp.Symbol("x")}, ParameterError, "finite and real"),
    "imaginary": ({("x", "y"): sp.I * sp.Symbol("x")}, ParameterError, "finite and real"),
    "not smooth, of SymPy": ({("x", "y"): sp.floor(sp.Symbol("x"))}, ParameterError, "smooth"),
    "a conjugate": ({("x", "y"): sp.conjugate(sp.Symbol("x"))}, ParameterError, "smooth"),
    "not written out": ({("x", "y"): sp.Derivative(sp.sin(sp.Symbol("x")))}, ParameterError, "written out"),
    "a positive coordinate": ({("x", "y"): sp.Symbol("x", positive=True)}, ParameterError, "without assumptions"),
    "no Poisson bracket": ({("x", "y"): "z", ("y", "z"): "x*y", ("z", "x"): "y"}, JacobiError, "Jacobi"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_no_tensor_is_refused(case):
    entries, error, words = REFUSED[case]
    with pytest.raises(error, match=words):
        tensor("x y z", entries)


def test_the_refusal_of_a_bracket_names_the_triple_and_the_residual():
    with pytest.raises(JacobiError) as caught:
        tensor("x y z", {("x", "y"): "z", ("y", "z"): "x*y", ("z", "x"): "y"})
    error = caught.value
    assert (error.triple, error.residual) == (("x", "y", "z"), "-x*z")
    with pytest.raises(JacobiError, match=r"cyclic sum of \{\{u, v\}, w\} is -u\*w"):
        tensor("u v w", {("u", "v"): "w", ("v", "w"): "u*v", ("w", "u"): "v"})
    again = pickle.loads(pickle.dumps(error))
    assert (again.triple, again.residual, str(again)) == (error.triple, error.residual, str(error))


def test_decimals_in_expressions_are_exact():
    """0.1 + 0.2 of SymPy's numbers is not 0.3, of which the Jacobi identity here is made."""
    x, y, z = sp.symbols("x y z")
    half, whole = sp.Float("0.1"), sp.Float("0.7")
    bracket = lp.PoissonTensor(
        ["x", "y", "z"], {("x", "y"): half * x * y, ("y", "z"): half * y * z, ("z", "x"): whole * x * z}
    )
    assert bracket.poisson_tensor()[0, 1] == x * y / 10
    assert bracket.casimirs() == [x * y**7 * z]


NAMED_ALIKE = {
    "a value": lambda: tensor("x y", {("x", "y"): "a"}, parameters={"a": "x"}),
    "a value, later": lambda: tensor("x y", {("x", "y"): "a"}, symbols=["a"]).substitute({"a": "2*x"}),
    "a new name": lambda: tensor("x y", {("x", "y"): "a*x"}, symbols=["a"]).rename("a", "b"),
    "a name in a Casimir": lambda: (
        tensor("x y z", {("x", "y"): "1"}).with_casimirs(["a*z"], symbols=["a"]).rename("a", "b", "c")
    ),
    "a log-canonical one": lambda: lp.brackets.log_canonical([[0, "x3", 1], ["-x3", 0, 1], [-1, -1, 0]]),
    "Nambu's": lambda: lp.brackets.nambu("a*x + z", ["x", "y", "z"], {"a": "z"}),
    "other coordinates": lambda: tensor("x y", {("x", "y"): "a"}, symbols=["a"]).in_variables(
        {"a": "x", "v": "y"}, {"x": "a", "y": "v"}
    ),
}


@pytest.mark.parametrize("case", NAMED_ALIKE)
def test_no_parameter_has_the_name_of_a_coordinate(case):
    with pytest.raises(BracketError, match="name both coordinates and parameters"):
        NAMED_ALIKE[case]()


@pytest.mark.parametrize(
    ("entry", "point"),
    [("atan(1/x)", [0, 1]), ("sin(1/x)", [0, 1]), ("log(x)", [-1, 1]), ("sqrt(x)", [-1, 1]), ("x/(x + y)", [0, 0])],
)
def test_there_is_no_rank_where_an_entry_is_no_real_number(entry, point):
    with pytest.raises(ParameterError, match="wanted one where all entries are finite and real"):
        tensor("x y", {("x", "y"): entry}).rank(point)


def test_values_must_leave_the_entries_and_casimirs_real():
    bracket = tensor("x y z", {("x", "y"): "sqrt(a)*x*y"}, symbols=["a", "b"], casimirs=["z/b"])
    assert bracket.substitute({"a": 4}).poisson_tensor()[0, 1] == 2 * sp.prod(bracket.variables[:2])
    for values in ({"a": -1}, {"b": 0}):
        with pytest.raises(ParameterError, match="finite and real"):
            bracket.substitute(values)


def test_a_parameter_of_a_casimir_alone_takes_a_value():
    bracket = tensor("x y z", {("x", "y"): "1"}, symbols=["a"], casimirs=["a*z"])
    assert bracket.symbols == {"a"}
    system = lp.System(bracket, "x^2 + y^2", {"a": 3})
    assert system.invariants["C1"] == 3 * sp.Symbol("z")
    assert max(lp.integrate(system, [1, 1, 1], t_end=1).drift["C1"]) == 0


@pytest.mark.parametrize(
    ("variables", "error"),
    [("xyz", ShapeError), ([], ShapeError), (["x", "x"], BracketError), (["x", "2y"], ParameterError),
     (["x", "sin"], ParameterError), ([1, 2], ShapeError)],
)  # fmt: skip
def test_names_of_coordinates_are_checked(variables, error):
    with pytest.raises(error):
        lp.PoissonTensor(variables, {(0, 1): "1"})


@pytest.mark.parametrize("casimirs", [["x + y"], ["3"], ["x*y*z", "log(x)"], {"C": "x*y"}])
def test_a_function_that_is_no_casimir_is_refused(casimirs):
    with pytest.raises(BracketError, match="Casimir"):
        tensor("x y z", CYCLE, casimirs=casimirs)


def test_given_casimirs_come_first():
    bracket = tensor("x y z", CYCLE, casimirs=["log(x) + log(y) + log(z)"])
    x, y, z = bracket.variables
    assert bracket.casimirs() == [sp.log(x) + sp.log(y) + sp.log(z)]
    assert bracket.n_unknown_casimirs == 0
    assert bracket.casimirs(3) == [x * y * z]
    assert list(lp.System(bracket, "x + y").invariants) == ["H", "C1"]
    assert bracket.casimir_report().verified


def test_parameters_are_inserted_or_stay():
    entries = {("x", "y"): "a[1]*x*y", ("y", "z"): "b*y*z", ("x", "z"): "a2*x*z"}
    fixed = tensor("x y z", entries, parameters={"a": [1, 2], "b": "1/3"})
    symbolic = tensor("x y z", entries, symbols=["a[2]", "b"])
    x, y, z = fixed.variables
    assert fixed.symbols == set()
    assert symbolic.symbols == {"a1", "a2", "b"}
    assert symbolic.substitute({"a1": 1, "a2": 2, "b": "1/3"}).poisson_tensor() == fixed.poisson_tensor()
    assert fixed.casimirs() == [y**6 / (x * z**3)]
    system = lp.System(symbolic, "x + y + z", {"a": [1, 2], "b": "1/3"})
    assert system.equations == lp.System(fixed, "x + y + z").equations
    with pytest.raises(BracketError, match="parameters"):
        lp.System(fixed, "x", {"y": 1})


def test_the_null_vectors_of_a_log_canonical_tensor_are_casimirs():
    matrix = [[0, 1, -2, "1/2", 0], [-1, 0, 1, 1, 3], [2, -1, 0, 1, -1], ["-1/2", -1, -1, 0, 2], [0, -3, 1, -2, 0]]
    bracket = lp.brackets.log_canonical(matrix)
    numbers = sp.Matrix(5, 5, [sp.Rational(c) for row in matrix for c in row])
    assert bracket.rank() == numbers.rank()
    (casimir,) = bracket.casimirs()
    powers = [sp.Poly(sp.log(casimir).expand(force=True).coeff(sp.log(x)), x).LC() for x in bracket.variables]
    assert numbers * sp.Matrix(powers) == sp.zeros(5, 1)
    assert bracket.strata()[0].complete
    with pytest.raises(BracketError, match="antisymmetric"):
        lp.brackets.log_canonical([[0, 1], [1, 0]])


def test_strata_of_a_log_canonical_tensor_are_where_coordinates_vanish():
    strata = tensor("x y z", CYCLE).strata()
    assert len(strata) == 8
    assert all(stratum.proved for stratum in strata)
    ranks = {stratum.condition: stratum.rank for stratum in strata}
    assert ranks["x != 0, y != 0, z != 0"] == 2
    assert ranks["z = 0, x != 0, y != 0"] == 2
    assert ranks["y = 0, z = 0, x != 0"] == 0
    bracket = tensor("x y z", CYCLE)
    assert bracket.rank([0, 2, 3]) == 2
    assert bracket.rank([0, 0, 3]) == 0


def where(text, point):
    """Whether a condition of a stratum holds at a point, by SymPy."""
    sides = re.split(r", (?![^(]*\))", text) if text != "everywhere" else []
    for side in sides:
        functions, sign = re.fullmatch(r"(.*) (=|!=) 0", side).groups()
        values = [sp.sympify(f.replace("^", "**")).subs(point) for f in functions.strip("()").split(", ")]
        yield any(values) == (sign == "!=")


NONLINEAR = {
    "a sphere": lp.brackets.nambu("(x^2 + y^2 + z^2)/2", ["x", "y", "z"]),
    "three lines": lp.brackets.nambu("x^2*y - z^2*y + z^3", ["x", "y", "z"], factor="x - 1"),
    "a circle": tensor("x y", {("x", "y"): "(x^2 + y^2 - 1)^2"}),
    "a product": lp.brackets.product(tensor("x y", {("x", "y"): "x"}), tensor("u v", {("u", "v"): "u*v - 1"})),
    "so(3) bent": tensor("x y z", SO3_BENT),
}


@pytest.mark.parametrize("name", NONLINEAR)
def test_strata_of_a_polynomial_tensor_are_a_partition_by_rank(name):
    bracket, numbers = NONLINEAR[name], Random(1)
    strata = bracket.strata()
    assert all(stratum.proved for stratum in strata)
    for _ in range(60):
        point = {
            x: sp.Rational(numbers.choice([0, 0, 1, 1, 2, -1]), numbers.choice([1, 1, 2])) for x in bracket.variables
        }
        (here,) = [s for s in strata if all(where(s.condition, point))]
        assert here.rank == bracket.poisson_tensor().subs(point).rank()


def test_strata_are_named_by_equations_and_those_without_real_points_are_left_out():
    conditions = lambda bracket: [(s.rank, s.condition) for s in bracket.strata()]  # noqa: E731
    assert conditions(NONLINEAR["a sphere"]) == [(2, "(x, y, z) != 0"), (0, "x = 0, y = 0, z = 0")]
    assert conditions(NONLINEAR["a circle"]) == [(2, "x^2 + y^2 - 1 != 0"), (0, "x^2 + y^2 - 1 = 0")]
    assert conditions(tensor("x y", {("x", "y"): "x^2 + y^2 + 1"})) == [(2, "everywhere")]
    assert conditions(tensor("x y", {("x", "y"): "exp(x)"})) == [(2, "generic")]
    system = lp.System(NONLINEAR["a circle"], "x")
    assert [lp.Leaf.through(system, state).rank for state in ([0.6, 0.8], [0.5, 0.8])] == [0, 2]


def test_rational_casimirs_are_found_by_their_denominators():
    volterra = lp.brackets.log_canonical([[0, 1, -1], [-1, 0, -1], [1, 1, 0]])
    x1, x2, x3 = volterra.variables
    (found,) = volterra.rational_casimirs(2)
    assert found in (x1 / (x2 * x3), x2 * x3 / x1)
    assert volterra.rational_casimirs(1) == []
    assert tensor("x y z", {("x", "y"): "x*z"}).rational_casimirs(2) == [sp.Symbol("z")]  # and not its square
    with pytest.raises(BracketError, match="rational"):
        tensor("x y", {("x", "y"): "exp(x)"}).rational_casimirs(2)
    for degree in (0, True, 1.5, 1000):
        with pytest.raises(ParameterError, match="egree"):
            volterra.rational_casimirs(degree)


def test_other_coordinates_give_the_same_motion():
    system = lp.System(lp.so(3) @ lp.trivial(), BODY)
    forward = {"u": "l1", "v": "l2 + l1^2", "w": "l3 - l1*l2"}
    bracket = system.bracket.in_variables(forward, {"l1": "u", "l2": "v - u^2", "l3": "w + u*(v - u^2)"})
    energy = system.hamiltonian.xreplace(
        {sp.Symbol("l1"): sp.Symbol("u"), sp.Symbol("l2"): sp.sympify("v - u**2"),
         sp.Symbol("l3"): sp.sympify("w + u*(v - u**2)")}
    )  # fmt: skip
    state = [0.3, -0.4, 1.2]
    image = [state[0], state[1] + state[0] ** 2, state[2] - state[0] * state[1]]
    rates, other = system.vector_field(state), lp.System(bracket, energy).vector_field(image)
    turned = [rates[0], rates[1] + 2 * state[0] * rates[0], rates[2] - state[0] * rates[1] - state[1] * rates[0]]
    assert other == pytest.approx(turned, rel=1e-13)
    assert bracket.n_unknown_casimirs == 0
    # logarithms of species: log(exp(u)) is u, as coordinates are real
    species = tensor("x y z", CYCLE).in_variables(
        {"u": "log(x)", "v": "log(y)", "w": "log(z)"}, {"x": "exp(u)", "y": "exp(v)", "z": "exp(w)"}
    )
    assert species.poisson_tensor() == sp.Matrix([[0, 1, -1], [-1, 0, 1], [1, -1, 0]])
    with pytest.raises(BracketError, match="inverse to each other"):
        system.bracket.in_variables(forward, {"l1": "u", "l2": "v + u^2", "l3": "w"})
    with pytest.raises(BracketError, match="none for l3"):
        system.bracket.in_variables(forward, {"l1": "u", "l2": "v - u^2"})


def test_a_product_is_made_of_both_brackets():
    both = lp.brackets.product(lp.so(3) @ lp.trivial(), lp.brackets.log_canonical([[0, 1], [-1, 0]]))
    assert both.coordinate_names_in_order == ("l1", "l2", "l3", "x1", "x2")
    assert (both.rank(), both.jacobi, both.n_unknown_casimirs) == (4, "proved", 0)
    l1, _, _, x1, x2 = both.variables
    assert both(l1, x1) == 0
    assert both(x1, x2) == x1 * x2
    with pytest.raises(BracketError, match="both"):
        lp.brackets.product(both, lp.so(3) @ lp.trivial())


def test_copies_and_new_names():
    bracket = tensor("x y z", CYCLE, casimirs=["x*y*z"])
    again = pickle.loads(pickle.dumps(bracket))
    assert again.poisson_tensor() == bracket.poisson_tensor()
    assert (again.jacobi, again.casimirs()) == ("proved", bracket.casimirs())
    renamed = bracket.rename("u", "v", "w")
    assert renamed.casimirs() == [sp.prod(renamed.variables)]
    assert repr(renamed) == "PoissonTensor(u, v, w)"


@pytest.mark.parametrize("what", ["algebra", "extension", "constant"])
def test_what_needs_a_lie_algebra_is_refused_with_a_sentence(what):
    with pytest.raises(BracketError, match="given by formulas"):
        getattr(tensor("x y z", CYCLE), what)


@pytest.mark.parametrize("call", ["derivations", "scalings", "entries", "coboundary"])
def test_methods_that_need_structure_constants_are_refused(call):
    with pytest.raises(BracketError, match="given by formulas"):
        getattr(tensor("x y z", CYCLE), call)()


def test_roots_of_squares_are_not_tried():
    """Of sqrt((x - 5)^2), which is 5 - x where points lie, no identity beyond x = 5 is known."""
    broken = {("x", "y"): "z", ("y", "z"): "x", ("z", "x"): "y + x*y*(sqrt((x - 5)^2) + x - 5)"}
    with pytest.raises(ParameterError, match=r"without roots of squares.*got sqrt\(\(x - 5\)\*\*2\)"):
        tensor("x y z", broken)
    sphere = tensor("x y z", {("x", "y"): "z", ("y", "z"): "x", ("z", "x"): "y"})
    with pytest.raises(ParameterError, match="without roots of squares"):
        sphere.is_casimir("x^2 + y^2 + z^2 + sqrt((x - 5)^2) + x - 5")
    assert sphere.is_casimir("sqrt(x^2 + y^2 + z^2)")
    times_a_size = {("x", "y"): "z*sqrt(y^2)", ("y", "z"): "x*sqrt(y^2)", ("z", "x"): "y*sqrt(y^2)"}
    assert tensor("x y z", times_a_size).jacobi == "proved"  # for both signs
