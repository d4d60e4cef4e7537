"""Lax pairs of the literature for systems of the catalog, verified each time that one is asked for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from liepoisson.catalog import entry, names
from liepoisson.catalog.lax_pairs import LAX_PAIRS
from liepoisson.errors import UnknownNameError, did_you_mean
from liepoisson.formula.parameters import read_values
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.integrability.lax.pair import LaxPair, lax_pair

if TYPE_CHECKING:
    from liepoisson.formula.parameters import GivenValue


@explains_its_arguments
def known_lax_pair(name: str, *, parameters: Mapping[str, GivenValue] | None = None) -> LaxPair:
    """The Lax pair of a system of the catalog, verified.

    Example:
        >>> pair = lp.integrability.known_lax_pair("kovalevskaya")
        >>> pair.integrals().coefficients[0].formula
        8*H

    Args:
        name: The name of the system.
        parameters: Values in the place of those of the catalog.

    Raises:
        UnknownNameError: there is no such system, or the package has no Lax pair of it; the message lists those it has.
        LaxPairError: the pair is none for these parameters.
    """
    if name not in LAX_PAIRS:
        what = "has no Lax pair in the package" if name in names() else "is no system of the catalog"
        hint = did_you_mean(name, LAX_PAIRS)
        raise UnknownNameError(f"{name!r} {what}. {hint}There are those of {', '.join(LAX_PAIRS)}.")
    file, texts = entry(name), LAX_PAIRS[name]
    system = replace(file, parameters={**file.parameters, **read_values(parameters)}).system()
    return lax_pair(system, texts.L, texts.M, source=texts.source)
