"""How an answer is written down: plain data that JSON keeps, the same in each run, and readable line by line.

Doubles stand as Python writes them, which is exact: two of them read the same if and only if their bits are the same
(NaNs apart).  Long arrays stand as their shape and a hash.  An error is an answer, too: its type and its message.
"""

from __future__ import annotations

import dataclasses
import hashlib
import re
import tempfile
import warnings
from collections.abc import Callable, Mapping, Set
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
LONGEST = 32
"""Numbers of an array that are written out."""
OF_LIBRARIES = (DeprecationWarning, PendingDeprecationWarning, FutureWarning, ImportWarning, ResourceWarning)
"""Warnings that depend on what was imported before."""
_MASKS = (
    (re.compile(r"0x[0-9a-f]{6,}"), "0x..."),
    (re.compile(re.escape(str(ROOT))), "(repository)"),
    (re.compile(re.escape(tempfile.gettempdir()) + r"[^\s'\",:;)\]}]*"), "(temporary path)"),
)


def masked(text: str) -> str:
    """The text without addresses in memory, temporary paths and the place of the repository."""
    for pattern, instead in _MASKS:
        text = pattern.sub(instead, text)
    return text


def lines(text: str) -> str | list[str]:
    """The text, by lines where it has several: then a difference is that of a line."""
    text = masked(text)
    return text.split("\n") if "\n" in text else text


def answer(question: Callable[[], Any]) -> Any:
    """What a function returns, or the type and the message of what it raises; with what it warns of."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            found = plain(question())
        except Exception as error:  # whatever it is, it is the answer
            found = {"raises": type(error).__name__, "message": lines(str(error))}
    ours = [one for one in caught if not issubclass(one.category, OF_LIBRARIES)]
    said = sorted({f"{one.category.__name__}: {masked(str(one.message))}" for one in ours})
    return {"answer": found, "warnings": said} if said else found


def answers(questions: Mapping[str, Callable[[], Any]]) -> dict[str, Any]:
    """The answers to several questions, by their names."""
    return {name: answer(question) for name, question in questions.items()}


def plain(value: Any) -> Any:
    """A value as texts, numbers, lists and dictionaries; of a record its public fields."""
    if isinstance(value, np.generic):
        value = value.item()
    if value is None or isinstance(value, (bool, int, float)):
        return value
    if isinstance(value, complex):
        return [value.real, value.imag]
    if isinstance(value, np.ndarray):
        return _array(value)
    return lines(value) if isinstance(value, str) else _whole(value)


def _whole(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, Set):
        return sorted(str(plain(item)) for item in value)
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        fields = [field.name for field in dataclasses.fields(value) if not field.name.startswith("_")]
        return {"type": type(value).__name__, **{name: _field(getattr(value, name)) for name in fields}}
    return lines(str(value))


def _field(value: Any) -> Any:
    """A field of a record: a record in it stands as its text, so that no record leads to all the others."""
    return lines(str(value)) if dataclasses.is_dataclass(value) else plain(value)


def _array(value: np.ndarray) -> Any:
    if value.dtype.kind not in "biufc":
        return plain(value.tolist())
    if value.size <= LONGEST:
        return plain(value.tolist())
    return {"dtype": str(value.dtype), "shape": list(value.shape), "sha256": digest(value)}


def digest(value: Any) -> str:
    """A hash of the numbers of an array, bit by bit."""
    array = np.ascontiguousarray(value)
    return hashlib.sha256(array.astype(array.dtype.newbyteorder("<")).tobytes()).hexdigest()[:32]


def rounded_digest(value: Any, digits: int = 10) -> str:
    """A hash of numbers rounded to so many significant digits, which no other order of operations changes."""
    numbers = np.ma.filled(np.ma.asarray(value, dtype=float), np.nan)
    texts = [f"{number:.{digits - 1}e}" for number in numbers.ravel()]
    shown = " ".join([str(numbers.shape), *texts]).replace("-0.", "0.").replace("-" + f"{0.0:.{digits - 1}e}", "0")
    return hashlib.sha256(shown.encode()).hexdigest()[:32]
