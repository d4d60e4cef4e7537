"""How messages quote a wrong value."""

from __future__ import annotations


def shown(value: object) -> str:
    """A wrong value as a message quotes it: never long."""
    try:
        text = repr(value)
    except ValueError:  # an integer of thousands of digits has no repr
        text = "a very large number"
    return text if len(text) <= 60 else text[:57] + "..."
