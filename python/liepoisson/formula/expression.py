"""The meaning of formulas: names, vectors, matrices and functions, read into SymPy expressions.

A formula is a scalar built from the fields of a bracket (vectors: `l`), their components (`l[1]`, or `l1` for short),
parameters (numbers, vectors, matrices) and symbols.  The functions:

    dot(u, v)  cross(u, v)  norm(v)  diag(v)  inv(M)  transpose(M)  trace(M)
    sqrt exp log sin cos tan sinh cosh tanh asin acos atan, and the constant pi

and, in functions of sections and figures, the angle `atan2(y, x)` of a pair.

`inv` of a vector v is the inverse of diag(v), as in `dot(l, inv(I)*l)/2`.  What is not smooth is refused, and
so is what cannot be read in bounded time.  The grammar is in `liepoisson.formula.grammar`; no text is ever run
as code.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.exact_numbers import Coefficient, Exact, exact, symbols_of, to_sympy
from liepoisson.errors import ExpressionError, did_you_mean
from liepoisson.formula.arithmetic import Arithmetic, RefusedError
from liepoisson.formula.grammar import (
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
from liepoisson.formula.parameters import component_name
from liepoisson.formula.scope import Scope
from liepoisson.formula.tensor_arithmetic import (
    Matrix,
    TensorArithmetic,
    Value,
    Vector,
    kind_of,
    shape_of,
)
from liepoisson.inputs.names import (
    ANGLE,
    CONSTANTS,
    ELEMENTARY_FUNCTIONS,
    FUNCTIONS,
    MATRIX_FUNCTIONS,
    NOT_SMOOTH,
    PARTIAL_FUNCTIONS,
)

if TYPE_CHECKING:
    from sympy import Expr

_INSTEAD = {
    "ln": "log(x)",
    "pow": "x^y",
    "arcsin": "asin(x)",
    "arccos": "acos(x)",
    "arctan": "atan(x)",
    "sec": "1/cos(x)",
    "csc": "1/sin(x)",
    "cot": "cos(x)/sin(x)",
    "inverse": "inv(M)",
}
_NO_CONSTANTS = {
    "e": "Euler's number is exp(1)",
    "E": "Euler's number is exp(1)",
    "Pi": "The constant is pi",
    "PI": "The constant is pi",
    "oo": "Formulas are finite",
    "inf": "Formulas are finite",
    "i": "Formulas are real",
    "I": "Formulas are real",
    "j": "Formulas are real",
}

_TIME = {"t", "time"}


@dataclass(frozen=True)
class Formula:
    """A formula that has been read.

    Attributes:
        expression: With the parameters as symbols: those of a vector I are I1, I2, ...
        value: With the values of the parameters inserted.
        names: The fields, parameters and symbols that occur.
    """

    expression: Expr
    value: Expr
    names: frozenset[str]


def read_formula(text: str, scope: Scope, *, angles: bool = False) -> Formula:
    """Read a formula, with the parameters as symbols and with their values.

    Raises:
        ExpressionError: not in the grammar, an unknown name, shapes that do not fit, a function that is not smooth, a
            value that is not finite and real, or too large a formula; with the position.
    """
    tree = parse(text)
    value = _read(tree, text, scope, insert_values=True, angles=angles)
    expression = _read(tree, text, scope, insert_values=False, angles=angles) if scope.parameters else value
    names = frozenset(owner for name in names_in(tree) if (owner := scope.owner(name)) is not None)
    return Formula(expression, value, names)


def read_expression(text: str, scope: Scope, *, insert_values: bool = False, angles: bool = False) -> Expr:
    """Read a formula into a SymPy expression in plain symbols.

    Args:
        text: The formula.
        scope: The names that it may use.
        insert_values: Insert the values of the parameters; otherwise they stay symbols (I1, I2, I3 for a vector I).
            The formula is checked with the values inserted either way.
        angles: Whether `atan2(y, x)` may occur, which is not smooth where x < 0 and y = 0.

    Raises:
        ExpressionError: as in `read_formula`.
    """
    formula = read_formula(text, scope, angles=angles)
    return formula.value if insert_values else formula.expression


def evaluate(tree: Node, text: str, scope: Scope) -> Exact:
    """The scalar that a part of a formula stands for, with the values of the parameters inserted.

    A rational number comes as a Fraction, and SymPy is then not imported.

    Raises:
        ExpressionError: as in `read_formula`.
    """
    return _evaluated(tree, text, scope, insert_values=True)


def constant(text: str) -> Exact:
    """The number that a text without names stands for, exactly: "1/3", "0.1", "sqrt(2)/2", "-pi".

    This is how numbers are read wherever one can be given as text.  A rational number comes as a Fraction, and SymPy
    is then not imported.

    Raises:
        ExpressionError: as in `read_formula`.
    """
    return evaluate(parse(text), text, Scope())


def is_partial(text: str) -> bool:
    """Whether a formula may be no real number at a real state: it has a logarithm, a root, or an inverse sine."""
    waiting = [parse(text)]
    while waiting:
        node = waiting.pop()
        if isinstance(node, Call) and node.function in PARTIAL_FUNCTIONS:
            return True
        if isinstance(node, Power) and not _is_integer(node.children[1]):
            return True
        waiting.extend(node.children)
    return False


def _is_integer(exponent: Node) -> bool:
    if isinstance(exponent, Negative):
        return _is_integer(exponent.children[0])
    return isinstance(exponent, Number) and exponent.value.denominator == 1


def check_names(tree: Node, text: str, scope: Scope) -> frozenset[str]:
    """The owners of all names in a formula; does not import SymPy.

    Raises:
        ExpressionError: a name is unknown.
    """
    owners: set[str] = set()
    for name, position in names_in(tree).items():
        owner = scope.owner(name)
        if owner is None and name not in CONSTANTS:
            raise ExpressionError(_unknown_name(name, scope), text, position)
        if owner is not None:
            owners.add(owner)
    return frozenset(owners)


def _read(tree: Node, text: str, scope: Scope, *, insert_values: bool, angles: bool) -> Expr:
    return to_sympy(_evaluated(tree, text, scope, insert_values=insert_values, angles=angles))


def _evaluated(tree: Node, text: str, scope: Scope, *, insert_values: bool, angles: bool = False) -> Exact:
    reader = Reader(text, scope, insert_values=insert_values, angles=angles)
    try:
        return reader.read(tree)
    except RecursionError:  # SymPy calls itself for each level of nesting, and so may the caller have done
        raise ExpressionError("the formula is nested too deeply. Simplify it", text, tree.position) from None


class Reader:
    """Turns a tree into a value, from the leaves up.

    Args:
        text: The formula, for messages.
        scope: The names that it may use.
        insert_values: Whether parameters are read as their values, and not as symbols.
        scalars: The arithmetic; by default that of Fractions and SymPy expressions.
        angles: Whether `atan2(y, x)` may occur.
    """

    def __init__(
        self, text: str, scope: Scope, *, insert_values: bool, scalars: Arithmetic | None = None, angles: bool = False
    ) -> None:
        self.text = text
        self.scope = scope
        self.insert_values = insert_values
        self.angles = angles
        self.scalars = Arithmetic() if scalars is None else scalars
        self.tensors = TensorArithmetic(self.scalars)
        self.rules: dict[type[Node], Callable[[Any, Sequence[Value]], Value]] = {
            Number: lambda node, _: node.value,
            Name: self.named,
            Sum: self.sum,
            Product: self.product,
            Negative: self.negative,
            Power: self.power,
            Component: self.component,
            Call: self.call,
        }

    def read(self, tree: Node) -> Exact:
        """The scalar that a tree stands for."""
        waiting, values = [(tree, False)], list[Value]()  # a stack of our own: long formulas must not fill Python's
        while waiting:
            node, children_are_read = waiting.pop()
            if children_are_read:
                first = len(values) - len(node.children)
                values[first:] = [self.value(node, values[first:])]
            else:
                waiting.append((node, True))
                waiting.extend((child, False) for child in reversed(node.children))
        if isinstance(values[0], (Vector, Matrix)):
            message = f"a formula must be a scalar; got {kind_of(values[0])}. Write for example dot(u, v)"
            raise self.error(message, tree.position)
        return values[0]

    def value(self, node: Node, parts: Sequence[Value]) -> Value:
        """The value of a node, given those of its children."""
        try:
            return self.rules[type(node)](node, parts)
        except RefusedError as refusal:
            raise self.error(str(refusal), node.position) from None

    def negative(self, _node: Negative, parts: Sequence[Value]) -> Value:
        """The opposite of a value."""
        return self.tensors.times(Fraction(-1), parts[0])

    def named(self, node: Name, _parts: Sequence[Value] = ()) -> Value:
        """What a name stands for."""
        name = node.name
        if name in self.scope.fields:
            return Vector(tuple(self.symbol(f"{name}{component}") for component in self.scope.fields[name]))
        if name in self.scope.shapes:
            return self.parameter(name)
        if name in self.scope.components:
            owner, index = self.scope.components[name]
            whole = self.scope.values.get(owner) if self.insert_values else None
            return self.symbol(name) if whole is None else self.given(_entry(whole, index))
        if name in CONSTANTS:
            return self.circle_number()
        raise self.error(_unknown_name(name, self.scope), node.position)

    def symbol(self, name: str) -> Exact:
        """What stands for a coordinate or a symbol."""
        from sympy import Symbol

        return Symbol(name)

    def given(self, value: Coefficient) -> Exact:
        """What stands for the value of a parameter."""
        return exact(value)

    def circle_number(self) -> Exact:
        """The number pi."""
        from sympy import pi

        return pi

    def parameter(self, name: str) -> Value:
        """A parameter by its value, or by symbols."""
        shape = self.scope.shapes[name]
        value = self.scope.values.get(name) if self.insert_values else None

        def entry(*index: int) -> Exact:
            if value is None:
                return self.symbol(component_name(name, index, shape))
            return self.given(_entry(value, index))

        if not shape:
            return entry()
        if len(shape) == 1:
            return Vector(tuple(entry(i) for i in range(1, shape[0] + 1)))
        rows, columns = shape
        return Matrix(tuple(tuple(entry(i, j) for j in range(1, columns + 1)) for i in range(1, rows + 1)))

    def sum(self, node: Sum, terms: Sequence[Value]) -> Value:
        """A sum or difference of values of one shape."""
        for term, position in zip(terms, node.positions, strict=True):
            if kind_of(term) != kind_of(terms[0]):
                message = f"terms of a sum must have one shape; got {kind_of(terms[0])} and {kind_of(term)}"
                raise self.error(message, position)
        signed = [
            self.tensors.times(Fraction(-1), t) if s == "-" else t for s, t in zip(node.signs, terms, strict=True)
        ]
        return self.tensors.sum(signed)

    def product(self, node: Product, factors: Sequence[Value]) -> Value:
        """A product of scalars and tensors, and quotients by scalars."""
        scalars: list[Exact] = []
        tensor: Vector | Matrix | None = None
        for factor, operator, position in zip(factors, node.operators, node.positions, strict=True):
            try:
                if operator == "/":
                    scalars.append(self.scalars.reciprocal(self.tensors.as_divisor(factor)))
                elif not isinstance(factor, (Vector, Matrix)):
                    scalars.append(factor)
                else:
                    tensor = factor if tensor is None else self.tensors.product(tensor, factor)
            except RefusedError as refusal:
                raise self.error(str(refusal), position) from None
        scalar = self.scalars.product(scalars)
        return scalar if tensor is None else self.tensors.times(scalar, tensor)

    def power(self, node: Power, parts: Sequence[Value]) -> Value:
        """A power of a scalar."""
        base, exponent = parts
        if isinstance(base, (Vector, Matrix)) or isinstance(exponent, (Vector, Matrix)):
            kind = kind_of(base if isinstance(base, (Vector, Matrix)) else exponent)
            raise RefusedError(
                f"a power must be one of scalars; got {kind}. Write dot(v, v) for the square of a vector"
            )
        if symbols_of(exponent) & self.scope.coordinates():
            raise self.error("an exponent must not depend on the state. Write exp(y*log(x)) for x^y", node.position)
        return self.scalars.power(base, exponent)

    def component(self, node: Component, parts: Sequence[Value]) -> Value:
        """A component of a vector or a matrix."""
        whole = parts[0]
        shape = shape_of(whole)
        if len(shape) != len(node.indices):
            hint = f"Write {len(shape)} of them" if shape else "Leave it out"
            raise RefusedError(
                f"a vector has components with one index and a matrix with two; got {len(node.indices)} for "
                f"{kind_of(whole)}. {hint}"
            )
        if any(i > n for i, n in zip(node.indices, shape, strict=True)):
            raise RefusedError(f"an index must not exceed the shape; got {list(node.indices)} for {kind_of(whole)}")
        return _entry(_entries(whole), node.indices)

    def call(self, node: Call, arguments: Sequence[Value]) -> Value:
        """A function of its arguments."""
        name = node.function
        if name in MATRIX_FUNCTIONS:
            return self.tensors.apply(name, arguments)
        if name == ANGLE:
            return self.angle(node, arguments)
        if name not in ELEMENTARY_FUNCTIONS:
            raise self.error(_unknown_function(name, self.scope), node.position)
        if len(arguments) != 1 or isinstance(arguments[0], (Vector, Matrix)):
            got = " and ".join(map(kind_of, arguments)) or "nothing"
            raise RefusedError(f"{name} takes one scalar; got {got}")
        return self.scalars.apply(name, arguments[0])

    def angle(self, node: Call, arguments: Sequence[Value]) -> Value:
        """The angle of a point (x, y) of a plane, from y and x."""
        if not self.angles:
            raise self.error(
                f"{ANGLE} jumps by 2*pi where its angle is pi, and the equations of motion need derivatives. Use it in "
                "functions of sections and figures only; here write x and y themselves",
                node.position,
            )
        if len(arguments) != 2 or any(isinstance(one, (Vector, Matrix)) for one in arguments):
            got = " and ".join(map(kind_of, arguments)) or "nothing"
            raise RefusedError(f"{ANGLE} takes two scalars, y and x; got {got}. Write for example {ANGLE}(l2, l1)")
        return self.scalars.angle(*(one for one in arguments if not isinstance(one, (Vector, Matrix))))

    def error(self, message: str, position: int) -> ExpressionError:
        """An error at a position of the text; to be raised."""
        return ExpressionError(message, self.text, position)


def _entry(values: object, index: tuple[int, ...]) -> Exact:
    """The entry of nested tuples at an index counted from 1."""
    entry: Any = values
    for i in index:
        entry = entry[i - 1]
    return entry


def _entries(value: Value) -> object:
    if isinstance(value, Vector):
        return value.entries
    return value.rows if isinstance(value, Matrix) else value


def _unknown_name(name: str, scope: Scope) -> str:
    if name in _TIME:
        hint = scope.suggestion(name)
        return f"the name {name!r} is unknown. Time is t, and in the Hamiltonian of a Python System alone. {hint}"
    if name in FUNCTIONS:
        return f"{name} is a function and needs its arguments. Write {name}(...)"
    constant = f"{_NO_CONSTANTS[name]}. " if name in _NO_CONSTANTS else ""
    return f"the name {name!r} is unknown. {constant}{scope.suggestion(name)}"


def _unknown_function(name: str, scope: Scope) -> str:
    if scope.owner(name) or name in CONSTANTS:
        return f"{name} is no function. Write {name}*(...) for a product, {name}[1] for a component"
    if name.lower() in NOT_SMOOTH:
        return f"{name} is not smooth, and the equations of motion need derivatives. Use smooth functions only"
    if name.lower() in _INSTEAD:
        return f"the function {name!r} is unknown. Write {_INSTEAD[name.lower()]}"
    return f"the function {name!r} is unknown. {did_you_mean(name, FUNCTIONS)}Known are {', '.join(FUNCTIONS)}"
