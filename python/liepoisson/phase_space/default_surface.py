"""A surface of section for any system: where the rate of a bounded function vanishes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from liepoisson.calls import explains_its_arguments
from liepoisson.errors import ParameterError
from liepoisson.exact.rational_polynomials import in_words
from liepoisson.phase_space.lengths import unit_length

if TYPE_CHECKING:
    from liepoisson.phase_space.leaf import Leaf

_NEARBY, _RESTS = 0.2, 1e-9
"""How far the states are moved at which rates are compared, relative to the state; a rate below this fraction of the
largest is round-off."""


@explains_its_arguments
def default_surface(leaf: Leaf) -> str:
    r"""A surface that recurrent orbits of a leaf meet again and again: where the rate of a bounded function vanishes.

    For a top with two fields that function is $\ell\cdot\beta$ (see `good_surface`).  Otherwise, or where its rate
    vanishes on the whole leaf, it is a coordinate: the last of each vector in turn, then the others.

    Example:
        >>> lp.sections.default_surface(lp.Leaf(lp.catalog.system("henon-heiles"), {}))  # the rate of p_y
        '-x^2 + y^2 - y'

    Args:
        leaf: The leaf.

    Returns:
        The function that is zero on the surface, for `section`.

    Raises:
        ParameterError: every state of the leaf is an equilibrium.
    """
    return chosen_surface(leaf)[0]


@np.errstate(all="ignore")
def chosen_surface(leaf: Leaf) -> tuple[str, str]:
    """The default surface, and the function whose rate vanishes there."""
    from liepoisson.exact.system_text import formula_text
    from liepoisson.phase_space.surfaces import as_leaf, good_surface

    as_leaf(leaf)
    system, top = leaf.system, leaf.system.top_parameters
    names = system.component_names
    if top is not None and any(float(a) for a in top.field().a) and leaf.is_regular and top.field().epsilon:
        return good_surface(system), "-dot(l, beta)"
    size = system.vector_length
    order = sorted(range(len(names)), key=lambda k: (size - 1 - k % size, k))
    # A leaf of lower rank may make a rate zero that is not zero elsewhere: compare with the rates at moved states.
    view = leaf.in_units()
    size = float(np.linalg.norm(view.state)) + unit_length(system.bracket)
    noise = np.random.default_rng(0).standard_normal((8, len(names))) * view.units * size / np.sqrt(len(names))
    nearby = leaf.project(leaf.state + _NEARBY * noise)
    rates = np.abs(system.vector_field(nearby)).max(axis=0) / view.units
    for k in order:
        if rates[k] > _RESTS * rates.max():
            if system.polynomial_rates is not None:
                return in_words(system.polynomial_rates[k], names), names[k]
            return formula_text(list(system.equations.values())[k]), names[k]
    raise ParameterError(f"{system.name} must move on this leaf; every state is an equilibrium. Try another leaf.")
