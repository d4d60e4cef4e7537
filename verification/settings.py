"""How much is computed: all of it, or enough for a look."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar

Choice = TypeVar("Choice")


@dataclass(frozen=True)
class Settings:
    """The size of an audit.

    Attributes:
        quick: Small ensembles and short runs, a minute or two in all.
    """

    quick: bool

    def choose(self, *, quick: Choice, full: Choice) -> Choice:
        """One of two sizes."""
        return quick if self.quick else full
