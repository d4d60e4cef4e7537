"""A surface of section for any system, where the rate of a bounded function vanishes; a good one for two-field tops."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

import numpy as np

from liepoisson.algebra.exact_numbers import is_zero
from liepoisson.algebra.rational_polynomials import in_words
from liepoisson.errors import LeafError, ParameterError, SurfaceWarning
from liepoisson.formula.scalars import as_count
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.refusals import check_choice
from liepoisson.leaf._checks import as_energy, as_system
from liepoisson.leaf.leaf_in_units import unit_length
from liepoisson.portable import linear
from liepoisson.streams import generator

if TYPE_CHECKING:
    from liepoisson.inputs.arrays import Array
    from liepoisson.leaf.leaf import Leaf
    from liepoisson.model.system import System

_NEARBY, _RESTS = 0.2, 1e-9
"""How far the states are moved at which rates are compared, relative to the state; a rate below this fraction of the
largest is round-off."""
_TWO_DEGREES, _TRIED = 4, 100
"""The rank of leaves whose sections are planes; states on a section by which it is judged."""
_FOLLOWED, _TURNS = 16, 100.0
"""How many of these are followed until they come back, and for how long at most, in natural times, as the command does
for each crossing."""
_REASON = "a component: every plane folds the section where the rate of {} vanishes"


@explains_its_arguments
def good_surface(system: System) -> str:
    r"""The surface $a\cdot(\alpha\times\beta) = 0$ of a top with two fields, where $\ell\cdot\beta$ is extremal.

    $$\frac{d}{dt}\,\ell\cdot\beta = -a\cdot(\alpha\times\beta) = -s .$$

    Energy surfaces on leaves are bounded and carry an invariant measure, so almost every orbit is recurrent; a
    recurrent orbit on which $\ell\cdot\beta$ is not constant passes s = 0 infinitely often, alternately at maxima of
    $\ell\cdot\beta$ (s increases, direction +1) and at minima (-1).  The flow is tangent to the surface where

    $$\dot s = (\alpha\times\beta)\cdot(\omega\times a) + \epsilon\,|a\times\beta|^2 = 0 ,$$

    a set of codimension one in it.  Where $\alpha$ and $\beta$ are parallel it is transverse, unless $\epsilon = 0$ or
    $\beta\parallel a$.  On leaves with $\beta = 0$ (or, for $\epsilon = 0$, $\alpha\parallel\beta$) s vanishes
    everywhere.  A top without charge and cocycle, whose beta acts on nothing, is better cut as
    `catalog.system("heavy-top", ...)`, by `default_surface` or a component such as alpha3.

    Example:
        >>> lp.sections.good_surface(lp.Top.twisted_kovalevskaya())
        '-alpha2*beta3 + alpha3*beta2'

    Args:
        system: A top with two fields $\alpha, \beta$.

    Returns:
        The function s with numbers for a, for `section`.

    Raises:
        ParameterError: the system is no top with numbers for parameters, or a = 0, so that $\ell\cdot\beta$ is
            constant.

    References: [twistedtop2001], the equation for the derivative of $\ell\cdot\beta$.
    """
    from liepoisson.model.system_text import formula_text

    system = as_system(system)
    parameters = system.top_parameters
    if parameters is None:
        raise ParameterError(
            f"a top with fields alpha, beta and numbers for its parameters was wanted; {system.name} is none. For "
            f"another system {_other_surfaces(system)}."
        )
    if all(is_zero(value) for value in parameters.a):
        raise ParameterError(
            "a must not be zero: a = 0 keeps dot(l, beta) constant. The top with inertia and b alone is a heavy top in "
            '(l, beta); try a surface such as "beta3".'
        )
    terms = [
        f"({value})*(alpha{i}*beta{j} - alpha{j}*beta{i})"
        for value, (i, j) in zip(parameters.a, ((2, 3), (3, 1), (1, 2)), strict=True)
        if not is_zero(value)
    ]
    surface = " + ".join(terms)
    polynomial = system.polynomial(surface)
    if polynomial is not None:
        return in_words(polynomial, system.component_names)
    return formula_text(system.expression(surface))


def _other_surfaces(system: System) -> str:
    """What to take where there is no good surface for all leaves: a component that moves, if a vector has an axis."""
    advice = "take sections.default_surface(leaf), zeros of the time derivative of a bounded function"
    name = system.component_names[-1]
    if system.bracket.has_scalar_fields or system.vector_length != 3 or system.is_constant(name):
        return advice
    return f'{advice}; or "{name}", if orbits of your leaf and energy cross it'


@explains_its_arguments
def default_surface(leaf: Leaf, *, energy: float | None = None, direction: int = 1, seed: int = 0) -> str:
    r"""A surface that recurrent orbits of a leaf meet again and again: where the rate of a bounded function vanishes.

    For a top with two fields that function is $\ell\cdot\beta$ (see `good_surface`).  Otherwise, or where its rate
    vanishes on the whole leaf, it is a coordinate: the last of each vector in turn, then the others.  Of a Hamiltonian
    that is periodic in time it is t, whose section is the stroboscopic map.  Every recurrent
    orbit of the leaf meets it; it is what the command `section` takes for one orbit, given by `--start`.

    For several orbits of one energy the command takes what comes with `energy`: where the section is a plane that this
    surface folds, a component that orbits meet again, if its section is a graph.  Where the third component of a vector
    of space is zero and orbits pass in one direction, the angle about the third axis and its momentum determine the
    state, if the energy is convex in the momenta.

    Example:
        >>> oscillator = lp.Leaf(lp.catalog.system("henon-heiles"), {})
        >>> lp.sections.default_surface(oscillator)  # the rate of p_y
        '-x^2 + y^2 - y'
        >>> lp.sections.default_surface(oscillator, energy=0.1)
        'y'

    Args:
        leaf: The leaf.
        energy: The energy of the orbits; by default any.
        direction: The direction of the crossings by which sections of this energy are judged, 0 for both.
        seed: Draws states on these sections.

    Returns:
        The function that is zero on the surface, for `section`.

    Raises:
        ParameterError: every state of the leaf is an equilibrium, or an argument is of another kind.
    """
    check_choice(direction, "direction", (-1, 0, 1))
    level = None if energy is None else as_energy(energy)
    return surface_and_reason(leaf, level, direction=direction, seed=as_count(seed, "seed"))[0]


def surface_and_reason(leaf: Leaf, energy: float | None, *, direction: int = 1, seed: int = 0) -> tuple[str, str]:
    """`default_surface`, and why it was taken."""
    from liepoisson.poincare.section_sheets import section_axes
    from liepoisson.poincare.surfaces import as_leaf, section_starts

    if (clock := as_leaf(leaf).system.clock) is not None and clock in leaf.system.periods:
        return clock, "time: once in each period"
    default, of = chosen_surface(leaf)
    by_default = default, f"the rate of {of}"
    if energy is None or leaf.rank != _TWO_DEGREES:
        return by_default
    names = leaf.system.component_names
    for surface, reason in (by_default, *((names[k], _REASON.format(of)) for k in _places(leaf))):
        try:
            states = section_starts(
                leaf, surface, energy=energy, n_starts=_TRIED, seed=seed, direction=direction or 1, spread=True
            )
        except LeafError:  # no orbit of this energy crosses it
            continue
        is_graph = section_axes(leaf.system, states, surface, (names[-1], names[0])).is_graph
        if is_graph and (surface == default or _come_back(leaf, states, surface, direction)):
            return surface, reason
    return by_default


def _come_back(leaf: Leaf, states: Array, surface: str, direction: int) -> bool:
    """Whether orbits meet a surface again: near a pole, and where they escape, they do not."""
    from liepoisson.numeric.time_scale import time_scale, unit_of_time
    from liepoisson.poincare.section import section

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SurfaceWarning)
        few = states[:_FOLLOWED]
        t_end = _TURNS * unit_of_time(time_scale(leaf.system, few))
        run = section(leaf.system, few, surface=surface, t_end=t_end, direction=direction, n_crossings=1)
    return bool(run.count.all())


def _in_turn(leaf: Leaf) -> list[int]:
    """The places of the components, the last of each vector first, time and its momentum after all others."""
    size, names, clock = leaf.system.vector_length, leaf.system.component_names, leaf.system.clock
    begin = len(names) if clock is None else names.index(clock)
    return sorted(range(len(names)), key=lambda k: (k >= begin, size - 1 - k % size, k))


def _places(leaf: Leaf) -> list[int]:
    """The components that are no momenta, as far as that is known: not those of the first of several vectors."""
    system = leaf.system
    n, size = len(system.component_names), system.vector_length
    if system.bracket.has_scalar_fields:
        return list(range(n // 2))[::-1]
    return [k for k in _in_turn(leaf) if k >= size or size == n]


@np.errstate(all="ignore")
def chosen_surface(leaf: Leaf) -> tuple[str, str]:
    """The default surface, and the function whose rate vanishes there."""
    from liepoisson.model.system_text import formula_text
    from liepoisson.poincare.surfaces import as_leaf

    leaf = as_leaf(leaf).moving
    system, top = leaf.system, leaf.system.top_parameters
    names = system.component_names
    if top is not None and any(float(a) for a in top.field().a) and leaf.is_regular and top.field().epsilon:
        return good_surface(system), "-dot(l, beta)"
    # A leaf of lower rank may make a rate zero that is not zero elsewhere: compare with the rates at moved states.
    view = leaf.in_units()
    size = float(linear.norm(view.state)) + unit_length(system.bracket)
    noise = generator(0).standard_normal((8, len(names))) * view.units * size / np.sqrt(len(names))
    nearby = leaf.project(leaf.state + _NEARBY * noise)
    rates = np.abs(system.vector_field(nearby)).max(axis=0) / view.units
    for k in _in_turn(leaf):
        if rates[k] > _RESTS * rates.max():
            if system.polynomial_rates is not None:
                return in_words(system.polynomial_rates[k], names), names[k]
            return formula_text(list(system.equations.values())[k]), names[k]
    raise ParameterError(f"{system.name} must move on this leaf; every state is an equilibrium. Try another leaf.")
