import pickle
from fractions import Fraction

import pytest

from liepoisson.errors import ExpressionError, ParameterError
from liepoisson.formula.grammar import (
    MAX_CHARACTERS,
    MAX_NESTING,
    Call,
    Component,
    Name,
    Negative,
    Node,
    Number,
    Power,
    Product,
    Sum,
    names_in,
    parse,
)


def shape(node: Node) -> object:
    """The tree without positions."""
    parts = [shape(child) for child in node.children]
    heads = {
        Number: lambda: node.value,
        Name: lambda: node.name,
        Sum: lambda: ("sum", *zip(node.signs, parts, strict=True)),
        Product: lambda: ("product", *zip(node.operators, parts, strict=True)),
        Negative: lambda: ("-", *parts),
        Power: lambda: ("^", *parts),
        Component: lambda: (*parts, *node.indices),
        Call: lambda: (node.function, parts),
    }
    return heads[type(node)]()


@pytest.mark.parametrize(
    ("text", "tree"),
    [
        ("0.1", Fraction(1, 10)),
        ("-x^2", ("-", ("^", "x", 2))),
        ("2^3^2", ("^", 2, ("^", 3, 2))),
        ("2**3", ("^", 2, 3)),
        ("2^-x", ("^", 2, ("-", "x"))),
        ("a-(b-c)", ("sum", ("+", "a"), ("-", ("sum", ("+", "b"), ("-", "c"))))),
        ("a/b*c", ("product", ("*", "a"), ("/", "b"), ("*", "c"))),
        ("-a*b", ("product", ("*", ("-", "a")), ("*", "b"))),
        ("a+b*c", ("sum", ("+", "a"), ("+", ("product", ("*", "b"), ("*", "c"))))),
        ("2--+x", ("sum", ("+", 2), ("-", ("-", "x")))),
        ("l[2]^2", ("^", ("l", 2), 2)),
        ("A[1, 12]", ("A", 1, 12)),
        ("dot(u, \n v)", ("dot", ["u", "v"])),
        ("f()", ("f", [])),
        ("cross(u,v)[3]", (("cross", ["u", "v"]), 3)),
    ],
)
def test_precedence_is_that_of_the_blackboard(text, tree):
    assert shape(parse(text)) == tree


@pytest.mark.parametrize(
    ("text", "position", "message"),
    [
        ("", 0, "empty"),
        ("2x", 1, r"Write 2\*x"),
        ("l1 l2", 3, r"Write l1\*l2"),
        ("(a)(b)", 3, "a product needs its sign"),
        ("l.dot", 1, r"a component is l\[1\]"),
        ("x = 1", 2, "without '='"),
        ("'os'", 0, "quotes"),
        ("α + 1", 0, "alpha"),
        ("l1²", 2, r"\^2"),
        ("a − b", 2, "minus sign"),
        ("lambda x: x", 8, "no meaning"),
        ("1 +", 3, "the end of the formula"),
        ("* x", 0, "is wanted here"),
        ("(1 + 2", 0, "never closed"),
        ("dot(l", 3, "never closed"),
        ("1)", 1, "not expected"),
        ("l[0]", 2, "from 1 on"),
        ("l[i]", 2, "from 1 on"),
        ("A[1][2]", 4, r"A\[1,2\]"),
        ("1e5000", 0, "3 in its exponent"),
        ("x + 0." + "7" * 300, 4, "200 digits"),
        ("a" * 1000, 0, "100 characters"),
        ("f(,)", 2, "is wanted here"),
    ],
)
def test_a_mistake_is_named_with_its_position(text, position, message):
    with pytest.raises(ExpressionError, match=message) as caught:
        parse(text)
    assert caught.value.position == position
    assert caught.value.text == text


def test_the_message_shows_the_line_with_a_caret():
    with pytest.raises(ParameterError) as caught:
        parse("l1 +\n  2*$ + 1")
    error = caught.value
    assert (error.line, error.column, error.position) == (2, 5, 9)
    assert str(error).endswith("(line 2, column 5).\n      2*$ + 1\n        ^")
    copy = pickle.loads(pickle.dumps(error))
    assert (str(copy), copy.position, copy.text) == (str(error), error.position, error.text)
    long = "x + " * 100 + "$" + " + x" * 100
    with pytest.raises(ExpressionError) as caught:
        parse(long)
    _, line, caret = str(caught.value).split("\n")
    assert len(line) < 100
    assert line[caret.index("^")] == "$"


@pytest.mark.parametrize("opening", ["(", "-", "2^", "f(", "(-2^sin("])
def test_deep_nesting_is_refused_and_shallow_is_not(opening):
    levels = MAX_NESTING // (opening.count("(") + opening.count("-") + opening.count("^"))

    def nested(n: int) -> str:
        return opening * n + "x" + ")" * (opening.count("(") * n)

    parse(nested(levels))
    for depth in (levels + 1, 1500):
        with pytest.raises(ExpressionError, match="nested"):
            parse(nested(depth))


def test_long_formulas_are_read_without_recursion():
    text = "+".join(["x"] * (MAX_CHARACTERS // 2))
    assert len(parse(text).children) == MAX_CHARACTERS // 2
    with pytest.raises(ExpressionError, match="20000 characters"):
        parse(text + "+x")
    assert names_in(parse("f(b) + a*b + l[1]")) == {"b": 2, "a": 7, "l": 13}
