"""TOML files with exact numbers: 0.1 is one tenth.  A file is read with limits, and its faults with their lines."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any, TypeVar, cast

from liepoisson.errors import (
    ExpressionError,
    LiePoissonError,
    MissingFileError,
    ParameterError,
    SystemFileError,
    did_you_mean,
)
from liepoisson.formula.parameters import read_parameter

T = TypeVar("T")

MAX_BYTES = 1_000_000
_MAX_PARTS = 16
_HDF5 = b"\x89HDF\r\n\x1a\n"
"""How a NetCDF-4 file begins."""
# The time that a key takes grows with the square of the number of its parts.
_PART = r"(?>[\w-]+|\"[^\"\n]*\"|'[^'\n]*')[ \t]*\.[ \t]*"
_LONG_KEY = re.compile(rf"(?<![\w-])(?>{_PART}){{{_MAX_PARTS}}}")
_POSITION = re.compile(r"(.*) \(at (?:line (\d+), column (\d+)|end of document)\)", re.DOTALL)


@dataclass(frozen=True, slots=True, repr=False)
class UnreadableNumber:
    """A decimal that is not a finite number of reasonable length, for example nan; shown as it is written."""

    text: str

    def __repr__(self) -> str:
        return self.text


@dataclass(frozen=True)
class TomlText:
    """A TOML file that has been read.

    Attributes:
        path: How the file is called in messages.
        text: Its text.
        tables: What it says; decimals are Fractions or UnreadableNumbers.
    """

    path: str
    text: str
    tables: dict[str, Any]

    def error(self, keys: Sequence[str | int], message: str) -> SystemFileError:
        """An error about the value of a key, to be raised."""
        line = self._line(keys)
        where = f"{self.path}, line {line}" if line else self.path
        return SystemFileError(f"{where}: {_shown(keys)}{message}")

    def _line(self, keys: Sequence[str | int]) -> int | None:
        """The line of a key; that of its table if the key itself is not written on a line of its own."""
        lines = self.text.split("\n")
        names = [key for key in keys if isinstance(key, str)]
        start, found = 0, None
        if len(names) > 1 or (names and isinstance(self.tables.get(names[0]), (dict, list))):
            count = next((key for key in keys if isinstance(key, int)), None)
            for depth in range(len(names) if count is None else 1, 0, -1):  # [integrals.K] before [integrals]
                headers = _headers(lines, names[:depth])
                if headers:
                    start = found = headers[min(count or 0, len(headers) - 1)]
                    names = names[depth:]
                    break
        for name in names[:1]:
            key = re.compile(rf"\s*[\"']?{re.escape(name)}[\"']?\s*[=.]")
            found = next((number for number in range(start, len(lines)) if key.match(lines[number])), found)
        return None if found is None else found + 1


class TomlReader:
    """Turns the tables of a file into its meaning; every error names the key and the line.

    Args:
        toml: The file.
    """

    def __init__(self, toml: TomlText) -> None:
        self.toml = toml

    def table(self, keys: tuple[str | int, ...], given: object) -> dict[str, Any]:
        """A table, which must be there."""
        if given is None:
            raise self.toml.error((), f"wanted a table [{keys[0]}]; there is none. Add it.")
        if not isinstance(given, dict):
            raise self.toml.error(
                keys, f"wanted a table; got {in_words(given)}. Write [{keys[0]}] on a line of its own."
            )
        return cast("dict[str, Any]", given)

    def check_keys(
        self,
        keys: tuple[str | int, ...],
        table: Mapping[str, object],
        known: Sequence[str],
        below: Mapping[str, str] | None = None,
    ) -> None:
        """Refuse unknown keys; of some, which may be meant by a misspelt one, too, it is known where they belong."""
        elsewhere = below or {}
        for key in table:
            if key not in known:
                hint = elsewhere.get(key) or did_you_mean(key, (*known, *elsewhere)).strip() or "Remove it."
                raise self.toml.error((*keys, key), f"the key is unknown; known are {', '.join(known)}. {hint}")

    def guarded(self, keys: tuple[str | int, ...], read: Callable[[], T]) -> T:
        """What `read` returns; an error that it raises is told with the key and the line."""
        try:
            return read()
        except SystemFileError:
            raise
        except ExpressionError as error:
            raise self.toml.error(keys, error.within_formula()) from error
        except LiePoissonError as error:
            raise self.toml.error(keys, str(error).removeprefix(_shown(keys))) from error


def in_words(given: object) -> str:
    """A wrong value as a message about a file quotes it."""
    if isinstance(given, UnreadableNumber):
        return given.text
    if isinstance(given, (str, bool, float)):
        return repr(given)[:60]
    kinds: dict[type[Any], str] = {dict: "a table", list: "a list", int: "a number", Fraction: "a number"}
    return kinds.get(type(given), f"a {type(given).__name__}")


def _headers(lines: Sequence[str], names: Sequence[str]) -> list[int]:
    """The lines that begin a table of this name, or an entry of an array of tables."""
    name = r"\s*\.\s*".join(rf"[\"']?{re.escape(name)}[\"']?" for name in names)
    header = re.compile(rf"\s*\[\[?\s*{name}\s*\]")
    return [number for number, line in enumerate(lines) if header.match(line)]


def read_toml(path: str | Path) -> TomlText:
    """Read a TOML file.

    Raises:
        SystemFileError: there is no such file, it is too large or not UTF-8, or it is not TOML (with the line).
    """
    try:
        found = Path(path)
    except TypeError:
        raise SystemFileError(f"a system file is given by its path; got {path!r:.60}. Write its name.") from None
    return parse_toml(_text_of(found), str(path))


def parse_toml(text: str, path: str) -> TomlText:
    """Read TOML text; `path` is how messages call it.

    Raises:
        SystemFileError: it is not TOML (with the line).
    """
    if match := _LONG_KEY.search(text):
        line = text.count("\n", 0, match.start()) + 1
        raise SystemFileError(f"{path}, line {line}: a key has more than {_MAX_PARTS} parts. Write shorter keys.")
    try:
        return TomlText(path, text, tomllib.loads(text, parse_float=_decimal))
    except RecursionError:
        raise SystemFileError(f"{path}: lists or tables are nested too deeply. Write them flatter.") from None
    except ValueError as error:  # TOMLDecodeError, or a whole number that is too long to be read
        raise SystemFileError(_translated(error, path)) from None


def _text_of(path: Path) -> str:
    try:
        with path.open("rb") as file:
            content = file.read(MAX_BYTES + 1)
    except IsADirectoryError:
        raise SystemFileError(f"{path} must be a file; it is a folder. Give the path of a TOML file.") from None
    except FileNotFoundError:
        raise MissingFileError(f"there is no file {path}. {_instead_of(path)}") from None
    except (OSError, ValueError) as error:  # ValueError: a null character in the path
        raise SystemFileError(f"{path} cannot be read: {error}. Check the path and the permissions.") from None
    if content.startswith(_HDF5):
        raise SystemFileError(
            f"{path} must be a TOML file; it is a NetCDF file, as the results of runs are. Read a result with "
            f"lp.load({str(path)!r:.200})."
        )
    if len(content) > MAX_BYTES:
        raise SystemFileError(f"{path} must have at most {MAX_BYTES} bytes; it has more. Is it a system file?")
    try:
        return content.decode("utf-8").removeprefix("\ufeff").replace("\r\n", "\n")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        message = (
            f"{path}, line {line}: the text must be in UTF-8; byte {content[error.start]:#04x} is not. Convert it."
        )
        raise SystemFileError(message) from None


def _instead_of(path: Path) -> str:
    """What to try where there is no such file: a bare name was most likely meant for the catalog."""
    if path.suffix or path.name != str(path):
        return "Check the path."
    return f'Check the path. In Python a system of the catalog is lp.catalog.system("{path.name:.60}").'


def _decimal(text: str) -> Fraction | UnreadableNumber:
    try:
        value = read_parameter(text.replace("_", ""), "a number")
    except ParameterError:
        return UnreadableNumber(text[:40])
    return value if isinstance(value, Fraction) else UnreadableNumber(text[:40])


def _translated(error: ValueError, path: str) -> str:
    """The message of Python's reader of TOML in our form."""
    match = _POSITION.fullmatch(str(error))
    if match is None:
        hint = "Numbers have at most 200 digits" if "digits" in str(error) else str(error)
        return f"{path} is not TOML: {hint}. Correct the file."
    line = f", line {match[2]}, column {match[3]}" if match[2] else ", at its end"
    return f"{path}{line}: not TOML: {match[1]}. Texts stand in quotes, tables in [brackets]."


def _shown(keys: Sequence[str | int]) -> str:
    """The keys as the file writes them: [parameters] I[1]."""
    if not keys:
        return ""
    first, *rest = keys
    shown = "".join(f"[{key + 1}]" if isinstance(key, int) else f" {key}" for key in rest)
    return f"[{first}]{shown}: " if rest else f"{first}: "
