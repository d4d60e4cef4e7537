r"""All real Lie algebras of dimension four and less by their names, with their Casimirs.

The names of indecomposable ones, $A_{n,k}$, their brackets and the ranges of parameters are those of Mubarakzyanov as
Patera, Sharp, Winternitz and Zassenhaus print them; A1 and A2 are the algebras of dimension one and two.  Casimirs are
those of the paper, with real functions in the place of complex powers.  They exist on open dense sets, those with
$\arctan(y/x)$ where x is not zero.

References: Mubarakzyanov, Izv. Vyssh. Uchebn. Zaved. Mat. 32 (1963) 114; Patera, Sharp, Winternitz and Zassenhaus, J.
Math. Phys. 17 (1976) 986, table I.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.exact_numbers import Exact, to_sympy
from liepoisson.errors import ParameterError
from liepoisson.formula.expression import read_expression
from liepoisson.formula.parameters import Parameter, read_parameter
from liepoisson.formula.scope import Scope
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.refusals import check_choice, shown
from liepoisson.structure.lie_algebra import LieAlgebra

if TYPE_CHECKING:
    from sympy import Expr


@dataclass(frozen=True)
class _Row:
    """A row of the table.

    Attributes:
        brackets: By pairs of basis elements, counted from 1, as texts in e1, ..., e4.
        casimirs: In e1, ..., e4.
        ranges: Of a and b in words, by name; what they must not be outside of.
    """

    dimension: int
    brackets: Mapping[str, str] = field(default_factory=dict[str, str])
    casimirs: tuple[str, ...] = ()
    ranges: Mapping[str, str] = field(default_factory=dict[str, str])


_ROWS = {
    "A1": _Row(1, {}, ("e1",)),
    "A2": _Row(2, {"12": "e2"}),
    "A3,1": _Row(3, {"23": "e1"}, ("e1",)),
    "A3,2": _Row(3, {"13": "e1", "23": "e1 + e2"}, ("e1*exp(-e2/e1)",)),
    "A3,3": _Row(3, {"13": "e1", "23": "e2"}, ("e2/e1",)),
    "A3,4": _Row(3, {"13": "e1", "23": "-e2"}, ("e1*e2",)),
    "A3,5": _Row(3, {"13": "e1", "23": "a*e2"}, ("e2*e1^(-a)",), {"a": "0 < |a| < 1"}),
    "A3,6": _Row(3, {"13": "-e2", "23": "e1"}, ("e1^2 + e2^2",)),
    "A3,7": _Row(
        3, {"13": "a*e1 - e2", "23": "e1 + a*e2"}, ("(e1^2 + e2^2)*exp(-2*a*atan(e2/e1))",), {"a": "a > 0"}
    ),
    "A3,8": _Row(3, {"12": "e1", "13": "-2*e2", "23": "e3"}, ("e2^2 + e1*e3",)),
    "A3,9": _Row(3, {"12": "e3", "23": "e1", "13": "-e2"}, ("e1^2 + e2^2 + e3^2",)),
    "A4,1": _Row(4, {"24": "e1", "34": "e2"}, ("e1", "e2^2 - 2*e1*e3")),
    "A4,2": _Row(
        4, {"14": "a*e1", "24": "e2", "34": "e2 + e3"}, ("e1*e2^(-a)", "e2*exp(-e3/e2)"), {"a": "a != 0"}
    ),
    "A4,3": _Row(4, {"14": "e1", "34": "e2"}, ("e2", "e1*exp(-e3/e2)")),
    "A4,4": _Row(
        4, {"14": "e1", "24": "e1 + e2", "34": "e2 + e3"}, ("e1*exp(-e2/e1)", "(e2^2 - 2*e1*e3)/e1^2")
    ),
    "A4,5": _Row(
        4, {"14": "e1", "24": "a*e2", "34": "b*e3"}, ("e2*e1^(-a)", "e3*e1^(-b)"),
        {"a": "-1 <= a <= b, a != 0", "b": "a <= b <= 1, b != 0, b > 0 where a = -1"},
    ),
    "A4,6": _Row(
        4, {"14": "a*e1", "24": "b*e2 - e3", "34": "e2 + b*e3"},
        ("e1*exp(-a*atan(e3/e2))", "(e2^2 + e3^2)*exp(-2*b*atan(e3/e2))"),
        {"a": "a != 0, a > 0 where b = 0", "b": "b >= 0"},
    ),
    "A4,7": _Row(4, {"14": "2*e1", "23": "e1", "24": "e2", "34": "e2 + e3"}),
    "A4,8": _Row(4, {"23": "e1", "24": "e2", "34": "-e3"}, ("e1", "e2*e3 - e1*e4")),
    "A4,9": _Row(4, {"23": "e1", "14": "(1 + b)*e1", "24": "e2", "34": "b*e3"}, (), {"b": "-1 < b <= 1"}),
    "A4,10": _Row(4, {"23": "e1", "24": "-e3", "34": "e2"}, ("e1", "e2^2 + e3^2 + 2*e1*e4")),
    "A4,11": _Row(4, {"23": "e1", "14": "2*a*e1", "24": "a*e2 - e3", "34": "e2 + a*e3"}, (), {"a": "a > 0"}),
    "A4,12": _Row(4, {"13": "e1", "23": "e2", "14": "-e2", "24": "e1"}),
}  # fmt: skip

_SUMS = (
    "2A1", "3A1", "A2+A1", "4A1", "A2+2A1", "2A2", *(f"A3,{k}+A1" for k in range(1, 10)),
)  # fmt: skip


def _parts(name: str) -> list[str]:
    """The indecomposable summands of a name: "A2+2A1" is A2, A1, A1."""
    found: list[str] = []
    for part in name.split("+"):
        count, _, rest = part.partition("A")
        found += [f"A{rest}"] * int(count or 1)
    return found


NAMES: tuple[str, ...] = tuple(
    sorted((*_ROWS, *_SUMS), key=lambda name: (sum(_ROWS[part].dimension for part in _parts(name)), name in _SUMS))
)
"""The names by dimension, sums last."""


@explains_its_arguments
def low_dimensional(name: str, a: Parameter | None = None, b: Parameter | None = None) -> LieAlgebra:
    r"""A real Lie algebra of dimension at most four by its name: each there is once, with one value of its parameters.

    | name | nonzero brackets | parameters |
    |---|---|---|
    | A1, A2 | none; $[e_1, e_2] = e_2$ | |
    | A3,1 | $[e_2, e_3] = e_1$ | |
    | A3,2 | $[e_1, e_3] = e_1$, $[e_2, e_3] = e_1 + e_2$ | |
    | A3,3, A3,4, A3,5 | $[e_1, e_3] = e_1$, $[e_2, e_3] = a e_2$ | a = 1, a = -1, $0 < |a| < 1$ |
    | A3,6, A3,7 | $[e_1, e_3] = a e_1 - e_2$, $[e_2, e_3] = e_1 + a e_2$ | a = 0, a > 0 |
    | A3,8 | $[e_1, e_2] = e_1$, $[e_1, e_3] = -2 e_2$, $[e_2, e_3] = e_3$ | |
    | A3,9 | $[e_1, e_2] = e_3$, $[e_2, e_3] = e_1$, $[e_3, e_1] = e_2$ | |
    | A4,1 | $[e_2, e_4] = e_1$, $[e_3, e_4] = e_2$ | |
    | A4,2 | $[e_1, e_4] = a e_1$, $[e_2, e_4] = e_2$, $[e_3, e_4] = e_2 + e_3$ | $a \ne 0$ |
    | A4,3 | $[e_1, e_4] = e_1$, $[e_3, e_4] = e_2$ | |
    | A4,4 | $[e_1, e_4] = e_1$, $[e_2, e_4] = e_1 + e_2$, $[e_3, e_4] = e_2 + e_3$ | |
    | A4,5 | $[e_1, e_4] = e_1$, $[e_2, e_4] = a e_2$, $[e_3, e_4] = b e_3$ | $-1 \le a \le b \le 1$, $ab \ne 0$; \
        $b > 0$ where $a = -1$ |
    | A4,6 | $[e_1, e_4] = a e_1$, $[e_2, e_4] = b e_2 - e_3$, $[e_3, e_4] = e_2 + b e_3$ | $a \ne 0$, $b \ge 0$; \
        $a > 0$ where $b = 0$ |
    | A4,7 | $[e_2, e_3] = e_1$, $[e_1, e_4] = 2 e_1$, $[e_2, e_4] = e_2$, $[e_3, e_4] = e_2 + e_3$ | |
    | A4,8, A4,9 | $[e_2, e_3] = e_1$, $[e_1, e_4] = (1 + b) e_1$, $[e_2, e_4] = e_2$, $[e_3, e_4] = b e_3$ | b = -1, \
        $-1 < b \le 1$ |
    | A4,10, A4,11 | $[e_2, e_3] = e_1$, $[e_1, e_4] = 2a e_1$, $[e_2, e_4] = a e_2 - e_3$, $[e_3, e_4] = e_2 + a e_3$ \
        | a = 0, a > 0 |
    | A4,12 | $[e_1, e_3] = e_1$, $[e_2, e_3] = e_2$, $[e_1, e_4] = -e_2$, $[e_2, e_4] = e_1$ | |

    Direct sums: 2A1, 3A1, A2+A1, 4A1, A2+2A1, 2A2, A3,1+A1, ..., A3,9+A1.  Bianchi's types are I 3A1, II A3,1, III
    A2+A1, IV A3,2, V A3,3, VI A3,4 and A3,5, VII A3,6 and A3,7, VIII A3,8, IX A3,9.

    Example:
        >>> lp.algebras.low_dimensional("A4,5", "1/2", 1).derived_series()[1].dimension
        3

    Args:
        name: Its name.
        a: The parameter a, exact, or a name that stays symbolic.
        b: The parameter b.

    Raises:
        ParameterError: there is no such name, it has not these parameters, or one is not exact or outside of its range.

    References: Mubarakzyanov (1963); [pswz1976], table I.
    """
    parts, values = _read(name, a, b)
    algebra: LieAlgebra | None = None
    for part in parts:
        row = _ROWS[part]
        basis = [f"e{k + 1}" for k in range(row.dimension)]
        brackets: dict[tuple[int, int], Any] = {}
        for pair, text in row.brackets.items():
            total: Any = _expression(text, basis, values)
            slopes = {k: total.diff(e) for k, e in enumerate(_symbols(basis))}
            brackets[int(pair[0]) - 1, int(pair[1]) - 1] = {k: c for k, c in slopes.items() if c != 0}
        one = LieAlgebra.from_brackets(row.dimension, brackets, check=False)
        algebra = one if algebra is None else algebra + one
    assert algebra is not None
    shown_values = ", ".join(str(value) for value in values.values())
    algebra.name, algebra.summands = f"{name}({shown_values})" if values else name, ()
    return algebra


@explains_its_arguments
def low_dimensional_casimirs(name: str, a: Parameter | None = None, b: Parameter | None = None) -> list[Expr]:
    r"""Independent Casimirs of `low_dimensional(name, a, b) @ trivial()`, all there are: rational ones and others.

    Example:
        >>> bracket = lp.algebras.low_dimensional("A4,3") @ lp.trivial()
        >>> casimirs = lp.algebras.low_dimensional_casimirs("A4,3")
        >>> casimirs, bracket.with_casimirs(casimirs).n_unknown_casimirs
        ([l2, l1*exp(-l3/l2)], 0)

    Args:
        name: The name.
        a: The parameter a.
        b: The parameter b.

    Raises:
        ParameterError: there is no such name, it has not these parameters, or one is not exact or outside of its range.

    References: [pswz1976], table I.
    """
    parts, values = _read(name, a, b)
    found: list[Expr] = []
    start = 0
    for part in parts:
        row = _ROWS[part]
        names = [f"l{start + k + 1}" for k in range(row.dimension)]
        moved = (re.sub(r"e(\d)", lambda m, s=start: f"l{s + int(m[1])}", text) for text in row.casimirs)
        found += [_expression(text, names, values) for text in moved]
        start += row.dimension
    return found


def _symbols(names: list[str]) -> list[Any]:
    from sympy import Symbol

    return [Symbol(name) for name in names]


def _expression(text: str, names: list[str], values: Mapping[str, Exact]) -> Expr:
    from sympy import Symbol

    inserted: Any = {Symbol(key): to_sympy(value) for key, value in values.items()}  # roots may be exponents
    read: Any = read_expression(text, Scope(symbols=[*names, *values]))
    return read.xreplace(inserted)


def _read(name: str, a: Parameter | None, b: Parameter | None) -> tuple[list[str], dict[str, Exact]]:
    """The summands of a name, and the values of its parameters."""
    check_choice(name, "name", NAMES)
    parts = _parts(name)
    ranges = {key: text for part in parts for key, text in _ROWS[part].ranges.items()}
    given = {key: value for key, value in (("a", a), ("b", b)) if value is not None}
    if unknown := sorted(given.keys() - ranges.keys()):
        raise ParameterError(f"{unknown[0]}: wanted none for {name}; got {shown(given[unknown[0]])}; leave it out")
    if missing := sorted(ranges.keys() - given.keys()):
        raise ParameterError(
            f"{missing[0]}: wanted a number for {name}, {ranges[missing[0]]}; got none; give it, or a name such as "
            f'{missing[0]}="{missing[0]}"'
        )
    values = {key: read_parameter(given[key], key) for key in ranges}
    numbers: Any = {key: to_sympy(value) for key, value in values.items()}
    if all(value.is_number for value in numbers.values()):
        for key, text in ranges.items():
            if not _holds(text, numbers):
                raise ParameterError(
                    f"{key}: wanted {text} for {name}; got {shown(str(given[key]))}; algebras.identify says which name "
                    "other values have"
                )
    return parts, values


def _holds(text: str, values: Mapping[str, Any]) -> bool:
    """Whether numbers obey a range such as "-1 <= a <= b, a != 0, b > 0 where a = -1"."""
    from sympy import Integer

    def number(word: str) -> Any:
        plain = word.strip().strip("|")
        value = values[plain] if plain in values else Integer(int(plain))
        return abs(value) if "|" in word else value

    def holds(part: str) -> bool:
        words = re.split(r"(<=|>=|!=|<|>|=)", part)
        for left, sign, right in zip(words[::2], words[1::2], words[2::2], strict=False):
            difference: Any = number(right) - number(left)
            relations = {
                "<": difference.is_positive, "<=": difference.is_nonnegative, ">": difference.is_negative,
                ">=": difference.is_nonpositive, "!=": not difference.is_zero, "=": difference.is_zero,
            }  # fmt: skip
            if not relations[sign]:
                return False
        return True

    rules = (part.partition("where") for part in text.split(","))
    return all(holds(rule) for rule, _, case in rules if not case or holds(case))
