"""The reader of the values in system files: exact numbers, formulas, and lists of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any, cast

from liepoisson.algebra.exact_numbers import Coefficient, Exact
from liepoisson.formula.coefficients import coefficient
from liepoisson.formula.expression import evaluate
from liepoisson.formula.grammar import MAX_DIGITS, parse
from liepoisson.formula.parameters import Value
from liepoisson.formula.scope import Scope
from liepoisson.formula.toml_text import TomlReader, in_words

_MAX_LIST = 100_000


class ValueReader(TomlReader):
    """Turns the values of tables into numbers and texts; every method says which key is wrong."""

    def entries(self, keys: tuple[str | int, ...], given: object) -> Any:
        """Formulas and exact numbers, in lists of lists."""
        if isinstance(given, list):
            return tuple(self.entries((*keys, k), item) for k, item in enumerate(cast("list[object]", given)))
        return self.text(keys, given) if isinstance(given, str) else self.number(keys, given)

    def value(self, keys: tuple[str | int, ...], given: object) -> Value:
        """A number, a vector or a matrix."""
        if not isinstance(given, list):
            return self.number(keys, given)
        items = cast("list[object]", given)
        if not items or len(items) > _MAX_LIST:
            raise self.toml.error(keys, f"wanted 1 to {_MAX_LIST} entries; got {len(items)}. Correct the list.")
        if not any(isinstance(item, list) for item in items):
            return tuple(self.number((*keys, k), item) for k, item in enumerate(items))
        rows = [tuple(self.array((*keys, k), item, None, depth=1)) for k, item in enumerate(items)]
        if len({len(row) for row in rows}) != 1 or not rows[0]:
            raise self.toml.error(keys, "wanted a matrix with rows of one length. Fill up the short rows.")
        return tuple(rows)

    def array(
        self, keys: tuple[str | int, ...], given: object, symbols: Sequence[str] | None, *, depth: int
    ) -> list[Any]:
        """Nested lists of numbers, or of coefficients in the symbols."""
        if not isinstance(given, list) or len(cast("list[object]", given)) > _MAX_LIST:
            kind = ("", "a list", "a list of lists", "a list of lists of lists")[depth]
            raise self.toml.error(keys, f"wanted {kind} of numbers; got {in_words(given)}. Put it in square brackets.")
        items = enumerate(cast("list[object]", given))
        if depth == 1 and symbols is None:
            return [self.number((*keys, k), item) for k, item in items]
        if depth == 1:
            scope = Scope(symbols=symbols or ())
            return [self.coefficient((*keys, k), item, scope) for k, item in items]
        return [self.array((*keys, k), item, symbols, depth=depth - 1) for k, item in items]

    def coefficient(self, keys: tuple[str | int, ...], given: object, scope: Scope) -> Coefficient:
        """A number, or a formula in symbols."""
        if isinstance(given, str):
            return self.guarded(keys, lambda: coefficient(parse(given), given, scope))
        return self.number(keys, given)

    def number(self, keys: tuple[str | int, ...], given: object) -> Exact:
        """An exact number, also as a formula."""
        if isinstance(given, str):
            return self.guarded(keys, lambda: evaluate(parse(given), given, Scope()))
        if isinstance(given, Fraction):
            return given
        if isinstance(given, bool) or not isinstance(given, int):
            raise self.toml.error(keys, f'wanted a number such as 2, 0.5 or "1/3"; got {in_words(given)}. Correct it.')
        if abs(given) >= 10**MAX_DIGITS:
            raise self.toml.error(keys, f"wanted a number of at most {MAX_DIGITS} digits; got a longer one. Rescale.")
        return Fraction(given)

    def text(self, keys: tuple[str | int, ...], given: object) -> str:
        """A text that is not empty."""
        if not isinstance(given, str) or not given.strip():
            raise self.toml.error(keys, f"wanted a text in quotes; got {in_words(given)}. Correct it.")
        return given

    def optional_text(self, keys: tuple[str | int, ...], table: Mapping[str, object]) -> str | None:
        """The text of the last key; None where it is not given."""
        return self.text(keys, table[str(keys[-1])]) if keys[-1] in table else None

    def texts(self, keys: tuple[str | int, ...], given: object) -> list[str]:
        """A list of texts."""
        if not isinstance(given, list):
            raise self.toml.error(keys, f"wanted a list of texts; got {in_words(given)}. Put it in square brackets.")
        return [self.text((*keys, k), item) for k, item in enumerate(cast("list[object]", given))]
