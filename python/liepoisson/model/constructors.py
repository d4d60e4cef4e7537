"""Lie algebras and extensions by name, as a system file writes them: "so(3) + so(3)", "leibniz(3, epsilon)".

The text is read with the grammar of formulas; only the registered constructors can be called.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from inspect import signature
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from liepoisson.errors import ExpressionError, LiePoissonError, did_you_mean
from liepoisson.formula.expression import evaluate
from liepoisson.formula.grammar import Call, Name, Node, Sum, parse
from liepoisson.formula.parameters import read_symbol
from liepoisson.formula.scope import Scope

if TYPE_CHECKING:
    from liepoisson.structure.extension import Extension
    from liepoisson.structure.lie_algebra import LieAlgebra

T = TypeVar("T")


def read_algebra(text: str, symbols: Sequence[str] = ()) -> LieAlgebra:
    """Read a Lie algebra: so(3), so(2,1), su(5), ..., or a direct sum so(3) + so(3).

    Args:
        text: A constructor of `ALGEBRAS` with its arguments, or a sum of such.
        symbols: Names that an argument may use, as they are declared in system files ("epsilon", "a[3]").

    Raises:
        ExpressionError: not such a text, an unknown constructor, arguments that it does not take; with the position.
    """
    from liepoisson.structure.lie_algebras import ALGEBRAS

    return _read(text, _Registry("Lie algebra", ALGEBRAS, "so(3)"), symbols)


def read_extension(text: str, symbols: Sequence[str] = ()) -> Extension:
    """Read an extension: leibniz(3, epsilon), semidirect(3), ..., or a direct sum trivial() + trivial().

    Args:
        text: A constructor of `EXTENSIONS` with its arguments, or a sum of such.
        symbols: Names that an argument may use, as they are declared in system files ("epsilon", "a[3]").

    Raises:
        ExpressionError: not such a text, an unknown constructor, arguments that it does not take; with the position.
    """
    from liepoisson.structure.extensions import EXTENSIONS

    return _read(text, _Registry("extension", EXTENSIONS, "leibniz(3, epsilon)"), symbols)


@dataclass(frozen=True)
class _Registry(Generic[T]):
    """Constructors by name, what they construct, and an example."""

    kind: str
    constructors: Mapping[str, Callable[..., T]]
    example: str


def _read(text: str, registry: _Registry[T], symbols: Sequence[str]) -> T:
    tree = parse(text)
    terms = tree.children if isinstance(tree, Sum) else (tree,)
    if isinstance(tree, Sum) and "-" in tree.signs:
        position = tree.positions[tree.signs.index("-")]
        message = f"a direct sum is written with +; got '-'. Write {registry.example} + {registry.example}"
        raise ExpressionError(message, text, position)
    scope = Scope(symbols=symbols)
    built = [_build(term, text, registry, scope) for term in terms]
    total: Any = built[0]
    for summand in built[1:]:
        total = total + summand
    return total


def _build(node: Node, text: str, registry: _Registry[T], scope: Scope) -> T:
    if isinstance(node, Name) and (named := registry.constructors.get(node.name)) and not signature(named).parameters:
        return named()  # trivial, for trivial(): there is nothing to write in the brackets
    if not isinstance(node, Call):
        hint = (
            f"{node.name}(...)" if isinstance(node, Name) and node.name in registry.constructors else registry.example
        )
        message = f"this {registry.kind} must be a name with its arguments in brackets. Write for example {hint}"
        raise ExpressionError(message, text, node.position)
    constructor = registry.constructors.get(node.function)
    if constructor is None:
        hint = did_you_mean(node.function, registry.constructors)
        known = ", ".join(registry.constructors)
        message = f"the {registry.kind} {node.function!r} is unknown. {hint}Known are {known}"
        raise ExpressionError(message, text, node.position)
    parameters = signature(constructor).parameters
    symbolic = {k for k, parameter in enumerate(parameters.values()) if parameter.annotation == "Parameter"}
    arguments = [_argument(child, text, scope, may_be_a_name=k in symbolic) for k, child in enumerate(node.children)]
    try:
        signature(constructor).bind(*arguments)
    except TypeError as error:
        wanted = f"{node.function}({', '.join(parameters)})"
        raise ExpressionError(f"{error} for {wanted}. Correct the arguments", text, node.position) from None
    try:
        return constructor(*arguments)
    except LiePoissonError as error:
        raise ExpressionError(str(error).removesuffix("."), text, node.position) from error


def _argument(node: Node, text: str, scope: Scope, *, may_be_a_name: bool) -> object:
    """A whole number as int, another rational number as Fraction, anything else as an expression in symbols.

    A symbol stays a name, for which SymPy need not be imported, where the constructor takes one for a symbol; "nan" it
    does not take.
    """
    if (
        may_be_a_name
        and isinstance(node, Name)
        and scope.shapes.get(node.name) == ()
        and read_symbol(node.name, node.name) is not None
    ):
        return node.name
    value = evaluate(node, text, scope)
    return int(value) if isinstance(value, Fraction) and value.denominator == 1 else value
