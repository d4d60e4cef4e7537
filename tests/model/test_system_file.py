import time
from fractions import Fraction

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

import liepoisson as lp
from liepoisson.errors import SystemFileError
from liepoisson.model.system_file import Integral, SystemFile
from liepoisson.model.system_file_reader import parse_system_file, read_system_file

F = Fraction
TOP = """
name = "my top"
source = "a paper"
[bracket]
algebra   = "so(3)"
extension = "leibniz(3, epsilon)"
variables = ["l", "alpha", "beta"]
[parameters]
epsilon = 1
I = [2, 2.5, "7/2"]
a = [-1, 0, 0.1]
[hamiltonian]
expression = "l1^2/(2*I1) + l2^2/(2*I2) + l3^2/(2*I3) + dot(a, alpha)"
"""
MINIMAL = '[bracket]\nalgebra = "so(3)"\n[hamiltonian]\nexpression = "dot(l, l)/2"\n'


REST = MINIMAL.partition("[hamiltonian]")[1] + MINIMAL.partition("[hamiltonian]")[2]
# [e0, e1] = e2, [e2, e3] = e0: [[e0, e1], e3] = e0 and the other two cyclic terms vanish
WRONG = [[[0] * 4 for _ in range(4)] for _ in range(4)]
WRONG[0][1][2] = WRONG[2][3][0] = 1
WRONG[1][0][2] = WRONG[3][2][0] = -1
NOT_ASSOCIATIVE = [[[0, 0], [0, 1]], [[1, 0], [0, 0]]]


def changed(old: str, new: str, text: str = TOP) -> str:
    assert old in text
    return text.replace(old, new)


def test_the_file_of_a_top_says_what_it_means():
    file = parse_system_file(TOP)
    assert (file.name, file.source, file.symbols) == ("my top", "a paper", ())
    assert file.parameters == {"epsilon": F(1), "I": (F(2), F(5, 2), F(7, 2)), "a": (F(-1), F(0), F(1, 10))}
    assert " ".join(map(str, file.bracket.variables)) == "l1 l2 l3 alpha1 alpha2 alpha3 beta1 beta2 beta3"
    l1, l2, l3, alpha1, alpha2, alpha3, _, beta2, _ = file.bracket.variables
    system = file.system()
    energy = l1**2 / 4 + l2**2 / 5 + l3**2 / 7 - alpha1 + alpha3 / 10
    assert sp.expand(system.hamiltonian - energy) == 0
    # alpha' = alpha x omega + epsilon beta x a, first component
    expected = alpha2 * l3 * sp.Rational(2, 7) - alpha3 * l2 * sp.Rational(2, 5) + beta2 / 10
    assert sp.expand(system.equations[alpha1] - expected) == 0


def test_defaults_are_one_field_and_the_name_of_the_file(tmp_path):
    path = tmp_path / "free-body.toml"
    path.write_text(MINIMAL)
    file = read_system_file(path)
    assert file.name == "free-body"
    assert file.bracket.dimension == 3
    assert file.system().name == "free-body"
    path.write_bytes(b"\xef\xbb\xbf" + MINIMAL.replace("\n", "\r\n").encode())
    assert read_system_file(path).bracket.dimension == 3


ROTATIONS = [[[0, 0, 0], [0, 0, -1], [0, 1, 0]], [[0, 0, 1], [0, 0, 0], [-1, 0, 0]], [[0, -1, 0], [1, 0, 0], [0, 0, 0]]]
SCALED = [[[0, 0], [0, "k"]], [[0, "-k"], [0, 0]]]


@pytest.mark.parametrize(
    ("bracket", "bare"),
    [
        (f'matrices = {ROTATIONS}\nW = [[[1, 0], [0, 0]], [[0, 1], [1, 0]]]\nvariables = ["l", "p"]',
         lambda: lp.so(3) @ lp.semidirect(2).rename("l", "p")),
        (f'matrices = {ROTATIONS}\ncasimirs = ["l1^2 + l2^2 + l3^2"]', lambda: lp.so(3) @ lp.trivial()),
        (f'structure_constants = {SCALED}\nbasis_names = ["a", "b"]\n[parameters]\nsymbols = ["k"]',
         lambda: lp.LieAlgebra(SCALED, basis_names=("a", "b")) @ lp.trivial()),
        ('canonical = 2', lambda: lp.canonical(2)),
        ('canonical = ["x", "y"]', lambda: lp.canonical(names=("x", "y"))),
        ('canonical = ["x"]\nmomenta = ["u"]', lambda: lp.canonical(names=("x",), momenta=("u",))),
        ('algebra = "so(3)"\nconstant.l1.l2 = "k[3]"\nconstant.l2.l3 = "k[1]"\n[parameters]\nk = ["1/2", 0, 3]',
         lambda: (lp.so(3) @ lp.trivial()).with_constant({("l1", "l2"): "k3", ("l2", "l3"): "k1"})),
    ],
)  # fmt: skip
def test_brackets_are_given_in_many_ways(bracket, bare):
    read = parse_system_file(f'[bracket]\n{bracket}\n[hamiltonian]\nexpression = "1"').bracket
    assert read.coordinate_names_in_order == bare().coordinate_names_in_order
    assert read.poisson_tensor() == bare().poisson_tensor()


def test_numbers_are_exact_and_may_be_formulas():
    numbers = {"0.1": F(1, 10), "1_000.5": F(2001, 2), '"1/3"': F(1, 3), "1e-3": F(1, 1000), "-7": F(-7), "0x10": F(16)}
    for written, expected in numbers.items():
        assert parse_system_file(changed("epsilon = 1", f"epsilon = {written}")).parameters["epsilon"] == expected
    assert parse_system_file(changed("epsilon = 1", 'epsilon = "sqrt(2)/2"')).parameters["epsilon"] == sp.sqrt(2) / 2


def test_integrals_and_references_are_read():
    text = (
        TOP
        + """
[integrals]
P = "l3"
"K'" = {expression = "dot(l, beta)", on = "dot(l, alpha) = 1/2", source = "a book"}
Q = {expression = "l1", on = "l2 = 0"}
[[reference]]
state = {l = [1, 2, 3], alpha = [0, 0, 1], beta = ["1/2", 0, 0]}
quantity = "H"
value = "7/2"
[[reference]]
state = [1, 2, 3, 4, 5, 6, 7, 8, 9]
quantity = "derivative"
value = [1, 0.5]
tolerance = 1e-6
source = "printed in a book"
"""
    )
    file = parse_system_file(text)
    assert file.integrals["P"] == Integral("l3")
    assert file.integrals["K'"].source == "a book"
    assert file.integrals["K'"].vanishing == "(dot(l, alpha)) - (1/2)"
    assert file.integrals["Q"].vanishing == "l2"
    first, second = file.references
    assert first.state == tuple(map(F, (1, 2, 3, 0, 0, 1, 0.5, 0, 0)))
    assert (first.quantity, first.value, first.tolerance) == ("H", F(7, 2), None)
    assert (second.value, second.tolerance, second.source) == ((F(1), F(1, 2)), F(1, 10**6), "printed in a book")
    assert second.state == tuple(map(F, range(1, 10)))
    system = file.system()
    assert set(system.integrals) == {"P"}
    assert set(system.partial_integrals) == {"K'", "Q"}


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("name =", "nmae =", r"line 2: nmae: .*Did you mean name"),
        ("algebra  ", "algebre  ", r"line 5: \[bracket\] algebre: .*Did you mean algebra"),
        ("[bracket]", "[equation]", r"line 4: equation: .*Did you mean equations"),
        ('algebra   = "so(3)"', "", r"line 4: bracket: wanted one of algebra, structure_constants or matrices"),
        ('"so(3)"', '"os(3)"', r"line 5: \[bracket\] algebra: the Lie algebra 'os' is unknown"),
        ('"so(3)"', '"so(3)"\nmatrices = [[[1]]]', "exclude each other"),
        ('"so(3)"', '"so(3)"\nbasis_names = ["1"]', "Remove basis_names"),
        ("leibniz(3, epsilon)", "leibniz(3, eps)", r"line 6: .*'eps' is unknown"),
        ('extension = "leibniz(3, epsilon)"', f"W = {NOT_ASSOCIATIVE}", r"\[bracket\] W: .*associative"),
        ('extension = "leibniz(3, epsilon)"', "W = [[1, 2], [3, 4]]", r"W\[1\]\[1\]: wanted a list"),
        ('["l", "alpha", "beta"]', '["l", "alpha"]', r"line 7: \[bracket\] variables: wanted one name .*; got 2"),
        ('["l", "alpha", "beta"]', '["l", "alpha", "b c"]', "letters, digits"),
        ('["l", "alpha", "beta"]', '"l"', "wanted a list of texts"),
        ("epsilon = 1", "epsilon = nan", r"line 9: \[parameters\] epsilon: wanted a number .*got nan"),
        ("epsilon = 1", "epsilon = 1e999999999", "got 1e999999999"),
        ("epsilon = 1", "epsilon = true", "got True"),
        ("epsilon = 1", "epsilon = 1979-05-27", "got a date"),
        ("epsilon = 1", "epsilon = " + "9" * 300, "200 digits"),
        ("epsilon = 1", "epsilon = 0x" + "f" * 10_000, "200 digits"),
        ("epsilon = 1", 'epsilon = "delta"', r"\[parameters\] epsilon: the name 'delta' is unknown"),
        ("epsilon = 1", 'epsilon = "1/0"', "must not vanish"),
        ("epsilon = 1", "epsilon = {}", "got a table"),
        ("epsilon = 1", "epsilon = [[1, 2], [3]]", "one length"),
        ("epsilon = 1", "epsilon = 1\nunused = 2", r"line 10: \[parameters\] unused: unused occurs neither"),
        ("epsilon = 1", 'epsilon = 1\nsymbols = ["unused[2]"]', "unused occurs neither"),
        ("epsilon = 1", 'epsilon = 1\nsymbols = ["epsilon"]', "given twice"),
        ("epsilon = 1", 'epsilon = 1\nsymbols = ["x[", "y"]', "declared by its name"),
        ("dot(a, alpha)", "dot(a, alhpa)", r"line 13: \[hamiltonian\] expression: the name 'alhpa' is unknown.*alpha"),
        ('"l1^2/(2*I1)', '"""\nl1^2/(2*I1) + (\n"""#', "a number, a name or a bracket"),
        ("[parameters]", "[parameters]\n[parameters]", "line 9, column 12: not TOML"),
        ("a = [-1, 0, 0.1]", "a = [-1, 0, 0.1", "not TOML"),
        ("a = [", "a = " + "[" * 5000, "nested too deeply"),
        ("a = ", "a" + ".a" * 5000 + " = ", "parts"),
        ("[bracket]", "[[bracket]]", "bracket: wanted a table; got a list"),
        ('"l1^2/(2*I1)', '"""\nl1^2 +\n  alhpa""" #', r"line 13: .*\(line 2, column 3 of the formula\)"),
        ('algebra   = "so(3)"', 'canonical = ["x"]', "algebra|extension"),
        ('extension = "leibniz(3, epsilon)"', 'extension = "semidirect(3)"\nconstant.l1.alpha1 = 1', "2-cocycle"),
        ('algebra   = "so(3)"', f"structure_constants = {WRONG}", r"line 5: \[bracket\] structure_constants: .*Jacobi"),
        *(('algebra   = "so(3)"', f'algebra = "so(3)"\n{constant}', message) for constant, message in (
            ("constant.l1.n2 = 1", "n2"), ('constant.l1.l2 = "h"', "h"),
            ("constant.l1.l2 = 1\nconstant.l2.l1 = 1", "twice"),
            ("constant.l1 = 3", r"\[bracket\] constant l1: wanted a table"))),
    ],
)  # fmt: skip
def test_mistakes_are_told_with_key_and_line(old, new, message):
    with pytest.raises(SystemFileError, match="(?s)" + message):
        parse_system_file(changed(old, new))


@pytest.mark.parametrize(
    ("addition", "message"),
    [
        ('[integrals]\nK = "l1 +"', r"line 16: \[integrals\] K: .*wanted here"),
        ('[integrals]\nK = {expression = "l1", on = "l9 = 0"}', r"line 16: \[integrals\] K on: the name 'l9'"),
        ('[integrals]\nH = "l1"', r"line 16: \[integrals\] H: an integral must not be named H, C1"),
        ('[integrals.C12]\nexpression = "l1"', r"line 15: \[integrals\] C12: an integral must not be named"),
        ('[integrals]\nK = {on = "l1 = 0"}', "wanted the key expression"),
        ('[integrals]\nK = {expression = "l1", on = "l1 = l2 = 0"}', "one equation"),
        ('[integrals]\nK = {expression = "l1", on = "l1 = "}\nM = 1', "wanted a table; got a number"),
        ('[integrals]\nK = {expression = "l1", no = "l1"}', r"\[integrals\] K no: the key is unknown"),
        ('[reference]\nquantity = "H"', "double brackets"),
        ('[[reference]]\nquantity = "H"', "wanted the key value"),
        (
            '[[reference]]\nquantity = "H"\nvalue = 1\nstate = [1, 2]',
            r"\[reference\]\[1\] state: wanted 9 components; got 2",
        ),
        ('[[reference]]\nquantity = "H"\nvalue = 1\nstate = {l = [1, 2, 3]}', "alpha has none"),
        (
            '[[reference]]\nquantity = "H"\nvalue = 1\nstate = {l = [1], alpha = [1, 2, 3], beta = [1, 2, 3]}',
            "wanted 3",
        ),
        ('[[reference]]\nquantity = "H"\nvalue = [[1]]', "got a matrix"),
        ('[[reference]]\nquantity = "H"\nvalue = "x"', "'x' is unknown"),
    ],
)
def test_mistakes_in_integrals_and_references_are_told(addition, message):
    with pytest.raises(SystemFileError, match="(?s)" + message):
        parse_system_file(TOP + "\n" + addition)


@pytest.mark.parametrize(("formula", "message"), [("l[4]", "must not exceed the shape"), ("abs(l1)", "not smooth")])
@pytest.mark.parametrize(
    ("key", "addition"),
    [
        (r"line 13: \[hamiltonian\] expression", ""),
        (r"line 16: \[integrals\] K", '[integrals]\nK = "l1 + ({0})"'),
        (r"line 16: \[integrals\] K on", '[integrals]\nK = {{expression = "l1", on = "{0} = 0"}}'),
        (r"line 15: \[integrals\] K", '[integrals.K]\non = "l2"\nexpression = "l1 + ({0})"'),
    ],
)
def test_a_formula_without_meaning_is_refused_when_the_system_is_made(formula, message, key, addition):
    text = (
        TOP + "\n" + addition.format(formula) if addition else changed("dot(a, alpha)", f"dot(a, alpha) + ({formula})")
    )
    place = r" \(column \d+ of the formula\)\.\n"
    with pytest.raises(SystemFileError, match=f"(?s)^system file, {key}: [^\n]*{message}.*{place}"):
        parse_system_file(text).system()


LINES = [line for line in (TOP + MINIMAL).split("\n") if line] + [
    'a = "',
    "I = [[1]]",
    "x = 1",
    "[integrals]",
    'K = "l1"',
]


@settings(max_examples=30)
@given(st.one_of(st.text(max_size=200), st.lists(st.sampled_from(LINES), max_size=14).map("\n".join)))
def test_any_text_is_a_system_file_or_refused(text):
    try:
        assert isinstance(parse_system_file(text), SystemFile)
    except SystemFileError as error:
        message = str(error)
    else:
        message = "system file"
    assert message.startswith("system file")


def test_components_of_large_matrices_have_names_of_their_own():
    # so(5) has ten dimensions; in A1_10 the indices are set off, as (1, 11) and (11, 1) must be in larger ones
    A = [[0] * 10 for _ in range(10)]
    A[0][9], A[9][0], A[0][0] = 3, 4, 1
    text = '[bracket]\nalgebra = "so(5)"\nvariables = ["M"]\n[parameters]\n' + f"A = {A}\n[hamiltonian]\n"
    system = parse_system_file(text + 'expression = "dot(M, A*M) + A[10,1]*M[2] + A1_10*M13"').system()
    M12, M13, *_, M45 = system.variables
    assert sp.expand(system.hamiltonian - (M12**2 + 7 * M12 * M45 + 7 * M13)) == 0


@pytest.mark.parametrize("filling", ["a", "a.", "'a'.", "[", "a = 1\n", "a.b.c.d=1\n"])
def test_hostile_files_are_refused_quickly(filling):
    start = time.perf_counter()
    with pytest.raises(SystemFileError):
        parse_system_file(filling * (200_000 // len(filling)))
    assert time.perf_counter() - start < 10


@pytest.mark.parametrize(
    ("bracket", "value", "message"),
    [
        ("canonical = 1.5", "", "from 1 to 100"),
        ('canonical = "x"', "", "canonical"),
        ('canonical = ["x", "y"]\nmomenta = ["u"]', "", "one momentum for each"),
        (
            'canonical = ["x"]',
            '[[reference]]\nstate = {p_x = 4}\nquantity = "H"\nvalue = 1',
            "for each field; x has none",
        ),
        (
            'canonical = ["x"]',
            '[[reference]]\nstate = {x = [1, 2], p_x = 4}\nquantity = "H"\nvalue = 1',
            "wanted 1 comp",
        ),
    ],
)
def test_mistakes_in_canonical_files(bracket, value, message):
    with pytest.raises(SystemFileError, match=message):
        parse_system_file(f'[bracket]\n{bracket}\n[hamiltonian]\nexpression = "1"\n{value}')
